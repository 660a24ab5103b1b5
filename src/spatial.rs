//! Poses, spatial velocities and forces, rigid-body inertia. This module does not know trees or
//! indices.
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
    #[must_use]
    pub fn compose(&self, other: &Self) -> Self {
        Self {
            R: self.R * other.R,
            p: self.R * other.p + self.p,
        }
    }

    /// `X_BA` from `X_AB`.
    #[must_use]
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
    #[must_use]
    #[cfg_attr(small, optimize(size))]
    pub fn transformed(&self, X_AB: &Pose) -> Self {
        Self {
            mass: self.mass,
            com: X_AB.point(&self.com),
            I_cm: X_AB.R * self.I_cm * X_AB.R.transpose(),
        }
    }

    /// Two bodies rigidly joined; both in one frame.
    #[must_use]
    #[cfg_attr(small, optimize(size))]
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

/// A spatial vector `[angular; linear]`, world axes, about the common point O.
pub type Vec6 = [f64; 6];

/// The angular half.
#[inline]
pub fn angular(a: &Vec6) -> Vec3 {
    Vec3::new(a[0], a[1], a[2])
}

/// The linear half.
#[inline]
pub fn linear(a: &Vec6) -> Vec3 {
    Vec3::new(a[3], a[4], a[5])
}

/// `[angular; linear]` from its halves.
#[inline]
pub fn join(angular: &Vec3, linear: &Vec3) -> Vec6 {
    [
        angular.x, angular.y, angular.z, linear.x, linear.y, linear.z,
    ]
}

/// Power of a force on a velocity: `τ·ω + f·v`. Two running sums, so that two lanes suffice.
#[inline]
pub fn dot6(a: &Vec6, b: &Vec6) -> f64 {
    (a[0] * b[0] + a[2] * b[2] + a[4] * b[4]) + (a[1] * b[1] + a[3] * b[3] + a[5] * b[5])
}

/// `a += b · s`.
#[inline]
pub fn add_scaled6(a: &mut Vec6, b: &Vec6, s: f64) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b * s;
    }
}

/// `a += b`.
#[inline]
pub fn add6(a: &mut Vec6, b: &Vec6) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b;
    }
}

/// Velocity of the body point at `x` from O: `u + ω × x`.
#[inline]
pub fn velocity_at(V: &Vec6, x: &Vec3) -> Vec3 {
    Vec3::new(
        V[3] + V[1] * x.z - V[2] * x.y,
        V[4] + V[2] * x.x - V[0] * x.z,
        V[5] + V[0] * x.y - V[1] * x.x,
    )
}

/// Adds a force `f` acting at `x` to the spatial force `F` about O.
#[inline]
pub fn add_force_at(F: &mut Vec6, x: &Vec3, f: &Vec3) {
    F[0] += x.y * f.z - x.z * f.y;
    F[1] += x.z * f.x - x.x * f.z;
    F[2] += x.x * f.y - x.y * f.x;
    F[3] += f.x;
    F[4] += f.y;
    F[5] += f.z;
}

/// `(ω; u) ×m (a; b) = (ω × a ; ω × b + u × a)`.
#[inline]
pub fn cross_motion(V: &Vec6, W: &Vec6) -> Vec6 {
    let (w, u) = (angular(V), linear(V));
    let (a, b) = (angular(W), linear(W));
    join(&w.cross(&a), &(w.cross(&b) + u.cross(&a)))
}

/// `(ω; u) ×f (n; f) = (ω × n + u × f ; ω × f)`.
#[inline]
pub fn cross_force(V: &Vec6, F: &Vec6) -> Vec6 {
    let (w, u) = (angular(V), linear(V));
    let (n, f) = (angular(F), linear(F));
    join(&(w.cross(&n) + u.cross(&f)), &w.cross(&f))
}

/// Inertia of a rigid body about O in world axes: mass, first moment, rotational inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpatialInertia {
    /// kg
    pub mass: f64,
    /// `m c`, with `c` from O to the centre of mass, kg·m.
    pub moment: [f64; 3],
    /// About O: xx, yy, zz, xy, xz, yz, kg·m².
    pub rotational: [f64; 6],
}

impl SpatialInertia {
    /// Of a mass `m` with centre of mass `c` (from O) and inertia `I_cm` (xx, yy, zz, xy, xz, yz)
    /// about it, world axes.
    #[inline]
    pub fn new(m: f64, c: &Vec3, I_cm: &[f64; 6]) -> Self {
        let (x, y, z) = (c.x, c.y, c.z);
        Self {
            mass: m,
            moment: [m * x, m * y, m * z],
            rotational: [
                I_cm[0] + m * (y * y + z * z),
                I_cm[1] + m * (x * x + z * z),
                I_cm[2] + m * (x * x + y * y),
                I_cm[3] - m * x * y,
                I_cm[4] - m * x * z,
                I_cm[5] - m * y * z,
            ],
        }
    }

    /// Centre of mass from O, m.
    pub fn center(&self) -> Vec3 {
        Vec3::from(self.moment) / self.mass
    }

    /// Rotational inertia about the centre of mass, kg·m².
    pub fn about_center(&self) -> Mat3 {
        let [xx, yy, zz, xy, xz, yz] = self.rotational;
        let lever = self.center().cross_matrix();
        Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) + lever * lever * self.mass
    }

    /// Momentum of a velocity: `(Ī ω + h × u ; m u − h × ω)`.
    #[inline]
    pub fn mul(&self, V: &Vec6) -> Vec6 {
        let [h0, h1, h2] = self.moment;
        let i = &self.rotational;
        let [a, b, c, x, y, z] = *V;
        [
            i[0] * a + i[3] * b + i[4] * c + (h1 * z - h2 * y),
            i[3] * a + i[1] * b + i[5] * c + (h2 * x - h0 * z),
            i[4] * a + i[5] * b + i[2] * c + (h0 * y - h1 * x),
            self.mass * x - (h1 * c - h2 * b),
            self.mass * y - (h2 * a - h0 * c),
            self.mass * z - (h0 * b - h1 * a),
        ]
    }

    /// Adds another body.
    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        for (a, b) in self.moment.iter_mut().zip(&other.moment) {
            *a += b;
        }
        for (a, b) in self.rotational.iter_mut().zip(&other.rotational) {
            *a += b;
        }
    }

    /// The lower triangle of the 6×6 matrix, row by row: 21 numbers.
    #[inline]
    pub fn lower(&self) -> [f64; 21] {
        let [hx, hy, hz] = self.moment;
        let i = &self.rotational;
        let m = self.mass;
        [
            i[0], i[3], i[1], i[4], i[5], i[2], 0.0, hz, -hy, m, -hz, 0.0, hx, 0.0, m, hy, -hx,
            0.0, 0.0, 0.0, m,
        ]
    }
}

/// `A s` of a symmetric 6×6 matrix given by its lower triangle, row by row.
#[inline]
pub fn multiply_lower(A: &[f64; 21], s: &Vec6) -> Vec6 {
    let mut y = [0.0; 6];
    let mut place = 0;
    for i in 0..6 {
        for j in 0..i {
            y[i] += A[place] * s[j];
            y[j] += A[place] * s[i];
            place += 1;
        }
        y[i] += A[place] * s[i];
        place += 1;
    }
    y
}

/// A unit vector across the unit vector `axis`.
pub fn across(axis: &Vec3) -> Vec3 {
    // Of two coordinate directions one that is not along it.
    let other = if axis.x.abs() < 0.6 {
        Vec3::x()
    } else {
        Vec3::y()
    };
    axis.cross(&other).normalize()
}

/// Rotation that takes z to the unit vector `axis`; exact for the coordinate axes.
pub fn rotation_to_axis(axis: &Vec3) -> Mat3 {
    let z = *axis;
    // The coordinate direction least aligned with the axis gives the x axis.
    let seed = if z.x.abs() <= z.y.abs() && z.x.abs() <= z.z.abs() {
        Vec3::new(1.0, 0.0, 0.0)
    } else if z.y.abs() <= z.z.abs() {
        Vec3::new(0.0, 1.0, 0.0)
    } else {
        Vec3::new(0.0, 0.0, 1.0)
    };
    let x = (seed - z * seed.dot(&z)).normalize();
    let y = z.cross(&x);
    Mat3::from_columns(&[x, y, z])
}

/// Hamilton product of quaternions (w, x, y, z).
#[inline]
pub fn quaternion_product(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Quaternion (w, x, y, z) of the rotation vector `r`, rad.
#[inline]
pub fn quaternion_exp(r: &Vec3) -> [f64; 4] {
    let t2 = r.norm_squared();
    let t = t2.sqrt();
    let (c, s) = if t < 1e-4 {
        (1.0 - t2 / 8.0, 0.5 - t2 / 48.0)
    } else {
        let (sin, cos) = libm::sincos(0.5 * t);
        (cos, sin / t)
    };
    [c, s * r.x, s * r.y, s * r.z]
}

/// Rotation vector of a unit quaternion (w, x, y, z), rad; the shorter way round.
#[inline]
pub fn quaternion_log(q: &[f64; 4]) -> Vec3 {
    let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
    let n = (q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    let s = if n < 1e-8 {
        2.0
    } else {
        2.0 * libm::atan2(n, sign * q[0]) / n
    };
    Vec3::new(q[1], q[2], q[3]) * (sign * s)
}

/// Unit length.
#[inline]
pub fn quaternion_normalized(q: &[f64; 4]) -> [f64; 4] {
    let n = 1.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    [q[0] * n, q[1] * n, q[2] * n, q[3] * n]
}

/// Rotation of a unit quaternion (w, x, y, z).
#[inline]
pub fn rotation_from_quaternion(q: &[f64; 4]) -> Mat3 {
    let [a, b, c, d] = *q;
    Mat3::new(
        1.0 - 2.0 * (c * c + d * d),
        2.0 * (b * c - a * d),
        2.0 * (b * d + a * c),
        2.0 * (b * c + a * d),
        1.0 - 2.0 * (b * b + d * d),
        2.0 * (c * d - a * b),
        2.0 * (b * d - a * c),
        2.0 * (c * d + a * b),
        1.0 - 2.0 * (b * b + c * c),
    )
}
