//! Loops that hold nothing: both ends are on the axis of the joint between their links.

use super::*;
use crate::closure::testing::{add, ends_at};
use crate::model::{LoopId, LoopKind};

/// A door at the end of an arm of two joints, at any attitude, its motors, and where its axis is.
fn door(seed: u64) -> (Model, Pose) {
    let mut random = Random(seed);
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let mut link = LinkId(0);
    for last in [false, false, true] {
        let place = Pose::from_xyz_rpy(random.vector(1.0), random.vector(1.5));
        let axis = if last { Vec3::z() } else { random.unit() };
        let body = inertia(10.0, random.vector(0.4), [1.0, 1.2, 1.4]);
        link = b.link(link, place, Motion::Revolute(axis), body);
        b.actuator(link, ActuatorMode::Effort, 50.0);
    }
    b.model.initial.joint_positions = (0..3).map(|_| random.uniform(-1.0, 1.0)).collect();
    b.model.initial.joint_velocities = (0..3).map(|_| random.uniform(-1.0, 1.0)).collect();
    // Along the axis, and turned about it.
    let end = Pose::from_xyz_rpy(
        Vec3::z() * random.uniform(0.2, 1.0),
        Vec3::z() * random.uniform(-3.0, 3.0),
    );
    (b.model, end)
}

/// Adds what holds nothing between the last two links.
fn hang(model: &mut Model, end: Pose, kind: &str) {
    let links = [LinkId(3), LinkId(2)].map(Some);
    let q = model.initial.joint_positions.clone();
    let mut ends = ends_at(model, &q, links, end);
    ends.reverse();
    let kind = match kind {
        "ball" => LoopKind::Ball(ends),
        "hinge" => LoopKind::Hinge(ends),
        _ => {
            let along = ends[1].X_LA.R.column(2) * 0.3;
            ends[1].X_LA.p += along;
            LoopKind::Distance { ends, length: 0.3 }
        }
    };
    add(model, kind);
}

/// Runs for a second; returns all positions on the way.
fn way(s: &mut Simulation) -> Vec<f64> {
    for (motor, effort) in (0..3).map(ActuatorId).zip([20.0, -15.0, 2.0]) {
        s.set_input(InputSlot::Effort(motor), effort);
    }
    let mut found = Vec::new();
    for i in 1..=10 {
        s.advance_to(0.1 * f64::from(i)).expect("finite");
        found.extend_from_slice(&s.state().physical.q);
    }
    found
}

/// The joints move as without the loop, which has no force: a second pin on the axis of a door, or
/// a rod along it.
#[test]
fn a_loop_on_the_axis_of_a_joint_holds_nothing() {
    for seed in 0..24 {
        let (model, end) = door(seed);
        let expected = way(&mut start(model.clone(), 1e-6));
        for kind in ["ball", "hinge", "distance"] {
            let mut model = model.clone();
            hang(&mut model, end, kind);
            let mut s = start(model, 1e-6);
            for (a, b) in way(&mut s).iter().zip(&expected) {
                assert!((a - b).abs() < 1e-9, "{seed} {kind}: {a} {b}");
            }
            for axis in 0..3 {
                let force = s.output(OutputSlot::LoopForce(LoopId(0), axis));
                let torque = s.output(OutputSlot::LoopTorque(LoopId(0), axis));
                let felt = force.abs() + torque.abs();
                assert!(felt < 1e-12, "{seed} {kind}: {force} {torque}");
            }
            assert!(s.output(OutputSlot::LoopGap(LoopId(0))) < 1e-12);
        }
    }
}
