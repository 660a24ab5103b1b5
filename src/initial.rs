//! The state in which a simulation begins.

pub(crate) mod closing;

use crate::closure::Gap;
use crate::kinematics::Kinematics;
#[cfg(feature = "urdf")]
use crate::kinematics::advance;
use crate::model::{Body, JointId, Model, RootId};
use crate::parameters::Parameters;
use crate::slots::ParameterSlot as P;
use crate::spatial::{Vec3, quaternion_from_rotation, rotation_from_rpy};
#[cfg(feature = "urdf")]
use crate::spatial::{rotation_from_quaternion, rpy_from_rotation};
use crate::state::{Physical, State};
use crate::tree::{BaseFrame, Tree, TreeCollider};
#[cfg(feature = "urdf")]
use crate::tuning::SPARE;
use crate::tuning::{DEEP_START, REFERENCE_GRAVITY};

/// The state that the parameters ask for at `time`, s.
#[cfg_attr(small, optimize(size))]
pub(crate) fn initial_state(model: &Model, parameters: &Parameters, time: f64) -> State {
    let mut state = State::new(model);
    state.time = time;
    for (id, root) in (0..).map(RootId).zip(&model.roots) {
        if !model.floats(id) {
            continue;
        }
        let axes = |slot| parameters.of_base(slot, id);
        let body = &model.bodies[root.body.index()];
        let q = &mut state.physical.q[body.coordinate..];
        q[..3].copy_from_slice(axes(P::InitialBasePosition).as_slice());
        let turn = quaternion_from_rotation(&rotation_from_rpy(&axes(P::InitialBaseRpy)));
        q[3..7].copy_from_slice(&[turn.w, turn.i, turn.j, turn.k]);
        let v = &mut state.physical.v[body.dof.index()..];
        v[..3].copy_from_slice(axes(P::InitialBaseAngularVelocity).as_slice());
        v[3..6].copy_from_slice(axes(P::InitialBaseLinearVelocity).as_slice());
        let base = BaseFrame {
            coordinate: body.coordinate,
            dof: body.dof.index(),
            center: model.solver_frame(root.body).p,
        };
        base.take_link(&mut state.physical.q, &mut state.physical.v);
    }
    for (id, joint) in (0..).map(JointId).zip(&model.joints) {
        let Some(body) = model.scalar_body(id) else {
            continue;
        };
        if joint.mimic.is_none() {
            let body = &model.bodies[body.index()];
            state.physical.q[body.coordinate] = parameters.get(P::InitialJointPosition(id));
            state.physical.v[body.dof.index()] = parameters.get(P::InitialJointVelocity(id));
        }
    }
    state
}

/// Shapes that are deeper in the ground than their contacts carry the weight at rest, at the poses
/// of `kin`, and how deep each is, m. What no force moves does not touch the ground.
///
/// Springs are made for the weight under standard gravity, and deep where they push with
/// [`DEEP_START`] times as much. A weight that is greater makes them deeper: what is deep pushes as
/// many times as hard then.
///
/// - `tree`: with springs that are made for the weight, see [`Tree::scale`]
#[cfg_attr(small, optimize(size))]
pub(crate) fn in_ground<'a>(
    model: &'a Model,
    (tree, kin): (&'a Tree, &'a Kinematics),
) -> impl Iterator<Item = (&'a TreeCollider, f64)> {
    let colliders = tree.contact.colliders.iter().filter(|c| c.yields);
    let depths = colliders.map(|c| {
        let pose = kin.X[c.body].compose(&c.X);
        let lowest = model.colliders[c.index].shape.lowest(&pose, &Vec3::z());
        (c, -(kin.origin(tree, c.body).z + lowest))
    });
    let weights = (-tree.world.gravity.z / REFERENCE_GRAVITY).max(1.0);
    depths.filter(move |(c, depth)| c.spring.weights(*depth) > weights * DEEP_START)
}

/// Closes the loops of the initial state that the parameters ask for: what they say otherwise than
/// the model does, and velocities that are not 0, stay if they can. Returns the widest loop that
/// stays open.
///
/// Spherical, planar and floating joints have no initial value. They begin where they close the
/// loops of the model's own initial state, whose other joints are where they do.
pub(crate) fn close(
    model: &Model,
    parameters: &Parameters,
    tree: &Tree,
    kin: &mut Kinematics,
    state: &mut Physical,
) -> Option<(usize, Gap)> {
    let mut given = [vec![false; model.nv()], vec![false; model.nv()]];
    for (id, joint) in (0..).map(JointId).zip(&model.joints) {
        if let (Some(body), None) = (model.scalar_body(id), joint.mimic) {
            let dof = model.bodies[body.index()].dof.index();
            let position = parameters.get(P::InitialJointPosition(id));
            let own = model.initial.joint_positions[id.index()];
            given[0][dof] = position.to_bits() != own.to_bits();
            given[1][dof] = parameters.get(P::InitialJointVelocity(id)) != 0.0;
        }
    }
    follow(model, tree, kin, state);
    let [positions, velocities] = &given;
    closing::close(tree, kin, [&|k| positions[k], &|k| velocities[k]], state)
}

/// Puts joints that have no initial value to where they close the loops of the model's own initial
/// state, with all others held.
fn follow(model: &Model, tree: &Tree, kin: &mut Kinematics, state: &mut Physical) {
    let follows = |body: &&Body| {
        body.joint
            .is_some_and(|joint| model.scalar_body(joint).is_none())
    };
    let mut followers = vec![false; model.nv()];
    for body in model.bodies.iter().filter(follows) {
        let dof = body.dof.index();
        followers[dof..dof + body.motion.nv()].fill(true);
    }
    if tree.closures.is_empty() || !followers.contains(&true) {
        return;
    }
    let mut own = initial_state(model, &Parameters::new(model), 0.0).physical;
    closing::close(tree, kin, [&|k| !followers[k], &|_| false], &mut own);
    for body in model.bodies.iter().filter(follows) {
        let places = body.coordinate..body.coordinate + body.motion.nq();
        state.q[places.clone()].copy_from_slice(&own.q[places]);
    }
}

/// Closes the loops of a model's initial state, and makes the closed one the initial state; the
/// same as [`close`] else.
///
/// - `held`: joints whose positions, or velocities, have been given
#[cfg(feature = "urdf")]
pub(crate) fn close_model(model: &mut Model, held: &[Vec<bool>; 2]) -> Option<(usize, Gap)> {
    let parameters = Parameters::new(model);
    let mut tree = Tree::new(model, &parameters);
    let mut state = initial_state(model, &parameters, 0.0).physical;
    let mut kin = Kinematics::new(&tree);
    kin.update_poses(&tree, &state.q);
    crate::dynamics::crba::mass_matrix(&tree, &mut kin);
    let diagonal = |k| kin.M[tree.sparsity.diagonal(k)];
    let inertia: Vec<f64> = (0..model.nv()).map(diagonal).collect();
    tree.scale(model, &inertia, &kin.X);
    tree.mesh(&state.q);
    let mut given = [vec![false; model.nv()], vec![false; model.nv()]];
    let scalar = |model: &Model, id: JointId| {
        let body = model.scalar_body(id)?;
        let independent = model.joints[id.index()].mimic.is_none();
        independent.then(|| {
            let body = &model.bodies[body.index()];
            (body.coordinate, body.dof.index())
        })
    };
    for id in (0..model.joints.len()).map(JointId::from) {
        if let Some((_, dof)) = scalar(model, id) {
            for (given, held) in given.iter_mut().zip(held) {
                given[dof] = held.get(id.index()) == Some(&true);
            }
        }
    }
    let [positions, velocities] = &given;
    let held: [&dyn Fn(usize) -> bool; 2] = [&|k| positions[k], &|k| velocities[k]];
    let before = state.clone();
    let open = closing::close(&tree, &mut kin, held, &mut state);
    // What has hardly moved keeps its very numbers.
    let moved = |from: f64, to: f64| (to - from).abs() > 1e-12;
    for id in (0..model.joints.len()).map(JointId::from) {
        if let Some((c, dof)) = scalar(model, id) {
            if moved(before.q[c], state.q[c]) {
                model.initial.joint_positions[id.index()] = state.q[c];
            }
            if moved(before.v[dof], state.v[dof]) {
                model.initial.joint_velocities[id.index()] = state.v[dof];
            }
        }
    }
    for (id, root) in (0..).map(RootId).zip(&mut model.roots) {
        let Some(base) = tree.base_frame(id) else {
            continue;
        };
        let (c, k) = (base.coordinate, base.dof);
        let changes = |from: &[f64], to: &[f64]| {
            let mut pairs = from.iter().zip(to);
            pairs.any(|(from, to)| moved(*from, *to))
        };
        let position = base.position(&state.q);
        if changes(base.position(&before.q).as_slice(), position.as_slice()) {
            root.position = position;
        }
        let turned = c + 3..c + 7;
        if changes(&before.q[turned.clone()], &state.q[turned]) {
            let turn = [3, 4, 5, 6].map(|i| state.q[c + i]);
            root.rpy = rpy_from_rotation(&rotation_from_quaternion(&turn));
        }
        let velocity = |at: &Physical| base.velocity(&at.q, &at.v);
        if changes(&before.v[k..k + 3], &state.v[k..k + 3])
            || changes(velocity(&before).as_slice(), velocity(&state).as_slice())
        {
            root.angular_velocity = Vec3::from_fn(|i, _| state.v[k + i]);
            root.linear_velocity = velocity(&state);
        }
    }
    open
}

/// Loops that hold nothing, or next to nothing, where the robot begins and where all joints are
/// farther by 1 rad or 1 m: which, and how much of their ends' motion, at most.
#[cfg(feature = "urdf")]
pub(crate) fn idle_loops(model: &Model) -> Vec<(usize, f64)> {
    let parameters = Parameters::new(model);
    let tree = Tree::new(model, &parameters);
    let begin = initial_state(model, &parameters, 0.0).physical.q;
    let mut farther = begin.clone();
    advance(&tree, &begin, &vec![1.0; model.nv()], 1.0, &mut farther);
    let mut shares = vec![0.0_f64; model.loops.len()];
    let mut kin = Kinematics::new(&tree);
    for q in [begin, farther] {
        kin.update_poses(&tree, &q);
        kin.update_loops(&tree);
        for (index, share) in shares.iter_mut().enumerate() {
            *share = share.max(kin.loops.share(&tree, index));
        }
    }
    let shares = shares.into_iter().enumerate();
    shares.filter(|(_, share)| *share < SPARE.sqrt()).collect()
}
