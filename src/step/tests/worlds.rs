//! Several trees in one world: what bodies do to each other.

use super::*;
use crate::dynamics::energy;
use crate::kinematics::Kinematics;
use crate::model::RootKind;
use crate::simulation::Snapshot;
use crate::spatial::rotation_from_quaternion;

const G: f64 = 9.81;

/// A body of one shape on a floating base, its middle at `at`; it stands on a ground.
pub(super) fn body(mass: f64, shape: Shape, at: Vec3) -> Model {
    let i = match &shape {
        Shape::Sphere { radius } => [0.4 * mass * radius * radius; 3],
        Shape::Box { half } => {
            [half.yz(), half.xz(), half.xy()].map(|h| mass / 3.0 * h.norm_squared())
        }
        Shape::Cylinder {
            radius,
            half_length,
        } => {
            let (r, h) = (radius * radius, half_length * half_length);
            let across = mass * (0.25 * r + h / 3.0);
            [across, across, 0.5 * mass * r]
        }
        _ => [0.01 * mass; 3],
    };
    let mut b = Builder::new(true, inertia(mass, Vec3::zeros(), i));
    b.shape(LinkId(0), shape, Pose::IDENTITY);
    b.model.roots[0].position = at;
    b.model
}

pub(super) fn cube(mass: f64, at: Vec3) -> Model {
    let half = Vec3::repeat(0.05);
    body(mass, Shape::Box { half }, at)
}

/// A box of 40 by 40 by 20 cm that does not move, its top at z = 1.
pub(super) fn table() -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let half = Vec3::new(0.2, 0.2, 0.1);
    b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
    b.model.roots[0].position.z = 0.9;
    b.model
}

/// All in one world, the first one as the robot.
pub(super) fn world(models: impl IntoIterator<Item = Model>) -> Model {
    let mut models = models.into_iter();
    let mut all = models.next().expect("one");
    for (i, model) in models.enumerate() {
        all.join(model, &format!("other{i}"), RootKind::Object);
    }
    all.validate().expect("valid");
    all
}

/// Angular and linear speed of each body, rad/s and m/s, where all are free.
pub(super) fn speeds(s: &Simulation) -> Vec<[f64; 2]> {
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let bodies = s.state().physical.v.chunks(6);
    bodies.map(|v| [norm(&v[..3]), norm(&v[3..])]).collect()
}

/// Momentum about the world's origin, angular and linear, and energy but that of springs.
pub(super) fn books(s: &Simulation) -> (Vec3, Vec3, f64) {
    let (tree, state) = (s.tree(), &s.state().physical);
    let mut kin = Kinematics::new(tree);
    kin.update_poses(tree, &state.q);
    kin.update_velocities(tree, &state.v);
    let (mut angular, mut linear) = (Vec3::zeros(), Vec3::zeros());
    for (part, origin) in tree.trees.iter().zip(&kin.origins) {
        let P = energy::momentum(&kin, part.bodies.clone());
        let p = Vec3::new(P[3], P[4], P[5]);
        linear += p;
        angular += Vec3::new(P[0], P[1], P[2]) + origin.cross(&p);
    }
    let held = energy::kinetic(tree, &kin, &state.v) + energy::potential(tree, &kin);
    (angular, linear, held)
}

/// Depth at which the law of contacts, `N = K δ (1 + (δ/δ₁)³)` with `K (δ₁/2)(1 + 1/8) = W` and
/// from `30 δ₁` on its tangent, carries so many weights `W`, m; `δ₁` = 0.1 mm.
pub(super) fn depth(weights: f64) -> f64 {
    let (last, most) = (30.0, 30.0 * (1.0 + 27000.0));
    if 0.5625 * weights > most {
        return (last + (0.5625 * weights - most) / (1.0 + 4.0 * 27000.0)) * 1e-4;
    }
    let (mut low, mut high) = (0.0, weights);
    for _ in 0..100 {
        let x: f64 = 0.5 * (low + high);
        if x * (1.0 + x * x * x) < 0.5625 * weights {
            low = x;
        } else {
            high = x;
        }
    }
    low * 1e-4
}

pub(super) fn speed(s: &Simulation) -> f64 {
    s.state().physical.v.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// However three cubes lie on each other, each interface is as deep as the weights on it say, and
/// nothing moves in an hour.
#[test]
fn a_stack_stands_for_an_hour_at_the_depths_of_the_law() {
    for (shift, turn, tolerance) in [
        (0.0, 0.0, 1e-3),
        (0.0, 0.4, 1e-3),
        (0.1, 0.3, 1e-3),
        (0.1, 0.3, 1e-5),
    ] {
        let mut cubes = [0.0, 1.0, 2.0].map(|i| {
            let side = shift * 0.1 * i * i / 4.0;
            cube(1.0, Vec3::new(side, 0.5 * side, 0.05 + 0.1 * i))
        });
        for (i, cube) in cubes.iter_mut().enumerate() {
            cube.roots[0].rpy.z = [0.0, turn, -0.7 * turn][i];
        }
        let mut s = start(world(cubes), tolerance);
        // What lies askew creeps by parts of a nanometre for another second.
        let settled = if shift > 0.0 { 5.0 } else { 1.0 };
        s.advance_to(settled).expect("finite");
        let rest = s.state().physical.q.clone();
        // Tilted by an uneven load, a cube's middle is not quite as deep.
        let close = if shift > 0.0 { 5e-6 } else { 1e-9 };
        let mut top = 0.0;
        for i in 0..3_u8 {
            let z = top + 0.05 - depth(f64::from(3 - i));
            let found = rest[7 * usize::from(i) + 2];
            assert!(
                (found - z).abs() < close,
                "{shift} {turn} cube {i}: {found} {z}"
            );
            top = found + 0.05;
        }
        run(&mut s, 3600.0, 10.0);
        assert_eq!(s.state().physical.q, rest, "{shift} {turn} {tolerance}");
        assert!(speed(&s) <= 0.0);
    }
}

/// A box as wide as the table lies on it, turned by 45°: they have eight corners in common, and it
/// is as deep as one of four.
#[test]
fn a_box_is_as_deep_with_eight_corners_as_with_four() {
    for yaw in [0.0, std::f64::consts::FRAC_PI_4] {
        let half = Vec3::new(0.2, 0.2, 0.05);
        let mut board = body(1.0, Shape::Box { half }, Vec3::new(0.0, 0.0, 1.05));
        board.roots[0].rpy.z = yaw;
        let mut s = start(world([table(), board]), 1e-3);
        s.advance_to(2.0).expect("finite");
        let sunk = 1.05 - s.state().physical.q[2];
        assert!((sunk - depth(1.0)).abs() < 1e-9, "{yaw}: {sunk}");
        assert!(speed(&s) <= 0.0);
    }
}

/// A flat face, a line, a ball: half of the penetration, as on the plane.
#[test]
fn shapes_are_as_deep_in_a_table_as_in_the_ground() {
    let lying = std::f64::consts::FRAC_PI_2;
    let (radius, half_length) = (0.03, 0.06);
    let shapes = [
        (Shape::Sphere { radius }, radius, 0.0, depth(1.0)),
        (
            Shape::Capsule {
                radius,
                half_length,
            },
            radius,
            lying,
            depth(1.0),
        ),
        (
            Shape::Cylinder {
                radius,
                half_length,
            },
            radius,
            lying,
            depth(1.0),
        ),
        (
            Shape::Box {
                half: Vec3::repeat(0.05),
            },
            0.05,
            0.0,
            depth(1.0),
        ),
        // One of two rims: δ = d ½^¼, and it carries Σ N w = N ½^¼.
        (
            Shape::Cylinder {
                radius,
                half_length,
            },
            half_length,
            0.0,
            {
                let root = libm::pow(0.5, 0.25);
                depth(1.0 / root) / root
            },
        ),
    ];
    for (shape, height, pitch, expected) in shapes {
        for tolerance in [1e-3, 1e-5] {
            let at = Vec3::new(0.013, 0.021, 1.0 + height);
            let mut model = body(1.0, shape.clone(), at);
            (model.roots[0].rpy.y, model.roots[0].rpy.z) = (pitch, 0.3);
            let mut s = start(world([table(), model]), tolerance);
            s.advance_to(3.0).expect("finite");
            let sunk = at.z - s.state().physical.q[2];
            assert!(
                (sunk - expected).abs() < 1e-9,
                "{shape:?} {tolerance}: {sunk} {expected}"
            );
            assert!(speed(&s) <= 0.0);
        }
    }
}

/// A cube on a tilted table: friction holds it for ever below atan μ, and lets it slide with
/// g (sin θ − μ cos θ) above.
#[test]
fn a_cube_on_a_tilted_table_sticks_below_the_cone_and_slides_above() {
    let mu: f64 = 0.5;
    for (share, tolerance) in [(0.98, 1e-3), (1.1, 1e-4)] {
        let tilt = libm::atan(share * mu);
        let up = Vec3::new(libm::sin(tilt), 0.0, libm::cos(tilt));
        let mut board = table();
        board.roots[0].rpy.y = tilt;
        // A cube that lies on the middle of the table's top, at rest, at its depth.
        let top = Vec3::new(0.0, 0.0, 0.9) + up * (0.1 + 0.05 - depth(libm::cos(tilt)));
        let mut block = cube(1.0, top);
        block.roots[0].rpy.y = tilt;
        let mut model = world([board, block]);
        for link in &mut model.links {
            link.friction = mu;
        }
        let mut s = start(model, tolerance);
        let place = |s: &Simulation| Vec3::from_row_slice(&s.state().physical.q[..3]);
        let begin = place(&s);
        if share < 1.0 {
            s.advance_to(0.3).expect("finite");
            let way = (place(&s) - begin).norm();
            // Its load moves downhill, and it tilts by some depths.
            assert!(way < 2e-4, "{way}");
            s.advance_to(1.0).expect("finite");
            let rest = place(&s);
            run(&mut s, 600.0, 1.0);
            assert_eq!(place(&s), rest);
        } else {
            let speeds = [0.1, 0.3].map(|t| {
                s.advance_to(t).expect("finite");
                Vec3::from_row_slice(&s.state().physical.v[3..6]).norm()
            });
            let found = (speeds[1] - speeds[0]) / 0.2;
            let expected = G * (libm::sin(tilt) - mu * libm::cos(tilt));
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        }
    }
}

/// What a link feels the other one feels reversed, as outputs say.
#[test]
fn the_contact_forces_of_two_links_are_opposite() {
    let mut s = start(
        world([table(), cube(2.0, Vec3::new(0.05, 0.0, 1.05))]),
        1e-3,
    );
    run(&mut s, 2.0, 0.01);
    let mut force = |link: u32| {
        Vec3::from_fn(|i, _| {
            let axis = u8::try_from(i).expect("three");
            s.output(OutputSlot::ContactForce(LinkId(link), axis))
        })
    };
    let (below, above) = (force(0), force(1));
    assert_eq!(below, -above);
    assert!(
        (above - Vec3::new(0.0, 0.0, 2.0 * G)).norm() < 1e-6,
        "{above}"
    );
}

/// Two fingers press a cube with 10 N each, lift it and hold it: it does not creep.
#[test]
fn a_cube_between_two_fingers_is_lifted_and_held() {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let lift = b.link(
        LinkId(0),
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::z()),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
    let half = Vec3::new(0.01, 0.03, 0.03);
    let mut actuators = vec![lift];
    for side in [-1.0, 1.0] {
        let finger = b.link(
            lift,
            at(side * 0.061, 0.0, 0.0),
            Motion::Prismatic(Vec3::x()),
            inertia(0.1, Vec3::zeros(), [1e-4; 3]),
        );
        b.shape(finger, Shape::Box { half }, Pose::IDENTITY);
        actuators.push(finger);
    }
    // It lifts 1.7 kg: faster than at 3 m/s² it would leave the cube behind.
    b.actuator(actuators[0], ActuatorMode::Position, 22.0);
    b.actuator(actuators[1], ActuatorMode::Effort, 20.0);
    b.actuator(actuators[2], ActuatorMode::Effort, 20.0);
    b.model.roots[0].position.z = 0.05;
    let mut s = start(world([b.model, cube(0.5, Vec3::new(0.0, 0.0, 0.05))]), 1e-3);
    s.set_input(InputSlot::Effort(ActuatorId(1)), 10.0);
    s.set_input(InputSlot::Effort(ActuatorId(2)), -10.0);
    run(&mut s, 0.5, 0.01);
    s.set_input(InputSlot::Position(ActuatorId(0)), 0.1);
    run(&mut s, 3.0, 0.01);
    // Seen from the fingers; the servo gives way by up to a millimetre.
    let height = |s: &Simulation| s.state().physical.q[3 + 2] - s.state().physical.q[0];
    let lifted = height(&s);
    assert!(s.state().physical.q[0] > 0.099);
    assert!((lifted - 0.05).abs() < 1e-4, "{lifted}");
    run(&mut s, 63.0, 0.1);
    let crept = (height(&s) - lifted).abs();
    assert!(crept <= 0.0, "{crept:e}");
}

/// Two slides of a robot that floats in space press their pads on each other with the motors'
/// 10 N: the pads feel these, and the robot as a whole stays where it is.
#[test]
fn links_of_one_robot_press_each_other_with_their_motors_force() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.01; 3]));
    let half = Vec3::new(0.01, 0.03, 0.03);
    for (side, turn) in [(-1.0, 0.0), (1.0, 0.3)] {
        let slide = b.link(
            LinkId(0),
            at(side * 0.05, 0.0, 0.1),
            Motion::Prismatic(Vec3::x()),
            inertia(0.2, Vec3::zeros(), [1e-4; 3]),
        );
        let R = crate::spatial::rotation_from_rpy(&Vec3::new(turn, 0.0, 0.0));
        let p = Vec3::zeros();
        b.shape(slide, Shape::Box { half }, Pose { R, p });
        b.actuator(slide, ActuatorMode::Effort, 20.0);
    }
    b.model.world.gravity = Vec3::zeros();
    b.model.world.ground = None;
    for self_collision in [true, false] {
        let mut model = b.model.clone();
        model.roots[0].self_collision = self_collision;
        // At rest, forces balance to 3e-4 of the tolerance.
        let mut s = start(model, 1e-4);
        s.set_input(InputSlot::Effort(ActuatorId(0)), 10.0);
        s.set_input(InputSlot::Effort(ActuatorId(1)), -10.0);
        run(&mut s, 0.5, 0.01);
        let force = s.output(OutputSlot::ContactForce(LinkId(1), 0));
        let opposite = s.output(OutputSlot::ContactForce(LinkId(2), 0));
        if self_collision {
            assert!(
                (force + 10.0).abs() < 1e-6 && (force + opposite).abs() <= 0.0,
                "{force} {opposite}"
            );
            assert!(speed(&s) <= 0.0);
            let moved = Vec3::from_row_slice(&s.state().physical.q[..3]).norm();
            assert!(moved < 1e-6, "{moved}");
        } else {
            assert!(force.abs() <= 0.0 && speed(&s) > 1.0);
        }
    }
}

/// Nothing but the state is remembered from step to step, with contacts between bodies, too.
#[test]
fn a_restored_world_goes_on_with_the_same_bits() {
    for (tolerance, step) in [(1e-3, 0.0), (1e-5, 0.0), (1e-3, 1.0 / 240.0)] {
        let mut cubes = [0.06, 0.18, 0.31].map(|z| cube(1.0, Vec3::new(0.1 * z, 0.0, z)));
        for cube in &mut cubes {
            cube.roots[0].rpy = Vec3::new(0.1, 0.2, 0.3);
        }
        let mut model = world(cubes);
        model.solver.step_size = step;
        let mut s = start(model.clone(), tolerance);
        run(&mut s, 0.25, 0.01);
        let bytes = s.save().to_bytes();
        let mut other = start(model, tolerance);
        let saved = Snapshot::from_bytes(other.model(), &bytes).expect("own bytes");
        other.restore(&saved).expect("own state");
        other.spoil();
        for simulation in [&mut s, &mut other] {
            run(simulation, 0.6, 0.01);
        }
        assert_eq!(s.state(), other.state());
        let q = &s.state().physical.q;
        assert!(rotation_from_quaternion(&[q[3], q[4], q[5], q[6]]).trace() > 2.9);
    }
}

/// A peg that falls askew into a square hole, with 0.5 mm of play, stands still in half a second:
/// walls a hundredth of a millimetre away do not stir it. One that it leans on may carry a
/// thousandth of its weight by friction.
#[test]
fn a_peg_in_a_hole_comes_to_rest() {
    let mut models = Vec::new();
    for i in 0..4 {
        let angle = f64::from(i) * std::f64::consts::FRAC_PI_2;
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let half = Vec3::new(0.01, 0.05, 0.05);
        b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
        let side = Vec3::new(libm::cos(angle), libm::sin(angle), 0.0);
        b.model.roots[0].position = side * 0.03025 + Vec3::new(0.0, 0.0, 0.05);
        b.model.roots[0].rpy.z = angle;
        b.model.links[0].friction = 0.2;
        models.push(b.model);
    }
    let half = Vec3::new(0.02, 0.02, 0.06);
    let mut peg = body(0.5, Shape::Box { half }, Vec3::new(1e-4, 1e-4, 0.14));
    peg.links[0].friction = 0.2;
    peg.roots[0].linear_velocity = Vec3::new(0.1, 0.05, 0.0);
    peg.roots[0].angular_velocity = Vec3::new(0.2, -0.3, 0.5);
    models.push(peg);
    let mut all = world(models);
    all.world.ground = Some(crate::model::Ground {
        friction: 0.2,
        ..Default::default()
    });
    for tolerance in [1e-3, 1e-4] {
        let mut s = start(all.clone(), tolerance);
        run(&mut s, 1.0, 1.0 / 240.0);
        assert!(speed(&s) <= 0.0, "{tolerance}: {:?}", s.state().physical.v);
        let sunk = 0.06 - s.state().physical.q[2];
        assert!(
            (sunk / depth(1.0) - 1.0).abs() < 1e-3,
            "{tolerance}: {sunk}"
        );
    }
}
