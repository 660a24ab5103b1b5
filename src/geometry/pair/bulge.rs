//! Where smooth heights bulge towards a shape between its corners and rims.
//!
//! Corners and rims alone carry a shape on even ground. On a hill whose samples are so fine that
//! none is sharp, the hill would pass into a face between its corners by `κ L²/8`, 5 cm for a
//! board of 2 m on a hill of a radius of 10 m. So places of the shape's own surface are looked at,
//! too: a grid on each face that looks down, and circles along the axis of a capsule or a cylinder.
//!
//! 1. Where the ground is even between the corners of a face, the depth at a place is that of the
//!    corners, interpolated. The bulge at a place is by how much it is deeper than that; `B` is the
//!    largest bulge of a face.
//! 2. All places of a face have the same share, together `min(1, B/b)`, with `b` the length over
//!    which faces take over from each other. A bulge of [`BULGE_LEAST`] times `b` is round-off and
//!    has none. So even ground is a plane to the last digit, and shares change continuously with
//!    the pose.
//! 3. A place counts less by the cosine where its face does not look against the normal of the
//!    ground, and less where samples are sharp, because these act themselves.
//!
//! The ground rises by little between places beside each other, as far as [`MOST_LOOKS`] allow.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::{Core, Round};
use super::deepest::Deepest;
use super::foot::{Nearest, Place, nearest_from};
use super::placed::Placed;
use super::points::{PatchPoint, Rim, Side, point};
use super::ring::{Low, Lows};
use super::sink::Sink;
use super::trace::Trace;
use crate::geometry::MOST_CORNERS;
use crate::geometry::field::{Field, count};
use crate::spatial::Vec3;
use crate::tuning::{
    BULGE_BETWEEN, BULGE_LEAST, MOST_BULGES, MOST_LOOKS, MOST_ON_LINE, NEAREST_ON_FIELD,
};

/// Adds the places between corners and rims, given in the axes of the terrain.
///
/// - `ends`: of a capsule or a cylinder, if the terrain is below both
pub(super) fn bulges(shape: &Placed, field: &Field, ends: Option<[End; 2]>, sink: &mut Sink) {
    let solid = shape.solid;
    // A ball has no place but its nearest one.
    if let Core::Point = shape.core {
        return;
    }
    let bend = field.hump(shape.p.x, shape.p.y, solid.reach);
    let mut on = Bulges {
        shape,
        field,
        bend,
        sink,
    };
    // No face and no line is longer.
    if !on.counts(2.0 * solid.reach) {
        return;
    }
    match &solid.round {
        Some(round) => {
            if let Some(ends) = ends {
                on.line(round, ends);
            }
            if round.flat {
                // The inside of an end is touched first only where it looks against a normal.
                on.faces(field.upright());
            }
        }
        None => on.faces(0.0),
    }
}

/// What is being found.
struct Bulges<'a, 's> {
    shape: &'a Placed<'a>,
    field: &'a Field,
    /// What the surface bends down by near the shape, at most, 1/m.
    bend: f64,
    sink: &'a mut Sink<'s>,
}

/// An end of a capsule or a cylinder against the ground below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    /// Normal of the ground.
    pub(super) n: Vec3,
    /// m
    pub(super) depth: f64,
}

/// A place of the shape against the ground below it.
#[derive(Clone, Copy, Default)]
struct Look {
    /// Normal of the ground.
    n: Vec3,
    /// Where it is, m.
    x: Vec3,
    /// How much of the share of a place it has.
    part: f64,
    rim: Option<Rim>,
}

/// The places of a face or a line.
struct Looks {
    deepest: Deepest<[(f64, Look); MOST_BULGES]>,
    /// How many there are that may have a part.
    count: usize,
    /// The largest bulge, m.
    bulge: f64,
}

impl Looks {
    fn new() -> Self {
        Self {
            deepest: Deepest::new(),
            count: 0,
            bulge: 0.0,
        }
    }

    /// Adds a place and how deep it is; `even`: its depth on ground that is even between the
    /// corners, m.
    fn add(&mut self, (depth, look): (f64, Look), even: f64) {
        self.bulge = self.bulge.max(depth - even);
        self.deepest.add(depth, look);
    }

    /// Adds the points; `blend`: the bulge whose share is the whole, m.
    fn into_points(self, blend: f64, sink: &mut Sink) {
        let whole = (self.bulge / blend - BULGE_LEAST).min(1.0);
        if whole <= 0.0 {
            return;
        }
        let share = whole / count(self.count);
        for (depth, look) in self.deepest.found() {
            let halfway = look.x + look.n * (0.5 * depth);
            let found = PatchPoint {
                rim: look.rim,
                ..point(halfway, *depth, share * look.part)
            };
            sink.add(&look.n, found);
        }
    }
}

impl Bulges<'_, '_> {
    /// Whether the ground may bulge by more than round-off within a length, m.
    fn counts(&self, length: f64) -> bool {
        self.bend * length * length > 8.0 * BULGE_LEAST * self.shape.solid.blend
    }

    /// How much of a place does not belong to sharp samples, 0 … 1.
    fn smooth(&self, x: &Vec3) -> f64 {
        1.0 - self.field.sharp(x.x, x.y)
    }

    /// Into how many parts a length is divided, at most `most`: the ground rises by `κ c²/8`
    /// between places `c` apart. The number is the same wherever the shape is, so that places do
    /// not jump.
    fn parts(&self, length: f64, most: usize) -> usize {
        let rise = 0.125 * self.field.humps() * length * length;
        let between = BULGE_BETWEEN * self.shape.solid.blend;
        // At least two: a middle.
        let fine = (2..most).find(|n| rise <= between * count(n * n));
        fine.unwrap_or(most)
    }

    /// Circles along the axis of a capsule or a cylinder, between its ends.
    fn line(&mut self, round: &Round, [last, first]: [End; 2]) {
        let length = 2.0 * round.half;
        if !self.counts(length) {
            return;
        }
        let most = first.depth.max(last.depth) + 0.125 * self.bend * length * length;
        if most <= -self.sink.reach {
            return;
        }
        let parts = self.parts(length, MOST_ON_LINE);
        let mut looks = Looks::new();
        for k in 1..parts {
            let way = count(k) / count(parts);
            let near = first.n + (last.n - first.n) * way;
            let even = first.depth + (last.depth - first.depth) * way;
            looks.count += 1;
            self.circle(round, 2.0 * way - 1.0, near, |look| looks.add(look, even));
        }
        looks.into_points(self.shape.solid.blend, self.sink);
    }

    /// The lowest places of the circle at `s` of an axis, −1 … 1, near which the ground has about
    /// the normal `near`, of any length.
    fn circle(&self, round: &Round, s: f64, near: Vec3, mut add: impl FnMut((f64, Look))) {
        if !round.flat {
            let found = self.ball(round, s);
            return found.into_iter().for_each(add);
        }
        // The ends have been looked for in the same way.
        let (field, reach) = (self.field, self.sink.reach);
        if let Some(lows) = Lows::find(self.shape, round, s, (field, reach)) {
            for low in lows.found() {
                let part = low.part * self.smooth(&low.x);
                let Low { n, x, rim, .. } = *low;
                add((low.depth, Look { n, x, part, rim }));
            }
            return;
        }
        let lowest = |n: &Vec3| Trace::new(self.shape, round, n, Side::First).end(s);
        // Each time the error of the normal is multiplied by the radius over that of the hill.
        let Some((n, _)) = field.below(&lowest(&near.normalize()).0) else {
            return;
        };
        let (x, rim) = lowest(&n);
        if let Some((_, depth)) = field.below(&x) {
            let part = self.smooth(&x);
            add((depth, Look { n, x, part, rim }));
        }
    }

    /// The deepest place of a ball at `s` of the axis of a capsule.
    fn ball(&self, round: &Round, s: f64) -> Option<(f64, Look)> {
        let c = self.shape.p + self.shape.axis() * (s * round.half);
        let against = |Place { at, n }: &Place| {
            let x = c - n * round.radius;
            let look = Look {
                n: *n,
                x,
                part: self.smooth(&x),
                rim: None,
            };
            (n.dot(&(at - x)), look)
        };
        let nearest = Nearest::in_hollow(self.field, &c, round.radius, self.sink.reach);
        let found = nearest.found().iter().map(against);
        found.max_by(|(a, _), (b, _)| a.total_cmp(b)).or_else(|| {
            let looks = (NEAREST_ON_FIELD, f64::INFINITY);
            let (place, _) = nearest_from(self.field, &c, [c.x, c.y], looks)?;
            Some(against(&place))
        })
    }

    /// Grids on the faces of which the normal goes down by more than `least`.
    fn faces(&mut self, least: f64) {
        let mesh = &self.shape.solid.mesh;
        for (index, normal) in mesh.normals.iter().enumerate() {
            let normal = self.shape.R * normal;
            if -normal.z > least {
                self.face(&normal, mesh.face(index));
            }
        }
    }

    /// Grids on the triangles that the sides of a face make with its middle.
    fn face(&mut self, normal: &Vec3, indices: &[usize]) {
        let (shape, mesh) = (self.shape, &self.shape.solid.mesh);
        // Each corner, and its depth, m.
        let mut corners = [(Vec3::zeros(), 0.0); MOST_CORNERS];
        let corners = &mut corners[..indices.len()];
        for (corner, &index) in corners.iter_mut().zip(indices) {
            corner.0 = shape.world(&mesh.corners[index]);
        }
        let sides = count(corners.len());
        let middle = corners.iter().map(|(x, _)| x).sum::<Vec3>() / sides;
        let size = corners.iter().map(|(x, _)| (x - middle).norm());
        let size = size.fold(0.0, f64::max);
        if !self.counts(2.0 * size) {
            return;
        }
        let (mut mean, mut most) = (0.0, f64::NEG_INFINITY);
        for (x, depth) in &mut *corners {
            // A corner beyond the end of the ground lies on the tangent plane there.
            let Some((_, found)) = self.field.below_or_end(x) else {
                return;
            };
            *depth = found;
            mean += found / sides;
            most = found.max(most);
        }
        if most + 0.5 * self.bend * size * size <= -self.sink.reach {
            return;
        }
        let fine = (2..MOST_LOOKS).find(|n| corners.len() * n * (n + 1) > 2 * MOST_LOOKS);
        let parts = self.parts(size, fine.unwrap_or(MOST_LOOKS));
        let mut looks = Looks::new();
        let mut add = |x: Vec3, even: f64| {
            if let Some((n, depth)) = self.field.below(&x) {
                let look = Look {
                    n,
                    x,
                    part: (-normal.dot(&n)).max(0.0) * self.smooth(&x),
                    rim: None,
                };
                looks.count += 1;
                looks.add((depth, look), even);
            }
        };
        add(middle, mean);
        let next = corners.iter().cycle().skip(1);
        for ((a, depth_a), (b, depth_b)) in corners.iter().zip(next) {
            // Corners act by themselves, and places between the middle and `b` are the next side's.
            for i in 1..parts {
                for j in 0..=parts - i {
                    let (u, v) = (count(i) / count(parts), count(j) / count(parts));
                    let x = middle + (a - middle) * u + (b - middle) * v;
                    add(x, mean + (depth_a - mean) * u + (depth_b - mean) * v);
                }
            }
        }
        looks.into_points(shape.solid.blend, self.sink);
    }
}
