//! What of smooth heights bulges between the corners and rims of a shape that lies on them.
//!
//! Corners and rims alone carry a shape on even ground. On a hill whose samples are so fine that
//! none is sharp, the hill would pass into a face between its corners by `κ L²/8`, 5 cm for a
//! board of 2 m on a hill of a radius of 10 m. So places of the shape's own surface are looked at,
//! too: a grid on each face that looks down, and circles along the axis of a capsule or a cylinder.
//!
//! 1. Where the ground is even between the corners of a face, the depth at a place is that of the
//!    corners, interpolated. By how much it is more is the bulge there; `B` is the largest of a
//!    face.
//! 2. The places have the share `min(1, B/b)` together, but for round-off, all the same part of it,
//!    with `b` the length over which faces take over from each other. So on even ground they have
//!    none, to the last digit, and what they have changes continuously with the pose.
//! 3. A face that does not look against the normal of the ground counts less, by the cosine; so do
//!    places where samples are sharp, which act themselves.
//!
//! Places are so near to each other that the ground between them rises by little, as far as
//! [`MOST_LOOKS`] allow.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::Round;
use super::foot::{Nearest, Place, nearest_from};
use super::placed::Placed;
use super::points::{PatchPoint, Rim, Side, point};
use super::sink::Sink;
use super::trace::Trace;
use crate::geometry::field::Field;
use crate::spatial::Vec3;
use crate::tuning::{
    BULGE_BETWEEN, BULGE_LEAST, MOST_BULGES, MOST_LOOKS, MOST_ON_LINE, NEAREST_ON_FIELD,
};

/// Adds the places between corners and rims, given in the axes of the terrain.
///
/// - `ends`: of a capsule or a cylinder, if the terrain is below both
pub(super) fn bulges(shape: &Placed, field: &Field, ends: Option<[End; 2]>, sink: &mut Sink) {
    let solid = shape.solid;
    let bend = field.hump(shape.p.x, shape.p.y, solid.reach);
    let mut on = Bulges {
        shape,
        field,
        bend,
        sink,
    };
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
    /// m
    x: Vec3,
    depth: f64,
    /// How much of its share it has.
    part: f64,
    rim: Option<Rim>,
}

/// The deepest of the places that have been looked at.
struct Deepest {
    list: [Look; MOST_BULGES],
    kept: usize,
    looks: usize,
    /// The largest bulge, m.
    bulge: f64,
}

impl Deepest {
    fn new() -> Self {
        Self {
            list: [Look::default(); MOST_BULGES],
            kept: 0,
            looks: 0,
            bulge: 0.0,
        }
    }

    /// Looks at a place; `even`: its depth if the ground were even between the corners, m.
    fn add(&mut self, look: Look, even: f64) {
        self.looks += 1;
        self.bulge = self.bulge.max(look.depth - even);
        let at = self.list[..self.kept].partition_point(|known| known.depth >= look.depth);
        if at < MOST_BULGES {
            self.kept = (self.kept + 1).min(MOST_BULGES);
            self.list[at..self.kept].rotate_right(1);
            self.list[at] = look;
        }
    }

    fn into(self, blend: f64, sink: &mut Sink) {
        let whole = (self.bulge / blend - BULGE_LEAST).min(1.0);
        if whole <= 0.0 {
            return;
        }
        let share = whole / count(self.looks);
        for look in &self.list[..self.kept] {
            let halfway = look.x + look.n * (0.5 * look.depth);
            let found = PatchPoint {
                rim: look.rim,
                ..point(halfway, look.depth, share * look.part)
            };
            sink.add(&look.n, found);
        }
    }
}

impl Bulges<'_, '_> {
    /// Whether what bulges within a length counts, m.
    fn counts(&self, length: f64) -> bool {
        self.bend * length * length > 8.0 * BULGE_LEAST * self.shape.solid.blend
    }

    /// The tangent plane below a place: its normal, and how deep the place is in it.
    fn below(&self, x: &Vec3) -> Option<(Vec3, f64)> {
        let (height, n) = self.field.tangent(x.x, x.y)?;
        Some((n, (height - x.z) * n.z))
    }

    /// What of a place does not belong to sharp samples.
    fn smooth(&self, x: &Vec3) -> f64 {
        1.0 - self.field.sharp(x.x, x.y)
    }

    /// Into how many parts a length is divided, at most so many: the ground rises by `κ c²/8`
    /// between places `c` apart. The same wherever the shape is, so that nothing jumps.
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
        let mut deepest = Deepest::new();
        for k in 1..parts {
            let way = count(k) / count(parts);
            let near = first.n + (last.n - first.n) * way;
            let even = first.depth + (last.depth - first.depth) * way;
            if let Some(look) = self.circle(round, 2.0 * way - 1.0, near) {
                deepest.add(look, even);
            }
        }
        deepest.into(self.shape.solid.blend, self.sink);
    }

    /// The lowest place of the circle at `s` of an axis, −1 … 1, near which the ground has about
    /// the normal `near`, of any length.
    fn circle(&self, round: &Round, s: f64, near: Vec3) -> Option<Look> {
        let c = self.shape.p + self.shape.axis() * (s * round.half);
        let lowest = |n: &Vec3| Trace::new(self.shape, round, n, Side::First).end(s);
        let against = |Place { at, n }: &Place| {
            let (x, rim) = if round.flat {
                lowest(n)
            } else {
                (c - n * round.radius, None)
            };
            Look {
                n: *n,
                x,
                depth: n.dot(&(at - x)),
                part: self.smooth(&x),
                rim,
            }
        };
        // As the ends are looked for.
        let nearest = Nearest::in_hollow(self.field, &c, round.radius, self.sink.reach);
        let found = nearest.found().iter().map(against);
        if let Some(deepest) = found.max_by(|a, b| a.depth.total_cmp(&b.depth)) {
            return Some(deepest);
        }
        if !round.flat {
            let looks = (NEAREST_ON_FIELD, f64::INFINITY);
            let (place, _) = nearest_from(self.field, &c, [c.x, c.y], looks)?;
            return Some(against(&place));
        }
        // Each time the error of the normal becomes less by the radius over that of the hill.
        let (n, _) = self.below(&lowest(&near.normalize()).0)?;
        let (x, rim) = lowest(&n);
        let (_, depth) = self.below(&x)?;
        Some(Look {
            n,
            x,
            depth,
            part: self.smooth(&x),
            rim,
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

    /// A grid on each triangle of a side of a face and its middle.
    fn face(&mut self, normal: &Vec3, corners: &[usize]) {
        let (shape, mesh) = (self.shape, &self.shape.solid.mesh);
        let corner = |k: usize| shape.world(&mesh.corners[corners[k % corners.len()]]);
        let sides = corners.len();
        let middle = (0..sides).map(corner).sum::<Vec3>() / count(sides);
        let size = (0..sides).map(|k| (corner(k) - middle).norm());
        let size = size.fold(0.0, f64::max);
        if !self.counts(2.0 * size) {
            return;
        }
        // Where there is no ground below it a corner lies on the tangent plane of its end.
        let depth = |x: &Vec3| {
            let [a, b] = self.field.within([x.x, x.y]);
            let (height, n) = self.field.tangent(a, b)?;
            Some(n.dot(&(Vec3::new(a, b, height) - x)))
        };
        let mut mean = 0.0;
        let mut deepest_corner = f64::NEG_INFINITY;
        for k in 0..sides {
            let Some(depth) = depth(&corner(k)) else {
                return;
            };
            mean += depth / count(sides);
            deepest_corner = deepest_corner.max(depth);
        }
        if deepest_corner + 0.5 * self.bend * size * size <= -self.sink.reach {
            return;
        }
        let most = (2..MOST_LOOKS).find(|n| sides * n * (n + 1) > 2 * MOST_LOOKS);
        let parts = self.parts(size, most.unwrap_or(MOST_LOOKS));
        let mut deepest = Deepest::new();
        let mut look = |x: Vec3, even: f64| {
            if let Some((n, depth)) = self.below(&x) {
                let part = (-normal.dot(&n)).max(0.0) * self.smooth(&x);
                let rim = None;
                deepest.add(
                    Look {
                        n,
                        x,
                        depth,
                        part,
                        rim,
                    },
                    even,
                );
            }
        };
        look(middle, mean);
        let (mut a, mut depth_a) = (corner(0), depth(&corner(0)).unwrap_or(mean));
        for k in 0..sides {
            let b = corner(k + 1);
            let depth_b = depth(&b).unwrap_or(mean);
            for i in 1..=parts {
                // Places of the next side lie on the next triangle; corners act by themselves.
                for j in usize::from(i == parts)..=parts - i {
                    let (u, v) = (count(i) / count(parts), count(j) / count(parts));
                    if j < parts {
                        let x = middle + (a - middle) * u + (b - middle) * v;
                        look(x, mean + (depth_a - mean) * u + (depth_b - mean) * v);
                    }
                }
            }
            (a, depth_a) = (b, depth_b);
        }
        deepest.into(shape.solid.blend, self.sink);
    }
}

#[expect(clippy::cast_precision_loss, reason = "a small count")]
fn count(n: usize) -> f64 {
    n as f64
}
