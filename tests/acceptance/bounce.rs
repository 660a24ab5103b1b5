//! C8, C10, C13: bounces, fast impacts and deep overlaps.

use super::*;

/// Rebound over approach speed of a ball of 1 kg, at the height of the touch-down, in gravity `g`.
///
/// - `step`: fixed, s; 0: under error control
fn restitution(e: f64, speed: f64, g: f64, tolerance: f64, step: f64) -> f64 {
    let mut b = ball(0.8);
    b.model.roots[0].position.z = 0.11;
    b.model.roots[0].linear_velocity.z = -speed;
    b.model.world.gravity = Vec3::new(0.0, 0.0, -g);
    b.model.links[0].restitution = e;
    b.model.solver.step_size = step;
    let mut s = start(b.model, tolerance);
    // Until it is out of the ground again; the contact lasts about √(m/k) and longer the less it
    // rebounds.
    for i in 1..=500 {
        s.advance_to(0.01 * f64::from(i) / speed).expect("finite");
        let (z, v) = (s.state().physical.q[2], s.state().physical.v[5]);
        if v > 0.0 && z > 0.1 {
            let square = v * v + 2.0 * g * (z - 0.1);
            return (square / (speed * speed + 2.0 * g * 0.01)).sqrt();
        }
    }
    0.0
}

/// C8. Newton's coefficient at every speed of impact, from 0.1 to 10 m/s, in gravity so light that
/// its own work during the contact (g t/v with t about 10 ms) does not show: to a share of itself.
/// The case asks for 1 % at 1e-4 and for 0.1 % at 1e-6.
#[test]
fn c8_a_ball_rebounds_with_the_coefficient_of_restitution_at_every_speed() {
    let table = [0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05];
    for (tolerance, allowed) in [
        (1e-3, [4e-3, 1.5e-2, 1.5e-2]),
        (1e-4, [1.5e-3, 5e-3, 1e-2]),
        (1e-6, [3e-3, 5e-4, 2e-3]),
    ] {
        for (speed, allowed) in [10.0, 1.0, 0.1].into_iter().zip(allowed) {
            let mut worst = 0.0_f64;
            for e in table {
                let rebound = restitution(e, speed, 1e-4 * speed, tolerance, 0.0);
                worst = worst.max((rebound / e - 1.0).abs());
            }
            let what = format!("e = 0.05 … 0.95 at {speed} m/s, relative, tol {tolerance:.0e}");
            hold("C8", &what, "Newton's e", worst, allowed);
        }
    }
}

/// C8. The same with fixed steps, which are longer than the contact lasts.
#[test]
fn c8_a_ball_rebounds_in_fixed_steps_too() {
    for (step, name) in [
        (1.0 / 60.0, "1/60 s"),
        (1.0 / 240.0, "1/240 s"),
        (1e-3, "1 ms"),
    ] {
        for (speed, allowed) in [(10.0, 4e-3), (1.0, 1.5e-2), (0.1, 1.5e-2)] {
            let mut worst = 0.0_f64;
            for e in [0.95, 0.8, 0.6, 0.4, 0.2, 0.05] {
                let rebound = restitution(e, speed, 1e-4 * speed, 1e-3, step);
                worst = worst.max((rebound / e - 1.0).abs());
            }
            let what = format!("e = 0.05 … 0.95 at {speed} m/s, relative, fixed steps of {name}");
            hold("C8", &what, "Newton's e", worst, allowed);
        }
    }
}

/// C10. A ball of 5 mm at 10 and 50 m/s: as deep in the ground as Hunt and Crossley's law lets it
/// in, K (½ x² + x⁵/5δ₁³) = m (v/d − ln(1 + d v)/d²), looked at every 10 µs while it is there; and
/// at rest after communication steps of 0.1 s, the first of which goes through the whole impact.
#[test]
fn c10_a_fast_small_ball_does_not_tunnel() {
    let sphere = Shape::Sphere { radius: 0.005 };
    let mut b = single(1e-3, [1e-8; 3], sphere, 0.8);
    b.model.roots[0].position.z = 0.1;
    for (tolerance, speed, deep, rests) in [
        (1e-3, 10.0, 2e-3, 5e-11),
        (1e-3, 50.0, 5e-2, 5e-11),
        (1e-4, 10.0, 1.5e-3, 4e-12),
        (1e-4, 50.0, 5e-2, 4e-12),
    ] {
        b.model.roots[0].linear_velocity.z = -speed;
        let mut s = start(b.model.clone(), tolerance);
        let (k, d) = (1e-3 * G / 0.5625e-4, s.tree().contact.dissipation);
        let v = (speed * speed + 2.0 * G * 0.095).sqrt();
        let energy = 1e-3 * (v / d - (d * v).ln_1p() / (d * d));
        let (mut deepest, mut more) = (0.0_f64, 3e-3);
        while more > 1e-12 {
            let x = deepest + more;
            if k * (0.5 * x * x + 0.2 * x.powi(5) * 1e12) <= energy {
                deepest = x;
            }
            more *= 0.5;
        }
        let mut lowest = f64::INFINITY;
        // It falls 0.1 m in 10 ms at most, and is deepest some milliseconds later.
        for i in 1..=5000 {
            s.advance_to(1e-5 * f64::from(i)).expect("finite");
            lowest = lowest.min(s.state().physical.q[2] - 0.005);
        }
        let beyond = -lowest / deepest - 1.0;
        let what = |what: &str| format!("{what}, {speed} m/s, tol {tolerance:.0e}");
        let (depth, law) = (what("greatest depth, relative"), "Hunt & Crossley, exact");
        hold("C10", &depth, law, beyond, deep);
        let mut s = start(b.model.clone(), tolerance);
        run(&mut s, 4.0, 0.1);
        let rest = s.state().physical.q[2] - (0.005 - 5e-5);
        let place = what("place of rest in communication steps of 0.1 s, m");
        hold("C10", &place, "law of stiffness", rest, rests);
    }
}

/// C13. A block 10 mm deep in the ground comes out no faster than its law allows: 1/d, and while
/// deeper than 50 δ at most 0.7 √(2 g (depth − 50 δ)), and does not hop.
#[test]
fn c13_an_initial_overlap_leaves_gently() {
    for (depth, allowed) in [(0.01, [1.6, 1.0]), (0.05, [1.0, 1.0])] {
        let mut b = block(0.5);
        b.model.roots[0].position.z = 0.1 - depth;
        let mut s = start(b.model, 1e-4);
        let slow = 1.0 / s.tree().contact.dissipation;
        let fast = 0.7
            * (2.0 * G * (depth - 50.0 * s.tree().contact.colliders[0].spring.reference)).sqrt();
        let (mut inside, mut outside, mut highest) = (0.0_f64, 0.0_f64, 0.0_f64);
        for i in 1..=2000 {
            s.advance_to(f64::from(i) * 1e-3).expect("finite");
            let (z, v) = (s.state().physical.q[2], s.state().physical.v[5]);
            inside = inside.max(v);
            if z > 0.1 - 1e-3 {
                outside = outside.max(v);
            }
            highest = highest.max(z);
        }
        let what = |what: &str| format!("{what}, {} mm deep", depth * 1e3);
        let expected = "at most max(1/d, 0.7√(2g(depth − 50δ)))";
        hold(
            "C13",
            &what("fastest inside, share of the most"),
            expected,
            inside / fast.max(slow),
            allowed[0],
        );
        hold(
            "C13",
            &what("fastest at the surface, share of the most"),
            "at most 1/d",
            outside / slow,
            allowed[1],
        );
        hold(
            "C13",
            &what("hop, m"),
            "none",
            (highest - 0.1).max(0.0),
            0.0,
        );
        let rest = s.state().physical.q[2] - (0.1 - 5e-5);
        hold(
            "C13",
            &what("place of rest, m"),
            "law of stiffness",
            rest,
            2e-12,
        );
    }
}
