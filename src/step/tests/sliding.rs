//! Bodies that slide on a face and spin: where friction acts on the face changes all the time.

use super::*;

/// Place and half of the yaw of a box of 0.2 m that slides with (1, 0.5) m/s and spins with 6 rad/s
/// until it stands, after 0.5 s.
fn stopped([tolerance, step, h]: [f64; 3]) -> Vec3 {
    let mut b = block(1.0, 0.5);
    b.model.roots[0].linear_velocity = Vec3::new(1.0, 0.5, 0.0);
    b.model.roots[0].angular_velocity.z = 6.0;
    b.model.solver.step_size = step;
    let mut s = start(b.model, tolerance);
    run(&mut s, 0.5, h);
    let q = &s.state().physical.q;
    Vec3::new(q[0], q[1], q[6])
}

/// Against its own solution at 1e-8 in communication steps of 1/4000 s. It leans into its friction,
/// and the direction of that turns. While a step took from its start how a face shares its load
/// among its corners, an error of first order in its length was left that no tolerance changed: the
/// place was off by 0.36 mm in fixed steps and by 0.28, 0.2, 0.26 and 0.11 mm at 1e-3 to 1e-6, the
/// yaw by 3 to 7 mrad.
#[test]
fn what_slides_and_spins_stops_where_the_tolerance_says() {
    let h = 1.0 / 240.0;
    let exact = stopped([1e-8, 0.0, 1.0 / 4000.0]);
    for (tolerance, step, off) in [
        (1e-3, 1.0 / 240.0, 4e-4),
        (1e-3, 0.0, 5e-4),
        (1e-4, 0.0, 2.5e-4),
        (1e-5, 0.0, 5e-5),
        (1e-6, 0.0, 1.5e-5),
    ] {
        let error = (stopped([tolerance, step, h]) - exact).norm();
        assert!(error < off, "{tolerance:.0e}, {step}: {error:e}");
    }
}
