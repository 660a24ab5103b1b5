use super::keys::KEYS;
use super::*;
use crate::model::ActuatorMode;
use crate::range::Range;
use crate::spatial::Vec3;

mod advice;
mod pairs;
mod sensors;
mod terrain;
mod world;

fn parse(text: &str) -> Settings {
    Settings::parse(text, "robot.toml").unwrap_or_else(|findings| panic!("{findings:?}"))
}

/// The one finding of a text.
fn finding(text: &str) -> Diagnostic {
    let mut findings = Settings::parse(text, "robot.toml").expect_err(text);
    assert_eq!(findings.len(), 1, "{text}: {findings:?}");
    findings.remove(0)
}

fn place(finding: &Diagnostic) -> (usize, usize, usize) {
    let place = finding.place.as_ref().expect("a place");
    assert_eq!(place.file, "robot.toml");
    (place.line, place.column, place.length)
}

#[test]
fn an_empty_file_means_the_documented_defaults() {
    // The values of the interface's example file.
    let settings = parse("");
    assert_eq!(settings, Settings::default());
    assert_eq!(settings.base, BaseChoice::Auto);
    assert_eq!(settings.scale.to_bits(), 1.0_f64.to_bits());
    assert_eq!(settings.inertia, InertiaSource::Urdf);
    assert!(!settings.flat_names);
    assert_eq!(settings.solver.step_size.to_bits(), 0);
    assert_eq!(settings.solver.tolerance.to_bits(), 0);
    assert_eq!(settings.contact.penetration.to_bits(), 1e-4_f64.to_bits());
    assert_eq!(settings.contact.stiffness, None);
    assert_eq!(settings.contact.dissipation.to_bits(), 51.0_f64.to_bits());
    assert_eq!(settings.world.gravity, Vec3::new(0.0, 0.0, -9.81));
    let ground = settings.world.ground.expect("a plane");
    assert_eq!((ground.friction, ground.restitution), (0.8, 0.0));
    assert_eq!(settings.contact_outputs, ContactOutputs::Auto);
    assert_eq!(settings.initial.z, None);
}

#[test]
fn every_default_is_legal_for_its_own_key() {
    for key in KEYS {
        let Some(default) = key.default else { continue };
        assert!(
            !key.path.contains(['*', '[']),
            "{}: defaults of named tables are not read",
            key.path
        );
        let text = format!("{} = {default}", key.path);
        let mut settings = parse(&text);
        // Where it stands is the one thing that differs.
        settings.initial.velocity_place = None;
        assert_eq!(settings, Settings::default(), "{text}");
    }
}

#[test]
fn the_interface_s_example_is_read_as_it_stands() {
    let settings = parse(
        r#"
        [robot]
        base = "floating"
        scale = 2
        inertia = "collision"
        self_collision = false
        compat = "none"
        [fmu]
        naming = "flat"
        [solver]
        step_size = "1/240"
        tolerance = 1e-4
        [contact]
        stiffness = 3e4
        dissipation = 10
        [world]
        gravity = [0, 0, -1.62]
        ground = { type = "plane", friction = 0.5, restitution = 0.25 }
        [initial]
        xyz = [1, 2, 0.5]
        rpy = [0, 0.1, 0]
        joints = { head_swivel = 0.2, "*_wheel" = 1 }
        linear_velocity = [1, 0, 0]
        angular_velocity = [0, 0, 2]
        joint_velocities = { head_swivel = -3 }
        [[actuator]]
        joint = "*_wheel_joint"
        mode = "velocity"
        max_effort = 20
        [[actuator]]
        joint = "arm"
        mode = "pd"
        kp = 100
        kd = 5.5
        [joint."left_*"]
        damping = 0.1
        friction = 0.2
        armature = 0.3
        limits = { lower = -1, upper = 2 }
        effort = 7
        velocity = 8
        [outputs]
        contacts = ["*_wheel"]
        links = ["head"]
        [[external_wrench]]
        link = "base_link"
        [link."*_wheel"]
        friction = 0.9
        restitution = 0.1
        mass = 3
        "#,
    );
    assert_eq!(settings.base, BaseChoice::Floating);
    assert_eq!(settings.inertia, InertiaSource::Collision);
    assert!(settings.flat_names);
    assert_eq!(
        settings.solver.step_size.to_bits(),
        (1.0_f64 / 240.0).to_bits()
    );
    assert_eq!(settings.contact.stiffness, Some(3e4));
    assert_eq!(
        settings.initial.xy.map(f64::to_bits),
        [1.0, 2.0].map(f64::to_bits)
    );
    assert_eq!(settings.initial.z, Some(0.5));
    assert_eq!(settings.initial.angular_velocity, Vec3::new(0.0, 0.0, 2.0));
    assert_eq!(settings.initial.joints.len(), 2);
    assert_eq!(settings.initial.joints[1].0.text, "*_wheel");
    assert_eq!(settings.actuators.len(), 2);
    let pd = &settings.actuators[1];
    assert_eq!(pd.mode, Some(ModeChoice::Commanded(ActuatorMode::Pd)));
    assert_eq!(
        (pd.kp, pd.kd, pd.max_effort),
        (Some(100.0), Some(5.5), None)
    );
    let joint = &settings.joints[0];
    assert_eq!(joint.joint.text, "left_*");
    assert_eq!((joint.lower, joint.upper), (Some(-1.0), Some(2.0)));
    assert_eq!((joint.effort, joint.velocity), (Some(7.0), Some(8.0)));
    assert_eq!(settings.links[0].mass, Some(3.0));
    assert_eq!(settings.link_outputs[0].text, "head");
    assert_eq!(settings.external_wrenches[0].text, "base_link");
}

#[test]
fn two_numbers_for_xyz_leave_the_height_open() {
    let settings = parse("initial.xyz = [3, -4]");
    assert_eq!(
        settings.initial.xy.map(f64::to_bits),
        [3.0, -4.0].map(f64::to_bits)
    );
    assert_eq!(settings.initial.z, None);
}

#[test]
fn tables_of_named_entries_keep_the_order_of_the_file() {
    // Later entries win, so the order matters; TOML's own maps are sorted.
    let settings =
        parse("[joint.zz]\ndamping = 1\n[joint.\"*\"]\ndamping = 2\n[joint.a]\nfriction = 3");
    let names: Vec<_> = settings
        .joints
        .iter()
        .map(|j| j.joint.text.as_str())
        .collect();
    assert_eq!(names, ["zz", "*", "a"]);
}

#[test]
fn an_unknown_key_names_the_nearest_and_its_place() {
    let found = finding("[solver]\ntolerence = 1e-3\n");
    assert_eq!(found.code, "S102");
    assert_eq!(place(&found), (2, 1, 9));
    assert!(
        found
            .help
            .as_deref()
            .is_some_and(|h| h.contains("'tolerance'")),
        "{found:?}"
    );

    let found = finding("[robto]\nbase = \"fixed\"");
    assert!(
        found.help.as_deref().is_some_and(|h| h.contains("'robot'")),
        "{found:?}"
    );

    let found = finding("[joint.\"*\"]\nlimit = { lower = 1 }");
    assert!(
        found
            .help
            .as_deref()
            .is_some_and(|h| h.contains("'limits'")),
        "{found:?}"
    );
}

#[test]
fn a_key_in_the_wrong_table_names_the_right_one() {
    let found = finding("[world]\ntolerance = 1e-3");
    assert!(
        found
            .help
            .as_deref()
            .is_some_and(|h| h.contains("[solver]")),
        "{found:?}"
    );
    let found = finding("step_size = 1e-3");
    assert!(
        found
            .help
            .as_deref()
            .is_some_and(|h| h.contains("[solver]")),
        "{found:?}"
    );
}

#[test]
fn a_robot_in_place_of_settings_is_one_finding() {
    for text in [
        "<robot name='r'>\n  <link name='a'/>\n</robot>\n",
        "\u{feff}\n  <?xml version='1.0'?>\n<!-- = -->\n<robot name='r'/>\n",
    ] {
        let found = finding(text);
        assert_eq!(found.code, "S101");
        assert!(found.message.contains("XML"), "{found:?}");
        let help = found.help.as_deref().unwrap_or_default();
        assert!(
            help.contains("-c") && help.lines().count() == 1,
            "{found:?}"
        );
    }
    let text = "[solver]\ntolerance = = 1\n[robot]\nscale = = 2\n";
    let found = Settings::parse(text, "robot.toml").expect_err("syntax");
    assert!(found.len() > 1, "{found:?}");
}

#[test]
fn syntax_errors_have_a_place() {
    let found = Settings::parse("[solver]\ntolerance = = 1\n", "robot.toml").expect_err("syntax");
    assert!(found.iter().all(|d| d.code == "S101"), "{found:?}");
    assert_eq!(found[0].place.as_ref().map(|p| p.line), Some(2));
    // A key given twice is one, too.
    let found =
        Settings::parse("[robot]\nscale = 1\nscale = 2\n", "robot.toml").expect_err("twice");
    assert_eq!(
        (found[0].code, found[0].place.as_ref().map(|p| p.line)),
        ("S101", Some(3))
    );
}

#[test]
fn wrong_types_say_what_is_expected() {
    for (text, expected) in [
        ("robot.scale = \"2\"", "a number"),
        ("robot.self_collision = 1", "true or false"),
        ("robot.base = 3", "\"auto\" or \"floating\" or \"fixed\""),
        ("world.gravity = -9.81", "a list of 3 numbers"),
        ("world.gravity = [0, -9.81]", "3 numbers, not 2"),
        ("initial.joints = [0]", "a table"),
        (
            "actuator = { joint = \"a\" }",
            "an array of tables, [[actuator]]",
        ),
        ("outputs.links = \"head\"", "a list of names or globs"),
        ("outputs.contacts = 1", "\"auto\" or \"none\" or a list"),
        ("[[external_wrench]]\nlink = [\"a\"]", "a name or glob"),
        ("solver = 1", "a table"),
    ] {
        let found = finding(text);
        assert_eq!(found.code, "S103", "{text}");
        assert!(
            found.message.contains(expected),
            "{text}: {}",
            found.message
        );
    }
}

#[test]
fn numbers_outside_their_range_are_refused() {
    for text in [
        "world.ground.friction = -0.1",
        "world.ground.restitution = 1.5",
        "solver.tolerance = 0",
        "solver.step_size = -1",
        "solver.step_size = 1e-8",
        "solver.step_size = \"1/0\"",
        "solver.step_size = \"fast\"",
        "robot.scale = 0",
        "robot.scale = nan",
        "world.gravity = [0, 0, nan]",
        "initial.xyz = [0, inf, 0]",
        "robot.base = \"flying\"",
        "outputs.contacts = \"all\"",
        "[joint.a]\ndamping = -1",
        "[link.a]\nmass = 0",
        "[[actuator]]\njoint = \"a\"\nmax_effort = -1",
        "robot.scale = 99999999999999999999999",
        "contact.penetration = 1e-300",
        "world.ground.restitution = 1e-18",
        "world.gravity = [0, 0, -1e12]",
        "[link.a]\nmass = 1e100",
        "[initial.joint_velocities]\na = 1e160",
        "solver.max_steps = 0",
    ] {
        assert_eq!(finding(text).code, "S104", "{text}");
    }
}

#[test]
fn groups_and_sensors_refuse_missing_and_unsuitable_keys() {
    for (text, code, part) in [
        ("[[group]]\nname = \"a\"", "S107", "joints"),
        ("[[group]]\nname = \"a\"\njoints = []", "S107", "joints"),
        ("[[group]]\njoints = [\"a\"]", "S107", "name"),
        ("[[group]]\nname = \"\"\njoints = [\"a\"]", "S104", "empty"),
        ("[[group]]\nname = 1\njoints = [\"a\"]", "S103", "name"),
        ("[[group]]\nname = \"a\"\njoints = \"b\"", "S103", "joints"),
        ("[[sensor]]\nlink = \"a\"", "S107", "type"),
        ("[[sensor]]\ntype = \"gps\"\nlink = \"a\"", "S104", "gps"),
        ("[[sensor]]\ntype = \"imu\"", "S107", "link"),
        ("[[sensor]]\ntype = \"ft\"", "S107", "joint"),
        (
            "[[sensor]]\ntype = \"imu\"\nlink = \"a\"\nrays = 2",
            "S106",
            "rays",
        ),
        (
            "[[sensor]]\ntype = \"ft\"\njoint = \"a\"\nxyz = [0, 0, 1]",
            "S106",
            "xyz",
        ),
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"a\"\nframe = \"child\"",
            "S106",
            "frame",
        ),
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"a\"\nfov = 1",
            "S106",
            "fov",
        ),
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"a\"\nrays = 2.5",
            "S104",
            "rays",
        ),
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"a\"\nrays = 10001",
            "S104",
            "rays",
        ),
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"a\"\nrange = 0",
            "S104",
            "range",
        ),
    ] {
        let found = finding(text);
        assert_eq!(found.code, code, "{text}: {}", found.message);
        assert!(found.message.contains(part), "{text}: {}", found.message);
    }
}

#[test]
fn contradictions_and_missing_keys_are_errors() {
    for (text, code) in [
        ("contact = { penetration = 1e-3, stiffness = 1e4 }", "S106"),
        ("[joint.a]\nlimits = { lower = 1, upper = -1 }", "S106"),
        (
            "[[actuator]]\njoint = \"a\"\nmode = \"effort\"\nmax_effort = 1",
            "S106",
        ),
        (
            "[[actuator]]\njoint = \"a\"\nmode = \"velocity\"\nkp = 1",
            "S106",
        ),
        ("[[actuator]]\nmode = \"velocity\"", "S107"),
        ("[[external_wrench]]", "S107"),
    ] {
        assert_eq!(finding(text).code, code, "{text}");
    }
}

#[test]
fn all_findings_come_at_once_in_file_order() {
    let text = "[robot]\nscale = -1\nbas = 1\n[solver]\ntolerance = \"x\"\n";
    let findings = Settings::parse(text, "robot.toml").expect_err("three");
    let codes: Vec<_> = findings.iter().map(|d| d.code).collect();
    assert_eq!(codes, ["S104", "S102", "S103"]);
}

#[test]
fn columns_count_characters_not_bytes() {
    let found = finding("\"é\" = 1");
    assert_eq!(place(&found), (1, 1, 3));
    let found = finding("initial.joints = { \"é\" = 1, b = true }");
    assert_eq!(place(&found), (1, 33, 4));
}

#[test]
fn a_file_that_cannot_be_read_says_so() {
    let findings = Settings::read(Path::new("no/such/robot.toml")).expect_err("no file");
    assert_eq!(findings[0].code, "S108");
    assert!(findings[0].message.contains("robot.toml"));
}

#[test]
fn no_key_stands_in_the_table_twice() {
    for (i, key) in KEYS.iter().enumerate() {
        assert!(
            KEYS[..i].iter().all(|other| other.path != key.path),
            "{}",
            key.path
        );
    }
}

#[test]
fn the_documentation_lists_every_key() {
    let page = include_str!("../../docs/interface.md");
    // The variables have a table of their own, with some of the same names.
    let (_, page) = page
        .split_once("\n## Settings\n")
        .expect("the page has settings");
    for key in KEYS {
        let default = key.default.unwrap_or_default();
        let row = page
            .lines()
            .find(|line| line.contains(&format!("`{}`", key.path)));
        let row = row.unwrap_or_else(|| panic!("{} is not in docs/interface.md", key.path));
        assert!(
            row.contains(default) && row.contains(key.about),
            "{}",
            key.path
        );
        let range = key.takes.range().map_or("", Range::label);
        assert!(row.contains(range), "{}: {range}", key.path);
    }
}

#[test]
fn garbage_never_panics() {
    // Every prefix and every single-byte damage of a file that uses all kinds of values.
    let text = "[solver]\nstep_size = \"1/240\"\n[[actuator]]\njoint = \"*\"\nkp = 0x1F\n[joint.\"é\"]\n\
                limits = { lower = -1e3, upper = 2 }\n[initial]\nxyz = [1, 2.5, nan]\n";
    for end in 0..text.len() {
        if let Some(prefix) = text.get(..end) {
            let _ = Settings::parse(prefix, "f");
        }
        let mut bytes = text.as_bytes().to_vec();
        for damage in [b'"', b'=', b'[', b'\n', 0, b'1'] {
            bytes[end] = damage;
            let _ = Settings::parse(&String::from_utf8_lossy(&bytes), "f");
        }
    }
}

#[test]
fn static_friction_needs_a_sliding_friction_not_above_it() {
    let ground = |text: &str| {
        let text = format!("[world.ground]\n{text}");
        Settings::parse(&text, "f").map(|s| s.world.ground.expect("a ground").static_excess)
    };
    assert_eq!(ground("friction = 0.5"), Ok(0.0));
    assert_eq!(ground("friction = 0.5\nstatic_friction = 0.75"), Ok(0.5));
    assert_eq!(ground("friction = 0\nstatic_friction = 0"), Ok(0.0));
    for wrong in [
        "friction = 0.5\nstatic_friction = 0.4",
        "friction = 0\nstatic_friction = 0.4",
    ] {
        let findings = ground(wrong).expect_err("less at rest than sliding");
        assert_eq!(findings[0].code, "S106");
        assert_eq!(findings[0].place.as_ref().map(|p| p.line), Some(3));
    }
}

#[test]
fn a_no_load_speed_is_allowed_in_every_mode_with_effort() {
    let actuator = |mode: &str| {
        let text = format!(
            "[[actuator]]\njoint = \"*\"\nmode = \"{mode}\"\nno_load_speed = 5\nmax_effort = 2\n"
        );
        Settings::parse(&text, "f").map(|s| s.actuators[0].no_load_speed)
    };
    for mode in ["velocity", "position", "effort", "pd"] {
        assert_eq!(actuator(mode), Ok(Some(5.0)), "{mode}");
    }
    assert_eq!(actuator("none").expect_err("no motor")[0].code, "S106");
}
