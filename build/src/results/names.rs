//! Which column of a foreign table is which variable.
//!
//! Programs write names in their own ways: `joint.elbow.position`, `joint_elbow_position`
//! (Simulink), `plant.root.robot.joint.elbow.position` (co-simulation tools). Names are therefore
//! compared by their letters and digits, and a prefix that many columns have in common is ignored.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write as _;
use urdf2fmu_drawing::scene::Scene;

/// Names that a note lists, at most.
const LISTED: usize = 6;

/// Gives elements of arrays, `name[1]` and so on, the names of the scene's variables that follow
/// each other under the array's name: `base.position.x`, `.y`, `.z`.
pub(super) fn rename_lists(
    columns: &mut [(String, Vec<f64>)],
    lists: &[(String, usize)],
    scene: &Scene,
) {
    for (name, count) in lists {
        let whole = plain(name) + "_";
        let variables = scene.head.variables.iter().map(|v| v.name.as_str());
        let elements: Vec<&str> = variables.filter(|v| plain(v).starts_with(&whole)).collect();
        // Of other arrays the numbers of the elements stay.
        if elements.len() != *count {
            continue;
        }
        for (k, element) in (1..).zip(elements) {
            let own = format!("{name}[{k}]");
            if let Some(column) = columns.iter_mut().find(|column| column.0 == own) {
                element.clone_into(&mut column.0);
            }
        }
    }
}

/// Gives columns the names of the scene's variables, and says what is missing and what is unknown.
/// Returns why they may be those of another robot.
pub(super) fn rename(
    columns: &mut [(String, Vec<f64>)],
    scene: &Scene,
    notes: &mut Vec<String>,
) -> Option<String> {
    let head = &scene.head;
    let mut variables: HashMap<String, Option<&str>> = HashMap::new();
    for variable in &head.variables {
        // Two variables that differ in nothing but dots are matched by their exact names only.
        let clash = variables.contains_key(&plain(&variable.name));
        let name = (!clash).then_some(variable.name.as_str());
        variables.insert(plain(&variable.name), name);
    }
    let exact: BTreeSet<&str> = head.variables.iter().map(|v| v.name.as_str()).collect();
    let prefix = prefix(columns, &variables);
    let mut taken: BTreeSet<String> = columns
        .iter()
        .filter(|(name, _)| exact.contains(name.as_str()))
        .map(|(name, _)| name.clone())
        .collect();
    let mut renamed = BTreeMap::new();
    let mut unknown = Vec::new();
    for (name, _) in columns.iter_mut() {
        if exact.contains(name.as_str()) {
            continue;
        }
        let plain = plain(name);
        let short = plain.strip_prefix(prefix.as_str()).unwrap_or(&plain);
        let found = variables.get(short).or_else(|| variables.get(&plain));
        match found.copied().flatten() {
            Some(variable) if taken.insert(variable.to_owned()) => {
                renamed.insert(name.clone(), variable.to_owned());
                variable.clone_into(name);
            }
            _ => unknown.push(name.clone()),
        }
    }
    if let Some((was, is)) = renamed.iter().next() {
        notes.push(format!(
            "{} columns have other names than the FMU's variables and were matched, such as \
             '{was}' with '{is}'.",
            renamed.len()
        ));
    }
    if !unknown.is_empty() {
        notes.push(format!(
            "{} of this robot: {}.",
            count(
                unknown.len(),
                "column is no variable",
                "columns are no variables"
            ),
            listed(&unknown)
        ));
    }
    missing(scene, &taken, notes)
}

/// Says which poses cannot be shown; the doubt where that is all of them.
fn missing(scene: &Scene, there: &BTreeSet<String>, notes: &mut Vec<String>) -> Option<String> {
    let head = &scene.head;
    let lacks = |names: &[String]| names.iter().any(|name| !there.contains(name));
    let mut poses = head.tracks().flat_map(|track| &track.variables).peekable();
    if poses.peek().is_some() && !poses.any(|name| there.contains(name)) {
        return Some(format!(
            "No column says where '{}' is, so that it stays where it starts: is it a run of this \
             robot?",
            head.robot
        ));
    }
    for root in &head.roots {
        if lacks(&root.position.variables) || lacks(&root.orientation.variables) {
            let base = match root.name.as_str() {
                "" => "The base".to_owned(),
                name => format!("'{name}'"),
            };
            notes.push(format!(
                "{base} stays where it starts: columns of its position or orientation are missing."
            ));
        }
    }
    let moving = head.joints.iter().filter(|joint| !joint.motions.is_empty());
    let still: Vec<String> = moving
        .filter(|joint| joint.motions.iter().any(|m| lacks(&m.track.variables)))
        .map(|joint| joint.name.clone())
        .collect();
    if !still.is_empty() {
        notes.push(format!(
            "{}, because columns of positions are missing: {}.",
            count(
                still.len(),
                "joint stays where it starts",
                "joints stay where they start"
            ),
            listed(&still)
        ));
    }
    None
}

/// Letters and digits of a name; whatever stands between them is one underscore.
fn plain(name: &str) -> String {
    let mut plain = String::with_capacity(name.len());
    for c in name.chars() {
        if c.is_alphanumeric() {
            plain.push(c);
        } else if !plain.ends_with('_') {
            plain.push('_');
        }
    }
    plain
}

/// What most columns have in front of a variable's name.
fn prefix(columns: &[(String, Vec<f64>)], variables: &HashMap<String, Option<&str>>) -> String {
    let mut votes: BTreeMap<String, usize> = BTreeMap::new();
    for (name, _) in columns {
        let plain = plain(name);
        // The longest known name at its end.
        let starts = std::iter::once(0).chain(plain.match_indices('_').map(|(at, _)| at + 1));
        for start in starts {
            if variables.contains_key(&plain[start..]) {
                *votes.entry(plain[..start].to_owned()).or_default() += 1;
                break;
            }
        }
    }
    let most = votes.into_iter().max_by_key(|(_, votes)| *votes);
    most.map_or(String::new(), |(prefix, _)| prefix)
}

pub(super) fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn listed(names: &[String]) -> String {
    let mut text = String::new();
    for (i, name) in names.iter().take(LISTED).enumerate() {
        _ = write!(text, "{}'{name}'", if i == 0 { "" } else { ", " });
    }
    if names.len() > LISTED {
        _ = write!(text, " and {} more", names.len() - LISTED);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_compared_by_letters_and_digits() {
        assert_eq!(plain("joint.a-b.position"), "joint_a_b_position");
        assert_eq!(plain("joint_a_b_position"), "joint_a_b_position");
        assert_eq!(plain("関節.x"), "関節_x");
    }

    #[test]
    fn what_most_columns_have_in_front_is_found() {
        let variables = HashMap::from([
            ("base_position_x".to_owned(), None),
            ("energy".to_owned(), None),
        ]);
        let columns = |names: &[&str]| -> Vec<(String, Vec<f64>)> {
            names
                .iter()
                .map(|name| ((*name).to_owned(), Vec::new()))
                .collect()
        };
        let of = |names: &[&str]| prefix(&columns(names), &variables);
        assert_eq!(
            of(&["plant.root.base.position.x", "plant/root/energy", "u"]),
            "plant_root_"
        );
        assert_eq!(of(&["base_position_x", "energy"]), "");
        assert_eq!(of(&["u"]), "");
    }
}
