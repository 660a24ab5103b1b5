//! Expressions → values, by Python's rules.

use super::functions::Names;
use super::parse::{Each, Expression};
use super::value::{Value, insert, items, without};
use super::{format, functions};
use std::rc::Rc;
use urdf2fmu_core::diagnostic::nearest;

/// How the message on a key that is missing begins: no other program has it either.
pub(super) const NO_KEY: &str = "the dictionary has no key";

/// Entries of a list that an expression may make.
const LONGEST: i64 = 1_000_000;

/// What is evaluated, with the names that `for` binds.
pub struct Evaluation<'n> {
    pub names: &'n mut dyn Names,
    bound: Vec<(String, Value)>,
}

impl<'n> Evaluation<'n> {
    pub fn new(names: &'n mut dyn Names) -> Self {
        Self {
            names,
            bound: Vec::new(),
        }
    }

    /// The value of an expression.
    pub fn value(&mut self, expression: &Expression) -> Result<Value, String> {
        Ok(match expression {
            Expression::Number(value) => Value::Float(*value),
            Expression::Whole(value) => Value::Int(*value),
            Expression::Text(text) => Value::Str(Rc::clone(text)),
            Expression::Name(name) => self.name(name)?,
            Expression::List(list) => Value::list(self.all(list)?),
            Expression::Tuple(list) => Value::Tuple(Rc::new(self.all(list)?)),
            Expression::Dict(pairs) => {
                let mut found = Vec::new();
                for (key, value) in pairs {
                    let (key, value) = (self.value(key)?, self.value(value)?);
                    insert(&mut found, key, value);
                }
                Value::Dict(Rc::new(found))
            }
            Expression::Each(each) => Value::list(self.each(each)?),
            Expression::Unary(sign, of) => unary(sign, &self.value(of)?)?,
            Expression::Binary(sign, left, right) => {
                let (left, right) = (self.value(left)?, self.value(right)?);
                binary(sign, &left, &right)?
            }
            Expression::Compare(first, others) => {
                let mut left = self.value(first)?;
                for (sign, right) in others {
                    let right = self.value(right)?;
                    if !compare(sign, &left, &right)? {
                        return Ok(Value::Bool(false));
                    }
                    left = right;
                }
                Value::Bool(true)
            }
            Expression::And(left, right) => {
                let left = self.value(left)?;
                if left.truth() {
                    self.value(right)?
                } else {
                    left
                }
            }
            Expression::Or(left, right) => {
                let left = self.value(left)?;
                if left.truth() {
                    left
                } else {
                    self.value(right)?
                }
            }
            Expression::Choice(parts) => {
                let [condition, then, other] = parts.as_ref();
                let taken = if self.value(condition)?.truth() {
                    then
                } else {
                    other
                };
                self.value(taken)?
            }
            Expression::Attribute(of, name) => {
                let of = self.value(of)?;
                self.attribute(&of, name)?
            }
            Expression::Item(of, index) => {
                let (of, index) = (self.value(of)?, self.value(index)?);
                item(&of, &index)?
            }
            Expression::Slice(of, parts) => {
                let of = self.value(of)?;
                let mut ends = [None; 3];
                for (end, part) in ends.iter_mut().zip(parts) {
                    if let Some(part) = part {
                        let value = self.value(part)?;
                        *end = Some(value.whole().ok_or("a slice needs whole numbers")?);
                    }
                }
                slice(&of, ends)?
            }
            Expression::Call(function, values, named) => {
                let function = self.value(function)?;
                let values = self.all(values)?;
                let mut pairs = Vec::new();
                for (name, value) in named {
                    pairs.push((name.clone(), self.value(value)?));
                }
                functions::call(self.names, &function, &values, pairs)?
            }
        })
    }

    fn all(&mut self, list: &[Expression]) -> Result<Vec<Value>, String> {
        list.iter().map(|value| self.value(value)).collect()
    }

    fn name(&mut self, name: &str) -> Result<Value, String> {
        if let Some((_, value)) = self.bound.iter().rev().find(|(bound, _)| bound == name) {
            return Ok(value.clone());
        }
        if let Some(value) = self.names.name(name)? {
            return Ok(value);
        }
        functions::global(name).ok_or_else(|| self.unknown(name))
    }

    fn unknown(&mut self, name: &str) -> String {
        self.names.unknown(name);
        format!("name '{name}' is not defined")
    }

    fn each(&mut self, each: &Each) -> Result<Vec<Value>, String> {
        let list = items(&self.value(&each.list)?)?;
        let before = self.bound.len();
        let mut found = Vec::new();
        for value in list {
            if let [name] = &each.names[..] {
                self.bound.push((name.clone(), value));
            } else {
                let parts = items(&value)?;
                if parts.len() != each.names.len() {
                    return Err(format!(
                        "{} names for {} values",
                        each.names.len(),
                        parts.len()
                    ));
                }
                self.bound.extend(each.names.iter().cloned().zip(parts));
            }
            let mut taken = true;
            for condition in &each.conditions {
                taken = taken && self.value(condition)?.truth();
            }
            if taken {
                found.push(self.value(&each.value)?);
            }
            self.bound.truncate(before);
        }
        Ok(found)
    }

    fn attribute(&mut self, of: &Value, name: &str) -> Result<Value, String> {
        match of {
            Value::Scope(scope) => {
                let found = self.names.in_scope(*scope, name)?;
                found.ok_or_else(|| self.unknown(name))
            }
            Value::Module(module) => functions::of_module(module, name)
                .ok_or_else(|| format!("name '{name}' is not defined in {module}")),
            Value::Dict(pairs) => {
                let key = Value::text(name);
                if let Some((_, value)) = pairs.iter().find(|(own, _)| own.same(&key)) {
                    return Ok(value.clone());
                }
                if functions::METHODS.contains(&name) {
                    return Ok(Value::Method(Rc::new((of.clone(), name.to_owned()))));
                }
                Err(no_key(pairs, &key))
            }
            _ => Ok(Value::Method(Rc::new((of.clone(), name.to_owned())))),
        }
    }
}

fn unary(sign: &str, of: &Value) -> Result<Value, String> {
    Ok(match (sign, of) {
        ("not", of) => Value::Bool(!of.truth()),
        ("-", Value::Float(value)) => Value::Float(-value),
        ("+", Value::Float(value)) => Value::Float(*value),
        ("-", of) if of.whole().is_some() => {
            let turned = of.whole().and_then(i64::checked_neg);
            Value::Int(turned.ok_or_else(|| "the number is too large".to_owned())?)
        }
        ("+", of) if of.whole().is_some() => Value::Int(of.whole().unwrap_or(0)),
        ("~", of) if of.whole().is_some() => Value::Int(!of.whole().unwrap_or(0)),
        _ => return Err(format!("bad operand for {sign}: '{}'", of.kind())),
    })
}

fn binary(sign: &str, left: &Value, right: &Value) -> Result<Value, String> {
    let bad = || {
        format!(
            "unsupported operands for {sign}: '{}' and '{}'",
            left.kind(),
            right.kind()
        )
    };
    match (sign, left, right) {
        ("+", Value::Str(a), Value::Str(b)) => return Ok(Value::text(format!("{a}{b}"))),
        ("+", Value::List(a), Value::List(b)) => {
            return Ok(Value::list(a.iter().chain(b.iter()).cloned().collect()));
        }
        ("+", Value::Tuple(a), Value::Tuple(b)) => {
            return Ok(Value::Tuple(Rc::new(
                a.iter().chain(b.iter()).cloned().collect(),
            )));
        }
        ("*", Value::Str(_) | Value::List(_), count) if count.whole().is_some() => {
            return repeated(left, count.whole().unwrap_or(0));
        }
        ("*", count, Value::Str(_) | Value::List(_)) if count.whole().is_some() => {
            return repeated(right, count.whole().unwrap_or(0));
        }
        (sign, Value::Set(a), Value::Set(b)) => {
            let (left, right) = (without(a, b), without(b, a));
            return Ok(Value::Set(Rc::new(match sign {
                "-" => left,
                "&" => without(a, &left),
                "|" => [&a[..], &right].concat(),
                "^" => [left, right].concat(),
                _ => return Err(bad()),
            })));
        }
        ("%", Value::Str(format), values) => return format::percent(format, values),
        _ => {}
    }
    if let (Some(a), Some(b)) = (left.whole(), right.whole())
        && let Some(found) = whole(sign, a, b)?
    {
        return Ok(found);
    }
    let (a, b) = (
        left.number().ok_or_else(bad)?,
        right.number().ok_or_else(bad)?,
    );
    let zero = || "division by zero".to_owned();
    Ok(Value::Float(match sign {
        "+" => a + b,
        "-" => a - b,
        "*" => a * b,
        "/" | "//" | "%" if b == 0.0 => return Err(zero()),
        "/" => a / b,
        "//" => (a - floored_rest(a, b)) / b,
        "%" => floored_rest(a, b),
        "**" => a.powf(b),
        _ => return Err(bad()),
    }))
}

/// Python's rest has the sign of the divisor.
fn floored_rest(a: f64, b: f64) -> f64 {
    let rest = a % b;
    if rest != 0.0 && (rest < 0.0) != (b < 0.0) {
        rest + b
    } else {
        rest
    }
}

/// Of whole numbers, where the result is whole.
fn whole(sign: &str, a: i64, b: i64) -> Result<Option<Value>, String> {
    let large = || "the number is too large".to_owned();
    let found = match sign {
        "+" => a.checked_add(b),
        "-" => a.checked_sub(b),
        "*" => a.checked_mul(b),
        "//" | "%" if b == 0 => return Err("division by zero".to_owned()),
        "//" => {
            let quotient = a.checked_div(b).ok_or_else(large)?;
            Some(quotient - i64::from(a % b != 0 && (a < 0) != (b < 0)))
        }
        "%" => {
            let rest = a.checked_rem(b).ok_or_else(large)?;
            Some(if rest != 0 && (rest < 0) != (b < 0) {
                rest + b
            } else {
                rest
            })
        }
        "**" if b >= 0 => u32::try_from(b).ok().and_then(|b| a.checked_pow(b)),
        "<<" => u32::try_from(b).ok().and_then(|b| a.checked_shl(b)),
        ">>" => u32::try_from(b).ok().and_then(|b| a.checked_shr(b)),
        "&" => Some(a & b),
        "|" => Some(a | b),
        "^" => Some(a ^ b),
        _ => return Ok(None),
    };
    found.map(|value| Some(Value::Int(value))).ok_or_else(large)
}

fn repeated(of: &Value, count: i64) -> Result<Value, String> {
    let count = usize::try_from(count.clamp(0, LONGEST)).unwrap_or(0);
    Ok(match of {
        Value::Str(text) if text.len() * count <= 1 << 20 => Value::text(text.repeat(count)),
        Value::List(list) if list.len() * count <= 1 << 20 => {
            Value::list((0..count).flat_map(|_| list.iter().cloned()).collect())
        }
        _ => return Err("the result is too long".to_owned()),
    })
}

fn compare(sign: &str, left: &Value, right: &Value) -> Result<bool, String> {
    use std::cmp::Ordering;
    let order = || {
        left.order(right).ok_or_else(|| {
            format!(
                "'{}' and '{}' cannot be compared by {sign}",
                left.kind(),
                right.kind()
            )
        })
    };
    Ok(match sign {
        "==" => left.same(right),
        "!=" => !left.same(right),
        "is" => left.same(right) && left.kind() == right.kind(),
        "is not" => !(left.same(right) && left.kind() == right.kind()),
        "in" => contains(right, left)?,
        "not in" => !contains(right, left)?,
        "<" => order()? == Ordering::Less,
        ">" => order()? == Ordering::Greater,
        "<=" => order()? != Ordering::Greater,
        _ => order()? != Ordering::Less,
    })
}

fn contains(list: &Value, value: &Value) -> Result<bool, String> {
    match (list, value) {
        (Value::Str(text), Value::Str(part)) => Ok(text.contains(part.as_ref())),
        _ => Ok(items(list)?.iter().any(|own| own.same(value))),
    }
}

/// What is said of a key that a dictionary does not have, with those that it has.
fn no_key(pairs: &[(Value, Value)], key: &Value) -> String {
    /// More keys than these are not shown.
    const MOST: usize = 8;
    let keys: Vec<String> = pairs.iter().map(|(own, _)| own.literal()).collect();
    let known = match (
        nearest(&key.literal(), keys.iter().map(String::as_str)),
        keys.len(),
    ) {
        (Some(near), _) => format!(": did you mean {near}?"),
        (None, 0) => ", nor any other".to_owned(),
        (None, 1..=MOST) => format!(", only {}", keys.join(", ")),
        (None, _) => format!(", only {}, …", keys[..MOST].join(", ")),
    };
    format!("{NO_KEY} {}{known}", key.literal())
}

/// From the end where it is negative.
fn place(index: i64, length: usize) -> Option<usize> {
    let length = i64::try_from(length).ok()?;
    let index = if index < 0 { index + length } else { index };
    (0..length)
        .contains(&index)
        .then(|| usize::try_from(index).ok())?
}

fn item(of: &Value, index: &Value) -> Result<Value, String> {
    if let Value::Dict(pairs) = of {
        let found = pairs.iter().find(|(key, _)| key.same(index));
        return found
            .map(|(_, value)| value.clone())
            .ok_or_else(|| no_key(pairs, index));
    }
    let at = index.whole().ok_or("an index must be a whole number")?;
    let none = || "the index is out of range".to_owned();
    match of {
        Value::Str(text) => {
            let letters: Vec<char> = text.chars().collect();
            let at = place(at, letters.len()).ok_or_else(none)?;
            Ok(Value::text(letters[at].to_string()))
        }
        Value::List(list) | Value::Tuple(list) => {
            let at = place(at, list.len()).ok_or_else(none)?;
            Ok(list[at].clone())
        }
        _ => Err(format!("'{}' has no items", of.kind())),
    }
}

fn slice(of: &Value, [from, to, step]: [Option<i64>; 3]) -> Result<Value, String> {
    let list: Vec<Value> = match of {
        Value::Str(_) | Value::List(_) | Value::Tuple(_) => items(of)?,
        _ => return Err(format!("'{}' has no parts", of.kind())),
    };
    let length = i64::try_from(list.len()).unwrap_or(0);
    let step = step.unwrap_or(1);
    if step == 0 {
        return Err("a slice's step is 0".to_owned());
    }
    let (low, high) = if step > 0 {
        (0, length)
    } else {
        (-1, length - 1)
    };
    let end = |end: Option<i64>, default: i64| {
        end.map_or(default, |end| {
            (if end < 0 { end + length } else { end }).clamp(low, high)
        })
    };
    let (mut at, to) = if step > 0 {
        (end(from, 0), end(to, length))
    } else {
        (end(from, length - 1), end(to, -1))
    };
    let mut found = Vec::new();
    while if step > 0 { at < to } else { at > to } {
        found.push(list[usize::try_from(at).unwrap_or(0)].clone());
        at = at.saturating_add(step);
    }
    Ok(match of {
        Value::Str(_) => Value::text(found.iter().map(Value::shown).collect::<String>()),
        Value::Tuple(_) => Value::Tuple(Rc::new(found)),
        _ => Value::list(found),
    })
}
