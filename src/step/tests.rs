//! Physics against closed forms: each expected value's source stands beside it.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::Shape;
use crate::model::{ActuatorId, ActuatorMode, Model, Motion};
use crate::simulation::{InputSlot, OutputSlot, Simulation};
use crate::spatial::{Pose, Vec3};
use crate::testing::{Builder, Random, inertia, random_tree};
use std::sync::Arc;

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
        restitution: 0.0,
    });
    b
}

trait IntoLink {
    fn into_link(self) -> crate::model::LinkId;
}
impl IntoLink for u32 {
    fn into_link(self) -> crate::model::LinkId {
        crate::model::LinkId(self)
    }
}

fn height(s: &mut Simulation) -> f64 {
    s.output(OutputSlot::BasePosition(2))
}

// ---- A: no contact ----

#[test]
fn a_thrown_body_follows_the_parabola_while_it_spins() {
    let mut b = Builder::new(true, inertia(2.0, Vec3::new(0.1, 0.0, 0.0), [0.02; 3]));
    b.model.initial.angular_velocity = Vec3::new(1.0, 2.0, 3.0);
    let mut s = start(b.model, 1e-8);
    // Centre of mass: starts with ω × r.
    let v0 = Vec3::new(1.0, 2.0, 3.0).cross(&Vec3::new(0.1, 0.0, 0.0));
    run(&mut s, 10.0, 0.01);
    let R = crate::spatial::rotation_from_quaternion(&[
        s.state().q[3],
        s.state().q[4],
        s.state().q[5],
        s.state().q[6],
    ]);
    let com = Vec3::new(s.state().q[0], s.state().q[1], s.state().q[2]) + R * X * 0.1;
    let expected = X * 0.1 + v0 * 10.0 + Vec3::new(0.0, 0.0, -0.5 * G * 100.0);
    assert!(
        (com - expected).norm() < 1e-5,
        "{}",
        (com - expected).norm()
    );
}

/// Torque-free body I = (1, 2, 3), ω = (1, 1, 1): ω has the period 4 K(k² = 1/2) / √(8/6) (Landau & Lifshitz §37).
#[test]
fn a_free_asymmetric_body_has_the_period_of_jacobis_functions() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [1.0, 2.0, 3.0]));
    b.model.world.gravity = Vec3::zeros();
    b.model.initial.angular_velocity = Vec3::new(1.0, 1.0, 1.0);
    let mut s = start(b.model, 1e-8);
    run(&mut s, 6.422_703_1, 0.1);
    let R = crate::spatial::rotation_from_quaternion(&[
        s.state().q[3],
        s.state().q[4],
        s.state().q[5],
        s.state().q[6],
    ]);
    let w = R.transpose() * Vec3::new(s.state().v[0], s.state().v[1], s.state().v[2]);
    assert!((w - Vec3::new(1.0, 1.0, 1.0)).norm() < 1e-6, "{w}");
}

/// A point-like mass on a massless rod of 1 m, released from horizontal: T = 4 K(1/√2)/√(g) (`IFToMM` A01).
#[test]
fn a_pendulum_released_from_horizontal_has_the_exact_period() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Revolute(Y),
        inertia(1.0, X, [0.0; 3]),
    );
    let mut s = start(b.model, 1e-9);
    let energy = |s: &mut Simulation| {
        s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
    };
    let before = energy(&mut s);
    run(&mut s, 2.367_841_95, 0.01);
    assert!(s.state().q[0].abs() < 2e-7, "{}", s.state().q[0]);
    run(&mut s, 10.0, 0.01);
    assert!((energy(&mut s) - before).abs() < 1e-6 * G);
}

/// Two point masses, two rods of 1 m, from (π/2, π/2) at rest; values at t = 2 s of the design's case A5
/// (an independent high-order integration).
#[test]
fn a_double_pendulum_ends_where_the_reference_says() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let down = Vec3::new(0.0, 0.0, -1.0);
    let first = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Revolute(-Y),
        inertia(1.0, down, [0.0; 3]),
    );
    b.link(
        first,
        at(0.0, 0.0, -1.0),
        Motion::Revolute(-Y),
        inertia(1.0, down, [0.0; 3]),
    );
    // The second angle is measured from the vertical, the joint's from the first rod.
    b.model.initial.joint_positions = vec![std::f64::consts::FRAC_PI_2, 0.0];
    for (tolerance, allowed) in [(1e-4, 2e-4), (1e-6, 2e-6)] {
        let mut s = start(b.model.clone(), tolerance);
        run(&mut s, 2.0, 0.1);
        let q = &s.state().q;
        let (a, b) = (q[0], q[0] + q[1]);
        let error = (a + 0.482_971_53).abs().max((b + 1.324_048_71).abs());
        assert!(error < allowed, "{tolerance}: {error} ({a}, {b})");
    }
}

// ---- B: joints and motors ----

/// Cart with a force-limited velocity motor: 5.5 kg in all, wheel 0.5 kg disc R = 0.1, 0.5 N·m, 10 rad/s:
/// a = F/R/(M + I/R²) = 0.8695652 until 1 m/s, so x(3) = 1.15²·a/2 + 1.85 = 2.425.
#[test]
fn a_velocity_motor_drives_a_cart_with_its_effort_and_then_holds_its_speed() {
    let mut b = Builder::new(true, inertia(5.0, Vec3::new(0.0, 0.0, 0.0), [0.1; 3]));
    let wheel = Shape::Cylinder {
        radius: 0.1,
        half_length: 0.05,
    };
    // Two free-running wheels ahead and behind would carry the cart; here a skid-free wide wheel does: the cart is
    // kept upright by a joint to the world instead.
    b.model.bodies[0].motion = Motion::Welded;
    b.model.nq = 0;
    b.model.dofs.clear();
    b.model.links[0].inertia = crate::spatial::RigidInertia::ZERO;
    let cart = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(5.0, Vec3::zeros(), [0.1; 3]),
    );
    let lift = b.link(
        cart,
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::z()),
        inertia(1e-6, Vec3::zeros(), [1e-6; 3]),
    );
    let hub = b.link(
        lift,
        at(0.0, 0.0, 0.1),
        Motion::Revolute(Y),
        inertia(0.5, Vec3::zeros(), [0.0025, 0.0025, 0.0025]),
    );
    let turned = Pose::from_xyz_rpy(
        Vec3::zeros(),
        Vec3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0),
    );
    b.shape(hub, wheel, turned);
    b.actuator(hub, ActuatorMode::Velocity, 0.5);
    // The wheel alone presses on the ground: enough friction to carry 5 N.
    b.model.links[hub.index()].friction = 3.0;
    b.model.world.ground = Some(crate::model::Ground {
        friction: 3.0,
        restitution: 0.0,
    });
    let mut s = start(b.model, 1e-4);
    run(&mut s, 0.2, 1.0 / 240.0);
    let (x0, t0) = (s.state().q[0], s.time());
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 10.0);
    run(&mut s, t0 + 3.0, 1.0 / 240.0);
    let x = s.state().q[0] - x0;
    assert!((x - 2.425).abs() < 5e-4, "{x}");
    let speed = s.state().v[0];
    assert!((speed - 1.0).abs() < 1e-4, "{speed}");
}

#[test]
fn a_position_servo_reaches_its_target_without_overshoot_and_holds_it_under_load() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let arm = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Revolute(Y),
        inertia(2.0, X * 0.5, [0.01, 0.1, 0.1]),
    );
    b.actuator(arm, ActuatorMode::Position, 20.0);
    b.model.joints[0].velocity = Some(2.0);
    for h in [1.0 / 1000.0, 1.0 / 240.0, 0.1] {
        let mut s = start(b.model.clone(), 1e-3);
        s.set_input(InputSlot::Position(ActuatorId(0)), 1.5);
        let (mut highest, mut fastest) = (0.0_f64, 0.0_f64);
        let count = (4.0 / h) as usize;
        for i in 1..=count {
            s.advance_to(i as f64 * h).expect("finite");
            highest = highest.max(s.state().q[0]);
            fastest = fastest.max(s.state().v[0].abs());
        }
        assert!(highest < 1.5 + 1e-3, "overshoot {}", highest - 1.5);
        assert!(fastest < 2.0 + 1e-2, "speed {fastest}");
        assert!((s.state().q[0] - 1.5).abs() < 1e-3);
        assert!(s.state().v[0].abs() < 1e-6);
    }
}

#[test]
fn a_stiff_pd_on_a_gram_is_stable_at_a_tenth_of_a_second() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let link = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1e-3, Vec3::zeros(), [1e-6; 3]),
    );
    b.actuator(link, ActuatorMode::Pd, 1e9);
    b.model.actuators[0].kp = 1e6;
    b.model.actuators[0].kd = 1e3;
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::Position(ActuatorId(0)), 0.3);
    run(&mut s, 1.0, 0.1);
    assert!((s.state().q[0] - 0.3).abs() < 1e-3);
}

#[test]
fn a_joint_limit_carries_a_static_load_at_its_stiffness() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let link = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::z()),
        inertia(2.0, Vec3::zeros(), [0.01; 3]),
    );
    b.limits(link, -0.1, 0.1);
    let mut s = start(b.model, 1e-4);
    run(&mut s, 3.0, 0.01);
    let expected = -0.1 - 2.0 * G / s.tree().limit_stiffness[0];
    assert!(
        (s.state().q[0] - expected).abs() < 1e-9,
        "{} {expected}",
        s.state().q[0]
    );
}

#[test]
fn a_mimic_joint_follows_exactly() {
    let mut random = Random(7);
    let model = random_tree(&mut random, 10, false, true);
    let mut s = start(model, 1e-4);
    run(&mut s, 1.0, 0.01);
    let model = s.model().clone();
    let mut followers = 0;
    for (id, joint) in (0..).map(crate::model::JointId).zip(&model.joints) {
        let Some(mimic) = &joint.mimic else { continue };
        let (q, source) = (
            s.output(OutputSlot::JointPosition(id, 0)),
            s.output(OutputSlot::JointPosition(mimic.joint, 0)),
        );
        assert!((q - mimic.multiplier * source - mimic.offset).abs() < 1e-15);
        followers += 1;
    }
    assert_eq!(followers, 2);
}

// ---- C: one contact ----

#[test]
fn a_ball_rests_at_its_static_penetration_and_does_not_move_again() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [4e-3; 3]));
    b.shape(
        0u32.into_link(),
        Shape::Sphere { radius: 0.1 },
        Pose::IDENTITY,
    );
    b.model.initial.position.z = 0.5;
    let mut s = start(b.model, 1e-3);
    run(&mut s, 2.0, 1.0 / 240.0);
    // One point carries what the stiffness spreads over four.
    let z = height(&mut s);
    assert!((z - (0.1 - 4e-4)).abs() < 1e-9, "{z}");
    run(&mut s, 62.0, 1.0 / 240.0);
    assert!((height(&mut s) - z).abs() < 1e-12);
    let force = s.output(OutputSlot::ContactForce(0u32.into_link(), 2));
    assert!((force - G).abs() < 1e-6 * G, "{force}");
}

/// `RaiSim` issue 55's case: μ = 0.5, 1 kg: 4.90 N holds, 4.92 N gives a = 4.92 − 4.905 = 0.015 m/s².
#[test]
fn a_block_sticks_just_below_the_cone_and_slides_just_above_it() {
    for (force, moves) in [(4.90, false), (4.92, true)] {
        let mut b = block(1.0, 0.5);
        b.model.outputs.external_wrenches = vec![0u32.into_link()];
        let mut s = start(b.model, 1e-4);
        run(&mut s, 1.0, 0.01);
        s.set_input(InputSlot::ExternalForce(0u32.into_link(), 0), force);
        // The push comes at once and gives the block 12 mm/s, which friction takes 3 s to stop at 4.90 N.
        run(&mut s, 6.0, 0.01);
        let (x0, v0) = (s.state().q[0], s.state().v[3]);
        run(&mut s, 66.0, 0.01);
        let moved = s.state().q[0] - x0;
        if moves {
            let a = (s.state().v[3] - v0) / 60.0;
            assert!((a - 0.015).abs() < 1e-6, "{a}");
        } else {
            assert!(moved.abs() < 1e-9, "{moved}");
        }
    }
}

/// v0²/(2 μ g).
#[test]
fn a_sliding_block_stops_after_the_coulomb_distance() {
    let mut b = block(1.0, 0.5);
    // Placed in equilibrium, so that the normal force is there from the start.
    b.model.initial.position.z = 0.1 - 1e-4;
    b.model.initial.linear_velocity.x = 1.0;
    let mut s = start(b.model, 1e-4);
    run(&mut s, 1.0, 0.01);
    let x = s.state().q[0];
    assert!((x - 0.101_936_8).abs() < 2e-4, "{x}");
    assert!(s.state().v[3].abs() < 1e-9);
}

/// Sphere sliding into rolling: v = 5/7 v0 after 2 v0/(7 μ g), then constant.
#[test]
fn a_sliding_sphere_ends_up_rolling_at_five_sevenths() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [4e-3; 3]));
    b.shape(
        0u32.into_link(),
        Shape::Sphere { radius: 0.1 },
        Pose::IDENTITY,
    );
    b.model.initial.position.z = 0.1 - 4e-4;
    b.model.initial.linear_velocity.x = 1.0;
    b.model.links[0].friction = 0.3;
    b.model.world.ground = Some(crate::model::Ground {
        friction: 0.3,
        restitution: 0.0,
    });
    let mut s = start(b.model, 1e-5);
    run(&mut s, 1.0, 0.01);
    let v = s.state().v[3];
    assert!((v - 5.0 / 7.0).abs() < 2e-3, "{v}");
    run(&mut s, 61.0, 0.01);
    assert!((s.state().v[3] - v).abs() < 1e-9, "{}", s.state().v[3] - v);
}

/// Newton's restitution in light gravity, at two impact speeds.
#[test]
fn a_ball_rebounds_with_the_coefficient_of_restitution_at_every_speed() {
    for e in [0.9, 0.5, 0.2] {
        for speed in [1.0, 4.0] {
            let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [4e-3; 3]));
            b.shape(
                0u32.into_link(),
                Shape::Sphere { radius: 0.1 },
                Pose::IDENTITY,
            );
            b.model.initial.position.z = 0.11;
            b.model.initial.linear_velocity.z = -speed;
            b.model.world.gravity = Vec3::zeros();
            b.model.links[0].restitution = e;
            let mut s = start(b.model, 1e-5);
            run(&mut s, 0.3, 0.01);
            let rebound = s.state().v[5] / speed;
            assert!((rebound - e).abs() < 0.01, "{e} at {speed}: {rebound}");
        }
    }
}

#[test]
fn a_fast_small_ball_does_not_tunnel() {
    let mut b = Builder::new(true, inertia(1e-3, Vec3::zeros(), [1e-8; 3]));
    b.shape(
        0u32.into_link(),
        Shape::Sphere { radius: 0.005 },
        Pose::IDENTITY,
    );
    b.model.initial.position.z = 1.0;
    b.model.initial.linear_velocity.z = -50.0;
    let mut s = start(b.model, 1e-3);
    // Deepest penetration of the Hunt–Crossley law: ½ k x² / m = v/d − ln(1 + d v)/d².
    let (k, d, v) = (s.tree().stiffness, s.tree().dissipation, 50.0);
    let deepest = (2e-3 / k * (v / d - (1.0 + d * v).ln() / (d * d))).sqrt();
    for i in 1..=40 {
        s.advance_to(0.1 * f64::from(i)).expect("finite");
        assert!(
            height(&mut s) > 0.005 - 1.05 * deepest,
            "{}",
            height(&mut s)
        );
    }
    assert!((height(&mut s) - (0.005 - 4e-4)).abs() < 1e-6);
}

/// A deep overlap leaves gently: no faster than it would fall back.
#[test]
fn a_deep_initial_overlap_leaves_without_a_hop() {
    let mut b = block(1.0, 0.5);
    b.model.initial.position.z = 0.1 - 0.05;
    let mut s = start(b.model, 1e-3);
    let mut highest = 0.0_f64;
    for i in 1..=480 {
        s.advance_to(f64::from(i) / 240.0).expect("finite");
        highest = highest.max(height(&mut s));
    }
    assert!(highest < 0.1 + 1e-4, "{highest}");
    assert!((height(&mut s) - (0.1 - 1e-4)).abs() < 1e-6);
}

#[test]
fn a_rolling_wheel_is_exactly_round() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [4e-3, 4e-3, 5e-3]));
    b.shape(
        0u32.into_link(),
        Shape::Cylinder {
            radius: 0.1,
            half_length: 0.05,
        },
        Pose::IDENTITY,
    );
    b.model.initial.rpy.x = std::f64::consts::FRAC_PI_2;
    b.model.initial.position.z = 0.1 - 2e-4;
    b.model.initial.linear_velocity.x = 1.0;
    b.model.initial.angular_velocity.y = 10.0;
    let mut s = start(b.model, 1e-4);
    run(&mut s, 1.0, 0.01);
    let (low, x0) = (height(&mut s), s.state().q[0]);
    let (mut ripple, v) = (0.0_f64, s.state().v[3]);
    for i in 1..=200 {
        s.advance_to(1.0 + 0.01 * f64::from(i)).expect("finite");
        ripple = ripple.max((height(&mut s) - low).abs());
    }
    assert!(ripple < 1e-9, "{ripple}");
    assert!((s.state().q[0] - x0 - 2.0 * v).abs() < 1e-8);
    assert!(
        (v - 0.1 * s.state().v[1]).abs() < 1e-8,
        "{v} {}",
        s.state().v[1]
    );
}

// ---- properties of the step ----

/// A model with everything in it, falling onto the ground.
fn everything() -> Model {
    let mut random = Random(11);
    let mut model = random_tree(&mut random, 9, true, true);
    let mut slot = 0;
    for (i, link) in model.links.iter().enumerate() {
        let shape = match i % 4 {
            0 => Shape::Sphere { radius: 0.1 },
            1 => Shape::Cylinder {
                radius: 0.08,
                half_length: 0.1,
            },
            2 => Shape::Box {
                half: Vec3::new(0.05, 0.1, 0.07),
            },
            _ => Shape::Capsule {
                radius: 0.05,
                half_length: 0.1,
            },
        };
        let slots = shape.slots();
        model.colliders.push(crate::model::Collider {
            link: (i).into(),
            body: link.body,
            X_BG: Pose::IDENTITY,
            shape,
            slot,
        });
        slot += slots;
    }
    model.world.ground = Some(crate::model::Ground {
        friction: 0.8,
        restitution: 0.3,
    });
    model.initial.position.z = 1.2;
    for joint in &mut model.joints {
        joint.damping = 0.1;
        joint.friction = 0.05;
    }
    let joint = model.joints[0].clone();
    let body = joint.bodies[0];
    model.actuators.push(crate::model::Actuator {
        joint: 0usize.into(),
        dof: model.bodies[body.index()].dof,
        mode: ActuatorMode::Velocity,
        max_effort: 5.0,
        reference_effort: 5.0,
        kp: 0.0,
        kd: 0.0,
    });
    model
}

#[test]
fn a_saved_state_continues_bit_for_bit_through_bytes_and_in_another_instance() {
    let model = everything();
    let mut s = start(model.clone(), 1e-3);
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 3.0);
    run(&mut s, 0.7, 1.0 / 240.0);
    let saved = s.save();
    let bytes = saved.to_bytes();
    assert_eq!(bytes.len(), saved.byte_len());
    run(&mut s, 1.5, 1.0 / 240.0);
    let expected = s.state().clone();
    s.restore(&saved).expect("its own state");
    run(&mut s, 1.5, 1.0 / 240.0);
    assert_eq!(s.state(), &expected);
    let read = super::super::simulation::Snapshot::from_bytes(&s.model().clone(), &bytes)
        .expect("what was written");
    let mut other = start(
        Model {
            solver: s.model().solver.clone(),
            ..model
        },
        1e-3,
    );
    other.restore(&read).expect("the same model");
    run(&mut other, 1.5, 1.0 / 240.0);
    assert_eq!(other.state(), &expected);
}

#[test]
fn changed_bytes_of_a_saved_state_are_refused() {
    let s = start(everything(), 1e-3);
    let model = s.model().clone();
    let bytes = s.save().to_bytes();
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 0x10;
        assert!(super::super::simulation::Snapshot::from_bytes(&model, &changed).is_err());
        assert!(super::super::simulation::Snapshot::from_bytes(&model, &bytes[..place]).is_err());
    }
}

#[test]
fn a_heap_of_everything_falls_and_never_gains_energy_while_passive() {
    for fixed in [0.0, 1.0 / 240.0] {
        let mut model = everything();
        model.actuators.clear();
        model.solver.step_size = fixed;
        for link in &mut model.links {
            link.restitution = 0.0;
        }
        model.world.ground = Some(crate::model::Ground {
            friction: 0.8,
            restitution: 0.0,
        });
        let mut s = start(model, 1e-3);
        let mut before = f64::INFINITY;
        let highest = s.output(OutputSlot::EnergyPotential);
        for i in 1..=1200 {
            s.advance_to(f64::from(i) / 240.0).expect("finite");
            let energy =
                s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential);
            // What the contacts store elastically may come back: the weight times the penetration.
            assert!(
                energy < before + 1e-3 * highest,
                "{fixed} {i}: {energy} {before}"
            );
            before = energy;
        }
    }
}

#[test]
fn the_communication_step_does_not_change_the_result_beyond_the_tolerance() {
    let mut ends = Vec::new();
    for h in [1.0 / 1000.0, 1.0 / 240.0, 1.0 / 60.0, 0.1] {
        let mut b = block(1.0, 0.5);
        b.model.initial.linear_velocity = Vec3::new(1.0, 0.5, 0.0);
        b.model.initial.angular_velocity.z = 2.0;
        let mut s = start(b.model, 1e-4);
        run(&mut s, 1.0, h);
        ends.push(Vec3::new(s.state().q[0], s.state().q[1], s.state().q[6]));
    }
    for end in &ends {
        assert!((end - ends[0]).norm() < 1e-3, "{ends:?}");
    }
}

#[test]
fn nan_in_the_scratch_between_steps_changes_nothing() {
    let model = everything();
    let mut a = start(model.clone(), 1e-3);
    let mut b = start(model, 1e-3);
    for i in 1..=100 {
        let t = f64::from(i) / 240.0;
        a.advance_to(t).expect("finite");
        // A new stepper has nothing of the old one's scratch.
        let saved = b.save();
        b = Simulation::new(Arc::new(b.model().clone()));
        b.restore(&saved).expect("the same model");
        b.advance_to(t).expect("finite");
        assert_eq!(a.state(), b.state(), "step {i}");
    }
}

/// Random robots with random actuators, masses over six decades, random commands and steps: nothing fails.
#[test]
fn random_robots_under_random_commands_stay_finite() {
    for seed in 0..40_u64 {
        let mut random = Random(seed);
        let mut model = random_tree(&mut random, 2 + seed as usize % 9, true, seed % 3 == 0);
        let mut slot = 0;
        for (i, link) in model.links.iter_mut().enumerate() {
            let scale = libm::pow(10.0, random.uniform(-3.0, 3.0));
            link.inertia.mass *= scale;
            link.inertia.I_cm *= scale;
            let shape = match (i as u64 + seed) % 4 {
                0 => Shape::Sphere {
                    radius: random.uniform(0.01, 0.3),
                },
                1 => Shape::Cylinder {
                    radius: 0.08,
                    half_length: random.uniform(0.01, 0.3),
                },
                2 => Shape::Box {
                    half: Vec3::from_fn(|_, _| random.uniform(0.01, 0.2)),
                },
                _ => Shape::Capsule {
                    radius: 0.05,
                    half_length: 0.1,
                },
            };
            let slots = shape.slots();
            model.colliders.push(crate::model::Collider {
                link: i.into(),
                body: link.body,
                X_BG: Pose::from_xyz_rpy(random.vector(0.1), random.vector(3.0)),
                shape,
                slot,
            });
            slot += slots;
        }
        let e = if seed % 2 == 0 {
            0.0
        } else {
            random.uniform(0.0, 1.0)
        };
        model.world.ground = Some(crate::model::Ground {
            friction: random.uniform(0.0, 1.5),
            restitution: e,
        });
        model.initial.position.z = random.uniform(-0.3, 1.5);
        model.initial.rpy = random.vector(3.0);
        for joint in &mut model.joints {
            joint.damping = libm::pow(10.0, random.uniform(-4.0, 3.0));
            joint.friction = random.uniform(0.0, 1.0);
        }
        let modes = [
            ActuatorMode::Velocity,
            ActuatorMode::Position,
            ActuatorMode::Effort,
            ActuatorMode::Pd,
        ];
        for joint in 0..model.joints.len() {
            let body = &model.bodies[model.joints[joint].bodies[0].index()];
            if model.joints[joint].mimic.is_some() || body.motion.nv() != 1 {
                continue;
            }
            let effort = libm::pow(10.0, random.uniform(-3.0, 4.0));
            model.actuators.push(crate::model::Actuator {
                joint: joint.into(),
                dof: body.dof,
                mode: modes[joint % 4],
                max_effort: effort,
                reference_effort: effort,
                kp: libm::pow(10.0, random.uniform(0.0, 6.0)),
                kd: libm::pow(10.0, random.uniform(-1.0, 4.0)),
            });
            if joint % 3 == 0 {
                model.dofs[body.dof.index()].limits = Some(crate::model::Limits {
                    lower: -0.5,
                    upper: 0.5,
                });
            }
        }
        if seed % 5 == 0 {
            model.solver.step_size = 1.0 / 240.0;
        }
        let actuators = model.actuators.len();
        let mut s = start(model, 1e-3);
        let mut t = 0.0;
        for step in 0..150 {
            if step % 10 == 0 {
                for a in 0..actuators {
                    let a = ActuatorId::from(a);
                    s.set_input(InputSlot::Velocity(a), random.uniform(-30.0, 30.0));
                    s.set_input(InputSlot::Position(a), random.uniform(-1.0, 1.0));
                    s.set_input(InputSlot::Effort(a), random.uniform(-50.0, 50.0));
                }
            }
            t += libm::pow(10.0, random.uniform(-5.0, -1.5));
            let result = s.advance_to(t);
            assert!(result.is_ok(), "seed {seed}, t = {t}: {result:?}");
        }
        // Not stalled, either: chattering contacts of gram-sized links on tonnes do not drive the step to nothing.
        let taken = s.state().counters[0] + s.state().counters[1];
        assert!(taken < 100_000, "seed {seed}: {:?}", s.state().counters);
    }
}

// ---- C, continued: gravity turned by an angle stands for a slope ----

/// Gravity as on a slope of `angle`, falling along +x.
fn slope(angle: f64) -> Vec3 {
    Vec3::new(libm::sin(angle), 0.0, -libm::cos(angle)) * G
}

/// One hour on 20° with μ = 1, and a minute with a 5 Hz side load that reaches 86 % of the cone (peers creep by
/// millimetres to metres an hour, see `docs/accuracy.md`).
#[test]
fn a_block_on_a_slope_does_not_creep() {
    let mut b = block(1.0, 1.0);
    // Centre of mass in the contact plane: all corners carry the same, and reach the same share of the cone.
    b.model.links[0].inertia.com.z = -0.1;
    b.model.world.gravity = slope(20.0_f64.to_radians());
    b.model.outputs.external_wrenches = vec![0u32.into_link()];
    let mut s = start(b.model, 1e-4);
    run(&mut s, 5.0, 0.01);
    let x0 = s.state().q[0];
    run(&mut s, 3605.0, 1.0);
    assert!(
        (s.state().q[0] - x0).abs() < 1e-9,
        "{}",
        s.state().q[0] - x0
    );
    // Peak: √(sin² + side²) = 0.86 cos.
    let (sin, cos) = libm::sincos(20.0_f64.to_radians());
    let side = G * ((0.86 * cos) * (0.86 * cos) - sin * sin).sqrt();
    let mut marks = Vec::new();
    for i in 1..=12_000 {
        let t = f64::from(i) * 0.005;
        let load = side * libm::sin(std::f64::consts::TAU * 5.0 * t);
        s.set_input(InputSlot::ExternalForce(0u32.into_link(), 1), load);
        s.advance_to(3605.0 + t).expect("finite");
        if i % 1200 == 0 {
            marks.push(s.state().q[0]);
        }
    }
    let drift = marks[9] - marks[1];
    assert!(drift.abs() < 1e-7, "{drift}");
}

/// Friction of a block with the same load on all corners acts against the motion, whatever its direction.
#[test]
fn friction_is_isotropic() {
    for degrees in [0.0, 17.0, 45.0, 73.0, 90.0_f64] {
        let (s, c) = libm::sincos(degrees.to_radians());
        let mut b = block(1.0, 0.5);
        b.model.links[0].inertia.com.z = -0.1;
        b.model.initial.position.z = 0.1 - 1e-4;
        b.model.initial.linear_velocity = Vec3::new(c, s, 0.0);
        let mut sim = start(b.model, 1e-5);
        run(&mut sim, 0.15, 0.01);
        let angle = libm::atan2(sim.state().v[4], sim.state().v[3]);
        assert!(
            (angle - degrees.to_radians()).abs() < 1e-6,
            "{degrees}: {angle}"
        );
    }
}

/// Rolling down: a = 5/7 g sin θ for a ball, 2/3 g sin θ for a cylinder (rigid-body textbooks); slipping where
/// μ < 2/7 tan θ resp. 1/3 tan θ.
#[test]
fn balls_and_cylinders_roll_down_a_slope_as_rigid_bodies_do() {
    let angle = 10.0_f64.to_radians();
    let ball = (Shape::Sphere { radius: 0.1 }, [4e-3; 3], 5.0 / 7.0, 4e-4);
    let cylinder = (
        Shape::Cylinder {
            radius: 0.1,
            half_length: 0.05,
        },
        [1.0 / 12.0 * (0.03 + 0.01), 1.0 / 12.0 * (0.03 + 0.01), 5e-3],
        2.0 / 3.0,
        2e-4,
    );
    for (shape, I, share, depth) in [ball, cylinder] {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), I));
        b.shape(0u32.into_link(), shape, Pose::IDENTITY);
        b.model.initial.rpy.x = std::f64::consts::FRAC_PI_2;
        b.model.initial.position.z = 0.1 - depth;
        b.model.world.gravity = slope(angle);
        let mut s = start(b.model, 1e-5);
        run(&mut s, 0.5, 0.01);
        let v0 = s.state().v[3];
        run(&mut s, 1.5, 0.01);
        let a = s.state().v[3] - v0;
        assert!((a - share * G * libm::sin(angle)).abs() < 1e-4, "{a}");
        let slip = s.state().v[3] - 0.1 * s.state().v[1];
        assert!(slip.abs() < 1e-6, "{slip}");
    }
}

/// A rod that slides point first with μ = 2 (Painlevé): rigid bodies have no solution, compliant ones do.
#[test]
fn painleves_rod_finishes_without_gaining_energy() {
    for tolerance in [1e-3, 1e-5] {
        let mut b = Builder::new(
            true,
            inertia(1.0, Vec3::zeros(), [1.0 / 12.0, 1.0 / 12.0, 1e-4]),
        );
        b.shape(
            0u32.into_link(),
            Shape::Capsule {
                radius: 0.01,
                half_length: 0.5,
            },
            Pose::IDENTITY,
        );
        b.model.links[0].friction = 2.0;
        b.model.world.ground = Some(crate::model::Ground {
            friction: 2.0,
            restitution: 0.0,
        });
        b.model.initial.rpy.y = -0.6;
        b.model.initial.position.z = 0.5 * libm::cos(0.6) + 0.01;
        b.model.initial.linear_velocity.x = 2.0;
        let mut s = start(b.model, tolerance);
        let energy = |s: &mut Simulation| {
            s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
        };
        let initial = energy(&mut s);
        let mut lowest = initial;
        for i in 1..=400 {
            s.advance_to(f64::from(i) * 0.01).expect("finite");
            let now = energy(&mut s);
            // What the contact stores at an impact of 2 m/s, ½ k x², comes back for a moment.
            assert!(now < initial && now < lowest + 2e-2, "{i}: {now} {lowest}");
            lowest = lowest.min(now);
        }
        assert!(lowest < 0.2, "it lies and rests: {lowest}");
    }
}

/// A gram under a ton: the contact carries both, as deep as its stiffness says.
#[test]
fn a_mass_ratio_of_a_million_rests_at_the_static_penetration() {
    let mut b = Builder::new(true, inertia(1e-3, Vec3::zeros(), [1e-6; 3]));
    for (x, y) in [(0.1, 0.1), (-0.1, 0.1), (0.1, -0.1), (-0.1, -0.1)] {
        b.shape(
            0u32.into_link(),
            Shape::Sphere { radius: 0.05 },
            at(x, y, 0.0),
        );
    }
    let torso = b.link(
        0u32.into_link(),
        at(0.0, 0.0, 0.2),
        Motion::Prismatic(Vec3::z()),
        inertia(1e3, Vec3::zeros(), [10.0; 3]),
    );
    b.limits(torso, 0.0, 0.1);
    b.model.initial.position.z = 0.05;
    let mut s = start(b.model, 1e-3);
    run(&mut s, 3.0, 1.0 / 240.0);
    let depth = 0.05 - height(&mut s);
    assert!((depth - 1e-4).abs() < 1e-6, "{depth}");
    let force = s.output(OutputSlot::ContactForce(0u32.into_link(), 2));
    assert!((force / (1000.001 * G) - 1.0).abs() < 1e-6, "{force}");
}

/// A can set down at a small tilt settles flat, whatever the tilt.
#[test]
fn a_can_set_down_tilted_settles_on_its_end() {
    for degrees in [0.0, 2.0, 4.0, 6.0, 9.0_f64] {
        let I = [
            1.0 / 12.0 * (3.0 * 0.01 + 0.09),
            1.0 / 12.0 * (3.0 * 0.01 + 0.09),
            5e-3,
        ];
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), I));
        b.shape(
            0u32.into_link(),
            Shape::Cylinder {
                radius: 0.1,
                half_length: 0.15,
            },
            Pose::IDENTITY,
        );
        let tilt = degrees.to_radians();
        b.model.initial.rpy.y = tilt;
        b.model.initial.position.z = 0.15 * libm::cos(tilt) + 0.1 * libm::sin(tilt);
        let mut s = start(b.model, 1e-3);
        run(&mut s, 6.0, 1.0 / 240.0);
        assert!(
            (height(&mut s) - (0.15 - 1e-4)).abs() < 1e-6,
            "{degrees}: {}",
            height(&mut s)
        );
        assert!(
            s.state().v.iter().all(|v| v.abs() < 1e-9),
            "{degrees}: {:?}",
            s.state().v
        );
    }
}

/// Halving the tolerance tenfold reduces the error of a motion through contact: the step converges.
#[test]
fn tighter_tolerances_converge_through_contact_and_friction() {
    let end = |tolerance: f64| {
        let mut b = block(1.0, 0.4);
        b.model.initial.position.z = 0.15;
        b.model.initial.linear_velocity = Vec3::new(1.0, 0.3, 0.0);
        b.model.initial.angular_velocity = Vec3::new(0.3, 0.2, 1.0);
        let mut s = start(b.model, tolerance);
        run(&mut s, 0.5, 0.05);
        Vec3::new(s.state().q[0], s.state().q[1], s.state().q[6])
    };
    let exact = end(1e-8);
    let errors: Vec<f64> = [1e-3, 1e-4, 1e-5, 1e-6]
        .map(|t| (end(t) - exact).norm())
        .to_vec();
    assert!(errors[0] < 1e-2 && errors[3] < 1e-4, "{errors:?}");
    assert!(
        errors.windows(2).all(|pair| pair[1] < 0.5 * pair[0]),
        "{errors:?}"
    );
}

/// A hinged link deep in the ground that its mounting does not let out: the host lives, and so does the state.
#[test]
fn a_link_stuck_deep_in_the_ground_stays_finite() {
    for rpy in [
        Vec3::new(0.3, 0.2, 0.1),
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(1.5, 0.0, 0.3),
    ] {
        for friction in [0.0, 0.8, 1.5] {
            let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
            let link = b.link(
                0u32.into_link(),
                Pose::IDENTITY,
                Motion::Revolute(Vec3::z()),
                inertia(1.0, Vec3::zeros(), [1.0; 3]),
            );
            b.shape(
                link,
                Shape::Box {
                    half: Vec3::new(0.5, 0.5, 0.5),
                },
                Pose::IDENTITY,
            );
            b.model.links[link.index()].friction = friction;
            b.model.world.ground = Some(crate::model::Ground {
                friction,
                restitution: 0.0,
            });
            b.model.initial.rpy = rpy;
            b.model.joints[0].damping = 1.0;
            b.model.joints[0].friction = 1e-4;
            let mut s = start(b.model, 1e-3);
            run(&mut s, 1.0, 1.0 / 240.0);
            assert!(
                s.state().v.iter().all(|v| v.abs() < 10.0),
                "{rpy} {:?}",
                s.state().v
            );
        }
    }
}

/// Nothing stalls: a joint told to spin at 4e9 rad/s ends its step, rightly or with an error.
#[test]
fn an_absurd_initial_speed_does_not_stall_the_host() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.1, 0.2, 0.15]));
    b.link(
        0u32.into_link(),
        at(0.1, 0.0, 0.0),
        Motion::Revolute(Y),
        inertia(0.5, X * 0.2, [0.01, 0.02, 0.02]),
    );
    b.model.initial.joint_velocities[0] = 4e9;
    let mut s = start(b.model, 1e-3);
    for step in 1..=10 {
        if s.advance_to(f64::from(step) / 240.0).is_err() {
            break;
        }
    }
    assert!(s.state().is_finite());
    assert!(
        s.state().counters[0] + s.state().counters[1] < 100_000,
        "{:?}",
        s.state().counters
    );
}

/// Every mode with `max_effort` 0, on a joint that nothing loads: the motor lets go.
#[test]
fn a_released_motor_leaves_its_joint_alone() {
    for mode in [
        ActuatorMode::Velocity,
        ActuatorMode::Position,
        ActuatorMode::Pd,
    ] {
        let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
        let link = b.link(
            0u32.into_link(),
            Pose::IDENTITY,
            Motion::Prismatic(X),
            inertia(1.0, Vec3::zeros(), [0.01; 3]),
        );
        b.actuator(link, mode, 5.0);
        b.model.actuators[0].kp = 100.0;
        b.model.joints[0].friction = 0.1;
        let mut s = start(b.model, 1e-3);
        s.set_input(InputSlot::MaxEffort(ActuatorId(0)), 0.0);
        s.set_input(InputSlot::Position(ActuatorId(0)), 1.0);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), 1.0);
        run(&mut s, 1.0, 0.01);
        assert_eq!((s.state().q[0], s.state().v[0]), (0.0, 0.0), "{mode:?}");
    }
}

/// A servo that pushes against a limit: two large forces balance and nothing else acts.
#[test]
fn a_servo_pressed_against_a_limit_rests() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let link = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
    b.limits(link, -0.1, 0.1);
    b.actuator(link, ActuatorMode::Position, 500.0);
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::Position(ActuatorId(0)), 1.0);
    run(&mut s, 2.0, 1.0 / 240.0);
    let expected = 0.1 + 500.0 / s.tree().limit_stiffness[0];
    assert!(
        (s.state().q[0] - expected).abs() < 1e-8,
        "{} {expected}",
        s.state().q[0]
    );
    let steps = s.state().counters[0];
    run(&mut s, 3.0, 1.0);
    assert!(
        s.state().counters[0] < steps + 3,
        "{:?}",
        s.state().counters
    );
}
