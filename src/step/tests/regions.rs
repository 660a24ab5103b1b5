//! What moves over terrain: waves, and regions that have surfaces of their own.

use super::loops::energy;
use super::terrain::{field, grid, ground, mesh, over};
use super::worlds::{body, depth, world};
use super::*;
use crate::geometry::field::{Field, Samples};
use crate::testing::Random;
use std::sync::Arc;

/// Farthest that what rolls over waves of heights for 3 s is from the rigid body that rolls there,
/// m.
///
/// The path of the centre is the curve at the distance R from the surface. What rolls has the
/// kinetic energy `c m v²`, so `v² = v₀² − (g/c)(z − z₀)`.
///
/// - `c`: 0.7 of a ball, 0.75 of a cylinder
fn off_the_waves(shape: &Shape, c: f64, [penetration, tolerance, step]: [f64; 3]) -> f64 {
    let (a, k, R) = (0.03, std::f64::consts::TAU, 0.1);
    let surface = move |x: f64| a * libm::cos(k * x);
    let slope = move |x: f64| -a * k * libm::sin(k * x);
    let center = move |x: f64| {
        let c = 1.0 / (1.0 + slope(x) * slope(x)).sqrt();
        (x - R * slope(x) * c, surface(x) + R * c)
    };
    let mut one = body(1.0, shape.clone(), Vec3::zeros());
    if matches!(shape, Shape::Cylinder { .. }) {
        one.roots[0].rpy.x = -std::f64::consts::FRAC_PI_2;
    }
    // It begins on a crest, as deep as the load there asks: that is less than the weight, as its
    // centre goes round with the curvature κ/(1 + R κ).
    let (start_at, v0, bend) = (center(-2.0), 1.0, a * k * k);
    let load = 1.0 - v0 * v0 * bend / (1.0 + R * bend) / G;
    let deep = depth(load) * penetration / 1e-4;
    one.roots[0].position = Vec3::new(start_at.0, 0.0, start_at.1 - deep);
    one.roots[0].linear_velocity = Vec3::new(v0, 0.0, 0.0);
    one.roots[0].angular_velocity = Vec3::new(0.0, v0 / R, 0.0);
    // Samples are 5 mm apart: the curvature of the surface jumps at each, and what yields more
    // feels it more.
    let counts = [1601, 81];
    let place = |i: usize| (i as f64 / 1600.0 - 0.5) * 8.0;
    let rows = (0..counts[1]).flat_map(|_| (0..counts[0]).map(place));
    let samples = Samples {
        size: [8.0, 0.4],
        counts,
        heights: rows.map(surface).collect(),
    };
    let terrain = Shape::Field {
        field: Arc::new(Field::try_from(samples).expect("a grid")),
    };
    let mut model = over(ground(terrain, Vec3::zeros()), one);
    model.contact.penetration = penetration;
    model.solver.step_size = step;
    let mut s = start(model, tolerance);
    let (mut x, mut time, mut worst) = (-2.0, 0.0, 0.0_f64);
    let n = 30_000;
    let dt = 3.0 / f64::from(n);
    for i in 1..=n {
        // Time to the next place of the contact, by the midpoint rule.
        let speed = |x: f64| {
            let d = 1e-6;
            let (p, q) = (center(x - d), center(x + d));
            let way = libm::hypot(q.0 - p.0, q.1 - p.1) / (2.0 * d);
            let v2 = v0 * v0 - G / c * (center(x).1 - start_at.1);
            v2.sqrt() / way
        };
        let middle = x + 0.5 * dt * speed(x);
        x += dt * speed(middle);
        time += dt;
        if i % 1500 == 0 {
            run(&mut s, time, 0.01);
            let q = &s.state().physical.q;
            let c = center(x);
            worst = worst.max(libm::hypot(q[0] - c.0, q[2] - c.1));
        }
    }
    worst
}

/// The contact yields by the penetration, and what rolls goes round by the radius that is left. So
/// a ball is 3.0e-4 m off after 3 m with the default of 0.1 mm, at any tolerance; 1.5e-5 m with
/// 0.01 mm, and 8e-7 m with 0.001 mm at 1e-6: in proportion to what it yields by.
#[test]
fn a_ball_and_a_wheel_roll_over_waves_as_the_equation_of_one_freedom_says() {
    let radius = 0.1;
    let half_length = 0.03;
    for (name, shape, c) in [
        ("ball", Shape::Sphere { radius }, 0.7),
        (
            "wheel",
            Shape::Cylinder {
                radius,
                half_length,
            },
            0.75,
        ),
    ] {
        for (ways, most) in [
            ([1e-4, 1e-3, 0.0], 4e-4),
            ([1e-4, 1e-5, 0.0], 4e-4),
            ([1e-5, 1e-5, 0.0], 5e-5),
            ([1e-5, 1e-3, 1.0 / 240.0], 5e-5),
            ([1e-6, 1e-6, 0.0], 5e-6),
        ] {
            let off = off_the_waves(&shape, c, ways);
            assert!(off < most, "{name} {ways:?}: {off:e}");
        }
    }
}

/// Two regions side by side, of heights and of triangles: on each, a box stops after `v²/(2 μ g)`
/// by the friction of its own (Coulomb), and a ball bounces to `e² h` by its own restitution
/// (Newton).
#[test]
fn regions_have_friction_and_restitution_of_their_own() {
    let surfaces = [(0.2, 0.9), (0.7, 0.4)];
    for even in [field(4.0, 8, |_, _| 0.0), mesh(&grid(4.0, 8, |_, _| 0.0))] {
        let side = |i: usize| if i == 0 { -2.0 } else { 2.0 };
        let regions = surfaces.iter().enumerate().map(|(i, (mu, e))| {
            let mut region = ground(even.clone(), Vec3::zeros());
            region.roots[0].position.y = side(i);
            region.links[0].friction = *mu;
            region.links[0].restitution = *e;
            region
        });
        let half = Vec3::new(0.1, 0.1, 0.02);
        let boxes = surfaces.iter().enumerate().map(|(i, (mu, _))| {
            let at = Vec3::new(-1.5, side(i), half.z - depth(1.0));
            let mut one = body(1.0, Shape::Box { half }, at);
            one.roots[0].linear_velocity.x = 1.5;
            one.links[0].friction = *mu;
            one
        });
        let (radius, fall) = (0.05, 0.5);
        let balls = (0..2).map(|i| {
            let at = Vec3::new(0.0, side(i) + 1.0, radius + fall);
            body(1.0, Shape::Sphere { radius }, at)
        });
        let mut model = world(boxes.chain(balls).chain(regions));
        model.world.ground = None;
        let mut s = start(model, 1e-4);
        let mut highest = [0.0_f64; 2];
        let lands = (2.0 * fall / G).sqrt();
        for k in 1..=400 {
            let t = 0.0025 * f64::from(k);
            s.advance_to(t).expect("a step");
            for (i, highest) in highest.iter_mut().enumerate() {
                let z = s.state().physical.q[7 * (2 + i) + 2] - radius;
                // Until it comes back.
                if t > lands && t < lands * (1.0 + 2.0 * surfaces[i].1) {
                    *highest = highest.max(z);
                }
            }
        }
        run(&mut s, 2.0, 0.01);
        for (i, (mu, e)) in surfaces.into_iter().enumerate() {
            let slid = s.state().physical.q[7 * i] + 1.5;
            let way = 1.5 * 1.5 / (2.0 * mu * G);
            assert!((slid - way).abs() < 2e-3, "{mu}: {slid} {way}");
            let apex = e * e * fall;
            assert!(
                (highest[i] - apex).abs() < 0.01 * apex,
                "{e}: {} {apex}",
                highest[i]
            );
        }
    }
}

/// Triangles of a profile in x and z, as wide as twice `half` along y.
fn along(profile: &[[f64; 2]], half: f64) -> Vec<[Vec3; 3]> {
    let sides = profile.windows(2).map(|two| {
        let corner = |[x, z]: [f64; 2], y: f64| Vec3::new(x, y, z);
        [(0, -half), (1, -half), (1, half), (0, half)].map(|(end, y)| corner(two[end], y))
    });
    sides
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect()
}

/// What bounces in a groove or in a corner touches two parts of the terrain at once. A box, a
/// capsule and a cylinder of restitution 0.5 come down there, turned in several ways, with error
/// control and in fixed steps: they stay above it and gain no energy. Before, slopes of the depth
/// that were found by differences took one part for both, and a step ended in an error of the
/// program.
#[test]
fn what_bounces_in_grooves_and_corners_touches_two_parts() {
    let groove = |x: f64, _: f64| x.abs();
    let corner = along(&[[-2.0, 2.0], [-2.0, 0.0], [2.0, 0.0]], 2.0);
    let shapes = [
        Shape::Box {
            half: Vec3::new(0.1, 0.15, 0.07),
        },
        Shape::Capsule {
            radius: 0.05,
            half_length: 0.1,
        },
        Shape::Cylinder {
            radius: 0.08,
            half_length: 0.1,
        },
    ];
    let grounds = [
        (field(4.0, 40, groove), 0.0),
        (mesh(&grid(4.0, 40, groove)), 0.0),
        (mesh(&corner), -1.9),
    ];
    for (terrain, x) in &grounds {
        for shape in &shapes {
            for (turn, step) in [(0.0, 0.0), (0.7, 1.0 / 240.0), (1.9, 0.0)] {
                let mut one = body(1.0, shape.clone(), Vec3::new(*x, 0.0, 0.6));
                one.roots[0].rpy = Vec3::new(turn, 0.3, 2.0 * turn);
                let mut floor = ground(terrain.clone(), Vec3::zeros());
                for model in [&mut one, &mut floor] {
                    model.links[0].restitution = 0.5;
                    model.links[0].friction = 0.3;
                }
                let mut model = over(floor, one);
                model.solver.step_size = step;
                let mut s = start(model, 1e-3);
                let before = energy(&mut s);
                run(&mut s, 1.5, 1.0 / 240.0);
                let (gained, z) = (energy(&mut s) - before, s.state().physical.q[2]);
                assert!(
                    gained < 1e-2 && z > 0.04,
                    "{shape:?}, {turn}: {gained} J, {z} m"
                );
            }
        }
    }
}

/// A wall of a mesh, 10 cm wide and 30 cm high, on a floor of the same mesh. Boxes and hulls of a
/// metre that come down on it, turned in all ways, lie across it with corners beyond it, and make
/// hardly any energy. Before, a corner that had passed the wall was as deep in its near side as it
/// was far from that: up to half a metre, and a hull rose by 0.8 m.
///
/// Truth: a passive robot gains no energy.
#[test]
fn corners_that_have_passed_a_wall_are_not_in_it() {
    let profile = [
        [-5.0, 0.0],
        [-0.05, 0.0],
        [-0.05, 0.3],
        [0.05, 0.3],
        [0.05, 0.0],
        [5.0, 0.0],
    ];
    let wall = mesh(&along(&profile, 5.0));
    let mut random = Random(17);
    for k in 0..24 {
        let shape = if k % 2 == 0 {
            Shape::Box {
                half: Vec3::new(0.5, 0.4, 0.3),
            }
        } else {
            let points: Vec<Vec3> = (0..10).map(|_| random.vector(0.6)).collect();
            Shape::Hull {
                vertices: crate::geometry::convex_hull(&points).expect("a hull"),
            }
        };
        let at = Vec3::new(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 1.6);
        let mut one = body(100.0, shape, at);
        one.roots[0].rpy = random.vector(3.0);
        one.roots[0].linear_velocity = random.vector(1.0);
        one.roots[0].angular_velocity = random.vector(2.0);
        one.links[0].friction = 0.3;
        let mut s = start(over(ground(wall.clone(), Vec3::zeros()), one), 1e-3);
        let mut lowest = energy(&mut s);
        for i in 1..=360 {
            s.advance_to(f64::from(i) / 240.0).expect("finite");
            let now = energy(&mut s);
            // 3 % of a fall of a metre; up to 2 % are left, see docs/sweep.md.
            assert!(now - lowest < 30.0, "{k} at step {i}: {} J", now - lowest);
            lowest = lowest.min(now);
        }
    }
}
