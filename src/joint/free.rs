//! A floating base: `q = [p_WB(3), quaternion(w, x, y, z)]`, `v = [ω_WB_W(3), ṗ_WB(3)]`.

use super::freedom::{Freedom, Mount, Sweep, wind_turn};
use crate::spatial::{
    Pose, Vec3, Vec6, angular, linear, quaternion_exp, quaternion_log, quaternion_normalized,
    quaternion_product, rotation_from_quaternion,
};

pub(super) struct Free;

impl Freedom for Free {
    const NQ: usize = 7;
    const NV: usize = 6;
    const BASE: bool = true;
    const QUATERNION: Option<usize> = Some(3);

    /// The columns of `S` are the unit vectors: angular, then linear velocity of the origin O.
    #[inline]
    fn place(_: &Mount, q: &[f64], S: &mut [Vec6], origin: &mut Vec3) -> Pose {
        *origin = Vec3::new(q[0], q[1], q[2]);
        for (i, S) in S.iter_mut().enumerate() {
            *S = std::array::from_fn(|k| f64::from(u8::from(k == i)));
        }
        Pose {
            R: rotation_from_quaternion(&[q[3], q[4], q[5], q[6]]),
            p: Vec3::zeros(),
        }
    }

    #[inline]
    fn velocity(_: &Vec6, _: &[Vec6], v: &[f64]) -> Vec6 {
        std::array::from_fn(|k| v[k])
    }

    /// Spatial acceleration is the rate of `V` at a fixed point: `−ω × ṗ` appears because O moves
    /// with the base.
    #[inline]
    fn velocity_product(V: &Vec6, _: &[Vec6], _: &[f64]) -> Vec6 {
        let a = -angular(V).cross(&linear(V));
        [0.0, 0.0, 0.0, a.x, a.y, a.z]
    }

    #[inline]
    fn advance(from: &[f64], v: &[f64], h: f64, to: &mut [f64]) {
        for i in 0..3 {
            to[i] = from[i] + h * v[3 + i];
        }
        let turn = quaternion_exp(&(Vec3::new(v[0], v[1], v[2]) * h));
        let q = [from[3], from[4], from[5], from[6]];
        let q = quaternion_normalized(&quaternion_product(&turn, &q));
        to[3..].copy_from_slice(&q);
    }

    #[inline]
    fn wind(change: &[f64], h: f64, mean: &mut [f64]) {
        wind_turn(change, h, mean);
    }

    #[inline]
    fn difference(b: &[f64], a: &[f64], out: &mut [f64]) {
        for i in 0..3 {
            out[3 + i] = b[i] - a[i];
        }
        let qb = [b[3], b[4], b[5], b[6]];
        let qa = [a[3], -a[4], -a[5], -a[6]];
        let r = quaternion_log(&quaternion_product(&qb, &qa));
        out[..3].copy_from_slice(r.as_slice());
    }

    #[inline]
    fn position_rates(q: &[f64], v: &[f64], rate: &mut [f64]) {
        rate[..3].copy_from_slice(&v[3..]);
        let turn = [0.0, 0.5 * v[0], 0.5 * v[1], 0.5 * v[2]];
        let q = [q[3], q[4], q[5], q[6]];
        rate[3..].copy_from_slice(&quaternion_product(&turn, &q));
    }

    #[inline]
    fn position_error(change: impl Fn(usize) -> f64, out: &mut [f64]) {
        for i in 0..3 {
            out[3 + i] = change(i);
            // A small change of a unit quaternion is half the angle.
            out[i] = 2.0 * change(4 + i);
        }
        out[0] += 2.0 * change(3);
    }

    #[inline]
    fn turn_rate(_: f64, v: &[f64]) -> f64 {
        (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
    }

    fn sweep(axis: usize) -> Sweep {
        if axis < 3 {
            Sweep::AboutPoint
        } else {
            Sweep::Along
        }
    }
}
