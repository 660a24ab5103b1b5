//! A fixed base: no coordinate, no motion.

use super::freedom::{Freedom, Mount, Sweep};
use crate::spatial::{Pose, Vec3, Vec6};

pub(super) struct Welded;

impl Freedom for Welded {
    const NQ: usize = 0;
    const NV: usize = 0;
    const BASE: bool = true;

    #[inline]
    fn place(mount: &Mount, _: &[f64], _: &mut [Vec6], origin: &mut Vec3) -> Pose {
        *origin = mount.base.p;
        Pose {
            R: mount.base.R,
            p: Vec3::zeros(),
        }
    }

    #[inline]
    fn velocity(_: &Vec6, _: &[Vec6], _: &[f64]) -> Vec6 {
        [0.0; 6]
    }

    #[inline]
    fn velocity_product(_: &Vec6, _: &[Vec6], _: &[f64]) -> Vec6 {
        [0.0; 6]
    }

    fn advance(_: &[f64], _: &[f64], _: f64, _: &mut [f64]) {}

    fn difference(_: &[f64], _: &[f64], _: &mut [f64]) {}

    fn position_rates(_: &[f64], _: &[f64], _: &mut [f64]) {}

    fn position_error(_: impl Fn(usize) -> f64, _: &mut [f64]) {}

    fn turn_rate(_: f64, _: &[f64]) -> f64 {
        0.0
    }

    fn sweep(_: usize) -> Sweep {
        Sweep::Along
    }
}
