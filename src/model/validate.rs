//! What must hold for a [`Model`] before anything computes with it.
//!
//! A `model.json` may be damaged or hostile: whatever indexes, divides or allocates later relies on
//! the checks made here, so that a wrong file is an error and never a panic.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod bodies;
mod check;
mod loops;
mod outputs;

use super::{Joint, JointId, JointKind, Model, ModelError};
use crate::geometry::Shape;
use crate::range::Range;
use check::{Check, not_negative, number, pose, positive, require, symmetric, unit, vector};
use std::collections::BTreeSet;

/// Most links, joints, bodies, colliders or actuators. The largest robots have some hundred.
const MOST_PARTS: usize = 20_000;

/// Most degrees of freedom: the mass matrix then takes 32 MB.
const MOST_DOFS: usize = 2_000;

/// Most corners of all hulls, and most contact points.
const MOST_CORNERS: usize = 2_000_000;

impl Model {
    /// Whether everything that the solver relies on holds: indices, order, lengths, units, finite
    /// numbers.
    ///
    /// # Errors
    /// [`ModelError::Invalid`] names the first part that is wrong.
    #[cfg_attr(small, optimize(size))]
    pub fn validate(&self) -> Result<(), ModelError> {
        sizes(self)?;
        links(self)?;
        joints(self)?;
        bodies::validate(self)?;
        colliders(self)?;
        actuators(self)?;
        initial(self)?;
        settings(self)?;
        loops::validate(self)?;
        outputs::validate(self)
    }
}

fn sizes(model: &Model) -> Check {
    let model_part = || "the model".to_owned();
    require(!model.links.is_empty(), model_part, "has no links")?;
    require(!model.bodies.is_empty(), model_part, "has no bodies")?;
    let parts = [
        model.links.len(),
        model.joints.len(),
        model.bodies.len(),
        model.colliders.len(),
        model.actuators.len(),
    ];
    require(
        parts.iter().all(|&n| n <= MOST_PARTS),
        model_part,
        "has more than 20000 links, joints, bodies, shapes or actuators",
    )?;
    require(
        model.dofs.len() <= MOST_DOFS,
        model_part,
        "has more than 2000 degrees of freedom",
    )?;
    require(
        model.joints.len() + model.roots.len() == model.links.len(),
        model_part,
        "must have one link more than joints for each of its trees",
    )
}

fn links(model: &Model) -> Check {
    let (mut names, mut next) = (BTreeSet::new(), 0);
    for (l, link) in model.links.iter().enumerate() {
        let part = || format!("link '{}'", link.name);
        require(
            names.insert(link.name.as_str()),
            part,
            "has the name of another link",
        )?;
        // Links and joints are ordered alike: each joint carries the next link that is no base's.
        let base = model.roots.iter().any(|root| {
            let base = model.bodies.get(root.body.index());
            base.is_some_and(|base| base.link.index() == l)
        });
        let joint = (!base).then_some(next);
        next += usize::from(!base);
        require(
            link.joint.map(JointId::index) == joint,
            part,
            "does not hang on the joint before it in the list",
        )?;
        require(
            link.body.index() < model.bodies.len(),
            part,
            "belongs to a body that does not exist",
        )?;
        pose(&link.X_BL, part)?;
        let inertia = &link.inertia;
        require(
            number(inertia.mass) && inertia.mass >= 0.0,
            part,
            "has a mass that is not finite or negative",
        )?;
        require(
            vector(&inertia.com) && symmetric(&inertia.I_cm),
            part,
            "has an inertia that is not finite and symmetric",
        )?;
        require(
            not_negative(link.friction),
            part,
            "has a friction that is not finite or negative",
        )?;
        require(
            Range::Restitution.contains(link.restitution),
            part,
            "has a restitution that is not 0 or from 1e-6 to 1",
        )?;
        let more = [
            link.static_excess,
            link.rolling_friction,
            link.torsional_friction,
        ];
        require(
            more.iter().all(|&value| not_negative(value)),
            part,
            "has a static, rolling or torsional friction that is not finite or negative",
        )?;
        require(
            link.stiffness.is_none_or(positive) && link.dissipation.is_none_or(not_negative),
            part,
            "has a contact stiffness that is not finite or not positive, or a dissipation that is negative",
        )?;
    }
    Ok(())
}

fn joints(model: &Model) -> Check {
    let mut names = BTreeSet::new();
    // Per link: the base of its tree.
    let mut base = 0;
    let bases: Vec<usize> = (0..)
        .zip(&model.links)
        .map(|(l, link)| {
            base = if link.joint.is_none() { l } else { base };
            base
        })
        .collect();
    for (j, joint) in model.joints.iter().enumerate() {
        let part = || format!("joint '{}'", joint.name);
        require(
            names.insert(joint.name.as_str()),
            part,
            "has the name of another joint",
        )?;
        let (parent, child) = (joint.parent.index(), joint.child.index());
        let carried = model.links.get(child).and_then(|link| link.joint);
        require(
            carried.map(JointId::index) == Some(j) && (bases[child]..child).contains(&parent),
            part,
            "breaks the order: parents come before children",
        )?;
        pose(&joint.X_PJ, part)?;
        require(
            unit(&joint.axis),
            part,
            "has an axis that is no unit vector",
        )?;
        if let Some(limits) = &joint.limits {
            require(
                number(limits.lower) && number(limits.upper) && limits.lower <= limits.upper,
                part,
                "has limits that are no range",
            )?;
        }
        let optional = [joint.effort, joint.velocity];
        require(
            optional.iter().flatten().all(|&value| not_negative(value)),
            part,
            "has an effort or velocity limit that is not finite or negative",
        )?;
        let terms = [
            joint.damping,
            joint.friction,
            joint.armature,
            joint.static_excess,
        ];
        require(
            terms.iter().all(|&value| not_negative(value)) && positive(joint.stribeck_velocity),
            part,
            "has damping, friction or armature that is not finite or negative",
        )?;
        let count = match joint.kind {
            JointKind::Fixed => 0,
            JointKind::Revolute
            | JointKind::Continuous
            | JointKind::Prismatic
            | JointKind::Spherical => 1,
            JointKind::Planar => 3,
            JointKind::Floating => 4,
        };
        require(
            joint.bodies.len() == count,
            part,
            "has not the number of bodies of its type",
        )?;
        let exist = joint
            .bodies
            .iter()
            .all(|b| (1..model.bodies.len()).contains(&b.index()));
        require(exist, part, "names a body that does not exist")?;
        mimic(model, joint)?;
    }
    Ok(())
}

fn mimic(model: &Model, joint: &Joint) -> Check {
    let part = || format!("joint '{}'", joint.name);
    let Some(mimic) = &joint.mimic else {
        return Ok(());
    };
    let scalar = |kind| {
        matches!(
            kind,
            JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic
        )
    };
    let source = model.joints.get(mimic.joint.index());
    require(
        scalar(joint.kind) && source.is_some_and(|s| s.mimic.is_none() && scalar(s.kind)),
        part,
        "mimics what cannot be mimicked",
    )?;
    require(
        number(mimic.multiplier) && number(mimic.offset),
        part,
        "has a mimic ratio or offset that is not finite",
    )
}

fn colliders(model: &Model) -> Check {
    let mut points = 0_usize;
    let mut corners = 0_usize;
    for (c, collider) in model.colliders.iter().enumerate() {
        let part = || format!("collider {c}");
        let link = model.links.get(collider.link.index());
        require(
            link.is_some_and(|link| link.body == collider.body),
            part,
            "is not on the body of its link",
        )?;
        pose(&collider.X_BG, part)?;
        let fits = match &collider.shape {
            Shape::Sphere { radius } => positive(*radius),
            Shape::Capsule {
                radius,
                half_length,
            } => positive(*radius) && not_negative(*half_length),
            Shape::Cylinder {
                radius,
                half_length,
            } => positive(*radius) && positive(*half_length),
            Shape::Box { half } => half.iter().all(|&h| positive(h)),
            Shape::Hull { vertices } => !vertices.is_empty() && vertices.iter().all(vector),
            // Heights were checked when they were read.
            Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => true,
        };
        let moves = model
            .bodies
            .get(collider.body.index())
            .is_some_and(|body| body.motion.kind().moves());
        require(
            !(moves && collider.shape.is_terrain()),
            part,
            "is terrain, and moves",
        )?;
        require(fits, part, "has a shape without size")?;
        corners = corners.saturating_add(match &collider.shape {
            Shape::Hull { vertices } => vertices.len(),
            _ => 0,
        });
        points = points.saturating_add(collider.shape.points());
        require(
            corners.max(points) <= MOST_CORNERS,
            part,
            "takes the corners beyond what is supported",
        )?;
    }
    Ok(())
}

fn actuators(model: &Model) -> Check {
    let mut driven = BTreeSet::new();
    for (a, actuator) in model.actuators.iter().enumerate() {
        let part = || format!("actuator {}", a + 1);
        let body = model
            .joints
            .get(actuator.joint.index())
            .filter(|joint| joint.mimic.is_none())
            .and_then(|_| model.scalar_body(actuator.joint));
        require(
            body.is_some_and(|b| model.bodies[b.index()].dof == actuator.dof),
            part,
            "does not drive an independent turning or sliding joint",
        )?;
        require(
            driven.insert(actuator.joint),
            part,
            "drives the joint of another one",
        )?;
        let values = [actuator.max_effort, actuator.kp, actuator.kd];
        require(
            values.iter().all(|&value| not_negative(value))
                && positive(actuator.reference_effort)
                && actuator.no_load_speed.is_none_or(positive),
            part,
            "has an effort, gain or speed that is not finite or negative",
        )?;
    }
    Ok(())
}

fn initial(model: &Model) -> Check {
    let part = || "the initial state".to_owned();
    let initial = &model.initial;
    for root in &model.roots {
        let vectors = [
            &root.position,
            &root.rpy,
            &root.linear_velocity,
            &root.angular_velocity,
        ];
        require(
            vectors.into_iter().all(vector),
            part,
            "has a number that is not finite",
        )?;
    }
    let per_joint = [&initial.joint_positions, &initial.joint_velocities];
    require(
        per_joint
            .into_iter()
            .all(|list| list.len() == model.joints.len() && list.iter().all(|&x| number(x))),
        part,
        "must have one finite number per joint",
    )
}

fn settings(model: &Model) -> Check {
    let solver = &model.solver;
    require(
        not_negative(solver.step_size)
            && not_negative(solver.tolerance)
            && positive(solver.max_steps),
        || "the solver's settings".to_owned(),
        "have a number that is not finite or negative",
    )?;
    let contact = &model.contact;
    require(
        positive(contact.penetration)
            && contact.stiffness.is_none_or(positive)
            && not_negative(contact.dissipation)
            && positive(contact.stribeck_velocity),
        || "the contact law".to_owned(),
        "has a number out of range",
    )?;
    let ground = model.world.ground.as_ref();
    require(
        vector(&model.world.gravity)
            && not_negative(model.world.drag)
            && ground.is_none_or(|ground| {
                let more = [
                    ground.friction,
                    ground.static_excess,
                    ground.rolling_friction,
                    ground.torsional_friction,
                ];
                more.iter().all(|&value| not_negative(value))
                    && (0.0..=1.0).contains(&ground.restitution)
            }),
        || "the world".to_owned(),
        "has a number out of range",
    )
}

#[cfg(all(test, feature = "urdf"))]
mod tests;
