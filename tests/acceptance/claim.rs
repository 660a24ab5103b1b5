//! A claim of an acceptance case, and its row of the table in `docs/acceptance.md`.
//!
//! A claim has a target, which stands in the test, and a figure: what was measured when figures
//! were recorded last, in `tests/acceptance/figures/`. A claim that meets its target is held to
//! [`WIDE`] times its figure, and to no more than the target; a figure of zero is held to zero.
//! Results are the same on every machine to the last bit, so that nothing wider is needed. A claim
//! that misses its target is held to [`WIDE`] times its figure, too, stands in the table as missed,
//! and fails once it meets the target. A change of the method that moves figures needs one run of
//! `.ci/acceptance record`, which records them; the table shows which targets are missed then.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Largest ratio of a bound to the recorded value.
const WIDE: f64 = 3.0;

thread_local! {
    /// Figures of the test that this thread runs: those recorded, and those measured now.
    static FIGURES: RefCell<(BTreeMap<String, f64>, BTreeMap<String, f64>)> =
        RefCell::new((read(), BTreeMap::new()));
}

/// Name of the test that this thread runs.
fn test() -> String {
    std::thread::current().name().unwrap_or_default().to_owned()
}

/// The file with the figures of the test that this thread runs.
fn file() -> PathBuf {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/acceptance/figures");
    PathBuf::from(folder).join(test().replace("::", ".") + ".txt")
}

/// Whether figures are recorded anew.
fn records() -> bool {
    std::env::var_os("URDF2FMU_RECORD").is_some()
}

fn read() -> BTreeMap<String, f64> {
    let text = std::fs::read_to_string(file()).unwrap_or_default();
    let lines = text.lines().filter_map(|line| {
        let (figure, claim) = line.split_once(' ')?;
        Some((claim.to_owned(), figure.parse().ok()?))
    });
    lines.collect()
}

/// The least number of two digits that is not below a figure: what misses its target by a hair has
/// a figure that does so, too.
fn rounded_up(error: f64) -> f64 {
    if error <= 0.0 {
        return 0.0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent of ten")]
    let unit = 10_f64.powi(error.log10().floor() as i32 - 1);
    // The rest of the division is round-off where the figure has two digits already.
    let above = unit * (error / unit - 1e-9).ceil();
    format!("{above:.1e}").parse().expect("a number")
}

/// The recorded figure of a claim; where figures are recorded, what is measured becomes it.
fn figure(claim: String, error: f64) -> Option<f64> {
    FIGURES.with_borrow_mut(|(known, measured)| {
        if !records() {
            return known.get(&claim).copied();
        }
        let figure = rounded_up(error.abs());
        measured.insert(claim, figure);
        let mut text = String::new();
        for (claim, figure) in &*measured {
            writeln!(text, "{figure:.1e} {claim}").expect("a string");
        }
        std::fs::create_dir_all(file().parent().expect("a folder")).expect("a folder");
        std::fs::write(file(), text).expect("the file of figures can be written");
        Some(figure)
    })
}

/// Holds one claim of a case to its target and to its figure.
#[track_caller]
pub fn hold(case: &str, quantity: &str, expected: &str, error: f64, target: f64) {
    hold_or_say([case, quantity, expected], error, target, "");
}

/// The same with the reason that the table gives while the target is missed.
#[track_caller]
pub fn hold_or_say(claim: [&str; 3], error: f64, target: f64, why: &str) {
    let [case, quantity, _] = claim;
    let known = figure(format!("{case}, {quantity}"), error);
    let figure = known.unwrap_or_else(|| {
        panic!("{case}, {quantity}: no figure is recorded; `.ci/acceptance record` records it");
    });
    let missed = figure > target;
    let bound = if missed {
        WIDE * figure
    } else {
        target.min(WIDE * figure)
    };
    if missed {
        let held = format!("**missed: {target:.1e}**; {bound:.1e}");
        row(claim, error, &held, why);
    } else {
        row(claim, error, &format!("{bound:.1e}"), "");
    }
    if records() {
        return;
    }
    // A NaN holds nothing.
    assert!(
        error.abs() <= bound,
        "{case}, {quantity}: off by {error:e}, allowed {bound:e}"
    );
    assert!(
        !missed || error.abs() > target,
        "{case}, {quantity}: off by {error:e} meets its target of {target:e}; `.ci/acceptance record` \
         records that"
    );
}

/// Prints a row; where the environment variable `URDF2FMU_ROWS` names a folder, into a file of the
/// test there, too.
#[allow(
    clippy::print_stdout,
    reason = "the table can be read in a test's output"
)]
fn row(claim: [&str; 3], error: f64, held: &str, why: &str) {
    use std::io::Write as _;
    let thread = std::thread::current();
    let test = thread.name().unwrap_or_default();
    let row = format!(
        "| {} | {held} | {error:.1e} | {why} | `{test}` |",
        claim.join(" | ")
    );
    println!("\n{row}");
    if let Some(folder) = std::env::var_os("URDF2FMU_ROWS") {
        let file = std::path::Path::new(&folder).join(test.replace("::", "."));
        let mut options = std::fs::OpenOptions::new();
        let file = options.create(true).append(true).open(file);
        let written = file.and_then(|mut file| writeln!(file, "{row}"));
        written.expect("URDF2FMU_ROWS is a folder that can be written to");
    }
}
