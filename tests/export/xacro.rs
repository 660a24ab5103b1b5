//! Robots written in xacro, in every command.
//!
//! Expected texts are what xacro 2.1.1 of the Python package makes of the same files;
//! `tests/corpus/xacro.py` compares the two on whole collections.

use super::*;

/// A package with a robot of two files, macros, blocks, conditions, lists, YAML and arguments.
fn package(folder: &Path) -> PathBuf {
    let package = folder.join("my_arm_description");
    for below in ["urdf", "config", "meshes"] {
        fs::create_dir_all(package.join(below)).unwrap();
    }
    fs::write(
        package.join("package.xml"),
        "<package><name>arm_description</name></package>",
    )
    .unwrap();
    fs::write(
        package.join("config/arm.yaml"),
        "links: {upper: {mass: 2.5, size: [0.1, 0.2, 0.3]}, lower: {mass: 1.5}}\nangle: !degrees 90\n",
    )
    .unwrap();
    fs::write(
        package.join("urdf/macros.xacro"),
        r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="half" value="${pi / 2}"/>
  <xacro:macro name="box" params="mass size:='1 1 1' *origin">
    <inertial>
      <xacro:insert_block name="origin"/>
      <mass value="${mass}"/>
      <xacro:property name="s" value="${[float(x) for x in size.split()]}"/>
      <inertia ixx="${mass / 12 * (s[1]**2 + s[2]**2)}" ixy="0" ixz="0"
               iyy="${mass / 12 * (s[0]**2 + s[2]**2)}" iyz="0" izz="${mass / 12 * (s[0]**2 + s[1]**2)}"/>
    </inertial>
  </xacro:macro>
  <xacro:macro name="part" params="name parent:=^ **extra">
    <link name="${prefix}${name}"><xacro:insert_block name="extra"/></link>
    <joint name="${prefix}${name}_joint" type="revolute">
      <origin xyz="0 0 0.3" rpy="0 ${half} ${-angle}"/>
      <parent link="${prefix}${parent}"/><child link="${prefix}${name}"/><axis xyz="0 1 0"/>
      <limit lower="${radians(-90)}" upper="${1.5 if not wide else 2}" effort="${10 // 3}" velocity="2"/>
    </joint>
  </xacro:macro>
</robot>"#,
    )
    .unwrap();
    let robot = package.join("urdf/arm.urdf.xacro");
    fs::write(
        &robot,
        r#"<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="prefix" default=""/>
  <xacro:arg name="wide" default="false"/>
  <xacro:include filename="$(find arm_description)/urdf/macros.xacro"/>
  <xacro:property name="prefix" value="$(arg prefix)"/>
  <xacro:property name="wide" value="$(arg wide)"/>
  <xacro:property name="data" value="${xacro.load_yaml('../config/arm.yaml')}"/>
  <xacro:property name="angle" value="${data.angle}"/>
  <link name="${prefix}base"/>
  <xacro:property name="parent" value="base"/>
  <xacro:part name="upper">
    <x><xacro:box mass="${data['links']['upper'].mass}" size="${' '.join(map(str, data.links.upper.size))}">
      <origin xyz="0 0 0.15"/>
    </xacro:box></x>
  </xacro:part>
  <xacro:unless value="${len(prefix) == 0}">
    <link name="${prefix}marker"/>
    <joint name="marker_joint" type="fixed"><parent link="${prefix}upper"/><child link="${prefix}marker"/></joint>
  </xacro:unless>
  <xacro:if value="$(arg wide)"><gazebo>$${kept} $(arg prefix)</gazebo></xacro:if>
</robot>"#,
    )
    .unwrap();
    robot
}

#[test]
fn a_xacro_file_is_expanded_as_by_ros_without_python() {
    let folder = tempfile::tempdir().unwrap();
    let robot = package(folder.path());
    let run = |args: &[&str]| run_in(folder.path(), args, &[("PATH", "/nowhere")]);
    let done = run(&["expand", text(&robot), "prefix:=left_", "wide:=true"]);
    assert_eq!(done.code, 0, "{done:?}");
    // As the program of ROS writes it, but for its comment.
    let expected = r#"<?xml version="1.0" ?>
<!-- expanded from xacro -->
<robot name="arm">
  <link name="left_base"/>
  <link name="left_upper">
    <inertial>
      <origin xyz="0 0 0.15"/>
      <mass value="2.5"/>
      <inertia ixx="0.027083333333333334" ixy="0" ixz="0" iyy="0.020833333333333336" iyz="0" izz="0.01041666666666667"/>
    </inertial>
  </link>
  <joint name="left_upper_joint" type="revolute">
    <origin rpy="0 1.5707963267948966 -1.5707963267948966" xyz="0 0 0.3"/>
    <parent link="left_base"/>
    <child link="left_upper"/>
    <axis xyz="0 1 0"/>
    <limit effort="3" lower="-1.5707963267948966" upper="2" velocity="2"/>
  </joint>
  <link name="left_marker"/>
  <joint name="marker_joint" type="fixed">
    <parent link="left_upper"/>
    <child link="left_marker"/>
  </joint>
  <gazebo>${kept} left_</gazebo>
</robot>
"#;
    assert_eq!(done.out, expected);
    // Every command takes the file itself.
    let done = run(&["info", text(&robot), "prefix:=r_", "--json"]);
    assert_eq!(done.code, 0, "{done:?}");
    let info: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(info["mass"], 2.5);
    assert_eq!(info["links"][1]["name"], "r_upper");
    // The FMU holds the expanded text, without a path of this machine.
    let done = run(&["export", text(&robot)]);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.out.contains("expanded from xacro"), "{}", done.out);
    let (_, contents) = entries(&folder.path().join("arm.fmu"));
    let packed = contents.iter().find(|(name, _)| name.ends_with("arm.urdf"));
    let packed = String::from_utf8_lossy(packed.expect("the source").1).into_owned();
    assert!(packed.contains("<mass value=\"2.5\"/>"), "{packed}");
    assert!(!packed.contains(text(folder.path())), "{packed}");
}

#[test]
fn a_urdf_with_xacro_in_it_is_expanded_and_a_lone_call_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let ball = "<link name='ball'><inertial><mass value='${m}'/>\
                <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
    let robot = write(
        "ball.urdf",
        &format!("<robot name='r'><xacro:property name='m' value='3'/>{ball}</robot>"),
    );
    let done = urdf2fmu(["info", text(&robot), "--json"]);
    assert_eq!(done.code, 0, "{done:?}");
    let info: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(info["mass"], 3.0);
    // The rest of a call whose macro was never there: others pass over it.
    let rest = write(
        "rest.urdf",
        &format!(
            "<robot name='r'>{}<xacro:sensors/></robot>",
            ball.replace("${m}", "3")
        ),
    );
    let done = urdf2fmu(["check", text(&rest)]);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.out.contains("warning[U006]") && done.out.contains("<xacro:sensors>"));
    assert_eq!(
        urdf2fmu(["check", text(&rest), "--deny", "warnings"]).code,
        1
    );
}

#[test]
fn what_a_xacro_file_lacks_is_told_with_the_call_that_gives_it() {
    let folder = tempfile::tempdir().unwrap();
    let write = |text: &str| {
        let path = folder.path().join("r.urdf.xacro");
        let head = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>";
        fs::write(&path, format!("{head}\n{text}</robot>")).unwrap();
        path
    };
    let told = |xml: &str, args: &[&str]| {
        let path = write(xml);
        let mut all = vec!["check", text(&path)];
        all.extend(args);
        let done = run_in(folder.path(), &all, &[("PATH", "/nowhere")]);
        assert_eq!(done.code, 1, "{done:?}");
        done.err
    };
    let both = "<link name='$(arg side)_$(arg kind)'/><xacro:arg name='with' default='1'/>";
    for (xml, args, parts) in [
        (both, &[][..], &["'kind', 'side'", "kind:=… side:=…"][..]),
        (
            both,
            &["side:=left"],
            &["'kind' has no value", "side:=left kind:=…"],
        ),
        (
            "<link name='$(find my_pkg)'/>",
            &[],
            &["the package 'my_pkg' is not found", "--package my_pkg=DIR"],
        ),
        (
            "<xacro:wheel/>",
            &[],
            &["there is no macro 'wheel'", "r.urdf.xacro:2:1"],
        ),
        (
            "<link name='${a + 1}'/>",
            &[],
            &["name 'a' is not defined, in ${a + 1}"],
        ),
        ("<link name='${1 / 0}'/>", &[], &["division by zero"]),
        ("<link name='${(1}'/>", &[], &["')' is missing"]),
        (
            "<xacro:property name='a' value='${b}'/><xacro:property name='b' value='${a}'/><link name='${a}'/>",
            &[],
            &["the property 'a' needs itself"],
        ),
        (
            "<xacro:macro name='m' params='a b'><link name='${a}'/></xacro:macro><xacro:m a='1'/>",
            &[],
            &["macro 'm' needs 'b'"],
        ),
        (
            "<xacro:macro name='m' params=''><xacro:m/></xacro:macro><xacro:m/>",
            &[],
            &["calls itself without an end"],
        ),
        // Found by fuzzing: through what stands in its call.
        (
            "<xacro:macro name='m' params=''><xacro:m><xacro:m/></xacro:m></xacro:macro><xacro:m/>",
            &[],
            &["calls itself without an end"],
        ),
        (
            "<xacro:include filename='r.urdf.xacro'/>",
            &[],
            &["files include each other in a circle"],
        ),
        (
            "<xacro:include filename='nothing.xacro'/>",
            &[],
            &["the included file", "nothing.xacro cannot be read"],
        ),
        ("<link name='a'><b></link>", &[], &["not XML"]),
        (
            "<xacro:macro name='arm' params='x'/>",
            &[],
            &[
                "only defines macros for other files, arm",
                "the robot has no links",
            ],
        ),
    ] {
        let err = told(xml, args);
        for part in parts {
            assert!(err.contains(part), "{part}\n{err}");
        }
    }
    // An argument for a file that takes none, and one that is none.
    let plain = folder.path().join("plain.urdf");
    fs::write(&plain, "<robot name='r'><link name='a'/></robot>").unwrap();
    let done = urdf2fmu(["check", text(&plain), "mass:=1"]);
    assert!(
        done.code == 1 && done.err.contains("no xacro file"),
        "{done:?}"
    );
    let done = urdf2fmu(["check", text(&plain), "mass=1"]);
    assert!(
        done.code == 2 && done.err.contains("name:=value"),
        "{done:?}"
    );
}

/// What is Python beyond what is known here is left to the command, with an index of packages such
/// as ROS 2's. Here a script says what it is given; `tests/python/test_xacro.py` runs the command
/// itself.
#[test]
fn expressions_that_are_not_known_are_left_to_the_command() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let robot = package(folder.path());
    fs::write(
        &robot,
        "<robot xmlns:xacro='x' name='$(find arm_description)'><link name='${(lambda x: x)(1)}'/></robot>",
    )
    .unwrap();
    let script = folder.path().join("xacro");
    // Answers only where the package is in the index, and where Python's module can be found.
    fs::write(
        &script,
        "#!/bin/sh\np=${AMENT_PREFIX_PATH%%:*}\n\
         test -e $p/share/ament_index/resource_index/packages/arm_description || exit 1\n\
         test -e $p/share/arm_description/package.xml || exit 1\n\
         test -e ${PYTHONPATH%%:*}/ament_index_python/packages.py || exit 1\n\
         echo \"<robot name='from_the_command'><link name='a'/></robot>\"\n",
    )
    .unwrap();
    fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!(
        "{}:{}",
        folder.path().display(),
        std::env::var("PATH").unwrap_or_default()
    );
    let done = run_in(folder.path(), &["expand", text(&robot)], &[("PATH", &path)]);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.out.contains("from_the_command"), "{}", done.out);
    let done = run_in(
        folder.path(),
        &["expand", text(&robot)],
        &[("PATH", "/nowhere")],
    );
    assert_eq!(done.code, 1);
    assert!(
        done.err.contains("'lambda'") && done.err.contains("pip install xacro"),
        "{}",
        done.err
    );
}

/// Each would fill every memory or every stack, and the last one would wait for ever.
#[test]
fn a_xacro_file_that_grows_without_bound_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let property =
        |name: &str, value: &str| format!("<xacro:property name=\"{name}\" value=\"{value}\"/>\n");
    let doubled = |first: &str, sum: fn(usize) -> String| -> String {
        let rows = (1..64).map(|i| property(&format!("p{i}"), &sum(i - 1)));
        property("p0", first) + &rows.collect::<String>()
    };
    let texts = doubled("0123456789abcdef", |i| format!("${{p{i} + p{i}}}"));
    let joined = doubled("0123456789abcdef", |i| format!("${{p{i}}}${{p{i}}}"));
    let lists = doubled("${[1]}", |i| format!("${{[p{i}, p{i}]}}"));
    let chain: String = (0..100_000)
        .map(|i| property(&format!("p{i}"), &format!("${{p{} + 1}}", i + 1)))
        .collect();
    let end = "<link name=\"${p63}\"/>";
    let mut cases = vec![
        (texts + end, "a value has more than"),
        (joined + end, "a value has more than"),
        (lists + end, "a value has more than"),
        (chain + "<link name=\"${p0}\"/>", "need each other"),
    ];
    if cfg!(unix) {
        let pipe = folder.path().join("pipe");
        let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        let include = "<xacro:include filename=\"pipe\"/>".to_owned();
        cases.push((include, "it is a pipe, not a file"));
    }
    for (body, expected) in cases {
        let path = folder.path().join("r.xacro");
        let text = format!("<robot xmlns:xacro='x' name='r'>\n{body}</robot>");
        fs::write(&path, text).unwrap();
        let done = urdf2fmu(["expand", path.to_str().unwrap()]);
        assert_eq!(done.code, 1, "{expected}");
        assert!(done.err.contains(expected), "{expected}: {}", done.err);
    }
}

/// Universal Robots' description: its default names a folder that is not there, and that the file
/// is missing says nothing of the argument.
#[test]
fn a_file_that_is_missing_by_the_value_of_an_argument_is_told_with_the_argument() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["ur10e", "ur3e"] {
        fs::create_dir_all(folder.path().join("config").join(name)).unwrap();
        let file = folder.path().join("config").join(name).join("limits.yaml");
        fs::write(file, "mass: 2\n").unwrap();
    }
    // With these the file would be missing, too.
    fs::create_dir_all(folder.path().join("config/docs")).unwrap();
    fs::write(folder.path().join("config/initial.yaml"), "").unwrap();
    let robot = folder.path().join("ur.urdf.xacro");
    fs::write(
        &robot,
        "<robot name='ur' xmlns:xacro='http://www.ros.org/wiki/xacro'>\
         <xacro:arg name='ur_type' default='ur5x'/>\
         <xacro:property name='file' value='config/$(arg ur_type)/limits.yaml'/>\
         <xacro:property name='limits' value='${xacro.load_yaml(file)}'/>\
         <link name='base'><inertial><mass value='${limits[\"mass\"]}'/>\
         <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>",
    )
    .unwrap();
    let done = urdf2fmu(["check", text(&robot)]);
    assert_eq!(done.code, 1, "{done:?}");
    for part in [
        "the argument 'ur_type' is 'ur5x'",
        "ur_type:=…",
        "has ur10e, ur3e\n",
    ] {
        assert!(done.err.contains(part), "{part}: {}", done.err);
    }
    let done = urdf2fmu(["check", text(&robot), "ur_type:=ur3e"]);
    assert_eq!(done.code, 0, "{done:?}");
}

/// However the file is named, with a folder or without. Expected: the links that xacro 2.1.1 makes
/// of them in all three calls, and its warning "matched no files".
#[test]
fn parts_and_folders_do_not_depend_on_how_the_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for name in ["part2", "part1", "a1", "a3", "more/part5"] {
        let file = here.join(format!("{name}.xacro"));
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        let link = name.replace('/', "_");
        fs::write(file, format!("<robot><link name='{link}'/></robot>")).unwrap();
    }
    let joined = |child: &str| {
        format!(
            "<joint name='{child}_j' type='fixed'><parent link='l'/><child link='{child}'/></joint>"
        )
    };
    let joints: String = ["part1", "part2", "a1", "more_part5"].map(joined).concat();
    fs::write(
        here.join("arm.urdf.xacro"),
        format!(
            "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><link name='l'/>\
             <xacro:include filename='part*.xacro'/><xacro:include filename='a[12].xacro'/>\
             <xacro:include filename='$(dirname)/m?re/*.xacro'/>\
             <xacro:include filename='nope*.xacro'/>{joints}</robot>"
        ),
    )
    .unwrap();
    let absolute = here.join("arm.urdf.xacro");
    for named in ["arm.urdf.xacro", "./arm.urdf.xacro", text(&absolute)] {
        let done = run_in(here, &["expand", named], &[]);
        assert_eq!(done.code, 0, "{named}: {done:?}");
        let links: Vec<&str> = done.out.split("<link name=\"").skip(1).collect();
        let links: Vec<&str> = links.iter().map(|l| l.split('"').next().unwrap()).collect();
        assert_eq!(
            links,
            ["l", "part1", "part2", "a1", "more_part5"],
            "{named}"
        );
        let told = "warning[U118]: no file matches 'nope*.xacro'";
        assert!(done.err.contains(told), "{named}: {}", done.err);
    }
}

#[test]
fn an_include_without_a_name_and_what_is_no_file_are_told_as_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("r.urdf.xacro");
    fs::write(
        &robot,
        "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><link name='l'/>\
         <xacro:include filename=''/></robot>",
    )
    .unwrap();
    let done = urdf2fmu(["check", text(&robot)]);
    let told = "<xacro:include>: a file without a name cannot be read";
    assert!(done.err.contains(told), "{}", done.err);
    let done = urdf2fmu(["expand", "/dev/null"]);
    assert_eq!(done.code, 1, "{done:?}");
    assert!(!done.err.contains("did you mean"), "{}", done.err);
}
