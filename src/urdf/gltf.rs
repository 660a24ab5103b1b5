//! Binary glTF 2.0 (`.glb`) → points and triangles by colour: meshes placed by the nodes of the
//! scene, in m.
//!
//! glTF has its y axis upwards, and nothing is turned for that: exporters of robots, `SAPIEN`,
//! Genesis, three.js loaders and trimesh take the file's axes as those of the link. Points and
//! lines are skipped, a skinned mesh stands in its bind pose, a morphed one at rest. Textures are
//! not read.
//!
//! Source: Khronos Group, "glTF 2.0 specification", ISO/IEC 12113.

use super::faces::{MeshError, Paint, Part, Parts};
use crate::spatial::Vec3;
use nalgebra::{Matrix4, Point3, Quaternion, UnitQuaternion};
use serde::Deserialize;

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

/// Corners of all triangles in the scene.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Vec3>, MeshError> {
    let mut points = Vec::new();
    triangles_of(bytes, |_, triangle| points.extend(triangle))?;
    Ok(points)
}

/// All triangles in the scene.
pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    let mut triangles = Vec::new();
    triangles_of(bytes, |_, triangle| triangles.push(triangle))?;
    Ok(triangles)
}

/// All triangles in the scene, by their colours.
pub(super) fn parts(bytes: &[u8]) -> Result<Vec<Part>, MeshError> {
    let mut parts = Parts::default();
    triangles_of(bytes, |paint, triangle| {
        parts.of(paint, false).push(triangle, None);
    })?;
    parts.finish()
}

fn problem(what: impl Into<String>) -> MeshError {
    MeshError::Content(what.into())
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Scenes {
    #[serde(default)]
    extensions_required: Vec<String>,
    scene: Option<usize>,
    #[serde(default, rename = "scenes")]
    list: Vec<SceneNodes>,
    #[serde(default)]
    nodes: Vec<Node>,
    #[serde(default)]
    meshes: Vec<Mesh>,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    buffer_views: Vec<View>,
    #[serde(default)]
    buffers: Vec<Buffer>,
    #[serde(default)]
    materials: Vec<Material>,
}

#[derive(Deserialize)]
struct SceneNodes {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct Node {
    #[serde(default)]
    children: Vec<usize>,
    mesh: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
struct Mesh {
    #[serde(default)]
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    material: Option<usize>,
    #[serde(default = "triangle_list")]
    mode: u32,
}

fn triangle_list() -> u32 {
    4
}

#[derive(Deserialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Material {
    pbr_metallic_roughness: Option<Pbr>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Pbr {
    base_color_factor: Option<[f64; 4]>,
    base_color_texture: Option<serde::de::IgnoredAny>,
}

/// The JSON and the binary chunk.
fn chunks(bytes: &[u8]) -> Result<(&[u8], &[u8]), MeshError> {
    let word = |at: usize| {
        let four = bytes.get(at..)?.first_chunk::<4>()?;
        usize::try_from(u32::from_le_bytes(*four)).ok()
    };
    if !bytes.starts_with(b"glTF") {
        return Err(problem("no binary glTF file"));
    }
    match word(4) {
        Some(2) => {}
        Some(version) => {
            let what = format!("it is glTF {version}; glTF 2 is read");
            return Err(problem(what));
        }
        None => return Err(problem("the file is cut short")),
    }
    let chunk = |at: usize, kind: &[u8; 4]| {
        let length = word(at)?;
        let body = bytes.get(at + 8..)?.get(..length)?;
        (bytes.get(at + 4..at + 8)? == kind).then_some(body)
    };
    let json = chunk(12, b"JSON").ok_or_else(|| problem("the file is cut short"))?;
    // Chunks end on multiples of four bytes.
    let next = 20 + json.len().next_multiple_of(4);
    Ok((json, chunk(next, b"BIN\0").unwrap_or_default()))
}

/// Shows every triangle of the scene, placed, with its colour.
fn triangles_of(bytes: &[u8], mut show: impl FnMut(&Paint, [Vec3; 3])) -> Result<(), MeshError> {
    let (json, binary) = chunks(bytes)?;
    let scenes: Scenes =
        serde_json::from_slice(json).map_err(|error| problem(format!("its JSON: {error}")))?;
    let required = &scenes.extensions_required;
    if let Some(name) = required.iter().find(|name| PACKED.contains(&name.as_str())) {
        let what = format!("it needs {name}, which is not read: export it without");
        return Err(problem(what));
    }
    let mut left = MOST_TRIANGLES;
    let mut shown = vec![false; scenes.nodes.len()];
    let mut open: Vec<(usize, Matrix4<f64>, usize)> = scenes
        .roots()
        .into_iter()
        .rev()
        .map(|node| (node, Matrix4::identity(), 0))
        .collect();
    while let Some((index, above, depth)) = open.pop() {
        let node = scenes.nodes.get(index);
        let node = node.ok_or_else(|| problem(format!("there is no node {index}")))?;
        if std::mem::replace(&mut shown[index], true) || depth > DEEPEST {
            return Err(problem(format!("node {index} stands in the scene twice")));
        }
        let placed = above * node.placement()?;
        let children = node.children.iter().rev();
        open.extend(children.map(|&child| (child, placed, depth + 1)));
        let Some(mesh) = node.mesh else {
            continue;
        };
        let mesh = scenes.meshes.get(mesh);
        let mesh = mesh.ok_or_else(|| problem(format!("node {index} shows no mesh")))?;
        for primitive in &mesh.primitives {
            scenes.primitive(binary, primitive, &placed, &mut left, &mut show)?;
        }
    }
    Ok(())
}

impl Scenes {
    /// The nodes of the scene that is shown first; without a scene those that are nobody's child.
    fn roots(&self) -> Vec<usize> {
        if let Some(scene) = self.list.get(self.scene.unwrap_or(0)) {
            return scene.nodes.clone();
        }
        let mut root = vec![true; self.nodes.len()];
        for &child in self.nodes.iter().flat_map(|node| &node.children) {
            if let Some(root) = root.get_mut(child) {
                *root = false;
            }
        }
        (0..root.len()).filter(|&node| root[node]).collect()
    }

    fn primitive(
        &self,
        binary: &[u8],
        primitive: &Primitive,
        placed: &Matrix4<f64>,
        left: &mut usize,
        show: &mut impl FnMut(&Paint, [Vec3; 3]),
    ) -> Result<(), MeshError> {
        // Points and lines.
        if !(4..=6).contains(&primitive.mode) {
            return Ok(());
        }
        let Some(position) = primitive.attributes.position else {
            return Ok(());
        };
        let rows = self.rows(binary, position)?;
        if (rows.accessor.component_type, rows.accessor.kind.as_str()) != (5126, "VEC3") {
            return Err(problem("a position is not three floats"));
        }
        let point = |index: usize| {
            let row = rows.row(index)?;
            let number = |at: usize| {
                let four = row.get(4 * at..)?.first_chunk::<4>()?;
                Some(f64::from(f32::from_le_bytes(*four)))
            };
            let point = Point3::new(number(0)?, number(1)?, number(2)?);
            Some(placed.transform_point(&point).coords)
        };
        let indices = primitive.indices.map(|own| self.rows(binary, own));
        let indices = indices.transpose()?;
        let count = indices.as_ref().unwrap_or(&rows).accessor.count;
        let corner = |at: usize| match &indices {
            None => point(at),
            Some(indices) => {
                let row = indices.row(at)?;
                let index = match indices.accessor.component_type {
                    5121 => u32::from(*row.first()?),
                    5123 => u32::from(u16::from_le_bytes(*row.first_chunk()?)),
                    5125 => u32::from_le_bytes(*row.first_chunk()?),
                    _ => return None,
                };
                point(usize::try_from(index).ok()?)
            }
        };
        let paint = self.paint(primitive.material);
        let triangles = match primitive.mode {
            4 => count / 3,
            _ => count.saturating_sub(2),
        };
        *left = left
            .checked_sub(triangles)
            .ok_or_else(|| problem(format!("it has more than {MOST_TRIANGLES} triangles")))?;
        for k in 0..triangles {
            let corners = match primitive.mode {
                4 => [3 * k, 3 * k + 1, 3 * k + 2],
                // A strip turns every second triangle over.
                5 => [k, k + 1 + k % 2, k + 2 - k % 2],
                _ => [0, k + 1, k + 2],
            };
            let [a, b, c] = corners.map(corner);
            let (Some(a), Some(b), Some(c)) = (a, b, c) else {
                return Err(problem("a triangle names a vertex that is not there"));
            };
            show(&paint, [a, b, c]);
        }
        Ok(())
    }

    /// What a material is seen as without light: colours of the file are linear.
    fn paint(&self, material: Option<usize>) -> Paint {
        let pbr = material
            .and_then(|own| self.materials.get(own)?.pbr_metallic_roughness.as_ref())
            .filter(|pbr| pbr.base_color_texture.is_none());
        let color = pbr.and_then(|pbr| pbr.base_color_factor);
        Paint {
            color: color.map(|[red, green, blue, _]| [red, green, blue].map(displayed)),
            image: None,
        }
    }

    fn rows<'d>(&'d self, binary: &'d [u8], accessor: usize) -> Result<Rows<'d>, MeshError> {
        let accessor = self.accessors.get(accessor);
        let accessor = accessor.ok_or_else(|| problem("an accessor is not there"))?;
        let view = accessor
            .buffer_view
            .and_then(|own| self.buffer_views.get(own));
        let (Some(view), None) = (view, &accessor.sparse) else {
            return Err(problem("sparse accessors are not read: export it without"));
        };
        let outside = self
            .buffers
            .get(view.buffer)
            .is_some_and(|own| own.uri.is_some());
        if view.buffer != 0 || outside {
            return Err(problem("it names other files: export one .glb file"));
        }
        let bytes = binary
            .get(view.byte_offset..)
            .and_then(|rest| rest.get(..view.byte_length)?.get(accessor.byte_offset..))
            .ok_or_else(|| problem("the file is cut short"))?;
        let own = match (accessor.component_type, accessor.kind.as_str()) {
            (5126, "VEC3") => 12,
            (5121, "SCALAR") => 1,
            (5123, "SCALAR") => 2,
            (5125, "SCALAR") => 4,
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

impl Node {
    fn placement(&self) -> Result<Matrix4<f64>, MeshError> {
        if let Some(matrix) = &self.matrix {
            return Ok(Matrix4::from_column_slice(matrix));
        }
        let [x, y, z] = self.translation.unwrap_or_default();
        let moved = Matrix4::new_translation(&nalgebra::Vector3::new(x, y, z));
        let turned = match self.rotation {
            None => Matrix4::identity(),
            Some([x, y, z, w]) => UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
                .ok_or_else(|| problem("a rotation is not a unit quaternion"))?
                .to_homogeneous(),
        };
        let [x, y, z] = self.scale.unwrap_or([1.0; 3]);
        Ok(moved * turned * Matrix4::new_nonuniform_scaling(&nalgebra::Vector3::new(x, y, z)))
    }
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
