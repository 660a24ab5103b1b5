//! Messages between viewers and the simulation, see `docs/see.md`.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a viewer asks for. Unknown keys are ignored, so that older programs understand newer pages
/// as far as they can.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
#[allow(clippy::struct_excessive_bools, reason = "each is a key of a message")]
pub struct Wish {
    /// Inputs and the values that they keep.
    pub set: BTreeMap<String, f64>,
    /// Inputs and the values that they have for as long as the viewer holds them.
    pub hold: BTreeMap<String, f64>,
    /// Inputs that the viewer holds no longer.
    pub release: Vec<String>,
    /// Go on.
    pub run: bool,
    /// Stop.
    pub pause: bool,
    /// Stop, and take one step.
    pub step: bool,
    /// Begin anew.
    pub reset: bool,
    /// Simulated seconds for each second.
    pub speed: Option<f64>,
}

impl Wish {
    /// Reads a message; none where it is no wish.
    pub fn parse(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }
}

/// What a viewer is told beside the values of outputs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct News<'a> {
    /// Inputs and the values that they have now.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub inputs: BTreeMap<&'a str, f64>,
    /// Inputs that someone holds.
    pub held: Vec<&'a str>,
    /// Simulated seconds for each second, as asked for.
    pub speed: f64,
    /// Why the simulation stopped; empty while it has not.
    pub failed: &'a str,
}

impl News<'_> {
    /// As text.
    pub fn text(&self) -> String {
        // Numbers and names always have a text.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// Bits of a frame's first number.
pub const PAUSED: u32 = 1;
/// What came before is another run.
pub const RESET: u32 = 2;

/// A frame: flags, simulated seconds for each second as measured, time, then all outputs in the
/// order of the scene.
pub fn values(flags: u32, factor: f64, time: f64, outputs: impl Iterator<Item = f64>) -> Vec<u8> {
    let mut bytes = flags.to_le_bytes().to_vec();
    bytes.extend(narrow(factor));
    bytes.extend(time.to_le_bytes());
    for output in outputs {
        bytes.extend(narrow(output));
    }
    bytes
}

/// A number for the page, whose numbers have 32 bits.
fn narrow(x: f64) -> [u8; 4] {
    #[expect(clippy::cast_possible_truncation, reason = "for the eye")]
    let narrow = x as f32;
    narrow.to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_read_and_anything_else_is_ignored() {
        let wish = Wish::parse(r#"{"set":{"a":1.5},"release":["b"],"run":true,"alive":true}"#);
        let wish = wish.expect("a wish");
        assert_eq!(wish.set, BTreeMap::from([("a".to_owned(), 1.5)]));
        assert!(wish.run && !wish.pause && wish.release == ["b"] && wish.speed.is_none());
        assert_eq!(Wish::parse("{}"), Some(Wish::default()));
        for text in [
            "",
            "[1]",
            "{\"set\":1}",
            "{\"set\":{\"a\":NaN}}",
            "{\"speed\":\"fast\"}",
        ] {
            assert_eq!(Wish::parse(text), None, "{text}");
        }
    }

    #[test]
    fn a_frame_has_sixteen_bytes_and_four_for_each_output() {
        let frame = values(PAUSED | RESET, 1.0, 0.5, [1.0, -2.0].into_iter());
        assert_eq!(frame.len(), 24);
        assert_eq!(frame[..4], [3, 0, 0, 0]);
        assert_eq!(frame[20..], (-2.0_f32).to_le_bytes());
    }
}
