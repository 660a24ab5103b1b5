//! Lengths in another unit than m, and how large things are.
//!
//! Meshes in mm, as programs for design write them, and whole files in mm make a robot a thousand
//! times as large, and so a thousand million times less dense. No robot is lighter than the air
//! that it displaces.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::checked::{CheckedRobot, Geometry, Order, called};
use super::description::{
    CollisionDescription, Description, JointDescription, LinkDescription, VisualDescription,
    VisualShape,
};
use super::scope::Scope;
use super::xml::Node;
use crate::digits::Digits;
use crate::geometry::Shape;
use crate::model::JointKind;
use crate::spatial::{Pose, Vec3};
use std::ops::Range;

/// kg/m³, of air at 15 °C and 1013 hPa. Collision shapes are simplified, but real robots have tens
/// to thousands of kg in each m³ of them.
const AIR: f64 = 1.225;

/// kg/m³, of osmium, than which nothing is denser.
const DENSEST: f64 = 22_590.0;

/// Warns of a robot whose shapes together are lighter than air, and would be as dense as things are
/// if their lengths were mm: others have masses that nobody has measured. Gives whether it has
/// warned: whatever compares sizes says nothing new then.
pub(super) fn compare_with_masses(
    scope: &mut Scope,
    robot: &CheckedRobot,
    order: &Order,
    description: &Description,
) -> bool {
    // Links without mass are frames or scenery.
    let heavy = description
        .links
        .iter()
        .enumerate()
        .filter_map(|(i, link)| {
            let mass = link.inertial.map_or(0.0, |inertial| inertial.mass);
            let volume: f64 = link.collisions.iter().map(|c| c.shape.volume()).sum();
            (mass > 0.0 && volume > 0.0).then_some((i, mass, volume))
        });
    let heavy: Vec<(usize, f64, f64)> = heavy.collect();
    let mass: f64 = heavy.iter().map(|(_, mass, _)| mass).sum();
    let volume: f64 = heavy.iter().map(|(_, _, volume)| volume).sum();
    let largest = heavy.iter().max_by(|a, b| a.2.total_cmp(&b.2));
    let in_mm = AIR * volume..DENSEST * volume;
    let Some(&(i, ..)) = largest.filter(|_| in_mm.contains(&(1e9 * mass)) && mass < in_mm.start)
    else {
        return false;
    };
    let link = &description.links[i];
    let balls = link.collisions.iter().map(|c| c.shape.ball_around().1);
    let size = 2.0 * balls.fold(0.0, f64::max);
    let checked = &robot.links[order.links[i]];
    let mesh = checked.collisions.iter().find_map(|c| match &c.geometry {
        Geometry::Mesh { at, .. } => Some(at.clone()),
        _ => None,
    });
    let all = "--scale 0.001, if all lengths of the file are in mm";
    let help = match &mesh {
        Some(_) => {
            format!(
                "write scale=\"0.001 0.001 0.001\" in <mesh>, if meshes are in mm, or pass {all}"
            )
        }
        None => format!("lengths are in m; pass {all}"),
    };
    let message = format!(
        "link '{}': it is {size:.1} m large, so that the robot is lighter than air: {mass:.3} kg in \
         {volume:.1} m³; its lengths look like mm",
        link.name
    );
    let at = mesh.unwrap_or_else(|| checked.node.tag_at());
    scope.report.warning("U067", at, message, help);
    true
}

/// Times the size of a robot beyond which an `<origin>` is told: half-way, by their ratio, between
/// one that is right and one in cm, which is 100 times too far.
const FAR: f64 = 10.0;

/// What is nearer than this is no place in cm, m: it would be a millimetre away. A tip of 1 mm at
/// the end of a top, which touches nothing else, may well be 4 cm below its origin.
const NEAR: f64 = 0.1;

/// A length in m as messages write it: with `decimals` from 1 m on, below by its first digit.
fn written(length: f64, decimals: usize) -> String {
    if length >= 1.0 {
        return format!("{length:.decimals$}");
    }
    let rounded = format!("{length:.0e}").parse().unwrap_or(length);
    Digits(rounded).to_string()
}

/// Warns of origins in mm or cm: of places of joints, shapes and centres of mass that are many
/// times as far away as the robot is large. How large it is, is at most the length of all its
/// links, one behind the other; and of a robot with many links, at most as much as its largest
/// link, or the middle one of its origins if that is more. Robots without shapes have no size to
/// compare with.
pub(super) fn compare_origins(
    scope: &mut Scope,
    robot: &CheckedRobot,
    description: &Description,
    scale: f64,
) {
    let sizes: Vec<f64> = description.links.iter().map(largest).collect();
    let (length, link) = sizes.iter().fold((0.0, 0.0_f64), |(sum, most), size| {
        (sum + size, most.max(*size))
    });
    if length <= 0.0 {
        return;
    }
    let origins = origins(robot, scale);
    let mut ways: Vec<f64> = origins.iter().map(|origin| origin.away).collect();
    ways.retain(|away| *away > 0.0);
    ways.sort_unstable_by(f64::total_cmp);
    let middle = ways.get(ways.len() / 2).copied().unwrap_or(0.0);
    let size = length.min(link.max(middle));
    // As the file writes it, which a scale makes m of.
    let far = |origin: &&Origin| origin.away > FAR * size && origin.away > NEAR * scale;
    let mut found = origins.iter().filter(far);
    if let Some(first) = found.next() {
        let message = format!(
            "{}: the <origin> of <{}> is {} m away, in a robot some {} m large: it looks like mm or cm",
            first.owner,
            first.element,
            written(first.away, 0),
            written(size, 1)
        );
        let mut help =
            "lengths are in m; pass --scale 0.001 if all of the file are in mm".to_owned();
        let more = found.count();
        if more > 0 {
            help = format!("{more} other origins are as far away\n{help}");
        }
        scope
            .report
            .warning("U069", first.at.clone(), message, help);
    }
}

/// Twice the root of the mean square of the way from the centre of mass to the mass of a link, m,
/// of the largest: with moments of inertia `I`, `tr I = 2 ∫ r² dm`.
fn spread(robot: &CheckedRobot) -> f64 {
    let links = robot.links.iter().filter_map(|link| link.inertial.as_ref());
    let ways = links.filter(|own| own.mass > 0.0).map(|own| {
        let trace = own.inertia[0] + own.inertia[3] + own.inertia[5];
        2.0 * (0.5 * trace.max(0.0) / own.mass).sqrt()
    });
    ways.fold(0.0, f64::max)
}

/// How far joints slide, m.
fn slides(description: &Description) -> impl Iterator<Item = f64> {
    let sliding = |joint: &&JointDescription| joint.kind == JointKind::Prismatic;
    let joints = description.joints.iter().filter(sliding);
    joints.filter_map(|joint| Some(joint.limits?.upper - joint.limits?.lower))
}

/// Warns of a visual in mm or cm, in a robot that is else in m: of one that is many times as large
/// as each collision shape, as the place of each joint, shape and centre of mass is away, and as a
/// joint slides; where there is none of these, as the mass is spread, if nothing is that light.
pub(super) fn compare_visuals(
    scope: &mut Scope,
    robot: &CheckedRobot,
    order: &Order,
    description: &Description,
    scale: f64,
) {
    let collisions = description.links.iter().flat_map(|link| &link.collisions);
    let shapes = collisions.map(|c| 2.0 * c.shape.ball_around().1);
    let origins = origins(robot, scale).into_iter();
    let origins = origins.filter(|origin| origin.element != "visual");
    let size = shapes
        .chain(origins.map(|origin| origin.away))
        .chain(slides(description))
        .fold(0.0, f64::max);
    // Where there is no length at all, masses say how large things are.
    let only_drawn = size <= 0.0;
    let size = if only_drawn { spread(robot) } else { size };
    if size <= 0.0 {
        return;
    }
    let in_mm = |i: usize, diameter: f64| {
        let mass = robot.links[i].inertial.as_ref().map_or(0.0, |own| own.mass);
        let volume = Shape::Sphere {
            radius: 0.5 * diameter,
        }
        .volume();
        let of_things = AIR * volume..DENSEST * volume;
        mass < of_things.start && of_things.contains(&(1e9 * mass))
    };
    let links = order.links.iter().zip(&description.links);
    let visuals = links.flat_map(|(&i, link)| {
        let visuals = link.visuals.iter();
        visuals.map(move |visual| (i, link, visual))
    });
    let diameter = |visual| Some(2.0 * drawn_ball(visual, description)?.1);
    let mut found = visuals.filter_map(|(i, link, visual)| {
        let large = diameter(visual).filter(|large| *large > FAR * size)?;
        // An inertia alone may be a placeholder.
        if only_drawn && !in_mm(i, large) {
            return None;
        }
        Some((i, link, visual, large))
    });
    let Some((i, link, visual, large)) = found.next() else {
        return;
    };
    let more = match found.count() {
        0 => String::new(),
        1 => ", another one likewise".to_owned(),
        n => format!(", {n} others likewise"),
    };
    let message = format!(
        "link '{}': its <visual> is {} m large{more}, in a robot some {} m large: it looks like mm \
         or cm",
        link.name,
        written(large, 1),
        written(size, 1)
    );
    let help = match visual.shape {
        VisualShape::Mesh { .. } => {
            "write scale=\"0.001 0.001 0.001\" in <mesh>, if the mesh is in mm; the robot moves as it \
             is, and pictures show the visual"
        }
        VisualShape::Solid(_) => {
            "lengths are in m; the robot moves as it is, and pictures show the visual"
        }
    };
    let nodes = robot.links[i].node.children_named("visual");
    let lines = nodes.map(Node::tag_at);
    let mut at = lines.filter(|at| scope.report.line(at.start) == visual.line);
    let at = at.next().unwrap_or_else(|| robot.links[i].node.tag_at());
    scope.report.warning("U075", at, message, help);
}

/// Warns of a mesh that is many times as far from the frame of its link as the robot is large: its
/// corners are given in the axes of a site or a drawing, and no `<origin>` brings them back. How
/// large the robot is, is as much as its largest shape, or its farthest origin or way to slide.
pub(super) fn compare_places(
    scope: &mut Scope,
    robot: &CheckedRobot,
    order: &Order,
    description: &Description,
    scale: f64,
) {
    let touching = |c: &CollisionDescription| {
        let (center, radius) = c.shape.ball_around();
        Some((c.mesh.is_some(), c.X_LG, center, radius))
    };
    let drawn = |v: &VisualDescription| {
        let (center, radius) = drawn_ball(v, description)?;
        let mesh = matches!(v.shape, VisualShape::Mesh { .. });
        Some((mesh, v.X_LG, center, radius))
    };
    let mut lengths: Vec<f64> = origins(robot, scale).iter().map(|o| o.away).collect();
    lengths.extend(slides(description));
    let mut meshes = Vec::new();
    for (&i, link) in order.links.iter().zip(&description.links) {
        let collisions = link.collisions.iter().filter_map(touching);
        let visuals = link.visuals.iter().filter_map(drawn);
        let collisions = collisions.map(|ball| ("collision", ball));
        for (kind, (mesh, X_LG, center, radius)) in
            collisions.chain(visuals.map(|ball| ("visual", ball)))
        {
            lengths.push(2.0 * radius);
            if mesh {
                meshes.push((&robot.links[i], kind, X_LG.p, X_LG.point(&center)));
            }
        }
    }
    let size = lengths.into_iter().fold(0.0, f64::max);
    let far = |(.., place): &&(_, _, _, Vec3)| {
        let away = place.norm();
        away > FAR * size && away > NEAR * scale
    };
    let Some((link, kind, origin, place)) = meshes.iter().find(far) else {
        return;
    };
    let message = format!(
        "link '{}': the mesh of its <{kind}> is {} m away from its frame, in a robot some {} m \
         large: its corners are far from the origin of their file",
        link.name,
        written(place.norm(), 0),
        written(size, 1)
    );
    let back = (origin - place) / scale;
    let [x, y, z] = [back.x, back.y, back.z].map(Digits);
    let help = format!(
        "move it to its origin in the program that made it; in place of that, xyz=\"{x} {y} {z}\" of \
         the <origin> in <{kind}> brings its middle to the frame"
    );
    let mut nodes = link.node.children_named(kind);
    let of_mesh = |node: &Node| {
        node.child("geometry")
            .is_some_and(|g| g.child("mesh").is_some())
    };
    let at = nodes.find(of_mesh).unwrap_or(link.node).tag_at();
    scope.report.warning("U069", at, message, help);
}

/// Centres and radii of balls around the shapes of a link, in its frame, m: those that touch, or
/// those that are drawn where none touches.
pub(super) fn balls(link: &LinkDescription, description: &Description) -> Vec<(Vec3, f64)> {
    let placed = |X: &Pose, (center, radius): (Vec3, f64)| (X.point(&center), radius);
    if link.collisions.is_empty() {
        let drawn = link.visuals.iter();
        return drawn
            .filter_map(|v| Some(placed(&v.X_LG, drawn_ball(v, description)?)))
            .collect();
    }
    let touching = link.collisions.iter();
    touching
        .map(|c| placed(&c.X_LG, c.shape.ball_around()))
        .collect()
}

/// Centre and radius of a ball around what is drawn, in its own axes, m; none of a mesh that has
/// not been read.
fn drawn_ball(visual: &VisualDescription, description: &Description) -> Option<(Vec3, f64)> {
    match &visual.shape {
        VisualShape::Solid(shape) => Some(shape.ball_around()),
        VisualShape::Mesh { mesh, scale } => {
            let parts = &description.drawn_meshes[*mesh].parts;
            let corners = parts.iter().flat_map(|part| &part.corners);
            let mut corners = corners.map(|corner| corner.component_mul(scale));
            let first = corners.next()?;
            let (least, most) = corners.fold((first, first), |(least, most), corner| {
                (least.inf(&corner), most.sup(&corner))
            });
            Some((0.5 * (least + most), 0.5 * (most - least).norm()))
        }
    }
}

/// The largest extent of a link's shapes from its frame, twice, m; 0 without shapes. Meshes that
/// are only drawn are not read here.
fn largest(link: &LinkDescription) -> f64 {
    let collisions = link.collisions.iter().map(|c| &c.shape);
    let drawn = link
        .visuals
        .iter()
        .filter_map(|visual| match &visual.shape {
            VisualShape::Solid(shape) => Some(shape),
            VisualShape::Mesh { .. } => None,
        });
    let balls = collisions.chain(drawn).map(Shape::ball_around);
    let reaches = balls.map(|(center, radius)| center.norm() + radius);
    2.0 * reaches.fold(0.0, f64::max)
}

/// An `<origin>` of a file.
struct Origin<'a> {
    /// What the element belongs to, as messages call it.
    owner: String,
    /// The element that it stands in.
    element: &'a str,
    /// Place of its `xyz` in the file.
    at: Range<usize>,
    /// How far away it is, m.
    away: f64,
}

/// All origins of links' parts and of joints.
fn origins<'a>(robot: &CheckedRobot<'a>, scale: f64) -> Vec<Origin<'a>> {
    let read = |owner: String, node: Node<'a>| {
        let xyz = node.child("origin")?.attribute("xyz")?;
        let numbers = xyz.value.split_whitespace().map(str::parse::<f64>);
        let squared: f64 = numbers.flatten().map(|number| number * number).sum();
        Some(Origin {
            owner,
            element: node.name(),
            at: xyz.at.clone(),
            away: scale * squared.sqrt(),
        })
    };
    let parts = robot.links.iter().flat_map(|link| {
        let parts = link.node.children();
        let placed =
            parts.filter(|part| ["inertial", "visual", "collision"].contains(&part.name()));
        placed.filter_map(|part| read(called("link", link.name), part))
    });
    let joints = robot.joints.iter();
    parts
        .chain(joints.filter_map(|joint| read(joint.called(), joint.node)))
        .collect()
}

#[cfg(test)]
mod tests;
