//! Springs between two points of bodies.
//!
//! With the vector `r` from the second point to the first one, its length `L` and direction `n`,
//! a spring pulls the first point by `T = k (L − L₀)` along `−n`, and its damper by `d n·ṙ`. At the
//! end of a step of `h` seconds with the relative velocity `u` of the points, to first order,
//!
//! ```text
//! f = −(T n + (h K + d n nᵀ) u),    K = k n nᵀ + max(T/L, 0) (1 − n nᵀ)
//! ```
//!
//! which is the gradient of a convex cost: a compressed spring that bows aside is left out of `K`,
//! because it gives way.

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
    /// From the second to the first, m.
    apart: Vec3,
    /// m
    length: f64,
    /// N/m
    stiffness: f64,
    /// N·s/m
    damping: f64,
}

#[cfg(test)]
crate::spoil::spoil!(SpringTerm: index body other points apart length stiffness damping;);

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
        Self {
            index,
            body,
            other: moving.map(|other| Other {
                body: other,
                from,
                axes: Mat3::identity(),
            }),
            points: [point, place],
            apart: point - place,
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

    /// `h K + d n nᵀ`, N·s/m.
    pub fn resistance(&self, h: f64) -> Mat3 {
        let (length, n) = self.line();
        let along = n * n.transpose();
        let tension = self.tension(length);
        let across = if tension > 0.0 && length > 0.0 {
            tension / length
        } else if length == 0.0 && self.length == 0.0 {
            self.stiffness
        } else {
            0.0
        };
        along * (h * self.stiffness + self.damping) + (Mat3::identity() - along) * (h * across)
    }

    /// Impulse on the first point in a step of `h` seconds that ends with the relative velocity
    /// `u`, N·s.
    #[inline]
    pub fn impulse(&self, u: &Vec3, h: f64) -> Vec3 {
        let (length, n) = self.line();
        (n * self.tension(length) + self.resistance(h) * u) * -h
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

    /// Moves it by the displacement `way` of all bodies; its points stay where they act.
    pub fn shift(&mut self, way: &[Vec6]) {
        self.apart += self.relative(way);
    }

    /// Energy that it holds, J.
    pub fn stored(&self) -> f64 {
        let stretch = self.apart.norm() - self.length;
        0.5 * self.stiffness * stretch * stretch
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

impl SpringTerm {
    /// Squared angular frequency, rad²/s², and rate, 1/s, with which the spring and its damper move
    /// what hangs on them.
    pub fn rates(&self, tree: &Tree, kin: &Kinematics) -> [f64; 2] {
        let (length, n) = self.line();
        let mut mobility = 0.0;
        let places = self.places();
        let bodies = [Some(self.body), self.other.map(|other| other.body)];
        for (body, x) in bodies.into_iter().zip(&places) {
            let Some(body) = body else { continue };
            for c in tree.columns_to(body) {
                let v = velocity_at(&kin.S[c], x);
                // Across the line the spring is as stiff where it is short.
                let along = if length > 0.0 {
                    n.dot(&v) * n.dot(&v)
                } else {
                    v.norm_squared()
                };
                mobility += along * kin.inverse_diagonal[tree.dof[c]];
            }
        }
        [self.stiffness * mobility, self.damping * mobility]
    }
}
