//! Places of a circle that are deeper in the ground than those beside them, in their order around
//! it: what there is between them, and what each has of the share of the circle.

use crate::tuning::{MOST_NEAREST, NEAREST_IN_HOLLOW, ROUND_OFF};

/// Where a circle is deeper in the ground than on either side.
#[derive(Clone, Copy, Default)]
pub(super) struct Turn {
    pub(super) angle: f64,
    /// Between looks at it that are so far from each other, rad.
    pub(super) between: f64,
    /// How far the ground is above it there, m.
    pub(super) over: f64,
    /// The least that the ground is above the circle from here to the next one, m.
    pub(super) least_after: f64,
}

/// Turns in their order around a circle.
pub(super) struct Turns {
    list: [Turn; MOST_NEAREST],
    number: usize,
    /// What is lowest before the first one: it belongs behind the last.
    before: f64,
}

impl Turns {
    pub(super) fn new() -> Self {
        Self {
            list: Default::default(),
            number: 0,
            before: f64::INFINITY,
        }
    }

    /// Adds the next one; those beyond the room are left out.
    pub(super) fn add(&mut self, turn: Turn) {
        if self.number < MOST_NEAREST {
            self.list[self.number] = turn;
            self.number += 1;
        }
    }

    /// Passes a place over which the ground is so high, m.
    pub(super) fn pass(&mut self, over: f64) {
        let least = match self.number {
            0 => &mut self.before,
            n => &mut self.list[n - 1].least_after,
        };
        *least = least.min(over);
    }

    /// All of them, once the circle has been gone around.
    pub(super) fn close(&mut self) -> &[Turn] {
        self.pass(self.before);
        &self.list[..self.number]
    }
}

/// What each of the highest turns, in their order around the circle, has of the share of a circle.
///
/// The highest has all of it, another one as much of it as it is above what is between it and a
/// higher one, in blends. Where two are as high as each other, they have the same: what both have
/// is divided evenly as far as they are nearer to each other than to what is between them.
pub(super) fn shares(turns: &[Turn], blend: f64) -> [f64; MOST_NEAREST] {
    let mut shares = [0.0; MOST_NEAREST];
    let by_height = |a: &usize, b: &usize| turns[*a].over.total_cmp(&turns[*b].over);
    let Some(top) = (0..turns.len()).max_by(by_height) else {
        return shares;
    };
    shares[top] = 1.0;
    let number = turns.len();
    for i in (0..number).filter(|i| *i != top) {
        let is_higher = |k: usize| k == top || turns[k].over > turns[i].over;
        // What is lowest on the way to a higher one, forwards and backwards.
        let mut ways = [f64::INFINITY; 2];
        let mut k = i;
        while k == i || !is_higher(k) {
            ways[0] = ways[0].min(turns[k].least_after);
            k = (k + 1) % number;
        }
        k = i;
        while k == i || !is_higher(k) {
            k = (k + number - 1) % number;
            ways[1] = ways[1].min(turns[k].least_after);
        }
        let stands_out = turns[i].over - ways[0].max(ways[1]);
        if stands_out <= 0.0 {
            continue;
        }
        let own = (stands_out / blend).min(1.0);
        let alike = (1.0 - (turns[top].over - turns[i].over) / stands_out).max(0.0);
        let moved = 0.5 * (1.0 - own) * alike;
        shares[i] = own + moved;
        shares[top] = (shares[top] - moved).max(0.0);
    }
    shares
}

/// Where the rise changes its sign between two angles, by the Illinois method.
///
/// - `ends`: angles and rises
/// - `least`: a rise that is as good as none
/// - `at`: the rise at an angle, and what is to be found
pub(super) fn between<T>(
    ends: [(f64, f64); 2],
    least: f64,
    at: impl Fn(f64) -> Option<(f64, T)>,
) -> Option<T> {
    let [mut low, mut high] = ends;
    let mut kept = 0.0;
    let mut found = None;
    for _ in 0..NEAREST_IN_HOLLOW {
        let angle = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
        let (rise, here) = at(angle)?;
        found = Some(here);
        if rise.abs() <= least || (high.0 - low.0).abs() <= ROUND_OFF {
            break;
        }
        if (rise > 0.0) == (low.1 > 0.0) {
            low = (angle, rise);
            high.1 *= if kept < 0.0 { 0.5 } else { 1.0 };
            kept = -1.0;
        } else {
            high = (angle, rise);
            low.1 *= if kept > 0.0 { 0.5 } else { 1.0 };
            kept = 1.0;
        }
    }
    found
}
