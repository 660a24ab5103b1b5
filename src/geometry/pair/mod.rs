//! Contact between two shapes: where they touch, how deep, and how much of a face each point
//! carries.
//!
//! In: two shapes, prepared by [`Solid::new`], and their poses. Out: a [`Patch`], a normal and some
//! points. What a contact of these points does is in [`crate::force`]; nothing here knows forces or
//! velocities, and nothing is remembered from one query to the next.
//!
//! 1. The normal is the direction between the nearest points of the cores, see `core.rs`. It moves
//!    continuously with the poses. Where the shapes overlap by more than half of their roundings,
//!    smaller cores take over, and where these meet, too, the axis of least overlap, which jumps.
//! 2. Depths of faces are those of the sharp shapes along the normal, so a face that lies on a face
//!    has the depths that it has on a plane. Balls meet what is rounded at its edges.
//! 3. Each point has its share in a face, so that the fourth-power mean of the depths is
//!    continuous, too: `polygon.rs` for faces, `trace.rs` for the lines and rims of round shapes,
//!    `edges.rs` for what lies along an edge.
//! 4. A cylinder's flat end that lies within a face has the law of a rim. Where a side of the face
//!    cuts it, a polygon of 16 corners takes over, by four times the part that is cut off.
//!
//! | pair | points and shares |
//! |---|---|
//! | ball | one, 1 |
//! | capsule on plane or face | two ends of what lies over it, ½ |
//! | two capsules | skew one, 1; parallel two, ½ |
//! | box, hull on plane | corners, exterior angle / 2π |
//! | box, hull on box, hull | corners of the polygon that both cover, exterior angle / 2π |
//! | capsule, cylinder or edge along an edge | two ends of what both have in common, ½ |
//! | cylinder on plane or face | two circles, ½ each; standing one of them is high above |
//! | cylinder on cylinder | as on a face where an end takes part, as two capsules otherwise |
//! | all on heights | those on a plane, what bulges between, sharp samples, see `field.rs` |
//! | all on a mesh | those on each plane, and on each crest of the mesh, see `surface.rs` |
//!
//! Nothing is allocated in a query. Exchanging the shapes gives the same points to round-off and
//! the opposite normal.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod bulge;
mod core;
mod corners;
mod cylinders;
mod deep;
mod deepest;
mod edges;
mod field;
mod flush;
mod foot;
mod gjk;
mod hollow;
mod leads;
mod lifts;
mod lowest;
mod meet;
mod mesh;
mod nearby;
mod nearest;
mod own;
mod placed;
mod points;
mod polygon;
mod ring;
mod segments;
mod share;
mod shut;
mod sink;
mod surface;
mod terrain;
#[cfg(test)]
pub(crate) mod tests;
mod trace;
mod view;

pub use self::core::Solid;
pub use self::lifts::Lifted;
pub use self::nearby::Nearby;
pub use self::points::{MOST_POINTS, PatchPoint, Rim, Side};
pub use self::shut::Others;
pub use self::terrain::{MOST_PARTS, Part};

use self::core::Core;
use self::meet::Meeting;
use self::placed::{Placed, rank, separation};
use self::points::Points;
use self::shut::Among;
use crate::spatial::{Pose, Vec3};

/// By which share of two shapes' reach they must be farther apart than a query looks, so that it is
/// certain that this finds nothing: much more than what round-off makes of either.
/// (`what_is_known_to_be_apart_is_found_to_be` in `tests/apart.rs`)
const CERTAIN: f64 = 1e-9;

/// What two shapes have in common. One is filled again and again: it holds the memory of a query,
/// too.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// Unit vector from the second shape into the first.
    pub normal: Vec3,
    /// Whether the shapes overlap by more than half of their roundings, so that smaller cores have
    /// a part in the normal.
    pub blended: bool,
    /// Whether these smaller cores meet, too: then the normal may jump.
    pub deep: bool,
    /// Share of the spring that the contact has, 0 … 1: less than 1 where what carries the first
    /// shape together with the second one has another part of a face.
    pub share: f64,
    points: Points,
    meeting: Meeting,
    on_surface: surface::Scratch,
    parts: [Part; MOST_PARTS],
    count: usize,
}

impl Patch {
    /// An empty one.
    pub fn new() -> Self {
        Self::default()
    }

    /// What belongs together: all, but several parts on terrain that is uneven.
    pub fn parts(&self) -> &[Part] {
        &self.parts[..self.count]
    }

    /// Its points.
    pub fn points(&self) -> &[PatchPoint] {
        self.points.list()
    }

    /// Whether `a` at `X_WA` and `b` at `X_WB` are nearer than `reach`, m, by their rounded shapes;
    /// see [`Self::find`].
    pub fn are_near((a, X_WA): (&Solid, &Pose), (b, X_WB): (&Solid, &Pose), reach: f64) -> bool {
        let couple = Couple::new((a, X_WA), (b, X_WB));
        let (above, below) = couple.ranked();
        Meeting::are_near(above, below, reach)
    }

    /// Whether along the unit vector `n`, from `b` to `a`, the shapes are certainly so far apart
    /// that [`Self::find`] finds nothing within `reach`, m. Not of terrain.
    pub fn are_apart(
        (a, X_WA): (&Solid, &Pose),
        (b, X_WB): (&Solid, &Pose),
        reach: f64,
        n: &Vec3,
    ) -> bool {
        let couple = Couple::new((a, X_WA), (b, X_WB));
        let gap = separation(&couple.first, &couple.second, n) - (a.radius + b.radius);
        gap > reach + a.sharp + b.sharp + CERTAIN * (a.reach + b.reach)
    }

    /// Finds what `a` at `X_WA` and `b` at `X_WB` have in common, as far as it is nearer than
    /// `reach`, m; whether there is anything. Positions and vectors are those of the frame W.
    ///
    /// A half-space may be `a` or `b`; two half-spaces have nothing in common.
    pub fn find(&mut self, a: (&Solid, &Pose), b: (&Solid, &Pose), reach: f64) -> bool {
        self.find_near([a, b], None, reach, None)
    }

    /// The same with what else stands there, and with what was near when the same two shapes were
    /// looked at before, if one of them is a mesh, which only saves time.
    pub fn find_near(
        &mut self,
        [a, b]: [(&Solid, &Pose); 2],
        others: Option<&dyn Others>,
        reach: f64,
        nearby: Option<&mut Nearby>,
    ) -> bool {
        let Some(couple) = self.begin(a, b, reach) else {
            return false;
        };
        let (above, below) = couple.ranked();
        if matches!(below.core, Core::Field(_) | Core::Surface(_)) {
            if !above.solid.is_terrain() {
                let among = couple.among(others);
                let scratch = (&mut self.meeting, &mut self.on_surface);
                let (pair, points) = ((above, below), &mut self.points);
                terrain::on_terrain(pair, among.as_ref(), reach, scratch, nearby, points);
            }
            self.points.finish(&couple.origin, None, couple.swapped);
            self.count = terrain::parts(&mut self.points, &mut self.parts);
            (self.blended, self.deep, self.share) = (false, false, 1.0);
            self.normal = self.parts[0].normal;
            return self.count > 0;
        }
        self.meet(&couple, others, [reach; 2])
    }

    /// Begins with nothing in common; none of what is certainly farther apart than `reach`, m.
    fn begin<'a>(
        &mut self,
        (a, X_WA): (&'a Solid, &Pose),
        (b, X_WB): (&'a Solid, &Pose),
        reach: f64,
    ) -> Option<Couple<'a>> {
        self.points.clear();
        self.count = 0;
        let far = (X_WA.p - X_WB.p).norm() > a.reach + b.reach + reach;
        (!far).then(|| Couple::new((a, X_WA), (b, X_WB)))
    }

    /// Finds what a couple without terrain has in common; for the reaches see
    /// [`Meeting::find_along`].
    fn meet(&mut self, couple: &Couple, others: Option<&dyn Others>, reaches: [f64; 2]) -> bool {
        let among = couple.among(others);
        let (pair, points) = (couple.ranked(), &mut self.points);
        let found = self.meeting.find(pair, among.as_ref(), reaches, points);
        (self.normal, self.blended, self.deep) = found;
        if couple.swapped {
            self.normal = -self.normal;
        }
        let normal = Some(&self.normal);
        self.points.finish(&couple.origin, normal, couple.swapped);
        self.share = match &among {
            Some(among) if self.points.count() > 0 => {
                let pair = [&couple.first, &couple.second];
                self.meeting.share(pair, &self.normal, among)
            }
            _ => 1.0,
        };
        self.share > 0.0 && self.be_one_part()
    }

    /// Makes all points one part; tells whether there are any.
    fn be_one_part(&mut self) -> bool {
        self.parts[0] = Part {
            normal: self.normal,
            points: 0..self.points().len(),
            ..Part::default()
        };
        self.count = usize::from(!self.points().is_empty());
        self.count > 0
    }

    /// Finds all points of two shapes that are nearer than `reach`, m, however far these points are
    /// from each other; tells whether [`Self::limit`] makes of them what [`Self::find`] finds for
    /// any reach. Not of terrain.
    pub fn find_whole(
        &mut self,
        [a, b]: [(&Solid, &Pose); 2],
        others: Option<&dyn Others>,
        reach: f64,
    ) -> bool {
        let Some(couple) = self.begin(a, b, reach) else {
            return false;
        };
        self.meet(&couple, others, [reach, f64::INFINITY])
            && !self.meeting.flush
            && self.points.count() < MOST_POINTS
    }

    /// Takes points that [`Self::find_whole`] has found.
    pub fn take(
        &mut self,
        (normal, share): (&Vec3, f64),
        [blended, deep]: [bool; 2],
        points: &[PatchPoint],
    ) {
        (self.normal, self.share) = (*normal, share);
        (self.blended, self.deep) = (blended, deep);
        self.points.take(points);
        self.be_one_part();
    }

    /// Leaves out the points that are not within `reach`, m; tells whether any are. None where one
    /// is just as far, which some rules take to be within reach and others do not.
    pub fn limit(&mut self, reach: f64) -> Option<bool> {
        let points = self.points();
        if points.iter().any(|p| (p.depth + reach).abs() <= 0.0) {
            return None;
        }
        self.points.limit(reach);
        Some(self.be_one_part())
    }
}

/// Two shapes as they lie, seen from a place near one of them, where few digits are lost.
struct Couple<'a> {
    first: Placed<'a>,
    second: Placed<'a>,
    origin: Vec3,
    /// Whether the second one comes first by its rank.
    swapped: bool,
}

impl<'a> Couple<'a> {
    fn new((a, X_WA): (&'a Solid, &Pose), (b, X_WB): (&'a Solid, &Pose)) -> Self {
        let origin = if a.is_terrain() { X_WB.p } else { X_WA.p };
        Self {
            first: Placed::new(a, X_WA, &origin),
            second: Placed::new(b, X_WB, &origin),
            origin,
            swapped: rank(a) > rank(b),
        }
    }

    /// What else stands there.
    fn among<'b>(&self, others: Option<&'b dyn Others>) -> Option<Among<'b>> {
        others.map(|others| Among {
            others,
            origin: self.origin,
            swapped: self.swapped,
        })
    }

    /// Both in the order of their rank.
    fn ranked(&self) -> (&Placed<'a>, &Placed<'a>) {
        if self.swapped {
            (&self.second, &self.first)
        } else {
            (&self.first, &self.second)
        }
    }
}
