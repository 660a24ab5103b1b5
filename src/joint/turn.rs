//! A joint that turns about the z axis of the solver's frame: `q` in rad.

use super::freedom::{Freedom, Mount, Sweep, one_column_product};
use crate::spatial::{Mat3, Pose, Vec3, Vec6};

pub(super) struct Turn;

impl Freedom for Turn {
    const NQ: usize = 1;
    const NV: usize = 1;

    #[inline]
    fn place(mount: &Mount, q: &[f64], S: &mut [Vec6], _: &mut Vec3) -> Pose {
        let parent = mount.parent;
        let R = parent.R * mount.X.R;
        let p = parent.R * mount.X.p + parent.p;
        let angle = mount.ratio * q[0] + mount.offset;
        let (s, c) = libm::sincos(angle);
        let (x, y, z) = (R.column(0), R.column(1), R.column(2));
        let axis: Vec3 = z.into_owned();
        let R = Mat3::from_columns(&[x * c + y * s, y * c - x * s, axis]);
        let moment = p.cross(&axis);
        let k = mount.ratio;
        S[0] = [
            axis.x * k,
            axis.y * k,
            axis.z * k,
            moment.x * k,
            moment.y * k,
            moment.z * k,
        ];
        Pose { R, p }
    }

    #[inline]
    fn velocity_product(V: &Vec6, S: &[Vec6], v: &[f64]) -> Vec6 {
        one_column_product(V, S, v)
    }

    /// A mimic body shares its coordinate: writing it twice gives the same value.
    #[inline]
    fn advance(from: &[f64], v: &[f64], h: f64, to: &mut [f64]) {
        to[0] = from[0] + h * v[0];
    }

    #[inline]
    fn difference(b: &[f64], a: &[f64], out: &mut [f64]) {
        out[0] = b[0] - a[0];
    }

    #[inline]
    fn position_rates(_: &[f64], v: &[f64], rate: &mut [f64]) {
        rate[0] = v[0];
    }

    #[inline]
    fn position_error(change: impl Fn(usize) -> f64, out: &mut [f64]) {
        out[0] = change(0);
    }

    #[inline]
    fn turn_rate(ratio: f64, v: &[f64]) -> f64 {
        (ratio * v[0]).abs()
    }

    fn sweep(_: usize) -> Sweep {
        Sweep::AboutAxis
    }
}
