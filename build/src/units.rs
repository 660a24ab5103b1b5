//! Names of units in FMI, and their base units.

use urdf2fmu_core::variables::{Display, Unit};

/// A unit in FMI's terms.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Unit name, as Modelica tools write it: `N.m`, `m/s2`.
    pub name: &'static str,
    /// Name of the physical quantity; also the name of the FMI type.
    pub quantity: &'static str,
    /// Exponents of FMI's base units; absent ones are 0.
    pub exponents: [(&'static str, i8); 4],
    /// Display units and their factors: value in it = factor × value in the unit. The first is that
    /// of the type.
    pub display: &'static [(&'static str, f64)],
}

/// The name of a unit that people read; [`facts`] has its factor.
pub fn display(display: Display) -> &'static str {
    match display {
        Display::Degree => "deg",
        Display::DegreePerSecond => "deg/s",
        Display::TurnPerMinute => "rpm",
    }
}

/// The FMI facts of a unit.
///
/// A torque is `kg.m2/s2` without radians, as in the SI; what is *per angle* carries rad⁻¹.
pub fn facts(unit: Unit) -> Facts {
    let make = |name, quantity, kg, m, s, rad| Facts {
        name,
        quantity,
        exponents: [("kg", kg), ("m", m), ("s", s), ("rad", rad)],
        display: &[],
    };
    match unit {
        Unit::One => make("1", "Ratio", 0, 0, 0, 0),
        Unit::Meter => make("m", "Length", 0, 1, 0, 0),
        Unit::Radian => Facts {
            display: &[("deg", 180.0 / std::f64::consts::PI)],
            ..make("rad", "Angle", 0, 0, 0, 1)
        },
        Unit::Second => make("s", "Time", 0, 0, 1, 0),
        Unit::Kilogram => make("kg", "Mass", 1, 0, 0, 0),
        Unit::MeterPerSecond => make("m/s", "Velocity", 0, 1, -1, 0),
        Unit::RadianPerSecond => Facts {
            display: &[
                ("deg/s", 180.0 / std::f64::consts::PI),
                ("rpm", 30.0 / std::f64::consts::PI),
            ],
            ..make("rad/s", "AngularVelocity", 0, 0, -1, 1)
        },
        Unit::MeterPerSecondSquared => make("m/s2", "Acceleration", 0, 1, -2, 0),
        Unit::RadianPerSecondSquared => make("rad/s2", "AngularAcceleration", 0, 0, -2, 1),
        Unit::Newton => make("N", "Force", 1, 1, -2, 0),
        Unit::NewtonMeter => make("N.m", "Torque", 1, 2, -2, 0),
        Unit::NewtonPerMeter => make("N/m", "TranslationalStiffness", 1, 0, -2, 0),
        Unit::NewtonMeterPerRadian => make("N.m/rad", "RotationalStiffness", 1, 2, -2, -1),
        Unit::NewtonSecondPerMeter => make("N.s/m", "TranslationalDamping", 1, 0, -1, 0),
        Unit::NewtonMeterSecondPerRadian => make("N.m.s/rad", "RotationalDamping", 1, 2, -1, -1),
        Unit::Joule => make("J", "Energy", 1, 2, -2, 0),
        Unit::PerSecond => make("1/s", "Rate", 0, 0, -1, 0),
    }
}
