//! Which numbers a user may give: one range for each physical quantity.
//!
//! The ranges hold every robot from a millimetre to a hundred metres, and from milligrams to
//! thousands of tonnes, with wide margins. A number outside is a mistake in a unit or a sign. It
//! would be noticed late, as a step that fails or never ends; here it is reported where it is
//! given. Within the ranges products of a few numbers stay finite.

/// Which numbers are legal; finite in any case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// A limit of a joint: "no limit" is often written as 1e16 or more.
    Limit,
    /// The same for a limit on a size: effort, speed.
    LimitSize,
    /// Factor on every length; 0.001 and 1000 go between mm and m.
    Scale,
    /// Factor on the axes of a mesh; mirrored where it is negative.
    MeshScale,
    /// Size of a shape, m.
    Length,
    /// Position, m or rad: in 1000 km round-off is still a tenth of a nanometre.
    Position,
    /// Velocity of a joint, m/s or rad/s: spindles turn with up to 1e5 rad/s.
    Velocity,
    /// Velocity of the base, m/s: satellites fly with 8e3 m/s.
    Flight,
    /// Angular velocity of the base, rad/s: 1e4 turns a minute.
    Spin,
    /// Component of gravity, m/s²: 36 times that of the sun's surface, as in a fast centrifuge.
    Gravity,
    /// Effort or force that acts, N·m or N: a big rocket has 1e8 N.
    Load,
    /// Time derivative of an input. A table whose rows are a nanosecond apart has steep ones.
    Slope,
    /// Mass, kg, of a link that has one.
    Mass,
    /// Density of links that the file gives no mass, kg/m³: from aerogel to far above every metal.
    Density,
    /// Coulomb coefficient; a lever of rolling or torsional friction, m. 1e5 stands for "does not
    /// slip" in many robots.
    Friction,
    /// Ratio of a mimicking joint.
    Ratio,
    /// Moment or product of inertia, kg·m²: of the greatest mass at 1 km.
    Inertia,
    /// Coefficient of a joint, a servo or a rotor: damping, dry friction, gains, armature.
    Coefficient,
    /// Newton's coefficient of restitution. One below 1e-6 would need a dissipation that is greater
    /// than every number of the solve.
    Restitution,
    /// Depth of a contact under the robot's weight, m.
    Penetration,
    /// Stiffness of a contact, N/m.
    Stiffness,
    /// Hunt–Crossley dissipation of a contact, s/m.
    Dissipation,
    /// A speed that others are measured by, m/s or rad/s.
    ReferenceSpeed,
    /// Angle between the first and the last ray of a sensor, rad: up to a full turn.
    View,
    /// Samples a second: from one in a quarter of an hour to those of a fast converter.
    Rate,
    /// Steps of an encoder in a turn or in a metre.
    Steps,
    /// Bias of a sensor, in its own unit.
    Bias,
    /// Standard deviation of a sensor, likewise.
    Noise,
    /// A distance that may be nothing, m.
    Near,
    /// A fixed step, s, or 0 for error control. A shorter one would keep the host waiting for ever.
    Step,
    /// Error allowed per step.
    Tolerance,
    /// The same, or 0 for the importer's.
    ToleranceOrNone,
    /// Tries of a solver step.
    Work,
    /// Length of an experiment, s.
    Duration,
    /// Time, s: beyond it steps of a microsecond are lost in round-off.
    Time,
    /// A number of parts.
    Count,
}

/// Tries of a solver step in a communication step of up to a second, and in each second of a longer
/// one, beyond which it is given up.
///
/// Robots of the collections, dropped and driven about, take up to 150 tries in a communication
/// step of 1/240 s and 1,900 in one of 1 s at a tolerance of 1e-3, 11,000 in one of 1 s at 1e-5. At
/// 30 µs a try this many take some seconds.
pub const MOST_STEPS: f64 = 100_000.0;

/// Shortest fixed step, s; what a model asks for is raised to it.
pub(crate) const SHORTEST_FIXED_STEP: f64 = 1e-7;

macro_rules! ranges {
    ($($name:ident $(($zero:literal) or)? $least:literal to $greatest:literal;)*) => {
        impl Range {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Least and greatest legal number. 0 may be legal besides, see [`Self::contains`].
            pub fn bounds(self) -> (f64, f64) {
                match self { $(Self::$name => ($least, $greatest)),* }
            }

            /// Whether `value` is legal. Not inlined, so that a library has it once.
            #[inline(never)]
            pub fn contains(self, value: f64) -> bool {
                match self {
                    $(Self::$name => $((value == 0.0 && matches!($zero, 0)) ||)?
                        ($least..=$greatest).contains(&value)),*
                }
            }

            /// What a legal number is, for messages.
            pub fn expected(self) -> &'static str {
                match self {
                    $(Self::$name => concat!(
                        $($zero, " or ",)? "a number from ", $least, " to ", $greatest
                    )),*
                }
            }

            /// The same for tables.
            pub fn label(self) -> &'static str {
                match self {
                    $(Self::$name => concat!($($zero, " or ",)? $least, " … ", $greatest)),*
                }
            }
        }
    };
}

ranges! {
    Limit -1e30 to 1e30;
    LimitSize 0.0 to 1e30;
    Scale 1e-6 to 1e6;
    MeshScale -1e9 to 1e9;
    Length 1e-9 to 1e6;
    Density 1.0 to 1e5;
    Duration 1e-6 to 1e9;
    Position -1e6 to 1e6;
    Velocity -1e5 to 1e5;
    Flight -1e4 to 1e4;
    Spin -1e3 to 1e3;
    Gravity -1e4 to 1e4;
    Load -1e12 to 1e12;
    Slope -1e18 to 1e18;
    Mass 1e-12 to 1e12;
    Friction 0.0 to 1e6;
    Ratio -1e6 to 1e6;
    Inertia -1e18 to 1e18;
    Coefficient 0.0 to 1e12;
    Restitution (0) or 1e-6 to 1.0;
    Penetration 1e-9 to 1.0;
    Stiffness 1e-3 to 1e15;
    Dissipation 0.0 to 1e6;
    ReferenceSpeed 1e-9 to 1e9;
    View 0.0 to 6.3;
    Rate 1e-3 to 1e6;
    Steps 1e-3 to 1e12;
    Bias -1e12 to 1e12;
    Noise 0.0 to 1e12;
    Near 0.0 to 1e6;
    Step (0) or 1e-7 to 1.0;
    Tolerance 1e-12 to 1.0;
    ToleranceOrNone (0) or 1e-12 to 1.0;
    Work 1.0 to 1e15;
    Time -1e10 to 1e10;
    Count 1.0 to 1e9;
}

/// The number that a text like `1/240` or `0.01` means.
pub fn number_or_ratio(text: &str) -> Option<f64> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    match text.split_once('/') {
        Some((above, below)) => Some(number(above)? / number(below)?),
        None => number(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_ends_at_its_bounds() {
        for &range in Range::ALL {
            let (least, greatest) = range.bounds();
            assert!(
                range.contains(least) && range.contains(greatest),
                "{range:?}"
            );
            assert!(!range.contains(greatest * 1.001), "{range:?}");
            assert!(!range.contains(least - 0.001 * greatest), "{range:?}");
            for value in [
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::MAX,
                f64::MIN,
            ] {
                assert!(!range.contains(value), "{range:?} {value}");
            }
        }
    }

    #[test]
    fn a_range_says_where_it_ends() {
        assert_eq!(Range::Mass.expected(), "a number from 1e-12 to 1e12");
        assert_eq!(Range::Step.expected(), "0 or a number from 1e-7 to 1.0");
        assert_eq!(Range::Gravity.label(), "-1e4 … 1e4");
    }
}
