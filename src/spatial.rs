//! Poses, spatial velocities and forces, rigid-body inertia. No tree, no indices.
//!
//! Spatial vectors are angular first: `[ω; v]` and `[τ; f]`. Frames: see `docs/style.md`.
//!
//! Source: Featherstone 2008, chapter 2.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Three components, expressed in the frame that the name says.
pub type Vec3 = Vector3<f64>;
/// A rotation or a symmetric inertia.
pub type Mat3 = Matrix3<f64>;

/// Pose of a frame B in a frame A: `p_A = R p_B + p`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Rotation `R_AB`.
    pub R: Mat3,
    /// Position `p_AoBo_A`, m.
    pub p: Vec3,
}

impl Pose {
    /// The pose that changes nothing.
    pub const IDENTITY: Self = Self {
        R: Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        p: Vec3::new(0.0, 0.0, 0.0),
    };

    /// `X_AC = X_AB * X_BC`.
    pub fn compose(&self, other: &Self) -> Self {
        Self {
            R: self.R * other.R,
            p: self.R * other.p + self.p,
        }
    }

    /// `X_BA` from `X_AB`.
    pub fn inverse(&self) -> Self {
        let R = self.R.transpose();
        Self {
            R,
            p: -(R * self.p),
        }
    }

    /// A point given in B, expressed in A.
    pub fn point(&self, p: &Vec3) -> Vec3 {
        self.R * p + self.p
    }

    /// From a URDF `<origin>`: position in m, fixed-axis roll, pitch, yaw in rad.
    pub fn from_xyz_rpy(xyz: Vec3, rpy: Vec3) -> Self {
        Self {
            R: rotation_from_rpy(&rpy),
            p: xyz,
        }
    }
}

/// `R = Rz(yaw) Ry(pitch) Rx(roll)`, URDF's convention; `libm`, so that platforms agree to the bit.
pub fn rotation_from_rpy(rpy: &Vec3) -> Mat3 {
    let (sr, cr) = libm::sincos(rpy.x);
    let (sp, cp) = libm::sincos(rpy.y);
    let (sy, cy) = libm::sincos(rpy.z);
    Mat3::new(
        cy * cp,
        cy * sp * sr - sy * cr,
        cy * sp * cr + sy * sr,
        sy * cp,
        sy * sp * sr + cy * cr,
        sy * sp * cr - cy * sr,
        -sp,
        cp * sr,
        cp * cr,
    )
}

/// Fixed-axis roll, pitch, yaw of a rotation, rad; pitch in ±π/2, roll 0 where pitch is at ±π/2.
pub fn rpy_from_rotation(R: &Mat3) -> Vec3 {
    let cos_pitch = libm::hypot(R[(0, 0)], R[(1, 0)]);
    let pitch = libm::atan2(-R[(2, 0)], cos_pitch);
    if cos_pitch > 1e-12 {
        let roll = libm::atan2(R[(2, 1)], R[(2, 2)]);
        Vec3::new(roll, pitch, libm::atan2(R[(1, 0)], R[(0, 0)]))
    } else {
        Vec3::new(0.0, pitch, libm::atan2(-R[(0, 1)], R[(1, 1)]))
    }
}

/// Unit quaternion of a rotation.
pub fn quaternion_from_rotation(R: &Mat3) -> UnitQuaternion<f64> {
    // Shepperd's method: divide by the largest of the four candidates.
    let t = R.trace();
    let (w, x, y, z);
    if t > 0.0 {
        let s = 2.0 * (1.0 + t).sqrt();
        w = 0.25 * s;
        x = (R[(2, 1)] - R[(1, 2)]) / s;
        y = (R[(0, 2)] - R[(2, 0)]) / s;
        z = (R[(1, 0)] - R[(0, 1)]) / s;
    } else if R[(0, 0)] > R[(1, 1)] && R[(0, 0)] > R[(2, 2)] {
        let s = 2.0 * (1.0 + R[(0, 0)] - R[(1, 1)] - R[(2, 2)]).sqrt();
        w = (R[(2, 1)] - R[(1, 2)]) / s;
        x = 0.25 * s;
        y = (R[(0, 1)] + R[(1, 0)]) / s;
        z = (R[(0, 2)] + R[(2, 0)]) / s;
    } else if R[(1, 1)] > R[(2, 2)] {
        let s = 2.0 * (1.0 + R[(1, 1)] - R[(0, 0)] - R[(2, 2)]).sqrt();
        w = (R[(0, 2)] - R[(2, 0)]) / s;
        x = (R[(0, 1)] + R[(1, 0)]) / s;
        y = 0.25 * s;
        z = (R[(1, 2)] + R[(2, 1)]) / s;
    } else {
        let s = 2.0 * (1.0 + R[(2, 2)] - R[(0, 0)] - R[(1, 1)]).sqrt();
        w = (R[(1, 0)] - R[(0, 1)]) / s;
        x = (R[(0, 2)] + R[(2, 0)]) / s;
        y = (R[(1, 2)] + R[(2, 1)]) / s;
        z = 0.25 * s;
    }
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// Inertia of a rigid body about its centre of mass, in its link's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RigidInertia {
    /// kg
    pub mass: f64,
    /// Centre of mass `p_BoBcm_B`, m.
    pub com: Vec3,
    /// Rotational inertia about the centre of mass, in the link's axes, kg m².
    pub I_cm: Mat3,
}

impl RigidInertia {
    /// Neither mass nor inertia.
    pub const ZERO: Self = Self {
        mass: 0.0,
        com: Vec3::new(0.0, 0.0, 0.0),
        I_cm: Mat3::from_array_storage(nalgebra::ArrayStorage([[0.0; 3]; 3])),
    };

    /// The same body seen from A, given the pose `X_AB`.
    pub fn transformed(&self, X_AB: &Pose) -> Self {
        Self {
            mass: self.mass,
            com: X_AB.point(&self.com),
            I_cm: X_AB.R * self.I_cm * X_AB.R.transpose(),
        }
    }

    /// Two bodies rigidly joined; both in one frame.
    pub fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass <= 0.0 {
            return Self {
                mass,
                com: self.com,
                I_cm: self.I_cm + other.I_cm,
            };
        }
        let com = (self.com * self.mass + other.com * other.mass) / mass;
        Self {
            mass,
            com,
            I_cm: self.I_cm
                + other.I_cm
                + point_inertia(self.mass, &(self.com - com))
                + point_inertia(other.mass, &(other.com - com)),
        }
    }
}

/// Rotational inertia of a point mass at `c`: `m (c·c 1 − c cᵀ)`.
pub fn point_inertia(mass: f64, c: &Vec3) -> Mat3 {
    (Mat3::identity() * c.dot(c) - c * c.transpose()) * mass
}
