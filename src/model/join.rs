//! Worlds: several models in one.

use super::{
    ActuatorId, Anchor, BodyId, ContactPair, DofId, Group, JointId, LinkId, Loop, LoopKind, Model,
    OutputSelection, Root, RootId, RootKind, Sensor, SensorKind, Spring,
};

impl Model {
    /// Adds all that another model has, as trees of their own. Its one robot gets the name `name`,
    /// and the names of its links, joints, groups, sensors and pairs begin with that and a dot.
    /// World, contact law and solver stay those of `self`.
    pub fn join(&mut self, other: Self, name: &str, kind: RootKind) {
        let own = |part: &str| format!("{name}.{part}");
        let links = self.links.len();
        let roots = self.roots.len();
        let joints = self.joints.len();
        let bodies = self.bodies.len();
        let dofs = self.dofs.len();
        let actuators = self.actuators.len();
        let link = |id: LinkId| LinkId::from(links + id.index());
        let joint = |id: JointId| JointId::from(joints + id.index());
        let body = |id: BodyId| BodyId::from(bodies + id.index());
        let dof = |id: DofId| DofId::from(dofs + id.index());
        let actuator = |id: ActuatorId| ActuatorId::from(actuators + id.index());
        for mut part in other.roots {
            part.body = body(part.body);
            self.roots.push(Root {
                name: name.to_owned(),
                kind,
                ..part
            });
        }
        for mut part in other.links {
            part.name = own(&part.name);
            part.joint = part.joint.map(joint);
            part.body = body(part.body);
            self.links.push(part);
        }
        for mut part in other.joints {
            part.name = own(&part.name);
            (part.parent, part.child) = (link(part.parent), link(part.child));
            part.bodies = part.bodies.into_iter().map(body).collect();
            if let Some(mimic) = &mut part.mimic {
                mimic.joint = joint(mimic.joint);
            }
            self.joints.push(part);
        }
        for mut part in other.bodies {
            part.link = link(part.link);
            part.parent = part.parent.map(body);
            part.joint = part.joint.map(joint);
            part.coordinate += self.nq;
            part.dof = dof(part.dof);
            self.bodies.push(part);
        }
        for mut part in other.dofs {
            part.body = body(part.body);
            self.dofs.push(part);
        }
        self.nq += other.nq;
        for mut part in other.colliders {
            (part.link, part.body) = (link(part.link), body(part.body));
            self.colliders.push(part);
        }
        for mut part in other.actuators {
            (part.joint, part.dof) = (joint(part.joint), dof(part.dof));
            self.actuators.push(part);
        }
        let apart = other.apart.into_iter().map(|pair| pair.map(link));
        self.apart.extend(apart);
        self.join_closures((other.loops, other.springs), own, (link, joint));
        let initial = &mut self.initial;
        initial
            .joint_positions
            .extend(other.initial.joint_positions);
        initial
            .joint_velocities
            .extend(other.initial.joint_velocities);
        let OutputSelection {
            contacts,
            pairs,
            links: shown,
            external_wrenches,
            conveyors,
            driven,
            groups,
            sensors,
            ..
        } = other.outputs;
        let outputs = &mut self.outputs;
        outputs.contacts.extend(contacts.into_iter().map(link));
        let pairs = pairs.into_iter().map(|pair| pair.joined(own, link));
        outputs.pairs.extend(pairs);
        outputs.links.extend(shown.into_iter().map(link));
        let wrenches = external_wrenches.into_iter().map(link);
        outputs.external_wrenches.extend(wrenches);
        let conveyors = conveyors.into_iter();
        let conveyors = conveyors.map(|id| RootId::from(roots + id.index()));
        outputs.conveyors.extend(conveyors);
        let driven = driven.into_iter();
        let driven = driven.map(|id| RootId::from(roots + id.index()));
        outputs.driven.extend(driven);
        outputs.groups.extend(groups.into_iter().map(|group| Group {
            name: own(&group.name),
            actuators: group.actuators.into_iter().map(actuator).collect(),
        }));
        let sensors = sensors.into_iter().map(|s| s.joined(own, link, joint));
        outputs.sensors.extend(sensors);
    }

    /// The same of loops and springs, where names, links and joints are others.
    fn join_closures(
        &mut self,
        (loops, springs): (Vec<Loop>, Vec<Spring>),
        name: impl Fn(&str) -> String,
        (link, joint): (impl Fn(LinkId) -> LinkId, impl Fn(JointId) -> JointId),
    ) {
        let hang = |ends: &mut [Anchor; 2]| {
            for anchor in ends {
                anchor.link = anchor.link.map(&link);
            }
        };
        for mut part in loops {
            part.name = name(&part.name);
            if let LoopKind::Coupler { terms, .. } = &mut part.kind {
                for term in terms {
                    term.joint = joint(term.joint);
                }
            }
            part.kind.ends_mut().into_iter().for_each(hang);
            self.loops.push(part);
        }
        for mut part in springs {
            part.name = name(&part.name);
            hang(&mut part.ends);
            self.springs.push(part);
        }
    }
}

impl ContactPair {
    /// The same in a world where names and links are others.
    fn joined(mut self, name: impl Fn(&str) -> String, link: impl Fn(LinkId) -> LinkId) -> Self {
        self.name = name(&self.name);
        for id in self.sides.iter_mut().flatten().flatten() {
            *id = link(*id);
        }
        self
    }
}

impl Sensor {
    /// The same in a world where names, links and joints are others.
    fn joined(
        mut self,
        name: impl Fn(&str) -> String,
        link: impl Fn(LinkId) -> LinkId,
        joint: impl Fn(JointId) -> JointId,
    ) -> Self {
        self.name = name(&self.name);
        self.link = link(self.link);
        match &mut self.kind {
            SensorKind::ForceTorque { joint: id, .. } | SensorKind::Encoder { joint: id, .. } => {
                *id = joint(*id);
            }
            SensorKind::Ray { ignored, .. } => {
                for id in ignored {
                    *id = link(*id);
                }
            }
            SensorKind::Imu | SensorKind::Contact { .. } => {}
        }
        self
    }
}
