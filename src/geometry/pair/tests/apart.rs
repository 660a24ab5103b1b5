//! What a direction shows to be apart has nothing in common.

use super::{any_rotation, any_shape, at, solid};
use crate::geometry::pair::Patch;
use crate::spatial::Vec3;
use crate::testing::Random;

/// Of random pairs: along the normal of a look that finds nothing and along others, which are off
/// by little or much, and within a reach that is less than the gap by some units of round-off.
#[test]
fn what_is_known_to_be_apart_is_found_to_be() {
    let mut random = Random(0x94D0_49BB_1331_11EB);
    let (mut shown, mut missed, mut patch) = (0, 0, Patch::new());
    for round in 0..20_000 {
        let shapes = [round % 5, round / 5 % 5].map(|kind| any_shape(kind, 0.2, &mut random));
        let solids = [0, 1].map(|i| solid(&shapes[i]));
        let place = random.unit() * random.uniform(0.1, 0.8);
        let X = at(random.vector(1.0), any_rotation(&mut random));
        let Y = at(X.p + place, any_rotation(&mut random));
        let pair = ((&solids[0], &X), (&solids[1], &Y));
        let near = place.norm() < solids[0].reach + solids[1].reach;
        if !near || patch.find(pair.0, pair.1, 0.0) {
            continue;
        }
        let normal = patch.normal;
        // The largest reach that the direction shows to be too small.
        let apart = |reach: f64, n: &Vec3| Patch::are_apart(pair.0, pair.1, reach, n);
        let mut tilted = |by: f64| (normal + random.vector(by)).normalize();
        for n in [
            normal,
            tilted(0.1),
            tilted(1e-8),
            tilted(1e-9),
            tilted(1e-10),
        ] {
            if !apart(0.0, &n) {
                missed += usize::from(n == normal);
                continue;
            }
            let (mut low, mut high) = (0.0, 2.0);
            while f64::midpoint(low, high) > low && f64::midpoint(low, high) < high {
                let middle = f64::midpoint(low, high);
                if apart(middle, &n) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            for reach in [low, low.next_down(), low.next_down().next_down(), 0.5 * low] {
                assert!(
                    !patch.find(pair.0, pair.1, reach),
                    "{shapes:?} {X:?} {Y:?} {reach}"
                );
                shown += 1;
            }
        }
    }
    // Nearly all looks that find nothing give a direction that shows it; the others have corners
    // that are within their roundings.
    assert!(shown > 10_000 && missed < shown / 100, "{shown} {missed}");
}

/// What is found of pairs once, at any reach, is what a look at each reach finds, to the last bit.
#[test]
fn what_is_found_whole_is_what_is_found_at_any_reach() {
    let mut random = Random(0x2545_F491_4F6C_DD1D);
    let (mut whole, mut patch, mut compared) = (Patch::new(), Patch::new(), 0);
    for round in 0..5_000 {
        let shapes = [round % 5, round / 5 % 5].map(|kind| any_shape(kind, 0.2, &mut random));
        let solids = [0, 1].map(|i| solid(&shapes[i]));
        let place = random.unit() * random.uniform(0.05, 0.5);
        let X = at(random.vector(1.0), any_rotation(&mut random));
        // Every other pair lies face on face.
        let R = if round % 2 == 0 {
            X.R
        } else {
            any_rotation(&mut random)
        };
        let Y = at(X.p + place, R);
        let pair = ((&solids[0], &X), (&solids[1], &Y));
        if !whole.find_whole([pair.0, pair.1], None, 0.0) {
            continue;
        }
        let (points, lies) = (whole.points().to_vec(), (whole.normal, whole.share));
        let kinds = [whole.blended, whole.deep];
        for reach in [0.0, 1e-3, 0.01, 0.1] {
            whole.take((&lies.0, lies.1), kinds, &points);
            let Some(any) = whole.limit(reach) else {
                continue;
            };
            assert_eq!(any, patch.find(pair.0, pair.1, reach), "{round}: {reach}");
            assert_eq!(whole.points(), patch.points(), "{round}: {reach}");
            if any {
                assert_eq!(
                    ((whole.normal, whole.share), kinds),
                    ((patch.normal, patch.share), [patch.blended, patch.deep])
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 4_000, "{compared}");
}
