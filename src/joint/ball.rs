//! A joint that turns freely: `q = quaternion(w, x, y, z)` of the body after the joint's own pose,
//! `v = ω` in the body's axes.

use super::freedom::{Freedom, Mount, Sweep, wind_turn};
use crate::spatial::{
    Pose, Vec3, Vec6, add_scaled6, cross_motion, quaternion_exp, quaternion_log,
    quaternion_normalized, quaternion_product, rotation_from_quaternion,
};

pub(super) struct Ball;

impl Freedom for Ball {
    const NQ: usize = 4;
    const NV: usize = 3;
    const QUATERNION: Option<usize> = Some(0);

    #[inline]
    fn place(mount: &Mount, q: &[f64], S: &mut [Vec6], _: &mut Vec3) -> Pose {
        let parent = mount.parent;
        let turn = rotation_from_quaternion(&[q[0], q[1], q[2], q[3]]);
        let R = parent.R * mount.X.R * turn;
        let p = parent.R * mount.X.p + parent.p;
        for (i, S) in S.iter_mut().enumerate() {
            let axis: Vec3 = R.column(i).into_owned();
            let moment = p.cross(&axis);
            *S = [axis.x, axis.y, axis.z, moment.x, moment.y, moment.z];
        }
        Pose { R, p }
    }

    #[inline]
    fn velocity_product(V: &Vec6, S: &[Vec6], v: &[f64]) -> Vec6 {
        let mut relative = [0.0; 6];
        for (S, v) in S.iter().zip(v) {
            add_scaled6(&mut relative, S, *v);
        }
        cross_motion(V, &relative)
    }

    #[inline]
    fn advance(from: &[f64], v: &[f64], h: f64, to: &mut [f64]) {
        let turn = quaternion_exp(&(Vec3::new(v[0], v[1], v[2]) * h));
        let q = [from[0], from[1], from[2], from[3]];
        let q = quaternion_normalized(&quaternion_product(&q, &turn));
        to.copy_from_slice(&q);
    }

    #[inline]
    fn wind(change: &[f64], h: f64, mean: &mut [f64]) {
        wind_turn(change, -h, mean);
    }

    #[inline]
    fn difference(b: &[f64], a: &[f64], out: &mut [f64]) {
        let qb = [b[0], b[1], b[2], b[3]];
        let qa = [a[0], -a[1], -a[2], -a[3]];
        let r = quaternion_log(&quaternion_product(&qa, &qb));
        out.copy_from_slice(r.as_slice());
    }

    #[inline]
    fn position_rates(q: &[f64], v: &[f64], rate: &mut [f64]) {
        let turn = [0.0, 0.5 * v[0], 0.5 * v[1], 0.5 * v[2]];
        let q = [q[0], q[1], q[2], q[3]];
        rate.copy_from_slice(&quaternion_product(&q, &turn));
    }

    #[inline]
    fn position_error(change: impl Fn(usize) -> f64, out: &mut [f64]) {
        // A small change of a unit quaternion is half the angle.
        for (i, out) in out.iter_mut().enumerate() {
            *out = 2.0 * change(1 + i);
        }
    }

    #[inline]
    fn turn_rate(_: f64, v: &[f64]) -> f64 {
        (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
    }

    fn sweep(_: usize) -> Sweep {
        Sweep::AboutPoint
    }
}
