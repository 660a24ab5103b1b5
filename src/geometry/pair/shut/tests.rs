//! Tests of walls that are shut.

use super::*;
use crate::geometry::pair::flush::{is_over, lowest_over};
use crate::geometry::pair::tests::{any_rotation, at, cube, solid};
use crate::spatial::Mat3;
use crate::testing::Random;

/// One solid that stands there.
struct One<'a>(&'a Solid, Pose);

impl Others for One<'_> {
    fn any(
        &self,
        _: bool,
        _: (&Vec3, f64),
        is: &mut dyn FnMut(&Solid, &Pose, bool) -> bool,
    ) -> bool {
        is(self.0, &self.1, true)
    }

    fn carries(&self) -> bool {
        false
    }

    fn any_that_carries(&self, _: (&Vec3, f64), _: &mut dyn FnMut(&Solid, &Pose) -> bool) -> bool {
        false
    }

    fn level(&self) -> f64 {
        1e-4
    }
}

/// Beside all places of boxes that lie askew over another one, beside which a third one stands:
/// what is beyond the wall that this one covers is not over the box.
#[test]
fn the_lowest_place_over_a_solid_is_that_of_all_that_are() {
    let mut random = Random(5);
    let [below, above, beside] = [0.05, 0.04, 0.05].map(|half| solid(&cube(half)));
    let place = |x| at(Vec3::new(x, 0.0, 0.0), Mat3::identity());
    let others = One(&beside, place(0.1));
    let among = Among {
        others: &others,
        origin: Vec3::zeros(),
        swapped: false,
    };
    let mut found = [0; 3];
    for _ in 0..200 {
        let by = Vec3::new(random.uniform(0.0, 0.2), 0.0, 0.1);
        let X = at(by, any_rotation(&mut random));
        let (p, o) = (
            Placed::new(&below, &place(0.0), &Vec3::zeros()),
            Placed::new(&above, &X, &Vec3::zeros()),
        );
        let on = On::new((&p, &o), true, Some(&among));
        let up = Vec3::z();
        let all = places(&o, &up).filter(|x| is_over(&on, (&up, None), x));
        let expected = lowest_of(all, &up);
        let least = lowest_over(&on, (&up, None));
        assert_eq!(least.to_bits(), expected.to_bits());
        let lowest = lowest_of(places(&o, &up), &up);
        found[usize::from(expected > lowest) + usize::from(expected.is_infinite())] += 1;
    }
    assert!(found.iter().all(|count| *count > 10), "{found:?}");
}
