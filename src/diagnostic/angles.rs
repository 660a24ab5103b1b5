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

/// Limits of so many radians are told, from two turns on; those that stand for "none" are mostly
/// larger than two turns in degrees.
const LIMITS: std::ops::RangeInclusive<f64> = MOST_TURNED..=720.0;

/// Limits from here on are nearly always degrees, rad: five turns, or a twelfth of a turn in
/// degrees.
const DEGREES: f64 = 30.0;

/// Numbers that stand for "no limit" as often as for an angle.
const NO_LIMITS: [f64; 3] = [100.0, 500.0, 600.0];

/// What is told of the limits of a joint that turns.
pub struct Told {
    /// Which of them: `lower` or `upper`.
    pub name: &'static str,
    /// The message.
    pub message: String,
    /// Whether it is nearly always right; else it may be a joint of many turns.
    pub certain: bool,
}

/// What is told of the lower and the upper limit of a joint that turns in degrees; none of what is
/// a number of quarter turns, or within two turns.
///
/// - `ends`: rad
pub fn limits(ends: [Option<f64>; 2]) -> Option<Told> {
    let size = |end: &f64| end.abs();
    let largest = ends.iter().flatten().map(size).fold(0.0, f64::max);
    let quarters = largest / std::f64::consts::FRAC_PI_2;
    // As numbers with four digits are rounded; whole ones, such as 355, are not.
    let even = largest.fract() > 0.0 && (quarters - quarters.round()).abs() < 1e-4 * quarters;
    if even || !LIMITS.contains(&largest) {
        return None;
    }
    let lower = ends[0].is_some_and(|end| end.abs() >= largest);
    let turns = largest / std::f64::consts::TAU;
    Some(Told {
        name: if lower { "lower" } else { "upper" },
        message: format!("a limit of {largest} rad is {turns:.1} turns: it looks like degrees"),
        certain: largest >= DEGREES && !NO_LIMITS.contains(&largest),
    })
}

#[cfg(test)]
mod tests {
    use super::limits;

    /// Of public robots in degrees: so101, Panda. Quarter turns are meant as such, also where they
    /// are rounded, and large numbers as no limit.
    #[test]
    fn limits_in_degrees_are_told_and_turns_are_not() {
        let certain = |lower: f64, upper: f64| {
            let told = limits([Some(lower), Some(upper)]);
            told.map(|told| (told.name, told.certain))
        };
        for (ends, told) in [
            ([-90.0, 90.0], Some(("lower", true))),
            ([-2.0, 166.0], Some(("upper", true))),
            ([-118.0, 120.0], Some(("upper", true))),
            ([-355.0, 355.0], Some(("lower", true))),
            ([-57.0, 1.0], Some(("lower", true))),
            ([-100.0, 100.0], Some(("lower", false))),
            ([-20.5, 0.0], Some(("lower", false))),
            ([-12.56, 12.56], None),
            ([-31.4159, 31.4159], None),
            ([-62.83, 62.83], None),
            ([-1000.0, 1000.0], None),
            ([-1e16, 1e16], None),
            ([-1.5, f64::INFINITY], None),
        ] {
            assert_eq!(certain(ends[0], ends[1]), told, "{ends:?}");
        }
    }
}
