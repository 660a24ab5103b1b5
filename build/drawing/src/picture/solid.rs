//! Shapes of a scene → triangles with normals.
//!
//! Edges of boxes and cylinders are bevelled by a little, so that they reflect light as edges of
//! real parts do. Faces of a mesh that meet at a flat angle share their normal, which is computed
//! only for faces that are seen: of many meshes most are not.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::camera::count;
use super::texture::{ALL_PIXELS, Image};
use crate::image::linear;
use crate::scene::{Drawn, End, Scene, Shape, Triangles, between, pose};
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::ops::Range;
use urdf2fmu_core::hash::Quick;
use urdf2fmu_core::parallel;
use urdf2fmu_core::spatial::{Pose, Vec3};

/// Bevel of an edge, as a part of the shortest side.
const BEVEL: f64 = 0.05;

/// Sides of a circle.
const SIDES: usize = 64;

/// What is drawn, and not yet where.
pub(super) struct Stage {
    pub(super) surfaces: Vec<Surface>,
    pub(super) images: Vec<Option<Image>>,
    /// One for each surface: where it is, and its triangles.
    shapes: Vec<(Place, Solid)>,
}

/// Where a shape is.
enum Place {
    /// On a link, with a pose there.
    Link(usize, Pose),
    /// Between two points, and stretched to their distance.
    Between([End; 2]),
}

impl Place {
    /// Its pose where the links have these, and the corners of the shape there.
    fn put<'s>(&self, solid: &'s Solid, poses: &[Pose]) -> (Pose, impl Iterator<Item = Vec3> + 's) {
        let (X_WG, stretch) = match self {
            Self::Link(link, X_LG) => (poses[*link].compose(X_LG), 1.0),
            Self::Between(ends) => between(ends, poses),
        };
        let positions = solid.positions.iter();
        let corners = positions.map(move |p| X_WG.point(&Vec3::new(p.x, p.y, p.z * stretch)));
        (X_WG, corners)
    }
}

/// What triangles look like.
pub(super) struct Surface {
    /// Red, green, blue, linear.
    pub(super) color: [f32; 3],
    pub(super) alpha: f32,
    /// In [`Stage::images`].
    pub(super) image: Option<usize>,
}

impl Surface {
    fn new([red, green, blue, alpha]: [f64; 4], image: Option<usize>) -> Self {
        Self {
            color: [red, green, blue].map(|x| linear(soft(x))),
            #[allow(clippy::cast_possible_truncation, reason = "0 … 1")]
            alpha: alpha as f32,
            image,
        }
    }
}

/// Triangles in a shape's frame.
#[derive(Default)]
pub(super) struct Solid {
    /// Corners, each of which some triangle has.
    pub(super) positions: Vec<Vec3>,
    /// Places in `positions`.
    pub(super) faces: Vec<[u32; 3]>,
    normals: Normals,
}

/// Normals at the corners of triangles.
enum Normals {
    /// Those of each position.
    Own(Vec<Vec3>),
    /// Those of a mesh.
    Mesh(Mesh),
}

impl Default for Normals {
    fn default() -> Self {
        Self::Own(Vec::new())
    }
}

/// A triangle that is seen, in the world.
pub(super) struct Triangle {
    pub(super) corners: [Vec3; 3],
    pub(super) normals: [Vec3; 3],
    pub(super) uv: [[f64; 2]; 3],
    /// The middle of the normals, a unit vector.
    pub(super) facing: Vec3,
    /// In [`Stage::surfaces`].
    pub(super) surface: usize,
}

impl Stage {
    pub(super) fn new(scene: &Scene) -> Self {
        let most = ALL_PIXELS / scene.head.textures.len().max(1);
        let images = parallel::map_largest_first(
            &scene.head.textures,
            |texture| texture.bytes,
            |texture| Image::read(&texture.kind, scene.image(texture)?, most),
        );
        let triangles = |drawn: &Drawn| match drawn.shape {
            Shape::Mesh(mesh) => scene.head.meshes[mesh].triangles,
            _ => 0,
        };
        let solids = parallel::map_largest_first(scene.shown(), triangles, |drawn| {
            solid(scene, &drawn.shape, drawn.scale)
        });
        let mut stage = Self {
            surfaces: Vec::new(),
            images,
            shapes: Vec::new(),
        };
        for (drawn, solid) in scene.shown().iter().zip(solids) {
            let image = drawn.texture.filter(|&t| stage.images[t].is_some());
            stage.surfaces.push(Surface::new(drawn.color, image));
            let X_LG = pose(&drawn.position, &drawn.orientation);
            let place = Place::Link(drawn.link, X_LG);
            stage.shapes.push((place, solid));
        }
        for tie in &scene.head.ties {
            stage.surfaces.push(Surface::new(tie.color, None));
            let solid = solid(scene, &tie.shape, tie.scale);
            stage.shapes.push((Place::Between(tie.ends), solid));
        }
        stage
    }

    /// All corners of what can be seen.
    pub(super) fn corners<'s>(&'s self, poses: &'s [Pose]) -> impl Iterator<Item = Vec3> + 's {
        let seen = self.shapes.iter().zip(&self.surfaces);
        let seen = seen.filter(|(_, surface)| surface.alpha > 0.0);
        seen.flat_map(|((place, solid), _)| place.put(solid, poses).1)
    }
}

/// A stage whose links are at given poses.
pub(super) struct World<'s> {
    pub(super) stage: &'s Stage,
    /// Corners of all triangles.
    pub(super) positions: Vec<Vec3>,
    /// All triangles, one surface after the other: places in `positions`.
    pub(super) faces: Vec<[u32; 3]>,
    /// Poses of the shapes, and which of `faces` are theirs.
    shapes: Vec<(Pose, Range<usize>)>,
}

impl<'s> World<'s> {
    pub(super) fn new(stage: &'s Stage, poses: &[Pose]) -> Self {
        let solids = || stage.shapes.iter().map(|(_, solid)| solid);
        let mut world = Self {
            stage,
            positions: Vec::with_capacity(solids().map(|solid| solid.positions.len()).sum()),
            faces: Vec::with_capacity(solids().map(|solid| solid.faces.len()).sum()),
            shapes: Vec::with_capacity(stage.shapes.len()),
        };
        for (at, solid) in &stage.shapes {
            let (base, first) = (place(world.positions.len()), world.faces.len());
            let (X_WG, corners) = at.put(solid, poses);
            world.positions.extend(corners);
            let faces = solid.faces.iter().map(|face| face.map(|i| base + i));
            world.faces.extend(faces);
            world.shapes.push((X_WG, first..world.faces.len()));
        }
        world
    }

    /// The surfaces, and which of [`World::faces`] they have.
    pub(super) fn surfaces(&self) -> impl Iterator<Item = (&Surface, Range<usize>)> {
        let faces = self.shapes.iter().map(|(_, faces)| faces.clone());
        self.stage.surfaces.iter().zip(faces)
    }

    /// One of [`World::faces`].
    pub(super) fn triangle(&self, face: usize) -> Triangle {
        let surface = self.shapes.partition_point(|(_, faces)| faces.end <= face);
        let (X_WG, faces) = &self.shapes[surface];
        let (normals, uv) = self.stage.shapes[surface].1.corners(face - faces.start);
        let middle = normals[0] + normals[1] + normals[2];
        let facing = middle.try_normalize(0.0).unwrap_or_else(Vec3::z);
        Triangle {
            corners: self.faces[face].map(|i| self.positions[i as usize]),
            normals: normals.map(|n| X_WG.R * n),
            uv,
            facing: X_WG.R * facing,
            surface,
        }
    }
}

/// A place in a list that has far fewer entries than a u32 can count.
pub(super) fn place(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}

impl Solid {
    /// - `positions`: corners, each of which some face has
    pub(super) fn of_mesh(positions: Vec<Vec3>, faces: Vec<[u32; 3]>, mesh: Mesh) -> Self {
        Self {
            positions,
            faces,
            normals: Normals::Mesh(mesh),
        }
    }

    /// Adds a triangle that has an area.
    fn push(&mut self, corners: [(Vec3, Vec3); 3]) {
        let positions = corners.map(|c| c.0);
        let Normals::Own(normals) = &mut self.normals else {
            return;
        };
        if area(&positions).norm() > 0.0 {
            let first = place(self.positions.len());
            self.positions.extend(positions);
            normals.extend(corners.map(|c| c.1));
            self.faces.push([first, first + 1, first + 2]);
        }
    }

    /// Normals and texture coordinates at the corners of a face.
    fn corners(&self, face: usize) -> ([Vec3; 3], [[f64; 2]; 3]) {
        match &self.normals {
            Normals::Own(normals) => {
                let normals = self.faces[face].map(|i| normals[i as usize]);
                (normals, [[0.0; 2]; 3])
            }
            Normals::Mesh(mesh) => (mesh.normals(self, face), mesh.uv(&self.faces[face])),
        }
    }
}

/// URDF colours are plain numbers; pure black and white leave no room for light and shadow.
fn soft(x: f64) -> f64 {
    0.045 + 0.855 * x
}

fn solid(scene: &Scene, shape: &Shape, scale: Option<[f64; 3]>) -> Solid {
    match *shape {
        Shape::Box(sides) => cuboid(&Vec3::from(sides)),
        Shape::Sphere(radius) => turned(&capsule(radius, 0.0)),
        Shape::Cylinder([radius, length]) => turned(&cylinder(radius, length)),
        Shape::Capsule([radius, length]) => turned(&capsule(radius, length)),
        Shape::Mesh(mesh) => {
            let mesh = scene.triangles(&scene.head.meshes[mesh]);
            mesh.map_or_else(Solid::default, |mesh| Mesh::solid(&mesh, scale))
        }
    }
}

/// A bevelled box: six sides, twelve strips, eight corners. Each corner of a side has its normal,
/// so that the light bends around the edges.
fn cuboid(sides: &Vec3) -> Solid {
    let half = sides * 0.5;
    let bevel = BEVEL * sides.min();
    let mut solid = Solid::default();
    let mut add = |corners| solid.push(corners);
    // The corner of side `axis` nearest to the box's corner `signs`.
    let corner = |axis: usize, signs: &[f64; 3]| {
        let mut p = Vec3::zeros();
        for i in 0..3 {
            let inset = if i == axis { 0.0 } else { bevel };
            p[i] = signs[i] * (half[i] - inset);
        }
        let mut n = Vec3::zeros();
        n[axis] = signs[axis];
        (p, n)
    };
    let signs = [-1.0, 1.0];
    for axis in 0..3 {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let place = |a: f64, b: f64, c: f64| {
            let mut signs = [0.0; 3];
            (signs[axis], signs[next], signs[last]) = (a, b, c);
            signs
        };
        for a in signs {
            let quad = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[b, c]| corner(axis, &place(a, b, c)));
            add([quad[0], quad[1], quad[2]]);
            add([quad[0], quad[2], quad[3]]);
            // The strips along the edges between the two other sides.
            for b in signs {
                let [p, q] = [-1.0, 1.0].map(|x| place(x, a, b));
                let quad = [
                    corner(next, &p),
                    corner(next, &q),
                    corner(last, &q),
                    corner(last, &p),
                ];
                add([quad[0], quad[1], quad[2]]);
                add([quad[0], quad[2], quad[3]]);
                if axis == 0 {
                    for x in signs {
                        let at = place(x, a, b);
                        add([corner(0, &at), corner(1, &at), corner(2, &at)]);
                    }
                }
            }
        }
    }
    solid
}

/// Radius and height of a point of a profile, and its normal in these directions.
type Rim = [[f64; 2]; 2];

fn cylinder(radius: f64, length: f64) -> Vec<Rim> {
    let (half, bevel) = (0.5 * length, BEVEL * length.min(2.0 * radius));
    let up = |sign: f64| [0.0, sign];
    vec![
        [[0.0, half], up(1.0)],
        [[radius - bevel, half], up(1.0)],
        [[radius, half - bevel], [1.0, 0.0]],
        [[radius, bevel - half], [1.0, 0.0]],
        [[radius - bevel, -half], up(-1.0)],
        [[0.0, -half], up(-1.0)],
    ]
}

/// Two half spheres, `length` apart.
fn capsule(radius: f64, length: f64) -> Vec<Rim> {
    let quarter = SIDES / 4;
    let rim = |i: usize, shift: f64| {
        let angle = count(i) / count(quarter) * 0.5 * std::f64::consts::PI;
        let (sin, cos) = libm::sincos(angle);
        [[radius * sin, radius * cos + shift], [sin, cos]]
    };
    let mut profile: Vec<Rim> = (0..=quarter).map(|i| rim(i, 0.5 * length)).collect();
    let lower = (quarter..=2 * quarter).map(|i| rim(i, -0.5 * length));
    profile.extend(lower.skip(usize::from(length <= 0.0)));
    profile
}

/// Turns a profile about z.
fn turned(profile: &[Rim]) -> Solid {
    let circle: Vec<(f64, f64)> = (0..=SIDES)
        .map(|i| {
            // The last is the first, to the bit.
            let part = count(i % SIDES) / count(SIDES);
            libm::sincos(part * 2.0 * std::f64::consts::PI)
        })
        .collect();
    let mut solid = Solid::default();
    for pair in profile.windows(2) {
        for side in circle.windows(2) {
            let at = |rim: &Rim, (sin, cos): (f64, f64)| {
                rim.map(|[across, along]| Vec3::new(across * cos, across * sin, along))
            };
            let quad = [
                at(&pair[0], side[0]),
                at(&pair[1], side[0]),
                at(&pair[1], side[1]),
                at(&pair[0], side[1]),
            ];
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                solid.push(triangle.map(|i: usize| (quad[i][0], quad[i][1])));
            }
        }
    }
    solid
}

/// Twice the area of a triangle, along its normal.
pub(super) fn area([a, b, c]: &[Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

// Normals of a mesh: at each corner of a face the normals of the faces that meet there at a flat
// angle are averaged by their areas, whichever way these faces are wound.

/// Cosine of the angle up to which faces look like one surface.
const CREASE: f64 = 0.83;

/// Faces at one corner beyond which each keeps its own normal: comparing all pairs would take long.
const MOST_FACES: usize = 400;

/// What the normals of a mesh are computed from, and its texture coordinates.
pub(super) struct Mesh {
    /// Positions that differ only in their texture coordinates are one corner.
    corner_of: Vec<u32>,
    /// The faces at each corner: those of corner `i` from `first[i]` to `first[i + 1]` in `at`.
    first: Vec<u32>,
    at: Vec<u32>,
    /// One for each position, or none at all.
    uv: Vec<[f64; 2]>,
}

impl Mesh {
    /// - `scale`: factors on all coordinates
    pub(super) fn solid(mesh: &Triangles, scale: Option<[f64; 3]>) -> Solid {
        /// A vertex that no face has had yet.
        const NEW: u32 = u32::MAX;
        let scale = Vec3::from(scale.unwrap_or([1.0; 3]));
        let mut positions = Vec::with_capacity(mesh.positions.len());
        let mut uv = Vec::with_capacity(mesh.uv.len());
        let mut corner_of = Vec::with_capacity(mesh.positions.len());
        let mut corners: HashMap<[u64; 3], u32, BuildHasherDefault<Quick>> =
            HashMap::with_capacity_and_hasher(mesh.positions.len(), BuildHasherDefault::default());
        // Vertices in the order in which faces have them; some have none.
        let mut places = vec![NEW; mesh.positions.len()];
        let mut renumbered = |i: u32| {
            let i = i as usize;
            if places[i] == NEW {
                places[i] = place(positions.len());
                let p = mesh.positions[i];
                positions.push(Vec3::from(p).component_mul(&scale));
                uv.extend(mesh.uv.get(i));
                let next = place(corners.len());
                corner_of.push(*corners.entry(p.map(f64::to_bits)).or_insert(next));
            }
            places[i]
        };
        let faces = mesh.indices.iter();
        let faces: Vec<[u32; 3]> = faces.map(|face| face.map(&mut renumbered)).collect();
        let corner = |i: u32| corner_of[i as usize] as usize;
        let mut first = vec![0; corners.len() + 1];
        for &i in faces.iter().flatten() {
            first[corner(i) + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut next = first.clone();
        let mut at = vec![0; 3 * faces.len()];
        for (f, face) in (0..).zip(&faces) {
            for &i in face {
                let next = &mut next[corner(i)];
                at[*next as usize] = f;
                *next += 1;
            }
        }
        let mesh = Self {
            corner_of,
            first,
            at,
            uv,
        };
        Solid::of_mesh(positions, faces, mesh)
    }

    /// The normals at the corners of a face of its solid.
    pub(super) fn normals(&self, solid: &Solid, face: usize) -> [Vec3; 3] {
        let plane = |f: usize| {
            let area = area(&solid.faces[f].map(|i| solid.positions[i as usize]));
            (area, area.try_normalize(0.0).unwrap_or_else(Vec3::z))
        };
        let (_, own) = plane(face);
        solid.faces[face].map(|i| {
            let corner = self.corner_of[i as usize] as usize;
            let [first, end] = [corner, corner + 1].map(|c| self.first[c] as usize);
            if end - first > MOST_FACES {
                return own;
            }
            let mut sum = Vec3::zeros();
            for &other in &self.at[first..end] {
                let (area, normal) = plane(other as usize);
                let cosine = own.dot(&normal);
                if cosine > CREASE {
                    sum += area;
                } else if cosine < -CREASE {
                    sum -= area;
                }
            }
            sum.try_normalize(0.0).unwrap_or(own)
        })
    }

    /// Texture coordinates of three positions.
    pub(super) fn uv(&self, face: &[u32; 3]) -> [[f64; 2]; 3] {
        face.map(|i| self.uv.get(i as usize).copied().unwrap_or_default())
    }
}
