//! Which blocks of a grid are high.

/// The largest value in each block of a grid: of 2 × 2 values, of 4 × 4, and so on.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pyramid {
    levels: Vec<([usize; 2], Vec<f64>)>,
}

impl Pyramid {
    #[cfg_attr(small, optimize(size))]
    pub(super) fn new(counts: [usize; 2], values: Vec<f64>) -> Self {
        let mut levels = vec![(counts, values)];
        while let Some(([nx, ny], below)) = levels.last()
            && nx * ny > 1
        {
            let [mx, my] = [nx.div_ceil(2), ny.div_ceil(2)];
            let mut values = vec![f64::NEG_INFINITY; mx * my];
            for (k, value) in below.iter().enumerate() {
                let at = (k / nx / 2) * mx + (k % nx) / 2;
                values[at] = values[at].max(*value);
            }
            levels.push(([mx, my], values));
        }
        Self { levels }
    }

    /// The largest of all.
    pub(super) fn top(&self) -> f64 {
        self.levels.last().map_or(f64::NEG_INFINITY, |(_, v)| v[0])
    }

    /// The largest value in blocks that are up to twice as wide as the columns and rows, both
    /// included, and cover these.
    pub(super) fn highest(&self, within: [[usize; 2]; 2]) -> f64 {
        let ([columns, rows], level) = (within, self.level(within));
        let ([nx, _], values) = &self.levels[level];
        let mut top = f64::NEG_INFINITY;
        for j in rows[0] >> level..=rows[1] >> level {
            for value in &values[j * nx + (columns[0] >> level)..=j * nx + (columns[1] >> level)] {
                top = top.max(*value);
            }
        }
        top
    }

    /// The level of blocks that are as wide as what is looked at, or up to twice as wide.
    fn level(&self, [columns, rows]: [[usize; 2]; 2]) -> usize {
        let widest = (columns[1] - columns[0]).max(rows[1] - rows[0]) + 1;
        let level = widest.next_power_of_two().ilog2() as usize;
        level.min(self.levels.len() - 1)
    }

    /// Calls `open` with the largest value of each block that has a part in the columns and rows,
    /// both included; opens it where that says so. With a single value comes its place. It begins
    /// with blocks as large as what is looked at, so that the rest of the grid costs nothing.
    pub(super) fn each(
        &self,
        within: [[usize; 2]; 2],
        open: &mut impl FnMut(f64, Option<[usize; 2]>) -> bool,
    ) {
        let ([columns, rows], level) = (within, self.level(within));
        for j in rows[0] >> level..=rows[1] >> level {
            for i in columns[0] >> level..=columns[1] >> level {
                self.visit(level, [i, j], within, open);
            }
        }
    }

    fn visit(
        &self,
        level: usize,
        [bi, bj]: [usize; 2],
        within: [[usize; 2]; 2],
        open: &mut impl FnMut(f64, Option<[usize; 2]>) -> bool,
    ) {
        let ([nx, ny], values) = &self.levels[level];
        let [columns, rows] = within;
        let outside = |b: usize, [first, last]: [usize; 2]| {
            ((b + 1) << level) <= first || (b << level) > last
        };
        if bi >= *nx || bj >= *ny || outside(bi, columns) || outside(bj, rows) {
            return;
        }
        let value = values[bj * nx + bi];
        if level == 0 {
            open(value, Some([bi, bj]));
        } else if open(value, None) {
            for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                self.visit(level - 1, [2 * bi + di, 2 * bj + dj], within, open);
            }
        }
    }
}
