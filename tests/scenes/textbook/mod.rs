//! Scenes from textbooks, papers and olympiads, each with a closed form or with equations of its
//! own that are integrated independently. `docs/sweep.md` lists them.

mod joints;
mod oscillators;
pub mod rolling;
mod sliding;
pub mod tops;
mod vehicles;

use super::{BASE, Run, Scene, Solver, base_place, figure, idle, play};
use crate::testing::Builder;
use urdf2fmu_core::model::{ActuatorId, ActuatorMode, LinkId, Model};
use urdf2fmu_core::simulation::{InputSlot, Simulation};

/// All of them.
pub fn all() -> Vec<Scene> {
    let mut all = tops::all();
    all.extend(joints::all());
    all.extend(oscillators::all());
    all.extend(rolling::all());
    all.extend(sliding::all());
    all.extend(vehicles::all());
    all
}

/// What a scene allows: in steps of 1/240 s, in tolerances under error control, and at least under
/// error control, because the truth has rigid contacts or servos and ours give way.
#[derive(Clone, Copy, Debug)]
struct Allowed {
    fixed: f64,
    tolerances: f64,
    least: f64,
}

/// Ten tolerances, and in fixed steps a hundredth of a metre or a radian.
const SMOOTH: Allowed = Allowed {
    fixed: 1e-2,
    tolerances: 10.0,
    least: 1e-8,
};

/// A share, whatever the solver.
const fn share(share: f64) -> Allowed {
    Allowed {
        fixed: share,
        tolerances: 0.0,
        least: share,
    }
}

/// What a scene is compared by: the name of the scene, of its source and of its quantity, and the
/// communication step and the end, s.
#[derive(Clone, Copy, Debug)]
struct Plan {
    name: &'static str,
    source: &'static str,
    quantity: &'static str,
    span: [f64; 2],
    allowed: Allowed,
}

/// What a user does at the beginning of each communication step.
type Command = Box<dyn Fn(&mut Simulation, f64)>;

/// Nothing.
fn nothing() -> Command {
    Box::new(idle)
}

/// A scene whose `seen` numbers at the end should be those of `truth`; its figure is their largest
/// difference.
fn compare(
    plan: Plan,
    make: impl Fn() -> (Model, Command) + 'static,
    look: impl Fn(&mut Simulation) -> Vec<f64> + 'static,
    truth: impl Fn() -> Vec<f64> + 'static,
) -> Scene {
    let Plan {
        name,
        source,
        quantity,
        span,
        allowed,
    } = plan;
    let simulate = move |solver| {
        let (model, command) = make();
        let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
            if s.time() > span[1] - 0.5 * span[0] {
                *seen = look(s);
            }
            true
        };
        play(model, solver, span, &mut |s, t| command(s, t), &mut watch)
    };
    let judge = move |solver: Solver, run: &Run| {
        let truth = Run {
            seen: truth(),
            ..Run::default()
        };
        let target = solver
            .tolerances(allowed.tolerances)
            .map_or(allowed.fixed, |t| t.max(allowed.least));
        vec![figure(quantity, run.apart(&truth), target)]
    };
    Scene {
        name: name.into(),
        source,
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// The coordinates at these places; of a base that floats the position of its link.
fn at_places<const N: usize>(places: [usize; N]) -> impl Fn(&mut Simulation) -> Vec<f64> {
    move |s| {
        let floats = s.model().is_floating();
        let of = |i: usize| match i {
            0..3 if floats => base_place(s)[i],
            _ => s.state().physical.q[i],
        };
        places.map(of).to_vec()
    }
}

/// A motor of this mode on the joint of a link.
fn motor(b: &mut Builder, link: LinkId, mode: ActuatorMode, gains: [f64; 2]) {
    b.actuator(link, mode, 1e4);
    let actuator = b.model.actuators.last_mut().expect("just added");
    [actuator.kp, actuator.kd] = gains;
}

fn set(s: &mut Simulation, slot: fn(ActuatorId) -> InputSlot, actuator: usize, value: f64) {
    s.set_input(slot(ActuatorId::from(actuator)), value);
}

/// Targets of the first `count` actuators at 0.
fn hold_at_zero(count: usize) -> Command {
    Box::new(move |s, _| (0..count).for_each(|a| set(s, InputSlot::Position, a, 0.0)))
}
