//! URDF text → [`Description`]: positioned checks, `package://`, meshes, inertia.
//!
//! Way of a file: XML with places (`xml`), checks of links (`link`, `inertia`), joints (`joint`)
//! and the whole (`tree`), which give a `checked` robot; meshes found (`resolve`, `packages`), read
//! (`mesh`, `obj`, `ply`, `collada`, `gltf`) and enclosed in hulls (`hulls`), each or each of its
//! objects (`objects`), or cut into parts (`decompose`); visuals with their colours and textures
//! (`visuals`, `painted`); all put together (`assemble`). All problems of a file are found in one
//! run.
//!
//! Not here: merging massless links, initial pose, defaults for what the file leaves out. Expanding
//! xacro is not done here either.

mod assemble;
mod checked;
mod closures;
mod collada;
mod decompose;
mod description;
mod faces;
mod file;
mod foreign;
mod gltf;
mod gyration;
mod habits;
mod hulls;
mod image;
mod inertia;
mod joint;
mod limit;
mod link;
mod mesh;
mod missing;
mod nearby;
mod numbers;
mod obj;
mod objects;
mod options;
mod order;
mod packages;
mod painted;
mod ply;
mod resolve;
mod scope;
mod sensed;
mod sensors;
mod sizes;
pub(crate) mod solids;
mod srdf;
#[cfg(test)]
mod test_folder;
mod tree;
mod visuals;
mod xml;

pub use description::{
    ClosureDescription, ClosureDescriptionKind, CollisionDescription, Description, DrawnMesh,
    ImageFormat, JointDescription, LinkDescription, MeshPart, Tag, Texture, VisualDescription,
    VisualShape,
};
pub use faces::LFS_POINTER;
pub use options::{ImpossibleInertia, MeshShapes, MissingMass, ReadOptions};
pub use sensed::{SensedKind, SensorDescription};
pub use srdf::{Semantics, VirtualJoint, read_srdf, read_srdf_str};
pub use xml::HARDWARE;

use crate::diagnostic::{Diagnostic, Report};
use crate::folder;
use crate::spatial::Vec3;
use faces::MeshError;
use mesh::MeshFile;
use packages::Packages;
pub use packages::Remark;
use resolve::Resolver;
use scope::Scope;
use std::path::{Path, PathBuf};
use xml::Document;

/// Why a mesh file cannot be read.
#[derive(Clone, Debug)]
pub struct UnreadMesh {
    /// What is wrong with it, as the end of a sentence.
    pub message: String,
    /// What to do.
    pub help: String,
}

/// Triangles of a mesh file, STL, OBJ, PLY, COLLADA or glTF, in m, and the files beside it that
/// hold parts of it.
///
/// # Errors
/// What is wrong with the file, and what to do.
pub fn read_triangles(path: &Path) -> Result<(Vec<[Vec3; 3]>, Vec<PathBuf>), UnreadMesh> {
    let told = |error: MeshError| UnreadMesh {
        message: error.to_string(),
        help: error.help(),
    };
    let mesh = alone(path).map_err(told)?;
    // Whatever is wrong with its numbers is found with the corners.
    mesh.corners().map_err(told)?;
    let triangles = mesh.triangles().map_err(told)?;
    Ok((triangles, mesh.beside().to_owned()))
}

/// A mesh that no robot names: its folders are those that a robot in its place would have.
fn alone(path: &Path) -> Result<MeshFile, MeshError> {
    let options = ReadOptions::default();
    let resolver = Resolver::new(folder::of(path), &options, None);
    MeshFile::open(path, &|name| resolver.beside(path, name))
}

/// Reads a URDF file and the meshes of its collision shapes.
///
/// # Errors
/// Everything that is wrong with the file, errors and warnings, in file order; with
/// [`ReadOptions::rest`] only what leaves nothing of it.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Description, Vec<Diagnostic>> {
    let file = path.display().to_string();
    let text = file::text(path).map_err(|finding| vec![*finding])?;
    let mut description = read_str(&text, &file, folder::of(path), options)?;
    description.sources.insert(0, path.to_owned());
    Ok(description)
}

/// A package.
#[derive(Clone, Debug)]
pub struct FoundPackage {
    /// Its folder.
    pub folder: PathBuf,
    /// What is to be said of where that is.
    pub remark: Option<Remark>,
}

/// The workspace or the outermost repository that holds a folder, if one does.
pub fn checkout(dir: &Path) -> Option<PathBuf> {
    packages::around(&std::path::absolute(dir).ok()?).own
}

/// The folder above another one, unless it is of all users.
pub fn above(dir: &Path) -> Option<PathBuf> {
    let around = packages::around(&std::path::absolute(dir).ok()?);
    around.folders.into_iter().nth(1)
}

/// The name of the package in a folder, by its `package.xml`.
pub fn package_name(folder: &Path) -> Option<String> {
    packages::name_in(folder)
}

/// Finds packages, looked for as for `package://`.
pub fn package_finder<'o>(
    base_dir: &Path,
    options: &'o ReadOptions,
) -> impl Fn(&str) -> Option<FoundPackage> + use<'o> {
    let packages = Packages::new(base_dir, options);
    move |name| {
        Some(FoundPackage {
            folder: resolve::tidy(&packages.folder(name)?),
            remark: packages.remark(name),
        })
    }
}

/// Corners of the faces of a mesh file (STL, OBJ, PLY, COLLADA, glTF) in m, as a URDF
/// without `scale` takes them.
///
/// # Errors
/// What is wrong with the file.
pub fn mesh_corners(path: &Path) -> Result<Vec<Vec3>, Box<dyn std::error::Error>> {
    Ok(alone(path)?.corners()?)
}

/// Reads a URDF text and the meshes of its collision shapes.
///
/// - `file_name`: shown in diagnostics
/// - `base_dir`: from where relative mesh names count, and from where packages are looked for
///   upwards
///
/// # Errors
/// As [`read`].
pub fn read_str(
    text: &str,
    file_name: &str,
    base_dir: &Path,
    options: &ReadOptions,
) -> Result<Description, Vec<Diagnostic>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut report = Report::new(file_name, text);
    let description = describe(&mut report, text, file_name, base_dir, options);
    let failed = report.has_errors();
    let diagnostics = report.finish();
    match description {
        Some(description) if !failed || options.rest => Ok(Description {
            diagnostics,
            text: text.into(),
            ..description
        }),
        _ => Err(diagnostics),
    }
}

/// Corners of the faces of a mesh file, m as the file has them.
///
/// - `kind`: how the file's name ends, `stl`, `obj`, `ply`, `dae`, `glb` or `gltf`; without
///   files beside it
///
/// # Errors
/// What is wrong with the file, for people.
pub fn mesh_corners_of(kind: &str, bytes: &[u8]) -> Result<Vec<Vec3>, String> {
    mesh::parse(kind, bytes).map_err(|error| error.to_string())
}

/// Faces of a mesh file, cut into triangles, m as the file has them; see [`mesh_corners_of`].
///
/// # Errors
/// What is wrong with the file, for people.
pub fn mesh_triangles_of(kind: &str, bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, String> {
    mesh::triangles_of(kind, bytes).map_err(|error| error.to_string())
}

/// What a mesh file looks like, m as the file has them, and whether each part has a texture; see
/// [`mesh_corners_of`].
///
/// # Errors
/// What is wrong with the file, for people.
pub fn mesh_parts_of(kind: &str, bytes: &[u8]) -> Result<Vec<(MeshPart, bool)>, String> {
    let file = MeshFile::of(kind, bytes).map_err(|error| error.to_string())?;
    let parts = painted::parts(&file, |_| None).map_err(|error| error.to_string())?;
    let part = |part: faces::Part| {
        let textured = part.paint.image.is_some();
        let part = MeshPart {
            corners: part.corners,
            triangles: part.triangles,
            uv: part.uv,
            color: part.paint.color,
            tint: part.paint.tint,
            texture: None,
        };
        (part, textured)
    };
    Ok(parts.into_iter().map(part).collect())
}

/// Corners of the convex parts that a mesh is cut into where the settings want a decomposition, m.
///
/// - `voxels`: along the longest side; fewer are faster than what is made of a robot
///
/// # Errors
/// What stands against it, for people.
pub fn convex_parts_of(triangles: &[[Vec3; 3]], voxels: u32) -> Result<Vec<Vec<Vec3>>, String> {
    decompose::parts_of(triangles, voxels).map(|found| found.parts)
}

/// `None` only after an error was reported.
fn describe(
    report: &mut Report,
    text: &str,
    file_name: &str,
    base_dir: &Path,
    options: &ReadOptions,
) -> Option<Description> {
    if !(options.scale.is_finite() && options.scale > 0.0) {
        let message = format!("the scale {} is not a number above zero", options.scale);
        report.error("U033", 0..0, message, "1 leaves the size as it is");
        return None;
    }
    let document = Document::parse_rest(text, report)?;
    let mut scope = Scope::new(report);
    scope.impossible_inertia = options.impossible_inertia;
    scope.missing_mass = options.missing_mass;
    scope.pybullet = options.pybullet;
    scope.sensors = options.sensors;
    let spare = order::spare_names(document.root().children().count());
    let mut robot = tree::check(&mut scope, &document, file_name)?;
    let order = match order::order(&mut scope, &robot) {
        Some(order) => order,
        None => order::mend(&mut robot, &spare),
    };
    inertia::judge(&mut scope, &mut robot, &order);
    let mesh_dir = document
        .root()
        .child("mujoco")
        .and_then(|mujoco| mujoco.child("compiler"))
        .and_then(|compiler| compiler.value("meshdir"));
    let resolver = Resolver::new(base_dir, options, mesh_dir);
    let mut meshes = if options.rest {
        robot.forget_meshes();
        hulls::Meshes::default()
    } else {
        hulls::read_meshes(&mut scope, &robot, &resolver, options)
    };
    visuals::check(&mut scope, document.root(), &mut robot);
    let known = std::mem::take(&mut meshes.drawn);
    let drawn = visuals::read(&mut scope, &robot, &resolver, options.drawn, known);
    missing::report_moved(&mut scope, &robot, &resolver);
    let sensors = if options.sensors {
        sensors::read(&mut scope, document.root(), &robot, options.scale)
    } else {
        Vec::new()
    };
    scope.report_tags();
    if scope.report.has_errors() && !options.rest {
        inertia::foretell(&mut scope, &robot, &order);
        return None;
    }
    let mut description = assemble::description(&robot, &order, &meshes, drawn, options.scale)?;
    description.sensors = sensors;
    if !sizes::compare_with_masses(&mut scope, &robot, &order, &description) {
        gyration::compare_with_sizes(&mut scope, &robot, &order, &description);
    }
    sizes::compare_visuals(&mut scope, &robot, &order, &description, options.scale);
    sizes::compare_origins(&mut scope, &robot, &description, options.scale);
    sizes::compare_places(&mut scope, &robot, &order, &description, options.scale);
    Some(description)
}
