//! Functions of numbers that expressions may call.

use super::value::{Value, float_of, items, number_of};
use std::rc::Rc;

/// Functions of numbers; none where it is another one.
#[allow(
    clippy::too_many_lines,
    clippy::match_same_arms,
    reason = "one arm for each function"
)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "checked before"
)]
pub fn of_numbers(name: &str, values: &[Value]) -> Result<Option<Value>, String> {
    let domain = || format!("{name}() has no value here");
    let number = |i: usize| values.get(i).and_then(Value::number);
    let need = |i: usize| number(i).ok_or_else(|| format!("{name}() needs a number"));
    let as_whole = |x: f64| {
        if x.abs() < 9e18 {
            Ok(Value::Int(x as i64))
        } else {
            Err(domain())
        }
    };
    let real = |value: f64, arguments: &[f64]| {
        if value.is_nan() && !arguments.iter().any(|x| x.is_nan()) {
            return Err(domain());
        }
        Ok(Some(Value::Float(value)))
    };
    if values.len() == 1 {
        let of: Option<fn(f64) -> f64> = match name {
            "sin" => Some(f64::sin),
            "cos" => Some(f64::cos),
            "tan" => Some(f64::tan),
            "asin" => Some(f64::asin),
            "acos" => Some(f64::acos),
            "atan" => Some(f64::atan),
            "sinh" => Some(f64::sinh),
            "cosh" => Some(f64::cosh),
            "tanh" => Some(f64::tanh),
            "sqrt" => Some(f64::sqrt),
            "cbrt" => Some(f64::cbrt),
            "exp" => Some(f64::exp),
            "expm1" => Some(f64::exp_m1),
            "log" => Some(f64::ln),
            "log1p" => Some(f64::ln_1p),
            "log10" => Some(f64::log10),
            "log2" => Some(f64::log2),
            "fabs" => Some(f64::abs),
            // Python multiplies by these two quotients.
            "radians" => Some(|x| x * (std::f64::consts::PI / 180.0)),
            "degrees" => Some(|x| x * (180.0 / std::f64::consts::PI)),
            _ => None,
        };
        if let Some(of) = of {
            let x = need(0)?;
            return real(of(x), &[x]);
        }
    }
    Ok(Some(match (name, values) {
        ("floor", [_]) => as_whole(need(0)?.floor())?,
        ("ceil", [_]) => as_whole(need(0)?.ceil())?,
        ("trunc", [_]) => as_whole(need(0)?.trunc())?,
        ("isnan", [_]) => Value::Bool(need(0)?.is_nan()),
        ("isinf", [_]) => Value::Bool(need(0)?.is_infinite()),
        ("atan2", [_, _]) => return real(need(0)?.atan2(need(1)?), &[need(0)?, need(1)?]),
        ("hypot", [_, _]) => return real(need(0)?.hypot(need(1)?), &[need(0)?, need(1)?]),
        ("fmod", [_, _]) => return real(need(0)? % need(1)?, &[need(0)?, need(1)?]),
        ("copysign", [_, _]) => return real(need(0)?.copysign(need(1)?), &[need(0)?, need(1)?]),
        ("pow", [_, _]) => return real(need(0)?.powf(need(1)?), &[need(0)?, need(1)?]),
        ("log", [_, _]) => return real(need(0)?.ln() / need(1)?.ln(), &[need(0)?, need(1)?]),
        ("abs", [Value::Int(value)]) => Value::Int(value.checked_abs().ok_or_else(domain)?),
        ("abs", [_]) => Value::Float(need(0)?.abs()),
        ("float", []) => Value::Float(0.0),
        ("float", [Value::Str(text)]) => {
            Value::Float(float_of(text).ok_or_else(|| format!("'{text}' is no number"))?)
        }
        ("float", [_]) => Value::Float(need(0)?),
        ("int", []) => Value::Int(0),
        ("int", [Value::Str(text)]) => match number_of(text) {
            Some(value @ Value::Int(_)) => value,
            _ => return Err(format!("'{text}' is no whole number")),
        },
        ("int", [value]) if value.whole().is_some() => Value::Int(value.whole().unwrap_or(0)),
        ("int", [_]) => as_whole(need(0)?.trunc())?,
        ("round", [value]) if value.whole().is_some() => Value::Int(value.whole().unwrap_or(0)),
        // Half goes to the even one.
        ("round", [_]) => as_whole(need(0)?.round_ties_even())?,
        ("round", [value, digits]) => {
            let digits = digits.whole().ok_or_else(domain)?;
            match (value, usize::try_from(digits)) {
                (Value::Int(value), Ok(_)) => Value::Int(*value),
                (_, Ok(digits)) => {
                    let text = format!("{:.*}", digits.min(300), need(0)?);
                    Value::Float(text.parse().map_err(|_| domain())?)
                }
                _ => return Err(domain()),
            }
        }
        ("divmod", [a, b]) => {
            let (Some(a), Some(b)) = (a.whole(), b.whole().filter(|&b| b != 0)) else {
                return Err(domain());
            };
            let (quotient, rest) = (a.div_euclid(b), a.rem_euclid(b));
            Value::Tuple(Rc::new(vec![Value::Int(quotient), Value::Int(rest)]))
        }
        ("sum" | "fsum", [list]) => {
            let mut total = Value::Int(0);
            for value in items(list)? {
                total = match (total.whole(), value.whole()) {
                    (Some(a), Some(b)) => Value::Int(a.checked_add(b).ok_or_else(domain)?),
                    _ => Value::Float(
                        total.number().ok_or_else(domain)? + value.number().ok_or_else(domain)?,
                    ),
                };
            }
            total
        }
        ("min" | "max", values) if !values.is_empty() => {
            let list = match values {
                [one] => items(one)?,
                many => many.to_vec(),
            };
            let mut list = list.into_iter();
            let mut best = list.next().ok_or_else(domain)?;
            for value in list {
                let order = value.order(&best).ok_or_else(domain)?;
                if order.is_lt() && name == "min" || order.is_gt() && name == "max" {
                    best = value;
                }
            }
            best
        }
        _ => return Ok(None),
    }))
}
