//! Files as people have them: faults that other programs pass over, meshes at other places, files
//! of the wrong kind. Each robot here is a public one made small.
//!
//! Over 500 lines because it is a list of files, each with what is said of it.

use super::*;

pub(super) fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, content).unwrap();
    path
}

/// A binary STL of a tetrahedron with corners at 0 and 0.1 m.
pub(super) fn tetrahedron() -> Vec<u8> {
    let corners = [
        [0.0_f32; 3],
        [0.1, 0.0, 0.0],
        [0.0, 0.1, 0.0],
        [0.0, 0.0, 0.1],
    ];
    let mut bytes = vec![0; 80];
    bytes.extend(4_u32.to_le_bytes());
    for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        bytes.extend([0; 12]);
        for corner in face {
            bytes.extend(corners[corner].iter().flat_map(|x: &f32| x.to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

#[allow(clippy::format_collect, reason = "a few links")]
pub(super) fn mesh_robot(names: &[&str]) -> String {
    let links: String = names
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let joint = if i == 0 {
                String::new()
            } else {
                format!(
                    "<joint name='j{i}' type='revolute'><parent link='l{}'/><child link='l{i}'/>\
                     <axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\n",
                    i - 1
                )
            };
            format!(
                "<link name='l{i}'><inertial><mass value='1'/>\
                 <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>\n\
                 <collision><geometry><mesh filename='{name}'/></geometry></collision></link>\n{joint}"
            )
        })
        .collect();
    format!("<robot name='r'>\n{links}</robot>\n")
}

pub(super) fn findings(path: &Path, args: &[&str]) -> (bool, Vec<Value>) {
    let mut all = vec!["check", text(path), "--json"];
    all.extend(args);
    let done = run_in(Path::new("."), &all, &[]);
    let value: Value = serde_json::from_str(&done.out).unwrap_or_else(|_| panic!("{done:?}"));
    let list = value["findings"].as_array().unwrap().clone();
    (value["ok"] == true, list)
}

pub(super) fn of_severity<'f>(findings: &'f [Value], severity: &str) -> Vec<&'f Value> {
    findings
        .iter()
        .filter(|f| f["severity"] == severity)
        .collect()
}

#[allow(clippy::format_push_string, reason = "a few links")]
fn chain(joints: usize, link: &dyn Fn(usize) -> String) -> String {
    let mut out = String::from("<robot name='arm'>\n");
    for i in 0..=joints {
        out += &format!("<link name='l{i}'>{}</link>\n", link(i));
        if i > 0 {
            out += &format!(
                "<joint name='j{i}' type='revolute'><origin xyz='0 0 0.3'/><parent link='l{}'/>\
                 <child link='l{i}'/><axis xyz='0 1 0'/>\
                 <limit lower='-1' upper='1' effort='9' velocity='1'/></joint>\n",
                i - 1
            );
        }
    }
    out + "</robot>\n"
}

/// As ROS-Industrial's arms: shapes, but no masses. 96 of 707 public files are so.
#[test]
fn links_without_inertia_are_told_at_once_and_the_ways_offered_work() {
    let folder = tempfile::tempdir().unwrap();
    let shape = "<collision><geometry><box size='0.1 0.1 0.2'/></geometry></collision>";
    let drawn = write(folder.path(), "a.urdf", chain(6, &|_| shape.to_owned()));
    let bare = write(
        folder.path(),
        "b.urdf",
        chain(6, &|i| {
            if i == 6 {
                String::new()
            } else {
                shape.to_owned()
            }
        }),
    );
    for (robot, links) in [(&drawn, 6), (&bare, 6)] {
        let (ok, list) = findings(robot, &[]);
        let errors = of_severity(&list, "error");
        assert!(!ok && errors.len() == 1, "{errors:?}");
        assert_eq!(errors[0]["code"], "A104");
        let message = errors[0]["message"].as_str().unwrap();
        assert!(
            message.contains(&format!("{links} links without inertia")),
            "{message}"
        );
        let help = errors[0]["help"].as_str().unwrap();
        assert!(help.contains("'l1'") && help.contains("'l6'"), "{help}");
        assert!(
            help.contains("--density 1000")
                && help.contains("[robot] density = 1000")
                && help.contains("--compat pybullet"),
            "{help}"
        );
        // What it offers loads.
        assert!(findings(robot, &["--compat", "pybullet"]).0);
    }
    // Seven boxes of 0.1 × 0.1 × 0.2 m at 1000 kg/m³ are 2 kg each; the base does not float for it.
    let way = ["--density", "1000"];
    let (ok, list) = findings(&drawn, &way);
    assert!(ok, "{list:?}");
    let done = run_in(
        Path::new("."),
        &[&["info", text(&drawn), "--json"][..], &way[..]].concat(),
        &[],
    );
    let info: Value = serde_json::from_str(&done.out).unwrap();
    assert!(
        (info["mass"].as_f64().unwrap() - 14.0).abs() < 1e-9,
        "{}",
        info["mass"]
    );
    // A cuboid about its middle: m/12 (a² + b²).
    let inertia = info["links"][3]["inertia"].to_string();
    assert!(inertia.contains("0.00833333333333333"), "{inertia}");
    // The link without a shape gets a mass of its own: a ball of 5 cm, 2/5 m r².
    let (_, list) = findings(&bare, &[]);
    let help = of_severity(&list, "error")[0]["help"]
        .as_str()
        .unwrap()
        .to_owned();
    let options = ["--density", "1000", "--missing-mass", "0.1"];
    assert!(help.contains(&options.join(" ")), "{help}");
    let keys = "[robot]\ndensity = 1000\nmissing_mass = 0.1\n";
    let settings = write(folder.path(), "s.toml", keys);
    for options in [&options[..], &["-c", text(&settings)]] {
        let (ok, list) = findings(&bare, options);
        assert!(ok, "{list:?}");
        let info = run_in(
            Path::new("."),
            &[&["info", text(&bare), "--json"][..], options].concat(),
            &[],
        );
        let info: Value = serde_json::from_str(&info.out).unwrap();
        let last = &info["links"][6];
        let moment = last["inertia"][0][0].as_f64().unwrap();
        assert!((moment - 0.4 * 0.1 * 0.05 * 0.05).abs() < 1e-15, "{last}");
        assert!(
            (last["mass"].as_f64().unwrap() - 0.1).abs() < 1e-15,
            "{last}"
        );
    }
}

#[test]
fn a_mass_without_an_inertia_gets_that_of_the_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let robot = write(
        folder.path(),
        "r.urdf",
        "<robot name='r'><link name='l'><inertial><mass value='3'/></inertial>\
         <collision><geometry><sphere radius='0.1'/></geometry></collision></link></robot>",
    );
    let (ok, list) = findings(&robot, &[]);
    assert!(
        ok && of_severity(&list, "warning")[0]["code"] == "U063",
        "{list:?}"
    );
    let done = urdf2fmu(["info", text(&robot), "--json"]);
    let info: Value = serde_json::from_str(&done.out).unwrap();
    // (2/5) m r²
    let moment = info["links"][0]["inertia"].to_string();
    assert!(moment.contains("0.012"), "{moment}");
    assert!(!findings(&robot, &["--deny", "warnings"]).0);
}

/// Atlas, Kinova, `eve_r3`, `pr2_simplified`, Pioneer, Poppy: other programs load them.
#[test]
fn what_others_take_is_a_warning_that_says_what_was_assumed() {
    let folder = tempfile::tempdir().unwrap();
    let body = "<inertial><mass value='1'/>\
                <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    let two = |joint: &str, of_b: &str| {
        format!(
            "<robot name='r'><link name='a'>{body}</link><link name='b'>{body}{of_b}</link>\
             <joint name='j' {joint}</joint></robot>"
        )
    };
    let ends = "<parent link='a'/><child link='b'/>";
    let limit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
    let hinge = format!("type='revolute'>{ends}{limit}");
    let touch = |shape: &str| format!("<collision><geometry>{shape}</geometry></collision>");
    for (name, xml, code, message) in [
        ("sphere", two(&hinge, &touch("<sphere radius='0'/>")), "U033", "radius is 0: the shape touches"),
        ("box", two(&hinge, &touch("<box size='0 0 0'/>")), "U033", "size is 0"),
        ("cylinder", two(&hinge, &touch("<cylinder radius='0.1' length='0'/>")), "U033", "length is 0"),
        (
            "effort",
            two(&hinge.replace("effort='1'", "effort='-1'"), ""),
            "U033",
            "effort -1 is negative: it counts as unlimited",
        ),
        ("limit", two(&format!("type='prismatic'>{ends}"), ""), "U044", "counts as unlimited"),
        ("axis", two(&format!("type='fixed'>{ends}<axis/>"), ""), "U015", "\"1 0 0\" is used"),
        (
            "world",
            two(&hinge, "").replace(
                "</robot>",
                "<joint name='w' type='fixed'><parent link='world'/><child link='a'/></joint></robot>",
            ),
            "U016",
            "taken as the world itself",
        ),
        (
            "shapes",
            two(&hinge, &touch("<sphere radius='0.1'/><box size='1 1 1'/>")),
            "U018",
            "all of them are used",
        ),
        (
            "origin",
            two(&hinge, &touch("<origin xyz='1 0 0'/><sphere radius='0.1'/>")),
            "U074",
            "<origin> inside <geometry> is not used",
        ),
        (
            "mass",
            two(&hinge, "").replacen("value='1'", "value='4.19e-15'", 1),
            "U064",
            "counts as none",
        ),
    ] {
        let robot = write(folder.path(), &format!("{name}.urdf"), &xml);
        let (ok, list) = findings(&robot, &[]);
        assert!(ok, "{name}: {list:?}");
        let warnings = of_severity(&list, "warning");
        let told = warnings.iter().any(|f| {
            f["code"] == code && f["message"].as_str().unwrap().contains(message) && f["line"].is_u64()
        });
        assert!(told, "{name}: {warnings:?}");
        assert!(!findings(&robot, &["--deny", "warnings"]).0, "{name}");
        // It runs.
        let done = urdf2fmu(["simulate", text(&robot), "--stop-time", "0.05", "--quiet"]);
        assert_eq!(done.code, 0, "{name}: {done:?}");
    }
    // Nothing is lost: both shapes of the one geometry.
    let done = urdf2fmu(["info", text(&folder.path().join("shapes.urdf")), "--json"]);
    let info: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(info["links"][1]["collision"].as_array().unwrap().len(), 2);
    // A negative size is still a mistake.
    let wrong = write(
        folder.path(),
        "w.urdf",
        two(&hinge, &touch("<sphere radius='-1'/>")),
    );
    assert!(!findings(&wrong, &[]).0);
}

/// `package://` of a renamed package, paths from a folder of assets, paths of another machine.
#[test]
fn meshes_at_another_place_of_the_robot_s_folders_are_used_and_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let names = [
        "package://QARM/meshes/a.stl",
        "package://QARM/meshes/b.stl",
        "meshes/a.stl",
        "file:///home/somebody/ws/share/arm/meshes/b.stl",
    ];
    write(folder.path(), "arm/meshes/a.stl", tetrahedron());
    write(folder.path(), "arm/meshes/b.stl", tetrahedron());
    let robot = write(folder.path(), "arm/urdf/r.urdf", mesh_robot(&names));
    let (ok, list) = findings(&robot, &[]);
    assert!(ok, "{list:?}");
    let moved: Vec<&Value> = list.iter().filter(|f| f["code"] == "U118").collect();
    // Once for the package, once for paths.
    assert_eq!(moved.len(), 2, "{moved:?}");
    let said = format!("{moved:?}");
    assert!(
        said.contains("--package QARM=DIR") && said.contains("and 1 more likewise"),
        "{said}"
    );
    let done = urdf2fmu(["info", text(&robot), "--json"]);
    let info: Value = serde_json::from_str(&done.out).unwrap();
    for link in info["links"].as_array().unwrap() {
        assert_eq!(link["collision"].as_array().unwrap().len(), 1, "{link}");
    }
    // Two files that fit equally well are not guessed between.
    write(folder.path(), "arm/old/meshes/a.stl", tetrahedron());
    let one = write(
        folder.path(),
        "arm/urdf/one.urdf",
        mesh_robot(&["package://QARM/meshes/a.stl"]),
    );
    let (ok, list) = findings(&one, &[]);
    assert!(
        !ok && of_severity(&list, "error")[0]["code"] == "U104",
        "{list:?}"
    );
    // The package can be named.
    let package = format!("QARM={}", folder.path().join("arm").display());
    let (ok, list) = findings(&one, &["--package", &package]);
    assert!(ok && !list.iter().any(|f| f["code"] == "U118"), "{list:?}");
}

#[test]
fn missing_meshes_are_one_finding_with_one_option_that_finds_them() {
    let folder = tempfile::tempdir().unwrap();
    let names = [
        "package://nao/m/a.stl",
        "package://nao/m/b.stl",
        "package://nao/m/c.stl",
    ];
    let robot = write(folder.path(), "ws/bot/r.urdf", mesh_robot(&names));
    let (_, list) = findings(&robot, &[]);
    let errors = of_severity(&list, "error");
    assert_eq!(errors.len(), 1, "{errors:?}");
    let message = errors[0]["message"].as_str().unwrap();
    assert!(
        message.contains("a.stl, and 2 more of package 'nao'"),
        "{message}"
    );
    let help = errors[0]["help"].as_str().unwrap();
    assert!(
        help.contains("--package nao=DIR") && help.contains("lines 5, 8"),
        "{help}"
    );
    assert!(help.lines().count() <= 10, "{help}");
    // They lie beside the robot's folder, where no file is taken from without being told to. What
    // has another name may be of another robot, and is not offered.
    for name in ["a", "b", "c"] {
        let name = format!("ws/nao_meshes/m/{name}.stl");
        write(folder.path(), &name, tetrahedron());
    }
    let (_, list) = findings(&robot, &[]);
    let help = of_severity(&list, "error")[0]["help"].to_string();
    assert!(!help.contains("nao_meshes"), "{help}");
    for name in ["a", "b", "c"] {
        let name = format!("ws/data/nao/m/{name}.stl");
        write(folder.path(), &name, tetrahedron());
    }
    let (ok, list) = findings(&robot, &[]);
    let help = of_severity(&list, "error")[0]["help"]
        .as_str()
        .unwrap()
        .to_owned();
    let option = help.lines().next().unwrap();
    assert!(!ok && option.ends_with(" finds all of them"), "{help}");
    let words: Vec<&str> = option.split(' ').take(2).collect();
    assert!(findings(&robot, &words).0, "{words:?}");
}

#[test]
fn folders_pointers_of_git_lfs_and_pipes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 10\n";
    write(folder.path(), "p.stl", pointer);
    fs::create_dir(folder.path().join("d.stl")).unwrap();
    let mut meshes = vec![
        ("p.stl", ["Git LFS", "git lfs pull"]),
        ("d.stl", ["is a folder, not a file", "d.stl"]),
    ];
    if cfg!(unix) {
        // Nobody writes to it: who opens it waits for ever.
        let pipe = folder.path().join("f.stl");
        let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success(), "{made}");
        meshes.push(("f.stl", ["is a pipe, not a file", "f.stl"]));
    }
    for (mesh, parts) in meshes {
        let robot = write(folder.path(), "r.urdf", mesh_robot(&[mesh]));
        let (ok, list) = findings(&robot, &[]);
        let error = of_severity(&list, "error")[0].to_string();
        assert!(
            !ok && parts.iter().all(|part| error.contains(part)),
            "{error}"
        );
    }
}

#[test]
fn a_file_of_the_wrong_kind_is_told_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let robot = write(
        folder.path(),
        "r.urdf",
        "<robot name='r'><link name='a'/></robot>",
    );
    let fmu = folder.path().join("r.fmu");
    let run = urdf2fmu([
        "export",
        "--no-documentation",
        text(&robot),
        "-o",
        text(&fmu),
    ]);
    assert_eq!(run.code, 0, "{run:?}");
    let zip = folder.path().join("r.zip");
    fs::copy(&fmu, &zip).unwrap();
    let mesh = write(folder.path(), "m.stl", tetrahedron());
    let table = write(folder.path(), "t.csv", "time,x\n0,1\n");
    let settings = write(folder.path(), "s.toml", "[robot]\n");
    let picture = write(folder.path(), "p.dat", b"\x89PNG\r\n\x1a\n");
    let fake = write(
        folder.path(),
        "f.fmu",
        "<robot name='r'><link name='a'/></robot>",
    );
    for (path, part) in [
        (&zip, "a zip archive"),
        (&mesh, "a mesh: give the URDF"),
        (&table, "a table"),
        (&settings, "a settings file"),
        (&picture, "a picture"),
        (&fake, "no FMU"),
    ] {
        for command in ["info", "check", "simulate"] {
            let done = urdf2fmu([command, text(path)]);
            assert!(
                done.code == 1 && done.err.contains(part),
                "{command} {path:?}: {done:?}"
            );
        }
    }
    // One that is not there is no FMU.
    for command in ["check", "export"] {
        let done = urdf2fmu([command, text(&folder.path().join("none.fmu"))]);
        assert!(done.code == 1 && done.err.contains("cannot be read: No such file"));
    }
    // A zip of something else, and one of the folder that the FMU was unpacked into.
    let other = folder.path().join("other.fmu");
    for (name, part) in [
        ("readme.txt", "it has no modelDescription.xml at its top\n"),
        (
            "r/modelDescription.xml",
            "at its top, but in 'r': an FMU is",
        ),
    ] {
        let mut zip = zip::ZipWriter::new(fs::File::create(&other).unwrap());
        zip.start_file(name, zip::write::SimpleFileOptions::default())
            .unwrap();
        zip.finish().unwrap();
        let done = urdf2fmu(["simulate", text(&other)]);
        let said = format!("error: '{}' is no FMU: ", text(&other));
        assert!(
            done.code == 1 && done.err.starts_with(&said) && done.err.contains(part),
            "{done:?}"
        );
    }
    let done = urdf2fmu(["check", text(&fmu)]);
    assert!(
        done.code == 1 && done.err.contains("check takes the URDF"),
        "{done:?}"
    );
    let done = urdf2fmu(["export", text(&fmu)]);
    assert!(
        done.code == 1 && done.err.contains("an FMU already"),
        "{done:?}"
    );
}

/// `- 1` is a value and no option, whatever comes of it.
#[test]
fn negative_numbers_are_values() {
    let rover = example("rover.urdf");
    for option in ["--output-interval", "--tolerance", "--scale", "--density"] {
        for value in ["-1", "-1e-3", "-.5", "-1E+2"] {
            let done = urdf2fmu(["simulate", text(&rover), option, value]);
            assert!(
                !done.err.contains("unexpected argument") && done.code != 0,
                "{option} {value}: {done:?}"
            );
        }
    }
    let start = "initial.joint.head_joint.velocity";
    let moved = [
        "simulate",
        text(&rover),
        "--stop-time",
        "0.01",
        "--start-value",
        start,
    ];
    for value in ["-1e-3", "-.5", "-5E-1"] {
        let done = run(&[&moved[..], &[value]].concat());
        assert_eq!(done.code, 0, "{value}: {done:?}");
    }
    // Numbers of any size are short, too.
    let done = run(&[&moved[..], &["-1e300"]].concat());
    assert!(done.err.contains("not -1e300"), "{done:?}");
}

#[test]
fn names_that_become_one_have_a_place() {
    let folder = tempfile::tempdir().unwrap();
    let robot = chain(2, &|_| {
        "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"
            .to_owned()
    });
    let robot = robot
        .replace("name='j1'", "name='j a'")
        .replace("name='j2'", "name='j_a'");
    let robot = write(folder.path(), "r.urdf", robot);
    let (ok, list) = findings(&robot, &[]);
    let errors = of_severity(&list, "error");
    assert!(!ok && errors[0]["code"] == "A139", "{errors:?}");
    assert_eq!(errors[0]["line"], 6, "{errors:?}");
    assert_eq!(
        errors[0]["length"],
        "<joint name='j_a' type='revolute'>".len()
    );
}

#[test]
fn settings_for_all_that_match_nothing_are_notes() {
    let folder = tempfile::tempdir().unwrap();
    let robot = write(
        folder.path(),
        "r.urdf",
        "<robot name='r'><link name='a'/></robot>",
    );
    let settings = write(
        folder.path(),
        "s.toml",
        "[[actuator]]\njoint = \"*\"\nmode = \"effort\"\n[outputs]\ncontacts = [\"*\"]\n[joint.\"*\"]\ndamping = 1\n",
    );
    let (ok, list) = findings(&robot, &["-c", text(&settings)]);
    assert!(ok, "{list:?}");
    let of_names = |f: &&Value| f["code"] == "A101" || f["code"] == "A102";
    let mut told: Vec<_> = list
        .iter()
        .filter(of_names)
        .map(|f| (f["severity"].as_str().unwrap(), f["line"].as_u64().unwrap()))
        .collect();
    told.sort_unstable();
    assert_eq!(told, [("note", 2), ("note", 5), ("note", 6)], "{list:?}");
    let settings = write(
        folder.path(),
        "t.toml",
        "[[actuator]]\njoint = \"elbow\"\nmode = \"effort\"\n",
    );
    assert!(!findings(&robot, &["-c", text(&settings)]).0);
}

/// Files of one package's arm, mounted by everybody.
#[test]
fn an_arm_that_floats_stands_out_and_init_proposes_its_base() {
    let folder = tempfile::tempdir().unwrap();
    let body = "<inertial><mass value='1'/>\
                <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    let robot = write(folder.path(), "r.urdf", chain(6, &|_| body.to_owned()));
    let (ok, list) = findings(&robot, &[]);
    let warnings = of_severity(&list, "warning");
    assert!(ok && warnings[0]["code"] == "A107", "{list:?}");
    assert!(
        warnings[0]["help"]
            .as_str()
            .unwrap()
            .contains("--fixed-base")
    );
    for option in ["--fixed-base", "--floating-base"] {
        let (_, list) = findings(&robot, &[option]);
        assert!(of_severity(&list, "warning").is_empty(), "{list:?}");
    }
    let done = urdf2fmu(["init", text(&robot)]);
    assert!(
        done.out.contains("\n# base = \"fixed\" mounts it\n"),
        "{}",
        done.out
    );
}

#[test]
fn codes_are_explained_and_listed() {
    let done = urdf2fmu(["explain", "u063"]);
    assert!(done.code == 0 && done.out.starts_with("U063: "), "{done:?}");
    let done = urdf2fmu(["explain", "X999"]);
    assert!(
        done.code == 2 && done.err.contains("no finding 'X999'"),
        "{done:?}"
    );
    // The page is what the command writes.
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/codes.md");
    assert_eq!(urdf2fmu(["explain"]).out, fs::read_to_string(page).unwrap());
}

#[test]
fn an_fmu_says_who_made_it_and_a_changed_model_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let settings = write(
        folder.path(),
        "s.toml",
        "[fmu]\nname = \"My rover\"\nauthor = \"A & B\"\nversion = \"1.2\"\ncopyright = \"C\"\n\
         license = \"MIT\"\nstop_time = 3\n",
    );
    let fmu = folder.path().join("r.fmu");
    let rover = example("rover.urdf");
    let done = urdf2fmu([
        "export",
        text(&rover),
        "-c",
        text(&settings),
        "-o",
        text(&fmu),
        "--no-documentation",
    ]);
    assert_eq!(done.code, 0, "{done:?}");
    let (_, contents) = entries(&fmu);
    let xml = String::from_utf8_lossy(&contents["modelDescription.xml"]).into_owned();
    for part in [
        "modelName=\"My rover\"",
        "author=\"A &amp; B\"",
        "version=\"1.2\"",
        "copyright=\"C\"",
        "license=\"MIT\"",
        "stopTime=\"3\"",
        "modelIdentifier=\"My_rover\"",
        "displayUnit=\"deg/s\"",
        "name=\"rpm\"",
    ] {
        assert!(xml.contains(part), "{part}");
    }
    // One digit of one mass.
    let model = String::from_utf8_lossy(&contents["resources/model.json"]).into_owned();
    let at = model.find("\"mass\": ").unwrap() + 8;
    let mut changed = contents.clone();
    let mut bytes = model.into_bytes();
    bytes[at] = if bytes[at] == b'1' { b'2' } else { b'1' };
    changed.insert("resources/model.json".to_owned(), bytes);
    let other = folder.path().join("o.fmu");
    let mut zip = zip::ZipWriter::new(fs::File::create(&other).unwrap());
    for (name, content) in &changed {
        zip.start_file(name.as_str(), zip::write::SimpleFileOptions::default())
            .unwrap();
        std::io::Write::write_all(&mut zip, content).unwrap();
    }
    zip.finish().unwrap();
    for command in ["info", "simulate"] {
        let done = urdf2fmu([command, text(&other)]);
        assert!(
            done.code != 0 && done.err.contains("changed after it was exported"),
            "{command}: {done:?}"
        );
    }
}

/// A modelDescription.xml of a few MB that unpacks to gigabytes.
#[test]
fn an_fmu_that_unpacks_to_too_much_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.fmu");
    let mut zip = zip::ZipWriter::new(fs::File::create(&path).unwrap());
    zip.start_file(
        "modelDescription.xml",
        zip::write::SimpleFileOptions::default(),
    )
    .unwrap();
    let blank = vec![b' '; 1 << 20];
    for _ in 0..513 {
        std::io::Write::write_all(&mut zip, &blank).unwrap();
    }
    zip.finish().unwrap();
    let done = urdf2fmu(["simulate", text(&path)]);
    assert!(
        done.code == 1 && done.err.contains("modelDescription.xml' unpacks to more"),
        "{done:?}"
    );
}

/// The robot's mass is its own, the list of what is around it is short, and scenery is meant.
#[test]
fn a_summary_counts_the_robot_alone() {
    let folder = tempfile::tempdir().unwrap();
    let cube = write(
        folder.path(),
        "cube.urdf",
        "<robot name='cube'><link name='c'><inertial><mass value='5'/>\
         <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>\
         <collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link></robot>",
    );
    let rover = example("rover.urdf");
    let fmu = folder.path().join("r.fmu");
    let objects: Vec<String> = (0..9)
        .map(|i| format!("{}@{},0", cube.display(), i + 2))
        .collect();
    let mut args = vec![
        "export",
        text(&rover),
        "-o",
        text(&fmu),
        "--no-documentation",
    ];
    for object in &objects {
        args.extend(["--object", object.as_str()]);
    }
    let done = run_in(Path::new("."), &args, &[]);
    assert_eq!(done.code, 0, "{done:?}");
    let own = "6 links, 5 joints, 11 degrees of freedom, 14.2 kg";
    assert!(
        done.out.contains(own) && done.out.contains("and 4 more"),
        "{}",
        done.out
    );
    let done = urdf2fmu(["info", text(&fmu), "--json"]);
    let info: Value = serde_json::from_str(&done.out).unwrap();
    assert!(
        (info["mass"].as_f64().unwrap() - 14.2).abs() < 1e-9,
        "{}",
        info["mass"]
    );
    let plane = write(
        folder.path(),
        "table.urdf",
        "<robot name='table'><link name='t'><collision><geometry><box size='1 1 1'/></geometry></collision></link></robot>",
    );
    let object = format!("{}@0,0,2", cube.display());
    let done = urdf2fmu(["check", text(&plane), "--object", &object, "--json"]);
    let value: Value = serde_json::from_str(&done.out).unwrap();
    let list = value["findings"].as_array().unwrap().clone();
    assert!(
        !of_severity(&list, "warning")
            .iter()
            .any(|f| f["code"] == "A107"),
        "{list:?}"
    );
}
