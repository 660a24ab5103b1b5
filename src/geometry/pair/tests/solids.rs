//! Meshes of floors with holes.

#![allow(clippy::cast_precision_loss, reason = "small counts")]

use super::*;
use crate::geometry::surface::{Surface, Triangles};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// What is carried by a mesh.
fn ground(triangles: &[[Vec3; 3]]) -> Solid {
    let surface = Surface::try_from(Triangles::new(triangles)).expect("a mesh");
    let surface = Arc::new(surface);
    solid(&Shape::Surface { surface })
}

/// An even floor of 0.3 m about a hole of so many sides and of a radius, m, 0.1 m deep.
fn floor_with_hole(sides: usize, radius: f64) -> Vec<[Vec3; 3]> {
    let rings = [[0.3, 0.0], [radius, 0.0], [0.99 * radius, -0.1]];
    let corner = |ring: usize, side: usize| {
        let ([r, z], angle) = (rings[ring], (side % sides) as f64 * TAU / sides as f64);
        Vec3::new(r * angle.cos(), r * angle.sin(), z)
    };
    let places = (0..2).flat_map(|ring| (0..sides).map(move |side| (ring, side)));
    let pairs = places.flat_map(|(ring, side)| {
        let [a, b] = [corner(ring, side), corner(ring, side + 1)];
        let [c, d] = [corner(ring + 1, side), corner(ring + 1, side + 1)];
        [[a, b, c], [b, d, c]]
    });
    pairs.collect()
}

/// All of the floor is below z = 0: what goes below that by 0.1 mm is no deeper in it, and is if it
/// does so beside the hole. A ball beside a hole that was about as wide as it was pushed by the
/// walls that it was above, up to 43 mm deep: their lower halves went on above the floor, beyond
/// the corner where they meet the next wall.
#[test]
fn what_lies_beside_a_hole_is_above_its_walls() {
    let (seed, deep) = (29, 1e-4);
    let mut random = Random(seed);
    let (radius, half_length) = (0.05, 0.04);
    let things = [
        ("ball", Shape::Sphere { radius }, radius),
        (
            "capsule",
            Shape::Capsule {
                radius,
                half_length,
            },
            radius,
        ),
        ("box", cube(radius), radius),
    ];
    for sides in [4, 5, 8, 16, 24, 48] {
        let hole = random.uniform(0.5, 2.0) * radius;
        let ground = ground(&floor_with_hole(sides, hole));
        for case in 0..300 {
            let (name, shape, height) = &things[case % things.len()];
            let (at_angle, way) = (random.uniform(0.0, TAU), random.uniform(0.0, 0.18));
            let turn = turned(Vec3::z(), random.uniform(0.0, TAU));
            let lying = turned(Vec3::x(), FRAC_PI_2);
            let p = Vec3::new(way * at_angle.cos(), way * at_angle.sin(), height - deep);
            let mut patch = Patch::new();
            let X = at(p, turn * lying);
            patch.find((&solid(shape), &X), (&ground, &Pose::IDENTITY), 0.0);
            let deepest = patch.points().iter().map(|p| p.depth).fold(0.0, f64::max);
            let label = format!("seed {seed}, {sides} sides, {name} {case}, {way} m");
            assert!(deepest <= deep * (1.0 + 1e-9), "{label}: {deepest} m");
            let wide = 0.5 * deep * f64::from(u8::from(way > hole));
            assert!(deepest >= wide, "{label}: {deepest} m");
        }
    }
}
