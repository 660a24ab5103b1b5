//! Finds the chains along which momentum is kept, see [`super::kept`].

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::closure::{End, TreeSpring};
use super::kept::{Kept, Space};
use super::parts::{Tree, TreeBody};
use crate::joint::Kind;
use crate::model::Model;
use crate::spatial::{Pose, Vec3, Vec6, join};

impl Tree {
    /// Whether a joint of a chain is at its limit or beyond.
    pub fn is_limited(&self, kept: &Kept, q: &[f64]) -> bool {
        let mut places = kept.columns().iter().zip(kept.places);
        places.any(|(column, place)| {
            let limits = self.dofs.limits[self.dof[*column]];
            limits.is_some_and(|l| q[place] <= l.lower || q[place] >= l.upper)
        })
    }

    /// Finds all chains along which momentum is kept, those beyond others first, and by which of
    /// them each body is moved.
    pub(super) fn find_kept(&mut self, model: &Model) {
        self.kept.clear();
        let twists = self.twists();
        for b in (0..self.bodies.len()).rev() {
            if let Some(kept) = self.longest_kept(model, &twists, b) {
                self.kept.push(kept);
            }
        }
        // Parents before children, those of kept momentum the other way round.
        let mut next = self.kept.len();
        for (b, body) in self.bodies.iter().enumerate() {
            let before = (!body.kind.is_base()).then(|| self.carrier[body.parent]);
            let mut carrier = before.flatten();
            if next > 0 && self.kept[next - 1].body == b {
                next -= 1;
                self.kept[next].outer = carrier;
                if let Some(outer) = carrier {
                    self.kept[outer].inner = true;
                }
                carrier = Some(next);
            }
            self.carrier[b] = carrier;
        }
    }

    /// The longest chain that ends with the body `last`, of joints that belong to no other one.
    fn longest_kept(&self, model: &Model, twists: &[[Vec6; 6]], last: usize) -> Option<Kept> {
        let mut found = None;
        let (mut first, mut count) = (last, 0);
        loop {
            let body = &self.bodies[first];
            let columns = body.column..body.column + body.columns;
            let found_yet = self.kept.iter().rev().take_while(|k| k.tree == body.tree);
            let taken = |c| found_yet.clone().any(|kept| kept.columns().contains(&c));
            count += columns.len();
            let free = columns
                .clone()
                .all(|c| self.is_left_alone(model, c) && !taken(c));
            if columns.is_empty() || count > 6 || !free || self.is_held(first) {
                return found;
            }
            found = self.chain(twists, first, last).or(found);
            let parent = body.parent;
            if body.kind.is_base() || !self.only_passes_on(parent, first) {
                return found;
            }
            first = parent;
        }
    }

    /// Whether nothing acts along a column of `S` by itself, but limits.
    fn is_left_alone(&self, model: &Model, column: usize) -> bool {
        let (dof, dofs) = (self.dof[column], &self.dofs);
        dofs.armature[dof] <= 0.0
            && dofs.damping[dof] <= 0.0
            && dofs.friction[dof].at_rest <= 0.0
            && dofs.speed_limit[dof].is_infinite()
            && !model.actuators.iter().any(|a| a.dof.index() == dof)
            && !self.closures.iter().any(|c| c.dofs.contains(&dof))
            && self.dof.iter().filter(|d| **d == dof).count() == 1
    }

    /// Whether something holds what moves with a body otherwise: a spring to another part of its
    /// own tree, or inputs. Other trees pull by springs as they push by contacts.
    fn is_held(&self, body: usize) -> bool {
        let tree = self.bodies[body].tree;
        let pulls = |spring: &TreeSpring| {
            let moves = |end: &End| end.body.is_some_and(|end| self.moves_with(end, body));
            let own = |end: &End| end.body.is_some_and(|end| self.bodies[end].tree == tree);
            let [a, b] = &spring.ends;
            moves(a) != moves(b) && own(a) && own(b)
        };
        self.is_driven(body) || self.springs.iter().any(pulls)
    }

    /// Whether a body is one of those that move with the last one of a chain.
    pub fn is_carried(&self, body: usize, kept: usize) -> bool {
        let mut carrier = self.carrier[body];
        while let Some(by) = carrier.filter(|by| *by != kept) {
            carrier = self.kept[by].outer;
        }
        carrier.is_some()
    }

    /// Whether a body is moved by the joint of another one.
    fn moves_with(&self, mut body: usize, by: usize) -> bool {
        while body > by && !self.bodies[body].kind.is_base() {
            body = self.bodies[body].parent;
        }
        body == by
    }

    /// Whether a body has neither mass nor anything else to carry than `child`.
    fn only_passes_on(&self, body: usize, child: usize) -> bool {
        let carries = |(b, other): (usize, &TreeBody)| {
            b != child && other.parent == body && !other.kind.is_base()
        };
        let parent = &self.bodies[body];
        parent.mass <= 0.0
            && parent.I_cm.iter().all(|x| x.abs() <= 0.0)
            && !self.bodies_between(body).any(carries)
    }

    /// The bodies of a tree that come after one, with their indices.
    fn bodies_between(&self, body: usize) -> impl Iterator<Item = (usize, &TreeBody)> {
        let places = body + 1..self.trees[self.bodies[body].tree].bodies.end;
        places.clone().zip(&self.bodies[places])
    }

    /// The chain between two bodies, if momentum is kept along it.
    fn chain(&self, twists: &[[Vec6; 6]], first: usize, last: usize) -> Option<Kept> {
        let mut kept = Kept {
            tree: self.bodies[last].tree,
            body: last,
            ..Kept::default()
        };
        let mut space = Space::NONE;
        let mut turns = [(0, 0); 6];
        let mut b = last;
        loop {
            let body = &self.bodies[b];
            let columns = body.column..body.column + body.columns;
            for (twist, c) in twists[b].iter().zip(columns) {
                if !space.add(twist) {
                    return None;
                }
                // Of a floating base, positions come first, and angular velocities.
                let place = body.coordinate + (c - body.column) % 3;
                if twist[..3].iter().all(|w| w.abs() <= 0.0) {
                    (kept.columns[kept.slides], kept.places[kept.slides]) = (c, place);
                    kept.slides += 1;
                } else {
                    turns[kept.count - kept.slides] = (c, place);
                }
                kept.count += 1;
            }
            if b == first {
                break;
            }
            b = body.parent;
        }
        for (i, turn) in (kept.slides..kept.count).zip(turns) {
            (kept.columns[i], kept.places[i]) = turn;
        }
        let gravity = join(&Vec3::zeros(), &self.world.gravity);
        if !space.stays(&gravity) {
            return None;
        }
        let mut b = last;
        loop {
            let body = &self.bodies[b];
            let mut own = twists[b][..body.columns].iter();
            if !own.all(|twist| space.stays(twist)) {
                return None;
            }
            if body.kind.is_base() {
                return Some(kept);
            }
            b = body.parent;
        }
    }

    /// What the joint of each body lets it do where all joints are at zero: twists about the place
    /// of the base, world axes, as many as it has columns.
    #[cfg_attr(small, optimize(size))]
    fn twists(&self) -> Vec<[Vec6; 6]> {
        // Parents come before children.
        let mut poses: Vec<Pose> = Vec::with_capacity(self.bodies.len());
        let twists = self.bodies.iter().map(|body| {
            let X = if body.kind.is_base() {
                let R = self.trees[body.tree].base.R;
                Pose {
                    R,
                    ..Pose::IDENTITY
                }
            } else {
                poses[body.parent].compose(&body.X)
            };
            poses.push(X);
            let zero = Vec3::zeros();
            let axis = |i: usize| X.R.column(i).into_owned();
            let turn = |i: usize| join(&axis(i), &X.p.cross(&axis(i)));
            let slide = |i: usize| join(&zero, &axis(i));
            match body.kind {
                Kind::Welded => [[0.0; 6]; 6],
                Kind::Free => std::array::from_fn(|i| if i < 3 { turn(i) } else { slide(i - 3) }),
                Kind::Turn => [turn(2); 6],
                Kind::Slide => [slide(2); 6],
                Kind::Ball => std::array::from_fn(|i| turn(i % 3)),
            }
        });
        twists.collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::model::{ActuatorMode, LinkId, Model, Motion};
    use crate::parameters::Parameters;
    use crate::spatial::{Pose, RigidInertia, Vec3};
    use crate::testing::{Builder, inertia};
    use crate::tree::Tree;

    const X: Motion = Motion::Prismatic(Vec3::new(1.0, 0.0, 0.0));
    const Y: Motion = Motion::Prismatic(Vec3::new(0.0, 1.0, 0.0));
    const Z: Motion = Motion::Prismatic(Vec3::new(0.0, 0.0, 1.0));
    const YAW: Motion = Motion::Revolute(Vec3::new(0.0, 0.0, 1.0));
    const ROLL: Motion = Motion::Revolute(Vec3::new(1.0, 0.0, 0.0));
    const BALL: Motion = Motion::Spherical;

    /// A chain of joints in the world, or on a floating base, of which those in `heavy` move a mass
    /// themselves, with a motor on the joint after them.
    fn chain(floating: bool, joints: &[Motion], heavy: &[usize]) -> Model {
        let own = inertia(1.0, Vec3::new(0.3, 0.2, 0.1), [0.1, 0.2, 0.25]);
        let mut b = Builder::new(floating, if floating { own } else { RigidInertia::ZERO });
        let mut last = LinkId(0);
        for (i, motion) in joints.iter().chain([&ROLL]).enumerate() {
            let own = if heavy.contains(&i) || i == joints.len() {
                own
            } else {
                RigidInertia::ZERO
            };
            last = b.link(last, Pose::IDENTITY, *motion, own);
        }
        b.actuator(last, ActuatorMode::Effort, 1.0);
        b.model
    }

    /// How many columns each chain has, what hangs on others first.
    fn found(model: &Model) -> Vec<usize> {
        let tree = Tree::new(model, &Parameters::new(model));
        tree.kept.iter().map(|kept| kept.columns().len()).collect()
    }

    /// By hand: which motions leave those of a chain as they are, and who is without mass.
    #[test]
    fn momentum_is_kept_along_motions_that_no_other_one_turns() {
        let plane = [X, Y, YAW];
        let floats = [X, Y, Z, BALL];
        for (what, floating, joints, heavy, expected) in [
            ("planar joint", false, &plane[..], &[2][..], &[3][..]),
            ("yaw in the midst", false, &[X, YAW, Y], &[2], &[3]),
            ("floating joint", false, &floats, &[3], &[6]),
            (
                "heavy slides: none of the yaw",
                false,
                &plane,
                &[0, 1, 2],
                &[1, 1],
            ),
            ("first slide heavy", false, &plane, &[0, 2], &[1, 1]),
            (
                "second one heavy: in the plane",
                false,
                &plane,
                &[1, 2],
                &[2],
            ),
            ("turret, along gravity", false, &[YAW], &[0], &[1]),
            ("pendulum", false, &[ROLL], &[0], &[]),
            ("arm of a crane: its yaw", false, &[YAW, X], &[0, 1], &[1]),
            ("drill", false, &[YAW, Z], &[0, 1], &[1, 1]),
            ("floating base", true, &[], &[], &[6]),
            (
                "planar joint on it: not the same plane",
                true,
                &plane,
                &[2],
                &[6],
            ),
            ("slide on it", true, &[X], &[0], &[6]),
            ("three slides on it", true, &[X, Y, Z], &[2], &[3, 6]),
            ("floating joint on it", true, &floats, &[3], &[6, 6]),
            (
                "floating joint on what rolls",
                false,
                &[ROLL, X, Y, Z, BALL],
                &[0, 4],
                &[6],
            ),
            (
                "yaw and roll on slides",
                false,
                &[X, Y, YAW, ROLL],
                &[3],
                &[3],
            ),
        ] {
            assert_eq!(found(&chain(floating, joints, heavy)), expected, "{what}");
        }
    }

    /// What acts along a joint takes it out.
    #[test]
    fn momentum_is_kept_only_where_nothing_acts() {
        let free = chain(false, &[X, Y, YAW], &[2]);
        let mut damped = free.clone();
        damped.joints[2].damping = 0.1;
        assert_eq!(found(&damped), [2], "damped yaw");
        let mut geared = free.clone();
        geared.joints[1].armature = 0.1;
        assert_eq!(found(&geared), [1], "rotor on y");
        let mut rubbing = free.clone();
        rubbing.joints[0].friction = 0.1;
        assert_eq!(found(&rubbing), [1], "friction on x");
        let mut level = chain(false, &[ROLL], &[0]);
        level.world.gravity = Vec3::new(-1.0, 0.0, 0.0);
        assert_eq!(found(&level), [1], "gravity along the axle");
        assert_eq!(found(&free), [3]);
    }
}
