//! The state in which a simulation begins.

use crate::model::{JointId, Model, RootId};
use crate::parameters::Parameters;
use crate::slots::ParameterSlot as P;
use crate::spatial::{quaternion_from_rotation, rotation_from_rpy};
use crate::state::State;

/// The state that the parameters ask for at `time`, s.
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
