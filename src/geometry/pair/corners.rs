//! The corners of a hull, laid out for the search of the one that is farthest along a direction.

use crate::spatial::Vec3;

/// How many corners are looked at together. Processors compute two or four numbers with one
/// instruction where these lie side by side and no branch depends on them.
const LANES: usize = 4;

/// Corners of a hull.
#[derive(Clone, Debug)]
pub(super) struct Corners {
    list: Vec<Vec3>,
    /// Coordinates x, y and z of every four of them; the last four are filled with the first one.
    blocks: Vec<[[f64; LANES]; 3]>,
}

impl Corners {
    #[cfg_attr(small, optimize(size))]
    pub(super) fn new(list: Vec<Vec3>) -> Self {
        let block = |four: &[Vec3]| {
            let corner = |lane: usize| four.get(lane).unwrap_or(&list[0]);
            [0, 1, 2].map(|axis| std::array::from_fn(|lane| corner(lane)[axis]))
        };
        let blocks = list.chunks(LANES).map(block).collect();
        Self { list, blocks }
    }

    pub(super) fn list(&self) -> &[Vec3] {
        &self.list
    }

    /// The one that is farthest along `d`, the first of those that are equally far.
    pub(super) fn farthest(&self, d: &Vec3) -> Vec3 {
        let mut best = [f64::NEG_INFINITY; LANES];
        let mut at = [0; LANES];
        for (block, [x, y, z]) in self.blocks.iter().enumerate() {
            for lane in 0..LANES {
                let height = d.x * x[lane] + d.y * y[lane] + d.z * z[lane];
                let higher = height > best[lane];
                best[lane] = if higher { height } else { best[lane] };
                at[lane] = if higher { block } else { at[lane] };
            }
        }
        let mut first = (f64::NEG_INFINITY, usize::MAX);
        for lane in 0..LANES {
            let index = LANES * at[lane] + lane;
            if best[lane] > first.0 || (best[lane] >= first.0 && index < first.1) {
                first = (best[lane], index);
            }
        }
        self.list.get(first.1).copied().unwrap_or_else(Vec3::zeros)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn the_farthest_corner_is_the_first_of_the_farthest() {
        let mut random = Random(0x1B87_3593_CC9E_2D51);
        for count in 1..40 {
            // Of few different places, so that some are equally far.
            let place = |random: &mut Random| random.vector(2.0).map(f64::round);
            let list: Vec<Vec3> = (0..count).map(|_| place(&mut random)).collect();
            let corners = Corners::new(list.clone());
            for _ in 0..50 {
                let d = place(&mut random);
                let mut best = (f64::NEG_INFINITY, Vec3::zeros());
                for corner in &list {
                    let height = d.dot(corner);
                    if height > best.0 {
                        best = (height, *corner);
                    }
                }
                assert_eq!(corners.farthest(&d), best.1, "{list:?} along {d}");
            }
        }
    }
}
