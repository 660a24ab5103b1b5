//! The Hessian `H = M + Jᵀ G J`: a contact's stiffness is a 6×6 matrix on its body, composed and
//! projected like a composite rigid body, so that `H` has the sparsity of `M`.
//!
//! For contacts with the ground: the stiffness between two bodies of different branches lies
//! outside that pattern.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Newton, Problem};
use crate::dynamics::crba::add_row;
use crate::force::{Contact, Response};
use crate::spatial::{Vec3, dot6, multiply_lower};

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
            if response.normal > 0.0 || response.tangential > 0.0 {
                any = true;
                add_point_stiffness(&mut self.G[contact.body], contact, response);
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
fn lower_triangle(n: &Vec3, r: &Response) -> [f64; 6] {
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

/// `G_B += Φᵀ G Φ` with `Φ = [−[x]× 1]` and a response's `G`, lower triangle.
#[inline]
fn add_point_stiffness(G_B: &mut [f64; 21], contact: &Contact, r: &Response) {
    let g = lower_triangle(&contact.normal, r);
    let (x, y, z) = (contact.x.x, contact.x.y, contact.x.z);
    // P = [x]× G
    let P = [
        [
            y * g[3] - z * g[1],
            y * g[4] - z * g[2],
            y * g[5] - z * g[4],
        ],
        [
            z * g[0] - x * g[3],
            z * g[1] - x * g[4],
            z * g[3] - x * g[5],
        ],
        [
            x * g[1] - y * g[0],
            x * g[2] - y * g[1],
            x * g[4] - y * g[3],
        ],
    ];
    // angular–angular: P [x]×ᵀ
    G_B[0] += P[0][2] * y - P[0][1] * z;
    G_B[1] += P[1][2] * y - P[1][1] * z;
    G_B[2] += P[1][0] * z - P[1][2] * x;
    G_B[3] += P[2][2] * y - P[2][1] * z;
    G_B[4] += P[2][0] * z - P[2][2] * x;
    G_B[5] += P[2][1] * x - P[2][0] * y;
    // linear rows: Pᵀ, then G
    G_B[6] += P[0][0];
    G_B[7] += P[1][0];
    G_B[8] += P[2][0];
    G_B[9] += g[0];
    G_B[10] += P[0][1];
    G_B[11] += P[1][1];
    G_B[12] += P[2][1];
    G_B[13] += g[1];
    G_B[14] += g[2];
    G_B[15] += P[0][2];
    G_B[16] += P[1][2];
    G_B[17] += P[2][2];
    G_B[18] += g[3];
    G_B[19] += g[4];
    G_B[20] += g[5];
}
