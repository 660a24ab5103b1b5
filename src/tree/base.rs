//! Where the link of a floating base is, whose solver frame stands in its centre of mass.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::parts::Tree;
use crate::model::RootId;
use crate::spatial::{Pose, Vec3, quaternion_normalized, rotation_from_quaternion};

/// The frame of a floating base in the solver, and the origin of its link, which is what outputs,
/// parameters and the states of Model Exchange are of. With the way `r` from the former to the
/// latter, which turns with the body:
///
/// ```text
/// p_link = p + r,    v_link = v + ω × r,    a_link = a + α × r + ω × (ω × r)
/// ```
#[derive(Clone, Copy, Debug)]
pub struct BaseFrame {
    /// Its first place in `q`: position, then orientation w, x, y, z.
    pub coordinate: usize,
    /// Its first place in `v`: angular velocity, then that of the origin.
    pub dof: usize,
    /// Origin of the solver's frame in the link's, m.
    pub center: Vec3,
}

impl BaseFrame {
    /// `r`, m, world axes, at the quaternion of `q`, of any length.
    #[inline]
    pub fn way(&self, q: &[f64]) -> Vec3 {
        if self.center == Vec3::zeros() {
            return self.center;
        }
        let q = &q[self.coordinate + 3..];
        let turn = quaternion_normalized(&[q[0], q[1], q[2], q[3]]);
        -(rotation_from_quaternion(&turn) * self.center)
    }

    /// The solver's frame in the world, at a quaternion of any length.
    pub fn solver_pose(&self, q: &[f64]) -> Pose {
        let turn = &q[self.coordinate + 3..];
        let turn = quaternion_normalized(&[turn[0], turn[1], turn[2], turn[3]]);
        Pose {
            R: rotation_from_quaternion(&turn),
            p: three(q, self.coordinate),
        }
    }

    /// Position of the link's origin in the world, m.
    #[inline]
    pub fn position(&self, q: &[f64]) -> Vec3 {
        three(q, self.coordinate) + self.way(q)
    }

    /// Velocity of the link's origin, m/s, world axes.
    #[inline]
    pub fn velocity(&self, q: &[f64], v: &[f64]) -> Vec3 {
        three(v, self.dof + 3) + three(v, self.dof).cross(&self.way(q))
    }

    /// Acceleration of the link's origin, m/s², world axes.
    pub fn acceleration(&self, q: &[f64], v: &[f64], vdot: &[f64]) -> Vec3 {
        let (r, w) = (self.way(q), three(v, self.dof));
        three(vdot, self.dof + 3) + three(vdot, self.dof).cross(&r) + w.cross(&w.cross(&r))
    }

    /// Puts the solver's frame to where position and velocity in `q` and `v` are those of the
    /// link's origin.
    #[cfg_attr(small, optimize(size))]
    pub fn take_link(&self, q: &mut [f64], v: &mut [f64]) {
        let r = self.way(q);
        let carried = three(v, self.dof).cross(&r);
        for i in 0..3 {
            q[self.coordinate + i] -= r[i];
            v[self.dof + 3 + i] -= carried[i];
        }
    }
}

impl Tree {
    /// The frame of the base of a tree, if that floats.
    #[inline]
    pub fn base_frame(&self, root: RootId) -> Option<BaseFrame> {
        let extent = &self.trees[root.index()];
        extent.free.then_some(BaseFrame {
            coordinate: extent.coordinates.start,
            dof: extent.dofs.start,
            center: extent.center,
        })
    }
}

#[inline]
fn three(x: &[f64], first: usize) -> Vec3 {
    Vec3::new(x[first], x[first + 1], x[first + 2])
}
