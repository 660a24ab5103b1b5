//! What a ball, or the end of a capsule, has of its share on each of the planes that it lies on in
//! a hollow.
//!
//! In a groove a point lies on both sides with all of its share. On ground that is bent slightly,
//! as a pipe of many triangles is, both sides are one ground, and with all of its share on each of
//! them what rolls there would be carried twice at every edge: it would be thrown up by half of its
//! depth, and lose that.
//!
//! 1. How far a plane stands out is what the shape is less deep between it and another one than on
//!    it: with the heights `h₁` and `h₂` of its middle over both, whose normals are at the angle
//!    `φ`, the distance to the line that they have in common is
//!    `√(h₁² + h₂² − 2 h₁ h₂ cos φ)/sin φ`, and it stands out by that less `h₁`. Where both are as
//!    deep that is `h₁ (1/cos(φ/2) − 1)`.
//! 2. The deepest plane has all of the share, and another one as much of it as it would stand out
//!    from a deeper one where both are as deep, in blends: by the angle alone, so that what it has
//!    does not change where something moves along both sides of a groove.
//! 3. Where two are as deep as each other, both have the same: what they have is divided evenly as
//!    far as they are nearer to each other than to what is between them. So nothing jumps where the
//!    one becomes deeper than the other. See also `ring/turns.rs`.
//!
//! The round end of a cylinder that leans is bent otherwise, and corners lie on two planes only as
//! far as they are deep: they have all of their share on each.

use crate::spatial::Vec3;

/// A plane that a point lies on.
#[derive(Clone, Copy)]
pub(super) struct Side {
    pub(super) normal: Vec3,
    /// Of the middle over it, m.
    pub(super) height: f64,
    /// m
    pub(super) depth: f64,
}

impl Side {
    /// How far it stands out from another one, m: where it is, and where both are as deep.
    fn stands_out(&self, other: &Self) -> [f64; 2] {
        let along = self.normal.dot(&other.normal);
        let across = self.normal.cross(&other.normal).norm();
        let (a, b) = (self.height, other.height);
        let line = (a * a + b * b - 2.0 * a * b * along).max(0.0).sqrt();
        // Of planes that do not meet nothing is between.
        if across > 0.0 {
            let middle = a * ((2.0 / (1.0 + along)).sqrt() - 1.0);
            [line / across - a, middle].map(|out| out.max(0.0))
        } else {
            [f64::INFINITY; 2]
        }
    }
}

/// Which part of its share the point has on `side`, one of `all`.
pub(super) fn part(side: usize, all: impl Iterator<Item = Side> + Clone, blend: f64) -> f64 {
    let by_depth = |a: &(usize, Side), b: &(usize, Side)| {
        // Of equal ones the first.
        a.1.depth.total_cmp(&b.1.depth).then(b.0.cmp(&a.0))
    };
    let listed = all.enumerate();
    let Some(top) = listed.clone().max_by(by_depth) else {
        return 1.0;
    };
    // What one that is not the deepest has, and how much of it is the deepest one's.
    let shared = |this: (usize, Side)| {
        let deeper = listed
            .clone()
            .filter(|other| by_depth(other, &this).is_gt());
        let [least, alike] = deeper.fold([f64::INFINITY; 2], |least, (_, other)| {
            let out = this.1.stands_out(&other);
            [least[0].min(out[0]), least[1].min(out[1])]
        });
        let own = (alike / blend).min(1.0);
        let apart = top.1.depth - this.1.depth;
        let alike = if least > 0.0 {
            (1.0 - apart / least).max(0.0)
        } else {
            0.0
        };
        let moved = 0.5 * (1.0 - own) * alike;
        [own + moved, moved]
    };
    if side == top.0 {
        let others = listed.clone().filter(|(i, _)| *i != top.0);
        let moved: f64 = others.map(|this| shared(this)[1]).sum();
        return (1.0 - moved).max(0.0);
    }
    listed.clone().nth(side).map_or(1.0, |this| shared(this)[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of 0.1 m, so deep in the planes of an edge of so many radians, `x` beside the middle.
    fn parts(angle: f64, x: f64, blend: f64) -> [f64; 2] {
        let (radius, depth) = (0.1, 5e-5);
        let sides = [-0.5, 0.5].map(|half| {
            let normal = Vec3::new(-libm::sin(half * angle), 0.0, libm::cos(half * angle));
            let high = (radius - depth) / libm::cos(0.5 * angle);
            let height = normal.dot(&Vec3::new(x, 0.0, high));
            Side {
                normal,
                height,
                depth: radius - height,
            }
        });
        [0, 1].map(|side| part(side, sides.into_iter(), blend))
    }

    /// By the symmetry of the middle, and because nothing is between the sides of flat ground.
    #[test]
    fn a_slight_bend_carries_once_and_a_groove_twice() {
        for angle in [1e-3, 0.01, 0.03] {
            let [a, b] = parts(angle, 0.0, 1e-3);
            assert!(
                (a - b).abs() < 1e-9 && (a + b - 1.0).abs() < 0.02,
                "{angle}: {a} {b}"
            );
            let all = parts(angle, 0.05 * angle, 1e-3);
            assert!(all[1] > 0.98 && all[0] < 0.02, "{angle}: {all:?}");
            let mut last = parts(angle, -0.05 * angle, 1e-3);
            for i in -99..=100 {
                let next = parts(angle, 5e-4 * f64::from(i) * angle, 1e-3);
                assert!(
                    (next[1] - last[1]).abs() < 0.1,
                    "{angle} {i}: {next:?} {last:?}"
                );
                assert!(
                    (next[0] + next[1] - 1.0).abs() < 0.02,
                    "{angle} {i}: {next:?}"
                );
                last = next;
            }
        }
        let groove = parts(1.5, 0.0, 1e-3);
        assert!(groove.iter().all(|part| (part - 1.0).abs() < 1e-12));
    }
}
