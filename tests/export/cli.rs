//! Common to all commands: usage, files, options beside settings.

use super::*;

#[test]
fn help_and_version_are_printed() {
    let help = urdf2fmu(["--help"]);
    assert_eq!(help.code, 0);
    for command in ["export", "info", "check"] {
        assert!(help.out.contains(command));
    }
    assert!(urdf2fmu(["--version"]).out.starts_with("urdf2fmu "));
}

#[test]
fn wrong_usage_is_exit_code_2_with_a_hint() {
    for args in [
        &[][..],
        &["exprt", "a.urdf"],
        &["export"],
        &["export", "a.urdf", "--mode", "torque"],
        &["export", "a.urdf", "--fixed-base", "--floating-base"],
        &["check", "a.urdf", "--deny", "everything"],
    ] {
        let run = run_in(Path::new("."), args, &[]);
        assert_eq!(run.code, 2, "{args:?}: {run:?}");
        assert!(
            run.err.contains("Usage") || run.err.contains("--help"),
            "{}",
            run.err
        );
    }
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.urdf");
    let run = urdf2fmu(["export", text(&missing)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.err.contains("missing.urdf"), "{}", run.err);

    let nowhere = folder.path().join("no/such/folder/a.fmu");
    let rover = example("rover.urdf");
    let run = urdf2fmu(["export", text(&rover), "-o", text(&nowhere)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.err.contains("no/such/folder"), "{}", run.err);

    let text_file = folder.path().join("text.fmu");
    fs::write(&text_file, "no zip").unwrap();
    let run = urdf2fmu(["info", text(&text_file)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.err.contains("text.fmu"), "{}", run.err);
}

#[test]
fn command_line_wins_over_the_settings_file() {
    let arm = example("arm.urdf");
    assert_eq!(info(&arm, &["--floating-base"])["base"], "floating");
    let rover = example("rover.urdf");
    let inputs = |options: &[&str]| -> Vec<String> {
        let value = info(&rover, options);
        value["variables"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|v| v["causality"] == "input")
            .map(|v| v["name"].as_str().unwrap().to_owned())
            .collect()
    };
    assert!(inputs(&["--mode", "effort"]).contains(&"cmd.head_joint.effort".to_owned()));
    assert!(inputs(&["--naming", "flat"]).contains(&"cmd_head_joint_velocity".to_owned()));
    // The settings name the wheels alone.
    let toml = example("rover.toml");
    let mixed = inputs(&["-c", text(&toml), "--mode", "effort"]);
    assert!(
        mixed.contains(&"cmd.head_joint.effort".to_owned()),
        "{mixed:?}"
    );
    assert!(
        mixed.contains(&"cmd.left_front_wheel_joint.velocity".to_owned()),
        "{mixed:?}"
    );
}

#[test]
fn inertia_and_scale_can_be_given_on_the_command_line() {
    let links = |options: &[&str]| info(&example("rover.urdf"), options)["links"].clone();
    let plain = links(&[]);
    let doubled = links(&["--scale", "2"]);
    let inertia = |links: &Value| links[0]["inertia"][0][0].as_f64().unwrap();
    // Masses stay, so inertias grow with the square of the lengths.
    assert_eq!(plain[0]["mass"], doubled[0]["mass"]);
    assert!((inertia(&doubled) / inertia(&plain) - 4.0).abs() < 1e-12);
    // The examples' inertias are those of their solids.
    let computed = links(&["--inertia", "collision"]);
    assert!((inertia(&computed) / inertia(&plain) - 1.0).abs() < 1e-3);
    let run = urdf2fmu(["info", text(&example("rover.urdf")), "--scale", "-1"]);
    assert_eq!(run.code, 2, "{run:?}");
}

#[test]
fn scale_of_the_settings_reaches_the_reader() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("s.toml");
    fs::write(&settings, "[robot]\nscale = 2\n").unwrap();
    let arm = info(&example("arm.urdf"), &["-c", text(&settings)]);
    let joints = arm["joints"].as_array().unwrap();
    let elbow = joints.iter().find(|j| j["name"] == "elbow").unwrap();
    // Lengths double (0.42 m in the file), masses stay.
    assert_eq!(
        elbow["origin_position"],
        serde_json::json!([0.0, 0.0, 0.84])
    );
    assert!((arm["mass"].as_f64().unwrap() - 24.5).abs() < 1e-12);
}

#[test]
fn a_mode_for_all_joints_is_legal_where_there_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("ball.urdf");
    let ball = r#"<robot name="ball"><link name="ball"><inertial><mass value="1"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;
    fs::write(&urdf, ball).unwrap();
    assert_eq!(
        info(&urdf, &["--mode", "velocity"])["degrees_of_freedom"],
        6
    );
}

#[test]
fn options_about_a_robot_are_refused_where_an_fmu_is_made_already() {
    let (folder, fmu) = export(&example("rover.urdf"), &[]);
    let page = folder.path().join("a.html");
    for (command, option, name) in [
        ("simulate", &["--object", "crate.urdf@1,0"][..], "--object"),
        ("simulate", &["--fixed-base"], "--fixed-base"),
        ("info", &["-c", "nowhere.toml"], "--config"),
        ("picture", &["--scale", "3"], "--scale"),
        ("view", &["--mode", "position"], "--mode"),
        ("report", &["--fixed-base"], "--fixed-base"),
    ] {
        let file = [text(&fmu)];
        let model = ["run.csv", "--model", text(&fmu), "-o", text(&page)];
        let files = if command == "report" {
            &model[..]
        } else {
            &file
        };
        let run = run_in(Path::new("."), &[&[command], files, option].concat(), &[]);
        assert_eq!(run.code, 2, "{command}: {run:?}");
        let said = format!("is an FMU already, and {name} belongs to its export");
        assert!(run.err.contains(&said), "{}", run.err);
    }
}

#[test]
fn a_word_without_an_option_is_told_how_options_are_repeated() {
    let (_folder, fmu) = export(&example("rover.urdf"), &[]);
    let names = ["base.position.x", "base.position.z"];
    let run = urdf2fmu([
        "simulate",
        text(&fmu),
        "--output-variable",
        names[0],
        names[1],
    ]);
    assert_eq!(run.code, 2, "{run:?}");
    for said in [
        names[1],
        "repeated",
        "--output-variable A --output-variable B",
    ] {
        assert!(run.err.contains(said), "{}", run.err);
    }
}

#[test]
fn files_are_not_written_under_the_name_of_another_format() {
    let rover = example("rover.urdf");
    let folder = tempfile::tempdir().unwrap();
    for (args, said) in [
        (&["simulate", "--plot", "a.png"][..], "end it with .svg"),
        (&["simulate", "--report", "a.csv"], "end it with .html"),
        (&["simulate", "--output-file", "a.xlsx"], "end it with .csv"),
        (
            &["simulate", "--output-file", "a.parquet"],
            "end it with .csv",
        ),
        (&["simulate", "--output-file", "a.npy"], "end it with .csv"),
        (&["simulate", "--output-file", "a.json"], "end it with .csv"),
        (
            &["simulate", "--output-file", "a.csv.gz"],
            "end it with .csv",
        ),
        (&["picture", "-o", "a.jpg"], "end it with .png"),
        (&["export", "-o", "a.zip"], "end it with .fmu"),
    ] {
        let args = [&[args[0], text(&rover)], &args[1..]].concat();
        let run = run_in(folder.path(), &args, &[]);
        assert_eq!(run.code, 2, "{args:?}: {run:?}");
        assert!(run.err.contains(said), "{}", run.err);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
