//! Discs that wobble on their rim, against the closed form of steady motion.

use super::worlds::{body, books};
use super::*;
use crate::model::Ground;

const G: f64 = 9.81;

/// A thin disc of the radius `R` whose centre is at rest wobbles on its rim for ever: leaning by
/// `α` to the ground, its place of contact goes round with `Ω² sin α = 4 g/R`, and it turns about
/// the diameter to that place with `Ω sin α` (Moffatt 2000). Its energy is `3/2 m g R sin α`.
///
/// A cylinder has penetration and damping, which take up to 5 %. Fixed steps in which the place
/// goes round by 0.1 to 0.5 rad had one solve each, which took half of the energy and more.
#[test]
fn a_disc_that_wobbles_keeps_its_energy_in_steps_of_any_length() {
    for (radius, lean) in [(0.1, 0.4_f64), (0.1, 0.15), (0.04, 0.3), (0.0125, 0.3)] {
        for rate in [220.0, 240.0, 260.0, 480.0, 0.0] {
            let around = (4.0 * G / (radius * lean.sin())).sqrt();
            let shape = Shape::Cylinder {
                radius,
                half_length: 0.005 * radius,
            };
            let high = radius * lean.sin() + 0.005 * radius * lean.cos();
            let mut disc = body(0.5, shape, Vec3::new(0.0, 0.0, high));
            disc.links[0].friction = 3.0;
            disc.world.ground = Some(Ground {
                friction: 3.0,
                ..Ground::default()
            });
            let root = &mut disc.roots[0];
            root.rpy.x = lean;
            root.angular_velocity = Vec3::new(0.0, lean.cos(), lean.sin()) * (around * lean.sin());
            disc.solver.step_size = if rate > 0.0 { 1.0 / rate } else { 0.0 };
            let mut s = start(disc, 1e-3);
            let begin = 1.5 * 0.5 * G * radius * lean.sin();
            run(&mut s, 0.5, 1.0 / if rate > 0.0 { rate } else { 240.0 });
            let kept = books(&s).2 / begin;
            assert!(
                (kept - 1.0).abs() < 0.05,
                "{radius} m leaning by {lean} rad, {rate} steps a second: {kept}"
            );
        }
    }
}
