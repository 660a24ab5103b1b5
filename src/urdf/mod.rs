//! URDF text → [`Description`]: positioned checks, `package://`, meshes, inertia.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::Shape;
use crate::model::{JointKind, Limits};
use crate::spatial::{Pose, RigidInertia, Vec3};
use std::path::PathBuf;

/// A checked URDF with its meshes read: a tree with parents before children (file order among siblings).
#[derive(Clone, Debug)]
pub struct Description {
    /// Robot name.
    pub name: String,
    /// The links; the first is the root.
    pub links: Vec<LinkDescription>,
    /// The joints, ordered like their child links: joint `i` has child link `i + 1`.
    pub joints: Vec<JointDescription>,
    /// Files that it was read from (URDF first, then meshes), for `resources/source/`.
    pub sources: Vec<PathBuf>,
    /// Warnings and notes, each with its place in the file.
    pub diagnostics: Vec<Diagnostic>,
}

/// A link as the file has it.
#[derive(Clone, Debug)]
pub struct LinkDescription {
    /// Name.
    pub name: String,
    /// `<inertial>`, rotated into the link's axes; none where the file has none.
    pub inertial: Option<RigidInertia>,
    /// `<collision>` elements in file order, poses in the link's frame.
    pub collisions: Vec<CollisionDescription>,
    /// `<contact><lateral_friction>` or Gazebo's mu1, where the file has one.
    pub friction: Option<f64>,
    /// `<contact><restitution>`, where the file has one.
    pub restitution: Option<f64>,
    /// 1-based line of the `<link>` element.
    pub line: usize,
}

/// A collision shape as the file has it.
#[derive(Clone, Debug)]
pub struct CollisionDescription {
    /// Pose of the shape in the link's frame.
    pub X_LG: Pose,
    /// Mesh: its convex hull.
    pub shape: Shape,
    /// The mesh file that it was read from.
    pub mesh: Option<PathBuf>,
}

/// A joint as the file has it.
#[derive(Clone, Debug)]
pub struct JointDescription {
    /// Name.
    pub name: String,
    /// Type.
    pub kind: JointKind,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the child link.
    pub child: usize,
    /// `<origin>`.
    pub X_PJ: Pose,
    /// Unit vector; (1, 0, 0) where the file has none.
    pub axis: Vec3,
    /// lower and upper; none for continuous, planar, floating, fixed joints.
    pub limits: Option<Limits>,
    /// As in the file, where there is a `<limit>`.
    pub effort: Option<f64>,
    /// As in the file, where there is a `<limit>`.
    pub velocity: Option<f64>,
    /// `<dynamics damping>`, 0 where the file has none.
    pub damping: f64,
    /// `<dynamics friction>`, 0 where the file has none.
    pub friction: f64,
    /// `<mimic>`: name of the joint followed, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
    /// 1-based line of the `<joint>` element.
    pub line: usize,
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// An assumption that was taken.
    Note,
    /// Legal but suspicious.
    Warning,
    /// Stops the export.
    Error,
}

/// A finding with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad.
    pub severity: Severity,
    /// Stable code, such as `U104`.
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// File, 1-based line and column, length of the marked text; none for findings without a place.
    pub place: Option<Place>,
}

/// Where in a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// File name as given.
    pub file: String,
    /// 1-based.
    pub line: usize,
    /// 1-based, in characters.
    pub column: usize,
    /// Characters marked.
    pub length: usize,
    /// The whole line, for display.
    pub text: String,
}
