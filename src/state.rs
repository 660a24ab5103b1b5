//! The state: what the next step reads and cannot recompute.
//!
//! [`Physical`] is the physical state of the robot, which determines its motion. [`Stepping`] is
//! what the method remembers from step to step: step sizes, accelerations, sums for outputs. Both
//! are saved, so that a restored state continues bit for bit.

pub mod ahead;

use self::ahead::Ahead;
use crate::force::{Memory, Touch};
use crate::model::{Model, Sensor};
use crate::tuning::INITIAL_STEP;

/// State of a robot. All quantities in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// s
    pub time: f64,
    /// What the robot is in.
    pub physical: Physical,
    /// What the method remembers.
    pub stepping: Stepping,
}

/// What the robot is in. Steps write it in one place, `step/attempt.rs`.
#[derive(Clone, Debug, PartialEq)]
pub struct Physical {
    /// Generalised positions, `nq`; layout: [`crate::model::Motion`].
    pub q: Vec<f64>,
    /// Generalised velocities, `nv`, likewise.
    pub v: Vec<f64>,
    /// What contacts, motors and dry friction remember.
    pub memory: Memory,
}

/// What the method remembers from step to step.
#[derive(Clone, Debug, PartialEq)]
pub struct Stepping {
    /// Step sizes of the error control.
    pub sizes: Sizes,
    /// Accelerations of the last step, where it was an implicit one, else 0.
    pub trend: Trend,
    /// What has been counted since the start.
    pub counters: Counters,
    /// Contact impulse per link over the last communication step, world axes, N·s.
    pub impulse: Vec<[f64; 3]>,
    /// The same per named pair, on its first side by the second one.
    pub pair_impulse: Vec<[f64; 3]>,
    /// Length of the last communication step, s; 0 before the first.
    pub last_step: f64,
    /// 1 for each tree that has rested all through the last communication step, else 0.
    pub rested: Vec<f64>,
    /// What sensors with a rate hold: of each how many samples it has taken, the time of the last
    /// one, s, and the values of its channels.
    pub samples: Vec<f64>,
    /// Contact forces on what rests, by ascending slot.
    pub loads: Vec<Load>,
    /// The smooth steps under way.
    pub ahead: Ahead,
}

/// Force of a contact while all that it belongs to rests.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Index of the shape, or that of a pair of shapes: see [`Model::slots`].
    pub slot: usize,
    /// On the shape of lower index, world axes, N.
    pub force: [f64; 3],
}

/// Mean accelerations of a step, `nv`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trend {
    /// Over its first stage.
    pub first: Vec<f64>,
    /// Over all of it.
    pub whole: Vec<f64>,
}

impl Trend {
    /// Room for so many degrees of freedom, all zero.
    #[cfg_attr(small, optimize(size))]
    pub fn new(nv: usize) -> Self {
        Self {
            first: vec![0.0; nv],
            whole: vec![0.0; nv],
        }
    }

    /// Overwrites this with another of the same length, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.first.copy_from_slice(&other.first);
        self.whole.copy_from_slice(&other.whole);
    }
}

/// Step sizes of the error control, s, one for each tree. Trees that move together have the same;
/// in a step those of the first one count, see [`crate::tree::Island::lead`].
#[derive(Clone, Debug, PartialEq)]
pub struct Sizes {
    /// Of the next step.
    pub proposed: Vec<f64>,
    /// The shortest that the error control may ask for; 0 before the first step.
    pub floor: Vec<f64>,
}

/// What has been counted since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Steps taken.
    pub steps: u64,
    /// Steps rejected.
    pub rejected: u64,
    /// Most Newton iterations in one solve.
    pub newton_max: u64,
    /// Steps taken at the smallest size although their error was too large.
    pub forced: u64,
}

impl Counters {
    /// Every counter, in saved order.
    pub fn numbers(self) -> [u64; 4] {
        [self.steps, self.rejected, self.newton_max, self.forced]
    }

    /// The inverse of [`Self::numbers`].
    pub fn from_numbers([steps, rejected, newton_max, forced]: [u64; 4]) -> Self {
        Self {
            steps,
            rejected,
            newton_max,
            forced,
        }
    }
}

/// Every stored list of real numbers of a fixed length, in saved order: a new field goes here and
/// nowhere else. Touches, loads, the coefficients of steps under way and the counters are the only
/// other content.
macro_rules! fields {
    ($state:ident, $one:path, $flat:ident $(, $mutable:tt)?) => {{
        let State { time, physical, stepping } = $state;
        [
            $one(time),
            & $($mutable)? physical.q,
            & $($mutable)? physical.v,
            & $($mutable)? physical.memory.motor,
            & $($mutable)? physical.memory.dry,
            & $($mutable)? physical.memory.sliding,
            & $($mutable)? stepping.sizes.proposed,
            & $($mutable)? stepping.sizes.floor,
            & $($mutable)? stepping.trend.first,
            & $($mutable)? stepping.trend.whole,
            stepping.impulse.$flat(),
            stepping.pair_impulse.$flat(),
            $one(& $($mutable)? stepping.last_step),
            & $($mutable)? stepping.rested,
            & $($mutable)? stepping.samples,
            & $($mutable)? stepping.ahead.start,
            & $($mutable)? stepping.ahead.length,
            & $($mutable)? stepping.ahead.lead,
            & $($mutable)? stepping.ahead.changed,
        ]
    }};
}

/// Length of the list of fields.
pub const FIELDS: usize = 19;

impl Physical {
    /// All zero, quaternions at identity.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        let mut q = vec![0.0; model.nq];
        for body in &model.bodies {
            body.motion.kind().identity(&mut q[body.coordinate..]);
        }
        Self {
            q,
            v: vec![0.0; model.nv()],
            memory: Memory::new(model),
        }
    }

    /// Overwrites this with another of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.q.copy_from_slice(&other.q);
        self.v.copy_from_slice(&other.v);
        self.memory.copy_from(&other.memory);
    }

    /// Whether positions and velocities are finite; nothing else can be infinite without them.
    pub fn is_finite(&self) -> bool {
        self.q.iter().chain(&self.v).all(|x| x.is_finite())
    }
}

impl State {
    /// All zero, quaternions at identity.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        let sensors = &model.outputs.sensors;
        Self {
            time: 0.0,
            physical: Physical::new(model),
            stepping: Stepping {
                sizes: Sizes {
                    proposed: vec![INITIAL_STEP; model.roots.len()],
                    floor: vec![0.0; model.roots.len()],
                },
                trend: Trend::new(model.nv()),
                counters: Counters::default(),
                impulse: vec![[0.0; 3]; model.links.len()],
                pair_impulse: vec![[0.0; 3]; model.outputs.pairs.len()],
                last_step: 0.0,
                rested: vec![0.0; model.roots.len()],
                samples: vec![0.0; sensors.iter().map(Sensor::held).sum()],
                loads: Vec::with_capacity(model.contact_room()[0]),
                ahead: Ahead::new(model),
            },
        }
    }

    /// Every stored list of real numbers, in saved order.
    pub fn fields(&self) -> [&[f64]; FIELDS] {
        fields!(self, std::slice::from_ref, as_flattened)
    }

    /// The same, to be written.
    pub fn fields_mut(&mut self) -> [&mut [f64]; FIELDS] {
        fields!(self, std::slice::from_mut, as_flattened_mut, mut)
    }

    /// Overwrites this state with another of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        for (to, from) in self.fields_mut().into_iter().zip(other.fields()) {
            to.copy_from_slice(from);
        }
        self.stepping.counters = other.stepping.counters;
        let (to, from) = (
            &mut self.physical.memory.touches,
            &other.physical.memory.touches,
        );
        to.clear();
        to.extend_from_slice(from);
        let (to, from) = (&mut self.stepping.loads, &other.stepping.loads);
        to.clear();
        to.extend_from_slice(from);
        let from = &other.stepping.ahead.coefficients;
        self.stepping.ahead.coefficients.clear();
        self.stepping.ahead.coefficients.extend_from_slice(from);
    }

    /// Whether no length of time is negative: with a negative one a step would go back in time and
    /// the run would not end.
    pub fn lengths_are_positive(&self) -> bool {
        let Stepping { sizes, ahead, .. } = &self.stepping;
        let sizes = [&sizes.proposed, &sizes.floor];
        let mut lengths = sizes.into_iter().chain([&ahead.length]).flatten();
        lengths.all(|length| *length >= 0.0) && self.stepping.last_step >= 0.0
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        let is_finite = |field: &[f64]| field.iter().all(|x| x.is_finite());
        let touches = self.physical.memory.touches.iter().flat_map(Touch::numbers);
        let coefficients = self.stepping.ahead.coefficients.iter().copied();
        let loads = self.stepping.loads.iter().flat_map(|load| load.force);
        self.fields().into_iter().all(is_finite)
            && touches.chain(coefficients).chain(loads).all(f64::is_finite)
    }
}
