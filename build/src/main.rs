//! The `urdf2fmu` command.

fn main() {}
