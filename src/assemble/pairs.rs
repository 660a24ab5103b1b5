//! Pairs of links, or of groups of links, whose contacts with each other are outputs.
//!
//! Names are those of the whole world: links of the robot itself, links of other robots and of
//! objects with the name of these in front (`cup.handle`), these names alone for all of their links
//! (`cup`), and `ground`. A glob means what these names mean, but never the ground, and without a
//! dot no single links of others.

use super::findings::Findings;
use super::initial::{Poses, poses};
use crate::diagnostic::words::likeliest;
use crate::model::{ContactPair, LinkId, Model, RootId, RootKind};
use crate::pattern::Pattern;
use crate::settings::PairSettings;
use crate::tree::{Tree, TreeCollider};
use crate::variables::identifier;
use std::collections::BTreeSet;

/// What stands for the ground.
const GROUND: &str = "ground";

/// Links, none for the ground.
type Side = BTreeSet<Option<LinkId>>;

/// Adds the pairs to the outputs of a model, which is complete but for them.
pub(super) fn select(model: &mut Model, pairs: &[PairSettings], findings: &mut Findings) {
    let mut found = Vec::new();
    if pairs.is_empty() {
        return;
    }
    let meanings = meanings(model);
    let Poses { tree, .. } = poses(model);
    for settings in pairs {
        let name = &settings.name;
        let others = model.outputs.pairs.iter().chain(&found);
        let taken = |other: &&ContactPair| identifier(&other.name) == identifier(&name.text);
        if let Some(other) = others.into_iter().find(taken) {
            let message = format!("a second pair is named '{}'", other.name);
            findings.error("A137", name.place.clone(), message, "give it another name");
            continue;
        }
        let sides = settings
            .sides
            .each_ref()
            .map(|patterns| side(&meanings, patterns, findings));
        let [Some(first), Some(second)] = sides else {
            continue;
        };
        let wrong = both(model, &first, &second).or_else(|| never(model, &tree, &first, &second));
        if let Some((message, help)) = wrong {
            let message = format!("pair '{}': {message}", name.text);
            findings.error("A137", name.place.clone(), message, help);
            continue;
        }
        found.push(ContactPair {
            name: name.text.clone(),
            sides: [first, second].map(|side| side.into_iter().collect()),
        });
    }
    model.outputs.pairs.extend(found);
}

/// What a name means.
pub(super) struct Meaning<'m> {
    pub(super) name: &'m str,
    /// In a sentence.
    pub(super) what: &'static str,
    /// Those with a shape; none for the ground.
    pub(super) links: Vec<Option<LinkId>>,
    /// Whether a glob without a dot may mean it.
    is_own: bool,
}

/// A single link, in a sentence.
const LINK: &str = "a link";

impl Meaning<'_> {
    /// Whether it is a single link.
    pub(super) fn is_link(&self) -> bool {
        self.what == LINK
    }

    /// Whether it is a single link of the robot itself.
    pub(super) fn is_own_link(&self) -> bool {
        self.is_link() && self.is_own
    }

    fn is_meant(&self, pattern: &Pattern) -> bool {
        if pattern.is_glob() {
            self.name != GROUND
                && (self.is_own || pattern.text.contains('.'))
                && pattern.matches(self.name)
        } else {
            pattern.text == self.name
        }
    }
}

/// What stands in the world, in a sentence.
pub(super) fn what(kind: RootKind) -> &'static str {
    match kind {
        RootKind::Robot => "a robot",
        RootKind::Object => "an object",
    }
}

/// Every name that a side may have.
pub(super) fn meanings(model: &Model) -> Vec<Meaning<'_>> {
    let shaped: BTreeSet<LinkId> = model.colliders.iter().map(|c| c.link).collect();
    let links = || (0..).map(LinkId).zip(&model.links);
    let mut meanings: Vec<_> = links()
        .map(|(id, link)| Meaning {
            name: &link.name,
            what: LINK,
            links: shaped
                .contains(&id)
                .then_some(Some(id))
                .into_iter()
                .collect(),
            is_own: model.root_of(link.body) == RootId::ROBOT,
        })
        .collect();
    for (id, root) in (0..).map(RootId).zip(&model.roots).skip(1) {
        let own = links().filter(|(_, link)| model.root_of(link.body) == id);
        meanings.push(Meaning {
            name: &root.name,
            what: what(root.kind),
            links: own
                .filter(|(id, _)| shaped.contains(id))
                .map(|(id, _)| Some(id))
                .collect(),
            is_own: true,
        });
    }
    meanings.push(Meaning {
        name: GROUND,
        what: "the ground",
        links: model.world.ground.iter().map(|_| None).collect(),
        is_own: false,
    });
    meanings
}

/// What is said of a pattern that means nothing, and what helps.
pub(super) fn unknown(meanings: &[Meaning], pattern: &Pattern) -> (String, String) {
    let text = &pattern.text;
    let nearest = likeliest(text, meanings.iter().map(|meaning| meaning.name));
    let help = pattern.help(nearest.map(|name| format!("the nearest is '{name}'")));
    (format!("no link or object matches '{text}'"), help)
}

/// The links of a side; none after an error.
fn side(meanings: &[Meaning], patterns: &[Pattern], findings: &mut Findings) -> Option<Side> {
    let mut side = Side::new();
    let mut complete = true;
    for pattern in patterns {
        let text = &pattern.text;
        let mut error = |code: &'static str, message: String, help: &str| {
            findings.error(code, pattern.place.clone(), message, help);
            complete = false;
        };
        let meant: Vec<&Meaning> = meanings.iter().filter(|m| m.is_meant(pattern)).collect();
        let touching: Vec<&&Meaning> = meant.iter().filter(|m| !m.links.is_empty()).collect();
        match (&meant[..], &touching[..]) {
            ([], _) => {
                let (message, help) = unknown(meanings, pattern);
                error("A101", message, &help);
            }
            (_, [one, other, ..]) if !pattern.is_glob() => {
                let message = format!("'{text}' means {} and {}", one.what, other.what);
                error("A137", message, "rename one of them");
            }
            ([one, ..], []) if one.name == GROUND => {
                let message = "there is no ground that anything could touch".to_owned();
                error(
                    "A102",
                    message,
                    "name something else, or let [world] ground be a plane",
                );
            }
            ([one, ..], []) => {
                let message = format!(
                    "'{}' has no collision shape that can touch anything",
                    one.name
                );
                error("A102", message, "choose another one");
            }
            _ => side.extend(touching.iter().flat_map(|meaning| &meaning.links)),
        }
    }
    complete.then_some(side)
}

/// What is wrong, and what to do about it.
type Wrong = (String, &'static str);

fn called(model: &Model, link: Option<LinkId>) -> String {
    link.map_or_else(
        || "the ground".to_owned(),
        |link| format!("link '{}'", model.links[link.index()].name),
    )
}

/// Whether something is on both sides.
fn both(model: &Model, first: &Side, second: &Side) -> Option<Wrong> {
    let common = *first.intersection(second).next()?;
    let message = format!("{} is on both sides", called(model, common));
    Some((message, "leave it out of one of them"))
}

/// Whether no link of one side can ever touch one of the other.
fn never(model: &Model, tree: &Tree, first: &Side, second: &Side) -> Option<Wrong> {
    let mut why = None;
    for &a in first {
        for &b in second {
            let reason = apart(model, tree, a, b)?;
            why.get_or_insert((a, b, reason));
        }
    }
    let (a, b, (reason, help)) = why?;
    let [a, b] = [a, b].map(|link| called(model, link));
    Some((format!("{a} and {b} never touch: {reason}"), help))
}

/// Why two links never touch; none if they may.
fn apart(
    model: &Model,
    tree: &Tree,
    a: Option<LinkId>,
    b: Option<LinkId>,
) -> Option<(&'static str, &'static str)> {
    let colliders = || tree.contact.colliders.iter().enumerate();
    let of = |link: LinkId| colliders().filter(move |(_, c)| c.link == link.index());
    let moves = |link: LinkId| model.yields(model.links[link.index()].body);
    let still = ("no force can move either of them", "choose others");
    let (Some(a), Some(b)) = (a, b) else {
        let moving = a.or(b).is_some_and(moves);
        return (!moving).then_some(still);
    };
    let may = |(i, _): (usize, &TreeCollider), (j, _): (usize, &TreeCollider)| {
        tree.contact.may_touch([i.min(j), i.max(j)])
    };
    if of(a).any(|x| of(b).any(|y| may(x, y))) {
        return None;
    }
    let [of_a, of_b] = [a, b].map(|link| model.links[link.index()].body);
    let root = model.root_of(of_a);
    Some(if of_a == of_b {
        ("they are one body", "choose others")
    } else if model.apart.contains(&[a.min(b), a.max(b)]) {
        (
            "they are kept apart by [[ignore_contact]] or an SRDF, or overlap at the start",
            "leave them out there, or correct their shapes",
        )
    } else if root != model.root_of(of_b) {
        still
    } else if !model.roots[root.index()].self_collision {
        (
            "links of one robot touch each other only with self_collision",
            "set [robot] self_collision = true",
        )
    } else {
        ("they are neighbours at a joint", "choose others")
    })
}
