//! Loops and springs of settings and of notes in a URDF.

use super::*;
use crate::model::{LoopKind, Model};
use crate::settings::Settings;
use crate::urdf::{ReadOptions, read_str};
use std::path::Path;

/// Crank, coupler and rocker, drawn along x, with further tags.
fn four_bar(notes: &str) -> String {
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.5 0 0\"/><mass value=\"1\"/>\
             <inertia ixx=\"0.001\" ixy=\"0\" ixz=\"0\" iyy=\"0.08\" iyz=\"0\" izz=\"0.08\"/>\
             </inertial></link>\n"
        )
    };
    let joint = |name: &str, parent: &str, child: &str, x: f64| {
        format!(
            "<joint name=\"{name}\" type=\"continuous\"><parent link=\"{parent}\"/>\
             <child link=\"{child}\"/><origin xyz=\"{x} 0 0\"/><axis xyz=\"0 -1 0\"/></joint>\n"
        )
    };
    format!(
        "<robot name=\"four_bar\">\n<link name=\"base\"/>\n{}{}{}{}{}{}{notes}</robot>",
        link("crank"),
        link("coupler"),
        link("rocker"),
        joint("a", "base", "crank", 0.0),
        joint("b", "crank", "coupler", 1.0),
        joint("c", "base", "rocker", 1.2),
    )
}

fn read(notes: &str) -> crate::urdf::Description {
    let text = four_bar(notes);
    read_str(&text, "test.urdf", Path::new("."), &ReadOptions::default()).expect("a sound file")
}

fn built(
    notes: &str,
    settings: &str,
) -> Result<super::super::Assembled, Vec<crate::diagnostic::Diagnostic>> {
    let settings =
        format!("robot.base = \"fixed\"\nworld.ground = {{ type = \"none\" }}\n{settings}");
    let settings = Settings::parse(&settings, "test.toml")?;
    super::super::build(&read(notes), &settings)
}

const OPEN: &str = "[initial]\njoints = { a = 1.5 }\n";
const BALL: &str = "[[loop]]\ntype = \"ball\"\nlinks = [\"coupler\", \"rocker\"]\n\
    origins = [[1, 0, 0], [1, 0, 0]]\n";

/// Distance of the tips of coupler and rocker at the start.
fn apart(model: &Model) -> f64 {
    let q = &model.initial.joint_positions;
    let tip = |x: f64, a: f64| [x + libm::cos(a), libm::sin(a)];
    let elbow = tip(0.0, q[0]);
    let one = [
        elbow[0] + libm::cos(q[0] + q[1]),
        elbow[1] + libm::sin(q[0] + q[1]),
    ];
    let two = tip(1.2, q[2]);
    libm::hypot(one[0] - two[0], one[1] - two[1])
}

#[test]
fn the_initial_pose_closes_a_loop_and_what_was_given_stays() {
    let built = built("", &format!("{OPEN}{BALL}")).expect("it closes");
    let model = &built.model;
    assert!(apart(model) < 1e-9, "{}", apart(model));
    let given = model.initial.joint_positions[0];
    assert_eq!(given.to_bits(), 1.5_f64.to_bits());
    let note = note(&built, "A141");
    assert!(
        note.message
            .contains("closing the loops has moved b from 0"),
        "{}",
        note.message
    );
}

#[test]
fn what_moves_by_less_than_a_note_shows_is_not_told() {
    let closed = built("", &format!("{OPEN}{BALL}")).expect("it closes");
    let q = &closed.model.initial.joint_positions;
    // As a file has them: the loop is open by some 1e-8 m.
    let near = format!(
        "[initial]\njoints = {{ a = 1.5, b = {:.8}, c = {:.8} }}\n",
        q[1], q[2]
    );
    let again = built("", &format!("{near}{BALL}")).expect("it closes");
    assert!(apart(&again.model) < 1e-12);
    let told = again.diagnostics.iter().find(|found| found.code == "A141");
    assert!(told.is_none(), "{told:?}");
}

#[test]
fn a_loop_that_cannot_close_is_an_error_with_its_gap_and_its_place() {
    let far = BALL.replace("[1, 0, 0]]", "[9, 0, 0]]");
    let errors = built("", &far).expect_err("9 m");
    let error = errors.iter().find(|e| e.code == "A141").expect("it tells");
    // Crank and coupler reach 2 m from the base, the rocker's point is 9 m from 1.2 m.
    assert!(
        error.message.contains("5.8") && error.message.contains("rad are left"),
        "{}",
        error.message
    );
    assert_eq!(error.place.as_ref().map(|place| place.line), Some(3));
}

/// It has no origins.
#[test]
fn a_coupler_that_cannot_be_closed_is_told_with_what_it_has() {
    let coupler = |sum: f64| {
        format!("[[loop]]\ntype = \"coupler\"\njoints = [\"a\"]\nfactors = [1]\nsum = {sum}\n")
    };
    let errors = built("", &(coupler(1.0) + &coupler(2.0))).expect_err("1 is not 2");
    let error = errors.iter().find(|e| e.code == "A141").expect("it tells");
    assert!(!error.message.contains("rad"), "{error:?}");
    let help = error.help.as_deref().unwrap_or_default();
    assert!(help.contains("its factors and its sum"), "{error:?}");
}

#[test]
fn broken_loops_are_errors_with_their_place() {
    for (text, code, words) in [
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"coupler\", \"rockr\"]",
            "A101",
            "rockr",
        ),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"rocker\", \"rocker\"]",
            "S106",
            "both ends",
        ),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"base\", \"world\"]",
            "A140",
            "no force can move",
        ),
        (
            "[[loop]]\ntype = \"gear\"\njoints = [\"a\", \"a\"]\nratio = 2",
            "A140",
            "'a' stands twice",
        ),
        (
            "[[loop]]\ntype = \"coupler\"\njoints = [\"a\", \"b\", \"a\"]\nfactors = [1, 1, 1]",
            "A140",
            "'a' stands twice",
        ),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"base\"]",
            "S104",
            "two links",
        ),
        ("[[loop]]\nlinks = [\"base\", \"crank\"]", "S107", "type"),
        ("[[loop]]\ntype = \"bal\"", "S104", "bal"),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"coupler\", \"rocker\"]\norigins = [[nan, 0, 0], [0, 0, 0]]",
            "S104",
            "origins",
        ),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"coupler\", \"rocker\"]\norigins = [[0, 0, 0]]",
            "S103",
            "origins",
        ),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"coupler\", \"rocker\"]\nlength = 1",
            "S106",
            "length",
        ),
        (
            "[[loop]]\ntype = \"distance\"\nlinks = [\"coupler\", \"rocker\"]\nlength = -1",
            "S104",
            "length",
        ),
        (
            "[[loop]]\ntype = \"hinge\"\nlinks = [\"coupler\", \"rocker\"]\naxes = [[0, 0, 0], [0, 0, 1]]",
            "S104",
            "axes",
        ),
        (
            "[[loop]]\ntype = \"gear\"\njoints = [\"a\", \"c\"]",
            "S107",
            "ratio",
        ),
        (
            "[[loop]]\ntype = \"coupler\"\njoints = [\"a\", \"c\"]\nfactors = [1]",
            "S107",
            "factors",
        ),
        (
            "[[loop]]\ntype = \"coupler\"\njoints = [\"a\", \"x\"]\nfactors = [1, 1]",
            "A101",
            "'x'",
        ),
        (
            "[[spring]]\nlinks = [\"coupler\", \"rocker\"]",
            "S107",
            "stiffness",
        ),
        (
            "[[spring]]\nlinks = [\"coupler\", \"rocker\"]\nstiffness = -3",
            "S104",
            "stiffness",
        ),
        ("outputs.loops = [\"x\"]", "A101", "'x'"),
    ] {
        let errors = built("", text).expect_err(text);
        let found = errors.iter().find(|e| e.code == code);
        let found = found.unwrap_or_else(|| panic!("{text}: {:?}", texts(&errors)));
        assert!(found.message.contains(words), "{text}: {}", found.message);
        assert!(found.place.is_some(), "{text}");
    }
}

/// Each note closes the loop of the tips; ours is the one that its program makes of it.
#[test]
fn notes_for_other_programs_close_loops() {
    let notes = [
        "<loop_joint name=\"tip\" type=\"spherical\"><link1 link=\"coupler\" rpy=\"0 0 0\" xyz=\"1 0 0\"/>\
         <link2 link=\"rocker\" rpy=\"0 0 0\" xyz=\"1 0 0\"/></loop_joint>",
        "<loop_joint name=\"tip\" type=\"revolute\"><link1 link=\"coupler\" xyz=\"1 0 0\"/>\
         <link2 link=\"rocker\" xyz=\"1 0 0\"/><axis xyz=\"0 1 0\"/></loop_joint>",
        "<drake:ball_constraint><drake:ball_constraint_body_A name=\"coupler\"/>\
         <drake:ball_constraint_body_B name=\"rocker\"/><drake:ball_constraint_p_AP value=\"1 0 0\"/>\
         <drake:ball_constraint_p_BQ value=\"1 0 0\"/></drake:ball_constraint>",
    ];
    for note in notes {
        let built = built(note, OPEN).unwrap_or_else(|e| panic!("{note}: {:?}", texts(&e)));
        assert_eq!(built.model.loops.len(), 1, "{note}");
        assert!(apart(&built.model) < 1e-9, "{note}");
        assert!(!has(&built, "U022"), "{note}");
    }
    // These say where the first point is, and the other one from the pose at joint zero: the tip
    // of the coupler is at 2 m, 0.8 m along the rocker.
    for (note, kind) in [
        (
            "<gazebo><joint name=\"tip\" type=\"revolute\"><parent>rocker</parent><child>coupler</child>\
          <pose>1 0 0 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint></gazebo>",
            "hinge",
        ),
        (
            "<gazebo><joint name=\"tip\" type=\"revolute\"><parent>rocker</parent><child>coupler</child>\
          <pose relative_to=\"rocker\">0.8 0 0 0.5 0 0</pose>\
          <axis><xyz expressed_in=\"crank\">0 1 0</xyz></axis></joint></gazebo>",
            "hinge",
        ),
        (
            "<gazebo><joint name=\"tip\" type=\"revolute\"><parent>rocker</parent><child>coupler</child>\
          <pose relative_to=\"__model__\">2 0 0 0.5 0 0</pose><axis><xyz>0 1 0</xyz>\
          <use_parent_model_frame>true</use_parent_model_frame></axis></joint></gazebo>",
            "hinge",
        ),
        (
            "<gazebo><joint name=\"tip\" type=\"ball\"><parent>rocker</parent><child>coupler</child>\
          <pose>1 0 0 0 0 0</pose></joint></gazebo>",
            "ball",
        ),
        (
            "<mujoco><equality><connect body1=\"coupler\" body2=\"rocker\" anchor=\"1 0 0\"/></equality></mujoco>",
            "ball",
        ),
    ] {
        let built = built(note, "").unwrap_or_else(|e| panic!("{note}: {:?}", texts(&e)));
        let [closure] = &built.model.loops[..] else {
            panic!("{note}");
        };
        let ends = closure.kind.ends().expect("two ends");
        let on = |link: &str| {
            let mut ends = ends.iter();
            let end = ends.find(|end| {
                end.link
                    .is_some_and(|l| built.model.links[l.index()].name == link)
            });
            end.expect("a link").X_LA.p
        };
        assert!(
            (on("coupler") - Vec3::new(1.0, 0.0, 0.0)).norm() < 1e-12,
            "{note}"
        );
        assert!(
            (on("rocker") - Vec3::new(0.8, 0.0, 0.0)).norm() < 1e-12,
            "{note}"
        );
        match (&closure.kind, kind) {
            (LoopKind::Ball(_), "ball") => {}
            (LoopKind::Hinge(ends), "hinge") => {
                let axis = ends[0].X_LA.R.column(2).into_owned();
                assert!((axis - Vec3::new(0.0, 1.0, 0.0)).norm() < 1e-12, "{note}");
            }
            other => panic!("{note}: {other:?}"),
        }
    }
}

#[test]
fn notes_couple_joints_weld_links_and_hang_springs() {
    let coupled = "<mujoco><equality><joint joint1=\"a\" joint2=\"c\" polycoef=\"0.1 2 0 0 0\"/>\
        <weld body1=\"rocker\" body2=\"coupler\" active=\"false\"/></equality></mujoco>";
    let built_one = built(coupled, "").expect("it closes");
    let LoopKind::Coupler { terms, sum } = &built_one.model.loops[0].kind else {
        panic!("a coupler");
    };
    assert_eq!(
        terms.iter().map(|t| t.factor).collect::<Vec<_>>(),
        [1.0, -2.0]
    );
    assert_eq!(*sum, Some(0.1));
    let q = &built_one.model.initial.joint_positions;
    assert!((q[0] - 2.0 * q[2] - 0.1).abs() < 1e-9, "{q:?}");
    let welded = "<mujoco><equality><weld body1=\"base\" body2=\"crank\" \
        relpose=\"0 0 0 0.7071067811865476 0 -0.7071067811865476 0\"/></equality></mujoco>";
    let built_one = built(welded, "").expect("it closes");
    let a = built_one.model.initial.joint_positions[0];
    assert!((a - std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{a}");
    let spring = "<drake:linear_spring_damper><drake:linear_spring_damper_body_A name=\"coupler\"/>\
        <drake:linear_spring_damper_p_AP value=\"1 0 0\"/>\
        <drake:linear_spring_damper_body_B name=\"world\"/>\
        <drake:linear_spring_damper_p_BQ value=\"4 5 6\"/>\
        <drake:linear_spring_damper_free_length value=\"7.0\"/>\
        <drake:linear_spring_damper_stiffness value=\"8.0\"/>\
        <drake:linear_spring_damper_damping value=\"9.0\"/></drake:linear_spring_damper>";
    let built_one = built(spring, "").expect("a spring");
    let [spring] = &built_one.model.springs[..] else {
        panic!("one spring");
    };
    let numbers = [spring.length, spring.stiffness, spring.damping];
    assert_eq!(format!("{numbers:?}"), "[7.0, 8.0, 9.0]");
    assert_eq!(spring.ends[1].link, None);
}

#[test]
fn notes_that_are_not_used_are_warned_of_by_name() {
    for (note, words) in [
        ("<drake:linear_bushing_rpy/>", "drake:linear_bushing_rpy"),
        ("<drake:tendon_constraint/>", "drake:tendon_constraint"),
        ("<loop name=\"x\" type=\"revolute\"/>", "<loop>"),
        (
            "<loop_joint name=\"x\" type=\"prismatic\"><link1 link=\"coupler\"/><link2 link=\"rocker\"/></loop_joint>",
            "prismatic",
        ),
        (
            "<loop_joint name=\"x\" type=\"spherical\"><link1 link=\"coupler\"/><link2 link=\"rockr\"/></loop_joint>",
            "rockr",
        ),
        (
            "<gazebo><joint name=\"x\" type=\"gearbox\"><parent>crank</parent><child>rocker</child></joint></gazebo>",
            "gearbox",
        ),
        (
            "<gazebo><joint name=\"x\" type=\"ball\"><parent>crank</parent><child>rocker</child>\
          <pose relative_to=\"nothing\">0 0 0 0 0 0</pose></joint></gazebo>",
            "nothing",
        ),
        (
            "<mujoco><equality><joint joint1=\"a\" joint2=\"c\" polycoef=\"0 1 3 0 0\"/></equality></mujoco>",
            "not linear",
        ),
        (
            "<mujoco><equality><tendon tendon1=\"x\"/></equality></mujoco>",
            "<tendon>",
        ),
        (
            "<drake:ball_constraint><drake:ball_constraint_body_A name=\"coupler\"/></drake:ball_constraint>",
            "body_B",
        ),
    ] {
        let found = read(note).diagnostics;
        let found = found.iter().find(|d| d.code == "U022");
        let found = found.unwrap_or_else(|| panic!("{note}"));
        assert!(found.message.contains(words), "{note}: {}", found.message);
        assert!(found.place.is_some(), "{note}");
    }
}

/// A joint that closing a loop has moved is held there by a servo that nobody commands.
#[test]
fn commands_that_are_not_set_follow_what_closes_the_loops() {
    use crate::simulation::ParameterSlot;
    let servos = "[[actuator]]\njoint = \"*\"\nmode = \"none\"\n[[actuator]]\njoint = \"c\"\n\
                  mode = \"position\"\n";
    let model = built("", &format!("{OPEN}{BALL}{servos}"))
        .expect("it closes")
        .model;
    let (crank, rocker) = (JointId(0), JointId(2));
    let own = model.initial.joint_positions[2];
    let command = InputSlot::Position(ActuatorId(0));
    let begun = |position: Option<f64>| {
        let mut s = Simulation::new(Arc::new(model.clone()));
        if let Some(position) = position {
            s.set_parameter(ParameterSlot::InitialJointPosition(crank), position);
        }
        s.initialize(0.0).expect("it closes");
        s
    };
    // The very number of the model, where nothing has been set.
    assert_eq!(begun(None).input(command).to_bits(), own.to_bits());
    let mut s = begun(Some(1.2));
    let found = s.output(OutputSlot::JointPosition(rocker, 0));
    assert!((found - own).abs() > 0.1, "{found} {own}");
    assert_eq!(s.input(command).to_bits(), found.to_bits());
}

/// The crank turns about y: a pin on that axis holds nothing, one beside it by 10 nm all but
/// nothing. A rod that is stretched out at the start holds the crank.
#[test]
fn a_loop_that_holds_nothing_is_told() {
    let pin = |kind: &str, x: f64| {
        format!(
            "[[loop]]\ntype = \"{kind}\"\nlinks = [\"base\", \"crank\"]\n\
             origins = [[{x}, 0.3, 0], [{x}, 0.3, 0]]\n"
        )
    };
    let axes = "axes = [[0, 1, 0], [0, 1, 0]]\n";
    let rod = "[[loop]]\ntype = \"distance\"\nlinks = [\"base\", \"crank\"]\norigins = ";
    let told = |settings: &str| {
        let built = built("", settings).unwrap_or_else(|e| panic!("{settings}: {:?}", texts(&e)));
        let mut found = built.diagnostics.into_iter().filter(|d| d.code == "A140");
        let first = found.next().map(|d| (d.message, d.place.map(|p| p.line)));
        assert!(found.next().is_none(), "{settings}");
        first
    };
    for settings in [
        pin("ball", 0.0),
        pin("hinge", 0.0) + axes,
        format!("{rod}[[0, 0.3, 0], [0, 0.6, 0]]\n"),
        format!("{BALL}{}", pin("ball", 0.0)),
    ] {
        let (message, line) = told(&settings).unwrap_or_else(|| panic!("{settings}"));
        assert!(message.contains("holds nothing"), "{settings}: {message}");
        assert!(line.is_some(), "{settings}");
    }
    let near = told(&pin("ball", 1e-8)).expect("it tells");
    assert!(near.0.contains("nearly nothing"), "{near:?}");
    for settings in [
        BALL.to_owned(),
        pin("ball", 0.01),
        format!("{rod}[[3, 0, 0], [1, 0, 0]]\n"),
    ] {
        assert_eq!(told(&settings), None, "{settings}");
    }
}
