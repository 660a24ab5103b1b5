//! Moving parts: merged links, chains of bodies, the base, colliders.

use super::*;

#[test]
fn fixed_joints_merge_bodies_and_keep_frames() {
    let assembled = assembled(&cart(), "");
    let model = &assembled.model;
    assert_eq!(model.bodies.len(), 3);
    assert_eq!((model.nv(), model.nq), (8, 9));
    let camera = &model.links[4];
    assert_eq!(camera.body, BodyId(0));
    // Two translations add: (0, 0, 0.5) + (0.1, 0, 0).
    assert!((camera.X_BL.p - Vec3::new(0.1, 0.0, 0.5)).norm() < 1e-15);
    let merged = note(&assembled, "A108");
    assert!(merged.message.starts_with("2 links"), "{}", merged.message);
    assert!(merged.message.contains("'mast_link', 'camera_link'"));
    assert_eq!(merged.severity, Severity::Note);
}

#[test]
fn a_moving_joint_behind_a_fixed_one_starts_from_the_merged_body() {
    let turned = Pose::from_xyz_rpy(Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, FRAC_PI_2));
    let description = robot(mass("base", 1.0))
        .with("base", "f", Fixed, turned, frame("arm"))
        .with("arm", "j", Revolute, at(2.0, 0.0, 0.0), mass("tip", 1.0));
    let model = model(&description, "");
    let body = body_of(&model, "j");
    assert_eq!(body.parent, Some(BodyId(0)));
    // Turned by 90° about z, 2 m along x become 2 m along y.
    assert!((body.X_PB.p - Vec3::new(1.0, 2.0, 0.0)).norm() < 1e-15);
    assert_eq!(model.links[2].X_BL, Pose::IDENTITY);
    assert_eq!(body.link, LinkId(2));
}

#[test]
fn a_planar_joint_is_two_slides_and_a_turn() {
    for (axis, u, w) in [
        (Vec3::z(), Vec3::x(), Vec3::y()),
        (Vec3::x(), Vec3::y(), Vec3::z()),
        (Vec3::y(), Vec3::z(), Vec3::x()),
    ] {
        let description = robot(mass("world", 0.0))
            .with(
                "world",
                "plane",
                Planar,
                at(0.0, 0.0, 1.0),
                mass("puck", 2.0),
            )
            .and(|j| j.axis = axis);
        let model = model(&description, "");
        let motions: Vec<_> = model.bodies.iter().map(|b| b.motion).collect();
        assert_eq!(
            motions,
            [
                Motion::Welded,
                Motion::Prismatic(u),
                Motion::Prismatic(w),
                Motion::Revolute(axis)
            ]
        );
        assert_eq!(model.links[1].body, BodyId(3));
        assert_eq!(model.bodies[1].X_PB, at(0.0, 0.0, 1.0));
        assert_eq!(model.bodies[3].X_PB, Pose::IDENTITY);
        assert_eq!((model.nq, model.nv()), (3, 3));
    }
}

#[test]
fn plane_axes_are_right_handed_for_any_normal() {
    let mut random = crate::testing::Random(3);
    for _ in 0..1000 {
        let n = random.unit();
        let [u, w] = crate::assemble::bodies::plane_axes(&n);
        assert!((u.norm() - 1.0).abs() < 1e-14 && (w.norm() - 1.0).abs() < 1e-14);
        assert!((u.cross(&w) - n).norm() < 1e-14);
    }
}

#[test]
fn a_floating_joint_inside_the_robot_is_three_slides_and_a_ball() {
    let description = robot(body("world", 0.0))
        .with(
            "world",
            "arm",
            Revolute,
            at(0.0, 0.0, 0.0),
            mass("link", 1.0),
        )
        .with(
            "world",
            "free",
            Floating,
            at(0.0, 1.0, 2.0),
            body("box", 3.0),
        );
    let model = model(&description, "");
    assert!(!model.is_floating());
    let joint = &model.joints[1];
    assert_eq!(joint.bodies.len(), 4);
    assert_eq!(
        model.bodies[joint.bodies[3].index()].motion,
        Motion::Spherical
    );
    assert_eq!((model.nq, model.nv()), (1 + 3 + 4, 1 + 3 + 3));
}

/// A spinning top that hangs by its tip: a spherical pendulum. Period of small swings about any
/// horizontal axis: `2π √(I / m g l)`, with `I` about the tip.
#[test]
fn a_spherical_joint_swings_to_all_sides_alike() {
    let (m, l) = (2.0, 0.5);
    let mut bob = mass("bob", m);
    if let Some(inertia) = &mut bob.inertial {
        inertia.com = Vec3::new(0.0, 0.0, -l);
    }
    let description =
        robot(frame("world")).with("world", "ball", Spherical, at(0.0, 0.0, 2.0), bob);
    let built = model(&description, "solver.tolerance = 1e-8");
    assert_eq!((built.nv(), built.actuators.len()), (3, 0));
    let I = 0.4 * m * 0.01 + m * l * l;
    let period = 2.0 * PI * (I / (m * 9.81 * l)).sqrt();
    for axis in 0..2 {
        let mut s = Simulation::new(Arc::new(built.clone()));
        s.initialize(0.0).expect("a legal start");
        let rate = 0.01;
        s.state_mut().physical.v[axis] = rate;
        let mut read = |time: f64| {
            s.advance_to(time).expect("finite");
            let ball = JointId(0);
            let place = u8::try_from(axis).expect("few");
            (
                s.output(OutputSlot::JointOrientation(ball, place)),
                s.output(OutputSlot::JointVelocity(ball, place)),
            )
        };
        // After a quarter it is furthest out: angle ω₀ T/2π, half of it in the quaternion; after a
        // half it comes back.
        let (turn, _) = read(period / 4.0);
        let furthest = 0.5 * rate * period / (2.0 * PI);
        assert!(
            (turn / furthest - 1.0).abs() < 1e-4,
            "{turn} is not {furthest}"
        );
        let (_, back) = read(period / 2.0);
        assert!((back / rate + 1.0).abs() < 1e-4, "{back}");
    }
    // About the vertical nothing pulls back: with damping d the rate falls as exp(−d t / I_zz).
    let damped = assembled(&description, "[joint.ball]\ndamping = 0.02\nfriction = 1");
    assert_eq!(note(&damped, "A122").severity, Severity::Warning);
    let mut s = Simulation::new(Arc::new(damped.model));
    s.initialize(0.0).expect("a legal start");
    s.state_mut().physical.v[2] = 1.0;
    s.advance_to(0.3).expect("finite");
    let expected = (-0.02_f64 * 0.3 / (0.4 * m * 0.01)).exp();
    let rate = s.output(OutputSlot::JointVelocity(JointId(0), 2));
    assert!((rate - expected).abs() < 2e-3, "{rate} is not {expected}");
}

#[test]
fn a_massless_root_with_one_floating_joint_is_the_world() {
    let description = robot(frame("map"))
        .with(
            "map",
            "root_joint",
            Floating,
            at(0.0, 3.0, 1.0),
            body("trunk", 3.0),
        )
        .with(
            "trunk",
            "knee",
            Revolute,
            at(0.0, 0.0, -0.3),
            body("shank", 1.0),
        );
    let assembled = assembled(&description, "");
    let built = &assembled.model;
    assert!(built.is_floating());
    assert_eq!(built.links[0].name, "trunk");
    assert_eq!(built.joints.len(), 1);
    assert_eq!(built.joints[0].parent, LinkId(0));
    // y is the joint's, z makes the shank's ball of radius 0.1 touch the ground.
    assert!(close(built.roots[0].position.y, 3.0) && sunk(built.roots[0].position.z, 0.4));
    assert!(note(&assembled, "A107").message.contains("'map'"));
    // Bolted down, its trunk is the fixed base.
    let fixed = model(
        &description,
        "robot.base = \"fixed\"\ninitial.xyz = [0, 0, 2]",
    );
    assert_eq!(fixed.bodies[0].motion, Motion::Welded);
    assert!(close(fixed.roots[0].position.z, 3.0));
}

#[test]
fn the_base_is_chosen_by_name_and_mass_unless_the_settings_say_it() {
    let arm = |root: LinkDescription| {
        let name = root.name.clone();
        robot(root).with(&name, "j", Revolute, at(0.0, 0.0, 0.0), mass("tip", 1.0))
    };
    for (root, settings, floating) in [
        (mass("base", 1.0), "", true),
        (frame("base"), "", false),
        (mass("world", 1.0), "", false),
        (mass("base", 1.0), "robot.base = \"fixed\"", false),
        (mass("world", 1.0), "robot.base = \"floating\"", true),
    ] {
        let name = root.name.clone();
        let assembled = assembled(&arm(root), settings);
        assert_eq!(assembled.model.is_floating(), floating, "{name} {settings}");
        assert_eq!(has(&assembled, "A107"), settings.is_empty());
    }
    // As the file tells Gazebo; what is said here counts more.
    for (settings, floating) in [("", false), ("robot.base = \"floating\"", true)] {
        let ramp = Description {
            stands_still: true,
            ..robot(mass("ramp", 1.0))
        };
        let assembled = assembled(&ramp, settings);
        assert_eq!(assembled.model.is_floating(), floating, "{settings}");
        if settings.is_empty() {
            let found = note(&assembled, "A107");
            assert!(found.message.contains("<static>"), "{}", found.message);
        }
    }
    // A footprint frame in front of the real base has mass by way of its fixed joint.
    let footprint = robot(frame("base_footprint"))
        .with(
            "base_footprint",
            "f",
            Fixed,
            at(0.0, 0.0, 0.1),
            mass("base_link", 3.0),
        )
        .with(
            "base_link",
            "j",
            Continuous,
            at(0.0, 0.0, 0.0),
            mass("wheel", 1.0),
        );
    assert!(model(&footprint, "").is_floating());
}

#[test]
fn a_floating_robot_without_mass_is_an_error() {
    let found = error(&robot(frame("plane")), "robot.base = \"floating\"");
    assert_eq!(found.code, "A105");
    assert!(
        found.help.as_deref().is_some_and(|h| h.contains("fixed")),
        "{found:?}"
    );
    assert!(
        model(&robot(frame("plane")), "robot.base = \"fixed\"")
            .dofs
            .is_empty()
    );
}

#[test]
fn a_robot_without_mass_and_moving_joints_is_scenery() {
    // As PyBullet's plane.urdf, and a table of several links.
    let mut top = frame("top");
    top.collisions = vec![collision(Pose::IDENTITY, ball())];
    let table = robot(frame("table")).with("table", "f", Fixed, at(0.0, 0.0, 1.0), top);
    for scenery in [robot(frame("plane")), table] {
        let built = assembled(&scenery, "");
        assert!(built.model.dofs.is_empty() && !built.model.is_floating());
        let found = note(&built, "A107");
        assert_eq!(found.severity, Severity::Warning);
        assert!(found.message.contains("stands still"), "{}", found.message);
    }
}

#[test]
fn every_shape_has_room_for_its_contact_points() {
    let mut link = body("base", 1.0);
    link.collisions.push(collision(
        at(0.0, 0.0, 1.0),
        Shape::Box {
            half: Vec3::repeat(0.1),
        },
    ));
    link.collisions.push(collision(
        at(0.0, 0.0, 2.0),
        Shape::Capsule {
            radius: 0.1,
            half_length: 0.2,
        },
    ));
    let model = model(&robot(link), "");
    let points: Vec<_> = model.colliders.iter().map(|c| c.shape.points()).collect();
    assert_eq!(points, [1, 8, 2]);
    assert_eq!(model.contact_room(), [3, 11]);
}

#[test]
fn colliders_lie_in_their_body_s_frame() {
    let description = robot(mass("base", 1.0)).with("base", "f", Fixed, at(0.0, 0.0, 1.0), {
        let mut link = body("arm", 1.0);
        link.collisions[0].X_LG = at(0.0, 2.0, 0.0);
        link
    });
    let model = model(&description, "");
    assert!((model.colliders[0].X_BG.p - Vec3::new(0.0, 2.0, 1.0)).norm() < 1e-15);
    assert_eq!(
        (model.colliders[0].link, model.colliders[0].body),
        (LinkId(1), BodyId(0))
    );
}
