//! A quadruped on rough ground, and a parcel on a belt.

use super::{G, examples, run};

#[test]
fn a_quadruped_stands_down_on_rough_ground_and_a_parcel_goes_with_its_belt() {
    let run = run("quadruped.urdf", "rough_ground", 2.0);
    let urdf = std::fs::read_to_string(examples().join("quadruped.urdf")).unwrap();
    let masses = urdf.split("<mass value=\"").skip(1);
    let mass: f64 = masses
        .map(|m| m.split('"').next().unwrap().parse::<f64>().unwrap())
        .sum();
    // At rest the ground carries the weight along z, and nothing along x and y.
    let force = |axis: &str| -> f64 {
        let feet = ["front_left", "front_right", "rear_left", "rear_right"];
        feet.iter()
            .map(|foot| run.last(&format!("contact.{foot}_foot.force.{axis}")))
            .sum()
    };
    let weight = mass * G;
    assert!(
        (force("z") - weight).abs() < 1e-3 * weight,
        "{} {weight}",
        force("z")
    );
    assert!(force("x").abs().max(force("y").abs()) < 1e-3 * weight);
    for foot in ["front_left", "front_right", "rear_left", "rear_right"] {
        let active = run.last(&format!("contact.{foot}_foot.active"));
        assert!(active > 0.5, "{foot} hangs in the air");
    }

    // The parcel slips for v/(μ g), and is behind the belt by v²/(2 μ g) then.
    let (v, mu) = (0.5, 0.8);
    let speed = run.last("object.parcel.linear_velocity.x");
    assert!((speed - v).abs() < 1e-6, "{speed}");
    let way = run.last("object.parcel.position.x") - 3.6;
    let expected = v * 2.0 - v * v / (2.0 * mu * G);
    // Before friction slides it gives way by a fraction of a millimetre.
    assert!((way - expected).abs() < 1e-3, "{way} {expected}");
}
