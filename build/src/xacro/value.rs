//! Values of xacro's expressions, which are Python's, and how Python writes them.

use super::tree::Element;
use std::cmp::Ordering;
use std::rc::Rc;

/// A value.
#[derive(Clone, Debug)]
pub enum Value {
    /// `None`
    None,
    /// `True`, `False`
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// Text.
    Str(Rc<str>),
    /// `[…]`
    List(Rc<Vec<Value>>),
    /// `(…)`
    Tuple(Rc<Vec<Value>>),
    /// `{…}`, in the order of insertion.
    Dict(Rc<Vec<(Value, Value)>>),
    /// `set(…)`, each value once, in the order of insertion.
    Set(Rc<Vec<Value>>),
    /// Properties of an included file with a name of its own.
    Scope(usize),
    /// A function by its name.
    Function(&'static str),
    /// Functions with a common name: `math`, `python`, `xacro`.
    Module(&'static str),
    /// A function of a value.
    Method(Rc<(Value, String)>),
    /// A block of XML.
    Block(Rc<Element>),
}

impl Value {
    /// Text.
    pub fn text(text: impl AsRef<str>) -> Self {
        Self::Str(text.as_ref().into())
    }

    /// A list.
    pub fn list(values: Vec<Self>) -> Self {
        Self::List(Rc::new(values))
    }

    /// Python's name of its type.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::None => "NoneType",
            Self::Bool(_) => "bool",
            Self::Int(_) => "int",
            Self::Float(_) => "float",
            Self::Str(_) => "str",
            Self::List(_) => "list",
            Self::Tuple(_) => "tuple",
            Self::Dict(_) => "dict",
            Self::Set(_) => "set",
            Self::Scope(_) | Self::Module(_) => "namespace",
            Self::Function(_) | Self::Method(_) => "function",
            Self::Block(_) => "block",
        }
    }

    /// Whether scopes are in it: their numbers mean nothing to another expansion.
    pub fn holds_scope(&self) -> bool {
        match self {
            Self::Scope(_) => true,
            Self::List(values) | Self::Tuple(values) | Self::Set(values) => {
                values.iter().any(Self::holds_scope)
            }
            Self::Dict(pairs) => {
                let mut pairs = pairs.iter();
                pairs.any(|(key, value)| key.holds_scope() || value.holds_scope())
            }
            Self::Method(of) => of.0.holds_scope(),
            _ => false,
        }
    }

    /// Whether it counts as true.
    pub fn truth(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(value) => *value,
            Self::Int(value) => *value != 0,
            Self::Float(value) => *value != 0.0,
            Self::Str(value) => !value.is_empty(),
            Self::List(values) | Self::Tuple(values) | Self::Set(values) => !values.is_empty(),
            Self::Dict(values) => !values.is_empty(),
            _ => true,
        }
    }

    /// As a number, where it is one; `True` is 1.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Bool(value) => Some(f64::from(u8::from(*value))),
            #[allow(clippy::cast_precision_loss, reason = "as Python does")]
            Self::Int(value) => Some(*value as f64),
            Self::Float(value) => Some(*value),
            _ => None,
        }
    }

    /// As a whole number, where it is one.
    pub fn whole(&self) -> Option<i64> {
        match self {
            Self::Bool(value) => Some(i64::from(*value)),
            Self::Int(value) => Some(*value),
            _ => None,
        }
    }

    /// Whether both are the same to Python.
    pub fn same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::None, Self::None) => true,
            (Self::Str(a), Self::Str(b)) => a == b,
            (Self::List(a), Self::List(b)) | (Self::Tuple(a), Self::Tuple(b)) => {
                a.len() == b.len() && a.iter().zip(b.iter()).all(|(a, b)| a.same(b))
            }
            (Self::Set(a), Self::Set(b)) => a.len() == b.len() && without(a, b).is_empty(),
            (Self::Dict(a), Self::Dict(b)) => {
                let has =
                    |key: &Self, value: &Self| b.iter().any(|(k, v)| k.same(key) && v.same(value));
                a.len() == b.len() && a.iter().all(|(key, value)| has(key, value))
            }
            _ => match (self.number(), other.number()) {
                #[allow(clippy::float_cmp, reason = "Python's own comparison")]
                (Some(a), Some(b)) => a == b,
                _ => false,
            },
        }
    }

    /// Which one is greater, where they can be compared.
    pub fn order(&self, other: &Self) -> Option<Ordering> {
        match (self, other) {
            (Self::Str(a), Self::Str(b)) => Some(a.as_ref().cmp(b.as_ref())),
            (Self::List(a), Self::List(b)) | (Self::Tuple(a), Self::Tuple(b)) => {
                let unlike = a.iter().zip(b.iter()).find(|(a, b)| !a.same(b));
                unlike.map_or(Some(a.len().cmp(&b.len())), |(a, b)| a.order(b))
            }
            _ => self.number()?.partial_cmp(&other.number()?),
        }
    }

    /// `str(value)`.
    pub fn shown(&self) -> String {
        match self {
            Self::Str(text) => text.to_string(),
            _ => self.literal(),
        }
    }

    /// `repr(value)`.
    pub fn literal(&self) -> String {
        let all = |values: &[Self]| -> String {
            let parts: Vec<String> = values.iter().map(Self::literal).collect();
            parts.join(", ")
        };
        match self {
            Self::None => "None".to_owned(),
            Self::Bool(true) => "True".to_owned(),
            Self::Bool(false) => "False".to_owned(),
            Self::Int(value) => value.to_string(),
            Self::Float(value) => float(*value),
            Self::Str(text) => quoted(text),
            Self::List(values) => format!("[{}]", all(values)),
            Self::Tuple(values) if values.len() == 1 => format!("({},)", all(values)),
            Self::Tuple(values) => format!("({})", all(values)),
            Self::Set(values) if values.is_empty() => "set()".to_owned(),
            Self::Set(values) => format!("{{{}}}", all(values)),
            Self::Dict(pairs) => {
                let pairs = pairs.iter();
                let parts: Vec<String> = pairs
                    .map(|(key, value)| format!("{}: {}", key.literal(), value.literal()))
                    .collect();
                format!("{{{}}}", parts.join(", "))
            }
            Self::Scope(_) | Self::Module(_) => "<namespace>".to_owned(),
            Self::Function(name) => format!("<function {name}>"),
            Self::Method(of) => format!("<method {}>", of.1),
            Self::Block(element) => format!("<block {}>", element.name),
        }
    }

    /// Whether its literal stays below `left` bytes or so, and no deeper than `depth` levels:
    /// values share their parts, so that a few can stand for a text that fills every memory.
    pub fn fits(&self, left: &mut usize, depth: usize) -> bool {
        let own = match self {
            Self::Str(text) => text.len() + 2,
            _ => 2,
        };
        let Some(rest) = left.checked_sub(own) else {
            return false;
        };
        *left = rest;
        let Some(depth) = depth.checked_sub(1) else {
            return false;
        };
        match self {
            Self::List(values) | Self::Tuple(values) | Self::Set(values) => {
                values.iter().all(|v| v.fits(left, depth))
            }
            Self::Dict(pairs) => {
                let mut pairs = pairs.iter();
                pairs.all(|(key, value)| key.fits(left, depth) && value.fits(left, depth))
            }
            Self::Method(of) => of.0.fits(left, depth),
            _ => true,
        }
    }

    /// What a property's or an argument's text stands for: a number, a Boolean value, or itself.
    pub fn of_literal(self) -> Self {
        let Self::Str(text) = &self else {
            return self;
        };
        if let Some(inner) = text
            .strip_prefix('\'')
            .and_then(|rest| rest.strip_suffix('\''))
        {
            return Self::text(inner);
        }
        if text.contains('_') {
            return self;
        }
        number_of(text).unwrap_or_else(|| match text.as_ref() {
            "true" | "True" => Self::Bool(true),
            "false" | "False" => Self::Bool(false),
            _ => self.clone(),
        })
    }
}

/// What `for` goes through.
pub fn items(of: &Value) -> Result<Vec<Value>, String> {
    Ok(match of {
        Value::List(list) | Value::Tuple(list) | Value::Set(list) => list.to_vec(),
        Value::Dict(pairs) => pairs.iter().map(|(key, _)| key.clone()).collect(),
        Value::Str(text) => text.chars().map(|c| Value::text(c.to_string())).collect(),
        _ => return Err(format!("'{}' is no list", of.kind())),
    })
}

/// Values of a list that another one does not have.
pub fn without(list: &[Value], others: &[Value]) -> Vec<Value> {
    let other = |value: &&Value| !others.iter().any(|other| other.same(value));
    list.iter().filter(other).cloned().collect()
}

/// Adds an entry, or replaces it.
pub fn insert(pairs: &mut Vec<(Value, Value)>, key: Value, value: Value) {
    match pairs.iter_mut().find(|(own, _)| own.same(&key)) {
        Some((_, own)) => *own = value,
        None => pairs.push((key, value)),
    }
}

/// `int(text)`, else `float(text)`.
pub fn number_of(text: &str) -> Option<Value> {
    let text = text.trim();
    if let Ok(whole) = text.parse::<i64>() {
        return Some(Value::Int(whole));
    }
    float_of(text).map(Value::Float)
}

/// `float(text)`.
pub fn float_of(text: &str) -> Option<f64> {
    // Rust knows the same words as Python, in any case.
    text.trim().parse::<f64>().ok()
}

/// `repr(float)`: the shortest digits that mean the number, with an exponent below 1e-4 and from
/// 1e16 on.
pub fn float(value: f64) -> String {
    if value.is_nan() {
        return "nan".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "inf" } else { "-inf" }.to_owned();
    }
    let scientific = format!("{value:e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if value != 0.0 && !(-4..16).contains(&exponent) {
        let sign = if exponent < 0 { '-' } else { '+' };
        return format!("{digits}e{sign}{:02}", exponent.abs());
    }
    let plain = format!("{value}");
    if plain.contains('.') {
        plain
    } else {
        plain + ".0"
    }
}

fn quoted(text: &str) -> String {
    let quote = if text.contains('\'') && !text.contains('"') {
        '"'
    } else {
        '\''
    };
    let mut out = String::from(quote);
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            c if c == quote => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out.push(quote);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: what Python 3.11 prints.
    #[test]
    fn numbers_are_written_as_python_writes_them() {
        for (value, text) in [
            (0.1 + 0.2, "0.30000000000000004"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (1.5e-7, "1.5e-07"),
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (1e100, "1e+100"),
            (3.0, "3.0"),
            (-0.0, "-0.0"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(float(value), text);
        }
    }

    #[test]
    fn texts_of_properties_become_numbers_and_booleans() {
        let of = |text: &str| Value::text(text).of_literal().literal();
        for (text, value) in [
            ("3", "3"),
            (" 3.50 ", "3.5"),
            ("1e3", "1000.0"),
            ("true", "True"),
            ("'5'", "'5'"),
            ("1_000", "'1_000'"),
            ("1 2", "'1 2'"),
            ("", "''"),
        ] {
            assert_eq!(of(text), value, "{text}");
        }
    }
}
