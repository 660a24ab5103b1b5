//! Slips of the pen, one at a time, and the word that the advice must give: names in xacro, keys
//! and values of settings, angles in degrees.

use super::people::{findings, write};
use super::*;

/// A cart in xacro.
const CART: &str = "<robot name='cart' xmlns:xacro='http://www.ros.org/wiki/xacro'>
<xacro:arg name='prefix' default='my_'/>
<xacro:arg name='with_arm' default='true'/>
<xacro:property name='wheel_radius' value='0.1'/>
<xacro:property name='wheel_width' value='0.04'/>
<xacro:macro name='box_inertial' params='mass x y z'>
  <inertial><mass value='${mass}'/><inertia ixx='${mass*(y*y+z*z)/12}' iyy='${mass*(x*x+z*z)/12}'
    izz='${mass*(x*x+y*y)/12}' ixy='0' ixz='0' iyz='0'/></inertial>
</xacro:macro>
<xacro:macro name='wheel' params='side reflect:=1 *origin'>
  <link name='$(arg prefix)${side}_wheel'>
    <xacro:box_inertial mass='1.5' x='0.2' y='0.04' z='0.2'/>
    <collision><origin rpy='${radians(90)} 0 0'/>
      <geometry><cylinder radius='${wheel_radius}' length='${wheel_width}'/></geometry></collision>
  </link>
  <joint name='${side}_joint' type='continuous'><parent link='base_link'/>
    <child link='$(arg prefix)${side}_wheel'/><xacro:insert_block name='origin'/><axis xyz='0 1 0'/></joint>
</xacro:macro>
<link name='base_link'><xacro:box_inertial mass='10' x='0.5' y='0.3' z='0.1'/>
  <collision><geometry><box size='0.5 0.3 0.1'/></geometry></collision></link>
<xacro:wheel side='left'><origin xyz='0 0.2 0'/></xacro:wheel>
<xacro:wheel side='right' reflect='-1'><origin xyz='0 -0.2 0'/></xacro:wheel>
<xacro:if value='$(arg with_arm)'>
  <link name='arm'><xacro:box_inertial mass='1' x='0.1' y='0.1' z='0.3'/></link>
  <joint name='shoulder' type='revolute'><parent link='base_link'/><child link='arm'/>
    <origin xyz='0 0 0.1' rpy='0 0 1'/><axis xyz='0 1 0'/>
    <limit lower='-1' upper='1' effort='10' velocity='2'/></joint>
</xacro:if>
</robot>";

const SETTINGS: &str = "[robot]
base = \"fixed\"
[[actuator]]
joint = \"shoulder\"
[initial]
xyz = [0, 0, 0.5]
[outputs]
links = [\"*\"]
";

/// What stands in one of the files, what a hand writes, and what the advice says.
const SLIPS: [[&str; 3]; 23] = [
    [
        "<xacro:box_inertial mass='10'",
        "<xacro:box_inertal mass='10'",
        "did you mean 'box_inertial'?",
    ],
    [
        "<xacro:box_inertial mass='10'",
        "<xacro:BoxInertial mass='10'",
        "did you mean 'box_inertial'?",
    ],
    [
        "length='${wheel_width}'",
        "length='${wheel_widht}'",
        "did you mean 'wheel_width'?",
    ],
    [
        "length='${wheel_width}'",
        "length='${Wheel_Width}'",
        "did you mean 'wheel_width'?",
    ],
    ["radians(90)", "radian(90)", "did you mean 'radians'?"],
    [
        "$(arg with_arm)",
        "$(arg witharm)",
        "did you mean 'with_arm'?",
    ],
    [
        "<xacro:property name='wheel_width' value='0.04'/>",
        "<xacro:propery name='wheel_width' value='0.04'/>",
        "did you mean 'property'?",
    ],
    [
        "<xacro:insert_block name",
        "<xacro:insert_blok name",
        "did you mean 'insert_block'?",
    ],
    [
        "insert_block name='origin'",
        "insert_block name='orign'",
        "did you mean 'origin'?",
    ],
    ["reflect='-1'", "reflekt='-1'", "did you mean 'reflect'?"],
    ["mass='10' x=", "mas='10' x=", "did you mean 'mass'?"],
    [
        "name='wheel_width' value",
        "name='wheel_width' vale",
        "has no attribute 'value'",
    ],
    [
        "default='my_'",
        "defualt='my_'",
        "did you mean 'default' by 'defualt'?",
    ],
    [
        "name='wheel' params",
        "name='wheel' param",
        "did you mean 'params' by 'param'?",
    ],
    ["rpy='0 0 1'", "rpy='0 0 90'", "90 degrees are 1.5708"],
    [
        "lower='-1' upper='1'",
        "lower='-90' upper='90'",
        "90 degrees are 1.5708",
    ],
    [
        "<origin xyz='0 0 0.1' rpy='0 0 1'/>",
        "<pose xyz='0 0 0.1' rpy='0 0 1'/>",
        "did you mean 'origin'?",
    ],
    [
        "base = \"fixed\"",
        "base = fixed",
        "a text stands in quotes: \"fixed\"",
    ],
    [
        "base = \"fixed\"",
        "self_collision = True",
        "TOML writes it true",
    ],
    ["base = \"fixed\"", "self_collision = yes", "write true"],
    [
        "[[actuator]]",
        "[[object]]\nurdf = \"a\"\n[[actuator]]",
        "write [[world.object]]",
    ],
    ["links = ", "link = ", "did you mean 'links'?"],
    ["[outputs]", "[output]", "did you mean 'outputs'?"],
];

#[test]
fn slips_are_told_with_the_word_that_was_meant() {
    let folder = tempfile::tempdir().unwrap();
    let check = |slip: [&str; 2], arguments: &[&str]| {
        let robot = write(
            folder.path(),
            "r.urdf.xacro",
            CART.replacen(slip[0], slip[1], 1),
        );
        let config = write(
            folder.path(),
            "r.toml",
            SETTINGS.replacen(slip[0], slip[1], 1),
        );
        let all = [arguments, &["--config", text(&config)]].concat();
        findings(&robot, &all).1
    };
    let advice = |list: &[Value]| -> Vec<String> {
        let serious = list.iter().filter(|finding| finding["severity"] != "note");
        let help = |finding: &Value| finding["help"].as_str().unwrap_or_default().to_owned();
        serious.map(help).collect()
    };
    assert_eq!(advice(&check(["", ""], &[])), [""; 0], "the sound robot");
    for [old, new, word] in SLIPS {
        assert!(CART.contains(old) || SETTINGS.contains(old), "{old}");
        let list = check([old, new], &[]);
        let told = advice(&list);
        assert!(
            told.iter().any(|help| help.contains(word)),
            "{new}: {told:?}"
        );
    }
    // An argument that nobody asks for would change nothing, and nobody would say so.
    let told = advice(&check(["", ""], &["with_amr:=false"]));
    assert_eq!(told, ["did you mean 'with_arm'?"]);
    let told = advice(&check(["", ""], &["with_arm:=true"]));
    assert_eq!(told, [""; 0]);
    // A default may stand before the name, and may hold whatever an attribute may.
    let sound = "<xacro:arg name='with_arm' default='true'/>";
    let turned = format!("{sound}<xacro:arg default='a > b, name' name='color' />");
    let told = advice(&check([sound, &turned], &["colr:=red"]));
    assert_eq!(told, ["did you mean 'color'?"]);
}

/// The line of an expanded text is in no file of the user's: the advice names that which is.
#[test]
fn findings_in_an_expanded_text_say_where_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let macros = "<robot xmlns:xacro='x'>\n<xacro:macro name='leg' params='name mass *at'>\n\
        <link name='${name}'><inertial>\n<mass value='${mass}'/>\n\
        <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\n\
        <joint name='${name}_joint' type='revolute'><parent link='body'/><child link='${name}'/>\n\
        <xacro:insert_block name='at'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\n\
        </xacro:macro></robot>";
    let robot = "<robot name='r' xmlns:xacro='x'>\n<xacro:include filename='macros.xacro'/>\n\
        <link name='body'><inertial><mass value='1'/>\n\
        <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\n\n\
        <xacro:leg name='a' mass='1,5'><origin xyz='0 0 1'/></xacro:leg>\n\
        <xacro:leg name='b' mass='2'>\n  <origin xyz='0 0'/></xacro:leg>\n</robot>";
    let macros = write(folder.path(), "macros.xacro", macros);
    let robot = write(folder.path(), "r.urdf.xacro", robot);
    let (ok, list) = findings(&robot, &[]);
    let told: Vec<&str> = list
        .iter()
        .filter(|finding| finding["severity"] == "error")
        .filter_map(|finding| finding["help"].as_str()?.lines().next())
        .collect();
    // The number in the macro, and the block that stands in the call.
    let written = |file: &Path, line: u32| format!("it is written in {}:{line}", file.display());
    assert_eq!(told, [written(&macros, 4), written(&robot, 8)], "{list:?}");
    assert!(!ok);
}

/// Names of files that are nearly right, also in settings, and files that are something else.
#[test]
fn files_that_are_not_there_are_told_with_the_one_that_is() {
    let folder = tempfile::tempdir().unwrap();
    let rover = write(
        folder.path(),
        "rover.urdf",
        fs::read_to_string(example("rover.urdf")).unwrap(),
    );
    let near = |name: &str| folder.path().join(name);
    write(folder.path(), "crate.urdf", "<robot name='c'/>");
    write(folder.path(), "drive.csv", "time\n0\n");
    let settings = "[[world.object]]\nname = \"a\"\nurdf = \"craet.urdf\"\n";
    let settings = write(folder.path(), "rover.toml", settings);
    for (arguments, part) in [
        (["check", text(&near("rovr.urdf"))].to_vec(), "rover.urdf'?"),
        (
            ["simulate", text(&near("rovr.urdf"))].to_vec(),
            "rover.urdf'?",
        ),
        (
            ["check", text(&rover), "-c", text(&near("rovr.toml"))].to_vec(),
            "rover.toml'?",
        ),
        (
            ["check", text(&rover), "-c", text(&settings)].to_vec(),
            "crate.urdf'?",
        ),
        (
            ["check", text(&rover), "-c", text(&settings)].to_vec(),
            "rover.toml:3:8]",
        ),
        (
            [
                "simulate",
                text(&rover),
                "--input-file",
                text(&near("drvie.csv")),
            ]
            .to_vec(),
            "drive.csv'?",
        ),
        (
            ["report", text(&near("drvie.csv")), "--model", text(&rover)].to_vec(),
            "drive.csv'?",
        ),
        (["check", "-"].to_vec(), "/dev/stdin"),
        (
            ["export", text(&rover), "-o", "nowhere/"].to_vec(),
            "there is no folder 'nowhere/'",
        ),
        (
            ["export", text(&rover), "--platform", "windows"].to_vec(),
            "'win64'",
        ),
        (
            ["export", text(&rover), "--platform", "all"].to_vec(),
            "without platforms",
        ),
    ] {
        let done = run(&arguments);
        assert!(
            done.code != 0 && done.err.contains(part),
            "{arguments:?}: {done:?}"
        );
    }
    let fmu = write(folder.path(), "rover.fmu", "PK");
    for command in ["init", "expand"] {
        let done = urdf2fmu([command, text(&fmu)]);
        assert!(done.err.contains("is an FMU: "), "{command}: {done:?}");
    }
}

/// Times as settings take them, and tables as pandas writes them.
#[test]
fn times_are_ratios_too_and_an_index_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let rover = example("rover.urdf");
    let out = folder.path().join("out.csv");
    let tenth = [
        "simulate",
        text(&rover),
        "--stop-time",
        "1/10",
        "--output-file",
        text(&out),
    ];
    let done = run(&[&tenth[..], &["--output-interval", "1/100"]].concat());
    assert_eq!(done.code, 0, "{done:?}");
    assert_eq!(fs::read_to_string(&out).unwrap().lines().count(), 12);
    let done = run(&[&tenth[..], &["--output-interval", "10ms"]].concat());
    assert!(done.err.contains("such as 0.01 or 1/240"), "{done:?}");
    let wide = format!("time,cmd.head_joint.velocity\n0,{}\n", "1".repeat(9999));
    for (table, part) in [
        (",time\n0,0\n", "index=False"),
        (wide.as_str(), "1…' is no finite"),
        (
            "time,cmd.head_joint.velocity\n0,1e40\n",
            "in.csv', line 2, column 2: fmi2SetReal returned fmi2Error",
        ),
    ] {
        let table = write(folder.path(), "in.csv", table);
        let done = run(&[&tenth[..], &["--input-file", text(&table)]].concat());
        assert!(
            done.code == 1 && done.err.contains(part) && done.err.len() < 400,
            "{done:?}"
        );
    }
}

/// What lies in a mesh's place, and an SRDF that is to be expanded.
#[test]
fn meshes_that_are_something_else_are_told_as_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let solid = "solid s\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n\
        endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\n\
        endloop\nendfacet\nendsolid\n";
    let wide: Vec<u8> = solid.encode_utf16().flat_map(u16::to_le_bytes).collect();
    write(folder.path(), "near.stl", solid);
    for (name, content, told) in [
        ("m.stl", format!("\u{feff}{solid}").into_bytes(), ""),
        ("m.stl", [b"\xff\xfe", &wide[..]].concat(), "text in UTF-16"),
        (
            "m.stl",
            b"\n<!DOCTYPE html><html></html>".to_vec(),
            "a web page",
        ),
        ("m.obj", b"PK\x03\x04zip".to_vec(), "a compressed file"),
        ("m", solid.into(), "no ending"),
        ("naer.stl", Vec::new(), "near.stl'?"),
    ] {
        let robot = format!(
            "<robot name='r'><link name='a'><inertial><mass value='1'/>\
             <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>\
             <collision><geometry><mesh filename='{name}'/></geometry></collision></link></robot>"
        );
        let robot = write(folder.path(), "r.urdf", robot);
        if !content.is_empty() {
            fs::write(folder.path().join(name), content).unwrap();
        }
        let (ok, list) = findings(&robot, &[]);
        let errors: Vec<String> = list
            .iter()
            .filter(|finding| finding["severity"] == "error")
            .map(|finding| format!("{} {}", finding["message"], finding["help"]))
            .collect();
        assert_eq!(ok, told.is_empty(), "{name}: {errors:?}");
        assert!(
            errors.iter().all(|error| error.contains(told)),
            "{told}: {errors:?}"
        );
    }
    // A call whose macro is nowhere.
    let srdf = "<robot name='rover' xmlns:xacro='x'><xacro:rover_srdf prefix=''/></robot>";
    let srdf = write(folder.path(), "a.srdf", srdf);
    let (_, list) = findings(&example("rover.urdf"), &["--srdf", text(&srdf)]);
    let mut told = list
        .iter()
        .filter(|finding| finding["severity"] == "warning");
    assert!(
        told.any(|f| f["help"].as_str().unwrap_or("").contains("urdf2fmu expand")),
        "{list:?}"
    );
}

/// Files of arguments whose defaults are empty, as Universal Robots' are.
#[test]
fn an_argument_that_is_an_empty_name_of_a_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let robot = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n\
        <xacro:arg name='limits' default=''/>\n<xacro:arg default='' name='masses'/>\n\
        <xacro:property name='of' value=\"${xacro.load_yaml('$(arg limits)')}\"/>\n\
        <link name='${of.name}'/></robot>";
    let robot = write(folder.path(), "r.urdf.xacro", robot);
    let (_, list) = findings(&robot, &["masses:=m.yaml"]);
    let help = list
        .iter()
        .find_map(|finding| finding["help"].as_str())
        .unwrap_or_default();
    assert!(
        help.contains("limits:=FILE") && !help.contains("masses:="),
        "{list:?}"
    );
}

/// One rule for tables of runs and of inputs, in the same words.
#[test]
fn units_in_the_names_of_a_run_are_those_of_its_variables() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("run.html");
    let rover = example("rover.urdf");
    let table = folder.path().join("run.csv");
    for (names, wrong) in [
        ("time [s],base.position.z [m]", ""),
        ("time [s],base_position_z (m)", ""),
        (
            "time,base.position.z [mm]",
            "line 1, column 2: the values of 'base.position.z' must be in m, not in mm",
        ),
        (
            "time,base_position_z (mm)",
            "line 1, column 2: the values of 'base.position.z' must be in m, not in mm",
        ),
        (
            "base.position.z,time [ms]",
            "line 1, column 2: the values of 'time' must be in s, not in ms",
        ),
        (
            "time,base.rpy.yaw [deg]",
            "line 1, column 2: the values of 'base.rpy.yaw' must be in rad, not in deg",
        ),
        // A column of another program's may be in any unit.
        ("time,base.position.z,something [furlong]", ""),
    ] {
        let more = if names.contains("furlong") { ",3" } else { "" };
        fs::write(&table, format!("{names}\n0,0.1{more}\n1,0.2{more}\n")).unwrap();
        let run = run(&[
            "report",
            text(&table),
            "--model",
            text(&rover),
            "-o",
            text(&page),
        ]);
        assert_eq!(run.code == 0, wrong.is_empty(), "{names}: {run:?}");
        assert!(run.err.contains(wrong), "{names}: {}", run.err);
    }
}
