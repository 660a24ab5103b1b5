//! Numbers and sizes that nobody means are told where they are given.

use super::*;

/// Runs the command on the rover with these settings.
fn with_settings(command: &str, settings: &str) -> Run {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("r.toml"), settings).unwrap();
    let rover = example("rover.urdf");
    run_in(folder.path(), &[command, text(&rover), "-c", "r.toml"], &[])
}

#[test]
fn a_setting_out_of_range_is_told_at_its_line() {
    for setting in [
        "world.ground.restitution = 1e-18",
        "world.gravity = [0, 0, -1e12]",
        "contact.penetration = 1e-300",
        "robot.scale = 1e300",
        "link.base_link.mass = 1e100",
        "initial.linear_velocity = [1e160, 0, 0]",
    ] {
        for command in ["check", "export", "info", "init", "simulate"] {
            if command == "init" {
                continue; // It takes no settings.
            }
            let run = with_settings(command, &format!("\n{setting}\n"));
            assert_eq!(run.code, 1, "{command} {setting}: {run:?}");
            assert!(run.err.contains("S104"), "{}", run.err);
            assert!(run.err.contains("r.toml:2:"), "{}", run.err);
            assert!(!run.err.contains("report"), "{}", run.err);
        }
    }
}

#[test]
fn a_number_of_the_robot_out_of_range_is_told_at_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let rover = fs::read_to_string(example("rover.urdf")).unwrap();
    for (from, to) in [
        ("<mass value=\"10\"/>", "<mass value=\"1e100\"/>"),
        ("<mass value=\"10\"/>", "<mass value=\"1e300\"/>"),
    ] {
        assert!(rover.contains(from));
        let line = rover[..rover.find(from).unwrap()].matches('\n').count() + 1;
        fs::write(folder.path().join("r.urdf"), rover.replacen(from, to, 1)).unwrap();
        let run = run_in(folder.path(), &["check", "r.urdf"], &[]);
        assert_eq!(run.code, 1, "{to}: {run:?}");
        assert!(run.err.contains("U032"), "{}", run.err);
        assert!(run.err.contains(&format!("r.urdf:{line}:")), "{}", run.err);
    }
}

/// 90 rad are 14 turns: what the settings refuse (S104) the command line does, too.
#[test]
fn an_attitude_in_degrees_is_refused_on_the_command_line() {
    let rover = example("rover.urdf");
    let object = format!("{}@1,0,0.5,0,0,90", text(&example("worlds/crate.urdf")));
    let start = ["--start-value", "initial.base.rpy.*", "90"];
    let cases: [(&str, &[&str]); 3] = [
        ("check", &["--object", &object]),
        ("export", &["--object", &object]),
        ("simulate", &start),
    ];
    for (command, options) in cases {
        let folder = tempfile::tempdir().unwrap();
        let arguments: Vec<&str> = [&[command, text(&rover)], options].concat();
        let run = run_in(folder.path(), &arguments, &[]);
        assert_eq!(run.code, 2, "{command}: {run:?}");
        assert!(run.err.contains("90 degrees are 1.5708"), "{}", run.err);
    }
}

#[test]
fn a_start_value_out_of_range_is_told_with_its_name() {
    let rover = example("rover.urdf");
    for (name, value) in [
        ("initial.base.linear_velocity.x", "1e160"),
        ("link.base_link.mass", "1e100"),
        ("world.gravity.z", "-1e12"),
        ("world.ground.restitution", "1e-18"),
        ("solver.max_steps", "0"),
    ] {
        let arguments = ["simulate", text(&rover), "--start-value", name, value];
        let run = run_in(Path::new("."), &arguments, &[]);
        assert_eq!(run.code, 3, "{name}: {run:?}");
        assert!(run.err.contains(name) && run.out.is_empty(), "{}", run.err);
    }
    for arguments in [
        ["--scale", "1e300"],
        ["--tolerance", "1e-300"],
        ["--tolerance", "nan"],
    ] {
        let run = urdf2fmu(["simulate", text(&rover), arguments[0], arguments[1]]);
        assert_eq!(run.code, 2, "{arguments:?}: {run:?}");
    }
}

#[test]
fn a_step_that_takes_too_much_work_ends_the_simulation_and_says_what_to_change() {
    let rover = example("rover.urdf");
    let run = urdf2fmu([
        "simulate",
        text(&rover),
        "--start-value",
        "cmd.left_front_wheel_joint.velocity",
        "5",
        "--start-value",
        "solver.max_steps",
        "2",
        "--output-interval",
        "1",
    ]);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(run.err.contains("solver.max_steps"), "{}", run.err);
    assert_eq!(
        run.out.lines().count(),
        2,
        "the names and the start: {}",
        run.out
    );
}

/// A chain of `links` links on hinges.
fn chain(links: usize) -> String {
    let link = |i: usize| {
        format!(
            "<link name=\"l{i}\"><inertial><mass value=\"0.1\"/><inertia ixx=\"1e-4\" ixy=\"0\" \
             ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" izz=\"1e-4\"/></inertial></link>\n"
        )
    };
    let joint = |i: usize| {
        format!(
            "<joint name=\"j{i}\" type=\"continuous\"><parent link=\"l{}\"/><child \
             link=\"l{i}\"/><origin xyz=\"0.1 0 0\"/><axis xyz=\"0 1 0\"/></joint>\n",
            i - 1
        )
    };
    let parts: Vec<String> = (0..links).map(link).chain((1..links).map(joint)).collect();
    format!("<robot name=\"chain\">{}</robot>", parts.concat())
}

#[test]
fn too_many_links_are_told_with_how_many_there_may_be() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("r.urdf"), chain(2_100)).unwrap();
    let run = run_in(folder.path(), &["check", "r.urdf", "--floating-base"], &[]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(
        run.err.contains("more than 2000 degrees of freedom"),
        "{}",
        run.err
    );
    assert!(!run.err.contains("report"), "{}", run.err);
}
