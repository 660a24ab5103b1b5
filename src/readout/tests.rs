//! Contact outputs. Expected values: statics, load transfer of a sliding body, geometry.

use crate::assemble::testing::{at, body, collision, frame, mass, model, robot};
use crate::geometry::Shape;
use crate::model::JointKind::{Continuous, Fixed};
use crate::model::{LinkId, RootId};
use crate::simulation::{OutputSlot, Simulation};
use crate::spatial::Vec3;
use crate::urdf::{Description, LinkDescription};
use std::sync::Arc;

const G: f64 = 9.81;

/// Height of [`plate`], m.
const HEIGHT: f64 = 0.1;

fn start(description: &Description, settings: &str) -> Simulation {
    let settings = format!("outputs.contact_points = true\n{settings}");
    let mut simulation = Simulation::new(Arc::new(model(description, &settings)));
    simulation.initialize(0.0).expect("a legal start");
    simulation
}

/// A box of 0.4 m × 0.4 m.
fn plate(name: &str, m: f64) -> LinkDescription {
    let shape = Shape::Box {
        half: Vec3::new(0.2, 0.2, 0.5 * HEIGHT),
    };
    LinkDescription {
        inertial: Some(shape.solid_inertia(m)),
        collisions: vec![collision(at(0.0, 0.0, 0.0), shape)],
        ..frame(name)
    }
}

fn vector(s: &mut Simulation, slot: impl Fn(u8) -> OutputSlot) -> Vec3 {
    Vec3::new(s.output(slot(0)), s.output(slot(1)), s.output(slot(2)))
}

fn force(s: &mut Simulation, link: usize) -> Vec3 {
    vector(s, |axis| OutputSlot::ContactForce(LinkId::from(link), axis))
}

fn point(s: &mut Simulation, link: usize) -> Vec3 {
    vector(s, |axis| OutputSlot::ContactPoint(LinkId::from(link), axis))
}

fn near(found: Vec3, expected: Vec3, tolerance: f64) {
    assert!(
        (found - expected).norm() <= tolerance,
        "{found} is not {expected}"
    );
}

/// Whatever stands still is supported below its centre of mass.
#[test]
fn the_contact_point_of_a_standing_box_lies_below_its_load() {
    let loaded = robot(plate("plate", 2.0)).with(
        "plate",
        "mast",
        Fixed,
        at(0.12, -0.06, 0.3),
        mass("load", 1.0),
    );
    let mut s = start(&loaded, "");
    s.advance_to(3.0).expect("finite");
    let base = vector(&mut s, |axis| OutputSlot::BasePosition(RootId::ROBOT, axis));
    // The middle of the masses, in the plate; the plate tilts by less than 1e-3 rad.
    let found = point(&mut s, 0) - base;
    near(found, Vec3::new(0.04, -0.02, -0.5 * HEIGHT), 2e-4);
    near(force(&mut s, 0), Vec3::new(0.0, 0.0, 3.0 * G), 1e-6);
}

/// Friction `μ m g` at the ground turns a box about its middle at half its height; the normal force
/// undoes this with an arm of `μ` times half the height.
#[test]
fn the_contact_point_of_a_sliding_box_runs_ahead() {
    let settings = "initial.linear_velocity = [2, 0, 0]\nlink.plate.friction = 0.3\n\
                    world.ground = { type = \"plane\", friction = 0.3 }\n";
    let mut s = start(&robot(plate("plate", 2.0)), settings);
    s.advance_to(0.4).expect("finite");
    let base = vector(&mut s, |axis| OutputSlot::BasePosition(RootId::ROBOT, axis));
    let speed = s.output(OutputSlot::BaseLinearVelocity(RootId::ROBOT, 0));
    assert!((speed - (2.0 - 0.3 * G * 0.4)).abs() < 1e-2, "{speed}");
    let ahead = point(&mut s, 0).x - base.x;
    assert!((ahead - 0.3 * 0.5 * HEIGHT).abs() < 2e-4, "{ahead}");
}

#[test]
fn the_contact_point_of_a_rolling_ball_stays_below_its_middle() {
    let mut s = start(
        &robot(body("ball", 1.0)),
        "initial.linear_velocity = [1, 0.5, 0]\n",
    );
    s.advance_to(1.5).expect("finite");
    let base = vector(&mut s, |axis| OutputSlot::BasePosition(RootId::ROBOT, axis));
    assert!(base.x > 0.5, "{base}");
    near(point(&mut s, 0), Vec3::new(base.x, base.y, 0.0), 2e-4);
}

#[test]
fn the_contact_point_of_a_link_in_the_air_is_its_origin() {
    let winged = robot(body("ball", 1.0)).with(
        "ball",
        "shoulder",
        Continuous,
        at(0.3, 0.0, 0.2),
        body("wing", 0.1),
    );
    let mut s = start(&winged, "initial.xyz = [0.5, 0.25, 2]\n");
    for time in [0.0, 0.3] {
        if time > 0.0 {
            s.advance_to(time).expect("finite");
        }
        let base = vector(&mut s, |axis| OutputSlot::BasePosition(RootId::ROBOT, axis));
        near(point(&mut s, 0), base, 1e-15);
        let wing = vector(&mut s, |axis| OutputSlot::LinkPosition(LinkId(1), axis));
        near(point(&mut s, 1), wing, 1e-15);
        near(force(&mut s, 1), Vec3::zeros(), 0.0);
    }
}

#[test]
fn a_welded_foot_has_its_own_contact_force() {
    // The foot is part of the shank's body, and it is what stands on the ground.
    let leg = robot(body("shank", 2.0)).with(
        "shank",
        "ankle",
        Fixed,
        at(0.05, 0.0, -0.5),
        plate("foot", 1.0),
    );
    let mut s = start(&leg, "");
    s.advance_to(2.0).expect("finite");
    near(force(&mut s, 0), Vec3::zeros(), 0.0);
    near(force(&mut s, 1), Vec3::new(0.0, 0.0, 3.0 * G), 1e-6);
    let active = [0, 1].map(|link| s.output(OutputSlot::ContactActive(LinkId(link))));
    assert!(active[0] < 0.5 && active[1] > 0.5, "{active:?}");
}

#[test]
fn the_contact_point_continues_from_a_saved_state() {
    let mut s = start(
        &robot(plate("plate", 2.0)),
        "initial.linear_velocity = [2, 1, 0]\n",
    );
    s.advance_to(0.1).expect("finite");
    let saved = s.save();
    let before = point(&mut s, 0);
    s.advance_to(0.15).expect("finite");
    assert!((point(&mut s, 0) - before).norm() > 1e-3);
    s.restore(&saved).expect("its own state");
    assert_eq!(point(&mut s, 0), before);
}
