//! The packed matrix against the same written out in full.

#![allow(clippy::cast_precision_loss, reason = "small counts")]

use super::*;

/// A·x for the pattern's matrix, written out in full.
fn dense(p: &Sparsity, a: &[f64]) -> nalgebra::DMatrix<f64> {
    let n = p.len();
    let mut m = nalgebra::DMatrix::zeros(n, n);
    for k in 0..n {
        for q in 0..=p.depth[k] {
            let j = p.column[p.start[k] + q] as usize;
            m[(k, j)] = a[p.start[k] + q];
            m[(j, k)] = a[p.start[k] + q];
        }
    }
    m
}

fn check(p: &Sparsity) {
    let mut a = vec![0.0; p.entries()];
    for (i, x) in a.iter_mut().enumerate() {
        *x = libm::sin(1.0 + 3.7 * i as f64);
    }
    for k in 0..p.len() {
        a[p.diagonal(k)] = 20.0 + k as f64;
    }
    let m = dense(p, &a);
    let x: Vec<f64> = (0..p.len()).map(|i| libm::cos(i as f64)).collect();
    let mut y = vec![0.0; p.len()];
    p.multiply(&a, &x, &mut y);
    let expected = &m * nalgebra::DVector::from_vec(x.clone());
    for (y, e) in y.iter().zip(expected.iter()) {
        assert!((y - e).abs() < 1e-12);
    }
    p.factor(&mut a);
    p.solve(&a, &mut y);
    for (y, x) in y.iter().zip(&x) {
        assert!((y - x).abs() < 1e-12, "{y} {x}");
    }
}

#[test]
fn factor_and_solve_invert_multiply_on_a_branched_floating_tree() {
    let base: Vec<usize> = (0..6).collect();
    let path = |tail: &[usize]| [base.clone(), tail.to_vec()].concat();
    let p = Sparsity::new(&[11], &[path(&[6, 7]), path(&[6, 8]), path(&[9, 10])]);
    assert!(p.blocks[0].floating);
    assert_eq!(p.depth[8], 7);
    check(&p);
}

#[test]
fn limbs_on_a_trunk_and_a_fixed_chain_factor_solve_and_multiply() {
    // A floating base with a trunk of nine, two arms of three on it and a leg of two beside it.
    let trunk: Vec<usize> = (0..15).collect();
    let path =
        |root: &[usize], limb: std::ops::Range<usize>| [root, &limb.collect::<Vec<_>>()].concat();
    let limbs = [
        path(&trunk, 15..18),
        path(&trunk, 18..21),
        path(&trunk[..6], 21..23),
    ];
    let p = Sparsity::new(&[23], &limbs);
    assert!(p.blocks[0].floating);
    let direct = [13, 14, 17, 20, 22].map(|k| p.prefix[k]);
    assert_eq!(direct, [0, 14, 17, 15, 0]);
    check(&p);
    let chain = Sparsity::new(&[20], &[path(&[], 0..20)]);
    assert!(chain.blocks[0].floating);
    check(&chain);
}

#[test]
fn trees_that_are_apart_are_worked_on_one_by_one() {
    // A floating robot with two arms of two, a fixed chain of three, a free body.
    let base: Vec<usize> = (0..6).collect();
    let arm = |from: usize| [base.clone(), vec![from, from + 1]].concat();
    let cliques = [arm(6), arm(8), vec![10, 11, 12], (13..19).collect()];
    let p = Sparsity::new(&[10, 3, 0, 6], &cliques);
    let floating: Vec<bool> = p.blocks.iter().map(|b| b.floating).collect();
    assert_eq!(floating, [true, false, false, true]);
    check(&p);
    // The robot has the digits that it has alone.
    let alone = Sparsity::new(&[10], &cliques[..2]);
    let n = alone.entries();
    let mut a: Vec<f64> = (0..p.entries()).map(|i| libm::sin(i as f64)).collect();
    for k in 0..p.len() {
        a[p.diagonal(k)] = 20.0;
    }
    let mut own = a[..n].to_vec();
    p.factor(&mut a);
    alone.factor(&mut own);
    assert_eq!(own, a[..n]);
}

#[test]
fn coupled_branches_fill_in_and_still_solve() {
    // Two fingers on one palm joint (0); finger 3 follows finger 1, so that 1 and 3's subtree
    // (4) couple.
    let p = Sparsity::new(&[5], &[vec![0, 1, 2], vec![0, 3, 4], vec![0, 2, 4]]);
    assert!(!p.blocks[0].floating);
    check(&p);
}
