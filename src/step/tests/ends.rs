//! Where terrain ends: what slides or rolls over the end goes on as mechanics says.

use super::terrain::{field, grid, ground, mesh, over, rough_ground, shapes};
use super::worlds::body;
use super::*;
use std::f64::consts::FRAC_PI_2;

/// What may slide across an end: its shape, its attitude, and how high its middle is.
fn sliding() -> [(&'static str, Shape, Vec3, f64); 5] {
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(0.15 * sign(1), 0.1 * sign(2), 0.1 * sign(4))
    };
    let (radius, half_length) = (0.1, 0.15);
    let flat = Vec3::zeros();
    [
        (
            "box",
            Shape::Box {
                half: Vec3::new(0.15, 0.1, 0.1),
            },
            flat,
            0.1,
        ),
        (
            "hull",
            Shape::Hull {
                vertices: (0..8).map(corner).collect(),
            },
            flat,
            0.1,
        ),
        (
            "capsule across",
            Shape::Capsule {
                radius,
                half_length,
            },
            Vec3::new(0.0, FRAC_PI_2, 0.0),
            0.1,
        ),
        (
            "can across",
            Shape::Cylinder {
                radius,
                half_length,
            },
            Vec3::new(0.0, FRAC_PI_2, 0.0),
            0.1,
        ),
        (
            "standing can",
            Shape::Cylinder {
                radius: 0.15,
                half_length: 0.1,
            },
            flat,
            0.1,
        ),
    ]
}

/// Even terrain that ends at 1 m.
fn even() -> [(&'static str, Shape); 2] {
    let even = |_: f64, _: f64| 0.0;
    [
        ("mesh", mesh(&grid(2.0, 1, even))),
        ("heights", field(2.0, 20, even)),
    ]
}

/// A body of 1 kg without friction on terrain, at a place and an attitude, that goes along x.
fn going((shape, surface): (&Shape, &Shape), [place, rpy]: [Vec3; 2], speed: f64) -> Model {
    let mut one = body(1.0, shape.clone(), place);
    one.links[0].friction = 0.0;
    one.roots[0].rpy = rpy;
    one.roots[0].linear_velocity = X * speed;
    over(ground(surface.clone(), Vec3::zeros()), one)
}

/// Without friction a body goes on at its speed until its middle is over the end: nothing pushes it
/// but upwards. The triangles let go of a corner where it had left them, and the edge took it up a
/// millimetre later, where its rounding had left them, too: in between the front tipped by 0.1 mm,
/// and then hit the edge. A box at 0.5 m/s had 0.15 m/s left, and a capsule that lay across the end
/// was carried only while its front was down. On heights the corners let go where the samples at
/// the end came in with twice their share, and a box at 3 m/s had 2.66 m/s left at 1e-5.
#[test]
fn what_slides_over_the_end_of_terrain_keeps_its_speed() {
    let terrains = even();
    for (name, shape, rpy, height) in sliding() {
        for (terrain, surface) in &terrains {
            for (speed, tolerance) in [0.5, 3.0].into_iter().flat_map(each_tolerance) {
                let start_at = Vec3::new(0.8, 0.0, height - 5e-5);
                let model = going((&shape, surface), [start_at, rpy], speed);
                let mut s = start(model, tolerance);
                // Its middle is a centimetre before the end.
                run(&mut s, 0.19 / speed, 1.0 / 240.0);
                let x = s.state().physical.q[0];
                assert!(
                    (x - 0.99).abs() < 5e-4,
                    "{name} on {terrain} with {speed} m/s at {tolerance:e}: {x} instead of 0.99"
                );
            }
        }
    }
}

fn each_tolerance(speed: f64) -> [(f64, f64); 3] {
    [1e-3, 1e-4, 1e-5].map(|tolerance| (speed, tolerance))
}

/// A ball or a wheel without friction that leaves the end at a speed at which it takes off at once
/// (v² > g R) falls along a parabola. Samples at the end of a field carried it together with the
/// surface before the end and threw it up by 0.12 m/s in fixed steps.
#[test]
fn what_rolls_off_the_end_of_terrain_is_not_thrown_up() {
    let terrains = even();
    let lying = Vec3::new(FRAC_PI_2, 0.0, 0.0);
    let (radius, half_length) = (0.1, 0.15);
    let shapes = [
        ("ball", Shape::Sphere { radius }, Vec3::zeros()),
        (
            "capsule",
            Shape::Capsule {
                radius,
                half_length,
            },
            lying,
        ),
        (
            "wheel",
            Shape::Cylinder {
                radius,
                half_length,
            },
            lying,
        ),
    ];
    for (name, shape, rpy) in shapes {
        for (terrain, surface) in &terrains {
            for beside in [0.0, 0.03, 0.05] {
                for tolerance in [0.0_f64, 1e-3, 1e-5] {
                    let start_at = Vec3::new(0.8, beside, radius - 5e-5);
                    let mut model = going((&shape, surface), [start_at, rpy], 3.0);
                    if tolerance == 0.0 {
                        model.solver.step_size = 1.0 / 240.0;
                    }
                    let mut s = start(model, tolerance.max(1e-3));
                    run(&mut s, 0.2, 1.0 / 240.0);
                    let q = &s.state().physical.q;
                    let falls = 0.2 - 0.2 / 3.0;
                    let z = radius - 0.5 * G * falls * falls;
                    // A step of 1/240 s in which it leaves carries it to its end.
                    let allowed = if tolerance > 0.0 { 1e-3 } else { 6e-3 };
                    assert!(
                        (q[2] - z).abs() < allowed && (q[0] - 1.4).abs() < 1e-3,
                        "{name} on {terrain}, {beside} beside, at {tolerance:e}: {q:?}, {z}"
                    );
                }
            }
        }
    }
}

/// Terrain of two meshes that meet is one: what slides over the seam goes on at its speed, in fixed
/// steps, too. The end of the second mesh was a crest, and a box of 0.1 m at 1.6 m/s ran against it
/// and stood still; so did 22 of 34 boxes and 32 of 34 cans.
#[test]
fn what_slides_over_the_seam_of_two_meshes_does_not_stumble() {
    let flat = || mesh(&grid(2.0, 1, |_, _| 0.0));
    for (name, shape, rpy, height) in sliding() {
        for speed in [1.0, 1.6, 2.1, 3.0] {
            for (tolerance, step) in [(1e-3, 1.0 / 240.0), (1e-3, 0.0), (1e-5, 0.0)] {
                let start_at = Vec3::new(0.7, 0.02, height - 5e-5);
                let mut model = going((&shape, &flat()), [start_at, rpy], speed);
                let mut second = ground(flat(), Vec3::zeros());
                second.roots[0].position.x = 2.0;
                model.join(second, "second", crate::model::RootKind::Object);
                model.world.ground = None;
                model.solver.step_size = step;
                let mut s = start(model, tolerance);
                run(&mut s, 0.6 / speed, 1.0 / 240.0);
                let x = s.state().physical.q[0];
                assert!(
                    (x - 1.3).abs() < 5e-4,
                    "{name} with {speed} m/s at {tolerance:e}, steps of {step}: {x} instead of 1.3"
                );
            }
        }
    }
}

/// Terrain of heights goes on in heights and in a mesh beside it, and a mesh in heights: what
/// slides or rolls over the seam goes on at its speed, and no deeper. The end of heights was a
/// crest, and a can whose lowest point was over the other terrain than its middle was carried by
/// neither: one of four fell through, others were 0.14 m beside their way.
#[test]
fn what_goes_over_the_seam_of_heights_does_not_stumble() {
    let heights = || field(2.0, 8, |_, _| 0.0);
    let flat = || mesh(&grid(2.0, 1, |_, _| 0.0));
    let ball = ("ball", Shape::Sphere { radius: 0.1 }, Vec3::zeros(), 0.1);
    for (name, shape, rpy, height) in sliding().into_iter().chain([ball]) {
        for (from, one, other) in [
            ("heights to heights", heights(), heights()),
            ("heights to a mesh", heights(), flat()),
            ("a mesh to heights", flat(), heights()),
        ] {
            for (tolerance, step) in [(1e-3, 1.0 / 240.0), (1e-3, 0.0), (1e-5, 0.0)] {
                let start_at = Vec3::new(0.7, 0.02, height - 5e-5);
                let mut model = going((&shape, &one), [start_at, rpy], 2.1);
                let mut second = ground(other.clone(), Vec3::zeros());
                second.roots[0].position.x = 2.0;
                model.join(second, "second", crate::model::RootKind::Object);
                model.world.ground = None;
                model.roots[0].angular_velocity = Vec3::new(0.0, 0.0, 0.5);
                model.solver.step_size = step;
                let mut s = start(model, tolerance);
                run(&mut s, 0.6 / 2.1, 1.0 / 240.0);
                let q = &s.state().physical.q;
                let off = Vec3::new(q[0] - 1.3, q[1] - 0.02, q[2] - height + 5e-5);
                assert!(
                    off.norm() < 5e-4,
                    "{name} from {from} at {tolerance:e}, steps of {step}: {off}"
                );
            }
        }
    }
}

/// A corridor of 8 m joins the middle of the 10 m of a plate's end. Beside it the plate ends: what
/// stands there with its middle on the plate stays. While the end counted as a seam wherever four
/// places of it went on, boxes, balls and capsules fell through.
#[test]
fn what_stands_on_an_end_that_goes_on_in_part_does_not_fall_through() {
    let plate = |[from, to]: [f64; 2], width: f64| {
        let corner = |x: f64, side: f64| Vec3::new(x, 0.5 * side * width, 0.0);
        let [a, b] = [corner(from, -1.0), corner(to, -1.0)];
        let [c, d] = [corner(to, 1.0), corner(from, 1.0)];
        mesh(&[[a, b, c], [a, c, d]])
    };
    // Its cells at the end are joined as a whole or not at all.
    let heights = || field(10.0, 100, |_, _| 0.0);
    for (name, shape, rpy, height) in sliding() {
        for (wide, end) in [(plate([-4.0, 0.0], 10.0), 0.0), (heights(), 5.0)] {
            let start_at = Vec3::new(end - 0.05, 4.6, height - 5e-5);
            let mut model = going((&shape, &wide), [start_at, rpy], 0.0);
            let second = ground(plate([end, end + 4.0], 8.0), Vec3::zeros());
            model.join(second, "second", crate::model::RootKind::Object);
            model.world.ground = None;
            let mut s = start(model, 1e-3);
            run(&mut s, 0.5, 1.0 / 240.0);
            let z = s.state().physical.q[2];
            assert!(
                (z - height).abs() < 0.01,
                "{name} at {end}: {z} instead of {height}"
            );
        }
    }
}

/// What falls beside uneven ground meets nothing, however deep it falls: below the end of heights
/// and of a mesh there is no wall.
#[test]
fn what_falls_beside_rough_ground_falls_freely() {
    let mut random = Random(72);
    for case in 0..56 {
        let (_, shape, ..) = shapes()[case % 7].clone();
        let terrain = rough_ground(case);
        let side = if case % 3 == 0 { Vec3::x() } else { -Vec3::y() };
        let at = side.cross(&Vec3::z()) * random.vector(0.8).x
            + side * (1.7 + 0.2 * f64::from(case as u32 % 5));
        let mut one = body(1.0, shape.clone(), Vec3::new(at.x, at.y, 0.0));
        one.roots[0].rpy = random.vector(3.0);
        one.roots[0].linear_velocity = side * random.uniform(0.0, 0.1);
        let mut s = start(over(ground(terrain, Vec3::zeros()), one), 1e-3);
        let begin = s.state().physical.v[3..6].to_vec();
        run(&mut s, 2.0, 0.01);
        let v = &s.state().physical.v;
        assert_eq!(v[3..5], begin[..2], "{case} {shape:?}");
        assert!((v[5] - begin[2] + 2.0 * G).abs() < 1e-9, "{case} {shape:?}");
    }
}
