//! Files that packages of registries carry (`ManiSkill`, Genesis, Isaac Gym, `JAXsim`, compas
//! and others), each made small: what their own simulators take, and what is said of the rest.

use super::people::{findings, mesh_robot, of_severity, tetrahedron, write};
use super::*;

pub const INERTIAL: &str = "<inertial><mass value='1'/>\
                        <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";

pub fn info(path: &Path, args: &[&str]) -> Value {
    let mut all = vec!["info", text(path), "--json"];
    all.extend(args);
    let done = run_in(Path::new("."), &all, &[]);
    serde_json::from_str(&done.out).unwrap_or_else(|_| panic!("{done:?}"))
}

/// The text of a finding's field, of the first error or warning with a code.
pub fn field(list: &[Value], code: &str, name: &str) -> String {
    let found = list.iter().find(|finding| finding["code"] == code);
    found.unwrap_or_else(|| panic!("{code}: {list:?}"))[name]
        .as_str()
        .unwrap_or_default()
        .to_owned()
}

/// Isaac Gym's cubes.
#[test]
fn an_inertial_with_a_density_weighs_its_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let cube = |inertial: &str| {
        format!(
            "<robot name='r'><link name='l'><collision><origin xyz='0 0 0.5'/><geometry>\
             <box size='0.1 0.1 0.1'/></geometry></collision><inertial>{inertial}</inertial>\
             </link></robot>"
        )
    };
    let robot = write(folder.path(), "r.urdf", cube("<density value='300'/>"));
    let (ok, list) = findings(&robot, &[]);
    assert!(ok && of_severity(&list, "warning").is_empty(), "{list:?}");
    assert!(field(&list, "U023", "message").contains("<density> is read"));
    let link = &info(&robot, &[])["links"][0];
    // 300 kg/m³ × 1e-3 m³; m a² / 6.
    let near = |value: &Value, expected: f64| {
        let value = value.as_f64().unwrap();
        assert!((value - expected).abs() < 1e-12, "{value} {expected}");
    };
    near(&link["mass"], 0.3);
    near(&link["com"][2], 0.5);
    near(&link["inertia"][0][0], 0.3 * 0.01 / 6.0);
    // A mass holds beside it.
    let both = cube("<mass value='2'/><density value='300'/>");
    let robot = write(folder.path(), "both.urdf", both);
    let (ok, list) = findings(&robot, &[]);
    assert!(ok && field(&list, "U020", "message").contains("<density>"));
    near(&info(&robot, &[])["links"][0]["mass"], 2.0);
    let wrong = write(folder.path(), "w.urdf", cube("<density value='-1'/>"));
    let (ok, list) = findings(&wrong, &[]);
    assert!(!ok && field(&list, "U032", "message").contains("density"));
}

/// The tower of Genesis: `<inertial>` holds zeros and no mass.
#[test]
fn an_inertial_without_mass_counts_as_none_and_the_way_offered_works() {
    let folder = tempfile::tempdir().unwrap();
    let robot = write(
        folder.path(),
        "ring.urdf",
        "<robot name='r'><link name='world'/><joint name='j' type='floating'>\
         <parent link='world'/><child link='l'/></joint><link name='l'><inertial>\
         <inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial><collision>\
         <geometry><sphere radius='0.1'/></geometry></collision></link></robot>",
    );
    let (ok, list) = findings(&robot, &[]);
    assert!(!ok && field(&list, "U017", "message").contains("counts as none"));
    let errors = of_severity(&list, "error");
    assert_eq!(errors.len(), 1, "{errors:?}");
    let options = ["--density", "1000"];
    assert!(
        errors[0]["help"].to_string().contains(&options.join(" ")),
        "{errors:?}"
    );
    assert!(findings(&robot, &options).0);
}

/// The fingers of the `TriFinger`, the gripper WSG 50: every reader of URDF takes the first.
#[test]
fn of_two_elements_the_first_is_used() {
    let folder = tempfile::tempdir().unwrap();
    let robot = write(
        folder.path(),
        "r.urdf",
        format!(
            "<robot name='r'><link name='a'>{INERTIAL}</link><link name='b'>{INERTIAL}{}</link>\
             <joint name='j' type='revolute'><parent link='a'/><child link='b'/>\
             <limit lower='-1' upper='1' effort='5' velocity='1'/><limit effort='9' velocity='1'/>\
             </joint></robot>",
            INERTIAL.replacen("'1'", "'7'", 1)
        ),
    );
    let (ok, list) = findings(&robot, &[]);
    assert!(ok, "{list:?}");
    let told = of_severity(&list, "warning");
    let told: Vec<_> = told.iter().filter(|f| f["code"] == "U018").collect();
    assert_eq!(told.len(), 2, "{told:?}");
    let info = info(&robot, &[]);
    assert_eq!(info["links"][1]["mass"], 1.0);
    assert_eq!(info["joints"][0]["max_effort"], 5.0);
}

/// The cart-pole of `JAXsim` has the largest single float, others infinity.
#[test]
fn limits_beyond_every_number_count_as_unlimited() {
    let folder = tempfile::tempdir().unwrap();
    for number in ["3.4028235e+38", "1.7976931348623157e308", "inf", "Infinity"] {
        let robot = write(
            folder.path(),
            "r.urdf",
            format!(
                "<robot name='r'><link name='a'>{INERTIAL}</link><link name='b'>{INERTIAL}</link>\
                 <joint name='j' type='revolute'><parent link='a'/><child link='b'/><limit \
                 lower='-{number}' upper='{number}' effort='{number}' velocity='{number}'/></joint>\
                 </robot>"
            ),
        );
        let (ok, list) = findings(&robot, &[]);
        assert!(ok, "{number}: {list:?}");
        let told = list.iter().filter(|f| f["code"] == "U032").count();
        assert_eq!(told, 4, "{number}: {list:?}");
        let done = urdf2fmu(["simulate", text(&robot), "--stop-time", "0.05", "--quiet"]);
        assert_eq!(done.code, 0, "{number}: {done:?}");
    }
}

/// Isaac Gym's `factory_franka`: meshes of another robot's folder, and no masses.
#[test]
fn meshes_outside_are_one_finding_and_what_comes_next_is_told_with_it() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["collision/a.stl", "collision/b.stl", "visual/a.stl"] {
        write(
            folder.path(),
            &format!("assets/franka/meshes/{name}"),
            tetrahedron(),
        );
    }
    let names = ["a", "b"].map(|name| format!("../../franka/meshes/collision/{name}.stl"));
    let xml = mesh_robot(&[&names[0], &names[1]])
        .replacen(
            "<collision>",
            "<visual><geometry><mesh filename='../../franka/meshes/visual/a.stl'/></geometry>\
             </visual><collision>",
            1,
        )
        .replace(INERTIAL, "");
    assert!(!xml.contains("<mass"), "{xml}");
    let robot = write(folder.path(), "assets/factory/robot/r.urdf", xml);
    let (ok, list) = findings(&robot, &[]);
    let errors = of_severity(&list, "error");
    assert!(!ok && errors.len() == 1, "{errors:?}");
    assert!(field(&list, "U112", "message").contains("a.stl, and 1 more"));
    let meshes = folder.path().join("assets/franka/meshes");
    for code in ["U112", "U111"] {
        let help = field(&list, code, "help");
        let option = help.split("--package-path ").nth(1).unwrap();
        assert!(Path::new(option).ends_with("franka/meshes"), "{help}");
    }
    assert!(field(&list, "U066", "help").contains("--density 1000"));
    let all = ["--package-path", text(&meshes), "--density", "1000"];
    let (ok, list) = findings(&robot, &all);
    assert!(ok, "{list:?}");
}

/// The Movo: both halves of the matrix.
#[test]
fn the_other_half_of_an_inertia_is_known_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    let link = |izy: &str| {
        let whole = INERTIAL.replace("ixz='0'", &format!("ixz='0' iyx='0.0' izx='0' izy='{izy}'"));
        format!("<robot name='r'><link name='l'>{whole}</link></robot>")
    };
    let (ok, list) = findings(&write(folder.path(), "r.urdf", link("0")), &[]);
    assert!(ok && of_severity(&list, "warning").is_empty(), "{list:?}");
    let (ok, list) = findings(&write(folder.path(), "w.urdf", link("0.1")), &[]);
    assert!(ok && field(&list, "U019", "message").contains("izy is not iyz"));
}

/// The table of the `TriFinger`: in another folder than the name says, and the only one so named.
#[test]
fn a_missing_mesh_names_the_one_file_of_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(
        root,
        "tri/package.xml",
        "<package><name>tri</name></package>",
    );
    write(root, "tri/meshes/table.stl", tetrahedron());
    let robot = write(
        root,
        "tri/urdf/r.urdf",
        mesh_robot(&["package://tri/meshes/stl/table.stl"]),
    );
    let (ok, list) = findings(&robot, &[]);
    assert!(!ok);
    let help = field(&list, "U104", "help");
    assert!(
        help.contains("one file of that name") && help.contains("meshes/table.stl"),
        "{help}"
    );
    // Two are not told apart.
    write(root, "tri/old/table.stl", tetrahedron());
    let (_, list) = findings(&robot, &[]);
    assert!(!field(&list, "U104", "help").contains("one file of that name"));
}

/// A robot from Windows whose meshes were moved to a folder below: nothing but their last names
/// fits.
#[test]
fn missing_meshes_that_lie_in_one_other_folder_are_told_together() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["a.stl", "b.stl"] {
        write(root, &format!("meshes/collision/bac/{name}"), tetrahedron());
    }
    let meshes = ["meshes\\collision\\a.stl", "meshes\\collision\\b.stl"];
    let robot = write(root, "r.urdf", mesh_robot(&meshes));
    let (ok, list) = findings(&robot, &[]);
    let help = field(&list, "U104", "help");
    assert!(
        !ok && help.contains("all 2 are in ")
            && help.contains("meshes/collision/bac: write this folder in their lines"),
        "{help}"
    );
    // In two folders there is no one to write.
    write(root, "meshes/old/c.stl", tetrahedron());
    let others = mesh_robot(&[meshes[0], "meshes\\collision\\c.stl"]);
    let (_, list) = findings(&write(root, "o.urdf", others), &[]);
    assert!(!field(&list, "U104", "help").contains("all 2 are in "));
}

/// `ManiSkill`, Genesis and `real_robot` collide with `.glb` and `.ply` files.
#[test]
fn meshes_in_ply_and_binary_gltf_collide_and_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let corners = ["0 0 0", "0.1 0 0", "0 0.1 0", "0 0 0.1"];
    let faces = [[0_u16, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                   property float z\nelement face 4\nproperty list uchar int vertex_indices\n\
                   end_header\n"
        .to_owned();
    for corner in corners {
        ply += corner;
        ply.push('\n');
    }
    for [a, b, c] in faces {
        let line = format!("3 {a} {b} {c}\n");
        ply += &line;
    }
    write(folder.path(), "a.ply", ply);
    let mut json = br#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 24}], "buffers": [{"byteLength": 72}]}"#
        .to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = Vec::new();
    for corner in corners {
        let numbers = corner.split(' ').map(|x| x.parse::<f32>().unwrap());
        binary.extend(numbers.flat_map(f32::to_le_bytes));
    }
    binary.extend(faces.iter().flatten().flat_map(|x| x.to_le_bytes()));
    let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        glb.extend(u32::try_from(chunk.len()).unwrap().to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    write(folder.path(), "b.GLB", glb);
    let shape = |name: &str| format!("<geometry><mesh filename='{name}'/></geometry>");
    let link = |name: &str| {
        let shape = shape(name);
        format!("<visual>{shape}</visual><collision>{shape}</collision>")
    };
    let robot = write(
        folder.path(),
        "r.urdf",
        format!(
            "<robot name='r'><link name='a'>{}</link><link name='b'>{}</link>\
             <joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint></robot>",
            link("a.ply"),
            link("b.GLB")
        ),
    );
    let options = ["--inertia", "collision", "--density", "6000"];
    let (ok, list) = findings(&robot, &options);
    assert!(ok && of_severity(&list, "warning").is_empty(), "{list:?}");
    for link in info(&robot, &options)["links"].as_array().unwrap() {
        // A sixth of a cube of 1e-3 m³, of corners in single precision.
        let mass = link["mass"].as_f64().unwrap();
        assert!((mass - 1.0).abs() < 1e-6, "{mass}");
    }
}

/// Two faults each, of which one comes to light only after the other where checks end at the first:
/// whoever mends both is told of no third.
#[test]
fn faults_of_files_of_settings_and_of_names_are_told_in_one_run() {
    let joint = |name: &str, parent: &str, child: &str, more: &str| {
        format!(
            "<joint name='{name}' type='continuous'><parent link='{parent}'/>\
             <child link='{child}'/>{more}</joint>"
        )
    };
    let link = |name: &str, more: &str| format!("<link name='{name}'>{INERTIAL}{more}</link>");
    let shape = |geometry: &str| format!("<collision><geometry>{geometry}</geometry></collision>");
    let mesh = shape("<mesh filename='nowhere.stl'/>");
    let robot = |first: &str, joints: &str| {
        let links = link("a", first) + &link("b", "") + &link("c", "");
        format!("<robot name='r'>{links}{joints}</robot>")
    };
    let sound = joint("j", "a", "b", "") + &joint("k", "b", "c", "");
    let alike = joint("j 1", "a", "b", "") + &joint("j-1", "b", "c", "");
    let mimic = joint("j", "a", "b", "") + &joint("k", "b", "c", "<mimic joint='x'/>");
    let negative = shape("<sphere radius='-1'/>");
    let unknown = "[solver]\ntolerence = 1e-4\n";
    let nobody = "[[actuator]]\njoint = 'nobody'\nmode = 'velocity'\n";
    let both = format!("{unknown}{nobody}");
    for (urdf, settings, codes) in [
        (robot(&mesh, &alike), "", ["U104", "A139"]),
        (robot(&mesh, &sound), nobody, ["U104", "A101"]),
        (robot(&negative, &alike), "", ["U033", "A139"]),
        (robot(&negative, &sound), unknown, ["S102", "U033"]),
        (robot(&mesh, &mimic), "[solver", ["S101", "U046"]),
        (robot("", &sound), &both, ["S102", "A101"]),
        (robot("", &alike), unknown, ["S102", "A139"]),
        (robot("", &alike), nobody, ["A101", "A139"]),
        (
            robot("", &alike).replace(INERTIAL, ""),
            "",
            ["A104", "A139"],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), "r.urdf", urdf.clone());
        let config = write(folder.path(), "r.toml", settings);
        let (ok, list) = findings(&path, &["--config", text(&config)]);
        assert!(!ok);
        let errors = of_severity(&list, "error");
        for code in codes {
            let told = errors.iter().filter(|finding| finding["code"] == code);
            assert_eq!(told.count(), 1, "{code}: {list:?} {urdf} {settings}");
        }
    }
    // What follows from a fault is not told as another one.
    let folder = tempfile::tempdir().unwrap();
    let path = write(
        folder.path(),
        "r.urdf",
        robot("", &sound).replace(INERTIAL, ""),
    );
    let config = write(
        folder.path(),
        "r.toml",
        "[robot]\ninertia = 'colision'\n[robot",
    );
    let (_, list) = findings(&path, &["--config", text(&config)]);
    let codes: Vec<&Value> = of_severity(&list, "error")
        .iter()
        .map(|f| &f["code"])
        .collect();
    let own = |code: &&Value| **code == "S101" || **code == "S104";
    assert!(codes.iter().all(own), "{list:?}");
}

/// Files that are something else, as people have them.
#[test]
fn files_that_are_no_text_or_a_web_page_are_told_what_they_are() {
    let four_bytes: Vec<u8> = "\u{feff}<robot/>"
        .chars()
        .flat_map(|c| u32::from(c).to_le_bytes())
        .collect();
    for (content, what) in [
        (four_bytes, "byte 0xff"),
        (b"\x1f\x8b\x08\0".to_vec(), "compressed"),
        (
            b"\n<!DOCTYPE html>\n<html>404</html>".to_vec(),
            "a web page",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (ok, list) = findings(&write(folder.path(), "r.urdf", content), &[]);
        assert!(
            !ok && field(&list, "U002", "message").contains(what),
            "{list:?}"
        );
    }
}

/// The Jaco of differentiable-robot-model: who puts the meshes where their names say would have
/// been told in a second run that they lie outside of the robot's folders.
#[test]
fn a_mesh_that_is_missing_outside_of_the_robot_s_folders_comes_with_the_option_that_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let robot = write(root, "ws/bot/r.urdf", mesh_robot(&["../meshes/a.stl"]));
    let (ok, list) = findings(&robot, &[]);
    assert!(!ok);
    let help = field(&list, "U104", "help");
    let option = "with the file, pass --package-path ";
    let folder = help.lines().find_map(|line| line.split(option).nth(1));
    let folder = folder.unwrap_or_else(|| panic!("{help}"));
    write(root, "ws/meshes/a.stl", tetrahedron());
    let (ok, list) = findings(&robot, &["--package-path", folder]);
    assert!(ok, "{list:?}");
    // A file that is missing in the robot's own folder needs no option.
    let robot = write(root, "ws/bot/own.urdf", mesh_robot(&["b.stl"]));
    let (_, list) = findings(&robot, &[]);
    assert!(!field(&list, "U104", "help").contains("--package-path"));
}
