//! Dissipation of what bounces, against impacts whose result is known.

use super::*;
use crate::force::tests::{met, two_bodies};
use crate::force::{ContactSet, detect};
use crate::geometry::Shape;
use crate::law::dissipation_number;
use crate::model::{Model, RootKind};
use crate::simulation::Simulation;
use crate::spatial::Pose;
use crate::testing::{Builder, inertia, start};

/// A spring that is 60 penetrations deep and holds more than the shapes have come in with has
/// been pressed by others, and bounces no more; one that has taken up an impact goes on, and so
/// does what is as deep as loads press. Before, what was pressed in among bodies that began in
/// each other was resolved by 12,000 steps a communication step, and thrown out.
#[test]
fn what_is_pressed_into_others_bounces_no_more() {
    let radius = 0.05;
    for e in [0.3, 0.9, 1.0] {
        let shapes = [0; 2].map(|_| Shape::Sphere { radius });
        let mut model = two_bodies(&shapes).model().clone();
        for link in &mut model.links {
            link.restitution = e;
        }
        let s = Simulation::new(std::sync::Arc::new(model));
        // The share of the speed that it holds with which it has come in.
        for (depth, came, bounces) in [(60.0, 0.4, false), (60.0, 0.6, true), (30.0, 0.4, true)] {
            let pose = |depth: f64| Pose {
                p: Vec3::z() * (2.0 * radius - depth),
                ..Pose::IDENTITY
            };
            let between = |list: &ContactSet| {
                let mut all = list.iter();
                all.find(|c| c.other.is_some()).expect("they touch").clone()
            };
            let reference = between(&met(&s, &pose(0.01)).1).spring.reference;
            let (kin, mut list) = met(&s, &pose(depth * reference));
            let first = between(&list);
            let kept = (2.0 * first.spring.stored(first.depth) / first.mass).sqrt();
            let touch = Touch {
                slot: first.slot,
                bounce: dissipation_number(e) / (came * kept),
                ..Touch::default()
            };
            detect(s.model(), s.tree(), &[touch], &kin, 0.0, &mut list);
            let bounce = between(&list).bounce;
            assert_eq!(bounce > 0.0, bounces, "{e}, {depth}, {came}: {bounce}");
        }
    }
}

/// Balls of 0.1 kg and 5 cm without gravity, with this restitution and no friction, their middles
/// at these places, m; the first one comes at 1 m/s along x.
fn balls(e: f64, places: &[[f64; 2]]) -> Model {
    let ball = |[x, y]: &[f64; 2]| {
        let mut b = Builder::new(true, inertia(0.1, Vec3::zeros(), [1e-4; 3]));
        b.shape(
            0usize.into(),
            Shape::Sphere { radius: 0.05 },
            Pose::IDENTITY,
        );
        b.model.roots[0].position = Vec3::new(*x, *y, 1.0);
        b.model
    };
    let mut model = ball(&places[0]);
    for (i, place) in places[1..].iter().enumerate() {
        model.join(ball(place), &format!("ball{i}"), RootKind::Object);
    }
    model.world.gravity = Vec3::zeros();
    model.world.ground = None;
    model.roots[0].linear_velocity.x = 1.0;
    for link in &mut model.links {
        link.restitution = e;
        link.friction = 0.0;
    }
    model
}

/// Speeds along x, m/s, after all have parted.
fn parted(e: f64, places: &[[f64; 2]], tolerance: f64) -> Vec<f64> {
    let mut s = start(balls(e, places), tolerance);
    s.advance_to(0.2).expect("finite");
    let v = &s.state().physical.v;
    (0..places.len()).map(|i| v[6 * i + 3]).collect()
}

/// An impact goes through a row of balls that lie 1 µm beside each other, as in Newton's cradle,
/// with the losses of its restitution. Beside the law of Walton and Braun (1986), whose contacts
/// give back e² of what they take at any speed, integrated in 2e-4 of the time scale. One by one,
/// the last ball would have ((1 + e)/2)^(n − 1), 0.9025 and 0.8145.
#[test]
fn an_impact_goes_through_balls_that_touch_with_their_restitution() {
    let e = 0.9;
    for (n, last, kept) in [(3_u32, 0.898, 0.839), (5, 0.814, 0.735)] {
        let x = |i: u32| 0.100_001 * f64::from(i) - if i == 0 { 0.02 } else { 0.0 };
        let places: Vec<[f64; 2]> = (0..n).map(|i| [x(i), 0.0]).collect();
        for tolerance in [1e-3, 1e-5] {
            let v = parted(e, &places, tolerance);
            let energy: f64 = v.iter().map(|v| v * v).sum();
            assert!((v.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{v:?}");
            assert!(
                (v[places.len() - 1] - last).abs() < 0.05,
                "{n}, {tolerance:.0e}: {v:?}"
            );
            assert!(
                (energy - kept).abs() < 0.08,
                "{n}, {tolerance:.0e}: {energy}"
            );
        }
    }
}

/// Fastest of three boxes that begin in each other by centimetres, without a ground, in 0.1 s of
/// fixed steps, m/s; the first one has 0.2 kg, the others 2 kg.
fn fastest(boxes: &[([f64; 3], [f64; 3], [f64; 3]); 3], friction: f64) -> f64 {
    let body = |i: usize| {
        let (sides, place, rpy) = boxes[i];
        let mass = if i == 0 { 0.2 } else { 2.0 };
        let s = sides.map(|side| side * side * mass / 12.0);
        let diagonal = [s[1] + s[2], s[0] + s[2], s[0] + s[1]];
        let mut b = Builder::new(true, inertia(mass, Vec3::zeros(), diagonal));
        let half = Vec3::from(sides) * 0.5;
        b.shape(0usize.into(), Shape::Box { half }, Pose::IDENTITY);
        b.model.roots[0].position = Vec3::from(place);
        b.model.roots[0].rpy = Vec3::from(rpy);
        b.model
    };
    let mut model = body(0);
    for i in 1..3 {
        model.join(body(i), &format!("box{i}"), RootKind::Object);
    }
    model.world.ground = None;
    model.solver.step_size = 1.0 / 240.0;
    for link in &mut model.links {
        link.friction = friction;
    }
    let mut s = start(model, 1e-3);
    let mut fastest: f64 = 0.0;
    for i in 1..=24 {
        s.advance_to(f64::from(i) / 240.0).expect("finite");
        for v in s.state().physical.v.chunks(6) {
            fastest = fastest.max(Vec3::new(v[3], v[4], v[5]).norm());
        }
    }
    fastest
}

/// What pushes shapes out of each other is no load that they carry, and rubs nothing: with friction
/// they leave as slowly as without. Its load is a million times their weight, and in fixed steps
/// its friction threw one of these boxes out at 21 m/s and 8 m/s, which leave at 1 m/s without
/// friction, and with it under error control.
#[test]
fn what_begins_deep_in_others_is_not_thrown_out_by_friction() {
    let boxes = [
        [
            ([0.058, 0.104, 0.086], [0.0, 0.0, 1.0], [-2.44, -0.4, -0.13]),
            (
                [0.052, 0.098, 0.05],
                [-0.007, 0.001, 0.996],
                [0.52, 1.43, 2.74],
            ),
            (
                [0.092, 0.096, 0.064],
                [-0.03, 0.028, 0.988],
                [-1.12, 2.35, 0.51],
            ),
        ],
        [
            ([0.104, 0.082, 0.062], [0.0, 0.0, 1.0], [-2.68, -0.7, -0.55]),
            (
                [0.044, 0.044, 0.12],
                [0.009, -0.016, 0.996],
                [2.85, 2.39, 2.07],
            ),
            (
                [0.08, 0.094, 0.044],
                [0.003, -0.014, 1.023],
                [-2.61, 1.08, 2.22],
            ),
        ],
    ];
    for boxes in boxes {
        for friction in [0.0, 0.5, 2.0] {
            let speed = fastest(&boxes, friction);
            assert!(speed < 2.0, "{friction}: {speed} m/s");
        }
    }
}
