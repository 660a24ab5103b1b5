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
