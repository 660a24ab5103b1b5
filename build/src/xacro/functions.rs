//! The functions that expressions of xacro may call: some of Python's own, those of `math`, and
//! methods of texts, lists and dictionaries.

use super::format::format_braces;
use super::numbers::of_numbers;
use super::value::{Value, insert, items};
use std::rc::Rc;

/// Python's own that are known everywhere.
const OWN: [&str; 31] = [
    "list",
    "dict",
    "map",
    "len",
    "str",
    "float",
    "int",
    "bool",
    "min",
    "max",
    "round",
    "sorted",
    "range",
    "abs",
    "all",
    "any",
    "divmod",
    "enumerate",
    "filter",
    "isinstance",
    "ord",
    "repr",
    "reversed",
    "set",
    "sum",
    "tuple",
    "type",
    "zip",
    "chr",
    "pow",
    "hasattr",
];

/// Of numbers.
const MATH: [&str; 34] = [
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "sqrt",
    "exp",
    "log",
    "log10",
    "log2",
    "floor",
    "ceil",
    "trunc",
    "fabs",
    "radians",
    "degrees",
    "isnan",
    "isinf",
    "atan2",
    "hypot",
    "fmod",
    "copysign",
    "pow",
    "gcd",
    "factorial",
    "cbrt",
    "expm1",
    "log1p",
    "fsum",
    "isclose",
];

/// Of xacro itself.
const XACRO: [&str; 10] = [
    "load_yaml",
    "abs_filename",
    "dotify",
    "arg",
    "message",
    "warning",
    "error",
    "fatal",
    "tokenize",
    "print_location",
];

/// Methods of dictionaries, which hide behind keys.
pub const METHODS: [&str; 5] = ["keys", "values", "items", "get", "copy"];

fn constant(name: &str) -> Option<Value> {
    Some(Value::Float(match name {
        "pi" => std::f64::consts::PI,
        "e" => std::f64::consts::E,
        "tau" => std::f64::consts::TAU,
        "inf" => f64::INFINITY,
        "nan" => f64::NAN,
        _ => return None,
    }))
}

fn among(list: &[&'static str], name: &str) -> Option<Value> {
    let found = list.iter().find(|known| **known == name);
    found.map(|known| Value::Function(known))
}

/// What a name means that no property has.
pub fn global(name: &str) -> Option<Value> {
    match name {
        "True" => Some(Value::Bool(true)),
        "False" => Some(Value::Bool(false)),
        "None" => Some(Value::None),
        "math" => Some(Value::Module("math")),
        "python" => Some(Value::Module("python")),
        "xacro" => Some(Value::Module("xacro")),
        _ => constant(name)
            // As in Python, a function of two numbers, not of whole ones.
            .or_else(|| (name == "pow").then_some(Value::Function("pow")))
            .or_else(|| among(&OWN[..13], name))
            .or_else(|| among(&MATH, name))
            .or_else(|| {
                among(
                    &["sorted", "range", "load_yaml", "abs_filename", "dotify"],
                    name,
                )
            }),
    }
}

/// The names that [`global`] knows, but for those of one letter.
pub fn globals<'a>() -> Vec<&'a str> {
    let mut all = vec!["True", "False", "None", "pi", "tau", "inf", "nan"];
    all.extend(&OWN[..13]);
    all.extend(MATH);
    all
}

/// A function of a module.
pub fn of_module(module: &str, name: &str) -> Option<Value> {
    match module {
        "math" => constant(name).or_else(|| among(&MATH, name)),
        "python" => among(&OWN, name),
        _ => among(&XACRO, name),
    }
}

/// Where names are looked up, and files read; without more there are none.
pub trait Names {
    /// The value of a name; `Ok(None)` where there is none.
    fn name(&mut self, _name: &str) -> Result<Option<Value>, String> {
        Ok(None)
    }
    /// A name of an included file's scope.
    fn in_scope(&mut self, _scope: usize, _name: &str) -> Result<Option<Value>, String> {
        Ok(None)
    }
    /// Hears of a name that is nowhere defined.
    fn unknown(&mut self, _name: &str) {}
    /// `xacro.load_yaml(name)`
    fn yaml(&mut self, _name: &str) -> Result<Value, String> {
        Err("files cannot be read here".to_owned())
    }
    /// The path of a file that the current one names.
    fn path(&mut self, name: &str) -> String {
        name.to_owned()
    }
    /// `xacro.arg(name)`, and names of `$(eval …)`.
    fn argument(&mut self, _name: &str) -> Option<String> {
        None
    }
}

/// Calls a function.
pub fn call(
    names: &mut dyn Names,
    function: &Value,
    values: &[Value],
    named: Vec<(String, Value)>,
) -> Result<Value, String> {
    match function {
        Value::Function(name) => own(names, name, values, named),
        Value::Method(of) => method(&of.0, &of.1, values, &named),
        other => Err(format!("'{}' is no function", other.kind())),
    }
}

#[allow(
    clippy::too_many_lines,
    clippy::match_same_arms,
    reason = "one arm for each function"
)]
fn own(
    names: &mut dyn Names,
    name: &'static str,
    values: &[Value],
    named: Vec<(String, Value)>,
) -> Result<Value, String> {
    let wrong = || format!("{name}() does not take these arguments");
    if let ("tokenize", [text], [(key, signs)]) = (name, values, &named[..])
        && key == "sep"
    {
        return own(names, name, &[text.clone(), signs.clone()], Vec::new());
    }
    if !named.is_empty() && name != "dict" {
        return Err(wrong());
    }
    if let Some(found) = of_numbers(name, values)? {
        return Ok(found);
    }
    Ok(match (name, values) {
        ("dict", values) => {
            let mut pairs = Vec::new();
            for value in values {
                match value {
                    Value::Dict(own) => {
                        for (key, value) in own.iter() {
                            insert(&mut pairs, key.clone(), value.clone());
                        }
                    }
                    other => {
                        for pair in items(other)? {
                            let [key, value] = &items(&pair)?[..] else {
                                return Err(wrong());
                            };
                            insert(&mut pairs, key.clone(), value.clone());
                        }
                    }
                }
            }
            for (key, value) in named {
                insert(&mut pairs, Value::text(key), value);
            }
            Value::Dict(Rc::new(pairs))
        }
        ("list", []) => Value::list(Vec::new()),
        ("tuple", []) => Value::Tuple(Rc::default()),
        ("set", []) => Value::Set(Rc::default()),
        ("list", [of]) => Value::list(items(of)?),
        ("tuple", [of]) => Value::Tuple(Rc::new(items(of)?)),
        ("set", [of]) => {
            let mut found: Vec<Value> = Vec::new();
            for value in items(of)? {
                if !found.iter().any(|own| own.same(&value)) {
                    found.push(value);
                }
            }
            Value::Set(Rc::new(found))
        }
        ("map", [function, list]) => {
            let mut found = Vec::new();
            for value in items(list)? {
                found.push(call(names, function, &[value], Vec::new())?);
            }
            Value::list(found)
        }
        ("filter", [function, list]) => {
            let mut found = Vec::new();
            for value in items(list)? {
                let keep = match function {
                    Value::None => value.clone(),
                    function => call(names, function, std::slice::from_ref(&value), Vec::new())?,
                };
                if keep.truth() {
                    found.push(value);
                }
            }
            Value::list(found)
        }
        ("len", [of]) => Value::Int(i64::try_from(items(of)?.len()).map_err(|_| wrong())?),
        ("str", []) => Value::text(""),
        ("str", [of]) => Value::text(of.shown()),
        ("repr", [of]) => Value::text(of.literal()),
        ("bool", [of]) => Value::Bool(of.truth()),
        ("sorted", [of]) => sorted(of)?,
        ("reversed", [of]) => Value::list(items(of)?.into_iter().rev().collect()),
        ("range", values) => range(values).ok_or_else(wrong)?,
        ("all", [of]) => Value::Bool(items(of)?.iter().all(Value::truth)),
        ("any", [of]) => Value::Bool(items(of)?.iter().any(Value::truth)),
        ("enumerate", [of]) => {
            let pair = |(i, value): (usize, Value)| {
                Value::Tuple(Rc::new(vec![
                    Value::Int(i64::try_from(i).unwrap_or(0)),
                    value,
                ]))
            };
            Value::list(items(of)?.into_iter().enumerate().map(pair).collect())
        }
        ("zip", lists) if !lists.is_empty() => {
            let lists: Vec<Vec<Value>> = lists.iter().map(items).collect::<Result<_, _>>()?;
            let length = lists.iter().map(Vec::len).min().unwrap_or(0);
            let row =
                |i: usize| Value::Tuple(Rc::new(lists.iter().map(|l| l[i].clone()).collect()));
            Value::list((0..length).map(row).collect())
        }
        ("ord", [Value::Str(text)]) => {
            let mut letters = text.chars();
            let (Some(letter), None) = (letters.next(), letters.next()) else {
                return Err(wrong());
            };
            Value::Int(i64::from(u32::from(letter)))
        }
        ("type", [of]) => Value::text(of.kind()),
        ("isinstance", [of, Value::Function(kind)]) => Value::Bool(of.kind() == *kind),
        ("load_yaml", [Value::Str(file)]) => names.yaml(file)?,
        ("abs_filename", [Value::Str(file)]) => Value::text(names.path(file)),
        ("dotify", [of]) => of.clone(),
        ("arg", [Value::Str(name)]) => {
            let found = names.argument(name);
            Value::text(found.ok_or_else(|| format!("the argument '{name}' has no value"))?)
        }
        ("message" | "warning" | "error" | "print_location", _) => Value::text(""),
        ("fatal", values) => {
            let parts: Vec<String> = values.iter().map(Value::shown).collect();
            return Err(parts.join(" "));
        }
        ("tokenize", [Value::Str(text)]) => tokens(text, ",; "),
        ("tokenize", [Value::Str(text), Value::Str(signs)]) => tokens(text, signs),
        _ => return Err(wrong()),
    })
}

fn tokens(text: &str, signs: &str) -> Value {
    let parts = text
        .split(|c| signs.contains(c))
        .filter(|part| !part.is_empty());
    Value::list(parts.map(Value::text).collect())
}

fn sorted(of: &Value) -> Result<Value, String> {
    let mut list = items(of)?;
    let mut odd = false;
    list.sort_by(|a, b| {
        a.order(b).unwrap_or_else(|| {
            odd = true;
            std::cmp::Ordering::Equal
        })
    });
    if odd {
        return Err("these values have no order".to_owned());
    }
    Ok(Value::list(list))
}

fn range(values: &[Value]) -> Option<Value> {
    let whole: Vec<i64> = values.iter().map(Value::whole).collect::<Option<_>>()?;
    let (from, to, step) = match whole[..] {
        [to] => (0, to, 1),
        [from, to] => (from, to, 1),
        [from, to, step] if step != 0 => (from, to, step),
        _ => return None,
    };
    let mut list = Vec::new();
    let mut at = from;
    while (if step > 0 { at < to } else { at > to }) && list.len() < 100_000 {
        list.push(Value::Int(at));
        at = at.checked_add(step)?;
    }
    Some(Value::list(list))
}

fn method(
    of: &Value,
    name: &str,
    values: &[Value],
    named: &[(String, Value)],
) -> Result<Value, String> {
    let wrong = || {
        format!(
            "'{}' has no function {name}() for these arguments",
            of.kind()
        )
    };
    let list = |parts: Vec<&str>| Value::list(parts.into_iter().map(Value::text).collect());
    Ok(match (of, name, values) {
        (Value::Str(text), "format", values) => format_braces(text, values, named)?,
        _ if !named.is_empty() => return Err(wrong()),
        (Value::Str(text), "split", []) => list(text.split_whitespace().collect()),
        (Value::Str(text), "split", [Value::Str(by)]) if !by.is_empty() => {
            list(text.split(by.as_ref()).collect())
        }
        (Value::Str(text), "split", [Value::Str(by), Value::Int(most)]) if !by.is_empty() => {
            let most = usize::try_from(*most).map_or(usize::MAX, |most| most + 1);
            list(text.splitn(most, by.as_ref()).collect())
        }
        (Value::Str(text), "join", [parts]) => {
            let parts: Vec<String> = items(parts)?.iter().map(Value::shown).collect();
            Value::text(parts.join(text))
        }
        (Value::Str(text), "replace", [Value::Str(a), Value::Str(b)]) => {
            Value::text(text.replace(a.as_ref(), b))
        }
        (Value::Str(text), "lower", []) => Value::text(text.to_lowercase()),
        (Value::Str(text), "upper", []) => Value::text(text.to_uppercase()),
        (Value::Str(text), "strip", []) => Value::text(text.trim()),
        (Value::Str(text), "lstrip", []) => Value::text(text.trim_start()),
        (Value::Str(text), "rstrip", []) => Value::text(text.trim_end()),
        (Value::Str(text), "strip" | "lstrip" | "rstrip", [Value::Str(signs)]) => {
            let sign = |c: char| signs.contains(c);
            Value::text(match name {
                "strip" => text.trim_matches(sign),
                "lstrip" => text.trim_start_matches(sign),
                _ => text.trim_end_matches(sign),
            })
        }
        (Value::Str(text), "startswith", [Value::Str(part)]) => {
            Value::Bool(text.starts_with(part.as_ref()))
        }
        (Value::Str(text), "endswith", [Value::Str(part)]) => {
            Value::Bool(text.ends_with(part.as_ref()))
        }
        (Value::Str(text), "count", [Value::Str(part)]) if !part.is_empty() => {
            Value::Int(i64::try_from(text.matches(part.as_ref()).count()).unwrap_or(0))
        }
        (Value::Str(text), "find", [Value::Str(part)]) => {
            let at = text
                .find(part.as_ref())
                .map(|at| text[..at].chars().count());
            Value::Int(at.map_or(-1, |at| i64::try_from(at).unwrap_or(-1)))
        }
        (Value::Str(text), "isdigit", []) => {
            Value::Bool(!text.is_empty() && text.chars().all(|c| c.is_ascii_digit()))
        }
        (Value::Str(text), "capitalize", []) => {
            let mut letters = text.chars();
            let first = letters.next().map(|c| c.to_uppercase().to_string());
            Value::text(first.unwrap_or_default() + &letters.as_str().to_lowercase())
        }
        (Value::List(all), "index", [value]) => {
            let at = all
                .iter()
                .position(|own| own.same(value))
                .ok_or_else(wrong)?;
            Value::Int(i64::try_from(at).unwrap_or(0))
        }
        (Value::List(all), "count", [value]) => {
            let count = all.iter().filter(|own| own.same(value)).count();
            Value::Int(i64::try_from(count).unwrap_or(0))
        }
        (Value::Dict(pairs), "keys", []) => {
            Value::list(pairs.iter().map(|(key, _)| key.clone()).collect())
        }
        (Value::Dict(pairs), "values", []) => {
            Value::list(pairs.iter().map(|(_, value)| value.clone()).collect())
        }
        (Value::Dict(pairs), "items", []) => {
            let pair = |(a, b): &(Value, Value)| Value::Tuple(Rc::new(vec![a.clone(), b.clone()]));
            Value::list(pairs.iter().map(pair).collect())
        }
        (Value::Dict(_) | Value::List(_), "copy", []) => of.clone(),
        (Value::Dict(pairs), "get", [key, rest @ ..]) if rest.len() < 2 => {
            let found = pairs.iter().find(|(own, _)| own.same(key));
            let default = rest.first().cloned().unwrap_or(Value::None);
            found.map_or(default, |(_, value)| value.clone())
        }
        _ => return Err(wrong()),
    })
}
