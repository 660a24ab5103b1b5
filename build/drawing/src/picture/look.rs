//! What a picture shows, how it is taken, and what it is.

/// Samples of a pixel along each side.
pub(super) const SAMPLES: usize = 4;

/// A picture, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue (sRGB) and alpha of each pixel.
    pub pixels: Vec<[u8; 4]>,
}

/// How a picture is taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Where the camera stands.
    pub from: Toward,
    /// What is behind the robot.
    pub theme: Theme,
    /// Directions of the sky that are looked at for each place.
    pub sky: u16,
    /// Whether the frames of the links are drawn over it.
    pub frames: bool,
}

/// Where the camera stands, seen from the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toward {
    /// About z, from x towards y, degrees.
    pub azimuth: f64,
    /// Above the horizon, degrees.
    pub elevation: f64,
}

/// What is behind the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// Nothing but its shadow: for pages of any colour.
    Clear,
    /// Nothing at all.
    Cutout,
    /// A light floor with a grid.
    Light,
    /// A dark floor with a grid.
    Dark,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            from: Toward {
                azimuth: -53.0,
                elevation: 20.0,
            },
            theme: Theme::Clear,
            sky: 48,
            frames: false,
        }
    }
}
