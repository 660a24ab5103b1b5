//! Angles that look like degrees where URDF has radians.

/// More than these many radians are no attitude that anybody writes: two turns.
const MOST_TURNED: f64 = 4.0 * std::f64::consts::PI;

/// Limits in degrees are whole and divisible by this; those that stand for "none" are mostly
/// larger than two turns in degrees, and a tenth of a turn in degrees is five turns in radians.
const STEP: f64 = 5.0;
const LIMITS: std::ops::RangeInclusive<f64> = 30.0..=720.0;

/// Numbers that stand for "no limit" as often as for an angle.
const NO_LIMITS: [f64; 3] = [100.0, 500.0, 600.0];

/// What is advised for both.
pub(super) const HELP: &str = "URDF's angles are in radians; 90 degrees are 1.5708";

/// What is told of roll, pitch and yaw in degrees.
pub(super) fn attitude(rpy: [f64; 3]) -> Option<String> {
    let angle = rpy.into_iter().find(|angle| angle.abs() > MOST_TURNED)?;
    let turns = angle.abs() / std::f64::consts::TAU;
    Some(format!(
        "<origin> rpy {angle} rad are {turns:.1} turns: it looks like degrees"
    ))
}

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
