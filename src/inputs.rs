//! Commands of the robot: values at the last communication point and their Taylor polynomials.
//!
//! Each input is a Taylor polynomial in the time since the communication point,
//! `u(t) = u + t u′ + t² u″/2 + t³ u‴/6`, so that a command which changes within a step changes
//! within the solver's steps, too. Without derivatives it is a constant without additional cost.

use crate::model::{ActuatorId, LinkId, Model, RootId};
use crate::range::Range;
use crate::slots::InputSlot;
use crate::spatial::{Vec3, Vec6};
use crate::tree::Tree;
use crate::tuning::RAMP_ROUND_OFF;

/// Highest time derivative of an input that is used.
pub const INPUT_ORDERS: usize = 3;

/// Torque and force on a body about its link's centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExternalWrench {
    /// Index of the body.
    pub body: usize,
    /// Point of attack in the body's solver frame, m.
    pub point: Vec3,
    /// `[τ; f]`, world axes, at the communication point.
    pub wrench: Vec6,
    /// Its first time derivatives, where one is not 0.
    pub rates: Option<[Vec6; INPUT_ORDERS]>,
}

impl ExternalWrench {
    /// The wrench `t` seconds after the communication point.
    #[inline]
    pub fn at(&self, t: f64) -> Vec6 {
        let Some([first, second, third]) = &self.rates else {
            return self.wrench;
        };
        std::array::from_fn(|i| {
            self.wrench[i] + t * (first[i] + t / 2.0 * (second[i] + t / 3.0 * third[i]))
        })
    }
}

impl InputSlot {
    /// What its value may be.
    pub(crate) fn range(self) -> Range {
        match self {
            Self::Velocity(_) => Range::Velocity,
            Self::Position(_) => Range::Position,
            Self::Effort(_) | Self::ExternalForce(..) | Self::ExternalTorque(..) => Range::Load,
            Self::MaxEffort(_) => Range::LimitSize,
            Self::SurfaceVelocity(..) | Self::BaseLinearVelocity(..) => Range::Flight,
            Self::BaseAngularVelocity(..) => Range::Spin,
        }
    }
}

/// Values and time derivatives of all inputs of a model.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Number of actuators.
    actuators: usize,
    /// Per actuator, the one whose inputs it takes: the first of its group, or itself.
    leader: Vec<usize>,
    /// Number of inputs.
    count: usize,
    /// Per link, its place among those with an external wrench.
    wrench: Vec<Option<u32>>,
    /// What has a surface that moves.
    conveyors: Vec<RootId>,
    /// What has a base that moves as inputs say.
    driven: Vec<RootId>,
    /// All values in the order that `Self::index` gives, then all first derivatives, and so on.
    pub numbers: Vec<f64>,
    /// Per actuator, 1 where its position has been set before the simulation begins: until then
    /// others follow the initial position, see [`Self::follow`]. Once it runs all are 0. Numbers,
    /// because saved states have them.
    pub given: Vec<f64>,
    /// Whether a derivative is not 0.
    varies: bool,
    /// Wrenches that are not 0, see [`Self::gather`].
    pub wrenches: Vec<ExternalWrench>,
}

/// What an actuator is told over a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// rad/s or m/s, at the end of the step.
    pub velocity: f64,
    /// rad or m, at the end of the step.
    pub position: f64,
    /// Rate of `position`, rad/s or m/s, at the end of the step.
    pub rate: f64,
    /// N·m or N, at the middle of the step: its mean, up to the second order.
    pub effort: f64,
    /// N·m or N, at the end of the step; not negative.
    pub max_effort: f64,
}

impl Inputs {
    /// Start values: positions as initialised, efforts as the model says, all else 0.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        let n = model.actuators.len();
        let mut wrench = vec![None; model.links.len()];
        for (place, link) in (0..).zip(&model.outputs.external_wrenches) {
            wrench[link.index()] = Some(place);
        }
        let wrenches = model.outputs.external_wrenches.len();
        let outputs = &model.outputs;
        let bases = 4 * n + 6 * wrenches + 3 * outputs.conveyors.len();
        let count = bases + 6 * outputs.driven.len();
        let mut numbers = vec![0.0; count * (1 + INPUT_ORDERS)];
        for (place, root) in outputs.driven.iter().enumerate() {
            // It goes on as it begins.
            let root = &model.roots[root.index()];
            let start = bases + 6 * place;
            numbers[start..start + 3].copy_from_slice(root.angular_velocity.as_slice());
            numbers[start + 3..start + 6].copy_from_slice(root.linear_velocity.as_slice());
        }
        for (a, actuator) in model.actuators.iter().enumerate() {
            numbers[n + a] = model.initial.joint_positions[actuator.joint.index()];
            numbers[3 * n + a] = actuator.max_effort;
        }
        Self {
            actuators: n,
            leader: model.leaders(),
            count,
            wrench,
            conveyors: outputs.conveyors.clone(),
            driven: outputs.driven.clone(),
            numbers,
            given: vec![0.0; n],
            varies: false,
            wrenches: Vec::with_capacity(wrenches),
        }
    }

    /// Takes note that a position is set before the simulation begins.
    pub fn give(&mut self, slot: InputSlot) {
        if let InputSlot::Position(a) = slot {
            self.given[self.leader[a.index()]] = 1.0;
        }
    }

    /// Positions that nobody has set become those in which the joints begin: of each actuator that
    /// `initial` gives.
    pub fn follow(&mut self, initial: impl Fn(ActuatorId) -> f64) {
        for a in 0..self.actuators {
            if self.leader[a] == a && self.given[a] == 0.0 {
                self.numbers[self.actuators + a] = initial(ActuatorId::from(a));
            }
        }
    }

    fn index(&self, slot: InputSlot) -> Option<usize> {
        let n = self.actuators;
        let wrench = |link: LinkId| self.wrench[link.index()].map(|w| 4 * n + 6 * w as usize);
        let leader = |a: ActuatorId| self.leader[a.index()];
        let bases = self.count - 6 * self.driven.len();
        let base = |root: RootId| {
            let place = self.driven.iter().position(|known| *known == root)?;
            Some(bases + 6 * place)
        };
        match slot {
            InputSlot::Velocity(a) => Some(leader(a)),
            InputSlot::Position(a) => Some(n + leader(a)),
            InputSlot::Effort(a) => Some(2 * n + leader(a)),
            InputSlot::MaxEffort(a) => Some(3 * n + leader(a)),
            InputSlot::ExternalTorque(link, axis) => wrench(link).map(|w| w + axis as usize),
            InputSlot::ExternalForce(link, axis) => wrench(link).map(|w| w + 3 + axis as usize),
            InputSlot::SurfaceVelocity(root, axis) => {
                let place = self.conveyors.iter().position(|known| *known == root)?;
                Some(bases - 3 * (self.conveyors.len() - place) + axis as usize)
            }
            InputSlot::BaseAngularVelocity(root, axis) => base(root).map(|b| b + axis as usize),
            InputSlot::BaseLinearVelocity(root, axis) => base(root).map(|b| b + 3 + axis as usize),
        }
    }

    /// Value of an input; 0 for the wrench of a link that has none.
    pub fn get(&self, slot: InputSlot) -> f64 {
        self.index(slot).map_or(0.0, |i| self.numbers[i])
    }

    /// Sets an input, not its derivatives; ignored for the wrench of a link that has none.
    pub fn set(&mut self, slot: InputSlot, value: f64) {
        if let Some(index) = self.index(slot) {
            self.numbers[index] = value;
        }
    }

    /// Sets the time derivative of order 1 … [`INPUT_ORDERS`] of an input at the communication
    /// point; whether that changed anything.
    pub fn set_derivative(&mut self, slot: InputSlot, order: usize, value: f64) -> bool {
        let Some(index) = self.index(slot) else {
            return false;
        };
        let derivative = &mut self.numbers[order * self.count + index];
        // Zero has no sign here: the inputs do not vary either way.
        let value = value + 0.0;
        if derivative.to_bits() == value.to_bits() {
            return false;
        }
        *derivative = value;
        self.varies = self.numbers[self.count..].iter().any(|d| *d != 0.0);
        true
    }

    /// Whether any input changes after the communication point.
    #[inline]
    pub fn varies(&self) -> bool {
        self.varies
    }

    /// Value, or derivative of order `order`, of the input at `index`, `t` seconds after the
    /// communication point.
    fn taylor(&self, index: usize, order: usize, t: f64) -> f64 {
        let mut value = 0.0;
        for k in (order..=INPUT_ORDERS).rev() {
            // Horner: the coefficient of t^(k − order) is the derivative over (k − order)!.
            #[expect(clippy::cast_precision_loss, reason = "an order is at most 3")]
            let divisor = (k - order + 1) as f64;
            value = self.numbers[k * self.count + index] + t / divisor * value;
        }
        value
    }

    /// What actuator `a` is told over a step of `h` seconds that begins `t` seconds after the
    /// communication point.
    #[inline]
    pub fn command(&self, a: usize, t: f64, h: f64) -> Command {
        let n = self.actuators;
        let a = self.leader[a];
        if self.varies {
            return self.varying_command(a, t, h);
        }
        Command {
            velocity: self.numbers[a],
            position: self.numbers[n + a],
            rate: 0.0,
            effort: self.numbers[2 * n + a],
            max_effort: self.numbers[3 * n + a],
        }
    }

    #[cold]
    fn varying_command(&self, a: usize, t: f64, h: f64) -> Command {
        let n = self.actuators;
        Command {
            velocity: self.taylor(a, 0, t + h),
            position: self.taylor(n + a, 0, t + h),
            rate: self.taylor(n + a, 1, t + h),
            effort: self.taylor(2 * n + a, 0, t + 0.5 * h),
            max_effort: self.taylor(3 * n + a, 0, t + h).max(0.0),
        }
    }

    /// Whether all inputs are finite `t` seconds after the communication point; start values may be
    /// infinite.
    pub fn is_finite_at(&self, t: f64) -> bool {
        !self.varies
            || (0..self.count)
                .all(|i| self.taylor(i, 0, t).is_finite() || !self.numbers[i].is_finite())
    }

    /// What an input becomes where its derivatives take it out of its range within `span` seconds
    /// after the communication point.
    pub fn beyond(&self, slot: InputSlot, span: f64) -> Option<f64> {
        let index = self.index(slot).filter(|_| self.varies)?;
        let [u, u1, u2, u3]: [f64; 1 + INPUT_ORDERS] =
            std::array::from_fn(|order| self.numbers[order * self.count + index]);
        // Start values may be infinite.
        if !u.is_finite() || [u1, u2, u3].iter().all(|d| *d == 0.0) {
            return None;
        }
        // It is greatest and least at the end, or where u′ + t u″ + t² u‴/2 is 0.
        let root = libm::sqrt(u2 * u2 - 2.0 * u1 * u3);
        let half = -(u2 + libm::copysign(root, u2));
        let times = [span, half / u3, 2.0 * u1 / half];
        let (least, greatest) = slot.range().bounds();
        let terms = [
            u,
            u1 * span,
            u2 * span * span / 2.0,
            u3 * span * span * span / 6.0,
        ];
        let slack = RAMP_ROUND_OFF * terms.iter().map(|term| term.abs()).sum::<f64>();
        let within = times.into_iter().filter(|t| (0.0..=span).contains(t));
        let mut values = within.map(|t| self.taylor(index, 0, t));
        values.find(|x| x.is_nan() || *x < least - slack || *x > greatest + slack)
    }

    /// Moves the communication point `t` seconds on: what follows it stays the same.
    pub fn shift(&mut self, t: f64) {
        if !self.varies {
            return;
        }
        for index in 0..self.count {
            // Lower orders first: they need the higher ones as they were.
            for order in 0..=INPUT_ORDERS {
                self.numbers[order * self.count + index] = self.taylor(index, order, t);
            }
        }
        let n = self.actuators;
        for limit in &mut self.numbers[3 * n..4 * n] {
            *limit = limit.max(0.0);
        }
    }

    /// All derivatives become 0: the inputs stay where they are.
    pub fn hold(&mut self) {
        if self.varies {
            self.numbers[self.count..].fill(0.0);
            self.varies = false;
        }
    }

    /// Overwrites these inputs with others of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        if self.varies || other.varies {
            self.numbers.copy_from_slice(&other.numbers);
        } else {
            self.numbers[..self.count].copy_from_slice(&other.numbers[..self.count]);
        }
        self.varies = other.varies;
        self.wrenches.clear();
        self.wrenches.extend_from_slice(&other.wrenches);
    }

    /// Whether saved numbers can be used: values may be infinite, derivatives are finite.
    pub fn is_sound(&self, numbers: &[f64]) -> bool {
        let (values, derivatives) = numbers.split_at(self.count.min(numbers.len()));
        !values.iter().any(|x| x.is_nan()) && derivatives.iter().all(|x| x.is_finite())
    }

    /// Whether what was saved of [`Self::given`] can be used.
    pub fn tells_given(given: &[f64]) -> bool {
        let legal = [0.0_f64, 1.0].map(f64::to_bits);
        given.iter().all(|given| legal.contains(&given.to_bits()))
    }

    /// Takes over numbers that were saved; [`Self::gather`] must follow.
    pub fn restore(&mut self, numbers: &[f64]) {
        self.numbers.copy_from_slice(numbers);
        self.varies = self.numbers[self.count..].iter().any(|d| *d != 0.0);
    }

    /// Velocity of the surface of what stands still, m/s, axes of its base; none of what has none.
    pub fn surface_velocity(&self, root: RootId) -> Option<Vec3> {
        self.conveyors.contains(&root).then(|| {
            let along = |axis| self.get(InputSlot::SurfaceVelocity(root, axis));
            Vec3::new(along(0), along(1), along(2))
        })
    }

    /// Velocity `[ω; v]` of a driven base `t` seconds after the communication point, rad/s and
    /// m/s, world axes; none of what is not driven.
    pub fn base_velocity(&self, root: RootId, t: f64) -> Option<Vec6> {
        let first = self.index(InputSlot::BaseAngularVelocity(root, 0))?;
        Some(std::array::from_fn(|i| self.taylor(first + i, 0, t)))
    }

    /// Lists the external wrenches that are not 0, or will not be.
    pub fn gather(&mut self, model: &Model, tree: &Tree) {
        self.wrenches.clear();
        for (place, link) in model.outputs.external_wrenches.iter().enumerate() {
            let start = 4 * self.actuators + 6 * place;
            let part = |order: usize| -> [f64; 6] {
                std::array::from_fn(|i| self.numbers[order * self.count + start + i])
            };
            let wrench = part(0);
            let rates: [[f64; 6]; INPUT_ORDERS] = if self.varies {
                std::array::from_fn(|order| part(1 + order))
            } else {
                [[0.0; 6]; INPUT_ORDERS]
            };
            let varies = rates.iter().flatten().any(|x| *x != 0.0);
            if varies || wrench.iter().any(|x| *x != 0.0) {
                let link = link.index();
                self.wrenches.push(ExternalWrench {
                    body: model.links[link].body.index(),
                    point: tree.link_pose[link].point(&model.links[link].inertia.com),
                    wrench,
                    rates: varies.then_some(rates),
                });
            }
        }
    }
}
