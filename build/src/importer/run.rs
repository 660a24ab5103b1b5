//! From start to stop: sets inputs, takes steps, records outputs.

use super::binary;
use super::csv::Table;
use super::description::Description;
use super::error::{RunError, stopped};
use super::exchange::{self, Exchange, Inputs};
use super::experiment::{Experiment, Times, description, signals, starts, unusual_gravity};
use super::library::{LibraryError, Slave, Stepped, uri};
use super::select::selection;
use super::signals::Signals;
use super::variable::{Kind, Variable};
use std::collections::BTreeMap;
use std::path::{MAIN_SEPARATOR, Path};
use std::time::{Duration, Instant};
use urdf2fmu_core::clock;
use urdf2fmu_core::settings::FmiVersion;

/// Relative tolerance of Model Exchange where neither the FMU nor a person names one.
const TOLERANCE: f64 = 1e-4;

/// What came out of a simulation.
#[derive(Debug)]
pub struct Outcome {
    /// Every output and input at every step, `time` first.
    pub table: Table,
    /// FMI's names of the columns' units; empty where there is none.
    pub units: Vec<String>,
    /// Which columns change in jumps only.
    pub discrete: Vec<bool>,
    /// Columns that are written, in their order.
    pub written: Vec<usize>,
    /// What was to be simulated.
    pub times: Times,
    /// Relative tolerance, if the FMU was told one.
    pub tolerance: Option<f64>,
    /// How long each step took; one less than there are rows.
    pub took: Vec<Duration>,
    /// What the FMU said: status and text.
    pub messages: Vec<(i32, String)>,
    /// Parameters and inputs that were given values at the start.
    pub started: BTreeMap<String, f64>,
    /// Whether inputs had slopes.
    pub slopes: bool,
    /// Why it ended early, if it did.
    pub failure: Option<RunError>,
}

/// Simulates the FMU that was unpacked in `folder`.
///
/// - `watch`: is told the time, s, after each step; it ends the simulation by answering `false`
///
/// # Errors
/// [`RunError`] for whatever comes before the first step; what comes later is in the outcome,
/// beside the results.
pub fn simulate(
    folder: &Path,
    experiment: &Experiment,
    watch: &mut dyn FnMut(f64, &Times) -> bool,
) -> Result<Outcome, RunError> {
    let description = description(folder)?;
    let times = Times::new(&description, experiment)?;
    let signals = match &experiment.inputs {
        Some(path) => Some(signals(&description, path, times.allowed())?),
        None => None,
    };
    let misses = signals
        .as_ref()
        .and_then(|s| s.misses(times.start, times.stop));
    let starts = starts(&description, &experiment.start_values)?;
    let told = misses
        .into_iter()
        .chain(unusual_gravity(&description, &starts));
    let told: Vec<_> = told.map(|text| (1, text)).collect();
    let named = starts.iter().map(|(v, value)| (v.name.clone(), *value));
    let started = named.collect();
    // Local variables are written only where they are asked for.
    let seen = ["output", "input", "local"];
    let recorded = Recorded::new(&description, |v| seen.contains(&v.causality.as_str()));
    let written = selection(&description, &recorded.names, &experiment.written)?;
    let tolerance = experiment.tolerance.or(description.tolerance);
    let mut run = Run::new(
        folder,
        &description,
        signals,
        recorded,
        tolerance,
        experiment.debug_logging,
    )?;
    run.slopes = experiment.slopes && description.can_interpolate_inputs;
    run.slave.setup(tolerance, times.start, Some(times.stop))?;
    for (variable, value) in starts {
        run.set(variable, value)?;
    }
    run.slave.enter_initialization()?;
    run.apply(times.start)?;
    run.begin(times.start, times.stop)?;
    run.sample(times.start)?;
    let stepped = run.steps(&times, description.variable_step, watch);
    // A failure at the end leaves the results, too.
    let failure = match stepped {
        Err(error @ (RunError::Over { .. } | RunError::Ended { .. })) => {
            Some(run.slave.terminate().err().map_or(error, RunError::from))
        }
        other => other.and_then(|()| Ok(run.slave.terminate()?)).err(),
    };
    let messages = run.slave.messages().into_iter().map(|m| (m.status, m.text));
    Ok(Outcome {
        messages: told.into_iter().chain(messages).collect(),
        units: of_each(&description, &run.table.names, |v| v.unit.clone()),
        discrete: of_each(&description, &run.table.names, |v| {
            v.kind != Kind::Real || v.variability == "discrete"
        }),
        slopes: run.slopes,
        table: run.table,
        started,
        written,
        times,
        tolerance,
        took: run.took,
        failure,
    })
}

/// Something of each variable by its name, and a default for `time`.
fn of_each<T: Default>(
    description: &Description,
    names: &[String],
    what: impl Fn(&Variable) -> T,
) -> Vec<T> {
    let of = |name: &String| description.find(name).map(&what).unwrap_or_default();
    names.iter().map(of).collect()
}

/// What is recorded, by type.
pub(super) struct Recorded {
    names: Vec<String>,
    real: Vec<u32>,
    integer: Vec<u32>,
    boolean: Vec<u32>,
}

impl Recorded {
    pub(super) fn new(description: &Description, wanted: impl Fn(&Variable) -> bool) -> Self {
        let mut names = vec!["time".to_owned()];
        let mut of = |kind: Kind| -> Vec<u32> {
            let variables = description.variables.iter();
            let variables = variables.filter(|v| v.kind == kind && wanted(v));
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
    /// What integrates a Model Exchange FMU.
    exchange: Option<Exchange>,
    /// Model Exchange: inputs that others than the table have set, by value references.
    held: BTreeMap<u32, f64>,
    slopes: bool,
    recorded: Recorded,
    signals: Option<Signals>,
    table: Table,
    took: Vec<Duration>,
}

impl Run {
    pub(super) fn new(
        folder: &Path,
        description: &Description,
        signals: Option<Signals>,
        recorded: Recorded,
        tolerance: Option<f64>,
        debug_logging: bool,
    ) -> Result<Self, RunError> {
        let library = binary::library(folder, description)?;
        let (resources, guid) = (folder.join("resources"), &description.guid);
        let interface = description.interface;
        let slave = match description.fmi {
            FmiVersion::V2 => {
                let uri = uri(&resources);
                Slave::of_fmi_2(&library, guid, &uri, interface, debug_logging)
            }
            FmiVersion::V3 => {
                let path = format!("{}{MAIN_SEPARATOR}", resources.display());
                let elements = description.elements.clone();
                Slave::of_fmi_3(&library, guid, &path, elements, interface, debug_logging)
            }
        };
        let tolerance = tolerance.unwrap_or(TOLERANCE);
        Ok(Self {
            slave: slave?,
            exchange: exchange::of(interface, &description.states, tolerance),
            held: BTreeMap::new(),
            slopes: false,
            signals,
            table: Table {
                names: recorded.names.clone(),
                rows: Vec::new(),
            },
            took: Vec::new(),
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

    /// Ends the initialisation at `time`, s, of a simulation until `stop`.
    pub(super) fn begin(&mut self, time: f64, stop: f64) -> Result<(), RunError> {
        self.slave.exit_initialization()?;
        self.held.clear();
        let Some(exchange) = &mut self.exchange else {
            return Ok(());
        };
        let begun = exchange.begin(&mut self.slave, time);
        begun.map_err(|error| error.at(time, stop))
    }

    /// Takes inputs from the table at a communication point; in Model Exchange that is an event
    /// where something jumps, and elsewhere they follow by themselves.
    pub(super) fn follow_table(&mut self, time: f64, stop: f64) -> Result<(), RunError> {
        if self.exchange.is_none() {
            let applied = self.apply(time);
            return applied.map_err(|error| stopped(time, stop, &error));
        }
        let jumps = |signals: &Signals| signals.jumps_at(time);
        if self.signals.as_ref().is_some_and(jumps) {
            self.event(time, stop)
        } else {
            Ok(())
        }
    }

    /// Sets inputs that are numbers at a communication point; in Model Exchange a change of one is
    /// an event, and those that are not named any longer are the table's again.
    pub(super) fn hold(
        &mut self,
        inputs: &[(u32, f64)],
        time: f64,
        stop: f64,
    ) -> Result<(), RunError> {
        if self.exchange.is_none() {
            let (references, values): (Vec<u32>, Vec<f64>) = inputs.iter().copied().unzip();
            return Ok(self.slave.set_real(&references, &values)?);
        }
        let held: BTreeMap<u32, f64> = inputs.iter().copied().collect();
        if held == self.held {
            return Ok(());
        }
        self.held = held;
        self.event(time, stop)
    }

    /// An event of Model Exchange, in which all inputs may jump.
    fn event(&mut self, time: f64, stop: f64) -> Result<(), RunError> {
        let failed = |error: LibraryError| stopped(time, stop, &error);
        self.slave.enter_event_mode().map_err(failed)?;
        let applied = self.apply(time);
        applied.map_err(|error| stopped(time, stop, &error))?;
        let held = self
            .held
            .iter()
            .map(|(reference, value)| (*reference, *value));
        let (references, values): (Vec<u32>, Vec<f64>) = held.unzip();
        self.slave.set_real(&references, &values).map_err(failed)?;
        let Some(exchange) = &mut self.exchange else {
            return Ok(());
        };
        let settled = exchange.settle(&mut self.slave, time);
        settled.map_err(|error| error.at(time, stop))
    }

    /// Simulates from `time` to `end`, s; the whole simulation ends at `stop`.
    pub(super) fn step(&mut self, time: f64, end: f64, stop: f64) -> Result<(), RunError> {
        if let Some(exchange) = &mut self.exchange {
            let next = self.signals.as_ref();
            let next = next.map_or(f64::INFINITY, |signals| signals.next_event(time));
            let inputs = Inputs {
                signals: self.signals.as_ref(),
                held: &self.held,
                next,
            };
            let advanced = exchange.advance(&mut self.slave, inputs, end);
            return advanced.map_err(|(reached, error)| error.at(reached, stop));
        }
        let mut now = time;
        loop {
            let stepped = self.slave.do_step(now, end - now);
            match stepped.map_err(|error| stopped(now, stop, &error))? {
                Stepped::Done => return Ok(()),
                Stepped::Early(reached) if reached >= end => return Ok(()),
                Stepped::Early(reached) if reached > now => now = reached,
                Stepped::Early(reached) => {
                    let why = "the FMU returned from the step without having begun it";
                    return Err(stopped(reached, stop, &why));
                }
                Stepped::Over(time) => return Err(RunError::Over { time, stop }),
                Stepped::Discarded(reached) => {
                    let said = self.slave.messages().pop();
                    let why = said.map_or("the FMU discarded the step".to_owned(), |m| m.text);
                    return Err(stopped(reached, stop, &why));
                }
            }
        }
    }

    /// Sets all inputs to what they are at `time`.
    pub(super) fn apply(&mut self, time: f64) -> Result<(), RunError> {
        let Some(signals) = self.signals.take() else {
            return Ok(());
        };
        let done = self.set_all(&signals, time).map_err(|error| {
            let what = error.to_string();
            match signals.place_of(&what, time) {
                Some(place) => RunError::Name { place, what },
                None => error.into(),
            }
        });
        self.signals = Some(signals);
        done
    }

    fn set_all(&mut self, signals: &Signals, time: f64) -> Result<(), LibraryError> {
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
        Ok(())
    }

    /// Records a row.
    fn sample(&mut self, time: f64) -> Result<(), LibraryError> {
        let row = self.row(time)?;
        self.table.rows.push(row);
        Ok(())
    }

    /// `time` and all that is recorded.
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
    fn steps(
        &mut self,
        times: &Times,
        variable_step: bool,
        watch: &mut dyn FnMut(f64, &Times) -> bool,
    ) -> Result<(), RunError> {
        let Times {
            start,
            stop,
            interval,
        } = *times;
        let is_same = |a, b| clock::is_same(a, b, times.allowed());
        let (mut time, mut count) = (start, 0_u32);
        while time < stop && !is_same(time, stop) {
            let regular = start + f64::from(count + 1) * interval;
            let mut next = regular;
            let event = self
                .signals
                .as_ref()
                .map_or(f64::INFINITY, |signals| signals.next_event(time));
            if variable_step && next > event && !is_same(next, event) {
                next = event;
            }
            if next > stop && !is_same(next, stop) {
                if !variable_step {
                    break;
                }
                next = stop;
            }
            self.follow_table(time, stop)?;
            let begun = Instant::now();
            let stepped = self.step(time, next, stop);
            let took = begun.elapsed();
            let reached = match &stepped {
                Ok(()) => next,
                // Its last values count, too.
                Err(RunError::Over { time, .. }) => *time,
                Err(_) => return stepped,
            };
            if reached > time {
                time = reached;
                self.sample(time)?;
                self.took.push(took);
            }
            stepped?;
            if is_same(time, regular) {
                count += 1;
            }
            if !watch(time, times) {
                return Err(RunError::Ended { time, stop });
            }
        }
        Ok(())
    }
}
