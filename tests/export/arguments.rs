//! What a file in xacro lacks, with what its package says of it: values of arguments, files and
//! packages in other letters, a file without an element, and macros without an end.

use super::packages::field;
use super::people::{findings, of_severity, write};
use super::*;

const ROOT: &str = "<robot xmlns:xacro='http://wiki.ros.org/xacro' name='r'>";

fn robot(content: &str) -> String {
    format!("{ROOT}{content}<link name='l'/></robot>")
}

/// Launch files give the values with which a description is expanded; who follows what is told
/// needs two runs.
#[test]
fn arguments_are_told_with_the_values_that_launch_files_give() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "car/package.xml", "<name>car</name>");
    write(
        root,
        "car/launch/a.launch",
        "<launch><arg name='rate' default='50'/><param name='robot_description' command=\"xacro \
         car.xacro colour:='red' rate:='$(arg rate)' old_side:=right\"/></launch>",
    );
    write(
        root,
        "car/launch/b.launch.py",
        "DeclareLaunchArgument(\n  \"side\",\n  default_value=\"left\")\n\
         Command([\"xacro \", path, \" side:=\", side])",
    );
    write(
        root,
        "car/urdf/other.xacro",
        robot("<xacro:arg name='wide' default='2'/>"),
    );
    let content = "<a x='$(arg colour) $(arg rate) $(arg side) $(arg wide) $(arg nobody)'/>\
                   <xacro:if value='$(arg hat)'/>";
    let file = write(root, "car/urdf/car.xacro", robot(content));
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    let help = field(&list, "U006", "help");
    let call = "car.xacro colour:=red hat:=false nobody:=… rate:=50 side:=left wide:=2\n";
    assert!(help.contains(call), "{help}");
    let launch = root.join("car/launch/a.launch");
    let reason = format!("colour:=red is what {} gives", launch.display());
    assert!(help.contains(&reason), "{help}");
    assert!(help.contains("hat is a condition: true or false"), "{help}");
    let values = [
        "colour:=red",
        "hat:=false",
        "nobody:=1",
        "rate:=50",
        "side:=left",
        "wide:=2",
    ];
    assert!(findings(&file, &values).0);
}

/// File systems that do not tell upper and lower case apart hide that a name is written otherwise.
#[test]
fn files_and_packages_in_other_upper_and_lower_case_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for package in ["with/package.xml", "without/readme.txt"] {
        write(root, package, "<name>with</name>");
        let inner = root.join(package);
        let inner = inner.parent().unwrap();
        write(
            inner,
            "parts.trans",
            robot("<xacro:property name='x' value='1'/>"),
        );
        let content = "<xacro:include filename='Parts.trans'/><a x='${x}'/>";
        let text = robot(content).replace("<link name='l'/>", "");
        let (ok, list) = findings(&write(inner, "r.xacro", text), &[]);
        assert!(ok, "{list:?}");
        let moved = field(&list, "U118", "message");
        assert!(
            moved.contains("parts.trans is read in its place"),
            "{moved}"
        );
    }
    let content = "<a x='$(find With)'/>";
    let file = write(root, "without/p.xacro", robot(content));
    let help = field(&findings(&file, &[]).1, "U006", "help");
    let place = root.join("with");
    let option = format!("With={}", text(&place));
    assert!(help.contains(&option), "{help}");
    assert!(findings(&file, &["--package", &option]).0);
}

/// Neither was told with what it is, only that the xacro program may know more.
#[test]
fn a_file_without_an_element_and_one_with_another_root_are_told_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "package.xml", "<name>p</name>");
    let file = write(root, "none.xacro", "<!-- nothing -->");
    let help = field(&findings(&file, &[]).1, "U006", "help");
    assert!(help.contains("one element around all others"), "{help}");
    let part = "<root xmlns:xacro='http://wiki.ros.org/xacro'><xacro:property name='x' \
                value='1'/></root>";
    let file = write(root, "part.xacro", part);
    write(
        root,
        "whole.xacro",
        robot("<xacro:include filename='part.xacro'/>"),
    );
    let help = field(&findings(&file, &[]).1, "U007", "help");
    assert!(
        help.contains("give a file that includes this one"),
        "{help}"
    );
    assert!(help.contains("whole.xacro"), "{help}");
}

/// Macros that call themselves within calls that are wrong went on for seconds: each wrong call was
/// told, or known, and the next looked into.
#[test]
fn macros_that_call_themselves_within_wrong_calls_end_soon() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = "<xacro:none/>".repeat(3);
    let calls = "<xacro:ab><xacro:b/></xacro:ab>".repeat(3);
    let content = format!(
        "<xacro:macro name='a' params='*k'>{calls}<xacro:a/></xacro:macro>\
         <xacro:macro name='b' params='*k'>{wrong}</xacro:macro>\
         <xacro:macro name='ab' params=''><xacro:none y='${{y}}'/></xacro:macro><xacro:a/>"
    );
    let file = write(folder.path(), "r.xacro", robot(&content));
    let start = std::time::Instant::now();
    let (ok, list) = findings(&file, &[]);
    assert!(!ok && !of_severity(&list, "error").is_empty(), "{list:?}");
    let seconds = start.elapsed().as_secs_f64();
    assert!(seconds < 20.0, "{seconds} s");
}
