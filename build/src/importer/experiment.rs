//! What to simulate: times, start values and inputs, checked against the FMU's description.

use super::csv::Table;
use super::description::Description;
use super::error::{RunError, START_VALUE};
use super::signals::{Signal, Signals};
use super::tabular::{decoded, name_and_unit, same_unit};
use super::variable::{Kind, Variable};
use std::path::{Path, PathBuf};
use urdf2fmu_core::digits::Digits;
use urdf2fmu_core::pattern::Pattern;

/// Longest table of results, in rows: a longer one is probably a typing error in an interval.
const MOST_ROWS: f64 = 1e8;

/// What to simulate; missing values are those of modelDescription.xml.
#[derive(Clone, Debug, Default)]
pub struct Experiment {
    /// s
    pub start_time: Option<f64>,
    /// s
    pub stop_time: Option<f64>,
    /// s
    pub output_interval: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Names or globs of parameters and inputs, and their values.
    pub start_values: Vec<(String, String)>,
    /// Inputs over time.
    pub inputs: Option<PathBuf>,
    /// Names and globs of what is written; none for all outputs.
    pub written: Vec<String>,
    /// Whether the FMU is told the inputs' slopes.
    pub slopes: bool,
    /// Whether the FMU is asked to say more.
    pub debug_logging: bool,
}

/// When a simulation begins and ends, and what lies between two rows.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// s
    pub start: f64,
    /// s
    pub stop: f64,
    /// s
    pub interval: f64,
}

impl Times {
    pub(super) fn new(
        description: &Description,
        experiment: &Experiment,
    ) -> Result<Self, RunError> {
        let start = experiment.start_time.or(description.start_time);
        let start = start.unwrap_or(0.0);
        let stop = experiment.stop_time.or(description.stop_time);
        let stop = stop.unwrap_or(start + 1.0);
        let interval = experiment.output_interval.or(description.step_size);
        let interval = interval.unwrap_or((stop - start) / 500.0);
        if !(start.is_finite() && stop.is_finite() && stop > start) {
            return Err(RunError::Times(format!(
                "the stop time must be after the start time, not {} s after {} s",
                Digits(stop),
                Digits(start)
            )));
        }
        if !(interval.is_finite() && interval > 0.0 && (stop - start) / interval <= MOST_ROWS) {
            return Err(RunError::Times(format!(
                "the output interval must be above 0 s and not too short for {} s, not {} s",
                Digits(stop - start),
                Digits(interval)
            )));
        }
        Ok(Self {
            start,
            stop,
            interval,
        })
    }
}

pub(super) fn read(path: &Path) -> Result<String, RunError> {
    let failed = |source| RunError::Read {
        path: path.to_owned(),
        source,
    };
    let bytes = std::fs::read(path).map_err(failed)?;
    Ok(decoded(bytes))
}

/// The file of inputs, its columns matched with variables.
pub(super) fn signals(description: &Description, path: &Path) -> Result<Signals, RunError> {
    let (table, line) = Table::parse(&read(path)?).map_err(|source| RunError::Csv {
        path: path.to_owned(),
        source,
    })?;
    let mut list = Vec::new();
    for (column, name) in table.names.iter().enumerate().skip(1) {
        let place = || format!("'{}', line {line}, column {}", path.display(), column + 1);
        let settable = |v: &Variable| v.is_input() || v.variability == "tunable";
        let failed = |what| RunError::Name {
            place: place(),
            what,
        };
        // A unit behind a name must be that of the variable: values are never converted.
        let (stem, unit) = match description.find(name) {
            Some(_) => (name.as_str(), None),
            None => name_and_unit(name),
        };
        let variable = find(
            description,
            stem,
            settable,
            "an input or a tunable parameter",
        )
        .map_err(failed)?;
        if let Some(unit) = unit.filter(|unit| !same_unit(unit, &variable.unit)) {
            return Err(failed(format!(
                "the values of '{stem}' must be in {}, not in {unit}",
                match variable.unit.as_str() {
                    "" => "no unit",
                    unit => unit,
                }
            )));
        }
        let mut others = list
            .iter()
            .map(|signal: &Signal| signal.variable.name.as_str());
        if others.any(|other| other == variable.name) {
            return Err(failed(format!("'{stem}' has a column of its own before")));
        }
        list.push(Signal {
            variable: variable.clone(),
            column,
        });
    }
    Ok(Signals::new(table, list))
}

/// `--start-value`: what a name or glob means, with its value.
pub(super) fn starts<'d>(
    description: &'d Description,
    values: &[(String, String)],
) -> Result<Vec<(&'d Variable, f64)>, RunError> {
    let mut starts = Vec::new();
    for (name, text) in values {
        let failed = |what| RunError::Name {
            place: START_VALUE.to_owned(),
            what,
        };
        for variable in meant(description, name).map_err(failed)? {
            let bad = |expected| RunError::Value {
                name: variable.name.clone(),
                text: text.clone(),
                expected,
            };
            let value = match (variable.kind, text.trim()) {
                (Kind::Boolean, "true" | "True" | "1") => 1.0,
                (Kind::Boolean, "false" | "False" | "0") => 0.0,
                (Kind::Boolean, _) => return Err(bad("true or false")),
                (Kind::Integer, text) => {
                    f64::from(text.parse::<i32>().map_err(|_| bad("whole number"))?)
                }
                (_, text) => text
                    .parse()
                    .ok()
                    .filter(|x: &f64| x.is_finite())
                    .ok_or_else(|| bad("finite number"))?,
            };
            starts.push((variable, value));
        }
    }
    Ok(starts)
}

/// Parameters and inputs that a name or glob means; the error tells the nearest name.
fn meant<'d>(description: &'d Description, name: &str) -> Result<Vec<&'d Variable>, String> {
    let pattern = Pattern::from(name);
    if !pattern.is_glob() || description.find(name).is_some() {
        let what = "a parameter or an input";
        return Ok(vec![find(description, name, Variable::can_start, what)?]);
    }
    let fit = |v: &&Variable| v.can_start() && v.kind != Kind::Text && pattern.matches(&v.name);
    let found: Vec<&Variable> = description.variables.iter().filter(fit).collect();
    if found.is_empty() {
        return Err(format!(
            "no parameter or input matches '{name}'; urdf2fmu info --variables lists all"
        ));
    }
    Ok(found)
}

/// The variable called `name`, if it is `fit`; otherwise the error, with the nearest suitable name.
fn find<'d>(
    description: &'d Description,
    name: &str,
    fit: impl Fn(&Variable) -> bool,
    expected: &str,
) -> Result<&'d Variable, String> {
    match description.find(name) {
        Some(variable) if fit(variable) && variable.kind != Kind::Text => Ok(variable),
        Some(variable) => Err(format!(
            "'{name}' is not {expected}, but {} {}",
            if variable.causality == "output" || variable.causality == "input" {
                "an"
            } else {
                "a"
            },
            variable.causality
        )),
        None => {
            let names = || description.variables.iter().filter(|v| fit(v));
            let distance = |name: &str, v: &Variable| strsim::damerau_levenshtein(&v.name, name);
            let nearest = names().min_by_key(|v| (distance(name, v), v.name.clone()));
            let near = nearest.filter(|v| distance(name, v) <= (name.len() / 3).clamp(1, 8));
            // A part of a name, such as that of a joint.
            let part = |v: &&Variable| name.len() > 2 && v.name.contains(name);
            let hint = match near.or_else(|| names().find(part)) {
                Some(meant) => format!("; did you mean '{}'?", meant.name),
                None => "; urdf2fmu info --variables lists all".to_owned(),
            };
            Err(format!("there is no variable '{name}'{hint}"))
        }
    }
}
