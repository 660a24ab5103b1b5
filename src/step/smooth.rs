//! Explicit steps where nothing is stiff: Dormand–Prince 5(4) on the equations of motion.
//!
//! Used while no shape is near the ground, no limit is near, and no motor, servo or dry friction acts: robots in the
//! air, passive or torque-driven arms. Quaternions are integrated as four numbers and normalised after each step.
//!
//! Source: Dormand & Prince 1980; Hairer, Nørsett & Wanner 1993, section II.5.

use crate::actuator::{Drive, JointTerm};
use crate::dynamics::{crba, rnea};
use crate::kinematics::Kinematics;
use crate::spatial::{quaternion_normalized, quaternion_product};
use crate::tree::{Move, Tree};

const STAGES: usize = 7;

/// Row `i` holds the weights of stages `0 … i` for stage `i + 1`; the last row is the fifth-order solution.
const A: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [
        19372.0 / 6561.0,
        -25360.0 / 2187.0,
        64448.0 / 6561.0,
        -212.0 / 729.0,
        0.0,
        0.0,
    ],
    [
        9017.0 / 3168.0,
        -355.0 / 33.0,
        46732.0 / 5247.0,
        49.0 / 176.0,
        -5103.0 / 18656.0,
        0.0,
    ],
    [
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
];

/// Fifth minus fourth order.
const ERROR: [f64; STAGES] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Scratch of the explicit step.
#[derive(Clone, Debug)]
pub struct Explicit {
    /// Positions after the step.
    pub q: Vec<f64>,
    /// Velocities after the step.
    pub v: Vec<f64>,
    /// Estimated error of the velocities, and of the positions as velocities times time.
    pub error: [Vec<f64>; 2],
    q_rate: [Vec<f64>; STAGES],
    v_rate: [Vec<f64>; STAGES],
    factor: Vec<f64>,
    /// Whether stage 0 holds the rates at the current state.
    fresh: bool,
}

impl Explicit {
    /// Buffers for a tree with `nq` coordinates.
    pub fn new(tree: &Tree, nq: usize) -> Self {
        let nv = tree.sparsity.len();
        Self {
            q: vec![0.0; nq],
            v: vec![0.0; nv],
            error: [vec![0.0; nv], vec![0.0; nv]],
            q_rate: std::array::from_fn(|_| vec![0.0; nq]),
            v_rate: std::array::from_fn(|_| vec![0.0; nv]),
            factor: vec![0.0; tree.sparsity.entries()],
            fresh: false,
        }
    }

    /// Forgets the rates kept from the last step; call it when the state or an input has changed.
    pub fn restart(&mut self) {
        self.fresh = false;
    }

    /// Takes the rates at the end of the last step as those at the start of the next.
    pub fn accept(&mut self) {
        self.q_rate.swap(0, STAGES - 1);
        self.v_rate.swap(0, STAGES - 1);
        self.fresh = true;
    }

    /// One step of `h` seconds from `(q, v)`, into `self.q`, `self.v` and `self.error`. `kin` is overwritten.
    #[expect(clippy::too_many_arguments, reason = "the parts of a right-hand side")]
    pub fn step(
        &mut self,
        tree: &Tree,
        kin: &mut Kinematics,
        joints: &[JointTerm],
        wrenches: &[rnea::ExternalWrench],
        q: &[f64],
        v: &[f64],
        h: f64,
    ) {
        if !self.fresh {
            self.rates(tree, kin, joints, wrenches, 0, q, v);
            self.fresh = true;
        }
        for (stage, weights) in A.iter().enumerate() {
            let mut stage_q = std::mem::take(&mut self.q);
            let mut stage_v = std::mem::take(&mut self.v);
            combine(&mut stage_q, q, &self.q_rate, &weights[..=stage], h);
            combine(&mut stage_v, v, &self.v_rate, &weights[..=stage], h);
            normalize(tree, &mut stage_q);
            self.rates(tree, kin, joints, wrenches, stage + 1, &stage_q, &stage_v);
            self.q = stage_q;
            self.v = stage_v;
        }
        let [velocity, position] = &mut self.error;
        for i in 0..v.len() {
            velocity[i] = 0.0;
            for (rate, weight) in self.v_rate.iter().zip(ERROR) {
                velocity[i] += h * weight * rate[i];
            }
        }
        for body in &tree.bodies {
            let c = body.coordinate;
            let error = |k: usize| -> f64 {
                self.q_rate
                    .iter()
                    .zip(ERROR)
                    .map(|(rate, w)| h * w * rate[k])
                    .sum()
            };
            match body.motion {
                Move::Welded => {}
                Move::Free => {
                    for i in 0..3 {
                        position[3 + i] = error(c + i);
                        // A small change of a unit quaternion is half the angle.
                        position[i] = 2.0 * error(c + 4 + i);
                    }
                    position[0] += 2.0 * error(c + 3);
                }
                Move::Turn | Move::Slide => position[tree.dof[body.column]] = error(c),
                Move::Ball => {
                    for i in 0..3 {
                        position[tree.dof[body.column + i]] = 2.0 * error(c + 1 + i);
                    }
                }
            }
        }
    }

    /// Rates of stage `stage` at `(q, v)`.
    #[expect(clippy::too_many_arguments, reason = "the parts of a right-hand side")]
    fn rates(
        &mut self,
        tree: &Tree,
        kin: &mut Kinematics,
        joints: &[JointTerm],
        wrenches: &[rnea::ExternalWrench],
        stage: usize,
        q: &[f64],
        v: &[f64],
    ) {
        kin.update_poses(tree, q);
        kin.update_velocities(tree, v);
        crba::mass_matrix(tree, kin);
        rnea::bias(tree, kin, v, wrenches);
        let acceleration = &mut self.v_rate[stage];
        for (a, k) in acceleration.iter_mut().zip(&kin.bias) {
            *a = -k;
        }
        for term in joints {
            let effort = match term.drive {
                Drive::Effort(effort) => effort,
                _ => 0.0,
            };
            acceleration[term.dof] += effort - term.damping * v[term.dof];
        }
        self.factor.copy_from_slice(&kin.M);
        tree.sparsity.factor(&mut self.factor);
        tree.sparsity.solve(&self.factor, acceleration);
        position_rates(tree, q, v, &mut self.q_rate[stage]);
    }
}

/// `q̇` for velocities `v`.
fn position_rates(tree: &Tree, q: &[f64], v: &[f64], rate: &mut [f64]) {
    for body in &tree.bodies {
        let c = body.coordinate;
        match body.motion {
            Move::Welded => {}
            Move::Free => {
                rate[c..c + 3].copy_from_slice(&v[3..6]);
                let turn = [0.0, 0.5 * v[0], 0.5 * v[1], 0.5 * v[2]];
                let q = [q[c + 3], q[c + 4], q[c + 5], q[c + 6]];
                rate[c + 3..c + 7].copy_from_slice(&quaternion_product(&turn, &q));
            }
            Move::Turn | Move::Slide => rate[c] = v[tree.dof[body.column]],
            Move::Ball => {
                let d = tree.dof[body.column];
                let turn = [0.0, 0.5 * v[d], 0.5 * v[d + 1], 0.5 * v[d + 2]];
                let q = [q[c], q[c + 1], q[c + 2], q[c + 3]];
                rate[c..c + 4].copy_from_slice(&quaternion_product(&q, &turn));
            }
        }
    }
}

/// `out = start + h Σ weight · rate`.
fn combine(out: &mut [f64], start: &[f64], rates: &[Vec<f64>; STAGES], weights: &[f64], h: f64) {
    for (i, (out, start)) in out.iter_mut().zip(start).enumerate() {
        let mut sum = 0.0;
        for (rate, weight) in rates.iter().zip(weights) {
            sum += weight * rate[i];
        }
        *out = start + h * sum;
    }
}

/// Quaternions back to unit length.
fn normalize(tree: &Tree, q: &mut [f64]) {
    for body in &tree.bodies {
        let c = match body.motion {
            Move::Free => body.coordinate + 3,
            Move::Ball => body.coordinate,
            _ => continue,
        };
        let unit = quaternion_normalized(&[q[c], q[c + 1], q[c + 2], q[c + 3]]);
        q[c..c + 4].copy_from_slice(&unit);
    }
}
