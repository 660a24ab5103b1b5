//! Contacts between two named sides: the outputs of [`crate::model::OutputSelection::pairs`].
//!
//! Means are weighted with the normal forces of the contacts between the sides, at this moment.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Readout;
use crate::force::Contact;
use crate::model::PairId;
use crate::spatial::Vec3;
use crate::step::point::{Context, Point};
use crate::tuning::OPPOSED;
use std::ops::{AddAssign, Div, Mul};

impl Readout {
    /// The contacts between the sides of a pair, each with what the first side gets of its force:
    /// 1 or −1.
    fn between(&self, pair: PairId) -> impl Iterator<Item = (&Contact, f64)> + '_ {
        let contacts = self.point.terms.contacts.iter();
        contacts
            .map(move |c| (c, self.named.share(pair.index(), c.links())))
            .filter(|(_, sign)| *sign != 0.0)
    }

    /// Mean of a quantity of each of these contacts and its sign; none where nothing presses.
    fn mean<T>(&self, pair: PairId, of: impl Fn(&Contact, f64) -> T) -> Option<T>
    where
        T: Default + AddAssign + Mul<f64, Output = T> + Div<f64, Output = T>,
    {
        let Point { kin, terms, .. } = &self.point;
        let (mut total, mut sum) = (0.0, T::default());
        for (contact, sign) in self.between(pair) {
            let load = contact.normal_load(&terms.contacts.points, &kin.V);
            if load > 0.0 {
                total += load;
                sum += of(contact, sign) * load;
            }
        }
        (total > 0.0).then(|| sum / total)
    }

    /// Whether the sides press on each other.
    #[inline(never)]
    pub(super) fn pair_presses(&self, pair: PairId) -> bool {
        self.mean(pair, |_, _| 1.0).is_some()
    }

    /// Force on the first side at this moment, N.
    #[inline(never)]
    pub(super) fn pair_force(&self, pair: PairId) -> Vec3 {
        let Point { kin, terms, .. } = &self.point;
        let mut force = Vec3::zeros();
        for (contact, sign) in self.between(pair) {
            force += contact.wrench(&terms.contacts.points, &kin.V).0 * sign;
        }
        force
    }

    /// Where the normal forces act, m, world; the origin of the first link of the first side, or of
    /// the second side where the first one is the ground, where nothing presses.
    #[inline(never)]
    pub(super) fn pair_point(&self, ctx: &Context, pair: PairId) -> Vec3 {
        let kin = &self.point.kin;
        let center = self.mean(pair, |c, _| c.center + kin.origin(ctx.tree, c.body));
        center.unwrap_or_else(|| {
            let sides = &ctx.model.outputs.pairs[pair.index()].sides;
            let link = sides.iter().flatten().flatten().next();
            link.map_or_else(Vec3::zeros, |link| {
                let body = ctx.model.links[link.index()].body.index();
                self.link_pose(ctx, link.index()).p + kin.origin(ctx.tree, body)
            })
        })
    }

    /// Mean direction of the normals from the second side into the first, a unit vector; 0 where
    /// nothing presses, and where they cancel.
    #[inline(never)]
    pub(super) fn pair_normal(&self, pair: PairId) -> Vec3 {
        let mean = self.mean(pair, |c, sign| c.normal * sign);
        let mean = mean.unwrap_or_else(Vec3::zeros);
        let length = mean.norm();
        if length > OPPOSED {
            mean / length
        } else {
            Vec3::zeros()
        }
    }

    /// The deepest overlap of the sides, m; 0 where there is none.
    #[inline(never)]
    pub(super) fn pair_depth(&self, pair: PairId) -> f64 {
        let points = &self.point.terms.contacts.points;
        let of = |c: &Contact| points[c.points.clone()].iter().map(|p| p.depth);
        let depths = self.between(pair).flat_map(|(c, _)| of(c));
        depths.fold(0.0, f64::max)
    }

    /// How fast the sides slide on each other, m/s; 0 where nothing presses.
    #[inline(never)]
    pub(super) fn pair_slip_speed(&self, pair: PairId) -> f64 {
        let V = &self.point.kin.V;
        self.mean(pair, |c, _| c.slip_speed(V)).unwrap_or(0.0)
    }
}
