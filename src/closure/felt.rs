//! What motors in closed loops move and carry.
//!
//! A motor plans with the mass that it moves and the load that it carries. In a tree these are the
//! diagonal of `M` and the bias: those of what is beyond the joint, with all other joints held. In
//! a loop other joints must follow, and what they carry is felt, too: a cylinder of a kilogram that
//! lifts a boom of a tonne feels the tonne. For the degrees of freedom of all loops, with all
//! others held:
//!
//! 1. `P = M⁻¹ − Y W⁻¹ Yᵀ` with `Y = M⁻¹Jᵀ` and `W = J Y` is what forces make of accelerations
//!    within the loops. Without forces of motors these are `v̇₀ = −P k − Y W⁻¹ J̇v`. With the
//!    factors `M = L Lᵀ` and `W = C Cᵀ`, `Z = L⁻¹Jᵀ`, and for each motor `z = L⁻¹e` and
//!    `w = C⁻¹Zᵀz`, it is `P_ab = z_a·z_b − w_a·w_b`. Likewise `v̇₀_a = z_a·z − w_a·w` with
//!    `z = −L⁻¹k` and `w = C⁻¹(Zᵀz + J̇v)`.
//! 2. Along the joint `j` the loops move like the mass `1/P_jj`. What is beyond the joint counts at
//!    least, as in a tree.
//! 3. The motors carry what holds their joints: `P_AA τ = −v̇₀_A` for the joints `A` that have one.
//!    With more of them than the loops have freedoms `P_AA` has no inverse, and joints that move
//!    cannot all be without acceleration. So `τ` has the least sum of the squares of what is left
//!    of the accelerations and, by [`SHARED_LOAD`], of forces, `(P_AA² + ε²) τ = −P_AA v̇₀_A`, in
//!    units of the diagonal: such motors share their load.
//!
//! Rows and motors have entries at the parts of the joint-space matrix that they act on alone, and
//! motors that no loop joins have none in common: what is zero is neither computed nor kept.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rows::Rows;
use super::skyline::Skyline;
use crate::model::{ActuatorMode, Model};
use crate::tree::{Closure, Tree};
use crate::tuning::{LOOP_COMPLIANCE, SHARED_LOAD, SPARE};
use std::ops::Range;

/// Mass and load of the motors in loops.
#[derive(Clone, Debug)]
pub struct Felt {
    /// Whether a motor holds a joint, and there is a loop.
    needed: bool,
    /// Of each actuator, kg·m² or kg, and N·m or N; none outside of loops.
    of: Vec<Option<[f64; 2]>>,
    /// Degrees of freedom of the loops, ascending.
    dofs: Vec<usize>,
    /// Actuators that hold joints of loops.
    motors: Vec<Motor>,
    L: Skyline,
    /// One row a row of the loops, each at the places that `spans` tells, from `starts` on.
    Z: Vec<f64>,
    spans: Vec<Range<usize>>,
    starts: Vec<usize>,
    C: Skyline,
    /// `z` and `w` of the motors, one after the other, and last those of `v̇₀`; of the motors where
    /// their places and rows are.
    z: Vec<f64>,
    w: Vec<f64>,
    /// `P_AA` in units of its diagonal, the factor of its square, and what makes a force or an
    /// acceleration of a unit.
    P: Vec<f64>,
    square: Skyline,
    scale: Vec<f64>,
    /// `−v̇₀_A`, then `τ`, in these units.
    asked: Vec<f64>,
    loads: Vec<f64>,
}

#[cfg(test)]
crate::spoil::spoil!(
    Felt: dofs L Z spans starts C z w P square scale asked loads; needed of motors
);

/// An actuator that holds a joint of a loop.
#[derive(Clone, Debug)]
struct Motor {
    index: usize,
    /// Places of the degrees of freedom of loops from its own to the last one of its part.
    span: Range<usize>,
    /// Rows of loops that it may do something to, and motors, by their places in the list.
    rows: Range<usize>,
    beside: Range<usize>,
}

/// What masses and loads are found from.
#[derive(Clone, Copy, Debug)]
pub struct Carried<'a> {
    /// Mass matrix, packed as [`Tree::sparsity`] says.
    pub M: &'a [f64],
    /// `1 / M_kk`
    pub inverse_diagonal: &'a [f64],
    /// `k`
    pub bias: &'a [f64],
    /// `J` and `J̇v`
    pub rows: &'a Rows,
}

impl Felt {
    /// Room for all loops of a robot; none where no motor holds a joint, or there is no loop.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let mut motors = model.actuators.iter();
        let needed = !tree.closures.is_empty() && motors.any(|a| a.mode != ActuatorMode::Effort);
        let room = usize::from(needed);
        let nv = room * tree.sparsity.len();
        let (m, k) = (room * Rows::most(tree), room * model.actuators.len());
        Self {
            needed,
            of: vec![None; model.actuators.len()],
            dofs: Vec::with_capacity(nv),
            motors: Vec::with_capacity(k),
            L: Skyline::new(nv),
            Z: Vec::with_capacity(m * nv),
            spans: Vec::with_capacity(m),
            starts: Vec::with_capacity(m),
            C: Skyline::new(m),
            z: vec![0.0; (k + 1) * nv],
            w: vec![0.0; (k + 1) * m],
            P: vec![0.0; k * k],
            square: Skyline::new(k),
            scale: Vec::with_capacity(k),
            asked: Vec::with_capacity(k),
            loads: Vec::with_capacity(k),
        }
    }

    /// Mass, kg·m² or kg, and load, N·m or N, of an actuator whose joint is in a loop.
    pub fn of(&self, actuator: usize) -> Option<[f64; 2]> {
        self.of[actuator]
    }

    /// Finds them.
    ///
    /// - `acts`: whether an actuator has an effort to hold its joint with
    pub fn find(
        &mut self,
        (model, tree): (&Model, &Tree),
        at: Carried,
        acts: impl Fn(usize) -> bool,
    ) {
        self.of.fill(None);
        if !self.needed || !tree.is_closed() {
            return;
        }
        self.select(model, tree, acts);
        if !self.motors.is_empty() {
            self.factor(tree, at);
            self.gather();
            self.reduce(at);
            self.share(at);
        }
    }

    /// Which degrees of freedom and motors are in loops.
    fn select(&mut self, model: &Model, tree: &Tree, acts: impl Fn(usize) -> bool) {
        self.dofs.clear();
        for (_, closure) in tree.worked_closures() {
            for dof in &closure.dofs {
                if let Err(place) = self.dofs.binary_search(dof) {
                    self.dofs.insert(place, *dof);
                }
            }
        }
        self.motors.clear();
        for (index, actuator) in model.actuators.iter().enumerate() {
            if actuator.mode != ActuatorMode::Effort && acts(index) {
                let dof = actuator.dof.index();
                if let Ok(place) = self.dofs.binary_search(&dof) {
                    self.motors.push(Motor {
                        index,
                        span: place..self.end(tree, tree.sparsity.part_of(dof)),
                        rows: 0..0,
                        beside: 0..0,
                    });
                }
            }
        }
    }

    /// Where the degrees of freedom of a part end in `dofs`.
    fn end(&self, tree: &Tree, part: usize) -> usize {
        let end = tree.sparsity.parts[part].own.rows.end;
        self.dofs.partition_point(|dof| *dof < end)
    }

    /// `L`, `Z` and `C`.
    fn factor(&mut self, tree: &Tree, at: Carried) {
        self.L.clear();
        let mut begin = 0;
        for (place, dof) in self.dofs.iter().enumerate() {
            let part = &tree.sparsity.parts[tree.sparsity.part_of(*dof)].own.rows;
            while self.dofs[begin] < part.start {
                begin += 1;
            }
            let others = &self.dofs[begin..=place];
            for (entry, other) in self.L.add(begin).iter_mut().zip(others) {
                *entry = tree.sparsity.entry(at.M, *dof, *other);
            }
        }
        self.L.factor();
        self.Z.clear();
        self.spans.clear();
        self.starts.clear();
        self.C.clear();
        let mut last = (usize::MAX, 0..0);
        for row in 0..at.rows.len() {
            let index = at.rows.closure_of(row);
            if last.0 != index {
                let Closure { dofs, parts, .. } = &tree.closures[index];
                let begin = |dof: &usize| self.dofs.partition_point(|other| other < dof);
                let ends = dofs.first().zip(parts.last());
                let span = ends.map_or(0..0, |(dof, part)| begin(dof)..self.end(tree, *part));
                last = (index, span);
            }
            let own = last.1.clone();
            let start = self.Z.len();
            self.Z.resize(start + own.len(), 0.0);
            let z = &mut self.Z[start..];
            let (dofs, entries) = at.rows.entries(tree, row);
            for (dof, entry) in dofs.iter().zip(entries) {
                z[self.dofs.partition_point(|other| other < dof) - own.start] += entry;
            }
            self.L.forward_span(own.clone(), z);
            self.spans.push(own);
            self.starts.push(start);
            let meets = |other: &usize| !common(&self.spans[*other], &self.spans[row]).is_empty();
            let first = (0..row).find(meets).unwrap_or(row);
            for (entry, other) in self.C.add(first).iter_mut().zip(first..) {
                let both = common(&self.spans[other], &self.spans[row]);
                let [a, b] = [other, row].map(|row| {
                    let from = both.start - self.spans[row].start;
                    &self.Z[self.starts[row] + from..][..both.len()]
                });
                *entry = dot(a, b);
            }
        }
        self.C.soften(LOOP_COMPLIANCE);
        self.C.factor();
    }

    /// What each motor may do something to: what is in its part, and what loops join with that.
    fn gather(&mut self) {
        for i in 0..self.motors.len() {
            let span = self.motors[i].span.clone();
            let alike = i > 0 && self.motors[i - 1].span.end == span.end;
            self.motors[i].rows = if alike {
                self.motors[i - 1].rows.clone()
            } else {
                let meets = |own: &Range<usize>| !common(own, &span).is_empty();
                let row = self.spans.iter().position(meets);
                row.map_or(0..0, |row| self.C.block(row))
            };
        }
        for i in 0..self.motors.len() {
            let motor = &self.motors[i];
            let joined = |other: &Motor| {
                other.span.end == motor.span.end
                    || !motor.rows.is_empty() && other.rows == motor.rows
            };
            let beside = if i > 0 && joined(&self.motors[i - 1]) {
                self.motors[i - 1].beside.clone()
            } else {
                let first = self.motors.iter().position(joined).unwrap_or(i);
                let last = self.motors.iter().rposition(joined).unwrap_or(i);
                first..last + 1
            };
            self.motors[i].beside = beside;
        }
    }

    /// `z` and `w` of the motors and of `v̇₀`.
    fn reduce(&mut self, at: Carried) {
        let (n, m, k) = (self.dofs.len(), at.rows.len(), self.motors.len());
        for i in 0..=k {
            let z = &mut self.z[i * n..(i + 1) * n];
            let w = &mut self.w[i * m..(i + 1) * m];
            let (span, rows) = if let Some(motor) = self.motors.get(i) {
                z[motor.span.clone()].fill(0.0);
                z[motor.span.start] = 1.0;
                w[motor.rows.clone()].fill(0.0);
                (motor.span.clone(), motor.rows.clone())
            } else {
                for (z, dof) in z.iter_mut().zip(&self.dofs) {
                    *z = -at.bias[*dof];
                }
                w.copy_from_slice(&at.rows.bias[..m]);
                (0..n, 0..m)
            };
            self.L.forward_span(span.clone(), &mut z[span.clone()]);
            for row in rows.clone() {
                let own = &self.spans[row];
                let both = common(own, &span);
                let Z = &self.Z[self.starts[row] + both.start - own.start..][..both.len()];
                w[row] += dot(Z, &z[both]);
            }
            self.C.forward_span(rows.clone(), &mut w[rows]);
        }
    }

    /// Masses, and shares of the load.
    fn share(&mut self, at: Carried) {
        let (n, m, k) = (self.dofs.len(), at.rows.len(), self.motors.len());
        let (z, w, P, motors) = (&self.z, &self.w, &mut self.P, &self.motors);
        // With another motor, or with `v̇₀`.
        let product = |a: usize, b: usize| {
            let Motor { span, rows, .. } = &motors[a];
            let both = motors
                .get(b)
                .map_or(span.clone(), |b| common(span, &b.span));
            let along = dot(&z[a * n..][both.clone()], &z[b * n..][both]);
            along - dot(&w[a * m..][rows.clone()], &w[b * m..][rows.clone()])
        };
        self.scale.clear();
        for (i, motor) in motors.iter().enumerate() {
            let z = &z[i * n..][motor.span.clone()];
            // What cannot move at all is heavy.
            let mobility = product(i, i).max(SPARE * dot(z, z));
            self.scale.push(1.0 / mobility.sqrt());
        }
        self.asked.clear();
        for (i, motor) in motors.iter().enumerate() {
            let scale = &self.scale;
            for j in motor.beside.start..=i {
                let joined = motors[j].beside == motor.beside;
                let along = if joined { product(i, j) } else { 0.0 };
                P[i * k + j] = along * scale[i] * scale[j];
                P[j * k + i] = along * scale[j] * scale[i];
            }
            self.asked.push(-product(i, k) * scale[i]);
        }
        self.square.clear();
        self.loads.clear();
        for (i, motor) in motors.iter().enumerate() {
            let own = motor.beside.clone();
            let row = |i: usize| &P[i * k..][own.clone()];
            let entries = self.square.add(own.start);
            for (entry, j) in entries.iter_mut().zip(own.start..) {
                if motors[j].beside == own {
                    *entry = dot(row(i), row(j));
                }
            }
            entries[i - own.start] += SHARED_LOAD * SHARED_LOAD;
            self.loads.push(dot(row(i), &self.asked[own.clone()]));
        }
        self.square.factor();
        self.square.divide(&mut self.loads);
        for (i, motor) in motors.iter().enumerate() {
            let beyond = 1.0 / at.inverse_diagonal[self.dofs[motor.span.start]];
            let mass = (self.scale[i] * self.scale[i]).max(beyond);
            self.of[motor.index] = Some([mass, self.loads[i] * self.scale[i]]);
        }
    }
}

/// What two ranges have in common.
fn common(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    let start = a.start.max(b.start);
    start..a.end.min(b.end).max(start)
}

#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
