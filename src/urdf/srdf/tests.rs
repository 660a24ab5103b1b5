//! An SRDF of a small robot, and what is made of it.

use super::*;
use crate::diagnostic::Severity;
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
    let findings = read_srdf_str(SRDF, "r.srdf", Some("hom"), &robot()).expect_err("no such state");
    let error = findings
        .iter()
        .find(|d| d.code == "R104")
        .expect("an error");
    assert_eq!(error.help.as_deref(), Some("it has home, away"));
    let urdf = r#"<robot name="r"><link name="base"/></robot>"#;
    let findings = read_srdf_str(urdf, "r.urdf", None, &robot()).expect_err("a URDF");
    assert_eq!(findings[0].code, "R101");
    let number = SRDF.replace("\"0.5\"", "\"0.5 rad\"");
    let findings = read_srdf_str(&number, "r.srdf", Some("home"), &robot()).expect_err("no number");
    assert!(has(&findings, "R105", 5, "'0.5 rad'"), "{findings:#?}");
}

#[test]
fn a_virtual_joint_says_how_the_base_is_joined_to_the_world() {
    let read = |attributes: &str| {
        let text = format!("<robot name='r'><virtual_joint name='v' {attributes}/></robot>");
        read_srdf_str(&text, "r.srdf", None, &robot()).expect("an SRDF")
    };
    for (kind, fixed) in [("fixed", true), ("planar", false), ("floating", false)] {
        let semantics = read(&format!(
            "type='{kind}' parent_frame='table' child_link='base'"
        ));
        let joint = semantics.virtual_joint.expect("of the base");
        assert_eq!((joint.fixed, joint.frame.as_str()), (fixed, "table"));
        assert_eq!(joint.name.text, "v");
        let [found] = &semantics.diagnostics[..] else {
            panic!("{:?}", semantics.diagnostics);
        };
        assert_eq!((found.code, found.severity), ("R106", Severity::Note));
    }
    for (attributes, severity, code, part) in [
        (
            "type='fix' child_link='base'",
            Severity::Warning,
            "R106",
            "type 'fix'",
        ),
        (
            "type='fixed' child_link='bas'",
            Severity::Warning,
            "R102",
            "'bas'",
        ),
        (
            "type='fixed'",
            Severity::Warning,
            "R102",
            "has no child_link",
        ),
        (
            "type='fixed' child_link='fore'",
            Severity::Note,
            "R106",
            "not the base",
        ),
    ] {
        let semantics = read(attributes);
        assert_eq!(semantics.virtual_joint, None, "{attributes}");
        let [found] = &semantics.diagnostics[..] else {
            panic!("{attributes}: {:?}", semantics.diagnostics);
        };
        assert_eq!((found.code, found.severity), (code, severity));
        assert!(found.message.contains(part), "{}", found.message);
    }
}

/// Slips by which positions of a state were lost without a word, or told as what they are not.
#[test]
fn slips_in_a_state_are_told_where_they_stand() {
    let state = |inner: &str| format!("<robot name=\"r\">\n{inner}\n</robot>");
    let named = |inner: &str| state(&format!("<group_state name=\"home\">{inner}</group_state>"));
    for (text, code, part, help) in [
        (
            named("<joints name=\"elbow\" value=\"0.5\"/>"),
            "R106",
            "<joints> of state 'home' is not used",
            "<joint name=",
        ),
        (
            named("<joint name=\"elbow\" value=\"0.5\"/><joint name=\"elbow\" value=\"1\"/>"),
            "R105",
            "has the position 1 here and 0.5 before",
            "leave one",
        ),
        (
            state("<group_state group=\"arm\"><joint name=\"elbow\" value=\"0.5\"/></group_state>"),
            "R104",
            "<group_state> has no name",
            "name=",
        ),
        (
            state("<group_stat name=\"home\"/>"),
            "R106",
            "<group_stat> is not used",
            "did you mean 'group_state'?",
        ),
    ] {
        let read = read_srdf_str(&text, "r.srdf", Some("home"), &robot());
        let found = read.map_or_else(|found| found, |read| read.diagnostics);
        let told = found
            .iter()
            .find(|d| d.code == code && d.message.contains(part));
        let told = told.unwrap_or_else(|| panic!("{text}: {found:?}"));
        assert_eq!(told.severity, Severity::Warning);
        assert_eq!(told.place.as_ref().map(|p| p.line), Some(2), "{told:?}");
        assert!(
            told.help.as_deref().is_some_and(|h| h.contains(help)),
            "{told:?}"
        );
    }
    for other in OTHERS {
        let read = read_srdf_str(&state(&format!("<{other}/>")), "r.srdf", None, &robot());
        let found = read.expect("what is not used").diagnostics;
        assert!(
            found.iter().all(|d| d.severity == Severity::Note),
            "{found:?}"
        );
    }
    let found = read_srdf_str("", "r.srdf", None, &robot()).expect_err("an empty file");
    assert!(
        found[0]
            .help
            .as_deref()
            .is_some_and(|h| h.starts_with("an SRDF")),
        "{found:?}"
    );
}
