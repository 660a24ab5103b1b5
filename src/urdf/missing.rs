//! Findings about mesh files that are missing, one for each package, and about those of other
//! formats.

use super::checked::{CheckedRobot, Geometry};
use super::habits;
use super::mesh;
use super::nearby;
use super::resolve::{Missing, Moved, NotFound, Resolver};
use super::scope::Scope;
use crate::diagnostic::words::shell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A collision mesh that is missing.
pub(super) struct Lost<'d> {
    /// `link 'arm'`.
    pub(super) owner: String,
    pub(super) filename: &'d str,
    pub(super) at: Range<usize>,
}

/// A collision mesh of a format that is not read.
pub(super) struct Unread {
    /// `link 'arm'`.
    pub(super) owner: String,
    /// Which format it is.
    pub(super) message: String,
    pub(super) path: PathBuf,
    pub(super) at: Range<usize>,
}

/// What helps where the same mesh lies beside one of a format that is not read.
pub(super) fn twin(path: &Path) -> Option<String> {
    let kinds = ["stl", "obj", "dae", "STL", "OBJ", "DAE"];
    let files = kinds.map(|kind| path.with_extension(kind));
    let twin = files.into_iter().find(|file| file.is_file())?;
    Some(format!("{} lies beside it: name that one", twin.display()))
}

/// One error for all meshes of one format that is not read.
pub(super) fn report_unread(scope: &mut Scope, unread: &[Unread]) {
    let mut groups: BTreeMap<&str, Vec<&Unread>> = BTreeMap::new();
    for mesh in unread {
        groups.entry(&mesh.message).or_default().push(mesh);
    }
    for list in groups.into_values() {
        let twins: Vec<String> = list.iter().filter_map(|mesh| twin(&mesh.path)).collect();
        let [first, others @ ..] = &list[..] else {
            continue;
        };
        scope.owner.clone_from(&first.owner);
        let more = match others.len() {
            0 => String::new(),
            n => format!(", nor {n} more"),
        };
        let path = first.path.display();
        let message = format!("mesh {path} cannot be read{more}: {}", first.message);
        let help = match (&twins[..], list.len() - twins.len()) {
            ([], _) => {
                let kind = mesh::unread_kind(&first.path.to_string_lossy());
                habits::mesh(&kind.unwrap_or_default()).to_owned()
            }
            ([twin], 0) => twin.clone(),
            ([twin, ..], 0) => format!("{twin}, and so for the others"),
            ([twin, rest @ ..], n) => format!(
                "{twin}, and so for {} more; convert the other {n} to STL or OBJ",
                rest.len()
            ),
        };
        scope.problem("U106", first.at.clone(), &message, help);
    }
}

/// The package that a file name asks for, or nothing.
fn package(filename: &str) -> &str {
    let rest = ["package://", "model://"]
        .iter()
        .find_map(|scheme| filename.trim().strip_prefix(scheme));
    rest.and_then(|rest| rest.split('/').next())
        .unwrap_or_default()
}

/// One error for each package whose meshes are missing, and for all paths together.
pub(super) fn report(
    scope: &mut Scope,
    robot: &CheckedRobot,
    resolver: &Resolver,
    lost: Vec<Lost>,
) {
    let mut groups: Vec<(&str, Vec<(Lost, Missing)>)> = Vec::new();
    for lost in lost {
        let Err(missing) = resolver.find(lost.filename) else {
            continue;
        };
        // What is no file stands alone; what lies outside is one thing to do.
        let package = match missing {
            Missing::Outside(_) => "",
            _ => package(lost.filename),
        };
        let grouped = !matches!(missing, Missing::NoFile(..));
        let kind = std::mem::discriminant(&missing);
        let group = groups.iter_mut().find(|(name, list)| {
            let alike = |(_, other): &(Lost, Missing)| std::mem::discriminant(other) == kind;
            grouped && *name == package && list.iter().all(alike)
        });
        match group {
            Some((_, list)) => list.push((lost, missing)),
            None => groups.push((package, vec![(lost, missing)])),
        }
    }
    for (package, list) in groups {
        let Some((first, missing)) = list.first() else {
            continue;
        };
        scope.owner.clone_from(&first.owner);
        let filename = first.filename;
        let missing = match missing {
            Missing::NotFound(missing) => missing,
            Missing::Outside(path) => {
                let more = match list.len() {
                    1 => String::new(),
                    n => format!(", and {} more", n - 1),
                };
                let message = format!("mesh outside of the robot's folders: {filename}{more}");
                let help = outside_help(path, robot, resolver);
                scope.problem("U112", first.at.clone(), &message, help);
                continue;
            }
            Missing::NoFile(path, what) => {
                let message = format!("mesh {filename} is {what}, not a file");
                let help = format!("{} is {what}: name the mesh file", path.display());
                scope.problem("U104", first.at.clone(), &message, help);
                continue;
            }
        };
        let mut names: Vec<&str> = Vec::new();
        for (lost, _) in &list {
            if !names.contains(&lost.filename) {
                names.push(lost.filename);
            }
        }
        let mut message = format!("mesh not found: {filename}");
        let mut help = of_first(missing, &list);
        if names.len() > 1 {
            let of = if package.is_empty() {
                String::new()
            } else {
                format!(" of package '{package}'")
            };
            message = format!("{message}, and {} more{of}", names.len() - 1);
            let lines: Vec<String> = list[1..]
                .iter()
                .map(|(lost, _)| scope.report.line(lost.at.start).to_string())
                .take(20)
                .collect();
            let more = if list.len() - 1 > lines.len() {
                " …"
            } else {
                ""
            };
            if let Some(folder) = moved_together(resolver, &names) {
                help = format!(
                    "{help}\nall {} are in {folder}: write this folder in their lines, or copy the files to \
                     where they are looked for",
                    names.len()
                );
            }
            let s = if list.len() == 2 { "" } else { "s" };
            help = format!(
                "{help}\nthe others are in line{s} {}{more}",
                lines.join(", ")
            );
        }
        let help = with_ways(help, resolver, package, &names);
        scope.problem("U104", first.at.clone(), &message, help);
    }
}

/// What helps with the first of some meshes, with the folder that holds all if they are outside.
fn of_first(missing: &NotFound, list: &[(Lost, Missing)]) -> String {
    let folders = list.iter().filter_map(|(_, missing)| match missing {
        Missing::NotFound(missing) => missing.outside.clone(),
        _ => None,
    });
    match &missing.outside {
        Some(own) => missing.help_with(Some(&common(folders).unwrap_or_else(|| own.clone()))),
        None => missing.help(),
    }
}

/// The help on meshes that are missing, with what else there is to do: another format, where they
/// belong, and the option that finds them.
fn with_ways(mut help: String, resolver: &Resolver, package: &str, names: &[&str]) -> String {
    // Who finds the file would be told next that it cannot be read.
    let unread = names.iter().find_map(|name| mesh::unread_kind(name));
    if let Some(kind) = unread {
        help = format!("{help}\n{}", habits::ending(&kind));
    }
    if let Some((place, count)) = beside_moved(resolver, package, names) {
        let are = if count == 1 {
            "other one of its package is"
        } else {
            "others of its package are"
        };
        let shown = place.display();
        help = format!("put it at {shown}, where {count} {are} found\n{help}");
    }
    if let Some((option, count)) = resolver.advice(names) {
        let all = if count == names.len() && count == 1 {
            "it".to_owned()
        } else if count == names.len() {
            "all of them".to_owned()
        } else {
            format!("{count} of {}", names.len())
        };
        help = format!("{option} finds {all}\n{help}");
    }
    help
}

/// Where the first of some files of a package belongs, which are nowhere, while others of it are
/// found below one folder that has another name, and how many these are. In a folder of the
/// package's own name it would hide them.
fn beside_moved(resolver: &Resolver, package: &str, names: &[&str]) -> Option<(PathBuf, usize)> {
    let filename = names.first().filter(|_| !package.is_empty())?;
    let inside = |name: &str| {
        let (_, rest) = name.split_once("://")?;
        let rest = rest.trim_start_matches('/').strip_prefix(package)?;
        Some(rest.strip_prefix('/')?.to_owned())
    };
    let moved = resolver.moved_files();
    let homes = moved.iter().filter_map(|(name, moved)| {
        let home = nearby::package_of(&moved.path, &inside(name)?);
        (!moved.other_case).then_some(home)
    });
    let homes: Vec<Option<PathBuf>> = homes.collect();
    let home = homes.first()?.as_ref()?;
    let alike = homes.iter().all(|other| other.as_ref() == Some(home));
    let name = inside(&filename.trim().replace('\\', "/"))?;
    alike.then(|| (home.join(name), homes.len()))
}

/// The one folder in which the only files lie that are called as these.
fn moved_together(resolver: &Resolver, names: &[&str]) -> Option<String> {
    let folder = |name: &&str| {
        let file = resolver.same_name(&name.trim().replace('\\', "/"), None)?;
        Some(file.parent()?.to_owned())
    };
    let folders: Option<Vec<PathBuf>> = names.iter().map(folder).collect();
    let folders = folders?;
    let first = folders.first()?;
    let together = folders.iter().all(|other| other == first);
    together.then(|| first.display().to_string())
}

/// A file name, where it stands, and the file that is used.
type Place<'d> = (&'d str, &'d Range<usize>, &'d Moved);

/// Warns of meshes that were found at another place of the robot's folders than their names say, or
/// in other case, once for each package; and of packages that are twice in the workspace.
pub(super) fn report_moved(scope: &mut Scope, robot: &CheckedRobot, resolver: &Resolver) {
    let moved = resolver.moved_files();
    let mut places: Vec<Place> = Vec::new();
    let mut packages: BTreeMap<&str, &Range<usize>> = BTreeMap::new();
    for link in &robot.links {
        let collisions = link.collisions.iter().map(|collision| &collision.geometry);
        let visuals = link.visuals.iter().map(|visual| &visual.geometry);
        for geometry in collisions.chain(visuals) {
            let Geometry::Mesh { filename, at, .. } = geometry else {
                continue;
            };
            packages.entry(package(filename)).or_insert(at);
            let known = places.iter().any(|(name, ..)| name == filename);
            if let (false, Some(file)) = (known, moved.get(&filename.trim().replace('\\', "/"))) {
                places.push((*filename, at, file));
            }
        }
    }
    for (package, at) in packages {
        if let Some(remark) = resolver.remark(package) {
            let (at, message) = ((*at).clone(), remark.message);
            scope
                .report
                .add(remark.severity, "U118", at, message, remark.help);
        }
    }
    let mut groups: BTreeMap<(&str, bool), Vec<Place>> = BTreeMap::new();
    for place in places {
        let kind = (package(place.0), place.2.other_case);
        groups.entry(kind).or_default().push(place);
    }
    for ((package, other_case), list) in groups {
        let Some((name, at, file)) = list.first() else {
            continue;
        };
        let others = match list.len() {
            1 => String::new(),
            n => format!(", and {} more likewise", n - 1),
        };
        let why = if other_case {
            "which differs in upper and lower case"
        } else {
            "whose name ends alike"
        };
        let message = format!(
            "there is no {name}; {} is used, {why}{others}",
            file.path.display()
        );
        let help = if other_case {
            "correct the name in the file: the two are different files on Linux".to_owned()
        } else if package.is_empty() {
            "correct the path in the file, or pass --package-path DIR for where it counts from"
                .to_owned()
        } else {
            format!("pass --package {package}=DIR to say where the package is")
        };
        scope.report.warning("U118", (*at).clone(), message, help);
    }
}

/// The folder that holds all of some folders, if it belongs to somebody.
fn common(folders: impl Iterator<Item = PathBuf>) -> Option<PathBuf> {
    /// Not the folders of all users, nor the system's.
    const LEAST_DEPTH: usize = 3;
    let common = |a: PathBuf, b: PathBuf| {
        let above = a.ancestors().find(|above| b.starts_with(above));
        above.unwrap_or(Path::new("")).to_owned()
    };
    folders.reduce(common).filter(|folder| {
        let absolute = std::path::absolute(folder).unwrap_or_default();
        absolute.components().count() > LEAST_DEPTH
    })
}

/// What to do about a file outside of the robot's folders: one folder for all meshes that are.
pub(super) fn outside_help(path: &Path, robot: &CheckedRobot, resolver: &Resolver) -> String {
    let nodes = robot.links.iter().map(|link| link.node);
    let shapes = nodes.flat_map(|link| {
        let collisions = link.children_named("collision");
        collisions.chain(link.children_named("visual"))
    });
    let names =
        shapes.filter_map(|shape| shape.child("geometry")?.child("mesh")?.value("filename"));
    let folders = names.filter_map(|name| match resolver.find(name) {
        Err(Missing::Outside(path)) => Some(path.parent()?.to_owned()),
        _ => None,
    });
    let folder = common(folders).filter(|folder| folder.is_dir());
    let leaf = || path.parent().unwrap_or(path).to_owned();
    format!(
        "an FMU takes no other files of this machine; if it belongs to the robot, pass --package-path {}",
        shell(&folder.unwrap_or_else(leaf).display().to_string())
    )
}
