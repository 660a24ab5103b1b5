//! `init`: settings to start from.

use super::*;

/// What `init` writes says what holds: exporting with it changes nothing, nor with all its lines
/// made active.
#[test]
fn init_writes_settings_that_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("init.toml");
    for name in EXAMPLES {
        for options in [
            &[][..],
            &["--fixed-base"],
            &["--floating-base", "--naming", "flat", "--mode", "pd"],
        ] {
            let urdf = example(&format!("{name}.urdf"));
            let mut args = vec!["init", text(&urdf)];
            args.extend(options);
            let run = run_in(Path::new("."), &args, &[]);
            assert_eq!(run.code, 0, "{run:?}");
            let active: String = run
                .out
                .lines()
                .map(|line| match line.strip_prefix('#') {
                    Some(rest) if !rest.starts_with(' ') => format!("{rest}\n"),
                    _ => format!("{line}\n"),
                })
                .collect();
            assert_ne!(active, run.out);
            let (_kept, plain) = export(&urdf, options);
            for settings in [&run.out, &active] {
                fs::write(&path, settings).unwrap();
                let (_folder, fmu) = export(&urdf, &["-c", text(&path)]);
                let (plain, with) = (entries(&plain).1, entries(&fmu).1);
                for file in ["modelDescription.xml", "resources/model.json"] {
                    assert_eq!(
                        String::from_utf8_lossy(&plain[file]),
                        String::from_utf8_lossy(&with[file]),
                        "{name} {options:?} {file}"
                    );
                }
            }
        }
    }
    let run = urdf2fmu(["init", text(&example("arm.urdf")), "-c", text(&path)]);
    assert_eq!(run.code, 2, "{run:?}");
}

/// SSP 2.0 has arrays, and names of elements would set nothing of such an FMU.
#[test]
fn parameters_that_are_arrays_of_fmi_3_are_arrays_of_ssp_2() {
    let urdf = example("rover.urdf");
    let arrays = urdf2fmu(["init", text(&urdf), "--ssv", "--fmi", "3"]);
    assert_eq!(arrays.code, 0, "{}", arrays.err);
    for words in [
        "version=\"2.0\"",
        "<ssv:Parameter name=\"initial.base.position\">",
        "<ssc:Dimension size=\"3\"/>",
    ] {
        assert!(arrays.out.contains(words), "{words} not in\n{}", arrays.out);
    }
    assert!(!arrays.out.contains("initial.base.position.x"));
    let fmi = ["--fmi", "3", "--arrays", "none"];
    let scalars = urdf2fmu(["init", text(&urdf), "--ssv", fmi[0], fmi[1], fmi[2], fmi[3]]);
    assert_eq!(scalars.code, 0, "{}", scalars.err);
    assert!(scalars.out.contains("name=\"initial.base.position.x\""));
    assert!(scalars.out.contains("version=\"1.0\"") && !scalars.out.contains("Dimension"));
}

#[test]
fn the_parameters_are_written_for_tools_of_ssp_with_values_and_units() {
    let urdf = example("rover.urdf");
    let run = urdf2fmu(["init", text(&urdf), "--ssv", "--scale", "2"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let listing = urdf2fmu(["info", text(&urdf), "--scale", "2", "--json", "--variables"]);
    let info: Value = serde_json::from_str(&listing.out).unwrap();
    let variables = info["variables"].as_array().unwrap().iter();
    let parameters: Vec<&Value> = variables
        .filter(|v| v["causality"] == "parameter")
        .collect();
    assert!(parameters.len() > 40);

    // An independent reader of attributes: each tag with its name and what stands in it.
    let attribute = |tag: &str, name: &str| -> Option<String> {
        let (_, rest) = tag.split_once(&format!(" {name}=\""))?;
        Some(rest.split('"').next()?.to_owned())
    };
    let tags: Vec<&str> = run.out.split('<').collect();
    let written: Vec<(String, String, Option<String>)> = tags
        .windows(2)
        .filter(|pair| pair[0].starts_with("ssv:Parameter "))
        .map(|pair| {
            let name = attribute(pair[0], "name").unwrap();
            let value = attribute(pair[1], "value").unwrap();
            (name, value, attribute(pair[1], "unit"))
        })
        .collect();
    let units: Vec<String> = tags
        .iter()
        .filter(|tag| tag.starts_with("ssc:Unit "))
        .map(|tag| attribute(tag, "name").unwrap())
        .collect();
    assert_eq!(written.len(), parameters.len());
    for ((name, value, unit), expected) in written.iter().zip(parameters) {
        assert_eq!(name, expected["name"].as_str().unwrap());
        let start = expected["start"].as_f64();
        let start = start.or(expected["start"].as_bool().map(f64::from));
        let value = value.parse().ok().or(Some(f64::from(value == "true")));
        assert_eq!(value, start, "{name}");
        if let Some(unit) = unit {
            assert_eq!(unit, expected["unit"].as_str().unwrap(), "{name}");
            assert!(units.contains(unit), "{unit} is defined");
        }
    }
}

/// As MoveIt's setup assistant writes it for an arm on a table.
#[test]
fn an_srdf_that_bolts_a_robot_down_stands_out_and_init_proposes_its_base() {
    let folder = tempfile::tempdir().unwrap();
    let body = "<inertial><mass value='1'/>\
                <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    // One joint, and no name that says so.
    let robot = people::write(
        folder.path(),
        "r.urdf",
        format!(
            "<robot name='r'><link name='a'>{body}</link><link name='b'>{body}</link>\
             <joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint></robot>"
        ),
    );
    let srdf = |kind: &str| {
        let text = format!(
            "<robot name='r'>\n<virtual_joint name='v' type='{kind}' parent_frame='table' \
             child_link='a'/>\n</robot>"
        );
        people::write(folder.path(), &format!("{kind}.srdf"), text)
    };
    let [fixed, floating] = ["fixed", "floating"].map(srdf);
    let warnings = |options: &[&str]| {
        let (ok, list) = people::findings(&robot, options);
        assert!(ok, "{list:?}");
        list.into_iter()
            .filter(|f| f["severity"] == "warning" && f["code"] == "A107")
            .collect::<Vec<_>>()
    };
    let told = warnings(&["--srdf", text(&fixed)]);
    assert_eq!(told.len(), 1, "{told:?}");
    assert_eq!(told[0]["line"], 2);
    assert!(
        told[0]["file"].as_str().unwrap().ends_with("fixed.srdf"),
        "{told:?}"
    );
    assert!(told[0]["help"].as_str().unwrap().contains("--fixed-base"));
    for options in [
        &["--srdf", text(&fixed), "--fixed-base"][..],
        &["--srdf", text(&fixed), "--floating-base"],
        &["--srdf", text(&floating)],
        &[],
    ] {
        assert_eq!(warnings(options), [0; 0].map(Value::from), "{options:?}");
    }
    let proposed = "# base = \"fixed\" mounts it";
    let done = urdf2fmu(["init", text(&robot), "--srdf", text(&fixed)]);
    assert!(done.code == 0 && done.out.contains(proposed), "{done:?}");
    let done = urdf2fmu(["init", text(&robot), "--srdf", text(&floating)]);
    assert!(done.code == 0 && !done.out.contains(proposed), "{done:?}");
}

#[test]
fn settings_do_not_take_the_place_of_a_file_of_another_kind() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = example("arm.urdf");
    for (name, more, ending) in [
        ("rover.urdf", None, "settings, and"),
        ("run.csv", None, "settings, and"),
        ("rover.urdf", Some("--ssv"), "start values, and"),
    ] {
        let own = folder.path().join(name);
        fs::write(&own, "kept").unwrap();
        let mut args = vec!["init", text(&urdf), "-o", text(&own)];
        args.extend(more);
        let run = run(&args);
        assert_eq!(run.code, 2, "{run:?}");
        assert!(run.err.contains(ending), "{}", run.err);
        assert_eq!(fs::read_to_string(&own).unwrap(), "kept");
    }
}

/// A robot of two links with a mesh of a package, written in xacro with one argument, and its SRDF.
fn robot_of_a_package(folder: &Path) {
    let inertial = "<inertial><mass value='1'/>\
                    <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    let solid =
        "<collision><geometry><mesh filename='package://parts/part.stl'/></geometry></collision>";
    let ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
    let body = |name: &str, third: &str| {
        format!(
            "<link name='a'>{inertial}{solid}</link><link name='b'>{inertial}{solid}</link>\
             <link name='c'>{third}{ball}</link>\
             <joint name='{name}' type='revolute'><parent link='a'/><child link='b'/>\
             <axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='2' velocity='3'/></joint>\
             <joint name='free' type='continuous'><parent link='a'/><child link='c'/>\
             <axis xyz='0 0 1'/></joint>"
        )
    };
    let head = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>";
    for (name, third) in [("r.urdf", inertial), ("light.urdf", "")] {
        let text = format!("<robot name='r'>{}</robot>", body("j", third));
        people::write(folder, name, text);
    }
    let argument = "<xacro:arg name='joint' default='j'/>";
    let text = format!("{head}{argument}{}</robot>", body("$(arg joint)", inertial));
    people::write(folder, "r.urdf.xacro", text);
    let state =
        "<group_state name='bent over' group='g'><joint name='j' value='0.5'/></group_state>";
    let srdf = format!(
        "<robot name='r'><group name='g'><joint name='j'/></group>{state}\
         <passive_joint name='free'/><disable_collisions link1='a' link2='c'/></robot>"
    );
    people::write(folder, "r.srdf", srdf);
    people::write(folder, "my parts/part.stl", people::tetrahedron());
    let cube = "<robot name='cube'><link name='cube'><inertial><mass value='1'/>\
                <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>\
                <collision><geometry><box size='1 1 1'/></geometry></collision></link></robot>";
    people::write(folder, "crate.urdf", cube);
    let plane = "<robot name='plane'><link name='p'><collision><origin xyz='0 0 -5'/><geometry>\
                 <box size='30 30 10'/></geometry></collision></link></robot>";
    people::write(folder, "ground.urdf", plane);
}

/// Words of a command line with single quotes and backslashes, as a shell takes them.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let (mut quoted, mut escaped) = (false, false);
    for sign in line.chars() {
        match sign {
            '\'' if !escaped => quoted = !quoted,
            '\\' if !quoted => escaped = true,
            ' ' if !quoted => words.push(String::new()),
            _ => {
                escaped = false;
                words.last_mut().unwrap().push(sign);
            }
        }
    }
    words
}

/// Each option of `export` is in the settings that `init` writes with it, or in the command line in
/// their first line, which makes the same FMU but for the settings in it.
#[test]
fn the_first_line_of_settings_exports_what_the_options_do() {
    let parts = ["--package", "parts=my parts"];
    let workspace = tempfile::tempdir().unwrap();
    let folder = workspace.path().join("r_description");
    fs::create_dir(&folder).unwrap();
    robot_of_a_package(&folder);
    // The same part as a package of a workspace.
    let shared = workspace.path().join("other/parts");
    fs::create_dir_all(&shared).unwrap();
    fs::copy(folder.join("my parts/part.stl"), shared.join("part.stl")).unwrap();
    let (urdf, xacro) = ("r.urdf", "r.urdf.xacro");
    let platform = std::env::consts::ARCH;
    let platform = format!("{platform}-{}", std::env::consts::OS);
    for (file, options) in [
        (urdf, &[][..]),
        (urdf, &["--fixed-base"]),
        (urdf, &["--floating-base"]),
        (urdf, &["--mode", "velocity"]),
        (urdf, &["--mode", "position"]),
        (urdf, &["--mode", "effort"]),
        (urdf, &["--mode", "pd"]),
        (urdf, &["--compat", "pybullet"]),
        (urdf, &["--inertia", "collision"]),
        (urdf, &["--inertia", "pybullet"]),
        (urdf, &["--inertia", "nearest"]),
        (urdf, &["--sensors", "urdf"]),
        ("light.urdf", &["--density", "500"]),
        ("light.urdf", &["--missing-mass", "0.25"]),
        (urdf, &["--scale", "0.5"]),
        (urdf, &["--naming", "flat"]),
        (urdf, &["--fmi", "3"]),
        (
            urdf,
            &["--fmi", "3", "--interface", "both", "--arrays", "all"],
        ),
        (urdf, &["--fmi", "3", "--arrays", "none"]),
        (urdf, &["--interface", "me"]),
        (urdf, &["--srdf", "r.srdf"]),
        (urdf, &["--srdf", "r.srdf", "--initial-state", "bent over"]),
        (xacro, &["joint:=elbow"]),
        (xacro, &["joint:=it's"]),
        (
            urdf,
            &[
                "--object",
                "crate.urdf@2,0",
                "--object",
                "crate.urdf@4,0,3,0,0,1",
            ],
        ),
        (
            urdf,
            &["--object", "ground.urdf", "--object", "crate.urdf@2,0"],
        ),
        (urdf, &["--no-documentation"]),
        (urdf, &["--reference-run"]),
        (urdf, &["--platform", &platform]),
    ] {
        let options = [options, &parts].concat();
        the_same(&folder, file, &options);
    }
    the_same(&folder, urdf, &["--package-path", "../other"]);
}

fn the_same(folder: &Path, file: &str, options: &[&str]) {
    let settings = folder.join("init.toml");
    let contents = |run: Run, fmu: &str| {
        assert_eq!(run.code, 0, "{options:?} {run:?}");
        let mut contents = entries(&folder.join(fmu)).1;
        contents.retain(|name, _| !name.starts_with("resources/source/"));
        contents
    };
    let quick = ["--no-documentation"];
    let quick = if options.contains(&quick[0]) {
        &[][..]
    } else {
        &quick
    };
    let args = [&["export", file, "-o", "a.fmu"][..], options, quick].concat();
    let by_options = contents(run_in(folder, &args, &[]), "a.fmu");
    let run = run_in(folder, &[&["init", file][..], options].concat(), &[]);
    assert_eq!(run.code, 0, "{options:?} {run:?}");
    fs::write(&settings, &run.out).unwrap();
    let first = run.out.lines().next().unwrap();
    let (_, command) = first.split_once("for: urdf2fmu ").unwrap();
    let command = command.replace("THIS_FILE", "init.toml");
    let words = words(&command);
    let mut args: Vec<&str> = words.iter().map(String::as_str).collect();
    args.extend(["-o", "b.fmu"]);
    args.extend(quick);
    let by_settings = contents(run_in(folder, &args, &[]), "b.fmu");
    assert!(by_options.keys().eq(by_settings.keys()), "{options:?}");
    for (name, bytes) in &by_options {
        // What was assumed is told with its place in the settings.
        if name != "resources/scene.bin" {
            assert!(
                *bytes == by_settings[name],
                "{options:?} {name}\n{}",
                run.out
            );
        }
    }
}
