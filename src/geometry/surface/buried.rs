//! Walls between solids that touch: a floor of boxes, a hill of cubes, a house on its ground.
//!
//! Where two solids of one mesh touch, each has a wall there, and the two walls lie on each other.
//! Nothing can come between them, but a shape that lies a little deep in the floor above them would
//! be held by them. A sheet that is drawn from both sides is two triangles on each other, too, and
//! is there. What tells them apart is the surface that a wall belongs to: at the edge of a wall
//! between two solids, the surface of its own solid goes on in that of the other one.
//!
//! 1. A triangle is covered if others that face it lie on all of it.
//! 2. A covered triangle lies between solids if, at one of its edges, its own solid has a surface
//!    that goes on beyond the edge, see [`seams::beyond`].
//! 3. So do the covered triangles that go on from it in its plane, up to where a third one comes
//!    out in front.

use super::facet::Facet;
use super::seams;
use crate::spatial::Vec3;
use crate::tuning::EVEN_EDGE;
use std::collections::BTreeMap;

/// Triangles at each edge: their indices and which of their edges it is.
pub(super) type Edges = BTreeMap<[u32; 2], Vec<[usize; 2]>>;

/// The edge of a triangle from one of its corners to the next.
pub(super) fn edge_of(triangle: &[u32; 3], edge: usize) -> [u32; 2] {
    let (a, b) = (triangle[edge], triangle[(edge + 1) % 3]);
    [a.min(b), a.max(b)]
}

/// Which triangles lie between two solids. `near` calls its argument with what is near a point.
pub(super) fn between(
    facets: &[Facet],
    (triangles, edges): (&[[u32; 3]], &Edges),
    near: impl Fn(&Vec3, &mut dyn FnMut(usize, &Facet)),
) -> Vec<bool> {
    let covered: Vec<bool> = facets.iter().map(|f| is_covered(f, &near)).collect();
    let mut found = vec![false; facets.len()];
    let mut ways = Vec::new();
    for places in edges.values() {
        for wall in places {
            if !covered[wall[0]] || found[wall[0]] {
                continue;
            }
            let goes_on = |own: &[usize; 2]| {
                turns_down(facets, *own, *wall) && seams::beyond(facets, *own, &near).is_some()
            };
            if places.iter().any(goes_on) {
                found[wall[0]] = true;
                ways.push(wall[0]);
            }
        }
    }
    while let Some(this) = ways.pop() {
        let normal = facets[this].normal;
        for edge in 0..3 {
            let places = &edges[&edge_of(&triangles[this], edge)];
            let in_front =
                |place: &[usize; 2]| facets[place[0]].inward[place[1]].dot(&normal) > EVEN_EDGE;
            if places.iter().any(in_front) {
                continue;
            }
            for &[next, _] in places {
                if covered[next] && !found[next] && facets[next].normal.dot(&normal) > 0.0 {
                    found[next] = true;
                    ways.push(next);
                }
            }
        }
    }
    found
}

/// Whether a surface turns down into a wall at their edge.
fn turns_down(facets: &[Facet], own: [usize; 2], wall: [usize; 2]) -> bool {
    let [a, b] = [own, wall].map(|place| (&facets[place[0]], place[1]));
    a.0.ends(a.1)[0] != b.0.ends(b.1)[0] && a.0.inward[a.1].dot(&b.0.normal) < -EVEN_EDGE
}

/// Whether triangles that face a triangle lie on it: at its middle, near its corners and near the
/// middles of its edges.
fn is_covered(facet: &Facet, near: &impl Fn(&Vec3, &mut dyn FnMut(usize, &Facet))) -> bool {
    let middle = facet.middle();
    let [a, b, c] = facet.corners;
    let outer = [a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
    let looks = outer.map(|p| middle + (p - middle) * 0.9);
    std::iter::once(middle).chain(looks).all(|p| {
        let mut is = false;
        near(&p, &mut |_, other| {
            let faces = other.normal.dot(&facet.normal) < EVEN_EDGE - 1.0;
            is = is || faces && other.carries(&p);
        });
        is
    })
}
