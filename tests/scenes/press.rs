//! Bodies that stand, tip, rest, bounce and slide.

use super::truth::Law;
use super::{BASE, G, H, Run, Scene, Solver, Z, figure, fixed, idle, last, play, single, slope};
use crate::testing::inertia;
use std::path::Path;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{Model, Motion};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{InputSlot, Simulation};
use urdf2fmu_core::spatial::{Pose, Vec3};
use urdf2fmu_core::{assemble, urdf};

/// Inertia of a homogeneous cylinder of 1 kg.
fn cylinder_moments(radius: f64, half_length: f64) -> [f64; 3] {
    let across = radius * radius / 4.0 + half_length * half_length / 3.0;
    [across, across, radius * radius / 2.0]
}

/// Whether a standing can tips that is pushed at its centre of mass by `share` of the force that
/// tips a rigid one, towards `angle`. The force grows for half a second and stays.
fn tips(radius: f64, tall: f64, angle: f64, share: f64, solver: Solver) -> Run {
    let half_length = tall * radius;
    let shape = Shape::Cylinder {
        radius,
        half_length,
    };
    let moments = cylinder_moments(radius, half_length);
    let mut b = single(1.0, moments, shape, 2.0 / tall);
    b.model.roots[0].position.z = half_length - 0.5 * b.model.contact.penetration;
    let force = G * radius / half_length * share;
    let (sin, cos) = libm::sincos(angle);
    let mut push = |s: &mut Simulation, t: f64| {
        let now = force * (t / 0.5).min(1.0);
        s.set_input(InputSlot::ExternalForce(BASE, 0), now * cos);
        s.set_input(InputSlot::ExternalForce(BASE, 1), now * sin);
    };
    // Half way to where it would fall without a push.
    let upright = libm::cos(0.5 * libm::atan(1.0 / tall));
    let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
        let q = &s.state().physical.q;
        let fell = 1.0 - 2.0 * (q[4] * q[4] + q[5] * q[5]) < upright;
        *seen = vec![f64::from(u8::from(fell))];
        !fell
    };
    play(b.model, solver, [H, 3.0], &mut push, &mut watch)
}

/// The force that tips a standing can as a share of `m g R/z`, pushed at its centre of mass at the
/// height `z` of `tall` radii, in `count` directions: between 0° and 45° for less than 16, all
/// round otherwise.
pub fn tipping(radius: f64, tall: f64, count: u32) -> Scene {
    let whole = if count < 16 {
        0.25 * std::f64::consts::PI
    } else {
        std::f64::consts::TAU
    };
    let parts = if count < 16 { count - 1 } else { count };
    let simulate = move |solver| {
        let mut all = Run::default();
        for i in 0..count {
            let angle = whole * f64::from(i) / f64::from(parts);
            let (mut stands, mut falls) = (0.5, 1.3);
            for _ in 0..8 {
                let share = 0.5 * (stands + falls);
                let run = tips(radius, tall, angle, share, solver);
                all.add_steps(&run);
                if run.seen == [0.0] {
                    stands = share;
                } else {
                    falls = share;
                }
            }
            all.seen.push(0.5 * (stands + falls));
        }
        all
    };
    let judge = |_: Solver, run: &Run| {
        let worst = run
            .seen
            .iter()
            .fold(0.0, |m, share| super::larger(m, (share - 1.0).abs()));
        vec![figure(
            "tipping force, relative, worst direction",
            worst,
            0.01,
        )]
    };
    Scene {
        name: format!("standing can R {radius} m, h {tall} R, {count} directions"),
        source: "statics: m g R/z",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A standing can that is pushed at its centre of mass by `share` of the force that tips it. The
/// force grows for half a second and stays; friction is twice what holds. The can leans on its
/// edge, gives way elastically by less than 0.1 mm, and comes to rest.
pub fn leaning_can(radius: f64, tall: f64, share: f64) -> Scene {
    let half_length = tall * radius;
    let simulate = move |solver| {
        let shape = Shape::Cylinder {
            radius,
            half_length,
        };
        let moments = cylinder_moments(radius, half_length);
        let mut b = single(1.0, moments, shape, 2.0 / tall);
        b.model.roots[0].position.z = half_length - 0.5 * b.model.contact.penetration;
        let force = G / tall * share;
        let mut push = |s: &mut Simulation, t: f64| {
            s.set_input(
                InputSlot::ExternalForce(BASE, 0),
                force * (t / 0.5).min(1.0),
            );
        };
        let mut watch = last(|s| {
            let state = &s.state().physical;
            let fastest = state.v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            vec![state.q[0], fastest]
        });
        play(b.model, solver, [H, 2.0], &mut push, &mut watch)
    };
    let judge = move |_: Solver, run: &Run| {
        let seen = run.seen_or_nan(2);
        vec![
            figure("way of its centre of mass, m", seen[0], 2e-4),
            figure("largest speed after 2 s, m/s or rad/s", seen[1], 1e-3),
        ]
    };
    Scene {
        name: format!("can R {radius:.2} m, h {tall:.1} R, leaning under {share} of its limit"),
        source: "it stays where it is",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A shape of 1 kg at rest: how it is turned, how high its frame is when it just touches, and the
/// weight of what presses.
pub struct Resting {
    name: &'static str,
    shape: Shape,
    rpy: Vec3,
    height: f64,
    share: f64,
    /// Held upright by a vertical guide: it would fall over.
    guided: bool,
}

/// Corners of a cube of half the edge 0.1 m, of a dodecahedron, and of a prism of 32 sides, with
/// the height of the centre over the face that they stand on.
fn hulls() -> [(&'static str, Vec<Vec3>, f64); 3] {
    let cube = (0..8)
        .map(|i| Vec3::from_fn(|axis, _| if i >> axis & 1 == 0 { -0.1 } else { 0.1 }))
        .collect();
    // A regular dodecahedron: two pentagons and ten corners between; one face lies flat.
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let ring = |radius: f64, z: f64, turn: f64| {
        (0..5).map(move |i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * (f64::from(i) + turn) / 5.0);
            Vec3::new(radius * cos, radius * sin, z)
        })
    };
    // Circumradius 0.1 m: the face's circle and its height, and those of the middle corners.
    let edge = 0.1 * 4.0 / (3.0_f64.sqrt() * (1.0 + 5.0_f64.sqrt()));
    let face = edge / (2.0 * libm::sin(std::f64::consts::PI / 5.0));
    let top = (0.01 - face * face).sqrt();
    let wide = face * golden;
    let middle = (0.01 - wide * wide).sqrt();
    let dodecahedron = ring(face, -top, 0.0)
        .chain(ring(wide, -middle, 0.0))
        .chain(ring(wide, middle, 0.5))
        .chain(ring(face, top, 0.5))
        .collect();
    let prism = (0..64)
        .map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i / 2) / 32.0);
            Vec3::new(0.1 * cos, 0.1 * sin, if i % 2 == 0 { -0.1 } else { 0.1 })
        })
        .collect();
    [
        ("hull of 8 corners", cube, 0.1),
        ("hull of 20 corners", dodecahedron, top),
        ("hull of 64 corners", prism, 0.1),
    ]
}

/// All shapes of the depths' law.
pub fn resting() -> Vec<Resting> {
    let quarter = std::f64::consts::FRAC_PI_2;
    let cube = Shape::Box {
        half: Vec3::new(0.1, 0.1, 0.1),
    };
    let flat = Shape::Box {
        half: Vec3::new(0.15, 0.1, 0.05),
    };
    let ball = |radius| Shape::Sphere { radius };
    let can = Shape::Cylinder {
        radius: 0.1,
        half_length: 0.15,
    };
    let capsule = Shape::Capsule {
        radius: 0.05,
        half_length: 0.1,
    };
    let lying = Vec3::new(quarter, 0.0, 0.0);
    let (upright, edge) = (Vec3::zeros(), Vec3::new(0.5 * quarter, 0.0, 0.0));
    // A corner down: turned by 45° about x, then by atan(1/√2) about y.
    let corner = Vec3::new(0.5 * quarter, libm::atan(0.5_f64.sqrt()), 0.0);
    let of = |name, shape, rpy, height, share, guided| Resting {
        name,
        shape,
        rpy,
        height,
        share,
        guided,
    };
    let mut all = vec![
        of("box on a face", cube.clone(), upright, 0.1, 1.0, false),
        of("flat box", flat, upright, 0.05, 1.0, false),
        of(
            "box on an edge",
            cube.clone(),
            edge,
            0.1 * 2.0_f64.sqrt(),
            0.5,
            true,
        ),
        of(
            "box on a corner",
            cube,
            corner,
            0.1 * 3.0_f64.sqrt(),
            0.25,
            true,
        ),
        of("ball", ball(0.1), upright, 0.1, 1.0, false),
        of("small ball", ball(0.01), upright, 0.01, 1.0, false),
        of("lying can", can.clone(), lying, 0.1, 1.0, false),
        of("standing can", can, upright, 0.15, 0.5, false),
        of("lying capsule", capsule.clone(), lying, 0.05, 1.0, false),
        of("standing capsule", capsule, upright, 0.15, 0.5, true),
    ];
    for (name, vertices, height) in hulls() {
        all.push(of(
            name,
            Shape::Hull { vertices },
            upright,
            height,
            1.0,
            false,
        ));
    }
    all
}

impl Resting {
    /// Its height after 2 s on the ground.
    fn rest(&self, solver: Solver) -> Run {
        let start = self.height + 1e-4;
        let moments = [4e-3; 3];
        if self.guided {
            let mut b = fixed();
            let turned = Pose::from_xyz_rpy(Vec3::zeros(), self.rpy);
            let body = inertia(1.0, Vec3::zeros(), moments);
            let link = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(Z), body);
            b.shape(link, self.shape.clone(), turned);
            b.model.initial.joint_positions = vec![start];
            return play(
                b.model,
                solver,
                [H, 2.0],
                &mut idle,
                &mut last(height_at(0)),
            );
        }
        let mut b = single(1.0, moments, self.shape.clone(), 0.8);
        b.model.roots[0].rpy = self.rpy;
        b.model.roots[0].position.z = start;
        play(
            b.model,
            solver,
            [H, 2.0],
            &mut idle,
            &mut last(height_at(2)),
        )
    }
}

fn height_at(place: usize) -> impl Fn(&Simulation) -> Vec<f64> {
    move |s| vec![s.state().physical.q[place]]
}

/// The depths of all shapes of 1 kg under their weight.
pub fn depths() -> Scene {
    let shapes = resting();
    let simulate = move |solver| {
        let mut all = Run::default();
        for shape in &shapes {
            let run = shape.rest(solver);
            all.add_steps(&run);
            all.seen.push(run.seen_or_nan(1)[0]);
        }
        all
    };
    let judge = |_: Solver, run: &Run| {
        let (shapes, law) = (resting(), Law::new(G, 1e-4));
        let seen = run.seen_or_nan(shapes.len());
        let off = |shape: &Resting, seen: f64| shape.height - seen - law.depth(G, shape.share);
        let figures = shapes.iter().zip(seen).map(|(shape, seen)| {
            let name = format!("depth of a {}, m", shape.name);
            figure(&name, off(shape, seen), 1e-9)
        });
        figures.collect()
    };
    Scene {
        name: "depths of 13 shapes, 1 kg".into(),
        source: "the law of stiffness",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A cube of `mass` kg that is pressed down by `load` times its weight, and how deep it sinks: the
/// law of stiffness is that of its own weight.
pub fn pressed(mass: f64, load: f64) -> Scene {
    let simulate = move |solver| {
        let half = Vec3::new(0.1, 0.1, 0.1);
        let moments = [mass * 0.02 / 3.0; 3];
        let mut b = single(mass, moments, Shape::Box { half }, 0.8);
        b.model.roots[0].position.z = 0.1;
        let mut push = |s: &mut Simulation, t: f64| {
            let force = -load * mass * G * (t / 0.5).min(1.0);
            s.set_input(InputSlot::ExternalForce(BASE, 2), force);
        };
        play(
            b.model,
            solver,
            [H, 2.0],
            &mut push,
            &mut last(height_at(2)),
        )
    };
    let judge = move |_: Solver, run: &Run| {
        let depth = Law::new(mass * G, 1e-4).depth((1.0 + load) * mass * G, 1.0);
        let off = (0.1 - run.seen_or_nan(1)[0]) / depth - 1.0;
        vec![
            figure("depth, relative", off, 1e-5),
            figure(
                "depth over the stated penetration",
                (0.1 - run.seen_or_nan(1)[0]) / 1e-4,
                30.0,
            ),
        ]
    };
    Scene {
        name: format!("cube of {mass:.1e} kg under {load:.1e} times its weight"),
        source: "the law of stiffness",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A ball of 0.05 m that falls by `h` m and rebounds with the coefficient `e`.
pub fn bounce([h, e]: [f64; 2]) -> Scene {
    Scene {
        name: format!("bounce from {h} m, e {e}"),
        ..bounce_of(1.0, 0.05, h, e)
    }
}

/// The same of a ball of this mass and radius.
pub fn bounce_of(mass: f64, radius: f64, h: f64, e: f64) -> Scene {
    let simulate = move |solver| {
        let moments = [0.4 * mass * radius * radius; 3];
        let mut b = single(mass, moments, Shape::Sphere { radius }, 0.8);
        b.model.roots[0].position.z = radius + h;
        b.model.links[0].restitution = e;
        if let Some(ground) = &mut b.model.world.ground {
            ground.restitution = e;
        }
        let mut watch = |s: &mut Simulation, seen: &mut Vec<f64>| {
            let state = &s.state().physical;
            let (low, v) = (state.q[2] - radius, state.v[5]);
            let up = low > 0.0 && v > 0.0;
            if up {
                *seen = vec![low + v * v / (2.0 * G)];
            }
            !up
        };
        play(b.model, solver, [H, 3.0], &mut idle, &mut watch)
    };
    let judge = move |_: Solver, run: &Run| {
        let apex = run.seen_or_nan(1)[0];
        vec![
            figure(
                "lift-off over touch-down speed, relative to e",
                (apex / h).sqrt() / e - 1.0,
                5e-3,
            ),
            figure("apex, relative to e² h", apex / (e * e * h) - 1.0, 1e-2),
        ]
    };
    Scene {
        name: format!("ball {mass:.1e} kg, R {radius:.1e} m, from {h:.2} m, e {e:.2}"),
        source: "Newton",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// How a box is set down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placed {
    /// So that it just touches the ground.
    Touching,
    /// Half the stated penetration deep, where a face carries its weight.
    Sunk,
    /// By the exporter, from a URDF without a height.
    Assembled,
}

/// A box of 0.2 × 0.2 × 0.1 m and 1 kg in the gravity of a slope.
fn box_on_slope(angle: f64, mu: f64, placed: Placed) -> Model {
    let (half, g) = (Vec3::new(0.1, 0.1, 0.05), slope(angle));
    if placed == Placed::Assembled {
        let text = r#"<robot name="box"><link name="box">
            <inertial><mass value="1"/><inertia ixx="0.004166666666666667" ixy="0" ixz="0"
                iyy="0.004166666666666667" iyz="0" izz="0.006666666666666667"/></inertial>
            <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision>
            </link></robot>"#;
        let settings = format!(
            "[world]\ngravity = [{:e}, 0, {:e}]\nground = {{ type = \"plane\", friction = {mu} }}\n\
             [link.\"*\"]\nfriction = {mu}\n",
            g.x, g.z
        );
        let settings = Settings::parse(&settings, "box.toml").expect("sound settings");
        let options = urdf::ReadOptions::default();
        let read = urdf::read_str(text, "box.urdf", Path::new("."), &options);
        let built = assemble::build(&read.expect("a sound robot"), &settings);
        return built.expect("a sound robot").model;
    }
    let moments = [0.05 / 12.0, 0.05 / 12.0, 0.08 / 12.0];
    let mut b = single(1.0, moments, Shape::Box { half }, mu);
    b.model.world.gravity = g;
    let sunk = if placed == Placed::Sunk { 0.5 } else { 0.0 };
    b.model.roots[0].position.z = 0.05 - sunk * b.model.contact.penetration;
    b.model
}

/// A box on a slope with `tan θ = steep μ` and μ = 0.4, set down at rest; its way after 2 s.
pub fn release(steep: f64, placed: Placed) -> Scene {
    release_of(0.4, steep, placed)
}

/// The same with this friction.
pub fn release_of(mu: f64, steep: f64, placed: Placed) -> Scene {
    let angle = libm::atan(steep * mu);
    let simulate = move |solver| {
        let model = box_on_slope(angle, mu, placed);
        let mut watch = last(|s| vec![s.state().physical.q[0]]);
        play(model, solver, [H, 2.0], &mut idle, &mut watch)
    };
    let judge = move |_: Solver, run: &Run| {
        let (sin, cos) = libm::sincos(angle);
        let way = 0.5 * G * (sin - mu * cos) * 4.0;
        let off = run.seen_or_nan(1)[0] / way - 1.0;
        vec![figure("way after 2 s, relative", off, 0.01)]
    };
    Scene {
        name: format!("release at tan θ = {steep:.4} μ, μ {mu:.2}, {placed:?}"),
        source: "½ g (sin θ − μ cos θ) t²",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}
