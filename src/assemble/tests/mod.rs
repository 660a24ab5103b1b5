//! Robots described in code, assembled.

use super::testing::*;
use crate::diagnostic::Severity;
use crate::geometry::Shape;
use crate::model::{
    ActuatorId, ActuatorMode, Body, BodyId, JointId, JointKind, Limits, LinkId, Model, Motion,
};
use crate::simulation::{InputSlot, OutputSlot, Simulation};
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3};
use crate::urdf::{Description, JointDescription, LinkDescription};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use JointKind::{Continuous, Fixed, Floating, Planar, Prismatic, Revolute, Spherical};

mod actuators;
mod base;
mod bodies;
mod idle;
mod inertia;
mod initial;
mod loops;
mod mimic;
mod objects;
mod outputs;
mod pairs;
mod robot;
mod sink;
mod terrain;
mod touch;
mod world;

/// Whether a robot that is set down stands at a height: it sinks by up to the penetration of a
/// single corner.
fn sunk(z: f64, touching: f64) -> bool {
    z < touching && touching - z < 1.01e-4
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * (1.0 + b.abs())
}

fn body_of<'m>(model: &'m Model, joint: &str) -> &'m Body {
    let joint = model
        .joints
        .iter()
        .find(|j| j.name == joint)
        .expect("the joint");
    &model.bodies[joint.bodies[0].index()]
}

/// A box on two wheels and a caster fork, as robots are.
fn cart() -> Description {
    robot(body("chassis", 5.0))
        .with(
            "chassis",
            "left",
            Continuous,
            at(0.0, 0.2, -0.1),
            body("left_wheel", 1.0),
        )
        .with(
            "chassis",
            "right",
            Continuous,
            at(0.0, -0.2, -0.1),
            body("right_wheel", 1.0),
        )
        .with(
            "chassis",
            "mast",
            Fixed,
            at(0.0, 0.0, 0.5),
            frame("mast_link"),
        )
        .with(
            "mast_link",
            "camera",
            Fixed,
            at(0.1, 0.0, 0.0),
            mass("camera_link", 0.5),
        )
}

#[test]
fn what_was_built_can_be_simulated() {
    let all = cart()
        .with("chassis", "p", Planar, at(0.0, 0.0, 1.0), mass("puck", 1.0))
        .with("puck", "f", Floating, at(0.0, 0.0, 1.0), body("drone", 1.0))
        .with(
            "drone",
            "m",
            Revolute,
            at(0.0, 0.0, 0.1),
            mass("rotor", 0.1),
        )
        .mimicking("left", 2.0, 0.1)
        .and(|j| j.limits = None);
    let mut simulation = Simulation::new(Arc::new(model(&all, "")));
    simulation.initialize(0.0).expect("a legal start");
    simulation.advance_to(0.05).expect("finite");
}
