//! Typed robot and meshes → [`Description`], scaled.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::hulls::{Meshes, ReadMesh};
use super::inertia;
use super::tree::{CheckedRobot, Order};
use super::{CollisionDescription, Description, JointDescription, LinkDescription};
use crate::geometry::Shape;
use crate::model::{JointKind, Limits};
use crate::spatial::{Pose, RigidInertia, Vec3, rotation_from_rpy};
use std::collections::HashMap;

/// What a `<collision>` touches with: its shape, the hull of its mesh, or the convex parts that the mesh has been taken into;
/// `None` without a shape.
fn collisions(
    collision: &urdf_rs::Collision,
    mesh: Option<&ReadMesh>,
    scale: f64,
) -> Option<Vec<CollisionDescription>> {
    let whole = CollisionDescription {
        X_LG: pose(&collision.origin, scale),
        shape: shape(&collision.geometry, mesh, scale)?,
        part: false,
        mesh: mesh.map(|mesh| mesh.path.clone()),
        outline: mesh.and_then(|mesh| mesh.outline.clone()),
        bounds: mesh.map(|mesh| mesh.bounds),
    };
    let Some(parts) = mesh.and_then(|mesh| mesh.parts.as_ref()) else {
        return Some(vec![whole]);
    };
    let part = |vertices: &Vec<Vec3>| CollisionDescription {
        shape: Shape::Hull {
            vertices: vertices.clone(),
        },
        part: true,
        outline: None,
        ..whole.clone()
    };
    Some(parts.iter().map(part).collect())
}

/// Puts everything together. `typed` has the links and joints in `order`; `None` if it does not.
pub(super) fn description(
    robot: &CheckedRobot,
    order: &Order,
    typed: &urdf_rs::Robot,
    meshes: &Meshes,
    scale: f64,
) -> Option<Description> {
    if typed.links.len() != order.links.len() || typed.joints.len() != order.joints.len() {
        return None;
    }
    let mut links = Vec::with_capacity(typed.links.len());
    for (typed, &i) in typed.links.iter().zip(&order.links) {
        let checked = &robot.links[i];
        let collisions = typed
            .collision
            .iter()
            .enumerate()
            .map(|(k, collision)| collisions(collision, meshes.hulls.get(&(i, k)), scale))
            .collect::<Option<Vec<_>>>()?
            .concat();
        links.push(LinkDescription {
            name: typed.name.clone(),
            inertial: checked
                .inertial
                .is_some()
                .then(|| inertial(&typed.inertial, scale)),
            R_LI: rotation_from_rpy(&Vec3::from(*typed.inertial.origin.rpy)),
            collisions,
            friction: checked.surface.friction,
            static_friction: checked.surface.static_friction,
            rolling_friction: checked.surface.rolling_friction,
            torsional_friction: checked.surface.torsional_friction,
            restitution: checked.surface.restitution,
            stiffness: checked.surface.stiffness,
            damping: checked.surface.damping,
            inertia_scaling: checked.surface.inertia_scaling,
            line: checked.line,
        });
    }
    let place: HashMap<&str, usize> = links
        .iter()
        .enumerate()
        .map(|(i, link)| (link.name.as_str(), i))
        .collect();
    let kinds: HashMap<&str, JointKind> = robot.joints.iter().map(|j| (j.name, j.kind)).collect();
    let length = |kind: JointKind| {
        if kind == JointKind::Prismatic {
            scale
        } else {
            1.0
        }
    };
    let mut joints = Vec::with_capacity(typed.joints.len());
    for (typed, &j) in typed.joints.iter().zip(&order.joints) {
        let checked = &robot.joints[j];
        let own = length(checked.kind);
        let xyz = Vec3::from(*typed.axis.xyz);
        joints.push(JointDescription {
            name: typed.name.clone(),
            kind: checked.kind,
            parent: *place.get(typed.parent.link.as_str())?,
            child: *place.get(typed.child.link.as_str())?,
            X_PJ: pose(&typed.origin, scale),
            axis: xyz.try_normalize(0.0).unwrap_or_else(Vec3::x),
            limits: checked.limits.map(|_| Limits {
                lower: typed.limit.lower * own,
                upper: typed.limit.upper * own,
            }),
            effort: checked.effort.map(|_| typed.limit.effort),
            velocity: checked.velocity.map(|_| typed.limit.velocity * own),
            damping: typed.dynamics.as_ref().map_or(0.0, |d| d.damping),
            friction: typed.dynamics.as_ref().map_or(0.0, |d| d.friction),
            // Turning: lengths do not enter. Sliding: a mass.
            armature: checked.armature,
            interfaces: checked.interfaces.clone(),
            mimic: typed.mimic.as_ref().map(|mimic| {
                let other = kinds
                    .get(mimic.joint.as_str())
                    .map_or(1.0, |&kind| length(kind));
                let multiplier = mimic.multiplier.unwrap_or(1.0) * own / other;
                (
                    mimic.joint.clone(),
                    multiplier,
                    mimic.offset.unwrap_or(0.0) * own,
                )
            }),
            line: checked.line,
        });
    }
    Some(Description {
        name: typed.name.clone(),
        links,
        joints,
        sources: meshes.sources.clone(),
        diagnostics: Vec::new(),
        text: "".into(),
    })
}

fn pose(origin: &urdf_rs::Pose, scale: f64) -> Pose {
    Pose::from_xyz_rpy(Vec3::from(*origin.xyz) * scale, Vec3::from(*origin.rpy))
}

/// Turned into the link's axes.
fn inertial(inertial: &urdf_rs::Inertial, scale: f64) -> RigidInertia {
    let i = &inertial.inertia;
    let I = inertia::matrix(&[i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz]) * (scale * scale);
    let R = rotation_from_rpy(&Vec3::from(*inertial.origin.rpy));
    RigidInertia {
        mass: inertial.mass.value,
        com: Vec3::from(*inertial.origin.xyz) * scale,
        I_cm: R * I * R.transpose(),
    }
}

/// `None` for a mesh that was not read.
fn shape(geometry: &urdf_rs::Geometry, mesh: Option<&ReadMesh>, scale: f64) -> Option<Shape> {
    Some(match geometry {
        urdf_rs::Geometry::Box { size } => Shape::Box {
            half: Vec3::from(**size) * (0.5 * scale),
        },
        urdf_rs::Geometry::Cylinder { radius, length } => Shape::Cylinder {
            radius: radius * scale,
            half_length: 0.5 * length * scale,
        },
        urdf_rs::Geometry::Capsule { radius, length } => Shape::Capsule {
            radius: radius * scale,
            half_length: 0.5 * length * scale,
        },
        urdf_rs::Geometry::Sphere { radius } => Shape::Sphere {
            radius: radius * scale,
        },
        urdf_rs::Geometry::Mesh { .. } => Shape::Hull {
            vertices: mesh?.vertices.clone(),
        },
    })
}
