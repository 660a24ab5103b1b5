//! Springs: pd laws inside their limits and beyond them.

use super::truth::Law;
use super::{
    BASE, G, H, Run, Scene, Solver, X, Z, figure, fixed, last, play, single, target, truth,
};
use crate::testing::{Builder, at, inertia};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{ActuatorMode, LinkId, Motion};
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_core::spatial::{Pose, Vec3};

/// A pd law on the joint of a link, without a limit of its effort.
fn pd(b: &mut Builder, link: LinkId, kp: f64, kd: f64, max_effort: f64) {
    b.actuator(link, ActuatorMode::Pd, max_effort);
    let actuator = b.model.actuators.last_mut().expect("just added");
    (actuator.kp, actuator.kd) = (kp, kd);
}

/// Position and velocity of the coordinate and degree of freedom at `place`.
fn phase(place: [usize; 2]) -> impl Fn(&Simulation) -> Vec<f64> {
    move |s| {
        let state = &s.state().physical;
        vec![state.q[place[0]], state.v[place[1]]]
    }
}

/// Amplitude and phase of an oscillation `x = A e^(−δ t) cos(ω t)`-like: the vector
/// `(x, −(v + δ x)/ω)`, which turns by `ω t` and shrinks by `e^(−δ t)`.
fn turned(seen: &[f64], omega: f64, decay: f64) -> (f64, f64) {
    let (x, y) = (seen[0], -(seen[1] + decay * seen[0]) / omega);
    (x.hypot(y), libm::atan2(y, x))
}

/// How far the phase `angle` is from `expected`, as a share of `expected`.
fn late(angle: f64, expected: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let off = angle - expected;
    (off - turn * (off / turn).round()) / expected
}

/// `mass` kg on a horizontal spring of a pd law, of frequency `f` in Hz and damping ratio `zeta`,
/// released at 5 cm.
pub fn spring(mass: f64, f: f64, zeta: f64) -> Scene {
    let omega = std::f64::consts::TAU * f;
    // Until it has lost all but a twentieth, at most 10 s; whole communication steps.
    let end: f64 = if zeta > 0.0 {
        3.0 / (zeta * omega)
    } else {
        10.0
    };
    let end = ((end.min(10.0) / H).round() * H).max(H);
    let simulate = move |solver| {
        let mut b = fixed();
        let body = inertia(mass, Vec3::zeros(), [1e-3 * mass; 3]);
        let link = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(X), body);
        let (kp, kd) = (mass * omega * omega, 2.0 * mass * zeta * omega);
        pd(&mut b, link, kp, kd, 1e6);
        b.model.initial.joint_positions = vec![0.05];
        play(
            b.model,
            solver,
            [H, end],
            &mut target(0, 0.0),
            &mut last(phase([0, 0])),
        )
    };
    let judge = move |solver: Solver, run: &Run| {
        let decay = zeta * omega;
        let fast = omega * (1.0 - zeta * zeta).sqrt();
        let (first, begin) = turned(&[0.05, 0.0], fast, decay);
        let (size, angle) = turned(&run.seen_or_nan(2), fast, decay);
        // Fixed steps are asked for frequencies of up to 5 Hz.
        let asked = |share: f64| (solver.tolerances(1.0).is_some() || f <= 5.0).then_some(share);
        let period = figure(
            "period, relative",
            late(angle - begin, fast * end),
            asked(1e-3),
        );
        if zeta > 0.0 {
            let ratio = libm::log(first / size) / (decay * end) - 1.0;
            vec![
                figure("damping ratio, relative", ratio, asked(0.05)),
                period,
            ]
        } else {
            let lost = asked(solver.pick(0.02, 0.01));
            vec![
                figure("amplitude, relative", size / first - 1.0, lost),
                period,
            ]
        }
    };
    Scene {
        name: format!("spring {mass:.2} kg, {f:.2} Hz, ζ {zeta:.3}, {end:.1} s"),
        source: "x'' = −ω² x − 2ζω x'",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// 20 kg on a vertical leg with a pd law of 3 Hz above a foot of 1 kg that stands on the ground,
/// compressed by 2 cm. The foot stays down: the spring always presses.
pub fn sprung_foot() -> Scene {
    let omega = std::f64::consts::TAU * 3.0;
    let (kp, end) = (20.0 * omega * omega, 10.0);
    let rest = -20.0 * G / kp;
    let simulate = move |solver| {
        let half = Vec3::new(0.1, 0.1, 0.025);
        let mut b = single(1.0, [4e-3; 3], Shape::Box { half }, 0.8);
        let body = inertia(20.0, Vec3::zeros(), [0.5; 3]);
        let link = b.link(BASE, at(0.0, 0.0, 0.3), Motion::Prismatic(Z), body);
        pd(&mut b, link, kp, 0.0, 1e4);
        b.model.roots[0].position.z = 0.025 - 0.5 * b.model.contact.penetration;
        b.model.initial.joint_positions = vec![rest - 0.02];
        play(
            b.model,
            solver,
            [H, end],
            &mut target(0, 0.0),
            &mut last(phase([7, 6])),
        )
    };
    let judge = move |_: Solver, run: &Run| {
        let seen = run.seen_or_nan(2);
        // The ground gives way by 1e-3 of what the spring does. The foot's depth, the spring's
        // length from its target, and their rates; dissipation as the default.
        let law = Law::new(21.0 * G, 1e-4);
        let rates = |x: &[f64; 4]| {
            let [depth, length, sinks, grows] = *x;
            let ground = law.force(depth, 1.0) * (1.0 + 51.0 * sinks).max(0.0);
            let sinking = G + kp * -length - ground;
            [sinks, grows, sinking, -kp * length / 20.0 - G + sinking]
        };
        let start = [0.5e-4, rest - 0.02, 0.0, 0.0];
        let exact = truth::runge_kutta(rates, start, end, 500_000);
        let of = |length: f64, rate: f64| turned(&[length - rest, rate], omega, 0.0);
        let (size, angle) = of(seen[0], seen[1]);
        let (expected, end_angle) = of(exact[1], exact[3]);
        // Both phases are known up to whole turns; they are compared at the end.
        let off = late(angle - end_angle + omega * end, omega * end);
        vec![
            figure("amplitude, relative", size / expected - 1.0, 0.01),
            figure("period, relative", off, 1e-3),
        ]
    };
    Scene {
        name: "sprung foot 3 Hz, 10 s".into(),
        source: "two masses on the law of stiffness, Runge–Kutta in steps of 20 µs",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A rotor under a pd law with an effort limit, whose target jumps.
#[derive(Clone, Copy, Debug)]
pub struct Servo {
    /// kg·m²
    pub moment: f64,
    /// N·m/rad
    pub kp: f64,
    /// N·m·s/rad
    pub kd: f64,
    /// N·m
    pub most: f64,
    /// rad
    pub jump: f64,
}

/// A rotor of 0.05 kg·m² under a pd law of 1500 N·m/rad and 7 N·m·s/rad with at most 3 N·m, whose
/// target jumps by `jump`, rad.
pub fn saturated(jump: f64) -> Scene {
    let servo = Servo {
        moment: 0.05,
        kp: 1500.0,
        kd: 7.0,
        most: 3.0,
        jump,
    };
    Scene {
        name: format!("saturated pd, jump {jump} rad"),
        ..servo.scene()
    }
}

impl Servo {
    /// Its position after 1 s and on the way there.
    pub fn scene(self) -> Scene {
        let Self {
            moment,
            kp,
            kd,
            most,
            jump,
        } = self;
        let marks = [0.05, 0.25, 0.5, 1.0];
        let simulate = move |solver| {
            let mut b = fixed();
            let rotor = inertia(1.0, Vec3::zeros(), [moment; 3]);
            let link = b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), rotor);
            pd(&mut b, link, kp, kd, most);
            let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
                if marks.iter().any(|mark| (s.time() - mark).abs() < 1e-9) {
                    seen.push(s.state().physical.q[0]);
                }
                true
            };
            play(b.model, solver, [H, 1.0], &mut target(0, jump), &mut watch)
        };
        let judge = move |solver: Solver, run: &Run| {
            let seen = run.seen_or_nan(4);
            let effort = |x: &[f64; 2]| (kp * (jump - x[0]) - kd * x[1]).clamp(-most, most);
            let rates = |x: &[f64; 2]| [x[1], effort(x) / moment];
            let (mut x, mut t, mut worst) = ([0.0; 2], 0.0, 0.0);
            let mut off = 0.0;
            for (mark, seen) in marks.into_iter().zip(seen) {
                // Steps of a microsecond: where the limit binds or leaves, a step errs by 1e-12.
                x = truth::runge_kutta(rates, x, mark - t, ((mark - t) * 1e6) as u32);
                (t, off) = (mark, seen - x[0]);
                worst = super::larger(worst, off.abs());
            }
            let asked = solver.pick(None, Some(1e-2));
            vec![
                figure("position after 1 s, rad", off, asked),
                figure("largest error at 0.05 … 1 s, rad", worst, None),
            ]
        };
        Scene {
            name: format!("servo {moment:.1e} {kp:.1e} {kd:.1e} {most:.1e}, jump {jump:.3}"),
            source: "piecewise linear, Runge–Kutta in steps of 1 µs",
            simulate: Box::new(simulate),
            judge: Box::new(judge),
            reference: None,
        }
    }
}

/// Three masses in a row on servos of pd laws with limits, which start stretched: masses, gains kp
/// and kd, limits, and stretches.
///
/// With `F` the forces of the servos, `m a = F − F′` for the servo `F′` of the next mass, and a
/// stretch grows by the difference of two neighbours' accelerations.
pub fn limited_row(
    masses: [f64; 3],
    gains: [[f64; 2]; 3],
    most: [f64; 3],
    start: [f64; 3],
) -> Scene {
    let simulate = move |solver| {
        let mut b = fixed();
        let mut parent = BASE;
        for i in 0..3 {
            let body = inertia(masses[i], Vec3::zeros(), [1e-3; 3]);
            parent = b.link(parent, Pose::IDENTITY, Motion::Prismatic(X), body);
            pd(&mut b, parent, gains[i][0], gains[i][1], most[i]);
        }
        b.model.initial.joint_positions = start.to_vec();
        let mut command = |s: &mut Simulation, t: f64| (0..3).for_each(|a| target(a, 0.0)(s, t));
        play(
            b.model,
            solver,
            [H, 2.0],
            &mut command,
            &mut last(super::coordinates),
        )
    };
    let judge = move |solver: Solver, run: &Run| {
        let rates = |x: &[f64; 6]| {
            let force =
                |i: usize| (-gains[i][0] * x[i] - gains[i][1] * x[3 + i]).clamp(-most[i], most[i]);
            let a: [f64; 3] = std::array::from_fn(|i| {
                (force(i) - if i < 2 { force(i + 1) } else { 0.0 }) / masses[i]
            });
            [x[3], x[4], x[5], a[0], a[1] - a[0], a[2] - a[1]]
        };
        let [a, b, c] = start;
        let x = truth::runge_kutta(rates, [a, b, c, 0.0, 0.0, 0.0], 2.0, 200_000);
        let seen = run.seen_or_nan(3);
        let off = (0..3).fold(0.0, |m, i| super::larger(m, (seen[i] - x[i]).abs()));
        vec![figure(
            "stretches after 2 s, m",
            off,
            solver.pick(None, Some(1e-2)),
        )]
    };
    Scene {
        name: format!("row of limited servos, {masses:.1?} kg"),
        source: "piecewise linear, Runge–Kutta in steps of 10 µs",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}
