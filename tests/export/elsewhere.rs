//! Files in xacro whose macros and files are elsewhere than they say, as in packages that are not
//! installed: they are found, or told with their places, so that one mend is enough.

use super::packages::field;
use super::people::{findings, of_severity, write};
use super::*;

const ROOT: &str = "<robot xmlns:xacro='http://wiki.ros.org/xacro' name='r'>";

fn robot(content: &str) -> String {
    format!("{ROOT}{content}</robot>")
}

const BOX: &str = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' \
                   izz='1'/></inertial>";

/// `ros2_control_demos` and `uos_tools` name files by the places where an installation puts them.
#[test]
fn a_file_that_an_installation_puts_elsewhere_is_read_where_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "demo/package.xml", "<name>demo</name>");
    let control = robot("<xacro:macro name='control'><link name='l'/></xacro:macro>");
    write(root, "demo/description/control/a.xacro", &control);
    write(root, "demo/description/config/m.yaml", "mass: 2\n");
    let content = "<xacro:include filename='$(find demo)/control/a.xacro'/><xacro:control/>\
                   <xacro:property name='f' value='$(find demo)/config/m.yaml'/>\
                   <xacro:property name='m' value=\"${xacro.load_yaml(f)['mass']}\"/>\
                   <xacro:if value='${m == 2}'><link name='two'/><joint name='j' type='fixed'>\
                   <parent link='two'/><child link='l'/></joint></xacro:if>";
    let file = write(root, "demo/description/urdf/r.urdf.xacro", robot(content));
    let (ok, list) = findings(&file, &[]);
    assert!(ok, "{list:?}");
    let moved: Vec<_> = list.iter().filter(|f| f["code"] == "U118").collect();
    assert_eq!(moved.len(), 2, "{list:?}");
    for (finding, name) in moved.iter().zip(["control/a.xacro", "config/m.yaml"]) {
        assert_eq!(finding["severity"], "warning");
        let message = finding["message"].as_str().unwrap();
        let place = root.join("demo/description").join(name);
        assert!(
            message.contains(&format!("{} is read", place.display())),
            "{message}"
        );
        assert_eq!(finding["file"], text(&file));
    }
    // Who says where the package is needs no warning.
    let package = format!("demo={}", root.join("demo/description").display());
    let (ok, list) = findings(&file, &["--package", &package]);
    assert!(ok && list.iter().all(|f| f["code"] != "U118"), "{list:?}");
    // Of two files neither is taken, and both are named.
    write(root, "demo/other/control/a.xacro", &control);
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    let help = field(&list, "U006", "help");
    for other in ["description", "other"] {
        let place = root.join("demo").join(other).join("control/a.xacro");
        assert!(help.contains(text(&place)), "{help}");
    }
}

/// The grippers of HIWIN, written on Windows, and a gripper of Baxter in the wrong folder.
#[test]
fn an_included_file_of_another_folder_or_with_other_slashes_is_found_or_named() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "p/package.xml", "<name>p</name>");
    let part = write(
        root,
        "p/urdf/pneumatic/part.xacro",
        robot("<link name='l'/>"),
    );
    let include = |name: &str| robot(&format!("<xacro:include filename='{name}'/>"));
    let turned = write(
        root,
        "p/turned.xacro",
        include("$(find p)\\urdf\\pneumatic\\part.xacro"),
    );
    let (ok, list) = findings(&turned, &[]);
    assert!(ok, "{list:?}");
    let wrong = include("$(find p)/urdf/electric/part.xacro");
    let file = write(root, "p/wrong.xacro", &wrong);
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    let help = field(&list, "U006", "help");
    assert_eq!(help, format!("did you mean '{}'?", part.display()));
    fs::write(&file, include(text(&part))).unwrap();
    assert!(findings(&file, &[]).0);
    // A slip in the name, as of the cameras of the Husky.
    fs::write(&file, include("urdf/pneumatic/prat.xacro")).unwrap();
    let help = field(&findings(&file, &[]).1, "U006", "help");
    assert!(
        help.starts_with("did you mean '") && help.ends_with("pneumatic/part.xacro'?"),
        "{help}"
    );
}

/// The Allegro hand calls macros that stand behind the calls, as the first xacro allowed.
#[test]
fn a_macro_or_property_that_is_defined_elsewhere_is_told_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let define = "<xacro:macro name='finger' params='n'>\n<link name='${n}${side}'/></xacro:macro>";
    let side = "<xacro:property name='side' value='_left'/>";
    let (call, comment) = (
        "<xacro:finger n='a'/>",
        "<!-- <xacro:macro name='finger'> -->",
    );
    let late = format!("{comment}{side}\n{call}\n{define}");
    let file = write(root, "hand.xacro", robot(&late));
    let (ok, list) = findings(&file, &[]);
    assert!(!ok);
    let help = field(&list, "U006", "help");
    assert!(
        help.contains("defined behind this, in line 3: put the definition before"),
        "{help}"
    );
    fs::write(&file, robot(&format!("{side}{define}{call}"))).unwrap();
    assert!(findings(&file, &[]).0);
    // A condition that does not hold.
    let unless = format!("<xacro:unless value='true'>{define}</xacro:unless>{side}\n{call}");
    fs::write(&file, robot(&unless)).unwrap();
    let help = field(&findings(&file, &[]).1, "U006", "help");
    assert!(help.contains("hand.xacro:1 defines it, but"), "{help}");
    // Another file, with the property that it needs in a third one.
    write(root, "parts/finger.xacro", robot(define));
    fs::write(&file, robot(call)).unwrap();
    let (_, list) = findings(&file, &[]);
    let include = "<xacro:include filename=\"parts/finger.xacro\"/>";
    let help = field(&list, "U006", "help");
    assert!(
        help.contains("not included") && help.ends_with(include),
        "{help}"
    );
    write(root, "parts/side.xacro", robot(side));
    fs::write(&file, robot(&format!("{include}{call}"))).unwrap();
    let (_, list) = findings(&file, &[]);
    let include_side = "<xacro:include filename=\"parts/side.xacro\"/>";
    let help = field(&list, "U006", "help");
    assert!(help.ends_with(include_side), "{help}");
    fs::write(&file, robot(&format!("{include}{include_side}{call}"))).unwrap();
    assert!(findings(&file, &[]).0);
    // Several files define it: each is named.
    write(root, "parts/thumb.xacro", robot(define));
    fs::write(&file, robot(call)).unwrap();
    let help = field(&findings(&file, &[]).1, "U006", "help");
    assert!(
        help.contains("parts/finger.xacro\n") && help.ends_with("parts/thumb.xacro"),
        "{help}"
    );
}

/// The turtle of the Roomba does not give its camera a place; a Kinova gives one too much.
#[test]
fn what_a_call_lacks_is_told_with_the_macro_that_needs_it() {
    let folder = tempfile::tempdir().unwrap();
    let macros =
        robot("\n<xacro:macro name='m' params='x y'><link name='${x}${y}'/></xacro:macro>");
    write(folder.path(), "m.xacro", &macros);
    let include = "<xacro:include filename='m.xacro'/>";
    for (call, advice) in [
        ("<xacro:m x='1'/>", "write y=\"…\" into the call: "),
        ("<xacro:m x='1' y='2' gripper='3'/>", "leave out gripper: "),
    ] {
        let file = write(folder.path(), "r.xacro", robot(&format!("{include}{call}")));
        let (ok, list) = findings(&file, &[]);
        assert!(!ok);
        let help = field(&list, "U006", "help");
        assert!(
            help.starts_with(advice) && help.ends_with("m.xacro:2"),
            "{help}"
        );
    }
}

/// The camera of the Stretch: with the package that it lacks, it would be a part without a parent.
#[test]
fn a_part_that_lacks_a_package_or_file_names_the_files_that_include_it() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["$(find camera_pkg)/c.xacro", "no_such.xacro"] {
        let include = format!("<xacro:include filename='{name}'/>");
        let part = write(root, "part.xacro", robot(&include));
        let whole = root.join("whole.xacro");
        _ = fs::remove_file(&whole);
        let (_, list) = findings(&part, &[]);
        assert!(!field(&list, "U006", "help").contains("part of a robot"));
        write(
            root,
            "whole.xacro",
            robot("<xacro:include filename='part.xacro'/>"),
        );
        let (_, list) = findings(&part, &[]);
        let help = field(&list, "U006", "help");
        let named = format!(
            "this is a part of a robot, give a file that includes this one:\n{}",
            whole.display()
        );
        assert!(help.ends_with(&named), "{help}");
    }
}

/// The grippers of Baxter and the table of three fingers hang on a link that another file has.
#[test]
fn a_part_that_hangs_on_a_link_of_another_file_is_told_the_link_that_makes_it_load() {
    let folder = tempfile::tempdir().unwrap();
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<link name='{child}'>{BOX}</link><joint name='{name}' type='fixed'>\
             <parent link='{parent}'/><child link='{child}'/></joint>"
        )
    };
    let check = |content: &str| {
        let file = write(
            folder.path(),
            "r.urdf",
            format!("<robot name='r'>{content}</robot>"),
        );
        findings(&file, &[])
    };
    let gripper = joint("a", "left_hand", "base");
    let (ok, list) = check(&gripper);
    assert!(!ok);
    let link = "<link name=\"left_hand\"/>";
    let help = field(&list, "U016", "help");
    assert!(
        help.contains(link) && help.contains("whole robot"),
        "{help}"
    );
    assert!(check(&format!("{link}{gripper}")).0);
    // Two such links would be two roots.
    let (ok, list) = check(&format!("{gripper}{}", joint("b", "head", "eye")));
    let told = of_severity(&list, "error");
    assert!(!ok && told.len() == 2, "{list:?}");
    for finding in told {
        let help = finding["help"].as_str().unwrap();
        assert!(
            !help.contains("<link") && help.contains("whole robot"),
            "{help}"
        );
    }
    // A child.
    let lone = "<link name='base'/><joint name='a' type='fixed'><parent link='base'/>\
                <child link='gaze'/></joint>";
    let (ok, list) = check(lone);
    let link = "<link name=\"gaze\"/>";
    assert!(
        !ok && field(&list, "U016", "help").contains(link),
        "{list:?}"
    );
    assert!(check(&format!("{link}{lone}")).0);
}

/// The hand of the Panda on its own: it hangs on the last link of the arm.
#[test]
fn a_link_is_not_offered_in_place_of_another_one_of_its_row() {
    let folder = tempfile::tempdir().unwrap();
    let check = |link: &str| {
        let content = format!(
            "<robot name='r'><link name='{link}'/><link name='hand'>{BOX}</link>\
             <joint name='j' type='fixed'><parent link='panda_link8'/><child link='hand'/></joint>\
             </robot>"
        );
        let (ok, list) = findings(&write(folder.path(), "r.urdf", content), &[]);
        assert!(!ok);
        field(&list, "U016", "help")
    };
    assert_eq!(
        check("panda_link0"),
        "give the file of the whole robot if this is a part of it, or write the name that is \
         meant: 'panda_link0' is another one of its row"
    );
    assert_eq!(check("panda_lnk8"), "did you mean 'panda_lnk8'?");
    assert_eq!(check("panda_link08"), "did you mean 'panda_link08'?");
}
