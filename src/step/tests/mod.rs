//! Properties of the step for any motion. Comparisons with closed forms are in `tests/acceptance`.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::Shape;
use crate::model::{ActuatorId, ActuatorMode, LinkId, Model, Motion, RootId};
use crate::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation};
use crate::spatial::{Pose, RigidInertia, Vec3};
use crate::testing::{Builder, Random, at, inertia, random_tree, run, shape_all_links, start};

mod agreement;
mod cans;
mod chains;
mod collisions;
mod deep;
mod discs;
mod driven;
mod dropped;
mod ends;
mod fine;
mod fixed;
mod flush;
mod frames;
mod free;
mod hills;
mod idle;
mod impacts;
mod inputs;
mod islands;
mod joints;
mod kept;
mod landings;
mod listed;
mod loops;
mod machines;
mod mechanisms;
mod momentum;
mod motors;
mod moving_ground;
mod order;
mod pairs;
mod plates;
mod properties;
mod ratios;
mod regions;
mod rims;
mod rolling;
mod seams;
mod servos;
mod shares;
mod sliding;
mod springs;
mod standing;
mod sticking;
mod swings;
mod terrain;
mod tops;
mod turning;
mod whips;
mod worlds;

const G: f64 = 9.81;
const X: Vec3 = Vec3::new(1.0, 0.0, 0.0);
const Y: Vec3 = Vec3::new(0.0, 1.0, 0.0);

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
    b.model.roots[0].position.z = 0.1;
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

/// The same with a pendulum of 0.5 kg on it.
fn cart_with_pendulum() -> (Builder, LinkId) {
    let (mut b, cart) = cart();
    b.link(
        cart,
        Pose::IDENTITY,
        Motion::Revolute(Y),
        inertia(0.5, X * 0.4, [0.01; 3]),
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
