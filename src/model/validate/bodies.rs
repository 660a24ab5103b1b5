//! Bodies and coordinates: they hang on each other and move as the joints say, and each coordinate
//! has one owner.

use super::check::{Check, number, pose, require, unit};
use crate::model::{Body, BodyId, Joint, LinkId, Model};
use crate::spatial::Pose;
use std::collections::BTreeSet;

#[cfg_attr(small, optimize(size))]
pub(super) fn validate(model: &Model) -> Check {
    roots(model)?;
    bodies(model)?;
    dofs(model)
}

/// There is a robot, and every base is listed once, in order, with a name of its own.
fn roots(model: &Model) -> Check {
    let part = || "the list of trees".to_owned();
    let bases = model.bodies.iter().zip(0..);
    let bases = bases.filter(|(body, _)| body.parent.is_none());
    let listed = model.roots.iter().map(|root| root.body);
    require(
        listed.eq(bases.map(|(_, b)| BodyId(b))) && !model.roots.is_empty(),
        part,
        "does not name every base in order",
    )?;
    let mut names = BTreeSet::new();
    for (r, root) in model.roots.iter().enumerate() {
        require(
            root.name.is_empty() == (r == 0) && names.insert(root.name.as_str()),
            part,
            "has a name twice, or a tree without one",
        )?;
    }
    Ok(())
}

fn bodies(model: &Model) -> Check {
    for (b, body) in model.bodies.iter().enumerate() {
        let part = || format!("body {b}");
        require(
            body.link.index() < model.links.len(),
            part,
            "names a link that does not exist",
        )?;
        let before = match body.parent {
            None => true,
            Some(parent) => parent.index() < b,
        };
        require(before, part, "does not come after its parent")?;
        let base = body.motion.kind().is_base();
        require(
            base == body.parent.is_none() && base == body.joint.is_none(),
            part,
            "is no base but moves like one, or the other way round",
        )?;
        pose(&body.X_PB, part)?;
        if let Some(axis) = body.motion.axis() {
            require(unit(&axis), part, "has an axis that is no unit vector")?;
        }
        require(
            number(body.ratio) && number(body.offset),
            part,
            "has a ratio or offset that is not finite",
        )?;
        let nq = body.motion.nq();
        let nv = body.motion.nv();
        let fits = |first: usize, count: usize, all: usize| {
            first.checked_add(count).is_some_and(|end| end <= all)
        };
        require(
            fits(body.coordinate, nq, model.nq) && fits(body.dof.index(), nv, model.dofs.len()),
            part,
            "has coordinates that do not exist",
        )?;
        if let Some(joint) = body.joint {
            let listed = model
                .joints
                .get(joint.index())
                .is_some_and(|joint| joint.bodies.iter().any(|other| other.index() == b));
            require(listed, part, "is not one of its joint's")?;
        }
    }
    for joint in &model.joints {
        chain(model, joint)?;
    }
    for (l, link) in model.links.iter().enumerate() {
        let part = || format!("link '{}'", link.name);
        let expected = match link.joint {
            None => Some(model.roots[model.root_of(link.body).index()].body),
            Some(joint) => {
                let joint = &model.joints[joint.index()];
                let moved = joint.bodies.last().copied();
                moved.or_else(|| Some(model.links[joint.parent.index()].body))
            }
        };
        require(
            expected == Some(link.body),
            part,
            "is not on the body that its joint moves",
        )?;
        let owner = model.bodies[link.body.index()].link;
        require(
            owner != LinkId::from(l) || link.X_BL == Pose::IDENTITY,
            part,
            "gives its body the frame but has a pose in it",
        )?;
    }
    Ok(())
}

/// The bodies of a joint hang on each other and move as its type says.
fn chain(model: &Model, joint: &Joint) -> Check {
    let part = || format!("joint '{}'", joint.name);
    let mut parent = model.links[joint.parent.index()].body;
    for (i, &b) in joint.bodies.iter().enumerate() {
        let body: &Body = &model.bodies[b.index()];
        let kind = joint.kind.chain().get(i) == Some(&body.motion.kind());
        let own = body.joint.is_some_and(|j| {
            model
                .joints
                .get(j.index())
                .is_some_and(|other| other.child == joint.child)
        });
        require(
            kind && own && body.parent == Some(parent) && body.link == joint.child,
            part,
            "has bodies that are not its own",
        )?;
        parent = b;
    }
    Ok(())
}

/// Every place in `q` and `v` belongs to exactly one independent body; mimics share their source's.
fn dofs(model: &Model) -> Check {
    let part = || "the list of degrees of freedom".to_owned();
    let (mut nq, mut nv) = (0, 0);
    for (b, body) in model.bodies.iter().enumerate() {
        let mimic = body
            .joint
            .and_then(|joint| model.joints[joint.index()].mimic);
        if let Some(mimic) = mimic {
            let source = model.joints[mimic.joint.index()].bodies[0].index();
            let source = &model.bodies[source];
            require(
                body.coordinate == source.coordinate && body.dof == source.dof,
                || format!("body {b}"),
                "does not share the coordinate of the joint that it mimics",
            )?;
            #[expect(clippy::float_cmp, reason = "one is a copy of the other")]
            let same = body.ratio == mimic.multiplier && body.offset == mimic.offset;
            require(
                same,
                || format!("body {b}"),
                "does not have the ratio of the joint that it mimics",
            )?;
            continue;
        }
        #[expect(clippy::float_cmp, reason = "exact by construction")]
        let own = body.ratio == 1.0 && body.offset == 0.0;
        require(
            own && body.coordinate == nq && body.dof.index() == nv,
            || format!("body {b}"),
            "does not have the next free coordinate",
        )?;
        nq += body.motion.nq();
        for dof in nv..nv + body.motion.nv() {
            require(
                model.dofs.get(dof).is_some_and(|dof| dof.body.index() == b),
                part,
                "names wrong bodies",
            )?;
        }
        nv += body.motion.nv();
    }
    require(
        nq == model.nq && nv == model.dofs.len(),
        part,
        "does not fit the bodies",
    )?;
    for dof in &model.dofs {
        if let Some(limits) = &dof.limits {
            let scalar = model.bodies[dof.body.index()].motion.nv() == 1;
            require(
                scalar
                    && number(limits.lower)
                    && number(limits.upper)
                    && limits.lower <= limits.upper,
                part,
                "has limits that are no range",
            )?;
        }
    }
    Ok(())
}
