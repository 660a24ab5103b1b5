//! Meshes as files have them.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]

use super::*;
use crate::geometry::surface::{Surface, Triangles};
use crate::spatial::{quaternion_normalized, rotation_from_quaternion};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

type Triangle = [Vec3; 3];

/// An even floor over `from` … `to` along x and −2 … 2 m along y, of cells of an edge.
fn floor([from, to]: [f64; 2], cell: f64) -> Vec<Triangle> {
    let count = |way: f64| (way / cell).round() as usize;
    let at = |i: usize, j: usize| Vec3::new(from + i as f64 * cell, j as f64 * cell - 2.0, 0.0);
    let cells = (0..count(4.0)).flat_map(|j| (0..count(to - from)).map(move |i| (i, j)));
    let pairs = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    pairs.collect()
}

/// The sides of a box.
pub(super) fn sides(low: Vec3, high: Vec3) -> Vec<Triangle> {
    let corner = |i: usize| {
        let at = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        Vec3::new(at(0), at(1), at(2))
    };
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = quads.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let triangles = halves.as_flattened().iter();
    triangles.map(|t| t.map(corner)).collect()
}

/// A floor of closed boxes over `from` … `to` along x and −2 … 2 m along y.
fn boxes([from, to]: [f64; 2], cell: f64) -> Vec<Triangle> {
    let count = |way: f64| (way / cell).round() as usize;
    let cells = (0..count(4.0)).flat_map(|j| (0..count(to - from)).map(move |i| (i, j)));
    let places = cells.flat_map(|(i, j)| {
        let at = |i: usize, j: usize, z: f64| {
            Vec3::new(from + i as f64 * cell, j as f64 * cell - 2.0, z)
        };
        sides(at(i, j, -0.2), at(i + 1, j + 1, 0.0))
    });
    places.collect()
}

/// Floors that are even but for how they are drawn.
fn floors(random: &mut Random) -> Vec<(&'static str, Vec<Triangle>)> {
    let even = floor([-2.0, 2.0], 0.2);
    let again = |turn: fn(&Triangle) -> Triangle| {
        let twice = even.iter().copied().chain(even.iter().map(turn));
        twice.collect::<Vec<_>>()
    };
    let mut halves = floor([-2.0, 0.0], 0.2);
    halves.extend(floor([0.0, 2.0], 1.0 / 15.0));
    let rim = |k: usize| {
        let angle = TAU * k as f64 / 2000.0;
        Vec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0)
    };
    let mut rows = boxes([-2.0, 0.0], 0.5);
    rows.extend(boxes([0.0, 2.0], 0.1));
    let gap = 1e-7;
    let mut shift = || Vec3::new(random.uniform(-gap, gap), random.uniform(-gap, gap), 0.0);
    vec![
        ("every triangle twice", again(|t| *t)),
        ("from below, too", again(|&[a, b, c]| [a, c, b])),
        ("T-junctions", halves),
        (
            "slivers",
            (0..2000)
                .map(|k| [Vec3::zeros(), rim(k), rim(k + 1)])
                .collect(),
        ),
        ("boxes side by side", boxes([-2.0, 2.0], 0.2)),
        ("boxes of two sizes", rows),
        (
            "gaps",
            even.iter().map(|t| t.map(|c| c + shift())).collect(),
        ),
    ]
}

/// Depth, direction and centre of what presses.
fn pressed(patch: &Patch) -> (f64, Vec3, Vec3) {
    let (mut sum, mut normal, mut center, mut total) = (0.0, Vec3::zeros(), Vec3::zeros(), 0.0);
    for p in patch.points() {
        let depth = p.depth.max(0.0);
        let weight = p.share * depth.powi(3);
        sum += weight * depth;
        total += weight;
        normal += p.normal * weight;
        center += p.x * weight;
    }
    (sum.powf(0.25), normal / total, center / total)
}

/// What a shape presses into a plane and into a floor where it is so deep in the plane, m, at a
/// random place and yaw.
fn pressed_in_both(
    (one, [roll, pitch]): (&Solid, [f64; 2]),
    floors: [&Solid; 2],
    deep: f64,
    random: &mut Random,
) -> [(f64, Vec3, Vec3); 2] {
    let yaw = random.uniform(0.0, TAU);
    let R = *nalgebra::Rotation3::from_euler_angles(roll, pitch, yaw).matrix();
    let [x, y] = [0, 1].map(|_| random.uniform(-1.0, 1.0));
    let mut X = at(Vec3::new(x, y, 0.5), R);
    let mut patch = Patch::new();
    patch.find((one, &X), (floors[0], &Pose::IDENTITY), 1.0);
    let highest = patch.points().iter().map(|p| p.depth);
    X.p.z += highest.fold(f64::NEG_INFINITY, f64::max) - deep;
    floors.map(|floor| {
        patch.find((one, &X), (floor, &Pose::IDENTITY), 1e-3);
        pressed(&patch)
    })
}

/// Triangles that are there twice or from both sides, whose corners lie in the midst of others'
/// sides, and that a file has torn apart by its digits: all are a plane.
#[test]
fn meshes_that_are_no_clean_surfaces_carry_like_clean_ones() {
    let seed = 11;
    let mut random = Random(seed);
    let plane = solid(&Shape::Plane);
    let lying = Vec3::new(FRAC_PI_2, 0.0, 0.0);
    let (radius, half_length) = (0.1, 0.03);
    let things = [
        ("ball", Shape::Sphere { radius }, Vec3::zeros()),
        (
            "capsule",
            Shape::Capsule {
                radius: 0.03,
                half_length: 0.1,
            },
            lying,
        ),
        (
            "wheel",
            Shape::Cylinder {
                radius,
                half_length,
            },
            lying,
        ),
        (
            "can",
            Shape::Cylinder {
                radius: 0.05,
                half_length: 0.06,
            },
            Vec3::zeros(),
        ),
        ("box", cube(0.07), Vec3::zeros()),
        ("hull", dodecahedron(0.06), Vec3::new(0.3, 0.2, 0.0)),
    ];
    for (name, list) in floors(&mut random) {
        let surface = Surface::try_from(Triangles::new(&list)).expect("triangles");
        let ground = solid(&Shape::Surface {
            surface: Arc::new(surface),
        });
        for (what, shape, tilt) in &things {
            let one = solid(shape);
            for case in 0..100 {
                let mut lean = |x: f64| x + random.uniform(-0.01, 0.01) * f64::from(case % 2);
                let (roll, pitch) = (lean(tilt.x), lean(tilt.y));
                let leaning = (&one, [roll, pitch]);
                let [(depth, n, c), (d, m, k)] =
                    pressed_in_both(leaning, [&plane, &ground], 1e-4, &mut random);
                assert!(
                    (d / depth - 1.0).abs() < 1e-6
                        && (m - n).norm() < 1e-9
                        && (k - c).norm() < 1e-6,
                    "{name}, {what}, seed {seed}, case {case}: {d} of {depth}, {k} of {c}"
                );
            }
        }
    }
}

/// What has struck such floors is deep in them as in a plane, also where a floor is drawn from
/// below, too: deeper than a shape is round, a corner counts only where it has come through.
#[test]
fn what_is_deep_in_meshes_that_are_no_clean_surfaces_is_as_deep_as_in_a_plane() {
    let seed = 12;
    let mut random = Random(seed);
    let plane = solid(&Shape::Plane);
    let (radius, half_length) = (0.05, 0.06);
    let can = Shape::Cylinder {
        radius,
        half_length,
    };
    let things = [
        ("can", can),
        ("box", cube(0.07)),
        ("hull", dodecahedron(0.06)),
    ];
    for (name, list) in floors(&mut random) {
        let surface = Surface::try_from(Triangles::new(&list)).expect("triangles");
        let ground = solid(&Shape::Surface {
            surface: Arc::new(surface),
        });
        for (what, shape) in &things {
            let one = solid(shape);
            for case in 0..60 {
                let [roll, pitch] = [0, 1].map(|_| random.uniform(-0.3, 0.3));
                let leaning = (&one, [roll, pitch]);
                let [(depth, n, _), (d, m, _)] =
                    pressed_in_both(leaning, [&plane, &ground], 5e-3, &mut random);
                assert!(
                    (d / depth - 1.0).abs() < 1e-4 && (m - n).norm() < 1e-9,
                    "{name}, {what}, seed {seed}, case {case}: {d} of {depth}"
                );
            }
        }
    }
}

/// A can on a round hill of triangles that meet at less than 0.1°: their edges count as even, and
/// the lowest point of the can along the normal of each triangle is beyond it.
#[test]
fn a_can_on_a_hill_of_small_triangles_stands_on_the_one_below_it() {
    let (count, extent, bend) = (30, 0.3, 10.0);
    let at_corner = |i: usize, j: usize| {
        let place = |i: usize| (i as f64 / f64::from(count) - 0.5) * extent;
        let (x, y) = (place(i), place(j));
        Vec3::new(x, y, -0.5 * (x * x + y * y) / bend)
    };
    let cells = (0..count as usize).flat_map(|j| (0..count as usize).map(move |i| (i, j)));
    let pairs = cells.flat_map(|(i, j)| {
        let [a, b] = [at_corner(i, j), at_corner(i + 1, j)];
        let [c, d] = [at_corner(i + 1, j + 1), at_corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let surface = Surface::try_from(Triangles::new(&pairs.collect::<Vec<_>>())).expect("a hill");
    let ground = solid(&Shape::Surface {
        surface: Arc::new(surface),
    });
    let can = solid(&Shape::Cylinder {
        radius: 0.05,
        half_length: 0.06,
    });
    let mut random = Random(5);
    for case in 0..200 {
        let (x, y) = (random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05));
        let height = -0.5 * (x * x + y * y) / bend;
        let X = at(Vec3::new(x, y, height + 0.06 - 1e-3), Mat3::identity());
        let mut patch = Patch::new();
        patch.find((&can, &X), (&ground, &Pose::IDENTITY), 1e-3);
        let (depth, normal, _) = pressed(&patch);
        // One rim carries half; the hill falls by 5e-3 rad within the radius.
        let level = depth / 0.5_f64.powf(0.25);
        assert!(
            (0.7e-3..1.5e-3).contains(&level) && normal.z > 0.9999,
            "seed 5, case {case}: {level} m, {normal}"
        );
    }
}

/// A can over the edge of a step of a mesh of few triangles, leaning into the free: its low rim is
/// over the lower level, 1 to 4 cm below the upper one. It touches nothing, as the same can over a
/// closed step does, but was as deep in the upper level as its rim is below that.
#[test]
fn the_rim_of_a_can_before_a_step_is_not_in_its_tread() {
    let corner = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let quad = |[a, b, c, d]: [Vec3; 4]| [[a, b, c], [a, c, d]];
    let level = |from: f64, to: f64, z: f64| {
        quad([
            corner(from, -1.0, z),
            corner(to, -1.0, z),
            corner(to, 1.0, z),
            corner(from, 1.0, z),
        ])
    };
    let riser = quad([
        corner(0.0, 1.0, 0.0),
        corner(0.0, -1.0, 0.0),
        corner(0.0, -1.0, 0.3),
        corner(0.0, 1.0, 0.3),
    ]);
    let list = [level(-1.0, 0.0, 0.0), riser, level(0.0, 1.0, 0.3)].concat();
    let surface = Surface::try_from(Triangles::new(&list)).expect("a step");
    let ground = solid(&Shape::Surface {
        surface: Arc::new(surface),
    });
    let (radius, half_length) = (0.1, 0.04);
    let can = solid(&Shape::Cylinder {
        radius,
        half_length,
    });
    let mut patch = Patch::new();
    for lean in [0.1, 0.25, 0.4] {
        for over in [-0.03, 0.003, 0.01, 0.05] {
            // The edge is 10 µm below the lower end, so far from its middle.
            let R = turned(Vec3::y(), -lean);
            let end = Vec3::new(0.0, 0.0, 0.3 + 1e-5) + R * Vec3::new(over, 0.0, half_length);
            let touches = patch.find((&can, &at(end, R)), (&ground, &Pose::IDENTITY), 0.02);
            let deepest = patch.points().iter().map(|p| p.depth).fold(-1.0, f64::max);
            assert!(touches && deepest < 1e-4, "{lean} {over}: {deepest}");
        }
    }
}

/// A can whose lower rim is beyond one edge of the top of a thin wall, and the middle of its end
/// beyond the other edge: the edges alone carry it, as those of a box do. The first place is 2.5 mm
/// above the wall, the last one 5 mm in it, where a step of 1/240 s at 1.8 m/s may end: the edge
/// was felt to overlap least with the side of the can, in a direction in which it does not push,
/// and a can that was dropped fell through the wall.
#[test]
fn a_can_across_the_top_of_a_thin_wall_lies_on_its_edges() {
    let half = Vec3::new(0.01, 0.17, 0.06);
    let list = sides(Vec3::new(-0.01, -0.17, 0.0), Vec3::new(0.01, 0.17, 0.12));
    let surface = Surface::try_from(Triangles::new(&list)).expect("a wall");
    let ground = solid(&Shape::Surface {
        surface: Arc::new(surface),
    });
    let wall = solid(&Shape::Box { half });
    let can = solid(&Shape::Cylinder {
        radius: 0.033,
        half_length: 0.06,
    });
    let mut patch = Patch::new();
    for (p, q) in [
        (
            Vec3::new(-0.00625, 0.00483, 0.18817),
            [0.98121, 0.06703, 0.08457, 0.15996],
        ),
        (
            Vec3::new(-0.00658, 0.00446, 0.18528),
            [0.98162, 0.06345, 0.08288, 0.15978],
        ),
        (
            Vec3::new(-0.00571, 0.00358, 0.18063),
            [0.98219, 0.06182, 0.08919, 0.15340],
        ),
    ] {
        let X = at(p, rotation_from_quaternion(&quaternion_normalized(&q)));
        let mut deepest = |other: &Solid, Y: &Pose| {
            patch.find((&can, &X), (other, Y), 0.02);
            let depths = patch.points().iter().filter(|p| p.normal.z > 0.9);
            depths.map(|p| p.depth).fold(-1.0, f64::max)
        };
        let on_mesh = deepest(&ground, &Pose::IDENTITY);
        let on_box = deepest(&wall, &at(Vec3::z() * 0.06, Mat3::identity()));
        assert!((on_mesh - on_box).abs() < 3e-4, "{p}: {on_mesh} {on_box}");
    }
}
