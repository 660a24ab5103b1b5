//! Bodies that begin inside each other, put there by initial poses.

use super::worlds::{body, speeds, world};
use super::*;
use crate::spatial::rotation_from_rpy;
use crate::testing::Random;

/// 5 to 11 bodies of 3 to 20 cm and 50 g to 10 kg within 20 cm of each other and of the ground,
/// most of them centimetres inside others.
fn pile(seed: u64, restitution: f64) -> Model {
    let random = &mut Random(seed);
    let count = 5 + random.below(7);
    let mut bodies = Vec::new();
    for _ in 0..count {
        let [a, b, c] = [0; 3].map(|_| random.uniform(0.015, 0.1));
        let shape = match random.below(3) {
            0 => Shape::Sphere { radius: a },
            1 => Shape::Cylinder {
                radius: a,
                half_length: b,
            },
            _ => Shape::Box {
                half: Vec3::new(a, b, c),
            },
        };
        let mass = libm::pow(10.0, random.uniform(-1.3, 1.0));
        let at = random.vector(0.1) + Vec3::z() * 0.15;
        let mut model = body(mass, shape, at);
        model.roots[0].rpy = random.vector(3.0);
        for link in &mut model.links {
            link.restitution = restitution;
        }
        bodies.push(model);
    }
    world(bodies)
}

/// Fastest velocity of any body in the first 0.1 s, m/s, that of places 0.1 m beside it included.
fn fastest(mut model: Model, (tolerance, step): (f64, f64)) -> f64 {
    model.solver.step_size = step;
    let mut s = start(model, tolerance);
    let mut fastest: f64 = 0.0;
    for i in 1..=24 {
        s.advance_to(f64::from(i) / 240.0).expect("finite");
        for [turning, speed] in speeds(&s) {
            fastest = fastest.max(speed).max(0.1 * turning);
        }
    }
    fastest
}

/// What begins deep in others leaves them slowly, at 0.7 of the speed of a fall through the overlap
/// at most, and pinches what is light out of between a few times as fast: by less than 6 m/s in
/// these piles, and without restitution just so. The depth of two shapes whose inner cores meet
/// jumps in some places. While the jump over a nudge of some 0.1 µm counted as a slope, a contact
/// pushed with thousands of times its force, and bodies flew away at 500 to 2,700 m/s.
#[test]
fn what_begins_deep_in_others_is_not_thrown_out_whatever_its_restitution() {
    for seed in [13, 29, 33] {
        for e in [0.0, 0.18, 1.0] {
            let speed = fastest(pile(seed, e), (1e-3, 1.0 / 240.0));
            assert!(speed < 6.0, "{seed}, {e}: {speed} m/s");
        }
    }
}

/// A box of 20 cm that begins 3 cm and more in the ground, leaning: where it is after 0.1 s does
/// not depend on the steps. While the spring's factor fell evenly to 0 at the speed with which an
/// overlap leaves, its corners took turns: at 1e-5 it ended 4e-3 m or rad from where it ends at
/// 1e-7 and took 1,500 tries, at 1e-4 2.3e-2. Expected is the end at 1e-7; errors of the tolerance
/// in each 0.1 s grow tenfold where an edge tips.
#[test]
fn what_begins_deep_in_the_ground_emerges_alike_in_all_steps() {
    let end = |tolerance: f64| {
        let half = Vec3::new(0.1, 0.1, 0.1);
        let mut model = body(2.0, Shape::Box { half }, Vec3::z() * 0.07);
        model.roots[0].rpy = Vec3::new(0.2, 0.1, 0.0);
        let mut s = start(world(vec![model]), tolerance);
        for i in 1..=24 {
            s.advance_to(f64::from(i) / 240.0).expect("finite");
        }
        let tries = s.output(OutputSlot::Steps) + s.output(OutputSlot::Rejected);
        (s.state().physical.q.clone(), tries)
    };
    let (expected, _) = end(1e-7);
    for (tolerance, most) in [(1e-4, 150.0), (1e-5, 300.0)] {
        let (q, tries) = end(tolerance);
        let off = q.iter().zip(&expected).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 50.0 * tolerance, "{tolerance}: {off}");
        assert!(tries < most, "{tolerance}: {tries} tries");
    }
}

/// A rover with four driven wheels that begins 10 to 30 mm in the ground and leans by 0.04 rad: it
/// rises in a fifth of a second. While the factor on the springs of contacts that were less than 50
/// penetrations deep fell evenly to 0 at the speed with which they leave, its wheels took turns on
/// the way, in 3,000 tries at 1e-3.
#[test]
fn a_rover_that_begins_askew_in_the_ground_rises_in_few_steps() {
    let mut b = Builder::new(true, inertia(10.0, Vec3::zeros(), [0.1, 0.2, 0.3]));
    let wheels = [(0.17, 0.18), (-0.17, 0.18), (0.17, -0.18), (-0.17, -0.18)].map(|(x, y)| {
        let wheel = inertia(1.0, Vec3::zeros(), [0.0028, 0.005, 0.0028]);
        let place = at(x, y, -0.05);
        let link = b.link(0u32.into_link(), place, Motion::Revolute(Y), wheel);
        let shape = Shape::Cylinder {
            radius: 0.1,
            half_length: 0.03,
        };
        let lying = rotation_from_rpy(&(X * std::f64::consts::FRAC_PI_2));
        let pose = Pose {
            R: lying,
            p: Vec3::zeros(),
        };
        b.shape(link, shape, pose);
        b.actuator(link, ActuatorMode::Velocity, 5.0);
    });
    let mut model = b.model;
    model.roots[0].position = Vec3::z() * 0.13;
    model.roots[0].rpy = Vec3::new(0.02, 0.03, 0.0);
    let mut s = start(model, 1e-3);
    for i in 0..wheels.len() {
        s.set_input(InputSlot::Velocity(ActuatorId::from(i)), 6.0 + i as f64);
    }
    for i in 1..=96 {
        s.advance_to(f64::from(i) / 240.0).expect("finite");
    }
    let tries = s.output(OutputSlot::Steps) + s.output(OutputSlot::Rejected);
    assert!(tries < 400.0, "{tries} tries");
    // A wheel is as deep as a weight makes it, 0.05 mm, or less.
    let z = s.state().physical.q[2];
    assert!((z - 0.15).abs() < 2e-3, "{z}");
}

/// An arm of two links of 1 kg and 1 m without gravity and motors, whose first joint begins beyond
/// its limit and has an effort limit of 1000 N·m: it comes back at the 0.0196 rad/s of the default
/// dissipation of 51 s/rad. While the factor on the springs of limits fell evenly to 0 at this
/// speed, the force that turns the second link had to be found within 1e-9 of it: 1,300 tries at
/// 1e-4, 24,000 at 1e-5, and more than 100,000 from farther out.
#[test]
fn an_arm_that_begins_beyond_its_limits_comes_back_in_few_steps() {
    for beyond in [0.05, 0.2, 1.0, 29.0] {
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let mut b = Builder::new(false, inertia(1.0, Vec3::zeros(), [0.1; 3]));
            let mut last = 0u32.into_link();
            for x in [0.0, 1.0] {
                let rod = inertia(1.0, X * 0.5, [0.01, 0.1, 0.1]);
                last = b.link(last, at(x, 0.0, 0.0), Motion::Revolute(Y), rod);
                b.limits(last, -1.0, 1.0);
            }
            let mut model = b.model;
            model.world.gravity = Vec3::zeros();
            model.joints[0].effort = Some(1000.0);
            model.initial.joint_positions[0] = 1.0 + beyond;
            let mut s = start(model, tolerance);
            for i in 1..=60 {
                s.advance_to(f64::from(i) / 240.0).expect("finite");
            }
            let tries = s.output(OutputSlot::Steps) + s.output(OutputSlot::Rejected);
            assert!(tries < 120.0, "{tries} tries at {tolerance}, {beyond}");
            let speed = -s.state().physical.v[0] * s.tree().contact.dissipation;
            assert!((0.9..1.1).contains(&speed), "{speed}");
        }
    }
}
