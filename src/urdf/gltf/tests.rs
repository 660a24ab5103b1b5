use super::*;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

fn file(bytes: &[u8]) -> Result<File, MeshError> {
    File::read(bytes, |_| None)
}

fn read(bytes: &[u8]) -> Result<Vec<Vec3>, MeshError> {
    file(bytes)?.corners()
}

fn triangles(bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    file(bytes)?.triangles()
}

fn parts(bytes: &[u8]) -> Result<Vec<Part>, MeshError> {
    file(bytes)?.parts()
}

/// A file of JSON and numbers: floats, then indices.
fn glb(json: &str, floats: &[f32], indices: &[u16]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    binary.extend(indices.iter().flat_map(|x| x.to_le_bytes()));
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        bytes.extend(u32::try_from(chunk.len()).expect("short").to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

const CORNERS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 2.0, 3.0];
const INDICES: [u16; 4] = [0, 1, 2, 3];

/// Two nodes, one in the other, that show a mesh of one primitive.
fn scene(primitive: &str) -> String {
    format!(
        r#"{{"scene": 0, "scenes": [{{"nodes": [1]}}],
        "nodes": [{{"mesh": 0, "scale": [2, 2, 2]}},
            {{"children": [0], "translation": [0, 0, 10],
              "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]}}],
        "meshes": [{{"primitives": [{primitive}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorFactor": [1, 0.5, 0, 1]}}}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
            {{"bufferView": 1, "componentType": 5123, "count": 4, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}},
            {{"buffer": 0, "byteOffset": 48, "byteLength": 8}}],
        "buffers": [{{"byteLength": 56}}]}}"#
    )
}

const PRIMITIVE: &str =
    r#"{"attributes": {"POSITION": 0}, "indices": 1, "material": 0, "mode": 5}"#;

#[test]
fn a_strip_is_placed_by_the_nodes_above_it() {
    let bytes = glb(&scene(PRIMITIVE), &CORNERS, &INDICES);
    // Twice as large, a quarter turn about z, ten up.
    let [a, b, c, d] = [
        [0.0, 0.0, 10.0],
        [0.0, 2.0, 10.0],
        [-4.0, 2.0, 10.0],
        [-4.0, 0.0, 16.0],
    ]
    .map(Vec3::from);
    let found = triangles(&bytes).expect("two triangles");
    for (found, expected) in found.iter().flatten().zip([a, b, c, b, d, c]) {
        assert!((found - expected).norm() < 1e-12, "{found} {expected}");
    }
    assert_eq!(found.len(), 2);
    assert_eq!(read(&bytes).expect("corners"), found.concat());
    let parts = parts(&bytes).expect("two triangles");
    assert_eq!(parts.len(), 1);
    assert_eq!(parts[0].whole(), found);
    // Of half the light a screen shows 0.7354 (IEC 61966-2-1).
    let [red, green, blue] = parts[0].paint.color.expect("a colour");
    assert!((red - 1.0).abs() < 1e-15 && blue.abs() < 1e-15);
    assert!((green - 0.735_357).abs() < 1e-6, "{green}");
}

/// ISO/IEC 12113, 3.7.4: a node with a negative determinant turns the winding of its triangles
/// over. The normal of the first triangle is z, which a mirror at x = 0 keeps.
#[test]
fn mirrored_nodes_keep_their_outside() {
    for scale in ["[2, 2, 2]", "[-2, 2, 2]", "[-2, -2, 2]"] {
        let json = scene(PRIMITIVE).replace("[2, 2, 2]", scale);
        let found = triangles(&glb(&json, &CORNERS, &INDICES)).expect("two triangles");
        let [a, b, c] = found[0];
        let normal = (b - a).cross(&(c - a)).normalize();
        assert!((normal - Vec3::z()).norm() < 1e-12, "{scale}: {normal}");
    }
}

#[test]
fn triangles_without_indices_and_fans_are_read() {
    let list = glb(
        &scene(r#"{"attributes": {"POSITION": 0}}"#),
        &CORNERS,
        &INDICES,
    );
    assert_eq!(triangles(&list).map(|found| found.len()), Ok(1));
    let fan = glb(
        &scene(r#"{"attributes": {"POSITION": 0}, "mode": 6}"#),
        &CORNERS,
        &[],
    );
    assert_eq!(triangles(&fan).map(|found| found.len()), Ok(2));
    let lines = glb(
        &scene(r#"{"attributes": {"POSITION": 0}, "mode": 1}"#),
        &CORNERS,
        &[],
    );
    assert_eq!(triangles(&lines).map(|found| found.len()), Ok(0));
}

#[test]
fn what_cannot_be_read_is_told() {
    for (from, to, what) in [
        (
            "\"scene\": 0",
            "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"]",
            "draco",
        ),
        ("[{\"nodes\": [1]}]", "[{\"nodes\": [1, 0]}]", "twice"),
        ("\"children\": [0]", "\"children\": [1]", "twice"),
        ("\"children\": [0]", "\"children\": [7]", "no node 7"),
        ("\"mesh\": 0", "\"mesh\": 3", "shows no mesh"),
        ("5126", "5122", "not read"),
        ("5123", "5126", "not read"),
        (
            "\"count\": 4, \"type\": \"VEC3\"",
            "\"count\": 5, \"type\": \"VEC3\"",
            "cut short",
        ),
        ("\"byteLength\": 48", "\"byteLength\": 12", "cut short"),
        (
            "{\"byteLength\": 56}",
            "{\"uri\": \"a.bin\"}",
            "a.bin is not beside it",
        ),
        (
            "{\"byteLength\": 56}",
            "{\"uri\": \"data:,abc\"}",
            "not in base64",
        ),
        (
            "{\"byteLength\": 56}",
            "{\"uri\": \"data:;base64,A*A\"}",
            "no base64",
        ),
        ("\"buffer\": 0", "\"buffer\": 3", "no buffer 3"),
        ("{\"bufferView\": 0, ", "{", "sparse"),
        (
            "\"rotation\": [0, 0, 0.7071067811865476,",
            "\"rotation\": [0, 0, 0,",
            "",
        ),
        ("\"meshes\"", "meshes", "its JSON"),
    ] {
        let whole = scene(PRIMITIVE);
        let broken = whole.replacen(from, to, 1);
        assert_ne!(broken, whole, "{from}");
        let told = read(&glb(&broken, &CORNERS, &INDICES));
        if what.is_empty() {
            // A quaternion of another length is made one of length 1.
            assert!(told.is_ok(), "{told:?}");
            continue;
        }
        let told = told.expect_err(from).to_string();
        assert!(told.contains(what), "{told}");
    }
    let bytes = glb(&scene(PRIMITIVE), &CORNERS, &[0, 1, 2, 9]);
    assert!(read(&bytes).is_err_and(|error| error.to_string().contains("not there")));
    let bytes = glb(&scene(PRIMITIVE), &CORNERS, &INDICES);
    for end in 0..bytes.len() {
        assert!(read(&bytes[..end]).is_err(), "{end}");
    }
    let old = [&bytes[..4], &[1], &bytes[5..]].concat();
    assert!(read(&old).is_err_and(|error| error.to_string().contains("glTF 1")));
}

/// A picture is what its bytes are: whether they can be shown is asked later.
const PICTURE: &[u8] = b"a picture";

/// [`scene`] with the corners' texture coordinates behind their places, and an image.
fn textured(how: &str, image: &str) -> String {
    let primitive = r#"{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "material": 0, "mode": 5}"#;
    let accessor = r#"{"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}"#;
    let color = r#""baseColorFactor": [1, 0.5, 0, 1]"#;
    scene(primitive)
        .replace(
            color,
            &format!(r#"{color}, "baseColorTexture": {{"index": 0{how}}}"#),
        )
        .replace(
            "\"SCALAR\"}]",
            &format!(
                "\"SCALAR\"}}, {accessor}], \"textures\": [{{\"source\": 0}}], \"images\": [{image}]"
            ),
        )
        .replace(
            "\"byteLength\": 8}]",
            "\"byteLength\": 8}, {\"buffer\": 0, \"byteOffset\": 56, \"byteLength\": 32},
             {\"buffer\": 0, \"byteOffset\": 88, \"byteLength\": 9}]",
        )
}

/// Places, indices, texture coordinates (a corner for each vertex) and the picture.
fn numbers() -> Vec<u8> {
    let mut bytes: Vec<u8> = CORNERS.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(INDICES.iter().flat_map(|x| x.to_le_bytes()));
    let uv = [0.0_f32, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0];
    bytes.extend(uv.iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(PICTURE);
    bytes
}

/// The specification counts texture coordinates from the upper left corner of the image, this
/// program from the lower left one.
#[test]
fn a_texture_is_taken_from_the_file_from_beside_it_or_from_a_uri() {
    let uri = |bytes: &[u8]| format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes));
    let held = Image::Held(PICTURE.into());
    let inside = textured("", r#"{"bufferView": 3, "mimeType": "image/png"}"#);
    let beside = textured("", r#"{"uri": "a%20b.png"}"#);
    let in_uri = textured("", &format!("{{\"uri\": \"{}\"}}", uri(PICTURE)));
    let own = "\"buffers\": [{\"byteLength\": 56}]";
    let other = |json: &str, name: &str| {
        json.replace(own, &format!("\"buffers\": [{{\"uri\": \"{name}\"}}]"))
    };
    let mut asked = Vec::new();
    let found = [
        (inside.clone(), held.clone()),
        (beside, Image::Named("a%20b.png".to_owned())),
        (in_uri, held.clone()),
        (other(&inside, "a.bin"), held.clone()),
        (other(&inside, &uri(&numbers())), held.clone()),
        // Without padding.
        (other(&inside, uri(&numbers()).trim_end_matches('=')), held),
    ];
    for (json, image) in found {
        let bytes = if json.contains(own) {
            let mut bytes = glb(&json, &[], &[]);
            let length = u32::try_from(numbers().len()).expect("short");
            let end = bytes.len();
            bytes[end - 8..end - 4].copy_from_slice(&length.to_le_bytes());
            bytes.extend(numbers());
            bytes
        } else {
            json.into_bytes()
        };
        let file = File::read(&bytes, |name| {
            asked.push(name.to_owned());
            Some(Ok(numbers()))
        });
        let parts = file.and_then(|file| file.parts()).expect("two triangles");
        assert_eq!(parts.len(), 1);
        assert_eq!(parts[0].paint.image, Some(image));
        assert_eq!(parts[0].paint.color, None);
        // Half of the light is 0.7354 in sRGB (IEC 61966-2-1).
        let tint = parts[0].paint.tint.expect("a factor that is not white");
        let off = [1.0, 0.735_357, 0.0].map(f64::abs);
        let off = off.iter().zip(tint).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-6, "{tint:?}");
        // The corners 0 1 2 and 1 3 2 of the strip.
        let [a, b, c, d] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        assert_eq!(parts[0].uv, [[a, b, c], [b, d, c]]);
    }
    assert_eq!(asked, ["a.bin"]);
}

/// The example of the extension: a quarter turn against the clock, half the size, moved.
#[test]
fn a_texture_is_turned_scaled_and_moved_as_its_extension_says() {
    let how = r#", "extensions": {"KHR_texture_transform": {"offset": [0.25, 0.5],
        "rotation": 1.5707963267948966, "scale": [0.5, 2]}}"#;
    let json = textured(how, r#"{"uri": "a.png"}"#)
        .replace("{\"byteLength\": 56}", "{\"uri\": \"a.bin\"}");
    let file = File::read(json.as_bytes(), |_| Some(Ok(numbers())));
    let parts = file.and_then(|file| file.parts()).expect("two triangles");
    // Translation times rotation times scale on (1, 1): (0.25 + 2, 0.5 - 0.5).
    for (found, expected) in parts[0].uv[0]
        .iter()
        .zip([[0.25, 0.5], [0.25, 1.0], [2.25, 1.0]])
    {
        let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
        assert!(off < 1e-12, "{found:?} {expected:?}");
    }
}
