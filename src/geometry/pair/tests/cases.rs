//! Places whose contact is known by hand.

use super::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

const REACH: f64 = 5e-3;

fn total(points: &[PatchPoint]) -> f64 {
    points.iter().map(|p| p.share).sum()
}

/// A big box whose top is the plane z = 0.
fn table() -> (Shape, Pose) {
    let half = Vec3::new(1.0, 1.2, 0.3);
    let pose = at(Vec3::new(0.1, -0.2, -0.3), Mat3::identity());
    (Shape::Box { half }, pose)
}

/// `shape` at `pose` on a big box, and on the plane z = 0.
fn on_both(shape: &Shape, pose: Pose) -> Vec<Patch> {
    let (table, place) = table();
    let on_box = find((shape, pose), (&table, place), REACH);
    let mut on_plane = Patch::new();
    let ground = Solid::half_space();
    on_plane.find((&solid(shape), &pose), (&ground, &Pose::IDENTITY), REACH);
    vec![on_box, on_plane]
}

#[test]
fn what_lies_flat_on_a_big_box_has_the_points_that_it_has_on_a_plane() {
    let random = &mut Random(5);
    let lying = turned(Vec3::x(), FRAC_PI_2);
    let (radius, half_length) = (0.04, 0.06);
    let capsule = Shape::Capsule {
        radius,
        half_length,
    };
    let cylinder = Shape::Cylinder {
        radius,
        half_length,
    };
    let face = |shape: &Shape| {
        let s = solid(shape);
        let down = crate::spatial::rotation_to_axis(&s.mesh.normals[0]);
        // That normal downwards.
        turned(Vec3::x(), std::f64::consts::PI) * down.transpose()
    };
    let hull = cloud(40, 0.06, random);
    let cases = [
        (
            Shape::Sphere { radius: 0.05 },
            Mat3::identity(),
            [1.0; 1].as_slice(),
            1e-12,
        ),
        (capsule, lying, &[0.5; 2], 1e-12),
        (cylinder.clone(), lying, &[0.5; 2], 1e-12),
        (cylinder, Mat3::identity(), &[0.5], 1e-12),
        (cube(0.05), Mat3::identity(), &[0.25; 4], 1e-12),
        (
            dodecahedron(0.05),
            face(&dodecahedron(0.05)),
            &[0.2; 5],
            1e-6,
        ),
        // Its faces are 20° from each other, and the nearest ones have a part of the weight.
        (hull.clone(), face(&hull), &[0.4, 0.38, 0.22], 1e-2),
    ];
    for (shape, R, shares, tolerance) in cases {
        let (count, whole) = (shares.len(), shares.iter().sum::<f64>());
        let R = turned(Vec3::z(), 0.7) * R;
        let down = -1e-4 - shape.lowest(&at(Vec3::zeros(), R), &Vec3::z());
        let pose = at(Vec3::new(0.2, 0.1, down), R);
        let both = on_both(&shape, pose);
        let (on_box, on_plane) = (&both[0], &both[1]);
        assert!((on_box.normal - Vec3::z()).norm() < 1e-12, "{shape:?}");
        let deep = |patch: &Patch| -> Vec<PatchPoint> {
            let list = patch.points().iter().copied();
            list.filter(|p| p.depth > -1e-3).collect()
        };
        let (found, expected) = (deep(on_box), deep(on_plane));
        assert_eq!(found.len(), count, "{shape:?} {found:?}");
        assert_eq!(expected.len(), count, "{shape:?} {expected:?}");
        assert!(
            (total(&found) - whole).abs() < tolerance,
            "{shape:?} {found:?}"
        );
        for p in &expected {
            let q = found
                .iter()
                .min_by(|a, b| (a.x - p.x).norm().total_cmp(&(b.x - p.x).norm()))
                .expect("a point");
            assert!((q.x - p.x).norm() < 1e-12, "{shape:?} {p:?} {q:?}");
            assert!((q.depth - p.depth).abs() < 1e-12, "{shape:?} {p:?} {q:?}");
            assert!((q.depth - 1e-4).abs() < 1e-8, "{shape:?} {q:?}");
            assert!(
                (q.share - p.share).abs() < tolerance,
                "{shape:?} {p:?} {q:?}"
            );
            assert_eq!(q.rim.is_some(), p.rim.is_some());
            if let (Some(found), Some(expected)) = (q.rim, p.rim) {
                assert!((found.a - expected.a).norm() < 1e-12);
                assert!((found.center - expected.center).norm() < 1e-12);
                assert!((found.axis - expected.axis).norm() < 1e-12);
            }
        }
    }
}

/// Two equal squares turned by 45° cover an octagon.
#[test]
fn faces_turned_by_45_degrees_have_eight_corners_of_one_depth() {
    let pose = at(
        Vec3::new(0.0, 0.0, 0.1 - 2e-4),
        turned(Vec3::z(), FRAC_PI_4),
    );
    let patch = find((&cube(0.05), pose), (&cube(0.05), Pose::IDENTITY), REACH);
    let points = patch.points();
    assert_eq!(points.len(), 8, "{points:?}");
    // Half width of the square over the cosine of 22.5°.
    let radius = 0.05 / libm::cos(FRAC_PI_4 / 2.0);
    for p in points {
        assert!((p.share - 0.125).abs() < 1e-12, "{p:?}");
        assert!((p.depth - 2e-4).abs() < 1e-14, "{p:?}");
        assert!((p.x.xy().norm() - radius).abs() < 1e-12, "{p:?}");
        assert!((p.x.z - (0.05 - 1e-4)).abs() < 1e-12, "{p:?}");
    }
}

#[test]
fn an_overhanging_box_ends_where_the_one_below_ends() {
    let pose = at(Vec3::new(0.07, 0.01, 0.1 - 1e-4), Mat3::identity());
    let patch = find((&cube(0.05), pose), (&cube(0.05), Pose::IDENTITY), REACH);
    let points = patch.points();
    assert_eq!(points.len(), 4);
    for p in points {
        let x = (p.x.x - 0.02).abs() < 1e-14 || (p.x.x - 0.05).abs() < 1e-14;
        let y = (p.x.y + 0.04).abs() < 1e-14 || (p.x.y - 0.05).abs() < 1e-14;
        assert!(x && y && (p.share - 0.25).abs() < 1e-12, "{p:?}");
        assert!((p.depth - 1e-4).abs() < 1e-14, "{p:?}");
    }
}

/// An edge along x over an edge along y: they cross at one point.
#[test]
fn crossed_edges_touch_in_one_point_with_a_quarter() {
    let root = 0.05 * 2.0_f64.sqrt();
    let up = at(
        Vec3::new(0.01, 0.0, 2.0 * root - 1e-4),
        turned(Vec3::x(), FRAC_PI_4),
    );
    let down = at(Vec3::zeros(), turned(Vec3::y(), FRAC_PI_4));
    let patch = find((&cube(0.05), up), (&cube(0.05), down), 1e-3);
    assert!((patch.normal - Vec3::z()).norm() < 1e-12);
    let deepest: Vec<_> = patch.points().iter().filter(|p| p.depth > 0.0).collect();
    assert_eq!(deepest.len(), 1, "{:?}", patch.points());
    let p = deepest[0];
    assert!((p.x - Vec3::new(0.0, 0.0, root - 5e-5)).norm() < 1e-12);
    assert!((p.depth - 1e-4).abs() < 1e-14 && (p.share - 0.25).abs() < 1e-12);
}

#[test]
fn a_corner_on_a_face_has_a_quarter_at_any_lean() {
    let random = &mut Random(17);
    for _ in 0..200 {
        let R = any_rotation(random);
        let shape = cube(0.05);
        let down = -1e-4 - shape.lowest(&at(Vec3::zeros(), R), &Vec3::z());
        let both = on_both(&shape, at(Vec3::new(0.0, 0.0, down), R));
        for patch in &both {
            let deepest = patch
                .points()
                .iter()
                .max_by(|p, q| p.depth.total_cmp(&q.depth));
            let p = deepest.expect("a point");
            assert!((p.depth - 1e-4).abs() < 1e-14, "{p:?}");
            assert!((p.share - 0.25).abs() < 1e-9, "{p:?}");
        }
    }
}

#[test]
fn a_capsule_on_a_box_has_its_ends_or_where_it_leaves_the_box() {
    let capsule = Shape::Capsule {
        radius: 0.02,
        half_length: 0.1,
    };
    let lying = turned(Vec3::y(), FRAC_PI_2);
    let pose = at(Vec3::new(0.08, 0.0, 0.07 - 1e-4), lying);
    let patch = find((&capsule, pose), (&cube(0.05), Pose::IDENTITY), 1e-3);
    let points = patch.points();
    assert_eq!(points.len(), 2, "{points:?}");
    for (p, x) in points.iter().zip([-0.02, 0.05]) {
        let matches = points.iter().any(|p| (p.x.x - x).abs() < 1e-12);
        assert!(matches && (p.share - 0.5).abs() < 1e-12 && (p.depth - 1e-4).abs() < 1e-14);
    }
    // Skew over an edge of the box, which is rounded by 1 mm: one point with half.
    let tilted = turned(Vec3::y(), FRAC_PI_2 + FRAC_PI_4);
    let off = 0.049 + (0.02 + 0.001 - 1e-4) / 2.0_f64.sqrt();
    let pose = at(Vec3::new(off, 0.0, off), tilted);
    let patch = find((&capsule, pose), (&cube(0.05), Pose::IDENTITY), 1e-3);
    let deepest: Vec<_> = patch.points().iter().filter(|p| p.depth > 0.0).collect();
    assert_eq!(deepest.len(), 1, "{:?}", patch.points());
    assert!((deepest[0].share - 0.5).abs() < 1e-9, "{deepest:?}");
    // Where both faces are tilted alike, the depth is that of the rounded edge.
    assert!((deepest[0].depth - 1e-4).abs() < 1e-12, "{deepest:?}");
}

#[test]
fn skew_capsules_touch_in_one_point_and_parallel_ones_in_two() {
    let capsule = Shape::Capsule {
        radius: 0.02,
        half_length: 0.1,
    };
    let crossed = at(
        Vec3::new(0.0, 0.01, 0.04 - 1e-4),
        turned(Vec3::x(), FRAC_PI_2),
    );
    let lying = at(Vec3::zeros(), turned(Vec3::y(), FRAC_PI_2));
    let patch = find((&capsule, crossed), (&capsule, lying), 1e-3);
    assert_eq!(patch.points().len(), 1);
    let p = patch.points()[0];
    assert!((p.share - 1.0).abs() < 1e-15 && (p.depth - 1e-4).abs() < 1e-15);
    assert!((p.x - Vec3::new(0.0, 0.0, 0.02 - 5e-5)).norm() < 1e-15);
    let shifted = at(Vec3::new(0.05, 0.0, 0.04 - 1e-4), lying.R);
    let patch = find((&capsule, shifted), (&capsule, lying), 1e-3);
    let points = patch.points();
    assert_eq!(points.len(), 2, "{points:?}");
    for x in [-0.05, 0.1] {
        let p = points
            .iter()
            .find(|p| (p.x.x - x).abs() < 1e-12)
            .expect("an end");
        assert!((p.share - 0.5).abs() < 1e-12 && (p.depth - 1e-4).abs() < 1e-12);
    }
}

/// Cans: one on the other, and one lying across the end of another.
#[test]
fn cylinders_stand_and_lie_on_cylinders() {
    let can = |radius: f64| Shape::Cylinder {
        radius,
        half_length: 0.05,
    };
    // The smaller one within the end of the other, above and below.
    let high = at(Vec3::new(0.005, 0.0, 0.1 - 1e-4), Mat3::identity());
    for (radii, side) in [((0.03, 0.04), Side::First), ((0.04, 0.03), Side::Second)] {
        let (up, down) = (can(radii.0), can(radii.1));
        let patch = find((&up, high), (&down, Pose::IDENTITY), REACH);
        let rims: Vec<_> = patch
            .points()
            .iter()
            .filter_map(|p| Some((p, p.rim?)))
            .collect();
        let share: f64 = rims.iter().map(|(p, _)| p.share).sum();
        let all: f64 = patch.points().iter().map(|p| p.share).sum();
        assert!(
            (share - 0.5).abs() < 1e-9 && (all - 0.5).abs() < 1e-9,
            "{rims:?}"
        );
        for (p, rim) in rims {
            assert_eq!(rim.side, side);
            assert!((p.depth - 1e-4).abs() < 1e-12, "{p:?}");
        }
    }
    let across = at(
        Vec3::new(0.0, 0.01, 0.09 - 1e-4),
        turned(Vec3::y(), FRAC_PI_2),
    );
    let patch = find((&can(0.04), across), (&can(0.03), Pose::IDENTITY), REACH);
    let points = patch.points();
    assert_eq!(points.len(), 2, "{points:?}");
    // Half of the chord at 1 cm, of a polygon of 16 corners.
    let chord = (0.03_f64.powi(2) - 0.01_f64.powi(2)).sqrt();
    for p in points {
        assert!(
            (p.share - 0.5).abs() < 1e-9 && (p.depth - 1e-4).abs() < 1e-12,
            "{p:?}"
        );
        assert!((p.x.x.abs() - chord).abs() < 0.02 * chord, "{p:?} {chord}");
    }
}

#[test]
fn nothing_is_found_beyond_the_reach() {
    let gap = |z: f64| at(Vec3::new(0.0, 0.0, 0.1 + z), Mat3::identity());
    let cube = cube(0.05);
    assert!(
        find((&cube, gap(1.9e-3)), (&cube, Pose::IDENTITY), 2e-3)
            .points()
            .len()
            == 4
    );
    assert!(
        find((&cube, gap(2.1e-3)), (&cube, Pose::IDENTITY), 2e-3)
            .points()
            .is_empty()
    );
}

/// How exactly the place of the nearest points of curved surfaces is known, m: the root of the part
/// of their distance that `cylinders.rs` does not settle.
const NEAREST: f64 = 1e-7;

/// The same points from both sides, and against a plane that is given first.
#[test]
fn exchanging_the_shapes_turns_the_normal_over() {
    let random = &mut Random(77);
    for round in 0..200 {
        let first = distances::kinds(random, 0.05).map(|shape| solid(&shape));
        let second = distances::kinds(random, 0.05).map(|shape| solid(&shape));
        for a in &first {
            for b in &second {
                let X = at(
                    random.unit() * 0.7 * (a.reach + b.reach),
                    any_rotation(random),
                );
                let Y = at(random.vector(0.01), any_rotation(random));
                let (mut there, mut back) = (Patch::new(), Patch::new());
                let found = there.find((a, &X), (b, &Y), 0.02);
                assert_eq!(found, back.find((b, &Y), (a, &X), 0.02), "round {round}");
                // Which of several axes of least overlap is found first is chance.
                if !found || there.deep {
                    continue;
                }
                assert!((there.normal + back.normal).norm() < 1e-9, "round {round}");
                for p in there.points() {
                    let same = |q: &&PatchPoint| {
                        (q.x - p.x).norm() < NEAREST
                            && (q.depth - p.depth).abs() < 1e-9
                            && q.rim.map(|r| r.side.other()) == p.rim.map(|r| r.side)
                    };
                    let sum = |patch: &Patch| -> f64 {
                        patch.points().iter().filter(same).map(|q| q.share).sum()
                    };
                    let own: f64 = there
                        .points()
                        .iter()
                        .filter(|q| (q.x - p.x).norm() < NEAREST)
                        .filter(|q| (q.depth - p.depth).abs() < 1e-9)
                        .filter(|q| q.rim.map(|r| r.side) == p.rim.map(|r| r.side))
                        .map(|q| q.share)
                        .sum();
                    let error = (sum(&back) - own).abs();
                    assert!(error < 1e-6, "round {round}: {p:?} {:?}", back.points());
                }
            }
        }
        let shape = &first[round % 5];
        let X = at(random.vector(0.02), any_rotation(random));
        let Y = at(random.vector(0.02), any_rotation(random));
        let (mut there, mut back) = (Patch::new(), Patch::new());
        let ground = Solid::half_space();
        assert!(there.find((shape, &X), (&ground, &Y), 1.0));
        assert!(back.find((&ground, &Y), (shape, &X), 1.0));
        assert_eq!(there.normal, -back.normal);
        assert_eq!(there.normal, Vec3::from(Y.R.column(2)));
        assert_eq!(there.points().len(), back.points().len());
    }
}
