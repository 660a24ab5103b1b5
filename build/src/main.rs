//! The `urdf2fmu` command.

#[expect(dead_code, reason = "the packager takes it from here")]
mod library;

fn main() {}
