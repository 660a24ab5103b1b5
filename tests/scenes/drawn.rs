//! Members of the classes of scenes that chance has chosen, and nobody else.

use super::press::Placed;
use super::springs::{Servo, limited_row, spring};
use super::textbook::{rolling, tops};
use super::{Scene, press, rim, spin};
use crate::testing::Random;

/// A number between two powers of ten.
fn power(random: &mut Random, low: f64, high: f64) -> f64 {
    libm::pow(10.0, random.uniform(low, high))
}

fn servo(random: &mut Random) -> Scene {
    let (moment, jump) = (power(random, -4.0, 0.0), random.uniform(0.01, 2.0));
    let omega = power(random, 0.7, 2.3);
    let kp = moment * omega * omega;
    Servo {
        moment,
        kp,
        kd: 2.0 * random.uniform(0.05, 1.5) * moment * omega,
        most: kp * jump * power(random, -2.0, 0.3),
        jump,
    }
    .scene()
}

fn row(random: &mut Random) -> Scene {
    let masses: [f64; 3] = [(); 3].map(|()| power(random, -1.0, 1.0));
    let gains = masses.map(|mass| {
        let omega = power(random, 0.5, 1.6);
        [
            mass * omega * omega,
            mass * omega * random.uniform(0.1, 1.0),
        ]
    });
    let start = [(); 3].map(|()| random.uniform(-0.2, 0.2));
    let most = gains.map(|[kp, _]| kp * power(random, -2.0, -0.7));
    limited_row(masses, gains, most, start)
}

fn can(random: &mut Random) -> Scene {
    let tall = random.uniform(0.3, 2.5);
    let most = 0.6 * libm::atan(1.0 / tall).to_degrees();
    rim::can(power(random, -2.0, -0.5), tall, random.uniform(1.0, most))
}

fn disc(random: &mut Random) -> Scene {
    let radius: f64 = power(random, -1.5, -0.3);
    // Above √(g R/3), so that it does not fall over.
    let speed = (9.81 * radius / 3.0).sqrt() * random.uniform(1.5, 4.0);
    let wobble = if random.uniform(0.0, 1.0) < 0.5 {
        0.0
    } else {
        0.05
    };
    rim::disc_of(radius, random.uniform(8.0, 35.0), speed, wobble)
}

fn release(random: &mut Random) -> Scene {
    let steep = 1.0 + power(random, -2.0, 0.0);
    press::release_of(random.uniform(0.1, 1.2), steep, Placed::Assembled)
}

fn bounce(random: &mut Random) -> Scene {
    let (mass, radius) = (power(random, -3.0, 1.5), power(random, -2.0, -0.7));
    press::bounce_of(
        mass,
        radius,
        power(random, -1.3, 0.7),
        random.uniform(0.1, 1.0),
    )
}

fn swinging(random: &mut Random) -> Scene {
    let (mass, f) = (power(random, -3.0, 3.0), power(random, -0.5, 1.0));
    let zeta = [0.0, power(random, -2.3, -1.0)];
    spring(mass, f, zeta[usize::from(random.uniform(0.0, 1.0) < 0.5)])
}

fn tumble(random: &mut Random) -> Scene {
    spin::tumble(random.vector(8.0).into(), false)
}

fn pressed(random: &mut Random) -> Scene {
    press::pressed(power(random, -3.0, 3.0), power(random, 0.0, 6.0))
}

/// A class and how chance chooses its members.
type Class = (&'static str, fn(&mut Random) -> Scene);

const CLASSES: [Class; 11] = [
    ("springs", swinging),
    ("servos with limits", servo),
    ("rows of servos with limits", row),
    ("tumbling boxes", tumble),
    ("heavy bodies on a point", tops::drawn),
    ("billiard shots", rolling::drawn),
    ("cans on their rim", can),
    ("rolling discs", disc),
    ("boxes released on slopes", release),
    ("bouncing balls", bounce),
    ("cubes under loads", pressed),
];

/// `count` members of each class, with its name.
pub fn classes(seed: u64, count: usize) -> Vec<(&'static str, Vec<Scene>)> {
    let classes = CLASSES.iter().zip(1..).map(|((name, draw), place)| {
        // Other classes do not change what this one draws.
        let mut random = Random(seed * 1000 + place);
        (*name, (0..count).map(|_| draw(&mut random)).collect())
    });
    classes.collect()
}
