//! Lengths in another unit, and what is right.

use crate::diagnostic::Diagnostic;
use crate::urdf::{ReadOptions, read_str};
use std::path::Path;

fn findings(scale: f64, size: &str, mass: f64, mesh: Option<&str>) -> Vec<Diagnostic> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots");
    let shape = mesh.map_or(format!("<box size='{size}'/>"), |scale| {
        format!("<mesh filename='meshes/far_off.obj' scale='{scale}'/>")
    });
    // A cube of 0.1 m and 1 kg: m a²/6.
    let text = format!(
        "<robot name='r'><link name='a'><inertial><mass value='{mass}'/><inertia ixx='0.00167' \
         iyy='0.00167' izz='0.00167' ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry>\
         {shape}</geometry></collision></link></robot>"
    );
    let options = ReadOptions {
        scale,
        ..ReadOptions::default()
    };
    let robot = read_str(&text, "r.urdf", &folder, &options).expect("legal");
    let told = robot.diagnostics.into_iter();
    told.filter(|d| d.code == "U067" || d.code == "U065")
        .collect()
}

#[test]
fn a_robot_in_millimetres_is_told_by_how_light_it_is() {
    assert!(findings(1.0, "0.1 0.1 0.1", 1.0, None).is_empty());
    let told = findings(1.0, "100 100 100", 1.0, None);
    let [told] = &told[..] else {
        panic!("one finding: {told:?}")
    };
    assert!(told.message.contains("it is 173.2 m large"), "{told:?}");
    let help = told.help.as_deref().unwrap_or_default();
    assert!(help.contains("pass --scale 0.001"), "{help}");
    // That option mends it.
    assert!(
        findings(0.001, "100 100 100", 1.0, None)
            .iter()
            .all(|d| d.code != "U067")
    );
    // A balloon of 1 m that is as heavy as its air and skin is none.
    assert!(
        findings(1.0, "1 1 1", 1.3, None)
            .iter()
            .all(|d| d.code != "U067")
    );
}

/// A box of 0.3 m with a link of 0.4 m on it, whose larger one is 2 √(0.03² + 0.2²) m: told
/// from ten times as many, 4.04 m, on.
#[test]
fn origins_in_millimetres_are_told_by_the_size_of_all_shapes() {
    let told = |mass: f64, shape: f64, joint: f64, scale: f64| {
        let text = format!(
            "<robot name='r'><link name='a'><collision><geometry><box size='0.3 0.2 0.1'/>\
             </geometry></collision></link><link name='b'><inertial><origin xyz='0 0 {mass}'/>\
             <mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.001' ixy='0' ixz='0' iyz='0'/>\
             </inertial><collision><origin xyz='0 0 {shape}'/><geometry><cylinder radius='0.03' \
             length='0.4'/></geometry></collision></link><joint name='j' type='continuous'>\
             <origin xyz='0 0 {joint}'/><parent link='a'/><child link='b'/></joint></robot>"
        );
        let options = ReadOptions {
            scale,
            ..ReadOptions::default()
        };
        let robot = read_str(&text, "r.urdf", Path::new("."), &options).expect("legal");
        let mut told = robot.diagnostics.into_iter().filter(|d| d.code == "U069");
        told.next().map(|d| (d.message, d.help.unwrap_or_default()))
    };
    assert_eq!(told(0.2, 0.2, 0.05, 1.0), None);
    assert_eq!(told(4.0, 0.2, 4.0, 1.0), None);
    for (places, what, more) in [
        (
            [200.0, 0.2, 0.05],
            "link 'b': the <origin> of <inertial> is 200 m",
            0,
        ),
        (
            [4.1, 0.2, 0.05],
            "link 'b': the <origin> of <inertial> is 4 m",
            0,
        ),
        (
            [0.2, 0.2, 50.0],
            "joint 'j': the <origin> of <joint> is 50 m",
            0,
        ),
        (
            [200.0, 200.0, 50.0],
            "link 'b': the <origin> of <inertial> is 200 m",
            2,
        ),
    ] {
        let [mass, shape, joint] = places;
        let (message, help) = told(mass, shape, joint, 1.0).expect(what);
        assert!(message.starts_with(what), "{message}");
        let size = if more > 0 { "0.8 m" } else { "0.4 m" };
        assert!(message.contains(&format!("some {size} large")), "{message}");
        assert_eq!(
            help.contains(&format!("{more} other origins")),
            more > 0,
            "{help}"
        );
        // All lengths are scaled alike.
        assert!(told(mass, shape, joint, 0.001).is_some());
    }
}

/// One of many links is 135 m away: more than ten times the largest link, but not than thirty
/// of them in a row. Four feet of 4 cm alone say nothing of legs of 0.5 m.
#[test]
fn one_origin_in_millimetres_among_many_links_is_told() {
    let chain = |shape: &str, shaped: usize, first: f64| {
        let links = (0..30).map(|i| {
            let shape = format!("<collision><geometry>{shape}</geometry></collision>");
            let shape = if i < shaped { shape } else { String::new() };
            format!("<link name='l{i}'>{shape}</link>")
        });
        let joints = (1..30).map(|i| {
            let away = if i == 1 { first } else { 0.5 };
            format!(
                "<joint name='j{i}' type='fixed'><origin xyz='0 0 {away}'/>\
                 <parent link='l{}'/><child link='l{i}'/></joint>",
                i - 1
            )
        });
        let parts: String = links.chain(joints).collect();
        let text = format!("<robot name='r'>{parts}</robot>");
        let options = ReadOptions::default();
        let robot = read_str(&text, "r.urdf", Path::new("."), &options).expect("legal");
        robot.diagnostics.iter().any(|d| d.code == "U069")
    };
    let link = "<box size='0.5 0.3 0.3'/>";
    assert!(chain(link, 30, 135.0));
    assert!(!chain(link, 30, 0.5));
    assert!(!chain("<sphere radius='0.02'/>", 4, 0.5));
}

/// A top whose tip of 1 mm is all of it that touches, and tips that are off in mm and in cm.
#[test]
fn a_tiny_tip_below_its_origin_is_not_told_and_sizes_below_a_metre_have_digits() {
    let told = |away: f64| {
        let text = format!(
            "<robot name='top'><link name='top'><inertial><mass value='0.1'/><inertia ixx='1e-4' \
             iyy='1e-4' izz='1e-4' ixy='0' ixz='0' iyz='0'/></inertial><collision><origin \
             xyz='0 0 -{away}'/><geometry><sphere radius='0.001'/></geometry></collision></link>\
             </robot>"
        );
        let robot = read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default());
        let robot = robot.expect("legal");
        let mut told = robot.diagnostics.into_iter().filter(|d| d.code == "U069");
        told.next().map(|d| d.message)
    };
    assert_eq!(told(0.04), None);
    for (away, sizes) in [
        (0.4, "is 0.4 m away, in a robot some 0.002 m large"),
        (4.0, "is 4 m away, in a robot some 0.002 m large"),
        (40.0, "is 40 m away, in a robot some 0.002 m large"),
    ] {
        let message = told(away).expect("off by a unit");
        assert!(message.contains(sizes), "{message}");
    }
}

/// A cube of 0.1 m, drawn 1000 times as large, 2·√3·50 m, and the mesh of it, at a rail of 30 m
/// along which it slides.
#[test]
fn visuals_in_millimetres_are_told_by_the_size_of_the_rest() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots");
    let told = |visual: &str, slides: f64| {
        let text = format!(
            "<robot name='r'><link name='a'><collision><geometry><box size='0.1 0.1 0.1'/>\
             </geometry></collision></link><link name='b'><visual><geometry>{visual}\
             </geometry></visual></link><joint name='j' type='prismatic'><parent link='a'/>\
             <child link='b'/><limit lower='0' upper='{slides}' effort='1' velocity='1'/>\
             </joint></robot>"
        );
        let options = ReadOptions {
            drawn: true,
            ..ReadOptions::default()
        };
        let robot = read_str(&text, "r.urdf", &folder, &options).expect("legal");
        let mut told = robot.diagnostics.into_iter().filter(|d| d.code == "U075");
        told.next().map(|d| d.message + &d.help.unwrap_or_default())
    };
    assert_eq!(told("<box size='0.1 0.1 0.1'/>", 0.1), None);
    let text = told("<box size='100 100 100'/>", 0.1).expect("in mm");
    let start = "link 'b': its <visual> is 173.2 m large, in a robot some 0.2 m large";
    assert!(text.starts_with(start), "{text}");
    assert_eq!(told("<box size='30 0.1 0.1'/>", 30.0), None);
    let mesh = |scale: &str| {
        let mesh = format!("<mesh filename='meshes/far_off.obj' scale='{scale}'/>");
        told(&mesh, 0.1)
    };
    assert_eq!(mesh("1 1 1"), None);
    let text = mesh("1000 1000 1000").expect("in mm");
    assert!(text.contains("scale=\"0.001 0.001 0.001\""), "{text}");
}

/// Rolling and spinning friction are lever arms, m.
#[test]
fn arms_of_friction_follow_the_scale() {
    let text = "<robot name='r'><link name='a'><contact><rolling_friction value='0.01'/>\
                <spinning_friction value='0.02'/></contact></link></robot>";
    let options = ReadOptions {
        scale: 4.0,
        ..ReadOptions::default()
    };
    let robot = read_str(text, "r.urdf", std::path::Path::new("."), &options).expect("legal");
    let arms = [
        &robot.links[0].rolling_friction,
        &robot.links[0].torsional_friction,
    ];
    assert_eq!(arms, [&Some(0.04), &Some(0.08)]);
}

/// A room of 300 m³ with a mass of 1 kg, and a link with a placeholder of 1e-5 kg.
#[test]
fn masses_that_nobody_has_measured_are_no_millimetres() {
    for (size, mass) in [("10 10 3", 1.0), ("0.1 0.1 0.1", 1e-5)] {
        let told = findings(1.0, size, mass, None);
        assert!(told.iter().all(|d| d.code != "U067"), "{told:?}");
    }
}

#[test]
fn a_mesh_in_millimetres_is_told_with_its_scale_and_not_with_an_inertia_of_its_size() {
    let told = findings(1.0, "", 1.0, Some("1000 1000 1000"));
    let [told] = &told[..] else {
        panic!("one finding: {told:?}")
    };
    assert_eq!(told.code, "U067");
    let help = told.help.as_deref().unwrap_or_default();
    assert!(help.contains("scale=\"0.001 0.001 0.001\""), "{help}");
}

/// A cube of 0.1 m and 1 kg, `m a²/6`, that is drawn alone: in mm, as it is, and with a placeholder
/// as inertia.
#[test]
fn visuals_in_millimetres_are_told_by_the_masses_where_there_is_no_length() {
    let told = |size: f64, inertia: f64| {
        let text = format!(
            "<robot name='r'><link name='a'><inertial><mass value='1'/><inertia ixx='{inertia}' \
             iyy='{inertia}' izz='{inertia}' ixy='0' ixz='0' iyz='0'/></inertial><visual><geometry>\
             <box size='{size} {size} {size}'/></geometry></visual></link></robot>"
        );
        let robot = read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default());
        let told = robot.expect("legal").diagnostics.into_iter();
        told.filter(|d| d.code == "U075").map(|d| d.message).next()
    };
    let text = told(100.0, 0.00167).expect("in mm");
    let start = "link 'a': its <visual> is 173.2 m large, in a robot some 0.1 m large";
    assert!(text.starts_with(start), "{text}");
    for (size, inertia) in [(0.1, 0.00167), (0.1, 1e-6), (1.0, 1e-6), (100.0, 1667.0)] {
        assert_eq!(told(size, inertia), None, "{size} {inertia}");
    }
}

/// A rod of 0.1 m whose middle is 1.25 m above the origin of its file, in a robot of nothing else:
/// 12.5 times its own length. An `<origin>` that brings it back, or a joint 0.5 m away, says that
/// it is where it is meant to be.
#[test]
fn a_mesh_far_from_the_frame_of_its_link_is_told_with_what_brings_it_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots");
    let told = |kind: &str, origin: &str, joint: f64, scale: f64| {
        let text = format!(
            "<robot name='r'><link name='a'/><link name='b'><{kind}><origin xyz='{origin}'/>\
             <geometry><mesh filename='meshes/far_off.obj' scale='0.01 0.01 1'/></geometry></{kind}>\
             </link><joint name='j' type='fixed'><origin xyz='0 0 {joint}'/><parent link='a'/>\
             <child link='b'/></joint></robot>"
        );
        let options = ReadOptions {
            scale,
            drawn: true,
            ..ReadOptions::default()
        };
        let robot = read_str(&text, "r.urdf", &folder, &options).expect("legal");
        let mut told = robot.diagnostics.into_iter().filter(|d| d.code == "U069");
        told.next().map(|d| (d.message, d.help.unwrap_or_default()))
    };
    for (kind, scale) in [("collision", 1.0), ("visual", 1.0), ("collision", 100.0)] {
        let (message, help) = told(kind, "0 0 0.01", 0.0, scale).expect("told");
        let away = if scale > 1.0 { "126 m" } else { "1 m" };
        let start = format!("link 'b': the mesh of its <{kind}> is {away} away from its frame");
        assert!(message.starts_with(&start), "{message}");
        assert!(help.contains("xyz=\"0 0 -1.25\""), "{help}");
        assert_eq!(told(kind, "0 0 -1.25", 0.0, scale), None);
        assert_eq!(told(kind, "0 0 0.01", 0.5, scale), None);
    }
}
