//! A robot whose tags have been checked: every number is finite and in its range, every name is
//! there.

use super::description::{ClosureDescription, Tag};
use super::xml::{Attribute, Node};
use crate::model::{ActuatorMode, JointKind};
use crate::spatial::Vec3;
use std::ops::Range;

/// A robot whose tags have been checked.
pub(super) struct CheckedRobot<'d> {
    pub(super) name: String,
    /// File order.
    pub(super) links: Vec<CheckedLink<'d>>,
    /// File order.
    pub(super) joints: Vec<CheckedJoint<'d>>,
    /// Loops and springs, in file order; lengths as in the file.
    pub(super) closures: Vec<ClosureDescription>,
    /// Gazebo's `<static>`.
    pub(super) stands_still: bool,
}

impl CheckedRobot<'_> {
    /// Leaves out all shapes that are in files.
    pub(super) fn forget_meshes(&mut self) {
        let plain = |geometry: &Geometry| !matches!(geometry, Geometry::Mesh { .. });
        for link in &mut self.links {
            link.collisions.retain(|shape| plain(&shape.geometry));
        }
    }
}

/// Order of the links and joints, parents before children: joint `i` has child link `i + 1`.
pub(super) struct Order {
    /// Indices into [`CheckedRobot::links`].
    pub(super) links: Vec<usize>,
    /// Indices into [`CheckedRobot::joints`].
    pub(super) joints: Vec<usize>,
}

/// A link whose numbers have been checked.
pub(super) struct CheckedLink<'d> {
    pub(super) node: Node<'d>,
    pub(super) tag: Tag,
    /// Empty where there is none.
    pub(super) name: &'d str,
    /// Whether it is known by this name: it has one, and no other link had it before.
    pub(super) own_name: bool,
    pub(super) inertial: Option<CheckedInertial>,
    pub(super) collisions: Vec<CheckedCollision<'d>>,
    /// Filled in last: whatever is wrong with them is a warning.
    pub(super) visuals: Vec<CheckedVisual<'d>>,
    pub(super) surface: Surface,
}

/// `<inertial>`.
pub(super) struct CheckedInertial {
    /// m
    pub(super) xyz: Vec3,
    /// rad
    pub(super) rpy: Vec3,
    /// kg
    pub(super) mass: f64,
    /// ixx, ixy, ixz, iyy, iyz, izz about the centre of mass, kg m²
    pub(super) inertia: [f64; 6],
    /// Whether it is that of the collision shapes, because the file has none.
    pub(super) of_shapes: bool,
    /// Density of the collision shapes, kg/m³, where it gives mass, centre and inertia.
    pub(super) density: Option<f64>,
    /// Where `<inertia>` stands.
    pub(super) at: Range<usize>,
    /// What is wrong with the inertia, if it is wrong for a body on its own.
    pub(super) suspect: Option<Suspect>,
}

/// `<collision>`.
pub(super) struct CheckedCollision<'d> {
    pub(super) xyz: Vec3,
    pub(super) rpy: Vec3,
    pub(super) geometry: Geometry<'d>,
}

/// `<visual>`.
pub(super) struct CheckedVisual<'d> {
    pub(super) xyz: Vec3,
    pub(super) rpy: Vec3,
    pub(super) geometry: Geometry<'d>,
    pub(super) paint: Paint<'d>,
    /// 1-based
    pub(super) line: usize,
}

/// What `<material>` says, where there is one.
#[derive(Clone, Copy, Default)]
pub(super) struct Paint<'d> {
    /// Red, green, blue, alpha, each 0 … 1.
    pub(super) color: Option<[f64; 4]>,
    /// File name of the texture, and its attribute.
    pub(super) texture: Option<(&'d str, &'d Attribute)>,
}

impl Paint<'_> {
    /// Whether it has the same colour and the same texture, by its name, as another one.
    pub(super) fn looks_like(&self, other: &Self) -> bool {
        let look = |paint: &Self| {
            let color = paint.color.map(|color| color.map(f64::to_bits));
            (color, paint.texture.map(|(file, _)| file.to_owned()))
        };
        look(self) == look(other)
    }
}

/// What stands in `<geometry>`, sizes in m.
#[derive(PartialEq)]
pub(super) enum Geometry<'d> {
    Box {
        size: [f64; 3],
    },
    Cylinder {
        radius: f64,
        length: f64,
    },
    Capsule {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    Mesh {
        filename: &'d str,
        scale: [f64; 3],
        /// Where the file name stands.
        at: Range<usize>,
    },
}

impl Geometry<'_> {
    /// Whether two are the same shape, wherever they stand in the file.
    pub(super) fn same_as(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Mesh {
                    filename, scale, ..
                },
                Self::Mesh {
                    filename: name,
                    scale: factors,
                    ..
                },
            ) => filename == name && scale.map(f64::to_bits) == factors.map(f64::to_bits),
            _ => self == other,
        }
    }
}

/// An inertia that is not positive definite.
#[derive(Clone)]
pub(super) struct Suspect {
    pub(super) at: Range<usize>,
    pub(super) message: String,
    pub(super) help: String,
}

/// Of a link's surface, where a tag gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Surface {
    /// Coulomb coefficient, sliding.
    pub(super) friction: Option<f64>,
    /// Coulomb coefficient at rest.
    pub(super) static_friction: Option<f64>,
    /// Newton's coefficient.
    pub(super) restitution: Option<f64>,
    /// Moment against rolling over normal force, m.
    pub(super) rolling_friction: Option<f64>,
    /// Moment against turning about the normal over normal force, m.
    pub(super) torsional_friction: Option<f64>,
    /// PyBullet's, N/m.
    pub(super) stiffness: Option<f64>,
    /// PyBullet's, N·s/m.
    pub(super) damping: Option<f64>,
    /// Factor that PyBullet multiplies the inertia by.
    pub(super) inertia_scaling: Option<f64>,
}

/// A joint whose numbers have been checked.
pub(super) struct CheckedJoint<'d> {
    pub(super) node: Node<'d>,
    pub(super) tag: Tag,
    /// Empty where there is none.
    pub(super) name: &'d str,
    /// Whether it is known by this name: it has one, and no other joint had it before.
    pub(super) own_name: bool,
    pub(super) kind: JointKind,
    pub(super) parent: Option<LinkReference<'d>>,
    pub(super) child: Option<LinkReference<'d>>,
    pub(super) xyz: Vec3,
    pub(super) rpy: Vec3,
    /// As in the file: not yet of unit length.
    pub(super) axis: Vec3,
    /// rad or m
    pub(super) limits: Option<(f64, f64)>,
    pub(super) effort: Option<f64>,
    pub(super) velocity: Option<f64>,
    pub(super) damping: f64,
    pub(super) friction: f64,
    /// Of rotors, at the joint.
    pub(super) armature: f64,
    /// What its hardware takes.
    pub(super) interfaces: Vec<ActuatorMode>,
    pub(super) mimic: Option<CheckedMimic<'d>>,
}

impl CheckedJoint<'_> {
    /// What it is called in a sentence.
    pub(super) fn called(&self) -> String {
        called("joint", self.name)
    }
}

/// What a link or a joint is called in a sentence.
pub(super) fn called(tag: &str, name: &str) -> String {
    if name.is_empty() {
        format!("a {tag} without a name")
    } else {
        format!("{tag} '{name}'")
    }
}

/// `<parent link>` or `<child link>`.
pub(super) struct LinkReference<'d> {
    pub(super) name: &'d str,
    pub(super) at: Range<usize>,
}

/// `<mimic>`.
pub(super) struct CheckedMimic<'d> {
    pub(super) joint: &'d str,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
    /// Where the name of the joint stands.
    pub(super) at: Range<usize>,
}
