//! The first six coordinates of a floating robot as another program has them, whose base moves by
//! the origin of its link, and as the solver has them, whose base moves by its centre of mass.
//!
//! With the way `r` from the latter to the former, velocities change by `T`, forces by `Tᵀ`:
//!
//! ```text
//! v = v_link − ω × r,    n_link = n − r × f,    M_link = Tᵀ M T,    k_link = Tᵀ (k + M Ṫ v_link)
//! ```

use urdf2fmu_core::model::RootId;
use urdf2fmu_core::spatial::Vec3;
use urdf2fmu_core::tree::{BaseFrame, Tree};

/// The base of a robot in a state; of one that does not float nothing changes.
pub struct Base {
    frame: Option<BaseFrame>,
    r: Vec3,
    w: Vec3,
}

fn three(x: &[f64], first: usize) -> Vec3 {
    Vec3::new(x[first], x[first + 1], x[first + 2])
}

fn add(x: &mut [f64], first: usize, by: Vec3) {
    for i in 0..3 {
        x[first + i] += by[i];
    }
}

impl Base {
    /// Takes positions, velocities and forces of the link to the solver's frame.
    pub fn enter(tree: &Tree, q: &mut [f64], v: &mut [f64], tau: &mut [f64]) -> Self {
        let frame = tree.base_frame(RootId::ROBOT);
        let r = frame.map_or(Vec3::zeros(), |frame| frame.way(q));
        let w = frame.map_or(Vec3::zeros(), |frame| three(v, frame.dof));
        if let Some(frame) = frame {
            frame.take_link(q, v);
            let force = three(tau, frame.dof + 3);
            add(tau, frame.dof, r.cross(&force));
        }
        Self { frame, r, w }
    }

    /// `T x`.
    pub fn velocity(&self, x: &mut [f64]) {
        if let Some(BaseFrame { dof, .. }) = self.frame {
            let turn = three(x, dof);
            add(x, dof + 3, -turn.cross(&self.r));
        }
    }

    /// `Tᵀ f`.
    pub fn force(&self, f: &mut [f64]) {
        if let Some(BaseFrame { dof, .. }) = self.frame {
            let force = three(f, dof + 3);
            add(f, dof, -self.r.cross(&force));
        }
    }

    /// `Ṫ v_link`, of `n` degrees of freedom.
    pub fn drift(&self, n: usize) -> Vec<f64> {
        let mut drift = vec![0.0; n];
        if let Some(BaseFrame { dof, .. }) = self.frame {
            add(&mut drift, dof + 3, -self.w.cross(&self.w.cross(&self.r)));
        }
        drift
    }

    /// The column `k` of `M_link`.
    pub fn column(&self, tree: &Tree, M: &[f64], k: usize) -> Vec<f64> {
        let n = tree.dof.len();
        let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
        unit[k] = 1.0;
        self.velocity(&mut unit);
        tree.sparsity.multiply(M, &unit, &mut column);
        self.force(&mut column);
        column
    }

    /// `k_link`.
    pub fn bias(&self, tree: &Tree, M: &[f64], k: &[f64]) -> Vec<f64> {
        let mut bias = vec![0.0; k.len()];
        tree.sparsity.multiply(M, &self.drift(k.len()), &mut bias);
        for (bias, k) in bias.iter_mut().zip(k) {
            *bias += k;
        }
        self.force(&mut bias);
        bias
    }

    /// Accelerations of the link, from those of the solver's frame.
    pub fn leave(&self, mut vdot: Vec<f64>) -> Vec<f64> {
        let drift = self.drift(vdot.len());
        if let Some(BaseFrame { dof, .. }) = self.frame {
            let turn = three(&vdot, dof);
            add(
                &mut vdot,
                dof + 3,
                turn.cross(&self.r) - three(&drift, dof + 3),
            );
        }
        vdot
    }
}
