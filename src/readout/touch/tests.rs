//! Contact sensors. Expected values: statics.

use crate::assemble::testing::{at, collision, frame, mass, model, robot};
use crate::geometry::Shape;
use crate::model::JointKind::Fixed;
use crate::model::SensorId;
use crate::simulation::{OutputSlot, Sensed, Simulation};
use crate::spatial::Vec3;
use crate::urdf::{Description, LinkDescription};
use std::sync::Arc;

const G: f64 = 9.81;

/// A box of 0.4 m × 0.4 m × 0.1 m and 2 kg, with 1 kg on a mast at x = 0.12 m and y = −0.06 m.
fn loaded() -> Description {
    let shape = Shape::Box {
        half: Vec3::new(0.2, 0.2, 0.05),
    };
    let plate = LinkDescription {
        inertial: Some(shape.solid_inertia(2.0)),
        collisions: vec![collision(at(0.0, 0.0, 0.0), shape)],
        ..frame("plate")
    };
    let mast = at(0.12, -0.06, 0.3);
    robot(plate).with("plate", "mast", Fixed, mast, mass("load", 1.0))
}

/// Force, point and depth of a sensor after a while.
fn rest(s: &mut Simulation, sensor: u32) -> (f64, Vec3, f64) {
    let id = SensorId(sensor);
    (
        s.output(OutputSlot::Sensor(id, Sensed::NormalForce)),
        Vec3::from([0, 1, 2].map(|axis| s.output(OutputSlot::Sensor(id, Sensed::Point(axis))))),
        s.output(OutputSlot::Sensor(id, Sensed::Depth)),
    )
}

fn standing(sensors: &str) -> Simulation {
    let settings = format!("initial.rpy = [0, 0, 0.7]\n{sensors}");
    let mut s = Simulation::new(Arc::new(model(&loaded(), &settings)));
    s.initialize(0.0).expect("a legal start");
    s.advance_to(3.0).expect("finite");
    s
}

/// The load is 3 g at a third of the mast's place, in the link's frame whatever its yaw.
#[test]
fn a_contact_sensor_feels_the_weight_where_it_acts() {
    let mut s = standing("[[sensor]]\ntype = \"contact\"\nlink = \"plate\"\nxyz = [0, 0, -0.05]\n");
    let (force, point, depth) = rest(&mut s, 0);
    assert!((force - 3.0 * G).abs() < 1e-6, "{force}");
    assert!(
        (point - Vec3::new(0.04, -0.02, 0.0)).norm() < 2e-4,
        "{point}"
    );
    assert!(depth > 1e-5 && depth < 1e-3, "{depth}");
}

/// Four boxes about the corners: together they feel all of the weight, and their forces have the
/// moments of the load about both axes, with arms of 0.2 m.
#[test]
fn patches_of_a_face_share_its_load() {
    let patch = |name: &str, x: f64, y: f64| {
        format!(
            "[[sensor]]\ntype = \"contact\"\nname = \"{name}\"\nlink = \"plate\"\nxyz = [{x}, {y}, -0.05]\nsize = [0.1, 0.1, 0.02]\n"
        )
    };
    let corners = [(0.2, 0.2), (0.2, -0.2), (-0.2, 0.2), (-0.2, -0.2)];
    let sensors: String = (0..)
        .zip(corners)
        .map(|(i, (x, y))| patch(&format!("p{i}"), x, y))
        .collect();
    let mut s = standing(&format!("{sensors}{}", patch("middle", 0.0, 0.0)));
    let (mut sum, mut moment) = (0.0, Vec3::zeros());
    for (i, (x, y)) in (0..).zip(corners) {
        let (force, point, _) = rest(&mut s, i);
        // Corners tilt and sink in by less than a tenth of a millimetre.
        assert!(force > 1.0 && point.norm() < 2e-4, "{i}: {force} {point}");
        sum += force;
        moment += Vec3::new(x, y, 0.0) * force;
    }
    assert!((sum - 3.0 * G).abs() < 1e-6, "{sum}");
    assert!(
        (moment / sum - Vec3::new(0.04, -0.02, 0.0)).norm() < 2e-4,
        "{moment}"
    );
    assert_eq!(rest(&mut s, 4), (0.0, Vec3::zeros(), 0.0));
}

/// A box as large as the face: the corners lie on its border, to round-off and to what the tilt
/// under the load makes of that.
#[test]
fn the_border_of_a_box_belongs_to_it() {
    let sensors = "[[sensor]]\ntype = \"contact\"\nlink = \"plate\"\nxyz = [0, 0, -0.05]\nsize = [0.4, 0.4, 0.1]\n";
    let mut s = standing(sensors);
    let (force, ..) = rest(&mut s, 0);
    assert!((force - 3.0 * G).abs() < 1e-6, "{force}");
}

#[test]
fn a_contact_sensor_in_the_air_feels_nothing() {
    let sensors = "initial.xyz = [0, 0, 5]\n[[sensor]]\ntype = \"contact\"\nlink = \"plate\"\n";
    let mut s = Simulation::new(Arc::new(model(&loaded(), sensors)));
    s.initialize(0.0).expect("a legal start");
    s.advance_to(0.3).expect("finite");
    assert_eq!(rest(&mut s, 0), (0.0, Vec3::zeros(), 0.0));
}
