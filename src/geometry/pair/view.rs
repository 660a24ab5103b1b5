//! Two shapes seen along the direction between them: corners as places in the plane across it and
//! heights, faces as heights over that plane.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::mesh::Mesh;
use super::placed::Placed;
use crate::geometry::MOST_CORNERS;
use crate::spatial::{Vec3, across};

/// Faces that can take part at a time: all of a hull, which has fewer than two a corner.
const MOST_FRONTS: usize = 2 * MOST_CORNERS;
/// Cosine to the direction below which a face is seen edge-on and has no part.
const EDGE_ON: f64 = 1e-9;

/// Axes of the plane and the direction, right-handed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    t: Vec3,
    b: Vec3,
    pub(super) n: Vec3,
}

impl Frame {
    pub(super) fn new(n: Vec3) -> Self {
        let t = across(&n);
        Self {
            t,
            b: n.cross(&t),
            n,
        }
    }

    /// A vector in these axes.
    pub(super) fn see(&self, x: &Vec3) -> Vec3 {
        Vec3::new(self.t.dot(x), self.b.dot(x), self.n.dot(x))
    }

    /// And back.
    pub(super) fn world(&self, x: &Vec3) -> Vec3 {
        self.t * x.x + self.b * x.y + self.n * x.z
    }
}

/// A face that looks towards the other shape.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Front {
    pub(super) index: usize,
    /// Height `h0 + slope·(u, v)`.
    pub(super) h0: f64,
    pub(super) slope: [f64; 2],
    /// Square of the sine of its tilt.
    pub(super) tilt: f64,
    /// Least and greatest place of its corners.
    low: [f64; 2],
    high: [f64; 2],
}

impl Front {
    /// Whether it may lie over another one.
    pub(super) fn meets(&self, other: &Self) -> bool {
        (0..2).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }

    /// Area that both have in common at most, m².
    pub(super) fn common_area(&self, other: &Self) -> f64 {
        let side =
            |i: usize| (self.high[i].min(other.high[i]) - self.low[i].max(other.low[i])).max(0.0);
        side(0) * side(1)
    }

    /// Its unit normal, up.
    pub(super) fn normal(&self, frame: &Frame) -> Vec3 {
        let up = Vec3::new(-self.slope[0], -self.slope[1], 1.0);
        frame.world(&up.normalize())
    }

    /// Height at a place.
    pub(super) fn height(&self, x: &Vec3) -> f64 {
        self.h0 + self.slope[0] * x.x + self.slope[1] * x.y
    }
}

/// A shape with faces, as seen.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    corners: Box<[Vec3]>,
    count: usize,
    fronts: Box<[Front]>,
    front_count: usize,
    /// Least and greatest height of a corner, m.
    pub(super) heights: (f64, f64),
    /// The ends of a cylinder, which its faces stand for.
    discs: Option<[Disc; 2]>,
}

/// The flat end of a cylinder, as seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    center: Vec3,
    radius: f64,
}

impl Disc {
    /// Between which places, within −1 … 1, a line `(middle, way)` is over the end with the plane
    /// of `front`, and how far inside of it its middle there is, m, as seen.
    ///
    /// What lies below the line in that plane is, from the centre, `r₀ + s r₁`; over the end is
    /// where this is no longer than the radius.
    pub(super) fn clip(&self, front: &Front, (middle, way): (&Vec3, &Vec3)) -> (f64, f64, f64) {
        const NONE: (f64, f64, f64) = (1.0, -1.0, 0.0);
        let below = |x: Vec3| Vec3::new(x.x, x.y, front.height(&x));
        let from = below(*middle) - self.center;
        let rate = below(middle + way) - below(*middle);
        let (square, half) = (rate.norm_squared(), from.dot(&rate));
        let beyond = from.norm_squared() - self.radius * self.radius;
        let root = half * half - square * beyond;
        if root <= 0.0 && beyond >= 0.0 {
            return NONE;
        }
        let (mut low, mut high) = (-1.0_f64, 1.0_f64);
        if root > 0.0 {
            // Of the two quotients for each root the one without cancellation.
            let sum = -(half + root.sqrt().copysign(half));
            let (one, two) = (sum / square, beyond / sum);
            (low, high) = (low.max(one.min(two)), high.min(one.max(two)));
        }
        let seen = (1.0 - front.tilt).max(0.0).sqrt();
        let inside = self.radius - (from + rate * (0.5 * (low + high))).norm();
        (low, high, inside * seen)
    }
}

impl Seen {
    /// Room for the largest solid.
    pub(super) fn new() -> Self {
        let front = Front {
            index: 0,
            h0: 0.0,
            slope: [0.0; 2],
            tilt: 0.0,
            low: [0.0; 2],
            high: [0.0; 2],
        };
        Self {
            corners: vec![Vec3::zeros(); MOST_CORNERS].into(),
            count: 0,
            fronts: vec![front; MOST_FRONTS].into(),
            front_count: 0,
            heights: (0.0, 0.0),
            discs: None,
        }
    }

    /// Looks at the corners of a solid.
    pub(super) fn look(&mut self, placed: &Placed, frame: &Frame) {
        let (R, p) = (
            [0, 1, 2].map(|i| frame.see(&placed.R.column(i).into())),
            frame.see(&placed.p),
        );
        let corners = &placed.solid.mesh.corners;
        self.count = corners.len().min(MOST_CORNERS);
        self.heights = (f64::INFINITY, f64::NEG_INFINITY);
        for (seen, c) in self.corners.iter_mut().zip(corners) {
            *seen = p + R[0] * c.x + R[1] * c.y + R[2] * c.z;
            self.heights = (self.heights.0.min(seen.z), self.heights.1.max(seen.z));
        }
        let round = placed.solid.round.filter(|round| round.flat);
        self.discs = round.map(|round| {
            [1.0, -1.0].map(|end| Disc {
                center: p + R[2] * (end * round.half),
                radius: round.radius,
            })
        });
    }

    /// Moves faces that are tilted back to what lies behind them: by `r (1/cos θ − 1)` where the
    /// shape is rounded by `r` and the face tilted by `θ`. Over an edge, with the same tilt of both
    /// of its faces, their height is then that of the rounded shape, and no other face than one
    /// that is tilted is changed.
    pub(super) fn round(&mut self, r: f64) {
        for front in &mut self.fronts[..self.front_count] {
            let cos = (1.0 - front.tilt).max(f64::MIN_POSITIVE).sqrt();
            front.h0 -= r * front.tilt / (cos * (1.0 + cos));
        }
    }

    /// Finds the faces that look up, `up` = 1, or down, −1, and reach beyond the height `limit`
    /// that way.
    pub(super) fn face(&mut self, placed: &Placed, frame: &Frame, up: f64, limit: f64) {
        self.front_count = 0;
        let local = placed.R.tr_mul(&(frame.n * up));
        let mesh = &placed.solid.mesh;
        for (index, normal) in mesh.normals.iter().enumerate() {
            let cos = normal.dot(&local);
            if cos <= EDGE_ON {
                continue;
            }
            let list = mesh.face(index);
            let beyond = |z: f64| up * (z - limit) > 0.0;
            let reaches = list.iter().any(|&i| beyond(self.corners[i].z))
                || self.disc(index).is_some_and(|disc| {
                    let rise = disc.radius * (1.0 - cos * cos).max(0.0).sqrt();
                    beyond(disc.center.z + up * rise)
                });
            if !reaches || self.front_count == MOST_FRONTS {
                continue;
            }
            let seen = frame.see(&(placed.R * normal));
            let slope = [-seen.x / seen.z, -seen.y / seen.z];
            let corner = &self.corners[list[0]];
            let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            for &i in list {
                for axis in 0..2 {
                    low[axis] = low[axis].min(self.corners[i][axis]);
                    high[axis] = high[axis].max(self.corners[i][axis]);
                }
            }
            self.fronts[self.front_count] = Front {
                index,
                h0: corner.z - slope[0] * corner.x - slope[1] * corner.y,
                slope,
                tilt: seen.x * seen.x + seen.y * seen.y,
                low,
                high,
            };
            self.front_count += 1;
        }
        // Those that look at the other shape most come first: beside them others count for little.
        let fronts = &mut self.fronts[..self.front_count];
        // By insertion, as of pairs in `force/pairs.rs`.
        for last in 1..fronts.len() {
            let front = &fronts[last];
            let follows = |other: &Front| {
                let by_tilt = other.tilt.total_cmp(&front.tilt);
                by_tilt.then(other.index.cmp(&front.index)).is_gt()
            };
            let before = fronts[..last].iter().rposition(|other| !follows(other));
            let at = before.map_or(0, |before| before + 1);
            fronts[at..=last].rotate_right(1);
        }
    }

    pub(super) fn fronts(&self) -> &[Front] {
        &self.fronts[..self.front_count]
    }

    /// The disc that a face stands for.
    pub(super) fn disc(&self, face: usize) -> Option<&Disc> {
        self.discs.as_ref()?.get(face)
    }

    /// Corners of a face in order, as seen.
    pub(super) fn outline<'a>(
        &'a self,
        mesh: &'a Mesh,
        face: usize,
    ) -> impl DoubleEndedIterator<Item = Vec3> + ExactSizeIterator + Clone + 'a {
        mesh.face(face).iter().map(|&i| self.corners[i])
    }
}
