//! The differential equations beside the steps, which have tests of their own.

use super::*;
use crate::dynamics::{energy, rnea};
use crate::geometry::Shape;
use crate::joint::Motion;
use crate::kinematics::Kinematics;
use crate::model::{ActuatorMode, Ground, Interface, Limits, LinkId, Model, RootKind};
use crate::simulation::Simulation;
use crate::slots::OutputSlot;
use crate::spatial::{Pose, RigidInertia, Vec3, Vec6};
use crate::testing::{Builder, Random, inertia, random_tree, shape_all_links};
use crate::variables::{Slot, table};
use std::sync::Arc;

/// A floating body of 1 kg.
fn single(shape: &Shape, at: Vec3) -> Model {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [1e-3; 3]));
    b.shape(LinkId(0), shape.clone(), Pose::IDENTITY);
    b.model.roots[0].position = at;
    b.model
}

/// A random tree with shapes above the ground, motors of all kinds, dry friction, limits.
fn robot(random: &mut Random, n: usize, floating: bool) -> Model {
    let mut model = random_tree(random, n, floating, false);
    shape_all_links(&mut model);
    model.world.ground = Some(Ground {
        friction: 0.7,
        ..Ground::default()
    });
    let modes = [
        ActuatorMode::Velocity,
        ActuatorMode::Pd,
        ActuatorMode::Position,
    ];
    for j in 0..model.joints.len() {
        let joint = &mut model.joints[j];
        let body = joint.bodies[0];
        if model.bodies[body.index()].motion.axis().is_none() {
            continue;
        }
        joint.damping = random.uniform(0.0, 0.1);
        joint.friction = if j % 2 == 0 {
            random.uniform(0.05, 0.2)
        } else {
            0.0
        };
        let dof = model.bodies[body.index()].dof;
        if j % 3 == 0 {
            model.dofs[dof.index()].limits = Some(Limits {
                lower: -2.0,
                upper: 2.0,
            });
        }
        let mode = modes[j % 3];
        model.actuators.push(crate::model::Actuator {
            joint: j.into(),
            dof,
            mode,
            max_effort: 3.0,
            reference_effort: 3.0,
            kp: 20.0,
            kd: 0.5,
            no_load_speed: None,
        });
    }
    model.outputs.interface = Interface::Both;
    model
}

fn exchanged(model: Model) -> Simulation {
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.exchange();
    simulation.initialize(0.0).expect("a sound model");
    simulation
}

fn derivatives(simulation: &mut Simulation, x: &[f64]) -> Vec<f64> {
    simulation.set_states(x);
    simulation.derivatives().expect("finite").to_vec()
}

fn states(simulation: &mut Simulation) -> Vec<f64> {
    let mut x = vec![0.0; simulation.states().len()];
    simulation.read_states(&mut x);
    x
}

/// A place at random near the initial one, with velocities up to `speed` and displacements that no
/// friction is too weak for, up to `memory`.
fn shaken(simulation: &mut Simulation, random: &mut Random, [speed, memory]: [f64; 2]) -> Vec<f64> {
    let mut x = states(simulation);
    let all: Vec<State> = simulation.states().iter().copied().collect();
    for (x, state) in x.iter_mut().zip(&all) {
        match state.place {
            Place::Position(_) => *x += random.uniform(-0.3, 0.3),
            Place::Velocity(_) => *x = speed * random.uniform(-1.0, 1.0),
            Place::Memory => *x = memory * random.uniform(-1.0, 1.0),
        }
    }
    let quaternions: Vec<usize> = simulation.states().quaternions().map(|q| q.first).collect();
    for first in quaternions {
        let length: f64 = x[first..first + 4]
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt();
        x[first..first + 4].iter_mut().for_each(|x| *x /= length);
    }
    x
}

/// A robot at a random place where its lowest point is a twentieth of a millimetre in the ground.
fn touching(
    random: &mut Random,
    mut model: Model,
    speed: [f64; 2],
) -> (Model, Simulation, Vec<f64>) {
    model.roots[0].position.z = -5.0;
    let mut simulation = exchanged(model.clone());
    let mut x = shaken(&mut simulation, random, speed);
    simulation.set_states(&x);
    let (_, [depth, _]) = simulation.deepest_in_ground().expect("five metres deep");
    let rise = depth - 5e-5;
    model.roots[0].position.z += rise;
    let mut simulation = exchanged(model.clone());
    if model.floats(crate::model::RootId::ROBOT) {
        x[2] += rise;
    }
    simulation.set_states(&x);
    (model, simulation, x)
}

/// A co-simulation of the same model that stands at `x` takes a step of a nanosecond: its mean rate
/// is the derivative, of positions and velocities. Memory that slips takes a faster way in a step.
#[test]
fn derivatives_are_what_a_step_without_length_does() {
    let mut random = Random(5);
    for case in 0..40 {
        let n = 2 + case % 7;
        let h = 1e-9;
        let model = robot(&mut random, n, case % 3 != 0);
        let (model, mut field, x) = touching(&mut random, model, [0.5, 1e-7]);
        let mut steps = Simulation::new(Arc::new(model));
        // Else it would take a longer one, and show a part of it.
        steps.set_rules(crate::tuning::Rules {
            look_ahead: false,
            ..crate::tuning::Rules::ALL
        });
        steps.initialize(0.0).expect("a sound model");
        let rates = derivatives(&mut field, &x);
        let mut physical = steps.state().physical.clone();
        steps.states().clone().write(&x, &mut physical);
        steps.state_mut().physical = physical;
        steps.advance_to(h).expect("finite");
        let after = states(&mut steps);
        let worst = |place: fn(&Place) -> bool| {
            let all = steps
                .states()
                .iter()
                .zip(rates.iter().zip(x.iter().zip(&after)));
            let of = all.filter(|(state, _)| place(&state.place));
            let mut largest = 0.0_f64;
            let mut off = 0.0_f64;
            for (_, (rate, (before, after))) in of {
                largest = largest.max(rate.abs());
                off = off.max(((after - before) / h - rate).abs());
            }
            (off, largest)
        };
        let (off, largest) = worst(|place| matches!(place, Place::Position(_)));
        assert!(
            off <= 1e-4 * (1.0 + largest),
            "case {case}: position {off} of {largest}"
        );
        let (off, largest) = worst(|place| matches!(place, Place::Velocity(_)));
        assert!(
            off <= 1e-3 * (1.0 + largest),
            "case {case}: velocity {off} of {largest}"
        );
    }
}

/// Classical Runge–Kutta, to have something independent of the steps.
fn integrate(simulation: &mut Simulation, x: &mut [f64], h: f64, steps: usize) {
    let add = |x: &[f64], k: &[f64], h: f64| -> Vec<f64> {
        x.iter().zip(k).map(|(x, k)| x + h * k).collect()
    };
    for _ in 0..steps {
        let k1 = derivatives(simulation, x);
        let k2 = derivatives(simulation, &add(x, &k1, 0.5 * h));
        let k3 = derivatives(simulation, &add(x, &k2, 0.5 * h));
        let k4 = derivatives(simulation, &add(x, &k3, h));
        for (i, x) in x.iter_mut().enumerate() {
            *x += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    simulation.set_states(x);
}

/// Linear momentum of a tree and its angular momentum about the world's origin.
fn momentum(simulation: &Simulation) -> Vec6 {
    let (tree, at) = (simulation.tree(), &simulation.state().physical);
    let mut kin = Kinematics::new(tree);
    kin.update_poses(tree, &at.q);
    kin.update_velocities(tree, &at.v);
    rnea::bias(tree, &mut kin, &at.v, &[], 0.0);
    let mut sum = energy::momentum(&kin, 0..kin.V.len());
    let shift = kin.origins[0].cross(&Vec3::new(sum[3], sum[4], sum[5]));
    for axis in 0..3 {
        sum[axis] += shift[axis];
    }
    sum
}

/// Without ground, motors and damping nothing is lost: energy; and of trees in flight momentum,
/// which without gravity keeps its value.
#[test]
fn trees_in_flight_keep_energy_and_momentum() {
    let mut random = Random(7);
    for case in 0..200 {
        let floating = case % 2 == 0;
        let mut model = random_tree(&mut random, 1 + case % 9, floating, case % 5 == 4);
        model.outputs.interface = Interface::Me;
        if case % 4 == 0 {
            model.world.gravity = Vec3::zeros();
        }
        let weightless = case % 4 == 0;
        let weight = model.world.gravity * model.links.iter().map(|l| l.inertia.mass).sum::<f64>();
        let mut simulation = exchanged(model);
        let mut x = shaken(&mut simulation, &mut random, [1.0, 0.0]);
        simulation.set_states(&x);
        let energy = |simulation: &mut Simulation| {
            simulation.output(OutputSlot::EnergyKinetic)
                + simulation.output(OutputSlot::EnergyPotential)
        };
        let (before, kinetic) = (
            energy(&mut simulation),
            simulation.output(OutputSlot::EnergyKinetic),
        );
        let begin = momentum(&simulation);
        let (h, steps) = (1e-3, 200);
        integrate(&mut simulation, &mut x, h, steps);
        let change = energy(&mut simulation) - before;
        assert!(
            change.abs() < 1e-8 * (1.0 + kinetic),
            "case {case}: {change} of {kinetic}"
        );
        if !floating {
            continue;
        }
        let (end, time) = (momentum(&simulation), h * 200.0);
        let size = 1.0 + begin.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
        for axis in 0..6 {
            if axis < 3 && !weightless {
                continue;
            }
            let gained = if axis < 3 {
                0.0
            } else {
                weight[axis - 3] * time
            };
            let off = end[axis] - begin[axis] - gained;
            assert!(off.abs() < 1e-8 * size, "case {case}, axis {axis}: {off}");
        }
    }
}

/// A passive robot on the ground loses energy and never gains any. With friction it may gain what
/// the stiffness of friction, which grows with the load, adds to a displacement that is there: at
/// most a thousandth.
#[test]
fn passive_trees_on_the_ground_only_lose_energy() {
    let mut random = Random(11);
    for case in 0..20 {
        let mut model = robot(&mut random, 1 + case % 4, true);
        model.actuators.clear();
        let rough = case % 2 == 0;
        if !rough {
            model.world.ground = Some(Ground::default());
        }
        let (_, mut simulation, mut x) = touching(&mut random, model, [0.3, 0.0]);
        // Springs of contacts hold nothing yet.
        x[2] += 5e-5;
        simulation.set_states(&x);
        let energy = |simulation: &mut Simulation| {
            simulation.output(OutputSlot::EnergyKinetic)
                + simulation.output(OutputSlot::EnergyPotential)
        };
        let begin = energy(&mut simulation);
        for _ in 0..20 {
            integrate(&mut simulation, &mut x, 2e-6, 500);
            let now = energy(&mut simulation);
            let share = if rough { 1e-3 } else { 1e-9 };
            assert!(
                now <= begin * (1.0 + share),
                "case {case}: {begin} J, then {now} J"
            );
        }
    }
}

/// Every state has a row, and every row of a derivative its state.
#[test]
fn the_table_lists_states_and_their_derivatives() {
    let mut random = Random(3);
    for case in 0..10 {
        let model = robot(&mut random, 1 + case % 6, case % 2 == 0);
        let rows = table(&model).expect("no clash");
        let simulation = exchanged(model);
        let count = simulation.states().len();
        let states: Vec<_> = rows.iter().filter_map(|row| row.state).collect();
        assert_eq!(states.len(), count);
        let rates = rows
            .iter()
            .filter(|row| matches!(row.slot, Slot::Output(OutputSlot::Rate(_))));
        assert_eq!(rates.count(), count);
    }
}

/// What an integrator's errors have made of the length of a quaternion goes by e in half a second,
/// and the orientation is not touched by it.
#[test]
fn quaternions_come_back_to_unit_length() {
    let mut random = Random(13);
    let mut model = random_tree(&mut random, 3, true, false);
    model.outputs.interface = Interface::Me;
    let mut simulation = exchanged(model);
    let mut x = shaken(&mut simulation, &mut random, [1.0, 0.0]);
    let mut y = x.clone();
    let first = simulation
        .states()
        .quaternions()
        .next()
        .expect("it floats")
        .first;
    for y in &mut y[first..first + 4] {
        *y *= 1.001;
    }
    let length = |x: &[f64]| {
        x[first..first + 4]
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt()
    };
    integrate(&mut simulation, &mut x, 1e-3, 500);
    integrate(&mut simulation, &mut y, 1e-3, 500);
    // d(|q| − 1)/dt = −2 γ (|q| − 1) for small ones.
    assert!(((length(&y) - 1.0) / 1e-3 - (-1.0_f64).exp()).abs() < 1e-2);
    for i in first..first + 4 {
        assert!((y[i] / length(&y) - x[i] / length(&x)).abs() < 1e-9);
    }
}

/// A ball of 5 cm that falls from 2 m on a board of 2 cm, and two balls that fly at each other,
/// without gravity: at each event that is announced nothing has passed the other's middle, which
/// closed forms say, and a few events lead to the touch. Before, `SciPy`'s and `FMPy`'s integrators
/// went through boards, meshes and other balls, since free flight gives no error.
#[test]
fn what_falls_on_thin_things_is_announced_in_time() {
    for (falls, gravity) in [(true, 9.81), (false, 0.0)] {
        let ball = Shape::Sphere { radius: 0.05 };
        let (height, speed, other) = if falls {
            let half = Vec3::new(1.0, 1.0, 0.01);
            (2.0, 0.0, Shape::Box { half })
        } else {
            (1.0, 2.0, ball.clone())
        };
        let mut model = single(&ball, Vec3::z() * height);
        model.join(single(&other, Vec3::zeros()), "other", RootKind::Object);
        model.world.gravity = Vec3::z() * -gravity;
        model.world.ground = None;
        model.outputs.interface = Interface::Both;
        model.validate().expect("valid");
        let mut s = exchanged(model);
        let (q, v) = (s.state().physical.q.clone(), s.state().physical.v.clone());
        // They touch at this distance, and have not passed each other within the mean of their
        // half thicknesses.
        let [reach, thickness] = if falls { [0.06, 0.03] } else { [0.1, 0.05] };
        let mut time = 0.0;
        let mut events = 0;
        loop {
            let gap = height - speed * time - 0.5 * gravity * time * time - reach;
            // The board falls as the ball does unless it is held.
            let mut physical = s.state().physical.clone();
            physical.q.copy_from_slice(&q);
            physical.v.copy_from_slice(&v);
            physical.q[2] = gap + reach;
            physical.v[5] = -speed - gravity * time;
            let mut x = vec![0.0; s.states().len()];
            s.states().read(&physical, &mut x);
            s.set_states(&x);
            s.set_time(time);
            assert!(gap > -thickness, "{gap} m after {events} events");
            if gap < 0.0 {
                break;
            }
            let next = s.plan_event().expect("shapes that can pass each other");
            assert!(next > time && !s.has_event());
            time = next;
            events += 1;
        }
        assert!(events < 20, "{events}");
        s.plan_event();
        assert!(s.indicator() > 0.0 && !s.has_event(), "it goes on touching");
        // Half a millimetre apart, where they part.
        let mut physical = s.state().physical.clone();
        physical.q[2] = reach + 5e-4;
        physical.v[5] = 0.1;
        let mut x = vec![0.0; s.states().len()];
        s.states().read(&physical, &mut x);
        s.set_states(&x);
        assert!(s.indicator() < 0.0 && s.has_event(), "a contact has ended");
    }
}

/// A ball in the ground that rises at half and at one and a half of the speed from which on nothing
/// pushes it goes on touching; at two and a half it has left, and is no event any more after it.
#[test]
fn what_leaves_faster_than_anything_pushes_it_has_left() {
    let ball = Shape::Sphere { radius: 0.05 };
    let mut model = single(&ball, Vec3::z() * 0.05);
    model.world.ground = Some(Ground::default());
    model.outputs.interface = Interface::Both;
    let mut s = exchanged(model);
    let pushed_below = 1.0 / s.tree().contact.dissipation;
    let at = |s: &mut Simulation, rise: f64, share: f64| {
        let mut physical = s.state().physical.clone();
        (physical.q[2], physical.v[5]) = (0.05 + rise, share * pushed_below);
        let mut x = vec![0.0; s.states().len()];
        s.states().read(&physical, &mut x);
        derivatives(s, &x);
    };
    let apart = 1e-3;
    at(&mut s, apart, 0.0);
    s.plan_event();
    assert!(s.indicator() >= 1.0, "nothing touches");
    // A trial place does not count.
    at(&mut s, -1e-4, 0.0);
    at(&mut s, apart, 0.0);
    assert!(s.indicator() >= 1.0 && !s.has_event());
    for (share, left) in [(0.5, false), (1.5, false), (2.5, true)] {
        at(&mut s, -1e-4, 0.0);
        assert!(s.indicator() > 0.0, "it touches");
        at(&mut s, -1e-4, share);
        let indicator = s.reading().margin();
        assert_eq!(indicator < 0.0, left, "{share}: {indicator}");
        assert_eq!(s.indicator().to_bits(), indicator.to_bits());
        assert_eq!(s.has_event(), left, "{share}");
    }
    s.plan_event();
    assert!(
        s.indicator() >= 1.0 && !s.has_event(),
        "it has left already"
    );
}

/// A joint of 1 kg·m² at its limit, with a stiffness of 10⁶ N·m/rad there, that a motor of as much
/// or a thousand times less holds, or none. It comes to its limit within a step, where derivatives
/// are asked for, and has left it at the end of the step.
#[test]
fn a_joint_that_has_left_its_limit_is_announced_unless_its_motor_holds_it() {
    for (effort, announced) in [(None, true), (Some(1e3), false), (Some(1.0), true)] {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let motion = Motion::Revolute(Vec3::y());
        let body = inertia(1.0, Vec3::zeros(), [1.0; 3]);
        let link = b.link(LinkId(0), Pose::IDENTITY, motion, body);
        b.limits(link, 0.0, 1.0);
        if let Some(effort) = effort {
            b.actuator(link, ActuatorMode::Position, effort);
        }
        let mut model = b.model;
        model.world.gravity = Vec3::zeros();
        model.outputs.interface = Interface::Both;
        let mut s = exchanged(model);
        s.plan_event();
        let inside = derivatives(&mut s, &[1e-6, 0.0]);
        assert!(!s.has_event(), "it has not been at its limit");
        let beyond = derivatives(&mut s, &[-1e-6, 0.0]);
        assert!(
            beyond[1] - inside[1] > 0.9,
            "a limit of 10⁶ N·m/rad acts: {beyond:?}"
        );
        s.set_states(&[1e-6, 0.0]);
        assert_eq!(s.has_event(), announced, "{effort:?}");
    }
}
