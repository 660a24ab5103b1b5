//! Rays in worlds. Expected values: geometry; the same rays at every shape without a search.

#![expect(clippy::float_cmp, reason = "exact numbers are expected")]

use crate::assemble::testing::{at, body, collision, error, frame, mass, model, robot};
use crate::geometry::Shape;
use crate::geometry::ray::{Ray, Target};
use crate::model::JointKind::{Continuous, Fixed};
use crate::model::{Ground, LinkId, Model, RootKind, Sampling, Sensor, SensorId, SensorKind};
use crate::simulation::{OutputSlot, Sensed, Simulation};
use crate::spatial::{Pose, Vec3, rotation_from_quaternion};
use crate::testing::{Random, random_tree, shape_all_links};
use crate::urdf::LinkDescription;
use std::sync::Arc;

fn start(model: Model) -> Simulation {
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.initialize(0.0).expect("a legal start");
    simulation
}

/// Distance and hit of a ray of sensor 0.
fn reading(s: &mut Simulation, ray: u32) -> (f64, f64) {
    (
        s.output(OutputSlot::Sensor(SensorId(0), Sensed::Distance(ray))),
        s.output(OutputSlot::Sensor(SensorId(0), Sensed::Hit(ray))),
    )
}

/// A cube of 1 m.
fn cube(name: &str) -> LinkDescription {
    let shape = Shape::Box {
        half: Vec3::new(0.5, 0.5, 0.5),
    };
    LinkDescription {
        inertial: Some(shape.solid_inertia(1.0)),
        collisions: vec![collision(Pose::IDENTITY, shape)],
        ..frame(name)
    }
}

/// A robot at the world's origin that looks along x from 1 m height, with more settings.
fn looker(settings: &str) -> Model {
    let eye = robot(body("eye", 1.0));
    let settings = format!(
        "robot.base = \"fixed\"\ninitial.xyz = [0, 0, 1]\n[[sensor]]\ntype = \"ray\"\nlink = \"eye\"\nhits = true\n{settings}"
    );
    model(&eye, &settings)
}

fn join(model: &mut Model, name: &str, x: f64) {
    let settings = format!("robot.base = \"fixed\"\ninitial.xyz = [{x}, 0, 0.5]\n");
    let thing = crate::assemble::testing::model(&robot(cube(name)), &settings);
    model.join(thing, name, RootKind::Object);
}

#[test]
fn a_ray_tells_the_nearest_thing_and_how_far_it_is() {
    let mut model = looker("range = 20\n");
    join(&mut model, "far", 5.0);
    join(&mut model, "near", 3.0);
    let mut s = start(model);
    // Link 0 is the sensor's own, 1 the far cube, 2 the near one.
    let (distance, hit) = reading(&mut s, 0);
    assert!(
        (distance - 2.5).abs() < 1e-15 && hit == 3.0,
        "{distance} {hit}"
    );
}

#[test]
fn a_ray_goes_through_its_own_body_and_what_it_ignores() {
    let housing = robot(cube("base"))
        .with("base", "mast", Fixed, at(0.0, 0.0, 0.0), cube("housing"))
        .with(
            "base",
            "shoulder",
            Continuous,
            at(2.0, 0.0, 0.0),
            cube("arm"),
        )
        .with("arm", "wrist", Continuous, at(2.0, 0.0, 0.0), cube("hand"));
    let read = |more: &str| {
        let settings = format!(
            "robot.base = \"fixed\"\ninitial.xyz = [0, 0, 5]\n[[sensor]]\ntype = \"ray\"\nlink = \"base\"\nhits = true\n{more}"
        );
        let mut s = start(model(&housing, &settings));
        reading(&mut s, 0)
    };
    assert_eq!(read(""), (1.5, 3.0));
    assert_eq!(read("ignore = [\"a*\"]\n"), (3.5, 4.0));
    assert_eq!(read("ignore = [\"arm\", \"hand\"]\n"), (10.0, 0.0));
}

#[test]
fn a_thing_before_the_least_range_is_not_seen() {
    let read = |settings: &str| {
        let mut model = looker(settings);
        join(&mut model, "near", 3.0);
        join(&mut model, "far", 6.0);
        reading(&mut start(model), 0)
    };
    // The near cube reaches from 2.5 m to 3.5 m.
    assert_eq!(read("min_range = 1\n"), (2.5, 2.0));
    assert_eq!(read("min_range = 3\n"), (3.0, 2.0));
    assert_eq!(read("min_range = 4\n"), (5.5, 3.0));
    assert_eq!(read("min_range = 4\nrange = 5\n"), (5.0, 0.0));
}

#[test]
fn rows_of_rays_go_from_below_right_to_above_left() {
    // The ground is 1 m below: a row that looks down by 45° meets it at √2 m.
    let settings = format!(
        "rays = 3\nfov = {}\nrows = 3\nvertical_fov = {}\n",
        std::f64::consts::FRAC_PI_2,
        std::f64::consts::FRAC_PI_2
    );
    let model = looker(&settings);
    let SensorKind::Ray { directions, .. } = &model.outputs.sensors[0].kind else {
        panic!("rays");
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert!((directions[0] - Vec3::new(0.5, -0.5, -half)).norm() < 1e-15);
    assert!((directions[8] - Vec3::new(0.5, 0.5, half)).norm() < 1e-15);
    let names: Vec<String> = crate::variables::table(&model)
        .expect("no clash")
        .into_iter()
        .map(|row| row.name)
        .filter(|name| name.starts_with("sensor."))
        .collect();
    assert_eq!(names[0], "sensor.eye.ray[1,1]");
    assert_eq!(names[5], "sensor.eye.ray[2,3]");
    assert_eq!(names[17], "sensor.eye.hit[3,3]");
    let mut s = start(model);
    for ray in 0..9 {
        let (distance, hit) = reading(&mut s, ray);
        let (expected, thing) = if ray < 3 {
            (2.0 * half, -1.0)
        } else {
            (10.0, 0.0)
        };
        assert!(
            (distance - expected).abs() < 1e-15 && hit == thing,
            "{ray}: {distance} {hit}"
        );
    }
}

/// The same rays at every shape, one by one, at the poses that the outputs say.
#[test]
fn the_search_finds_what_a_look_at_every_shape_finds() {
    let mut hits = 0;
    for seed in 0..20 {
        let mut random = Random(seed);
        let mut model = random_tree(&mut random, 12, true, false);
        shape_all_links(&mut model);
        for i in 0..4 {
            let mut other = random_tree(&mut random, 12, false, false);
            shape_all_links(&mut other);
            // Far from the origin digits would show.
            other.roots[0].position = random.vector(2.0) + Vec3::new(300.0, 0.0, 5.0);
            model.join(other, &format!("r{i}"), RootKind::Robot);
        }
        model.world.ground = Some(Ground::default());
        model.roots[0].position = Vec3::new(300.0, 0.0, 5.0);
        model.roots[0].rpy = random.vector(3.0);
        for position in &mut model.initial.joint_positions {
            *position = random.uniform(-1.0, 1.0);
        }
        let directions: Vec<Vec3> = (0..500).map(|_| random.unit()).collect();
        let X_LS = Pose::from_xyz_rpy(random.vector(0.3), random.vector(3.0));
        let (near, range) = (0.05, 6.0);
        model.outputs.links = (0..model.links.len()).map(LinkId::from).collect();
        model.outputs.sensors = vec![Sensor {
            name: "lidar".into(),
            link: LinkId(0),
            X_LS,
            kind: SensorKind::Ray {
                directions: directions.clone(),
                columns: 500,
                near,
                range,
                hits: true,
                ignored: vec![LinkId(3)],
            },
            sampling: Sampling::default(),
        }];
        let mut s = start(model.clone());
        let frames: Vec<Pose> = (0..model.links.len())
            .map(|l| {
                let id = LinkId::from(l);
                let q = [3, 0, 1, 2].map(|i| s.output(OutputSlot::LinkOrientation(id, i)));
                Pose {
                    R: rotation_from_quaternion(&q),
                    p: Vec3::from([0, 1, 2].map(|i| s.output(OutputSlot::LinkPosition(id, i)))),
                }
            })
            .collect();
        let X_WS = frames[0].compose(&X_LS);
        for (ray, along) in (0..).zip(&directions) {
            let along = X_WS.R * along;
            let (mut least, mut thing) = (range, 0.0);
            let fall = -along.z;
            if fall > 0.0 && X_WS.p.z / fall < least {
                (least, thing) = (X_WS.p.z / fall, -1.0);
            }
            for collider in &model.colliders {
                let link = collider.link.index();
                if link == 0 || link == 3 {
                    continue;
                }
                let X_WG = frames[link].compose(&collider.X_BG);
                let own = Ray {
                    origin: X_WG.R.transpose() * (X_WS.p - X_WG.p),
                    along: X_WG.R.transpose() * along,
                };
                if let Some(found) = Target::new(&collider.shape).first(&own, near)
                    && found < least
                {
                    (least, thing) = (found, f64::from(collider.link.0) + 1.0);
                }
            }
            let (distance, hit) = reading(&mut s, ray);
            // Positions of 300 m have 6e-14 m, and what grazes feels it more.
            assert!(
                (distance - least).abs() < 1e-10 && hit == thing,
                "seed {seed}, ray {ray}: {distance} {hit}, not {least} {thing}"
            );
            hits += usize::from(hit > 0.0);
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn rays_of_a_sensor_that_ignores_an_unknown_link_are_an_error() {
    let found = error(
        &robot(mass("eye", 1.0)),
        "[[sensor]]\ntype = \"ray\"\nlink = \"eye\"\nignore = [\"ey\"]\n",
    );
    assert_eq!((found.code, found.place.map(|p| p.line)), ("A101", Some(4)));
}
