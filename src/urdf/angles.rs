//! Angles that look like degrees where URDF has radians.

use super::scope::Scope;
use super::xml::Node;

/// More than these many radians are no attitude that anybody writes: two turns.
const MOST_TURNED: f64 = 4.0 * std::f64::consts::PI;

/// Limits in degrees are whole and divisible by this; those that stand for "none" are mostly
/// larger than two turns in degrees, and a tenth of a turn in degrees is five turns in radians.
const STEP: f64 = 5.0;
const LIMITS: std::ops::RangeInclusive<f64> = 30.0..=720.0;

/// Numbers that stand for "no limit" as often as for an angle.
const NO_LIMITS: [f64; 3] = [100.0, 500.0, 600.0];

const HELP: &str = "URDF's angles are in radians; 90 degrees are 1.5708";

/// Warns of an attitude in degrees.
pub(super) fn attitude(scope: &mut Scope, origin: Node, rpy: [f64; 3]) {
    let far = |angle: &f64| angle.abs() > MOST_TURNED;
    let (Some(angle), Some(attribute)) = (rpy.into_iter().find(far), origin.attribute("rpy"))
    else {
        return;
    };
    let message = format!(
        "<origin> rpy {angle} rad are {:.1} turns: it looks like degrees",
        angle.abs() / std::f64::consts::TAU
    );
    scope.warning("U035", attribute.at.clone(), &message, HELP);
}

/// Warns of the limits of a joint that turns in degrees.
pub(super) fn limits(scope: &mut Scope, limit: Node, ends: [Option<f64>; 2]) {
    let largest = ends
        .iter()
        .flatten()
        .fold(0.0, |most: f64, end| most.max(end.abs()));
    let whole = ends.iter().flatten().all(|end| end % STEP == 0.0);
    if !whole || !LIMITS.contains(&largest) || NO_LIMITS.contains(&largest) {
        return;
    }
    let named = |name: &&str| {
        let number = limit.attribute(name).map(|a| a.value.trim().parse::<f64>());
        number.is_some_and(|number| number.is_ok_and(|number| number.abs() == largest))
    };
    let name = ["lower", "upper"].into_iter().find(|name| named(&name));
    let at = name
        .and_then(|name| limit.attribute(name))
        .map_or_else(|| limit.tag_at(), |a| a.at.clone());
    let message = format!(
        "a limit of {largest} rad is {:.1} turns: it looks like degrees",
        largest / std::f64::consts::TAU
    );
    scope.warning("U035", at, &message, HELP);
}
