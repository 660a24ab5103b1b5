//! The lowest places of a solid along a direction.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::Core;
use super::placed::Placed;
use crate::spatial::Vec3;

/// The lowest places of a solid: its sharp corners, the ends of what is round, or its centre.
///
/// The rounded edge of what leans is lower than its sharp one, and lower still beyond a wall.
pub(super) fn place(on: &Placed, down: &Vec3, index: usize) -> Option<Vec3> {
    let (half, radius) = match (on.solid.round, on.core) {
        (Some(round), _) => (round.half, if round.flat { round.radius } else { 0.0 }),
        (None, Core::Point) => (0.0, 0.0),
        _ => return on.solid.mesh.corners.get(index).map(|x| on.world(x)),
    };
    let end = on.axis() * if index == 0 { half } else { -half };
    let across = down - on.axis() * on.axis().dot(down);
    let radial = across.try_normalize(f64::MIN_POSITIVE).unwrap_or_default() * radius;
    let count = if half > 0.0 { 2 } else { 1 };
    (index < count).then(|| on.p + end + radial)
}

/// Radius of the ball that sweeps these places, m.
pub(super) fn skin(on: &Placed) -> f64 {
    match on.core {
        Core::Point | Core::Segment { .. } => on.solid.radius,
        _ => 0.0,
    }
}

/// All places of a solid that [`place`] gives.
pub(super) fn places<'a>(on: &'a Placed, up: &Vec3) -> impl Iterator<Item = Vec3> + 'a {
    let down = -up;
    (0..).map_while(move |i| place(on, &down, i))
}

/// How high the lowest of some places is along `up`, m; infinite without any.
pub(super) fn lowest_of(places: impl Iterator<Item = Vec3>, up: &Vec3) -> f64 {
    places.fold(f64::INFINITY, |least, x| least.min(up.dot(&x)))
}
