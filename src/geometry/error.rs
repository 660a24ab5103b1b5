//! What is wrong with points, heights and triangles.

/// Why points have no hull, heights no surface, triangles no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// Nothing to enclose.
    #[error("there are no points")]
    NoPoints,
    /// NaN or infinite.
    #[error("point {index} is not finite")]
    NotFinite {
        /// Position in the list.
        index: usize,
    },
    /// Not a robot part.
    #[error("point {index} lies {distance:.3e} m from the origin, more than 1e6; check the unit")]
    TooFar {
        /// Position in the list.
        index: usize,
        /// m
        distance: f64,
    },
    /// No extent.
    #[error("all points are in one place")]
    OnePlace,
    /// None, or too many.
    #[error("there are {count} triangles with an area; 1 to 1,000,000 are possible")]
    Triangles {
        /// How many.
        count: usize,
    },
    /// A line or a point.
    #[error("triangle {index} has no area")]
    Flat {
        /// Position in the list.
        index: usize,
    },
    /// Not a grid.
    #[error("heights need at least 2 x 2 and at most 4,000,000 samples over 0 to 1e6 m")]
    Grid,
}
