//! Which variables share a panel, and what they are called in it.

use super::curve::Curve;
use std::collections::BTreeSet;
use urdf2fmu_drawing::scene::Head;

/// Curves of a panel, at most: as many as there are colours.
pub(super) const CURVES: usize = 8;

/// Curves that belong together.
#[derive(Debug)]
pub(super) struct Panel<'p, 'c> {
    /// What the names share, with a `*` for the rest.
    pub(super) title: String,
    pub(super) unit: &'c str,
    pub(super) curves: &'p [&'p Curve<'c>],
    /// Of the curves: what they do not share.
    pub(super) names: Vec<String>,
}

/// Curves of one unit and quantity, in the order of their first.
pub(super) fn groups<'p, 'c>(curves: &'p [Curve<'c>]) -> Vec<Vec<&'p Curve<'c>>> {
    let alike = |a: &Curve, b: &Curve| a.unit == b.unit && ends(a.name) == ends(b.name);
    let mut groups: Vec<Vec<&Curve>> = Vec::new();
    for curve in curves {
        match groups.iter_mut().find(|group| alike(group[0], curve)) {
            Some(group) => group.push(curve),
            None => groups.push(vec![curve]),
        }
    }
    groups
}

/// Panels of a group, none with more than [`CURVES`]; components of a vector stay together.
pub(super) fn panels<'p, 'c>(group: &'p [&'p Curve<'c>]) -> Vec<Panel<'p, 'c>> {
    let all: Vec<&str> = group.iter().map(|curve| curve.name).collect();
    let lasts: BTreeSet<&str> = all.iter().map(|name| last_part(name)).collect();
    let vectors =
        lasts.iter().all(|last| component(last)) && group.len().is_multiple_of(lasts.len());
    let stride = if vectors { lasts.len() } else { 1 };
    let things = group.len() / stride;
    let count = things.div_ceil(CURVES / stride);
    let (title, names) = (title(&all), short_names(&all));
    (0..count)
        .map(|i| {
            // Their sizes differ by one thing at most.
            let from = i * things / count * stride;
            let to = (i + 1) * things / count * stride;
            Panel {
                title: if count > 1 {
                    format!("{title}  ({} of {count})", i + 1)
                } else {
                    title.clone()
                },
                unit: group[from].unit,
                curves: &group[from..to],
                names: names[from..to].to_vec(),
            }
        })
        .collect()
}

/// Whether the last part of a name is a component of a vector.
fn component(part: &str) -> bool {
    matches!(part, "x" | "y" | "z" | "w" | "roll" | "pitch" | "yaw")
}

fn last_part(name: &str) -> &str {
    name.rsplit(['.', '_']).next().unwrap_or(name)
}

/// First part of a name and the last one that is no component: `joint`, `position`. Of two parts,
/// as in `energy.kinetic`, the second is what differs.
fn ends(name: &str) -> (&str, &str) {
    let parts: Vec<&str> = name.split(['.', '_']).collect();
    match parts[..] {
        [first, last] if !component(last) => (first, ""),
        _ => {
            let last = parts.iter().rfind(|part| !component(part));
            (parts[0], last.unwrap_or(&parts[0]))
        }
    }
}

/// Numbers of parts that all names share in front and behind; never a whole name.
fn shared(parts: &[Vec<&str>]) -> (usize, usize) {
    let least = parts.iter().map(Vec::len).min().unwrap_or(0);
    let same = |at: &dyn Fn(&Vec<&str>) -> String| {
        parts.windows(2).all(|pair| at(&pair[0]) == at(&pair[1]))
    };
    let mut first = 0;
    while first + 1 < least && same(&|list| list[first].to_owned()) {
        first += 1;
    }
    let mut last = 0;
    while last + first + 1 < least && same(&|list| list[list.len() - 1 - last].to_owned()) {
        last += 1;
    }
    (first, last)
}

/// `joint.*.position`
fn title(names: &[&str]) -> String {
    let [first, _, ..] = names else {
        return names
            .first()
            .map_or(String::new(), |name| (*name).to_owned());
    };
    let separator = if first.contains('.') { "." } else { "_" };
    let parts: Vec<Vec<&str>> = names.iter().map(|n| n.split(separator).collect()).collect();
    let (front, back) = shared(&parts);
    let mut list: Vec<&str> = parts[0][..front].to_vec();
    list.push("*");
    list.extend(&parts[0][parts[0].len() - back..]);
    // `base.position.*` says no more than `base.position`.
    if back == 0 && front > 0 && names.iter().all(|name| component(last_part(name))) {
        list.pop();
    }
    list.join(separator)
}

/// `left` and `right` of `joint.left_wheel.velocity` and `joint.right_wheel.velocity`.
fn short_names(names: &[&str]) -> Vec<String> {
    if names.len() < 2 {
        return names.iter().map(|name| (*name).to_owned()).collect();
    }
    let parts: Vec<Vec<&str>> = names.iter().map(|name| pieces(name)).collect();
    let (front, back) = shared(&parts);
    let short = |list: &Vec<&str>| list[front..list.len() - back].concat();
    parts
        .iter()
        .map(|list| short(list).trim_start_matches(['.', '_']).to_owned())
        .collect()
}

/// A name cut before each of its dots and underscores.
fn pieces(name: &str) -> Vec<&str> {
    let mut cuts: Vec<usize> = name.match_indices(['.', '_']).map(|(at, _)| at).collect();
    cuts.retain(|at| *at > 0);
    let starts = std::iter::once(0).chain(cuts.iter().copied());
    let ends = cuts.iter().copied().chain(std::iter::once(name.len()));
    starts.zip(ends).map(|(from, to)| &name[from..to]).collect()
}

/// Names of what says most about a run, as the page of a report has it: base, joints, contacts,
/// efforts, energy. What is zero throughout says nothing.
pub fn defaults(head: &Head, columns: &[(String, Vec<f64>)]) -> Vec<String> {
    let mut names: Vec<String> = head.base().position.variables.clone();
    // Beside the position: `base.position.x` and `base.rpy.roll`, with dots or underscores.
    for (position, angle) in head
        .base()
        .position
        .variables
        .iter()
        .zip(["roll", "pitch", "yaw"])
    {
        if let Some((front, back)) = position.split_once("position") {
            let separator = &back[..back.len().min(1)];
            names.push(format!("{front}rpy{separator}{angle}"));
        }
    }
    for joint in &head.joints {
        let named = |key: &str| joint.variables.get(key).cloned();
        let spins = named("cmd.velocity").is_some() && named("cmd.position").is_none();
        names.extend(named(if spins { "velocity" } else { "position" }));
        let driven = joint.variables.keys().any(|key| key.starts_with("cmd."));
        names.extend(named("effort").filter(|_| driven));
    }
    names.extend(
        head.contacts
            .iter()
            .filter_map(|contact| contact.force.get(2).cloned()),
    );
    let energy = head
        .variables
        .iter()
        .filter(|v| v.causality == "output" && v.unit == "J");
    names.extend(energy.map(|variable| variable.name.clone()));
    let moves = |name: &String| {
        let column = columns.iter().find(|(other, _)| other == name);
        column.is_some_and(|(_, values)| values.iter().any(|x| *x != 0.0))
    };
    names.retain(moves);
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Titles and names of all panels of variables.
    fn of(names: &[(&str, &str)]) -> Vec<(String, Vec<String>)> {
        let curve = |(name, unit)| Curve {
            name,
            unit,
            stepped: false,
            values: &[],
        };
        let curves: Vec<Curve> = names.iter().copied().map(curve).collect();
        let groups = groups(&curves);
        let panels = groups.iter().flat_map(|group| panels(group));
        panels.map(|panel| (panel.title, panel.names)).collect()
    }

    fn is(title: &str, names: &[&str]) -> (String, Vec<String>) {
        let names = names.iter().map(|name| (*name).to_owned());
        (title.to_owned(), names.collect())
    }

    #[test]
    fn variables_of_one_quantity_share_a_panel_and_names_lose_what_they_share() {
        let found = of(&[
            ("base.position.x", "m"),
            ("joint.left_wheel.velocity", "rad/s"),
            ("base.rpy.yaw", "rad"),
            ("base.position.y", "m"),
            ("joint.right_wheel.velocity", "rad/s"),
            ("joint.lift.velocity", "m/s"),
            ("energy.kinetic", "J"),
            ("energy.potential", "J"),
        ]);
        assert_eq!(
            found,
            [
                is("base.position", &["x", "y"]),
                is("joint.*.velocity", &["left", "right"]),
                is("base.rpy.yaw", &["base.rpy.yaw"]),
                is("joint.lift.velocity", &["joint.lift.velocity"]),
                is("energy.*", &["kinetic", "potential"]),
            ]
        );
        let flat = of(&[("base_position_x", "m"), ("base_position_z", "m")]);
        assert_eq!(flat, [is("base_position", &["x", "z"])]);
    }

    #[test]
    fn many_curves_are_spread_evenly_over_panels_and_vectors_stay_whole() {
        let joints: Vec<String> = (0..19).map(|i| format!("joint.j{i}.position")).collect();
        let joints: Vec<(&str, &str)> = joints.iter().map(|name| (name.as_str(), "rad")).collect();
        let sizes: Vec<usize> = of(&joints).iter().map(|(_, names)| names.len()).collect();
        assert_eq!(sizes, [6, 6, 7]);
        let (title, names) = &of(&joints)[1];
        assert_eq!(title, "joint.*.position  (2 of 3)");
        assert_eq!(names[0], "j6");
        let names: Vec<String> = (0..5)
            .flat_map(|i| ["x", "y", "z"].map(|axis| format!("contact.l{i}.force.{axis}")))
            .collect();
        let names: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "N")).collect();
        let sizes: Vec<usize> = of(&names).iter().map(|(_, names)| names.len()).collect();
        assert_eq!(sizes, [3, 6, 6]);
    }

    #[test]
    fn a_panel_does_not_drop_what_its_own_names_share_but_others_have_not() {
        let sides = ["left", "right"].iter().flat_map(|side| {
            let part = move |i| format!("joint.{side}_{i}.position");
            (0..6).map(part)
        });
        let names: Vec<String> = sides.collect();
        let names: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "rad")).collect();
        assert_eq!(of(&names)[0].1[0], "left_0");
        // One component of many vectors is no vector.
        let up: Vec<String> = (0..9).map(|i| format!("contact.l{i}.force.z")).collect();
        let up: Vec<(&str, &str)> = up.iter().map(|name| (name.as_str(), "N")).collect();
        let sizes: Vec<usize> = of(&up).iter().map(|(_, names)| names.len()).collect();
        assert_eq!(sizes, [4, 5]);
    }

    #[test]
    fn names_that_begin_alike_stay_apart() {
        assert_eq!(short_names(&["a.b", "a.b.c"]), ["b", "b.c"]);
        assert_eq!(short_names(&["関節_x", "関節_y"]), ["x", "y"]);
    }
}
