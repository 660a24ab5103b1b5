//! The URDF's joint types.

use crate::joint::Kind;
use serde::{Deserialize, Serialize};

/// A URDF's joint type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// No motion.
    Fixed,
    /// Turns within limits.
    Revolute,
    /// Turns without limits.
    Continuous,
    /// Slides within limits.
    Prismatic,
    /// Slides in the plane normal to the axis and turns about it.
    Planar,
    /// Six degrees of freedom.
    Floating,
    /// Turns freely about a point: not URDF's, but `PyBullet`'s and Drake's (`ball`).
    Spherical,
}

impl JointKind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Fixed,
        Self::Revolute,
        Self::Continuous,
        Self::Prismatic,
        Self::Planar,
        Self::Floating,
        Self::Spherical,
    ];

    /// As URDF files call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Planar => "planar",
            Self::Floating => "floating",
            Self::Spherical => "spherical",
        }
    }

    /// The chain of bodies that makes up its motion, by their kinds, from the parent to the child.
    pub fn chain(self) -> &'static [Kind] {
        match self {
            Self::Fixed => &[],
            Self::Revolute | Self::Continuous => &[Kind::Turn],
            Self::Prismatic => &[Kind::Slide],
            Self::Planar => &[Kind::Slide, Kind::Slide, Kind::Turn],
            Self::Floating => &[Kind::Slide, Kind::Slide, Kind::Slide, Kind::Ball],
            Self::Spherical => &[Kind::Ball],
        }
    }
}
