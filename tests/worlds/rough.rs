//! A quadruped stands and walks on rough ground, and a parcel on a belt.

use super::{G, Run, examples, run};

const FEET: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];

/// At rest the ground carries the weight along z, and nothing along x and y, with all feet.
fn stands(run: &Run) {
    let urdf = std::fs::read_to_string(examples().join("quadruped.urdf")).unwrap();
    let masses = urdf.split("<mass value=\"").skip(1);
    let mass: f64 = masses
        .map(|m| m.split('"').next().unwrap().parse::<f64>().unwrap())
        .sum();
    let force = |axis: &str| -> f64 {
        let of = |foot: &&str| run.last(&format!("contact.{foot}_foot.force.{axis}"));
        FEET.iter().map(of).sum()
    };
    let weight = mass * G;
    assert!(
        (force("z") - weight).abs() < 1e-3 * weight,
        "{} {weight}",
        force("z")
    );
    assert!(force("x").abs().max(force("y").abs()) < 1e-3 * weight);
    for foot in FEET {
        let active = run.last(&format!("contact.{foot}_foot.active"));
        assert!(active > 0.5, "{foot} hangs in the air");
    }
}

/// It trots from 2 s to 7 s, ten steps a leg of 0.12 m each, uphill and downhill without looking
/// where it treads, and stands again.
#[test]
fn a_quadruped_trots_over_rough_ground_and_stands_again() {
    let run = run("quadruped.urdf", "rough_ground", 8.0);
    let way = run.last("base.position.x") - run.at("base.position.x", 2.0);
    assert!((0.8..1.2).contains(&way), "{way} of 1.2 m");
    // Its z axis leans by no more than the hills, whose slope is up to 0.25.
    for row in 0..run.time.len() {
        let (_, [x, y, _, _]) = run.pose("base", row);
        let leans = 2.0 * (x * x + y * y).sqrt();
        assert!(leans < 0.3, "{leans} rad at {} s", run.time[row]);
    }
    for foot in FEET {
        let active = run.column(&format!("contact.{foot}_foot.active"));
        let lifts = active.windows(2).filter(|two| two[0] > two[1]).count();
        assert!(lifts >= 9, "{foot} was lifted {lifts} times");
    }
    stands(&run);
}

#[test]
fn a_quadruped_stands_down_on_rough_ground_and_a_parcel_goes_with_its_belt() {
    let run = run("quadruped.urdf", "rough_ground", 2.0);
    stands(&run);

    // The parcel slips for v/(μ g), and is behind the belt by v²/(2 μ g) then.
    let (v, mu) = (0.5, 0.8);
    let speed = run.last("object.parcel.linear_velocity.x");
    assert!((speed - v).abs() < 1e-6, "{speed}");
    let way = run.last("object.parcel.position.x") - 3.6;
    let expected = v * 2.0 - v * v / (2.0 * mu * G);
    // Before friction slides it gives way by a fraction of a millimetre.
    assert!((way - expected).abs() < 1e-3, "{way} {expected}");
}
