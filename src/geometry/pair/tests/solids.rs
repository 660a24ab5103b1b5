//! Meshes of floors with holes, and of solids that go through each other.

#![allow(clippy::cast_precision_loss, reason = "small counts")]

use super::meshes::sides;
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
pub(crate) fn floor_with_hole(sides: usize, radius: f64) -> Vec<[Vec3; 3]> {
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

/// What lies at the foot of a ramp that comes out of a floor and is drawn down below it, as two
/// solids of one mesh: each carries it by its own plane. While the middle of a triangle told
/// whether it was behind another one, half of the floor, whose middle is below the plane of the
/// ramp, carried nothing there: boxes sank in by 30 mm, capsules by 51 mm.
#[test]
fn a_ramp_that_goes_through_a_floor_hides_nothing_of_it() {
    let seed = 31;
    let mut random = Random(seed);
    let r = 0.05;
    for case in 0..200 {
        let angle: f64 = random.uniform(0.2, 1.4);
        let n = Vec3::new(angle.sin(), 0.0, angle.cos());
        let tilt = turned(Vec3::y(), angle);
        // Its upper face goes through the axis y.
        let slope = sides(Vec3::new(-0.6, -0.4, -0.1), Vec3::new(0.4, 0.4, 0.0));
        let mut triangles = sides(Vec3::new(-1.5, -1.0, -0.1), Vec3::new(1.5, 1.0, 0.0));
        triangles.extend(slope.iter().map(|t| t.map(|c| tilt * c)));
        let ground = ground(&triangles);
        // By so much it is in the floor and in the ramp.
        let deep = [random.uniform(1e-5, 1e-3), random.uniform(1e-5, 1e-3)];
        let box_corner = Vec3::new(-r, 0.0, -r);
        let y = random.uniform(-0.2, 0.2);
        let (name, shape, lowest, R) = match case % 3 {
            0 => (
                "ball",
                Shape::Sphere { radius: r },
                [Vec3::z() * -r, n * -r],
                Mat3::identity(),
            ),
            1 => (
                "capsule",
                Shape::Capsule {
                    radius: r,
                    half_length: r,
                },
                [Vec3::z() * -r, n * -r],
                turned(Vec3::x(), FRAC_PI_2),
            ),
            _ => ("box", cube(r), [box_corner, box_corner], Mat3::identity()),
        };
        let z = -deep[0] - lowest[0].z;
        let x = (-deep[1] - n.dot(&lowest[1]) - n.z * z) / n.x;
        let mut patch = Patch::new();
        let X = at(Vec3::new(x, y, z), R);
        patch.find((&solid(&shape), &X), (&ground, &Pose::IDENTITY), 0.0);
        for (normal, deep, from) in [(Vec3::z(), deep[0], "floor"), (n, deep[1], "ramp")] {
            let on = |p: &&PatchPoint| (p.normal - normal).norm() < 1e-9;
            let points = patch.points().iter().filter(on).copied();
            let found = points.map(|p| p.depth).fold(0.0, f64::max);
            assert!(
                (found - deep).abs() < 1e-9,
                "seed {seed}, case {case}, {name} on the {from}, {angle} rad: {found}, not {deep} m"
            );
        }
    }
}

/// A capsule that lies across an edge of an upright plate, with its middle on one side and an end
/// on the other: it is as deep as its axis is nearer to the edge than its radius. That end was
/// up to 77 mm deep in the side that the middle is in front of, though the plate is 4 mm thick.
#[test]
fn the_end_of_a_capsule_beyond_a_plate_is_not_in_its_near_side() {
    let (seed, deep, radius, half_length) = (37, 1e-4, 0.02, 0.08);
    let mut random = Random(seed);
    let plate = sides(Vec3::new(-2e-3, -0.5, -0.1), Vec3::new(2e-3, 0.5, 0.0));
    let ground = ground(&plate);
    let capsule = solid(&Shape::Capsule {
        radius,
        half_length,
    });
    for case in 0..100 {
        let (tilt, before) = (random.uniform(0.5, 0.8), random.uniform(0.03, 0.04));
        let edge = Vec3::new(2e-3, random.uniform(-0.2, 0.2), 0.0);
        let R = turned(Vec3::y(), FRAC_PI_2 + tilt);
        let (axis, across) = (R.column(2), R.column(0));
        let p = edge - across * (radius - deep) - axis * before;
        let end = p + axis * half_length;
        assert!(p.x < -2e-3 && end.x > 2e-3 && end.z < 0.0, "{p}, {end}");
        let mut patch = Patch::new();
        let X = at(p, R);
        patch.find((&capsule, &X), (&ground, &Pose::IDENTITY), 0.0);
        let deepest = patch.points().iter().map(|p| p.depth).fold(0.0, f64::max);
        let label = format!("seed {seed}, case {case}, {tilt} rad, {before} m");
        assert!((deepest - deep).abs() < 1e-9, "{label}: {deepest} m");
    }
}

/// A box over a hole in a floor that leans by less than a degree: its lowest corner is as deep as
/// it is below the floor, nothing is deeper, and no normal leans more than the box. A corner that
/// was above the floor was 50 mm deep behind the walls of the hole, which do not reach it:
/// what went on beyond their upright edges did so above their ends, too.
#[test]
fn a_face_over_a_hole_lies_on_the_floor_about_it() {
    let (seed, half) = (41, 0.05);
    let mut random = Random(seed);
    let thing = solid(&cube(half));
    for sides in [4, 6, 16, 32, 64] {
        let ground = ground(&floor_with_hole(sides, random.uniform(0.2, 0.6) * half));
        for case in 0..100 {
            let (tilt, angle) = (random.uniform(0.0, 0.01), random.uniform(0.0, TAU));
            let R = turned(Vec3::new(angle.cos(), angle.sin(), 0.0), tilt)
                * turned(Vec3::z(), random.uniform(0.0, TAU));
            let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
            let corners = signs.map(|[x, y]| R * Vec3::new(x * half, y * half, -half));
            let lowest = corners.iter().map(|c| c.z).fold(0.0, f64::min);
            let deep = random.uniform(1e-5, 5e-4);
            let mut place = || random.uniform(-0.01, 0.01);
            let X = at(Vec3::new(place(), place(), -lowest - deep), R);
            let mut patch = Patch::new();
            patch.find((&thing, &X), (&ground, &Pose::IDENTITY), 0.0);
            let deepest = patch.points().iter().map(|p| p.depth).fold(0.0, f64::max);
            let leaning = patch.points().iter().map(|p| p.normal.angle(&Vec3::z()));
            let leaning = leaning.fold(0.0, f64::max);
            let label = format!("seed {seed}, {sides} sides, case {case}, {tilt} rad");
            assert!(
                (deepest - deep).abs() < 1e-9,
                "{label}: {deepest}, not {deep} m"
            );
            assert!(
                leaning < tilt + 1e-6,
                "{label}: a normal leans by {leaning} rad"
            );
        }
    }
}
