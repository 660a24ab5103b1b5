//! A communication step: its beginning and its end, and those of each island in it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::model::{LinkId, RootId};
use crate::spatial::Vec6;
use crate::state::State;
use crate::step::driver::{Stepper, Stop};
use crate::step::fixed::fixed_count;
use crate::step::point::Context;
use crate::step::size::landing;
use crate::tuning::{MAX_STEP, MIN_STEP};

impl Stepper {
    /// Begins a communication step from `state` to `end`.
    pub fn begin(&mut self, state: &mut State, end: f64) {
        self.backup.copy_from(state);
        (self.tried, self.implicit.iterations, self.stages.iterations) = (0, 0, 0);
        state.stepping.last_step = end - state.time;
        state.stepping.impulse.fill([0.0; 3]);
        state.stepping.pair_impulse.fill([0.0; 3]);
    }

    /// Begins it again.
    pub fn begin_again(&mut self, state: &mut State, end: f64) {
        let tried = self.tried;
        state.copy_from(&self.backup);
        self.begin(state, end);
        self.tried = tried;
    }

    /// See [`crate::step::islands::Islands::part`]. Where there is nothing to part, no island is
    /// entered or left.
    pub fn part(&mut self, ctx: &Context, state: &State, lengths: [f64; 2]) -> bool {
        self.attempt.company.meet(ctx.tree);
        let many = self.islands.part(ctx, state, &mut self.there, lengths);
        if !many {
            // Of what no term writes, a try holds what the state does, as in `enter`.
            self.attempt.stay(state);
        }
        many
    }

    /// Begins with an island, whose trees `ctx` works on: what it remembers is that of all its
    /// trees together.
    pub fn enter(&mut self, ctx: &Context, state: &mut State) {
        let (tree, stepping) = (ctx.tree, &mut state.stepping);
        let lead = tree.island.lead;
        let sizes = &mut stepping.sizes;
        for (index, _) in tree.moved() {
            sizes.proposed[lead] = sizes.proposed[lead].min(sizes.proposed[index]);
            sizes.floor[lead] = sizes.floor[lead].max(sizes.floor[index]);
        }
        if !stepping.ahead.is_under_way(tree) {
            stepping.ahead.clear(tree);
        }
        let touches = &mut state.physical.memory.touches;
        self.islands.set_aside(ctx, touches);
        for point in [&mut self.here, &mut self.there, &mut self.stages.middle] {
            point.terms.select(ctx.model, tree);
        }
        // Of other trees, a try holds what the state does.
        self.attempt.stay(state);
    }

    /// Ends with an island: each of its trees remembers what the island does.
    pub fn leave(&mut self, ctx: &Context, state: &mut State) {
        let (tree, sizes) = (ctx.tree, &mut state.stepping.sizes);
        let lead = tree.island.lead;
        for (index, _) in tree.moved() {
            sizes.proposed[index] = sizes.proposed[lead];
            sizes.floor[index] = sizes.floor[lead];
        }
        self.islands.take_back(&mut state.physical.memory.touches);
    }

    /// Ends a communication step that has led to `result` at `end`, and which is a part of one up
    /// to `whole`.
    ///
    /// # Errors
    /// [`Stop`] of `result`; `state` is then what it was.
    pub fn end(
        &mut self,
        ctx: &Context,
        state: &mut State,
        [end, whole]: [f64; 2],
        result: Result<(), Stop>,
    ) -> Result<(), Stop> {
        if result.is_err() {
            state.copy_from(&self.backup);
            return result;
        }
        state.time = end;
        self.arrive(ctx, state, whole);
        if !state.stepping.loads.is_empty() {
            self.attempt.begin(state);
            for load in &state.stepping.loads {
                let links = ctx.model.links_of(load.slot);
                let impulse = load.force.map(|x| x * state.stepping.last_step);
                let links = links.map(|link| link.map(LinkId::index));
                self.attempt.add_impulse(links, &impulse);
            }
            self.attempt.give_impulses(state);
        }
        let stepping = &mut state.stepping;
        stepping.ahead.changed.fill(0.0);
        let newton_max = &mut stepping.counters.newton_max;
        let iterations = self.implicit.iterations.max(self.stages.iterations);
        *newton_max = (*newton_max).max(iterations as u64);
        Ok(())
    }

    /// Puts driven bases where their velocities, which have changed evenly, lead from the last
    /// communication point, whatever steps have led here.
    fn arrive(&self, ctx: &Context, state: &mut State, whole: f64) {
        let (tree, from) = (ctx.tree, &self.backup.physical);
        let (span, arrived) = (state.time - self.backup.time, state.time >= whole);
        tree.carry_driven((&from.q, &from.v), span, &mut state.physical.q);
        let v = &mut state.physical.v;
        for (body, first, acceleration) in tree.driven() {
            let start = &from.v[first..first + 6];
            let mut target: Vec6 = std::array::from_fn(|i| start[i] + span * acceleration[i]);
            if arrived {
                // To the last digit.
                let root = RootId::from(tree.bodies[body].tree);
                target = ctx.inputs.base_velocity(root, span).unwrap_or(target);
            }
            v[first..first + 6].copy_from_slice(&target);
        }
    }

    /// Length of a step that all trees take together on the way to a communication point, s: what
    /// the error control proposes for the one that needs the shortest, or the fixed step.
    pub fn common_step(ctx: &Context, state: &State, remaining: f64) -> f64 {
        if ctx.fixed_step > 0.0 {
            return remaining / fixed_count(ctx, remaining);
        }
        let proposed = state.stepping.sizes.proposed.iter();
        let shortest = proposed.fold(MAX_STEP, |shortest, h| shortest.min(*h));
        landing(shortest.max(MIN_STEP), remaining)
    }

    /// Whether what stands at `self.here` has stayed where its island may go.
    pub(super) fn check_limits(&self, ctx: &Context) -> Result<(), Stop> {
        if self.islands.hold(ctx.tree, &self.here.kin) {
            Ok(())
        } else {
            Err(Stop::Strayed)
        }
    }
}
