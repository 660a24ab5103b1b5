//! Rotational inertias that do not fit the size of their link.
//!
//! All mass of a body lies within some distance `r` of its centre of mass, so no moment exceeds
//! `m r²`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::checked::{CheckedRobot, Order};
use super::description::{Description, LinkDescription};
use super::inertia::principal_moments;
use super::options::ImpossibleInertia;
use super::scope::Scope;
use super::sizes;
use crate::spatial::{Pose, Vec3};
use std::ops::Range;

/// How many times further out than a link's shapes and joints reach its mass may lie before it is
/// told: collision shapes are simplified.
const TOO_FAR: f64 = 3.0;

/// Part of the size of a link's largest shape below which its radius of gyration is told: even a
/// motor in a light cover has a tenth.
const TOO_NEAR: f64 = 1.0 / 30.0;

/// Warns of inertias that the link's size contradicts: placeholders such as 1 kg m² on a gripper,
/// or numbers in another unit. The size of a link is that of its collision shapes, or of what it
/// draws; one without shapes is at most as large as the robot.
pub(super) fn compare_with_sizes(
    scope: &mut Scope,
    robot: &CheckedRobot,
    order: &Order,
    description: &Description,
) {
    if scope.impossible_inertia == ImpossibleInertia::Unused {
        return;
    }
    let places = places(description);
    let extents = extents(description, &places);
    let mut found: Vec<(Range<usize>, String)> = Vec::new();
    let mut shaped = true;
    for (i, link) in description.links.iter().enumerate() {
        let Some(inertial) = link.inertial.filter(|i| i.mass > 0.0) else {
            continue;
        };
        let Some(checked) = &robot.links[order.links[i]].inertial else {
            continue;
        };
        let [_, _, largest] = principal_moments(&inertial.I_cm);
        let gyration = (largest / inertial.mass).max(0.0).sqrt();
        let balls = sizes::balls(link, description);
        let size = balls.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
        let own = |(center, radius): &(Vec3, f64)| (center - inertial.com).norm() + radius;
        let joints = description.joints.iter();
        let joints = joints.filter(|joint| joint.parent == i);
        let joints = joints.map(|joint| (joint.X_PJ.p - inertial.com).norm());
        let reach = if size > 0.0 {
            let shapes = balls.iter().map(own);
            shapes.chain(joints).fold(inertial.com.norm(), f64::max)
        } else {
            let center = places[i].point(&inertial.com);
            let away = extents
                .iter()
                .map(|(place, radius)| (place - center).norm() + radius);
            away.fold(0.0, f64::max)
        };
        // A point mass has its own finding.
        if reach <= 0.0 || largest <= 0.0 {
            continue;
        }
        let what = if gyration > TOO_FAR * reach {
            format!("would need its mass {gyration:.3} m from its centre, but reaches {reach:.3} m")
        } else if gyration < TOO_NEAR * size {
            format!("would need all its mass within {gyration:.3e} m, but is {size:.3} m large")
        } else {
            continue;
        };
        shaped &= !link.collisions.is_empty();
        let message = format!(
            "the inertia does not fit the link: with {largest:.4} kg m² and {} kg it {what}",
            inertial.mass
        );
        found.push((
            checked.at.clone(),
            format!("link '{}': {message}", link.name),
        ));
    }
    let Some((at, message)) = found.first() else {
        return;
    };
    let others: Vec<String> = found[1..]
        .iter()
        .map(|(at, _)| scope.report.line(at.start).to_string())
        .collect();
    let mut help = if shaped {
        "--inertia collision computes all inertias from the collision shapes"
    } else {
        "inertias are in kg m²: 1 kg mm² is 1e-6 of it, 1 g mm² 1e-9"
    }
    .to_owned();
    if !others.is_empty() {
        const MOST: usize = 20;
        let more = others.len().saturating_sub(MOST);
        let shown = others[..others.len() - more].join(", ");
        let tail = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        let s = if others.len() == 1 { "" } else { "s" };
        help = format!("the same in line{s} {shown}{tail}\n{help}");
    }
    scope
        .report
        .warning("U065", at.clone(), message.clone(), help);
}

/// Per link its pose in the robot, with all joints at zero.
fn places(description: &Description) -> Vec<Pose> {
    let mut places = vec![Pose::IDENTITY; description.links.len()];
    // Parents come before their children.
    for joint in &description.joints {
        places[joint.child] = places[joint.parent].compose(&joint.X_PJ);
    }
    places
}

/// Centres and radii of balls around all that has a place in the robot, m: frames, centres of mass
/// and shapes.
fn extents(description: &Description, places: &[Pose]) -> Vec<(Vec3, f64)> {
    let links = description.links.iter().zip(places);
    let of_link = |(link, X): (&LinkDescription, &Pose)| {
        let com = link.inertial.map(|inertial| (X.point(&inertial.com), 0.0));
        let balls = sizes::balls(link, description).into_iter();
        let balls = balls.map(|(center, radius)| (X.point(&center), radius));
        let all: Vec<(Vec3, f64)> = balls.chain(com).chain([(X.p, 0.0)]).collect();
        all
    };
    links.flat_map(of_link).collect()
}

#[cfg(test)]
mod tests {
    use crate::urdf::{ReadOptions, read_str};
    use std::path::Path;

    /// A cube of 0.1 m whose corners are about (0, 0, 1.25), moved back to its link by `<origin>`,
    /// as programs for design write meshes in the coordinates of the whole robot. Its own
    /// inertia, m a²/6, fits; the thousandth of it and a thousand times it do not.
    #[test]
    fn meshes_far_from_their_origin_are_as_large_as_they_are() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots");
        for (moment, fits) in [
            (1.0 / 600.0, true),
            (1e-3 / 600.0, false),
            (1e3 / 600.0, false),
        ] {
            let text = format!(
                "<robot name='r'><link name='a'><inertial><mass value='1'/><inertia ixx='{moment}' \
                 iyy='{moment}' izz='{moment}' ixy='0' ixz='0' iyz='0'/></inertial><collision>\
                 <origin xyz='0 0 -1.25'/><geometry><mesh filename='meshes/far_off.obj'/>\
                 </geometry></collision></link></robot>"
            );
            let robot = read_str(&text, "r.urdf", &folder, &ReadOptions::default()).expect("legal");
            let told = robot.diagnostics.iter().any(|d| d.code == "U065");
            assert_eq!(told, !fits, "{moment}: {:?}", robot.diagnostics);
        }
    }

    /// A chain of two frames 0.5 m apart without a shape, whose largest extent is 0.7 m with the
    /// centre of mass at its end: a rod of 0.4 m and 1 kg has m l²/12 = 0.01333 kg m², written in
    /// kg mm² a million times that. Where a box of 0.4 m is drawn, a thousandth of that is enough:
    /// 3.65 m, and it reaches no farther than 0.5 m.
    #[test]
    fn inertias_of_links_without_collision_shapes_are_told_by_the_size_of_the_robot() {
        let told = |factor: f64, visual: &str| {
            let moment = factor * 0.16 / 12.0;
            let text = format!(
                "<robot name='r'><link name='a'/><link name='b'><inertial><origin xyz='0 0 0.2'/>\
                 <mass value='1'/><inertia ixx='{moment}' iyy='{moment}' izz='{moment}' ixy='0' \
                 ixz='0' iyz='0'/></inertial>{visual}</link><joint name='j' type='continuous'>\
                 <origin xyz='0 0 0.5'/><parent link='a'/><child link='b'/></joint></robot>"
            );
            let options = ReadOptions::default();
            let robot = read_str(&text, "r.urdf", Path::new("."), &options).expect("legal");
            let found = robot.diagnostics.into_iter().find(|d| d.code == "U065");
            found.map(|d| d.message + &d.help.unwrap_or_default())
        };
        assert_eq!(told(1.0, ""), None);
        let text = told(1e6, "").expect("kg mm²");
        assert!(text.contains("but reaches 0.700 m"), "{text}");
        assert!(text.contains("1 kg mm² is 1e-6"), "{text}");
        let visual = "<visual><origin xyz='0 0 0.2'/><geometry><box size='0.1 0.1 0.4'/>\
                      </geometry></visual>";
        assert_eq!(told(1.0, visual), None);
        assert!(told(1e3, visual).is_some());
    }
}
