//! Depths beside those of the rounded and of the sharp shapes, and how fast they change.

use super::*;
use crate::geometry::pair::nearest::nearest;
use crate::geometry::pair::placed::Placed;

/// How far a shape with sharp edges reaches along `d`, m.
fn reach(shape: &Shape, X: &Pose, d: &Vec3) -> f64 {
    let local = X.R.tr_mul(d);
    let own = match shape {
        Shape::Sphere { radius } => *radius,
        Shape::Capsule {
            radius,
            half_length,
        } => radius + half_length * local.z.abs(),
        Shape::Cylinder {
            radius,
            half_length,
        } => radius * libm::hypot(local.x, local.y) + half_length * local.z.abs(),
        Shape::Box { half } => half.dot(&local.abs()),
        Shape::Hull { vertices } => {
            let along = vertices.iter().map(|v| v.dot(&local));
            along.fold(f64::NEG_INFINITY, f64::max)
        }
        _ => unreachable!("no such shape here"),
    };
    X.p.dot(d) + own
}

/// Two shapes that touch.
struct Couple {
    shapes: [Shape; 2],
    solids: [Solid; 2],
    poses: [Pose; 2],
}

impl Couple {
    /// Random ones of these kinds and of some `size`, m, in random attitudes, which overlap by
    /// `overlap`, m, as `measure` says it.
    fn new(
        (kinds, size): ([usize; 2], f64),
        random: &mut Random,
        (overlap, measure): (f64, impl Fn(&Self) -> f64),
    ) -> Self {
        let shapes = kinds.map(|kind| any_shape(kind, size, random));
        let mut couple = Self {
            solids: shapes.each_ref().map(solid),
            shapes,
            poses: [
                at(random.unit() * (0.1 * size), any_rotation(random)),
                at(Vec3::zeros(), any_rotation(random)),
            ],
        };
        let (start, way) = (couple.poses[0].p, random.unit());
        let (mut low, mut high) = (0.0, 10.0 * size);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            couple.poses[0].p = start + way * middle;
            if measure(&couple) > overlap {
                low = middle;
            } else {
                high = middle;
            }
        }
        couple
    }

    /// Overlap of the rounded shapes, m, and the normal.
    fn rounded(&self) -> (f64, Vec3) {
        let [a, b] = [0, 1].map(|i| Placed::new(&self.solids[i], &self.poses[i], &Vec3::zeros()));
        let apart = nearest(&a, &b, f64::INFINITY);
        (
            a.solid.radius + b.solid.radius - apart.distance,
            apart.normal,
        )
    }

    /// Overlap of the sharp shapes along a direction, m.
    fn sharp(&self, n: &Vec3) -> f64 {
        reach(&self.shapes[1], &self.poses[1], n) + reach(&self.shapes[0], &self.poses[0], &-n)
    }

    fn find(&self, patch: &mut Patch) {
        let [a, b] = [0, 1].map(|i| (&self.solids[i], &self.poses[i]));
        patch.find(a, b, 0.01);
    }
}

/// All pairs of kinds with 10 cm, and those of round shapes with 1 m, too: there the 16 sides that
/// stand for the end of a cylinder are farther from it.
fn kinds_and_sizes() -> impl Iterator<Item = ([usize; 2], f64)> {
    let pairs = (0..25).map(|k| [k / 5, k % 5]);
    let round = pairs.clone().filter(|kinds| kinds.iter().all(|k| *k < 3));
    let small = pairs.map(|kinds| (kinds, 0.1));
    small.chain(round.map(|kinds| (kinds, 1.0)))
}

/// Shapes are rounded by up to a millimetre, and nothing is deeper than the sharp ones overlap at
/// least, or less deep than the rounded ones do, by more than 0.15 mm. Ends of cylinders that were
/// polygons of 16 sides were off by 1.7 mm: piles of cylinders sank into each other.
#[test]
fn depths_are_between_those_of_rounded_and_of_sharp_shapes() {
    for (kinds, size) in kinds_and_sizes() {
        let random = &mut Random(1000 + 10 * kinds[0] as u64 + kinds[1] as u64);
        let mut worst: f64 = 0.0;
        for _ in 0..60 {
            let overlap = (5e-4, |c: &Couple| c.sharp(&c.rounded().1));
            let couple = Couple::new((kinds, size), random, overlap);
            let (rounded, n) = couple.rounded();
            // The least overlap of the sharp shapes, by a random search.
            let (mut least, mut best) = (couple.sharp(&n), n);
            for k in 0..1500 {
                let size = 0.3 * libm::pow(0.4, f64::from(k / 100));
                let along = (best + random.unit() * size).normalize();
                let overlap = couple.sharp(&along);
                if overlap < least {
                    (least, best) = (overlap, along);
                }
            }
            let mut patch = Patch::new();
            couple.find(&mut patch);
            let points = patch.points().iter().filter(|p| p.share > 1e-3);
            let deepest = points.map(|p| p.depth).fold(f64::NEG_INFINITY, f64::max);
            let (low, high) = (rounded.min(least), rounded.max(least));
            worst = worst.max(low - deepest).max(deepest - high);
        }
        assert!(worst < 1.5e-4, "{kinds:?} of {size} m: {worst}");
    }
}

/// Two shapes that slide along each other with the same overlap of the rounded shapes: their depth
/// changes by less than twice their way. Where rules took over from each other within micrometres
/// it changed by 12 times as much, and steps of a simulation could not follow.
#[test]
fn depths_change_no_faster_than_shapes_move() {
    const SAMPLES: u32 = 1000;
    let (length, angle) = (0.01, 0.05);
    let per_sample = (length + angle * 0.05) / f64::from(SAMPLES);
    for (kinds, size) in kinds_and_sizes() {
        let random = &mut Random(1000 + 10 * kinds[0] as u64 + kinds[1] as u64);
        let mut worst: f64 = 0.0;
        for _ in 0..30 {
            let overlap = random.uniform(1e-5, 3e-4);
            let mut couple =
                Couple::new((kinds, size), random, (overlap, |c: &Couple| c.rounded().0));
            let n = couple.rounded().1;
            let along = random.unit();
            let (along, axis) = ((along - n * n.dot(&along)).normalize(), random.unit());
            let start = couple.poses[0];
            let (mut patch, mut before) = (Patch::new(), None);
            // What keeps the overlap as it is; of a sample nearly that of the one before.
            let mut lift = Vec3::zeros();
            for k in 0..=SAMPLES {
                let s = f64::from(k) / f64::from(SAMPLES) - 0.5;
                let place = start.p + along * (length * s);
                couple.poses[0] = at(place + lift, turned(axis, angle * s) * start.R);
                for _ in 0..if k == 0 { 3 } else { 1 } {
                    let (depth, n) = couple.rounded();
                    couple.poses[0].p += n * (depth - overlap);
                }
                lift = couple.poses[0].p - place;
                couple.find(&mut patch);
                let now = depth(patch.points());
                if let Some(before) = before.replace(now) {
                    let change: f64 = now - before;
                    worst = worst.max(change.abs() / per_sample);
                }
            }
        }
        assert!(worst < 2.0, "{kinds:?} of {size} m: {worst}");
    }
}
