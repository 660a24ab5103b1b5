//! Which walls of a solid are shut, so that nothing can come against them, and which face is all of
//! it that what lies on something beside it can come against.
//!
//! A wall is shut where something stands against it. What lies on something that is level with a
//! face of the solid, with a gap between both, cannot come down beside it: it is over all of it.
//!
//! Both are looked for at each query, whether it moves against the solid or stands still
//! as it does. What moves may come apart from it, and something get between the two, a wedge that
//! lifts a block off its table. So that shuts a wall only where it goes on level with a face of the
//! solid: over such a joint there is nothing to get between. Each of them has sunk by its own
//! weight into what carries it, so that they are level but for such depths.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::{Core, Solid};
use super::lowest::{lowest_of, places, skin};
use super::placed::{Face, Placed};
use super::polygon::Polygon;
use crate::spatial::{Pose, Vec3};
use crate::tuning::{EVEN_EDGE, SEAM, STRAIGHT};
use std::cell::Cell;

/// What else stands there where two shapes meet, and does not move with either of them.
pub trait Others {
    /// Whether `is` says yes of any that comes near a ball, in the frame of both shapes: a solid,
    /// where it stands, and whether it never moves against the one that it stands beside. It
    /// carries what it touches together with the first or the second one.
    ///
    /// - `first`: whether it stands beside the first one
    fn any(
        &self,
        first: bool,
        ball: (&Vec3, f64),
        is: &mut dyn FnMut(&Solid, &Pose, bool) -> bool,
    ) -> bool;

    /// Whether the first one yields, and the second one, on which it lies, does not.
    fn carries(&self) -> bool;

    /// Whether `is` says yes of any of them that does not yield and comes near a ball, in the frame
    /// of both shapes: what carries the first one together with the second one.
    fn any_that_carries(
        &self,
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
        let ball = (&x, 2.0 * slack);
        self.others.any(self.swapped, ball, &mut |other, X, _| {
            let back = X.inverse();
            let seen = back.point(&x);
            [[0, 1], [1, 0]].into_iter().any(|[up, wall]| {
                let [up, wall] = [up, wall].map(|i| back.R * sides[i]);
                other.level_face(&seen, &up, slack).is_some()
                    && other.holds(&(seen + (wall - up) * slack), slack)
            })
        })
    }
}

impl Among<'_> {
    /// Whether anything near a ball carries the first shape together with the second one.
    pub(super) fn carry_near(&self, (center, radius): (&Vec3, f64)) -> bool {
        let ball = (&(center + self.origin), radius);
        self.others.carries() && self.others.any_that_carries(ball, &mut |_, _| true)
    }

    /// All that carries the first shape together with the second one and comes near a ball, with a
    /// face that is level with one of the second one: that is given by a place and its normal. Of
    /// each the solid, its face and where it stands.
    pub(super) fn each_level(
        &self,
        (place, up): (&Vec3, &Vec3),
        (center, radius): (&Vec3, f64),
        each: &mut dyn FnMut(&Solid, usize, &Pose),
    ) {
        let slack = self.others.level();
        let ball = (&(center + self.origin), radius);
        self.others.any_that_carries(ball, &mut |solid, X| {
            let seen = Pose {
                p: X.p - self.origin,
                ..*X
            };
            let back = seen.inverse();
            let found = solid.level_face(&back.point(place), &(back.R * up), slack);
            if let Some((face, _)) = found.filter(|_| solid.has_faces()) {
                each(solid, face, &seen);
            }
            false
        });
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
        self.others.is_none()
    }

    /// A place within some faces of the solid near its edge at `x`, in its axes: by so much as
    /// things that are level with each other may be apart, or one of them higher.
    pub(super) fn within(&self, x: &Vec3, faces: [Option<Face>; 3]) -> Vec3 {
        let depth = self.others.map_or(0.0, |among| among.others.level());
        faces.iter().flatten().fold(*x, |x, (n, height)| {
            x - n * (n.dot(&x) - (height - depth)).max(0.0)
        })
    }

    /// Whether a wall is shut beside the place `x` of the solid, where the direction `d` leads out
    /// of it; both in its axes.
    ///
    /// - `within`: see [`Self::within`], of the direction before any wall was found to be shut
    pub(super) fn is_closed(&self, wall: Face, (x, within): (&Vec3, &Vec3), d: &Vec3) -> bool {
        let Some(Among {
            others,
            origin,
            swapped,
        }) = self.others
        else {
            return false;
        };
        let (p, slack) = (self.p, others.level());
        let first = self.first != *swapped;
        let place = p.world(x) + origin;
        let beyond = within + wall.0 * (wall.1 + slack - wall.0.dot(within));
        let beyond = p.world(&beyond) + origin;
        let covers = |other: &Solid, X: &Pose, stays: bool| {
            let holds = other.holds(&X.inverse().point(&beyond), slack);
            if stays || !holds {
                return holds;
            }
            let faces = p.solid.leads(d);
            let mut ups = faces
                .iter()
                .flatten()
                .filter(|(n, _)| is_edge((n, d), wall));
            let top = ups.find_map(|(up, _)| self.level((other, X), (x, up)));
            if let Some((_, top)) = top {
                self.rises(top);
            }
            top.is_some()
        };
        others.any(first, (&place, 2.0 * slack), &mut { covers })
    }

    /// The face of the solid on which the other one lies flat, while it lies on something else that
    /// is level with it, too, with a gap between both or without: it is over all of the solid then,
    /// and its edge comes against nothing of that but this face. In the axes of the solid.
    ///
    /// - `x`, `d`: where it is that it comes to the solid, and the direction that leads there
    pub(super) fn flat(&self, x: &Vec3, d: &Vec3) -> Option<Face> {
        let Among {
            others,
            origin,
            swapped,
        } = self.others?;
        let (p, o, slack) = (self.p, self.o, others.level());
        let first = self.first != *swapped;
        let under = (&(o.p + origin), o.solid.reach + slack);
        // The place of the other one that comes to the solid is an edge of the face that lies on
        // it, or of a broken edge beside that face.
        let foremost = o.solid.foremost(&o.R.tr_mul(&(p.R * -d)));
        let mut ups = foremost.filter_map(|(down, _)| {
            let against = p.R.tr_mul(&(o.R * down));
            let steep = |a: &Face, b: &Face| a.0.dot(&against).total_cmp(&b.0.dot(&against));
            let up = p.solid.faces().min_by(steep)?;
            (up.0.dot(d) > STRAIGHT).then_some(up)
        });
        ups.find(|up| {
            if self.flat_on(p.face(*up), slack).is_none() {
                return false;
            }
            let x = x + up.0 * (up.1 - up.0.dot(x));
            others.any(first, under, &mut |other, X, stays| {
                let Some((face, top)) = self.level((other, X), (&x, &up.0)) else {
                    return false;
                };
                let beside = Placed::new(other, X, origin);
                let lies = other.has_faces() && self.lies_on(top, beside.sides(face));
                if lies && !stays {
                    self.rises(top);
                }
                lies
            })
        })
    }

    /// Whether the other one lies flat on a face of the solid.
    pub(super) fn is_flat_on(&self, face: Face) -> bool {
        let slack = self.others.map_or(0.0, |among| among.others.level());
        self.flat_on(self.p.face(face), slack).is_some()
    }

    /// The face of another one that is level with a face of the solid, and where it is along the
    /// normal of that.
    ///
    /// - `x`, `up`: a place on the face of the solid, and its normal
    fn level(&self, (other, X): (&Solid, &Pose), (x, up): (&Vec3, &Vec3)) -> Option<(usize, Face)> {
        let Among { others, origin, .. } = self.others?;
        let (place, back, out) = (self.p.world(x), X.inverse(), self.p.R * up);
        let seen = back.point(&(place + origin));
        let (face, over) = other.level_face(&seen, &(back.R * out), others.level())?;
        Some((face, (out, out.dot(&place) - over)))
    }

    /// Notes how high the other one is over a face of what moves against the solid.
    fn rises(&self, (up, height): Face) {
        let least = lowest_of(places(self.o, &up), &up) - skin(self.o);
        self.rise.set(self.rise.get().min(least - height));
    }

    /// The corners of the face of the other one that is turned most against the normal of a face,
    /// where it lies flat at its height, or no farther from it than `slack`, m.
    fn flat_on(
        &self,
        (up, height): Face,
        slack: f64,
    ) -> Option<impl Iterator<Item = Vec3> + Clone + '_> {
        let (o, mesh) = (self.o, &self.o.solid.mesh);
        let down = o.R.tr_mul(&-up);
        let steep = |a: &usize, b: &usize| {
            let [a, b] = [a, b].map(|i| mesh.normals[*i].dot(&down));
            a.total_cmp(&b)
        };
        let lowest = (0..mesh.normals.len()).max_by(steep)?;
        let corners = mesh.face(lowest).iter().map(|i| o.world(&mesh.corners[*i]));
        let near = |x: Vec3| (up.dot(&x) - height).abs() <= o.solid.blend + slack;
        corners.clone().all(near).then_some(corners)
    }

    /// Whether the other one lies with a part of a face or of a flat end on a face within these
    /// sides of it. A part that is no wider than they sink in may be what it has sunk in beside it.
    fn lies_on(&self, (up, height): Face, sides: impl Iterator<Item = Face>) -> bool {
        let slack = self.others.map_or(0.0, |among| among.others.level());
        let Some(corners) = self.flat_on((up, height), 0.0) else {
            return false;
        };
        let (mut one, mut two) = (Polygon::NONE, Polygon::NONE);
        one.take(corners);
        for (n, height) in sides {
            two.cut(&one, |x| height - slack - n.dot(x));
            std::mem::swap(&mut one, &mut two);
        }
        one.has_area()
    }
}

/// Whether over a wall the direction `d` leads out of a face with the normal `up`, too.
fn is_edge((up, d): (&Vec3, &Vec3), wall: Face) -> bool {
    up.dot(d) > STRAIGHT && (up - wall.0).norm() >= EVEN_EDGE
}

/// What is asked of a solid beside another one, in its own axes.
impl Solid {
    /// Flat faces of a polyhedron, and the ends of a cylinder.
    pub(super) fn faces(&self) -> impl Iterator<Item = Face> + Clone + '_ {
        let mesh = &self.mesh;
        (0..mesh.normals.len()).map(|i| {
            let n = mesh.normals[i];
            (n, n.dot(&mesh.corners[mesh.face(i)[0]]))
        })
    }

    /// All flat faces, and of a cylinder the wall at which a direction leads out of it.
    pub(super) fn walls(&self, out: &Vec3) -> impl Iterator<Item = Face> + Clone + '_ {
        let side = Vec3::new(out.x, out.y, 0.0).try_normalize(f64::MIN_POSITIVE);
        let round = self.round.filter(|round| round.flat);
        let wall = round.and_then(|round| Some((side?, round.radius)));
        self.faces().chain(wall)
    }

    /// Walls that are upright on a face, along its edges.
    pub(super) fn sides(&self, face: usize) -> impl Iterator<Item = Face> + '_ {
        let (up, corners) = (self.mesh.normals[face], self.mesh.face(face));
        let ends = corners.iter().zip(corners.iter().cycle().skip(1));
        ends.filter_map(move |(&a, &b)| {
            let [a, b] = [a, b].map(|i| self.mesh.corners[i]);
            let n = (b - a).cross(&up).try_normalize(f64::MIN_POSITIVE)?;
            Some((n, n.dot(&a)))
        })
    }

    /// Whether it has flat faces: a box, a hull or a cylinder.
    pub(super) fn has_faces(&self) -> bool {
        !self.mesh.normals.is_empty()
    }

    /// Whether it is a box or a hull.
    pub(super) fn is_polyhedron(&self) -> bool {
        matches!(self.core, Core::Box { .. } | Core::Corners(_)) && self.has_faces()
    }

    /// Whether a place is inside. Terrain of triangles holds what is no deeper than `deep` behind
    /// them, m.
    fn holds(&self, x: &Vec3, deep: f64) -> bool {
        match &self.core {
            Core::HalfSpace => x.z <= SEAM,
            Core::Field(field) => {
                field.is_over(x) && field.below(x).is_some_and(|(_, depth)| depth >= -SEAM)
            }
            Core::Surface(surface) => surface.is_any_near(x, 2.0 * deep, |facet| {
                facet.height(x) <= SEAM && facet.apart(x).norm() <= 2.0 * deep
            }),
            _ => self.is_polyhedron() && self.faces().all(|(n, height)| n.dot(x) <= height + SEAM),
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
}

#[cfg(test)]
mod tests;
