//! Pendulums, cranes, chains and gears.

use super::{BASE, Command, Plan, SMOOTH, at_places, compare, hold_at_zero, motor, nothing, set};
use crate::scenes::truth::runge_kutta;
use crate::scenes::{G, H, Scene, X, Y, Z, fixed};
use crate::testing::{at, inertia};
use urdf2fmu_core::model::{ActuatorMode, Motion};
use urdf2fmu_core::simulation::{InputSlot, Simulation};
use urdf2fmu_core::spatial::{Pose, RigidInertia, Vec3};

/// A body of `mass` that slides or turns about its centre of mass with the moment `moment`.
pub fn body(mass: f64, moment: f64) -> RigidInertia {
    inertia(mass, Vec3::zeros(), [moment; 3])
}

pub fn plan(name: &'static str, source: &'static str, end: f64) -> Plan {
    Plan {
        name,
        source,
        quantity: "coordinates at the end, m or rad",
        span: [H, end],
        allowed: SMOOTH,
    }
}

/// A point mass on a massless rod of 1 m that hangs on a mount with two axes: it is let go with a
/// speed across, and its ellipse precesses; or the mount turns by 0.5 rad/s, and the pendulum keeps
/// to its plane (Foucault), but for what it gets of that turning at the beginning.
///
/// `p̈ = −g z + λ p` with `λ = (g p_z − |v|²)/l²`, because the length stays.
fn spherical_pendulum(foucault: bool) -> Scene {
    let (lean, turns) = (0.8_f64, 0.5);
    let (sin, cos) = libm::sincos(lean);
    let across = if foucault { -turns * sin } else { 1.2 * cos };
    let make = move || {
        let mut b = fixed();
        let none = RigidInertia::ZERO;
        let mount = if foucault {
            b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), body(1.0, 1.0))
        } else {
            BASE
        };
        let first = b.link(mount, Pose::IDENTITY, Motion::Revolute(X), none);
        let bob = inertia(1.0, -Z, [0.0; 3]);
        b.link(first, Pose::IDENTITY, Motion::Revolute(Y), bob);
        b.model.initial.joint_positions = vec![0.0, lean];
        b.model.initial.joint_velocities = vec![1.2, 0.0];
        if !foucault {
            return (b.model, nothing());
        }
        b.model.initial.joint_positions = vec![0.0, 0.0, lean];
        b.model.initial.joint_velocities = vec![turns, 0.0, 0.0];
        motor(&mut b, mount, ActuatorMode::Velocity, [0.0; 2]);
        let command = move |s: &mut Simulation, _: f64| set(s, InputSlot::Velocity, 0, turns);
        (b.model, Box::new(command) as Command)
    };
    let look = move |s: &mut Simulation| {
        let q = &s.state().physical.q;
        let (turned, q) = if foucault {
            (q[0], &q[1..])
        } else {
            (0.0, &q[..])
        };
        let ((sa, ca), (sb, cb)) = (libm::sincos(q[0]), libm::sincos(q[1]));
        let (st, ct) = libm::sincos(turned);
        let (x, y) = (-sb, sa * cb);
        vec![ct * x - st * y, st * x + ct * y, -ca * cb]
    };
    let truth = move || {
        let rates = |x: &[f64; 6]| {
            let [px, py, pz, vx, vy, vz] = *x;
            let pull = G * pz - (vx * vx + vy * vy + vz * vz);
            [vx, vy, vz, pull * px, pull * py, pull * pz - G]
        };
        let start = [-sin, 0.0, -cos, 0.0, across, 0.0];
        runge_kutta(rates, start, 5.0, 50_000)[..3].to_vec()
    };
    let plan = if foucault {
        plan(
            "pendulum on a turning mount, 5 s",
            "keeps its plane; Foucault 1851",
            5.0,
        )
    } else {
        plan(
            "spherical pendulum, 5 s",
            "Newton; Landau & Lifshitz §14",
            5.0,
        )
    };
    compare(plan, make, look, truth)
}

/// Solves `A x = b` of eight equations by Gauss's elimination; A is positive definite.
fn solve(mut A: [[f64; 8]; 8], mut b: [f64; 8]) -> [f64; 8] {
    for i in 0..8 {
        for j in i + 1..8 {
            let ratio = A[j][i] / A[i][i];
            let pivot = A[i];
            for (below, above) in A[j].iter_mut().zip(pivot).skip(i) {
                *below -= ratio * above;
            }
            b[j] -= ratio * b[i];
        }
    }
    for i in (0..8).rev() {
        for k in i + 1..8 {
            b[i] -= A[i][k] * b[k];
        }
        b[i] /= A[i][i];
    }
    b
}

/// A chain of eight point masses on rods of 1/8 m that falls from level, like a whip.
///
/// With `θ` the angles from straight down and `n(i) = 8 − i` the masses from rod `i` on, counted
/// from 0: `Σⱼ n(max(i, j)) (cos(θᵢ − θⱼ) θ̈ⱼ + sin(θᵢ − θⱼ) θ̇ⱼ²) l = −n(i) g sin θᵢ`.
fn whip() -> Scene {
    let (l, end) = (0.125, 0.7);
    let make = move || {
        let mut b = fixed();
        let mut parent = BASE;
        for i in 0..8 {
            let place = if i == 0 {
                Pose::IDENTITY
            } else {
                at(0.0, 0.0, -l)
            };
            let bob = inertia(0.1, -Z * l, [0.0; 3]);
            parent = b.link(parent, place, Motion::Revolute(-Y), bob);
        }
        b.model.initial.joint_positions[0] = std::f64::consts::FRAC_PI_2;
        (b.model, nothing())
    };
    let look = |s: &mut Simulation| {
        let mut sum = 0.0;
        let angles = s.state().physical.q.iter().map(|q| {
            sum += q;
            sum
        });
        angles.collect()
    };
    let truth = move || {
        let rates = |x: &[f64; 16]| {
            let carried = |i: usize, j: usize| (8 - i.max(j)) as f64;
            let b = std::array::from_fn(|i| {
                let whirl = |j: usize| carried(i, j) * libm::sin(x[i] - x[j]) * x[8 + j] * x[8 + j];
                let sum: f64 = (0..8).map(whirl).sum();
                -sum - carried(i, i) * G / l * libm::sin(x[i])
            });
            let A = std::array::from_fn(|i| {
                std::array::from_fn(|j| carried(i, j) * libm::cos(x[i] - x[j]))
            });
            let bend = solve(A, b);
            std::array::from_fn(|i| if i < 8 { x[8 + i] } else { bend[i - 8] })
        };
        let mut start = [0.0; 16];
        start[..8].fill(std::f64::consts::FRAC_PI_2);
        runge_kutta(rates, start, end, 4000)[..8].to_vec()
    };
    compare(
        plan("whip of eight rods, 0.7 s", "Lagrange's equations", end),
        make,
        look,
        truth,
    )
}

/// A cart on rails with a pendulum hanging or standing on it; x, angle and their rates under the
/// force `push(t, x)` on the cart and the torque `turn(x)` on the hinge.
fn cart(
    [mass, bob, l]: [f64; 3],
    up: f64,
    push: impl Fn(&[f64; 5]) -> f64,
    turn: impl Fn(&[f64; 5]) -> f64,
) -> impl Fn(&[f64; 5]) -> [f64; 5] {
    // (M + m) ẍ + m l (θ̈ cos θ − θ̇² sin θ) = F; m l² θ̈ + m l ẍ cos θ ± m g l sin θ = τ.
    move |x| {
        let (sin, cos) = libm::sincos(x[1]);
        let first = push(x) + bob * l * x[3] * x[3] * sin;
        let second = turn(x) + up * bob * G * l * sin;
        let (a, b, c) = (mass + bob, bob * l * cos, bob * l * l);
        let whole = a * c - b * b;
        let (along, bend) = (
            (c * first - b * second) / whole,
            (a * second - b * first) / whole,
        );
        [x[2], x[3], along, bend, 1.0]
    }
}

/// An overhead crane that is pushed forth and back, each for a second.
fn crane() -> Scene {
    let sizes = [10.0, 5.0, 2.0];
    let make = move || {
        let mut b = fixed();
        let cart = b.link(
            BASE,
            Pose::IDENTITY,
            Motion::Prismatic(X),
            body(sizes[0], 0.1),
        );
        let load = inertia(sizes[1], -Z * sizes[2], [0.0; 3]);
        b.link(cart, Pose::IDENTITY, Motion::Revolute(-Y), load);
        motor(&mut b, cart, ActuatorMode::Effort, [0.0; 2]);
        let command = |s: &mut Simulation, t: f64| {
            let force = [20.0, -20.0, 0.0][(t as usize).min(2)];
            set(s, InputSlot::Effort, 0, force);
        };
        (b.model, Box::new(command) as Command)
    };
    let truth = move || {
        let mut x = [0.0; 5];
        for (force, time) in [(20.0, 1.0), (-20.0, 1.0), (0.0, 2.0)] {
            x = runge_kutta(cart(sizes, -1.0, move |_| force, |_| 0.0), x, time, 10_000);
        }
        x[..2].to_vec()
    };
    compare(
        plan("overhead crane, 4 s", "Lagrange's equations", 4.0),
        make,
        at_places([0, 1]),
        truth,
    )
}

/// A pole on a free cart that a pd law of its hinge holds upright.
fn pole() -> Scene {
    let (sizes, kp, kd) = ([1.0, 0.2, 0.5], 5.0, 0.05);
    let make = move || {
        let mut b = fixed();
        let cart = b.link(
            BASE,
            Pose::IDENTITY,
            Motion::Prismatic(X),
            body(sizes[0], 0.1),
        );
        let bob = inertia(sizes[1], Z * sizes[2], [0.0; 3]);
        let pole = b.link(cart, Pose::IDENTITY, Motion::Revolute(Y), bob);
        motor(&mut b, pole, ActuatorMode::Pd, [kp, kd]);
        b.model.initial.joint_positions = vec![0.0, 0.3];
        (b.model, hold_at_zero(1))
    };
    let truth = move || {
        let turn = move |x: &[f64; 5]| -kp * x[1] - kd * x[3];
        let rates = cart(sizes, 1.0, |_| 0.0, turn);
        runge_kutta(rates, [0.0, 0.3, 0.0, 0.0, 0.0], 4.0, 40_000)[..2].to_vec()
    };
    let plan = plan("pole on a cart under pd, 4 s", "Lagrange's equations", 4.0);
    compare(plan, make, at_places([0, 1]), truth)
}

/// Gears of ratio −3: `τ = (J₁ + 9 J₂) θ̈`.
fn gears() -> Scene {
    let make = || {
        let mut b = fixed();
        let first = b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), body(1.0, 0.01));
        let second = b.link(
            BASE,
            at(0.2, 0.0, 0.0),
            Motion::Revolute(Z),
            body(1.0, 0.002),
        );
        b.mimic(second, first, -3.0, 0.0);
        motor(&mut b, first, ActuatorMode::Effort, [0.0; 2]);
        let command = |s: &mut Simulation, _: f64| set(s, InputSlot::Effort, 0, 0.05);
        (b.model, Box::new(command) as Command)
    };
    let truth = || vec![0.5 * 0.05 / (0.01 + 9.0 * 0.002) * 4.0];
    compare(
        plan("gear train, 2 s", "τ = (J₁ + n² J₂) θ''", 2.0),
        make,
        at_places([0]),
        truth,
    )
}

/// Two masses over a pulley: `(m₁ + m₂ + J/R²) a = (m₂ − m₁) g`.
fn atwood() -> Scene {
    let make = || {
        let mut b = fixed();
        let first = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(Z), body(1.0, 1e-3));
        let second = b.link(
            BASE,
            at(0.2, 0.0, 0.0),
            Motion::Prismatic(Z),
            body(1.2, 1e-3),
        );
        b.mimic(second, first, -1.0, 0.0);
        let pulley = b.link(
            BASE,
            at(0.1, 0.0, 1.0),
            Motion::Revolute(Y),
            body(0.5, 0.002),
        );
        b.mimic(pulley, first, 10.0, 0.0);
        (b.model, nothing())
    };
    let truth = || vec![0.5 * 0.2 * G / (2.2 + 0.002 * 100.0) * 2.25];
    let plan = plan(
        "Atwood's machine, 1.5 s",
        "(m₂ − m₁) g/(m₁ + m₂ + J/R²)",
        1.5,
    );
    compare(plan, make, at_places([0]), truth)
}

/// A wheel on a thin axle that unwinds its string: `a = g/(1 + J/(m r²))`.
fn maxwell() -> Scene {
    let make = || {
        let mut b = fixed();
        let none = RigidInertia::ZERO;
        let down = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(-Z), none);
        let wheel = b.link(down, Pose::IDENTITY, Motion::Revolute(Y), body(0.5, 1e-3));
        b.mimic(wheel, down, 1.0 / 0.005, 0.0);
        (b.model, nothing())
    };
    let truth = || vec![0.5 * G / (1.0 + 1e-3 / (0.5 * 25e-6)) * 9.0];
    compare(
        plan("Maxwell's wheel, 3 s", "g/(1 + J/(m r²))", 3.0),
        make,
        at_places([0]),
        truth,
    )
}

/// A bead on a rod that turns: by a motor at a constant rate, `r = r₀ cosh ω t`, or freely with
/// `(J + m r²) ω` constant.
fn bead(driven: bool) -> Scene {
    let (moment, mass, rate, end) = (0.05, 0.2, 2.0, 1.5);
    let make = move || {
        let mut b = fixed();
        let rod = b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), body(1.0, moment));
        b.link(
            rod,
            Pose::IDENTITY,
            Motion::Prismatic(X),
            inertia(mass, Vec3::zeros(), [0.0; 3]),
        );
        b.model.initial.joint_positions = vec![0.0, 0.1];
        b.model.initial.joint_velocities = vec![rate, 0.0];
        if !driven {
            return (b.model, nothing());
        }
        motor(&mut b, rod, ActuatorMode::Velocity, [0.0; 2]);
        let command = move |s: &mut Simulation, _: f64| set(s, InputSlot::Velocity, 0, rate);
        (b.model, Box::new(command) as Command)
    };
    let truth = move || {
        if driven {
            return vec![rate * end, 0.1 * libm::cosh(rate * end)];
        }
        let momentum = (moment + mass * 0.01) * rate;
        let rates = |x: &[f64; 3]| {
            let w = momentum / (moment + mass * x[1] * x[1]);
            [w, x[2], w * w * x[1]]
        };
        runge_kutta(rates, [0.0, 0.1, 0.0], end, 15_000)[..2].to_vec()
    };
    let (name, source) = if driven {
        ("bead on a driven rod, 1.5 s", "r₀ cosh ω t")
    } else {
        ("bead on a free rod, 1.5 s", "(J + m r²) ω constant")
    };
    compare(plan(name, source, end), make, at_places([0, 1]), truth)
}

pub fn all() -> Vec<Scene> {
    vec![
        spherical_pendulum(false),
        spherical_pendulum(true),
        whip(),
        crane(),
        pole(),
        gears(),
        atwood(),
        maxwell(),
        bead(true),
        bead(false),
    ]
}
