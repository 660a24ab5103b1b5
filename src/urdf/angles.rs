//! Angles that look like degrees where URDF has radians.

/// Limits in degrees are whole and divisible by this; those that stand for "none" are mostly
/// larger than two turns in degrees, and a tenth of a turn in degrees is five turns in radians.
const STEP: f64 = 5.0;
const LIMITS: std::ops::RangeInclusive<f64> = 30.0..=720.0;

/// Numbers that stand for "no limit" as often as for an angle.
const NO_LIMITS: [f64; 3] = [100.0, 500.0, 600.0];

/// What is told of the lower and the upper limit of a joint that turns in degrees, and of which of
/// them.
pub(super) fn limits(ends: [Option<f64>; 2]) -> Option<(&'static str, String)> {
    let size = |end: &f64| end.abs();
    let largest = ends.iter().flatten().map(size).fold(0.0, f64::max);
    let whole = ends.iter().flatten().all(|end| end % STEP == 0.0);
    if !whole || !LIMITS.contains(&largest) || NO_LIMITS.contains(&largest) {
        return None;
    }
    let lower = ends[0].is_some_and(|end| end.abs() >= largest);
    let turns = largest / std::f64::consts::TAU;
    let message = format!("a limit of {largest} rad is {turns:.1} turns: it looks like degrees");
    Some((if lower { "lower" } else { "upper" }, message))
}
