//! The search for pairs that come near, beside a look at all of them.

use super::*;
use crate::model::{LinkId, Motion, RootKind};
use crate::simulation::Simulation;
use crate::spatial::RigidInertia;
use crate::testing::{Builder, Random, inertia};

/// A shape of some centimetres, or of a metre where it is `large`.
fn shape(random: &mut Random, large: bool) -> Shape {
    let size = if large { 1.0 } else { 0.05 };
    let half = Vec3::from_fn(|_, _| size * random.uniform(0.1, 1.0));
    let (radius, half_length) = (half.x, half.y);
    match random.below(5) {
        0 => Shape::Sphere { radius },
        1 => Shape::Capsule {
            radius,
            half_length,
        },
        2 => Shape::Cylinder {
            radius,
            half_length,
        },
        3 => Shape::Box { half },
        _ => Shape::Hull {
            vertices: (0..8).map(|_| random.unit().component_mul(&half)).collect(),
        },
    }
}

/// So many shapes at random, in a box of `extent` m, two on each body; every tenth body stands
/// still, every seventh robot has two arms that touch each other, and some shapes are large. They
/// fly at up to 3 m/s.
fn cloud(count: usize, extent: Vec3, seed: u64) -> Model {
    let random = &mut Random(seed);
    let mut all: Option<Model> = None;
    let (mut shapes, mut bodies) = (0, 0);
    while shapes < count {
        bodies += 1;
        let floats = bodies % 10 != 0;
        let mass = if floats {
            inertia(1.0, Vec3::zeros(), [0.01; 3])
        } else {
            RigidInertia::ZERO
        };
        let mut b = Builder::new(floats, mass);
        for _ in 0..2 {
            let large = random.below(100) == 0;
            let place = Pose {
                p: random.vector(0.1),
                ..Pose::IDENTITY
            };
            b.shape(LinkId(0), shape(random, large), place);
            shapes += 1;
        }
        if floats && bodies % 7 == 0 {
            for side in [-0.05, 0.05] {
                let place = crate::testing::at(side, 0.0, 0.05);
                let part = inertia(0.1, Vec3::zeros(), [1e-4; 3]);
                let arm = b.link(LinkId(0), place, Motion::Revolute(Vec3::y()), part);
                b.shape(arm, shape(random, false), Pose::IDENTITY);
                shapes += 1;
            }
            b.model.roots[0].self_collision = true;
        }
        let root = &mut b.model.roots[0];
        root.position = random.vector(0.5).component_mul(&extent);
        root.rpy = random.vector(3.0);
        if floats {
            root.linear_velocity = random.vector(3.0);
            root.angular_velocity = random.vector(5.0);
        }
        match &mut all {
            None => all = Some(b.model),
            Some(all) => all.join(b.model, &format!("thing{bodies}"), RootKind::Object),
        }
    }
    all.expect("some")
}

/// A simulation of a model and where its bodies begin.
fn started(model: &Model) -> (Simulation, Kinematics) {
    let simulation = crate::testing::start(model.clone(), 1e-3);
    let (tree, state) = (simulation.tree(), &simulation.state().physical);
    let mut kin = Kinematics::new(tree);
    kin.update_poses(tree, &state.q);
    kin.update_velocities(tree, &state.v);
    (simulation, kin)
}

/// 500 shapes in a cloud, along each axis and in a plane: each pair that may touch and is nearer
/// than both go in the time, or nearer than the margin, by the distance of the shapes themselves,
/// is listed once, by ascending places. A sum of the balls' radii that left out the margin or the
/// velocity, or a sweep that ended at the first ball apart, would lose some.
#[test]
fn the_search_finds_every_pair_of_500_shapes_that_a_look_at_all_pairs_finds() {
    for (extent, seed) in [
        (Vec3::repeat(1.5), 1),
        (Vec3::new(40.0, 0.1, 0.1), 2),
        (Vec3::new(0.1, 40.0, 0.1), 3),
        (Vec3::new(0.0, 5.0, 5.0), 4),
    ] {
        let model = cloud(500, extent, seed);
        model.validate().expect("valid");
        let (simulation, kin) = started(&model);
        let tree = simulation.tree();
        let mut pairs = Pairs::new(&model);
        for [h, margin] in [[0.0, 0.0], [0.004, 1e-3], [0.01, 0.0]] {
            pairs.search(tree, &kin, [h, margin]);
            assert!(pairs.near.is_sorted(), "{:?}", pairs.near);
            let listed: std::collections::BTreeSet<_> = pairs.near.iter().copied().collect();
            assert_eq!(listed.len(), pairs.near.len());
            let (mut near, mut count) = (0, 0);
            for a in 0..tree.contact.colliders.len() {
                for b in a + 1..tree.contact.colliders.len() {
                    if !tree.contact.may_touch([a, b]) {
                        assert!(!listed.contains(&[a, b]), "{a} {b}");
                        continue;
                    }
                    count += 1;
                    let pair = Pair::new(tree, &kin, [a, b]).expect("two shapes");
                    if pair.is_near(h * pair.speed(&kin) + margin) {
                        near += 1;
                        assert!(listed.contains(&[a, b]), "{a} {b}, {extent} {h} {margin}");
                    }
                }
            }
            // It finds some, and leaves nearly all of 125,000 out.
            assert!(near > 50 && count > 100_000, "{near} of {count}");
            assert!(listed.len() < count / 10, "{} of {count}", listed.len());
        }
    }
}

/// Pairs of a cloud that touch where a step ends are not looked at anew where the next one begins,
/// and those that have moved are. With no room for what is kept all would be.
#[test]
fn pairs_that_touch_are_known_where_they_stand() {
    let model = cloud(100, Vec3::repeat(0.3), 5);
    let (simulation, mut kin) = started(&model);
    let tree = simulation.tree();
    let mut pairs = Pairs::new(&model);
    let mut touching = Vec::new();
    let still = ([0.0, 0.0], true);
    pairs.each(
        (tree, &kin),
        still,
        |_| false,
        |slot, _, _, _| {
            touching.push(slot);
            false
        },
    );
    let mut patch = Patch::new();
    let mut recall = |kin: &Kinematics| {
        let known = pairs.near.iter().filter(|places| {
            let pair = Pair::new(tree, kin, **places).expect("two shapes");
            let found = pairs.kept.recall(**places, &pair, &mut patch, 1e-3);
            found == Some(true)
        });
        known.count()
    };
    assert!(touching.len() > 100, "{}", touching.len());
    assert!(recall(&kin) >= touching.len(), "{}", touching.len());
    for pose in &mut kin.X {
        pose.p.x += 1e-9 * pose.p.x.abs().max(1.0);
    }
    assert_eq!(recall(&kin), 0);
}
