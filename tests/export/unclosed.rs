//! Texts that are no XML in several places: each place is told in the first run.

use super::people::{findings, of_severity, write};
use super::*;

fn places(list: &[Value]) -> Vec<u64> {
    let errors = of_severity(list, "error");
    let mut lines: Vec<u64> = errors.iter().filter_map(|f| f["line"].as_u64()).collect();
    lines.dedup();
    lines
}

/// An element without its end in each of two links and a joint, as careless editing leaves them.
#[test]
fn an_end_that_is_missing_in_each_of_several_links_is_told_for_each() {
    let folder = tempfile::tempdir().unwrap();
    let lines = [
        "<robot name='r'><link name='a'><visual>",
        "<geometry><box size='1 1 1'/></geometry></visual></link>",
        "<link name='b'><collision><geometry>",
        "<box size='1 1 1'/></geometry></collision></link>",
        "<joint name='j' type='fixed'><parent link='a'/><child link='b'/>",
        "<origin xyz='0 0 1'></origin></joint></robot>",
    ];
    let whole = lines.join("\n");
    assert!(findings(&write(folder.path(), "r.urdf", &whole), &[]).0);
    let faults = [
        ("</geometry></visual>", "</visual>"),
        ("</collision>", ""),
        ("</origin>", ""),
    ];
    let check = |faults: &[(&str, &str)]| {
        let mut text = whole.clone();
        for (sound, broken) in faults {
            text = text.replacen(sound, broken, 1);
        }
        places(&findings(&write(folder.path(), "r.urdf", text), &[]).1)
    };
    assert_eq!(check(&faults), [2, 4, 6]);
    // Each alone is one error.
    for (fault, line) in faults.iter().zip([2, 4, 6]) {
        assert_eq!(check(&[*fault]), [line]);
    }
}

/// A quotation mark and a bracket that are missing took in the rest of a file in xacro.
#[test]
fn a_mark_that_is_missing_in_xacro_hides_no_other_fault() {
    let folder = tempfile::tempdir().unwrap();
    let lines = [
        "<robot xmlns:xacro='http://wiki.ros.org/xacro' name='r'>",
        "<xacro:property name=\"a\" value=\"1\"/>",
        "<xacro:macro name='m' params='x'><link name='${x}'/></xacro:macro>",
        "<xacro:m x='b'/>",
        "<link name='c'><inertial><origin xyz='0 0 0'/>",
        "<mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>",
        "<joint name='j' type='fixed'><parent link='b'/><child link='c'/></joint>",
        "</robot>",
    ];
    let whole = lines.join("\n");
    assert!(findings(&write(folder.path(), "r.xacro", &whole), &[]).0);
    let told = |faults: &[(&str, &str)]| {
        let mut text = whole.clone();
        for (sound, broken) in faults {
            text = text.replacen(sound, broken, 1);
        }
        findings(&write(folder.path(), "r.xacro", text), &[]).1
    };
    let quote = ("name=\"a\" value", "name=\"a value");
    let late = ("value=\"1\"", "value=\"1");
    let bracket = ("xyz='0 0 0'/>", "xyz='0 0 0'");
    for mark in [quote, late, bracket] {
        let list = told(&[mark]);
        let errors = of_severity(&list, "error");
        assert_eq!(errors.len(), 1, "{mark:?}: {list:?}");
        let help = errors[0]["help"].as_str().unwrap();
        assert!(help.contains("a quotation mark"), "{help}");
        // The other fault is an error or, where the mark may be its cause, what may be wrong, too.
        let call = ("<xacro:m x=", "<xacro:mm x=");
        let parameter = ("params='x'", "params='y'");
        for other in [call, parameter] {
            let list = told(&[mark, other]);
            let of_it = |f: &Value| {
                let told = f["code"] == "U006" && f["line"] == 4;
                told || f["help"].to_string().contains("r.xacro:4: ")
            };
            assert!(list.iter().any(of_it), "{mark:?} {other:?}: {list:?}");
        }
    }
    // The donut of Clearpath's sample.
    let (_, list) = {
        let text = whole.replacen("params='x'>", "params='x'/>", 1);
        findings(&write(folder.path(), "r.xacro", text), &[])
    };
    let ends = list
        .iter()
        .find(|f| f["message"].to_string().contains("ends nothing"));
    let help = ends.unwrap()["help"].as_str().unwrap().to_owned();
    assert!(help.contains("<xacro:macro …/> in line 3"), "{help}");
}

/// What is left out is looked into: a macro that is called by a wrong name, and the inertia beside
/// a mass whose name is wrong.
#[test]
fn what_a_wrong_name_leaves_out_is_looked_into() {
    let folder = tempfile::tempdir().unwrap();
    let robot = |call: &str| {
        format!(
            "<robot xmlns:xacro='http://wiki.ros.org/xacro' name='r'>\n\
             <xacro:macro name='wheel' params='x'>\n<link name='${{x}}${{side}}'/></xacro:macro>\n\
             <xacro:property name='seite' value='_left'/>\n<xacro:{call} x='a'/></robot>"
        )
    };
    let file = write(folder.path(), "r.xacro", robot("wheeel"));
    let (_, list) = findings(&file, &[]);
    let maybe = super::packages::field(&list, "U068", "help");
    assert!(
        maybe.contains("r.xacro:3: name 'side' is not defined"),
        "{maybe}"
    );
    // Without a fault of its own nothing more is told.
    let text = robot("wheeel").replace("seite", "side");
    let (_, list) = findings(&write(folder.path(), "r.xacro", text), &[]);
    assert!(of_severity(&list, "error").len() == 1);
    assert!(list.iter().all(|f| f["code"] != "U068"), "{list:?}");
    let text = "<robot name='r'><link name='a'><inertial><msas value='1'/>\
                <inertia ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>";
    let (_, list) = findings(&write(folder.path(), "r.urdf", text), &[]);
    let codes: Vec<_> = of_severity(&list, "error")
        .iter()
        .map(|f| f["code"].clone())
        .collect();
    assert_eq!(codes, ["U017", "U015"], "{list:?}");
}

/// A `<collision>` behind a `<visual>` without its end was a part of it, and so was its fault.
#[test]
fn a_part_of_a_link_behind_one_without_an_end_is_looked_into() {
    let folder = tempfile::tempdir().unwrap();
    let lines = [
        "<robot name='r'><link name='a'><visual>",
        "<geometry><box size='1 1 1'/></geometry></visual>",
        "<collision><geometry><sphere radius='1'/></geometry></collision></link>",
        "</robot>",
    ];
    let whole = lines.join("\n");
    assert!(findings(&write(folder.path(), "r.urdf", &whole), &[]).0);
    let open = whole.replace("</visual>", "");
    let list = findings(&write(folder.path(), "r.urdf", &open), &[]).1;
    let errors = of_severity(&list, "error");
    assert_eq!(errors.len(), 1, "{list:?}");
    assert_eq!(errors[0]["line"], 1);
    assert_eq!(
        errors[0]["help"],
        "add </visual> before the next <collision>"
    );
    // Its own fault is told in the same run.
    let both = open.replace("radius", "raduis");
    let list = findings(&write(folder.path(), "r.urdf", both), &[]).1;
    assert_eq!(places(&list), [1, 3], "{list:?}");
}
