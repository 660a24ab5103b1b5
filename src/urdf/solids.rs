//! Mass and inertia of a link whose collision shapes are taken as solids.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::description::CollisionDescription;
use crate::range::Range;
use crate::spatial::{Mat3, RigidInertia};

/// Mass, centre of mass and inertia of `shapes`, each a solid of `density` kg/m³, in the link's
/// axes.
/// None where they have no volume.
pub(crate) fn of_density(density: f64, shapes: &[CollisionDescription]) -> Option<RigidInertia> {
    let mut total = RigidInertia::ZERO;
    for collision in shapes {
        let mass = density * collision.shape.volume();
        if mass > 0.0 {
            let solid = collision.shape.solid_inertia(mass);
            total = total.joined(&solid.transformed(&collision.X_LG));
        }
    }
    // Symmetric to the last bit.
    total.I_cm = (total.I_cm + total.I_cm.transpose()) * 0.5;
    Range::Mass.contains(total.mass).then_some(total)
}

/// Inertia tensor in the link's axes of a link of `mass` kg that consists of `shapes`, each a
/// solid, all of one density; about the shapes' common centre of mass. None where they have no
/// volume.
///
/// The link keeps the centre of mass that the file gives: as with `PyBullet`, whose default this
/// follows, the shapes say how large the link is, not where its mass lies.
pub(crate) fn of_solids(mass: f64, shapes: &[CollisionDescription]) -> Option<Mat3> {
    let volumes: Vec<f64> = shapes.iter().map(|c| c.shape.volume()).collect();
    let volume: f64 = volumes.iter().sum();
    if !(volume > 0.0 && volume.is_finite()) {
        return None;
    }
    let mut total = RigidInertia::ZERO;
    for (collision, own) in shapes.iter().zip(&volumes) {
        if *own > 0.0 {
            let solid = collision.shape.solid_inertia(mass * own / volume);
            total = total.joined(&solid.transformed(&collision.X_LG));
        }
    }
    // Symmetric to the last bit.
    Some((total.I_cm + total.I_cm.transpose()) * 0.5)
}
