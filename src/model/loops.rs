//! Closed kinematic loops, and springs between two points.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::id::{JointId, LinkId};
use crate::spatial::Pose;
use serde::{Deserialize, Serialize};

/// What closes a loop: an exact constraint beside the joints of the trees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Loop {
    /// In messages and in the names of its outputs.
    pub name: String,
    /// What it holds.
    pub kind: LoopKind,
    /// Whether it has `loop.*` outputs.
    #[serde(default)]
    pub shown: bool,
}

/// What a loop holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum LoopKind {
    /// Two frames, as one.
    Weld([Anchor; 2]),
    /// The origins of two frames.
    Ball([Anchor; 2]),
    /// Two origins and two z axes: what is left is turning about z.
    Hinge([Anchor; 2]),
    /// The distance of two origins.
    Distance {
        /// The frames.
        ends: [Anchor; 2],
        /// m, above zero.
        length: f64,
    },
    /// A sum of positions of joints.
    Coupler {
        /// Which, and how often; at least one.
        terms: Vec<Share>,
        /// What the sum is, rad or m; none: what it is at the start, as gears mesh.
        sum: Option<f64>,
    },
}

/// A frame on a link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Anchor {
    /// None: the world.
    pub link: Option<LinkId>,
    /// Pose in the link, or in the world.
    pub X_LA: Pose,
}

/// A joint in a sum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Share {
    /// A turning or sliding joint.
    pub joint: JointId,
    /// What its position is multiplied by; not zero.
    pub factor: f64,
}

/// A spring and a damper between the origins of two frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// In messages and in the names of its outputs.
    pub name: String,
    /// Where it hangs.
    pub ends: [Anchor; 2],
    /// Length without force, m, not negative.
    pub length: f64,
    /// N/m, not negative.
    pub stiffness: f64,
    /// N·s/m along the line between the ends, not negative.
    pub damping: f64,
    /// Whether it has `spring.*` outputs.
    #[serde(default)]
    pub shown: bool,
}

impl LoopKind {
    /// The frames that it joins; none of a coupler.
    pub fn ends(&self) -> Option<&[Anchor; 2]> {
        match self {
            Self::Weld(ends)
            | Self::Ball(ends)
            | Self::Hinge(ends)
            | Self::Distance { ends, .. } => Some(ends),
            Self::Coupler { .. } => None,
        }
    }

    /// The same, to be changed.
    pub fn ends_mut(&mut self) -> Option<&mut [Anchor; 2]> {
        match self {
            Self::Weld(ends)
            | Self::Ball(ends)
            | Self::Hinge(ends)
            | Self::Distance { ends, .. } => Some(ends),
            Self::Coupler { .. } => None,
        }
    }

    /// Whether what it joins overlaps where it is joined, as at a joint.
    pub fn is_joint(&self) -> bool {
        matches!(self, Self::Weld(_) | Self::Ball(_) | Self::Hinge(_))
    }

    /// How many rows of the equations it makes.
    pub fn rows(&self) -> usize {
        match self {
            Self::Weld(_) => 6,
            Self::Hinge(_) => 5,
            Self::Ball(_) => 3,
            Self::Distance { .. } | Self::Coupler { .. } => 1,
        }
    }
}
