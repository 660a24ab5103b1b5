//! What touches itself, or what it holds, in space: Newton's third law. Momenta stay what they are
//! in both kinds of step, however roughly contacts are resolved.

use super::worlds::{body, books, world};
use super::*;

/// A body of 10 kg in space, with arms that end in boxes: each hangs on a hinge about the y axis at
/// a place, m, reaches forwards, and begins with an angle, rad, and a velocity, rad/s.
fn with_arms(arms: &[([f64; 3], f64, f64)]) -> Builder {
    let mut b = Builder::new(
        true,
        inertia(10.0, Vec3::new(0.0, 0.0, 0.05), [0.4, 0.3, 0.2]),
    );
    let half = Vec3::new(0.1, 0.1, 0.2);
    b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
    for (place, angle, velocity) in arms {
        let [x, y, z] = *place;
        let arm = b.link(
            LinkId(0),
            at(x, y, z),
            Motion::Revolute(Vec3::y()),
            inertia(1.5, Vec3::new(0.25, 0.0, 0.0), [0.002, 0.03, 0.03]),
        );
        let half = Vec3::new(0.06, 0.04, 0.02);
        b.shape(arm, Shape::Box { half }, at(0.45, 0.0, 0.0));
        b.actuator(arm, ActuatorMode::Effort, 30.0);
        let joint = b.model.initial.joint_positions.len() - 1;
        b.model.initial.joint_positions[joint] = *angle;
        b.model.initial.joint_velocities[joint] = *velocity;
    }
    b.model.roots[0].self_collision = true;
    b.model.roots[0].angular_velocity = Vec3::new(0.4, -0.7, 0.9);
    b.model.roots[0].linear_velocity = Vec3::new(0.3, 0.2, -0.1);
    b
}

/// Arms above each other clap: they meet at 2.4 m/s and are pressed on each other.
fn clap() -> (Model, Vec<f64>) {
    let b = with_arms(&[
        ([0.1, 0.0, 0.25], -0.3, 3.0),
        ([0.1, 0.01, 0.05], 0.3, -3.0),
    ]);
    (b.model, vec![4.0, -4.0])
}

/// Two hands come down on two knees that come up.
fn hands_on_knees() -> (Model, Vec<f64>) {
    let b = with_arms(&[
        ([0.1, 0.12, 0.2], -0.4, 1.0),
        ([0.1, -0.12, 0.2], -0.3, 0.0),
        ([0.1, 0.13, -0.2], 0.1, 0.0),
        ([0.1, -0.11, -0.2], 0.0, -1.0),
    ]);
    (b.model, vec![6.0, 5.0, -3.0, -4.0])
}

/// Two fingers close on a ball that spins and comes along beside their middle.
fn ball_in_a_gripper() -> (Model, Vec<f64>) {
    let mut b = Builder::new(true, inertia(2.0, Vec3::zeros(), [0.02; 3]));
    let half = Vec3::new(0.01, 0.03, 0.05);
    for side in [-1.0, 1.0] {
        let finger = b.link(
            LinkId(0),
            at(side * 0.06, 0.0, 0.1),
            Motion::Prismatic(Vec3::x()),
            inertia(0.2, Vec3::zeros(), [1e-4; 3]),
        );
        b.shape(finger, Shape::Box { half }, Pose::IDENTITY);
        b.actuator(finger, ActuatorMode::Effort, 20.0);
    }
    b.model.roots[0].angular_velocity = Vec3::new(0.0, 0.5, 0.8);
    let mut ball = body(
        0.3,
        Shape::Sphere { radius: 0.03 },
        Vec3::new(0.005, 0.01, 0.12),
    );
    ball.roots[0].linear_velocity = Vec3::new(0.1, -0.05, -0.1);
    ball.roots[0].angular_velocity = Vec3::new(8.0, -3.0, 5.0);
    (world([b.model, ball]), vec![8.0, -8.0])
}

/// Largest change of the linear and the angular momentum about the common centre of mass in a
/// second, N·s and N·m·s, and the momenta that they are to be compared with: the largest of any
/// body. Commands last for a third of the time and turn round in the last one.
fn changes(model: Model, efforts: &[f64], [tolerance, step]: [f64; 2]) -> [f64; 4] {
    let mut model = model;
    model.world.gravity = Vec3::zeros();
    model.world.ground = None;
    model.solver.step_size = step;
    let mut s = start(model, tolerance);
    let (turned, moved, _) = books(&s);
    let (mut worst, mut largest, mut touched) = ([0.0_f64; 2], [0.0_f64; 2], false);
    for i in 1..=240 {
        for (a, effort) in efforts.iter().enumerate() {
            let share = [1.0, 0.0, -0.5][(i - 1) / 80];
            s.set_input(InputSlot::Effort(a.into()), share * effort);
        }
        s.advance_to(i as f64 / 240.0).expect("finite");
        let (angular, linear, _) = books(&s);
        worst[0] = worst[0].max((linear - moved).norm());
        worst[1] = worst[1].max((angular - turned).norm());
        let mut kin = crate::kinematics::Kinematics::new(s.tree());
        kin.update_poses(s.tree(), &s.state().physical.q);
        kin.update_velocities(s.tree(), &s.state().physical.v);
        for (I, V) in kin.I.iter().zip(&kin.V) {
            let p = I.mul(V);
            let norm = |p: &[f64]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
            largest[0] = largest[0].max(norm(&p[3..]));
            largest[1] = largest[1].max(norm(&p[..3]));
        }
        let forces = (0..s.model().links.len()).map(LinkId::from);
        touched |= forces
            .into_iter()
            .any(|l| s.output(OutputSlot::ContactForce(l, 0)) != 0.0);
    }
    assert!(touched, "nothing has touched anything");
    [worst[0], worst[1], largest[0], largest[1]]
}

/// To 1e-9 of the momentum of the body that has most of it. Without what the bases take up of it
/// (`step/flight.rs`), a clap changed the angular momentum by parts of a thousand.
#[test]
fn what_claps_and_holds_in_space_keeps_its_momenta() {
    for (name, (model, efforts)) in [
        ("clap", clap()),
        ("hands on knees", hands_on_knees()),
        ("ball in a gripper", ball_in_a_gripper()),
    ] {
        for way in [[1e-3, 0.0], [1e-5, 0.0], [1e-3, 1.0 / 240.0], [1e-3, 1e-3]] {
            let [linear, angular, p, L] = changes(model.clone(), &efforts, way);
            let what = format!("{name}, {way:?}");
            assert!(linear < 1e-9 * p, "{what}: {linear:e} of {p}");
            assert!(angular < 1e-9 * L, "{what}: {angular:e} of {L}");
        }
    }
}
