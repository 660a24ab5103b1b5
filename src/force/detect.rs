//! Contact points of shapes against the ground, with stable slots.
//!
//! Points are functions of the pose alone and move continuously with it, so that error control has
//! a smooth motion to work on: a sphere's lowest point, a capsule's two, a box's eight corners, a
//! hull's vertices, three points on the lowest generatrix of a cylinder (its ends and its middle,
//! weighted like Simpson's rule for a uniform line pressure) that fade into four fixed points on
//! each rim as the cylinder stands up. A rolling cylinder or sphere is exactly round.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, normal_part};
use super::memory::Touch;
use crate::geometry::Shape;
use crate::kinematics::Kinematics;
use crate::law::{ElastoPlastic, HuntCrossley, stribeck};
use crate::model::Model;
use crate::spatial::{Pose, Vec3, Vec6, velocity_at};
use crate::tree::{Tree, TreeCollider};
use crate::tuning::{
    BOUNCE_THRESHOLD, CONTACT_MARGIN, DEEP_OVERLAP, EMERGENCE, FADE, LEAST_FLAT, TANGENTIAL_RATIO,
};

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

/// Finds the points that can touch within `h` seconds, into `contacts`; reads poses and velocities
/// of `kin`.
///
/// `stiffness_limit` caps the stiffness of a point (fixed steps cannot resolve more), N/m.
pub fn detect(
    model: &Model,
    tree: &Tree,
    touches: &[Touch],
    kin: &Kinematics,
    h: f64,
    stiffness_limit: f64,
    contacts: &mut Vec<Contact>,
) {
    contacts.clear();
    if tree.contact.colliders.is_empty() {
        return;
    }
    let plane = Plane::GROUND;
    let g = tree.world.gravity.norm();
    let mut finder = Finder {
        tree,
        touches,
        plane,
        // Height of O over the plane.
        height: plane.normal.dot(&kin.origin) - plane.offset,
        h,
        fall: 2.0 * h * h * g,
        stiffness_limit,
        nominal: 0.0,
        stiffness: 0.0,
        damping: 0.0,
        gravity: g,
        contacts,
    };
    for collider in &tree.contact.colliders {
        let index = collider.index;
        let (X_OB, V) = (&kin.X[collider.body], &kin.V[collider.body]);
        let center = X_OB.p + X_OB.R * collider.X.p;
        let clearance = finder.height + plane.normal.dot(&center) - collider.radius;
        let spin = V[0].abs() + V[1].abs() + V[2].abs();
        let speed = plane.normal.dot(&velocity_at(V, &center)).abs() + spin * collider.radius;
        let reach = h * speed + finder.fall + CONTACT_MARGIN;
        if clearance < reach {
            finder.soften(collider.stiffness);
            let shape = &model.colliders[index];
            finder.points(collider, &shape.shape, shape.slot, X_OB, &center, V, reach);
        }
    }
}

/// Whether nothing comes near the ground within `h` seconds, by twice the way that velocities and
/// gravity take it; reads poses and velocities of `kin`.
pub fn is_clear(tree: &Tree, kin: &Kinematics, h: f64) -> bool {
    let plane = Plane::GROUND;
    let height = plane.normal.dot(&kin.origin) - plane.offset;
    let fall = 2.0 * h * h * tree.world.gravity.norm();
    tree.contact.colliders.iter().all(|collider| {
        let (X_OB, V) = (&kin.X[collider.body], &kin.V[collider.body]);
        let center = X_OB.p + X_OB.R * collider.X.p;
        let clearance = height + plane.normal.dot(&center) - collider.radius;
        let spin = V[0].abs() + V[1].abs() + V[2].abs();
        let speed = velocity_at(V, &center).norm() + spin * collider.radius;
        clearance > 2.0 * h * speed + fall + 2.0 * CONTACT_MARGIN
    })
}

struct Finder<'a> {
    tree: &'a Tree,
    /// What is left of the stored touches: points are found by ascending slot.
    touches: &'a [Touch],
    plane: Plane,
    height: f64,
    h: f64,
    fall: f64,
    stiffness_limit: f64,
    /// Stiffness of a point of the present link, N/m, before and after the limit.
    nominal: f64,
    stiffness: f64,
    /// Damping of its sticking friction, N·s/m.
    damping: f64,
    gravity: f64,
    contacts: &'a mut Vec<Contact>,
}

impl Finder<'_> {
    /// Takes over a link's stiffness, N/m.
    #[inline]
    fn soften(&mut self, nominal: f64) {
        #[expect(clippy::float_cmp, reason = "nearly all links have the same")]
        if nominal != self.nominal {
            self.nominal = nominal;
            self.stiffness = nominal.min(self.stiffness_limit);
            let mass = 0.25 * self.tree.moving_mass();
            self.damping = 2.0 * (TANGENTIAL_RATIO * self.stiffness * mass).sqrt();
        }
    }

    #[expect(clippy::too_many_arguments, reason = "one shape's place, spelled out")]
    fn points(
        &mut self,
        collider: &TreeCollider,
        shape: &Shape,
        slot: usize,
        X_OB: &Pose,
        center: &Vec3,
        V: &Vec6,
        reach: f64,
    ) {
        let n = self.plane.normal;
        match shape {
            Shape::Sphere { radius } => {
                self.add(collider, V, center - n * *radius, 1.0, slot);
            }
            Shape::Capsule {
                radius,
                half_length,
            } => {
                let axis = X_OB.R * collider.X.R.column(2) * *half_length;
                self.add(collider, V, center + axis - n * *radius, 1.0, slot);
                self.add(collider, V, center - axis - n * *radius, 1.0, slot + 1);
            }
            Shape::Box { half } => {
                let local = collider.X.R.transpose() * (X_OB.R.transpose() * n);
                let lowest = self.height + n.dot(center) - shape.depth(&local);
                if lowest >= reach {
                    return;
                }
                let R = X_OB.R * collider.X.R;
                let (x, y, z) = (
                    R.column(0) * half.x,
                    R.column(1) * half.y,
                    R.column(2) * half.z,
                );
                for corner in 0..8 {
                    let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
                    let point = center + x * sign(1) + y * sign(2) + z * sign(4);
                    if self.height + n.dot(&point) < reach {
                        self.add(collider, V, point, 1.0, slot + corner);
                    }
                }
            }
            Shape::Hull { vertices } => {
                let R = X_OB.R * collider.X.R;
                // The plane's normal seen from the mesh: one dot product tells a vertex's height.
                let local = R.transpose() * n;
                let base = self.height + n.dot(center);
                for (i, vertex) in vertices.iter().enumerate() {
                    if base + local.dot(vertex) < reach {
                        self.add(collider, V, center + R * vertex, 1.0, slot + i);
                    }
                }
            }
            Shape::Cylinder {
                radius,
                half_length,
            } => {
                self.cylinder(collider, V, X_OB, center, (*radius, *half_length), slot);
            }
        }
    }

    /// Points of a cylinder with the unit axis `a` and the radius `r` on a plane with the normal
    /// `n`.
    ///
    /// 1. Lying, it touches along its lowest generatrix, which runs through the centre plus `−r m`,
    ///    with `m = (n − (n·a) a)/|n − (n·a) a|` (`down` is `r m`). A uniform pressure on the line
    ///    is what three points at its ends and its middle make of it with the weights 1/3, 4/3 and
    ///    1/3 (Simpson's rule, exact up to cubic depths; the sum is that of two points).
    /// 2. Standing, it touches with four fixed points on the lower rim (`spokes`), with the weight
    ///    1 each.
    /// 3. Between two tilts the one fades into the other. With `c = |n·a|` (`along`) and `FADE =
    ///    (c₀, c₁)`, the rims have the share `s = ρ² (3 − 2 ρ)` (`standing`), where `ρ = (c −
    ///    c₀)/(c₁ − c₀)` (`rise`), and the line has `1 − s`: both are smooth where fading begins
    ///    and ends.
    /// 4. The share changes as the axis turns: `ds/dc = 6 ρ (1 − ρ)/(c₁ − c₀)` (`steepness`). A
    ///    share `w` of a spring with the stiffness `k` and the depth `d` holds `E = ½ w k d²`, and
    ///    its force must be minus the gradient of that, `−w k d ∂d − ½ k d² ∂w`: else tilting the
    ///    cylinder to and fro would make energy.
    /// 5. Turning the body by `δθ` changes `n·a` by `n·(δθ × a) = δθ·(a × n)`, so that the second
    ///    part of the force is a moment. A force `F = w k d` along `n` that acts beside its point
    ///    by `l` gives the moment `l × F n`. With `l = λ (a − (n·a) n)`, which lies in the plane,
    ///    this is `λ F a × n`, and `λ F = −½ k d² ∂w/∂(n·a)` gives `λ = −d/(2 w) ∂w/∂(n·a)`.
    /// 6. For the rims `w = s`, for the line `w = 1 − s` (Simpson's weights cancel). With the
    ///    vector `rising = −½ ds/d(n·a) (a − (n·a) n)`, per metre of depth, the points lie
    ///    `rising/s` and `−rising/(1 − s)` beside their places (`lean`).
    ///
    /// Test: `the_springs_of_a_cylinder_do_the_work_of_their_energy_at_every_tilt`.
    fn cylinder(
        &mut self,
        collider: &TreeCollider,
        V: &Vec6,
        X_OB: &Pose,
        center: &Vec3,
        (radius, half_length): (f64, f64),
        slot: usize,
    ) {
        let n = self.plane.normal;
        let axis = X_OB.R * collider.X.R.column(2);
        let along = n.dot(&axis);
        let rise = ((along.abs() - FADE.0) / (FADE.1 - FADE.0)).clamp(0.0, 1.0);
        let standing = rise * rise * (3.0 - 2.0 * rise);
        let steepness = 6.0 * rise * (1.0 - rise) / (FADE.1 - FADE.0);
        let rising = (axis - n * along) * (-0.5 * steepness.copysign(along));
        if standing < 1.0 {
            let across = n - axis * along;
            let down = across * (radius / across.norm());
            let end = axis * half_length;
            let line = 1.0 - standing;
            let lean = rising * (-1.0 / line);
            self.add_leaning(collider, V, center + end - down, line / 3.0, lean, slot);
            self.add_leaning(collider, V, center - end - down, line / 3.0, lean, slot + 1);
            self.add_leaning(collider, V, center - down, line * 4.0 / 3.0, lean, slot + 2);
        }
        if standing > 0.0 {
            let R = X_OB.R * collider.X.R;
            let (x, y) = (R.column(0) * radius, R.column(1) * radius);
            let lean = rising / standing;
            let rims = [axis * half_length, axis * -half_length];
            for (rim, end) in rims.iter().enumerate() {
                let spokes = [x, y, -x, -y];
                for (k, spoke) in spokes.iter().enumerate() {
                    let point = center + end + spoke;
                    self.add_leaning(collider, V, point, standing, lean, slot + 3 + 4 * rim + k);
                }
            }
        }
    }

    /// Takes the point at `x` (from O) into the list if it can touch within the step; `share`
    /// weights its stiffness.
    #[inline]
    fn add(&mut self, collider: &TreeCollider, V: &Vec6, x: Vec3, share: f64, slot: usize) {
        self.add_leaning(collider, V, x, share, Vec3::zeros(), slot);
    }

    /// The same for a point whose share changes with the tilt: its force acts beside the point, see
    /// [`Self::cylinder`].
    ///
    /// - `lean`: how far beside it, per metre of depth
    #[inline]
    fn add_leaning(
        &mut self,
        collider: &TreeCollider,
        V: &Vec6,
        x: Vec3,
        share: f64,
        lean: Vec3,
        slot: usize,
    ) {
        let normal = self.plane.normal;
        let gap = self.height + normal.dot(&x);
        let v = velocity_at(V, &x);
        let (vn, u) = normal_part(&normal, &v);
        if gap >= self.h * vn.abs() + self.fall + CONTACT_MARGIN {
            return;
        }
        let stiffness = self.stiffness * share;
        let mut contact = Contact {
            body: collider.body,
            link: collider.link,
            slot,
            x: x + lean * (-gap).max(0.0),
            normal,
            gap,
            spring: HuntCrossley {
                stiffness,
                dissipation: collider.dissipation,
            },
            mu: self.friction(collider, &u),
            friction: ElastoPlastic {
                stiffness: TANGENTIAL_RATIO * stiffness,
                damping: self.damping * share.sqrt(),
                ..ElastoPlastic::default()
            },
            ..Contact::default()
        };
        let stored = self.stored(slot);
        if collider.restitution > 0.0 {
            let approach = if stored.touchdown > 0.0 {
                stored.touchdown
            } else {
                -vn
            };
            if approach > BOUNCE_THRESHOLD {
                contact.touchdown = approach;
                contact.spring.dissipation = collider.dissipation_number / approach;
            }
        }
        if contact.touchdown == 0.0 {
            // A deep initial overlap leaves faster than a light touch, but slower than it would
            // hop.
            let excess = -gap - DEEP_OVERLAP * collider.penetration;
            if excess > 0.0 {
                let emergence = EMERGENCE * (2.0 * self.gravity * excess).sqrt();
                contact.spring.dissipation =
                    1.0 / (1.0 / contact.spring.dissipation).max(emergence);
            }
        }
        contact.carry(contact.normal_force(vn));
        // The displacement follows the tangent plane and keeps its length.
        let stored = Vec3::from(stored.displacement);
        let (out, flat) = normal_part(&normal, &stored);
        if out == 0.0 {
            contact.friction.displacement = stored;
        } else {
            let (length, flat_length) = (stored.norm(), flat.norm());
            if flat_length > LEAST_FLAT * length {
                contact.friction.displacement = flat * (length / flat_length);
            }
        }
        self.contacts.push(contact);
    }

    /// Coulomb coefficient of a point that slides at `u`.
    #[inline]
    fn friction(&self, collider: &TreeCollider, u: &Vec3) -> f64 {
        if collider.mu_at_rest > collider.mu {
            let reference = self.tree.contact.stribeck_velocity;
            stribeck(collider.mu_at_rest, collider.mu, u.norm(), reference)
        } else {
            collider.mu
        }
    }

    /// What the point in `slot` remembers.
    #[inline]
    fn stored(&mut self, slot: usize) -> Touch {
        while let Some((first, rest)) = self.touches.split_first() {
            if first.slot > slot {
                break;
            }
            self.touches = rest;
            if first.slot == slot {
                return *first;
            }
        }
        Touch::default()
    }
}
