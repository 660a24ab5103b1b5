//! The acceptance cases: physics against closed forms, standards and independent programs.
//!
//! Each case has a label (A: no contact, B: joints and motors, C: one contact, D: whole robots),
//! and each claim of a case prints a row of the table in `docs/acceptance.md`; the command that
//! makes the table stands there.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(
    clippy::doc_markdown,
    reason = "formulas and names of programs, as in their sources"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use claim::{hold, hold_or_say};
use std::sync::Arc;
use testing::{Builder, at, inertia, random, run, start};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{ActuatorId, ActuatorMode, Ground, JointId, LinkId, Model, Motion};
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, Simulation};
use urdf2fmu_core::spatial::{Mat3, Pose, RigidInertia, Vec3, rotation_from_quaternion};
use urdf2fmu_core::tuning::Rules;
// Where the models of the unit tests look for them.
use urdf2fmu_core::{geometry, model, range, simulation, spatial};

mod bodies;
mod bounce;
#[allow(dead_code, missing_docs, reason = "shared with a bench")]
mod campaign;
mod claim;
mod extremes;
mod free;
mod joints;
mod repeat;
mod robots;
mod roll;
mod rows;
#[path = "../scenes/mod.rs"]
#[allow(dead_code, missing_docs, reason = "shared with a bench")]
mod scenes;
mod slide;
#[path = "../../src/testing.rs"]
#[allow(dead_code, missing_docs, reason = "shared with the unit tests")]
mod testing;

const G: f64 = 9.81;
const X: Vec3 = Vec3::new(1.0, 0.0, 0.0);
const Y: Vec3 = Vec3::new(0.0, 1.0, 0.0);
const Z: Vec3 = Vec3::new(0.0, 0.0, 1.0);
const BASE: LinkId = LinkId(0);
/// Round-off of some hundred steps, each of which is off by a unit in the last place of a quantity
/// of the size one: the target of what is exact but for that.
const ROUND_OFF: f64 = 500.0 * f64::EPSILON;

/// Claims about rest hold by construction where a robot at rest is left where it is, and those
/// about momentum where the base is given what steps have lost: they are measured without that
/// rule, too. Rules and name of each measurement.
const REST: [(Rules, &str); 2] = [
    (Rules::ALL, ""),
    (
        Rules {
            rest: false,
            ..Rules::ALL
        },
        ", rest detection off",
    ),
];
/// The same for momentum.
const MOMENTUM: [(Rules, &str); 2] = [
    (Rules::ALL, ""),
    (
        Rules {
            momentum: false,
            ..Rules::ALL
        },
        ", momentum not restored",
    ),
];

/// A base that does not move and has no inertia: something to hang joints on.
fn fixed() -> Builder {
    Builder::new(false, RigidInertia::ZERO)
}

/// A plane with Coulomb friction alone.
fn ground(mu: f64) -> Ground {
    Ground {
        friction: mu,
        restitution: 0.0,
        static_excess: 0.0,
        rolling_friction: 0.0,
        torsional_friction: 0.0,
    }
}

/// A floating body of `mass` with one shape on a ground of the same friction.
fn single(mass: f64, diagonal: [f64; 3], shape: Shape, mu: f64) -> Builder {
    let mut b = Builder::new(true, inertia(mass, Vec3::zeros(), diagonal));
    b.shape(BASE, shape, Pose::IDENTITY);
    b.model.links[0].friction = mu;
    b.model.world.ground = Some(ground(mu));
    b.model.outputs.external_wrenches = vec![BASE];
    b
}

/// A cube of 1 kg with edges of 0.2 m that stands in equilibrium.
fn block(mu: f64) -> Builder {
    let half = Vec3::new(0.1, 0.1, 0.1);
    let mut b = single(1.0, [0.04 / 6.0; 3], Shape::Box { half }, mu);
    b.model.roots[0].position.z = 0.1 - 0.5 * b.model.contact.penetration;
    b
}

/// A ball of 1 kg and 0.1 m that rests in equilibrium: its one point carries what the stiffness
/// spreads over four.
fn ball(mu: f64) -> Builder {
    let mut b = single(1.0, [4e-3; 3], Shape::Sphere { radius: 0.1 }, mu);
    b.model.roots[0].position.z = 0.1 - 0.5 * b.model.contact.penetration;
    b
}

/// Gravity as on a slope of `angle`, falling along +x.
fn slope(angle: f64) -> Vec3 {
    Vec3::new(libm::sin(angle), 0.0, -libm::cos(angle)) * G
}

/// Orientation of a floating base, or of the spherical body whose quaternion stands at `place` in
/// `q`.
fn rotation(simulation: &Simulation, place: usize) -> Mat3 {
    let q = &simulation.state().physical.q;
    rotation_from_quaternion(&[q[place], q[place + 1], q[place + 2], q[place + 3]])
}

fn vector(from: &[f64]) -> Vec3 {
    Vec3::new(from[0], from[1], from[2])
}

fn energy(simulation: &mut Simulation) -> f64 {
    simulation.output(OutputSlot::EnergyKinetic) + simulation.output(OutputSlot::EnergyPotential)
}

/// Vertical contact force on all links, N, mean over the last communication step.
fn carried(simulation: &mut Simulation) -> f64 {
    let links = simulation.model().links.len();
    (0..links)
        .map(|l| simulation.output(OutputSlot::ContactForce(LinkId::from(l), 2)))
        .sum()
}
