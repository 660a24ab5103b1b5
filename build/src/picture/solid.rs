//! Shapes of a scene → triangles with normals.
//!
//! Edges of boxes and cylinders are bevelled by a little: they catch light, and a box stops looking
//! like a diagram. Faces of a mesh that meet at a flat angle share their normal.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::camera::count;
use super::texture::{ALL_PIXELS, Image};
use crate::image::linear;
use crate::scene::{Drawn, Scene, Shape, Triangles, pose};
use std::collections::HashMap;
use urdf2fmu_core::spatial::{Pose, Vec3};

/// Bevel of an edge, as a part of the shortest side.
const BEVEL: f64 = 0.05;

/// Cosine of the angle up to which faces look like one surface.
const CREASE: f64 = 0.83;

/// Faces at one vertex beyond which each keeps its own normal: comparing all pairs would take long.
const MOST_FACES: usize = 400;

/// Sides of a circle.
const SIDES: usize = 64;

/// What is drawn, and not yet where.
pub(super) struct Stage {
    pub(super) surfaces: Vec<Surface>,
    pub(super) images: Vec<Option<Image>>,
    shapes: Vec<(usize, Pose, Vec<Face>)>,
}

/// What triangles look like.
pub(super) struct Surface {
    /// Red, green, blue, linear.
    pub(super) color: [f32; 3],
    pub(super) alpha: f32,
    /// In [`Stage::images`].
    pub(super) image: Option<usize>,
}

/// A triangle of a shape, in the shape's frame.
#[derive(Clone, Debug)]
struct Face {
    corners: [Vec3; 3],
    normals: [Vec3; 3],
    /// The middle of the normals, a unit vector.
    facing: Vec3,
    uv: [[f64; 2]; 3],
}

impl Face {
    fn new(corners: [Vec3; 3], normals: [Vec3; 3], uv: [[f64; 2]; 3]) -> Self {
        let middle = normals[0] + normals[1] + normals[2];
        Self {
            corners,
            normals,
            facing: middle.try_normalize(0.0).unwrap_or_else(Vec3::z),
            uv,
        }
    }
}

/// A triangle in the world.
pub(super) struct Triangle {
    pub(super) corners: [Vec3; 3],
    pub(super) normals: [Vec3; 3],
    pub(super) uv: [[f64; 2]; 3],
    /// The middle of the normals.
    pub(super) facing: Vec3,
    /// In [`Stage::surfaces`].
    pub(super) surface: usize,
}

impl Stage {
    pub(super) fn new(scene: &Scene) -> Self {
        let most = ALL_PIXELS / scene.head.textures.len().max(1);
        let images = scene.head.textures.iter();
        let images = images
            .map(|texture| Image::read(&texture.kind, scene.image(texture)?, most))
            .collect();
        let mut stage = Self {
            surfaces: Vec::new(),
            images,
            shapes: Vec::new(),
        };
        for drawn in scene.shown() {
            let [red, green, blue, alpha] = drawn.color;
            let image = drawn.texture.filter(|&t| stage.images[t].is_some());
            stage.surfaces.push(Surface {
                color: [red, green, blue].map(|x| linear(soft(x))),
                #[allow(clippy::cast_possible_truncation, reason = "0 … 1")]
                alpha: alpha as f32,
                image,
            });
            let X_LG = pose(&drawn.position, &drawn.orientation);
            stage.shapes.push((drawn.link, X_LG, faces(scene, drawn)));
        }
        stage
    }

    /// All triangles for links at these poses.
    pub(super) fn triangles(&self, poses: &[Pose]) -> Vec<Triangle> {
        let mut list = Vec::with_capacity(self.shapes.iter().map(|s| s.2.len()).sum());
        for (surface, (link, X_LG, faces)) in self.shapes.iter().enumerate() {
            let X_WG = poses[*link].compose(X_LG);
            list.extend(faces.iter().map(|face| Triangle {
                corners: face.corners.map(|p| X_WG.point(&p)),
                normals: face.normals.map(|n| X_WG.R * n),
                facing: X_WG.R * face.facing,
                uv: face.uv,
                surface,
            }));
        }
        list
    }

    /// All corners of what can be seen.
    pub(super) fn corners(&self, poses: &[Pose]) -> Vec<Vec3> {
        let mut list = Vec::new();
        for (surface, (link, X_LG, faces)) in self.shapes.iter().enumerate() {
            if self.surfaces[surface].alpha > 0.0 {
                let X_WG = poses[*link].compose(X_LG);
                let corners = faces.iter().flat_map(|face| face.corners);
                list.extend(corners.map(|p| X_WG.point(&p)));
            }
        }
        list
    }
}

/// URDF colours are plain numbers; pure black and white leave no room for light and shadow.
fn soft(x: f64) -> f64 {
    0.045 + 0.855 * x
}

fn faces(scene: &Scene, drawn: &Drawn) -> Vec<Face> {
    let mut faces = match drawn.shape {
        Shape::Box(sides) => cuboid(&Vec3::from(sides)),
        Shape::Sphere(radius) => turned(&capsule(radius, 0.0)),
        Shape::Cylinder([radius, length]) => turned(&cylinder(radius, length)),
        Shape::Capsule([radius, length]) => turned(&capsule(radius, length)),
        Shape::Mesh(mesh) => {
            let mesh = scene.triangles(&scene.head.meshes[mesh]);
            return mesh.map_or_else(Vec::new, |mesh| smooth(&mesh, drawn.scale));
        }
    };
    faces.retain(|face| area(&face.corners).norm() > 0.0);
    faces
}

/// A bevelled box: six sides, twelve strips, eight corners. Each corner of a side has its normal,
/// so that the light bends around the edges.
fn cuboid(sides: &Vec3) -> Vec<Face> {
    let half = sides * 0.5;
    let bevel = BEVEL * sides.min();
    let mut faces = Vec::new();
    let mut add = |corners: [(Vec3, Vec3); 3]| {
        let [p, n] = [corners.map(|c| c.0), corners.map(|c| c.1)];
        faces.push(Face::new(p, n, [[0.0; 2]; 3]));
    };
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
    faces
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
fn turned(profile: &[Rim]) -> Vec<Face> {
    let circle: Vec<(f64, f64)> = (0..=SIDES)
        .map(|i| {
            // The last is the first, to the bit.
            let part = count(i % SIDES) / count(SIDES);
            libm::sincos(part * 2.0 * std::f64::consts::PI)
        })
        .collect();
    let mut faces = Vec::new();
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
            for [i, j, k] in [[0, 1, 2], [0, 2, 3]] {
                let [p, n] = [0, 1].map(|of| [quad[i][of], quad[j][of], quad[k][of]]);
                faces.push(Face::new(p, n, [[0.0; 2]; 3]));
            }
        }
    }
    faces
}

/// Twice the area of a triangle, along its normal.
fn area([a, b, c]: &[Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

/// The faces of a mesh; at each corner the normals of the faces that meet there at a flat angle
/// are averaged by their areas, whichever way these faces are wound.
fn smooth(mesh: &Triangles, scale: Option<[f64; 3]>) -> Vec<Face> {
    let scale = Vec3::from(scale.unwrap_or([1.0; 3]));
    let positions: Vec<Vec3> = mesh
        .positions
        .iter()
        .map(|&p| Vec3::from(p).component_mul(&scale))
        .collect();
    // Vertices that differ only in their texture coordinates are one corner.
    let mut places: HashMap<[u64; 3], usize> = HashMap::new();
    let corner_of: Vec<usize> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = places.len();
            *places.entry(p.map(f64::to_bits)).or_insert(next)
        })
        .collect();
    let areas: Vec<Vec3> = mesh
        .indices
        .iter()
        .map(|face| area(&face.map(|i| positions[i])))
        .collect();
    let normals: Vec<Vec3> = areas
        .iter()
        .map(|a| a.try_normalize(0.0).unwrap_or_else(Vec3::z))
        .collect();
    // The faces at each corner, one list behind the other.
    let mut first = vec![0; places.len() + 1];
    for &i in mesh.indices.iter().flatten() {
        first[corner_of[i] + 1] += 1;
    }
    for i in 1..first.len() {
        first[i] += first[i - 1];
    }
    let mut next = first.clone();
    let mut at = vec![0; 3 * mesh.indices.len()];
    for (f, face) in mesh.indices.iter().enumerate() {
        for &i in face {
            let place = &mut next[corner_of[i]];
            at[*place] = f;
            *place += 1;
        }
    }
    let normal = |f: usize, i: usize| {
        let corner = corner_of[i];
        let around = &at[first[corner]..first[corner + 1]];
        if around.len() > MOST_FACES {
            return normals[f];
        }
        let mut sum = Vec3::zeros();
        for &other in around {
            let cosine = normals[f].dot(&normals[other]);
            if cosine > CREASE {
                sum += areas[other];
            } else if cosine < -CREASE {
                sum -= areas[other];
            }
        }
        sum.try_normalize(0.0).unwrap_or(normals[f])
    };
    let faces = mesh.indices.iter().enumerate();
    faces
        .map(|(f, face)| {
            let uv = face.map(|i| mesh.uv.get(i).copied().unwrap_or_default());
            Face::new(face.map(|i| positions[i]), face.map(|i| normal(f, i)), uv)
        })
        .collect()
}
