//! First time derivatives of outputs: of positions, orientations and velocities. Others (efforts,
//! contact forces, accelerations, energies) have none: they may jump.

use super::{Level, Readout, joint_orientation, quaternion};
use crate::model::{BodyId, JointId, Model, RootId};
use crate::sensor::frame::pose;
use crate::slots::{Axis, OutputSlot, Sensed};
use crate::spatial::{Vec3, angular, linear, quaternion_product};
use crate::state::State;
use crate::step::point::Context;

impl Readout {
    /// Time derivative of an output at the state's time, from the right where forces jump; None if
    /// it has none.
    #[expect(clippy::too_many_lines, reason = "one line for each kind of output")]
    pub fn derivative(&mut self, ctx: &Context, state: &State, slot: OutputSlot) -> Option<f64> {
        use OutputSlot as O;
        let model = ctx.model;
        if Self::is_held(ctx, slot) {
            return None;
        }
        let derivative = match slot {
            O::BasePosition(root, axis) => self.read(ctx, state, O::BaseLinearVelocity(root, axis)),
            O::BaseOrientation(root, axis) => {
                let q = std::array::from_fn(|i| {
                    self.read(ctx, state, O::BaseOrientation(root, LETTERS[i]))
                });
                world_quaternion_rate(q, &self.base_spin(ctx, state, root), axis)
            }
            O::BaseRpy(root, axis) => {
                let omega = self.base_spin(ctx, state, root);
                rpy_rate(&self.rpy(ctx, root), &omega, axis)
            }
            O::BaseLinearVelocity(root, axis) => {
                self.at(ctx, state, Level::Accelerations);
                let (q, v) = (&state.physical.q, &state.physical.v);
                let base = ctx.tree.base_frame(root);
                base.map_or(0.0, |b| b.acceleration(q, v, &self.vdot)[axis as usize])
            }
            O::BaseAngularVelocity(root, axis) => {
                self.at(ctx, state, Level::Accelerations);
                let base = ctx.tree.base_frame(root);
                base.map_or(0.0, |base| self.vdot[base.dof + axis as usize])
            }
            O::JointPosition(joint, axis) => self.read(ctx, state, O::JointVelocity(joint, axis)),
            O::JointVelocity(joint, axis) => {
                self.read(ctx, state, O::JointAcceleration(joint, axis))
            }
            O::JointOrientation(joint, axis) => {
                joint_orientation_rate(model, state, joint, axis, |axis| {
                    super::joint_rate(model, &state.physical.v, joint, axis)
                })
            }
            O::LinkPosition(link, axis) => self.read(ctx, state, O::LinkLinearVelocity(link, axis)),
            O::LinkOrientation(link, axis) => {
                let omega = Vec3::from_fn(|i, _| {
                    self.read(ctx, state, O::LinkAngularVelocity(link, LETTERS[i]))
                });
                let q = quaternion(&self.link_pose(ctx, link.index()));
                world_quaternion_rate(q, &omega, axis)
            }
            O::LinkAngularVelocity(link, axis) => {
                let body = model.links[link.index()].body.index();
                self.at(ctx, state, Level::BodyAccelerations);
                self.A[body][axis as usize]
            }
            O::LinkLinearVelocity(link, axis) => {
                let body = model.links[link.index()].body.index();
                self.at(ctx, state, Level::BodyAccelerations);
                let (A, V) = (&self.A[body], &self.point.kin.V[body]);
                let r = self.link_pose(ctx, link.index()).p;
                let omega = angular(V);
                // Spatial accelerations are rates at a fixed point: that of the link's origin moves
                // on with it.
                let velocity = linear(V) + omega.cross(&r);
                let a = linear(A) + angular(A).cross(&r) + omega.cross(&velocity);
                a[axis as usize]
            }
            O::Sensor(sensor, Sensed::Orientation(axis)) => {
                let q = std::array::from_fn(|i| {
                    self.read(
                        ctx,
                        state,
                        O::Sensor(sensor, Sensed::Orientation(LETTERS[i])),
                    )
                });
                let (body, _) = pose(ctx, &self.point, sensor.index());
                world_quaternion_rate(q, &angular(&self.point.kin.V[body]), axis)
            }
            O::Sensor(sensor, Sensed::AngularVelocity(axis)) => {
                self.at(ctx, state, Level::BodyAccelerations);
                let (body, X) = pose(ctx, &self.point, sensor.index());
                // In moving axes: `d(Rᵀω)/dt = Rᵀ α`, because ω does not turn in its own axes.
                (X.R.transpose() * angular(&self.A[body]))[axis as usize]
            }
            O::JointAcceleration(..)
            | O::Sensor(..)
            | O::JointEffort(_)
            | O::ContactActive(_)
            | O::ContactForce(..)
            | O::ContactPoint(..)
            | O::PairActive(_)
            | O::PairForce(..)
            | O::PairPoint(..)
            | O::PairNormal(..)
            | O::PairDepth(_)
            | O::PairSlipSpeed(_)
            | O::LoopForce(..)
            | O::LoopTorque(..)
            | O::LoopEffort(_)
            | O::LoopGap(_)
            | O::SpringForce(..)
            | O::SpringLength(_)
            | O::EnergyKinetic
            | O::EnergyPotential
            | O::State(_)
            | O::Rate(_)
            | O::Indicator
            | O::Steps
            | O::Rejected
            | O::NewtonMax => return None,
        };
        // Roll and yaw have no rate where pitch is ±90°.
        derivative.is_finite().then_some(derivative)
    }

    fn base_spin(&mut self, ctx: &Context, state: &State, root: RootId) -> Vec3 {
        self.at(ctx, state, Level::Kinematics);
        let body = ctx.model.roots[root.index()].body;
        angular(&self.point.kin.V[body.index()])
    }
}

/// Axes of a vector or quaternion.
const LETTERS: [Axis; 4] = [0, 1, 2, 3];

/// `q̇ = ½ ω q` of a quaternion x, y, z, w, with `ω` in world axes.
fn world_quaternion_rate([x, y, z, w]: [f64; 4], omega: &Vec3, axis: Axis) -> f64 {
    let spin = [0.0, 0.5 * omega.x, 0.5 * omega.y, 0.5 * omega.z];
    quaternion_product(&spin, &[w, x, y, z])[(axis as usize + 1) % 4]
}

/// Rates of roll, pitch and yaw about fixed axes: `ω = ψ̇ ẑ + Rz(ψ) (θ̇ ŷ + Ry(θ) φ̇ x̂)` solved
/// for them.
fn rpy_rate(rpy: &Vec3, omega: &Vec3, axis: Axis) -> f64 {
    let (sin_pitch, cos_pitch) = (libm::sin(rpy.y), libm::cos(rpy.y));
    let (sin_yaw, cos_yaw) = (libm::sin(rpy.z), libm::cos(rpy.z));
    let roll = (cos_yaw * omega.x + sin_yaw * omega.y) / cos_pitch;
    match axis {
        0 => roll,
        1 => cos_yaw * omega.y - sin_yaw * omega.x,
        _ => omega.z + sin_pitch * roll,
    }
}

/// Rate of the orientation of a floating joint; `rate` gives its velocities by axis, 3–5 in child
/// axes.
fn joint_orientation_rate(
    model: &Model,
    state: &State,
    joint: JointId,
    axis: Axis,
    rate: impl Fn(Axis) -> f64,
) -> f64 {
    let bodies = &model.joints[joint.index()].bodies;
    let quaternion = |body: &BodyId| model.bodies[body.index()].motion.kind().quaternion();
    if bodies.last().and_then(quaternion).is_none() {
        return 0.0;
    }
    // A floating joint slides along 0–2 first: as many axes as bodies before the one that turns.
    #[expect(clippy::cast_possible_truncation, reason = "at most four bodies")]
    let first = (bodies.len() - 1) as Axis;
    let [x, y, z, w] = LETTERS.map(|axis| joint_orientation(model, state, joint, axis));
    // `q̇ = ½ q ω` with ω in child axes.
    let spin = [
        0.0,
        0.5 * rate(first),
        0.5 * rate(first + 1),
        0.5 * rate(first + 2),
    ];
    quaternion_product(&[w, x, y, z], &spin)[(axis as usize + 1) % 4]
}

#[cfg(test)]
mod tests {
    use crate::model::{LinkId, Model, Sampling, Sensor, SensorKind};
    use crate::simulation::{OutputSlot, Simulation};
    use crate::spatial::{Pose, Vec3};
    use crate::testing::{Random, random_tree};
    use crate::variables::{Kind, Slot, table};
    use std::sync::Arc;

    /// Central differences over ± 1e-4 s: their error is 1e-8/6 times the third derivative, up to
    /// some 1e3 here.
    fn check(mut model: Model, random: &mut Random) {
        model.outputs.links = (0..model.links.len()).map(LinkId::from).collect();
        model.outputs.sensors = (0..model.links.len())
            .map(|l| Sensor {
                name: format!("imu{l}"),
                link: LinkId::from(l),
                X_LS: Pose::from_xyz_rpy(random.vector(0.5), random.vector(1.0)),
                kind: SensorKind::Imu,
                sampling: Sampling::default(),
            })
            .collect();
        model.roots[0].position = Vec3::new(1.0, -2.0, 3.0);
        model.roots[0].rpy = Vec3::new(0.4, -0.7, 2.0);
        model.roots[0].angular_velocity = random.vector(2.0);
        model.roots[0].linear_velocity = random.vector(1.0);
        for velocity in &mut model.initial.joint_velocities {
            *velocity = random.uniform(-2.0, 2.0);
        }
        model.world.ground = None;
        model.solver.tolerance = 1e-10;
        let rows = table(&model).expect("names do not clash");
        let slots: Vec<(String, OutputSlot)> = rows
            .into_iter()
            .filter(|row| row.kind == Kind::Real)
            .filter_map(|row| match row.slot {
                Slot::Output(slot) => Some((row.name, slot)),
                _ => None,
            })
            .collect();
        let mut s = Simulation::new(Arc::new(model));
        s.initialize(0.0).expect("a sound model");
        // A joint without an initial velocity of its own turns and slides, too.
        for v in &mut s.state_mut().physical.v {
            *v += random.uniform(-1.0, 1.0);
        }
        let mut at = |time: f64| -> Vec<(f64, Option<f64>)> {
            s.advance_to(time).expect("finite");
            let slots = slots.iter();
            slots
                .map(|(_, slot)| (s.output(*slot), s.output_derivative(*slot)))
                .collect()
        };
        let (t, d) = (0.2, 1e-4);
        let (before, now, after) = (at(t - d), at(t), at(t + d));
        for (i, (name, _)) in slots.iter().enumerate() {
            let Some(derivative) = now[i].1 else {
                let jumps = ["acceleration", "effort", "contact", "energy"];
                assert!(jumps.iter().any(|word| name.contains(word)), "{name}");
                continue;
            };
            let difference = (after[i].0 - before[i].0) / (2.0 * d);
            assert!(
                (derivative - difference).abs() < 1e-4 * (1.0 + difference.abs()),
                "{name}: {derivative} {difference}"
            );
        }
    }

    #[test]
    fn derivatives_are_those_of_the_outputs_over_time() {
        for (seed, floating) in [(3, true), (5, false), (8, true)] {
            let mut random = Random(seed);
            let model = random_tree(&mut random, 6, floating, true);
            check(model, &mut random);
        }
    }

    #[cfg(feature = "urdf")]
    #[test]
    fn derivatives_of_planar_and_floating_joints_are_those_of_the_outputs_over_time() {
        let link = |name: &str| {
            format!(
                "<link name='{name}'><inertial><origin xyz='0.1 0.2 -0.1'/><mass value='2'/>\
                 <inertia ixx='0.1' iyy='0.2' izz='0.25' ixy='0' ixz='0' iyz='0'/></inertial></link>"
            )
        };
        let joint = |kind: &str, parent: &str, child: &str| {
            format!(
                "<joint name='to_{child}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>\
                 <origin xyz='0.3 0.1 0.2' rpy='0.5 0.4 0.3'/><axis xyz='0 0.6 0.8'/></joint>"
            )
        };
        let text = format!(
            "<robot name='r'>{}{}{}{}{}</robot>",
            link("base"),
            link("drone"),
            link("puck"),
            joint("floating", "base", "drone"),
            joint("planar", "drone", "puck"),
        );
        let options = crate::urdf::ReadOptions::default();
        let folder = std::path::Path::new(".");
        let description =
            crate::urdf::read_str(&text, "r.urdf", folder, &options).expect("a robot");
        let settings = crate::settings::Settings::default();
        let model = crate::assemble::build(&description, &settings).expect("a model");
        check(model.model, &mut Random(4));
    }

    #[test]
    fn roll_and_yaw_have_no_rate_where_pitch_is_a_right_angle() {
        let omega = Vec3::new(0.0, 1.0, 0.0);
        let rpy = Vec3::new(0.0, 0.0, 0.0);
        assert!((super::rpy_rate(&rpy, &omega, 1) - 1.0).abs() < 1e-15);
        // At exactly 90° in floating point the cosine is 6e-17: rates are finite but huge unless
        // nothing turns.
        let rpy = Vec3::new(0.0, std::f64::consts::FRAC_PI_2, 0.0);
        assert!(super::rpy_rate(&rpy, &Vec3::x(), 0).abs() > 1e15);
    }
}
