//! Rods and springs between two points, which loops that hold a distance and springs are drawn as.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::format::{End, Scene, Shape, Tie, short, vector};
use super::mesh;
use super::pose::link_poses;
use urdf2fmu_core::model::{Anchor, LinkId, LoopKind, Model};
use urdf2fmu_core::spatial::{Pose, Vec3, rotation_to_axis};

/// Radius of a rod, as a part of its length.
const ROD: f64 = 0.008;

/// Radius of the coil of a spring, as a part of the length that it has without force.
const COIL: f64 = 0.05;

/// Radius of a spring's wire, as a part of that of its coil.
const WIRE: f64 = 0.15;

/// Turns of a spring; its ends are straight for a tenth of it each.
const TURNS: f64 = 9.0;
const STRAIGHT: f64 = 0.1;

/// Places along a spring where its wire has a ring of corners, and corners of a ring.
const RINGS: u32 = 180;
const CORNERS: u32 = 6;

/// The colour of steel, which no file gives.
const STEEL: [f64; 4] = [0.62, 0.64, 0.67, 1.0];

/// Adds the rods and springs of a model to a scene of it.
pub(super) fn add(scene: &mut Scene, model: &Model) {
    let poses = link_poses(&scene.head, |_| None);
    let mut ties = Vec::new();
    for held in &model.loops {
        if let LoopKind::Distance { ends, length } = &held.kind {
            let radius = short(ROD * length);
            let shape = Shape::Cylinder([radius, 1.0]);
            ties.push(tie(&held.name, ends, shape, None));
        }
    }
    // One mesh is the coil of all springs.
    let packed = (!model.springs.is_empty()).then(|| mesh::pack_whole(&coil(), &[]));
    if let Some(packed) = packed.flatten() {
        let coil = Shape::Mesh(scene.head.meshes.len());
        let mesh = mesh::append(&mut scene.body, &packed);
        scene.head.meshes.push(mesh);
        for spring in &model.springs {
            let ends = spring.ends.each_ref().map(end);
            // One without a length of its own is as long as it is at the start.
            let length = if spring.length > 0.0 {
                spring.length
            } else {
                between(&ends, &poses).1
            };
            let radius = short(COIL * length);
            let scale = Some([radius, radius, 1.0]);
            ties.push(tie(&spring.name, &spring.ends, coil, scale));
        }
    }
    scene.head.ties = ties;
}

fn tie(name: &str, ends: &[Anchor; 2], shape: Shape, scale: Option<[f64; 3]>) -> Tie {
    Tie {
        name: name.to_owned(),
        ends: ends.each_ref().map(end),
        shape,
        scale,
        color: STEEL,
    }
}

fn end(anchor: &Anchor) -> End {
    End {
        link: anchor.link.map(LinkId::index),
        position: vector(&anchor.X_LA.p),
    }
}

/// Where what is between two points stands, in the middle of them with its z axis from the first to
/// the second, and how far they are apart, m. What is drawn there is as many times as long as it
/// is, along z.
///
/// - `poses`: of all links
pub fn between(ends: &[End; 2], poses: &[Pose]) -> (Pose, f64) {
    let [a, b] = ends.map(|end| {
        let p = Vec3::from(end.position);
        end.link.map_or(p, |link| poses[link].point(&p))
    });
    let way = b - a;
    let axis = way.try_normalize(0.0).unwrap_or_else(Vec3::z);
    let X_WT = Pose {
        R: rotation_to_axis(&axis),
        p: (a + b) * 0.5,
    };
    (X_WT, way.norm())
}

/// The triangles of a coil of the radius 1 from −½ to ½ along z, which begins and ends on the axis.
fn coil() -> Vec<[Vec3; 3]> {
    let ring = |i: u32| {
        let along = f64::from(i) / f64::from(RINGS);
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * TURNS * along);
        let outwards = Vec3::new(cos, sin, 0.0);
        // Out of the axis, and into it again, within the straight ends.
        let out = (along.min(1.0 - along) / STRAIGHT).clamp(0.0, 1.0);
        let center = outwards * out + Vec3::z() * (along - 0.5);
        // Across the wire, which goes around the axis: outwards, and along it.
        (0..CORNERS).map(move |j| {
            let (sin, cos) =
                libm::sincos(std::f64::consts::TAU * f64::from(j) / f64::from(CORNERS));
            // A spring is some ten times as long as its coil is wide.
            let up = Vec3::z() * (COIL * sin);
            center + (outwards * cos + up) * WIRE
        })
    };
    let rings: Vec<Vec<Vec3>> = (0..=RINGS).map(|i| ring(i).collect()).collect();
    let mut triangles = Vec::new();
    for pair in rings.windows(2) {
        let [lower, upper] = [&pair[0], &pair[1]];
        for j in 0..lower.len() {
            let next = (j + 1) % lower.len();
            triangles.push([lower[j], lower[next], upper[next]]);
            triangles.push([lower[j], upper[next], upper[j]]);
        }
    }
    triangles
}
