//! Files that terrain is made of: heights as PNG, NPY or CSV by the first byte, and triangles.

#[path = "../../../build/src/terrain/npy.rs"]
mod npy;
#[path = "../../../build/src/terrain/read.rs"]
mod read;

use urdf2fmu_core::geometry::field::{Field, Samples};
use urdf2fmu_core::geometry::surface::{Surface, Triangles};
use urdf2fmu_core::urdf;

pub fn heights(data: &[u8]) {
    let Some((&first, bytes)) = data.split_first() else {
        return;
    };
    let ending = ["png", "npy", "csv", "txt"][usize::from(first % 4)];
    let Ok(table) = read::heights_of(ending, bytes) else {
        return;
    };
    let [nx, ny] = table.counts;
    assert_eq!(nx * ny, table.values.len());
    assert!(table.values.iter().all(|height| height.is_finite()));
    // A large one costs as much as it holds.
    if table.values.len() <= 4096 {
        let size = [2.0, 3.0];
        let (counts, heights) = (table.counts, table.values);
        _ = Field::try_from(Samples {
            size,
            counts,
            heights,
        });
    }
}

pub fn surface(data: &[u8]) {
    let Some((&first, bytes)) = data.split_first() else {
        return;
    };
    let ending = ["stl", "obj", "dae"][usize::from(first % 3)];
    let Ok(triangles) = urdf::mesh_triangles_of(ending, bytes) else {
        return;
    };
    if triangles.len() <= 4096 {
        _ = Surface::try_from(Triangles::new(&triangles));
    }
}
