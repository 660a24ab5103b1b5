//! Packages in workspaces as people have them, and what else their robots were refused for.

use super::packages::field;
use super::people::{findings, mesh_robot, of_severity, tetrahedron, write};
use super::*;

const LINK: &str = "<link name='base'><collision><geometry><box size='0.1 0.1 0.1'/></geometry>\
                    </collision></link>";

/// `package://` and `$(find)` look in the same workspace.
#[test]
fn packages_of_a_workspace_are_found_by_meshes_and_by_xacro() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "ws/src/cfg/arm/package.xml", "<name>arm</name>");
    write(
        root,
        "ws/src/deps/repo/grip/package.xml",
        "<name>grip</name>",
    );
    write(root, "ws/src/deps/repo/grip/meshes/a.stl", tetrahedron());
    let grip = mesh_robot(&["package://grip/meshes/a.stl"]);
    write(root, "ws/src/deps/repo/grip/urdf/grip.xacro", &grip);
    // What the robot has under the same name is another mesh.
    write(root, "ws/src/cfg/arm/meshes/a.stl", "no mesh");
    let robot = write(root, "ws/src/cfg/arm/urdf/r.urdf", &grip);
    let (ok, list) = findings(&robot, &[]);
    assert!(ok && !list.iter().any(|f| f["code"] == "U118"), "{list:?}");
    let xacro = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\
                 <xacro:include filename='$(find grip)/urdf/grip.xacro'/></robot>";
    let robot = write(root, "ws/src/cfg/arm/urdf/r.urdf.xacro", xacro);
    let (ok, list) = findings(&robot, &[]);
    assert!(ok, "{list:?}");
    // A second one that is as near.
    write(
        root,
        "ws/src/deps/fork/grip/package.xml",
        "<name>grip</name>",
    );
    write(root, "ws/src/deps/fork/grip/meshes/a.stl", tetrahedron());
    let robot = root.join("ws/src/cfg/arm/urdf/r.urdf");
    let (ok, list) = findings(&robot, &[]);
    let message = field(&list, "U118", "message");
    assert!(
        ok && message.starts_with("package 'grip' is at "),
        "{message}"
    );
    let first = message.find("fork").zip(message.find("repo"));
    assert!(first.is_some_and(|(fork, repo)| fork < repo), "{message}");
    // Where xacro looks for it, too, with the place that names it.
    write(root, "ws/src/deps/fork/grip/urdf/grip.xacro", &grip);
    let robot = root.join("ws/src/cfg/arm/urdf/r.urdf.xacro");
    let (ok, list) = findings(&robot, &[]);
    let remarks: Vec<_> = list.iter().filter(|f| f["code"] == "U118").collect();
    assert!(ok && remarks.len() == 1, "{remarks:?}");
    assert_eq!(remarks[0]["message"], message);
    assert_eq!(remarks[0]["severity"], "warning");
    assert!(
        remarks[0]["file"]
            .as_str()
            .unwrap()
            .ends_with("r.urdf.xacro")
    );
    let named = format!("grip={}", root.join("ws/src/deps/repo/grip").display());
    let (ok, list) = findings(&robot, &["--package", &named]);
    assert!(ok && !list.iter().any(|f| f["code"] == "U118"), "{list:?}");
}

/// A robot that was copied out of its workspace takes what lies around: that is told, and where.
#[test]
fn a_package_outside_of_any_workspace_is_told_with_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "tools/grip/package.xml", "<name>grip</name>");
    write(root, "tools/grip/meshes/a.stl", tetrahedron());
    let grip = mesh_robot(&["package://grip/meshes/a.stl"]);
    write(root, "tools/grip/urdf/grip.xacro", &grip);
    let plain = write(root, "copied/arm/urdf/r.urdf", &grip);
    let xacro = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\
                 <xacro:include filename='$(find grip)/urdf/grip.xacro'/></robot>";
    let xacro = write(root, "copied/arm/urdf/r.urdf.xacro", xacro);
    let place = root.join("tools/grip").canonicalize().unwrap();
    for robot in [plain, xacro] {
        let (ok, list) = findings(&robot, &[]);
        assert!(ok, "{list:?}");
        let message = field(&list, "U118", "message");
        let taken = format!("package 'grip' is taken from {},", place.display());
        assert!(message.starts_with(&taken), "{message}");
        assert_eq!(field(&list, "U118", "severity"), "note");
    }
}

/// `$(env LIDAR_TYPE)` of many mobile robots.
#[test]
fn a_variable_that_is_not_set_is_told_with_the_call_that_sets_it() {
    let folder = tempfile::tempdir().unwrap();
    let text_of = |condition: &str| {
        format!(
            "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\
             <xacro:property name='lidar' value='$(env URDF2FMU_NO_LIDAR)'/>{LINK}\
             <xacro:if value=\"{condition}\"><link name='laser'/></xacro:if></robot>"
        )
    };
    for (condition, value) in [
        ("${lidar in ['A1', 'A2']}", "A1"),
        ("${lidar == 'ld19'}", "ld19"),
        ("${'$(env URDF2FMU_NO_LIDAR)' == 'x4'}", "x4"),
        ("${len(lidar) > 2}", "…"),
    ] {
        let robot = write(folder.path(), "r.urdf.xacro", text_of(condition));
        let help = field(&findings(&robot, &[]).1, "U006", "help");
        let call = format!("URDF2FMU_NO_LIDAR={value} urdf2fmu …");
        assert!(help.ends_with(&call) && !help.contains("ROS"), "{help}");
    }
}

#[test]
fn a_call_of_a_macro_without_its_prefix_is_told_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let robot = format!(
        "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\
         <xacro:macro name='arm' params='parent'><link name='arm'/></xacro:macro>\n{LINK}\n\
         <arm parent='base'/>\n<leg parent='base'/></robot>"
    );
    let robot = write(folder.path(), "r.urdf.xacro", robot);
    let (ok, list) = findings(&robot, &[]);
    assert!(ok, "{list:?}");
    let helps: Vec<&str> = list
        .iter()
        .filter(|finding| finding["code"] == "U019")
        .filter_map(|finding| finding["help"].as_str())
        .collect();
    let [arm, leg] = helps[..] else {
        panic!("{list:?}")
    };
    assert!(arm.contains("write <xacro:arm …>"), "{arm}");
    assert!(!leg.contains("write <xacro"), "{leg}");
}

#[test]
fn meshes_of_a_format_that_is_not_read_name_those_beside_them_once() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["a.wrl", "b.wrl", "c.wrl"] {
        write(root, name, "#VRML V2.0 utf8");
    }
    let robot = write(root, "r.urdf", mesh_robot(&["a.wrl", "b.wrl", "c.wrl"]));
    let (_, list) = findings(&robot, &[]);
    assert_eq!(of_severity(&list, "error").len(), 1, "{list:?}");
    assert!(field(&list, "U106", "message").contains("cannot be read, nor 2 more: '.wrl'"));
    assert_eq!(
        field(&list, "U106", "help"),
        "convert the mesh to STL or OBJ"
    );
    write(root, "a.stl", tetrahedron());
    write(root, "b.OBJ", "");
    let help = field(&findings(&robot, &[]).1, "U106", "help");
    assert!(help.contains("a.stl lies beside it"), "{help}");
    assert!(
        help.ends_with("for 1 more; convert the other 1 to STL or OBJ"),
        "{help}"
    );
    let visual = mesh_robot(&["a.wrl"]).replace("collision>", "visual>");
    let robot = write(root, "v.urdf", visual);
    let help = field(&findings(&robot, &[]).1, "U116", "help");
    assert!(help.contains("a.stl lies beside it"), "{help}");
}

#[test]
fn a_visual_mesh_outside_of_the_robot_s_folders_is_told_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let mesh = write(root, "others/a.stl", tetrahedron());
    let there = mesh_robot(&[&format!("file://{}", mesh.display())]);
    let robot = write(root, "bot/r.urdf", there.replace("collision>", "visual>"));
    let message = field(&findings(&robot, &[]).1, "U111", "message");
    assert!(
        message.starts_with("visual mesh outside of the robot's folders"),
        "{message}"
    );
    fs::remove_file(mesh).unwrap();
    let message = field(&findings(&robot, &[]).1, "U111", "message");
    assert!(message.starts_with("visual mesh not found"), "{message}");
}
