//! Where a sensor is.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::spatial::Pose;
use crate::step::point::{Context, Point};

/// Pose of the sensor's frame: axes in the world, position from O. Needs poses.
pub fn pose(ctx: &Context, point: &Point, sensor: usize) -> (usize, Pose) {
    let sensor = &ctx.model.outputs.sensors[sensor];
    let body = ctx.model.links[sensor.link.index()].body.index();
    let X = link_pose(ctx, point, sensor.link.index()).compose(&sensor.X_LS);
    (body, X)
}

/// Pose of a link: axes in the world, position from O. Needs poses.
pub fn link_pose(ctx: &Context, point: &Point, link: usize) -> Pose {
    let body = ctx.model.links[link].body.index();
    point.kin.X[body].compose(&ctx.tree.link_pose[link])
}
