//! Which walls of a solid are shut, so that nothing can come against them.
//!
//! A wall is shut where something stands against it, and where something goes on behind a gap at
//! the height of the face that is looked at, as long as what lies on both cannot come down there.
//!
//! What stands on the same body, or does not move as the solid itself, is known beforehand. What
//! moves against it is looked for at each query. The two may come apart, and something get between
//! them, a wedge that lifts a block off its table. So it shuts a wall only where it goes on level
//! with a face of the solid: over such a joint there is nothing to get between. Each of them has
//! sunk by its own weight into what carries it, so that they are level but for such depths.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::beside::{Face, is_in, is_on};
use super::core::{Core, Solid};
use super::lowest::{lowest_of, places, skin};
use super::placed::Placed;
use crate::spatial::{Pose, Vec3};
use crate::tuning::{EVEN_EDGE, SEAM, STRAIGHT};
use std::cell::Cell;

/// What else stands there where two shapes meet, and does not move with either of them.
pub trait Others {
    /// Whether `is` says yes of any that comes near a ball, in the frame of both shapes: a solid
    /// and where it stands. It carries what it touches together with the first or the second one.
    ///
    /// - `first`: whether it stands beside the first one
    fn any(
        &self,
        first: bool,
        ball: (&Vec3, f64),
        is: &mut dyn FnMut(&Solid, &Pose) -> bool,
    ) -> bool;

    /// How much one of them may be higher than a solid beside it and still be level with it, m: as
    /// deep as what lies on them sinks into them.
    fn level(&self) -> f64;
}

/// What else stands where two shapes meet, seen from a place near these.
pub(super) struct Among<'a> {
    pub(super) others: &'a dyn Others,
    /// That place.
    pub(super) origin: Vec3,
    /// Whether the second one comes first by its rank.
    pub(super) swapped: bool,
}

impl Among<'_> {
    /// See [`Sink::goes_on`](super::sink::Sink::goes_on), of the second one by rank.
    pub(super) fn go_on(&self, x: &Vec3, sides: &[Vec3; 2]) -> bool {
        let (x, slack) = (x + self.origin, self.others.level());
        let ball = (&x, slack + 2.0 * SEAM);
        self.others.any(self.swapped, ball, &mut |other, X| {
            let back = X.inverse();
            let seen = back.point(&x);
            [[0, 1], [1, 0]].into_iter().any(|[up, wall]| {
                let [up, wall] = [up, wall].map(|i| back.R * sides[i]);
                other.level_face(&seen, &up, slack).is_some()
                    && other.holds(&(seen + wall * (2.0 * SEAM)), slack)
            })
        })
    }
}

/// A solid, and another one that lies on it or comes to it.
pub(super) struct On<'a> {
    pub(super) p: &'a Placed<'a>,
    pub(super) o: &'a Placed<'a>,
    /// Whether `p` is the first one by rank.
    first: bool,
    others: Option<&'a Among<'a>>,
    /// How high the other one is over what shuts walls of the solid and moves against it, m;
    /// infinite where nothing has been found to.
    rise: Cell<f64>,
}

impl<'a> On<'a> {
    pub(super) fn new(
        (p, o): (&'a Placed<'a>, &'a Placed<'a>),
        first: bool,
        others: Option<&'a Among<'a>>,
    ) -> Self {
        Self {
            p,
            o,
            first,
            others,
            rise: Cell::new(f64::INFINITY),
        }
    }

    /// How high the other one is over what shuts walls of the solid, as far as these have been
    /// looked at, m; below all numbers where that does not move against the solid.
    pub(super) fn rise(&self) -> f64 {
        let rise = self.rise.get();
        if rise < f64::INFINITY {
            rise
        } else {
            f64::NEG_INFINITY
        }
    }

    /// Whether nothing stands beside the solid.
    pub(super) fn is_alone(&self) -> bool {
        let solid = self.p.solid;
        self.others.is_none() && solid.beside.is_empty() && solid.across.is_empty()
    }

    /// Whether a wall is shut beside the place `x` of the solid, where the direction `d` leads out
    /// of it; both in its axes.
    pub(super) fn is_closed(&self, wall: Face, x: &Vec3, d: &Vec3) -> bool {
        let solid = self.p.solid;
        let beyond = beyond(wall, x);
        let (mut beside, mut across) = (solid.beside.iter(), solid.across.iter());
        beside.any(|other| other.holds(&beyond, SEAM))
            || across.any(|a| {
                let holds = |x: &Vec3| a.sides.iter().all(|(n, height)| n.dot(x) <= *height);
                // At a corner `d` leans to two walls.
                a.wall == wall.0
                    && a.up.dot(d) > STRAIGHT
                    && lies_on((self.p, self.o), (&a.wall, &a.up), holds)
            })
            || self.is_level_with_others(wall, x, d)
    }

    /// Whether something that moves against the solid stands against a wall of it, or behind a gap
    /// on which the other one lies, and is level with a face that `d` leads out of.
    fn is_level_with_others(&self, wall: Face, x: &Vec3, d: &Vec3) -> bool {
        let Some(Among {
            others,
            origin,
            swapped,
        }) = self.others
        else {
            return false;
        };
        let (p, slack) = (self.p, others.level());
        let wide = 2.0 * self.o.solid.reach;
        let ball = (&(p.world(x) + origin), wide + 2.0 * SEAM);
        let beyond = beyond(wall, x);
        let is_up = |(n, _): &Face| n.dot(d) > STRAIGHT && n.dot(&wall.0) < EVEN_EDGE;
        others.any(self.first != *swapped, ball, &mut |other, X| {
            // From the axes of the solid to those of the other one.
            let back = X.inverse();
            let seen = |x: &Vec3| back.point(&(p.world(x) + origin));
            p.solid.faces().filter(is_up).any(|(up, _)| {
                let out = p.R * up;
                let found = other.level_face(&seen(x), &(back.R * out), slack);
                let Some((level, over)) = found else {
                    return false;
                };
                let is_shut = other.holds(&seen(&beyond), slack)
                    || other.is_behind(&(back.R * (p.R * wall.0)), &seen(&beyond), slack)
                        && lies_on((p, self.o), (&wall.0, &up), |x| {
                            other.holds_beside(level, &seen(x))
                        });
                if is_shut {
                    let least = lowest_of(places(self.o, &out), &out) - skin(self.o);
                    let rise = least - (out.dot(&p.world(x)) - over);
                    self.rise.set(self.rise.get().min(rise));
                }
                is_shut
            })
        })
    }
}

/// Whether `o` lies with a face or a flat end on what is level with `p` behind a gap at its wall
/// `n`, and has a place that `holds` tells, in the axes of `p`.
fn lies_on(
    (p, o): (&Placed, &Placed),
    (n, up): (&Vec3, &Vec3),
    holds: impl Fn(&Vec3) -> bool,
) -> bool {
    let (n, up) = (p.R * n, p.R * up);
    let lies = |x: Vec3| holds(&p.R.tr_mul(&(x - p.p)));
    match o.core {
        Core::Box { .. } | Core::Corners(_) => {
            let least = lowest_of(places(o, &up), &up);
            let lowest = || places(o, &up).filter(|x| up.dot(x) < least + o.solid.blend);
            lowest().count() > 2 && lowest().any(lies)
        }
        // On its rim, the place that is farthest beyond the gap.
        Core::Cylinder { radius, half } => {
            let upright = o.axis().dot(&up);
            let side = |n: &Vec3| n - o.axis() * o.axis().dot(n);
            let rim = side(&n).try_normalize(STRAIGHT).unwrap_or_default() * *radius;
            let end = o.axis() * if upright > 0.0 { -half } else { *half };
            radius * side(&up).norm() < o.solid.blend && lies(o.p + end + rim)
        }
        _ => false,
    }
}

/// A place just beyond a wall.
fn beyond((n, height): Face, x: &Vec3) -> Vec3 {
    x + n * (height - n.dot(x) + 2.0 * SEAM)
}

/// What is asked of a solid beside another one, in its own axes.
impl Solid {
    /// Flat faces of a polyhedron.
    pub(super) fn faces(&self) -> impl Iterator<Item = Face> + '_ {
        let mesh = &self.mesh;
        (0..mesh.normals.len()).map(|i| {
            let n = mesh.normals[i];
            (n, n.dot(&mesh.corners[mesh.face(i)[0]]))
        })
    }

    /// Whether it is a box or a hull.
    pub(super) fn is_polyhedron(&self) -> bool {
        matches!(self.core, Core::Box { .. } | Core::Corners(_)) && !self.mesh.normals.is_empty()
    }

    /// Whether a place is inside, or not farther from it than `slack`, m. Terrain holds what is
    /// near its surface.
    pub(super) fn holds(&self, x: &Vec3, slack: f64) -> bool {
        match &self.core {
            Core::HalfSpace => x.z <= slack,
            Core::Field(field) => is_in(field, x, slack),
            Core::Surface(surface) => is_on(surface, x, slack),
            _ => self.is_polyhedron() && self.faces().all(|(n, height)| n.dot(x) <= height + slack),
        }
    }

    /// Its face with about the normal `up` that is as high as a place, 0 of what has no faces, and
    /// how far the place is over it, m.
    fn level_face(&self, x: &Vec3, up: &Vec3, slack: f64) -> Option<(usize, f64)> {
        let level = |face: usize, n: &Vec3, over: f64| {
            ((n - up).norm() < EVEN_EDGE && over.abs() <= slack).then_some((face, over))
        };
        match &self.core {
            Core::HalfSpace => level(0, &Vec3::z(), x.z),
            Core::Field(field) => {
                let (n, depth) = field.below(x)?;
                level(0, &n, -depth)
            }
            Core::Surface(surface) => {
                let mut found = None;
                surface.is_any_near(x, 2.0 * slack, |facet| {
                    if facet.apart(x).norm() <= 2.0 * slack {
                        found = level(0, &facet.normal, facet.height(x));
                    }
                    found.is_some()
                });
                found
            }
            _ => {
                let mut faces = self.faces().enumerate();
                faces.find_map(|(i, (n, height))| level(i, &n, n.dot(x) - height))
            }
        }
    }

    /// Whether all of a polyhedron lies beyond a wall with the normal `n` at a place.
    fn is_behind(&self, n: &Vec3, x: &Vec3, slack: f64) -> bool {
        let least = n.dot(x) - slack;
        self.is_polyhedron() && self.mesh.corners.iter().all(|c| n.dot(c) > least)
    }

    /// Whether a place is on the own side of all faces of a polyhedron but one.
    fn holds_beside(&self, face: usize, x: &Vec3) -> bool {
        let mut faces = self.faces().enumerate();
        faces.all(|(i, (n, height))| i == face || n.dot(x) <= height)
    }
}
