//! The Hessian `H = M + Jᵀ G J`: a contact's stiffness is a 6×6 matrix on its body, composed and
//! projected like a composite rigid body, so that `H` has the sparsity of `M`.
//!
//! Between bodies of two trees it is that on each of the two, and one block beside the pattern,
//! `−Sᵀ G S'` with the columns of both, which couples the trees.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Newton, Problem};
use crate::dynamics::crba::add_row;
use crate::force::{
    Contact, ContactPoint, Other, PointResponse, Response, SpringTerm, TurnResponse,
};
use crate::kinematics::Kinematics;
use crate::sparsity::coupled::Coupled;
use crate::spatial::{
    Vec3, Vec6, across, add_force_at, add_scaled6, angular, dot6, join, linear, multiply_lower,
    velocity_at,
};
use crate::tree::Tree;

impl Newton {
    /// `H = M + Jᵀ G J` from the responses.
    #[inline]
    pub(super) fn assemble(&mut self, p: &Problem) {
        let Problem { tree, kin, .. } = *p;
        let pattern = &tree.sparsity;
        self.factor.H.part();
        self.factor.H.packed.copy_from_slice(&kin.M);
        for (term, r) in p.terms.joints.iter().zip(&self.responses.joints) {
            let stiffness = r.stiffness;
            self.factor.H.packed[pattern.diagonal(term.dof)] += stiffness;
        }
        if p.terms.is_free() {
            return;
        }
        for &b in &self.loaded {
            self.G[b] = [0.0; 21];
        }
        for (_, tree) in tree.moved() {
            self.G[tree.bodies.start] = [0.0; 21];
        }
        let mut any = !p.terms.springs.is_empty();
        for (contact, response) in p.terms.contacts.iter().zip(&self.responses.contacts) {
            // What no longer presses is still damped against rocking by the load of the start.
            if response.presses() || response.friction.around > 0.0 || contact.load > 0.0 {
                any = true;
                let own = contact.points.clone();
                let points = &p.terms.contacts.points[own.clone()];
                let response = (response, &self.responses.points[own]);
                let own = &mut self.G[contact.body];
                let Some(other) = contact.other else {
                    add_contact(own, contact, points, response, p.h);
                    continue;
                };
                let mut G = [0.0; 21];
                add_contact(&mut G, contact, points, response, p.h);
                let sums = (&mut self.G[..], &mut self.factor.H);
                link((tree, kin), sums, contact.body, &other, &G);
            }
        }
        for (turn, response) in p.terms.turns.iter().zip(&self.responses.turns) {
            if response.normal > 0.0 || response.tangential > 0.0 {
                any = true;
                let stiffness = lower_triangle(&turn.normal, response);
                let contact = &p.terms.contacts.list[turn.contact];
                if let Some(other) = contact.other {
                    let mut G = [0.0; 21];
                    G[..6].copy_from_slice(&stiffness);
                    let sums = (&mut self.G[..], &mut self.factor.H);
                    link((tree, kin), sums, turn.body, &other, &G);
                    continue;
                }
                for (sum, g) in self.G[turn.body].iter_mut().zip(stiffness) {
                    *sum += g;
                }
            }
        }
        for spring in &p.terms.springs {
            let sums = (&mut self.G[..], &mut self.factor.H);
            add_spring((tree, kin), sums, spring, p.h);
        }
        if !any {
            return;
        }
        for &b in &self.loaded {
            let body = &tree.bodies[b];
            // Not what the pattern looks like: the rows of a fixed serial chain of six joints or
            // more look the same as those on a floating base.
            let floating = tree.is_free(b);
            let G = self.G[b];
            for c in body.column..body.column + body.columns {
                let F = multiply_lower(&G, &kin.S[c]);
                if tree.pure {
                    let (start, depth) = (pattern.start[c], pattern.depth[c]);
                    let mut from = 0;
                    if floating {
                        for (m, f) in self.factor.H.packed[start..start + 6].iter_mut().zip(&F) {
                            *m += f;
                        }
                        from = 6;
                    }
                    let places = &mut self.factor.H.packed[start + from..=start + depth];
                    let columns = &pattern.column[start + from..=start + depth];
                    for (m, &a) in places.iter_mut().zip(columns) {
                        *m += dot6(&kin.S[a as usize], &F);
                    }
                } else {
                    add_row(tree, &kin.S, b, c, &F, &mut self.factor.H.packed);
                }
            }
            for (sum, g) in self.G[body.parent].iter_mut().zip(&G) {
                *sum += g;
            }
        }
        for (_, tree) in tree.moved().filter(|(_, tree)| tree.free) {
            let rows = &mut self.factor.H.packed[pattern.start[tree.dofs.start]..];
            for (m, g) in rows.iter_mut().zip(&self.G[tree.bodies.start]) {
                *m += g;
            }
        }
    }
}

/// Adds the stiffness of a spring over `h` seconds to what acts on its bodies and to what couples
/// them.
fn add_spring(
    (tree, kin): (&Tree, &Kinematics),
    (sums, H): (&mut [[f64; 21]], &mut Coupled),
    spring: &SpringTerm,
    h: f64,
) {
    let D = spring.resistance(h) * h;
    let places = spring.places();
    let bodies = [Some(spring.body), spring.other.map(|other| other.body)];
    for (body, x) in bodies.into_iter().zip(&places) {
        let Some(body) = body else { continue };
        let mut place = 0;
        for i in 0..6 {
            let mut unit = [0.0; 6];
            unit[i] = 1.0;
            let mut row = [0.0; 6];
            add_force_at(&mut row, x, &(D * velocity_at(&unit, x)));
            for g in &row[..=i] {
                sums[body][place] += g;
                place += 1;
            }
        }
    }
    let [Some(body), Some(other)] = bodies else {
        return;
    };
    let dofs = [body, other].map(|b| &tree.trees[tree.bodies[b].tree].dofs);
    H.couple(&tree.sparsity, dofs.map(|dofs| dofs.start));
    for i in tree.columns_to(body) {
        let f = D * velocity_at(&kin.S[i], &places[0]);
        for j in tree.columns_to(other) {
            let v = velocity_at(&kin.S[j], &places[1]);
            H.add(tree.dof[i], tree.dof[j], -f.dot(&v));
        }
    }
}

/// Adds the stiffness `G`, about O of the tree of `body`, between `body` and another one of another
/// tree, to what acts on both and to what couples them.
fn link(
    (tree, kin): (&Tree, &Kinematics),
    (sums, H): (&mut [[f64; 21]], &mut Coupled),
    body: usize,
    other: &Other,
    G: &[f64; 21],
) {
    for (sum, g) in sums[body].iter_mut().zip(G) {
        *sum += g;
    }
    // What a unit velocity of the first body does, as a force about O of the other tree.
    let lever = &other.from;
    let P = mirrored(G).map(|F| {
        let moment = angular(&F) + lever.cross(&linear(&F));
        [moment.x, moment.y, moment.z, F[3], F[4], F[5]]
    });
    // The same of a unit velocity of the other one, seen from the first.
    let mut own = P;
    for (i, own) in own[..3].iter_mut().enumerate() {
        let mut unit = Vec3::zeros();
        unit[i] = 1.0;
        let seen = unit.cross(lever);
        for (own, k) in own.iter_mut().zip(0..) {
            *own += seen.x * P[3][k] + seen.y * P[4][k] + seen.z * P[5][k];
        }
    }
    let rows = own.iter().enumerate().flat_map(|(i, row)| &row[..=i]);
    for (sum, g) in sums[other.body].iter_mut().zip(rows) {
        *sum += g;
    }
    let [dofs, others] = [body, other.body].map(|b| &tree.trees[tree.bodies[b].tree].dofs);
    if dofs.is_empty() || others.is_empty() {
        return;
    }
    H.couple(&tree.sparsity, [dofs.start, others.start]);
    if tree.is_free_base(body) && tree.is_free_base(other.body) {
        for (i, F) in dofs.clone().zip(&P) {
            for (j, f) in others.clone().zip(F) {
                H.add(i, j, -f);
            }
        }
        return;
    }
    for i in tree.columns_to(body) {
        let mut F = [0.0; 6];
        for (s, P) in kin.S[i].iter().zip(&P) {
            add_scaled6(&mut F, P, *s);
        }
        for j in tree.columns_to(other.body) {
            H.add(tree.dof[i], tree.dof[j], -dot6(&kin.S[j], &F));
        }
    }
}

/// The rows of a symmetric matrix of which the lower triangle is given.
#[inline]
fn mirrored(G: &[f64; 21]) -> [Vec6; 6] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let (row, column) = (i.max(j), i.min(j));
            G[row * (row + 1) / 2 + column]
        })
    })
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
fn add_square<const N: usize>(G: &mut [f64], row: &[f64; N], weight: f64) {
    let mut place = 0;
    for i in 0..N {
        let x = weight * row[i];
        for y in &row[..=i] {
            G[place] += x * y;
            place += 1;
        }
    }
}

/// Adds the stiffness of a contact's response over `h` seconds to that of its body about O: the
/// second derivatives of the costs in [`crate::force::Contact`].
#[inline]
fn add_contact(
    G: &mut [f64; 21],
    contact: &Contact,
    points: &[ContactPoint],
    response: (&Response, &[PointResponse]),
    h: f64,
) {
    if contact.uneven {
        let row = |p: &ContactPoint, m: &Vec3| join(m, &p.row);
        along_normals(contact, points, response, (h, row), G);
    } else {
        let row = |_: &ContactPoint, m: &Vec3| [m.x, m.y, m.z, 1.0];
        let mut S = [0.0; 10];
        along_normals(contact, points, response, (h, row), &mut S);
        add_along(G, &contact.normal, &S);
    }
    let friction = &response.0.friction;
    let slope = h * friction.slope;
    if friction.around > 0.0 {
        let n = &contact.normal;
        let mut add = |direction: &Vec3, slope: f64| {
            let (along, moment) = contact.lever(direction);
            add_square(G, &join(&moment, &along), slope);
        };
        // Two directions across the slip, or two tangents and drilling. A single point does not
        // resist drilling, but may have been stretched by it before: then its slip leans out of
        // the tangent plane, and counts along both tangents.
        let slips = response.0.slips();
        let axis = if slips { friction.slip } else { *n };
        let first = n.cross(&axis).try_normalize(1e-12);
        let first = first.unwrap_or_else(|| across(n));
        add(&first, h * friction.around);
        add(&axis.cross(&first), slope);
        if contact.radius > 0.0 && !slips {
            add(n, slope);
        }
    }
}

/// Adds the stiffness of what acts along the normals to `S`, lower triangle. The `row` of a point
/// with a lever `m` is the one by which velocities move it along its normal: of a velocity `m·ω +
/// c n·v`, `[m c]` where all have the normal `n`; else one for the six parts of a spatial velocity.
#[inline]
fn along_normals<const N: usize>(
    contact: &Contact,
    points: &[ContactPoint],
    (r, of): (&Response, &[PointResponse]),
    (h, row): (f64, impl Fn(&ContactPoint, &Vec3) -> [f64; N]),
    S: &mut [f64],
) {
    let (mut mean, mut load_mean) = ([0.0; N], [0.0; N]);
    let strain = h * h * r.force;
    for (p, response) in points.iter().zip(of) {
        let mut arm = p.arm;
        for (sum, x) in load_mean.iter_mut().zip(row(p, &p.arm)) {
            *sum += x * p.load;
        }
        if let Some(rim) = &p.rim {
            arm += rim.moment(&response.lean);
            // Two tangents, the first along which the rim leans at the end.
            let (e, inverse) = response.end;
            let first = e
                .try_normalize(1e-12)
                .unwrap_or_else(|| p.normal.cross(&rim.axis_across()));
            let second = p.normal.cross(&first);
            let damping = h * contact.tilting * p.load * rim.tilt_damping;
            let weight = strain * response.weight * inverse;
            for (tangent, bend) in [(first, 1.0 - e.norm_squared()), (second, 1.0)] {
                let moment = rim.moment(&tangent);
                let tilt = [moment.x, moment.y, moment.z];
                add_square(&mut S[..6], &tilt, weight * bend + damping);
            }
        }
        let own = row(p, &arm);
        add_square(S, &own, strain * response.bend);
        for (sum, x) in mean.iter_mut().zip(own) {
            *sum += response.weight * x;
        }
    }
    if r.presses() {
        add_square(S, &mean, h * h * r.slope - 3.0 * strain / r.depth);
    }
    for (p, response) in points.iter().zip(of) {
        if response.rocking > 0.0 {
            let mut apart = row(p, &p.arm);
            for (x, mean) in apart.iter_mut().zip(&load_mean) {
                *x -= mean;
            }
            let slope = h * response.rocking;
            if contact.uneven {
                add_square(S, &apart, slope);
            } else {
                // The shares sum up to one: along one normal all have the same linear velocity.
                add_square(S, &[apart[0], apart[1], apart[2]], slope);
            }
        }
    }
}

/// Adds what [`along_normals`] gives for the normal `n` of all.
#[inline]
fn add_along(G: &mut [f64; 21], n: &Vec3, S: &[f64; 10]) {
    for (sum, x) in G.iter_mut().zip(&S[..6]) {
        *sum += x;
    }
    let mut place = 6;
    for i in 0..3 {
        for m in &S[6..9] {
            G[place] += n[i] * m;
            place += 1;
        }
        for j in 0..=i {
            G[place] += n[i] * n[j] * S[9];
            place += 1;
        }
    }
}
