//! What comes next once that is done which a run of `check` proposes: it is told in the same run,
//! so that the second one accepts the robot.
//!
//! Each file stands for public ones that needed a third run, see docs/collections.md.

use super::packages::field;
use super::people::{findings, mesh_robot, of_severity, tetrahedron, write};
use super::*;

const ROOT: &str = "<robot xmlns:xacro='http://wiki.ros.org/xacro' name='r'>";

/// A joint that turns, its link, and what the link has.
fn finger(name: &str, content: &str) -> String {
    format!(
        "<link name='{name}'>{content}</link><joint name='{name}' type='continuous'>\
         <parent link='palm'/><child link='{name}'/></joint>"
    )
}

/// Codes of errors, and of what is told to come next, in order.
fn codes(list: &[Value]) -> Vec<&str> {
    let told = list.iter().filter(|f| {
        f["severity"] == "error" || ["U066", "U068"].contains(&f["code"].as_str().unwrap())
    });
    told.map(|f| f["code"].as_str().unwrap()).collect()
}

/// The Allegro hand of Wonik: its fingers are called before they are defined, and weigh nothing.
#[test]
fn a_macro_that_is_defined_behind_its_call_hides_no_missing_mass() {
    let folder = tempfile::tempdir().unwrap();
    let ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
    let (call, macros) = (
        "<xacro:finger name='thumb'/>".to_owned(),
        format!(
            "<xacro:macro name='finger' params='name'>{}</xacro:macro>",
            finger("${name}", ball)
        ),
    );
    let text =
        |first: &str, second: &str| format!("{ROOT}<link name='palm'/>{first}{second}</robot>");
    let hand = write(folder.path(), "hand.xacro", text(&call, &macros));
    let (_, list) = findings(&hand, &[]);
    assert_eq!(codes(&list), ["U006", "A104"]);
    assert!(field(&list, "U006", "help").contains("put the definition before its use"));
    assert!(field(&list, "U024", "message").contains("as if what is proposed were done"));
    // Both are followed.
    let hand = write(folder.path(), "hand.xacro", text(&macros, &call));
    assert!(findings(&hand, &["--density", "1000"]).0);
    // The definition stands in a file that nobody includes.
    let inner = format!("{ROOT}{macros}</robot>");
    write(folder.path(), "package.xml", "<name>p</name>");
    write(folder.path(), "macros.xacro", inner);
    let hand = write(folder.path(), "hand.xacro", text(&call, ""));
    let (_, list) = findings(&hand, &[]);
    assert_eq!(codes(&list), ["U006", "A104"]);
    // A property that comes too late, with a name that depends on it.
    let far = finger("f", "").replace("link='palm'", "link='${far}'");
    let property = "<xacro:property name='far' value='plam'/>";
    let hand = write(folder.path(), "hand.xacro", text(&far, property));
    let (_, list) = findings(&hand, &[]);
    assert_eq!(codes(&list), ["U006", "U066", "U016"]);
    assert!(field(&list, "U016", "help").contains("did you mean 'palm'?"));
}

/// The objects of the scene of Pisa's hand: an argument without a default names a mesh.
#[test]
fn a_mesh_that_is_missing_by_the_value_that_is_proposed_for_an_argument_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "package.xml", "<name>p</name>");
    let call = "<param command='xacro object.xacro name:=cup'/>";
    write(root, "launch/a.launch", call);
    let object = mesh_robot(&["$(arg name).stl"]);
    let object = object.replacen('>', " xmlns:xacro='http://wiki.ros.org/xacro'>", 1);
    let object = write(root, "object.xacro", object);
    let (_, list) = findings(&object, &[]);
    assert_eq!(codes(&list), ["U006", "U104"]);
    assert!(field(&list, "U104", "message").contains("cup.stl"));
    write(root, "cup.stl", tetrahedron());
    assert!(findings(&object, &["name:=cup"]).0);
}

/// The example of Baxter's gripper: an included file is in another folder, and what it holds hangs
/// on a link that is not there.
#[test]
fn what_is_wrong_in_a_file_that_is_meant_is_told_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "package.xml", "<name>p</name>");
    let part = format!(
        "{ROOT}<link name='palm'/>{}</robot>",
        finger("f", "").replace("'palm'", "'hand'")
    );
    write(root, "parts/finger.xacro", part);
    let text = format!("{ROOT}<xacro:include filename='other/finger.xacro'/></robot>");
    let robot = write(root, "robot.xacro", text);
    let (_, list) = findings(&robot, &[]);
    assert_eq!(codes(&list), ["U006", "U066", "U016"]);
}

/// Universal Robots' description with a type of robot that there is not: what a macro hands out is
/// not known, and not what the other branch of its condition would have been.
#[test]
fn what_a_condition_would_set_that_cannot_be_known_is_not_known() {
    let folder = tempfile::tempdir().unwrap();
    let set = |tag: &str, value: &str| {
        format!(
            "<xacro:{tag} value=\"${{'a' in known}}\">\
             <xacro:property name='found' value=\"{value}\" scope='parent'/></xacro:{tag}>"
        )
    };
    let text = format!(
        "{ROOT}<xacro:property name='known' value=\"${{xacro.load_yaml('no.yaml')}}\"/>\
         <xacro:macro name='find' params=''>{}{}</xacro:macro><xacro:find/>\
         <link name=\"${{found['mesh']}}\"/><link name='l'/></robot>",
        set("if", "${known['a']}"),
        set("unless", "")
    );
    let robot = write(folder.path(), "r.xacro", text);
    let (_, list) = findings(&robot, &[]);
    let told = of_severity(&list, "error");
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(field(&list, "U006", "message").contains("no.yaml"));
}

/// COMAN's conditions: what is told as an error is not told again as what may be wrong, too.
#[test]
fn an_error_is_not_listed_among_what_may_be_wrong_too() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        format!("{ROOT}<xacro:if value='${{USES_FEET}}'><a/></xacro:if><link name='l'/></robot>");
    let robot = write(folder.path(), "r.xacro", text);
    let (_, list) = findings(&robot, &[]);
    assert_eq!(codes(&list), ["U006"]);
}

/// COMAN's camera: one joint hangs on a link that is not there, another one holds one.
#[test]
fn links_that_are_missing_above_and_below_are_told_with_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let text = |more: &str| {
        format!(
            "<robot name='r'><link name='camera'/><joint name='j' type='fixed'>\
             <parent link='torso'/><child link='camera'/></joint><joint name='k' type='fixed'>\
             <parent link='camera'/><child link='gaze'/></joint>{more}</robot>"
        )
    };
    let robot = write(folder.path(), "r.urdf", text(""));
    let (_, list) = findings(&robot, &[]);
    let offered: Vec<&str> = list
        .iter()
        .filter_map(|f| f["help"].as_str()?.split("write ").nth(1))
        .collect();
    let links = ["<link name=\"torso\"/>", "<link name=\"gaze\"/>"];
    assert!(
        offered
            .iter()
            .zip(links)
            .all(|(offered, link)| offered.starts_with(link)),
        "{offered:?}"
    );
    let robot = write(folder.path(), "r.urdf", text(&links.concat()));
    assert!(findings(&robot, &[]).0);
}

/// Agibot's G1: meshes are missing, and a loop cannot be closed, however they look.
#[test]
fn a_loop_that_cannot_be_closed_is_told_beside_meshes_that_are_missing() {
    let folder = tempfile::tempdir().unwrap();
    let settings = "[[loop]]\nname = 'c'\ntype = 'ball'\nlinks = ['palm', 'f']\n\
                    origins = [[0, 0, 9], [0, 0, 0]]\n";
    let settings = write(folder.path(), "s.toml", settings);
    let config = ["--config", text(&settings)];
    let robot = |shape: &str| {
        let content = format!(
            "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>\
             </inertial><collision><geometry>{shape}</geometry></collision>"
        );
        format!(
            "<robot name='r'><link name='palm'/>{}</robot>",
            finger("f", &content)
        )
    };
    let one = write(folder.path(), "one.urdf", robot("<sphere radius='0.1'/>"));
    assert_eq!(codes(&findings(&one, &config).1), ["A141"]);
    let both = write(
        folder.path(),
        "both.urdf",
        robot("<mesh filename='no.stl'/>"),
    );
    assert_eq!(codes(&findings(&both, &config).1), ["U104", "A141"]);
    // Where the joints are is not known.
    let lame =
        robot("<mesh filename='no.stl'/>").replace("<parent", "<origin xyz='a b c'/><parent");
    let lame = write(folder.path(), "lame.urdf", lame);
    assert_eq!(codes(&findings(&lame, &config).1), ["U104", "U030"]);
}

/// Found by fuzzing: what a file that is included under a name has was taken into an expansion that
/// does not have it yet, which ended the command.
#[test]
fn a_file_that_is_included_under_a_name_after_its_use_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let part = format!("{ROOT}<xacro:property name='k' value='2'/></robot>");
    write(folder.path(), "part.xacro", part);
    for use_of in ["${n.k}", "${held[0].k}"] {
        let text = format!(
            "{ROOT}<link name='l{use_of}'/><xacro:include filename='part.xacro' ns='n'/>\
             <xacro:property name='held' value='${{[n]}}' lazy_eval='false'/></robot>"
        );
        let robot = write(folder.path(), "r.xacro", text);
        let (_, list) = findings(&robot, &[]);
        assert_eq!(codes(&list)[0], "U006", "{list:?}");
        let place = list.iter().find(|f| f["code"] == "U006").unwrap();
        assert_eq!(place["severity"], "error");
    }
}

/// Atlas of DRC: a link that is to be written is moved by a joint, and would have no mass.
#[test]
fn a_link_that_is_to_be_written_is_told_to_need_mass() {
    let folder = tempfile::tempdir().unwrap();
    let text = |kind: &str, more: &str| {
        format!(
            "<robot name='r'><link name='palm'/><joint name='j' type='{kind}'>\
             <parent link='palm'/><child link='head'/></joint>{more}</robot>"
        )
    };
    let robot = write(folder.path(), "r.urdf", text("continuous", ""));
    let (_, list) = findings(&robot, &[]);
    let help = field(&list, "U016", "help");
    let (link, option) = ("<link name=\"head\"/>", "--missing-mass 0.1");
    assert!(help.contains(link) && help.contains(option), "{help}");
    let robot = write(folder.path(), "r.urdf", text("continuous", link));
    assert!(!findings(&robot, &[]).0);
    assert!(findings(&robot, &["--missing-mass", "0.1"]).0);
    // What does not move needs none.
    let robot = write(folder.path(), "r.urdf", text("fixed", ""));
    let (_, list) = findings(&robot, &[]);
    assert!(!field(&list, "U016", "help").contains("mass"));
}

/// An arm with a gripper, each with meshes in a folder of another machine.
#[test]
fn meshes_that_are_missing_in_several_folders_outside_are_told_with_the_one_that_holds_them() {
    let folder = tempfile::tempdir().unwrap();
    let far = folder.path().join("a/home/of/another");
    let meshes = ["arm/a.stl", "gripper/b.stl"].map(|mesh| far.join(mesh));
    let names = meshes.clone().map(|mesh| format!("file://{}", text(&mesh)));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let own = folder.path().join("own/robot/urdf/of");
    fs::create_dir_all(&own).unwrap();
    let robot = write(&own, "r.urdf", mesh_robot(&names));
    let (_, list) = findings(&robot, &[]);
    let option = format!("pass --package-path {}\n", far.display());
    assert!(field(&list, "U104", "help").contains(&option), "{list:?}");
    for mesh in &meshes {
        write(
            mesh.parent().unwrap().parent().unwrap(),
            text(mesh.strip_prefix(&far).unwrap()),
            tetrahedron(),
        );
    }
    assert!(findings(&robot, &["--package-path", text(&far)]).0);
}

/// The folders of a project on somebody's desktop: what is offered is typed as it stands.
#[test]
fn folders_with_blanks_are_offered_as_a_shell_takes_them() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("my robot/of/the work");
    write(&root, "other/Arm/package.xml", "<name>elsewhere</name>");
    write(&root, "arms/arm/meshes/a.stl", tetrahedron());
    let robot = write(&root, "u/v/r.urdf", mesh_robot(&["arm/meshes/a.stl"]));
    let (_, list) = findings(&robot, &[]);
    let help = field(&list, "U104", "help");
    let option = format!("--package-path '{}'", root.join("arms").display());
    assert!(help.starts_with(&option), "{help}");
    assert!(findings(&robot, &["--package-path", text(&root.join("arms"))]).0);
    let call = mesh_robot(&["$(arg mesh)"]);
    let call = call.replacen('>', " xmlns:xacro='http://wiki.ros.org/xacro'>", 1);
    let robot = write(&root, "r.xacro", call);
    let (_, list) = findings(&robot, &[]);
    let offered = format!("give them after the file: '{}' mesh:=", text(&robot));
    assert!(field(&list, "U006", "help").contains(&offered), "{list:?}");
}
