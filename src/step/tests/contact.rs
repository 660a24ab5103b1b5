//! One contact: rest, friction, rolling, bouncing.

use super::*;

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
        ..Default::default()
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
