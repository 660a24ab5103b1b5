//! SRDF, the description of a robot for motion planning, as far as a simulator can use it.
//!
//! - `<group_state>`: joint positions to start with, by name
//! - `<passive_joint>`: a joint without actuator
//! - `<disable_collisions>`: pairs of links that do not touch each other where `self_collision` is
//!   on.
//!
//! Planning groups, end effectors and the virtual joint are reported and not used. Faults of the
//! file are warnings, except if the requested state cannot be used.
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
    /// Findings that are no errors.
    pub diagnostics: Vec<Diagnostic>,
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
        let mut virtual_joints = HashSet::new();
        let mut unused: BTreeMap<&str, (usize, Range<usize>)> = BTreeMap::new();
        for node in root.children() {
            if node.name() == "virtual_joint" {
                virtual_joints.extend(node.value("name"));
            }
            if !["disable_collisions", "group_state", "passive_joint"].contains(&node.name()) {
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
            } else {
                self.report.note("R106", at, message, "");
            }
        }
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
                continue;
            };
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
                "the file has no <group_state>".to_owned()
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
                self.report.warning("R105", at, message, help);
            }
            position = inside;
        }
        // The last one of a joint holds, as in settings.
        semantics.positions.push((pattern, position));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use crate::urdf::{ReadOptions, read_str};
    use crate::{assemble, model::Model};
    use std::fmt::Write as _;

    /// A base, two arms, a wheel, and a finger that follows another one.
    fn robot() -> Description {
        let inertial = r#"<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"#;
        let mut text = String::from(r#"<robot name="r">"#);
        for link in ["base", "upper", "fore", "wheel", "a", "b"] {
            _ = write!(text, r#"<link name="{link}">{inertial}</link>"#);
        }
        let limit = r#"<limit lower="-1" upper="2" effort="1" velocity="1"/>"#;
        for (joint, kind, parent, child, rest) in [
            ("shoulder", "revolute", "base", "upper", limit),
            ("elbow", "revolute", "upper", "fore", limit),
            ("caster", "continuous", "base", "wheel", ""),
            ("finger", "prismatic", "fore", "a", limit),
            (
                "thumb",
                "prismatic",
                "fore",
                "b",
                &format!(r#"{limit}<mimic joint="finger"/>"#),
            ),
        ] {
            _ = write!(
                text,
                r#"<joint name="{joint}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{rest}</joint>"#
            );
        }
        text += "</robot>";
        read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default()).expect("a robot")
    }

    const SRDF: &str = r#"<robot name="r">
<virtual_joint name="world_joint" type="floating" parent_frame="world" child_link="base"/>
<group name="arm"><chain base_link="base" tip_link="fore"/></group>
<group_state name="home" group="arm"><joint name="world_joint" value="0 0 1 0 0 0 1"/>
<joint name="shoulder" value="0.5"/>
<joint name="elbow" value="-1.5"/></group_state>
<group_state name="home" group="hand"><joint name="finger" value="0.25"/><joint name="thumb" value="0.25"/></group_state>
<group_state name="away" group="arm"><joint name="shoulder" value="1"/></group_state>
<passive_joint name="caster"/>
<disable_collisions link1="base" link2="upper" reason="Adjacent"/>
<disable_collisions link1="upper" link2="base" reason="Never"/>
<disable_collisions link1="fore" link2="fore"/>
<disable_collisions link1="base" link2="for"/>
</robot>"#;

    fn has(findings: &[Diagnostic], code: &str, line: usize, part: &str) -> bool {
        findings.iter().any(|d| {
            d.code == code
                && d.place.as_ref().is_some_and(|p| p.line == line)
                && d.message.contains(part)
        })
    }

    fn model(semantics: &Semantics, settings: &str) -> Model {
        let mut settings = Settings::parse(settings, "s.toml").expect("settings");
        settings.initial.state.clone_from(&semantics.positions);
        let passive = semantics.passive.iter().cloned();
        settings.actuators.splice(
            0..0,
            passive.map(crate::settings::ActuatorSettings::passive),
        );
        assemble::build(&robot(), &settings).expect("a model").model
    }

    #[test]
    fn the_groups_of_a_state_add_up_and_stay_within_limits() {
        let semantics = read_srdf_str(SRDF, "r.srdf", Some("home"), &robot()).expect("an SRDF");
        let found = &semantics.diagnostics;
        assert_eq!(semantics.states, ["home", "away"]);
        assert_eq!(
            model(&semantics, "").initial.joint_positions,
            [0.5, -1.0, 0.25, 0.0, 0.0]
        );
        assert!(
            has(found, "R105", 6, "outside its limits -1 … 2"),
            "{found:#?}"
        );
        assert!(
            has(found, "R105", 7, "'thumb' follows another one"),
            "{found:#?}"
        );
        assert!(has(found, "R106", 4, "place of the base"), "{found:#?}");
        assert!(has(found, "R106", 3, "<group> is not used"), "{found:#?}");
    }

    #[test]
    fn initial_joints_of_the_settings_take_precedence_over_the_group_state() {
        let semantics = read_srdf_str(SRDF, "r.srdf", Some("home"), &robot()).expect("an SRDF");
        let model = model(
            &semantics,
            "[initial]\njoints = { \"e*\" = 0.75 }\n[[actuator]]\njoint = \"caster\"\nmode = \"effort\"\n",
        );
        assert_eq!(model.initial.joint_positions[..2], [0.5, 0.75]);
        assert_eq!(model.actuators.len(), 4);
    }

    #[test]
    fn a_passive_joint_is_not_driven() {
        let semantics = read_srdf_str(SRDF, "r.srdf", None, &robot()).expect("an SRDF");
        let model = model(&semantics, "");
        let driven = model
            .actuators
            .iter()
            .map(|a| model.joints[a.joint.index()].name.as_str());
        assert_eq!(driven.collect::<Vec<_>>(), ["shoulder", "elbow", "finger"]);
        assert_eq!(model.initial.joint_positions, [0.0; 5]);
    }

    #[test]
    fn disabled_collision_pairs_are_compared_with_the_links_of_the_robot() {
        let semantics = read_srdf_str(SRDF, "r.srdf", None, &robot()).expect("an SRDF");
        let found = &semantics.diagnostics;
        assert_eq!(semantics.disabled_pairs, [[0, 1]]);
        assert!(has(found, "R106", 10, "1 pairs of links"), "{found:#?}");
        assert!(
            has(
                found,
                "R103",
                11,
                "'base', 'upper' stands here a second time (1 such pairs"
            ),
            "{found:#?}"
        );
        assert!(has(found, "R103", 12, "'fore' with itself"), "{found:#?}");
        assert!(has(found, "R102", 13, "names link 'for'"), "{found:#?}");
        let help = found
            .iter()
            .find(|d| d.message.contains("'for'"))
            .and_then(|d| d.help.as_deref());
        assert_eq!(help, Some("did you mean 'fore'?"));
    }

    #[test]
    fn a_missing_group_state_and_a_urdf_in_place_of_an_srdf_are_errors() {
        let findings =
            read_srdf_str(SRDF, "r.srdf", Some("hom"), &robot()).expect_err("no such state");
        let error = findings
            .iter()
            .find(|d| d.code == "R104")
            .expect("an error");
        assert_eq!(error.help.as_deref(), Some("it has home, away"));
        let urdf = r#"<robot name="r"><link name="base"/></robot>"#;
        let findings = read_srdf_str(urdf, "r.urdf", None, &robot()).expect_err("a URDF");
        assert_eq!(findings[0].code, "R101");
        let number = SRDF.replace("\"0.5\"", "\"0.5 rad\"");
        let findings =
            read_srdf_str(&number, "r.srdf", Some("home"), &robot()).expect_err("no number");
        assert!(has(&findings, "R105", 5, "'0.5 rad'"), "{findings:#?}");
    }
}
