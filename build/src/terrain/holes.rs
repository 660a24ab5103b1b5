//! Holes of a mesh: what stands over one falls through.
//!
//! An edge that belongs to one triangle alone, and beyond which the surface does not go on, is a
//! part of its border. Along a border the triangles lie to the left. So the outer border of a floor
//! goes round counter-clockwise, seen from where the triangles look to, and the border of a hole
//! the other way.

use std::collections::BTreeMap;
use urdf2fmu_core::geometry::surface::{Beyond, Facet, Surface};
use urdf2fmu_core::spatial::Vec3;

/// Area over the square of the way round it below which a border encloses nothing: a slit between
/// triangles that have no corners in common, as in files of few digits.
const SLIT: f64 = 1e-4;

/// Cosine of the angle between a border's plane and the triangles along it, on average, from which
/// on it is a hole in them: that of a box without a lid is the end of its sides.
const FLAT: f64 = 0.5;

/// A hole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hole {
    /// Mean of its corners, in the frame of the mesh, m.
    pub middle: Vec3,
    /// m²
    pub area: f64,
}

/// A place, to the bit.
type Key = [u64; 3];

fn key(place: &Vec3) -> Key {
    // Zero has no sign here.
    [place.x, place.y, place.z].map(|x| (x + 0.0).to_bits())
}

/// The holes of a mesh, the largest first.
pub(super) fn holes(surface: &Surface) -> Vec<Hole> {
    let mut borders = borders(surface.facets());
    let mut found = Vec::new();
    while let Some((first, mut list)) = borders.pop_first() {
        let Some(start) = list.pop() else { continue };
        if !list.is_empty() {
            borders.insert(first, list);
        }
        let mut way = vec![start];
        let mut next = key(&start[1]);
        // Back to where it began, or to where a broken mesh leads no farther.
        while next != first
            && let Some(mut list) = borders.remove(&next)
        {
            let Some(edge) = list.pop() else { break };
            if !list.is_empty() {
                borders.insert(next, list);
            }
            way.push(edge);
            next = key(&edge[1]);
        }
        if next == first {
            found.extend(hole(&way));
        }
    }
    found.sort_by(|a, b| b.area.total_cmp(&a.area));
    found
}

/// The edges at which the surface ends, by where they begin: both ends, and the normal of the
/// triangle times the length.
fn borders(facets: &[Facet]) -> BTreeMap<Key, Vec<[Vec3; 3]>> {
    let ends = |facet: &Facet, edge: usize| [edge, (edge + 1) % 3].map(|i| facet.corners[i]);
    let edges = || {
        facets
            .iter()
            .flat_map(|facet| (0..3).map(move |edge| (facet, edge)))
    };
    // Whichever of its triangles goes along it.
    let name = |facet: &Facet, edge: usize| {
        let mut both = ends(facet, edge).map(|end| key(&end));
        both.sort_unstable();
        both
    };
    let mut shared: BTreeMap<[Key; 2], u32> = BTreeMap::new();
    for (facet, edge) in edges() {
        *shared.entry(name(facet, edge)).or_default() += 1;
    }
    let mut borders: BTreeMap<Key, Vec<[Vec3; 3]>> = BTreeMap::new();
    for (facet, edge) in edges().filter(|(facet, edge)| facet.beyond[*edge] == Beyond::Crest) {
        if shared.get(&name(facet, edge)) == Some(&1) {
            let [a, b] = ends(facet, edge);
            let weighted = facet.normal * (b - a).norm();
            borders.entry(key(&a)).or_default().push([a, b, weighted]);
        }
    }
    borders
}

/// What a closed border encloses, if that is a hole.
fn hole(way: &[[Vec3; 3]]) -> Option<Hole> {
    let (mut area, mut normal, mut middle, mut length) =
        (Vec3::zeros(), Vec3::zeros(), Vec3::zeros(), 0.0);
    let [origin, ..] = way.first()?;
    let mut count = 0.0;
    for [a, b, weighted] in way {
        area += (a - origin).cross(&(b - origin)) * 0.5;
        normal += weighted;
        length += (b - a).norm();
        middle += a;
        count += 1.0;
    }
    let size = area.norm();
    (area.dot(&normal) < -FLAT * size * length && size > SLIT * length * length).then(|| Hole {
        middle: middle / count,
        area: size,
    })
}
