//! Machines with closed loops: every moment beside their closed-form kinematics.

use super::run;
use std::f64::consts::{PI, TAU};

/// A point of a plane.
type Point = [f64; 2];

fn apart(a: Point, b: Point) -> f64 {
    f64::hypot(a[0] - b[0], a[1] - b[1])
}

fn direction(from: Point, to: Point) -> f64 {
    f64::atan2(to[1] - from[1], to[0] - from[0])
}

/// The angle between the sides `a` and `b` of a triangle, across from `c`.
fn across(a: f64, b: f64, c: f64) -> f64 {
    f64::acos((a * a + b * b - c * c) / (2.0 * a * b))
}

/// What is left of a turn.
fn turned(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// The platform is where three spheres meet: rods of 0.7 m about the elbows, moved inwards by the
/// platform's radius. It does not turn.
#[test]
fn a_delta_robot_is_where_three_spheres_meet() {
    let run = run("worlds/delta.urdf", "delta", 2.0);
    let angles: Vec<_> = (1..=3)
        .map(|i| run.column(&format!("joint.shoulder_{i}.position")))
        .collect();
    // The settings say so, and the platform, which floats, can follow.
    for angles in &angles {
        assert!((angles[0] - 0.2).abs() < 1e-9, "{}", angles[0]);
    }
    let [x, y, z] = ["x", "y", "z"].map(|a| run.column(&format!("link.platform.position.{a}")));
    let mut moved: f64 = 0.0;
    for i in 0..run.time.len() {
        let centers: Vec<[f64; 3]> = [0.0, 1.0, 2.0]
            .into_iter()
            .zip(&angles)
            .map(|(arm, angles)| {
                let (turn, angle) = (TAU * arm / 3.0, angles[i]);
                let radius = 0.2 + 0.3 * angle.cos() - 0.06;
                [
                    radius * turn.cos(),
                    radius * turn.sin(),
                    1.0 - 0.3 * angle.sin(),
                ]
            })
            .collect();
        // What lies on two of the spheres lies on a plane: two planes leave a line.
        let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let from = centers[0];
        let [a, b] = [1, 2].map(|k| minus(centers[k], from));
        let normal = [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ];
        // Foot of the line: s a + t b with equal distances.
        let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
        let d = aa * bb - ab * ab;
        let (s, t) = (
            (0.5 * aa * bb - 0.5 * bb * ab) / d,
            (0.5 * bb * aa - 0.5 * aa * ab) / d,
        );
        let foot = [0, 1, 2].map(|k| s * a[k] + t * b[k]);
        let height = ((0.49 - dot(foot, foot)) / dot(normal, normal)).sqrt();
        let sign = -normal[2].signum();
        for (k, column) in [x, y, z].into_iter().enumerate() {
            let expected = from[k] + foot[k] + sign * height * normal[k];
            let found = column[i];
            assert!(
                (found - expected).abs() < 1e-9,
                "{}: {found} {expected}",
                run.time[i]
            );
        }
        let turn = run.column("link.platform.orientation.w")[i];
        assert!((turn.abs() - 1.0).abs() < 1e-12, "{}: {turn}", run.time[i]);
        moved = moved.max((x[i] - x[0]).abs());
        let gap = run.column("loop.rod_1a.gap")[i];
        assert!(gap.abs() < 1e-9, "{}: {gap}", run.time[i]);
    }
    assert!(moved > 0.05, "it moves by {moved}");
}

/// Boom, stick and rocker lie across from their cylinders in triangles; the bucket across from the
/// pusher. Lengths and places are those of the file.
#[test]
#[expect(clippy::approx_constant, reason = "the digits of the file")]
fn an_excavator_moves_as_its_triangles_do() {
    let run = run("worlds/excavator.urdf", "excavator", 6.0);
    let joint = |name: &str| run.column(&format!("joint.{name}.position"));
    let (mut swung, mut dug): (f64, f64) = (0.0, 0.0);
    for i in 0..run.time.len() {
        let at = |name: &str| joint(name)[i];
        let check = |name: &str, expected: f64| {
            let found = at(name);
            let off = turned(expected - found);
            assert!(
                off.abs() < 1e-9,
                "{name} at {}: {found} {expected}",
                run.time[i]
            );
        };
        // A lever on a pivot, whose end a cylinder pushes from its foot: the angle of the lever.
        let lever = |pivot: Point, foot: Point, end: Point, length: f64, side: f64| {
            let arm = f64::hypot(end[0], end[1]);
            let opening = across(apart(pivot, foot), arm, length);
            direction(pivot, foot) + side * opening - f64::atan2(end[1], end[0])
        };
        let length = 1.089_404 + at("boom_cylinder");
        let boom = lever([0.2, 0.6], [0.7, 0.35], [1.0, 0.25], length, 1.0);
        check("boom", boom - 0.698_132);
        let length = 1.583_986 + at("stick_cylinder");
        let stick = lever([2.5, 0.0], [1.1, 0.45], [-0.35, 0.12], length, -1.0);
        check("stick", stick + 1.745_329);
        let length = 1.20004 + at("bucket_cylinder");
        let rocker = lever([1.2, 0.05], [0.15, 0.3], [0.3, 0.0], length, -1.0);
        check("rocker", rocker - 1.047_198);
        let tip = [1.2 + 0.3 * rocker.cos(), 0.05 + 0.3 * rocker.sin()];
        let bucket = lever([1.5, 0.0], tip, [0.02, 0.22], 0.305_975, -1.0);
        check("bucket", bucket + 0.523_599);
        swung = swung.max(at("swing").abs());
        dug = dug.max(at("bucket").abs());
    }
    assert!(swung > 0.3 && dug > 0.3, "{swung} {dug}");
}
