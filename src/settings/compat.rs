//! Conventions of another simulator: defaults that differ under `[robot] compat`.
//!
//! Values of a settings file take precedence. `docs/pybullet.md` lists how each was measured.

/// Whose conventions hold where neither the robot nor the settings say otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compat {
    /// Ours.
    #[default]
    None,
    /// `PyBullet`'s, as of `loadURDF` without flags.
    PyBullet,
}

/// Keys of [`super::keys::KEYS`] with another default for [`Compat::PyBullet`], in TOML.
const PYBULLET: [(&str, &str); 3] = [
    ("robot.inertia", "\"pybullet\""),
    ("solver.step_size", "\"1/240\""),
    ("world.ground.friction", "1.0"),
];

impl Compat {
    /// From its word in the settings.
    pub fn from_word(word: &str) -> Option<Self> {
        match word {
            "none" => Some(Self::None),
            "pybullet" => Some(Self::PyBullet),
            _ => None,
        }
    }

    /// Its word in the settings.
    pub fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::PyBullet => "pybullet",
        }
    }

    /// What holds where the key at `path` is not given, in TOML, if it is not what the table of
    /// keys says.
    pub fn default_of(self, path: &str) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::PyBullet => PYBULLET
                .iter()
                .find(|(key, _)| *key == path)
                .map(|(_, default)| *default),
        }
    }

    /// Coulomb coefficient of a link where neither the file nor the settings give one.
    pub fn link_friction(self) -> f64 {
        match self {
            Self::None => 0.8,
            Self::PyBullet => 0.5,
        }
    }

    /// Mass of a link without `<inertial>`, kg.
    pub fn missing_mass(self, link: &str) -> Option<f64> {
        (self == Self::PyBullet && link != "world").then_some(1.0)
    }

    /// What every turning or sliding joint's motor can do where the settings do not say, N·m or N.
    pub fn motor_effort(self) -> Option<f64> {
        (self == Self::PyBullet).then_some(240.0)
    }

    /// Speed that no turning or sliding joint exceeds where the settings do not say, rad/s or m/s.
    pub fn largest_speed(self) -> Option<f64> {
        (self == Self::PyBullet).then_some(100.0)
    }

    /// Drag of every body, see [`crate::model::World::drag`], 1/s.
    pub fn drag(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::PyBullet => 0.04,
        }
    }
}
