//! Outputs: base, joints, links, contacts, energy, counters.

use super::build::{Group, RPY, Row, Table, XYZ, XYZW, axes, group, identifier, units};
use super::row::{Kind, Unit};
use crate::model::{JointId, JointKind, LinkId, PairId, RootId, RootKind};
use crate::slots::{Axis, OutputSlot};

/// Slots by axis.
type OfBase = fn(RootId, Axis) -> OutputSlot;
type OfJoint = fn(JointId, Axis) -> OutputSlot;
type OfLink = fn(LinkId, Axis) -> OutputSlot;
type OfPair = fn(PairId, Axis) -> OutputSlot;

impl Table<'_> {
    #[cfg_attr(small, optimize(size))]
    pub(super) fn base_outputs(&mut self) {
        for (id, root) in (0..).map(RootId).zip(&self.model.roots) {
            if self.model.floats(id) {
                let prefix = self.scope(id);
                let prefix = match root.kind {
                    RootKind::Robot => format!("{prefix}base"),
                    RootKind::Object => prefix.trim_end_matches('.').to_owned(),
                };
                self.outputs_of_base(id, &prefix);
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn outputs_of_base(&mut self, id: RootId, prefix: &str) {
        let base = self.model.base(id).link;
        let owner = format!("base link '{}'", self.model.links[base.index()].name);
        let groups: [Group<OfBase>; 5] = [
            group(
                "position",
                &XYZ,
                Unit::Meter,
                OutputSlot::BasePosition,
                "Position in the world of",
            ),
            group(
                "orientation",
                &XYZW,
                Unit::One,
                OutputSlot::BaseOrientation,
                "Orientation quaternion in the world of",
            ),
            group(
                "rpy",
                &RPY,
                Unit::Radian,
                OutputSlot::BaseRpy,
                "Fixed-axis roll, pitch, yaw in the world of",
            ),
            group(
                "linear_velocity",
                &XYZ,
                Unit::MeterPerSecond,
                OutputSlot::BaseLinearVelocity,
                "Velocity in world axes of the origin of",
            ),
            group(
                "angular_velocity",
                &XYZ,
                Unit::RadianPerSecond,
                OutputSlot::BaseAngularVelocity,
                "Angular velocity in world axes of",
            ),
        ];
        self.groups(&groups, |of, axis| of(id, axis), &owner, prefix);
    }

    /// Rows of a base, link or sensor, one for each axis of each group; `slot` says which slot a
    /// group's entry means.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn groups<S: Copy>(
        &mut self,
        groups: &[Group<S>],
        slot: impl Fn(S, Axis) -> OutputSlot,
        owner: &str,
        prefix: &str,
    ) {
        for group in groups {
            let first = self.len();
            for (axis, letter) in axes(group.axes) {
                let about = about!("{} {owner}, {letter}", group.about);
                let row = Row::output(slot(group.slot, axis), group.unit, about);
                self.add(format_args!("{prefix}.{}.{letter}", group.name), owner, row);
            }
            let about = about!("{} {owner}", group.about);
            self.vector(first, &format!("{prefix}.{}", group.name), &about);
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn joint_outputs(&mut self) {
        for (id, joint) in self.joints() {
            let owner = format!("joint '{}'", joint.name);
            let prefix = self.of_joint("joint", joint);
            match joint.kind {
                JointKind::Fixed => {}
                JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => {
                    let units = units(joint.kind);
                    let rows = [
                        (
                            "position",
                            OutputSlot::JointPosition(id, 0),
                            units.position,
                            "Position of",
                        ),
                        (
                            "velocity",
                            OutputSlot::JointVelocity(id, 0),
                            units.velocity,
                            "Velocity of",
                        ),
                        (
                            "acceleration",
                            OutputSlot::JointAcceleration(id, 0),
                            units.acceleration,
                            "Acceleration of",
                        ),
                        (
                            "effort",
                            OutputSlot::JointEffort(id),
                            units.effort,
                            "Effort of the motor alone of",
                        ),
                    ];
                    for (quantity, slot, unit, about) in rows {
                        let row = Row::output(slot, unit, about!("{about} {owner}"));
                        let row = row.of_joint(joint.kind);
                        self.add(format_args!("{prefix}.{quantity}"), &owner, row);
                    }
                }
                JointKind::Planar => self.planar_outputs(id, &owner, &prefix),
                JointKind::Floating => self.floating_outputs(id, &owner, &prefix),
                JointKind::Spherical => self.spherical_outputs(id, &owner, &prefix),
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn planar_outputs(&mut self, id: JointId, owner: &str, prefix: &str) {
        let groups: [(&str, OfJoint, [Unit; 2]); 3] = [
            (
                "position",
                OutputSlot::JointPosition,
                [Unit::Meter, Unit::Radian],
            ),
            (
                "velocity",
                OutputSlot::JointVelocity,
                [Unit::MeterPerSecond, Unit::RadianPerSecond],
            ),
            (
                "acceleration",
                OutputSlot::JointAcceleration,
                [Unit::MeterPerSecondSquared, Unit::RadianPerSecondSquared],
            ),
        ];
        for (group, slot, [sliding, turning]) in groups {
            for (axis, name) in axes(&["x", "y", "angle"]) {
                let unit = if name == "angle" { turning } else { sliding };
                let row = Row::output(
                    slot(id, axis),
                    unit,
                    about!("Planar {group} of {owner}, {name}"),
                );
                self.add(format_args!("{prefix}.{group}.{name}"), owner, row);
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn spherical_outputs(&mut self, id: JointId, owner: &str, prefix: &str) {
        let groups: [Group<OfJoint>; 3] = [
            group(
                "orientation",
                &XYZW,
                Unit::One,
                OutputSlot::JointOrientation,
                "quaternion, joint frame",
            ),
            group(
                "angular_velocity",
                &XYZ,
                Unit::RadianPerSecond,
                OutputSlot::JointVelocity,
                "child axes",
            ),
            group(
                "angular_acceleration",
                &XYZ,
                Unit::RadianPerSecondSquared,
                OutputSlot::JointAcceleration,
                "child axes",
            ),
        ];
        self.joint_groups("Spherical", &groups, id, owner, prefix);
    }

    #[cfg_attr(small, optimize(size))]
    fn floating_outputs(&mut self, id: JointId, owner: &str, prefix: &str) {
        let groups: [Group<OfJoint>; 6] = [
            group(
                "position",
                &XYZ,
                Unit::Meter,
                OutputSlot::JointPosition,
                "joint frame",
            ),
            group(
                "orientation",
                &XYZW,
                Unit::One,
                OutputSlot::JointOrientation,
                "quaternion, joint frame",
            ),
            group(
                "linear_velocity",
                &XYZ,
                Unit::MeterPerSecond,
                OutputSlot::JointVelocity,
                "joint frame",
            ),
            group(
                "angular_velocity",
                &XYZ,
                Unit::RadianPerSecond,
                |joint, axis| OutputSlot::JointVelocity(joint, axis + 3),
                "child axes",
            ),
            group(
                "linear_acceleration",
                &XYZ,
                Unit::MeterPerSecondSquared,
                OutputSlot::JointAcceleration,
                "joint frame",
            ),
            group(
                "angular_acceleration",
                &XYZ,
                Unit::RadianPerSecondSquared,
                |joint, axis| OutputSlot::JointAcceleration(joint, axis + 3),
                "child axes",
            ),
        ];
        self.joint_groups("Floating", &groups, id, owner, prefix);
    }

    #[cfg_attr(small, optimize(size))]
    fn joint_groups(
        &mut self,
        kind: &str,
        groups: &[Group<OfJoint>],
        id: JointId,
        owner: &str,
        prefix: &str,
    ) {
        for Group {
            name: group,
            axes: names,
            unit,
            slot,
            about,
        } in groups
        {
            let first = self.len();
            let about = about!("{kind} {} of {owner}, {about}", group.replace('_', " "));
            for (axis, name) in axes(names) {
                let row = Row::output(slot(id, axis), *unit, about!("{about}, {name}"));
                self.add(format_args!("{prefix}.{group}.{name}"), owner, row);
            }
            self.vector(first, &format!("{prefix}.{group}"), &about);
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn link_outputs(&mut self) {
        let groups: [Group<OfLink>; 4] = [
            group(
                "position",
                &XYZ,
                Unit::Meter,
                OutputSlot::LinkPosition,
                "Position in the world of the origin of",
            ),
            group(
                "orientation",
                &XYZW,
                Unit::One,
                OutputSlot::LinkOrientation,
                "Orientation quaternion in the world of",
            ),
            group(
                "linear_velocity",
                &XYZ,
                Unit::MeterPerSecond,
                OutputSlot::LinkLinearVelocity,
                "Velocity in world axes of the origin of",
            ),
            group(
                "angular_velocity",
                &XYZ,
                Unit::RadianPerSecond,
                OutputSlot::LinkAngularVelocity,
                "Angular velocity in world axes of",
            ),
        ];
        for &id in &self.model.outputs.links {
            let link = &self.model.links[id.index()];
            let owner = format!("link '{}'", link.name);
            let prefix = self.of_link("link", link);
            self.groups(&groups, |of, axis| of(id, axis), &owner, &prefix);
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn contact_outputs(&mut self) {
        let outputs = &self.model.outputs;
        for &id in &outputs.contacts {
            let link = &self.model.links[id.index()];
            let owner = format!("link '{}'", link.name);
            let prefix = self.of_link("contact", link);
            let about = about!("Whether {owner} touches something");
            let row = Row::output(OutputSlot::ContactActive(id), Unit::One, about);
            self.add(
                format_args!("{prefix}.active"),
                &owner,
                row.kind(Kind::Boolean),
            );
            let first = self.len();
            let about = about!(
                "Net contact force on {owner} in world axes, mean over the communication step"
            );
            for (axis, letter) in axes(&XYZ) {
                let slot = OutputSlot::ContactForce(id, axis);
                let row = Row::output(slot, Unit::Newton, about!("{about}, {letter}"));
                self.add(format_args!("{prefix}.force.{letter}"), &owner, row);
            }
            self.vector(first, &format!("{prefix}.force"), &about);
            let points: &[Group<OfLink>] = &[group(
                "point",
                &XYZ,
                Unit::Meter,
                OutputSlot::ContactPoint,
                "Position in the world where the normal forces act, else the origin, of",
            )];
            if outputs.contact_points {
                self.groups(points, |of, axis| of(id, axis), &owner, &prefix);
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn pair_outputs(&mut self) {
        let groups: [Group<OfPair>; 3] = [
            group(
                "force",
                &XYZ,
                Unit::Newton,
                OutputSlot::PairForce,
                "Force of the second side on the first in world axes, mean over the communication step:",
            ),
            group(
                "point",
                &XYZ,
                Unit::Meter,
                OutputSlot::PairPoint,
                "Position in the world where the normal forces act, else the origin of the first link:",
            ),
            group(
                "normal",
                &XYZ,
                Unit::One,
                OutputSlot::PairNormal,
                "Mean unit normal from the second side into the first in world axes, else 0:",
            ),
        ];
        for (p, pair) in self.model.outputs.pairs.iter().enumerate() {
            let id = PairId::from(p);
            let owner = format!("pair '{}'", pair.name);
            let prefix = format!("pair.{}", identifier(&pair.name));
            let about = about!("Whether the two sides press on each other: {owner}");
            let row = Row::output(OutputSlot::PairActive(id), Unit::One, about);
            self.add(
                format_args!("{prefix}.active"),
                &owner,
                row.kind(Kind::Boolean),
            );
            self.groups(&groups, |of, axis| of(id, axis), &owner, &prefix);
            let about = about!("Deepest overlap of the two sides, else 0: {owner}");
            let row = Row::output(OutputSlot::PairDepth(id), Unit::Meter, about);
            self.add(format_args!("{prefix}.depth"), &owner, row);
            let about = about!("Speed at which the two sides slide on each other, else 0: {owner}");
            let slot = OutputSlot::PairSlipSpeed(id);
            let row = Row::output(slot, Unit::MeterPerSecond, about);
            self.add(format_args!("{prefix}.slip_speed"), &owner, row);
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn common_outputs(&mut self) {
        let owner = "the robot";
        let energies = [
            (
                "kinetic",
                OutputSlot::EnergyKinetic,
                "Kinetic energy of all that forces move",
            ),
            (
                "potential",
                OutputSlot::EnergyPotential,
                "Potential energy of all that forces move in gravity, 0 at the world's origin, and of springs",
            ),
        ];
        for (name, slot, about) in energies {
            let row = Row::output(slot, Unit::Joule, about.to_owned());
            self.add(format_args!("energy.{name}"), owner, row);
        }
        if !self.model.outputs.interface.steps() {
            return;
        }
        let counters = [
            (
                "steps",
                OutputSlot::Steps,
                "Solver steps taken since the start",
            ),
            (
                "rejected",
                OutputSlot::Rejected,
                "Solver steps rejected since the start",
            ),
            (
                "newton_max",
                OutputSlot::NewtonMax,
                "Most Newton iterations of one solve since the start",
            ),
        ];
        for (name, slot, about) in counters {
            let row = Row::output(slot, Unit::One, about.to_owned()).kind(Kind::Integer);
            self.add(format_args!("solver.{name}"), owner, row);
        }
    }
}
