//! Messages that are obeyed to the letter: what was told leads to no second message of its kind.
//! Each robot here is one of a public repository made small.

use super::packages::field;
use super::people::{findings, mesh_robot, of_severity, tetrahedron, write};
use super::*;

const ROOT: &str = "<robot xmlns:xacro='http://www.ros.org/wiki/xacro' name='r'>";

/// A robot in xacro with a link.
fn robot(content: &str) -> String {
    format!("{ROOT}\n{content}\n<link name='base_link'/></robot>")
}

/// Every help of the errors, one below the other.
fn helps(list: &[Value]) -> String {
    let errors = of_severity(list, "error").into_iter();
    let helps = errors.filter_map(|finding| finding["help"].as_str());
    helps.collect::<Vec<_>>().join("\n")
}

/// A vehicle under water has eight thrusters: who left the parameter out of the calls, as was told,
/// was told next that its name is not defined, and that 'int' may be meant.
#[test]
fn a_parameter_that_a_macro_uses_and_does_not_list_belongs_into_its_definition() {
    let folder = tempfile::tempdir().unwrap();
    let calls =
        "<xacro:thruster side='l' joint='a' max='1'/><xacro:thruster side='r' joint='b' max='2'/>";
    for (params, both) in [
        ("", "side joint max"),
        ("side", "side joint max"),
        ("joint max:=3", "joint max:=3 side"),
    ] {
        let content = |params: &str| {
            robot(&format!(
                "<xacro:macro name='thruster' params='{params}'>\
                 <gazebo><n side='${{side}}'>${{2*max}} ${{joint}}</n></gazebo>\
                 </xacro:macro>{calls}"
            ))
        };
        let file = write(folder.path(), "r.urdf.xacro", content(params));
        let (ok, list) = findings(&file, &[]);
        assert!(!ok && of_severity(&list, "error").len() == 1, "{list:?}");
        let help = helps(&list);
        let advice = format!("write params=\"{both}\" where it is defined, in ");
        assert!(
            help.contains(&advice) && help.contains("r.urdf.xacro:2"),
            "{help}"
        );
        let file = write(folder.path(), "r.urdf.xacro", content(both));
        let (ok, list) = findings(&file, &[]);
        assert!(ok, "{list:?}");
    }
    // What no expression of the macro names is of no use to it.
    let content = "<xacro:macro name='m' params='a'><n x='${a} ${ab} joint'/></xacro:macro>\
                   <xacro:property name='ab' value='1'/><xacro:m a='1' joint='2'/>";
    let (_, list) = findings(&write(folder.path(), "m.xacro", robot(content)), &[]);
    assert!(helps(&list).contains("leave out joint"), "{list:?}");
}

/// A function is called, so that no bare name stands for one.
#[test]
fn a_function_is_not_meant_by_a_name_that_is_not_called() {
    let folder = tempfile::tempdir().unwrap();
    for (expression, meant) in [
        ("joint", false),
        ("joint + int(2)", false),
        ("itn(2)", true),
    ] {
        let content = robot(&format!("<n x='${{{expression}}}'/>"));
        let (_, list) = findings(&write(folder.path(), "r.xacro", content), &[]);
        assert_eq!(
            helps(&list).contains("did you mean 'int'"),
            meant,
            "{list:?}"
        );
    }
}

/// Macros of releases before ROS Jade needed no prefix. Who wrote the link that joints lack, as was
/// told, had a robot that loads and lacks its body.
#[test]
fn links_of_macros_without_their_prefix_are_not_to_be_written_by_hand() {
    let folder = tempfile::tempdir().unwrap();
    let content = |prefix: &str| {
        format!(
            "{ROOT}\n<xacro:macro name='body'><link name='base_link'/></xacro:macro>\n\
             <{prefix}body/>\n<link name='sonar'/><joint name='j' type='fixed'>\n\
             <parent link='base_link'/><child link='sonar'/></joint></robot>"
        )
    };
    let file = write(folder.path(), "r.urdf.xacro", content(""));
    let (ok, list) = findings(&file, &[]);
    let help = field(&list, "U016", "help");
    assert!(!ok && !help.contains("<link name"), "{help}");
    let advice = format!("write <xacro:body …> in {}:3", file.display());
    assert!(help.contains(&advice), "{help}");
    let file = write(folder.path(), "r.urdf.xacro", content("xacro:"));
    let (ok, list) = findings(&file, &[]);
    assert!(ok, "{list:?}");
}

/// A hand names its package otherwise than it is called, and has most of its meshes below the
/// package's folder. Who made the folder that was told first, with the mesh, hid all others.
#[test]
fn a_mesh_belongs_to_where_others_of_its_package_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(
        root,
        "hand/package.xml",
        "<package><name>hand</name></package>",
    );
    let names = ["palm", "thumb", "ring"].map(|name| format!("package://hand_2/meshes/{name}.STL"));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let file = write(root, "hand/urdf/hand.urdf", mesh_robot(&names));
    for name in ["thumb", "ring"] {
        write(root, &format!("hand/meshes/{name}.STL"), tetrahedron());
    }
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    let help = field(&list, "U104", "help");
    let place = fs::canonicalize(root).unwrap().join("hand/meshes/palm.STL");
    let advice = format!(
        "put it at {}, where 2 others of its package are found",
        place.display()
    );
    assert!(help.starts_with(&advice), "{help}");
    fs::write(place, tetrahedron()).unwrap();
    let (ok, list) = findings(&file, &[]);
    assert!(ok, "{list:?}");
}

/// A vehicle whose sensors were copied from an SDF.
#[test]
fn what_an_sdf_has_as_an_element_is_told_as_an_attribute_with_its_value() {
    let folder = tempfile::tempdir().unwrap();
    let moments = "<ixx>0.3</ixx><iyy>0.3</iyy><izz>0.3</izz>";
    let text = format!(
        "<robot name='r'><link name='a'/><link name='imu'><inertial><mass> 0.015 </mass>\
         <inertia>{moments}<ixy>0.001</ixy></inertia></inertial><collision><geometry><box>\
         <size>0.1  0.2\n0.3</size></box></geometry></collision><collision><geometry><mesh>\
         <uri>model://m/a.stl</uri></mesh></geometry></collision></link>\
         <joint name='j' type='fixed'><parent>a</parent><child>imu</child></joint></robot>"
    );
    let (ok, list) = findings(&write(folder.path(), "r.urdf", text), &[]);
    assert!(!ok);
    let told: Vec<&str> = list
        .iter()
        .filter_map(|finding| finding["help"].as_str())
        .collect();
    for (attribute, place) in [
        ("value=\"0.015\"", "the text"),
        ("ixx=\"0.3\"", "<ixx>"),
        ("iyy=\"0.3\"", "<iyy>"),
        ("izz=\"0.3\"", "<izz>"),
        ("ixy=\"0.001\"", "<ixy>"),
        ("size=\"0.1 0.2 0.3\"", "<size>"),
        ("filename=\"model://m/a.stl\"", "<uri>"),
        ("link=\"a\"", "the text"),
        ("link=\"imu\"", "the text"),
    ] {
        let advice = format!("write {attribute} in place of {place}, which is how an SDF has it");
        assert!(told.contains(&&*advice), "{advice}: {told:?}");
    }
}

/// A package of several drones and a camera, each with a launch file: the first in the order of
/// their names gave the name of the camera to a drone.
#[test]
fn values_come_from_launch_files_that_name_the_robot() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "p/package.xml", "<package><name>p</name></package>");
    for (name, file) in [
        ("camera", "camera"),
        ("drone", "drone"),
        ("zeppelin", "balloon"),
    ] {
        let text = format!(
            "<launch><arg name='name' default='{name}'/><arg name='model' \
             value='$(find p)/urdf/{file}.urdf.xacro'/><param name='d' \
             command=\"xacro '$(arg model)' name:=$(arg name)\"/></launch>"
        );
        write(root, &format!("p/launch/{name}.launch"), text);
    }
    for (file, value) in [
        ("camera", "camera"),
        ("drone", "drone"),
        ("balloon", "zeppelin"),
    ] {
        let name = format!("p/urdf/{file}.urdf.xacro");
        // What stands in a comment asks for nothing.
        let content = robot("<n x='$(arg name)'/><!-- node='$(arg node_name)' -->");
        let (_, list) = findings(&write(root, &name, content), &[]);
        let help = field(&list, "U006", "help");
        let call = format!(".urdf.xacro name:={value}\n");
        assert!(help.contains(&call), "{help}");
    }
}

/// A tractor's old description lies outside of the package that has the files it includes.
#[test]
fn an_included_file_that_the_checkout_has_elsewhere_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join(".git")).unwrap();
    write(
        root,
        "src/car/package.xml",
        "<package><name>car</name></package>",
    );
    let macros = format!("{ROOT}<xacro:macro name='wheel'><link name='w'/></xacro:macro></robot>");
    let there = write(root, "src/car/urdf/macros.xacro", macros);
    let content = "<xacro:include filename='macros.xacro'/><xacro:wheel/>";
    let text = format!("{ROOT}{content}</robot>");
    let file = write(root, "notes/old/robot.urdf.xacro", &text);
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    let help = field(&list, "U006", "help");
    let meant = format!("did you mean '{}'?", there.display());
    assert_eq!(help, meant);
    write(
        root,
        "notes/old/robot.urdf.xacro",
        text.replace("macros.xacro", super::text(&there)),
    );
    assert!(findings(&file, &[]).0);
}

/// A glider whose propellers are macros of a package that is not there: with it, they have no
/// inertia, which was told in the second run, so that a third one was needed.
#[test]
fn what_a_missing_package_may_write_is_told_with_an_option_for_both() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let include = "<xacro:include filename='$(find propellers)/urdf/p.xacro'/>";
    let masses = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' \
                  izz='1'/></inertial>";
    let text = format!(
        "{ROOT}{include}<link name='hull'>{masses}</link><xacro:propeller name='a'/>\
         <xacro:propeller name='b'/></robot>"
    );
    let file = write(root, "glider/r.urdf.xacro", text);
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    let help = field(&list, "U006", "help");
    let advice = "('propeller'): with --missing-mass 0.1 in the same call";
    assert!(
        help.contains("--package propellers=DIR") && help.contains(advice),
        "{help}"
    );
    let propeller = format!(
        "{ROOT}<xacro:macro name='propeller' params='name'><link name='${{name}}'/>\
         <joint name='j_${{name}}' type='continuous'><parent link='hull'/><child link='${{name}}'/>\
         <axis xyz='1 0 0'/></joint></xacro:macro></robot>"
    );
    write(root, "elsewhere/deep/urdf/p.xacro", propeller);
    let package = format!("propellers={}", root.join("elsewhere/deep").display());
    let given = ["--package", &package];
    let (ok, list) = findings(&file, &given);
    assert!(
        !ok && list.iter().any(|finding| finding["code"] == "A104"),
        "{list:?}"
    );
    let (ok, list) = findings(&file, &[&given[..], &["--missing-mass", "0.1"]].concat());
    assert!(ok, "{list:?}");
    // Where nothing of the package is called, there is nothing to expect.
    let text = format!("{ROOT}{include}<link name='hull'/></robot>");
    let (_, list) = findings(&write(root, "glider/s.urdf.xacro", text), &[]);
    assert!(
        !field(&list, "U006", "help").contains("--missing-mass"),
        "{list:?}"
    );
}

/// A loop that is written as two parents.
#[test]
fn a_link_with_two_parents_is_told_with_what_closes_a_loop() {
    let folder = tempfile::tempdir().unwrap();
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='fixed'><parent link='{parent}'/>\
             <child link='{child}'/></joint>"
        )
    };
    let text = format!(
        "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>{}{}{}</robot>",
        joint("x", "a", "b"),
        joint("y", "a", "c"),
        joint("z", "b", "c")
    );
    let (_, list) = findings(&write(folder.path(), "r.urdf", text), &[]);
    let help = field(&list, "U013", "help");
    assert!(
        help.contains("remove one of the two") && help.contains("[[loop]]"),
        "{help}"
    );
}
