//! Bodies of very different masses on each other.

use super::worlds::{body, cube, depth, speed, world};
use super::*;

/// A cube of `size`, m, with the inertia of a solid one.
fn solid(mass: f64, size: f64, at: Vec3) -> Model {
    let half = Vec3::repeat(0.5 * size);
    body(mass, Shape::Box { half }, at)
}

/// A gram under a tonne, cubes of 10 cm: 27 depths, as the stiffening law says, and at rest. Under
/// five tonnes, of which the law says 49 depths, a spring that was as soft there as at its
/// beginning let the cubes sink for ever, at 13 mm/s. A tonne under a gram does not notice it.
#[test]
fn masses_a_million_times_apart_rest_on_each_other() {
    let (light, heavy) = (1e-3, 1e3);
    let loads = [(light, heavy), (light, 5.0 * heavy), (heavy, light)];
    for ((under, above), step) in loads
        .iter()
        .flat_map(|l| [0.0, 1.0 / 240.0].map(|h| (*l, h)))
    {
        let cubes = [(under, 0.05), (above, 0.15)].map(|(m, z)| cube(m, Vec3::new(0.0, 0.0, z)));
        let mut model = world(cubes);
        model.solver.step_size = step;
        let mut s = start(model, 1e-3);
        s.advance_to(10.0).expect("finite");
        let [low, high] = [2, 9].map(|i| s.state().physical.q[i]);
        let own = depth((under + above) / under);
        let between = depth(above / under.max(above));
        assert!(
            (low - (0.05 - own)).abs() < 1e-6 * own.max(1e-3),
            "{low} {own}"
        );
        assert!(
            (high - low - (0.1 - between)).abs() < 1e-9,
            "{high} {low} {between}"
        );
        assert!(speed(&s) <= 0.0);
    }
}

/// A gram lies still on a block of 100 m and of 1e9 kg, in every kind of step. Where the impulses
/// on both were judged together, what was left of those on the block was more than the weight of
/// the gram, which shook at up to 15 cm/s and was moved by 8 mm in a second.
#[test]
fn a_gram_lies_still_on_a_block_of_a_million_tonnes() {
    for (mass, size) in [(1e7, 100.0), (1e9, 1.0), (1e9, 100.0)] {
        for (step, tolerance) in [(1.0 / 240.0, 0.0), (0.0, 1e-2), (0.0, 1e-3), (0.0, 1e-5)] {
            let place = Vec3::new(0.03 * size, 0.02 * size, size + 0.005);
            let block = solid(mass, size, Vec3::new(0.0, 0.0, 0.5 * size));
            let mut model = world([block, solid(1e-3, 0.01, place)]);
            model.solver.step_size = step;
            let mut s = start(model, tolerance);
            let q = |s: &Simulation| Vec3::from_row_slice(&s.state().physical.q[7..10]);
            s.advance_to(0.5).expect("finite");
            let begin = q(&s);
            for k in 1..=240 {
                s.advance_to(0.5 + f64::from(k) / 240.0).expect("finite");
                assert!(speed(&s) < 1e-9, "{mass} {size} {step} {tolerance}");
            }
            assert!((q(&s) - begin).norm() < 1e-11);
        }
    }
}
