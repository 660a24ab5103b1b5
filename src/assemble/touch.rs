//! Which links of a robot touch each other, and which of them do not touch what is around it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::Findings;
use super::initial::poses;
use super::pairs::{self, Meaning};
use crate::geometry::pair::Patch;
use crate::model::{LinkId, Model};
use crate::pattern::Pattern;
use crate::settings::Settings;
use crate::urdf::Description;
use std::collections::BTreeSet;

/// Overlap before anything moves that is worth a warning, m. Links of one robot then do not touch
/// each other: shapes of neighbours are drawn into each other, and a robot that is pushed apart at
/// once helps nobody.
const DRAWN_TOGETHER: f64 = 1e-3;

/// Lets the robot's links touch each other if the settings say so, but for those that they and the
/// SRDF name, and those that overlap from the beginning.
pub(super) fn select(model: &mut Model, settings: &Settings, findings: &mut Findings) {
    model.roots[0].self_collision = settings.self_collision;
    let names: Vec<&str> = model.links.iter().map(|link| link.name.as_str()).collect();
    let id = |link: usize| LinkId::from(link);
    let mut apart = BTreeSet::new();
    for patterns in &settings.ignored_contacts {
        let mut links = BTreeSet::new();
        for pattern in patterns {
            links.extend(findings.select(pattern, "link", &names, |_| None));
        }
        for &a in &links {
            let above = links.range(a + 1..);
            apart.extend(above.map(|&b| [id(a), id(b)]));
        }
    }
    for pair in &settings.disabled_contacts {
        let place = |name: &String| names.iter().position(|other| other == name);
        if let [Some(a), Some(b)] = [&pair[0], &pair[1]].map(place) {
            apart.insert([id(a.min(b)), id(a.max(b))]);
        }
    }
    model.apart = apart.into_iter().collect();
    if !settings.self_collision {
        return;
    }
    // At joint zero, too: many robots are drawn with what touches there.
    let mut zero = model.clone();
    zero.initial.joint_positions.fill(0.0);
    let mut drawn: Vec<([LinkId; 2], f64)> = Vec::new();
    for model in [&*model, &zero] {
        for (pair, depth) in overlaps(model) {
            match drawn.iter_mut().find(|(known, _)| *known == pair) {
                Some((_, most)) => *most = most.max(depth),
                None => drawn.push((pair, depth)),
            }
        }
    }
    drawn.sort_by_key(|(pair, _)| *pair);
    tell(model, &drawn, findings);
    model.apart.extend(drawn.into_iter().map(|(pair, _)| pair));
    model.apart.sort_unstable();
}

/// Warns of links that overlap, and by how much, m. Of a hand that is drawn folded these are a
/// hundred pairs, which are one thing to look at.
fn tell(model: &Model, drawn: &[([LinkId; 2], f64)], findings: &mut Findings) {
    /// As many pairs at most are told each by itself, and of more of them as many are listed.
    const EACH: usize = 3;
    const LISTED: usize = 20;
    let name = |link: LinkId| &model.links[link.index()].name;
    let overlap = |([a, b], depth): &([LinkId; 2], f64)| {
        let (a, b, depth) = (name(*a), name(*b), 1e3 * depth);
        format!("'{a}' and '{b}' overlap by {depth:.1} mm")
    };
    let help = "name them in [[ignore_contact]] if that is right, else correct their shapes";
    let warning = |pair: &([LinkId; 2], f64)| {
        let overlap = overlap(pair);
        format!("links {overlap} before anything moves, so they do not touch each other")
    };
    if drawn.len() <= EACH {
        for pair in drawn {
            findings.warning("A136", None, warning(pair), help);
        }
        return;
    }
    let mut deepest: Vec<_> = drawn.iter().collect();
    deepest.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let (first, others) = (deepest[0], &deepest[1..]);
    let count = others.len();
    let message = format!("{}; nor do those of {count} more pairs", warning(first));
    let shown = others.iter().take(LISTED).map(|pair| overlap(pair));
    let mut shown: Vec<String> = shown.collect();
    if let more @ 1.. = count.saturating_sub(LISTED) {
        shown.push(format!("and {more} more, which overlap less"));
    }
    let help = format!("{help}\n{}", shown.join("\n"));
    findings.warning("A136", None, message, &help);
}

/// What `[[ignore_contact]]` of a robot in a world says about the robot alone: entries that name
/// nothing else, and of others their links of the robot, if these are pairs that may touch.
pub(super) fn own(settings: &Settings, description: &Description) -> Vec<Vec<Pattern>> {
    let names = || description.links.iter().map(|link| &link.name);
    let of_robot = |pattern: &&Pattern| names().any(|name| pattern.matches(name));
    let entries = settings.ignored_contacts.iter();
    let own = entries.map(|patterns| {
        let own: Vec<Pattern> = patterns.iter().filter(of_robot).cloned().collect();
        let meant = |name: &&String| own.iter().any(|pattern| pattern.matches(name));
        let pairs = settings.self_collision && names().filter(meant).nth(1).is_some();
        (own.len() == patterns.len() || pairs).then_some(own)
    });
    own.flatten().collect()
}

/// Keeps links apart that `[[ignore_contact]]` names with what is around the robot: links of others
/// as `cup.handle`, all of one as `cup`. A glob without a dot means links of the robot alone, as
/// where there is no other.
pub(super) fn across(model: &mut Model, settings: &Settings, findings: &mut Findings) {
    let meanings = pairs::meanings(model);
    let mut apart: BTreeSet<[LinkId; 2]> = model.apart.iter().copied().collect();
    for patterns in &settings.ignored_contacts {
        let own = |m: &&Meaning| m.is_own_link();
        let of_robot = |pattern: &Pattern| {
            let mut own = meanings.iter().filter(own);
            own.any(|m| pattern.matches(m.name)) && named(&meanings, pattern).len() < 2
        };
        if patterns.iter().all(of_robot) {
            continue;
        }
        let mut links = BTreeSet::new();
        for pattern in patterns {
            links.extend(meant(&meanings, pattern, findings));
        }
        let pairs: Vec<[LinkId; 2]> = links
            .iter()
            .flat_map(|&a| links.range(a..).skip(1).map(move |&b| [a, b]))
            .collect();
        let root = |link: LinkId| model.root_of(model.links[link.index()].body);
        let touch = |[a, b]: &[LinkId; 2]| {
            root(*a) != root(*b) || model.roots[root(*a).index()].self_collision
        };
        if !pairs.iter().any(touch) && !findings.has_errors() {
            let place = patterns.first().and_then(|pattern| pattern.place.clone());
            let message =
                "[[ignore_contact]] changes nothing: no two of these links touch each other";
            let help = "name links of two different robots or objects";
            findings.warning("A144", place, message.to_owned(), help);
        }
        apart.extend(pairs);
    }
    model.apart = apart.into_iter().collect();
}

/// What a plain name means.
fn named<'m>(meanings: &'m [Meaning<'m>], pattern: &Pattern) -> Vec<&'m Meaning<'m>> {
    let named = meanings.iter().filter(|m| pattern.text == m.name);
    named.collect()
}

/// Links with a shape that a pattern means, in a world; none after an error.
fn meant(meanings: &[Meaning], pattern: &Pattern, findings: &mut Findings) -> Vec<LinkId> {
    let found: Vec<&Meaning> = if pattern.is_glob() {
        let others = pattern.text.contains('.');
        let links = meanings
            .iter()
            .filter(|m| m.is_own_link() || others && m.is_link());
        links.filter(|m| pattern.matches(m.name)).collect()
    } else {
        named(meanings, pattern)
    };
    let place = pattern.place.clone();
    let text = &pattern.text;
    let links: Vec<Option<LinkId>> = found.iter().flat_map(|m| m.links.clone()).collect();
    match (&found[..], &links[..]) {
        ([], _) => {
            let (message, help) = pairs::unknown(meanings, pattern);
            findings.error("A101", place, message, &help);
            Vec::new()
        }
        ([one, other, ..], _) if !pattern.is_glob() => {
            let message = format!("'{text}' means {} and {}", one.what, other.what);
            findings.error("A102", place, message, "rename one of them");
            Vec::new()
        }
        (_, [None]) => {
            let message =
                "the ground is no link, and what is to fall through it needs none".to_owned();
            let help = "set [world] ground = { type = \"none\" }";
            findings.error("A102", place, message, help);
            Vec::new()
        }
        (_, []) => {
            let message = format!("'{text}' has no collision shape that can touch anything");
            findings.error("A102", place, message, "choose another one");
            Vec::new()
        }
        _ => links.into_iter().flatten().collect(),
    }
}

/// Links whose shapes may touch and overlap at the start by more than [`DRAWN_TOGETHER`], and by
/// how much, m.
pub(super) fn overlaps(model: &Model) -> Vec<([LinkId; 2], f64)> {
    let poses = poses(model);
    let contacts = &poses.tree.contact;
    let colliders = &contacts.colliders;
    let mut patch = Patch::new();
    let mut found: Vec<([LinkId; 2], f64)> = Vec::new();
    for (i, a) in colliders.iter().enumerate() {
        for (j, b) in colliders.iter().enumerate().skip(i + 1) {
            let (Some(first), Some(second)) = (&a.solid, &b.solid) else {
                continue;
            };
            if !contacts.may_touch([i, j]) {
                continue;
            }
            let X = poses.pair([a, b]);
            patch.find((first, &X[0]), (second, &X[1]), 0.0);
            let deepest = patch.points().iter().map(|p| p.depth).fold(0.0, f64::max);
            let pair = [a.link.min(b.link), a.link.max(b.link)].map(LinkId::from);
            if deepest > DRAWN_TOGETHER {
                match found.iter_mut().find(|(known, _)| *known == pair) {
                    Some((_, most)) => *most = most.max(deepest),
                    None => found.push((pair, deepest)),
                }
            }
        }
    }
    found
}
