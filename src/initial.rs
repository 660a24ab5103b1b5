//! The state in which a simulation begins.

use crate::model::{JointId, Model};
use crate::parameters::Parameters;
use crate::slots::{Axis, ParameterSlot as P};
use crate::spatial::{Vec3, quaternion_from_rotation, rotation_from_rpy};
use crate::state::State;

/// The state that the parameters ask for at `time`, s.
pub(crate) fn initial_state(model: &Model, parameters: &Parameters, time: f64) -> State {
    let mut state = State::new(model);
    state.time = time;
    let axes = |slot: fn(Axis) -> P| {
        Vec3::new(
            parameters.get(slot(0)),
            parameters.get(slot(1)),
            parameters.get(slot(2)),
        )
    };
    if model.is_floating() {
        state.physical.q[..3].copy_from_slice(axes(P::InitialBasePosition).as_slice());
        let turn = quaternion_from_rotation(&rotation_from_rpy(&axes(P::InitialBaseRpy)));
        state.physical.q[3..7].copy_from_slice(&[turn.w, turn.i, turn.j, turn.k]);
        state.physical.v[..3].copy_from_slice(axes(P::InitialBaseAngularVelocity).as_slice());
        state.physical.v[3..6].copy_from_slice(axes(P::InitialBaseLinearVelocity).as_slice());
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
