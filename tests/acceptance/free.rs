//! A: no contact. Flight, spin, pendulums.

use super::*;

/// Complete elliptic integral of the first kind for the parameter m = k², by the
/// arithmetic–geometric mean.
fn elliptic_k(m: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (1.0 - m).sqrt());
    for _ in 0..10 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::FRAC_PI_2 / a
}

/// A2. `z = z0 − g t²/2` for 10 s while the body tumbles.
#[test]
fn a2_a_tumbling_body_falls_on_the_parabola() {
    let mut b = Builder::new(true, inertia(2.0, Vec3::zeros(), [0.01, 0.02, 0.025]));
    b.model.roots[0].angular_velocity = Vec3::new(1.0, 2.0, 3.0);
    for ((rules, name), allowed) in MOMENTUM.into_iter().zip([1e-12, 1e-12]) {
        let mut s = start(b.model.clone(), 1e-4);
        s.set_rules(rules);
        run(&mut s, 10.0, 0.01);
        let error = s.state().physical.q[2] + 0.5 * G * 100.0;
        let what = format!("z after 10 s, tol 1e-4{name}");
        hold("A2", &what, "−g t²/2", error, allowed);
    }
}

/// A2. The same of the centre of mass, when the frame of the base is not in it and everything must
/// cancel.
#[test]
fn a2_the_centre_of_mass_falls_on_the_parabola_wherever_the_frame_is() {
    let mut b = Builder::new(true, inertia(2.0, X * 0.1, [0.01, 0.02, 0.025]));
    let omega = Vec3::new(1.0, 2.0, 3.0);
    b.model.roots[0].angular_velocity = omega;
    let [with, without] = MOMENTUM;
    for (tolerance, (rules, name), allowed) in [
        (1e-4, with, 1e-12),
        (1e-8, with, 1e-12),
        (1e-4, without, 5e-5),
        (1e-8, without, 4e-9),
    ] {
        let mut s = start(b.model.clone(), tolerance);
        s.set_rules(rules);
        run(&mut s, 10.0, 0.01);
        let com = vector(&scenes::base_place(&mut s)) + rotation(&s, 3) * X * 0.1;
        let expected = X * 0.1 + omega.cross(&X) + Vec3::new(0.0, 0.0, -0.5 * G * 100.0);
        hold(
            "A2",
            &format!("centre of mass 0.1 m off the frame, 10 s, tol {tolerance:.0e}{name}"),
            "parabola",
            (com - expected).norm(),
            allowed,
        );
    }
}

/// A3. Torque-free body I = (1, 2, 3), ω = (1, 1, 1): ω has the period 4 K(1/2)/√(8/6) = 6.4227031
/// s (Landau & Lifshitz, Mechanics, §37); energy and angular momentum in the world keep their
/// values.
#[test]
fn a3_a_free_asymmetric_body_has_the_period_of_jacobis_functions() {
    let period = 4.0 * elliptic_k(0.5) / (8.0_f64 / 6.0).sqrt();
    assert!((period - 6.422_703_1).abs() < 1e-7);
    let I = Vec3::new(1.0, 2.0, 3.0);
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), I.into()));
    b.model.world.gravity = Vec3::zeros();
    let omega = Vec3::new(1.0, 1.0, 1.0);
    b.model.roots[0].angular_velocity = omega;
    let bounds = [[5e-9, 5e-9, 2e-15, 4e-10], [5e-9, 5e-9, 6e-10, 4e-10]];
    for (rules, allowed) in MOMENTUM.into_iter().zip(bounds) {
        hold_free_spin(&b.model, period, rules, allowed);
    }
}

/// The rows of A3 under some rules.
fn hold_free_spin(model: &Model, period: f64, (rules, name): (Rules, &str), allowed: [f64; 4]) {
    let (I, omega) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 1.0, 1.0));
    let mut s = start(model.clone(), 1e-8);
    s.set_rules(rules);
    run(&mut s, period, 0.1);
    let spin = |s: &Simulation| rotation(s, 3).transpose() * vector(&s.state().physical.v);
    // How much later ω = (1, 1, 1) comes back; ω̇ there by Euler's equations.
    let rate = Vec3::new(-1.0, 1.0, -1.0 / 3.0);
    let late = (omega - spin(&s)).dot(&rate) / rate.norm_squared();
    let expected = "4K(½)/√(8/6); Landau & Lifshitz §37";
    let what = |what: &str| format!("{what}{name}");
    hold(
        "A3",
        &what("period, s, tol 1e-8"),
        expected,
        late,
        allowed[0],
    );
    let off = (spin(&s) - omega).norm();
    hold(
        "A3",
        &what("ω after one period, rad/s, tol 1e-8"),
        expected,
        off,
        allowed[1],
    );
    let momentum = |s: &Simulation| rotation(s, 3) * I.component_mul(&spin(s));
    let drift = (momentum(&s) - I).norm() / I.norm();
    let momenta = what("angular momentum, relative");
    hold("A3", &momenta, "constant", drift, allowed[2]);
    let drift = s.output(OutputSlot::EnergyKinetic) / 3.0 - 1.0;
    hold(
        "A3",
        &what("energy, relative"),
        "constant",
        drift,
        allowed[3],
    );
}

/// A point mass on a massless rod of 1 m, held horizontally; q = π/2 is straight down.
fn pendulum() -> Model {
    let mut b = fixed();
    let bob = inertia(1.0, X, [0.0; 3]);
    b.link(BASE, Pose::IDENTITY, Motion::Revolute(Y), bob);
    b.model
}

/// A4. Released from horizontal: T = 4 K(1/2)/√g = 2.36784195 s (IFToMM benchmark A01). Looked at
/// where it is fastest, a quarter after the period: at its turning point an error of the period
/// would not show. The energy should drift by less than 1e-6 in 10 s.
#[test]
fn a4_a_pendulum_released_from_horizontal_has_the_exact_period() {
    let period = 4.0 * elliptic_k(0.5) / G.sqrt();
    assert!((period - 2.367_841_95).abs() < 1e-8);
    for (tolerance, off) in [(1e-4, 4e-6), (1e-8, 4e-10)] {
        let mut s = start(pendulum(), tolerance);
        let before = energy(&mut s);
        run(&mut s, 1.25 * period, 0.01);
        let late =
            (s.state().physical.q[0] - std::f64::consts::FRAC_PI_2) / s.state().physical.v[0];
        hold(
            "A4",
            &format!("time through the lowest point after 1¼ periods, s, tol {tolerance:.0e}"),
            "T = 4K(½)/√g; IFToMM A01",
            late,
            off,
        );
        let mut worst = 0.0_f64;
        while s.time() < 10.0 {
            let next = s.time() + 0.01;
            s.advance_to(next).expect("finite");
            worst = worst.max((energy(&mut s) - before).abs() / G);
        }
        let what = format!("energy in 10 s, share of m g l, tol {tolerance:.0e}");
        let expected = "constant; IFToMM A01";
        if tolerance > 1e-8 {
            let why = "errors per step add up";
            hold_or_say(["A4", &what, expected], worst, 1e-6, why);
        } else {
            hold("A4", &what, expected, worst, 4e-9);
        }
    }
}

/// Two point masses on two rods of 1 m; joint angles from straight down and from the first rod.
pub(crate) fn double_pendulum() -> Model {
    let mut b = fixed();
    let bob = inertia(1.0, -Z, [0.0; 3]);
    let first = b.link(BASE, Pose::IDENTITY, Motion::Revolute(-Y), bob);
    b.link(first, at(0.0, 0.0, -1.0), Motion::Revolute(-Y), bob);
    b.model.initial.joint_positions = vec![std::f64::consts::FRAC_PI_2, 0.0];
    b.model
}

/// Angles from the vertical and their rates after 2 s: Lagrange's equations of the two point
/// masses, `2θ̈₁ + c θ̈₂ = −s θ̇₂² − 2g sin θ₁`, `c θ̈₁ + θ̈₂ = s θ̇₁² − g sin θ₂` with c, s of θ₁
/// − θ₂, by the classical Runge–Kutta method in `count` steps.
fn lagrange(count: u32) -> [f64; 4] {
    let rates = |[a, b, u, w]: [f64; 4]| {
        let (s, c) = libm::sincos(a - b);
        let first = -s * w * w - 2.0 * G * libm::sin(a);
        let second = s * u * u - G * libm::sin(b);
        let bend = (first - c * second) / (2.0 - c * c);
        [u, w, bend, second - c * bend]
    };
    let h = 2.0 / f64::from(count);
    let add = |x: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    let mut x = [std::f64::consts::FRAC_PI_2; 4];
    (x[2], x[3]) = (0.0, 0.0);
    for _ in 0..count {
        let k1 = rates(x);
        let k2 = rates(add(x, k1, 0.5 * h));
        let k3 = rates(add(x, k2, 0.5 * h));
        let k4 = rates(add(x, k3, h));
        let mean = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
        x = add(x, mean, h);
    }
    x
}

/// A5. From (π/2, π/2) at rest, at 2 s: q = (−0.48297153, −1.32404871), v = (3.06528819,
/// 2.94927155), angles from the vertical, and more digits from Lagrange's equations.
#[test]
fn a5_a_double_pendulum_ends_at_the_reference() {
    let reference = lagrange(20_000);
    let known = [-0.482_971_53, -1.324_048_71, 3.065_288_19, 2.949_271_55];
    for ((fine, coarse), known) in reference.iter().zip(lagrange(10_000)).zip(known) {
        // Sixteen times as far off, and still to eleven digits.
        assert!((fine - coarse).abs() < 1e-11, "{fine} {coarse}");
        assert!((fine - known).abs() < 6e-9, "{fine} {known}");
    }
    let [a, b, u, w] = reference;
    for (tolerance, off, fast) in [(1e-4, 1e-5, 1e-4), (1e-6, 8e-8, 8e-7)] {
        let mut s = start(double_pendulum(), tolerance);
        run(&mut s, 2.0, 0.1);
        let (q, v) = (&s.state().physical.q, &s.state().physical.v);
        let position = (q[0] - a).abs().max((q[0] + q[1] - b).abs());
        let speed = (v[0] - u).abs().max((v[0] + v[1] - w).abs());
        let expected = "Lagrange's equations by Runge–Kutta in 20,000 steps";
        let name = format!("angles after 2 s, rad, tol {tolerance:.0e}");
        hold("A5", &name, expected, position, off);
        let name = format!("rates after 2 s, rad/s, tol {tolerance:.0e}");
        hold("A5", &name, expected, speed, fast);
    }
}

/// A7. A heavy symmetric top on its point, precessing steadily at 0.3 rad: I₁ cos θ Ω² − I₃ ω₃ Ω +
/// m g l = 0 (Goldstein, Classical Mechanics, §5.7), the slow root.
#[test]
fn a7_a_heavy_top_precesses_steadily_at_the_rate_of_euler() {
    let (mass, length, tilt, spin) = (1.0, 0.1, 0.3_f64, 12.0);
    let (across, along) = (0.02, 0.04);
    let I1 = across + mass * length * length;
    let (sin, cos) = tilt.sin_cos();
    let b = along * spin;
    let rate = (b - (b * b - 4.0 * I1 * cos * mass * G * length).sqrt()) / (2.0 * I1 * cos);
    for (tolerance, nods) in [(1e-4, 1.5e-5), (1e-8, 1e-9)] {
        let mut builder = fixed();
        let body = inertia(mass, Z * length, [across, across, along]);
        builder.link(BASE, Pose::IDENTITY, Motion::Spherical, body);
        let mut s = start(builder.model, tolerance);
        let state = s.state_mut();
        // Quaternion of a turn by θ about y; ω = Ω ẑ + spin in the top's own axes.
        state
            .physical
            .q
            .copy_from_slice(&[(0.5 * tilt).cos(), 0.0, (0.5 * tilt).sin(), 0.0]);
        state.physical.v.copy_from_slice(&[-rate * sin, 0.0, spin]);
        let (mut nod, mut off) = (0.0_f64, 0.0_f64);
        for i in 1..=200 {
            let t = 0.01 * f64::from(i);
            s.advance_to(t).expect("finite");
            let axis = rotation(&s, 0) * Z;
            nod = nod.max((axis.z - cos).abs());
            let expected = Vec3::new(sin * (rate * t).cos(), sin * (rate * t).sin(), cos);
            off = off.max((axis - expected).norm());
        }
        let name = format!("direction of the axis over 2 s, tol {tolerance:.0e}");
        let expected = "I₁ cos θ Ω² − I₃ω₃Ω + mgl = 0; Goldstein §5.7";
        if tolerance > 1e-8 {
            let why = "errors per step add up";
            hold_or_say(["A7", &name, expected], off, 1e-6, why);
        } else {
            hold("A7", &name, expected, off, 4e-9);
        }
        let name = format!("nutation over 2 s, tol {tolerance:.0e}");
        hold("A7", &name, "none", nod, nods);
    }
}
