//! Integrates stiff equations `x' = f(t, x)` by RODAS, a Rosenbrock method of order 4(3).
//!
//! Each step solves six linear systems with one matrix and no iteration. The method is L-stable and
//! stiffly accurate, and it remembers nothing but the length of its steps: it may end a step
//! wherever an importer has to communicate, and begin anew after a jump.
//!
//! Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd edition, IV.7, and
//! the coefficients of their program RODAS (method 1).

use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Numbers of each stage: factors of the slope's linear part in time.
const D: [f64; 6] = [0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0];
/// Where in the step a stage is evaluated.
const C: [f64; 6] = [0.0, 0.386, 0.21, 0.63, 1.0, 1.0];
/// Diagonal element of the method.
const GAMMA: f64 = 0.25;
/// The states that a stage is evaluated at, by the increments of those before it.
const A: [[f64; 5]; 6] = [
    [0.0; 5],
    [1.544, 0.0, 0.0, 0.0, 0.0],
    [
        0.946_678_528_081_582_6,
        0.255_701_169_898_328_4,
        0.0,
        0.0,
        0.0,
    ],
    [
        3.314_825_187_068_521,
        2.896_124_015_972_201,
        0.998_641_913_997_781_7,
        0.0,
        0.0,
    ],
    [A51, A52, A53, A54, 0.0],
    [A51, A52, A53, A54, 1.0],
];
const A51: f64 = 1.221_224_509_226_641;
const A52: f64 = 6.019_134_481_288_629;
const A53: f64 = 12.537_083_329_320_87;
const A54: f64 = -0.687_886_036_105_895;
/// What the increments before a stage add to its linear system.
const E: [[f64; 5]; 6] = [
    [0.0; 5],
    [-5.6688, 0.0, 0.0, 0.0, 0.0],
    [
        -2.430_093_356_833_875,
        -0.206_359_915_709_191_5,
        0.0,
        0.0,
        0.0,
    ],
    [
        -0.107_352_905_815_137_5,
        -9.594_562_251_023_355,
        -20.470_286_148_096_16,
        0.0,
        0.0,
    ],
    [
        7.496_443_313_967_647,
        -10.246_804_314_643_52,
        -33.999_903_528_199_05,
        11.708_908_932_061_6,
        0.0,
    ],
    [
        8.083_246_795_921_522,
        -7.981_132_988_064_893,
        -31.521_594_328_743_71,
        16.319_305_431_231_36,
        -6.058_818_238_834_054,
    ],
];

/// Length of the first step, s: short, because nothing is known yet; it grows quickly.
const FIRST: f64 = 1e-5;
/// A step is so many times as long as the error estimate allows, and changes by no more than that.
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 6.0;
/// Increment of a state for differences, in parts of its size: the power 2/3 of the least
/// difference of numbers of size 1.
///
/// The order of the method rests on right derivatives by the states, and differences err by
/// rounding and by curvature. By this increment rounding is 6e-6, the power 1/3, of a change of the
/// derivatives by their own size. That of the power 1/2 suits what is curved on the scale of its
/// size; but positions count by metres, and hard contacts, which are curved on the scale of their
/// depth, are less than a micrometre deep: a Panda that holds a cube takes four times as many steps
/// by it. Test: `a_hard_contact_is_followed_in_long_steps`.
const INCREMENT: f64 = 3.666_852_862_501_036e-11;

/// Shortest step in parts of the time: below it the time does not advance.
const LEAST: f64 = 4.0 * f64::EPSILON;

/// The equations.
pub(super) trait Equations {
    /// Why there is no value.
    type Error;

    /// Writes the derivatives; false where there are none, so that a shorter step has to do.
    ///
    /// # Errors
    /// Whatever ends the integration.
    fn rates(&mut self, time: f64, states: &[f64], rates: &mut [f64]) -> Result<bool, Self::Error>;
}

/// What a step came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// It was accepted.
    Step,
    /// It would have to be too short for the time to advance.
    Stuck,
}

/// An integration.
pub(super) struct Rodas {
    /// s
    pub time: f64,
    /// At that time.
    pub states: Vec<f64>,
    /// Relative tolerance.
    relative: f64,
    /// Sizes of the states to expect: absolute tolerances and differences are in parts of them.
    nominals: Vec<f64>,
    /// Length of the next step, s.
    step: f64,
    slopes: DMatrix<f64>,
    rates: DVector<f64>,
    rates_by_time: DVector<f64>,
    increments: Vec<DVector<f64>>,
    at: DVector<f64>,
    there: DVector<f64>,
}

impl Rodas {
    /// Begins at a time and states.
    pub fn new(time: f64, states: Vec<f64>, nominals: Vec<f64>, relative: f64) -> Self {
        let n = states.len();
        let zeros = || DVector::zeros(n);
        Self {
            time,
            states,
            relative,
            nominals,
            step: FIRST,
            slopes: DMatrix::zeros(n, n),
            rates: zeros(),
            rates_by_time: zeros(),
            increments: (0..6).map(|_| zeros()).collect(),
            at: zeros(),
            there: zeros(),
        }
    }

    /// Goes on from states that have jumped.
    pub fn restart(&mut self, states: &[f64], nominals: &[f64]) {
        self.states.copy_from_slice(states);
        self.nominals.copy_from_slice(nominals);
    }

    /// Takes a step that ends at `end`, s, or before it.
    ///
    /// # Errors
    /// Those of the equations.
    pub fn advance<Q: Equations>(
        &mut self,
        equations: &mut Q,
        end: f64,
    ) -> Result<Taken, Q::Error> {
        let least = LEAST * (self.time.abs() + FIRST);
        // Without states there is nothing to integrate: outputs follow the inputs and the time.
        if end - self.time <= least || self.states.is_empty() {
            self.time = end;
            return Ok(Taken::Step);
        }
        if !self.linearise(equations, end)? {
            return Ok(Taken::Stuck);
        }
        let mut rejected = false;
        loop {
            let rest = end - self.time;
            // No tiny rest is left.
            let (h, cut) = if self.step >= rest {
                (rest, true)
            } else if 2.0 * self.step > rest {
                (0.5 * rest, true)
            } else {
                (self.step, false)
            };
            if h <= least {
                return Ok(Taken::Stuck);
            }
            let Some(error) = self.attempt(equations, h)? else {
                // Nothing has a value there, or the matrix is singular.
                self.step = SHRINK * h;
                rejected = true;
                continue;
            };
            let factor = (SAFETY * error.powf(-0.25)).clamp(SHRINK, GROW);
            if error > 1.0 {
                self.step = h * factor;
                rejected = true;
                continue;
            }
            let next = h * if rejected { factor.min(1.0) } else { factor };
            self.step = if cut { next.max(self.step) } else { next };
            self.time = if h >= rest { end } else { self.time + h };
            self.states.copy_from_slice(self.at.as_slice());
            return Ok(Taken::Step);
        }
    }

    /// Evaluates derivatives, and their own derivatives by the states and by the time, at the
    /// beginning of a step; false where there are none.
    fn linearise<Q: Equations>(&mut self, equations: &mut Q, end: f64) -> Result<bool, Q::Error> {
        let time = self.time;
        if !evaluated(equations, time, &self.states, &mut self.rates)? {
            return Ok(false);
        }
        // Within the piece up to `end`, where the inputs do not jump.
        let later = time + (f64::EPSILON.sqrt() * time.abs().max(1.0)).min(0.5 * (end - time));
        if !evaluated(equations, later, &self.states, &mut self.there)? {
            return Ok(false);
        }
        let scale = 1.0 / (later - time);
        self.rates_by_time.copy_from(&self.there);
        self.rates_by_time -= &self.rates;
        self.rates_by_time *= scale;
        let mut moved = self.states.clone();
        for column in 0..moved.len() {
            let state = moved[column];
            moved[column] = state + INCREMENT * state.abs().max(self.nominals[column]);
            let difference = moved[column] - state;
            if !evaluated(equations, time, &moved, &mut self.there)? {
                return Ok(false);
            }
            moved[column] = state;
            let mut slope = self.slopes.column_mut(column);
            slope.copy_from(&self.there);
            slope -= &self.rates;
            slope /= difference;
        }
        Ok(true)
    }

    /// Tries a step of length `h`, s: leaves the states at its end in `at`, and gives its error in
    /// parts of what is tolerated. None where something has no value.
    fn attempt<Q: Equations>(
        &mut self,
        equations: &mut Q,
        h: f64,
    ) -> Result<Option<f64>, Q::Error> {
        let n = self.states.len();
        let mut matrix = -&self.slopes;
        for i in 0..n {
            matrix[(i, i)] += 1.0 / (h * GAMMA);
        }
        let factors: LU<f64, Dyn, Dyn> = matrix.lu();
        for stage in 0..6 {
            self.at.copy_from_slice(&self.states);
            for (increment, a) in self.increments.iter().zip(&A[stage][..stage.min(5)]) {
                self.at.axpy(*a, increment, 1.0);
            }
            if stage == 0 {
                self.there.copy_from(&self.rates);
            } else {
                let time = self.time + C[stage] * h;
                if !evaluated(equations, time, self.at.as_slice(), &mut self.there)? {
                    return Ok(None);
                }
            }
            for (increment, e) in self.increments.iter().zip(&E[stage][..stage.min(5)]) {
                self.there.axpy(*e / h, increment, 1.0);
            }
            self.there.axpy(h * D[stage], &self.rates_by_time, 1.0);
            if !factors.solve_mut(&mut self.there) {
                return Ok(None);
            }
            self.increments[stage].copy_from(&self.there);
        }
        // The last increment is the difference to a method of order 3.
        self.at += &self.there;
        let mut sum = 0.0;
        for (i, error) in self.there.iter().enumerate() {
            let size = self.states[i].abs().max(self.at[i].abs());
            let tolerated = self.relative * self.nominals[i].max(size);
            sum += (error / tolerated).powi(2);
        }
        #[expect(clippy::cast_precision_loss, reason = "a number of states")]
        let error = (sum / n.max(1) as f64).sqrt();
        Ok(error.is_finite().then_some(error.max(f64::MIN_POSITIVE)))
    }
}

/// Whether there are finite derivatives.
fn evaluated<Q: Equations>(
    equations: &mut Q,
    time: f64,
    states: &[f64],
    rates: &mut DVector<f64>,
) -> Result<bool, Q::Error> {
    let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
    Ok(finite(states)
        && equations.rates(time, states, rates.as_mut_slice())?
        && finite(rates.as_slice()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// Equations of a function, and how often it was evaluated.
    struct Of<F>(F, usize);

    impl<F: FnMut(f64, &[f64], &mut [f64])> Equations for Of<F> {
        type Error = Infallible;

        fn rates(&mut self, t: f64, x: &[f64], rates: &mut [f64]) -> Result<bool, Infallible> {
            self.1 += 1;
            (self.0)(t, x, rates);
            Ok(true)
        }
    }

    /// The states at `end`, and the number of evaluations.
    fn integrated(
        equations: impl FnMut(f64, &[f64], &mut [f64]),
        states: &[f64],
        end: f64,
        relative: f64,
    ) -> (Vec<f64>, usize) {
        let mut equations = Of(equations, 0);
        let mut method = Rodas::new(0.0, states.to_vec(), vec![1.0; states.len()], relative);
        while method.time < end {
            let Ok(taken) = method.advance(&mut equations, end);
            assert_eq!(taken, Taken::Step);
        }
        (method.states, equations.1)
    }

    /// x' = −x² + sin t … with a known solution: x = 1/(1 + t) + sin t by a fitting right side.
    fn curved(t: f64, x: &[f64], rates: &mut [f64]) {
        let (decay, wave) = (1.0 / (1.0 + t), t.sin());
        let exact = decay + wave;
        rates[0] = exact.powi(2) - x[0].powi(2) - decay.powi(2) + t.cos();
    }

    #[test]
    fn errors_of_one_length_of_step_fall_with_its_fourth_power() {
        let exact = 0.5 + 1.0_f64.sin();
        let error = |steps: i32| {
            let h = 1.0 / f64::from(steps);
            let mut equations = Of(curved, 0);
            // A tolerance that never binds, and steps that end where they are told to.
            let mut method = Rodas::new(0.0, vec![1.0], vec![1.0], 1e6);
            method.step = 1.0;
            for step in 1..=steps {
                let Ok(_) = method.advance(&mut equations, h * f64::from(step));
            }
            (method.states[0] - exact).abs()
        };
        let (coarse, fine) = (error(8), error(16));
        let order = (coarse / fine).log2();
        assert!(
            fine < 1e-6 && (3.7..4.6).contains(&order),
            "{coarse:e} {fine:e}: {order}"
        );
    }

    #[test]
    fn without_states_time_goes_on() {
        let (states, _) = integrated(|_, _, _| {}, &[], 2.0, 1e-6);
        assert!(states.is_empty());
    }

    #[test]
    fn what_is_stiff_is_taken_in_long_steps() {
        // Two rates, of 1/s and of 1e6/s: Prothero and Robinson's problem beside a decay.
        let stiff = |t: f64, x: &[f64], rates: &mut [f64]| {
            rates[0] = -x[0];
            rates[1] = -1e6 * (x[1] - t.cos()) - t.sin();
        };
        let (states, evaluations) = integrated(stiff, &[1.0, 0.0], 2.0, 1e-6);
        assert!((states[0] - (-2.0_f64).exp()).abs() < 1e-6, "{states:?}");
        assert!((states[1] - 2.0_f64.cos()).abs() < 1e-6, "{states:?}");
        assert!(evaluations < 1000, "{evaluations}");
    }

    #[test]
    fn a_hard_contact_is_followed_in_long_steps() {
        // A mass of 1 kg on a Hertzian contact, 20 nm deep under its weight, that a force shakes:
        // the depth follows the force by the law. With increments of 1.5e-8 m it took 1,794
        // evaluations.
        const DEPTH: f64 = 2e-8;
        let force = |t: f64| 10.0 + 5.0 * (6.0 * t).sin();
        let contact = |t: f64, x: &[f64], rates: &mut [f64]| {
            let load = 10.0 * ((-x[0]).max(0.0) / DEPTH).powf(1.5);
            rates[0] = x[1];
            rates[1] = load * (1.0 - 500.0 * x[1]) - force(t);
        };
        let (states, evaluations) = integrated(contact, &[-DEPTH, 0.0], 2.0, 1e-6);
        let depth = DEPTH * (force(2.0) / 10.0).powf(2.0 / 3.0);
        assert!((states[0] + depth).abs() < 0.1 * DEPTH, "{states:?}");
        assert!(evaluations < 200, "{evaluations}");
    }

    #[test]
    fn a_tolerance_is_kept() {
        // A pendulum of 1 rad: energy is kept as well as the tolerance says.
        let pendulum = |_: f64, x: &[f64], rates: &mut [f64]| {
            rates[0] = x[1];
            rates[1] = -x[0].sin();
        };
        for (tolerance, bound) in [(1e-4, 1e-3), (1e-8, 1e-7)] {
            let (states, _) = integrated(pendulum, &[1.0, 0.0], 10.0, tolerance);
            let energy = 0.5 * states[1].powi(2) - states[0].cos() + 1.0_f64.cos();
            assert!(energy.abs() < bound, "{tolerance:e}: {energy:e}");
        }
    }

    #[test]
    fn what_has_no_value_is_approached_and_not_passed() {
        struct Wall;
        impl Equations for Wall {
            type Error = Infallible;
            fn rates(&mut self, _: f64, x: &[f64], rates: &mut [f64]) -> Result<bool, Infallible> {
                rates[0] = 1.0;
                Ok(x[0] < 1.0)
            }
        }
        let mut method = Rodas::new(0.0, vec![0.0], vec![1.0], 1e-6);
        let mut steps = 0;
        let stuck = loop {
            let Ok(taken) = method.advance(&mut Wall, 2.0);
            steps += 1;
            if taken == Taken::Stuck || steps > 1000 {
                break taken;
            }
        };
        assert_eq!(stuck, Taken::Stuck);
        assert!(method.time < 1.0 && method.time > 0.999, "{}", method.time);
    }
}
