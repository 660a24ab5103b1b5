//! Lengths in another unit than m, and how large things are.
//!
//! Meshes in mm, as programs for design write them, and whole files in mm make a robot a thousand
//! times as large, and so a thousand million times less dense. No robot is lighter than the air
//! that it displaces.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::checked::{CheckedRobot, Geometry, Order, called};
use super::description::{
    Description, JointDescription, LinkDescription, VisualDescription, VisualShape,
};
use super::scope::Scope;
use super::xml::Node;
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
    let mut found = origins.iter().filter(|origin| origin.away > FAR * size);
    if let Some(first) = found.next() {
        let message = format!(
            "{}: the <origin> of <{}> is {:.0} m away, in a robot some {size:.1} m large: \
             it looks like mm or cm",
            first.owner, first.element, first.away
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

/// Warns of a visual in mm or cm, in a robot that is else in m: of one that is many times as large
/// as each collision shape, as the place of each joint, shape and centre of mass is away, and as a
/// joint slides.
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
    let sliding = |joint: &&JointDescription| joint.kind == JointKind::Prismatic;
    let slides = description.joints.iter().filter(sliding);
    let ways = slides.filter_map(|joint| Some(joint.limits?.upper - joint.limits?.lower));
    let size = shapes
        .chain(origins.map(|origin| origin.away))
        .chain(ways)
        .fold(0.0, f64::max);
    if size <= 0.0 {
        return;
    }
    let links = order.links.iter().zip(&description.links);
    let visuals = links.flat_map(|(&i, link)| {
        let visuals = link.visuals.iter();
        visuals.map(move |visual| (i, link, visual))
    });
    let diameter = |visual| Some(2.0 * drawn_ball(visual, description)?.1);
    let mut found = visuals.filter_map(|(i, link, visual)| {
        let large = diameter(visual).filter(|large| *large > FAR * size)?;
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
        "link '{}': its <visual> is {large:.1} m large{more}, in a robot some {size:.1} m large: it \
         looks like mm or cm",
        link.name
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
mod tests {
    use crate::diagnostic::Diagnostic;
    use crate::urdf::{ReadOptions, read_str};
    use std::path::Path;

    fn findings(scale: f64, size: &str, mass: f64, mesh: Option<&str>) -> Vec<Diagnostic> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots");
        let shape = mesh.map_or(format!("<box size='{size}'/>"), |scale| {
            format!("<mesh filename='meshes/far_off.obj' scale='{scale}'/>")
        });
        // A cube of 0.1 m and 1 kg: m a²/6.
        let text = format!(
            "<robot name='r'><link name='a'><inertial><mass value='{mass}'/><inertia ixx='0.00167' \
             iyy='0.00167' izz='0.00167' ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry>\
             {shape}</geometry></collision></link></robot>"
        );
        let options = ReadOptions {
            scale,
            ..ReadOptions::default()
        };
        let robot = read_str(&text, "r.urdf", &folder, &options).expect("legal");
        let told = robot.diagnostics.into_iter();
        told.filter(|d| d.code == "U067" || d.code == "U065")
            .collect()
    }

    #[test]
    fn a_robot_in_millimetres_is_told_by_how_light_it_is() {
        assert!(findings(1.0, "0.1 0.1 0.1", 1.0, None).is_empty());
        let told = findings(1.0, "100 100 100", 1.0, None);
        let [told] = &told[..] else {
            panic!("one finding: {told:?}")
        };
        assert!(told.message.contains("it is 173.2 m large"), "{told:?}");
        let help = told.help.as_deref().unwrap_or_default();
        assert!(help.contains("pass --scale 0.001"), "{help}");
        // That option mends it.
        assert!(
            findings(0.001, "100 100 100", 1.0, None)
                .iter()
                .all(|d| d.code != "U067")
        );
        // A balloon of 1 m that is as heavy as its air and skin is none.
        assert!(
            findings(1.0, "1 1 1", 1.3, None)
                .iter()
                .all(|d| d.code != "U067")
        );
    }

    /// A box of 0.3 m with a link of 0.4 m on it, whose larger one is 2 √(0.03² + 0.2²) m: told
    /// from ten times as many, 4.04 m, on.
    #[test]
    fn origins_in_millimetres_are_told_by_the_size_of_all_shapes() {
        let told = |mass: f64, shape: f64, joint: f64, scale: f64| {
            let text = format!(
                "<robot name='r'><link name='a'><collision><geometry><box size='0.3 0.2 0.1'/>\
                 </geometry></collision></link><link name='b'><inertial><origin xyz='0 0 {mass}'/>\
                 <mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.001' ixy='0' ixz='0' iyz='0'/>\
                 </inertial><collision><origin xyz='0 0 {shape}'/><geometry><cylinder radius='0.03' \
                 length='0.4'/></geometry></collision></link><joint name='j' type='continuous'>\
                 <origin xyz='0 0 {joint}'/><parent link='a'/><child link='b'/></joint></robot>"
            );
            let options = ReadOptions {
                scale,
                ..ReadOptions::default()
            };
            let robot = read_str(&text, "r.urdf", Path::new("."), &options).expect("legal");
            let mut told = robot.diagnostics.into_iter().filter(|d| d.code == "U069");
            told.next().map(|d| (d.message, d.help.unwrap_or_default()))
        };
        assert_eq!(told(0.2, 0.2, 0.05, 1.0), None);
        assert_eq!(told(4.0, 0.2, 4.0, 1.0), None);
        for (places, what, more) in [
            (
                [200.0, 0.2, 0.05],
                "link 'b': the <origin> of <inertial> is 200 m",
                0,
            ),
            (
                [4.1, 0.2, 0.05],
                "link 'b': the <origin> of <inertial> is 4 m",
                0,
            ),
            (
                [0.2, 0.2, 50.0],
                "joint 'j': the <origin> of <joint> is 50 m",
                0,
            ),
            (
                [200.0, 200.0, 50.0],
                "link 'b': the <origin> of <inertial> is 200 m",
                2,
            ),
        ] {
            let [mass, shape, joint] = places;
            let (message, help) = told(mass, shape, joint, 1.0).expect(what);
            assert!(message.starts_with(what), "{message}");
            let size = if more > 0 { "0.8 m" } else { "0.4 m" };
            assert!(message.contains(&format!("some {size} large")), "{message}");
            assert_eq!(
                help.contains(&format!("{more} other origins")),
                more > 0,
                "{help}"
            );
            // All lengths are scaled alike.
            assert!(told(mass, shape, joint, 0.001).is_some());
        }
    }

    /// One of many links is 135 m away: more than ten times the largest link, but not than thirty
    /// of them in a row. Four feet of 4 cm alone say nothing of legs of 0.5 m.
    #[test]
    fn one_origin_in_millimetres_among_many_links_is_told() {
        let chain = |shape: &str, shaped: usize, first: f64| {
            let links = (0..30).map(|i| {
                let shape = format!("<collision><geometry>{shape}</geometry></collision>");
                let shape = if i < shaped { shape } else { String::new() };
                format!("<link name='l{i}'>{shape}</link>")
            });
            let joints = (1..30).map(|i| {
                let away = if i == 1 { first } else { 0.5 };
                format!(
                    "<joint name='j{i}' type='fixed'><origin xyz='0 0 {away}'/>\
                     <parent link='l{}'/><child link='l{i}'/></joint>",
                    i - 1
                )
            });
            let parts: String = links.chain(joints).collect();
            let text = format!("<robot name='r'>{parts}</robot>");
            let options = ReadOptions::default();
            let robot = read_str(&text, "r.urdf", Path::new("."), &options).expect("legal");
            robot.diagnostics.iter().any(|d| d.code == "U069")
        };
        let link = "<box size='0.5 0.3 0.3'/>";
        assert!(chain(link, 30, 135.0));
        assert!(!chain(link, 30, 0.5));
        assert!(!chain("<sphere radius='0.02'/>", 4, 0.5));
    }

    /// A cube of 0.1 m, drawn 1000 times as large, 2·√3·50 m, and the mesh of it, at a rail of 30 m
    /// along which it slides.
    #[test]
    fn visuals_in_millimetres_are_told_by_the_size_of_the_rest() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots");
        let told = |visual: &str, slides: f64| {
            let text = format!(
                "<robot name='r'><link name='a'><collision><geometry><box size='0.1 0.1 0.1'/>\
                 </geometry></collision></link><link name='b'><visual><geometry>{visual}\
                 </geometry></visual></link><joint name='j' type='prismatic'><parent link='a'/>\
                 <child link='b'/><limit lower='0' upper='{slides}' effort='1' velocity='1'/>\
                 </joint></robot>"
            );
            let options = ReadOptions {
                drawn: true,
                ..ReadOptions::default()
            };
            let robot = read_str(&text, "r.urdf", &folder, &options).expect("legal");
            let mut told = robot.diagnostics.into_iter().filter(|d| d.code == "U075");
            told.next().map(|d| d.message + &d.help.unwrap_or_default())
        };
        assert_eq!(told("<box size='0.1 0.1 0.1'/>", 0.1), None);
        let text = told("<box size='100 100 100'/>", 0.1).expect("in mm");
        let start = "link 'b': its <visual> is 173.2 m large, in a robot some 0.2 m large";
        assert!(text.starts_with(start), "{text}");
        assert_eq!(told("<box size='30 0.1 0.1'/>", 30.0), None);
        let mesh = |scale: &str| {
            let mesh = format!("<mesh filename='meshes/far_off.obj' scale='{scale}'/>");
            told(&mesh, 0.1)
        };
        assert_eq!(mesh("1 1 1"), None);
        let text = mesh("1000 1000 1000").expect("in mm");
        assert!(text.contains("scale=\"0.001 0.001 0.001\""), "{text}");
    }

    /// Rolling and spinning friction are lever arms, m.
    #[test]
    fn arms_of_friction_follow_the_scale() {
        let text = "<robot name='r'><link name='a'><contact><rolling_friction value='0.01'/>\
                    <spinning_friction value='0.02'/></contact></link></robot>";
        let options = ReadOptions {
            scale: 4.0,
            ..ReadOptions::default()
        };
        let robot = read_str(text, "r.urdf", std::path::Path::new("."), &options).expect("legal");
        let arms = [
            &robot.links[0].rolling_friction,
            &robot.links[0].torsional_friction,
        ];
        assert_eq!(arms, [&Some(0.04), &Some(0.08)]);
    }

    /// A room of 300 m³ with a mass of 1 kg, and a link with a placeholder of 1e-5 kg.
    #[test]
    fn masses_that_nobody_has_measured_are_no_millimetres() {
        for (size, mass) in [("10 10 3", 1.0), ("0.1 0.1 0.1", 1e-5)] {
            let told = findings(1.0, size, mass, None);
            assert!(told.iter().all(|d| d.code != "U067"), "{told:?}");
        }
    }

    #[test]
    fn a_mesh_in_millimetres_is_told_with_its_scale_and_not_with_an_inertia_of_its_size() {
        let told = findings(1.0, "", 1.0, Some("1000 1000 1000"));
        let [told] = &told[..] else {
            panic!("one finding: {told:?}")
        };
        assert_eq!(told.code, "U067");
        let help = told.help.as_deref().unwrap_or_default();
        assert!(help.contains("scale=\"0.001 0.001 0.001\""), "{help}");
    }
}
