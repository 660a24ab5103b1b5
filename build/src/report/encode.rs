//! Columns of numbers in few bytes, as `build/page/src/container.js` reads them.
//!
//! A number becomes a whole one, `(x - low) / step`; of these the first or second differences are
//! kept, whichever is smaller when deflated, with the sign in the lowest bit, all lowest bytes
//! first, then all of the next, because neighbours are alike in their high bytes.

use crate::page::{container, deflate};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use urdf2fmu_drawing::scene::Scene;

/// Parts of a column's range that are told apart: a thousandth of a pixel of any plot.
const PARTS: f64 = (1_u32 << 20) as f64;

/// What poses are computed from is never coarser than this, m or rad.
const FINE: f64 = 1e-5;

/// Time is never coarser than this, s, as long as [`MOST`] allows.
const INSTANT: f64 = 1e-9;

/// Greatest whole number; differences of two then fit into 32 bits with their sign.
const MOST: f64 = (1_u32 << 30) as f64;

/// The run as the page reads it: length of the head, head, body.
pub fn run(
    scene: &Scene,
    time: &[f64],
    columns: &[(String, Vec<f64>)],
    notes: &[&String],
    changed: &BTreeMap<String, f64>,
) -> Vec<u8> {
    let head = &scene.head;
    let poses: BTreeSet<&str> = head
        .tracks()
        .flat_map(|track| track.variables.iter().map(String::as_str))
        .collect();
    let mut body = Vec::new();
    let mut list = vec![column("time", time, INSTANT, &mut body)];
    for (name, values) in columns {
        let coarsest = if poses.contains(name.as_str()) {
            FINE
        } else {
            f64::INFINITY
        };
        list.push(column(name, values, coarsest, &mut body));
    }
    let head = json!({
        "format": 1,
        "rows": time.len(),
        "columns": list,
        "notes": notes,
        "changed": changed,
    });
    container(&head, &body)
}

/// Appends a column to the body; gives what the head says of it.
fn column(name: &str, values: &[f64], coarsest: f64, body: &mut Vec<u8>) -> serde_json::Value {
    let known = || values.iter().copied().filter(|x| x.is_finite());
    let low = known().fold(f64::INFINITY, f64::min);
    let high = known().fold(f64::NEG_INFINITY, f64::max);
    let low = if low.is_finite() { low } else { 0.0 };
    let range = (high - low).max(0.0);
    let gaps = gaps(values);
    let mut entry = json!({ "name": name, "low": low, "step": 0, "planes": 0, "order": 1 });
    if !gaps.is_empty() {
        entry["gaps"] = json!(gaps);
    }
    if range == 0.0 {
        return entry;
    }
    let step = (range / PARTS).min(coarsest).max(range / MOST);
    let whole = whole(values, low, step);
    let first: Vec<i64> = differences(&whole);
    let second = differences(&first);
    let packed = [planes(&first), planes(&second)];
    let size = |planes: &Option<Vec<u8>>| planes.as_ref().map_or(usize::MAX, |p| deflate(p).len());
    let order = if size(&packed[1]) < size(&packed[0]) {
        2
    } else {
        1
    };
    let [one, two] = packed;
    let bytes = if order == 2 { two } else { one }.unwrap_or_default();
    entry["step"] = json!(step);
    entry["order"] = json!(order);
    entry["planes"] = json!(bytes.len() / values.len().max(1));
    body.extend(bytes);
    entry
}

/// Rows without a value: first and number of each group.
fn gaps(values: &[f64]) -> Vec<[usize; 2]> {
    let mut gaps: Vec<[usize; 2]> = Vec::new();
    for (row, _) in values.iter().enumerate().filter(|(_, x)| !x.is_finite()) {
        match gaps.last_mut() {
            Some([first, count]) if *first + *count == row => *count += 1,
            _ => gaps.push([row, 1]),
        }
    }
    gaps
}

/// Numbers of steps above `low`; where there is no value, that of the row before.
fn whole(values: &[f64], low: f64, step: f64) -> Vec<i64> {
    let mut before = 0;
    values
        .iter()
        .map(|x| {
            if x.is_finite() {
                #[expect(clippy::cast_possible_truncation, reason = "0 … 2^30 by its step")]
                let n = libm::round((x - low) / step) as i64;
                before = n;
            }
            before
        })
        .collect()
}

fn differences(values: &[i64]) -> Vec<i64> {
    let before = std::iter::once(&0).chain(values);
    values
        .iter()
        .zip(before)
        .map(|(now, before)| now - before)
        .collect()
}

/// Bytes by their weight; none where a number has more than 32 bits.
fn planes(values: &[i64]) -> Option<Vec<u8>> {
    let signed = values
        .iter()
        .map(|&n| u32::try_from((n << 1) ^ (n >> 63)).ok());
    let signed: Vec<u32> = signed.collect::<Option<_>>()?;
    let bits = 32 - signed.iter().fold(0, |all, n| all | n).leading_zeros();
    let planes = bits.div_ceil(8).max(1);
    let plane = |weight: u32| signed.iter().map(move |n| n.to_le_bytes()[weight as usize]);
    Some((0..planes).flat_map(plane).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the page does it.
    fn decoded(entry: &serde_json::Value, body: &[u8], rows: usize) -> Vec<f64> {
        let number = |key: &str| entry[key].as_f64().expect("a number");
        let planes = entry["planes"].as_u64().expect("a number");
        let (mut n, mut slope) = (0_i64, 0_i64);
        let mut values: Vec<f64> = (0..rows)
            .map(|row| {
                let zigzag = (0..planes).fold(0_u32, |z, plane| {
                    let plane = usize::try_from(plane).expect("small");
                    z | u32::from(body[plane * rows + row]) << (8 * plane)
                });
                let difference = i64::from(zigzag >> 1) ^ -i64::from(zigzag & 1);
                if entry["order"] == 2 {
                    slope += difference;
                    n += slope;
                } else {
                    n += difference;
                }
                #[expect(clippy::cast_precision_loss, reason = "at most 2^30")]
                let steps = n as f64;
                number("low") + steps * number("step")
            })
            .collect();
        for gap in entry["gaps"].as_array().into_iter().flatten() {
            let place =
                |i: usize| usize::try_from(gap[i].as_u64().expect("a place")).expect("small");
            values[place(0)..place(0) + place(1)].fill(f64::NAN);
        }
        values
    }

    /// A generator of numbers that are no pattern (xorshift), -1 … 1.
    fn noise(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            #[expect(clippy::cast_precision_loss, reason = "53 bits")]
            let unit = (state >> 11) as f64 / (1_u64 << 52) as f64;
            unit - 1.0
        }
    }

    #[test]
    fn columns_come_back_within_half_a_step() {
        let mut random = noise(7);
        let rows = 500;
        let smooth: Vec<f64> = (0..rows).map(|i| libm::sin(0.02 * f64::from(i))).collect();
        let rough: Vec<f64> = (0..rows).map(|_| 1e6 * random()).collect();
        let far: Vec<f64> = (0..rows).map(|i| 1e12 + 1e-3 * f64::from(i)).collect();
        let huge: Vec<f64> = (0..rows)
            .map(|i| if i % 2 == 0 { 1e37 } else { -1e37 })
            .collect();
        let mut holes = smooth.clone();
        holes[0] = f64::NAN;
        holes[70..90].fill(f64::NAN);
        let constant = vec![-0.25; 500];
        for (name, values) in [
            ("smooth", smooth),
            ("rough", rough),
            ("far", far),
            ("huge", huge),
            ("holes", holes),
            ("constant", constant),
        ] {
            for coarsest in [f64::INFINITY, FINE] {
                let mut body = Vec::new();
                let entry = column(name, &values, coarsest, &mut body);
                let step = entry["step"].as_f64().expect("a number");
                for (was, is) in values.iter().zip(decoded(&entry, &body, values.len())) {
                    // Half a step, and the rounding of a number of this size.
                    let most = 0.5001 * step + 1e-15 * was.abs();
                    assert!(
                        was.is_nan() && is.is_nan() || (was - is).abs() <= most,
                        "{name}: {was} became {is}, step {step}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_poses_are_made_of_is_fine_whatever_its_range() {
        let values = [0.0, 5000.0];
        let mut body = Vec::new();
        let entry = column("base.position.x", &values, FINE, &mut body);
        assert!(entry["step"].as_f64().expect("a number") <= FINE);
    }

    #[test]
    fn nothing_at_all_is_a_column_of_gaps() {
        let mut body = Vec::new();
        let entry = column("x", &[f64::NAN; 3], FINE, &mut body);
        assert_eq!(entry["gaps"], json!([[0, 3]]));
        assert!(body.is_empty());
    }
}
