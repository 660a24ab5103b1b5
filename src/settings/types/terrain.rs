//! What `[[world.terrain]]` says, checked.

use std::path::{Path, PathBuf};

/// A surface with everything below.
#[derive(Clone, Debug, PartialEq)]
pub enum TerrainSettings {
    /// z = 0 of its own axes, without an end.
    Plane,
    /// Heights over a rectangle about its origin.
    Heights {
        /// Where they come from.
        source: HeightSource,
        /// Extent along x and y, m.
        size: [f64; 2],
        /// Height of the brightest value of an image over the darkest, or of what is generated, m;
        /// a factor on the heights of a table. None: 1.
        height: Option<f64>,
    },
    /// The surface of a triangle mesh.
    Mesh {
        /// STL, OBJ, PLY, COLLADA or glTF.
        file: PathBuf,
        /// Factor on all lengths.
        scale: f64,
    },
}

impl TerrainSettings {
    /// The file that it is read from.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Heights {
                source: HeightSource::File(file),
                ..
            }
            | Self::Mesh { file, .. } => Some(file),
            _ => None,
        }
    }
}

/// Where heights come from.
#[derive(Clone, Debug, PartialEq)]
pub enum HeightSource {
    /// An image, or a table of numbers.
    File(PathBuf),
    /// They are computed.
    Generated(GeneratedHeights),
}

/// Heights that are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratedHeights {
    /// What they look like.
    pub form: HeightForm,
    /// Distance between samples, m.
    pub resolution: f64,
    /// Length of a wave, or of the largest bumps of the noise, m.
    pub wavelength: f64,
    /// Of the noise.
    pub seed: u32,
    /// How many steps.
    pub steps: u32,
}

/// What heights that are computed look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightForm {
    /// Even, up along x over the middle third, even.
    Ramp,
    /// Up along x in steps.
    Steps,
    /// Waves along x.
    Waves,
    /// Smooth noise.
    Noise,
}

impl HeightForm {
    /// The one of a word of the settings.
    pub fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "ramp" => Self::Ramp,
            "steps" => Self::Steps,
            "waves" => Self::Waves,
            "noise" => Self::Noise,
            _ => return None,
        })
    }
}
