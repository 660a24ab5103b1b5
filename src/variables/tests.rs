#![cfg(feature = "urdf")]

mod arrays;
mod words;

use super::*;
use crate::assemble::testing::{at, body, frame, mass, model, robot};
use crate::model::JointKind::{
    Continuous, Fixed, Floating, Planar, Prismatic, Revolute, Spherical,
};
use crate::model::Limits;
use crate::slots::OutputSlot;
use crate::urdf::Description;

fn cart() -> Description {
    robot(body("chassis", 5.0))
        .with(
            "chassis",
            "left wheel",
            Continuous,
            at(0.0, 0.2, 0.0),
            body("left_rim", 1.0),
        )
        .with(
            "chassis",
            "lift",
            Prismatic,
            at(0.0, 0.0, 0.5),
            mass("fork", 1.0),
        )
        .with(
            "fork",
            "grip",
            Revolute,
            at(0.0, 0.0, 0.0),
            mass("finger", 0.1),
        )
        .mimicking("lift", 1.0, 0.0)
        .with("fork", "eye", Fixed, at(0.0, 0.0, 0.0), frame("camera"))
}

fn table_of(description: &Description, settings: &str) -> Vec<Variable> {
    table(&model(description, settings)).expect("no clash")
}

fn names(table: &[Variable], keep: impl Fn(&Slot) -> bool) -> Vec<&str> {
    let kept = table.iter().filter(|v| keep(&v.slot));
    kept.map(|v| v.name.as_str()).collect()
}

fn get<'t>(table: &'t [Variable], name: &str) -> &'t Variable {
    find(table, name).unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn the_variables_of_a_small_robot_are_those_of_the_interface_page() {
    let table = table_of(&cart(), "");
    assert_eq!(
        names(&table, |s| matches!(s, Slot::Input(_))),
        [
            "cmd.left_wheel.velocity",
            "cmd.left_wheel.max_effort",
            "cmd.lift.position",
            "cmd.lift.max_effort"
        ]
    );
    let expected = "
        base.position.x base.position.y base.position.z
        base.orientation.x base.orientation.y base.orientation.z base.orientation.w
        base.rpy.roll base.rpy.pitch base.rpy.yaw
        base.linear_velocity.x base.linear_velocity.y base.linear_velocity.z
        base.angular_velocity.x base.angular_velocity.y base.angular_velocity.z
        joint.left_wheel.position joint.left_wheel.velocity joint.left_wheel.acceleration joint.left_wheel.effort
        joint.lift.position joint.lift.velocity joint.lift.acceleration joint.lift.effort
        joint.grip.position joint.grip.velocity joint.grip.acceleration joint.grip.effort
        contact.chassis.active contact.chassis.force.x contact.chassis.force.y contact.chassis.force.z
        contact.left_rim.active contact.left_rim.force.x contact.left_rim.force.y contact.left_rim.force.z
        energy.kinetic energy.potential
        solver.steps solver.rejected solver.newton_max";
    assert_eq!(
        names(&table, |s| matches!(s, Slot::Output(_))),
        expected.split_whitespace().collect::<Vec<_>>()
    );
    let expected = "
        initial.base.position.x initial.base.position.y initial.base.position.z
        initial.base.rpy.roll initial.base.rpy.pitch initial.base.rpy.yaw
        initial.base.linear_velocity.x initial.base.linear_velocity.y initial.base.linear_velocity.z
        initial.base.angular_velocity.x initial.base.angular_velocity.y initial.base.angular_velocity.z
        initial.joint.left_wheel.position initial.joint.left_wheel.velocity
        initial.joint.lift.position initial.joint.lift.velocity
        joint.left_wheel.damping joint.left_wheel.friction
        joint.lift.damping joint.lift.friction
        joint.grip.damping joint.grip.friction
        link.chassis.friction link.chassis.mass link.left_rim.friction link.left_rim.mass
        link.fork.mass link.finger.mass
        world.gravity.x world.gravity.y world.gravity.z
        world.ground.friction world.ground.restitution
        solver.step_size solver.tolerance solver.max_steps";
    assert_eq!(
        names(&table, |s| matches!(s, Slot::Parameter(_))),
        expected.split_whitespace().collect::<Vec<_>>()
    );
}

#[test]
fn contact_points_are_outputs_on_request() {
    let settings = "[outputs]\ncontacts = [\"left_rim\"]\ncontact_points = true\n";
    let table = table_of(&cart(), settings);
    let mut of_contacts = names(&table, |s| matches!(s, Slot::Output(_)));
    of_contacts.retain(|name| name.starts_with("contact."));
    let expected = "contact.left_rim.active
        contact.left_rim.force.x contact.left_rim.force.y contact.left_rim.force.z
        contact.left_rim.point.x contact.left_rim.point.y contact.left_rim.point.z";
    assert_eq!(of_contacts, expected.split_whitespace().collect::<Vec<_>>());
    assert_eq!(get(&table, "contact.left_rim.point.x").unit, Unit::Meter);
}

#[test]
fn rows_are_numbered_and_ordered_inputs_outputs_parameters() {
    let table = table_of(&cart(), "");
    let rank = |v: &Variable| match v.slot {
        Slot::Input(_) => 0,
        Slot::Output(_) => 1,
        Slot::Parameter(_) => 2,
    };
    for (i, pair) in table.windows(2).enumerate() {
        assert_eq!(pair[0].value_reference as usize, i);
        assert!(rank(&pair[0]) <= rank(&pair[1]), "{}", pair[1].name);
    }
    assert_eq!(table, table_of(&cart(), ""));
}

#[test]
fn starts_and_bounds_follow_the_joint() {
    let table = table_of(&cart(), "initial.joints = { lift = 1.5 }");
    let velocity = get(&table, "cmd.left_wheel.velocity");
    assert_eq!(
        (velocity.start, velocity.min, velocity.max),
        (Some(0.0), Some(-5.0), Some(5.0))
    );
    let effort = get(&table, "cmd.lift.max_effort");
    assert_eq!(
        (effort.start, effort.min, effort.max),
        (Some(10.0), Some(0.0), None)
    );
    assert_eq!(effort.unit, Unit::Newton);
    for name in ["cmd.lift.position", "initial.joint.lift.position"] {
        let position = get(&table, name);
        assert_eq!(
            (position.start, position.min, position.max),
            (Some(1.5), Some(-1.0), Some(2.0))
        );
        assert_eq!(position.unit, Unit::Meter);
    }
    assert_eq!(get(&table, "link.fork.mass").start, Some(1.0));
    assert_eq!(get(&table, "initial.base.position.z").min, None);
}

#[test]
fn every_start_lies_in_its_bounds_and_outputs_have_neither() {
    // A start beyond the velocity limit, and a limit narrowed by a mimic joint.
    let description = cart();
    let table = table_of(
        &description,
        "initial.joint_velocities = { lift = -7 }\n[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 3\nkd = 1",
    );
    for v in &table {
        if let Slot::Output(_) = v.slot {
            assert_eq!((v.start, v.min, v.max), (None, None, None), "{}", v.name);
            continue;
        }
        let start = v.start.expect("a start");
        assert!(v.min.is_none_or(|min| min <= start), "{}", v.name);
        assert!(v.max.is_none_or(|max| max >= start), "{}", v.name);
    }
    assert_eq!(get(&table, "initial.joint.lift.velocity").min, Some(-7.0));
}

#[test]
fn pd_joints_have_four_inputs_and_two_gains_effort_joints_one_input() {
    let table = table_of(
        &cart(),
        "[[actuator]]\njoint = \"lift\"\nmode = \"pd\"\nkp = 3\n\
         [[actuator]]\njoint = \"left wheel\"\nmode = \"effort\"",
    );
    assert_eq!(
        names(&table, |s| matches!(s, Slot::Input(_))),
        [
            "cmd.left_wheel.effort",
            "cmd.lift.position",
            "cmd.lift.velocity",
            "cmd.lift.effort",
            "cmd.lift.max_effort"
        ]
    );
    let kp = get(&table, "cmd.lift.kp");
    assert_eq!((kp.start, kp.unit), (Some(3.0), Unit::NewtonPerMeter));
    assert!(matches!(kp.slot, Slot::Parameter(slot) if slot.tunable()));
    assert_eq!(get(&table, "cmd.lift.kd").unit, Unit::NewtonSecondPerMeter);
}

#[test]
fn kinds_are_real_except_for_flags_and_counters() {
    let table = table_of(&cart(), "outputs.links = [\"*\"]");
    for v in &table {
        let expected = match v.slot {
            Slot::Output(OutputSlot::ContactActive(_)) => Kind::Boolean,
            Slot::Output(OutputSlot::Steps | OutputSlot::Rejected | OutputSlot::NewtonMax) => {
                Kind::Integer
            }
            _ => Kind::Real,
        };
        assert_eq!(v.kind, expected, "{}", v.name);
    }
}

#[test]
fn a_fixed_base_can_be_mounted_but_not_moved() {
    let table = table_of(&cart(), "robot.base = \"fixed\"");
    assert!(table.iter().all(|v| !v.name.starts_with("base.")));
    assert!(find(&table, "initial.base.rpy.yaw").is_some());
    assert!(find(&table, "initial.base.linear_velocity.x").is_none());
}

#[test]
fn planar_and_floating_joints_have_outputs_by_axis() {
    let description = robot(frame("world"))
        .with("world", "p", Planar, at(0.0, 0.0, 0.0), mass("puck", 1.0))
        .with(
            "world",
            "f",
            Floating,
            at(0.0, 0.0, 0.0),
            mass("drone", 1.0),
        );
    let table = table_of(&description, "");
    for (name, unit) in [
        ("joint.p.position.x", Unit::Meter),
        ("joint.p.position.angle", Unit::Radian),
        ("joint.p.velocity.y", Unit::MeterPerSecond),
        ("joint.p.acceleration.angle", Unit::RadianPerSecondSquared),
        ("joint.f.position.z", Unit::Meter),
        ("joint.f.orientation.w", Unit::One),
        ("joint.f.linear_velocity.x", Unit::MeterPerSecond),
        ("joint.f.angular_velocity.z", Unit::RadianPerSecond),
        ("joint.f.linear_acceleration.y", Unit::MeterPerSecondSquared),
        (
            "joint.f.angular_acceleration.x",
            Unit::RadianPerSecondSquared,
        ),
    ] {
        assert_eq!(get(&table, name).unit, unit, "{name}");
    }
    // One place of the simulation per row.
    let slot = |name| match get(&table, name).slot {
        Slot::Output(slot) => slot,
        _ => panic!("{name} is no output"),
    };
    let f = crate::model::JointId(1);
    assert_eq!(
        slot("joint.f.angular_velocity.x"),
        OutputSlot::JointVelocity(f, 3)
    );
    assert_eq!(
        slot("joint.f.orientation.w"),
        OutputSlot::JointOrientation(f, 3)
    );
    assert!(table.iter().all(|v| !matches!(v.slot, Slot::Input(_))));
}

#[test]
fn selected_links_have_poses_and_wrenches() {
    let table = table_of(
        &cart(),
        "outputs.links = [\"camera\"]\n[[external_wrench]]\nlink = \"ch*\"",
    );
    let inputs = names(&table, |s| matches!(s, Slot::Input(_)));
    assert_eq!(
        inputs[4..],
        [
            "ext.chassis.force.x",
            "ext.chassis.force.y",
            "ext.chassis.force.z",
            "ext.chassis.torque.x",
            "ext.chassis.torque.y",
            "ext.chassis.torque.z"
        ]
    );
    let camera = table.iter().filter(|v| v.name.starts_with("link.camera."));
    // 3 + 4 + 3 + 3; it has neither mass nor shape.
    assert_eq!(camera.count(), 13);
}

#[test]
fn without_a_ground_there_are_no_parameters_of_it() {
    let table = table_of(&cart(), "world.ground = { type = \"none\" }");
    assert!(
        table
            .iter()
            .all(|v| !v.name.contains("ground") && !v.name.starts_with("contact."))
    );
}

#[test]
fn flat_names_have_no_dots() {
    let table = table_of(&cart(), "fmu.naming = \"flat\"");
    assert!(table.iter().all(|v| !v.name.contains('.')));
    assert!(find(&table, "cmd_left_wheel_max_effort").is_some());
}

#[test]
fn urdf_names_become_identifiers() {
    for (name, expected) in [
        ("wheel", "wheel"),
        ("left wheel-1", "left_wheel_1"),
        ("1st", "_1st"),
        ("größe", "gr__e"),
        ("kính ế", "k_nh__"),
        ("手臂", "_624b_81c2"),
        ("\u{1f916}", "_"),
        ("a.b[1]", "a_b_1_"),
        ("", "_"),
    ] {
        assert_eq!(build::identifier(name), expected);
    }
}

#[test]
fn names_that_become_equal_are_an_error_that_names_both() {
    let description = cart().with(
        "chassis",
        "left-wheel",
        Continuous,
        at(0.0, 0.0, 0.0),
        mass("x", 1.0),
    );
    let error = table(&model(&description, "")).expect_err("left wheel and left-wheel");
    let text = error.to_string();
    assert!(
        text.contains("'left wheel'") && text.contains("'left-wheel'"),
        "{text}"
    );
    assert!(text.contains("cmd.left_wheel.velocity"), "{text}");
    // Where neither has a variable, there is no clash.
    let fixed = cart().with(
        "chassis",
        "e ye",
        Fixed,
        at(0.0, 0.0, 0.0),
        frame("cam era"),
    );
    assert!(table(&model(&fixed, "")).is_ok());
}

#[test]
fn flat_names_can_clash_where_structured_ones_do_not() {
    let description = robot(frame("world"))
        .with(
            "world",
            "f",
            Floating,
            at(0.0, 0.0, 0.0),
            mass("drone", 1.0),
        )
        .with(
            "world",
            "f_angular",
            Planar,
            at(0.0, 0.0, 0.0),
            mass("puck", 1.0),
        )
        .with(
            "world",
            "hinge",
            Revolute,
            at(0.0, 0.0, 0.0),
            mass("door", 1.0),
        );
    assert!(table(&model(&description, "")).is_ok());
    let error = table(&model(&description, "fmu.naming = \"flat\"")).expect_err("one name twice");
    assert!(
        error.to_string().contains("'joint_f_angular_velocity_x'"),
        "{error}"
    );
}

#[test]
fn bounds_of_a_leader_are_narrowed_by_its_mimics() {
    let description = cart();
    let mut narrow = description.clone();
    narrow.joints[2].limits = Some(Limits {
        lower: -0.5,
        upper: 0.25,
    });
    let position = |description: &Description| {
        let table = table_of(description, "");
        let v = get(&table, "cmd.lift.position");
        (v.min, v.max)
    };
    assert_eq!(position(&description), (Some(-1.0), Some(2.0)));
    assert_eq!(position(&narrow), (Some(-0.5), Some(0.25)));
}

#[test]
fn a_spherical_joint_shows_orientation_and_rates() {
    let neck = robot(frame("world")).with("world", "neck", Spherical, at(0.0, 0.0, 1.0), {
        let mut head = mass("head", 1.0);
        if let Some(inertia) = &mut head.inertial {
            inertia.com.z = 0.1;
        }
        head
    });
    let table = table_of(&neck, "");
    let all = names(&table, |slot| matches!(slot, Slot::Output(_)));
    let joint: Vec<&&str> = all.iter().filter(|n| n.starts_with("joint.neck")).collect();
    assert_eq!(joint.len(), 4 + 3 + 3, "{joint:?}");
    assert!(all.contains(&"joint.neck.orientation.w"));
    assert!(all.contains(&"joint.neck.angular_acceleration.z"));
}

const WHEELS: &str = "[[group]]\nname = \"drive\"\njoints = [\"*_wheel\"]\n";

/// Four wheels, one of them weaker and slower.
fn rover() -> Description {
    let mut rover = robot(body("chassis", 5.0));
    for (i, name) in ["fl", "fr", "rl", "rr"].iter().enumerate() {
        let rim = body(&format!("{name}_rim"), 1.0);
        let joint = format!("{name}_wheel");
        rover = rover
            .with("chassis", &joint, Continuous, at(0.0, 0.2, 0.0), rim)
            .and(|j| {
                if i == 2 {
                    j.effort = Some(7.0);
                    j.velocity = Some(3.0);
                }
            });
    }
    rover
}

#[test]
fn a_group_has_the_inputs_of_its_joints_once() {
    let table = table_of(&rover(), WHEELS);
    let inputs = names(&table, |slot| matches!(slot, Slot::Input(_)));
    assert_eq!(inputs, ["cmd.drive.velocity", "cmd.drive.max_effort"]);
    // What every wheel can do.
    let velocity = get(&table, "cmd.drive.velocity");
    assert_eq!((velocity.min, velocity.max), (Some(-3.0), Some(3.0)));
    assert_eq!(get(&table, "cmd.drive.max_effort").start, Some(7.0));
    assert!(velocity.description.contains("group 'drive'"));
    // Gains are shared, too, and joints outside of the group keep their own.
    let settings = "[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 1\nkd = 2\n\
                    [[group]]\nname = \"left\"\njoints = [\"fl_wheel\", \"rl_wheel\"]\n";
    let table = table_of(&rover(), settings);
    let gains: Vec<&str> = names(&table, |slot| matches!(slot, Slot::Parameter(_)))
        .into_iter()
        .filter(|name| name.contains(".kp"))
        .collect();
    assert_eq!(gains, ["cmd.left.kp", "cmd.fr_wheel.kp", "cmd.rr_wheel.kp"]);
}

#[test]
fn sensors_have_outputs_in_their_own_names() {
    let settings = "[[sensor]]\ntype = \"imu\"\nlink = \"chassis\"\n\
                    [[sensor]]\ntype = \"ft\"\njoint = \"eye\"\nname = \"neck 1\"\n\
                    [[sensor]]\ntype = \"ray\"\nname = \"scan\"\nlink = \"camera\"\nrays = 3\nfov = 1\n";
    let sensor_names = |settings: &str| -> Vec<String> {
        let table = table_of(&cart(), settings);
        names(&table, |slot| matches!(slot, Slot::Output(_)))
            .into_iter()
            .filter(|name| name.starts_with("sensor"))
            .map(str::to_owned)
            .collect()
    };
    let all = sensor_names(settings);
    assert_eq!(all.len(), 4 + 3 + 3 + 6 + 3);
    for name in [
        "sensor.chassis.orientation.w",
        "sensor.chassis.angular_velocity.x",
        "sensor.chassis.linear_acceleration.z",
        "sensor.neck_1.force.y",
        "sensor.neck_1.torque.z",
        "sensor.scan.ray[1]",
        "sensor.scan.ray[3]",
    ] {
        assert!(all.iter().any(|n| n == name), "{name} {all:?}");
    }
    let flat = sensor_names(&format!("fmu.naming = \"flat\"\n{settings}"));
    assert!(flat.iter().any(|n| n == "sensor_scan_ray_2"), "{flat:?}");
}
