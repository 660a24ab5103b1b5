//! The parts of a robot, as text and as JSON: joints with the columns of PyBullet's `getJointInfo`,
//! links with the inertia that the solver uses.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::columns::Columns;
use crate::describe::{causality, number, variability};
use crate::units;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::sync::Arc;
use urdf2fmu_core::model::{
    Interface, Joint, JointId, JointKind, LinkId, Model, Root, RootId, RootKind,
};
use urdf2fmu_core::settings::FmiVersion;
use urdf2fmu_core::simulation::{OutputSlot, Simulation};
use urdf2fmu_core::spatial::{Mat3, Vec3, quaternion_from_rotation};
use urdf2fmu_core::variables::{Kind, Variable};

/// The robot in a few lines, then its joints and links.
pub fn text(model: &Model) -> String {
    let mut out = format!(
        "{}: {}, {}, {} kg\n",
        model.name,
        if model.is_floating() {
            "floating base"
        } else {
            "fixed base"
        },
        parts(model),
        short(total_mass(model)),
    );
    if model.roots.len() > 1 {
        _ = write!(out, "\nWorld\n{}", things(model).indented());
    }
    if !model.joints.is_empty() {
        _ = write!(out, "\nJoints\n{}", joints(model).indented());
    }
    _ = write!(out, "\nLinks\n{}", links(model).indented());
    out
}

/// `co-simulation`, `Model Exchange`, or both.
pub fn interfaces(model: &Model) -> &'static str {
    match model.outputs.interface {
        Interface::Cs => "co-simulation",
        Interface::Me => "Model Exchange",
        Interface::Both => "co-simulation and Model Exchange",
    }
}

/// The same as the elements of modelDescription.xml.
pub fn elements(model: &Model) -> &'static [&'static str] {
    match model.outputs.interface {
        Interface::Cs => &["CoSimulation"],
        Interface::Me => &["ModelExchange"],
        Interface::Both => &["CoSimulation", "ModelExchange"],
    }
}

/// Which standard an FMU holds to, how it is run, and what identifies it.
///
/// - `guid`: none where there is no FMU yet, since it depends on the libraries inside
pub fn interface(model: &Model, fmi: FmiVersion, guid: Option<&str>) -> String {
    let name = match fmi {
        FmiVersion::V2 => "guid",
        FmiVersion::V3 => "instantiation token",
    };
    let guid = guid.map_or_else(String::new, |guid| format!(", {name} {guid}"));
    format!("\nInterface\n  FMI {fmi}, {}{guid}\n", interfaces(model))
}

/// `1 link`, `2 links`, `2 degrees of freedom`.
pub fn count(n: usize, thing: &str) -> String {
    if n == 1 {
        return format!("1 {thing}");
    }
    match thing.split_once(" of ") {
        Some((head, rest)) => format!("{n} {head}s of {rest}"),
        None => format!("{n} {thing}s"),
    }
}

/// What a tree is: a robot or an object, whether its base moves, and its mass, kg.
fn facts(model: &Model, id: RootId) -> (&'static str, &'static str, f64) {
    let kind = match model.roots[id.index()].kind {
        RootKind::Robot => "robot",
        RootKind::Object => "object",
    };
    let base = if model.floats(id) {
        "floating"
    } else {
        "fixed"
    };
    let own = model.links.iter();
    let own = own.filter(|link| model.root_of(link.body) == id);
    (kind, base, own.map(|link| link.inertia.mass).sum())
}

/// The names of all that stands in the world, the robot first.
fn named(model: &Model) -> impl Iterator<Item = (RootId, &str, &Root)> {
    let roots = model.roots.iter().enumerate();
    roots.map(|(i, root)| {
        let name = if root.name.is_empty() {
            model.name.as_str()
        } else {
            root.name.as_str()
        };
        (RootId::from(i), name, root)
    })
}

/// The robots and objects of a world.
fn things(model: &Model) -> Columns {
    let titles = [
        "name",
        "what",
        "base",
        "mass kg",
        "position x y z m",
        "rpy rad",
    ];
    let mut rows = Columns::new(&titles);
    for (id, name, root) in named(model) {
        let (kind, base, mass) = facts(model, id);
        rows.row([
            name.to_owned(),
            kind.to_owned(),
            base.to_owned(),
            short(mass),
            triple(&root.position),
            triple(&root.rpy),
        ]);
    }
    rows
}

/// What is around the robot, in words; empty for nothing.
pub fn around(model: &Model) -> String {
    /// More than this hide the rest of the report.
    const MOST: usize = 6;
    let others = named(model).skip(1).map(|(id, name, _)| {
        let (kind, base, mass) = facts(model, id);
        format!("{kind} {name} ({base}, {} kg)", short(mass))
    });
    let mut others: Vec<String> = others.collect();
    if others.len() > MOST {
        let more = others.len() - (MOST - 1);
        others.truncate(MOST - 1);
        others.push(format!("and {more} more"));
    }
    others.join(", ")
}

/// What the robot consists of, without what is around it.
pub fn parts(model: &Model) -> String {
    let own = |body| model.root_of(body) == RootId::ROBOT;
    let links = model.links.iter().filter(|link| own(link.body));
    let child = |joint: &&Joint| own(model.links[joint.child.index()].body);
    let freedom = model.dofs.iter().filter(|dof| own(dof.body));
    format!(
        "{}, {}, {}",
        count(links.count(), "link"),
        count(model.joints.iter().filter(child).count(), "joint"),
        count(freedom.count(), "degree of freedom")
    )
}

/// kg, all links of the robot together, without what is around it.
pub fn total_mass(model: &Model) -> f64 {
    let own = model.links.iter();
    let own = own.filter(|link| model.root_of(link.body) == RootId::ROBOT);
    own.map(|link| link.inertia.mass).sum()
}

/// Six significant digits: for eyes, not for computing.
pub fn short(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    number(rounded)
}

fn joints(model: &Model) -> Columns {
    // The 17 of getJointInfo, in its order, and what is commanded.
    let mut rows = Columns::new(&[
        "#",
        "joint",
        "type",
        "q",
        "v",
        "flags",
        "damping",
        "friction",
        "lower",
        "upper",
        "effort",
        "velocity",
        "link",
        "axis",
        "origin x y z m",
        "origin x y z w",
        "parent",
        "command",
    ]);
    for (i, joint) in model.joints.iter().enumerate() {
        let moving = joint.kind != JointKind::Fixed;
        let optional = |x: Option<f64>| x.map_or_else(String::new, short);
        let of_motion = |x: f64| if moving { short(x) } else { String::new() };
        let place = places(model, joint);
        let index = |i: Option<usize>| i.map_or_else(String::new, |i| i.to_string());
        let turn = quaternion_from_rotation(&joint.X_PJ.R);
        rows.row([
            i.to_string(),
            joint.name.clone(),
            joint.kind.name().to_owned(),
            index(place.map(|(q, _)| q)),
            index(place.map(|(_, v)| v)),
            u8::from(is_driven(model, i)).to_string(),
            of_motion(joint.damping),
            of_motion(joint.friction),
            optional(joint.limits.map(|l| l.lower)),
            optional(joint.limits.map(|l| l.upper)),
            optional(joint.effort.filter(|_| moving)),
            optional(joint.velocity.filter(|_| moving)),
            model.links[joint.child.index()].name.clone(),
            if moving && !matches!(joint.kind, JointKind::Floating | JointKind::Spherical) {
                joint
                    .axis
                    .iter()
                    .map(|x| short(*x))
                    .collect::<Vec<_>>()
                    .join(" ")
            } else {
                String::new()
            },
            triple(&joint.X_PJ.p),
            [turn.i, turn.j, turn.k, turn.w].map(short).join(" "),
            model.links[joint.parent.index()].name.clone(),
            command(model, JointId::from(i)),
        ]);
    }
    rows
}

/// First places of a joint in `q` and `v`; none for fixed ones and those that follow others.
fn places(model: &Model, joint: &Joint) -> Option<(usize, usize)> {
    let body = &model.bodies[joint.bodies.first()?.index()];
    let own = joint.mimic.is_none();
    own.then(|| (body.coordinate, body.dof.index()))
}

/// Whether a joint has a motor: PyBullet's flag 1.
fn is_driven(model: &Model, joint: usize) -> bool {
    model.actuators.iter().any(|a| a.joint.index() == joint)
}

/// Three numbers in a cell.
fn triple(v: &Vec3) -> String {
    format!("{} {} {}", short(v.x), short(v.y), short(v.z))
}

/// What drives a joint: an actuator's mode, or the joint that it mimics.
fn command(model: &Model, joint: JointId) -> String {
    if let Some(mimic) = model.joints[joint.index()].mimic {
        let leader = &model.joints[mimic.joint.index()].name;
        let offset = if mimic.offset == 0.0 {
            String::new()
        } else {
            format!(" + {}", short(mimic.offset))
        };
        return format!("{} × {leader}{offset}", short(mimic.multiplier));
    }
    let Some(a) = model.actuators.iter().position(|a| a.joint == joint) else {
        return String::new();
    };
    let mode = format!("{:?}", model.actuators[a].mode).to_lowercase();
    match group(model, a) {
        Some(group) => format!("{mode} of {group}"),
        None => mode,
    }
}

/// The group that an actuator is told with.
fn group(model: &Model, actuator: usize) -> Option<&str> {
    let mut groups = model.outputs.groups.iter();
    groups
        .find(|group| group.actuators.iter().any(|a| a.index() == actuator))
        .map(|group| group.name.as_str())
}

/// Where the links are at the start, as `getLinkState` has it: origin in the world, orientation x,
/// y, z, w.
fn poses(model: &Model) -> Vec<([f64; 3], [f64; 4])> {
    let mut simulation = Simulation::new(Arc::new(model.clone()));
    (0..model.links.len())
        .map(|l| {
            let link = LinkId::from(l);
            (
                [0, 1, 2].map(|axis| simulation.output(OutputSlot::LinkPosition(link, axis))),
                [0, 1, 2, 3].map(|axis| simulation.output(OutputSlot::LinkOrientation(link, axis))),
            )
        })
        .collect()
}

fn links(model: &Model) -> Columns {
    let mut rows = Columns::new(&[
        "#",
        "link",
        "mass kg",
        "com x y z m",
        "ixx kg.m2",
        "iyy",
        "izz",
        "ixy",
        "ixz",
        "iyz",
        "friction",
        "rolling m",
        "spinning m",
        "restitution",
        "position x y z m",
        "orientation x y z w",
        "shapes",
    ]);
    let poses = poses(model);
    for (i, link) in model.links.iter().enumerate() {
        let com = link.inertia.com;
        let I = link.inertia.I_cm;
        let shapes = colliders(model, LinkId::from(i));
        rows.row([
            i.to_string(),
            link.name.clone(),
            short(link.inertia.mass),
            triple(&com),
            short(I[(0, 0)]),
            short(I[(1, 1)]),
            short(I[(2, 2)]),
            short(I[(0, 1)]),
            short(I[(0, 2)]),
            short(I[(1, 2)]),
            short(link.friction),
            short(link.rolling_friction),
            short(link.torsional_friction),
            short(link.restitution),
            poses[i].0.map(short).join(" "),
            poses[i].1.map(short).join(" "),
            shapes.join(" "),
        ]);
    }
    rows
}

fn colliders(model: &Model, link: LinkId) -> Vec<&'static str> {
    use urdf2fmu_core::geometry::Shape;
    model
        .colliders
        .iter()
        .filter(|c| c.link == link)
        .map(|c| match c.shape {
            Shape::Sphere { .. } => "sphere",
            Shape::Capsule { .. } => "capsule",
            Shape::Cylinder { .. } => "cylinder",
            Shape::Box { .. } => "box",
            Shape::Hull { .. } => "hull",
            Shape::Plane => "plane",
            Shape::Field { .. } => "heightfield",
            Shape::Surface { .. } => "triangle mesh",
        })
        .collect()
}

/// `input`, `output`, `fixed parameter`, `tunable parameter`.
pub fn role(v: &Variable) -> String {
    match causality(v) {
        "parameter" => format!("{} parameter", variability(v)),
        other => other.to_owned(),
    }
}

/// FMI's unit name; empty for what is not a Real.
pub fn unit(v: &Variable) -> &'static str {
    if v.kind == Kind::Real {
        units::facts(v.unit).name
    } else {
        ""
    }
}

/// The same for other programs; numbers exact.
pub fn json(model: &Model) -> Value {
    let poses = poses(model);
    json!({
        "robot": model.name,
        "base": if model.is_floating() { "floating" } else { "fixed" },
        "degrees_of_freedom": model.nv(),
        "mass": total_mass(model),
        "world": named(model).map(|(id, name, root)| {
            let (kind, base, mass) = facts(model, id);
            json!({
                "name": name,
                "kind": kind,
                "base": base,
                "mass": mass,
                "position": root.position.as_slice(),
                "rpy": root.rpy.as_slice(),
            })
        }).collect::<Vec<_>>(),
        "joints": model.joints.iter().enumerate().map(|(i, j)| joint_json(model, i, j)).collect::<Vec<_>>(),
        "links": model.links.iter().enumerate().map(|(i, link)| json!({
            "index": i,
            "name": link.name,
            "mass": link.inertia.mass,
            "com": link.inertia.com.as_slice(),
            "inertia": matrix(&link.inertia.I_cm),
            "friction": link.friction,
            "rolling_friction": link.rolling_friction,
            "spinning_friction": link.torsional_friction,
            "restitution": link.restitution,
            "position": poses[i].0,
            "orientation_xyzw": poses[i].1,
            "collision": colliders(model, LinkId::from(i)),
        })).collect::<Vec<_>>(),
    })
}

/// The 17 columns of `getJointInfo`, by PyBullet's names where FMI and URDF have none; frames are
/// the URDF's: the joint's origin in its parent link, not in the parent's inertial frame.
fn joint_json(model: &Model, index: usize, joint: &Joint) -> Value {
    let place = places(model, joint);
    let actuator = model
        .actuators
        .iter()
        .position(|a| a.joint.index() == index);
    let turn = quaternion_from_rotation(&joint.X_PJ.R);
    json!({
        "index": index,
        "name": joint.name,
        "type": joint.kind.name(),
        "q_index": place.map(|(q, _)| q),
        "v_index": place.map(|(_, v)| v),
        "flags": u8::from(actuator.is_some()),
        "mimic": joint.mimic.map(|m| json!({
            "joint": model.joints[m.joint.index()].name,
            "multiplier": m.multiplier,
            "offset": m.offset,
        })),
        "damping": joint.damping,
        "friction": joint.friction,
        "armature": joint.armature,
        "lower": joint.limits.map(|l| l.lower),
        "upper": joint.limits.map(|l| l.upper),
        "max_effort": joint.effort,
        "max_velocity": joint.velocity,
        "link": model.links[joint.child.index()].name,
        "axis": joint.axis.as_slice(),
        "origin_position": joint.X_PJ.p.as_slice(),
        "origin_orientation_xyzw": [turn.i, turn.j, turn.k, turn.w],
        "parent": model.links[joint.parent.index()].name,
        "parent_index": joint.parent.index(),
        "command": actuator.map(|a| format!("{:?}", model.actuators[a].mode).to_lowercase()),
        "group": actuator.and_then(|a| group(model, a)),
    })
}

/// Rows of a symmetric matrix.
fn matrix(m: &Mat3) -> Vec<Vec<f64>> {
    m.row_iter()
        .map(|row| row.iter().copied().collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_keeps_six_digits_and_drops_noise() {
        assert_eq!(short(0.1 + 0.2), "0.3");
        assert_eq!(short(1.0 / 3.0), "0.333333");
        assert_eq!(short(-0.0), "0");
        assert_eq!(short(1e-12), "1e-12");
        assert_eq!(short(14.2), "14.2");
    }

    #[test]
    fn count_spells_plurals() {
        assert_eq!(count(1, "link"), "1 link");
        assert_eq!(count(3, "degree of freedom"), "3 degrees of freedom");
        assert_eq!(count(3, "local variable"), "3 local variables");
    }
}
