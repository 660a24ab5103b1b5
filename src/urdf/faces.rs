//! What the readers of mesh files share: their errors, and polygons cut into triangles.

use crate::spatial::Vec3;

/// Mesh files larger than this, in bytes, are refused. Five million triangles.
pub(super) const LARGEST_FILE: u64 = 256 << 20;

/// Why a mesh cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum MeshError {
    #[error("the file cannot be read: {0}")]
    Io(String),
    #[error("the file has {0} bytes, more than the {LARGEST_FILE} that are read")]
    TooLarge(u64),
    #[error("the file is empty")]
    Empty,
    #[error("'{0}' files are not read; STL, OBJ and COLLADA are")]
    Format(String),
    #[error(
        "the file is cut short: {expected} bytes for {triangles} triangles, but it has {found}"
    )]
    Truncated {
        triangles: u32,
        expected: u64,
        found: u64,
    },
    #[error("the file is cut short: it ends within a facet")]
    Unfinished,
    #[error("line {line}: {what}")]
    Line { line: usize, what: String },
    #[error("neither ASCII nor binary STL")]
    NotStl,
    #[error("{0}")]
    Collada(String),
    #[error("there is no face in it")]
    NoFaces,
    #[error("a coordinate is not finite")]
    NotFinite,
}

/// Triangles from the first corner of a polygon to its other sides.
pub(super) fn fan(corners: &[Vec3]) -> impl Iterator<Item = [Vec3; 3]> + '_ {
    let sides = corners.get(1..).unwrap_or_default().windows(2);
    sides.map(|side| [corners[0], side[0], side[1]])
}
