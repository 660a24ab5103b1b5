//! Checked robot and meshes → [`Description`], scaled.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::checked::{
    CheckedCollision, CheckedInertial, CheckedRobot, CheckedVisual, Geometry, LinkReference, Order,
};
use super::description::{
    ClosureDescription, CollisionDescription, Description, JointDescription, LinkDescription,
    VisualDescription, VisualShape,
};
use super::hulls::{Meshes, ReadMesh};
use super::inertia;
use super::solids::{of_density, of_solids};
use super::visuals::Drawn;
use crate::geometry::Shape;
use crate::model::{JointKind, Limits};
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3, rotation_from_rpy};
use std::collections::HashMap;

/// Thickness of what has no size, m: less than any contact resolves.
const SMALLEST_SIZE: f64 = 1e-9;

/// What a `<collision>` touches with: its shape, the hull of its mesh, or the convex parts that the
/// mesh has been cut into; `None` for a mesh that was not read.
fn collisions(
    collision: &CheckedCollision,
    mesh: Option<&ReadMesh>,
    scale: f64,
) -> Option<Vec<CollisionDescription>> {
    let whole = CollisionDescription {
        X_LG: pose(&collision.xyz, &collision.rpy, scale),
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

/// What closes its loops, in metres.
fn closures(robot: &CheckedRobot, scale: f64) -> Vec<ClosureDescription> {
    let scaled = |part: ClosureDescription| ClosureDescription {
        kind: part.kind.scaled(scale),
        ..part
    };
    robot.closures.iter().cloned().map(scaled).collect()
}

/// Puts everything together, links and joints in `order`; `None` where a mesh or a link is missing.
pub(super) fn description(
    robot: &CheckedRobot,
    order: &Order,
    meshes: &Meshes,
    drawn: Drawn,
    scale: f64,
) -> Option<Description> {
    let mut links = Vec::with_capacity(order.links.len());
    for &i in &order.links {
        let checked = &robot.links[i];
        let collisions = checked
            .collisions
            .iter()
            .enumerate()
            .map(|(k, collision)| collisions(collision, meshes.hulls.get(&(i, k)), scale))
            .collect::<Option<Vec<_>>>()?
            .concat();
        links.push(LinkDescription {
            name: checked.name.to_owned(),
            inertial: checked
                .inertial
                .as_ref()
                .and_then(|own| inertial(own, &collisions, scale)),
            R_LI: checked
                .inertial
                .as_ref()
                .map_or_else(Mat3::identity, |own| rotation_from_rpy(&own.rpy)),
            collisions,
            visuals: checked
                .visuals
                .iter()
                .filter_map(|visual| self::visual(visual, &drawn, scale))
                .collect(),
            friction: checked.surface.friction,
            static_friction: checked.surface.static_friction,
            rolling_friction: checked.surface.rolling_friction.map(|arm| scale * arm),
            torsional_friction: checked.surface.torsional_friction.map(|arm| scale * arm),
            restitution: checked.surface.restitution,
            stiffness: checked.surface.stiffness,
            damping: checked.surface.damping,
            inertia_scaling: checked.surface.inertia_scaling,
            tag: checked.tag.clone(),
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
    let index = |reference: &Option<LinkReference>| {
        let reference = reference.as_ref()?;
        place.get(reference.name).copied()
    };
    let mut joints = Vec::with_capacity(order.joints.len());
    for &j in &order.joints {
        let checked = &robot.joints[j];
        let own = length(checked.kind);
        joints.push(JointDescription {
            name: checked.name.to_owned(),
            kind: checked.kind,
            parent: index(&checked.parent)?,
            child: index(&checked.child)?,
            X_PJ: pose(&checked.xyz, &checked.rpy, scale),
            axis: checked.axis.try_normalize(0.0).unwrap_or_else(Vec3::x),
            limits: checked.limits.map(|(lower, upper)| Limits {
                lower: lower * own,
                upper: upper * own,
            }),
            effort: checked.effort,
            velocity: checked.velocity.map(|velocity| velocity * own),
            damping: checked.damping,
            friction: checked.friction,
            // Turning: lengths do not enter. Sliding: a mass.
            armature: checked.armature,
            interfaces: checked.interfaces.clone(),
            mimic: checked.mimic.as_ref().map(|mimic| {
                let other = kinds.get(mimic.joint).map_or(1.0, |&kind| length(kind));
                let multiplier = mimic.multiplier * own / other;
                (mimic.joint.to_owned(), multiplier, mimic.offset * own)
            }),
            tag: checked.tag.clone(),
        });
    }
    Some(Description {
        closures: closures(robot, scale),
        stands_still: robot.stands_still,
        name: robot.name.clone(),
        links,
        joints,
        sensors: Vec::new(),
        drawn_meshes: drawn.meshes,
        textures: drawn.textures,
        sources: meshes.sources.clone(),
        diagnostics: Vec::new(),
        text: "".into(),
    })
}

/// `None` for a visual whose mesh cannot be had.
fn visual(visual: &CheckedVisual, drawn: &Drawn, scale: f64) -> Option<VisualDescription> {
    let known = |of: &HashMap<String, Option<usize>>, name: &str| of.get(name).copied().flatten();
    Some(VisualDescription {
        X_LG: pose(&visual.xyz, &visual.rpy, scale),
        shape: match &visual.geometry {
            Geometry::Mesh {
                filename,
                scale: factors,
                ..
            } => VisualShape::Mesh {
                mesh: known(&drawn.mesh_of, filename)?,
                scale: Vec3::from(*factors) * scale,
            },
            solid => VisualShape::Solid(shape(solid, None, scale)?),
        },
        color: visual.paint.color,
        texture: visual
            .paint
            .texture
            .and_then(|(name, _)| known(&drawn.texture_of, name)),
        line: visual.line,
    })
}

fn pose(xyz: &Vec3, rpy: &Vec3, scale: f64) -> Pose {
    Pose::from_xyz_rpy(xyz * scale, *rpy)
}

/// Turned into the link's axes; none by a density of shapes without volume.
fn inertial(
    inertial: &CheckedInertial,
    collisions: &[CollisionDescription],
    scale: f64,
) -> Option<RigidInertia> {
    if let Some(density) = inertial.density {
        return of_density(density, collisions);
    }
    if inertial.of_shapes {
        return Some(RigidInertia {
            mass: inertial.mass,
            com: inertial.xyz * scale,
            I_cm: of_solids(inertial.mass, collisions).unwrap_or_default(),
        });
    }
    let I = inertia::matrix(&inertial.inertia) * (scale * scale);
    let R = rotation_from_rpy(&inertial.rpy);
    Some(RigidInertia {
        mass: inertial.mass,
        com: inertial.xyz * scale,
        I_cm: R * I * R.transpose(),
    })
}

/// `None` for a mesh that was not read.
fn shape(geometry: &Geometry, mesh: Option<&ReadMesh>, scale: f64) -> Option<Shape> {
    // A size of 0 leaves a point, a line or a face, which is this thick.
    let size = |size: f64| (size * scale).max(SMALLEST_SIZE);
    Some(match *geometry {
        Geometry::Box { size: sides } => Shape::Box {
            half: Vec3::from(sides.map(|side| 0.5 * size(side))),
        },
        Geometry::Cylinder { radius, length } => Shape::Cylinder {
            radius: size(radius),
            half_length: 0.5 * size(length),
        },
        Geometry::Capsule { radius, length } => Shape::Capsule {
            radius: size(radius),
            half_length: 0.5 * length * scale,
        },
        Geometry::Sphere { radius } => Shape::Sphere {
            radius: size(radius),
        },
        Geometry::Mesh { .. } => Shape::Hull {
            vertices: mesh?.vertices.clone(),
        },
    })
}
