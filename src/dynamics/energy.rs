//! Energies and momenta.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::Kinematics;
use crate::spatial::{Vec3, Vec6, add6, dot6};
use crate::tree::Tree;

/// Kinetic energy, J, of the bodies and of the rotors (armature); reads `kin.V`, `kin.I`.
pub fn kinetic(tree: &Tree, kin: &Kinematics, v: &[f64]) -> f64 {
    let bodies: f64 = kin
        .V
        .iter()
        .zip(&kin.I)
        .map(|(V, I)| dot6(V, &I.mul(V)))
        .sum();
    let rotors: f64 = tree
        .dofs
        .armature
        .iter()
        .zip(v)
        .map(|(a, v)| a * v * v)
        .sum();
    0.5 * (bodies + rotors)
}

/// Potential energy of gravity on the moving bodies, J, zero at the world's origin; reads `kin.I`,
/// `kin.origin`.
pub fn potential(tree: &Tree, kin: &Kinematics) -> f64 {
    tree.bodies
        .iter()
        .zip(&kin.I)
        .filter(|(body, _)| body.kind.moves())
        .map(|(_, I)| {
            let moment = Vec3::from(I.moment) + kin.origin * I.mass;
            -tree.world.gravity.dot(&moment)
        })
        .sum()
}

/// Angular momentum about O and linear momentum, world axes; reads `kin.V`, `kin.I`.
pub fn momentum(kin: &Kinematics) -> Vec6 {
    let mut sum = [0.0; 6];
    for (V, I) in kin.V.iter().zip(&kin.I) {
        add6(&mut sum, &I.mul(V));
    }
    sum
}
