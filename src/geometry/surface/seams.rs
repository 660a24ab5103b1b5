//! Edges of meshes that are no clean surfaces: more than two triangles at an edge, and triangles
//! that go on in others without sharing their corners.
//!
//! 1. Of several triangles at an edge, two belong together between which there is nothing outside
//!    of the surface: each goes on in the first one that is met when turning about the edge from
//!    its front. Sheets that are drawn from both sides are two surfaces then.
//! 2. An edge of one triangle alone ends the surface, unless a triangle begins where it ends:
//!    beside a side that others divide (a T-junction), or behind a gap of less than [`SEAM`]. A
//!    floor that ends at the middle of a wall goes on in the wall.

use super::facet::{Beyond, Crest, Facet};
use crate::geometry::segment::cover;
use crate::spatial::Vec3;
use crate::tuning::{EVEN_EDGE, SEAM};
use std::f64::consts::TAU;

/// Places along an edge that are looked at.
const LOOKS: u32 = 4;

/// Angle below which two triangles at an edge lie on each other, rad.
const FOLDED: f64 = 1e-6;

/// Angle from the front of one triangle at an edge to another one, rad; none if that looks the
/// other way.
fn turn(facets: &[Facet], from: [usize; 2], to: [usize; 2]) -> Option<f64> {
    let [a, b] = [from, to].map(|place| (&facets[place[0]], place[1]));
    if a.0.ends(a.1)[0] == b.0.ends(b.1)[0] {
        return None;
    }
    let (into, other) = (a.0.inward[a.1], b.0.inward[b.1]);
    let angle = libm::atan2(other.dot(&a.0.normal), other.dot(&into));
    let angle = if angle < 0.0 { angle + TAU } else { angle };
    (FOLDED..TAU - FOLDED).contains(&angle).then_some(angle)
}

/// Which of the triangles at an edge belong together: their indices in `places`, each once.
#[cfg_attr(small, optimize(size))]
pub(super) fn partners(facets: &[Facet], places: &[[usize; 2]]) -> Vec<(usize, Option<usize>)> {
    let first = |i: usize| {
        let angles = (0..places.len()).filter_map(|j| {
            let angle = turn(facets, places[i], places[j])?;
            Some((angle, j))
        });
        let nearest = angles.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.map(|(_, j)| j)
    };
    let next: Vec<_> = (0..places.len()).map(first).collect();
    let partner = |i: usize| next[i].filter(|&j| next[j] == Some(i));
    (0..places.len())
        .map(|i| (i, partner(i)))
        .filter(|(i, partner)| partner.is_none_or(|j| *i < j))
        .collect()
}

/// What lies beyond an edge of one triangle alone; none if nothing does. `near` calls its argument
/// with what is near a point.
pub(super) fn beyond(
    facets: &[Facet],
    [index, edge]: [usize; 2],
    near: impl Fn(&Vec3, &mut dyn FnMut(usize, &Facet)),
) -> Option<usize> {
    let facet = &facets[index];
    let [a, b] = facet.ends(edge);
    let mut found = None;
    for k in 0..LOOKS {
        let share = (f64::from(k) + 0.5) / f64::from(LOOKS);
        let p = a + (b - a) * share + facet.away(edge) * SEAM;
        let mut here = None;
        near(&p, &mut |other, next| {
            let on = next.normal.dot(&facet.normal) > 0.0;
            let up = next.normal.dot(&facet.inward[edge]) > EVEN_EDGE;
            if other != index && next.carries(&p) && (on || up) {
                here = Some(other);
            }
        });
        found = Some(here?);
    }
    found
}

/// The surface goes on in the triangle `other` beyond an edge of one triangle alone. The crest is
/// lost, unless it falls there.
pub(super) fn go_on(
    (facets, crests): (&mut [Facet], &mut [Crest]),
    [index, edge]: [usize; 2],
    other: usize,
) {
    let falls = facets[other].normal.dot(&facets[index].away(edge));
    let sides = [facets[index].normal, facets[other].normal];
    let facet = &mut facets[index];
    if falls > EVEN_EDGE {
        if let Some(crest) = facet.crests[edge] {
            crests[crest] = Crest::new(facet.ends(edge), sides);
        }
        return;
    }
    facet.crests[edge] = None;
    facet.beyond[edge] = if falls > -EVEN_EDGE {
        Beyond::Seam
    } else {
        Beyond::Hollow
    };
}

/// Edges at which a surface ends and other terrain goes on along all of them, by triangle and edge.
///
/// - `carried`: adds the parts of a segment, from 0 to 1, that other terrain carries with about the
///   given normal
pub(super) fn beside(
    (facets, crests): (&[Facet], &[Crest]),
    carried: impl Fn([Vec3; 2], &Vec3, &mut Vec<[f64; 2]>),
) -> Vec<[usize; 2]> {
    let places = (0..facets.len()).flat_map(|index| (0..3).map(move |edge| [index, edge]));
    let mut parts = Vec::new();
    let is_seam = |[index, edge]: &[usize; 2]| {
        let facet = &facets[*index];
        let away = facet.away(*edge);
        let crest = facet.crests[*edge].map(|crest| &crests[crest]);
        crest.is_some_and(|crest| crest.is_free) && {
            let ends = facet.ends(*edge).map(|end| end + away * SEAM);
            parts.clear();
            carried(ends, &facet.normal, &mut parts);
            cover(&mut parts, SEAM / (ends[1] - ends[0]).norm())
        }
    };
    places.filter(is_seam).collect()
}
