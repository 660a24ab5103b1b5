//! Fuzz targets for arbitrary files. A target must return without a panic, a hang or memory use out
//! of proportion to the file.
//!
//! | target | bytes are |
//! |---|---|
//! | `urdf` | a URDF; what is accepted is made a model of, with the settings' defaults |
//! | `srdf` | the SRDF of a small robot, which starts in the state that it gives |
//! | `stl`, `obj`, `ply`, `collada`, `gltf` | a mesh, read as corners and as triangles, glTF with
//! its colours, too; some of the accepted are enclosed in their hull |
//! | `decomposition` | the corners of a small mesh, which is cut into convex parts |
//! | `scene` | what a robot looks like, as an FMU holds it |
//! | `xacro` | a document in xacro, a file that it can include, and a YAML file |
//! | `heights` | heights of terrain as PNG, NPY or CSV |
//! | `surface` | triangles of terrain |
//! | `image` | a texture in PNG or JPEG |
//! | `tables` | a table of inputs or results |
//! | `fmu` | an FMU, or its modelDescription.xml |
#![allow(
    dead_code,
    missing_docs,
    clippy::cast_precision_loss,
    reason = "each target is a program of its own that uses a part"
)]

#[path = "../../build/src/describe/words.rs"]
mod describe;
#[path = "targets/fmu.rs"]
mod fmu;
#[path = "targets/image.rs"]
mod image;
#[path = "targets/importer.rs"]
mod importer;
#[path = "targets/results.rs"]
mod results;
#[path = "targets/scene.rs"]
mod scene;
#[path = "targets/srdf.rs"]
mod srdf;
#[path = "targets/tables.rs"]
mod tables;
#[path = "targets/terrain.rs"]
mod terrain;
#[path = "targets/xacro.rs"]
mod xacro;

pub use fmu::fmu;
pub use image::image;
pub use scene::scene;
pub use srdf::srdf;
pub use tables::tables;
pub use terrain::{heights, surface};
pub use xacro::xacro;

use std::path::Path;
use urdf2fmu_core::geometry::{MOST_CORNERS, Shape, bounded_hull};
use urdf2fmu_core::hash::fnv1a;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::spatial::Vec3;
use urdf2fmu_core::{assemble, urdf};

pub fn urdf(data: &[u8]) {
    // No such folder: mesh names that the fuzzer makes up must not find files of this machine. At
    // the root, so that no folders around it are searched for them.
    let nowhere = Path::new("/no-such-folder");
    let text = String::from_utf8_lossy(data);
    let options = urdf::ReadOptions {
        sensors: true,
        ..urdf::ReadOptions::default()
    };
    let Ok(description) = urdf::read_str(&text, "fuzz.urdf", nowhere, &options) else {
        return;
    };
    let settings = Settings::default();
    if !chosen(data) {
        return;
    }
    if let Ok(assembled) = assemble::build(&description, &settings) {
        // What is accepted must be what the simulator can work with.
        assembled.model.validate().expect("a legal model");
    }
}

pub fn stl(data: &[u8]) {
    mesh("stl", data);
}

pub fn obj(data: &[u8]) {
    mesh("obj", data);
}

pub fn ply(data: &[u8]) {
    mesh("ply", data);
}

pub fn collada(data: &[u8]) {
    mesh("dae", data);
}

/// The JSON, a line end, and the numbers: lengths of chunks would be wrong after every change. What
/// is a whole file, or begins with a line end and is JSON alone, is read as it is.
pub fn gltf(data: &[u8]) {
    if data.starts_with(b"glTF") {
        painted("glb", data);
        return;
    }
    if let Some(json) = data.strip_prefix(b"\n") {
        painted("gltf", json);
        return;
    }
    let end = data.iter().position(|&byte| byte == b'\n');
    let (json, numbers) = data.split_at(end.unwrap_or(data.len()));
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    let mut chunk = |kind: &[u8; 4], content: &[u8], filler: u8| {
        let length = content.len().next_multiple_of(4);
        bytes.extend(u32::try_from(length).unwrap_or(0).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
        bytes.resize(bytes.len() + length - content.len(), filler);
    };
    chunk(b"JSON", json, b' ');
    chunk(b"BIN\0", numbers.get(1..).unwrap_or_default(), 0);
    painted("glb", &bytes);
}

/// A mesh, and what it looks like.
fn painted(kind: &str, data: &[u8]) {
    mesh(kind, data);
    for (part, textured) in urdf::mesh_parts_of(kind, data).unwrap_or_default() {
        assert!(!part.triangles.is_empty());
        let expected = if textured { part.triangles.len() } else { 0 };
        assert_eq!(part.uv.len(), expected);
        assert!(part.uv.iter().flatten().flatten().all(|x| x.is_finite()));
    }
}

/// Most triangles of a mesh that is decomposed here.
const FEW: usize = 24;

/// Voxels along its longest side, an eighth of what is made of a robot.
const VOXELS: u32 = 8;

/// Coordinates on a coarse grid, so that faces meet and solids close: the first byte says how they
/// are joined.
pub fn decomposition(data: &[u8]) {
    let Some((&kind, places)) = data.split_first() else {
        return;
    };
    // A byte is a place on a grid of 8 x 8 x 4; one bit of `kind` tears the grid.
    let points: Vec<Vec3> = places
        .iter()
        .take(3 * FEW)
        .enumerate()
        .map(|(i, &place)| {
            let number = |shift: u8, mask: u8| f64::from(place >> shift & mask);
            let torn = if kind & 1 == 1 { 1e-7 * i as f64 } else { 0.0 };
            let scale = [1.0, 1e-3, 1e6, 1e-9][usize::from(kind >> 1 & 3)];
            Vec3::new(number(0, 7) + torn, number(3, 7), number(6, 3)) * scale
        })
        .collect();
    let triangles: Vec<[Vec3; 3]> = if kind & 8 == 0 {
        let corners = points.chunks_exact(3);
        corners.map(|t| [t[0], t[1], t[2]]).collect()
    } else {
        // The surface of the hull, which is closed, with the last points' triangles taken away or
        // pushed in.
        let Ok(hull) = bounded_hull(&points, 12) else {
            return;
        };
        let center = hull.vertices.iter().sum::<Vec3>() / hull.vertices.len() as f64;
        let corners = hull.vertices.windows(3);
        corners
            .flat_map(|t| [[t[0], t[1], t[2]], [t[0], t[2], center]])
            .collect()
    };
    let Ok(parts) = urdf::convex_parts_of(&triangles, VOXELS) else {
        return;
    };
    assert!(!parts.is_empty());
    for vertices in parts {
        assert!(vertices.iter().flatten().all(|x| x.is_finite()));
        let shape = Shape::Hull { vertices };
        assert!(shape.volume() > 0.0 && shape.volume().is_finite());
    }
}

/// Largest number of points of which the hull is made here, and largest file of which it is made
/// each time.
const SMALL_MESH: usize = 64;

fn mesh(kind: &str, data: &[u8]) {
    let triangles = urdf::mesh_triangles_of(kind, data);
    let Ok(points) = urdf::mesh_corners_of(kind, data) else {
        return;
    };
    assert!(!points.is_empty());
    assert!(points.iter().flatten().all(|x| x.is_finite()));
    if let Ok(triangles) = triangles {
        assert!(triangles.iter().flatten().flatten().all(|x| x.is_finite()));
        // A scene may place a mesh many times.
        assert!(matches!(kind, "dae" | "glb" | "gltf") || triangles.len() <= data.len());
    }
    // Reading is what the bytes decide about: the hull is made for one file in eight.
    if points.len() > SMALL_MESH || !chosen(data) {
        return;
    }
    let Ok(hull) = bounded_hull(&points, MOST_CORNERS) else {
        return;
    };
    assert!(hull.vertices.len() <= MOST_CORNERS);
    let shape = Shape::Hull {
        vertices: hull.vertices,
    };
    assert!(shape.volume() >= 0.0);
    assert!(shape.solid_inertia(1.0).I_cm.iter().all(|x| x.is_finite()));
}

/// One file in eight, by its bytes.
fn chosen(data: &[u8]) -> bool {
    (fnv1a(data) >> 32).is_multiple_of(8)
}
