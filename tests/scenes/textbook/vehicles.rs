//! A bicycle, a two-wheeled inverted pendulum, and carts that drive and brake.

use super::{
    Allowed, BASE, Command, Plan, at_places, base_place, compare, motor, nothing, set, share,
};
use crate::scenes::truth::runge_kutta;
use crate::scenes::{G, H, Scene, Y, ground};
use crate::testing::{Builder, at, inertia};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{ActuatorMode, LinkId, Model, Motion, RootId};
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, Simulation};
use urdf2fmu_core::spatial::{Mat3, Pose, RigidInertia, Vec3};

/// A wheel whose axle is y, on a link.
fn wheel(b: &mut Builder, link: LinkId, radius: f64, half_length: f64, mu: f64) {
    let axle = Pose::from_xyz_rpy(
        Vec3::zeros(),
        Vec3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0),
    );
    let shape = Shape::Cylinder {
        radius,
        half_length,
    };
    b.shape(link, shape, axle);
    b.model.links[link.index()].friction = mu;
    b.model.world.ground = Some(ground(mu));
}

/// Inertia in the plane of x and z, as the bicycle's tables give it: mass, centre of mass, the
/// moments about x, y, z and the product of x and z.
fn planar(mass: f64, com: Vec3, [xx, yy, zz, xz]: [f64; 4]) -> RigidInertia {
    RigidInertia {
        mass,
        com,
        I_cm: Mat3::new(xx, 0.0, xz, 0.0, yy, 0.0, xz, 0.0, zz),
    }
}

/// The benchmark bicycle of Meijaard, Papadopoulos, Ruina and Schwab (2007, table 1) at this
/// speed, m/s. Their z axis points down: heights and products change their sign here. The frame of
/// the base is the ground contact of the rear wheel, that of the fork the point where the steering
/// axis meets the ground.
fn bicycle_model(speed: f64) -> Model {
    let mu = 2.0;
    let frame = planar(85.0, Vec3::new(0.3, 0.0, 0.9), [9.2, 11.0, 2.8, -2.4]);
    let mut b = Builder::new(true, frame);
    let rear = inertia(2.0, Vec3::zeros(), [0.0603, 0.12, 0.0603]);
    let rear = b.link(BASE, at(0.0, 0.0, 0.3), Motion::Revolute(Y), rear);
    let fork = planar(
        4.0,
        Vec3::new(-0.2, 0.0, 0.7),
        [0.05892, 0.06, 0.00708, 0.00756],
    );
    let (sin, cos) = libm::sincos(std::f64::consts::PI / 10.0);
    let axis = Vec3::new(sin, 0.0, -cos);
    let fork = b.link(BASE, at(1.1, 0.0, 0.0), Motion::Revolute(axis), fork);
    let front = inertia(3.0, Vec3::zeros(), [0.1405, 0.28, 0.1405]);
    let front = b.link(fork, at(-0.08, 0.0, 0.35), Motion::Revolute(Y), front);
    wheel(&mut b, rear, 0.3, 1e-6, mu);
    wheel(&mut b, front, 0.35, 1e-6, mu);
    b.model.roots[0].position.z = -0.3 * b.model.contact.penetration;
    b.model.roots[0].linear_velocity.x = speed;
    b.model.roots[0].angular_velocity.x = 0.02;
    b.model.initial.joint_velocities = vec![speed / 0.3, 0.0, speed / 0.35];
    b.model
}

/// Lean and steer of that bicycle after `time` s: `M q̈ + v C₁ q̇ + (g K₀ + v² K₂) q = 0` with the
/// matrices of that paper's appendix.
fn bicycle_truth(speed: f64, time: f64) -> Vec<f64> {
    let M = [
        [80.817_22, 2.319_413_322_087_09],
        [2.319_413_322_087_09, 0.297_841_881_996_86],
    ];
    let C = [
        [0.0, 33.866_413_914_924_94],
        [-0.850_356_414_569_78, 1.685_403_973_975_60],
    ];
    let K0 = [
        [-80.95, -2.599_516_852_498_72],
        [-2.599_516_852_498_72, -0.803_294_884_586_18],
    ];
    let K2 = [[0.0, 76.597_345_895_732_22], [0.0, 2.654_315_237_946_04]];
    let whole = M[0][0] * M[1][1] - M[0][1] * M[1][0];
    let rates = |x: &[f64; 4]| {
        let f: [f64; 2] = std::array::from_fn(|i| {
            let of = |j: usize| {
                speed * C[i][j] * x[2 + j] + (G * K0[i][j] + speed * speed * K2[i][j]) * x[j]
            };
            -of(0) - of(1)
        });
        [
            x[2],
            x[3],
            (M[1][1] * f[0] - M[0][1] * f[1]) / whole,
            (M[0][0] * f[1] - M[1][0] * f[0]) / whole,
        ]
    };
    runge_kutta(rates, [0.0, 0.0, 0.02, 0.0], time, 20_000)[..2].to_vec()
}

/// The bicycle is disturbed by a rate of lean of 0.02 rad/s: below 4.29 m/s it weaves more and
/// more, from there to 6.02 m/s it stays upright by itself, beyond it capsizes slowly.
///
/// - `least`: 2 % of the largest angle on the way
fn bicycle(name: &'static str, speed: f64, least: f64) -> Scene {
    let plan = Plan {
        name,
        source: "linear benchmark; Meijaard et al. 2007",
        quantity: "lean and steer, rad",
        span: [H, 2.0],
        allowed: Allowed {
            fixed: 2.0 * least,
            tolerances: 0.1,
            least,
        },
    };
    let look = |s: &mut Simulation| {
        vec![
            s.output(OutputSlot::BaseRpy(RootId::ROBOT, 0)),
            s.state().physical.q[8],
        ]
    };
    compare(
        plan,
        move || (bicycle_model(speed), nothing()),
        look,
        move || bicycle_truth(speed, 2.0),
    )
}

/// Sizes of the two-wheeled pendulum: body, its height over the axle and its moment, each wheel,
/// its radius and its moment about the axle.
const PENDULUM: [f64; 6] = [10.0, 0.4, 0.3, 1.0, 0.15, 0.012];
/// Torque for a lean and its rate.
const GAINS: [f64; 2] = [120.0, 12.0];

/// A body on two wheels whose motors hold it upright by its lean, which they are told at each
/// communication step.
fn two_wheels() -> Scene {
    let [mass, l, moment, wheel_mass, radius, wheel_moment] = PENDULUM;
    let first = 0.1;
    let make = move || {
        let body = inertia(mass, Vec3::new(0.0, 0.0, l), [moment, moment, 0.1]);
        let mut b = Builder::new(true, body);
        for y in [0.2, -0.2] {
            let rim = inertia(wheel_mass, Vec3::zeros(), [0.007, wheel_moment, 0.007]);
            let link = b.link(BASE, at(0.0, y, 0.0), Motion::Revolute(Y), rim);
            wheel(&mut b, link, radius, 0.02, 1.0);
            motor(&mut b, link, ActuatorMode::Effort, [0.0; 2]);
        }
        b.model.roots[0].position.z = radius - 0.25 * b.model.contact.penetration;
        b.model.roots[0].rpy.y = first;
        // Wheels that do not turn in the world.
        b.model.initial.joint_positions = vec![-first; 2];
        let command = |s: &mut Simulation, _: f64| {
            let state = &s.state().physical;
            let lean = 2.0 * libm::atan2(state.q[5], state.q[3]);
            let torque = GAINS[0] * lean + GAINS[1] * state.v[1];
            (0..2).for_each(|a| set(s, InputSlot::Effort, a, 0.5 * torque));
        };
        (b.model, Box::new(command) as Command)
    };
    let truth = move || {
        let whole = mass + 2.0 * wheel_mass + 2.0 * wheel_moment / (radius * radius);
        let mut x = [0.0, first, 0.0, 0.0];
        for _ in 0..480 {
            let torque = GAINS[0] * x[1] + GAINS[1] * x[3];
            // whole ẍ + m l (θ̈ cos θ − θ̇² sin θ) = T/r;
            // (I + m l²) θ̈ + m l ẍ cos θ = m g l sin θ − T.
            let rates = |x: &[f64; 4]| {
                let (sin, cos) = libm::sincos(x[1]);
                let along = torque / radius + mass * l * x[3] * x[3] * sin;
                let about = mass * G * l * sin - torque;
                let (c, d) = (mass * l * cos, moment + mass * l * l);
                let det = whole * d - c * c;
                [
                    x[2],
                    x[3],
                    (d * along - c * about) / det,
                    (whole * about - c * along) / det,
                ]
            };
            x = runge_kutta(rates, x, H, 10);
        }
        vec![x[0], x[1]]
    };
    let look = |s: &mut Simulation| {
        let x = base_place(s)[0];
        let q = &s.state().physical.q;
        vec![x, 2.0 * libm::atan2(q[5], q[3])]
    };
    let plan = Plan {
        name: "pendulum on two wheels, 2 s",
        source: "Lagrange's equations",
        quantity: "place, m, and lean, rad",
        span: [H, 2.0],
        allowed: Allowed {
            fixed: 2e-2,
            tolerances: 10.0,
            least: 2e-3,
        },
    };
    compare(plan, make, look, truth)
}

/// A cart of 10 kg, its centre of mass 0.2 m above the ground, on four wheels of 1 kg with axles
/// 0.6 m apart.
fn four_wheels(mode: ActuatorMode, mu: f64, speed: f64) -> Model {
    let radius = 0.1;
    let body = inertia(10.0, Vec3::new(0.0, 0.0, 0.1), [0.2, 0.4, 0.5]);
    let mut b = Builder::new(true, body);
    for (x, y) in [(0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)] {
        let rim = inertia(1.0, Vec3::zeros(), [0.003, 0.005, 0.003]);
        let link = b.link(BASE, at(x, y, 0.0), Motion::Revolute(Y), rim);
        wheel(&mut b, link, radius, 0.02, mu);
        motor(&mut b, link, mode, [0.0; 2]);
        b.model.outputs.contacts.push(link);
    }
    b.model.roots[0].position.z = radius - 0.12 * b.model.contact.penetration;
    b.model.roots[0].linear_velocity.x = speed;
    b.model
}

/// All wheels are driven: `a = 4 T/R/(M + 4 J/R²)`.
fn driven_cart() -> Scene {
    let torque = 0.5;
    let make = move || {
        let model = four_wheels(ActuatorMode::Effort, 1.0, 0.0);
        let command = move |s: &mut Simulation, _: f64| {
            (0..4).for_each(|a| set(s, InputSlot::Effort, a, torque));
        };
        (model, Box::new(command) as Command)
    };
    let truth = move || vec![0.5 * 4.0 * torque / 0.1 / (14.0 + 4.0 * 0.005 / 0.01) * 2.25];
    let plan = Plan {
        name: "driven cart, 1.5 s",
        source: "4 T/R/(M + 4 J/R²)",
        quantity: "way, m",
        span: [H, 1.5],
        allowed: Allowed {
            fixed: 1e-2,
            tolerances: 10.0,
            least: 5e-4,
        },
    };
    compare(plan, make, at_places([0]), truth)
}

/// All wheels are locked: it slows down by `μ g`, and the front axle carries
/// `½ + μ h/L` of the weight.
fn braking() -> Scene {
    let (mu, speed, end) = (0.5, 3.0, 0.5);
    let make = move || (four_wheels(ActuatorMode::Velocity, mu, speed), nothing());
    // Of the whole: the wheels' centres lie lower.
    let height = (10.0 * 0.2 + 4.0 * 0.1) / 14.0;
    let look = |s: &mut Simulation| {
        let of = |s: &mut Simulation, wheel: u16| {
            s.output(OutputSlot::ContactForce(
                LinkId::from(usize::from(wheel)),
                2,
            ))
        };
        let front = of(s, 1) + of(s, 2);
        let all = front + of(s, 3) + of(s, 4);
        vec![base_place(s)[0], front / all, all / (14.0 * G)]
    };
    let truth = move || {
        vec![
            speed * end - 0.5 * mu * G * end * end,
            0.5 + mu * height / 0.6,
            1.0,
        ]
    };
    let plan = Plan {
        name: "cart with locked wheels",
        source: "μ g, ½ + μ h/L",
        quantity: "way, m, and shares of the weight",
        span: [H, end],
        allowed: share(5e-3),
    };
    compare(plan, make, look, truth)
}

pub fn all() -> Vec<Scene> {
    vec![
        bicycle("bicycle at 3.5 m/s, weaving, 2 s", 3.5, 1e-3),
        bicycle("bicycle at 5 m/s, stable, 2 s", 5.0, 1e-4),
        bicycle("bicycle at 8 m/s, 2 s", 8.0, 5e-5),
        two_wheels(),
        driven_cart(),
        braking(),
    ]
}
