//! Time of contact between two shapes.
//!
//! `cargo bench -p urdf2fmu-core --bench pairs` prints a Markdown table: nanoseconds of a query of
//! shapes that lie on each other, that touch with a corner or skew, and that overlap deeply, the
//! fastest of some rounds.

#![expect(clippy::print_stdout, reason = "the table goes to standard output")]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

#[path = "support/clock.rs"]
mod clock;
#[path = "../src/testing/random.rs"]
mod random;

use random::Random;
use std::hint::black_box;
use urdf2fmu_core::geometry::pair::{Patch, Solid};
use urdf2fmu_core::geometry::{Shape, bounded_hull};
use urdf2fmu_core::spatial::{Pose, Vec3, rotation_from_rpy};

/// Poses that are visited in turn, calls per measurement, and measurements.
const POSES: usize = 64;
const CALLS: usize = 1024;
const ROUNDS: usize = 20;

/// Poses of `a` over `b`, turned by up to `lean` and `yaw`, that overlap by `depth` along z.
fn poses(a: &Solid, b: &Solid, [lean, yaw, depth]: [f64; 3], random: &mut Random) -> Vec<Pose> {
    (0..POSES)
        .map(|_| {
            let mut turn = |by: f64| random.uniform(-by, by);
            let R = rotation_from_rpy(&Vec3::new(turn(lean), turn(lean), turn(yaw)));
            let mut pose = Pose {
                R,
                p: Vec3::new(turn(0.02), turn(0.02), 0.3),
            };
            // Lowered until it is as deep.
            let mut patch = Patch::new();
            let (mut low, mut high) = (0.0, 0.3);
            for _ in 0..40 {
                pose.p.z = 0.5 * (low + high);
                patch.find((a, &pose), (b, &Pose::IDENTITY), 1e-3);
                let deepest = patch.points().iter().map(|p| p.depth).fold(-1.0, f64::max);
                if deepest > depth {
                    low = pose.p.z;
                } else {
                    high = pose.p.z;
                }
            }
            pose
        })
        .collect()
}

/// Nanoseconds of a query.
fn time(a: &Solid, b: &Solid, poses: &[Pose]) -> f64 {
    let mut patch = Patch::new();
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = clock::now();
        for i in 0..CALLS {
            let pose = &poses[i % POSES];
            black_box(patch.find((a, pose), (b, &Pose::IDENTITY), 1e-3));
        }
        best = best.min(clock::now() - start);
    }
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let calls = CALLS as f64;
    best / calls * 1e9
}

fn main() {
    let random = &mut Random(1);
    let points: Vec<Vec3> = (0..2000)
        .map(|_| Vec3::from_fn(|_, _| random.uniform(-1.0, 1.0)).normalize() * 0.06)
        .collect();
    let hull = bounded_hull(&points, 64).expect("a hull").vertices;
    let (radius, half_length) = (0.04, 0.05);
    let shapes = [
        ("ball", Shape::Sphere { radius }),
        (
            "capsule",
            Shape::Capsule {
                radius,
                half_length,
            },
        ),
        (
            "cylinder",
            Shape::Cylinder {
                radius,
                half_length,
            },
        ),
        (
            "box",
            Shape::Box {
                half: Vec3::new(0.05, 0.05, 0.05),
            },
        ),
        ("hull of 64", Shape::Hull { vertices: hull }),
    ];
    let solids = shapes.map(|(name, shape)| (name, Solid::new(&shape, 3e-4)));
    println!("| pair | flat, ns | leaning, ns | 4 mm deep, ns |\n|---|---|---|---|");
    for (i, (name, a)) in solids.iter().enumerate() {
        for (other, b) in &solids[..=i] {
            let kinds = [[0.0, 0.7, 1e-4], [0.6, 0.7, 1e-4], [0.6, 0.7, 4e-3]];
            let times = kinds.map(|kind| time(a, b, &poses(a, b, kind, random)));
            let [flat, leaning, deep] = times;
            println!("| {name}–{other} | {flat:.0} | {leaning:.0} | {deep:.0} |");
        }
    }
}
