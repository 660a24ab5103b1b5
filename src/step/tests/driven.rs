//! Bases that move as their inputs say: platforms, lifts, turntables, shaking tables.

use super::worlds::{body, cube, depth, world};
use super::*;
use crate::closure::testing::{add, anchor};
use crate::model::LoopKind;
use crate::simulation::{SimulationError, Snapshot};
use crate::slots::InputSlot::{BaseAngularVelocity, BaseLinearVelocity};
use crate::spatial::{Mat3, quaternion_normalized, quaternion_product, rotation_from_quaternion};
use crate::testing::Random;
use std::f64::consts::TAU;

/// What is driven in these worlds.
const TABLE: RootId = RootId(1);

/// Things on a table of 2 by 2 m, its top at z = 0, that is driven; no other ground.
fn on_table(mu: f64, things: impl IntoIterator<Item = Model>) -> Model {
    let half = Vec3::new(1.0, 1.0, 0.1);
    let mut table = body(1.0, Shape::Box { half }, Vec3::z() * -0.1);
    table.outputs.driven = vec![RootId(0)];
    let mut things = things.into_iter();
    let first = things.next().expect("one");
    let mut model = world([first, table].into_iter().chain(things));
    model.world.ground = None;
    for link in &mut model.links {
        link.friction = mu;
    }
    model
}

/// A cube of 10 cm that rests at `x` on the table.
fn resting(mass: f64, x: f64) -> Model {
    cube(mass, Vec3::new(x, 0.0, 0.05 - depth(1.0)))
}

fn drive(s: &mut Simulation, linear: Vec3, angular: Vec3) {
    for i in 0..3_u8 {
        let axis = usize::from(i);
        s.set_input(BaseLinearVelocity(TABLE, i), linear[axis]);
        s.set_input(BaseAngularVelocity(TABLE, i), angular[axis]);
    }
}

fn place(s: &mut Simulation, root: u32) -> Vec3 {
    let along = |axis| s.output(OutputSlot::BasePosition(RootId(root), axis));
    Vec3::from([0, 1, 2].map(along))
}

/// Velocities are those of the inputs, to the last bit, and places their integrals, whatever lies
/// on it and however the steps are taken: 100 kg more change nothing.
#[test]
fn what_is_driven_goes_where_its_inputs_say() {
    for step in [0.0, 1.0 / 240.0] {
        let mut model = on_table(0.8, [resting(100.0, 0.2), resting(1.0, -0.4)]);
        model.solver.step_size = step;
        let mut s = start(model, 1e-3);
        let (mut at, mut angle, mut before) = (place(&mut s, 1), 0.0, [0.0; 4]);
        let dt = 1.0 / 60.0;
        for k in 1..=120 {
            let t = f64::from(k) * dt;
            let now = [3.0, 5.0, 7.0, 11.0].map(|w| 0.4 * libm::sin(w * t));
            drive(
                &mut s,
                Vec3::new(now[0], now[1], now[2]),
                Vec3::z() * now[3],
            );
            s.advance_to(t).expect("a step");
            for i in 0..3 {
                at[i] += 0.5 * dt * (before[i] + now[i]);
            }
            angle += 0.5 * dt * (before[3] + now[3]);
            let off = place(&mut s, 1) - at;
            assert!(off.norm() < 1e-13, "{step} {t}: {off}");
            let yaw = s.output(OutputSlot::BaseRpy(TABLE, 2));
            assert!((yaw - angle).abs() < 1e-13, "{step} {t}: {yaw} {angle}");
            let v = s.output(OutputSlot::BaseLinearVelocity(TABLE, 0));
            assert_eq!(v.to_bits(), now[0].to_bits());
            before = now;
        }
        assert!(s.output(OutputSlot::BaseRpy(TABLE, 0)).abs() < 1e-300);
    }
}

/// A table starts with the acceleration `a` for 0.2 s and goes on at its speed. A box on it follows
/// with at most `μ g` (Coulomb): below that it stays where it is on the table, above it slips by
/// `½ a T² (a/(μ g) − 1)`.
#[test]
fn a_box_on_a_driven_table_slips_above_mu_g() {
    let mu = 0.4;
    for share in [0.5, 0.95, 1.05, 1.5, 3.0] {
        for (step, tolerance) in [(1.0 / 240.0, 1e-3), (0.0, 1e-3), (0.0, 1e-5)] {
            let mut model = on_table(mu, [resting(1.0, 0.0)]);
            model.solver.step_size = step;
            let mut s = start(model, tolerance);
            let (a, T, dt) = (share * mu * G, 0.2, 1.0 / 240.0);
            for k in 1..=240 {
                let t = f64::from(k) * dt;
                drive(&mut s, X * (a * t.min(T)), Vec3::zeros());
                s.advance_to(t).expect("a step");
            }
            // One a communication step, and some where friction begins to slip and ends. The work
            // of the table was lost where friction cones had to follow their loads last: up to
            // 177,000 steps looked as if they made energy.
            let steps = s.state().stepping.counters.steps;
            assert!(steps < 300, "{share} {step} {tolerance}: {steps} steps");
            let slip = place(&mut s, 1).x - place(&mut s, 0).x;
            let truth = 0.5 * a * T * T * (share - 1.0).max(0.0);
            // Friction has a spring of the stiffness of contacts, which is not yet loaded at the
            // start: a box that slips lacks a part of the speed that friction would have given it
            // within the spring's time √(m/k), 2.6 ms, until the table stops to accelerate.
            let lacks = if share > 1.0 {
                2.6e-3 * mu * G * T
            } else {
                1e-4
            };
            assert!(
                (slip - truth).abs() < lacks,
                "{share} {step} {tolerance}: {slip} {truth}"
            );
            let level = place(&mut s, 0).z - (0.05 - depth(1.0));
            assert!(level.abs() < 2e-6, "{share} {step}: {level:e}");
        }
    }
}

/// The weight of a box in a lift is `m (g + a)` (Newton): on the way up, at even speed, while it
/// stops, and where it falls as fast as the box would.
#[test]
fn a_box_in_a_lift_weighs_what_it_accelerates() {
    let mass = 3.0;
    for step in [0.0, 1.0 / 240.0] {
        let mut model = on_table(0.8, [resting(mass, 0.0)]);
        model.outputs.contacts = vec![LinkId(0)];
        model.solver.step_size = step;
        let mut s = start(model, 1e-4);
        let (dt, mut speed) = (0.01, 0.0);
        for (from, a) in [
            (0.0, 2.0),
            (1.0, 0.0),
            (2.0, -2.0),
            (3.0, -0.5 * G),
            (4.0, -2.0 * G),
        ] {
            for k in 1..=100 {
                speed += a * dt;
                drive(&mut s, Vec3::z() * speed, Vec3::zeros());
                s.advance_to(from + f64::from(k) * dt).expect("a step");
            }
            let force = s.output(OutputSlot::ContactForce(LinkId(0), 2));
            let truth = mass * (G + a).max(0.0);
            assert!(
                (force - truth).abs() < 1e-4 * mass * G,
                "{step} {a}: {force} {truth}"
            );
        }
    }
}

/// A box on a turntable stays on its circle while `ω² r < μ g`, and is thrown out above it.
#[test]
fn a_box_on_a_turntable_stays_within_friction() {
    let (mu, r, T): (f64, f64, f64) = (0.5, 0.5, 2.0);
    for (share, stays) in [(0.9, true), (1.1, false)] {
        for step in [0.0, 1.0 / 240.0] {
            let mut model = on_table(mu, [resting(1.0, r)]);
            model.solver.step_size = step;
            let mut s = start(model, 1e-4);
            let speed = (share * mu * G / r).sqrt();
            let dt = 1.0 / 240.0;
            // It goes on at its speed for half a second.
            for k in 1..=600 {
                let t = f64::from(k) * dt;
                drive(
                    &mut s,
                    Vec3::zeros(),
                    Vec3::z() * (speed * (t / T).min(1.0)),
                );
                s.advance_to(t).expect("a step");
            }
            let at = place(&mut s, 0);
            let radius = libm::hypot(at.x, at.y);
            if stays {
                let angle = speed * (0.5 * T + 0.5);
                let turned = libm::remainder(libm::atan2(at.y, at.x) - angle, TAU) * r;
                // What the spring of friction gives.
                assert!((radius - r).abs() < 1e-4, "{step}: {radius}");
                assert!(turned.abs() < 1e-4, "{step}: {turned}");
            } else {
                assert!(radius > r + 0.01, "{step}: {radius}");
            }
        }
    }
}

/// A pendulum whose pivot a loop holds on what is driven: `l θ̈ = −(g + z̈) sin θ − ẍ cos θ` of a
/// point mass, solved by RK4 in steps of 1e-4 s.
#[test]
fn a_pendulum_hangs_on_what_is_driven() {
    let l = 0.5;
    for (step, tolerance, allowed) in [
        (1.0 / 960.0, 1e-3, 1e-3),
        (0.0, 1e-4, 1e-3),
        (0.0, 1e-6, 2e-5),
    ] {
        let mut bob = Builder::new(true, inertia(1.0, Vec3::zeros(), [1e-9; 3])).model;
        bob.roots[0].position = Vec3::new(0.0, 0.0, -l);
        let mut model = on_table(0.5, [bob]);
        model.colliders.clear();
        let ends = [
            anchor(Some(LinkId(0)), at(0.0, 0.0, l)),
            anchor(Some(LinkId(1)), at(0.0, 0.0, 0.1)),
        ];
        add(&mut model, LoopKind::Ball(ends));
        model.solver.step_size = step;
        let mut s = start(model, tolerance);
        // Even accelerations in steps of 10 ms, of a motion that sways and lifts.
        let dt = 0.01;
        let speed = |k: i32| {
            let t = f64::from(k) * dt;
            [0.3 * libm::sin(6.0 * t), 0.4 * libm::sin(9.0 * t)]
        };
        let (mut theta, mut rate) = (0.0_f64, 0.0_f64);
        for k in 1..=200 {
            let ([x0, z0], [x1, z1]) = (speed(k - 1), speed(k));
            drive(&mut s, Vec3::new(x1, 0.0, z1), Vec3::zeros());
            s.advance_to(f64::from(k) * dt).expect("a step");
            let (ax, az) = ((x1 - x0) / dt, (z1 - z0) / dt);
            let pull = |theta: f64| {
                let (sin, cos) = libm::sincos(theta);
                -((G + az) * sin + ax * cos) / l
            };
            let h = 1e-4;
            for _ in 0..100 {
                let k1 = (rate, pull(theta));
                let k2 = (rate + 0.5 * h * k1.1, pull(theta + 0.5 * h * k1.0));
                let k3 = (rate + 0.5 * h * k2.1, pull(theta + 0.5 * h * k2.0));
                let k4 = (rate + h * k3.1, pull(theta + h * k3.0));
                theta += h / 6.0 * (k1.0 + 2.0 * (k2.0 + k3.0) + k4.0);
                rate += h / 6.0 * (k1.1 + 2.0 * (k2.1 + k3.1) + k4.1);
            }
            let by = place(&mut s, 0) - place(&mut s, 1) - Vec3::z() * 0.1;
            let found = libm::atan2(by.x, -by.z);
            assert!(
                (found - theta).abs() < allowed,
                "{step} {tolerance} {k}: {found} {theta}"
            );
            assert!((by.norm() - l).abs() < 1e-11, "{}", by.norm() - l);
        }
    }
}

/// A restored state goes on with the same bits, and nothing is left in scratch.
#[test]
fn a_driven_world_goes_on_with_the_same_bits() {
    for step in [0.0, 1.0 / 240.0] {
        let mut model = on_table(0.5, [resting(1.0, 0.3), resting(2.0, -0.3)]);
        model.solver.step_size = step;
        let go = |s: &mut Simulation, from: i32| {
            for k in from..from + 30 {
                let t = f64::from(k + 1) * 0.01;
                drive(s, X * libm::sin(20.0 * t), Vec3::z() * t);
                s.advance_to(t).expect("a step");
            }
        };
        let mut s = start(model.clone(), 1e-3);
        go(&mut s, 0);
        let bytes = s.save().to_bytes();
        let mut other = start(model, 1e-3);
        let read = Snapshot::from_bytes(other.model(), &bytes).expect("own bytes");
        other.restore(&read).expect("same model");
        other.spoil();
        let both = [&mut s, &mut other].map(|s| {
            let shown = s.output(OutputSlot::LinkLinearVelocity(LinkId(0), 0));
            go(s, 30);
            shown.to_bits()
        });
        assert_eq!(both[0], both[1]);
        assert_eq!(other.state(), s.state());
    }
}

/// A step that an importer watches is taken in parts; the table still reaches its velocity at the
/// end of the whole, with an even acceleration.
#[test]
fn a_step_in_parts_drives_as_one() {
    let mut s = start(on_table(0.8, [resting(1.0, 0.2)]), 1e-3);
    drive(&mut s, Vec3::x(), Vec3::zeros());
    for (now, x) in [(0.002, 0.2e-3), (0.007, 2.45e-3), (0.01, 5e-3)] {
        s.advance_part(now, 0.01).expect("finite");
        // ½ a t² with a = 100 m/s².
        assert!((place(&mut s, 1).x - x).abs() < 1e-15, "{now}");
    }
    let v = s.output(OutputSlot::BaseLinearVelocity(TABLE, 0));
    assert_eq!(v.to_bits(), 1.0_f64.to_bits());
}

/// Turns about axes that turn themselves, from one random velocity to the next, in one step beside
/// the integral of the angular velocity: RK4 of the quaternion in 20,000 steps, which are off by
/// less than 1e-14. A cube that is welded to the table goes with it, and a step in parts leads
/// where one leads. In one communication step of 0.1 s the mean of both angular velocities alone
/// would be off by 0.03 rad, with four terms of the Magnus expansion by 7e-5, in one of 1 s by 2
/// rad (beside `solve_ivp` of `SciPy` at 1e-12).
#[test]
fn an_axis_that_turns_is_followed() {
    let mut random = Random(5);
    for (span, step, tolerance) in [
        (0.05, 0.0, 1e-3),
        (0.1, 0.0, 1e-3),
        (0.1, 1.0 / 240.0, 1e-3),
        (1.0, 0.0, 1e-2),
        (1.0, 0.0, 1e-5),
        (1.0, 1.0 / 240.0, 1e-3),
    ] {
        for k in 0..20 {
            let [from, to] = if k == 0 {
                [Vec3::x() * 5.0, Vec3::y() * 5.0]
            } else {
                [(); 2].map(|()| random.vector(5.0))
            };
            let mut model = on_table(0.8, [cube(1.0, Vec3::new(0.9, 0.0, 0.3))]);
            model.colliders.clear();
            let ends = [
                anchor(Some(LinkId(0)), at(0.0, 0.0, 0.0)),
                anchor(Some(LinkId(1)), at(0.9, 0.0, 0.4)),
            ];
            add(&mut model, LoopKind::Weld(ends));
            model.solver.step_size = step;
            let mut s = start(model, tolerance);
            drive(&mut s, Vec3::zeros(), from);
            s.advance_to(1.0).expect("finite");
            let before = s.save();
            let start = orientation(&s);
            drive(&mut s, Vec3::zeros(), to);
            s.advance_to(1.0 + span).expect("finite");
            let end = orientation(&s);
            let off = angle(&(integral([from, to], span) * start), &end);
            assert!(
                off < 1e-13,
                "{span} {step} {tolerance}: {off:e}, {from} {to}"
            );
            let hung = place(&mut s, 1) + end * Vec3::new(0.9, 0.0, 0.4) - place(&mut s, 0);
            assert!(hung.norm() < 1e-11, "{span} {step} {tolerance}: {hung}");
            s.restore(&before).expect("own state");
            drive(&mut s, Vec3::zeros(), to);
            for share in [0.3, 0.4, 1.0] {
                s.advance_part(1.0 + share * span, 1.0 + span)
                    .expect("finite");
            }
            let apart = angle(&orientation(&s), &end);
            assert!(
                apart < 1e-13,
                "{span} {step} {tolerance}: {apart:e} in parts"
            );
        }
    }
}

/// Rotation of the table.
fn orientation(s: &Simulation) -> Mat3 {
    let place = s.tree().bodies[s.model().roots[1].body.index()].coordinate;
    let q = &s.state().physical.q[place..];
    rotation_from_quaternion(&[q[3], q[4], q[5], q[6]])
}

/// Angle of the turn from one rotation to the other, which is small, rad: its sine has all digits.
fn angle(from: &Mat3, to: &Mat3) -> f64 {
    let apart = from.transpose() * to;
    let sine = 0.5 * (apart - apart.transpose());
    Vec3::new(sine[(2, 1)], sine[(0, 2)], sine[(1, 0)]).norm()
}

/// Turn while the angular velocity changes evenly from one to the other in `span` seconds, by RK4.
fn integral([from, to]: [Vec3; 2], span: f64) -> Mat3 {
    let count = 20_000;
    let h = span / f64::from(count);
    let mut q = [1.0, 0.0, 0.0, 0.0];
    let after = |q: &[f64; 4], t: f64, k: &[f64; 4]| -> [f64; 4] {
        std::array::from_fn(|i| q[i] + t * k[i])
    };
    for k in 0..count {
        let rate = |share: f64, q: &[f64; 4]| {
            let w = from + (to - from) * ((f64::from(k) + share) / f64::from(count));
            quaternion_product(&[0.0, 0.5 * w.x, 0.5 * w.y, 0.5 * w.z], q)
        };
        let k1 = rate(0.0, &q);
        let k2 = rate(0.5, &after(&q, 0.5 * h, &k1));
        let k3 = rate(0.5, &after(&q, 0.5 * h, &k2));
        let k4 = rate(1.0, &after(&q, h, &k3));
        for i in 0..4 {
            q[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
    }
    rotation_from_quaternion(&quaternion_normalized(&q))
}

/// However slowly the table sinks, what stands on it sinks with it, and does not rest.
#[test]
fn what_stands_on_a_creeping_table_creeps_with_it() {
    let mut s = start(on_table(0.8, [resting(1.0, 0.2)]), 1e-3);
    run(&mut s, 0.5, 1.0 / 60.0);
    let before = place(&mut s, 0).z;
    drive(&mut s, Vec3::z() * -9e-8, Vec3::zeros());
    run(&mut s, 10.5, 0.1);
    let sunk = place(&mut s, 0).z - before;
    assert!((sunk / -9e-7 - 1.0).abs() < 0.02, "{sunk:e}");
}

/// A step that is refused leaves the state as it was, accelerations included.
#[test]
fn a_refused_step_leaves_what_is_driven_alone() {
    let mut s = start(on_table(0.8, [resting(1.0, 0.2)]), 1e-3);
    drive(&mut s, Vec3::x(), Vec3::zeros());
    run(&mut s, 0.1, 0.01);
    s.set_parameter(ParameterSlot::MaxSteps, 1.0);
    drive(&mut s, Vec3::x() * -5.0, Vec3::y() * 3.0);
    let before = s.save().to_bytes();
    assert!(s.advance_to(0.6).is_err());
    assert!(before == s.save().to_bytes());
}

/// A crate on rods of half a metre to a post and to a table that drives off: beyond 1 m a rod
/// cannot reach, and the error says which, when, and that it is no matter of numbers.
#[test]
fn a_rod_that_is_pulled_beyond_its_reach_is_named() {
    for step in [0.0, 1.0 / 240.0] {
        let mut model = on_table(0.0, [cube(1.0, Vec3::new(-2.5, 0.0, 0.5))]);
        let at = |x: f64| Pose::from_xyz_rpy(Vec3::x() * x, Vec3::zeros());
        let rods = [(None, -3.0), (Some(LinkId(1)), -2.0)].map(|(other, x)| {
            let height = if other.is_some() { 0.6 } else { 0.5 };
            let far = Pose::from_xyz_rpy(Vec3::new(x, 0.0, height), Vec3::zeros());
            LoopKind::Distance {
                ends: [anchor(Some(LinkId(0)), at(0.0)), anchor(other, far)],
                length: 0.5,
            }
        });
        for rod in rods {
            add(&mut model, rod);
        }
        model.solver.step_size = step;
        model.world.gravity = Vec3::zeros();
        let mut s = start(model, 1e-3);
        drive(&mut s, Vec3::y(), Vec3::zeros());
        let stops = (1..=400).find_map(|k| s.advance_to(f64::from(k) * 0.005).err());
        let Some(SimulationError::Apart { name, time }) = stops else {
            panic!("{stops:?}");
        };
        assert!(name.starts_with("loop"), "{name}");
        assert!((0.0..1.0).contains(&time), "{time}");
    }
}
