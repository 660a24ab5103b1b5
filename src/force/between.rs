//! Contacts of shapes with each other.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Other};
use super::gather::ContactSet;
use super::meeting::{Meeting, limited};
use super::memory::{Touch, seek};
use super::pairs::{Pair, contact_point};
use super::point::norm;
use crate::kinematics::Kinematics;
use crate::tree::{Surface, Tree};

/// Adds the contacts between shapes that can act within `h` seconds, after those with the ground;
/// parameters are those of [`super::detect`].
pub(super) fn find_pairs(
    tree: &Tree,
    touches: &[Touch],
    kin: &Kinematics,
    [h, margin]: [f64; 2],
    fastest: f64,
    contacts: &mut ContactSet,
) {
    let ContactSet {
        list,
        points,
        pairs,
    } = contacts;
    let Some(mut patch) = pairs.patch.take() else {
        return;
    };
    pairs.search(tree, kin, [h, margin]);
    let mut touches = touches.iter().peekable();
    for &places in &pairs.near {
        let Some(pair) = Pair::new(tree, kin, places) else {
            continue;
        };
        let [a, b] = pair.colliders;
        let landing = pair.heavier(tree).spring.reference;
        let reach = h * pair.speed(kin) + margin;
        if list.len() == list.capacity() || !pair.touch(&mut patch, reach) {
            continue;
        }
        let first = points.len();
        let found = patch.points();
        if first + found.len() > points.capacity() {
            continue;
        }
        for point in found {
            points.push(contact_point(point, &patch.normal, landing));
        }
        let slot = tree.contact.slot(places);
        let stored = seek(&mut touches, slot, |t| t.slot);
        let stored = stored.copied().unwrap_or_default();
        let mass = pair.mass(tree);
        let other = b.moves.then(|| Other {
            body: b.body,
            from: pair.from,
            axes: kin.X[b.body].R,
        });
        let mut contact = Contact {
            body: a.body,
            other,
            link: a.link,
            other_link: Some(b.link),
            slot,
            thickness: pair.thickness(),
            mass,
            normal: patch.normal,
            points: first..points.len(),
            spring: limited(&pair.heavier(tree).spring, mass, fastest),
            ..Contact::default()
        };
        contact.gather(points);
        let mut surface = Surface::default();
        surface.combine([&a.own, &b.own], tree.contact.combination);
        let meeting = Meeting {
            surface: &surface,
            dissipation: a.dissipation.max(b.dissipation),
            gravity: if b.moves {
                0.0
            } else {
                -contact.normal.dot(&tree.world.gravity)
            },
        };
        meeting.complete(tree, &stored, (kin, points), &mut contact);
        list.push(contact);
    }
    pairs.patch = Some(patch);
}

/// Energy that the springs between shapes hold at the poses of `kin`, J.
///
/// - `contacts`: its points are scratch
pub(super) fn held_between(
    tree: &Tree,
    kin: &Kinematics,
    fastest: f64,
    contacts: &mut ContactSet,
) -> f64 {
    let ContactSet { points, pairs, .. } = contacts;
    let Some(mut patch) = pairs.patch.take() else {
        return 0.0;
    };
    pairs.search(tree, kin, [0.0, 0.0]);
    let mut sum = 0.0;
    for &places in &pairs.near {
        let Some(pair) = Pair::new(tree, kin, places) else {
            continue;
        };
        if !pair.touch(&mut patch, 0.0) {
            continue;
        }
        points.clear();
        let landing = pair.heavier(tree).spring.reference;
        for point in patch.points() {
            points.push(contact_point(point, &patch.normal, landing));
        }
        let (depth, _) = norm(points);
        let spring = limited(&pair.heavier(tree).spring, pair.mass(tree), fastest);
        sum += spring.stored(depth);
    }
    pairs.patch = Some(patch);
    sum
}
