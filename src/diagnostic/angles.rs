//! Angles that look like degrees where radians are meant.

/// More than these many radians are no attitude that anybody writes: two turns.
const MOST_TURNED: f64 = 4.0 * std::f64::consts::PI;

/// What is advised.
pub const HELP: &str = "angles are in radians; 90 degrees are 1.5708";

/// What is told of roll, pitch and yaw in degrees; none of what may be in radians.
///
/// - `what`: where they stand
/// - `rpy`: rad
pub fn attitude(what: &str, rpy: &[f64]) -> Option<String> {
    let angle = rpy.iter().find(|angle| angle.abs() > MOST_TURNED)?;
    let turns = angle.abs() / std::f64::consts::TAU;
    Some(format!(
        "{what} {angle} rad are {turns:.1} turns: it looks like degrees"
    ))
}

/// Limits in degrees are whole and divisible by this; those that stand for "none" are mostly
/// larger than two turns in degrees, and a tenth of a turn in degrees is five turns in radians.
const LIMIT_STEP: f64 = 5.0;
const LIMITS: std::ops::RangeInclusive<f64> = 30.0..=720.0;

/// Numbers that stand for "no limit" as often as for an angle.
const NO_LIMITS: [f64; 3] = [100.0, 500.0, 600.0];

/// What is told of the lower and the upper limit of a joint that turns in degrees, and of which of
/// them; none of what may be in radians.
///
/// - `ends`: rad
pub fn limits(ends: [Option<f64>; 2]) -> Option<(&'static str, String)> {
    let size = |end: &f64| end.abs();
    let largest = ends.iter().flatten().map(size).fold(0.0, f64::max);
    let whole = ends.iter().flatten().all(|end| end % LIMIT_STEP == 0.0);
    if !whole || !LIMITS.contains(&largest) || NO_LIMITS.contains(&largest) {
        return None;
    }
    let lower = ends[0].is_some_and(|end| end.abs() >= largest);
    let turns = largest / std::f64::consts::TAU;
    let message = format!("a limit of {largest} rad is {turns:.1} turns: it looks like degrees");
    Some((if lower { "lower" } else { "upper" }, message))
}
