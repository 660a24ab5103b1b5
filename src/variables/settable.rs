//! Variables that can be set: inputs and parameters.

use super::build::{Group, RPY, Row, Table, XYZ, axes, group, identifier, is_scalar, units};
use super::row::Unit;
use crate::model::{Actuator, ActuatorId, ActuatorMode, Limits, LinkId, Root, RootId, RootKind};
use crate::slots::{Axis, InputSlot, ParameterSlot};

/// Slots by axis.
type OfAxis = fn(RootId, Axis) -> ParameterSlot;

/// What the inputs of an actuator drive: a joint, or a group of them.
struct Driven {
    owner: String,
    prefix: String,
    limits: Option<Limits>,
    velocity: Option<f64>,
    effort: Option<f64>,
}

impl Table<'_> {
    #[cfg_attr(small, optimize(size))]
    pub(super) fn inputs(&mut self) {
        for (a, actuator) in self.model.actuators.iter().enumerate() {
            if let Some(driven) = self.driven(a) {
                self.commands(ActuatorId::from(a), actuator, &driven);
            }
        }
        for &id in &self.model.outputs.external_wrenches {
            let link = &self.model.links[id.index()];
            let owner = format!("link '{}'", link.name);
            let prefix = self.of_link("ext", link);
            let first = self.len();
            let whole = about!("Force on {owner} at its centre of mass, world");
            for (axis, letter) in axes(&XYZ) {
                let slot = InputSlot::ExternalForce(id, axis);
                let row = Row::input(slot, Unit::Newton, 0.0, about!("{whole} {letter}"));
                self.add(format_args!("{prefix}.force.{letter}"), &owner, row);
            }
            self.vector(first, &format!("{prefix}.force"), &about!("{whole} axes"));
            let first = self.len();
            let whole = about!("Torque on {owner}, world");
            for (axis, letter) in axes(&XYZ) {
                let slot = InputSlot::ExternalTorque(id, axis);
                let row = Row::input(slot, Unit::NewtonMeter, 0.0, about!("{whole} {letter}"));
                self.add(format_args!("{prefix}.torque.{letter}"), &owner, row);
            }
            self.vector(first, &format!("{prefix}.torque"), &about!("{whole} axes"));
        }
    }

    /// Inputs of surfaces that move.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn conveyors(&mut self) {
        for &id in &self.model.outputs.conveyors {
            let owner = format!("'{}'", self.model.roots[id.index()].name);
            let scope = self.scope(id);
            let first = self.len();
            let whole = about!("Velocity of the surface of {owner} along its own");
            for (axis, letter) in axes(&XYZ) {
                let slot = InputSlot::SurfaceVelocity(id, axis);
                let about = about!("{whole} {letter}");
                let row = Row::input(slot, Unit::MeterPerSecond, 0.0, about);
                self.add(
                    format_args!("{scope}surface.velocity.{letter}"),
                    &owner,
                    row,
                );
            }
            let name = format!("{scope}surface.velocity");
            self.vector(first, &name, &about!("{whole} axes"));
        }
    }

    /// Inputs of bases that move as they say.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn driven_bases(&mut self) {
        type OfBase = fn(RootId, Axis) -> InputSlot;
        for &id in &self.model.outputs.driven {
            let root = &self.model.roots[id.index()];
            let owner = format!("'{}'", root.name);
            let scope = self.scope(id);
            let kinds: [(OfBase, Unit, &str, &str, _); 2] = [
                (
                    InputSlot::BaseLinearVelocity,
                    Unit::MeterPerSecond,
                    "linear",
                    "Velocity of the origin",
                    root.linear_velocity,
                ),
                (
                    InputSlot::BaseAngularVelocity,
                    Unit::RadianPerSecond,
                    "angular",
                    "Angular velocity",
                    root.angular_velocity,
                ),
            ];
            for (slot, unit, kind, what, start) in kinds {
                let first = self.len();
                let whole = about!("{what} of {owner} at the end of the next step, world");
                for (axis, letter) in axes(&XYZ) {
                    let about = about!("{whole} {letter}");
                    let row = Row::input(slot(id, axis), unit, start[usize::from(axis)], about);
                    let name = format_args!("{scope}cmd.{kind}_velocity.{letter}");
                    self.add(name, &owner, row);
                }
                let name = format!("{scope}cmd.{kind}_velocity");
                self.vector(first, &name, &about!("{whole} axes"));
            }
        }
    }

    /// What an actuator's inputs drive: its joint, or its group if it is the first of it, else
    /// none.
    #[cfg_attr(small, optimize(size))]
    fn driven(&self, actuator: usize) -> Option<Driven> {
        let id = ActuatorId::from(actuator);
        let groups = &self.model.outputs.groups;
        let joint_of = |a: &ActuatorId| {
            let joint = self.model.actuators[a.index()].joint;
            &self.model.joints[joint.index()]
        };
        let Some(group) = groups.iter().find(|group| group.actuators.contains(&id)) else {
            let joint = joint_of(&id);
            return Some(Driven {
                owner: format!("joint '{}'", joint.name),
                prefix: self.of_joint("cmd", joint),
                limits: self.limits(joint),
                velocity: joint.velocity,
                effort: joint.effort,
            });
        };
        // Within what every joint of the group can do.
        let least =
            |values: &mut dyn Iterator<Item = Option<f64>>| values.flatten().min_by(f64::total_cmp);
        let joints = || group.actuators.iter().map(joint_of);
        let limits = joints().filter_map(|joint| self.limits(joint));
        let limits = limits.reduce(|a, b| Limits {
            lower: a.lower.max(b.lower),
            upper: a.upper.min(b.upper),
        });
        (group.actuators.first() == Some(&id)).then(|| Driven {
            owner: format!("group '{}'", group.name),
            prefix: format!("cmd.{}", identifier(&group.name)),
            limits: limits.filter(|l| l.lower <= l.upper),
            velocity: least(&mut joints().map(|joint| joint.velocity)),
            effort: least(&mut joints().map(|joint| joint.effort)),
        })
    }

    #[cfg_attr(small, optimize(size))]
    fn commands(&mut self, id: ActuatorId, actuator: &Actuator, driven: &Driven) {
        let joint = &self.model.joints[actuator.joint.index()];
        let start = self.model.initial.joint_positions[actuator.joint.index()];
        let units = units(joint.kind);
        let Driven {
            owner,
            prefix,
            limits,
            velocity,
            effort,
        } = driven;
        let mode = actuator.mode;
        let pd = mode == ActuatorMode::Pd;
        if pd || mode == ActuatorMode::Position {
            let about = about!("Commanded position of {owner}");
            let row = Row::input(InputSlot::Position(id), units.position, start, about);
            self.add(
                format_args!("{prefix}.position"),
                owner,
                row.limits(*limits),
            );
        }
        if pd || mode == ActuatorMode::Velocity {
            let about = about!("Commanded velocity of {owner}");
            let row = Row::input(InputSlot::Velocity(id), units.velocity, 0.0, about);
            let row = row.of_joint(joint.kind);
            self.add(
                format_args!("{prefix}.velocity"),
                owner,
                row.symmetric(*velocity),
            );
        }
        if pd || mode == ActuatorMode::Effort {
            let about = about!("Commanded effort of {owner}");
            let row = Row::input(InputSlot::Effort(id), units.effort, 0.0, about);
            self.add(
                format_args!("{prefix}.effort"),
                owner,
                row.symmetric(*effort),
            );
        }
        if mode != ActuatorMode::Effort {
            let about = about!("Most effort that the motor of {owner} gives; 0 lets it go");
            let start = actuator.max_effort;
            let row = Row::input(InputSlot::MaxEffort(id), units.effort, start, about);
            self.add(
                format_args!("{prefix}.max_effort"),
                owner,
                row.not_negative(),
            );
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn initial_parameters(&mut self) {
        for (id, root) in (0..).map(RootId).zip(&self.model.roots) {
            self.initial_base(id, root);
        }
        self.initial_joints();
    }

    #[cfg_attr(small, optimize(size))]
    fn initial_base(&mut self, id: RootId, initial: &Root) {
        let base = self.model.base(id).link;
        let owner = format!("base link '{}'", self.model.links[base.index()].name);
        let name = match initial.kind {
            RootKind::Robot => format!("{}initial.base", self.scope(id)),
            RootKind::Object => format!("initial.{}", self.scope(id).trim_end_matches('.')),
        };
        let groups: [(Group<OfAxis>, [f64; 3]); 4] = [
            (
                group(
                    "position",
                    &XYZ,
                    Unit::Meter,
                    ParameterSlot::InitialBasePosition,
                    "Initial position in the world of",
                ),
                initial.position.into(),
            ),
            (
                group(
                    "rpy",
                    &RPY,
                    Unit::Radian,
                    ParameterSlot::InitialBaseRpy,
                    "Initial fixed-axis roll, pitch, yaw of",
                ),
                initial.rpy.into(),
            ),
            (
                group(
                    "linear_velocity",
                    &XYZ,
                    Unit::MeterPerSecond,
                    ParameterSlot::InitialBaseLinearVelocity,
                    "Initial velocity in world axes of the origin of",
                ),
                initial.linear_velocity.into(),
            ),
            (
                group(
                    "angular_velocity",
                    &XYZ,
                    Unit::RadianPerSecond,
                    ParameterSlot::InitialBaseAngularVelocity,
                    "Initial angular velocity in world axes of",
                ),
                initial.angular_velocity.into(),
            ),
        ];
        // A fixed base can be mounted anywhere, but does not move; a driven one moves as its inputs
        // say.
        let moved = self.model.floats(id) && !self.model.is_driven(id);
        let count = if moved { 4 } else { 2 };
        for (
            Group {
                name: group,
                axes: names,
                unit,
                slot,
                about,
            },
            starts,
        ) in groups.into_iter().take(count)
        {
            let first = self.len();
            let about = about!("{about} {owner}");
            for ((axis, axis_name), start) in axes(names).zip(starts) {
                let row =
                    Row::parameter(slot(id, axis), unit, start, about!("{about}, {axis_name}"));
                self.add(format_args!("{name}.{group}.{axis_name}"), &owner, row);
            }
            self.vector(first, &format!("{name}.{group}"), &about);
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn initial_joints(&mut self) {
        let initial = &self.model.initial;
        for (id, joint) in self.independent_joints() {
            let owner = format!("joint '{}'", joint.name);
            let prefix = self.of_joint("initial.joint", joint);
            let units = units(joint.kind);
            let start = initial.joint_positions[id.index()];
            let slot = ParameterSlot::InitialJointPosition(id);
            let about = about!("Initial position of {owner}");
            let row = Row::parameter(slot, units.position, start, about);
            self.add(
                format_args!("{prefix}.position"),
                &owner,
                row.limits(self.limits(joint)),
            );
            let start = initial.joint_velocities[id.index()];
            let slot = ParameterSlot::InitialJointVelocity(id);
            let about = about!("Initial velocity of {owner}");
            let row = Row::parameter(slot, units.velocity, start, about).of_joint(joint.kind);
            self.add(
                format_args!("{prefix}.velocity"),
                &owner,
                row.symmetric(joint.velocity),
            );
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn tunable_parameters(&mut self) {
        let model = self.model;
        for (a, actuator) in model.actuators.iter().enumerate() {
            if actuator.mode != ActuatorMode::Pd {
                continue;
            }
            let Some(Driven { owner, prefix, .. }) = self.driven(a) else {
                continue;
            };
            let id = ActuatorId::from(a);
            let joint = &model.joints[actuator.joint.index()];
            let units = units(joint.kind);
            let rows = [
                (
                    "kp",
                    ParameterSlot::Kp(id),
                    units.stiffness,
                    actuator.kp,
                    "Position gain of",
                ),
                (
                    "kd",
                    ParameterSlot::Kd(id),
                    units.damping,
                    actuator.kd,
                    "Velocity gain of",
                ),
            ];
            for (name, slot, unit, start, about) in rows {
                let row = Row::parameter(slot, unit, start, about!("{about} {owner}"));
                self.add(format_args!("{prefix}.{name}"), &owner, row.not_negative());
            }
        }
        for (id, joint) in self.joints().filter(|(_, joint)| is_scalar(joint)) {
            let owner = format!("joint '{}'", joint.name);
            let prefix = self.of_joint("joint", joint);
            let units = units(joint.kind);
            let rows = [
                (
                    "damping",
                    ParameterSlot::JointDamping(id),
                    units.damping,
                    joint.damping,
                    "Viscous damping of",
                ),
                (
                    "friction",
                    ParameterSlot::JointFriction(id),
                    units.effort,
                    joint.friction,
                    "Dry friction of",
                ),
            ];
            for (name, slot, unit, start, about) in rows {
                let row = Row::parameter(slot, unit, start, about!("{about} {owner}"));
                self.add(format_args!("{prefix}.{name}"), &owner, row.not_negative());
            }
        }
        self.link_parameters();
        let first = self.len();
        for ((axis, letter), start) in axes(&XYZ).zip(model.world.gravity.iter().copied()) {
            let slot = ParameterSlot::Gravity(axis);
            let about = about!("Gravity, world {letter}");
            let row = Row::parameter(slot, Unit::MeterPerSecondSquared, start, about);
            self.add(format_args!("world.gravity.{letter}"), "the world", row);
        }
        self.vector(first, "world.gravity", "Gravity, world axes");
        if let Some(ground) = &model.world.ground {
            let about = "Coulomb coefficient of the ground".to_owned();
            let slot = ParameterSlot::GroundFriction;
            let row = Row::parameter(slot, Unit::One, ground.friction, about).not_negative();
            self.add(format_args!("world.ground.friction"), "the ground", row);
            let about = "Newton's coefficient of restitution of the ground".to_owned();
            let slot = ParameterSlot::GroundRestitution;
            let row = Row::parameter(slot, Unit::One, ground.restitution, about);
            let row = row.within(Some(0.0), Some(1.0));
            self.add(format_args!("world.ground.restitution"), "the ground", row);
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn link_parameters(&mut self) {
        let model = self.model;
        for (l, link) in model.links.iter().enumerate() {
            let id = LinkId::from(l);
            let owner = format!("link '{}'", link.name);
            let prefix = self.of_link("link", link);
            if model.colliders.iter().any(|collider| collider.link == id) {
                let about = about!("Coulomb coefficient of the surface of {owner}");
                let slot = ParameterSlot::LinkFriction(id);
                let row = Row::parameter(slot, Unit::One, link.friction, about);
                self.add(
                    format_args!("{prefix}.friction"),
                    &owner,
                    row.not_negative(),
                );
            }
            if link.inertia.mass > 0.0 {
                let about = about!("Mass of {owner}; its rotational inertia scales with it");
                let slot = ParameterSlot::LinkMass(id);
                let row = Row::parameter(slot, Unit::Kilogram, link.inertia.mass, about);
                self.add(format_args!("{prefix}.mass"), &owner, row.not_negative());
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(super) fn solver_parameters(&mut self) {
        if !self.model.outputs.interface.steps() {
            return;
        }
        let solver = &self.model.solver;
        let about = "Fixed solver step; 0: error controlled".to_owned();
        let row = Row::parameter(
            ParameterSlot::StepSize,
            Unit::Second,
            solver.step_size,
            about,
        );
        self.add(
            format_args!("solver.step_size"),
            "the solver",
            row.not_negative(),
        );
        let about =
            "Error allowed per step in m, and in rad at 1 m reach; 0: the importer's, else 1e-3";
        let slot = ParameterSlot::Tolerance;
        let row = Row::parameter(slot, Unit::One, solver.tolerance, about.to_owned());
        self.add(
            format_args!("solver.tolerance"),
            "the solver",
            row.not_negative(),
        );
        let about = "Most tries of a solver step in a communication step of up to 1 s, and in each \
                     second of a longer one";
        let slot = ParameterSlot::MaxSteps;
        let row = Row::parameter(slot, Unit::One, solver.max_steps, about.to_owned());
        self.add(
            format_args!("solver.max_steps"),
            "the solver",
            row.not_negative(),
        );
    }
}
