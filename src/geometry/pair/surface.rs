//! A shape on a triangle mesh.
//!
//! 1. What carries the shape on a plane, see `on_plane` in `meet.rs`, on each triangle that is
//!    below it. Of triangles that lie in one plane only one counts for a point, so that flat ground
//!    is a plane however it is divided. Beyond a concave edge a triangle is continued. A point that
//!    is behind two triangles of which all of the second lies behind the first, as at a crest, is
//!    as deep as behind the nearer one; solids that go through each other need no rule of their
//!    own.
//! 2. Crests: edges where the surface falls away or ends. An edge meets a shape as a capsule
//!    without a radius does, where the direction between them lies between the normals of its two
//!    triangles; outside these directions the triangles carry the shape.
//!
//! A triangle carries a shape whose middle is in front of it, but not with a corner that has not
//! come through the surface on the way from there: the tip of a hull that has passed a wall is not
//! as deep in its near side as the wall is thick, and more, and what hangs over the free rim of a
//! wall is not behind its sides. Nor does it where its plane has come out of the ground again: of
//! rough ground the plane of a triangle in a valley goes on over the next one, and that of a wall
//! of a hole above the floor. A corner that is just above the floor is behind the wall by its
//! distance from the hole.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::{Core, Solid};
use super::deep::least_overlap_along;
use super::deepest::Deepest;
use super::hollow::{Side, part};
use super::meet::Meeting;
use super::nearby::{Nearby, Parts};
use super::nearest::Apart;
use super::own::{OwnPoints, is_far};
use super::placed::{Placed, rank};
use super::points::{PatchPoint, Points};
use super::sink::Sink;
use super::trace::STANDING;
use crate::geometry::Shape;
use crate::geometry::surface::{Crest, Facet, Surface};
use crate::spatial::{Mat3, Vec3, across};
use crate::tuning::{CREST_SLACK, EVEN_EDGE, SEAM};

/// Most points on triangles that are looked at: the deepest ones.
const MOST_FOUND: usize = 64;

/// A point of the shape on a triangle.
#[derive(Clone, Copy, Debug, Default)]
struct OnFacet {
    /// Which point of the shape.
    own: usize,
    /// Index of the triangle.
    facet: usize,
    /// Whether only the middle of the end that it belongs to is over the triangle.
    beside: bool,
    /// Whether it is behind a nearer one.
    hidden: bool,
    point: PatchPoint,
}

/// Memory of a query.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    found: Deepest<Box<[(f64, OnFacet)]>>,
    /// The points of the shape.
    own: OwnPoints,
    /// Those on a crest.
    points: Points,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            found: Deepest::with_room(MOST_FOUND),
            own: OwnPoints::default(),
            points: Points::default(),
        }
    }
}

/// Adds the points of a shape, given in the axes of the mesh.
pub(super) fn on_surface(
    shape: &Placed,
    surface: &Surface,
    (meeting, scratch): (&mut Meeting, &mut Scratch),
    nearby: Option<&mut Nearby>,
    sink: &mut Sink,
) {
    let around = shape.solid.reach + sink.reach;
    let Scratch { found, own, points } = scratch;
    found.clear();
    own.clear();
    // What an end of a capsule has about its middle, which is the corner of its core, m.
    let about = shape.solid.radius - shape.solid.rounding();
    let (reach, radius) = (sink.reach, shape.solid.radius);
    let take = |own: &mut OwnPoints, index, facet: &Facet, part: Parts| {
        for (crest, near) in facet.crests.iter().zip(part.crests) {
            if let (Some(crest), true) = (crest, near) {
                on_crest(shape, surface.crest(*crest), (meeting, points), sink);
            }
        }
        if !part.face {
            return;
        }
        let height = facet.height(&shape.p);
        let beside = facet.is_beside(&shape.p, shape.solid.reach);
        if height <= 0.0 || height > around || beside {
            return;
        }
        own.each_on(shape, facet, sink.reach, |own, point, beside, over| {
            let deep = radius > 0.0 && facet.height(over) < 0.0;
            let within = || surface.is_within(&shape.p, over);
            let passed = || {
                let corner = point.x - facet.normal * (0.5 * point.depth);
                is_passed(surface, facet, &shape.p, (&corner, point.depth))
            };
            if deep && (!within() || !beside && is_off(surface, facet, over, about) || passed()) {
                return;
            }
            let place = OnFacet {
                own,
                facet: index,
                beside,
                hidden: false,
                point,
            };
            found.add(point.depth, place);
        });
    };
    if let Some(nearby) = nearby {
        nearby.each((shape, surface), own, reach, take);
    } else {
        let mut take = take;
        surface.each_near(&shape.p, around, |index, facet| {
            take(own, index, facet, Parts::ALL);
        });
    }
    let found = found.all();
    found.sort_unstable_by(|(_, a), (_, b)| {
        let by_depth = a.point.depth.total_cmp(&b.point.depth);
        a.own.cmp(&b.own).then(by_depth).then(a.facet.cmp(&b.facet))
    });
    let facet = |this: &OnFacet| &surface.facets()[this.facet];
    for i in 0..found.len() {
        let (_, this) = &found[i];
        if this.beside {
            // What stands on a hill of many triangles is lowest, for each of them, beyond it.
            let mut others = found.iter().filter(|(_, other)| other.own == this.own);
            let n = &facet(this).normal;
            let x = this.point.x;
            let around = sink.reach + shape.solid.rounding();
            let alone = others.all(|(_, other)| other.beside)
                && surface.is_any_near(&x, around, |next| {
                    let near = next.height(&x).abs() <= around;
                    near && (next.normal - n).norm() < CREST_SLACK && next.is_below(&x, 0.0)
                });
            if !alone {
                found[i].1.hidden = true;
                continue;
            }
        }
        let hidden = found[..i].iter().any(|(_, nearer)| {
            let same = || {
                let turned = facet(nearer).normal - facet(this).normal;
                this.point.depth - nearer.point.depth <= SEAM && turned.norm() < EVEN_EDGE
            };
            !nearer.hidden
                && nearer.own == this.own
                && (same() || nearer.point.depth > 0.0 && is_behind(facet(nearer), facet(this)))
        });
        found[i].1.hidden = hidden;
    }
    let shown = |this: &&(f64, OnFacet)| !this.1.hidden;
    for list in found.chunk_by(|(_, a), (_, b)| a.own == b.own) {
        let middle = own.middle(list[0].1.own);
        for (i, (_, this)) in list.iter().filter(shown).enumerate() {
            let mut point = this.point;
            if let Some(middle) = &middle {
                let sides = list.iter().filter(shown).map(|(_, this)| Side {
                    normal: facet(this).normal,
                    height: facet(this).height(middle),
                    depth: this.point.depth,
                });
                point.share *= part(i, sides, shape.solid.blend);
            }
            sink.add(&facet(this).normal, point);
        }
    }
}

/// Whether all of a triangle is behind the plane of another one, as beyond a crest. Where solids go
/// through each other their surfaces meet in hollow edges alone, and a triangle of one of them that
/// is behind the other one in part is not hidden by it.
fn is_behind(nearer: &Facet, this: &Facet) -> bool {
    let behind = |corner: &Vec3| nearer.height(corner) <= SEAM;
    nearer.height(&this.middle()) < 0.0 && this.corners.iter().all(behind)
}

/// Whether a corner that is so deep in a triangle has passed a nearer one that lies before all of
/// it, as at a crest, and that the middle of the shape is behind. That pushes nothing, as what
/// hangs over a crest has it, but what is just behind it is not as deep in what is beyond the
/// crest.
fn is_passed(
    surface: &Surface,
    facet: &Facet,
    middle: &Vec3,
    (corner, depth): (&Vec3, f64),
) -> bool {
    surface.is_any_near(corner, depth, |near| {
        let height = near.height(corner);
        let nearer = height <= 0.0 && -height < depth;
        nearer && near.height(middle) <= 0.0 && near.is_over(corner) && is_behind(near, facet)
    })
}

/// Whether the place on the plane of a triangle of the corner of a core is in front of the surface,
/// by more than `about`, m: beyond a hollow edge the plane goes on in what rises there, but not
/// where lower ground begins behind that, nor above the ground in which a wall of a hole ends. The
/// nearest triangle tells; where its nearest place is on an edge, the one of both triangles that
/// faces the place most.
fn is_off(surface: &Surface, facet: &Facet, over: &Vec3, about: f64) -> bool {
    let place = over - facet.normal * facet.height(over);
    let mut nearest = (f64::INFINITY, 0.0_f64);
    surface.is_any_near(&place, facet.apart(&place).norm(), |facet| {
        let apart = facet.apart(&place);
        let (distance, front) = (apart.norm(), facet.normal.dot(&apart));
        let nearer = distance < nearest.0 - SEAM;
        if nearer || distance <= nearest.0 + SEAM && front.abs() > nearest.1.abs() + SEAM {
            nearest = (distance, front);
        }
        false
    });
    nearest.1 > about + SEAM
}

/// Adds the points of a shape on an edge.
fn on_crest(
    shape: &Placed,
    crest: &Crest,
    (meeting, points): (&mut Meeting, &mut Points),
    sink: &mut Sink,
) {
    let Crest {
        middle,
        half_length: length,
        along,
        ..
    } = *crest;
    if is_far(shape, crest, &crest.apart(&shape.p), sink.reach) {
        return;
    }
    let edge = Solid::new(
        &Shape::Capsule {
            radius: 0.0,
            half_length: length,
        },
        0.0,
    );
    let side = across(&along);
    let R = Mat3::from_columns(&[side, along.cross(&side), along]);
    let placed = Placed {
        solid: &edge,
        core: &edge.core,
        R,
        p: middle,
    };
    points.clear();
    let swapped = rank(shape.solid) > rank(&edge);
    let pair = if swapped {
        (&placed, shape)
    } else {
        (shape, &placed)
    };
    let outwards = |normal: &Vec3| if swapped { -normal } else { *normal };
    // Points are found only where the crest has a part.
    let acts =
        |normal: &Vec3| part_between(&outwards(normal), &crest.sides, (shape, &middle)) > 0.0;
    let along = |apart: &Apart| {
        if acts(&apart.normal) {
            return Some(apart.normal);
        }
        // Deep in a shape the edge overlaps least with it towards any side of the shape, into the
        // ground, too. It pushes along its own directions. Behind a free rim there is no ground.
        let inwards = crest.sides.map(|n| outwards(&n));
        let deep = apart.part < 1.0 && !crest.is_free;
        deep.then(|| least_overlap_along(pair, inwards, acts))
            .flatten()
    };
    let (normal, ..) = meeting.find_along((pair, None), [sink.reach; 2], along, points);
    if points.list().is_empty() {
        return;
    }
    let n = outwards(&normal);
    let share = part_between(&n, &crest.sides, (shape, &middle));
    for found in points.list() {
        let place = found.x - crest.apart(&found.x);
        if sink.goes_on(&place, &crest.sides) {
            continue;
        }
        let mut rim = found.rim;
        if let (true, Some(rim)) = (swapped, &mut rim) {
            rim.side = rim.side.other();
        }
        let share = found.share * share;
        sink.add(
            &n,
            PatchPoint {
                share,
                rim,
                ..*found
            },
        );
    }
}

/// How much of a direction is between the sides of a crest: 1 there, 0 beyond. What is round has
/// left the crest where the surface begins, but for a capsule or a cylinder that lies across it.
pub(super) fn part_between(n: &Vec3, [a, b]: &[Vec3; 2], (shape, middle): (&Placed, &Vec3)) -> f64 {
    // Along the edge, so that turning from one side to the other is positive.
    let axis = a.cross(b);
    let length = axis.norm();
    if length <= 0.0 {
        return 0.0;
    }
    let beyond = [a.cross(n).dot(&axis), n.cross(b).dot(&axis)].map(|x| -x / length);
    let excess = beyond[0].max(beyond[1]);
    if n.dot(&(a + b)) <= 0.0 {
        return 0.0;
    }
    let leaves = match (shape.core, &shape.solid.round) {
        (Core::Point, _) => true,
        (_, Some(round)) => {
            let stands = round.flat && n.dot(&shape.axis()).abs() > STANDING;
            !stands && !lies_across(shape, round.half, (middle, &(axis / length)))
        }
        _ => false,
    };
    if leaves {
        return f64::from(u8::from(excess < 0.0));
    }
    (1.0 - excess.max(0.0) / CREST_SLACK).max(0.0)
}

/// Whether the axis of a capsule or a cylinder comes nearest to an edge, given by one of its places
/// and its direction, between its ends. The surface then carries its ends, and only the edge what
/// is between them.
fn lies_across(shape: &Placed, half: f64, (middle, along): (&Vec3, &Vec3)) -> bool {
    let (axis, from) = (shape.axis(), shape.p - middle);
    let facing = axis.dot(along);
    // Of the nearest place of two lines, times the squared sine of the angle between them.
    let place = facing * along.dot(&from) - axis.dot(&from);
    place.abs() < half * (1.0 - facing * facing)
}
