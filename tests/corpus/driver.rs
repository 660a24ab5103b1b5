//! Helper of `meshes.py`: reads names of mesh files and prints one line of JSON for each, the
//! corners of its faces in m.

use serde_json::json;
use std::io::{BufRead as _, Write as _};
use std::path::Path;
use urdf2fmu_core::urdf;

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for name in std::io::stdin().lock().lines() {
        let told = match urdf::mesh_corners(Path::new(&name?)) {
            Ok(corners) => json!({"corners": corners}),
            Err(error) => json!({"error": error.to_string()}),
        };
        writeln!(out, "{told}")?;
        out.flush()?;
    }
    Ok(())
}
