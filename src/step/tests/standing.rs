//! What is set down before the first step, and what stands on points of the terrain.

use super::terrain::{field, ground, mesh, over};
use super::worlds::{body, depth};
use super::*;
use crate::geometry::pair::tests::solids::floor_with_hole;
use crate::spatial::{rotation_from_quaternion, rotation_from_rpy};

/// A box of 1 kg whose height follows from the ground, and in it 1 kg on a limp vertical slide.
fn loaded(half: Vec3) -> Builder {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.01; 3]));
    b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
    b.link(
        LinkId(0),
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::z()),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
    b.model.roots[0].position.z = half.z;
    b.model.roots[0].set_down = true;
    b
}

/// The joints of a robot that is set down do not move: the ground carries all of its weight, at the
/// depth of the law, although the slide would fall.
#[test]
fn a_robot_is_set_down_as_one_rigid_body() {
    let s = start(loaded(Vec3::repeat(0.1)).model, 1e-3);
    let sunk = 0.1 - s.state().physical.q[2];
    let expected = depth(1.0);
    assert!((sunk - expected).abs() < 1e-9, "{sunk:e} {expected:e}");
    assert_eq!(s.state().physical.q[7].to_bits(), 0.0_f64.to_bits());
}

/// There is no pose in which the ground carries a box whose middle lies beyond its edge: it begins
/// where it has been put.
#[test]
fn what_tips_over_is_not_set_down() {
    let mut b = loaded(Vec3::repeat(0.1));
    b.model.links[0].inertia.com = X * 0.3;
    // In the centre of mass.
    let before = [0.3, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0];
    let s = start(b.model, 1e-3);
    assert_eq!(s.state().physical.q[..7], before);
}

/// A box that is given an attitude stands on the lowest of its corners or edges; what the weight
/// does to it is seen when time has begun, from that attitude on. Small ones come down by a few
/// millimetres until they lie flat.
#[test]
fn what_is_set_down_keeps_the_attitude_that_it_is_given() {
    let sizes = [[0.02; 3], [0.1; 3], [0.4, 0.3, 0.2], [1.0, 0.6, 0.3]];
    for size in sizes {
        let half = Vec3::from(size) * 0.5;
        for rpy in [
            [0.01, 0.0, 0.0],
            [0.05, 0.0, 0.0],
            [0.2, 0.0, 0.0],
            [0.4, 0.3, 0.0],
        ] {
            let rpy = Vec3::from(rpy);
            let mut m = body(1.0, Shape::Box { half }, Vec3::zeros());
            let up = rotation_from_rpy(&rpy).transpose() * Vec3::z();
            m.roots[0].rpy = rpy;
            m.roots[0].position.z = up.abs().dot(&half) - depth(1.0);
            m.roots[0].set_down = true;
            let s = start(m, 1e-3);
            let q = &s.state().physical.q;
            let R = rotation_from_quaternion(&[q[3], q[4], q[5], q[6]]);
            let off = (R.transpose() * Vec3::z() - up).norm();
            assert!(off < 1e-9, "{size:?} {rpy:?}: {off:e}");
        }
    }
}

/// A bench whose legs differ by a third of the depth with which the ground carries it stands on all
/// four from the beginning: it leans by that over their distance, less by what the lower ones sink.
#[test]
fn what_lies_on_the_ground_but_for_its_sinking_is_set_down_on_all_of_it() {
    let half = Vec3::new(0.2, 0.2, 0.1);
    let tilt = depth(1.0) / 3.0 / 0.4;
    let mut m = body(1.0, Shape::Box { half }, Vec3::zeros());
    m.roots[0].rpy = X * tilt;
    m.roots[0].position.z = half.z + half.y * tilt - depth(1.0);
    m.roots[0].set_down = true;
    let s = start(m, 1e-3);
    let q = &s.state().physical.q;
    assert!(q[4].abs() < 1e-9, "{:e}", q[4]);
    let (sunk, expected) = (half.z - q[2], depth(1.0));
    assert!((sunk - expected).abs() < 1e-9, "{sunk:e} {expected:e}");
}

/// A board of 1 kg on four nails that stand out of the terrain, each a sample as sharp as a point.
/// Four points of the share one that are `d` deep count as one of the depth `δ = (4 d⁴)^¼ = √2 d`,
/// and push with `√2 N(δ)`.
#[test]
fn a_board_lies_on_four_nails_at_the_depth_of_the_law() {
    let nails = field(1.0, 20, |x, y| {
        let on = |x: f64| (x.abs() - 0.1).abs() < 1e-6;
        if on(x) && on(y) { 0.1 } else { 0.0 }
    });
    let half = Vec3::new(0.15, 0.15, 0.05);
    let board = body(1.0, Shape::Box { half }, Vec3::z() * (0.1 + half.z));
    let mut s = start(over(ground(nails, Vec3::zeros()), board), 1e-4);
    run(&mut s, 1.0, 0.01);
    let q = &s.state().physical.q;
    let (sunk, expected) = (0.1 + half.z - q[2], depth(0.5_f64.sqrt()) / 2.0_f64.sqrt());
    assert!((sunk - expected).abs() < 1e-9, "{sunk:e} {expected:e}");
    let tilt = q[4].abs().max(q[5].abs());
    assert!(tilt < 1e-9, "{tilt:e}");
}

/// A block of 0.2 m that is set upon stiff ground without a load and slides off at 1 m/s: its
/// friction is that of the loads which the steps find, and Coulomb stops it after `v²/(2 μ g)`,
/// without a hop.
#[test]
fn a_block_slides_on_stiff_ground_from_its_first_step_as_coulomb_says() {
    let (mu, v, h) = (0.5, 1.0, 1.0 / 60.0);
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let mut b = block(1.0, mu);
        b.model.contact.penetration = 1e-6;
        b.model.roots[0].linear_velocity = X * v;
        let mut s = start(b.model, tolerance);
        for i in 1..=30 {
            s.advance_to(f64::from(i) * h).expect("finite");
            let t = s.time().min(v / (mu * G));
            let expected = v * t - 0.5 * mu * G * t * t;
            let [x, z] = [0, 2].map(|k| s.state().physical.q[k]);
            assert!(
                (x - expected).abs() < 1e-4 && z < 0.1 + 1e-6,
                "{x} {expected} {z} at {tolerance}"
            );
        }
    }
}

/// A box on the rim of a hole in a mesh, 0.1 mm above it, stays where it is let down, as on even
/// ground. It was thrown by up to 0.5 m by walls of the hole that its corners were not in.
#[test]
fn a_box_over_a_hole_in_a_mesh_stays_there() {
    let half = Vec3::new(0.03, 0.03, 0.02);
    for sides in [6, 16, 32] {
        let terrain = mesh(&floor_with_hole(sides, 0.01));
        for tolerance in [1e-3, 1e-5] {
            let place = Vec3::new(0.003, 0.001, half.z + 1e-4);
            let one = body(1.0, Shape::Box { half }, place);
            let model = over(ground(terrain.clone(), Vec3::zeros()), one);
            let mut s = start(model, tolerance);
            run(&mut s, 0.5, 0.01);
            let q = &s.state().physical.q;
            let moved = (Vec3::new(q[0], q[1], q[2]) - place).norm();
            assert!(moved < 1e-3, "{sides} sides, {tolerance}: {moved} m");
        }
    }
}
