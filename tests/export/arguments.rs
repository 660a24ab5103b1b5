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

/// As xacro 2.1.1 has them: what an argument or a variable has given is looked through for
/// `$(find …)` once more, and for nothing else.
#[test]
fn packages_in_the_values_of_arguments_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "src/arm/package.xml", "<name>arm</name>");
    write(root, "src/grip/package.xml", "<name>grip</name>");
    let content = "<xacro:arg name='p' default=''/><xacro:property name='q' value='$(arg p)'/>\
                   <xacro:macro name='m' params=\"b:='$(arg p)'\"><link name='m_${b}'/></xacro:macro>\
                   <link name='a_$(arg p)'/><link name='b_${q}/z'/><link name=\"c_${xacro.arg('p')}\"/>\
                   <xacro:m/>";
    let file = write(root, "src/arm/urdf/r.xacro", robot(content));
    let grip = root.join("src/grip").canonicalize().unwrap();
    let grip = grip.display();
    let expand = |value: &str| {
        let done = urdf2fmu(["expand", text(&file), value]);
        assert_eq!(done.code, 0, "{done:?}");
        done.out
    };
    let out = expand("p:=$(find grip)/x");
    for name in ["a_%/x", "b_%/x/z", "m_%/x"] {
        let link = format!("<link name=\"{}\"/>", name.replace('%', &grip.to_string()));
        assert!(out.contains(&link), "{out}");
    }
    assert!(out.contains("<link name=\"c_$(find grip)/x\"/>"), "{out}");
    let (ok, list) = findings(&file, &["p:=$(find grap)/x"]);
    let message = field(&list, "U006", "message");
    assert!(
        !ok && message.contains("the package 'grap' is not found"),
        "{message}"
    );
}

/// Who follows what is said of a dictionary reads neither Python nor the manual of xacro.
#[test]
fn a_key_that_a_file_does_not_have_is_told_with_those_that_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "a.yaml", "wheel:\n  radius: 0.1\n  width: 0.2\n");
    write(root, "tab.yaml", "wheel:\n\tradius: 0.1\n");
    let told = |file: &str, value: &str| {
        let content = format!(
            "<xacro:property name='c' value=\"${{xacro.load_yaml('{file}')}}\"/><a x=\"${{{value}}}\"/>"
        );
        let file = write(root, "r.xacro", robot(&content));
        let (ok, list) = findings(&file, &[]);
        assert!(!ok && of_severity(&list, "error").len() == 1, "{list:?}");
        ["message", "help"].map(|name| field(&list, "U006", name))
    };
    for value in ["c['wheel']['raduis']", "c.wheel.raduis"] {
        let [message, help] = told("a.yaml", value);
        let meant = "the dictionary has no key 'raduis': did you mean 'radius'?, in ";
        assert!(message.contains(meant), "{message}");
        assert!(help.starts_with("correct the key"), "{help}");
    }
    let [message, _] = told("a.yaml", "c['mass']");
    assert!(
        message.contains("no key 'mass', only 'wheel', in "),
        "{message}"
    );
    let [message, help] = told("tab.yaml", "c['wheel']");
    assert!(message.contains("tab.yaml: tabs "), "{message}");
    assert!(help.starts_with("correct that file"), "{help}");
}

/// The tools of the Stretch 4: a URDF that is a part of a robot in xacro, which says where its
/// meshes are.
#[test]
fn meshes_below_an_argument_are_asked_for_with_the_folder_that_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let meshes = root.join("a robot/tool/meshes");
    write(&meshes, "t.stl", super::people::tetrahedron());
    // Another tool has a file of the same name.
    write(root, "a robot/other/meshes/t.stl", "solid");
    write(root, "a robot/package.xml", "<name>stretch</name>");
    let urdf = super::people::mesh_robot(&["$(arg mesh_dir)/t.stl"]);
    let file = write(root, "a robot/tool/tool.urdf", urdf);
    let whole = write(
        root,
        "a robot/all.xacro",
        robot("<xacro:include filename='tool/tool.urdf'/>"),
    );
    let (ok, list) = findings(&file, &[]);
    let errors = of_severity(&list, "error");
    assert!(!ok && errors.len() == 1, "{list:?}");
    let help = field(&list, "U006", "help");
    let call = format!("tool.urdf' mesh_dir:='{}'", meshes.display());
    assert!(help.contains(&call), "{help}");
    let or = format!("or give a file that includes this one:\n{}", text(&whole));
    assert!(help.ends_with(&or), "{help}");
    let given = format!("mesh_dir:={}", meshes.display());
    let (ok, list) = findings(&file, &[&given]);
    assert!(ok, "{list:?}");
}

/// The Stretch 4 as a whole: a launch file composes the folders of its parts.
#[test]
fn a_file_that_is_missing_by_arguments_within_each_other_is_told_with_all_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(
        folder.path(),
        "r.xacro",
        robot(
            "<xacro:arg name='batch' default='none'/><xacro:arg name='home' default='nowhere'/>\
             <xacro:arg name='of_model' default='$(arg home)/SE4_$(arg batch)'/>\
             <xacro:include filename='$(arg of_model)/main.xacro'/>",
        ),
    );
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    assert_eq!(
        field(&list, "U006", "help"),
        "its path is made of arguments, batch ('none'), home ('nowhere'): give other ones after \
         the file, batch:=… home:=…"
    );
}
