//! Texts with fields: `"{:.3f}".format(x)` and `"%d" % x`.

use super::numbers::of_numbers;
use super::value::Value;

/// `'{} {name} {0:.3f}'.format(…)`
pub fn format_braces(
    text: &str,
    values: &[Value],
    named: &[(String, Value)],
) -> Result<Value, String> {
    let mut out = String::new();
    let mut next = 0;
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        out.push_str(&rest[..at]);
        let sign = &rest[at..=at];
        rest = &rest[at + 1..];
        if rest.starts_with(sign) {
            out.push_str(sign);
            rest = &rest[1..];
            continue;
        }
        let (field, after) = rest.split_once('}').ok_or("a '}' is missing in a format")?;
        rest = after;
        let (name, how) = field.split_once(':').unwrap_or((field, ""));
        let value = if name.is_empty() {
            next += 1;
            values.get(next - 1)
        } else if let Ok(index) = name.parse::<usize>() {
            values.get(index)
        } else {
            named
                .iter()
                .find(|(own, _)| own == name)
                .map(|(_, value)| value)
        };
        let value = value.ok_or_else(|| format!("the format has no value for '{{{field}}}'"))?;
        out.push_str(&written(value, how)?);
    }
    out.push_str(rest);
    Ok(Value::text(out))
}

/// A value by a format such as `.3f`, `02d`, `d` or `s`.
fn written(value: &Value, how: &str) -> Result<String, String> {
    let unknown = || format!("the format '{how}' is not known");
    if how.is_empty() {
        return Ok(value.shown());
    }
    let kind = how.chars().last().filter(char::is_ascii_alphabetic);
    let digits = kind.map_or(how, |kind| &how[..how.len() - kind.len_utf8()]);
    let (width, precision) = digits.split_once('.').unwrap_or((digits, ""));
    let zeros = width.starts_with('0');
    let width: usize = if width.is_empty() {
        0
    } else {
        width.parse().map_err(|_| unknown())?
    };
    let precision: Option<usize> = if precision.is_empty() {
        None
    } else {
        Some(precision.parse().map_err(|_| unknown())?)
    };
    if width > 100 || precision.is_some_and(|p| p > 100) {
        return Err(unknown());
    }
    let text = match (kind, precision) {
        (Some('f'), precision) => {
            let number = value.number().ok_or_else(unknown)?;
            format!("{number:.*}", precision.unwrap_or(6))
        }
        (Some('d'), None) => value.whole().ok_or_else(unknown)?.to_string(),
        (Some('s') | None, None) => value.shown(),
        _ => return Err(unknown()),
    };
    Ok(if zeros {
        format!("{text:0>width$}")
    } else if value.number().is_some() {
        format!("{text:>width$}")
    } else {
        format!("{text:<width$}")
    })
}

/// `'%d %s' % (…)`
pub fn percent(text: &str, values: &Value) -> Result<Value, String> {
    let values = match values {
        Value::Tuple(list) => list.to_vec(),
        one => vec![one.clone()],
    };
    let mut values = values.iter();
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('%') {
        out.push_str(before);
        let end = after.find(|c: char| c.is_ascii_alphabetic() || c == '%');
        let end = end.ok_or("a format ends after '%'")?;
        let (how, after) = after.split_at(end + 1);
        rest = after;
        if how == "%" {
            out.push('%');
            continue;
        }
        let value = values
            .next()
            .ok_or("the format has more fields than values")?;
        // `%d` cuts a number.
        let value = match (how.ends_with('d'), value) {
            (true, Value::Float(_)) => of_numbers("int", std::slice::from_ref(value))?,
            _ => None,
        }
        .unwrap_or_else(|| value.clone());
        out.push_str(&written(&value, how)?);
    }
    out.push_str(rest);
    Ok(Value::text(out))
}
