//! The places of a surface of heights that are nearest to a point.

use crate::geometry::field::{Field, Local};
use crate::spatial::Vec3;
use crate::tuning::{MOST_NEAREST, NEAREST_IN_HOLLOW, ROUND_OFF, SEAM, TOO_FAR};

/// A place of the surface, m, and the normal there; at the end of the surface, of what is beyond
/// it, the direction from that place.
#[derive(Clone, Copy, Default)]
pub(super) struct Place {
    pub(super) at: Vec3,
    pub(super) n: Vec3,
}

/// Places of the surface that are nearer to a point than what is around them.
#[derive(Default)]
pub(super) struct Nearest {
    list: [Place; MOST_NEAREST],
    pub(super) count: usize,
}

impl Nearest {
    pub(super) fn add(&mut self, place: Place) {
        if self.count < MOST_NEAREST {
            self.list[self.count] = place;
            self.count += 1;
        }
    }

    pub(super) fn found(&self) -> &[Place] {
        &self.list[..self.count]
    }

    /// Those of a ball that may touch several places within `reach`, m, each once; none elsewhere.
    pub(super) fn in_hollow(field: &Field, c: &Vec3, radius: f64, reach: f64) -> Self {
        let mut nearest = Self::default();
        let around = radius + reach;
        if !field.is_hollow(c, radius, around) {
            return nearest;
        }
        let apart = Field::looks_apart(around);
        field.each_nearest(c, around + apart, |start| {
            let Some((place, left)) =
                nearest_from(field, c, start, (NEAREST_IN_HOLLOW, 0.5 * apart))
            else {
                return;
            };
            let is_new = |known: &Place| (known.at - place.at).norm() > 0.5 * apart;
            if left <= SEAM && nearest.found().iter().all(is_new) {
                nearest.add(place);
            }
        });
        nearest
    }
}

/// The place of the surface nearest to `c`, found from another place by Newton's method on
/// `x − c + (H − c_z) ∇H = 0` in so many looks at the surface, with no step longer than `most`, m;
/// and how long the last one was. None for what is beside the surface and not above its end, and
/// for what other terrain carries in which it goes on.
///
/// In a hollow that bends more than the ball the second derivatives count less, so that the matrix
/// stays definite and each step leads downhill. Over a crest that bends more than the ball a step
/// may go too far, because second derivatives change from cell to cell: where the ground rises
/// again behind it, the lowest place on the way is looked for before the next one.
pub(super) fn nearest_from(
    field: &Field,
    c: &Vec3,
    start: [f64; 2],
    (looks, most): (usize, f64),
) -> Option<(Place, f64)> {
    let half = field.samples().size.map(|s| 0.5 * s);
    let mut here = Foot::at(field, c, field.within(start))?;
    let (mut left, mut held) = (0.0, None);
    let mut look = 0;
    while look < looks {
        let way = here.step();
        let free = [0, 1].map(|k| here.x[k] - way[k].clamp(-most, most));
        let next = field.within(free);
        held = (next.map(f64::to_bits) != free.map(f64::to_bits)).then_some(free);
        let step = [0, 1].map(|k| next[k] - here.x[k]);
        left = step[0].abs().max(step[1].abs());
        if left <= ROUND_OFF * half[0].max(half[1]) {
            break;
        }
        let downhill = here.along(&step);
        // Both ends of what holds the lowest place: where, and the slope there.
        let (mut low, mut high) = ((0.0, downhill), (1.0, f64::NAN));
        let (mut t, mut kept) = (1.0, 0.0);
        let from = here.x;
        loop {
            here = Foot::at(field, c, [0, 1].map(|k| from[k] + t * step[k]))?;
            look += 1;
            let slope = here.along(&step);
            let beyond = t < 1.0 || slope > 0.0;
            let near = slope.abs() <= -TOO_FAR * downhill;
            if downhill >= 0.0 || !beyond || near || look >= looks {
                break;
            }
            // The Illinois method: an end that stays counts half.
            if slope > 0.0 {
                high = (t, slope);
                low.1 *= if kept > 0.0 { 0.5 } else { 1.0 };
                kept = 1.0;
            } else {
                low = (t, slope);
                high.1 *= if kept < 0.0 { 0.5 } else { 1.0 };
                kept = -1.0;
            }
            t = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
        }
    }
    let mut n = here.local.normal();
    let at = Vec3::new(here.x[0], here.x[1], here.local.height);
    let apart = c - at;
    let is_below = apart.dot(&n) <= 0.0;
    if let Some(free) = held {
        if field.goes_on(free) {
            return None;
        }
        if !is_below {
            n = apart.normalize();
        }
    }
    // What is beside the surface and below its tangent planes is in no ground: a place far away may
    // have a normal that leads there.
    if is_below && !field.is_over(c) {
        return None;
    }
    Some((Place { at, n }, left))
}

/// A place of the surface that is looked at.
struct Foot {
    x: [f64; 2],
    local: Local,
    /// Half of the first derivatives of the squared distance, m, and the height over the point
    /// from which it is looked for.
    rise: [f64; 2],
    over: f64,
}

impl Foot {
    fn at(field: &Field, c: &Vec3, x: [f64; 2]) -> Option<Self> {
        let local = field.at(x[0], x[1])?;
        let over = local.height - c.z;
        let rise = [0, 1].map(|k| x[k] - c[k] + over * local.slope[k]);
        Some(Self {
            x,
            local,
            rise,
            over,
        })
    }

    /// Half of the slope of the squared distance along a step.
    fn along(&self, step: &[f64; 2]) -> f64 {
        self.rise[0] * step[0] + self.rise[1] * step[1]
    }

    /// The step of Newton's method, turned round.
    fn step(&self) -> [f64; 2] {
        let [gx, gy] = self.local.slope;
        let [bxx, bxy, byy] = self.local.bend.map(|b| b * self.over);
        // Least eigenvalue of the second derivatives' part.
        let (mean, apart) = (0.5 * (bxx + byy), 0.5 * (bxx - byy));
        let least = mean - (apart * apart + bxy * bxy).sqrt();
        let part = if least < -0.75 { -0.75 / least } else { 1.0 };
        let (jxx, jyy) = (1.0 + gx * gx + part * bxx, 1.0 + gy * gy + part * byy);
        let jxy = gx * gy + part * bxy;
        let [fx, fy] = self.rise;
        let det = jxx * jyy - jxy * jxy;
        [(jyy * fx - jxy * fy) / det, (jxx * fy - jxy * fx) / det]
    }
}
