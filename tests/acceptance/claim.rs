//! A claim of an acceptance case, and its row of the table in `docs/acceptance.md`.
//!
//! A bound says something only if it lies near what is measured: [`hold`] fails as soon as its
//! bound is more than [`WIDE`] times the measured value. Where there is a reason for a wider bound,
//! [`hold_wide`] gives it in the table. A target that is not met is a row of its own kind,
//! [`miss`].

/// Largest ratio of a bound to the measured value that needs no reason.
const WIDE: f64 = 3.0;

/// Holds one claim of a case: `error` must not exceed `allowed`, which must not exceed it by more
/// than [`WIDE`] times.
#[track_caller]
pub fn hold(case: &str, quantity: &str, expected: &str, error: f64, allowed: f64) {
    row(
        [case, quantity, expected],
        error,
        &format!("{allowed:.1e}"),
        "",
    );
    // A NaN holds nothing.
    assert!(
        error.abs() <= allowed,
        "{case}, {quantity}: off by {error:e}, allowed {allowed:e}"
    );
    assert!(
        allowed <= WIDE * error.abs(),
        "{case}, {quantity}: off by {error:e} only, {allowed:e} allows too much"
    );
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
    assert!(
        error.abs() <= recorded && recorded <= WIDE * error.abs(),
        "{case}, {quantity}: off by {error:e}, recorded {recorded:e}"
    );
    assert!(
        error.abs() > target,
        "{case}, {quantity}: off by {error:e}, which meets the target of {target:e}"
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
