//! A closed loop and a spring, as the solver sees them.

use crate::spatial::Pose;

/// A loop that is closed; filled by [`Tree::new`](super::Tree::new).
#[derive(Clone, Debug)]
pub struct Closure {
    /// What it holds.
    pub kind: ClosureKind,
    /// Where it holds it; none of a coupler has a body.
    pub ends: [End; 2],
    /// Columns of `S` that move the first end and not the second one, and the other way round:
    /// with the place of their degree of freedom in `dofs`.
    pub columns: [Vec<(usize, usize)>; 2],
    /// Degrees of freedom that it acts on, ascending.
    pub dofs: Vec<usize>,
    /// Parts of the joint-space matrix that it acts on, ascending.
    pub parts: Vec<usize>,
    /// Closures before it in [`Tree::closure_order`](super::Tree::closure_order) that act on one of
    /// these, too, in that order, and itself.
    pub beside: Vec<usize>,
    /// Its place in that order.
    pub rank: usize,
    /// Its first row among those of all closures.
    pub first: usize,
    /// Trees that it joins, without scenery; the second one may be the first one again, or none.
    pub trees: [Option<usize>; 2],
}

/// What a closure holds.
#[derive(Clone, Debug)]
pub enum ClosureKind {
    /// See [`LoopKind::Weld`](crate::model::LoopKind::Weld).
    Weld,
    /// See [`LoopKind::Ball`](crate::model::LoopKind::Ball).
    Ball,
    /// See [`LoopKind::Hinge`](crate::model::LoopKind::Hinge).
    Hinge,
    /// See [`LoopKind::Distance`](crate::model::LoopKind::Distance): the length, m.
    Distance(f64),
    /// See [`LoopKind::Coupler`](crate::model::LoopKind::Coupler).
    Coupler {
        /// Place in `q`, place in [`Closure::dofs`], and factor.
        terms: Vec<(usize, usize, f64)>,
        /// What the sum of these is, rad or m.
        sum: f64,
        /// Whether it follows from where the joints begin, see [`Tree::mesh`](super::Tree::mesh).
        meshes: bool,
    },
}

impl ClosureKind {
    /// How many rows it has.
    pub fn rows(&self) -> usize {
        match self {
            Self::Weld => 6,
            Self::Hinge => 5,
            Self::Ball => 3,
            Self::Distance(_) | Self::Coupler { .. } => 1,
        }
    }
}

/// A frame on a body.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// None: the world.
    pub body: Option<usize>,
    /// Pose in the body's solver frame, or in the world.
    pub X: Pose,
}

/// A spring between two points; filled by [`Tree::new`](super::Tree::new).
#[derive(Clone, Copy, Debug)]
pub struct TreeSpring {
    /// Index in the model's list.
    pub index: usize,
    /// A body that moves and the point on it, and what it hangs on.
    pub ends: [End; 2],
    /// Whether these are the model's ends the other way round.
    pub reversed: bool,
    /// m
    pub length: f64,
    /// N/m
    pub stiffness: f64,
    /// N·s/m
    pub damping: f64,
}
