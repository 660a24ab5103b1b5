//! `export`: the contents of an FMU, and errors.

use super::*;

#[test]
fn descriptions_keep_the_rules_of_fmi_in_every_mode() {
    for name in EXAMPLES {
        let (urdf, toml) = (
            example(&format!("{name}.urdf")),
            example(&format!("{name}.toml")),
        );
        for options in [
            &[][..],
            &["-c", text(&toml)],
            &["--mode", "pd", "--naming", "flat"],
            &["--mode", "effort", "--fixed-base"],
            &["--mode", "velocity", "--floating-base"],
            &["--mode", "position"],
        ] {
            let (_folder, fmu) = export(&urdf, options);
            let problems = model_description::problems(&description(&fmu));
            assert!(problems.is_empty(), "{name} {options:?}: {problems:#?}");
        }
    }
}

/// Every kind of variable that settings can ask for, in one FMU.
const EVERYTHING: &str = r#"
[outputs]
contacts = ["*"]
contact_points = true
links = ["*"]
[[outputs.pair]]
name = "stand"
first = "*_wheel"
second = "ground"
[[actuator]]
joint = "left_*_wheel_joint"
mode = "pd"
kp = 5
kd = 0.5
[[actuator]]
joint = "right_*_wheel_joint"
mode = "effort"
[[group]]
name = "left"
joints = ["left_*_wheel_joint"]
[[external_wrench]]
link = "*"
[[sensor]]
type = "imu"
link = "base_link"
[[sensor]]
type = "ft"
joint = "head_joint"
[[sensor]]
type = "ray"
link = "head"
rays = 12
fov = 1
[[sensor]]
type = "ray"
name = "fan"
link = "base_link"
rays = 4
fov = 1
rows = 2
vertical_fov = 0.5
hits = true
rate = 20
distance = { noise = 0.01 }
[[sensor]]
type = "encoder"
name = "turn"
joint = "head_joint"
counts = 512
rate = 100
[[sensor]]
type = "contact"
name = "tyre"
link = "left_front_wheel"
"#;

#[test]
fn a_description_with_every_kind_of_variable_keeps_the_rules_of_fmi() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("everything.toml");
    std::fs::write(&settings, EVERYTHING).unwrap();
    for naming in ["structured", "flat"] {
        let options = ["-c", text(&settings), "--naming", naming];
        let (_folder, fmu) = export_documented(&example("rover.urdf"), &options);
        let problems = model_description::problems(&description(&fmu));
        assert!(problems.is_empty(), "{naming}: {problems:#?}");
        let page =
            String::from_utf8_lossy(&entries(&fmu).1["documentation/index.html"]).into_owned();
        assert!(
            page.contains("<tr><td>6</td><td><code>head</code></td></tr>"),
            "{page}"
        );
    }
}

#[test]
fn fmu_holds_the_files_of_the_interface_in_order() {
    let (_folder, fmu) = export_documented(
        &example("rover.urdf"),
        &["-c", text(&example("rover.toml"))],
    );
    let (names, contents) = entries(&fmu);
    assert!(names.is_sorted(), "{names:?}");
    for name in [
        "documentation/frames.png",
        "documentation/index.html",
        "documentation/robot.html",
        "documentation/licenses/license.spdx",
        "documentation/licenses/license.txt",
        "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml",
        "extra/org.fmi-standard.fmi-ls-ref/parameters.ssv",
        "model.png",
        "modelDescription.xml",
        "resources/model.json",
        "resources/scene.bin",
        "resources/source/rover.toml",
        "resources/source/rover.urdf",
        "terminalsAndIcons/icon.png",
    ] {
        assert!(contents.contains_key(name), "{name} not in {names:?}");
    }
    // The rest is the same without what is made for people; the licences of what is inside stay.
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("rover.toml");
    let given = std::fs::read_to_string(example("rover.toml")).unwrap();
    std::fs::write(&settings, given + "\n[fmu]\ndocumentation = false\n").unwrap();
    let for_people = |name: &str| {
        let picture = Path::new(name).extension().is_some_and(|end| end == "png");
        picture || (name.starts_with("documentation/") && !name.contains("licenses"))
    };
    let beside = folder.path().join("rover.urdf");
    std::fs::copy(example("rover.urdf"), &beside).unwrap();
    let (urdf, plain) = (example("rover.urdf"), example("rover.toml"));
    for (urdf, options) in [
        (beside, vec!["-c", text(&settings)]),
        (urdf, vec!["-c", text(&plain), "--no-documentation"]),
    ] {
        let (_folder, bare) = export_documented(&urdf, &options);
        let (bare, without) = entries(&bare);
        let expected: Vec<_> = names.iter().filter(|name| !for_people(name)).collect();
        assert_eq!(bare.iter().collect::<Vec<_>>(), expected);
        for name in bare {
            let own = name.ends_with("rover.toml");
            assert!(own || without[&name] == contents[&name], "{name}");
        }
    }
    let identifier = "modelIdentifier=\"rover\"";
    assert!(description(&fmu).contains(identifier));
    let library = names.iter().find(|n| n.starts_with("binaries/")).unwrap();
    assert!(library.contains("/rover."), "{library}");
    let urdf = fs::read(example("rover.urdf")).unwrap();
    assert_eq!(contents["resources/source/rover.urdf"], urdf);
    // PKWARE's APPNOTE 4.3.14 and 4.3.15: what a zip64 has at its end.
    let bytes = fs::read(&fmu).unwrap();
    let tail = &bytes[bytes.len() - 100..];
    assert!(
        !tail
            .windows(4)
            .any(|w| w == b"PK\x06\x06" || w == b"PK\x06\x07")
    );
}

/// A tetrahedron of about 0.1 m.
const TETRAHEDRON: &str =
    "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A robot with a mesh beside it.
fn robot_with_mesh(folder: &Path) -> PathBuf {
    fs::create_dir_all(folder.join("meshes")).unwrap();
    fs::write(folder.join("meshes/body.obj"), TETRAHEDRON).unwrap();
    let urdf = folder.join("thing.urdf");
    fs::write(
        &urdf,
        r#"<robot name="thing"><link name="body">
  <inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><mesh filename="meshes/body.obj"/></geometry></collision>
</link></robot>"#,
    )
    .unwrap();
    urdf
}

#[test]
fn same_robot_gives_the_same_bytes_again_in_another_folder_and_on_another_day() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let deeper = two.path().join("deeper/and deeper");
    let make = |folder: &Path| {
        let urdf = robot_with_mesh(folder);
        let (_folder, fmu) = export(&urdf, &[]);
        fs::read(fmu).unwrap()
    };
    let first = make(one.path());
    assert!(first == make(one.path()), "the second run differs");
    assert!(first == make(&deeper), "another folder differs");
}

#[test]
fn nothing_of_the_machine_is_in_the_fmu() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = robot_with_mesh(folder.path());
    let (_folder, fmu) = export(&urdf, &[]);
    let (names, contents) = entries(&fmu);
    assert!(
        names.contains(&"resources/source/meshes/body.obj".to_owned()),
        "{names:?}"
    );
    let path = text(folder.path()).as_bytes();
    for (name, bytes) in contents {
        assert!(
            !bytes.windows(path.len()).any(|w| w == path),
            "{name} names the folder"
        );
    }
}

#[test]
fn source_date_epoch_sets_the_date() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = example("rover.urdf");
    let args = ["export", text(&urdf), "-o", "a.fmu", "--no-documentation"];
    let date = |environment: &[(&str, &str)]| {
        let run = run_in(folder.path(), &args, environment);
        assert_eq!(run.code, 0, "{run:?}");
        let root = model_description::Element::read(&description(&folder.path().join("a.fmu")));
        root.get("generationDateAndTime").unwrap().to_owned()
    };
    assert_eq!(date(&[]), "1980-01-01T00:00:00Z");
    // date -u -d @1700000000
    assert_eq!(
        date(&[("SOURCE_DATE_EPOCH", "1700000000")]),
        "2023-11-14T22:13:20Z"
    );
}

#[test]
fn guid_follows_what_the_robot_is_and_not_how_the_file_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let original = fs::read_to_string(example("rover.urdf")).unwrap();
    let guid = |change: &str, to: &str| {
        let urdf = folder.path().join("rover.urdf");
        assert!(original.contains(change));
        fs::write(&urdf, original.replacen(change, to, 1)).unwrap();
        let (_folder, fmu) = export(&urdf, &[]);
        let root = model_description::Element::read(&description(&fmu));
        root.get("guid").unwrap().to_owned()
    };
    let mass = "<mass value=\"10\"/>";
    let same = guid(mass, mass);
    assert_eq!(guid(mass, "<mass  value=\"10.0\"/><!-- kg -->"), same);
    assert_ne!(guid(mass, "<mass value=\"10.5\"/>"), same);
    let json = folder.path().join("rover.urdf");
    fs::write(&json, original).unwrap();
    let (_folder, fmu) = export(&json, &[]);
    let model = String::from_utf8(entries(&fmu).1.remove("resources/model.json").unwrap()).unwrap();
    let model: Value = serde_json::from_str(&model).unwrap();
    assert_eq!(
        model["guid"],
        same.as_str(),
        "the library compares it with the file's"
    );
}

#[test]
fn an_fmu_contains_every_platform_of_the_command_unless_some_are_selected() {
    let platforms = |fmu: &Path| -> Vec<String> {
        let run = urdf2fmu(["info", text(fmu), "--json"]);
        assert_eq!(run.code, 0, "{}", run.err);
        let info: Value = serde_json::from_str(&run.out).unwrap();
        let (names, _) = entries(fmu);
        let listed: Vec<String> = serde_json::from_value(info["platforms"].clone()).unwrap();
        for platform in &listed {
            let folder = format!("binaries/{platform}/rover.");
            assert!(names.iter().any(|name| name.starts_with(&folder)));
        }
        let libraries = names.iter().filter(|name| name.starts_with("binaries/"));
        assert_eq!(libraries.count(), listed.len(), "{names:?}");
        listed
    };
    let (_folder, all) = export(&example("rover.urdf"), &[]);
    let carried = platforms(&all);
    assert!(!carried.is_empty());
    for platform in &carried {
        let (_folder, fmu) = export(&example("rover.urdf"), &["--platform", platform]);
        assert_eq!(platforms(&fmu), std::slice::from_ref(platform));
        let run = urdf2fmu(["info", text(&fmu)]);
        // FMI 2.0's name of both Macs does not say which it is for.
        assert!(run.out.contains(&format!("\nPlatforms\n  {platform}")));
    }
    let (_folder, both) = export(&example("rover.urdf"), &["--platform", &carried.join(",")]);
    assert_eq!(platforms(&both), carried);

    // By FMI 3.0's names, which also name processors, and in the settings.
    let run = urdf2fmu(["info", text(&all), "--json"]);
    let info: Value = serde_json::from_str(&run.out).unwrap();
    let systems: Vec<String> = serde_json::from_value(info["systems"].clone()).unwrap();
    assert!(systems.len() >= carried.len());
    for system in &systems {
        let (_folder, fmu) = export(&example("rover.urdf"), &["--platform", system]);
        let run = urdf2fmu(["info", text(&fmu), "--json"]);
        let info: Value = serde_json::from_str(&run.out).unwrap();
        assert_eq!(info["systems"], serde_json::json!([system]));
    }
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("robot.toml");
    let first = &carried[0];
    fs::write(&settings, format!("[fmu]\nplatforms = ['{first}']\n")).unwrap();
    let (_folder, thin) = export(&example("rover.urdf"), &["-c", text(&settings)]);
    assert_eq!(platforms(&thin), std::slice::from_ref(first));
    let last = carried.last().unwrap();
    let options = ["-c", text(&settings), "--platform", last];
    let (_folder, other) = export(&example("rover.urdf"), &options);
    assert_eq!(platforms(&other), std::slice::from_ref(last), "options win");
}

#[test]
fn platforms_that_an_fmu_cannot_have_are_errors_that_say_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = folder.path().join("robot.fmu");
    let urdf = example("rover.urdf");
    for (asked, words) in [
        (
            "amiga",
            &["'amiga' is no platform", "x86_64-linux", "win64"][..],
        ),
        ("x86_64-linx", &["did you mean 'x86_64-linux'?"]),
        ("linux64,win46", &["did you mean 'win64'?"]),
        ("", &["'' is no platform"]),
        (
            "win32",
            &[
                "carries no library for the platform 'win32', only for",
                "docs/platforms.md",
            ],
        ),
    ] {
        let arguments = ["export", text(&urdf), "-o", text(&fmu), "--platform", asked];
        let run = urdf2fmu(arguments);
        assert_eq!(run.code, 2, "{}", run.err);
        for word in words {
            assert!(run.err.contains(word), "{asked}: {}", run.err);
        }
        assert!(!fmu.exists());
    }
    let settings = folder.path().join("robot.toml");
    for (asked, word) in [
        ("win46", "did you mean 'win64'?"),
        ("win32", "carries no library"),
    ] {
        fs::write(&settings, format!("[fmu]\nplatforms = [\n  '{asked}']\n")).unwrap();
        let run = urdf2fmu([
            "export",
            text(&urdf),
            "-o",
            text(&fmu),
            "-c",
            text(&settings),
        ]);
        assert_eq!(run.code, 1, "{}", run.err);
        assert!(
            run.err.contains("error[S109]") && run.err.contains(word),
            "{}",
            run.err
        );
        assert!(run.err.contains("robot.toml:3:3"), "{}", run.err);
        assert!(!fmu.exists());
    }
    // What no command could carry is told by `check`, too.
    fs::write(&settings, "[fmu]\nplatforms = ['win46']\n").unwrap();
    let run = urdf2fmu(["check", text(&urdf), "-c", text(&settings)]);
    assert_eq!(run.code, 1, "{}", run.err);
}

#[test]
fn export_says_what_it_made_and_what_it_assumed() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = example("rover.urdf");
    let run = run_in(folder.path(), &["export", text(&urdf)], &[]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(
        folder.path().join("rover.fmu").exists(),
        "the default name is the file's"
    );
    for word in [
        "rover.fmu",
        "floating base",
        "14.2 kg",
        "10 inputs",
        "assumed",
        "FMI 2.0 co-simulation, ",
    ] {
        assert!(run.out.contains(word), "{word:?} not in\n{}", run.out);
    }
    // The platforms are those of the folders inside.
    let (names, _) = entries(&folder.path().join("rover.fmu"));
    let folders = names.iter().filter_map(|name| {
        let (folder, _) = name.strip_prefix("binaries/")?.split_once('/')?;
        Some(folder)
    });
    let first = run.out.lines().next().unwrap();
    let told: Vec<&str> = folders.collect();
    assert!(!told.is_empty() && told.iter().all(|folder| first.contains(folder)));
    // The wheels' lowest point: axle 0.05 m below the base's origin, radius 0.1 m; the ground gives
    // way by 14 micrometres.
    assert!(
        run.out.contains("0.14998"),
        "initial height not in\n{}",
        run.out
    );
    assert_eq!(run.err, "", "an example has nothing to warn about");
}

#[test]
fn broken_robots_are_refused_with_file_and_line_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("robot.fmu");
    let good = r#"<robot name="x">
<link name="a"/>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>
</robot>"#;
    for (what, from, to, line) in [
        ("not XML", "</robot>", "<robot>", None),
        (
            "unknown parent",
            "parent link=\"a\"",
            "parent link=\"nobody\"",
            Some(4),
        ),
        ("duplicate link", "name=\"a\"", "name=\"b\"", None),
        (
            "not a number",
            "mass value=\"1\"",
            "mass value=\"NaN\"",
            Some(3),
        ),
        (
            "decimal comma",
            "mass value=\"1\"",
            "mass value=\"1,0\"",
            Some(3),
        ),
        (
            "negative mass",
            "mass value=\"1\"",
            "mass value=\"-1\"",
            Some(3),
        ),
    ] {
        let urdf = folder.path().join("broken.urdf");
        fs::write(&urdf, good.replacen(from, to, 1)).unwrap();
        let run = urdf2fmu(["export", text(&urdf), "-o", text(&target)]);
        assert_eq!(run.code, 1, "{what}: {run:?}");
        assert_eq!(run.out, "", "{what}");
        assert!(run.err.contains("error["), "{what}: {}", run.err);
        let place = line.map_or("broken.urdf:".to_owned(), |n| format!("broken.urdf:{n}:"));
        assert!(
            run.err.contains(&place),
            "{what}: {place} not in\n{}",
            run.err
        );
        let files: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|f| f.unwrap().path())
            .collect();
        assert_eq!(files, [urdf], "{what}");
    }
}

#[test]
fn an_export_never_overwrites_what_it_is_made_from() {
    let folder = tempfile::tempdir().unwrap();
    let (urdf, config) = (folder.path().join("a.urdf"), folder.path().join("a.toml"));
    fs::copy(example("rover.urdf"), &urdf).unwrap();
    fs::copy(example("rover.toml"), &config).unwrap();
    for target in [&urdf, &config] {
        let before = fs::read(target).unwrap();
        let run = urdf2fmu([
            "export",
            text(&urdf),
            "-c",
            text(&config),
            "-o",
            text(target),
        ]);
        assert_eq!(run.code, 1, "{run:?}");
        assert!(run.err.contains("give another name"), "{}", run.err);
        assert_eq!(fs::read(target).unwrap(), before);
    }
}
