//! Loops on models built in code.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::Kinematics;
use crate::model::{Anchor, LinkId, Loop, LoopKind, Model};
use crate::parameters::Parameters;
use crate::spatial::Pose;
use crate::testing::Builder;
use crate::tree::Tree;

/// A frame on a link, or in the world.
pub fn anchor(link: Option<LinkId>, X: Pose) -> Anchor {
    Anchor { link, X_LA: X }
}

/// Adds a loop.
pub fn add(model: &mut Model, kind: LoopKind) {
    let name = format!("loop{}", model.loops.len());
    model.loops.push(Loop {
        name,
        kind,
        shown: true,
    });
}

/// Poses of two ends that are one frame at the positions `q`: that of the first is given.
pub fn ends_at(model: &Model, q: &[f64], [a, b]: [Option<LinkId>; 2], X: Pose) -> [Anchor; 2] {
    let tree = Tree::new(model, &Parameters::new(model));
    let mut kin = Kinematics::new(&tree);
    kin.update_poses(&tree, q);
    let pose = |link: Option<LinkId>| {
        let Some(link) = link else {
            return Pose::IDENTITY;
        };
        let body = model.links[link.index()].body.index();
        let mut X = kin.X[body].compose(&tree.link_pose[link.index()]);
        X.p += kin.origins[tree.bodies[body].tree];
        X
    };
    let other = pose(b).inverse().compose(&pose(a)).compose(&X);
    [anchor(a, X), anchor(b, other)]
}

impl Builder {
    /// Adds a loop.
    pub fn close(&mut self, kind: LoopKind) {
        add(&mut self.model, kind);
    }
}
