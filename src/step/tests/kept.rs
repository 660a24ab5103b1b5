//! What moves freely below joints keeps its momentum, as a floating base does.
//!
//! Expected values: Newton's laws. What nothing pushes along a direction has a centre of mass that
//! moves along it as gravity says, and keeps its angular momentum about it; what turns about an
//! axis that stands still keeps its angular momentum about the axis.

use super::worlds::books;
use super::*;
use crate::kinematics::Kinematics;

/// Two tolerances and two fixed steps.
const WAYS: [(f64, f64); 4] = [(1e-3, 0.0), (1e-5, 0.0), (1e-3, 1.0 / 240.0), (1e-3, 1e-3)];

/// What stays of the bodies from one on.
#[derive(Clone, Copy, Debug)]
enum Stays {
    /// The centre of mass in a direction, but for gravity.
    Center(Vec3),
    /// The angular momentum in a direction, about the centre of mass.
    Spin(Vec3),
    /// The same about the world's origin.
    Moment(Vec3),
}

/// Place and velocity of the centre of mass of the bodies from one on, m and m/s, and their angular
/// momentum about it and about the world's origin.
fn measure(s: &Simulation, from: usize) -> [Vec3; 4] {
    let state = &s.state().physical;
    let mut kin = Kinematics::new(s.tree());
    kin.update_poses(s.tree(), &state.q);
    kin.update_velocities(s.tree(), &state.v);
    let (mut mass, mut moment) = (0.0, Vec3::zeros());
    let (mut p, mut L) = (Vec3::zeros(), Vec3::zeros());
    for (I, V) in kin.I.iter().zip(&kin.V).skip(from) {
        let H = I.mul(V);
        let push = Vec3::new(H[3], H[4], H[5]);
        mass += I.mass;
        moment += Vec3::from(I.moment) + kin.origins[0] * I.mass;
        L += Vec3::new(H[0], H[1], H[2]) + kin.origins[0].cross(&push);
        p += push;
    }
    let center = moment / mass;
    [center, p / mass, L - center.cross(&p), L]
}

/// A chain of joints that hang on each other, with the masses of what they move, in the world.
fn chain(joints: &[(Motion, f64)]) -> (Builder, LinkId) {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let mut last = LinkId(0);
    for (motion, mass) in joints {
        let own = if *mass > 0.0 {
            inertia(*mass, Vec3::new(0.05, 0.02, 0.01), [0.02, 0.03, 0.025])
        } else {
            RigidInertia::ZERO
        };
        last = b.link(last, Pose::IDENTITY, *motion, own);
    }
    (b, last)
}

/// The same with an arm on the last body, which a motor turns to and fro.
fn with_arm(joints: &[(Motion, f64)], axis: Vec3) -> Builder {
    let (mut b, last) = chain(joints);
    let arm = b.link(
        last,
        at(0.1, 0.0, 0.05),
        Motion::Revolute(axis),
        inertia(0.5, Vec3::new(0.2, 0.0, 0.1), [0.01; 3]),
    );
    b.actuator(arm, ActuatorMode::Velocity, 5.0);
    b
}

/// A name, the robot, gravity, the first body of which something stays, and what stays.
type Case = (&'static str, Builder, Vec3, usize, Vec<Stays>);

fn cases() -> Vec<Case> {
    use Stays::{Center, Moment, Spin};
    let Z = Vec3::z();
    let (slide, turn) = (Motion::Prismatic, Motion::Revolute);
    let oblique = Vec3::new(0.5, 0.75_f64.sqrt(), 0.0);
    let ball = (Motion::Spherical, 1.0);
    let plane = [Center(X), Center(Y), Spin(Z)];
    let space = [Center(X), Center(Y), Center(Z), Spin(X), Spin(Y), Spin(Z)];
    let fall = Vec3::new(1.0, -2.0, -G);
    let none = Vec3::zeros();
    let floats = [(slide(X), 0.0), (slide(Y), 0.0), (slide(Z), 0.0), ball];
    let mut cases: Vec<Case> = vec![];
    let joints = [(slide(X), 0.0), (slide(Y), 0.0), (turn(Z), 1.0)];
    cases.push(("plane", with_arm(&joints, Z), fall, 0, plane.into()));
    cases.push((
        "arm that nods in it",
        with_arm(&joints, Y),
        fall,
        0,
        plane.into(),
    ));
    let joints = [(turn(Z), 0.0), (slide(X), 0.0), (slide(Y), 1.0)];
    cases.push((
        "yaw before the slides",
        with_arm(&joints, Z),
        fall,
        0,
        plane.into(),
    ));
    let joints = [(slide(X), 2.0), (slide(oblique), 3.0), (turn(Z), 1.0)];
    cases.push((
        "heavy slides",
        with_arm(&joints, Z),
        fall,
        0,
        vec![Center(X)],
    ));
    cases.push((
        "the second one",
        with_arm(&joints, Z),
        fall,
        2,
        vec![Center(oblique)],
    ));
    cases.push((
        "floating joint",
        with_arm(&floats, Y),
        fall,
        0,
        space.into(),
    ));
    let balls = [ball];
    let about = vec![Moment(X), Moment(Y), Moment(Z)];
    cases.push(("ball joint", with_arm(&balls, Y), none, 0, about));
    let upright = Vec3::new(0.0, 0.0, -G);
    let joints = [(turn(Z), 1.0)];
    cases.push(("turret", with_arm(&joints, Y), upright, 0, vec![Moment(Z)]));
    let joints = [(turn(Z), 1.0), (slide(Z), 0.5)];
    cases.push(("drill", with_arm(&joints, Y), upright, 0, vec![Moment(Z)]));
    cases.push(("its bit", with_arm(&joints, Y), upright, 2, vec![Center(Z)]));
    // Two motors: a turntable below what floats.
    let mut joints = vec![(turn(Z), 5.0)];
    joints.extend(floats);
    let mut driven = with_arm(&joints, Y);
    driven.actuator(LinkId(1), ActuatorMode::Velocity, 50.0);
    cases.push((
        "floating joint on a turntable",
        driven,
        fall,
        2,
        space.into(),
    ));
    cases
}

#[test]
fn what_moves_freely_keeps_its_momentum_wherever_its_joints_hang() {
    use Stays::{Center, Moment, Spin};
    for (name, mut b, gravity, from, stays) in cases() {
        b.model.world.gravity = gravity;
        b.model.initial.joint_velocities[0] = 0.3;
        for (tolerance, step) in WAYS {
            let mut model = b.model.clone();
            model.solver.step_size = step;
            let mut s = start(model, tolerance);
            let before = measure(&s, from);
            let motor = s.model().actuators[0].dof.index();
            let mut moved = 0.0_f64;
            for i in 0..480 {
                let target = if (i / 60) % 2 == 0 { 10.0 } else { -10.0 };
                s.set_input(InputSlot::Velocity(0.into()), target);
                if s.model().actuators.len() > 1 {
                    s.set_input(InputSlot::Velocity(1.into()), -0.2 * target);
                }
                s.advance_to(f64::from(i + 1) / 240.0).expect("finite");
                moved = moved.max(s.state().physical.v[motor].abs());
                let (t, now) = (s.time(), measure(&s, from));
                for stays in &stays {
                    let [off, size] = match stays {
                        Center(u) => {
                            let way = now[0] - before[0] - before[1] * t - gravity * (0.5 * t * t);
                            let faster = now[1] - before[1] - gravity * t;
                            [u.dot(&way).abs().max(u.dot(&faster).abs()), 1.0 + G * t * t]
                        }
                        Spin(w) => {
                            // The difference of moments about O.
                            let size = 1.0 + gravity.norm_squared() * t * t * t;
                            [w.dot(&(now[2] - before[2])).abs(), size]
                        }
                        Moment(w) => [w.dot(&(now[3] - before[3])).abs(), 1.0],
                    };
                    assert!(
                        off < 1e-12 * size,
                        "{name}, {tolerance:.0e}, {step} s, {t} s: {stays:?} by {off:e}"
                    );
                }
            }
            assert!(moved > 3.0, "{name}: the motor has not turned");
        }
    }
}

/// Two pucks on planar joints meet each other and a ball: what they have together in the plane
/// stays.
#[test]
fn pucks_below_planar_joints_keep_their_common_momentum() {
    for (tolerance, step) in WAYS {
        let (slide, turn) = (Motion::Prismatic, Motion::Revolute(Vec3::z()));
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let half = Vec3::repeat(0.05);
        for (place, speed, mass) in [(-0.2, 1.0, 1.0), (0.0, 0.0, 2.0)] {
            let mut last = LinkId(0);
            for axis in [X, Y] {
                let X_PB = if last == LinkId(0) {
                    at(place, 0.0, 0.0)
                } else {
                    Pose::IDENTITY
                };
                last = b.link(last, X_PB, slide(axis), RigidInertia::ZERO);
            }
            let own = inertia(mass, Vec3::new(0.02, 0.03, 0.0), [0.002; 3]);
            last = b.link(last, Pose::IDENTITY, turn, own);
            b.shape(last, Shape::Box { half }, Pose::IDENTITY);
            let joints = b.model.initial.joint_velocities.len();
            b.model.initial.joint_velocities[joints - 3] = speed;
            b.model.initial.joint_velocities[joints - 1] = 2.0;
        }
        b.model.roots[0].self_collision = true;
        let radius = 0.05;
        let ball = super::worlds::body(0.5, Shape::Sphere { radius }, Vec3::new(0.2, 0.03, 0.0));
        let mut model = super::worlds::world([b.model, ball]);
        (model.world.ground, model.world.gravity) = (None, Vec3::zeros());
        model.solver.step_size = step;
        let mut s = start(model, tolerance);
        let (L, p, _) = books(&s);
        for i in 1..=240 {
            s.advance_to(f64::from(i) / 240.0).expect("finite");
            let (now, pushed, _) = books(&s);
            let off = [(pushed - p).xy().norm(), (now - L).z.abs()];
            assert!(
                off[0] < 1e-13 && off[1] < 1e-13,
                "{tolerance:.0e}, {step} s: {off:?}"
            );
        }
        let ball = s.state().physical.v.len() - 6;
        assert!(
            s.state().physical.v[3].abs() > 0.1,
            "the pucks have not met"
        );
        assert!(
            s.state().physical.v[ball + 3].abs() > 0.1,
            "the ball has not been met"
        );
    }
}
