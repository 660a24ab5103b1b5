//! Shapes on terrain.

use super::worlds::{body, depth, world};
use super::*;
use crate::geometry::field::{Field, Samples};
use crate::geometry::surface::{Surface, Triangles};
use std::sync::Arc;

const G: f64 = 9.81;

/// Heights over a square grid.
pub(super) fn field(extent: f64, cells: usize, height: impl Fn(f64, f64) -> f64) -> Shape {
    let place = |i: usize| (i as f64 / cells as f64 - 0.5) * extent;
    let rows = (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j)));
    let samples = Samples {
        size: [extent; 2],
        counts: [cells + 1; 2],
        heights: rows.map(|(i, j)| height(place(i), place(j))).collect(),
    };
    Shape::Field {
        field: Arc::new(Field::try_from(samples).expect("a grid")),
    }
}

/// Triangles over a square grid.
pub(super) fn grid(extent: f64, cells: usize, height: impl Fn(f64, f64) -> f64) -> Vec<[Vec3; 3]> {
    let place = |i: usize| (i as f64 / cells as f64 - 0.5) * extent;
    let corner = |i, j| Vec3::new(place(i), place(j), height(place(i), place(j)));
    let places = (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j)));
    places
        .flat_map(|(i, j)| {
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

pub(super) fn mesh(triangles: &[[Vec3; 3]]) -> Shape {
    Shape::Surface {
        surface: Arc::new(Surface::try_from(Triangles::new(triangles)).expect("triangles")),
    }
}

/// What does not move, turned by `rpy`.
pub(super) fn ground(shape: Shape, rpy: Vec3) -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    b.shape(LinkId(0), shape, Pose::IDENTITY);
    b.model.roots[0].rpy = rpy;
    b.model
}

/// A body over terrain and nothing else.
pub(super) fn over(terrain: Model, body: Model) -> Model {
    let mut model = world([body, terrain]);
    model.world.ground = None;
    model
}

/// One of each kind, standing or lying, of 1 kg.
pub(super) fn shapes() -> [(&'static str, Shape, Vec3, f64); 7] {
    use std::f64::consts::FRAC_PI_2;
    let (radius, half_length) = (0.05, 0.1);
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(0.05 * sign(1), 0.04 * sign(2), 0.03 * sign(4))
    };
    let lying = Vec3::new(FRAC_PI_2, 0.0, 0.0);
    let flat = Vec3::zeros();
    [
        ("ball", Shape::Sphere { radius }, flat, 0.05),
        (
            "box",
            Shape::Box {
                half: Vec3::new(0.05, 0.04, 0.03),
            },
            flat,
            0.03,
        ),
        (
            "hull",
            Shape::Hull {
                vertices: (0..8).map(corner).collect(),
            },
            flat,
            0.03,
        ),
        (
            "capsule",
            Shape::Capsule {
                radius,
                half_length,
            },
            lying,
            0.05,
        ),
        (
            "standing capsule",
            Shape::Capsule {
                radius,
                half_length,
            },
            flat,
            0.15,
        ),
        (
            "can",
            Shape::Cylinder {
                radius,
                half_length,
            },
            flat,
            0.1,
        ),
        (
            "lying can",
            Shape::Cylinder {
                radius,
                half_length,
            },
            lying,
            0.05,
        ),
    ]
}

#[test]
fn even_terrain_carries_like_the_plane() {
    // The law gives the depth on a plane; a can stands on one of its two rims.
    for (name, shape, rpy, height) in shapes() {
        let expected = if name.ends_with("standing capsule") || name == "can" {
            let share = 0.5_f64.powf(0.25);
            depth_of_share(share)
        } else {
            depth(1.0)
        };
        for terrain in [
            Shape::Plane,
            field(2.0, 50, |_, _| 0.3),
            mesh(&grid(2.0, 10, |_, _| 0.3)),
        ] {
            let lift = if matches!(terrain, Shape::Plane) {
                0.0
            } else {
                0.3
            };
            let mut one = body(1.0, shape.clone(), Vec3::new(0.013, 0.007, lift + height));
            one.roots[0].rpy = rpy;
            let mut s = start(over(ground(terrain, Vec3::zeros()), one), 1e-3);
            run(&mut s, 2.0, 0.01);
            let sunk = lift + height - s.state().physical.q[2];
            assert!(
                (sunk - expected).abs() < 1e-9,
                "{name}: {sunk:e}, {expected:e}"
            );
        }
    }
}

/// Depth of a point of the share `m` under one weight: with `δ = m^¼ d` it pushes with `N m^¼`.
fn depth_of_share(root: f64) -> f64 {
    depth(1.0 / root) / root
}

/// A box of a room: floor z = 0 and two walls x = 0, y = 0, all to the positive side.
fn room() -> Shape {
    let quad = |o: Vec3, u: Vec3, v: Vec3| [[o, o + u, o + u + v], [o, o + u + v, o + v]];
    let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()];
    let o = Vec3::zeros();
    mesh(&[quad(o, x, y), quad(o, y, z), quad(o, z, x)].concat())
}

#[test]
fn walls_and_floor_push_along_their_own_normals() {
    // Leaning gravity presses a body into the corner of a room: each face carries its part. A point
    // that nothing else helps has the depth of the law, whatever carries the rest.
    for (name, shape, half) in [
        ("ball", Shape::Sphere { radius: 0.05 }, Vec3::repeat(0.05)),
        (
            "box",
            Shape::Box {
                half: Vec3::new(0.05, 0.04, 0.03),
            },
            Vec3::new(0.05, 0.04, 0.03),
        ),
    ] {
        let mut one = body(1.0, shape, half * 1.0001);
        one.links[0].friction = 0.0;
        let mut model = over(ground(room(), Vec3::zeros()), one);
        model.world.gravity = Vec3::new(-3.0, -2.0, -G);
        let mut s = start(model, 1e-4);
        run(&mut s, 3.0, 0.01);
        let q = &s.state().physical.q;
        for (axis, force) in [(0, 3.0), (1, 2.0), (2, G)] {
            let (sunk, expected) = (half[axis] - q[axis], depth(force / G));
            assert!(
                (sunk - expected).abs() < 1e-8,
                "{name} {axis}: {sunk:e}, {expected:e}"
            );
        }
    }
}

#[test]
fn a_ball_rolls_off_a_step_and_down_stairs_without_a_failure() {
    let stairs = |x: f64| -0.1 * libm::floor((x + 1.0) / 0.3).clamp(0.0, 6.0);
    let quad = |o: Vec3, u: Vec3, v: Vec3| [[o, o + u, o + u + v], [o, o + u + v, o + v]];
    let mut triangles = Vec::new();
    for i in 0..8 {
        let x = -1.0 + 0.3 * f64::from(i) - 0.3;
        let (z, next) = (stairs(x + 0.1), stairs(x + 0.4));
        let at = |x: f64, z: f64| Vec3::new(x, -1.0, z);
        triangles.extend(quad(at(x, z), Vec3::x() * 0.3, Vec3::y() * 2.0));
        if next < z {
            let down = Vec3::z() * (next - z);
            triangles.extend(quad(at(x + 0.3, z), down, Vec3::y() * 2.0));
        }
    }
    for (shape, rpy) in [
        (Shape::Sphere { radius: 0.1 }, Vec3::zeros()),
        (
            Shape::Cylinder {
                radius: 0.1,
                half_length: 0.1,
            },
            Vec3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0),
        ),
        (
            Shape::Capsule {
                radius: 0.1,
                half_length: 0.1,
            },
            Vec3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0),
        ),
        (
            Shape::Box {
                half: Vec3::repeat(0.05),
            },
            Vec3::zeros(),
        ),
    ] {
        let mut one = body(1.0, shape.clone(), Vec3::new(-1.2, 0.0, 0.1));
        one.roots[0].rpy = rpy;
        one.roots[0].linear_velocity = Vec3::new(1.0, 0.0, 0.0);
        let mut s = start(over(ground(mesh(&triangles), Vec3::zeros()), one), 1e-3);
        for i in 1..=200 {
            let time = 0.01 * f64::from(i);
            run(&mut s, time, 0.01);
            let q = &s.state().physical.q;
            let r = 0.05 - 2e-3;
            assert!(q[0] > 1.0 || q[2] > stairs(q[0]) + r, "{time} {q:?}");
        }
    }
}

#[test]
fn what_rests_without_friction_does_not_fall() {
    // Friction has nothing to remember there, but the ground still carries the body.
    for on_ground in [true, false] {
        let mut one = body(
            1.0,
            Shape::Box {
                half: Vec3::repeat(0.05),
            },
            Vec3::z() * 0.05,
        );
        one.links[0].friction = 0.0;
        let mut model = if on_ground {
            one
        } else {
            over(ground(Shape::Plane, Vec3::zeros()), one)
        };
        if let Some(ground) = &mut model.world.ground {
            ground.friction = 0.0;
        }
        let mut s = start(model, 1e-3);
        run(&mut s, 5.0, 0.01);
        let sunk = 0.05 - s.state().physical.q[2];
        assert!((sunk - depth(1.0)).abs() < 1e-9, "{on_ground}: {sunk:e}");
        assert_eq!(s.state().physical.v, [0.0; 6]);
    }
}

/// A box on a belt takes the belt's speed `v` after `v/(μ g)`, having slipped `v²/(2 μ g)`; it
/// stays still where the belt stands, and is woken by a belt that starts.
#[test]
fn a_box_on_a_conveyor_takes_its_speed_as_coulomb_says() {
    use crate::model::RootId;
    use crate::slots::InputSlot::SurfaceVelocity;
    let (mu, v) = (0.5, 1.0);
    for (turned, fixed_step) in [(0.0, 0.0), (0.6, 0.0), (0.0, 1.0 / 240.0)] {
        let mut one = body(
            1.0,
            Shape::Box {
                half: Vec3::repeat(0.05),
            },
            Vec3::zeros(),
        );
        one.roots[0].position.z = 0.05 - depth(1.0);
        one.links[0].friction = mu;
        let mut belt = ground(Shape::Plane, Vec3::new(0.0, 0.0, turned));
        belt.links[0].friction = mu;
        belt.outputs.conveyors = vec![RootId::from(0)];
        let mut model = over(belt, one);
        model.solver.step_size = fixed_step;
        let mut s = start(model, 1e-5);
        run(&mut s, 1.0, 0.01);
        assert!(s.state().physical.v.iter().all(|v| v.abs() < 1e-12));
        let before = s.state().physical.q[0];
        s.set_input(SurfaceVelocity(RootId::from(1), 0), v);
        let (slip, end): (f64, f64) = (v / (mu * G), 1.0);
        // Along the belt: half of the way of the belt while it slips, all of it after.
        let expected = v * (end - slip) + 0.5 * v * slip;
        let (sin, cos) = libm::sincos(turned);
        for i in 1..=100 {
            let t = 0.01 * f64::from(i);
            run(&mut s, 1.0 + t, 0.01);
            // It takes the speed of the belt after v/(μ g), evenly, having slipped v²/(2 μ g).
            let (q, w) = (&s.state().physical.q, &s.state().physical.v);
            let speed = w[3] * cos + w[4] * sin;
            assert!(
                (speed - v * (t / slip).min(1.0)).abs() < 0.01 * v,
                "{t}: {speed}"
            );
            let slipped = v * t - ((q[0] - before) * cos + q[1] * sin);
            let fall = (slip - t).max(0.0);
            let truth = 0.5 * v * (slip - fall * fall / slip);
            assert!((slipped - truth).abs() < 2e-3 * v, "{t}: {slipped} {truth}");
        }
        let q = &s.state().physical.q;
        let (along, across) = (
            (q[0] - before) * cos + q[1] * sin,
            q[1] * cos - (q[0] - before) * sin,
        );
        assert!((along - expected).abs() < 2e-3 * v, "{along} {expected}");
        assert!(across.abs() < 1e-5, "{across:e}");
        let w = &s.state().physical.v;
        let speed = w[3] * cos + w[4] * sin;
        assert!((speed - v).abs() < 1e-3, "{speed}");
        s.set_input(SurfaceVelocity(RootId::from(1), 0), 0.0);
        run(&mut s, 3.0, 0.01);
        assert!(s.state().physical.v.iter().all(|v| v.abs() < 1e-9));
    }
}

/// A block slides down an inclined plane as Coulomb says, and sticks below the angle of friction.
#[test]
fn a_plane_may_be_inclined() {
    let mu: f64 = 0.5;
    for (degrees, slides) in [(26.0_f64, false), (27.0, true), (40.0, true)] {
        let a = degrees.to_radians();
        let tilt = Vec3::new(0.0, a, 0.0);
        let (sin, cos) = libm::sincos(a);
        let half = Vec3::new(0.1, 0.1, 0.02);
        let up = Vec3::new(sin, 0.0, cos);
        let at = up * (half.z - depth(cos));
        let mut one = body(1.0, Shape::Box { half }, at);
        one.roots[0].rpy = tilt;
        one.links[0].friction = mu;
        let mut slope = ground(Shape::Plane, tilt);
        slope.links[0].friction = mu;
        let mut s = start(over(slope, one), 1e-4);
        run(&mut s, 1.0, 0.01);
        let way = (Vec3::from_column_slice(&s.state().physical.q[..3]) - at).norm();
        let expected = if slides {
            0.5 * G * (sin - mu * cos)
        } else {
            0.0
        };
        // A block that is let go slides up to two millimetres too far, as on the ground: row S11.
        assert!(
            (way - expected).abs() < 2e-3,
            "{degrees}°: {way} {expected}"
        );
    }
}

/// Height of rough ground, m.
fn rough(x: f64, y: f64) -> f64 {
    0.1 * libm::sin(3.0 * x) * libm::cos(4.0 * y + x) + 0.05 * x
}

/// Rough ground of 3 m: heights in even cases, triangles of the same in odd ones.
pub(super) fn rough_ground(case: usize) -> Shape {
    if case.is_multiple_of(2) {
        field(3.0, 60, rough)
    } else {
        mesh(&grid(3.0, 20, rough))
    }
}

/// Random bodies dropped on rough heights and on the triangles of the same: nothing falls through,
/// nothing fails, nothing gains energy.
#[test]
fn what_falls_on_rough_ground_stays_on_it() {
    let mut random = Random(71);
    for case in 0..24 {
        let (_, shape, ..) = shapes()[case % 7].clone();
        let terrain = rough_ground(case);
        let at = random.vector(0.3) + Vec3::z() * 0.7;
        let mut one = body(1.0, shape.clone(), at);
        one.roots[0].rpy = random.vector(3.0);
        one.roots[0].angular_velocity = random.vector(3.0);
        let mut s = start(over(ground(terrain, Vec3::zeros()), one), 1e-3);
        let (_, _, begin) = super::worlds::books(&s);
        let mut most = f64::NEG_INFINITY;
        for i in 1..=400 {
            run(&mut s, 0.01 * f64::from(i), 0.01);
            let (_, _, energy) = super::worlds::books(&s);
            most = most.max(energy - begin);
            let q = &s.state().physical.q;
            let inside = q[0].abs().max(q[1].abs()) < 1.45;
            assert!(
                !inside || q[2] > rough(q[0], q[1]),
                "{case} {shape:?} {q:?}"
            );
        }
        assert!(most < 1e-3, "{case}: {most:e}");
    }
}

/// On heights and on triangles, against a wall, on a belt: saved and restored, with NaN in all
/// scratch, in smooth steps and fixed ones.
#[test]
fn restored_terrain_continues_with_the_same_bits() {
    use crate::model::RootId;
    use crate::simulation::Snapshot;
    use crate::slots::InputSlot::SurfaceVelocity;
    let rough = |x: f64, y: f64| 0.05 * libm::sin(5.0 * x) * libm::cos(4.0 * y);
    for (terrain, step) in [
        (field(2.0, 40, rough), 0.0),
        (mesh(&grid(2.0, 20, rough)), 0.0),
        (mesh(&grid(2.0, 20, rough)), 1e-3),
        (room(), 0.0),
    ] {
        for (name, shape, rpy, _) in shapes() {
            let mut one = body(1.0, shape, Vec3::new(0.25, 0.2, 0.3));
            one.roots[0].rpy = rpy + Vec3::new(0.2, 0.1, 0.0);
            one.roots[0].linear_velocity = Vec3::new(-0.8, -0.6, 0.0);
            let mut belt = ground(terrain.clone(), Vec3::zeros());
            belt.outputs.conveyors = vec![RootId::from(0)];
            let mut model = over(belt, one);
            model.solver.step_size = step;
            let mut s = start(model.clone(), 1e-3);
            s.set_input(SurfaceVelocity(RootId::from(1), 0), 0.1);
            run(&mut s, 0.4, 0.01);
            let bytes = s.save().to_bytes();
            let mut other = start(model, 1e-3);
            let read = Snapshot::from_bytes(other.model(), &bytes).expect("own bytes");
            other.restore(&read).expect("same model");
            other.spoil();
            run(&mut s, 0.6, 0.01);
            run(&mut other, 0.6, 0.01);
            assert_eq!(other.state(), s.state(), "{name}");
        }
    }
}

/// A wheel that falls over on rough heights takes about as many steps as on the same heights as a
/// mesh, 400 in 1.25 s. With a point at the lowest place of the rim, against the ground nearest to
/// the middle of that, such wheels took 6,700 and more in fixed steps.
#[test]
fn a_wheel_that_falls_over_on_rough_heights_takes_few_steps() {
    let mut random = Random(5);
    let rough: Vec<f64> = (0..1681).map(|_| random.uniform(-0.035, 0.035)).collect();
    let index = |x: f64| (5.0 * (x + 4.0)).round() as usize;
    let waves = |x: f64, y: f64| 0.15 * libm::sin(1.3 * x) * libm::cos(1.1 * y);
    let height = |x: f64, y: f64| waves(x, y) + rough[41 * index(y) + index(x)];
    let wheel = Shape::Cylinder {
        radius: 0.15,
        half_length: 0.04,
    };
    for case in 0..4 {
        let mut uniform = |most: f64| random.uniform(-most, most);
        let place = Vec3::new(uniform(2.0), uniform(2.0), 0.5);
        let mut one = body(1.0, wheel.clone(), place);
        one.roots[0].rpy = Vec3::new(uniform(3.0), uniform(3.0), uniform(3.0));
        one.roots[0].linear_velocity = Vec3::new(uniform(1.0), uniform(1.0), 0.0);
        one.roots[0].angular_velocity = Vec3::new(uniform(6.0), uniform(6.0), uniform(6.0));
        let terrain = field(8.0, 40, height);
        let mut s = start(over(ground(terrain, Vec3::zeros()), one), 1e-3);
        run(&mut s, 1.25, 1.0 / 240.0);
        let counters = s.state().stepping.counters;
        let tries = counters.steps + counters.rejected;
        assert!(tries < 700, "case {case}: {counters:?}");
    }
}
