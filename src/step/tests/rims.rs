//! Free rims of meshes without a thickness.

use super::terrain::{ground, mesh, over};
use super::worlds::{body, books};
use super::*;
use std::f64::consts::TAU;

/// A floor and a wall about it, of so many sides; the radius below and above and the height, m.
fn cup(sides: usize, [below, above, height]: [f64; 3]) -> Shape {
    let at = |i: usize, radius: f64, z: f64| {
        let angle = TAU * (i % sides) as f64 / sides as f64;
        Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
    };
    let side = |i: usize| {
        let [a, b] = [i, i + 1].map(|i| at(i, below, 0.0));
        let [d, c] = [i, i + 1].map(|i| at(i, above, height));
        [[Vec3::zeros(), a, b], [a, c, b], [a, d, c]]
    };
    mesh(&(0..sides).flat_map(side).collect::<Vec<_>>())
}

/// What may lean over a rim, of a length and a thickness, m.
fn rods(length: f64, thick: f64) -> [Shape; 4] {
    let (radius, half_length) = (0.5 * thick, 0.5 * length);
    let half = Vec3::new(radius, radius, half_length);
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(sign(1) * half.x, sign(2) * half.y, sign(4) * half.z)
    };
    [
        Shape::Cylinder {
            radius,
            half_length,
        },
        Shape::Box { half },
        Shape::Capsule {
            radius,
            half_length,
        },
        Shape::Hull {
            vertices: (0..8).map(corner).collect(),
        },
    ]
}

/// What leans over the free rim of a round wall gains no energy: above the rim there is no wall,
/// although the planes of its sides go on there. Contacts give back what they hold, at most a
/// hundredth of weight times length; thrown up by such planes, rods gained ten times as much. Nor
/// does what leans in the corner of four walls, of which none is nearer to one axis than to the
/// other, take a thousand tries where others take one.
#[test]
fn what_leans_over_the_free_rim_of_a_round_wall_gains_no_energy() {
    let mut random = Random(15);
    for case in 0..120 {
        let sides = 3 + (random.uniform(0.0, 8.0).exp2() * 0.3) as usize;
        let below = 0.1;
        let above = below * random.uniform(0.7, 1.5);
        let height = random.uniform(0.05, 0.2);
        let length = random.uniform(1.5, 4.0) * height;
        let thick = random.uniform(0.005, 0.04);
        let shape = rods(length, thick)[case % 4].clone();
        let free = 0.5 * below.min(above) - thick;
        let lean = random.uniform(0.1, 1.0) * f64::atan(free / height);
        let up = 0.5 * length * lean.cos() + thick + 0.001;
        let aside = random.uniform(-0.01, 0.01);
        let at = Vec3::new(0.5 * length * lean.sin(), aside, up);
        let mut one = body(0.1, shape.clone(), at);
        one.links[0].friction = 0.0;
        one.links[0].restitution = 0.0;
        one.roots[0].rpy = Vec3::new(random.uniform(-0.02, 0.02), lean, 0.0);
        let terrain = ground(cup(sides, [below, above, height]), Vec3::zeros());
        let mut s = start(over(terrain, one), [1e-3, 1e-5][case / 4 % 2]);
        let (mut least, mut gained) = (books(&s).2, 0.0);
        for i in 1..=200 {
            s.advance_to(0.005 * f64::from(i)).expect("finite");
            let held = books(&s).2;
            least = f64::min(least, held);
            gained = f64::max(gained, held - least);
        }
        let case = format!("{case}: {sides} sides, {above}, {height}, {shape:?}");
        assert!(gained < 0.01 * 0.1 * 9.81 * length, "{case}: {gained} J");
        let counters = s.state().stepping.counters;
        let tries = counters.steps + counters.rejected;
        assert!(tries < 8000, "{case}: {tries} tries");
    }
}
