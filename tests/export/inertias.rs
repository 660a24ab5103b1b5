//! Inertias that no body can have, and links that lack theirs beside other faults.

use super::packages::{INERTIAL, field, info};
use super::people::{findings, write};

/// The ABB IRB 4600 of compas: other programs load it, as they do not look.
#[test]
fn an_impossible_inertia_comes_with_the_option_that_computes_it() {
    let folder = tempfile::tempdir().unwrap();
    let xml = |shape: &str| {
        format!(
            "<robot name='r'><link name='l'>{}{shape}</link></robot>",
            INERTIAL.replace("ixx='1'", "ixx='-4.98'")
        )
    };
    let shape = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
    let robot = write(folder.path(), "r.urdf", xml(shape));
    let (ok, list) = findings(&robot, &[]);
    assert!(!ok && field(&list, "U061", "help").contains("--inertia collision"));
    assert!(findings(&robot, &["--inertia", "collision"]).0);
    // Without a shape there is nothing to compute it from, but a nearest one that is possible.
    let bare = write(folder.path(), "bare.urdf", xml(""));
    let (ok, list) = findings(&bare, &[]);
    let help = field(&list, "U061", "help");
    assert!(!ok && !help.contains("--inertia collision"), "{help}");
    let nearest = ["--inertia", "nearest", "--missing-mass", "0.1"];
    assert!(
        help.ends_with(&format!(": {}", nearest.join(" "))),
        "{help}"
    );
    let (ok, list) = findings(&bare, &nearest);
    assert!(ok && field(&list, "U061", "message").ends_with("; the nearest is used"));
    let inertia = info(&bare, &nearest)["links"][0]["inertia"].clone();
    let inertia: [[f64; 3]; 3] = serde_json::from_value(inertia).unwrap();
    // Second moments tr/2 − I of −4.98, 1, 1 kg m² are 3.49, −2.49, −2.49; without the negative
    // ones they are those of a rod, which has no inertia about itself. It gets that of a ball of
    // 1 kg and 5 cm, 2/5 m r².
    let ball = 0.4 * 0.05 * 0.05;
    for (i, expected) in [ball, 3.49 + ball, 3.49 + ball].into_iter().enumerate() {
        assert!((inertia[i][i] - expected).abs() < 1e-12, "{inertia:?}");
    }
    // What has two second moments needs no more: −1, 3, 1 kg m² have 2.5, −1.5, 0.5.
    let wide = xml("")
        .replace("ixx='-4.98'", "ixx='-1'")
        .replace("iyy='1'", "iyy='3'");
    let wide = write(folder.path(), "wide.urdf", wide);
    let (_, list) = findings(&wide, &[]);
    assert!(field(&list, "U061", "help").ends_with(": --inertia nearest"));
    let inertia = info(&wide, &["--inertia", "nearest"])["links"][0]["inertia"].clone();
    let inertia: [[f64; 3]; 3] = serde_json::from_value(inertia).unwrap();
    for (i, expected) in [0.5, 3.0, 2.5].into_iter().enumerate() {
        assert!((inertia[i][i] - expected).abs() < 1e-12, "{inertia:?}");
    }
}

/// The Panda of cuRobo and Romeo: what comes after the inertias is told with them.
#[test]
fn fingers_without_mass_are_told_with_what_else_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
    let bad = INERTIAL.replace("ixx='1'", "ixx='-1'");
    let xml = |finger: &str| {
        let joint = |child: &str| {
            format!(
                "<joint name='{child}' type='continuous'><parent link='a'/><child link='{child}'/>\
                 </joint><link name='{child}'>{finger}</link>"
            )
        };
        format!(
            "<robot name='r'><link name='a'>{bad}{ball}</link>{}{}</robot>",
            joint("b"),
            joint("c")
        )
    };
    let robot = write(folder.path(), "shapes.urdf", xml(ball));
    let (ok, list) = findings(&robot, &[]);
    assert!(!ok && field(&list, "U066", "message").contains("another joint likewise"));
    assert!(field(&list, "U066", "help").starts_with("pass --density 1000 for"));
    let options = ["--inertia", "collision", "--density", "1000"];
    assert!(findings(&robot, &options).0);
    let robot = write(folder.path(), "bare.urdf", xml(""));
    let (ok, list) = findings(&robot, &[]);
    assert!(!ok && field(&list, "U066", "help").starts_with("pass --missing-mass 0.1 for"));
    assert!(findings(&robot, &["--compat", "pybullet"]).0);
    let options = ["--inertia", "collision", "--missing-mass", "0.1"];
    assert!(findings(&robot, &options).0);
    // What the options do not give mass to is told even so, and nothing else.
    let one = xml("").replacen(
        "<link name='b'></link>",
        &format!("<link name='b'>{ball}</link>"),
        1,
    );
    let robot = write(folder.path(), "one.urdf", one);
    for (options, message) in [
        (&[][..], Some("another joint likewise")),
        (
            &["--density", "1000"],
            Some("joint 'c' moves nothing that has mass: "),
        ),
        (&["--missing-mass", "0.1"], None),
    ] {
        let (ok, list) = findings(&robot, options);
        let told = list.iter().find(|finding| finding["code"] == "U066");
        let told = told.map(|told| told["message"].as_str().unwrap());
        assert!(!ok && told.is_some() == message.is_some(), "{told:?}");
        assert!(
            told.unwrap_or_default()
                .contains(message.unwrap_or_default()),
            "{told:?}"
        );
    }
    // Told in that place only: alone it is an error with ways that were tried.
    let sound = xml(ball).replace("ixx='-1'", "ixx='1'");
    let (ok, list) = findings(&write(folder.path(), "sound.urdf", sound), &[]);
    assert!(!ok && list.iter().all(|finding| finding["code"] != "U066"));
}
