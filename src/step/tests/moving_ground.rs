//! Rolling over divided ground, and ground that a motor moves.

use super::terrain::{field, grid, ground, mesh, over};
use super::worlds::{body, depth, world};
use super::*;
use std::f64::consts::TAU;

/// On ground of 9,800 triangles, and of as many heights, everything rolls as on a plane.
#[test]
fn ten_thousand_even_triangles_are_a_plane_for_what_rolls() {
    let (radius, half_length) = (0.1, 0.04);
    let (yaw, speed): (f64, f64) = (0.7, 1.0);
    let along = Vec3::new(libm::cos(yaw), libm::sin(yaw), 0.0);
    for (name, shape, rpy) in [
        ("ball", Shape::Sphere { radius }, Vec3::zeros()),
        (
            "wheel",
            Shape::Cylinder {
                radius,
                half_length,
            },
            Vec3::new(-0.25 * TAU, 0.0, yaw),
        ),
        (
            "capsule",
            Shape::Capsule {
                radius,
                half_length,
            },
            Vec3::new(-0.25 * TAU, 0.0, yaw),
        ),
    ] {
        let roll = |terrain: Shape| {
            let at = Vec3::new(-0.8123, -0.6456, radius - depth(1.0));
            let mut one = body(1.0, shape.clone(), at);
            one.roots[0].rpy = rpy;
            one.roots[0].linear_velocity = along * speed;
            one.roots[0].angular_velocity = Vec3::z().cross(&along) * (speed / radius);
            let mut s = start(over(ground(terrain, Vec3::zeros()), one), 1e-3);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 1..=200 {
                run(&mut s, 0.01 * f64::from(i), 0.01);
                let z = s.state().physical.q[2];
                if i > 20 {
                    (low, high) = (low.min(z), high.max(z));
                }
            }
            let q = &s.state().physical.q;
            (Vec3::new(q[0], q[1], q[2]), high - low)
        };
        let (plane, _) = roll(Shape::Plane);
        assert!((plane.x + 0.8123 - 2.0 * along.x).abs() < 0.05, "{plane}");
        for terrain in [field(4.0, 70, |_, _| 0.0), mesh(&grid(4.0, 70, |_, _| 0.0))] {
            let (end, ripple) = roll(terrain);
            assert!((end - plane).norm() < 1e-9, "{name}: {}", end - plane);
            assert!(ripple < 1e-9, "{name}: {ripple:e}");
        }
    }
}

/// A table on a rail, which a motor moves by commanded velocities, carries a block as Coulomb says:
/// with it below the friction that there is, behind it above.
#[test]
fn a_block_on_a_shaking_table_slides_where_friction_ends() {
    let (mu, amplitude) = (0.3, 0.02);
    // Largest acceleration of the table over that of friction.
    for (name, share, tolerance) in [("sticks", 0.9, 1e-4), ("slides", 2.0, 1e-5)] {
        let omega = (share * mu * G / amplitude).sqrt();
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let table = b.link(
            LinkId(0),
            Pose::IDENTITY,
            Motion::Prismatic(X),
            inertia(50.0, Vec3::zeros(), [1.0; 3]),
        );
        let half = Vec3::new(0.5, 0.5, 0.05);
        b.shape(table, Shape::Box { half }, at(0.0, 0.0, -0.05));
        b.actuator(table, ActuatorMode::Velocity, 1e5);
        b.model.links[table.index()].friction = mu;
        let half = Vec3::new(0.1, 0.1, 0.02);
        let mut block = body(1.0, Shape::Box { half }, Vec3::z() * (0.02 - depth(1.0)));
        block.links[0].friction = mu;
        let mut model = world([b.model, block]);
        model.world.ground = None;
        let mut s = start(model, tolerance);
        // The truth: the block's speed follows the table's with at most μ g.
        let (rate, seconds) = (2000, 4);
        let dt = 1.0 / f64::from(rate);
        let mut block = (0.0, 0.0);
        let table_speed = |t: f64| amplitude * omega * libm::sin(omega * t);
        let mut after_start = None;
        let mut worst = [0.0_f64; 2];
        for k in 0..rate * seconds {
            let t = f64::from(k) * dt;
            s.set_input(
                InputSlot::Velocity(ActuatorId(0)),
                table_speed(t + 0.5 * dt),
            );
            s.advance_to(t + dt).expect("a step");
            let most = mu * G * dt;
            let next = block.1 + (table_speed(t + dt) - block.1).clamp(-most, most);
            block.0 += 0.5 * (block.1 + next) * dt;
            block.1 = next;
            let found = s.output(OutputSlot::BasePosition(RootId(1), 0));
            let off = found - block.0;
            worst[0] = worst[0].max(off.abs());
            if t > TAU / omega {
                let since = off - *after_start.get_or_insert(off);
                worst[1] = worst[1].max(since.abs());
            }
        }
        // Friction has a spring, which is not yet loaded when the table starts at once with its
        // largest acceleration: the block goes on from there with its speed of that time.
        assert!(worst[0] < 0.05 * amplitude, "{name}: {worst:?}");
        assert!(worst[1] < 0.015 * amplitude, "{name}: {worst:?}");
    }
}
