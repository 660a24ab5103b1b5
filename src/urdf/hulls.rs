//! Meshes of a robot's collision shapes → hulls and convex parts, scaled.
//!
//! A file that several links use at one scale is processed once. A failure is a finding.

use super::checked::{CheckedRobot, Geometry};
use super::decompose;
use super::faces::{FORMATS, MeshError};
use super::mesh::MeshFile;
use super::missing::{self, Lost};
use super::options::ReadOptions;
use super::resolve::{Found, Resolver};
use super::scope::Scope;
use crate::geometry::{GeometryError, MOST_CORNERS, bounded_hull};
use crate::hash::Quick;
use crate::model::JointKind;
use crate::spatial::Vec3;
use std::collections::{HashMap, HashSet};
use std::hash::BuildHasherDefault;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Part of a mesh's size by which its hull may be off without a note.
const SILENT_ERROR: f64 = 1e-3;

/// Corners that are kept of the hull of what may be a wheel.
const MOST_OUTLINE: usize = 1024;

/// The hull of a mesh, scaled.
#[derive(Clone)]
pub(super) struct ReadMesh {
    pub(super) path: PathBuf,
    /// Not to be packed: a symbolic link leads out of the robot's folders.
    linked: bool,
    /// Files that it is read from, too.
    beside: Vec<PathBuf>,
    pub(super) vertices: Vec<Vec3>,
    /// How far the mesh reaches out of their hull at most, m.
    error: f64,
    /// Least and greatest coordinates of all that the file has.
    pub(super) bounds: [Vec3; 2],
    /// Convex parts in place of the hull, where they are wanted.
    pub(super) parts: Option<Arc<[Vec<Vec3>]>>,
    /// More of them, where the mesh may be a wheel.
    pub(super) outline: Option<Arc<[Vec3]>>,
}

/// Meshes by link and collision, both in file order.
#[derive(Default)]
pub(super) struct Meshes {
    pub(super) hulls: HashMap<(usize, usize), ReadMesh>,
    /// Files to be packed, each once.
    pub(super) sources: Vec<PathBuf>,
}

/// Reads the meshes of all collision shapes; what cannot be read is reported.
pub(super) fn read_meshes(
    scope: &mut Scope,
    robot: &CheckedRobot,
    resolver: &Resolver,
    options: &ReadOptions,
) -> Meshes {
    let mut meshes = Meshes::default();
    // The same mesh often stands in many links; `None` if it was reported already.
    let mut known: HashMap<(PathBuf, [u64; 3], bool), Option<ReadMesh>> = HashMap::new();
    let wheels = wheel_meshes(robot);
    let mut found = HashMap::new();
    let mut lost = Vec::new();
    let mut first_mesh: Option<Range<usize>> = None;
    let mut count = 0;
    for (i, link) in robot.links.iter().enumerate() {
        scope.owner = format!("link '{}'", link.name);
        let decompose = options
            .decomposed
            .iter()
            .rfind(|(pattern, _)| pattern.matches(link.name))
            .is_some_and(|&(_, decompose)| decompose);
        for (k, collision) in link.collisions.iter().enumerate() {
            let Geometry::Mesh {
                filename,
                scale: factors,
                at,
            } = &collision.geometry
            else {
                continue;
            };
            if !decompose {
                first_mesh.get_or_insert_with(|| at.clone());
            }
            count += usize::from(!decompose);
            let place = found
                .entry(*filename)
                .or_insert_with(|| resolver.find(filename));
            let Ok(file) = place else {
                lost.push(Lost {
                    owner: scope.owner.clone(),
                    filename,
                    at: at.clone(),
                });
                continue;
            };
            let file = file.clone();
            let factors = factors.map(|f| f * options.scale);
            let read = known
                .entry((file.path.clone(), factors.map(f64::to_bits), decompose))
                .or_insert_with(|| {
                    read_mesh(
                        scope,
                        resolver,
                        file,
                        Vec3::from(factors),
                        wheels.contains(filename),
                        decompose,
                        at,
                    )
                });
            if let Some(mesh) = read {
                if !mesh.linked && !meshes.sources.contains(&mesh.path) {
                    meshes.sources.push(mesh.path.clone());
                    meshes.sources.extend(mesh.beside.iter().cloned());
                }
                meshes.hulls.insert((i, k), mesh.clone());
            }
        }
    }
    missing::report(scope, robot, resolver, lost);
    report_rough_hulls(scope, robot, &meshes);
    if let Some(at) = first_mesh {
        let message =
            format!("collision meshes are replaced by their convex hulls ({count}, first here)");
        scope.report.note("U110", at, message, "");
    }
    meshes
}

/// Tells how far the hulls are off that do not keep all corners, once for all of them, at the
/// worst.
fn report_rough_hulls(scope: &mut Scope, robot: &CheckedRobot, meshes: &Meshes) {
    let mut rough: Vec<(&Path, f64, &Range<usize>, &str)> = Vec::new();
    for (i, link) in robot.links.iter().enumerate() {
        for (k, collision) in link.collisions.iter().enumerate() {
            let (Geometry::Mesh { at, .. }, Some(mesh)) =
                (&collision.geometry, meshes.hulls.get(&(i, k)))
            else {
                continue;
            };
            let size = (mesh.bounds[1] - mesh.bounds[0]).norm();
            let known = rough.iter().any(|(path, ..)| *path == mesh.path);
            if mesh.error > SILENT_ERROR * size && mesh.parts.is_none() && !known {
                rough.push((&mesh.path, mesh.error, at, link.name));
            }
        }
    }
    let Some((path, error, at, link)) = rough.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return;
    };
    let name = path.file_name().unwrap_or(path.as_os_str());
    let (name, error) = (name.to_string_lossy(), error * 1e3);
    let message = if rough.len() == 1 {
        format!(
            "the hull of mesh {name} keeps {MOST_CORNERS} corners; it is off by at most {error:.2} mm"
        )
    } else {
        format!(
            "the hulls of {} meshes keep {MOST_CORNERS} corners; they are off by at most {error:.2} mm, that of mesh {name}",
            rough.len()
        )
    };
    if rough.len() == 1 {
        scope.owner = format!("link '{link}'");
        scope.note("U108", (*at).clone(), &message, "");
    } else {
        scope.report.note("U108", (*at).clone(), message, "");
    }
}

fn read_mesh(
    scope: &mut Scope,
    resolver: &Resolver,
    file: Found,
    factors: Vec3,
    wheel: bool,
    decompose: bool,
    at: &Range<usize>,
) -> Option<ReadMesh> {
    let Found { path, linked } = file;
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    if linked {
        let message = format!(
            "mesh {name} is a symbolic link out of the robot's folders: it is used, but no copy is packed"
        );
        scope.note("U113", at.clone(), &message, "");
    }
    let read = MeshFile::open(&path, &|name| resolver.beside(&path, name));
    let read = read.and_then(|mesh| Ok((mesh.corners()?, mesh)));
    let (points, mesh) = match read {
        Ok(read) => read,
        Err(error) => {
            let (code, help) = match error {
                MeshError::Pointer => (
                    "U105",
                    "fetch the files where the robot was cloned: git lfs install && git lfs pull"
                        .to_owned(),
                ),
                MeshError::Format(_) => ("U106", "convert the mesh to STL or OBJ".to_owned()),
                _ => ("U105", format!("export the mesh again; {FORMATS} are read")),
            };
            let message = format!("mesh {} cannot be read: {error}", path.display());
            scope.problem(code, at.clone(), &message, help);
            return None;
        }
    };
    let points = distinct(points.iter().map(|p| p.component_mul(&factors)));
    let hull = match bounded_hull(&points, MOST_CORNERS) {
        Ok(hull) => hull,
        Err(error) => {
            let help = match error {
                GeometryError::TooFar { .. } => {
                    "many meshes are in mm: use scale=\"0.001 0.001 0.001\""
                }
                _ => "the mesh needs some extent; export it again",
            };
            let message = format!("mesh {} has no convex hull: {error}", path.display());
            scope.problem("U107", at.clone(), &message, help);
            return None;
        }
    };
    let bounds = points
        .iter()
        .fold([points[0]; 2], |[low, high], p| [low.inf(p), high.sup(p)]);
    let outline = wheel
        .then(|| bounded_hull(&points, MOST_OUTLINE))
        .and_then(Result::ok)
        .map(|hull| hull.vertices.into());
    if hull.flat {
        let message = format!("mesh {name} has no volume: it is used as it is");
        scope.warning("U109", at.clone(), &message, "");
    }
    let parts = if decompose && !hull.flat {
        Some(convex_parts(scope, &mesh, &name, factors, at)?.into())
    } else {
        None
    };
    Some(ReadMesh {
        path,
        linked,
        beside: mesh.beside().to_vec(),
        vertices: hull.vertices,
        error: hull.error,
        bounds,
        parts,
        outline,
    })
}

/// Each point once, where it first comes: an STL has a corner anew for each of its triangles.
fn distinct(points: impl ExactSizeIterator<Item = Vec3>) -> Vec<Vec3> {
    let mut known: HashSet<[u64; 3], BuildHasherDefault<Quick>> =
        HashSet::with_capacity_and_hasher(points.len() / 4, BuildHasherDefault::default());
    let bits = |p: &Vec3| [p.x, p.y, p.z].map(f64::to_bits);
    points.filter(|p| known.insert(bits(p))).collect()
}

/// The convex parts of a mesh; says how many, and how much they fill that the mesh does not.
fn convex_parts(
    scope: &mut Scope,
    mesh: &MeshFile,
    name: &str,
    factors: Vec3,
    at: &Range<usize>,
) -> Option<Vec<Vec<Vec3>>> {
    let triangles = mesh.triangles().map_err(|error| error.to_string());
    let scaled = triangles.map(|triangles| {
        let scaled = |p: Vec3| p.component_mul(&factors);
        triangles.into_iter().map(|t| t.map(scaled)).collect()
    });
    match scaled.and_then(|triangles: Vec<_>| decompose::parts(&triangles)) {
        Ok(found) => {
            let volume = match found.excess {
                Some([parts, hull]) => format!(
                    "their volume is off the mesh's by {:.1} %, its hull's would be by {:.1} %",
                    parts * 100.0,
                    hull * 100.0
                ),
                None => "it is not closed, so its volume is not known".to_owned(),
            };
            let count = found.parts.len();
            let message = format!("mesh {name} becomes {count} convex parts; {volume}");
            scope.note("U114", at.clone(), &message, "");
            Some(found.parts)
        }
        Err(error) => {
            let message = format!("mesh {name} cannot be decomposed: {error}");
            let help = "set collision = \"hull\" for this link, or give it several simpler meshes";
            scope.problem("U115", at.clone(), &message, help);
            None
        }
    }
}

/// Files of the meshes that turn with a continuous joint.
fn wheel_meshes<'d>(robot: &CheckedRobot<'d>) -> HashSet<&'d str> {
    let mut carried_by = HashMap::new();
    for joint in &robot.joints {
        if let Some(child) = &joint.child {
            carried_by.entry(child.name).or_insert(joint);
        }
    }
    let turns = |mut link: &'d str| {
        // No more steps than joints: whether they go in a circle is not known yet.
        for _ in 0..robot.joints.len() {
            match (carried_by.get(link), carried_by.get(link).map(|j| j.kind)) {
                (Some(joint), Some(JointKind::Fixed)) => match &joint.parent {
                    Some(parent) => link = parent.name,
                    None => return false,
                },
                (_, kind) => return kind == Some(JointKind::Continuous),
            }
        }
        false
    };
    let mut files = HashSet::new();
    for link in &robot.links {
        for collision in &link.collisions {
            if let Geometry::Mesh { filename, .. } = &collision.geometry
                && turns(link.name)
            {
                files.insert(*filename);
            }
        }
    }
    files
}
