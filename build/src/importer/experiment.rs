//! What to simulate: times, start values and inputs, checked against the FMU's description.

use super::csv::Table;
use super::description::Description;
use super::error::{RunError, START_VALUE};
use super::signals::{Signal, Signals};
use super::tabular::{LARGEST, decoded, name_and_unit, wrong_unit};
use super::variable::{Kind, Variable};
use std::path::{Path, PathBuf};
use urdf2fmu_core::clock;
use urdf2fmu_core::diagnostic::angles;
use urdf2fmu_core::diagnostic::gravity::{self, Unusual};
use urdf2fmu_core::digits::Digits;
use urdf2fmu_core::pattern::Pattern;
use urdf2fmu_core::range::number_or_ratio;
use urdf2fmu_core::reading;

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

/// How far apart, as a part of the interval and beside their round-off, two times may lie that are
/// taken for the same: tables of inputs have times of nine digits. `FMPy` takes 1e-9 of the time,
/// which is as much for the first seconds at usual intervals, and a second at a Unix time.
pub(super) const SAME: f64 = 1e-6;

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
        // Who gave what is wrong: the user, or the FMU.
        let wrong = |own: bool, text: String| {
            if own {
                RunError::Times(text)
            } else {
                RunError::Default(text)
            }
        };
        let later = stop > start && !clock::is_same(start, stop, 0.0);
        if !(start.is_finite() && stop.is_finite() && later) {
            let own = experiment.start_time.is_some() || experiment.stop_time.is_some();
            return Err(wrong(
                own,
                format!(
                    "the stop time must be after the start time, not {} s after {} s",
                    Digits(stop),
                    Digits(start)
                ),
            ));
        }
        // An interval that is one is wrong for the times alone.
        let times = experiment.start_time.is_some() || experiment.stop_time.is_some();
        let one = interval.is_finite() && interval > 0.0;
        let own = experiment.output_interval.is_some() || times && one;
        if !(interval.is_finite() && interval > 0.0 && (stop - start) / interval <= MOST_ROWS) {
            return Err(wrong(
                own,
                format!(
                    "the output interval must be above 0 s, and at least {} s for {} s, not {} s",
                    Digits((stop - start) / MOST_ROWS),
                    Digits(stop - start),
                    Digits(interval)
                ),
            ));
        }
        // Each row has a time of its own.
        let least = 2.0 * clock::round_off(start.abs().max(stop.abs()));
        if interval < least {
            return Err(wrong(
                own,
                format!(
                    "the output interval must be at least {} s for times near {} s, which are not \
                     told apart on a finer scale, not {} s",
                    Digits(least),
                    Digits(stop),
                    Digits(interval)
                ),
            ));
        }
        Ok(Self {
            start,
            stop,
            interval,
        })
    }

    /// How far apart, s, two times may lie that are taken for the same.
    pub(super) fn allowed(&self) -> f64 {
        SAME * self.interval.min(self.stop - self.start)
    }
}

fn read(path: &Path) -> Result<Vec<u8>, RunError> {
    reading::read(path, LARGEST).map_err(|source| RunError::Read {
        path: path.to_owned(),
        source,
    })
}

/// What the modelDescription.xml of the FMU that was unpacked in `folder` says.
pub(super) fn description(folder: &Path) -> Result<Description, RunError> {
    let bytes = read(&folder.join("modelDescription.xml"))?;
    Ok(Description::from_bytes(bytes)?)
}

/// The file of inputs, its columns matched with variables. Arrays stand there by their own names or
/// by those of their elements.
///
/// - `allowed`: how far apart, s, two times may lie that are taken for the same
pub(super) fn signals(
    description: &Description,
    path: &Path,
    allowed: f64,
) -> Result<Signals, RunError> {
    let elements = |name: &str| Some(description.arrays.get(name)?.as_slice());
    let parsed = Table::parse(&decoded(read(path)?), elements);
    let (table, places) = parsed.map_err(|source| RunError::Csv {
        path: path.to_owned(),
        source,
    })?;
    let mut list = Vec::new();
    for (column, name) in table.names.iter().enumerate().skip(1) {
        let place = || {
            let (line, column) = (places.line, places.columns[column]);
            format!("'{}', line {line}, column {column}", path.display())
        };
        let settable = |v: &Variable| v.is_input() || v.variability == "tunable";
        let failed = |what| RunError::Name {
            place: place(),
            what,
        };
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
        if let Some(what) = unit.and_then(|unit| wrong_unit(stem, unit, &variable.unit)) {
            return Err(failed(what));
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
    Ok(Signals::new(table, list, allowed).of_file(path, places))
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
                // As the settings and the options for times take it.
                (_, text) => number_or_ratio(text)
                    .filter(|x| x.is_finite())
                    .ok_or_else(|| {
                        let comma = "finite number, in which the decimal sign is a point";
                        bad(if text.contains(',') {
                            comma
                        } else {
                            "finite number"
                        })
                    })?,
            };
            if variable.is_attitude() && angles::attitude(&variable.name, &[value]).is_some() {
                return Err(bad("attitude in radians; 90 degrees are 1.5708"));
            }
            starts.push((variable, value));
        }
    }
    Ok(starts)
}

/// What to tell of start values: gravity that is nearly always meant otherwise, as the settings
/// tell it (A143).
pub(super) fn unusual_gravity(
    description: &Description,
    starts: &[(&Variable, f64)],
) -> Option<String> {
    let plain = |v: &Variable| v.name.replace('_', ".");
    let of = |letter: &str| {
        let name = format!("world.gravity.{letter}");
        let mut own = starts.iter().filter(|(v, _)| plain(v) == name);
        own.next_back().map(|(_, value)| *value)
    };
    let z = of("z")?;
    let [x, y] = ["x", "y"].map(|letter| of(letter).unwrap_or_default());
    // A contact with the ground has parameters.
    let mut variables = description.variables.iter();
    let ground = variables.any(|v| plain(v).starts_with("world.ground."));
    let unusual = gravity::unusual([x, y, z], ground)?;
    let (down, more) = match unusual {
        Unusual::Upwards => (z, ""),
        Unusual::AlongY => (y.abs(), "--start-value world.gravity.y 0 "),
        Unusual::Unit(_) => (9.81, ""),
    };
    let [x, y, z, down] = [x, y, z, down].map(Digits);
    Some(format!(
        "gravity {unusual}: it is [{x}, {y}, {z}] m/s², and z is up; what falls has \
         {more}--start-value world.gravity.z -{down}"
    ))
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

/// By what a variable is set, or starts, that is not `fit` itself.
fn set_by(
    description: &Description,
    variable: &Variable,
    fit: impl Fn(&Variable) -> bool,
) -> String {
    if variable.can_start() {
        return "; --start-value sets it".to_owned();
    }
    let initial = ['.', '_'].map(|sign| format!("initial{sign}{}", variable.name));
    let known = |name: &&String| description.find(name).is_some_and(&fit);
    let start = initial.iter().find(known);
    start.map_or_else(String::new, |name| format!("; it starts at '{name}'"))
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
            "'{name}' is not {expected}, but {} {}{}",
            if variable.causality == "output" || variable.causality == "input" {
                "an"
            } else {
                "a"
            },
            variable.causality,
            set_by(description, variable, fit)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn times(default: &str, start: f64, stop: f64, interval: f64) -> Result<Times, RunError> {
        let text = format!(
            "<fmiModelDescription fmiVersion='2.0' guid='1'><CoSimulation modelIdentifier='m'/>\
             <DefaultExperiment {default}/></fmiModelDescription>"
        );
        let given = |x: f64| (!x.is_nan()).then_some(x);
        let experiment = Experiment {
            start_time: given(start),
            stop_time: given(stop),
            output_interval: given(interval),
            ..Experiment::default()
        };
        Times::new(&Description::parse(&text).expect("legal"), &experiment)
    }

    #[test]
    fn gravity_of_another_sign_axis_or_unit_is_told_of_start_values() {
        let text = "<fmiModelDescription fmiVersion='2.0' guid='1'><CoSimulation \
                    modelIdentifier='m'/><ModelVariables>XYZ</ModelVariables></fmiModelDescription>";
        let variable = |letter: &str| {
            format!(
                "<ScalarVariable name='world.gravity.{letter}' valueReference='{}' \
                 causality='parameter' variability='tunable'><Real start='0'/></ScalarVariable>",
                letter.as_bytes()[0]
            )
        };
        let all: String = ["x", "y", "z"].map(variable).concat();
        let ground = "<ScalarVariable name='world.ground.friction' valueReference='9' \
                      causality='parameter' variability='tunable'><Real start='1'/></ScalarVariable>";
        let told = |ground: &str, given: &[(&str, &str)]| {
            let text = text.replace("XYZ", &(all.clone() + ground));
            let description = Description::parse(&text).expect("legal");
            let pair = |(letter, value): &(&str, &str)| {
                (format!("world.gravity.{letter}"), (*value).to_owned())
            };
            let given: Vec<(String, String)> = given.iter().map(pair).collect();
            let starts = starts(&description, &given).expect("legal");
            unusual_gravity(&description, &starts)
        };
        let aside = [("y", "-9.81"), ("z", "0")];
        for (given, what) in [
            (&[("z", "9.81")][..], "points upwards"),
            (&aside, "points along -y"),
            (&[("z", "-9810")], "is the earth's in mm/s²"),
            (&[("z", "-980.665")], "is the earth's in cm/s²"),
        ] {
            let message = told(ground, given).expect(what);
            assert!(
                message.starts_with(&format!("gravity {what}: it is [0")),
                "{message}"
            );
            assert!(message.ends_with("world.gravity.z -9.81"), "{message}");
        }
        let message = told(ground, &aside).expect("along -y");
        assert!(
            message.contains("--start-value world.gravity.y 0 "),
            "{message}"
        );
        // Seen from above, without a ground.
        assert_eq!(told("", &aside), None);
        assert_eq!(told(ground, &[("z", "-9.81")]), None);
        // Sideways, as on a slope.
        assert_eq!(told(ground, &[("z", "1"), ("x", "9.8")]), None);
    }

    /// As settings take it; the text is no number otherwise.
    #[test]
    fn start_values_are_ratios_too() {
        let text = "<fmiModelDescription fmiVersion='2.0' guid='1'><CoSimulation \
                    modelIdentifier='m'/><ModelVariables><ScalarVariable name='solver.step_size' \
                    valueReference='1' causality='parameter' variability='fixed'>\
                    <Real start='0'/></ScalarVariable></ModelVariables></fmiModelDescription>";
        let description = Description::parse(text).expect("legal");
        let given = |value: &str| {
            let pair = [("solver.step_size".to_owned(), value.to_owned())];
            let starts = starts(&description, &pair).ok()?;
            Some(starts[0].1)
        };
        assert_eq!(given("1/240"), Some(1.0 / 240.0));
        assert_eq!(given("0.25"), Some(0.25));
        assert_eq!(given("1/0"), None);
        assert_eq!(given("1/240 s"), None);
    }

    #[test]
    fn times_that_make_no_simulation_are_blamed_on_who_gave_them() {
        const NONE: f64 = f64::NAN;
        for default in [
            "stepSize='-0.1'",
            "stepSize='NaN'",
            "stopTime='NaN'",
            "startTime='3' stopTime='2'",
        ] {
            let refused = times(default, NONE, NONE, NONE).expect_err(default);
            assert!(!refused.is_usage(), "{refused}");
            let text = refused.to_string();
            assert!(text.starts_with("modelDescription.xml: "), "{text}");
        }
        assert!(times("stepSize='-0.1'", NONE, NONE, 0.1).is_ok());
        for (start, stop, interval) in [(0.0, 1.0, -0.1), (2.0, 1.0, 0.1), (0.0, 1.0, 1e-9)] {
            let refused = times("", start, stop, interval).expect_err("no simulation");
            assert!(refused.is_usage(), "{refused}");
        }
        // Doubles near 2e12 are 2.4e-4 apart, and rows of 0.004 s are too many.
        let refused = times("stepSize='0.004'", 1e12, 2e12, NONE).expect_err("no simulation");
        assert!(refused.is_usage(), "{refused}");
    }

    /// Doubles near 1e10 are 1.9e-6 apart.
    #[test]
    fn an_interval_that_times_do_not_tell_apart_is_refused() {
        assert!(times("", 1e10, 1e10 + 1e-3, 1e-6).is_err());
        assert!(times("", 1e10, 1e10 + 1e-6, 1.0).is_err());
        assert!(times("", 1e10, 1e10 + 1.0, 1e-3).is_ok());
        assert!(times("", 1.7e9, 1.7e9 + 1.0, 1e-4).is_ok());
    }
}
