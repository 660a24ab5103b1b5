//! Springs between two points of bodies.
//!
//! With the vector `r` from the second point to the first one, its length `L` and direction `n`,
//! a spring pulls the first point by `T = k (L − L₀)` along `−n`, and its damper by `d L̇`.
//!
//! A step has one place for lever arms, and one line `n` there. The length is a coordinate of its
//! own: it begins as long as the spring is at the start of the step, and its rate at a time is
//! `n·u + δ`. Here `u` is the relative velocity of the points with the lever arms of that place,
//! and `δ` the drift: what `n·u` changes by until then because line and lever arms turn. So a
//! damper takes nothing from what turns about its other end. At the end of a part of `h` seconds
//! that begins with the length `L` and the displacement `s` from that place,
//!
//! ```text
//! f = −(k (L + h (n·u + w δ) − L₀) + d (n·u + δ)) n − a (1 − n nᵀ) (s + h u)
//! ```
//!
//! with `a = max(T/L, 0)` of the start of the step and `w = 1 − a/k`, which is the gradient of a
//! convex cost. A compressed spring that bows aside is left out of `a`, because it gives way. The
//! share `a/k` of a spring pulls as if its length without force were 0. This share is linear in
//! `r` and has no drift.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::Other;
use crate::kinematics::Kinematics;
use crate::spatial::{Mat3, Vec3, Vec6, add_force_at, add6, dot6, velocity_at};
use crate::tree::{Tree, TreeSpring};

/// A spring in a step.
#[derive(Clone, Debug)]
pub struct SpringTerm {
    /// Index in the tree's list.
    pub index: usize,
    /// Index of the body that it pulls, and what it hangs on; none: what does not move.
    pub body: usize,
    /// See `body`.
    pub other: Option<Other>,
    /// Its points, from O of the first body's tree, m.
    points: [Vec3; 2],
    /// From the second to the first where its points are, m.
    apart: Vec3,
    /// Length with which a part of a step begins, m.
    drawn: f64,
    /// Displacement of the first point then from there, as the second one sees it, m.
    aside: Vec3,
    /// Drift at the end of the part, m/s.
    drift: f64,
    /// Stiffness across the line, N/m.
    across: f64,
    /// m
    length: f64,
    /// N/m
    stiffness: f64,
    /// N·s/m
    damping: f64,
}

#[cfg(test)]
crate::spoil::spoil!(
    SpringTerm: index body other points apart drawn aside drift across length stiffness damping;
);

impl SpringTerm {
    /// As it stands in `kin`.
    pub fn new(tree: &Tree, kin: &Kinematics, index: usize, spring: &TreeSpring) -> Self {
        let [a, b] = spring.ends;
        let body = a.body.unwrap_or_default();
        let own = kin.origins[tree.bodies[body].tree];
        let point = kin.X[body].point(&a.X.p);
        let (place, from) = match b.body {
            Some(other) => {
                let from = own - kin.origins[tree.bodies[other].tree];
                (kin.X[other].point(&b.X.p) - from, from)
            }
            None => (b.X.p - own, Vec3::zeros()),
        };
        let moving = b.body.filter(|b| tree.bodies[*b].kind.moves());
        let apart = point - place;
        Self {
            index,
            body,
            other: moving.map(|other| Other {
                body: other,
                from,
                axes: Mat3::identity(),
            }),
            points: [point, place],
            apart,
            drawn: apart.norm(),
            aside: Vec3::zeros(),
            drift: 0.0,
            across: across(spring, apart.norm()),
            length: spring.length,
            stiffness: spring.stiffness,
            damping: spring.damping,
        }
    }

    /// Velocity or displacement of the first point as the second one sees it.
    #[inline]
    pub fn relative(&self, V: &[Vec6]) -> Vec3 {
        let own = velocity_at(&V[self.body], &self.points[0]);
        self.other.map_or(own, |other| {
            own - velocity_at(&other.seen(&V[other.body]), &self.points[1])
        })
    }

    /// Length, m, and unit vector to the first point; that is 0 where both points are one.
    pub fn line(&self) -> (f64, Vec3) {
        let length = self.apart.norm();
        let direction = self.apart.try_normalize(f64::MIN_POSITIVE);
        (length, direction.unwrap_or_default())
    }

    /// Tension without damping, N.
    fn tension(&self, length: f64) -> f64 {
        self.stiffness * (length - self.length)
    }

    /// Force on the first point at the relative velocity `u`, N.
    pub fn force(&self, u: &Vec3) -> Vec3 {
        let (length, n) = self.line();
        n * -(self.tension(length) + self.damping * n.dot(u))
    }

    /// Stiffness, N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Damping, N·s/m.
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// What of `u` lies along the line, times `factor`. Of a spring without a length all of it: it
    /// is as stiff across the line where it is short.
    pub fn along(&self, u: &Vec3, factor: f64) -> Vec3 {
        let (length, n) = self.line();
        if length > 0.0 {
            n * (factor * n.dot(u))
        } else {
            u * factor
        }
    }

    /// Share of the force that turns with the line, `w`.
    fn turning_share(&self) -> f64 {
        1.0 - self.across / self.stiffness.max(f64::MIN_POSITIVE)
    }

    /// `(h k + d) n nᵀ + h a (1 − n nᵀ)`, N·s/m.
    pub fn resistance(&self, h: f64) -> Mat3 {
        let (_, n) = self.line();
        let along = n * n.transpose();
        along * (h * self.stiffness + self.damping) + (Mat3::identity() - along) * (h * self.across)
    }

    /// Impulse on the first point in a part of `h` seconds that ends with the relative velocity
    /// `u`, N·s.
    #[inline]
    pub fn impulse(&self, u: &Vec3, h: f64) -> Vec3 {
        let (_, n) = self.line();
        let drifting = h * self.stiffness * self.turning_share() + self.damping;
        let along = self.tension(self.drawn) + drifting * self.drift;
        let beside = self.aside - n * n.dot(&self.aside);
        (n * along + beside * self.across + self.resistance(h) * u) * -h
    }

    /// Adds an impulse on the first point, and its reaction on the second one, to those on all
    /// bodies about O.
    #[inline]
    pub fn act(&self, impulse: &Vec3, F: &mut [Vec6]) {
        add_force_at(&mut F[self.body], &self.points[0], impulse);
        if let Some(other) = &self.other {
            let place = self.points[1] + other.from;
            add_force_at(&mut F[other.body], &place, &-impulse);
        }
    }

    /// Where it acts, from O of the first body's tree and from that of the second one's, m.
    pub fn places(&self) -> [Vec3; 2] {
        let from = self.other.map_or(Vec3::zeros(), |other| other.from);
        [self.points[0], self.points[1] + from]
    }

    /// Moves it by the displacement `way` of all bodies, and by what it drifts in `risen` seconds;
    /// its line and its points stay where they are.
    pub fn shift(&mut self, way: &[Vec6], risen: f64) {
        let (_, n) = self.line();
        let moved = self.relative(way);
        self.aside += moved;
        self.drawn += n.dot(&moved) + risen * self.turning_share() * self.drift;
    }

    /// Multiplies its drift.
    pub fn scale_drift(&mut self, share: f64) {
        self.drift *= share;
    }

    /// Sets the drift from where a step begins to here, and begins as long as it is there.
    ///
    /// - `start`: there
    /// - `before`: velocities of bodies there, with their motions here and with those there
    /// - `back`: displacement of bodies from here to there
    pub fn begin_at(&mut self, start: &Self, before: [&[Vec6]; 2], back: &[Vec6]) {
        let ((_, n), (length, n0)) = (self.line(), start.line());
        // A spring whose points pass each other is drawn along the other way.
        let n0 = if n.dot(&n0) < 0.0 { -n0 } else { n0 };
        self.across = start.across;
        self.drift = n.dot(&self.relative(before[0])) - n0.dot(&start.relative(before[1]));
        let linear = self.apart.norm() + n.dot(&self.relative(back));
        self.drawn += self.turning_share() * (length - linear);
    }

    /// Angle, rad, by which what it pulls turns between two displacements from the place of the
    /// step. The line of a damper has no sense.
    pub fn turned(&self, ends: [Vec3; 2]) -> f64 {
        let direction = |end: Vec3| (self.apart + end).try_normalize(f64::MIN_POSITIVE);
        let [one, two] = ends.map(|end| direction(end).unwrap_or_default());
        let angle = (one - two).norm();
        let damped = if self.damping > 0.0 {
            angle.min((one + two).norm())
        } else {
            0.0
        };
        damped.max(self.turning_share() * angle)
    }

    /// Displacement from the place of the step with which its part begins, m.
    pub fn aside(&self) -> Vec3 {
        self.aside
    }

    /// Energy that it holds, J.
    pub fn stored(&self) -> f64 {
        let stretch = self.apart.norm() - self.length;
        0.5 * self.stiffness * stretch * stretch
    }
}

/// Stiffness of a spring across its line where it is so long, N/m.
fn across(spring: &TreeSpring, length: f64) -> f64 {
    let tension = spring.stiffness * (length - spring.length);
    if tension > 0.0 && length > 0.0 {
        tension / length
    } else if length == 0.0 && spring.length == 0.0 {
        spring.stiffness
    } else {
        0.0
    }
}

/// Energy that all springs that a step works on hold at the poses of `kin`, J.
pub fn held_by_springs(tree: &Tree, kin: &Kinematics) -> f64 {
    let springs = tree.worked_springs();
    springs
        .map(|(index, spring)| SpringTerm::new(tree, kin, index, spring).stored())
        .sum()
}

/// Adds the forces of all springs that a step works on, at the poses and velocities of `kin`, along
/// each degree of freedom.
///
/// - `F`: scratch, one a body
pub fn push_springs(tree: &Tree, kin: &Kinematics, F: &mut [Vec6], effort: &mut [f64]) {
    if tree.springs.is_empty() {
        return;
    }
    F.fill([0.0; 6]);
    for (index, spring) in tree.worked_springs() {
        let spring = SpringTerm::new(tree, kin, index, spring);
        spring.act(&spring.force(&spring.relative(&kin.V)), F);
    }
    pull_back(tree, kin, F, effort);
}

/// Adds what forces on bodies do along each degree of freedom.
///
/// - `F`: one a body; those of what hangs on it are added
pub fn pull_back(tree: &Tree, kin: &Kinematics, F: &mut [Vec6], effort: &mut [f64]) {
    for (b, body) in tree.worked_bodies().rev() {
        let own = F[b];
        for c in body.column..body.column + body.columns {
            effort[tree.dof[c]] += dot6(&kin.S[c], &own);
        }
        if !body.kind.is_base() {
            add6(&mut F[body.parent], &own);
        }
    }
}
