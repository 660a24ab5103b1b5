//! SRDFs in xacro, as the assistants of MoveIt and many hands write them.

use super::packages::field;
use super::people::{findings, of_severity, write};
use super::*;

const ROOT: &str = "<robot name='arm' xmlns:xacro='http://www.ros.org/wiki/xacro'>";

/// An arm of one joint, the SRDF's macros, and the SRDF that calls them in `package`.
fn files(root: &Path) -> [PathBuf; 2] {
    let body = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' \
                izz='1'/></inertial>";
    let urdf = format!(
        "<robot name='arm'><link name='left_base'>{body}</link><link name='left_tip'>{body}</link>\
         <joint name='left_elbow' type='revolute'><parent link='left_base'/>\
         <child link='left_tip'/><axis xyz='0 1 0'/><limit lower='-2' upper='2' effort='9' \
         velocity='1'/></joint></robot>"
    );
    let macros = format!(
        "{ROOT}<xacro:macro name='arm_srdf' params='prefix'>\
         <group_state name='${{prefix}}bent' group='g'><joint name='${{prefix}}elbow' \
         value='${{pi/2}}'/></group_state><disable_collisions link1='${{prefix}}base' \
         link2='${{prefix}}tip' reason='Adjacent'/></xacro:macro></robot>"
    );
    let whole = format!(
        "{ROOT}<xacro:arg name='side' default='right'/>\
         <xacro:include filename='$(find cfg)/srdf/macros.srdf.xacro'/>\
         <xacro:arm_srdf prefix='$(arg side)_'/><virtual_joint name='v' type='fixed' \
         parent_frame='world' child_link='$(arg side)_base'/></robot>"
    );
    write(root, "src/cfg/package.xml", "<name>cfg</name>");
    write(root, "src/cfg/srdf/macros.srdf.xacro", macros);
    let srdf = write(root, "src/cfg/srdf/arm.srdf.xacro", whole);
    [write(root, "src/arm/arm.urdf", urdf), srdf]
}

#[test]
fn an_srdf_in_xacro_is_expanded_with_its_arguments() {
    let folder = tempfile::tempdir().unwrap();
    let [urdf, srdf] = files(folder.path());
    let options = |state: &'static str, argument: &'static str| {
        ["--srdf", text(&srdf), "--initial-state", state, argument].map(str::to_owned)
    };
    let check = |options: &[String]| {
        let options: Vec<&str> = options.iter().map(String::as_str).collect();
        findings(&urdf, &options)
    };
    let (ok, list) = check(&options("left_bent", "side:=left"));
    assert!(ok, "{list:?}");
    let warnings = of_severity(&list, "warning");
    assert!(warnings.iter().all(|f| f["code"] == "A107"), "{warnings:?}");
    let notes: Vec<&Value> = list.iter().filter(|f| f["code"] == "R106").collect();
    assert!(
        notes
            .iter()
            .any(|f| f["message"].as_str().unwrap().starts_with("1 pairs"))
    );
    // Each of them has its place in the file that was written by hand.
    let written = |f: &&&Value| {
        f["help"]
            .as_str()
            .unwrap_or_default()
            .contains("is written in ")
    };
    assert_eq!(
        notes.iter().filter(written).count(),
        notes.len(),
        "{notes:?}"
    );
    let all = options("left_bent", "side:=left");
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    let variables = info(&urdf, &all)["variables"].clone();
    let variables = variables.as_array().unwrap();
    let of_elbow = |v: &&Value| v["name"] == "initial.joint.left_elbow.position";
    let start = variables.iter().find(of_elbow).unwrap()["start"]
        .as_f64()
        .unwrap();
    assert!(
        (start - std::f64::consts::FRAC_PI_2).abs() < 1e-12,
        "{start}"
    );

    // Without the argument it is the SRDF of another robot; a wrong one is told with those it has.
    let (ok, list) = check(&options("left_bent", "side:=right"));
    assert!(
        !ok && field(&list, "R104", "help").contains("right_bent"),
        "{list:?}"
    );
    let (ok, list) = check(&options("right_bent", "sid:=left"));
    assert!(
        ok && field(&list, "U006", "help").contains("'side'"),
        "{list:?}"
    );
    // Faults of the expansion are errors, as those of a robot in xacro.
    let macros = folder.path().join("src/cfg/srdf/macros.srdf.xacro");
    let whole = fs::read_to_string(&macros).unwrap();
    fs::write(&macros, whole.replace("pi/2", "pie/2")).unwrap();
    let (ok, list) = check(&options("left_bent", "side:=left"));
    assert!(
        !ok && field(&list, "U006", "message").contains("'pie' is not defined"),
        "{list:?}"
    );
    fs::write(&macros, &whole).unwrap();

    let whole = fs::read_to_string(&srdf).unwrap();
    let argument = "<xacro:arg name='side' default='right'/>";
    fs::write(&srdf, whole.replace(argument, "")).unwrap();
    let (ok, list) = findings(&urdf, &["--srdf", text(&srdf)]);
    let call = format!("after the robot's file: {} side:=", urdf.display());
    assert!(
        !ok && field(&list, "U006", "help").contains(&call),
        "{list:?}"
    );

    // A file of macros alone says nothing; and no SRDF is a robot.
    let (ok, list) = findings(&urdf, &["--srdf", text(&macros)]);
    assert!(
        ok && field(&list, "R101", "message").contains("only defines macros"),
        "{list:?}"
    );
    let done = urdf2fmu(["check", text(&srdf)]);
    assert!(done.code == 1 && done.err.contains("give the URDF, and this one with --srdf"));
}

/// The FMU holds what was read.
#[test]
fn an_fmu_holds_the_expanded_srdf() {
    let folder = tempfile::tempdir().unwrap();
    let [urdf, srdf] = files(folder.path());
    let fmu = folder.path().join("arm.fmu");
    let done = urdf2fmu([
        "export",
        text(&urdf),
        "-o",
        text(&fmu),
        "--no-documentation",
        "--srdf",
        text(&srdf),
        "side:=left",
    ]);
    assert_eq!(done.code, 0, "{done:?}");
    let (names, files) = entries(&fmu);
    let name = names.iter().find(|name| name.ends_with("arm.srdf"));
    let text = String::from_utf8_lossy(&files[name.expect("an SRDF")]);
    assert!(text.contains("name=\"left_bent\""), "{text}");
}
