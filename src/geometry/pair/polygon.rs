//! Where faces of two shapes lie over each other, and how much of a face each corner carries.
//!
//! Seen along the normal, two faces that are opposite each other, `f` of A and `g` of B, have a
//! convex polygon in common, and the gap `t` between them is a linear function on it.
//!
//! 1. Within a polygon a corner's share is its exterior angle over 2π: the shares of all sum up to
//!    one, and a corner that is split, or a new one that has no angle yet, changes nothing. As the
//!    polygon moves, they change continuously as long as it has an area.
//! 2. The polygons of all pairs tile what the shapes cover in common. Each has the volume `V = ∫ (ℓ
//!    − t)₊ dA`, with the level `ℓ` a little above the gap where the shapes are nearest, and the
//!    weight `W = V⁴`. It is continuous, and vanishes with the polygon's area: so a point's share,
//!    `Σ W m / Σ W` of all pairs, moves continuously with the poses. Because of the power one pair
//!    dominates: pairs beside a flat face have some percent of its volume, but less than a
//!    millionth of its weight.
//! 3. Angles are those in the plane of the face that is more tilted against the normal: the corner
//!    of a box has a quarter at any lean.

use super::mesh::Mesh;
use super::points::{Points, point};
use super::view::{Frame, Front, Seen};
use crate::spatial::Vec3;

/// Corners of a polygon, at most: two faces of 64 corners, and one more for each cut.
const MOST_CORNERS: usize = 2 * crate::geometry::MOST_CORNERS + 8;
/// Part of the size of a polygon within which two corners are one.
const SAME: f64 = 1e-15;

/// Corners of a polygon, counter-clockwise: places and heights of the upper surface.
#[derive(Clone, Debug)]
pub(super) struct Polygon {
    at: [Vec3; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    pub(super) const NONE: Self = Self {
        at: [Vec3::new(0.0, 0.0, 0.0); MOST_CORNERS],
        count: 0,
    };

    fn push(&mut self, x: Vec3) {
        if self.count < MOST_CORNERS {
            self.at[self.count] = x;
            self.count += 1;
        }
    }

    pub(super) fn take(&mut self, corners: impl Iterator<Item = Vec3>) {
        self.count = 0;
        for x in corners {
            self.push(x);
        }
    }

    fn corners(&self) -> &[Vec3] {
        &self.at[..self.count]
    }

    /// What of `from` has `side ≥ 0`, a linear function of the place.
    pub(super) fn cut(&mut self, from: &Self, side: impl Fn(&Vec3) -> f64) {
        self.count = 0;
        let Some(last) = from.corners().last() else {
            return;
        };
        let (mut a, mut before) = (*last, side(last));
        for &b in from.corners() {
            let after = side(&b);
            if (before >= 0.0) != (after >= 0.0) {
                self.push(a + (b - a) * (before / (before - after)));
            }
            if after >= 0.0 {
                self.push(b);
            }
            (a, before) = (b, after);
        }
    }

    /// Whether it is more than a line, in space.
    pub(super) fn has_area(&self) -> bool {
        let list = self.corners();
        let Some(first) = list.first() else {
            return false;
        };
        let ends = list[1..].iter().zip(list.iter().skip(2));
        let double: Vec3 = ends.map(|(a, b)| (a - first).cross(&(b - first))).sum();
        double != Vec3::zeros()
    }

    /// Area, m², as seen.
    pub(super) fn area(&self) -> f64 {
        self.integral(|_| 0.0).0
    }

    /// Area, m², as seen, of what lies within an outline, counter-clockwise; `scratch` is
    /// overwritten.
    pub(super) fn area_within(
        &self,
        outline: impl Iterator<Item = Vec3> + Clone,
        scratch: [&mut Self; 2],
    ) -> f64 {
        let [one, two] = scratch;
        one.take(self.corners().iter().copied());
        Self::keep_within([one, two], outline)[0].area()
    }

    /// What of the first one lies within an outline, counter-clockwise, and the other one, which is
    /// scratch.
    fn keep_within(
        [mut one, mut two]: [&mut Self; 2],
        outline: impl Iterator<Item = Vec3> + Clone,
    ) -> [&mut Self; 2] {
        let mut ends = outline.clone();
        let begin = ends.next();
        for (a, b) in outline.zip(ends.chain(begin)) {
            two.cut(one, |x| turn(&(b - a), &(x - a)));
            // Places are swapped, not what stands there.
            std::mem::swap(&mut one, &mut two);
            if one.count == 0 {
                break;
            }
        }
        [one, two]
    }

    /// Area, and integral of a linear function over it.
    fn integral(&self, value: impl Fn(&Vec3) -> f64) -> (f64, f64) {
        let (mut area, mut sum) = (0.0, 0.0);
        let list = self.corners();
        for i in 2..self.count {
            let (a, b, c) = (&list[0], &list[i - 1], &list[i]);
            let part = 0.5 * turn(&(b - a), &(c - a));
            area += part;
            sum += part * (value(a) + value(b) + value(c)) / 3.0;
        }
        (area, sum)
    }

    /// m, as seen.
    fn circumference(&self) -> f64 {
        let list = self.corners();
        let sides = list.iter().zip(list.iter().cycle().skip(1));
        sides.map(|(a, b)| (b - a).xy().norm()).sum()
    }

    /// Drops corners that coincide with the one before.
    fn merge(&mut self) {
        let size = self.corners().iter().fold(0.0, |size: f64, x| {
            size.max((x.x - self.at[0].x).abs() + (x.y - self.at[0].y).abs())
        });
        let near = |a: &Vec3, b: &Vec3| (a.x - b.x).abs() + (a.y - b.y).abs() <= SAME * size;
        let mut kept = 0;
        for i in 0..self.count {
            if kept == 0 || !near(&self.at[i], &self.at[kept - 1]) {
                self.at[kept] = self.at[i];
                kept += 1;
            }
        }
        while kept > 1 && near(&self.at[kept - 1], &self.at[0]) {
            kept -= 1;
        }
        self.count = kept;
    }
}

fn turn(a: &Vec3, b: &Vec3) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Memory for the polygons of a query.
#[derive(Clone, Debug)]
pub(super) struct Polygons {
    pub(super) one: Polygon,
    pub(super) two: Polygon,
    pub(super) third: Polygon,
}

impl Polygons {
    pub(super) const NONE: Self = Self {
        one: Polygon::NONE,
        two: Polygon::NONE,
        third: Polygon::NONE,
    };
}

/// What all pairs of faces have in common.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cover {
    /// `Σ W`, m¹².
    pub(super) weight: f64,
    /// How much of the contact the polygons decide, 0 … 1, see [`Limits::part`]: the mean, by the
    /// weights.
    pub(super) part: f64,
    /// What part of the upper face's area below the level has no lower face under it, 0 … 1.
    pub(super) cut: f64,
    /// Least gap, m; infinite where nothing lies over each other.
    pub(super) least: f64,
}

/// Level, and farthest gap of a point that is taken, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) level: f64,
    /// By how much the level is above the gap where the rounded shapes are nearest, m.
    pub(super) blend: f64,
    /// How wide, or far inside of a face, something is that decides alone, m.
    pub(super) wide: f64,
    pub(super) reach: f64,
    pub(super) asked: Asked,
}

/// What is asked for of faces that lie over each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// The least gap.
    Least,
    /// All but the part that is cut off, and what has no part in the weights.
    Points,
    /// Everything.
    All,
}

impl Limits {
    /// How much of a contact something decides that is `wide` m wide, or inside of a face, and has
    /// the least gap `gap`, 0 … 1; the rest is that of the nearest points of the rounded shapes.
    ///
    /// With `x`, which rises evenly with both, it is `x⁴/(x⁴ + (1 − x)⁴)`: depths are a mean of
    /// fourth powers, so that both ends of the transition are gentle.
    pub(super) fn part(&self, wide: f64, gap: f64) -> f64 {
        let near = ((self.level - gap) / self.blend).clamp(0.0, 1.0);
        let x = (wide / self.wide).clamp(0.0, 1.0) * near;
        let (a, b) = (x * x, (1.0 - x) * (1.0 - x));
        a * a / (a * a + b * b)
    }
}

/// Share of the weight below which a pair of faces has no points: the sides of a box that lies on a
/// face, turned by less than some hundred microradians, are seen as slivers. It is far below the
/// round-off of the shares of the others.
const NEGLIGIBLE: f64 = 1e-20;

/// Adds the corners of all pairs of faces to `points`, with their shares times `W`. `upper` looks
/// down, `lower` up.
pub(super) fn cover(
    (upper, upper_mesh): (&Seen, &Mesh),
    (lower, lower_mesh): (&Seen, &Mesh),
    frame: &Frame,
    limits: Limits,
    work: &mut Polygons,
    points: &mut Points,
) -> Cover {
    let first = points.count();
    let mut all = Cover {
        least: f64::INFINITY,
        ..Cover::default()
    };
    let mut covered = 0.0;
    let height = limits.level - (upper.heights.0 - lower.heights.1);
    for f in upper.fronts() {
        for g in lower.fronts() {
            if !f.meets(g) {
                continue;
            }
            if limits.asked == Asked::Points {
                let volume = f.common_area(g) * height;
                if (volume * volume) * (volume * volume) <= NEGLIGIBLE * all.weight {
                    continue;
                }
            }
            let gap = |x: &Vec3| x.z - g.height(x);
            let Polygons { one, two, .. } = &mut *work;
            let face = upper.outline(upper_mesh, f.index).rev();
            one.take(face.clone());
            let outline = lower.outline(lower_mesh, g.index);
            let [one, two] = Polygon::keep_within([one, two], outline);
            let nearest = one.corners().iter().map(gap).fold(f64::INFINITY, f64::min);
            all.least = all.least.min(nearest);
            if limits.asked == Asked::Least {
                continue;
            }
            two.cut(one, |x| limits.level - gap(x));
            let (area, volume) = two.integral(|x| limits.level - gap(x));
            if area <= 0.0 || volume <= 0.0 {
                continue;
            }
            let weight = (volume * volume) * (volume * volume);
            all.weight += weight;
            all.part += weight * limits.part(2.0 * area / two.circumference(), nearest);
            one.merge();
            corners(one, (f, g), frame, (limits.reach, weight), (first, points));
            if limits.asked == Asked::Points {
                continue;
            }
            // How much the face would cover of the whole plane.
            one.take(face);
            two.cut(one, |x| limits.level - gap(x));
            let (whole, _) = two.integral(|_| 0.0);
            covered += area;
            if whole > area {
                all.cut += area * (1.0 - area / whole);
            }
        }
    }
    if covered > 0.0 {
        all.cut /= covered;
    }
    if all.weight > 0.0 {
        all.part /= all.weight;
    }
    all
}

/// Adds the corners of a polygon with their shares times `weight`.
fn corners(
    polygon: &Polygon,
    (f, g): (&Front, &Front),
    frame: &Frame,
    (reach, weight): (f64, f64),
    (first, points): (usize, &mut Points),
) {
    let list = polygon.corners();
    let count = list.len();
    let tilts = f.tilt + g.tilt;
    let part = if tilts > 1e-26 { f.tilt / tilts } else { 0.5 };
    // Cosines, by which areas in a face are greater than seen.
    let (cos_f, cos_g) = (
        (1.0 - f.tilt).max(1e-18).sqrt(),
        (1.0 - g.tilt).max(1e-18).sqrt(),
    );
    for (i, x) in list.iter().enumerate() {
        let depth = g.height(x) - x.z;
        if depth <= -reach {
            continue;
        }
        let (before, after) = (list[(i + count - 1) % count], list[(i + 1) % count]);
        let (u, v) = (x - before, after - x);
        let (sine, cosine) = (turn(&u, &v), u.x * v.x + u.y * v.y);
        let rise = |e: &Vec3| g.slope[0] * e.x + g.slope[1] * e.y;
        let angle = |cos: f64, rises: f64| libm::atan2(sine / cos, cosine + rises).max(0.0);
        let share =
            part * angle(cos_f, u.z * v.z) + (1.0 - part) * angle(cos_g, rise(&u) * rise(&v));
        let middle = Vec3::new(x.x, x.y, x.z + 0.5 * depth);
        let share = weight * share / std::f64::consts::TAU;
        points.add(first, point(frame.world(&middle), depth, share));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::pair::placed::Placed;
    use crate::geometry::pair::tests::{any_rotation, at, cloud, solid};
    use crate::testing::Random;

    /// Where the level is looked for, nothing is asked for but the least gap: no point is found,
    /// of which there would be 64, and the gap is the one that all points have.
    #[test]
    fn the_least_gap_is_found_without_points() {
        let mut random = Random(0x2545_F491_4F6C_DD1D);
        for _ in 0..20 {
            let solids = [0, 1].map(|_| solid(&cloud(40, 0.1, &mut random)));
            let poses = [0, 1].map(|_| at(random.vector(0.02), any_rotation(&mut random)));
            let [a, b] = [0, 1].map(|i| Placed::new(&solids[i], &poses[i], &Vec3::zeros()));
            let frame = Frame::new(random.unit());
            let (mut upper, mut lower, mut work) = (Seen::new(), Seen::new(), Polygons::NONE);
            upper.look(&a, &frame);
            lower.look(&b, &frame);
            upper.face(&a, &frame, -1.0, f64::INFINITY);
            lower.face(&b, &frame, 1.0, f64::NEG_INFINITY);
            let mut look = |asked| {
                let limits = Limits {
                    level: 1.0,
                    blend: 1e-3,
                    wide: 1e-4,
                    reach: 1.0,
                    asked,
                };
                let mut points = Points::default();
                let pair = ((&upper, &solids[0].mesh), (&lower, &solids[1].mesh));
                let all = cover(pair.0, pair.1, &frame, limits, &mut work, &mut points);
                let depths = points.list().iter().map(|p| p.depth);
                (
                    all.least,
                    points.count(),
                    depths.fold(f64::NEG_INFINITY, f64::max),
                )
            };
            let (least, count, _) = look(Asked::Least);
            let (expected, all, deepest) = look(Asked::All);
            assert!(count == 0 && all > 20, "{count} {all}");
            assert!(
                least.to_bits() == expected.to_bits() && least <= 1e-12 - deepest,
                "{least} {expected} {deepest}"
            );
        }
    }
}
