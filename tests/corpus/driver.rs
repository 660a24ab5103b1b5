//! For `corpus.py` and `meshes.py`: names of files in, one line of JSON for each out.
//!
//! A URDF: what became of it (`ours.rs`). A mesh: the corners of its faces, m.

mod ours;

use serde_json::json;
use std::io::{BufRead as _, Write as _};
use std::path::Path;
use urdf2fmu_core::urdf;

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for name in std::io::stdin().lock().lines() {
        let name = name?;
        let path = Path::new(&name);
        let told = if path.extension().is_some_and(|e| e == "urdf") {
            ours::judge(path)
        } else {
            match urdf::mesh_corners(path) {
                Ok(corners) => json!({"corners": corners}),
                Err(error) => json!({"error": error.to_string()}),
            }
        };
        writeln!(out, "{told}")?;
        out.flush()?;
    }
    Ok(())
}
