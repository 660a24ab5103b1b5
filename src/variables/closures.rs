//! Outputs of loops and springs.

use super::build::{Group, Row, Table, XYZ, group, identifier, units};
use super::row::Unit;
use crate::model::{JointKind, LoopId, LoopKind, SpringId};
use crate::slots::{Axis, OutputSlot};

type OfLoop = fn(LoopId, Axis) -> OutputSlot;
type OfSpring = fn(SpringId, Axis) -> OutputSlot;

impl Table<'_> {
    #[cfg_attr(small, optimize(size))]
    pub(super) fn closure_outputs(&mut self) {
        let force: Group<OfLoop> = group(
            "force",
            &XYZ,
            Unit::Newton,
            OutputSlot::LoopForce,
            "Force on the first link in world axes of",
        );
        let torque: Group<OfLoop> = group(
            "torque",
            &XYZ,
            Unit::NewtonMeter,
            OutputSlot::LoopTorque,
            "Torque on the first link about its end in world axes of",
        );
        for (id, part) in (0..).map(LoopId).zip(&self.model.loops) {
            if !part.shown {
                continue;
            }
            let owner = format!("loop '{}'", part.name);
            let prefix = format!("loop.{}", identifier(&part.name));
            let mut unit = Unit::Meter;
            match &part.kind {
                LoopKind::Weld(_) | LoopKind::Hinge(_) => {
                    let groups = [force, torque];
                    self.groups(&groups, |of, axis| of(id, axis), &owner, &prefix);
                }
                LoopKind::Ball(_) | LoopKind::Distance { .. } => {
                    self.groups(&[force], |of, axis| of(id, axis), &owner, &prefix);
                }
                LoopKind::Coupler { terms, .. } => {
                    let kind = terms
                        .first()
                        .map(|t| self.model.joints[t.joint.index()].kind);
                    let units = units(kind.unwrap_or(JointKind::Revolute));
                    unit = units.position;
                    let about = about!("Effort along the sum of positions of {owner}");
                    let row = Row::output(OutputSlot::LoopEffort(id), units.effort, about);
                    self.add(format_args!("{prefix}.effort"), &owner, row);
                }
            }
            let about = about!("How far the points, or the sum, are off in {owner}");
            let row = Row::output(OutputSlot::LoopGap(id), unit, about);
            self.add(format_args!("{prefix}.gap"), &owner, row);
        }
        let force: [Group<OfSpring>; 1] = [group(
            "force",
            &XYZ,
            Unit::Newton,
            OutputSlot::SpringForce,
            "Force on the first link in world axes of",
        )];
        for (id, part) in (0..).map(SpringId).zip(&self.model.springs) {
            if part.shown {
                let owner = format!("spring '{}'", part.name);
                let prefix = format!("spring.{}", identifier(&part.name));
                self.groups(&force, |of, axis| of(id, axis), &owner, &prefix);
                let about = about!("Length of {owner}");
                let row = Row::output(OutputSlot::SpringLength(id), Unit::Meter, about);
                self.add(format_args!("{prefix}.length"), &owner, row);
            }
        }
    }
}
