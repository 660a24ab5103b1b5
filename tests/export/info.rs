//! `info`: the numbers of a robot or an FMU.

use super::*;

#[test]
fn info_says_the_same_of_a_robot_and_of_its_fmu() {
    let arm = example("arm.urdf");
    let (_folder, fmu) = export(&arm, &[]);
    // But for the guid, which a robot has not.
    let guid = info(&fmu, &[])["guid"].as_str().unwrap().to_owned();
    for options in [&[][..], &["--variables"], &["--json", "--variables"]] {
        let of = |file: &Path| {
            let mut args = vec!["info", text(file)];
            args.extend(options);
            let run = run_in(Path::new("."), &args, &[]);
            assert_eq!(run.code, 0, "{run:?}");
            run.out
        };
        let told = of(&fmu);
        assert!(told.contains(&guid), "{told}");
        let told = told.replace(&format!(", guid {guid}"), "");
        let told = told.replace(&format!("\"guid\": \"{guid}\""), "\"guid\": null");
        assert_eq!(of(&arm), told, "{options:?}");
    }
}

/// The examples' inertia was computed by formula from the solids that are also their collision
/// shapes.
#[test]
fn inertia_in_the_examples_is_that_of_their_solids() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("s.toml");
    fs::write(&settings, "[robot]\ninertia = \"collision\"\n").unwrap();
    for name in EXAMPLES {
        let urdf = example(&format!("{name}.urdf"));
        let (file, solids) = (info(&urdf, &[]), info(&urdf, &["-c", text(&settings)]));
        let links = |value: &Value| value["links"].as_array().unwrap().clone();
        for (a, b) in links(&file).iter().zip(&links(&solids)) {
            for (row_a, row_b) in a["inertia"]
                .as_array()
                .unwrap()
                .iter()
                .zip(b["inertia"].as_array().unwrap())
            {
                for (x, y) in row_a
                    .as_array()
                    .unwrap()
                    .iter()
                    .zip(row_b.as_array().unwrap())
                {
                    let (x, y) = (x.as_f64().unwrap(), y.as_f64().unwrap());
                    // Nine digits in the files.
                    assert!(
                        (x - y).abs() <= 1e-8 * x.abs() + 1e-12,
                        "{name} {}: {x} {y}",
                        a["name"]
                    );
                }
            }
        }
    }
}

#[test]
fn info_lists_joints_with_the_file_s_numbers() {
    let arm = info(&example("arm.urdf"), &[]);
    assert_eq!(arm["base"], "fixed");
    // Six axes and one independent finger.
    assert_eq!(arm["degrees_of_freedom"], 7);
    assert!((arm["mass"].as_f64().unwrap() - 24.5).abs() < 1e-12);
    let joints = arm["joints"].as_array().unwrap();
    let joint = |name: &str| joints.iter().find(|j| j["name"] == name).unwrap();
    let elbow = joint("elbow");
    assert_eq!(elbow["max_effort"], 100.0);
    assert_eq!(elbow["lower"], -2.7);
    assert_eq!(elbow["damping"], 0.8);
    assert_eq!(elbow["axis"], serde_json::json!([0.0, 1.0, 0.0]));
    assert_eq!(
        elbow["origin_position"],
        serde_json::json!([0.0, 0.0, 0.42])
    );
    assert_eq!(
        joint("right_finger_joint")["mimic"]["joint"],
        "left_finger_joint"
    );
}

/// The 17 columns of `getJointInfo`, by hand from the file where numbers are compared.
#[test]
fn info_has_the_columns_of_get_joint_info_and_the_poses_of_get_link_state() {
    let arm = info(&example("arm.urdf"), &[]);
    let elbow = arm["joints"]
        .as_array()
        .unwrap()
        .iter()
        .find(|j| j["name"] == "elbow")
        .unwrap();
    for column in [
        "index",
        "name",
        "type",
        "q_index",
        "v_index",
        "flags",
        "damping",
        "friction",
        "lower",
        "upper",
        "max_effort",
        "max_velocity",
        "link",
        "axis",
        "origin_position",
        "origin_orientation_xyzw",
        "parent_index",
    ] {
        assert!(elbow.get(column).is_some(), "{column}");
    }
    assert_eq!(elbow["flags"], 1);
    let parent = elbow["parent_index"].as_u64().unwrap();
    assert_eq!(
        arm["links"][usize::try_from(parent).unwrap()]["name"],
        elbow["parent"]
    );
    // The root of a fixed base that the settings do not move lies in the world's origin.
    assert_eq!(
        arm["links"][0]["position"],
        serde_json::json!([0.0, 0.0, 0.0])
    );
    assert_eq!(
        arm["links"][0]["orientation_xyzw"],
        serde_json::json!([0.0, 0.0, 0.0, 1.0])
    );
    let run = urdf2fmu(["info", text(&example("arm.urdf"))]);
    let heading = run
        .out
        .lines()
        .find(|line| line.contains("joint  "))
        .unwrap();
    for word in [
        "type", "q", "v", "flags", "damping", "friction", "lower", "upper", "effort", "velocity",
        "link", "axis", "origin", "parent", "command",
    ] {
        assert!(
            heading.split_whitespace().any(|w| w == word),
            "{word}: {heading}"
        );
    }
}
