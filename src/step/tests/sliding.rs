//! Bodies that slide on a face and spin: where friction acts on the face changes all the time.

use super::worlds::{body, depth, world};
use super::*;

/// Place and half of the yaw of a box of 0.2 m that slides with (1, 0.5) m/s and spins with 6 rad/s
/// until it stands, after 0.5 s.
fn stopped([tolerance, step, h]: [f64; 3]) -> Vec3 {
    let mut b = block(1.0, 0.5);
    b.model.roots[0].linear_velocity = Vec3::new(1.0, 0.5, 0.0);
    b.model.roots[0].angular_velocity.z = 6.0;
    b.model.solver.step_size = step;
    let mut s = start(b.model, tolerance);
    run(&mut s, 0.5, h);
    let q = &s.state().physical.q;
    Vec3::new(q[0], q[1], q[6])
}

/// Against its own solution at 1e-8 in communication steps of 1/4000 s. It leans into its friction,
/// and the direction of that turns. While a step took from its start how a face shares its load
/// among its corners, an error of first order in its length was left that no tolerance changed: the
/// place was off by 0.36 mm in fixed steps and by 0.28, 0.2, 0.26 and 0.11 mm at 1e-3 to 1e-6, the
/// yaw by 3 to 7 mrad.
#[test]
fn what_slides_and_spins_stops_where_the_tolerance_says() {
    let h = 1.0 / 240.0;
    let exact = stopped([1e-8, 0.0, 1.0 / 4000.0]);
    for (tolerance, step, off) in [
        (1e-3, 1.0 / 240.0, 4e-4),
        (1e-3, 0.0, 5e-4),
        (1e-4, 0.0, 2.5e-4),
        (1e-5, 0.0, 5e-5),
        (1e-6, 0.0, 1.5e-5),
    ] {
        let error = (stopped([tolerance, step, h]) - exact).norm();
        assert!(error < off, "{tolerance:.0e}, {step}: {error:e}");
    }
}

/// By how much more than the law a simulation may differ from what is true, in shares of it.
const APART: f64 = 0.004;

/// Fixed steps, s, none under error control, and the tolerance.
const MODES: [(f64, f64); 3] = [(0.0, 1e-3), (0.0, 1e-4), (1.0 / 240.0, 1e-3)];

/// Place and angle, m and rad, of a plate with these half lengths that slides and spins until it
/// stands, by sums of Coulomb friction over 60 × 60 cells of an even pressure, of which `inside`
/// says whether they belong to it. It is thin: nothing leans.
fn summed(
    half: [f64; 2],
    inside: fn([f64; 2]) -> bool,
    mu: f64,
    [speed, mut w]: [f64; 2],
) -> [f64; 3] {
    let at = |i: u32| (f64::from(i) + 0.5) / 30.0 - 1.0;
    let cells = (0..60).flat_map(|i| (0..60).map(move |j| [at(i), at(j)]));
    let cells: Vec<_> = cells.filter(|cell| inside(*cell)).collect();
    let cells: Vec<_> = cells
        .iter()
        .map(|c| [c[0] * half[0], c[1] * half[1]])
        .collect();
    let all = cells.len() as f64;
    let squares = cells.iter().map(|[x, y]| x * x + y * y).sum::<f64>() / all;
    let (mut v, mut x, mut angle, h) = ([speed, 0.0], [0.0; 2], 0.0, 1e-3);
    while v[0].hypot(v[1]) > 2e-3 || w.abs() > 2e-2 {
        let (sin, cos) = libm::sincos(angle);
        let (mut force, mut moment) = ([0.0; 2], 0.0);
        for [a, b] in &cells {
            let r = [cos * a - sin * b, sin * a + cos * b];
            let u = [v[0] - w * r[1], v[1] + w * r[0]];
            let size = u[0].hypot(u[1]).max(1e-6);
            force = [0, 1].map(|k| force[k] + u[k] / size);
            moment += (r[0] * u[1] - r[1] * u[0]) / size;
        }
        let brake = h * mu * G / all;
        let before = v;
        v = [0, 1].map(|k| v[k] - brake * force[k]);
        let turned = w;
        w -= brake * moment / squares;
        x = [0, 1].map(|k| x[k] + 0.5 * h * (before[k] + v[k]));
        angle += 0.5 * h * (turned + w);
    }
    [x[0], x[1], angle]
}

/// A thin plate of 1 kg on the ground that begins to slide along x and to spin.
///
/// - mean squares of its extent along x and y, m², and half of its thickness, m
/// - `speed`, `spin`: m/s and rad/s
/// - `step`, `tolerance`: see [`MODES`]
fn thrown(
    (shape, [a, b], thick): (Shape, [f64; 2], f64),
    mu: f64,
    [speed, spin]: [f64; 2],
    (step, tolerance): (f64, f64),
) -> Simulation {
    let mut builder = Builder::new(true, inertia(1.0, Vec3::zeros(), [b, a, a + b]));
    builder.shape(0u32.into_link(), shape, Pose::IDENTITY);
    let root = &mut builder.model.roots[0];
    root.position.z = thick;
    root.linear_velocity.x = speed;
    root.angular_velocity.z = spin;
    builder.model.links[0].friction = mu;
    builder.model.world.ground = Some(crate::model::Ground {
        friction: mu,
        ..Default::default()
    });
    builder.model.solver.step_size = step;
    start(builder.model, tolerance)
}

/// Where thin plates and a disc that slide and spin come to stand, against such sums, in shares of
/// the way and of the angle. By how much the law itself differs from these is known: the plane
/// equations of motion with its arcs and those with sums were both integrated by `SciPy`'s RK45 at
/// 1e-6, which gives the two numbers at the end of each line, place and angle. A simulation may
/// differ by [`APART`] more. While friction of a face had a ball for the forces that it can bear,
/// the disc that spins fast went 15 % less far and the slow one turned by 16 % less; the plate was
/// off by 14 % and the boards by 13 and 14 %. Boards come to stand beside their place: what they
/// have of friction across their way is not in the law.
#[test]
fn what_slides_and_spins_goes_as_far_as_its_points_do_together() {
    let (mu, thick) = (0.4, 1e-3);
    for (half, disc, speed, spin, law) in [
        ([0.1, 0.1], true, 0.5, 15.0, [0.0205, 0.0020]),
        ([0.1, 0.1], true, 0.6, 4.0, [0.0054, 0.0147]),
        ([0.1, 0.1], false, 0.5, 12.0, [0.0193, 0.0002]),
        ([0.15, 0.06], false, 0.5, 10.0, [0.0773, 0.0083]),
        ([0.2, 0.02], false, 0.6, 9.0, [0.1131, 0.0048]),
    ] {
        let inside = if disc {
            |[x, y]: [f64; 2]| x * x + y * y < 1.0
        } else {
            |_| true
        };
        let truth = summed(half, inside, mu, [speed, spin]);
        let [a, b] = half.map(|x| x * x / if disc { 4.0 } else { 3.0 });
        let shape = if disc {
            Shape::Cylinder {
                radius: half[0],
                half_length: thick,
            }
        } else {
            Shape::Box {
                half: Vec3::new(half[0], half[1], thick),
            }
        };
        for (step, tolerance) in MODES {
            let plate = (shape.clone(), [a, b], thick);
            let mut s = thrown(plate, mu, [speed, spin], (step, tolerance));
            let (mut angle, mut yaw) = (0.0, 0.0);
            for i in 1..=480 {
                run(&mut s, f64::from(i) / 240.0, 1.0 / 240.0);
                let q = &s.state().physical.q;
                let now = 2.0 * libm::atan2(q[6], q[3]);
                angle += libm::remainder(now - yaw, std::f64::consts::TAU);
                yaw = now;
            }
            let q = &s.state().physical.q;
            let way = truth[0].hypot(truth[1]);
            let apart = (q[0] - truth[0]).hypot(q[1] - truth[1]) / way;
            let by = (angle / truth[2] - 1.0).abs();
            let found = [apart, by];
            let fits = (0..2).all(|i| found[i] < law[i] + APART);
            assert!(fits, "{half:?}, {step}: {found:?}, the law {law:?}");
        }
    }
}

/// Yaw, rad, of a board of 1 kg and half of these lengths on the ground, that a ball which is
/// driven across it at 0.02 m/s pushes for `way` from its long side, `off` its middle.
fn pushed(half: [f64; 2], off: f64, way: f64, (step, tolerance): (f64, f64)) -> f64 {
    let (mu, thick) = (0.2, 1e-3);
    let half = Vec3::new(half[0], half[1], thick);
    let mut board = body(1.0, Shape::Box { half }, Vec3::z() * (thick - depth(1.0)));
    board.links[0].friction = mu;
    let radius = thick;
    let place = Vec3::new(off, -half.y - radius, thick);
    let mut pin = body(1.0, Shape::Sphere { radius }, place);
    pin.links[0].friction = 0.0;
    pin.outputs.driven = vec![RootId(0)];
    let mut model = world([board, pin]);
    model.world.ground = Some(crate::model::Ground {
        friction: mu,
        ..Default::default()
    });
    model.solver.step_size = step;
    let mut s = start(model, tolerance);
    let speed = 0.02;
    s.set_input(InputSlot::BaseLinearVelocity(RootId(1), 1), speed);
    run(&mut s, way / speed, 0.01);
    s.output(OutputSlot::BaseRpy(RootId::ROBOT, 2))
}

/// Mason's boards: by how much a pin turns a board that it pushes beside its middle follows from
/// how its friction shares out between sliding and turning alone. Expected are the yaws by sums of
/// Coulomb friction over 60 × 60 cells of an even pressure, of which the motion at each place is
/// the one that dissipates least, by a program of its own. With a ball for the forces that a face
/// can bear the first was 0.302 and the second 0.570.
#[test]
fn a_board_that_is_pushed_beside_its_middle_turns_as_its_points_do() {
    for (half, off, way, expected) in [
        ([0.1, 0.1], 0.03, 0.1, 0.386),
        ([0.1, 0.05], 0.03, 0.1, 0.756),
        ([0.1, 0.04], 0.06, 0.1, 0.738),
        ([0.1, 0.02], 0.03, 0.06, 0.533),
        ([0.1, 0.01], 0.02, 0.06, 0.550),
        ([0.1, 0.01], 0.05, 0.06, 0.505),
    ] {
        for mode in MODES {
            let yaw = pushed(half, off, way, mode);
            let wrong = (yaw / expected - 1.0).abs();
            assert!(wrong < 0.05, "{half:?}, {off}, {mode:?}: {yaw} {expected}");
        }
    }
}

/// A disc that slides and spins under an even pressure: both stop at once, whatever they were at
/// first, and the speed of sliding over that of the rim approaches 0.653 (Farkas, Bartels, Unger &
/// Wolf 2003, Phys. Rev. Lett. 90 248302), by the arcs of the law 0.568. The true way, angle and
/// time are by their equations `v̇ = −µ g F(v/R ω)` and `ω̇ = −(2 µ g/R) T(v/R ω)` with sums for
/// `F` and `T`; the time is that until a hundredth of the sliding is left, and the ratio that
/// where both speeds together are 0.2 of what the sliding was. By how much the law differs from
/// these stands behind them: the same equations with its arcs, all by `SciPy`'s LSODA at 1e-8. A
/// simulation may differ by [`APART`] more. With a ball the ratio goes to 0, and the first disc
/// comes 0.17 less far.
#[test]
fn a_disc_stops_sliding_and_spinning_at_once() {
    let (mu, thick, radius) = (0.4, 1e-3, 0.1);
    for (speed, spin, truth, law) in [
        (
            0.2,
            10.0,
            [0.022_416, 0.993_75, 0.200_45, 0.4132],
            [0.0064, 0.0010, 0.0005, 0.0813],
        ),
        (
            0.5,
            15.0,
            [0.087_627, 2.386_95, 0.323_21, 0.5318],
            [0.0205, 0.0021, 0.0027, 0.0337],
        ),
        (
            0.5,
            7.656_968,
            [0.051_711, 0.791_89, 0.204_77, 0.6530],
            [0.0173, 0.0110, 0.0024, 0.0967],
        ),
        (
            0.6,
            4.0,
            [0.051_248, 0.426_93, 0.179_25, 0.7564],
            [0.0054, 0.0147, 0.0029, 0.0354],
        ),
        (
            0.8,
            2.0,
            [0.082_839, 0.274_20, 0.209_05, 1.4473],
            [0.0001, 0.0084, 0.0009, 0.0519],
        ),
    ] {
        for (step, tolerance) in [(0.0, 1e-3), (0.0, 1e-4), (1.0 / 960.0, 1e-3)] {
            let shape = Shape::Cylinder {
                radius,
                half_length: thick,
            };
            let disc = (shape, [0.25 * radius * radius; 2], thick);
            let mut s = thrown(disc, mu, [speed, spin], (step, tolerance));
            let (mut ratio, mut last) = (0.0, [0.0; 2]);
            let mut before = [speed, radius * spin];
            let first = 0.2 * speed;
            for i in 1..=400 {
                let now = f64::from(i) / 960.0;
                run(&mut s, now, 1.0 / 960.0);
                let v = &s.state().physical.v;
                let speeds = [v[3].hypot(v[4]), radius * v[2].abs()];
                let [sum, summed] = [speeds, before].map(|x| x[0] + x[1]);
                if sum < first && summed >= first {
                    let share = (summed - first) / (summed - sum);
                    let [slides, spins] =
                        [0, 1].map(|k| before[k] + share * (speeds[k] - before[k]));
                    ratio = slides / spins;
                }
                for (k, last) in last.iter_mut().enumerate() {
                    let little = 1e-2 * speed;
                    if speeds[k] < little && before[k] >= little {
                        let share = (before[k] - little) / (before[k] - speeds[k]);
                        *last = now - (1.0 - share) / 960.0;
                    }
                }
                before = speeds;
            }
            let q = &s.state().physical.q;
            let found = [q[0], 2.0 * libm::atan2(q[6], q[3]), last[0], ratio];
            let off = [0, 1, 2, 3].map(|i| (found[i] / truth[i] - 1.0).abs());
            let fits = (0..4).all(|i| off[i] < law[i] + APART);
            assert!(fits, "{speed}, {spin}, {step}: {found:?}, off by {off:?}");
            let apart = (last[0] - last[1]).abs();
            assert!(apart < 2.5 / 960.0, "{speed}, {spin}, {step}: {last:?}");
        }
    }
}
