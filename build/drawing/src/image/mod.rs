//! Images as files: pixels of PNG and JPEG, PNG of pixels, and images of fewer pixels.
//!
//! The same bytes on every platform: no instructions of one processor or the other, and functions
//! of `libm`.

mod color;
pub mod png;
mod read;
mod reduce;

pub use color::{STEPS, linear, srgb_table};
pub use read::{Pixels, read};
pub use reduce::{light_of_bytes, reduced, shrunk};
