//! Description and settings → model: bodies, mimic joints, defaults, initial pose.
//!
//! In: [`crate::urdf::Description`] (checked URDF, lengths already scaled, see
//! [`crate::urdf::ReadOptions`]) and [`Settings`]. Out: [`crate::model::Model`] and every
//! assumption that was taken, as notes.
//!
//! - Links joined by fixed joints are one body; each keeps its frame (`Link::X_BL`). A body's frame
//!   is the frame of the link that its joint carries.
//! - A planar joint is a chain of two sliding and one turning body. With the normal `n` these slide
//!   along `u` and `n × u`; `u` is the part of a coordinate axis in the plane: x for a normal along
//!   z, y for x, z for y. A floating joint slides along x, y, z and then turns freely.
//! - A spherical joint is one body that turns freely; it has no actuator.
//! - A massless root whose only joint is floating is the world: root and joint are left out, the
//!   child is a floating base.
//! - Mimic joints share the coordinate of the last joint of their chain.
//! - A mesh on a continuous joint that is round about it becomes a cylinder or a ball.
//! - A moving link may be massless if its children give every degree of freedom inertia.
//!
//! Not done here: reading files, scaling, solving.
//!
//! | code | about |
//! |---|---|
//! | A101 | a name or glob that matches nothing |
//! | A102 | a name or glob that means something unsuitable |
//! | A103 | mimic |
//! | A104 | a moving link without inertia |
//! | A105 | a floating base without mass |
//! | A106 | an initial value outside the limits |
//! | A107 | how the base was chosen |
//! | A108 | merged links |
//! | A109 | massless moving links |
//! | A110 | joint zero outside the limits |
//! | A111 | initial height |
//! | A112 | a start inside the ground |
//! | A113 | effort limits that the file does not give |
//! | A114 | effort limits of zero |
//! | A115 | velocity limits of zero |
//! | A116 | friction that the file does not give |
//! | A117 | position limits that are no range |
//! | A118 | limits narrowed by mimic joints |
//! | A119 | inertia from the collision shapes |
//! | A120 | gains |
//! | A121 | a model that cannot be computed with |
//! | A122 | damping and friction of planar and floating joints |
//! | A123 | a singular inertia replaced by that of the shapes |
//! | A124 | velocity limits that do not bind |
//! | A125 | friction at rest that does not go with sliding friction |
//! | A126 | commands that the file's hardware takes |
//! | A127 | wheels fitted to meshes |
//! | A128 | driven wheels that are polygons |
//! | A130 | groups |
//! | A131 | sensors |
//! | A132 | masses that the conventions of another simulator give |
//! | A133 | settings of a further robot that are the world's |
//! | A134 | an object that is the ground |
//! | A135 | shapes of different trees that overlap at the start |
//! | A136 | links of one robot that overlap before anything moves |
//! | A137 | pairs |
//! | A138 | masses by a density |
//! | A139 | names that clash |
//! | A140 | loops and springs |
//! | A141 | the initial pose that closes the loops |
//! | A142 | what Model Exchange has no equations for |
//! | A143 | gravity that points upwards or along -y, or is not in m/s² |
//! | A144 | settings that change nothing |
//! | A145 | contacts so soft that a robot sinks into the ground |

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod actuators;
mod alone;
mod base;
mod bodies;
mod exchange;
mod findings;
mod guests;
mod idle;
mod inertia;
mod initial;
mod loops;
mod masses;
mod mimic;
mod outputs;
mod pairs;
mod pybullet;
mod robot;
mod sensors;
mod sink;
mod terrain;
mod touch;
mod ways;
mod wheels;
mod world;

use crate::pattern::names_last;
use crate::settings::{Compat, InertiaSource, MeshCollision, Settings};
use crate::urdf::{ImpossibleInertia, MeshShapes, MissingMass, ReadOptions};
pub use alone::{Assembled, build, inspect};
pub use world::{Guest, of_object, of_robot, solid, take_ground, world};

/// What the settings mean for the reader of the URDF: `options` with scale, source of inertia and
/// what meshes become.
pub fn read_options(settings: &Settings, options: ReadOptions) -> ReadOptions {
    ReadOptions {
        scale: settings.scale,
        impossible_inertia: match settings.inertia {
            InertiaSource::Urdf => ImpossibleInertia::Refused,
            InertiaSource::Nearest => ImpossibleInertia::Nearest,
            InertiaSource::Collision | InertiaSource::PyBullet => ImpossibleInertia::Unused,
        },
        missing_mass: if settings.missing_mass.is_some() || settings.compat == Compat::PyBullet {
            MissingMass::All
        } else if settings.density.is_some() {
            MissingMass::Shapes
        } else {
            MissingMass::Nothing
        },
        pybullet: settings.compat == Compat::PyBullet
            || settings.inertia == InertiaSource::PyBullet,
        sensors: settings.described_sensors,
        meshes: names_last(&settings.links, |entry| &entry.link)
            .filter_map(|entry| {
                let shapes = match entry.collision? {
                    MeshCollision::Hull => MeshShapes::Hull,
                    MeshCollision::Objects => MeshShapes::Objects,
                    MeshCollision::Decomposition => MeshShapes::Decomposition,
                };
                Some((entry.link.clone(), shapes))
            })
            .collect(),
        ..options
    }
}

#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
