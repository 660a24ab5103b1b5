//! The scenes with known truths in one table: how far off each is, and what it costs.
//!
//! `cargo bench -p urdf2fmu-core --bench scenes -- [words of names]` runs those whose names contain
//! one of the words, all without words, in fixed steps and at tolerances of 1e-3 … 1e-6. The first
//! line of a scene shows steps + rejected steps and the milliseconds of CPU time that they took.
//! Each other line shows one figure, with `!` where it misses its target. Robots are compared with
//! our own solution. With `--profile test` it builds faster and runs a little slower.
//!
//! With `--sweep=FILE` it measures the scenes of textbooks and writes their table into FILE,
//! `docs/sweep.md`, between its marks: the worst on top.
//!
//! With `--drawn=SEED` it runs eight members of each class that chance has chosen, and shows their
//! largest error in units of its target.
//!
//! With `--ablation=FILE` it switches off one rule of the method after the other, and writes a
//! table of what each costs and saves into FILE, `docs/design.md`, between its marks.
//!
//! With `--order` the table shows, from 1e-3 to 1e-7, how far each is from our own solution at
//! 1e-9 (`--order=1e-8`: at that), and the factor by which the error falls from each tolerance to
//! the next: 10 where it is proportional.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]
#![expect(clippy::print_stdout, reason = "the tables are the result")]

#[path = "../tests/scenes/mod.rs"]
#[allow(dead_code, missing_docs, reason = "shared with the tests")]
mod scenes;
#[path = "../src/testing.rs"]
#[allow(dead_code, missing_docs, reason = "shared with the unit tests")]
mod testing;

use scenes::{Scene, Solver};
use std::fmt::Write as _;
// Where the models of the unit tests look for them.
use urdf2fmu_core::tuning::Rules;
use urdf2fmu_core::{geometry, model, range, simulation, spatial};

const SOLVERS: [Solver; 5] = [
    Solver::FIXED,
    Solver::Tolerance(1e-3),
    Solver::Tolerance(1e-4),
    Solver::Tolerance(1e-5),
    Solver::Tolerance(1e-6),
];

/// One line: a name and a cell for each solver.
fn line(name: &str, cells: &[String]) {
    print!("{name:<52}");
    for cell in cells {
        print!(" {cell:>19}");
    }
    println!();
}

fn table(chosen: &[Scene]) {
    line("", &SOLVERS.map(Solver::name));
    let mut total = 0.0;
    for scene in chosen {
        let runs = SOLVERS.map(|solver| (scene.simulate)(solver));
        total += runs.iter().map(|run| run.seconds).sum::<f64>();
        let costs = runs.each_ref().map(|run| {
            format!(
                "{:.0}+{:.0} {:.1}",
                run.steps,
                run.rejected,
                1e3 * run.seconds
            )
        });
        line(&scene.name, &costs);
        let mut figures: Vec<(String, Vec<String>)> = Vec::new();
        for (solver, run) in SOLVERS.into_iter().zip(&runs) {
            for figure in (scene.judge)(solver, run) {
                let missed = figure.missed();
                let cell = format!("{:.2e}{}", figure.error, if missed { "!" } else { " " });
                match figures.iter_mut().find(|(name, _)| *name == figure.name) {
                    Some((_, cells)) => cells.push(cell),
                    None => figures.push((figure.name, vec![cell])),
                }
            }
        }
        for (name, cells) in figures {
            line(&format!("    {name}"), &cells);
        }
        if let Some(tolerance) = scene.reference {
            let reference = (scene.simulate)(Solver::Tolerance(tolerance));
            total += reference.seconds;
            let cells = runs
                .each_ref()
                .map(|run| format!("{:.2e} ", run.apart(&reference)));
            let ms = 1e3 * reference.seconds;
            line(
                &format!("    from our own at {tolerance:.0e} ({ms:.0} ms)"),
                &cells,
            );
        }
    }
    println!("{total:.1} s in all");
}

/// The largest share of a target that a scene drawn by chance reaches, and how many miss.
fn drawn(seed: u64) {
    line("largest error in targets", &SOLVERS.map(Solver::name));
    let mut missed = [0; 5];
    let classes = scenes::drawn::classes(seed, 8);
    let chosen: Vec<&Scene> = classes.iter().flat_map(|(_, members)| members).collect();
    for scene in &chosen {
        let mut i = 0;
        let cells = SOLVERS.map(|solver| {
            let run = (scene.simulate)(solver);
            let figures = (scene.judge)(solver, &run);
            let shares = figures
                .iter()
                .filter_map(|f| f.target.map(|target| f.error / target));
            let worst = shares.fold(0.0, scenes::larger);
            let misses = figures.iter().any(scenes::Figure::missed);
            missed[i] += usize::from(misses);
            i += 1;
            format!("{worst:.3}{}", if misses { "!" } else { " " })
        });
        line(&scene.name, &cells);
    }
    let cells = missed.map(|count| format!("{count} "));
    line(&format!("misses of {}", chosen.len()), &cells);
}

fn order(chosen: &[Scene], tight: f64) {
    let tolerances = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
    line(
        "largest error of a position",
        &tolerances.map(|t| format!("tol {t:.0e}")),
    );
    for scene in chosen {
        let reference = (scene.simulate)(Solver::Tolerance(tight));
        let errors = tolerances.map(|t| (scene.simulate)(Solver::Tolerance(t)).apart(&reference));
        let mut before = f64::NAN;
        let cells = errors.map(|error| {
            let fall = before / error;
            before = error;
            format!(
                "{error:.1e} {:>7}",
                if fall.is_nan() {
                    String::new()
                } else {
                    format!("/{fall:.1}")
                }
            )
        });
        line(&scene.name, &cells);
    }
}

/// The scenes of textbooks as rows of a table, ordered by the largest share of a target.
fn sweep() -> String {
    let mut rows: Vec<(f64, String)> = Vec::new();
    for scene in scenes::textbook::all() {
        let figures = SOLVERS.map(|solver| {
            let run = (scene.simulate)(solver);
            (scene.judge)(solver, &run).remove(0)
        });
        let share = |f: &scenes::Figure| f.target.map_or(0.0, |target| f.error / target);
        let worst = figures.iter().map(share).fold(0.0, scenes::larger);
        let cells = figures.each_ref().map(|f| {
            let mark = if f.missed() { "**" } else { "" };
            format!("{mark}{:.1e}{mark}", f.error)
        });
        let target = figures[1].target.unwrap_or(f64::NAN);
        rows.push((
            worst,
            format!(
                "| {} | {} | {} | {target:.0e} | {} | {worst:.2} |",
                scene.name,
                scene.source,
                figures[0].name,
                cells.join(" | "),
            ),
        ));
    }
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    let head = "| scene | truth, source | figure | target at 1e-3 | 1/240 s | 1e-3 | 1e-4 | 1e-5 | \
                1e-6 | most, in targets |\n|---|---|---|---|---|---|---|---|---|---|";
    let rows: Vec<String> = rows.into_iter().map(|row| row.1).collect();
    format!("{head}\n{}", rows.join("\n"))
}

/// A rule of the method, and what switches it off.
type Rule = (&'static str, fn(&mut Rules));

const RULES: [Rule; 14] = [
    ("rest", |rules| rules.rest = false),
    ("momentum", |rules| rules.momentum = false),
    ("explicit", |rules| rules.explicit = false),
    ("coast", |rules| rules.coast = false),
    ("look_ahead", |rules| rules.look_ahead = false),
    ("cones", |rules| rules.cones = false),
    ("touchdown", |rules| rules.touchdown = false),
    ("bounce", |rules| rules.bounce = false),
    ("floor", |rules| rules.floor = false),
    ("energy", |rules| rules.energy = false),
    ("secants", |rules| rules.secants = false),
    ("first_stage", |rules| rules.first_stage = false),
    ("parts", |rules| rules.parts = false),
    ("islands", |rules| rules.islands = false),
];

/// One scene under one solver: its steps, and its figures in units of their targets.
struct Shares {
    steps: f64,
    figures: Vec<(String, f64)>,
}

/// All scenes under some solvers with the rules that act now.
///
/// - `references`: our own solutions with all rules, where nothing better exists
fn shares(chosen: &[Scene], references: &[Option<scenes::Run>], solvers: &[Solver]) -> Vec<Shares> {
    let scenes = chosen.iter().zip(references);
    let runs = scenes.flat_map(|(scene, reference)| {
        solvers.iter().map(move |&solver| {
            let run = (scene.simulate)(solver);
            let mut figures = (scene.judge)(solver, &run);
            if let Some(reference) = reference {
                let apart = run.apart(reference);
                let name = "from our own solution";
                figures.push(scenes::figure(name, apart, solver.tolerances(2.0)));
            }
            let figures = figures.into_iter().filter_map(|figure| {
                let share = figure.error / figure.target?;
                let name = format!("{}: {}, {}", scene.name, figure.name, solver.name());
                // A run that failed is as far off as can be.
                Some((name, if share.is_nan() { f64::INFINITY } else { share }))
            });
            Shares {
                steps: (run.steps + run.rejected).max(1.0),
                figures: figures.collect(),
            }
        })
    });
    runs.collect()
}

/// What each rule of the method does for the scenes, as rows of a table.
fn ablation() -> String {
    /// Below this share of its target no error counts.
    const SEEN: f64 = 0.1;
    let solvers = [
        Solver::FIXED,
        Solver::Tolerance(1e-3),
        Solver::Tolerance(1e-5),
    ];
    let chosen = scenes::all();
    let references: Vec<_> = chosen.iter().map(Scene::solution).collect();
    let before = shares(&chosen, &references, &solvers);
    let mut table =
        "| rule | errors twice as large | of these now missed | the most, in targets | \
                     steps, mean | steps, most |\n|---|---|---|---|---|---|"
            .to_owned();
    for (name, switch) in RULES {
        let mut rules = Rules::ALL;
        switch(&mut rules);
        scenes::set_rules(rules);
        let after = shares(&chosen, &references, &solvers);
        scenes::set_rules(Rules::ALL);
        let (mut worse, mut missed, mut most) = (0, 0, (0.0, String::new()));
        let figures = |all: &[Shares]| -> Vec<(String, f64)> {
            all.iter().flat_map(|run| run.figures.clone()).collect()
        };
        for ((figure, with), (_, without)) in figures(&before).into_iter().zip(figures(&after)) {
            if without > SEEN && without > 2.0 * with {
                worse += 1;
                missed += usize::from(without > 1.0 && with <= 1.0);
                if without / with > most.0 {
                    most = (
                        without / with,
                        format!("{figure}: {with:.1e} → {without:.1e}"),
                    );
                }
            }
        }
        let steps = before.iter().zip(&after).map(|(b, a)| a.steps / b.steps);
        let steps: Vec<f64> = steps.collect();
        let mean = (steps.iter().map(|x| x.ln()).sum::<f64>() / steps.len() as f64).exp();
        let largest = steps.iter().copied().fold(0.0, f64::max);
        let _ = write!(
            table,
            "\n| `{name}` | {worse} | {missed} | {} | × {mean:.2} | × {largest:.1} |",
            most.1
        );
    }
    table
}

/// Replaces what stands between the marks of a document.
fn write_between_marks(path: &str, mark: &str, table: &str) {
    let text = std::fs::read_to_string(path).expect("the document can be read");
    let begin = text
        .find(&format!("<!-- {mark} begin"))
        .expect("a mark where the table begins");
    let begin = begin + text[begin..].find('\n').expect("a line below the mark") + 1;
    let end = text
        .find(&format!("<!-- {mark} end"))
        .expect("a mark where the table ends");
    let text = format!("{}\n{table}\n\n{}", &text[..begin], &text[end..]);
    std::fs::write(path, text).expect("the document can be written");
}

fn main() {
    let mut words = Vec::new();
    let mut tight = None;
    for argument in std::env::args().skip(1).filter(|a| a != "--bench") {
        if let Some(seed) = argument.strip_prefix("--drawn=") {
            drawn(seed.parse().expect("--drawn=SEED"));
            return;
        }
        if let Some(path) = argument.strip_prefix("--sweep=") {
            write_between_marks(path, "sweep", &sweep());
            return;
        }
        if let Some(path) = argument.strip_prefix("--ablation=") {
            write_between_marks(path, "ablation", &ablation());
            return;
        }
        match argument.strip_prefix("--order") {
            Some("") => tight = Some(1e-9),
            Some(value) => {
                let number = value.trim_start_matches('=').parse();
                tight = Some(number.expect("--order=TOLERANCE"));
            }
            None => words.push(argument),
        }
    }
    let chosen: Vec<Scene> = scenes::all()
        .into_iter()
        .filter(|scene| words.is_empty() || words.iter().any(|word| scene.name.contains(word)))
        .collect();
    match tight {
        Some(tight) => order(&chosen, tight),
        None => table(&chosen),
    }
}
