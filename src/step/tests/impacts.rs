//! Bodies that hit each other.

use super::terrain::{grid, ground, mesh, over};
use super::worlds::{body, books, cube, speeds, world};
use super::*;

/// Two bodies that meet in space keep their momentum to round-off, and their angular momentum to
/// what the tolerance leaves; what friction and impact take does not come back.
#[test]
fn bodies_that_meet_in_space_keep_their_momentum() {
    for (tolerance, allowed) in [(1e-3, 1e-6), (1e-5, 1e-7)] {
        let ball = body(
            0.3,
            Shape::Sphere { radius: 0.04 },
            Vec3::new(0.5, 0.03, 1.02),
        );
        let mut model = world([cube(1.0, Vec3::new(0.0, 0.0, 1.0)), ball]);
        model.world.gravity = Vec3::zeros();
        model.world.ground = None;
        model.roots[1].linear_velocity = Vec3::new(-2.0, 0.1, 0.0);
        model.roots[1].angular_velocity = Vec3::new(0.0, 10.0, 20.0);
        for link in &mut model.links {
            link.restitution = 0.7;
        }
        let mut s = start(model, tolerance);
        let (angular, linear, energy) = books(&s);
        s.advance_to(1.0).expect("finite");
        let (now, p, held) = books(&s);
        assert!((p - linear).norm() < 1e-14 * linear.norm().max(1.0));
        assert!(
            (now - angular).norm() < allowed * angular.norm(),
            "{}",
            (now - angular).norm()
        );
        assert!(held < 0.8 * energy);
    }
}

/// Newton: two equal balls, the first at 1 m/s against the second at rest, go on at (1 ∓ e)/2.
#[test]
fn balls_that_meet_head_on_part_as_restitution_says() {
    for e in [1.0, 0.8, 0.3] {
        let at = |x: f64| body(0.5, Shape::Sphere { radius: 0.05 }, Vec3::new(x, 0.0, 1.0));
        let mut model = world([at(0.0), at(0.2)]);
        model.world.gravity = Vec3::zeros();
        model.roots[0].linear_velocity.x = 1.0;
        for link in &mut model.links {
            link.restitution = e;
        }
        let mut s = start(model, 1e-4);
        s.advance_to(1.0).expect("finite");
        let v = [3, 9].map(|i| s.state().physical.v[i]);
        let expected = [0.5 * (1.0 - e), 0.5 * (1.0 + e)];
        for (v, expected) in v.iter().zip(expected) {
            assert!((v - expected).abs() < 5e-3 * e, "{e}: {v} {expected}");
        }
    }
}

/// What lands on an edge, a corner, an end or a rim rebounds as what lands on a face: each is so
/// poised that it does not turn. At 0.1 m/s the weight takes its part, too.
#[test]
fn corners_and_edges_have_the_restitution_of_faces() {
    use std::f64::consts::FRAC_PI_4;
    let half = Vec3::repeat(0.1);
    let (capsule, cylinder) = (
        Shape::Capsule {
            radius: 0.05,
            half_length: 0.1,
        },
        Shape::Cylinder {
            radius: 0.1,
            half_length: 0.1,
        },
    );
    let lean = libm::atan(libm::sqrt(0.5));
    let cases = [
        (Shape::Box { half }, Vec3::zeros(), 0.1),
        (Shape::Box { half }, Vec3::x() * FRAC_PI_4, libm::sqrt(0.02)),
        (
            Shape::Box { half },
            Vec3::new(FRAC_PI_4, lean, 0.0),
            libm::sqrt(0.03),
        ),
        (capsule, Vec3::zeros(), 0.15),
        (cylinder, Vec3::x() * FRAC_PI_4, libm::sqrt(0.02)),
    ];
    for (shape, rpy, height) in cases {
        for (speed, step, look) in [
            (3.0, 0.0, 1.0 / 240.0),
            (3.0, 1.0 / 240.0, 1.0 / 240.0),
            (0.1, 0.0, 1e-3),
        ] {
            let at = Vec3::z() * (height + 1e-5);
            let mut model = world([body(1.0, shape.clone(), at)]);
            model.roots[0].rpy = rpy;
            model.roots[0].linear_velocity.z = -speed;
            model.links[0].restitution = 0.5;
            model.solver.step_size = step;
            let mut s = start(model, 1e-5);
            let left = (1..=20).find_map(|i| {
                s.advance_to(f64::from(i) * look).expect("finite");
                let (z, v) = (s.state().physical.q[2] - height, s.state().physical.v[5]);
                (z > 0.0 && v > 0.0).then(|| libm::sqrt(v * v + 2.0 * 9.81 * z))
            });
            let leaving = left.expect("a rebound");
            let e = leaving / libm::sqrt(speed * speed + 2.0 * 9.81e-5);
            assert!((e - 0.5).abs() < 5e-3, "{shape:?} at {speed} m/s: {e}");
        }
    }
}

/// A gram that hits a tonne is back after some microseconds, in steps as short as they get. They
/// keep its restitution, also where they err by more than the tolerance.
#[test]
fn a_gram_rebounds_from_a_tonne_at_every_tolerance() {
    for tolerance in [1e-3, 1e-5, 1e-6, 1e-7, 1e-9] {
        let at = |mass: f64, radius: f64, x: f64| {
            body(mass, Shape::Sphere { radius }, Vec3::new(x, 0.0, 1.0))
        };
        let mut model = world([at(1000.0, 0.5, 0.0), at(1e-3, 0.02, 0.53)]);
        model.world.gravity = Vec3::zeros();
        model.roots[1].linear_velocity.x = -5.0;
        for link in &mut model.links {
            link.restitution = 0.9;
        }
        let mut s = start(model, tolerance);
        s.advance_to(0.01).expect("finite");
        let e = s.state().physical.v[9] / 5.0;
        assert!((e - 0.9).abs() < 2e-3, "{tolerance:.0e}: {e}");
    }
}

/// A bounce takes as many steps as the time scale of its spring asks for, also where the weight
/// leaves hardly any of it: dropped from some tenths of a millimetre, without losses.
#[test]
fn a_gentle_bounce_without_losses_takes_few_steps() {
    for height in [1e-5, 3e-5, 1e-4, 3e-4, 1e-3] {
        let place = Vec3::new(0.0, 0.0, 0.05 + height);
        let mut model = world([body(0.5, Shape::Sphere { radius: 0.05 }, place)]);
        model.roots[0].linear_velocity.z = -0.02;
        model.links[0].restitution = 1.0;
        model.world.ground = Some(crate::model::Ground {
            restitution: 1.0,
            ..Default::default()
        });
        let mut s = start(model, 1e-3);
        s.advance_to(0.5).expect("finite");
        // A tenth of the time scale of a millisecond and more is a step of 0.1 ms.
        let steps = s.state().stepping.counters.steps;
        assert!(steps < 10_000, "{height}: {steps}");
        let lowest = s.state().physical.q[2];
        assert!((lowest - 0.05).abs() < height + 1e-3, "{height}: {lowest}");
    }
}

/// What has bounced and slides or rolls on is taken in steps as long as without restitution: a box
/// and a ball that fall from 1 cm at 1 m/s along the ground.
#[test]
fn what_has_bounced_and_rolls_on_takes_long_steps() {
    let half = Vec3::new(0.1, 0.1, 0.05);
    for shape in [Shape::Box { half }, Shape::Sphere { radius: 0.05 }] {
        let mut model = world([body(1.0, shape, Vec3::new(0.0, 0.0, 0.06))]);
        model.roots[0].linear_velocity.x = 1.0;
        model.links[0].restitution = 0.3;
        model.links[0].friction = 0.05;
        model.world.ground = Some(crate::model::Ground {
            friction: 0.05,
            restitution: 0.3,
            ..Default::default()
        });
        let mut s = start(model, 1e-3);
        run(&mut s, 0.5, 1.0 / 240.0);
        let before = s.state().stepping.counters.steps;
        run(&mut s, 1.0, 1.0 / 240.0);
        let steps = s.state().stepping.counters.steps - before;
        assert!((100..=240).contains(&steps), "{steps}");
        assert!(s.state().physical.v[3] > 0.4);
    }
}

/// A ball of 1 cm at 100 m/s against a plate of 1 mm does not pass, in both kinds of step; nor does
/// one that a motor makes fast from rest within a step.
#[test]
fn nothing_passes_through_a_thin_plate() {
    let plate = || {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let half = Vec3::new(0.0005, 0.3, 0.3);
        b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
        b.model.roots[0].position = Vec3::new(1.0, 0.0, 1.0);
        b.model
    };
    for step in [0.0, 1.0 / 240.0, 0.02] {
        for speed in [1.0, 30.0, 100.0] {
            let mut ball = body(
                0.01,
                Shape::Sphere { radius: 0.005 },
                Vec3::new(0.1, 0.0, 1.0),
            );
            ball.roots[0].linear_velocity.x = speed;
            let mut model = world([plate(), ball]);
            model.world.gravity = Vec3::zeros();
            model.solver.step_size = step;
            let mut s = start(model, 1e-3);
            run(&mut s, 2.0 / speed, 0.013 / speed);
            let x = s.state().physical.q[0];
            assert!(x < 1.0, "step {step}, {speed} m/s: {x}");
        }
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let slide = b.link(
            LinkId(0),
            Pose::IDENTITY,
            Motion::Prismatic(Vec3::x()),
            inertia(0.01, Vec3::zeros(), [1e-6; 3]),
        );
        b.shape(slide, Shape::Sphere { radius: 0.005 }, Pose::IDENTITY);
        b.actuator(slide, ActuatorMode::Effort, 100.0);
        b.model.roots[0].position = Vec3::new(0.98, 0.0, 1.0);
        let mut model = world([b.model, plate()]);
        model.solver.step_size = step;
        let mut s = start(model, 1e-3);
        s.set_input(InputSlot::Effort(ActuatorId(0)), 100.0);
        run(&mut s, 0.5, 0.1);
        let x = s.state().physical.q[0];
        assert!(x < 0.02, "step {step}: {x}");
    }
}

/// Shapes of all kinds fall on each other in a heap: no step fails, nothing falls through the
/// ground, and energy does not come from nowhere.
#[test]
fn random_piles_fall_without_a_failure() {
    for seed in 0..24_u8 {
        let mut random = Random(7000 + u64::from(seed));
        let count = 3 + seed % 6;
        let models = (0..count).map(|i| {
            let mass = libm::pow(10.0, random.uniform(-1.0, 1.0));
            let side = random.vector(0.03);
            let at = Vec3::new(side.x, side.y, 0.12 + 0.2 * f64::from(i));
            let mut model = body(mass, some_shape(&mut random), at);
            model.roots[0].rpy = random.vector(3.0);
            model.roots[0].linear_velocity = random.vector(0.5);
            model.roots[0].angular_velocity = random.vector(3.0);
            model
        });
        let mut model = world(models.collect::<Vec<_>>());
        if seed % 4 == 3 {
            model.solver.step_size = 1.0 / 240.0;
        }
        let mut s = start(model, 1e-3);
        let (_, _, first) = books(&s);
        let mut lowest = first;
        for k in 1..=480 {
            s.advance_to(f64::from(k) / 240.0).expect("no failure");
            let (_, _, held) = books(&s);
            assert!(
                held - lowest < 3e-3 * first,
                "seed {seed}: {held} {lowest} {first}"
            );
            lowest = lowest.min(held);
            for body in 0..usize::from(count) {
                assert!(s.state().physical.q[7 * body + 2] > 0.0, "seed {seed}");
            }
        }
    }
}

fn some_shape(random: &mut Random) -> Shape {
    let mut size = || random.uniform(0.02, 0.08);
    let (a, b, c) = (size(), size(), size());
    let kind = random.uniform(0.0, 5.0);
    if kind < 1.0 {
        Shape::Sphere { radius: a }
    } else if kind < 2.0 {
        Shape::Capsule {
            radius: a,
            half_length: b,
        }
    } else if kind < 3.0 {
        Shape::Cylinder {
            radius: a,
            half_length: b,
        }
    } else if kind < 4.0 {
        Shape::Box {
            half: Vec3::new(a, b, c),
        }
    } else {
        let corner = |_| random.unit().component_mul(&Vec3::new(a, b, c));
        Shape::Hull {
            // Even about its centre of mass.
            vertices: (0..6).map(corner).flat_map(|x| [x, -x]).collect(),
        }
    }
}

/// What lies behind a mesh is not known, so nothing may get there in one step: a ball of 1 cm at
/// 100 m/s, onto triangles much larger than itself and onto small ones, in both kinds of step.
#[test]
fn a_fast_ball_does_not_pass_through_a_mesh() {
    for (cells, step) in [(4, 0.0), (40, 0.0), (4, 1.0 / 240.0), (40, 1.0 / 240.0)] {
        for slant in [0.0, 60.0] {
            let floor = mesh(&grid(4.0, cells, |_, _| 0.0));
            let mut one = body(0.01, Shape::Sphere { radius: 0.01 }, Vec3::z() * 0.51);
            one.roots[0].linear_velocity = Vec3::new(slant, 0.0, -100.0);
            let mut model = over(ground(floor, Vec3::zeros()), one);
            model.solver.step_size = step;
            let mut s = start(model, 1e-3);
            for i in 1..=60 {
                run(&mut s, f64::from(i) / 2400.0, 1.0 / 240.0);
                let q = &s.state().physical.q;
                assert!(q[2] > 0.0, "{cells} {step} {slant}: {q:?} at {}", s.time());
            }
        }
    }
}

/// A limb of 2 g that swings at `speed`, rad/s, from the middle between stiff limits at ±1 rad.
/// Nothing else turns it.
fn limb(speed: f64) -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let rod = inertia(2e-3, Vec3::new(0.03, 0.0, 0.0), [1e-7, 6e-7, 6e-7]);
    let motion = Motion::Revolute(Vec3::z());
    let link = b.link(0u32.into_link(), Pose::IDENTITY, motion, rod);
    b.limits(link, -1.0, 1.0);
    let joint = b.model.links[link.index()].joint.expect("a joint");
    b.model.joints[joint.index()].effort = Some(1.0);
    b.model.initial.joint_velocities[0] = speed;
    b.model
}

/// A limb of 2 g that swings at 20 rad/s against a stiff limit stays there, but for the 1/51 rad/s
/// that the law gives back: it is at rest within a microsecond, which no step need resolve. What is
/// left of an impact may err by the tolerance in 0.1 s at the limb's reach.
#[test]
fn a_limb_that_comes_to_its_limit_takes_few_steps() {
    for tolerance in [1e-3, 3e-4] {
        let mut s = start(limb(20.0), tolerance);
        run(&mut s, 0.1, 1.0 / 240.0);
        let (q, v) = (s.state().physical.q[0], s.state().physical.v[0]);
        let counters = s.state().stepping.counters;
        let back = 1.0 / 51.0 + tolerance / (0.1 * s.tree().dofs.weight[0]);
        assert!((-back..1e-6).contains(&v), "{v} {back}");
        assert!((1.0 - 0.05 * back..1.0 + 1e-6).contains(&q), "{q}");
        // 24 and 25 for 24 communication steps; 34 and 38 if every step has both stages.
        assert!(counters.steps + counters.rejected < 28, "{counters:?}");
    }
}

/// Steps end where a joint comes to its limit, so that its impulse there is a difference of two
/// that are equal but for their round-off. Where nothing else pushes the joint, that is all that is
/// left to balance: it has to be told from what a solve has not found yet. It went on for all of
/// its 50 iterations, and the step was taken for one that cannot be solved.
#[test]
fn what_just_comes_to_its_limit_is_solved_in_few_iterations() {
    for tenths in 140..260 {
        let mut s = start(limb(0.1 * f64::from(tenths)), 1e-3);
        run(&mut s, 0.1, 1.0 / 240.0);
        let counters = s.state().stepping.counters;
        assert!(counters.newton_max < 30, "{tenths}: {counters:?}");
    }
}

/// A pendulum of 0.5 kg on a free cart of 1 kg turns at 12 rad/s to its limit, wherever that is,
/// and rests there. Without gravity nothing pushes the cart and the pendulum together: cart and
/// pendulum then have the common velocity that their momentum at the start says. Before the
/// impact, too, a step that ends with its first stage may not err by more than the tolerance in
/// 0.1 s: its bias is that of the middle of the whole step, and the impact behind it.
#[test]
fn a_pendulum_that_comes_to_its_limit_keeps_the_momentum_of_its_cart() {
    for (tolerance, h) in [
        (1e-3, 1.0 / 240.0),
        (1e-4, 1.0 / 240.0),
        (1e-4, 0.02),
        (1e-3, 0.1),
    ] {
        let mut worst: f64 = 0.0;
        for k in 0..40 {
            let (mut b, _) = cart_with_pendulum();
            b.limits(LinkId(2), -10.0, 0.2 + 2.3 * f64::from(k) / 39.0);
            b.model.world.gravity = Vec3::zeros();
            b.model.initial.joint_velocities = vec![0.0, 12.0];
            let mut s = start(b.model, tolerance);
            let momentum = |s: &Simulation| {
                let (q, v) = (&s.state().physical.q, &s.state().physical.v);
                1.5 * v[0] - 0.5 * 0.4 * libm::sin(q[1]) * v[1]
            };
            let begin = momentum(&s);
            run(&mut s, 0.4, h);
            worst = worst.max((momentum(&s) - begin).abs() / 1.5);
        }
        assert!(worst < 5.0 * tolerance, "{worst} at {tolerance}");
    }
}

/// What begins in something else has not come there by an impact, so that nothing of what the
/// springs hold comes back: it leaves slower than a body that falls as far as the overlap, 3 cm, at
/// 0.77 m/s, whatever its restitution. While it was taken for an impact, a restitution of 1 threw
/// the cube away at 681 m/s, and 0.05 took 23,445 steps for the first 1/80 s.
#[test]
fn what_begins_in_something_else_leaves_it_slowly_whatever_its_restitution() {
    for (tolerance, step) in [(1e-3, 0.0), (1e-3, 1.0 / 240.0), (1e-5, 0.0)] {
        for e in [0.05, 0.9, 1.0] {
            let mut upper = cube(1.0, Vec3::new(0.02, 0.01, 0.12));
            upper.roots[0].rpy = Vec3::new(0.1, 0.05, 0.3);
            upper.roots[0].linear_velocity.z = -0.3;
            let mut model = world([cube(1.0, Vec3::new(0.0, 0.0, 0.05)), upper]);
            for link in &mut model.links {
                link.restitution = e;
            }
            model.solver.step_size = step;
            let mut s = start(model, tolerance);
            let mut fastest: f64 = 0.0;
            for i in 1..=24 {
                s.advance_to(f64::from(i) / 240.0).expect("finite");
                let linear = speeds(&s).into_iter().map(|[_, speed]| speed);
                fastest = linear.fold(fastest, f64::max);
                let steps = s.state().stepping.counters.steps;
                assert!(steps < 5000, "{e}, {tolerance}, {step}: {steps} steps");
            }
            assert!(fastest < 0.77, "{e}, {tolerance}, {step}: {fastest} m/s");
        }
    }
}

/// A ball hops on a ground of restitution 0.3, which is set to 0 on the way: it rests as it does
/// with 0 from the beginning. While what had come in with a restitution went on as a bounce, each
/// step took 1e-7 s, the shortest there is.
#[test]
fn a_restitution_that_is_set_to_0_ends_all_bounces() {
    for (step, tolerance) in [(1.0 / 240.0, 1e-3), (0.0, 1e-3), (0.0, 1e-5)] {
        for at in [80, 95, 110] {
            let shape = Shape::Sphere { radius: 0.05 };
            let mut model = body(1.0, shape, Vec3::z() * 0.15);
            model.world.ground = Some(crate::model::Ground::default());
            model.solver.step_size = step;
            let mut s = start(model, tolerance);
            s.set_parameter(ParameterSlot::GroundRestitution, 0.3);
            let mut before = 0.0;
            for i in 1..=144 {
                if i == at {
                    s.set_parameter(ParameterSlot::GroundRestitution, 0.0);
                    before = s.output(OutputSlot::Steps) + s.output(OutputSlot::Rejected);
                }
                s.advance_to(f64::from(i) / 240.0).expect("finite");
            }
            let tries = s.output(OutputSlot::Steps) + s.output(OutputSlot::Rejected) - before;
            assert!(tries < 100.0, "{tries} tries, {at} {step} {tolerance}");
            assert!(s.state().physical.v.iter().all(|v| v.abs() < 1e-9));
        }
    }
}
