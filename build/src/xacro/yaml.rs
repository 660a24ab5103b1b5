//! YAML files as `PyYAML` reads them, with the units that xacro adds.
//!
//! The structure is read by a library; what a plain word means follows YAML 1.1 as `PyYAML` does:
//! `yes` is true, and `1e-3` without a point is a text.

use super::value::{Value, float_of, insert};
use saphyr_parser::{Event, Parser, ScalarStyle, Tag};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Values that one file may make, copies of anchors included.
const MOST_VALUES: usize = 200_000;

/// Levels that are read.
const DEEPEST: usize = 100;

/// What a file holds; `evaluate` gives the value of an expression with a unit.
pub fn read(text: &str, evaluate: &mut dyn FnMut(&str) -> Option<f64>) -> Result<Value, String> {
    let mut reader = Reader {
        events: Parser::new_from_str(text),
        anchors: BTreeMap::new(),
        left: MOST_VALUES,
        evaluate,
    };
    loop {
        match reader.next()? {
            Event::StreamEnd | Event::DocumentEnd => return Ok(Value::None),
            Event::StreamStart | Event::DocumentStart(_) | Event::Nothing => {}
            event => return reader.value(event, 0),
        }
    }
}

struct Reader<'t, 'e> {
    events: Parser<'t, saphyr_parser::StrInput<'t>>,
    anchors: BTreeMap<usize, Value>,
    left: usize,
    evaluate: &'e mut dyn FnMut(&str) -> Option<f64>,
}

impl<'t> Reader<'t, '_> {
    fn next(&mut self) -> Result<Event<'t>, String> {
        match self.events.next() {
            Some(Ok((event, _))) => Ok(event),
            Some(Err(error)) => Err(error.to_string()),
            None => Ok(Event::StreamEnd),
        }
    }

    fn value(&mut self, event: Event<'t>, depth: usize) -> Result<Value, String> {
        self.left = self.left.checked_sub(1).ok_or("the file holds too much")?;
        if depth > DEEPEST {
            return Err("the file is nested too deeply".to_owned());
        }
        let (value, anchor) = match event {
            Event::Alias(anchor) => {
                let known = self.anchors.get(&anchor).cloned();
                return known.ok_or_else(|| "an alias has no anchor".to_owned());
            }
            Event::Scalar(text, style, anchor, tag) => (self.scalar(&text, style, tag)?, anchor),
            Event::SequenceStart(anchor, _) => {
                let mut list = Vec::new();
                loop {
                    match self.next()? {
                        Event::SequenceEnd => break,
                        event => list.push(self.value(event, depth + 1)?),
                    }
                }
                (Value::list(list), anchor)
            }
            Event::MappingStart(anchor, _) => (self.mapping(depth)?, anchor),
            _ => return Err("the file ends too early".to_owned()),
        };
        if anchor > 0 {
            self.anchors.insert(anchor, value.clone());
        }
        Ok(value)
    }

    fn mapping(&mut self, depth: usize) -> Result<Value, String> {
        let (mut pairs, mut merged): (Vec<(Value, Value)>, Vec<Value>) = Default::default();
        loop {
            let key = match self.next()? {
                Event::MappingEnd => break,
                event => self.value(event, depth + 1)?,
            };
            let event = self.next()?;
            let value = self.value(event, depth + 1)?;
            if key.same(&Value::text("<<")) {
                merged.push(value);
            } else {
                insert(&mut pairs, key, value);
            }
        }
        // Merged entries are those that the mapping does not have itself.
        for value in merged {
            let all = match value {
                Value::List(list) => list.to_vec(),
                one => vec![one],
            };
            for one in all {
                let Value::Dict(others) = one else {
                    continue;
                };
                for (key, value) in others.iter() {
                    if !pairs.iter().any(|(own, _)| own.same(key)) {
                        pairs.push((key.clone(), value.clone()));
                    }
                }
            }
        }
        Ok(Value::Dict(Rc::new(pairs)))
    }

    fn scalar(
        &mut self,
        text: &str,
        style: ScalarStyle,
        tag: Option<Cow<'_, Tag>>,
    ) -> Result<Value, String> {
        if let Some(tag) = tag {
            if tag.handle == "!" {
                let factor = unit(&tag.suffix)
                    .ok_or_else(|| format!("the tag !{} is not known", tag.suffix))?;
                let value = (self.evaluate)(text);
                let value = value.ok_or_else(|| format!("'{text}' is no number"))?;
                return Ok(Value::Float(value * factor));
            }
            return Ok(match tag.suffix.as_str() {
                "str" => Value::text(text),
                "float" => {
                    Value::Float(float_of(text).ok_or_else(|| format!("'{text}' is no number"))?)
                }
                _ => plain(text),
            });
        }
        Ok(match style {
            ScalarStyle::Plain => plain(text),
            _ => Value::text(text),
        })
    }
}

/// Factor of a unit to SI.
fn unit(name: &str) -> Option<f64> {
    Some(match name {
        "radians" | "meters" => 1.0,
        "degrees" => std::f64::consts::PI / 180.0,
        "millimeters" => 0.001,
        "foot" => 0.3048,
        "inches" => 0.0254,
        _ => return None,
    })
}

/// A word without quotes.
fn plain(text: &str) -> Value {
    match text {
        "" | "~" | "null" | "Null" | "NULL" => return Value::None,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "YES" | "on" | "On" | "ON" => {
            return Value::Bool(true);
        }
        "false" | "False" | "FALSE" | "no" | "No" | "NO" | "off" | "Off" | "OFF" => {
            return Value::Bool(false);
        }
        ".inf" | ".Inf" | ".INF" | "+.inf" => return Value::Float(f64::INFINITY),
        "-.inf" | "-.Inf" | "-.INF" => return Value::Float(f64::NEG_INFINITY),
        ".nan" | ".NaN" | ".NAN" => return Value::Float(f64::NAN),
        _ => {}
    }
    let bare = text.strip_prefix(['-', '+']).unwrap_or(text);
    let digits = bare.replace('_', "");
    let sign = if text.starts_with('-') { -1 } else { 1 };
    if bare.starts_with(|c: char| c.is_ascii_digit()) {
        let radix = |prefix: &str, radix| {
            let rest = digits.strip_prefix(prefix)?;
            i64::from_str_radix(rest, radix).ok()
        };
        let octal = || {
            let is = digits.len() > 1 && digits.starts_with('0');
            (is && digits.bytes().all(|b| (b'0'..b'8').contains(&b))).then(|| radix("0", 8))?
        };
        let decimal = || {
            let is = digits.bytes().all(|b| b.is_ascii_digit())
                && (digits == "0" || !digits.starts_with('0'));
            is.then(|| digits.parse().ok())?
        };
        let whole = radix("0x", 16)
            .or_else(|| radix("0b", 2))
            .or_else(octal)
            .or_else(decimal);
        if let Some(value) = whole {
            return Value::Int(sign * value);
        }
    }
    // A number has a point, and its exponent a sign.
    let shaped = digits.contains('.')
        && digits.starts_with(|c: char| c.is_ascii_digit() || c == '.')
        && digits
            .bytes()
            .all(|b| b.is_ascii_digit() || b".eE+-".contains(&b))
        && digits
            .find(['e', 'E'])
            .is_none_or(|at| digits[at + 1..].starts_with(['+', '-']));
    if shaped && let Some(value) = float_of(&digits) {
        return Value::Float(if sign < 0 { -value } else { value });
    }
    Value::text(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: what `PyYAML` 6.0 reads.
    #[test]
    fn words_mean_what_pyyaml_takes_them_for() {
        let text = "a: [1, 0x10, 010, 1.5, 1e-3, 1.0e-3, 1.e+2, yes, ~, 'yes', -.5, 1_000, -7]\n\
                    b: &x {c: 1, d: text with words}\nf: {<<: *x, c: 2}\ng: !degrees 90\n";
        let value = read(text, &mut |text| text.parse().ok()).expect("YAML");
        assert_eq!(
            value.literal(),
            "{'a': [1, 16, 8, 1.5, '1e-3', 0.001, 100.0, True, None, 'yes', -0.5, 1000, -7], \
             'b': {'c': 1, 'd': 'text with words'}, 'f': {'c': 2, 'd': 'text with words'}, \
             'g': 1.5707963267948966}"
        );
    }

    #[test]
    fn a_file_that_copies_itself_ends() {
        let mut text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n".to_owned();
        for i in 1..30 {
            let before = vec![format!("*a{}", i - 1); 10].join(", ");
            text.push_str(
                &[
                    "a",
                    &i.to_string(),
                    ": &a",
                    &i.to_string(),
                    " [",
                    &before,
                    "]\n",
                ]
                .concat(),
            );
        }
        // Copies are shared, so this is small; it must only end.
        assert!(read(&text, &mut |_| None).is_ok());
    }
}
