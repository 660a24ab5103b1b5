//! Energies and momenta.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::Kinematics;
use crate::spatial::{Vec3, Vec6, add6, dot6};
use crate::tree::Tree;
use std::ops::Range;

/// Kinetic energy, J, of the bodies that a step works on and of the rotors (armature); reads
/// `kin.V`, `kin.I`.
pub fn kinetic(tree: &Tree, kin: &Kinematics, v: &[f64]) -> f64 {
    let bodies = tree.worked_bodies().map(|(b, _)| {
        let V = &kin.V[b];
        dot6(V, &kin.I[b].mul(V))
    });
    let bodies: f64 = bodies.sum();
    let rotors = tree
        .worked_dofs()
        .map(|k| tree.dofs.armature[k] * v[k] * v[k]);
    let rotors: f64 = rotors.sum();
    0.5 * (bodies + rotors)
}

/// Potential energy of gravity on the moving bodies, J, zero at the world's origin; reads `kin.I`,
/// `kin.origins`.
pub fn potential(tree: &Tree, kin: &Kinematics) -> f64 {
    tree.worked_bodies()
        .filter(|(_, body)| body.kind.moves())
        .map(|(b, body)| {
            let I = &kin.I[b];
            let moment = Vec3::from(I.moment) + kin.origins[body.tree] * I.mass;
            -tree.world.gravity.dot(&moment)
        })
        .sum()
}

/// Angular momentum about O and linear momentum of a tree, world axes; reads `kin.V`, `kin.I`.
///
/// - `bodies`: those of the tree
pub fn momentum(kin: &Kinematics, bodies: Range<usize>) -> Vec6 {
    let mut sum = [0.0; 6];
    for (V, I) in kin.V[bodies.clone()].iter().zip(&kin.I[bodies]) {
        add6(&mut sum, &I.mul(V));
    }
    sum
}
