//! What is seen at each sample → colours.
//!
//! The samples of a pixel that show one surface from one side are shaded once; the others of the
//! pixel separately, so that edges stay smooth. Light is linear until the end; values brighter than
//! white are then compressed below it.

use super::camera::{Camera, count};
use super::color::finish;
use super::light::{Lights, Spot};
use super::look::{Look, Picture, SAMPLES, Theme};
use super::raster::{Layer, NONE};
use super::solid::{Stage, Triangle};
use crate::image::{linear, srgb_table};
use urdf2fmu_core::parallel;
use urdf2fmu_core::spatial::Vec3;

type Rgb = [f32; 3];

/// Colour of the lamp, of the sky above, and of what the ground throws back.
const LAMP: Rgb = [0.80, 0.775, 0.73];
const SKY: Rgb = [0.41, 0.425, 0.455];
const BOUNCE: Rgb = [0.19, 0.185, 0.18];

/// Cosine of the angle between normals up to which samples are shaded as one.
const SAME_SIDE: f64 = 0.97;

/// Colours of the floor, its lines, and the two axes, sRGB.
struct Paper {
    floor: Rgb,
    line: Rgb,
    axes: [Rgb; 2],
    /// How dark a full shadow is.
    shadow: f32,
}

const LIGHT: Paper = Paper {
    floor: [0.957, 0.965, 0.976],
    line: [0.80, 0.82, 0.85],
    axes: [[0.90, 0.42, 0.42], [0.36, 0.72, 0.50]],
    shadow: 0.78,
};

const DARK: Paper = Paper {
    floor: [0.094, 0.106, 0.130],
    line: [0.20, 0.22, 0.26],
    axes: [[0.62, 0.27, 0.29], [0.22, 0.47, 0.34]],
    shadow: 0.80,
};

/// Darkness of a full shadow on a page of unknown colour.
const CLEAR_SHADOW: f32 = 0.60;

/// Rows that are shaded together.
const BAND: usize = 16;

/// What one of the lamps of the sky hides alone would be a faint ray on the floor: shade below this
/// is left out.
const FAINT: f32 = 0.05;

/// How far from its middle the floor shows the robot's shade, in sizes of the robot.
const FAR: f32 = 2.6;

/// All that a picture is made of.
pub(super) struct Seen<'s> {
    pub(super) stage: &'s Stage,
    pub(super) layer: &'s Layer,
    pub(super) lights: &'s Lights,
    pub(super) camera: &'s Camera,
    pub(super) look: &'s Look,
    /// Whether there is a floor at z = 0.
    pub(super) floor: bool,
}

/// Samples that are shaded together.
struct Group {
    /// Of the first of them.
    triangle: u32,
    /// Sum of their places in the pixel.
    place: [f64; 2],
    count: f64,
    /// The place of the first, in pixels.
    first: [f64; 2],
}

impl Group {
    /// Whether a triangle may be shaded with it.
    fn takes(&self, triangles: &[Triangle], t: u32) -> bool {
        if self.triangle == t {
            return true;
        }
        let [a, b] = [self.triangle, t].map(|t| &triangles[t as usize]);
        a.surface == b.surface && a.facing.dot(&b.facing).abs() > SAME_SIDE
    }
}

/// - `done`: takes each band of rows by its number as soon as it is there
pub(super) fn picture(seen: &Seen, done: impl Fn(usize, &[[u8; 4]]) + Sync) -> Picture {
    let Look { width, height, .. } = *seen.look;
    let to_srgb = srgb_table();
    let mut pixels = vec![[0; 4]; width * height];
    let band = BAND.min(height);
    parallel::for_pieces(&mut pixels, band * width, |i, rows| {
        seen.band(i * band, rows, &to_srgb);
        done(i, rows);
    });
    Picture {
        width,
        height,
        pixels,
    }
}

/// What is seen at a place, before it is known how much light falls on it.
enum Place {
    Robot {
        normal: Vec3,
        ray: Vec3,
        color: Rgb,
    },
    Floor {
        /// Without its shadow.
        color: Rgb,
        /// How much of the shadow is shown.
        shade: f32,
    },
}

/// A place, its part of a pixel, and the pixel's place in the band.
struct Piece {
    pixel: usize,
    weight: f32,
    place: Place,
}

impl Seen<'_> {
    /// Shades some rows from row `first` on.
    fn band(&self, first: usize, pixels: &mut [[u8; 4]], to_srgb: &[u8]) {
        let width = self.look.width;
        let (mut pieces, mut spots) = (Vec::new(), Vec::new());
        for pixel in 0..pixels.len() {
            let (x, y) = (pixel % width, first + pixel / width);
            self.pixel(x, y, |weight, place, spot| {
                pieces.push(Piece {
                    pixel,
                    weight,
                    place,
                });
                spots.push(spot);
            });
        }
        self.lights.look(&mut spots);
        // Linear colour times alpha, and alpha.
        let mut sums = vec![[0.0_f32; 4]; pixels.len()];
        for (piece, spot) in pieces.iter().zip(&spots) {
            let color = match &piece.place {
                Place::Robot { normal, ray, color } => {
                    let [red, green, blue] = self.lit(spot, normal, ray, *color);
                    [red, green, blue, 1.0]
                }
                Place::Floor { color, shade } => self.floor(spot, *color, *shade),
            };
            for (sum, color) in sums[piece.pixel].iter_mut().zip(color) {
                *sum += piece.weight * color;
            }
        }
        for (pixel, sum) in pixels.iter_mut().zip(sums) {
            *pixel = finish(sum, to_srgb);
        }
    }

    /// Shows the places in a pixel with their parts of it.
    fn pixel(&self, x: usize, y: usize, mut show: impl FnMut(f32, Place, Spot)) {
        let triangles = self.layer.triangles(y * SAMPLES);
        let mut groups: Vec<Group> = Vec::new();
        let mut empty = 0.0_f32;
        for j in 0..SAMPLES {
            for i in 0..SAMPLES {
                let (column, row) = (x * SAMPLES + i, y * SAMPLES + j);
                let t = self.layer.seen[row * self.layer.width + column];
                if t == NONE {
                    empty += 1.0;
                    continue;
                }
                let at = [column, row].map(|k| (count(k) + 0.5) / count(SAMPLES));
                if let Some(group) = groups.iter_mut().find(|g| g.takes(triangles, t)) {
                    group.count += 1.0;
                    group.place = [group.place[0] + at[0], group.place[1] + at[1]];
                } else {
                    groups.push(Group {
                        triangle: t,
                        place: at,
                        count: 1.0,
                        first: at,
                    });
                }
            }
        }
        #[allow(clippy::cast_precision_loss, reason = "sixteen")]
        let all = (SAMPLES * SAMPLES) as f32;
        for group in &groups {
            #[allow(clippy::cast_possible_truncation, reason = "at most sixteen")]
            let weight = group.count as f32 / all;
            let (place, spot) = self.robot(triangles, group);
            show(weight, place, spot);
        }
        if empty > 0.0
            && let Some((place, spot)) = self.ground(count(x) + 0.5, count(y) + 0.5)
        {
            show(empty / all, place, spot);
        }
    }

    fn robot(&self, triangles: &[Triangle], group: &Group) -> (Place, Spot) {
        let triangle = &triangles[group.triangle as usize];
        let middle = group.place.map(|x| x / group.count);
        let from = self.camera.eye;
        // The middle of the samples may lie beside the triangle of the first.
        let (ray, parts) = [middle, group.first]
            .map(|[x, y]| {
                let ray = self.camera.ray(x, y);
                (ray, meet(&from, &ray, &triangle.corners))
            })
            .into_iter()
            .min_by(|a, b| outside(&a.1).total_cmp(&outside(&b.1)))
            .unwrap_or_else(|| (-triangle.facing, [1.0 / 3.0; 3]));
        let [a, b, c] = inside(parts);
        let mix = |v: &[Vec3; 3]| v[0] * a + v[1] * b + v[2] * c;
        let p = mix(&triangle.corners);
        let mut normal = mix(&triangle.normals).try_normalize(0.0).unwrap_or(-ray);
        if normal.dot(&ray) > 0.0 {
            normal = -normal;
        }
        let surface = &self.stage.surfaces[triangle.surface];
        let mut color = surface.color;
        if let Some(image) = surface.image.and_then(|i| self.stage.images[i].as_ref()) {
            let uv = &triangle.uv;
            let at = [0, 1].map(|i| uv[0][i] * a + uv[1][i] * b + uv[2][i] * c);
            let texel = image.at(at, self.footprint(triangle, &p));
            for (color, texel) in color.iter_mut().zip(texel) {
                *color *= texel;
            }
        }
        let spot = self.lights.spot(&p, &normal);
        (Place::Robot { normal, ray, color }, spot)
    }

    /// How much of a texture's side a pixel covers.
    fn footprint(&self, triangle: &Triangle, p: &Vec3) -> f64 {
        let [a, b, c] = &triangle.corners;
        let area = (b - a).cross(&(c - a)).norm();
        let [ua, ub, uc] = triangle.uv;
        let uv_area = ((ub[0] - ua[0]) * (uc[1] - ua[1]) - (ub[1] - ua[1]) * (uc[0] - ua[0])).abs();
        let pixel = (p - self.camera.eye).norm() / self.camera.focal;
        if area > 0.0 {
            pixel * (uv_area / area).sqrt()
        } else {
            0.0
        }
    }

    /// Light of the lamp, the sky and the ground on a painted surface with a thin clear coat.
    #[allow(clippy::cast_possible_truncation, reason = "0 … 1")]
    fn lit(&self, spot: &Spot, n: &Vec3, ray: &Vec3, color: Rgb) -> Rgb {
        let toward = self.lights.lamp.toward;
        let cosine = n.dot(&toward) as f32;
        let Spot { lamp, sky, .. } = *spot;
        let up = n.z as f32;
        // The ground shines back on what faces it, less the nearer it is to the robot's own shade.
        let bounce = (0.5 - 0.5 * up) * (0.35 + 0.65 * sky.min(1.0));
        let facing = (-n.dot(ray)).max(0.0) as f32;
        // As Schlick 1994, for a coat that is duller than glass.
        let grazing = (1.0 - facing) * (1.0 - facing);
        let coat = 0.03 + 0.5 * grazing * grazing * (1.0 - facing);
        let mirrored = ray - n * (2.0 * n.dot(ray));
        let open = (0.25 + 0.75 * sky).min(1.0);
        let around = environment(&mirrored, &toward) * open;
        let half = (toward - ray).try_normalize(0.0).unwrap_or(toward);
        let gloss = power(n.dot(&half).max(0.0) as f32, 6) * 0.30 * lamp * cosine.max(0.0);
        std::array::from_fn(|i| {
            let light = LAMP[i] * lamp * cosine.max(0.0) + SKY[i] * sky + BOUNCE[i] * bounce;
            bent(color[i] * light * (1.0 - coat) + coat * around + gloss)
        })
    }

    /// What is seen past the robot, if anything.
    #[allow(clippy::cast_possible_truncation, reason = "colours")]
    fn ground(&self, x: f64, y: f64) -> Option<(Place, Spot)> {
        let paper = match self.look.theme {
            Theme::Cutout => return None,
            Theme::Clear => None,
            Theme::Light => Some(&LIGHT),
            Theme::Dark => Some(&DARK),
        };
        let mut color = paper.map_or([0.0; 3], |paper| paper.floor);
        let mut spot = Spot::default();
        let mut shade = 0.0;
        let ray = self.camera.ray(x, y);
        if self.floor && ray.z < -1e-3 && self.camera.eye.z > 0.0 {
            let p = self.camera.eye - ray * (self.camera.eye.z / ray.z);
            let [x, y] = [0, 1].map(|i| p[i] - self.camera.target[i]);
            let away = ((x * x + y * y).sqrt() / self.camera.size) as f32;
            if away < FAR {
                spot = self.lights.spot(&p, &Vec3::z());
                // The shadow of a tall robot fades out and is not cut off.
                shade = (2.0 * (FAR - away) / FAR).clamp(0.0, 1.0);
            }
            if let Some(paper) = paper {
                let lines = self.lines(&p, &ray, away);
                let colors = [paper.line, paper.axes[0], paper.axes[1]];
                for (strength, line) in lines.into_iter().zip(colors) {
                    for (color, line) in color.iter_mut().zip(line) {
                        *color += (line - *color) * strength;
                    }
                }
            }
        }
        let color = color.map(|x| linear(f64::from(x)));
        Some((Place::Floor { color, shade }, spot))
    }

    /// Colour and alpha of the floor in the robot's shade.
    #[allow(clippy::cast_possible_truncation, reason = "0 … 1")]
    fn floor(&self, spot: &Spot, color: Rgb, shade: f32) -> [f32; 4] {
        let up = self.lights.lamp.toward.z as f32;
        let lamp = LAMP[1] * up;
        let dark = (lamp * (1.0 - spot.lamp) + SKY[1] * (1.0 - spot.sky)) / (lamp + SKY[1]);
        let dark = shade * ((dark - FAINT) / (1.0 - FAINT)).clamp(0.0, 1.0);
        let paper = match self.look.theme {
            Theme::Light => &LIGHT,
            Theme::Dark => &DARK,
            Theme::Clear | Theme::Cutout => return [0.0, 0.0, 0.0, CLEAR_SHADOW * dark],
        };
        let [red, green, blue] = color.map(|x| x * (1.0 - paper.shadow * dark));
        [red, green, blue, 1.0]
    }

    /// How much of the grid and of the two axes is in a pixel of the floor.
    #[allow(clippy::cast_possible_truncation, reason = "0 … 1")]
    fn lines(&self, p: &Vec3, ray: &Vec3, away: f32) -> [f32; 3] {
        let size = self.camera.size;
        // Squares of 1, 0.1, 0.01 … m: five to twenty of them fit into the robot's size.
        let mut side = 1.0;
        while side > 0.4 * size {
            side *= 0.1;
        }
        while side < 0.04 * size {
            side *= 10.0;
        }
        let distance = (p - self.camera.eye).norm();
        let pixel = distance / self.camera.focal;
        // Seen flat, a pixel is longer along the ray.
        let flat = (ray.x * ray.x + ray.y * ray.y).sqrt();
        let long = pixel / (-ray.z);
        let fade = (1.0 - away / 3.2).clamp(0.0, 1.0);
        let fade = fade * fade;
        let mut strength = [0.0_f32; 3];
        for (i, (x, along)) in [(p.x, ray.x), (p.y, ray.y)].into_iter().enumerate() {
            // Width of a pixel across the lines.
            let turn = (along / flat).abs();
            let width = pixel + (long - pixel) * turn;
            for (every, weight) in [(side, 0.55), (10.0 * side, 0.9)] {
                let off = (x / every - (x / every).round()).abs() * every;
                let cover = (1.1 - off / width).clamp(0.0, 1.0) * (0.35 * every / width).min(1.0);
                strength[0] = strength[0].max(cover as f32 * weight * fade);
            }
            let cover = (1.6 - x.abs() / width).clamp(0.0, 1.0) as f32 * fade;
            // The line where y is 0 is the x axis.
            strength[2 - i] = strength[2 - i].max(0.8 * cover);
        }
        strength
    }
}

/// How far a place in the plane of a triangle lies beside it.
fn outside(parts: &[f64; 3]) -> f64 {
    parts.iter().map(|x| (-x).max(0.0)).sum()
}

/// A place beside a triangle is moved to its rim.
fn inside(parts: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = parts.map(|x| x.clamp(0.0, 1.0));
    let sum = a + b + c;
    [a / sum, b / sum, c / sum]
}

/// Where a ray meets the plane of a triangle: parts of its corners.
fn meet(from: &Vec3, ray: &Vec3, [a, b, c]: &[Vec3; 3]) -> [f64; 3] {
    // Möller and Trumbore 1997.
    let (u, v) = (b - a, c - a);
    let h = ray.cross(&v);
    let det = u.dot(&h);
    if det == 0.0 {
        return [1.0 / 3.0; 3];
    }
    let s = from - a;
    let second = s.dot(&h) / det;
    let third = ray.dot(&s.cross(&u)) / det;
    [1.0 - second - third, second, third]
}

/// What a mirror would show: a dim ground, a bright band at the horizon, a calm sky, and a broad
/// soft light around the lamp.
#[allow(clippy::cast_possible_truncation, reason = "0 … 1")]
fn environment(toward: &Vec3, lamp: &Vec3) -> f32 {
    let up = toward.z as f32;
    let base = if up < 0.0 {
        0.55 + 0.35 * up
    } else {
        0.62 + 0.30 * up
    };
    base + 0.8 * power(toward.dot(lamp).max(0.0) as f32, 3)
}

/// `x` to the power of 2 to the power of `doublings`.
fn power(mut x: f32, doublings: u8) -> f32 {
    for _ in 0..doublings {
        x *= x;
    }
    x
}

/// Bends what is brighter than the paper.
fn bent(x: f32) -> f32 {
    /// From here on it is bent.
    const SHOULDER: f32 = 0.72;
    let over = (x - SHOULDER).max(0.0);
    let rest = 1.0 - SHOULDER;
    x.min(SHOULDER) + rest * over / (over + rest)
}
