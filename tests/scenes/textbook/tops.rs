//! Tops, gyroscopes and bodies in flight.

use super::{BASE, Command, Plan, SMOOTH, at_places, compare, motor, nothing, set};
use crate::scenes::truth::{heavy, runge_kutta};
use crate::scenes::{G, H, Scene, X, Y, Z, fixed};
use crate::testing::{Builder, Random, inertia};
use urdf2fmu_core::model::{ActuatorMode, Model, Motion};
use urdf2fmu_core::simulation::{InputSlot, Simulation};
use urdf2fmu_core::spatial::{Mat3, Pose, RigidInertia, Vec3, rotation_from_quaternion};

/// Its moments about its centre of mass, that centre seen from the point that it turns about, and
/// how it starts: tilt about y, rad, and angular velocity in its own axes, rad/s.
struct Top {
    diagonal: [f64; 3],
    centre: Vec3,
    tilt: f64,
    spin: [f64; 3],
}

impl Top {
    /// Of 1 kg on a spherical joint.
    fn make(&self) -> (Model, Command) {
        let mut b = fixed();
        let body = inertia(1.0, self.centre, self.diagonal);
        b.link(BASE, Pose::IDENTITY, Motion::Spherical, body);
        let start = self.start();
        let begin = move |s: &mut Simulation, t: f64| {
            if t == 0.0 {
                let state = &mut s.state_mut().physical;
                state.q.copy_from_slice(&start[..4]);
                state.v.copy_from_slice(&start[4..]);
            }
        };
        (b.model, Box::new(begin))
    }

    fn start(&self) -> [f64; 7] {
        let (sin, cos) = libm::sincos(0.5 * self.tilt);
        [cos, 0.0, sin, 0.0, self.spin[0], self.spin[1], self.spin[2]]
    }

    /// Its axes after `time` s.
    fn after(&self, time: f64) -> Vec<f64> {
        let c = self.centre;
        let I = Mat3::from_diagonal(&Vec3::from(self.diagonal))
            + Mat3::identity() * c.norm_squared()
            - c * c.transpose();
        axes(&runge_kutta(
            heavy(I, c),
            self.start(),
            time,
            (time * 2e4) as u32,
        ))
    }
}

fn axes(q: &[f64]) -> Vec<f64> {
    let R = rotation_from_quaternion(&[q[0], q[1], q[2], q[3]]);
    R.as_slice()[3..].to_vec()
}

fn top(
    name: &'static str,
    source: &'static str,
    end: f64,
    make: impl Fn() -> Top + Clone + 'static,
) -> Scene {
    let plan = Plan {
        name,
        source,
        quantity: "axes at the end",
        span: [H, end],
        allowed: SMOOTH,
    };
    let again = make.clone();
    compare(
        plan,
        move || make().make(),
        |s| axes(&s.state().physical.q),
        move || again().after(end),
    )
}

/// A heavy body on a point, drawn by chance.
pub fn drawn(random: &mut Random) -> Scene {
    // Two moments and less than their sum, as a body has them.
    let [a, b] = [(); 2].map(|()| random.uniform(0.005, 0.03));
    let c = (a - b).abs() + random.uniform(0.2, 0.9) * (a + b - (a - b).abs());
    let (centre, spin) = (random.vector(0.08), random.vector(12.0));
    let tilt = random.uniform(0.0, 2.0);
    top(
        "heavy body on a point, 2 s",
        "Euler's equations",
        2.0,
        move || Top {
            diagonal: [a, b, c],
            centre,
            tilt,
            spin: spin.into(),
        },
    )
}

/// Spin at which a symmetric top of 1 kg begins to sleep: 2 √(I₁ m g l)/I₃.
fn sleeping(share: f64) -> Top {
    let (across, along, l) = (0.02, 0.04, 0.1);
    let limit = 2.0 * ((across + l * l) * G * l).sqrt() / along;
    Top {
        diagonal: [across, across, along],
        centre: Z * l,
        tilt: 0.01,
        spin: [0.0, 0.0, share * limit],
    }
}

/// A rotor with a horizontal axis in two gimbals: it goes round by `m g l/(I₃ ω)` exactly.
fn gimbals() -> Scene {
    let (l, along, spin) = (0.1, 0.01, 60.0);
    let rate = G * l / (along * spin);
    let plan = Plan {
        name: "gyroscope in gimbals, 3 s",
        source: "Ω = m g l/(I₃ ω); Goldstein §5.7",
        quantity: "angles of both gimbals, rad",
        span: [H, 3.0],
        allowed: SMOOTH,
    };
    let make = move || {
        let mut b = fixed();
        let outer = b.link(
            BASE,
            Pose::IDENTITY,
            Motion::Revolute(Z),
            RigidInertia::ZERO,
        );
        let inner = b.link(
            outer,
            Pose::IDENTITY,
            Motion::Revolute(Y),
            RigidInertia::ZERO,
        );
        let rotor = inertia(1.0, X * l, [along, 0.006, 0.006]);
        b.link(inner, Pose::IDENTITY, Motion::Revolute(X), rotor);
        b.model.initial.joint_velocities = vec![rate, 0.0, spin];
        (b.model, nothing())
    };
    compare(plan, make, at_places([0, 1]), move || vec![rate * 3.0, 0.0])
}

/// Two bodies that turn against each other on one axis, without momentum.
fn turning_against() -> Scene {
    let (first, second) = (0.03, 0.02);
    let plan = Plan {
        name: "turning without momentum, 3 s",
        source: "−I₂/(I₁ + I₂) of the joint's angle",
        quantity: "angle of the base, rad",
        span: [H, 3.0],
        allowed: SMOOTH,
    };
    let make = move || {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.02, 0.02, first]));
        b.model.world.gravity = Vec3::zeros();
        let wheel = inertia(0.5, Vec3::zeros(), [0.01, 0.01, second]);
        let wheel = b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), wheel);
        motor(&mut b, wheel, ActuatorMode::Velocity, [0.0; 2]);
        let command =
            |s: &mut Simulation, t: f64| set(s, InputSlot::Velocity, 0, libm::sin(t) + 1.0);
        (b.model, Box::new(command) as Command)
    };
    let look = move |s: &mut Simulation| {
        let q = &s.state().physical.q;
        vec![2.0 * libm::atan2(q[6], q[3]) + second / (first + second) * q[7]]
    };
    compare(plan, make, look, || vec![0.0])
}

/// A falling cat: two bodies on a universal joint whose angles go round a circle turn as a whole,
/// without momentum.
///
/// With both centres of mass in the joint, `I₁ ω + R I₂ Rᵀ (ω + ω_rel) = 0` gives `ω` for the
/// turning `ω_rel` of the second body in the first, whose axes all of this is in. The joints'
/// speeds are constant within communication steps.
fn cat() -> Scene {
    const FIRST: [f64; 3] = [0.03, 0.05, 0.02];
    const SECOND: [f64; 3] = [0.02, 0.04, 0.03];
    let rates = |t: f64| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * t);
        [
            -0.8 * std::f64::consts::TAU * sin,
            0.8 * std::f64::consts::TAU * cos,
        ]
    };
    let plan = Plan {
        name: "falling cat, two turns of its waist",
        source: "zero angular momentum; Kane & Scher 1969",
        quantity: "axes of the first body",
        span: [H, 2.0],
        // The motors take a millisecond to follow each command.
        allowed: super::Allowed {
            fixed: 1e-2,
            tolerances: 10.0,
            least: 1e-3,
        },
    };
    let make = move || {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), FIRST));
        b.model.world.gravity = Vec3::zeros();
        let waist = b.link(
            BASE,
            Pose::IDENTITY,
            Motion::Revolute(X),
            RigidInertia::ZERO,
        );
        let second = inertia(1.0, Vec3::zeros(), SECOND);
        let second = b.link(waist, Pose::IDENTITY, Motion::Revolute(Y), second);
        for link in [waist, second] {
            motor(&mut b, link, ActuatorMode::Velocity, [0.0; 2]);
        }
        b.model.initial.joint_positions = vec![0.8, 0.0];
        let command = move |s: &mut Simulation, t: f64| {
            let rates = rates(t + 0.5 * H);
            (0..2).for_each(|a| set(s, InputSlot::Velocity, a, rates[a]));
        };
        (b.model, Box::new(command) as Command)
    };
    let truth = move || {
        // Turns about x and then about the new y.
        let bend = |a: f64, b: f64| -> Mat3 {
            let ((sa, ca), (sb, cb)) = (libm::sincos(a), libm::sincos(b));
            Mat3::new(1.0, 0.0, 0.0, 0.0, ca, -sa, 0.0, sa, ca)
                * Mat3::new(cb, 0.0, sb, 0.0, 1.0, 0.0, -sb, 0.0, cb)
        };
        let mut x = [1.0, 0.0, 0.0, 0.0, 0.8, 0.0];
        for i in 0..480 {
            let speed = rates((f64::from(i) + 0.5) * H);
            let turn = |x: &[f64; 6]| {
                let R = bend(x[4], x[5]);
                let relative = X * speed[0] + bend(x[4], 0.0) * Y * speed[1];
                let second = R * Mat3::from_diagonal(&Vec3::from(SECOND)) * R.transpose();
                let both = Mat3::from_diagonal(&Vec3::from(FIRST)) + second;
                let w = -(both.try_inverse().expect("inertia") * second * relative);
                let body = crate::scenes::truth::euler([1.0; 3]);
                let q = body(&[x[0], x[1], x[2], x[3], w.x, w.y, w.z]);
                [q[0], q[1], q[2], q[3], speed[0], speed[1]]
            };
            x = runge_kutta(turn, x, H, 8);
        }
        axes(&x[..4])
    };
    compare(plan, make, |s| axes(&s.state().physical.q[3..7]), truth)
}

/// A body thrown through a medium: `v̇ = g − c v (1 + |v|)`.
fn thrown() -> Scene {
    let drag = 0.1;
    let plan = Plan {
        name: "throw with drag, 2 s",
        source: "acceleration g − c v (1 + speed)",
        quantity: "place, m",
        span: [H, 2.0],
        allowed: SMOOTH,
    };
    let make = move || {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [1e-3; 3]));
        b.model.world.drag = drag;
        b.model.roots[0].linear_velocity = Vec3::new(5.0, 0.0, 8.0);
        (b.model, nothing())
    };
    let truth = move || {
        let rates = |x: &[f64; 4]| {
            let slows = drag * (1.0 + x[2].hypot(x[3]));
            [x[2], x[3], -slows * x[2], -G - slows * x[3]]
        };
        runge_kutta(rates, [0.0, 0.0, 5.0, 8.0], 2.0, 20_000)[..2].to_vec()
    };
    compare(plan, make, at_places([0, 2]), truth)
}

pub fn all() -> Vec<Scene> {
    vec![
        top(
            "heavy top, nutating, 3 s",
            "Euler's equations; Goldstein §5.7",
            3.0,
            || Top {
                diagonal: [0.02, 0.02, 0.04],
                centre: Z * 0.1,
                tilt: 0.5,
                spin: [0.0, 0.0, 20.0],
            },
        ),
        top(
            "sleeping top, 5 % too fast to wake, 2 s",
            "2 √(I₁ m g l)/I₃; Goldstein §5.7",
            2.0,
            || sleeping(1.05),
        ),
        top(
            "sleeping top, 5 % too slow to sleep, 2 s",
            "2 √(I₁ m g l)/I₃; Goldstein §5.7",
            2.0,
            || sleeping(0.95),
        ),
        top(
            "Kovalevskaya's top, 3 s",
            "Euler's equations; Kovalevskaya 1889",
            3.0,
            || Top {
                diagonal: [0.02, 0.0175, 0.0075],
                centre: X * 0.05,
                tilt: -1.0,
                spin: [0.5, 2.0, 4.0],
            },
        ),
        gimbals(),
        turning_against(),
        cat(),
        thrown(),
    ]
}
