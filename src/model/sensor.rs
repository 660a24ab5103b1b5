//! Sensors: what they measure, where, how often and how well.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::id::{JointId, LinkId};
use crate::spatial::{Pose, Vec3};
use serde::{Deserialize, Serialize};

/// A sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// In the names of its outputs.
    pub name: String,
    /// The link that it is fixed to; of a force–torque sensor the one whose axes it has; of an
    /// encoder the child of its joint.
    pub link: LinkId,
    /// Its frame in the link's.
    pub X_LS: Pose,
    /// What it measures.
    pub kind: SensorKind,
    /// How often and how well; ideal where it is left out.
    #[serde(default, skip_serializing_if = "Sampling::is_ideal")]
    pub sampling: Sampling,
}

/// How often and how well a sensor measures.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Samples a second, each held until the next one; none: it follows the state.
    pub rate: Option<f64>,
    /// Of its noise, together with its name.
    pub seed: u32,
    /// What is added to each of [`Sensor::channels`] that can err, in their order; of rays one
    /// for all. Empty: nothing.
    pub bias: Vec<f64>,
    /// Standard deviation of what is added to each of them anew in each sample, likewise.
    pub noise: Vec<f64>,
}

impl Sampling {
    /// Whether a sensor measures what is there at the moment.
    pub fn is_ideal(&self) -> bool {
        *self == Self::default()
    }

    /// Whether any noise is added.
    pub fn is_noisy(&self) -> bool {
        self.noise.iter().any(|deviation| *deviation > 0.0)
    }
}

/// What a sensor measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum SensorKind {
    /// Orientation in the world, angular velocity and specific force in its own axes.
    Imu,
    /// Force and torque that a joint's parent exerts on its child, about the child's origin.
    ForceTorque {
        /// Any joint, fixed ones included.
        joint: JointId,
        /// Whether it tells what the child exerts on the parent instead.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        reversed: bool,
    },
    /// Distances to whatever is in the way, but for what is on the sensor's own body.
    Ray {
        /// Unit vectors in the sensor's frame, row by row.
        directions: Vec<Vec3>,
        /// Rays in a row.
        columns: u32,
        /// Where rays begin, m.
        near: f64,
        /// Largest distance, m.
        range: f64,
        /// Whether it tells what is hit, too.
        hits: bool,
        /// Links that its rays go through, ascending.
        ignored: Vec<LinkId>,
    },
    /// Position of a turning or sliding joint in whole steps.
    Encoder {
        /// The joint.
        joint: JointId,
        /// The step, rad or m.
        step: f64,
    },
    /// What presses on a link.
    Contact {
        /// Half extents, m, of the box about the sensor's frame in which contacts count; none:
        /// all of the link's.
        half: Option<Vec3>,
    },
}

impl Sensor {
    /// Real numbers that it measures, and hits, in the order in which they are held.
    pub fn channels(&self) -> usize {
        match &self.kind {
            // Four of the orientation, which do not err.
            SensorKind::Imu => 10,
            SensorKind::ForceTorque { .. } => 6,
            SensorKind::Ray {
                directions, hits, ..
            } => directions.len() * if *hits { 2 } else { 1 },
            SensorKind::Encoder { .. } => 1 + usize::from(self.sampling.rate.is_some()),
            SensorKind::Contact { .. } => 5,
        }
    }

    /// The channels that can err: the first one, and how many numbers [`Sampling::bias`] has for
    /// them.
    pub fn erring(&self) -> (usize, usize) {
        match &self.kind {
            SensorKind::Imu => (4, 6),
            SensorKind::ForceTorque { .. } => (0, 6),
            SensorKind::Ray { .. } => (0, 1),
            SensorKind::Encoder { .. } | SensorKind::Contact { .. } => (0, 0),
        }
    }

    /// Numbers that are held of it: how many samples it has taken, when the last one, and its
    /// channels. None where it follows the state.
    pub fn held(&self) -> usize {
        self.sampling.rate.map_or(0, |_| 2 + self.channels())
    }
}
