//! Several trees in one world.

use super::*;
use crate::model::{BodyId, Root, RootKind};

/// A cube of 10 cm and 1 kg on a floating base, its middle at `at`.
fn cube(at: Vec3) -> Model {
    let inertia = inertia(1.0, Vec3::zeros(), [1.0 / 600.0; 3]);
    let mut b = Builder::new(true, inertia);
    let half = Vec3::repeat(0.05);
    b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
    b.model.roots[0].position = at;
    b.model
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

#[test]
fn three_cubes_stand_on_each_other_at_their_static_depths() {
    let mut s = start(
        world([0.0499, 0.1498, 0.2497].map(|z| cube(Vec3::new(0.0, 0.0, z)))),
        1e-3,
    );
    s.advance_to(3.0).expect("finite");
    let z = [0, 1, 2].map(|i| s.state().physical.q[7 * i + 2]);
    println!("{z:?} {:?}", s.state().stepping.counters);
}
