//! Checks of `<link>`: mass, shapes, surface.

use super::checked::{CheckedCollision, CheckedInertial, CheckedLink, Geometry, called};
use super::scope::Scope;
use super::xml::Node;
use super::{foreign, habits, inertia};
use crate::diagnostic::Severity;
use crate::diagnostic::words::did_you_mean;
use crate::range::Range as Physical;
use crate::spatial::Vec3;

const CHILDREN: [&str; 4] = ["inertial", "visual", "collision", "contact"];

/// Written by others, read by others.
const FOREIGN: [&str; 10] = [
    "audio_source",
    "collision_checking",
    "gravity",
    "kinematic",
    "material",
    "origin",
    "self_collision_checking",
    "self_filter",
    "sensor",
    "surface",
];

/// Checks a `<link>` that has a name.
pub(super) fn check<'d>(scope: &mut Scope, node: Node<'d>, name: &'d str) -> CheckedLink<'d> {
    scope.owner = called("link", name);
    scope.known_attributes(node, &["name", "type", "concave"]);
    scope.known_children(node, &CHILDREN, &FOREIGN);
    let inertial = scope
        .single(node, "inertial")
        .and_then(|inertial| check_inertial(scope, inertial));
    let mut surface = foreign::contact(scope, node);
    let mut collisions = Vec::new();
    for collision in node.children_named("collision") {
        scope.known_attributes(collision, &["name", "concave", "group", "mask"]);
        scope.known_children(
            collision,
            &["origin", "geometry", "drake:proximity_properties"],
            &["material", "verbose"],
        );
        foreign::proximity(scope, collision, &mut surface);
        let (xyz, rpy) = scope.origin(collision);
        for geometry in geometries(scope, collision) {
            let known = collisions.iter();
            let mut known = known.map(|c: &CheckedCollision| (c.xyz, c.rpy, &c.geometry));
            if known.any(|(p, r, shape)| (p, r) == (xyz, rpy) && shape.same_as(&geometry)) {
                let message = "a <collision> stands twice: its contacts count twice";
                scope.warning("U018", collision.tag_at(), message, "remove one of them");
            }
            collisions.push(CheckedCollision { xyz, rpy, geometry });
        }
    }
    CheckedLink {
        node,
        tag: scope.tag(node),
        name,
        own_name: true,
        inertial,
        collisions,
        visuals: Vec::new(),
        surface,
    }
}

fn check_inertial(scope: &mut Scope, node: Node) -> Option<CheckedInertial> {
    scope.known_attributes(node, &[]);
    scope.known_children(node, &["origin", "mass", "inertia", "density"], &[]);
    let (xyz, rpy) = scope.origin(node);
    let density = scope.single(node, "density");
    let Some(mass_node) = scope.single(node, "mass") else {
        return without_mass(scope, node, density);
    };
    if let Some(density) = density {
        scope.ignore(density);
    }
    let mass = mass(scope, mass_node);
    let inertia_node = scope.single(node, "inertia");
    let inertia = inertia_node.map(|i| moments(scope, i));
    let mass = mass?;
    let Some(inertia_node) = inertia_node else {
        let help =
            "add <inertia ixx=\"…\" ixy=\"0\" ixz=\"0\" iyy=\"…\" iyz=\"0\" izz=\"…\"/>, in kg m²";
        if mass > 0.0 {
            let message = "<inertial> has no <inertia>: that of the collision shapes as solids is \
                           used, without any shape that of a point";
            scope.warning("U063", node.tag_at(), message, help);
        } else {
            let message = "<inertial> has no <inertia>: none is used";
            scope.warning("U063", node.tag_at(), message, help);
        }
        let mut inertial = CheckedInertial {
            xyz,
            rpy,
            mass,
            inertia: [0.0; 6],
            of_shapes: mass > 0.0,
            density: None,
            at: node.tag_at(),
            suspect: None,
        };
        if mass < 0.0 {
            inertia::check(scope, &mut inertial, mass_node, node);
        }
        return Some(inertial);
    };
    let mut values = [0.0; 6];
    for (value, read) in values.iter_mut().zip(inertia?) {
        *value = read?;
    }
    let mut inertial = CheckedInertial {
        xyz,
        rpy,
        mass,
        inertia: values,
        of_shapes: false,
        density: None,
        at: inertia_node.tag_at(),
        suspect: None,
    };
    inertia::check(scope, &mut inertial, mass_node, inertia_node);
    Some(inertial)
}

/// The numbers of `<inertia>` in URDF's order.
fn moments(scope: &mut Scope, i: Node) -> [Option<f64>; 6] {
    inertia::known_attributes(scope, i);
    inertia::NAMES.map(|name| {
        if name == "ixx" || name == "iyy" || name == "izz" {
            let moment = scope.required_number(i, name)?;
            return scope.within(i, name, moment, Physical::Inertia);
        }
        if i.attribute(name).is_none() {
            if let Some(mirrored) = inertia::mirrored(scope, i, name) {
                return scope.within(i, mirrored.0, mirrored.1, Physical::Inertia);
            }
            let message = format!("<inertia> has no {name}");
            let help = habits::content(i, name).unwrap_or_else(|| "0 is used".to_owned());
            scope.warning("U063", i.tag_at(), &message, help);
            return Some(0.0);
        }
        let product = scope.number(i, name)?;
        scope.within(i, name, product, Physical::Inertia)
    })
}

/// The value of `<mass>`, kg.
fn mass(scope: &mut Scope, node: Node) -> Option<f64> {
    scope.leaf(node, &["value"]);
    let mass = scope.required_number(node, "value")?;
    // What is negative or 0 is told with the inertia.
    if mass > 0.0 && mass < Physical::Mass.bounds().0 {
        let at = node
            .attribute("value")
            .map_or_else(|| node.tag_at(), |a| a.at.clone());
        let message = format!("<mass> {mass:e} kg counts as none");
        let help = "give the mass in kg, or, of a frame that does not move, leave <inertial> out";
        scope.warning("U064", at, &message, help);
        Some(0.0)
    } else if mass > 0.0 {
        scope.within(node, "value", mass, Physical::Mass)
    } else {
        Some(mass)
    }
}

/// An `<inertial>` without `<mass>`: by the density that Isaac Gym and others write into it, or
/// none at all.
fn without_mass(
    scope: &mut Scope,
    node: Node,
    density_node: Option<Node>,
) -> Option<CheckedInertial> {
    if let Some(own) = density_node {
        scope.used(own);
        scope.leaf(own, &["value"]);
        let density = scope.required_number(own, "value")?;
        let density = scope.within(own, "value", density, Physical::Density)?;
        return Some(CheckedInertial {
            xyz: Vec3::zeros(),
            rpy: Vec3::zeros(),
            mass: 0.0,
            inertia: [0.0; 6],
            of_shapes: false,
            density: Some(density),
            at: own.tag_at(),
            suspect: None,
        });
    }
    let inertia = node.child("inertia");
    let zero = |name: &str| {
        let number = |node: Node| node.value(name)?.trim().parse::<f64>().ok();
        inertia.is_none_or(|node| node.value(name).is_none() || number(node) == Some(0.0))
    };
    let help = "add <mass value=\"…\"/>, in kg, or let the collision shapes weigh: --density 1000; \
                --missing-mass 0.1 is for what has no shapes";
    if inertia::NAMES.iter().all(|name| zero(name)) {
        let message = "<inertial> has no <mass>: it counts as none";
        scope.warning("U017", node.tag_at(), message, help);
    } else {
        let message = "<inertial> has no <mass>";
        scope.problem(
            "U017",
            node.tag_at(),
            message,
            "add <mass value=\"…\"/>, in kg",
        );
        // What is wrong with it, too, comes next.
        inertia.map(|inertia| moments(scope, inertia));
    }
    None
}

/// The only child of that name; a problem if there is none.
fn required<'d>(
    scope: &mut Scope,
    node: Node<'d>,
    name: &'static str,
    help: &str,
) -> Option<Node<'d>> {
    let child = scope.single(node, name);
    if child.is_none() {
        let message = format!("<{}> has no <{name}>", node.name());
        scope.problem("U017", node.tag_at(), &message, format!("add {help}"));
    }
    child
}

const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "sphere", "mesh"];

/// The shapes of a `<collision>` or `<visual>`: one, by the letter of URDF.
pub(super) fn geometries<'d>(scope: &mut Scope, node: Node<'d>) -> Vec<Geometry<'d>> {
    let Some(geometry) = required(scope, node, "geometry", "<geometry> with one shape") else {
        return Vec::new();
    };
    scope.no_text(geometry);
    let own = |child: &Node| child.name().starts_with("drake:");
    let mut others: Vec<Node> = Vec::new();
    for child in geometry.children() {
        if child.name() == "origin" {
            let message = "<origin> inside <geometry> is not used";
            let help = format!("move it beside <geometry>, directly into <{}>", node.name());
            scope.warning("U074", child.tag_at(), message, help);
            continue;
        }
        // Some exporters write materials here.
        if child.name() == "material" || !own(&child) && scope.prefixed(child, &SHAPES) {
            continue;
        }
        others.push(child);
    }
    // What another program adds to a shape, or its own shape: `<drake:capsule>`.
    let plain = |child: &&Node| !child.name().contains(':');
    let mut shapes: Vec<Node> = others.iter().filter(plain).copied().collect();
    if shapes.is_empty() {
        shapes = others;
    }
    if shapes.is_empty() {
        let help = format!(
            "put one of {} into it",
            SHAPES.map(|s| format!("<{s}>")).join(", ")
        );
        scope.problem("U017", geometry.tag_at(), "<geometry> is empty", help);
    }
    if let Some(second) = shapes.get(1) {
        let message = "a second shape in one <geometry>: all of them are used";
        let help = format!(
            "others take the first alone; write one <{}> for each shape",
            node.name()
        );
        scope.warning("U018", second.tag_at(), message, help);
    }
    let shapes = shapes.into_iter();
    shapes
        .filter_map(|shape| self::shape(scope, shape))
        .collect()
}

/// One shape.
fn shape<'d>(scope: &mut Scope, shape: Node<'d>) -> Option<Geometry<'d>> {
    let name = shape.name();
    match name.rsplit_once(':').map_or(name, |(_, own)| own) {
        "box" => {
            scope.leaf(shape, &["size"]);
            require_attribute(scope, shape, "size", "size=\"x y z\", in m");
            let size = scope.vector::<3>(shape, "size")?;
            let least = size.iter().copied().fold(f64::INFINITY, f64::min);
            not_negative_or_problem(scope, shape, "size", least)?;
            for side in size.into_iter().filter(|&side| side > 0.0) {
                scope.within(shape, "size", side, Physical::Length)?;
            }
            Some(Geometry::Box { size })
        }
        "sphere" => {
            scope.leaf(shape, &["radius"]);
            let radius = length(scope, shape, "radius")?;
            Some(Geometry::Sphere { radius })
        }
        kind @ ("cylinder" | "capsule") => {
            scope.leaf(shape, &["radius", "length"]);
            let (radius, length) = (
                length(scope, shape, "radius"),
                length(scope, shape, "length"),
            );
            let (radius, length) = (radius?, length?);
            Some(if kind == "capsule" {
                Geometry::Capsule { radius, length }
            } else {
                Geometry::Cylinder { radius, length }
            })
        }
        "mesh" => mesh(scope, shape),
        other => {
            let message = format!("unknown shape <{name}>");
            let help = match did_you_mean(other, SHAPES) {
                _ if other == "plane" => "the ground is the FMU's own: leave the plane out, or \
                                          write a large <box>"
                    .to_owned(),
                _ if other == "ellipsoid" => {
                    "write a <mesh> of it, such as one of a ball with three scales".to_owned()
                }
                help if help.is_empty() => format!("known shapes are {}", SHAPES.join(", ")),
                help => help,
            };
            scope.problem("U070", shape.tag_at(), &message, help);
            None
        }
    }
}

fn mesh<'d>(scope: &mut Scope, shape: Node<'d>) -> Option<Geometry<'d>> {
    scope.leaf(shape, &["filename", "scale"]);
    require_attribute(scope, shape, "filename", "filename=\"…\"");
    let scale = match shape.attribute("scale") {
        Some(_) => scope.vector::<3>(shape, "scale"),
        None => Some([1.0; 3]),
    };
    let file = shape.attribute("filename")?;
    let scale = scale?;
    if scale.contains(&0.0) {
        let at = shape
            .attribute("scale")
            .map_or_else(|| shape.tag_at(), |a| a.at.clone());
        let help = "1 leaves the size as it is; -1 mirrors";
        scope.problem("U033", at, "<mesh> scale must not be zero", help);
        return None;
    }
    for factor in scale {
        scope.within(shape, "scale", factor, Physical::MeshScale)?;
    }
    Some(Geometry::Mesh {
        filename: &file.value,
        scale,
        at: file.at.clone(),
    })
}

fn require_attribute(scope: &mut Scope, node: Node, name: &str, help: &str) {
    if node.attribute(name).is_none() {
        scope.missing_attribute(node, name, &format!("write {help}"));
    }
}

/// A length, m.
fn length(scope: &mut Scope, node: Node, name: &str) -> Option<f64> {
    let value = scope.required_number(node, name)?;
    not_negative_or_problem(scope, node, name, value)?;
    if value > 0.0 {
        return scope.within(node, name, value, Physical::Length);
    }
    Some(value)
}

/// Shapes without size are told: of a sphere a point is left, which touches as one. Many files mark
/// contact points and frames so, and other programs take them.
fn not_negative_or_problem(scope: &mut Scope, node: Node, name: &str, least: f64) -> Option<()> {
    if least > 0.0 {
        return Some(());
    }
    let at = node
        .attribute(name)
        .map_or_else(|| node.tag_at(), |a| a.at.clone());
    let drawn = scope.severity < Severity::Error;
    if least < 0.0 || drawn {
        let message = format!("<{}> {name} must be above zero", node.name());
        scope.problem(
            "U033",
            at,
            &message,
            "give the size in m, or remove the shape",
        );
        return None;
    }
    let message = format!(
        "<{}> {name} is 0: the shape touches as the point, line or face that is left of it",
        node.name()
    );
    scope.warning(
        "U033",
        at,
        &message,
        "give the size in m, or remove the shape",
    );
    Some(())
}
