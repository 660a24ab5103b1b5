//! urdf-rs reads the same robots: names, tree, places, axes, limits, masses and shapes agree to the
//! last bit.
//!
//! urdf-rs is an independent reader of URDF. It reads the files as they stand; what it refuses
//! although this project reads it is listed in [`REFUSED`] with the reason. Compared are this
//! project's robots and those of `pybullet_data` and example-robot-data; of the thousand objects in
//! `random_urdfs`, which differ in a mesh only, every hundredth.
#![allow(clippy::float_cmp, reason = "both read the same decimal text")]

#[path = "environment.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod environment;

use std::path::{Path, PathBuf};
use std::process::Command;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::JointKind;
use urdf2fmu_core::pattern::Pattern;
use urdf2fmu_core::spatial::{Pose, Vec3, rotation_from_rpy};
use urdf2fmu_core::urdf::{self, Description, MeshShapes, ReadOptions};

/// Files that urdf-rs refuses, and why they are read all the same.
const REFUSED: [(&str, &str); 6] = [
    (
        "husky.urdf",
        "the default of $(optenv …) is taken, with a warning",
    ),
    (
        "icub.urdf",
        "a visual without a file name does not move the robot",
    ),
    (
        "icub_reduced.urdf",
        "a visual without a file name does not move the robot",
    ),
    ("racecar.urdf", "a material inside <geometry> is left out"),
    (
        "spherical_joint_limit.urdf",
        "a limit without velocity counts as unlimited",
    ),
    (
        "spirit40newer.urdf",
        "an element that is written twice and equal is a warning",
    ),
];

fn below(folder: &Path, list: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).expect("a folder");
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            below(&path, list);
        } else if path.extension().is_some_and(|ending| ending == "urdf") {
            list.push(path);
        }
    }
}

/// Every robot that is compared, in the order of their names; none where there is no Python.
fn files() -> Option<Vec<PathBuf>> {
    let environment = environment::make()?;
    let script = "import robots; print(robots.example_robots())";
    let output = Command::new(&environment.interpreter)
        .args(["-c", script])
        .env("PYTHONPATH", environment::tests())
        .output()
        .expect("Python runs");
    assert!(output.status.success(), "example-robot-data is installed");
    let examples = String::from_utf8(output.stdout).expect("a path");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut list = Vec::new();
    for folder in [
        &root.join("examples"),
        &root.join("tests/robots"),
        &environment.pybullet_data,
        Path::new(examples.trim()),
    ] {
        below(folder, &mut list);
    }
    list.sort();
    let random = |path: &&PathBuf| {
        path.components()
            .any(|part| part.as_os_str() == "random_urdfs")
    };
    let sample: Vec<PathBuf> = list.iter().filter(random).step_by(100).cloned().collect();
    list.retain(|path| !random(&path) || sample.contains(path));
    Some(list)
}

fn pose(origin: &urdf_rs::Pose) -> Pose {
    Pose::from_xyz_rpy(Vec3::from(*origin.xyz), Vec3::from(*origin.rpy))
}

fn compare(ours: &Description, theirs: &urdf_rs::Robot, file: &str) {
    assert_eq!(ours.links.len(), theirs.links.len(), "{file}");
    assert_eq!(ours.joints.len(), theirs.joints.len(), "{file}");
    for link in &ours.links {
        let what = format!("{file}: link '{}'", link.name);
        let other = theirs.links.iter().find(|other| other.name == link.name);
        compare_links(link, other.expect(&what), &what);
    }
    for joint in &ours.joints {
        let what = format!("{file}: joint '{}'", joint.name);
        let other = theirs.joints.iter().find(|other| other.name == joint.name);
        compare_joints(ours, joint, other.expect(&what), &what);
    }
}

fn compare_links(ours: &urdf::LinkDescription, theirs: &urdf_rs::Link, what: &str) {
    if let Some(own) = &ours.inertial {
        let other = &theirs.inertial;
        assert_eq!(own.mass, other.mass.value, "{what}");
        assert_eq!(own.com, Vec3::from(*other.origin.xyz), "{what}");
        assert_eq!(
            ours.R_LI,
            rotation_from_rpy(&Vec3::from(*other.origin.rpy)),
            "{what}"
        );
        // The trace does not turn with the axes; zero where round-off such as 1e-20 is left out.
        let trace = other.inertia.ixx + other.inertia.iyy + other.inertia.izz;
        let allowed = 1e-12 * (trace.abs() + own.mass);
        assert!(
            (own.I_cm.trace() - trace).abs() <= allowed,
            "{what}: {trace}"
        );
    }
    assert_eq!(ours.collisions.len(), theirs.collision.len(), "{what}");
    for (own, other) in ours.collisions.iter().zip(&theirs.collision) {
        assert_eq!(own.X_LG, pose(&other.origin), "{what}");
        let same = match (&own.shape, &other.geometry) {
            (Shape::Box { half }, urdf_rs::Geometry::Box { size }) => {
                *half == Vec3::from(**size) * 0.5
            }
            (
                Shape::Cylinder {
                    radius,
                    half_length,
                },
                urdf_rs::Geometry::Cylinder {
                    radius: r,
                    length: l,
                },
            )
            | (
                Shape::Capsule {
                    radius,
                    half_length,
                },
                urdf_rs::Geometry::Capsule {
                    radius: r,
                    length: l,
                },
            ) => radius == r && *half_length == 0.5 * l,
            (Shape::Sphere { radius }, urdf_rs::Geometry::Sphere { radius: r }) => radius == r,
            (Shape::Hull { .. }, urdf_rs::Geometry::Mesh { filename, .. }) => {
                let file = own.mesh.as_ref().and_then(|path| path.file_name());
                let name = filename.rsplit(['/', '\\']).next();
                file.map(|file| file.to_string_lossy()).as_deref() == name
            }
            _ => false,
        };
        assert!(same, "{what}: {:?}, {:?}", own.shape, other.geometry);
    }
}

fn compare_joints(
    robot: &Description,
    ours: &urdf::JointDescription,
    theirs: &urdf_rs::Joint,
    what: &str,
) {
    assert_eq!(robot.links[ours.parent].name, theirs.parent.link, "{what}");
    assert_eq!(robot.links[ours.child].name, theirs.child.link, "{what}");
    let kind = match theirs.joint_type {
        urdf_rs::JointType::Fixed => JointKind::Fixed,
        urdf_rs::JointType::Revolute => JointKind::Revolute,
        urdf_rs::JointType::Continuous => JointKind::Continuous,
        urdf_rs::JointType::Prismatic => JointKind::Prismatic,
        urdf_rs::JointType::Planar => JointKind::Planar,
        urdf_rs::JointType::Floating => JointKind::Floating,
        urdf_rs::JointType::Spherical => JointKind::Spherical,
    };
    assert_eq!(ours.kind, kind, "{what}");
    assert_eq!(ours.X_PJ, pose(&theirs.origin), "{what}");
    if let Some(axis) = Vec3::from(*theirs.axis.xyz).try_normalize(1e-6) {
        assert_eq!(ours.axis, axis, "{what}");
    }
    if let Some(limits) = ours.limits {
        assert_eq!(limits.lower, theirs.limit.lower, "{what}");
        assert_eq!(limits.upper, theirs.limit.upper, "{what}");
    }
    for (own, other) in [
        (ours.effort, theirs.limit.effort),
        (ours.velocity, theirs.limit.velocity),
    ] {
        assert!(
            own.is_none_or(|own| own == other),
            "{what}: {own:?}, {other}"
        );
    }
    let dynamics = theirs.dynamics.clone().unwrap_or_default();
    assert_eq!(ours.damping, dynamics.damping, "{what}");
    assert_eq!(ours.friction, dynamics.friction, "{what}");
    // A joint that neither turns nor slides cannot follow another one.
    let follows = matches!(
        kind,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic
    );
    if let Some(other) = theirs.mimic.as_ref().filter(|_| follows) {
        let (joint, multiplier, offset) = ours.mimic.as_ref().expect(what);
        assert_eq!(*joint, other.joint, "{what}");
        assert_eq!(*multiplier, other.multiplier.unwrap_or(1.0), "{what}");
        assert_eq!(*offset, other.offset.unwrap_or(0.0), "{what}");
    }
}

#[test]
fn urdf_rs_reads_the_same_robots() {
    let Some(files) = files() else { return };
    let mut compared = 0;
    let mut refused = Vec::new();
    // One shape for each <collision>, as there.
    let options = ReadOptions {
        meshes: vec![(Pattern::from("*"), MeshShapes::Hull)],
        ..ReadOptions::default()
    };
    for path in files {
        let Ok(ours) = urdf::read(&path, &options) else {
            continue;
        };
        let file = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        match urdf_rs::read_from_string(&ours.text) {
            Ok(theirs) => {
                compare(&ours, &theirs, &file);
                compared += 1;
            }
            Err(error) => refused.push((file, error.to_string())),
        }
    }
    refused.sort();
    let expected: Vec<&str> = REFUSED.iter().map(|(file, _)| *file).collect();
    let found: Vec<&str> = refused.iter().map(|(file, _)| file.as_str()).collect();
    assert_eq!(found, expected, "{refused:#?}");
    assert!(compared > 150, "only {compared} robots were compared");
}
