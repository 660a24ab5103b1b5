//! C6, C7, C11: rolling.

use super::*;

/// C6. A ball that starts sliding rolls at 5/7 of its speed after 2 v0/(7 μ g) = 0.0970827 s and 12
/// v0²/(49 μ g) = 0.0832137 m (v0 = 1, μ = 0.3), and goes on at that speed.
#[test]
fn c6_a_sliding_ball_ends_up_rolling_at_five_sevenths() {
    let mut b = ball(0.3);
    b.model.roots[0].linear_velocity.x = 1.0;
    let (time, way) = (2.0 / (7.0 * 0.3 * G), 12.0 / (49.0 * 0.3 * G));
    for (tolerance, allowed) in [
        (1e-4, [1.5e-6, 1.5e-10, 2e-12, 3e-10]),
        (1e-6, [3e-6, 1.5e-12, 1.5e-5, 7e-13]),
    ] {
        let mut s = start(b.model.clone(), tolerance);
        run(&mut s, time, time / 10.0);
        let name = |what: &str| format!("{what}, tol {tolerance:.0e}");
        let x = s.state().physical.q[0] - way;
        hold(
            "C6",
            &name("way to rolling, m"),
            "12 v²/(49 μg)",
            x,
            allowed[0],
        );
        run(&mut s, 1.0, 0.01);
        let v = s.state().physical.v[3];
        hold(
            "C6",
            &name("rolling speed, m/s"),
            "5/7 v",
            v - 5.0 / 7.0,
            allowed[1],
        );
        let x = s.state().physical.q[0] - way - 5.0 / 7.0 * (1.0 - time);
        hold(
            "C6",
            &name("way after 1 s, m"),
            "12 v²/(49 μg) + 5/7 v t",
            x,
            allowed[2],
        );
        run(&mut s, 61.0, 0.01);
        let change = s.state().physical.v[3] - v;
        hold(
            "C6",
            &name("speed lost in a minute, m/s"),
            "0",
            change,
            allowed[3],
        );
    }
}

/// A ball or a wheel of 1 kg and 0.1 m on a slope, with its share c of m R².
fn on_slope(round: bool, angle: f64, mu: f64) -> (Builder, f64) {
    let (mut b, share) = if round {
        (ball(mu), 0.4)
    } else {
        (wheel(mu), 0.5)
    };
    b.model.world.gravity = slope(angle);
    (b, share)
}

/// A wheel of 1 kg, 0.1 m and 0.1 m wide with its axle along y, in equilibrium: its three points
/// are as stiff as two.
fn wheel(mu: f64) -> Builder {
    let across = 0.04 / 12.0;
    let cylinder = Shape::Cylinder {
        radius: 0.1,
        half_length: 0.05,
    };
    let mut b = single(1.0, [across, across, 5e-3], cylinder, mu);
    b.model.roots[0].rpy.x = std::f64::consts::FRAC_PI_2;
    b.model.roots[0].position.z = 0.1 - 0.5 * b.model.contact.penetration;
    b
}

/// What a guess that needs no iteration may lack, m/s²: each step begins with the guess that the
/// last one ended with, and at a tolerance of 1e-4 it may lack 2e-8 of the impulses, those of g.
const GUESSED: f64 = 2e-7;

/// C7. Down a slope: a = g sin θ/(1 + c), that is 5/7 and 2/3 g sin θ; slipping, a = g (sin θ − μ
/// cos θ), where μ < c/(1 + c) tan θ, that is 2/7 and 1/3 tan θ (rigid-body textbooks).
#[test]
fn c7_balls_and_cylinders_roll_and_slip_down_a_slope_as_rigid_bodies_do() {
    let angle = 10.0_f64.to_radians();
    let (sin, cos) = angle.sin_cos();
    for (round, name) in [(true, "ball"), (false, "cylinder")] {
        for (relative, slips) in [(0.98, true), (1.02, false), (5.0, false)] {
            let share = if round { 0.4 } else { 0.5 };
            let limit = share / (1.0 + share) * angle.tan();
            let (b, share) = on_slope(round, angle, relative * limit);
            let mut s = start(b.model, 1e-4);
            run(&mut s, 0.5, 0.01);
            let slip = |s: &Simulation| s.state().physical.v[3] - 0.1 * s.state().physical.v[1];
            let (v0, slip0) = (s.state().physical.v[3], slip(&s));
            run(&mut s, 1.5, 0.01);
            let a = s.state().physical.v[3] - v0;
            let (expected, source) = if slips {
                (G * (sin - relative * limit * cos), "g (sin θ − μ cos θ)")
            } else {
                (G * sin / (1.0 + share), "g sin θ/(1 + c)")
            };
            let what = format!("acceleration of a {name} at {relative} of the slipping μ, m/s²");
            hold("C7", &what, source, a - expected, GUESSED);
            if slips {
                // The spin grows by μ g cos θ R/(c R²).
                let expected = expected - relative * limit * G * cos / share;
                let what = format!("growth of the slip of a {name}, m/s²");
                let error = slip(&s) - slip0 - expected;
                hold("C7", &what, "a − μ g cos θ/c", error, GUESSED);
            } else {
                let what = format!("slip of a {name} at {relative} of the slipping μ, m/s");
                hold("C7", &what, "0", slip(&s), 1e-9);
            }
        }
    }
}

/// Rolls at 1 m/s for 1 s, then for 2 s more: how much its height varies, how far it is from where
/// `ω R` takes it, and the mismatch of its speeds.
fn rolled(mut b: Builder) -> [f64; 3] {
    b.model.roots[0].linear_velocity.x = 1.0;
    b.model.roots[0].angular_velocity.y = 10.0;
    let mut s = start(b.model, 1e-4);
    run(&mut s, 1.0, 0.01);
    let (x0, v, spin) = (
        s.state().physical.q[0],
        s.state().physical.v[3],
        s.state().physical.v[1],
    );
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 1..=2000 {
        s.advance_to(1.0 + 1e-3 * f64::from(i)).expect("finite");
        low = low.min(s.state().physical.q[2]);
        high = high.max(s.state().physical.q[2]);
    }
    let odometry = s.state().physical.q[0] - x0 - 2.0 * 0.1 * spin;
    [high - low, odometry, v - 0.1 * spin]
}

/// C11. A cylinder wheel at 1 m/s is exactly round; a hull of 32 sides, as other simulators make of
/// it, is not.
#[test]
fn c11_a_rolling_wheel_is_exactly_round() {
    let [ripple, odometry, slip] = rolled(wheel(0.8));
    hold("C11", "vertical ripple at 1 m/s, m", "0", ripple, 0.0);
    hold("C11", "way in 2 s against ω R, m", "0", odometry, 0.0);
    hold("C11", "v − ω R, m/s", "0", slip, 0.0);
    let mut b = wheel(0.8);
    let corner = |i: i32, side: f64| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / 32.0);
        Vec3::new(0.1 * cos, 0.1 * sin, 0.05 * side)
    };
    let vertices = (0..32)
        .flat_map(|i| [corner(i, 1.0), corner(i, -1.0)])
        .collect();
    b.model.colliders.clear();
    b.shape(BASE, Shape::Hull { vertices }, Pose::IDENTITY);
    let [polygon, ..] = rolled(b);
    // The sagitta, less what the ground gives way under the corners.
    let sagitta = 0.1 * (1.0 - (std::f64::consts::PI / 32.0).cos());
    assert!(polygon > 0.5 * sagitta, "{polygon} {sagitta}");
}
