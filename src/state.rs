//! What the next step reads and cannot recompute.

pub mod ahead;
pub mod lag;

use self::ahead::Ahead;
use self::lag::Lag;
use crate::force::{Memory, Touch};
use crate::model::Model;
use crate::tuning::INITIAL_STEP;

/// State of a robot. All quantities in SI units; layout of `q` and `v`: [`crate::model::Motion`].
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// s
    pub time: f64,
    /// Generalised positions.
    pub q: Vec<f64>,
    /// Generalised velocities.
    pub v: Vec<f64>,
    /// What the force terms remember.
    pub memory: Memory,
    /// Commands (velocity, position, effort, limit of each actuator) of the last step, to see that they jump.
    pub commands: Vec<[f64; 4]>,
    /// Step that the error control proposes, the one it proposes just after a communication point, and the shortest
    /// that it may ask for, s.
    pub step: [f64; 3],
    /// Mean accelerations over the last step, where it was an implicit one.
    pub trend: Vec<f64>,
    /// Error of single solves.
    pub lag: Lag,
    /// Steps taken, steps rejected, most Newton iterations in a solve, steps taken at the smallest size.
    pub counters: [u64; 4],
    /// Contact impulse per link over the last communication step, N·s, and that step's length, s.
    pub impulse: Vec<[f64; 3]>,
    /// Length of the last communication step, s; 0 before the first.
    pub last_step: f64,
    /// The smooth step under way.
    pub ahead: Ahead,
}

impl State {
    /// All zero, quaternions at identity.
    pub fn new(model: &Model) -> Self {
        let mut q = vec![0.0; model.nq];
        for body in &model.bodies {
            body.motion.kind().identity(&mut q[body.coordinate..]);
        }
        Self {
            time: 0.0,
            q,
            v: vec![0.0; model.nv()],
            memory: Memory::new(model),
            commands: vec![[0.0; 4]; model.actuators.len()],
            step: [INITIAL_STEP, INITIAL_STEP, 0.0],
            trend: vec![0.0; model.nv()],
            lag: Lag::new(model),
            counters: [0; 4],
            impulse: vec![[0.0; 3]; model.links.len()],
            last_step: 0.0,
            ahead: Ahead::new(model),
        }
    }

    /// Overwrites this state with another of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.time = other.time;
        self.q.copy_from_slice(&other.q);
        self.v.copy_from_slice(&other.v);
        self.memory.copy_from(&other.memory);
        self.commands.copy_from_slice(&other.commands);
        self.step = other.step;
        self.trend.copy_from_slice(&other.trend);
        self.lag.copy_from(&other.lag);
        self.counters = other.counters;
        self.impulse.copy_from_slice(&other.impulse);
        self.last_step = other.last_step;
        self.ahead.copy_from(&other.ahead);
    }

    /// Every stored list of real numbers, in saved order; touches, the step under way and counters are the only other
    /// content. A new field goes here, into [`Self::copy_from`] and nowhere else.
    pub fn fields_mut(&mut self) -> [&mut [f64]; 20] {
        [
            std::slice::from_mut(&mut self.time),
            &mut self.q,
            &mut self.v,
            &mut self.memory.motor,
            &mut self.memory.dry,
            self.commands.as_flattened_mut(),
            &mut self.step,
            &mut self.trend,
            &mut self.lag.positions,
            &mut self.lag.velocities,
            self.lag.impulses.as_flattened_mut(),
            std::slice::from_mut(&mut self.lag.length),
            std::slice::from_mut(&mut self.lag.last),
            std::slice::from_mut(&mut self.lag.pressing),
            std::slice::from_mut(&mut self.lag.uses),
            self.impulse.as_flattened_mut(),
            std::slice::from_mut(&mut self.last_step),
            std::slice::from_mut(&mut self.ahead.start),
            std::slice::from_mut(&mut self.ahead.length),
            std::slice::from_mut(&mut self.ahead.changed),
        ]
    }

    /// See [`Self::fields_mut`].
    pub fn fields(&self) -> [&[f64]; 20] {
        [
            std::slice::from_ref(&self.time),
            &self.q,
            &self.v,
            &self.memory.motor,
            &self.memory.dry,
            self.commands.as_flattened(),
            &self.step,
            &self.trend,
            &self.lag.positions,
            &self.lag.velocities,
            self.lag.impulses.as_flattened(),
            std::slice::from_ref(&self.lag.length),
            std::slice::from_ref(&self.lag.last),
            std::slice::from_ref(&self.lag.pressing),
            std::slice::from_ref(&self.lag.uses),
            self.impulse.as_flattened(),
            std::slice::from_ref(&self.last_step),
            std::slice::from_ref(&self.ahead.start),
            std::slice::from_ref(&self.ahead.length),
            std::slice::from_ref(&self.ahead.changed),
        ]
    }

    /// Whether no length of time is negative: a step would go back, and then for ever forward again.
    pub fn lengths_are_positive(&self) -> bool {
        let lag = [&self.lag.length, &self.lag.last];
        let mut lengths = self
            .step
            .iter()
            .chain([&self.last_step, &self.ahead.length])
            .chain(lag);
        lengths.all(|length| *length >= 0.0)
    }

    /// Whether every number is finite; the effort limits among the commands may be infinite: no limit.
    pub fn is_finite(&self) -> bool {
        let touches = self.memory.touches.iter().flat_map(Touch::numbers);
        let caps = self.commands.as_flattened();
        let is_finite =
            |field: &[f64]| std::ptr::eq(field, caps) || field.iter().all(|x| x.is_finite());
        self.fields().into_iter().all(is_finite)
            && touches
                .chain(self.ahead.coefficients.iter().copied())
                .all(f64::is_finite)
            && self
                .commands
                .iter()
                .all(|[velocity, position, effort, cap]| {
                    [velocity, position, effort].iter().all(|x| x.is_finite()) && !cap.is_nan()
                })
    }

    /// Whether positions and velocities are finite; nothing else can be infinite without them.
    pub fn moves_finitely(&self) -> bool {
        self.q.iter().chain(&self.v).all(|x| x.is_finite())
    }
}
