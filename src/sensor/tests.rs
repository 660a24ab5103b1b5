//! Expected values: statics, free flight, the mathematical pendulum, and the joint's own equation
//! of motion.

use crate::assemble::testing::{
    at, ball, body, collision, error, frame, mass, model, point, robot,
};
use crate::model::JointKind::{Continuous, Fixed, Prismatic, Revolute};
use crate::model::{JointId, LinkId, SensorId};
use crate::simulation::{InputSlot, OutputSlot, Sensed, Simulation};
use crate::spatial::{Mat3, Pose, Vec3};
use crate::urdf::Description;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};
use std::sync::Arc;

mod balance;
mod others;

const G: f64 = 9.81;

fn start(description: &Description, settings: &str) -> Simulation {
    let mut simulation = Simulation::new(Arc::new(model(description, settings)));
    simulation.initialize(0.0).expect("a legal start");
    simulation
}

fn read(s: &mut Simulation, what: fn(u8) -> Sensed, sensor: u32) -> Vec3 {
    let slot = |axis| OutputSlot::Sensor(SensorId(sensor), what(axis));
    Vec3::new(s.output(slot(0)), s.output(slot(1)), s.output(slot(2)))
}

fn acceleration(s: &mut Simulation) -> Vec3 {
    read(s, Sensed::Acceleration, 0)
}

/// Force and torque of sensor 0.
fn wrench(s: &mut Simulation) -> [Vec3; 2] {
    [read(s, Sensed::Force, 0), read(s, Sensed::Torque, 0)]
}

fn near(found: Vec3, expected: Vec3, tolerance: f64) {
    assert!(
        (found - expected).norm() <= tolerance,
        "{found} is not {expected}"
    );
}

#[test]
fn an_imu_at_rest_measures_gravity_in_its_own_axes() {
    // Lying on its side: roll of a quarter turn, up is then the link's −y … and the sensor is
    // turned once more.
    let settings = format!(
        "robot.base = \"fixed\"\ninitial.rpy = [{FRAC_PI_2}, 0, 0]\n[[sensor]]\ntype = \"imu\"\nlink = \"box\"\n\
         [[sensor]]\ntype = \"imu\"\nname = \"turned\"\nlink = \"box\"\nrpy = [0, 0, {FRAC_PI_2}]\nxyz = [1, 2, 3]\n"
    );
    let mut s = start(&robot(body("box", 1.0)), &settings);
    // z of the world is the link's y after a roll of +90°.
    near(acceleration(&mut s), Vec3::new(0.0, G, 0.0), 1e-14);
    near(
        read(&mut s, Sensed::Acceleration, 1),
        Vec3::new(G, 0.0, 0.0),
        1e-14,
    );
    let q: Vec<f64> = (0..4)
        .map(|i| s.output(OutputSlot::Sensor(SensorId(0), Sensed::Orientation(i))))
        .collect();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert!(
        (q[0] - half).abs() < 1e-15 && (q[3] - half).abs() < 1e-15,
        "{q:?}"
    );
}

#[test]
fn an_imu_in_free_flight_measures_only_its_rotation() {
    // A ball that spins about z: ω × (ω × r) = −ω² r, whatever its flight.
    let settings = "world.ground.type = \"none\"\ninitial.angular_velocity = [0, 0, 3]\n\
                    initial.linear_velocity = [5, -2, 7]\n[[sensor]]\ntype = \"imu\"\nlink = \"box\"\n\
                    [[sensor]]\ntype = \"imu\"\nname = \"arm\"\nlink = \"box\"\nxyz = [0.5, 0, 0.2]\n";
    let mut s = start(&robot(mass("box", 2.0)), settings);
    for _ in 0..3 {
        near(acceleration(&mut s), Vec3::zeros(), 1e-12);
        let arm = read(&mut s, Sensed::Acceleration, 1);
        near(arm, Vec3::new(-9.0 * 0.5, 0.0, 0.0), 1e-9);
        let spin = read(&mut s, Sensed::AngularVelocity, 1);
        near(spin, Vec3::new(0.0, 0.0, 3.0), 1e-9);
        s.advance_to(s.time() + 0.3).expect("finite");
    }
}

/// A table that turns about z with ω: `ω² r` towards the middle, and g upwards.
#[test]
fn an_imu_on_a_turntable_measures_the_centripetal_acceleration() {
    let (omega, r) = (3.0, 0.4);
    let table = robot(frame("world")).with(
        "world",
        "axle",
        Continuous,
        at(0.0, 0.0, 1.0),
        mass("table", 2.0),
    );
    let settings = format!(
        "initial.joint_velocities = {{ axle = {omega} }}\n[[actuator]]\njoint = \"axle\"\nmode = \"none\"\n\
         [[sensor]]\ntype = \"imu\"\nlink = \"table\"\nxyz = [{r}, 0, 0.1]\n"
    );
    let mut s = start(&table, &settings);
    for _ in 0..5 {
        near(
            acceleration(&mut s),
            Vec3::new(-omega * omega * r, 0.0, G),
            1e-12,
        );
        let spin = read(&mut s, Sensed::AngularVelocity, 0);
        near(spin, Vec3::new(0.0, 0.0, omega), 1e-12);
        s.advance_to(s.time() + 0.37).expect("finite");
    }
}

/// A point mass `m` on a rod of length `l` about y; at angle θ from hanging, with rate ω.
fn pendulum(m: f64, l: f64) -> Description {
    robot(frame("world"))
        .with(
            "world",
            "hinge",
            Continuous,
            at(0.0, 0.0, 2.0),
            point("bob", m, Vec3::new(0.0, 0.0, -l)),
        )
        .and(|j| j.axis = Vec3::y())
}

#[test]
fn a_pendulum_pulls_at_its_hinge_with_weight_and_centrifugal_force() {
    let (m, l, theta, omega) = (2.0, 0.7, FRAC_PI_3, 4.0);
    let settings = format!(
        "initial.joints = {{ hinge = {theta} }}\ninitial.joint_velocities = {{ hinge = {omega} }}\n\
         [[actuator]]\njoint = \"hinge\"\nmode = \"none\"\n\
         [[sensor]]\ntype = \"ft\"\njoint = \"hinge\"\n\
         [[sensor]]\ntype = \"ft\"\nname = \"outside\"\njoint = \"hinge\"\nframe = \"parent\"\n\
         [[sensor]]\ntype = \"imu\"\nname = \"bob\"\nlink = \"bob\"\nxyz = [0, 0, {}]\n",
        -l
    );
    let mut s = start(&pendulum(m, l), &settings);
    // The hinge holds the bob with m (g cos θ + ω² l) along the rod, which is the link's z; nothing
    // across it, because the bob falls as it likes, and no torque about the hinge.
    let tension = m * (G * theta.cos() + omega * omega * l);
    let [force, torque] = wrench(&mut s);
    near(force, Vec3::new(0.0, 0.0, tension), 1e-12 * tension);
    near(torque, Vec3::zeros(), 1e-12 * tension);
    // In the world's axes the rod points from the bob to the hinge: (sin θ, 0, cos θ).
    let rod = Vec3::new(theta.sin(), 0.0, theta.cos());
    near(
        read(&mut s, Sensed::Force, 1),
        rod * tension,
        1e-12 * tension,
    );
    // What the bob feels is what the rod does to it, per mass.
    let felt = read(&mut s, Sensed::Acceleration, 2);
    near(felt, Vec3::new(0.0, 0.0, tension / m), 1e-12 * tension);
}

#[test]
fn a_weld_carries_the_weight_and_the_moment_of_what_hangs_on_it() {
    // 3 kg at 0.5 m along x of a flange, the flange 1 m up a column: weight 3 g, moment r × (m g
    // ẑ) = −0.5·3·g ŷ.
    let tool = point("tool", 3.0, Vec3::new(0.5, 0.0, 0.0));
    let arm = robot(mass("column", 5.0)).with("column", "flange", Fixed, at(0.0, 0.0, 1.0), tool);
    for (direction, sign) in [("parent_to_child", 1.0), ("child_to_parent", -1.0)] {
        let settings = format!(
            "robot.base = \"fixed\"\n[[sensor]]\ntype = \"ft\"\njoint = \"flange\"\ndirection = \"{direction}\"\n"
        );
        let mut s = start(&arm, &settings);
        let [force, torque] = wrench(&mut s);
        near(force, Vec3::new(0.0, 0.0, 3.0 * G) * sign, 1e-13);
        near(torque, Vec3::new(0.0, -1.5 * G, 0.0) * sign, 1e-13);
    }
}

#[test]
fn an_ankle_sensor_measures_the_load_above_it_and_not_the_ground_force() {
    // The foot, 1 kg, stands on the ground and carries 4 kg by a weld: the parent presses it down
    // with 4 g.
    let mut foot = body("foot", 1.0);
    foot.collisions = [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)]
        .map(|(x, y)| collision(at(x, y, 0.0), ball()))
        .to_vec();
    let leg = robot(mass("trunk", 4.0)).with("trunk", "ankle", Fixed, at(0.0, 0.0, -0.5), foot);
    let mut s = start(&leg, "[[sensor]]\ntype = \"ft\"\njoint = \"ankle\"\n");
    s.advance_to(3.0).expect("finite");
    let [force, torque] = wrench(&mut s);
    near(force, Vec3::new(0.0, 0.0, -4.0 * G), 1e-3);
    near(torque, Vec3::zeros(), 1e-3);
}

#[test]
fn an_external_wrench_appears_in_the_sensor_of_the_joint_that_carries_it() {
    let tool = point("tool", 1.0, Vec3::new(0.0, 0.0, 0.2));
    let arm = robot(mass("base", 5.0)).with("base", "flange", Fixed, Pose::IDENTITY, tool);
    let settings = "world.gravity = [0, 0, 0]\nworld.ground.type = \"none\"\n[[external_wrench]]\nlink = \"tool\"\n\
                    [[sensor]]\ntype = \"ft\"\njoint = \"flange\"\n";
    let mut s = Simulation::new(Arc::new(model(&arm, settings)));
    s.set_input(InputSlot::ExternalForce(LinkId(1), 2), 12.0);
    s.initialize(0.0).expect("a legal start");
    // 6 kg are pulled with 12 N: 2 m/s². The tool's share is 2 N, so it pulls at the flange with 10
    // N.
    let [force, _] = wrench(&mut s);
    near(force, Vec3::new(0.0, 0.0, -10.0), 1e-12);
}

#[test]
fn the_load_along_a_joint_axis_is_the_sum_of_motor_and_friction() {
    // An arm of three axes in full motion, with damping: axis · wrench = τ of the joint, whatever
    // the rest does.
    let lump = |name: &str, m: f64| {
        let mut link = mass(name, m);
        if let Some(inertia) = &mut link.inertial {
            inertia.com = Vec3::new(0.1, -0.05, 0.2);
            inertia.I_cm = Mat3::new(0.02, 0.003, 0.0, 0.003, 0.03, 0.001, 0.0, 0.001, 0.04) * m;
        }
        link
    };
    let tilted = Pose::from_xyz_rpy(Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.4, -0.7, 1.1));
    let arm = robot(mass("base", 3.0))
        .with("base", "a", Revolute, tilted, lump("upper", 2.0))
        .with("upper", "b", Prismatic, tilted, lump("slide", 1.5))
        .and(|j| j.axis = Vec3::new(0.0, 0.6, 0.8))
        .with("slide", "c", Revolute, tilted, lump("hand", 1.0))
        .and(|j| j.axis = Vec3::x())
        .with("hand", "d", Fixed, tilted, lump("tool", 0.5));
    let sensors: String = ["a", "b", "c"]
        .map(|j| format!("[[sensor]]\ntype = \"ft\"\njoint = \"{j}\"\n"))
        .concat();
    let settings = format!(
        "world.ground.type = \"none\"\ninitial.angular_velocity = [0.3, -1, 2]\ninitial.rpy = [0.2, 0.3, 0.4]\n\
         initial.joints = {{ a = 0.5, b = 0.2, c = -0.4 }}\n\
         initial.joint_velocities = {{ a = 1.5, b = -0.3, c = 2.0 }}\n\
         [joint.\"*\"]\ndamping = 0\n[joint.a]\ndamping = 0.7\n[[actuator]]\njoint = \"*\"\nmode = \"effort\"\n{sensors}"
    );
    let mut s = start(&arm, &settings);
    let efforts = [3.0, -8.0, 1.0];
    for (a, effort) in (0..).zip(efforts) {
        s.set_input(InputSlot::Effort(crate::model::ActuatorId(a)), effort);
    }
    s.advance_to(0.05).expect("finite");
    for (j, (axis, effort)) in [Vec3::z(), Vec3::new(0.0, 0.6, 0.8), Vec3::x()]
        .into_iter()
        .zip(efforts)
        .enumerate()
    {
        let sensor = u32::try_from(j).expect("few");
        let slot = if j == 1 {
            Sensed::Force
        } else {
            Sensed::Torque
        };
        let carried = axis.dot(&read(&mut s, slot, sensor));
        let rate = s.output(OutputSlot::JointVelocity(JointId::from(j), 0));
        let tau = effort - if j == 0 { 0.7 * rate } else { 0.0 };
        assert!(
            (carried - tau).abs() < 1e-9,
            "joint {j}: {carried} is not {tau}"
        );
    }
}

#[test]
fn the_imu_of_a_moving_arm_agrees_with_the_velocity_of_its_link() {
    // Central differences of the link's velocity, less gravity, turned into the link's axes.
    let arm = robot(frame("world"))
        .with(
            "world",
            "a",
            Revolute,
            at(0.0, 0.0, 1.0),
            mass("upper", 2.0),
        )
        .and(|j| j.axis = Vec3::y())
        .with(
            "upper",
            "b",
            Continuous,
            at(0.3, 0.0, 0.0),
            mass("hand", 1.0),
        )
        .and(|j| j.axis = Vec3::x())
        .with("hand", "tip", Fixed, at(0.1, 0.2, 0.0), frame("tip"));
    let settings = "initial.joints = { a = 0.4 }\ninitial.joint_velocities = { a = 2, b = -3 }\n\
                    outputs.links = [\"tip\"]\nsolver.tolerance = 1e-10\n\
                    [[actuator]]\njoint = \"*\"\nmode = \"none\"\n[[sensor]]\ntype = \"imu\"\nlink = \"tip\"\n";
    let link = LinkId(3);
    let velocity = |s: &mut Simulation| {
        Vec3::from(std::array::from_fn(|i| {
            let axis = u8::try_from(i).expect("three");
            s.output(OutputSlot::LinkLinearVelocity(link, axis))
        }))
    };
    let h = 1e-4;
    let run_to = |time: f64| {
        let mut s = start(&arm, settings);
        s.advance_to(time).expect("finite");
        s
    };
    let (mut before, mut now, mut after) = (run_to(0.2 - h), run_to(0.2), run_to(0.2 + h));
    let change = (velocity(&mut after) - velocity(&mut before)) / (2.0 * h);
    let q: [f64; 4] = std::array::from_fn(|i| {
        let component = [3, 0, 1, 2][i];
        now.output(OutputSlot::LinkOrientation(link, component))
    });
    let R_WS = crate::spatial::rotation_from_quaternion(&q);
    let expected = R_WS.transpose() * (change + Vec3::new(0.0, 0.0, G));
    near(acceleration(&mut now), expected, 1e-4);
}

#[test]
fn rays_measure_the_distance_to_the_ground() {
    let sensor = |more: &str| {
        format!(
            "robot.base = \"fixed\"\ninitial.xyz = [0, 0, 2]\n[[sensor]]\ntype = \"ray\"\nname = \"eye\"\nlink = \"box\"\n{more}"
        )
    };
    let rays = |more: &str, n: u32| -> Vec<f64> {
        let mut s = start(&robot(body("box", 1.0)), &sensor(more));
        (0..n)
            .map(|ray| s.output(OutputSlot::Sensor(SensorId(0), Sensed::Distance(ray))))
            .collect()
    };
    // Straight down from 2 m, and from 0.5 m above the link.
    let down = format!("rpy = [0, {FRAC_PI_2}, 0]\n");
    assert!((rays(&down, 1)[0] - 2.0).abs() < 1e-12);
    assert!((rays(&format!("{down}xyz = [0, 0, 0.5]\n"), 1)[0] - 2.5).abs() < 1e-12);
    // Three rays over 120° about the one that points down: 2 m / cos 60° to both sides.
    let fan = rays(&format!("{down}rays = 3\nfov = {}\n", 2.0 * FRAC_PI_3), 3);
    for (found, expected) in fan.iter().zip([4.0, 2.0, 4.0]) {
        assert!((found - expected).abs() < 1e-12, "{fan:?}");
    }
    // Nothing in reach, nothing below, nothing at all.
    assert_eq!(rays(&format!("{down}range = 1.5\n"), 1), [1.5]);
    assert_eq!(rays("", 1), [10.0]);
    assert_eq!(
        rays(
            &format!("{down}[world]\nground = {{ type = \"none\" }}\n"),
            1
        ),
        [10.0]
    );
}

#[test]
fn a_sensor_is_on_one_link_or_joint_and_has_a_name_of_its_own() {
    let arm = robot(mass("base", 1.0)).with("base", "j", Fixed, Pose::IDENTITY, mass("tip", 1.0));
    let found = error(&arm, "[[sensor]]\ntype = \"imu\"\nlink = \"*\"\n");
    assert_eq!((found.code, found.place.map(|p| p.line)), ("A131", Some(3)));
    let twice =
        "[[sensor]]\ntype = \"imu\"\nlink = \"tip\"\n[[sensor]]\ntype = \"ray\"\nlink = \"tip\"\n";
    assert_eq!(error(&arm, twice).code, "A131");
    let found = error(&arm, "[[sensor]]\ntype = \"ft\"\njoint = \"jj\"\n");
    assert_eq!(found.code, "A101");
    assert!(found.help.is_some_and(|h| h.contains("'j'")));
}
