//! The point of a segment or of a triangle that is nearest to another point.

use crate::spatial::Vec3;

/// The point of the segment `a b` nearest to `p`.
pub(super) fn on_segment(p: &Vec3, a: &Vec3, b: &Vec3) -> Vec3 {
    let ab = b - a;
    let length = ab.norm_squared();
    if length <= 0.0 {
        return *a;
    }
    a + ab * ((p - a).dot(&ab) / length).clamp(0.0, 1.0)
}

/// The point of the triangle nearest to `p`.
pub(super) fn on_triangle(p: &Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let normal = (b - a).cross(&(c - a));
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(s, e)| (e - s).cross(&(p - s)).dot(&normal) >= 0.0);
    if inside && normal.norm_squared() > 0.0 {
        return p - normal * (normal.dot(&(p - a)) / normal.norm_squared());
    }
    let nearest = |s: &Vec3, e: &Vec3| on_segment(p, s, e);
    let candidates = [nearest(&a, &b), nearest(&b, &c), nearest(&c, &a)];
    let distance = |x: &Vec3| (p - x).norm_squared();
    candidates
        .into_iter()
        .min_by(|x, y| distance(x).total_cmp(&distance(y)))
        .unwrap_or(a)
}
