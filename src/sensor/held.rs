//! What springs and closed loops do to links: a force sensor carries it as it carries contacts.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::frame::link_pose;
use crate::closure::Places;
use crate::model::Anchor;
use crate::spatial::Vec3;
use crate::step::point::{Context, Point};

/// A force on a link.
#[derive(Clone, Copy, Debug)]
pub struct Hold {
    /// Where it acts, from O of the link's tree, m.
    pub x: Vec3,
    /// N
    pub force: Vec3,
    /// N·m
    pub torque: Vec3,
}

/// What springs and loops do to links that are `beyond`. What joins two of these is left out: it
/// does nothing to both of them together.
///
/// - `forces`: those of all rows of closed loops
pub fn holds<'a>(
    ctx: &'a Context,
    point: &'a Point,
    forces: &'a [f64],
    beyond: &'a impl Fn(usize) -> bool,
) -> impl Iterator<Item = Hold> + 'a {
    let Point { kin, terms, .. } = point;
    let on = |ends: &'a [Anchor; 2], force: Vec3, torque: Vec3, back: Vec3| {
        let [first, second] = ends.each_ref().map(|end| {
            let link = end.link?.index();
            beyond(link).then(|| link_pose(ctx, point, link).point(&end.X_LA.p))
        });
        match (first, second) {
            (Some(x), None) => Some(Hold {
                x: x + back,
                force,
                torque,
            }),
            (None, Some(x)) => Some(Hold {
                x: x - back,
                force: -force,
                torque: -torque,
            }),
            _ => None,
        }
    };
    let springs = terms.springs.iter().filter_map(move |spring| {
        let of = &ctx.tree.springs[spring.index];
        let pull = spring.force(&spring.relative(&kin.V));
        let force = if of.reversed { -pull } else { pull };
        on(
            &ctx.model.springs[of.index].ends,
            force,
            Vec3::zeros(),
            Vec3::zeros(),
        )
    });
    let places = Places {
        origins: &kin.origins,
        X: &kin.X,
        S: &kin.S,
    };
    let loops = ctx.model.loops.iter().enumerate();
    springs.chain(loops.filter_map(move |(index, closure)| {
        let ends = closure.kind.ends()?;
        let [force, torque, back] = kin.loops.wrench(ctx.tree, places, index, forces);
        on(ends, force, torque, back)
    }))
}
