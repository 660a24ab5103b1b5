#![allow(clippy::cast_precision_loss, reason = "small counts")]

use super::*;
use nalgebra::{DMatrix, DVector};

/// Blocks of the lengths, full within, coupled by `pairs` of unknowns; the matrix, and the same
/// written out in full.
fn matrix(lengths: &[usize], pairs: &[[usize; 2]]) -> (Sparsity, Coupled, DMatrix<f64>) {
    let mut first = 0;
    let cliques = lengths.iter().map(|length| {
        first += length;
        (first - length..first).collect()
    });
    let cliques: Vec<Vec<usize>> = cliques.collect();
    let pattern = Sparsity::new(lengths, &cliques);
    let n = pattern.len();
    let mut m = DMatrix::zeros(n, n);
    let mut coupled = Coupled::new(&pattern, true);
    for k in 0..n {
        for q in 0..=pattern.depth[k] {
            let j = pattern.column[pattern.start[k] + q] as usize;
            let own = if j == k { 40.0 } else { 0.0 };
            let value = own + libm::sin(1.0 + 3.7 * (k * n + j) as f64);
            coupled.packed[pattern.start[k] + q] = value;
            (m[(k, j)], m[(j, k)]) = (value, value);
        }
    }
    coupled.part();
    for pair in pairs {
        coupled.couple(&pattern, *pair);
    }
    for (p, [i, j]) in pairs.iter().enumerate() {
        let value = libm::cos(p as f64);
        coupled.add(*i, *j, value);
        m[(*i, *j)] += value;
        m[(*j, *i)] += value;
    }
    (pattern, coupled, m)
}

fn check(lengths: &[usize], pairs: &[[usize; 2]]) {
    let (pattern, mut coupled, m) = matrix(lengths, pairs);
    let expected: Vec<f64> = (0..pattern.len()).map(|i| libm::cos(i as f64)).collect();
    let right = m * DVector::from_vec(expected.clone());
    coupled.factor(&pattern);
    let mut x: Vec<f64> = right.iter().copied().collect();
    coupled.solve(&pattern, &mut x);
    for (x, e) in x.iter().zip(&expected) {
        assert!((x - e).abs() < 1e-12, "{x} {e}");
    }
}

#[test]
fn coupled_blocks_factor_and_solve() {
    check(&[6, 6], &[[2, 9]]);
    check(&[7, 3, 6, 2], &[[1, 9], [8, 12], [12, 0], [12, 0], [17, 6]]);
    // More than fit into one word, with a block that stays alone.
    let chain: Vec<[usize; 2]> = (0..29).map(|i| [6 * i + i % 5, 6 * i + 8]).collect();
    check(&[6; 31], &chain);
}

#[test]
fn blocks_that_nothing_couples_have_the_digits_that_they_have_alone() {
    let (pattern, mut coupled, _) = matrix(&[6, 9, 6], &[[3, 17]]);
    let (alone, mut own, _) = matrix(&[6, 9, 6], &[]);
    coupled.factor(&pattern);
    own.factor(&alone);
    let (mut x, mut y) = (vec![1.0; 21], vec![1.0; 21]);
    coupled.solve(&pattern, &mut x);
    own.solve(&alone, &mut y);
    assert_eq!(x[6..15], y[6..15]);
    assert!(x[..6] != y[..6]);
}

#[test]
fn nothing_of_an_earlier_coupling_is_left() {
    let (pattern, mut coupled, _) = matrix(&[6, 6, 6], &[[3, 17], [2, 9]]);
    coupled.factor(&pattern);
    let (_, fresh, m) = matrix(&[6, 6, 6], &[[0, 7]]);
    coupled.packed.copy_from_slice(&fresh.packed);
    coupled.part();
    coupled.couple(&pattern, [0, 7]);
    coupled.add(0, 7, 1.0);
    coupled.factor(&pattern);
    let mut x: Vec<f64> = (m * DVector::from_element(18, 1.0))
        .iter()
        .copied()
        .collect();
    coupled.solve(&pattern, &mut x);
    assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-12));
}

#[test]
fn the_fill_of_a_pile_is_exact() {
    // Ten bodies one upon the other: each row reaches its own block and the one below.
    let chain: Vec<[usize; 2]> = (0..9)
        .flat_map(|i| (0..36).map(move |p| [6 * i + p / 6, 6 * i + 6 + p % 6]))
        .collect();
    let (pattern, mut coupled, _) = matrix(&[6; 10], &chain);
    coupled.factor(&pattern);
    let mut cost = 0;
    for k in 0..pattern.len() {
        coupled.find_runs(k);
        let d: usize = coupled.runs.iter().map(Range::len).sum();
        assert!(d < 12);
        cost += d * (d + 1) / 2;
    }
    // Rows of 6 … 11 entries in nine of the blocks, of 0 … 5 in the lowest.
    assert_eq!(cost, 9 * (21 + 28 + 36 + 45 + 55 + 66) + 35);
}
