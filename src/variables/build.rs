//! Parts of the rows of [`super::table`].

use super::row::{Display, Kind, Part, Slot, TableError, Unit, Variable};
use crate::model::{
    BodyId, Joint, JointId, JointKind, Limits, Link, Model, RootId, RootKind, StateId,
};
use crate::slots::{Axis, InputSlot, OutputSlot, ParameterSlot};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

pub(super) const XYZ: [&str; 3] = ["x", "y", "z"];
pub(super) const XYZW: [&str; 4] = ["x", "y", "z", "w"];
pub(super) const RPY: [&str; 3] = ["roll", "pitch", "yaw"];

/// Names with their axes.
pub(super) fn axes<'n>(names: &'n [&'n str]) -> impl Iterator<Item = (Axis, &'n str)> {
    (0..).zip(names.iter().copied())
}

/// A table in the making.
pub(super) struct Table<'m> {
    pub(super) model: &'m Model,
    rows: Vec<Variable>,
    /// Weight of everything, N, one digit of it: forces are of this size, torques and energies are
    /// it times a metre.
    weight: Option<f64>,
    /// Whose row it is, for [`TableError::Clash`].
    owners: Vec<String>,
}

/// A row without name and place in the table.
pub(super) struct Row {
    slot: Slot,
    kind: Kind,
    unit: Unit,
    display: Option<Display>,
    start: Option<f64>,
    range: (Option<f64>, Option<f64>),
    description: String,
}

impl Row {
    #[inline(never)]
    pub(super) fn input(slot: InputSlot, unit: Unit, start: f64, description: String) -> Self {
        Self {
            slot: Slot::Input(slot),
            kind: Kind::Real,
            unit,
            display: unit.display(),
            start: Some(start),
            range: (None, None),
            description,
        }
    }

    #[inline(never)]
    pub(super) fn output(slot: OutputSlot, unit: Unit, description: String) -> Self {
        Self {
            slot: Slot::Output(slot),
            kind: Kind::Real,
            unit,
            display: unit.display(),
            start: None,
            range: (None, None),
            description,
        }
    }

    #[inline(never)]
    pub(super) fn parameter(
        slot: ParameterSlot,
        unit: Unit,
        start: f64,
        description: String,
    ) -> Self {
        Self {
            slot: Slot::Parameter(slot),
            kind: Kind::Real,
            unit,
            display: unit.display(),
            start: Some(start),
            range: (None, None),
            description,
        }
    }

    pub(super) fn kind(self, kind: Kind) -> Self {
        Self { kind, ..self }
    }

    /// Velocities of joints that turn without end are read in turns a minute.
    #[inline(never)]
    pub(super) fn of_joint(self, kind: JointKind) -> Self {
        let turns = kind == JointKind::Continuous && self.unit == Unit::RadianPerSecond;
        Self {
            display: if turns {
                Some(Display::TurnPerMinute)
            } else {
                self.display
            },
            ..self
        }
    }

    /// Bounds, moved to the start value where they exclude it: FMI wants the start inside.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    pub(super) fn within(self, min: Option<f64>, max: Option<f64>) -> Self {
        let start = self.start.unwrap_or(0.0);
        Self {
            range: (min.map(|min| min.min(start)), max.map(|max| max.max(start))),
            ..self
        }
    }

    pub(super) fn not_negative(self) -> Self {
        self.within(Some(0.0), None)
    }

    pub(super) fn limits(self, limits: Option<Limits>) -> Self {
        self.within(limits.map(|l| l.lower), limits.map(|l| l.upper))
    }

    /// ± `bound`, where there is one.
    pub(super) fn symmetric(self, bound: Option<f64>) -> Self {
        let bound = bound.filter(|&bound| bound > 0.0);
        self.within(bound.map(|bound| -bound), bound)
    }
}

/// Rows that differ by an axis: `slot` makes the slot of one.
#[derive(Clone, Copy)]
pub(super) struct Group<F> {
    pub(super) name: &'static str,
    pub(super) axes: &'static [&'static str],
    pub(super) unit: Unit,
    pub(super) slot: F,
    pub(super) about: &'static str,
}

pub(super) const fn group<F: Copy>(
    name: &'static str,
    axes: &'static [&'static str],
    unit: Unit,
    slot: F,
    about: &'static str,
) -> Group<F> {
    Group {
        name,
        axes,
        unit,
        slot,
        about,
    }
}

/// Units of a joint's own coordinate.
pub(super) struct JointUnits {
    pub(super) position: Unit,
    pub(super) velocity: Unit,
    pub(super) acceleration: Unit,
    pub(super) effort: Unit,
    pub(super) stiffness: Unit,
    pub(super) damping: Unit,
}

const TURNING: JointUnits = JointUnits {
    position: Unit::Radian,
    velocity: Unit::RadianPerSecond,
    acceleration: Unit::RadianPerSecondSquared,
    effort: Unit::NewtonMeter,
    stiffness: Unit::NewtonMeterPerRadian,
    damping: Unit::NewtonMeterSecondPerRadian,
};

const SLIDING: JointUnits = JointUnits {
    position: Unit::Meter,
    velocity: Unit::MeterPerSecond,
    acceleration: Unit::MeterPerSecondSquared,
    effort: Unit::Newton,
    stiffness: Unit::NewtonPerMeter,
    damping: Unit::NewtonSecondPerMeter,
};

pub(super) fn units(kind: JointKind) -> &'static JointUnits {
    match kind {
        JointKind::Prismatic => &SLIDING,
        JointKind::Fixed
        | JointKind::Revolute
        | JointKind::Continuous
        | JointKind::Planar
        | JointKind::Floating
        | JointKind::Spherical => &TURNING,
    }
}

pub(super) fn is_scalar(joint: &Joint) -> bool {
    matches!(
        joint.kind,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic
    )
}

/// Characters outside `[A-Za-z0-9_]` become `_`, and letters of other alphabets than the Latin one
/// also their code point, because names in these would all become the same; a leading digit gets a
/// `_` in front, so does nothing at all.
#[cfg_attr(small, optimize(size))]
pub(crate) fn identifier(name: &str) -> String {
    let mut identifier = String::with_capacity(name.len());
    for c in name.chars() {
        if c.is_ascii_alphanumeric() {
            identifier.push(c);
            continue;
        }
        identifier.push('_');
        let code = u32::from(c);
        // Latin letters with marks end at U+024F, and go on from U+1E00 to U+1EFF.
        let is_latin = matches!(code, 0..=0x24f | 0x1e00..=0x1eff);
        if c.is_alphabetic() && !is_latin {
            let digits = (0..8).rev().map(|place| (code >> (4 * place)) & 0xf);
            let digits = digits.skip_while(|digit| *digit == 0);
            identifier.extend(digits.filter_map(|digit| char::from_digit(digit, 16)));
        }
    }
    if identifier.is_empty() || identifier.starts_with(|c: char| c.is_ascii_digit()) {
        identifier.insert(0, '_');
    }
    identifier
}

/// A name in the style that the model asks for.
#[cfg_attr(small, optimize(size))]
pub(super) fn styled(model: &Model, name: String) -> String {
    if model.outputs.flat_names {
        name.replace(['.', '[', ','], "_").replace(']', "")
    } else {
        name
    }
}

/// The weight of all links, N, rounded to one digit.
fn weight(model: &Model) -> Option<f64> {
    let mass: f64 = model.links.iter().map(|link| link.inertia.mass).sum();
    let weight = mass * model.world.gravity.norm();
    let digit = format!("{weight:.0e}").parse().ok();
    digit.filter(|&weight: &f64| weight > 0.0 && weight.is_finite())
}

impl<'m> Table<'m> {
    #[cfg_attr(small, optimize(size))]
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            rows: Vec::new(),
            weight: weight(model),
            owners: Vec::new(),
        }
    }

    /// Adds a row; `owner` says whose it is in the URDF's own names. It is not inlined, like others
    /// here, because dozens of lines call it, and all of them run once.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    pub(super) fn add(&mut self, name: fmt::Arguments<'_>, owner: &str, row: Row) {
        let name = styled(self.model, name.to_string());
        let value_reference =
            u32::try_from(self.rows.len()).expect("a robot has fewer than 2^32 variables");
        let (min, max) = row.range;
        let sized = matches!(row.slot, Slot::Output(_))
            && matches!(row.unit, Unit::Newton | Unit::NewtonMeter | Unit::Joule);
        self.owners.push(owner.to_owned());
        self.rows.push(Variable {
            name,
            value_reference,
            description: row.description,
            slot: row.slot,
            kind: row.kind,
            stepped: false,
            start: row.start,
            min,
            max,
            unit: row.unit,
            part: None,
            state: None,
            display: row.display,
            nominal: self.weight.filter(|_| sized),
        });
    }

    /// The rows from `first` on are the elements of a whole of this name and shape.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    pub(super) fn whole(&mut self, first: usize, name: &str, shape: &[u32], description: &str) {
        let name = styled(self.model, name.to_owned());
        for (index, row) in (0..).zip(&mut self.rows[first..]) {
            row.part = Some(Part {
                whole: name.clone(),
                description: description.to_owned(),
                index,
                shape: shape.to_vec(),
            });
        }
    }

    /// As [`Self::whole`], for a vector of all rows from `first` on.
    #[inline(never)]
    pub(super) fn vector(&mut self, first: usize, name: &str, description: &str) {
        let len = u32::try_from(self.rows.len() - first).expect("a part of the table");
        self.whole(first, name, &[len], description);
    }

    /// The row with a slot.
    pub(super) fn find(&self, slot: Slot) -> Option<usize> {
        self.rows.iter().position(|row| row.slot == slot)
    }

    /// A row is a continuous state.
    pub(super) fn is_state(&mut self, row: usize, id: StateId, nominal: f64) {
        let row = &mut self.rows[row];
        row.state = Some(id);
        row.nominal = Some(nominal).filter(|nominal| *nominal < 1.0);
    }

    /// Adds the derivative of the state of a row; after those of all elements before it, where it
    /// is the last element of a whole, they are a whole, too.
    pub(super) fn derivative_of(&mut self, row: usize, id: StateId) {
        let (state, owner) = (self.rows[row].clone(), self.owners[row].clone());
        let about = about!("Derivative of {}", state.name);
        let slot = OutputSlot::Rate(id);
        let unit = state.unit.rate();
        let first = self.rows.len();
        // The name has its style already.
        self.add(format_args!(""), &owner, Row::output(slot, unit, about));
        self.rows[first].name = format!("der({})", state.name);
        self.rows[first].nominal = None;
        self.rows[first].part = state.part.map(|part| Part {
            description: about!("Derivative of {}", part.whole),
            whole: format!("der({})", part.whole),
            ..part
        });
    }

    /// How many rows there are.
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The rows from `first` on change in steps.
    pub(super) fn stepped_from(&mut self, first: usize) {
        for row in &mut self.rows[first..] {
            row.stepped = true;
        }
    }

    /// The rows, or the first of the names that clash.
    pub(super) fn finish(self) -> Result<Vec<Variable>, TableError> {
        match self.clashes().into_iter().next() {
            Some(clash) => Err(clash),
            None => Ok(self.rows),
        }
    }

    /// Names that clash, once for each two owners.
    pub(super) fn clashes(&self) -> Vec<TableError> {
        let mut owners: BTreeMap<&str, &String> = BTreeMap::new();
        let mut pairs = BTreeSet::new();
        let mut list = Vec::new();
        for (row, owner) in self.rows.iter().zip(&self.owners) {
            let first = *owners.entry(row.name.as_str()).or_insert(owner);
            if !std::ptr::eq(first, owner) && pairs.insert((first, owner)) {
                list.push(TableError::Clash {
                    first: first.clone(),
                    second: owner.clone(),
                    name: row.name.clone(),
                });
            }
        }
        list
    }

    /// What the names of a tree's variables begin with: nothing for the robot itself.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    pub(super) fn scope(&self, root: RootId) -> String {
        let root = &self.model.roots[root.index()];
        match (root.name.is_empty(), root.kind) {
            (true, _) => String::new(),
            (false, RootKind::Robot) => format!("{}.", identifier(&root.name)),
            (false, RootKind::Object) => format!("object.{}.", identifier(&root.name)),
        }
    }

    /// The name of a group of variables of a joint, such as `joint.elbow`.
    pub(super) fn of_joint(&self, group: &str, joint: &Joint) -> String {
        let body = self.model.links[joint.child.index()].body;
        self.of_part(group, body, &joint.name)
    }

    /// The name of a group of variables of a link, such as `link.hand`.
    pub(super) fn of_link(&self, group: &str, link: &Link) -> String {
        self.of_part(group, link.body, &link.name)
    }

    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn of_part(&self, group: &str, body: BodyId, name: &str) -> String {
        let root = self.model.root_of(body);
        let own = &self.model.roots[root.index()].name;
        let local = name.strip_prefix(own.as_str());
        let local = local
            .and_then(|rest| rest.strip_prefix('.'))
            .unwrap_or(name);
        let (scope, local) = (self.scope(root), identifier(local));
        match (scope.starts_with("object."), group.strip_prefix("initial.")) {
            (true, Some(group)) => format!("initial.{scope}{group}.{local}"),
            _ => format!("{scope}{group}.{local}"),
        }
    }

    pub(super) fn joints(&self) -> impl Iterator<Item = (JointId, &'m Joint)> + use<'m> {
        let joints = self.model.joints.iter().enumerate();
        joints.map(|(j, joint)| (JointId::from(j), joint))
    }

    /// Turning and sliding joints that mimic nothing: those with an initial value of their own.
    pub(super) fn independent_joints(
        &self,
    ) -> impl Iterator<Item = (JointId, &'m Joint)> + use<'m> {
        self.joints()
            .filter(|(_, joint)| is_scalar(joint) && joint.mimic.is_none())
    }

    /// The range of an independent joint, its mimics' included.
    pub(super) fn limits(&self, joint: &Joint) -> Option<Limits> {
        let body = &self.model.bodies[joint.bodies.first()?.index()];
        self.model.dofs[body.dof.index()].limits
    }
}
