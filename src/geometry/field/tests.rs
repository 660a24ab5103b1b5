//! Tests of heights over a grid.

use super::*;
use crate::testing::Random;

fn random(seed: u64) -> Field {
    let mut random = Random(seed);
    let counts = [9, 7];
    let heights = (0..63).map(|_| random.uniform(-0.2, 0.2)).collect();
    let size = [2.0, 3.0];
    Field::try_from(Samples {
        size,
        counts,
        heights,
    })
    .expect("a grid")
}

#[test]
fn the_surface_is_smooth_and_goes_through_its_samples() {
    let field = random(3);
    for j in 0..7 {
        for i in 0..9 {
            let [x, y] = field.place(i, j);
            let local = field.at(x, y).expect("inside");
            assert!((local.height - field.samples().heights[j * 9 + i]).abs() < 1e-14);
        }
    }
    let mut random = Random(4);
    let (mut rough, d) = (0.0_f64, 1e-6);
    for k in 0..4000 {
        // Half of them across the border of two cells.
        let y = random.uniform(-1.4, 1.4);
        let x = if k % 2 == 0 {
            field.place(1 + k % 7, 0)[0]
        } else {
            random.uniform(-0.9, 0.9)
        };
        let at = |dx: f64, dy: f64| field.at(x + dx, y + dy).expect("inside");
        let local = at(0.0, 0.0);
        let slopes = [
            (at(d, 0.0).height - at(-d, 0.0).height) / (2.0 * d),
            (at(0.0, d).height - at(0.0, -d).height) / (2.0 * d),
        ];
        for (found, expected) in local.slope.iter().zip(slopes) {
            rough = rough.max((found - expected).abs());
        }
        if k % 2 == 1 {
            let bend = (at(d, 0.0).slope[0] - at(-d, 0.0).slope[0]) / (2.0 * d);
            assert!(
                (local.bend[0] - bend).abs() < 1e-4,
                "{} {bend}",
                local.bend[0]
            );
            let bend = (at(d, 0.0).slope[1] - at(-d, 0.0).slope[1]) / (2.0 * d);
            assert!(
                (local.bend[1] - bend).abs() < 1e-4,
                "{} {bend}",
                local.bend[1]
            );
        }
    }
    assert!(rough < 1e-4, "{rough:e}");
}

#[test]
fn no_surface_is_above_its_bound_nor_far_beyond_a_step() {
    let field = random(5);
    let mut random = Random(6);
    for _ in 0..2000 {
        let (x, y) = (random.uniform(-0.99, 0.99), random.uniform(-1.49, 1.49));
        let local = field.at(x, y).expect("inside");
        assert!(local.height <= field.highest(x, y, 0.0) + 1e-15);
        assert!(field.highest(x, y, 0.3) >= field.highest(x, y, 0.1));
    }
    let step = |i: usize| if i % 16 < 8 { 0.0 } else { 1.0 };
    let field = Field::try_from(Samples {
        size: [1.0, 1.0],
        counts: [16, 16],
        heights: (0..256).map(step).collect(),
    })
    .expect("a grid");
    for i in 0..1000 {
        let x = f64::from(i) / 1000.0 - 0.5;
        let height = field.at(x, 0.1).expect("inside").height;
        assert!((-0.05..=1.05).contains(&height), "{x} {height}");
    }
}

#[test]
fn even_heights_are_even_to_the_last_bit() {
    let field = Field::try_from(Samples {
        size: [1.0, 2.0],
        counts: [5, 5],
        heights: vec![0.1; 25],
    })
    .expect("a grid");
    let mut random = Random(7);
    for _ in 0..1000 {
        let (x, y) = (random.uniform(-0.5, 0.5), random.uniform(-1.0, 1.0));
        let local = field.at(x, y).expect("inside");
        assert_eq!((local.height, local.slope), (0.1, [0.0; 2]));
        assert_eq!(local.normal(), Vec3::z());
    }
    assert!(field.at(0.51, 0.0).is_none());
}

#[test]
fn peaks_are_found_as_if_all_were_looked_at() {
    let field = random(8);
    let mut random = Random(9);
    for _ in 0..500 {
        let (x, y) = (random.uniform(-1.0, 1.0), random.uniform(-1.5, 1.5));
        let (around, low) = (random.uniform(0.05, 0.5), random.uniform(-0.1, 0.1));
        let mut found = Vec::new();
        field.each_peak((x, y, around), low, |i, j| {
            found.push((i, j));
            low
        });
        for j in 0..7 {
            for i in 0..9 {
                let (p, _, share) = field.sample(i, j);
                let near = (p.x - x).abs() < around && (p.y - y).abs() < around;
                if near && share > 0.0 && p.z > low {
                    assert!(found.contains(&(i, j)));
                }
            }
        }
    }
}

#[test]
fn the_greatest_size_is_the_documented_one() {
    let over = |size: f64| {
        let (counts, heights) = ([2, 2], vec![0.0; 4]);
        let size = [size, 1.0];
        Field::try_from(Samples {
            size,
            counts,
            heights,
        })
        .is_ok()
    };
    assert!(over(1e6) && !over(1.1e6));
}
