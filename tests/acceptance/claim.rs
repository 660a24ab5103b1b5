//! A claim of an acceptance case, and its row of the table in `docs/acceptance.md`.

/// Holds one claim of a case: `error` must not exceed `allowed`. Prints the claim's row of the table.
#[allow(clippy::print_stdout, reason = "the table is made from it")]
#[track_caller]
pub fn hold(case: &str, quantity: &str, expected: &str, error: f64, allowed: f64) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or_default().to_owned();
    println!("\n| {case} | {quantity} | {expected} | {allowed:.1e} | {error:.1e} | `{test}` |");
    // A NaN holds nothing.
    assert!(
        error.abs() <= allowed,
        "{case}, {quantity}: off by {error:e}, allowed {allowed:e}"
    );
}
