//! The robot as a URDF describes it, checked, with its meshes read.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::sensed::SensorDescription;
use crate::diagnostic::Diagnostic;
use crate::geometry::Shape;
use crate::model::{ActuatorMode, JointKind, Limits};
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Where a tag stands in [`Description::text`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tag {
    /// 1-based; 0 where there is no text.
    pub line: usize,
    /// Bytes of the text.
    pub at: Range<usize>,
}

/// A checked URDF with its meshes read: a tree with parents before children (file order among
/// siblings).
#[derive(Clone, Debug)]
pub struct Description {
    /// Robot name.
    pub name: String,
    /// The links; the first is the root.
    pub links: Vec<LinkDescription>,
    /// The joints, ordered like their child links: joint `i` has child link `i + 1`.
    pub joints: Vec<JointDescription>,
    /// Sensors in file order; none unless [`super::ReadOptions::sensors`] is on.
    pub sensors: Vec<SensorDescription>,
    /// Loops and springs of its notes for other programs.
    pub closures: Vec<ClosureDescription>,
    /// Whether Gazebo is told that it stands still, with `<static>`.
    pub stands_still: bool,
    /// Meshes of the visuals, each file once.
    pub drawn_meshes: Vec<DrawnMesh>,
    /// Textures of the visuals, each file once.
    pub textures: Vec<Texture>,
    /// Files that it was read from (URDF first, then meshes), for `resources/source/`.
    pub sources: Vec<PathBuf>,
    /// Warnings and notes, each with its place in the file.
    pub diagnostics: Vec<Diagnostic>,
    /// The URDF's text, for marks in later findings; empty for a robot that was made in code.
    pub text: Arc<str>,
}

/// A loop or a spring as a note for another program has it.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureDescription {
    /// Name, or what kind of note it is.
    pub name: String,
    /// What it does.
    pub kind: ClosureDescriptionKind,
    /// Where the element's tag stands.
    pub tag: Tag,
}

/// What a note for another program closes.
#[derive(Clone, Debug, PartialEq)]
pub enum ClosureDescriptionKind {
    /// Two frames, as one.
    Weld {
        /// Names of the links; `world` is the world, if no link has the name.
        links: [String; 2],
        /// The frames in these.
        X: [Pose; 2],
    },
    /// Two points, as one.
    Ball {
        /// As above.
        links: [String; 2],
        /// As above.
        X: [Pose; 2],
    },
    /// Two points and the z axes there, as one.
    Hinge {
        /// As above.
        links: [String; 2],
        /// As above.
        X: [Pose; 2],
    },
    /// A sum of positions of joints.
    Coupler {
        /// Names, and what each is multiplied by.
        joints: Vec<(String, f64)>,
        /// The sum; none: that at the start.
        sum: Option<f64>,
    },
    /// A spring between two points.
    Spring {
        /// As above.
        links: [String; 2],
        /// As above.
        X: [Pose; 2],
        /// m
        length: f64,
        /// N/m
        stiffness: f64,
        /// N·s/m
        damping: f64,
    },
}

impl ClosureDescriptionKind {
    /// The same in a robot whose lengths are multiplied.
    pub(super) fn scaled(mut self, scale: f64) -> Self {
        match &mut self {
            Self::Weld { X, .. } | Self::Ball { X, .. } | Self::Hinge { X, .. } => {
                for X in X {
                    X.p *= scale;
                }
            }
            Self::Spring { X, length, .. } => {
                for X in X {
                    X.p *= scale;
                }
                *length *= scale;
            }
            Self::Coupler { .. } => {}
        }
        self
    }
}

/// A link as the file has it.
#[derive(Clone, Debug)]
pub struct LinkDescription {
    /// Name.
    pub name: String,
    /// `<inertial>`, rotated into the link's axes; none where the file has none.
    pub inertial: Option<RigidInertia>,
    /// Axes of `<inertial><origin>` in the link's; the identity where the file has none.
    pub R_LI: Mat3,
    /// `<collision>` elements in file order, poses in the link's frame.
    pub collisions: Vec<CollisionDescription>,
    /// `<visual>` elements in file order; those whose mesh cannot be had are left out.
    pub visuals: Vec<VisualDescription>,
    /// `<contact><lateral_friction>`, Drake's `mu_dynamic` or Gazebo's `mu1`, where the file has
    /// one.
    pub friction: Option<f64>,
    /// Drake's `mu_static`, where the file has one.
    pub static_friction: Option<f64>,
    /// `<contact><rolling_friction>`, m, where the file has one.
    pub rolling_friction: Option<f64>,
    /// `<contact><spinning_friction>`, m, where the file has one.
    pub torsional_friction: Option<f64>,
    /// `<contact><restitution>`, where the file has one.
    pub restitution: Option<f64>,
    /// `<contact><stiffness>`, N/m, where the file has one; used with PyBullet's conventions.
    pub stiffness: Option<f64>,
    /// `<contact><damping>`, N·s/m, likewise.
    pub damping: Option<f64>,
    /// `<contact><inertia_scaling>`, where the file has one: PyBullet's factor on the inertia, used
    /// with its conventions.
    pub inertia_scaling: Option<f64>,
    /// Where the `<link>` tag stands.
    pub tag: Tag,
}

impl Description {
    /// A robot that is made in code: a root link alone, named after it.
    pub fn of(root: LinkDescription) -> Self {
        Self {
            name: root.name.clone(),
            links: vec![root],
            joints: Vec::new(),
            sensors: Vec::new(),
            closures: Vec::new(),
            stands_still: false,
            drawn_meshes: Vec::new(),
            textures: Vec::new(),
            sources: Vec::new(),
            diagnostics: Vec::new(),
            text: "".into(),
        }
    }
}

impl LinkDescription {
    /// A frame without mass and shape.
    ///
    /// - `tag`: of the `<link>` element
    pub fn frame(name: &str, tag: Tag) -> Self {
        Self {
            name: name.to_owned(),
            inertial: None,
            R_LI: Mat3::identity(),
            collisions: Vec::new(),
            visuals: Vec::new(),
            friction: None,
            static_friction: None,
            rolling_friction: None,
            torsional_friction: None,
            restitution: None,
            stiffness: None,
            damping: None,
            inertia_scaling: None,
            tag,
        }
    }
}

/// A collision shape as the file has it.
#[derive(Clone, Debug)]
pub struct CollisionDescription {
    /// Pose of the shape in the link's frame.
    pub X_LG: Pose,
    /// Mesh: its convex hull.
    pub shape: Shape,
    /// Whether it is one of several convex parts of a mesh; these are no wheels.
    pub part: bool,
    /// The mesh file that it was read from.
    pub mesh: Option<PathBuf>,
    /// Mesh that turns with a continuous joint: corners of its hull, more than the shape has.
    pub outline: Option<Arc<[Vec3]>>,
    /// Mesh: least and greatest coordinates of the whole of it, m, in the shape's axes; its hull
    /// has fewer corners.
    pub bounds: Option<[Vec3; 2]>,
}

/// A `<visual>` as the file has it.
#[derive(Clone, Debug)]
pub struct VisualDescription {
    /// Pose of the shape in the link's frame.
    pub X_LG: Pose,
    /// What is drawn.
    pub shape: VisualShape,
    /// Red, green, blue (sRGB) and alpha of its `<material>`, each 0 … 1.
    pub color: Option<[f64; 4]>,
    /// Texture of its `<material>`, in [`Description::textures`].
    pub texture: Option<usize>,
    /// 1-based line of the `<visual>` element.
    pub line: usize,
}

/// What a `<visual>` draws, lengths in m.
#[derive(Clone, Debug)]
pub enum VisualShape {
    /// A mesh of [`Description::drawn_meshes`] or a part of one.
    Mesh {
        /// Its place in the list.
        mesh: usize,
        /// Factors on its coordinates, the robot's scale included.
        scale: Vec3,
    },
    /// A solid; no hull.
    Solid(Shape),
}

/// A mesh file as it is drawn.
#[derive(Clone, Debug)]
pub struct DrawnMesh {
    /// The file.
    pub path: PathBuf,
    /// Its triangles by colour and texture; empty where [`super::ReadOptions::drawn`] is off.
    pub parts: Vec<MeshPart>,
}

/// Triangles of one colour and texture.
#[derive(Clone, Debug, Default)]
pub struct MeshPart {
    /// Corners, m, as the file has them, in the order in which triangles first have them; some
    /// stand there several times.
    pub corners: Vec<Vec3>,
    /// Places in `corners`.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of the corners, (0, 0) at the lower left; one for each triangle where
    /// there is a texture, else none.
    pub uv: Vec<[[f64; 2]; 3]>,
    /// Red, green, blue (sRGB) as the file has them, each 0 … 1.
    pub color: Option<[f64; 3]>,
    /// In [`Description::textures`].
    pub texture: Option<usize>,
    /// What the texture is multiplied by, as `color`; none for white.
    pub tint: Option<[f64; 3]>,
}

/// An image file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// The file, or the mesh file that it is inside of.
    pub path: PathBuf,
    /// How it is written.
    pub format: ImageFormat,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Content of the image file.
    pub bytes: Vec<u8>,
}

/// How an image file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// ISO/IEC 15948.
    Png,
    /// ISO/IEC 10918.
    Jpeg,
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
    /// Rotor inertia times gear ratio squared, kg·m² or kg: Drake's tags, or `<dynamics armature>`.
    pub armature: f64,
    /// What its hardware takes, by `<ros2_control>` and `<transmission>`.
    pub interfaces: Vec<ActuatorMode>,
    /// `<mimic>`: name of the joint followed, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
    /// Where the `<joint>` tag stands.
    pub tag: Tag,
}
