//! COLLADA (`.dae`) → points: geometries placed by the nodes of the scene, in m by `<unit>`.
//!
//! `<up_axis>` is ignored, as RViz, Gazebo, MoveIt and Pinocchio ignore it: robots are designed
//! with these programs, so the axes of the file are those of the link in any case. Lines, splines
//! and materials are skipped; a skinned geometry stands in its bind pose.

use super::faces::{MeshError, fan};
use super::xml::{Document, Node};
use crate::diagnostic::Report;
use crate::spatial::Vec3;
use nalgebra::{Matrix4, Point3, Rotation3, Unit};
use std::collections::HashMap;

/// Most placed geometries: a part library that refers to itself must end.
const MOST_INSTANCES: usize = 10_000;

/// Most points that are kept.
const MOST_POINTS: usize = 20_000_000;

/// Corners of all faces in the scene.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Vec3>, MeshError> {
    scene(bytes, false)
}

/// All faces in the scene, cut into triangles.
pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    let corners = scene(bytes, true)?;
    Ok(corners
        .chunks_exact(3)
        .map(|t| [t[0], t[1], t[2]])
        .collect())
}

/// Points of the scene: each corner once, or three of each triangle.
fn scene(bytes: &[u8], triangles: bool) -> Result<Vec<Vec3>, MeshError> {
    let text = std::str::from_utf8(bytes).map_err(|_| problem("the file is not UTF-8"))?;
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
    Scene::new(root, triangles).points()
}

fn problem(what: &str) -> MeshError {
    MeshError::Collada(what.to_owned())
}

struct Scene<'d> {
    root: Node<'d>,
    /// Whether three points of each triangle are wanted, not each corner once.
    triangles: bool,
    ids: HashMap<&'d str, Node<'d>>,
    /// Points of a geometry, by the place of its tag.
    geometries: HashMap<usize, Vec<Vec3>>,
}

impl<'d> Scene<'d> {
    fn new(root: Node<'d>, triangles: bool) -> Self {
        let mut ids = HashMap::new();
        for node in root.descendants() {
            if let Some(id) = node.value("id") {
                ids.entry(id).or_insert(node);
            }
        }
        Self {
            root,
            triangles,
            ids,
            geometries: HashMap::new(),
        }
    }

    fn target(&self, node: Node<'d>, attribute: &str) -> Option<Node<'d>> {
        self.ids
            .get(node.value(attribute)?.strip_prefix('#')?)
            .copied()
    }

    fn points(mut self) -> Result<Vec<Vec3>, MeshError> {
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
                    self.place(geometry, &placed, &mut all)?;
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
                    self.place(geometry, &(placed * bind), &mut all)?;
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

    fn place(
        &mut self,
        geometry: Node<'d>,
        placed: &Matrix4<f64>,
        all: &mut Vec<Vec3>,
    ) -> Result<(), MeshError> {
        let key = geometry.tag_at().start;
        if !self.geometries.contains_key(&key) {
            let points = self.corners(geometry)?;
            self.geometries.insert(key, points);
        }
        let points = &self.geometries[&key];
        if all.len() + points.len() > MOST_POINTS {
            return Err(problem("the scene has too many points"));
        }
        all.extend(
            points
                .iter()
                .map(|p| placed.transform_point(&Point3::from(*p)).coords),
        );
        Ok(())
    }

    /// Positions that a face of the geometry uses.
    fn corners(&self, geometry: Node<'d>) -> Result<Vec<Vec3>, MeshError> {
        let mesh = geometry
            .child("mesh")
            .or_else(|| geometry.child("convex_mesh"));
        let Some(mesh) = mesh else {
            return Ok(Vec::new());
        };
        let mut corners = Vec::new();
        for faces in mesh.children() {
            let kinds = ["triangles", "polylist", "polygons", "tristrips", "trifans"];
            if !kinds.contains(&faces.local_name()) {
                continue;
            }
            let inputs = || faces.children_named("input");
            let Some(input) = inputs().find(|i| i.value("semantic") == Some("VERTEX")) else {
                continue;
            };
            let offset_of = |input: Node| -> Result<usize, MeshError> {
                let text = input.value("offset").unwrap_or("0");
                text.trim()
                    .parse()
                    .ok()
                    .filter(|&offset: &usize| offset < 1000)
                    .ok_or_else(|| problem("an <input offset> is not a small number"))
            };
            let mut stride = 1;
            for other in inputs() {
                stride = stride.max(offset_of(other)? + 1);
            }
            let offset = offset_of(input)?;
            let positions = self.positions(input)?;
            let mut used = vec![false; positions.len()];
            let mut polygons = Vec::new();
            for p in faces.descendants().filter(|node| node.local_name() == "p") {
                let content = p.content();
                let mut face = Vec::new();
                for word in content
                    .split_ascii_whitespace()
                    .skip(offset)
                    .step_by(stride)
                {
                    let index = word.parse::<usize>().ok().filter(|&i| i < used.len());
                    let Some(index) = index else {
                        let what = format!("a face names vertex '{word}', which does not exist");
                        return Err(MeshError::Collada(what));
                    };
                    used[index] = true;
                    face.push(positions[index]);
                }
                polygons.push(face);
            }
            if self.triangles {
                corners.extend(triangulated(faces, &polygons)?.into_iter().flatten());
                continue;
            }
            corners.extend(
                positions
                    .iter()
                    .zip(&used)
                    .filter(|(_, used)| **used)
                    .map(|(p, _)| *p),
            );
        }
        Ok(corners)
    }

    /// The points behind an input of semantic VERTEX.
    fn positions(&self, input: Node<'d>) -> Result<Vec<Vec3>, MeshError> {
        let missing = || problem("a face refers to positions that are not there");
        let vertices = self.target(input, "source").ok_or_else(missing)?;
        let source = if vertices.local_name() == "vertices" {
            let position = vertices
                .children_named("input")
                .find(|i| i.value("semantic") == Some("POSITION"))
                .ok_or_else(missing)?;
            self.target(position, "source").ok_or_else(missing)?
        } else {
            vertices
        };
        let accessor = source
            .child("technique_common")
            .and_then(|t| t.child("accessor"));
        let number = |name: &str, default: usize| {
            accessor
                .and_then(|a| a.value(name))
                .and_then(|v| v.trim().parse::<usize>().ok())
                .unwrap_or(default)
        };
        let (stride, offset) = (number("stride", 3), number("offset", 0));
        if stride < 3 {
            return Err(problem("positions have fewer than three coordinates"));
        }
        let array = source
            .child("float_array")
            .or_else(|| self.target(accessor?, "source"))
            .ok_or_else(missing)?;
        let floats = numbers(array)?;
        let floats = floats.get(offset..).unwrap_or_default();
        Ok(floats
            .chunks(stride)
            .filter_map(|c| c.get(..3))
            .map(|c| Vec3::new(c[0], c[1], c[2]))
            .collect())
    }
}

/// The triangles of a group of faces; `lists` are the corners in each of its `<p>`.
fn triangulated(faces: Node, lists: &[Vec<Vec3>]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    let mut triangles = Vec::new();
    for list in lists {
        match faces.local_name() {
            "triangles" => triangles.extend(list.chunks_exact(3).map(|t| [t[0], t[1], t[2]])),
            "polylist" => {
                let mut rest = list.as_slice();
                let counts = faces.child("vcount").map(super::xml::Node::content);
                for word in counts.iter().flat_map(|c| c.split_ascii_whitespace()) {
                    let polygon = word.parse().ok().and_then(|n| rest.split_at_checked(n));
                    let (polygon, others) =
                        polygon.ok_or_else(|| problem("<vcount> and <p> do not agree"))?;
                    triangles.extend(fan(polygon));
                    rest = others;
                }
            }
            // Every other triangle of a strip turns the other way.
            "tristrips" => triangles.extend(list.windows(3).enumerate().map(|(i, t)| {
                let [a, b] = if i % 2 == 0 { [0, 1] } else { [1, 0] };
                [t[a], t[b], t[2]]
            })),
            _ => triangles.extend(fan(list)),
        }
    }
    Ok(triangles)
}

fn nodes(node: Node<'_>) -> impl Iterator<Item = Node<'_>> {
    node.children_named("node")
}

fn numbers(node: Node) -> Result<Vec<f64>, MeshError> {
    let content = node.content();
    content
        .split_ascii_whitespace()
        .map(|word| {
            word.parse().map_err(|_| {
                MeshError::Collada(format!("<{}>: '{word}' is not a number", node.name()))
            })
        })
        .collect()
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
    fn scene(asset: &str, nodes: &str) -> Result<Vec<Vec3>, MeshError> {
        let text = format!(
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
        );
        read(text.as_bytes())
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
    fn a_node_that_contains_itself_is_refused() {
        let nodes = "<node id='x'><instance_node url='#x'/></node>";
        assert!(matches!(scene("", nodes), Err(MeshError::Collada(_))));
    }

    #[test]
    fn faulty_collada_files_are_refused() {
        assert!(read(b"<COLLADA><asset>").is_err());
        assert!(read(b"<svg/>").is_err());
        assert!(scene("<unit meter='0'/>", "").is_err());
        assert!(scene("", "<node><matrix>1 2 3</matrix></node>").is_err());
        assert!(scene("", "<node><translate>1 2 x</translate></node>").is_err());
    }
}
