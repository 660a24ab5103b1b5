//! Indices into the lists of a model, one type a list.

use serde::{Deserialize, Serialize};

macro_rules! id {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// Position in its list.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl From<usize> for $name {
            fn from(index: usize) -> Self {
                Self(u32::try_from(index).expect("a robot has fewer than 2^32 parts"))
            }
        }
    )*};
}

id! {
    /// Index into [`super::Model::links`].
    LinkId,
    /// Index into [`super::Model::joints`].
    JointId,
    /// Index into [`super::Model::bodies`].
    BodyId,
    /// Index into [`super::Model::dofs`], into `v` and into `tau`.
    DofId,
    /// Index into [`super::Model::actuators`].
    ActuatorId,
    /// Index into [`super::Model::roots`].
    RootId,
    /// Index into [`super::OutputSelection::sensors`].
    SensorId,
    /// Index into [`super::OutputSelection::pairs`].
    PairId,
    /// Index into [`super::Model::loops`].
    LoopId,
    /// Index into [`super::Model::springs`].
    SpringId,
    /// Index into [`crate::continuous::States`].
    StateId,
}

impl RootId {
    /// The tree of the robot itself.
    pub const ROBOT: Self = Self(0);
}
