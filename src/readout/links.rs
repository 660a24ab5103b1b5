//! Frames of links, and what touches links at this moment.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Readout;
use crate::model::LinkId;
use crate::slots::Axis;
use crate::spatial::{Pose, Vec3, velocity_at};
use crate::step::point::{Context, Point};

impl Readout {
    /// Pose of a link's frame: axes in the world, position from O.
    pub(super) fn link_pose(&self, ctx: &Context, link: usize) -> Pose {
        let body = ctx.model.links[link].body.index();
        self.point.kin.X[body].compose(&ctx.tree.link_pose[link])
    }

    /// Origin of a link's frame in the world, m.
    #[inline(never)]
    pub(super) fn link_position(&self, ctx: &Context, link: LinkId) -> Vec3 {
        let body = ctx.model.links[link.index()].body.index();
        self.link_pose(ctx, link.index()).p + self.point.kin.origin(ctx.tree, body)
    }

    /// Velocity of the origin of a link's frame, m/s, world axes.
    #[inline(never)]
    pub(super) fn link_velocity(&self, ctx: &Context, link: LinkId) -> Vec3 {
        let body = ctx.model.links[link.index()].body.index();
        let p = self.link_pose(ctx, link.index()).p;
        velocity_at(&self.point.kin.V[body], &p)
    }

    /// Whether anything presses on a link.
    #[inline(never)]
    pub(super) fn touches(&self, ctx: &Context, link: LinkId) -> bool {
        self.normal_loads(ctx, link).any(|(load, _)| load > 0.0)
    }

    /// Force of the contacts on a link at this moment along an axis of the world, N.
    #[inline(never)]
    pub(super) fn contact_force(&self, link: LinkId, axis: Axis) -> f64 {
        let Point { kin, terms, .. } = &self.point;
        let contacts = &terms.contacts;
        contacts
            .iter()
            .map(|c| (c, c.share_of(link.index())))
            .filter(|(_, share)| *share != 0.0)
            .map(|(c, share)| share * c.wrench(&contacts.points, &kin.V).0[axis as usize])
            .sum()
    }

    /// Normal force, N, and centre of the load, from O, of each contact of a link at this moment.
    fn normal_loads(&self, ctx: &Context, link: LinkId) -> impl Iterator<Item = (f64, Vec3)> {
        let Point { kin, terms, .. } = &self.point;
        let contacts = &terms.contacts;
        let own = contacts
            .iter()
            .filter(move |c| c.share_of(link.index()) != 0.0);
        own.map(move |c| {
            let center = c.center + c.seen_from((ctx.model, ctx.tree), kin, link.index());
            (c.normal_load(&contacts.points, &kin.V), center)
        })
    }

    /// Centre of pressure of a link in the world, m: the mean of its loads' centres, weighted with
    /// their normal forces; the link's origin where nothing presses.
    #[inline(never)]
    pub(super) fn contact_point(&self, ctx: &Context, link: LinkId) -> Vec3 {
        let (mut load, mut moment) = (0.0, Vec3::zeros());
        for (force, center) in self.normal_loads(ctx, link) {
            load += force;
            moment += center * force;
        }
        if load > 0.0 {
            let body = ctx.model.links[link.index()].body.index();
            moment / load + self.point.kin.origin(ctx.tree, body)
        } else {
            self.link_position(ctx, link)
        }
    }
}
