//! A mesh → a few convex parts that leave its notches open, by VHACD.
//!
//! Parry fills the mesh with voxels and cuts these along planes until each part is nearly convex. A
//! part is the hull of the mesh's own surface within its voxels and not of the voxels, so that the
//! soles of feet keep their shape.

use super::faces::scaled;
use super::mesh::MeshFile;
use super::scope::Scope;
use crate::geometry::{Shape, bounded_hull};
use crate::spatial::Vec3;
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Most parts of a mesh.
const MOST_PARTS: u32 = 16;

/// Corners that are kept of a part.
const MOST_CORNERS: usize = 32;

/// Voxels along the longest side: notches narrower than a fiftieth of it are filled.
const RESOLUTION: u32 = 64;

/// Share of the hull's volume by which a part may be larger than what it stands for.
const CONCAVITY: f64 = 0.002;

/// For meshes of which no parts can be made.
pub(super) const CUT_HELP: &str =
    "set collision = \"hull\" for this link, or give it several simpler meshes";

/// A decomposed mesh.
#[derive(Debug, PartialEq)]
pub(super) struct Decomposition {
    /// Corners of each part, m.
    pub(super) parts: Vec<Vec<Vec3>>,
    /// How much larger than the mesh the parts' volume and that of the mesh's hull are, as a share
    /// of the mesh's; none where the mesh is not closed.
    pub(super) excess: Option<[f64; 2]>,
}

/// Decomposes the solid that triangles enclose. The same triangles give the same parts.
///
/// # Errors
/// What stands against it, for people.
pub(super) fn parts(triangles: &[[Vec3; 3]]) -> Result<Decomposition, String> {
    parts_of(triangles, RESOLUTION)
}

/// The same with another number of voxels along the longest side.
pub(super) fn parts_of(triangles: &[[Vec3; 3]], voxels: u32) -> Result<Decomposition, String> {
    let corners = triangles.as_flattened();
    let whole = bounded_hull(corners, usize::MAX).map_err(|error| error.to_string())?;
    if whole.flat {
        return Err("it has no volume".to_owned());
    }
    let size = whole
        .vertices
        .iter()
        .map(|v| (v - whole.vertices[0]).norm())
        .fold(0.0, f64::max);
    // To a size near 1, for parry's tolerances; by a power of two, so no digit is lost.
    let unit = libm::exp2(libm::floor(libm::log2(size)));
    let points: Vec<Vector> = corners
        .iter()
        .map(|p| p / unit)
        .map(|p| Vector::new(p.x, p.y, p.z))
        .collect();
    let count = u32::try_from(points.len()).map_err(|_| "it has too many faces".to_owned())?;
    let faces: Vec<[u32; 3]> = (0..count / 3)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let parameters = VHACDParameters {
        resolution: voxels,
        concavity: CONCAVITY,
        max_convex_hulls: MOST_PARTS,
        ..VHACDParameters::default()
    };
    // Parry takes some shapes for impossible.
    let surfaces = catch_unwind(AssertUnwindSafe(|| {
        VHACD::decompose(&parameters, &points, &faces, true)
            .compute_primitive_intersections(&points, &faces)
    }))
    .map_err(|_| "its surface is folded or too thin".to_owned())?;
    let mut parts = Vec::new();
    for surface in surfaces {
        let surface: Vec<Vec3> = surface
            .iter()
            .map(|p| Vec3::new(p.x, p.y, p.z) * unit)
            .collect();
        // A part inside has no surface; one that a plane has just touched has no volume.
        if let Ok(hull) = bounded_hull(&surface, MOST_CORNERS)
            && !hull.flat
        {
            parts.push(hull.vertices);
        }
    }
    if parts.is_empty() {
        return Err("no part of it has volume".to_owned());
    }
    let excess = enclosed(triangles).map(|solid| {
        let volume = |vertices: &Vec<Vec3>| {
            Shape::Hull {
                vertices: vertices.clone(),
            }
            .volume()
        };
        let filled: f64 = parts.iter().map(volume).sum();
        [filled, volume(&whole.vertices)].map(|volume| volume / solid - 1.0)
    });
    Ok(Decomposition { parts, excess })
}

/// The convex parts of a mesh; says how many, and how much they fill that the mesh does not.
pub(super) fn convex_parts(
    scope: &mut Scope,
    mesh: &MeshFile,
    name: &str,
    factors: Vec3,
    at: &Range<usize>,
) -> Option<Vec<Vec<Vec3>>> {
    let triangles = mesh.triangles().map_err(|error| error.to_string());
    match triangles.and_then(|triangles| parts(&scaled(&triangles, &factors))) {
        Ok(found) => {
            let volume = match found.excess {
                Some([parts, hull]) => format!(
                    "their volume is off the mesh's by {:.1} %, its hull's would be by {:.1} %",
                    parts * 100.0,
                    hull * 100.0
                ),
                None => "it is not closed, so its volume is not known".to_owned(),
            };
            let count = found.parts.len();
            let message = format!("mesh {name} becomes {count} convex parts; {volume}");
            scope.note("U114", at.clone(), &message, "");
            Some(found.parts)
        }
        Err(error) => {
            let message = format!("mesh {name} cannot be decomposed: {error}");
            scope.problem("U115", at.clone(), &message, CUT_HELP);
            None
        }
    }
}

/// The volume that triangles enclose, m³; none where they leave gaps.
pub(super) fn enclosed(triangles: &[[Vec3; 3]]) -> Option<f64> {
    let top = triangles.first()?[0];
    let (mut volume, mut open, mut area) = (0.0, Vec3::zeros(), 0.0);
    for [a, b, c] in triangles {
        let normal = (b - a).cross(&(c - a));
        volume += normal.dot(&(a - top)) / 6.0;
        open += normal;
        area += normal.norm();
    }
    // A closed surface shows as much to the left as to the right.
    (open.norm() <= 1e-6 * area && volume != 0.0).then(|| volume.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A prism over a polygon in x and z that a fan from its first corner fills, 0.1 m wide in y.
    fn prism(outline: &[[f64; 2]]) -> Vec<[Vec3; 3]> {
        let at = |i: usize, y: f64| {
            let [x, z] = outline[i % outline.len()];
            Vec3::new(x, y, z)
        };
        let mut triangles = Vec::new();
        for i in 0..outline.len() {
            let [a, b] = [at(i, -0.05), at(i + 1, -0.05)];
            let [c, d] = [at(i, 0.05), at(i + 1, 0.05)];
            triangles.extend([[a, d, b], [a, c, d]]);
            if (1..outline.len() - 1).contains(&i) {
                triangles.extend([[at(0, -0.05), a, b], [at(0, 0.05), d, c]]);
            }
        }
        triangles
    }

    /// An L in x and z: legs of 0.3 m, 0.1 m thick; seen from the inner corner, every side is
    /// visible.
    fn l() -> Vec<[Vec3; 3]> {
        prism(&[
            [0.1, 0.1],
            [0.1, 0.3],
            [0.0, 0.3],
            [0.0, 0.0],
            [0.3, 0.0],
            [0.3, 0.1],
        ])
    }

    /// Whether `p` adds nothing to a part.
    fn contains(part: &[Vec3], p: &Vec3) -> bool {
        let mut with = part.to_vec();
        with.push(*p);
        let volume = |vertices: Vec<Vec3>| Shape::Hull { vertices }.volume();
        volume(with) <= volume(part.to_vec()) * (1.0 + 1e-9)
    }

    /// By hand: the L has 0.1 (0.3² - 0.2²) = 0.005 m³, its hull a triangle of legs 0.2 m more,
    /// 0.002 m³ or 40 %.
    #[test]
    fn the_notch_of_an_l_stays_open() {
        let found = parts(&l()).expect("parts");
        assert!(found.parts.len() >= 2, "{}", found.parts.len());
        let [parts, hull] = found.excess.expect("it is closed");
        assert!((hull - 0.4).abs() < 1e-9, "{hull}");
        assert!(parts.abs() < 0.02, "{parts}");
        // In the notch, but in the hull: 0.15 + 0.15 < 0.4.
        let notch = Vec3::new(0.15, 0.0, 0.15);
        assert!(!found.parts.iter().any(|part| contains(part, &notch)));
        for solid in [[0.05, 0.0, 0.05], [0.05, 0.0, 0.25], [0.25, 0.0, 0.05]] {
            let solid = Vec3::from(solid);
            assert!(found.parts.iter().any(|part| contains(part, &solid)));
        }
        // The outermost corners are those of the mesh, not of voxels 5 mm wide.
        let all = found.parts.concat();
        for (axis, low, high) in [(0, 0.0, 0.3), (1, -0.05, 0.05), (2, 0.0, 0.3)] {
            let lowest = all.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
            let highest = all.iter().map(|p| p[axis]).fold(0.0, f64::max);
            assert!((lowest - low).abs() < 1e-12 && (highest - high).abs() < 1e-12);
        }
    }

    #[test]
    fn parts_are_the_same_each_time_and_at_each_size() {
        let once = parts(&l()).expect("parts");
        assert_eq!(parts(&l()).expect("parts"), once);
        let large: Vec<_> = l().iter().map(|t| t.map(|p| p * 1024.0)).collect();
        let large = parts(&large).expect("parts");
        let small: Vec<Vec<Vec3>> = large
            .parts
            .iter()
            .map(|part| part.iter().map(|p| p / 1024.0).collect())
            .collect();
        assert_eq!(small, once.parts);
    }

    #[test]
    fn meshes_without_volume_are_refused_and_open_ones_have_no_volume_error() {
        let flat = l()[..1].to_vec();
        assert!(parts(&flat).is_err());
        assert!(parts(&[]).is_err());
        let mut open = l();
        open.pop();
        assert_eq!(parts(&open).expect("parts").excess, None);
    }

    /// The mesh file is the L of these tests, its ends polygons with six corners.
    #[test]
    fn a_decomposed_mesh_gives_one_collider_for_each_part() {
        use crate::settings::Settings;
        use crate::urdf::{ReadOptions, read_str};
        let text = r#"<robot name="r"><link name="foot">
            <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
            <collision><geometry><mesh filename="bracket.obj"/></geometry></collision></link></robot>"#;
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots/meshes");
        let build = |settings: &str| {
            let settings = Settings::parse(settings, "s").expect("settings");
            let options = crate::assemble::read_options(&settings, ReadOptions::default());
            let robot = read_str(text, "r", &folder, &options).expect("a robot");
            let notes = robot.diagnostics.iter().map(|d| d.code).collect::<Vec<_>>();
            let built = crate::assemble::build(&robot, &settings).expect("a model");
            (built.model.colliders, notes)
        };
        let (hull, notes) = build("");
        assert_eq!(hull.len(), 1);
        assert!(notes.contains(&"U110") && !notes.contains(&"U114"));
        let (parts, notes) = build("[link.\"f*\"]\ncollision = \"decomposition\"\n");
        assert!(parts.len() >= 2 && !notes.contains(&"U110") && notes.contains(&"U114"));
        let volume = |shapes: &[crate::model::Collider]| -> f64 {
            shapes.iter().map(|collider| collider.shape.volume()).sum()
        };
        assert!((volume(&hull) - 0.007).abs() < 1e-12);
        assert!((volume(&parts) / 0.005 - 1.0).abs() < 0.02);
        let both =
            "[link.\"*\"]\ncollision = \"decomposition\"\n[link.foot]\ncollision = \"hull\"\n";
        assert_eq!(build(both).0.len(), 1);
    }
}
