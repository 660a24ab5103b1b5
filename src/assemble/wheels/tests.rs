use super::super::testing::*;
use super::*;
use crate::geometry::convex_hull;
use crate::model::{ActuatorId, RootId};
use crate::simulation::{InputSlot, OutputSlot, Simulation};
use crate::urdf::Description;
use std::sync::Arc;

const RADIUS: f64 = 0.12;
const WIDTH: f64 = 0.05;

/// Corners of a prism of `n` facets along z, inscribed in a cylinder.
fn prism(n: u32, radius: f64, width: f64) -> Vec<Vec3> {
    (0..n)
        .flat_map(|i| {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(n));
            [-0.5, 0.5].map(|side| Vec3::new(radius * cos, radius * sin, side * width))
        })
        .collect()
}

/// As mesh files have it: in single precision.
fn mesh(X_LG: Pose, points: &[Vec3]) -> CollisionDescription {
    #[expect(clippy::cast_possible_truncation, reason = "mesh files are in f32")]
    let points: Vec<Vec3> = points
        .iter()
        .map(|p| p.map(|x| f64::from(x as f32)))
        .collect();
    CollisionDescription {
        mesh: Some("wheel.stl".into()),
        outline: Some(points.clone().into()),
        part: false,
        ..collision(
            X_LG,
            Shape::Hull {
                vertices: convex_hull(&points).expect("a hull"),
            },
        )
    }
}

/// A box on four wheels, whose axles (z of the joint) point to the left; `wheel` is in the wheel's
/// frame.
fn cart(kind: JointKind, wheel: &CollisionDescription) -> Description {
    let mut cart = robot(mass("chassis", 5.0));
    for (name, x, y) in [
        ("fl", 0.3, 0.2),
        ("fr", 0.3, -0.2),
        ("rl", -0.3, 0.2),
        ("rr", -0.3, -0.2),
    ] {
        let mut link = mass(&format!("{name}_wheel"), 1.0);
        link.collisions = vec![wheel.clone()];
        let place = Pose::from_xyz_rpy(Vec3::new(x, y, 0.0), Vec3::new(-0.5 * PI, 0.0, 0.0));
        cart = cart.with("chassis", name, kind, place, link);
    }
    cart
}

fn shapes(model: &Model) -> Vec<&Shape> {
    model.colliders.iter().map(|c| &c.shape).collect()
}

#[test]
fn a_wheel_of_many_facets_becomes_the_cylinder_around_it_and_its_error_is_the_sagitta() {
    for n in [12, 32, 100, 500] {
        let wheel = mesh(Pose::IDENTITY, &prism(n, RADIUS, WIDTH));
        let assembled = assembled(&cart(JointKind::Continuous, &wheel), "");
        for shape in shapes(&assembled.model) {
            let Shape::Cylinder {
                radius,
                half_length,
            } = shape
            else {
                panic!("{n}: {shape:?}");
            };
            // f32 has 6e-8 of 0.12 m.
            assert!((radius - RADIUS).abs() < 1e-8 && (half_length - 0.5 * WIDTH).abs() < 1e-8);
        }
        // Two rims each.
        assert_eq!(assembled.model.contact_room(), [4, 8]);
        let told = note(&assembled, "A127").message;
        // A facet of an n-gon lies R (1 − cos π/n) inside the circle.
        let sagitta = RADIUS * (1.0 - libm::cos(PI / f64::from(n)));
        let stated: f64 = told
            .split(" mm (")
            .next()
            .and_then(|head| head.rsplit(' ').next())
            .and_then(|number| number.parse().ok())
            .expect("the largest error");
        assert!((stated - 1e3 * sagitta).abs() < 1e-3, "{told} {sagitta}");
        assert!(
            told.contains("'fl_wheel', 'fr_wheel', 'rl_wheel', 'rr_wheel'"),
            "{told}"
        );
        assert!(!has(&assembled, "A128"));
    }
}

/// Turned and shifted in its link, the mesh is still found to stand on the joint's axis.
#[test]
fn a_wheel_is_fitted_wherever_its_mesh_has_its_own_origin() {
    let X = Pose::from_xyz_rpy(Vec3::new(0.4, -0.3, 0.2), Vec3::new(0.3, 0.2, 0.1));
    let points: Vec<Vec3> = prism(40, RADIUS, WIDTH)
        .iter()
        .map(|p| X.inverse().point(&(p + Vec3::z() * 0.01)))
        .collect();
    let model = model(&cart(JointKind::Continuous, &mesh(X, &points)), "");
    let collider = &model.colliders[0];
    assert!(matches!(collider.shape, Shape::Cylinder { .. }));
    assert!(
        (collider.X_BG.p - Vec3::z() * 0.01).norm() < 1e-7,
        "{}",
        collider.X_BG.p
    );
    // Exactly on the axis: what single precision lost does not make it eccentric.
    assert!(collider.X_BG.p.xy().norm() < 1e-15);
    assert!((collider.X_BG.R.column(2) - Vec3::z()).norm() < 1e-12);
}

#[test]
fn a_ball_becomes_a_sphere() {
    let mut points = Vec::new();
    for i in 0..=16 {
        let (sin, cos) = libm::sincos(PI * f64::from(i) / 16.0);
        points.extend(prism(32, RADIUS * sin, 2.0 * RADIUS * cos));
    }
    let assembled = assembled(
        &cart(JointKind::Continuous, &mesh(Pose::IDENTITY, &points)),
        "",
    );
    for shape in shapes(&assembled.model) {
        let Shape::Sphere { radius } = shape else {
            panic!("{shape:?}");
        };
        assert!((radius - RADIUS).abs() < 1e-8);
    }
    assert!(note(&assembled, "A127").message.contains("sphere"));
}

#[test]
fn blocks_cones_and_parts_beside_the_axis_keep_their_hulls() {
    let cone: Vec<Vec3> = prism(40, RADIUS, WIDTH)
        .iter()
        .map(|p| {
            if p.z > 0.0 {
                Vec3::new(0.2 * p.x, 0.2 * p.y, 2.0 * RADIUS)
            } else {
                *p
            }
        })
        .collect();
    let beside: Vec<Vec3> = prism(40, RADIUS, WIDTH)
        .iter()
        .map(|p| p + Vec3::x() * 0.1)
        .collect();
    let mast: Vec<Vec3> = prism(40, RADIUS, WIDTH)
        .into_iter()
        .chain(prism(40, 0.1 * RADIUS, 10.0 * RADIUS))
        .collect();
    for points in [
        prism(4, RADIUS, WIDTH),
        prism(8, RADIUS, WIDTH),
        cone,
        beside,
        mast,
    ] {
        let wheel = mesh(Pose::IDENTITY, &points);
        let built = assembled(&cart(JointKind::Continuous, &wheel), "");
        assert!(
            shapes(&built.model)
                .iter()
                .all(|s| matches!(s, Shape::Hull { .. }))
        );
        assert!(!has(&built, "A127"));
        // Passive wheels and those of a bolted robot may be what they like.
        let passive = "[[actuator]]\njoint = \"*\"\nmode = \"none\"\n";
        for settings in [
            passive,
            "robot.base = \"fixed\"\n",
            "[link.\"*wheel\"]\nwheel_fit = \"none\"\n",
        ] {
            let quiet = assembled(&cart(JointKind::Continuous, &wheel), settings);
            assert!(!has(&quiet, "A128"), "{settings}");
        }
    }
}

#[test]
fn a_driven_block_causes_a_warning_with_advice() {
    let wheel = mesh(Pose::IDENTITY, &prism(4, RADIUS, WIDTH));
    let built = assembled(&cart(JointKind::Continuous, &wheel), "");
    let warnings: Vec<_> = built
        .diagnostics
        .iter()
        .filter(|d| d.code == "A128")
        .collect();
    assert_eq!(warnings.len(), 4);
    // 1 − cos 45° = 29 %.
    assert!(
        warnings[0].message.contains("29 %"),
        "{}",
        warnings[0].message
    );
    let forced = assembled(
        &cart(JointKind::Continuous, &wheel),
        "[link.\"*wheel\"]\nwheel_fit = \"cylinder\"\n",
    );
    assert!(
        shapes(&forced.model)
            .iter()
            .all(|s| matches!(s, Shape::Cylinder { .. }))
    );
    assert!(has(&forced, "A127") && !has(&forced, "A128"));
}

#[test]
fn an_eccentric_wheel_stays_eccentric() {
    let offset = 0.1 * RADIUS;
    let points: Vec<Vec3> = prism(60, RADIUS, WIDTH)
        .iter()
        .map(|p| p + Vec3::y() * offset)
        .collect();
    let assembled = assembled(
        &cart(JointKind::Continuous, &mesh(Pose::IDENTITY, &points)),
        "",
    );
    let collider = &assembled.model.colliders[0];
    assert!(matches!(collider.shape, Shape::Cylinder { .. }));
    assert!(
        (collider.X_BG.p - Vec3::y() * offset).norm() < 1e-8,
        "{}",
        collider.X_BG.p
    );
    assert!(
        note(&assembled, "A127")
            .message
            .contains("12.00 mm off the axis")
    );
}

#[test]
fn meshes_on_limited_joints_are_fitted_only_when_asked() {
    let wheel = mesh(Pose::IDENTITY, &prism(40, RADIUS, WIDTH));
    let kept = model(&cart(JointKind::Revolute, &wheel), "");
    assert!(
        shapes(&kept)
            .iter()
            .all(|s| matches!(s, Shape::Hull { .. }))
    );
    let asked = model(
        &cart(JointKind::Revolute, &wheel),
        "[link.fl_wheel]\nwheel_fit = \"cylinder\"\n",
    );
    let fitted = shapes(&asked)
        .iter()
        .filter(|s| matches!(s, Shape::Cylinder { .. }))
        .count();
    assert_eq!(fitted, 1);
}

/// The point of it all: the cart drives without a bump, where the polygon bobs by its sagitta.
#[test]
fn a_fitted_wheel_rolls_without_ripple() {
    let wheel = mesh(Pose::IDENTITY, &prism(24, RADIUS, WIDTH));
    let ripple = |settings: &str| {
        let mut s = Simulation::new(Arc::new(model(
            &cart(JointKind::Continuous, &wheel),
            settings,
        )));
        s.set_parameter(crate::simulation::ParameterSlot::Tolerance, 1e-4);
        s.initialize(0.0).expect("a sound model");
        for a in 0..4 {
            s.set_input(InputSlot::Velocity(ActuatorId(a)), 5.0);
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 1..=600 {
            s.advance_to(0.01 * f64::from(i)).expect("finite");
            if i > 300 {
                let z = s.output(OutputSlot::BasePosition(RootId::ROBOT, 2));
                (low, high) = (low.min(z), high.max(z));
            }
        }
        let speed = s.output(OutputSlot::BaseLinearVelocity(RootId::ROBOT, 0));
        assert!(speed > 0.5, "{speed}");
        high - low
    };
    let (fitted, polygon) = (ripple(""), ripple("[link.\"*\"]\nwheel_fit = \"none\"\n"));
    assert!(fitted < 1e-9, "{fitted}");
    assert!(
        polygon > 0.3 * RADIUS * (1.0 - libm::cos(PI / 24.0)),
        "{polygon}"
    );
}
