//! Whether a base floats, and whether the finding about it stands out.

use super::*;
use crate::settings::{Mounting, Settings};

/// A robot with a base of 1 kg and limbs: each a list of joints with their links, in series.
fn with_limbs(base: &str, limbs: &[&[&str]]) -> Description {
    let mut built = robot(mass(base, 1.0));
    for limb in limbs {
        let mut parent = base;
        for link in *limb {
            let (kind, name) = match link.strip_prefix('=') {
                Some(name) => (Fixed, name),
                None => (Revolute, *link),
            };
            let joint = format!("{name}_joint");
            built = built.with(parent, &joint, kind, at(0.1, 0.0, 0.0), mass(name, 1.0));
            parent = name;
        }
    }
    built
}

/// Robots of public collections made small. `=`: on a fixed joint.
#[test]
fn what_others_bolt_down_stands_out_by_its_limbs_or_names() {
    let bolted: [(&str, &[&[&str]]); 10] = [
        // kinova, panda; a double pendulum, PyBullet's TwoJointRobot.
        ("base", &[&["l1", "l2", "l3", "l4", "l5", "l6"]]),
        ("base_link", &[&["link1", "link2"]]),
        // Sawyer: its feet do not move.
        (
            "base",
            &[&["=pedestal", "=pedestal_feet"], &["l0", "l1", "l2"]],
        ),
        // Baxter, Nextage, YuMi, the upper body of G1.
        (
            "base",
            &[
                &["=pedestal"],
                &["head"],
                &["left_e0", "left_e1"],
                &["right_e0", "right_e1"],
            ],
        ),
        (
            "WAIST",
            &[&["HEAD_Link"], &["RARM_JOINT0_Link"], &["LARM_JOINT0_Link"]],
        ),
        (
            "yumi_body",
            &[&["link_1_r", "gripper_r"], &["link_1_l", "gripper_l"]],
        ),
        (
            "waist_yaw_link",
            &[
                &["left_shoulder", "left_hand"],
                &["right_shoulder", "right_hand"],
            ],
        ),
        // The Allegro hand, grippers of the PR2 and of Franka.
        ("palm_link", &[&["a1", "a2"], &["b1", "b2"], &["c1", "c2"]]),
        ("gripper_pole", &[&["left"], &["right"]]),
        ("base", &[&["LeftFingers"], &["RightFingers"]]),
    ];
    let free: [(&str, &[&[&str]]); 9] = [
        // PR2, whose wheels are not in the file; TIAGo.
        ("base_footprint", &[&["torso", "arm_1", "arm_2", "arm_3"]]),
        (
            "base_link",
            &[
                &["wheel_left"],
                &["wheel_right"],
                &["arm_1", "arm_2", "gripper"],
            ],
        ),
        // TALOS, Spot with an arm, a hopper.
        (
            "pelvis",
            &[
                &["LHipYaw", "l2"],
                &["RHipYaw", "r2"],
                &["left_arm", "left_hand"],
            ],
        ),
        (
            "body",
            &[&["fl_upperleg"], &["fr_upperleg"], &["arm0", "arm1"]],
        ),
        ("trunk", &[&["thigh", "shank", "foot"]]),
        // Flying arms, drones, a crawler with a bucket, what has a lid, a table of drawers.
        (
            "hextilt",
            &[&["flying_arm_1", "flying_arm_2", "flying_arm_3"]],
        ),
        ("chassis", &[&["swing", "boom", "stick"]]),
        ("box", &[&["lid"]]),
        ("kitchen", &[&["drawer_1"], &["drawer_2"], &["handle"]]),
    ];
    for (robots, severity) in [
        (&bolted[..], Severity::Warning),
        (&free[..], Severity::Note),
    ] {
        for (base, limbs) in robots {
            let description = with_limbs(base, limbs);
            let built = assembled(&description, "");
            assert!(built.model.is_floating(), "{base} {limbs:?}");
            let found = note(&built, "A107");
            assert_eq!(
                found.severity, severity,
                "{base} {limbs:?}: {}",
                found.message
            );
            let said = found.message.contains("bolted down");
            assert_eq!(said, severity == Severity::Warning, "{}", found.message);
            // What is said is no longer guessed.
            let meant = assembled(&description, "robot.base = \"floating\"");
            assert!(!has(&meant, "A107"), "{base}");
        }
    }
}

/// MoveIt's setup assistant writes it for arms; a planar or floating one is that of what drives,
/// walks or flies.
#[test]
fn the_virtual_joint_of_an_srdf_says_whether_the_base_is_bolted_down() {
    let mounted = |description: &Description, fixed: bool| {
        let settings = Settings {
            mounting: Some(Mounting {
                name: "to_world".into(),
                frame: "table".to_owned(),
                fixed,
            }),
            ..Settings::default()
        };
        crate::assemble::build(description, &settings).expect("a robot")
    };
    // It is told whatever else the names say.
    for limbs in [&[&["lid"][..]][..], &[&["wheel_left"], &["wheel_right"]]] {
        let built = mounted(&with_limbs("box", limbs), true);
        let found = note(&built, "A107");
        assert_eq!(found.severity, Severity::Warning);
        let message = &found.message;
        assert!(
            message.contains("virtual joint 'to_world'")
                && message.contains("bolted down to 'table'"),
            "{message}"
        );
        assert!(
            found
                .help
                .as_deref()
                .is_some_and(|help| help.contains("--fixed-base"))
        );
    }
    // An arm that is said to move is meant to.
    let arm = with_limbs("base", &[&["l1", "l2", "l3", "l4"]]);
    assert_eq!(note(&mounted(&arm, false), "A107").severity, Severity::Note);
    assert_eq!(
        note(&mounted(&arm, true), "A107").severity,
        Severity::Warning
    );
    // A base that is fixed anyway has nothing to be warned of.
    let world =
        robot(mass("world", 1.0)).with("world", "j", Revolute, at(0.0, 0.0, 0.0), mass("tip", 1.0));
    let built = mounted(&world, true);
    assert!(!built.model.is_floating());
    assert_eq!(note(&built, "A107").severity, Severity::Note);
}

#[test]
fn a_world_that_hangs_on_the_robot_is_told_with_the_exchange_that_bolts_it_down() {
    let description = with_limbs("box", &[&["lid"], &["=world"]]);
    let built = assembled(&description, "");
    let found = note(&built, "A107");
    assert_eq!(found.severity, Severity::Warning, "{}", found.message);
    assert!(found.message.contains("'world_joint', not its parent"));
    let help = found.help.as_deref().expect("advice");
    assert!(help.contains("exchange <parent> and <child> of joint 'world_joint'"));
    assert!(!has(
        &assembled(&description, "robot.base = \"floating\""),
        "A107"
    ));
}

/// A box of 0.4 × 0.3 × 0.1 m with limbs of three joints at its corners, whose balls of 0.1 m are
/// `fall` m below each other.
fn with_corners(corners: &[[f64; 2]], fall: f64) -> Description {
    let half = Vec3::new(0.2, 0.15, 0.05);
    let mut built = robot(LinkDescription {
        collisions: vec![collision(Pose::IDENTITY, Shape::Box { half })],
        ..mass("base_link", 1.0)
    });
    for (k, [x, y]) in corners.iter().enumerate() {
        let names = ["shoulder", "arm", "hand"].map(|part| format!("limb_{k}_{part}_link"));
        let mut parent = "base_link".to_owned();
        for (i, name) in names.into_iter().enumerate() {
            let X_PJ = if i == 0 {
                at(*x, *y, 0.0)
            } else {
                at(0.0, 0.0, -fall)
            };
            let joint = format!("{parent}_to_{k}_{i}");
            built = built.with(&parent, &joint, Revolute, X_PJ, body(&name, 0.2));
            parent = name;
        }
    }
    built
}

/// A quadruped of students, whose legs are called shoulder, arm and hand, stands at 0.381 m for
/// 3 s.
#[test]
fn four_equal_limbs_that_carry_the_base_are_legs_whatever_they_are_called() {
    let corners = [[0.2, 0.1], [0.2, -0.1], [-0.2, 0.1], [-0.2, -0.1]];
    let severity = |description: &Description| {
        let built = assembled(description, "");
        note(&built, "A107").severity
    };
    assert_eq!(severity(&with_corners(&corners, 0.15)), Severity::Note);
    // Three, and four that rise from the base as fingers from a palm.
    assert_eq!(
        severity(&with_corners(&corners[..3], 0.15)),
        Severity::Warning
    );
    let palm = with_corners(&corners, 0.15);
    let mut risen = palm.clone();
    for joint in &mut risen.joints {
        joint.X_PJ.p.z = -joint.X_PJ.p.z + 0.1;
    }
    assert_eq!(severity(&risen), Severity::Warning);
    // One that differs.
    let mut odd = palm;
    odd.joints[2].kind = Fixed;
    assert_eq!(severity(&odd), Severity::Warning);
}

/// As Blender's exporter writes it: an empty root with mass, from which body and feet hang freely.
#[test]
fn a_root_that_falls_without_its_robot_is_told_with_the_link_that_carries_it() {
    let loose = |root: LinkDescription, kind| {
        robot(root)
            .with(
                "root",
                "foot_joint",
                Floating,
                at(0.3, 0.0, 0.0),
                body("foot", 0.1),
            )
            .with(
                "root",
                "body_joint",
                kind,
                at(0.0, 0.0, 0.1),
                body("body", 2.0),
            )
            .with(
                "body",
                "hip",
                Revolute,
                at(0.2, 0.0, 0.0),
                body("thigh", 0.2),
            )
    };
    let built = assembled(&loose(mass("root", 0.1), Floating), "");
    let found = note(&built, "A107");
    assert_eq!(found.severity, Severity::Warning, "{}", found.message);
    assert!(
        found
            .message
            .contains("'root' touches nothing and falls by itself")
            && found.message.contains("'body', with 2 of 4 links"),
        "{}",
        found.message
    );
    let help = found.help.expect("advice");
    assert!(
        help.contains("make 'body' the root") && help.contains("'body_joint'"),
        "{help}"
    );
    // A root that touches, and one that carries the body.
    for (root, kind) in [(body("root", 0.1), Floating), (mass("root", 0.1), Revolute)] {
        let built = assembled(&loose(root, kind), "");
        let told = note(&built, "A107").message;
        assert!(!told.contains("falls by itself"), "{told}");
    }
}
