//! The same inputs give the same bits: in every run, instance, restored state and thread.

use super::robots::robot;
use super::*;
use testing::Random;
use urdf2fmu_core::simulation::Snapshot;

/// Every number of a state, as bits.
fn bits(s: &Simulation) -> Vec<u64> {
    let fields = s.state().fields();
    fields.into_iter().flatten().map(|x| x.to_bits()).collect()
}

/// Robots that drive, walk and reach.
const ROBOTS: [&str; 3] = [
    "examples/rover.urdf",
    "examples/quadruped.urdf",
    "examples/arm.urdf",
];

/// Every robot under error control and in fixed steps, with its name for the table.
fn cases() -> impl Iterator<Item = (Arc<Model>, String)> {
    let steps = [(0.0, "error control"), (1.0 / 240.0, "fixed steps")];
    ROBOTS.iter().flat_map(move |path| {
        steps.map(|(step, name)| {
            let mut model = robot(path, |_| {});
            model.solver.step_size = step;
            (Arc::new(model), format!("{path}, {name}"))
        })
    })
}

/// One simulation of a driven robot under random commands of every kind.
struct Run {
    simulation: Simulation,
    random: Random,
}

impl Run {
    fn new(model: &Arc<Model>, seed: u64) -> Self {
        let mut simulation = Simulation::new(Arc::clone(model));
        simulation.initialize(0.0).expect("a sound model");
        Self {
            simulation,
            random: Random(seed),
        }
    }

    fn step(&mut self) {
        let Self { simulation, random } = self;
        for a in (0..simulation.model().actuators.len()).map(ActuatorId::from) {
            simulation.set_input(InputSlot::Velocity(a), random.uniform(-8.0, 8.0));
            simulation.set_input(InputSlot::Position(a), random.uniform(-0.5, 0.5));
            simulation.set_input(InputSlot::Effort(a), random.uniform(-1.0, 1.0));
            let rate = random.uniform(-1.0, 1.0);
            simulation.set_input_derivative(InputSlot::Position(a), 1, rate);
        }
        let end = simulation.time() + random.uniform(1e-4, 0.02);
        simulation.advance_to(end).expect("finite");
    }
}

/// Repeatability. 64 simulations on eight threads, interleaved on each, give the bits of each
/// simulation alone.
#[test]
fn sixty_four_simulations_on_eight_threads_give_the_bits_of_one() {
    for (model, name) in cases() {
        let alone: Vec<Vec<u64>> = (0..8)
            .map(|seed| {
                let mut run = Run::new(&model, seed);
                (0..100).for_each(|_| run.step());
                bits(&run.simulation)
            })
            .collect();
        let differing: usize = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..8)
                .map(|_| {
                    scope.spawn(|| {
                        let mut runs: Vec<Run> =
                            (0..8).map(|seed| Run::new(&model, seed)).collect();
                        for _ in 0..100 {
                            runs.iter_mut().for_each(Run::step);
                        }
                        let pairs = runs.iter().zip(&alone);
                        pairs
                            .filter(|(run, alone)| bits(&run.simulation) != **alone)
                            .count()
                    })
                })
                .collect();
            threads
                .into_iter()
                .map(|t| t.join().expect("no panic"))
                .sum()
        });
        let what = format!("of 64 simulations on 8 threads, other bits than alone, {name}");
        hold("R", &what, "0", differing as f64, 0.0);
        assert!(
            alone.windows(2).all(|pair| pair[0] != pair[1]),
            "seeds differ"
        );
    }
}

/// Repeatability. A state saved at a random moment, through bytes, in another instance that did
/// something else before, and run again, on another thread.
#[test]
fn restored_states_continue_with_the_same_bits() {
    for (model, name) in cases() {
        let mut differing = 0;
        for cut in [1, 17, 50, 83] {
            let mut first = Run::new(&model, 5);
            (0..cut).for_each(|_| first.step());
            let bytes = first.simulation.save().to_bytes();
            let random = first.random.0;
            (cut..100).for_each(|_| first.step());
            let other = std::thread::scope(|scope| {
                let thread = scope.spawn(|| {
                    let mut other = Run::new(&model, 6);
                    (0..31).for_each(|_| other.step());
                    let saved = Snapshot::from_bytes(&model, &bytes).expect("what was written");
                    other.simulation.restore(&saved).expect("the same model");
                    other.random.0 = random;
                    (cut..100).for_each(|_| other.step());
                    bits(&other.simulation)
                });
                thread.join().expect("no panic")
            });
            differing += usize::from(bits(&first.simulation) != other);
        }
        let what = format!("of 4 restored runs, other bits than the first, {name}");
        hold("R", &what, "0", differing as f64, 0.0);
    }
}
