//! Contacts: their impulses, stiffness and energy.

use super::*;
use crate::geometry::Shape;
use crate::geometry::pair::tests::any_shape;
use crate::kinematics::{Kinematics, advance};
use crate::law::normal::Stiffening;
use crate::law::{Damping, ElastoPlastic};
use crate::simulation::Simulation;
use crate::spatial::{Mat3, Pose, Vec3, Vec6, angular, dot6, linear, velocity_at};
use crate::testing::{Builder, Random, inertia, start};

/// Energy that the springs of all points hold, J, and the force on the body about its origin
/// (moment, force).
fn springs(s: &Simulation, q: &[f64]) -> (f64, Vec6) {
    let mut kin = Kinematics::new(s.tree());
    kin.update_poses(s.tree(), q);
    kin.update_velocities(s.tree(), &[0.0; 6]);
    let mut list = ContactSet::new([0, 0]);
    detect(s.model(), s.tree(), &[], &kin, 0.0, &mut list);
    let (mut energy, mut force) = (0.0, [[0.0; 6]]);
    for c in list.iter() {
        energy += c.stored();
        let (f, moment) = c.wrench(&list.points, &[[0.0; 6]]);
        c.act(&f, &moment, &mut force);
    }
    let force = force[0];
    (energy, force)
}

/// The elastic force is minus the gradient of the springs' energy, at every tilt of a cylinder:
/// else tilting it to and fro would make energy.
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

/// A contact of a body with two corners and the rim of a cylinder, all of them pressed in.
pub(crate) fn random_contact(
    random: &mut Random,
    body: usize,
    points: &mut Vec<ContactPoint>,
) -> Contact {
    let (first, normal) = (points.len(), random.unit());
    for corner in 0..3 {
        let axis = random.unit();
        let radius = random.uniform(0.1, 0.3);
        let x = random.vector(0.5);
        let of_face = [random.uniform(1e-3, 3e-3), random.uniform(0.1, 0.5)];
        let rim = (corner == 2).then(|| {
            let a = (axis - normal * normal.dot(&axis)) * radius;
            let [crown, landing] = [0; 2].map(|_| random.uniform(1e-3, 0.1));
            Rim::new(axis, a, [radius, crown, landing])
        });
        points.push(ContactPoint {
            rim,
            ..ContactPoint::new(Some(corner), x, &normal, of_face)
        });
    }
    let mut contact = Contact {
        body,
        slot: body,
        normal,
        points: first..points.len(),
        spring: Stiffening {
            stiffness: 1e4,
            reference: 4e-3,
        },
        damping: Damping {
            power: random.uniform(1.0, 8.0),
            ..Damping::new(0.2)
        },
        load: random.uniform(0.0, 100.0),
        tilting: random.uniform(0.0, 20.0),
        friction: ElastoPlastic {
            cap: random.uniform(0.0, 20.0),
            stiffness: 8e3,
            damping: 30.0,
            ..ElastoPlastic::default()
        },
        ..Contact::default()
    };
    contact.gather(points, &vec![Vec6::default(); body + 1], 0.0);
    contact.slide_along(&random.vector(1.0));
    contact
}

/// A contact, its points, and the velocities of its body that a spatial velocity gives.
fn random(random: &mut Random) -> (Contact, Vec<ContactPoint>) {
    let mut points = Vec::new();
    let mut contact = random_contact(random, 0, &mut points);
    let stored = random.vector(1e-3);
    contact.friction.displacement = stored;
    (contact, points)
}

fn spatial(random: &mut Random, size: f64) -> Vec6 {
    let (w, v) = (random.vector(size), random.vector(size));
    [w.x, w.y, w.z, v.x, v.y, v.z]
}

/// Impulses on the body about O for its spatial velocity.
fn impulse(contact: &Contact, points: &[ContactPoint], W: &Vec6, h: f64) -> Vec6 {
    let V = [*W];
    let at: Vec<PointVelocity> = contact.velocities(points, &V).collect();
    let mut out = Vec::new();
    let u = contact.sliding(&V);
    let r = contact.response(points, Some(&u), |i| at[i], h, &mut out);
    let mut F = [[0.0; 6]];
    contact.push(points, (&r, &out), h, &mut F);
    F[0]
}

fn dot(a: &Vec6, b: &Vec6) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn moved(a: &Vec6, b: &Vec6, share: f64) -> Vec6 {
    std::array::from_fn(|i| a[i] + share * b[i])
}

/// Impulses are the gradient of a convex cost: they fall along every change of the velocity.
#[test]
fn the_impulse_is_monotone_in_the_velocity() {
    let mut rng = Random(11);
    for _ in 0..3000 {
        let (contact, points) = random(&mut rng);
        let h = libm::pow(10.0, rng.uniform(-5.0, -1.0));
        let size = libm::pow(10.0, rng.uniform(-3.0, 1.0));
        let (a, b) = (spatial(&mut rng, size), spatial(&mut rng, size));
        let change = moved(&b, &a, -1.0);
        let fall = moved(
            &impulse(&contact, &points, &b, h),
            &impulse(&contact, &points, &a, h),
            -1.0,
        );
        let scale = dot(&change, &change).sqrt() * dot(&fall, &fall).sqrt();
        assert!(dot(&fall, &change) <= 1e-12 * scale, "{h} {size}");
    }
}

/// What the line search takes for slope and curvature, against the impulses themselves and
/// their differences.
#[test]
fn power_and_curvature_are_those_of_the_impulse() {
    let mut rng = Random(12);
    for _ in 0..300 {
        let (contact, points) = random(&mut rng);
        let h = libm::pow(10.0, rng.uniform(-4.0, -2.0));
        let (W, along) = (spatial(&mut rng, 0.1), spatial(&mut rng, 1.0));
        let V = [W];
        let at: Vec<PointVelocity> = contact.velocities(&points, &V).collect();
        let directions: Vec<PointVelocity> = contact.velocities(&points, &[along]).collect();
        let (u, du) = (contact.sliding(&V), contact.sliding(&[along]));
        let mut out = Vec::new();
        let r = contact.response(&points, Some(&u), |i| at[i], h, &mut out);
        let power = Contact::power((&r, &out), (&du, &directions), h);
        let expected = dot(&impulse(&contact, &points, &W, h), &along);
        assert!((power - expected).abs() < 1e-10 * (1.0 + expected.abs()));
        let step = 1e-7;
        let ahead = impulse(&contact, &points, &moved(&W, &along, step), h);
        let behind = impulse(&contact, &points, &moved(&W, &along, -step), h);
        let difference = -dot(&moved(&ahead, &behind, -1.0), &along) / (2.0 * step);
        let curvature = contact.curvature(&points, (&r, &out), (&du, &directions), h);
        // One of many may stand on a kink.
        let error = (curvature - difference).abs();
        assert!(
            error < 1e-4 * (1.0 + difference.abs()),
            "{curvature} {difference}"
        );
    }
}

/// At the start the wrench is the limit of the impulses of short steps.
#[test]
fn the_wrench_at_the_start_is_that_of_a_short_step() {
    let mut rng = Random(13);
    for _ in 0..300 {
        let (contact, points) = random(&mut rng);
        let W = spatial(&mut rng, 0.05);
        let h = 1e-9;
        let F = impulse(&contact, &points, &W, h);
        let (force, moment) = contact.wrench(&points, &[W]);
        let wrench = [moment.x, moment.y, moment.z, force.x, force.y, force.z];
        let size = dot(&wrench, &wrench).sqrt();
        for (f, w) in F.iter().zip(wrench) {
            assert!((f / h - w).abs() < 1e-4 * (1.0 + size), "{F:?} {wrench:?}");
        }
    }
}

/// Work of friction over the step, `h F·u`, against what its spring holds more: while it sticks
/// `ς` moves by `h u`, and the rest is the damper's; while it slips the spring is stretched by
/// no more than the slip's way, or loses.
#[test]
fn friction_gives_back_no_more_than_it_was_paid() {
    let mut rng = Random(9);
    for _ in 0..10_000 {
        let (mut contact, _) = random(&mut rng);
        let h = libm::pow(10.0, rng.uniform(-7.0, -1.0));
        let size = libm::pow(10.0, rng.uniform(-5.0, 1.0));
        contact.friction.cap = 20.0;
        let most = contact.friction.cap / contact.friction.stiffness;
        let (stored, u) = (rng.vector(1.5 * most), rng.vector(size));
        contact.friction.displacement = stored;
        let paid = h * contact.friction.respond(u, h).force.dot(&u);
        let next = contact.friction.next(u, h);
        let more = 0.5 * contact.friction.stiffness * (next.norm_squared() - stored.norm_squared());
        assert!(
            more <= paid + 1e-12 * contact.friction.cap * most,
            "{h} {u} {stored}"
        );
    }
}

/// Both bodies feel the same wrench, with opposite signs, and moving together is no motion.
#[test]
fn two_bodies_push_each_other_with_opposite_wrenches() {
    let mut rng = Random(14);
    let (mut contact, _) = random(&mut rng);
    let from = rng.vector(0.3);
    contact.other = Some(Other {
        body: 1,
        from,
        axes: Mat3::identity(),
    });
    let (a, b) = (spatial(&mut rng, 0.1), spatial(&mut rng, 0.1));
    // The same motion, about the other tree's O.
    let about_other = |V: &Vec6| {
        let v = velocity_at(V, &-from);
        [V[0], V[1], V[2], v.x, v.y, v.z]
    };
    assert!(contact.sliding(&[a, about_other(&a)]).norm() < 1e-15);
    let relative = moved(&a, &b, -1.0);
    let slides = contact.sliding(&[a, about_other(&b)]);
    let expected = contact.sliding(&[relative, [0.0; 6]]);
    assert!((slides - expected).norm() < 1e-15);
    let mut F = [[0.0; 6]; 2];
    contact.act(&Vec3::new(7.0, 8.0, 9.0), &Vec3::new(1.0, 2.0, 3.0), &mut F);
    // The force is opposite, and so is the moment about one point.
    let (f, g) = (linear(&F[0]), linear(&F[1]));
    assert_eq!(f, -g);
    let moment = angular(&F[1]) - from.cross(&g);
    assert!((angular(&F[0]) + moment).norm() < 1e-14);
    // What both do to a common motion is nothing.
    let power = dot6(&F[0], &a) + dot6(&F[1], &about_other(&a));
    assert!(power.abs() < 1e-14);
}

/// Two bodies with these shapes.
pub(super) fn two_bodies(shapes: &[Shape; 2]) -> Simulation {
    let body = |shape: &Shape| {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.01; 3]));
        b.shape(0usize.into(), shape.clone(), Pose::IDENTITY);
        b.model
    };
    let mut model = body(&shapes[0]);
    model.join(body(&shapes[1]), "other", crate::model::RootKind::Object);
    Simulation::new(std::sync::Arc::new(model))
}

/// Where two bodies stand, the first one at `pose` and the other one at the origin, and what
/// touches.
pub(super) fn met(s: &Simulation, pose: &Pose) -> (Kinematics, ContactSet) {
    let turn = crate::spatial::quaternion_from_rotation(&pose.R);
    let mut q = s.state().physical.q.clone();
    q[..3].copy_from_slice(pose.p.as_slice());
    q[3..7].copy_from_slice(&[turn.w, turn.i, turn.j, turn.k]);
    q[7..10].fill(0.0);
    let mut kin = Kinematics::new(s.tree());
    kin.update_poses(s.tree(), &q);
    kin.update_velocities(s.tree(), &[0.0; 12]);
    let mut list = ContactSet::of(s.model());
    detect(s.model(), s.tree(), &[], &kin, 0.0, &mut list);
    (kin, list)
}

/// The contact of two bodies.
struct Touching {
    depth: f64,
    /// What its rows make of a displacement.
    rate: f64,
    /// Whether they are found by differences.
    by_differences: bool,
}

/// The contact of two bodies, the first one at `pose`, for the displacement `W` of this one about
/// the origin.
fn touching(s: &Simulation, pose: &Pose, W: &Vec6) -> Option<Touching> {
    let (_, list) = met(s, pose);
    let contact = list.iter().find(|c| c.other.is_some() && c.depth > 0.0)?;
    let own = &list.points[contact.points.clone()];
    // About the origin of the body that is pushed.
    let moved = velocity_at(W, &pose.p);
    let W = if contact.body == 0 {
        [W[0], W[1], W[2], moved.x, moved.y, moved.z]
    } else {
        W.map(|x| -x)
    };
    let along: f64 = own.iter().map(|p| p.load * p.along(&W)).sum();
    Some(Touching {
        depth: contact.depth,
        rate: -contact.weights * along,
        by_differences: contact.uneven,
    })
}

/// Errors of the rows of contacts at random poses, against central differences: of those that are
/// found by differences, or of the others, up to the depth `deepest`, m.
fn errors_of_rows(
    (shapes, random): (&[Shape; 2], &mut Random),
    (by_differences, deepest): (bool, f64),
    out: &mut Vec<f64>,
) {
    let s = two_bodies(shapes);
    for _ in 0..100 {
        let pose = Pose {
            R: crate::spatial::rotation_from_rpy(&random.vector(3.0)),
            p: random.vector(0.15),
        };
        let (v, w) = (random.vector(1.0), random.vector(5.0));
        let W = [w.x, w.y, w.z, v.x, v.y, v.z];
        let touches = |pose: &Pose| {
            let found = touching(&s, pose, &W)?;
            (found.by_differences == by_differences).then_some(found)
        };
        let Some(here) = touches(&pose).filter(|here| here.depth < deepest) else {
            continue;
        };
        let at = |by: f64| {
            let turn = crate::spatial::rotation_from_rpy(&(w * by));
            let moved = Pose {
                R: turn * pose.R,
                p: turn * pose.p + v * by,
            };
            touches(&moved).map(|found| found.depth)
        };
        let by = 1e-7;
        if let (Some(before), Some(after)) = (at(-by), at(by)) {
            out.push((here.rate - (after - before) / (2.0 * by)).abs());
        }
    }
}

/// The row of a ball is the gradient of its depth without differences, whatever it touches: so it
/// is left as it is where the ball bounces, too. Derivatives by central differences.
#[test]
fn the_row_of_a_ball_is_the_gradient_of_its_depth() {
    let mut random = Random(8);
    for kind in 0..5 {
        let mut worst: Vec<f64> = Vec::new();
        for _ in 0..300 {
            let shapes = [0, kind].map(|kind| any_shape(kind, 0.15, &mut random));
            errors_of_rows((&shapes, &mut random), (false, 5e-4), &mut worst);
        }
        let most = worst.iter().copied().fold(0.0, f64::max);
        assert!(
            worst.len() > 20 && most < 1e-8,
            "{kind}: {most} of {}",
            worst.len()
        );
    }
}

/// Where the direction between two shapes turns as they move, the rows of their contact are the
/// gradient of its depth: else a contact that slides makes energy.
/// Derivatives by central differences.
#[test]
fn rows_of_deep_contacts_are_the_gradient_of_their_depth() {
    let mut random = Random(7);
    let mut worst: Vec<f64> = Vec::new();
    for _ in 0..200 {
        let mut size = || random.uniform(0.05, 0.15);
        let half = Vec3::new(size(), size(), size());
        let shapes = [
            Shape::Box { half },
            Shape::Cylinder {
                radius: size(),
                half_length: size(),
            },
        ];
        // As deep as a contact gets, and not so that the axis of least overlap may jump.
        errors_of_rows((&shapes, &mut random), (true, 3e-3), &mut worst);
    }
    worst.sort_by(f64::total_cmp);
    // Depths have kinks: where one lies within the differences, they see both sides of it.
    let most = worst[worst.len() * 98 / 100];
    assert!(worst.len() > 50 && most < 5e-3, "{most} of {}", worst.len());
}

/// What friction has stored is the same energy when the load has changed: nobody pays for it.
#[test]
fn friction_keeps_its_energy_under_another_load() {
    let spring = Stiffening {
        stiffness: 1e4,
        reference: 1e-4,
    };
    let at = |depth: f64| Contact {
        spring,
        friction: ElastoPlastic {
            stiffness: crate::tuning::TANGENTIAL_RATIO * spring.slope(depth),
            ..ElastoPlastic::default()
        },
        ..Contact::default()
    };
    let (light, heavy) = (at(2e-5), at(2e-3));
    let slip = Vec3::new(3e-5, -1e-5, 2e-5);
    let energy = |c: &Contact, slip: &Vec3| 0.5 * c.friction.stiffness * slip.norm_squared();
    let kept = heavy.recall_slip(&light.keep_slip(&slip));
    let (before, after) = (energy(&light, &slip), energy(&heavy, &kept));
    assert!((after / before - 1.0).abs() < 1e-14, "{before} {after}");
    let back = light.recall_slip(&heavy.keep_slip(&kept));
    assert!((back - slip).norm() < 1e-19, "{back}");
}

/// Shapes without a thickness have no such gradient, and forces that are numbers.
#[test]
fn a_flat_hull_deep_in_a_box_pushes_with_a_number() {
    let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0);
    let plate = Shape::Hull {
        vertices: [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]
            .map(|(x, y)| corner(x, y))
            .to_vec(),
    };
    let half = Vec3::repeat(0.1);
    for other in [Shape::Box { half }, plate.clone()] {
        let s = two_bodies(&[plate.clone(), other]);
        let mut kin = Kinematics::new(s.tree());
        let mut q = s.state().physical.q.clone();
        let place = [0.02, 0.01, 0.0995, 0.995, 0.1, 0.0, 0.0];
        q[..7].copy_from_slice(&place);
        q[7..10].fill(0.0);
        kin.update_poses(s.tree(), &q);
        kin.update_velocities(s.tree(), &[0.0; 12]);
        let mut list = ContactSet::of(s.model());
        detect(s.model(), s.tree(), &[], &kin, 0.0, &mut list);
        for c in list.iter() {
            let (f, moment) = c.wrench(&list.points, &kin.V);
            assert!(f.iter().chain(&moment).all(|x| x.is_finite()), "{f}");
        }
    }
}
