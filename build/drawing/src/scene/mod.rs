//! What a robot looks like and what its variables mean: `resources/scene.bin` of an FMU.
//!
//! Pictures, reports and live views draw this and nothing else. `format` says what it holds, `make`
//! writes it from a robot, `mesh` and `texture` pack triangles and images into it, `tie` adds rods
//! and springs between two points, `pose` says where its links are for given values of variables.
//! The format is described in `docs/scene.md`; the FMU's library never reads the file.

mod format;
mod make;
mod mesh;
mod pose;
mod texture;
mod tie;

pub use format::{
    Contact, Drawn, End, FILE_NAME, Head, Joint, Link, Mesh, Motion, MotionKind, Note, Root, Scene,
    SceneError, Shape, Texture, Tie, Track, Variable, Wrench,
};
pub use make::make;
pub use mesh::Triangles;
pub use pose::{link_poses, pose};
pub use tie::between;

#[cfg(test)]
mod tests;
