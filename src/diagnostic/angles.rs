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
