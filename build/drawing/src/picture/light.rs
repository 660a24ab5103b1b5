//! How much light of a lamp and of the sky reaches each place.
//!
//! The sky is a number of lamps far away, spread evenly over the upper half. For each lamp the
//! depths of the robot seen from it are drawn once, and a place is lit by the lamp if nothing is
//! nearer to the lamp there. The sum over the sky gives soft shadows, in corners and on the ground,
//! without an approximation for them.

use super::aim::{Aim, Point, dot, place};
use super::camera::{Camera, count};
use super::cubes::{Cubes, Sorted};
use super::depth::Depth;
use super::look::Look;
use super::raster::Places;
use super::rows::{greatest, least};
use super::sky;
use super::solid::World;
use urdf2fmu_core::parallel;
use urdf2fmu_core::spatial::Vec3;

/// Where the lamp stands, seen from the camera: to the left of it, degrees. Behind the camera no
/// shadow would be seen.
const LAMP_AZIMUTH: f64 = -62.0;
/// Above the horizon, degrees.
const LAMP_ELEVATION: f64 = 58.0;

/// Side of the lamp's picture, and of one of a part of the sky.
const LAMP_SIDE: usize = 1024;
const SKY_SIDE: usize = 224;

/// Squares of the lamp's picture and of the sky's that have their nearest place, as powers of two
/// of pixels, and how many pixels beyond them are theirs, too: the soft edge of the lamp to both of
/// its sides, and the second of two pixels between which a place in the sky's picture lies.
const LAMP_TILES: [u8; 2] = [4, 2 * EDGE];
const SKY_TILES: [u8; 2] = [2, 1];

/// The sky sees the robot made of so many cubes along its size: finer than its pictures are.
const SKY_CELLS: f64 = 300.0;

/// Pixels around a lamp's picture of the robot: more than a cube of the sky's.
const RIM: f32 = 5.0;

/// Half width of the lamp's soft edge, as a part of the robot's size.
const SOFTNESS: f64 = 0.012;

/// The same in pixels of the lamp's picture, and one more.
const EDGE: u8 = 13;

/// A place is moved along its normal by this part of the robot's size before it looks at a lamp,
/// because a lamp's picture knows distances only to within its pixels.
const LAMP_OFFSET: f64 = 0.005;
const SKY_OFFSET: f64 = 0.012;

/// The lamp and the sky.
pub(super) struct Lights {
    pub(super) lamp: Lamp,
    disc: Disc,
    sky: Vec<Lamp>,
    /// Places are given from here, m: so that short numbers are exact enough.
    center: Vec3,
    lamp_offset: f64,
    sky_offset: f64,
}

/// A lamp far away.
pub(super) struct Lamp {
    /// Unit vector towards it.
    pub(super) toward: Vec3,
    /// The same in short numbers.
    short: [f32; 3],
    rows: Aim,
    depth: Depth,
}

/// A place that is looked at, in short numbers from [`Lights::center`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spot {
    /// Seen from the lamp: the place, moved off its surface.
    at_lamp: [f32; 3],
    /// Seen from the sky, likewise.
    at_sky: [f32; 3],
    normal: [f32; 3],
    /// Part of the lamp that is seen.
    pub(super) lamp: f32,
    /// Light of the sky: 1 under an open one.
    pub(super) sky: f32,
}

#[allow(clippy::cast_possible_truncation, reason = "a few digits suffice")]
fn shorter(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Where lamps look at the robot from.
///
/// - `reach`: points that their pictures reach to
#[allow(clippy::cast_possible_truncation, reason = "places in a picture")]
fn aims<const N: usize>(toward: &[Vec3; N], reach: &[Point], side: usize) -> [Aim; N] {
    let axes = toward.map(|toward| {
        let right = Vec3::z().cross(&toward);
        let right = right.try_normalize(1e-9).unwrap_or_else(Vec3::x);
        [right, toward.cross(&right)].map(|axis| shorter(&axis))
    });
    let mut low = [[f32::INFINITY; 2]; N];
    let mut high = [[f32::NEG_INFINITY; 2]; N];
    for point in reach {
        for ((axes, low), high) in axes.iter().zip(&mut low).zip(&mut high) {
            for i in 0..2 {
                let x = dot(&axes[i], point);
                low[i] = least(low[i], x);
                high[i] = greatest(high[i], x);
            }
        }
    }
    std::array::from_fn(|l| {
        let (low, high) = (low[l], high[l]);
        let size = (high[0] - low[0]).max(high[1] - low[1]).max(1e-6);
        // Some pixels stay free at each rim.
        let scale = (count(side) as f32 - 2.0 * RIM) / size;
        let row = |i: usize| {
            let [x, y, z] = axes[l][i].map(|x| x * scale);
            [x, y, z, RIM - low[i] * scale]
        };
        let short = shorter(&toward[l]);
        [row(0), row(1), [short[0], short[1], short[2], 0.0]]
    })
}

impl Lamp {
    fn new(toward: Vec3, rows: Aim, depth: Depth) -> Self {
        Self {
            toward,
            short: shorter(&toward),
            rows,
            depth,
        }
    }

    /// Adds the light of this lamp to the sky's on some places.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "within the picture"
    )]
    fn shine(&self, lanes: &mut Lanes) {
        let cosine = sums(&self.short, &lanes.normal, 0.0);
        if cosine.iter().all(|cosine| *cosine <= 0.0) {
            return;
        }
        let [x, y, near] = [0, 1, 2].map(|i| {
            let [a, b, c, d] = self.rows[i];
            sums(&[a, b, c], &lanes.place, d)
        });
        let side = self.depth.side;
        // The rim is free, so beyond it nothing hides the lamp.
        let end = count(side) as f32 - 1.0;
        let (x, y) = (x.map(|x| x - 0.5), y.map(|y| y - 0.5));
        let inside: [bool; LANES] =
            each(|l| x[l] >= 0.0 && y[l] >= 0.0 && x[l] < end && y[l] < end);
        let mut seen = [1.0; LANES];
        if inside.contains(&true) {
            let (left, top) = (x.map(|x| x as i32), y.map(|y| y as i32));
            let hidden: [bool; LANES] = each(|l| {
                let nearest = || self.depth.nearest_about(left[l] as usize, top[l] as usize);
                inside[l] && nearest() > near[l]
            });
            // Where nothing hides the lamp, the sum of all parts is 1 to the last bit.
            if hidden.contains(&true) {
                // The four pixels around each place that they may hide.
                let mut pixels = [[f32::NEG_INFINITY; LANES]; 4];
                for l in (0..LANES).filter(|l| hidden[*l]) {
                    let at = top[l] as usize * side + left[l] as usize;
                    if let Some(rows) = self.depth.near.get(at..at + side + 2) {
                        for (pixel, k) in pixels.iter_mut().zip([0, 1, side, side + 1]) {
                            pixel[l] = rows[k];
                        }
                    }
                }
                let open = pixels.map(|pixel| {
                    let open = |l: usize| if pixel[l] > near[l] { 0.0 } else { 1.0 };
                    each::<f32>(open)
                });
                let mixed: [f32; LANES] = each(|l| {
                    let (u, v) = (x[l] - left[l] as f32, y[l] - top[l] as f32);
                    let upper = open[0][l] * (1.0 - u) + open[1][l] * u;
                    let lower = open[2][l] * (1.0 - u) + open[3][l] * u;
                    upper * (1.0 - v) + lower * v
                });
                seen = each(|l| if inside[l] { mixed[l] } else { 1.0 });
            }
        }
        for l in 0..LANES {
            lanes.sky[l] += cosine[l].max(0.0) * seen[l];
        }
    }
}

/// Places that are looked at together: compilers make one instruction of the same sum for several.
const LANES: usize = 8;

/// Places in the sky's light.
struct Lanes {
    /// As [`Spot::at_sky`]: all x, all y, all z.
    place: [[f32; LANES]; 3],
    normal: [[f32; LANES]; 3],
    /// Light so far.
    sky: [f32; LANES],
}

impl Lanes {
    fn of(spots: &[Spot]) -> Self {
        let spot = |l: usize| spots.get(l).copied().unwrap_or_default();
        Self {
            place: [0, 1, 2].map(|i| each(|l| spot(l).at_sky[i])),
            normal: [0, 1, 2].map(|i| each(|l| spot(l).normal[i])),
            sky: [0.0; LANES],
        }
    }
}

/// One number for each place.
#[inline]
fn each<T>(of: impl FnMut(usize) -> T) -> [T; LANES] {
    std::array::from_fn(of)
}

/// x, y and z with factors, and a number added to their sum.
#[inline]
fn sums(factors: &[f32; 3], [x, y, z]: &[[f32; LANES]; 3], more: f32) -> [f32; LANES] {
    let [a, b, c] = factors;
    each(|l| a * x[l] + b * y[l] + c * z[l] + more)
}

/// Pictures that one thread draws at a time.
enum Group {
    /// That of the lamp.
    Own,
    /// Some of a quarter of the sky.
    Sky(usize, Vec<usize>),
}

impl Lights {
    pub(super) fn new(world: &World, camera: &Camera, look: &Look) -> Self {
        let center = camera.target;
        let points = world.positions.iter();
        let points: Vec<Point> = points.map(|p| shorter(&(p - center))).collect();
        // Glass throws no shadow.
        let casting = world.surfaces().filter(|(surface, _)| surface.alpha > 0.5);
        let casting: Vec<&[[u32; 3]]> = casting.map(|(_, at)| &world.faces[at]).collect();
        let faces = || casting.iter().flat_map(|faces| faces.iter().copied());
        let cubes = Cubes::new(&points, faces(), camera.size / SKY_CELLS).sorted();
        let own = direction(look.from.azimuth + LAMP_AZIMUTH, LAMP_ELEVATION);
        let directions = sky(look.sky);
        // The lamp's own picture is the largest, and is begun first.
        let mut groups = vec![Group::Own];
        for quarter in 0..Sorted::QUARTERS {
            let lamps =
                (0..directions.len()).filter(|&k| Sorted::quarter(&directions[k]) == quarter);
            let lamps: Vec<usize> = lamps.collect();
            let groups_of = lamps.chunks(sky::LAMPS);
            groups.extend(groups_of.map(|lamps| Group::Sky(quarter, lamps.to_vec())));
        }
        let drawn = parallel::map(&groups, |group| match group {
            Group::Own => {
                let [rows] = aims(&[own], &cubes.middles, LAMP_SIDE);
                let places = Places::new(points.iter().map(|p| place(&rows, p)));
                let depth = Depth::new(&places, faces(), LAMP_SIDE, LAMP_TILES);
                vec![(0, Lamp::new(own, rows, depth))]
            }
            Group::Sky(quarter, lamps) => {
                // Where there are fewer, the last one stands for those that are not there.
                let lamp = |l: usize| lamps[l.min(lamps.len() - 1)];
                let toward = std::array::from_fn(|l| directions[lamp(l)]);
                let rows = aims(&toward, &cubes.middles, SKY_SIDE);
                let faces = cubes.toward(*quarter);
                let near = sky::nearest(&rows, lamps.len(), &cubes.middles, faces, SKY_SIDE);
                let depths = near
                    .into_iter()
                    .map(|near| Depth::of(near, SKY_SIDE, SKY_TILES));
                let drawn = lamps.iter().zip(toward).zip(rows).zip(depths);
                let lamp = |(((k, toward), rows), depth): (((&usize, _), _), _)| {
                    (k + 1, Lamp::new(toward, rows, depth))
                };
                drawn.map(lamp).collect()
            }
        });
        let mut sky: Vec<(usize, Lamp)> = drawn.into_iter().flatten().collect();
        sky.sort_unstable_by_key(|(k, _)| *k);
        let mut sky: Vec<Lamp> = sky.into_iter().map(|(_, lamp)| lamp).collect();
        let lamp = sky.remove(0);
        Self {
            lamp,
            disc: Disc::new(),
            sky,
            center,
            lamp_offset: LAMP_OFFSET * camera.size,
            sky_offset: SKY_OFFSET * camera.size,
        }
    }

    /// A place with the normal `n`; how much it sees is found by [`Lights::look`].
    pub(super) fn spot(&self, p: &Vec3, n: &Vec3) -> Spot {
        let p = p - self.center;
        Spot {
            at_lamp: shorter(&(p + n * self.lamp_offset)),
            at_sky: shorter(&(p + n * self.sky_offset)),
            normal: shorter(n),
            lamp: 0.0,
            sky: 0.0,
        }
    }

    /// Finds what many places see: one lamp after the other, because what is near each other in the
    /// list is near each other in the lamp's picture, and so in the processor's memory.
    pub(super) fn look(&self, spots: &mut [Spot]) {
        let mut whole = 0.0_f32;
        let mut lanes: Vec<Lanes> = spots.chunks(LANES).map(Lanes::of).collect();
        for lamp in &self.sky {
            whole += lamp.short[2];
            for lanes in &mut lanes {
                lamp.shine(lanes);
            }
        }
        let sky = lanes.iter().flat_map(|lanes| lanes.sky);
        for (spot, sky) in spots.iter_mut().zip(sky) {
            // A flat floor under an open sky has 1.
            spot.sky = sky / whole;
            if dot(&self.lamp.short, &spot.normal) > 0.0 {
                spot.lamp = self.soft(&spot.at_lamp);
            }
        }
    }

    /// Part of the lamp that is seen, with a round soft edge.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "floats saturate"
    )]
    fn soft(&self, p: &[f32; 3]) -> f32 {
        let [x, y, near] = place(&self.lamp.rows, p);
        let Depth {
            side, near: known, ..
        } = &self.lamp.depth;
        let [left, top] = [x, y].map(|x| usize::from((x - f32::from(EDGE)) as u16));
        if self.lamp.depth.nearest_about(left, top) <= near {
            return 1.0;
        }
        // Beyond the picture nothing hides the lamp.
        let pixel = |x: f32| {
            if x < 0.0 {
                *side
            } else {
                (x as usize).min(*side)
            }
        };
        let columns = self.disc.steps.map(|step| pixel(x + step));
        // Weights are whole numbers, so that their sums are exact in any order.
        let mut hidden = 0.0;
        for (step, weights) in self.disc.steps.iter().zip(&self.disc.weights) {
            let row = pixel(y + step);
            let Some(known) = known.get(row * side..(row + 1) * side) else {
                continue;
            };
            for (column, weight) in columns.iter().zip(weights) {
                let known = known.get(*column).copied().unwrap_or(f32::NEG_INFINITY);
                hidden += if known > near { *weight } else { 0.0 };
            }
        }
        (self.disc.all - hidden) / self.disc.all
    }
}

/// Steps to each side of the middle of the lamp's soft edge.
const REACH: i8 = 4;

/// The lamp's soft edge in its picture.
struct Disc {
    /// Steps to the right, which are those down, too.
    steps: [f32; 9],
    /// Those of each row, whole numbers.
    weights: [[f32; 9]; 9],
    /// The sum of all weights.
    all: f32,
}

impl Disc {
    fn new() -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "a few pixels")]
        let step = (SOFTNESS * count(LAMP_SIDE) / f64::from(REACH)) as f32;
        let numbers: [i8; 9] = [-4, -3, -2, -1, 0, 1, 2, 3, 4];
        let weight = |i: i8, j: i8| f32::from((REACH * REACH + 2 - i * i - j * j).max(0));
        let weights = numbers.map(|j| numbers.map(|i| weight(i, j)));
        Self {
            steps: numbers.map(|i| f32::from(i) * step),
            all: weights.iter().flatten().sum(),
            weights,
        }
    }
}

/// Unit vector of an azimuth and an elevation in degrees.
fn direction(azimuth: f64, elevation: f64) -> Vec3 {
    let radians = std::f64::consts::PI / 180.0;
    let (sin_a, cos_a) = libm::sincos(azimuth * radians);
    let (sin_e, cos_e) = libm::sincos(elevation * radians);
    Vec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

/// Directions spread evenly over the sky: heights in equal steps, turned by the golden angle.
fn sky(count: u16) -> Vec<Vec3> {
    const GOLDEN: f64 = 137.507_764_05;
    (0..count)
        .map(|i| {
            let height = 1.0 - 0.95 * (f64::from(i) + 0.5) / f64::from(count);
            let across = (1.0 - height * height).sqrt();
            let (sin, cos) = libm::sincos(f64::from(i) * GOLDEN * std::f64::consts::PI / 180.0);
            Vec3::new(across * cos, across * sin, height)
        })
        .collect()
}
