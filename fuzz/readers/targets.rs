//! What is tried with arbitrary files. A target returns whatever happens; what must not happen is a panic, a hang or
//! memory out of proportion to the file.
//!
//! | target | bytes are |
//! |---|---|
//! | `urdf` | a URDF; what is accepted is made a model of, with the settings' defaults |
//! | `stl`, `obj`, `collada` | a mesh; what is accepted is enclosed in its hull |
#![allow(
    dead_code,
    missing_docs,
    reason = "each target is a program of its own that uses a part"
)]

use std::path::Path;
use urdf2fmu_core::geometry::{MOST_CORNERS, Shape, bounded_hull};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::{assemble, urdf};

pub fn urdf(data: &[u8]) {
    // No such folder: mesh names that the fuzzer makes up must not find files of this machine.
    let nowhere = Path::new("no-such-folder");
    let text = String::from_utf8_lossy(data);
    let options = urdf::ReadOptions::default();
    let Ok(description) = urdf::read_str(&text, "fuzz.urdf", nowhere, &options) else {
        return;
    };
    let Ok(settings) = Settings::parse("", "none") else {
        return;
    };
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

pub fn collada(data: &[u8]) {
    mesh("dae", data);
}

fn mesh(kind: &str, data: &[u8]) {
    let Ok(points) = urdf::mesh_corners_of(kind, data) else {
        return;
    };
    assert!(!points.is_empty());
    assert!(points.iter().flatten().all(|x| x.is_finite()));
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
