//! Scenes with a known truth: a robot, what it is told, and how far what it does is from what it
//! should do.
//!
//! The acceptance rows of `tests/acceptance/scenes.rs` and the bench `scenes` run them. Truths are
//! closed forms, or integrations of equations that are written out here by hand and know nothing
//! of the engine. Numbers are SI units, g = 9.81 m/s² unless a scene says otherwise, and
//! communication steps are 1/240 s.

#[path = "../../benches/support/clock.rs"]
mod clock;
pub mod drawn;
pub mod press;
pub mod rim;
pub mod robots;
pub mod spin;
pub mod springs;
pub mod textbook;
pub mod truth;

use crate::testing::{Builder, inertia};
use std::cell::Cell;
use std::sync::Arc;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{ActuatorId, Ground, LinkId, Model, RootId};
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation};
use urdf2fmu_core::spatial::{Pose, RigidInertia, Vec3};
use urdf2fmu_core::tuning::Rules;

pub const G: f64 = 9.81;
pub const BASE: LinkId = LinkId(0);
pub const X: Vec3 = Vec3::new(1.0, 0.0, 0.0);
pub const Y: Vec3 = Vec3::new(0.0, 1.0, 0.0);
pub const Z: Vec3 = Vec3::new(0.0, 0.0, 1.0);
/// Communication step, s.
pub const H: f64 = 1.0 / 240.0;

/// How the simulator chooses its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solver {
    /// All of this length, s.
    Fixed(f64),
    /// Under error control with this tolerance.
    Tolerance(f64),
}

impl Solver {
    /// Fixed steps of one communication step.
    pub const FIXED: Self = Self::Fixed(H);
    /// The tolerance that a user gets without asking.
    pub const DEFAULT: Self = Self::Tolerance(1e-3);

    /// As tables call it.
    pub fn name(self) -> String {
        match self {
            Self::Fixed(h) => format!("steps of 1/{:.0} s", 1.0 / h),
            Self::Tolerance(tolerance) => format!("tol {tolerance:.0e}"),
        }
    }

    /// One of two numbers: for fixed steps and under error control.
    pub fn pick<T>(self, fixed: T, controlled: T) -> T {
        match self {
            Self::Fixed(_) => fixed,
            Self::Tolerance(_) => controlled,
        }
    }

    /// Ten tolerances, none for fixed steps.
    pub fn tolerances(self, count: f64) -> Option<f64> {
        match self {
            Self::Fixed(_) => None,
            Self::Tolerance(tolerance) => Some(count * tolerance),
        }
    }

    /// A target of the default tolerance that is ten times as strict at each tighter one, down to
    /// `least`.
    pub fn falling(self, target: f64, least: f64) -> Option<f64> {
        self.tolerances(target * 1e3).map(|t| t.max(least))
    }
}

/// What one run of a scene has shown.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Positions, m and rad, in the scene's own order; NaN alone where a step failed.
    pub seen: Vec<f64>,
    pub steps: f64,
    pub rejected: f64,
    /// CPU time of the steps and of what looks at them, s.
    pub seconds: f64,
}

impl Run {
    /// Adds the steps of another run.
    pub fn add_steps(&mut self, other: &Self) {
        self.steps += other.steps;
        self.rejected += other.rejected;
        self.seconds += other.seconds;
    }

    /// What has been seen, if that are `count` numbers, else NaN.
    pub fn seen_or_nan(&self, count: usize) -> Vec<f64> {
        if self.seen.len() == count {
            self.seen.clone()
        } else {
            vec![f64::NAN; count]
        }
    }

    /// Largest difference of what two runs have seen; NaN if one of them has failed.
    pub fn apart(&self, other: &Self) -> f64 {
        if self.seen.len() != other.seen.len() {
            return f64::NAN;
        }
        let pairs = self.seen.iter().zip(&other.seen);
        pairs.fold(0.0, |most, (a, b)| larger(most, (a - b).abs()))
    }
}

/// The larger of two errors; NaN if one of them is.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// One number that says how far a run is from the truth.
#[derive(Clone, Debug)]
pub struct Figure {
    pub name: String,
    pub error: f64,
    /// What it should not exceed; none where nothing is asked.
    pub target: Option<f64>,
}

impl Figure {
    /// Whether it exceeds its target; NaN does.
    pub fn missed(&self) -> bool {
        self.target
            .is_some_and(|t| self.error.is_nan() || self.error > t)
    }
}

/// A figure and what it should not exceed.
pub fn figure(name: &str, error: f64, target: impl Into<Option<f64>>) -> Figure {
    Figure {
        name: name.into(),
        error: error.abs(),
        target: target.into(),
    }
}

type Simulate = Box<dyn Fn(Solver) -> Run>;
type Judge = Box<dyn Fn(Solver, &Run) -> Vec<Figure>>;

/// A scene: what it does under a solver, and what that is worth.
pub struct Scene {
    pub name: String,
    /// Where the truth comes from.
    pub source: &'static str,
    pub simulate: Simulate,
    pub judge: Judge,
    /// The tolerance of our own solution that `seen` is compared with where nothing better exists.
    pub reference: Option<f64>,
}

impl Scene {
    /// Our own solution at a tight tolerance, where nothing better exists.
    pub fn solution(&self) -> Option<Run> {
        self.reference
            .map(|tolerance| (self.simulate)(Solver::Tolerance(tolerance)))
    }
}

/// The figures with a target of several scenes under one solver, the worst of each name. Those
/// with a reference are compared with it and should be off by two tolerances at most.
pub fn worst(scenes: &[Scene], references: &[Option<Run>], solver: Solver) -> Vec<Figure> {
    let mut worst: Vec<Figure> = Vec::new();
    for (scene, reference) in scenes.iter().zip(references) {
        let run = (scene.simulate)(solver);
        let mut figures = (scene.judge)(solver, &run);
        if let Some(reference) = reference {
            let name = "largest difference of a position, m or rad";
            figures.push(figure(name, run.apart(reference), solver.tolerances(2.0)));
        }
        for figure in figures.into_iter().filter(|f| f.target.is_some()) {
            match worst.iter_mut().find(|known| known.name == figure.name) {
                Some(known) => known.error = larger(known.error, figure.error),
                None => worst.push(figure),
            }
        }
    }
    worst
}

thread_local! {
    /// Rules of the method that act in the scenes of this thread.
    static RULES: Cell<Rules> = const { Cell::new(Rules::ALL) };
}

/// Switches rules of the method off or on in all scenes that this thread plays from now on.
pub fn set_rules(rules: Rules) {
    RULES.set(rules);
}

/// Runs a model to `end` in steps of `h` while `go_on` says so. `command` sets inputs at the
/// beginning of each step, at the time that it is given.
pub fn play(
    mut model: Model,
    solver: Solver,
    [h, end]: [f64; 2],
    command: &mut dyn FnMut(&mut Simulation, f64),
    go_on: &mut dyn FnMut(&mut Simulation, &mut Vec<f64>) -> bool,
) -> Run {
    let (step, tolerance) = match solver {
        Solver::Fixed(step) => (step, 1e-3),
        Solver::Tolerance(tolerance) => (0.0, tolerance),
    };
    model.solver.step_size = step;
    model.solver.tolerance = tolerance;
    let mut s = Simulation::new(Arc::new(model));
    s.set_parameter(ParameterSlot::MaxSteps, 1e7);
    s.set_rules(RULES.get());
    let mut run = Run::default();
    let count = (end / h).round().max(1.0) as u64;
    let mut good = s.initialize(0.0).is_ok();
    let begin = clock::now();
    for i in 0..count {
        command(&mut s, i as f64 * end / count as f64);
        good = good && s.advance_to((i + 1) as f64 * end / count as f64).is_ok();
        if !good || !go_on(&mut s, &mut run.seen) {
            break;
        }
    }
    if !good {
        run.seen = vec![f64::NAN];
    }
    run.seconds = clock::now() - begin;
    run.steps = s.output(OutputSlot::Steps);
    run.rejected = s.output(OutputSlot::Rejected);
    run
}

/// For scenes without commands.
pub fn idle(_: &mut Simulation, _: f64) {}

/// Keeps what `of` finds at the last communication point.
pub fn last(
    of: impl Fn(&Simulation) -> Vec<f64>,
) -> impl FnMut(&mut Simulation, &mut Vec<f64>) -> bool {
    move |s, seen| {
        *seen = of(s);
        true
    }
}

/// All coordinates.
pub fn coordinates(s: &Simulation) -> Vec<f64> {
    s.state().physical.q.clone()
}

/// Where the origin of the link of the robot's base is, m.
pub fn base_place(s: &mut Simulation) -> [f64; 3] {
    [0, 1, 2].map(|axis| s.output(OutputSlot::BasePosition(RootId::ROBOT, axis)))
}

/// A base that does not move and has no inertia: something to hang joints on.
pub fn fixed() -> Builder {
    Builder::new(false, RigidInertia::ZERO)
}

/// A plane with Coulomb friction alone.
pub fn ground(mu: f64) -> Ground {
    Ground {
        friction: mu,
        restitution: 0.0,
        static_excess: 0.0,
        rolling_friction: 0.0,
        torsional_friction: 0.0,
    }
}

/// A floating body of `mass` with one shape on a ground of the same friction.
pub fn single(mass: f64, diagonal: [f64; 3], shape: Shape, mu: f64) -> Builder {
    let mut b = Builder::new(true, inertia(mass, Vec3::zeros(), diagonal));
    b.shape(BASE, shape, Pose::IDENTITY);
    b.model.links[0].friction = mu;
    b.model.world.ground = Some(ground(mu));
    b.model.outputs.external_wrenches = vec![BASE];
    b
}

/// Gravity as on a slope of `angle`, falling along +x.
pub fn slope(angle: f64) -> Vec3 {
    Vec3::new(libm::sin(angle), 0.0, -libm::cos(angle)) * G
}

/// Sets the position that an actuator is told, once.
pub fn target(actuator: usize, position: f64) -> impl FnMut(&mut Simulation, f64) {
    move |s, _| s.set_input(InputSlot::Position(ActuatorId::from(actuator)), position)
}

/// The scenes of the table, each class by a few members.
pub fn all() -> Vec<Scene> {
    let mut all = Vec::new();
    all.extend([0.5, 2.0, 5.0, 10.0].map(|f| springs::spring(1.0, f, 0.0)));
    all.extend([0.005, 0.02, 0.1].map(|zeta| springs::spring(1.0, 2.0, zeta)));
    all.push(springs::sprung_foot());
    all.extend([0.002, 0.1, 0.8].map(springs::saturated));
    all.extend([8.0, 0.0].map(|kp| spin::satellite(kp, spin::SPIN)));
    for spin in [
        [0.1, 4.0, 0.1],
        [0.01, 6.0, 0.02],
        [1.0, 2.0, 3.0],
        [0.2, 0.1, 10.0],
    ] {
        all.extend([false, true].map(|shaped| spin::tumble(spin, shaped)));
    }
    all.push(press::tipping(0.05, 1.0, 5));
    all.push(press::tipping(0.05, 4.0, 5));
    all.extend([0.9, 0.96].map(|share| press::leaning_can(0.05, 1.0, share)));
    all.extend([2.0, 5.0, 15.0].map(|lean| rim::can(0.05, 1.0, lean)));
    all.push(rim::disc(2.0, 0.0));
    all.push(rim::disc(2.0, 0.05));
    all.push(rim::coin());
    all.push(press::depths());
    all.extend([[1.0, 1e2], [1.0, 1e6]].map(|[mass, load]| press::pressed(mass, load)));
    all.extend([[0.3, 0.3], [1.0, 0.5], [3.0, 0.8], [1.0, 0.95]].map(press::bounce));
    all.extend([1.005, 1.02, 1.2].map(|s| press::release(s, press::Placed::Sunk)));
    all.push(press::release(1.02, press::Placed::Assembled));
    all.extend(robots::all());
    all.extend(textbook::all());
    all
}
