//! Thin wheels on edges that lie along their axes, and tips of acute hulls.

use super::super::nearest::nearest;
use super::super::placed::Placed;
use super::*;

/// A wheel of 0.1 m against the upper edge of a box of 5 mm height that lies along its axis but for
/// a rotation of `tilt`, and reaches over it by 1 m and more on both sides.
struct OnEdge {
    wheel: Solid,
    step: Solid,
    /// The edge, where the middle of the wheel is.
    edge: Vec3,
    poses: [Pose; 2],
}

impl OnEdge {
    /// - `half`: half of its width, m
    /// - `over`: how deep the edge is in it, m
    fn new([half, over, tilt]: [f64; 3], random: &mut Random) -> Self {
        let radius = 0.1;
        let half_height = 0.0025;
        let edge = Vec3::new(0.45, 0.2, 2.0 * half_height);
        let [up, far] = [radius - edge.z, radius - over];
        let middle = Vec3::new(edge.x - (far * far - up * up).sqrt(), edge.y, radius);
        let spin = turned(Vec3::y(), random.uniform(-3.0, 3.0));
        let lying = turned(Vec3::x(), std::f64::consts::FRAC_PI_2);
        let R = turned(random.unit(), random.uniform(0.0, tilt)) * spin * lying;
        let half_step = Vec3::new(2.5, 1.0, half_height);
        Self {
            wheel: solid(&Shape::Cylinder {
                radius,
                half_length: half,
            }),
            step: solid(&Shape::Box { half: half_step }),
            edge,
            poses: [
                at(middle, R),
                at(
                    Vec3::new(edge.x + half_step.x, 0.0, half_height),
                    Mat3::identity(),
                ),
            ],
        }
    }

    /// Depth after the wheel has moved by `way` and turned by `turn` about the edge.
    fn depth(&self, [way, turn]: [Vec3; 2]) -> f64 {
        let mut patch = Patch::new();
        let angle = turn.norm();
        let R = if angle > 0.0 {
            turned(turn, angle)
        } else {
            Mat3::identity()
        };
        let X = &self.poses[0];
        let moved = at(self.edge + R * (X.p - self.edge) + way, R * X.R);
        let [wheel, step] = [(&self.wheel, &moved), (&self.step, &self.poses[1])];
        patch.find(wheel, step, 0.0);
        depth(patch.points())
    }
}

/// Tilts, rad: of wheels that have been built into a robot, and turned by round-off.
const TILTS: [f64; 6] = [0.0, 1e-17, 1e-12, 1e-10, 1e-8, 1e-7];

/// The edge of the core of the box is at a place that is known, and so is the axis of the wheel:
/// the direction between the cores is what is across both. It was off by up to 1e-5 where the edge
/// and the axis were parallel but for 1e-8: the search along the edge ended by its number of looks.
#[test]
fn an_edge_along_a_thin_cylinder_has_its_direction_to_round_off() {
    let mut random = Random(0x5DEE_CE66_D1CE_4E5B);
    for i in 0..3000 {
        let tilt = TILTS[i % 6];
        let half = [0.015, 0.005, 0.002][i % 3];
        let over = random.uniform(0.0, 0.2) * half * 0.02;
        let on = OnEdge::new([half, over, tilt], &mut random);
        let [a, b] = [(&on.wheel, &on.poses[0]), (&on.step, &on.poses[1])]
            .map(|(solid, X)| Placed::new(solid, X, &on.poses[0].p));
        let found = nearest(&a, &b, 1e-3).normal;
        let r = b.solid.radius;
        let edge = on.edge + Vec3::new(r, 0.0, -r);
        let across = on.poses[0].p - edge;
        let expected = Vec3::new(across.x, 0.0, across.z).normalize();
        let off = (found - expected).norm();
        assert!(off < 1e-11 + 1.5 * tilt, "{tilt} {half} {over}: {off}");
    }
}

/// No displacement by 25 nm makes the depth grow by more than about that, nor any rotation by as
/// much over the radius, also where inner cores take part. It grew by up to forty times as much:
/// the end of the wheel, seen from its side, was over the step or not by round-off.
#[test]
fn the_depth_of_a_thin_wheel_on_an_edge_has_a_slope() {
    let mut random = Random(0x0DDB_1A5E_5BAD_5EED);
    let by = 2.5e-8;
    for i in 0..3000 {
        let half = [0.015, 0.0095, 0.005][i % 3];
        let over = random.uniform(0.0, 4e-4);
        let on = OnEdge::new([half, over, TILTS[i % 6]], &mut random);
        let here = on.depth([Vec3::zeros(); 2]);
        for kind in 0..2 {
            for axis in 0..3 {
                let mut ways = [Vec3::zeros(); 2];
                ways[kind][axis] = [by, by / 0.1][kind];
                let slope = (on.depth(ways) - here) / by;
                assert!(slope.abs() < 2.0, "{half} {over} {kind} {axis}: {slope}");
            }
        }
    }
}

/// A tip is as deep in the top of a box as in a plane there, however acute it is. The core of one
/// of 5° ends ten roundings before its tip, which was in a box by a millimetre before it was found.
#[test]
fn the_tip_of_an_acute_hull_is_as_deep_in_a_box_as_in_a_plane() {
    let mut random = Random(0x7EA5_0000_ACCE_55ED);
    let step = Shape::Box {
        half: Vec3::new(1.0, 1.0, 0.05),
    };
    for degrees in [1.0_f64, 2.0, 5.0, 10.0, 20.0, 40.0] {
        let (height, corners) = (0.2, 8);
        let radius = height * degrees.to_radians().tan();
        let mut vertices = vec![Vec3::zeros()];
        for i in 0..corners {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(corners);
            vertices.push(Vec3::new(
                radius * angle.cos(),
                radius * angle.sin(),
                height,
            ));
        }
        let spike = Shape::Hull { vertices };
        for deep in [1e-6, 5e-5, 3e-4] {
            let tip = Vec3::new(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), -deep);
            let X = at(tip, turned(random.unit(), random.uniform(0.0, 0.3)));
            let below = at(Vec3::new(0.0, 0.0, -0.05), Mat3::identity());
            let on_box = find((&spike, X), (&step, below), 1e-3);
            let on_plane = find((&spike, X), (&Shape::Plane, Pose::IDENTITY), 1e-3);
            let most = |patch: &Patch| patch.points().iter().map(|p| p.depth).fold(0.0, f64::max);
            let [found, expected] = [&on_box, &on_plane].map(most);
            assert!(
                (found - expected).abs() < 1e-12 && (expected - deep).abs() < 1e-12,
                "{degrees}° {deep}: {found} {expected}"
            );
        }
    }
}
