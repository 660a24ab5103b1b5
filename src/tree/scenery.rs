//! Shapes that never move, in an order in which a search finds those at some place.

use crate::spatial::Vec3;

/// Balls about all shapes that never move but terrain, which has no end, by ascending least x. A
/// world of a thousand of them costs a search no more than those that it comes near.
#[derive(Clone, Debug, Default)]
pub struct Scenery {
    balls: Vec<Still>,
    /// Places of all other shapes, ascending.
    pub(super) movers: Vec<usize>,
}

/// A ball about a shape that never moves.
#[derive(Clone, Debug)]
pub struct Still {
    /// Place of the shape among all.
    pub place: usize,
    /// Its tree.
    pub tree: usize,
    /// Centre in the world, m.
    pub center: Vec3,
    /// m
    pub radius: f64,
    /// Greatest x of this ball and all before it, m.
    high: f64,
}

impl Still {
    /// Whether it may have a point in another ball in the world, m.
    pub fn is_near(&self, center: &Vec3, radius: f64) -> bool {
        let reach = radius + self.radius;
        (self.center - center).norm_squared() <= reach * reach
    }

    /// m
    fn low(&self) -> f64 {
        self.center.x - self.radius
    }
}

impl Scenery {
    /// - `movers`: places of what moves, ascending
    /// - `still`: the rest: place, tree, and a ball about the shape, m
    pub(super) fn new(movers: Vec<usize>, still: Vec<(usize, usize, Vec3, f64)>) -> Self {
        let ball = |(place, tree, center, radius)| Still {
            place,
            tree,
            center,
            radius,
            high: f64::NEG_INFINITY,
        };
        let mut balls: Vec<Still> = still.into_iter().map(ball).collect();
        balls.sort_by(|a, b| a.low().total_cmp(&b.low()));
        let mut high = f64::NEG_INFINITY;
        for ball in &mut balls {
            high = high.max(ball.center.x + ball.radius);
            ball.high = high;
        }
        Self { balls, movers }
    }

    /// Those that may have points within a range of x, m, in no order that means anything.
    pub fn within(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = &Still> {
        let end = self.balls.partition_point(|ball| ball.low() < high);
        let before = self.balls[..end].iter().rev();
        before.take_while(move |ball| ball.high > low)
    }
}
