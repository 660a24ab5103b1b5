//! Balls, hoops, pencils and discs that roll.

use super::{Allowed, BASE, Plan, at_places, compare, nothing};
use crate::scenes::rim;
use crate::scenes::truth::{Rolling, runge_kutta};
use crate::scenes::{
    G, H, Run, Scene, Solver, X, Y, Z, figure, fixed, ground, idle, play, single, slope,
};
use crate::testing::{Builder, Random, inertia};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{Model, Motion};
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_core::spatial::{Pose, RigidInertia, Vec3};

/// Contacts give way by 0.1 mm, and friction builds up within that.
const CONTACT: Allowed = Allowed {
    fixed: 1e-2,
    tolerances: 10.0,
    least: 2e-4,
};

fn plan(name: &'static str, source: &'static str, end: f64) -> Plan {
    Plan {
        name,
        source,
        quantity: "place at the end, m",
        span: [H, end],
        allowed: CONTACT,
    }
}

/// A billiard ball that moves at `v` and turns at `w`, in the place where its weight sinks it.
fn billiard(mu: f64, v: Vec3, w: Vec3) -> Builder {
    let (mass, radius) = (0.17, 0.0286);
    let moment = 0.4 * mass * radius * radius;
    let mut b = single(mass, [moment; 3], Shape::Sphere { radius }, mu);
    b.model.roots[0].position.z = radius - 0.5 * b.model.contact.penetration;
    b.model.roots[0].linear_velocity = v;
    b.model.roots[0].angular_velocity = w;
    b
}

/// The slip `v − R ω × z` of a ball keeps its direction and is gone after `2 |u|/(7 μ g)`; then the
/// ball rolls straight on. Its place after `time` s.
fn billiard_place(mu: f64, v: Vec3, w: Vec3, time: f64) -> Vec<f64> {
    let slip = v - w.cross(&Z) * 0.0286;
    let slides = 2.0 * slip.norm() / (7.0 * mu * G);
    let a = -slip.normalize() * (mu * G);
    let rolls = (time - slides).max(0.0);
    let slides = slides.min(time);
    let place = v * slides + a * (0.5 * slides * slides) + (v + a * slides) * rolls;
    vec![place.x, place.y]
}

fn shot(name: &'static str, v: Vec3, w: Vec3) -> Scene {
    shot_of(name, v, w, 0.2)
}

/// A shot drawn by chance.
pub fn drawn(random: &mut Random) -> Scene {
    let mut v = random.vector(3.0);
    v.z = 0.0;
    let mu = random.uniform(0.05, 0.9);
    shot_of("billiard shot, 1.5 s", v, random.vector(100.0), mu)
}

fn shot_of(name: &'static str, v: Vec3, w: Vec3, mu: f64) -> Scene {
    let make = move || (billiard(mu, v, w).model, nothing());
    let truth = move || billiard_place(mu, v, w, 1.5);
    let plan = plan(name, "slip of constant direction; Coriolis 1835", 1.5);
    compare(plan, make, at_places([0, 1]), truth)
}

/// A hoop that begins to slide and ends up rolling at half of its speed.
fn hoop() -> Scene {
    let (mu, speed) = (0.3, 2.0);
    let make = move || {
        let shape = Shape::Cylinder {
            radius: 0.2,
            half_length: 0.02,
        };
        let mut b = single(1.0, [0.02, 0.02, 0.04], shape, mu);
        b.model.roots[0].rpy.x = std::f64::consts::FRAC_PI_2;
        b.model.roots[0].position.z = 0.2 - 0.5 * b.model.contact.penetration;
        b.model.roots[0].linear_velocity.x = speed;
        (b.model, nothing())
    };
    let truth = move || {
        let slides = 0.5 * speed / (mu * G);
        vec![speed * slides - 0.5 * mu * G * slides * slides + 0.5 * speed * (1.5 - slides)]
    };
    compare(
        plan("hoop, slip to roll, 1.5 s", "v/2", 1.5),
        make,
        at_places([0]),
        truth,
    )
}

/// A ball that rolls across a slope: `5/7 g sin θ` down, uniform across.
fn across_a_slope() -> Scene {
    let angle = 0.3_f64;
    let make = move || {
        let mut b = billiard(0.8, Vec3::new(0.0, 1.0, 0.0), X * (-1.0 / 0.0286));
        b.model.world.gravity = slope(angle);
        (b.model, nothing())
    };
    let truth = move || vec![0.5 * 5.0 / 7.0 * G * libm::sin(angle), 1.0];
    let plan = plan("ball across a slope, 1 s", "5/7 g sin θ", 1.0);
    compare(plan, make, at_places([0, 1]), truth)
}

/// A ball with its centre of mass below its middle rocks:
/// `(I + m (R² + d² − 2 R d cos θ)) θ̈ + m R d sin θ (θ̇² ) + m g d sin θ = 0`.
fn roly_poly() -> Scene {
    let (mass, radius, d, moment) = (0.5, 0.1, 0.03, 1.5e-3);
    let make = move || {
        let mut b = Builder::new(true, inertia(mass, -Z * d, [moment; 3]));
        b.shape(BASE, Shape::Sphere { radius }, Pose::IDENTITY);
        b.model.links[0].friction = 0.8;
        b.model.world.ground = Some(ground(0.8));
        b.model.roots[0].position.z = radius - 0.5 * b.model.contact.penetration;
        b.model.roots[0].rpy.y = 1.0;
        (b.model, nothing())
    };
    let truth = move || {
        let rates = |x: &[f64; 2]| {
            let (sin, cos) = libm::sincos(x[0]);
            let whole = moment + mass * (radius * radius + d * d - 2.0 * radius * d * cos);
            [x[1], -mass * d * sin * (radius * x[1] * x[1] + G) / whole]
        };
        let end = runge_kutta(rates, [1.0, 0.0], 4.0, 40_000);
        vec![radius * (end[0] - 1.0)]
    };
    let plan = plan("roly-poly, rocking, 4 s", "Lagrange's equation", 4.0);
    compare(plan, make, at_places([0]), truth)
}

/// A hexagonal pencil that rolls down a slope of 15° on its edges. An impact keeps 11/17 of its
/// speed, and a side's fall of `a sin γ` makes up for that: just before an impact
/// `ω² = (24/17) (g/a) sin γ/(1 − (11/17)²)` (International Physics Olympiad 1998, problem 1).
/// Between impacts it turns about an edge; the mean rate follows from the time that takes.
fn pencil() -> Scene {
    let (a, slope_angle) = (0.05, 15.0_f64.to_radians());
    let make = move || {
        let mut b = fixed();
        let none = RigidInertia::ZERO;
        let along = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(X), none);
        let up = b.link(along, Pose::IDENTITY, Motion::Prismatic(Z), none);
        let moment = 5.0 / 12.0 * a * a;
        let pencil = inertia(1.0, Vec3::zeros(), [moment; 3]);
        let pencil = b.link(up, Pose::IDENTITY, Motion::Revolute(Y), pencil);
        let corner = |i: i32| {
            let angle = (f64::from(i / 2) + 0.5) * std::f64::consts::FRAC_PI_3;
            let side = if i % 2 == 0 { -0.1 } else { 0.1 };
            Vec3::new(a * libm::sin(angle), side, a * libm::cos(angle))
        };
        let vertices = (0..12).map(corner).collect();
        b.shape(pencil, Shape::Hull { vertices }, Pose::IDENTITY);
        b.model.links[pencil.index()].friction = 3.0;
        b.model.world.ground = Some(ground(3.0));
        b.model.world.gravity = slope(slope_angle);
        b.model.initial.joint_positions = vec![0.0, a * libm::cos(std::f64::consts::PI / 6.0), 0.0];
        b.model.initial.joint_velocities = vec![0.5, 0.0, 10.0];
        b.model
    };
    // From 1 s on, when the beginning is forgotten, to 4 s.
    let simulate = move |solver| {
        let mut begin = f64::NAN;
        let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
            let angle = s.state().physical.q[2];
            if s.time() < 1.0 + 0.5 * H {
                begin = angle;
            }
            *seen = vec![(angle - begin) / 3.0];
            true
        };
        play(make(), solver, [H, 4.0], &mut idle, &mut watch)
    };
    let judge = move |_: Solver, run: &Run| {
        let before2 = 24.0 / 17.0 * G / a * libm::sin(slope_angle) / (1.0 - 121.0 / 289.0);
        let after = 11.0 / 17.0 * before2.sqrt();
        // About the edge: 17/12 m a² θ̈ = m g a sin θ, θ from the vertical.
        let rates = |x: &[f64; 2]| [x[1], 12.0 / 17.0 * G / a * libm::sin(x[0])];
        let sixth = std::f64::consts::PI / 6.0;
        let (mut x, mut t, h) = ([slope_angle - sixth, after], 0.0, 1e-5);
        while x[0] < slope_angle + sixth {
            x = runge_kutta(rates, x, h, 1);
            t += h;
        }
        let side = t - (x[0] - slope_angle - sixth) / x[1];
        let off = run.seen_or_nan(1)[0] / (2.0 * sixth / side) - 1.0;
        // Thirty sides: one more or less is 3 %.
        vec![figure("mean rate, relative", off, 0.04)]
    };
    Scene {
        name: "hexagonal pencil on 15°, mean rate of 3 s".into(),
        source: "11/17 an impact; IPhO 1998",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A thin disc that rolls upright, leaning by 0.02 rad at first, at a share of the speed
/// `√(g R/3)` below which it falls over.
fn upright(name: &'static str, share: f64) -> Scene {
    let body = Rolling::cylinder(0.1, 0.15, 1e-7);
    let k = Vec3::new(libm::cos(0.02), 0.0, libm::sin(0.02));
    let speed = share * (G * body.radius / 3.0).sqrt();
    let start = body.start(&k, &(k * (speed / body.radius)));
    let make = move || -> (Model, super::Command) { (rim::model(&body, &start, 0.8), nothing()) };
    let look = |s: &mut Simulation| {
        let (k, place) = rim::axis_and_centre(s);
        vec![0.15 * k.x, 0.15 * k.y, 0.15 * k.z, place.x, place.y]
    };
    let truth = move || {
        let x = body.after(start, 2.0);
        vec![0.15 * x[0], 0.15 * x[1], 0.15 * x[2], x[6], x[7]]
    };
    let plan = Plan {
        quantity: "place and axis at the end, m",
        allowed: Allowed {
            fixed: 2e-2,
            tolerances: 10.0,
            least: 2e-3,
        },
        ..plan(name, "rolling without slip; √(g R/3)", 2.0)
    };
    compare(plan, make, look, truth)
}

/// A ball of radius 2 cm whose centre of mass lies 3 mm below its middle, spun at 150 rad/s with a
/// lean of 0.2 rad: it slides all the time and rises on its other end (tippe top).
///
/// 1. `k` is the axis from the centre of mass to the middle at the distance `e`; the contact lies
///    at `r = e k − R z` from the centre of mass and slides at `u = v + ω × r`.
/// 2. It is pushed by `N (z − μ u/|u|)`: `I ω̇ = r × N (…) − ω × I ω = A + N B`.
/// 3. The height `R − e k_z` gives `z̈ = −e (ω̇ × k + ω × (ω × k))_z = N/m − g`, hence `N`.
fn tippe_top() -> Scene {
    let (mass, radius, e, mu, end) = (0.05, 0.02, 3e-3, 0.3, 1.0);
    let (across, along, spin, lean) = (7e-6, 8e-6, 150.0, 0.2_f64);
    let make = move || {
        let body = inertia(mass, -Z * e, [across, across, along]);
        let mut b = Builder::new(true, body);
        b.shape(BASE, Shape::Sphere { radius }, Pose::IDENTITY);
        b.model.links[0].friction = mu;
        b.model.world.ground = Some(ground(mu));
        b.model.roots[0].position.z = radius - 0.5 * b.model.contact.penetration;
        b.model.roots[0].rpy.y = lean;
        let w = Vec3::new(libm::sin(lean), 0.0, libm::cos(lean)) * spin;
        b.model.roots[0].angular_velocity = w;
        // The middle lies on the axis and does not move.
        (b.model, nothing())
    };
    let rates = move |x: &[f64; 11]| {
        let vector = |i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
        let (k, w, v) = (vector(0), vector(3), vector(6));
        let r = k * e - Z * radius;
        let mut slip = v + w.cross(&r);
        slip.z = 0.0;
        let push = Z - slip * (mu / slip.norm().max(1e-9));
        let momentum = w * across + k * ((along - across) * k.dot(&w));
        // The inverse of I: across 1/I₁, along 1/I₃.
        let inverse = |t: Vec3| t / across + k * (k.dot(&t) * (1.0 / along - 1.0 / across));
        let (a, b) = (inverse(-w.cross(&momentum)), inverse(r.cross(&push)));
        let falls = a.cross(&k).z + w.cross(&w.cross(&k)).z;
        let normal = (G - e * falls) / (1.0 / mass + e * b.cross(&k).z);
        let (turns, pushed) = (a + b * normal, push * (normal / mass) - Z * G);
        let mut rates = [0.0; 11];
        rates[..3].copy_from_slice(w.cross(&k).as_slice());
        rates[3..6].copy_from_slice(turns.as_slice());
        rates[6..9].copy_from_slice(pushed.as_slice());
        rates[9..].copy_from_slice(&x[6..8]);
        rates
    };
    let truth = move || {
        let (sin, cos) = libm::sincos(lean);
        let mut start = [0.0; 11];
        start[..3].copy_from_slice(&[sin, 0.0, cos]);
        start[3..6].copy_from_slice(&[spin * sin, 0.0, spin * cos]);
        // Where the centre of mass is; the middle begins over the origin.
        start[9] = -e * sin;
        let x = runge_kutta(rates, start, end, 20_000);
        let middle = [x[9] + e * x[0], x[10] + e * x[1]];
        vec![0.02 * x[2], middle[0], middle[1]]
    };
    let look = |s: &mut Simulation| {
        let (k, place) = rim::axis_and_centre(s);
        vec![0.02 * k.z, place.x, place.y]
    };
    let plan = Plan {
        quantity: "place and R times height of the axis, m",
        allowed: Allowed {
            fixed: 5e-3,
            tolerances: 2.0,
            least: 5e-4,
        },
        ..plan("tippe top, 1 s", "Coulomb friction; Cohen 1977", end)
    };
    compare(plan, make, look, truth)
}

pub fn all() -> Vec<Scene> {
    vec![
        shot("draw shot, 1.5 s", X * 2.0, Y * -60.0),
        shot("massé shot, 1.5 s", X * 1.5, Vec3::new(60.0, -20.0, 0.0)),
        hoop(),
        across_a_slope(),
        roly_poly(),
        tippe_top(),
        pencil(),
        upright("disc rolling upright, 20 % too fast to fall, 2 s", 1.2),
        upright("disc rolling upright, 10 % too slow to stand, 2 s", 0.9),
    ]
}
