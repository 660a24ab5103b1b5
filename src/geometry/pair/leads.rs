//! Which faces of a solid a direction out of it leads out of.
//!
//! A box has no faces to which a direction leads but those that it leads out of. Of a hull half of
//! all faces lead to a side, wherever they are. Those that matter are about the place that is
//! farthest along the direction.

use super::core::Solid;
use super::placed::Face;
use crate::spatial::Vec3;
use crate::tuning::{LEAN, SEAM};

/// A face beside another one.
#[derive(Clone, Copy)]
struct Beside {
    face: Face,
    /// Along the other one to this one: of its normal what is across the normal of that. Unit.
    way: Vec3,
    /// How much of it that is.
    across: f64,
    /// How far a direction leads along the way.
    along: f64,
}

impl Solid {
    /// The faces that a direction out of it leads out of, at most three: the direction is a sum of
    /// their normals, with a positive factor of each.
    ///
    /// The normals of the faces about a corner are corners of a convex polygon on the sphere. The
    /// direction is in it, in one of the triangles between the normal that is nearest to it and two
    /// that follow each other. As seen from the first one, these are next to it on both sides.
    pub(super) fn leads(&self, d: &Vec3) -> [Option<Face>; 3] {
        let foremost = self.foremost_corner(d);
        let there = || {
            let walls = self.walls(d).enumerate();
            walls.filter_map(|(i, face)| self.is_about(foremost, (i, &face, d)).then_some(face))
        };
        let nearer = |a: &Face, b: &Face| a.0.dot(d).total_cmp(&b.0.dot(d));
        let Some(first) = there().max_by(nearer) else {
            return [None; 3];
        };
        let n = first.0;
        let rest = d - n * n.dot(d);
        let others = there().filter_map(|face| {
            let way = face.0 - n * n.dot(&face.0);
            let across = way.norm();
            let way = (across > LEAN).then(|| way / across)?;
            let along = way.dot(&rest);
            Some(Beside {
                face,
                way,
                across,
                along,
            })
        });
        let farther = |a: &Beside, b: &Beside| a.along.total_cmp(&b.along);
        let Some(second) = others.clone().max_by(farther).filter(|it| it.along > LEAN) else {
            return [Some(first), None, None];
        };
        // What the rest has across the way to the second one, and how far the others are there.
        let side = |v: &Vec3| n.dot(&second.way.cross(v));
        let beyond = side(&rest);
        let third = others.filter(|other| side(&other.way) * beyond > LEAN * beyond.abs());
        let third = third.max_by(farther).filter(|_| beyond.abs() > LEAN);
        // The rest is a sum of both ways. What their normals have of the first one is taken off.
        let beside = third.map_or(0.0, |third| beyond / side(&third.way));
        let along = second.along - third.map_or(0.0, |third| beside * third.way.dot(&second.way));
        let of = |other: &Beside, way: f64| n.dot(&other.face.0) * way / other.across;
        let own = n.dot(d) - of(&second, along) - third.map_or(0.0, |third| of(&third, beside));
        let third = third.map(|third| third.face);
        if own > LEAN {
            [Some(first), Some(second.face), third]
        } else {
            [Some(second.face), third, None]
        }
    }

    /// The faces about all places that are farthest along a direction out of a solid.
    pub(super) fn foremost(&self, d: &Vec3) -> impl Iterator<Item = Face> + '_ {
        let (mesh, d) = (&self.mesh, *d);
        let farthest = self.foremost_corner(&d);
        let far = mesh
            .corners
            .get(farthest)
            .map_or(0.0, |corner| corner.dot(&d) - SEAM);
        let is_there = move |face: usize| {
            let mut corners = mesh.face(face).iter();
            self.round.is_some() || corners.any(|i| mesh.corners[*i].dot(&d) >= far)
        };
        let faces = self.faces().enumerate();
        faces.filter_map(move |(i, face)| is_there(i).then_some(face))
    }

    /// The corner of a polyhedron that is farthest along a direction.
    fn foremost_corner(&self, d: &Vec3) -> usize {
        let corners = self.mesh.corners.iter().map(|corner| corner.dot(d));
        let farther = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
        corners.enumerate().max_by(farther).map_or(0, |it| it.0)
    }

    /// Whether a face of a polyhedron has a corner. At the rim of a cylinder, that is farthest
    /// along `d`, those meet to which that leads.
    fn is_about(&self, corner: usize, (i, (n, _), d): (usize, &Face, &Vec3)) -> bool {
        if self.round.is_some() {
            n.dot(d) > 0.0
        } else {
            self.mesh.face(i).contains(&corner)
        }
    }
}
