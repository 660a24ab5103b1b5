//! COLLADA (`.dae`) → points and painted triangles: geometries placed by the nodes of the scene, in
//! m by `<unit>`. Faces are read in `faces`, materials in `paint`, long rows of numbers in `words`.
//!
//! `<up_axis>` is ignored, as RViz, Gazebo, MoveIt and Pinocchio ignore it: robots are designed
//! with these programs, so the axes of the file are those of the link in any case. Lines and
//! splines are skipped; a skinned geometry stands in its bind pose.

mod faces;
mod paint;
mod words;

use super::faces::{MeshError, Part, no_number};
use super::xml::{Document, Node};
use crate::diagnostic::Report;
use crate::encoding::xml_text;
use crate::spatial::Vec3;
use nalgebra::{Matrix4, Point3, Rotation3, Unit};
use std::cell::RefCell;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

/// Most placed geometries: a part library that refers to itself must end.
const MOST_INSTANCES: usize = 10_000;

/// Most points that are kept.
const MOST_POINTS: usize = 20_000_000;

/// Long rows of numbers that have been read, by the places of their tags: both the corners and the
/// painted triangles of a mesh need them, and most of a file is numbers.
#[derive(Default)]
pub(super) struct Known {
    floats: RefCell<HashMap<usize, Arc<Vec<f64>>>>,
    indices: RefCell<HashMap<usize, Arc<Vec<Vec<u32>>>>>,
}

impl Known {
    fn floats(&self, node: Node) -> Result<Arc<Vec<f64>>, MeshError> {
        let place = node.tag_at().start;
        if let Some(known) = self.floats.borrow().get(&place) {
            return Ok(Arc::clone(known));
        }
        let read = Arc::new(numbers(node)?);
        let mut list = self.floats.borrow_mut();
        list.insert(place, Arc::clone(&read));
        Ok(read)
    }

    /// In pieces.
    fn indices(&self, node: Node) -> Arc<Vec<Vec<u32>>> {
        let mut list = self.indices.borrow_mut();
        let known = list.entry(node.tag_at().start);
        Arc::clone(known.or_insert_with(|| Arc::new(words::indices(&node.content()))))
    }
}

/// Corners of all faces in the scene, each once for each group of faces.
///
/// - `known`: of the same file
pub(super) fn read(bytes: &[u8], known: &Known) -> Result<Vec<Vec3>, MeshError> {
    with_scene(bytes, known, |scene| {
        scene.points(Scene::corners, |_, _| {})
    })
}

/// All faces in the scene, cut into triangles.
pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    let known = Known::default();
    let corners = with_scene(bytes, &known, |scene| {
        scene.points(Scene::triangle_corners, |instance, corners| {
            instance.turn(corners);
        })
    })?;
    Ok(in_threes(&corners))
}

/// The same by the geometries that the scene places.
///
/// - `known`: of the same file
pub(super) fn objects(bytes: &[u8], known: &Known) -> Result<Vec<Vec<[Vec3; 3]>>, MeshError> {
    with_scene(bytes, known, |scene| {
        let mut list = Vec::new();
        scene.points(Scene::triangle_corners, |instance, corners| {
            instance.turn(corners);
            list.push(in_threes(corners));
        })?;
        Ok(list)
    })
}

fn in_threes(corners: &[Vec3]) -> Vec<[Vec3; 3]> {
    let triangles = corners.chunks_exact(3);
    triangles.map(|t| [t[0], t[1], t[2]]).collect()
}

/// All faces in the scene, cut into triangles, by what they are painted with.
///
/// - `known`: of the same file
pub(super) fn parts(bytes: &[u8], known: &Known) -> Result<Vec<Part>, MeshError> {
    with_scene(bytes, known, |scene| scene.parts()?.finish())
}

fn with_scene<T>(
    bytes: &[u8],
    known: &Known,
    work: impl FnOnce(&Scene) -> Result<T, MeshError>,
) -> Result<T, MeshError> {
    let text = xml_text(bytes.to_vec()).map_err(|refused| match refused.declared {
        None => problem("the file is not UTF-8"),
        Some(name) => problem(&format!(
            "the file is in the encoding '{name}', which is not read, or not in it"
        )),
    })?;
    let text = text.trim_start_matches('\u{feff}');
    let mut report = Report::new("", text);
    let document = Document::parse(text, &mut report);
    let Some(document) = &document else {
        return Err(match report.finish().into_iter().next() {
            Some(finding) => MeshError::Line {
                line: finding.place.map_or(1, |place| place.line),
                what: finding.message,
            },
            None => problem("the file is not XML"),
        });
    };
    let root = document.root();
    if root.local_name() != "COLLADA" {
        return Err(problem("the root element is not <COLLADA>"));
    }
    work(&Scene::new(root, known))
}

fn problem(what: &str) -> MeshError {
    MeshError::Collada(what.to_owned())
}

struct Scene<'d> {
    root: Node<'d>,
    known: &'d Known,
    ids: HashMap<&'d str, Node<'d>>,
    /// Whether any material has a texture: without one, texture coordinates are not read.
    textured: bool,
}

/// A geometry in its place.
struct Instance<'d> {
    geometry: Node<'d>,
    /// The element that binds materials to it.
    binder: Node<'d>,
    /// From the geometry's coordinates to m.
    placed: Matrix4<f64>,
}

impl<'d> Scene<'d> {
    fn new(root: Node<'d>, known: &'d Known) -> Self {
        let mut ids = HashMap::new();
        let mut textured = false;
        for node in root.descendants() {
            textured |= node.name() == "texture";
            if let Some(id) = node.value("id") {
                ids.entry(id).or_insert(node);
            }
        }
        Self {
            root,
            known,
            ids,
            textured,
        }
    }

    fn target(&self, node: Node<'d>, attribute: &str) -> Option<Node<'d>> {
        self.ids
            .get(node.value(attribute)?.strip_prefix('#')?)
            .copied()
    }

    /// What `of` gives of every geometry, placed, after `turn`.
    fn points(
        &self,
        of: impl Fn(&Self, Node<'d>) -> Result<Vec<Vec3>, MeshError>,
        mut turn: impl FnMut(&Instance, &mut [Vec3]),
    ) -> Result<Vec<Vec3>, MeshError> {
        let mut all = Vec::new();
        // Points of a geometry, by the place of its tag.
        let mut geometries: HashMap<usize, Vec<Vec3>> = HashMap::new();
        for instance in self.instances()? {
            let points = match geometries.entry(instance.geometry.tag_at().start) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(of(self, instance.geometry)?),
            };
            if all.len() + points.len() > MOST_POINTS {
                return Err(too_many_points());
            }
            let first = all.len();
            all.extend(points.iter().map(|p| instance.point(p)));
            turn(&instance, &mut all[first..]);
        }
        Ok(all)
    }

    /// Every geometry in its place, in the order of the scene.
    fn instances(&self) -> Result<Vec<Instance<'d>>, MeshError> {
        let unit = self.unit()?;
        let scenes: Vec<Node> = match self.root.child("scene") {
            Some(scene) => scene
                .children_named("instance_visual_scene")
                .filter_map(|instance| self.target(instance, "url"))
                .collect(),
            None => self
                .root
                .children_named("library_visual_scenes")
                .flat_map(|library| library.children_named("visual_scene"))
                .collect(),
        };
        let start = Matrix4::new_scaling(unit);
        let mut open: Vec<(Node, Matrix4<f64>)> = scenes
            .iter()
            .rev()
            .flat_map(|scene| nodes(*scene))
            .map(|node| (node, start))
            .collect();
        let mut all = Vec::new();
        let mut instances = 0;
        while let Some((node, above)) = open.pop() {
            instances += 1;
            if instances > MOST_INSTANCES {
                return Err(problem(
                    "the scene has too many nodes, or one that contains itself",
                ));
            }
            let placed = above * placement(node)?;
            for instance in node.children_named("instance_geometry") {
                if let Some(geometry) = self.target(instance, "url") {
                    all.push(Instance {
                        geometry,
                        binder: instance,
                        placed,
                    });
                }
            }
            for instance in node.children_named("instance_controller") {
                let skin = self.target(instance, "url").and_then(|c| c.child("skin"));
                let Some(skin) = skin else { continue };
                let bind = match skin.child("bind_shape_matrix") {
                    Some(matrix) => self::matrix(matrix)?,
                    None => Matrix4::identity(),
                };
                if let Some(geometry) = self.target(skin, "source") {
                    all.push(Instance {
                        geometry,
                        binder: instance,
                        placed: placed * bind,
                    });
                }
            }
            for instance in node.children_named("instance_node") {
                if let Some(target) = self.target(instance, "url") {
                    open.push((target, placed));
                }
            }
            open.extend(nodes(node).map(|child| (child, placed)));
        }
        Ok(all)
    }

    /// m per unit of the file.
    fn unit(&self) -> Result<f64, MeshError> {
        let unit = self
            .root
            .child("asset")
            .and_then(|asset| asset.child("unit"));
        let Some(text) = unit.and_then(|unit| unit.value("meter")) else {
            return Ok(1.0);
        };
        match text.trim().parse::<f64>() {
            Ok(meter) if meter.is_finite() && meter > 0.0 => Ok(meter),
            _ => Err(problem("<unit meter> is not a number above zero")),
        }
    }
}

impl Instance<'_> {
    /// Whether it is seen in a mirror: then its triangles are written the other way round, and
    /// would have their outside inwards.
    fn is_mirrored(&self) -> bool {
        self.placed.determinant() < 0.0
    }

    /// Turns its triangles with their outside outwards.
    fn turn(&self, corners: &mut [Vec3]) {
        if self.is_mirrored() {
            corners.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
        }
    }

    /// A point of the geometry, m.
    fn point(&self, p: &Vec3) -> Vec3 {
        self.placed.transform_point(&Point3::from(*p)).coords
    }
}

fn too_many_points() -> MeshError {
    problem("the scene has too many points")
}

fn nodes(node: Node<'_>) -> impl Iterator<Item = Node<'_>> {
    node.children_named("node")
}

fn numbers(node: Node) -> Result<Vec<f64>, MeshError> {
    words::floats(&node.content())
        .map_err(|word| MeshError::Collada(format!("<{}>: {}", node.name(), no_number(word))))
}

fn fixed<const N: usize>(node: Node) -> Result<[f64; N], MeshError> {
    <[f64; N]>::try_from(numbers(node)?).map_err(|found| {
        MeshError::Collada(format!(
            "<{}> needs {N} numbers, not {}",
            node.name(),
            found.len()
        ))
    })
}

fn matrix(node: Node) -> Result<Matrix4<f64>, MeshError> {
    Ok(Matrix4::from_row_slice(&fixed::<16>(node)?))
}

/// The product of a node's transformations, in the order of the file.
fn placement(node: Node) -> Result<Matrix4<f64>, MeshError> {
    let mut all = Matrix4::identity();
    for step in node.children() {
        all *= match step.local_name() {
            "matrix" => matrix(step)?,
            "translate" => Matrix4::new_translation(&Vec3::from(fixed(step)?)),
            "scale" => Matrix4::new_nonuniform_scaling(&Vec3::from(fixed(step)?)),
            "rotate" => {
                let [x, y, z, degrees] = fixed(step)?;
                match Unit::try_new(Vec3::new(x, y, z), 1e-9) {
                    Some(axis) => {
                        Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous()
                    }
                    None => Matrix4::identity(),
                }
            }
            "lookat" | "skew" => {
                let what = format!("<{}> is not supported; write a <matrix>", step.local_name());
                return Err(MeshError::Collada(what));
            }
            _ => continue,
        };
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene around one triangle with corners (1, 0, 0), (0, 1, 0), (0, 0, 1) and one unused
    /// point.
    fn text(asset: &str, nodes: &str) -> String {
        format!(
            "<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>
             <asset>{asset}</asset>
             <library_geometries><geometry id='g'><mesh>
               <source id='s'><float_array id='f' count='12'>1 0 0 0 1 0 0 0 1 9 9 9</float_array>
                 <technique_common><accessor source='#f' count='4' stride='3'/></technique_common>
               </source>
               <source id='n'><float_array count='3'>0 0 1</float_array></source>
               <vertices id='v'><input semantic='POSITION' source='#s'/></vertices>
               <triangles count='1'><input semantic='VERTEX' source='#v' offset='0'/>
                 <input semantic='NORMAL' source='#n' offset='1'/><p>0 0 1 0 2 0</p></triangles>
             </mesh></geometry></library_geometries>
             <library_nodes><node id='part'><instance_geometry url='#g'/></node></library_nodes>
             <library_visual_scenes><visual_scene id='a'>{nodes}</visual_scene></library_visual_scenes>
             <scene><instance_visual_scene url='#a'/></scene></COLLADA>"
        )
    }

    fn scene(asset: &str, nodes: &str) -> Result<Vec<Vec3>, MeshError> {
        read(text(asset, nodes).as_bytes(), &Known::default())
    }

    fn assert_close(found: Result<Vec<Vec3>, MeshError>, expected: [[f64; 3]; 3]) {
        let found = found.expect("a scene");
        assert_eq!(found.len(), 3);
        for (point, expected) in found.iter().zip(expected) {
            assert!((point - Vec3::from(expected)).norm() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn unit_scales_and_up_axis_does_not_turn() {
        let asset = "<unit name='centimeter' meter='0.01'/><up_axis>Y_UP</up_axis>";
        let found = scene(asset, "<node><instance_geometry url='#g'/></node>");
        assert_close(
            found,
            [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]],
        );
    }

    #[test]
    fn transformations_apply_in_file_order_from_the_outermost_node() {
        // x → 2x (inner), then a quarter turn about z: x → y, y → -x, then (5, 0, 0).
        let nodes = "<node><translate>5 0 0</translate><rotate>0 0 1 90</rotate>
                     <node><scale>2 1 1</scale><instance_node url='#part'/></node></node>";
        let expected = [[5.0, 2.0, 0.0], [4.0, 0.0, 0.0], [5.0, 0.0, 1.0]];
        assert_close(scene("", nodes), expected);
        let matrix = "<node><matrix>0 -1 0 5 2 0 0 0 0 0 1 0 0 0 0 1</matrix>
                      <instance_geometry url='#g'/></node>";
        assert_close(scene("", matrix), expected);
    }

    #[test]
    fn mirrored_nodes_keep_their_outside() {
        // The normal of the triangle is (1, 1, 1)/√3; a mirror at x = 0 makes it (−1, 1, 1)/√3.
        let part = "<instance_geometry url='#g'/></node>";
        for (mirror, x) in [("-1 1 1", -1.0), ("-1 -1 1", -1.0), ("1 1 1", 1.0)] {
            let nodes = format!("<node><scale>{mirror}</scale>{part}");
            let [a, b, c] = triangles(text("", &nodes).as_bytes()).expect("a triangle")[0];
            let normal = (b - a).cross(&(c - a));
            assert!(normal.x * x > 0.0 && normal.z > 0.0, "{mirror}: {normal}");
        }
    }

    #[test]
    fn files_in_the_encoding_that_they_declare_are_read() {
        let scene = text(
            "<contributor><author>José</author></contributor>",
            "<node><instance_geometry url='#g'/></node>",
        );
        let latin = |declared: &str| {
            let whole = format!("<?xml version='1.0' encoding='{declared}'?>{scene}");
            let byte = |letter| u8::try_from(u32::from(letter)).expect("of ISO 8859-1");
            read(
                &whole.chars().map(byte).collect::<Vec<_>>(),
                &Known::default(),
            )
        };
        assert_close(
            latin("ISO-8859-1"),
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        );
        let refused = latin("KOI8-R").expect_err("another alphabet").to_string();
        assert!(refused.contains("KOI8-R"), "{refused}");
        assert!(latin("utf-8").is_err());
    }

    #[test]
    fn a_node_that_contains_itself_is_refused() {
        let nodes = "<node id='x'><instance_node url='#x'/></node>";
        assert!(matches!(scene("", nodes), Err(MeshError::Collada(_))));
    }

    #[test]
    fn faulty_collada_files_are_refused() {
        assert!(read(b"<COLLADA><asset>", &Known::default()).is_err());
        assert!(read(b"<svg/>", &Known::default()).is_err());
        assert!(scene("<unit meter='0'/>", "").is_err());
        assert!(scene("", "<node><matrix>1 2 3</matrix></node>").is_err());
        assert!(scene("", "<node><translate>1 2 x</translate></node>").is_err());
    }
}
