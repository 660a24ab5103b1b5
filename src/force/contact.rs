//! Contact of two bodies over an area: one stiffness, one friction, one memory for a pair of
//! shapes.
//!
//! A face that stands on the ground presses with few points, its corners or its rim, but they are
//! one contact: how deep it is under a load depends on the load, not on the number of points.
//!
//! # Normal force
//!
//! 1. With the spatial velocity `W` at the end of a step of `h` seconds, point `i` is
//!    `d_i = D_i − h y_i` deep: `D_i` at the start, and `y_i` its velocity along the normal.
//! 2. The contact is `δ = (Σ m_i (d_i)₊⁴)^¼` deep, with the share `m_i` of the point in a face;
//!    they sum up to one, so that a face whose points are equally deep is as deep as they are.
//!    Where no point is inside, `δ = max d_i`. A norm of convex functions is convex.
//! 3. The force is `N(δ) = F(δ) (1 + D δ̇)₊`, with the spring `F` of [`Stiffening`], the
//!    dissipation `D` of Hunt & Crossley and `δ̇ = (δ − δ₀)/h`, where `δ₀` is the depth at the
//!    start; deep overlaps leave otherwise, see [`Damping`]. It rises with `δ`, so the cost
//!    `∫ N dδ` is convex.
//! 4. With `w_i = ∂δ/∂d_i = m_i (d_i/δ)³` point `i` pushes with `N w_i`.
//! 5. `δ` alone does not feel a face rock about its middle, nor one corner touch down while others
//!    leave. Each point is therefore damped against the mean of all, `ȳ = Σ ŵ_i y_i` with `ŵ =
//!    w/Σw` and the load `L` of the start, with damping where that takes from it: the cost `h L Σ
//!    ŵ_i Ψ(y_i − ȳ)` has no net force. With `Ψ' = ψ(z) = min(D z, 1)` each point has Hunt &
//!    Crossley's damping of its own share of the load, and one that leaves loses no more than this
//!    share. The flat face of a cylinder, which has one point, is damped by `½ c χ² ȧ` against
//!    tilting (see below), as an even load on a disc would, with `c = D L/(1 + D |ȧ|)` of the
//!    start.
//!
//! # Rims
//!
//! The face of a cylinder has one point, the lowest of its rim. With the axis `k`, the radius `R`,
//! the rim's centre `D_c` deep, and `a = R (k − (k·n) n)`, that point is `D_c + |a|` deep. A crown
//! `s` makes this smooth: `D = D_c + q − s` with `q = √(|a|² + s²)`; `χ = s²/q²` is 1 where the
//! face is flat on the ground. `q` is convex in `a`, so `D` is convex in `W` if `a` moves linearly.
//! In the step it moves by `ȧ = R T (ω × k)`, with
//!
//! ```text
//! T = (b² P + a aᵀ)/(b² + |a|²),    P = 1 − n nᵀ
//! ```
//!
//! so that tilting counts, and the precession of a rim that leans by more than `b/R` does not: it
//! moves `a` along a circle, not along its tangent, and the lowest point not along the normal. But
//! the direction of a small lean swings about that of the load, because turning it takes hardly any
//! motion: rolling on the rim, the load `N` turns it back by the moment `N R` and a lean of `|a|/R`
//! has the inertia `I (a/R)²` for this, so it swings with `ω² = N R²/(I |a|)`, with `I = ½ m R²`
//! `ω² = 2 N/(m |a|)`. Where that is faster than the step, `h ω > 1`, the direction must be that at
//! the end of the step: `b = 2 h² N/m`, at least the crown. The point's place is
//! `c + R (n·k) a/q − n |a|²/q`; there `y = y_c − e₀·ȧ` with `e₀ = a/q` at the start, hence
//! `d = D − h (y + e₀·ȧ) + q(a + h ȧ) − q(a)`.
//!
//! # Friction
//!
//! One elasto-plastic element acts on the 3-vector `u = v_t(c) + ρ (n·ω) n`: the tangential
//! velocity at the centre `c = Σ ŵ_i x_i` of the load, and the drilling velocity times the mean
//! distance `ρ` of the load from it. Sliding and drilling share the cap `μ Σ N w_i` as the points
//! of an even pressure do together, see [`crate::law::face`].
//!
//! Its stiffness `k_t` is in proportion to `dN/dδ`, so it changes with the load. With the same
//! displacement `ς` the energy `½ k_t ς²` would change with it, and nobody would pay. So from step
//! to step `√k_t ς` is remembered, whose energy stays: a rising load raises the force `k_t ς` by
//! the root of the stiffness, and a falling one takes that back.
//!
//! Source: Hunt & Crossley 1975; Castro et al. 2022.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]
use super::point::{ContactPoint, PointResponse, PointVelocity};
use super::spread::Oblong;
use crate::law::normal::Stiffening;
use crate::law::{Damping, ElastoPlastic, Face, Resistance};
use crate::spatial::{Mat3, Vec3, Vec6, angular, velocity_at};
use crate::tuning::ADVANCE;
use std::ops::Range;

/// What a contact gives for a velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct Response {
    /// Depth `δ` at the end of the step, m.
    pub depth: f64,
    /// `N`.
    pub force: f64,
    /// `dN/dδ` with the velocity that changes it, N/m.
    pub slope: f64,
    /// Normal impulse `h N Σ w_i`, N·s.
    pub load: f64,
    /// Friction; its slope in N·s/m.
    pub friction: Resistance<Vec3>,
}

impl Response {
    /// Whether it pushes.
    #[inline]
    pub fn presses(&self) -> bool {
        self.force > 0.0
    }

    /// Whether friction slips.
    #[inline]
    pub fn slips(&self) -> bool {
        self.friction.slip != Vec3::zeros()
    }
}

/// The body on the other side of a contact.
#[derive(Clone, Copy, Debug)]
pub struct Other {
    /// Its index.
    pub body: usize,
    /// O of the tree of the first body, seen from O of this one's, m, world axes.
    pub from: Vec3,
    /// Its axes in the world: what friction remembers turns with it.
    pub axes: Mat3,
}

impl Other {
    /// A velocity or displacement of the body, about O of the first one's tree.
    #[inline]
    pub fn seen(&self, V: &Vec6) -> Vec6 {
        let v = velocity_at(V, &self.from);
        [V[0], V[1], V[2], v.x, v.y, v.z]
    }
}

/// A contact in a step: what was found at its start, constant while the step is solved.
#[derive(Clone, Debug, Default)]
pub struct Contact {
    /// Index of the body that it pushes along the normal.
    pub body: usize,
    /// The body that it pushes against; none: the ground, or something else that does not move.
    pub other: Option<Other>,
    /// Index of the link, for outputs, and of the other one.
    pub link: usize,
    /// See `link`; none for the ground.
    pub other_link: Option<usize>,
    /// Place of its memory in the state: the index of the shape, or of the pair of shapes after
    /// those of all shapes.
    pub slot: usize,
    /// Half of the least extent of the thinner of its two shapes, m; of a ball, which may be a
    /// point, and another one the mean of both: the middles pass each other at twice this depth.
    /// Infinite with the ground.
    pub thickness: f64,
    /// Mass that takes part: that of the body's tree, reduced by that of the other one, kg; of that
    /// the share that its spring has, see [`crate::geometry::pair::Patch::share`].
    pub mass: f64,
    /// Unit vector from the ground or the other body into the body.
    pub normal: Vec3,
    /// Whether its points have rows of their own: `normal` is the mean of their normals.
    pub uneven: bool,
    /// Its points in [`super::ContactSet::points`].
    pub points: Range<usize>,
    /// Depth `δ₀`, m.
    pub depth: f64,
    /// Sum of `∂δ₀/∂d_i`; 1 where none is inside.
    pub weights: f64,
    /// Spring of the normal force, or its share.
    pub spring: Stiffening,
    /// Damping of that force.
    pub damping: Damping,
    /// Load `L` at the start that rocking is damped by, N.
    pub load: f64,
    /// Damping `c` of a tilting rim, N·s/m.
    pub tilting: f64,
    /// Dissipation that its restitution needs, s/m; 0 without restitution.
    pub bounce: f64,
    /// Time scale of its bounce, s.
    pub duration: f64,
    /// Centre of the load, from O, m, world axes.
    pub center: Vec3,
    /// Mean distance of the load from it, m.
    pub radius: f64,
    /// How the load is spread about it.
    pub oblong: Oblong,
    /// What spring and damper of friction give at the start of the step, N.
    pub pull: Vec3,
    /// What `u` is more than the step's lever arms say, because the contact has turned since they
    /// were found, m/s.
    pub drift: Vec3,
    /// The same for the velocities of its points along their normals, m/s.
    pub rise: f64,
    /// How fast its depth grows by what a secant has added to its rows, m/s, which is not damped.
    pub bent: f64,
    /// What the sliding velocity is more because a surface moves, m/s: tangential.
    pub carried: Vec3,
    /// Share of its friction that it has: less than 1 of a deep overlap.
    pub rubbing: f64,
    /// Coulomb coefficient at the speed of the slip at the start of the step.
    pub mu: f64,
    /// Torsional and rolling friction of both surfaces, m.
    pub turning: [f64; 2],
    /// Critical damping of its friction for the load at the start, N·s/m.
    pub critical: f64,
    /// Damping of its friction over the normal force in an impact, s/m.
    pub dissipation: f64,
    /// See [`ElastoPlastic::wound`], m/s; 0 where friction is not higher at rest.
    pub wound: f64,
    /// Friction in the tangent plane, and along the normal against drilling; world axes. It slips
    /// at `μ` times a normal force that is known: that at the start of the step, until a solve has
    /// found one.
    pub friction: ElastoPlastic<Vec3, Face>,
}

impl Contact {
    /// Spatial velocity of its body against that of the other one, where `V` are those of all.
    #[inline]
    pub(crate) fn relative(&self, V: &[Vec6]) -> Vec6 {
        let v = V[self.body];
        self.other.map_or(v, |other| {
            let w = other.seen(&V[other.body]);
            std::array::from_fn(|i| v[i] - w[i])
        })
    }

    /// Velocities of its points.
    #[inline]
    pub fn velocities<'a>(
        &'a self,
        points: &'a [ContactPoint],
        V: &[Vec6],
    ) -> impl Iterator<Item = PointVelocity> + 'a {
        self.velocities_with(points, self.relative(V))
    }

    /// The same for the velocity `W` of its body against the other one.
    #[inline]
    pub(super) fn velocities_with<'a>(
        &'a self,
        points: &'a [ContactPoint],
        W: Vec6,
    ) -> impl Iterator<Item = PointVelocity> + 'a {
        let w = angular(&W);
        points[self.points.clone()]
            .iter()
            .map(move |p| PointVelocity {
                along: p.along(&W),
                tilt: match &p.rim {
                    Some(rim) => rim.rate(&p.normal, &w),
                    None => Vec3::zeros(),
                },
            })
    }

    /// Velocity of the load's centre along the normal, m/s, positive apart; of the deepest point
    /// where none is inside.
    pub fn normal_velocity(&self, points: &[ContactPoint], V: &[Vec6]) -> f64 {
        let W = self.relative(V);
        let along = |p: &ContactPoint| p.along(&W);
        let own = &points[self.points.clone()];
        if self.depth > 0.0 {
            own.iter().map(|p| p.load * along(p)).sum()
        } else {
            let deeper = |a: &&ContactPoint, b: &&ContactPoint| a.depth.total_cmp(&b.depth);
            own.iter().rev().max_by(deeper).map_or(0.0, along)
        }
    }

    /// How fast its rims tilt, m/s.
    pub(super) fn tilt_speed(&self, points: &[ContactPoint], V: &[Vec6]) -> f64 {
        let w = angular(&self.relative(V));
        let own = points[self.points.clone()].iter();
        let speeds = own.filter_map(|p| Some(p.load * p.rim?.rate(&self.normal, &w).norm()));
        speeds.sum()
    }

    /// Longest step, s, in which the shapes come nearer by no more than [`ADVANCE`] of their
    /// thickness: what is expected in its middle still lies on the side that it has come from.
    /// Infinite where they do not come nearer, or not yet touch in `h` seconds.
    pub fn longest_step(&self, points: &[ContactPoint], V: &[Vec6], h: f64) -> f64 {
        let W = self.relative(V);
        let own = points[self.points.clone()].iter();
        own.fold(f64::INFINITY, |least, p| {
            let approach = -p.along(&W);
            if approach > 0.0 && p.depth + h * approach > 0.0 {
                least.min(ADVANCE * self.thickness / approach)
            } else {
                least
            }
        })
    }

    /// Time until the first of its points touches with these velocities, s; infinite if none comes
    /// nearer.
    pub fn time_to_touch(&self, points: &[ContactPoint], V: &[Vec6]) -> f64 {
        let W = self.relative(V);
        points[self.points.clone()]
            .iter()
            .fold(f64::INFINITY, |soonest, p| {
                let approach = -p.along(&W);
                if approach > 0.0 {
                    soonest.min(-p.depth / approach)
                } else {
                    soonest
                }
            })
    }

    /// Force of the spring with its damping, N, and its derivative with the depth, at the depth
    /// `depth` that grows at `rate`; `h`: time in which a change of the depth changes the rate.
    #[inline]
    pub(super) fn normal_force(&self, depth: f64, rate: f64, h: f64) -> (f64, f64) {
        let (damping, change) = self.damping.factor(rate);
        if depth <= 0.0 || damping <= 0.0 {
            return (0.0, 0.0);
        }
        let elastic = self.spring.force(depth);
        let slope = self.spring.slope(depth) * damping + elastic * change / h;
        (elastic * damping, slope)
    }

    /// Response to the velocities at the end of a step of `h` seconds: `u` of friction, none if
    /// that is found later, `at` of the points.
    #[inline]
    pub fn response(
        &self,
        points: &[ContactPoint],
        u: Option<&Vec3>,
        at: impl Fn(usize) -> PointVelocity,
        h: f64,
        out: &mut Vec<PointResponse>,
    ) -> Response {
        let own = &points[self.points.clone()];
        let first = out.len();
        let (mut deepest, mut sum, mut rise, mut mean) = (f64::NEG_INFINITY, 0.0, 0.0, 0.0);
        for (i, p) in own.iter().enumerate() {
            let v = at(i);
            let mut r = PointResponse::default();
            let mut change = -h * (v.along + self.rise);
            if let Some(rim) = &p.rim {
                let tilted = rim.tilted(&(v.tilt * h));
                change += tilted.deeper;
                r.end = tilted.end;
                r.lean = rim.direction() - tilted.end.0;
                let damping = h * self.tilting * p.load * rim.tilt_damping;
                r.tilting = v.tilt * -damping;
            }
            // Until the mean is known.
            r.rock = v.along;
            mean += p.load * v.along;
            let depth = p.depth + change;
            r.weight = depth;
            out.push(r);
            deepest = deepest.max(depth);
            let (before, after) = (p.depth.max(0.0), depth.max(0.0));
            let change = if p.depth > 0.0 && depth > 0.0 {
                change
            } else {
                after - before
            };
            let (squared, before_squared) = (after * after, before * before);
            sum += p.share * squared * squared;
            rise += p.share * change * (after + before) * (squared + before_squared);
        }
        let friction = u.map_or_else(Resistance::default, |u| self.rub(u, h));
        if deepest <= 0.0 || deepest.is_nan() {
            for (p, r) in own.iter().zip(&mut out[first..]) {
                r.weight = 0.0;
                self.rock(p, mean, r);
            }
            Self::balance(own, h, &mut out[first..]);
            return Response {
                depth: deepest,
                friction,
                ..Response::default()
            };
        }
        let depth = sum.sqrt().sqrt();
        // `δ − δ₀` by the fourth powers: it may have fewer digits than both.
        let change = if self.depth > 0.0 {
            rise / ((depth + self.depth) * (depth * depth + self.depth * self.depth))
        } else {
            depth - self.depth
        };
        let (force, slope) = self.normal_force(depth, change / h - self.bent, h);
        let mut weights = 0.0;
        for (p, r) in own.iter().zip(&mut out[first..]) {
            let part = r.weight.max(0.0) / depth;
            r.bend = 3.0 * p.share * part * part / depth;
            r.weight = p.share * part * part * part;
            weights += r.weight;
            r.impulse = h * force * r.weight;
            if p.rim.is_some() {
                r.tilting += r.lean * r.impulse;
            }
            self.rock(p, mean, r);
        }
        Self::balance(own, h, &mut out[first..]);
        Response {
            depth,
            force,
            slope,
            load: h * force * weights,
            friction,
        }
    }

    /// Friction over `h` seconds at the velocity `u`.
    #[inline]
    pub(super) fn rub(&self, u: &Vec3, h: f64) -> Resistance<Vec3> {
        self.friction.respond(self.slid(u), h)
    }

    /// Puts the damping of rocking into the response of a point, whose velocity stands in its
    /// place; `mean` is that of all.
    #[inline]
    fn rock(&self, point: &ContactPoint, mean: f64, r: &mut PointResponse) {
        let (force, slope) = self.rocking(r.rock - mean);
        (r.rock, r.rocking) = (force * point.load, slope * point.load);
    }

    /// `L ψ(z)` and its slope.
    #[inline]
    pub(super) fn rocking(&self, z: f64) -> (f64, f64) {
        let dissipation = self.damping.dissipation;
        let damping = dissipation * z;
        if damping > 1.0 {
            (self.load, 0.0)
        } else {
            (self.load * damping, self.load * dissipation)
        }
    }

    /// Takes the damping of rocking into the impulses of all points: what each point loses the mean
    /// of all gets.
    #[inline]
    fn balance(own: &[ContactPoint], h: f64, of: &mut [PointResponse]) {
        let total: f64 = of.iter().map(|r| r.rock).sum();
        for (p, r) in own.iter().zip(of) {
            r.impulse += h * (p.load * total - r.rock);
        }
    }

    /// What the impulses of a response do along velocities: `Σ γ·w`.
    #[inline]
    pub fn power(
        (r, points): (&Response, &[PointResponse]),
        (u, at): (&Vec3, &[PointVelocity]),
        h: f64,
    ) -> f64 {
        let mut power = -h * r.friction.force.dot(u);
        for (p, v) in points.iter().zip(at) {
            power += p.impulse * v.along + p.tilting.dot(&v.tilt);
        }
        power
    }

    /// `wᵀ G w` of the stiffness `G` of a response, kg (m/s)², where `u` and `at` are velocities.
    #[inline]
    pub fn curvature(
        &self,
        points: &[ContactPoint],
        (r, of): (&Response, &[PointResponse]),
        (u, at): (&Vec3, &[PointVelocity]),
        h: f64,
    ) -> f64 {
        let friction = &r.friction;
        let slip = friction.slip.dot(u);
        let mut sum = h * friction.slope * (u.norm_squared() - slip * slip);
        if (friction.around - friction.slope).abs() > 0.0 {
            let around = self.normal.cross(&friction.slip);
            let along = around.dot(u);
            let whole = around.norm_squared().max(f64::MIN_POSITIVE);
            sum += h * (friction.around - friction.slope) * (along * along / whole);
        }
        let (mut mean, mut bend, mut tilt) = (0.0, 0.0, 0.0);
        let mut middle = 0.0;
        for ((p, r), v) in points[self.points.clone()].iter().zip(of).zip(at) {
            let z = v.along + r.lean.dot(&v.tilt);
            mean += r.weight * z;
            bend += r.bend * z * z;
            let (e, inverse) = r.end;
            let along = e.dot(&v.tilt);
            tilt += r.weight * inverse * (v.tilt.norm_squared() - along * along);
            middle += p.load * v.along;
            let rim = p.rim.map_or(0.0, |rim| rim.tilt_damping);
            sum += h * self.tilting * p.load * rim * v.tilt.norm_squared();
        }
        for (r, v) in of.iter().zip(at) {
            let apart = v.along - middle;
            sum += h * r.rocking * apart * apart;
        }
        if r.presses() {
            let square = mean * mean;
            sum += h * h * (r.slope * square + r.force * (bend - 3.0 / r.depth * square + tilt));
        }
        sum
    }

    /// Energy that its normal spring holds at the start of the step, J.
    pub fn stored(&self) -> f64 {
        self.spring.stored(self.depth)
    }
}

/// Component of `x` along the unit vector `normal`, and the remainder.
#[inline]
pub(super) fn normal_part(normal: &Vec3, x: &Vec3) -> (f64, Vec3) {
    let along = normal.dot(x);
    (along, x - normal * along)
}
