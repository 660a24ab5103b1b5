//! Faces of a COLLADA geometry: their corners, their triangles, and these with texture coordinates.

use super::super::faces::{MeshError, Parts, fan};
use super::super::xml::Node;
use super::{MOST_POINTS, Scene, numbers, problem, too_many_points};
use crate::spatial::Vec3;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Elements that hold faces.
const KINDS: [&str; 5] = ["triangles", "polylist", "polygons", "tristrips", "trifans"];

/// A corner of a triangle: its position and its texture coordinates.
type Corner = (Vec3, [f64; 2]);

/// Triangles that carry one material.
struct Group<'d> {
    /// What the scene binds a material to.
    symbol: Option<&'d str>,
    triangles: Vec<[Corner; 3]>,
    /// Whether the texture coordinates are the file's.
    textured: bool,
}

/// Indices of the corners of a group of faces.
struct Corners {
    /// How many indices each corner has.
    stride: usize,
    /// The indices in each `<p>`.
    lists: Vec<Vec<usize>>,
}

impl<'d> Scene<'d> {
    /// Positions that a face of the geometry uses, each once for each group of faces.
    pub(super) fn corners(&self, geometry: Node<'d>) -> Result<Vec<Vec3>, MeshError> {
        let mut corners = Vec::new();
        for (faces, input) in groups(geometry) {
            let positions = self.positions(input)?;
            let mut used = vec![false; positions.len()];
            for list in corners_of(faces)?.of(offset(input)?, used.len())? {
                for index in list {
                    used[index] = true;
                }
            }
            let mut used = used.into_iter();
            corners.extend(positions.into_iter().filter(|_| used.next() == Some(true)));
        }
        Ok(corners)
    }

    /// Three corners of each triangle of the geometry.
    pub(super) fn triangle_corners(&self, geometry: Node<'d>) -> Result<Vec<Vec3>, MeshError> {
        let mut corners = Vec::new();
        for (faces, input) in groups(geometry) {
            let positions = self.positions(input)?;
            let lists = corners_of(faces)?.of(offset(input)?, positions.len())?;
            let triangles = triangulated(faces, &lists)?;
            corners.extend(triangles.into_iter().flatten().map(|i| positions[i]));
        }
        Ok(corners)
    }

    /// All triangles of the scene by what they are painted with.
    pub(super) fn parts(&self) -> Result<Parts, MeshError> {
        let mut parts = Parts::default();
        let mut count = 0;
        let mut geometries: HashMap<usize, Vec<Group>> = HashMap::new();
        for instance in self.instances()? {
            let groups = match geometries.entry(instance.geometry.tag_at().start) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(self.painted_groups(instance.geometry)?),
            };
            for group in groups {
                count += 3 * group.triangles.len();
                if count > MOST_POINTS {
                    return Err(too_many_points());
                }
                let paint = self.paint(instance.binder, group.symbol);
                let part = parts.of(&paint, group.textured);
                for triangle in &group.triangles {
                    let uv = group.textured.then(|| triangle.map(|corner| corner.1));
                    part.push(triangle.map(|corner| instance.point(&corner.0)), uv);
                }
            }
        }
        Ok(parts)
    }

    fn painted_groups(&self, geometry: Node<'d>) -> Result<Vec<Group<'d>>, MeshError> {
        let mut list = Vec::new();
        for (faces, input) in groups(geometry) {
            let positions = self.positions(input)?;
            let corners = corners_of(faces)?;
            let places = corners.of(offset(input)?, positions.len())?;
            // Where there are several sets, the first is the one of the colours.
            let uv_input = faces
                .children_named("input")
                .filter(|i| i.value("semantic") == Some("TEXCOORD"))
                .min_by_key(|i| {
                    i.value("set")
                        .and_then(|set| set.trim().parse::<u32>().ok())
                });
            // A texture that cannot be placed is left out; the shape is still drawn.
            let uv = uv_input.and_then(|input| {
                let uv = self.target(input, "source")?;
                let uv = self.vectors::<2>(uv).ok()?;
                let places = corners.of(offset(input).ok()?, uv.len()).ok()?;
                Some((uv, places))
            });
            let lists: Vec<Vec<Corner>> = match &uv {
                Some((uv, uv_places)) => places
                    .iter()
                    .zip(uv_places)
                    .map(|(of, uv_of)| {
                        let both = of.iter().zip(uv_of);
                        both.map(|(&p, &u)| (positions[p], uv[u])).collect()
                    })
                    .collect(),
                None => places
                    .iter()
                    .map(|of| of.iter().map(|&p| (positions[p], [0.0; 2])).collect())
                    .collect(),
            };
            list.push(Group {
                symbol: faces.value("material"),
                triangles: triangulated(faces, &lists)?,
                textured: uv.is_some(),
            });
        }
        Ok(list)
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
        let vectors = self.vectors::<3>(source)?;
        Ok(vectors.into_iter().map(Vec3::from).collect())
    }

    /// The first `N` numbers of each row of a `<source>`.
    fn vectors<const N: usize>(&self, source: Node<'d>) -> Result<Vec<[f64; N]>, MeshError> {
        let missing = || problem("a face refers to positions that are not there");
        let accessor = source
            .child("technique_common")
            .and_then(|t| t.child("accessor"));
        let number = |name: &str, default: usize| {
            accessor
                .and_then(|a| a.value(name))
                .and_then(|v| v.trim().parse::<usize>().ok())
                .unwrap_or(default)
        };
        let (stride, offset) = (number("stride", N), number("offset", 0));
        if stride < N {
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
            .filter_map(|row| row.first_chunk::<N>().copied())
            .collect())
    }
}

/// The groups of faces of a geometry, each with its input of semantic VERTEX.
fn groups(geometry: Node<'_>) -> impl Iterator<Item = (Node<'_>, Node<'_>)> {
    let mesh = geometry
        .child("mesh")
        .or_else(|| geometry.child("convex_mesh"));
    mesh.into_iter()
        .flat_map(Node::children)
        .filter(|faces| KINDS.contains(&faces.local_name()))
        .filter_map(|faces| {
            let mut inputs = faces.children_named("input");
            let input = inputs.find(|i| i.value("semantic") == Some("VERTEX"))?;
            Some((faces, input))
        })
}

/// Which of a corner's indices an `<input>` means.
fn offset(input: Node) -> Result<usize, MeshError> {
    let text = input.value("offset").unwrap_or("0");
    text.trim()
        .parse()
        .ok()
        .filter(|&offset: &usize| offset < 1000)
        .ok_or_else(|| problem("an <input offset> is not a small number"))
}

fn corners_of(faces: Node) -> Result<Corners, MeshError> {
    let mut stride = 1;
    for input in faces.children_named("input") {
        stride = stride.max(offset(input)? + 1);
    }
    let mut lists = Vec::new();
    for p in faces.descendants().filter(|node| node.local_name() == "p") {
        let content = p.content();
        // What is no number is refused where it is used.
        let index = |word: &str| word.parse().unwrap_or(usize::MAX);
        lists.push(content.split_ascii_whitespace().map(index).collect());
    }
    Ok(Corners { stride, lists })
}

impl Corners {
    /// For each list, each corner's index of `offset`; all are below `end`.
    fn of(&self, offset: usize, end: usize) -> Result<Vec<Vec<usize>>, MeshError> {
        let checked = |&index: &usize| {
            let beyond = || match index {
                usize::MAX => problem("a face names a vertex by what is no whole number"),
                index => MeshError::Collada(format!(
                    "a face names vertex '{index}', which does not exist"
                )),
            };
            (index < end).then_some(index).ok_or_else(beyond)
        };
        let own = |list: &Vec<usize>| {
            let all = list.iter().skip(offset).step_by(self.stride);
            all.map(checked).collect()
        };
        self.lists.iter().map(own).collect()
    }
}

/// The triangles of a group of faces; `lists` are the corners in each of its `<p>`.
fn triangulated<T: Copy>(faces: Node, lists: &[Vec<T>]) -> Result<Vec<[T; 3]>, MeshError> {
    let mut triangles = Vec::new();
    for list in lists {
        match faces.local_name() {
            "triangles" => triangles.extend(list.chunks_exact(3).map(|t| [t[0], t[1], t[2]])),
            "polylist" => {
                let mut rest = list.as_slice();
                let counts = faces.child("vcount").map(Node::content);
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
