//! What may have been meant by a key that does not exist, and by text that is no TOML.

use super::keys::{self, Key, QUANTITIES, Takes};
use crate::diagnostic::words::{called, nearest};
use crate::range::number_or_ratio;
use std::f64::consts::TAU;
use toml::de::{DeTable, DeValue};

/// How the shapes of an object are written.
pub(super) const SHAPES: &str = "shape = { box = [0.1, 0.1, 0.1] }, { sphere = 0.1 }, \
     { cylinder = [0.1, 0.2] } or { capsule = [0.1, 0.2] }";

/// A table as a file writes it.
pub(super) fn shown(path: &str) -> String {
    let name = path.replace(".*", ".\"…\"").replace("[].", ".");
    match name.strip_suffix("[]") {
        _ if path.is_empty() => "the settings".to_owned(),
        Some(array) => format!("[[{array}]]"),
        None => format!("[{name}]"),
    }
}

/// What a table takes, where something else stands in its place.
pub(super) fn table(path: &str) -> String {
    let known = keys::children(path);
    if known == ["*"] && keys::find(&format!("{path}.*")).is_some() {
        let name = path.rsplit_once('.').map_or(path, |(_, name)| name);
        return format!("write {name} = {{ \"name or glob\" = 0.1 }}");
    }
    if known == ["*"] {
        let header = shown(&format!("{path}.*"));
        return format!("write {header}, and below it the keys of one");
    }
    format!("{} has the keys {}", shown(path), known.join(", "))
}

/// What to do about a text in quotes that may be meant as a number or a flag, alone or in a list.
pub(super) fn quoted(text: &str) -> String {
    let plain = text.trim();
    let unit = plain.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
    let digits = &plain[..unit.unwrap_or(plain.len())];
    let is_number = |text: &str| text.parse::<f64>().is_ok_and(f64::is_finite);
    let flag = match plain.to_ascii_lowercase().as_str() {
        "true" | "yes" | "on" => Some("true"),
        "false" | "no" | "off" => Some("false"),
        _ => None,
    };
    if is_number(plain) {
        format!("write {plain}, without quotes")
    } else if is_number(digits) {
        format!("write the number alone, without quotes, in SI units: {digits}")
    } else if let Some(flag) = flag {
        format!("write {flag}, without quotes")
    } else {
        String::new()
    }
}

/// What a key of numbers is, with its unit, for findings that have no advice of their own: a range
/// alone does not say what to write.
pub(super) fn meaning(key: &Key) -> Option<String> {
    let counts = matches!(key.takes, Takes::Count(_) | Takes::Version(_));
    let numbers = counts || key.takes.range().is_some();
    numbers.then(|| format!("what it is: {}", key.about))
}

/// How numbers in one text are written as a list, and how many they are.
pub(super) fn list(name: &str, text: &str) -> Option<(String, usize)> {
    let between = |c: char| c.is_whitespace() || ",;[]()".contains(c);
    let words: Vec<&str> = text
        .split(between)
        .filter(|word| !word.is_empty())
        .collect();
    let number = |word: &&str| word.parse::<f64>().is_ok_and(f64::is_finite);
    let list = format!("write {name} = [{}]", words.join(", "));
    words.iter().all(number).then_some((list, words.len()))
}

/// How one name in place of a list is written, where some `words` may stand alone.
pub(super) fn list_of(name: &str, one: &str, words: &[&str]) -> String {
    let meant = nearest(one, words.iter().copied());
    let word = meant.map(|word| format!("{name} = \"{word}\", or "));
    let (word, all) = (word.unwrap_or_default(), !words.is_empty());
    let all = if all { "; [\"*\"] means all" } else { "" };
    format!("write {word}{name} = [\"{one}\"]{all}")
}

/// What to write in place of a number that is no count.
pub(super) fn count(name: &str, number: f64, most: u32) -> String {
    // The next one is at least two, so that what belongs to several has a meaning.
    let next = number.ceil();
    if (1.0..=f64::from(most)).contains(&number) {
        format!("write {name} = {next}")
    } else {
        String::new()
    }
}

/// What to write in place of an angle that is more than a turn.
pub(super) fn angle(name: &str, number: f64) -> String {
    if !["fov", "vertical_fov"].contains(&name) || number <= TAU {
        return String::new();
    }
    let turn = "a row all around has less than a turn, which is 6.283185";
    if number < 360.0 {
        let radians = libm::round(1e6 * number.to_radians()) / 1e6;
        format!("angles are in rad: {number}° are {name} = {radians}; {turn}")
    } else {
        format!("angles are in rad, and {turn}")
    }
}

/// What to write in place of the density of a noise that is given by its deviation alone.
pub(super) fn noise_of(path: &str, name: &str) -> Option<String> {
    let known = keys::children(path);
    let lacks = name == "noise_density" && known.contains(&"noise");
    lacks.then(|| {
        "write noise, the deviation of each sample: noise_density times the root of the sensor's \
         rate, which it needs"
            .to_owned()
    })
}

/// What to write in place of an error of a sensor, which belongs to one of the quantities of its
/// type.
///
/// - `sensor`: the type of the sensor and the value as they are written
pub(super) fn error_of_sensor(path: &str, name: &str, table: &DeTable) -> Option<String> {
    if path != "sensor[]" || !["bias", "noise", "noise_density"].contains(&name) {
        return None;
    }
    let kind = table.get("type")?.get_ref().as_str()?;
    let value = match table.get(name)?.get_ref() {
        DeValue::Float(x) => x.as_str(),
        DeValue::Integer(x) => x.as_str(),
        _ => "…",
    };
    let own = QUANTITIES.iter().filter(|(of, _)| *of == kind);
    let own = own.filter_map(|(_, quantity)| {
        let key = keys::find(&format!("{path}.{quantity}.{name}"))?;
        let value = match key.takes {
            Takes::Number(_) => value.to_owned(),
            _ => format!("[{value}, {value}, {value}]"),
        };
        let (unit, _) = key.about.split_once(',')?;
        Some(format!("{quantity}.{name} = {value}, in {unit}"))
    });
    let own: Vec<String> = own.collect();
    let rate = if name == "bias" || table.contains_key("rate") {
        ""
    } else {
        "; and rate, the samples a second, such as rate = 100.0"
    };
    (!own.is_empty()).then(|| format!("write {}{rate}", own.join(", or ")))
}

/// What to write in place of a key that the shape of an object does not have.
pub(super) fn shape_of(path: &str, name: &str) -> Option<String> {
    let is_shape = path == "world.object[].shape";
    let meant = called(name, &keys::children(path));
    (is_shape && meant.is_none()).then(|| format!("write {SHAPES}"))
}

/// The tables that have a key of this name.
fn tables_of(name: &str) -> impl Iterator<Item = &'static str> {
    let pairs = keys::KEYS
        .iter()
        .filter_map(|key| key.path.rsplit_once('.'));
    pairs
        .filter(move |(_, last)| *last == name)
        .map(|(table, _)| table)
}

/// What a key in the table at `path` may mean that is none of `known`.
///
/// - `unknown`: all such keys of its table: where a header is missing, they belong together
/// - `is_table`: whether its value is one
pub(super) fn key(
    path: &str,
    name: &str,
    (known, unknown): (&[&str], &[&str]),
    is_table: bool,
) -> String {
    let one_of_many = |known: &&&str| {
        known.strip_suffix('s') == Some(name) || name.strip_suffix('s') == Some(known)
    };
    if let Some(known) = known.iter().find(one_of_many) {
        return format!("did you mean '{known}'?");
    }
    let all = format!("known are {}", known.join(", "));
    if let Some(own) = called(name, known) {
        // The value is seldom that of the other name, such as true for a kind of base.
        let takes = keys::find(&format!("{path}.{own}")).map(|key| key.takes);
        let words = match takes {
            Some(Takes::Word(words)) => format!("it takes {}; ", one_of(words)),
            _ => String::new(),
        };
        return format!("did you mean '{own}'? {words}{all}");
    }
    // The same key in another table is likelier meant than another key here.
    let tables: Vec<&str> = tables_of(name).filter(|_| !is_table).collect();
    let of_all = |table: &&str| {
        let elsewhere = unknown.iter().filter(|key| tables_of(key).next().is_some());
        let mut elsewhere = elsewhere.copied();
        elsewhere.all(|key| tables_of(key).any(|other| other == *table))
    };
    let mut meant: Vec<&str> = tables.iter().copied().filter(of_all).collect();
    if meant.is_empty() {
        meant = tables;
    }
    if let Some((last, others)) = meant.split_last() {
        let others: Vec<String> = others.iter().copied().map(shown).collect();
        let or = if others.is_empty() { "" } else { " or " };
        let others = others.join(", ");
        return format!("'{name}' belongs into {others}{or}{}", shown(last));
    }
    // So is a table inside of another one.
    let mut paths = keys::KEYS.iter().map(|key| key.path);
    let inside = paths.find_map(|path| {
        let at = path.find(&format!(".{name}"))? + 1 + name.len();
        let end = path[at..].starts_with("[].").then_some(at + 2);
        end.or(path[at..].starts_with('.').then_some(at))
            .map(|end| &path[..end])
    });
    if let Some(table) = inside {
        return format!("write {}", shown(table));
    }
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean '{near}'? {all}"),
        // A guess that is far away would mislead.
        None => all,
    }
}

/// Whether a comma stands between two digits outside of a list.
fn is_decimal_comma(before: &str, rest: &str) -> bool {
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let behind = rest.strip_prefix(',');
    digit(before.chars().next_back()) && behind.is_some_and(|rest| digit(rest.chars().next()))
}

/// Such as `1/240`.
fn is_ratio(word: &str) -> bool {
    word.contains('/') && number_or_ratio(word).is_some()
}

/// The message and the advice for a number as a program prints it: `np.float64(1.0)`.
pub(super) fn called_number(rest: &str) -> Option<(String, String)> {
    let (name, inner) = rest.lines().next()?.split_once('(')?;
    let (number, _) = inner.split_once(')')?;
    let is_name = name.starts_with(|c: char| c.is_alphabetic())
        && name
            .chars()
            .all(|c| c.is_alphanumeric() || "_.".contains(c));
    let is_number = number.trim().parse::<f64>().is_ok_and(f64::is_finite);
    (is_name && is_number).then(|| {
        let message = format!("'{name}({number})' is no value of TOML");
        (
            message,
            format!("write the number alone: {}", number.trim()),
        )
    })
}

/// The message and the advice for text that is no TOML.
///
/// - `found`: the text, `before`, `rest`: what stands before it, and what begins with it
/// - `message`: what the parser says of it
pub(super) fn syntax(found: &str, (before, rest): (&str, &str), message: &str) -> (String, String) {
    let word = found.trim();
    if is_decimal_comma(before, rest) {
        let help = "the decimal sign is a point, and several numbers are a list: [1, 2]";
        return (message.to_owned(), help.to_owned());
    }
    let is_word = word.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && word
            .chars()
            .all(|c| c.is_alphanumeric() || "_-./".contains(c));
    if message.contains("duplicate") {
        let help = "it stands twice: leave one out, or put all keys of a table below one header";
        return (message.to_owned(), help.to_owned());
    }
    if rest.starts_with(',') && message.contains("newline") {
        let help = "leave the comma out: each key stands on a line of its own";
        return (message.to_owned(), help.to_owned());
    }
    match word.to_lowercase().as_str() {
        "null" | "none" | "nil" => (
            format!("'{word}' is no value of TOML"),
            "leave the key out".to_owned(),
        ),
        flag @ ("true" | "false") if flag != word => {
            (message.to_owned(), format!("TOML writes it {flag}"))
        }
        flag @ ("yes" | "no" | "on" | "off") => {
            let truth = matches!(flag, "yes" | "on");
            (
                message.to_owned(),
                format!("write {truth}, or \"{word}\" for a text"),
            )
        }
        _ if is_ratio(word) => (
            format!("'{word}' is no value of TOML"),
            format!("a ratio stands in quotes: \"{word}\""),
        ),
        _ if message.contains("escape") => (
            message.to_owned(),
            "in \"…\" a backslash begins a character that is written with it; write it twice, \
             or write '…' around the text"
                .to_owned(),
        ),
        _ if is_word => (
            format!("'{word}' is no value of TOML"),
            format!("a text stands in quotes: \"{word}\""),
        ),
        _ => (message.to_owned(), habit(word, message).to_owned()),
    }
}

/// What to do about the habits of other languages.
fn habit(word: &str, message: &str) -> &'static str {
    let number = ["mantissa", "fraction", "float", "leading zero"];
    if word.contains(['“', '”', '„', '‘', '’', '`']) {
        "write straight quotes: \"…\""
    } else if word.starts_with("//") || word.ends_with(';') && word.len() < 2 {
        "a comment begins with #, and nothing ends a line"
    } else if word.ends_with(';') {
        "leave the ; out: nothing ends a line"
    } else if word.is_empty() && message.contains("quoted") {
        "the value is missing: write one behind =, or leave the key out"
    } else if word.starts_with('*') {
        "a name with signs in it stands in quotes, as in [joint.\"*\"]"
    } else if word.starts_with(':') {
        "a key and its value are joined by ="
    } else if message.contains("carriage return") {
        "save the file with the line ends of Unix or Windows"
    } else if message.contains("unclosed") {
        "write the bracket or the quotation mark that is missing"
    } else if word.starts_with(|c: char| c.is_ascii_digit() || ".,".contains(c))
        || number.iter().any(|number| message.contains(number))
    {
        "a number is written as 0.5 or 1e-3: with a point between digits, without a unit"
    } else {
        "the file must be TOML 1.0"
    }
}

/// The article of a noun.
pub(super) fn article(noun: &str) -> &'static str {
    let vowel = noun.starts_with(['a', 'e', 'i', 'o', 'u']);
    if vowel { "an" } else { "a" }
}

/// Words of which one is expected.
pub(super) fn one_of(words: &[&str]) -> String {
    let quoted: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
    quoted.join(" or ")
}
