//! Ropes of free bodies: what their forces satisfy, which of their rows are redundant, and how much
//! is kept of them.

#![allow(clippy::cast_precision_loss, reason = "small counts")]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Schur;
use super::testing::{add, anchor};
use crate::dynamics::crba;
use crate::kinematics::Kinematics;
use crate::model::{Anchor, LinkId, LoopKind, Model, RootKind};
use crate::parameters::Parameters;
use crate::sparsity::inverse::Inverse;
use crate::spatial::Vec3;
use crate::state::State;
use crate::testing::{Builder, at, inertia};
use crate::tree::Tree;

/// Bodies along a helix whose neighbours a loop of each kind by turns holds together, with the
/// loops listed anyhow; the first one hangs on the world.
fn rope(count: usize, repeat: usize) -> Model {
    let body = || {
        Builder::new(
            true,
            inertia(1.3, Vec3::new(0.1, 0.05, 0.0), [0.02, 0.05, 0.04]),
        )
    };
    let place = |i: usize| {
        let angle = 0.7 * i as f64;
        Vec3::new(libm::cos(angle), libm::sin(angle), 0.3 * i as f64)
    };
    let mut model = body().model;
    model.roots[0].position = place(0);
    for i in 1..count {
        let mut other = body().model;
        other.roots[0].position = place(i);
        model.join(other, &format!("other{i}"), RootKind::Object);
    }
    for _ in 0..repeat {
        for i in (0..count).map(|i| i * 11 % count) {
            // In the middle between both.
            let half = if i > 0 {
                (place(i - 1) - place(i)) * 0.5
            } else {
                Vec3::zeros()
            };
            let pose = |p: Vec3| at(p.x, p.y, p.z);
            let ends: [Anchor; 2] = if i > 0 {
                [
                    anchor(Some(LinkId::from(i)), pose(half)),
                    anchor(Some(LinkId::from(i - 1)), pose(-half)),
                ]
            } else {
                [
                    anchor(Some(LinkId::from(0)), pose(half)),
                    anchor(None, pose(place(0))),
                ]
            };
            let kind = match i % 3 {
                0 => LoopKind::Ball(ends),
                1 => LoopKind::Hinge(ends),
                _ => LoopKind::Weld(ends),
            };
            add(&mut model, kind);
        }
    }
    model
}

/// Tree and kinematics where the rope begins.
fn prepared(model: &Model) -> (Tree, Kinematics) {
    let tree = Tree::new(model, &Parameters::new(model));
    let mut kin = Kinematics::new(&tree);
    kin.update_poses(&tree, &State::new(model).physical.q);
    crba::mass_matrix(&tree, &mut kin);
    kin.update_loops(&tree);
    (tree, kin)
}

/// `J H⁻¹ Jᵀ λ` is what the forces have been asked for, where it is found row by row with all
/// unknowns; and twice the rope has twice the entries, whatever the order of its loops.
#[test]
fn forces_of_a_rope_satisfy_their_equations_with_entries_in_proportion_to_its_length() {
    let entries = [14, 28, 56].map(|count| {
        let (tree, kin) = prepared(&rope(count, 1));
        let mut factor = kin.M.clone();
        tree.sparsity.factor(&mut factor);
        let mut schur = Schur::new(&tree);
        schur.factor(&tree, &kin.loops, &Inverse::Packed(&tree.sparsity, &factor));
        let rows = &kin.loops;
        let asked: Vec<f64> = (0..rows.len()).map(|row| libm::sin(row as f64)).collect();
        let mut forces = asked.clone();
        schur.solve(&mut forces);
        let (mut x, mut pushed) = (
            vec![0.0; tree.sparsity.len()],
            vec![0.0; tree.sparsity.len()],
        );
        for (row, force) in forces.iter().enumerate() {
            rows.add(&tree, row, *force, &mut x);
        }
        tree.sparsity.solve(&factor, &mut x);
        schur.push(&forces, &mut pushed);
        for (a, b) in x.iter().zip(&pushed) {
            assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{count}: {a} {b}");
        }
        for (row, asked) in asked.iter().enumerate() {
            let found = rows.along(&tree, row, &x);
            assert!(
                (found - asked).abs() < 1e-8,
                "{count} row {row}: {found} {asked}"
            );
        }
        schur.entries()
    });
    // Beside the two ends each loop has two neighbours.
    assert!(entries[2] < 2 * entries[1] + entries[0], "{entries:?}");
    assert!(entries[1] < 2 * entries[0] + entries[0], "{entries:?}");
}

/// Of a rope whose loops stand twice each second one is left out, and none of one whose loops stand
/// once: 14 rows a loop of each kind.
#[test]
fn redundant_rows_of_a_rope_are_left_out() {
    for (count, repeat) in [(12, 1), (12, 2), (30, 1), (30, 2)] {
        let (tree, mut kin) = prepared(&rope(count, repeat));
        assert_eq!(kin.loops.len(), repeat * count / 3 * 14);
        let D2 = kin.inverse_diagonal.clone();
        kin.loops.select(&tree, &D2);
        assert_eq!(
            kin.loops.len(),
            count / 3 * 14,
            "{count} bodies, {repeat} times"
        );
    }
}
