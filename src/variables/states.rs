//! Continuous states and their derivatives, which Model Exchange lists.

use super::build::{Row, Table, XYZ, axes, identifier, units};
use super::row::{Slot, Unit};
use crate::continuous::{Element, Events, Relaxing, States};
use crate::model::{JointId, LinkId, StateId};
use crate::parameters::Parameters;
use crate::slots::OutputSlot;
use crate::tree::Tree;

impl Table<'_> {
    /// States that are no other output, and the derivatives of all.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn state_outputs(&mut self) {
        if !self.model.outputs.interface.exchanges() {
            return;
        }
        let tree = Tree::new(self.model, &Parameters::new(self.model));
        let states = States::of(self.model, &tree);
        for element in states.memory.iter() {
            self.memory_outputs(&states, element);
        }
        // What is one state after the other may be elements of a whole, and so may the derivatives.
        let mut rows = Vec::with_capacity(states.len());
        for (id, state) in (0..).map(StateId).zip(states.iter()) {
            let own = Slot::Output(state.output.unwrap_or(OutputSlot::State(id)));
            let row = self.find(own).expect("positions and velocities are listed");
            self.is_state(row, id, state.nominal);
            rows.push(row);
        }
        for (id, row) in (0..).map(StateId).zip(rows) {
            self.derivative_of(row, id);
        }
        if Events::indicators(self.model) > 0 {
            let about = about!("How far from leaving is what touches; below 0 an event");
            let row = Row::output(OutputSlot::Indicator, Unit::One, about);
            self.add(format_args!("event.leaving"), "the event indicator", row);
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn memory_outputs(&mut self, states: &States, element: &Element) {
        let id = |axis: usize| StateId::from(element.first + axis);
        match element.what {
            Relaxing::Slip | Relaxing::Turn => {
                let (group, unit, about) = if element.what == Relaxing::Slip {
                    (
                        "contact",
                        Unit::Meter,
                        "Elastic displacement of the friction of",
                    )
                } else {
                    (
                        "turning",
                        Unit::Radian,
                        "Elastic angle of the friction against turning of",
                    )
                };
                let same = |e: &&Element| (e.what, e.links) == (element.what, element.links);
                let several = states.memory.iter().filter(same).count() > 1;
                let (mut name, owner) = self.of_contact(group, element.links);
                if several {
                    name = format!("{name}[{}]", element.number + 1);
                }
                let first = self.len();
                for (axis, letter) in axes(&XYZ) {
                    let slot = OutputSlot::State(id(usize::from(axis)));
                    let row = Row::output(slot, unit, about!("{about} {owner}, {letter}"));
                    self.add(format_args!("{name}.{letter}"), &owner, row);
                }
                self.vector(first, &name, &about!("{about} {owner}"));
            }
            Relaxing::Motor(actuator) => {
                let joint = self.model.actuators[actuator.index()].joint;
                self.joint_memory("motor", joint, None, id(0));
            }
            Relaxing::Dry(dof) => {
                let body = self.model.dofs[dof].body;
                let body = &self.model.bodies[body.index()];
                if let Some(joint) = body.joint {
                    let bodies = &self.model.joints[joint.index()].bodies;
                    let dofs = bodies.iter().map(|b| &self.model.bodies[b.index()]);
                    let mut dofs = dofs.flat_map(|b| b.dof.index()..b.dof.index() + b.motion.nv());
                    let place = dofs.clone().count() > 1;
                    let place = dofs.position(|other| other == dof).filter(|_| place);
                    self.joint_memory("friction", joint, place, id(0));
                }
            }
        }
    }

    /// What a motor or dry friction of a joint remembers.
    #[cfg_attr(small, optimize(size))]
    fn joint_memory(&mut self, group: &str, id: JointId, place: Option<usize>, state: StateId) {
        let joint = &self.model.joints[id.index()];
        let owner = format!("joint '{}'", joint.name);
        let what = if group == "motor" {
            "motor"
        } else {
            "dry friction"
        };
        let mut name = self.of_joint(&format!("state.{group}"), joint);
        if let Some(place) = place {
            name = format!("{name}[{}]", place + 1);
        }
        let about = about!("Elastic displacement of the {what} of {owner}");
        let row = Row::output(OutputSlot::State(state), units(joint.kind).position, about);
        self.add(format_args!("{name}"), &owner, row);
    }

    /// Name and owner of what the contact of two links remembers; none is the ground.
    #[cfg_attr(small, optimize(size))]
    fn of_contact(&self, group: &str, links: [Option<LinkId>; 2]) -> (String, String) {
        let mut links = links
            .into_iter()
            .flatten()
            .map(|link| &self.model.links[link.index()]);
        let Some(first) = links.next() else {
            return (format!("state.{group}"), "a contact".to_owned());
        };
        match links.next() {
            None => (
                self.of_link(&format!("state.{group}"), first),
                format!("link '{}' on the ground", first.name),
            ),
            Some(second) => (
                format!(
                    "{}.{}",
                    self.of_link(&format!("state.pair_{group}"), first),
                    identifier(&second.name)
                ),
                format!("links '{}' and '{}'", first.name, second.name),
            ),
        }
    }
}
