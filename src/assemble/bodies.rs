//! The solver's bodies: one chain of bodies per moving joint, coordinates, colliders.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::base::Base;
use super::findings::{Findings, counted, listed};
use crate::model::{
    Body, BodyId, Collider, Dof, DofId, JointId, JointKind, Limits, LinkId, Model, Motion,
};
use crate::spatial::{Pose, Vec3};
use crate::urdf::CollisionDescription;

/// Fills bodies, degrees of freedom, colliders, and what links and joints know of them.
pub(super) fn add(
    model: &mut Model,
    base: &Base,
    shapes: &[Vec<CollisionDescription>],
    findings: &mut Findings,
) {
    model.bodies.push(Body {
        link: LinkId(0),
        parent: None,
        joint: None,
        motion: base.motion,
        X_PB: Pose::IDENTITY,
        coordinate: 0,
        dof: DofId(0),
        ratio: 1.0,
        offset: 0.0,
    });
    for j in 0..model.joints.len() {
        add_joint(model, j);
    }
    number_coordinates(model);
    narrow_limits(model, findings);
    report_merged(model, findings);
    add_colliders(model, shapes);
}

/// The bodies of joint `j`, and the place of its child link.
fn add_joint(model: &mut Model, j: usize) {
    let joint = &model.joints[j];
    let parent = &model.links[joint.parent.index()];
    let X_BJ = parent.X_BL.compose(&joint.X_PJ);
    let child = joint.child;
    let mut body = parent.body;
    let n = joint.axis;
    let motions = match joint.kind {
        JointKind::Fixed => {
            let link = &mut model.links[child.index()];
            link.body = body;
            link.X_BL = X_BJ;
            return;
        }
        JointKind::Revolute | JointKind::Continuous => vec![Motion::Revolute(n)],
        JointKind::Prismatic => vec![Motion::Prismatic(n)],
        JointKind::Spherical => vec![Motion::Spherical],
        JointKind::Planar => {
            let [u, w] = plane_axes(&n);
            vec![
                Motion::Prismatic(u),
                Motion::Prismatic(w),
                Motion::Revolute(n),
            ]
        }
        JointKind::Floating => vec![
            Motion::Prismatic(Vec3::x()),
            Motion::Prismatic(Vec3::y()),
            Motion::Prismatic(Vec3::z()),
            Motion::Spherical,
        ],
    };
    let mut X_PB = X_BJ;
    for motion in motions {
        let id = BodyId::from(model.bodies.len());
        model.bodies.push(Body {
            link: child,
            parent: Some(body),
            joint: Some(JointId::from(j)),
            motion,
            X_PB,
            coordinate: 0,
            dof: DofId(0),
            ratio: 1.0,
            offset: 0.0,
        });
        model.joints[j].bodies.push(id);
        body = id;
        X_PB = Pose::IDENTITY;
    }
    let link = &mut model.links[child.index()];
    link.body = body;
    link.X_BL = Pose::IDENTITY;
}

/// Two unit vectors `u`, `w` that span the plane normal to the unit vector `n`; `u`, `w`, `n` are
/// right-handed.
///
/// `u` is the part in the plane of the coordinate axis that follows the one nearest to `n`:
/// x for z, y for x, z for y.
pub(super) fn plane_axes(n: &Vec3) -> [Vec3; 2] {
    let next = (n.iamax() + 1) % 3;
    let mut u = Vec3::zeros();
    u[next] = 1.0;
    u -= n * n[next];
    u.normalize_mut();
    [u, n.cross(&u)]
}

/// Gives each independent body the next places in `q` and `v`, then mimics those of their leaders.
fn number_coordinates(model: &mut Model) {
    let mimic_of = |model: &Model, body: &Body| {
        body.joint
            .and_then(|joint| model.joints[joint.index()].mimic)
    };
    for b in 0..model.bodies.len() {
        if mimic_of(model, &model.bodies[b]).is_some() {
            continue;
        }
        let dof = DofId::from(model.dofs.len());
        let body = &mut model.bodies[b];
        body.coordinate = model.nq;
        body.dof = dof;
        let (motion, joint) = (body.motion, body.joint);
        model.nq += motion.nq();
        // Limits belong to turning and sliding joints, which have one body with one degree of
        // freedom.
        let limits = joint.and_then(|joint| model.joints[joint.index()].limits);
        model.dofs.extend((0..motion.nv()).map(|_| Dof {
            body: BodyId::from(b),
            limits,
        }));
    }
    for b in 0..model.bodies.len() {
        let Some(mimic) = mimic_of(model, &model.bodies[b]) else {
            continue;
        };
        let source = model.joints[mimic.joint.index()].bodies[0];
        let (coordinate, dof) = {
            let source = &model.bodies[source.index()];
            (source.coordinate, source.dof)
        };
        let body = &mut model.bodies[b];
        body.coordinate = coordinate;
        body.dof = dof;
        body.ratio = mimic.multiplier;
        body.offset = mimic.offset;
    }
}

/// A joint may go only where those that mimic it may go, too.
fn narrow_limits(model: &mut Model, findings: &mut Findings) {
    for j in 0..model.joints.len() {
        let follower = &model.joints[j];
        let (Some(mimic), Some(limits)) = (follower.mimic, follower.limits) else {
            continue;
        };
        let source = &model.joints[mimic.joint.index()];
        let dof = model.bodies[source.bodies[0].index()].dof;
        let own = model.dofs[dof.index()].limits;
        let names = format!("joint '{}' mimics '{}'", follower.name, source.name);
        let (m, o) = (mimic.multiplier, mimic.offset);
        if m == 0.0 {
            if !(limits.lower..=limits.upper).contains(&o) {
                let message = format!("{names} with multiplier 0 at {o}, outside its own limits");
                let help = "the limits are not used: correct its offset or its limits";
                findings.warning("A118", None, message, help);
            }
            continue;
        }
        let ends = [(limits.lower - o) / m, (limits.upper - o) / m];
        let mapped = Limits {
            lower: ends[0].min(ends[1]),
            upper: ends[0].max(ends[1]),
        };
        let narrowed = Limits {
            lower: own.map_or(mapped.lower, |own| own.lower.max(mapped.lower)),
            upper: own.map_or(mapped.upper, |own| own.upper.min(mapped.upper)),
        };
        // Files round their numbers.
        let slack = 1e-6 * (1.0 + mapped.lower.abs().max(mapped.upper.abs()));
        let room = |limits: &Limits| limits.upper - limits.lower;
        let excluded = if narrowed.lower > narrowed.upper {
            Some("exclude every position of the other")
        } else if room(&narrowed) <= slack && own.as_ref().is_none_or(|own| room(own) > slack) {
            // As with the multiplier -1 and limits that were drawn for 1.
            Some("leave the other no room to move")
        } else {
            None
        };
        if let Some(what) = excluded {
            let message = format!("{names}, but its limits {what}");
            let help = "its limits are not used: correct its multiplier, its offset or its limits";
            findings.warning("A118", None, message, help);
            continue;
        }
        let changed = own.is_none_or(|own| {
            narrowed.lower > own.lower + slack || narrowed.upper < own.upper - slack
        });
        if changed {
            let message = format!(
                "{names}: its limits narrow those to {:.6} … {:.6}",
                narrowed.lower, narrowed.upper
            );
            findings.note("A118", message, "");
            model.dofs[dof.index()].limits = Some(narrowed);
        }
    }
}

/// Which links lost their own body, and which move without mass.
fn report_merged(model: &Model, findings: &mut Findings) {
    let merged: Vec<&str> = model
        .joints
        .iter()
        .filter(|joint| joint.kind == JointKind::Fixed)
        .map(|joint| model.links[joint.child.index()].name.as_str())
        .collect();
    if !merged.is_empty() {
        let message = format!(
            "{} on fixed joints merged into {}: {}",
            counted(merged.len(), "link"),
            if merged.len() == 1 {
                "its parent"
            } else {
                "their parents"
            },
            listed(&merged)
        );
        findings.note("A108", message, "their frames and names stay");
    }
    let mut mass = vec![0.0; model.bodies.len()];
    for link in &model.links {
        mass[link.body.index()] += link.inertia.mass;
    }
    let massless: Vec<&str> = model
        .joints
        .iter()
        .filter(|joint| joint.bodies.last().is_some_and(|b| mass[b.index()] <= 0.0))
        .map(|joint| model.links[joint.child.index()].name.as_str())
        .collect();
    if !massless.is_empty() {
        let message = format!(
            "{} without mass {}: {}",
            counted(massless.len(), "link"),
            if massless.len() == 1 { "moves" } else { "move" },
            listed(&massless)
        );
        findings.note(
            "A109",
            message,
            "what hangs on it must give the joint inertia",
        );
    }
}

fn add_colliders(model: &mut Model, shapes: &[Vec<CollisionDescription>]) {
    for (l, (link, shapes)) in model.links.iter().zip(shapes).enumerate() {
        for collision in shapes {
            model.colliders.push(Collider {
                link: LinkId::from(l),
                body: link.body,
                X_BG: link.X_BL.compose(&collision.X_LG),
                shape: collision.shape.clone(),
            });
        }
    }
}

/// Gives each mesh its origin in its middle, where its link's does not matter.
pub(super) fn center(model: &mut Model) {
    for collider in &mut model.colliders {
        let (shape, center) = collider.shape.centered();
        collider.X_BG.p = collider.X_BG.point(&center);
        collider.shape = shape;
    }
}
