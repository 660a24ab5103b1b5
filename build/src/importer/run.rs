//! From start to stop: sets inputs, takes steps, records outputs.

use super::csv::Table;
use super::description::{Description, Kind, Variable};
use super::error::{RunError, START_VALUE};
use super::library::{LibraryError, Slave, Stepped};
use super::signals::{Signal, Signals, is_close};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

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
    /// Names and values of parameters and inputs.
    pub start_values: Vec<(String, String)>,
    /// Inputs over time.
    pub inputs: Option<PathBuf>,
    /// Whether the FMU is told the inputs' slopes.
    pub slopes: bool,
    /// Whether the FMU is asked to say more.
    pub debug_logging: bool,
}

/// What came out of a simulation.
#[derive(Debug)]
pub struct Outcome {
    /// Every output at every step, `time` first.
    pub table: Table,
    /// What the FMU said: status and text.
    pub messages: Vec<(i32, String)>,
    /// Why it ended early, if it did.
    pub failure: Option<RunError>,
}

/// Simulates the FMU that was unpacked in `folder`.
///
/// # Errors
/// [`RunError`] for whatever comes before the first step; what comes later is in the outcome,
/// beside the results.
pub fn simulate(folder: &Path, experiment: &Experiment) -> Result<Outcome, RunError> {
    let text = read(&folder.join("modelDescription.xml"))?;
    let description = Description::parse(&text)?;
    let times = Times::new(&description, experiment)?;
    let signals = match &experiment.inputs {
        Some(path) => Some(signals(&description, path)?),
        None => None,
    };
    let starts = starts(&description, &experiment.start_values)?;
    let mut run = Run::new(folder, &description, signals, experiment.debug_logging)?;
    run.slopes = experiment.slopes && description.can_interpolate_inputs;
    let tolerance = experiment.tolerance.or(description.tolerance);
    run.slave.setup(tolerance, times.start, Some(times.stop))?;
    for (variable, value) in starts {
        run.set(variable, value)?;
    }
    run.slave.enter_initialization()?;
    run.apply(times.start)?;
    run.slave.exit_initialization()?;
    run.sample(times.start)?;
    let stepped = run.steps(&times, description.variable_step);
    // A failure at the end leaves the results, too.
    let failure = stepped.and_then(|()| Ok(run.slave.terminate()?)).err();
    let messages = run.slave.messages().into_iter();
    Ok(Outcome {
        messages: messages.map(|m| (m.status, m.text)).collect(),
        table: run.table,
        failure,
    })
}

/// Start, stop and interval.
struct Times {
    start: f64,
    stop: f64,
    interval: f64,
}

impl Times {
    fn new(description: &Description, experiment: &Experiment) -> Result<Self, RunError> {
        let start = experiment.start_time.or(description.start_time);
        let start = start.unwrap_or(0.0);
        let stop = experiment.stop_time.or(description.stop_time);
        let stop = stop.unwrap_or(start + 1.0);
        let interval = experiment.output_interval.or(description.step_size);
        let interval = interval.unwrap_or((stop - start) / 500.0);
        if !(start.is_finite() && stop.is_finite() && stop > start) {
            return Err(RunError::Times(format!(
                "the stop time must be after the start time, not {stop} s after {start} s"
            )));
        }
        if !(interval.is_finite() && interval > 0.0 && (stop - start) / interval <= MOST_ROWS) {
            return Err(RunError::Times(format!(
                "the output interval must be above 0 s and not too short for {} s, not {interval} s",
                stop - start
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
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The file of inputs, its columns matched with variables.
pub(super) fn signals(description: &Description, path: &Path) -> Result<Signals, RunError> {
    let table = Table::parse(&read(path)?).map_err(|source| RunError::Csv {
        path: path.to_owned(),
        source,
    })?;
    let mut list = Vec::new();
    for (column, name) in table.names.iter().enumerate().skip(1) {
        let place = || format!("'{}', line 1, column {}", path.display(), column + 1);
        let settable = |v: &Variable| v.is_input() || v.variability == "tunable";
        let variable = find(
            description,
            name,
            settable,
            "an input or a tunable parameter",
        )
        .map_err(|what| RunError::Name {
            place: place(),
            what,
        })?;
        list.push(Signal {
            variable: variable.clone(),
            column,
        });
    }
    Ok(Signals::new(table, list))
}

/// `--start-value`
fn starts<'d>(
    description: &'d Description,
    values: &[(String, String)],
) -> Result<Vec<(&'d Variable, f64)>, RunError> {
    let mut starts = Vec::new();
    for (name, text) in values {
        let variable = find(
            description,
            name,
            Variable::can_start,
            "a parameter or an input",
        )
        .map_err(|what| RunError::Name {
            place: START_VALUE.to_owned(),
            what,
        })?;
        let bad = |expected| RunError::Value {
            name: name.clone(),
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
    Ok(starts)
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
            let names = description.variables.iter().filter(|v| fit(v));
            let nearest = names
                .map(|v| (strsim::damerau_levenshtein(&v.name, name), &v.name))
                .min();
            let hint = match nearest {
                Some((distance, nearest)) if distance <= 3 + name.len() / 3 => {
                    format!("; did you mean '{nearest}'?")
                }
                _ => "; urdf2fmu info --variables lists all".to_owned(),
            };
            Err(format!("there is no variable '{name}'{hint}"))
        }
    }
}

/// This system's folder under `binaries/`.
const PLATFORM: &str = if cfg!(target_os = "windows") {
    if cfg!(target_pointer_width = "64") {
        "win64"
    } else {
        "win32"
    }
} else if cfg!(target_os = "macos") {
    "darwin64"
} else if cfg!(target_pointer_width = "64") {
    "linux64"
} else {
    "linux32"
};

fn library(folder: &Path, identifier: &str) -> Result<PathBuf, RunError> {
    let file = format!("{identifier}{}", std::env::consts::DLL_SUFFIX);
    let file = if cfg!(target_os = "macos") {
        format!("{identifier}.dylib")
    } else {
        file
    };
    let binaries = folder.join("binaries");
    let path = binaries.join(PLATFORM).join(&file);
    if path.is_file() {
        return Ok(path);
    }
    let mut found: Vec<String> = std::fs::read_dir(&binaries)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    found.sort();
    Err(RunError::Platform {
        platform: PLATFORM,
        file,
        found: if found.is_empty() {
            "none".to_owned()
        } else {
            found.join(", ")
        },
    })
}

/// A `file:` URI (RFC 3986, RFC 8089) of an absolute path.
fn uri(path: &Path) -> String {
    let path = path.to_string_lossy().replace('\\', "/");
    let mut uri = String::from(if path.starts_with('/') {
        "file://"
    } else {
        "file:///"
    });
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' | b':' => {
                uri.push(char::from(byte));
            }
            _ => _ = write!(uri, "%{byte:02X}"),
        }
    }
    uri
}

/// Outputs by type.
struct Recorded {
    names: Vec<String>,
    real: Vec<u32>,
    integer: Vec<u32>,
    boolean: Vec<u32>,
}

impl Recorded {
    fn new(description: &Description) -> Self {
        let mut names = vec!["time".to_owned()];
        let mut of = |kind: Kind| -> Vec<u32> {
            let variables = description.variables.iter();
            let variables = variables.filter(|v| v.kind == kind && v.causality == "output");
            variables
                .map(|v| {
                    names.push(v.name.clone());
                    v.value_reference
                })
                .collect()
        };
        let (real, integer, boolean) = (of(Kind::Real), of(Kind::Integer), of(Kind::Boolean));
        Self {
            names,
            real,
            integer,
            boolean,
        }
    }
}

/// An instance with its inputs and what is recorded of it.
pub(super) struct Run {
    pub(super) slave: Slave,
    slopes: bool,
    recorded: Recorded,
    signals: Option<Signals>,
    table: Table,
}

impl Run {
    pub(super) fn new(
        folder: &Path,
        description: &Description,
        signals: Option<Signals>,
        debug_logging: bool,
    ) -> Result<Self, RunError> {
        let library = library(folder, &description.model_identifier)?;
        let resources = uri(&folder.join("resources"));
        let recorded = Recorded::new(description);
        Ok(Self {
            slave: Slave::new(&library, &description.guid, &resources, debug_logging)?,
            slopes: false,
            signals,
            table: Table {
                names: recorded.names.clone(),
                rows: Vec::new(),
            },
            recorded,
        })
    }

    /// Names of what is recorded, `time` first.
    pub(super) fn names(&self) -> &[String] {
        &self.recorded.names
    }

    /// Whether the table of inputs has a column for a variable.
    pub(super) fn has_signal(&self, name: &str) -> bool {
        let mut signals = self.signals.iter().flat_map(|signals| &signals.list);
        signals.any(|signal| signal.variable.name == name)
    }

    fn set(&mut self, variable: &Variable, value: f64) -> Result<(), LibraryError> {
        let reference = variable.value_reference;
        match variable.kind {
            Kind::Real => self.slave.set_real(&[reference], &[value]),
            #[expect(clippy::cast_possible_truncation, reason = "saturates")]
            Kind::Integer => self.slave.set_integer(reference, value as i32),
            Kind::Boolean => self.slave.set_boolean(reference, value != 0.0),
            Kind::Text => Ok(()),
        }
    }

    /// Sets all inputs to what they are at `time`.
    pub(super) fn apply(&mut self, time: f64) -> Result<(), LibraryError> {
        let Some(signals) = self.signals.take() else {
            return Ok(());
        };
        let (mut references, mut values, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
        for signal in &signals.list {
            let value = signals.value(signal, time);
            if signal.variable.kind == Kind::Real {
                references.push(signal.variable.value_reference);
                values.push(value);
                slopes.push(signals.slope(signal, time));
            } else {
                self.set(&signal.variable, value)?;
            }
        }
        self.slave.set_real(&references, &values)?;
        if self.slopes {
            let inputs = signals
                .list
                .iter()
                .filter(|s| s.variable.kind == Kind::Real);
            let (references, slopes): (Vec<u32>, Vec<f64>) = inputs
                .zip(references.iter().zip(&slopes))
                .filter(|(signal, _)| signal.is_continuous())
                .map(|(_, (reference, slope))| (*reference, *slope))
                .unzip();
            self.slave.set_slopes(&references, &slopes)?;
        }
        self.signals = Some(signals);
        Ok(())
    }

    /// Records all outputs.
    fn sample(&mut self, time: f64) -> Result<(), LibraryError> {
        let row = self.row(time)?;
        self.table.rows.push(row);
        Ok(())
    }

    /// `time` and all outputs.
    pub(super) fn row(&mut self, time: f64) -> Result<Vec<f64>, LibraryError> {
        let Recorded {
            real,
            integer,
            boolean,
            names,
        } = &self.recorded;
        let mut row = vec![0.0; names.len()];
        row[0] = time;
        self.slave.get_real(real, &mut row[1..=real.len()])?;
        let mut whole = vec![0; integer.len().max(boolean.len())];
        self.slave
            .get_integer(integer, &mut whole[..integer.len()])?;
        let rest = &mut row[1 + real.len()..];
        for (place, value) in rest.iter_mut().zip(&whole[..integer.len()]) {
            *place = f64::from(*value);
        }
        self.slave
            .get_boolean(boolean, &mut whole[..boolean.len()])?;
        for (place, value) in rest[integer.len()..].iter_mut().zip(&whole) {
            *place = f64::from(u8::from(*value != 0));
        }
        Ok(row)
    }

    /// All steps. Steps end at multiples of the interval, at the stop time and where an input
    /// jumps.
    fn steps(&mut self, times: &Times, variable_step: bool) -> Result<(), RunError> {
        let Times {
            start,
            stop,
            interval,
        } = *times;
        let (mut time, mut count) = (start, 0_u32);
        while time < stop && !is_close(time, stop) {
            let regular = start + f64::from(count + 1) * interval;
            let mut next = regular;
            let event = self
                .signals
                .as_ref()
                .map_or(f64::INFINITY, |signals| signals.next_event(time));
            if variable_step && next > event && !is_close(next, event) {
                next = event;
            }
            if next > stop && !is_close(next, stop) {
                if !variable_step {
                    break;
                }
                next = stop;
            }
            let stopped = |time: f64, why: String| RunError::Stopped { time, stop, why };
            self.apply(time)
                .map_err(|error| stopped(time, error.to_string()))?;
            let stepped = self.slave.do_step(time, next - time);
            match stepped.map_err(|error| stopped(time, error.to_string()))? {
                Stepped::Done => time = next,
                Stepped::Discarded(reached) => {
                    let messages = self.slave.messages();
                    let last = messages.last().map(|m| m.text.clone());
                    return Err(stopped(reached, last.unwrap_or("fmi2Discard".to_owned())));
                }
            }
            self.sample(time)?;
            if is_close(time, regular) {
                count += 1;
            }
        }
        Ok(())
    }
}
