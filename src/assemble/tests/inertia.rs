//! Links without inertia, or with that of their shapes.

use super::*;

#[test]
fn a_terminal_link_without_inertia_is_an_error_with_a_suggestion() {
    let bare =
        robot(mass("base", 1.0)).with("base", "j", Revolute, at(0.0, 0.0, 0.0), frame("tip"));
    let found = error(&bare, "");
    assert_eq!(found.code, "A104");
    assert!(found.message.contains("'tip'") && found.message.contains("'j'"));
    assert_eq!(found.place.map(|p| p.line), Some(7));
    assert!(
        found
            .help
            .is_some_and(|h| h.contains("<mass value=\"0.1000\"/>"))
    );

    // A cube of 0.2 m at 1000 kg/m³: 8 kg, I = m a²/6 = 0.0533.
    let mut shaped = frame("tip");
    shaped.collisions = vec![collision(
        at(0.5, 0.0, 0.0),
        Shape::Box {
            half: Vec3::repeat(0.1),
        },
    )];
    let found = error(
        &robot(mass("base", 1.0)).with("base", "j", Revolute, at(0.0, 0.0, 0.0), shaped),
        "",
    );
    let help = found.help.expect("help");
    assert!(
        help.contains("<origin xyz=\"0.5000 0.0000 0.0000\"/><mass value=\"8.0000\"/>"),
        "{help}"
    );
    assert!(help.contains("ixx=\"5.333e-2\""), "{help}");
}

#[test]
fn a_massless_link_may_move_if_its_children_have_inertia() {
    // A planar chain in pieces: x, y, then the body; and a gimbal of three axes.
    let about = |axis: Vec3| move |j: &mut JointDescription| j.axis = axis;
    let chain = robot(frame("world"))
        .with("world", "x", Prismatic, at(0.0, 0.0, 0.0), frame("lx"))
        .and(about(Vec3::x()))
        .with("lx", "y", Prismatic, at(0.0, 0.0, 0.0), frame("ly"))
        .and(about(Vec3::y()))
        .with("ly", "yaw", Continuous, at(0.0, 0.0, 0.0), frame("lyaw"))
        .with(
            "lyaw",
            "pitch",
            Continuous,
            at(0.0, 0.0, 0.0),
            frame("lpitch"),
        )
        .and(about(Vec3::y()))
        .with(
            "lpitch",
            "roll",
            Continuous,
            at(0.0, 0.0, 0.0),
            mass("body", 2.0),
        )
        .and(about(Vec3::x()));
    let assembled = assembled(&chain, "");
    assert_eq!(assembled.model.nv(), 5);
    assert!(note(&assembled, "A109").message.contains("'lyaw'"));
    // Two joints about the same axis with nothing between them share one inertia.
    let twice = robot(frame("world"))
        .with(
            "world",
            "a",
            Continuous,
            at(0.0, 0.0, 0.0),
            frame("between"),
        )
        .with(
            "between",
            "b",
            Continuous,
            at(0.0, 0.0, 0.5),
            mass("body", 2.0),
        );
    let found = error(&twice, "");
    assert_eq!(found.code, "A104");
    assert!(
        found.message.contains("'between'") && found.message.contains("'a'"),
        "{}",
        found.message
    );
    // Rotor inertia heals it.
    assert_eq!(model(&twice, "[joint.a]\narmature = 1e-3").nv(), 2);
}

#[test]
fn a_point_mass_on_its_own_axis_has_no_inertia_about_it() {
    let pendulum = |com: Vec3| {
        robot(mass("base", 1.0)).with(
            "base",
            "j",
            Revolute,
            at(0.0, 0.0, 0.0),
            point("bob", 1.0, com),
        )
    };
    assert_eq!(error(&pendulum(Vec3::new(0.0, 0.0, -1.0)), "").code, "A104");
    assert_eq!(model(&pendulum(Vec3::new(1.0, 0.0, 0.0)), "").nv(), 7);
    // A floating point mass could not say how it turns.
    assert_eq!(
        error(&robot(point("bob", 1.0, Vec3::zeros())), "").code,
        "A104"
    );
}

/// A cylinder whose radius the file gives as 0: as a solid it has no inertia about its axis either.
#[test]
fn a_shape_without_width_is_no_help_to_a_link_without_inertia() {
    let mut thing = point("thing", 2.0, Vec3::zeros());
    let needle = Shape::Cylinder {
        radius: 1e-9,
        half_length: 0.1,
    };
    thing.collisions = vec![collision(Pose::IDENTITY, needle)];
    assert_eq!(error(&robot(thing), "").code, "A104");
}

/// A ball of quartz of 0.1 mm: 1.4 µg and, as a solid of this radius, 1.4e-18 kg m². A wheel of
/// 1 kg with as much was written without inertia.
#[test]
fn a_grain_of_a_tenth_of_a_millimetre_has_inertia() {
    let (mass, radius) = (1.4e-9, 5e-5);
    let of = |mass: f64| {
        let mut grain = point("grain", mass, Vec3::zeros());
        if let Some(inertia) = &mut grain.inertial {
            inertia.I_cm = Mat3::identity() * 0.4 * 1.4e-9 * radius * radius;
        }
        grain
    };
    let built = assembled(&robot(of(mass)), "");
    assert!(!has(&built, "A123"));
    let I = built.model.links[0].inertia.I_cm;
    assert!((I[(0, 0)] / (0.4 * mass * radius * radius) - 1.0).abs() < 1e-12);
    assert_eq!(error(&robot(of(1.0)), "").code, "A104");
}

#[test]
fn an_inertia_of_zeros_is_that_of_the_shapes_where_the_link_could_not_move() {
    // As PyBullet's random_urdfs: a mass, zeros, a collision shape. A ball has (2/5) m r².
    let mut thing = point("thing", 2.0, Vec3::zeros());
    thing.collisions = vec![collision(Pose::IDENTITY, ball())];
    let built = assembled(&robot(thing.clone()), "");
    let found = note(&built, "A123");
    assert_eq!(found.severity, Severity::Warning);
    assert_eq!(found.place.map(|p| p.line), Some(7));
    assert!(found.help.is_some_and(|h| h.contains("ixx=\"8.000e-3\"")));
    let I = built.model.links[0].inertia.I_cm;
    assert!((I - Mat3::identity() * 0.4 * 2.0 * 0.01).amax() < 1e-15);
    // The very numbers of random_urdfs: two axes of 1 kg m² and one without.
    let mut needle = thing.clone();
    if let Some(inertia) = &mut needle.inertial {
        inertia.I_cm = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 0.0));
    }
    let built = assembled(&robot(needle), "");
    assert!(has(&built, "A123"));
    let I = built.model.links[0].inertia.I_cm;
    assert!((I - Mat3::identity() * 0.4 * 2.0 * 0.01).amax() < 1e-15);
    // On the end of a lever the same link is the point mass that the file says.
    let lever = robot(mass("base", 1.0)).with("base", "j", Revolute, at(0.0, 0.0, 0.0), {
        let mut bob = thing.clone();
        bob.inertial = point("bob", 2.0, Vec3::x()).inertial;
        bob
    });
    let built = assembled(&lever, "");
    assert!(!has(&built, "A123"));
    assert_eq!(built.model.links[1].inertia.I_cm, Mat3::zeros());
    // Without mass nothing can be worked out.
    let mut empty = frame("shape");
    empty.collisions = thing.collisions;
    let moving = robot(mass("base", 1.0)).with("base", "j", Revolute, at(0.0, 0.0, 0.0), empty);
    assert_eq!(error(&moving, "").code, "A104");
}

/// Only what could not move gets the missing mass: neither frames on fixed joints, nor what carries
/// something that has inertia.
#[test]
fn a_missing_mass_goes_to_links_that_cannot_move_without() {
    let mut shaped = frame("shaped");
    shaped.collisions = vec![collision(at(0.5, 0.0, 0.0), ball())];
    let hand = robot(mass("base", 1.0))
        .with("base", "tool", Fixed, at(0.0, 0.0, 0.1), frame("tool"))
        .with("base", "a", Continuous, at(0.0, 0.0, 0.1), frame("between"))
        .with(
            "between",
            "b",
            Continuous,
            at(0.1, 0.0, 0.0),
            mass("heavy", 2.0),
        )
        .with("base", "c", Continuous, at(0.0, 0.0, 0.1), frame("bare"))
        .with("base", "d", Continuous, at(0.0, 0.0, 0.1), shaped)
        .with(
            "base",
            "e",
            Revolute,
            at(0.0, 0.0, 0.1),
            point("bob", 3.0, Vec3::z()),
        );
    let found = error(&hand, "");
    assert!(
        found.message.starts_with("3 links move"),
        "{}",
        found.message
    );
    let built = assembled(&hand, "robot.missing_mass = 0.5");
    let told = note(&built, "A138").message;
    assert!(told.ends_with(": 'bare', 'shaped', 'bob'"), "{told}");
    let of = |name: &str| {
        let mut links = built.model.links.iter();
        links
            .find(|link| link.name == name)
            .expect("a link")
            .inertia
    };
    assert!(of("tool").mass + of("between").mass < 1e-15);
    // Balls have (2/5) m r²: one of 5 cm, the collision shape of 10 cm, and one of the own mass.
    let moment = |name: &str, mass: f64, radius: f64| {
        let own = of(name);
        assert!((own.mass - mass).abs() < 1e-15, "{name}: {} kg", own.mass);
        let expected = Mat3::identity() * (0.4 * mass * radius * radius);
        assert!((own.I_cm - expected).amax() < 1e-15, "{name}: {}", own.I_cm);
    };
    moment("bare", 0.5, 0.05);
    moment("shaped", 0.5, 0.1);
    moment("bob", 3.0, 0.05);
    assert!((of("shaped").com - Vec3::new(0.5, 0.0, 0.0)).norm() < 1e-15);
    // A density is heard first.
    let dense = assembled(&hand, "robot.density = 1000\nrobot.missing_mass = 0.5");
    let shaped = &dense.model.links[5];
    assert_eq!(shaped.name, "shaped");
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 1e-3;
    assert!((shaped.inertia.mass - 1000.0 * volume).abs() < 1e-12);
}

#[test]
fn very_small_robots_have_inertia_too() {
    // A milligram, a tenth of a millimetre: (2/5) m r² = 4e-15 kg m².
    let mut tiny = frame("tip");
    tiny.inertial = Some(Shape::Sphere { radius: 1e-4 }.solid_inertia(1e-6));
    let description =
        robot(mass("base", 1.0)).with("base", "j", Continuous, at(0.0, 0.0, 0.0), tiny);
    assert_eq!(model(&description, "").nv(), 7);
}

#[test]
fn inertia_from_shapes_is_that_of_the_solid_about_its_own_centre() {
    // A cylinder of 10 kg along y with r = 0.2, l = 0.6, its centre off the file's centre of mass.
    let cylinder = Shape::Cylinder {
        radius: 0.2,
        half_length: 0.3,
    };
    let lying = Pose::from_xyz_rpy(Vec3::new(0.0, 0.0, 0.5), Vec3::new(-FRAC_PI_2, 0.0, 0.0));
    let mut link = mass("drum", 10.0);
    link.inertial = Some(RigidInertia {
        mass: 10.0,
        com: Vec3::new(0.1, 0.2, 0.3),
        I_cm: Mat3::identity(),
    });
    link.collisions = vec![collision(lying, cylinder)];
    let built = assembled(&robot(link.clone()), "robot.inertia = \"collision\"");
    let inertia = &built.model.links[0].inertia;
    assert!(has(&built, "A119"));
    // m r²/2 along the axis, m (3 r² + l²)/12 across it.
    let (along, across) = (0.5 * 10.0 * 0.04, 10.0 / 12.0 * (0.12 + 0.36));
    assert!((inertia.I_cm - Mat3::from_diagonal(&Vec3::new(across, along, across))).amax() < 1e-14);
    assert_eq!(inertia.com, Vec3::new(0.1, 0.2, 0.3));
    // Without the setting the file's stays.
    assert_eq!(
        model(&robot(link), "").links[0].inertia.I_cm,
        Mat3::identity()
    );
}

#[test]
fn several_shapes_share_the_mass_by_volume() {
    // Two equal balls 2 m apart: each (2/5)(m/2) r², and m/2 · 1² across the line between them.
    let mut link = mass("dumbbell", 4.0);
    link.collisions = vec![
        collision(at(1.0, 0.0, 0.0), ball()),
        collision(at(3.0, 0.0, 0.0), ball()),
    ];
    let model = model(&robot(link), "robot.inertia = \"collision\"");
    let own = 0.4 * 4.0 * 0.01;
    let expected = Vec3::new(own, own + 4.0, own + 4.0);
    assert!((model.links[0].inertia.I_cm - Mat3::from_diagonal(&expected)).amax() < 1e-13);
}
