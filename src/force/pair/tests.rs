//! Two shapes of very different size.

use crate::geometry::Shape;
use crate::model::{ActuatorId, ActuatorMode, LinkId, Motion};
use crate::simulation::{InputSlot, OutputSlot};
use crate::spatial::{Pose, RigidInertia, Vec3};
use crate::testing::{Builder, at, inertia, run, start};

/// A ball that a motor pushes against a point, as some robots have them where they touch things,
/// stops in as many steps as against a small ball, and presses with the motor's force: what a
/// step expects must not lie beyond the middles of both, and these are far apart.
#[test]
fn a_ball_meets_a_point_in_as_many_steps_as_a_small_ball() {
    for step in [0.0, 1.0 / 240.0] {
        let steps = [1e-4, 1e-9].map(|radius| {
            let mut b = Builder::new(false, RigidInertia::ZERO);
            for (x, radius) in [(-0.05, radius), (0.05, 0.02)] {
                let slide = b.link(
                    LinkId(0),
                    at(x, 0.0, 0.0),
                    Motion::Prismatic(Vec3::x()),
                    inertia(0.2, Vec3::zeros(), [1e-4; 3]),
                );
                b.shape(slide, Shape::Sphere { radius }, Pose::IDENTITY);
                b.actuator(slide, ActuatorMode::Effort, 20.0);
            }
            b.model.world.gravity = Vec3::zeros();
            b.model.world.ground = None;
            b.model.roots[0].self_collision = true;
            b.model.solver.step_size = step;
            let mut s = start(b.model, 1e-3);
            s.set_input(InputSlot::Effort(ActuatorId(0)), 10.0);
            s.set_input(InputSlot::Effort(ActuatorId(1)), -10.0);
            run(&mut s, 0.5, 0.01);
            let force = s.output(OutputSlot::ContactForce(LinkId(1), 0));
            assert!((force + 10.0).abs() < 1e-3, "{force}");
            s.state().stepping.counters.steps
        });
        assert!(steps[1] <= 2 * steps[0], "{steps:?}");
    }
}
