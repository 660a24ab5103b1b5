//! Cylinders that stand on each other, or on less than their end is wide.

use super::worlds::{body, world};
use super::*;

/// A can of 50 mm radius and height.
fn can(at: Vec3) -> Model {
    let (radius, half_length) = (0.05, 0.025);
    let shape = Shape::Cylinder {
        radius,
        half_length,
    };
    body(0.3, shape, at)
}

/// After how many communication steps of 1/240 s, of 360, a world takes no more steps, and its
/// fastest coordinate then.
fn last_step(model: Model, tolerance: f64) -> (u32, f64) {
    let mut s = start(model, tolerance);
    let (mut last, mut count) = (0, 0);
    for i in 1..=360 {
        s.advance_to(f64::from(i) / 240.0).expect("finite");
        let now = s.state().stepping.counters.steps;
        if now != count {
            (count, last) = (now, i);
        }
    }
    let v = &s.state().physical.v;
    (last, v.iter().fold(0.0, |most: f64, v| most.max(v.abs())))
}

/// A can stands on another one, or on a box, beside its middle. Wherever it stands, it is at rest
/// within a second. Where the place of the load on an end was found against the normal of the
/// contact, which is that of the one end or of the other by turns, 36 of these 78 worlds never came
/// to rest, and three that stand 16 mm beside each other did not where ends had no more than a
/// fixed share of a contact.
#[test]
fn cans_that_stand_on_each_other_askew_come_to_rest() {
    let mut wrong = Vec::new();
    for on_box in [false, true] {
        for beside in [
            0.0, 2e-4, 0.001, 0.003, 0.005, 0.008, 0.012, 0.016, 0.02, 0.025, 0.03, 0.035, 0.04,
        ] {
            for (tolerance, step) in [(1e-3, 1.0 / 240.0), (1e-3, 0.0), (1e-5, 0.0)] {
                let lower = Vec3::new(0.0, 0.0, 0.025);
                let lower = if on_box {
                    let half = Vec3::new(0.05, 0.05, 0.025);
                    body(0.3, Shape::Box { half }, lower)
                } else {
                    can(lower)
                };
                let upper = can(Vec3::new(beside, 0.3 * beside, 0.075));
                let mut model = world([lower, upper]);
                model.solver.step_size = step;
                let (last, speed) = last_step(model, tolerance);
                if last > 240 {
                    wrong.push(format!(
                        "on a box: {on_box}, {beside} m beside, {tolerance}, steps of {step}: \
                         {speed:.1e}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}\n{}", wrong.len(), wrong.join("\n"));
}
