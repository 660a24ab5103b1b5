//! A robot with other things around it: from the command line and from settings.

use super::*;

const CUBE: &str = r#"<robot name="cube.urdf"><link name="body">
<inertial><mass value="2"/>
<inertia ixx="0.0133333" iyy="0.0133333" izz="0.0133333" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
</link></robot>"#;

/// As `PyBullet`'s: a ground and nothing else.
const PLANE: &str = r#"<robot name="plane"><link name="planeLink">
<contact><lateral_friction value="0.5"/></contact>
<inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 -5"/><geometry><box size="30 30 10"/></geometry></collision>
</link></robot>"#;

/// A folder with both.
fn files() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cube.urdf"), CUBE).unwrap();
    fs::write(folder.path().join("plane.urdf"), PLANE).unwrap();
    folder
}

/// The last row of a run, by names.
fn last(folder: &Path, args: &[&str]) -> BTreeMap<String, f64> {
    let mut all = vec!["simulate", "--quiet", "--output-file", "out.csv"];
    all.extend(args);
    let run = run_in(folder, &all, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    let table = fs::read_to_string(folder.join("out.csv")).unwrap();
    let names = table.lines().next().unwrap().split(',');
    let names = names.map(|name| name.trim_matches('"').to_owned());
    let values = table.lines().last().unwrap().split(',');
    names
        .zip(values.map(|x| x.parse().unwrap_or(f64::NAN)))
        .collect()
}

#[test]
fn a_plane_two_cubes_and_a_rover_need_no_settings() {
    let folder = files();
    let rover = std::path::absolute(example("rover.urdf")).unwrap();
    let args = [
        "export",
        text(&rover),
        "-o",
        "world.fmu",
        "--object",
        "plane.urdf",
        "--object",
        "cube.urdf@2,0",
        "--object",
        "cube.urdf@2,0,1.1",
    ];
    let run = run_in(folder.path(), &args, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("nothing but a ground"), "{}", run.out);
    let around = "around it  object cube (floating, 2 kg), object cube2 (floating, 2 kg)";
    assert!(run.out.contains(around), "{}", run.out);
    let fmu = folder.path().join("world.fmu");
    let (names, contents) = entries(&fmu);
    let packed = |file: &str| names.iter().any(|name| name.ends_with(file));
    assert!(packed("/cube.urdf") && packed("/plane.urdf"), "{names:?}");
    let page = String::from_utf8_lossy(&contents["documentation/index.html"]);
    assert!(page.contains("object cube2 (floating, 2 kg)"));

    let told = info(&fmu, &[]);
    let world = told["world"].as_array().unwrap();
    let of = |i: usize, key: &str| world[i][key].as_str().unwrap().to_owned();
    assert_eq!(world.len(), 3);
    assert_eq!([of(1, "name"), of(2, "name")], ["cube", "cube2"]);
    assert_eq!([of(0, "kind"), of(1, "kind")], ["robot", "object"]);
    let friction = told["variables"].as_array().unwrap();
    let named = |v: &&Value| v["name"] == "world.ground.friction";
    let friction = friction.iter().find(named).unwrap();
    assert_eq!(friction["start"], 0.5);

    // z = 1.1 − g t² / 2 until it meets the first cube, at 0.3 s.
    let falling = last(folder.path(), &["world.fmu", "--stop-time", "0.3"]);
    let expected = 1.1 - 0.5 * 9.81 * 0.3 * 0.3;
    let z = falling["object.cube2.position.z"];
    assert!((z - expected).abs() < 1e-6, "{z} {expected}");
    assert!((falling["object.cube.position.z"] - 0.1).abs() < 1e-4);
    // Whoever begins elsewhere says so with a parameter.
    let args = ["world.fmu", "--stop-time", "0.1", "--start-value"];
    let moved = [&args[..], &["initial.object.cube2.position.z", "2"]].concat();
    let z = last(folder.path(), &moved)["object.cube2.position.z"];
    assert!((z - (2.0 - 0.5 * 9.81 * 0.01)).abs() < 1e-6, "{z}");
}

#[test]
fn a_cube_on_a_static_table_rests_at_its_height_and_two_robots_take_commands() {
    let folder = files();
    let arm = std::path::absolute(example("arm.urdf")).unwrap();
    fs::write(
        folder.path().join("world.toml"),
        format!(
            "[[world.object]]\nname = \"table\"\nshape = {{ box = [1, 1, 0.4] }}\nstatic = true\n\
             xyz = [3, 0]\n[[world.object]]\nname = \"cup\"\nurdf = \"cube.urdf\"\n\
             xyz = [3, 0, 0.5]\n[[world.robot]]\nname = \"left\"\nurdf = '{}'\nxyz = [-3, 0, 0]\n",
            text(&arm)
        ),
    )
    .unwrap();
    let rover = std::path::absolute(example("rover.urdf")).unwrap();
    let end = last(
        folder.path(),
        &[text(&rover), "-c", "world.toml", "--stop-time", "1"],
    );
    // Its face lies on the table: less deep than the penetration.
    let z = end["object.cup.position.z"];
    assert!((0.4999..=0.5).contains(&z), "{z}");
    assert!(end["object.cup.position.x"] - 3.0 < 1e-6);
    assert!((end["object.cup.contact.body.force.z"] - 2.0 * 9.81).abs() < 0.01);
    assert!(end.keys().any(|name| name.starts_with("left.joint.")));
    let inputs = info(&rover, &["-c", text(&folder.path().join("world.toml"))]);
    let variables = inputs["variables"].as_array().unwrap();
    let starts = |prefix: &str| {
        let named = |v: &&Value| v["name"].as_str().unwrap().starts_with(prefix);
        variables.iter().filter(named).count()
    };
    assert!(starts("left.cmd.") > 0 && starts("cmd.") > 0);
}

#[test]
fn what_is_wrong_with_an_object_is_told_with_its_file() {
    let folder = files();
    let rover = std::path::absolute(example("rover.urdf")).unwrap();
    let broken = CUBE.replace("value=\"2\"", "value=\"-2\"");
    fs::write(folder.path().join("broken.urdf"), broken).unwrap();
    for (object, words) in [("broken.urdf", "broken.urdf:2"), ("no.urdf", "no.urdf")] {
        let args = ["check", text(&rover), "--object", object];
        let run = run_in(folder.path(), &args, &[]);
        assert_eq!(run.code, 1, "{run:?}");
        assert!(run.err.contains(words), "{object}: {}", run.err);
    }
    let args = ["check", text(&rover), "--object", "cube.urdf@1"];
    let run = run_in(folder.path(), &args, &[]);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains("FILE@X,Y,Z"), "{}", run.err);
}

/// Their bytes are neither text nor XML, which would help nobody.
#[test]
fn a_mesh_as_an_object_is_told_as_one() {
    let folder = files();
    fs::write(folder.path().join("part.stl"), [0x9a; 84]).unwrap();
    fs::write(folder.path().join("part.obj"), "v 0 0 0\n").unwrap();
    let settings = "[[world.object]]\nname = \"o\"\nurdf = \"part.stl\"\n";
    fs::write(folder.path().join("w.toml"), settings).unwrap();
    for args in [
        ["--object", "part.stl@1,0"],
        ["--object", "part.obj@1,0"],
        ["-c", "w.toml"],
    ] {
        let run = run_in(
            folder.path(),
            &[&["check", "cube.urdf"], &args[..]].concat(),
            &[],
        );
        assert_eq!(run.code, 1, "{run:?}");
        let told = "is a mesh: give the URDF that uses it";
        assert!(run.err.contains(told), "{run:?}");
        assert!(
            !run.err.contains("U002") && !run.err.contains("U003"),
            "{run:?}"
        );
    }
}

#[test]
fn init_writes_the_objects_that_it_is_given() {
    let folder = files();
    let rover = std::path::absolute(example("rover.urdf")).unwrap();
    let objects = [
        "--object",
        "plane.urdf",
        "--object",
        "cube.urdf@2,0,1,0,0,0.5",
    ];
    let args = [&["init", text(&rover)][..], &objects].concat();
    let run = run_in(folder.path(), &args, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    fs::write(folder.path().join("init.toml"), run.out).unwrap();
    let export = |fmu: &str, options: &[&str]| {
        let bare = ["export", text(&rover), "-o", fmu, "--no-documentation"];
        let args = [&bare[..], options].concat();
        let run = run_in(folder.path(), &args, &[]);
        assert_eq!(run.code, 0, "{run:?}");
        entries(&folder.path().join(fmu))
            .1
            .remove("resources/model.json")
    };
    assert_eq!(
        export("a.fmu", &objects).map(|bytes| String::from_utf8(bytes).unwrap()),
        export("b.fmu", &["-c", "init.toml"]).map(|bytes| String::from_utf8(bytes).unwrap())
    );
}

/// Two fingers that slide along x towards each other, 10 cm apart and half a metre up.
fn gripper() -> String {
    let finger = |name: &str, x: f64| {
        format!(
            r#"<link name="{name}_finger">
<inertial><mass value="0.1"/>
<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.02 0.06 0.06"/></geometry></collision></link>
<joint name="{name}" type="prismatic"><parent link="world"/><child link="{name}_finger"/>
<origin xyz="{x} 0 0.5"/><axis xyz="1 0 0"/>
<limit lower="-0.1" upper="0.1" effort="20" velocity="1"/></joint>"#
        )
    };
    let fingers = finger("left", -0.06) + &finger("right", 0.06);
    format!(r#"<robot name="gripper"><link name="world"/>{fingers}</robot>"#)
}

#[test]
fn an_fmu_shows_how_a_gripper_holds_a_cube() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gripper.urdf"), gripper()).unwrap();
    fs::write(
        folder.path().join("grasp.toml"),
        "solver.tolerance = 1e-4\n[[actuator]]\njoint = \"*\"\nmode = \"effort\"\n\
         [[world.object]]\nname = \"cube\"\nshape = { box = [0.1, 0.1, 0.1] }\nmass = 0.5\n\
         xyz = [0, 0, 0.5]\n\
         [[outputs.pair]]\nname = \"left\"\nfirst = \"left_finger\"\nsecond = \"cube\"\n\
         [[outputs.pair]]\nname = \"right\"\nfirst = \"cube\"\nsecond = \"right_finger\"\n\
         [[outputs.pair]]\nname = \"stand\"\nfirst = \"cube\"\nsecond = \"ground\"\n",
    )
    .unwrap();
    let args = [
        "export",
        "gripper.urdf",
        "-c",
        "grasp.toml",
        "-o",
        "grasp.fmu",
    ];
    let run = run_in(folder.path(), &args, &[]);
    assert_eq!(run.code, 0, "{run:?}");

    let fmu = folder.path().join("grasp.fmu");
    let xml = description(&fmu);
    assert_eq!(model_description::problems(&xml), Vec::<String>::new());
    let told = info(&fmu, &[]);
    let variables = told["variables"].as_array().unwrap();
    let named = |name: &str| {
        let found = variables.iter().find(|v| v["name"] == name);
        found.unwrap_or_else(|| panic!("no {name}"))
    };
    for (quantity, unit) in [
        ("force.x", "N"),
        ("point.y", "m"),
        ("normal.z", "1"),
        ("depth", "m"),
        ("slip_speed", "m/s"),
    ] {
        let name = format!("pair.left.{quantity}");
        assert!(xml.contains(&format!("name=\"{name}\"")), "{name}");
        assert_eq!(named(&name)["unit"], unit, "{name}");
    }
    assert!(xml.contains("name=\"pair.right.active\""));
    let page = String::from_utf8(entries(&fmu).1.remove("documentation/index.html").unwrap());
    assert!(page.unwrap().contains("on each other: pair 'left'"));

    let end = last(
        folder.path(),
        &[
            "grasp.fmu",
            "--stop-time",
            "2",
            "--start-value",
            "cmd.left.effort",
            "10",
            "--start-value",
            "cmd.right.effort",
            "-10",
        ],
    );
    let near = |name: &str, expected: f64, tolerance: f64| {
        let found = end[name];
        assert!((found - expected).abs() <= tolerance, "{name} {found}");
    };
    // The fingers press with their motors' force and carry half of the weight each.
    let half = 0.5 * 0.5 * 9.81;
    near("pair.left.force.x", -10.0, 1e-6);
    near("pair.left.force.z", -half, 1e-6);
    near("pair.right.force.x", -10.0, 1e-6);
    near("pair.right.force.z", half, 1e-6);
    near("pair.left.active", 1.0, 0.0);
    near("pair.left.normal.x", -1.0, 1e-6);
    near("pair.right.normal.x", -1.0, 1e-6);
    near("pair.left.point.x", -0.05, 1e-4);
    near("pair.left.slip_speed", 0.0, 1e-6);
    assert!((1e-6..1e-3).contains(&end["pair.left.depth"]));
    // It hangs in the air.
    near("pair.stand.active", 0.0, 0.0);
    near("pair.stand.force.z", 0.0, 0.0);
    near("pair.stand.point.z", end["object.cube.position.z"], 0.0);
}

#[test]
fn a_pair_that_names_nothing_is_told_with_its_line() {
    let folder = files();
    let rover = std::path::absolute(example("rover.urdf")).unwrap();
    let pair = "[[outputs.pair]]\nname = \"a\"\nfirst = \"cube.bodi\"\nsecond = \"ground\"\n";
    fs::write(folder.path().join("world.toml"), pair).unwrap();
    let objects = ["--object", "cube.urdf@2,0"];
    let args = [&["check", text(&rover), "-c", "world.toml"][..], &objects].concat();
    let run = run_in(folder.path(), &args, &[]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.err.contains("world.toml:3"), "{}", run.err);
    assert!(
        run.err.contains("the nearest is 'cube.body'"),
        "{}",
        run.err
    );
}

/// Names are looked up in what can be read, and not in the rest. Expected: the messages of the same
/// faults in a world of which all can be read.
#[test]
fn of_a_world_with_a_file_that_cannot_be_read_the_other_names_are_checked() {
    use super::people::{findings, of_severity, write};
    let folder = tempfile::tempdir().unwrap();
    let ball = |name: &str, radius: &str| {
        format!(
            "<robot name='{name}'><link name='shell'><inertial><mass value='1'/>\
             <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>\
             <collision><geometry><sphere radius='{radius}'/></geometry></collision></link></robot>"
        )
    };
    let robot = write(folder.path(), "robot.urdf", ball("robot", "0.1"));
    write(folder.path(), "table.urdf", ball("table", "0.1"));
    let settings = |second: &str| {
        let pair = |name: &str, second: &str| {
            format!("[[outputs.pair]]\nname = '{name}'\nfirst = 'shell'\nsecond = '{second}'\n")
        };
        let object = |name: &str, x: f64| {
            format!("[[world.object]]\nname = '{name}'\nurdf = '{name}.urdf'\nxyz = [{x}, 0, 1]\n")
        };
        let text = [
            object("cup", 3.0),
            object("table", 6.0),
            pair("lost", "cup.handle"),
            pair("any", "*.shell"),
            pair("other", second),
            format!("[[spring]]\nlinks = ['shell', '{second}']\nstiffness = 10\n"),
        ];
        write(folder.path(), "robot.toml", text.concat())
    };
    for (second, radius, expected) in [
        ("table.shell", "0.1", &["cup.handle"][..]),
        ("table.shell", "x", &["'x' is not a number"]),
        // The misspelled name is told of the pair and of the spring.
        (
            "tabel.shell",
            "x",
            &["'x' is not a number", "tabel", "tabel"],
        ),
    ] {
        write(folder.path(), "cup.urdf", ball("cup", radius));
        let config = settings(second);
        let (ok, list) = findings(&robot, &["--config", text(&config)]);
        let told = of_severity(&list, "error");
        let messages = told.iter().map(|f| f["message"].as_str().unwrap());
        let messages: Vec<_> = messages.collect();
        assert!(
            !ok && messages.len() == expected.len(),
            "{second} {radius}: {messages:?}"
        );
        for (message, part) in messages.iter().zip(expected) {
            assert!(message.contains(part), "{part}: {messages:?}");
        }
    }
}

/// What a key of an object does not do is told, and what belongs to a robot.
#[test]
fn an_idle_mass_and_a_sensor_on_an_object_are_told_with_what_helps() {
    let folder = tempfile::tempdir().unwrap();
    let check = |keys: &str| {
        let shape = "[[world.object]]\nname = 'cup'\nshape = { sphere = 0.1 }\nxyz = [2, 0]\n";
        let settings = people::write(folder.path(), "s.toml", format!("{shape}{keys}"));
        people::findings(&example("rover.urdf"), &["-c", text(&settings)])
    };
    for why in ["static", "driven"] {
        let (ok, list) = check(&format!("mass = 2\n{why} = true\n"));
        let message = packages::field(&list, "S106", "message");
        assert!(
            ok && message.contains(&format!("'cup' changes nothing: it is {why}")),
            "{list:?}"
        );
        let (ok, list) = check(&format!("{why} = true\n"));
        assert!(ok && list.iter().all(|f| f["code"] != "S106"), "{list:?}");
    }
    for name in ["cup", "cup.cup"] {
        let sensor = format!("mass = 2\n[[sensor]]\ntype = 'imu'\nlink = '{name}'\n");
        let (ok, list) = check(&sensor);
        let help = packages::field(&list, "A101", "help");
        assert!(
            !ok && help.starts_with("'cup' is an object of the world"),
            "{list:?}"
        );
    }
}

/// What an object offers works with an object: a density would let scenery fall, and is none's.
#[test]
fn a_door_without_mass_gets_the_missing_one() {
    let folder = tempfile::tempdir().unwrap();
    let panel = "<collision><geometry><box size='1 0.1 2'/></geometry></collision>";
    let door = format!(
        "<robot name='door'><link name='frame'/><link name='panel'>{panel}</link>\
         <joint name='hinge' type='revolute'><parent link='frame'/><child link='panel'/>\
         <origin xyz='0.5 0 1.1'/><axis xyz='0 0 1'/><limit lower='0' upper='2' effort='9' \
         velocity='9'/></joint></robot>"
    );
    people::write(folder.path(), "door.urdf", door);
    let object = format!("{}@5,0", folder.path().join("door.urdf").display());
    let check = |options: &[&str]| {
        let all = [&["--object", object.as_str()][..], options].concat();
        people::findings(&example("rover.urdf"), &all)
    };
    let (ok, list) = check(&[]);
    let help = packages::field(&list, "A104", "help");
    assert!(
        !ok && help.starts_with("--missing-mass 0.1 gives"),
        "{list:?}"
    );
    assert!(!help.contains("--density"), "{help}");
    assert!(check(&["--missing-mass", "0.1"]).0);
}

/// The numbers of a glTF terrain lie in a file of their own: it is packed as that of a robot's mesh
/// is, and read from the terrain's own folders alone.
#[test]
fn a_terrain_of_two_files_is_packed_whole_and_reads_nothing_outside_of_its_folders() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    fs::create_dir(&own).unwrap();
    fs::copy(example("rover.urdf"), own.join("rover.urdf")).unwrap();
    let corners = [-5.0_f32, -5.0, 0.0, 5.0, -5.0, 0.0, 0.0, 9.0, 0.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(own.join("floor.bin"), &bytes).unwrap();
    fs::write(folder.path().join("floor.bin"), &bytes).unwrap();
    fs::write(folder.path().join("outside.bin"), &bytes).unwrap();
    fs::write(
        own.join("world.toml"),
        "[[world.terrain]]\nname = \"floor\"\ntype = \"mesh\"\nfile = \"floor.gltf\"\n\
         rpy = [1.5708, 0, 0]\n",
    )
    .unwrap();
    let rover = own.join("rover.urdf");
    let settings = own.join("world.toml");
    let fmu = folder.path().join("rover.fmu");
    let outside = folder.path().join("outside.bin");
    for (uri, taken) in [
        ("floor.bin", true),
        ("../outside.bin", false),
        (text(&outside), false),
    ] {
        let mesh = format!(
            r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
            "nodes": [{{"mesh": 0}}], "buffers": [{{"uri": "{uri}", "byteLength": 36}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}]}}"#
        );
        fs::write(own.join("floor.gltf"), mesh).unwrap();
        let args = [
            "export",
            text(&rover),
            "-c",
            text(&settings),
            "-o",
            text(&fmu),
            "--no-documentation",
        ];
        let run = run_in(folder.path(), &args, &[]);
        if taken {
            assert_eq!(run.code, 0, "{run:?}");
            let (names, contents) = entries(&fmu);
            let packed = names.iter().find(|name| name.ends_with("/floor.bin"));
            assert_eq!(contents[packed.expect("packed")], bytes, "{names:?}");
        } else {
            assert_eq!(run.code, 1, "{run:?}");
            let told = "is not beside it";
            assert!(
                run.err.contains("T002") && run.err.contains(told),
                "{}",
                run.err
            );
        }
    }
}
