//! Rest: a robot that is set down, and one that stands still.
//!
//! A block that is set down on a slope is held by friction at once, or slides from the first
//! instant on as friction at its cap lets it. Friction that began without a load would let it go
//! until its springs are stretched, with a speed that stays. Here the springs of friction are
//! stretched until they balance what drags at the robot in its initial pose, as far as their caps
//! go.
//!
//! Where its height follows from the ground, the robot as one rigid body also sinks and tilts by
//! the micrometres with which the ground carries its weight. Only what touches in the given pose
//! carries it: a body that would come down on something else keeps its attitude, and falls when
//! time begins.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::Terms;
use crate::kinematics::advance;
use crate::model::{LinkId, Model, RootId};
use crate::slots::ParameterSlot;
use crate::spatial::{Vec3, Vec6};
use crate::state::{Load, State, Stepping};
use crate::step::convex::Newton;
use crate::step::driver::Stepper;
use crate::step::point::Context;
use crate::tree::Tree;
use crate::tuning::{FIXED_ACCURACY, LOCKED, REST_SPEED, SET_DOWN, SETTLING, SETTLING_STEPS};

impl Stepper {
    /// Stretches the springs of the contacts' friction in `state`, if the robot is at rest there,
    /// and sets it down, if it is to be.
    ///
    /// Each of a number of implicit steps begins at rest, so that only what friction remembers, and
    /// the pose, go on from one to the next. Friction has no dampers in them: what slips reaches a
    /// speed within a step that it does not have when it is released, and a damper would take from
    /// the spring what that speed is worth.
    pub fn settle(&mut self, ctx: &Context, state: &mut State) {
        let mut trees = ctx.tree.moved();
        let set_down = trees.any(|(index, _)| is_set_down(ctx, index));
        let v = &state.physical.v;
        if ctx.tree.worked_dofs().any(|k| v[k] != 0.0) {
            return;
        }
        self.attempt.stay(state);
        if set_down && !(self.stretch(ctx, state, true) && self.has_only_sunk(ctx)) {
            // It tips over: there is no pose near the given one in which the ground carries it.
            self.attempt.accept(state);
        }
        self.stretch(ctx, state, false);
    }

    /// Takes the steps, with all joints locked and the pose going on if the robot `sinks`; tells
    /// whether it has come to rest.
    fn stretch(&mut self, ctx: &Context, state: &mut State, sinks: bool) -> bool {
        let tree = ctx.tree;
        let pattern = &tree.sparsity;
        let mut speed = 0.0;
        // Contacts are as stiff as in the steps that follow.
        let step = if ctx.fixed_step > 0.0 {
            ctx.fixed_step
        } else {
            SETTLING
        };
        for _ in 0..SETTLING_STEPS {
            self.here.update(ctx, &state.physical, step);
            if self.here.terms.contacts.is_empty() {
                return true;
            }
            let terms = &mut self.here.terms;
            for contact in &mut terms.contacts.list {
                contact.friction.damping = 0.0;
            }
            for turn in &mut terms.turns {
                (turn.torsional.damping, turn.rolling.damping) = (0.0, 0.0);
            }
            if sinks {
                for (_, tree) in tree.moved() {
                    let base = if tree.free { 6 } else { 0 };
                    for dof in tree.dofs.clone().skip(base) {
                        self.here.kin.M[pattern.diagonal(dof)] *= LOCKED;
                    }
                }
            }
            let problem = self.here.problem(tree, SETTLING, FIXED_ACCURACY[0]);
            let solved = &mut self.implicit.full;
            solved.guess_start(&problem, &state.physical.v);
            if !solved.solve(&problem).converged {
                return false;
            }
            let memory = &mut self.there_memory;
            self.here.terms.remember(&solved.solved(), SETTLING, memory);
            state.physical.memory.touches.clone_from(&memory.touches);
            if sinks {
                for (index, tree) in tree.moved() {
                    let sinks = tree.free && is_set_down(ctx, index);
                    for (place, v) in solved.v[tree.dofs.clone()].iter_mut().enumerate() {
                        // It turns about x and y and moves along z.
                        if !(sinks && matches!(place, 0 | 1 | 5)) {
                            *v = 0.0;
                        }
                    }
                }
                speed = fastest(tree, &solved.v);
                self.settled.copy_from_slice(&state.physical.q);
                let q = &mut state.physical.q;
                advance(tree, &self.settled, &solved.v, SETTLING, q);
                // It turns about its centre of mass, but the origin of its link stays above its
                // place.
                for (index, _) in tree.moved() {
                    if let Some(base) = tree.base_frame(RootId::from(index))
                        && is_set_down(ctx, index)
                    {
                        let back = base.position(&self.settled) - base.position(q);
                        q[base.coordinate] += back.x;
                        q[base.coordinate + 1] += back.y;
                    }
                }
            }
        }
        speed * SETTLING < SET_DOWN
    }

    /// Whether what has been set down is carried by nothing but what touches in the given pose,
    /// once it has sunk there without turning as deep as it is now. What comes to touch because the
    /// robot turns carries another pose: a die on its edge has one on each of its faces, which are
    /// not what was asked for.
    fn has_only_sunk(&self, ctx: &Context) -> bool {
        let deepest = self.carrying(ctx).fold([0.0; 2], |most: [f64; 2], point| {
            [0, 1].map(|k| most[k].max(point[k]))
        });
        let touching = (deepest[1] - deepest[0]).min(0.0);
        self.carrying(ctx).all(|[_, before]| before >= touching)
    }

    /// Depth of all points that carry at the end of setting down, and that of the same places of
    /// the bodies in the given pose, m.
    fn carrying(&self, ctx: &Context) -> impl Iterator<Item = [f64; 2]> {
        let (tree, kin, contacts) = (ctx.tree, &self.here.kin, &self.here.terms.contacts);
        // From where a place of a body is now to where it was.
        let back = move |body: usize, x: &Vec3| {
            let index = tree.bodies[body].tree;
            let base = tree.base_frame(RootId::from(index));
            base.filter(|_| is_set_down(ctx, index))
                .map_or_else(Vec3::zeros, |base| {
                    let [now, before] =
                        [&self.settled, &self.attempt.end.q].map(|q| base.solver_pose(q));
                    before.point(&now.inverse().point(x)) - x
                })
        };
        contacts.list.iter().flat_map(move |contact| {
            let points = contacts.points[contact.points.clone()].iter();
            points.filter(|point| point.depth > 0.0).map(move |point| {
                let x = point.x + kin.origin(tree, contact.body);
                let other = contact.other.as_ref();
                let other = other.map_or_else(Vec3::zeros, |other| back(other.body, &x));
                let way = back(contact.body, &x) - other;
                [point.depth, point.depth - point.normal.dot(&way)]
            })
        })
    }

    /// If the robot stands still and all forces balance, it stays: nothing moves until `remaining`
    /// has passed. The test does not depend on `h`, so it does not depend on the communication step
    /// either.
    ///
    /// - `accuracy`: imbalance that does not set it going, relative to the forces
    pub(super) fn rest(
        &mut self,
        ctx: &Context,
        state: &mut State,
        [h, remaining]: [f64; 2],
        accuracy: f64,
    ) -> bool {
        let speed = fastest(ctx.tree, &state.physical.v);
        // Forces that balance now need not balance later if a command changes.
        let v = &state.physical.v;
        let still = |(_, first, a): (usize, usize, &Vec6)| {
            a.iter().chain(&v[first..first + 6]).all(|x| *x == 0.0)
        };
        let driven = !ctx.tree.driven().all(still);
        if !ctx.rules.rest || speed >= REST_SPEED || driven || ctx.inputs.varies() {
            return false;
        }
        let (here, attempt) = (&mut self.here, &mut self.attempt);
        here.complete(ctx, &state.physical);
        attempt.stay(state);
        if speed > 0.0 {
            ctx.tree.clear_velocities(&mut attempt.end.v);
            here.update_motion(ctx, &attempt.end, h);
        }
        let solved = &mut self.implicit.full;
        let balanced = solved.is_balanced(&here.problem(ctx.tree, h, accuracy));
        if balanced {
            attempt.clear_trend(ctx.tree);
            here.terms.drop_unloaded(&mut attempt.end.memory);
            let stepping = &mut state.stepping;
            stepping.counters.steps += 1;
            if remaining < stepping.last_step {
                attempt.add_impulses(&here.terms, solved, [h, remaining / h]);
            } else {
                for (index, _) in ctx.tree.moved() {
                    stepping.rested[index] = 1.0;
                }
                stepping.note_loads(ctx.model, &here.terms, solved, h);
            }
            attempt.accept(state);
        } else if speed > 0.0 {
            here.update_motion(ctx, &state.physical, h);
        }
        balanced
    }
}

impl Stepping {
    /// Notes the contact forces on what rests, as a solve over `h` seconds has found them.
    fn note_loads(&mut self, model: &Model, terms: &Terms, solved: &Newton, h: f64) {
        let (points, of) = (&terms.contacts.points, &solved.responses.points);
        for (contact, response) in terms.contacts.iter().zip(&solved.responses.contacts) {
            let force = contact.impulse(points, (response, of), h) / h;
            let lower = model.links_of(contact.slot)[0].map(LinkId::index);
            let sign = if lower == Some(contact.link) {
                1.0
            } else {
                -1.0
            };
            self.loads.push(Load {
                slot: contact.slot,
                force: (force * sign).into(),
            });
        }
        self.loads.sort_unstable_by_key(|load| load.slot);
    }
}

/// The largest velocity of all degrees of freedom, rad/s or m/s.
fn fastest(tree: &Tree, v: &[f64]) -> f64 {
    tree.worked_dofs()
        .fold(0.0, |most: f64, k| most.max(v[k].abs()))
}

/// Whether a tree is to be set down: its height is the one that follows from the ground.
#[expect(clippy::float_cmp, reason = "another height is somebody's wish")]
fn is_set_down(ctx: &Context, tree: usize) -> bool {
    let root = &ctx.model.roots[tree];
    let height = ParameterSlot::InitialBasePosition(RootId::from(tree), 2);
    root.set_down && !ctx.tree.trees[tree].tied && ctx.parameters.get(height) == root.position.z
}
