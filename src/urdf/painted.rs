//! Mesh files → triangles by colour and texture, for drawing: STL, PLY, OBJ with MTL,
//! COLLADA, glTF.
//!
//! Where a triangle has no material, or one that is not understood, it has no colour: whoever draws
//! it takes the visual's. Texture coordinates that are not there are no fault either.

mod obj;

use super::collada;
pub(super) use super::faces::Part;
use super::faces::{MeshError, Paint, Parts};
use super::mesh::MeshFile;

/// The painted triangles of a mesh file.
///
/// - `beside`: text of a file that the mesh names, `None` where it cannot be had
pub(super) fn parts(
    file: &MeshFile,
    beside: impl Fn(&str) -> Option<String>,
) -> Result<Vec<Part>, MeshError> {
    if let Some(scene) = file.gltf() {
        return scene.parts();
    }
    match file.kind() {
        "obj" => obj::parts(&String::from_utf8_lossy(file.bytes()), beside),
        "dae" => collada::parts(file.bytes(), file.known()),
        _ => {
            let mut parts = Parts::default();
            let part = parts.of(&Paint::default(), false);
            for triangle in file.triangles()? {
                part.push(triangle, None);
            }
            parts.finish()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::faces::Image;
    use super::*;
    use crate::spatial::Vec3;
    use std::path::Path;

    const TEXTURED: &str = "<COLLADA version='1.4.1'><asset><unit meter='0.5'/></asset>
        <library_images><image id='i'><init_from>./a%20b.png</init_from></image></library_images>
        <library_effects><effect id='e'><profile_COMMON>
          <newparam sid='u'><surface type='2D'><init_from>i</init_from></surface></newparam>
          <newparam sid='p'><sampler2D><source>u</source></sampler2D></newparam>
          <technique sid='t'><phong><diffuse><texture texture='p' texcoord='UV'/></diffuse></phong>
          </technique></profile_COMMON></effect></library_effects>
        <library_materials><material id='m'><instance_effect url='#e'/></material></library_materials>
        <library_geometries><geometry id='g'><mesh>
          <source id='s'><float_array count='9'>0 0 0 2 0 0 0 4 0</float_array>
            <technique_common><accessor count='3' stride='3'/></technique_common></source>
          <source id='w'><float_array count='6'>0 0 1 0 0 1</float_array>
            <technique_common><accessor count='3' stride='2'/></technique_common></source>
          <vertices id='v'><input semantic='POSITION' source='#s'/></vertices>
          <triangles count='1' material='x'><input semantic='VERTEX' source='#v' offset='0'/>
            <input semantic='TEXCOORD' source='#w' offset='1' set='0'/><p>0 0 1 1 2 2</p></triangles>
          <triangles count='1'><input semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p></triangles>
        </mesh></geometry></library_geometries>
        <library_visual_scenes><visual_scene id='c'><node><instance_geometry url='#g'>
          <bind_material><technique_common><instance_material symbol='x' target='#m'/>
          </technique_common></bind_material></instance_geometry></node></visual_scene>
        </library_visual_scenes><scene><instance_visual_scene url='#c'/></scene></COLLADA>";

    #[test]
    fn a_texture_of_collada_is_found_through_sampler_surface_and_image() {
        let parts =
            collada::parts(TEXTURED.as_bytes(), &collada::Known::default()).expect("a scene");
        assert_eq!(parts.len(), 2);
        let image = Image::Named("./a%20b.png".to_owned());
        assert_eq!(parts[0].paint.image, Some(image));
        assert_eq!(parts[0].uv, [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]);
        assert_eq!(parts[1].paint, Paint::default());
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Vec3::from);
        assert_eq!(parts[0].whole(), [corners]);
        assert_eq!(parts[1].whole(), [corners]);
    }

    /// Random changes to valid files: triangles or an error, never a panic, and as many texture
    /// coordinates as triangles where there is a texture.
    #[test]
    fn mutated_meshes_with_materials_never_panic() {
        const OBJ: &str = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\n\
                           vt 1 0\nvt 0.5 1\nf 1/1 2/2 3/3\nusemtl b\nf 1/1/1 3/-1 4//2 -2\n";
        let library = |_: &str| Some("newmtl a\nKd 1 0 0\nnewmtl b\nmap_Kd -s 1 1 x.png\n".into());
        let mut random = crate::testing::Random(0x5DEE_CE66);
        let mut read_well = [0; 2];
        for _ in 0..4000 {
            for (kind, text) in [OBJ, TEXTURED].iter().enumerate() {
                let mut bytes = text.as_bytes().to_vec();
                for _ in 0..=random.below(3) {
                    let at = random.below(bytes.len());
                    match random.below(3) {
                        0 => bytes.insert(at, b"0123456789-.e <>\"/#"[random.below(19)]),
                        1 => drop(bytes.drain(at..(at + random.below(20)).min(bytes.len()))),
                        _ => bytes[at] = u8::try_from(random.below(256)).unwrap_or(0),
                    }
                }
                let parts = match kind {
                    0 => obj::parts(&String::from_utf8_lossy(&bytes), library),
                    _ => collada::parts(&bytes, &collada::Known::default()),
                };
                for part in parts.iter().flatten() {
                    let uv = part
                        .paint
                        .image
                        .as_ref()
                        .map_or(0, |_| part.triangles.len());
                    assert_eq!(part.uv.len(), uv);
                }
                read_well[kind] += usize::from(parts.is_ok());
            }
        }
        assert!(read_well.iter().all(|&n| n > 400), "{read_well:?}");
    }

    #[test]
    fn the_meshes_of_the_tests_have_the_triangles_that_decomposition_sees() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots/meshes");
        for name in ["ascii.STL", "solid.stl", "corner.obj", "corner.dae"] {
            let file = MeshFile::open(&folder.join(name), &|_| None).expect("a mesh");
            let parts = parts(&file, |_| None).expect("a mesh");
            let drawn: Vec<_> = parts.iter().flat_map(Part::whole).collect();
            assert_eq!(drawn, file.triangles().expect("a mesh"), "{name}");
        }
    }
}
