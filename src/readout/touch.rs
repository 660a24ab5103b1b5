//! Contact sensors: the forces on a link, or on a part of it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Readout;
use crate::model::{SensorId, SensorKind};
use crate::sensor::frame::pose;
use crate::spatial::Vec3;
use crate::step::point::{Context, Point};
use crate::tuning::SENSED_BORDER;

/// What a contact sensor feels at this moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Touched {
    /// Sum of the normal forces, N.
    pub(super) force: f64,
    /// Where they act, sensor frame, m; 0 where nothing presses.
    pub(super) point: Vec3,
    /// The deepest overlap, m.
    pub(super) depth: f64,
}

impl Readout {
    /// Contacts whose points lie in the sensor's box, or all of its link.
    pub(super) fn touched(&self, ctx: &Context, id: SensorId) -> Touched {
        let Point { kin, terms, .. } = &self.point;
        let sensor = &ctx.model.outputs.sensors[id.index()];
        let SensorKind::Contact { half } = &sensor.kind else {
            return Touched::default();
        };
        let link = sensor.link.index();
        let (_, X) = pose(ctx, &self.point, id.index());
        let R_SW = X.R.transpose();
        let mut touched = Touched::default();
        let mut moment = Vec3::zeros();
        let own = terms.contacts.iter().filter(|c| c.share_of(link) != 0.0);
        for contact in own {
            let load = contact.normal_load(&terms.contacts.points, &kin.V);
            let from = contact.seen_from((ctx.model, ctx.tree), kin, link);
            for point in &terms.contacts.points[contact.points.clone()] {
                let x = R_SW * (point.x + from - X.p);
                let beyond = |half: Vec3| (x.abs() - half * (1.0 + SENSED_BORDER)).max() > 0.0;
                if point.depth <= 0.0 || half.is_some_and(beyond) {
                    continue;
                }
                let force = load * point.load;
                touched.force += force;
                moment += x * force;
                touched.depth = touched.depth.max(point.depth);
            }
        }
        if touched.force > 0.0 {
            touched.point = moment / touched.force;
        }
        touched
    }
}

#[cfg(all(test, feature = "urdf"))]
mod tests;
