//! What each output depends on while the FMU initialises.
//!
//! Positions and velocities depend on the initial values only; accelerations, efforts, contact
//! forces and energies follow from the dynamics and may depend on everything. So does the pose of a
//! base that is set down: it sinks and tilts as the ground carries it, by its weight and whatever
//! else acts on it. Outputs between steps depend on nothing that an importer sets at that time (see
//! [`crate::describe`]).

use urdf2fmu_core::model::{BodyId, JointId, JointKind, Model};
use urdf2fmu_core::simulation::{OutputSlot, ParameterSlot, Sensed};
use urdf2fmu_core::variables::{Slot, Variable};

/// Indexes (from 1, ascending) of the table's inputs and parameters that `output` follows in
/// initialisation mode; none where it may follow all of them.
pub fn initial_dependencies(
    model: &Model,
    table: &[Variable],
    output: OutputSlot,
) -> Option<Vec<usize>> {
    let follows = Follows::new(model, output)?;
    if follows.has_pose() && model.roots.iter().any(|root| root.set_down) {
        return None;
    }
    Some(
        (1..)
            .zip(table)
            .filter(|(_, v)| matches!(v.slot, Slot::Parameter(p) if follows.parameter(p)))
            .map(|(index, _)| index)
            .collect(),
    )
}

/// Indexes (from 1, ascending) of the rows that an unknown of Model Exchange is a function of:
/// continuous states alone; none where inputs matter, or all states do.
pub fn dependencies(table: &[Variable], row: &Variable) -> Option<Vec<usize>> {
    use OutputSlot as O;
    let Slot::Output(slot) = row.slot else {
        return None;
    };
    let states = || (1..).zip(table).filter(|(_, v)| v.state.is_some());
    let those = |wanted: &dyn Fn(O) -> bool| -> Option<Vec<usize>> {
        let of = states().filter(|(_, v)| matches!(v.slot, Slot::Output(slot) if wanted(slot)));
        Some(of.map(|(index, _)| index).collect())
    };
    if row.state.is_some() {
        return those(&|other| other == slot);
    }
    match slot {
        O::Rate(id) => {
            let state = table.iter().find(|v| v.state == Some(id))?;
            let Slot::Output(state) = state.slot else {
                return None;
            };
            match state {
                O::BasePosition(root, axis) => those(&|o| o == O::BaseLinearVelocity(root, axis)),
                O::JointPosition(joint, axis) => those(&|o| o == O::JointVelocity(joint, axis)),
                O::BaseOrientation(root, _) => those(
                    &|o| matches!(o, O::BaseOrientation(r, _) | O::BaseAngularVelocity(r, _) if r == root),
                ),
                O::JointOrientation(joint, _) => those(
                    &|o| matches!(o, O::JointOrientation(j, _) | O::JointVelocity(j, _) if j == joint),
                ),
                _ => None,
            }
        }
        // What follows from positions and velocities alone; gravity counts for energies, too.
        O::BasePosition(..)
        | O::BaseOrientation(..)
        | O::BaseRpy(..)
        | O::BaseLinearVelocity(..)
        | O::BaseAngularVelocity(..)
        | O::JointPosition(..)
        | O::JointOrientation(..)
        | O::JointVelocity(..)
        | O::LinkPosition(..)
        | O::LinkOrientation(..)
        | O::LinkLinearVelocity(..)
        | O::LinkAngularVelocity(..)
        | O::SpringLength(_)
        | O::SpringForce(..)
        | O::Sensor(
            _,
            Sensed::Orientation(_)
            | Sensed::AngularVelocity(_)
            | Sensed::Distance(_)
            | Sensed::Hit(_)
            | Sensed::Position
            | Sensed::Velocity,
        ) => those(&|o| !matches!(o, O::State(_))),
        _ => None,
    }
}

/// Which initial values matter to one output.
#[expect(
    clippy::struct_excessive_bools,
    reason = "one for each group of initial values"
)]
#[derive(Clone, Copy, Debug, Default)]
struct Follows {
    base_position: bool,
    base_rpy: bool,
    base_linear_velocity: bool,
    base_angular_velocity: bool,
    joint_positions: Joints,
    joint_velocities: Joints,
}

#[derive(Clone, Copy, Debug, Default)]
enum Joints {
    #[default]
    None,
    One(JointId),
    All,
}

impl Joints {
    fn has(self, joint: JointId) -> bool {
        match self {
            Self::None => false,
            Self::One(id) => id == joint,
            Self::All => true,
        }
    }
}

impl Follows {
    /// None where the output comes out of the dynamics, or of closed loops, which may move all.
    #[expect(clippy::too_many_lines, reason = "one line for each kind of output")]
    fn new(model: &Model, output: OutputSlot) -> Option<Self> {
        let none = Self::default();
        if !model.loops.is_empty() && !output.counts() {
            return None;
        }
        let pose = Self {
            base_position: true,
            base_rpy: true,
            joint_positions: Joints::All,
            ..none
        };
        // A mimic joint moves with the one that it follows.
        let leader = |joint: JointId| {
            let leader = model.joints[joint.index()].mimic.map_or(joint, |m| m.joint);
            Joints::One(leader)
        };
        // The joint of a floating base: its motion is the base's.
        let is_base = |joint: JointId| {
            let joint = &model.joints[joint.index()];
            joint.kind == JointKind::Floating && joint.bodies.as_slice() == [BodyId(0)]
        };
        Some(match output {
            OutputSlot::BasePosition(..) => Self {
                base_position: true,
                ..none
            },
            OutputSlot::BaseOrientation(..) | OutputSlot::BaseRpy(..) => Self {
                base_rpy: true,
                ..none
            },
            OutputSlot::BaseLinearVelocity(..) => Self {
                base_linear_velocity: true,
                ..none
            },
            OutputSlot::BaseAngularVelocity(..) => Self {
                base_angular_velocity: true,
                ..none
            },
            OutputSlot::JointPosition(joint, _) if is_base(joint) => Self {
                base_position: true,
                ..none
            },
            OutputSlot::JointOrientation(joint, _) if is_base(joint) => Self {
                base_rpy: true,
                ..none
            },
            // Its angular part is expressed in the child's axes.
            OutputSlot::JointVelocity(joint, _) if is_base(joint) => Self {
                base_rpy: true,
                base_linear_velocity: true,
                base_angular_velocity: true,
                ..none
            },
            OutputSlot::JointPosition(joint, _) | OutputSlot::JointOrientation(joint, _) => Self {
                joint_positions: leader(joint),
                ..none
            },
            OutputSlot::JointVelocity(joint, _) => Self {
                joint_velocities: leader(joint),
                ..none
            },
            OutputSlot::LinkPosition(..) => pose,
            OutputSlot::LinkOrientation(..) | OutputSlot::Sensor(_, Sensed::Orientation(_)) => {
                Self {
                    base_position: false,
                    ..pose
                }
            }
            // The velocity of a point turns with the robot and grows with its distance from the
            // axes.
            OutputSlot::LinkLinearVelocity(..) => Self {
                base_position: false,
                base_linear_velocity: true,
                base_angular_velocity: true,
                joint_velocities: Joints::All,
                ..pose
            },
            OutputSlot::LinkAngularVelocity(..)
            | OutputSlot::Sensor(_, Sensed::AngularVelocity(_)) => Self {
                base_position: false,
                base_angular_velocity: true,
                joint_velocities: Joints::All,
                ..pose
            },
            // Counters start at zero whatever is set.
            OutputSlot::Steps | OutputSlot::Rejected | OutputSlot::NewtonMax => none,
            OutputSlot::JointAcceleration(..)
            | OutputSlot::JointEffort(_)
            | OutputSlot::ContactActive(_)
            | OutputSlot::ContactForce(..)
            | OutputSlot::ContactPoint(..)
            | OutputSlot::PairActive(_)
            | OutputSlot::PairForce(..)
            | OutputSlot::PairPoint(..)
            | OutputSlot::PairNormal(..)
            | OutputSlot::PairDepth(_)
            | OutputSlot::PairSlipSpeed(_)
            | OutputSlot::LoopForce(..)
            | OutputSlot::LoopTorque(..)
            | OutputSlot::LoopEffort(_)
            | OutputSlot::LoopGap(_)
            | OutputSlot::SpringForce(..)
            | OutputSlot::SpringLength(_)
            | OutputSlot::Sensor(..)
            | OutputSlot::EnergyKinetic
            | OutputSlot::EnergyPotential
            | OutputSlot::State(_)
            | OutputSlot::Rate(_)
            | OutputSlot::Indicator => return None,
        })
    }

    /// Whether the pose of a base matters.
    fn has_pose(self) -> bool {
        self.base_position || self.base_rpy
    }

    fn parameter(self, slot: ParameterSlot) -> bool {
        match slot {
            ParameterSlot::InitialBasePosition(..) => self.base_position,
            ParameterSlot::InitialBaseRpy(..) => self.base_rpy,
            ParameterSlot::InitialBaseLinearVelocity(..) => self.base_linear_velocity,
            ParameterSlot::InitialBaseAngularVelocity(..) => self.base_angular_velocity,
            ParameterSlot::InitialJointPosition(joint) => self.joint_positions.has(joint),
            ParameterSlot::InitialJointVelocity(joint) => self.joint_velocities.has(joint),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{dependencies, initial_dependencies};
    use std::path::Path;
    use urdf2fmu_core::model::Interface;
    use urdf2fmu_core::settings::Settings;
    use urdf2fmu_core::simulation::OutputSlot;
    use urdf2fmu_core::urdf::{ReadOptions, read};
    use urdf2fmu_core::variables::{Slot, Variable, table};
    use urdf2fmu_core::{assemble, model::Model};

    /// The rover, whose base begins at a height, m, or is set down.
    fn rover(height: Option<f64>) -> (Model, Vec<Variable>) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/rover.urdf");
        let robot = read(&file, &ReadOptions::default()).expect("a robot");
        let mut settings = Settings::default();
        settings.fmu.interface = Interface::Both;
        settings.initial.z = height;
        let model = assemble::build(&robot, &settings).expect("a model").model;
        let table = table(&model).expect("a table");
        (model, table)
    }

    fn slot(table: &[Variable], name: &str) -> OutputSlot {
        match table
            .iter()
            .find(|v| v.name == name)
            .expect("a variable")
            .slot
        {
            Slot::Output(slot) => slot,
            other => panic!("{name} is {other:?}"),
        }
    }

    #[test]
    fn the_initial_pose_of_a_base_that_is_set_down_follows_everything() {
        let count = |height: Option<f64>, name: &str| {
            let (model, table) = rover(height);
            let found = initial_dependencies(&model, &table, slot(&table, name));
            found.map(|list| list.len())
        };
        for name in ["base.position.x", "base.orientation.x", "base.rpy.roll"] {
            assert_eq!(count(None, name), None, "{name}");
            assert_eq!(count(Some(1.0), name), Some(3), "{name}");
        }
        // No joint moves while it sinks.
        let joint = "joint.left_front_wheel_joint.position";
        assert_eq!(count(None, joint), Some(1));
        assert_eq!(count(None, "base.linear_velocity.x"), Some(3));
    }

    #[test]
    fn energies_may_follow_everything_and_poses_follow_states() {
        let (_, table) = rover(None);
        let found = |name: &str| {
            let row = table.iter().find(|v| v.name == name).expect("a variable");
            dependencies(&table, row)
        };
        assert_eq!(found("energy.kinetic"), None);
        assert_eq!(found("energy.potential"), None);
        assert!(found("base.rpy.roll").is_some());
    }
}
