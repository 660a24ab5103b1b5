//! Sensors of files in the ways in which Gazebo's and ROS's documentation writes them.

#![expect(clippy::float_cmp, reason = "exact numbers are expected")]

use crate::diagnostic::{Diagnostic, Severity};
use crate::spatial::Vec3;
use crate::urdf::{Description, ReadOptions, SensedKind, SensorDescription, read_str};
use std::path::Path;

const LINKS: &str = "<link name='base'/><link name='head'/><joint name='neck' type='fixed'>\
    <parent link='base'/><child link='head'/></joint>";

fn read(tags: &str, options: &ReadOptions) -> Result<Description, Vec<Diagnostic>> {
    let text = format!("<robot name='r'>{LINKS}\n{tags}</robot>");
    read_str(&text, "r.urdf", Path::new("."), options)
}

fn on() -> ReadOptions {
    ReadOptions {
        sensors: true,
        ..ReadOptions::default()
    }
}

/// The sensors, and the warnings.
fn sensors(tags: &str) -> (Vec<SensorDescription>, Vec<String>) {
    let description = read(tags, &on()).unwrap_or_else(|findings| panic!("{findings:?}"));
    let warnings = description.diagnostics.iter();
    let warnings = warnings
        .filter(|d| d.severity == Severity::Warning)
        .map(|d| d.message.clone())
        .collect();
    (description.sensors, warnings)
}

/// The one sensor of a file without warnings.
fn sensor(tags: &str) -> SensorDescription {
    let (mut sensors, warnings) = sensors(tags);
    assert!(
        warnings.is_empty() && sensors.len() == 1,
        "{warnings:?} {sensors:?}"
    );
    sensors.remove(0)
}

const LIDAR: &str = "<gazebo reference='head'><sensor name='lidar' type='gpu_ray'>\
    <pose>0.1 0.2 0.3 0 0 1.5</pose><update_rate>40</update_rate><visualize>true</visualize>\
    <ray><scan><horizontal><samples>720</samples><resolution>1</resolution>\
    <min_angle>-1.57</min_angle><max_angle>1.0</max_angle></horizontal>\
    <vertical><samples>4</samples><min_angle>-0.1</min_angle><max_angle>0.2</max_angle></vertical>\
    </scan><range><min>0.1</min><max>30</max><resolution>0.01</resolution></range>\
    <noise><type>gaussian</type><mean>0.002</mean><stddev>0.01</stddev></noise></ray>\
    <plugin name='p' filename='lib.so'><topicName>scan</topicName></plugin></sensor></gazebo>";

#[test]
fn a_lidar_of_gazebo_keeps_its_rate_pose_angles_ranges_and_noise() {
    let lidar = sensor(LIDAR);
    assert_eq!(
        (lidar.name.text.as_str(), lidar.on.text.as_str()),
        ("lidar", "head")
    );
    assert_eq!(
        (lidar.xyz, lidar.rpy),
        (Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.0, 0.0, 1.5))
    );
    assert_eq!(lidar.rate, Some(40.0));
    assert_eq!(
        lidar.kind,
        SensedKind::Ray {
            columns: (720, [-1.57, 1.0]),
            rows: (4, [-0.1, 0.2]),
            range: [0.1, 30.0],
        }
    );
    assert_eq!(lidar.errors, [[[0.002; 3], [0.01; 3]]]);
}

#[test]
fn sensors_are_left_out_unless_they_are_asked_for() {
    let description = read(LIDAR, &ReadOptions::default()).expect("a robot");
    assert!(description.sensors.is_empty());
    let notes = description.diagnostics.iter();
    let ignored: Vec<_> = notes.filter(|d| d.message.contains("<sensor>")).collect();
    assert!(
        ignored.len() == 1 && ignored[0].code == "U020",
        "{ignored:?}"
    );
}

#[test]
fn an_inertial_unit_has_the_noise_of_each_axis_or_of_all() {
    let noise =
        |x: f64| format!("<noise type='gaussian'><mean>{x}</mean><stddev>1{x}</stddev></noise>");
    let axis = |(name, x): (&str, f64)| format!("<{name}>{}</{name}>", noise(x));
    let axes = [("x", 0.25), ("y", 0.5), ("z", 0.75)].map(axis).concat();
    let imu = sensor(&format!(
        "<gazebo reference='base'><sensor name='imu' type='imu'><update_rate>100</update_rate>\
         <imu><angular_velocity>{axes}</angular_velocity></imu></sensor></gazebo>"
    ));
    assert_eq!(imu.errors[0], [[0.25, 0.5, 0.75], [10.25, 10.5, 10.75]]);
    assert_eq!(imu.errors[1], [[0.0; 3], [0.0; 3]]);
    // As before SDF 1.5.
    let imu = sensor(
        "<gazebo reference='base'><sensor name='imu' type='imu'><update_rate>100</update_rate>\
         <imu><noise><type>gaussian</type><rate><mean>0.1</mean><stddev>0.2</stddev></rate>\
         <accel><bias_mean>0.3</bias_mean><stddev>0.4</stddev></accel></noise></imu></sensor></gazebo>",
    );
    assert_eq!(imu.errors, [[[0.1; 3], [0.2; 3]], [[0.3; 3], [0.4; 3]]]);
}

#[test]
fn a_force_torque_sensor_has_the_frame_and_the_direction_of_sdf() {
    let of = |inner: &str| {
        sensor(&format!(
            "<gazebo reference='neck'><sensor name='ft' type='force_torque'>\
             <update_rate>0</update_rate><force_torque>{inner}</force_torque></sensor></gazebo>"
        ))
    };
    let kind = |in_parent, reversed| SensedKind::ForceTorque {
        in_parent,
        reversed,
    };
    assert_eq!((of("").kind, of("").rate), (kind(false, true), None));
    let other = of("<frame>parent</frame><measure_direction>parent_to_child</measure_direction>");
    assert_eq!(other.kind, kind(true, false));
    // The rotation of its pose is that of its own frame alone, and its position is nowhere used.
    for (frame, pose, yaw, told) in [
        ("sensor", "0 0 0 0 0 1", 1.0, None),
        (
            "sensor",
            "0 0 1 0 0 1",
            1.0,
            Some("its position is not used"),
        ),
        ("child", "0 0 0 0 0 1", 0.0, Some("its pose is not used")),
        ("parent", "0 0 0 0 0 0", 0.0, None),
    ] {
        let text = format!(
            "<gazebo reference='neck'><sensor name='ft' type='force_torque'><pose>{pose}</pose>\
             <update_rate>0</update_rate><force_torque><frame>{frame}</frame></force_torque>\
             </sensor></gazebo>"
        );
        let robot = read(&text, &on()).expect("a robot");
        let found = &robot.sensors[0];
        assert_eq!((found.rpy.z, found.xyz), (yaw, Vec3::zeros()), "{frame}");
        let warned = robot.diagnostics.iter().find(|d| d.code == "U022");
        assert_eq!(warned.is_some(), told.is_some(), "{frame}: {warned:?}");
        if let (Some(warned), Some(words)) = (warned, told) {
            assert!(warned.message.contains(words), "{warned:?}");
        }
    }
}

#[test]
fn a_ray_of_urdf_has_attributes_and_a_parent() {
    let ray = sensor(
        "<sensor name='laser' update_rate='20'><parent link='head'/><origin xyz='1 0 0' rpy='0 0 1'/>\
         <ray><horizontal samples='100' resolution='1' min_angle='-1.5' max_angle='1.5'/>\
         <vertical samples='1' resolution='1' min_angle='0' max_angle='0'/></ray></sensor>",
    );
    assert_eq!((ray.rate, ray.xyz.x, ray.rpy.z), (Some(20.0), 1.0, 1.0));
    assert_eq!(
        ray.kind,
        SensedKind::Ray {
            columns: (100, [-1.5, 1.5]),
            rows: (1, [0.0, 0.0]),
            range: [0.0, 10.0],
        }
    );
}

#[test]
fn lengths_of_sensors_follow_the_scale() {
    let options = ReadOptions { scale: 2.0, ..on() };
    let lidar = read(LIDAR, &options).expect("a robot").sensors.remove(0);
    assert_eq!(lidar.xyz, Vec3::new(0.2, 0.4, 0.6));
    let SensedKind::Ray { range, .. } = lidar.kind else {
        panic!("rays");
    };
    assert_eq!(range, [0.2, 60.0]);
}

#[test]
fn what_is_not_understood_is_named() {
    let in_gazebo = |sensor: &str| format!("<gazebo reference='head'>{sensor}</gazebo>");
    for (tags, count, words) in [
        (
            in_gazebo("<sensor name='c' type='camera'><camera/></sensor>"),
            0,
            "'camera'",
        ),
        (in_gazebo("<sensor name='c'/>"), 0, "no type"),
        (
            in_gazebo("<sensor name='i' type='imu'><battery/><power/></sensor>"),
            1,
            "<battery>, <power>",
        ),
        (
            in_gazebo("<sensor:ray xmlns:sensor='x' name='l'/>"),
            0,
            "<sensor:ray>",
        ),
        (
            "<gazebo reference='nose'><sensor name='i' type='imu'/></gazebo>".to_owned(),
            0,
            "does not exist",
        ),
        (
            "<gazebo><sensor name='i' type='imu'/></gazebo>".to_owned(),
            0,
            "fixed to",
        ),
        (
            in_gazebo(
                "<sensor name='i' type='imu'><pose relative_to='x'>0 0 0 0 0 0</pose></sensor>",
            ),
            1,
            "attributes of <pose>",
        ),
        (
            in_gazebo(
                "<sensor name='l' type='ray'><ray><noise><stddev>1</stddev></noise></ray></sensor>",
            ),
            1,
            "no update_rate",
        ),
        (
            in_gazebo(
                "<sensor name='l' type='ray'><update_rate>1</update_rate><ray><noise>\
                 <bias_stddev>1</bias_stddev></noise></ray></sensor>",
            ),
            1,
            "bias_stddev",
        ),
    ] {
        let (sensors, warnings) = sensors(&tags);
        assert_eq!(sensors.len(), count, "{tags}");
        assert!(
            warnings.iter().any(|w| w.contains(words)),
            "{tags}: {warnings:?}"
        );
    }
}

#[test]
fn broken_numbers_of_sensors_are_errors_with_their_place() {
    let ray = |inner: &str| {
        format!("<gazebo reference='head'><sensor name='l' type='ray'>{inner}</sensor></gazebo>")
    };
    let samples = |n: &str| {
        ray(&format!(
            "<ray><scan><horizontal><samples>{n}</samples></horizontal></scan></ray>"
        ))
    };
    for tags in [
        ray("<update_rate>-1</update_rate><ray/>"),
        ray("<update_rate>nan</update_rate><ray/>"),
        ray("<pose>0 0 0</pose><ray/>"),
        ray("<pose>0 0 inf 0 0 0</pose><ray/>"),
        samples("0"),
        samples("many"),
        samples("20000"),
        ray("<ray><range><min>-1</min></range></ray>"),
        ray("<ray><range><min>3</min><max>2</max></range></ray>"),
        ray("<update_rate>1</update_rate><ray><noise><stddev>-1</stddev></noise></ray>"),
        "<sensor><parent link='head'/><ray/></sensor>".to_owned(),
    ] {
        let findings = read(&tags, &on()).expect_err(&tags);
        let errors: Vec<_> = findings
            .iter()
            .filter(|d| d.severity == Severity::Error)
            .collect();
        assert_eq!(errors.len(), 1, "{tags}: {findings:?}");
        let place = errors[0].place.as_ref().expect("a place");
        assert_eq!(place.line, 2, "{tags}");
    }
}

#[test]
fn sensors_of_a_file_become_outputs_on_request() {
    let names = |settings: &str| -> Vec<String> {
        let settings = crate::settings::Settings::parse(settings, "s.toml").expect("legal");
        let options = crate::assemble::read_options(&settings, ReadOptions::default());
        let tags = "<gazebo reference='neck'><sensor name='load' type='force_torque'/></gazebo>";
        let description = read(&format!("{LIDAR}{tags}"), &options).expect("a robot");
        let model = crate::assemble::build(&description, &settings).expect("a model");
        let rows = crate::variables::table(&model.model)
            .expect("no clash")
            .into_iter();
        rows.map(|row| row.name)
            .filter(|name| name.starts_with("sensor."))
            .collect()
    };
    assert!(names("").is_empty());
    let found = names("robot.sensors = \"urdf\"\n");
    assert_eq!(found.len(), 720 * 4 + 6);
    assert_eq!(found[0], "sensor.lidar.ray[1,1]");
    assert_eq!(found[720 * 4], "sensor.load.force.x");
}
