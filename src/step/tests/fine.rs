//! What lies on meshes of triangles that are much smaller than it: far more of them are near it
//! than a patch has points.

use super::terrain::{grid, ground, mesh, over};
use super::worlds::body;
use super::*;
use crate::spatial::rotation_from_quaternion;

/// Size of a triangle, m.
const CELL: f64 = 0.01;

/// A dome of a radius of 5 m.
fn dome(x: f64, y: f64) -> f64 {
    -0.1 * (x * x + y * y)
}

/// Height of one of a grid's corners, drawn from its place, up to 2 mm.
fn gravel(x: f64, y: f64) -> f64 {
    let place = |x: f64| libm::round(x / CELL);
    let mixed = (place(x) * 12.9898 + place(y) * 78.233).sin() * 43758.5453;
    0.002 * (mixed - mixed.floor())
}

/// Waves of 0.25 m, up to 45 mm high.
fn rough(x: f64, y: f64) -> f64 {
    let wave = |a: f64, b: f64, c: f64| (25.0 * (a * x + b * y) + c).cos();
    0.015 * (wave(1.0, 0.3, 0.4) + wave(-0.6, 0.9, 2.0) + wave(0.2, -1.1, 4.4))
}

fn terrain(height: impl Fn(f64, f64) -> f64) -> Model {
    ground(mesh(&grid(0.7, 70, height)), Vec3::zeros())
}

/// A box on a dome of 600 small triangles, and on gravel: it comes to rest, and no corner of the
/// mesh is deeper in it than ten of them carry it. Before, it lay on those 64 of all points that
/// were found first, which changed as it moved: it sank into gravel by 0.7 mm, and took 1,400 steps
/// for 0.1 s.
///
/// Truth: the corners of the mesh, looked at one by one.
#[test]
fn a_box_on_many_small_triangles_lies_on_the_deepest_of_them() {
    let half = Vec3::new(0.15, 0.1, 0.05);
    for (name, height) in [("dome", dome as fn(f64, f64) -> f64), ("gravel", gravel)] {
        for step in [0.0, 1.0 / 240.0] {
            let at = Vec3::new(0.0, 0.0, 0.053);
            let mut model = over(terrain(height), body(4.0, Shape::Box { half }, at));
            model.solver.step_size = step;
            let mut s = start(model, 1e-3);
            run(&mut s, 0.5, 1.0 / 240.0);
            let counters = s.state().stepping.counters;
            let tries = counters.steps + counters.rejected;
            assert!(tries < 120, "{name}: {tries} tries");
            assert!(s.state().stepping.rested[0] > 0.0, "{name} does not rest");
            let q = &s.state().physical.q;
            let pose = Pose {
                R: rotation_from_quaternion(&[q[3], q[4], q[5], q[6]]),
                p: Vec3::new(q[0], q[1], q[2]),
            };
            let mut deepest = f64::NEG_INFINITY;
            for i in 0..=70 {
                for j in 0..=70 {
                    let [x, y] = [i, j].map(|k| (f64::from(k) - 35.0) * CELL);
                    let corner = Vec3::new(x, y, height(x, y));
                    let inside = half - pose.R.tr_mul(&(corner - pose.p)).abs();
                    deepest = deepest.max(inside.min());
                }
            }
            assert!((0.0..1e-4).contains(&deepest), "{name}: {deepest} m");
        }
    }
}

/// Boxes without friction that slide about in the valleys of a rough mesh. Before, a corner that
/// was over a triangle's plane beyond its hollow edge was as deep in that as the plane was high
/// over the next hill: 0.13 m, and a box of 4 kg made 1.4 J.
///
/// Truth: a passive robot gains no energy.
#[test]
fn corners_on_a_rough_mesh_are_not_in_the_next_hill() {
    let mut random = Random(5);
    for k in 0..6 {
        let half = Vec3::new(
            random.uniform(0.1, 0.2),
            random.uniform(0.05, 0.15),
            random.uniform(0.03, 0.07),
        );
        let mut one = body(4.0, Shape::Box { half }, Vec3::new(0.0, 0.0, 0.25));
        one.roots[0].rpy = random.vector(0.3);
        one.roots[0].linear_velocity = random.vector(0.3);
        let mut model = over(terrain(rough), one);
        model.solver.step_size = if k % 2 == 0 { 1.0 / 240.0 } else { 0.0 };
        for link in &mut model.links {
            link.friction = 0.0;
        }
        let mut s = start(model, 1e-3);
        let mut lowest = super::loops::energy(&mut s);
        let mut gained = 0.0_f64;
        for i in 1..=240 {
            s.advance_to(f64::from(i) / 240.0).expect("finite");
            let now = super::loops::energy(&mut s);
            (gained, lowest) = (gained.max(now - lowest), lowest.min(now));
        }
        // A thousandth of a fall of 0.25 m.
        assert!(gained < 0.01, "{k}: {gained} J");
    }
}

/// A plate that comes down nearly flush on one side of a pyramid, its peak under it. Where a step
/// of the least length makes energy it is solved once more, and if that has no solution, what was
/// left of it was taken all the same: the state was not a number, and the simulation ended.
///
/// Truth: no step fails, and its velocity of 0.09 m/s takes it 5 mm far.
#[test]
fn a_plate_that_comes_down_flush_beside_a_peak_goes_on() {
    let ring = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let corner = |i: usize| Vec3::new(ring[i % 4][0], ring[i % 4][1], -0.05);
    let pyramid: Vec<[Vec3; 3]> = (0..4)
        .map(|i| [Vec3::new(0.0, 0.0, 0.2), corner(i), corner(i + 1)])
        .collect();
    let half = Vec3::new(0.0685, 0.04975, 0.00545);
    let at = Vec3::new(
        0.013_328_379_800_831_621,
        0.014_712_939_488_330_181,
        0.198_640_387_302_168_15,
    );
    for tolerance in [1e-3, 1e-5, 1e-6] {
        let mut model = over(
            ground(mesh(&pyramid), Vec3::zeros()),
            body(0.0717, Shape::Box { half }, at),
        );
        let root = model.roots.iter_mut().find(|root| root.position == at);
        let root = root.expect("the plate");
        root.rpy = Vec3::new(
            -0.075_797_537_181_045_98,
            0.460_463_738_372_920_43,
            1.398_513_240_446_985_8,
        );
        root.linear_velocity = Vec3::new(
            -0.047_650_985_895_095_56,
            0.077_104_932_647_397_76,
            -0.005_797_600_006_969_258_5,
        );
        for link in &mut model.links {
            link.friction = 1.0;
        }
        let mut s = start(model, tolerance);
        run(&mut s, 0.05, 1.0 / 240.0);
        let moved = Vec3::from_row_slice(&s.state().physical.q[..3]) - at;
        assert!(moved.norm() < 0.01, "{tolerance}: {moved:?}");
    }
}
