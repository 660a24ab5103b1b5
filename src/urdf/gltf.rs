//! glTF 2.0 (`.glb`, `.gltf`) → points and triangles by colour and texture: meshes placed by the
//! nodes of the scene, in m.
//!
//! glTF has its y axis upwards, and nothing is turned for that: exporters of robots, `SAPIEN`,
//! Genesis, three.js loaders and trimesh take the file's axes as those of the link. Points and
//! lines are skipped, a skinned mesh stands in its bind pose, a morphed one at rest. Of a material
//! the base colour and its texture are read.
//!
//! An own reader: it takes no more than the colour of a surface needs, and every place that the
//! JSON names is held to the bytes that are there.
//!
//! Sources: Khronos Group, "glTF 2.0 specification", ISO/IEC 12113; extension
//! `KHR_texture_transform`.

mod buffers;
mod json;

use super::faces::{Image, MeshError, Paint, Part, Parts};
use crate::spatial::Vec3;
use buffers::{Buffer, problem};
use json::{Accessor, Attributes, Node, Primitive, Scenes, TextureUse};
use nalgebra::{Matrix4, Point3, Quaternion, UnitQuaternion};
use std::sync::Arc;

/// Most triangles that are kept: many nodes may show one mesh.
const MOST_TRIANGLES: usize = 5_000_000;

/// Deepest nesting of nodes.
const DEEPEST: usize = 200;

/// Extensions without which the triangles cannot be had.
const PACKED: [&str; 4] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",
];

/// A file with the numbers that it names.
pub(super) struct File {
    scenes: Scenes,
    buffers: Vec<Buffer>,
}

impl File {
    /// - `beside`: content of a file that it names, `None` where it cannot be had
    pub(super) fn read(
        bytes: &[u8],
        beside: impl FnMut(&str) -> Option<Result<Vec<u8>, MeshError>>,
    ) -> Result<Self, MeshError> {
        let (json, binary) = buffers::chunks(bytes)?;
        let scenes: Scenes =
            serde_json::from_slice(json).map_err(|error| problem(format!("its JSON: {error}")))?;
        let required = &scenes.extensions_required;
        if let Some(name) = required.iter().find(|name| PACKED.contains(&name.as_str())) {
            let what = format!("it needs {name}, which is not read: export it without");
            return Err(problem(what));
        }
        buffers::known_version(&scenes.asset.version)?;
        let buffers = buffers::read(&scenes, binary, beside)?;
        Ok(Self { scenes, buffers })
    }

    /// Corners of all triangles in the scene.
    pub(super) fn corners(&self) -> Result<Vec<Vec3>, MeshError> {
        let mut points = Vec::new();
        self.each(|_, triangle| points.extend(triangle))?;
        Ok(points)
    }

    /// All triangles in the scene.
    pub(super) fn triangles(&self) -> Result<Vec<[Vec3; 3]>, MeshError> {
        let mut triangles = Vec::new();
        self.each(|_, triangle| triangles.push(triangle))?;
        Ok(triangles)
    }

    /// All triangles in the scene, by what they are painted with.
    pub(super) fn parts(&self) -> Result<Vec<Part>, MeshError> {
        let mut parts = Parts::default();
        let mut images = vec![None; self.scenes.images.len()];
        self.place(|_, primitive, placed, left| {
            let (paint, shown) = self.paint(primitive.material, &mut images);
            let uv = shown
                .map(|shown| self.coordinates(&primitive.attributes, shown))
                .transpose()?
                .flatten();
            let part = parts.of(&paint, uv.is_some());
            self.triangles_of(primitive, placed, left, |corners, triangle| {
                let uv = uv.as_ref().map(|uv| corners.map(uv));
                part.push(triangle, uv);
            })
        })?;
        parts.finish()
    }

    /// All triangles in the scene, by the nodes that show them.
    pub(super) fn objects(&self) -> Result<Vec<Vec<[Vec3; 3]>>, MeshError> {
        let (mut list, mut last) = (Vec::<Vec<_>>::new(), None);
        self.place(|node, primitive, placed, left| {
            if last.replace(node) != Some(node) {
                list.push(Vec::new());
            }
            self.triangles_of(primitive, placed, left, |_, triangle| {
                list.last_mut()
                    .into_iter()
                    .for_each(|own| own.push(triangle));
            })
        })?;
        Ok(list)
    }

    fn each(&self, mut show: impl FnMut(&Primitive, [Vec3; 3])) -> Result<(), MeshError> {
        self.place(|_, primitive, placed, left| {
            self.triangles_of(primitive, placed, left, |_, triangle| {
                show(primitive, triangle);
            })
        })
    }

    /// Shows every primitive of the scene that has triangles, with its node and where it stands; it
    /// counts its triangles down from what is left.
    fn place(
        &self,
        mut show: impl FnMut(usize, &Primitive, &Matrix4<f64>, &mut usize) -> Result<(), MeshError>,
    ) -> Result<(), MeshError> {
        let scenes = &self.scenes;
        let mut left = MOST_TRIANGLES;
        let mut shown = vec![false; scenes.nodes.len()];
        let roots = roots(scenes).into_iter().rev();
        let mut open: Vec<(usize, Matrix4<f64>, usize)> =
            roots.map(|node| (node, Matrix4::identity(), 0)).collect();
        while let Some((index, above, depth)) = open.pop() {
            let node = scenes.nodes.get(index);
            let node = node.ok_or_else(|| problem(format!("there is no node {index}")))?;
            if std::mem::replace(&mut shown[index], true) || depth > DEEPEST {
                return Err(problem(format!("node {index} stands in the scene twice")));
            }
            let placed = above * placement(node)?;
            let children = node.children.iter().rev();
            open.extend(children.map(|&child| (child, placed, depth + 1)));
            let Some(mesh) = node.mesh else {
                continue;
            };
            let mesh = scenes.meshes.get(mesh);
            let mesh = mesh.ok_or_else(|| problem(format!("node {index} shows no mesh")))?;
            // Not points and lines.
            let solid = |primitive: &&Primitive| (4..=6).contains(&primitive.mode);
            for primitive in mesh.primitives.iter().filter(solid) {
                show(index, primitive, &placed, &mut left)?;
            }
        }
        Ok(())
    }

    /// Shows the triangles of a primitive with the numbers of their vertices.
    fn triangles_of(
        &self,
        primitive: &Primitive,
        placed: &Matrix4<f64>,
        left: &mut usize,
        mut show: impl FnMut([usize; 3], [Vec3; 3]),
    ) -> Result<(), MeshError> {
        let Some(position) = primitive.attributes.position else {
            return Ok(());
        };
        let rows = self.rows(position)?;
        if (rows.accessor.component_type, rows.accessor.kind.as_str()) != (5126, "VEC3") {
            return Err(problem("a position is not three floats"));
        }
        let point = |index: usize| {
            let row = rows.row(index)?;
            let point = Point3::new(float(row, 0)?, float(row, 1)?, float(row, 2)?);
            Some(placed.transform_point(&point).coords)
        };
        let indices = primitive.indices.map(|own| self.rows(own)).transpose()?;
        let count = indices.as_ref().unwrap_or(&rows).accessor.count;
        let vertex = |at: usize| {
            let Some(indices) = &indices else {
                return Some(at);
            };
            let row = indices.row(at)?;
            let index = match indices.accessor.component_type {
                5121 => u32::from(*row.first()?),
                5123 => u32::from(u16::from_le_bytes(*row.first_chunk()?)),
                5125 => u32::from_le_bytes(*row.first_chunk()?),
                _ => return None,
            };
            usize::try_from(index).ok()
        };
        let triangles = match primitive.mode {
            4 => count / 3,
            _ => count.saturating_sub(2),
        };
        *left = left
            .checked_sub(triangles)
            .ok_or_else(|| problem(format!("it has more than {MOST_TRIANGLES} triangles")))?;
        // A mirror turns all of them over.
        let mirrored = placed.determinant() < 0.0;
        for k in 0..triangles {
            let mut places = match primitive.mode {
                4 => [3 * k, 3 * k + 1, 3 * k + 2],
                // A strip turns every second triangle over.
                5 => [k, k + 1 + k % 2, k + 2 - k % 2],
                _ => [0, k + 1, k + 2],
            };
            if mirrored {
                places.swap(1, 2);
            }
            let corner = |at| {
                let index = vertex(at)?;
                Some((index, point(index)?))
            };
            let [Some(a), Some(b), Some(c)] = places.map(corner) else {
                return Err(problem("a triangle names a vertex that is not there"));
            };
            show([a.0, b.0, c.0], [a.1, b.1, c.1]);
        }
        Ok(())
    }

    /// What a material is seen as without light, and how it shows its texture, which is multiplied
    /// by the factor.
    ///
    /// - `images`: those that have been read
    fn paint(
        &self,
        material: Option<usize>,
        images: &mut [Option<Image>],
    ) -> (Paint, Option<&TextureUse>) {
        let pbr = material.and_then(|own| {
            self.scenes
                .materials
                .get(own)?
                .pbr_metallic_roughness
                .as_ref()
        });
        let texture = pbr.and_then(|pbr| pbr.base_color_texture.as_ref());
        let image = texture.and_then(|own| {
            let number = self.scenes.textures.get(own.index)?.image()?;
            let known = images.get_mut(number)?;
            if known.is_none() {
                *known = self.image(number);
            }
            known.clone()
        });
        let factor = pbr.and_then(|pbr| pbr.base_color_factor);
        // Colours of the file are linear.
        let color = factor.map(|[red, green, blue, _]| [red, green, blue].map(displayed));
        if image.is_some() {
            let white = |color: &[f64; 3]| color.iter().all(|x| *x >= 1.0);
            let paint = Paint {
                color: None,
                image,
                tint: color.filter(|color| !white(color)),
            };
            return (paint, texture);
        }
        let paint = Paint {
            color: color.filter(|_| texture.is_none()),
            ..Paint::default()
        };
        (paint, None)
    }

    /// An image, as it is written; whoever shows it says what is wrong with it.
    fn image(&self, number: usize) -> Option<Image> {
        let image = self.scenes.images.get(number)?;
        match (&image.uri, image.buffer_view) {
            (Some(uri), _) if buffers::is_data(uri) => {
                Some(Image::Held(buffers::data(uri).unwrap_or_default().into()))
            }
            (Some(uri), _) => Some(Image::Named(uri.clone())),
            (None, Some(view)) => {
                let view = self.scenes.buffer_views.get(view)?;
                let bytes = buffers::view(&self.buffers, view).unwrap_or_default();
                Some(Image::Held(Arc::from(bytes)))
            }
            (None, None) => None,
        }
    }

    /// The texture coordinates of vertices; none where the primitive has none.
    fn coordinates<'d>(
        &'d self,
        attributes: &Attributes,
        shown: &'d TextureUse,
    ) -> Result<Option<impl Fn(usize) -> [f64; 2] + 'd>, MeshError> {
        let Some(accessor) = attributes.texture(shown.set()) else {
            return Ok(None);
        };
        let rows = self.rows(accessor)?;
        let kind = rows.accessor.component_type;
        if rows.accessor.kind != "VEC2" {
            return Err(problem("a texture coordinate is not two numbers"));
        }
        let number = move |row: &[u8], at: usize| match kind {
            5121 => Some(f64::from(*row.get(at)?) / 255.0),
            5123 => {
                Some(f64::from(u16::from_le_bytes(*row.get(2 * at..)?.first_chunk()?)) / 65535.0)
            }
            _ => float(row, at),
        };
        // A vertex without coordinates shows the corner of the texture.
        Ok(Some(move |vertex| {
            let row = rows.row(vertex).unwrap_or_default();
            let uv = [number(row, 0), number(row, 1)].map(Option::unwrap_or_default);
            shown.placed(uv)
        }))
    }

    fn rows(&self, accessor: usize) -> Result<Rows<'_>, MeshError> {
        let accessor = self.scenes.accessors.get(accessor);
        let accessor = accessor.ok_or_else(|| problem("an accessor is not there"))?;
        let view = accessor
            .buffer_view
            .and_then(|own| self.scenes.buffer_views.get(own));
        let (Some(view), None) = (view, &accessor.sparse) else {
            return Err(problem("sparse accessors are not read: export it without"));
        };
        let bytes = buffers::view(&self.buffers, view)?
            .get(accessor.byte_offset..)
            .ok_or_else(|| problem("the file is cut short"))?;
        let own = match (accessor.component_type, accessor.kind.as_str()) {
            (5126, "VEC3") => 12,
            (5126, "VEC2") => 8,
            (5123, "VEC2") | (5125, "SCALAR") => 4,
            (5121, "VEC2") | (5123, "SCALAR") => 2,
            (5121, "SCALAR") => 1,
            (kind, form) => {
                let what = format!("an accessor of {form} of type {kind} is not read");
                return Err(problem(what));
            }
        };
        let rows = Rows {
            accessor,
            bytes,
            stride: view.byte_stride.unwrap_or(own).max(1),
            size: own,
        };
        // The count is what loops go by.
        let last = accessor.count.checked_sub(1);
        if last.is_some_and(|last| rows.row(last).is_none()) {
            return Err(problem("the file is cut short"));
        }
        Ok(rows)
    }
}

/// The nodes of the scene that is shown first; without a scene those that are nobody's child.
fn roots(scenes: &Scenes) -> Vec<usize> {
    if let Some(scene) = scenes.list.get(scenes.scene.unwrap_or(0)) {
        return scene.nodes.clone();
    }
    let mut root = vec![true; scenes.nodes.len()];
    for &child in scenes.nodes.iter().flat_map(|node| &node.children) {
        if let Some(root) = root.get_mut(child) {
            *root = false;
        }
    }
    (0..root.len()).filter(|&node| root[node]).collect()
}

fn float(row: &[u8], at: usize) -> Option<f64> {
    let four = row.get(4 * at..)?.first_chunk::<4>()?;
    Some(f64::from(f32::from_le_bytes(*four)))
}

/// The numbers of an accessor.
struct Rows<'d> {
    accessor: &'d Accessor,
    bytes: &'d [u8],
    stride: usize,
    size: usize,
}

impl<'d> Rows<'d> {
    fn row(&self, index: usize) -> Option<&'d [u8]> {
        let at = index.checked_mul(self.stride)?;
        self.bytes.get(at..)?.get(..self.size)
    }
}

/// Pose and size of a node in the one above it.
fn placement(node: &Node) -> Result<Matrix4<f64>, MeshError> {
    if let Some(matrix) = &node.matrix {
        return Ok(Matrix4::from_column_slice(matrix));
    }
    let [x, y, z] = node.translation.unwrap_or_default();
    let moved = Matrix4::new_translation(&nalgebra::Vector3::new(x, y, z));
    let turned = match node.rotation {
        None => Matrix4::identity(),
        Some([x, y, z, w]) => UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
            .ok_or_else(|| problem("a rotation is not a unit quaternion"))?
            .to_homogeneous(),
    };
    let [x, y, z] = node.scale.unwrap_or([1.0; 3]);
    Ok(moved * turned * Matrix4::new_nonuniform_scaling(&nalgebra::Vector3::new(x, y, z)))
}

/// A linear part of a colour as screens take it (IEC 61966-2-1).
fn displayed(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests;
