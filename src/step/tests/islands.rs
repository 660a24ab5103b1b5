//! Trees far from each other: what one does is nothing to the others.

use super::worlds::{body, books, cube, world};
use super::*;
use crate::simulation::Snapshot;
use crate::tuning::Rules;

/// A floating tree that falls on the ground in motion, its motors at work, `x` metres from the
/// origin.
fn robot(seed: u64, x: f64) -> Model {
    let mut random = Random(seed);
    let mut model = random_tree(&mut random, 4, seed.is_multiple_of(2), false);
    shape_all_links(&mut model);
    model.world.ground = Some(crate::model::Ground {
        friction: 0.8,
        ..Default::default()
    });
    let root = &mut model.roots[0];
    root.position = Vec3::new(x, 0.0, 0.6);
    root.angular_velocity = random.vector(1.0);
    root.linear_velocity = random.vector(0.5);
    model
}

/// What bounces, rolls or rests at a place.
fn things(x: f64) -> Vec<Model> {
    let mut ball = body(2.0, Shape::Sphere { radius: 0.05 }, Vec3::new(x, 1.0, 0.8));
    ball.links[0].restitution = 0.9;
    let mut rolling = body(
        1.0,
        Shape::Cylinder {
            radius: 0.1,
            half_length: 0.2,
        },
        Vec3::new(x, -1.0, 0.1),
    );
    rolling.roots[0].rpy.x = std::f64::consts::FRAC_PI_2;
    rolling.roots[0].linear_velocity.x = 0.3;
    let lower = cube(1.0, Vec3::new(x + 1.0, 0.0, 0.05));
    let upper = cube(1.0, Vec3::new(x + 1.0, 0.01, 0.15));
    vec![ball, rolling, lower, upper]
}

fn with_step(mut model: Model, fixed: f64) -> Simulation {
    model.solver.step_size = fixed;
    start(model, 1e-3)
}

/// Positions and velocities of a tree, as bits.
fn bits(s: &Simulation, tree: usize) -> Vec<u64> {
    let extent = &s.tree().trees[tree];
    let physical = &s.state().physical;
    let positions = physical.q[extent.coordinates.clone()].iter();
    let velocities = physical.v[extent.dofs.clone()].iter();
    positions.chain(velocities).map(|x| x.to_bits()).collect()
}

/// Whatever goes on ten metres away, and wherever in the list it stands: the same bits, of robots
/// that fall, of what they rest on, in both kinds of step.
#[test]
fn what_is_far_away_changes_no_bit() {
    for seed in 0..8 {
        for fixed in [0.0, 1.0 / 240.0] {
            let mut alone = with_step(robot(seed, 0.0), fixed);
            let others = || things(10.0).into_iter();
            let mut first = with_step(world([robot(seed, 0.0)].into_iter().chain(others())), fixed);
            let mut last = with_step(world(others().chain([robot(seed, 0.0)])), fixed);
            let mut both = with_step(world([robot(seed, 0.0), robot(seed + 1, 30.0)]), fixed);
            let at = things(10.0).len();
            for i in 1..=240 {
                let t = f64::from(i) / 240.0;
                for s in [&mut alone, &mut first, &mut last, &mut both] {
                    s.advance_to(t).expect("finite");
                }
                let expected = bits(&alone, 0);
                let found = [bits(&first, 0), bits(&last, at), bits(&both, 0)];
                for (world, found) in found.iter().enumerate() {
                    assert_eq!(
                        found, &expected,
                        "seed {seed}, {fixed}, world {world}, {t} s"
                    );
                }
            }
        }
    }
}

/// Commands of another robot change no bit either, and a robot that hangs still takes no step
/// because of a ball that bounces.
#[test]
fn each_island_has_steps_of_its_own() {
    let mut ball = body(
        1.0,
        Shape::Sphere { radius: 0.05 },
        Vec3::new(5.0, 0.0, 1.0),
    );
    ball.links[0].restitution = 0.8;
    let steps = |models: Vec<Model>| {
        let mut s = start(world(models), 1e-3);
        run(&mut s, 2.0, 1.0 / 240.0);
        s.state().stepping.counters.steps
    };
    let (cubes, alone) = (
        || {
            vec![
                cube(1.0, Vec3::new(0.0, 0.0, 0.05)),
                cube(1.0, Vec3::new(0.0, 0.0, 0.15)),
            ]
        },
        steps(vec![ball.clone()]),
    );
    let resting = steps(cubes());
    let mut together = cubes();
    together.push(ball);
    assert_eq!(steps(together), alone + resting);
    // What rests takes none.
    assert!(resting < 200, "{resting}");
}

/// Two cubes that rest on each other take no steps and are carried by the same forces, however long
/// communication steps are, until a ball comes or somebody pushes.
#[test]
fn what_rests_is_carried_without_steps_and_wakes() {
    let lower = cube(1.0, Vec3::new(0.0, 0.0, 0.05));
    let mut upper = cube(1.0, Vec3::new(0.0, 0.0, 0.15));
    upper.outputs.external_wrenches = vec![LinkId(0)];
    let ball = body(
        0.1,
        Shape::Sphere { radius: 0.02 },
        Vec3::new(0.0, 0.0, 12.0),
    );
    let mut model = world([lower, upper, ball]);
    model.outputs.contacts = vec![LinkId(0), LinkId(1)];
    let mut s = start(model, 1e-3);
    let cubes = |s: &Simulation| (bits(s, 0), bits(s, 1));
    let force = |s: &mut Simulation, link: u32| s.output(OutputSlot::ContactForce(LinkId(link), 2));
    run(&mut s, 0.5, 1.0 / 240.0);
    let (rest, steps) = (cubes(&s), s.state().stepping.counters.steps);
    let carried = [0, 1].map(|link| force(&mut s, link));
    assert!(
        (carried[0] - G).abs() < 1e-5 && (carried[1] - G).abs() < 1e-5,
        "{carried:?}"
    );
    for span in [1e-3, 0.01, 0.1, 1.0 / 240.0] {
        let end = s.time() + span;
        s.advance_to(end).expect("finite");
        let close =
            |link: u32, s: &mut Simulation| (force(s, link) - carried[link as usize]).abs() < 1e-12;
        assert!(close(0, &mut s) && close(1, &mut s), "{span}");
        assert_eq!(cubes(&s), rest, "{span}");
    }
    // The ball alone has taken steps, long ones in flight.
    assert!(s.state().stepping.counters.steps - steps < 20);
    // It falls by ½ g t² on the upper cube, which presses on the lower one.
    run(&mut s, 1.56, 0.01);
    assert!(cubes(&s) != rest);
    assert!(force(&mut s, 0) > G);
    run(&mut s, 3.0, 1.0 / 240.0);
    let woken = cubes(&s);
    // A push of a newton is felt at once, and by both.
    s.set_input(InputSlot::ExternalForce(LinkId(1), 0), 1.0);
    run(&mut s, 3.1, 1.0 / 240.0);
    let pushed = cubes(&s);
    assert!(pushed.0 != woken.0 && pushed.1 != woken.1);
    run(&mut s, 4.0, 1.0 / 240.0);
    let side = s.output(OutputSlot::ContactForce(LinkId(0), 0));
    assert!(
        side.abs() < 1e-3,
        "the ground holds what the upper cube drags: {side}"
    );
}

/// Bodies that a communication step as long as their flight brings together, thrown or pushed:
/// they meet as if they had gone together all the time.
#[test]
fn what_comes_together_within_a_communication_step_meets() {
    for (speed, push) in [(0.0, 400.0), (0.0, 4000.0), (3.0, 0.0), (30.0, 0.0)] {
        for fixed in [0.0, 1.0 / 240.0] {
            let ends = [true, false].map(|islands| {
                let mut a = cube(1.0, Vec3::new(-0.8, 0.0, 0.0));
                let mut b = cube(1.0, Vec3::new(0.8, 0.0, 0.0));
                for model in [&mut a, &mut b] {
                    model.world.gravity = Vec3::zeros();
                    model.world.ground = None;
                    model.outputs.external_wrenches = vec![LinkId(0)];
                }
                a.roots[0].linear_velocity.x = speed;
                b.roots[0].linear_velocity.x = -speed;
                let mut s = with_step(world([a, b]), fixed);
                s.set_rules(Rules {
                    islands,
                    ..Rules::ALL
                });
                s.set_input(InputSlot::ExternalForce(LinkId(0), 0), push);
                s.set_input(InputSlot::ExternalForce(LinkId(1), 0), -push);
                run(&mut s, 1.0, 0.25);
                let (_, linear, _) = books(&s);
                assert!(linear.norm() < 1e-9 * (1.0 + speed + push), "{linear:?}");
                let q = &s.state().physical.q;
                (q[0], q[7])
            });
            let [(a, b), expected] = ends;

            // Neither has passed through the other one; 4000 N press them 0.39 mm together.
            assert!(b - a > 0.0996, "{speed} {push} {fixed}: {a} {b}");
            assert_eq!((a, b), expected, "{speed} {push} {fixed}");
        }
    }
}

/// A ball that flies past a row of others, from one island to the next: neither what stands in
/// the scratch nor a restored state changes a bit.
#[test]
fn islands_that_change_are_restored_and_hide_nothing() {
    for fixed in [0.0, 1.0 / 240.0] {
        let mut models = vec![robot(3, -4.0), robot(4, 6.0)];
        models.extend(things(0.0));
        let mut thrown = body(
            0.5,
            Shape::Sphere { radius: 0.04 },
            Vec3::new(-1.0, 0.0, 0.3),
        );
        thrown.roots[0].linear_velocity = Vec3::new(3.0, 0.0, 1.0);
        models.push(thrown);
        let all = world(models);
        let [mut a, mut b, mut c] = [(); 3].map(|()| with_step(all.clone(), fixed));
        for i in 1..=360 {
            let t = f64::from(i) / 240.0;
            b.spoil();
            let saved = a.save().to_bytes();
            let saved = Snapshot::from_bytes(c.model(), &saved).expect("its own");
            c.restore(&saved).expect("its own");
            for s in [&mut a, &mut b, &mut c] {
                s.advance_to(t).expect("finite");
            }
            assert!(
                a.state() == b.state() && a.state() == c.state(),
                "{fixed} {t}"
            );
        }
    }
}

/// Two balls that fly at each other through empty space, one beside the other in time: each is an
/// island of its own and takes the same long steps, in which neither looks for the other. They meet
/// in the midst of such a step, and must not go through each other.
#[test]
fn islands_with_steps_alike_meet_although_neither_has_looked_for_the_other() {
    let radius = 0.1;
    for (speed, gap) in [(0.3, 0.05), (1.0, 0.3), (2.5, 0.41), (7.0, 1.3)] {
        let ball = |side: f64| {
            let at = Vec3::new(side * (radius + 0.5 * gap), 0.0, 50.0);
            let mut ball = body(1.0, Shape::Sphere { radius }, at);
            ball.roots[0].linear_velocity.x = -side * speed;
            ball
        };
        let mut model = world([ball(-1.0), ball(1.0)]);
        model.world.gravity = Vec3::zeros();
        let mut s = start(model, 1e-3);
        for k in 1..=240 {
            s.advance_to(f64::from(k) / 240.0).expect("a step");
            let q = &s.state().physical.q;
            let apart = q[7] - q[0];
            // An impact of these speeds is less than 2 mm deep.
            assert!(
                apart > 2.0 * radius - 2e-3,
                "{speed} m/s: {apart} m after {k} steps"
            );
        }
        let v = &s.state().physical.v;
        let slower = v[3].abs().max(v[9].abs()) < 0.1 * speed;
        assert!(slower, "{speed} m/s: {} and {} m/s", v[3], v[9]);
    }
}
