//! Rolling and torsional friction, and friction that is higher at rest, against rigid-body
//! formulas.

use super::worlds::{body, world};
use super::*;

/// Fixed steps or error control: step size and tolerance.
const MODES: [(f64, f64); 2] = [(0.0, 1e-5), (1.0 / 240.0, 1e-5)];

const RADIUS: f64 = 0.1;

/// A ball of 1 kg and 0.1 m on the ground, in its resting place.
fn ball(rolling: f64, torsional: f64) -> Builder {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [4e-3; 3]));
    let shape = Shape::Sphere { radius: RADIUS };
    b.shape(0u32.into_link(), shape, Pose::IDENTITY);
    // One point carries the weight that the stiffness spreads over four.
    b.model.roots[0].position.z = RADIUS - 4e-4;
    b.model.links[0].rolling_friction = rolling;
    b.model.links[0].torsional_friction = torsional;
    b
}

fn started(mut b: Builder, (step, tolerance): (f64, f64)) -> Simulation {
    b.model.solver.step_size = step;
    start(b.model, tolerance)
}

/// About the contact: (I + m R²) ω̇ = −c m g, so a ball loses 5/7 c g/R; it stops where v0²/2a
/// says, for good.
#[test]
fn a_rolling_ball_slows_down_by_its_rolling_friction_and_stands() {
    let (c, v0) = (2e-3, 0.5);
    let a = 5.0 / 7.0 * c * G / RADIUS;
    for mode in MODES {
        let mut b = ball(c, 0.0);
        b.model.roots[0].linear_velocity.x = v0;
        b.model.roots[0].angular_velocity.y = v0 / RADIUS;
        let mut s = started(b, mode);
        run(&mut s, 1.0, 0.01);
        let v1 = s.state().physical.v[3];
        run(&mut s, 3.0, 0.01);
        let found = 0.5 * (v1 - s.state().physical.v[3]);
        assert!((found - a).abs() < 1e-4 * a, "{mode:?}: {found} {a}");
        run(&mut s, 6.0, 0.01);
        let x = s.state().physical.q[0];
        // The element gives by a milliradian and more before it holds, and the speed at which it
        // takes hold is resolved to the tolerance: 2.3 mm at 1e-5.
        assert!((x - v0 * v0 / (2.0 * a)).abs() < 3e-3, "{mode:?}: {x}");
        run(&mut s, 10.0, 0.01);
        let x = s.state().physical.q[0];
        run(&mut s, 70.0, 0.1);
        assert!((s.state().physical.q[0] - x).abs() < 1e-12, "{mode:?}");
    }
}

/// A solid cylinder has I = ½ m R² about its axis: a = 2/3 c g/R, its weight on three points.
#[test]
fn a_rolling_cylinder_slows_down_by_its_rolling_friction() {
    let c = 1e-3;
    let a = 2.0 / 3.0 * c * G / RADIUS;
    for mode in MODES {
        let i = (3.0 * RADIUS * RADIUS + 0.1 * 0.1) / 12.0;
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [i, i, 5e-3]));
        let shape = Shape::Cylinder {
            radius: RADIUS,
            half_length: 0.05,
        };
        b.shape(0u32.into_link(), shape, Pose::IDENTITY);
        b.model.roots[0].rpy.x = std::f64::consts::FRAC_PI_2;
        b.model.roots[0].position.z = RADIUS - 2e-4;
        b.model.roots[0].linear_velocity.x = 1.0;
        b.model.roots[0].angular_velocity.y = 1.0 / RADIUS;
        b.model.world.ground = Some(crate::model::Ground {
            friction: 0.8,
            rolling_friction: c,
            ..Default::default()
        });
        let mut s = started(b, mode);
        run(&mut s, 1.0, 0.01);
        let v1 = s.state().physical.v[3];
        run(&mut s, 3.0, 0.01);
        let found = 0.5 * (v1 - s.state().physical.v[3]);
        assert!((found - a).abs() < 1e-4 * a, "{mode:?}: {found} {a}");
    }
}

/// Statics: a ball stays on a slope up to tan θ = c/R, and above it rolls with 5/7 g (sin θ − c/R
/// cos θ).
#[test]
fn a_ball_stands_for_an_hour_on_a_slope_below_its_rolling_threshold_and_rolls_above() {
    let c = 1e-3;
    let limit = libm::atan(c / RADIUS);
    for mode in MODES {
        let mut b = ball(c, 0.0);
        b.model.world.gravity = slope(0.9 * limit);
        let mut s = started(b, mode);
        run(&mut s, 10.0, 0.1);
        let x = s.state().physical.q[0];
        // Released into the load, it first gives way by some milliradians: BREAKAWAY at four times
        // the load.
        assert!(x < 1e-2 * RADIUS, "{mode:?}: {x}");
        run(&mut s, 3610.0, 1.0);
        let creep = (s.state().physical.q[0] - x).abs();
        assert!(creep < 1e-9, "{mode:?}: {creep}");

        let mut b = ball(c, 0.0);
        let angle = 1.2 * limit;
        b.model.world.gravity = slope(angle);
        let mut s = started(b, mode);
        run(&mut s, 2.0, 0.01);
        let v1 = s.state().physical.v[3];
        run(&mut s, 6.0, 0.01);
        let a = 0.25 * (s.state().physical.v[3] - v1);
        let expected = 5.0 / 7.0 * G * (libm::sin(angle) - c / RADIUS * libm::cos(angle));
        assert!(
            (a - expected).abs() < 1e-3 * expected,
            "{mode:?}: {a} {expected}"
        );
    }
}

/// A body that spins on one point: `ω̇ = −μ_t m g/I`. Friction at a point has no lever to slow it.
#[test]
fn a_spinning_ball_slows_down_by_its_torsional_friction_alone() {
    let c = 1e-3;
    for mode in MODES {
        for (torsional, rolling) in [(c, 0.0), (0.0, c)] {
            let mut b = ball(rolling, torsional);
            b.model.roots[0].angular_velocity.z = 10.0;
            let mut s = started(b, mode);
            run(&mut s, 0.5, 0.01);
            let w = s.state().physical.v[2];
            run(&mut s, 2.5, 0.01);
            let found = 0.5 * (w - s.state().physical.v[2]);
            let expected = torsional * G / 4e-3;
            assert!(
                (found - expected).abs() < 1e-4,
                "{mode:?}: {found} {expected}"
            );
            run(&mut s, 10.0, 0.01);
            let spins = s.state().physical.v[2].abs() > 1e-9;
            assert_eq!(spins, torsional == 0.0, "{mode:?}");
        }
    }
}

/// A body of 1 kg and 5e-3 kg·m² that turns on its face with 30 rad/s.
///
/// - `half`: of its height, m
fn on_its_face((shape, half): (Shape, f64), mu: f64, mode: (f64, f64)) -> Simulation {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [2.5e-3, 2.5e-3, 5e-3]));
    b.shape(0u32.into_link(), shape, Pose::IDENTITY);
    b.model.roots[0].position.z = half - 0.5 * b.model.contact.penetration;
    b.model.roots[0].angular_velocity.z = 30.0;
    b.model.links[0].friction = mu;
    b.model.world.ground = Some(crate::model::Ground {
        friction: mu,
        ..Default::default()
    });
    started(b, mode)
}

/// By how much such a body is braked from 0.1 s to `end`, rad/s².
fn braked(body: (Shape, f64), mu: f64, mode: (f64, f64), end: f64) -> f64 {
    let mut s = on_its_face(body, mu, mode);
    run(&mut s, 0.1, 0.01);
    let w = s.state().physical.v[2];
    run(&mut s, end, 0.01);
    (w - s.state().physical.v[2]) / (end - 0.1)
}

/// A body that turns on the spot is braked by `μ m g` times the mean distance of an even pressure:
/// 0.5108 of the half diagonal of a plate of 5:1 (a sum over its area), and nearly ⅔ of the radius
/// of a prism of 16 sides. Of both it was 0.55 of that of the corners, 8 % more and 16 % less.
#[test]
fn what_turns_on_the_spot_is_braked_by_an_even_pressure() {
    let mu = 0.3;
    let half = Vec3::new(0.1, 0.02, 5e-3);
    let corner = |i: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / 16.0);
        let at = |z: f64| Vec3::new(RADIUS * cos, RADIUS * sin, z);
        [at(-half.z), at(half.z)]
    };
    let vertices = (0..16).flat_map(corner).collect();
    for (shape, lever, most) in [
        (Shape::Box { half }, 0.5108 * half.xy().norm(), 0.01),
        (Shape::Hull { vertices }, 0.6581 * RADIUS, 1e-3),
    ] {
        for mode in MODES {
            let found = braked((shape.clone(), half.z), mu, mode, 0.4);
            let expected = mu * G * lever / 5e-3;
            let error = (found - expected).abs() / expected;
            assert!(error < most, "{mode:?}: {found} {expected}");
        }
    }
}

/// A disc that stands on its face: friction of a uniform pressure has the mean lever `∫ r² dr / ∫ r
/// dr = 2/3 R`, and with `I = ½ m R²` it is `ω̇ = −4/3 μ g/R`.
#[test]
fn a_spinning_disc_slows_down_by_friction_over_its_face() {
    let mu = 0.3;
    for mode in MODES {
        let shape = Shape::Cylinder {
            radius: RADIUS,
            half_length: 5e-3,
        };
        let found = braked((shape, 5e-3), mu, mode, 0.5);
        let expected = 4.0 / 3.0 * mu * G / RADIUS;
        let error = (found - expected).abs() / expected;
        assert!(error < 1e-3, "{mode:?}: {found} {expected}");
    }
}

/// What turns on its face comes to rest, for good: a disc after `ω₀/ω̇` with the mean lever ⅔ R, a
/// square box with that of an even pressure, `(√2 + ln(1 + √2))/3 = 0.7652` of half its side.
#[test]
fn what_turns_on_its_face_stands_after_the_time_of_its_friction() {
    let (mu, half_length) = (0.3, 5e-3);
    let half = Vec3::new(RADIUS, RADIUS, half_length);
    let disc = Shape::Cylinder {
        radius: RADIUS,
        half_length,
    };
    for (shape, lever) in [
        (disc, 2.0 / 3.0 * RADIUS),
        (Shape::Box { half }, 0.7652 * RADIUS),
    ] {
        for mode in MODES {
            let expected = 30.0 * 5e-3 / (mu * G * lever);
            let mut s = on_its_face((shape.clone(), half_length), mu, mode);
            run(&mut s, expected - 0.02, 0.01);
            assert!(s.state().physical.v[2] > 0.1, "{shape:?} {mode:?}");
            run(&mut s, expected + 0.5, 0.01);
            let rest = s.state().physical.clone();
            assert!(
                rest.v.iter().all(|v| *v == 0.0),
                "{shape:?} {mode:?}: {:?}",
                rest.v
            );
            run(&mut s, expected + 10.0, 0.1);
            assert_eq!(s.state().physical.q, rest.q, "{shape:?} {mode:?}");
        }
    }
}

#[test]
fn of_two_surfaces_the_larger_resistance_to_turning_counts() {
    let mut b = ball(2e-3, 5e-4);
    b.model.world.ground = Some(crate::model::Ground {
        friction: 0.8,
        rolling_friction: 1e-3,
        torsional_friction: 3e-3,
        ..Default::default()
    });
    let s = start(b.model, 1e-3);
    let [torsional, rolling] = s.tree().contact.colliders[0].ground.turning;
    assert!((torsional - 3e-3).abs() < 1e-15 && (rolling - 2e-3).abs() < 1e-15);
}

/// A ball that rolls or spins on a free plate of half a tonne, or on a static one, with friction
/// against turning on the one surface or the other, listed before the plate or behind it: it slows
/// down by `c g/(1 + 2/5)` or `c m g/I`. Before, only what stood second in the list counted.
#[test]
fn resistance_to_turning_counts_on_either_surface_in_any_order() {
    let (radius, c) = (0.05, 2e-3);
    for mode in MODES {
        for (on_ball, first, drills) in [
            (true, true, false),
            (true, false, false),
            (false, true, false),
            (false, false, false),
            (true, true, true),
            (true, false, true),
            (false, true, true),
            (false, false, true),
        ] {
            let top = Vec3::z() * (0.1 + radius);
            let ball = body(1.0, Shape::Sphere { radius }, top);
            let half = Vec3::new(2.0, 2.0, 0.05);
            let plate = body(500.0, Shape::Box { half }, Vec3::z() * 0.05);
            let mut both = [ball, plate];
            let rough = &mut both[usize::from(!on_ball)].links[0];
            if drills {
                rough.torsional_friction = c;
            } else {
                rough.rolling_friction = c;
            }
            let [ball, plate] = both;
            let mut model = if first {
                world([ball, plate])
            } else {
                world([plate, ball])
            };
            let place = usize::from(!first);
            let root = &mut model.roots[place];
            if drills {
                root.angular_velocity = Vec3::z() * 20.0;
            } else {
                root.linear_velocity = Vec3::x();
                root.angular_velocity = Vec3::y() / radius;
            }
            model.solver.step_size = mode.0;
            let mut s = start(model, mode.1);
            run(&mut s, 0.5, 1.0 / 240.0);
            let v = &s.state().physical.v[6 * place..6 * place + 6];
            let (found, left) = if drills {
                (v[2], 20.0 - 0.5 * c * G / (0.4 * radius * radius))
            } else {
                (v[3], 1.0 - 0.5 * c / radius * G / 1.4)
            };
            assert!(
                (found / left - 1.0).abs() < 2e-3,
                "{mode:?} {on_ball} {first} {drills}: {found} for {left}"
            );
        }
    }
}

/// A ball of 1 kg that is pressed down with up to a thousand times its weight, as fingers press
/// what they hold. By statics a moment of less than `c N` about the normal, or about a tangent by a
/// force at its middle, turns it by that share of the milliradian at which friction against turning
/// gives way, and a larger one speeds it up by what exceeds `c N`. Made for a quarter of the
/// weight, it turned by 0.24 and 2.4 rad before it held the former.
#[test]
fn what_is_pressed_hard_turns_by_no_more_before_it_gives_way() {
    let c = 1e-3;
    for mode in MODES {
        for (press, drills) in [(100.0, true), (1000.0, true), (100.0, false)] {
            let limit = c * press * G;
            let turned = |share: f64, time: f64| {
                let mut b = ball(c, c);
                b.model.outputs.external_wrenches = vec![LinkId(0)];
                b.model.links[0].friction = 0.8;
                let mut s = started(b, mode);
                s.set_input(InputSlot::ExternalForce(LinkId(0), 2), (1.0 - press) * G);
                run(&mut s, 0.5, 0.01);
                let start = s.state().physical.clone();
                let moment = share * limit;
                if drills {
                    s.set_input(InputSlot::ExternalTorque(LinkId(0), 2), moment);
                } else {
                    s.set_input(InputSlot::ExternalForce(LinkId(0), 0), moment / RADIUS);
                }
                run(&mut s, 0.5 + time, 1.0 / 240.0);
                let end = &s.state().physical;
                if drills {
                    let half =
                        libm::atan2(end.q[6], end.q[3]) - libm::atan2(start.q[6], start.q[3]);
                    (2.0 * half, end.v[2])
                } else {
                    ((end.q[0] - start.q[0]) / RADIUS, end.v[1])
                }
            };
            let (angle, speed) = turned(0.6, 1.0);
            // A friction spring of 0.1 mm that a force at the middle stretches adds to the latter.
            let slides = if drills { 0.0 } else { 1e-3 };
            assert!(
                angle > 0.5 * 0.6e-3 && angle < 1.1 * 0.6e-3 + slides && speed.abs() < 1e-9,
                "{mode:?} {press} {drills}: {angle} {speed}"
            );
            // From 0.05 s on, when all of the moment that slips has set in.
            let [before, after] = [0.05, 0.15].map(|time| turned(1.2, time).1);
            let inertia = if drills { 4e-3 } else { 4e-3 + RADIUS * RADIUS };
            let expected = 0.2 * limit / inertia * 0.1;
            assert!(
                ((after - before) / expected - 1.0).abs() < 0.01,
                "{mode:?} {press} {drills}: {before} {after} {expected}"
            );
        }
    }
}

/// Coulomb with two coefficients: it breaks away at `μ_s N` and then accelerates with the rest of
/// the force.
#[test]
fn a_block_breaks_away_at_its_static_friction_and_slides_with_its_dynamic_one() {
    let (sliding, rest) = (0.4, 0.6);
    for mode in MODES {
        for (share, moves) in [(0.999, false), (1.002, true)] {
            let mut b = block(1.0, sliding);
            b.model.links[0].static_excess = rest / sliding - 1.0;
            b.model.world.ground = Some(crate::model::Ground {
                friction: sliding,
                static_excess: rest / sliding - 1.0,
                ..Default::default()
            });
            let mut s = started(b, mode);
            // The block is pushed by a gravity that leans, slowly: a load that jumps may overshoot.
            for i in 0..=100 {
                let push = share * rest * G * (f64::from(i) / 100.0);
                s.set_parameter(ParameterSlot::Gravity(0), push);
                let end = s.time() + 0.01;
                run(&mut s, end, 0.01);
            }
            run(&mut s, 3.0, 0.01);
            let (x, v) = (s.state().physical.q[0], s.state().physical.v[3]);
            if moves {
                run(&mut s, 4.0, 0.01);
                let a = s.state().physical.v[3] - v;
                let expected = (share * rest - sliding) * G;
                assert!((a - expected).abs() < 1e-4 * expected, "{mode:?}: {a}");
            } else {
                run(&mut s, 63.0, 0.1);
                let moved = s.state().physical.q[0] - x;
                assert!(moved.abs() < 1e-9, "{mode:?}: {moved}");
            }
        }
    }
}

/// `v0²/(2 μ_d g)`; the higher friction below a few cm/s shortens it by less than `v_s²/(μ_d g)`.
#[test]
fn a_sliding_block_stops_after_the_distance_of_its_dynamic_friction() {
    let (sliding, rest) = (0.4, 0.6);
    for mode in MODES {
        let mut b = block(1.0, sliding);
        b.model.links[0].static_excess = rest / sliding - 1.0;
        b.model.world.ground = Some(crate::model::Ground {
            friction: sliding,
            static_excess: rest / sliding - 1.0,
            ..Default::default()
        });
        b.model.roots[0].linear_velocity.x = 1.0;
        b.model.roots[0].position.z = 0.1 - 1e-4;
        let mut s = started(b, mode);
        run(&mut s, 1.0, 0.01);
        let x = s.state().physical.q[0];
        let expected = 1.0 / (2.0 * sliding * G);
        // Fixed steps are of first order: half a step at the initial speed.
        let allowed = if mode.0 > 0.0 { 0.5 * mode.0 } else { 2e-4 };
        assert!((x - expected).abs() < allowed, "{mode:?}: {x} {expected}");
        assert!(s.state().physical.v[3].abs() < 1e-9, "{mode:?}");
    }
}

/// A can on its end that somebody has touched stands still again at once: its rim tilts about the
/// place where its point is, wherever in a step that was found.
#[test]
fn a_can_that_was_nudged_comes_to_rest() {
    let (radius, half_length) = (0.039, 0.045);
    let (r, h) = (radius * radius, half_length * half_length);
    let across = 0.3 * (0.25 * r + h / 3.0);
    let i = [across, across, 0.15 * r];
    let shape = Shape::Cylinder {
        radius,
        half_length,
    };
    for (tolerance, nudge) in [(1e-3, 1e-6), (1e-3, 1e-3), (1e-4, 1e-6), (1e-5, 1e-4)] {
        let mut b = Builder::new(true, inertia(0.3, Vec3::zeros(), i));
        b.shape(LinkId(0), shape.clone(), Pose::IDENTITY);
        b.model.roots[0].position.z = half_length;
        b.model.roots[0].angular_velocity.y = nudge;
        let mut s = start(b.model, tolerance);
        run(&mut s, 1.0, 1.0 / 240.0);
        let moves = s.state().physical.v.iter().any(|v| *v != 0.0);
        let steps = s.state().stepping.counters.steps;
        assert!(
            !moves && steps < 200,
            "{tolerance} {nudge}: {steps} {:?}",
            s.state().physical.v
        );
    }
}
