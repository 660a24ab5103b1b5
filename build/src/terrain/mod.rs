//! Terrain: surfaces from images, tables and formulas.

mod generate;
mod holes;
mod npy;
mod outside;
mod points;
mod read;

use read::Unused;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use urdf2fmu_core::diagnostic::words::or_meant;
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity};
use urdf2fmu_core::digits::Digits;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::geometry::field::{Field, Samples};
use urdf2fmu_core::geometry::surface::{Surface, Triangles};
use urdf2fmu_core::reading;
use urdf2fmu_core::settings::{HeightForm, HeightSource, TerrainSettings};
use urdf2fmu_core::spatial::{Vec3, rotation_from_rpy};
use urdf2fmu_core::urdf;

/// The shape that settings describe, the files that it is read from, and what is not used of them.
///
/// - `place`: where they stand
///
/// # Errors
/// `T001` where a file cannot be read, `T002` where it holds no terrain.
pub fn shape(
    name: &str,
    settings: &TerrainSettings,
    place: Option<&Place>,
) -> Result<(Shape, Vec<PathBuf>, Vec<Diagnostic>), Box<Diagnostic>> {
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
    let mut notes = Vec::new();
    let samples = match settings {
        TerrainSettings::Plane => return Ok((Shape::Plane, files, notes)),
        TerrainSettings::Mesh { file, scale } => {
            let wrong = |code, message: String, help: &str| {
                error(code, format!("'{}': {message}", file.display()), help)
            };
            // As of heights.
            reading::open(file).map_err(|found| {
                let message = format!("{found}{}", or_meant(file, &found));
                wrong("T001", message, read::UNREAD)
            })?;
            let read = urdf::read_triangles(file);
            let (triangles, beside) =
                read.map_err(|found| wrong("T002", found.message, &found.help))?;
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
                if let Some(Unused {
                    severity,
                    what,
                    help,
                }) = table.unused
                {
                    let message = format!("'{}': {what} not used", path.display());
                    let note = error("T007", message, help);
                    notes.push(Diagnostic { severity, ..*note });
                }
                let by = height.unwrap_or(1.0);
                Samples {
                    size: *size,
                    counts: table.counts,
                    heights: table.values.into_iter().map(|h| h * by).collect(),
                }
            }
            HeightSource::Generated(made) => {
                let asked = height.unwrap_or(1.0);
                if made.form == HeightForm::Waves && made.wavelength > size[0] {
                    let told = |length: f64| Digits(length).to_string();
                    let message = format!(
                        "a wave of {} m is longer than its extent of {} m along x: it has no crest, and \
                         rises to {:.2} m instead of {} m",
                        told(made.wavelength),
                        told(size[0]),
                        asked * generate::wave(0.5 * size[0] / made.wavelength),
                        told(asked)
                    );
                    let help = "a shorter wavelength, or a longer size";
                    let found = error("T008", message, help);
                    notes.push(Diagnostic {
                        severity: Severity::Warning,
                        ..*found
                    });
                }
                generate::heights(made, *size, asked)
            }
        },
    };
    let help = "give at least 2 x 2 finite heights, and at most 4,000,000";
    let field = Field::try_from(samples).map_err(|found| error("T002", found.to_string(), help))?;
    let field = Arc::new(field);
    Ok((Shape::Field { field }, files, notes))
}

/// What looks wrong in a shape that can be used.
///
/// - `rpy`: how it is turned
/// - `place`: where the settings say so
pub fn findings(name: &str, shape: &Shape, rpy: &Vec3, place: Option<&Place>) -> Vec<Diagnostic> {
    let warning = |code, message: &str, help: &str| Diagnostic {
        severity: Severity::Warning,
        code,
        message: format!("terrain '{name}': {message}"),
        help: Some(help.to_owned()),
        place: place.cloned(),
    };
    match shape {
        Shape::Surface { surface } => outside::findings(name, surface, rpy, place),
        Shape::Plane if (rotation_from_rpy(rpy) * Vec3::z()).z < 0.0 => {
            let message = "the plane is upside down: its upper side, z, looks down, and all that is \
                           above it counts as inside";
            vec![warning(
                "T003",
                message,
                "turn it by half a turn, with rpy in rad",
            )]
        }
        Shape::Field { field } if points::are_points(field.samples()) => {
            let message = "its three columns look like x, y, z of points on a grid, but each number \
                           is taken as a height";
            let help = "write the heights alone, a row for each y and a column for each x, and the \
                        extent as size";
            vec![warning("T006", message, help)]
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod careless;
#[cfg(test)]
mod tests;
