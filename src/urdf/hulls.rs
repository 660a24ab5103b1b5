//! Meshes of a robot's collision shapes → hulls and convex parts, scaled.
//!
//! A file that several links use at one scale is processed once. A failure is a finding.

use super::checked::{CheckedRobot, Geometry};
use super::decompose;
use super::faces::MeshError;
use super::mesh::{self, MeshFile};
use super::missing::{self, Lost, Unread};
use super::objects;
use super::options::{MeshShapes, ReadOptions};
use super::painted;
use super::resolve::{Found, Missing, Resolver};
use super::scope::Scope;
use super::visuals::{self, Parts};
use crate::geometry::{BoundedHull, GeometryError, MOST_CORNERS, bounded_hull};
use crate::hash::Quick;
use crate::model::JointKind;
use crate::parallel;
use crate::spatial::Vec3;
use std::collections::{BTreeSet, HashMap, HashSet};
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
    /// Convex parts in place of the hull: of a decomposition, or of the objects of the file.
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
    /// What files hold that are to be drawn, read with the hulls so that no file is read twice and
    /// no thread waits for the last hull.
    pub(super) drawn: HashMap<PathBuf, Parts>,
}

/// What is made of a mesh, once for all shapes that ask for the same: its file, the bits of the
/// factors on its coordinates, and what it is to become.
type Key = (PathBuf, [u64; 3], Option<MeshShapes>);

/// A mesh of a collision shape.
struct Wanted<'r, 'd> {
    /// Number of the link and of the collision in it, in file order.
    place: (usize, usize),
    filename: &'d str,
    /// On all coordinates.
    factors: Vec3,
    /// What it is to become, where somebody says so.
    shapes: Option<MeshShapes>,
    at: &'r Range<usize>,
}

impl Wanted<'_, '_> {
    fn key(&self, path: &Path) -> Key {
        let factors: [f64; 3] = self.factors.into();
        (path.to_owned(), factors.map(f64::to_bits), self.shapes)
    }
}

/// The meshes of all collision shapes in file order.
fn wanted<'r, 'd>(robot: &'r CheckedRobot<'d>, options: &ReadOptions) -> Vec<Wanted<'r, 'd>> {
    let mut list = Vec::new();
    for (i, link) in robot.links.iter().enumerate() {
        let mut named = options.meshes.iter().rev();
        let shapes = named.find(|(pattern, _)| pattern.matches(link.name));
        let shapes = shapes.map(|&(_, shapes)| shapes);
        for (k, collision) in link.collisions.iter().enumerate() {
            if let Geometry::Mesh {
                filename,
                scale,
                at,
            } = &collision.geometry
            {
                list.push(Wanted {
                    place: (i, k),
                    filename,
                    factors: Vec3::from(scale.map(|f| f * options.scale)),
                    shapes,
                    at,
                });
            }
        }
    }
    list
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
    let mut known: HashMap<Key, Option<ReadMesh>> = HashMap::new();
    let wheels = wheel_meshes(robot);
    let wanted = wanted(robot, options);
    let mut found = HashMap::new();
    for mesh in &wanted {
        let name = mesh.filename;
        found.entry(name).or_insert_with(|| resolver.find(name));
    }
    let drawn = if options.drawn {
        visuals::likely_files(robot, resolver)
    } else {
        BTreeSet::new()
    };
    let (mut ahead, drawn) = read_ahead(&wanted, &found, &wheels, &drawn);
    meshes.drawn = drawn;
    let (mut lost, mut unread) = (Vec::new(), Vec::new());
    for mesh in &wanted {
        scope.owner = format!("link '{}'", robot.links[mesh.place.0].name);
        let Ok(file) = &found[mesh.filename] else {
            lost.push(Lost {
                owner: scope.owner.clone(),
                filename: mesh.filename,
                at: mesh.at.clone(),
            });
            continue;
        };
        let key = mesh.key(&file.path);
        let ahead = ahead.remove(&key);
        let read = known.entry(key).or_insert_with(|| {
            let enclosed = ahead.unwrap_or_else(|| {
                let beside = |name: &str| resolver.beside(&file.path, name);
                let wheel = wheels.contains(mesh.filename);
                enclosed(MeshFile::open(&file.path, &beside), mesh, wheel)
            });
            if let Err(Failure::Read(error @ MeshError::Format(_))) = &enclosed {
                unread.push(Unread {
                    owner: scope.owner.clone(),
                    message: error.to_string(),
                    path: file.path.clone(),
                    at: mesh.at.clone(),
                });
                return None;
            }
            read_mesh(scope, file, enclosed, mesh)
        });
        if let Some(read) = read {
            if !read.linked && !meshes.sources.contains(&read.path) {
                meshes.sources.push(read.path.clone());
                meshes.sources.extend(read.beside.iter().cloned());
            }
            meshes.hulls.insert(mesh.place, read.clone());
        }
    }
    missing::report(scope, robot, resolver, lost);
    missing::report_unread(scope, &unread);
    report_rough_hulls(scope, robot, &meshes);
    report_hulls(scope, &wanted, &meshes);
    meshes
}

/// Tells how many meshes became their hulls, and how many those of their objects.
fn report_hulls(scope: &mut Scope, wanted: &[Wanted], meshes: &Meshes) {
    let parts = |mesh: &Wanted| meshes.hulls.get(&mesh.place)?.parts.as_deref();
    let cut = |mesh: &Wanted| mesh.shapes == Some(MeshShapes::Decomposition);
    // One that is not there has none.
    let there = |mesh: &&Wanted| meshes.hulls.contains_key(&mesh.place);
    let hulls = wanted.iter().filter(there);
    let mut hulls = hulls.filter(|m| !cut(m) && parts(m).is_none());
    if let Some(first) = hulls.next() {
        let count = 1 + hulls.count();
        let message =
            format!("collision meshes are replaced by their convex hulls ({count}, first here)");
        scope.report.note("U110", first.at.clone(), message, "");
    }
    let several: Vec<_> = wanted
        .iter()
        .filter(|m| !cut(m) && parts(m).is_some())
        .collect();
    if let Some(first) = several.first() {
        let count = several.len();
        let objects: usize = several
            .iter()
            .filter_map(|m| parts(m))
            .map(<[_]>::len)
            .sum();
        let message = format!(
            "collision meshes of several objects are the convex hulls of these ({count} of {objects} objects in all, first here)"
        );
        scope.report.note("U119", first.at.clone(), message, "");
    }
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
            if mesh.error > SILENT_ERROR * size && !known {
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

/// A mesh in its hull.
struct Enclosed {
    hull: BoundedHull,
    /// Least and greatest coordinates.
    bounds: [Vec3; 2],
    /// A hull of more corners, for a wheel.
    outline: Option<Arc<[Vec3]>>,
    /// Files that were read beside the mesh's own.
    beside: Vec<PathBuf>,
    /// Hulls of the file's objects, or why there are none although they were asked for.
    objects: Option<Result<Vec<BoundedHull>, String>>,
    /// For a mesh that is cut into parts.
    file: Option<MeshFile>,
}

/// Why a mesh has no hull.
enum Failure {
    Read(MeshError),
    Hull(GeometryError),
}

/// A file that is read ahead, and what for.
struct Job<'j> {
    path: &'j Path,
    mesh: Option<(&'j Wanted<'j, 'j>, Key)>,
    drawn: bool,
}

/// Encloses the meshes that name no other files and reads what is to be drawn, several at a time.
///
/// - `drawn`: files that are to be drawn
fn read_ahead(
    wanted: &[Wanted],
    found: &HashMap<&str, Result<Found, Missing>>,
    wheels: &HashSet<&str>,
    drawn: &BTreeSet<PathBuf>,
) -> (
    HashMap<Key, Result<Enclosed, Failure>>,
    HashMap<PathBuf, Parts>,
) {
    let mut known = HashSet::new();
    let mut open: BTreeSet<&Path> = drawn.iter().map(PathBuf::as_path).collect();
    let mut jobs = Vec::new();
    for mesh in wanted {
        let Ok(file) = &found[mesh.filename] else {
            continue;
        };
        let (path, key) = (file.path.as_path(), mesh.key(&file.path));
        if mesh::stands_alone(path) && known.insert(key.clone()) {
            jobs.push(Job {
                path,
                mesh: Some((mesh, key)),
                drawn: open.remove(path),
            });
        }
    }
    jobs.extend(open.into_iter().map(|path| Job {
        path,
        mesh: None,
        drawn: true,
    }));
    let results = parallel::map_largest_first(
        &jobs,
        |job| mesh::size(job.path),
        |job| {
            let file = MeshFile::open(job.path, &|_| None);
            let parts = job.drawn.then(|| {
                let file = file.as_ref().map_err(Clone::clone)?;
                painted::parts(file, |_| None)
            });
            let hull = job.mesh.as_ref().map(|(mesh, _)| {
                let wheel = wheels.contains(mesh.filename);
                enclosed(file, mesh, wheel)
            });
            (hull, parts)
        },
    );
    let (mut hulls, mut parts) = (HashMap::new(), HashMap::new());
    for (job, (hull, painted)) in jobs.into_iter().zip(results) {
        let key = job.mesh.map(|(_, key)| key);
        hulls.extend(key.zip(hull));
        parts.extend(painted.map(|painted| (job.path.to_owned(), painted)));
    }
    (hulls, parts)
}

fn enclosed(
    file: Result<MeshFile, MeshError>,
    mesh: &Wanted,
    wheel: bool,
) -> Result<Enclosed, Failure> {
    let read = file.and_then(|file| Ok((file.corners()?, file)));
    let (points, file) = read.map_err(Failure::Read)?;
    let points = distinct(points.iter().map(|p| p.component_mul(&mesh.factors)));
    let hull = bounded_hull(&points, MOST_CORNERS).map_err(Failure::Hull)?;
    let outline = wheel.then(|| bounded_hull(&points, MOST_OUTLINE));
    let bounds = points
        .iter()
        .fold([points[0]; 2], |[low, high], p| [low.inf(p), high.sup(p)]);
    Ok(Enclosed {
        hull,
        bounds,
        outline: outline
            .and_then(Result::ok)
            .map(|hull| hull.vertices.into()),
        beside: file.beside().to_vec(),
        objects: match mesh.shapes {
            // What may be a wheel stays whole.
            None if !wheel => objects::convex(&file, &mesh.factors).map(Ok),
            Some(MeshShapes::Objects) => Some(objects::all(&file, &mesh.factors)),
            _ => None,
        },
        file: (mesh.shapes == Some(MeshShapes::Decomposition)).then_some(file),
    })
}

/// What a collision shape is made of, or `None` after saying why there is nothing.
fn read_mesh(
    scope: &mut Scope,
    file: &Found,
    enclosed: Result<Enclosed, Failure>,
    mesh: &Wanted,
) -> Option<ReadMesh> {
    let Found { path, linked } = file;
    let at = mesh.at;
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    if *linked {
        let message = format!(
            "mesh {name} is a symbolic link out of the robot's folders: it is used, but no copy is packed"
        );
        scope.note("U113", at.clone(), &message, "");
    }
    let enclosed = match enclosed {
        Ok(enclosed) => enclosed,
        Err(Failure::Read(error)) => {
            let help = error.help();
            let code = match error {
                MeshError::NoFormat => "U106",
                _ => "U105",
            };
            let message = format!("mesh {} cannot be read: {error}", path.display());
            scope.problem(code, at.clone(), &message, help);
            return None;
        }
        Err(Failure::Hull(error)) => {
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
    let hull = enclosed.hull;
    if hull.flat {
        let message = format!("mesh {name} has no volume: it is used as it is");
        scope.warning("U109", at.clone(), &message, "");
    }
    let (mut parts, mut error) = (None, hull.error);
    if let Some(objects) = enclosed.objects {
        let list = objects.map_err(|error| {
            let message = format!("mesh {name} has no hulls of its objects: {error}");
            scope.problem("U115", at.clone(), &message, decompose::CUT_HELP);
        });
        let list = list.ok()?;
        error = list.iter().fold(0.0, |most: f64, own| most.max(own.error));
        parts = Some(list.into_iter().map(|own| own.vertices).collect());
    }
    if let Some(file) = enclosed.file.as_ref().filter(|_| !hull.flat) {
        error = 0.0;
        parts = Some(decompose::convex_parts(scope, file, &name, mesh.factors, at)?.into());
    }
    Some(ReadMesh {
        path: path.clone(),
        linked: *linked,
        beside: enclosed.beside,
        vertices: hull.vertices,
        error,
        bounds: enclosed.bounds,
        parts,
        outline: enclosed.outline,
    })
}

/// Each point once, where it first comes: an STL has a corner anew for each of its triangles.
fn distinct(points: impl ExactSizeIterator<Item = Vec3>) -> Vec<Vec3> {
    let mut known: HashSet<[u64; 3], BuildHasherDefault<Quick>> =
        HashSet::with_capacity_and_hasher(points.len() / 4, BuildHasherDefault::default());
    let bits = |p: &Vec3| [p.x, p.y, p.z].map(f64::to_bits);
    points.filter(|p| known.insert(bits(p))).collect()
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
