//! Closed loops.

use super::worlds::{books, table, world};
use super::*;
use crate::closure::testing::{add, anchor, ends_at};
use crate::model::{Anchor, LoopKind};
use crate::snapshot::Snapshot;
use crate::tuning::Rules;

/// A rod of 1 kg along its x axis, with its end at the joint, about y.
fn rod(length: f64) -> RigidInertia {
    let i = length * length / 12.0;
    inertia(1.0, X * (0.5 * length), [1e-3, i, i])
}

/// Crank, coupler and rocker of rods of 1 m, closed 1.2 m beside the crank: it whirls.
pub(super) fn four_bar(ends: impl Fn([Anchor; 2]) -> LoopKind) -> Builder {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let turn = Motion::Revolute(-Y);
    let crank = b.link(LinkId(0), Pose::IDENTITY, turn, rod(1.0));
    let coupler = b.link(crank, at(1.0, 0.0, 0.0), turn, rod(1.0));
    let rocker = b.link(LinkId(0), at(1.2, 0.0, 0.0), turn, rod(1.0));
    let tips = [coupler, rocker].map(|link| anchor(Some(link), at(1.0, 0.0, 0.0)));
    // The z axis of a hinge is the y axis of the mechanism.
    let tips = tips.map(|tip| Anchor {
        X_LA: Pose {
            R: crate::spatial::rotation_from_rpy(&(X * -std::f64::consts::FRAC_PI_2)),
            ..tip.X_LA
        },
        ..tip
    });
    b.close(ends(tips));
    b.model.initial.joint_positions = vec![1.57, -1.77, 1.3];
    b.model.initial.joint_velocities = vec![-1.0, 0.0, 0.0];
    b
}

pub(super) fn energy(s: &mut Simulation) -> f64 {
    s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
}

/// The widest gap of the state, m.
pub(super) fn gap(s: &Simulation) -> f64 {
    let mut kin = crate::kinematics::Kinematics::new(s.tree());
    kin.update_poses(s.tree(), &s.state().physical.q);
    kin.update_loops(s.tree());
    kin.loops.find_sums(s.tree(), &s.state().physical.q);
    kin.loops.largest()
}

/// Runs for `end` seconds; returns the widest gap and the largest change of energy on the way.
pub(super) fn watch(s: &mut Simulation, end: f64, h: f64) -> [f64; 2] {
    let begin = energy(s);
    let (mut widest, mut lost) = (gap(s), 0.0_f64);
    let count = (end / h).round() as u64;
    for i in 1..=count {
        s.advance_to(end * i as f64 / count as f64).expect("finite");
        widest = widest.max(gap(s));
        lost = lost.max((energy(s) - begin).abs());
    }
    [widest, lost]
}

/// Energy of a whirling four-bar of 3 kg and 1 m, 20 J: at the ends of the allowed loss, and by
/// which method. Implicit steps lose what they lose on an open chain.
#[test]
fn a_four_bar_stays_closed_and_keeps_its_energy() {
    for (explicit, tolerance, allowed) in [
        (true, 1e-3, 2e-2),
        (true, 1e-4, 1e-3),
        (true, 1e-5, 2e-4),
        (false, 1e-3, 3.0),
        (false, 1e-4, 1.0),
        (false, 1e-5, 0.2),
    ] {
        let mut s = start(four_bar(LoopKind::Hinge).model, tolerance);
        s.set_rules(Rules {
            explicit,
            ..Rules::ALL
        });
        let [widest, lost] = watch(&mut s, 2.0, 0.01);
        assert!(widest < 1e-12, "{explicit} {tolerance}: {widest}");
        assert!(lost < allowed, "{explicit} {tolerance}: {lost}");
        assert_eq!(s.state().stepping.counters.forced, 0);
    }
}

#[test]
fn a_four_bar_stays_closed_in_fixed_steps() {
    for explicit in [true, false] {
        let mut b = four_bar(LoopKind::Ball);
        b.model.solver.step_size = 1e-3;
        let mut s = start(b.model, 1e-3);
        s.set_rules(Rules {
            explicit,
            ..Rules::ALL
        });
        let [widest, lost] = watch(&mut s, 2.0, 0.01);
        assert!(widest < 1e-12 && lost < 0.1, "{explicit} {widest} {lost}");
    }
}

/// The planar mechanism is the same whether the loop is a ball (1 row too many), a hinge (3) or a
/// weld would be (4, and it would not move).
#[test]
fn redundant_rows_change_nothing() {
    let ends = [LoopKind::Ball, LoopKind::Hinge].map(|kind| {
        let mut s = start(four_bar(kind).model, 1e-5);
        run(&mut s, 1.0, 0.01);
        s.state().physical.q.clone()
    });
    for (a, b) in ends[0].iter().zip(&ends[1]) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
}

/// A ball joint as a loop, a hinge as a loop, and a rod without mass: each is what a joint of the
/// tree does.
#[test]
fn loops_move_like_joints_of_a_tree() {
    let body = inertia(1.3, Vec3::new(0.5, 0.1, -0.05), [0.02, 0.05, 0.04]);
    let spin = Vec3::new(0.4, -0.7, 1.1);
    for hinge in [false, true] {
        let motion = if hinge {
            Motion::Revolute(Vec3::z())
        } else {
            Motion::Spherical
        };
        let mut tree = Builder::new(false, RigidInertia::ZERO);
        let tip = tree.link(LinkId(0), Pose::IDENTITY, motion, body);
        tree.model.outputs.links.push(tip);
        let mut tree = start(tree.model, 1e-7);
        let mut loops = Builder::new(true, body);
        let ends = [
            anchor(Some(LinkId(0)), Pose::IDENTITY),
            anchor(None, Pose::IDENTITY),
        ];
        loops.close(if hinge {
            LoopKind::Hinge(ends)
        } else {
            LoopKind::Ball(ends)
        });
        if hinge {
            tree.state_mut().physical.v[0] = spin.z;
            loops.model.roots[0].angular_velocity = Vec3::z() * spin.z;
            tree.set_parameter(ParameterSlot::Gravity(1), 9.0);
        } else {
            tree.state_mut().physical.v.copy_from_slice(spin.as_slice());
            loops.model.roots[0].angular_velocity = spin;
        }
        let mut loops = start(loops.model, 1e-7);
        if hinge {
            loops.set_parameter(ParameterSlot::Gravity(1), 9.0);
        }
        run(&mut tree, 1.0, 0.02);
        run(&mut loops, 1.0, 0.02);
        for axis in 0..4 {
            let a = tree.output(OutputSlot::LinkOrientation(tip, axis));
            let b = loops.output(OutputSlot::BaseOrientation(RootId::ROBOT, axis));
            assert!((a.abs() - b.abs()).abs() < 1e-6, "{hinge} {axis}: {a} {b}");
        }
    }
}

/// A bead on a rod without mass: a pendulum of a point, in two ways.
#[test]
fn a_distance_is_a_rod() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.01; 3]));
    b.model.roots[0].position = Vec3::new(0.6, 0.0, -0.8);
    let ends = [
        anchor(Some(LinkId(0)), Pose::IDENTITY),
        anchor(None, Pose::IDENTITY),
    ];
    b.close(LoopKind::Distance { ends, length: 1.0 });
    let mut s = start(b.model, 1e-8);
    let mut t = Builder::new(false, RigidInertia::ZERO);
    t.link(
        LinkId(0),
        Pose::IDENTITY,
        Motion::Revolute(-Y),
        inertia(1.0, X, [1e-12; 3]),
    );
    t.model.initial.joint_positions[0] = -libm::atan2(0.8, 0.6);
    let mut t = start(t.model, 1e-8);
    run(&mut s, 2.0, 0.01);
    run(&mut t, 2.0, 0.01);
    let angle = t.state().physical.q[0];
    let q = &s.state().physical.q;
    assert!((q[0] - libm::cos(angle)).abs() < 1e-6, "{q:?} {angle}");
    assert!((q[2] - libm::sin(angle)).abs() < 1e-6, "{q:?} {angle}");
}

/// Two flywheels with gears of 3 : 1, driven by gravity on an arm: exact.
#[test]
fn gears_turn_in_proportion() {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let arm = b.link(LinkId(0), Pose::IDENTITY, Motion::Revolute(Y), rod(1.0));
    let wheel = b.link(
        LinkId(0),
        at(2.0, 0.0, 0.0),
        Motion::Revolute(Y),
        inertia(1.0, Vec3::zeros(), [0.1; 3]),
    );
    let share = |link: LinkId, factor| crate::model::Share {
        joint: (link.index() - 1).into(),
        factor,
    };
    b.close(LoopKind::Coupler {
        terms: vec![share(arm, 3.0), share(wheel, 1.0)],
        sum: None,
    });
    b.model.initial.joint_positions = vec![0.3, 0.5];
    let mut s = start(b.model, 1e-8);
    // One degree of freedom: (I + 9 J) a = m g l/2 cos q.
    let (i, lever) = (1.0 / 3.0 + 9.0 * 0.1, 0.5 * G);
    let (mut q, mut v, h) = (0.3, 0.0, 1e-4);
    for _ in 0..10_000 {
        // Leapfrog: 1e-9.
        v += 0.5 * h * lever * libm::cos(q) / i;
        q += h * v;
        v += 0.5 * h * lever * libm::cos(q) / i;
    }
    run(&mut s, 1.0, 0.01);
    let found = &s.state().physical.q;
    assert!((found[0] - q).abs() < 1e-6, "{found:?} {q}");
    assert!((3.0 * (found[0] - 0.3) + found[1] - 0.5).abs() < 1e-12);
}

/// A random tree at a random place with loops, some twice, that are closed there.
fn random_closed(seed: u64, floating: bool) -> (Model, Vec<f64>, Vec<f64>) {
    let mut random = Random(seed);
    let mut model = random_tree(&mut random, 10, floating, seed.is_multiple_of(3));
    let tree = crate::tree::Tree::new(&model, &crate::parameters::Parameters::new(&model));
    let far: Vec<f64> = (0..model.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
    let mut q = vec![0.0; model.nq];
    let zero = crate::state::State::new(&model).physical.q;
    crate::kinematics::advance(&tree, &zero, &far, 1.0, &mut q);
    for twice in 0..3 {
        let (mut a, mut b) = (0, 0);
        while a == b {
            (a, b) = (
                random.below(model.links.len()),
                random.below(model.links.len()),
            );
        }
        let links = [a, b].map(|link| Some(LinkId::from(link)));
        let place = Pose::from_xyz_rpy(random.vector(0.3), random.vector(3.0));
        let ends = ends_at(&model, &q, links, place);
        add(&mut model, LoopKind::Ball(ends.clone()));
        if twice == 0 {
            add(&mut model, LoopKind::Ball(ends));
        }
    }
    let v = (0..model.nv()).map(|_| random.uniform(-0.5, 0.5)).collect();
    (model, q, v)
}

fn begin(model: Model, q: &[f64], v: &[f64], tolerance: f64) -> Simulation {
    let mut s = start(model, tolerance);
    let tree = s.tree().clone();
    let state = &mut s.state_mut().physical;
    state.q.copy_from_slice(q);
    state.v.copy_from_slice(v);
    let mut kin = crate::kinematics::Kinematics::new(&tree);
    let nothing = |_: usize| false;
    let open = crate::initial::closing::close(&tree, &mut kin, [&nothing, &nothing], state);
    assert_eq!(open, None);
    s
}

/// Angular momentum about the centre of mass, and linear momentum.
fn momenta(s: &Simulation) -> [Vec3; 2] {
    let tree = s.tree();
    let mut kin = crate::kinematics::Kinematics::new(tree);
    let state = &s.state().physical;
    kin.update_poses(tree, &state.q);
    kin.update_velocities(tree, &state.v);
    let momentum = crate::dynamics::energy::momentum(&kin, 0..tree.bodies.len());
    let mut whole = crate::spatial::SpatialInertia::default();
    for I in &kin.I {
        whole.add(I);
    }
    let linear = crate::spatial::linear(&momentum);
    let center = Vec3::from(whole.moment) / whole.mass;
    [
        crate::spatial::angular(&momentum) - center.cross(&linear),
        linear,
    ]
}

#[test]
fn random_loops_stay_closed_and_keep_energy_and_momenta() {
    for seed in 0..12 {
        let floating = seed % 2 == 0;
        let (mut model, q, v) = random_closed(seed, floating);
        if floating {
            model.world.gravity = Vec3::zeros();
        }
        let mut s = begin(model, &q, &v, 1e-6);
        let (before, kinetic) = (momenta(&s), s.output(OutputSlot::EnergyKinetic));
        let [widest, lost] = watch(&mut s, 1.0, 0.01);
        assert!(widest < 1e-9, "seed {seed}: {widest}");
        assert!(
            lost < 1e-3 * (1.0 + kinetic),
            "seed {seed}: {lost} of {kinetic}"
        );
        assert_eq!(s.state().stepping.counters.forced, 0, "seed {seed}");
        if floating {
            for (a, b) in before.iter().zip(momenta(&s)) {
                assert!((a - b).norm() < 1e-9, "seed {seed}: {a:?} {b:?}");
            }
        }
    }
}

/// In the midst of a motion, with shapes on the ground and motors: saved and restored, with NaN in
/// all scratch, in smooth steps, implicit ones and fixed ones.
#[test]
fn restored_loops_continue_with_the_same_bits() {
    for (seed, ground, step) in [
        (0, false, 0.0),
        (1, true, 0.0),
        (2, true, 1e-3),
        (5, false, 1e-3),
    ] {
        let (mut model, q, v) = random_closed(seed, true);
        if ground {
            shape_all_links(&mut model);
            model.world.ground = Some(crate::model::Ground {
                friction: 0.8,
                ..Default::default()
            });
        }
        model.solver.step_size = step;
        let mut s = begin(model.clone(), &q, &v, 1e-3);
        let end = s.time() + 0.3;
        run(&mut s, end, 0.01);
        let saved = s.save();
        run(&mut s, 0.4, 0.01);
        let mut other = start(model, 1e-3);
        let bytes = saved.to_bytes();
        let read = Snapshot::from_bytes(other.model(), &bytes).expect("own bytes");
        other.restore(&read).expect("same model");
        other.spoil();
        run(&mut other, 0.4, 0.01);
        assert!(gap(&s) < 1e-9, "seed {seed}: {}", gap(&s));
        assert_eq!(other.state(), s.state(), "seed {seed}");
    }
}

/// Three rods of a chain that is closed while stretched out to 0.6 mrad: as the knees pass through,
/// they are turned by thousands of rad/s² within a step that has begun slowly. Nothing drives them,
/// and in an explicit step, too, they keep to their energy. Without books of such steps they made
/// 90 J.
#[test]
fn a_loop_that_is_nearly_stretched_out_makes_no_energy_in_fixed_steps() {
    let lengths = [0.303_607, 0.450_509, 0.394_079];
    let angles = [-5.09e-4, 5.96e-4, 3.27e-4];
    let masses = [1.636, 0.518, 1.066];
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let (mut link, mut from, mut end) = (LinkId(0), 0.0, [0.0; 2]);
    let mut rows = [Vec3::zeros(); 2];
    for i in 0..3 {
        let (l, m) = (lengths[i], masses[i]);
        let across = m * l * l / 12.0;
        let body = inertia(m, Vec3::x() * (0.5 * l), [1e-3 * across, across, across]);
        link = b.link(link, at(from, 0.0, 0.0), Motion::Revolute(-Vec3::y()), body);
        let (sin, cos) = libm::sincos(angles[i]);
        (rows[0][i], rows[1][i]) = (-l * sin, l * cos);
        end = [end[0] + l * cos, end[1] + l * sin];
        from = l;
    }
    b.close(LoopKind::Ball([
        anchor(Some(link), at(from, 0.0, 0.0)),
        anchor(None, at(end[0], 0.0, end[1])),
    ]));
    // The only velocities that keep the end in its place.
    let turning = rows[0].cross(&rows[1]);
    let turning = turning * (3.0 / turning.amax());
    let relative = |x: [f64; 3]| vec![x[0], x[1] - x[0], x[2] - x[1]];
    b.model.initial.joint_positions = relative(angles);
    b.model.initial.joint_velocities = relative(turning.into());
    b.model.solver.step_size = 1.0 / 240.0;
    let mut s = start(b.model, 1e-3);
    let begin = books(&s).2;
    for i in 1..=120 {
        s.advance_to(f64::from(i) / 240.0).expect("finite");
        let gained = books(&s).2 - begin;
        assert!(gained < 1e-3, "{gained} J after {i} of 1/240 s");
    }
}

/// A four-bar whose initial pose is open by centimetres closes to the same bits beside a table,
/// which has no degree of freedom, as without it. The search for the pose once read the limits of
/// a degree of freedom that the table has not, and ended in a panic.
#[test]
fn a_loop_closes_at_the_start_beside_what_stands_still() {
    let open = || {
        let mut b = four_bar(LoopKind::Ball);
        b.model.initial.joint_positions = vec![1.5, -1.6, 1.2];
        b.model
    };
    let alone = start(open(), 1e-3);
    let beside = start(world([open(), table()]), 1e-3);
    assert!(gap(&alone) < 1e-9 && gap(&beside) < 1e-9);
    assert_eq!(alone.state().physical.q, beside.state().physical.q);
}
