//! Which variables are written: names and globs, and the nearest ones where nothing matches.

use super::description::Description;
use super::error::{OUTPUT_VARIABLE, RunError};
use urdf2fmu_core::pattern::Pattern;

/// Names that an error suggests, at most.
const SUGGESTED: usize = 3;

/// Columns that are written, in the order of the table: those that `wanted` matches, or all outputs
/// where nothing is asked for. The first one, `time`, always is.
///
/// - `names`: of the table's columns
pub(super) fn selection(
    description: &Description,
    names: &[String],
    wanted: &[String],
) -> Result<Vec<usize>, RunError> {
    let mut chosen = vec![false; names.len()];
    chosen[0] = true;
    for text in wanted {
        let pattern = Pattern::from(text.as_str());
        let mut found = false;
        for (name, chosen) in names.iter().zip(&mut chosen) {
            let matches = pattern.matches(name);
            *chosen |= matches;
            found |= matches;
        }
        if !found {
            return Err(RunError::Name {
                place: OUTPUT_VARIABLE.to_owned(),
                what: nothing(description, names, &pattern),
            });
        }
    }
    if wanted.is_empty() {
        for (name, chosen) in names.iter().zip(&mut chosen) {
            let variable = description.find(name);
            *chosen |= variable.is_some_and(|v| v.causality == "output");
        }
    }
    Ok((0..names.len()).filter(|&i| chosen[i]).collect())
}

/// What is said of a name or glob that matches nothing.
fn nothing(description: &Description, names: &[String], pattern: &Pattern) -> String {
    let text = &pattern.text;
    let known = description.find(text).map(|v| v.causality.as_str());
    let what = match known {
        Some(causality) => {
            let vowel = causality.starts_with(['a', 'e', 'i', 'o', 'u']);
            let article = if vowel { "an" } else { "a" };
            format!("'{text}' is neither an output nor an input, but {article} {causality}")
        }
        None if pattern.is_glob() => format!("no output or input matches '{text}'"),
        None => format!("there is no output or input '{text}'"),
    };
    let several = text.contains(',') && text.split(',').all(|part| !part.trim().is_empty());
    if several {
        return format!("{what}; each name has an {OUTPUT_VARIABLE} of its own");
    }
    let nearest = nearest(names, pattern);
    match nearest.split_last() {
        None => format!("{what}; urdf2fmu info --variables lists all"),
        Some((last, [])) => format!("{what}; did you mean {last}?"),
        Some((last, others)) => format!("{what}; did you mean {} or {last}?", others.join(", ")),
    }
}

/// The nearest names, or globs that match something, in quotes.
fn nearest(names: &[String], pattern: &Pattern) -> Vec<String> {
    let text = &pattern.text;
    let mut near: Vec<(usize, String)> = Vec::new();
    for name in names {
        let suggested = if pattern.is_glob() {
            mended(text, name)
        } else {
            Some(name.clone())
        };
        let Some(suggested) = suggested else { continue };
        let distance = strsim::damerau_levenshtein(text, &suggested);
        let most = (text.chars().count() / 3).clamp(1, 8);
        if distance <= most && !near.iter().any(|(_, s)| *s == suggested) {
            near.push((distance, suggested));
        }
    }
    // A part of names, such as that of a joint.
    if near.is_empty() && text.len() > 2 {
        let with_it = names.iter().filter(|name| name.contains(text.as_str()));
        near.extend(with_it.map(|name| (0, name.clone())));
    }
    // Of equally near ones the first in the table.
    near.sort_by_key(|(distance, _)| *distance);
    let least = near.first().map_or(0, |(distance, _)| *distance);
    near.retain(|(distance, _)| *distance <= least + 2);
    near.into_iter()
        .take(SUGGESTED)
        .map(|(_, name)| format!("'{name}'"))
        .collect()
}

/// A glob with the parts between its dots taken from a name where they do not match it.
fn mended(glob: &str, name: &str) -> Option<String> {
    let (parts, others): (Vec<&str>, Vec<&str>) =
        (glob.split('.').collect(), name.split('.').collect());
    let part = |(part, other): (&&str, &&str)| {
        let kept = Pattern::from(*part).matches(other);
        (if kept { *part } else { *other }).to_owned()
    };
    let mended: Vec<String> = parts.iter().zip(&others).map(part).collect();
    (parts.len() == others.len()).then(|| mended.join("."))
}

#[cfg(test)]
mod tests {
    use super::super::variable::{Kind, Variable};
    use super::*;

    const NAMES: [&str; 7] = [
        "time",
        "base.position.x",
        "base.position.y",
        "joint.left.position",
        "joint.left.velocity",
        "joint.right.position",
        "cmd.left.velocity",
    ];

    fn select(wanted: &[&str]) -> Result<Vec<usize>, String> {
        let text = |text: &&str| (*text).to_owned();
        let names: Vec<String> = NAMES.iter().map(text).collect();
        let wanted: Vec<String> = wanted.iter().map(text).collect();
        selection(&Description::default(), &names, &wanted).map_err(|error| error.to_string())
    }

    #[test]
    fn names_and_globs_select_columns_in_the_order_of_the_table() {
        let wanted = ["joint.*.position", "base.position.x", "joint.left.*"];
        assert_eq!(select(&wanted), Ok(vec![0, 1, 3, 4, 5]));
        assert_eq!(select(&["time"]), Ok(vec![0]));
    }

    #[test]
    fn what_matches_nothing_is_an_error_with_the_nearest_names() {
        let message = |wanted: &str| select(&[wanted]).expect_err("nothing matches");
        assert_eq!(
            message("joint.lft.position"),
            "--output-variable: there is no output or input 'joint.lft.position'; \
             did you mean 'joint.left.position'?"
        );
        assert_eq!(
            message("joint.*.positon"),
            "--output-variable: no output or input matches 'joint.*.positon'; \
             did you mean 'joint.*.position'?"
        );
        assert_eq!(
            message("base.position.w"),
            "--output-variable: there is no output or input 'base.position.w'; \
             did you mean 'base.position.x' or 'base.position.y'?"
        );
        // What is far from all is not guessed; a part of names is found.
        for far in ["something else", "nope", "x"] {
            let message = message(far);
            assert!(
                message.ends_with("urdf2fmu info --variables lists all"),
                "{message}"
            );
        }
        assert_eq!(
            message("right"),
            "--output-variable: there is no output or input 'right'; \
             did you mean 'joint.right.position'?"
        );
    }

    #[test]
    fn the_time_is_said_to_be_an_independent_variable() {
        let time = Variable {
            name: "t".to_owned(),
            value_reference: 0,
            kind: Kind::Real,
            causality: "independent".to_owned(),
            variability: "continuous".to_owned(),
            initial: String::new(),
            unit: "s".to_owned(),
        };
        let description = Description {
            variables: vec![time],
            ..Description::default()
        };
        let (names, wanted) = (["time".to_owned()], ["t".to_owned()]);
        let error = selection(&description, &names, &wanted).expect_err("not recorded");
        assert!(error.to_string().contains("but an independent"), "{error}");
    }
}
