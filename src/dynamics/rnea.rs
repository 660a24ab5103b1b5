//! The bias of the equations of motion by the recursive Newton–Euler algorithm.
//!
//! Source: Featherstone 2008, table 5.1, in world axes.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::inputs::ExternalWrench;
use crate::kinematics::Kinematics;
use crate::spatial::{Vec3, Vec6, add6, angular, cross_force, dot6, linear};
use crate::tree::Tree;
use crate::tuning::DRIVEN_MASS;

/// Fills `kin.bias` with `k(q, v)`, so that `M vdot + k = tau`, from `kin.S`, `kin.V` and `kin.I`,
/// and `J̇v` of closed loops.
///
/// - `v`: `nv`, the velocities that `kin.V` was made from
/// - `wrenches`: external wrenches on bodies, `t` seconds after the communication point; they are
///   taken off the bias
pub fn bias(tree: &Tree, kin: &mut Kinematics, v: &[f64], wrenches: &[ExternalWrench], t: f64) {
    let mut force = std::mem::take(&mut kin.force);
    body_forces(tree, kin, v, &mut force);
    add_drag(tree, kin, &mut force);
    add_wrenches(kin, wrenches, t, &mut force);
    kin.force = force;
    let Kinematics { S, force, bias, .. } = kin;
    if !tree.pure {
        bias.fill(0.0);
    }
    for span in tree.island.spans.iter().rev() {
        for (b, body) in tree.bodies_of(span).rev() {
            let F = force[b];
            if body.kind.is_free() {
                bias[body.dof..body.dof + 6].copy_from_slice(&F);
                continue;
            }
            if !body.kind.moves() {
                continue;
            }
            for c in body.column..body.column + body.columns {
                let k = dot6(&S[c], &F);
                if tree.pure {
                    bias[c] = k;
                } else {
                    bias[tree.dof[c]] += k;
                }
            }
            add6(&mut force[body.parent], &F);
        }
    }
    for (_, first, acceleration) in tree.driven() {
        for (bias, a) in bias[first..].iter_mut().zip(acceleration) {
            *bias = -DRIVEN_MASS * a;
        }
    }
    kin.update_loop_bias(tree);
}

/// Force that each body needs for `vdot = 0`, with gravity as an upward acceleration of the base.
fn body_forces(tree: &Tree, kin: &mut Kinematics, v: &[f64], force: &mut [Vec6]) {
    let Kinematics { S, V, I, C, .. } = kin;
    let g = tree.world.gravity;
    for span in &tree.island.spans {
        for (b, body) in tree.bodies_of(span) {
            let V_b = &V[b];
            let mut A = if body.kind.is_base() {
                [0.0, 0.0, 0.0, -g.x, -g.y, -g.z]
            } else {
                C[body.parent]
            };
            if body.kind.moves() {
                let product = body
                    .kind
                    .velocity_product(V_b, &S[body.column..], &v[body.dof..]);
                add6(&mut A, &product);
            }
            C[b] = A;
            if !body.kind.moves() {
                force[b] = [0.0; 6];
                continue;
            }
            // `I A + V ×f (I V)`
            let mut F = I[b].mul(&C[b]);
            add6(&mut F, &cross_force(V_b, &I[b].mul(V_b)));
            force[b] = F;
        }
    }
}

/// Takes external wrenches off the forces that the bodies need.
pub(super) fn add_wrenches(
    kin: &Kinematics,
    wrenches: &[ExternalWrench],
    t: f64,
    force: &mut [Vec6],
) {
    for w in wrenches {
        let wrench = about_origin(kin, w, t);
        for (F, w) in force[w.body].iter_mut().zip(wrench) {
            *F -= w;
        }
    }
}

/// An external wrench about O, `t` seconds after the communication point.
pub(crate) fn about_origin(kin: &Kinematics, w: &ExternalWrench, t: f64) -> Vec6 {
    let x = kin.X[w.body].point(&w.point);
    let wrench = w.at(t);
    let f = linear(&wrench);
    let torque = angular(&wrench) + x.cross(&f);
    [torque.x, torque.y, torque.z, f.x, f.y, f.z]
}

/// Adds the drag of every body to the forces that the bodies need; see
/// [`crate::model::World::drag`].
pub(super) fn add_drag(tree: &Tree, kin: &Kinematics, force: &mut [Vec6]) {
    if tree.world.drag == 0.0 {
        return;
    }
    for (b, body) in tree.worked_bodies() {
        let I = &kin.I[b];
        if I.mass <= 0.0 || !body.kind.moves() {
            continue;
        }
        // Momentum about O, split into that of the centre of mass and the spin about it.
        let momentum = I.mul(&kin.V[b]);
        let p = linear(&momentum);
        let orbit = Vec3::from(I.moment).cross(&p) / I.mass;
        let spin = angular(&momentum) - orbit;
        let along = tree.world.drag * (1.0 + p.norm() / I.mass);
        let about = tree.world.drag * (1.0 + angular(&kin.V[b]).norm());
        let torque = spin * about + orbit * along;
        let F = &mut force[b];
        for i in 0..3 {
            F[i] += torque[i];
            F[3 + i] += p[i] * along;
        }
    }
}
