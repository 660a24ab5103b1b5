//! Samples, errors, encoders. Expected values: free fall, statistics, arithmetic.

#![expect(clippy::float_cmp, reason = "exact numbers are expected")]

use crate::assemble::testing::{at, body, error, frame, mass, model, robot};
use crate::model::JointKind::{Continuous, Fixed, Prismatic};
use crate::model::{JointId, Model, SensorId};
use crate::simulation::{OutputSlot, Sensed, Simulation};
use crate::spatial::Pose;
use std::sync::Arc;

const G: f64 = 9.81;

fn start(model: Model) -> Simulation {
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.initialize(0.0).expect("a legal start");
    simulation
}

/// Something that falls from 100 m and measures its height.
fn falling(sensor: &str) -> Model {
    let settings = format!(
        "initial.xyz = [0, 0, 100]\nsolver.tolerance = 1e-9\n[[sensor]]\ntype = \"ray\"\nlink = \"box\"\nrange = 1e3\n\
         rpy = [0, {}, 0]\n{sensor}",
        std::f64::consts::FRAC_PI_2
    );
    model(&robot(body("box", 1.0)), &settings)
}

fn height(s: &mut Simulation) -> f64 {
    s.output(OutputSlot::Sensor(SensorId(0), Sensed::Distance(0)))
}

/// 50 samples a second at communication points of 1/240 s, 1/50 s and 1/7 s: what is held is the
/// height at the first communication point at or after the last sample's time.
#[test]
fn a_sensor_takes_one_sample_at_each_of_its_times() {
    for step in [1.0 / 240.0, 0.02, 1.0 / 7.0] {
        let mut s = start(falling("rate = 50\n"));
        let (mut taken, mut held) = (0, 100.0);
        assert!((height(&mut s) - 100.0).abs() < 1e-12);
        for i in 1..=100 {
            let time = f64::from(i) * step;
            s.advance_to(time).expect("finite");
            #[expect(clippy::cast_possible_truncation, reason = "some hundreds")]
            let due = (time * 50.0 + 1e-6).floor() as i32;
            if due > taken {
                (taken, held) = (due, 100.0 - 0.5 * G * time * time);
            }
            let found = height(&mut s);
            if held > 0.0 {
                assert!((found - held).abs() < 1e-9, "{step}, {i}: {found} {held}");
            }
        }
        assert!(taken >= 20, "{taken}");
    }
}

/// A step that is taken in parts, as an importer's callback makes them, has one communication
/// point: its end, wherever that turns out to be.
#[test]
fn a_sensor_takes_no_sample_within_a_communication_step() {
    let fallen = |time: f64| 100.0 - 0.5 * G * time * time;
    let mut s = start(falling("rate = 50\n"));
    for (part, whole) in [(0.01, 0.025), (0.02, 0.025), (0.024, 0.025)] {
        s.advance_part(part, whole).expect("finite");
        assert!((height(&mut s) - 100.0).abs() < 1e-12, "{part}");
    }
    s.advance_part(0.025, 0.025).expect("finite");
    assert!((height(&mut s) - fallen(0.025)).abs() < 1e-9);
    s.advance_part(0.045, 0.05).expect("finite");
    assert!((height(&mut s) - fallen(0.025)).abs() < 1e-9);
    s.sample();
    assert!((height(&mut s) - fallen(0.045)).abs() < 1e-9);
}

/// Near a Unix time numbers are 0.24 µs apart, which is 24 millionths of the time between samples.
#[test]
fn a_sensor_takes_all_its_samples_far_from_the_time_zero() {
    const START: f64 = 1.7e9;
    let mut s = Simulation::new(Arc::new(falling("rate = 100\n")));
    s.initialize(START).expect("a legal start");
    let mut heights = vec![height(&mut s)];
    for i in 1..=200 {
        s.advance_to(START + f64::from(i) * 0.01).expect("finite");
        heights.push(height(&mut s));
    }
    heights.dedup();
    assert_eq!(heights.len(), 201);
}

#[test]
fn before_the_start_a_sensor_with_a_rate_follows_the_parameters() {
    use crate::model::RootId;
    use crate::simulation::ParameterSlot;
    let mut s = Simulation::new(Arc::new(falling("rate = 50\ndistance = { bias = 0.5 }\n")));
    assert!((height(&mut s) - 100.5).abs() < 1e-12);
    let slot = ParameterSlot::InitialBasePosition(RootId::ROBOT, 2);
    s.set_parameter(slot, 70.0);
    assert!((height(&mut s) - 70.5).abs() < 1e-12);
    s.initialize(0.0).expect("a legal start");
    assert!((height(&mut s) - 70.5).abs() < 1e-12);
}

/// An inertial unit at rest with bias and noise in every channel.
const NOISY: &str = "robot.base = \"fixed\"\n[[sensor]]\ntype = \"imu\"\nlink = \"box\"\nrate = 400\nseed = 3\n\
     angular_velocity = { bias = [0.1, 0.2, 0.3], noise_density = [1e-3, 2e-3, 4e-3] }\n\
     linear_acceleration = { bias = [0, 0, -0.5], noise = [0.5, 0, 0.25] }\n";

fn read(s: &mut Simulation) -> [f64; 6] {
    std::array::from_fn(|i| {
        let axis = u8::try_from(i % 3).expect("three");
        s.output(if i < 3 {
            OutputSlot::Sensor(SensorId(0), Sensed::AngularVelocity(axis))
        } else {
            OutputSlot::Sensor(SensorId(0), Sensed::Acceleration(axis))
        })
    })
}

/// Of `n` samples the mean has a standard deviation of `σ/√n` and the variance one of `σ² √(2/n)`:
/// both stay within four of them. A density of `d` at 400 samples a second is `20 d`.
#[test]
fn readings_have_the_bias_and_the_noise_that_are_asked_for() {
    const SAMPLES: u32 = 10_000;
    let n = f64::from(SAMPLES);
    let mut s = start(model(&robot(mass("box", 1.0)), NOISY));
    let (mut sum, mut square) = ([0.0; 6], [0.0; 6]);
    for i in 1..=SAMPLES {
        let ideal = [0.1, 0.2, 0.3, 0.0, 0.0, G - 0.5];
        for (k, found) in read(&mut s).into_iter().enumerate() {
            let error = found - ideal[k];
            sum[k] += error;
            square[k] += error * error;
        }
        s.advance_to(f64::from(i) / 400.0).expect("finite");
    }
    for (k, sigma) in [0.02, 0.04, 0.08, 0.5, 0.0, 0.25].into_iter().enumerate() {
        let (mean, variance) = (sum[k] / n, square[k] / n);
        assert!(mean.abs() <= 4.0 * sigma / n.sqrt() + 1e-12, "{k}: {mean}");
        let slack = 4.0 * sigma * sigma * (2.0 / n).sqrt() + 1e-20;
        assert!((variance - sigma * sigma).abs() <= slack, "{k}: {variance}");
    }
}

#[test]
fn noise_goes_on_with_the_same_bits_from_a_saved_state() {
    let model = model(&robot(mass("box", 1.0)), NOISY);
    let mut s = start(model.clone());
    s.advance_to(0.1234).expect("finite");
    let bytes = s.save().to_bytes();
    let mut other = Simulation::new(Arc::new(model));
    let snapshot = other.saved_from_bytes(&bytes).expect("its own state");
    other.restore(&snapshot).expect("its own state");
    let mut last = read(&mut s);
    let mut changes = 0;
    for i in 0..200 {
        let (a, b) = (read(&mut s), read(&mut other));
        assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits), "{i}");
        changes += usize::from(a != last);
        last = a;
        let time = 0.1234 + 0.003 * f64::from(i + 1);
        s.advance_to(time).expect("finite");
        other.advance_to(time).expect("finite");
    }
    assert!(changes > 150, "{changes}");
    // Back to where it was, in the same simulation.
    s.restore(&snapshot).expect("its own state");
    let mut third = Simulation::new(s.model().clone().into());
    third.restore(&snapshot).expect("its own state");
    assert_eq!(
        read(&mut s).map(f64::to_bits),
        read(&mut third).map(f64::to_bits)
    );
}

#[test]
fn noise_differs_between_seeds_and_between_sensors_but_not_between_runs() {
    let two = NOISY.replace("robot.base = \"fixed\"\n", "");
    let settings = |first: &str, seed: &str| {
        let one = two.replace("seed = 3\n", seed);
        format!("robot.base = \"fixed\"\n{first}{one}")
    };
    let of = |settings: &str, sensor: u32| {
        let mut s = start(model(&robot(mass("box", 1.0)), settings));
        s.advance_to(0.1).expect("finite");
        s.output(OutputSlot::Sensor(
            SensorId(sensor),
            Sensed::Acceleration(0),
        ))
    };
    let plain = of(&settings("", "seed = 3\n"), 0);
    assert_eq!(
        plain.to_bits(),
        of(&settings("", "seed = 3\n"), 0).to_bits()
    );
    assert_ne!(
        plain.to_bits(),
        of(&settings("", "seed = 4\n"), 0).to_bits()
    );
    // A sensor before it changes nothing, and one of the same seed has other noise.
    let before = two.replace("type = \"imu\"", "type = \"imu\"\nname = \"other\"");
    let both = settings(&before, "seed = 3\n");
    assert_eq!(plain.to_bits(), of(&both, 1).to_bits());
    assert_ne!(plain.to_bits(), of(&both, 0).to_bits());
}

#[test]
fn rays_err_only_where_something_is_hit_and_stay_in_their_range() {
    let looking = |more: &str| {
        let settings = format!(
            "robot.base = \"fixed\"\ninitial.xyz = [0, 0, 2]\n[[sensor]]\ntype = \"ray\"\nlink = \"box\"\nrays = 2\n\
             fov = {}\n{more}",
            std::f64::consts::PI
        );
        model(&robot(body("box", 1.0)), &settings)
    };
    // Up and down, which a roll makes of right and left.
    let turned = "rpy = [-1.5707963267948966, 0, 0]\n";
    let of = |more: &str| {
        let mut s = start(looking(&format!("{turned}{more}")));
        [0, 1].map(|ray| s.output(OutputSlot::Sensor(SensorId(0), Sensed::Distance(ray))))
    };
    let [up, down] = of("distance = { bias = 0.25 }\n");
    assert!(up == 10.0 && (down - 2.25).abs() < 1e-12, "{up} {down}");
    assert_eq!(of("distance = { bias = 100 }\n"), [10.0, 10.0]);
    let [_, down] = of("min_range = 0.5\ndistance = { bias = -1.75 }\n");
    assert_eq!(down, 0.5);
}

/// A wheel that turns with 2 rad/s and a slide that moves with 0.3 m/s, without anything that
/// brakes them.
fn moving(sensors: &str) -> Simulation {
    let robot = robot(frame("world"))
        .with(
            "world",
            "wheel",
            Continuous,
            at(0.0, 0.0, 1.0),
            mass("rim", 1.0),
        )
        .with(
            "world",
            "slide",
            Prismatic,
            at(0.0, 1.0, 1.0),
            mass("cart", 1.0),
        )
        .with("world", "weld", Fixed, Pose::IDENTITY, mass("post", 1.0));
    let settings = format!(
        "world.gravity = [0, 0, 0]\ninitial.joint_velocities = {{ wheel = 2, slide = 0.3 }}\n\
         [[actuator]]\njoint = \"*\"\nmode = \"none\"\n{sensors}"
    );
    start(model(&robot, &settings))
}

#[test]
fn an_encoder_counts_in_steps_of_a_turn_or_a_metre() {
    let mut s = moving(
        "[[sensor]]\ntype = \"encoder\"\njoint = \"wheel\"\ncounts = 100\n\
         [[sensor]]\ntype = \"encoder\"\njoint = \"slide\"\ncounts = 1000\n",
    );
    for i in 1..=50 {
        s.advance_to(0.037 * f64::from(i)).expect("finite");
        for (sensor, step) in [(0, std::f64::consts::TAU / 100.0), (1, 1e-3)] {
            let joint = JointId::from(usize::try_from(sensor).expect("few"));
            let exact = s.output(OutputSlot::JointPosition(joint, 0));
            let found = s.output(OutputSlot::Sensor(SensorId(sensor), Sensed::Position));
            assert!(
                (found - exact).abs() <= 0.5 * step + 1e-12,
                "{found} {exact}"
            );
            let counts = found / step;
            assert!((counts - counts.round()).abs() < 1e-9, "{counts}");
        }
    }
}

/// 2 rad/s at 100 samples a second are 3.18 steps of 1/1000 of a turn: three or four each time, so
/// the velocity is 3 or 4 times 0.628 rad/s, and 2 rad/s in the mean.
#[test]
fn the_velocity_of_an_encoder_comes_from_its_last_two_samples() {
    let mut s =
        moving("[[sensor]]\ntype = \"encoder\"\njoint = \"wheel\"\ncounts = 1000\nrate = 100\n");
    let velocity = |s: &mut Simulation| s.output(OutputSlot::Sensor(SensorId(0), Sensed::Velocity));
    assert_eq!(velocity(&mut s), 0.0);
    let unit = std::f64::consts::TAU / 1000.0 * 100.0;
    let mut sum = 0.0;
    for i in 1..=500 {
        s.advance_to(0.01 * f64::from(i)).expect("finite");
        let found = velocity(&mut s);
        let steps = found / unit;
        assert!(
            (steps - 3.0).abs() < 1e-6 || (steps - 4.0).abs() < 1e-6,
            "{i}: {steps}"
        );
        sum += found / 500.0;
    }
    assert!((sum - 2.0).abs() < 2.0 * unit / 500.0, "{sum}");
    // Without a rate there is none.
    let table = |text: &str| crate::variables::table(moving(text).model()).expect("no clash");
    let plain = table("[[sensor]]\ntype = \"encoder\"\njoint = \"wheel\"\ncounts = 1000\n");
    assert!(crate::variables::find(&plain, "sensor.wheel.position").is_some());
    assert!(crate::variables::find(&plain, "sensor.wheel.velocity").is_none());
}

#[test]
fn an_encoder_in_a_weld_and_a_contact_sensor_without_a_shape_are_errors() {
    let arm =
        robot(mass("base", 1.0)).with("base", "weld", Fixed, Pose::IDENTITY, mass("tip", 1.0));
    for text in [
        "[[sensor]]\ntype = \"encoder\"\ncounts = 100\njoint = \"weld\"\n",
        "[[sensor]]\ntype = \"contact\"\nsize = [1, 1, 1]\nlink = \"tip\"\n",
    ] {
        let found = error(&arm, text);
        assert_eq!(
            (found.code, found.place.map(|p| p.line)),
            ("A102", Some(4)),
            "{text}"
        );
    }
}

/// Sensors only look: the motion has the same bits with them.
#[test]
fn sensors_do_not_change_the_motion() {
    let run = |sensors: &str| {
        let settings = format!("initial.linear_velocity = [1, 0, 0]\n{sensors}");
        let mut s = start(model(&robot(body("box", 1.0)), &settings));
        for i in 1..=100 {
            s.advance_to(0.013 * f64::from(i)).expect("finite");
            let slots = crate::variables::table(s.model()).expect("no clash");
            for row in slots {
                if let crate::variables::Slot::Output(slot) = row.slot {
                    assert!(s.output(slot).is_finite(), "{}", row.name);
                }
            }
        }
        s.state().physical.clone()
    };
    let all = "[[sensor]]\ntype = \"imu\"\nlink = \"box\"\nrate = 70\nangular_velocity.noise = [1, 1, 1]\n\
               [[sensor]]\ntype = \"ray\"\nname = \"eye\"\nlink = \"box\"\nrate = 30\nrays = 5\nfov = 3\nhits = true\n\
               [[sensor]]\ntype = \"contact\"\nname = \"skin\"\nlink = \"box\"\nrate = 50\n";
    assert_eq!(run(""), run(all));
}

#[test]
fn what_a_sensor_holds_changes_in_steps() {
    let plain = "[[sensor]]\ntype = \"imu\"\nlink = \"box\"\n";
    for (settings, stepped) in [
        (plain.to_owned(), false),
        (format!("{plain}rate = 50\n"), true),
    ] {
        let model = model(&robot(body("box", 1.0)), &settings);
        for row in crate::variables::table(&model).expect("no clash") {
            let expected = stepped && row.name.starts_with("sensor.");
            assert_eq!(row.stepped, expected, "{}", row.name);
        }
    }
}
