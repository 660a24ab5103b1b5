//! What a line meets of a surface.

use super::{Facet, Node, SAME, STACK, Surface};
use crate::spatial::Vec3;
use crate::tuning::SEAM;

impl Surface {
    /// Calls `take` with the triangles whose boxes a line meets between its beginning and a limit,
    /// m along it, which `take` may lower.
    pub fn each_along<'a>(
        &'a self,
        origin: &Vec3,
        along: &Vec3,
        mut take: impl FnMut(&'a Facet, &mut f64),
    ) {
        let mut limit = f64::INFINITY;
        let line = Line::new(origin, along);
        // The nearer one of two boxes first: what is behind a triangle is then never opened.
        let mut stack = [(0_usize, 0.0_f64); STACK];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (index, enter) = stack[count];
            if enter > limit {
                continue;
            }
            let node = &self.boxes[index];
            if node.leaf {
                for &facet in &self.order[node.next[0]..node.next[1]] {
                    take(&self.facets[facet], &mut limit);
                }
                continue;
            }
            let enters = node.next.map(|next| line.enter(&self.boxes[next]));
            let nearer = usize::from(enters[1] < enters[0]);
            for child in [1 - nearer, nearer] {
                if enters[child].is_finite() && enters[child] <= limit {
                    stack[count] = (node.next[child], enters[child]);
                    count += 1;
                }
            }
        }
    }

    /// Whether a line from a place in front of the surface to another one ends behind it: it goes
    /// through triangles from their front more often than from their back, as into one of two
    /// solids that go through each other and out of the other one; or from their front at last, as
    /// through a sheet that is drawn from both sides.
    pub fn is_within(&self, from: &Vec3, to: &Vec3) -> bool {
        let along = to - from;
        let length = along.norm();
        let (mut within, mut last, mut enters) = (0_i32, f64::NEG_INFINITY, false);
        self.each_along(from, &along, |facet, limit| {
            *limit = limit.min(1.0);
            let [before, after] = [from, to].map(|x| facet.height(x));
            let through = before / (before - after);
            if (before > 0.0) == (after > 0.0) || !facet.is_over(&(from + along * through)) {
                return;
            }
            let (way, front) = (through * length, before > 0.0);
            within += if front { 1 } else { -1 };
            if way > last - SEAM {
                enters = front || enters && way <= last + SEAM;
                last = last.max(way);
            }
        });
        within > 0 || enters
    }
}

/// A line from its beginning on, ready for many boxes.
struct Line<'a> {
    origin: &'a Vec3,
    /// One over its direction.
    inverse: Vec3,
    /// By how much boxes are wider than they are, for round-off, m.
    slack: Vec3,
}

impl<'a> Line<'a> {
    fn new(origin: &'a Vec3, along: &Vec3) -> Self {
        Self {
            origin,
            inverse: along.map(|d| 1.0 / d),
            slack: origin.map(|x| SAME * (1.0 + x.abs())),
        }
    }

    /// Where it enters a box, m along it; infinity if it does not. Along an axis in which it does
    /// not go, the quotients are infinite, and not a number, which bounds nothing, on the side.
    fn enter(&self, node: &Node) -> f64 {
        let low = (node.low - self.slack - self.origin).component_mul(&self.inverse);
        let high = (node.high + self.slack - self.origin).component_mul(&self.inverse);
        let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (a, b) = (low[axis], high[axis]);
            (enter, exit) = (enter.max(a.min(b)), exit.min(a.max(b)));
        }
        if enter <= exit { enter } else { f64::INFINITY }
    }
}
