//! terminalsAndIcons/terminalsAndIcons.xml of FMI 3: which variables belong together.
//!
//! A terminal, of matching rule `bus`, for each base, each joint with its commands and each sensor.
//! Members have the names that remain without the group's, so that two robots' joints fit together.
//!
//! Source: FMI 3.0 specification, section 2.4.9.

use super::shared::{DescribeError, clean};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use urdf2fmu_core::model::Model;
use urdf2fmu_core::slots::{InputSlot, OutputSlot};
use urdf2fmu_core::variables::{self, Entry, Slot, Variable, entries};

/// Name in the FMU.
pub const FILE_NAME: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// A terminal in the making.
struct Terminal {
    name: String,
    /// Name of the member, and of the variable.
    members: Vec<(String, String)>,
}

/// The XML text.
///
/// # Errors
/// [`DescribeError::Table`] if names clash.
pub fn terminals(model: &Model, table: &[Variable]) -> Result<Vec<u8>, DescribeError> {
    let mut terminals: Vec<Terminal> = Vec::new();
    // Names with dots say what belongs together, whatever names the FMU has.
    let mut dotted = model.clone();
    dotted.outputs.flat_names = false;
    let structured = variables::table(&dotted)?;
    let pairs = entries(model, table)?.into_iter();
    for (entry, shown) in entries(&dotted, &structured)?.iter().zip(pairs) {
        let Some((name, member)) = member(model, &structured, entry) else {
            continue;
        };
        let member = (member, shown.name);
        match terminals.iter_mut().find(|terminal| terminal.name == name) {
            Some(terminal) => terminal.members.push(member),
            None => terminals.push(Terminal {
                name,
                members: vec![member],
            }),
        }
    }
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("fmiTerminalsAndIcons")
        .with_attribute(("fmiVersion", "3.0"))
        .write_inner_content(|xml| {
            if terminals.is_empty() {
                return Ok(());
            }
            xml.create_element("Terminals").write_inner_content(|xml| {
                for terminal in &terminals {
                    xml.create_element("Terminal")
                        .with_attribute(("name", clean(&terminal.name).as_str()))
                        .with_attribute(("matchingRule", "bus"))
                        .write_inner_content(|xml| {
                            for (member, variable) in &terminal.members {
                                xml.create_element("TerminalMemberVariable")
                                    .with_attribute(("variableName", clean(variable).as_str()))
                                    .with_attribute(("memberName", clean(member).as_str()))
                                    .with_attribute(("variableKind", "signal"))
                                    .write_empty()?;
                            }
                            Ok(())
                        })?;
                }
                Ok(())
            })?;
            Ok(())
        })?;
    let mut text = xml.into_inner();
    text.push(b'\n');
    Ok(text)
}

/// Terminal and member of an entry, if it belongs to one.
fn member(model: &Model, table: &[Variable], entry: &Entry) -> Option<(String, String)> {
    let row = &table[entry.rows[0] as usize];
    let name = &entry.name;
    // Segments of a member's name: an element's has its vector's before it.
    let segments = match &row.part {
        Some(part) if entry.shape.is_empty() => {
            name.matches('.').count() - part.whole.matches('.').count() + 1
        }
        None if !entry.shape.is_empty() => 2,
        _ => 1,
    };
    let (at, _) = name.rmatch_indices('.').nth(segments - 1)?;
    let (group, member) = (name[..at].to_owned(), name[at + 1..].to_owned());
    if row.part.is_none() && !entry.shape.is_empty() {
        return Some((group, member));
    }
    match row.slot {
        Slot::Output(
            OutputSlot::BasePosition(..)
            | OutputSlot::BaseOrientation(..)
            | OutputSlot::BaseRpy(..)
            | OutputSlot::BaseLinearVelocity(..)
            | OutputSlot::BaseAngularVelocity(..)
            | OutputSlot::JointPosition(..)
            | OutputSlot::JointOrientation(..)
            | OutputSlot::JointVelocity(..)
            | OutputSlot::JointAcceleration(..)
            | OutputSlot::JointEffort(_)
            | OutputSlot::Sensor(..),
        ) => Some((group, member)),
        Slot::Input(
            InputSlot::Velocity(a)
            | InputSlot::Position(a)
            | InputSlot::Effort(a)
            | InputSlot::MaxEffort(a),
        ) => {
            let mut groups = model.outputs.groups.iter();
            if groups.any(|group| group.actuators.contains(&a)) {
                return Some((group, member));
            }
            // A joint's commands stand beside its state.
            let (at, _) = group.rmatch_indices("cmd.").next()?;
            let joint = format!("{}joint.{}", &group[..at], &group[at + 4..]);
            Some((joint, format!("cmd.{member}")))
        }
        _ => None,
    }
}
