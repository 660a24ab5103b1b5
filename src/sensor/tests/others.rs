//! What other robots and objects, springs and loops do to sensors. Expected values: statics and
//! circular motion.

use super::{G, near, read, start, wrench};
use crate::assemble::testing::{at, collision, frame, mass, point, robot};
use crate::assemble::{Guest, of_object, solid, world};
use crate::geometry::Shape;
use crate::model::JointKind::{Continuous, Fixed};
use crate::model::{ActuatorId, RootKind, SensorId};
use crate::settings::{ObjectSettings, ObjectSource, Settings};
use crate::simulation::{InputSlot, OutputSlot, Sensed, Simulation};
use crate::spatial::{Pose, Vec3};
use crate::urdf::{Description, LinkDescription};
use std::sync::Arc;

/// A disc of 2 kg on which things stand.
fn plate(name: &str) -> LinkDescription {
    let half = Vec3::new(0.5, 0.5, 0.05);
    LinkDescription {
        collisions: vec![collision(Pose::IDENTITY, Shape::Box { half })],
        ..mass(name, 2.0)
    }
}

const WEIGHT: &str = "[[world.object]]\nname = \"weight\"\nshape = { box = [0.1, 0.1, 0.1] }\n\
                      mass = 3\nxyz = [0.5, 0.05, 1.1]\n";

/// The robot with the solids of its settings around it.
fn surrounded(robot: &Description, settings: &str) -> Simulation {
    let settings = Settings::parse(settings, "test.toml").expect("legal settings");
    let guest = |object: &ObjectSettings| {
        let ObjectSource::Solid { shape, mass } = &object.source else {
            panic!("not a solid");
        };
        let name = object.name.as_ref().expect("a name").text.clone();
        Guest {
            description: solid(&name, shape, *mass),
            name,
            kind: RootKind::Object,
            settings: of_object(object, &settings),
        }
    };
    let guests: Vec<Guest> = settings.objects.iter().map(guest).collect();
    let built = world(robot, &settings, &guests).expect("a world");
    let mut simulation = Simulation::new(Arc::new(built.model));
    simulation.initialize(0.0).expect("a legal start");
    simulation
}

/// A weight that stands on a table beside its post, fixed or on a hinge: the post carries it, with
/// its lever. The table never moves, so its frame is that of the world; the weight has its own.
#[test]
fn a_post_carries_what_stands_on_its_table() {
    for kind in [Fixed, Continuous] {
        let stand =
            robot(frame("world")).with("world", "post", kind, at(0.2, -0.1, 1.0), plate("table"));
        let actuator = "[[actuator]]\njoint = \"*\"\nmode = \"none\"\n";
        let sensors = "[[sensor]]\ntype = \"ft\"\njoint = \"post\"\n\
                       [[sensor]]\ntype = \"contact\"\nname = \"pad\"\nlink = \"table\"\n";
        let actuator = if kind == Fixed { "" } else { actuator };
        let mut s = surrounded(&stand, &format!("{actuator}{sensors}{WEIGHT}"));
        s.advance_to(1.0).expect("a rest");
        let [force, torque] = wrench(&mut s);
        near(force, Vec3::new(0.0, 0.0, 5.0 * G), 1e-4);
        near(torque, Vec3::new(0.15, -0.3, 0.0) * (3.0 * G), 1e-4);
        let pressed = s.output(OutputSlot::Sensor(SensorId(1), Sensed::NormalForce));
        assert!((pressed - 3.0 * G).abs() < 1e-4, "{pressed}");
        near(
            read(&mut s, Sensed::Point, 1),
            Vec3::new(0.3, 0.15, 0.05),
            1e-3,
        );
    }
}

/// A rod of 2 kg and 1 m lies level on a hinge and something that holds its end.
fn level() -> Description {
    let rod = point("rod", 2.0, Vec3::new(0.5, 0.0, 0.0));
    robot(frame("world"))
        .with("world", "hinge", Continuous, at(0.0, 0.0, 1.0), rod)
        .and(|j| j.axis = Vec3::y())
}

/// A level rod whose end hangs on a spring or a rod: its hinge carries half of its weight, and what
/// the spring pulls along.
#[test]
fn a_hinge_carries_what_springs_and_loops_leave_it() {
    let ends = "links = [\"rod\", \"world\"]\norigins = [[1, 0, 0], [2, 0, 2]]\n";
    // 45°: half of the weight upwards, and the same along x.
    let tension = G * std::f64::consts::SQRT_2;
    let spring = format!(
        "[[spring]]\n{ends}stiffness = 1000\nlength = {}\n",
        std::f64::consts::SQRT_2 - tension / 1000.0
    );
    let length = format!("[[loop]]\ntype = \"distance\"\n{ends}");
    // A ball loop, whose other end hangs on nothing but the world.
    let ball = "[[loop]]\ntype = \"ball\"\nlinks = [\"world\", \"rod\"]\n\
                origins = [[1, 0, 1], [1, 0, 0]]\n";
    for (held, along) in [(spring.as_str(), -G), (&length, -G), (ball, f64::NAN)] {
        let settings = format!(
            "world.ground.type = \"none\"\n[[actuator]]\njoint = \"*\"\nmode = \"none\"\n\
             [[sensor]]\ntype = \"ft\"\njoint = \"hinge\"\n{held}"
        );
        let mut s = start(&level(), &settings);
        let [force, torque] = wrench(&mut s);
        near(torque, Vec3::zeros(), 1e-9);
        assert!((force.z - G).abs() < 1e-9, "{force} {held}");
        assert!(
            along.is_nan() || (force.x - along).abs() < 1e-9,
            "{force} {held}"
        );
    }
}

/// A box that rides on a turntable without slip: the axle is turned against what the box needs.
#[test]
fn an_axle_is_loaded_by_what_rides_on_its_turntable() {
    let (alpha, r, m) = (0.5, 0.3, 3.0);
    let table = robot(frame("world")).with(
        "world",
        "axle",
        Continuous,
        at(0.2, 0.05, 1.0),
        plate("table"),
    );
    let inertia = plate("table").inertial.expect("mass").I_cm[(2, 2)];
    let ride = m * (r * r + 0.01 / 6.0);
    let settings = format!(
        "[[actuator]]\njoint = \"axle\"\nmode = \"effort\"\n[[sensor]]\ntype = \"ft\"\njoint = \"axle\"\n\
         [[sensor]]\ntype = \"imu\"\nlink = \"table\"\nxyz = [{r}, 0, 0]\n{WEIGHT}"
    );
    let mut s = surrounded(&table, &settings);
    let effort = InputSlot::Effort(ActuatorId(0));
    s.set_input(effort, alpha * (inertia + ride));
    s.advance_to(2.0).expect("no slip");
    let [force, torque] = wrench(&mut s);
    // In the table's axes: the box is pulled inwards, and pushed on.
    let omega = 2.0 * alpha;
    let pull = Vec3::new(-omega * omega * r, alpha * r, 0.0) * m;
    near(force, pull + Vec3::new(0.0, 0.0, 5.0 * G), 0.02);
    let carried = Vec3::new(0.0, -r * m * G, 0.0) + Vec3::new(0.0, 0.0, 0.1).cross(&pull);
    near(
        torque,
        carried + Vec3::new(0.0, 0.0, alpha * (inertia + ride)),
        0.02,
    );
    // By the forces of the moment this was 0.159 to 0.190 m/s² along the table's edge at
    // communication points of 10 ms: in steps of 5 ms the load that the box leaves to friction
    // alternates.
    let felt = Vec3::new(-omega * omega * r, alpha * r, G);
    near(read(&mut s, Sensed::Acceleration, 1), felt, 2e-3);
}
