//! The JSON of glTF 2.0, as far as it is used.

use serde::Deserialize;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Scenes {
    #[serde(default)]
    pub(super) asset: Asset,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    pub(super) scene: Option<usize>,
    #[serde(default, rename = "scenes")]
    pub(super) list: Vec<SceneNodes>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<View>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) materials: Vec<Material>,
    #[serde(default)]
    pub(super) textures: Vec<Texture>,
    #[serde(default)]
    pub(super) images: Vec<Image>,
}

/// What the file is written by.
#[derive(Default, Deserialize)]
pub(super) struct Asset {
    /// Of the standard, such as `2.0`; as no file may be without.
    #[serde(default)]
    pub(super) version: String,
}

#[derive(Deserialize)]
pub(super) struct SceneNodes {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    #[serde(default)]
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    #[serde(default)]
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    #[serde(default = "triangle_list")]
    pub(super) mode: u32,
}

fn triangle_list() -> u32 {
    4
}

/// Accessors by the names of what they hold.
#[derive(Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) position: Option<usize>,
    #[serde(rename = "TEXCOORD_0")]
    texture_0: Option<usize>,
    #[serde(rename = "TEXCOORD_1")]
    texture_1: Option<usize>,
}

impl Attributes {
    /// The texture coordinates of a set; more than two sets are not needed for a colour.
    pub(super) fn texture(&self, set: usize) -> Option<usize> {
        match set {
            0 => self.texture_0,
            1 => self.texture_1,
            _ => None,
        }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) pbr_metallic_roughness: Option<Pbr>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Pbr {
    pub(super) base_color_factor: Option<[f64; 4]>,
    pub(super) base_color_texture: Option<TextureUse>,
}

/// Where a material shows a texture.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureUse {
    pub(super) index: usize,
    #[serde(default)]
    tex_coord: usize,
    #[serde(default)]
    extensions: UseExtensions,
}

#[derive(Default, Deserialize)]
struct UseExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<Transform>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Transform {
    #[serde(default)]
    offset: [f64; 2],
    #[serde(default)]
    rotation: f64,
    #[serde(default = "unit")]
    scale: [f64; 2],
    tex_coord: Option<usize>,
}

fn unit() -> [f64; 2] {
    [1.0; 2]
}

impl TextureUse {
    /// Which set of texture coordinates it takes.
    pub(super) fn set(&self) -> usize {
        let own = self.extensions.transform.as_ref();
        own.and_then(|own| own.tex_coord).unwrap_or(self.tex_coord)
    }

    /// Texture coordinates from the lower left corner, of those of the file, which count from the
    /// upper left one.
    pub(super) fn placed(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let Some(own) = &self.extensions.transform else {
            return [u, 1.0 - v];
        };
        let (sin, cos) = libm::sincos(own.rotation);
        let [u, v] = [u * own.scale[0], v * own.scale[1]];
        // The matrix of KHR_texture_transform.
        let [u, v] = [
            u * cos + v * sin + own.offset[0],
            v * cos - u * sin + own.offset[1],
        ];
        [u, 1.0 - v]
    }
}

#[derive(Deserialize)]
pub(super) struct Texture {
    source: Option<usize>,
    #[serde(default)]
    extensions: TextureExtensions,
}

/// Images in other formats, which stand in place of `source` or beside it.
#[derive(Default, Deserialize)]
struct TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<OtherSource>,
    #[serde(rename = "KHR_texture_basisu")]
    basisu: Option<OtherSource>,
}

#[derive(Deserialize)]
struct OtherSource {
    source: usize,
}

impl Texture {
    /// Its image, one that others than this reader can show if there is no other.
    pub(super) fn image(&self) -> Option<usize> {
        let others = [&self.extensions.webp, &self.extensions.basisu];
        let other = || others.into_iter().flatten().next().map(|own| own.source);
        self.source.or_else(other)
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<usize>,
}
