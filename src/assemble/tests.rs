use super::testing::*;
use crate::geometry::Shape;
use crate::model::{ActuatorMode, BodyId, JointId, JointKind, Limits, LinkId, Model, Motion};
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3};
use crate::urdf::{Description, Severity};
use std::f64::consts::{FRAC_PI_2, PI};

use JointKind::{Continuous, Fixed, Floating, Planar, Prismatic, Revolute, Spherical};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * (1.0 + b.abs())
}

fn body_of<'m>(model: &'m Model, joint: &str) -> &'m crate::model::Body {
    let joint = model
        .joints
        .iter()
        .find(|j| j.name == joint)
        .expect("the joint");
    &model.bodies[joint.bodies[0].index()]
}

/// A box on two wheels and a caster fork, as robots are.
fn cart() -> Description {
    robot(body("chassis", 5.0))
        .with(
            "chassis",
            "left",
            Continuous,
            at(0.0, 0.2, -0.1),
            body("left_wheel", 1.0),
        )
        .with(
            "chassis",
            "right",
            Continuous,
            at(0.0, -0.2, -0.1),
            body("right_wheel", 1.0),
        )
        .with(
            "chassis",
            "mast",
            Fixed,
            at(0.0, 0.0, 0.5),
            frame("mast_link"),
        )
        .with(
            "mast_link",
            "camera",
            Fixed,
            at(0.1, 0.0, 0.0),
            mass("camera_link", 0.5),
        )
}

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
        let [u, w] = super::bodies::plane_axes(&n);
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
    let model = &assembled.model;
    assert!(model.is_floating());
    assert_eq!(model.links[0].name, "trunk");
    assert_eq!(model.joints.len(), 1);
    assert_eq!(model.joints[0].parent, LinkId(0));
    // y is the joint's, z makes the shank's ball of radius 0.1 touch the ground.
    assert!(close(model.initial.position.y, 3.0) && close(model.initial.position.z, 0.4));
    assert!(note(&assembled, "A107").message.contains("'map'"));
    // Bolted down, its trunk is the fixed base.
    let fixed = testing_model(
        &description,
        "robot.base = \"fixed\"\ninitial.xyz = [0, 0, 2]",
    );
    assert_eq!(fixed.bodies[0].motion, Motion::Welded);
    assert!(close(fixed.initial.position.z, 3.0));
}

fn testing_model(description: &Description, settings: &str) -> Model {
    model(description, settings)
}

#[test]
fn the_base_is_chosen_by_name_and_mass_unless_the_settings_say_it() {
    let arm = |root: crate::urdf::LinkDescription| {
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
fn what_has_no_mass_and_no_moving_joint_stands_still() {
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
fn mimic_chains_lead_to_the_independent_joint() {
    let description = robot(mass("world", 0.0))
        .with("world", "c", Revolute, at(0.0, 0.0, 0.0), mass("lc", 1.0))
        .mimicking("b", 3.0, 0.25)
        .with("world", "b", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
        .mimicking("a", -2.0, 0.5)
        .with("world", "a", Continuous, at(0.0, 0.0, 0.0), mass("la", 1.0));
    let model = model(&description, "");
    assert_eq!((model.nq, model.nv()), (1, 1));
    let c = model.joints[0].mimic.expect("mimic");
    // c = 3 b + 0.25 = 3 (−2 a + 0.5) + 0.25 = −6 a + 1.75
    assert_eq!(c.joint, JointId(2));
    assert!(close(c.multiplier, -6.0) && close(c.offset, 1.75));
    assert!(close(model.bodies[1].ratio, -6.0) && close(model.bodies[1].offset, 1.75));
    assert_eq!(model.dofs[0].body, BodyId(3));
    // −1 ≤ b ≤ 2 gives −0.75 ≤ a ≤ 0.75; −1 ≤ c ≤ 2 gives −1/24 ≤ a ≤ 11/24.
    let limits = model.dofs[0].limits.expect("limits");
    assert!(
        close(limits.lower, -0.25 / 6.0) && close(limits.upper, 2.75 / 6.0),
        "{limits:?}"
    );
    // One actuator, on the independent joint.
    assert_eq!(model.actuators.len(), 1);
    assert_eq!(model.actuators[0].joint, JointId(2));
}

#[test]
fn wrong_mimics_are_errors_that_name_the_joints() {
    let two = |target: &str| {
        robot(mass("base", 1.0))
            .with("base", "a", Revolute, at(0.0, 0.0, 0.0), mass("la", 1.0))
            .mimicking(target, 1.0, 0.0)
            .with("base", "bee", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
            .with("base", "fix", Fixed, at(0.0, 0.0, 0.0), mass("lf", 1.0))
    };
    let found = error(&two("beee"), "");
    assert_eq!(found.code, "A103");
    assert!(
        found.help.as_deref().is_some_and(|h| h.contains("'bee'")),
        "{found:?}"
    );
    assert_eq!(found.place.map(|p| p.line), Some(9));
    assert!(error(&two("a"), "").message.contains("itself"));
    assert!(error(&two("fix"), "").message.contains("is fixed"));
    let circle = robot(mass("base", 1.0))
        .with("base", "a", Revolute, at(0.0, 0.0, 0.0), mass("la", 1.0))
        .mimicking("b", 1.0, 0.0)
        .with("base", "b", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
        .mimicking("a", 1.0, 0.0);
    assert_eq!(errors(&circle, "").len(), 2);
}

#[test]
fn limits_that_exclude_each_other_keep_the_leader_s() {
    let description = robot(mass("world", 0.0))
        .with("world", "a", Revolute, at(0.0, 0.0, 0.0), mass("la", 1.0))
        .with("world", "b", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
        .mimicking("a", 1.0, 100.0);
    let assembled = assembled(&description, "");
    let warning = note(&assembled, "A118");
    assert_eq!(warning.severity, Severity::Warning);
    assert_eq!(
        assembled.model.dofs[0].limits,
        Some(Limits {
            lower: -1.0,
            upper: 2.0
        })
    );
}

#[test]
fn joint_zero_outside_the_limits_moves_to_the_nearest_limit() {
    let description = robot(mass("base", 1.0))
        .with(
            "base",
            "knee",
            Revolute,
            at(0.0, 0.0, 0.0),
            mass("shank", 1.0),
        )
        .and(|j| {
            j.limits = Some(Limits {
                lower: -2.7,
                upper: -0.9,
            });
        });
    let built = assembled(&description, "");
    assert!(close(built.model.initial.joint_positions[0], -0.9));
    let found = note(&built, "A110");
    assert!(found.message.contains("knee = -0.9"), "{}", found.message);

    let set = assembled(&description, "initial.joints = { knee = -2 }");
    assert!(close(set.model.initial.joint_positions[0], -2.0));
    assert!(!has(&set, "A110"));

    let found = error(&description, "initial.joints = { knee = 1 }");
    assert_eq!(found.code, "A106");
    assert_eq!(
        found.place.as_ref().map(|p| (p.line, p.column)),
        Some((1, 20))
    );
}

#[test]
fn names_and_globs_that_match_nothing_name_the_nearest() {
    for settings in [
        "[[actuator]]\njoint = \"lefft\"",
        "[joint.lefft]\ndamping = 1",
        "initial.joints = { lefft = 1 }",
        "initial.joint_velocities = { lefft = 1 }",
    ] {
        let found = error(&cart(), settings);
        assert_eq!(found.code, "A101", "{settings}");
        assert!(
            found.help.as_deref().is_some_and(|h| h.contains("'left'")),
            "{found:?}"
        );
        assert!(found.place.is_some(), "{settings}");
    }
    for settings in [
        "[link.chasis]\nfriction = 1",
        "outputs.links = [\"chasis\"]",
        "outputs.contacts = [\"chasis\"]",
        "[[external_wrench]]\nlink = \"chasis\"",
    ] {
        let found = error(&cart(), settings);
        assert_eq!(found.code, "A101", "{settings}");
        assert!(
            found
                .help
                .as_deref()
                .is_some_and(|h| h.contains("'chassis'")),
            "{found:?}"
        );
    }
}

#[test]
fn unsuitable_names_say_why_and_globs_pass_over_them() {
    for (settings, why) in [
        ("[[actuator]]\njoint = \"mast\"", "is fixed"),
        ("[joint.mast]\ndamping = 1", "is fixed"),
        ("initial.joints = { mast = 1 }", "is fixed"),
        ("[link.mast_link]\nmass = 2", "no <inertial>"),
        ("outputs.contacts = [\"camera_link\"]", "no collision shape"),
    ] {
        let found = error(&cart(), settings);
        assert_eq!(found.code, "A102", "{settings}");
        assert!(found.message.contains(why), "{}", found.message);
    }
    let model = model(
        &cart(),
        "[joint.\"*\"]\ndamping = 2\n[link.\"*\"]\nmass = 2\n",
    );
    assert!(close(model.joints[0].damping, 2.0) && close(model.joints[2].damping, 0.0));
    assert!(close(model.links[0].inertia.mass, 2.0) && close(model.links[3].inertia.mass, 0.0));
}

#[test]
fn settings_replace_the_file_s_joint_and_link_properties() {
    let model = model(
        &cart(),
        "[joint.\"*\"]\ndamping = 1\nfriction = 2\narmature = 3\n\
         [joint.left]\ndamping = 4\nlimits = { lower = -1, upper = 1 }\neffort = 5\nvelocity = 0\n\
         [link.chassis]\nmass = 10\nfriction = 0.3\nrestitution = 0.5\n",
    );
    let (left, right) = (&model.joints[0], &model.joints[1]);
    assert!(close(left.damping, 4.0) && close(right.damping, 1.0));
    assert!(close(left.friction, 2.0) && close(left.armature, 3.0));
    assert_eq!(
        left.limits,
        Some(Limits {
            lower: -1.0,
            upper: 1.0
        })
    );
    assert_eq!((left.effort, left.velocity), (Some(5.0), None));
    assert_eq!((right.effort, right.velocity), (Some(10.0), Some(5.0)));
    let chassis = &model.links[0];
    assert!(close(chassis.inertia.mass, 10.0) && close(chassis.friction, 0.3));
    // The inertia of the 5 kg ball doubles: 2 · (2/5) 5 0.1².
    assert!(close(chassis.inertia.I_cm[(0, 0)], 0.04));
    assert!(close(model.links[1].friction, 0.8));
}

#[test]
fn half_a_range_without_the_file_s_other_half_is_an_error() {
    let found = error(&cart(), "[joint.left]\nlimits = { lower = -1 }");
    assert_eq!(found.code, "A117");
    let arm =
        robot(mass("base", 1.0)).with("base", "j", Revolute, at(0.0, 0.0, 0.0), mass("t", 1.0));
    let set = model(&arm, "[joint.j]\nlimits = { lower = 0.5 }");
    assert_eq!(
        set.joints[0].limits,
        Some(Limits {
            lower: 0.5,
            upper: 2.0
        })
    );
    assert_eq!(
        error(&arm, "[joint.j]\nlimits = { lower = 3 }").code,
        "A117"
    );
}

#[test]
fn limits_that_are_no_range_count_as_none() {
    let description = robot(mass("base", 1.0))
        .with("base", "j", Revolute, at(0.0, 0.0, 0.0), mass("t", 1.0))
        .and(|j| {
            j.limits = Some(Limits {
                lower: 0.0,
                upper: -1.0,
            });
        });
    let assembled = assembled(&description, "");
    assert_eq!(assembled.model.joints[0].limits, None);
    assert_eq!(note(&assembled, "A117").severity, Severity::Warning);
}

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

/// A spinning top that hangs by its tip: a spherical pendulum. Period of small swings about any horizontal axis:
/// `2π √(I / m g l)`, with `I` about the tip.
#[test]
fn a_spherical_joint_swings_to_all_sides_alike() {
    use crate::simulation::{OutputSlot, Simulation};
    use std::sync::Arc;
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
        s.state_mut().v[axis] = rate;
        let mut read = |time: f64| {
            s.advance_to(time).expect("finite");
            let ball = JointId(0);
            let place = u8::try_from(axis).expect("few");
            (
                s.output(OutputSlot::JointOrientation(ball, place)),
                s.output(OutputSlot::JointVelocity(ball, place)),
            )
        };
        // After a quarter it is furthest out: angle ω₀ T/2π, half of it in the quaternion; after a half it comes back.
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
    s.state_mut().v[2] = 1.0;
    s.advance_to(0.3).expect("finite");
    let expected = (-0.02_f64 * 0.3 / (0.4 * m * 0.01)).exp();
    let rate = s.output(OutputSlot::JointVelocity(JointId(0), 2));
    assert!((rate - expected).abs() < 2e-3, "{rate} is not {expected}");
}

#[test]
fn massless_links_may_move_what_has_inertia() {
    // A planar chain in pieces: x, y, then the body; and a gimbal of three axes.
    let about = |axis: Vec3| move |j: &mut crate::urdf::JointDescription| j.axis = axis;
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

#[test]
fn a_floating_robot_starts_with_its_lowest_point_on_the_ground() {
    let built = assembled(&cart(), "");
    // The wheels' centres are 0.1 below the base's, their radius is 0.1.
    assert!(close(built.model.initial.position.z, 0.2));
    assert!(note(&built, "A111").message.contains("z = 0.200000"));
    // Turned by 90° about x, the right wheel's centre at y = −0.2 is lowest; the left one's after −90°.
    let leaning = model(&cart(), &format!("initial.rpy = [{FRAC_PI_2}, 0, 0]"));
    assert!((leaning.initial.position.z - 0.3).abs() < 1e-12);
    // Upside down nothing but the mast's frames is lower than the chassis' ball.
    let over = model(
        &cart(),
        &format!("initial.rpy = [{PI}, 0, 0]\ninitial.xyz = [5, 6]"),
    );
    assert!((over.initial.position - Vec3::new(5.0, 6.0, 0.1)).norm() < 1e-12);
}

#[test]
fn joint_positions_count_for_the_initial_height() {
    let leg = robot(body("trunk", 1.0))
        .with(
            "trunk",
            "hip",
            Revolute,
            at(0.0, 0.0, 0.0),
            mass("thigh", 1.0),
        )
        .and(|j| j.axis = Vec3::y())
        .with(
            "thigh",
            "foot_joint",
            Fixed,
            at(0.0, 0.0, -1.0),
            body("foot", 1.0),
        );
    assert!(close(model(&leg, "").initial.position.z, 1.1));
    let bent = model(&leg, "initial.joints = { hip = 1.0471975511965976 }");
    // 60°: the foot's centre is cos 60° = 0.5 m below.
    assert!((bent.initial.position.z - 0.6).abs() < 1e-12);
}

#[test]
fn a_start_inside_the_ground_is_warned_about_with_its_depth() {
    let deep = assembled(&cart(), "initial.xyz = [0, 0, 0.1]");
    let found = note(&deep, "A112");
    assert!(found.message.contains("100.000 mm"), "{}", found.message);
    assert!(found.help.is_some_and(|h| h.contains("0.200000")));
    assert!(close(deep.model.initial.position.z, 0.1));
    for settings in [
        "initial.xyz = [0, 0, 0.2]",
        "initial.xyz = [0, 0, 5]",
        "initial.xyz = [0, 0, 0.1]\nworld.ground = { type = \"none\" }",
    ] {
        assert!(!has(&assembled(&cart(), settings), "A112"), "{settings}");
    }
    // A fixed base is where it is; only what moves is looked at.
    let arm = robot(body("pedestal", 1.0)).with(
        "pedestal",
        "j",
        Revolute,
        at(0.0, 0.0, 0.05),
        body("arm", 1.0),
    );
    let fixed = assembled(&arm, "robot.base = \"fixed\"");
    assert!(note(&fixed, "A112").message.contains("50.000 mm"));
    assert!(close(fixed.model.initial.position.z, 0.0));
}

#[test]
fn without_shapes_or_ground_the_base_starts_at_zero() {
    for (description, settings) in [
        (robot(mass("satellite", 1.0)), ""),
        (cart(), "world.ground = { type = \"none\" }"),
    ] {
        let assembled = assembled(&description, settings);
        assert!(close(assembled.model.initial.position.z, 0.0));
        assert!(note(&assembled, "A111").message.contains("z = 0"));
    }
}

#[test]
fn limited_joints_are_commanded_by_position_others_by_velocity() {
    let description = cart().with(
        "chassis",
        "lift",
        Prismatic,
        at(0.0, 0.0, 0.0),
        mass("fork", 1.0),
    );
    let model = model(&description, "");
    let modes: Vec<_> = model.actuators.iter().map(|a| a.mode).collect();
    assert_eq!(
        modes,
        [
            ActuatorMode::Velocity,
            ActuatorMode::Velocity,
            ActuatorMode::Position
        ]
    );
    assert!(model.actuators.iter().all(|a| close(a.max_effort, 10.0)));
}

#[test]
fn later_actuator_entries_win_key_by_key() {
    let model = model(
        &cart(),
        "[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 1\nkd = 2\nmax_effort = 3\n\
         [[actuator]]\njoint = \"right\"\nkp = 7\n",
    );
    let [left, right] = &model.actuators[..] else {
        panic!("two")
    };
    assert_eq!(
        (left.mode, right.mode),
        (ActuatorMode::Pd, ActuatorMode::Pd)
    );
    assert!(close(left.kp, 1.0) && close(right.kp, 7.0) && close(right.kd, 2.0));
    assert!(close(right.max_effort, 3.0) && close(right.reference_effort, 3.0));
    let passive = testing_model(&cart(), "[[actuator]]\njoint = \"left\"\nmode = \"none\"");
    assert_eq!(passive.actuators.len(), 1);
    assert_eq!(passive.actuators[0].joint, JointId(1));
}

#[test]
fn missing_efforts_get_a_default_from_weight_and_reach() {
    let description = robot(mass("base", 1.0))
        .with(
            "base",
            "turn",
            Continuous,
            at(0.0, 0.0, 0.0),
            point("arm", 1.0, Vec3::new(2.0, 0.0, 0.0)),
        )
        .and(|j| j.effort = None)
        .with(
            "base",
            "slide",
            Prismatic,
            at(0.0, 0.0, 0.0),
            mass("fork", 1.0),
        )
        .and(|j| j.effort = Some(f64::NAN));
    let assembled = assembled(&description, "");
    // 3 kg and 2 m reach: 2 · 3 · 9.81 · 2 = 117.72; 10 · 3 · 9.81 = 294.3; three digits.
    assert!(close(assembled.model.actuators[0].max_effort, 118.0));
    assert!(close(assembled.model.actuators[0].reference_effort, 118.0));
    assert!(close(assembled.model.actuators[1].max_effort, 294.0));
    assert_eq!(assembled.model.joints[0].effort, None);
    let found = note(&assembled, "A113");
    assert!(found.message.contains("turn = 118") && found.message.contains("slide = 294"));
}

#[test]
fn an_effort_limit_of_zero_stays_and_is_warned_about() {
    let description = robot(mass("base", 1.0))
        .with("base", "j", Continuous, at(0.0, 0.0, 0.0), mass("w", 1.0))
        .and(|j| j.effort = Some(0.0));
    let built = assembled(&description, "");
    assert_eq!(note(&built, "A114").severity, Severity::Warning);
    let motor = &built.model.actuators[0];
    assert!(close(motor.max_effort, 0.0) && motor.reference_effort > 1.0);
    // Asked for in the settings, it is what the user wants.
    assert!(!has(
        &assembled(&description, "[[actuator]]\njoint = \"j\"\nmax_effort = 0"),
        "A114"
    ));
}

#[test]
fn leaf_links_with_shapes_have_contact_outputs() {
    let names = |model: &Model| -> Vec<String> {
        let links = &model.outputs.contacts;
        links
            .iter()
            .map(|l| model.links[l.index()].name.clone())
            .collect()
    };
    // The chassis carries the wheels, the mast has no shape.
    assert_eq!(names(&model(&cart(), "")), ["left_wheel", "right_wheel"]);
    assert_eq!(names(&model(&robot(body("cube", 1.0)), "")), ["cube"]);
    assert!(names(&model(&cart(), "outputs.contacts = \"none\"")).is_empty());
    assert!(names(&model(&cart(), "world.ground = { type = \"none\" }")).is_empty());
    assert_eq!(
        names(&model(&cart(), "outputs.contacts = [\"*\"]")),
        ["chassis", "left_wheel", "right_wheel"]
    );
    // A foot fixed to a shank: both are the end of the leg. The fixed base touches nothing.
    let leg = robot(body("world", 1.0))
        .with(
            "world",
            "knee",
            Revolute,
            at(0.0, 0.0, 1.0),
            body("shank", 1.0),
        )
        .with(
            "shank",
            "ankle",
            Fixed,
            at(0.0, 0.0, -0.5),
            body("foot", 1.0),
        );
    assert_eq!(names(&model(&leg, "")), ["shank", "foot"]);
}

#[test]
fn slots_of_colliders_follow_each_other() {
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
    let slots: Vec<_> = model.colliders.iter().map(|c| c.slot).collect();
    assert_eq!(slots, [0, 1, 9]);
    assert_eq!(model.contact_slots(), 11);
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

#[test]
fn properties_of_planar_and_floating_joints_are_not_used() {
    let description = robot(frame("world"))
        .with("world", "p", Planar, at(0.0, 0.0, 0.0), mass("puck", 1.0))
        .and(|j| j.damping = 1.0);
    let assembled = assembled(&description, "");
    assert_eq!(note(&assembled, "A122").severity, Severity::Warning);
    assert!(close(assembled.model.joints[0].damping, 0.0));
}

#[test]
fn what_other_programs_say_of_surfaces_and_rotors_is_used_unless_the_settings_differ() {
    let mut wheel = body("wheel", 1.0);
    wheel.friction = Some(0.5);
    wheel.static_friction = Some(0.75);
    wheel.rolling_friction = Some(0.001);
    wheel.torsional_friction = Some(0.02);
    let description = robot(mass("base", 1.0))
        .with("base", "j", Continuous, at(0.0, 0.0, 0.0), wheel)
        .and(|j| j.armature = 0.25);
    let built = model(&description, "");
    let link = &built.links[1];
    assert!(close(link.friction, 0.5) && close(link.static_excess, 0.5));
    assert!(close(link.rolling_friction, 0.001) && close(link.torsional_friction, 0.02));
    assert!(close(built.joints[0].armature, 0.25));
    let set = "[link.wheel]\nrolling_friction = 0\nfriction = 0.9\n[joint.j]\narmature = 1";
    let built = model(&description, set);
    let link = &built.links[1];
    // The file's friction at rest goes with the file's sliding friction.
    assert!(close(link.friction, 0.9) && close(link.static_excess, 0.0));
    assert!(close(link.rolling_friction, 0.0) && close(link.torsional_friction, 0.02));
    assert!(close(built.joints[0].armature, 1.0));
}

#[test]
fn the_commands_that_the_hardware_takes_are_suggested_not_taken() {
    let description = robot(mass("base", 1.0))
        .with("base", "j", Revolute, at(0.0, 0.0, 0.0), mass("arm", 1.0))
        .and(|j| j.interfaces = vec![ActuatorMode::Effort]);
    let built = assembled(&description, "");
    assert_eq!(built.model.actuators[0].mode, ActuatorMode::Position);
    let found = note(&built, "A126");
    assert!(found.message.contains("effort commands for 1 joint") && found.message.contains("'j'"));
    assert!(found.help.is_some_and(|h| h.contains("--mode effort")));
    let chosen = assembled(
        &description,
        "[[actuator]]\njoint = \"j\"\nmode = \"position\"",
    );
    assert!(!has(&chosen, "A126"));
    let both = description.and(|j| j.interfaces.push(ActuatorMode::Position));
    assert!(!has(&assembled(&both, ""), "A126"));
}

#[test]
fn default_friction_is_told_once_and_only_where_it_is_used() {
    assert!(
        note(&assembled(&cart(), ""), "A116")
            .message
            .contains("3 links")
    );
    let mut cube = body("cube", 1.0);
    cube.friction = Some(0.3);
    cube.restitution = Some(0.4);
    let built = assembled(&robot(cube), "");
    assert!(!has(&built, "A116"));
    assert!(
        close(built.model.links[0].friction, 0.3) && close(built.model.links[0].restitution, 0.4)
    );
}

#[test]
fn an_initial_velocity_of_a_fixed_base_is_an_error() {
    let found = error(
        &cart(),
        "robot.base = \"fixed\"\ninitial.linear_velocity = [1, 0, 0]",
    );
    assert_eq!(found.code, "A106");
    assert_eq!(found.place.map(|p| p.line), Some(2));
}

#[test]
fn what_was_built_can_be_simulated() {
    use crate::simulation::Simulation;
    use std::sync::Arc;
    let all = cart()
        .with("chassis", "p", Planar, at(0.0, 0.0, 1.0), mass("puck", 1.0))
        .with("puck", "f", Floating, at(0.0, 0.0, 1.0), body("drone", 1.0))
        .with(
            "drone",
            "m",
            Revolute,
            at(0.0, 0.0, 0.1),
            mass("rotor", 0.1),
        )
        .mimicking("left", 2.0, 0.1)
        .and(|j| j.limits = None);
    let mut simulation = Simulation::new(Arc::new(model(&all, "")));
    simulation.initialize(0.0).expect("a legal start");
    simulation.advance_to(0.05).expect("finite");
}

#[test]
fn surfaces_take_their_friction_at_rest_and_against_turning_from_the_settings() {
    let settings = "[link.\"*_wheel\"]\nfriction = 0.5\nstatic_friction = 0.6\n\
                    rolling_friction = 2e-3\ntorsional_friction = 1e-3\n";
    let model = model(&cart(), settings);
    let wheel = model.links.iter().find(|l| l.name == "left_wheel");
    let wheel = wheel.expect("the wheel");
    // 0.6/0.5 − 1.
    assert!(close(wheel.static_excess, 0.2));
    assert!(close(wheel.rolling_friction, 2e-3) && close(wheel.torsional_friction, 1e-3));
    let chassis = &model.links[0];
    assert!(close(chassis.static_excess, 0.0) && close(chassis.rolling_friction, 0.0));
    let low = "[link.chassis]\nstatic_friction = 0.3\n";
    let refused = error(&cart(), low);
    assert_eq!(refused.code, "A125");
    assert!(refused.place.is_some());
}

#[test]
fn joints_and_motors_take_their_laws_from_the_settings() {
    let settings = "[joint.left]\nfriction = 0.2\nstatic_friction = 0.3\nstribeck_velocity = 0.05\n\
                    enforce_velocity = true\n[[actuator]]\njoint = \"left\"\nno_load_speed = 30\n";
    let assembled = assembled(&cart(), settings);
    let left = &assembled.model.joints[0];
    // 0.3/0.2 − 1.
    assert!(close(left.static_excess, 0.5) && close(left.stribeck_velocity, 0.05));
    assert!(left.enforce_velocity && !assembled.model.joints[1].enforce_velocity);
    let speeds: Vec<_> = assembled
        .model
        .actuators
        .iter()
        .map(|a| a.no_load_speed)
        .collect();
    assert_eq!(speeds, [Some(30.0), None]);
    // The other wheel has a velocity limit in the file and no position servo.
    let unbound = note(&assembled, "A124");
    assert!(unbound.message.contains("1 joint") && unbound.message.contains("'right'"));
    assert_eq!(
        error(&cart(), "[joint.left]\nstatic_friction = 0.3\n").code,
        "A125"
    );
}

#[test]
fn a_group_is_told_once_for_all_and_each_joint_obeys() {
    use crate::model::ActuatorId;
    use crate::simulation::{InputSlot, OutputSlot, Simulation};
    use std::sync::Arc;
    let settings =
        "robot.base = \"fixed\"\n[[group]]\nname = \"drive\"\njoints = [\"left\", \"right\"]\n";
    let built = assembled(&cart(), settings);
    assert_eq!(built.model.outputs.groups.len(), 1);
    let mut s = Simulation::new(Arc::new(built.model));
    s.initialize(0.0).expect("a legal start");
    // The table shows the first one's input alone; either sets both.
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 2.0);
    assert!(close(s.input(InputSlot::Velocity(ActuatorId(1))), 2.0));
    s.advance_to(1.0).expect("finite");
    for j in 0..2 {
        let rate = s.output(OutputSlot::JointVelocity(JointId(j), 0));
        assert!((rate - 2.0).abs() < 1e-3, "{rate}");
    }
}

#[test]
fn groups_that_cannot_share_a_command_are_errors_with_their_place() {
    let group =
        |name: &str, joints: &str| format!("[[group]]\nname = \"{name}\"\njoints = [{joints}]\n");
    let lifted = || {
        cart()
            .with(
                "chassis",
                "lift",
                Prismatic,
                at(0.0, 0.0, 0.0),
                mass("fork", 1.0),
            )
            .with(
                "chassis",
                "pan",
                Revolute,
                at(0.0, 0.0, 0.0),
                mass("eye", 1.0),
            )
            .with(
                "chassis",
                "tilt",
                Revolute,
                at(0.0, 0.0, 0.0),
                mass("ear", 1.0),
            )
    };
    for (settings, part) in [
        (group("left", "\"right\""), "has the name of joint 'left'"),
        (
            group("a", "\"left\"") + &group("a", "\"right\""),
            "second group",
        ),
        (
            group("a", "\"left\"") + &group("b", "\"left\", \"right\""),
            "in group 'a' already",
        ),
        (group("a", "\"left\", \"pan\""), "different commands"),
        (group("a", "\"lift\", \"pan\""), "one turns and one slides"),
        (
            "initial.joints = { pan = 0.5 }\n".to_owned() + &group("a", "\"pan\", \"tilt\""),
            "start at 0.5 and 0",
        ),
    ] {
        let found = error(&lifted(), &settings);
        assert_eq!(found.code, "A130", "{settings}");
        assert!(found.message.contains(part), "{}", found.message);
        assert!(found.place.is_some());
    }
    let found = error(&lifted(), &group("a", "\"lefd\""));
    assert_eq!(found.code, "A101");
    let passive = "[[actuator]]\njoint = \"left\"\nmode = \"none\"\n".to_owned();
    let found = error(&lifted(), &(passive + &group("a", "\"left\"")));
    assert_eq!(found.code, "A102");
    assert!(found.message.contains("not commanded"), "{}", found.message);
}
