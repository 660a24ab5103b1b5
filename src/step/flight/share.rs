//! How one part takes up the momentum that it lacks.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::Kinematics;
use crate::spatial::{SpatialInertia, Vec3, Vec6, add_scaled6, add6, angular, dot6, join, linear};
use crate::tree::Tree;
use crate::tuning::THIN;

/// A matrix of twists and wrenches.
type Mat6 = [Vec6; 6];

/// What a part keeps; world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
    /// Index in [`Tree::kept`].
    pub kept: usize,
    /// The origin of its tree, m.
    pub origin: Vec3,
    /// The centre of mass, from the tree's origin, m.
    pub center: Vec3,
    /// Of all its bodies, about the tree's origin.
    pub inertia: SpatialInertia,
    /// Linear momentum, N·s.
    pub linear: Vec3,
    /// Angular momentum about the centre of mass, N·m·s.
    pub angular: Vec3,
}

impl Flight {
    /// What stands in poses, inertias and velocities.
    pub fn of(tree: &Tree, kin: &Kinematics, kept: usize) -> Self {
        let part = &tree.kept[kept];
        let bodies = part.body..tree.trees[part.tree].bodies.end;
        let mut whole = SpatialInertia::default();
        let mut momentum = [0.0; 6];
        for b in bodies.filter(|b| tree.is_carried(*b, kept)) {
            whole.add(&kin.I[b]);
            add6(&mut momentum, &kin.I[b].mul(&kin.V[b]));
        }
        let (center, linear) = (whole.center(), linear(&momentum));
        Self {
            kept,
            origin: kin.origins[part.tree],
            center,
            inertia: whole,
            linear,
            angular: angular(&momentum) - center.cross(&linear),
        }
    }

    /// The centre of mass from that of another one, m.
    pub fn lever(&self, from: &Self) -> Vec3 {
        // Differences first: far from the world's origin its digits are few.
        (self.origin - from.origin) + self.center - from.center
    }
}

/// How a part takes up what it lacks. Twists, inertias and momenta of all parts that push or carry
/// each other are about one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    /// What it is in now.
    pub now: Flight,
    /// Place in the list of the one by whose columns its company moves, and of the free part that
    /// it hangs on.
    pub chief: usize,
    pub outer: Option<usize>,
    /// Its centre of mass from the place, m.
    pub lever: Vec3,
    /// By how much its centre of mass lacks, m.
    pub moved: Vec3,
    /// Columns of its joints, the slides first.
    pub S: Mat6,
    /// Inertia and lacking momentum, of all that moves with it.
    pub I: Mat6,
    pub p: Vec6,
    /// `U`, and the lower factor of `D` of so many columns.
    pub U: Mat6,
    pub L: Mat6,
    pub slides: usize,
    pub count: usize,
    /// Whether all of its company can move as the chief does.
    pub fits: bool,
    /// Whether it turns to take up what it lacks.
    pub turns: bool,
    /// How it moves, and what its joints take up.
    pub twist: Vec6,
    pub change: Vec6,
}

impl Share {
    /// Begins with what is lacking about the centre of mass, angular and linear, and the first
    /// `count` columns.
    pub fn begin(&mut self, (spin, push): &(Vec3, Vec3), count: usize) {
        let inertia = &self.now.inertia;
        let c = inertia.about_center();
        let c = [
            c[(0, 0)],
            c[(1, 1)],
            c[(2, 2)],
            c[(0, 1)],
            c[(0, 2)],
            c[(1, 2)],
        ];
        let whole = SpatialInertia::new(inertia.mass, &self.lever, &c);
        for (i, row) in self.I.iter_mut().enumerate() {
            let mut unit = [0.0; 6];
            unit[i] = 1.0;
            *row = whole.mul(&unit);
        }
        self.p = join(&(spin + self.lever.cross(push)), push);
        self.count = if self.fits { count } else { 0 };
    }

    /// Adds an inertia and what it lacks.
    pub fn add(&mut self, I: &Mat6, p: &Vec6) {
        for (row, other) in self.I.iter_mut().zip(I) {
            add6(row, other);
        }
        add6(&mut self.p, p);
    }

    /// Finds `U` and the factor of `D`, of as many columns as have one; of slides alone where all
    /// is as thin as a rod about some direction in which it turns.
    pub fn factor(&mut self) {
        for j in 0..self.count {
            self.U[j] = self.I.map(|row| dot6(&row, &self.S[j]));
        }
        let slides = self.slides.min(self.count);
        let mut turns = [0.0; 2];
        for i in 0..self.count {
            for j in 0..=i {
                let mut d = dot6(&self.S[i], &self.U[j]);
                for k in 0..j {
                    d -= self.L[i][k] * self.L[j][k];
                }
                self.L[i][j] = if i == j { d.sqrt() } else { d / self.L[j][j] };
            }
        }
        // Traces of what slides leave of `D`, and of its inverse.
        for i in slides..self.count {
            let mut inverse = [0.0; 6];
            inverse[i] = 1.0 / self.L[i][i];
            for k in i + 1..self.count {
                let row = &self.L[k];
                let sum: f64 = (i..k).map(|j| row[j] * inverse[j]).sum();
                inverse[k] = -sum / row[k];
            }
            turns[0] += self.L[i][slides..=i].iter().map(|x| x * x).sum::<f64>();
            turns[1] += inverse.iter().map(|x| x * x).sum::<f64>();
        }
        let compact = turns[0] * turns[1] * THIN < 1.0;
        if !compact {
            self.count = slides;
        }
    }

    /// `D⁻¹ x`.
    fn divided(&self, mut x: Vec6) -> Vec6 {
        for i in 0..self.count {
            for j in 0..i {
                x[i] -= self.L[i][j] * x[j];
            }
            x[i] /= self.L[i][i];
        }
        for i in (0..self.count).rev() {
            for j in i + 1..self.count {
                x[i] -= self.L[j][i] * x[j];
            }
            x[i] /= self.L[i][i];
        }
        x
    }

    /// `Sᵀ p − Uᵀ ξ`.
    fn lacks(&self, carried: &Vec6) -> Vec6 {
        std::array::from_fn(|j| {
            if j < self.count {
                dot6(&self.S[j], &self.p) - dot6(&self.U[j], carried)
            } else {
                0.0
            }
        })
    }

    /// `−U D⁻¹ Uᵀ` and `−U D⁻¹ Sᵀ p`: what it takes up itself.
    pub fn given_back(&self) -> (Mat6, Vec6) {
        let row = |x: Vec6| {
            let mut sum = [0.0; 6];
            for (U, x) in self.U[..self.count].iter().zip(x) {
                add_scaled6(&mut sum, U, -x);
            }
            sum
        };
        let I = std::array::from_fn(|i| row(self.divided(self.U.map(|column| column[i]))));
        (I, row(self.divided(self.lacks(&[0.0; 6]))))
    }

    /// Takes up what it lacks where what it hangs on moves by `carried`.
    pub fn solve(&mut self, carried: &Vec6) {
        self.change = self.divided(self.lacks(carried));
        self.twist = *carried;
        for (S, change) in self.S[..self.count].iter().zip(self.change) {
            add_scaled6(&mut self.twist, S, change);
        }
    }

    /// Moves by a twist.
    pub fn follow(&mut self, twist: &Vec6) {
        self.p = self.I.map(|row| dot6(&row, twist));
        self.factor();
        self.solve(&[0.0; 6]);
    }
}

#[cfg(test)]
crate::spoil::spoil!(
    Share: now chief outer lever moved S I p U L slides count fits turns twist change;
);
#[cfg(test)]
crate::spoil::spoil!(Flight: kept origin center inertia linear angular;);
