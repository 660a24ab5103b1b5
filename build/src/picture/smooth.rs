//! Normals of a mesh.
//!
//! At each corner of a face the normals of the faces that meet there at a flat angle are averaged
//! by their areas, whichever way these faces are wound.

use super::solid::{Solid, area, place};
use crate::scene::Triangles;
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use urdf2fmu_core::hash::Quick;
use urdf2fmu_core::spatial::Vec3;

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
