//! Words that a misspelt name may have meant.

/// Words longer than this, and more candidates than this, are not compared: the work is their
/// product.
const MOST_COMPARED: (usize, usize) = (100, 5000);

/// What other programs, formats and trades call a thing, and URDF's word for it.
const SYNONYMS: [(&str, &str); 29] = [
    ("ball", "spherical"),
    ("damp", "damping"),
    ("file", "filename"),
    ("fix", "fixed"),
    ("force", "effort"),
    ("free", "floating"),
    ("height", "length"),
    ("hinge", "revolute"),
    ("kind", "type"),
    ("linear", "prismatic"),
    ("max", "upper"),
    ("max_effort", "effort"),
    ("min", "lower"),
    ("name", "link"),
    ("path", "filename"),
    ("pos", "xyz"),
    ("pose", "origin"),
    ("position", "xyz"),
    ("rgb", "rgba"),
    ("rotary", "revolute"),
    ("rotation", "rpy"),
    ("rotational", "revolute"),
    ("slide", "prismatic"),
    ("slider", "prismatic"),
    ("speed", "velocity"),
    ("torque", "effort"),
    ("transform", "origin"),
    ("val", "value"),
    ("weld", "fixed"),
];

/// The word of `known` that is nearest to `word`: the same in other capitals, what others call it,
/// or one that differs by few letters only.
pub fn nearest<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let length = word.chars().count();
    if length > MOST_COMPARED.0 {
        return None;
    }
    let known: Vec<&str> = known.into_iter().take(MOST_COMPARED.1).collect();
    let same = |other: &str| {
        known
            .iter()
            .copied()
            .find(|k| k.eq_ignore_ascii_case(other))
    };
    let mut called = SYNONYMS
        .iter()
        .filter(|(own, _)| own.eq_ignore_ascii_case(word));
    if let Some(found) = same(word).or_else(|| called.find_map(|(_, other)| same(other))) {
        return Some(found);
    }
    let slips = length.div_ceil(3).max(1);
    known
        .iter()
        .copied()
        .filter(|k| k.len().abs_diff(word.len()) <= 4 * slips)
        .map(|k| (strsim::damerau_levenshtein(word, k), k))
        .filter(|&(distance, _)| distance <= slips)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, k)| k)
}

/// ` did you mean 'x'?`, or nothing.
pub(crate) fn did_you_mean<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    nearest(word, known).map_or_else(String::new, |k| format!("did you mean '{k}'?"))
}

/// The candidate that looks most like `name`, however far it is.
pub(crate) fn likeliest<'c>(
    name: &str,
    candidates: impl IntoIterator<Item = &'c str>,
) -> Option<&'c str> {
    let mut best: Option<(f64, &str)> = None;
    for candidate in candidates {
        let likeness = strsim::normalized_damerau_levenshtein(name, candidate)
            + 0.5 * strsim::jaro_winkler(name, candidate);
        // The first of equals, so that the answer does not depend on anything but the order.
        if best.is_none_or(|(most, _)| likeness > most) {
            best = Some((likeness, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn did_you_mean_finds_typing_errors_and_nothing_far_away() {
        let known = ["collision", "visual", "inertial"];
        assert_eq!(nearest("colision", known), Some("collision"));
        assert_eq!(nearest("intertial", known), Some("inertial"));
        assert_eq!(nearest("sensor", known), None);
        // The same in other capitals comes before another word of the same length.
        assert_eq!(nearest("B", ["a", "b"]), Some("b"));
        assert_eq!(nearest("Hinge", ["fixed", "revolute"]), Some("revolute"));
        assert_eq!(nearest("hinge", known), None);
    }
}
