//! SRDF, the description of a robot for motion planning, as far as a simulator can use it.
//!
//! - `<group_state>`: joint positions to start with, by name
//! - `<passive_joint>`: a joint without actuator
//! - `<disable_collisions>`: pairs of links that do not touch each other where `self_collision` is
//!   on
//! - `<virtual_joint>`: whether others bolt the robot down.
//!
//! Planning groups and end effectors are reported and not used. Faults of the file are warnings,
//! except if the requested state cannot be used.
//!
//! | code | meaning |
//! |---|---|
//! | R101 | the file cannot be read, or is no SRDF |
//! | R102 | it names a link or joint that the URDF does not have |
//! | R103 | a pair stands twice, or is of a link with itself |
//! | R104 | the state asked for is not there |
//! | R105 | a position is not a number, outside the limits, or of a joint that cannot take one |
//! | R106 | what was read, and what is not used |

use super::description::Description;
use super::file::text;
use super::xml::{Document, Node};
use crate::diagnostic::words::did_you_mean;
use crate::diagnostic::{Diagnostic, Report, times};
use crate::model::JointKind;
use crate::pattern::Pattern;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::path::Path;

/// Tags that are read.
const USED: [&str; 4] = [
    "disable_collisions",
    "group_state",
    "passive_joint",
    "virtual_joint",
];

/// Tags of SRDF that say nothing about motion.
const OTHERS: [&str; 7] = [
    "disable_default_collisions",
    "enable_collisions",
    "end_effector",
    "group",
    "joint_property",
    "link_sphere_approximation",
    "property",
];

/// What an SRDF says.
#[derive(Clone, Debug, Default)]
pub struct Semantics {
    /// Joint positions of the state that was asked for, rad or m.
    pub positions: Vec<(Pattern, f64)>,
    /// Joints that nothing drives.
    pub passive: Vec<Pattern>,
    /// Links that need not be looked at together: each pair once, the first in the robot's order
    /// first.
    pub disabled_pairs: Vec<[usize; 2]>,
    /// Names of the states, each once.
    pub states: Vec<String>,
    /// How the robot is joined to what is around it.
    pub virtual_joint: Option<VirtualJoint>,
    /// Findings that are no errors.
    pub diagnostics: Vec<Diagnostic>,
}

/// A virtual joint of the base.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualJoint {
    /// Its name, and where it stands.
    pub name: Pattern,
    /// The frame that the base is joined to.
    pub frame: String,
    /// Whether it is fixed.
    pub fixed: bool,
}

/// Reads an SRDF for a robot.
///
/// - `state`: name of the `<group_state>` to start in; groups that have one of that name add up
///
/// # Errors
/// The file cannot be read, or the state is not in it.
pub fn read_srdf(
    path: &Path,
    state: Option<&str>,
    robot: &Description,
) -> Result<Semantics, Vec<Diagnostic>> {
    let file = path.display().to_string();
    let text = text(path).map_err(|mut finding| {
        finding.code = "R101";
        vec![*finding]
    })?;
    read_srdf_str(&text, &file, state, robot)
}

/// Reads the text of an SRDF; `file_name` is for the findings.
///
/// # Errors
/// As [`read_srdf`].
pub fn read_srdf_str(
    text: &str,
    file_name: &str,
    state: Option<&str>,
    robot: &Description,
) -> Result<Semantics, Vec<Diagnostic>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut report = Report::new(file_name, text);
    let mut semantics = Semantics::default();
    if let Some(document) = Document::parse(text, &mut report) {
        let root = document.root();
        if root.name() == "robot" && root.child("link").is_none() {
            let mut reader = Reader::new(robot, &mut report);
            reader.read(root, state, &mut semantics);
        } else {
            let message = "this is no SRDF: it has no <robot>, or one with links of its own";
            let help = "give the URDF first, the .srdf file with --srdf";
            report.error("R101", root.tag_at(), message, help);
        }
    }
    let failed = report.has_errors();
    semantics.diagnostics = report.finish();
    if failed {
        Err(semantics.diagnostics)
    } else {
        Ok(semantics)
    }
}

struct Reader<'r, 't> {
    robot: &'r Description,
    links: HashMap<&'r str, usize>,
    joints: HashMap<&'r str, usize>,
    /// Names that the robot does not have, told already.
    unknown: HashSet<String>,
    report: &'r mut Report<'t>,
}

impl<'r, 't> Reader<'r, 't> {
    fn new(robot: &'r Description, report: &'r mut Report<'t>) -> Self {
        let links = robot.links.iter().map(|link| link.name.as_str());
        let joints = robot.joints.iter().map(|joint| joint.name.as_str());
        Self {
            robot,
            links: links.zip(0..).collect(),
            joints: joints.zip(0..).collect(),
            unknown: HashSet::new(),
            report,
        }
    }

    fn read(&mut self, root: Node, state: Option<&str>, semantics: &mut Semantics) {
        let virtual_joints = self.mounting(root, semantics);
        let mut unused: BTreeMap<&str, (usize, Range<usize>)> = BTreeMap::new();
        for node in root.children() {
            if !USED.contains(&node.name()) {
                let entry = unused.entry(node.name()).or_insert((0, node.tag_at()));
                entry.0 += 1;
            }
        }
        self.pairs(root, semantics);
        let mut first = None;
        for node in root.children_named("passive_joint") {
            let Some((joint, name)) = self.named(node, "name", "joint") else {
                continue;
            };
            // What cannot be driven need not be left alone.
            if self.unsuitable(joint).is_none() {
                first.get_or_insert_with(|| node.tag_at());
                semantics.passive.push(name);
            }
        }
        if let Some(at) = first {
            let count = semantics.passive.len();
            let message = format!("nothing drives the passive joints ({count}, first here)");
            let help = "an [[actuator]] of the settings drives them all the same";
            self.report.note("R106", at, message, help);
        }
        self.states(root, state, &virtual_joints, semantics);
        for (name, (count, at)) in unused {
            let message = format!("<{name}> is not used{}", times(count));
            if name.starts_with("xacro:") {
                let help = "expand it first: urdf2fmu expand robot.srdf.xacro > robot.srdf";
                self.report.warning("R101", at, message, help);
                continue;
            }
            let meant = Some(name).filter(|name| !OTHERS.contains(name));
            let help = meant.map_or_else(String::new, |name| did_you_mean(name, USED));
            if help.is_empty() {
                self.report.note("R106", at, message, "");
            } else {
                self.report.warning("R106", at, message, help);
            }
        }
    }

    /// Reads the virtual joints; gives their names.
    pub(super) fn mounting<'n>(
        &mut self,
        root: Node<'n>,
        semantics: &mut Semantics,
    ) -> HashSet<&'n str> {
        let mut names = HashSet::new();
        for node in root.children_named("virtual_joint") {
            names.extend(node.value("name"));
            let name = node.value("name").unwrap_or_default();
            let Some((link, child)) = self.named(node, "child_link", "link") else {
                continue;
            };
            let kind = node.value("type").unwrap_or_default();
            if !on_base(self.robot, link) {
                let message = format!(
                    "virtual joint '{name}' holds '{}', which is not the base: it is not used",
                    child.text
                );
                self.report.note("R106", node.tag_at(), message, "");
                continue;
            }
            if !["fixed", "planar", "floating"].contains(&kind) {
                let message = format!("virtual joint '{name}' of type '{kind}' is not used");
                let help = "its type is \"fixed\", \"planar\" or \"floating\"";
                self.report.warning("R106", node.tag_at(), message, help);
                continue;
            }
            let fixed = kind == "fixed";
            let frame = node.value("parent_frame").unwrap_or("world");
            let message = if fixed {
                format!("virtual joint '{name}' says that the base is fixed to '{frame}'")
            } else {
                format!("virtual joint '{name}' says that the base moves ({kind})")
            };
            self.report.note("R106", node.tag_at(), message, "");
            let place = self.report.place(node.tag_at());
            semantics.virtual_joint.get_or_insert(VirtualJoint {
                name: Pattern {
                    text: name.to_owned(),
                    place: Some(place),
                },
                frame: frame.to_owned(),
                fixed,
            });
        }
        names
    }

    /// A link or joint of the URDF that an attribute names; `None` after reporting that there is
    /// none.
    fn named(&mut self, node: Node, attribute: &str, kind: &str) -> Option<(usize, Pattern)> {
        let Some(found) = node.attribute(attribute) else {
            let message = format!("<{}> has no {attribute}", node.name());
            let help = "it is not used";
            self.report.warning("R102", node.tag_at(), message, help);
            return None;
        };
        let names = if kind == "link" {
            &self.links
        } else {
            &self.joints
        };
        if let Some(&index) = names.get(found.value.as_str()) {
            let place = self.report.place(found.at.clone());
            let pattern = Pattern {
                text: found.value.clone(),
                place: Some(place),
            };
            return Some((index, pattern));
        }
        // Once a name: there may be hundreds of pairs with it.
        if !self.unknown.insert(found.value.clone()) {
            return None;
        }
        let message = format!(
            "<{}> names {kind} '{}', which the robot does not have",
            node.name(),
            found.value
        );
        let mut known: Vec<&str> = names.keys().copied().collect();
        known.sort_unstable();
        let help = match did_you_mean(&found.value, known) {
            help if help.is_empty() => "is it the SRDF of this robot?".to_owned(),
            help => help,
        };
        self.report.warning("R102", found.at.clone(), message, help);
        None
    }

    fn pairs(&mut self, root: Node, semantics: &mut Semantics) {
        let mut seen = HashSet::new();
        let (mut first, mut twice) = (None, None);
        for node in root.children_named("disable_collisions") {
            first.get_or_insert_with(|| node.tag_at());
            let (a, b) = (
                self.named(node, "link1", "link"),
                self.named(node, "link2", "link"),
            );
            let (Some((a, _)), Some((b, name))) = (a, b) else {
                continue;
            };
            let pair = [a.min(b), a.max(b)];
            if a == b {
                let message = format!("a pair of link '{}' with itself", name.text);
                let help = "a link never touches itself";
                self.report.warning("R103", node.tag_at(), message, help);
            } else if seen.insert(pair) {
                semantics.disabled_pairs.push(pair);
            } else {
                let twice = twice.get_or_insert((0, pair, node.tag_at()));
                twice.0 += 1;
            }
        }
        if let Some((count, pair, at)) = twice {
            let [one, other] = pair.map(|link| &self.robot.links[link].name);
            let message = format!(
                "the pair '{one}', '{other}' stands here a second time ({count} such pairs, first here)"
            );
            self.report.warning("R103", at, message, "one is enough");
        }
        if let Some(at) = first {
            let message = format!(
                "{} pairs of links that do not touch are read; they count where [robot] self_collision is true",
                semantics.disabled_pairs.len()
            );
            self.report.note("R106", at, message, "");
        }
    }

    fn states(
        &mut self,
        root: Node,
        wanted: Option<&str>,
        virtual_joints: &HashSet<&str>,
        semantics: &mut Semantics,
    ) {
        for state in root.children_named("group_state") {
            let Some(name) = state.value("name") else {
                let message =
                    "<group_state> has no name, by which --initial-state could ask for it";
                let help = "write <group_state name=\"…\" group=\"…\">";
                self.report.warning("R104", state.tag_at(), message, help);
                continue;
            };
            for node in state.children().filter(|node| node.name() != "joint") {
                let message = format!("<{}> of state '{name}' is not used", node.name());
                let help = "a position is <joint name=\"…\" value=\"…\"/>";
                self.report.warning("R106", node.tag_at(), message, help);
            }
            if !semantics.states.iter().any(|known| known == name) {
                semantics.states.push(name.to_owned());
            }
            if wanted != Some(name) {
                continue;
            }
            for node in state.children_named("joint") {
                // The whole robot's place is not the state's business: it would stand in the ground
                // or above it.
                let base = node.value("name").is_some_and(|name| {
                    virtual_joints.contains(name)
                        || name == "root_joint" && !self.joints.contains_key(name)
                });
                if base {
                    let message = "the place of the base is not taken from the state";
                    let help =
                        "set [initial] xyz and rpy; without xyz the robot stands on the ground";
                    self.report.note("R106", node.tag_at(), message, help);
                } else if let Some((joint, pattern)) = self.named(node, "name", "joint") {
                    self.position(node, joint, pattern, semantics);
                }
            }
        }
        let Some(wanted) = wanted else { return };
        if !semantics.states.iter().any(|state| state == wanted) {
            let message = format!("there is no state '{wanted}'");
            let known = &semantics.states;
            let help = if known.is_empty() {
                "the file has no <group_state> with a name".to_owned()
            } else {
                format!("it has {}", known.join(", "))
            };
            self.report.error("R104", root.tag_at(), message, help);
        }
    }

    /// Why a joint has no position of its own to take, if it has not.
    fn unsuitable(&self, joint: usize) -> Option<&'static str> {
        let joint = &self.robot.joints[joint];
        match joint.kind {
            _ if joint.mimic.is_some() => Some("follows another one"),
            JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => None,
            _ => Some("neither turns nor slides"),
        }
    }

    /// One joint of the state.
    fn position(&mut self, node: Node, index: usize, pattern: Pattern, semantics: &mut Semantics) {
        let joint = &self.robot.joints[index];
        let at = node
            .attribute("value")
            .map_or_else(|| node.tag_at(), |a| a.at.clone());
        let value = node.value("value").unwrap_or_default().trim();
        if let Some(reason) = self.unsuitable(index) {
            let message = format!("joint '{}' {reason}: its position is not used", joint.name);
            self.report.note("R105", at, message, "");
            return;
        }
        let Some(mut position) = value.parse::<f64>().ok().filter(|p| p.is_finite()) else {
            let message = format!(
                "the position '{value}' of joint '{}' is no number",
                joint.name
            );
            self.report
                .error("R105", at, message, "give it in rad or m");
            return;
        };
        if let Some(limits) = joint.limits {
            let inside = position.clamp(limits.lower, limits.upper);
            if (position - inside).abs() > 1e-6 * (1.0 + inside.abs()) {
                let message = format!(
                    "the position {position} of joint '{}' is outside its limits {} … {}",
                    joint.name, limits.lower, limits.upper
                );
                let help = format!("the nearest possible one, {inside}, is taken");
                self.report.warning("R105", at.clone(), message, help);
            }
            position = inside;
        }
        let twice = |(before, other): &(Pattern, f64)| {
            before.text == pattern.text && other.to_bits() != position.to_bits()
        };
        if let Some((_, other)) = semantics.positions.iter().find(|p| twice(p)) {
            let message = format!(
                "joint '{}' has the position {position} here and {other} before: the last one holds",
                joint.name
            );
            let help = "leave one of them out";
            self.report.warning("R105", at, message, help);
        }
        // The last one of a joint holds, as in settings.
        semantics.positions.push((pattern, position));
    }
}

/// Whether a link is the root, or fixed to it.
fn on_base(robot: &Description, mut link: usize) -> bool {
    // The joint of a link stands before it.
    while let Some(j) = link.checked_sub(1) {
        if robot.joints[j].kind != JointKind::Fixed {
            return false;
        }
        link = robot.joints[j].parent;
    }
    true
}

#[cfg(test)]
mod tests;
