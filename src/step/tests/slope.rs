//! Slopes, cans, rods and mass ratios; gravity turned by an angle stands for a slope.

use super::*;

/// Gravity as on a slope of `angle`, falling along +x.
pub(super) fn slope(angle: f64) -> Vec3 {
    Vec3::new(libm::sin(angle), 0.0, -libm::cos(angle)) * G
}

/// One hour on 20° with μ = 1, and a minute with a 5 Hz side load that reaches 86 % of the cone (peers creep by
/// millimetres to metres an hour, see `docs/accuracy.md`).
#[test]
fn a_block_on_a_slope_does_not_creep() {
    let mut b = block(1.0, 1.0);
    // Centre of mass in the contact plane: all corners carry the same, and reach the same share of the cone.
    b.model.links[0].inertia.com.z = -0.1;
    b.model.world.gravity = slope(20.0_f64.to_radians());
    b.model.outputs.external_wrenches = vec![0u32.into_link()];
    let mut s = start(b.model, 1e-4);
    run(&mut s, 5.0, 0.01);
    let x0 = s.state().q[0];
    run(&mut s, 3605.0, 1.0);
    assert!(
        (s.state().q[0] - x0).abs() < 1e-9,
        "{}",
        s.state().q[0] - x0
    );
    // Peak: √(sin² + side²) = 0.86 cos.
    let (sin, cos) = libm::sincos(20.0_f64.to_radians());
    let side = G * ((0.86 * cos) * (0.86 * cos) - sin * sin).sqrt();
    let mut marks = Vec::new();
    for i in 1..=12_000 {
        let t = f64::from(i) * 0.005;
        let load = side * libm::sin(std::f64::consts::TAU * 5.0 * t);
        s.set_input(InputSlot::ExternalForce(0u32.into_link(), 1), load);
        s.advance_to(3605.0 + t).expect("finite");
        if i % 1200 == 0 {
            marks.push(s.state().q[0]);
        }
    }
    let drift = marks[9] - marks[1];
    assert!(drift.abs() < 1e-7, "{drift}");
}

/// Friction of a block with the same load on all corners acts against the motion, whatever its direction.
#[test]
fn friction_is_isotropic() {
    for degrees in [0.0, 17.0, 45.0, 73.0, 90.0_f64] {
        let (s, c) = libm::sincos(degrees.to_radians());
        let mut b = block(1.0, 0.5);
        b.model.links[0].inertia.com.z = -0.1;
        b.model.initial.position.z = 0.1 - 1e-4;
        b.model.initial.linear_velocity = Vec3::new(c, s, 0.0);
        let mut sim = start(b.model, 1e-5);
        run(&mut sim, 0.15, 0.01);
        let angle = libm::atan2(sim.state().v[4], sim.state().v[3]);
        assert!(
            (angle - degrees.to_radians()).abs() < 1e-6,
            "{degrees}: {angle}"
        );
    }
}

/// Rolling down: a = 5/7 g sin θ for a ball, 2/3 g sin θ for a cylinder (rigid-body textbooks); slipping where
/// μ < 2/7 tan θ resp. 1/3 tan θ.
#[test]
fn balls_and_cylinders_roll_down_a_slope_as_rigid_bodies_do() {
    let angle = 10.0_f64.to_radians();
    let ball = (Shape::Sphere { radius: 0.1 }, [4e-3; 3], 5.0 / 7.0, 4e-4);
    let cylinder = (
        Shape::Cylinder {
            radius: 0.1,
            half_length: 0.05,
        },
        [1.0 / 12.0 * (0.03 + 0.01), 1.0 / 12.0 * (0.03 + 0.01), 5e-3],
        2.0 / 3.0,
        2e-4,
    );
    for (shape, I, share, depth) in [ball, cylinder] {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), I));
        b.shape(0u32.into_link(), shape, Pose::IDENTITY);
        b.model.initial.rpy.x = std::f64::consts::FRAC_PI_2;
        b.model.initial.position.z = 0.1 - depth;
        b.model.world.gravity = slope(angle);
        let mut s = start(b.model, 1e-5);
        run(&mut s, 0.5, 0.01);
        let v0 = s.state().v[3];
        run(&mut s, 1.5, 0.01);
        let a = s.state().v[3] - v0;
        assert!((a - share * G * libm::sin(angle)).abs() < 1e-4, "{a}");
        let slip = s.state().v[3] - 0.1 * s.state().v[1];
        assert!(slip.abs() < 1e-6, "{slip}");
    }
}

/// A rod that slides point first with μ = 2 (Painlevé): rigid bodies have no solution, compliant ones do.
#[test]
fn painleves_rod_finishes_without_gaining_energy() {
    for tolerance in [1e-3, 1e-5] {
        let mut b = Builder::new(
            true,
            inertia(1.0, Vec3::zeros(), [1.0 / 12.0, 1.0 / 12.0, 1e-4]),
        );
        b.shape(
            0u32.into_link(),
            Shape::Capsule {
                radius: 0.01,
                half_length: 0.5,
            },
            Pose::IDENTITY,
        );
        b.model.links[0].friction = 2.0;
        b.model.world.ground = Some(crate::model::Ground {
            friction: 2.0,
            ..Default::default()
        });
        b.model.initial.rpy.y = -0.6;
        b.model.initial.position.z = 0.5 * libm::cos(0.6) + 0.01;
        b.model.initial.linear_velocity.x = 2.0;
        let mut s = start(b.model, tolerance);
        let energy = |s: &mut Simulation| {
            s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
        };
        let initial = energy(&mut s);
        let mut lowest = initial;
        for i in 1..=400 {
            s.advance_to(f64::from(i) * 0.01).expect("finite");
            let now = energy(&mut s);
            // What the contact stores at an impact of 2 m/s, ½ k x², comes back for a moment.
            assert!(now < initial && now < lowest + 2e-2, "{i}: {now} {lowest}");
            lowest = lowest.min(now);
        }
        assert!(lowest < 0.2, "it lies and rests: {lowest}");
    }
}

/// A gram under a ton: the contact carries both, as deep as its stiffness says.
#[test]
fn a_mass_ratio_of_a_million_rests_at_the_static_penetration() {
    let mut b = Builder::new(true, inertia(1e-3, Vec3::zeros(), [1e-6; 3]));
    for (x, y) in [(0.1, 0.1), (-0.1, 0.1), (0.1, -0.1), (-0.1, -0.1)] {
        b.shape(
            0u32.into_link(),
            Shape::Sphere { radius: 0.05 },
            at(x, y, 0.0),
        );
    }
    let torso = b.link(
        0u32.into_link(),
        at(0.0, 0.0, 0.2),
        Motion::Prismatic(Vec3::z()),
        inertia(1e3, Vec3::zeros(), [10.0; 3]),
    );
    b.limits(torso, 0.0, 0.1);
    b.model.initial.position.z = 0.05;
    let mut s = start(b.model, 1e-3);
    run(&mut s, 3.0, 1.0 / 240.0);
    let depth = 0.05 - height(&mut s);
    assert!((depth - 1e-4).abs() < 1e-6, "{depth}");
    let force = s.output(OutputSlot::ContactForce(0u32.into_link(), 2));
    assert!((force / (1000.001 * G) - 1.0).abs() < 1e-6, "{force}");
}

/// A can set down at a small tilt settles flat, whatever the tilt.
#[test]
fn a_can_set_down_tilted_settles_on_its_end() {
    for degrees in [0.0, 2.0, 4.0, 6.0, 9.0_f64] {
        let I = [
            1.0 / 12.0 * (3.0 * 0.01 + 0.09),
            1.0 / 12.0 * (3.0 * 0.01 + 0.09),
            5e-3,
        ];
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), I));
        b.shape(
            0u32.into_link(),
            Shape::Cylinder {
                radius: 0.1,
                half_length: 0.15,
            },
            Pose::IDENTITY,
        );
        let tilt = degrees.to_radians();
        b.model.initial.rpy.y = tilt;
        b.model.initial.position.z = 0.15 * libm::cos(tilt) + 0.1 * libm::sin(tilt);
        let mut s = start(b.model, 1e-3);
        run(&mut s, 6.0, 1.0 / 240.0);
        assert!(
            (height(&mut s) - (0.15 - 1e-4)).abs() < 1e-6,
            "{degrees}: {}",
            height(&mut s)
        );
        assert!(
            s.state().v.iter().all(|v| v.abs() < 1e-9),
            "{degrees}: {:?}",
            s.state().v
        );
    }
}
