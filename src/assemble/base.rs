//! The choice of the base: fixed to the world or free, by what settings, names, masses and an SRDF
//! say.
//!
//! A base with mass floats unless something says that it is fixed. Files of arms, hands and
//! grippers seldom say it, because others bolt them down; where that seems to be so, the finding is
//! a warning.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::Findings;
use super::robot::Robot;
use crate::model::{JointId, JointKind, LinkId, Motion};
use crate::settings::{BaseChoice, Settings};
use crate::spatial::{Pose, Vec3};
use std::collections::BTreeMap;

/// How a base is mounted.
const MOUNT: &str = "mount it: --fixed-base, or [robot] base = \"fixed\"; --floating-base says \
                     that it is meant";

/// The link that stands for the world where it is the root.
const WORLD: &str = "world";

/// Names of what carries a robot about; words may end so (`quadcopter`).
const CARRIERS: [&str; 9] = [
    "wheel",
    "caster",
    "castor",
    "chassis",
    "footprint",
    "propeller",
    "thruster",
    "copter",
    "flying",
];

/// Names of parts of legs, where they move: a pedestal may have feet, too.
const LEGS: [&str; 10] = [
    "leg", "foot", "feet", "toe", "hip", "thigh", "knee", "calf", "shank", "ankle",
];

/// Names of what hangs on something that is held, or holds it.
const HELD: [&str; 8] = [
    "arm",
    "hand",
    "palm",
    "finger",
    "gripper",
    "manipulator",
    "pedestal",
    "world",
];

/// Whether one of the words of a name is one of these, their plural, or ends so.
fn has_word(name: &str, words: &[&str]) -> bool {
    let mut spaced = String::new();
    let mut before = ' ';
    for sign in name.chars() {
        // A capital begins a word: `LeftHandLink`.
        if before.is_lowercase() && sign.is_uppercase() || !sign.is_alphabetic() {
            spaced.push(' ');
        }
        if sign.is_alphabetic() {
            spaced.extend(sign.to_lowercase());
        }
        before = sign;
    }
    spaced.split_whitespace().any(|word| {
        let one = word.strip_suffix('s').unwrap_or(word);
        let ends = |known: &&str| word.ends_with(known) || one.ends_with(known);
        words.iter().any(ends)
    })
}

/// How the base moves and where it is.
pub(super) struct Base {
    pub(super) motion: Motion,
    /// Pose of the base link in what the settings place.
    pub(super) X_RB: Pose,
}

/// Links that the root carries by fixed joints alone, itself included.
fn base_links(robot: &Robot) -> Vec<bool> {
    let mut on_base = vec![false; robot.links.len()];
    on_base[0] = true;
    for joint in &robot.joints {
        on_base[joint.child.index()] =
            joint.kind == JointKind::Fixed && on_base[joint.parent.index()];
    }
    on_base
}

/// The joint on which all that moves hangs, where that is a limb of several joints: an arm. Legs
/// and wheels are several; what has one joint is as likely a tool or a toy.
fn only_limb<'r>(robot: &'r Robot, on_base: &[bool]) -> Option<&'r str> {
    let mut moving = robot
        .joints
        .iter()
        .filter(|joint| joint.kind != JointKind::Fixed);
    let several = moving.clone().nth(1).is_some();
    let joint = moving.next().filter(|_| several)?;
    let alone = moving.all(|joint| !on_base[joint.parent.index()]);
    alone.then_some(joint.name.as_str())
}

/// Whether the base stands on legs, whatever they are called: at least four equal limbs, each of
/// which reaches below all that is fixed to the base. Fingers of a hand rise above its palm.
fn stands_on_limbs(robot: &Robot, on_base: &[bool]) -> bool {
    /// Two are the arms of a torso, three may be the fingers of a gripper.
    const LEAST: usize = 4;
    // Of each link: its pose, the moving joint by which it hangs on the base, and the kinds of
    // joints up to there.
    let mut poses = vec![Pose::IDENTITY; robot.links.len()];
    let mut limbs: Vec<Option<usize>> = vec![None; robot.links.len()];
    let mut kinds: BTreeMap<usize, (Vec<JointKind>, f64)> = BTreeMap::new();
    let lowest = |link: usize, pose: &Pose| {
        let shapes = robot.shapes[link].iter();
        let heights = shapes.map(|s| s.shape.lowest(&pose.compose(&s.X_LG), &Vec3::z()));
        heights.fold(f64::INFINITY, f64::min)
    };
    let mut floor = lowest(0, &poses[0]);
    for (j, joint) in robot.joints.iter().enumerate() {
        let (parent, child) = (joint.parent.index(), joint.child.index());
        poses[child] = poses[parent].compose(&joint.X_PJ);
        let own = lowest(child, &poses[child]);
        if on_base[child] {
            floor = floor.min(own);
            continue;
        }
        let limb = limbs[parent].unwrap_or(j);
        limbs[child] = Some(limb);
        let (list, end) = kinds.entry(limb).or_insert((Vec::new(), f64::INFINITY));
        list.push(joint.kind);
        *end = end.min(own);
    }
    let low = kinds
        .values()
        .filter(|(_, end)| *end < floor && end.is_finite());
    let legs: Vec<&Vec<JointKind>> = low.map(|(list, _)| list).collect();
    let equal = |leg: &&Vec<JointKind>| legs.iter().filter(|other| *other == leg).count();
    legs.iter().any(|leg| equal(leg) >= LEAST)
}

/// Why it seems that the base of a robot whose joints move is bolted down, which would float: the
/// end of a sentence.
fn seems_bolted(robot: &Robot, on_base: &[bool]) -> Option<String> {
    let links = robot.links.iter().zip(on_base);
    let links = links.map(|(link, still)| (link.name.as_str(), *still));
    let joints = robot.joints.iter();
    let joints = joints.map(|joint| (joint.name.as_str(), on_base[joint.child.index()]));
    let mut names = links.chain(joints).chain([(robot.name.as_str(), true)]);
    let carried =
        |(name, still): (&str, bool)| has_word(name, &CARRIERS) || !still && has_word(name, &LEGS);
    if names.clone().any(carried) {
        return None;
    }
    if let Some(joint) = only_limb(robot, on_base) {
        return Some(format!(
            "all that moves hangs on joint '{joint}', as with an arm that is bolted down: it will \
             fall over"
        ));
    }
    if stands_on_limbs(robot, on_base) {
        return None;
    }
    let (held, _) = names.find(|(name, _)| has_word(name, &HELD))?;
    Some(format!(
        "no name is that of a wheel or a foot, and '{held}' is one of an arm or a hand, which is \
         bolted down: it will fall over"
    ))
}

/// Warns of a link that stands for the world and hangs on a fixed joint, which fixes no base; tells
/// whether there is one.
fn world_hangs(robot: &Robot, findings: &mut Findings) -> bool {
    let mut joints = robot.joints.iter().zip(&robot.tags.joints);
    let found = joints.find(|(joint, _)| {
        joint.kind == JointKind::Fixed && robot.links[joint.child.index()].name == WORLD
    });
    if let Some((joint, tag)) = found {
        let (name, base) = (&joint.name, &robot.links[0].name);
        let message = format!(
            "the base '{base}' is floating, because the link '{WORLD}' is the child of joint \
             '{name}', not its parent"
        );
        let help = format!(
            "exchange <parent> and <child> of joint '{name}', if the robot is bolted down, or {MOUNT}"
        );
        let place = findings.tag(tag);
        findings.warning("A107", place, message, &help);
    }
    found.is_some()
}

/// Warns of a base without a shape from which all that touches hangs by floating joints: it falls
/// by itself, and nothing of it is the robot that one means; tells whether there is one.
fn falls_alone(robot: &Robot, on_base: &[bool], findings: &mut Findings) -> bool {
    let moving = || {
        let joints = robot.joints.iter().zip(&robot.tags.joints);
        joints.filter(|(joint, _)| on_base[joint.parent.index()] && joint.kind != JointKind::Fixed)
    };
    let shapeless = robot.shapes.iter().zip(on_base);
    let shapeless = shapeless
        .filter(|(_, on_base)| **on_base)
        .all(|(s, _)| s.is_empty());
    let loose = moving().all(|(joint, _)| joint.kind == JointKind::Floating);
    // How many links hang on each link, itself included: children come after their parents.
    let mut below = vec![1_usize; robot.links.len()];
    for joint in robot.joints.iter().rev() {
        below[joint.parent.index()] += below[joint.child.index()];
    }
    let largest = moving().max_by_key(|(joint, _)| below[joint.child.index()]);
    let (true, true, Some((joint, tag))) = (shapeless, loose, largest) else {
        return false;
    };
    let (base, body) = (&robot.links[0].name, &robot.links[joint.child.index()].name);
    let message = format!(
        "the base '{base}' touches nothing and falls by itself: '{body}', with {} of {} links, hangs \
         on it by joint '{}', which is floating",
        below[joint.child.index()],
        robot.links.len(),
        joint.name
    );
    let help = format!(
        "base.* and the summary follow '{base}'; make '{body}' the root: remove '{base}' and joint \
         '{}', or list '{body}' in [outputs] links to follow it",
        joint.name
    );
    let place = findings.tag(tag);
    findings.warning("A107", place, message, &help);
    true
}

/// Decides whether the base is fixed or floating; leaves out a root that only stands for the world.
pub(super) fn choose_base(robot: &mut Robot, settings: &Settings, findings: &mut Findings) -> Base {
    let root_joints = || {
        robot
            .joints
            .iter()
            .filter(|joint| joint.parent.index() == 0)
    };
    let root_is_world = robot.links[0].inertia.mass <= 0.0
        && robot.shapes[0].is_empty()
        && root_joints().count() == 1
        && root_joints().all(|joint| joint.kind == JointKind::Floating);
    if root_is_world {
        return leave_out_root(robot, settings, findings);
    }
    let on_base = base_links(robot);
    let mass: f64 = (0..robot.links.len())
        // A density says how heavy it is, not that it can move.
        .filter(|&l| on_base[l] && !robot.weighed[l])
        .map(|l| robot.links[l].inertia.mass)
        .sum();
    let has_moving_child = robot
        .joints
        .iter()
        .any(|joint| joint.kind != JointKind::Fixed && on_base[joint.parent.index()]);
    let name = &robot.links[0].name;
    // PyBullet's plane, tables, trays: without mass, what stands alone stands still.
    let scenery = !has_moving_child && robot.links.iter().all(|link| link.inertia.mass <= 0.0);
    if scenery && settings.base == BaseChoice::Auto {
        let message = format!("nothing in '{}' has mass: it stands still", robot.name);
        let help =
            "the ground is the FMU's own, [world] ground; give a link mass if it should move";
        let place = findings.tag(&robot.tags.links[0]);
        findings.warning("A107", place, message, help);
        return Base {
            motion: Motion::Welded,
            X_RB: Pose::IDENTITY,
        };
    }
    let reason = if name == WORLD {
        Some("the root link is named 'world'".to_owned())
    } else if robot.stands_still && has_moving_child {
        Some("its <gazebo> says <static>; its joints can move here".to_owned())
    } else if robot.stands_still {
        Some("its <gazebo> says <static>".to_owned())
    } else if mass <= 0.0 && has_moving_child {
        Some(format!(
            "the root link '{name}' has no mass and carries moving links"
        ))
    } else {
        None
    };
    let fixed = match settings.base {
        BaseChoice::Fixed => true,
        BaseChoice::Floating => false,
        BaseChoice::Auto => {
            if let Some(reason) = &reason {
                let message = format!("the base is fixed: {reason}");
                findings.note(
                    "A107",
                    message,
                    "set [robot] base = \"floating\" if it can move",
                );
            } else if let Some(joint) = settings.mounting.as_ref().filter(|joint| joint.fixed) {
                let message = format!(
                    "the base '{name}' is floating, but virtual joint '{}' of the SRDF says that it \
                     is bolted down to '{}'",
                    joint.name.text, joint.frame
                );
                let place = joint.name.place.clone();
                findings.warning("A107", place, message, MOUNT);
            } else if world_hangs(robot, findings) || falls_alone(robot, &on_base, findings) {
                // Told.
            } else if settings.mounting.is_none()
                && has_moving_child
                && let Some(why) = seems_bolted(robot, &on_base)
            {
                let message = format!("the base '{name}' is floating, but {why}");
                let place = findings.tag(&robot.tags.links[0]);
                findings.warning("A107", place, message, MOUNT);
            } else {
                let message = format!(
                    "the base is floating (--fixed-base mounts it), its frame is that of '{name}'"
                );
                findings.note(
                    "A107",
                    message,
                    "set [robot] base = \"fixed\" to bolt it down",
                );
            }
            reason.is_some()
        }
    };
    Base {
        motion: if fixed { Motion::Welded } else { Motion::Free },
        X_RB: Pose::IDENTITY,
    }
}

/// Drops the root and its floating joint: the child becomes the base.
fn leave_out_root(robot: &mut Robot, settings: &Settings, findings: &mut Findings) -> Base {
    let root = robot.links.remove(0);
    let joint = robot.joints.remove(0);
    robot.shapes.remove(0);
    robot.weighed.remove(0);
    robot.wheels.remove(0);
    robot.mimics.remove(0);
    robot.tags.links.remove(0);
    robot.tags.joints.remove(0);
    robot.tags.interfaces.remove(0);
    for (l, link) in robot.links.iter_mut().enumerate() {
        link.joint = l.checked_sub(1).map(JointId::from);
    }
    for joint in &mut robot.joints {
        joint.parent = LinkId::from(joint.parent.index() - 1);
        joint.child = LinkId::from(joint.child.index() - 1);
    }
    let fixed = settings.base == BaseChoice::Fixed;
    let message = format!(
        "root link '{}' stands for the world: with its floating joint '{}' it is left out, the base is '{}'{}",
        root.name,
        joint.name,
        robot.links[0].name,
        if fixed { ", fixed" } else { ", floating" }
    );
    findings.note("A107", message, "");
    Base {
        motion: if fixed { Motion::Welded } else { Motion::Free },
        X_RB: joint.X_PJ,
    }
}
