//! Solids that stand still with faces against each other, as the plates of a floor do.
//!
//! A plate has walls and edges where the next one begins, and nothing can come between the two.
//! With the rounded edge of each plate what slides over them would run against every edge: it lies
//! half a penetration deep, and comes upon an edge at up to 13°. So a direction out of a solid
//! never leans towards a wall that another one covers there: what the direction has along the
//! normal of that wall is left out. Between two level plates, the normal is that of both.
//!
//! The same holds for a plate whose top is level with the ground. And where two things have faces
//! that are level, with a gap between both, what lies flat on them with a part of a face or of the
//! flat end of a cylinder comes against the face of the one or of the other, and against nothing
//! else of them. What rolls comes down into a gap, and meets its edge.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::Solid;
use super::lowest::{places, skin};
use super::nearest::Apart;
use super::placed::{Face, Placed, separation};
use super::points::{Points, point};
use super::shut::{Among, On};
use crate::spatial::Vec3;
use crate::tuning::{EVEN_EDGE, LEAN, SEAM, STRAIGHT};

impl Solid {
    /// The part of a segment, from 0 to 1, that lies on one of its faces, with about that normal.
    pub fn carried(&self, [a, b]: [Vec3; 2], normal: &Vec3) -> Option<[f64; 2]> {
        if !self.is_polyhedron() {
            return None;
        }
        let on = |(n, height): &Face| {
            let is_on = |x: &Vec3| (n.dot(x) - height).abs() <= SEAM;
            (n - normal).norm() < EVEN_EDGE && is_on(&a) && is_on(&b)
        };
        let level = self.faces().position(|face| on(&face))?;
        let mut part = [0.0_f64, 1.0_f64];
        for (_, (n, height)) in self.faces().enumerate().filter(|(i, _)| *i != level) {
            let [from, to] = [a, b].map(|x| height - n.dot(&x));
            let crossed = from / (from - to);
            match (from < 0.0, to < 0.0) {
                (true, true) => return None,
                (true, false) => part[0] = part[0].max(crossed),
                (false, true) => part[1] = part[1].min(crossed),
                (false, false) => {}
            }
        }
        (part[0] < part[1]).then_some(part)
    }
}

/// A direction out of a solid that does not lean towards its covered walls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// The solid out of which it points: the first or the second.
    pub(super) first: bool,
    /// Unit vector out of the solid.
    pub(super) outward: Vec3,
    /// Between both cores along it, m: of the other one what is over the solid.
    pub(super) distance: f64,
    /// How high along it that is which is nearest to the solid, m.
    least: f64,
    /// The face of the solid on which the other one lies flat, if it lies on something beside it.
    flat: Option<Face>,
    /// See [`On::rise`], of what the direction leaves out.
    rise: f64,
}

/// The direction out of `p` towards `o`, about the place `x`, in place of `n`; none where it stays.
///
/// A direction out of a corner is a sum of the normals of its faces, none of them negative: what it
/// has of those of covered walls is left out. Beside an open face it leaves out what leads along
/// that over the edge to the wall, which at the toe of a wedge on the ground is nearly all.
/// (`what_slides_onto_a_wedge_climbs_it`)
fn kept(on: &On, n: &Vec3, x: &Vec3) -> Option<(Vec3, Option<Face>)> {
    let p = on.p;
    if on.is_alone() || !p.solid.has_faces() {
        return None;
    }
    let mut d = p.R.tr_mul(n);
    let faces = p.solid.leads(&d);
    let there = || faces.iter().copied().flatten();
    let is_face = faces[1].is_none();
    if is_face && there().all(|face| on.is_flat_on(face)) {
        return None;
    }
    let x = within(p.solid, &p.R.tr_mul(&(x - p.p)));
    let x = edge(&x, there());
    if let Some(face) = on.flat(&x, &d) {
        return Some((p.R * face.0, Some(face)));
    }
    // The normal of a face leans to no wall, and that of a wall stays.
    if is_face {
        return None;
    }
    let within = on.within(&x, faces);
    let is_closed = |face: &Face, d: &Vec3| on.is_closed(*face, (&x, &within), d);
    // Two walls at a corner need not be at right angles: what leads over the second one is taken
    // across the first, and the first is looked at once more.
    let mut gone: Option<Vec3> = None;
    for face in there().chain(there()) {
        if !is_closed(&face, &d) {
            continue;
        }
        let open = there().filter(|open| open.0.dot(&d) > LEAN && !is_closed(open, &d));
        let over = way_over(open, &face.0, &d);
        let over = match gone {
            Some(gone) => (over - gone * gone.dot(&over)).try_normalize(LEAN),
            None => Some(over),
        };
        let lean = over.map_or(0.0, |over| over.dot(&d));
        if lean > LEAN {
            d -= over.unwrap_or_default() * lean;
            gone = over;
        }
    }
    // What points straight into a wall is deep in both solids, or in the corner between them.
    let d = d.try_normalize(STRAIGHT)?;
    gone.map(|_| (p.R * d, None))
}

/// The way along one of some open faces over its edge to a wall with the normal `n`: of the face
/// that has, together with the wall, most of the direction `d`. The normal where there is none.
fn way_over(open: impl Iterator<Item = Face>, n: &Vec3, d: &Vec3) -> Vec3 {
    let mut best = (0.0, *n);
    for (up, _) in open {
        let Some(over) = (n - up * up.dot(n)).try_normalize(LEAN) else {
            continue;
        };
        let [along, across] = [up.dot(d), over.dot(d)];
        let has = along * along + across * across;
        if has > best.0 {
            best = (has, over);
        }
    }
    best.1
}

/// The place of a solid that is nearest to `x`, for faces at right angles.
fn within(solid: &Solid, x: &Vec3) -> Vec3 {
    let mut x = *x;
    for (n, height) in solid.walls(&x) {
        x -= n * (n.dot(&x) - height).max(0.0);
    }
    x
}

/// The place of a solid that is nearest to `x`, moved to the edge of some of its faces: what stands
/// beside a wall may leave a gap below that edge, into which nothing can come from above.
///
/// Each face is met across those before it, along which these are not left.
fn edge(x: &Vec3, faces: impl Iterator<Item = Face>) -> Vec3 {
    let (mut x, mut met) = (*x, [Vec3::zeros(); 2]);
    for (i, (n, height)) in faces.enumerate() {
        let across = met.iter().fold(n, |n, met| n - met * met.dot(&n));
        let Some(way) = across.try_normalize(LEAN) else {
            continue;
        };
        x += way * ((height - n.dot(&x)) / way.dot(&n));
        if let Some(met) = met.get_mut(i) {
            *met = way;
        }
    }
    x
}

/// The direction between two solids, from `b` to `a`, where one of them has covered walls to which
/// `n` leans.
///
/// Along it they are no deeper than before by more than the rounding of that solid, which is what
/// its edge takes away. Beside the edge of a table whose top a mat covers there would be a wall
/// left to point to, and what lies on the mat would be half its width deep in that.
///
/// - `apart`: how they are along `n`
/// - `others`: what stands beside them
pub(super) fn between(
    (a, b): (&Placed, &Placed),
    n: &Vec3,
    apart: &Apart,
    others: Option<&Among>,
) -> Option<Kept> {
    let radii = a.solid.radius + b.solid.radius;
    let of = |on: &On, n: &Vec3, first| {
        let (p, o) = (on.p, on.o);
        let (outward, flat) = kept(on, n, &apart.middle)?;
        let rise = on.rise();
        // Both cores are as far apart as the shapes and what has been taken off them.
        let top = outward.dot(&p.support(&outward)) - (o.solid.radius - skin(o));
        // What of the other one is beyond a covered wall lies on what is there, and may be lower.
        let mut least = lowest_over(on, (&outward, flat));
        if least.is_infinite() {
            least = top + separation(o, p, &outward);
        }
        let distance = least - top;
        (distance >= apart.distance.min(radii) - p.solid.radius).then_some(Kept {
            first,
            outward,
            distance,
            least,
            flat,
            rise,
        })
    };
    let [below, above] =
        [((b, a), false), ((a, b), true)].map(|(pair, first)| On::new(pair, first, others));
    let kept = of(&below, n, false);
    if kept.is_some_and(|kept| kept.rise == f64::NEG_INFINITY) {
        return kept;
    }
    // Where what lies on two things level with each other is level with one of them, too, both
    // ways are open. It presses on what carries it.
    let other = of(&above, &-n, true);
    match (kept, other) {
        (Some(kept), other) if other.is_none_or(|other| other.rise >= kept.rise) => Some(kept),
        (_, other) => other,
    }
}

/// How high along `up` the lowest place of the other one is that is over the solid, m; infinite
/// where none is. To see whether one is takes a look at all that stands near, and most often the
/// lowest one is: so they are asked from the lowest one on.
///
/// - `flat`: see [`Kept`]
pub(super) fn lowest_over(on: &On, (up, flat): (&Vec3, Option<Face>)) -> f64 {
    let mut last = (f64::NEG_INFINITY, usize::MAX);
    loop {
        let mut next = (f64::INFINITY, usize::MAX, Vec3::zeros());
        for (i, x) in places(on.o, up).enumerate() {
            let height = up.dot(&x);
            let follows = height > last.0 || height >= last.0 && i > last.1;
            if follows && height < next.0 {
                next = (height, i, x);
            }
        }
        let (height, i, x) = next;
        if i == usize::MAX || is_over(on, (up, flat), &x) {
            return height;
        }
        last = (height, i);
    }
}

/// Whether a place is on the solid's own side of all its walls that are covered along `up`, or of
/// all walls about the face on which the other one lies.
pub(super) fn is_over(on: &On, (up, flat): (&Vec3, Option<Face>), x: &Vec3) -> bool {
    let p = on.p;
    let (x, up) = (p.R.tr_mul(&(x - p.p)), p.R.tr_mul(up));
    let is_beyond = |face: &Face| face.0.dot(&x) > face.1;
    let walls = || p.solid.walls(&x).filter(is_beyond);
    if flat.is_some() {
        return walls().all(|face| Some(face) == flat);
    }
    if walls().next().is_none() {
        return true;
    }
    let place = within(p.solid, &x);
    let within = on.within(&place, p.solid.leads(&up));
    !walls().any(|face| on.is_closed(face, (&place, &within), &up))
}

/// Adds the lowest points of what lies on a solid with covered walls, as far as they are over it:
/// they lose their shares as they rise by `blend` above the lowest one.
///
/// - `gap`, `left`: of the lowest one, m; the share of all together
/// - `others`: what stands beside both
pub(super) fn lowest(
    ((a, b), others): ((&Placed, &Placed), Option<&Among>),
    kept: &Kept,
    (gap, left): (f64, f64),
    blend: f64,
    points: &mut Points,
) {
    let (on, p) = if kept.first { (b, a) } else { (a, b) };
    let under = On::new((p, on), kept.first, others);
    let up = kept.outward;
    let rise = |x: &Vec3| up.dot(x) - kept.least;
    let weight = |x: &Vec3| (1.0 - rise(x) / blend).clamp(0.0, 1.0);
    let total: f64 = places(on, &up).map(|x| weight(&x)).sum();
    for x in places(on, &up) {
        let (share, gap) = (left * weight(&x) / total, gap + rise(&x));
        if share > 0.0 && is_over(&under, (&up, kept.flat), &x) {
            let middle = x - up * (skin(on) + 0.5 * gap);
            points.add(0, point(middle, -gap, share));
        }
    }
}
