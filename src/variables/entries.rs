//! What FMI 3 lists: the table's rows one by one, or the vectors that they are elements of.

use super::build::{Table, identifier, is_scalar, styled};
use super::row::{Slot, TableError, Variable};
use crate::model::{Arrays, Model, RootId, RootKind};
use crate::slots::{InputSlot, OutputSlot};
use std::collections::BTreeMap;

/// A variable of FMI 3: a row, or several as one array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// That of its first row; entries that gather rows of many joints have numbers of their own,
    /// above [`time_reference`].
    pub value_reference: u32,
    /// The row's, or that of the whole.
    pub name: String,
    /// Says whose quantity it is.
    pub description: String,
    /// Empty for a scalar; else number of elements, or of rows and columns.
    pub shape: Vec<u32>,
    /// Rows of the table, in the order of the elements.
    pub rows: Vec<u32>,
}

/// Value reference of the independent variable.
pub fn time_reference(table: &[Variable]) -> u32 {
    // Rows are numbered so, and all of them have a number.
    u32::try_from(table.len()).unwrap_or(u32::MAX)
}

/// The entries of a table, in its order; what gathers joints comes first. `model.outputs.arrays`
/// says what is an array.
///
/// # Errors
/// [`TableError`] if the name of an array is that of another entry.
pub fn entries(model: &Model, table: &[Variable]) -> Result<Vec<Entry>, TableError> {
    let arrays = model.outputs.arrays;
    let mut entries = Vec::with_capacity(table.len());
    let mut taken = vec![false; table.len()];
    if arrays == Arrays::All {
        let references = time_reference(table) + 1..;
        for (value_reference, gathered) in references.zip(gathered(model, table)) {
            if matches!(table[gathered.rows[0] as usize].slot, Slot::Input(_)) {
                for row in &gathered.rows {
                    taken[*row as usize] = true;
                }
            }
            entries.push(Entry {
                value_reference,
                ..gathered
            });
        }
    }
    for (row, taken) in table.iter().zip(taken) {
        let input = matches!(row.slot, Slot::Input(_));
        let part = row.part.as_ref().filter(|_| match arrays {
            Arrays::None => false,
            Arrays::Vectors => !input,
            Arrays::All => true,
        });
        let first = row.value_reference;
        match part {
            _ if taken => {}
            None => entries.push(Entry {
                value_reference: first,
                name: row.name.clone(),
                description: row.description.clone(),
                shape: Vec::new(),
                rows: vec![first],
            }),
            Some(part) if part.index == 0 => entries.push(Entry {
                value_reference: first,
                name: part.whole.clone(),
                description: part.description.clone(),
                shape: part.shape.clone(),
                rows: (first..first + part.shape.iter().product::<u32>()).collect(),
            }),
            Some(_) => {}
        }
    }
    let mut names = BTreeMap::new();
    for entry in &entries {
        if let Some(first) = names.insert(entry.name.as_str(), entry) {
            return Err(TableError::Clash {
                first: first.description.clone(),
                second: entry.description.clone(),
                name: entry.name.clone(),
            });
        }
    }
    Ok(entries)
}

/// Vectors over the joints of each robot: states, and commands.
fn gathered(model: &Model, table: &[Variable]) -> Vec<Entry> {
    let builder = Table::new(model);
    let mut gathered = Vec::new();
    for (id, root) in (0..).map(RootId).zip(&model.roots) {
        if root.kind != RootKind::Robot {
            continue;
        }
        let scope = builder.scope(id);
        let of_joint = |joint: usize| {
            let joint = &model.joints[joint];
            let body = model.links[joint.child.index()].body;
            is_scalar(joint) && model.root_of(body) == id
        };
        let of_actuator = |actuator: usize| of_joint(model.actuators[actuator].joint.index());
        let quantity = |slot: &Slot| match *slot {
            Slot::Output(OutputSlot::JointPosition(j, _)) if of_joint(j.index()) => {
                Some(("joint.position", "Positions of the joints"))
            }
            Slot::Output(OutputSlot::JointVelocity(j, _)) if of_joint(j.index()) => {
                Some(("joint.velocity", "Velocities of the joints"))
            }
            Slot::Output(OutputSlot::JointEffort(j)) if of_joint(j.index()) => {
                Some(("joint.effort", "Efforts of the motors alone of the joints"))
            }
            Slot::Input(InputSlot::Position(a)) if of_actuator(a.index()) => {
                Some(("cmd.position", "Commanded positions of"))
            }
            Slot::Input(InputSlot::Velocity(a)) if of_actuator(a.index()) => {
                Some(("cmd.velocity", "Commanded velocities of"))
            }
            Slot::Input(InputSlot::Effort(a)) if of_actuator(a.index()) => {
                Some(("cmd.effort", "Commanded efforts of"))
            }
            Slot::Input(InputSlot::MaxEffort(a)) if of_actuator(a.index()) => {
                Some(("cmd.max_effort", "Most efforts of the motors of"))
            }
            _ => None,
        };
        let mut found: Vec<(&str, &str, Vec<u32>)> = Vec::new();
        for row in table {
            let Some((name, about)) = quantity(&row.slot) else {
                continue;
            };
            match found.iter_mut().find(|(known, ..)| *known == name) {
                Some((.., rows)) => rows.push(row.value_reference),
                None => found.push((name, about, vec![row.value_reference])),
            }
        }
        for (name, about, rows) in found {
            let whose = rows.iter().map(|row| whose(model, table, *row));
            let whose: Vec<String> = whose.collect();
            gathered.push(Entry {
                value_reference: 0,
                name: styled(model, format!("{scope}robot.{name}")),
                description: format!("{about} {}", whose.join(", ")),
                shape: vec![u32::try_from(rows.len()).unwrap_or(u32::MAX)],
                rows,
            });
        }
    }
    gathered
}

/// The joint, or the group of joints, that a row of [`gathered`] is of.
fn whose(model: &Model, table: &[Variable], row: u32) -> String {
    let actuator = match table[row as usize].slot {
        Slot::Output(
            OutputSlot::JointPosition(joint, _)
            | OutputSlot::JointVelocity(joint, _)
            | OutputSlot::JointEffort(joint),
        ) => return identifier(&model.joints[joint.index()].name),
        Slot::Input(
            InputSlot::Position(a)
            | InputSlot::Velocity(a)
            | InputSlot::Effort(a)
            | InputSlot::MaxEffort(a),
        ) => a,
        _ => return String::new(),
    };
    let mut groups = model.outputs.groups.iter();
    let joint = model.actuators[actuator.index()].joint;
    let group = groups.find(|group| group.actuators.contains(&actuator));
    let name = group.map_or(&model.joints[joint.index()].name, |group| &group.name);
    identifier(name)
}
