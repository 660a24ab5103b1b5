//! Contacts that are too soft for the weight on them.

use super::*;

/// A box of 14 kg, 0.3 m high, on four balls of 0.2 m.
fn rover() -> Description {
    let foot = |name: &str| body(name, 1.0);
    robot(LinkDescription {
        collisions: vec![collision(
            Pose::IDENTITY,
            Shape::Box {
                half: Vec3::new(0.3, 0.2, 0.1),
            },
        )],
        ..mass("chassis", 10.0)
    })
    .with("chassis", "j0", Fixed, at(0.3, 0.2, -0.1), foot("w0"))
    .with("chassis", "j1", Fixed, at(0.3, -0.2, -0.1), foot("w1"))
    .with("chassis", "j2", Fixed, at(-0.3, 0.2, -0.1), foot("w2"))
    .with("chassis", "j3", Fixed, at(-0.3, -0.2, -0.1), foot("w3"))
}

#[test]
fn what_sinks_deeply_is_warned_of_with_depth_and_key() {
    for (settings, key) in [
        ("contact.penetration = 1.0", "[contact] penetration = 1"),
        ("contact.stiffness = 100", "[contact] stiffness = 100"),
        (
            "[link.\"w*\"]\nstiffness = 100",
            "[link.\"w*\"] stiffness = 100",
        ),
        (
            "[contact]\nstiffness = 100\n[initial]\nxyz = [0, 0, 1]",
            "[contact] stiffness = 100",
        ),
    ] {
        let found = note(&assembled(&rover(), settings), "A145");
        assert_eq!(found.severity, Severity::Warning);
        let help = found.help.unwrap_or_default();
        assert!(help.starts_with(key), "{settings}: {help}");
        let words = found.message.split("sinks ").nth(1).expect("a depth");
        let depth: f64 = words
            .split(' ')
            .next()
            .expect("a number")
            .parse()
            .expect("one");
        // Where it comes to rest.
        let text = format!("{settings}\n");
        let mut model = model(&rover(), &text);
        model.roots[0].position.z = 0.2 - 1e-3 * depth;
        let mut simulation = Simulation::new(Arc::new(model));
        simulation.initialize(0.0).expect("a legal start");
        simulation.advance_to(2.0).expect("finite");
        let z = simulation.output(OutputSlot::BasePosition(crate::model::RootId::ROBOT, 2));
        assert!(
            (z - 0.2 + 1e-3 * depth).abs() < 2e-3,
            "{settings}: {z}, {depth}"
        );
    }
}

#[test]
fn what_stands_on_the_ground_is_not() {
    for settings in [
        "",
        "contact.penetration = 5e-3",
        "contact.stiffness = 1e5",
        "contact.penetration = 1.0\nworld.ground.type = \"none\"",
        "contact.penetration = 1.0\nrobot.base = \"fixed\"",
        "contact.penetration = 1.0\nworld.gravity = [0, 0, 0]",
    ] {
        assert!(!has(&assembled(&rover(), settings), "A145"), "{settings}");
    }
    // A point is no thing that is a twentieth deep in the ground.
    let mut point = mass("tip", 1.0);
    let radius = 5e-10;
    point.collisions = vec![collision(Pose::IDENTITY, Shape::Sphere { radius })];
    let built = assembled(&robot(point), "contact.penetration = 5e-3");
    assert!(!has(&built, "A145"));
}

/// A ball of 2 kg under 9.81 m/s² on a spring of `k` N/m is in balance `2 · 9.81/k` m deep.
#[test]
fn a_ball_starts_as_deep_as_its_spring_carries_it_which_is_not_called_deep() {
    let ball = robot(body("ball", 2.0));
    for stiffness in [200.0, 2000.0, 2e4, 1e6, 1e9] {
        let depth = 2.0 * 9.81 / stiffness;
        for key in ["contact.stiffness", "link.ball.stiffness"] {
            let settings = format!("world.gravity = [0, 0, -9.81]\n{key} = {stiffness}");
            let start = |z: f64| {
                let built = assembled(&ball, &format!("{settings}\ninitial.xyz = [0, 0, {z:?}]"));
                let told = has(&built, "A112");
                let mut simulation = Simulation::new(Arc::new(built.model));
                simulation.initialize(0.0).expect("a legal start");
                let deepest = simulation.deepest_in_ground();
                assert_eq!(told, deepest.is_some(), "{key} = {stiffness}, z = {z}");
                deepest.map(|(link, [depth, _])| (link.to_owned(), depth))
            };
            let z = model(&ball, &settings).roots[0].position.z;
            let off = z - (0.1 - depth);
            assert!(
                off.abs() < 1e-6 * depth + 1e-15,
                "{key} = {stiffness}: {off}"
            );
            assert_eq!(start(z), None, "{key} = {stiffness}");
            let (link, found) = start(0.1 - 3.0 * depth).expect("three times as deep");
            assert!(link == "ball" && (found - 3.0 * depth).abs() < 1e-12);
        }
    }
}

/// In a centrifuge or on another star a ball is in balance deeper than a spring that is made for
/// its weight on Earth is deep: by the law `K δ (1 + (δ/δ₁)³)`, documented in docs/design.md, with
/// `K δ₁ 9/16` the weight on Earth, at `δ₁ x` with `x (1 + x³) = 9/16 g/9.81`.
#[test]
fn a_ball_in_balance_is_not_called_deep_whatever_gravity() {
    let ball = robot(body("ball", 2.0));
    for gravity in [9.81, 34.0, 40.0, 150.0, 1e3, 1e4] {
        let settings = format!("world.gravity = [0, 0, -{gravity:?}]");
        let z = model(&ball, &settings).roots[0].position.z;
        let (depth, law) = (0.1 - z, |x: f64| x * (1.0 + x * x * x));
        let expected = 0.5625 * gravity / 9.81;
        let found = law(depth / 1e-4);
        assert!(
            (found - expected).abs() < 1e-6 * expected,
            "{gravity}: {found} {expected}"
        );
        let told = |depth: f64| {
            let z = 0.1 - depth;
            let built = assembled(&ball, &format!("{settings}\ninitial.xyz = [0, 0, {z:?}]"));
            let told = has(&built, "A112");
            let mut simulation = Simulation::new(Arc::new(built.model));
            simulation.initialize(0.0).expect("a legal start");
            assert_eq!(
                told,
                simulation.deepest_in_ground().is_some(),
                "{gravity}: {depth}"
            );
            told
        };
        assert!(!told(depth), "{gravity}");
        assert!(told(3.0 * depth), "{gravity}");
    }
}

/// A ball of 2 kg starts `contact.penetration` deep, as a person writes it, with the round-off of
/// `0.1 − 1e-4`. The law of docs/design.md, `x (1 + x³) = 9/16 F/W`, gives 32/9 = 3.6 weights
/// there, 4.6 at 1.1 such depths, and 10.4 at 1.45.
#[test]
fn a_start_as_deep_as_the_penetration_is_not_called_deep_by_round_off() {
    let ball = robot(body("ball", 2.0));
    for (z, told) in [
        (0.0999, None),
        (0.1 - 1e-4, None),
        (f64::from_bits((0.1_f64 - 1e-4).to_bits() - 9), None),
        (0.1 - 1.1e-4, None),
        (0.1 - 1.45e-4, Some(10.4)),
    ] {
        let built = assembled(&ball, &format!("initial.xyz = [0, 0, {z:?}]"));
        assert_eq!(has(&built, "A112"), told.is_some(), "{z}");
        if told.is_some() {
            let help = note(&built, "A112").help.expect("advice");
            assert!(help.contains("with 10 times its weight"), "{help}");
        }
        let mut simulation = Simulation::new(Arc::new(built.model));
        simulation.initialize(0.0).expect("a legal start");
        let push = simulation.deepest_in_ground().map(|(_, [_, push])| push);
        assert_eq!(push.is_some(), told.is_some(), "{z}");
        assert!(
            push.is_none_or(|push| (push - 10.4).abs() < 0.1),
            "{push:?}"
        );
    }
}
