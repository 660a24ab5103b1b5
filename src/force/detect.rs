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
use super::meeting::{Meeting, limited};
use super::memory::{Touch, seek};
use super::pairs::is_apart;
use super::point::{ContactPoint, Rim, norm};
use crate::geometry::Shape;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::spatial::{Mat3, Vec3, Vec6, angular, velocity_at};
use crate::tree::{Tree, TreeCollider};
use crate::tuning::{CONTACT_MARGIN, CROWN};

/// The half space `normal·x < offset` is solid.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Unit vector out of the ground, world axes.
    pub normal: Vec3,
    /// m
    pub offset: f64,
}

impl Plane {
    /// `z = 0`.
    pub const GROUND: Self = Self {
        normal: Vec3::new(0.0, 0.0, 1.0),
        offset: 0.0,
    };
}

/// Finds the contacts that can act within `h` seconds, into `contacts`; reads poses and velocities
/// of `kin`.
///
/// `fastest` caps how fast a contact may swing under its tree (fixed steps cannot resolve more),
/// rad/s.
pub fn detect(
    model: &Model,
    tree: &Tree,
    touches: &[Touch],
    kin: &Kinematics,
    h: f64,
    fastest: f64,
    contacts: &mut ContactSet,
) {
    contacts.clear();
    let plane = Plane::GROUND;
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
        let mass = tree.mass_with(collider.body);
        let mut contact = Contact {
            thickness: f64::INFINITY,
            mass,
            body: collider.body,
            link: collider.link,
            slot: collider.index,
            normal: plane.normal,
            points: first..contacts.points.len(),
            spring: limited(&collider.spring, mass, fastest),
            ..Contact::default()
        };
        contact.gather(&mut contacts.points);
        let meet = Meeting {
            surface: &collider.ground,
            dissipation: collider.dissipation,
            gravity: -contact.normal.dot(&tree.world.gravity),
        };
        meet.complete(tree, &stored, (kin, &contacts.points), &mut contact);
        contacts.list.push(contact);
    }
    find_pairs(tree, touches, kin, [h, margin], fastest, contacts);
}

/// Energy that the springs of all contacts hold at the poses of `kin`, J. The points of `contacts`
/// are scratch; `fastest` is that of [`detect`].
pub fn held(
    model: &Model,
    tree: &Tree,
    kin: &Kinematics,
    fastest: f64,
    contacts: &mut ContactSet,
) -> f64 {
    let mut sum = held_between(tree, kin, fastest, contacts);
    let points = &mut contacts.points;
    for collider in tree.on_ground() {
        points.clear();
        find(model, collider, kin, [0.0, 0.0], points);
        if !points.is_empty() {
            let (depth, _) = norm(points);
            let mass = tree.mass_with(collider.body);
            sum += limited(&collider.spring, mass, fastest).stored(depth);
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
    let plane = Plane::GROUND;
    let (X_OB, V) = (&kin.X[collider.body], &kin.V[collider.body]);
    let center = X_OB.p + X_OB.R * collider.X.p;
    // Height of O over the plane, and of the shape.
    let origin = &kin.origins[collider.tree];
    let height = plane.normal.dot(origin) - plane.offset;
    let clearance = height + plane.normal.dot(&center) - collider.radius;
    let mut reach = margin;
    if h > 0.0 {
        let spin = V[0].abs() + V[1].abs() + V[2].abs();
        let speed = plane.normal.dot(&velocity_at(V, &center)).abs() + spin * collider.radius;
        reach += h * speed;
    }
    if clearance >= reach {
        return;
    }
    let mut finder = Finder {
        plane,
        height,
        R: X_OB.R * collider.X.R,
        center,
        V,
        h,
        margin,
        points,
    };
    finder.find(collider, &model.colliders[collider.index].shape);
}

/// Whether nothing comes near the ground, or something else, within `h` seconds, by twice the way
/// that velocities and gravity take it; reads poses and velocities of `kin`.
pub fn is_clear(tree: &Tree, kin: &Kinematics, h: f64) -> bool {
    let plane = Plane::GROUND;
    let fall = 2.0 * h * h * tree.world.gravity.norm();
    let above = tree.on_ground().all(|collider| {
        let (center, speed) = kin.ball(collider);
        let height = plane.normal.dot(&kin.origins[collider.tree]) - plane.offset;
        let clearance = height + plane.normal.dot(&center) - collider.radius;
        clearance > 2.0 * h * speed + fall + 2.0 * CONTACT_MARGIN
    });
    above && (tree.contact.pairs.is_empty() || is_apart(tree, kin, h))
}

/// Finds the points of one shape.
struct Finder<'a> {
    plane: Plane,
    /// Height of O, m.
    height: f64,
    /// Axes of the shape, and its centre from O.
    R: Mat3,
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
        let n = self.plane.normal;
        let center = self.center;
        match shape {
            Shape::Sphere { radius } => self.add(0, center - n * *radius, 1.0),
            Shape::Capsule {
                radius,
                half_length,
            } => {
                let axis = self.R.column(2) * *half_length;
                self.add(0, center + axis - n * *radius, 0.5);
                self.add(1, center - axis - n * *radius, 0.5);
            }
            Shape::Box { half } => {
                let (x, y, z) = (
                    self.R.column(0) * half.x,
                    self.R.column(1) * half.y,
                    self.R.column(2) * half.z,
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
                // The plane's normal seen from the mesh: one dot product tells a vertex's height.
                let down = self.R.transpose() * -n;
                let base = self.height + n.dot(&center);
                let spin = angular(self.V).norm();
                let speed = n.dot(&velocity_at(self.V, &center)).abs() + spin * collider.radius;
                let reach = self.h * speed + self.margin;
                for (i, vertex) in vertices.iter().enumerate() {
                    if base - down.dot(vertex) < reach {
                        self.add(i, center + self.R * vertex, collider.faces.share(i, &down));
                    }
                }
            }
            Shape::Cylinder {
                radius,
                half_length,
            } => {
                for (end, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let axis = self.R.column(2) * sign;
                    let c = center + axis * *half_length;
                    self.add_rim(end, (c, axis), [*radius, collider.spring.reference]);
                }
            }
            // Terrain never moves.
            Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => {}
        }
    }

    /// Takes the point at `x` (from O) into the list if it can touch within the step.
    #[inline]
    fn add(&mut self, corner: usize, x: Vec3, share: f64) {
        let depth = -self.height - self.plane.normal.dot(&x);
        if self.reaches(depth, &x) {
            let point = ContactPoint::new(Some(corner), x, &self.plane.normal, [depth, share]);
            self.points.push(point);
        }
    }

    /// The same for the lowest point of the rim of radius `R` with the centre `c` (from O) and the
    /// axis `k`, outwards, of a contact that is some `landing` deep. The share of a rim is that of
    /// one of the two on which a cylinder lies.
    fn add_rim(&mut self, corner: usize, (c, k): (Vec3, Vec3), [R, landing]: [f64; 2]) {
        let n = self.plane.normal;
        let (up, across) = normal_part(&n, &k);
        let crown = CROWN * R;
        // So that a lying cylinder, whose `q` is `√(R² + s²)`, reaches down by its own radius.
        let R = (R * (R + 2.0 * crown)).sqrt();
        let rim = Rim::new(k, across * R, [R, crown, landing]);
        let x = c + rim.direction() * (R * up) - n * rim.lowest();
        let depth = -self.height - n.dot(&c) + rim.lowest();
        if self.reaches(depth, &x) {
            self.points.push(ContactPoint {
                rim: Some(rim),
                ..ContactPoint::new(Some(corner), x, &n, [depth, 0.5])
            });
        }
    }

    /// Whether a point can touch within the step.
    #[inline]
    fn reaches(&self, depth: f64, x: &Vec3) -> bool {
        let mut reach = self.margin;
        if self.h > 0.0 {
            reach += self.h * self.plane.normal.dot(&velocity_at(self.V, x)).abs();
        }
        -depth < reach
    }
}
