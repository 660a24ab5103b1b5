//! Terrain: surfaces from images, tables and formulas.

mod generate;
mod holes;
mod npy;
mod outside;
mod read;

use std::path::{Path, PathBuf};
use std::fs::File;
use std::sync::Arc;
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity};
use urdf2fmu_core::diagnostic::words::or_meant;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::geometry::field::{Field, Samples};
use urdf2fmu_core::geometry::surface::{Surface, Triangles};
use urdf2fmu_core::settings::{HeightSource, TerrainSettings};
use urdf2fmu_core::spatial::Vec3;
use urdf2fmu_core::urdf;

/// The shape that settings describe, and the files that it is read from.
///
/// - `place`: where they stand
///
/// # Errors
/// `T001` where a file cannot be read, `T002` where it holds no terrain.
pub fn shape(
    name: &str,
    settings: &TerrainSettings,
    place: Option<&Place>,
) -> Result<(Shape, Vec<PathBuf>), Box<Diagnostic>> {
    let mut files: Vec<PathBuf> = settings.file().into_iter().map(Path::to_owned).collect();
    let error = |code, message: String, help: &str| {
        Box::new(Diagnostic {
            severity: Severity::Error,
            code,
            message: format!("terrain '{name}': {message}"),
            help: Some(help.to_owned()),
            place: place.cloned(),
        })
    };
    let samples = match settings {
        TerrainSettings::Plane => return Ok((Shape::Plane, files)),
        TerrainSettings::Mesh { file, scale } => {
            let wrong = |code, message: String, help: &str| {
                error(code, format!("'{}': {message}", file.display()), help)
            };
            // As of heights.
            File::open(file).map_err(|found| {
                let message = format!("{found}{}", or_meant(file, &found));
                wrong("T001", message, read::UNREAD)
            })?;
            let read = urdf::read_triangles(file);
            let (triangles, beside) =
                read.map_err(|[message, help]| wrong("T002", message, &help))?;
            files.extend(beside);
            let scaled: Vec<_> = triangles.iter().map(|t| t.map(|c| c * *scale)).collect();
            let surface = Surface::try_from(Triangles::new(&scaled));
            let help = "give a file of triangles with an area: STL, OBJ, PLY, COLLADA or glTF";
            let surface = surface.map_err(|found| wrong("T002", found.to_string(), help))?;
            let surface = Arc::new(surface);
            return Ok((Shape::Surface { surface }, files, notes));
        }
        TerrainSettings::Heights {
            source,
            size,
            height,
        } => match source {
            HeightSource::File(path) => {
                let table = read::heights(path).map_err(|found| {
                    let message = format!("'{}': {}", path.display(), found.message);
                    error(found.code, message, found.help)
                })?;
                let by = height.unwrap_or(1.0);
                Samples {
                    size: *size,
                    counts: table.counts,
                    heights: table.values.into_iter().map(|h| h * by).collect(),
                }
            }
            HeightSource::Generated(made) => generate::heights(made, *size, height.unwrap_or(1.0)),
        },
    };
    let help = "give at least 2 x 2 finite heights, and at most 4,000,000";
    let field = Field::try_from(samples).map_err(|found| error("T002", found.to_string(), help))?;
    let field = Arc::new(field);
    Ok((Shape::Field { field }, files))
}

/// What looks wrong in a shape that can be used.
///
/// - `rpy`: how it is turned
/// - `place`: where the settings say so
pub fn findings(name: &str, shape: &Shape, rpy: &Vec3, place: Option<&Place>) -> Vec<Diagnostic> {
    match shape {
        Shape::Surface { surface } => outside::findings(name, surface, rpy, place),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests;
