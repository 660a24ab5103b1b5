//! A claim of an acceptance case, and its row of the table in `docs/acceptance.md`.
//!
//! A claim is held by two bounds: what it promises, which stands in the test, and [`WIDE`] times
//! what was measured when figures were recorded last, in `tests/acceptance/figures/`. So nothing
//! gets worse unnoticed where a promise is wide, and a change of the method that moves every figure
//! needs one run with `URDF2FMU_RECORD=1`, which prints the promises that are broken. Those stand
//! in the table as misses until they are met again. Where there is a reason for a bound by the
//! promise alone, [`hold_wide`] gives it in the table. A target that is not met is a row of its own
//! kind, [`miss`].

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Largest ratio of a bound to the recorded value.
const WIDE: f64 = 3.0;

/// Bound of figures that are nothing but round-off.
const ROUND_OFF: f64 = 1e-13;

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

/// The recorded figure of a claim; where figures are recorded, takes the measured one.
fn recorded(claim: String, error: f64) -> Option<f64> {
    FIGURES.with_borrow_mut(|(known, measured)| {
        if records() {
            measured.insert(claim, error.abs());
            let mut text = String::new();
            for (claim, figure) in &*measured {
                writeln!(text, "{figure:.1e} {claim}").expect("a string");
            }
            std::fs::create_dir_all(file().parent().expect("a folder")).expect("a folder");
            std::fs::write(file(), text).expect("the file of figures can be written");
            return None;
        }
        known.get(&claim).copied()
    })
}

/// Holds one claim of a case: `error` must exceed neither `allowed` nor [`WIDE`] times what is
/// recorded.
#[track_caller]
pub fn hold(case: &str, quantity: &str, expected: &str, error: f64, allowed: f64) {
    let recorded = recorded(format!("{case}, {quantity}"), error);
    let measured = recorded.map_or(allowed, |r| (WIDE * r).max(ROUND_OFF));
    // What was promised and is missed since a change of the method stays in the table as a miss.
    let missed = recorded.is_some_and(|r| r > allowed.max(ROUND_OFF));
    let bound = if missed {
        measured
    } else {
        measured.min(allowed.max(ROUND_OFF))
    };
    let held = if missed {
        format!("**missed: {allowed:.1e}**; {bound:.1e}")
    } else {
        format!("{bound:.1e}")
    };
    row([case, quantity, expected], error, &held, "");
    // A NaN holds nothing.
    check(
        error.abs() <= bound,
        &format!("{case}, {quantity}: off by {error:e}, allowed {bound:e}"),
    );
    assert!(
        records() || recorded.is_some(),
        "{case}, {quantity}: no figure is recorded; URDF2FMU_RECORD=1 does"
    );
}

/// Fails with a message; where figures are recorded it prints it only.
#[track_caller]
#[allow(clippy::print_stderr, reason = "for whoever records")]
fn check(holds: bool, message: &str) {
    if records() && !holds {
        eprintln!("BROKEN {message}");
    } else {
        assert!(holds, "{message}");
    }
}

/// The same with a bound that is wider than what is measured, and the reason.
#[allow(dead_code, reason = "not every test target has such a claim")]
#[track_caller]
pub fn hold_wide([case, quantity, expected]: [&str; 3], error: f64, allowed: f64, why: &str) {
    row(
        [case, quantity, expected],
        error,
        &format!("{allowed:.1e}"),
        why,
    );
    assert!(
        error.abs() <= allowed,
        "{case}, {quantity}: off by {error:e}, allowed {allowed:e}"
    );
}

/// A target that is missed: `error` must not be worse than `recorded`, which is at most [`WIDE`]
/// times as much, and becomes a claim to [`hold`] once it is within the `target`.
#[allow(dead_code, reason = "not every test target has such a row")]
#[track_caller]
pub fn miss(
    [case, quantity, expected]: [&str; 3],
    error: f64,
    target: f64,
    recorded: f64,
    why: &str,
) {
    let held = format!("**missed: {target:.1e}**; {recorded:.1e}");
    row([case, quantity, expected], error, &held, why);
    check(
        error.abs() <= recorded && recorded <= WIDE * error.abs(),
        &format!("{case}, {quantity}: off by {error:e}, recorded {recorded:e}"),
    );
    check(
        error.abs() > target,
        &format!("{case}, {quantity}: off by {error:e}, which meets the target of {target:e}"),
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
