//! Expected values: the equation of motion of a rod that turns about its end, statics.

use crate::closure::testing::anchor;
use crate::model::{ActuatorId, ActuatorMode, LinkId, LoopKind, Model, Motion};
use crate::simulation::{InputSlot, OutputSlot, Simulation};
use crate::spatial::{Pose, RigidInertia, Vec3};
use crate::testing::{Builder, at, inertia, start};

const G: f64 = 9.81;
const TICK: f64 = 1.0 / 240.0;

/// A rod along x, about its end.
fn rod(mass: f64, length: f64) -> RigidInertia {
    let across = mass * length * length / 12.0;
    inertia(mass, Vec3::x() * (0.5 * length), [1e-4, across, across])
}

fn begun(mut model: Model, tolerance: f64, step: f64) -> Simulation {
    model.solver.step_size = step;
    start(model, tolerance)
}

/// A rod that a velocity motor of so much effort, N·m, turns about a fixed axis, and its link.
fn turned(effort: f64, tolerance: f64, step: f64) -> (Simulation, LinkId) {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let turn = Motion::Revolute(Vec3::y());
    let link = b.link(LinkId(0), Pose::IDENTITY, turn, rod(0.5, 0.4));
    b.actuator(link, ActuatorMode::Velocity, effort);
    (begun(b.model, tolerance, step), link)
}

fn read(s: &mut Simulation, link: LinkId) -> [f64; 2] {
    let joint = s.model().links[link.index()].joint.expect("a joint");
    let slots = [
        OutputSlot::JointEffort(joint),
        OutputSlot::JointAcceleration(joint, 0),
    ];
    slots.map(|slot| s.output(slot))
}

const KINDS: [(f64, f64); 3] = [(1e-3, 0.0), (1e-5, 0.0), (1e-3, TICK)];

/// A velocity motor turns a rod evenly in the plane: it carries `½ m g l cos θ`. What it held at
/// the end of a step was what balanced the middle of the step, 0.023 N·m beside it, and where its
/// command jumped 240 times a second up to 2 N·m.
#[test]
fn the_effort_of_a_motor_is_what_its_joint_asks_for() {
    for (jumps, allowed) in [(false, 6e-3), (true, 0.3)] {
        for (tolerance, step) in KINDS {
            let (mut s, link) = turned(200.0, tolerance, step);
            let (mut worst, mut whirl) = (0.0_f64, 0.0_f64);
            for i in 0..480 {
                let t = f64::from(i) * TICK;
                let speed = if jumps {
                    7.0 * libm::cos(2.0 * t)
                } else {
                    12.0
                };
                s.set_input(InputSlot::Velocity(ActuatorId(0)), speed);
                s.advance_to(t + TICK).expect("finite");
                let theta = s.state().physical.q[0];
                let [effort, acceleration] = read(&mut s, link);
                if i > 60 {
                    let carried = -0.5 * 0.5 * G * 0.4 * libm::cos(theta);
                    worst = worst.max((effort - carried).abs());
                    whirl = whirl.max(acceleration.abs());
                }
            }
            let what = format!("{tolerance:e}, {step}, {jumps}: {worst} N·m, {whirl} rad/s²");
            assert!(worst < allowed, "{what}");
            assert!(jumps || whirl < 0.2, "{what}");
        }
    }
}

/// A boom that a stiff pd law holds carries a rod that whirls at its end. It yields by 0.2 mrad and
/// has 0.03 rad/s² then; by the forces of the moment it had 0.3 rad/s².
#[test]
fn what_a_pd_law_holds_has_the_acceleration_of_its_yielding() {
    for (tolerance, step) in KINDS {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let turn = Motion::Revolute(Vec3::y());
        let boom = b.link(LinkId(0), Pose::IDENTITY, turn, rod(2.0, 0.6));
        let rotor = b.link(boom, at(0.6, 0.0, 0.0), turn, rod(0.5, 0.4));
        b.actuator(boom, ActuatorMode::Pd, 200.0);
        b.actuator(rotor, ActuatorMode::Velocity, 200.0);
        (b.model.actuators[0].kp, b.model.actuators[0].kd) = (5e4, 500.0);
        let mut s = begun(b.model, tolerance, step);
        s.set_input(InputSlot::Velocity(ActuatorId(1)), 12.0);
        let mut worst = 0.0_f64;
        for i in 1..480 {
            s.advance_to(f64::from(i) * TICK).expect("finite");
            let [_, acceleration] = read(&mut s, boom);
            if i > 240 {
                worst = worst.max(acceleration.abs());
            }
        }
        assert!(worst < 0.06, "{tolerance:e}, {step}: {worst} rad/s²");
    }
}

/// A motor gives no more than its effort, nor more than its torque–speed line: what the end of a
/// step makes of its force is not added there.
#[test]
fn a_motor_at_its_limit_gives_what_it_can() {
    for (tolerance, step) in KINDS {
        let (mut s, link) = turned(0.9, tolerance, step);
        for i in 0..480 {
            let t = f64::from(i) * TICK;
            s.set_input(
                InputSlot::Velocity(ActuatorId(0)),
                7.0 * libm::cos(20.0 * t),
            );
            s.advance_to(t + TICK).expect("finite");
            let [effort, _] = read(&mut s, link);
            assert!(effort.abs() <= 0.9, "{tolerance:e}, {step}: {effort} N·m");
        }
    }
}

/// A crank of 0.1 m that a velocity motor turns at 20 rad/s pushes a slider by a rod of 0.3 m. It
/// has less than 0.02 rad/s², and the slider what `x = r cos θ + √(l² − r² sin² θ)` says. By what
/// the step has done alone it had 1.5 rad/s²: after each step the loop is closed, which moves the
/// crank, and the motor brings it back in the next one. The bounds are shares of that: a
/// fifth of it for the crank, two fifths for the slider.
#[test]
fn a_crank_that_is_turned_evenly_has_no_acceleration() {
    let (r, l, omega) = (0.1_f64, 0.3_f64, 20.0_f64);
    for (tolerance, step) in KINDS {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let turn = Motion::Revolute(-Vec3::y());
        let crank = b.link(LinkId(0), Pose::IDENTITY, turn, rod(0.3, r));
        let coupler = b.link(crank, at(r, 0.0, 0.0), turn, rod(0.4, l));
        let slide = Motion::Prismatic(Vec3::x());
        let slider = inertia(0.5, Vec3::zeros(), [1e-3; 3]);
        let slider = b.link(LinkId(0), at(r + l, 0.0, 0.0), slide, slider);
        let ends = [(coupler, at(l, 0.0, 0.0)), (slider, Pose::IDENTITY)];
        let ends = ends.map(|(link, place)| anchor(Some(link), place));
        b.close(LoopKind::Ball(ends));
        b.actuator(crank, ActuatorMode::Velocity, 1000.0);
        let (mut s, mut worst) = (begun(b.model, tolerance, step), [0.0_f64; 2]);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), omega);
        for i in 1..288 {
            s.advance_to(f64::from(i) * TICK).expect("finite");
            let (sin, cos) = libm::sincos(s.state().physical.q[0]);
            let way = (l * l - r * r * sin * sin).sqrt();
            let pull = cos * cos - sin * sin + r * r * sin * sin * cos * cos / (way * way);
            let truth = -omega * omega * r * (cos + r * pull / way);
            let [[_, own], [_, other]] = [crank, slider].map(|link| read(&mut s, link));
            if i > 120 {
                worst = [worst[0].max(own.abs()), worst[1].max((other - truth).abs())];
            }
        }
        let what = format!("{tolerance:e}, {step}: {worst:?}");
        assert!(worst[0] < 0.3 && worst[1] < 0.6, "{what}");
    }
}

/// A motor that is told to go faster by 6 rad/s² turns its joint by 6 rad/s², and not evenly.
#[test]
fn a_motor_whose_command_rises_has_the_acceleration_of_its_command() {
    for (tolerance, step) in KINDS {
        let (mut s, link) = turned(200.0, tolerance, step);
        let mut worst = 0.0_f64;
        for i in 0..240 {
            let t = f64::from(i) * TICK;
            s.set_input(InputSlot::Velocity(ActuatorId(0)), 6.0 * t);
            s.set_input_derivative(InputSlot::Velocity(ActuatorId(0)), 1, 6.0);
            s.advance_to(t + TICK).expect("finite");
            let [_, acceleration] = read(&mut s, link);
            if i > 60 {
                worst = worst.max((acceleration - 6.0).abs());
            }
        }
        assert!(worst < 0.1, "{tolerance:e}, {step}: {worst} rad/s²");
    }
}
