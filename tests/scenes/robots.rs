//! Whole robots: changing commands, light legs, loose hands. Their truth is our own solution at a
//! tight tolerance; passive ones must not gain energy.

use super::{BASE, H, Run, Scene, Solver, X, Y, Z, coordinates, figure, fixed, last, play, single};
use crate::testing::{Random, at, inertia};
use std::path::Path;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{ActuatorId, ActuatorMode, Model, Motion};
use urdf2fmu_core::settings::{ModeChoice, Settings};
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, Simulation};
use urdf2fmu_core::spatial::{Pose, Vec3};
use urdf2fmu_core::{assemble, urdf};

/// A robot of this repository, without the settings beside it.
fn robot(path: &str, settings: impl FnOnce(&mut Settings)) -> Model {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let mut chosen = Settings::default();
    settings(&mut chosen);
    let options = assemble::read_options(&chosen, urdf::ReadOptions::default());
    let description = urdf::read(&file, &options).expect("a robot of ours");
    let built = assemble::build(&description, &chosen);
    built.expect("a robot of ours").model
}

/// Every actuator in one mode.
fn in_mode(mode: ActuatorMode) -> impl FnOnce(&mut Settings) {
    move |s| s.default_mode = Some(ModeChoice::Commanded(mode))
}

type Command = Box<dyn FnMut(&mut Simulation, f64)>;

/// A scene whose truth is our own solution.
fn own(
    name: String,
    [h, end]: [f64; 2],
    reference: f64,
    make: impl Fn() -> (Model, Command) + 'static,
) -> Scene {
    let simulate = move |solver| {
        let (model, mut command) = make();
        play(
            model,
            solver,
            [h, end],
            &mut command,
            &mut last(coordinates),
        )
    };
    Scene {
        name,
        source: "our own solution at a tight tolerance",
        simulate: Box::new(simulate),
        judge: Box::new(|_, _| Vec::new()),
        reference: Some(reference),
    }
}

/// The rover with wheels at ±10 (1 + 0.2 sin 12 t) rad/s (`changing`) or at ±10 rad/s, turning on
/// the spot or straight on, for 1 s.
pub fn rover(changing: bool, turning: bool, mu: f64, h: f64) -> Scene {
    let kind = if changing { "changing" } else { "constant" };
    let way = if turning { "turning" } else { "straight" };
    let name = format!("rover {way}, {kind} speeds, μ {mu}, {:.0} Hz", 1.0 / h);
    own(name, [h, 1.0], 1e-8, move || {
        let mut model = robot("examples/rover.urdf", |_| {});
        for link in &mut model.links {
            link.friction = mu;
        }
        if let Some(ground) = &mut model.world.ground {
            ground.friction = mu;
        }
        let wheels: Vec<(usize, f64)> = model
            .actuators
            .iter()
            .enumerate()
            .filter_map(|(a, actuator)| {
                let name = &model.joints[actuator.joint.index()].name;
                let side = if name.starts_with("left") && turning {
                    -1.0
                } else {
                    1.0
                };
                name.contains("wheel").then_some((a, side))
            })
            .collect();
        let command = move |s: &mut Simulation, t: f64| {
            let swing = if changing {
                0.2 * libm::sin(12.0 * t)
            } else {
                0.0
            };
            for &(a, side) in &wheels {
                let slot = InputSlot::Velocity(ActuatorId::from(a));
                s.set_input(slot, 10.0 * side * (1.0 + swing));
            }
        };
        (model, Box::new(command) as Command)
    })
}

/// The quadruped with every joint's velocity at 0.3 sin(12 t + i) rad/s, for half a second.
pub fn quadruped(h: f64) -> Scene {
    let name = format!("quadruped, velocities 0.3 sin(12t+i), {:.0} Hz", 1.0 / h);
    own(name, [h, 0.5], 1e-8, || {
        let mut model = robot("examples/quadruped.urdf", in_mode(ActuatorMode::Velocity));
        for (joint, q) in model.joints.iter().zip(&mut model.initial.joint_positions) {
            if joint.name.contains("thigh") {
                *q = 0.8;
            } else if joint.name.contains("calf") {
                *q = -1.6;
            }
        }
        // Two links of 0.2 m, bent, and a foot of some centimetres.
        model.roots[0].position.z = 0.4 * libm::cos(0.8) + 0.021;
        let command = swaying(&model, InputSlot::Velocity, [0.3, 12.0]);
        (model, command)
    })
}

/// Sets the input `slot` of actuator `i` to `size sin(rate t + i)`, for all of them.
fn swaying(model: &Model, slot: fn(ActuatorId) -> InputSlot, [size, rate]: [f64; 2]) -> Command {
    let count = model.actuators.len();
    Box::new(move |s: &mut Simulation, t: f64| {
        for a in 0..count {
            let value = size * libm::sin(rate * t + a as f64);
            s.set_input(slot(ActuatorId::from(a)), value);
        }
    })
}

/// The humanoid with every joint's pd target at 0.2 sin(6 t + i) rad, for a quarter of a second.
pub fn humanoid(h: f64) -> Scene {
    let name = format!("humanoid, pd targets 0.2 sin(6t+i), {:.0} Hz", 1.0 / h);
    own(name, [h, 0.25], 1e-7, || {
        let mut model = robot("tests/robots/humanoid.urdf", in_mode(ActuatorMode::Pd));
        for actuator in &mut model.actuators {
            (actuator.kp, actuator.kd) = (100.0, 5.0);
        }
        let command = swaying(&model, InputSlot::Position, [0.2, 6.0]);
        (model, command)
    })
}

/// 60 kg on four legs of 20 g with feet of 2 g, each leg sliding up and down and each foot along
/// x, all under pd with 3000 N/m and 30 N·s/m and targets that sway by 1 cm.
pub fn light_legs() -> Scene {
    own("light legs, 1 s".into(), [H, 1.0], 1e-7, || {
        let half = Vec3::new(0.3, 0.2, 0.1);
        let mut b = single(60.0, [1.0, 2.0, 2.6], Shape::Box { half }, 0.8);
        b.model.colliders.clear();
        for (x, y) in [(0.25, 0.15), (0.25, -0.15), (-0.25, 0.15), (-0.25, -0.15)] {
            let leg = inertia(0.02, Vec3::zeros(), [1e-4, 1e-4, 1e-6]);
            let leg = b.link(BASE, at(x, y, -0.3), Motion::Prismatic(Z), leg);
            let foot = inertia(0.002, Vec3::zeros(), [4e-7; 3]);
            let foot = b.link(leg, at(0.0, 0.0, -0.1), Motion::Prismatic(X), foot);
            b.shape(foot, Shape::Sphere { radius: 0.02 }, Pose::IDENTITY);
            b.model.links[foot.index()].friction = 0.8;
            for link in [leg, foot] {
                b.actuator(link, ActuatorMode::Pd, 1e4);
                let actuator = b.model.actuators.last_mut().expect("just added");
                (actuator.kp, actuator.kd) = (3000.0, 30.0);
            }
        }
        b.model.roots[0].position.z = 0.42;
        let command = |s: &mut Simulation, t: f64| {
            for a in 0..8 {
                // Feet sway together, legs in turn.
                let phase = if a % 2 == 0 { a as f64 } else { 0.0 };
                let slot = InputSlot::Position(ActuatorId::from(a));
                s.set_input(slot, 0.01 * libm::sin(6.0 * t + phase));
            }
        };
        (b.model, Box::new(command) as Command)
    })
}

/// 100 kg on four legs of 10 g that turn in their hips, with feet of 1 g that turn in their ankles,
/// under pd with 3000 and 30 N·m/rad and targets that sway.
pub fn swaying_legs() -> Scene {
    own("swaying light legs, 0.5 s".into(), [H, 0.5], 1e-8, || {
        let half = Vec3::new(0.3, 0.2, 0.1);
        let mut b = single(100.0, [2.0, 4.0, 5.0], Shape::Box { half }, 0.8);
        b.model.colliders.clear();
        for (x, y) in [(0.25, 0.15), (0.25, -0.15), (-0.25, 0.15), (-0.25, -0.15)] {
            let leg = inertia(0.01, Z * -0.15, [8e-5, 8e-5, 1e-6]);
            let leg = b.link(BASE, at(x, y, -0.1), Motion::Revolute(Y), leg);
            let foot = inertia(0.001, Vec3::zeros(), [2e-6; 3]);
            let foot = b.link(leg, at(0.0, 0.0, -0.3), Motion::Revolute(Y), foot);
            let sole = Vec3::new(0.04, 0.02, 0.01);
            b.shape(foot, Shape::Box { half: sole }, Pose::IDENTITY);
            b.model.links[foot.index()].friction = 0.8;
            for (link, kp, kd) in [(leg, 3000.0, 30.0), (foot, 30.0, 0.3)] {
                b.actuator(link, ActuatorMode::Pd, 1e4);
                let actuator = b.model.actuators.last_mut().expect("just added");
                (actuator.kp, actuator.kd) = (kp, kd);
            }
        }
        b.model.roots[0].position.z = 0.41;
        let command = |s: &mut Simulation, t: f64| {
            for a in 0..8 {
                // Ankles turn against hips, so that soles stay level.
                let side = if a % 2 == 0 { 0.03 } else { -0.03 };
                let slot = InputSlot::Position(ActuatorId::from(a));
                s.set_input(slot, side * libm::sin(6.0 * t));
            }
        };
        (b.model, Box::new(command) as Command)
    })
}

/// A hand of five fingers with three undamped joints and limits each, links of 0.5 to 4 g, motors
/// off, shaken: every joint starts at up to `speed` rad/s. Sees the largest energy over that of the
/// beginning, in shares of the kinetic energy then.
pub fn loose_hand(speed: f64) -> Scene {
    let simulate = move |solver| {
        let mut b = fixed();
        let mut random = Random(5);
        let palm = inertia(0.3, Vec3::zeros(), [2e-4; 3]);
        let palm = b.link(BASE, at(0.0, 0.0, 0.5), Motion::Revolute(X), palm);
        b.limits(palm, -0.5, 0.5);
        for finger in 0..5 {
            let y = 0.02 * (f64::from(finger) - 2.0);
            let mut parent = palm;
            let mut place = at(0.08, y, 0.0);
            for (mass, length) in [(4e-3, 0.04), (1.5e-3, 0.025), (5e-4, 0.02)] {
                let across = mass * length * length / 12.0;
                let along = mass * 0.006 * 0.006;
                let body = inertia(mass, X * (0.5 * length), [along, across, across]);
                parent = b.link(parent, place, Motion::Revolute(Y), body);
                b.limits(parent, 0.0, 1.6);
                place = at(length, 0.0, 0.0);
            }
        }
        for (i, joint) in b.model.initial.joint_positions.iter_mut().enumerate() {
            *joint = if i == 0 { 0.0 } else { 0.4 };
        }
        for joint in &mut b.model.initial.joint_velocities {
            *joint = random.uniform(-speed, speed);
        }
        let (mut first, mut most) = (f64::NAN, 0.0_f64);
        let energy = |s: &mut Simulation| {
            s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
        };
        let mut scale = f64::NAN;
        let mut begin = |s: &mut Simulation, t: f64| {
            if t == 0.0 {
                first = energy(s);
                scale = s.output(OutputSlot::EnergyKinetic);
            }
        };
        let mut totals = Vec::new();
        let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
            totals.push(energy(s));
            *seen = coordinates(s);
            true
        };
        let mut run = play(b.model, solver, [H, 3.0], &mut begin, &mut watch);
        for total in totals {
            most = most.max((total - first) / scale);
        }
        run.seen.push(most);
        run
    };
    let judge = |_: Solver, run: &Run| {
        let gained = if run.seen.iter().any(|x| x.is_nan()) {
            f64::NAN
        } else {
            *run.seen.last().unwrap_or(&f64::NAN)
        };
        vec![figure(
            "energy over the first, share of the kinetic",
            gained,
            1e-3,
        )]
    };
    Scene {
        name: format!("loose hand, joints at ≤ {speed} rad/s, 3 s"),
        source: "a passive robot gains no energy",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// The robots of the table.
pub fn all() -> Vec<Scene> {
    vec![
        rover(false, true, 0.5, H),
        rover(true, true, 0.5, H),
        rover(true, true, 1.0, H),
        rover(true, false, 0.5, H),
        rover(true, true, 0.5, 1e-3),
        quadruped(H),
        quadruped(1e-3),
        humanoid(H),
        light_legs(),
        swaying_legs(),
        loose_hand(20.0),
    ]
}
