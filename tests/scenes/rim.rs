//! Cans, discs and coins that roll on their edge without slip.

use super::truth::{Rolling, Rolls};
use super::{H, Run, Scene, Solver, base_place, figure, idle, play, single};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_core::spatial::{Mat3, Vec3, rotation_from_quaternion, rpy_from_rotation};

/// A body that starts as the exact motion does, sunk as deep as an edge sinks.
pub fn model(body: &Rolling, start: &Rolls, mu: f64) -> Model {
    let shape = Shape::Cylinder {
        radius: body.radius,
        half_length: body.height,
    };
    let diagonal = [body.across, body.across, body.along];
    let mut b = single(body.mass, diagonal, shape, mu);
    let (k, w) = (
        Vec3::new(start[0], start[1], start[2]),
        Vec3::new(start[3], start[4], start[5]),
    );
    let y = k.cross(&Vec3::x()).normalize();
    let turn = Mat3::from_columns(&[y.cross(&k), y, k]);
    let initial = &mut b.model.roots[0];
    initial.position = Vec3::new(start[6], start[7], start[8]);
    initial.position.z -= 0.7 * b.model.contact.penetration;
    initial.rpy = rpy_from_rotation(&turn);
    initial.angular_velocity = w;
    initial.linear_velocity = body.arm(&k).cross(&w);
    b.model
}

/// The axis of the body, and where the origin of its link is.
pub fn axis_and_centre(s: &mut Simulation) -> (Vec3, Vec3) {
    let place = base_place(s);
    let q = &s.state().physical.q;
    let R = rotation_from_quaternion(&[q[3], q[4], q[5], q[6]]);
    (R.column(2).into(), Vec3::from(place))
}

/// Runs a body that should go round steadily by `rate`; sees the angle by which its axis has gone
/// round, the largest error of its lean and that of its axis, and the place at the end.
fn go_round(body: Rolling, start: Rolls, rate: f64, mu: f64, end: f64, solver: Solver) -> Run {
    let first = Vec3::new(start[0], start[1], start[2]);
    let (mut before, mut round, mut lean, mut off) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    let azimuth = libm::atan2(first.y, first.x);
    let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
        let (k, place) = axis_and_centre(s);
        let now = libm::atan2(k.y, k.x) - azimuth;
        let step: f64 = now - before;
        round += step - std::f64::consts::TAU * (step / std::f64::consts::TAU).round();
        before = now;
        let (sin, cos) = libm::sincos(rate * s.time());
        let exact = Vec3::new(
            cos * first.x - sin * first.y,
            sin * first.x + cos * first.y,
            first.z,
        );
        let angle = |z: f64| libm::acos(z.clamp(-1.0, 1.0));
        lean = lean.max((angle(k.z) - angle(first.z)).abs());
        off = off.max(2.0 * libm::asin((0.5 * (k - exact).norm()).min(1.0)));
        *seen = vec![round, lean, off, place.x, place.y, place.z];
        true
    };
    play(
        model(&body, &start, mu),
        solver,
        [H, end],
        &mut idle,
        &mut watch,
    )
}

/// A can of 1 kg whose centre of mass lies `tall` radii above its edge, rolling on that edge with
/// its axis `lean` degrees from upright and its centre of mass at rest.
///
/// With `r = −h k + R e` from the centre to the contact, the centre rests if `ω = λ r`. The axis
/// then goes round by `Ω = −λR/sin θ`, and with the weight's moment `m g r_x` the momentum
/// `−λ h I₃ k + λ R I₁ e` goes round with it:
/// `λ² = m g (R cos θ − h sin θ) sin θ/(R (R I₁ cos θ − h I₃ sin θ))`.
pub fn can(radius: f64, tall: f64, lean: f64) -> Scene {
    let h = tall * radius;
    let body = Rolling::cylinder(1.0, radius, h);
    let (sin, cos) = libm::sincos(lean.to_radians());
    let fast = body.mass * super::G * (radius * cos - h * sin) * sin
        / (radius * (radius * body.across * cos - h * body.along * sin));
    let lambda = fast.sqrt();
    let rate = -lambda * radius / sin;
    // Five times round.
    let end = ((5.0 * std::f64::consts::TAU / rate.abs()) / H).ceil() * H;
    let k = Vec3::new(sin, 0.0, cos);
    let start = body.start(&k, &(body.arm(&k) * lambda));
    let simulate = move |solver| go_round(body, start, rate, 0.8, end, solver);
    let judge = move |_: Solver, run: &Run| {
        let seen = run.seen_or_nan(6);
        vec![
            figure(
                "phase after 5 turns, relative",
                seen[0] / (rate * end) - 1.0,
                0.02,
            ),
            figure("lean, rad", seen[1], None),
        ]
    };
    Scene {
        name: format!("can R {radius:.3} m, h {tall:.2} R, on its rim at {lean:.1}°"),
        source: "steady rolling, closed form",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A thin disc of 0.15 m, 3 mm and 0.1 kg that rolls at `speed` m/s leaning by 20° for 8 m:
/// steadily, or wobbling because its lean begins off by `wobble` rad.
pub fn disc(speed: f64, wobble: f64) -> Scene {
    Scene {
        name: format!("disc leaning 20°, {speed} m/s, wobble {wobble} rad"),
        ..disc_of(0.15, 20.0, speed, wobble)
    }
}

/// The same with this radius, m, and lean, degrees.
pub fn disc_of(radius: f64, lean: f64, speed: f64, wobble: f64) -> Scene {
    let body = Rolling::cylinder(0.1, radius, 0.01 * radius);
    let lean = lean.to_radians();
    let axis = |lean: f64| Vec3::new(libm::cos(lean), 0.0, libm::sin(lean));
    let spin = speed / body.radius;
    let rate = body.steady(&axis(lean), spin);
    let start = {
        let k = axis(lean);
        let w = Vec3::z() * rate + k * spin;
        // The same turning with the disc a little flatter.
        let k = axis(lean + wobble);
        body.start(&k, &w)
    };
    let end = (8.0 / speed / H).round() * H;
    let simulate = move |solver| go_round(body, start, rate, 0.8, end, solver);
    let judge = move |_: Solver, run: &Run| {
        let seen = run.seen_or_nan(6);
        let exact = body.after(start, end);
        let place = (seen[3] - exact[6]).hypot(seen[4] - exact[7]);
        if wobble > 0.0 {
            vec![figure("place after 8 m, m", place, 0.02)]
        } else {
            vec![
                figure(
                    "phase after 8 m, relative",
                    seen[0] / (rate * end) - 1.0,
                    0.02,
                ),
                figure("lean, rad", seen[1], None),
                figure("place after 8 m, m", place, None),
            ]
        }
    };
    Scene {
        name: format!("disc R {radius:.3} m, {speed:.2} m/s, wobble {wobble:.3} rad"),
        source: "rolling without slip, Runge–Kutta in steps of 0.1 ms",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A coin of 12.5 mm, 2 mm and 10 g that rolls leaning by 20° with a spin of 60 rad/s for 4 s.
pub fn coin() -> Scene {
    let body = Rolling::cylinder(0.01, 0.0125, 1e-3);
    let lean = 20.0_f64.to_radians();
    let k = Vec3::new(libm::cos(lean), 0.0, libm::sin(lean));
    let rate = body.steady(&k, 60.0);
    let start = body.start(&k, &(Vec3::z() * rate + k * 60.0));
    let simulate = move |solver| go_round(body, start, rate, 0.9, 4.0, solver);
    let judge = move |solver: Solver, run: &Run| {
        let seen = run.seen_or_nan(6);
        let asked = match solver {
            Solver::Tolerance(t) if t < 3e-6 => 0.015,
            _ => 0.03,
        };
        let most = match solver {
            Solver::Tolerance(t) if t > 3e-4 => Some(1000.0),
            Solver::Tolerance(t) if t < 3e-6 => Some(15_000.0),
            _ => None,
        };
        vec![
            figure("axis off, rad", seen[2], solver.pick(None, Some(asked))),
            figure(
                "phase after 4 s, relative",
                seen[0] / (rate * 4.0) - 1.0,
                0.02,
            ),
            figure("steps", run.steps, most),
        ]
    };
    Scene {
        name: "coin leaning 20°, 60 rad/s, 4 s".into(),
        source: "steady rolling, root of the exact equations",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}
