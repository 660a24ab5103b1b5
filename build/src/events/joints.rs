//! Joints that reach limits of their positions, motors that reach limits of their efforts.

use super::run::{Event, Run, TOLD, moment, three};

/// A position counts as at its limit within this share of the joint's range …
const NEAR: f64 = 1e-3;

/// … and within this, rad or m.
const NEAREST: f64 = 1e-3;

/// An effort counts as at its limit within this share of it. It is not enough to be above: a table
/// of results does not say whether the limit was raised.
const SATURATED: f64 = 1e-3;

/// A joint that was at a limit.
struct Hit<'r> {
    joint: &'r str,
    /// When first, s.
    time: f64,
    /// For how long in all, s.
    spent: f64,
    /// `upper, 1.57 rad`
    limit: String,
}

/// Joints that came to the URDF's position limits. One that starts there has not come there.
pub(super) fn limits(run: &Run) -> Vec<Event> {
    let mut hits = Vec::new();
    for joint in &run.head.joints {
        let (Some(name), Some([lower, upper])) = (joint.variables.get("position"), joint.limits)
        else {
            continue;
        };
        let Some(positions) = run.columns.get(name.as_str()).filter(|_| lower < upper) else {
            continue;
        };
        let near = NEAREST.min(NEAR * (upper - lower));
        let at = |row: usize| positions[row] <= lower + near || positions[row] >= upper - near;
        let mut rows = 1..run.time.len();
        let Some(first) = rows.find(|row| at(*row) && !at(row - 1)) else {
            continue;
        };
        let (side, limit) = if positions[first] <= lower + near {
            ("lower", lower)
        } else {
            ("upper", upper)
        };
        hits.push(Hit {
            joint: &joint.name,
            time: run.time[first],
            spent: run.spent((first..run.time.len()).filter(|row| at(*row))),
            limit: format!("{side}, {} {}", three(limit), run.unit(name)),
        });
    }
    told(hits, "Position limit", "joints")
}

/// Motors at their greatest effort.
pub(super) fn efforts(run: &Run) -> Vec<Event> {
    let mut hits = Vec::new();
    for joint in &run.head.joints {
        let variable = |key: &str| joint.variables.get(key).map(String::as_str);
        let (Some(name), Some(most)) = (variable("effort"), variable("cmd.max_effort")) else {
            continue;
        };
        let Some(efforts) = run.columns.get(name) else {
            continue;
        };
        let limit = run.setting(most);
        let at = |row: &usize| {
            let limit = limit(*row).filter(|limit| *limit > 0.0);
            limit.is_some_and(|limit| (efforts[*row].abs() - limit).abs() <= SATURATED * limit)
        };
        let rows = || (0..run.time.len()).filter(at);
        let Some(first) = rows().next() else {
            continue;
        };
        hits.push(Hit {
            joint: &joint.name,
            time: run.time[first],
            spent: run.spent(rows()),
            limit: format!("{} {}", three(efforts[first].abs()), run.unit(name)),
        });
    }
    told(hits, "Effort limit", "motors")
}

/// The first hits one by one, the others in one sentence.
fn told(mut hits: Vec<Hit>, what: &str, whose: &str) -> Vec<Event> {
    hits.sort_by(|a, b| a.time.total_cmp(&b.time));
    // One more takes no more room than a summary.
    let single = if hits.len() <= TOLD + 1 {
        hits.len()
    } else {
        TOLD
    };
    let (each, rest) = hits.split_at(single);
    let event = |hit: &Hit| Event {
        time: hit.time,
        text: format!(
            "{what} reached: '{}', {}, first at {}, {} in all.",
            hit.joint,
            hit.limit,
            moment(hit.time),
            moment(hit.spent)
        ),
    };
    let mut events: Vec<Event> = each.iter().map(event).collect();
    if let Some(first) = rest.first() {
        let names = rest.iter().take(TOLD);
        let names: Vec<String> = names.map(|hit| format!("'{}'", hit.joint)).collect();
        let others = match rest.len() - names.len() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        events.push(Event {
            time: first.time,
            text: format!(
                "{what} reached by {} more {whose}, the first at {}: {}{others}.",
                rest.len(),
                moment(first.time),
                names.join(", "),
            ),
        });
    }
    events
}
