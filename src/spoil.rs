//! Fills scratch memory with NaN, for the test that no result depends on its contents.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{
    Contact, ContactPoint, ContactSet, Drive, JointResponse, JointTerm, Memory, Other,
    PointResponse, PointVelocity, Response, Responses, Terms, Touch, Turn, TurnResponse,
    Velocities,
};
use crate::kinematics::Kinematics;
use crate::law::normal::Stiffening;
use crate::law::{Damping, ElastoPlastic, HuntCrossley, Radial, Resistance, SpeedLine};
use crate::spatial::{Mat3, Pose, SpatialInertia, Vec3};
use crate::state::{Physical, State, Trend};

/// What can be spoilt.
pub trait Spoil {
    /// Makes every number NaN, every index one beyond all lists, and every flag true.
    fn spoil(&mut self);
}

/// Spoils each of the fields that are listed. All fields of the type must be listed; those after
/// the semicolon stay.
macro_rules! spoil {
    ($type:ty: $($field:ident)*; $($kept:ident)*) => {
        impl $crate::spoil::Spoil for $type {
            fn spoil(&mut self) {
                let Self { $($field,)* $($kept: _,)* } = self;
                $($crate::spoil::Spoil::spoil($field);)*
            }
        }
    };
}
pub(crate) use spoil;

impl Spoil for f64 {
    fn spoil(&mut self) {
        *self = f64::NAN;
    }
}

impl Spoil for usize {
    fn spoil(&mut self) {
        *self = usize::MAX;
    }
}

impl Spoil for u64 {
    fn spoil(&mut self) {
        *self = u64::MAX;
    }
}

impl Spoil for bool {
    fn spoil(&mut self) {
        *self = true;
    }
}

impl Spoil for std::ops::Range<usize> {
    fn spoil(&mut self) {
        (self.start, self.end) = (usize::MAX, usize::MAX);
    }
}

impl<A: Spoil, B: Spoil> Spoil for (A, B) {
    fn spoil(&mut self) {
        self.0.spoil();
        self.1.spoil();
    }
}

impl Spoil for Vec3 {
    fn spoil(&mut self) {
        self.fill(f64::NAN);
    }
}

impl Spoil for Mat3 {
    fn spoil(&mut self) {
        self.fill(f64::NAN);
    }
}

impl Spoil for Drive {
    fn spoil(&mut self) {
        *self = Self::Effort(f64::NAN);
    }
}

impl Spoil for State {
    fn spoil(&mut self) {
        self.physical.spoil();
        for field in self.fields_mut() {
            field.fill(f64::NAN);
        }
    }
}

impl<T: Spoil> Spoil for Option<T> {
    fn spoil(&mut self) {
        if let Some(value) = self {
            value.spoil();
        }
    }
}

impl<T: Spoil, const N: usize> Spoil for [T; N] {
    fn spoil(&mut self) {
        self.iter_mut().for_each(Spoil::spoil);
    }
}

impl<T: Spoil> Spoil for Box<T> {
    fn spoil(&mut self) {
        T::spoil(self);
    }
}

impl<T: Spoil> Spoil for Vec<T> {
    fn spoil(&mut self) {
        self.iter_mut().for_each(Spoil::spoil);
    }
}

impl Spoil for Radial {
    fn spoil(&mut self) {}
}

impl<X: Spoil, L: Spoil> Spoil for ElastoPlastic<X, L> {
    fn spoil(&mut self) {
        let Self {
            cap,
            stiffness,
            damping,
            displacement,
            limit,
        } = self;
        for number in [cap, stiffness, damping] {
            number.spoil();
        }
        displacement.spoil();
        limit.spoil();
    }
}

spoil!(Pose: R p;);
spoil!(SpatialInertia: mass moment rotational;);
spoil!(HuntCrossley: stiffness damping;);
spoil!(SpeedLine: stall no_load;);
spoil!(Response: depth force slope load friction;);
spoil!(Resistance<Vec3>: force slope around slip;);
spoil!(PointResponse: weight bend impulse rock rocking tilting lean end;);
spoil!(PointVelocity: along tilt;);
spoil!(TurnResponse: impulse normal tangential slip;);
spoil!(JointResponse: impulse stiffness effort;);
spoil!(Touch: slot displacement turn bounce sliding;);
spoil!(Memory: touches motor dry sliding;);
spoil!(Trend: first whole;);
spoil!(Responses: contacts points turns joints springs;);
spoil!(Velocities: contacts points turns springs;);
spoil!(Physical: q v memory;);
spoil!(Terms: contacts turns joints springs;);
spoil!(Other: body from axes;);
spoil!(
    Contact: body other link other_link slot thickness mass normal uneven points depth weights
    spring damping load tilting bounce duration center radius oblong pull drift rise bent carried
    rubbing mu turning critical dissipation wound friction;
);
spoil!(ContactPoint: corner x normal row arm depth share load rim;);

spoil!(ContactSet: list points depths; pairs);
spoil!(Stiffening: stiffness reference;);
spoil!(Damping: dissipation fastest power;);
spoil!(Turn: contact body other slot normal coefficient load stiffened critical torsional rolling;);
impl Spoil for JointTerm {
    /// What is the same in every step stays: which degree of freedom it is, and whether it has
    /// limits and an actuator.
    fn spoil(&mut self) {
        let Self {
            dof: _,
            coordinate: _,
            actuator,
            damping,
            dry,
            wound,
            gap,
            limit,
            drive,
            line,
            speed_limit,
            speed_damping,
        } = self;
        for number in [damping, wound, speed_limit, speed_damping] {
            number.spoil();
        }
        dry.spoil();
        limit.spoil();
        if gap[0].is_finite() {
            gap.spoil();
        }
        if actuator.is_some() {
            drive.spoil();
            line.spoil();
        }
    }
}

spoil!(Kinematics: origins X S V I composite M inverse_diagonal bias force C loops;);
