//! Contact points and their law together.

use super::*;
use crate::geometry::Shape;
use crate::kinematics::{Kinematics, advance};
use crate::simulation::Simulation;
use crate::spatial::{Pose, Vec3, Vec6};
use crate::testing::{Builder, inertia, start};

/// Energy that the springs of all points hold, J, and the force on the body about its origin
/// (moment, force).
fn springs(s: &Simulation, q: &[f64]) -> (f64, Vec6) {
    let mut kin = Kinematics::new(s.tree());
    kin.update_poses(s.tree(), q);
    kin.update_velocities(s.tree(), &[0.0; 6]);
    let mut list = Vec::new();
    detect(
        s.model(),
        s.tree(),
        &[],
        &kin,
        0.0,
        f64::INFINITY,
        &mut list,
    );
    let (mut energy, mut force) = (0.0, [0.0; 6]);
    for c in &list {
        energy += 0.5 * c.spring.stiffness * c.gap.min(0.0).powi(2);
        let f = c.normal * c.normal_force(0.0);
        let moment = c.x.cross(&f);
        for i in 0..3 {
            force[i] += moment[i];
            force[3 + i] += f[i];
        }
    }
    (energy, force)
}

/// The elastic force is minus the gradient of the springs' energy, also while a cylinder stands up
/// and its line hands its load over to its rims: else tilting it to and fro would make energy.
/// Derivatives by central differences.
#[test]
fn the_springs_of_a_cylinder_do_the_work_of_their_energy_at_every_tilt() {
    let mut b = Builder::new(true, inertia(2.0, Vec3::zeros(), [0.01; 3]));
    let shape = Shape::Cylinder {
        radius: 0.1,
        half_length: 0.05,
    };
    b.shape(0usize.into(), shape, Pose::IDENTITY);
    b.model.world.ground = Some(crate::model::Ground::default());
    b.model.contact.dissipation = 0.0;
    let s = start(b.model, 1e-3);
    for tilt in [0.5_f64, 2.9, 3.1, 4.0, 5.0, 6.0, 7.9, 8.1, 20.0, 89.0] {
        let tilt = tilt.to_radians();
        let turned = tilt * 0.5;
        // Tilted about an axis that lies across none of the spokes.
        let (x, y) = (0.3_f64.cos(), 0.3_f64.sin());
        let lowest = 0.1 * tilt.sin() + 0.05 * tilt.cos();
        let q = [
            0.2,
            -0.1,
            lowest - 2e-3,
            turned.cos(),
            turned.sin() * x,
            turned.sin() * y,
            0.0,
        ];
        let (_, force) = springs(&s, &q);
        let scale = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        assert!(scale > 1.0, "{tilt}: nothing touches");
        for (i, f) in force.iter().enumerate() {
            let mut v = [0.0; 6];
            v[i] = 1.0;
            let energy = |h: f64| {
                let mut moved = q;
                advance(s.tree(), &q, &v, h, &mut moved);
                springs(&s, &moved).0
            };
            let slope = (energy(1e-7) - energy(-1e-7)) / 2e-7;
            assert!(
                (f + slope).abs() < 1e-5 * scale,
                "tilt {tilt}, direction {i}: {f} and {slope}"
            );
        }
    }
}
