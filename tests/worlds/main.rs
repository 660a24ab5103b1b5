//! The worlds of `examples/worlds`, simulated by the command, beside what physics says of them.
//!
//! Each test runs one of them as its user does, with its settings and its table of inputs.

#![allow(clippy::unwrap_used, reason = "a test may fail")]
#![allow(missing_docs, reason = "tests say it in their names")]

mod dominoes;
mod lidar;
mod loops;
mod rough;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

const G: f64 = 9.81;

/// A table of results: a column for each name.
struct Run {
    /// The summary.
    told: String,
    time: Vec<f64>,
    columns: BTreeMap<String, Vec<f64>>,
}

/// A rotation by its unit quaternion, x y z w, as results have it.
type Quaternion = [f64; 4];

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples")
}

/// Simulates a world of `examples/worlds`; the robot is a file of `examples`.
fn run(robot: &str, world: &str, stop: f64) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let (table, worlds) = (folder.path().join("out.csv"), examples().join("worlds"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_urdf2fmu"));
    command.arg("simulate").arg(examples().join(robot));
    command
        .arg("-c")
        .arg(worlds.join(world).with_extension("toml"));
    let inputs = worlds.join(world).with_extension("csv");
    if inputs.exists() {
        command.arg("--input-file").arg(inputs);
    }
    command.arg("--stop-time").arg(stop.to_string());
    let done = command.arg("--output-file").arg(&table).output().unwrap();
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{world}: {told}");
    assert!(!told.contains("warning"), "{world}: {told}");
    Run::read(told.into_owned(), &table)
}

impl Run {
    fn read(told: String, table: &Path) -> Self {
        let mut reader = csv::Reader::from_path(table).unwrap();
        let names: Vec<String> = reader
            .headers()
            .unwrap()
            .iter()
            .map(str::to_owned)
            .collect();
        let mut values = vec![Vec::new(); names.len()];
        for row in reader.records() {
            for (column, value) in values.iter_mut().zip(row.unwrap().iter()) {
                column.push(value.parse().unwrap());
            }
        }
        let mut columns: BTreeMap<_, _> = names.into_iter().zip(values).collect();
        Self {
            told,
            time: columns.remove("time").unwrap(),
            columns,
        }
    }

    fn column(&self, name: &str) -> &[f64] {
        self.columns
            .get(name)
            .unwrap_or_else(|| panic!("no {name}"))
    }

    /// The row at or next after `t` s.
    fn row(&self, t: f64) -> usize {
        let row = self.time.partition_point(|x| *x < t - 1e-9);
        row.min(self.time.len() - 1)
    }

    fn at(&self, name: &str, t: f64) -> f64 {
        self.column(name)[self.row(t)]
    }

    fn last(&self, name: &str) -> f64 {
        *self.column(name).last().unwrap()
    }

    fn vector(&self, name: &str, row: usize) -> [f64; 3] {
        ["x", "y", "z"].map(|axis| self.column(&format!("{name}.{axis}"))[row])
    }

    /// Position and orientation of what has such outputs.
    fn pose(&self, name: &str, row: usize) -> ([f64; 3], Quaternion) {
        let orientation = ["x", "y", "z", "w"]
            .map(|axis| self.column(&format!("{name}.orientation.{axis}"))[row]);
        (self.vector(&format!("{name}.position"), row), orientation)
    }

    /// The largest velocity of anything in the last row.
    fn last_speed(&self) -> f64 {
        let moving = self
            .columns
            .iter()
            .filter(|(name, _)| (name.contains("velocity")) && !name.contains("cmd."));
        moving.fold(0.0, |most, (_, x)| x.last().unwrap().abs().max(most))
    }

    /// Sum of the vertical contact forces of the links whose names begin so, in the last row.
    fn load(&self, prefix: &str) -> f64 {
        let forces = self
            .columns
            .iter()
            .filter(|(name, _)| name.starts_with(prefix) && name.ends_with(".force.z"));
        forces.map(|(_, x)| x.last().unwrap()).sum()
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `v` in the axes that `q` turns the world's into.
fn seen_from([x, y, z, w]: Quaternion, v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let inverse = [-x, -y, -z];
    let once = cross(inverse, v);
    let twice = cross(inverse, once);
    [0, 1, 2].map(|i| v[i] + 2.0 * (w * once[i] + twice[i]))
}

/// How long the direction is that is up in the body, along the world's z axis.
fn upright([x, y, ..]: Quaternion) -> f64 {
    1.0 - 2.0 * (x * x + y * y)
}

#[test]
fn a_gripper_tips_a_cup_by_90_degrees_and_puts_it_down_without_a_slip() {
    let run = run("worlds/gripper.urdf", "gripper_cup", 8.0);
    // The grip is closed at 0.5 s; at 6.2 s the cup touches the shelf.
    let held = |row| {
        let ((palm, turned), (cup, _)) = (run.pose("link.palm", row), run.pose("object.cup", row));
        seen_from(turned, minus(cup, palm))
    };
    let settled = held(run.row(0.8));
    for row in run.row(0.8)..run.row(6.15) {
        let slip = norm(minus(held(row), settled));
        assert!(slip < 1e-5, "{slip} m at {} s", run.time[row]);
    }
    let (high, tipped) = run.pose("object.cup", run.row(2.9));
    assert!(
        upright(tipped).abs() < 1e-3 && high[2] > 0.5,
        "{high:?} {tipped:?}"
    );
    // It stands on the shelf, as deep in it as its weight says, a quarter turn about the column on.
    let (end, orientation) = run.pose("object.cup", run.row(8.0));
    assert!((end[2] - 0.4).abs() < 1e-4, "{end:?}");
    assert!(
        end[0].abs() < 1e-4 && (end[1] - 0.44).abs() < 1e-4,
        "{end:?}"
    );
    assert!(1.0 - upright(orientation) < 1e-8, "{orientation:?}");
    let load = run.last("object.cup.contact.cup.force.z");
    assert!((load - 0.3 * G).abs() < 1e-4, "{load}");
    assert!(run.last_speed() < 1e-12, "{}", run.last_speed());
}

#[test]
fn a_rover_pushes_a_crate_up_a_ramp_as_far_as_its_wheels_turn() {
    let run = run("rover.urdf", "rover_box_ramp", 6.0);
    let slope = 10.0_f64.to_radians();
    // Height of a place above the upper face of the ramp, which begins at x = 0.8, z = 0.
    let above = |[x, _, z]: [f64; 3]| z * slope.cos() - (x - 0.8) * slope.sin();
    for t in [3.0, 4.0, 6.0] {
        let (crate_at, orientation) = run.pose("object.crate", run.row(t));
        assert!((above(crate_at) - 0.1).abs() < 1e-4, "{t} s: {crate_at:?}");
        let lean = upright(orientation).acos();
        assert!((lean - slope).abs() < 1e-3, "{t} s: {lean}");
        let (rover, _) = run.pose("base", run.row(t));
        assert!((above(rover) - 0.15).abs() < 1e-4, "{t} s: {rover:?}");
    }
    // From 3 to 4 s all wheels are on the ramp; they roll without sliding.
    let way = |name: &str| {
        let at = |t| run.vector(&format!("{name}.position"), run.row(t));
        norm(minus(at(4.0), at(3.0)))
    };
    for side in ["left", "right"] {
        for wheel in ["front", "rear"] {
            let name = format!("joint.{side}_{wheel}_wheel_joint.position");
            let rolled = 0.1 * (run.at(&name, 4.0) - run.at(&name, 3.0));
            assert!(
                (way("base") - rolled).abs() < 1e-4,
                "{name}: {} {rolled}",
                way("base")
            );
        }
    }
    assert!((way("object.crate") - way("base")).abs() < 1e-5);
    assert!(way("base") > 0.499, "{}", way("base"));
    // A ramp that stands in the ground is no event, and its lower edge, which the ground covers, no
    // step: the crate stumbled over it with 768 N.
    assert!(run.told.contains("Deepest contact"), "{}", run.told);
    assert!(!run.told.contains("Hardest contact"), "{}", run.told);
    assert!(!run.told.contains("ramp"), "{}", run.told);
    // Stopped on the slope, everything rests.
    assert!(run.last_speed() < 1e-12, "{}", run.last_speed());
}

#[test]
fn a_humanoid_sits_down_and_its_chair_carries_most_of_it() {
    let run = run("worlds/humanoid.urdf", "humanoid_chair", 7.0);
    let weight = 61.2 * G;
    assert!((run.load("contact.") - weight).abs() < 1e-4 * weight);
    let seat = run.last("contact.pelvis.force.z")
        + run.last("contact.left_thigh.force.z")
        + run.last("contact.right_thigh.force.z");
    let feet = run.last("contact.left_foot.force.z") + run.last("contact.right_foot.force.z");
    assert!(seat > 0.6 * weight && feet > 0.1 * weight, "{seat} {feet}");
    assert!(
        (seat + feet - weight).abs() < 1e-4 * weight,
        "{seat} {feet}"
    );
    // What the humanoid and the ground do to the chair together is to carry its weight.
    let chair = run.last("object.chair.contact.chair.force.z");
    assert!((chair - 6.0 * G).abs() < 1e-4 * weight, "{chair}");
    let height = run.last("object.chair.position.z");
    assert!(height.abs() < 1e-4, "{height}");
    // The pelvis is a box 14 cm high, the seat is at 42 cm.
    let hip = run.last("base.position.z");
    assert!((hip - 0.49).abs() < 1e-3, "{hip}");
    assert!(run.last_speed() < 1e-12, "{}", run.last_speed());
}

#[test]
fn three_arms_hand_over_a_ball_and_it_ends_in_the_bowl() {
    let run = run("worlds/gripper.urdf", "three_arms_ball", 12.5);
    let ball = |t| run.vector("object.ball.position", run.row(t));
    // Between the arms, held by both hands in turn.
    for (t, x, y) in [(3.0, 0.44, 0.0), (7.5, 1.32, 0.0), (10.7, 1.76, 0.44)] {
        let off = norm(minus(ball(t), [x, y, 0.34]));
        assert!(off < 3e-4, "{t} s: {off} m off");
    }
    // In a funnel of planks that rise by 35°, whose middles are 65 mm from the axis and 70 mm high
    // and which are 8 mm thick, a ball of 40 mm rests where it is 44 mm above each middle plane.
    let slope = 35.0_f64.to_radians();
    let height = 0.07 + (0.044 - 0.065 * slope.sin()) / slope.cos();
    let off = norm(minus(ball(12.5), [1.76, 0.44, height]));
    assert!(off < 1e-4, "{:?} {off}", ball(12.5));
    assert!(run.last_speed() < 1e-12, "{}", run.last_speed());
}

/// Balls that are apart hit each other one after the other. Of two equal balls, the second leaves
/// an impact with `(1 + e)/2` of the velocity of the first, which keeps `(1 − e)/2` (Newton's law
/// and momentum). So the last one gets `((1 + e)/2)⁴`, and rises to that squared of the height.
#[test]
fn newtons_cradle_passes_momentum_and_energy_to_the_last_ball() {
    let run = run("worlds/cradle.urdf", "newtons_cradle", 0.6);
    let passed = f64::midpoint(1.0, 0.99);
    // Momentum: all of it, 10 ms later, but for what gravity took of the balls' swing.
    let speeds = |t| [1, 2, 3, 4, 5].map(|ball| run.at(&format!("joint.hinge_{ball}.velocity"), t));
    let (before, after) = (speeds(0.25), speeds(0.2625));
    let (mass, arm, inertia) = (0.5, 0.25, 0.5 * 0.25 * 0.25 + 0.000_125);
    let fastest = (2.0 * mass * G * arm * (1.0 - 0.5_f64.cos()) / inertia).sqrt();
    assert!((before[0] - fastest).abs() < 2e-3 * fastest, "{before:?}");
    let sum: f64 = after.iter().sum();
    assert!((sum - fastest).abs() < 3e-3 * fastest, "{after:?}");
    assert!(
        (after[4] - fastest * passed.powi(4)).abs() < 3e-3 * fastest,
        "{after:?}"
    );
    for (i, speed) in after[..4].iter().enumerate() {
        let kept = fastest * (1.0 - passed) * passed.powi(i32::try_from(i).unwrap());
        assert!((speed - kept).abs() < 1e-3 * fastest, "{i}: {speed} {kept}");
    }
    // Energy: what the last ball has at the top of its swing, of what the first one had.
    let top = run
        .column("joint.hinge_5.position")
        .iter()
        .fold(0.0_f64, |a, x| a.max(*x));
    let share = (1.0 - top.cos()) / (1.0 - 0.5_f64.cos());
    assert!(
        (share - passed.powi(8)).abs() < 4e-3,
        "{share} {}",
        passed.powi(8)
    );
    // And nothing out of nothing; at 0.26 s the balls' springs hold some of it.
    let energy = |i: usize| run.column("energy.kinetic")[i] + run.column("energy.potential")[i];
    let swing = mass * G * arm * (1.0 - 0.5_f64.cos());
    for (from, to) in [(0.0, 0.6), (0.2625, 0.6)] {
        let begin = energy(run.row(from));
        for i in run.row(from)..=run.row(to) {
            assert!(energy(i) - begin < 2e-4 * swing, "{} s", run.time[i]);
        }
    }
}
