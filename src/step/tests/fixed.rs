//! Properties of fixed steps.

use super::*;

/// Found by fuzzing saved states: 5e-324 s would have been the step, and 1e319 of them a
/// communication step.
#[test]
fn a_fixed_step_that_never_ends_is_refused_or_raised() {
    let s = start(block(1.0, 0.5).model, 1e-3);
    for (step, legal) in [(0.0, true), (1e-7, true), (1e-8, false), (5e-324, false)] {
        let slot = crate::simulation::ParameterSlot::StepSize;
        assert_eq!(s.check_parameter(slot, step).is_ok(), legal, "{step}");
    }
    let mut model = block(1.0, 0.5).model;
    model.solver.step_size = 5e-324;
    let mut s = start(model, 1e-3);
    s.advance_to(1e-4).expect("finite");
    assert!(
        s.state().stepping.counters.steps <= 1001,
        "{:?}",
        s.state().stepping.counters
    );
}

/// Limp arms of a long chain whirl at hundreds of rad/s: fixed steps that took them a radian at a
/// time used to feed them energy until the run ended. A wheel as fast costs no more steps.
#[test]
fn fixed_steps_are_split_for_fast_limbs_but_not_for_wheels() {
    let whirl = |offset: f64| {
        let mut b = Builder::new(true, inertia(5.0, Vec3::zeros(), [0.05; 3]));
        let arm = b.link(
            0u32.into_link(),
            at(0.0, 0.1, 0.0),
            Motion::Revolute(Y),
            inertia(0.5, X * offset, [1e-3; 3]),
        );
        b.link(
            arm,
            at(2.0 * offset, 0.0, 0.0),
            Motion::Revolute(Y),
            inertia(0.3, X * offset, [1e-3; 3]),
        );
        if offset == 0.0 {
            // Two wheels side by side instead.
            b.model.bodies[2].parent = Some(0usize.into());
        }
        b.model.world.gravity = Vec3::zeros();
        b.model.solver.step_size = 1.0 / 240.0;
        b.model.initial.joint_velocities = vec![150.0, -300.0];
        let mut s = start(b.model, 1e-3);
        let before = s.output(OutputSlot::EnergyKinetic);
        run(&mut s, 5.0, 1.0 / 240.0);
        let gained = s.output(OutputSlot::EnergyKinetic) / before - 1.0;
        (gained, s.state().stepping.counters.steps)
    };
    let (gained, steps) = whirl(0.1);
    // At a radian a step it loses 15 %; it must not gain.
    assert!(gained < 1e-3 && gained > -0.2, "{gained}");
    assert!(steps > 2400, "{steps}");
    let (gained, steps) = whirl(0.0);
    assert!(gained.abs() < 1e-9, "{gained}");
    assert_eq!(steps, 1200);
}

/// Found by fuzzing saved states: speeds that no robot has cut each of the shortest fixed steps
/// into 32 parts.
#[test]
fn parts_of_a_fixed_step_are_not_shorter_than_the_shortest_fixed_step() {
    let mut b = Builder::new(true, inertia(5.0, Vec3::zeros(), [0.05; 3]));
    b.link(
        0u32.into_link(),
        at(0.0, 0.1, 0.0),
        Motion::Revolute(Y),
        inertia(0.5, X * 0.1, [1e-3; 3]),
    );
    b.model.world.gravity = Vec3::zeros();
    b.model.solver.step_size = 2e-7;
    b.model.initial.joint_velocities = vec![1e9];
    let mut s = start(b.model, 1e-3);
    // Whether it ends well is not the question here.
    _ = s.advance_to(2e-6);
    assert!(
        s.state().stepping.counters.steps <= 20,
        "{:?}",
        s.state().stepping.counters
    );
}

/// A slider of 2 kg comes to its limit at 1 m/s, at twelve places of its steps. The law of limits
/// pushes with `(1 − d v)₊`, so nothing leaves one faster than `1/d`, which is 2 cm/s. Where the
/// limit pressed as both stages of a step began, they used to throw the slider back at up to 0.7
/// m/s, depending on the place.
#[test]
fn nothing_leaves_a_limit_faster_in_fixed_steps_than_its_law_allows() {
    for (step, effort) in [(1.0 / 240.0, 10.0), (1e-3, 1e3), (0.01, 1e3), (1e-3, 1e5)] {
        for i in 0..12 {
            let mut b = Builder::new(false, RigidInertia::ZERO);
            let cart = b.link(
                LinkId(0),
                Pose::IDENTITY,
                Motion::Prismatic(X),
                inertia(2.0, Vec3::zeros(), [0.1; 3]),
            );
            b.limits(cart, -1.0, 0.1);
            b.model.joints[0].effort = Some(effort);
            b.model.initial.joint_positions = vec![1e-3 * f64::from(i)];
            b.model.initial.joint_velocities = vec![1.0];
            b.model.solver.step_size = step;
            let most = 1.0 / b.model.contact.dissipation;
            let mut s = start(b.model, 1e-3);
            run(&mut s, 0.3, step);
            let v = s.state().physical.v[0];
            assert!(
                v <= 0.0 && v >= -1.001 * most,
                "{v} m/s in steps of {step} s, after {i} mm"
            );
        }
    }
}

/// A force at the middle of a rod acts as gravity of another direction does. Its work was left out
/// of the energy that a fixed step may make, so that the rod was taken in implicit steps of second
/// order, and ended 1 mrad elsewhere.
#[test]
fn a_force_at_the_middle_of_a_rod_acts_as_gravity_does_in_fixed_steps() {
    let swing = |leaning: f64, force: f64| {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        b.link(
            LinkId(0),
            Pose::IDENTITY,
            Motion::Revolute(Y),
            inertia(2.0, X * 0.5, [1e-3, 0.17, 0.17]),
        );
        b.model.world.gravity = Vec3::new(leaning, 0.0, -G);
        b.model.outputs.external_wrenches = vec![LinkId(1)];
        b.model.solver.step_size = 1.0 / 240.0;
        let mut s = start(b.model, 1e-3);
        s.set_input(InputSlot::ExternalForce(LinkId(1), 0), force);
        run(&mut s, 2.0, 1.0 / 240.0);
        s.state().physical.q[0]
    };
    let (pulled, pushed) = (swing(4.0, 0.0), swing(0.0, 8.0));
    assert!((pulled - pushed).abs() < 1e-9, "{pulled} {pushed}");
}

/// A force that grows by 1 kN/s pushes a slider of 1 kg against dry friction of 0.5 N: after 0.1 s
/// it is 4.95 m/s fast. The work of the force was counted with its value at the start of a step,
/// so that each step seemed to make energy, and was taken in parts.
#[test]
fn a_force_that_grows_within_a_fixed_step_is_not_taken_for_energy_out_of_nothing() {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    b.link(
        LinkId(0),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1.0, Vec3::zeros(), [0.1; 3]),
    );
    b.model.joints[0].friction = 0.5;
    b.model.outputs.external_wrenches = vec![LinkId(1)];
    b.model.solver.step_size = 1.0 / 240.0;
    let mut s = start(b.model, 1e-3);
    s.set_input_derivative(InputSlot::ExternalForce(LinkId(1), 0), 1, 1e3);
    s.advance_to(0.1).expect("finite");
    let v = s.state().physical.v[0];
    assert!((v - 4.95).abs() < 1e-3, "{v}");
    let counters = s.state().stepping.counters;
    assert!(
        counters.steps == 24 && counters.rejected == 0,
        "{counters:?}"
    );
}
