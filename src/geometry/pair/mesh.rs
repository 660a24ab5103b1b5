//! The flat faces of a shape, and its edges.

use super::super::faces::outline;
use super::super::hull::{Simplices, hull};
use crate::spatial::{Vec3, across};

/// Corners of the polygon that stands for the flat end of a cylinder where something cuts it.
const END_CORNERS: usize = 16;

/// Part of a hull's size within which corners count as in one plane.
const IN_PLANE: f64 = 1e-7;

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
    /// Corners at both ends of each edge of a polyhedron.
    pub(super) ends: Vec<[usize; 2]>,
}

impl Mesh {
    /// Corners of a face in order.
    pub(super) fn face(&self, index: usize) -> &[usize] {
        &self.loops[self.first[index]..self.first[index + 1]]
    }

    #[cfg_attr(small, optimize(size))]
    fn push(&mut self, normal: Vec3, corners: impl IntoIterator<Item = usize>) {
        if self.first.is_empty() {
            self.first.push(0);
        }
        self.normals.push(normal);
        self.loops.extend(corners);
        let own = &self.loops[self.first[self.normals.len() - 1]..];
        for (&from, &to) in own.iter().zip(own.iter().cycle().skip(1)) {
            let ends = [from.min(to), from.max(to)];
            // Once: the face on the other side has it, too.
            self.ends.retain(|known| *known != ends);
            self.ends.push(ends);
        }
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

/// Both ends of a cylinder.
pub(super) fn ends(radius: f64, half: f64) -> Mesh {
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
pub(super) fn box_mesh(half: &Vec3) -> Mesh {
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
pub(super) fn hull_mesh(corners: &[Vec3], size: f64) -> Mesh {
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

/// A segment with a ball about each of its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bar {
    pub(super) middle: Vec3,
    /// Unit vector along it.
    pub(super) along: Vec3,
    pub(super) half: f64,
    pub(super) radius: f64,
}

impl Bar {
    /// The edges of a mesh whose corners are at other places, but for those without a length.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn edges(mesh: &Mesh, corners: &[Vec3], radius: f64) -> Vec<Self> {
        let bar = |&[from, to]: &[usize; 2]| {
            let (x, y) = (corners[from], corners[to]);
            Some(Self {
                middle: (x + y) * 0.5,
                along: (y - x).try_normalize(0.0)?,
                half: 0.5 * (y - x).norm(),
                radius,
            })
        };
        mesh.ends.iter().filter_map(bar).collect()
    }

    /// How far it reaches along `n`, without the ball about its points.
    pub(super) fn height(&self, n: &Vec3) -> f64 {
        n.dot(&self.middle) + n.dot(&self.along).abs() * self.half
    }

    /// Squared distance of a place from its line, m².
    pub(super) fn across(&self, x: &Vec3) -> f64 {
        (x - self.middle).cross(&self.along).norm_squared()
    }

    /// How parallel it is to a line along a unit vector: 1 where it is, none from 60° on.
    pub(super) fn parallel(&self, along: &Vec3) -> Option<f64> {
        let parallel = 2.0 * self.along.dot(along).abs() - 1.0;
        (parallel > 0.0).then_some(parallel)
    }
}
