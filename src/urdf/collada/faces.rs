//! Faces of a COLLADA geometry: their corners, their triangles, and these with texture coordinates.

use super::super::faces::{MeshError, Parts, fan, place};
use super::super::xml::Node;
use super::words::NO_INDEX;
use super::{MOST_POINTS, Scene, problem, too_many_points};
use crate::spatial::Vec3;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

/// Elements that hold faces.
const KINDS: [&str; 5] = ["triangles", "polylist", "polygons", "tristrips", "trifans"];

/// Triangles that carry one material.
struct Group<'d> {
    /// What the scene binds a material to.
    symbol: Option<&'d str>,
    /// Positions in the order in which triangles first have them.
    positions: Vec<Vec3>,
    /// Places in `positions`.
    triangles: Vec<[u32; 3]>,
    /// Texture coordinates of each triangle, where the file has them.
    uv: Option<Vec<[[f64; 2]; 3]>>,
}

/// Indices of the corners of a group of faces.
struct Corners {
    /// How many indices each corner has.
    stride: usize,
    /// The indices in each `<p>`, in pieces.
    lists: Vec<Arc<Vec<Vec<u32>>>>,
}

impl<'d> Scene<'d> {
    /// Positions that a face of the geometry uses, each once for each group of faces.
    pub(super) fn corners(&self, geometry: Node<'d>) -> Result<Vec<Vec3>, MeshError> {
        let mut corners = Vec::new();
        for (faces, input) in groups(geometry) {
            let positions = self.positions(input)?;
            let mut used = vec![false; positions.len()];
            for list in self.corners_of(faces)?.of(offset(input)?, used.len())? {
                for index in list {
                    used[index as usize] = true;
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
            let lists = self
                .corners_of(faces)?
                .of(offset(input)?, positions.len())?;
            let triangles = triangulated(faces, &lists)?;
            let places = triangles.iter().flatten();
            corners.extend(places.map(|&i| positions[i as usize]));
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
                let part = parts.of(&paint, group.uv.is_some());
                let first = place(part.corners.len());
                let placed = group.positions.iter().map(|p| instance.point(p));
                part.corners.extend(placed);
                let triangles = group.triangles.iter();
                part.triangles
                    .extend(triangles.map(|t| t.map(|i| first + i)));
                if part.paint.image.is_some() {
                    part.uv.extend(group.uv.iter().flatten());
                }
            }
        }
        Ok(parts)
    }

    fn painted_groups(&self, geometry: Node<'d>) -> Result<Vec<Group<'d>>, MeshError> {
        let mut list = Vec::new();
        for (faces, input) in groups(geometry) {
            let positions = self.positions(input)?;
            let corners = self.corners_of(faces)?;
            let places = corners.of(offset(input)?, positions.len())?;
            let mut triangles = triangulated(faces, &places)?;
            let uv = self.coordinates(faces, &corners);
            list.push(Group {
                symbol: faces.value("material"),
                uv: uv.filter(|uv| uv.len() == triangles.len()),
                positions: renumbered(&mut triangles, &positions),
                triangles,
            });
        }
        Ok(list)
    }

    /// Texture coordinates of the triangles of a group of faces. A texture that cannot be placed is
    /// left out; the shape is still drawn.
    fn coordinates(&self, faces: Node<'d>, corners: &Corners) -> Option<Vec<[[f64; 2]; 3]>> {
        if !self.textured {
            return None;
        }
        // Where there are several sets, the first is the one of the colours.
        let input = faces
            .children_named("input")
            .filter(|i| i.value("semantic") == Some("TEXCOORD"))
            .min_by_key(|i| {
                i.value("set")
                    .and_then(|set| set.trim().parse::<u32>().ok())
            })?;
        let uv = self.vectors::<2>(self.target(input, "source")?).ok()?;
        let places = corners.of(offset(input).ok()?, uv.len()).ok()?;
        let triangles = triangulated(faces, &places).ok()?.into_iter();
        Some(triangles.map(|t| t.map(|i| uv[i as usize])).collect())
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
        let floats = self.known.floats(array)?;
        let floats = floats.get(offset..).unwrap_or_default();
        Ok(floats
            .chunks(stride)
            .filter_map(|row| row.first_chunk::<N>().copied())
            .collect())
    }

    fn corners_of(&self, faces: Node) -> Result<Corners, MeshError> {
        let mut stride = 1;
        for input in faces.children_named("input") {
            stride = stride.max(offset(input)? + 1);
        }
        let lists = faces.descendants().filter(|node| node.local_name() == "p");
        let lists = lists.map(|p| self.known.indices(p)).collect();
        Ok(Corners { stride, lists })
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

impl Corners {
    /// For each list, each corner's index of `offset`; all are below `end`.
    fn of(&self, offset: usize, end: usize) -> Result<Vec<Vec<u32>>, MeshError> {
        // What is no number is refused where it is used.
        let checked = |&index: &u32| {
            let beyond = || match index {
                NO_INDEX => problem("a face names a vertex by what is no whole number"),
                index => MeshError::Collada(format!(
                    "a face names vertex '{index}', which does not exist"
                )),
            };
            let there = index != NO_INDEX && (index as usize) < end;
            there.then_some(index).ok_or_else(beyond)
        };
        let own = |list: &Arc<Vec<Vec<u32>>>| {
            let count: usize = list.iter().map(Vec::len).sum();
            let mut places = Vec::with_capacity(count / self.stride + 1);
            let mut at = offset;
            for piece in list.iter() {
                while let Some(index) = piece.get(at) {
                    places.push(checked(index)?);
                    at += self.stride;
                }
                at -= piece.len();
            }
            Ok(places)
        };
        self.lists.iter().map(own).collect()
    }
}

/// The positions that triangles have, in the order in which they first have them; the triangles
/// then name places among these.
fn renumbered(triangles: &mut [[u32; 3]], positions: &[Vec3]) -> Vec<Vec3> {
    /// A position that no triangle has had yet.
    const NEW: u32 = u32::MAX;
    let mut places = vec![NEW; positions.len()];
    let mut used = Vec::with_capacity(positions.len());
    for i in triangles.as_flattened_mut() {
        let known = &mut places[*i as usize];
        if *known == NEW {
            *known = place(used.len());
            used.push(positions[*i as usize]);
        }
        *i = *known;
    }
    used
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
