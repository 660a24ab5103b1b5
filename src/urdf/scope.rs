//! Reading numbers and children of one link or joint, with every problem reported at its place.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::description::Tag;
use super::habits;
use super::numbers::{MOST_WORDS, Unread, hyphenated, parse, without_optenv};
use super::options::{ImpossibleInertia, MissingMass};
use super::xml::{Attribute, Node};
use crate::diagnostic::words::{code, did_you_mean, strange};
use crate::diagnostic::{Report, Severity, angles, times};
use crate::range as physical;
use crate::spatial::{Mat3, Vec3, rpy_from_rotation};
use nalgebra::{Quaternion, UnitQuaternion};
use std::collections::BTreeMap;
use std::ops::Range;

/// Tags that mean something to xacro alone.
const XACRO: [&str; 7] = [
    "include",
    "property",
    "macro",
    "arg",
    "if",
    "unless",
    "insert_block",
];

/// What is told as a unit behind a number.
const UNITS_ABOVE_ASCII: &str = "°²³";

/// Warnings of which many that are alike become one. Of the others, such as an inertia that is
/// replaced, it matters which links they are about.
const ALIKE: [&str; 4] = ["U019", "U020", "U022", "U032"];

/// URDF versions that change how a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Version(pub(super) u32, pub(super) u32);

/// What is known while a file is checked.
pub(super) struct Scope<'r, 'a> {
    pub(super) report: &'r mut Report<'a>,
    /// Who is looked at, for messages: `link 'arm'`.
    pub(super) owner: String,
    pub(super) version: Version,
    /// Tags that are left out: kind, first place, number.
    ignored: BTreeMap<String, (Range<usize>, usize)>,
    /// Tags of other programs that are read, likewise.
    read: BTreeMap<String, (Range<usize>, usize)>,
    /// Severity of a bad number: visuals do not move the robot.
    pub(super) severity: Severity,
    /// As [`super::ReadOptions::impossible_inertia`].
    pub(super) impossible_inertia: ImpossibleInertia,
    /// As [`super::ReadOptions::missing_mass`].
    pub(super) missing_mass: MissingMass,
    /// As [`super::ReadOptions::pybullet`].
    pub(super) pybullet: bool,
    /// As [`super::ReadOptions::sensors`].
    pub(super) sensors: bool,
}

impl<'r, 'a> Scope<'r, 'a> {
    pub(super) fn new(report: &'r mut Report<'a>) -> Self {
        Self {
            report,
            owner: String::new(),
            version: Version::default(),
            ignored: BTreeMap::new(),
            read: BTreeMap::new(),
            severity: Severity::Error,
            impossible_inertia: ImpossibleInertia::Refused,
            missing_mass: MissingMass::Nothing,
            pybullet: false,
            sensors: false,
        }
    }

    /// Reports with the owner's name in front.
    pub(super) fn problem(
        &mut self,
        code: &'static str,
        at: Range<usize>,
        message: &str,
        help: impl Into<String>,
    ) {
        let message = format!("{}: {message}", self.owner);
        self.report
            .add(self.severity, code, at, message, help.into());
    }

    pub(super) fn warning(
        &mut self,
        code: &'static str,
        at: Range<usize>,
        message: &str,
        help: impl Into<String>,
    ) {
        self.tell(Severity::Warning, code, at, message, help.into());
    }

    pub(super) fn note(
        &mut self,
        code: &'static str,
        at: Range<usize>,
        message: &str,
        help: impl Into<String>,
    ) {
        self.tell(Severity::Note, code, at, message, help.into());
    }

    fn tell(
        &mut self,
        severity: Severity,
        code: &'static str,
        at: Range<usize>,
        message: &str,
        help: String,
    ) {
        if severity < Severity::Error && ALIKE.contains(&code) {
            let owner = &self.owner;
            self.report.about(owner, severity, code, at, message, help);
        } else {
            let message = format!("{}: {message}", self.owner);
            self.report.add(severity, code, at, message, help);
        }
    }

    /// The attribute's number, if it is there and is one.
    pub(super) fn number(&mut self, node: Node, name: &str) -> Option<f64> {
        let attribute = node.attribute(name)?;
        let numbers = self.numbers(node, name, attribute)?;
        if let [number] = numbers[..] {
            return Some(number);
        }
        self.wrong_count(node, name, attribute, numbers.len(), 1);
        None
    }

    /// `value`, if the solver can work with it; else a problem at the attribute.
    pub(super) fn within(
        &mut self,
        node: Node,
        name: &str,
        value: f64,
        range: physical::Range,
    ) -> Option<f64> {
        if range.contains(value) {
            return Some(value);
        }
        let at = node
            .attribute(name)
            .map_or_else(|| node.tag_at(), |a| a.at.clone());
        let message = format!(
            "<{}> {name} must be {}, not {value:e}",
            node.name(),
            range.expected()
        );
        self.problem("U032", at, &message, "check its unit");
        None
    }

    /// As [`Self::number`]; a missing attribute is a problem too.
    pub(super) fn required_number(&mut self, node: Node, name: &str) -> Option<f64> {
        if node.attribute(name).is_none() {
            self.missing_attribute(node, name, &format!("write {name}=\"…\""));
        }
        self.number(node, name)
    }

    /// As many numbers as `N`, separated by white space.
    pub(super) fn vector<const N: usize>(&mut self, node: Node, name: &str) -> Option<[f64; N]> {
        let attribute = node.attribute(name)?;
        let numbers = self.numbers(node, name, attribute)?;
        let vector = <[f64; N]>::try_from(numbers.as_slice()).ok();
        if vector.is_none() {
            self.wrong_count(node, name, attribute, numbers.len(), N);
        }
        vector
    }

    pub(super) fn missing_attribute(&mut self, node: Node, name: &str, help: &str) {
        let message = format!("<{}> has no attribute '{name}'", node.name());
        let help = habits::content(node, name).unwrap_or_else(|| help.to_owned());
        self.problem("U015", node.tag_at(), &message, help);
    }

    fn wrong_count(&mut self, node: Node, name: &str, a: &Attribute, found: usize, needed: usize) {
        let s = if needed == 1 { "" } else { "s" };
        let message = format!(
            "<{}> {name} needs {needed} number{s}, not {found}",
            node.name()
        );
        let help = match needed {
            1 => "write one number",
            3 => "write x, y and z, separated by spaces",
            _ => "separate the numbers by spaces",
        };
        self.problem("U031", a.at.clone(), &message, help);
    }

    fn numbers(&mut self, node: Node, name: &str, attribute: &Attribute) -> Option<Vec<f64>> {
        let mut list = Vec::new();
        let (value, assumed) = without_optenv(&attribute.value);
        if assumed {
            let message = format!(
                "<{}> {name}: the default '{value}' of xacro's optenv is used",
                node.name()
            );
            let help = "name the file .xacro, so that it is expanded with the environment";
            self.warning("U034", attribute.at.clone(), &message, help);
        }
        let mut words = value.split_whitespace();
        while let Some(word) = words.next() {
            match parse(word) {
                Ok(number) => list.push(number),
                Err(Unread { code, what, help }) => {
                    let as_well = |word: &&str| parse(word).is_err_and(|other| other.what == what);
                    let mut bad = vec![word];
                    for other in words.filter(as_well) {
                        if !bad.contains(&other) && bad.len() < MOST_WORDS {
                            bad.push(other);
                        }
                    }
                    let others = bad[1..].iter().map(|word| format!(", nor is '{word}'"));
                    let others: String = others.collect();
                    let message = format!("<{}> {name}: '{word}' is {what}{others}", node.name());
                    let strange =
                        strange(word, UNITS_ABOVE_ASCII).map(|told| told + ": write it in ASCII");
                    let strange = hyphenated(word).or(strange);
                    let help = strange.unwrap_or_else(|| help.to_owned());
                    self.problem(code, attribute.at.clone(), &message, help);
                    return None;
                }
            }
        }
        Some(list)
    }

    /// The only child of that name. A second one is told: it is left out, as other readers of URDF
    /// do, except where nobody could know what is meant.
    pub(super) fn single<'d>(&mut self, node: Node<'d>, name: &'static str) -> Option<Node<'d>> {
        let mut all = node.children_named(name);
        let first = all.next()?;
        if let Some(second) = all.next() {
            let help = format!("<{}> takes one <{name}>; remove the other", node.name());
            if first.same_as(second) {
                let message = format!("<{name}> is written twice");
                self.warning("U018", second.tag_at(), &message, help);
            } else if ["parent", "child", "geometry"].contains(&name) {
                let message = format!("a second <{name}>, different from the first");
                self.problem("U018", second.tag_at(), &message, help);
            } else {
                let message = format!("a second <{name}>, different from the first, which is used");
                self.warning("U018", second.tag_at(), &message, help);
            }
        }
        Some(first)
    }

    /// Where the tag of an element stands.
    pub(super) fn tag(&self, node: Node) -> Tag {
        Tag {
            line: self.report.line(node.tag_at().start),
            at: node.tag_at(),
        }
    }

    /// `<origin>` below `node`: position as in the file, fixed-axis roll, pitch, yaw in rad.
    pub(super) fn origin(&mut self, node: Node) -> (Vec3, Vec3) {
        let Some(origin) = self.single(node, "origin") else {
            return (Vec3::zeros(), Vec3::zeros());
        };
        self.leaf(origin, &["xyz", "rpy", "quat_xyzw"]);
        let xyz = self.vector::<3>(origin, "xyz").unwrap_or_default();
        let mut rpy = Vec3::from(self.vector::<3>(origin, "rpy").unwrap_or_default());
        for (name, vector) in [("xyz", xyz), ("rpy", rpy.into())] {
            for value in vector {
                self.within(origin, name, value, physical::Range::Position);
            }
        }
        let told = angles::attitude("<origin> rpy", rpy.as_slice());
        if let (Some(message), Some(a)) = (told, origin.attribute("rpy")) {
            self.warning("U035", a.at.clone(), &message, angles::HELP);
        }
        if let Some(attribute) = origin.attribute("quat_xyzw") {
            if self.version < Version(1, 1) {
                let help = "write <robot version=\"1.1\"> or use rpy";
                let message = "quat_xyzw is ignored before URDF version 1.1";
                self.warning("U019", attribute.at.clone(), message, help);
            } else if origin.attribute("rpy").is_some() {
                let message = "<origin> has both rpy and quat_xyzw";
                self.problem("U018", attribute.at.clone(), message, "keep one of them");
            } else if let Some([x, y, z, w]) = self.vector::<4>(origin, "quat_xyzw") {
                match UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6) {
                    Some(q) => {
                        let R: Mat3 = q.to_rotation_matrix().into_inner();
                        rpy = rpy_from_rotation(&R);
                    }
                    None => self.problem(
                        "U033",
                        attribute.at.clone(),
                        "quat_xyzw is not a rotation: its length is zero",
                        "write \"0 0 0 1\" for no rotation",
                    ),
                }
            }
        }
        (Vec3::from(xyz), rpy)
    }

    /// Warns about attributes outside `known`. Those with a prefix belong to other programs.
    pub(super) fn known_attributes(&mut self, node: Node, known: &[&str]) {
        for (name, at) in node.attribute_names() {
            if !known.contains(&name) && !name.contains(':') && name != "xmlns" {
                let message = format!(
                    "<{}> attribute '{name}' is unknown and ignored",
                    node.name()
                );
                let help = habits::attribute(name, known);
                self.warning("U019", at, &message, help);
            }
        }
    }

    /// Warns about children outside `known`; those in `foreign`, and prefixed ones, are only
    /// counted.
    pub(super) fn known_children(&mut self, node: Node, known: &[&str], foreign: &[&str]) {
        self.no_text(node);
        self.elements(node, known, foreign);
    }

    /// Warns of text, of which URDF has none.
    pub(super) fn no_text(&mut self, node: Node) {
        let Some((text, at)) = node.first_text() else {
            return;
        };
        let help = if node.is_cdata(at.start) {
            "what stands in <![CDATA[…]]> is text, and no element: remove the brackets"
        } else if ["<<<<<<< ", "=======", ">>>>>>> "]
            .iter()
            .any(|mark| text.starts_with(mark))
        {
            "a conflict of a merge by git was left in the file: keep one side of it"
        } else if text.starts_with('&') {
            "write out what the entity stands for"
        } else {
            "a comment is written <!-- … -->, and ends at the first -->; all elements outside of it \
             are read"
        };
        let line = shown(
            text.split(['\n', '\r'])
                .next()
                .unwrap_or_default()
                .trim_end(),
        );
        let message = format!("text in <{}> is ignored: '{line}'", node.name());
        let help = match text.chars().find(|c| c.is_control()) {
            Some(c) if text.starts_with(c) => format!(
                "remove the control character {}: strict XML readers refuse the file",
                code(c)
            ),
            _ => help.to_owned(),
        };
        self.warning("U019", at.start..at.start + line.len(), &message, help);
    }

    fn elements(&mut self, node: Node, known: &[&str], foreign: &[&str]) {
        for child in node.children() {
            let name = child.name();
            if known.contains(&name) {
                continue;
            }
            if child.local_name() == "include" && name != "include" && !name.starts_with("xacro:") {
                let message = format!("<{name}> is not followed: what it includes is missing here");
                let help = "put the file's contents in its place, as xmllint --xinclude does";
                self.warning("U022", child.name_at(), &message, help);
                continue;
            }
            if self.prefixed(child, known) {
                continue;
            }
            if foreign.contains(&name) || name.contains(':') {
                self.ignore(child);
                continue;
            }
            let help = match place_of(name) {
                // Files of ROS 1 had xacro's tags without a prefix.
                _ if XACRO.contains(&name) => {
                    format!("as a tag of xacro it is written <xacro:{name}>, in a .xacro file")
                }
                Some(place) => format!("it belongs directly into {place}"),
                None => did_you_mean(name, known.iter().copied()),
            };
            self.unknown(child, help);
        }
    }

    /// Warns of an element with a prefix in the place of one of `known`: it is one of another
    /// language, whatever its name is; tells whether it is one.
    pub(super) fn prefixed(&mut self, child: Node, known: &[&str]) -> bool {
        let own = child.local_name();
        let name = child.name();
        let wrong = name != own && known.contains(&own) && !name.starts_with("xacro:");
        if wrong {
            let help = format!("elements of URDF have no prefix: write <{own}>, if it is meant");
            self.unknown(child, help);
        }
        wrong
    }

    fn unknown(&mut self, child: Node, help: String) {
        let message = format!("<{}> is unknown here and ignored", child.name());
        self.warning("U019", child.name_at(), &message, help);
    }

    /// Warns of all that an element has beside its attributes `known`, which alone hold what is
    /// read of it; of text that it is the value of the first of them.
    pub(super) fn leaf(&mut self, node: Node, known: &[&str]) {
        self.known_attributes(node, known);
        for child in node.children() {
            // `<scale>` in `<mesh>`, as SDF has it.
            let name = child.name();
            if known.contains(&name) {
                let help = attribute_help(node, name, child.content().trim());
                self.unknown(child, help);
            }
        }
        self.elements(node, known, &[]);
        let content = node.content();
        let content = content.trim();
        // A word or a number, not what is left of a comment.
        let value = content.starts_with(|c: char| c.is_alphanumeric() || "+-.".contains(c));
        if let [first, ..] = known
            && value
            && node.children().next().is_none()
        {
            let shown = shown(content);
            let message = format!("what stands in <{}> is ignored: '{shown}'", node.name());
            let help = attribute_help(node, first, &shown);
            self.warning("U019", node.content_at(), &message, help);
        } else {
            self.no_text(node);
        }
    }

    /// Counts a tag that is known but not used.
    pub(super) fn ignore(&mut self, node: Node) {
        let entry = self
            .ignored
            .entry(node.name().to_owned())
            .or_insert_with(|| (node.name_at(), 0));
        entry.1 += 1;
    }

    /// Counts a tag of another program that is read.
    pub(super) fn used(&mut self, node: Node) {
        let entry = self
            .read
            .entry(node.name().to_owned())
            .or_insert_with(|| (node.name_at(), 0));
        entry.1 += 1;
    }

    /// One note per kind of ignored tag, and per kind of other programs' tag that is read.
    pub(super) fn report_tags(&mut self) {
        for (name, (at, count)) in std::mem::take(&mut self.ignored) {
            let message = format!("<{name}> is not used{}", times(count));
            self.report.note("U020", at, message, "");
        }
        for (name, (at, count)) in std::mem::take(&mut self.read) {
            let message = format!("<{name}> is read{}", times(count));
            self.report.note("U023", at, message, "");
        }
    }
}

/// Where an element of URDF belongs.
fn place_of(name: &str) -> Option<&'static str> {
    Some(match name {
        "link" | "joint" => "<robot>",
        "inertial" | "visual" | "collision" => "<link>",
        "parent" | "child" | "axis" | "limit" | "dynamics" | "mimic" => "<joint>",
        "origin" => "<inertial>, <visual>, <collision> or <joint>",
        "mass" | "inertia" => "<inertial>",
        "geometry" => "<visual> or <collision>",
        "box" | "cylinder" | "sphere" | "mesh" => "<geometry>",
        "material" => "<visual>",
        "color" | "texture" => "<material>",
        _ => return None,
    })
}

fn attribute_help(node: Node, attribute: &str, value: &str) -> String {
    format!("write <{} {attribute}=\"{}\"/>", node.name(), shown(value))
}

/// As much of a text as a finding shows.
fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}
