use super::{Order, Reader};
use crate::model::LoopKind;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// One of each kind that a model has.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct All {
    number: f64,
    whole: u32,
    flag: bool,
    name: String,
    maybe: Option<f64>,
    list: Vec<[f64; 2]>,
    kind: Kind,
    #[serde(default = "seven")]
    seven: f64,
    #[serde(default)]
    part: Option<Part>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Bare,
    Value(f64),
    Fields { a: u32, b: Vec<Kind> },
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Part {
    size: usize,
}

fn seven() -> f64 {
    7.0
}

fn read<'t, T: Deserialize<'t>>(text: &'t str, order: Order) -> Result<T, String> {
    let mut reader = Reader::new(text, order);
    let value = T::deserialize(&mut reader).and_then(|value| reader.end().map(|()| value));
    value.map_err(|fault| reader.told(&fault))
}

/// What this reader makes of a text and what `serde_json` makes of it must be the same.
fn same<'t, T: Deserialize<'t> + PartialEq + Debug>(text: &'t str) {
    let other = serde_json::from_str::<T>(text).ok();
    assert_eq!(read::<T>(text, Order::Any).ok(), other, "{text}");
}

const WHOLE: &str = r#"{"number": 0.1, "whole": 3, "flag": true, "name": "a\"b", "maybe": null,
 "list": [[1, -2.5e-3], [0, 1E5]], "kind": {"fields": {"a": 1, "b": ["bare", {"value": 2.0}]}},
 "seven": 8.0, "part": {"size": 18446744073709551615}}"#;

#[test]
fn every_kind_of_value_is_read_as_serde_json_reads_it() {
    same::<All>(WHOLE);
    let known: All = serde_json::from_str(WHOLE).expect("JSON");
    assert_eq!(read(WHOLE, Order::Written), Ok(known));
}

#[test]
fn numbers_are_the_nearest_ones() {
    let mut state = 1_u64;
    for _ in 0..20_000 {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let number = f64::from_bits(state ^ (state >> 29));
        if number.is_finite() {
            let text = serde_json::to_string(&number).expect("finite");
            let back = read::<f64>(&text, Order::Written).map(f64::to_bits);
            assert_eq!(back, Ok(number.to_bits()), "{text}");
        }
    }
}

#[test]
fn what_is_no_number_of_json_is_refused() {
    for text in [
        "0",
        "-0",
        "-0.0",
        "1.5e3",
        "1E+2",
        "5e-324",
        "1e-400",
        "1e400",
        "01",
        "-01",
        "1.",
        ".5",
        "-",
        "+1",
        "1e",
        "1e+",
        "0x1",
        "NaN",
        "inf",
        "null",
        "\"1\"",
        "1 2",
        "",
        "1_0",
        "--1",
        "123456789012345678901234567890",
    ] {
        same::<f64>(text);
        same::<Option<f64>>(text);
        let number = serde_json::from_str::<u32>(text).ok();
        assert_eq!(read::<u32>(text, Order::Any).ok(), number, "{text}");
    }
    for text in [
        "4294967295",
        "4294967296",
        "-1",
        "1.0",
        "18446744073709551616",
    ] {
        same::<u32>(text);
        same::<u64>(text);
    }
}

#[test]
fn texts_are_read_with_their_escaped_characters() {
    for text in [
        r#""""#,
        r#""plain é 𝄞""#,
        r#""\"\\\/\b\f\n\r\t""#,
        r#""\u00e9\ud834\udd1e!""#,
        r#""\ud834""#,
        r#""\ud834\u0041""#,
        r#""\udd1e""#,
        r#""\u00g0""#,
        r#""\u00é""#,
        r#""\u+123""#,
        r#""\x""#,
        r#""open"#,
        "\"line\nbreak\"",
        "\"\\",
        "name",
    ] {
        same::<String>(text);
    }
}

#[test]
fn fields_may_come_in_any_order_and_be_left_out_where_they_may() {
    let turned =
        r#"{"list": [], "name": "", "kind": "bare", "flag": false, "whole": 0, "number": 1}"#;
    same::<All>(turned);
    let read: All = read(turned, Order::Any).expect("all that is needed");
    assert_eq!((read.seven, read.maybe, read.part), (7.0, None, None));
}

#[test]
fn texts_that_are_cut_or_changed_at_one_place_are_judged_as_serde_json_judges_them() {
    for end in 0..WHOLE.len() {
        assert!(read::<All>(&WHOLE[..end], Order::Any).is_err());
    }
    for place in 0..WHOLE.len() {
        for other in [
            "", " ", ",", ":", "]", "}", "[", "{", "\"", "\\", "0", "-", "n",
        ] {
            let text = [&WHOLE[..place], other, &WHOLE[place + 1..]].concat();
            same::<All>(&text);
            let quick = read::<All>(&text, Order::Written).ok();
            assert!(
                quick.is_none() || quick == serde_json::from_str(&text).ok(),
                "{text}"
            );
        }
    }
}

#[test]
fn messages_name_the_field_and_its_place() {
    for (text, message) in [
        (
            "{\"number\": 1,\n \"number\": 2}",
            "duplicate field `number` at line 2 column 2",
        ),
        (
            "{\"nombre\": 1}",
            "unknown field `nombre`, expected one of `number`, `whole`, `flag`, `name`, `maybe`, \
             `list`, `kind`, `seven`, `part` at line 1 column 2",
        ),
        (
            "{\"number\": 1}",
            "missing field `whole` at line 1 column 1",
        ),
        (
            "{\n\"number\": null}",
            "expected a number at line 2 column 11",
        ),
        (
            "{\"number\": 1e999}",
            "number out of range at line 1 column 12",
        ),
        ("[1]", "expected an object, `{` at line 1 column 1"),
        ("", "expected an object, `{` at line 1 column 1"),
    ] {
        assert_eq!(read::<All>(text, Order::Any), Err(message.into()));
    }
    let kind = read::<Kind>("\"bear\"", Order::Any).expect_err("no kind");
    assert!(kind.starts_with("unknown variant `bear`"), "{kind}");
    let kind = read::<LoopKind>(r#"{"weld": 1}"#, Order::Any).expect_err("no frames");
    assert_eq!(kind, "expected a list, `[` at line 1 column 10");
}
