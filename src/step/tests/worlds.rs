//! Several trees in one world.

use super::*;
use crate::dynamics::energy;
use crate::kinematics::Kinematics;
use crate::model::RootKind;

/// A body of one shape on a floating base, its middle at `at`; it stands on a ground.
fn body(mass: f64, shape: Shape, at: Vec3) -> Model {
    let i = match &shape {
        Shape::Sphere { radius } => [0.4 * mass * radius * radius; 3],
        Shape::Box { half } => {
            [half.yz(), half.xz(), half.xy()].map(|h| mass / 3.0 * h.norm_squared())
        }
        Shape::Cylinder {
            radius,
            half_length,
        } => {
            let (r, h) = (radius * radius, half_length * half_length);
            let across = mass * (0.25 * r + h / 3.0);
            [across, across, 0.5 * mass * r]
        }
        _ => [0.01 * mass; 3],
    };
    let mut b = Builder::new(true, inertia(mass, Vec3::zeros(), i));
    b.shape(LinkId(0), shape, Pose::IDENTITY);
    b.model.roots[0].position = at;
    b.model
}

fn cube(mass: f64, at: Vec3) -> Model {
    body(
        mass,
        Shape::Box {
            half: Vec3::repeat(0.05),
        },
        at,
    )
}

fn ball(mass: f64, radius: f64, at: Vec3) -> Model {
    body(mass, Shape::Sphere { radius }, at)
}

/// All in one world, the first one as the robot.
fn world(models: impl IntoIterator<Item = Model>) -> Model {
    let mut models = models.into_iter();
    let mut all = models.next().expect("one");
    for (i, model) in models.enumerate() {
        all.join(model, &format!("other{i}"), RootKind::Object);
    }
    all.validate().expect("valid");
    all
}

/// Momentum about the world's origin, angular and linear, and energy without that of springs.
fn books(s: &Simulation) -> (Vec3, Vec3, f64) {
    let (tree, state) = (s.tree(), &s.state().physical);
    let mut kin = Kinematics::new(tree);
    kin.update_poses(tree, &state.q);
    kin.update_velocities(tree, &state.v);
    let (mut angular, mut linear) = (Vec3::zeros(), Vec3::zeros());
    for (part, origin) in tree.trees.iter().zip(&kin.origins) {
        let P = energy::momentum(&kin, part.bodies.clone());
        let p = Vec3::new(P[3], P[4], P[5]);
        linear += p;
        angular += Vec3::new(P[0], P[1], P[2]) + origin.cross(&p);
    }
    let held = energy::kinetic(tree, &kin, &state.v) + energy::potential(tree, &kin);
    (angular, linear, held)
}

#[test]
fn explore() {
    // stack
    let mut s = start(
        world([0.0499, 0.1498, 0.2497].map(|z| cube(1.0, Vec3::new(0.0, 0.0, z)))),
        1e-3,
    );
    s.advance_to(3.0).expect("finite");
    let z = [0, 1, 2].map(|i| s.state().physical.q[7 * i + 2]);
    println!("stack {z:?} {:?}", s.state().stepping.counters);
    let q = s.state().physical.q.clone();
    s.advance_to(100.0).unwrap();
    println!("moved {:?}", q == s.state().physical.q);
    // offset stack, dropped
    for tol in [1e-3, 1e-5] {
        let mut m = [0.06, 0.17, 0.28].map(|z| cube(1.0, Vec3::new(0.01 * z, 0.02 * z, z)));
        m[1].roots[0].rpy.z = 0.5;
        m[2].roots[0].rpy.z = -0.3;
        let mut s = start(world(m), tol);
        for k in 1..=10 {
            s.advance_to(0.2 * f64::from(k)).expect("finite");
            let v = s
                .state()
                .physical
                .v
                .iter()
                .fold(0.0_f64, |m, v| m.max(v.abs()));
            let z = [0, 1, 2].map(|i| s.state().physical.q[7 * i + 2]);
            println!(
                "drop {tol} t {} {z:.7?} v {v:e} {:?}",
                s.time(),
                s.state().stepping.counters
            );
        }
    }
    // mass ratio
    let mut s = start(
        world([
            cube(1e-3, Vec3::new(0.0, 0.0, 0.05)),
            cube(1e3, Vec3::new(0.0, 0.0, 0.15)),
        ]),
        1e-3,
    );
    s.advance_to(3.0).unwrap();
    println!(
        "ratio {:?} {:?} {:?}",
        s.state().physical.q[2],
        s.state().physical.q[9],
        s.state().stepping.counters
    );
    let mut s = start(
        world([
            cube(1e3, Vec3::new(0.0, 0.0, 0.05)),
            cube(1e-3, Vec3::new(0.0, 0.0, 0.15)),
        ]),
        1e-3,
    );
    s.advance_to(3.0).unwrap();
    println!(
        "ratio {:?} {:?} {:?}",
        s.state().physical.q[2],
        s.state().physical.q[9],
        s.state().stepping.counters
    );
    // collision in space
    for tol in [1e-3, 1e-5] {
        let mut m = world([
            cube(1.0, Vec3::new(0.0, 0.0, 1.0)),
            ball(0.3, 0.04, Vec3::new(0.5, 0.03, 1.02)),
        ]);
        m.world.gravity = Vec3::zeros();
        m.world.ground = None;
        m.roots[1].linear_velocity = Vec3::new(-2.0, 0.1, 0.0);
        m.roots[1].angular_velocity = Vec3::new(0.0, 10.0, 20.0);
        for l in &mut m.links {
            l.restitution = 0.7;
        }
        let mut s = start(m, tol);
        let (a0, l0, e0) = books(&s);
        for k in 1..=10 {
            s.advance_to(0.1 * f64::from(k)).unwrap();
            let (a, l, e) = books(&s);
            println!(
                "hit {tol} {:.3} {:e} {:e} {:.6} {:?}",
                s.time(),
                (a - a0).norm(),
                (l - l0).norm(),
                e / e0,
                s.state().stepping.counters
            );
        }
    }
}

#[test]
fn look() {
    for (yaw, dx, dy) in [(0.5, 0.02, 0.2), (0.0, 0.02, 0.2), (0.5, 0.0, 0.2), (0.5, 0.2, 0.2)] {
        let mut m = [0.05, 0.15].map(|z| cube(1.0, Vec3::new(dx * z, dy * z, z)));
        m[1].roots[0].rpy.z = yaw;
        let mut s = start(world(m), 1e-5);
        for k in 0..=3 {
            s.advance_to(2.0 + 0.5 * f64::from(k)).expect("finite");
            let q = &s.state().physical.q;
            println!("t {yaw} {dx} {dy} {:.2} {:.3?} yaw {:.4e}", s.time(), s.state().physical.v.iter().map(|v| v*1e9).collect::<Vec<_>>(), q[13]);
            for t in &s.state().physical.memory.touches { println!("     {} {:.9?}", t.slot, t.displacement.map(|x| x*1e6)); }
        }
    }
}
