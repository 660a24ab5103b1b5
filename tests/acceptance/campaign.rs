//! Random drops: a robot is dropped onto the ground in every attitude, limp or driven, unmodified
//! or with one property at an extreme value. The tests take a sample; `benches/drops.rs` runs the
//! thousands of `docs/robustness.md`.
//!
//! Over 500 lines because the falls, what disturbs them and the ledger they are held to belong
//! together.

use crate::random::Random;
use std::sync::Arc;
use urdf2fmu_core::force::{ContactSet, detect, find_turns};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::kinematics::Kinematics;
use urdf2fmu_core::model::{ActuatorId, ActuatorMode, Model, Motion, RootId};
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation};

/// Communication step, s, and number of them in a drop.
const H: f64 = 1.0 / 240.0;
const STEPS: u32 = 300;

/// What is unusual about a robot or its world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// Nothing.
    None,
    /// Masses over six decades.
    MassRatio,
    /// Every joint under a pd law with 1e6 N·m/rad and 1e3 N·m·s/rad, unlimited.
    StiffGains,
    /// It starts anywhere in the ground.
    Overlap,
    /// Shapes without size.
    Points,
    /// Shapes a thousand times as large.
    Huge,
    /// Thrown at the ground without gravity.
    NoGravity,
    /// No effort limit.
    LimitlessEffort,
    /// No friction.
    NoFriction,
    /// Friction of 1e6.
    HugeFriction,
    /// It bounces without loss.
    Bouncing,
    /// Communication steps from 1 ns to 1 s.
    AnyStep,
}

impl Extreme {
    /// All but [`Extreme::None`].
    pub const ALL: [Self; 11] = [
        Self::MassRatio,
        Self::StiffGains,
        Self::Overlap,
        Self::Points,
        Self::Huge,
        Self::NoGravity,
        Self::LimitlessEffort,
        Self::NoFriction,
        Self::HugeFriction,
        Self::Bouncing,
        Self::AnyStep,
    ];

    /// As the table calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "as it is",
            Self::MassRatio => "masses times 1e-3 … 1e3",
            Self::StiffGains => "pd, 1e6 N·m/rad and 1e3 N·m·s/rad, unlimited",
            Self::Overlap => "begins anywhere in the ground",
            Self::Points => "shapes without size",
            Self::Huge => "shapes 1000 times as large",
            Self::NoGravity => "no gravity",
            Self::LimitlessEffort => "max_effort infinite",
            Self::NoFriction => "friction 0",
            Self::HugeFriction => "friction 1e6",
            Self::Bouncing => "restitution 1",
            Self::AnyStep => "doStep of 1 ns … 1 s",
        }
    }

    /// Makes a robot and its world extreme.
    fn apply(self, model: &mut Model, random: &mut Random) {
        match self {
            Self::MassRatio => {
                for link in &mut model.links {
                    let scale = libm::pow(10.0, random.uniform(-3.0, 3.0));
                    link.inertia.mass *= scale;
                    link.inertia.I_cm *= scale;
                }
            }
            Self::StiffGains => {
                for actuator in &mut model.actuators {
                    actuator.mode = ActuatorMode::Pd;
                    (actuator.kp, actuator.kd) = (1e6, 1e3);
                    actuator.max_effort = f64::INFINITY;
                }
            }
            Self::Points => {
                for collider in &mut model.colliders {
                    resize(&mut collider.shape, 0.0);
                }
            }
            Self::Huge => {
                for collider in &mut model.colliders {
                    resize(&mut collider.shape, 1e3);
                }
            }
            Self::NoGravity => model.world.gravity *= 0.0,
            Self::NoFriction | Self::HugeFriction => {
                let mu = if self == Self::NoFriction { 0.0 } else { 1e6 };
                for link in &mut model.links {
                    link.friction = mu;
                }
                if let Some(ground) = &mut model.world.ground {
                    ground.friction = mu;
                }
            }
            Self::Bouncing => {
                for link in &mut model.links {
                    link.restitution = 1.0;
                }
            }
            Self::None | Self::Overlap | Self::LimitlessEffort | Self::AnyStep => {}
        }
    }
}

/// Multiplies the lengths of a shape.
fn resize(shape: &mut Shape, scale: f64) {
    match shape {
        Shape::Sphere { radius } => *radius *= scale,
        Shape::Cylinder {
            radius,
            half_length,
        }
        | Shape::Capsule {
            radius,
            half_length,
        } => {
            *radius *= scale;
            *half_length *= scale;
        }
        Shape::Box { half } => *half *= scale,
        Shape::Hull { vertices } => {
            for vertex in vertices {
                *vertex *= scale;
            }
        }
        // No robot has terrain.
        Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => {}
    }
}

/// Poses and velocities of a state.
fn kinematics(s: &Simulation) -> Kinematics {
    let mut kin = Kinematics::new(s.tree());
    kin.update_poses(s.tree(), &s.state().physical.q);
    kin.update_velocities(s.tree(), &s.state().physical.v);
    kin
}

/// Normal force of all contacts of a state, as a step from it would see them, N.
pub fn pressing(s: &Simulation) -> f64 {
    let kin = kinematics(s);
    let contacts = touching(s, &kin);
    contacts
        .iter()
        .map(|c| c.normal_load(&contacts.points, &kin.V))
        .sum()
}

fn touching(s: &Simulation, kin: &Kinematics) -> ContactSet {
    let mut list = ContactSet::of(s.model());
    let touches = &s.state().physical.memory.touches;
    detect(s.model(), s.tree(), touches, kin, H, &mut list);
    list
}

/// Depth of a contact, relative to `δ₁`, from which its spring is its tangent.
const STIFFEST: f64 = 30.0;

/// What springs hold in a state, J: `K (½ δ² + δ⁵/5δ₁³)` of the normal springs of contacts with the
/// fourth-power norm `δ` of their points' depths, with its tangent beyond [`STIFFEST`], ½ k x² of
/// joint limits, and ½ k |ς|² of what friction has stored: of contacts, against turning, dry
/// friction, velocity motors.
pub fn stored(s: &Simulation) -> [f64; 2] {
    let (tree, state) = (s.tree(), s.state());
    let (mut springs, mut friction) = (0.0, 0.0);
    let kin = kinematics(s);
    let contacts = touching(s, &kin);
    for contact in contacts.iter() {
        let points = &contacts.points[contact.points.clone()];
        let fourth = points.iter().map(|p| p.share * p.depth.max(0.0).powi(4));
        let (depth, spring) = (fourth.sum::<f64>().powf(0.25), &contact.spring);
        let stiffening = depth.min(STIFFEST * spring.reference);
        let (excess, rest) = ((stiffening / spring.reference).powi(3), depth - stiffening);
        springs += spring.stiffness * stiffening * stiffening * (0.5 + 0.2 * excess);
        let slope = 1.0 + 4.0 * excess;
        springs += spring.stiffness * rest * (stiffening * (1.0 + excess) + 0.5 * rest * slope);
        let element = &contact.friction;
        friction += 0.5 * element.stiffness * element.displacement.norm_squared();
    }
    let mut turns = Vec::new();
    find_turns(
        tree,
        &state.physical.memory.touches,
        &kin,
        &contacts,
        &mut turns,
    );
    for turn in &turns {
        let (torsion, roll) = (turn.torsional.displacement, turn.rolling.displacement);
        friction += 0.5 * turn.torsional.stiffness * torsion * torsion;
        friction += 0.5 * turn.rolling.stiffness * roll.norm_squared();
    }
    for (dof, limits) in tree.dofs.limits.iter().enumerate() {
        let body = &s.model().bodies[s.model().dofs[dof].body.index()];
        if let Some(limits) = limits {
            let q = state.physical.q[body.coordinate];
            let depth = (limits.lower - q).max(q - limits.upper).max(0.0);
            springs += 0.5 * tree.dofs.limit_stiffness[dof] * depth * depth;
        }
        let stiffness = tree.dofs.friction[dof].moving / DRY_DEFLECTION;
        friction +=
            0.5 * stiffness * state.physical.memory.dry[dof] * state.physical.memory.dry[dof];
    }
    for (motor, displacement) in tree
        .actuators
        .motors
        .iter()
        .zip(&state.physical.memory.motor)
    {
        friction += 0.5 * motor.0 * displacement * displacement;
    }
    [springs, friction]
}

/// Deflection at which dry friction gives way, m or rad: documented, and measured by
/// `dry_friction_is_a_spring_until_it_slips`.
pub const DRY_DEFLECTION: f64 = 1e-4;

/// Keeps the books of a passive robot's energy, without any allowance.
///
/// One account holds what moves: kinetic energy, height, and the springs of contacts and limits.
/// The other holds what friction elements have stored, and only what has been paid for: what leaves
/// the first account may go into the second, up to what is stored there, and a rise of the first
/// may be drawn from it. Whatever rises beyond that is a gain at the moment at which it happens,
/// whatever was lost before. Energy that friction elements store without payment is not recorded
/// until it comes back, and then it is a gain. In continuous time there is none: the normal law
/// takes `d k x vₙ²`, friction `d_t u²` while it sticks and `F̄ u` while it slips.
#[derive(Clone, Debug)]
pub struct Ledger {
    /// The two accounts, J; NaN before the first entry.
    moving: f64,
    paid: f64,
    /// Lowest sum of both so far, and lowest energy with all that friction elements have in store,
    /// J.
    lowest: [f64; 2],
    /// What the robot had to fall with, J: kinetic energy, energy of position above the ground, and
    /// what springs held at the start.
    pub scale: f64,
    /// All gains together, as a share of `scale`.
    pub gained: f64,
    /// Most that the two accounts have stood over their lowest sum before, as a share of `scale`.
    pub risen: f64,
    /// The same with all that friction elements have in store, paid or not.
    pub raw: f64,
}

impl Ledger {
    /// From the state in which the robot is let go.
    pub fn new(s: &mut Simulation) -> Self {
        let kinetic = s.output(OutputSlot::EnergyKinetic);
        let potential = s.output(OutputSlot::EnergyPotential);
        let [springs, _] = stored(s);
        let mut ledger = Self {
            moving: f64::NAN,
            paid: 0.0,
            lowest: [f64::INFINITY; 2],
            scale: kinetic + potential.abs() + springs,
            gained: 0.0,
            risen: 0.0,
            raw: 0.0,
        };
        ledger.add(s);
        ledger
    }

    /// Kinetic energy, height, and the springs of contacts and limits, J.
    pub fn moving(&self) -> f64 {
        self.moving
    }

    /// Enters a state.
    pub fn add(&mut self, s: &mut Simulation) {
        let [springs, friction] = stored(s);
        let moving =
            s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential) + springs;
        if !self.moving.is_nan() {
            let rise = moving - self.moving;
            self.gained += (rise - self.paid).max(0.0) / self.scale;
            self.paid = (self.paid - rise).clamp(0.0, friction);
        }
        self.moving = moving;
        let sums = [moving + self.paid, moving + friction];
        for ((sum, lowest), most) in sums
            .iter()
            .zip(&mut self.lowest)
            .zip([&mut self.risen, &mut self.raw])
        {
            *lowest = lowest.min(*sum);
            *most = most.max((sum - *lowest) / self.scale);
        }
        // NaN must not count as no gain.
        if sums[1].is_nan() {
            (self.gained, self.risen, self.raw) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
        }
    }
}

/// Energy that limp robots of one kind of step have gained, each the most of its drops and with
/// robot and seed; see [`Ledger`].
#[derive(Clone, Debug, Default)]
pub struct Gain {
    /// Drops.
    pub drops: u32,
    /// [`Ledger::gained`].
    pub gained: Worst,
    /// [`Ledger::risen`].
    pub risen: Worst,
    /// [`Ledger::raw`].
    pub raw: Worst,
}

/// The worst of a number of drops.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// How bad it was; 0 if nothing was.
    pub share: f64,
    /// Robot and seed.
    pub drop: Option<(String, u64)>,
}

impl Worst {
    fn add(&mut self, share: f64, robot: &Model, seed: u64) {
        if share > self.share {
            self.share = share;
            self.drop = Some((robot.name.clone(), seed));
        }
    }
}

/// What came of drops.
#[derive(Debug, Default)]
pub struct Tally {
    /// Drops.
    pub drops: u32,
    /// Drops that ended with an error or with NaN.
    pub failed: u32,
    /// Robot and seed of each of them.
    pub failures: Vec<(String, u64)>,
    /// Limp robots' energy, under error control and in fixed steps.
    pub limp: [Gain; 2],
    /// Steps, and steps accepted at the floor.
    pub steps: [u64; 2],
    /// Host time, s: of all, and of the slowest drop.
    pub seconds: [f64; 2],
}

impl Tally {
    fn fail(&mut self, robot: &Model, seed: u64) {
        self.failed += 1;
        self.failures.push((robot.name.clone(), seed));
    }
}

/// One drop under way.
pub struct Drop {
    /// The robot and its world.
    pub s: Simulation,
    /// What it is told is random.
    random: Random,
    extreme: Extreme,
    /// Whether nothing drives it: even seeds.
    pub limp: bool,
    /// Whether it takes fixed steps: every fourth seed.
    pub fixed: bool,
    /// Communication steps behind it.
    step: u32,
}

impl Drop {
    /// Lets the robot go; none if it cannot be initialised.
    pub fn new(robot: &Model, extreme: Extreme, seed: u64) -> Option<Self> {
        let mut random = Random(seed);
        let limp = seed.is_multiple_of(2);
        let fixed = seed % 8 >= 6;
        let mut model = robot.clone();
        extreme.apply(&mut model, &mut random);
        let mut s = Simulation::new(Arc::new(model));
        place(&mut s, extreme, &mut random);
        if fixed {
            s.set_parameter(ParameterSlot::StepSize, H);
        }
        for a in 0..s.model().actuators.len() {
            let slot = InputSlot::MaxEffort(ActuatorId::from(a));
            if limp {
                s.set_input(slot, 0.0);
            } else if extreme == Extreme::LimitlessEffort {
                s.set_input(slot, f64::INFINITY);
            }
        }
        s.initialize(0.0).ok()?;
        Some(Self {
            s,
            random,
            extreme,
            limp,
            fixed,
            step: 0,
        })
    }

    /// Whether there is a communication step left.
    pub fn goes_on(&self) -> bool {
        self.step < STEPS && self.s.state().time <= 10.0
    }

    /// The next communication step; tells whether it went well.
    pub fn advance(&mut self) -> bool {
        let Self { s, random, .. } = self;
        if !self.limp && self.step.is_multiple_of(60) {
            for a in (0..s.model().actuators.len()).map(ActuatorId::from) {
                s.set_input(InputSlot::Velocity(a), random.uniform(-5.0, 5.0));
                s.set_input(InputSlot::Position(a), random.uniform(-1.0, 1.0));
                s.set_input(InputSlot::Effort(a), random.uniform(-10.0, 10.0));
            }
        }
        let h = match self.extreme {
            Extreme::AnyStep => libm::pow(10.0, random.uniform(-9.0, 0.0)),
            _ => H,
        };
        self.step += 1;
        let end = s.state().time + h;
        s.advance_to(end).is_ok() && s.state().is_finite()
    }
}

/// Throws the robot once and adds to the tally.
pub fn drop_once(robot: &Model, extreme: Extreme, seed: u64, tally: &mut Tally) {
    tally.drops += 1;
    let Some(mut drop) = Drop::new(robot, extreme, seed) else {
        tally.fail(robot, seed);
        return;
    };
    let mut ledger = Ledger::new(&mut drop.s);
    let mut seconds = 0.0;
    while drop.goes_on() {
        let start = std::time::Instant::now();
        let well = drop.advance();
        seconds += start.elapsed().as_secs_f64();
        if !well {
            tally.fail(robot, seed);
            break;
        }
        if drop.limp {
            ledger.add(&mut drop.s);
        }
    }
    let counters = drop.s.state().stepping.counters;
    tally.seconds[0] += seconds;
    tally.seconds[1] = tally.seconds[1].max(seconds);
    tally.steps[0] += counters.steps;
    tally.steps[1] += counters.forced;
    if drop.limp {
        let gain = &mut tally.limp[usize::from(drop.fixed)];
        gain.drops += 1;
        gain.gained.add(ledger.gained, robot, seed);
        gain.risen.add(ledger.risen, robot, seed);
        gain.raw.add(ledger.raw, robot, seed);
    }
}

/// A random attitude, pose and motion above (or, overlapping, in) the ground.
fn place(s: &mut Simulation, extreme: Extreme, random: &mut Random) {
    let model = s.model().clone();
    for axis in 0..3 {
        let angle = random.uniform(-3.0, 3.0);
        s.set_parameter(ParameterSlot::InitialBaseRpy(RootId::ROBOT, axis), angle);
        if model.bodies[0].motion == Motion::Free {
            let spin = random.uniform(-3.0, 3.0);
            s.set_parameter(
                ParameterSlot::InitialBaseAngularVelocity(RootId::ROBOT, axis),
                spin,
            );
            let mut speed = random.uniform(-1.0, 1.0);
            if extreme == Extreme::NoGravity && axis == 2 {
                speed -= 2.0;
            }
            s.set_parameter(
                ParameterSlot::InitialBaseLinearVelocity(RootId::ROBOT, axis),
                speed,
            );
        }
    }
    for (index, joint) in model.joints.iter().enumerate() {
        if let Some(limits) = joint.limits {
            let (low, high) = (limits.lower.max(-3.0), limits.upper.min(3.0));
            if low <= high {
                let slot = ParameterSlot::InitialJointPosition(index.into());
                s.set_parameter(slot, random.uniform(low, high));
            }
        }
    }
    let reach = s.tree().reach();
    let height = if extreme == Extreme::Overlap {
        random.uniform(-0.5, 0.5) * reach
    } else {
        reach + random.uniform(0.2, 1.0)
    };
    s.set_parameter(ParameterSlot::InitialBasePosition(RootId::ROBOT, 2), height);
}
