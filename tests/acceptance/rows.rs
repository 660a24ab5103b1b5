//! S: the scenes of `tests/scenes/`, each class swept over sizes, masses, gains and speeds. A row
//! holds the worst of its class. T: scenes from textbooks, one by one.

use super::scenes::press::Placed;
use super::scenes::truth::Rolling;
use super::scenes::{self, Scene, Solver, drawn, press, rim, robots, spin, springs};
use super::*;

const FIXED: Solver = Solver::FIXED;
const T3: Solver = Solver::Tolerance(1e-3);
const T4: Solver = Solver::Tolerance(1e-4);
const T5: Solver = Solver::Tolerance(1e-5);
const T6: Solver = Solver::Tolerance(1e-6);
/// Solvers of most classes.
const USUAL: [Solver; 4] = [FIXED, T3, T4, T5];

/// The rows of one case; a target is that of the scenes of its class.
pub struct Rows {
    case: &'static str,
    /// Why the misses of this case miss, for the table.
    why: &'static str,
}

impl Rows {
    pub fn of(case: &'static str, why: &'static str) -> Self {
        Self { case, why }
    }

    /// A row for the worst of each figure of a class under each solver.
    pub fn judge(&self, class: &str, all: &[Scene], solvers: &[Solver]) {
        let references: Vec<_> = all.iter().map(Scene::solution).collect();
        for &solver in solvers {
            for figure in scenes::worst(all, &references, solver) {
                let quantity = format!("{}, {class}, {}", figure.name, solver.name());
                let claim = [self.case, &quantity, all[0].source];
                let target = figure.target.unwrap_or(f64::NAN);
                hold_or_say(claim, figure.error, target, self.why);
            }
        }
    }
}

/// S1, S2. Springs of pd laws without damping keep their amplitude and their period, and damped
/// ones their damping ratio.
#[test]
fn s1_springs_keep_their_amplitude_and_their_period() {
    let rows = Rows::of("S1", "");
    let frequencies = [0.5, 1.0, 3.0, 5.0, 10.0].map(|f| springs::spring(1.0, f, 0.0));
    rows.judge("1 kg at 0.5 … 10 Hz, 10 s", &frequencies, &USUAL);
    let masses = [1e-2, 1e2].map(|mass| springs::spring(mass, 2.0, 0.0));
    rows.judge("10 g and 100 kg at 2 Hz, 10 s", &masses, &USUAL);
}

#[test]
fn s2_damped_springs_keep_their_damping_ratio() {
    let rows = Rows::of("S2", "");
    let damped: Vec<Scene> = [0.005, 0.01, 0.02, 0.05, 0.1]
        .into_iter()
        .flat_map(|zeta| [1.0, 5.0].map(|f| springs::spring(1.0, f, zeta)))
        .collect();
    rows.judge("ζ 0.005 … 0.1 at 1 and 5 Hz", &damped, &USUAL);
}

/// S3. A body on a sprung leg swings as above a rigid foot.
#[test]
fn s3_a_sprung_foot_swings_as_its_spring() {
    let rows = Rows::of("S3", "steps with contacts damp the spring above them");
    rows.judge("3 Hz, 10 s", &[springs::sprung_foot()], &USUAL);
}

/// S4. A satellite keeps energy and angular momentum for 300 s, however its wheel is held.
#[test]
fn s4_a_satellite_keeps_its_energy_and_its_momentum() {
    let rows = Rows::of(
        "S4",
        "the account of energy grants a share each step, and fixed steps turn the whole body at once",
    );
    let spins = [spin::SPIN, [2.0, 0.1, 0.2], [0.1, 1.5, 0.1]];
    for (gains, held) in [
        ([1.0, 8.0, 200.0], "pd of 1, 8, 200 N·m/rad without kd"),
        ([0.0; 3], "a motor"),
    ] {
        let scenes = gains.iter().zip(spins);
        let all: Vec<Scene> = scenes
            .map(|(kp, spin)| spin::satellite(*kp, spin))
            .collect();
        rows.judge(
            &format!("three spins, wheel held by {held}"),
            &all,
            &[FIXED, T3, T4],
        );
    }
}

/// S5. Tumbling bodies follow Euler's equations, with and without something to hit.
#[test]
fn s5_tumbling_bodies_follow_eulers_equations() {
    let rows = Rows::of(
        "S5",
        "errors per step add up, and a turn about the middle axis multiplies them",
    );
    let shaped = |spin: [f64; 3]| [false, true].map(|shaped| spin::tumble(spin, shaped));
    let solvers = [T3, T4, T5, T6];
    rows.judge("(0.1, 4, 0.1) rad/s", &shaped([0.1, 4.0, 0.1]), &solvers);
    let others = [[4.0, 0.1, 0.1], [1.0, 2.0, 3.0], [0.2, 0.1, 10.0]];
    let others: Vec<Scene> = others.into_iter().flat_map(shaped).collect();
    rows.judge("three more spins of up to 10 rad/s", &others, &solvers);
    // Errors grow by exp(6 √((I₂ − I₁)(I₃ − I₂)/(I₁ I₃)) t) here, a million times in 5 s.
    rows.judge(
        "(0.01, 6, 0.02) rad/s",
        &shaped([0.01, 6.0, 0.02]),
        &solvers,
    );
}

/// S6. A pd law that reaches its effort limit, and leaves it, brings its rotor where the three
/// linear pieces do.
#[test]
fn s6_a_saturated_pd_law_ends_where_its_linear_pieces_do() {
    let rows = Rows::of("S6", "met at 1e-4: long steps");
    let jumps = [0.002, 0.01, 0.05, 0.2, 0.8, 2.0].map(springs::saturated);
    rows.judge("jumps by 2 mrad … 2 rad", &jumps, &[FIXED, T3, T4, T5, T6]);
}

/// S7. A standing can tips at the force of statics in every direction.
#[test]
fn s7_a_standing_can_tips_at_the_force_of_statics() {
    let rows = Rows::of("S7", "");
    for radius in [0.01, 0.05, 0.2] {
        for tall in [1.0, 4.0] {
            let class = format!("R = {radius} m, z = {tall} R");
            let all = [press::tipping(radius, tall, 16)];
            rows.judge(&class, &all, &[FIXED, T3, T4]);
        }
    }
    let leaning: Vec<Scene> = [0.01, 0.05, 0.2]
        .into_iter()
        .flat_map(|radius| [1.0, 4.0].map(|tall| press::leaning_can(radius, tall, 0.9)))
        .collect();
    rows.judge(
        "cans that lean on their edge at 0.9 of that force",
        &leaning,
        &USUAL,
    );
}

/// S8. The exact rolling that the rows of S8 are compared with keeps its energy, and steady
/// motions stay steady in it.
#[test]
fn s8_the_exact_rolling_keeps_its_energy_and_its_steady_lean() {
    let body = Rolling::cylinder(0.1, 0.15, 1.5e-3);
    let lean = 20.0_f64.to_radians();
    let k = X * libm::cos(lean) + Z * libm::sin(lean);
    let rate = body.steady(&k, 13.0);
    let steady = body.after(body.start(&k, &(Z * rate + k * 13.0)), 4.0);
    let off = libm::asin(steady[2]) - lean;
    hold(
        "S8",
        "lean of a steady disc after 4 s, the truth itself, rad",
        "constant",
        off,
        1e-9,
    );
    let energy = |x: &[f64; 9]| {
        let (k, w) = (vector(&x[..3]), vector(&x[3..6]));
        let v = body.arm(&k).cross(&w);
        let along = k.dot(&w);
        let across = w.norm_squared() - along * along;
        0.5 * (body.across * across + body.along * along * along)
            + body.mass * (0.5 * v.norm_squared() + G * x[8])
    };
    let k = X * libm::cos(lean + 0.1) + Z * libm::sin(lean + 0.1);
    let start = body.start(&k, &(Z * rate + k * 13.0));
    let gained = energy(&body.after(start, 4.0)) / energy(&start) - 1.0;
    hold(
        "S8",
        "energy of a wobbling disc after 4 s, the truth itself, relative",
        "constant",
        gained,
        1e-9,
    );
}

/// S8. Cans, discs and coins that roll on their edges go round as rigid bodies do.
#[test]
fn s8_cans_and_discs_roll_on_their_edges() {
    let rows = Rows::of("S8", "the place of contact goes round far in a step");
    for lean in [2.0, 5.0, 10.0, 15.0] {
        let tall: &[f64] = if lean < 12.0 { &[1.0, 3.0] } else { &[1.0] };
        let cans: Vec<Scene> = [0.01, 0.05, 0.2]
            .into_iter()
            .flat_map(|radius| tall.iter().map(move |h| rim::can(radius, *h, lean)))
            .collect();
        let class = format!("cans on their rim at {lean}°");
        rows.judge(&class, &cans, &USUAL);
    }
    let discs = [1.5, 2.0, 3.0].map(|speed| rim::disc(speed, 0.0));
    rows.judge("discs at 1.5 … 3 m/s, steady", &discs, &USUAL);
    let discs = [1.5, 2.0, 3.0].map(|speed| rim::disc(speed, 0.05));
    rows.judge("discs at 1.5 … 3 m/s, wobbling", &discs, &USUAL);
    rows.judge("coin", &[rim::coin()], &[T3, T4, T5, T6]);
}

/// S9. Every shape sinks as deep as the law of stiffness says.
#[test]
fn s9_shapes_sink_as_deep_as_the_law_of_stiffness_says() {
    let rows = Rows::of("S9", "");
    rows.judge("1 kg", &[press::depths()], &[FIXED, T3, T4]);
    let loads = [1.0, 1e2, 1e4, 1e6];
    let cubes: Vec<Scene> = [1e-3, 1.0, 1e3]
        .into_iter()
        .flat_map(|mass| loads.map(|load| press::pressed(mass, load)))
        .collect();
    rows.judge(
        "cubes under up to a million times their weight",
        &cubes,
        &[FIXED, T3, T4],
    );
}

/// S10. Balls rebound with the coefficient of restitution.
#[test]
fn s10_balls_rebound_with_the_coefficient_of_restitution() {
    let rows = Rows::of("S10", "met at 1e-4: long steps");
    let bounces: Vec<Scene> = [0.3, 1.0, 3.0]
        .into_iter()
        .flat_map(|h| [0.3, 0.5, 0.8, 0.95].map(|e| press::bounce([h, e])))
        .collect();
    rows.judge("from 0.3 … 3 m, e 0.3 … 0.95", &bounces, &USUAL);
}

/// S11. A box set down on a slope that it slides down begins as if it had always stood there.
#[test]
fn s11_a_box_released_on_a_slope_slides_as_coulomb_says() {
    let rows = Rows::of("S11", "friction starts without load");
    for (place, how) in [
        (Placed::Touching, "just touching"),
        (Placed::Sunk, "at its static depth"),
        (Placed::Assembled, "height not given"),
    ] {
        let steep = [1.005, 1.01, 1.02, 1.05, 1.2, 2.0];
        let all = steep.map(|steep| press::release(steep, place));
        let class = format!("tan θ = 1.005 … 2 μ, {how}");
        rows.judge(&class, &all, &USUAL);
    }
}

/// S12. Robots whose commands change at every communication step, and light legs, are as far from
/// our own solution as the tolerance lets them expect.
#[test]
fn s12_robots_under_changing_commands_are_off_by_two_tolerances() {
    let rows = Rows::of(
        "S12",
        "single solves take nearly all steps at 1e-4 and looser",
    );
    let h = scenes::H;
    let rovers = [
        robots::rover(true, true, 0.5, h),
        robots::rover(true, true, 0.8, h),
        robots::rover(true, true, 1.0, h),
        robots::rover(true, false, 0.5, h),
    ];
    let solvers = [T3, T4, T5];
    rows.judge(
        "rover, wheels 10 (1 + 0.2 sin 12 t) rad/s, 240 Hz",
        &rovers,
        &solvers,
    );
    let rover = [robots::rover(true, true, 0.5, 1e-3)];
    rows.judge("rover, the same, 1 kHz", &rover, &solvers);
    for (h, name) in [(h, "240 Hz"), (1e-3, "1 kHz")] {
        let class = format!("quadruped, 0.3 sin(12 t + i) rad/s, {name}");
        rows.judge(&class, &[robots::quadruped(h)], &solvers);
    }
    let class = "humanoid, pd targets 0.2 sin(6 t + i) rad, 240 Hz";
    rows.judge(class, &[robots::humanoid(h)], &solvers);
    let legs = [robots::light_legs(), robots::swaying_legs()];
    rows.judge("light legs", &legs, &solvers);
}

/// S13. A hand whose undamped fingers of grams flap between their limits gains no energy.
#[test]
fn s13_a_loose_hand_gains_no_energy() {
    let rows = Rows::of("S13", "");
    let hands = [5.0, 20.0, 60.0].map(robots::loose_hand);
    rows.judge("joints at ≤ 5, 20, 60 rad/s", &hands, &[FIXED, T3, T4]);
}

/// S14. Members of the classes that chance has chosen meet the same targets.
#[test]
fn s14_scenes_drawn_by_chance_meet_the_targets_of_their_classes() {
    let rows = Rows::of("S14", "see the class");
    for (class, members) in drawn::classes(7, 8) {
        rows.judge(&format!("eight {class}"), &members, &[T3, T5]);
    }
}

/// T1. Scenes from textbooks end where their equations say; the table of `docs/sweep.md` has them
/// in fixed steps and at more tolerances.
#[test]
fn t1_scenes_of_textbooks_end_where_their_equations_say() {
    let rows = Rows::of("T1", "see docs/sweep.md");
    for scene in scenes::textbook::all() {
        let name = scene.name.clone();
        rows.judge(&name, &[scene], &[T3, T5]);
    }
}
