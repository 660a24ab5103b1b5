//! The parts of a tree, one idea each.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::closure::{Closure, TreeSpring};
use super::kept::Kept;
use super::scenery::Scenery;
use super::turning::Turning;
use crate::geometry::Faces;
use crate::geometry::pair::{MOST_PARTS, Solid};
use crate::joint::Kind;
use crate::law::normal::Stiffening;
use crate::model::{Combination, Joint, Limits, RootId};
use crate::sparsity::Sparsity;
use crate::spatial::{Pose, Vec3, Vec6};
use std::ops::Range;
use std::sync::Arc;

/// Everything that follows from a model and its parameters and is constant in a step.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Every body, parents before children; filled by [`Self::new`].
    pub bodies: Vec<TreeBody>,
    /// The trees that the bodies make up, each with a base of its own.
    pub trees: Vec<Extent>,
    /// Degree of freedom of each column of `S`; filled by [`Self::new`].
    pub dof: Vec<usize>,
    /// Pattern of the joint-space matrix; filled by [`Self::new`].
    pub sparsity: Sparsity,
    /// The trees that a step moves; set by [`Self::select`].
    pub island: Island,
    /// Whether every column of these is its own degree of freedom: no joint mimics another; set by
    /// [`Self::select`].
    pub pure: bool,
    /// Whether the articulated-body algorithm is cheaper there than mass matrix and factor: chains
    /// of many joints; set by [`Self::select`].
    pub long: bool,
    /// Pose of each link in its body's solver frame; filled by [`Self::new`].
    pub link_pose: Vec<Pose>,
    /// What closes loops; filled by [`Self::new`].
    pub closures: Vec<Closure>,
    /// In which order their rows stand: that in which forces are solved for; filled by
    /// [`Self::new`].
    pub closure_order: Vec<usize>,
    /// Springs between two points; filled by [`Self::new`].
    pub springs: Vec<TreeSpring>,
    /// What keeps its momentum, what hangs on others first; filled by [`Self::tune`].
    pub kept: Vec<Kept>,
    /// The innermost of these that moves each body; filled by [`Self::tune`].
    pub carrier: Vec<Option<usize>>,
    /// What the world does to all bodies.
    pub world: World,
    /// What touches, and how stiffly.
    pub contact: Contacts,
    /// What acts along each degree of freedom, and how its errors count.
    pub dofs: Dofs,
    /// What the actuators are made of.
    pub actuators: Actuators,
}

/// The trees that a step moves, and the scenery.
#[derive(Clone, Debug, Default)]
pub struct Island {
    /// By ascending index.
    pub spans: Vec<Span>,
    /// Whether each tree belongs to it.
    pub(super) takes: Vec<bool>,
    /// The first of those that move: what the method remembers of an island stands there.
    pub lead: usize,
    /// Whether loops close in it.
    pub closed: bool,
}

/// Trees one after the other, and what belongs to them in the lists of all trees.
#[derive(Clone, Debug)]
pub struct Span {
    /// Which.
    pub trees: Range<usize>,
    /// Their bodies.
    pub bodies: Range<usize>,
    /// Their places in `v`.
    pub dofs: Range<usize>,
    /// Their places in `q`.
    pub coordinates: Range<usize>,
}

/// One tree: a base that hangs in the world, and all that hangs on it.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each says something else")]
pub struct Extent {
    /// Pose of a fixed base in the world; filled by [`Tree::new`].
    pub base: Pose,
    /// Its bodies, the base first; filled by [`Tree::new`].
    pub bodies: Range<usize>,
    /// Its places in `v`; filled by [`Tree::new`].
    pub dofs: Range<usize>,
    /// Its places in `q`; filled by [`Tree::new`].
    pub coordinates: Range<usize>,
    /// Whether its base floats; filled by [`Tree::new`].
    pub free: bool,
    /// Where the solver's frame of a floating base stands in that of its link, m: in its centre of
    /// mass; filled by [`Tree::new`].
    pub center: Vec3,
    /// Whether every column is its own degree of freedom: no joint mimics another; filled by
    /// [`Tree::new`].
    pub pure: bool,
    /// Whether a loop closes in it, or joins it to something; filled by [`Tree::new`].
    pub closed: bool,
    /// Whether a loop or a spring holds it to another tree or to the world; filled by
    /// [`Tree::new`].
    pub tied: bool,
    /// Acceleration `[ω̇; p̈]` of a base that moves as inputs say, rad/s² and m/s², world axes;
    /// none of another one; set by [`Tree::drive`].
    pub driven: Option<Vec6>,
    /// Mass of all its moving bodies but a driven base, kg; filled by [`Tree::new`].
    pub moving_mass: f64,
    /// The same with all that loops join to it; filled by [`Tree::new`].
    pub joined_mass: f64,
    /// Its largest extent from its base in the initial position, m; filled by [`Tree::scale`].
    pub reach: f64,
}

impl Extent {
    /// Whether any of its bodies moves; else it is scenery.
    pub fn moves(&self) -> bool {
        !self.dofs.is_empty()
    }
}

/// What the world does to all bodies.
#[derive(Clone, Debug)]
pub struct World {
    /// m/s², world axes; filled by [`Tree::tune`].
    pub gravity: Vec3,
    /// As [`crate::model::World::drag`], 1/s.
    pub drag: f64,
}

/// What touches, and how stiffly.
#[derive(Clone, Debug)]
pub struct Contacts {
    /// How many shapes the model has.
    pub shapes: usize,
    /// Shapes that can touch something, by ascending index.
    pub colliders: Vec<TreeCollider>,
    /// What resists turning at each link, per link.
    pub turning: Vec<Turning>,
    /// Whether any surface does; filled by [`Tree::new`].
    pub resists_turning: bool,
    /// Dissipation of contacts without restitution, and of joint limits, s/m.
    pub dissipation: f64,
    /// Sliding speed at which friction has lost most of what it has more at rest, m/s.
    pub stribeck_velocity: f64,
    /// How the coefficients of two surfaces are combined.
    pub combination: Combination,
    /// Whether each pair of `colliders` may touch: the one at `a * colliders.len() + b`, `a < b`;
    /// empty where none may.
    pub pairs: Vec<bool>,
    /// Which of them never move, and which do.
    pub scenery: Scenery,
    /// Whether there is a ground.
    pub has_ground: bool,
    /// What the ground is for shapes that touch others; none where there is none.
    pub ground_solid: Option<Arc<Solid>>,
    /// Surface of the ground; filled by [`Tree::tune`].
    pub ground: Surface,
}

/// What acts along each degree of freedom, and how its errors count; each list has `nv` entries.
#[derive(Clone, Debug)]
pub struct Dofs {
    /// Rotor inertia, kg·m² or kg; filled by [`Tree::new`].
    pub armature: Vec<f64>,
    /// Viscous damping, N·m·s/rad or N·s/m; filled by [`Tree::tune`].
    pub damping: Vec<f64>,
    /// Dry friction; filled by [`Tree::tune`].
    pub friction: Vec<DryFriction>,
    /// Enforced speed limit, rad/s or m/s, infinite without; filled by [`Tree::new`].
    pub speed_limit: Vec<f64>,
    /// Damping beyond the speed limit, N·m·s/rad or N·s/m; filled by [`Tree::scale`].
    pub speed_damping: Vec<f64>,
    /// Position limits, rad or m; filled by [`Tree::new`].
    pub limits: Vec<Option<Limits>>,
    /// Stiffness of the position limits, N·m/rad or N/m; filled by [`Tree::scale`].
    pub limit_stiffness: Vec<f64>,
    /// Diagonal of the mass matrix at the initial position, kg·m² or kg; filled by [`Tree::scale`].
    pub inertia: Vec<f64>,
    /// Weight of an error, 1 at one metre or at one radian of a metre's reach; filled by
    /// [`Tree::scale`].
    pub weight: Vec<f64>,
    /// Number of components of the vector that begins here, such as the velocity of a base; 0 at
    /// the other components, 1 at a joint by itself; filled by [`Tree::new`].
    pub components: Vec<usize>,
}

/// What the actuators are made of; each list has one entry an actuator.
#[derive(Clone, Debug)]
pub struct Actuators {
    /// Stiffness (N·m/rad or N/m) and damping (N·m·s/rad or N·s/m) as a velocity motor; filled by
    /// [`Tree::scale`].
    pub motors: Vec<(f64, f64)>,
    /// Gains kp (N·m/rad or N/m) and kd (N·m·s/rad or N·s/m); filled by [`Tree::tune`].
    pub gains: Vec<[f64; 2]>,
}

/// A body as the solver sees it: its place in the tree, its inboard joint, its inertia. Filled by
/// [`Tree::new`].
#[derive(Clone, Debug)]
pub struct TreeBody {
    /// Index of the parent; a base points to itself.
    pub parent: usize,
    /// Index of its tree in [`Tree::trees`].
    pub tree: usize,
    /// How it moves in its parent.
    pub kind: Kind,
    /// Pose at joint zero in the parent's solver frame.
    pub X: Pose,
    /// First column.
    pub column: usize,
    /// Number of columns.
    pub columns: usize,
    /// First place in `q`.
    pub coordinate: usize,
    /// First place in `v`.
    pub dof: usize,
    /// Ratio of a mimic joint, else 1.
    pub ratio: f64,
    /// Offset of a mimic joint, else 0.
    pub offset: f64,
    /// Rate at which the bias turns over the one at which it turns: 1, and less or more for a
    /// wheel, which is even about its joint's axis and carries nothing, see `spinning`.
    pub spinning: f64,
    /// kg
    pub mass: f64,
    /// Centre of mass in the solver frame, m.
    pub com: Vec3,
    /// Inertia about the centre of mass in the solver frame: xx, yy, zz, xy, xz, yz, kg·m².
    pub I_cm: [f64; 6],
}

/// A collision shape as the solver sees it. Its place is filled by [`Tree::new`], coefficients with
/// the ground by [`Tree::tune`], stiffness and penetration by [`Tree::scale`].
#[derive(Clone, Debug)]
pub struct TreeCollider {
    /// Index in the model's list.
    pub index: usize,
    /// Index of the body, and of its tree.
    pub body: usize,
    /// See `body`.
    pub tree: usize,
    /// Whether the body moves.
    pub moves: bool,
    /// Whether what pushes the body moves it: not of one that stands still or moves as inputs say.
    pub yields: bool,
    /// Index of the link.
    pub link: usize,
    /// Pose in the body's solver frame.
    pub X: Pose,
    /// Radius of a ball about `X.p` that holds the shape, m.
    pub radius: f64,
    /// Coefficients of its own surface.
    pub own: Surface,
    /// The same, combined with those of the ground.
    pub ground: Surface,
    /// Hunt–Crossley dissipation without restitution, s/m.
    pub dissipation: f64,
    /// Velocity of its surface against its body, m/s, world axes; filled by
    /// [`Tree::run_conveyors`].
    pub belt: Vec3,
    /// Spring of its contact.
    pub spring: Stiffening,
    /// Faces of a hull; none of another shape.
    pub faces: Arc<Faces>,
    /// What it is for other shapes; none where there are none.
    pub solid: Option<Arc<Solid>>,
}

/// Coefficients of a surface, or of two that touch.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Coulomb coefficient, sliding.
    pub mu: f64,
    /// The same at rest, not below.
    pub mu_at_rest: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Hunt–Crossley dissipation times approach speed for that restitution.
    pub dissipation_number: f64,
    /// Torsional and rolling friction, m; filled by [`Tree::new`].
    pub turning: [f64; 2],
}

impl Default for Surface {
    /// Without friction and restitution.
    fn default() -> Self {
        Self {
            mu: 0.0,
            mu_at_rest: 0.0,
            restitution: 0.0,
            dissipation_number: f64::INFINITY,
            turning: [0.0; 2],
        }
    }
}

impl Surface {
    /// Takes a coefficient of restitution.
    #[expect(
        clippy::float_cmp,
        reason = "skips the root search where nothing changed"
    )]
    fn bounce(&mut self, restitution: f64) {
        if self.restitution != restitution {
            self.restitution = restitution;
            self.dissipation_number = crate::law::dissipation_number(restitution);
        }
    }

    /// Takes what this surface and another one have together.
    pub fn combine(&mut self, [own, other]: [&Self; 2], combination: Combination) {
        let combined = match combination {
            Combination::Mean => harmonic_mean,
            Combination::Product => |a: f64, b: f64| a * b,
        };
        self.mu = combined(own.mu, other.mu);
        self.mu_at_rest = combined(own.mu_at_rest, other.mu_at_rest);
        self.turning = [0, 1].map(|i| own.turning[i].max(other.turning[i]));
        let [a, b] = [own, other].map(|surface| surface.restitution);
        match combination {
            Combination::Mean => {
                let bouncier = if a < b { other } else { own };
                self.restitution = bouncier.restitution;
                self.dissipation_number = bouncier.dissipation_number;
            }
            Combination::Product => self.bounce(a * b),
        }
    }

    /// Whether it resists turning at all.
    pub fn resists_turning(&self) -> bool {
        self.turning[0] > 0.0 || self.turning[1] > 0.0
    }

    /// Takes the coefficients of a surface alone.
    pub(super) fn set(&mut self, mu: f64, static_excess: f64, restitution: f64) {
        (self.mu, self.mu_at_rest) = (mu, mu * (1.0 + static_excess));
        self.bounce(restitution);
    }
}

/// `2ab/(a+b)`, 0 where both are 0.
pub fn harmonic_mean(a: f64, b: f64) -> f64 {
    if a + b > 0.0 {
        2.0 * a * b / (a + b)
    } else {
        0.0
    }
}

/// Dry friction of a degree of freedom, filled by [`Tree::tune`].
#[derive(Clone, Copy, Debug, Default)]
pub struct DryFriction {
    /// Far above the Stribeck speed, N·m or N.
    pub moving: f64,
    /// At rest, not below.
    pub at_rest: f64,
    /// Stribeck speed, rad/s or m/s; 0 without friction.
    pub stribeck_velocity: f64,
}

impl DryFriction {
    /// Adds that of a joint which moves `ratio` times as fast.
    pub(super) fn add(&mut self, joint: &Joint, friction: f64, ratio: f64) {
        self.moving += friction * ratio;
        self.at_rest += friction * ratio * (1.0 + joint.static_excess);
        if friction * ratio > 0.0 {
            let own = joint.stribeck_velocity / ratio;
            self.stribeck_velocity = self.stribeck_velocity.max(own);
        }
    }
}

impl Contacts {
    /// What the surfaces of two shapes have together.
    pub fn surface_of(&self, [a, b]: [&TreeCollider; 2]) -> Surface {
        let mut both = Surface::default();
        both.combine([&a.own, &b.own], self.combination);
        both
    }

    /// What friction against turning of a link is made for, against another one if that yields.
    pub fn turning_of(&self, link: usize, other: Option<usize>) -> Turning {
        let own = self.turning[link];
        other.map_or(own, |other| own.with(self.turning[other]))
    }

    /// The slot of the first part of the contact of the shapes at two places, the lower one first;
    /// see [`crate::model::Model::slots`].
    #[inline]
    pub fn slot(&self, places: [usize; 2]) -> usize {
        let [a, b] = places.map(|place| self.colliders[place].index);
        self.shapes + (self.shapes * a + b) * MOST_PARTS
    }

    /// Whether the shapes at two places, the lower one first, may touch.
    #[inline]
    pub fn may_touch(&self, [a, b]: [usize; 2]) -> bool {
        self.pairs
            .get(a * self.colliders.len() + b)
            .is_some_and(|may| *may)
    }
}

impl Tree {
    /// Whether everything that moves has an inertia, and every spring is finite.
    pub fn is_sound(&self) -> bool {
        let mut springs = self.contact.colliders.iter().map(|c| &c.spring);
        self.dofs.inertia.iter().all(|m| m.is_finite() && *m > 0.0)
            && springs.all(|spring| spring.stiffness.is_finite())
    }

    /// Largest extent of a tree that a step moves from its base, m.
    pub fn reach(&self) -> f64 {
        self.moved().map(|(_, tree)| tree.reach).fold(0.0, f64::max)
    }

    /// Columns of `S` that move a body: its own, its parent's, and so on down to the base.
    #[inline]
    pub fn columns_to(&self, body: usize) -> impl Iterator<Item = usize> + '_ {
        let below = |b: &usize| {
            let body = &self.bodies[*b];
            (!body.kind.is_base()).then_some(body.parent)
        };
        std::iter::successors(Some(body), below).flat_map(|b| {
            let body = &self.bodies[b];
            body.column..body.column + body.columns
        })
    }

    /// Whether the base of a body's tree floats: its columns of `S`, the first six of the tree, are
    /// the unit vectors.
    #[inline]
    pub fn is_free(&self, body: usize) -> bool {
        self.trees[self.bodies[body].tree].free
    }

    /// Whether a body is the base of a floating tree: then its columns of `S` are the unit vectors,
    /// in this order.
    #[inline]
    pub fn is_free_base(&self, body: usize) -> bool {
        let tree = &self.trees[self.bodies[body].tree];
        tree.free && tree.bodies.start == body
    }

    /// Shapes that can touch the ground in a step: those that it moves, if there is one.
    pub fn on_ground(&self) -> impl Iterator<Item = &TreeCollider> + '_ {
        let colliders = self.worked_colliders().map(|(_, collider)| collider);
        colliders.filter(|c| c.yields && self.contact.has_ground)
    }

    /// Sets how fast surfaces move, by the inputs.
    pub fn run_conveyors(&mut self, velocity: impl Fn(RootId) -> Option<Vec3>) {
        for collider in &mut self.contact.colliders {
            if let Some(velocity) = velocity(RootId::from(collider.tree)) {
                collider.belt = self.trees[collider.tree].base.R * velocity;
            }
        }
    }

    /// Mass of all moving bodies of a body's tree, kg; 0 of a driven base, which no contact moves.
    #[inline]
    pub fn mass_with(&self, body: usize) -> f64 {
        if self.is_driven(body) {
            return 0.0;
        }
        self.trees[self.bodies[body].tree].moving_mass
    }

    /// Mass that takes part in an impact of a body, kg: [`Self::mass_with`] and that of all that
    /// loops join to its tree, as if joints did.
    #[inline]
    pub fn mass_in_impact(&self, body: usize) -> f64 {
        if self.is_driven(body) {
            return 0.0;
        }
        self.trees[self.bodies[body].tree].joined_mass
    }

    /// Brings the quaternions in what a step works on of `q` back to unit length.
    pub fn normalize(&self, q: &mut [f64]) {
        for (_, body) in self.worked_bodies() {
            body.kind.normalize(&mut q[body.coordinate..]);
        }
    }
}
