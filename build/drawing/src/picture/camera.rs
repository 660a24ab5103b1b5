//! A camera with a long lens that shows the whole robot.

use super::look::{Look, Theme};
use urdf2fmu_core::spatial::Vec3;

/// Field of view over the height of the picture, degrees: a long lens keeps right angles honest.
const FIELD_OF_VIEW: f64 = 24.0;

/// Part of the picture's width and height that the robot takes.
const FILL: f64 = 0.84;
/// The same without a ground.
const FILL_CUTOUT: f64 = 0.96;

/// Elevations beyond this look along z, where "up" has no meaning, degrees.
const STEEPEST: f64 = 89.0;

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Where it is, m.
    pub eye: Vec3,
    /// The middle of the picture, m.
    pub target: Vec3,
    /// Field of view over the height, degrees.
    pub field_of_view: f64,
    /// Unit vectors of the picture: to the right, upwards, towards the camera.
    pub(super) axes: [Vec3; 3],
    /// Pixels per unit of the tangent.
    pub(super) focal: f64,
    /// Middle of the picture, pixels.
    pub(super) middle: [f64; 2],
    /// Largest extent of what it shows, m.
    pub(super) size: f64,
}

impl Camera {
    /// The nearest camera that sees all of `corners`.
    ///
    /// Let x, y, z be the coordinates of a corner to the right, upwards and towards the camera, and
    /// D the camera's z. The corner is in the picture if |x − x₀| ≤ t (D − z), with the tangent t
    /// of half the width. So (x + t z) − x₀ ≤ t D and x₀ − (x − t z) ≤ t D for all corners: the
    /// least D has 2 t D = max(x + t z) − min(x − t z), and x₀ lies in the middle. The same holds
    /// for y; the larger D is taken.
    pub(super) fn fit(corners: impl Iterator<Item = Vec3>, look: &Look) -> Self {
        let radians = std::f64::consts::PI / 180.0;
        let (sin_a, cos_a) = libm::sincos(look.from.azimuth * radians);
        let elevation = look.from.elevation.clamp(-STEEPEST, STEEPEST) * radians;
        let (sin_e, cos_e) = libm::sincos(elevation);
        let toward = Vec3::new(cos_e * cos_a, cos_e * sin_a, sin_e);
        let right = Vec3::new(-sin_a, cos_a, 0.0);
        let up = toward.cross(&right);
        let axes = [right, up, toward];

        let (width, height) = (count(look.width), count(look.height));
        let fill = match look.theme {
            Theme::Cutout => FILL_CUTOUT,
            Theme::Clear | Theme::Light | Theme::Dark => FILL,
        };
        let tangent = libm::tan(0.5 * FIELD_OF_VIEW * radians);
        let focal = 0.5 * height / tangent;
        let tangents = [tangent * width / height * fill, tangent * fill];
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut reach = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for corner in corners {
            let [x, y, z] = axes.map(|axis| axis.dot(&corner));
            for (i, x) in [x, y, z].into_iter().enumerate() {
                low[i] = low[i].min(x);
                high[i] = high[i].max(x);
            }
            for (i, x) in [x, y].into_iter().enumerate() {
                reach[i][0] = reach[i][0].min(x - tangents[i] * z);
                reach[i][1] = reach[i][1].max(x + tangents[i] * z);
            }
        }
        if low[0] > high[0] {
            (low, high) = ([-0.5; 3], [0.5; 3]);
            reach = [[-1.0, 1.0]; 2];
        }
        let size = (0..3).map(|i| high[i] - low[i]).fold(1e-3, f64::max);
        let distance = (0..2)
            .map(|i| (reach[i][1] - reach[i][0]) / (2.0 * tangents[i]))
            // Never within the robot, which may be a long rod that points to the camera.
            .fold(high[2] + 0.5 * size, f64::max);
        let [x, y] = reach.map(|[low, high]| 0.5 * (low + high));
        let middle = right * x + up * y;
        Self {
            eye: middle + toward * distance,
            target: middle + toward * (0.5 * (low[2] + high[2])),
            field_of_view: FIELD_OF_VIEW,
            axes,
            focal,
            middle: [0.5 * width, 0.5 * height],
            size,
        }
    }

    /// The same camera, moved.
    pub(super) fn moved(&self, by: &Vec3) -> Self {
        Self {
            eye: self.eye + by,
            target: self.target + by,
            ..self.clone()
        }
    }

    /// Column, row and nearness of a point; the nearness is linear in the picture. `samples` to a
    /// pixel's side.
    pub(super) fn project(&self, p: &Vec3, samples: usize) -> [f64; 3] {
        let d = p - self.eye;
        let nearness = -1.0 / self.axes[2].dot(&d);
        let scale = self.focal * nearness;
        let samples = count(samples);
        [
            (self.middle[0] + scale * self.axes[0].dot(&d)) * samples,
            (self.middle[1] - scale * self.axes[1].dot(&d)) * samples,
            nearness,
        ]
    }

    /// Unit vector from the camera through a place in the picture, in pixels.
    pub(super) fn ray(&self, x: f64, y: f64) -> Vec3 {
        let right = self.axes[0] * ((x - self.middle[0]) / self.focal);
        let up = self.axes[1] * ((self.middle[1] - y) / self.focal);
        (right + up - self.axes[2]).normalize()
    }
}

/// A number of pixels.
#[allow(clippy::cast_precision_loss, reason = "pictures are small")]
pub(super) fn count(pixels: usize) -> f64 {
    pixels as f64
}
