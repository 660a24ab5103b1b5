//! The Hessian `H = M + Jᵀ G J`: a contact's stiffness is a 6×6 matrix on its body, composed and
//! projected like a composite rigid body, so that `H` has the sparsity of `M`.
//!
//! For contacts with the ground: the stiffness between two bodies of different branches lies
//! outside that pattern.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Newton, Problem};
use crate::dynamics::crba::add_row;
use crate::force::{Contact, ContactPoint, PointResponse, Response, TurnResponse, normal_part};
use crate::spatial::{Vec3, Vec6, dot6, multiply_lower};

impl Newton {
    /// `H = M + Jᵀ G J` from the responses.
    #[inline]
    pub(super) fn assemble(&mut self, p: &Problem) {
        let Problem { tree, kin, .. } = *p;
        let pattern = &tree.sparsity;
        self.H.copy_from_slice(&kin.M);
        for (term, r) in p.terms.joints.iter().zip(&self.responses.joints) {
            let stiffness = r.stiffness;
            self.H[pattern.diagonal(term.dof)] += stiffness;
        }
        if p.terms.contacts.is_empty() {
            return;
        }
        for &b in &self.loaded {
            self.G[b] = [0.0; 21];
        }
        self.G[0] = [0.0; 21];
        let mut any = false;
        for (contact, response) in p.terms.contacts.iter().zip(&self.responses.contacts) {
            if response.presses() || response.friction.slope > 0.0 {
                any = true;
                let own = contact.points.clone();
                let points = &p.terms.contacts.points[own.clone()];
                let response = (response, &self.responses.points[own]);
                add_contact(&mut self.G[contact.body], contact, points, response, p.h);
            }
        }
        for (turn, response) in p.terms.turns.iter().zip(&self.responses.turns) {
            if response.normal > 0.0 || response.tangential > 0.0 {
                any = true;
                let stiffness = lower_triangle(&turn.normal, response);
                for (sum, g) in self.G[turn.body].iter_mut().zip(stiffness) {
                    *sum += g;
                }
            }
        }
        if !any {
            return;
        }
        // Not `pattern.floating`: the rows of a fixed serial chain of six joints or more look the
        // same.
        let floating = tree.is_free();
        for &b in &self.loaded {
            let body = &tree.bodies[b];
            let G = self.G[b];
            for c in body.column..body.column + body.columns {
                let F = multiply_lower(&G, &kin.S[c]);
                if tree.pure {
                    let (start, depth) = (pattern.start[c], pattern.depth[c]);
                    let mut from = 0;
                    if floating {
                        for (m, f) in self.H[start..start + 6].iter_mut().zip(&F) {
                            *m += f;
                        }
                        from = 6;
                    }
                    let places = &mut self.H[start + from..=start + depth];
                    let columns = &pattern.column[start + from..=start + depth];
                    for (m, &a) in places.iter_mut().zip(columns) {
                        *m += dot6(&kin.S[a as usize], &F);
                    }
                } else {
                    add_row(tree, &kin.S, b, c, &F, &mut self.H);
                }
            }
            for (sum, g) in self.G[body.parent].iter_mut().zip(&G) {
                *sum += g;
            }
        }
        if floating {
            for (m, g) in self.H[..21].iter_mut().zip(&self.G[0]) {
                *m += g;
            }
        }
    }
}

/// `G = t 1 + (n − t) n̂n̂ᵀ − t ŝŝᵀ` of a response, lower triangle.
#[inline]
fn lower_triangle(n: &Vec3, r: &TurnResponse) -> [f64; 6] {
    let (t, s) = (r.tangential, &r.slip);
    let N = r.normal - t;
    [
        t + N * n.x * n.x - t * s.x * s.x,
        N * n.y * n.x - t * s.y * s.x,
        t + N * n.y * n.y - t * s.y * s.y,
        N * n.z * n.x - t * s.z * s.x,
        N * n.z * n.y - t * s.z * s.y,
        t + N * n.z * n.z - t * s.z * s.z,
    ]
}

/// `G += weight · row rowᵀ`, lower triangle.
#[inline]
fn add_square(G: &mut [f64; 21], row: &Vec6, weight: f64) {
    let mut place = 0;
    for i in 0..6 {
        let x = weight * row[i];
        for y in &row[..=i] {
            G[place] += x * y;
            place += 1;
        }
    }
}

/// The row that gives the velocity along `direction` at `x` from O.
#[inline]
fn row(x: &Vec3, direction: &Vec3) -> Vec6 {
    let moment = x.cross(direction);
    [
        moment.x,
        moment.y,
        moment.z,
        direction.x,
        direction.y,
        direction.z,
    ]
}

/// Adds the stiffness of a contact's response over `h` seconds to that of its body about O: the
/// second derivatives of the costs in [`crate::force::Contact`].
#[inline]
fn add_contact(
    G: &mut [f64; 21],
    contact: &Contact,
    points: &[ContactPoint],
    (r, of): (&Response, &[PointResponse]),
    h: f64,
) {
    let n = &contact.normal;
    let (mut mean, mut load_mean) = ([0.0; 6], [0.0; 6]);
    let strain = h * h * r.force;
    for (p, response) in points.iter().zip(of) {
        let push = row(&p.x, n);
        let mut own = push;
        if let Some(rim) = &p.rim {
            let lean = rim.moment(&response.lean);
            for (sum, x) in own.iter_mut().zip(lean.iter()) {
                *sum += x;
            }
            // Two tangents, the first along which the rim leans at the end.
            let (e, inverse) = response.end;
            let first = e
                .try_normalize(1e-12)
                .unwrap_or_else(|| n.cross(&rim.axis_across()));
            let second = n.cross(&first);
            let damping = h * contact.tilting * p.load * rim.tilt_damping();
            let weight = strain * response.weight * inverse;
            for (tangent, bend) in [(first, 1.0 - e.norm_squared()), (second, 1.0)] {
                let moment = rim.moment(&tangent);
                let tilt = [moment.x, moment.y, moment.z, 0.0, 0.0, 0.0];
                add_square(G, &tilt, weight * bend + damping);
            }
        }
        add_square(G, &own, strain * response.bend);
        for i in 0..6 {
            mean[i] += response.weight * own[i];
            load_mean[i] += p.load * push[i];
        }
    }
    if r.presses() {
        add_square(G, &mean, h * h * r.slope - 3.0 * strain / r.depth);
    }
    for (p, response) in points.iter().zip(of) {
        if response.rocking > 0.0 {
            let push = row(&p.x, n);
            let apart = std::array::from_fn(|i| push[i] - load_mean[i]);
            add_square(G, &apart, h * response.rocking);
        }
    }
    let slope = h * r.friction.slope;
    if slope > 0.0 {
        let sliding = |direction: &Vec3| {
            let (drilling, along) = normal_part(n, direction);
            let mut row = row(&contact.center, &along);
            for (sum, x) in row.iter_mut().zip(n.iter()) {
                *sum += contact.radius * drilling * x;
            }
            row
        };
        for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
            add_square(G, &sliding(&axis), slope);
        }
        if r.slips() {
            add_square(G, &sliding(&r.friction.slip), -slope);
        }
    }
}
