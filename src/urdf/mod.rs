//! URDF text → [`Description`]: positioned checks, `package://`, meshes, inertia.
//!
//! Way of a file: XML with places (`xml`), checks of links (`link`, `inertia`), joints (`joint`) and the whole
//! (`tree`), typed data by way of urdf-rs (`typed`), meshes found (`resolve`), read (`mesh`, `collada`) and enclosed
//! in hulls (`hulls`) or cut into parts (`decompose`), all put together (`assemble`). All problems of a file are found
//! in one run.
//!
//! Not here: merging massless links, initial pose, defaults for what the file leaves out. xacro is not expanded.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod assemble;
mod collada;
mod decompose;
mod diagnostic;
mod foreign;
mod hulls;
mod inertia;
mod joint;
mod link;
mod mesh;
mod resolve;
mod scope;
mod srdf;
mod tree;
mod typed;
mod xml;

pub use diagnostic::{Diagnostic, Place, Severity};
pub use srdf::{Semantics, read_srdf, read_srdf_str};

use crate::geometry::Shape;
use crate::model::{ActuatorMode, JointKind, Limits};
use crate::settings::Pattern;
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3};
use diagnostic::Report;
use mesh::MeshFile;
use resolve::Resolver;
use scope::Scope;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use xml::Document;

/// URDF files larger than this, in bytes, are refused.
const LARGEST_FILE: u64 = 64 << 20;

/// A checked URDF with its meshes read: a tree with parents before children (file order among siblings).
#[derive(Clone, Debug)]
pub struct Description {
    /// Robot name.
    pub name: String,
    /// The links; the first is the root.
    pub links: Vec<LinkDescription>,
    /// The joints, ordered like their child links: joint `i` has child link `i + 1`.
    pub joints: Vec<JointDescription>,
    /// Files that it was read from (URDF first, then meshes), for `resources/source/`.
    pub sources: Vec<PathBuf>,
    /// Warnings and notes, each with its place in the file.
    pub diagnostics: Vec<Diagnostic>,
    /// The URDF's text, for marks in later findings; empty for a robot that was made in code.
    pub text: Arc<str>,
}

/// A link as the file has it.
#[derive(Clone, Debug)]
pub struct LinkDescription {
    /// Name.
    pub name: String,
    /// `<inertial>`, rotated into the link's axes; none where the file has none.
    pub inertial: Option<RigidInertia>,
    /// Axes of `<inertial><origin>` in the link's; the identity where the file has none.
    pub R_LI: Mat3,
    /// `<collision>` elements in file order, poses in the link's frame.
    pub collisions: Vec<CollisionDescription>,
    /// `<contact><lateral_friction>`, Drake's `mu_dynamic` or Gazebo's `mu1`, where the file has one.
    pub friction: Option<f64>,
    /// Drake's `mu_static`, where the file has one.
    pub static_friction: Option<f64>,
    /// `<contact><rolling_friction>`, m, where the file has one.
    pub rolling_friction: Option<f64>,
    /// `<contact><spinning_friction>`, m, where the file has one.
    pub torsional_friction: Option<f64>,
    /// `<contact><restitution>`, where the file has one.
    pub restitution: Option<f64>,
    /// `<contact><stiffness>`, N/m, where the file has one; used with PyBullet's conventions.
    pub stiffness: Option<f64>,
    /// `<contact><damping>`, N·s/m, likewise.
    pub damping: Option<f64>,
    /// `<contact><inertia_scaling>`, where the file has one: PyBullet's factor on the inertia, used with its conventions.
    pub inertia_scaling: Option<f64>,
    /// 1-based line of the `<link>` element.
    pub line: usize,
}

/// A collision shape as the file has it.
#[derive(Clone, Debug)]
pub struct CollisionDescription {
    /// Pose of the shape in the link's frame.
    pub X_LG: Pose,
    /// Mesh: its convex hull.
    pub shape: Shape,
    /// Whether it is one of several convex parts of a mesh; these are no wheels.
    pub part: bool,
    /// The mesh file that it was read from.
    pub mesh: Option<PathBuf>,
    /// Mesh that turns with a continuous joint: corners of its hull, more than the shape has.
    pub outline: Option<Arc<[Vec3]>>,
    /// Mesh: least and greatest coordinates of the whole of it, m, in the shape's axes; its hull has fewer corners.
    pub bounds: Option<[Vec3; 2]>,
}

/// A joint as the file has it.
#[derive(Clone, Debug)]
pub struct JointDescription {
    /// Name.
    pub name: String,
    /// Type.
    pub kind: JointKind,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the child link.
    pub child: usize,
    /// `<origin>`.
    pub X_PJ: Pose,
    /// Unit vector; (1, 0, 0) where the file has none.
    pub axis: Vec3,
    /// lower and upper; none for continuous, planar, floating, fixed joints.
    pub limits: Option<Limits>,
    /// As in the file, where there is a `<limit>`.
    pub effort: Option<f64>,
    /// As in the file, where there is a `<limit>`.
    pub velocity: Option<f64>,
    /// `<dynamics damping>`, 0 where the file has none.
    pub damping: f64,
    /// `<dynamics friction>`, 0 where the file has none.
    pub friction: f64,
    /// Rotor inertia times gear ratio squared, kg·m² or kg: Drake's tags, or `<dynamics armature>`.
    pub armature: f64,
    /// What its hardware takes, by `<ros2_control>` and `<transmission>`.
    pub interfaces: Vec<ActuatorMode>,
    /// `<mimic>`: name of the joint followed, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
    /// 1-based line of the `<joint>` element.
    pub line: usize,
}

/// How to read a URDF.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// Folders in which packages are looked for: a package, a folder of packages, or an install prefix.
    pub package_paths: Vec<PathBuf>,
    /// Factor on all lengths, meshes included. Masses stay, inertia takes its square.
    pub scale: f64,
    /// The inertia matrices are not used, because they will be computed from the shapes: what is wrong with them
    /// is a warning.
    pub ignore_inertia: bool,
    /// The numbers of `<contact>` are used that only `PyBullet` has a use for: inertia scaling, stiffness, damping.
    pub pybullet: bool,
    /// Links whose collision meshes become several convex parts each (true) or their hulls (false); of those that
    /// match, the last holds.
    pub decomposed: Vec<(Pattern, bool)>,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            package_paths: Vec::new(),
            scale: 1.0,
            ignore_inertia: false,
            pybullet: false,
            decomposed: Vec::new(),
        }
    }
}

impl ReadOptions {
    /// The defaults, with the package paths of `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`.
    pub fn from_environment() -> Self {
        let paths = ["ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"]
            .into_iter()
            .filter_map(std::env::var_os)
            .flat_map(|value| std::env::split_paths(&value).collect::<Vec<_>>())
            .filter(|path| !path.as_os_str().is_empty())
            .collect();
        Self {
            package_paths: paths,
            ..Self::default()
        }
    }
}

/// Reads a URDF file and the meshes of its collision shapes.
///
/// # Errors
/// Everything that is wrong with the file, errors and warnings, in file order.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Description, Vec<Diagnostic>> {
    let file = path.display().to_string();
    let text = text(path).map_err(|finding| vec![*finding])?;
    let base_dir = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut description = read_str(&text, &file, base_dir, options)?;
    description.sources.insert(0, path.to_owned());
    Ok(description)
}

/// Corners of the faces of a mesh file (STL, OBJ, COLLADA) in m, as a URDF without `scale` takes them.
///
/// # Errors
/// What is wrong with the file.
pub fn mesh_corners(path: &Path) -> Result<Vec<Vec3>, Box<dyn std::error::Error>> {
    Ok(MeshFile::open(path)?.corners()?)
}

/// Reads a URDF text and the meshes of its collision shapes.
///
/// - `file_name`: shown in diagnostics
/// - `base_dir`: from where relative mesh names count, and from where packages are looked for upwards
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
        Some(description) if !failed => Ok(Description {
            diagnostics,
            text: text.into(),
            ..description
        }),
        _ => Err(diagnostics),
    }
}

/// Corners of the faces of a mesh file, m as the file has them.
///
/// - `kind`: how the file's name ends, `stl`, `obj` or `dae`
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
    let document = Document::parse(text, report)?;
    let mut scope = Scope::new(report);
    scope.ignore_inertia = options.ignore_inertia;
    scope.pybullet = options.pybullet;
    let robot = tree::check(&mut scope, &document, file_name)?;
    let order = tree::order(&mut scope, &robot);
    inertia::judge(&mut scope, &robot, order.as_ref());
    let mesh_dir = document
        .root()
        .child("mujoco")
        .and_then(|mujoco| mujoco.child("compiler"))
        .and_then(|compiler| compiler.value("meshdir"));
    let resolver = Resolver::new(base_dir, options, mesh_dir);
    let meshes = hulls::read_meshes(&mut scope, &robot, &resolver, options);
    hulls::check_visuals(&mut scope, &robot, &resolver);
    scope.report_tags();
    if scope.report.has_errors() {
        return None;
    }
    let order = order?;
    match typed::read(&robot, &order) {
        Ok(typed) => {
            let description =
                assemble::description(&robot, &order, &typed, &meshes, options.scale)?;
            inertia::compare_with_shapes(&mut scope, &robot, &order, &description);
            Some(description)
        }
        Err(error) => {
            let help = "please report this with the file: the checks should have found it";
            report.error(
                "U009",
                0..0,
                format!("urdf-rs refuses the file: {error}"),
                help,
            );
            None
        }
    }
}

/// The text of a file.
fn text(path: &Path) -> Result<String, Box<Diagnostic>> {
    let problem = |code, message: String, help: &str| {
        Box::new(Diagnostic {
            severity: Severity::Error,
            code,
            message,
            help: (!help.is_empty()).then(|| help.to_owned()),
            place: None,
        })
    };
    let name = path.display();
    let io = |error: std::io::Error| problem("U001", format!("{name} cannot be read: {error}"), "");
    let file = File::open(path).map_err(io)?;
    let metadata = file.metadata().map_err(io)?;
    if metadata.is_dir() {
        let message = format!("{name} is a folder");
        return Err(problem("U001", message, "name the URDF file in it"));
    }
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(io)?;
    if bytes.len() as u64 > LARGEST_FILE {
        let message = format!("{name} has more than {LARGEST_FILE} bytes");
        return Err(problem(
            "U001",
            message,
            "no URDF is that large: is it the right file?",
        ));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let utf16 = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
        let message = if utf16 {
            "the file is UTF-16 text, not UTF-8".to_owned()
        } else {
            format!("the file is not UTF-8 text: byte 0x{:02x}", bytes[valid])
        };
        let shown = String::from_utf8_lossy(bytes);
        // What stands before the bad byte is the same in both.
        let mut finding = problem("U002", message, "save the file as UTF-8");
        let place = Place::in_text(&name.to_string(), &shown, valid..valid + 1);
        finding.place = Some(place);
        finding
    })
}
