//! Two faults at a time in a robot that is written in xacro: of its expansion, of the URDF that it
//! expands to, and of its settings.
//!
//! Expected messages are those of the same fault alone, and what follows from a fault is not told:
//! a file with one fault has one error.

use super::people::{findings, of_severity, write};
use super::*;

/// What stands at one place of the robot, its macros or its settings, sound and faulty, and what
/// its error says.
const FAULTS: [[&str; 3]; 23] = [
    // The text.
    ["<h1 x='1'/>", "<h1 x=1/>", "not XML: <h1>"],
    ["<h2 x='1'/>", "<h2 x='1' x='1'/>", "not XML: <h2>"],
    ["<h3 x='&amp;'/>", "<h3 x='&'/>", "not XML: <h3> x"],
    ["<h4></h4>", "<h4>", "<h4> is never closed"],
    // The expansion.
    ["value='${m1}'", "value='${mm}'", "name 'mm' is not defined"],
    ["radius='${1 / 2}'", "radius='${1 / 0}'", "division by zero"],
    ["length='${(2)}'", "length='${(2}'", "')' is missing"],
    [
        "<xacro:leg name='hind'/>",
        "<xacro:legg name='hind'/>",
        "no macro 'legg'",
    ],
    [
        "<xacro:leg name='fore'/>",
        "<xacro:leg nam='fore'/>",
        "has no parameter 'nam' and needs 'name'",
    ],
    ["<seat at='1'/>", "", "needs a block for '**more'"],
    ["block name='kept'", "block name='lost'", "no block 'lost'"],
    ["'$(arg kind)'", "'$(arg kin)'", "'kin' has no value"],
    [
        "<a x='1'/>",
        "<a x='$(find my_pkg)'/>",
        "package 'my_pkg' is not found",
    ],
    [
        "if value='true'",
        "if value='maybe'",
        "neither true nor false",
    ],
    [
        "name='p' value='1'",
        "name='p' value='${q}'",
        "needs itself",
    ],
    ["<b x='2'>${3}</b>", "<b x='2'>${[][0]}</b>", "[]"],
    [
        "<!-- no file -->",
        "<xacro:property name='d' value=\"${xacro.load_yaml('no.yaml')}\"/><c x='${d.e}'/>",
        "no.yaml cannot be read",
    ],
    // What it expands to.
    [
        "<mass value='1.01'/>",
        "<mass value='1,01'/>",
        "'1,01' is not a number",
    ],
    [
        "<box size='0.01 0.01 0.01'/>",
        "<mesh filename='nowhere.stl'/>",
        "mesh not found: nowhere.stl",
    ],
    [
        "lower='-0.1' upper='0.1'",
        "lower='-0,1' upper='0.1'",
        "lower",
    ],
    [
        "rpy='0 0 0.1'",
        "rpy='0 0.1'",
        "<origin> rpy needs 3 numbers, not 2",
    ],
    // Its settings.
    ["tolerance = 1e-4", "tolerence = 1e-4", "'tolerence'"],
    ["gravity = [0, 0, -9.81]", "gravity = 'down'", "gravity"],
];

const MACROS: &str = "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>
<xacro:macro name='leg' params='name'>
  <link name='${name}'><inertial><mass value='${m1}'/>
    <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
  <joint name='${name}_joint' type='revolute'><parent link='body'/><child link='${name}'/>
    <axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>
</xacro:macro>
<xacro:macro name='chair' params='*seat **more'><f><xacro:insert_block name='seat'/>
  <xacro:insert_block name='kept'/></f></xacro:macro>
</robot>";

const ROBOT: &str = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>
<xacro:arg name='kind' default='small'/>
<xacro:include filename='macros.xacro'/>
<xacro:property name='m1' value='1'/>
<xacro:property name='q' value='${p}'/>
<xacro:property name='p' value='1'/>
<xacro:property name='kept'><g/></xacro:property>
<!-- no file -->
<u><a x='1'/><b x='2'>${3}</b><e x='$(arg kind)'/><e x='${q}'/></u>
<u><h1 x='1'/><h2 x='1'/><h3 x='&amp;'/><h4></h4></u>
<u><xacro:chair><seat at='1'/><more/></xacro:chair></u>
<link name='body'><inertial><mass value='1.01'/>
  <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>
  <collision><origin xyz='0 0 0' rpy='0 0 0.1'/><geometry><sphere radius='${1 / 2}'/></geometry></collision>
  <collision><geometry><cylinder radius='1' length='${(2)}'/></geometry></collision>
  <collision><geometry><box size='0.01 0.01 0.01'/></geometry></collision></link>
<xacro:leg name='fore'/>
<xacro:leg name='hind'/>
<link name='foot'/>
<joint name='ankle' type='fixed'><parent link='hind'/><child link='foot'/></joint>
<xacro:if value='true'><link name='tail'><inertial><mass value='1'/>
  <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
<joint name='wag' type='revolute'><parent link='body'/><child link='tail'/><axis xyz='0 1 0'/>
  <limit lower='-1' upper='1' effort='1' velocity='1'/></joint></xacro:if>
<link name='head'><inertial><mass value='1'/>
  <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
<joint name='nod' type='revolute'><parent link='body'/><child link='head'/><axis xyz='0 1 0'/>
  <limit lower='-0.1' upper='0.1' effort='1' velocity='1'/></joint>
</robot>";

const SETTINGS: &str = "[solver]
tolerance = 1e-4
[world]
gravity = [0, 0, -9.81]
[[actuator]]
joint = 'hind_joint'
mode = 'velocity'
";

/// What is told of the robot with these faults.
fn told(folder: &Path, faults: &[&[&str; 3]]) -> Vec<Value> {
    let mut found = 0;
    let mut text = |sound: &str| {
        faults.iter().fold(sound.to_owned(), |text, [old, new, _]| {
            found += text.matches(old).count();
            text.replace(old, new)
        })
    };
    write(folder, "macros.xacro", text(MACROS));
    let robot = write(folder, "r.urdf.xacro", text(ROBOT));
    let config = write(folder, "r.toml", text(SETTINGS));
    assert_eq!(found, faults.len(), "{faults:?}");
    let (ok, list) = findings(&robot, &["--config", super::text(&config)]);
    assert_eq!(ok, of_severity(&list, "error").is_empty());
    list
}

/// Messages of the errors among it.
fn errors(folder: &Path, faults: &[&[&str; 3]]) -> Vec<String> {
    let list = told(folder, faults);
    let message = |finding: &&Value| finding["message"].as_str().unwrap().to_owned();
    of_severity(&list, "error").iter().map(message).collect()
}

#[test]
fn of_two_faults_of_a_xacro_file_both_are_told_in_one_run() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(errors(folder.path(), &[]), [""; 0], "the sound robot");
    for fault in &FAULTS {
        let told = errors(folder.path(), &[fault]);
        let [message] = &told[..] else {
            panic!("{}: {told:?}", fault[1]);
        };
        assert!(message.contains(fault[2]), "{}: {message}", fault[1]);
    }
    let mut hidden = Vec::new();
    for (i, first) in FAULTS.iter().enumerate() {
        for second in &FAULTS[i + 1..] {
            let told = errors(folder.path(), &[first, second]);
            let each = [first, second].map(|fault| told.iter().any(|t| t.contains(fault[2])));
            if each != [true, true] || told.len() != 2 {
                hidden.push(format!("{} | {}: {told:?}", first[1], second[1]));
            }
        }
    }
    assert!(
        hidden.is_empty(),
        "{}:\n{}",
        hidden.len(),
        hidden.join("\n")
    );
}

/// What a file that is not there would define is not asked for: a name may be in it.
#[test]
fn what_a_missing_file_of_macros_may_define_is_not_told() {
    let folder = tempfile::tempdir().unwrap();
    let missing = ["filename='macros.xacro'", "filename='no.xacro'", "no.xacro"];
    let told = errors(folder.path(), &[&missing]);
    assert!(told.len() == 1 && told[0].contains("no.xacro"), "{told:?}");
    // What no file can define is told beside it.
    let number = ["<mass value='1.01'/>", "<mass value='1,01'/>", ""];
    let division = ["radius='${1 / 2}'", "radius='${1 / 0}'", ""];
    let told = errors(folder.path(), &[&missing, &number, &division]);
    assert_eq!(told.len(), 3, "{told:?}");
}

/// One warning lists it: names that a file may define which is not there, and names of what is left
/// out. Whoever mends the first fault has seen the second one.
#[test]
fn what_may_follow_from_a_fault_or_be_wrong_too_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    let missing = ["filename='macros.xacro'", "filename='no.xacro'", "no.xacro"];
    let call = [
        "<xacro:leg name='hind'/>",
        "<xacro:legg name='hind'/>",
        "no macro 'legg'",
    ];
    let property = ["length='${(2)}'", "length='${mm}'", "'mm' is not defined"];
    let setting = [
        "joint = 'hind_joint'",
        "joint = 'hint_joint'",
        "'hint_joint'",
    ];
    let parent = ["<parent link='hind'/>", "<parent link='hint'/>", "'hint'"];
    for faults in [
        &[missing, call][..],
        &[missing, property],
        &[missing, setting],
        &[missing, parent],
        &[missing, call, property, setting, parent],
        // A call that is left out may hold what is named.
        &[call, setting],
        &[call, parent],
    ] {
        let list = told(folder.path(), &faults.iter().collect::<Vec<_>>());
        let errors = of_severity(&list, "error");
        let [error] = &errors[..] else {
            panic!("{faults:?}: {errors:?}");
        };
        let first = error["message"].as_str().unwrap();
        assert!(first.contains(faults[0][2]), "{faults:?}: {first}");
        let may: Vec<_> = list.iter().filter(|f| f["code"] == "U068").collect();
        assert_eq!(may.len(), 1, "{list:?}");
        assert_eq!(may[0]["severity"], "warning");
        let help = may[0]["help"].as_str().unwrap();
        for fault in &faults[1..] {
            assert!(help.contains(fault[2]), "{fault:?}: {help}");
        }
    }
}

/// A camera of a field robot: the frame that a joint names is written in an included file, for an
/// argument that is false.
#[test]
fn a_link_that_a_condition_of_xacro_left_out_is_told_with_file_line_and_condition() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let camera = "<robot xmlns:xacro='x'>\n<xacro:macro name='cam' params='name'>\n\
                  <link name='${name}_link'/>\n<xacro:if value='${nominal}'>\n\
                  <link name='${name}_depth_frame'/>\n</xacro:if>\n</xacro:macro></robot>";
    write(root, "cam.xacro", camera);
    let robot = "<robot name='r' xmlns:xacro='x'><xacro:arg name='nominal' default='false'/>\
                 <xacro:property name='nominal' value='$(arg nominal)'/>\
                 <xacro:include filename='cam.xacro'/><xacro:cam name='d415'/><link name='b'/>\
                 <joint name='j' type='fixed'><parent link='d415_depth_frame'/>\
                 <child link='b'/></joint></robot>";
    let (ok, list) = findings(&write(root, "r.urdf.xacro", robot), &[]);
    let of_link = list.iter().find(|f| f["code"] == "U016").unwrap();
    let help = of_link["help"].as_str().unwrap();
    assert!(
        !ok && help.contains("cam.xacro:5 writes <link name=\"${name}_depth_frame\">")
            && help.contains("<xacro:if value='${nominal}'>, which may have left it out"),
        "{help}"
    );
}
