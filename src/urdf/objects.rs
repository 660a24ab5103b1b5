//! Objects of a mesh file → a hull for each.
//!
//! Programs that decompose meshes write the convex parts as objects of one file. Each part is
//! exactly convex: of 1,000 such files of `pybullet_data` the volumes of all objects are those
//! of their hulls to 1e-4. Of the public robots whose collision meshes are those that are drawn
//! none has only closed, convex objects. So a file tells by itself whether its objects are parts.

use super::decompose::enclosed;
use super::faces::{MOST_OBJECTS, scaled};
use super::mesh::MeshFile;
use crate::geometry::{BoundedHull, MOST_CORNERS, Shape, bounded_hull};
use crate::spatial::Vec3;

/// Share of its volume by which the hull of a convex object may be larger: what rounded coordinates
/// make, and far from the quarter that a mug's handle leaves open.
const CONVEX: f64 = 0.01;

/// The hulls of the objects of a file that has several, each of them a convex solid; none where it
/// is otherwise.
pub(super) fn convex(file: &MeshFile, factors: &Vec3) -> Option<Vec<BoundedHull>> {
    let objects = file.objects().ok()?;
    if !(2..=MOST_OBJECTS).contains(&objects.len()) {
        return None;
    }
    objects.iter().map(|own| solid(own, factors)).collect()
}

/// The hull of an object that is a convex solid.
fn solid(triangles: &[[Vec3; 3]], factors: &Vec3) -> Option<BoundedHull> {
    let triangles = scaled(triangles, factors);
    let volume = enclosed(&triangles)?;
    let whole = bounded_hull(triangles.as_flattened(), usize::MAX).ok()?;
    let corners = whole.vertices.clone();
    let filled = Shape::Hull { vertices: corners }.volume();
    if whole.flat || (filled - volume).abs() > CONVEX * filled {
        return None;
    }
    bounded_hull(&whole.vertices, MOST_CORNERS).ok()
}

/// The hulls of all objects of a file, whatever their shapes are.
///
/// # Errors
/// What stands against it, for people.
pub(super) fn all(file: &MeshFile, factors: &Vec3) -> Result<Vec<BoundedHull>, String> {
    let mut objects = file.objects().map_err(|error| error.to_string())?;
    if objects.is_empty() {
        objects.push(file.triangles().map_err(|error| error.to_string())?);
    }
    if objects.len() > MOST_OBJECTS {
        return Err(format!("it has more than {MOST_OBJECTS} objects"));
    }
    let hull = |own: &Vec<[Vec3; 3]>| {
        let triangles = scaled(own, factors);
        bounded_hull(triangles.as_flattened(), MOST_CORNERS).map_err(|error| error.to_string())
    };
    objects
        .iter()
        .filter(|own| !own.is_empty())
        .map(hull)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Collider;
    use crate::settings::Settings;
    use crate::urdf::{ReadOptions, read_str};
    use std::fmt::Write;
    use std::path::Path;

    /// A box as an OBJ has it, from `low` to `high`, seen from outside; `first` vertices are there.
    fn block(first: usize, low: [f64; 3], high: [f64; 3]) -> String {
        let mut text = String::new();
        for i in 0..8 {
            let at = |axis: usize| {
                if i >> axis & 1 == 0 {
                    low[axis]
                } else {
                    high[axis]
                }
            };
            let _ = writeln!(text, "v {} {} {}", at(0), at(1), at(2));
        }
        for sides in [
            "0 2 3 1", "4 5 7 6", "0 1 5 4", "2 6 7 3", "0 4 6 2", "1 3 7 5",
        ] {
            text.push('f');
            for corner in sides.split(' ') {
                let corner: usize = corner.parse().expect("a number");
                let _ = write!(text, " {}", first + corner + 1);
            }
            text.push('\n');
        }
        text
    }

    /// Two posts of 0.1 by 0.1 by 0.4 m, 0.2 m apart.
    fn posts(word: &str) -> String {
        let [left, right] = [0.0, 0.3].map(|x| ([x, 0.0, 0.0], [x + 0.1, 0.1, 0.4]));
        format!(
            "{word} left\n{}{word} right\n{}",
            block(0, left.0, left.1),
            block(8, right.0, right.1)
        )
    }

    fn parts(kind: &str, text: &str) -> Option<usize> {
        let file = MeshFile::of(kind, text.as_bytes()).expect("a file");
        Some(convex(&file, &Vec3::repeat(1.0))?.len())
    }

    #[test]
    fn convex_objects_of_an_obj_are_told_from_others() {
        assert_eq!(parts("obj", &posts("o")), Some(2));
        assert_eq!(parts("obj", &posts("g")), Some(2));
        assert_eq!(parts("obj", &posts("#")), None);
        assert_eq!(parts("obj", &block(0, [0.0; 3], [1.0; 3])), None);
        // Groups within an object are what it is painted with.
        let painted = posts("o").replace("f 1 ", "g paint\nf 1 ");
        assert_eq!(parts("obj", &painted), Some(2));
        // One side is missing, one corner is pushed in.
        let open = posts("o").replace("f 1 3 4 2\n", "");
        assert_eq!(parts("obj", &open), None);
        let dented = posts("o").replace("v 0.1 0.1 0.4", "v 0.02 0.02 0.3");
        assert_eq!(parts("obj", &dented), None);
    }

    #[test]
    fn more_objects_than_are_of_use_become_one_hull() {
        let many = |count: u32| {
            let mut text = String::new();
            for i in 0..count {
                let x = 2.0 * f64::from(i);
                let first = 8 * usize::try_from(i).expect("few");
                let own = block(first, [x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]);
                let _ = write!(text, "o b{i}\n{own}");
            }
            text
        };
        let most = u32::try_from(MOST_OBJECTS).expect("few");
        assert_eq!(parts("obj", &many(most)), Some(MOST_OBJECTS));
        assert_eq!(parts("obj", &many(most + 2)), None);
        let file = MeshFile::of("obj", many(most + 2).as_bytes()).expect("a file");
        assert!(all(&file, &Vec3::repeat(1.0)).is_err());
    }

    /// Two tetrahedra of 1/6 m³, the second one in a mirror.
    #[test]
    fn geometries_of_a_scene_and_nodes_of_gltf_are_objects() {
        let scene = "<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>
            <library_geometries><geometry id='g'><mesh>
              <source id='s'><float_array id='f' count='12'>0 0 0 1 0 0 0 1 0 0 0 1</float_array>
                <technique_common><accessor source='#f' count='4' stride='3'/></technique_common>
              </source>
              <vertices id='v'><input semantic='POSITION' source='#s'/></vertices>
              <triangles count='4'><input semantic='VERTEX' source='#v' offset='0'/>
                <p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
            </mesh></geometry></library_geometries>
            <library_visual_scenes><visual_scene id='a'>
              <node><instance_geometry url='#g'/></node>
              <node><translate>-1 0 0</translate><scale>-1 1 1</scale><instance_geometry url='#g'/>
              </node></visual_scene></library_visual_scenes>
            <scene><instance_visual_scene url='#a'/></scene></COLLADA>";
        assert_eq!(parts("dae", scene), Some(2));
        let numbers: Vec<u8> = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0_f32],
        ]
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .chain([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3])
        .collect();
        let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, numbers);
        let gltf = format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,1]}}],
            "nodes":[{{"mesh":0}},{{"mesh":0,"translation":[2,0,0]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
              {{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":48}},
              {{"buffer":0,"byteOffset":48,"byteLength":12}}],
            "buffers":[{{"byteLength":60,"uri":"data:application/octet-stream;base64,{data}"}}]}}"#
        );
        assert_eq!(parts("gltf", &gltf), Some(2));
    }

    /// By hand: two posts have 8e-3 m³, their hull 16e-3. The file is that of [`posts`].
    #[test]
    fn a_mesh_of_convex_objects_collides_as_each_of_them() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots/meshes");
        let text = |joint: &str| {
            let link = |name: &str| {
                format!(
                    r#"<link name="{name}"><inertial><mass value="1"/>
                    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
                    <collision><geometry><mesh filename="posts.obj"/></geometry></collision>
                    </link>"#
                )
            };
            format!(
                r#"<robot name="r">{}{}<joint name="j" type="{joint}"><parent link="gate"/>
                <child link="other"/><axis xyz="0 0 1"/></joint></robot>"#,
                link("gate"),
                link("other")
            )
        };
        let build = |joint: &str, settings: &str| -> (Vec<Collider>, Vec<&'static str>) {
            let settings = Settings::parse(settings, "s").expect("settings");
            let options = crate::assemble::read_options(&settings, ReadOptions::default());
            let robot = read_str(&text(joint), "r", &folder, &options).expect("a robot");
            let notes = robot.diagnostics.iter().map(|d| d.code).collect();
            let built = crate::assemble::build(&robot, &settings).expect("a model");
            (built.model.colliders, notes)
        };
        let volume = |shapes: &[Collider]| -> f64 {
            shapes.iter().map(|collider| collider.shape.volume()).sum()
        };
        let (fixed, notes) = build("fixed", "");
        assert_eq!(fixed.len(), 4);
        assert!((volume(&fixed) - 16e-3).abs() < 1e-12);
        assert!(notes.contains(&"U119") && !notes.contains(&"U110"));
        // What may be a wheel keeps its hull, unless it is asked for.
        let (turning, notes) = build("continuous", "");
        assert_eq!(turning.len(), 2);
        assert!(!notes.contains(&"U119") && notes.contains(&"U110"));
        let objects = "[link.\"*\"]\ncollision = \"objects\"\n";
        assert_eq!(build("continuous", objects).0.len(), 4);
        let (hulls, notes) = build("fixed", "[link.\"*\"]\ncollision = \"hull\"\n");
        assert!((volume(&hulls) - 32e-3).abs() < 1e-12);
        assert!(!notes.contains(&"U119") && notes.contains(&"U110"));
        // PyBullet takes the box around the mesh, whatever it is divided into.
        let of = |settings: &str| {
            let settings = format!("[robot]\ninertia = \"pybullet\"\n{settings}");
            let settings = Settings::parse(&settings, "s").expect("settings");
            let options = crate::assemble::read_options(&settings, ReadOptions::default());
            let robot = read_str(&text("revolute"), "r", &folder, &options).expect("a robot");
            let built = crate::assemble::build(&robot, &settings).expect("a model");
            built.model.links[0].inertia
        };
        assert_eq!(of(""), of("[link.\"*\"]\ncollision = \"hull\"\n"));
    }

    #[test]
    fn the_file_of_posts_is_what_these_tests_say() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots/meshes");
        let file = std::fs::read_to_string(folder.join("posts.obj")).expect("a file");
        assert_eq!(file, posts("o"));
    }
}
