//! The `urdf2fmu` command as a person or a script meets it: what it writes, prints and returns.

#![allow(clippy::unwrap_used, reason = "a test may fail")]
#![allow(missing_docs, reason = "tests say it in their names")]

mod model_description;

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// What a run of the command left behind.
#[derive(Debug)]
struct Run {
    code: i32,
    out: String,
    err: String,
}

fn urdf2fmu<const N: usize>(args: [&str; N]) -> Run {
    run_in(Path::new("."), &args, &[])
}

fn run_in(folder: &Path, args: &[&str], environment: &[(&str, &str)]) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_urdf2fmu"))
        .args(args)
        .current_dir(folder)
        .env_remove("SOURCE_DATE_EPOCH")
        .env_remove("ROS_PACKAGE_PATH")
        .env_remove("AMENT_PREFIX_PATH")
        .envs(environment.iter().copied())
        .output()
        .unwrap();
    Run {
        code: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples")
        .join(name)
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Exports `urdf` into a new folder; gives the folder and the FMU.
fn export(urdf: &Path, options: &[&str]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let fmu = folder.path().join("robot.fmu");
    let mut args = vec!["export", text(urdf), "-o", text(&fmu)];
    args.extend(options);
    let run = run_in(Path::new("."), &args, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    (folder, fmu)
}

/// Entries by name, in the order of the zip.
fn entries(fmu: &Path) -> (Vec<String>, BTreeMap<String, Vec<u8>>) {
    let mut zip = zip::ZipArchive::new(fs::File::open(fmu).unwrap()).unwrap();
    let mut names = Vec::new();
    let mut contents = BTreeMap::new();
    for i in 0..zip.len() {
        let mut entry = zip.by_index(i).unwrap();
        let name = entry.name().unwrap().into_owned();
        assert!(entry.is_file(), "{name}");
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        names.push(name.clone());
        contents.insert(name, bytes);
    }
    (names, contents)
}

fn description(fmu: &Path) -> String {
    String::from_utf8(entries(fmu).1.remove("modelDescription.xml").unwrap()).unwrap()
}

const EXAMPLES: [&str; 3] = ["rover", "arm", "quadruped"];

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
links = ["*"]
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
"#;

#[test]
fn a_description_with_every_kind_of_variable_keeps_the_rules_of_fmi() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("everything.toml");
    std::fs::write(&settings, EVERYTHING).unwrap();
    for naming in ["structured", "flat"] {
        let options = ["-c", text(&settings), "--naming", naming];
        let (_folder, fmu) = export(&example("rover.urdf"), &options);
        let problems = model_description::problems(&description(&fmu));
        assert!(problems.is_empty(), "{naming}: {problems:#?}");
    }
}

#[test]
fn fmu_holds_the_files_of_the_interface_in_order() {
    let (_folder, fmu) = export(
        &example("rover.urdf"),
        &["-c", text(&example("rover.toml"))],
    );
    let (names, contents) = entries(&fmu);
    assert!(names.is_sorted(), "{names:?}");
    for name in [
        "documentation/index.html",
        "documentation/licenses/license.txt",
        "modelDescription.xml",
        "resources/model.json",
        "resources/source/rover.toml",
        "resources/source/rover.urdf",
    ] {
        assert!(contents.contains_key(name), "{name} not in {names:?}");
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
    let args = ["export", text(&urdf), "-o", "a.fmu"];
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
    ] {
        assert!(run.out.contains(word), "{word:?} not in\n{}", run.out);
    }
    // The wheels' lowest point: axle 0.05 m below the base's origin, radius 0.1 m.
    assert!(
        run.out.contains("0.15"),
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
fn failed_export_leaves_the_old_fmu_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (urdf, target) = (folder.path().join("a.urdf"), folder.path().join("a.fmu"));
    fs::write(&urdf, "<robot/>").unwrap();
    fs::write(&target, "precious").unwrap();
    let run = urdf2fmu(["export", text(&urdf), "-o", text(&target)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert_eq!(fs::read_to_string(&target).unwrap(), "precious");
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
fn unknown_setting_is_refused_with_its_place_and_the_nearest_known_one() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("s.toml");
    fs::write(&settings, "[contact]\npenetratoin = 1e-4\n").unwrap();
    let rover = example("rover.urdf");
    let run = urdf2fmu(["check", text(&rover), "-c", text(&settings)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(
        run.err.contains("s.toml:2:") && run.err.contains("penetration"),
        "{}",
        run.err
    );
}

#[test]
fn info_says_the_same_of_a_robot_and_of_its_fmu() {
    let arm = example("arm.urdf");
    let (_folder, fmu) = export(&arm, &[]);
    for options in [&[][..], &["--variables"], &["--json", "--variables"]] {
        let of = |file: &Path| {
            let mut args = vec!["info", text(file)];
            args.extend(options);
            let run = run_in(Path::new("."), &args, &[]);
            assert_eq!(run.code, 0, "{run:?}");
            run.out
        };
        assert_eq!(of(&arm), of(&fmu), "{options:?}");
    }
}

fn info(urdf: &Path, options: &[&str]) -> Value {
    let mut args = vec!["info", text(urdf), "--json", "--variables"];
    args.extend(options);
    let run = run_in(Path::new("."), &args, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    serde_json::from_str(&run.out).unwrap()
}

/// The examples' inertia was computed by formula from the solids that are also their collision shapes.
#[test]
fn inertia_in_the_examples_is_that_of_their_solids() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("s.toml");
    fs::write(&settings, "[robot]\ninertia = \"collision\"\n").unwrap();
    for name in EXAMPLES {
        let urdf = example(&format!("{name}.urdf"));
        let (file, solids) = (info(&urdf, &[]), info(&urdf, &["-c", text(&settings)]));
        let links = |value: &Value| value["links"].as_array().unwrap().clone();
        for (a, b) in links(&file).iter().zip(&links(&solids)) {
            for (row_a, row_b) in a["inertia"]
                .as_array()
                .unwrap()
                .iter()
                .zip(b["inertia"].as_array().unwrap())
            {
                for (x, y) in row_a
                    .as_array()
                    .unwrap()
                    .iter()
                    .zip(row_b.as_array().unwrap())
                {
                    let (x, y) = (x.as_f64().unwrap(), y.as_f64().unwrap());
                    // Nine digits in the files.
                    assert!(
                        (x - y).abs() <= 1e-8 * x.abs() + 1e-12,
                        "{name} {}: {x} {y}",
                        a["name"]
                    );
                }
            }
        }
    }
}

#[test]
fn info_lists_joints_with_the_file_s_numbers() {
    let arm = info(&example("arm.urdf"), &[]);
    assert_eq!(arm["base"], "fixed");
    // Six axes and one independent finger.
    assert_eq!(arm["degrees_of_freedom"], 7);
    assert!((arm["mass"].as_f64().unwrap() - 24.5).abs() < 1e-12);
    let joints = arm["joints"].as_array().unwrap();
    let joint = |name: &str| joints.iter().find(|j| j["name"] == name).unwrap();
    let elbow = joint("elbow");
    assert_eq!(elbow["max_effort"], 100.0);
    assert_eq!(elbow["lower"], -2.7);
    assert_eq!(elbow["damping"], 0.8);
    assert_eq!(elbow["axis"], serde_json::json!([0.0, 1.0, 0.0]));
    assert_eq!(
        elbow["origin_position"],
        serde_json::json!([0.0, 0.0, 0.42])
    );
    assert_eq!(
        joint("right_finger_joint")["mimic"]["joint"],
        "left_finger_joint"
    );
}

/// The 17 columns of `getJointInfo`, by hand from the file where numbers are compared.
#[test]
fn info_has_the_columns_of_get_joint_info_and_the_poses_of_get_link_state() {
    let arm = info(&example("arm.urdf"), &[]);
    let elbow = arm["joints"]
        .as_array()
        .unwrap()
        .iter()
        .find(|j| j["name"] == "elbow")
        .unwrap();
    for column in [
        "index",
        "name",
        "type",
        "q_index",
        "v_index",
        "flags",
        "damping",
        "friction",
        "lower",
        "upper",
        "max_effort",
        "max_velocity",
        "link",
        "axis",
        "origin_position",
        "origin_orientation_xyzw",
        "parent_index",
    ] {
        assert!(elbow.get(column).is_some(), "{column}");
    }
    assert_eq!(elbow["flags"], 1);
    let parent = elbow["parent_index"].as_u64().unwrap();
    assert_eq!(
        arm["links"][usize::try_from(parent).unwrap()]["name"],
        elbow["parent"]
    );
    // The root of a fixed base that the settings do not move lies in the world's origin.
    assert_eq!(
        arm["links"][0]["position"],
        serde_json::json!([0.0, 0.0, 0.0])
    );
    assert_eq!(
        arm["links"][0]["orientation_xyzw"],
        serde_json::json!([0.0, 0.0, 0.0, 1.0])
    );
    let run = urdf2fmu(["info", text(&example("arm.urdf"))]);
    let heading = run
        .out
        .lines()
        .find(|line| line.contains("joint  "))
        .unwrap();
    for word in [
        "type", "q", "v", "flags", "damping", "friction", "lower", "upper", "effort", "velocity",
        "link", "axis", "origin", "parent", "command",
    ] {
        assert!(
            heading.split_whitespace().any(|w| w == word),
            "{word}: {heading}"
        );
    }
}

/// What `init` writes says what holds: exporting with it changes nothing, nor with all its lines made active.
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

/// With a stand-in for the command: what is asked of it, and what is made of its answer.
#[cfg(unix)]
#[test]
fn xacro_files_are_expanded_by_the_command_with_their_arguments() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (bin, robot) = (
        folder.path().join("bin"),
        folder.path().join("ball.urdf.xacro"),
    );
    fs::create_dir(&bin).unwrap();
    fs::write(&robot, "<robot xmlns:xacro='http://ros.org/wiki/xacro'/>").unwrap();
    let script = bin.join("xacro");
    // The banner is the command's own; the mass is the argument's.
    let write = |body: &str| {
        fs::write(&script, format!("#!/bin/sh\n{body}\n")).unwrap();
        fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
    };
    let path = format!(
        "{}:{}",
        bin.display(),
        std::env::var("PATH").unwrap_or_default()
    );
    let run = |args: &[&str], path: &str| run_in(folder.path(), args, &[("PATH", path)]);
    write(concat!(
        "m=${2#mass:=}\n",
        "echo \"<!-- |    This document was autogenerated by xacro from $PWD/$1 | -->\"\n",
        "echo \"<robot name='ball'><link name='ball'><inertial><mass value='$m'/>\"\n",
        "echo \"<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>\""
    ));
    let done = run(&["info", "ball.urdf.xacro", "mass:=2.5", "--json"], &path);
    assert_eq!(done.code, 0, "{done:?}");
    let info: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(info["mass"], 2.5);
    let done = run(&["export", "ball.urdf.xacro", "mass:=2.5"], &path);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.out.contains("expanded by xacro"), "{}", done.out);
    let (_, contents) = entries(&folder.path().join("ball.fmu"));
    let packed = String::from_utf8_lossy(&contents["resources/source/ball.urdf"]).into_owned();
    assert!(packed.contains("value='2.5'"), "{packed}");
    // Nothing of the machine: the banner's path is gone, the lines are the same.
    assert!(!packed.contains(text(folder.path())), "{packed}");
    assert_eq!(packed.lines().count(), 3);
    // A fault has its line in the expanded text.
    let done = run(&["check", "ball.urdf.xacro", "mass:=heavy"], &path);
    assert_eq!(done.code, 1);
    assert!(
        done.err.contains("ball.urdf.xacro:2:") && done.err.contains("'heavy'"),
        "{}",
        done.err
    );
    assert!(
        done.err.contains("lines are those of the expanded text"),
        "{}",
        done.err
    );
    // What the command says when it fails, and what to do where there is none.
    write("echo 'undefined substitution argument mass' >&2; exit 2");
    let done = run(&["check", "ball.urdf.xacro"], &path);
    assert_eq!(done.code, 1);
    assert!(
        done.err.contains("undefined substitution argument mass"),
        "{}",
        done.err
    );
    let done = run(&["check", "ball.urdf.xacro", "mass:=1"], "/nowhere");
    assert_eq!(done.code, 1);
    for part in [
        "pip install xacro",
        "xacro ball.urdf.xacro mass:=1 > ball.urdf",
    ] {
        assert!(done.err.contains(part), "{part}: {}", done.err);
    }
    let done = run(&["check", "ball.urdf", "mass:=1"], &path);
    assert!(
        done.code == 1 && done.err.contains("no xacro file"),
        "{}",
        done.err
    );
    let done = run(&["check", "ball.urdf.xacro", "mass=1"], &path);
    assert!(
        done.code == 2 && done.err.contains("name:=value"),
        "{}",
        done.err
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
fn check_reports_for_people_and_for_programs() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("odd.urdf");
    let original = fs::read_to_string(example("rover.urdf")).unwrap();
    fs::write(&urdf, original.replacen("<mass ", "<colour/><mass ", 1)).unwrap();
    let run = urdf2fmu(["check", text(&urdf)]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("warning["), "{}", run.out);

    let denied = urdf2fmu(["check", text(&urdf), "--deny", "warnings"]);
    assert_eq!(denied.code, 1, "{denied:?}");

    let json = urdf2fmu(["check", text(&urdf), "--json"]);
    let value: Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!(value["ok"], true);
    let findings = value["findings"].as_array().unwrap();
    let warning = findings
        .iter()
        .find(|f| f["severity"] == "warning")
        .unwrap();
    assert!(warning["line"].as_u64().unwrap() > 1, "{warning}");

    assert_eq!(urdf2fmu(["check", text(&example("rover.urdf"))]).code, 0);
}

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
fn fmu_holds_every_platform_of_the_command_unless_told_which() {
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
        assert!(run.out.contains(&format!("\nPlatforms\n  {platform}\n")));
    }
    let (_folder, both) = export(&example("rover.urdf"), &["--platform", &carried.join(",")]);
    assert_eq!(platforms(&both), carried);

    let folder = tempfile::tempdir().unwrap();
    let fmu = folder.path().join("robot.fmu");
    let urdf = example("rover.urdf");
    let run = urdf2fmu([
        "export",
        text(&urdf),
        "-o",
        text(&fmu),
        "--platform",
        "amiga",
    ]);
    assert_eq!(run.code, 2, "{}", run.err);
    assert!(run.err.contains("'amiga'"), "{}", run.err);
    assert!(run.err.contains(&carried.join(", ")), "{}", run.err);
    assert!(!fmu.exists());
}
