//! Pictures of a robot, without a graphics card, and with the same bytes on every platform.
//!
//! A scene at given poses becomes triangles with normals (`solid`), seen by a `camera`; `raster`
//! finds what is visible at each sample, `depth` how near it is to a lamp, both of them by `rows`
//! of triangles; `sky` draws the pictures of the sky's lamps of a robot made of `cubes`, `light`
//! computes how much of the sky and of the lamp each place sees, `shade` makes colours of it, `png`
//! writes them. `texture` has images in several sizes (mipmaps), `run` and `film` make an animation
//! of a run; `frames` are the axes of links.
//!
//! Only additions, multiplications, divisions and square roots are used, which IEEE 754 defines to
//! the last bit, and functions of `libm`. Threads work on different rows and lamps, and no sum is
//! split between them.

mod aim;
mod camera;
mod color;
mod cubes;
mod depth;
mod film;
mod frames;
mod light;
mod look;
mod png;
mod raster;
mod rows;
mod run;
mod shade;
mod sky;
mod solid;
mod still;
mod texture;

pub use camera::Camera;
pub use film::film;
pub use look::{Look, Theme, Toward};
pub use run::{ShowError, poses};
pub use still::{all, still};
