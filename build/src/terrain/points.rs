//! Tables of points in the place of tables of heights.

use std::collections::BTreeSet;
use urdf2fmu_core::geometry::field::Samples;

/// Whether heights are three columns of which the first two are a grid, at least 2 x 2, each place
/// of which stands there once: the x and y of points.
pub(super) fn are_points(samples: &Samples) -> bool {
    let rows = samples.heights.chunks_exact(3);
    let places: BTreeSet<[u64; 2]> = rows.map(|row| [row[0], row[1]].map(f64::to_bits)).collect();
    let lines = |axis: usize| {
        let places = places.iter().map(|place| place[axis]);
        places.collect::<BTreeSet<u64>>().len()
    };
    let [across, along] = [0, 1].map(lines);
    samples.counts[0] == 3
        && across.min(along) > 1
        && across * along == places.len()
        && places.len() == samples.counts[1]
}
