//! Newton and Euler for each link of random robots: what its joints, its contacts and gravity do to
//! it is what its own inertial unit says.

use crate::model::{JointId, JointKind, LinkId, Model, Sampling, Sensor, SensorId, SensorKind};
use crate::simulation::{OutputSlot, Sensed, Simulation};
use crate::spatial::{Mat3, Pose, Vec3, rotation_from_quaternion};
use crate::testing::{Random, random_tree, shape_all_links};
use std::sync::Arc;

/// An inertial unit at the centre of mass of every link, then a force–torque sensor in every joint.
fn with_sensors(mut model: Model) -> Model {
    let sensor = |name: String, link: LinkId, p: Vec3, kind: SensorKind| Sensor {
        name,
        link,
        X_LS: Pose {
            R: Mat3::identity(),
            p,
        },
        kind,
        sampling: Sampling::default(),
    };
    let links = (0..).map(LinkId).zip(&model.links);
    let units = links.map(|(id, link)| {
        let name = format!("imu{}", id.0);
        sensor(name, id, link.inertia.com, SensorKind::Imu)
    });
    let joints = (0..).map(JointId).zip(&model.joints);
    let loads = joints.map(|(id, joint)| {
        let kind = SensorKind::ForceTorque {
            joint: id,
            reversed: false,
        };
        sensor(format!("ft{}", id.0), joint.child, Vec3::zeros(), kind)
    });
    model.outputs.sensors = units.chain(loads).collect();
    model.outputs.links = (0..model.links.len()).map(LinkId::from).collect();
    model.outputs.contacts.clone_from(&model.outputs.links);
    model
}

fn vector(s: &mut Simulation, slot: impl Fn(u8) -> OutputSlot) -> Vec3 {
    Vec3::new(s.output(slot(0)), s.output(slot(1)), s.output(slot(2)))
}

/// Largest imbalance of forces, N, and of torques, N·m, each over the largest load.
fn imbalance(model: &Model, s: &mut Simulation) -> [f64; 2] {
    let links = model.links.len();
    let frames: Vec<Pose> = (0..links)
        .map(|l| {
            let id = LinkId::from(l);
            let q = [3, 0, 1, 2].map(|i| s.output(OutputSlot::LinkOrientation(id, i)));
            Pose {
                R: rotation_from_quaternion(&q),
                p: vector(s, |axis| OutputSlot::LinkPosition(id, axis)),
            }
        })
        .collect();
    let coms: Vec<Vec3> = (0..links)
        .map(|l| frames[l].point(&model.links[l].inertia.com))
        .collect();
    // What is missing at each link, about its centre of mass.
    let (mut forces, mut torques) = (vec![Vec3::zeros(); links], vec![Vec3::zeros(); links]);
    let mut largest = 0.0_f64;
    for l in 0..links {
        let (X, inertia) = (&frames[l], &model.links[l].inertia);
        let id = SensorId::from(l);
        let felt = vector(s, |axis| OutputSlot::Sensor(id, Sensed::Acceleration(axis)));
        let omega = vector(s, |axis| {
            OutputSlot::Sensor(id, Sensed::AngularVelocity(axis))
        });
        let alpha = Vec3::from(std::array::from_fn(|i| {
            let axis = u8::try_from(i).expect("three");
            s.output_derivative(OutputSlot::Sensor(id, Sensed::AngularVelocity(axis)))
                .expect("it has one")
        }));
        let spin = inertia.I_cm * alpha + omega.cross(&(inertia.I_cm * omega));
        let contact = vector(s, |axis| OutputSlot::ContactForce(LinkId::from(l), axis));
        forces[l] += contact - X.R * felt * inertia.mass;
        torques[l] -= X.R * spin;
        largest = largest.max(felt.norm() * inertia.mass);
    }
    for (j, joint) in model.joints.iter().enumerate() {
        let id = SensorId::from(links + j);
        let (child, parent) = (joint.child.index(), joint.parent.index());
        let X = &frames[child];
        let force = X.R * vector(s, |axis| OutputSlot::Sensor(id, Sensed::Force(axis)));
        let torque = X.R * vector(s, |axis| OutputSlot::Sensor(id, Sensed::Torque(axis)));
        for (l, sign) in [(child, 1.0), (parent, -1.0)] {
            forces[l] += force * sign;
            torques[l] += (torque + (X.p - coms[l]).cross(&force)) * sign;
        }
        largest = largest.max(force.norm());
    }
    // A base that is held takes what comes.
    let moving = (0..links).filter(|&l| model.is_floating() || l > 0);
    let of = |list: &[Vec3]| moving.clone().map(|l| list[l].norm()).fold(0.0, f64::max);
    [of(&forces) / largest, of(&torques) / largest]
}

fn start(mut model: Model, random: &mut Random) -> (Model, Simulation) {
    model.roots[0].rpy = random.vector(3.0);
    model.roots[0].angular_velocity = random.vector(2.0);
    model.roots[0].linear_velocity = random.vector(1.0);
    for velocity in &mut model.initial.joint_velocities {
        *velocity = random.uniform(-2.0, 2.0);
    }
    for position in &mut model.initial.joint_positions {
        *position = random.uniform(-1.0, 1.0);
    }
    let model = with_sensors(model);
    let mut s = Simulation::new(Arc::new(model.clone()));
    s.initialize(0.0).expect("a sound model");
    (model, s)
}

#[test]
fn joint_wrenches_balance_weight_and_inertia_of_random_robots() {
    for seed in 0..40 {
        let mut random = Random(seed);
        let model = random_tree(&mut random, 8, seed % 2 == 0, false);
        let (model, mut s) = start(model, &mut random);
        let worst = imbalance(&model, &mut s);
        assert!(worst.iter().all(|w| *w < 1e-9), "seed {seed}: {worst:?}");
        s.advance_to(0.05).expect("finite");
        let worst = imbalance(&model, &mut s);
        assert!(
            worst.iter().all(|w| *w < 1e-9),
            "seed {seed}, later: {worst:?}"
        );
    }
}

/// Largest load along a direction in which a joint moves freely, over the largest load: no motor,
/// damping or friction acts there, whatever contacts do to the links beyond.
fn free_load(model: &Model, s: &mut Simulation) -> f64 {
    let (mut free, mut largest) = (0.0_f64, 0.0_f64);
    for (j, joint) in model.joints.iter().enumerate() {
        let id = SensorId::from(model.links.len() + j);
        let force = vector(s, |axis| OutputSlot::Sensor(id, Sensed::Force(axis)));
        let torque = vector(s, |axis| OutputSlot::Sensor(id, Sensed::Torque(axis)));
        largest = largest.max(force.norm()).max(torque.norm());
        free = free.max(match joint.kind {
            JointKind::Continuous => joint.axis.dot(&torque).abs(),
            JointKind::Prismatic => joint.axis.dot(&force).abs(),
            // A ball joint.
            _ => torque.norm(),
        });
    }
    free / largest
}

/// Where on a link the ground pushes is no output; that the moments of contacts are counted, too,
/// shows in the directions in which joints are free.
#[test]
fn joint_wrenches_and_contacts_balance_weight_and_inertia() {
    let mut pressed = 0;
    for seed in 100..130 {
        let mut random = Random(seed);
        let mut model = random_tree(&mut random, 8, true, false);
        shape_all_links(&mut model);
        model.world.ground = Some(crate::model::Ground {
            friction: 0.7,
            ..Default::default()
        });
        // Sunk in by a few millimetres with its lowest parts, more or less.
        model.roots[0].position.z = 0.1;
        let (model, mut s) = start(model, &mut random);
        let [forces, _] = imbalance(&model, &mut s);
        assert!(forces < 1e-9, "seed {seed}: {forces:e}");
        let free = free_load(&model, &mut s);
        assert!(free < 1e-9, "seed {seed}: {free:e}");
        let links = (0..model.links.len()).map(LinkId::from);
        let mut push = |link| s.output(OutputSlot::ContactForce(link, 2));
        pressed += usize::from(links.map(&mut push).any(|force| force > 1.0));
    }
    assert!(pressed > 20, "{pressed}");
}
