//! Explicit steps where nothing is stiff but damping: Runge–Kutta pairs on the equations of motion.
//!
//! Used while no shape is near the ground, no limit is near, and no motor, servo or dry friction acts: robots in the
//! air, passive or torque-driven arms. Dormand–Prince 5(4) takes the long steps; Bogacki–Shampine 3(2) those that end
//! early because the communication step does. Quaternions are integrated as four numbers and normalised after each step.
//!
//! Damping that is faster than the motion holds explicit steps up. It is linear, and diagonal in joint space, so it may be
//! taken implicitly at no cost: with the velocity `u` of the explicit weights and `z` of the implicit ones
//! ([`KENNEDY_CARPENTER`], whose two sets share the weights of the solution), each stage solves
//!
//! ```text
//! (M(q) + h γ D) v̇ = τ − k(q, u) − D z,    z = v + h Σ (implicit weights of earlier stages) v̇
//! ```
//!
//! with the one factor that an explicit stage needs, too. It is a Runge–Kutta method for `F(u, z)` partitioned by argument,
//! hence of the order of the pair.
//!
//! Source: Dormand & Prince 1980; Bogacki & Shampine 1989; Hairer, Nørsett & Wanner 1993, sections II.4 to II.6; Kennedy &
//! Carpenter 2003 (`ARK4(3)6L[2]SA`); Boscarino, Filbet & Russo 2016 (one function of an explicit and an implicit argument).

use crate::dynamics::aba::Articulated;
use crate::dynamics::{crba, rnea};
use crate::force::{self, Drive, JointTerm};
use crate::kinematics::{Kinematics, position_rates};
use crate::state::ahead::COEFFICIENTS;
use crate::step::point::Context;
use crate::tree::Tree;
use crate::tuning::{DAMPED_SHARE, EXPLICIT_SHARE};

/// Most stages of a pair; the last one stands at the new state.
const STAGES: usize = 7;

/// A Runge–Kutta pair. If it is explicit, its last stage is the first of the next step.
#[derive(Debug)]
pub struct Pair {
    /// Row `i` holds the weights of stages `0 … i` for stage `i + 1`; the last row is the solution.
    weights: &'static [&'static [f64]],
    /// The same for the velocity that damping takes, of all rows but the last; empty: damping is explicit.
    implicit: &'static [&'static [f64]],
    /// Weight of a stage in its own velocity that damping takes.
    gamma: f64,
    /// Share of the tolerance that a step may use: steps are few and long, and what many of them add up to shall be of the
    /// size of the tolerance still. Damping forgets; without it twice the steps buy a fiftieth of the error.
    pub share: f64,
    /// Solution minus embedded solution.
    error: &'static [f64],
    /// Order of the error estimate plus one: the error of a step of length h grows like h to this power.
    pub order: i32,
}

impl Pair {
    /// Whether damping is explicit like everything else.
    pub fn is_explicit(&self) -> bool {
        self.implicit.is_empty()
    }
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
    implicit: &[],
    gamma: 0.0,
    share: EXPLICIT_SHARE,
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
    implicit: &[],
    gamma: 0.0,
    share: EXPLICIT_SHARE,
    order: 3,
};

/// Kennedy–Carpenter 4(3), additive, of six stages.
pub static KENNEDY_CARPENTER: Pair = Pair {
    weights: &[
        &[1.0 / 2.0],
        &[13_861.0 / 62_500.0, 6_889.0 / 62_500.0],
        &[
            -116_923_316_275.0 / 2_393_684_061_468.0,
            -2_731_218_467_317.0 / 15_368_042_101_831.0,
            9_408_046_702_089.0 / 11_113_171_139_209.0,
        ],
        &[
            -451_086_348_788.0 / 2_902_428_689_909.0,
            -2_682_348_792_572.0 / 7_519_795_681_897.0,
            12_662_868_775_082.0 / 11_960_479_115_383.0,
            3_355_817_975_965.0 / 11_060_851_509_271.0,
        ],
        &[
            647_845_179_188.0 / 3_216_320_057_751.0,
            73_281_519_250.0 / 8_382_639_484_533.0,
            552_539_513_391.0 / 3_454_668_386_233.0,
            3_354_512_671_639.0 / 8_306_763_924_573.0,
            4_040.0 / 17_871.0,
        ],
        &[
            82_889.0 / 524_892.0,
            0.0,
            15_625.0 / 83_664.0,
            69_875.0 / 102_672.0,
            -2_260.0 / 8_211.0,
            1.0 / 4.0,
        ],
    ],
    implicit: &[
        &[1.0 / 4.0],
        &[8_611.0 / 62_500.0, -1_743.0 / 31_250.0],
        &[
            5_012_029.0 / 34_652_500.0,
            -654_441.0 / 2_922_500.0,
            174_375.0 / 388_108.0,
        ],
        &[
            15_267_082_809.0 / 155_376_265_600.0,
            -71_443_401.0 / 120_774_400.0,
            730_878_875.0 / 902_184_768.0,
            2_285_395.0 / 8_070_912.0,
        ],
        &[
            82_889.0 / 524_892.0,
            0.0,
            15_625.0 / 83_664.0,
            69_875.0 / 102_672.0,
            -2_260.0 / 8_211.0,
        ],
    ],
    gamma: 1.0 / 4.0,
    // The solution's weights minus those of the embedded third order.
    error: &[
        82_889.0 / 524_892.0 - 4_586_570_599.0 / 29_645_900_160.0,
        0.0,
        15_625.0 / 83_664.0 - 178_811_875.0 / 945_068_544.0,
        69_875.0 / 102_672.0 - 814_220_225.0 / 1_159_782_912.0,
        -2_260.0 / 8_211.0 + 3_700_637.0 / 11_593_932.0,
        1.0 / 4.0 - 61_727.0 / 225_920.0,
    ],
    share: DAMPED_SHARE,
    order: 4,
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
    /// Velocities that damping takes.
    damped: Vec<f64>,
    /// Rotor inertia, and what implicit damping adds to it.
    armature: Vec<f64>,
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
            damped: vec![0.0; nv],
            armature: vec![0.0; nv],
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

    /// Takes the rates at the end of the last step by `pair` as those at the start of the next, if there are any.
    pub fn accept(&mut self, pair: &Pair) {
        self.fresh = pair.is_explicit();
        if self.fresh {
            self.q_rate.swap(0, pair.weights.len());
            self.v_rate.swap(0, pair.weights.len());
        }
    }

    /// One step of `h` seconds from `(q, v)`, into `self.q` and `self.v`.
    ///
    /// - `start`: kinematics at `(q, v)`: poses and velocities, and unless the tree is `long` mass matrix and bias
    /// - `kin`: overwritten; poses and velocities are those of the new state afterwards
    /// - `finish`: whether an explicit pair's last stage is wanted, for error and next step
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
        finish: bool,
    ) {
        let tree = system.ctx.tree;
        if !self.fresh {
            self.damped.copy_from_slice(v);
            self.accelerations(system, start, 0, v, 0.0);
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
            let last = stage + 1 == pair.weights.len();
            if last && !(finish && pair.is_explicit()) {
                self.q = stage_q;
                self.v = stage_v;
                return;
            }
            if !tree.long {
                crba::mass_matrix(tree, kin);
                rnea::bias(tree, kin, &stage_v, &ctx.inputs.wrenches, ctx.elapsed);
            }
            let mut own = 0.0;
            if let Some(weights) = pair.implicit.get(stage) {
                own = h * pair.gamma;
                combine(&mut self.damped, v, &self.v_rate, weights, h);
            } else {
                self.damped.copy_from_slice(&stage_v);
            }
            self.accelerations(system, kin, stage + 1, &stage_v, own);
            for (z, a) in self.damped.iter_mut().zip(&self.v_rate[stage + 1]) {
                *z += own * a;
            }
            let rates = &mut self.q_rate[stage + 1];
            position_rates(tree, &stage_q, &self.damped, rates);
            self.q = stage_q;
            self.v = stage_v;
        }
    }

    /// The polynomials of the step that was just taken by one of the pairs for long steps from `(q, v)`, before it is accepted:
    /// cubics through values and rates at both ends, and what Dormand–Prince adds to them. The last stage of an implicit
    /// pair is at the end, too: positions change there with the new velocity, which is exact, and velocities with an
    /// acceleration that is third order in h.
    pub fn extension(
        &self,
        pair: &Pair,
        q: &[f64],
        v: &[f64],
        h: f64,
        coefficients: &mut Vec<f64>,
    ) {
        let (weights, end_rate): (&[f64], _) = if pair.is_explicit() {
            (&EXTENSION, STAGES - 1)
        } else {
            (&[], pair.weights.len() - 1)
        };
        coefficients.clear();
        let parts = [(q, &self.q, &self.q_rate), (v, &self.v, &self.v_rate)];
        for (from, to, rates) in parts {
            for (i, (start, end)) in from.iter().zip(to).enumerate() {
                let difference = end - start;
                let bend = h * rates[0][i] - difference;
                let mut last = 0.0;
                for (rate, weight) in rates.iter().zip(weights) {
                    last += weight * rate[i];
                }
                let row: [f64; COEFFICIENTS] = [
                    *start,
                    difference,
                    bend,
                    difference - h * rates[end_rate][i] - bend,
                    h * last,
                ];
                coefficients.extend(row);
            }
        }
    }

    /// Errors of the step just taken, into `self.error`.
    pub fn estimate(&mut self, pair: &Pair, tree: &Tree, h: f64) {
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
            body.kind
                .position_error(|k| error(c + k), &mut position[body.dof..]);
        }
    }

    /// Accelerations of stage `stage` from up-to-date kinematics for `v`; damping acts on `self.damped` and `own` seconds of
    /// the acceleration.
    fn accelerations(
        &mut self,
        system: &Smooth,
        kin: &Kinematics,
        stage: usize,
        v: &[f64],
        own: f64,
    ) {
        let Context { tree, inputs, .. } = system.ctx;
        let acceleration = &mut self.v_rate[stage];
        self.effort.fill(0.0);
        if tree.long {
            self.armature.copy_from_slice(&tree.dofs.armature);
        }
        for term in system.joints {
            let v = v[term.dof];
            let effort = match (term.drive, term.actuator) {
                (Drive::Effort(_), Some(index)) if inputs.varies() => {
                    let command = inputs.command(index, system.ctx.elapsed, 0.0);
                    force::effort(system.ctx.model, index, &command)
                }
                (Drive::Effort(effort), _) => effort,
                _ => 0.0,
            };
            let resistance = term.damping * self.damped[term.dof];
            self.effort[term.dof] += term.line.cut((effort, 0.0), v).0 - resistance;
            if tree.long {
                self.armature[term.dof] += own * term.damping;
            }
        }
        if tree.long {
            self.articulated.accelerations_with(
                tree,
                kin,
                v,
                &self.armature,
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
        if own > 0.0 {
            for term in system.joints {
                self.factor[tree.sparsity.diagonal(term.dof)] += own * term.damping;
            }
        }
        tree.sparsity.factor(&mut self.factor);
        tree.sparsity.solve(&self.factor, acceleration);
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
