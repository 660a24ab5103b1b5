//! Texts of prepared models. The first byte chooses: numbers of a good model are replaced, or its
//! text is changed by lines and characters, or the bytes are the text themselves.
//!
//! What is accepted must be JSON to another reader and the same model there, and can be stored
//! again.

use super::{Bytes, chosen, good_model, prepare};
use std::borrow::Cow;
use std::sync::{Arc, LazyLock};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::geometry::field::{Field, Samples};
use urdf2fmu_core::geometry::surface::{Surface, Triangles};
use urdf2fmu_core::model::Model;
use urdf2fmu_core::prepared::PreparedModel;
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_core::spatial::Vec3;
use urdf2fmu_core::variables::{Slot, table};

/// The smallest robot with a body, a commanded joint with limits and a collider: reading it is most
/// of an execution.
const SMALL: &str = r#"<robot name="s"><link name="b"/>
<link name="w"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<joint name="j" type="revolute"><parent link="b"/><child link="w"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="1" effort="5" velocity="20"/><dynamics damping="0.01" friction="0.02"/></joint></robot>"#;

/// What the others lack: loops, springs, sensors, pairs, terrain, a mimic joint and other shapes.
const RICH: &str = r#"<robot name="r"><link name="b">
  <collision><geometry><sphere radius="0.1"/></geometry></collision>
  <collision><geometry><sphere radius="0.2"/></geometry></collision>
  <collision><geometry><sphere radius="0.3"/></geometry></collision></link>
<link name="u"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><cylinder radius="0.1" length="0.2"/></geometry></collision></link>
<link name="v"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="w"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="b"/><child link="u"/><axis xyz="0 1 0"/></joint>
<joint name="k" type="continuous"><parent link="u"/><child link="v"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/></joint>
<joint name="m" type="prismatic"><parent link="b"/><child link="w"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="5" velocity="20"/><mimic joint="j" multiplier="2"/></joint></robot>"#;

const RICH_SETTINGS: &str = r#"
[[sensor]]
type = "imu"
link = "u"
rate = 200
angular_velocity = { bias = [0.01, 0, 0], noise = [1e-3, 1e-3, 1e-3] }
[[sensor]]
type = "ray"
link = "v"
rays = 3
fov = 1
range = 2
hits = true
[[sensor]]
type = "contact"
name = "c"
link = "u"
[[loop]]
type = "ball"
links = ["v", "world"]
origins = [[0.1, 0, 0], [0.5, 0, 0]]
[[spring]]
links = ["u", "v"]
stiffness = 100
[[outputs.pair]]
name = "p"
first = "u"
second = "ground"
[robot]
self_collision = true
"#;

/// With a hull and terrain on the link that stands still.
fn rich_model() -> PreparedModel {
    let mut model = prepare(RICH, RICH_SETTINGS).model;
    let vertices = vec![
        Vec3::zeros(),
        Vec3::new(0.1, 0.0, 0.0),
        Vec3::new(0.0, 0.1, 0.0),
        Vec3::new(0.0, 0.0, 0.1),
    ];
    let field = Field::try_from(Samples {
        size: [2.0, 1.0],
        counts: [3, 2],
        heights: vec![-1.0, -1.5, -1.0, -2.0, -1.0, -1.25],
    });
    let ground = Triangles {
        corners: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
            .map(|[x, y]| Vec3::new(x, y, -1.0))
            .to_vec(),
        triangles: vec![[0, 1, 2], [1, 3, 2]],
    };
    let shapes = [
        Shape::Hull { vertices },
        Shape::Field {
            field: Arc::new(field.unwrap()),
        },
        Shape::Surface {
            surface: Arc::new(Surface::try_from(ground).unwrap()),
        },
    ];
    for (collider, shape) in model.colliders.iter_mut().zip(shapes) {
        collider.shape = shape;
    }
    PreparedModel::new(super::GUID.into(), model)
}

/// The models that are changed, line by line: first the small robot, then the others. Without their
/// checksums, with which any change is refused.
static MODELS: LazyLock<[Vec<String>; 3]> = LazyLock::new(|| {
    [prepare(SMALL, ""), good_model(), rich_model()].map(|mut model| {
        model.checksum = None;
        let text = model.to_json().unwrap();
        text.lines().map(|line| line.trim().to_owned()).collect()
    })
});

const OTHERS: [&str; 16] = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-308",
    "null",
    "4294967295",
    "18446744073709551616",
    "0.5",
    "\"\"",
    "[]",
    "{}",
    "true",
    "3",
    "1e-9",
    "7",
];

/// A good model with some of its numbers and words replaced.
fn changed_model(model: &[String], bytes: &mut Bytes) -> String {
    let mut changes = Vec::new();
    while changes.len() < 8 && !bytes.0.is_empty() {
        let line = (bytes.byte() as usize | (bytes.byte() as usize) << 8) % model.len();
        changes.push((line, OTHERS[bytes.byte() as usize % OTHERS.len()]));
    }
    let mut text = String::new();
    for (number, old) in model.iter().enumerate() {
        let change = changes.iter().rev().find(|(line, _)| *line == number);
        let tail = if old.ends_with(',') { "," } else { "" };
        match (change, old.split_once(": ")) {
            (Some((_, other)), Some((key, _))) if !old.ends_with(['{', '[']) => {
                text.extend([key, ":", other, tail]);
            }
            (Some((_, other)), None)
                if !old.trim_end_matches(',').ends_with(['{', '[', '}', ']']) =>
            {
                text.extend([other, tail]);
            }
            _ => text.push_str(old),
        }
    }
    text
}

/// What JSON consists of, and what it must not have.
const PIECES: [&str; 32] = [
    "\"",
    "\\",
    "\\\"",
    "\\u00e9",
    "\\ud834\\udd1e",
    "\\ud834",
    "\\udd1e",
    "\\n",
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "null",
    "true",
    "false",
    "-",
    "-0",
    "00",
    ".",
    "e",
    "e+",
    "1e400",
    "5e-324",
    "0.1000000000000000055511151231257827",
    " ",
    "\t\r\n",
    "\u{e9}",
    "\u{feff}",
    "\0",
    "{\"a\":1}",
];

/// A good model whose text is changed: lines are moved, repeated and left out, and characters
/// within them.
fn changed_text(model: &'static [String], bytes: &mut Bytes) -> String {
    let mut lines: Vec<Cow<[u8]>> = model.iter().map(|line| line.as_bytes().into()).collect();
    for _ in 0..8 {
        if bytes.0.is_empty() || lines.is_empty() {
            break;
        }
        let count = lines.len();
        let kind = bytes.byte();
        let mut line = || (bytes.byte() as usize | (bytes.byte() as usize) << 8) % count;
        let at = line();
        match kind % 8 {
            0 => {
                let other = line();
                lines.swap(at, other);
            }
            1 => {
                // A field or an element that takes several lines.
                let many = (bytes.byte() as usize % 16 + 1).min(count - at);
                let moved: Vec<_> = lines.drain(at..at + many).collect();
                let place = bytes.byte() as usize % (lines.len() + 1);
                lines.splice(place..place, moved);
            }
            2 => lines.insert(at, lines[at].clone()),
            3 => drop(lines.remove(at)),
            4 => lines.truncate(at),
            changed => {
                let line = lines[at].to_mut();
                let place = bytes.byte() as usize % (line.len() + 1);
                let other = bytes.byte();
                let piece = PIECES[other as usize % PIECES.len()].bytes();
                match (changed, place < line.len()) {
                    (6, true) => line[place] = other,
                    (7, true) => drop(line.splice(place..=place, piece)),
                    _ => drop(line.splice(place..place, piece)),
                }
            }
        }
    }
    String::from_utf8_lossy(&lines.concat()).into_owned()
}

pub fn model(data: &[u8]) {
    let mut bytes = Bytes(data);
    let text = match bytes.byte() {
        kind if kind % 2 == 1 => changed_model(&MODELS[usize::from(kind >= 224)], &mut bytes),
        kind if kind % 4 == 2 => changed_text(&MODELS[usize::from(kind >> 2) % 3], &mut bytes),
        _ => String::from_utf8_lossy(bytes.0).into_owned(),
    };
    let Ok(prepared) = PreparedModel::from_json(&text) else {
        return;
    };
    if !chosen(data, 8) {
        return;
    }
    let other: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let other = serde_json::from_value::<Model>(other["model"].clone());
    assert_eq!(other.ok().as_ref(), Some(&prepared.model));
    let again = PreparedModel::new(prepared.guid, prepared.model);
    let stored = again.to_json().expect("what is accepted can be stored");
    let read = PreparedModel::from_json(&stored).expect("what is stored can be read");
    assert_eq!(read, again);
    // Half of the time would go into steps.
    if chosen(data, 64) {
        step(read.model);
    }
}

/// What was read must be what the simulator can work with.
fn step(model: Model) {
    let Ok(rows) = table(&model) else {
        return;
    };
    let mut simulation = Simulation::new(Arc::new(model));
    if simulation.initialize(0.0).is_ok() {
        _ = simulation.advance_to(1e-4);
    }
    for row in rows {
        if let Slot::Output(slot) = row.slot {
            simulation.output(slot);
            simulation.output_derivative(slot);
        }
    }
}
