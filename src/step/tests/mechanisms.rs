//! Benchmarks of closed loops, beside their published or independent solutions.

use super::*;
use crate::closure::testing::anchor;
use crate::model::{LoopKind, Spring};

/// A body that turns about z at a point of its parent.
fn turning(b: &mut Builder, parent: LinkId, x: f64, y: f64, body: RigidInertia) -> LinkId {
    b.link(parent, at(x, y, 0.0), Motion::Revolute(Vec3::z()), body)
}

pub(super) fn ball(b: &mut Builder, ends: [(Option<LinkId>, [f64; 3]); 2]) {
    let ends = ends.map(|(link, [x, y, z])| anchor(link, at(x, y, z)));
    b.close(LoopKind::Ball(ends));
}

/// Andrews' squeezing mechanism: seven bodies in a plane, three loops, a spring, driven by a
/// constant torque to 15.8 rad in 0.03 s. Data and solution: Test Set for IVP Solvers, problem
/// II-13 (Hairer & Wanner 1996, section VII.7); angles as the file has them.
#[test]
fn andrews_squeezer_is_where_the_test_set_says() {
    let planar = |m: f64, x: f64, y: f64, i: f64| inertia(m, Vec3::new(x, y, 0.0), [i; 3]);
    let (xa, ya, xb, yb) = (-0.06934, -0.00227, -0.03635, 0.03273);
    let (d, da, e, ea, rr, ra) = (28e-3, 115e-4, 2e-2, 1421e-5, 7e-3, 92e-5);
    let (ss, sa, sb, sc, sd) = (35e-3, 1874e-5, 1043e-5, 18e-3, 2e-2);
    let (ta, tb, u, ua, ub) = (2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5);
    let (zf, zt, fa) = (2e-2, 4e-2, 1421e-5);
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let base = LinkId(0);
    let k1 = turning(&mut b, base, 0.0, 0.0, planar(0.04325, ra, 0.0, 2.194e-6));
    let k2 = turning(&mut b, k1, rr, 0.0, planar(0.00365, -da, 0.0, 4.410e-7));
    let k3 = turning(&mut b, base, xb, yb, planar(0.02373, sb, -sa, 5.255e-6));
    let k5 = turning(&mut b, base, xa, ya, planar(0.07050, ta, tb, 1.169e-5));
    let k4 = turning(&mut b, k5, zt, 0.0, planar(0.00706, 0.0, ea - e, 5.667e-7));
    let k7 = turning(&mut b, base, xa, ya, planar(0.05498, ua, ub, 1.912e-5));
    let k6 = turning(&mut b, k7, 0.0, -u, planar(0.00706, zf - fa, 0.0, 5.667e-7));
    let tip = (Some(k2), [-d, 0.0, 0.0]);
    ball(&mut b, [tip, (Some(k3), [0.0, -ss, 0.0])]);
    ball(&mut b, [tip, (Some(k4), [0.0, -e, 0.0])]);
    ball(&mut b, [tip, (Some(k6), [zf, 0.0, 0.0])]);
    b.model.springs.push(Spring {
        name: "spring".into(),
        ends: [
            anchor(Some(k3), at(sd, -sc, 0.0)),
            anchor(None, at(0.014, 0.072, 0.0)),
        ],
        length: 0.07785,
        stiffness: 4530.0,
        damping: 0.0,
        shown: true,
    });
    b.model.world.gravity = Vec3::zeros();
    b.actuator(k1, ActuatorMode::Effort, 1.0);
    // β, Θ, γ, δ, Φ, ε, Ω.
    b.model.initial.joint_positions = vec![
        -0.061_713_890_014_276_45,
        0.0,
        0.455_279_819_163_070_38,
        0.487_364_979_543_842_55,
        0.222_668_390_165_885_88,
        1.230_547_444_549_821_2,
        -0.222_668_390_165_885_88,
    ];
    let expected = [
        15.810_771_2,
        -15.756_371_1,
        0.040_822_240_1,
        0.524_409_966,
        -0.534_730_116,
        1.048_080_74,
        0.534_730_116,
    ];
    let mut s = start(b.model, 1e-8);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 0.033);
    run(&mut s, 0.03, 1e-3);
    let q = &s.state().physical.q;
    for (q, expected) in q.iter().zip(expected) {
        assert!((q - expected).abs() < 1e-6, "{q} {expected}");
    }
    assert!(super::loops::gap(&s) < 1e-9);
}

/// `IFToMM` benchmark A02 with two windows: five rods of 1 m and 1 kg, gravity 9.81, from upright
/// with 1 m/s at the top, 10 s. It passes the horizontal, where all rods are in line and each
/// window could fold. Energy is kept, and all uprights stay parallel.
#[test]
fn two_windows_pass_the_horizontal() {
    for (tolerance, allowed) in [(1e-3, 0.1), (1e-5, 1e-3)] {
        let i = 1.0 / 12.0;
        let rod = inertia(1.0, X * 0.5, [1e-3, i, i]);
        let turn = Motion::Revolute(-Y);
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let uprights: Vec<LinkId> = (0..3)
            .map(|k| b.link(LinkId(0), at(f64::from(k), 0.0, 0.0), turn, rod))
            .collect();
        for k in 0..2 {
            let top = b.link(uprights[k], at(1.0, 0.0, 0.0), turn, rod);
            let tip = [1.0, 0.0, 0.0];
            ball(&mut b, [(Some(top), tip), (Some(uprights[k + 1]), tip)]);
        }
        let quarter = std::f64::consts::FRAC_PI_2;
        b.model.initial.joint_positions = vec![quarter, quarter, quarter, -quarter, -quarter];
        b.model.initial.joint_velocities = vec![-1.0, -1.0, -1.0, 1.0, 1.0];
        let mut s = start(b.model, tolerance);
        let [widest, lost] = super::loops::watch(&mut s, 10.0, 0.01);
        assert!(widest < 1e-9, "{tolerance}: {widest}");
        assert!(lost < allowed, "{tolerance}: {lost}");
        let q = &s.state().physical.q;
        assert!(
            (q[0] - q[1]).abs() < 1e-9 && (q[1] - q[2]).abs() < 1e-9,
            "{q:?}"
        );
        assert!(q[0] < -quarter, "it has gone round: {q:?}");
    }
}

/// Slider–crank, `x = r cos θ + √(l² − r² sin² θ)`; the angle by its equation of one degree of
/// freedom, with the inertia `I(θ)` of crank, rod and slider and their weight, in steps of 1e-5 s.
#[test]
fn a_slider_crank_follows_its_equation_of_one_angle() {
    let (r, l, m_rod, m_slider) = (0.3, 0.8, 1.0, 2.0);
    let i_crank = 0.02;
    let i_rod = m_rod * l * l / 12.0;
    let turn = Motion::Revolute(-Y);
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let crank = b.link(
        LinkId(0),
        Pose::IDENTITY,
        turn,
        inertia(0.5, Vec3::zeros(), [i_crank; 3]),
    );
    let rod = b.link(
        crank,
        at(r, 0.0, 0.0),
        turn,
        inertia(m_rod, X * (0.5 * l), [1e-3, i_rod, i_rod]),
    );
    let slider = b.link(
        LinkId(0),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(m_slider, Vec3::zeros(), [0.01; 3]),
    );
    ball(
        &mut b,
        [(Some(rod), [l, 0.0, 0.0]), (Some(slider), [0.0; 3])],
    );
    b.model.initial.joint_positions = vec![0.4, -0.6, 1.0];
    b.model.initial.joint_velocities = vec![5.0, 0.0, 0.0];
    let mut s = start(b.model, 1e-6);
    let begin = s.state().physical.q[0];
    assert!((s.state().physical.v[0] - 5.0).abs() < 1e-12);
    // Kinetic energy ½ I(θ) θ̇² and potential V(θ): θ̈ = −(V' + ½ I' θ̇²)/I, by differences.
    let place = |angle: f64| {
        let lean = -libm::asin(r * libm::sin(angle) / l);
        let x = r * libm::cos(angle) + l * libm::cos(lean);
        (lean, x)
    };
    let inertia_at = |angle: f64| {
        let lean = -libm::asin(r * libm::sin(angle) / l);
        let leaning = -r * libm::cos(angle) / (l * libm::cos(lean));
        let sliding = -r * libm::sin(angle) - l * libm::sin(lean) * leaning;
        let vx = -r * libm::sin(angle) - 0.5 * l * libm::sin(lean) * leaning;
        let vz = r * libm::cos(angle) + 0.5 * l * libm::cos(lean) * leaning;
        i_crank
            + i_rod * leaning * leaning
            + m_rod * (vx * vx + vz * vz)
            + m_slider * sliding * sliding
    };
    let weight = |angle: f64| m_rod * G * 0.5 * r * libm::sin(angle);
    let slope = |of: &dyn Fn(f64) -> f64, x: f64| (of(x + 1e-5) - of(x - 1e-5)) / 2e-5;
    let rate = |angle: f64, speed: f64| {
        -(slope(&weight, angle) + 0.5 * slope(&inertia_at, angle) * speed * speed)
            / inertia_at(angle)
    };
    let (mut angle, mut speed, h) = (begin, 5.0, 1e-4);
    for _ in 0..10_000 {
        let k1 = (speed, rate(angle, speed));
        let k2 = (
            speed + 0.5 * h * k1.1,
            rate(angle + 0.5 * h * k1.0, speed + 0.5 * h * k1.1),
        );
        let k3 = (
            speed + 0.5 * h * k2.1,
            rate(angle + 0.5 * h * k2.0, speed + 0.5 * h * k2.1),
        );
        let k4 = (speed + h * k3.1, rate(angle + h * k3.0, speed + h * k3.1));
        angle += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        speed += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
    }
    for i in 1..=100 {
        s.advance_to(f64::from(i) * 0.01).expect("finite");
        let q = &s.state().physical.q;
        let (_, x) = place(q[0]);
        assert!((q[2] - x).abs() < 1e-12, "{q:?} {x}");
    }
    let q = &s.state().physical.q;
    assert!((q[0] - angle).abs() < 1e-6, "{q:?} {angle}");
}

/// Bricard's mechanism, `IFToMM` benchmark A04: five rods of 1 m and 1 kg and the frame, along six
/// edges of a cube, in a closed chain of six hinges that are square to the rods at both ends. Of
/// its equations one says nothing new. Gravity along −y.
///
/// - `spare`: whether the one more equation is there
fn bricard(spare: bool) -> Builder {
    let i = 1.0 / 12.0;
    let [x, y, z] = [X, Y, Vec3::z()];
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let (mut parent, mut place) = (LinkId(0), Vec3::zeros());
    for (along, axis) in [(x, y), (y, z), (z, x), (-x, y), (-y, z)] {
        let across = Vec3::new(1.0, 1.0, 1.0) - along.component_mul(&along);
        let body = inertia(1.0, along * 0.5, (across * i).into());
        let turn = Motion::Revolute(axis);
        let link = b.link(parent, at(place.x, place.y, place.z), turn, body);
        (parent, place) = (link, along);
    }
    let frame = |p: Vec3| Pose {
        p,
        R: crate::spatial::rotation_to_axis(&x),
    };
    let ends = [anchor(Some(parent), frame(place)), anchor(None, frame(z))];
    if spare {
        b.close(LoopKind::Hinge(ends));
    } else {
        b.close(LoopKind::Ball(ends));
        // That the axes do not lean to one side, as a distance.
        let aside = (y + z).normalize();
        b.close(LoopKind::Distance {
            ends: [
                anchor(Some(parent), frame(place + x)),
                anchor(None, frame(z + x + aside)),
            ],
            length: 1.0,
        });
    }
    b.model.world.gravity = -Y * G;
    b
}

#[test]
fn bricards_mechanism_moves_and_keeps_its_energy() {
    let mut s = start(bricard(true).model, 1e-5);
    let mut most = 0.0_f64;
    let begin = super::loops::energy(&mut s);
    for k in 1..=1000 {
        s.advance_to(f64::from(k) * 0.01).expect("finite");
        let gap = super::loops::gap(&s);
        assert!(gap < 1e-9, "{k}: {gap}");
        let lost = super::loops::energy(&mut s) - begin;
        assert!(lost.abs() < 1e-2, "{k}: {lost}");
        let q = &s.state().physical.q;
        most = q.iter().fold(most, |most, q| most.max(q.abs()));
    }
    assert!(most > 0.5, "it moves: {most}");
}

#[test]
fn a_row_that_says_nothing_new_changes_nothing() {
    let mut all = start(bricard(true).model, 1e-8);
    let mut fewer = start(bricard(false).model, 1e-8);
    run(&mut all, 1.0, 0.01);
    run(&mut fewer, 1.0, 0.01);
    for (a, b) in all.state().physical.q.iter().zip(&fewer.state().physical.q) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
}

/// The flyball governor, `IFToMM` benchmark A05: an axis that turns freely, two rods of 1 m at 30°
/// with 5 kg at their ends, a slider of 3 kg on the axis, held by spring-dampers of 8e5 N/m and
/// 4e4 N·s/m of 0.5 m from the slider to half of each rod, from 2π rad/s on. The slider's place
/// beside the same equations in the three coordinates of axis, rod and slider, by the classical
/// Runge–Kutta method in steps of 1e-5 s.
#[test]
fn the_governor_follows_its_equations() {
    let (k, c, l0) = (8e5, 4e4, 0.5);
    let (m_ball, m_slider, j_axis, j_slider) = (5.0, 3.0, 0.1, 0.05);
    let alpha = std::f64::consts::PI / 6.0;
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let z = Vec3::z();
    let axis = b.link(
        LinkId(0),
        Pose::IDENTITY,
        Motion::Revolute(z),
        inertia(1.0, Vec3::zeros(), [j_axis; 3]),
    );
    // Rods hang from the top of the axis, along −z at zero.
    let point = inertia(m_ball, -z, [1e-9; 3]);
    let rods = [Y, -Y].map(|turn| b.link(axis, Pose::IDENTITY, Motion::Revolute(-turn), point));
    let slider = b.link(
        axis,
        Pose::IDENTITY,
        Motion::Prismatic(-z),
        inertia(m_slider, Vec3::zeros(), [j_slider; 3]),
    );
    for (n, rod) in rods.into_iter().enumerate() {
        b.model.springs.push(Spring {
            name: format!("spring{n}"),
            ends: [
                anchor(Some(rod), at(0.0, 0.0, -0.5)),
                anchor(Some(slider), Pose::IDENTITY),
            ],
            length: l0,
            stiffness: k,
            damping: c,
            shown: true,
        });
    }
    let place = 2.0 * 0.5 * libm::cos(alpha);
    b.model.initial.joint_positions = vec![0.0, alpha, alpha, place];
    b.model.initial.joint_velocities = vec![std::f64::consts::TAU, 0.0, 0.0, 0.0];
    let mut s = start(b.model, 1e-8);
    // ω, α, s and their rates: angular momentum about the axis is kept.
    let inertia_of =
        |alpha: f64| j_axis + j_slider + 2.0 * m_ball * libm::pow(libm::sin(alpha), 2.0);
    let momentum = inertia_of(alpha) * std::f64::consts::TAU;
    let rates = |[a, va, s, vs]: [f64; 4]| {
        let w = momentum / inertia_of(a);
        let (sine, cosine) = (libm::sin(a), libm::cos(a));
        // From the slider to the middle of a rod: (½ sin α, s − ½ cos α).
        let (x, z) = (0.5 * sine, s - 0.5 * cosine);
        let (vx, vz) = (0.5 * cosine * va, vs + 0.5 * sine * va);
        let l = (x * x + z * z).sqrt();
        let rate = (x * vx + z * vz) / l;
        let pull = k * (l - l0) + c * rate;
        let along_a = pull * (x * 0.5 * cosine + z * 0.5 * sine) / l;
        let along_s = 2.0 * pull * z / l;
        let aa = (m_ball * w * w * sine * cosine - m_ball * G * sine - along_a) / (m_ball + 1e-9);
        let as_ = G - along_s / m_slider;
        [va, aa, vs, as_]
    };
    let mut y = [alpha, 0.0, place, 0.0];
    let mut worst = [0.0_f64; 2];
    let h = 1e-5;
    let step =
        |y: [f64; 4], k: [f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|i| y[i] + h * k[i]) };
    for n in 1..=1000 {
        for _ in 0..1000 {
            let k1 = rates(y);
            let k2 = rates(step(y, k1, 0.5 * h));
            let k3 = rates(step(y, k2, 0.5 * h));
            let k4 = rates(step(y, k3, h));
            let sum = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
            y = step(y, sum, h);
        }
        s.advance_to(f64::from(n) * 0.01).expect("finite");
        let q = &s.state().physical.q;
        worst = [
            worst[0].max((q[3] - y[2]).abs()),
            worst[1].max((q[1] - y[0]).abs()),
        ];
    }
    assert!(worst[0] < 1e-5 && worst[1] < 1e-5, "{worst:?}");
}
