//! Blocks, rods and discs that slide, tip, rock and fall, and balls that bounce with spin.

use super::{Allowed, BASE, Command, Plan, at_places, compare, nothing, share};
use crate::scenes::truth::runge_kutta;
use crate::scenes::{G, H, Scene, Solver, X, figure, play, single};
use crate::scenes::{Run, larger};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::simulation::{InputSlot, Simulation};
use urdf2fmu_core::spatial::Vec3;

/// Moments of a homogeneous cuboid of 1 kg with these half edges.
fn cuboid(half: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = half.map(|a| a * a / 3.0);
    [y + z, z + x, x + y]
}

/// A standing disc that slides and spins; friction of a uniform pressure, summed over its face.
/// Sliding and spinning end together, at `v/(R ω) = 0.653` (Farkas, Bartels, Unger & Wolf 2003).
fn spinning_disc() -> Scene {
    let (mu, radius, speed, spin) = (0.3, 0.1, 0.5, 8.0);
    let make = move || {
        let shape = Shape::Cylinder {
            radius,
            half_length: 5e-3,
        };
        let moments = [2.5e-3, 2.5e-3, 0.5 * radius * radius];
        let mut b = single(1.0, moments, shape, mu);
        b.model.roots[0].position.z = 5e-3 - 0.7 * b.model.contact.penetration;
        b.model.roots[0].linear_velocity.x = speed;
        b.model.roots[0].angular_velocity.z = spin;
        (b.model, nothing())
    };
    let truth = move || {
        // Means of the direction of the sliding, and of its moment, over the face.
        let means = |v: f64, w: f64| {
            let (mut along, mut about, count) = (0.0, 0.0, 24);
            for i in 0..count {
                let r = radius * ((f64::from(i) + 0.5) / f64::from(count)).sqrt();
                for j in 0..48 {
                    let (sin, cos) =
                        libm::sincos(std::f64::consts::TAU * (f64::from(j) + 0.5) / 48.0);
                    let (ux, uy) = (v - w * r * sin, w * r * cos);
                    let size = ux.hypot(uy).max(1e-12);
                    along += ux / size;
                    about += r * (cos * uy - sin * ux) / size;
                }
            }
            let all = f64::from(count * 48);
            (along / all, about / all)
        };
        let (mut v, mut w, mut x, mut angle, h) = (speed, spin, 0.0, 0.0, 5e-4);
        while v > 1e-3 && w > 1e-2 {
            let (along, about) = means(v, w);
            // The middle of the step, by Euler's half step.
            let [vm, wm] = [
                v - 0.5 * h * mu * G * along,
                w - h * mu * G * about / radius.powi(2),
            ];
            let (along, about) = means(vm, wm);
            x += h * vm;
            angle += h * wm;
            v -= h * mu * G * along;
            w -= h * mu * G * about / (0.5 * radius * radius);
        }
        vec![x, 0.1 * angle]
    };
    let look = |s: &mut Simulation| {
        let q = &s.state().physical.q;
        vec![q[0], 0.1 * 2.0 * libm::atan2(q[6], q[3])]
    };
    let plan = Plan {
        name: "sliding and spinning disc",
        source: "uniform pressure; Farkas et al. 2003",
        quantity: "way and R times angle when it stops, m",
        span: [H, 1.0],
        // 5 % of the way of 7 cm.
        allowed: share(3.5e-3),
    };
    compare(plan, make, look, truth)
}

/// A block in a force that goes round: `F² = (m v Ω)² + (μ m g)²`, on a circle of `v/Ω`.
fn circling_block() -> Scene {
    let (mu, rate, force) = (0.3, std::f64::consts::TAU, 6.0);
    let speed = (force * force - mu * mu * G * G).sqrt() / rate;
    let ahead = libm::atan2(speed * rate, mu * G);
    let make = move || {
        let half = [0.1, 0.1, 0.02];
        let mut b = single(1.0, cuboid(half), Shape::Box { half: half.into() }, mu);
        b.model.roots[0].position.z = 0.02 - 0.5 * b.model.contact.penetration;
        b.model.roots[0].linear_velocity.x = speed;
        let command = move |s: &mut Simulation, t: f64| {
            for (axis, turn) in [(0, 0.0), (1, -std::f64::consts::FRAC_PI_2)] {
                let slot = InputSlot::ExternalForce(BASE, axis);
                let (sin, cos) = libm::sincos(rate * t + ahead + turn);
                s.set_input(slot, force * cos);
                s.set_input_derivative(slot, 1, -force * rate * sin);
                s.set_input_derivative(slot, 2, -force * rate * rate * cos);
                s.set_input_derivative(slot, 3, force * rate * rate * rate * sin);
            }
        };
        (b.model, Box::new(command) as Command)
    };
    let plan = Plan {
        name: "block in a force that goes round, 2 ¼ turns",
        source: "F² = (m v Ω)² + (μ m g)²",
        quantity: "place, m",
        span: [H, 2.25],
        allowed: Allowed {
            fixed: 1e-2,
            tolerances: 10.0,
            least: 5e-4,
        },
    };
    compare(plan, make, at_places([0, 1]), move || vec![speed / rate; 2])
}

/// The force at its centre that tips a box over the edge that it is pushed against, as a share of
/// `m g a/(z cos φ)` for the half edge `a` and the push `φ` off its normal: found by halving.
fn tipping_boxes() -> Scene {
    let boxes = [[0.05, 0.1, 0.1], [0.02, 0.02, 0.1], [0.1, 0.1, 0.05]];
    let tips = |half: [f64; 3], angle: f64, share: f64, solver: Solver| {
        let (sin, cos) = libm::sincos(angle);
        let force = G * (half[0] / cos).min(half[1] / sin.max(1e-9)) / half[2];
        let mut b = single(1.0, cuboid(half), Shape::Box { half: half.into() }, 3.0);
        b.model.roots[0].position.z = half[2] - 0.5 * b.model.contact.penetration;
        let mut push = |s: &mut Simulation, t: f64| {
            let now = force * share * (t / 0.5).min(1.0);
            s.set_input(InputSlot::ExternalForce(BASE, 0), now * cos);
            s.set_input(InputSlot::ExternalForce(BASE, 1), now * sin);
        };
        let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
            let q = &s.state().physical.q;
            let fell = 1.0 - 2.0 * (q[4] * q[4] + q[5] * q[5]) < libm::cos(0.05);
            *seen = vec![f64::from(u8::from(fell))];
            !fell
        };
        play(b.model, solver, [H, 2.5], &mut push, &mut watch)
    };
    let simulate = move |solver| {
        let mut all = Run::default();
        for half in boxes {
            for angle in [0.0, 0.2, 0.4] {
                let (mut stands, mut falls) = (0.8, 1.2);
                for _ in 0..7 {
                    let middle = 0.5 * (stands + falls);
                    let run = tips(half, angle, middle, solver);
                    all.add_steps(&run);
                    if run.seen == [0.0] {
                        stands = middle;
                    } else {
                        falls = middle;
                    }
                }
                all.seen.push(0.5 * (stands + falls) - 1.0);
            }
        }
        all
    };
    let judge = |_: Solver, run: &Run| {
        let worst = run.seen.iter().fold(0.0, |m, off| larger(m, off.abs()));
        // Two corners sink by d = 0.07 mm while the others lift off: the slender box leans by d/2a,
        // which takes z d/2a² = 1 % of the force, and more where it is pushed towards a corner.
        vec![figure("tipping force, relative", worst, 0.02)]
    };
    Scene {
        name: "tipping boxes, three shapes and directions".into(),
        source: "statics: m g a/(z cos φ)",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A slender block let go leaning on an edge: its lean `time` s later, against a rigid edge before
/// the impact, and the lean that it reaches after it, when `1 − 3/2 sin² α` of its rate is left
/// (Housner 1963).
fn rocking_block(name: &'static str, end: f64) -> Scene {
    let (b_half, h_half, first) = (0.05, 0.25, 0.1_f64);
    let alpha = libm::atan(b_half / h_half);
    let reach = b_half.hypot(h_half);
    let make = move || {
        let half = [b_half, 0.1, h_half];
        let mut b = single(1.0, cuboid(half), Shape::Box { half: half.into() }, 3.0);
        b.model.roots[0].rpy.y = first;
        b.model.roots[0].position.z =
            reach * libm::cos(alpha - first) - 0.7 * b.model.contact.penetration;
        (b.model, nothing())
    };
    let look = |s: &mut Simulation| {
        let q = &s.state().physical.q;
        vec![2.0 * libm::atan2(q[5], q[3])]
    };
    // 4/3 m R² θ̈ = −m g R sin(α − |θ|) sign θ; a step that passes θ = 0 is divided there.
    let truth = move || {
        let kept = 1.0 - 1.5 * libm::sin(alpha).powi(2);
        let rates = move |x: &[f64; 2]| {
            let side = if x[0] < 0.0 { -1.0 } else { 1.0 };
            [
                x[1],
                -0.75 * G / reach * libm::sin(alpha - x[0].abs()) * side,
            ]
        };
        let (mut x, h) = ([first, 0.0], 1e-5);
        for _ in 0..(end / h) as u32 {
            let next = runge_kutta(rates, x, h, 1);
            x = if next[0] * x[0] < 0.0 {
                [next[0], next[1] * kept]
            } else {
                next
            };
        }
        vec![x[0]]
    };
    let plan = Plan {
        name,
        source: "rigid edges; Housner 1963",
        quantity: "lean, rad",
        span: [H, end],
        allowed: share(4e-3),
    };
    compare(plan, make, look, truth)
}

/// A rod of 1 m falls from a lean of 0.1 rad, on a floor without friction or on one where its end
/// rolls. Its lower end is a ball of the radius `r`.
fn falling_rod(rough: bool) -> Scene {
    let (l, r, end) = (0.5, 5e-3, if rough { 0.75 } else { 0.38 });
    let moment = l * l / 3.0;
    let make = move || {
        let rod = Shape::Capsule {
            radius: r,
            half_length: l,
        };
        let mu = if rough { 20.0 } else { 0.0 };
        let mut b = single(1.0, [moment, moment, 1e-5], rod, mu);
        b.model.roots[0].rpy.y = 0.1;
        b.model.roots[0].position.z = l * libm::cos(0.1) + r - 0.7 * b.model.contact.penetration;
        (b.model, nothing())
    };
    let look = move |s: &mut Simulation| {
        let q = &s.state().physical.q;
        vec![q[0], l * 2.0 * libm::atan2(q[5], q[3])]
    };
    // Without friction the centre falls straight:
    // (I + m l² sin² θ) θ̈ + m l² sin θ cos θ θ̇² = m g l sin θ.
    // Rolling: A θ̈ − m r l sin θ θ̇² = m g l sin θ with A = I + m (r² + l² + 2 r l cos θ).
    let truth = move || {
        let rates = move |x: &[f64; 2]| {
            let (sin, cos) = libm::sincos(x[0]);
            let pull = if rough {
                let whole = moment + r * r + l * l + 2.0 * r * l * cos;
                (G * l * sin + r * l * sin * x[1] * x[1]) / whole
            } else {
                (G * l * sin - l * l * sin * cos * x[1] * x[1]) / (moment + l * l * sin * sin)
            };
            [x[1], pull]
        };
        let x = runge_kutta(rates, [0.1, 0.0], end, 20_000);
        let moved = r * (x[0] - 0.1) + l * (libm::sin(x[0]) - libm::sin(0.1));
        vec![if rough { moved } else { 0.0 }, l * x[0]]
    };
    let plan = Plan {
        name: if rough {
            "rod falling on a rough floor"
        } else {
            "rod falling on ice"
        },
        source: "Lagrange's equation",
        quantity: "place and half length times lean, m",
        span: [H, end],
        allowed: share(5e-3),
    };
    compare(plan, make, look, truth)
}

/// Heights of the next three apexes of a ball that bounces, at their times: `e²ⁿ h`.
fn bounces() -> Scene {
    let (h, e) = (0.5, 0.7);
    let first = (2.0 * h / G).sqrt();
    // The fall, whole hops of 2 eⁿ, and half of the third hop.
    let end = first * (1.0 + 2.0 * e + 2.0 * e * e + e * e * e);
    let make = move || {
        let mut b = single(0.2, [5e-5; 3], Shape::Sphere { radius: 0.03 }, 0.5);
        b.model.roots[0].position.z = 0.03 + h;
        b.model.links[0].restitution = e;
        if let Some(ground) = &mut b.model.world.ground {
            ground.restitution = e;
        }
        (b.model, nothing())
    };
    let look = |s: &mut Simulation| vec![s.state().physical.q[2] - 0.03];
    let plan = Plan {
        name: "third hop of a ball",
        source: "e⁶ h at the time of the apex",
        quantity: "height, m",
        span: [end / 480.0, end],
        allowed: share(2e-3),
    };
    compare(plan, make, look, move || vec![e.powi(6) * h])
}

/// A ball thrown at the ground at 3 m/s with 1 m/s along it: it slides throughout the impact, which
/// takes `μ (1 + e) 3` of its speed along, or grips and leaves at 5/7 of it.
fn thrown_ball(name: &'static str, mu: f64) -> Scene {
    let (radius, e) = (0.05, 0.6);
    let make = move || {
        let mut b = single(
            0.5,
            [0.2 * radius * radius; 3],
            Shape::Sphere { radius },
            mu,
        );
        b.model.world.gravity *= 0.0;
        b.model.roots[0].position.z = radius + 0.03;
        b.model.roots[0].linear_velocity = X - Vec3::new(0.0, 0.0, 3.0);
        b.model.links[0].restitution = e;
        if let Some(ground) = &mut b.model.world.ground {
            ground.restitution = e;
        }
        (b.model, nothing())
    };
    let look = move |s: &mut Simulation| {
        let v = &s.state().physical.v;
        vec![v[3], radius * v[1]]
    };
    let truth = move || {
        let along = (1.0 - mu * (1.0 + e) * 3.0).max(5.0 / 7.0);
        vec![along, 2.5 * (1.0 - along)]
    };
    let plan = Plan {
        name,
        source: "Coulomb: μ (1 + e) v, or 5/7",
        quantity: "speeds after it, m/s",
        span: [H, 0.1],
        allowed: share(1e-2),
    };
    compare(plan, make, look, truth)
}

pub fn all() -> Vec<Scene> {
    vec![
        spinning_disc(),
        circling_block(),
        tipping_boxes(),
        rocking_block("rocking block, before the impact", 0.2),
        rocking_block("rocking block, after two impacts", 0.8),
        falling_rod(false),
        falling_rod(true),
        bounces(),
        thrown_ball("ball that slides through a bounce", 0.05),
        thrown_ball("ball that grips in a bounce", 0.5),
    ]
}
