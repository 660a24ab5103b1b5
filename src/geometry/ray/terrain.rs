//! Where a straight line meets terrain.
//!
//! Heights: the line goes from cell to cell; a cell whose surface cannot reach it is passed over,
//! in the others the first change of sign of the height over the surface is found by bisection.
//! A mesh: every triangle in the boxes that the line meets, from either side.

use super::line::Ray;
use crate::geometry::field::Field;
use crate::geometry::surface::Surface;
use crate::spatial::Vec3;
use crate::tuning::{RAY_BELOW, RAY_HALVINGS, RAY_PARTS};

/// The first point of a ray in the half-space z ≤ 0, not nearer than `near`.
pub(super) fn plane(ray: &Ray, near: f64) -> Option<f64> {
    let height = ray.origin.z + near * ray.along.z;
    if height <= 0.0 {
        return Some(near);
    }
    (ray.along.z < 0.0).then(|| -ray.origin.z / ray.along.z)
}

/// The first point of a ray at or below a surface of heights, not nearer than `near`.
pub(super) fn heights(field: &Field, ray: &Ray, near: f64) -> Option<f64> {
    let half = field.samples().size.map(|s| 0.5 * s);
    let (mut enter, mut exit) = (near, f64::INFINITY);
    for (axis, side) in half.iter().enumerate() {
        let (x, d) = (ray.origin[axis], ray.along[axis]);
        if d == 0.0 {
            if x.abs() > *side {
                return None;
            }
            continue;
        }
        let (a, b) = ((-side - x) / d, (side - x) / d);
        (enter, exit) = (enter.max(a.min(b)), exit.min(a.max(b)));
    }
    let top = field.top();
    if ray.along.z == 0.0 && ray.origin.z > top {
        return None;
    }
    // Where it comes down to the highest point, and where it would be above all.
    let level = (top - ray.origin.z) / ray.along.z;
    if ray.along.z < 0.0 {
        enter = enter.max(level);
        // What is below the lowest point is below the surface. A ray that is turned straight down
        // by a sensor's angles leaves the rectangle after 1e17 m, within which nothing is found.
        let below = field.bottom() - RAY_BELOW * field.reach();
        exit = exit.min(enter.max((below - ray.origin.z) / ray.along.z));
    } else if ray.along.z > 0.0 {
        exit = exit.min(level);
    }
    if enter > exit {
        return None;
    }
    let at = |t: f64| ray.origin + ray.along * t;
    let over = |t: f64| {
        let p = at(t);
        let (x, y) = (p.x.clamp(-half[0], half[0]), p.y.clamp(-half[1], half[1]));
        field
            .at(x, y)
            .map_or(f64::INFINITY, |local| p.z - local.height)
    };
    if over(enter) <= 0.0 {
        return Some(enter);
    }
    let cell = field.cell();
    let mut t = enter;
    while t < exit {
        // To the next line of samples.
        let p = at(t);
        let mut next = exit;
        for axis in 0..2 {
            let d = ray.along[axis];
            if d != 0.0 {
                let place = (p[axis] + half[axis]) / cell[axis];
                let line = if d > 0.0 {
                    libm::floor(place + 1e-9) + 1.0
                } else {
                    libm::ceil(place - 1e-9) - 1.0
                };
                let to = (line * cell[axis] - half[axis] - ray.origin[axis]) / d;
                if to > t {
                    next = next.min(to);
                }
            }
        }
        let middle = at(0.5 * (t + next));
        let low = p.z.min(at(next).z);
        if low <= field.highest(middle.x, middle.y, 0.0)
            && let Some(found) = first_root(&over, t, next)
        {
            return Some(found);
        }
        t = next;
    }
    None
}

/// The first place between two, of which the first is above the surface, where `over` is no longer
/// positive.
fn first_root(over: &impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    let mut above = from;
    for part in 1..=RAY_PARTS {
        let t = from + (to - from) * f64::from(part) / f64::from(RAY_PARTS);
        if over(t) <= 0.0 {
            let (mut low, mut high) = (above, t);
            for _ in 0..RAY_HALVINGS {
                let middle = 0.5 * (low + high);
                if over(middle) > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            return Some(high);
        }
        above = t;
    }
    None
}

/// The first point of a ray on the triangles of a mesh, not nearer than `near`.
pub(super) fn triangles(surface: &Surface, ray: &Ray, near: f64) -> Option<f64> {
    let mut least = f64::INFINITY;
    surface.each_along(&ray.origin, &ray.along, |facet, limit| {
        if let Some(t) = triangle(&facet.corners, ray)
            && t >= near
            && t < least
        {
            least = t;
            *limit = t;
        }
    });
    least.is_finite().then_some(least)
}

/// Source: Möller & Trumbore 1997; the distance is then that of the plane, which keeps its digits.
fn triangle([a, b, c]: &[Vec3; 3], ray: &Ray) -> Option<f64> {
    let (e, f) = (b - a, c - a);
    let n = e.cross(&f);
    let slope = n.dot(&ray.along);
    if slope == 0.0 {
        return None;
    }
    let p = ray.along.cross(&f);
    let det = e.dot(&p);
    let s = ray.origin - a;
    let u = s.dot(&p) / det;
    let v = ray.along.dot(&s.cross(&e)) / det;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    inside.then(|| -n.dot(&s) / slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::field::Samples;
    use crate::geometry::surface::Triangles;
    use crate::testing::Random;

    fn height(x: f64, y: f64) -> f64 {
        0.3 * libm::sin(4.0 * x) * libm::cos(3.0 * y)
    }

    /// Where a ray begins, looking roughly at the middle.
    fn ray(random: &mut Random) -> Ray {
        let origin = random.vector(2.0) + Vec3::z() * 1.5;
        let along = (random.vector(0.8) - origin).normalize();
        Ray { origin, along }
    }

    /// A sensor that looks down is turned by the double nearest to π/2, so that its ray leans by
    /// 6e-17. The truth is the surface's height at the place below.
    #[test]
    fn rays_straight_down_meet_the_height_below_them() {
        let mut random = Random(4);
        // Of flat ones the surface is where the search ends.
        for flat in std::iter::repeat_n(1.0, 30).chain([0.0]) {
            let lift = random.vector(1.0).x;
            let heights_of = (0..63).map(|_| lift + (1.0 - flat) * random.vector(1.0).x);
            let field = Field::try_from(Samples {
                size: [8.0, 6.0],
                counts: [9, 7],
                heights: heights_of.collect(),
            })
            .expect("a grid");
            for lean in [0.0, 6e-17, 1e-16, 1e-12, 1e-9] {
                for _ in 0..200 {
                    let place = random.vector(1.0);
                    let (x, y, z) = (3.9 * place.x, 2.9 * place.y, 20.0 + place.z);
                    let aside = random.unit();
                    let ray = Ray {
                        origin: Vec3::new(x, y, z),
                        along: Vec3::new(lean * aside.x, lean * aside.y, -1.0),
                    };
                    let expected = z - field.at(x, y).expect("on it").height;
                    let found = heights(&field, &ray, 0.0);
                    let found = found.unwrap_or(f64::INFINITY);
                    let error = (found - expected).abs();
                    // The place moves by the lean, on slopes of up to 4.
                    assert!(error < 1e-13 + 100.0 * lean, "{x} {y} {lean:e}: {error:e}");
                }
            }
        }
    }

    /// By small steps along the ray, then by halving: independent of cells.
    #[test]
    fn rays_meet_heights_where_small_steps_do() {
        let place = |i: u32, n: u32| f64::from(i) / f64::from(n) * 2.0 - 1.0;
        let samples = (0..=20).flat_map(|j| (0..=30).map(move |i| (i, j)));
        let field = Field::try_from(Samples {
            size: [2.0, 2.0],
            counts: [31, 21],
            heights: samples
                .map(|(i, j)| height(place(i, 30), place(j, 20)))
                .collect(),
        })
        .expect("a grid");
        let mut random = Random(21);
        let (mut hits, mut worst) = (0, 0.0_f64);
        for _ in 0..3000 {
            let ray = ray(&mut random);
            let below = |t: f64| {
                let p = ray.origin + ray.along * t;
                field.at(p.x, p.y).is_some_and(|local| p.z <= local.height)
            };
            let step = 5e-4;
            let expected = (0..14_000).map(|k| f64::from(k) * step).find(|t| below(*t));
            let found = heights(&field, &ray, 0.0);
            if let Some(high) = expected {
                let (mut low, mut high) = ((high - step).max(0.0), high);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if below(middle) {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                let found = found.expect("a hit");
                // A ray that grazes for less than a step is not seen by small steps.
                if found < high - 1e-9 {
                    assert!(below(found + 1e-12), "{found} {high}");
                } else {
                    hits += 1;
                    worst = worst.max((found - high).abs());
                }
            } else if let Some(found) = found {
                assert!(below(found + 1e-12), "{found}");
            }
        }
        assert!(hits > 1500 && worst < 1e-12, "{hits} {worst:e}");
    }

    /// Against a look at every triangle.
    #[test]
    fn rays_meet_meshes_where_a_look_at_every_triangle_does() {
        let mut random = Random(22);
        let corner = |random: &mut Random| random.vector(1.0);
        let list: Vec<[Vec3; 3]> = (0..400)
            .map(|_| {
                let a = corner(&mut random);
                [a, a + random.vector(0.3), a + random.vector(0.3)]
            })
            .collect();
        let surface = Surface::try_from(Triangles::new(&list)).expect("triangles");
        let mut hits = 0;
        for _ in 0..20_000 {
            let ray = ray(&mut random);
            let all = surface
                .facets()
                .iter()
                .filter_map(|f| triangle(&f.corners, &ray));
            let least = all.filter(|t| *t >= 0.2).fold(f64::INFINITY, f64::min);
            let expected = least.is_finite().then_some(least);
            assert_eq!(triangles(&surface, &ray, 0.2), expected);
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 5000, "{hits}");
    }
}
