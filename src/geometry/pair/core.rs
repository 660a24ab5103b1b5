//! What contact between two shapes needs of each, prepared when a model is loaded: a core, its
//! faces, what is round about it.
//!
//! The core is the shape with `rounding` taken off all around, so that the shape is nearly the core
//! swept by a ball: faces stay where they are, edges and corners are rounded. Two cores that do not
//! meet have a direction from one to the other that moves continuously with the poses, which the
//! sharp shapes have not.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::super::faces::{Faces, outline};
use super::super::hull::{Simplices, hull};
use super::super::{MOST_CORNERS, Shape, bounded_hull};
use crate::spatial::{Mat3, Pose, Vec3, across};
use crate::tuning::{ROUNDING, ROUNDING_SHARE};

/// Corners of the polygon that stands for the flat end of a cylinder where something cuts it.
pub(super) const END_CORNERS: usize = 16;

/// Part of a hull's size within which corners count as in one plane.
const IN_PLANE: f64 = 1e-7;

/// The convex set that directions between shapes are found from.
#[derive(Clone, Debug)]
pub(super) enum Core {
    /// Everything below the plane z = 0.
    HalfSpace,
    /// The origin.
    Point,
    /// From `−half` to `half` on the z axis.
    Segment { half: f64 },
    /// About the z axis.
    Cylinder { radius: f64, half: f64 },
    /// Half extents.
    Box { half: Vec3 },
    /// The hull of these.
    Corners(Vec<Vec3>),
}

/// Flat faces of a shape.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) corners: Vec<Vec3>,
    /// Unit normals outwards, one per face.
    pub(super) normals: Vec<Vec3>,
    /// Indices of corners, counter-clockwise from outside; those of face `i` from `first[i]` to
    /// `first[i + 1]`.
    loops: Vec<usize>,
    first: Vec<usize>,
    /// Directions of its edges, each once, unit vectors.
    pub(super) edges: Vec<Vec3>,
}

impl Mesh {
    /// Corners of a face in order.
    pub(super) fn face(&self, index: usize) -> &[usize] {
        &self.loops[self.first[index]..self.first[index + 1]]
    }

    fn push(&mut self, normal: Vec3, corners: impl IntoIterator<Item = usize>) {
        if self.first.is_empty() {
            self.first.push(0);
        }
        self.normals.push(normal);
        self.loops.extend(corners);
        self.first.push(self.loops.len());
    }

    /// Finds the directions of the edges from the faces.
    fn find_edges(&mut self) {
        for face in 0..self.normals.len() {
            let list = self.face(face).to_vec();
            for (i, &a) in list.iter().enumerate() {
                let b = list[(i + 1) % list.len()];
                let Some(along) = (self.corners[b] - self.corners[a]).try_normalize(0.0) else {
                    continue;
                };
                let known = |e: &Vec3| e.cross(&along).norm() < 1e-9;
                if !self.edges.iter().any(known) {
                    self.edges.push(along);
                }
            }
        }
    }
}

/// What a capsule or a cylinder is along its z axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub(super) radius: f64,
    pub(super) half: f64,
    /// Whether it ends flat.
    pub(super) flat: bool,
}

/// A shape, prepared for contact with others.
#[derive(Clone, Debug)]
pub struct Solid {
    pub(super) core: Core,
    /// Radius of the ball that sweeps the core, m.
    pub(super) radius: f64,
    /// Length over which faces take over from each other, m.
    pub(super) blend: f64,
    /// Real faces; of a cylinder its two ends as polygons.
    pub(super) mesh: Mesh,
    pub(super) round: Option<Round>,
    /// Largest distance of one of its points from its origin, m; infinite for a half-space.
    pub(super) reach: f64,
    /// Shares of a hull's corners on a plane.
    pub(super) shares: Faces,
}

impl Solid {
    /// Prepares a shape. `thickness`: within it corners of a hull count as in one face where it
    /// stands on a plane, m.
    ///
    /// Of a hull with more than 64 corners the outermost 64 are kept, as everywhere.
    pub fn new(shape: &Shape, thickness: f64) -> Self {
        let reach = shape.bounding_radius();
        let of = |core: Core, radius: f64, smallest: f64| Self {
            core,
            radius,
            blend: rounding(smallest).max(1e-4 * reach),
            mesh: Mesh::default(),
            round: None,
            reach,
            shares: Faces::default(),
        };
        match shape {
            Shape::Sphere { radius } => of(Core::Point, *radius, *radius),
            Shape::Capsule {
                radius,
                half_length: half,
            } => Self {
                round: Some(Round {
                    radius: *radius,
                    half: *half,
                    flat: false,
                }),
                ..of(Core::Segment { half: *half }, *radius, *radius)
            },
            Shape::Cylinder {
                radius,
                half_length: half,
            } => {
                let r = rounding(radius.min(*half));
                let core = Core::Cylinder {
                    radius: radius - r,
                    half: half - r,
                };
                Self {
                    round: Some(Round {
                        radius: *radius,
                        half: *half,
                        flat: true,
                    }),
                    mesh: ends(*radius, *half),
                    ..of(core, r, radius.min(*half))
                }
            }
            Shape::Box { half } => {
                let r = rounding(half.min());
                let core = Core::Box {
                    half: half.add_scalar(-r),
                };
                Self {
                    mesh: box_mesh(half),
                    ..of(core, r, half.min())
                }
            }
            Shape::Hull { vertices } => {
                let kept = bounded_hull(vertices, MOST_CORNERS);
                let corners = kept.map_or_else(|_| vertices.clone(), |hull| hull.vertices);
                let mesh = hull_mesh(&corners, reach);
                let (core, r) = shrunk(&mesh, &corners);
                Self {
                    shares: Faces::new(&corners, thickness),
                    mesh,
                    ..of(Core::Corners(core), r, r / ROUNDING_SHARE)
                }
            }
        }
    }

    /// The half-space below the plane z = 0 of its own axes.
    pub fn half_space() -> Self {
        Self {
            core: Core::HalfSpace,
            radius: 0.0,
            blend: 0.0,
            mesh: Mesh::default(),
            round: None,
            reach: f64::INFINITY,
            shares: Faces::default(),
        }
    }

    /// How much its edges are rounded by to find directions, m; 0 for balls, capsules and planes,
    /// which have none.
    pub fn rounding(&self) -> f64 {
        match self.core {
            Core::Cylinder { .. } | Core::Box { .. } | Core::Corners(_) => self.radius,
            _ => 0.0,
        }
    }
}

/// By how much edges of a shape with this smallest half extent are rounded.
fn rounding(smallest: f64) -> f64 {
    ROUNDING.min(ROUNDING_SHARE * smallest)
}

/// Both ends of a cylinder.
fn ends(radius: f64, half: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for z in [half, -half] {
        for i in 0..END_CORNERS {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let angle = std::f64::consts::TAU * (i as f64 / END_CORNERS as f64);
            let (sin, cos) = libm::sincos(angle);
            mesh.corners.push(Vec3::new(radius * cos, radius * sin, z));
        }
    }
    mesh.push(Vec3::z(), 0..END_CORNERS);
    mesh.push(-Vec3::z(), (END_CORNERS..2 * END_CORNERS).rev());
    mesh
}

/// A box's corner `i` is on the positive side of axis `k` where bit `k` of `i` is set.
fn box_mesh(half: &Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..8 {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        mesh.corners
            .push(half.component_mul(&Vec3::new(sign(1), sign(2), sign(4))));
    }
    for axis in 0..3 {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let mut normal = Vec3::zeros();
        normal[axis] = 1.0;
        let top = 1 << axis;
        mesh.push(normal, [top, top + u, top + u + v, top + v]);
        mesh.push(-normal, [0, v, u + v, u]);
    }
    mesh.edges = vec![Vec3::x(), Vec3::y(), Vec3::z()];
    mesh
}

/// Faces of a hull, those in one plane as one.
fn hull_mesh(corners: &[Vec3], size: f64) -> Mesh {
    let mut mesh = Mesh {
        corners: corners.to_vec(),
        ..Mesh::default()
    };
    let Some(hull) = hull(corners, corners.len().max(4)) else {
        return mesh;
    };
    let plane = |[a, b, c]: [usize; 3]| {
        let [a, b, c] = [a, b, c].map(|i| hull.corners[i]);
        (b - a).cross(&(c - a)).try_normalize(0.0)
    };
    let mut known: Vec<Vec<usize>> = Vec::new();
    let mut add = |mesh: &mut Mesh, normal: Vec3| {
        let height = |i: usize| normal.dot(&corners[i]);
        let top = (0..corners.len())
            .map(height)
            .fold(f64::NEG_INFINITY, f64::max);
        let list: Vec<usize> = (0..corners.len())
            .filter(|&i| height(i) > top - IN_PLANE * size)
            .collect();
        let x = across(&normal);
        let y = normal.cross(&x);
        let flat: Vec<(f64, f64)> = list
            .iter()
            .map(|&i| (x.dot(&corners[i]), y.dot(&corners[i])))
            .collect();
        let order: Vec<usize> = outline(&flat).into_iter().map(|i| list[i]).collect();
        if order.len() > 2 && !known.contains(&list) {
            // Of all corners: more exact than that of a thin triangle.
            let sum = (0..order.len()).fold(Vec3::zeros(), |sum, i| {
                let (a, b) = (corners[order[i]], corners[order[(i + 1) % order.len()]]);
                sum + (a - corners[order[0]]).cross(&(b - corners[order[0]]))
            });
            mesh.push(sum.try_normalize(0.0).unwrap_or(normal), order);
            known.push(list);
        }
    };
    match &hull.simplices {
        Simplices::Faces(triangles) => {
            for triangle in triangles {
                if let Some(normal) = plane(*triangle) {
                    add(&mut mesh, normal);
                }
            }
        }
        Simplices::Polygon(order) if order.len() > 2 => {
            if let Some(normal) = plane([order[0], order[1], order[2]]) {
                let x = across(&normal);
                let y = normal.cross(&x);
                let flat: Vec<(f64, f64)> = corners.iter().map(|c| (x.dot(c), y.dot(c))).collect();
                let order = outline(&flat);
                mesh.push(normal, order.clone());
                mesh.push(-normal, order.into_iter().rev());
            }
        }
        _ => {}
    }
    mesh.find_edges();
    mesh
}

/// Corners of the hull whose faces are all moved in by a rounding, and that rounding; the hull
/// itself and 0 where it has no volume.
///
/// 1. About an inner point `c` the faces are `ν·x ≤ e`, with `x` from `c` and `e > 0`.
/// 2. Moved in they are `p·x ≤ 1` with `p = ν/(e − r)`. A corner where faces `i j k` meet solves
///    `p_i·x = p_j·x = p_k·x = 1` and violates no other: `x` is the normal of a face of the hull of
///    all `p`, over its distance from 0.
fn shrunk(mesh: &Mesh, corners: &[Vec3]) -> (Vec<Vec3>, f64) {
    let itself = (corners.to_vec(), 0.0);
    if mesh.normals.len() < 4 {
        return itself;
    }
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let center = corners.iter().sum::<Vec3>() / corners.len() as f64;
    let inside = |face: usize| {
        let corner = corners[mesh.face(face)[0]];
        mesh.normals[face].dot(&(corner - center))
    };
    let least = (0..mesh.normals.len())
        .map(inside)
        .fold(f64::INFINITY, f64::min);
    let r = rounding(least);
    if r <= 0.0 {
        return itself;
    }
    let dual: Vec<Vec3> = (0..mesh.normals.len())
        .map(|face| mesh.normals[face] / (inside(face) - r))
        .collect();
    let Some(found) = hull(&dual, dual.len().max(4)) else {
        return itself;
    };
    let Simplices::Faces(triangles) = &found.simplices else {
        return itself;
    };
    let mut core: Vec<Vec3> = Vec::new();
    for triangle in triangles {
        let [p, q, s] = triangle.map(|i| found.corners[i]);
        let rows = Mat3::from_rows(&[p.transpose(), q.transpose(), s.transpose()]);
        let Some(x) = rows.lu().solve(&Vec3::repeat(1.0)) else {
            continue;
        };
        let corner = x + center;
        if !core.iter().any(|c| (c - corner).norm() < 1e-6 * r) {
            core.push(corner);
        }
    }
    if core.len() < 4 { itself } else { (core, r) }
}

/// A solid in a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub(super) solid: &'a Solid,
    pub(super) R: Mat3,
    pub(super) p: Vec3,
}

impl<'a> Placed<'a> {
    /// The solid at `X`, with positions from `origin`.
    pub(super) fn new(solid: &'a Solid, X: &Pose, origin: &Vec3) -> Self {
        Self {
            solid,
            R: X.R,
            p: X.p - origin,
        }
    }

    /// The z axis of the solid.
    pub(super) fn axis(&self) -> Vec3 {
        self.R.column(2).into()
    }

    /// The point of the core that is farthest along `d`.
    pub(super) fn support(&self, d: &Vec3) -> Vec3 {
        let signed = |x: f64, by: f64| if by < 0.0 { -x } else { x };
        match &self.solid.core {
            Core::HalfSpace | Core::Point => self.p,
            Core::Segment { half } => {
                let k = self.axis();
                self.p + k * signed(*half, k.dot(d))
            }
            Core::Cylinder { radius, half } => {
                let k = self.axis();
                let along = k.dot(d);
                let off = d - k * along;
                let length = off.norm();
                let rim = if length > 0.0 {
                    off * (radius / length)
                } else {
                    Vec3::zeros()
                };
                self.p + k * signed(*half, along) + rim
            }
            Core::Box { half } => {
                let local = self.R.tr_mul(d);
                let corner = half.zip_map(&local, signed);
                self.p + self.R * corner
            }
            Core::Corners(list) => {
                let local = self.R.tr_mul(d);
                let mut best = (f64::NEG_INFINITY, Vec3::zeros());
                for corner in list {
                    let height = local.dot(corner);
                    if height > best.0 {
                        best = (height, *corner);
                    }
                }
                self.p + self.R * best.1
            }
        }
    }
}
