//! Worlds: several models in one.

use super::{
    ActuatorId, BodyId, ContactPair, DofId, Group, JointId, LinkId, Model, OutputSelection, Root,
    RootKind, Sensor, SensorKind,
};

impl Model {
    /// Adds all that another model has, as trees of their own. Its one robot gets the name `name`,
    /// and the names of its links, joints, groups, sensors and pairs begin with that and a dot.
    /// World, contact law and solver stay those of `self`.
    pub fn join(&mut self, other: Self, name: &str, kind: RootKind) {
        let own = |part: &str| format!("{name}.{part}");
        let links = self.links.len();
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
        outputs.groups.extend(groups.into_iter().map(|group| Group {
            name: own(&group.name),
            actuators: group.actuators.into_iter().map(actuator).collect(),
        }));
        outputs
            .sensors
            .extend(sensors.into_iter().map(|sensor| Sensor {
                name: own(&sensor.name),
                link: link(sensor.link),
                kind: match sensor.kind {
                    SensorKind::ForceTorque { joint: id } => {
                        SensorKind::ForceTorque { joint: joint(id) }
                    }
                    kind => kind,
                },
                ..sensor
            }));
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
