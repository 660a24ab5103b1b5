//! Nearest points of two segments.

use crate::spatial::Vec3;

/// Nearest points of the segments `p ± u` and `q ± v`.
///
/// The lines are nearest where `w = u × v` joins them: at `s = (r × v)·w/|w|²` of the first, with
/// `r = q − p`, and at `t = (r × u)·w/|w|²` of the second. As products these are exact to round-off
/// over the angle of the lines, by which a wrong place hardly moves the nearest points. If one is
/// not on its segment, the nearest points are at an end of one of the two.
pub(super) fn segments((p, u): (Vec3, Vec3), (q, v): (Vec3, Vec3)) -> (Vec3, Vec3) {
    let (r, w) = (q - p, u.cross(&v));
    let square = w.norm_squared();
    if square > 0.0 {
        let s = r.cross(&v).dot(&w) / square;
        let t = r.cross(&u).dot(&w) / square;
        if s.abs() <= 1.0 && t.abs() <= 1.0 {
            return (p + u * s, q + v * t);
        }
    }
    let on = |x: Vec3, p: Vec3, u: Vec3| {
        let square = u.norm_squared();
        if square > 0.0 {
            p + u * ((x - p).dot(&u) / square).clamp(-1.0, 1.0)
        } else {
            p
        }
    };
    let mut best = (f64::INFINITY, p, q);
    let mut take = |x: Vec3, y: Vec3| {
        let distance = (x - y).norm_squared();
        if distance < best.0 {
            best = (distance, x, y);
        }
    };
    for sign in [1.0, -1.0] {
        take(p + u * sign, on(p + u * sign, q, v));
        take(on(q + v * sign, p, u), q + v * sign);
    }
    (best.1, best.2)
}
