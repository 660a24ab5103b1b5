//! Gravity that is nearly always meant otherwise: its sign, its axis or its unit.

use std::fmt;

/// What is unusual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unusual {
    /// It points up, along z, rather than down or sideways: its sign is forgotten.
    Upwards,
    /// It points straight along -y over a ground, as in programs where y is up.
    AlongY,
    /// It is the earth's in this unit of length over s², in place of m/s².
    Unit(&'static str),
}

impl fmt::Display for Unusual {
    /// As the predicate of a sentence.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Upwards => write!(f, "points upwards"),
            Self::AlongY => write!(f, "points along -y"),
            Self::Unit(unit) => write!(f, "is the earth's in {unit}/s²"),
        }
    }
}

/// The earth's gravity, m/s², and by how much that of other places and of other digits differs, as
/// a share.
const EARTH: (f64, f64) = (9.81, 0.01);

/// What is unusual about gravity, m/s²; none of what may be meant.
///
/// - `ground`: whether the world has a ground, with z up
pub fn unusual([x, y, z]: [f64; 3], ground: bool) -> Option<Unusual> {
    let level = libm::hypot(x, y);
    let size = libm::hypot(level, z);
    let mut units = [("mm", 1000.0), ("cm", 100.0)].into_iter();
    if z > level {
        Some(Unusual::Upwards)
    } else if ground && x == 0.0 && y < 0.0 && z == 0.0 {
        Some(Unusual::AlongY)
    } else {
        let near = |factor: f64| (size / (factor * EARTH.0) - 1.0).abs() < EARTH.1;
        let unit = units.find(|(_, factor)| near(*factor));
        unit.map(|(unit, _)| Unusual::Unit(unit))
    }
}
