//! Direction between two cylinders that do not meet.
//!
//! In this order, each with its own test: the flat end of one faces the other; both face each other
//! with their sides; a rim faces a side; two rims face each other. The first two are closed, the
//! others are a minimum over two places, found by Newton's method from the direction that
//! `gjk.rs` has found.

use super::core::Core;
use super::placed::{Placed, separation};
use super::segments::segments;
use crate::spatial::Vec3;

/// Sine below which two directions count as parallel.
const PARALLEL: f64 = 1e-14;
/// Cosine to the axis below which the side is tried before the rim.
const SIDE: f64 = 1e-6;
/// Accuracy of the gap against the distance, relative to the size of the cylinders.
const OPTIMAL: f64 = 1e-14;
/// Iterations of Newton's method, at most.
const MOST_ITERATIONS: usize = 30;

/// A cylinder in a place.
#[derive(Clone, Copy, Debug)]
struct Cylinder {
    p: Vec3,
    k: Vec3,
    radius: f64,
    half: f64,
}

impl Cylinder {
    fn of(placed: &Placed) -> Option<Self> {
        let Core::Cylinder { radius, half } = *placed.core else {
            return None;
        };
        Some(Self {
            p: placed.p,
            k: placed.axis(),
            radius,
            half,
        })
    }

    fn across(&self, x: &Vec3) -> Vec3 {
        x - self.k * self.k.dot(x)
    }
}

/// From `b` to `a`, and the nearest point of `a`, where `rough` and `at` are nearly these.
pub(super) fn apart(a: &Placed, b: &Placed, (rough, at): (&Vec3, &Vec3)) -> (Vec3, Vec3) {
    let (Some(first), Some(second)) = (Cylinder::of(a), Cylinder::of(b)) else {
        return (*rough, *at);
    };
    let n = rough.normalize();
    if let Some(n) = end_faces(&first, &second, &n) {
        let v = n * separation(a, b, &n);
        return (v, b.support(&n) + v);
    }
    if let Some(n) = end_faces(&second, &first, &-n) {
        return (-n * separation(a, b, &-n), a.support(&n));
    }
    if let Some(found) = sides(&first, &second) {
        return found;
    }
    let mut best = (f64::NEG_INFINITY, (*rough, *at));
    let near = |c: &Cylinder| c.k.dot(&n).abs() < SIDE;
    // The likelier curves first; the others where these turn out to be the wrong ones.
    for try_a in [near(&first), !near(&first)] {
        for try_b in [near(&second), !near(&second)] {
            if try_a && try_b {
                continue;
            }
            let (x, y) = (curve(&first, try_a, &-n), curve(&second, try_b, &n));
            let Some((v, s)) = newton(&x, &y) else {
                continue;
            };
            let distance = v.norm();
            let v = v / distance;
            let value = separation(a, b, &v);
            let beyond = |curve: &Curve, of: &Cylinder| if curve.round { 0.0 } else { of.radius };
            let (p, q) = (beyond(&x, &first), beyond(&y, &second));
            if value > best.0 {
                best = (value, (v * value, x.at(s).0 - v * p));
            }
            // No gap along a direction is more than the distance: where they agree, it is that.
            let size = distance + first.radius + second.radius;
            if (distance - p - q - value).abs() <= OPTIMAL * size {
                return best.1;
            }
        }
    }
    best.1
}

/// The direction, if an end of `a` faces `b`: where what of `b` reaches farthest towards it lies
/// over the end.
fn end_faces(a: &Cylinder, b: &Cylinder, n: &Vec3) -> Option<Vec3> {
    let along = a.k.dot(n);
    if along.abs() < 0.5 {
        return None;
    }
    let n = a.k * along.signum();
    let to = b.p - a.p;
    // It is beyond the end.
    if -n.dot(&to) <= a.half {
        return None;
    }
    let center = a.across(&to);
    let up = b.k.dot(&n);
    let off = n - b.k * up;
    let length = off.norm();
    let over = if length < PARALLEL {
        center.norm() <= a.radius + b.radius
    } else if up.abs() < PARALLEL {
        let (x, _) = segments((center, b.k * b.half), (Vec3::zeros(), Vec3::zeros()));
        x.norm() <= a.radius
    } else {
        let highest = b.k * (b.half * up.signum()) + off * (b.radius / length);
        (center + a.across(&highest)).norm() <= a.radius
    };
    over.then_some(n)
}

/// The same, if both face each other with their sides.
fn sides(a: &Cylinder, b: &Cylinder) -> Option<(Vec3, Vec3)> {
    let (r, w) = (b.p - a.p, a.k.cross(&b.k));
    let square = w.norm_squared();
    let (v, at) = if square < PARALLEL * PARALLEL {
        if a.k.dot(&r).abs() > a.half + b.half {
            return None;
        }
        (-a.across(&r), a.p)
    } else {
        let s = r.cross(&b.k).dot(&w) / square;
        let t = r.cross(&a.k).dot(&w) / square;
        if s.abs() > a.half || t.abs() > b.half {
            return None;
        }
        let at = a.p + a.k * s;
        (at - (b.p + b.k * t), at)
    };
    let length = v.norm();
    let apart = length - a.radius - b.radius;
    (apart > 0.0).then(|| (v * (apart / length), at - v * (a.radius / length)))
}

/// A rim, or the axis.
#[derive(Clone, Copy, Debug)]
struct Curve {
    center: Vec3,
    u: Vec3,
    v: Vec3,
    round: bool,
}

impl Curve {
    /// The point at `s`, and its first and second derivative.
    fn at(&self, s: f64) -> (Vec3, Vec3, Vec3) {
        if !self.round {
            return (self.center + self.u * s, self.u, Vec3::zeros());
        }
        let (sin, cos) = libm::sincos(s);
        let out = self.u * cos + self.v * sin;
        (self.center + out, self.v * cos - self.u * sin, -out)
    }
}

/// What of the cylinder faces along `d`.
fn curve(c: &Cylinder, side: bool, d: &Vec3) -> Curve {
    let end = c.k * (c.half * c.k.dot(d).signum());
    if side {
        return Curve {
            center: c.p + end,
            u: c.k,
            v: Vec3::zeros(),
            round: false,
        };
    }
    let u = c.across(d).try_normalize(1e-12);
    let u = u.unwrap_or_else(|| crate::spatial::across(&c.k)) * c.radius;
    Curve {
        center: c.p + end,
        u,
        v: c.k.cross(&u),
        round: true,
    }
}

/// From the nearest point of `y` to that of `x`, and the place of this.
fn newton(x: &Curve, y: &Curve) -> Option<(Vec3, f64)> {
    let (mut s, mut t) = (0.0, 0.0);
    let mut best = f64::INFINITY;
    let mut found = None;
    for _ in 0..MOST_ITERATIONS {
        let ((p, p1, p2), (q, q1, q2)) = (x.at(s), y.at(t));
        let v = p - q;
        let (g, f) = (v.dot(&p1), -v.dot(&q1));
        let value = g.abs() / p1.norm() + f.abs() / q1.norm();
        if value < best {
            (best, found) = (value, Some((v, s)));
        } else if value < 1e-12 * v.norm() {
            break;
        }
        let (mut a, b, mut c) = (
            p1.dot(&p1) + v.dot(&p2),
            -p1.dot(&q1),
            q1.dot(&q1) - v.dot(&q2),
        );
        // A saddle or a maximum: a shorter way downhill.
        if a <= 0.0 || a * c - b * b <= 0.0 {
            a = a.abs() + b.abs() + 1e-3 * p1.norm_squared();
            c = c.abs() + b.abs() + 1e-3 * q1.norm_squared();
        }
        let det = a * c - b * b;
        if det <= 0.0 || !det.is_finite() {
            break;
        }
        s -= (c * g - b * f) / det;
        t -= (a * f - b * g) / det;
    }
    found
}
