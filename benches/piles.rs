//! Random worlds: piles of bodies that fall on each other, unmodified and with one property at an
//! extreme value; bodies that are thrown at walls and thin plates.
//!
//! `cargo bench -p urdf2fmu-core --bench piles -- [worlds per class] [WORD]` prints the table of
//! `docs/robustness.md`, of the classes whose name holds the word, and lists the worst worlds. With
//! a second number only the world of that seed is run. Every fourth world takes fixed steps of
//! 1/240 s. `tests/acceptance/campaign.rs` has the ledger of energy.

#![expect(clippy::print_stdout, reason = "the tables are the result")]
#![expect(clippy::cast_precision_loss, reason = "counts")]

#[path = "../tests/acceptance/campaign.rs"]
#[allow(missing_docs, dead_code, reason = "shared with the tests")]
mod campaign;
#[path = "support/ground.rs"]
#[allow(dead_code, reason = "shared with other benches")]
mod ground;
#[path = "../src/testing/random.rs"]
mod random;

use campaign::Ledger;
use random::Random;
use std::sync::Arc;
use urdf2fmu_core::assemble::{self, Guest};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::{InitialSettings, Settings};
use urdf2fmu_core::simulation::{ParameterSlot, Simulation};
use urdf2fmu_core::spatial::Vec3;

/// Communication step, s, and number of them in a world.
const H: f64 = 1.0 / 240.0;
const STEPS: u32 = 720;

/// What is unusual about a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    Pile,
    Balls,
    Boxes,
    Cylinders,
    Hulls,
    MassRatio,
    Deep,
    Sizes,
    SameSizes,
    Bouncing,
    Slippery,
    Sticky,
    Soft,
    Spinning,
    Wall,
    Plate,
    FreePlate,
    NoGravity,
}

impl Class {
    const ALL: [Self; 18] = [
        Self::Pile,
        Self::Balls,
        Self::Boxes,
        Self::Cylinders,
        Self::Hulls,
        Self::MassRatio,
        Self::Deep,
        Self::Sizes,
        Self::SameSizes,
        Self::Bouncing,
        Self::Slippery,
        Self::Sticky,
        Self::Soft,
        Self::Spinning,
        Self::Wall,
        Self::Plate,
        Self::FreePlate,
        Self::NoGravity,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Pile => "pile of 5 to 20 bodies of all shapes",
            Self::Balls => "pile of balls and capsules",
            Self::Boxes => "pile of boxes",
            Self::Cylinders => "pile of cylinders",
            Self::Hulls => "pile of hulls",
            Self::MassRatio => "pile, masses times 1e-3 … 1e3",
            Self::Deep => "pile, bodies begin inside each other and the ground",
            Self::Sizes => "pile, sizes from 1 cm to 1 m",
            Self::SameSizes => "pile, all sizes times 1e-2 … 1e2",
            Self::Bouncing => "pile, restitution 1",
            Self::Slippery => "pile, friction 0",
            Self::Sticky => "pile, friction 1e6",
            Self::Soft => "pile, penetration 5 mm",
            Self::Spinning => "pile, bodies spin at 1,000 rad/s",
            Self::Wall => "body at 1,000 rad/s and 10 m/s against a wall",
            Self::Plate => "ball of 1 cm at 100 m/s against a plate of 1 mm",
            Self::FreePlate => "the same, the plate free",
            Self::NoGravity => "bodies thrown at each other without gravity",
        }
    }

    /// Those of the world and its first body, and the friction and restitution of all bodies.
    fn settings(self, random: &mut Random) -> (Settings, [f64; 2]) {
        let friction = match self {
            Self::Slippery => 0.0,
            Self::Sticky => 1e6,
            _ => random.uniform(0.1, 1.2),
        };
        let restitution = match self {
            Self::Bouncing => 1.0,
            _ if random.below(3) == 0 => random.uniform(0.0, 0.9),
            _ => 0.0,
        };
        let world = match self {
            Self::Wall | Self::Plate | Self::FreePlate | Self::NoGravity => {
                "world.ground.type = \"none\"\nworld.gravity = [0, 0, 0]".to_owned()
            }
            _ => format!("world.ground.friction = {friction}"),
        };
        let surface = format!("friction = {friction}, restitution = {restitution}");
        let mut text = format!("{world}\nlink.\"*\" = {{ {surface} }}\n");
        if self == Self::Soft {
            text += "contact.penetration = 5e-3\n";
        }
        let settings = Settings::parse(&text, "piles.toml");
        let settings = settings.unwrap_or_else(|e| panic!("{text}: {e:?}"));
        (settings, [friction, restitution])
    }
}

/// A random shape of about this size, m.
fn shape(class: Class, random: &mut Random, size: f64) -> Shape {
    let mut extent = || size * random.uniform(0.5, 1.5);
    let [a, b, c] = [extent(), extent(), extent()];
    let kind = match class {
        Class::Balls => [0, 3][random.below(2)],
        Class::Boxes => 1,
        Class::Cylinders => 2,
        Class::Hulls => 4,
        _ => random.below(5),
    };
    match kind {
        0 => Shape::Sphere { radius: a },
        1 => Shape::Box {
            half: Vec3::new(a, b, c),
        },
        2 => Shape::Cylinder {
            radius: a,
            half_length: b,
        },
        3 => Shape::Capsule {
            radius: a,
            half_length: b,
        },
        _ => {
            let vertex = |_| {
                let mut along = Vec3::zeros();
                while along.norm() < 0.1 {
                    along = Vec3::from_fn(|_, _| random.uniform(-1.0, 1.0));
                }
                along.normalize().component_mul(&Vec3::new(a, b, c))
            };
            let vertices: Vec<Vec3> = (0..24).map(vertex).collect();
            Shape::Hull { vertices }
        }
    }
}

/// About that of water, kg.
fn mass(shape: &Shape) -> f64 {
    4e3 * shape.bounding_radius().powi(3)
}

/// A body of the world: kg (0: it stands still), m, rad, m/s, rad/s.
struct Body {
    shape: Shape,
    mass: f64,
    at: Vec3,
    turn: Vec3,
    speed: Vec3,
    spin: Vec3,
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let along = Vec3::from_fn(|_, _| random.uniform(-1.0, 1.0));
        if (0.1..1.0).contains(&along.norm()) {
            return along.normalize();
        }
    }
}

fn bodies(class: Class, random: &mut Random) -> Vec<Body> {
    let turn = |random: &mut Random| Vec3::from_fn(|_, _| random.uniform(-3.0, 3.0));
    match class {
        Class::Wall | Class::Plate | Class::FreePlate => {
            let ball = class != Class::Wall;
            let shape = if ball {
                Shape::Sphere { radius: 5e-3 }
            } else {
                shape(class, random, 0.05)
            };
            let spin = if ball { 100.0 } else { 1000.0 };
            let speed = if ball { 100.0 } else { 10.0 };
            let mut aim = direction(random);
            aim.x = aim.x.abs().max(0.3);
            let aim = aim.normalize();
            let mut list = vec![Body {
                mass: mass(&shape),
                at: -aim * random.uniform(0.2, 0.4),
                turn: turn(random),
                speed: aim * speed,
                spin: direction(random) * spin,
                shape,
            }];
            let thickness = if ball { 5e-4 } else { 0.05 };
            list.push(Body {
                shape: Shape::Box {
                    half: Vec3::new(thickness, 0.5, 0.5),
                },
                mass: if class == Class::FreePlate {
                    random.uniform(0.05, 5.0)
                } else {
                    0.0
                },
                at: Vec3::zeros(),
                turn: Vec3::zeros(),
                speed: Vec3::zeros(),
                spin: Vec3::zeros(),
            });
            list
        }
        _ => {
            let count = 5 + random.below(16);
            let scale = match class {
                Class::SameSizes => libm::pow(10.0, random.uniform(-2.0, 2.0)),
                _ => 1.0,
            };
            let (mut list, mut height) = (Vec::new(), 0.0);
            for _ in 0..count {
                let size = match class {
                    Class::Sizes => libm::pow(10.0, random.uniform(-2.0, 0.0)),
                    _ => 0.1 * scale,
                };
                let shape = shape(class, random, size);
                let mut own = mass(&shape);
                if class == Class::MassRatio {
                    own *= libm::pow(10.0, random.uniform(-3.0, 3.0));
                }
                let reach = shape.bounding_radius();
                let across = 0.15 * scale;
                let mut at = Vec3::new(
                    random.uniform(-across, across),
                    random.uniform(-across, across),
                    height + reach + 0.01 * scale,
                );
                match class {
                    Class::Deep => {
                        at = Vec3::from_fn(|_, _| random.uniform(-0.2, 0.2));
                    }
                    Class::NoGravity => {
                        at = direction(random) * (0.4 + 0.6 * list.len() as f64);
                    }
                    _ => height += 2.0 * reach + 0.01 * scale,
                }
                let spin = if class == Class::Spinning {
                    1000.0
                } else {
                    3.0
                };
                let speed = if class == Class::NoGravity {
                    -at.normalize() * random.uniform(1.0, 5.0)
                } else {
                    Vec3::from_fn(|_, _| random.uniform(-0.3, 0.3)) * scale.sqrt()
                };
                list.push(Body {
                    shape,
                    mass: own,
                    at,
                    turn: turn(random),
                    speed,
                    spin: direction(random) * random.uniform(0.0, spin),
                });
            }
            list
        }
    }
}

fn place(body: &Body, initial: &mut InitialSettings) {
    initial.xy = [body.at.x, body.at.y];
    initial.z = Some(body.at.z);
    initial.rpy = body.turn;
    initial.linear_velocity = body.speed;
    initial.angular_velocity = body.spin;
}

fn world(class: Class, random: &mut Random) -> Model {
    let (mut settings, surface) = class.settings(random);
    let list = bodies(class, random);
    let guest = |(i, body): (usize, &Body)| {
        let mut initial = settings.initial.clone();
        place(body, &mut initial);
        let name = format!("body{}", i + 1);
        let solid = (&body.shape, body.mass);
        ground::object(&name, solid, initial, surface.map(Some), &settings)
    };
    let guests: Vec<Guest> = list[1..].iter().enumerate().map(guest).collect();
    place(&list[0], &mut settings.initial);
    let robot = assemble::solid("body0", &list[0].shape, list[0].mass);
    match assemble::world(&robot, &settings, &guests) {
        Ok(world) => world.model,
        Err(findings) => panic!("{}", findings[0].message),
    }
}

/// What came of the worlds of a class.
#[derive(Default)]
struct Tally {
    worlds: u32,
    failed: Vec<(u64, String)>,
    through: Vec<u64>,
    /// Worst gains under error control and in fixed steps: in all, over the lowest before.
    gained: [[(f64, u64); 2]; 2],
    /// Steps, and steps accepted at the floor.
    steps: [u64; 2],
    seconds: f64,
    /// s, and its seed.
    slowest: (f64, u64),
    /// What each world has gained in all, and its seed.
    each: Vec<(f64, u64)>,
}

fn run(class: Class, seed: u64, tally: &mut Tally) {
    tally.worlds += 1;
    let mut random = Random(seed.wrapping_mul(7919) + 17);
    let fixed = seed % 4 == 3;
    let mut s = Simulation::new(Arc::new(world(class, &mut random)));
    if fixed {
        s.set_parameter(ParameterSlot::StepSize, H);
    }
    if let Err(error) = s.initialize(0.0) {
        tally.failed.push((seed, error.to_string()));
        return;
    }
    let start = s.state().physical.q.clone();
    let mut ledger = Ledger::new(&mut s);
    let mut seconds = 0.0;
    for k in 1..=STEPS {
        let begin = std::time::Instant::now();
        let end = s.advance_to(f64::from(k) * H);
        seconds += begin.elapsed().as_secs_f64();
        if let Err(error) = end {
            tally.failed.push((seed, error.to_string()));
            break;
        }
        if !s.state().is_finite() {
            tally.failed.push((seed, "not finite".into()));
            break;
        }
        ledger.add(&mut s);
    }
    let q = &s.state().physical.q;
    let through = match class {
        Class::Wall | Class::Plate => q[0] > 0.0,
        Class::FreePlate => q[0] - q[7] > 0.0,
        Class::NoGravity => false,
        // A centre below the ground that was above it.
        _ => (0..s.model().roots.len()).any(|i| q[7 * i + 2] < 0.0 && start[7 * i + 2] > 0.0),
    };
    if through {
        tally.through.push(seed);
    }
    let counters = s.state().stepping.counters;
    tally.steps[0] += counters.steps;
    tally.steps[1] += counters.forced;
    tally.seconds += seconds;
    if seconds > tally.slowest.0 {
        tally.slowest = (seconds, seed);
    }
    tally.each.push((ledger.gained, seed));
    let worst = &mut tally.gained[usize::from(fixed)];
    for (worst, share) in worst.iter_mut().zip([ledger.gained, ledger.risen]) {
        if share > worst.0 || share.is_nan() {
            *worst = (share, seed);
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let numbers: Vec<u64> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let word = arguments.iter().find(|a| a.parse::<u64>().is_err());
    let count = numbers.first().copied().unwrap_or(20);
    let one = numbers.get(1).copied();
    println!(
        "| worlds | number | failed | through | gained in all: error control, fixed | \
         over the lowest before | steps per 1/240 s | at the floor | µs per 1/240 s | slowest, s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut notes = Vec::new();
    for class in Class::ALL {
        if word.is_some_and(|word| !class.name().contains(word.as_str())) {
            continue;
        }
        let mut t = Tally::default();
        for seed in one.map_or(0..count, |seed| seed..seed + 1) {
            run(class, seed, &mut t);
        }
        let total = f64::from(t.worlds) * f64::from(STEPS);
        let [[a, b], [c, d]] = t.gained;
        println!(
            "| {} | {} | {} | {} | {:.1e}, {:.1e} | {:.1e}, {:.1e} | {:.1} | {:.1e} | {:.0} | \
             {:.1} |",
            class.name(),
            t.worlds,
            t.failed.len(),
            t.through.len(),
            a.0,
            c.0,
            b.0,
            d.0,
            t.steps[0] as f64 / total,
            t.steps[1] as f64 / (t.steps[0].max(1)) as f64,
            1e6 * t.seconds / total,
            t.slowest.0,
        );
        t.each.sort_by(|a, b| b.0.total_cmp(&a.0));
        let over = |limit: f64| t.each.iter().filter(|world| world.0 > limit).count();
        let worst: Vec<String> = t
            .each
            .iter()
            .take(8)
            .map(|(g, s)| format!("{s} {g:.1e}"))
            .collect();
        notes.push(format!(
            "{}: over 1e-6 {}, 1e-5 {}, 1e-4 {}, 1e-3 {}, 1e-2 {}; worst (seed, gain) {}; \
             gained by {}, {}; risen by {}, {}; slowest {}; failed {:?}; through {:?}",
            class.name(),
            over(1e-6),
            over(1e-5),
            over(1e-4),
            over(1e-3),
            over(1e-2),
            worst.join(", "),
            a.1,
            c.1,
            b.1,
            d.1,
            t.slowest.1,
            t.failed,
            t.through
        ));
    }
    println!();
    for note in notes {
        println!("- {note}");
    }
}
