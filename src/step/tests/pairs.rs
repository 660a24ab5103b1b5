//! Contacts of two named sides, as outputs say them. Expected values: statics, the law of contacts,
//! closed forms of sliding.

use super::worlds::{body, cube, depth, table, world};
use super::*;
use crate::model::{ContactPair, PairId};
use crate::simulation::Snapshot;

/// A pair of links, none for the ground.
fn pair(name: &str, first: &[Option<u32>], second: &[Option<u32>]) -> ContactPair {
    let side = |links: &[Option<u32>]| links.iter().map(|link| link.map(LinkId)).collect();
    ContactPair {
        name: name.into(),
        sides: [side(first), side(second)],
    }
}

fn vector(s: &mut Simulation, slot: impl Fn(u8) -> OutputSlot) -> Vec3 {
    Vec3::new(s.output(slot(0)), s.output(slot(1)), s.output(slot(2)))
}

fn force(s: &mut Simulation, id: u32) -> Vec3 {
    vector(s, |axis| OutputSlot::PairForce(PairId(id), axis))
}

fn point(s: &mut Simulation, id: u32) -> Vec3 {
    vector(s, |axis| OutputSlot::PairPoint(PairId(id), axis))
}

fn normal(s: &mut Simulation, id: u32) -> Vec3 {
    vector(s, |axis| OutputSlot::PairNormal(PairId(id), axis))
}

fn is_active(s: &mut Simulation, id: u32) -> bool {
    s.output(OutputSlot::PairActive(PairId(id))) > 0.5
}

fn near(found: Vec3, expected: Vec3, tolerance: f64) {
    assert!(
        (found - expected).norm() <= tolerance,
        "{found} is not {expected}"
    );
}

/// Half the width of a finger, and half the side of what [`grasp`] holds, m.
const THICK: f64 = 0.01;
const HALF: f64 = 0.05;

/// Two fingers that hold a cube of 0.5 kg in the air with 10 N each: links 1 and 2, and the cube's
/// 3. The pairs are left finger and cube, right finger and cube, both and cube, and the first one
/// the other way round.
fn grasp(step: f64) -> Simulation {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let half = Vec3::new(THICK, 0.03, 0.03);
    for side in [-1.0, 1.0] {
        let finger = b.link(
            LinkId(0),
            at(side * (HALF + THICK), 0.0, 0.0),
            Motion::Prismatic(X),
            inertia(0.1, Vec3::zeros(), [1e-4; 3]),
        );
        b.shape(finger, Shape::Box { half }, Pose::IDENTITY);
        b.actuator(finger, ActuatorMode::Effort, 20.0);
    }
    b.model.roots[0].position.z = 0.5;
    let mut model = world([b.model, cube(0.5, Vec3::new(0.0, 0.0, 0.5))]);
    model.outputs.pairs = vec![
        pair("left", &[Some(1)], &[Some(3)]),
        pair("right", &[Some(2)], &[Some(3)]),
        pair("both", &[Some(1), Some(2)], &[Some(3)]),
        pair("turned", &[Some(3)], &[Some(1)]),
    ];
    model.solver.step_size = step;
    press(model)
}

/// Lets the motors of [`grasp`] press.
fn press(model: Model) -> Simulation {
    // At rest, forces balance to 3e-4 of the tolerance.
    let mut s = start(model, 1e-4);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 10.0);
    s.set_input(InputSlot::Effort(ActuatorId(1)), -10.0);
    s
}

/// A cube that two fingers hold presses each with 10 N sideways and half its weight down: the
/// forces on it, the other way round, carry it.
#[test]
fn the_pairs_of_a_grasp_carry_the_cube_and_press_with_the_motors_force() {
    for step in [0.0, 1.0 / 240.0] {
        let mut s = grasp(step);
        run(&mut s, 2.0, 0.01);
        let weight = Vec3::new(0.0, 0.0, -0.5 * G);
        let [left, right] = [0, 1].map(|id| force(&mut s, id));
        near(left, Vec3::new(-10.0, 0.0, -0.25 * G), 1e-6);
        near(right, Vec3::new(10.0, 0.0, -0.25 * G), 1e-6);
        near(weight - left - right, Vec3::zeros(), 1e-6);
        near(force(&mut s, 2), weight, 1e-6);
        // On the faces of the cube, which has sunk into friction's springs by less than 0.1 mm.
        let middle = Vec3::from_row_slice(&s.state().physical.q[2..5]);
        for (id, side) in [(0, -1.0), (1, 1.0)] {
            let x = Vec3::new(side * HALF, 0.0, 0.0);
            let place = point(&mut s, id) - middle;
            assert!(
                (place.x - x.x).abs() < 1e-4 && place.y.abs() < 1e-6,
                "{place}"
            );
            // The finger's face is 6 cm high: friction turns the cube by nothing, as it is even.
            assert!(place.z.abs() < 1e-3, "{place}");
            near(normal(&mut s, id), Vec3::new(side, 0.0, 0.0), 1e-4);
            assert!(is_active(&mut s, id));
            assert!(s.output(OutputSlot::PairSlipSpeed(PairId(id))) < 1e-9);
        }
    }
}

/// The mean of two opposite normals points nowhere, however round-off leaves it.
#[test]
fn fingers_on_two_sides_of_a_cube_have_no_common_normal() {
    let mut model = grasp(0.0).model().clone();
    for root in &mut model.roots {
        root.rpy.z = 0.3;
    }
    let mut s = press(model);
    run(&mut s, 2.0, 0.01);
    assert_eq!(normal(&mut s, 2), Vec3::zeros());
    assert!(is_active(&mut s, 2));
    let along = Vec3::new(libm::cos(0.3), libm::sin(0.3), 0.0);
    near(normal(&mut s, 1), along, 1e-4);
}

/// Before the first step, while it falls and when it lies.
#[test]
fn the_sides_of_a_pair_feel_opposite_forces_to_the_bit() {
    let mut s = grasp(0.0);
    for step in 0..100 {
        let (force, turned) = (force(&mut s, 0), force(&mut s, 3));
        assert_eq!(force, -turned, "{step}");
        assert_eq!(normal(&mut s, 0), -normal(&mut s, 3), "{step}");
        if is_active(&mut s, 0) {
            assert_eq!(point(&mut s, 0), point(&mut s, 3), "{step}");
        }
        for slot in [
            OutputSlot::PairActive,
            OutputSlot::PairDepth,
            OutputSlot::PairSlipSpeed,
        ] {
            let [one, other] = [0, 3].map(|id| s.output(slot(PairId(id))).to_bits());
            assert_eq!(one, other, "{step}");
        }
        let time = s.time();
        s.advance_to(time + 0.003).expect("finite");
    }
    assert!(force(&mut s, 0).norm() > 9.0);
}

/// Each interface of a stack carries what is above it, at the depth of the law.
#[test]
fn the_pairs_of_a_stack_carry_the_weights_above_at_the_depths_of_the_law() {
    let cubes = [0.05, 0.15, 0.25].map(|z| cube(1.0, Vec3::new(0.0, 0.0, z)));
    let mut model = world(cubes);
    model.outputs.pairs = vec![
        pair("low", &[Some(0)], &[None]),
        pair("middle", &[Some(1)], &[Some(0)]),
        pair("high", &[Some(2)], &[Some(1)]),
        pair("apart", &[Some(2)], &[None, Some(0)]),
        pair("under", &[None], &[Some(0), Some(1), Some(2)]),
    ];
    let mut s = start(model, 1e-4);
    run(&mut s, 3.0, 0.1);
    for id in 0..3 {
        let weights = f64::from(3 - id);
        near(force(&mut s, id), Vec3::new(0.0, 0.0, weights * G), 1e-6);
        near(normal(&mut s, id), Vec3::new(0.0, 0.0, 1.0), 1e-9);
        let found = s.output(OutputSlot::PairDepth(PairId(id)));
        let expected = depth(weights);
        assert!((found - expected).abs() < 1e-9, "{id}: {found} {expected}");
        let height = 0.1 * f64::from(id);
        near(point(&mut s, id), Vec3::new(0.0, 0.0, height), 2e-4);
        assert!(is_active(&mut s, id));
    }
    // Whoever does not touch has nothing, at the origin of his first link.
    assert!(!is_active(&mut s, 3));
    assert_eq!(force(&mut s, 3), Vec3::zeros());
    assert_eq!(normal(&mut s, 3), Vec3::zeros());
    assert_eq!(s.output(OutputSlot::PairDepth(PairId(3))).to_bits(), 0);
    assert_eq!(s.output(OutputSlot::PairSlipSpeed(PairId(3))).to_bits(), 0);
    let third = vector(&mut s, |axis| OutputSlot::BasePosition(RootId(2), axis));
    assert_eq!(point(&mut s, 3), third);
    // The ground on the first side.
    near(force(&mut s, 4), Vec3::new(0.0, 0.0, -3.0 * G), 1e-6);
}

/// Trees far from each other take steps of their own; a pair sums up what each of them feels.
#[test]
fn a_side_of_bodies_far_apart_has_the_forces_of_all() {
    let cubes = [(1.0, 0.0), (2.0, 10.0)].map(|(m, x)| cube(m, Vec3::new(x, 0.0, 0.05)));
    let mut ball = body(
        1.0,
        Shape::Sphere { radius: 0.05 },
        Vec3::new(20.0, 0.0, 1.0),
    );
    ball.links[0].restitution = 0.9;
    let mut model = world(cubes.into_iter().chain([ball]));
    model.outputs.pairs = vec![pair("both", &[Some(0), Some(1)], &[None])];
    let mut s = start(model, 1e-4);
    for end in [0.5, 3.0] {
        run(&mut s, end, 0.05);
        let of_links: Vec3 = [0, 1]
            .map(|link| vector(&mut s, |axis| OutputSlot::ContactForce(LinkId(link), axis)))
            .iter()
            .sum();
        near(force(&mut s, 0), of_links, 1e-12 * G);
    }
    near(force(&mut s, 0), Vec3::new(0.0, 0.0, 3.0 * G), 1e-5);
    // The mean of the places, weighted with 1 kg and 2 kg.
    near(point(&mut s, 0), Vec3::new(20.0 / 3.0, 0.0, 0.0), 2e-4);
}

/// The force before the first step is that of the moment: a cube that lies at the depth of its
/// weight is carried.
#[test]
fn a_pair_has_its_force_before_the_first_step() {
    let at = Vec3::new(0.0, 0.0, 1.05 - depth(1.0));
    let mut model = world([table(), cube(1.0, at)]);
    model.outputs.pairs = vec![pair("on", &[Some(1)], &[Some(0)])];
    let mut s = start(model, 1e-3);
    near(force(&mut s, 0), Vec3::new(0.0, 0.0, G), 1e-6);
}

/// A block on a table loses `μ g` of its speed, and while it slides the table pulls with `μ m g`.
#[test]
fn the_slip_speed_of_a_sliding_block_is_its_own_and_friction_is_coulombs() {
    let (mu, begin) = (0.3, 0.8);
    let half = Vec3::new(0.05, 0.05, 0.005);
    let block = body(
        1.0,
        Shape::Box { half },
        Vec3::new(-0.12, 0.0, 1.005 - depth(1.0)),
    );
    let mut model = world([table(), block]);
    model.roots[1].linear_velocity.x = begin;
    for link in &mut model.links {
        link.friction = mu;
    }
    model.outputs.pairs = vec![pair("slides", &[Some(1)], &[Some(0)])];
    let mut s = start(model, 1e-5);
    for time in [0.1, 0.15, 0.2] {
        s.advance_to(time).expect("finite");
        let expected = begin - mu * G * time;
        let found = s.output(OutputSlot::PairSlipSpeed(PairId(0)));
        assert!(
            (found - expected).abs() < 2e-3,
            "{time}: {found} {expected}"
        );
        let own = s.output(OutputSlot::BaseLinearVelocity(RootId(1), 0));
        assert!((found - own).abs() < 1e-4, "{time}: {found} {own}");
    }
    let force = force(&mut s, 0);
    assert!((force.x + mu * G).abs() < 1e-2 * mu * G, "{force}");
    assert!((force.z - G).abs() < 1e-2 * G, "{force}");
}

/// A motor pulls a plank at 0.2 m/s below a block that a rail holds: that is how fast they slide,
/// whichever of the two moves.
#[test]
fn the_slip_speed_on_a_driven_plank_is_the_motors_speed() {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let plank = b.link(
        LinkId(0),
        at(0.0, 0.0, 1.0),
        Motion::Prismatic(X),
        inertia(2.0, Vec3::zeros(), [0.01; 3]),
    );
    let half = Vec3::new(0.5, 0.1, 0.01);
    b.shape(plank, Shape::Box { half }, Pose::IDENTITY);
    b.actuator(plank, ActuatorMode::Velocity, 100.0);
    // Free to move up and down alone.
    let mut rail = Builder::new(false, RigidInertia::ZERO);
    let block = rail.link(
        LinkId(0),
        at(0.0, 0.0, 1.06),
        Motion::Prismatic(Vec3::z()),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
    let half = Vec3::repeat(0.05);
    rail.shape(block, Shape::Box { half }, Pose::IDENTITY);
    let mut model = world([b.model, rail.model]);
    for link in &mut model.links {
        link.friction = 0.5;
    }
    model.outputs.pairs = vec![
        pair("slides", &[Some(3)], &[Some(1)]),
        pair("turned", &[Some(1)], &[Some(3)]),
    ];
    let mut s = start(model, 1e-3);
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 0.2);
    run(&mut s, 1.0, 0.01);
    let speed = s.output(OutputSlot::JointVelocity(0u32.into_joint(), 0));
    assert!((speed - 0.2).abs() < 1e-3, "{speed}");
    for id in 0..2 {
        let found = s.output(OutputSlot::PairSlipSpeed(PairId(id)));
        assert!((found - speed).abs() < 1e-9, "{found} {speed}");
    }
    near(force(&mut s, 0), Vec3::new(0.5 * G, 0.0, G), 1e-3);
}

/// The sums of a pair belong to the state, and nothing else is remembered.
#[test]
fn a_restored_state_goes_on_with_the_same_bits_of_a_pairs_impulse() {
    for step in [0.0, 1.0 / 240.0] {
        let mut s = grasp(step);
        run(&mut s, 0.05, 0.01);
        assert!(s.state().stepping.pair_impulse[0][0] < -0.05);
        let bytes = s.save().to_bytes();
        // Those of the version before had no such sums.
        let mut old = bytes.clone();
        old[4] -= 1;
        let refused = Snapshot::from_bytes(s.model(), &old).expect_err("an old state");
        assert!(refused.reason.contains("another version"), "{refused}");
        let mut other = grasp(step);
        let saved = Snapshot::from_bytes(other.model(), &bytes).expect("own bytes");
        other.restore(&saved).expect("own state");
        other.spoil();
        for id in 0..4 {
            assert_eq!(force(&mut s, id), force(&mut other, id));
        }
        for simulation in [&mut s, &mut other] {
            run(simulation, 0.3, 0.01);
        }
        assert_eq!(s.state(), other.state());
        for id in 0..4 {
            assert_eq!(force(&mut s, id), force(&mut other, id));
            assert_eq!(point(&mut s, id), point(&mut other, id));
        }
    }
}

/// Pairs only look on: whatever is named, the motion has the same bits.
#[test]
fn pairs_change_nothing_but_outputs() {
    let mut with = grasp(0.0);
    let mut model = with.model().clone();
    model.outputs.pairs.clear();
    let mut without = press(model);
    for s in [&mut with, &mut without] {
        run(s, 0.5, 0.01);
    }
    assert_eq!(with.state().physical, without.state().physical);
    assert_eq!(
        with.state().stepping.counters,
        without.state().stepping.counters
    );
    assert_eq!(
        with.state().stepping.impulse,
        without.state().stepping.impulse
    );
}
