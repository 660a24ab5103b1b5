//! `<visual>` and `<material>`: their checks, and the meshes and textures that they name.
//!
//! Visuals do not move the robot: every fault in them is a warning, and a visual that cannot be
//! read is left out. A mesh or texture is read once, however often it stands in the file.

use super::checked::{CheckedRobot, CheckedVisual, Geometry, Paint};
use super::description::{DrawnMesh, MeshPart, Texture};
use super::faces::{Image, MeshError};
use super::image::{self, ImageError};
use super::mesh::{self, MeshFile};
use super::missing::{self, outside_help};
use super::resolve::{Found, Missing, Resolver};
use super::scope::Scope;
use super::xml::Node;
use super::{file, link, painted};
use crate::diagnostic::Severity;
use crate::diagnostic::words::did_you_mean;
use crate::parallel;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Checks the visuals of all links, with the materials that they name.
pub(super) fn check<'d>(scope: &mut Scope, root: Node<'d>, robot: &mut CheckedRobot<'d>) {
    scope.severity = Severity::Warning;
    "robot".clone_into(&mut scope.owner);
    let mut palette = HashMap::new();
    let (mut undefined, mut told) = (BTreeSet::new(), BTreeSet::new());
    // The robot's own materials come first, then those that visuals give a name.
    for material in root.children_named("material") {
        if let Some(other) = add_material(scope, material, &mut palette) {
            let message = format!("a second material '{other}' looks otherwise: it is not used");
            let help = "give it another name";
            scope.warning("U073", material.tag_at(), &message, help);
        }
    }
    for link in &robot.links {
        scope.owner = format!("link '{}'", link.name);
        for visual in link.node.children_named("visual") {
            for material in visual.children_named("material") {
                if let Some(other) = add_material(scope, material, &mut palette)
                    && told.insert(other)
                {
                    let message = format!(
                        "another material '{other}' looks otherwise: this visual has its own, and \
                         those that only name it have the first"
                    );
                    let help = "give each look a name of its own";
                    scope.note("U073", material.tag_at(), &message, help);
                }
            }
        }
    }
    for link in &mut robot.links {
        scope.owner = format!("link '{}'", link.name);
        for visual in link.node.children_named("visual") {
            scope.known_attributes(visual, &["name"]);
            scope.known_children(visual, &["origin", "geometry", "material"], &["meshScale"]);
            let (xyz, rpy) = scope.origin(visual);
            let line = scope.report.line(visual.tag_at().start);
            let material = visual.child("material");
            let paint = material.and_then(|material| {
                let own = palette.get(&Name::Place(material.tag_at().start));
                own.or_else(|| palette.get(&Name::Given(material.value("name")?)))
            });
            let paint = paint.copied().unwrap_or_default();
            if let Some(name) = material.and_then(|material| material.value("name"))
                && !name.is_empty()
                && !palette.contains_key(&Name::Given(name))
                && material.is_some_and(|material| material.children().next().is_none())
                && undefined.insert(name)
            {
                let at = material.map_or_else(|| visual.tag_at(), Node::tag_at);
                let message = format!("material '{name}' is defined nowhere: it gives no colour");
                let known = palette.keys().filter_map(|key| match key {
                    Name::Given(name) => Some(*name),
                    Name::Place(_) => None,
                });
                let known: BTreeSet<&str> = known.collect();
                let help = match did_you_mean(name, known) {
                    help if help.is_empty() => "give it a <color rgba=\"…\"/>".to_owned(),
                    help => help,
                };
                scope.note("U073", at, &message, help);
            }
            for geometry in link::geometries(scope, visual) {
                let known = &link.visuals;
                let same = |v: &CheckedVisual| v.xyz == xyz && v.rpy == rpy;
                let twice = |v: &CheckedVisual| same(v) && v.geometry.same_as(&geometry);
                if known.iter().any(twice) {
                    let message = "a <visual> stands twice";
                    scope.note("U018", visual.tag_at(), message, "remove one of them");
                }
                link.visuals.push(CheckedVisual {
                    xyz,
                    rpy,
                    geometry,
                    paint,
                    line,
                });
            }
        }
    }
    scope.severity = Severity::Error;
}

/// What a material is found by.
#[derive(PartialEq, Eq, Hash)]
enum Name<'d> {
    Given(&'d str),
    /// Of its tag in the file.
    Place(usize),
}

/// Adds a material that has a colour or a texture, by its place, and by its name if that is new;
/// gives its name if that is one of a material that looks otherwise.
fn add_material<'d>(
    scope: &mut Scope,
    material: Node<'d>,
    palette: &mut HashMap<Name<'d>, Paint<'d>>,
) -> Option<&'d str> {
    scope.known_children(material, &["color", "texture"], &["specular"]);
    for (part, attribute) in [("color", "rgba"), ("texture", "filename")] {
        for part in material.children_named(part) {
            scope.leaf(part, &[attribute]);
        }
    }
    let color = material.child("color").and_then(|color| rgba(scope, color));
    let texture = material.child("texture").and_then(|texture| {
        let file = texture.attribute("filename")?;
        Some((file.value.as_str(), file))
    });
    if color.is_none() && texture.is_none() {
        return None;
    }
    let paint = Paint { color, texture };
    palette.insert(Name::Place(material.tag_at().start), paint);
    let name = material.value("name").filter(|name| !name.is_empty())?;
    let first = palette.entry(Name::Given(name)).or_insert(paint);
    (!first.looks_like(&paint)).then_some(name)
}

fn rgba(scope: &mut Scope, color: Node) -> Option<[f64; 4]> {
    let rgba = scope.vector::<4>(color, "rgba")?;
    if rgba.iter().all(|x| (0.0..=1.0).contains(x)) {
        return Some(rgba);
    }
    let at = color
        .attribute("rgba")
        .map_or_else(|| color.tag_at(), |a| a.at.clone());
    let help = "red, green, blue and alpha are 0 … 1";
    scope.warning("U073", at, "a colour is outside of 0 … 1", help);
    // Bytes in place of parts of 1 are the usual reason.
    let byte = rgba.iter().any(|&x| x > 1.0) && rgba.iter().all(|x| x.fract() == 0.0);
    let full = if byte && rgba[..3].iter().any(|&x| x > 2.0) {
        255.0
    } else {
        1.0
    };
    let [red, green, blue] = [0, 1, 2].map(|i| (rgba[i] / full).clamp(0.0, 1.0));
    let alpha = if rgba[3] > 1.0 {
        rgba[3] / full
    } else {
        rgba[3]
    };
    Some([red, green, blue, alpha.clamp(0.0, 1.0)])
}

/// Meshes and textures of the visuals.
#[derive(Default)]
pub(super) struct Drawn {
    pub(super) meshes: Vec<DrawnMesh>,
    pub(super) textures: Vec<Texture>,
    /// Place in `meshes` by the file's name in the URDF; none for one that cannot be had.
    pub(super) mesh_of: HashMap<String, Option<usize>>,
    /// Place in `textures`, likewise.
    pub(super) texture_of: HashMap<String, Option<usize>>,
}

/// What went wrong, each kind told once with the place of the first.
#[derive(Default)]
struct Troubles {
    list: Vec<Trouble>,
}

struct Trouble {
    code: &'static str,
    at: Range<usize>,
    message: String,
    help: String,
    count: usize,
}

impl Troubles {
    fn add(&mut self, code: &'static str, at: &Range<usize>, message: String, help: String) {
        match self.list.iter_mut().find(|trouble| trouble.code == code) {
            Some(trouble) => trouble.count += 1,
            None => self.list.push(Trouble {
                code,
                at: at.clone(),
                message,
                help,
                count: 1,
            }),
        }
    }

    fn report(self, scope: &mut Scope) {
        for trouble in self.list {
            let more = match trouble.count {
                1 => String::new(),
                n => format!(", and {} more", n - 1),
            };
            let end = match trouble.code {
                "U117" => "it is drawn without",
                _ => "the robot moves without it",
            };
            let message = format!("{}{more}; {end}", trouble.message);
            scope
                .report
                .warning(trouble.code, trouble.at, message, trouble.help);
        }
    }
}

/// Finds the meshes and textures of all visuals, and reads them if `read`.
///
/// - `known`: what has been read of their files
pub(super) fn read(
    scope: &mut Scope,
    robot: &CheckedRobot,
    resolver: &Resolver,
    read: bool,
    mut known: HashMap<PathBuf, Parts>,
) -> Drawn {
    let mut drawn = Drawn::default();
    let mut troubles = Troubles::default();
    // Names may mean the same file.
    let mut meshes_by_path: HashMap<PathBuf, Option<usize>> = HashMap::new();
    let mut textures = Textures {
        resolver,
        by_path: HashMap::new(),
        list: Vec::new(),
    };
    let visuals = || robot.links.iter().flat_map(|link| &link.visuals);
    let mut files: HashMap<&str, Result<Found, Missing>> = HashMap::new();
    for visual in visuals() {
        if let Geometry::Mesh { filename, .. } = &visual.geometry {
            let file = files.entry(*filename);
            file.or_insert_with(|| resolver.find(filename));
        }
    }
    if read {
        read_ahead(files.values().flatten(), &mut known);
    }
    for visual in visuals() {
        if let Geometry::Mesh { filename, at, .. } = &visual.geometry
            && !drawn.mesh_of.contains_key(*filename)
            && let Some(file) = files.remove(*filename)
        {
            let place = match file {
                Ok(found) => *meshes_by_path.entry(found.path).or_insert_with_key(|path| {
                    let parts = if read {
                        let ahead = known.remove(path);
                        parts_of(path, ahead, at, &mut textures, &mut troubles)?
                    } else {
                        Vec::new()
                    };
                    drawn.meshes.push(DrawnMesh {
                        path: path.clone(),
                        parts,
                    });
                    Some(drawn.meshes.len() - 1)
                }),
                Err(missing) => {
                    let what = match missing {
                        Missing::Outside(_) => "outside of the robot's folders",
                        Missing::NotFound(_) | Missing::NoFile(..) => "not found",
                    };
                    let message = format!("visual mesh {what}: {filename}");
                    troubles.add("U111", at, message, help_for(&missing, robot, resolver));
                    None
                }
            };
            drawn.mesh_of.insert((*filename).to_owned(), place);
        }
        if let Some((name, attribute)) = visual.paint.texture
            && !drawn.texture_of.contains_key(name)
        {
            let place = match resolver.find(name) {
                Ok(_) if !read => None,
                Ok(found) if found.linked => None,
                Ok(found) => textures.read(&found.path, &attribute.at, &mut troubles),
                Err(missing) => {
                    let message = format!("texture not found: {name}");
                    troubles.add(
                        "U117",
                        &attribute.at,
                        message,
                        help_for(&missing, robot, resolver),
                    );
                    None
                }
            };
            drawn.texture_of.insert(name.to_owned(), place);
        }
    }
    drawn.textures = textures.list;
    troubles.report(scope);
    drawn
}

fn help_for(missing: &Missing, robot: &CheckedRobot, resolver: &Resolver) -> String {
    match missing {
        Missing::NotFound(missing) => missing.help(),
        Missing::Outside(path) => outside_help(path, robot, resolver),
        Missing::NoFile(path, what) => format!("{} is {what}", path.display()),
    }
}

/// Textures read so far.
struct Textures<'r> {
    resolver: &'r Resolver<'r>,
    by_path: HashMap<PathBuf, Option<usize>>,
    list: Vec<Texture>,
}

impl Textures<'_> {
    fn read(&mut self, path: &Path, at: &Range<usize>, troubles: &mut Troubles) -> Option<usize> {
        if let Some(&known) = self.by_path.get(path) {
            return known;
        }
        let name = format!("texture {}", path.display());
        let place = self.add(image::texture(path), &name, at, troubles);
        self.by_path.insert(path.to_owned(), place);
        place
    }

    /// - `name`: what a finding calls it
    fn add(
        &mut self,
        texture: Result<Texture, ImageError>,
        name: &str,
        at: &Range<usize>,
        troubles: &mut Troubles,
    ) -> Option<usize> {
        match texture {
            Ok(texture) => {
                // Each part of a robot may hold the same image.
                let same = |known: &Texture| known.bytes == texture.bytes;
                let known = self.list.iter().position(same);
                Some(known.unwrap_or_else(|| {
                    self.list.push(texture);
                    self.list.len() - 1
                }))
            }
            Err(error) => {
                let message = format!("{name} cannot be used: {error}");
                let help = "save it as JPEG or PNG of at most 8192 pixels a side";
                troubles.add("U117", at, message, help.to_owned());
                None
            }
        }
    }

    /// A texture of a mesh file, inside of it or beside it.
    fn of_mesh(
        &mut self,
        mesh: &Path,
        image: &Image,
        at: &Range<usize>,
        troubles: &mut Troubles,
    ) -> Option<usize> {
        let name = match image {
            Image::Named(name) => name,
            Image::Held(bytes) => {
                let name = format!("a texture inside of {}", mesh.display());
                return self.add(image::texture_of(mesh, bytes.to_vec()), &name, at, troubles);
            }
        };
        if let Some(path) = self.resolver.beside(mesh, name) {
            return self.read(&path, at, troubles);
        }
        let message = format!("texture not found: {name}, of mesh {}", mesh.display());
        let help = "it must lie in the robot's folders, as the mesh says";
        troubles.add("U117", at, message, help.to_owned());
        None
    }
}

/// What a mesh file holds, or why it cannot be read.
pub(super) type Parts = Result<Vec<painted::Part>, MeshError>;

/// Whether a mesh names no materials in other files.
fn alone(path: &Path) -> bool {
    // Materials of OBJ stand in other files.
    let kind = path.extension();
    let obj = kind.is_some_and(|kind| kind.eq_ignore_ascii_case("obj"));
    mesh::stands_alone(path) && !obj
}

/// Files of the meshes of visuals that have not been checked yet, and that name no other files.
pub(super) fn likely_files(robot: &CheckedRobot, resolver: &Resolver) -> BTreeSet<PathBuf> {
    let visuals = robot.links.iter();
    let names: BTreeSet<&str> = visuals
        .flat_map(|link| link.node.children_named("visual"))
        .flat_map(|visual| visual.children_named("geometry"))
        .flat_map(|geometry| geometry.children_named("mesh"))
        .filter_map(|mesh| mesh.value("filename"))
        .collect();
    let files = names
        .into_iter()
        .filter_map(|name| resolver.find(name).ok());
    let paths = files.map(|file| file.path);
    paths.filter(|path| alone(path)).collect()
}

/// Reads the meshes that name no materials in other files, several at a time, but for those that
/// are known.
fn read_ahead<'f>(files: impl Iterator<Item = &'f Found>, known: &mut HashMap<PathBuf, Parts>) {
    let paths = files.map(|file| &file.path);
    let paths: BTreeSet<&PathBuf> = paths
        .filter(|path| alone(path) && !known.contains_key(*path))
        .collect();
    let paths: Vec<&PathBuf> = paths.into_iter().collect();
    let size = |path: &&PathBuf| mesh::size(path);
    let parts = parallel::map_largest_first(&paths, size, |path| {
        MeshFile::open(path, &|_| None).and_then(|mesh| painted::parts(&mesh, |_| None))
    });
    known.extend(paths.into_iter().cloned().zip(parts));
}

/// The painted triangles of a mesh file, or `None` after saying why there are none.
///
/// - `ahead`: what has been read of it
fn parts_of(
    path: &Path,
    ahead: Option<Parts>,
    at: &Range<usize>,
    textures: &mut Textures,
    troubles: &mut Troubles,
) -> Option<Vec<MeshPart>> {
    let library = |name: &str| {
        let path = textures.resolver.beside(path, name)?;
        file::lossy_text(&path)
    };
    let read = || {
        let mesh = MeshFile::open(path, &|name| textures.resolver.beside(path, name))?;
        painted::parts(&mesh, library)
    };
    let parts = match ahead.unwrap_or_else(read) {
        Ok(parts) => parts,
        Err(error) => {
            let help = match error {
                MeshError::Format(_) => {
                    let twin = missing::twin(path);
                    twin.unwrap_or_else(|| "convert the mesh to one of these formats".to_owned())
                }
                _ => error.help(),
            };
            let message = format!("visual mesh {} cannot be read: {error}", path.display());
            troubles.add("U116", at, message, help);
            return None;
        }
    };
    let mut list = Vec::with_capacity(parts.len());
    for part in parts {
        let image = part.paint.image.as_ref();
        let texture = image.and_then(|image| textures.of_mesh(path, image, at, troubles));
        list.push(MeshPart {
            corners: part.corners,
            triangles: part.triangles,
            uv: part.uv,
            color: part.paint.color,
            // Without its image a part keeps no more than its plain colour.
            tint: part.paint.tint.filter(|_| texture.is_some()),
            texture,
        });
    }
    Some(list)
}
