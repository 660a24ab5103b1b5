//! A picture of a run: curves over time in panels, as SVG.
//!
//! In: a title, times and columns of values. Out: the file's text; the same values give the same
//! bytes. `curve` says what goes in and out, `panels` sorts variables into panels, `axis` chooses
//! ranges and ticks, `draw` writes the file.

mod axis;
mod curve;
mod draw;
mod panels;

pub use curve::{Curve, Plot};
pub use draw::svg;
pub use panels::defaults;
