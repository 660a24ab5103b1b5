//! What a robot looks like: its scene, as an FMU holds it, and pictures of it.
//!
//! | module | holds |
//! |---|---|
//! | `image` | PNG and JPEG: files to pixels and back |
//! | [`scene`] | shapes, meshes and textures of a robot, and what its variables move |
//! | [`picture`] | stills and animations of a scene |
//!
//! Nothing here writes a file or prints. It is a package of its own because it computes much, which
//! the command does not: for tests this is compiled with optimisation, and the command is not.

mod image;
pub mod picture;
pub mod scene;
