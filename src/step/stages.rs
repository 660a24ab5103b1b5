//! The implicit method: two stages with one mass matrix.
//!
//! A step of `h` seconds is a singly diagonally implicit Runge–Kutta step of order two with
//! `γ = 1 − 1/√2` (SDIRK2, L-stable and stiffly accurate). With the forces `F` on a robot of the
//! mass matrix `M` and the bias `k`, its stages are
//!
//! ```text
//! M (V₁ − v₀) = γ h (F₁ − k)                        at q₀ ⊕ γ h V₁
//! M (V₂ − v₀) = (1 − γ) h (F₁ − k) + γ h (F₂ − k)   at q₀ ⊕ ((1 − γ) h V₁ + γ h V₂)
//! ```
//!
//! and the result is the second one. With `η = γ h` and `v₀' = v₀ + (1 + √2)(V₁ − v₀)`, both are
//! implicit Euler steps over `η`, the second from `v₀'` at `q₀ ⊕ (1 − γ) h V₁`, as
//! `(1 − γ)/γ = 1 + √2`; what springs remember goes on in the same way. So each is the convex
//! minimisation of [`super::convex`], and both have the same matrix.
//!
//! `M`, `k`, joint motions and lever arms are those of one place, the expected middle of the step:
//! `q* = q₀ ⊕ h/2 (v₀ + h/4 a)` and `v* = v₀ + h/2 a` with the acceleration `a` of the last step.
//! As `Σ b_i (c_i − 1/2) = 0`, the order stays two. Displacements within a step are linear in that
//! place: `d₀ = −h/2 (v₀ + h/4 a)` is where it begins, `d₂ = d₀ + (1 − γ) h V₁` where its second
//! stage does. Where an axis of a turn turns, the ways to `q*` and to the end follow it: [`wind`].
//!
//! What rolls or sticks has a velocity of zero at the place of contact at each time, and that place
//! moves within the step. So the velocities of a contact in the stages, along the surface and
//! along its normal, have a drift beside the lever arms of the middle: what the expected velocity
//! makes of the way of the lever arms from the start to the middle, in proportion to the time from
//! there. With `J` of the start and of the middle, `J(t) v ≈ J* v + (J* − J₀) v* (t − h/2)/(h/2)`.
//! Displacements contain the drift, too: the second stage begins `(1 − γ) h` times that of the
//! first one farther. As `Σ b_i (c_i − 1/2) = 0`, nothing of it is left after a whole step.
//!
//! A contact slips at `μ` times a normal force that is known before the line search of a Newton
//! iteration: that of the guess and what the direction changes of it, see [`super::convex`]. Where
//! the normal forces that an iteration has found would change velocities, by the step's own matrix,
//! the next one goes on with these.
//!
//! A guess is what the last step has done: a stage changes the velocity by as much as the same
//! stage of the last step. So a motor that gets a new command at each step finds its transient.
//!
//! What it errs by is in [`estimate`]. Where that is too much, the first stage alone may be good:
//! it is an implicit Euler step of `γ h`. A limb that comes to its limit rests there at its end;
//! the second stage begins where `1 + √2` of the first one's change leads, which is a rebound, and
//! a limit does not pull.
//!
//! Source: Alexander 1977.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod estimate;
pub(super) mod finish;
mod regimes;
pub(super) mod secants;

use crate::closure::Rows;
use crate::dynamics::{crba, rnea};
use crate::force::{Contact, ContactSet, Memory, Responses, Secant, Terms, seek};
use crate::kinematics::{advance, forward, wind};
use crate::model::Model;
use crate::spatial::Vec6;
use crate::state::{Physical, Trend};
use crate::step::attempt::mean_acceleration;
use crate::step::convex::{Frame, Newton, coarser};
use crate::step::point::{Context, Point};
use crate::tree::Tree;
use crate::tuning::{
    BOUNCE_SHARE, CONTACT_STEP, FIXED_ACCURACY, LAG_SHARE, MISPLACED, VELOCITY_WEIGHT,
};
use std::f64::consts::SQRT_2;

/// `γ`.
const GAMMA: f64 = 1.0 - 0.5 * SQRT_2;

/// Time of each stage from the middle, in halves of the step.
const DRIFT: [f64; 2] = [2.0 * GAMMA - 1.0, 1.0];

/// Mean velocity from the start of a step of `h` seconds to its expected middle, of a degree of
/// freedom with the velocity `v` there and the acceleration `a`.
fn early(v: f64, a: f64, h: f64) -> f64 {
    v + 0.25 * h * a
}

/// Mean acceleration of a degree of freedom from the first stage of a step to its end.
pub fn late_acceleration(trend: &Trend, dof: usize) -> f64 {
    (trend.whole[dof] - GAMMA * trend.first[dof]) / (1.0 - GAMMA)
}

/// The method and its scratch.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    /// The robot in the expected middle of the step.
    pub middle: Point,
    /// What acts in each stage, from where it begins.
    pub terms: [Terms; 2],
    /// The same as the second, moved by the error of its positions.
    aside: Terms,
    /// Solution of each stage.
    pub solved: [Newton; 2],
    /// Accelerations that are expected.
    trend: Trend,
    /// Positions in the middle.
    q: Vec<f64>,
    /// Velocities there.
    v: Vec<f64>,
    /// Displacement from there, `nv`, and that of all bodies.
    moved: Vec<f64>,
    way: Vec<Vec6>,
    /// That of all bodies from there to the start.
    back: Vec<Vec6>,
    /// Velocity from which a stage begins, and that which is expected at its end.
    from: Vec<f64>,
    guess: Vec<f64>,
    /// What terms remember after the first stage.
    memory: Memory,
    /// Forces at the start, N or N·m.
    start: Vec<f64>,
    /// Scratch of the estimate: forces, errors of velocities and positions.
    forces: Vec<f64>,
    error: [Vec<f64>; 2],
    probe: Newton,
    /// Forces of loops against errors.
    loops: Vec<f64>,
    /// What the friction cones of each stage lag behind, as an error relative to the tolerance.
    lag: [f64; 2],
    /// What the middle is off, as an error relative to the tolerance.
    off: f64,
    /// Whether both stages hold a solution: not where the last try to find one has failed.
    pub has_solution: bool,
    /// Of the contacts of a step that is solved again, see `secants`.
    secants: Vec<Secant>,
    /// Most Newton iterations in a solve since the communication step has begun.
    pub iterations: usize,
}

#[cfg(test)]
crate::spoil::spoil!(
    Stages: middle terms aside solved trend q v moved way back from guess memory start forces error probe loops lag off has_solution secants iterations;
);

impl Stages {
    /// Room for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Box<Self> {
        let (room, nv) = (model.contact_room(), model.nv());
        // Not clones of one: a clone has no room beyond its length.
        let newton = || Newton::new(tree, room);
        Box::new(Self {
            middle: Point::new(model, tree),
            terms: [Terms::new(model), Terms::new(model)],
            aside: Terms::new(model),
            solved: [newton(), newton()],
            trend: Trend::new(nv),
            q: vec![0.0; model.nq],
            v: vec![0.0; nv],
            moved: vec![0.0; nv],
            way: vec![[0.0; 6]; tree.bodies.len()],
            back: vec![[0.0; 6]; tree.bodies.len()],
            from: vec![0.0; nv],
            guess: vec![0.0; nv],
            memory: Memory::new(model),
            start: vec![0.0; nv],
            forces: vec![0.0; nv],
            error: [vec![0.0; nv], vec![0.0; nv]],
            probe: newton(),
            loops: Vec::with_capacity(Rows::most(tree)),
            lag: [0.0; 2],
            off: 0.0,
            has_solution: false,
            secants: Vec::with_capacity(room[0]),
            iterations: 0,
        })
    }

    /// Solves a step of `h` seconds from where `here` stands; tells whether that went well, and no
    /// rim has thrown its load across its face.
    ///
    /// - `trend`: accelerations of the last step
    /// - `alike`: whether what touches has to be the same throughout, and friction right within the
    ///   tolerance
    pub fn solve(
        &mut self,
        ctx: &Context,
        (here, from): (&Point, &Physical),
        trend: &Trend,
        [h, accuracy]: [f64; 2],
        alike: bool,
    ) -> bool {
        self.trend.copy_from(trend);
        self.secants.clear();
        if !self.run_stages(ctx, (here, from), [h, accuracy], alike) {
            return false;
        }
        // Again from the middle that it has found, as long as that comes nearer by half. Solved
        // again once only, what nutates grows by a share of the fourth power of its turn in a step.
        let mut before = f64::INFINITY;
        loop {
            self.off = self.misplaced(ctx, from, h);
            if self.off <= MISPLACED || self.off > 0.5 * before {
                return true;
            }
            before = self.off;
            let [first, end] = self.solved.each_ref().map(|stage| &stage.v);
            let (tree, start) = (ctx.tree, &from.v);
            mean_acceleration(tree, start, (first, GAMMA * h), &mut self.trend.first);
            mean_acceleration(tree, start, (end, h), &mut self.trend.whole);
            if !self.run_stages(ctx, (here, from), [h, accuracy], alike) {
                return false;
            }
        }
    }

    /// Solves both stages of a step of `h` seconds with the accelerations `self.trend`.
    fn run_stages(
        &mut self,
        ctx: &Context,
        (here, from): (&Point, &Physical),
        [h, accuracy]: [f64; 2],
        alike: bool,
    ) -> bool {
        self.has_solution = false;
        self.middle.kin.loops.follow(&here.kin.loops);
        self.stand(ctx, from, h);
        self.begin_springs(ctx.tree, (here, from));
        self.find_drift(ctx, here);
        self.bend();
        let eta = GAMMA * h;
        // First stage.
        for (guess, (v, a)) in self
            .guess
            .iter_mut()
            .zip(from.v.iter().zip(&self.trend.first))
        {
            *guess = v + eta * a;
        }
        self.from.copy_from_slice(&from.v);
        self.begin(ctx, from, (0, h));
        self.begin_as_deep(here);
        if !self.run(ctx, 0, [eta, accuracy]) || self.breaks(0, alike.then_some(eta)) {
            return false;
        }
        let solved = self.solved[0].solved();
        self.terms[0].pass_on(&solved, eta, &mut self.memory);
        // Second stage.
        let rows = self.guess.iter_mut().zip(&mut self.from);
        let ends = from.v.iter().zip(&self.solved[0].v);
        let trends = self.trend.first.iter().zip(&self.trend.whole);
        for ((((guess, start), moved), (v0, v1)), (first, whole)) in
            rows.zip(&mut self.moved).zip(ends).zip(trends)
        {
            *guess = v1 + h * whole - eta * first;
            *start = v0 + (1.0 + SQRT_2) * (v1 - v0);
            *moved += (1.0 - GAMMA) * h * v1;
        }
        self.begin(ctx, from, (1, h));
        self.has_solution =
            self.run(ctx, 1, [eta, accuracy]) && !self.breaks(1, alike.then_some(eta));
        self.has_solution
    }

    /// When a contact with restitution touches in the step of `h` seconds from `here`, s, whose
    /// middle has been found; none where the bounce goes on as if the step had ended there. The way
    /// from the start is bent, which nobody knows before.
    ///
    /// What presses at the end of a step that is so much longer than the bounce takes away a share
    /// of the velocity, `γ h t/T²` of the time `t` for which it presses and the time scale `T`.
    pub fn touchdown(&self, here: &Point, h: f64) -> Option<f64> {
        let mut starts = here.terms.contacts.iter().peekable();
        let Point { kin, terms, .. } = &self.middle;
        let mut touches = h;
        for contact in terms.contacts.iter().filter(|c| c.bounce > 0.0) {
            let start = seek(&mut starts, contact.slot, |c| c.slot);
            let Some(start) = start.filter(|c| c.depth < 0.0) else {
                continue;
            };
            // It is `d + r s + c s²` deep, with `s` from −1 at the start to 1 at the end.
            let along = contact.normal_velocity(&terms.contacts.points, &kin.V);
            let (d, r) = (contact.depth, -0.5 * h * along);
            let c = start.depth - d + r;
            let root = (r * r - 4.0 * c * d).sqrt();
            let roots = [-r - root, -r + root].map(|x| 0.5 * h * (1.0 + 2.0 * d / x));
            let lasts = |time: &f64| {
                let resolved = BOUNCE_SHARE * contact.duration;
                *time > 0.0 && h * (h - time) > resolved * resolved
            };
            touches = roots.into_iter().filter(lasts).fold(touches, f64::min);
        }
        (touches < h).then_some(touches)
    }

    /// Whether the solution of the stages up to `last` is not to be taken, see [`Self::solve`].
    ///
    /// - `alike`: their length where what touches has to be the same throughout, s
    fn breaks(&self, last: usize, alike: Option<f64>) -> bool {
        let differs = |eta| self.changes(last, eta) || self.lag[last] > 1.0;
        self.flips(last) || alike.is_some_and(differs)
    }

    /// Puts the robot into the expected middle of the step; `self.moved` leads back to its start.
    fn stand(&mut self, ctx: &Context, from: &Physical, h: f64) {
        let (tree, trend) = (ctx.tree, &self.trend.whole);
        for (i, (v, a)) in from.v.iter().zip(trend).enumerate() {
            self.v[i] = early(*v, *a, h);
            self.moved[i] = -0.5 * h * self.v[i];
        }
        for (dof, change) in self.guess.iter_mut().enumerate() {
            *change = 0.5 * h * late_acceleration(&self.trend, dof);
        }
        wind(tree, &self.guess, 0.5 * h, &mut self.v);
        advance(tree, &from.q, &self.v, 0.5 * h, &mut self.q);
        for (middle, (v, a)) in self.v.iter_mut().zip(from.v.iter().zip(trend)) {
            *middle = v + 0.5 * h * a;
        }
        let Point { kin, .. } = &mut self.middle;
        kin.update_poses(tree, &self.q);
        crba::mass_matrix(tree, kin);
        kin.update_velocities(tree, &self.v);
        self.find_bias(ctx, 0.5 * h);
        self.middle.find_around(ctx, from, (&self.q, h));
    }

    /// Finds the bias in the middle, with the external wrenches `t` seconds after the start.
    fn find_bias(&mut self, ctx: &Context, t: f64) {
        let (kin, wrenches) = (&mut self.middle.kin, &ctx.inputs.wrenches);
        rnea::bias(ctx.tree, kin, &self.v, wrenches, ctx.elapsed + t);
    }

    /// Finds the bias in the middle anew where external wrenches change, with those `t` seconds
    /// after the start.
    fn follow_wrenches(&mut self, ctx: &Context, t: f64) {
        if ctx.inputs.varies() && !ctx.inputs.wrenches.is_empty() {
            self.find_bias(ctx, t);
        }
    }

    /// Sets the drift of contacts from the start to the middle, and the shares of their load to
    /// those of the start.
    fn find_drift(&mut self, ctx: &Context, here: &Point) {
        if self.middle.terms.contacts.is_empty() {
            return;
        }
        forward(ctx.tree, &here.kin.S, &self.v, &mut self.way);
        let Point { kin, terms, .. } = &mut self.middle;
        let mut starts = here.terms.contacts.iter().peekable();
        let ContactSet { list, points, .. } = &mut terms.contacts;
        for contact in list {
            let start = seek(&mut starts, contact.slot, |c| c.slot);
            if let Some(start) = start.filter(|c| c.depth > 0.0 && contact.depth > 0.0) {
                let before = &here.terms.contacts.points;
                contact.take_loads(points, &before[start.points.clone()]);
                let moved = contact.sliding(&kin.V) - start.sliding(&self.way);
                contact.drift = moved;
                let climbing = contact.normal_velocity(points, &kin.V);
                contact.rise = climbing - start.normal_velocity(before, &self.way);
            }
        }
    }

    /// Energy, J, that one solve over `h` seconds takes by what contacts have drifted: of the lever
    /// arms of its middle each impulse acts on the mean of the velocities at both ends, and what
    /// the arms have turned since the start is in one of them.
    pub fn taken_by_drift(&self, contacts: &ContactSet, solved: &Responses, h: f64) -> f64 {
        let mut middles = self.middle.terms.contacts.iter().peekable();
        let mut taken = 0.0;
        for (contact, r) in contacts.iter().zip(&solved.contacts) {
            if let Some(middle) = seek(&mut middles, contact.slot, |c| c.slot) {
                taken += 0.5 * (h * r.friction.force.dot(&middle.drift) - r.load * middle.rise);
            }
        }
        taken
    }

    /// Sets the drift of springs from the start to the middle, and their length to that of the
    /// start.
    fn begin_springs(&mut self, tree: &Tree, (here, from): (&Point, &Physical)) {
        let Point { kin, terms, .. } = &mut self.middle;
        if terms.springs.is_empty() {
            return;
        }
        forward(tree, &kin.S, &from.v, &mut self.way);
        forward(tree, &kin.S, &self.moved, &mut self.back);
        let before = [&*self.way, &here.kin.V];
        for (spring, start) in terms.springs.iter_mut().zip(&here.terms.springs) {
            spring.begin_at(start, before, &self.back);
        }
    }

    /// Makes contacts between two shapes that press at the start and have restitution as deep there
    /// as they are: the way of their points from there to the middle is bent. By as much they are
    /// deeper at the end, so that what their springs hold at both ends is what the step takes it to
    /// be. This needs rows that are the gradient of the depth, which only such contacts have.
    fn begin_as_deep(&mut self, here: &Point) {
        let mut starts = here.terms.contacts.iter().peekable();
        let firsts = &mut self.terms[0].contacts;
        let middle = &mut self.middle.terms.contacts;
        let contacts = middle.list.iter().zip(&mut firsts.list);
        let exact = |c: &Contact| c.other_link.is_some() && c.bounce > 0.0;
        for (contact, first) in contacts.filter(|(c, _)| exact(c)) {
            let presses = |c: &Contact| c.depth > 0.0;
            let start = seek(&mut starts, contact.slot, |c| c.slot);
            if let Some(start) = start.filter(|c| [c, contact, first].into_iter().all(presses)) {
                let by = (start.depth - first.depth) / first.weights;
                contact.sink(&mut middle.points, by);
                first.sink(&mut firsts.points, by);
                first.share_load(&mut firsts.points);
            }
        }
    }

    /// Sets up what acts in a stage from `self.moved`.
    fn begin(&mut self, ctx: &Context, from: &Physical, (stage, h): (usize, f64)) {
        if ctx.inputs.varies() {
            let end = [GAMMA, 1.0][stage] * h;
            self.follow_wrenches(ctx, end);
            self.middle.set_joints(ctx, from, (&self.q, [end, end]));
        }
        let Self {
            middle,
            terms,
            moved,
            way,
            memory,
            ..
        } = self;
        forward(ctx.tree, &middle.kin.S, moved, way);
        let after = (stage > 0).then_some((&*memory, 1.0 + SQRT_2));
        // What the drift of the first stage has moved.
        let risen = if stage > 0 {
            (1.0 - GAMMA) * h * DRIFT[0]
        } else {
            0.0
        };
        terms[stage].begin(&middle.terms, (way, moved, risen), after);
        terms[stage].scale_drift(DRIFT[stage]);
    }

    /// Solves a stage of `eta` seconds from `self.from`, near `self.guess`, with the friction cones
    /// that it finds itself.
    fn run(&mut self, ctx: &Context, stage: usize, [eta, accuracy]: [f64; 2]) -> bool {
        let tree = ctx.tree;
        let kin = &self.middle.kin;
        let ([first, second], [first_terms, second_terms]) = (&mut self.solved, &mut self.terms);
        let (solved, terms, before) = if stage == 0 {
            (first, first_terms, None)
        } else {
            (second, second_terms, Some((&*first, &first_terms.contacts)))
        };
        let fixed = (ctx.fixed_step > 0.0).then_some(FIXED_ACCURACY[1]);
        let frame = Frame {
            tree,
            kin,
            h: eta,
            ahead: 0.5 * DRIFT[stage] * (eta / GAMMA),
            accuracy: [accuracy, fixed.unwrap_or(coarser(accuracy))],
        };
        solved.guess_with_cones((&frame, terms), &self.from, &self.guess);
        let shared = before
            .and_then(|(first, contacts)| first.factor_for(contacts, solved, &frame.with(terms)));
        let cones = lag_allowed(ctx, eta / GAMMA);
        let (outcome, lag) = solved.solve_with_cones(&frame, terms, cones, shared);
        self.lag[stage] = VELOCITY_WEIGHT * lag / ctx.tolerance;
        if tree.driven().next().is_some() {
            // The work of what drives them is of these forces, and the lag's are elsewhere.
            solved.collect(&frame.with(terms));
        }
        self.iterations = self.iterations.max(outcome.iterations);
        outcome.converged
    }

    /// What friction cones still lag behind, as an error relative to the tolerance.
    pub fn lag(&self) -> f64 {
        self.lag[0].max(self.lag[1])
    }
}

/// What friction cones may lag behind in a step of `h` seconds before a solve takes other ones,
/// rad/s; infinite where they stay as they are.
pub(super) fn lag_allowed(ctx: &Context, h: f64) -> f64 {
    if !ctx.rules.cones {
        return f64::INFINITY;
    }
    // What many short steps leave shall not add up to more than what few long ones do.
    LAG_SHARE * (h / CONTACT_STEP).min(1.0) * ctx.tolerance / VELOCITY_WEIGHT
}
