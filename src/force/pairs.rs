//! Pairs of shapes that come near each other.
//!
//! Which pairs may touch is known beforehand, see [`crate::tree::Contacts::may_touch`]. Which come
//! near is found by sorting the balls about all shapes along x, those of the scenery once and for
//! all; where these come near, [`Patch`] finds the points.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::apart::Apart;
use super::kept::Kept;
use super::pair::Pair;
use crate::geometry::Shape;
use crate::geometry::pair::{MOST_PARTS, Nearby, Patch};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::spatial::{Pose, Vec3, Vec6, angular, velocity_at};
use crate::tree::{Tree, TreeCollider};
use crate::tuning::CONTACT_MARGIN;
use std::cmp::Ordering;

/// Scratch of the search for pairs.
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    /// A ball about each shape that moves and is no terrain, by ascending `Ball::low`.
    balls: Vec<Ball>,
    /// Places of terrain, and where it stands.
    grounds: Vec<(usize, Pose)>,
    /// What is known from before of each terrain, in the order of `grounds`, and each shape. It
    /// only saves time: the result is the same when nothing is known.
    known: Vec<KnownGround>,
    /// Pairs of places that come near, the lower one first.
    near: Vec<[usize; 2]>,
    /// Along what those are apart that do not touch.
    apart: Apart,
    /// What touching pairs had in common where a step ended.
    kept: Kept,
    /// None where no shapes touch each other.
    patch: Option<Box<Patch>>,
}

/// A ball in which a shape stays for the time that is looked ahead.
#[derive(Clone, Copy, Debug, Default)]
struct Ball {
    /// Place of the shape.
    place: usize,
    /// Centre in the world, m.
    center: Vec3,
    /// m
    radius: f64,
    /// Its least x, m.
    low: f64,
}

impl Ball {
    /// Whether it has something in common with another one.
    fn meets(&self, center: &Vec3, radius: f64) -> bool {
        let reach = self.radius + radius;
        (self.center - center).norm_squared() < reach * reach
    }
}

/// What is known of terrain from before.
#[derive(Clone, Debug)]
struct KnownGround {
    /// Its place, and where it stood.
    place: usize,
    X: Pose,
    /// Of each shape.
    shapes: Vec<Known>,
}

/// What is known of a shape and terrain from before.
#[derive(Clone, Debug)]
struct Known {
    /// A ball, and whether it comes near the terrain.
    ball: Ball,
    near: bool,
    /// What is near of a mesh.
    nearby: Option<Nearby>,
}

/// By how much a ball that is looked at is larger than it must be, as a share of its radius, so
/// that the next look need not ask the terrain.
const AHEAD: f64 = 0.125;

/// Room for looks at pairs and for their points that are kept, for each shape: a cube of a wall
/// touches four others, with four points each, and half of each pair is its own.
const KEPT: [usize; 2] = [4, 24];

impl KnownGround {
    /// Room for each shape on each terrain of a model.
    fn of(model: &Model, shapes: usize) -> Vec<Self> {
        let terrain = model.colliders.iter().filter_map(|collider| {
            let nearby = match collider.shape {
                Shape::Surface { .. } => Some(Nearby::new()),
                Shape::Plane | Shape::Field { .. } => None,
                _ => return None,
            };
            let one = Known {
                ball: Ball::default(),
                near: false,
                nearby,
            };
            Some(Self {
                place: usize::MAX,
                X: Pose::IDENTITY,
                shapes: vec![one; shapes],
            })
        });
        terrain.collect()
    }

    /// Knows nothing of other terrain, or of terrain that stands elsewhere.
    fn turn_to(&mut self, place: usize, X: &Pose) {
        if self.place == place && self.X == *X {
            return;
        }
        (self.place, self.X) = (place, *X);
        for known in &mut self.shapes {
            known.ball.radius = 0.0;
            if let Some(nearby) = &mut known.nearby {
                nearby.forget();
            }
        }
    }
}

impl Known {
    /// Whether a ball may come nearer than `margin`, m, to terrain that stands at `X`.
    fn may_be_near(&mut self, ground: &TreeCollider, X: &Pose, ball: &Ball, margin: f64) -> bool {
        let radius = ball.radius + margin;
        let room = self.ball.radius - radius;
        let holds = room > 0.0 && (self.ball.center - ball.center).norm_squared() < room * room;
        if !holds {
            let larger = radius * (1.0 + AHEAD);
            self.near = clearance(ground, X, &ball.center, larger) <= 0.0;
            // What round-off makes of the room is left out.
            self.ball = Ball {
                radius: radius * (1.0 + 0.99 * AHEAD),
                ..*ball
            };
        }
        self.near
    }
}

impl Pairs {
    /// Room for a model.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        let shapes = if model.has_pairs() {
            model.colliders.len()
        } else {
            0
        };
        Self {
            balls: Vec::with_capacity(shapes),
            grounds: Vec::with_capacity(shapes),
            known: KnownGround::of(model, shapes),
            near: Vec::with_capacity(shapes * shapes.saturating_sub(1) / 2),
            apart: Apart::new(shapes),
            kept: Kept::new(KEPT.map(|each| each * shapes)),
            patch: (shapes > 0).then(Box::default),
        }
    }

    /// Calls `take` with each pair of shapes that a step works on which is within the way that both
    /// go in `h` seconds, or nearer than `margin`, m, by ascending slots, until it says that it has
    /// enough; tells whether it has. Pairs whose places are to be passed over are not looked at
    /// closely.
    ///
    /// - `keep`: whether what is found is kept for the next looks at the same poses
    pub(super) fn each(
        &mut self,
        (tree, kin): (&Tree, &Kinematics),
        ([h, margin], keep): ([f64; 2], bool),
        pass_over: impl Fn([usize; 2]) -> bool,
        mut take: impl FnMut(usize, &Pair, &mut Patch, usize) -> bool,
    ) -> bool {
        let Some(mut patch) = self.patch.take() else {
            return false;
        };
        self.search(tree, kin, [h, margin]);
        let Self {
            near,
            grounds,
            known,
            apart,
            kept,
            ..
        } = self;
        if keep {
            kept.clear();
        }
        let enough = near.iter().any(|&places| {
            !pass_over(places)
                && Pair::new(tree, kin, places).is_some_and(|pair| {
                    let ground = grounds.iter().position(|(place, _)| places.contains(place));
                    let nearby = ground.and_then(|ground| {
                        let shape = usize::from(grounds[ground].0 == places[0]);
                        known[ground].shapes[places[shape]].nearby.as_mut()
                    });
                    let reach = h * pair.speed(kin) + margin;
                    let touch = if ground.is_some() {
                        pair.touch(&mut patch, reach, nearby)
                    } else {
                        apart.touch(places, (&pair, &mut patch), reach, |patch| {
                            if keep {
                                return kept.touch(places, &pair, patch, reach);
                            }
                            let known = kept.recall(places, &pair, patch, reach);
                            known.unwrap_or_else(|| pair.touch(patch, reach, None))
                        })
                    };
                    touch
                        && (0..patch.parts().len()).any(|at| {
                            let slot = tree.contact.slot(places) + patch.parts()[at].index;
                            take(slot, &pair, &mut patch, at)
                        })
                })
        });
        self.patch = Some(patch);
        enough
    }

    /// Takes what another search has kept.
    pub(crate) fn take_kept(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.kept, &mut other.kept);
    }

    /// See [`super::ContactSet::group`].
    pub(super) fn group(
        &mut self,
        (tree, kin): (&Tree, &Kinematics),
        [h, margin]: [f64; 2],
        left_out: &[bool],
        leader: &mut [usize],
    ) {
        if self.patch.is_none() {
            return;
        }
        self.search(tree, kin, [h, margin]);
        for &places in &self.near {
            let trees = places.map(|place| tree.contact.colliders[place].tree);
            let [a, b] = trees.map(|index| leader[index]);
            let moves = |index: &usize| tree.trees[*index].moves();
            let stays = |index: &usize| left_out.get(*index) == Some(&true);
            if a == b || !trees.iter().all(moves) || trees.iter().all(stays) {
                continue;
            }
            let near = Pair::new(tree, kin, places)
                .is_some_and(|pair| pair.is_near(h * pair.speed(kin) + margin));
            if near {
                let (low, high) = (a.min(b), a.max(b));
                for leader in leader.iter_mut().filter(|leader| **leader == high) {
                    *leader = low;
                }
            }
        }
    }

    /// Lists the pairs that may come near within `h` seconds, by ascending slots; `margin`: gap
    /// that is near whatever the velocities, m.
    fn search(&mut self, tree: &Tree, kin: &Kinematics, [h, margin]: [f64; 2]) {
        self.balls.clear();
        self.near.clear();
        self.grounds.clear();
        for (place, collider) in tree.worked_movers() {
            if let Some(X) = terrain_at(collider, kin) {
                self.grounds.push((place, X));
                continue;
            }
            let (center, speed) = kin.ball(collider);
            let radius = collider.radius + h * speed + 0.5 * margin;
            let center = center + kin.origins[collider.tree];
            self.balls.push(Ball {
                place,
                center,
                radius,
                low: center.x - radius,
            });
        }
        sort(&mut self.balls, |a, b| {
            a.low.total_cmp(&b.low).then(a.place.cmp(&b.place))
        });
        for ((ground, X), known) in self.grounds.iter().zip(&mut self.known) {
            known.turn_to(*ground, X);
        }
        let near = &mut self.near;
        let mut add = |first: usize, second: usize| {
            let pair = in_order(first, second);
            if tree.contact.may_touch(pair) {
                near.push(pair);
            }
        };
        for (rank, a) in self.balls.iter().enumerate() {
            let high = a.center.x + a.radius;
            for b in &self.balls[rank + 1..] {
                if b.low > high {
                    break;
                }
                if a.meets(&b.center, b.radius) {
                    add(a.place, b.place);
                }
            }
            let range = [a.low - 0.5 * margin, high + 0.5 * margin];
            for b in tree.contact.scenery.within(range) {
                if a.meets(&b.center, b.radius + 0.5 * margin) && tree.takes(b.tree) {
                    add(a.place, b.place);
                }
            }
            for ((ground, X), known) in self.grounds.iter().zip(&mut self.known) {
                let terrain = &tree.contact.colliders[*ground];
                if known.shapes[a.place].may_be_near(terrain, X, a, 0.5 * margin) {
                    add(a.place, *ground);
                }
            }
        }
        sort(&mut self.near, Ord::cmp);
    }
}

/// A few by insertion: the standard library takes longer where it is optimised for size, and
/// neighbours in the model are often neighbours in space.
fn sort<T: Copy>(list: &mut [T], compare: impl Fn(&T, &T) -> Ordering) {
    const FEW: usize = 50;
    if list.len() > FEW {
        return list.sort_unstable_by(compare);
    }
    for last in 1..list.len() {
        let item = list[last];
        let mut at = last;
        while at > 0 && compare(&list[at - 1], &item) == Ordering::Greater {
            list[at] = list[at - 1];
            at -= 1;
        }
        list[at] = item;
    }
}

/// Where terrain stands in the world; none for what is no terrain.
fn terrain_at(collider: &TreeCollider, kin: &Kinematics) -> Option<Pose> {
    let is_terrain = collider.solid.as_ref().is_some_and(|s| s.is_terrain());
    is_terrain.then(|| {
        let mut X = kin.X[collider.body].compose(&collider.X);
        X.p += kin.origins[collider.tree];
        X
    })
}

/// How far terrain that stands at `X` is from a ball, at least, m.
fn clearance(ground: &TreeCollider, X: &Pose, center: &Vec3, radius: f64) -> f64 {
    let solid = ground.solid.as_ref();
    let clear = solid.and_then(|s| s.clearance(X, center, radius));
    clear.unwrap_or(f64::NEG_INFINITY)
}

/// Whether no two shapes come near within `h` seconds, by twice the way that velocities and gravity
/// take them.
pub(super) fn is_apart(tree: &Tree, kin: &Kinematics, h: f64) -> bool {
    let more = 2.0 * h * h * tree.world.gravity.norm() + CONTACT_MARGIN;
    let ball = |c: &TreeCollider| {
        let (center, speed) = kin.ball(c);
        let center = center + kin.origins[c.tree];
        let radius = c.radius + 2.0 * h * speed + more;
        Ball {
            center,
            radius,
            low: center.x - radius,
            ..Ball::default()
        }
    };
    tree.worked_movers().all(|(first, collider)| {
        let own = ball(collider);
        let ground = terrain_at(collider, kin);
        let range = [own.low - more, own.center.x + own.radius + more];
        partners(tree, first, range).all(|second| {
            let c = &tree.contact.colliders[second];
            let grounds = [&ground, &terrain_at(c, kin)];
            !balls_meet([collider, c], grounds, [&own, &ball(c)], 0.0)
        })
    })
}

/// Places of all that may touch a shape which moves and stays in a range of x, m: of what moves,
/// those behind its own, so that each pair is met once.
#[cfg_attr(small, optimize(size))]
fn partners(tree: &Tree, own: usize, range: [f64; 2]) -> impl Iterator<Item = usize> + use<'_> {
    let later = tree.worked_movers().map(|(place, _)| place);
    let later = later.skip_while(move |place| *place <= own);
    let still = tree.contact.scenery.within(range);
    let still = still.filter(|still| tree.takes(still.tree));
    let places = later.chain(still.map(|still| still.place));
    places.filter(move |place| tree.contact.may_touch(in_order(own, *place)))
}

/// A pair of places, the lower one first.
fn in_order(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// Whether balls about two shapes are nearer than `reach`, m; of terrain, which stands at its place
/// in `grounds`, the terrain itself.
fn balls_meet(
    [a, b]: [&TreeCollider; 2],
    grounds: [&Option<Pose>; 2],
    [own, other]: [&Ball; 2],
    reach: f64,
) -> bool {
    let meets = |ground: &TreeCollider, X: &Pose, ball: &Ball| {
        clearance(ground, X, &ball.center, ball.radius + reach) <= 0.0
    };
    match grounds {
        [Some(X), _] => meets(a, X, other),
        [None, Some(X)] => meets(b, X, own),
        [None, None] => (other.center - own.center).norm() <= own.radius + other.radius + reach,
    }
}

/// Whether within `h` seconds two shapes may pass each other of which nothing is felt, by half of
/// the thickness of the thinner one, by the way that velocities and accelerations take them.
///
/// - `A`: accelerations of all bodies about O
/// - `felt`: slots of contacts of which something is felt
pub fn may_pass(tree: &Tree, kin: &Kinematics, A: &[Vec6], h: f64, felt: &[usize]) -> bool {
    // A ball about a shape, and the way that its points go.
    let ball = |c: &TreeCollider| {
        let (center, speed) = kin.ball(c);
        let (V, A) = (&kin.V[c.body], &A[c.body]);
        let v = velocity_at(V, &center);
        let faster = velocity_at(A, &center) + angular(V).cross(&v);
        // Terrain has no end and does not turn.
        let (spin, reach) = (angular(A).norm(), c.radius);
        let turning = if spin > 0.0 { spin * reach } else { 0.0 };
        let way = h * speed + 0.5 * h * h * (faster.norm() + turning);
        let ball = Ball {
            center: center + kin.origins[c.tree],
            radius: c.radius,
            ..Ball::default()
        };
        (ball, way)
    };
    let may = |places: [usize; 2]| {
        let [a, b] = places.map(|place| &tree.contact.colliders[place]);
        let slot = tree.contact.slot(places);
        let own = slot..slot + MOST_PARTS;
        if felt.iter().any(|slot| own.contains(slot)) {
            return false;
        }
        let Some(pair) = Pair::new(tree, kin, places) else {
            return false;
        };
        let ((own, way), (other, its_way)) = (ball(a), ball(b));
        let reach = way + its_way - pair.thickness();
        let grounds = [a, b].map(|c| terrain_at(c, kin));
        // Terrain is near wherever it is.
        reach > 0.0
            && balls_meet([a, b], grounds.each_ref(), [&own, &other], reach)
            && pair.is_near(reach)
    };
    tree.worked_movers().any(|(first, a)| {
        let (own, way) = ball(a);
        let reach = own.radius + way;
        let range = [own.center.x - reach, own.center.x + reach];
        partners(tree, first, range).any(|second| may(in_order(first, second)))
    })
}

#[cfg(test)]
mod tests;
