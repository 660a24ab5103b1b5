//! What lies with one face on several things that are level with each other.

use super::worlds::{body, depth, world};
use super::*;

/// Error control, and fixed steps, s.
const MODES: [f64; 2] = [0.0, 1.0 / 240.0];

/// A table of 2 by 2 m about x, its top at z = 0.
fn table(x: f64) -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let half = Vec3::new(1.0, 1.0, 0.1);
    b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
    b.model.roots[0].position = Vec3::new(x, 0.0, -0.1);
    b.model
}

/// The same, driven as inputs say.
fn driven(x: f64) -> Model {
    let half = Vec3::new(1.0, 1.0, 0.1);
    let mut table = body(1.0, Shape::Box { half }, Vec3::new(x, 0.0, -0.1));
    table.outputs.driven = vec![RootId(0)];
    table
}

/// The same, with a surface that moves along it.
fn belt(x: f64) -> Model {
    let mut belt = table(x);
    belt.outputs.conveyors = vec![RootId(0)];
    belt
}

/// A plate of 1 kg, 20 by 20 by 1 cm, with its middle at x, that lies in its statics on what has
/// its top at z = 0, and one of two things that meet at x = 0.
fn plate(x: f64, mu: f64, things: [Model; 2]) -> Model {
    let half = Vec3::new(0.1, 0.1, 0.005);
    let plate = body(
        1.0,
        Shape::Box { half },
        Vec3::new(x, 0.0, 0.005 - depth(1.0)),
    );
    let mut model = world([plate].into_iter().chain(things));
    model.world.ground = None;
    for link in &mut model.links {
        link.friction = mu;
    }
    model
}

fn pushed(s: &mut Simulation, link: u32) -> f64 {
    s.output(OutputSlot::ContactForce(LinkId(link), 2))
}

/// A rigid plate on an even foundation presses evenly, so that each of two tables carries the part
/// of the weight that lies on it; it lies as deep as on one. Here the second table carried 41 % of
/// the weight with 5 % of the area.
#[test]
fn each_of_two_level_tables_carries_what_lies_on_it() {
    for (second, step) in [
        (table as fn(f64) -> Model, 0.0),
        (driven, 0.0),
        (driven, 1.0 / 240.0),
    ] {
        for share in [0.02, 0.05, 0.25, 0.5, 0.75, 0.95] {
            let x = 0.2 * share - 0.1;
            let mut model = plate(x, 0.4, [table(-1.0), second(1.0)]);
            model.solver.step_size = step;
            let mut s = start(model, 1e-3);
            run(&mut s, 0.5, 0.01);
            let [one, two] = [1, 2].map(|link| -pushed(&mut s, link) / G);
            assert!((two - share).abs() < 2e-3, "{step} {share}: {two}");
            assert!((one + two - 1.0).abs() < 1e-6, "{one} {two}");
            let z = s.output(OutputSlot::BasePosition(RootId(0), 2));
            let deep = 0.005 - z;
            assert!((deep - depth(1.0)).abs() < 1e-3 * depth(1.0), "{deep}");
        }
    }
}

/// A plate that one belt hands to the next one keeps the speed of the first one, which holds it,
/// until half of it lies on the second. From there on Coulomb's friction of both leaves `μ g (2 s −
/// 1)` with the share `s` on the second one, until it is as fast as that: integrated by the
/// midpoint rule in steps of 0.1 ms. After 1.2 s on belts of 0.3 and 2 m/s it was 0.17 m behind.
#[test]
fn a_plate_is_handed_from_belt_to_belt_by_its_area() {
    let mu = 0.4;
    for [first, second] in [[0.3, 2.0], [1.0, 0.4], [0.5, 1.0]] {
        let (mut x, mut v, dt) = (-0.2, first, 1e-4);
        for _ in 0..12_000 {
            let share = ((x + 0.5 * dt * v + 0.1) / 0.2_f64).clamp(0.5, 1.0);
            let faster = dt * mu * G * (2.0 * share - 1.0);
            let next = v + (second - v).clamp(-faster, faster);
            x += 0.5 * dt * (v + next);
            v = next;
        }
        for step in MODES {
            let mut model = plate(-0.2, mu, [belt(-1.0), belt(1.0)]);
            model.roots[0].linear_velocity.x = first;
            model.solver.step_size = step;
            let mut s = start(model, 1e-3);
            s.set_input(InputSlot::SurfaceVelocity(RootId(1), 0), first);
            s.set_input(InputSlot::SurfaceVelocity(RootId(2), 0), second);
            run(&mut s, 1.2, 1.0 / 240.0);
            let found = s.output(OutputSlot::BasePosition(RootId(0), 0));
            assert!(
                (found - x).abs() < 2e-3,
                "{first} {second} {step}: {found} {x}"
            );
        }
    }
}

/// A floor of posts with gaps of 1 cm, their tops at z = 0: what slides over it without friction
/// goes on as it does on one plate. Where a plate spun it lost 25 % of its speed on octagons, and
/// 11 % on cylinders, whose walls are not behind each other.
#[test]
fn what_slides_over_posts_goes_on() {
    let octagon = (0..16).map(|i| {
        let (sin, cos) = libm::sincos((f64::from(i / 2) + 0.5) * std::f64::consts::FRAC_PI_4);
        let radius = 0.05 / libm::cos(std::f64::consts::PI / 8.0);
        Vec3::new(
            radius * cos,
            radius * sin,
            if i % 2 == 0 { 0.05 } else { -0.05 },
        )
    });
    let vertices: Vec<Vec3> = octagon.collect();
    let (radius, half_length) = (0.05, 0.05);
    let can = Shape::Cylinder {
        radius,
        half_length,
    };
    for (post, spin) in [
        (
            Shape::Hull {
                vertices: vertices.clone(),
            },
            0.0,
        ),
        (Shape::Hull { vertices }, 1.0),
        (can, 1.0),
    ] {
        for step in MODES {
            let half = Vec3::new(0.075, 0.075, 0.0125);
            let mut plate = body(1.0, Shape::Box { half }, Vec3::new(0.0, 0.013, 0.0125));
            plate.roots[0].linear_velocity = Vec3::new(0.3, 0.07, 0.0);
            plate.roots[0].angular_velocity.z = spin;
            let posts = (0..15).map(|i| {
                let mut b = Builder::new(false, RigidInertia::ZERO);
                b.shape(LinkId(0), post.clone(), Pose::IDENTITY);
                let [x, y] = [i / 3 - 1, i % 3 - 1].map(|at| 0.11 * f64::from(at));
                b.model.roots[0].position = Vec3::new(x, y, -0.05);
                b.model
            });
            let mut model = world([plate].into_iter().chain(posts));
            model.world.ground = None;
            for link in &mut model.links {
                link.friction = 0.0;
            }
            model.solver.step_size = step;
            let mut s = start(model, 1e-3);
            run(&mut s, 0.8, 1.0 / 240.0);
            let v = &s.state().physical.v;
            let speed = libm::hypot(v[3], v[4]) / libm::hypot(0.3, 0.07);
            assert!(
                (speed - 1.0).abs() < 1e-3,
                "{post:?} {spin} {step}: {speed}"
            );
            assert!(
                (v[2] - spin).abs() < 2e-3,
                "{post:?} {spin} {step}: {}",
                v[2]
            );
        }
    }
}
