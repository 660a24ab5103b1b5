//! `g`, `J` and `J̇v` of the loops that a step works on.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::search::Search;
use crate::spatial::{Mat3, Pose, Vec3, Vec6, angular, linear, velocity_at};
use crate::tree::{Closure, ClosureKind, End, Tree};
use crate::tuning::{LEAST_LEVER, SPARE};
use std::ops::Range;

/// Rows of all loops that a step works on, one after the other.
#[derive(Clone, Debug)]
pub struct Rows {
    /// `g`, m; filled by [`Self::find`].
    pub gap: Vec<f64>,
    /// `J̇v`, m/s²; filled by [`Self::find_bias`].
    pub bias: Vec<f64>,
    /// `J`, of each row at the degrees of freedom of its loop; filled by [`Self::find`].
    ///
    /// What is round-off of its [`Self::sides`] is 0: bodies that turn about one axis are held by
    /// nothing on it, however it lies.
    pub(super) J: Vec<f64>,
    /// Of each entry of `J`, how much its terms amount to that may cancel each other.
    pub(super) sides: Vec<f64>,
    /// Where the entries of each row begin.
    pub(super) start: Vec<usize>,
    /// The loop of each row, and its place among the rows of that.
    of: Vec<usize>,
    place: Vec<usize>,
    /// Which of all rows are worked with: the others say nothing new, see [`Self::select`].
    pub(super) keep: Vec<bool>,
    /// Scratch of [`Self::select`].
    pub(super) search: Search,
}

#[cfg(test)]
crate::spoil::spoil!(Rows: gap bias J sides start of place keep search;);

/// How far a loop is open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gap {
    /// m, or that of a coupler in its own unit.
    pub distance: f64,
    /// rad
    pub angle: f64,
}

/// Where bodies are and how they may move, as [`crate::kinematics::Kinematics`] has them.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    /// O of each tree in the world, m.
    pub origins: &'a [Vec3],
    /// Pose of each body's solver frame from O.
    pub X: &'a [Pose],
    /// Motion of each column.
    pub S: &'a [Vec6],
}

/// Both ends of a loop as they are.
struct Meeting {
    /// Axes of each.
    R: [Mat3; 2],
    /// Place of each from O of its tree, m.
    x: [Vec3; 2],
    /// From the second to the first, m.
    apart: Vec3,
}

impl Meeting {
    fn new(tree: &Tree, places: Places, ends: &[End; 2]) -> Self {
        let poses = ends.map(|end| match end.body {
            Some(body) => places.X[body].compose(&end.X),
            None => end.X,
        });
        let origin = |end: &End| match end.body {
            Some(body) => places.origins[tree.bodies[body].tree],
            None => Vec3::zeros(),
        };
        let x = [poses[0].p, poses[1].p];
        Self {
            R: poses.map(|X| X.R),
            x,
            // Differences first: far from the world's origin its digits are few.
            apart: (origin(&ends[0]) - origin(&ends[1])) + (x[0] - x[1]),
        }
    }

    /// The midpoint, from O of each end's tree.
    fn middle(&self) -> [Vec3; 2] {
        let half = self.apart * 0.5;
        [self.x[0] - half, self.x[1] + half]
    }

    /// What turns the second end to the first one, in its own axes: angle times axis.
    fn turn(&self) -> Vec3 {
        let R = self.R[1].transpose() * self.R[0];
        let axis = Vec3::new(
            R[(2, 1)] - R[(1, 2)],
            R[(0, 2)] - R[(2, 0)],
            R[(1, 0)] - R[(0, 1)],
        );
        let (sine, cosine) = (0.5 * axis.norm(), 0.5 * (R.trace() - 1.0));
        let angle = libm::atan2(sine, cosine);
        if sine > 1e-8 {
            return axis * (0.5 * angle / sine);
        }
        if cosine > 0.0 {
            return axis * 0.5;
        }
        // Half a turn: about the axis that stays.
        let square = (R + Mat3::identity()) * 0.5;
        let column = (0..3).max_by(|a, b| square[(*a, *a)].total_cmp(&square[(*b, *b)]));
        let axis = column.map_or(Vec3::x(), |c| square.column(c).into_owned());
        axis.normalize() * angle
    }

    /// What turns the second z axis to the first one, in the second end's axes: about x and y.
    fn tilt(&self) -> Vec3 {
        let z = self.R[1].transpose() * self.R[0].column(2);
        let (axis, sine) = (Vec3::new(-z.y, z.x, 0.0), (z.x * z.x + z.y * z.y).sqrt());
        if sine > 1e-300 {
            axis * (libm::atan2(sine, z.z) / sine)
        } else if z.z < 0.0 {
            Vec3::x() * std::f64::consts::PI
        } else {
            Vec3::zeros()
        }
    }
}

impl Rows {
    /// How many rows all loops of a tree have.
    pub fn most(tree: &Tree) -> usize {
        tree.closures.iter().map(|c| c.kind.rows()).sum()
    }

    /// Room for all loops of a tree.
    #[cfg_attr(small, optimize(size))]
    pub fn new(tree: &Tree) -> Self {
        let rows = Self::most(tree);
        let entries = tree.closures.iter().map(|c| c.kind.rows() * c.dofs.len());
        let entries = entries.sum();
        Self {
            gap: Vec::with_capacity(rows),
            bias: Vec::with_capacity(rows),
            J: Vec::with_capacity(entries),
            sides: Vec::with_capacity(entries),
            start: Vec::with_capacity(rows),
            of: Vec::with_capacity(rows),
            place: Vec::with_capacity(rows),
            keep: vec![true; rows],
            search: Search::new(rows),
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.gap.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.gap.is_empty()
    }

    /// Rows of a loop, by its index among all; none where the step does not work on it.
    pub fn of(&self, tree: &Tree, closure: usize) -> Range<usize> {
        let rank = |other: usize| tree.closures[other].rank;
        let own = rank(closure);
        let first = self.of.partition_point(|other| rank(*other) < own);
        let end = self.of.partition_point(|other| rank(*other) <= own);
        first..end
    }

    /// Finds gaps and rows where bodies are at `places`.
    pub fn find(&mut self, tree: &Tree, places: Places) {
        self.gap.clear();
        self.J.clear();
        self.sides.clear();
        self.start.clear();
        self.of.clear();
        self.place.clear();
        for (index, closure) in tree.worked_closures() {
            self.append(tree, places, (index, closure));
        }
        for (entry, side) in self.J.iter_mut().zip(&self.sides) {
            if entry.abs() <= SPARE * side {
                *entry = 0.0;
            }
        }
        self.drop_spare(tree);
    }

    /// Works with all rows from now on.
    pub fn keep_all(&mut self) {
        self.keep.fill(true);
    }

    /// Works with the same rows as others do.
    pub fn follow(&mut self, other: &Self) {
        self.keep.copy_from_slice(&other.keep);
    }

    /// `J` of a row, with the degrees of freedom of its loop.
    #[inline]
    pub(super) fn entries<'a>(&'a self, tree: &'a Tree, row: usize) -> (&'a [usize], &'a [f64]) {
        let dofs = &tree.closures[self.of[row]].dofs;
        (dofs, &self.J[self.start[row]..self.start[row] + dofs.len()])
    }

    /// The loop of a row, by its index among all.
    #[inline]
    pub(super) fn closure_of(&self, row: usize) -> usize {
        self.of[row]
    }

    /// Place of a row among those of all loops.
    pub(super) fn index(&self, tree: &Tree, row: usize) -> usize {
        tree.closures[self.of[row]].first + self.place[row]
    }

    /// Drops the rows that are left out; what is known of them stays where it is.
    pub(super) fn drop_spare(&mut self, tree: &Tree) {
        if self.keep.iter().all(|keep| *keep) {
            return;
        }
        let mut kept = 0;
        for row in 0..self.len() {
            if self.keep[self.index(tree, row)] {
                self.gap[kept] = self.gap[row];
                self.start[kept] = self.start[row];
                self.of[kept] = self.of[row];
                self.place[kept] = self.place[row];
                kept += 1;
            }
        }
        self.gap.truncate(kept);
        self.start.truncate(kept);
        self.of.truncate(kept);
        self.place.truncate(kept);
    }

    fn append(&mut self, tree: &Tree, places: Places, (index, closure): (usize, &Closure)) {
        let n = closure.dofs.len();
        let first = self.J.len();
        let count = closure.kind.rows();
        self.J.resize(first + count * n, 0.0);
        self.sides.resize(first + count * n, 0.0);
        for row in 0..count {
            self.start.push(first + row * n);
            self.of.push(index);
            self.place.push(row);
        }
        let (J, sides) = (&mut self.J[first..], &mut self.sides[first..]);
        if let ClosureKind::Coupler { terms, sum, .. } = &closure.kind {
            // The gap is that of positions, which `close_coupler` fills in.
            let lever = lever(tree, closure);
            for (_, place, factor) in terms {
                J[*place] += lever * factor;
                sides[*place] += lever * factor.abs();
            }
            self.gap.push(-lever * sum);
            return;
        }
        let meeting = Meeting::new(tree, places, &closure.ends);
        let middle = meeting.middle();
        let lever = lever(tree, closure);
        let (R, apart) = (&meeting.R[1], &meeting.apart);
        let direction = apart.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        for ((columns, sign), x) in closure.columns.iter().zip([1.0, -1.0]).zip(&middle) {
            for (column, place) in columns {
                let S = &places.S[*column];
                let v = velocity_at(S, x) * sign;
                let side = linear(S).norm() + angular(S).norm() * x.norm();
                if let ClosureKind::Distance(_) = closure.kind {
                    J[*place] += direction.dot(&v);
                    sides[*place] += side;
                    continue;
                }
                for i in 0..3 {
                    J[i * n + place] += v[i];
                    sides[i * n + place] += side;
                }
                let turning = count - 3;
                let w = angular(S) * (sign * lever);
                for i in 0..turning {
                    J[(3 + i) * n + place] += R.column(i).dot(&w);
                    sides[(3 + i) * n + place] += w.norm();
                }
            }
        }
        match closure.kind {
            ClosureKind::Distance(length) => self.gap.push(apart.norm() - length),
            ClosureKind::Coupler { .. } => {}
            ClosureKind::Ball => self.gap.extend(apart.iter()),
            ClosureKind::Hinge => {
                self.gap.extend(apart.iter());
                let tilt = meeting.tilt() * lever;
                self.gap.extend([tilt.x, tilt.y]);
            }
            ClosureKind::Weld => {
                self.gap.extend(apart.iter());
                let turn = meeting.turn() * lever;
                self.gap.extend(turn.iter());
            }
        }
    }

    /// Adds to the gaps of couplers what the positions `q` make of them, after [`Self::find`].
    pub fn find_sums(&mut self, tree: &Tree, q: &[f64]) {
        for (gap, of) in self.gap.iter_mut().zip(&self.of) {
            let closure = &tree.closures[*of];
            if let ClosureKind::Coupler { terms, .. } = &closure.kind {
                let sum: f64 = terms.iter().map(|(c, _, factor)| factor * q[*c]).sum();
                *gap += lever(tree, closure) * sum;
            }
        }
    }

    /// Finds `J̇v` where bodies have the velocities `V` and the accelerations `C` without `v̇`, in
    /// which gravity is an upward acceleration of the bases.
    pub fn find_bias(&mut self, tree: &Tree, places: Places, (V, C): (&[Vec6], &[Vec6])) {
        self.bias.clear();
        let mut last = (usize::MAX, [0.0; 6]);
        for (of, place) in self.of.iter().zip(&self.place) {
            if last.0 != *of {
                let closure = &tree.closures[*of];
                last = (*of, Self::bias_of(tree, places, (V, C), closure));
            }
            self.bias.push(last.1[*place]);
        }
    }

    /// `J̇v` of all rows of a loop.
    fn bias_of(
        tree: &Tree,
        places: Places,
        (V, C): (&[Vec6], &[Vec6]),
        closure: &Closure,
    ) -> [f64; 6] {
        let mut found = [0.0; 6];
        if let ClosureKind::Coupler { .. } = closure.kind {
            return found;
        }
        let meeting = Meeting::new(tree, places, &closure.ends);
        let g = tree.world.gravity;
        let still = ([0.0; 6], [0.0, 0.0, 0.0, -g.x, -g.y, -g.z]);
        let motions = closure
            .ends
            .map(|end| end.body.map_or(still, |b| (V[b], C[b])));
        let [first, second] = [0, 1].map(|i| {
            let (V, C) = &motions[i];
            let (w, x) = (angular(V), &meeting.x[i]);
            let v = velocity_at(V, x);
            (v, linear(C) + angular(C).cross(x) + w.cross(&v))
        });
        let (v, a) = (first.0 - second.0, first.1 - second.1);
        if let ClosureKind::Distance(_) = closure.kind {
            let length = meeting.apart.norm().max(f64::MIN_POSITIVE);
            let direction = meeting.apart / length;
            let along = direction.dot(&v);
            let across = (v.norm_squared() - along * along).max(0.0);
            found[0] = direction.dot(&a) + across / length;
            return found;
        }
        found[..3].copy_from_slice(a.as_slice());
        let turning = closure.kind.rows() - 3;
        let lever = lever(tree, closure);
        let [w, other] = motions.map(|(V, _)| angular(&V));
        let turn = angular(&motions[0].1) - angular(&motions[1].1);
        for i in 0..turning {
            let axis = meeting.R[1].column(i).into_owned();
            let bias = axis.dot(&turn) + other.cross(&axis).dot(&(w - other));
            found[3 + i] = lever * bias;
        }
        found
    }

    /// `J x` of a row.
    #[inline]
    pub fn along(&self, tree: &Tree, row: usize, x: &[f64]) -> f64 {
        let (dofs, J) = self.entries(tree, row);
        J.iter().zip(dofs).map(|(j, dof)| j * x[*dof]).sum()
    }

    /// `x += share · Jᵀ` of a row.
    #[inline]
    pub fn add(&self, tree: &Tree, row: usize, share: f64, x: &mut [f64]) {
        let (dofs, J) = self.entries(tree, row);
        for (j, dof) in J.iter().zip(dofs) {
            x[*dof] += share * j;
        }
    }

    /// `x −= Jᵀ λ`.
    pub fn subtract(&self, tree: &Tree, forces: &[f64], x: &mut [f64]) {
        for (row, force) in forces.iter().enumerate() {
            self.add(tree, row, -force, x);
        }
    }

    /// The largest gap, m; infinite where one is not a number.
    pub fn largest(&self) -> f64 {
        self.gap.iter().fold(0.0, |most: f64, gap| {
            if gap.is_nan() {
                f64::INFINITY
            } else {
                most.max(gap.abs())
            }
        })
    }

    /// How far a loop is open.
    pub fn opening(&self, tree: &Tree, closure: usize) -> Gap {
        let gap = &self.gap[self.of(tree, closure)];
        let lever = lever(tree, &tree.closures[closure]);
        let norm = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>().sqrt();
        if let ClosureKind::Coupler { .. } = tree.closures[closure].kind {
            return Gap {
                distance: norm(gap) / lever,
                angle: 0.0,
            };
        }
        let (distance, angle) = gap.split_at(gap.len().min(3));
        Gap {
            distance: norm(distance),
            angle: norm(angle) / lever,
        }
    }

    /// The loop that is open widest, if there is one, and how far.
    pub fn widest(&self, tree: &Tree) -> Option<(usize, Gap)> {
        let openings = (0..tree.closures.len()).map(|c| (c, self.opening(tree, c)));
        let size = |gap: &Gap| gap.distance + gap.angle;
        openings.max_by(|a, b| size(&a.1).total_cmp(&size(&b.1)))
    }

    /// Force, N, and torque about the midpoint, N·m, of a loop on the body of its first end, world
    /// axes, and that midpoint from the first end, from the forces of all rows. For a coupler: the
    /// force along its sum, as that in x.
    pub fn wrench(&self, tree: &Tree, places: Places, closure: usize, forces: &[f64]) -> [Vec3; 3] {
        let own = &forces[self.of(tree, closure)];
        let part = &tree.closures[closure];
        let lever = lever(tree, part);
        if own.is_empty() {
            return [Vec3::zeros(); 3];
        }
        if let ClosureKind::Coupler { .. } = part.kind {
            return [Vec3::x() * (own[0] * lever), Vec3::zeros(), Vec3::zeros()];
        }
        let meeting = Meeting::new(tree, places, &part.ends);
        let back = -meeting.apart * 0.5;
        if let ClosureKind::Distance(_) = part.kind {
            let direction = meeting.apart.try_normalize(f64::MIN_POSITIVE);
            return [
                direction.unwrap_or_default() * own[0],
                Vec3::zeros(),
                Vec3::zeros(),
            ];
        }
        let force = Vec3::new(own[0], own[1], own[2]);
        let mut torque = Vec3::zeros();
        for (i, x) in own[3..].iter().enumerate() {
            torque += meeting.R[1].column(i) * (lever * x);
        }
        [force, torque, back]
    }
}

/// What makes rad of a loop's turning, or the unit of a coupler, to metres: the reach of what
/// turns, or how far the loop's ends are from where their bodies turn. A body that is held 0.3 m
/// beside itself turns about that place: angles that counted less, as those of a body without
/// shapes, would be held by forces of fewer digits.
fn lever(tree: &Tree, closure: &Closure) -> f64 {
    if let ClosureKind::Coupler { terms, .. } = &closure.kind {
        let most = terms.iter().fold((0, 0.0_f64), |most, (_, place, factor)| {
            if factor.abs() > most.1 {
                (*place, factor.abs())
            } else {
                most
            }
        });
        return tree.dofs.weight[closure.dofs[most.0]] / most.1.max(f64::MIN_POSITIVE);
    }
    let trees = closure.trees.iter().flatten();
    let reaches = trees.map(|index| tree.trees[*index].reach);
    let ends = closure.ends.iter().filter(|end| end.body.is_some());
    let distances = ends.map(|end| end.X.p.norm());
    reaches.chain(distances).fold(LEAST_LEVER, f64::max)
}
