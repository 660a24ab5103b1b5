//! The norm of a face against sums over its points, and its force against differences.

use super::*;
use crate::law::ElastoPlastic;
use crate::spatial::across;
use crate::testing::Random;

/// Points of an even pressure on a rectangle with these half lengths, or on the ellipse in it,
/// and their mean distance from the middle.
fn area(half: [f64; 2], oval: bool) -> (Vec<[f64; 2]>, f64) {
    let count = 80;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(count) * 2.0 - 1.0;
    let cells = (0..count).flat_map(|i| (0..count).map(move |j| [at(i), at(j)]));
    let inside = cells.filter(|[x, y]| !oval || x * x + y * y < 1.0);
    let points: Vec<_> = inside.map(|[x, y]| [x * half[0], y * half[1]]).collect();
    let mean = points.iter().map(|[x, y]| x.hypot(*y)).sum::<f64>();
    let all: f64 = points.iter().map(|_| 1.0).sum();
    (points, mean / all)
}

/// The limit of such points about z.
fn face(points: &[[f64; 2]]) -> Face {
    let (mut whole, mut turned) = (0.0, [0.0; 2]);
    for [x, y] in points {
        whole += x * x + y * y;
        turned[0] += x * x - y * y;
        turned[1] += 2.0 * x * y;
    }
    Face::new(&Vec3::z(), &Vec3::x(), (whole, turned))
}

/// A face of any shape and direction.
fn any_face(random: &mut Random) -> Face {
    let normal = random.unit();
    let angle = random.uniform(0.0, 7.0);
    let long = random.uniform(0.0, 1.0);
    let (sin, cos) = libm::sincos(angle);
    Face::new(&normal, &across(&normal), (1.0, [long * cos, long * sin]))
}

/// `H` and `∇H`.
fn norm(face: &Face, w: &Vec3) -> (f64, Vec3) {
    let gradient = face.bear(*w, 1e-3 * w.norm()).growth;
    (gradient.dot(w), gradient)
}

/// Against sums of Coulomb friction over the area: what a face dissipates, the force along it
/// and the moment about its normal, in shares of the cap, in eight directions with all ratios
/// of sliding and spinning. With the length for both the force on a disc is off by 0.15, on a
/// square by 0.17 and on a board of 4:1 by 0.34.
#[test]
fn a_face_resists_as_its_points_do_together() {
    for (half, oval, most) in [
        ([1.0, 1.0], true, [0.009, 0.038, 0.035]),
        ([1.0, 1.0], false, [0.011, 0.042, 0.046]),
        ([1.25, 1.0], false, [0.022, 0.05, 0.06]),
        ([2.0, 1.0], false, [0.021, 0.05, 0.06]),
        ([2.5, 1.0], false, [0.022, 0.055, 0.05]),
        ([4.0, 1.0], false, [0.027, 0.07, 0.07]),
        ([4.0, 1.0], true, [0.019, 0.055, 0.07]),
        ([10.0, 1.0], false, [0.024, 0.085, 0.075]),
        ([4.0, 1e-3], false, [0.022, 0.075, 0.07]),
    ] {
        let (points, radius) = area(half, oval);
        let face = face(&points);
        let all: f64 = points.iter().map(|_| 1.0).sum();
        let mut worst = [0.0_f64; 3];
        for way in 0..8 {
            for ratio in 1..16 {
                let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_8 * f64::from(way));
                let (spin, slide) = libm::sincos(0.1 * f64::from(ratio));
                let w = Vec3::new(slide * cos, slide * sin, spin);
                let (mut sum, mut force) = (0.0, [0.0; 3]);
                for [x, y] in &points {
                    let v = [w.x - spin * y / radius, w.y + spin * x / radius];
                    let speed = v[0].hypot(v[1]);
                    sum += speed / all;
                    let moment = (x * v[1] - y * v[0]) / radius;
                    let part = [v[0], v[1], moment];
                    force = [0, 1, 2].map(|i| force[i] + part[i] / speed / all);
                }
                let (H, gradient) = norm(&face, &w);
                let apart = (gradient.x - force[0]).hypot(gradient.y - force[1]);
                worst[0] = worst[0].max((H / sum - 1.0).abs());
                worst[1] = worst[1].max(apart);
                worst[2] = worst[2].max((gradient.z - force[2]).abs());
            }
        }
        let fits = worst.iter().zip(most).all(|(found, most)| *found < most);
        assert!(fits, "{half:?}: {worst:?}");
    }
}

/// Where it slips the force is on the surface of the set, `f·ŵ = F̄ H(ŵ)`, and as it is the
/// gradient of a norm no other force of the set does more; its derivatives are those of central
/// differences, and what is short is borne as by a spring.
#[test]
fn a_face_slips_along_the_normal_of_the_forces_that_it_bears() {
    let mut random = Random(31);
    let (mut slips, mut sticks, mut between) = (0, 0, 0);
    for _ in 0..6000 {
        let face = any_face(&mut random);
        let cap = random.uniform(0.5, 2.0);
        let size = libm::pow(10.0, random.uniform(-0.5, 0.5));
        let y = random.unit() * (cap * size);
        let found = face.bear(y, cap);
        let (H, _) = norm(&face, &y);
        let reached = (H - EVEN_HELD * y.norm()) / (1.0 - EVEN_HELD);
        assert_eq!(face.holds(&y, cap), reached < cap);
        assert!(H < 1.05 * y.norm() && H > 0.83 * y.norm(), "{H}");
        let most = |w: &Vec3| cap * norm(&face, w).0;
        for _ in 0..20 {
            let w = random.unit();
            assert!(found.force.dot(&w) < most(&w) * (1.0 + 1e-12));
        }
        let springs = face.springs(&y, cap);
        if reached > cap {
            slips += 1;
            let gain = found.force.dot(&found.slip);
            assert!((gain - most(&found.slip)).abs() < 1e-12 * cap);
            let left = face.bear(found.left, cap * (1.0 - 1e-9)).force;
            assert!((left - found.force).norm() < 2e-9 * cap);
        } else {
            sticks += 1;
            assert!((found.left - y).norm() <= 0.0);
            between += i32::from(!springs);
        }
        if springs {
            assert!((found.force - y).norm() <= 0.0);
        }
        let by = 1e-5 * cap;
        let kink = |y: &Vec3| {
            let at = |cap: f64| (face.holds(y, cap), face.springs(y, cap));
            let bends = [-3.0, 3.0].map(|k| y.norm() < EVEN_HELD * (cap + k * by));
            at(cap - 3.0 * by) != at(cap + 3.0 * by) || bends[0] != bends[1]
        };
        if kink(&y) {
            continue;
        }
        let along = random.unit();
        let difference = |a: Borne<Vec3>, b: Borne<Vec3>| (a.force - b.force) / (2.0 * by);
        let [ahead, behind] = [by, -by].map(|by| face.bear(y + along * by, cap));
        let slope = face.slope(&found.left, cap, reached > cap);
        let w = face.along(&along);
        let own = [0, 1, 2].map(|i| (0..3).map(|j| slope[i][j] * w[j]).sum());
        let expected = face.vector(&own) * found.share;
        let found_by = difference(ahead, behind);
        assert!((found_by - expected).norm() < 1e-7, "{found_by} {expected}");
        let slip = found.slip;
        let curvature = face.curvature((&found.left, &slip), cap, &along);
        assert!((curvature * found.share - along.dot(&expected)).abs() < 1e-12);
        if springs || reached > cap {
            let [ahead, behind] = [by, -by].map(|by| face.bear(y, cap + by));
            assert!((difference(ahead, behind) - found.growth).norm() < 1e-7);
        }
    }
    assert!(
        slips > 1000 && sticks > 1000 && between > 200,
        "{slips} {sticks} {between}"
    );
}

/// The gradient of a convex function: the force rises along every change of what spring and
/// damper give, and its work on a closed way is none, but for the sum.
#[test]
fn the_force_of_a_face_is_the_gradient_of_a_convex_function() {
    let mut random = Random(34);
    for _ in 0..4000 {
        let face = any_face(&mut random);
        let size = libm::pow(10.0, random.uniform(-0.7, 0.7));
        let [a, b] = [0, 1].map(|_| random.unit() * (size * random.uniform(0.5, 2.0)));
        let [f, g] = [a, b].map(|y| face.bear(y, 1.0).force);
        assert!((f - g).dot(&(a - b)) >= -1e-15, "{a} {b}");
        if !(face.holds(&a, 1.0) && face.holds(&b, 1.0)) {
            continue;
        }
        let parts = 200;
        let mut work = 0.0;
        for i in 0..parts {
            let y = a + (b - a) * ((f64::from(i) + 0.5) / f64::from(parts));
            work += face.bear(y, 1.0).force.dot(&(b - a)) / f64::from(parts);
        }
        let more = 0.5 * (face.twice_held(&b, 1.0) - face.twice_held(&a, 1.0));
        assert!((work - more).abs() < 1e-4, "{work} {more}");
    }
}

/// At the largest ratio of `H` to the length that there is, which the test above holds it to.
#[test]
fn a_short_force_is_borne_as_by_a_spring_in_all_directions() {
    assert!(matches!(Face::hold(1.05, EVEN_SHORT), Hold::Spring));
}

/// As for [`crate::law::friction`]: `h F·u ≥ Δφ(k ς)/k`.
#[test]
fn a_face_gives_back_no_more_than_it_was_paid() {
    let mut random = Random(32);
    for _ in 0..20_000 {
        let h = libm::pow(10.0, random.uniform(-7.0, -1.0));
        let u = random.unit() * libm::pow(10.0, random.uniform(-5.0, 1.0));
        let element = ElastoPlastic {
            cap: 2.0,
            stiffness: 2e4,
            damping: 30.0,
            displacement: random.unit() * random.uniform(0.0, 1.5e-4),
            limit: any_face(&mut random),
        };
        let element = ElastoPlastic {
            displacement: element.clipped(element.displacement),
            ..element
        };
        let paid = h * u.dot(&element.respond(u, h).force);
        let (before, after) = (element.displacement, element.next(u, h));
        let held = |displacement: Vec3| {
            let element = ElastoPlastic {
                displacement,
                ..element
            };
            0.5 * element.twice_stored()
        };
        let more = held(after) - held(before);
        assert!(more <= paid + 1e-16, "{h} {u} {before}: {more} {paid}");
    }
}

/// Of a point, and of what only slides or only spins.
#[test]
fn without_a_face_or_a_spin_the_norm_is_the_length() {
    let mut random = Random(33);
    for _ in 0..500 {
        let face = any_face(&mut random);
        let way = random.unit();
        let along = (way - face.axes[2] * face.axes[2].dot(&way)).normalize();
        let point = Face::new(&face.axes[2], &across(&face.axes[2]), (0.0, [0.0; 2]));
        for (limit, y) in [
            (face, along * 3.0),
            (face, face.axes[2] * 3.0),
            (point, way * 3.0),
        ] {
            let found = limit.bear(y, 1.0);
            let unit = y.normalize();
            assert!((found.force - unit).norm() < 1e-12);
            assert!((found.slip - unit).norm() < 1e-12);
        }
    }
}
