//! What a robot looks like, as an FMU holds it: the bytes of the file, or, where the first byte is
//! odd, its head, a zero and its body, which are joined as the format wants it.

#[path = "../../../build/drawing/src/scene/format.rs"]
mod format;
#[path = "../../../build/drawing/src/scene/mesh.rs"]
mod mesh;
#[path = "../../../build/drawing/src/scene/pose.rs"]
mod pose;

use format::Scene;

pub fn scene(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else {
        return;
    };
    let joined = rest.iter().position(|&byte| byte == 0).and_then(|end| {
        let length = u32::try_from(end).ok()?;
        let (head, body) = (&rest[..end], &rest[end + 1..]);
        Some([&length.to_le_bytes(), head, body].concat())
    });
    let bytes = match joined {
        Some(joined) if first & 1 == 1 => joined,
        _ => rest.to_vec(),
    };
    let Ok(scene) = Scene::from_bytes(&bytes) else {
        return;
    };
    // What is accepted can be drawn.
    let head = &scene.head;
    assert_eq!(pose::link_poses(head, |_| None).len(), head.links.len());
    for mesh in &head.meshes {
        let read = scene.triangles(mesh).expect("it was checked");
        let inside = read
            .indices
            .iter()
            .flatten()
            .all(|&i| (i as usize) < mesh.vertices);
        assert!(inside && read.positions.len() == mesh.vertices);
    }
    for texture in &head.textures {
        assert_eq!(scene.image(texture).expect("checked").len(), texture.bytes);
    }
    // And it stays what it is.
    let written = scene.to_bytes().expect("what JSON can hold");
    assert_eq!(Scene::from_bytes(&written).expect("a scene"), scene);
}
