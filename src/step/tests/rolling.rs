//! Bodies that roll on bodies that move, against closed forms of rolling without slip.

use super::worlds::{body, depth, world};
use super::*;
use crate::model::Ground;
use crate::spatial::rotation_from_rpy;

/// Steps of 1/240 s, and tolerances.
const WAYS: [(f64, f64); 4] = [(1.0 / 240.0, 1e-3), (0.0, 1e-3), (0.0, 1e-4), (0.0, 1e-6)];

/// Roll, pitch and yaw of a cylinder whose axis lies along y.
const LYING: Vec3 = Vec3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0);

/// Sets the length of steps, 0 under error control, and a friction that holds.
fn rough(mut model: Model, step: f64) -> Model {
    model.solver.step_size = step;
    for link in &mut model.links {
        link.friction = 2.0;
    }
    if let Some(ground) = &mut model.world.ground {
        ground.friction = 2.0;
    }
    model
}

/// Position of a base whose coordinates begin at this one.
fn place(s: &Simulation, coordinate: usize) -> Vec3 {
    Vec3::from_row_slice(&s.state().physical.q[coordinate..coordinate + 3])
}

/// Holds an error to `most`: what contacts yield by, and friction builds up within.
fn hold((step, tolerance): (f64, f64), error: f64, most: f64) {
    assert!(
        error < most,
        "{error:e} m in steps of {step} s, or at {tolerance:e}"
    );
}

/// Angle at the time `end` of what goes down from 0.2 rad and from rest with the angular
/// acceleration `rate` times the sine of the angle, by the midpoint rule.
fn down(rate: f64, end: f64) -> f64 {
    let h = end / 10_000.0;
    let [mut angle, mut speed] = [0.2, 0.0];
    for _ in 0..10_000 {
        let middle = [
            angle + 0.5 * h * speed,
            speed + 0.5 * h * rate * libm::sin(angle),
        ];
        angle += h * middle[1];
        speed += h * rate * libm::sin(middle[0]);
    }
    angle
}

/// The unit vector that leans from z to x by `angle`.
fn leaning(angle: f64) -> Vec3 {
    Vec3::new(libm::sin(angle), 0.0, libm::cos(angle))
}

/// A cylinder of `mass` that lies along y.
fn roller(mass: f64, [radius, half_length]: [f64; 2], place: Vec3) -> Model {
    let shape = Shape::Cylinder {
        radius,
        half_length,
    };
    let mut b = body(mass, shape, place);
    b.roots[0].rpy = LYING;
    b
}

/// A turntable of 50 kg whose face is at the height `top` and turns with `rate`, rad/s.
fn turntable(top: f64, rate: f64) -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let disc = b.link(
        LinkId(0),
        at(0.0, 0.0, top - 0.05),
        Motion::Revolute(Vec3::z()),
        inertia(50.0, Vec3::zeros(), [10.0, 10.0, 20.0]),
    );
    let shape = Shape::Cylinder {
        radius: 3.0,
        half_length: 0.05,
    };
    b.shape(disc, shape, Pose::IDENTITY);
    b.actuator(disc, ActuatorMode::Velocity, 1e4);
    b.model.initial.joint_velocities = vec![rate];
    b.model
}

/// A can that stands on a turntable is held by a tenth of the friction that it may have, and stays
/// where it is. While any lean of its rim to the other side, here of 1e-6 rad, ended in one solve
/// of first order, it went 0.7 mm outwards in each second.
#[test]
fn a_can_on_a_turntable_stays_where_it_stands() {
    let (rate, top, radius, half_length) = (1.0, 0.5, 0.05, 0.05);
    for (step, tolerance) in WAYS {
        let shape = Shape::Cylinder {
            radius,
            half_length,
        };
        let mut can = body(1.0, shape, Vec3::new(0.5, 0.0, top + half_length));
        can.roots[0].linear_velocity = Y * (0.5 * rate);
        can.roots[0].angular_velocity = Vec3::z() * rate;
        let mut s = start(rough(world([turntable(top, rate), can]), step), tolerance);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), rate);
        run(&mut s, 4.0, 1.0 / 240.0);
        hold(
            (step, tolerance),
            (place(&s, 1).xy().norm() - 0.5).abs(),
            1e-4,
        );
    }
}

/// A ball on a turntable: the inertial velocity of its middle turns by 2/7 of the table's rate.
#[test]
fn a_ball_on_a_turntable_goes_round_by_two_sevenths_of_its_rate() {
    let (r, rate, top) = (0.1, 3.0, 0.5);
    for (step, tolerance) in WAYS {
        let start_at = Vec3::new(0.5, 0.0, top + r);
        let v = Vec3::new(0.3, 0.5, 0.0);
        let mut ball = body(
            1.0,
            Shape::Sphere { radius: r },
            start_at - Vec3::z() * depth(1.0),
        );
        let d = Vec3::z().cross(&start_at) * rate - v;
        ball.roots[0].linear_velocity = v;
        ball.roots[0].angular_velocity = Vec3::new(d.y / r, -d.x / r, 0.0);
        let mut s = start(rough(world([turntable(top, rate), ball]), step), tolerance);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), rate);
        let end = 4.0;
        run(&mut s, end, 1.0 / 240.0);
        let w = rate * 2.0 / 7.0;
        let (sin, cos) = libm::sincos(w * end);
        // Integral of the velocity that turns.
        let exact = start_at
            + Vec3::new(
                v.x * sin - v.y * (1.0 - cos),
                v.x * (1.0 - cos) + v.y * sin,
                0.0,
            ) / w;
        hold((step, tolerance), (place(&s, 1) - exact).xy().norm(), 3e-4);
    }
}

/// A ball that rolls down a ball: `θ'' = 5/7 g sin θ/(R + r)`.
#[test]
fn a_ball_rolls_down_a_ball() {
    let (R, r) = (1.0, 0.1);
    for (step, tolerance) in WAYS {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        b.shape(LinkId(0), Shape::Sphere { radius: R }, Pose::IDENTITY);
        b.model.roots[0].position.z = 2.0;
        let at = |a: f64| leaning(a) * (R + r) + Vec3::z() * 2.0;
        let ball = body(
            1.0,
            Shape::Sphere { radius: r },
            at(0.2) - leaning(0.2) * depth(1.0),
        );
        let mut s = start(rough(world([b.model, ball]), step), tolerance);
        let end = 0.5;
        run(&mut s, end, 1.0 / 240.0);
        let angle = down(5.0 / 7.0 * G / (R + r), end);
        hold((step, tolerance), (place(&s, 0) - at(angle)).norm(), 1.5e-4);
    }
}

/// A cylinder on a cart that is pulled: the cart goes with `a = F/(M + m/3)`, the cylinder with a
/// third of it.
#[test]
fn a_cylinder_rolls_on_a_cart() {
    let (r, top, force, M) = (0.1, 0.5, 20.0, 3.0);
    for (step, tolerance) in WAYS {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let cart = b.link(
            LinkId(0),
            at(0.0, 0.0, top - 0.05),
            Motion::Prismatic(X),
            inertia(M, Vec3::zeros(), [1.0; 3]),
        );
        b.shape(
            cart,
            Shape::Box {
                half: Vec3::new(3.0, 0.5, 0.05),
            },
            Pose::IDENTITY,
        );
        b.actuator(cart, ActuatorMode::Effort, 1e4);
        let roller = roller(1.0, [r, 0.1], Vec3::new(0.0, 0.0, top + r - depth(1.0)));
        let mut s = start(rough(world([b.model, roller]), step), tolerance);
        s.set_input(InputSlot::Effort(ActuatorId(0)), force);
        let end = 1.0;
        run(&mut s, end, 1.0 / 240.0);
        let a = force / (M + 1.0 / 3.0);
        let q = &s.state().physical.q;
        let error = (q[0] - 0.5 * a * end * end)
            .abs()
            .max((q[1] - a / 6.0 * end * end).abs());
        hold((step, tolerance), error, 3.5e-4);
    }
}

/// A cylinder rolls down one that turns about its axis: with the friction `f` on both,
/// `m a = m g sin θ − f` and `a − 2f/m = 2f/M`.
#[test]
fn a_cylinder_rolls_down_a_roller() {
    let (R, r, M, m) = (0.5, 0.1, 4.0, 1.0);
    for (step, tolerance) in WAYS {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let large = b.link(
            LinkId(0),
            at(0.0, 0.0, 1.0),
            Motion::Revolute(Y),
            inertia(M, Vec3::zeros(), [1.0, 0.5 * M * R * R, 1.0]),
        );
        let R_lying = rotation_from_rpy(&LYING);
        let lying = Pose {
            R: R_lying,
            ..Pose::IDENTITY
        };
        b.shape(
            large,
            Shape::Cylinder {
                radius: R,
                half_length: 0.3,
            },
            lying,
        );
        let at = |a: f64| leaning(a) * (R + r) + Vec3::z();
        let small = roller(m, [r, 0.2], at(0.2) - leaning(0.2) * depth(1.0));
        let mut s = start(rough(world([b.model, small]), step), tolerance);
        let end = 0.35;
        run(&mut s, end, 1.0 / 240.0);
        let angle = down(G / (1.0 + 1.0 / (2.0 + 2.0 * m / M)) / (R + r), end);
        hold((step, tolerance), (place(&s, 1) - at(angle)).norm(), 4e-5);
    }
}

/// A board on two cylinders that roll down a slope: `a = g sin α (M + m)/(M + 3/4 m)`.
#[test]
fn a_board_on_two_rollers_goes_down_a_slope() {
    let (r, M, angle) = (0.1, 2.0, 0.2);
    for (step, tolerance) in WAYS {
        let lie = |x: f64| roller(1.0, [r, 0.3], Vec3::new(x, 0.0, r - depth(2.0)));
        let half = Vec3::new(1.0, 0.2, 0.05);
        let board = body(
            M,
            Shape::Box { half },
            Vec3::new(0.0, 0.0, 2.0 * r + 0.05 - 2.0 * depth(2.0)),
        );
        let mut model = world([board, lie(-0.5), lie(0.5)]);
        model.world.ground = Some(Ground::default());
        model.world.gravity = slope(angle);
        let mut s = start(rough(model, step), tolerance);
        let end = 0.5;
        run(&mut s, end, 1.0 / 240.0);
        let a = G * libm::sin(angle) * (M + 1.0) / (M + 0.75);
        hold(
            (step, tolerance),
            (s.state().physical.q[0] - 0.5 * a * end * end).abs(),
            3e-4,
        );
    }
}
