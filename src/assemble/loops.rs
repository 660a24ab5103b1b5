//! Loops and springs: from names to links and joints, and the initial pose that closes the loops.
//!
//! Names are those of the whole world, see [`super::pairs`]; `world` is the world itself, and the
//! name of a robot or an object its base link.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::{Findings, listed};
use super::pairs::what;
use super::robot::{is_scalar, kind_name};
use crate::diagnostic::Place;
use crate::diagnostic::words::likeliest;
use crate::model::{Anchor, JointId, LinkId, Loop, LoopKind, Model, Share, Spring};
use crate::pattern::Pattern;
use crate::settings::{LoopChoice, LoopSettings, Settings, SpringSettings};
use crate::spatial::{Pose, Vec3, rotation_from_rpy, rotation_to_axis};
use crate::urdf::{ClosureDescriptionKind, Description};
use crate::variables::identifier;

/// What stands for the world.
const WORLD: &str = "world";

/// What a note about positions tells in its six decimals, m or rad.
const SHOWN: f64 = 5e-7;

/// Where each loop of a model was asked for.
pub(super) type Places = Vec<Option<Place>>;

/// Adds the loops and springs that the robot's own file has; links and joints are there.
pub(super) fn of_file(
    model: &mut Model,
    description: &Description,
    findings: &mut Findings,
) -> Places {
    let mut places = Vec::new();
    for part in &description.closures {
        let place = findings.tag(&part.tag);
        let name = unique(model, &part.name);
        let link = |name: &String| {
            let found = model.links.iter().position(|link| link.name == *name);
            found.map(LinkId::from)
        };
        let ends = |links: &[String; 2], X: &[Pose; 2]| -> Option<[Anchor; 2]> {
            let end = |i: usize| {
                let world = links[i] == WORLD && link(&links[i]).is_none();
                let link = if world { None } else { Some(link(&links[i])?) };
                Some(Anchor { link, X_LA: X[i] })
            };
            Some([end(0)?, end(1)?])
        };
        let kind = match &part.kind {
            ClosureDescriptionKind::Weld { links, X } => ends(links, X).map(LoopKind::Weld),
            ClosureDescriptionKind::Ball { links, X } => ends(links, X).map(LoopKind::Ball),
            ClosureDescriptionKind::Hinge { links, X } => ends(links, X).map(LoopKind::Hinge),
            ClosureDescriptionKind::Coupler { joints, sum } => {
                let share = |(name, factor): &(String, f64)| {
                    let joint = model.joints.iter().position(|joint| joint.name == *name)?;
                    let joint = JointId::from(joint);
                    model.scalar_body(joint)?;
                    Some(Share {
                        joint,
                        factor: *factor,
                    })
                };
                let terms: Option<Vec<Share>> = joints.iter().map(share).collect();
                terms.map(|terms| LoopKind::Coupler { terms, sum: *sum })
            }
            ClosureDescriptionKind::Spring {
                links,
                X,
                length,
                stiffness,
                damping,
            } => {
                if let Some(ends) = ends(links, X) {
                    model.springs.push(Spring {
                        name,
                        ends,
                        length: *length,
                        stiffness: *stiffness,
                        damping: *damping,
                        shown: false,
                    });
                }
                continue;
            }
        };
        let Some(kind) = kind else {
            let message = format!(
                "loop '{}' names a link or a joint that is not there",
                part.name
            );
            findings.error("A140", place, message, "correct the name");
            continue;
        };
        if let Some(wrong) = welded(model, &kind) {
            let message = format!("loop '{}' joins {wrong}", part.name);
            findings.error("A140", place, message, "leave it out");
            continue;
        }
        model.loops.push(Loop {
            name,
            kind,
            shown: false,
        });
        places.push(place);
    }
    places
}

/// A name that no other loop or spring has.
fn unique(model: &Model, name: &str) -> String {
    let taken = |name: &str| {
        let loops = model.loops.iter().map(|part| &part.name);
        let mut names = loops.chain(model.springs.iter().map(|part| &part.name));
        names.any(|other| identifier(other) == identifier(name))
    };
    if !taken(name) {
        return name.to_owned();
    }
    let numbered = (2..).map(|i| format!("{name}_{i}"));
    numbered
        .into_iter()
        .find(|name| !taken(name))
        .unwrap_or_default()
}

/// What a loop joins that no force moves against each other; none if one does.
fn welded(model: &Model, kind: &LoopKind) -> Option<String> {
    let ends = kind.ends()?;
    let bodies = ends.each_ref().map(|end| {
        let body = model.links[end.link?.index()].body;
        model.yields(body).then_some(body)
    });
    let called = |end: &Anchor| {
        end.link.map_or_else(
            || "the world".to_owned(),
            |link| format!("link '{}'", model.links[link.index()].name),
        )
    };
    let [a, b] = ends.each_ref().map(called);
    (bodies[0] == bodies[1])
        .then(|| format!("{a} and {b}, which no force can move against each other"))
}

/// Adds the loops and springs of the settings to a model, which is complete but for them, and
/// selects those that have outputs.
pub(super) fn select(
    model: &mut Model,
    settings: &Settings,
    places: &mut Places,
    findings: &mut Findings,
) {
    places.resize(model.loops.len(), None);
    for (number, part) in (1..).zip(&settings.loops) {
        let name = name(
            model,
            part.name.as_ref(),
            &format!("loop{number}"),
            findings,
        );
        if let Some(kind) = kind(model, part, findings) {
            if let Some(wrong) = welded(model, &kind) {
                let message = format!("loop '{name}' joins {wrong}");
                let help = "name two links that joints let move against each other";
                findings.error("A140", part.place.clone(), message, help);
                continue;
            }
            model.loops.push(Loop {
                name,
                kind,
                shown: false,
            });
            places.push(part.place.clone());
        }
    }
    for (number, part) in (1..).zip(&settings.springs) {
        let name = name(
            model,
            part.name.as_ref(),
            &format!("spring{number}"),
            findings,
        );
        if let Some(spring) = spring(model, name, part, findings) {
            model.springs.push(spring);
        }
    }
    let names: Vec<String> = model.loops.iter().map(|part| part.name.clone()).collect();
    for index in chosen("loop", &settings.closure_outputs[0], &names, findings) {
        model.loops[index].shown = true;
    }
    let names: Vec<String> = model.springs.iter().map(|part| part.name.clone()).collect();
    for index in chosen("spring", &settings.closure_outputs[1], &names, findings) {
        model.springs[index].shown = true;
    }
}

fn chosen(
    what: &str,
    patterns: &[Pattern],
    names: &[String],
    findings: &mut Findings,
) -> Vec<usize> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let patterns = patterns.iter();
    patterns
        .flat_map(|pattern| findings.select(pattern, what, &names, |_| None))
        .collect()
}

/// Its name, or `default`; an error where another one has it.
fn name(model: &Model, given: Option<&Pattern>, default: &str, findings: &mut Findings) -> String {
    let Some(given) = given else {
        return unique(model, default);
    };
    let found = unique(model, &given.text);
    if found != given.text {
        let message = format!("a second loop or spring is named '{}'", given.text);
        findings.error("A140", given.place.clone(), message, "give it another name");
    }
    found
}

/// An error that has been reported.
struct Reported;

/// The link that a name means, none for the world.
fn link(
    model: &Model,
    pattern: &Pattern,
    findings: &mut Findings,
) -> Result<Option<LinkId>, Reported> {
    let text = &pattern.text;
    let link = model.links.iter().position(|link| link.name == *text);
    let root = model.roots.iter().skip(1).find(|root| root.name == *text);
    if let (Some(_), Some(root)) = (link, root) {
        let message = format!("'{text}' means a link and {}", what(root.kind));
        findings.error("A140", pattern.place.clone(), message, "rename one of them");
        return Err(Reported);
    }
    if let Some(link) = link {
        return Ok(Some(link.into()));
    }
    if let Some(root) = root {
        return Ok(Some(model.bodies[root.body.index()].link));
    }
    if text == WORLD {
        return Ok(None);
    }
    let names = model.links.iter().map(|link| link.name.as_str());
    let help = likeliest(text, names.chain([WORLD]))
        .map_or_else(String::new, |name| format!("the nearest is '{name}'"));
    let message = format!("no link is named '{text}'");
    findings.error("A101", pattern.place.clone(), message, &help);
    Err(Reported)
}

fn anchors(
    model: &Model,
    links: &[Pattern; 2],
    X: [Pose; 2],
    findings: &mut Findings,
) -> Option<[Anchor; 2]> {
    let found = links.each_ref().map(|name| link(model, name, findings));
    let [Ok(a), Ok(b)] = found else {
        return None;
    };
    let [X_a, X_b] = X;
    Some([Anchor { link: a, X_LA: X_a }, Anchor { link: b, X_LA: X_b }])
}

/// Frames at two points.
fn at(origins: &[Vec3; 2]) -> [Pose; 2] {
    origins.map(|p| Pose {
        p,
        ..Pose::IDENTITY
    })
}

/// What a loop of the settings holds; none after an error.
fn kind(model: &Model, part: &LoopSettings, findings: &mut Findings) -> Option<LoopKind> {
    Some(match &part.kind {
        LoopChoice::Weld {
            links,
            origins,
            rpy,
        } => {
            let mut X = at(origins);
            for (X, rpy) in X.iter_mut().zip(rpy) {
                X.R = rotation_from_rpy(rpy);
            }
            LoopKind::Weld(anchors(model, links, X, findings)?)
        }
        LoopChoice::Ball { links, origins } => {
            LoopKind::Ball(anchors(model, links, at(origins), findings)?)
        }
        LoopChoice::Hinge {
            links,
            origins,
            axes,
        } => {
            let mut X = at(origins);
            for (X, axis) in X.iter_mut().zip(axes) {
                X.R = rotation_to_axis(&axis.normalize());
            }
            LoopKind::Hinge(anchors(model, links, X, findings)?)
        }
        LoopChoice::Distance {
            links,
            origins,
            length,
        } => {
            let ends = anchors(model, links, at(origins), findings)?;
            let length = length.unwrap_or_else(|| apart(model, &ends));
            if length <= 0.0 {
                let message = "the points are at one place: they have no distance".to_owned();
                let help = "take a loop of type \"ball\", or give a length";
                findings.error("A140", part.place.clone(), message, help);
                return None;
            }
            LoopKind::Distance { ends, length }
        }
        LoopChoice::Coupler { terms, sum } => {
            let names: Vec<&str> = model.joints.iter().map(|j| j.name.as_str()).collect();
            let unsuitable = |j: usize| {
                let kind = model.joints[j].kind;
                (!is_scalar(kind)).then(|| {
                    format!(
                        "{}: only turning and sliding joints are coupled",
                        kind_name(kind)
                    )
                })
            };
            let mut shares: Vec<Share> = Vec::new();
            let mut again = false;
            for (pattern, factor) in terms {
                for j in findings.select(pattern, "joint", &names, unsuitable) {
                    let joint = JointId::from(j);
                    if shares.iter().any(|share| share.joint == joint) {
                        let message = format!("joint '{}' stands twice in the loop", names[j]);
                        let help = "name joints that move against each other, each of them once";
                        findings.error("A140", pattern.place.clone(), message, help);
                        again = true;
                    }
                    let factor = *factor;
                    shares.push(Share { joint, factor });
                }
            }
            if again || shares.len() < terms.len() {
                return None;
            }
            LoopKind::Coupler {
                terms: shares,
                sum: *sum,
            }
        }
    })
}

fn spring(
    model: &Model,
    name: String,
    part: &SpringSettings,
    findings: &mut Findings,
) -> Option<Spring> {
    let ends = anchors(model, &part.links, at(&part.origins), findings)?;
    if let Some(wrong) = welded(model, &LoopKind::Ball(ends.clone())) {
        let message = format!("spring '{name}' joins {wrong}");
        findings.error("A140", part.place.clone(), message, "name two other links");
        return None;
    }
    let pushes = part.stiffness > 0.0 && part.length > 0.0;
    if pushes && apart(model, &ends) <= 0.0 {
        let message = format!(
            "the two points of spring '{name}' are one at the start: it has no direction there, and \
             no force until something else parts them"
        );
        let help = "set origins that are apart, or leave its length out";
        findings.warning("A140", part.place.clone(), message, help);
    }
    Some(Spring {
        name,
        ends,
        length: part.length,
        stiffness: part.stiffness,
        damping: part.damping,
        shown: false,
    })
}

/// Distance of two points at the start, m.
fn apart(model: &Model, ends: &[Anchor; 2]) -> f64 {
    let poses = super::initial::poses(model);
    let [a, b] = ends.each_ref().map(|end| {
        let Some(link) = end.link else {
            return end.X_LA.p;
        };
        let body = model.links[link.index()].body.index();
        poses.link(model, link).point(&end.X_LA.p) + poses.kin.origin(&poses.tree, body)
    });
    (a - b).norm()
}

/// Moves the initial pose until all loops are closed, and says how far.
///
/// - `held`: joints whose positions, or velocities, have been given
/// - `tells`: whether what has moved is worth a note
pub(super) fn close(
    model: &mut Model,
    held: &[Vec<bool>; 2],
    (places, tells): (&Places, bool),
    findings: &mut Findings,
) {
    if model.loops.is_empty() {
        return;
    }
    let before = model.initial.joint_positions.clone();
    let bases: Vec<Vec3> = model.roots.iter().map(|root| root.position).collect();
    if let Some((index, gap)) = crate::initial::close_model(model, held) {
        let part = &model.loops[index];
        let holds_links = part.kind.ends().is_some();
        let (left, correct) = if holds_links {
            // Not "-0".
            let left = format!("{:.3e} m and {:.3e} rad", gap.distance, gap.angle.abs());
            (left, "its origins")
        } else {
            (format!("{:.3e}", gap.distance), "its factors and its sum")
        };
        let message = format!("loop '{}' cannot be closed: {left} are left", part.name);
        let help = format!(
            "correct {correct}, or let the robot start nearer to a closed pose ([initial] joints)"
        );
        let place = places.get(index).cloned().flatten();
        findings.error("A141", place, message, &help);
        return;
    }
    if !tells {
        return;
    }
    for (index, share) in crate::initial::idle_loops(model) {
        let (name, place) = (&model.loops[index].name, places.get(index));
        let what = if share > 0.0 {
            "nearly nothing: joints open it by less than a millionth of their way, and it holds \
             them still by great forces"
        } else {
            "nothing: no motion of the joints opens it"
        };
        let message = format!("loop '{name}' holds {what}");
        let help = "leave it out, or correct its origins and axes";
        findings.warning("A140", place.cloned().flatten(), message, help);
    }
    let joints = model.joints.iter().zip(&before);
    let moved = joints.zip(&model.initial.joint_positions);
    let moved = moved.filter(|((_, from), to)| (*to - *from).abs() > SHOWN);
    let mut moved: Vec<String> = moved
        .map(|((joint, from), to)| {
            let [from, to] = [from, to].map(|x| if x.abs() > SHOWN { *x } else { 0.0 });
            format!("{} from {from:.6} to {to:.6}", joint.name)
        })
        .collect();
    for (root, from) in model.roots.iter().zip(bases) {
        let way = (root.position - from).norm();
        if way > SHOWN {
            let name = if root.name.is_empty() {
                "base"
            } else {
                &root.name
            };
            moved.push(format!("{name} by {way:.6} m"));
        }
    }
    if !moved.is_empty() {
        let message = format!(
            "closing the loops has moved {}",
            listed(&moved).replace('\'', "")
        );
        let help = "these are the initial values; set [initial] joints to start elsewhere";
        findings.note("A141", message, help);
    }
}

/// Joints whose positions, and whose velocities, the settings give.
pub(super) fn given(model: &Model, settings: &Settings, prefix: &str) -> [Vec<bool>; 2] {
    let initial = &settings.initial;
    let positions: Vec<_> = initial.joints.iter().chain(&initial.state).collect();
    let velocities: Vec<_> = initial.joint_velocities.iter().collect();
    [positions, velocities].map(|patterns| {
        let is_given = |name: &str| {
            let own = name.strip_prefix(prefix);
            own.is_some_and(|own| patterns.iter().any(|(pattern, _)| pattern.matches(own)))
        };
        let joints = model.joints.iter();
        joints.map(|joint| is_given(&joint.name)).collect()
    })
}
