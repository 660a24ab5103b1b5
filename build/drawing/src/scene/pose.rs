//! Where the links of a scene are, for given values of its variables.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::format::{Head, MotionKind, Scene, Track, Variable};
use std::collections::BTreeMap;
use urdf2fmu_core::spatial::{Mat3, Pose, Vec3, quaternion_from_rotation};

/// Poses `X_WL` of all links.
///
/// - `value`: of a variable by its name; `None` where it is not known, then its start counts
pub fn link_poses(head: &Head, value: impl Fn(&str) -> Option<f64>) -> Vec<Pose> {
    let mut poses = vec![Pose::IDENTITY; head.links.len()];
    for root in &head.roots {
        poses[root.link] = Pose {
            R: rotation(numbers(&root.orientation, &value)),
            p: Vec3::from(numbers(&root.position, &value)),
        };
    }
    for joint in &head.joints {
        let mut X_WC = poses[joint.parent].compose(&pose(&joint.position, &joint.orientation));
        for motion in &joint.motions {
            let axis = Vec3::from(motion.axis);
            let moved = match motion.kind {
                MotionKind::Slide => {
                    let [x] = numbers(&motion.track, &value);
                    Pose {
                        p: axis * x,
                        ..Pose::IDENTITY
                    }
                }
                MotionKind::Turn => {
                    let [angle] = numbers(&motion.track, &value);
                    let (sin, cos) = libm::sincos(0.5 * angle);
                    let v = axis * sin;
                    Pose {
                        R: rotation([v.x, v.y, v.z, cos]),
                        ..Pose::IDENTITY
                    }
                }
                MotionKind::Ball => Pose {
                    R: rotation(numbers(&motion.track, &value)),
                    ..Pose::IDENTITY
                },
            };
            X_WC = X_WC.compose(&moved);
        }
        poses[joint.child] = X_WC;
    }
    poses
}

impl Scene {
    /// Puts bases that cannot move where the parameters `changed` in a run mount them; tells
    /// whether there is one. The start of a base that moves is an output of the run instead.
    pub fn mount(&mut self, changed: &BTreeMap<String, f64>) -> bool {
        let Head {
            roots, variables, ..
        } = &mut self.head;
        let mut any = false;
        for root in roots.iter_mut().filter(|r| r.position.variables.is_empty()) {
            let base = match (root.kind.as_str(), root.name.as_str()) {
                ("object", name) => format!("initial.{name}"),
                (_, "") => "initial.base".to_owned(),
                (_, name) => format!("{name}.initial.base"),
            };
            // Three parameters, of which one has changed.
            let given = |members: [&str; 3]| {
                let mut moved = false;
                let mut values = Vec::new();
                for member in members {
                    let name = format!("{base}.{member}");
                    // Flat names have no dots.
                    let flat = name.replace('.', "_");
                    let of = |variable: &&Variable| [&name, &flat].contains(&&variable.name);
                    let variable = variables.iter().find(of)?;
                    let value = changed.get(&variable.name).copied();
                    moved |= value.is_some();
                    values.push(value.or(variable.start)?);
                }
                moved.then_some(values)
            };
            if let Some(position) = given(["position.x", "position.y", "position.z"]) {
                root.position.start = position;
                any = true;
            }
            if let Some(rpy) = given(["rpy.roll", "rpy.pitch", "rpy.yaw"]) {
                let rpy = Vec3::from_column_slice(&rpy);
                let turned = Pose::from_xyz_rpy(Vec3::zeros(), rpy);
                let q = quaternion_from_rotation(&turned.R);
                root.orientation.start = vec![q.i, q.j, q.k, q.w];
                any = true;
            }
        }
        any
    }
}

/// The numbers of a track; a variable that is not known, or not finite, has its start value.
fn numbers<const N: usize>(track: &Track, value: impl Fn(&str) -> Option<f64>) -> [f64; N] {
    std::array::from_fn(|i| {
        let known = track.variables.get(i).and_then(|name| value(name));
        known
            .filter(|x| x.is_finite())
            .or_else(|| track.start.get(i).copied())
            .unwrap_or_default()
    })
}

/// A pose from its position and its quaternion x, y, z, w.
pub fn pose(position: &[f64; 3], orientation: &[f64; 4]) -> Pose {
    Pose {
        R: rotation(*orientation),
        p: Vec3::from(*position),
    }
}

/// Rotation of a quaternion x, y, z, w of any length above zero.
fn rotation([x, y, z, w]: [f64; 4]) -> Mat3 {
    let square = x * x + y * y + z * z + w * w;
    if square < 1e-12 {
        return Mat3::identity();
    }
    let s = 2.0 / square;
    Mat3::new(
        1.0 - s * (y * y + z * z),
        s * (x * y - z * w),
        s * (x * z + y * w),
        s * (x * y + z * w),
        1.0 - s * (x * x + z * z),
        s * (y * z - x * w),
        s * (x * z - y * w),
        s * (y * z + x * w),
        1.0 - s * (x * x + y * y),
    )
}
