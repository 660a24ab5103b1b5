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

/// Rounding of the inner core, as a share of the smallest half extent.
const INNER: f64 = 0.3;

/// Blend of a shape that is too thin for a rounding, as a share of its reach.
const LEAST_BLEND: f64 = 1e-4;

/// Part of the rounding within which two corners of a core are one.
const SAME: f64 = 1e-6;

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
    /// A smaller one, for shapes that overlap by more than their roundings.
    pub(super) inner: Core,
    /// Radius of the ball that sweeps the core, m.
    pub(super) radius: f64,
    /// The same for the inner core, m.
    pub(super) inner_radius: f64,
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
            inner: core.clone(),
            core,
            radius,
            inner_radius: radius,
            blend: rounding(smallest).max(LEAST_BLEND * reach),
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
                let smallest = radius.min(*half);
                let r = rounding(smallest);
                let core = |r: f64| Core::Cylinder {
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
                    inner: core(INNER * smallest),
                    inner_radius: INNER * smallest,
                    ..of(core(r), r, smallest)
                }
            }
            Shape::Box { half } => {
                let r = rounding(half.min());
                let core = |r: f64| Core::Box {
                    half: half.add_scalar(-r),
                };
                Self {
                    mesh: box_mesh(half),
                    inner: core(INNER * half.min()),
                    inner_radius: INNER * half.min(),
                    ..of(core(r), r, half.min())
                }
            }
            Shape::Hull { vertices } => {
                let kept = bounded_hull(vertices, MOST_CORNERS);
                let corners = kept.map_or_else(|_| vertices.clone(), |hull| hull.vertices);
                let mesh = hull_mesh(&corners, reach);
                let smallest = thickness_of(&mesh);
                let (core, r) = shrunk(&mesh, rounding(smallest));
                let (inner, inner_radius) = shrunk(&mesh, INNER * smallest);
                Self {
                    shares: Faces::new(&corners, thickness),
                    mesh,
                    inner: Core::Corners(inner),
                    inner_radius,
                    ..of(Core::Corners(core), r, smallest)
                }
            }
        }
    }

    /// The half-space below the plane z = 0 of its own axes.
    pub fn half_space() -> Self {
        Self {
            core: Core::HalfSpace,
            inner: Core::HalfSpace,
            radius: 0.0,
            inner_radius: 0.0,
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

    /// Half of its least extent, m, where that is below 5 cm; else no more than its half extents.
    pub fn thickness(&self) -> f64 {
        match self.core {
            Core::Point | Core::Segment { .. } => self.radius,
            Core::Cylinder { .. } | Core::Box { .. } | Core::Corners(_) => {
                self.radius / ROUNDING_SHARE
            }
            Core::HalfSpace => f64::INFINITY,
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

/// The middle of a hull's corners.
fn center(mesh: &Mesh) -> Vec3 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = mesh.corners.len() as f64;
    mesh.corners.iter().sum::<Vec3>() / count
}

/// How far the faces of a hull are from its middle.
fn inside<'a>(mesh: &'a Mesh, center: &'a Vec3) -> impl Fn(usize) -> f64 + 'a {
    move |face| {
        let corner = mesh.corners[mesh.face(face)[0]];
        mesh.normals[face].dot(&(corner - center))
    }
}

/// Least distance of a face of a hull from its middle; 0 if it has no volume.
fn thickness_of(mesh: &Mesh) -> f64 {
    if mesh.normals.len() < 4 {
        return 0.0;
    }
    let center = center(mesh);
    let least = (0..mesh.normals.len()).map(inside(mesh, &center));
    least.fold(f64::INFINITY, f64::min).max(0.0)
}

/// The core of a hull with that rounding, and it; the hull itself and 0 where it has no volume.
fn shrunk(mesh: &Mesh, r: f64) -> (Vec<Vec3>, f64) {
    let core = if r > 0.0 { moved_in(mesh, r) } else { None };
    core.map_or_else(|| (mesh.corners.clone(), 0.0), |core| (core, r))
}

/// Corners of the hull whose faces are all moved in by `r`.
///
/// 1. About an inner point `c` the faces are `ν·x ≤ e`, with `x` from `c` and `e > 0`.
/// 2. Moved in they are `p·x ≤ 1` with `p = ν/(e − r)`. A corner where faces `i j k` meet solves
///    `p_i·x = p_j·x = p_k·x = 1` and violates no other: `x` is the normal of a face of the hull of
///    all `p`, over its distance from 0.
fn moved_in(mesh: &Mesh, r: f64) -> Option<Vec<Vec3>> {
    let center = center(mesh);
    let inside = inside(mesh, &center);
    let dual: Vec<Vec3> = (0..mesh.normals.len())
        .map(|face| mesh.normals[face] / (inside(face) - r))
        .collect();
    let found = hull(&dual, dual.len().max(4))?;
    let Simplices::Faces(triangles) = &found.simplices else {
        return None;
    };
    let mut corners: Vec<Vec3> = Vec::new();
    for triangle in triangles {
        let [p, q, s] = triangle.map(|i| found.corners[i]);
        let rows = Mat3::from_rows(&[p.transpose(), q.transpose(), s.transpose()]);
        let Some(x) = rows.lu().solve(&Vec3::repeat(1.0)) else {
            continue;
        };
        let corner = x + center;
        if !corners.iter().any(|c| (c - corner).norm() < SAME * r) {
            corners.push(corner);
        }
    }
    (corners.len() >= 4).then_some(corners)
}

/// A solid in a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub(super) solid: &'a Solid,
    pub(super) core: &'a Core,
    pub(super) R: Mat3,
    pub(super) p: Vec3,
}

impl<'a> Placed<'a> {
    /// The solid at `X`, with positions from `origin`.
    pub(super) fn new(solid: &'a Solid, X: &Pose, origin: &Vec3) -> Self {
        Self {
            solid,
            core: &solid.core,
            R: X.R,
            p: X.p - origin,
        }
    }

    /// The same with its inner core.
    pub(super) fn inner(&self) -> Self {
        Self {
            core: &self.solid.inner,
            ..*self
        }
    }

    /// The z axis of the solid.
    pub(super) fn axis(&self) -> Vec3 {
        self.R.column(2).into()
    }

    /// A point of its own axes in those of the poses.
    pub(super) fn world(&self, local: &Vec3) -> Vec3 {
        self.p + self.R * local
    }

    /// The point of the core that is farthest along `d`.
    pub(super) fn support(&self, d: &Vec3) -> Vec3 {
        self.world(&self.support_local(d))
    }

    /// The same in its own axes.
    pub(super) fn support_local(&self, d: &Vec3) -> Vec3 {
        let signed = |x: f64, by: f64| if by < 0.0 { -x } else { x };
        let local = self.R.tr_mul(d);
        match self.core {
            Core::HalfSpace | Core::Point => Vec3::zeros(),
            Core::Segment { half } => Vec3::new(0.0, 0.0, signed(*half, local.z)),
            Core::Cylinder { radius, half } => {
                // Round-off of a direction along the axis stays across it.
                let off = (local.x * local.x + local.y * local.y).sqrt();
                let out = if off > 0.0 { radius / off } else { 0.0 };
                Vec3::new(local.x * out, local.y * out, signed(*half, local.z))
            }
            Core::Box { half } => half.zip_map(&local, signed),
            Core::Corners(list) => {
                let mut best = (f64::NEG_INFINITY, Vec3::zeros());
                for corner in list {
                    let height = local.dot(corner);
                    if height > best.0 {
                        best = (height, *corner);
                    }
                }
                best.1
            }
        }
    }
}

/// The gap of the cores of `a` and `b` along `n`: `min n·x` of A minus `max n·y` of B.
pub(super) fn separation(a: &Placed, b: &Placed, n: &Vec3) -> f64 {
    n.dot(&(a.support(&-n) - b.support(n)))
}
