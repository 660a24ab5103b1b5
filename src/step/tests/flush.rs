//! What slides and rolls from one thing to another that is level with it, where these move or are
//! terrain. Those that all stand still are in `plates.rs`.

use super::terrain::{field, grid, ground, mesh};
use super::worlds::{body, world};
use super::*;
use crate::spatial::rotation_from_quaternion;
use std::f64::consts::FRAC_PI_2;

/// Error control, and fixed steps, s.
const MODES: [f64; 2] = [0.0, 1.0 / 240.0];

/// A floor of 2 by 1 m and 0.1 m about x, with its top at a height.
fn plate(x: f64, top: f64) -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let half = Vec3::new(1.0, 0.5, 0.05);
    b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
    b.model.roots[0].position = Vec3::new(x, 0.0, top - 0.05);
    b.model
}

/// The same, with its top at z = 0, that moves as inputs say: not at all.
fn driven(x: f64) -> Model {
    let half = Vec3::new(1.0, 0.5, 0.05);
    let mut plate = body(1.0, Shape::Box { half }, Vec3::new(x, 0.0, -0.05));
    plate.outputs.driven = vec![RootId(0)];
    plate
}

/// A free plate from one x to another that stands on the ground, its top at z = 0.1.
fn free(mass: f64, from: f64, to: f64) -> Model {
    let half = Vec3::new(0.5 * (to - from), 0.5, 0.05);
    body(
        mass,
        Shape::Box { half },
        Vec3::new(0.5 * (from + to), 0.0, 0.05),
    )
}

/// One free board of 2 m, made of boxes side by side.
fn boards(mass: f64, count: usize) -> Model {
    let mut b = Builder::new(true, inertia(mass, Vec3::zeros(), [mass; 3]));
    let half = Vec3::new(1.0 / count as f64, 0.5, 0.05);
    for i in 0..count {
        let x = half.x * (2 * i + 1) as f64 - 1.0;
        b.shape(LinkId(0), Shape::Box { half }, at(x, 0.0, 0.0));
    }
    b.model.roots[0].position.z = 0.05;
    b.model
}

/// Two plates of 2 m, of which a joint moves the second one along x.
fn drawer() -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let half = Vec3::new(1.0, 0.5, 0.05);
    b.shape(LinkId(0), Shape::Box { half }, Pose::IDENTITY);
    let own = inertia(1.0, Vec3::zeros(), [0.1; 3]);
    let link = b.link(
        LinkId(0),
        at(2.0, 0.0, 0.0),
        Motion::Prismatic(Vec3::x()),
        own,
    );
    b.shape(link, Shape::Box { half }, Pose::IDENTITY);
    b.model.roots[0].position = Vec3::new(-1.0, 0.0, -0.05);
    b.model
}

/// What slides, and how high its middle is.
fn sliders() -> [(&'static str, Shape, f64, Vec3); 4] {
    let half = Vec3::new(0.1, 0.1, 0.025);
    let (radius, half_length) = (0.1, 0.025);
    let can = Shape::Cylinder {
        radius,
        half_length,
    };
    let (radius, half_length) = (0.05, 0.1);
    let roller = Shape::Cylinder {
        radius,
        half_length,
    };
    [
        ("slab", Shape::Box { half }, 0.025, Vec3::zeros()),
        ("can", can, 0.025, Vec3::zeros()),
        ("ball", Shape::Sphere { radius }, radius, Vec3::zeros()),
        ("roller", roller, radius, Vec3::x() * FRAC_PI_2),
    ]
}

/// What is left of the speed along x of 1 kg without friction that slides 0.7 m over the joint at
/// x = 0 of things with their tops at a height, as a share.
fn left(
    (shape, height, rpy): (&Shape, f64, &Vec3),
    (top, things): (f64, Vec<Model>),
    [v, step]: [f64; 2],
) -> f64 {
    let mut one = body(1.0, shape.clone(), Vec3::new(-0.4, 0.013, top + height));
    one.roots[0].rpy = *rpy;
    one.roots[0].linear_velocity.x = v;
    let mut model = world([one].into_iter().chain(things));
    // The slider alone has none: boards stay where they are.
    for (i, link) in model.links.iter_mut().enumerate() {
        link.friction = if i == 0 || top <= 0.0 { 0.0 } else { 1.0 };
    }
    if top <= 0.0 {
        model.world.ground = None;
    }
    model.solver.step_size = step;
    let mut s = start(model, 1e-3);
    run(&mut s, 0.7 / v, 1.0 / 240.0);
    let state = &s.state().physical;
    assert!(
        state.q[0] > 0.0,
        "it comes to the other one: {}",
        state.q[0]
    );
    state.v[3] / v
}

/// On one plate all keep their speed. Here 7 % of 0.3 m/s were lost at each tolerance and 46 % in
/// fixed steps, and on a board of eight boxes 8 to 33 % and 78 %: only what stands still told what
/// was beside it.
#[test]
fn what_slides_over_a_level_joint_between_things_that_move_goes_on() {
    type Floor = (&'static str, f64, fn() -> Vec<Model>);
    let floors: [Floor; 9] = [
        ("static, driven", 0.0, || {
            vec![plate(-1.0, 0.0), driven(1.0)]
        }),
        ("driven, static", 0.0, || {
            vec![driven(-1.0), plate(1.0, 0.0)]
        }),
        ("static, 2 mm, driven", 0.0, || {
            vec![plate(-1.0, 0.0), driven(1.002)]
        }),
        ("static, free", 0.1, || {
            vec![plate(-1.0, 0.1), free(100.0, 0.0, 2.0)]
        }),
        ("free, static", 0.1, || {
            vec![free(100.0, -2.0, 0.0), plate(1.0, 0.1)]
        }),
        ("free, free", 0.1, || {
            vec![free(100.0, -2.0, 0.0), free(100.0, 0.0, 2.0)]
        }),
        ("eight free ones", 0.1, || {
            let at = |i: usize| 0.25 * i as f64 - 1.0;
            (0..8).map(|i| free(20.0, at(i), at(i + 1))).collect()
        }),
        ("eight boxes of one", 0.1, || vec![boards(1000.0, 8)]),
        ("a drawer", 0.0, || vec![drawer()]),
    ];
    for (floor, top, things) in floors {
        for (name, shape, height, rpy) in &sliders()[..3] {
            for v in [0.3, 1.0] {
                for mode in MODES {
                    let left = left((shape, *height, rpy), (top, things()), [v, mode]);
                    // A flat slider on light boards makes these rock.
                    let case = format!("{name} on {floor}, {v} m/s, {mode:?}: {left}");
                    assert!((left - 1.0).abs() < 0.02, "{case}");
                }
            }
        }
    }
}

/// The same from meshes and heights to boxes that are static or driven, and from static ones to
/// these: a slab lost 7 to 46 % of its speed, or was turned round with up to 12 rad/s.
#[test]
fn what_slides_from_terrain_to_a_level_box_goes_on() {
    let square = |x: f64| {
        let moved = |p: Vec3| Vec3::new(p.x + x, p.y, p.z);
        let triangles = grid(2.0, 4, |_, _| 0.0);
        let triangles: Vec<_> = triangles.iter().map(|t| t.map(moved)).collect();
        ground(mesh(&triangles), Vec3::zeros())
    };
    let heights = |x: f64| {
        let mut ground = ground(field(2.0, 10, |_, _| 0.0), Vec3::zeros());
        ground.roots[0].position.x = x;
        ground
    };
    for (name, shape, height, rpy) in &sliders() {
        for yaw in [0.0, 0.4] {
            for mode in MODES {
                let floors = [
                    ("mesh, box", vec![square(-1.0), plate(1.0, 0.0)]),
                    ("box, mesh", vec![plate(-1.0, 0.0), square(1.0)]),
                    ("heights, box", vec![heights(-1.0), plate(1.0, 0.0)]),
                    ("box, heights", vec![plate(-1.0, 0.0), heights(1.0)]),
                    ("mesh, driven box", vec![square(-1.0), driven(1.0)]),
                    ("heights, driven box", vec![heights(-1.0), driven(1.0)]),
                    ("driven box, mesh", vec![driven(-1.0), square(1.0)]),
                ];
                for (floor, things) in floors {
                    let rpy = rpy + Vec3::z() * yaw;
                    let left = left((shape, *height, &rpy), (0.0, things), [0.3, mode]);
                    let case = format!("{name} on {floor}, yaw {yaw}, {mode:?}: {left}");
                    assert!((left - 1.0).abs() < 0.01, "{case}");
                }
            }
        }
    }
}

/// A block of 1 kg on a free table, under whose edge a wedge of 15° is pushed: the block is lifted.
/// What stands on something that moves against it can come off it, so the table does not shut its
/// bottom.
#[test]
fn a_wedge_lifts_a_block_off_a_table_that_moves() {
    let tall = libm::tan(15.0_f64.to_radians()) * 0.2;
    let corner = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let wedge = Shape::Hull {
        vertices: vec![
            corner(0.0, -0.05, 0.0),
            corner(0.0, 0.05, 0.0),
            corner(-0.2, -0.05, 0.0),
            corner(-0.2, 0.05, 0.0),
            corner(-0.2, -0.05, tall),
            corner(-0.2, 0.05, tall),
        ],
    };
    let mut wedge = body(1.0, wedge, Vec3::x() * -0.01);
    wedge.outputs.driven = vec![RootId(0)];
    let half = Vec3::repeat(0.05);
    let block = body(1.0, Shape::Box { half }, Vec3::new(0.05, 0.0, 0.05));
    // A wall keeps it from being pushed away.
    let mut model = world([block, driven(0.0), wedge, plate(1.1, 0.1)]);
    model.world.ground = None;
    for link in &mut model.links {
        link.friction = 0.0;
    }
    for step in [0.0, 1.0 / 240.0] {
        model.solver.step_size = step;
        let mut s = start(model.clone(), 1e-3);
        s.set_input(InputSlot::BaseLinearVelocity(RootId(2), 0), 0.1);
        run(&mut s, 0.7, 1.0 / 240.0);
        // The wedge comes to 0.1 m/s within the first step, and goes 6 cm under the block. Turned
        // by θ, this touches the wall with its top and the wedge with its edge, h high:
        // h = b sin θ = tan 15° (0.06 − b + b sin θ + b cos θ).
        let state = &s.state().physical;
        let turn = rotation_from_quaternion(&[state.q[3], state.q[4], state.q[5], state.q[6]]);
        let edge = state.q[2] + (turn * Vec3::new(-0.05, 0.0, -0.05)).z;
        let (b, slope) = (0.1, libm::tan(15.0_f64.to_radians()));
        let mut sin = 0.0_f64;
        for _ in 0..20 {
            let cos = (1.0 - sin * sin).sqrt();
            sin = slope * (0.06 - b + b * cos) / (b * (1.0 - slope));
        }
        let lifted = b * sin;
        assert!(
            (edge / lifted - 1.0).abs() < 0.02,
            "{step}: {edge} of {lifted}"
        );
    }
}
