//! The SRDF of a small robot.

use super::assemble;
use super::urdf::{self, Description, ReadOptions};
use std::path::Path;
use std::sync::LazyLock;
use urdf2fmu_core::settings::Settings;

const ROBOT: &str = "<robot name='r'><link name='base'><inertial><mass value='1'/>\
    <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\
    <link name='arm'><inertial><mass value='1'/>\
    <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\
    <link name='tool'/>\
    <joint name='turn' type='revolute'><parent link='base'/><child link='arm'/>\
    <limit lower='-1' upper='2' effort='1' velocity='1'/></joint>\
    <joint name='hold' type='fixed'><parent link='arm'/><child link='tool'/></joint></robot>";

static READ: LazyLock<Description> = LazyLock::new(|| {
    let nowhere = Path::new("/no-such-folder");
    let read = urdf::read_str(ROBOT, "r.urdf", nowhere, &ReadOptions::default());
    read.expect("a robot")
});

pub fn srdf(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let Ok(semantics) = urdf::read_srdf_str(&text, "fuzz.srdf", Some("home"), &READ) else {
        return;
    };
    for pair in &semantics.disabled_pairs {
        assert!(pair[0] < pair[1] && pair[1] < READ.links.len());
    }
    let mut settings = Settings::default();
    settings.initial.state = semantics.positions;
    // What is accepted can be started with.
    let assembled = assemble::build(&READ, &settings).expect("positions within the limits");
    assembled.model.validate().expect("a legal model");
}
