//! The force of a contact moves continuously with the poses.

use super::*;

/// Paths of each of the 25 pairings; `PAIR_PATHS` asks for others, and writes down what they did.
fn paths() -> usize {
    let asked = std::env::var("PAIR_PATHS").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(60)
}

/// Samples of a path.
const SAMPLES: usize = 400;
/// Share of the largest wrench that counts as a jump: the place of the nearest points of curved
/// surfaces is known to the root of the round-off of their distance.
const JUMP: f64 = 1e-7;
/// Part of a path down to which a change is followed.
const SHORT: f64 = 1e-13;

/// What moves along a path of parameter 0 … 1.
#[derive(Clone)]
struct Path {
    a: Solid,
    b: Solid,
    /// Pose of A in the middle, and what it turns about.
    middle: Pose,
    about: Vec3,
    way: Vec3,
    turn: Vec3,
}

/// Moment over the size, and force.
type Wrench = nalgebra::Vector6<f64>;

impl Path {
    /// The wrench of the frozen contact, and whether inner cores take part.
    fn at(&self, s: f64, patch: &mut Patch) -> (Wrench, bool) {
        let angle = self.turn * (s - 0.5);
        let R = *nalgebra::Rotation3::new(angle).matrix();
        let pose = Pose {
            R: R * self.middle.R,
            p: self.about + R * (self.middle.p - self.about) + self.way * (s - 0.5),
        };
        let mut wrench = Wrench::zeros();
        patch.find((&self.a, &pose), (&self.b, &Pose::IDENTITY), 1e-3);
        let delta = depth(patch.points());
        if delta > 0.0 {
            for p in patch.points() {
                let force = patch.normal * (p.share * p.depth.max(0.0).powi(3) / (delta * delta));
                let moment = p.x.cross(&force) / 0.1;
                wrench += Wrench::new(moment.x, moment.y, moment.z, force.x, force.y, force.z);
            }
        }
        (wrench, patch.blended)
    }

    /// Largest jump over the largest wrench, whether inner cores take part anywhere, and where.
    fn jump(&self) -> (f64, bool, f64) {
        let mut patch = Patch::new();
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let place = |i: usize| i as f64 / SAMPLES as f64;
        let (mut before, mut deep) = self.at(0.0, &mut patch);
        let mut largest = before.norm();
        let mut steepest = (0.0, 0.0, 0.0);
        for i in 1..=SAMPLES {
            let (now, meets) = self.at(place(i), &mut patch);
            deep |= meets;
            largest = largest.max(now.norm());
            let change = (now - before).norm();
            if change > steepest.0 {
                steepest = (change, place(i - 1), place(i));
            }
            before = now;
        }
        let (mut change, mut low, mut high) = steepest;
        let mut earlier = change;
        let (mut first, mut last) = (self.at(low, &mut patch).0, self.at(high, &mut patch).0);
        while high - low > SHORT {
            let middle = 0.5 * (low + high);
            let (now, meets) = self.at(middle, &mut patch);
            deep |= meets;
            let (left, right) = ((now - first).norm(), (last - now).norm());
            if left > right {
                (high, last, change) = (middle, now, left);
            } else {
                (low, first, change) = (middle, now, right);
            }
            if high - low > 8.0 * SHORT {
                earlier = change;
            }
        }
        // What still falls with the part of the path is steep, and no jump.
        let jump = if largest > 0.0 && change > 0.5 * earlier {
            change / largest
        } else {
            0.0
        };
        (jump, deep, low)
    }
}

/// Moves `a` along `direction` until the rounded shapes overlap by `overlap`.
fn settle((a, mut pose): (&Solid, Pose), b: &Solid, direction: &Vec3, overlap: f64) -> Pose {
    use super::super::nearest::nearest;
    use super::super::placed::Placed;
    let (mut low, mut high) = (0.0, 2.0 * (a.reach + b.reach));
    let start = pose.p;
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        pose.p = start + direction * middle;
        let placed = |s, p| Placed::new(s, p, &Vec3::zeros());
        let apart = nearest(
            &placed(a, &pose),
            &placed(b, &Pose::IDENTITY),
            f64::INFINITY,
        );
        if apart.distance > a.radius + b.radius - overlap {
            high = middle;
        } else {
            low = middle;
        }
    }
    pose
}

fn shapes(random: &mut Random) -> [Shape; 5] {
    let (radius, half_length) = (0.03, 0.05);
    [
        Shape::Sphere { radius },
        Shape::Capsule {
            radius,
            half_length,
        },
        Shape::Cylinder {
            radius,
            half_length,
        },
        Shape::Box {
            half: Vec3::new(0.05, 0.04, 0.06),
        },
        if random.below(2) == 0 {
            dodecahedron(0.05)
        } else {
            cloud(10 + random.below(50), 0.06, random)
        },
    ]
}

/// A random path of a pairing, in the middle of which it touches. Every other one begins with an
/// axis or a face of one along an axis or a face of the other.
fn path(i: usize, j: usize, number: usize, depth: f64, random: &mut Random) -> Path {
    let (a, b) = (solid(&shapes(random)[i]), solid(&shapes(random)[j]));
    let aligned = number.is_multiple_of(2);
    let face = |s: &Solid, random: &mut Random| {
        let normals = &s.mesh.normals;
        match random.below(2) {
            0 if !normals.is_empty() => normals[random.below(normals.len())],
            _ => [Vec3::x(), Vec3::z()][random.below(2)],
        }
    };
    let (R, direction) = if aligned {
        let (u, v) = (face(&a, random), face(&b, random));
        // Takes u to −v, and turns about it.
        let to = |x: &Vec3| crate::spatial::rotation_to_axis(x);
        let about = turned(v, random.uniform(0.0, 6.0));
        (about * to(&-v) * to(&u).transpose(), v)
    } else {
        (any_rotation(random), random.unit())
    };
    let aside = random.vector(0.03);
    let aside = aside - direction * direction.dot(&aside);
    let pose = settle((&a, at(aside, R)), &b, &direction, depth);
    let mut patch = Patch::new();
    patch.find((&a, &pose), (&b, &Pose::IDENTITY), 1e-2);
    let about = patch.points().first().map_or(pose.p, |p| p.x);
    let n = patch.normal;
    let way = random.vector(0.02);
    // Along the contact; its depth changes little.
    let way = way - n * n.dot(&way) + n * random.uniform(-3e-4, 3e-4);
    let turn = match random.below(4) {
        0 => n * random.uniform(-0.5, 0.5),
        1 => random.vector(1e-3),
        2 => random.vector(0.02),
        _ => random.vector(0.3),
    };
    Path {
        a,
        b,
        middle: pose,
        about,
        way,
        turn,
    }
}

/// What the paths of some pairings did.
#[derive(Debug, Default)]
struct Found {
    paths: usize,
    /// Those with a jump of more than [`JUMP`].
    jumps: usize,
    largest: f64,
}

/// Where inner cores take part it need not be so. Beyond, at an overlap of some millimetres, are
/// places where a cylinder meets a corner sideways.
#[test]
fn forces_do_not_jump_unless_shapes_overlap_deeply() {
    let mut text = String::new();
    let (mut all, mut deep) = (Found::default(), Found::default());
    for i in 0..5 {
        for j in 0..5 {
            let seed = 1000 + 10 * i as u64 + j as u64;
            let random = &mut Random(seed);
            for number in 0..paths() {
                let depth = if number % 8 == 7 { 3e-3 } else { 3e-4 };
                let path = path(i, j, number, depth, random);
                let (jump, blended, s) = path.jump();
                let found = if blended { &mut deep } else { &mut all };
                found.paths += 1;
                found.largest = found.largest.max(jump);
                if jump > JUMP {
                    found.jumps += 1;
                    let line = format!("seed {seed} path {number} at {s}: {jump}, {blended}\n");
                    text.push_str(&line);
                }
            }
        }
    }
    let text = format!("{text}shallow {all:?}, deep {deep:?}");
    if std::env::var("PAIR_PATHS").is_ok() {
        std::fs::write(std::env::temp_dir().join("pair_jumps.txt"), &text).expect("a file");
    }
    assert!(all.paths > 10 * paths() && deep.paths > paths(), "{text}");
    assert!(all.jumps == 0, "{text}");
    assert!(deep.jumps * 100 <= deep.paths, "{text}");
}
