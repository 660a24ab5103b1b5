//! The step from inside: what must hold whatever moves. Physics against closed forms: `tests/acceptance`.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::Shape;
use crate::model::{ActuatorId, ActuatorMode, LinkId, Model, Motion};
use crate::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation};
use crate::spatial::{Pose, RigidInertia, Vec3};
use crate::testing::{Builder, Random, inertia, random_tree, shape_all_links};
use std::sync::Arc;

mod free;
mod inputs;
mod joints;
mod motors;
mod order;
mod properties;
mod turning;

const G: f64 = 9.81;
const X: Vec3 = Vec3::new(1.0, 0.0, 0.0);
const Y: Vec3 = Vec3::new(0.0, 1.0, 0.0);

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose {
        p: Vec3::new(x, y, z),
        ..Pose::IDENTITY
    }
}

/// A running simulation with a tolerance.
fn start(mut model: Model, tolerance: f64) -> Simulation {
    model.solver.tolerance = tolerance;
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.initialize(0.0).expect("a sound model");
    simulation
}

/// Advances to `end` in steps of `h`, the last one landing on `end`.
fn run(simulation: &mut Simulation, end: f64, h: f64) {
    let begin = simulation.time();
    let count = ((end - begin) / h).round() as u64;
    for i in 1..=count {
        simulation
            .advance_to(begin + (end - begin) * (i as f64 / count as f64))
            .expect("finite");
    }
}

/// A block of `mass` with corners ±0.1 on the ground, its base at z = 0.1.
fn block(mass: f64, mu: f64) -> Builder {
    let i = mass * (0.2 * 0.2 + 0.2 * 0.2) / 12.0;
    let mut b = Builder::new(true, inertia(mass, Vec3::zeros(), [i; 3]));
    b.shape(
        0u32.into_link(),
        Shape::Box {
            half: Vec3::new(0.1, 0.1, 0.1),
        },
        Pose::IDENTITY,
    );
    b.model.initial.position.z = 0.1;
    b.model.links[0].friction = mu;
    b.model.world.ground = Some(crate::model::Ground {
        friction: mu,
        ..Default::default()
    });
    b
}

/// A mass of 1 kg on a rail along x; builder and link.
fn cart() -> (Builder, LinkId) {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let cart = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
    (b, cart)
}

trait IntoLink {
    fn into_link(self) -> LinkId;
}
impl IntoLink for u32 {
    fn into_link(self) -> LinkId {
        LinkId(self)
    }
}

/// Gravity as on a slope of `angle`, falling along +x.
fn slope(angle: f64) -> Vec3 {
    Vec3::new(libm::sin(angle), 0.0, -libm::cos(angle)) * G
}

trait IntoJoint {
    fn into_joint(self) -> crate::model::JointId;
}
impl IntoJoint for u32 {
    fn into_joint(self) -> crate::model::JointId {
        crate::model::JointId(self)
    }
}
