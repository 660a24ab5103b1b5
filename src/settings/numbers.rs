//! Numbers of a settings file, alone and in lists: count, range, and how they are written.

use super::advice;
use super::reader::Reader;
use super::section::Value;
use crate::diagnostic::angles;
use crate::range::{Range, number_or_ratio};
use toml::Spanned;
use toml::de::{DeArray, DeValue};

impl Reader<'_> {
    /// Lists of three numbers each, one after the other.
    pub(super) fn vectors(
        &mut self,
        name: &str,
        count: usize,
        range: Range,
        value: &Spanned<DeValue>,
    ) -> Option<Value> {
        let rows = value.get_ref().as_array();
        let Some(rows) = rows.filter(|rows| rows.len() == count) else {
            let expected = format!("a list of {count} lists of three numbers");
            self.wrong_type(name, &expected, value);
            return None;
        };
        let rows = rows.iter().map(|row| {
            let Some(Value::Numbers(numbers)) = self.numbers(name, (3, 3), range, row) else {
                return None;
            };
            Some(numbers)
        });
        let rows: Option<Vec<Vec<f64>>> = rows.collect();
        Some(Value::Numbers(rows?.concat()))
    }

    pub(super) fn numbers(
        &mut self,
        name: &str,
        (least, most): (usize, usize),
        range: Range,
        value: &Spanned<DeValue>,
    ) -> Option<Value> {
        let fits = |array: &&DeArray| (least..=most).contains(&array.len());
        let Some(array) = value.get_ref().as_array().filter(fits) else {
            let count = if least == most {
                format!("{least}")
            } else {
                format!("{least} or {most}")
            };
            let found = value.get_ref();
            let message = match found.as_array() {
                Some(array) => format!("'{name}' must have {count} numbers, not {}", array.len()),
                None => format!(
                    "'{name}' must be a list of {count} numbers, not {} {}",
                    advice::article(found.type_str()),
                    found.type_str()
                ),
            };
            let help = found.as_str().and_then(|text| advice::list(name, text));
            let help = help.filter(|(_, length)| (least..=most).contains(length));
            let help = help.map(|(help, _)| help);
            self.error("S103", &value.span(), message, help.unwrap_or_default());
            return None;
        };
        let numbers: Vec<_> = array
            .iter()
            .filter_map(|element| self.number(name, range, false, element))
            .collect();
        if let (true, Some(message)) = (name == "rpy", angles::attitude("'rpy'", &numbers)) {
            self.error("S104", &value.span(), message, angles::HELP);
            return None;
        }
        (numbers.len() == array.len()).then_some(Value::Numbers(numbers))
    }

    pub(super) fn number(
        &mut self,
        name: &str,
        range: Range,
        ratio: bool,
        value: &Spanned<DeValue>,
    ) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            // An integer beyond 2^63 is no quantity of a robot.
            #[expect(
                clippy::cast_precision_loss,
                reason = "a quantity, not a count: rounding to the nearest is what a float key means"
            )]
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .ok()
                .map(|integer| integer as f64),
            DeValue::String(text) if ratio => {
                let number = number_or_ratio(text);
                if number.is_none() {
                    let message = format!("'{name}' must be a number or a text like \"1/240\"");
                    self.error("S104", &value.span(), message, "");
                    return None;
                }
                number
            }
            _ => {
                self.wrong_type(name, "a number", value);
                return None;
            }
        };
        match number {
            Some(number) if range.contains(number) => Some(number),
            _ => {
                let span = value.span();
                let given = self.text.get(span.clone()).unwrap_or_default();
                let message = format!("'{name}' must be {}, not {given}", range.expected());
                let help = number.map(|number| advice::angle(name, number));
                self.error("S104", &span, message, help.unwrap_or_default());
                None
            }
        }
    }
}
