//! Contacts of shapes with each other.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Other, normal_part};
use super::gather::ContactSet;
use super::meeting::Meeting;
use super::memory::{Touch, seek};
use super::pair::Pair;
use super::point::norm;
use crate::geometry::pair::Patch;
use crate::kinematics::Kinematics;
use crate::spatial::Vec3;
use crate::tree::Tree;

/// Adds the contacts between shapes that can act within `h` seconds, after those with the ground;
/// parameters are those of [`super::detect`].
pub(super) fn find_pairs(
    tree: &Tree,
    touches: &[Touch],
    kin: &Kinematics,
    [h, margin]: [f64; 2],
    contacts: &mut ContactSet,
) {
    let ContactSet {
        list,
        points,
        pairs,
        ..
    } = contacts;
    let mut touches = touches.iter().peekable();
    let add = |slot: usize, pair: &Pair, patch: &mut Patch, part: usize| {
        let first = points.len();
        let part = patch.parts()[part].clone();
        pair.add_points(tree, (patch, &part), points);
        let [a, b] = pair.colliders;
        let stored = seek(&mut touches, slot, |t| t.slot);
        let stored = stored.copied().unwrap_or_default();
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
            mass: pair.mass(tree) * patch.share,
            normal: part.normal,
            uneven: part.uneven,
            points: first..points.len(),
            spring: pair.spring(tree).part(patch.share),
            ..Contact::default()
        };
        contact.gather(points, &kin.V, h);
        let surface = tree.contact.surface_of([a, b]);
        // What bounces loses nothing in which an error of its rows would be lost, too.
        let bounces = surface.restitution > 0.0 && !part.uneven;
        // On terrain the rows of even parts are the gradient as they are, and other parts may come
        // and go over a nudge.
        let exact = patch.blended || bounces && !pair.touches_in_a_point();
        if exact
            && !pair.is_on_terrain()
            && contact.depth > 0.0
            && let place = (&part.normal, contact.depth)
            && let Some(gradient) = pair.gradient(patch, &contact.center, place)
        {
            contact.lean(points, gradient);
        }
        if b.belt != Vec3::zeros() {
            let (_, along) = normal_part(&contact.normal, &b.belt);
            contact.carried = -along;
        }
        let meeting = Meeting {
            surface: &surface,
            dissipation: a.dissipation.max(b.dissipation),
            gravity: if b.yields {
                0.0
            } else {
                -contact.normal.dot(&tree.world.gravity)
            },
        };
        meeting.complete(tree, &stored, (kin, points), h, &mut contact);
        list.push(contact);
        false
    };
    pairs.each((tree, kin), ([h, margin], false), |_| false, add);
}

/// Energy that the springs between shapes hold at the poses of `kin`, J; adds their depths.
///
/// - `contacts`: its points are scratch, its depths are added
pub(super) fn held_between(tree: &Tree, kin: &Kinematics, contacts: &mut ContactSet) -> f64 {
    let ContactSet {
        points,
        pairs,
        depths,
        ..
    } = contacts;
    let mut sum = 0.0;
    let add = |slot: usize, pair: &Pair, patch: &mut Patch, part: usize| {
        points.clear();
        pair.add_points(tree, (patch, &patch.parts()[part]), points);
        let (depth, _) = norm(points, 0.0);
        depths.push((slot, depth));
        sum += pair.spring(tree).part(patch.share).stored(depth);
        false
    };
    pairs.each((tree, kin), ([0.0, 0.0], true), |_| false, add);
    sum
}
