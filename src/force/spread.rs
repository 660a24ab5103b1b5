//! How the load of a face is spread about its centre: how far an even pressure with it would be
//! from there, and which forces friction under that can bear.

use crate::law::Face;
use crate::spatial::Vec3;
use crate::tuning::{EVEN_DISC, EVEN_LINE, MIN_CORNERS};

/// How far the load of a face is longer than it is wide; that of a point by default.
#[derive(Clone, Copy, Debug, Default)]
pub struct Oblong {
    /// Any direction across the normal, of any length; zero for a point.
    first: Vec3,
    /// `Σ load (x² − y²)` and `Σ load 2 x y` as shares of `Σ load (x² + y²)`, where `x` and `y` are
    /// the distances from the centre along `first` and across it.
    turned: [f64; 2],
}

#[cfg(test)]
crate::spoil::spoil!(Oblong: first turned;);

impl Oblong {
    /// Which forces friction can bear about the normal `normal` where it pulls by `pull`.
    pub(super) fn limit(&self, normal: &Vec3, pull: &Vec3) -> Face {
        let Self { first, turned } = self;
        if *first == Vec3::zeros() {
            return Face::default();
        }
        let [a, b] = *turned;
        let (x, y) = (pull.dot(first), pull.dot(&normal.cross(first)));
        // Along the pull, whose direction alone counts; what is not pulled is no more pulled along
        // one axis than along the other one.
        let q = if x == 0.0 && y == 0.0 {
            0.0
        } else if x.abs() > y.abs() {
            let r = y / x;
            (a * (1.0 - r * r) + 2.0 * b * r) / (1.0 + r * r)
        } else {
            let r = x / y;
            (a * (r * r - 1.0) + 2.0 * b * r) / (r * r + 1.0)
        };
        Face::new(normal, q, a * a + b * b)
    }
}

/// How the load of a face is spread about its centre: sums over its points, where `x` and `y` are
/// their distances from it along a direction across the normal and across that.
#[derive(Default)]
pub(super) struct Spread {
    /// That direction, of any length.
    pub first: Vec3,
    /// `Σ load²`
    pub squares: f64,
    /// `Σ load (x² + y²)`, m².
    pub whole: f64,
    /// `Σ load (x² − y²)` and `Σ load 2 x y`, m².
    pub turned: [f64; 2],
    /// `Σ load √(x² + y²)`, m.
    pub mean: f64,
    /// `Σ load R` and `Σ load R²` of what of the rims is flat, m and m².
    pub discs: [f64; 2],
}

impl Spread {
    pub fn add(&mut self, load: f64, [x, y]: [f64; 2]) {
        self.squares += load * load;
        self.whole += load * (x * x + y * y);
        self.turned[0] += load * (x * x - y * y);
        self.turned[1] += load * 2.0 * x * y;
        self.mean += load * (x * x + y * y).sqrt();
    }

    /// How far it is longer than wide.
    pub fn oblong(&self) -> Oblong {
        let whole = self.whole + self.discs[1];
        if whole > 0.0 {
            Oblong {
                first: self.first,
                turned: self.turned.map(|x| x / whole),
            }
        } else {
            Oblong::default()
        }
    }

    /// Mean distance of an even pressure from its middle, m, over an area that so many points
    /// carry.
    pub fn radius(&self, points: usize) -> f64 {
        let even = if points < 3 {
            EVEN_LINE
        } else {
            self.even_share()
        };
        self.mean * even + EVEN_DISC * self.discs[0]
    }

    /// Mean distance of an even pressure from its middle, as a share of that of the points that
    /// carry it, which are its corners: on a regular polygon of `n` corners, with `φ = π/n`,
    ///
    /// ```text
    /// ∫∫ r² dr dα/∫∫ r dr dα = R/3 (1 + cos φ ln(sec φ + tan φ)/tan φ)
    /// ```
    ///
    /// and half of the half length on a line. Between them it goes with the square of
    /// `2 a b/(a² + b²)` of the root mean squares `a`, `b` of the distances along the principal
    /// axes, which for rectangles is right to 1 % and smooth where the corners come to stand in a
    /// line. As many corners as carry count, `1/Σ load²`, at least four, so that it does not jump
    /// where one of them leaves. A triangle has 0.46 and is given 0.54.
    fn even_share(&self) -> f64 {
        let (whole, [a, b]) = (self.whole, self.turned);
        let round = (whole * whole - a * a - b * b) / (whole * whole);
        if self.squares <= 0.0 || round.is_nan() {
            return EVEN_LINE;
        }
        let corners = (1.0 / self.squares).max(MIN_CORNERS);
        let (sin, cos) = libm::sincos(std::f64::consts::PI / corners);
        let regular = (1.0 + cos * cos / sin * libm::log((1.0 + sin) / cos)) / 3.0;
        EVEN_LINE + round.max(0.0) * (regular - EVEN_LINE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms: a line, a square and a hexagon of corners at the distance 1, a rectangle of
    /// 5:1 (by a sum over its area: 0.5108) and a polygon that is nearly a disc. What stands on
    /// one corner, nearly, has a lever, too.
    #[test]
    fn an_even_pressure_has_the_lever_of_its_corners() {
        let share = |places: &[(f64, f64, f64)]| {
            let middle = |of: fn(&(f64, f64, f64)) -> f64| -> f64 {
                places.iter().map(|p| p.2 * of(p)).sum()
            };
            let (x, y) = (middle(|p| p.0), middle(|p| p.1));
            let mut spread = Spread::default();
            for p in places {
                spread.add(p.2, [p.0 - x, p.1 - y]);
            }
            spread.even_share()
        };
        let polygon = |n: u32| {
            let corner = |i: u32| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
                (cos, sin, 1.0 / f64::from(n))
            };
            share(&(0..n).map(corner).collect::<Vec<_>>())
        };
        let corners = [(5.0, 1.0), (5.0, -1.0), (-5.0, 1.0), (-5.0, -1.0)];
        let rectangle = share(&corners.map(|(x, y)| (x, y, 0.25)));
        let edge = share(&corners.map(|(x, y)| (x, y, if y > 0.0 { 0.5 } else { 0.0 })));
        for (found, expected, most) in [
            (polygon(4), 0.541_075, 1e-6),
            (polygon(6), 0.607_986, 1e-6),
            (polygon(60), 2.0 / 3.0, 1e-3),
            (rectangle, 0.5108, 6e-3),
            (edge, 0.5, 1e-12),
        ] {
            assert!((found - expected).abs() < most, "{found} {expected}");
        }
        let one = share(&[(0.0, 0.0, 0.98), (1.0, 0.0, 0.01), (0.0, 1.0, 0.01)]);
        assert!((0.3..0.7).contains(&one), "{one}");
    }
}
