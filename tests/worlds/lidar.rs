//! A rover with a lidar in a maze of boxes: each ray beside the geometry of the maze, seen from the
//! pose of the head that the same results show.

use super::{Quaternion, Run, run};

/// A wall: middle, half sizes, yaw.
type Wall = ([f64; 2], [f64; 2], f64);

/// In the order of `lidar_maze.toml`; the column is between the end and the block.
const WALLS: [Wall; 7] = [
    ([1.2, -0.75], [2.0, 0.05], 0.0),
    ([-0.75, 0.0], [0.05, 0.7], 0.0),
    ([0.35, 0.75], [1.15, 0.05], 0.0),
    ([3.15, 1.15], [0.05, 1.85], 0.0),
    ([1.55, 1.8], [0.05, 1.1], 0.0),
    ([2.35, 3.05], [0.85, 0.05], 0.0),
    ([0.8, 0.55], [0.1, 0.1], 0.6),
];
const COLUMN: ([f64; 2], f64) = ([2.85, 0.9], 0.1);
const HEIGHT: f64 = 0.5;
/// Links of the rover before those of the maze.
const OWN: f64 = 6.0;
const RANGE: f64 = 8.0;
const RAYS: usize = 72;

fn turned([x, y, z, w]: Quaternion, v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let t = cross([x, y, z], v).map(|t| 2.0 * t);
    let u = cross([x, y, z], t);
    std::array::from_fn(|i| v[i] + w * t[i] + u[i])
}

/// Where `o + t d` has `|x| ≤ half`.
fn slab(o: f64, d: f64, half: f64) -> [f64; 2] {
    let (a, b) = ((-half - o) / d, (half - o) / d);
    [a.min(b), a.max(b)]
}

/// The first of all, unless it is left first.
fn first(parts: &[[f64; 2]]) -> f64 {
    let enter = parts.iter().fold(0.0, |t: f64, part| t.max(part[0]));
    let exit = parts.iter().fold(f64::INFINITY, |t, part| t.min(part[1]));
    if enter <= exit { enter } else { f64::INFINITY }
}

/// Distance and number of the nearest thing.
fn nearest(o: [f64; 3], d: [f64; 3]) -> (f64, f64) {
    let standing = slab(o[2] - 0.5 * HEIGHT, d[2], 0.5 * HEIGHT);
    let walls = WALLS.iter().enumerate().map(|(i, (middle, half, yaw))| {
        let (s, c) = yaw.sin_cos();
        let [x, y] = [o[0] - middle[0], o[1] - middle[1]];
        let along = slab(c * x + s * y, c * d[0] + s * d[1], half[0]);
        let across = slab(c * y - s * x, c * d[1] - s * d[0], half[1]);
        // The column is the seventh thing.
        let number = if i == 6 {
            8.0
        } else {
            f64::from(u8::try_from(i).unwrap()) + 1.0
        };
        (first(&[along, across, standing]), OWN + number)
    });
    let ([x, y], radius) = ([o[0] - COLUMN.0[0], o[1] - COLUMN.0[1]], COLUMN.1);
    let (a, b) = (d[0] * d[0] + d[1] * d[1], x * d[0] + y * d[1]);
    let square = b * b - a * (x * x + y * y - radius * radius);
    let column = if square < 0.0 {
        f64::INFINITY
    } else {
        let root = square.sqrt();
        first(&[[(-b - root) / a, (-b + root) / a], standing])
    };
    let ground = if d[2] < 0.0 {
        o[2] / -d[2]
    } else {
        f64::INFINITY
    };
    walls
        .chain([(column, OWN + 7.0), (ground, -1.0), (RANGE, 0.0)])
        .fold((f64::INFINITY, 0.0), |a, b| if b.0 < a.0 { b } else { a })
}

fn ray(run: &Run, what: &str, ray: usize, row: usize) -> f64 {
    run.column(&format!("sensor.lidar.{what}[{}]", ray + 1))[row]
}

#[test]
fn a_lidar_in_a_maze_sees_its_walls_where_they_are() {
    let run = run("rover.urdf", "lidar_maze", 14.0);
    // Through the first corridor, round the corner, and up the second one.
    let end = ["x", "y"].map(|axis| run.last(&format!("base.position.{axis}")));
    assert!((1.9..2.6).contains(&end[0]) && end[1] > 1.5, "{end:?}");
    let (mut worst, mut seen) = (0.0_f64, [0; 9]);
    for row in (0..run.time.len()).step_by(7) {
        let (p, q) = run.pose("link.head", row);
        let up = turned(q, [0.0, 0.0, 0.12]);
        let o = [p[0] + up[0], p[1] + up[1], p[2] + up[2]];
        for i in 0..RAYS {
            let angle = (5.0 * f64::from(u8::try_from(i).unwrap()) - 177.5).to_radians();
            let d = turned(q, [angle.cos(), angle.sin(), 0.0]);
            let (distance, number) = nearest(o, d);
            let (found, hit) = (ray(&run, "ray", i, row), ray(&run, "hit", i, row));
            // Where two walls meet either may be told.
            worst = worst.max((found - distance).abs());
            assert!(
                (hit - number).abs() < 0.5 || (found - distance).abs() < 1e-12,
                "row {row}, ray {i}: {found} at {hit}, not {distance} at {number}"
            );
            if hit > OWN {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "few"
                )]
                let thing = (hit - OWN) as usize;
                seen[thing] += 1;
            }
        }
    }
    // Poses have 1e-15 of themselves, and rays that graze feel it a hundred times.
    assert!(worst < 1e-9, "{worst:e}");
    assert!(seen[1..].iter().all(|n| *n > 20), "{seen:?}");
    // It touches nothing: no wall is nearer to the head than half its width.
    let nearest = (0..run.time.len()).flat_map(|row| (0..RAYS).map(move |i| (row, i)));
    let nearest = nearest.map(|(row, i)| ray(&run, "ray", i, row));
    assert!(nearest.fold(f64::INFINITY, f64::min) > 0.25);
}
