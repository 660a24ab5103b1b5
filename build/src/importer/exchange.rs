//! Drives a Model Exchange FMU: integrates its derivatives from one communication point to the
//! next, and takes it through its events.
//!
//! Between events the inputs of a table follow it continuously. What is set at once, by a jump of
//! the table or by a person, is an event. State events are refused when the description is read,
//! but for those of this program's own FMUs: nothing that is integrated depends on when they are,
//! and the end of a step tells of them.

use super::error::{RunError, stopped};
use super::library::{Interface, LibraryError, Slave};
use super::rodas::{Equations, Rodas, Taken};
use super::signals::{Signal, Signals};
use std::collections::BTreeMap;

/// Most steps between two communication points.
const MOST_STEPS: usize = 100_000;

/// Times that an event is iterated, at most.
const MOST_UPDATES: usize = 100;

/// Why an integration does not go on.
#[derive(Debug, thiserror::Error)]
pub(super) enum ExchangeError {
    /// A function of the FMU.
    #[error(transparent)]
    Library(#[from] LibraryError),
    /// No step is short enough.
    #[error("no step of the integration is short enough; the fastest state is '{fastest}'{said}")]
    Stuck {
        /// Name of a state.
        fastest: String,
        /// What the FMU said.
        said: String,
    },
    /// Too much work.
    #[error(
        "the integration took {MOST_STEPS} steps without reaching the next communication point; the fastest \
         state is '{fastest}'; try a larger tolerance"
    )]
    Steps {
        /// Name of a state.
        fastest: String,
    },
    /// An event without end.
    #[error("the FMU asks for more than {MOST_UPDATES} updates at one event")]
    Updates,
    /// The FMU's wish.
    #[error("the FMU asked to end the simulation")]
    Ended,
}

impl ExchangeError {
    /// As the end at `time`, s, of a simulation until `stop`.
    pub fn at(&self, time: f64, stop: f64) -> RunError {
        match self {
            Self::Ended => RunError::Over { time, stop },
            other => stopped(time, stop, other),
        }
    }
}

/// The inputs between two events.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'a> {
    /// A table.
    pub signals: Option<&'a Signals>,
    /// What others than the table set, by value references.
    pub held: &'a BTreeMap<u32, f64>,
    /// When something jumps next, s: no step goes beyond it.
    pub next: f64,
}

/// The inputs of a table that follow the time between two events.
struct Following<'a> {
    signals: Option<&'a Signals>,
    list: Vec<&'a Signal>,
    /// Their value references.
    references: Vec<u32>,
    /// Their values; filled by [`Self::set`].
    values: Vec<f64>,
}

impl<'a> Following<'a> {
    /// Those that nobody else sets.
    fn new(inputs: &Inputs<'a>) -> Self {
        let mut list: Vec<&Signal> = Vec::new();
        list.extend(inputs.signals.iter().flat_map(|signals| &signals.list));
        list.retain(|signal| {
            signal.is_continuous() && !inputs.held.contains_key(&signal.variable.value_reference)
        });
        Self {
            signals: inputs.signals,
            references: list.iter().map(|s| s.variable.value_reference).collect(),
            values: vec![0.0; list.len()],
            list,
        }
    }

    /// Sets them to what they are at `time`, s.
    ///
    /// - `since`, `until`: when inputs last jumped, and when they may jump again, s
    fn set(
        &mut self,
        slave: &mut Slave,
        time: f64,
        [since, until]: [f64; 2],
    ) -> Result<(), LibraryError> {
        let Some(signals) = self.signals else {
            return Ok(());
        };
        for (value, signal) in self.values.iter_mut().zip(&self.list) {
            *value = if time <= since {
                signals.value(signal, time)
            } else {
                signals.value_before(signal, time.min(until))
            };
        }
        slave.set_real(&self.references, &self.values)
    }
}

/// What integrates an FMU.
pub(super) struct Exchange {
    names: Vec<String>,
    tolerance: f64,
    nominals: Vec<f64>,
    /// None before the beginning.
    method: Option<Rodas>,
    /// When the last event was, s.
    since: f64,
    /// When the FMU's next event is, s.
    next: f64,
}

impl Exchange {
    /// For an FMU with these states.
    ///
    /// - `tolerance`: relative
    pub fn new(names: Vec<String>, tolerance: f64) -> Self {
        Self {
            nominals: vec![1.0; names.len()],
            names,
            tolerance,
            method: None,
            since: 0.0,
            next: f64::INFINITY,
        }
    }

    /// Goes on from the initialisation, which has ended in event mode.
    pub fn begin(&mut self, slave: &mut Slave, time: f64) -> Result<(), ExchangeError> {
        self.method = None;
        self.settle(slave, time)
    }

    /// Ends an event at `time`, s, that began with event mode.
    pub fn settle(&mut self, slave: &mut Slave, time: f64) -> Result<(), ExchangeError> {
        let mut updates = 0;
        let update = loop {
            let update = slave.update_discrete_states()?;
            updates += 1;
            if update.ends {
                return Err(ExchangeError::Ended);
            }
            if !update.again {
                break update;
            }
            if updates == MOST_UPDATES {
                return Err(ExchangeError::Updates);
            }
        };
        slave.enter_continuous_time_mode()?;
        self.next = update.next.unwrap_or(f64::INFINITY);
        self.since = time;
        let mut states = vec![0.0; self.names.len()];
        slave.get_states(&mut states)?;
        slave.get_nominals(&mut self.nominals)?;
        for nominal in &mut self.nominals {
            *nominal = nominal.abs();
        }
        match &mut self.method {
            Some(method) => method.restart(&states, &self.nominals),
            None => {
                self.method = Some(Rodas::new(
                    time,
                    states,
                    self.nominals.clone(),
                    self.tolerance,
                ));
            }
        }
        Ok(())
    }

    /// Integrates to `end`, s, and leaves the FMU there; gives the time that was reached with an
    /// error.
    pub fn advance(
        &mut self,
        slave: &mut Slave,
        inputs: Inputs,
        end: f64,
    ) -> Result<(), (f64, ExchangeError)> {
        let mut steps = 0;
        let mut time = self.since;
        let mut following = Following::new(&inputs);
        loop {
            match self.piece(slave, (&mut following, inputs.next), end, &mut steps) {
                Ok(reached) => time = reached,
                Err(error) => {
                    let reached = self.method.as_ref().map_or(time, |method| method.time);
                    return Err((reached, error));
                }
            }
            if time >= end {
                return Ok(());
            }
        }
    }

    /// A step of the method and what follows from it; gives its end, s.
    ///
    /// - `jump`: when something jumps next, s
    fn piece(
        &mut self,
        slave: &mut Slave,
        (following, jump): (&mut Following, f64),
        end: f64,
        steps: &mut usize,
    ) -> Result<f64, ExchangeError> {
        let Some(method) = &mut self.method else {
            return Err(ExchangeError::Ended);
        };
        let due = end.min(self.next);
        let mut equations = Driven {
            slave: &mut *slave,
            following,
            between: [self.since, jump.min(self.next)],
            said: String::new(),
        };
        let taken = if due > method.time {
            method.advance(&mut equations, due)?
        } else {
            Taken::Step
        };
        let (time, states) = (method.time, method.states.as_slice());
        equations.place(time, states)?;
        let said = equations.said;
        *steps += 1;
        if taken == Taken::Stuck || *steps > MOST_STEPS {
            let fastest = fastest(slave, &self.names, &self.nominals);
            return Err(if taken == Taken::Stuck {
                ExchangeError::Stuck { fastest, said }
            } else {
                ExchangeError::Steps { fastest }
            });
        }
        let completed = slave.completed_step()?;
        if completed.ends {
            return Err(ExchangeError::Ended);
        }
        if completed.event || time >= self.next {
            slave.enter_event_mode()?;
            self.settle(slave, time)?;
        }
        Ok(time)
    }
}

/// The state that changes fastest, in parts of its size.
fn fastest(slave: &mut Slave, names: &[String], nominals: &[f64]) -> String {
    let mut rates = vec![0.0; names.len()];
    if slave.get_rates(&mut rates).is_err() {
        return "unknown".to_owned();
    }
    let sizes = rates
        .iter()
        .zip(nominals)
        .map(|(rate, nominal)| (rate / nominal).abs());
    let fastest = names.iter().zip(sizes).max_by(|a, b| a.1.total_cmp(&b.1));
    fastest.map_or("none".to_owned(), |(name, _)| name.clone())
}

/// The equations of an FMU with its inputs.
struct Driven<'a, 'b> {
    slave: &'a mut Slave,
    following: &'a mut Following<'b>,
    /// When the inputs last jumped, and when they may jump again, s.
    between: [f64; 2],
    /// What the FMU said where it last had no derivatives, as the end of a sentence.
    said: String,
}

impl Driven<'_, '_> {
    /// Sets time, states and the inputs that follow the time.
    fn place(&mut self, time: f64, states: &[f64]) -> Result<(), LibraryError> {
        self.slave.set_time(time)?;
        self.slave.set_states(states)?;
        self.following.set(self.slave, time, self.between)
    }

    fn evaluate(
        &mut self,
        time: f64,
        states: &[f64],
        rates: &mut [f64],
    ) -> Result<(), LibraryError> {
        self.place(time, states)?;
        self.slave.get_rates(rates)
    }
}

impl Equations for Driven<'_, '_> {
    type Error = LibraryError;

    fn rates(
        &mut self,
        time: f64,
        states: &[f64],
        rates: &mut [f64],
    ) -> Result<bool, LibraryError> {
        let heard = self.slave.heard();
        match self.evaluate(time, states, rates) {
            Ok(()) => Ok(true),
            // Nothing failed if a shorter step does it, and the FMU's complaint about the try is
            // no message about the run. If none does, the end of the run says it.
            Err(error) if error.is_discard() => {
                error.said().clone_into(&mut self.said);
                self.slave.forget_complaints(heard);
                Ok(false)
            }
            Err(error) => Err(error),
        }
    }
}

/// An integration, if the interface needs one.
pub(super) fn of(interface: Interface, names: &[String], tolerance: f64) -> Option<Exchange> {
    (interface == Interface::ModelExchange).then(|| Exchange::new(names.to_vec(), tolerance))
}
