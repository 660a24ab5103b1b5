//! Robots and objects that are to stand on terrain.
//!
//! Each shape asks each piece of terrain by how much it must be lifted to touch it, and the
//! greatest lift of all is that of the base.
//!
//! - What is below a plane or below heights is solid: they are touched up to one lift, and no
//!   higher.
//! - A mesh is its triangles. Each of them is touched between two lifts, see [`Lifted`], however
//!   thin the shape is; those with their outside up carry.
//! - Where the ground carries, too, only what begins inside is lifted: through all that it touches
//!   and triangles that it is behind, until nothing is above it or what is above faces down.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::initial::{Poses, poses};
use crate::geometry::Shape;
use crate::geometry::field::Field;
use crate::geometry::pair::{Lifted, Patch};
use crate::geometry::surface::Surface;
use crate::model::{LinkId, Model};
use crate::spatial::{Pose, Vec3};
use crate::tree::TreeCollider;

/// Halvings by which the height is found where something stands: to round-off.
const HALVINGS: usize = 60;

/// Parts of the way down to heights at most.
const MOST_PARTS: f64 = 20_000.0;

/// Whether a model has terrain.
pub(super) fn has_terrain(model: &Model) -> bool {
    model.colliders.iter().any(|c| c.shape.is_terrain())
}

/// Between which lifts of the base a shape touches a piece of terrain.
struct Touch {
    /// The least and the greatest lift, m.
    lifts: [f64; 2],
    /// Whether it carries what comes from above.
    carries: bool,
    /// Indices of the link and of that of the terrain.
    links: [usize; 2],
}

/// Sets the base of a tree to where the first of its shapes touches terrain, if there is any below;
/// `above`: only where it begins inside. Gives the link that touches and the name of the terrain.
pub(super) fn set_down(model: &mut Model, tree: usize, above: bool) -> Option<(LinkId, String)> {
    let poses = poses(model);
    let touches = touches(model, &poses, tree, above);
    let found = if above {
        above_all(touches)
    } else {
        let carrying = touches.into_iter().filter(|t| t.carries);
        carrying.max_by(|a, b| a.lifts[1].total_cmp(&b.lifts[1]))
    }?;
    let [link, ground] = found.links;
    model.roots[tree].position.z += found.lifts[1];
    Some((LinkId::from(link), model.links[ground].name.clone()))
}

/// The last of what the base at its present height is inside of, on the way up.
fn above_all(mut touches: Vec<Touch>) -> Option<Touch> {
    touches.sort_by(|a, b| a.lifts[0].total_cmp(&b.lifts[0]));
    let mut last: Option<Touch> = None;
    for touch in touches {
        let lift = last.as_ref().map_or(0.0, |last| last.lifts[1]);
        if touch.lifts[1] <= lift {
            continue;
        }
        if touch.lifts[0] > lift && !touch.carries {
            break;
        }
        last = Some(touch);
    }
    last
}

/// All that a tree touches at some height. Unless all is asked for, what can only be lower than
/// something else is left out.
fn touches(model: &Model, poses: &Poses, tree: usize, all: bool) -> Vec<Touch> {
    let colliders = &poses.tree.contact.colliders;
    let shape = |c: &TreeCollider| &model.colliders[c.index].shape;
    let reach =
        |c: &TreeCollider| model.colliders[c.index].X_BG.p.norm() + shape(c).bounding_radius();
    let bounded = colliders.iter().filter(|c| *shape(c) != Shape::Plane);
    let size = bounded.map(reach).fold(0.0, f64::max);
    let far = 1e3 + 10.0 * size;
    let mut list: Vec<Touch> = Vec::new();
    let own = colliders
        .iter()
        .filter(|c| c.tree == tree && !shape(c).is_terrain());
    for a in own {
        for b in colliders.iter().filter(|c| shape(c).is_terrain()) {
            let X = poses.pair([a, b]);
            let mut add = |lifts: [f64; 2], carries: bool| {
                if lifts[1].abs() <= far {
                    list.push(Touch {
                        lifts,
                        carries,
                        links: [a.link, b.link],
                    });
                }
            };
            match shape(b) {
                Shape::Surface { surface } => {
                    let Some(lifted) = Lifted::new(shape(a), &X[0]) else {
                        continue;
                    };
                    on_surface(&lifted, (surface, &X[1]), all, add);
                }
                Shape::Field { field } => {
                    if let Some(lift) = on_field([a, b], &X, (shape(a), field)) {
                        add([-far, lift], true);
                    }
                }
                _ => {
                    let n: Vec3 = X[1].R.column(2).into();
                    let gap = shape(a).lowest(&X[0], &n) - n.dot(&X[1].p);
                    // What hangs over is no ground.
                    if n.z > 0.0 {
                        add([-far, -gap / n.z], true);
                    }
                }
            }
        }
    }
    list
}

/// Tells between which lifts a shape touches the triangles of a mesh, and which of them carry.
/// Unless `all` is asked for, those that do not carry, or are lower than others, are left out.
fn on_surface(
    shape: &Lifted,
    (surface, X): (&Surface, &Pose),
    all: bool,
    mut add: impl FnMut([f64; 2], bool),
) {
    let mut highest = f64::NEG_INFINITY;
    for facet in surface.facets() {
        let carries = (X.R * facet.normal).z > 0.0;
        if !carries && !all {
            continue;
        }
        let corners = facet.corners.map(|corner| X.point(&corner));
        if let Some(lifts) = shape.touching(&corners, highest) {
            add(lifts, carries);
            if !all {
                highest = highest.max(lifts[1]);
            }
        }
    }
}

/// The greatest lift with which a shape touches heights: down from above them by parts of its own
/// size, which are less than how deep they are, and then by halves.
fn on_field(
    [a, b]: [&TreeCollider; 2],
    X: &[Pose; 2],
    (shape, field): (&Shape, &Field),
) -> Option<f64> {
    let (Some(first), Some(second)) = (&a.solid, &b.solid) else {
        return None;
    };
    let mut patch = Patch::new();
    let mut touches = |lift: f64| {
        let mut lifted = X[0];
        lifted.p.z += lift;
        patch.find((first, &lifted), (second, &X[1]), 0.0);
        patch.points().iter().any(|point| point.depth > 0.0)
    };
    let [bottom, top] = extent(field, &X[1]);
    let [lowest, highest] = Lifted::new(shape, &X[0])?.heights();
    let [end, mut high] = [bottom - highest, top - lowest];
    let part = (0.25 * shape.bounding_radius()).max((high - end) / MOST_PARTS);
    let mut low = high;
    while !touches(low) {
        if low < end {
            return None;
        }
        (high, low) = (low, low - part);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if touches(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}

/// Between which heights a surface of heights lies, m.
fn extent(field: &Field, X: &Pose) -> [f64; 2] {
    let [x, y] = field.samples().size.map(|size| 0.5 * size);
    let up: Vec3 = X.R.row(2).transpose();
    let level = x * up.x.abs() + y * up.y.abs();
    let ends = [field.bottom() * up.z, field.top() * up.z];
    let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
    [X.p.z + low - level, X.p.z + high + level]
}
