//! Contacts of shapes with the ground.
//!
//! Places are functions of the pose alone and move continuously with it, so that error control has
//! a smooth motion to work on: a sphere's lowest point, a capsule's two, a box's eight corners, a
//! hull's vertices, the lowest point of each rim of a cylinder. What the points of a shape do
//! together is in [`super::contact`].

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::between::{find_pairs, held_between};
use super::contact::{Contact, normal_part};
use super::gather::ContactSet;
use super::meeting::Meeting;
use super::memory::{Touch, seek};
use super::pairs::is_apart;
use super::point::{ContactPoint, Rim, norm};
use crate::geometry::Shape;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::spatial::{Pose, Vec3, Vec6, angular};
use crate::tree::{Tree, TreeCollider};
use crate::tuning::{CONTACT_MARGIN, CROWN};

/// Unit vector out of the ground, the half space below `z = 0`. Heights are read as `z`, and not as
/// products with this: half of the shapes that are looked at are far above.
const UP: Vec3 = Vec3::new(0.0, 0.0, 1.0);

/// Finds the contacts that can act within `h` seconds, into `contacts`; reads poses and velocities
/// of `kin`.
pub fn detect(
    model: &Model,
    tree: &Tree,
    touches: &[Touch],
    kin: &Kinematics,
    h: f64,
    contacts: &mut ContactSet,
) {
    contacts.clear();
    let mut remembered = touches.iter().peekable();
    let margin = 2.0 * h * h * tree.world.gravity.norm() + CONTACT_MARGIN;
    for collider in tree.on_ground() {
        let first = contacts.points.len();
        find(model, collider, kin, [h, margin], &mut contacts.points);
        if contacts.points.len() == first {
            continue;
        }
        let stored = seek(&mut remembered, collider.index, |t| t.slot);
        let stored = stored.copied().unwrap_or_default();
        let mass = tree.mass_in_impact(collider.body);
        let mut contact = Contact {
            thickness: f64::INFINITY,
            mass,
            body: collider.body,
            link: collider.link,
            slot: collider.index,
            normal: UP,
            points: first..contacts.points.len(),
            spring: collider.spring,
            ..Contact::default()
        };
        contact.gather(&mut contacts.points, &kin.V, h);
        let meet = Meeting {
            surface: &collider.ground,
            dissipation: collider.dissipation,
            gravity: -contact.normal.dot(&tree.world.gravity),
        };
        let places = (kin, &mut contacts.points[..]);
        meet.complete(tree, &stored, places, h, &mut contact);
        contacts.list.push(contact);
    }
    find_pairs(tree, touches, kin, [h, margin], contacts);
}

/// Energy that the springs of all contacts hold at the poses of `kin`, J; finds the depths of
/// `contacts`, whose points are scratch.
pub fn held(model: &Model, tree: &Tree, kin: &Kinematics, contacts: &mut ContactSet) -> f64 {
    contacts.depths.clear();
    let mut sum = held_between(tree, kin, contacts);
    let ContactSet { points, depths, .. } = contacts;
    for collider in tree.on_ground() {
        points.clear();
        find(model, collider, kin, [0.0, 0.0], points);
        if !points.is_empty() {
            let (depth, _) = norm(points, 0.0);
            depths.push((collider.index, depth));
            sum += collider.spring.stored(depth);
        }
    }
    sum
}

/// Adds the points of a shape that can touch within `h` seconds, or are nearer than `margin`, m.
fn find(
    model: &Model,
    collider: &TreeCollider,
    kin: &Kinematics,
    [h, margin]: [f64; 2],
    points: &mut Vec<ContactPoint>,
) {
    let (X_OB, V) = (&kin.X[collider.body], &kin.V[collider.body]);
    let center = X_OB.p + X_OB.R * collider.X.p;
    let height = kin.origins[collider.tree].z;
    let clearance = height + center.z - collider.radius;
    let mut finder = Finder {
        height,
        X_OB,
        center,
        V,
        h,
        margin,
        points,
    };
    if clearance >= margin && clearance >= finder.reach(collider.radius) {
        return;
    }
    finder.find(collider, &model.colliders[collider.index].shape);
}

/// Whether nothing comes near the ground, or something else, within `h` seconds, by twice the way
/// that velocities and gravity take it; reads poses and velocities of `kin`.
pub fn is_clear(tree: &Tree, kin: &Kinematics, h: f64) -> bool {
    let fall = 2.0 * h * h * tree.world.gravity.norm();
    let above = tree.on_ground().all(|collider| {
        let (center, speed) = kin.ball(collider);
        let clearance = kin.origins[collider.tree].z + center.z - collider.radius;
        clearance > 2.0 * h * speed + fall + 2.0 * CONTACT_MARGIN
    });
    above && (tree.contact.pairs.is_empty() || is_apart(tree, kin, h))
}

/// Finds the points of one shape.
struct Finder<'a> {
    /// Height of O, m.
    height: f64,
    /// Pose of the body from O, and the shape's centre.
    X_OB: &'a Pose,
    center: Vec3,
    /// Spatial velocity of its body.
    V: &'a Vec6,
    h: f64,
    /// Gap below which a point takes part whatever its velocity, m.
    margin: f64,
    points: &'a mut Vec<ContactPoint>,
}

impl Finder<'_> {
    fn find(&mut self, collider: &TreeCollider, shape: &Shape) {
        let (center, R_OB) = (self.center, &self.X_OB.R);
        let R_BG = &collider.X.R;
        match shape {
            Shape::Sphere { radius } => self.add(0, center - UP * *radius, 1.0),
            Shape::Capsule {
                radius,
                half_length,
            } => {
                let axis = R_OB * R_BG.column(2) * *half_length;
                self.add(0, center + axis - UP * *radius, 0.5);
                self.add(1, center - axis - UP * *radius, 0.5);
            }
            Shape::Box { half } => {
                let R = R_OB * R_BG;
                let down = R.row(2).abs() * half;
                let clearance = self.height + center.z - down.x;
                // What rounding does to corners is far below a margin.
                if clearance > self.reach(collider.radius) + CONTACT_MARGIN {
                    return;
                }
                let (x, y, z) = (
                    R.column(0) * half.x,
                    R.column(1) * half.y,
                    R.column(2) * half.z,
                );
                for corner in 0..8 {
                    let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
                    self.add(
                        corner,
                        center + x * sign(1) + y * sign(2) + z * sign(4),
                        0.25,
                    );
                }
            }
            Shape::Hull { vertices } => {
                let R = R_OB * R_BG;
                // Down seen from the mesh: one dot product tells a vertex's height.
                let down = R.transpose() * -UP;
                let base = self.height + center.z;
                let spin = angular(self.V).norm();
                let speed = rise(self.V, &center).abs() + spin * collider.radius;
                let reach = self.h * speed + self.margin;
                for (i, vertex) in vertices.iter().enumerate() {
                    if base - down.dot(vertex) < reach {
                        self.add(i, center + R * vertex, collider.faces.share(i, &down));
                    }
                }
            }
            Shape::Cylinder {
                radius,
                half_length,
            } => {
                let up = R_OB * R_BG.column(2);
                for (end, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let axis = up * sign;
                    let c = center + axis * *half_length;
                    self.add_rim(end, (c, axis), [*radius, collider.spring.reference]);
                }
            }
            // Terrain never moves.
            Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => {}
        }
    }

    /// Height below which a point of a ball of `radius` about the centre can touch within the step,
    /// m.
    #[inline]
    fn reach(&self, radius: f64) -> f64 {
        let mut reach = self.margin;
        if self.h > 0.0 {
            let V = self.V;
            let spin = V[0].abs() + V[1].abs() + V[2].abs();
            reach += self.h * (rise(V, &self.center).abs() + spin * radius);
        }
        reach
    }

    /// Takes the point at `x` (from O) into the list if it can touch within the step.
    #[inline]
    fn add(&mut self, corner: usize, x: Vec3, share: f64) {
        let depth = -self.height - x.z;
        if self.reaches(depth, &x) {
            let point = ContactPoint::new(Some(corner), x, &UP, [depth, share]);
            self.points.push(point);
        }
    }

    /// The same for the lowest point of the rim of radius `R` with the centre `c` (from O) and the
    /// axis `k`, outwards, of a contact that is some `landing` deep. The share of a rim is that of
    /// one of the two on which a cylinder lies.
    fn add_rim(&mut self, corner: usize, (c, k): (Vec3, Vec3), [R, landing]: [f64; 2]) {
        let (up, across) = normal_part(&UP, &k);
        let crown = CROWN * R;
        // So that a lying cylinder, whose `q` is `√(R² + s²)`, reaches down by its own radius.
        let R = (R * (R + 2.0 * crown)).sqrt();
        let rim = Rim::new(k, across * R, [R, crown, landing]);
        let x = c + rim.direction() * (R * up) - UP * rim.lowest();
        let depth = -self.height - c.z + rim.lowest();
        if self.reaches(depth, &x) {
            self.points.push(ContactPoint {
                rim: Some(rim),
                ..ContactPoint::new(Some(corner), x, &UP, [depth, 0.5])
            });
        }
    }

    /// Whether a point can touch within the step.
    #[inline]
    fn reaches(&self, depth: f64, x: &Vec3) -> bool {
        let mut reach = self.margin;
        if self.h > 0.0 {
            reach += self.h * rise(self.V, x).abs();
        }
        -depth < reach
    }
}

/// Speed upwards, m/s, of the body point at `x` from O.
#[inline]
fn rise(V: &Vec6, x: &Vec3) -> f64 {
    V[5] + V[0] * x.y - V[1] * x.x
}
