//! Meshes in glTF with files beside them.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use std::path::Path;
use urdf2fmu_core::diagnostic::Severity;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::urdf::{ReadOptions, read_str};

/// glTF with its numbers and its image beside it, in a URI and in one file.
#[test]
fn a_gltf_collides_and_is_drawn_with_its_texture_from_wherever_its_files_are() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gltf");
    std::fs::create_dir_all(&folder).expect("target/ is writable");
    let corners = [
        [0.0_f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let uv = [[0.0_f32, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let mut numbers: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    numbers.extend(uv.iter().flatten().flat_map(|x| x.to_le_bytes()));
    numbers.extend([0_u8, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]);
    // Signature, length and name of the chunk, four pixels wide and two high.
    let mut image = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x04\0\0\0\x02".to_vec();
    image.extend([0; 8]);
    let json = |buffer: &str, image: &str| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}],
            "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}},
                "indices": 2, "material": 0}}]}}],
            "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}],
            "textures": [{{"source": 0}}], "images": [{image}],
            "accessors": [
                {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
                {{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"}},
                {{"bufferView": 2, "componentType": 5121, "count": 12, "type": "SCALAR"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 48}},
                {{"buffer": 0, "byteOffset": 48, "byteLength": 32}},
                {{"buffer": 0, "byteOffset": 80, "byteLength": 12}}],
            "buffers": [{{{buffer} "byteLength": 92}}]}}"#
        )
    };
    let uri = |bytes: &[u8]| format!("data:;base64,{}", BASE64_STANDARD.encode(bytes));
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).expect(name);
    write("n 1.bin", &numbers);
    write("t.png", &image);
    let beside = json(r#""uri": "n%201.bin","#, r#"{"uri": "t.png"}"#);
    write("a.gltf", beside.as_bytes());
    let held = json(
        &format!(r#""uri": "{}","#, uri(&numbers)),
        &format!(r#"{{"uri": "{}"}}"#, uri(&image)),
    );
    write("b.GLTF", held.as_bytes());
    let mut inside = json("", r#"{"uri": "t.png"}"#).into_bytes();
    inside.resize(inside.len().next_multiple_of(4), b' ');
    let mut binary = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", &inside), (b"BIN\0", &numbers)] {
        binary.extend(u32::try_from(chunk.len()).expect("short").to_le_bytes());
        binary.extend(kind);
        binary.extend(chunk);
    }
    write("c.glb", &binary);
    let options = ReadOptions {
        drawn: true,
        ..ReadOptions::default()
    };
    let robot = |mesh: &str| {
        let shape = format!("<geometry><mesh filename='{mesh}'/></geometry>");
        let text = format!(
            "<robot name='r'><link name='a'><visual>{shape}</visual>\
             <collision>{shape}</collision></link></robot>"
        );
        read_str(&text, "r.urdf", &folder, &options)
    };
    for (mesh, sources) in [("a.gltf", 2), ("b.GLTF", 1), ("c.glb", 1)] {
        let robot = robot(mesh).unwrap_or_else(|list| panic!("{mesh}: {list:?}"));
        assert!(
            robot
                .diagnostics
                .iter()
                .all(|d| d.severity == Severity::Note)
        );
        let Shape::Hull { vertices } = &robot.links[0].collisions[0].shape else {
            panic!("{mesh}: no hull");
        };
        assert_eq!(vertices.len(), 4, "{mesh}");
        assert_eq!(robot.sources.len(), sources, "{mesh}: {:?}", robot.sources);
        let part = &robot.drawn_meshes[0].parts[0];
        assert_eq!((part.triangles.len(), part.texture), (4, Some(0)), "{mesh}");
        // The image counts from above, the description from below.
        assert_eq!(part.uv[0], [[0.0, 1.0], [0.0, 0.0], [1.0, 1.0]], "{mesh}");
        let texture = &robot.textures[0];
        assert_eq!((texture.width, texture.height), (4, 2), "{mesh}");
        assert_eq!(texture.bytes, image, "{mesh}");
    }
    // What is not there is an error for what collides, told with its name.
    write("d.gltf", json(r#""uri": "nowhere.bin","#, "{}").as_bytes());
    let list = robot("d.gltf").expect_err("no numbers");
    assert!(
        list.iter()
            .any(|d| d.code == "U105" && d.message.contains("nowhere.bin")),
        "{list:?}"
    );
}
