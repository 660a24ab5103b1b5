//! Two shapes as they meet.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::point::{ContactPoint, Rim, together};
use crate::geometry::pair::{Nearby, Others, Part, Patch, PatchPoint, Side, Solid};
use crate::kinematics::Kinematics;
use crate::law::normal::Stiffening;
use crate::spatial::{Pose, Vec3, quaternion_normalized, rotation_from_quaternion};
use crate::tree::{Tree, TreeCollider};
use crate::tuning::{LIGHT, NUDGE, STEEPEST, TANGENTIAL_RATIO};

/// Two shapes as they meet: the first one moves, and is pushed along the normal.
pub(super) struct Pair<'a> {
    pub colliders: [&'a TreeCollider; 2],
    solids: [&'a Solid; 2],
    /// Their poses, from O of the first one's tree.
    poses: [Pose; 2],
    /// O of the first one's tree, seen from that of the second one.
    pub from: Vec3,
    tree: &'a Tree,
    kin: &'a Kinematics,
    /// Places of both colliders.
    places: [usize; 2],
}

impl<'a> Pair<'a> {
    pub fn new(tree: &'a Tree, kin: &'a Kinematics, places: [usize; 2]) -> Option<Self> {
        let places = in_order(tree, places);
        let colliders = places.map(|place| &tree.contact.colliders[place]);
        let [Some(first), Some(second)] = colliders.map(|c| c.solid.as_deref()) else {
            return None;
        };
        let from = kin.origins[colliders[0].tree] - kin.origins[colliders[1].tree];
        let poses = colliders.map(|c| kin.X[c.body].compose(&c.X));
        let poses = [
            poses[0],
            Pose {
                p: poses[1].p - from,
                ..poses[1]
            },
        ];
        Some(Self {
            colliders,
            solids: [first, second],
            poses,
            from,
            tree,
            kin,
            places,
        })
    }

    /// Finds what both have in common within `reach`, m.
    pub fn touch(&self, patch: &mut Patch, reach: f64, nearby: Option<&mut Nearby>) -> bool {
        let pair = [0, 1].map(|i| (self.solids[i], &self.poses[i]));
        patch.find_near(pair, Some(self), reach, nearby)
    }

    /// The same, and all that they have in common beyond `reach` once anything is near; tells
    /// whether [`Patch::limit`] makes what [`Self::touch`] finds of it for any reach.
    pub fn touch_whole(&self, patch: &mut Patch, reach: f64) -> bool {
        let pair = [0, 1].map(|i| (self.solids[i], &self.poses[i]));
        patch.find_whole(pair, Some(self), reach)
    }

    /// O of the first one's tree in the world.
    fn origin(&self) -> Vec3 {
        self.kin.origins[self.colliders[0].tree]
    }

    /// Whether `is` says yes of any other shape that may touch the one at the place `above` and
    /// comes near a ball; with where it stands, from O of the first one's tree.
    fn any_near(
        &self,
        [beside, above]: [usize; 2],
        (center, radius): (&Vec3, f64),
        is: &mut dyn FnMut(&TreeCollider, &Solid, &Pose) -> bool,
    ) -> bool {
        let Self { tree, kin, .. } = self;
        let origin = self.origin();
        let mut stands = |place: usize| {
            let other = &tree.contact.colliders[place];
            let pair = [place.min(above), place.max(above)];
            let Some(solid) = other.solid.as_deref() else {
                return false;
            };
            if place == beside || !tree.contact.may_touch(pair) {
                return false;
            }
            let (X, from) = (&kin.X[other.body], kin.origins[other.tree] - origin);
            let p = X.point(&other.X.p) + from;
            let R = X.R * other.X.R;
            let near = (p - center).norm() <= radius + other.radius;
            near && is(other, solid, &Pose { R, p })
        };
        let there = center + origin;
        let range = [there.x - radius, there.x + radius];
        let still = tree.contact.scenery.within(range);
        let mut near = still.filter(|still| still.is_near(&there, radius));
        tree.worked_movers().any(|(place, _)| stands(place))
            || near.any(|still| stands(still.place))
    }

    /// Their poses, from O of the first one's tree.
    pub fn poses(&self) -> &[Pose; 2] {
        &self.poses
    }

    /// Whether they are certainly farther apart than `reach`, m, along a direction that is given in
    /// the axes of the first one, see [`Patch::are_apart`].
    pub fn is_apart_along(&self, direction: &Vec3, reach: f64) -> bool {
        let [a, b] = [0, 1].map(|i| (self.solids[i], &self.poses[i]));
        Patch::are_apart(a, b, reach, &(self.poses[0].R * direction))
    }

    /// A direction in the axes of the first one.
    pub fn seen_from_first(&self, direction: &Vec3) -> Vec3 {
        self.poses[0].R.tr_mul(direction)
    }

    /// Depth, m, and how much it grows where all points sink by one unit; 0 where nothing is
    /// inside. Not of terrain, where several parts may touch.
    fn depth(&self, patch: &mut Patch) -> (f64, f64) {
        self.touch(patch, 0.0, None);
        together(patch.points().iter().map(|p| (p.depth, p.share)))
    }

    /// How the depth grows with displacements of the first one along the axes, and with rotations,
    /// m, about `center`, in shares of how it grows where all points sink. By differences; none of
    /// shapes that are too thin for these, or whose depth jumps there: that of shapes whose inner
    /// cores meet may, and a jump over a nudge would be a slope of thousands. A light touch is
    /// looked at as if it were so deep that no nudge ends it.
    ///
    /// - `normal`, `depth`: as they touch, m
    pub fn gradient(
        &self,
        patch: &mut Patch,
        center: &Vec3,
        (normal, depth): (&Vec3, f64),
    ) -> Option<[Vec3; 2]> {
        let by = NUDGE * self.thickness();
        let lever = self.colliders[0].radius.min(self.colliders[1].radius);
        let sunk = normal * (depth - LIGHT * by).min(0.0);
        let (here, weights) = self.moved([sunk, Vec3::zeros()], center).depth(patch);
        let mut slopes = [Vec3::zeros(); 2];
        for (kind, by) in [(0, by), (1, by / lever)] {
            for axis in 0..3 {
                let mut ways = [sunk, Vec3::zeros()];
                ways[kind][axis] += by;
                let (there, _) = self.moved(ways, center).depth(patch);
                slopes[kind][axis] = (there - here) / (by * weights);
            }
        }
        // What is not a number is not less, either.
        let smooth = |(slope, lever): (&Vec3, f64)| slope.norm() < STEEPEST * lever;
        let all = slopes.iter().zip([1.0, lever]).all(smooth);
        all.then_some(slopes)
    }

    /// The same after the first one has moved by `way` and turned by the rotation vector `turn`
    /// about `center`, both small.
    fn moved(&self, [way, turn]: [Vec3; 2], center: &Vec3) -> Self {
        let half = turn * 0.5;
        let R = rotation_from_quaternion(&quaternion_normalized(&[1.0, half.x, half.y, half.z]));
        let X = &self.poses[0];
        let moved = Pose {
            R: R * X.R,
            p: center + R * (X.p - center) + way,
        };
        Self {
            poses: [moved, self.poses[1]],
            ..*self
        }
    }

    /// Whether the row of their contact is the gradient of its depth as it is, as long as no inner
    /// core takes part.
    pub fn touches_in_a_point(&self) -> bool {
        self.solids.iter().any(|solid| solid.is_ball())
    }

    /// Whether the second one is terrain.
    pub fn is_on_terrain(&self) -> bool {
        self.solids[1].is_terrain()
    }

    /// Whether they are nearer than `reach`, m.
    pub fn is_near(&self, reach: f64) -> bool {
        let [a, b] = [0, 1].map(|i| (self.solids[i], &self.poses[i]));
        Patch::are_near(a, b, reach)
    }

    /// How fast any two of their points come nearer, at most, m/s.
    pub fn speed(&self, kin: &Kinematics) -> f64 {
        self.colliders.iter().map(|c| kin.ball(c).1).sum()
    }

    /// Mass that takes part in an impact of both, kg: see [`super::Contact::mass`].
    pub fn mass(&self, tree: &Tree) -> f64 {
        mass_of(tree, self.colliders)
    }

    /// See [`super::Contact::thickness`].
    pub fn thickness(&self) -> f64 {
        thickness_of(self.solids)
    }

    /// The one whose contact is made for the greater weight.
    fn heavier(&self, tree: &Tree) -> &TreeCollider {
        heavier_of(tree, self.colliders)
    }

    /// Spring of its contact.
    pub fn spring(&self, tree: &Tree) -> Stiffening {
        self.heavier(tree).spring
    }

    /// Adds the points of a part of a patch, from O of the first one's tree.
    pub fn add_points(
        &self,
        tree: &Tree,
        (patch, part): (&Patch, &Part),
        points: &mut Vec<ContactPoint>,
    ) {
        let landing = self.heavier(tree).spring.reference;
        let found = patch.points()[part.points.clone()].iter();
        points.extend(found.map(|point| contact_point(point, landing)));
    }
}

/// See [`Pair::thickness`].
fn thickness_of([a, b]: [&Solid; 2]) -> f64 {
    if b.is_endless() {
        // There is no other side.
        f64::INFINITY
    } else if b.is_terrain() {
        a.thickness()
    } else if a.is_ball() || b.is_ball() {
        0.5 * (a.thickness() + b.thickness())
    } else {
        a.thickness().min(b.thickness())
    }
}

/// Whether there are shapes that could pass each other, and have another side where nothing would
/// be felt of it.
pub fn can_pass(tree: &Tree) -> bool {
    let places = 0..tree.contact.colliders.len();
    places.clone().any(|a| {
        places.clone().skip(a + 1).any(|b| {
            let solids = ordered(tree, [a, b]).map(|c| c.solid.as_deref());
            let [Some(first), Some(second)] = solids else {
                return false;
            };
            tree.contact.may_touch([a, b]) && thickness_of([first, second]) < f64::INFINITY
        })
    })
}

/// The places of two shapes as they meet: the first one yields.
fn in_order(tree: &Tree, [a, b]: [usize; 2]) -> [usize; 2] {
    if tree.contact.colliders[b].yields {
        [b, a]
    } else {
        [a, b]
    }
}

/// The shapes at two places as they meet.
fn ordered(tree: &Tree, places: [usize; 2]) -> [&TreeCollider; 2] {
    in_order(tree, places).map(|place| &tree.contact.colliders[place])
}

impl Others for Pair<'_> {
    fn any(
        &self,
        first: bool,
        ball: (&Vec3, f64),
        is: &mut dyn FnMut(&Solid, &Pose, bool) -> bool,
    ) -> bool {
        let [beside, above] = [usize::from(!first), usize::from(first)].map(|i| self.places[i]);
        let own = &self.tree.contact.colliders[beside];
        let stays = |other: &TreeCollider| own.body == other.body || !own.moves && !other.moves;
        let mut is_beside =
            |other: &TreeCollider, solid: &Solid, X: &Pose| is(solid, X, stays(other));
        if self.any_near([beside, above], ball, &mut is_beside) {
            return true;
        }
        let ground = self.tree.contact.ground_solid.as_deref();
        ground.is_some_and(|ground| {
            let there = Pose {
                p: -self.origin(),
                ..Pose::IDENTITY
            };
            is(ground, &there, !own.moves)
        })
    }

    fn carries(&self) -> bool {
        !self.colliders[1].yields && !self.is_on_terrain()
    }

    fn any_that_carries(
        &self,
        ball: (&Vec3, f64),
        is: &mut dyn FnMut(&Solid, &Pose) -> bool,
    ) -> bool {
        let [above, beside] = self.places;
        let mut carries =
            |other: &TreeCollider, solid: &Solid, X: &Pose| !other.yields && is(solid, X);
        self.any_near([beside, above], ball, &mut carries)
    }

    fn level(&self) -> f64 {
        self.spring(self.tree).reference
    }
}

/// See [`Pair::mass`].
fn mass_of(tree: &Tree, colliders: [&TreeCollider; 2]) -> f64 {
    let [a, b] = colliders.map(|c| tree.mass_in_impact(c.body));
    if colliders[1].yields {
        a * b / (a + b)
    } else {
        a
    }
}

/// See [`Pair::heavier`].
fn heavier_of<'a>(tree: &Tree, [a, b]: [&'a TreeCollider; 2]) -> &'a TreeCollider {
    let mass = |c: &TreeCollider| tree.mass_with(c.body);
    if b.moves && mass(b) > mass(a) { b } else { a }
}

/// How fast the friction of a contact forgets while nothing presses, 1/s: one over its own time
/// `d/k` at the depth 0. `places`: of its shapes, the lower one first; twice the same with the
/// ground.
pub fn light_touch(tree: &Tree, places: [usize; 2]) -> f64 {
    let colliders = ordered(tree, places);
    let (spring, mass) = if places[0] == places[1] {
        (&colliders[0].spring, tree.mass_in_impact(colliders[0].body))
    } else {
        (
            &heavier_of(tree, colliders).spring,
            mass_of(tree, colliders),
        )
    };
    // `d = 2 √(k m)`
    0.5 * (TANGENTIAL_RATIO * spring.slope(0.0) / mass).sqrt()
}

/// A point of a patch, from O of the first one's tree, as a contact has it; `landing` as in
/// [`Rim::new`].
fn contact_point(point: &PatchPoint, landing: f64) -> ContactPoint {
    let PatchPoint {
        x,
        normal,
        depth,
        share,
        ..
    } = *point;
    ContactPoint {
        rim: point.rim.map(|rim| {
            // What turns the second body one way tilts its rim as turning the first one the other
            // way does.
            let axis = match rim.side {
                Side::First => rim.axis,
                Side::Second => -rim.axis,
            };
            Rim::new(axis, rim.a, [rim.radius, rim.crown, landing])
        }),
        ..ContactPoint::new(None, x, &normal, [depth, share])
    }
}

#[cfg(test)]
mod tests;
