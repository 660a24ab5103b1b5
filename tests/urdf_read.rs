//! The description contains what the URDF says: `tests/robots/every_tag.urdf`, meshes, encodings,
//! scale.
//!
//! Expected values were computed by hand from the file.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

#[path = "robots/gltf.rs"]
mod gltf;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use urdf2fmu_core::assemble;
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{ActuatorMode, JointKind, Limits};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_core::spatial::{Mat3, Vec3};
use urdf2fmu_core::urdf::{Description, ImpossibleInertia, ReadOptions, read, read_str};
use urdf2fmu_core::variables::{Slot, find, table};

fn robots() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots")
}

fn every_tag(scale: f64) -> Description {
    let options = ReadOptions {
        scale,
        ..ReadOptions::default()
    };
    read(&robots().join("every_tag.urdf"), &options).expect("a robot")
}

fn from_text(text: &str) -> Description {
    read_str(text, "r.urdf", &robots(), &ReadOptions::default()).expect("a robot")
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn links_come_parents_first_and_joints_like_their_children() {
    let robot = every_tag(1.0);
    assert_eq!(robot.name, "every_tag");
    let names: Vec<&str> = robot.links.iter().map(|l| l.name.as_str()).collect();
    let expected = [
        "base", "turret", "slide", "finger", "wheel", "cart", "ball", "sensor",
    ];
    assert_eq!(names, expected);
    let joints: Vec<&str> = robot.joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!(
        joints,
        ["yaw", "lift", "grip", "roll", "drift", "free", "mount"]
    );
    let parents: Vec<usize> = robot.joints.iter().map(|j| j.parent).collect();
    assert_eq!(parents, [0, 1, 2, 0, 4, 5, 6]);
    assert_eq!((robot.links[0].tag.line, robot.joints[0].tag.line), (5, 35));
    assert_eq!(robot.sources, [robots().join("every_tag.urdf")]);
}

#[test]
fn inertia_is_turned_into_the_axes_of_the_link() {
    let inertia = every_tag(1.0).links[0].inertial.expect("an inertia");
    assert!(close(inertia.mass, 10.0));
    assert!((inertia.com - Vec3::new(0.1, 0.2, 0.3)).norm() < 1e-15);
    // A quarter turn about z takes the inertial frame's x to the link's y and its y to -x:
    // Ixx = iyy, Iyy = ixx, Ixy = -ixy, Ixz = -iyz, Iyz = ixz.
    let expected = Mat3::new(0.2, -0.01, -0.03, -0.01, 0.1, 0.02, -0.03, 0.02, 0.25);
    assert!((inertia.I_cm - expected).norm() < 1e-15, "{}", inertia.I_cm);
    assert!(every_tag(1.0).links[1].inertial.is_none());
}

#[test]
fn shapes_and_surface_are_read() {
    let robot = every_tag(1.0);
    let base = &robot.links[0];
    let shapes: Vec<Shape> = base.collisions.iter().map(|c| c.shape.clone()).collect();
    let (radius, half_length) = (0.1, 0.25);
    assert_eq!(
        shapes,
        [
            Shape::Box {
                half: Vec3::new(0.1, 0.2, 0.3)
            },
            Shape::Sphere { radius: 0.25 },
            Shape::Cylinder {
                radius,
                half_length
            },
            Shape::Capsule {
                radius,
                half_length
            },
        ]
    );
    // pitch of a quarter turn: the shape's x points down, its z along the link's x
    let X = &base.collisions[0].X_LG;
    assert!((X.point(&Vec3::x()) - Vec3::new(0.0, 0.0, -0.5)).norm() < 1e-15);
    assert!((X.point(&Vec3::z()) - Vec3::new(1.0, 0.0, 0.5)).norm() < 1e-15);
    assert_eq!((base.friction, base.restitution), (Some(0.7), Some(0.3)));
    assert_eq!(robot.links[4].friction, Some(1.25));
    assert_eq!(robot.links[4].rolling_friction, None);
    assert_eq!(robot.links[1].friction, None);
}

#[test]
fn joints_are_read() {
    let robot = every_tag(1.0);
    let [yaw, lift, grip, roll, drift, free, mount] = &robot.joints[..] else {
        panic!("seven joints");
    };
    assert_eq!(yaw.kind, JointKind::Revolute);
    assert_eq!(yaw.axis, Vec3::z());
    assert_eq!(
        yaw.limits,
        Some(Limits {
            lower: -1.5,
            upper: 2.5
        })
    );
    assert_eq!((yaw.effort, yaw.velocity), (Some(30.0), Some(4.0)));
    assert_eq!((yaw.damping, yaw.friction), (0.5, 0.25));
    assert_eq!(yaw.X_PJ.p, Vec3::z());
    assert_eq!(lift.kind, JointKind::Prismatic);
    assert!((lift.axis - Vec3::new(0.0, 0.6, 0.8)).norm() < 1e-15);
    // without <axis>
    assert_eq!(grip.axis, Vec3::x());
    assert_eq!(grip.mimic, Some(("yaw".to_owned(), -0.02, 0.01)));
    // the limits of a continuous joint bound effort and velocity only
    assert_eq!(
        (roll.kind, roll.limits, roll.effort),
        (JointKind::Continuous, None, Some(5.0))
    );
    assert_eq!(
        (drift.kind, drift.limits, drift.effort),
        (JointKind::Planar, None, None)
    );
    assert_eq!(free.kind, JointKind::Floating);
    assert_eq!(mount.kind, JointKind::Fixed);
    assert_eq!(mount.X_PJ.p, Vec3::new(1.0, 2.0, 3.0));
}

#[test]
fn scale_changes_lengths_and_nothing_else() {
    let (one, two) = (every_tag(1.0), every_tag(2.0));
    let (a, b) = (
        one.links[0].inertial.expect("one"),
        two.links[0].inertial.expect("one"),
    );
    assert!(close(b.mass, a.mass));
    assert!((b.com - a.com * 2.0).norm() < 1e-15 && (b.I_cm - a.I_cm * 4.0).norm() < 1e-15);
    assert_eq!(
        two.links[0].collisions[1].shape,
        Shape::Sphere { radius: 0.5 }
    );
    assert_eq!(two.links[0].collisions[0].X_LG.p, Vec3::z());
    assert_eq!(two.joints[0].X_PJ.p, Vec3::z() * 2.0);
    // angles stay, travels and their rates scale
    assert_eq!(two.joints[0].limits, one.joints[0].limits);
    assert_eq!(
        two.joints[1].limits,
        Some(Limits {
            lower: 0.2,
            upper: 0.8
        })
    );
    assert_eq!(
        (two.joints[1].effort, two.joints[1].velocity),
        (Some(100.0), Some(1.0))
    );
    // m of the finger per rad of the turret
    assert_eq!(two.joints[2].mimic, Some(("yaw".to_owned(), -0.04, 0.02)));
}

#[test]
fn unused_tags_are_reported_once_for_each_kind() {
    let robot = every_tag(1.0);
    let notes: Vec<&str> = robot
        .diagnostics
        .iter()
        .map(|d| d.message.as_str())
        .collect();
    let expected = [
        "<safety_controller> is not used",
        "<calibration> is not used",
        "<kp> is not used",
        "<transmission> is not used",
        "<lateral_friction> is read",
        "<restitution> is read",
        "<mu1> is read",
    ];
    assert_eq!(notes.len(), expected.len(), "{notes:?}");
    for tag in expected {
        assert!(notes.contains(&tag), "{tag} {notes:?}");
    }
    assert!(
        robot
            .diagnostics
            .iter()
            .all(|d| d.severity == Severity::Note)
    );
}

/// `tests/robots/foreign_tags.urdf`: what `PyBullet`, Gazebo, ROS, Drake and `MuJoCo` add to a
/// URDF.
#[test]
fn what_is_unused_in_many_joints_is_told_once_and_in_few_at_each() {
    let told = |joints: usize| -> Vec<(String, Option<usize>)> {
        let joint = |i: usize| {
            format!(
                "<link name='l{i}'/>\n<joint name='j{i}' type='fixed'><parent link='a'/>\
                 <child link='l{i}'/><dynamics D='1'/></joint>\n"
            )
        };
        let joints: String = (0..joints).map(joint).collect();
        let robot = from_text(&format!(
            "<robot name='r'><link name='a'/>\n{joints}</robot>"
        ));
        let unknown = robot.diagnostics.into_iter().filter(|d| d.code == "U019");
        unknown
            .map(|d| (d.message, d.place.map(|p| p.line)))
            .collect()
    };
    let few = told(3);
    assert_eq!(few.len(), 3, "{few:?}");
    assert!(few[2].0.starts_with("joint 'j2'") && !few[2].0.contains("times"));
    let many = told(7);
    assert_eq!(many.len(), 1, "{many:?}");
    let message =
        "joint 'j0': <dynamics> attribute 'D' is unknown and ignored (7 times, first here)";
    assert_eq!(many[0], (message.to_owned(), Some(3)));
}

#[test]
fn tags_of_other_programs_are_read_reported_or_cause_a_warning() {
    let robot =
        read(&robots().join("foreign_tags.urdf"), &ReadOptions::default()).expect("a robot");
    let link = |name: &str| robot.links.iter().find(|l| l.name == name).expect("a link");
    let joint = |name: &str| {
        robot
            .joints
            .iter()
            .find(|j| j.name == name)
            .expect("a joint")
    };
    let (base, wheel) = (link("base"), link("wheel"));
    assert_eq!(
        (base.friction, base.static_friction),
        (Some(0.6), Some(0.9))
    );
    assert_eq!((wheel.friction, wheel.restitution), (Some(0.7), Some(0.3)));
    assert_eq!(
        (wheel.rolling_friction, wheel.torsional_friction),
        (Some(0.001), Some(0.02))
    );
    assert_eq!((wheel.inertia_scaling, wheel.stiffness), (None, None));
    let options = ReadOptions {
        pybullet: true,
        ..ReadOptions::default()
    };
    let theirs = read(&robots().join("foreign_tags.urdf"), &options).expect("a robot");
    let wheel = theirs.links.iter().find(|l| l.name == "wheel");
    let wheel = wheel.expect("a link");
    assert_eq!(
        (wheel.inertia_scaling, wheel.stiffness),
        (Some(3.0), Some(30_000.0))
    );
    assert_eq!(
        (link("foot").friction, link("tail").friction),
        (Some(1.5), Some(0.4))
    );
    // 100² · 2e-5 kg m² at the joint.
    assert!(close(joint("hip").armature, 0.2));
    assert!(close(joint("drive").armature, 0.25));
    assert_eq!(joint("thumb").mimic, Some(("finger".to_owned(), -1.0, 0.5)));
    assert_eq!(joint("hip").interfaces, [ActuatorMode::Effort]);
    assert_eq!(
        joint("wag").interfaces,
        [ActuatorMode::Velocity, ActuatorMode::Effort]
    );

    let has = |severity, code, line, part: &str| {
        let found = robot.diagnostics.iter().any(|d| {
            (d.severity, d.code) == (severity, code)
                && d.place.as_ref().is_some_and(|p| p.line == line)
                && d.message.contains(part)
        });
        assert!(found, "{code} {line} {part}\n{:#?}", robot.diagnostics);
    };
    has(Severity::Warning, "U022", 5, "balanceinertia");
    has(
        Severity::Warning,
        "U022",
        54,
        "1.5 in one direction and 1.2 in the other",
    );
    has(Severity::Warning, "U022", 57, "<turnGravityOff>");
    has(Severity::Warning, "U022", 62, "<springStiffness>");
    has(Severity::Warning, "U022", 81, "<drake:ball_constraint>");
    has(Severity::Warning, "U021", 79, "'wig'");
    has(Severity::Note, "U020", 25, "<stiffness> is not used");
    has(Severity::Note, "U020", 26, "<inertia_scaling> is not used");
    has(
        Severity::Note,
        "U020",
        15,
        "<drake:hunt_crossley_dissipation> is not used",
    );
    has(Severity::Note, "U023", 69, "<drake:rotor_inertia> is read");
    has(Severity::Note, "U023", 65, "<hardwareInterface> is read");
}

#[test]
fn byte_order_marks_and_line_ends_of_windows_are_accepted() {
    let robot = from_text(
        "\u{feff}<?xml version=\"1.0\"?>\r\n<robot name=\"ä\">\r\n<link name='b &amp; \"c\"'/>\r\n</robot>\r\n",
    );
    assert_eq!(robot.name, "ä");
    assert_eq!(
        (robot.links[0].name.as_str(), robot.links[0].tag.line),
        ("b & \"c\"", 3)
    );
    assert!(robot.diagnostics.is_empty(), "{:?}", robot.diagnostics);
}

#[test]
fn quaternions_are_used_from_urdf_1_1_on_and_reported_before() {
    let text = |version: &str| {
        format!(
            "<robot name='r' version='{version}'><link name='a'/><link name='b'/><joint name='j' type='fixed'>
             <parent link='a'/><child link='b'/><origin quat_xyzw='0 0 2 2'/></joint></robot>"
        )
    };
    // a quarter turn about z, not of unit length
    let quarter = Mat3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let new = from_text(&text("1.1"));
    assert!((new.joints[0].X_PJ.R - quarter).norm() < 1e-15);
    let old = from_text(&text("1.0"));
    assert_eq!(old.joints[0].X_PJ.R, Mat3::identity());
    assert!(
        old.diagnostics
            .iter()
            .any(|d| d.message.contains("quat_xyzw is ignored"))
    );
}

#[test]
fn joints_without_lower_and_upper_have_no_limits_and_half_a_range_counts_from_zero() {
    let joint = |version: &str, limit: &str| {
        let text = format!(
            "<robot name='r' version='{version}'><link name='a'/><link name='b'/><joint name='j' type='revolute'>
             <parent link='a'/><child link='b'/><limit {limit} effort='1' velocity='1'/></joint></robot>"
        );
        from_text(&text).joints[0].limits
    };
    // The specification of 1.0 has 0 for both, which locks the joint; no program that steps robots
    // takes it so.
    assert_eq!(joint("1.2", ""), None);
    assert_eq!(joint("1.0", ""), None);
    let upper = Limits {
        lower: 0.0,
        upper: 2.0,
    };
    assert_eq!(joint("1.0", "upper='2'"), Some(upper));
    // PyBullet's two ways to write "none".
    assert_eq!(joint("1.0", "lower='1' upper='-1'"), None);
    assert_eq!(joint("1.0", "lower='0' upper='-1'"), None);
    // Other exchanged limits are those of a range.
    let (lower, upper) = (-0.5, 0.25);
    let range = Some(Limits { lower, upper });
    assert_eq!(joint("1.0", "lower='0.25' upper='-0.5'"), range);
}

#[test]
fn what_gazebo_is_told_to_hold_still_is_known() {
    for (tag, still) in [("true", true), ("1", true), ("false", false)] {
        let tag = format!("<gazebo><static>{tag}</static></gazebo>");
        let robot = from_text(&format!("<robot name='r'>{tag}<link name='a'/></robot>"));
        assert_eq!(robot.stands_still, still, "{tag}");
    }
}

/// One tetrahedron with corners 0, x, y, z at 1, 2, 3 m in three formats, mirrored and in mm.
#[test]
fn meshes_of_every_format_give_the_same_hull() {
    for file in ["ascii.STL", "solid.stl", "corner.obj", "corner.dae"] {
        let text = format!(
            "<robot name='r'><link name='a'><collision><geometry>
             <mesh filename='meshes/{file}' scale='-0.001 0.001 0.001'/></geometry></collision></link></robot>"
        );
        let robot = from_text(&text);
        let collision = &robot.links[0].collisions[0];
        assert!(collision.mesh.as_ref().is_some_and(|m| m.ends_with(file)));
        assert_eq!(robot.sources, [robots().join("meshes").join(file)]);
        let Shape::Hull { vertices } = &collision.shape else {
            panic!("{file} is no hull");
        };
        assert_eq!(vertices.len(), 4, "{file}: {vertices:?}");
        let corners = [
            [0.0, 0.0, 0.0],
            [-1e-3, 0.0, 0.0],
            [0.0, 2e-3, 0.0],
            [0.0, 0.0, 3e-3],
        ];
        for corner in corners.map(Vec3::from) {
            assert!(
                vertices.iter().any(|v| (v - corner).norm() < 1e-9),
                "{file}: {vertices:?}"
            );
        }
        // Solid of a tetrahedron at a right-angled corner: centre of mass a quarter of the edges,
        // Ixx = 3/80 m (b² + c²) about it.
        let solid = collision.shape.solid_inertia(2.0);
        assert!((solid.com - Vec3::new(-0.25e-3, 0.5e-3, 0.75e-3)).norm() < 1e-9);
        let expected = 3.0 / 80.0 * 2.0 * (4.0 + 9.0) * 1e-6;
        assert!(
            (solid.I_cm[(0, 0)] - expected).abs() < 1e-9 * expected.max(1e-3),
            "{file}"
        );
    }
}

#[test]
fn problems_with_inertia_are_warnings_where_it_is_not_used() {
    let text = "<robot name='r'><link name='a'><inertial><mass value='1'/>
                <inertia ixx='1' ixy='2' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>";
    let read = |impossible_inertia| {
        let options = ReadOptions {
            impossible_inertia,
            ..ReadOptions::default()
        };
        read_str(text, "r.urdf", &robots(), &options)
    };
    let refused = read(ImpossibleInertia::Refused).expect_err("not a body");
    assert_eq!(refused[0].code, "U061");
    // eigenvalues 3, 1, -1: second moments 3/2 - those = -3/2, 1/2, 5/2, the first to zero:
    // moments 3, 5/2, 1/2 along (1,1,0)/√2, z, (1,-1,0)/√2
    let help = refused[0].help.as_deref().unwrap_or_default();
    assert!(
        help.contains("ixx=\"1.750000e0\" ixy=\"1.250000e0\""),
        "{help}"
    );
    for way in [ImpossibleInertia::Unused, ImpossibleInertia::Nearest] {
        let told = &read(way).expect("a robot").diagnostics[0];
        assert!(told.code == "U061" && told.severity == Severity::Warning);
    }
}

#[test]
fn names_of_any_characters_are_read_unchanged() {
    let names = [
        "a b", " a", "a ", "a  b", "a/b", "a::b", "<a>", "a&b", "'a'", "\"a\"", "]]>", "--", "ä",
        "日本", "🤖", "\u{fffd}", "\u{e000}", "{a}", "&amp;", "a=b", "%s", "\\", "0", "-",
    ];
    for name in names {
        let escaped = name
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('"', "&quot;");
        let text = format!(
            "<robot name=\"r\"><link name=\"{escaped}\"/><link name=\"other\"/><joint name=\"{escaped}\" type=\"fixed\">
             <parent link=\"{escaped}\"/><child link=\"other\"/></joint></robot>"
        );
        let robot = from_text(&text);
        assert_eq!(robot.links[0].name, name);
        assert_eq!(
            (robot.joints[0].name.as_str(), robot.joints[0].parent),
            (name, 0)
        );
    }
}

/// `tests/robots/sensors.urdf`, up to the numbers that its sensors give.
#[test]
fn sensors_of_a_file_are_read_on_request_and_measure() {
    let text = "robot.sensors = \"urdf\"\nrobot.base = \"fixed\"\ninitial.xyz = [0, 0, 1]\n";
    let settings = Settings::parse(text, "s.toml").expect("legal settings");
    let options = assemble::read_options(&settings, ReadOptions::default());
    let description = read(&robots().join("sensors.urdf"), &options).expect("a robot");
    let names: Vec<_> = description.sensors.iter().map(|s| &s.name.text).collect();
    assert_eq!(names, ["lidar", "imu", "bumper", "load", "laser"]);
    let left_out = |d: &&Diagnostic| d.code == "U022" && d.message.contains("'camera'");
    assert_eq!(description.diagnostics.iter().filter(left_out).count(), 1);
    let model = assemble::build(&description, &settings).expect("a model");
    let rows = table(&model.model).expect("no clash");
    let mut simulation = Simulation::new(Arc::new(model.model));
    simulation.initialize(0.0).expect("a sound model");
    let mut value = |name: &str| match find(&rows, name).expect(name).slot {
        Slot::Output(slot) => simulation.output(slot),
        _ => panic!("{name} is no output"),
    };
    // Bias upwards; the mast of 0.5 kg hangs on its weld.
    assert!((value("sensor.imu.linear_acceleration.z") - 9.91).abs() < 1e-12);
    assert!((value("sensor.load.force.z") - 0.5 * 9.81).abs() < 1e-12);
    assert!(value("sensor.lidar.ray[2,9]") > 7.9);
    assert!((value("sensor.laser.ray[3]") - 10.0).abs() < 1e-12);
}
