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
    for (n, last, kept) in [(3, 0.898, 0.839), (5, 0.814, 0.735)] {
        let x = |i: usize| 0.100_001 * i as f64 - if i == 0 { 0.02 } else { 0.0 };
        let places: Vec<[f64; 2]> = (0..n).map(|i| [x(i), 0.0]).collect();
        for tolerance in [1e-3, 1e-5] {
            let v = parted(e, &places, tolerance);
            let energy: f64 = v.iter().map(|v| v * v).sum();
            assert!((v.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{v:?}");
            assert!(
                (v[n - 1] - last).abs() < 0.05,
                "{n}, {tolerance:.0e}: {v:?}"
            );
            assert!(
                (energy - kept).abs() < 0.08,
                "{n}, {tolerance:.0e}: {energy}"
            );
        }
    }
}
