//! Fixed steps and error control solve the same equations, so their results agree.

use super::*;

/// Positions at `end`, in fixed steps of `step` seconds or, where that is 0, under error control.
fn end(model: &Model, command: Option<f64>, (step, tolerance): (f64, f64), end: f64) -> Vec<f64> {
    let mut model = model.clone();
    model.solver.step_size = step;
    let mut s = start(model, tolerance);
    if let Some(speed) = command {
        s.set_input(InputSlot::Velocity(ActuatorId(0)), speed);
    }
    run(&mut s, end, 1.0 / 60.0);
    s.state().physical.q.clone()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

/// A block lands on an edge and tumbles: corners that hold slip for an instant at the blows of
/// others, for less than any of these steps. The expected place is that of error control at 1e-8.
/// Positions move with the velocity of a step's end and a blow begins within a step: first order at
/// best, and a sixteenth of the step must leave less than a quarter of the error, in the geometric
/// mean of five neighbouring steps. When the stored displacement jumped with the slip's speed, it
/// left six tenths.
#[test]
fn fixed_steps_agree_with_error_control_where_corners_slip_briefly() {
    let mut b = block(1.0, 0.8);
    b.model.roots[0].position.z = 0.16;
    b.model.roots[0].rpy.y = 0.4;
    b.model.roots[0].linear_velocity = Vec3::new(1.0, 0.0, -1.0);
    let exact = end(&b.model, None, (0.0, 1e-8), 0.4);
    let error = |mode| distance(&end(&b.model, None, mode, 0.4), &exact);
    let mean = |rate: f64| {
        let errors = [0.25, 0.5, 1.0, 2.0, 4.0].map(|n| error((1.0 / (n * rate), 1e-3)));
        libm::pow(errors.iter().product(), 0.2)
    };
    let [coarse, fine] = [960.0, 15360.0].map(mean);
    assert!(fine < 0.25 * coarse, "{fine} {coarse}");
    let controlled = error((0.0, 1e-5));
    assert!(controlled < 1e-3, "{controlled}");
}

/// A rotor reaches its speed of 10 rad/s in `J ω/e = 10 µs`, in which it falls behind by half of
/// 0.1 mrad; longer steps take it to its speed at once, and leave that out. Beside it the motor
/// gives by 1 mrad, its deflection under its effort.
#[test]
fn fixed_steps_agree_with_error_control_where_a_motor_jumps_to_its_speed() {
    let (J, effort, speed) = (1e-6, 1.0, 10.0);
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let rotor = inertia(1.0, Vec3::zeros(), [1.0, 1.0, J]);
    let base = 0u32.into_link();
    let link = b.link(base, Pose::IDENTITY, Motion::Revolute(Vec3::z()), rotor);
    b.actuator(link, ActuatorMode::Velocity, effort);
    let left_out = 0.5 * speed * J * speed / effort;
    let controlled = end(&b.model, Some(speed), (0.0, 1e-8), 0.1)[0];
    for n in [60.0, 240.0, 960.0, 7680.0] {
        let fixed = end(&b.model, Some(speed), (1.0 / n, 1e-3), 0.1)[0];
        let ahead = fixed - controlled;
        assert!((ahead - left_out).abs() < 0.1 * left_out, "{n}: {ahead}");
    }
}
