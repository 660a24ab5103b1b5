//! Accelerations and forces where something stiff holds: motors, dry friction, contacts.
//!
//! 1. The force of a stiff element at the end of a step is that of its last stage, which balances
//!    the mass matrix and the bias of the middle of the step, and what a command that has jumped
//!    asks of that stage. With those of the end a force of first order in the step is left over,
//!    and what is light makes much of it: at 1e-3 the crank of Hoeken's linkage, turned at 6 rad/s,
//!    had 114 rad/s² in place of 0.06, and an arm whose joints get new speeds 240 times a second
//!    63 rad/s² in place of 0.3.
//! 2. What the step has done knows better: `a_s`, the mean acceleration from the first stage of the
//!    step to its end. After a command that jumps it is that of the time after the jump.
//! 3. As in an estimate of an error, what dies within a step is filtered out of the difference:
//!    `(M + G)(v̇ − a_s) = r − M a_s`, with the stiffness `G = Jᵀ β h (d + h k) J` of elements that
//!    hold, and `r` all forces less the bias. Where an element is stiff this gives `a_s`; where
//!    nothing is, `M v̇ = r`.
//! 4. `M v̇` is then `r` less `G (v̇ − a_s)`: that is what the forces are off by.
//!
//! Along a joint of the mass `m` an element of `g` counts with `g²/(m + g)`. Of a jump of the
//! command by 1 at the start of a step, an element of the rate `z/h` leaves `R = (1 − β z)/(1 + γ
//! z)²` at its end, with `β = 1 − 2γ`. So `r/m` is `−z R/h`, where the truth soon is 0, and `a_s`
//! is `−z/(1 + γ z)²/h`: with the weights `1` and `β z − 1` both cancel. `g²/(m + g)` is nearly
//! that where an element is stiff. Where it is soft it counts nothing, and `M v̇ = r` is exact. Of
//! contacts friction counts, with `β h` for `h`: the load that sticking friction carries alternates
//! from step to step, and a turntable on which a box rides had 0.159 to 0.190 m/s² in place of
//! 0.15. Normal forces follow from depths and do not: with them a foot that a motor presses down
//! was 3.2 N off in place of 1.2. Springs between two points do not count; what explicit steps
//! resolve, pd laws and damping, counts only where the last step was none and ends at this moment.
//!
//! A velocity motor asks for the acceleration of its command, 0 where that is held. What a step has
//! done differs from it by what dies within each step: a step takes the load of its middle, and the
//! next one begins with the load of another place, or with a velocity that closing a loop has
//! changed. The crank of a slider–crank at 20 rad/s had 1.5 rad/s² in place of 0.02, that of
//! Jansen's linkage 27 in place of 0.1. So `m g³/(1 + g)`, with `g` in units of the mass `m`, holds
//! the joint to the acceleration of the command besides. Where `g` is small, a transient of the
//! motor is resolved, and this counts little. A motor that yields smoothly has nearly the same
//! acceleration in the first stage and after it; as far as it has, it is held to that. The mass `m`
//! is at least that for which the motor is damped critically, because in a loop a motor moves more
//! than `M` says.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Readout;
use crate::force::{Drive, JointTerm};
use crate::kinematics::forward;
use crate::model::{Sensor, SensorKind};
use crate::slots::ParameterSlot;
use crate::spatial::add_scaled6;
use crate::state::{State, Trend};
use crate::step::convex::{Problem, Run};
use crate::step::late_acceleration;
use crate::step::point::Context;
use crate::tuning::CONTACT_STEP;
use std::f64::consts::SQRT_2;

/// `β = 1 − 2γ` of the stages.
const LEFT: f64 = SQRT_2 - 1.0;

impl Readout {
    /// Where something holds, finds accelerations and the forces of loops from the forces less the
    /// bias in `self.vdot`; tells whether it does.
    pub(super) fn hold(&mut self, ctx: &Context, state: &State) -> bool {
        let tree = ctx.tree;
        self.held.any = false;
        self.held.pushed.clear();
        // What rests is in balance.
        let mut trees = ctx.tree.trees.iter().zip(&state.stepping.rested);
        let rests = trees.all(|(tree, rested)| *rested > 0.0 || !tree.moves());
        if rests || state.stepping.last_step <= 0.0 || !self.find_stiff(ctx, state) {
            return false;
        }
        let Self {
            point,
            held,
            vdot,
            closed,
            loops,
            ..
        } = self;
        std::mem::swap(&mut point.terms.joints, &mut held.joints);
        std::mem::swap(&mut point.terms.springs, &mut held.springs);
        held.loosen(&mut point.terms.contacts.list);
        let problem = Problem {
            accuracy: 0.0,
            iterated: 0.0,
            // Velocities satisfy their rows already, and stay as they are.
            ahead: 0.0,
            ..Problem::new((tree, &point.kin), &point.terms, held.tau, 0.0)
        };
        held.newton.guess_start(&problem, &state.physical.v);
        let ended = held.newton.aim(&problem, &mut Run::default(), None);
        let contacts = &point.terms.contacts;
        let factor = held.newton.factor_for(contacts, &held.newton, &problem);
        if let (None, Some(factor)) = (ended, factor) {
            held.any = true;
            tree.sparsity
                .multiply(&point.kin.M, &held.late, &mut held.change);
            for (r, momentum) in vdot.iter_mut().zip(&held.change) {
                *r -= momentum;
            }
            for (term, [_, pull]) in held.joints.iter().zip(&held.motors) {
                vdot[term.dof] += pull;
            }
            held.solve(tree, factor, vdot);
            for (a, late) in vdot.iter_mut().zip(&held.late) {
                *a += late;
            }
            let rows = &point.kin.loops;
            if !rows.is_empty() {
                closed.factor(tree, rows, &factor.inverse(tree));
                closed.close((tree, rows), |row| -rows.bias[row], vdot, loops);
            }
        }
        std::mem::swap(&mut point.terms.joints, &mut held.joints);
        std::mem::swap(&mut point.terms.springs, &mut held.springs);
        if self.held.any {
            self.push_on(ctx, state);
        }
        self.held.tighten(&mut self.point.terms.contacts.list);
        self.held.any
    }

    /// Finds `a_s`, `τ` and the stiffness of joint terms; tells whether anything is stiff.
    fn find_stiff(&mut self, ctx: &Context, state: &State) -> bool {
        let (held, terms) = (&mut self.held, &self.point.terms);
        let (v, trend) = (&state.physical.v, &state.stepping.trend);
        let inverse = &self.point.kin.inverse_diagonal;
        let fixed = ctx.parameters.get(ParameterSlot::StepSize);
        let longest = if fixed > 0.0 { fixed } else { CONTACT_STEP };
        let longest = longest.min(state.stepping.last_step);
        // That of contacts: of what touches, the shortest step.
        let mut step = longest;
        let mut any = false;
        for contact in terms.contacts.iter().filter(|c| c.depth > 0.0) {
            step = step.min(next_step(ctx, state, ctx.tree.bodies[contact.body].tree));
            any = true;
        }
        held.tau = LEFT * step;
        held.joints.clear();
        held.motors.clear();
        for (index, extent) in ctx.tree.trees.iter().enumerate() {
            let h = longest.min(next_step(ctx, state, index));
            let mut dofs = extent.dofs.clone();
            // Not within a step that goes on: its accelerations are those of another time.
            let ended = state.stepping.ahead.length[index] == 0.0;
            let staged =
                ended && dofs.any(|dof| trend.first[dof].to_bits() != trend.whole[dof].to_bits());
            let first = terms.joints.partition_point(|t| t.dof < extent.dofs.start);
            let own = terms.joints[first..].iter();
            for term in own.take_while(|t| t.dof < extent.dofs.end) {
                let counts = staged || term.is_stiff_beside_pd();
                let [mut motor, mut all, mut pull] = [0.0; 3];
                if counts {
                    let (dof, v) = (term.dof, v[term.dof]);
                    motor = LEFT * motor_stiffness(term, v, h);
                    all = motor + LEFT * rest_stiffness(term, v, h);
                    let share = all * inverse[dof];
                    let share = share / (1.0 + share);
                    let asked = asked(ctx, term, (trend, h));
                    let (more, lightness) = asked.unwrap_or_default();
                    let g = motor * lightness.min(inverse[dof]);
                    let firm = motor * g * g / (1.0 + g);
                    pull = firm * more;
                    (motor, all) = (share * motor + firm, share * all + firm);
                    any |= all > 0.0;
                }
                held.motors.push([motor, pull]);
                held.joints.push(JointTerm {
                    dof: term.dof,
                    damping: all / held.tau,
                    gap: [f64::INFINITY; 2],
                    speed_limit: f64::INFINITY,
                    ..JointTerm::default()
                });
            }
        }
        for (dof, late) in held.late.iter_mut().enumerate() {
            *late = late_acceleration(trend, dof);
        }
        any
    }

    /// Finds what contacts push more by, after the accelerations: force sensors want to know.
    fn push_on(&mut self, ctx: &Context, state: &State) {
        let Self {
            point, held, vdot, ..
        } = self;
        let h = held.tau;
        for ((change, a), late) in held.change.iter_mut().zip(vdot.iter()).zip(&held.late) {
            *change = a - late;
        }
        let terms = &point.terms;
        let is_felt = |sensor: &Sensor| matches!(sensor.kind, SensorKind::ForceTorque { .. });
        if terms.contacts.is_empty() || !ctx.model.outputs.sensors.iter().any(is_felt) {
            return;
        }
        forward(ctx.tree, &point.kin.S, &held.change, &mut held.V);
        for (W, V) in held.V.iter_mut().zip(&point.kin.V) {
            let change = *W;
            *W = *V;
            add_scaled6(W, &change, h);
        }
        held.at.set(terms, &held.V);
        terms.respond(&state.physical.v, &held.at, h, &mut held.responses);
        let points = &terms.contacts.points;
        for (i, contact) in terms.contacts.iter().enumerate() {
            let mut pushed = [0.0; 6];
            for (found, sign) in [(&held.responses, 1.0), (&held.newton.responses, -1.0)] {
                held.F[contact.body] = [0.0; 6];
                let own = &found.points[contact.points.clone()];
                contact.push(points, (&found.contacts[i], own), h, &mut held.F);
                add_scaled6(&mut pushed, &held.F[contact.body], sign / h);
            }
            held.pushed.push(pushed);
        }
        for (i, turn) in terms.turns.iter().enumerate() {
            let [more, less] =
                [&held.responses, &held.newton.responses].map(|found| found.turns[i].impulse);
            let moment = (more - less) / h;
            for (sum, x) in held.pushed[turn.contact].iter_mut().zip(&moment) {
                *sum += x;
            }
        }
    }

    /// What a motor gives, N·m or N.
    ///
    /// - `place`: that of its term
    pub(super) fn drive_effort(&self, state: &State, place: usize) -> f64 {
        let term = &self.point.terms.joints[place];
        let v = state.physical.v[term.dof];
        let (force, _) = term.drive_force(v, 0.0);
        let (held, motor) = (&self.held, self.held.motors.get(place));
        let Some([stiffness, pull]) = motor.filter(|motor| held.any && motor[0] > 0.0) else {
            return force;
        };
        let most = term.drive.most();
        let effort = force - stiffness * held.change[term.dof] + pull;
        term.line.cut((effort.clamp(-most, most), 0.0), v).0
    }
}

/// What a step of a tree that is not cut short would take next, s: not much more than its last one.
fn next_step(ctx: &Context, state: &State, tree: usize) -> f64 {
    if ctx.parameters.get(ParameterSlot::StepSize) > 0.0 {
        f64::INFINITY
    } else {
        state.stepping.sizes.proposed[tree]
    }
}

/// By what the acceleration that a velocity motor asks of its joint is more than `a_s`, rad/s² or
/// m/s², and one over the mass for which it is damped critically, 1/(kg·m²) or 1/kg; none of
/// others.
fn asked(ctx: &Context, term: &JointTerm, (trend, h): (&Trend, f64)) -> Option<(f64, f64)> {
    let Drive::Velocity { element, .. } = term.drive else {
        return None;
    };
    let mut even = 0.0;
    if ctx.inputs.varies() && h > 0.0 {
        // Exact for polynomials of the second order.
        let index = term.actuator?;
        let speed = |t| ctx.inputs.command(index, ctx.elapsed + t, 0.0).velocity;
        even = (speed(h) - speed(-h)) / (2.0 * h);
    }
    let first = trend.first[term.dof];
    let late = late_acceleration(trend, term.dof);
    let mut agree = 0.0;
    if first.to_bits() != trend.whole[term.dof].to_bits() {
        agree = (1.0 - (first - late).abs() / (late - even).abs()).max(0.0);
    }
    let lightness = 4.0 * element.stiffness / (element.damping * element.damping);
    Some(((1.0 - agree) * (even - late), lightness))
}

/// Stiffness of a motor over a step of `h` seconds, kg·m² or kg; 0 of one that gives all it can.
fn motor_stiffness(term: &JointTerm, v: f64, h: f64) -> f64 {
    let (asked, slope) = term.drive.force(v, 0.0);
    let (given, _) = term.drive_force(v, 0.0);
    if slope == 0.0 || given.to_bits() != asked.to_bits() {
        return 0.0;
    }
    match &term.drive {
        Drive::Velocity { element, .. } => h * (element.damping + h * element.stiffness),
        drive => -h * drive.force(v, h).1,
    }
}

/// That of all else that a term has.
fn rest_stiffness(term: &JointTerm, v: f64, h: f64) -> f64 {
    let rest = JointTerm {
        drive: Drive::None,
        ..*term
    };
    rest.response(v, h).stiffness
}

#[cfg(test)]
mod tests;
