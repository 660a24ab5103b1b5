//! What lies along an edge.

use super::*;

/// Where the load acts, as seen from the middle of `a` along `k`, m.
fn place(patch: &Patch, k: &Vec3) -> f64 {
    let loads = patch.points().iter().map(|p| {
        let load = p.share * p.depth.max(0.0).powi(3);
        (load, load * k.dot(&p.x))
    });
    let (load, moment) = loads.fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
    moment / load
}

/// A can, a capsule and, with an edge of its own, a prism of 16 sides lie along the upper edge of a
/// cube on its edge, 0.05 mm deep. All have their load in the middle of what they have in common,
/// as statics says of even ones, and while they rock by a microradian, which lifts an end by 0.03
/// µm, a thousandth of their depth, the load moves by some thousandths of the length.
#[test]
fn what_lies_along_an_edge_carries_with_both_ends() {
    let (half, depth) = (0.03, 5e-5);
    let edge = 0.05;
    let cube = solid(&cube(edge));
    let lower = at(
        Vec3::zeros(),
        turned(Vec3::y(), 0.25 * std::f64::consts::PI),
    );
    let top = edge * 2.0_f64.sqrt();
    let radius = 0.02;
    let prism = (0..32).map(|i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i / 2) / 16.0).sin_cos();
        let z = if i.is_multiple_of(2) { half } else { -half };
        Vec3::new(radius * cos, radius * sin, z)
    });
    let round = [
        Shape::Cylinder {
            radius,
            half_length: half,
        },
        Shape::Capsule {
            radius,
            half_length: half,
        },
    ];
    let prism = Shape::Hull {
        vertices: prism.collect(),
    };
    // Its z axis along the edge, and an edge of the prism down.
    let lies = turned(Vec3::x(), 0.5 * std::f64::consts::PI);
    let shapes = round.iter().map(|s| (s, radius, lies));
    let shapes = shapes.chain([(&prism, radius, lies)]);
    let mut patch = Patch::new();
    for (shape, low, R) in shapes {
        let upper = solid(shape);
        for shift in [0.0, 0.04] {
            let middle = Vec3::new(0.0, shift, 0.0);
            let common = 0.5 * ((shift - half).max(-edge) + (shift + half).min(edge));
            // The edges of the cube are rounded by 1 mm.
            let rounded = 1e-3 * (2.0_f64.sqrt() - 1.0);
            let z = top + low - depth - rounded;
            for tilt in [-1e-6, 0.0, 1e-6] {
                let R = turned(Vec3::x(), tilt) * R;
                let pose = at(middle + Vec3::new(0.0, 0.0, z), R);
                patch.find((&upper, &pose), (&cube, &lower), 1e-3);
                let off = place(&patch, &Vec3::y()) - common;
                assert!(off.abs() < 1e-3, "{shape:?} {shift} {tilt} {off}");
            }
        }
    }
}
