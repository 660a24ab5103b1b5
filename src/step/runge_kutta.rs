//! Explicit steps where nothing is stiff: Runge–Kutta pairs on the equations of motion.
//!
//! Used while no shape is near the ground, no limit is near, and no motor, servo or dry friction acts: robots in the
//! air, passive or torque-driven arms. Dormand–Prince 5(4) takes the long steps; Bogacki–Shampine 3(2) those that end
//! early because the communication step does. Quaternions are integrated as four numbers and normalised after each step.
//!
//! Source: Dormand & Prince 1980; Bogacki & Shampine 1989; Hairer, Nørsett & Wanner 1993, sections II.4 to II.6.

use crate::actuator::{self, Drive, JointTerm};
use crate::dynamics::aba::Articulated;
use crate::dynamics::{crba, rnea};
use crate::kinematics::Kinematics;
use crate::spatial::quaternion_product;
use crate::state::ahead::COEFFICIENTS;
use crate::step::point::Context;
use crate::tree::{Move, Tree};

/// Most stages of a pair; the last one stands at the new state.
const STAGES: usize = 7;

/// A Runge–Kutta pair whose last stage is the first of the next step.
#[derive(Debug)]
pub struct Pair {
    /// Row `i` holds the weights of stages `0 … i` for stage `i + 1`; the last row is the solution.
    weights: &'static [&'static [f64]],
    /// Solution minus embedded solution.
    error: &'static [f64],
    /// Order of the error estimate plus one: the error of a step of length h grows like h to this power.
    pub order: i32,
}

/// Dormand–Prince 5(4).
pub static DORMAND_PRINCE: Pair = Pair {
    weights: &[
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
        &[
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
        ],
    ],
    error: &[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339_200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    order: 5,
};

/// Bogacki–Shampine 3(2).
pub static BOGACKI_SHAMPINE: Pair = Pair {
    weights: &[
        &[1.0 / 2.0],
        &[0.0, 3.0 / 4.0],
        &[2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0],
    ],
    error: &[-5.0 / 72.0, 1.0 / 12.0, 1.0 / 9.0, -1.0 / 8.0],
    order: 3,
};

/// Weights of the stages in the last coefficient of Dormand–Prince's continuous extension.
const EXTENSION: [f64; STAGES] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

/// What drives the robot in an explicit step.
#[derive(Clone, Copy, Debug)]
pub struct Smooth<'a> {
    /// The robot, its inputs, and the time at which it stands.
    pub ctx: Context<'a>,
    /// Damping and efforts.
    pub joints: &'a [JointTerm],
}

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
    effort: Vec<f64>,
    articulated: Articulated,
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
            effort: vec![0.0; nv],
            articulated: Articulated::new(tree),
            fresh: false,
        }
    }

    /// Forgets the rates kept from the last step; call it when the state or an input has changed.
    pub fn restart(&mut self) {
        self.fresh = false;
    }

    /// Room for the rates of positions at two states; whatever was kept is forgotten.
    pub fn rates(&mut self) -> [&mut [f64]; 2] {
        self.fresh = false;
        let [first, second, ..] = &mut self.q_rate;
        [first, second]
    }

    /// Takes the rates at the end of the last step by `pair` as those at the start of the next.
    pub fn accept(&mut self, pair: &Pair) {
        self.q_rate.swap(0, pair.weights.len());
        self.v_rate.swap(0, pair.weights.len());
        self.fresh = true;
    }

    /// One step of `h` seconds from `(q, v)`, into `self.q`, `self.v` and `self.error`.
    ///
    /// - `start`: kinematics at `(q, v)`: poses and velocities, and unless the tree is `long` mass matrix and bias
    /// - `kin`: overwritten; stands at the new state afterwards
    #[expect(clippy::too_many_arguments, reason = "start and end of a step")]
    pub fn step(
        &mut self,
        pair: &Pair,
        system: &Smooth,
        start: &Kinematics,
        kin: &mut Kinematics,
        q: &[f64],
        v: &[f64],
        h: f64,
    ) {
        let tree = system.ctx.tree;
        if !self.fresh {
            self.accelerations(system, start, 0, v);
            position_rates(tree, q, v, &mut self.q_rate[0]);
            self.fresh = true;
        }
        for (stage, weights) in pair.weights.iter().enumerate() {
            let mut stage_q = std::mem::take(&mut self.q);
            let mut stage_v = std::mem::take(&mut self.v);
            combine(&mut stage_q, q, &self.q_rate, weights, h);
            combine(&mut stage_v, v, &self.v_rate, weights, h);
            tree.normalize(&mut stage_q);
            // The time of a stage is the sum of its weights.
            let ctx = system.ctx.after(h * weights.iter().sum::<f64>());
            let system = &Smooth { ctx, ..*system };
            kin.update_poses(tree, &stage_q);
            kin.update_velocities(tree, &stage_v);
            if !tree.long {
                crba::mass_matrix(tree, kin);
                rnea::bias(tree, kin, &stage_v, &ctx.inputs.wrenches, ctx.elapsed);
            }
            self.accelerations(system, kin, stage + 1, &stage_v);
            position_rates(tree, &stage_q, &stage_v, &mut self.q_rate[stage + 1]);
            self.q = stage_q;
            self.v = stage_v;
        }
        self.estimate(pair, tree, h);
    }

    /// The polynomials of the step that was just taken by [`DORMAND_PRINCE`] from `(q, v)`, before it is accepted.
    pub fn extension(&self, q: &[f64], v: &[f64], h: f64, coefficients: &mut Vec<f64>) {
        coefficients.clear();
        let parts = [(q, &self.q, &self.q_rate), (v, &self.v, &self.v_rate)];
        for (from, to, rates) in parts {
            for (i, (start, end)) in from.iter().zip(to).enumerate() {
                let difference = end - start;
                let bend = h * rates[0][i] - difference;
                let mut last = 0.0;
                for (rate, weight) in rates.iter().zip(EXTENSION) {
                    last += weight * rate[i];
                }
                let row: [f64; COEFFICIENTS] = [
                    *start,
                    difference,
                    bend,
                    difference - h * rates[STAGES - 1][i] - bend,
                    h * last,
                ];
                coefficients.extend(row);
            }
        }
    }

    /// Errors of the step just taken.
    fn estimate(&mut self, pair: &Pair, tree: &Tree, h: f64) {
        let [velocity, position] = &mut self.error;
        for (i, velocity) in velocity.iter_mut().enumerate() {
            *velocity = 0.0;
            for (rate, weight) in self.v_rate.iter().zip(pair.error) {
                *velocity += h * weight * rate[i];
            }
        }
        for body in &tree.bodies {
            let c = body.coordinate;
            let error = |k: usize| -> f64 {
                self.q_rate
                    .iter()
                    .zip(pair.error)
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

    /// Accelerations of stage `stage` from up-to-date kinematics.
    fn accelerations(&mut self, system: &Smooth, kin: &Kinematics, stage: usize, v: &[f64]) {
        let Context { tree, inputs, .. } = system.ctx;
        let acceleration = &mut self.v_rate[stage];
        self.effort.fill(0.0);
        for term in system.joints {
            let v = v[term.dof];
            let effort = match (term.drive, term.actuator) {
                (Drive::Effort(_), Some(index)) if inputs.varies() => {
                    let command = inputs.command(index, system.ctx.elapsed, 0.0);
                    actuator::effort(system.ctx.model, index, &command)
                }
                (Drive::Effort(effort), _) => effort,
                _ => 0.0,
            };
            self.effort[term.dof] += term.line.cut((effort, 0.0), v).0 - term.damping * v;
        }
        if tree.long {
            self.articulated.accelerations(
                tree,
                kin,
                v,
                &self.effort,
                (&inputs.wrenches, system.ctx.elapsed),
                acceleration,
            );
            return;
        }
        for ((a, k), effort) in acceleration.iter_mut().zip(&kin.bias).zip(&self.effort) {
            *a = effort - k;
        }
        self.factor.copy_from_slice(&kin.M);
        tree.sparsity.factor(&mut self.factor);
        tree.sparsity.solve(&self.factor, acceleration);
    }
}

/// `q̇` for velocities `v`.
pub(super) fn position_rates(tree: &Tree, q: &[f64], v: &[f64], rate: &mut [f64]) {
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
