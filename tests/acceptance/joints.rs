//! B: joints and motors.

use super::*;

/// A slide along `axis` with a mass on it.
fn slide(axis: Vec3, mass: f64) -> (Builder, LinkId) {
    let mut b = fixed();
    let body = inertia(mass, Vec3::zeros(), [1e-3 * mass; 3]);
    let link = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(axis), body);
    (b, link)
}

/// A slide along x with a pd actuator of unlimited effort.
fn spring(mass: f64, kp: f64, kd: f64) -> Builder {
    let (mut b, link) = slide(X, mass);
    b.actuator(link, ActuatorMode::Pd, f64::INFINITY);
    b.model.actuators[0].kp = kp;
    b.model.actuators[0].kd = kd;
    b.model.actuators[0].reference_effort = 1.0;
    b
}

/// B1. A mass on a spring with dry friction: each half cycle is 2 F/k shorter than the last, until
/// the spring is weaker than friction at a turning point; then it stays (Den Hartog, Mechanical
/// Vibrations, §1.7).
#[test]
fn b1_dry_friction_takes_two_f_over_k_off_each_half_cycle_and_then_holds_for_an_hour() {
    let (mass, k, friction) = (1.0, 100.0, 2.0);
    let mut b = spring(mass, k, 0.0);
    b.model.joints[0].friction = friction;
    b.model.initial.joint_positions[0] = 0.19;
    let model = b.model;
    for ((rules, name), drifts) in REST.into_iter().zip([0.0, 4e-13]) {
        hold_turns_and_drift(model.clone(), (mass, k), (rules, name), drifts);
    }
}

/// The rows of B1 under some rules.
fn hold_turns_and_drift(
    model: Model,
    (mass, k): (f64, f64),
    (rules, name): (Rules, &str),
    allowed: f64,
) {
    let mut s = start(model, 1e-4);
    s.set_rules(rules);
    s.set_input(InputSlot::Position(ActuatorId(0)), 0.0);
    let half = std::f64::consts::PI * (mass / k).sqrt();
    // 0.19, −0.15, 0.11, −0.07, 0.03, and there 0.03·100 N = 3 N still move it: to 0.01 on the
    // other side.
    let mut worst = 0.0_f64;
    for (i, turn) in [-0.15, 0.11, -0.07, 0.03, 0.01].iter().enumerate() {
        run(&mut s, half * (i + 1) as f64, half / 50.0);
        worst = worst.max((s.state().physical.q[0] - turn).abs());
    }
    hold(
        "B1",
        &format!("turning points, m, tol 1e-4{name}"),
        "2F/k less each half cycle; Den Hartog §1.7",
        worst,
        9e-5,
    );
    run(&mut s, 10.0, 0.01);
    let rest = s.state().physical.q[0];
    run(&mut s, 3610.0, 1.0);
    let drift = s.state().physical.q[0] - rest;
    hold(
        "B1",
        &format!("drift in one hour, m, spring against friction{name}"),
        "0",
        drift,
        allowed,
    );
}

/// B2. Cart with a force-limited velocity motor: 5 kg, wheel 0.5 kg disc R = 0.1 m, 0.5 N·m, 10
/// rad/s: a = F/R/(M + I/R²) = 0.8695652 until 1 m/s, so x(3) = 1.15²·a/2 + 1.85 = 2.425.
#[test]
fn b2_a_velocity_motor_drives_a_cart_with_its_effort_and_then_holds_its_speed() {
    let (mut b, cart) = slide(X, 5.0);
    let lift = inertia(1e-6, Vec3::zeros(), [1e-6; 3]);
    let lift = b.link(cart, Pose::IDENTITY, Motion::Prismatic(Z), lift);
    let disc = inertia(0.5, Vec3::zeros(), [0.0025; 3]);
    let hub = b.link(lift, at(0.0, 0.0, 0.1), Motion::Revolute(Y), disc);
    let across = Pose::from_xyz_rpy(Vec3::zeros(), X * std::f64::consts::FRAC_PI_2);
    let wheel = Shape::Cylinder {
        radius: 0.1,
        half_length: 0.05,
    };
    b.shape(hub, wheel, across);
    b.actuator(hub, ActuatorMode::Velocity, 0.5);
    // Only the wheel's own weight presses on the ground: enough friction to carry 5 N all the same.
    b.model.links[hub.index()].friction = 3.0;
    b.model.world.ground = Some(ground(3.0));
    let mut s = start(b.model, 1e-4);
    run(&mut s, 0.2, 1.0 / 240.0);
    let (x0, t0) = (s.state().physical.q[0], s.time());
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 10.0);
    run(&mut s, t0 + 0.5, 1.0 / 240.0);
    let a = s.state().physical.v[0] / 0.5;
    hold(
        "B2",
        "acceleration, m/s², tol 1e-4",
        "F/R/(M + I/R²)",
        a - 0.5 / 0.1 / 5.75,
        4e-7,
    );
    let mut fastest = 0.0_f64;
    while s.time() < t0 + 3.0 - 1e-9 {
        let next = s.time() + 1.0 / 240.0;
        s.advance_to(next).expect("finite");
        fastest = fastest.max(s.state().physical.v[0]);
    }
    let x = s.state().physical.q[0] - x0;
    hold(
        "B2",
        "x after 3 s, m, tol 1e-4",
        "2.425, by hand",
        x - 2.425,
        1.4e-4,
    );
    hold(
        "B2",
        "overshoot, m/s",
        "none",
        (fastest - 1.0).max(0.0),
        1.5e-10,
    );
}

/// B3. A rotor under a saturated pd law reaches ω after J ω/e: full effort until the law leaves
/// saturation.
#[test]
fn b3_a_saturated_rotor_takes_j_omega_over_e() {
    let (J, effort, target, kd) = (0.02, 0.5, 30.0, 10.0);
    let mut b = fixed();
    let rotor = inertia(1.0, Vec3::zeros(), [J; 3]);
    let link = b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), rotor);
    b.actuator(link, ActuatorMode::Pd, effort);
    b.model.actuators[0].kd = kd;
    for (direction, name) in [(1.0, "forward"), (-1.0, "backward")] {
        let mut s = start(b.model.clone(), 1e-4);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), direction * target);
        // Saturated while kd (target − ω) > effort; looked at just before.
        let leaves = J * (target - effort / kd) / effort;
        run(&mut s, 0.99 * leaves, 0.05);
        let late = (0.99 * leaves * effort / J - direction * s.state().physical.v[0]) * J / effort;
        let quantity = format!("time to speed, relative, {name}, tol 1e-4");
        hold("B3", &quantity, "J ω/e", late / leaves, 2e-14);
        run(&mut s, 2.0 * leaves, 0.05);
        let error = direction * s.state().physical.v[0] - target;
        hold("B3", "final speed, rad/s", "the command", error, 0.0);
    }
}

/// B4. Kp = 1e6, Kd = 1e3 on a gram, communication steps of 0.1 s.
#[test]
fn b4_a_stiff_pd_on_a_gram_is_stable_at_a_tenth_of_a_second() {
    let mut s = start(spring(1e-3, 1e6, 1e3).model, 1e-4);
    s.set_input(InputSlot::Position(ActuatorId(0)), 0.3);
    let mut highest = 0.0_f64;
    for i in 1..=10 {
        s.advance_to(0.1 * f64::from(i)).expect("finite");
        highest = highest.max(s.state().physical.q[0]);
    }
    hold(
        "B4",
        "final position, m",
        "the command",
        s.state().physical.q[0] - 0.3,
        0.0,
    );
    hold("B4", "overshoot, m", "none", (highest - 0.3).max(0.0), 0.0);
}

/// B5. A velocity motor with half its effort as load: no error of the speed, no creep when told to
/// stand.
#[test]
fn b5_a_loaded_velocity_motor_keeps_its_speed_and_its_place() {
    let mass = 1.0;
    let (mut b, link) = slide(Z, mass);
    b.actuator(link, ActuatorMode::Velocity, 2.0 * mass * G);
    for (speed, quantity) in [(0.2, "rising"), (-0.2, "sinking")] {
        let mut s = start(b.model.clone(), 1e-4);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), speed);
        run(&mut s, 5.0, 0.01);
        let quantity = format!("speed under half the effort, {quantity}, m/s");
        hold(
            "B5",
            &quantity,
            "the command",
            s.state().physical.v[0] - speed,
            4e-10,
        );
    }
    for ((rules, name), allowed) in REST.into_iter().zip([0.0, 2e-11]) {
        let mut s = start(b.model.clone(), 1e-4);
        s.set_rules(rules);
        run(&mut s, 5.0, 0.01);
        let place = s.state().physical.q[0];
        run(&mut s, 3605.0, 1.0);
        let drift = s.state().physical.q[0] - place;
        let what = format!("drift in one hour under half the effort, m{name}");
        hold("B5", &what, "0", drift, allowed);
    }
}

/// Rebound speed times dissipation of a Hunt–Crossley contact met at `a`/d: the root of
/// `a − ln(1 + a) = −b − ln(1 − b)` (the exact solution of m v dv = −k x (1 + d v) dx).
fn rebound(a: f64) -> f64 {
    let target = a - a.ln_1p();
    let (mut low, mut high) = (0.0_f64, 1.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if -middle - (-middle).ln_1p() < target {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// B6. A joint limit hit at 1 m/s throws back as Hunt and Crossley's law says, and carries a static
/// load at its stiffness.
#[test]
fn b6_a_limit_rebounds_by_its_law_and_carries_a_load_at_its_stiffness() {
    let (mut b, link) = slide(X, 2.0);
    b.limits(link, -1.0, 0.1);
    b.model.initial.joint_velocities[0] = 1.0;
    for (tolerance, allowed) in [(1e-4, 6e-6), (1e-6, 9e-8)] {
        let mut s = start(b.model.clone(), tolerance);
        run(&mut s, 0.5, 0.01);
        let d = s.tree().contact.dissipation;
        let error = s.state().physical.v[0] + rebound(d * 1.0) / d;
        let quantity = format!("rebound speed at 1 m/s, m/s, tol {tolerance:.0e}");
        hold("B6", &quantity, "Hunt & Crossley, exact", error, allowed);
    }
    let (mut b, link) = slide(Z, 2.0);
    b.limits(link, -0.1, 0.1);
    let mut s = start(b.model, 1e-4);
    run(&mut s, 3.0, 0.01);
    let deflection = -0.1 - s.state().physical.q[0];
    let error = deflection / (2.0 * G / s.tree().dofs.limit_stiffness[0]) - 1.0;
    hold(
        "B6",
        "deflection under a load, relative",
        "m g/k",
        error,
        1e-8,
    );
}

/// B7. A pd law that follows a ramp and knows its speed has no lag. The ramp comes as samples, each
/// for the middle of its communication step; the sign of the kd term would show as a lag of 2 kd
/// c/kp = 40 mm.
#[test]
fn b7_a_pd_law_follows_a_ramp_without_lag() {
    let (c, h) = (0.5, 1e-3);
    let mut s = start(spring(1.0, 100.0, 4.0).model, 1e-4);
    s.set_input(InputSlot::Velocity(ActuatorId(0)), c);
    let mut worst = 0.0_f64;
    for i in 0..10_000 {
        let t = f64::from(i) * h;
        s.set_input(InputSlot::Position(ActuatorId(0)), c * (t + 0.5 * h));
        s.advance_to(t + h).expect("finite");
        if t > 8.0 {
            worst = worst.max((s.state().physical.q[0] - c * (t + h)).abs());
        }
    }
    hold("B7", "lag behind a ramp, m, tol 1e-4", "0", worst, 4e-8);
}

/// B8. A gripper whose second finger mimics the first, driven by a servo and loaded unevenly: exact
/// at every step.
#[test]
fn b8_a_mimic_finger_follows_exactly() {
    let (mut b, finger) = slide(X, 0.1);
    let other = inertia(0.3, Y * 0.05, [1e-4; 3]);
    let other = b.link(BASE, at(0.0, 0.1, 0.0), Motion::Prismatic(-X), other);
    b.mimic(other, finger, 0.75, 0.01);
    b.limits(finger, 0.0, 0.04);
    b.actuator(finger, ActuatorMode::Position, 20.0);
    b.model.world.gravity = Vec3::new(3.0, 0.0, -9.0);
    let mut s = start(b.model, 1e-4);
    let mut worst = 0.0_f64;
    for i in 1..=400 {
        let target = if i % 100 < 50 { 0.035 } else { 0.002 };
        s.set_input(InputSlot::Position(ActuatorId(0)), target);
        s.advance_to(f64::from(i) / 240.0).expect("finite");
        let leader = s.output(OutputSlot::JointPosition(JointId(0), 0));
        let follower = s.output(OutputSlot::JointPosition(JointId(1), 0));
        worst = worst.max((follower - 0.75 * leader - 0.01).abs());
    }
    hold("B8", "q_m less a q_s + b, m", "0", worst, 5e-18);
}

/// B9. A rotor of inertia I_r behind a gear n adds n² I_r: q = τ t²/(2 (I + n² I_r)).
#[test]
fn b9_a_geared_rotor_adds_its_inertia_times_the_ratio_squared() {
    let (I, gear, rotor, torque) = (0.05, 30.0_f64, 1e-4, 1.4);
    let mut b = fixed();
    let body = inertia(1.0, Vec3::zeros(), [I; 3]);
    let link = b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), body);
    b.model.joints[0].armature = gear * gear * rotor;
    b.actuator(link, ActuatorMode::Effort, 10.0);
    let mut s = start(b.model, 1e-4);
    s.set_input(InputSlot::Effort(ActuatorId(0)), torque);
    run(&mut s, 2.0, 0.01);
    let a = torque / (I + gear * gear * rotor);
    let error = s.state().physical.q[0] / (0.5 * a * 4.0) - 1.0;
    hold(
        "B9",
        "angle after 2 s, relative, tol 1e-4",
        "τ t²/(2(I + n² I_r))",
        error,
        2e-15,
    );
    let error = s.state().physical.v[0] / (a * 2.0) - 1.0;
    hold(
        "B9",
        "speed after 2 s, relative",
        "τ t/(I + n² I_r)",
        error,
        6e-16,
    );
}
