//! Properties of the step: saved states, convergence, what must not break it.

use super::*;

/// A model with everything in it, falling onto the ground.
fn everything() -> Model {
    let mut random = Random(11);
    let mut model = random_tree(&mut random, 9, true, true);
    shape_all_links(&mut model);
    model.world.ground = Some(crate::model::Ground {
        friction: 0.8,
        restitution: 0.3,
        ..Default::default()
    });
    model.roots[0].position.z = 1.2;
    for (i, link) in model.links.iter_mut().enumerate() {
        link.static_excess = [0.0, 0.3][i % 2];
        link.rolling_friction = [1e-3, 0.0][i % 2];
        link.torsional_friction = [0.0, 2e-3, 5e-3][i % 3];
    }
    for joint in &mut model.joints {
        joint.damping = 0.1;
        joint.friction = 0.05;
        joint.static_excess = 0.5;
        joint.velocity = Some(4.0);
        joint.enforce_velocity = true;
    }
    let joint = model.joints[0].clone();
    let body = joint.bodies[0];
    model.actuators.push(crate::model::Actuator {
        joint: 0usize.into(),
        dof: model.bodies[body.index()].dof,
        mode: ActuatorMode::Velocity,
        max_effort: 5.0,
        reference_effort: 5.0,
        kp: 0.0,
        kd: 0.0,
        no_load_speed: Some(8.0),
    });
    model
}

#[test]
fn a_saved_state_continues_bit_for_bit_through_bytes_and_in_another_instance() {
    let model = everything();
    let mut s = start(model.clone(), 1e-3);
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 3.0);
    run(&mut s, 0.7, 1.0 / 240.0);
    let saved = s.save();
    let bytes = saved.to_bytes();
    assert_eq!(bytes.len(), saved.byte_len());
    run(&mut s, 1.5, 1.0 / 240.0);
    let expected = s.state().clone();
    s.restore(&saved).expect("its own state");
    run(&mut s, 1.5, 1.0 / 240.0);
    assert_eq!(s.state(), &expected);
    let read = crate::simulation::Snapshot::from_bytes(&s.model().clone(), &bytes)
        .expect("what was written");
    let mut other = start(
        Model {
            solver: s.model().solver.clone(),
            ..model
        },
        1e-3,
    );
    other.restore(&read).expect("the same model");
    run(&mut other, 1.5, 1.0 / 240.0);
    assert_eq!(other.state(), &expected);
}

#[test]
fn changed_bytes_of_a_saved_state_are_refused() {
    let s = start(everything(), 1e-3);
    let model = s.model().clone();
    let bytes = s.save().to_bytes();
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 0x10;
        assert!(crate::simulation::Snapshot::from_bytes(&model, &changed).is_err());
        assert!(crate::simulation::Snapshot::from_bytes(&model, &bytes[..place]).is_err());
    }
}

#[test]
fn the_communication_step_does_not_change_the_result_beyond_the_tolerance() {
    let mut ends = Vec::new();
    for h in [1.0 / 1000.0, 1.0 / 240.0, 1.0 / 60.0, 0.1] {
        let mut b = block(1.0, 0.5);
        b.model.roots[0].linear_velocity = Vec3::new(1.0, 0.5, 0.0);
        b.model.roots[0].angular_velocity.z = 2.0;
        let mut s = start(b.model, 1e-4);
        run(&mut s, 1.0, h);
        ends.push(Vec3::new(
            s.state().physical.q[0],
            s.state().physical.q[1],
            s.state().physical.q[6],
        ));
    }
    for end in &ends {
        assert!((end - ends[0]).norm() < 1e-3, "{ends:?}");
    }
}

/// Steps and reads two equal simulations, one with every number of its scratch NaN, every index
/// beyond all lists and every flag true; states and outputs must be the same to the last bit.
fn same_with_spoilt_scratch(mut model: Model) {
    model.outputs.links = (0..model.links.len()).map(LinkId::from).collect();
    for fixed in [0.0, 1.0 / 240.0] {
        model.solver.step_size = fixed;
        let mut a = start(model.clone(), 1e-3);
        let mut b = start(model.clone(), 1e-3);
        let outputs = |s: &mut Simulation| -> Vec<u64> {
            let table = crate::variables::table(s.model()).expect("distinct names");
            let slots = table.iter().filter_map(|variable| match variable.slot {
                crate::variables::Slot::Output(slot) => Some(slot),
                _ => None,
            });
            slots.map(|slot| s.output(slot).to_bits()).collect()
        };
        for i in 1..=100 {
            let t = f64::from(i) / 240.0;
            b.spoil();
            a.advance_to(t).expect("finite");
            b.advance_to(t).expect("finite");
            assert!(a.state() == b.state(), "fixed {fixed}, step {i}");
            b.spoil();
            assert_eq!(outputs(&mut a), outputs(&mut b), "fixed {fixed}, step {i}");
        }
    }
}

/// A robot with everything in it, one in flight, whose steps are explicit and reach beyond the
/// communication point, and the same with damping.
#[test]
fn nan_in_the_scratch_between_steps_changes_nothing() {
    let mut flying = random_tree(&mut Random(5), 9, true, false);
    flying.roots[0].angular_velocity = Vec3::new(1.0, 2.0, 3.0);
    let mut damped = flying.clone();
    for joint in &mut damped.joints {
        joint.damping = 10.0;
    }
    for model in [everything(), flying, damped] {
        same_with_spoilt_scratch(model);
    }
}

/// A long chain, whose accelerations are those of articulated bodies.
#[test]
fn nan_in_the_scratch_of_a_long_chain_changes_nothing() {
    let mut chain = Builder::new(false, RigidInertia::ZERO);
    for i in 0..60u32 {
        let body = inertia(0.1, X * 0.05, [1e-4; 3]);
        chain.link(LinkId(i), at(0.1, 0.0, 0.0), Motion::Revolute(Y), body);
    }
    same_with_spoilt_scratch(chain.model);
}

/// Gives every surface friction at rest, against rolling and against turning.
fn roughen(model: &mut Model, random: &mut Random) {
    for link in &mut model.links {
        link.static_excess = random.uniform(0.0, 0.5);
        link.rolling_friction = libm::pow(10.0, random.uniform(-6.0, -1.0));
        link.torsional_friction = libm::pow(10.0, random.uniform(-6.0, -1.0));
    }
}

/// A random robot with random actuators and masses over six decades.
fn random_robot(seed: u64, random: &mut Random) -> Model {
    let mut model = random_tree(random, 2 + seed as usize % 9, true, seed.is_multiple_of(3));
    for (i, link) in model.links.iter_mut().enumerate() {
        let scale = libm::pow(10.0, random.uniform(-3.0, 3.0));
        link.inertia.mass *= scale;
        link.inertia.I_cm *= scale;
        let shape = match (i as u64 + seed) % 4 {
            0 => Shape::Sphere {
                radius: random.uniform(0.01, 0.3),
            },
            1 => Shape::Cylinder {
                radius: 0.08,
                half_length: random.uniform(0.01, 0.3),
            },
            2 => Shape::Box {
                half: Vec3::from_fn(|_, _| random.uniform(0.01, 0.2)),
            },
            _ => Shape::Capsule {
                radius: 0.05,
                half_length: 0.1,
            },
        };
        model.colliders.push(crate::model::Collider {
            link: i.into(),
            body: link.body,
            X_BG: Pose::from_xyz_rpy(random.vector(0.1), random.vector(3.0)),
            shape,
        });
    }
    let e = if seed.is_multiple_of(2) {
        0.0
    } else {
        random.uniform(0.0, 1.0)
    };
    model.world.ground = Some(crate::model::Ground {
        friction: random.uniform(0.0, 1.5),
        restitution: e,
        ..Default::default()
    });
    if seed % 3 == 1 {
        roughen(&mut model, random);
    }
    model.roots[0].position.z = random.uniform(-0.3, 1.5);
    model.roots[0].rpy = random.vector(3.0);
    for joint in &mut model.joints {
        joint.damping = libm::pow(10.0, random.uniform(-4.0, 3.0));
        joint.friction = random.uniform(0.0, 1.0);
        joint.static_excess = [0.0, 0.5][seed as usize % 2];
        if seed % 4 == 2 {
            joint.velocity = Some(random.uniform(0.1, 10.0));
            joint.enforce_velocity = true;
        }
    }
    let modes = [
        ActuatorMode::Velocity,
        ActuatorMode::Position,
        ActuatorMode::Effort,
        ActuatorMode::Pd,
    ];
    for joint in 0..model.joints.len() {
        let body = &model.bodies[model.joints[joint].bodies[0].index()];
        if model.joints[joint].mimic.is_some() || body.motion.nv() != 1 {
            continue;
        }
        let effort = libm::pow(10.0, random.uniform(-3.0, 4.0));
        model.actuators.push(crate::model::Actuator {
            joint: joint.into(),
            dof: body.dof,
            mode: modes[joint % 4],
            max_effort: effort,
            reference_effort: effort,
            kp: libm::pow(10.0, random.uniform(0.0, 6.0)),
            kd: libm::pow(10.0, random.uniform(-1.0, 4.0)),
            no_load_speed: (seed % 4 == 1).then(|| random.uniform(0.1, 50.0)),
        });
        if joint % 3 == 0 {
            model.dofs[body.dof.index()].limits = Some(crate::model::Limits {
                lower: -0.5,
                upper: 0.5,
            });
        }
    }
    if seed.is_multiple_of(5) {
        model.solver.step_size = 1.0 / 240.0;
    }
    model
}

/// Random robots with random actuators, masses over six decades, random commands and steps: nothing
/// fails.
#[test]
fn random_robots_under_random_commands_stay_finite() {
    for seed in 0..40_u64 {
        let mut random = Random(seed);
        let model = random_robot(seed, &mut random);
        let actuators = model.actuators.len();
        let mut s = start(model, 1e-3);
        let mut t = 0.0;
        for step in 0..150 {
            if step % 10 == 0 {
                for a in 0..actuators {
                    let a = ActuatorId::from(a);
                    s.set_input(InputSlot::Velocity(a), random.uniform(-30.0, 30.0));
                    s.set_input(InputSlot::Position(a), random.uniform(-1.0, 1.0));
                    s.set_input(InputSlot::Effort(a), random.uniform(-50.0, 50.0));
                }
            }
            t += libm::pow(10.0, random.uniform(-5.0, -1.5));
            let result = s.advance_to(t);
            assert!(result.is_ok(), "seed {seed}, t = {t}: {result:?}");
        }
        // Not stalled, either: chattering contacts of gram-sized links on tonnes do not drive the
        // step to nothing.
        let taken = s.state().stepping.counters.steps + s.state().stepping.counters.rejected;
        assert!(
            taken < 100_000,
            "seed {seed}: {:?}",
            s.state().stepping.counters
        );
    }
}

/// A tolerance a hundred times as tight reduces the error of a motion through contact: the step
/// converges. Each block falls on its corners, one after the other, which amplifies what is off
/// before, in some falls much more than in others: the geometric mean counts.
#[test]
fn tighter_tolerances_converge_through_contact_and_friction() {
    let mut random = Random(77);
    let mut sums = [0.0; 4];
    for _ in 0..20 {
        let mut in_plane = |most: f64| random.uniform(-most, most);
        let speed = Vec3::new(in_plane(1.0), in_plane(1.0), 0.0);
        let spin = Vec3::new(in_plane(0.5), in_plane(0.5), in_plane(1.0));
        let end = |tolerance: f64| {
            let mut b = block(1.0, 0.4);
            b.model.roots[0].position.z = 0.15;
            b.model.roots[0].linear_velocity = speed;
            b.model.roots[0].angular_velocity = spin;
            let mut s = start(b.model, tolerance);
            run(&mut s, 0.5, 0.05);
            let q = &s.state().physical.q;
            Vec3::new(q[0], q[1], q[6])
        };
        let exact = end(1e-9);
        for (sum, tolerance) in sums.iter_mut().zip([1e-3, 1e-4, 1e-5, 1e-6]) {
            *sum += libm::log10((end(tolerance) - exact).norm()) / 20.0;
        }
    }
    let errors = sums.map(|mean| libm::pow(10.0, mean));
    assert!(errors[0] < 1.5e-2 && errors[3] < 1.5e-4, "{errors:?}");
    let falls = |three: &[f64]| three[2] < 0.2 * three[0];
    assert!(errors.windows(3).all(falls), "{errors:?}");
}

/// A hinged link deep in the ground that its mounting does not let out: the host lives, and so does
/// the state.
#[test]
fn a_link_stuck_deep_in_the_ground_stays_finite() {
    for rpy in [
        Vec3::new(0.3, 0.2, 0.1),
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(1.5, 0.0, 0.3),
    ] {
        for friction in [0.0, 0.8, 1.5] {
            let mut b = Builder::new(false, RigidInertia::ZERO);
            let link = b.link(
                0u32.into_link(),
                Pose::IDENTITY,
                Motion::Revolute(Vec3::z()),
                inertia(1.0, Vec3::zeros(), [1.0; 3]),
            );
            b.shape(
                link,
                Shape::Box {
                    half: Vec3::new(0.5, 0.5, 0.5),
                },
                Pose::IDENTITY,
            );
            b.model.links[link.index()].friction = friction;
            b.model.world.ground = Some(crate::model::Ground {
                friction,
                ..Default::default()
            });
            b.model.roots[0].rpy = rpy;
            b.model.joints[0].damping = 1.0;
            b.model.joints[0].friction = 1e-4;
            let mut s = start(b.model, 1e-3);
            run(&mut s, 1.0, 1.0 / 240.0);
            assert!(
                s.state().physical.v.iter().all(|v| v.abs() < 10.0),
                "{rpy} {:?}",
                s.state().physical.v
            );
        }
    }
}

/// Nothing stalls: a joint told to spin at 4e9 rad/s ends its step, rightly or with an error.
#[test]
fn an_absurd_initial_speed_does_not_stall_the_host() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.1, 0.2, 0.15]));
    b.link(
        0u32.into_link(),
        at(0.1, 0.0, 0.0),
        Motion::Revolute(Y),
        inertia(0.5, X * 0.2, [0.01, 0.02, 0.02]),
    );
    b.model.initial.joint_velocities[0] = 4e9;
    let mut s = start(b.model, 1e-3);
    for step in 1..=10 {
        if s.advance_to(f64::from(step) / 240.0).is_err() {
            break;
        }
    }
    assert!(s.state().is_finite());
    assert!(
        s.state().stepping.counters.steps + s.state().stepping.counters.rejected < 100_000,
        "{:?}",
        s.state().stepping.counters
    );
}

/// A saved state carries the pushes from outside; what was pushed since is forgotten.
#[test]
fn a_restored_state_keeps_its_external_wrenches() {
    let mut b = block(1.0, 0.5);
    b.model.outputs.external_wrenches = vec![0u32.into_link()];
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::ExternalForce(0u32.into_link(), 0), 8.0);
    run(&mut s, 0.5, 0.01);
    let saved = s.save();
    run(&mut s, 1.0, 0.01);
    let pushed = s.state().clone();
    s.set_input(InputSlot::ExternalForce(0u32.into_link(), 0), -8.0);
    run(&mut s, 1.2, 0.01);
    s.restore(&saved).expect("its own state");
    run(&mut s, 1.0, 0.01);
    assert_eq!(s.state(), &pushed);
    s.reset();
    s.initialize(0.0).expect("a sound model");
    run(&mut s, 0.5, 0.01);
    assert!(
        s.state().physical.q[0].abs() < 1e-9,
        "a reset robot is not pushed"
    );
}

/// Found by fuzzing: a proposed step of −1e10 s led back that far, and from there forward in small
/// steps.
#[test]
fn a_saved_state_whose_steps_go_back_is_refused() {
    let mut s = start(block(1.0, 0.5).model, 1e-3);
    let model = s.model().clone();
    s.state_mut().stepping.sizes.proposed[0] = -1e10;
    let bytes = s.save().to_bytes();
    assert!(crate::simulation::Snapshot::from_bytes(&model, &bytes).is_err());
}

/// Found by fuzzing: with a link of −1 kg no bounce was short enough.
#[test]
fn a_saved_state_with_parameters_that_nobody_may_set_is_refused() {
    use ParameterSlot as P;
    let link = 0u32.into_link();
    let s = start(block(1.0, 0.5).model, 1e-3);
    for (slot, value) in [
        (P::LinkMass(link), -1.0),
        (P::LinkMass(link), 0.0),
        (P::LinkFriction(link), -0.1),
        (P::GroundFriction, f64::NAN),
        (P::GroundRestitution, 1.1),
        (P::StepSize, 1e-8),
        (P::Tolerance, -1e-3),
        (P::Gravity(2), f64::INFINITY),
    ] {
        assert!(s.check_parameter(slot, value).is_err(), "{slot:?} {value}");
        let mut forged = start(block(1.0, 0.5).model, 1e-3);
        forged.set_parameter(slot, value);
        let bytes = forged.save().to_bytes();
        let read = s.saved_from_bytes(&bytes);
        assert!(read.is_err(), "{slot:?} {value}");
    }
    for (slot, value) in [
        (P::LinkMass(link), 2.0),
        (P::Gravity(2), 9.81),
        (P::StepSize, 1e-7),
    ] {
        let mut changed = start(block(1.0, 0.5).model, 1e-3);
        changed.set_parameter(slot, value);
        let bytes = changed.save().to_bytes();
        assert!(s.saved_from_bytes(&bytes).is_ok(), "{slot:?} {value}");
    }
}

/// As docs/interface.md says of `solver.tolerance`.
#[test]
fn the_tolerance_is_the_models_else_the_importers_else_a_thousandth() {
    for (own, importer, expected) in [(0.0, 0.0, 1e-3), (0.0, 1e-5, 1e-5), (1e-4, 1e-5, 1e-4)] {
        let mut s = start(block(1.0, 0.5).model, own);
        s.set_importer_tolerance(importer);
        assert_eq!(
            s.tolerance().to_bits(),
            f64::to_bits(expected),
            "{own} {importer}"
        );
    }
}
