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

/// One simulation of a driven robot under random commands.
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
        for a in 0..self.simulation.model().actuators.len() {
            let speed = self.random.uniform(-8.0, 8.0);
            let slot = InputSlot::Velocity(ActuatorId::from(a));
            self.simulation.set_input(slot, speed);
        }
        let end = self.simulation.time() + self.random.uniform(1e-4, 0.02);
        self.simulation.advance_to(end).expect("finite");
    }
}

/// Repeatability. 64 simulations on eight threads, interleaved on each, give the bits of each simulation alone.
#[test]
fn sixty_four_simulations_on_eight_threads_give_the_bits_of_one() {
    for path in ["examples/rover.urdf", "examples/quadruped.urdf"] {
        let model = Arc::new(robot(path, |_| {}));
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
        let what = format!("of 64 simulations on 8 threads, other bits than alone, {path}");
        hold("G", &what, "0", differing as f64, 0.0);
        assert!(
            alone.windows(2).all(|pair| pair[0] != pair[1]),
            "seeds differ"
        );
    }
}

/// Repeatability. A state saved at a random moment, through bytes, in another instance that did something else before,
/// and run again.
#[test]
fn restored_states_continue_with_the_same_bits() {
    for path in ["examples/rover.urdf", "examples/quadruped.urdf"] {
        let model = Arc::new(robot(path, |_| {}));
        let mut differing = 0;
        for cut in [1, 17, 50, 83] {
            let mut first = Run::new(&model, 5);
            (0..cut).for_each(|_| first.step());
            let bytes = first.simulation.save().to_bytes();
            let random = first.random.0;
            (cut..100).for_each(|_| first.step());
            let mut other = Run::new(&model, 6);
            (0..31).for_each(|_| other.step());
            let saved = Snapshot::from_bytes(&model, &bytes).expect("what was written");
            other.simulation.restore(&saved).expect("the same model");
            other.random.0 = random;
            (cut..100).for_each(|_| other.step());
            differing += usize::from(bits(&first.simulation) != bits(&other.simulation));
        }
        let what = format!("of 4 restored runs, other bits than the first, {path}");
        hold("G", &what, "0", differing as f64, 0.0);
    }
}
