//! The described robot with the settings applied, as links and joints of the model, before bodies
//! are assigned.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::{Findings, counted, listed};
use super::masses::{given_inertia, link_inertia, report_missing_masses, weighed};
use crate::diagnostic::Place;
use crate::diagnostic::angles;
use crate::geometry::Shape;
use crate::model::{ActuatorMode, Joint, JointKind, Limits, Link};
use crate::pattern::names_last;
use crate::settings::{
    Compat, InertiaSource, JointSettings, LinkSettings, STATIC_FRICTION_HELP, Settings, WheelFit,
    static_excess,
};
use crate::spatial::Pose;
use crate::tuning::REFERENCE_GRAVITY;
use crate::urdf::{CollisionDescription, Description, JointDescription, Tag};

/// Stribeck speed of a joint where the settings give none, rad/s or m/s.
const DEFAULT_STRIBECK_VELOCITY: f64 = 0.01;

/// Links and joints in the model's form; mimics by name.
pub(super) struct Robot {
    pub(super) name: String,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
    /// Per joint, as in the file.
    pub(super) mimics: Vec<Option<(String, f64, f64)>>,
    /// Per link.
    pub(super) shapes: Vec<Vec<CollisionDescription>>,
    /// Per link: whether its mass comes from a density, not from the file.
    pub(super) weighed: Vec<bool>,
    /// Per link.
    pub(super) wheels: Vec<WheelChoice>,
    /// As in the file.
    pub(super) stands_still: bool,
    pub(super) tags: Tags,
}

/// What the URDF says of links and joints that the model does not keep: places, interfaces.
pub(super) struct Tags {
    /// Per link: its tag.
    pub(super) links: Vec<Tag>,
    /// Per joint: its tag.
    pub(super) joints: Vec<Tag>,
    /// Per joint: what its hardware takes, as the file says.
    pub(super) interfaces: Vec<Vec<ActuatorMode>>,
}

impl Tags {
    fn of(description: &Description) -> Self {
        let (links, joints) = (description.links.iter(), description.joints.iter());
        Self {
            links: links.map(|link| link.tag.clone()).collect(),
            interfaces: joints.clone().map(|j| j.interfaces.clone()).collect(),
            joints: joints.map(|joint| joint.tag.clone()).collect(),
        }
    }
}

/// What the settings want to be made of a link's meshes.
pub(super) struct WheelChoice {
    pub(super) fit: WheelFit,
    pub(super) place: Option<Place>,
}

/// A turning or sliding joint.
pub(super) fn is_scalar(kind: JointKind) -> bool {
    matches!(
        kind,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic
    )
}

/// What a joint of this kind is called in a sentence.
pub(super) fn kind_name(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Fixed => "is fixed",
        JointKind::Planar => "is planar",
        JointKind::Floating => "is floating",
        JointKind::Spherical => "is spherical",
        JointKind::Revolute | JointKind::Continuous => "turns",
        JointKind::Prismatic => "slides",
    }
}

impl Robot {
    pub(super) fn new(
        description: &Description,
        settings: &Settings,
        findings: &mut Findings,
    ) -> Self {
        let joint_overrides = joint_overrides(description, &settings.joints, findings);
        let link_overrides = link_overrides(description, settings, findings);
        let mut robot = Self {
            name: description.name.clone(),
            links: Vec::new(),
            joints: Vec::new(),
            mimics: description.joints.iter().map(|j| j.mimic.clone()).collect(),
            shapes: description
                .links
                .iter()
                .map(|link| link.collisions.clone())
                .collect(),
            weighed: description
                .links
                .iter()
                .map(|link| weighed(link, settings).is_some())
                .collect(),
            wheels: link_overrides
                .iter()
                .map(|link| WheelChoice {
                    fit: link.wheel_fit.unwrap_or(WheelFit::Auto),
                    place: link.link.place.clone(),
                })
                .collect(),
            stands_still: description.stands_still,
            tags: Tags::of(description),
        };
        let mut unlimited = Vec::new();
        for (joint, overrides) in description.joints.iter().zip(&joint_overrides) {
            let joint = model_joint(joint, overrides, settings.compat, &mut unlimited, findings);
            robot.joints.push(joint);
        }
        report_unlimited(&unlimited, findings);
        let mut default_friction = 0;
        for (l, (link, overrides)) in description.links.iter().zip(&link_overrides).enumerate() {
            let friction = overrides.friction.or(link.friction);
            default_friction += usize::from(friction.is_none() && !link.collisions.is_empty());
            let friction = friction.unwrap_or(settings.compat.link_friction());
            let static_friction = overrides.static_friction.or_else(|| {
                // The file's two go together; a sliding friction of the settings stands alone.
                let file = link
                    .static_friction
                    .filter(|_| overrides.friction.is_none());
                file.filter(|&at_rest| at_rest >= friction)
            });
            let static_friction = static_friction.unwrap_or(friction);
            let static_excess = static_excess(friction, static_friction).unwrap_or_else(|| {
                let message = format!(
                    "the friction {static_friction} of link '{}' at rest does not go with its friction {friction}",
                    link.name
                );
                let place = overrides.link.place.clone();
                findings.error("A125", place, message, STATIC_FRICTION_HELP);
                0.0
            });
            robot.links.push(Link {
                name: link.name.clone(),
                joint: l.checked_sub(1).map(Into::into),
                body: 0.into(),
                X_BL: Pose::IDENTITY,
                inertia: link_inertia(link, overrides, settings, findings),
                friction,
                restitution: overrides.restitution.or(link.restitution).unwrap_or(0.0),
                static_excess,
                rolling_friction: overrides
                    .rolling_friction
                    .or(link.rolling_friction)
                    .unwrap_or(0.0),
                torsional_friction: overrides
                    .torsional_friction
                    .or(link.torsional_friction)
                    .unwrap_or(0.0),
                stiffness: overrides.stiffness,
                dissipation: overrides.dissipation,
            });
        }
        if settings.compat == Compat::PyBullet {
            robot.take_springs(description);
        }
        if default_friction > 0 {
            let message = format!(
                "the friction coefficient of {} is not given and taken as {}",
                counted(default_friction, "link"),
                settings.compat.link_friction()
            );
            let help = "set [link.\"…\"] friction, or link.<name>.friction in the FMU";
            findings.note("A116", message, help);
        }
        report_sources(description, settings, findings);
        robot
    }
}

impl Robot {
    /// Takes over the contact springs of the file that the settings leave open. They are those of
    /// each of `PyBullet`'s contact points, of which a face has four; here a contact has one for
    /// all. The damping, N·s/m, is `PyBullet`'s where it matters, under the robot's weight: there
    /// it is the load times the dissipation.
    fn take_springs(&mut self, description: &Description) {
        let mass: f64 = self.links.iter().map(|link| link.inertia.mass).sum();
        let load = mass * REFERENCE_GRAVITY;
        for (link, file) in self.links.iter_mut().zip(&description.links) {
            let shapes = file.collisions.iter().map(|collision| &collision.shape);
            let points = shapes.map(contact_points).fold(1.0, f64::max);
            let stiffness = file.stiffness.filter(|&k| k > 0.0).map(|k| k * points);
            link.stiffness = link.stiffness.or(stiffness);
            let dissipation = file.damping.filter(|_| load > 0.0);
            link.dissipation = link.dissipation.or(dissipation.map(|c| c * points / load));
        }
    }
}

/// With how many points a shape that lies on the ground touches it in `PyBullet`.
fn contact_points(shape: &Shape) -> f64 {
    match shape {
        Shape::Sphere { .. } | Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => 1.0,
        Shape::Capsule { .. } => 2.0,
        Shape::Box { .. } | Shape::Cylinder { .. } | Shape::Hull { .. } => 4.0,
    }
}

/// What the settings say about each joint; later entries win, plain names over globs.
fn joint_overrides(
    description: &Description,
    settings: &[JointSettings],
    findings: &mut Findings,
) -> Vec<JointSettings> {
    let names: Vec<&str> = description.joints.iter().map(|j| j.name.as_str()).collect();
    let mut merged = vec![JointSettings::new(""); names.len()];
    for entry in names_last(settings, |entry| &entry.joint) {
        let limited = entry.lower.is_some() || entry.upper.is_some();
        let unsuitable = |j: usize| {
            let kind = description.joints[j].kind;
            match kind {
                JointKind::Fixed => Some("is fixed: it has no such property".to_owned()),
                JointKind::Planar | JointKind::Floating | JointKind::Spherical if limited => {
                    Some(format!(
                        "{}: only turning and sliding joints have limits",
                        kind_name(kind)
                    ))
                }
                _ => None,
            }
        };
        let meant = findings.select(&entry.joint, "joint", &names, unsuitable);
        let turns = |&&j: &&usize| {
            let kind = description.joints[j].kind;
            matches!(kind, JointKind::Revolute | JointKind::Continuous)
        };
        if let Some(&j) = meant.iter().find(turns)
            && let Some(told) = angles::limits([entry.lower, entry.upper])
        {
            let message = format!("joint '{}': {}", names[j], told.message);
            if told.certain {
                findings.warning("S104", entry.joint.place.clone(), message, angles::HELP);
            } else {
                findings.note("S104", message, angles::HELP);
            }
        }
        for j in meant {
            let joint = &mut merged[j];
            joint.damping = entry.damping.or(joint.damping);
            joint.friction = entry.friction.or(joint.friction);
            joint.armature = entry.armature.or(joint.armature);
            joint.static_friction = entry.static_friction.or(joint.static_friction);
            joint.stribeck_velocity = entry.stribeck_velocity.or(joint.stribeck_velocity);
            joint.enforce_velocity = entry.enforce_velocity.or(joint.enforce_velocity);
            joint.lower = entry.lower.or(joint.lower);
            joint.upper = entry.upper.or(joint.upper);
            joint.effort = entry.effort.or(joint.effort);
            joint.velocity = entry.velocity.or(joint.velocity);
            if limited || entry.static_friction.is_some() {
                joint.joint.place.clone_from(&entry.joint.place);
            }
        }
    }
    merged
}

/// What the settings say about each link; later entries win, plain names over globs.
fn link_overrides(
    description: &Description,
    settings: &Settings,
    findings: &mut Findings,
) -> Vec<LinkSettings> {
    let names: Vec<&str> = description.links.iter().map(|l| l.name.as_str()).collect();
    let mut merged = vec![LinkSettings::new(""); names.len()];
    for entry in names_last(&settings.links, |entry| &entry.link) {
        let unsuitable = |l: usize| {
            let meshes = description.links[l]
                .collisions
                .iter()
                .any(|c| c.mesh.is_some());
            if entry.collision.is_some() && !meshes {
                return Some("has no collision mesh".to_owned());
            }
            let massless =
                given_inertia(&description.links[l], settings).is_none_or(|i| i.mass <= 0.0);
            (entry.mass.is_some() && massless)
                .then(|| "has no <inertial> with mass whose mass could be replaced".to_owned())
        };
        for l in findings.select(&entry.link, "link", &names, unsuitable) {
            let link = &mut merged[l];
            link.friction = entry.friction.or(link.friction);
            link.restitution = entry.restitution.or(link.restitution);
            link.static_friction = entry.static_friction.or(link.static_friction);
            link.rolling_friction = entry.rolling_friction.or(link.rolling_friction);
            link.torsional_friction = entry.torsional_friction.or(link.torsional_friction);
            if entry.static_friction.is_some() || entry.wheel_fit.is_some() {
                link.link.place.clone_from(&entry.link.place);
            }
            link.stiffness = entry.stiffness.or(link.stiffness);
            link.dissipation = entry.dissipation.or(link.dissipation);
            link.mass = entry.mass.or(link.mass);
            link.wheel_fit = entry.wheel_fit.or(link.wheel_fit);
        }
    }
    merged
}

/// Where masses and inertias come from.
fn report_sources(description: &Description, settings: &Settings, findings: &mut Findings) {
    if settings.inertia == InertiaSource::PyBullet {
        let message = "rotational inertia is computed as PyBullet does, of the box around each link's collision shapes; masses and centres of mass are the file's";
        findings.note("A119", message.to_owned(), "");
    }
    report_missing_masses(description, settings, findings);
    if settings.inertia == InertiaSource::Collision {
        let message = "rotational inertia is computed from the collision shapes as solids; masses and centres of mass are the file's";
        findings.note("A119", message.to_owned(), "");
    }
}

fn report_unlimited(joints: &[String], findings: &mut Findings) {
    if joints.is_empty() {
        return;
    }
    let message = format!(
        "the velocity limit 0 of {} counts as none: {}",
        counted(joints.len(), "joint"),
        listed(joints)
    );
    findings.note("A115", message, "");
}

/// Adds the name to `unlimited` where a velocity limit of 0 counts as none.
fn model_joint(
    joint: &JointDescription,
    overrides: &JointSettings,
    compat: Compat,
    unlimited: &mut Vec<String>,
    findings: &mut Findings,
) -> Joint {
    let scalar = is_scalar(joint.kind);
    let place = || findings.tag(&joint.tag);
    let place = place();
    let name = &joint.name;
    let mut damping = overrides.damping.unwrap_or(joint.damping);
    let mut friction = overrides.friction.unwrap_or(joint.friction);
    let mut armature = overrides.armature.unwrap_or(joint.armature);
    if joint.kind == JointKind::Spherical {
        // Damping acts against any turning alike; friction and rotors have an axis.
        if friction + armature > 0.0 {
            let message = format!(
                "joint '{name}' is spherical: its dry friction and armature are not used, its damping is"
            );
            findings.warning("A122", place.clone(), message, "");
        }
        (friction, armature) = (0.0, 0.0);
    } else if !scalar {
        if damping + friction + armature > 0.0 && joint.kind != JointKind::Fixed {
            let message = format!(
                "joint '{name}' {}: its damping, dry friction and armature are not used",
                kind_name(joint.kind)
            );
            let help = "one number cannot mean both sliding and turning";
            findings.warning("A122", place.clone(), message, help);
        }
        (damping, friction, armature) = (0.0, 0.0, 0.0);
    }
    let static_friction = overrides.static_friction.unwrap_or(friction);
    let static_excess = static_excess(friction, static_friction).unwrap_or_else(|| {
        let message = format!(
            "the friction {static_friction} of joint '{name}' at rest does not go with its friction {friction}"
        );
        let place = overrides.joint.place.clone();
        findings.error("A125", place, message, STATIC_FRICTION_HELP);
        0.0
    });
    // Infinite means no limit.
    let usable = |value: Option<f64>| value.filter(|value| value.is_finite() && *value >= 0.0);
    let velocity = overrides.velocity.or(compat.largest_speed());
    let velocity = usable(velocity.or(joint.velocity)).filter(|_| scalar);
    if velocity == Some(0.0) {
        unlimited.push(name.clone());
    }
    Joint {
        name: name.clone(),
        kind: joint.kind,
        parent: joint.parent.into(),
        child: joint.child.into(),
        X_PJ: joint.X_PJ,
        axis: joint.axis,
        bodies: Vec::new(),
        limits: limits(joint, overrides, findings).filter(|_| scalar),
        effort: usable(overrides.effort.or(joint.effort)).filter(|_| scalar),
        velocity: velocity.filter(|&velocity| velocity > 0.0),
        damping,
        friction,
        armature,
        static_excess,
        stribeck_velocity: overrides
            .stribeck_velocity
            .unwrap_or(DEFAULT_STRIBECK_VELOCITY),
        enforce_velocity: overrides
            .enforce_velocity
            .unwrap_or(scalar && compat.largest_speed().is_some()),
        mimic: None,
    }
}

/// The file's limits with those of the settings; none where they are no range.
fn limits(
    joint: &JointDescription,
    overrides: &JointSettings,
    findings: &mut Findings,
) -> Option<Limits> {
    let file = joint.limits;
    if overrides.lower.is_none() && overrides.upper.is_none() && file.is_none() {
        return None;
    }
    let lower = overrides.lower.or(file.map(|l| l.lower));
    let upper = overrides.upper.or(file.map(|l| l.upper));
    let (Some(lower), Some(upper)) = (lower, upper) else {
        let message = format!(
            "joint '{}' has no limits in the file, the settings give one side only",
            joint.name
        );
        let place = overrides.joint.place.clone();
        findings.error("A117", place, message, "give both lower and upper");
        return None;
    };
    let range = format!("{lower} … {upper}");
    if overrides.lower.or(overrides.upper).is_some() && lower > upper {
        let message = format!("the limits {range} of joint '{}' are no range", joint.name);
        let place = overrides.joint.place.clone();
        findings.error("A117", place, message, "give both lower and upper");
        return None;
    }
    if !(lower.is_finite() && upper.is_finite() && lower <= upper) {
        let message = format!(
            "the limits {range} of joint '{}' are no range and count as none",
            joint.name
        );
        let help = "correct them, or use type=\"continuous\"";
        findings.warning("A117", findings.tag(&joint.tag), message, help);
        return None;
    }
    #[expect(clippy::float_cmp, reason = "a range without width")]
    if lower == upper {
        let message = format!("the limits of joint '{}' keep it at {lower}", joint.name);
        let help = "correct them, or use type=\"fixed\"";
        findings.warning("A117", findings.tag(&joint.tag), message, help);
    }
    Some(Limits { lower, upper })
}
