//! The surface of a triangle mesh that never moves.
//!
//! Corners at the same place are merged. An edge between two triangles is flat, concave or a crest;
//! a shape can lie on a crest, and on an edge that belongs to one triangle alone.
//!
//! Triangles are found by a tree of boxes.

mod along;
mod buried;
mod facet;
mod seams;

pub use self::facet::{Beyond, Crest, Facet};

use self::buried::Edges;
use self::facet::area_of;
use super::error::GeometryError;
use crate::spatial::Vec3;
use crate::tuning::{EVEN_EDGE, SEAM};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Most triangles of a surface.
pub const MOST_TRIANGLES: usize = 1_000_000;

/// Corners closer than this part of the extent are one.
const SAME: f64 = 1e-9;

/// Triangles in a leaf of the tree of boxes.
const LEAF: usize = 4;

/// Room for the way down the tree: its depth is the logarithm of the number of triangles.
const STACK: usize = 64;

/// Triangles, seen counter-clockwise from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Triangles", into = "Triangles")]
pub struct Surface {
    given: Triangles,
    facets: Vec<Facet>,
    crests: Vec<Crest>,
    boxes: Vec<Node>,
    /// Facets in the order of the leaves.
    order: Vec<usize>,
    reach: f64,
}

/// Corners, m, and triangles by their indices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Triangles {
    /// m
    pub corners: Vec<Vec3>,
    /// Counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A box about some triangles.
#[derive(Clone, Debug, PartialEq)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// Children, or the first place in `order` and one past the last one.
    next: [usize; 2],
    leaf: bool,
}

impl TryFrom<Triangles> for Surface {
    type Error = GeometryError;

    #[cfg_attr(small, optimize(size))]
    fn try_from(given: Triangles) -> Result<Self, GeometryError> {
        let count = given.triangles.len();
        if count == 0 || count > MOST_TRIANGLES {
            return Err(GeometryError::Triangles { count });
        }
        for (index, corner) in given.corners.iter().enumerate() {
            if !corner.iter().all(|x| x.is_finite()) {
                return Err(GeometryError::NotFinite { index });
            }
            let distance = corner.norm();
            if distance > 1e6 {
                return Err(GeometryError::TooFar { index, distance });
            }
        }
        let exists = |i: &u32| (*i as usize) < given.corners.len();
        if !given.triangles.iter().flatten().all(exists) {
            return Err(GeometryError::NoPoints);
        }
        // An edge without a length has no direction.
        let area = |triangle: &[u32; 3]| area_of(triangle.map(|i| given.corners[i as usize]));
        let flat = |triangle: &[u32; 3]| area(triangle).try_normalize(0.0).is_none();
        if let Some(index) = given.triangles.iter().position(flat) {
            return Err(GeometryError::Flat { index });
        }
        Ok(Self::of(given))
    }
}

impl From<Surface> for Triangles {
    fn from(surface: Surface) -> Self {
        surface.given
    }
}

impl Triangles {
    /// Triangles with their corners, those in one place as one; those without an area are left
    /// out.
    pub fn new(list: &[[Vec3; 3]]) -> Self {
        let extent = list.iter().flatten().map(Vec3::amax).fold(0.0, f64::max);
        let grain = (SAME * extent).max(f64::MIN_POSITIVE);
        #[expect(clippy::cast_possible_truncation, reason = "at most 1e9 grains")]
        let key = |c: &Vec3| [c.x, c.y, c.z].map(|x| (x / grain).round() as i64);
        let mut known: BTreeMap<[i64; 3], u32> = BTreeMap::new();
        let mut given = Self {
            corners: Vec::new(),
            triangles: Vec::new(),
        };
        for triangle in list {
            let indices = triangle.map(|c| {
                *known.entry(key(&c)).or_insert_with(|| {
                    given.corners.push(c);
                    #[expect(clippy::cast_possible_truncation, reason = "counted before")]
                    let index = (given.corners.len() - 1) as u32;
                    index
                })
            });
            let area = area_of(indices.map(|i| given.corners[i as usize]));
            if area.try_normalize(grain * grain).is_some() {
                given.triangles.push(indices);
            }
        }
        given
    }
}

impl Surface {
    #[cfg_attr(small, optimize(size))]
    fn of(given: Triangles) -> Self {
        let mut triangles = distinct(&given.triangles);
        let corners = |triangle: &[u32; 3]| triangle.map(|i| given.corners[i as usize]);
        let facets = triangles.iter().map(|t| Facet::new(corners(t))).collect();
        let reach = given.corners.iter().map(Vec3::norm).fold(0.0, f64::max);
        let mut surface = Self {
            given,
            facets,
            crests: Vec::new(),
            boxes: Vec::new(),
            order: Vec::new(),
            reach,
        };
        surface.build_tree();
        let mut edges = edges(&triangles);
        let near = |p: &Vec3, take: &mut dyn FnMut(usize, &Facet)| {
            surface.each_near(p, 2.0 * SEAM, take);
        };
        let buried = buried::between(&surface.facets, (&triangles, &edges), near);
        if buried.contains(&true) {
            leave_out(&mut surface.facets, &buried);
            leave_out(&mut triangles, &buried);
            surface.build_tree();
            edges = self::edges(&triangles);
        }
        surface.join_all(&edges);
        surface
    }

    /// Sorts the facets into boxes.
    #[cfg_attr(small, optimize(size))]
    fn build_tree(&mut self) {
        self.order = (0..self.facets.len()).collect();
        self.boxes.clear();
        self.divide(0, self.order.len());
    }

    /// Finds what every edge is.
    fn join_all(&mut self, edges: &Edges) {
        let mut alone = Vec::new();
        let (facets, crests) = (&mut self.facets, &mut self.crests);
        for places in edges.values() {
            for (i, partner) in seams::partners(facets, places) {
                if let Some(j) = partner {
                    join(facets, [places[i], places[j]], crests);
                } else {
                    end(facets, places[i], crests);
                    alone.push(places[i]);
                }
            }
        }
        for place in alone {
            let near = |p: &Vec3, take: &mut dyn FnMut(usize, &Facet)| {
                self.each_near(p, 2.0 * SEAM, take);
            };
            if let Some(other) = seams::beyond(&self.facets, place, near) {
                seams::go_on((&mut self.facets, &mut self.crests), place, other);
            }
        }
    }

    /// Puts the facets of places of the order under a node of their own; returns it.
    #[cfg_attr(small, optimize(size))]
    fn divide(&mut self, first: usize, last: usize) -> usize {
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        for &facet in &self.order[first..last] {
            for corner in &self.facets[facet].corners {
                (low, high) = (low.inf(corner), high.sup(corner));
            }
        }
        let index = self.boxes.len();
        self.boxes.push(Node {
            low,
            high,
            next: [first, last],
            leaf: true,
        });
        if last - first > LEAF {
            let axis = (high - low).imax();
            let facets = &self.facets;
            let middle = |i: &usize| facets[*i].middle()[axis];
            let half = (last - first) / 2;
            let by = |a: &usize, b: &usize| middle(a).total_cmp(&middle(b)).then(a.cmp(b));
            self.order[first..last].select_nth_unstable_by(half, by);
            let left = self.divide(first, first + half);
            let right = self.divide(first + half, last);
            (self.boxes[index].next, self.boxes[index].leaf) = ([left, right], false);
        }
        index
    }

    /// The same where it ends beside other terrain in which it goes on, if there is such an edge:
    /// it is a seam then, and nothing can lie on it or run against it. An edge that goes on in part
    /// stays an end.
    ///
    /// - `carried`: adds the parts of a segment, from 0 to 1, that other terrain carries with about
    ///   the given normal
    pub fn beside(&self, carried: impl Fn([Vec3; 2], &Vec3, &mut Vec<[f64; 2]>)) -> Option<Self> {
        let seams = seams::beside((&self.facets, &self.crests), carried);
        let mut joined = (!seams.is_empty()).then(|| self.clone())?;
        for [index, edge] in seams {
            joined.facets[index].crests[edge] = None;
            joined.facets[index].beyond[edge] = Beyond::Seam;
        }
        Some(joined)
    }

    /// Adds the parts of a segment, from 0 to 1, that lie on its triangles, with about that normal.
    pub fn carried(&self, [a, b]: [Vec3; 2], normal: &Vec3, parts: &mut Vec<[f64; 2]>) {
        let around = 0.5 * (b - a).norm() + 2.0 * SEAM;
        self.is_any_near(&((a + b) * 0.5), around, |facet| {
            if (facet.normal - normal).norm() < EVEN_EDGE {
                parts.extend(facet.carried([a, b]));
            }
            false
        });
    }

    /// Its triangles.
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// An edge.
    pub fn crest(&self, index: usize) -> &Crest {
        &self.crests[index]
    }

    /// Largest distance of one of its points from its origin, m.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Calls `take` with the triangles whose boxes come nearer to a point than `radius`, m.
    pub fn each_near<'a>(&'a self, p: &Vec3, radius: f64, mut take: impl FnMut(usize, &'a Facet)) {
        self.any_near(p, radius, |index, facet| {
            take(index, facet);
            false
        });
    }

    /// Whether `is` holds for a triangle whose box comes nearer to a point than `radius`, m.
    pub fn is_any_near(&self, p: &Vec3, radius: f64, mut is: impl FnMut(&Facet) -> bool) -> bool {
        self.any_near(p, radius, |_, facet| is(facet))
    }

    /// Whether the box about some triangles is nearer to a place than `radius`, m.
    pub fn is_near(&self, p: &Vec3, radius: f64) -> bool {
        self.any_near(p, radius, |_, _| true)
    }

    /// Calls `take` with the triangles near a place until it says that it has enough; tells whether
    /// it has.
    fn any_near<'a>(
        &'a self,
        p: &Vec3,
        radius: f64,
        mut take: impl FnMut(usize, &'a Facet) -> bool,
    ) -> bool {
        self.any_leaf(p, radius, |leaf| {
            self.leaf(leaf).any(|(index, facet)| take(index, facet))
        })
    }

    /// Calls `take` with the leaves of the tree whose boxes come nearer to a point than `radius`,
    /// m, until it says that it has enough; tells whether it has.
    pub fn any_leaf(&self, p: &Vec3, radius: f64, mut take: impl FnMut(usize) -> bool) -> bool {
        let mut stack = [0_usize; STACK];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let index = stack[count];
            let node = &self.boxes[index];
            if !node.is_near(p, radius) {
                continue;
            }
            if node.leaf {
                if take(index) {
                    return true;
                }
            } else {
                (stack[count], stack[count + 1]) = (node.next[1], node.next[0]);
                count += 2;
            }
        }
        false
    }

    /// Triangles of a leaf, with their indices.
    pub fn leaf(&self, leaf: usize) -> impl Iterator<Item = (usize, &Facet)> {
        let [first, last] = self.boxes[leaf].next;
        let places = self.order[first..last].iter();
        places.map(|&facet| (facet, &self.facets[facet]))
    }

    /// Whether the box of a leaf comes nearer to a point than `radius`, m.
    #[inline]
    pub fn is_leaf_near(&self, leaf: usize, p: &Vec3, radius: f64) -> bool {
        self.boxes[leaf].is_near(p, radius)
    }
}

impl Node {
    #[inline]
    fn is_near(&self, p: &Vec3, radius: f64) -> bool {
        let apart = p - p.sup(&self.low).inf(&self.high);
        apart.norm_squared() <= radius * radius
    }
}

/// Triangles, each once.
fn distinct(list: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut known = BTreeSet::new();
    let mut first = |triangle: &&[u32; 3]| {
        let mut turned = **triangle;
        let lowest = (0..3).min_by_key(|&i| triangle[i]).unwrap_or_default();
        turned.rotate_left(lowest);
        known.insert(turned)
    };
    list.iter().filter(|t| first(t)).copied().collect()
}

/// Leaves out what is marked.
fn leave_out<T>(list: &mut Vec<T>, marked: &[bool]) {
    let mut marks = marked.iter();
    list.retain(|_| !marks.next().is_some_and(|is| *is));
}

/// The edges of triangles.
#[cfg_attr(small, optimize(size))]
fn edges(triangles: &[[u32; 3]]) -> Edges {
    let mut edges = Edges::new();
    for (index, triangle) in triangles.iter().enumerate() {
        for edge in 0..3 {
            let places = edges.entry(buried::edge_of(triangle, edge)).or_default();
            places.push([index, edge]);
        }
    }
    edges
}

/// Finds what the edge of two facets is.
fn join(facets: &mut [Facet], [first, second]: [[usize; 2]; 2], crests: &mut Vec<Crest>) {
    let normals = [first, second].map(|place| facets[place[0]].normal);
    // The sine of the angle by which the second one falls beyond the first one's edge.
    let falls = facets[second[0]].away(second[1]).dot(&normals[0]);
    let beyond = if normals[0].dot(&normals[1]) > 0.0 && falls.abs() < EVEN_EDGE {
        Beyond::Even
    } else if falls > 0.0 {
        Beyond::Crest
    } else {
        Beyond::Hollow
    };
    if beyond == Beyond::Crest {
        facets[first[0]].crests[first[1]] = Some(crests.len());
        let ends = facets[first[0]].ends(first[1]);
        crests.push(Crest::new(ends, normals));
    }
    for place in [first, second] {
        facets[place[0]].beyond[place[1]] = beyond;
    }
}

/// An edge at which the surface ends.
fn end(facets: &mut [Facet], place: [usize; 2], crests: &mut Vec<Crest>) {
    facets[place[0]].crests[place[1]] = Some(crests.len());
    let facet = &facets[place[0]];
    let sides = [facet.normal, facet.away(place[1])];
    crests.push(Crest {
        is_free: true,
        ..Crest::new(facet.ends(place[1]), sides)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by fuzzing texts of prepared models: the crest of an edge without a length had no
    /// direction. [`Triangles::new`] leaves such triangles out.
    #[test]
    fn triangles_that_are_stored_without_an_area_are_refused() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [2.0, 0.0], [0.0, 0.0]];
        let corners = corners.map(|[x, y]| Vec3::new(x, y, -1.0)).to_vec();
        for flat in [[1, 1, 2], [0, 1, 3], [0, 4, 2]] {
            let corners = corners.clone();
            let triangles = vec![[0, 1, 2], flat];
            let refused = Surface::try_from(Triangles { corners, triangles });
            assert_eq!(refused, Err(GeometryError::Flat { index: 1 }), "{flat:?}");
        }
    }
}
