//! Files as people post them in forums and lists of issues: what is said of each leads to one that
//! loads, in one call.

use super::people::{tetrahedron, write};
use super::*;

const INERTIAL: &str = "<inertial><mass value='1'/>\
    <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";

/// A robot of two links, whose joint and second link hold what is given.
fn robot(joint: &str, link: &str) -> String {
    format!(
        "<robot name='r'><link name='base'>{INERTIAL}</link><link name='tip'>{INERTIAL}{link}</link>\
         <joint name='j' type='revolute'><parent link='base'/><child link='tip'/>\
         <limit lower='-1' upper='1' effort='1' velocity='1'/>{joint}</joint></robot>"
    )
}

/// What `check` says of each text contains the part, and it says nothing of U066; the mended text
/// loads.
pub(super) fn lead_to_what_loads(name: &str, cases: &[(String, &str, String)]) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "meshes/t.stl", tetrahedron());
    write(
        folder.path(),
        "common.xacro",
        "<robot xmlns:xacro='x'><xacro:macro name='frame' params='name *place'>\
         <link name='${name}'/></xacro:macro></robot>",
    );
    write(
        folder.path(),
        "arm/package.xml",
        "<package><name>arm</name></package>",
    );
    write(folder.path(), "arm/part.xacro", "<robot xmlns:xacro='x'/>");
    for (text, part, mended) in cases {
        let path = write(folder.path(), name, text);
        let run = run_in(folder.path(), &["check", super::text(&path)], &[]);
        // Long advice is in lines; none of the parts tells of two things.
        let said = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(part), "{text}: {part}: {}", run.err);
        assert!(!said.contains("U066"), "{text}: {}", run.err);
        assert_eq!(run.code, 1, "{text}: {}", run.err);
        let path = write(folder.path(), name, mended);
        let run = run_in(folder.path(), &["check", super::text(&path)], &[]);
        assert_eq!(run.code, 0, "{mended}: {}", run.err);
    }
}

#[test]
fn urdfs_of_forums_load_after_one_look_at_what_is_said() {
    let plain = || robot("", "");
    let mimic = |of: &str| {
        let limit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
        plain().replace(
            "</robot>",
            &format!(
                "<link name='end'>{INERTIAL}</link><joint name='k' type='revolute'>\
                 <parent link='tip'/><child link='end'/>{limit}<mimic joint='{of}'/></joint></robot>"
            ),
        )
    };
    let prefixed = plain()
        .replace("</", "</u:")
        .replace('<', "<u:")
        .replace("<u:/u:", "</u:");
    lead_to_what_loads(
        "r.urdf",
        &[
            (
                robot("<origin xyz='0 0 \u{2212}0.1'/>", ""),
                "its sign is U+2212, not a hyphen: write -0.1",
                robot("<origin xyz='0 0 -0.1'/>", ""),
            ),
            (
                prefixed,
                "leave the prefix 'u:' out of the names of all elements",
                plain(),
            ),
            (
                format!(
                    "<launch><param name='robot_description'>{}</param></launch>",
                    plain()
                ),
                "put the <robot> of line 1 into a file of its own",
                plain(),
            ),
            (
                plain().replace("'tip'", "'tip&nbsp;1'"),
                "there is no entity &nbsp;",
                plain().replace("'tip'", "'tip&#160;1'"),
            ),
            (
                format!(
                    "<!DOCTYPE robot [<!ENTITY m '1'>]>{}",
                    plain().replace("'1'/>", "'&m;'/>")
                ),
                "write out what the entity stands for",
                plain(),
            ),
            (
                format!(
                    "<!DOCTYPE robot [<!ENTITY arm SYSTEM 'arm.xml'>]>{}",
                    plain().replace("</robot>", "&arm;</robot>")
                ),
                "help: write out what the entity stands for",
                plain(),
            ),
            (
                mimic("tip"),
                "that is a link, which joint 'j' moves",
                mimic("j"),
            ),
            (
                plain().replace("<mass value='1'/>", "<mass>1</mass>"),
                "write <mass value=\"1\"/>",
                plain(),
            ),
            (
                plain().replace("<mass value='1'/>", "<mass value='1 kg'/>"),
                "write the number alone",
                plain(),
            ),
            (
                plain().replace(
                    "type='revolute'><parent link='base'/><child link='tip'/>",
                    "type='revolute' parent='base' child='tip'>",
                ),
                "add <parent link=\"base\"/>",
                plain(),
            ),
        ],
    );
}

#[test]
fn shapes_of_forums_load_after_one_look_at_what_is_said() {
    let mesh = |name: &str| {
        let shape = format!("<geometry><mesh filename='{name}'/></geometry>");
        robot("", &format!("<collision>{shape}</collision>"))
    };
    let shape = |shape: &str| {
        robot(
            "",
            &format!("<collision><geometry>{shape}</geometry></collision>"),
        )
    };
    lead_to_what_loads(
        "r.urdf",
        &[
            (
                mesh("$(find arm)/../meshes/t.stl"),
                "write package://arm/../meshes/t.stl",
                mesh("package://arm/../meshes/t.stl"),
            ),
            (
                mesh("https://example.org/t.stl"),
                "nothing is downloaded: put the file beside the URDF",
                mesh("meshes/t.stl"),
            ),
            (
                shape("<plane normal='0 0 1'/>"),
                "leave the plane out, or write a large <box>",
                shape("<box size='10 10 0.1'/>"),
            ),
            (
                shape("<ellipsoid radii='1 2 3'/>"),
                "write a <mesh> of it",
                shape("<mesh filename='meshes/t.stl' scale='1 2 3'/>"),
            ),
        ],
    );
}

#[test]
fn xacro_of_forums_loads_after_one_look_at_what_is_said() {
    let file = |inside: &str| {
        format!(
            "<robot name='r' xmlns:xacro='x'><xacro:include filename='common.xacro'/>{inside}\
             <link name='base'>{INERTIAL}</link></robot>"
        )
    };
    lead_to_what_loads(
        "r.xacro",
        &[
            (
                file("<xacro:frame name='f'/>").replace("'base'", "'f'"),
                "write an element for it between the tags of the call",
                file("<xacro:frame name='base'><origin/></xacro:frame>")
                    .replace(&format!("<link name='base'>{INERTIAL}</link>"), ""),
            ),
            (
                file("<xacro:include filename='$(find-pkg-share arm)/part.xacro'/>"),
                "that is of launch files: xacro writes $(find NAME)",
                file("<xacro:include filename='$(find arm)/part.xacro'/>"),
            ),
            (
                file("<xacro:include filename='package://arm/part.xacro'/>"),
                "xacro names it $(find arm)/part.xacro",
                file("<xacro:include filename='$(find arm)/part.xacro'/>"),
            ),
            (
                file("<link_of mass='${mas}'/><xacro:property name='mass' value='1'/>"),
                "did you mean 'mass'? it is defined behind this, in line 1: put the definition",
                file("<xacro:property name='mass' value='1'/><link_of mass='${mass}'/>"),
            ),
            (
                file("<macro name='m' params='n:=1'><link name='${n}'/></macro>"),
                "write <xacro:macro name=\"m\" …>, and call it by <xacro:m …/>",
                file("<xacro:macro name='m' params='n:=1'><link name='${n}'/></xacro:macro>"),
            ),
        ],
    );
}

/// What is found in the tree was placed at the first element of the line.
#[test]
fn in_a_urdf_of_one_line_the_element_is_told_and_not_the_line() {
    let folder = tempfile::tempdir().unwrap();
    for filling in ["", "<gazebo/>"] {
        let text = robot("", "").replace("name='r'", "name='arm'");
        let text = text.replace(
            "<link name='base'",
            &(filling.repeat(2000) + "<link name='base'"),
        );
        let path = write(folder.path(), "r.urdf", &text);
        let run = run(&["check", "--json", super::text(&path)]);
        let found: Value = serde_json::from_str(&run.out).unwrap();
        let found = found["findings"].as_array().unwrap();
        let falls = found.iter().find(|f| f["code"] == "A107").unwrap();
        let at = text.find("<link name='base'").unwrap();
        assert_eq!(falls["column"], at + 1, "{falls}");
        assert_eq!(falls["length"], "<link name='base'>".len());
        // The same for people, also where the line is too long to show.
        let shown = run_in(folder.path(), &["check", super::text(&path)], &[]).out;
        assert!(shown.contains(&format!("r.urdf:1:{}]", at + 1)), "{shown}");
    }
}

/// The message names the base first, and tells of the joint.
#[test]
fn in_a_urdf_of_one_line_a_finding_of_a_joint_is_at_the_joint() {
    let folder = tempfile::tempdir().unwrap();
    let joint = "<joint name='j' type='floating'>";
    let text = robot("", "").replace("<joint name='j' type='revolute'>", joint);
    let path = write(folder.path(), "r.urdf", &text);
    let (_, list) = super::people::findings(&path, &[]);
    let falls = list.iter().find(|f| f["code"] == "A107").unwrap();
    let message = falls["message"].as_str().unwrap();
    assert!(message.starts_with("the base 'base'") && message.contains("joint 'j'"));
    assert_eq!(falls["column"], text.find(joint).unwrap() + 1, "{falls}");
    assert_eq!(falls["length"], joint.len(), "{falls}");
}
