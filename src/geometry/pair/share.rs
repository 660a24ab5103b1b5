//! Which part of a face each of several level faces carries that it lies on.
//!
//! A plate that lies on two belts, or on many tiles, has a contact with each. Each of these has a
//! spring of its own, which is made for the weight of the plate: with one spring for each part the
//! plate would be carried by as many springs as there are parts, all alike, whatever of it lies on
//! which. Where 5 % of a plate had come to the second of two belts this carried 41 % of it, and
//! pulled it along with that.
//!
//! So a spring has only the share of its part, `s = A/(A + Σ A_j)`: the area `A` of the face that
//! lies over what carries it, and the areas `A_j` over what is level with that. Together they are
//! one spring again, and where all parts are equally deep each carries the weight on its area. The
//! energy does not depend on the shares then, so that nothing jumps where a part begins or ends.
//!
//! 1. Only what is nearer than the level counts of the face (see [`super::polygon`]): the corner of
//!    a plate that comes down on one tile lies on that alone.
//! 2. Faces share as far as both look along the normal. With the sines `σ` of their tilts the share
//!    is `1 − c (1 − s)`, `c = ((1 − σ_f²) (1 − σ_g²))²`: what meets with edges shares nothing.
//! 3. What carries does not yield. Bodies that lie side by side on a free one are no parts of one
//!    thing, and those under it each have their own weight.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::placed::Placed;
use super::polygon::Polygons;
use super::shut::Among;
use super::view::{Frame, Seen};
use crate::spatial::Vec3;

/// Share of the spring of a contact between `free`, which yields, and `on`, which does not: 0 … 1.
///
/// - `n`: unit vector from `on` to `free`
/// - `level`: gap up to which places of the face count, m
/// - `others`: what else stands there
pub(super) fn share(
    [free, on]: [&Placed; 2],
    n: &Vec3,
    level: f64,
    others: &Among,
    ([upper, lower], work): ([&mut Seen; 2], &mut Polygons),
) -> f64 {
    if !others.carry_near((&free.p, free.solid.reach)) {
        return 1.0;
    }
    let frame = Frame::new(*n);
    upper.look(free, &frame);
    lower.look(on, &frame);
    upper.face(free, &frame, -1.0, lower.heights.1 + level);
    lower.face(on, &frame, 1.0, upper.heights.0 - level);
    let (Some(f), Some(g)) = (upper.fronts().first(), lower.fronts().first()) else {
        return 1.0;
    };
    let Polygons { one, two, third } = work;
    one.take(upper.outline(&free.solid.mesh, f.index).rev());
    third.cut(one, |x| level - (x.z - g.height(x)));
    let near = &*third;
    let outline = lower.outline(&on.solid.mesh, g.index);
    let own = near.area_within(outline.clone(), [&mut *one, &mut *two]);
    let place = frame.world(&outline.clone().next().unwrap_or_default());
    let face = (&place, &g.normal(&frame));
    let mut beside = 0.0;
    others.each_level(face, (&free.p, free.solid.reach), &mut |solid, index, X| {
        let corners = solid.mesh.face(index).iter();
        let outline = corners.map(|&i| frame.see(&X.point(&solid.mesh.corners[i])));
        beside += near.area_within(outline, [&mut *one, &mut *two]);
    });
    if beside <= 0.0 {
        return 1.0;
    }
    let faces = (1.0 - f.tilt) * (1.0 - g.tilt);
    1.0 - faces * faces * (beside / (own + beside))
}
