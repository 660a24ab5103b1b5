//! Points of a patch.

use crate::spatial::Vec3;

/// Points of a patch, at most. Two boxes have eight; only faces with many corners, and what lies on
/// many triangles of a mesh, have more than 24. Of those on terrain the deepest ones find a place.
pub const MOST_POINTS: usize = 64;

/// Distance within which two points of a patch are one, m.
const SAME: f64 = 1e-14;

/// One of the two shapes of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// The first one, into which the normal points.
    #[default]
    First,
    /// The second one.
    Second,
}

impl Side {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }
}

/// A circle about the axis of a cylinder, of which a point is the lowest against the other shape.
///
/// Its law is that of rims in `force`, with the patch's normal; a circle of the second shape turns
/// with this shape's angular velocity against the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rim {
    /// Whose it is.
    pub side: Side,
    /// Its centre, m, in the frame of the poses.
    pub center: Vec3,
    /// Unit vector along the cylinder's axis, outwards.
    pub axis: Vec3,
    /// What of the axis lies in the tangent plane, times the radius, m.
    pub a: Vec3,
    /// Radius with the crown, `√(R (R + 2 s))`, m.
    pub radius: f64,
    /// Crown `s`, m.
    pub crown: f64,
}

/// A point of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PatchPoint {
    /// Position half way between the two surfaces along the normal, m, in the frame of the poses.
    pub x: Vec3,
    /// The patch's normal, but on uneven ground.
    pub normal: Vec3,
    /// Which part of the patch it belongs to, see [`super::Part`].
    pub part: usize,
    /// How much they overlap there along the normal, m; negative apart.
    pub depth: f64,
    /// Share `m_i` in a face: those of a whole face sum up to one.
    pub share: f64,
    /// The circle whose lowest point it is, of a cylinder.
    pub rim: Option<Rim>,
}

/// A point without a rim, with the patch's normal to come.
pub(super) fn point(x: Vec3, depth: f64, share: f64) -> PatchPoint {
    PatchPoint {
        x,
        depth,
        share,
        ..PatchPoint::default()
    }
}

/// Points that are being found.
#[derive(Clone, Debug)]
pub(super) struct Points {
    at: Box<[PatchPoint]>,
    count: usize,
}

impl Default for Points {
    fn default() -> Self {
        Self {
            at: vec![PatchPoint::default(); MOST_POINTS].into(),
            count: 0,
        }
    }
}

impl Points {
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn list(&self) -> &[PatchPoint] {
        &self.at[..self.count]
    }

    pub(super) fn all(&mut self) -> &mut [PatchPoint] {
        &mut self.at[..self.count]
    }

    /// Adds a point; `from`: first of the points among which one in the same place may be.
    pub(super) fn add(&mut self, from: usize, point: PatchPoint) {
        if let Some(point) = self.merge(from, point)
            && self.count < MOST_POINTS
        {
            self.at[self.count] = point;
            self.count += 1;
        }
    }

    /// Adds a point. If there is no place left, the deeper ones stay: what a shape lies on shall
    /// not depend on which of many triangles are found first.
    pub(super) fn add_deeper(&mut self, point: PatchPoint) {
        if self.count < MOST_POINTS {
            return self.add(0, point);
        }
        let by_depth = |a: &&mut PatchPoint, b: &&mut PatchPoint| a.depth.total_cmp(&b.depth);
        if let Some(point) = self.merge(0, point)
            && let Some(least) = self.at.iter_mut().min_by(by_depth)
            && least.depth < point.depth
        {
            *least = point;
        }
    }

    /// Adds the share of a point to that of one in the same place; gives it back where there is
    /// none.
    fn merge(&mut self, from: usize, point: PatchPoint) -> Option<PatchPoint> {
        if point.share <= 0.0 {
            return None;
        }
        let same = |p: &&mut PatchPoint| {
            (p.x - point.x).amax() <= SAME && (p.depth - point.depth).abs() <= SAME
        };
        let Some(known) = self.at[from..self.count].iter_mut().find(same) else {
            return Some(point);
        };
        known.share += point.share;
        None
    }

    /// Multiplies the shares of the points from `from` on; drops these where that is zero.
    pub(super) fn scale(&mut self, from: usize, by: f64) {
        if by <= 0.0 {
            self.count = from;
        }
        for p in &mut self.at[from..self.count] {
            p.share *= by;
        }
    }

    /// Multiplies the shares of the points from `from` on, before `to`.
    pub(super) fn scale_range(&mut self, from: usize, to: usize, by: f64) {
        for p in &mut self.at[from..to] {
            p.share *= by;
        }
    }

    /// Takes points in place of its own.
    pub(super) fn take(&mut self, points: &[PatchPoint]) {
        self.at[..points.len()].copy_from_slice(points);
        self.count = points.len();
    }

    /// Drops the points without a share.
    pub(super) fn drop_empty(&mut self) {
        self.keep(|point| point.share > 0.0);
    }

    /// Drops the points that are not within `reach`, m.
    pub(super) fn limit(&mut self, reach: f64) {
        self.keep(|point| -point.depth < reach);
    }

    fn keep(&mut self, keeps: impl Fn(&PatchPoint) -> bool) {
        let mut kept = 0;
        for i in 0..self.count {
            if keeps(&self.at[i]) {
                self.at[kept] = self.at[i];
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Moves all to the frame of the poses, with the shapes in their order; gives all the normal
    /// of the patch, if it has one.
    pub(super) fn finish(&mut self, origin: &Vec3, normal: Option<&Vec3>, swapped: bool) {
        for p in &mut self.at[..self.count] {
            p.x += origin;
            match normal {
                Some(normal) => p.normal = *normal,
                None if swapped => p.normal = -p.normal,
                None => {}
            }
            if let Some(rim) = &mut p.rim {
                rim.center += origin;
                if swapped {
                    rim.side = rim.side.other();
                }
            }
        }
    }
}
