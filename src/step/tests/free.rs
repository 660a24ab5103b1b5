//! No contact: flight, spin, pendulums.

use super::*;
use crate::snapshot::Snapshot;
use crate::state::State;
use crate::tuning::MAX_FLOOR;
use nalgebra::{Quaternion, UnitQuaternion};

/// A mass on a rail, a pendulum on the mass.
fn swing() -> Builder {
    let (mut b, cart) = cart_with_pendulum();
    b.actuator(cart, ActuatorMode::Effort, 10.0);
    b
}

/// Smooth steps are as long as the motion allows: who looks how often changes nothing but
/// round-off.
#[test]
fn communication_points_do_not_change_a_smooth_motion() {
    // Explicit steps; with damping that is stiff, implicit ones.
    for damping in [0.0, 500.0] {
        let ends: Vec<State> = [1.0 / 1000.0, 1.0 / 240.0, 0.125]
            .into_iter()
            .map(|h| {
                let mut b = swing();
                b.model.joints[0].damping = damping;
                let mut s = start(b.model, 1e-3);
                run(&mut s, 3.0, h);
                s.state().clone()
            })
            .collect();
        for end in &ends[1..] {
            assert_eq!(end.stepping.counters, ends[0].stepping.counters);
            for (a, b) in end.physical.q.iter().zip(&ends[0].physical.q) {
                assert!((a - b).abs() < 1e-12, "{damping}: {a} {b}");
            }
        }
    }
}

/// 1 N on 1 kg from t = 0.5 s on: x = ½ (t − ½)², whatever had been foreseen.
#[test]
fn an_effort_acts_from_the_communication_point_at_which_it_is_set() {
    let (mut b, cart) = cart();
    b.actuator(cart, ActuatorMode::Effort, 10.0);
    let mut s = start(b.model, 1e-3);
    run(&mut s, 0.5, 0.01);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 1.0);
    run(&mut s, 1.0, 0.01);
    assert!(
        (s.state().physical.q[0] - 0.125).abs() < 1e-12,
        "{}",
        s.state().physical.q[0]
    );
}

/// 10 N on 1 kg with damping d: x = F/d (t − m/d (1 − exp(−d t/m))), whatever d. Damping that is a
/// hundred thousand times faster than the motion costs no more steps than damping as fast as it,
/// and no look in between sees anything else.
#[test]
fn damping_of_any_strength_is_followed_in_few_steps() {
    for damping in [1.0, 1e2, 1e3, 1e5] {
        let (mut b, cart) = cart();
        b.actuator(cart, ActuatorMode::Effort, 10.0);
        b.model.joints[0].damping = damping;
        let mut s = start(b.model, 1e-3);
        s.set_input(InputSlot::Effort(ActuatorId(0)), 10.0);
        let mut worst = 0.0_f64;
        for i in 1..=1000 {
            let t = f64::from(i) * 1e-3;
            s.advance_to(t).expect("finite");
            let x = 10.0 / damping * (t - (1.0 - libm::exp(-damping * t)) / damping);
            worst = worst.max((s.state().physical.q[0] - x).abs());
        }
        let tries = s.state().stepping.counters.steps + s.state().stepping.counters.rejected;
        assert!(
            worst < 1e-4 && tries < 60,
            "{damping}: {worst:e} m in {tries} steps"
        );
    }
}

/// Saved in the middle of a step that reaches beyond the communication point.
#[test]
fn a_state_saved_within_a_long_step_continues_bit_for_bit() {
    for damping in [0.0, 500.0] {
        let mut b = swing();
        b.model.joints[0].damping = damping;
        let mut s = start(b.model.clone(), 1e-3);
        run(&mut s, 0.5, 0.001);
        while s.state().stepping.ahead.coefficients.is_empty() {
            assert!(s.time() < 3.0, "{damping} {:?}", s.state());
            let next = s.time() + 0.001;
            s.advance_to(next).expect("finite");
        }
        let bytes = s.save().to_bytes();
        let mut other = start(b.model, 1e-3);
        let saved = Snapshot::from_bytes(other.model(), &bytes).expect("its own bytes");
        other.restore(&saved).expect("its own state");
        for simulation in [&mut s, &mut other] {
            for step in 1..=100 {
                simulation
                    .advance_to(1.0 + 0.01 * f64::from(step))
                    .expect("finite");
            }
        }
        assert_eq!(s.state(), other.state());
    }
}

/// A joint pushed towards its limit from rest: nothing tells the first step that it will get there.
#[test]
fn a_long_step_does_not_jump_over_a_limit() {
    let (mut b, cart) = cart();
    b.limits(cart, -0.1, 0.1);
    b.actuator(cart, ActuatorMode::Effort, 200.0);
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 100.0);
    run(&mut s, 0.01, 0.01);
    // It arrives with 4.5 m/s; the limit's law takes that on within millimetres.
    let mut farthest = 0.0_f64;
    for i in 1..=100 {
        s.advance_to(0.01 + f64::from(i) * 0.01).expect("finite");
        farthest = farthest.max(s.state().physical.q[0]);
    }
    let rest = 0.1 + 100.0 / s.tree().dofs.limit_stiffness[0];
    assert!((s.state().physical.q[0] - rest).abs() < 1e-9);
    assert!(farthest < 0.1 + 0.01, "{farthest}");
}

/// Newton and Euler: whatever acts inside of a robot in flight, its centre of mass follows a
/// parabola, and its angular momentum about it stays. Here at the default tolerance, with motors
/// that work, and read off however often.
#[test]
fn a_robot_in_flight_follows_a_parabola_and_keeps_its_angular_momentum() {
    // Masses, their places and momenta, summed up by hand.
    let measure = |s: &Simulation| {
        let mut kin = crate::kinematics::Kinematics::new(s.tree());
        kin.update_poses(s.tree(), &s.state().physical.q);
        kin.update_velocities(s.tree(), &s.state().physical.v);
        let (mut mass, mut center, mut linear) = (0.0, Vec3::zeros(), Vec3::zeros());
        for I in &kin.I {
            mass += I.mass;
            center += Vec3::from(I.moment) + kin.origins[0] * I.mass;
        }
        let mut angular = Vec3::zeros();
        for (I, V) in kin.I.iter().zip(&kin.V) {
            let p = I.mul(V);
            linear += Vec3::new(p[3], p[4], p[5]);
            angular += Vec3::new(p[0], p[1], p[2]);
        }
        let center = center / mass;
        (
            center,
            linear / mass,
            angular - (center - kin.origins[0]).cross(&linear),
        )
    };
    for (mode, seed) in [
        (ActuatorMode::Pd, 1),
        (ActuatorMode::Effort, 2),
        (ActuatorMode::Velocity, 3),
    ] {
        let mut random = Random(seed);
        let mut model = random_tree(&mut random, 8, true, true);
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.1; 3]));
        std::mem::swap(&mut b.model, &mut model);
        for link in 1..b.model.links.len() {
            let moving = b.model.links[link].joint.is_some();
            if moving && b.model.actuators.len() < 3 {
                b.actuator(link.into(), mode, 5.0);
            }
        }
        b.model.roots[0].angular_velocity = Vec3::new(1.0, -2.0, 3.0);
        b.model.roots[0].linear_velocity = Vec3::new(3.0, 0.0, 8.0);
        let ends: Vec<State> = [1.0 / 1000.0, 1.0 / 240.0, 0.125]
            .into_iter()
            .map(|h| {
                let mut s = start(b.model.clone(), 1e-3);
                let (center, velocity, angular) = measure(&s);
                let scale = angular.norm();
                for step in 0..4 {
                    for a in 0..s.model().actuators.len() {
                        let command = (f64::from(step) + a as f64).sin();
                        s.set_input(InputSlot::Effort(a.into()), command);
                        s.set_input(InputSlot::Velocity(a.into()), command);
                        s.set_input(InputSlot::Position(a.into()), command);
                    }
                    let from = s.time();
                    while s.time() < from + 0.25 {
                        let next = (s.time() + h).min(from + 0.25);
                        s.advance_to(next).expect("finite");
                        let t = s.time();
                        let (c, v, H) = measure(&s);
                        let fall = Vec3::new(0.0, 0.0, -0.5 * G * t * t);
                        assert!((c - center - velocity * t - fall).norm() < 1e-12, "{c}");
                        assert!((v - velocity - fall * (2.0 / t)).norm() < 1e-12, "{v}");
                        assert!((H - angular).norm() < 1e-12 * scale, "{H} {angular}");
                    }
                }
                s.state().clone()
            })
            .collect();
        let moved: f64 = ends[0].physical.v[6..].iter().map(|v| v.abs()).sum();
        assert!(moved > 1.0, "{mode:?}: nothing moves inside");
    }
}

/// A rod without inertia about its axis: what its momentum about it is, is round-off, and is not
/// made a velocity.
#[test]
fn a_thin_rod_in_flight_does_not_spin_up_about_its_axis() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [1e-12, 0.1, 0.1]));
    b.model.roots[0].angular_velocity = Vec3::new(0.3, 1.0, -2.0);
    let mut s = start(b.model, 1e-3);
    let about_axis = |s: &Simulation| {
        let mut kin = crate::kinematics::Kinematics::new(s.tree());
        kin.update_poses(s.tree(), &s.state().physical.q);
        let [x, y, z] = [
            s.state().physical.v[0],
            s.state().physical.v[1],
            s.state().physical.v[2],
        ];
        kin.X[0].R.column(0).dot(&Vec3::new(x, y, z))
    };
    let mut worst = 0.0_f64;
    for i in 1..=1000 {
        s.advance_to(0.001 * f64::from(i)).expect("finite");
        worst = worst.max((about_axis(&s) - 0.3).abs());
    }
    // Symmetric about the axis: Euler's equations keep the spin about it.
    assert!(worst < 1e-3, "{worst}");
}

/// A body that tumbles keeps its energy (Euler's equations), also where what has gone before has
/// raised the shortest step to its greatest length: in steps of 0.1 ms it would turn by radians.
#[test]
fn what_whirls_makes_no_energy_although_short_steps_have_gone_before() {
    for rate in [3e3, 3e4, 3e5] {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [1e-4, 2e-4, 2.5e-4]));
        b.model.roots[0].angular_velocity = Vec3::new(0.3, 1.0, 0.2) * rate;
        b.model.world.gravity = Vec3::zeros();
        let mut s = start(b.model, 1e-3);
        s.state_mut().stepping.sizes.floor[0] = MAX_FLOOR;
        let before = s.output(OutputSlot::EnergyKinetic);
        run(&mut s, 0.005, 1.0 / 240.0);
        let gained = s.output(OutputSlot::EnergyKinetic) / before - 1.0;
        assert!(gained.abs() < 1e-6, "{rate} rad/s: {gained}");
    }
}

/// A free body without a ground, at `x` on the first axis, that spins.
fn spinning(body: RigidInertia, shape: Shape, x: f64, spin: Vec3) -> Model {
    let mut b = Builder::new(true, body);
    b.shape(LinkId(0), shape, Pose::IDENTITY);
    b.model.roots[0].position = Vec3::new(x, 0.0, 0.0);
    b.model.roots[0].angular_velocity = spin;
    b.model.world.ground = None;
    b.model
}

/// Kinetic and potential energy, J.
fn energy(s: &mut Simulation) -> f64 {
    s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
}

/// Two rods whirl beside each other, so near that each step has to look whether they meet. Nothing
/// acts on them, and each keeps its energy and its angular momentum (Euler's equations). Steps of
/// the second order made energy, until the rods turned about their long axes.
#[test]
fn what_whirls_beside_others_keeps_its_energy() {
    for fixed in [0.0, 1.0 / 240.0] {
        let rod = |x: f64, spin: Vec3| {
            let body = inertia(1.0, Vec3::zeros(), [4e-3, 5e-3, 4e-4]);
            let half = Vec3::new(0.02, 0.02, 0.1);
            spinning(body, Shape::Box { half }, x, spin)
        };
        let rods = [
            rod(0.0, Vec3::new(500.0, 60.0, 700.0)),
            rod(0.25, Vec3::new(-30.0, 600.0, 900.0)),
        ];
        let mut model = super::worlds::world(rods);
        model.world.gravity = Vec3::zeros();
        model.solver.step_size = fixed;
        let mut s = start(model, 1e-3);
        let before = s.output(OutputSlot::EnergyKinetic);
        run(&mut s, 0.5, 1.0 / 240.0);
        let gained = s.output(OutputSlot::EnergyKinetic) / before - 1.0;
        assert!(gained.abs() < 1e-10, "step {fixed}: {gained}");
    }
}

/// Boxes drawn by chance whirl beside each other, let go with their centres of mass at rest beside
/// the middle. They keep kinetic and potential energy together, and each centre of mass falls.
#[test]
fn boxes_drawn_by_chance_fall_and_whirl_beside_others_as_if_alone() {
    let random = &mut Random(17);
    let mut worst = Vec::new();
    for world in 0..24 {
        let (mut centers, mut boxes, mut x) = (Vec::new(), Vec::new(), 0.0);
        for _ in 0..2 {
            let half = [(); 3].map(|()| random.uniform(0.03, 0.1));
            let [a, b, c] = half.map(|x| x * x / 3.0);
            let (com, spin) = (random.vector(0.02), random.vector(600.0));
            // It turns about its centre of mass: a centimetre is left between what both sweep.
            let half = Vec3::from(half);
            let reach = half.norm() + com.norm() + 0.005;
            x += reach;
            let body = inertia(1.0, com, [b + c, a + c, a + b]);
            let mut model = spinning(body, Shape::Box { half }, x - com.x, spin);
            model.roots[0].linear_velocity = -spin.cross(&com);
            centers.push(model.roots[0].position + com);
            boxes.push(model);
            x += reach;
        }
        let mut model = super::worlds::world(boxes);
        model.solver.step_size = [0.0, 1.0 / 240.0][world % 2];
        let gravity = model.world.gravity;
        let mut s = start(model, 1e-3);
        let before = energy(&mut s);
        let t = 0.1;
        run(&mut s, t, 1.0 / 240.0);
        let gained = energy(&mut s) / before - 1.0;
        let mut off: f64 = 0.0;
        let mut kin = crate::kinematics::Kinematics::new(s.tree());
        kin.update_poses(s.tree(), &s.state().physical.q);
        for (body, place) in centers.into_iter().enumerate() {
            let now = kin.origins[body] + kin.I[body].center();
            off = off.max((now - (place + gravity * (0.5 * t * t))).norm());
        }
        worst.push([gained.abs(), off]);
    }
    worst.sort_by(|a, b| b[0].total_cmp(&a[0]));
    // One world has a fixed step that one solve takes, which does not know of this. Some of the
    // others have a moment in which nothing is near, and explicit steps.
    for (world, [energy, place]) in [(0, [1e-6, 1e-5]), (1, [3e-9, 1e-13])] {
        let [gained, off] = worst[world];
        assert!(gained < energy && off < place, "{world}: {worst:?}");
    }
}

/// A ball that spins comes no nearer to anything: its spin of 10¹⁰ rad/s stays, and the call comes
/// back.
#[test]
fn what_spins_without_measure_keeps_no_call_waiting() {
    for fixed in [0.0, 1.0 / 240.0] {
        let ball = |x: f64, rate: f64| {
            let body = inertia(1.0, Vec3::zeros(), [4e-3; 3]);
            let spin = Vec3::new(1.0, 2.0, 3.0) * rate;
            spinning(body, Shape::Sphere { radius: 0.1 }, x, spin)
        };
        let mut model = super::worlds::world([ball(0.0, 0.0), ball(0.2001, 1e10)]);
        model.solver.max_steps = 100.0;
        model.solver.step_size = fixed;
        let mut s = start(model, 1e-3);
        // A budget that is used up is an answer, too.
        drop(s.advance_to(1.0 / 240.0));
        let spin = Vec3::from_column_slice(&s.state().physical.v[6..9]);
        assert!((spin.norm() / 1e10 - 14.0_f64.sqrt()).abs() < 1e-6);
    }
}

/// A satellite that tumbles with a wheel at 1000 rad/s, which a velocity motor holds. It is even
/// about the wheel's axis `a`, and so Euler's equations have a closed solution: with the momentum
/// `H` and the moment `A` across the axis, the satellite turns with `H/A` in the world and with
/// `−(H·a/A − ω·a) a` within itself; it nutates with `|H|/A`, 60 rad/s, 9 mrad to both sides.
/// Bounds: an error of a velocity counts by the step, and in 5 s the satellite turns by 300 rad.
#[test]
fn a_satellite_with_a_fast_wheel_nutates_as_eulers_equations_say() {
    let (base, wheel) = ([0.045, 0.045, 0.03], [5e-3, 5e-3, 3e-3]);
    let (across, along) = (base[0] + wheel[0], base[2] + wheel[2]);
    let (spin, turns) = (1000.0, Vec3::new(0.3, 0.4, 0.2));
    let momentum = Vec3::new(
        across * turns.x,
        across * turns.y,
        along * turns.z + wheel[2] * spin,
    );
    let end = 5.0;
    let rotation = |turn: Vec3| UnitQuaternion::from_scaled_axis(turn * end);
    let within = Vec3::z() * (momentum.z / across - turns.z);
    let truth = rotation(momentum / across) * rotation(-within);
    let fixed = [(1.0 / 240.0, 1e-3, 5e-3), (1.0 / 1000.0, 1e-3, 1e-3)];
    let controlled = [1e-5, 1e-6, 1e-7].map(|tolerance| (0.0, tolerance, 500.0 * tolerance));
    for (step, tolerance, bound) in controlled.into_iter().chain(fixed) {
        let mut b = Builder::new(true, inertia(5.0, Vec3::zeros(), base));
        let link = b.link(
            0u32.into_link(),
            Pose::IDENTITY,
            Motion::Revolute(Vec3::z()),
            inertia(1.0, Vec3::zeros(), wheel),
        );
        b.actuator(link, ActuatorMode::Velocity, 1e3);
        b.model.world.gravity = Vec3::zeros();
        b.model.initial.joint_velocities = vec![spin];
        b.model.roots[0].angular_velocity = turns;
        b.model.solver.step_size = step;
        let mut s = start(b.model, tolerance);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), spin);
        run(&mut s, end, 1.0 / 240.0);
        let q = &s.state().physical.q;
        let found = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[4], q[5], q[6]));
        let off = found.angle_to(&truth);
        assert!(off < bound, "{step} {tolerance}: {off}");
    }
}
