//! Sensors as a file has them.

use crate::pattern::Pattern;
use crate::spatial::Vec3;

/// A sensor as the file has it, lengths scaled.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorDescription {
    /// Its name.
    pub name: Pattern,
    /// The link, or the joint of a force–torque sensor.
    pub on: Pattern,
    /// Origin in the link, m.
    pub xyz: Vec3,
    /// Roll, pitch, yaw in the link, rad.
    pub rpy: Vec3,
    /// What it measures.
    pub kind: SensedKind,
    /// Samples a second; none: not given, or 0.
    pub rate: Option<f64>,
    /// Bias and standard deviation per axis: of angular velocity and specific force, of force and
    /// torque, or of distances, which have one.
    pub errors: Vec<[[f64; 3]; 2]>,
}

/// What a sensor of a file measures.
#[derive(Clone, Debug, PartialEq)]
pub enum SensedKind {
    /// An inertial unit.
    Imu,
    /// Force and torque in a joint.
    ForceTorque {
        /// In the axes of the parent link.
        in_parent: bool,
        /// What the child does to the parent.
        reversed: bool,
    },
    /// Distances.
    Ray {
        /// Number, first and last angle of the rays in a row, rad.
        columns: (u32, [f64; 2]),
        /// The same of the rows.
        rows: (u32, [f64; 2]),
        /// Least and largest distance, m.
        range: [f64; 2],
    },
    /// Contacts of a link.
    Contact,
}
