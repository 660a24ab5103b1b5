//! Files as programs for design and newcomers write them, beside those of forums: what is said of
//! each leads to one that loads.

use super::forums::lead_to_what_loads;
use super::people::{findings, of_severity, write};
use super::*;

/// A robot of two links with this in its joint and this shape.
fn robot(joint: &str, shape: &str) -> String {
    let inertial = "<inertial><mass value='1'/>\
        <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    format!(
        "<robot name='r'><link name='base'>{inertial}</link><link name='tip'>{inertial}\
         <collision><geometry>{shape}</geometry></collision></link>\
         <joint name='j' type='continuous'><parent link='base'/><child link='tip'/>{joint}</joint>\
         </robot>"
    )
}

#[test]
fn files_of_newcomers_load_after_one_look_at_what_is_said() {
    let mesh = |name: &str| robot("", &format!("<mesh filename='{name}'/>"));
    let sound = mesh("meshes/t.stl");
    let ball = |radius: &str| robot("", &format!("<sphere {radius}/>"));
    let axis = |axis: &str| robot(axis, "<sphere radius='1'/>");
    let cases = [
        (
            axis("<axis <!-- up --> xyz='0 0 1'/>"),
            "a comment within a tag is none: write it before the tag",
            axis("<!-- up --><axis xyz='0 0 1'/>"),
        ),
        (
            axis("<axis xyz='-z'/>"),
            "an axis is written as three numbers",
            axis("<axis xyz='0 0 -1'/>"),
        ),
        (
            ball("diameter='0.2'"),
            "write radius=\"…\", which is half of it",
            ball("radius='0.1'"),
        ),
        (
            mesh("meshes/t.stl?raw=true"),
            "leave ?raw=true out, which is no part of a file's name",
            sound.clone(),
        ),
        (
            mesh("\"meshes/t.stl\""),
            "leave \" out, which is no part of a file's name",
            sound.clone(),
        ),
        (
            mesh("meshes/t.stl.gz"),
            ".gz files are not read: unpack them, and name what is in them",
            sound.clone(),
        ),
        (
            "<launch><param name='robot_description' textfile='r.urdf'/></launch>".to_owned(),
            "this is a launch file: give the URDF or .xacro file that it loads",
            sound.clone(),
        ),
        (
            "<package><name>p</name></package>".to_owned(),
            "this is the manifest of a package: give a URDF or .xacro file of it",
            sound,
        ),
    ];
    lead_to_what_loads("r.urdf", &cases);
}

#[test]
fn a_packed_mesh_that_is_there_is_told_to_be_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "m.zae", "PK");
    let file = write(
        folder.path(),
        "r.urdf",
        robot("", "<mesh filename='m.zae'/>"),
    );
    let (_, list) = findings(&file, &[]);
    let told = of_severity(&list, "error");
    assert_eq!(told[0]["help"], "unpack the file, and name what is in it");
}

#[test]
fn a_turn_by_four_numbers_is_told_how_a_urdf_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let turned = |origin: &str| robot(origin, "<sphere radius='1'/>");
    let file = write(folder.path(), "r.urdf", turned("<origin quat='0 0 1 0'/>"));
    let (_, list) = findings(&file, &[]);
    let advice = "write quat_xyzw=\"x y z w\", with <robot version=\"1.1\">, or rpy";
    assert!(list.iter().any(|f| f["help"] == advice), "{list:?}");
    let good =
        turned("<origin quat_xyzw='0 0 1 0'/>").replace("name='r'", "name='r' version='1.1'");
    let file = write(folder.path(), "r.urdf", good);
    assert!(
        findings(&file, &["--deny", "warnings", "--floating-base"])
            .1
            .iter()
            .all(|f| f["code"] != "U019")
    );
}

#[test]
fn addresses_in_place_of_a_file_are_told_as_such() {
    for (name, said) in [
        (
            "https://example.org/r.urdf",
            "nothing is downloaded: fetch the file, and give its path",
        ),
        (
            "file:///nowhere/r.urdf",
            "write the path alone: /nowhere/r.urdf",
        ),
        (
            "package://arm/r.urdf",
            "give the path of the file: only names within it may be of packages",
        ),
    ] {
        let run = run(&["check", name]);
        assert!(
            run.code == 1 && run.err.contains(said),
            "{name}: {}",
            run.err
        );
    }
}

/// As in a workspace of ROS that was copied without what it was built from.
#[cfg(unix)]
#[test]
fn a_symbolic_link_to_nothing_is_told_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["r.urdf", "r.xacro", "macros.xacro"] {
        std::os::unix::fs::symlink("gone/there", root.join(name)).unwrap();
    }
    let include = "<robot xmlns:xacro='http://wiki.ros.org/xacro' name='r'>\
                   <xacro:include filename='macros.xacro'/></robot>";
    write(root, "all.xacro", include);
    let said = format!(
        "a symbolic link to {}, where",
        root.join("gone/there").display()
    );
    for name in ["r.urdf", "r.xacro", "all.xacro"] {
        let run = run(&["check", text(&root.join(name))]);
        assert!(
            run.code == 1 && run.err.contains(&said),
            "{name}: {}",
            run.err
        );
    }
}

/// The Panda beside an arm of another maker: links of both are called `link0`, `link1`, ….
#[test]
fn meshes_of_another_package_are_not_offered_in_part() {
    let folder = tempfile::tempdir().unwrap();
    let root = &folder.path().join("home/of");
    for package in ["panda", "piper"] {
        let manifest = format!("<package><name>{package}</name></package>");
        write(root, &format!("{package}/package.xml"), manifest);
    }
    let names = ["meshes/link0.stl", "meshes/link1.stl"];
    let file = write(root, "panda/urdf/r.urdf", super::people::mesh_robot(&names));
    for (name, offered) in [("link0.stl", false), ("link1.stl", true)] {
        let mesh = super::people::tetrahedron();
        write(root, &format!("piper/meshes/{name}"), mesh);
        let (_, list) = findings(&file, &[]);
        let help = super::packages::field(&list, "U104", "help");
        assert_eq!(help.contains("finds all of them"), offered, "{help}");
        assert_eq!(help.contains("piper"), offered, "{help}");
    }
}

/// Quadrupeds of Unitree in xacro: `{name}` is text.
#[test]
fn an_expression_without_its_sign_is_told_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let text = robot("", "<sphere radius='1'/>").replace(
        "</robot>",
        "<gazebo reference='{name}_hip'/><transmission name='t'><joint name='{name}_knee'/>\
         </transmission></robot>",
    );
    let (_, list) = findings(&write(folder.path(), "r.urdf", text), &[]);
    let told = list.iter().filter(|f| f["code"] == "U021");
    let told: Vec<_> = told.map(|finding| &finding["help"]).collect();
    let advice = "an expression of xacro begins with a dollar sign: ${…}";
    assert_eq!(told, [advice, advice], "{list:?}");
}
