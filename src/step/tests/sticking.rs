//! Friction that is higher at rest, under loads that set in at once: it holds what it can hold.
//!
//! Before, the elastic yield of what sticks counted as sliding, so that friction at rest was lost
//! where a load stretched its spring faster than Stribeck's speed: an arm of 2 kg fell under 0.7 of
//! what holds it, and a box slid off under a force that jumped to 0.9 of it.

use super::*;

/// A slider of `mass`, kg, along x, without weight; `friction`, N, moving and at rest.
fn slider(mass: f64, [moving, at_rest]: [f64; 2], stribeck: f64) -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let link = b.link(
        LinkId::from(0),
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::x()),
        inertia(mass, Vec3::zeros(), [mass; 3]),
    );
    b.actuator(link, ActuatorMode::Effort, 1e3);
    let joint = &mut b.model.joints[0];
    (joint.friction, joint.static_excess) = (moving, at_rest / moving - 1.0);
    joint.stribeck_velocity = stribeck;
    b.model.world.gravity = Vec3::zeros();
    b.model
}

/// A force that jumps to 0.85 of what friction at rest holds, or grows to it in 20 ms, on sliders
/// of 0.1 to 100 kg. Truth: Coulomb; the spring of friction yields by 0.1 mm under moving friction.
/// Its damper is critical and has it pull with 1.14 of a load that jumps, so that more than 0.88 of
/// what is held may break away.
#[test]
fn friction_at_rest_holds_a_load_that_sets_in_at_once() {
    for mass in [0.1, 1.0, 100.0] {
        for (step, tolerance) in [(0.0, 1e-3), (0.0, 1e-5), (1.0 / 240.0, 1e-3)] {
            for ramp in [0.0, 0.02] {
                // The spring swings faster than such steps follow.
                if mass < 1.0 && step > 0.0 {
                    continue;
                }
                let mut model = slider(mass, [3.0, 5.0], 0.01);
                model.solver.step_size = step;
                let mut s = start(model, tolerance);
                for i in 1..=120 {
                    let t = f64::from(i) / 240.0;
                    let share = if t < ramp { t / ramp } else { 1.0 };
                    s.set_input(InputSlot::Effort(ActuatorId(0)), 0.85 * 5.0 * share);
                    s.advance_to(t).expect("finite");
                }
                let way = s.state().physical.q[0];
                let name = format!("{mass} kg, step {step}, {tolerance}, {ramp} s");
                assert!((1.4e-4..2.5e-4).contains(&way), "{name}: {way} m");
            }
        }
    }
}

/// A mass on a spring that is drawn along at 0.1 m/s sticks and slips. Truth: the equation of the
/// slip, `m ẍ = k (V t − x) − F(ẋ)`, by Heun's method from where the spring holds friction at rest
/// to where the mass stands, and the time in which the spring is stretched again.
#[test]
fn stick_and_slip_have_the_period_of_their_equation() {
    let (mass, stiffness, speed, stribeck) = (10.0, 2000.0, 0.1, 1e-3);
    let [moving, at_rest] = [20.0, 40.0];
    let friction = |v: f64| {
        let x = v / stribeck;
        moving + (at_rest - moving) * libm::exp(-x * x)
    };
    let rate = |pull: f64, v: f64| (pull - friction(v)) / mass;
    let (mut pull, mut v, mut time) = (at_rest, 1e-6_f64, 0.0);
    let dt = 1e-6;
    while v > 0.0 {
        let a = rate(pull, v);
        let there = pull + dt * stiffness * (speed - v);
        let then = v + dt * a;
        pull += 0.5 * dt * stiffness * (2.0 * speed - v - then);
        v += 0.5 * dt * (a + rate(there, then));
        time += dt;
    }
    let period = time + (at_rest - pull) / (stiffness * speed);
    for (step, tolerance) in [(0.0, 1e-3), (0.0, 1e-5), (1e-3, 1e-3)] {
        let mut model = slider(mass, [moving, at_rest], stribeck);
        model.solver.step_size = step;
        model.actuators[0].mode = ActuatorMode::Pd;
        model.actuators[0].kp = stiffness;
        let mut s = start(model, tolerance);
        let (mut slips, mut fast) = (Vec::new(), false);
        for i in 1..=3000 {
            let t = f64::from(i) * 1e-3;
            s.set_input(InputSlot::Position(ActuatorId(0)), speed * t);
            s.advance_to(t).expect("finite");
            let now = s.state().physical.v[0] > 0.1;
            if now && !fast {
                slips.push(t);
            }
            fast = now;
        }
        let found = (slips[slips.len() - 1] - slips[1]) / (slips.len() - 2) as f64;
        let error = found / period - 1.0;
        assert!(error.abs() < 0.02, "{error} at {step}, {tolerance}");
    }
}

/// A box that a force of 0.85 of its friction at rest pulls all at once. Truth: Coulomb.
#[test]
fn a_box_stays_under_a_force_that_sets_in_at_once() {
    for (step, tolerance) in [(0.0, 1e-3), (0.0, 1e-5), (1.0 / 240.0, 1e-3)] {
        let half = Vec3::new(0.1, 0.1, 0.02);
        let mut model = super::worlds::body(1.0, Shape::Box { half }, Vec3::new(0.0, 0.0, 0.02));
        model.links[0].friction = 0.5;
        model.links[0].static_excess = 0.6;
        if let Some(ground) = &mut model.world.ground {
            (ground.friction, ground.static_excess) = (0.5, 0.6);
        }
        model.solver.step_size = step;
        let mut s = start(model, tolerance);
        run(&mut s, 0.2, 1.0 / 240.0);
        let pull = 0.85 * 0.8 * 9.81;
        s.set_parameter(ParameterSlot::Gravity(0), pull);
        let before = s.state().physical.q[0];
        for i in 1..=120 {
            s.advance_to(0.2 + f64::from(i) / 240.0).expect("finite");
        }
        let way = s.state().physical.q[0] - before;
        assert!(way.abs() < 1e-3, "{way} m at {step}, {tolerance}");
    }
}
