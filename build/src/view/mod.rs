//! A live view: the FMU runs by its own library in real time, and browsers show it and send
//! commands.
//!
//! One thread simulates, the one that called [`Ready::run`]; `server` has the others. `http` and
//! `socket` read what comes from outside, `protocol` interprets it, `inputs` records which viewer
//! holds which input, `pace` keeps simulated time with real time, `hub` sends, `record` writes.

mod http;
mod hub;
mod inputs;
mod open;
mod pace;
mod protocol;
mod record;
mod server;
mod socket;

pub use open::open;

use crate::importer::error::RunError;
use crate::importer::live::Live;
use crate::output::{OutputError, tell};
use crate::page;
use hub::Hub;
use inputs::Inputs;
use pace::Pace;
use protocol::{News, PAUSED, RESET, Wish};
use record::Recording;
use server::{Event, Server};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use urdf2fmu_drawing::scene::Scene;

/// Length of a step, s.
const STEP: f64 = 1.0 / 240.0;

/// Steps for each frame.
const PER_FRAME: u64 = 4;

/// Longest time between two looks at what viewers wish, while the simulation is slow.
const BUSY: Duration = Duration::from_millis(25);

/// Time between frames while nothing moves: viewers see that the connection lives.
const IDLE: Duration = Duration::from_millis(250);

/// Time between writes of the recording.
const WRITTEN: Duration = Duration::from_millis(250);

/// What to show.
pub struct View<'a> {
    /// The robot.
    pub scene: &'a Scene,
    /// The scene's bytes.
    pub packed: &'a [u8],
    /// The unpacked FMU.
    pub folder: &'a Path,
    /// A table of inputs over time.
    pub inputs: Option<PathBuf>,
    /// Where results go.
    pub record: Option<PathBuf>,
    /// 0 for any.
    pub port: u16,
    /// Simulated seconds for each second.
    pub speed: f64,
}

/// Why a view cannot begin or go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The FMU.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The port.
    #[error("cannot listen on 127.0.0.1:{port}: {source}; --port 0 takes any free port")]
    Port {
        /// As asked for.
        port: u16,
        /// Why.
        source: io::Error,
    },
    /// The recording.
    #[error("cannot write '{}': {source}", path.display())]
    Record {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Standard error.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// A view that is ready.
pub struct Ready<'a> {
    live: Live,
    scene: &'a Scene,
    /// Where each output of the scene stands in a row.
    places: Vec<usize>,
    inputs: Inputs,
    pace: Pace,
    hub: Hub,
    events: Receiver<Event>,
    recording: Option<Recording>,
    server: Server,
    done: u64,
    running: bool,
    /// Whether the first viewer is still to come.
    waiting: bool,
    failed: String,
    flags: u32,
    told_slow: bool,
}

impl<'a> View<'a> {
    /// Loads the FMU and begins to listen.
    ///
    /// # Errors
    /// [`ViewError`]
    pub fn start(&self) -> Result<Ready<'a>, ViewError> {
        let mut live = Live::open(self.folder, self.inputs.as_deref(), STEP)?;
        live.begin()?;
        let head = &self.scene.head;
        let place = |name: &str| live.names().iter().position(|other| other == name);
        let outputs = head.variables.iter().filter(|v| v.causality == "output");
        let places = outputs
            .map(|v| place(&v.name).unwrap_or_default())
            .collect();
        let recording = self.record.as_deref().map(|path| {
            Recording::new(path, live.names()).map_err(|source| ViewError::Record {
                path: path.to_owned(),
                source,
            })
        });
        let recording = recording.transpose()?;
        let inputs = Inputs::new(&head.variables, |name| live.has_in_table(name));
        let now = Instant::now();
        let mut pace = Pace::new(STEP, now);
        pace.set_speed(self.speed, now, 0);
        let hub = Hub::default();
        let (sender, events) = channel();
        let html = |port: u16| {
            // A page that came through a tunnel has another port, which is 'self' to it.
            let connect = format!("'self' ws://127.0.0.1:{port} ws://localhost:{port}");
            page::html(&head.robot, self.packed, None, &connect)
        };
        let server = server::start(self.port, html, hub.clone(), sender);
        let port = self.port;
        let server = server.map_err(|source| ViewError::Port { port, source })?;
        Ok(Ready {
            live,
            scene: self.scene,
            places,
            inputs,
            pace,
            hub,
            events,
            recording,
            server,
            done: 0,
            running: false,
            waiting: true,
            failed: String::new(),
            flags: RESET,
            told_slow: false,
        })
    }
}

impl Ready<'_> {
    /// With the key.
    pub fn address(&self) -> &str {
        &self.server.address
    }

    /// For a tunnel.
    pub fn port(&self) -> u16 {
        self.server.port
    }

    /// Runs until `ended`.
    ///
    /// # Errors
    /// [`ViewError`]; a simulation that fails is told to viewers and goes on with a reset.
    pub fn run(&mut self, ended: impl Fn() -> bool) -> Result<(), ViewError> {
        let mut framed = Instant::now();
        let mut written = framed;
        self.record()?;
        self.send()?;
        while !ended() {
            let now = Instant::now();
            let mut moved = self.hear(now)?;
            self.inputs.release_silent(now);
            if self.running {
                moved |= self.catch_up(now)?;
                self.pace.measure(Instant::now(), self.done);
                self.tell_slow()?;
            }
            let now = Instant::now();
            if moved || now.duration_since(framed) > IDLE {
                framed = now;
                self.send()?;
            }
            if now.duration_since(written) > WRITTEN {
                written = now;
                self.write()?;
            }
        }
        self.write()
    }

    /// Waits until steps are due or a viewer wishes something; says whether the state has changed.
    fn hear(&mut self, now: Instant) -> Result<bool, ViewError> {
        let next = self.pace.when(self.done, PER_FRAME);
        let wait = if self.running {
            next.saturating_duration_since(now).min(IDLE)
        } else {
            IDLE
        };
        let mut moved = false;
        let mut event = self.events.recv_timeout(wait);
        loop {
            match event {
                Ok(Event::Joined) => {
                    if std::mem::take(&mut self.waiting) {
                        self.go();
                    }
                    moved = true;
                }
                Ok(Event::Left(viewer)) => self.inputs.release_all(viewer),
                Ok(Event::Wish(viewer, wish)) => {
                    self.inputs.hear(viewer, Instant::now());
                    moved |= self.grant(viewer, &wish)?;
                }
                // The sender lives as long as the listener, which does not end.
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => break,
            }
            event = self
                .events
                .try_recv()
                .map_err(|_| RecvTimeoutError::Timeout);
        }
        Ok(moved)
    }

    /// Does what a viewer wishes.
    fn grant(&mut self, viewer: u64, wish: &Wish) -> Result<bool, ViewError> {
        self.inputs.set(&wish.set);
        self.inputs.hold(viewer, &wish.hold);
        self.inputs.release(viewer, &wish.release);
        if let Some(speed) = wish.speed {
            self.pace.set_speed(speed, Instant::now(), self.done);
            self.told_slow = false;
        }
        if wish.reset {
            self.reset()?;
        }
        if wish.pause || wish.step {
            self.running = false;
        }
        if wish.run && !self.running {
            self.go();
        }
        if wish.step {
            self.step()?;
        }
        Ok(wish.reset || wish.pause || wish.run || wish.step || wish.speed.is_some())
    }

    fn go(&mut self) {
        self.running = self.failed.is_empty();
        self.pace.start(Instant::now(), self.done);
    }

    fn reset(&mut self) -> Result<(), ViewError> {
        self.inputs.reset();
        self.failed.clear();
        self.done = 0;
        self.flags |= RESET;
        if let Err(error) = self.live.begin() {
            return self.fail(&error);
        }
        if let Some(recording) = &mut self.recording {
            recording.next().map_err(|source| ViewError::Record {
                path: recording.path().to_owned(),
                source,
            })?;
        }
        self.go();
        self.record()
    }

    /// Takes the steps that are due, as far as time allows; says whether there were any.
    fn catch_up(&mut self, begin: Instant) -> Result<bool, ViewError> {
        let mut due = self.pace.due(begin, self.done);
        let any = due > 0;
        while due > 0 && self.running && begin.elapsed() < BUSY {
            self.step()?;
            due -= 1;
        }
        Ok(any)
    }

    fn step(&mut self) -> Result<(), ViewError> {
        if !self.failed.is_empty() {
            return Ok(());
        }
        let decided = self.inputs.decided();
        #[expect(clippy::cast_precision_loss, reason = "a number of steps")]
        let end = self.live.start() + (self.done + 1) as f64 * STEP;
        let live = &mut self.live;
        let stepped = live
            .follow_table()
            .and_then(|()| live.set(&decided))
            .and_then(|()| live.step_to(end));
        match stepped {
            Ok(()) => {
                self.done += 1;
                self.record()
            }
            Err(error) => self.fail(&error),
        }
    }

    fn fail(&mut self, error: &RunError) -> Result<(), ViewError> {
        self.running = false;
        self.failed = format!("The simulation stopped: {error}.");
        tell(&format!(
            "error: {error}; a reset in the page begins anew\n"
        ))?;
        Ok(())
    }

    fn record(&mut self) -> Result<(), ViewError> {
        let Some(recording) = &mut self.recording else {
            return Ok(());
        };
        let row = self.live.row()?;
        recording.row(&row).map_err(|source| ViewError::Record {
            path: recording.path().to_owned(),
            source,
        })
    }

    fn write(&mut self) -> Result<(), ViewError> {
        let Some(recording) = &mut self.recording else {
            return Ok(());
        };
        recording.flush().map_err(|source| ViewError::Record {
            path: recording.path().to_owned(),
            source,
        })
    }

    /// Sends values and news to all viewers.
    fn send(&mut self) -> Result<(), ViewError> {
        let row = self.live.row()?;
        let paused = if self.running { 0 } else { PAUSED };
        let outputs = self.places.iter().map(|&place| row[place]);
        let factor = if self.running {
            self.pace.factor()
        } else {
            0.0
        };
        let values = protocol::values(self.flags | paused, factor, row[0], outputs);
        if self.hub.count() > 0 {
            self.flags = 0;
        }
        self.hub.send_values(&values);
        let changed = self.inputs.changed();
        let (all, held) = self.inputs.all();
        let news = |inputs| {
            News {
                inputs,
                held: held.clone(),
                speed: self.pace.speed(),
                failed: &self.failed,
            }
            .text()
        };
        let changes = changed.iter().map(|(name, value)| (name.as_str(), *value));
        self.hub
            .send_news(Some(news(changes.collect())), || news(all.clone()));
        Ok(())
    }

    /// Says once that real time is not held.
    fn tell_slow(&mut self) -> Result<(), ViewError> {
        if self.told_slow || !self.pace.is_slow() {
            return Ok(());
        }
        let (factor, speed) = (self.pace.factor(), self.pace.speed());
        self.told_slow = true;
        tell(&format!(
            "note: '{}' runs at {factor:.2} times real time, {speed} was asked for: a step takes \
             longer than it lasts\n",
            self.scene.head.robot
        ))?;
        Ok(())
    }
}
