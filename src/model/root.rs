//! Trees of a world.

use super::id::BodyId;
use crate::spatial::Vec3;
use serde::{Deserialize, Serialize};

/// A robot or an object: the base of a tree, and how it begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Root {
    /// Its name; empty for the first. The names of its links and joints begin with it and a dot.
    pub name: String,
    /// What it is.
    pub kind: RootKind,
    /// Its base.
    pub body: BodyId,
    /// Initial base position `p_WB`, m. For a fixed base: where it is mounted.
    pub position: Vec3,
    /// Initial base roll, pitch, yaw, rad.
    pub rpy: Vec3,
    /// Initial base velocity `ṗ_WB`, m/s; zero for a fixed base.
    pub linear_velocity: Vec3,
    /// Initial base angular velocity `ω_WB_W`, rad/s; zero for a fixed base.
    pub angular_velocity: Vec3,
    /// Whether the base is set down on the ground: its height follows from the ground, which
    /// carries it from the first instant on.
    #[serde(default)]
    pub set_down: bool,
    /// Whether its own links touch each other.
    #[serde(default)]
    pub self_collision: bool,
}

/// What stands in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RootKind {
    /// Something that is commanded.
    Robot,
    /// Something that is not.
    Object,
}

impl Root {
    /// One on the body `body`, at rest in the world's origin.
    pub fn new(name: String, body: BodyId) -> Self {
        Self {
            name,
            kind: RootKind::Robot,
            body,
            position: Vec3::zeros(),
            rpy: Vec3::zeros(),
            linear_velocity: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            set_down: false,
            self_collision: false,
        }
    }
}
