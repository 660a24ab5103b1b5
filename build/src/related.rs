//! Files beside an FMU for whoever imports it: its parameters, and on request a reference run.
//!
//! They are listed in the layout of FMI-LS-REF 1.0.0-alpha.1 (Modelica Association), a layered
//! standard for FMI 2.0 and 3.0. The reference run is what the FMU itself gives, called through its
//! C functions as by any other importer: an importer that gets other values does something else.

use crate::describe::{STEP_SIZE, number};
use crate::importer::csv::{Table, cells};
use crate::importer::error::RunError;
use crate::importer::experiment::Experiment;
use crate::importer::run::{self, Outcome};
use crate::library::{Binary, LibraryError, embedded, pack, target};
use crate::listing::Listed;
use crate::output::tell;
use crate::progress::Progress;
use crate::ssv;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};
use urdf2fmu_core::model::Model;
use urdf2fmu_core::prepared::FILE_NAME;
use urdf2fmu_core::settings::FmiVersion;
use urdf2fmu_core::simulation::InputSlot;
use urdf2fmu_core::variables::{Causality, Slot, Unit, Variable};

/// Where they are in the FMU.
const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
const PARAMETERS: &str = "parameters.ssv";
const EXPERIMENT: &str = "reference.exp";
const INPUTS: &str = "reference_inputs.csv";
const OUTPUTS: &str = "reference_outputs.csv";

/// What the schema of the layered standard fixes.
const NAMESPACE: &str = "http://fmi-standard.org/fmi-ls-manifest";
const STANDARD: [(&str, &str); 3] = [
    ("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-ref"),
    ("fmi-ls:fmi-ls-version", "1.0.0-alpha.1"),
    (
        "fmi-ls:fmi-ls-description",
        "Layered Standard providing information on related files included in an FMU.",
    ),
];

/// Length of a reference run, s. Commands rise between the two times and stay: importers that hold
/// inputs over a step and those that follow lines get the same at the communication points, and a
/// jump, which needs a row of its own, is not needed.
const STOP: f64 = 2.0;
const RISE: [f64; 2] = [0.5, 1.0];
/// By how much they rise: a tenth of the limit, so that no robot falls over by it, or where there
/// is no limit this, rad/s and m/s.
const SHARE: f64 = 0.1;
const SPEED: f64 = 0.5;
/// rad and m
const ANGLE: f64 = 0.1;
const WAY: f64 = 0.02;
/// N·m and N
const EFFORT: f64 = 0.1;

/// Seconds of the clock after which a word is said of a run that is not done.
const PATIENCE: Duration = Duration::from_secs(10);

/// What is said then.
///
/// - `time`: what has been simulated, s
fn slow(time: f64) -> String {
    format!(
        "note: the reference run is at {time:.3} of {STOP} s after {} s of the clock, and goes on; \
         without --reference-run there is none\n",
        PATIENCE.as_secs()
    )
}

/// Why there is no reference run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RelatedError {
    /// The library of this system.
    #[error("a reference run needs the library for this system: {0}")]
    Library(#[from] LibraryError),
    /// The run.
    #[error("the reference run fails: {0}")]
    Run(#[from] RunError),
    /// Its files.
    #[error("cannot write the files of a reference run: {0}")]
    Write(#[from] io::Error),
}

/// What an FMU gave for some inputs.
pub struct Reference {
    inputs: Table,
    outcome: Outcome,
}

/// What a run needs to know of an FMU.
pub struct Subject<'a> {
    /// modelDescription.xml
    pub description: &'a [u8],
    /// resources/model.json
    pub prepared: &'a str,
    /// Name of the library.
    pub model_identifier: &'a str,
    /// Version of the standard.
    pub fmi: FmiVersion,
    /// Its variables.
    pub table: &'a [Variable],
}

/// Runs an FMU for two seconds; `folder` is for its files.
///
/// # Errors
/// [`RelatedError`].
pub fn reference(subject: &Subject, folder: &Path) -> Result<Reference, RelatedError> {
    use std::env::consts::{ARCH, OS};
    let here = target::of(OS, ARCH).map_or(OS, |target| target.platform);
    let write = |name: &str, bytes: &[u8]| {
        let file = folder.join(name);
        file.parent().map_or(Ok(()), std::fs::create_dir_all)?;
        std::fs::write(file, bytes)
    };
    for Binary {
        folder,
        extension,
        file,
        ..
    } in pack(embedded(), &[here], subject.fmi.major())?
    {
        let name = format!("binaries/{folder}/{}.{extension}", subject.model_identifier);
        write(&name, &file)?;
    }
    write("modelDescription.xml", subject.description)?;
    write(
        &format!("resources/{FILE_NAME}"),
        subject.prepared.as_bytes(),
    )?;
    let inputs = inputs(subject.table);
    write(INPUTS, inputs.to_text().as_bytes())?;
    let experiment = Experiment {
        start_time: Some(0.0),
        stop_time: Some(STOP),
        output_interval: Some(STEP_SIZE),
        inputs: Some(folder.join(INPUTS)),
        ..Experiment::default()
    };
    let mut progress = Progress::new(true);
    let mut patience = Some(Instant::now() + PATIENCE);
    let mut outcome = run::simulate(folder, &experiment, &mut |time, times| {
        progress.at(time, times.start, times.stop);
        if patience.is_some_and(|end| Instant::now() > end) {
            patience = None;
            // Whoever has no terminal sees no progress; a stream that is closed needs none.
            _ = tell(&slow(time));
        }
        true
    })?;
    progress.clear();
    match outcome.failure.take() {
        Some(failure) => Err(failure.into()),
        None => Ok(Reference { inputs, outcome }),
    }
}

/// Commands that rise and stay; all other inputs keep their start values.
fn inputs(table: &[Variable]) -> Table {
    let commands = table.iter().filter_map(|v| Some((v, risen(v)?)));
    let (names, values): (Vec<_>, Vec<_>) = commands
        .map(|(v, risen)| (v.name.clone(), [v.start.unwrap_or_default(), risen]))
        .unzip();
    let rows = [(0.0, 0), (RISE[0], 0), (RISE[1], 1), (STOP, 1)];
    let rows = rows.map(|(time, which)| {
        let values = values.iter().map(|value: &[f64; 2]| value[which]);
        std::iter::once(time).chain(values).collect()
    });
    Table {
        names: std::iter::once("time".to_owned()).chain(names).collect(),
        rows: rows.to_vec(),
    }
}

/// What a command rises to; none of what is no command.
fn risen(v: &Variable) -> Option<f64> {
    let Slot::Input(slot) = v.slot else {
        return None;
    };
    let share = |usual: f64| {
        v.max
            .filter(|max| *max > 0.0)
            .map_or(usual, |max| SHARE * max)
    };
    let start = v.start.unwrap_or_default();
    let by = match slot {
        InputSlot::Velocity(_) => share(SPEED),
        InputSlot::Effort(_) => share(EFFORT),
        InputSlot::Position(_) if v.unit == Unit::Meter => WAY,
        InputSlot::Position(_) => ANGLE,
        _ => return None,
    };
    let beyond = v.max.is_some_and(|max| start + by > max);
    let below = v.min.is_some_and(|min| start - by < min);
    Some(match (beyond, below) {
        (false, _) => start + by,
        (true, false) => start - by,
        (true, true) => start,
    })
}

/// The files with their names in the FMU.
///
/// # Errors
/// [`RelatedError::Write`]: of the writer.
pub fn files(
    model: &Model,
    listed: &[Listed],
    reference: Option<&Reference>,
) -> Result<Vec<(String, Vec<u8>)>, RelatedError> {
    let mut files = vec![(PARAMETERS, ssv::text(model, listed)?.into_bytes())];
    let mut related = vec![[
        "application/x-ssp-parameter-set",
        PARAMETERS,
        "parameter",
        "All parameters with the values that they start with",
    ]];
    if let Some(reference) = reference {
        let columns = |causality| {
            listed
                .iter()
                .filter(move |v| v.first().causality() == causality)
        };
        let inputs = text(&reference.inputs, columns(Causality::Input));
        let outputs = text(&reference.outcome.table, columns(Causality::Output));
        files.push((EXPERIMENT, experiment(&reference.outcome)?));
        files.push((INPUTS, inputs.into_bytes()));
        files.push((OUTPUTS, outputs.into_bytes()));
        related.push([
            "application/x-ma-ls-experiments",
            EXPERIMENT,
            "experiment/smoke-test",
            "Two seconds with commands that rise, and what the FMU gives",
        ]);
    }
    files.push(("fmi-ls-manifest.xml", manifest(&related)?));
    let named = files.into_iter();
    Ok(named
        .map(|(name, bytes)| (format!("{FOLDER}/{name}"), bytes))
        .collect())
}

/// A table with a column for each variable of the file that it has values of: numbers of an array
/// stand in one cell, with blanks between them, as `FMPy` and fmusim write and read them.
fn text<'a>(table: &Table, listed: impl Iterator<Item = &'a Listed<'a>>) -> String {
    let places: HashMap<&str, usize> = (1..table.names.len())
        .map(|place| (table.names[place].as_str(), place))
        .collect();
    let place = |row: &Variable| places.get(row.name.as_str()).copied();
    let columns: Vec<&Listed> = listed
        .filter(|v| v.rows.iter().any(|row| place(row).is_some()))
        .collect();
    let mut text = String::from("\"time\"");
    for column in &columns {
        _ = write!(text, ",\"{}\"", column.name);
    }
    for row in &table.rows {
        text.push('\n');
        text.push_str(&cells(&row[..1]).join(""));
        for column in &columns {
            let values = column.rows.iter().map(|element| {
                let found = place(element).map(|place| row[place]);
                found.or(element.start).unwrap_or_default()
            });
            text.push(',');
            text.push_str(&cells(&values.collect::<Vec<_>>()).join(" "));
        }
    }
    text.push('\n');
    text
}

fn document() -> io::Result<Writer<Vec<u8>>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    Ok(xml)
}

fn ended(xml: Writer<Vec<u8>>) -> Vec<u8> {
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    bytes
}

fn manifest(related: &[[&str; 4]]) -> io::Result<Vec<u8>> {
    let mut xml = document()?;
    xml.create_element("fmiReferences")
        .with_attribute(("xmlns:fmi-ls", NAMESPACE))
        .with_attributes(STANDARD)
        .write_inner_content(|xml| {
            related.iter().try_for_each(|file| {
                let names = ["type", "source", "role", "description"];
                let attributes = names.into_iter().zip(file.iter().copied());
                let element = xml.create_element("Related").with_attributes(attributes);
                element.write_empty().map(drop)
            })
        })?;
    Ok(ended(xml))
}

fn experiment(outcome: &Outcome) -> io::Result<Vec<u8>> {
    let mut xml = document()?;
    let times = &outcome.times;
    let (start, stop) = (number(times.start), number(times.stop));
    let (step, tolerance) = (number(times.interval), outcome.tolerance.map(number));
    xml.create_element("Experiments")
        .with_attribute(("name", "Reference run"))
        .write_inner_content(|xml| {
            let mut element = xml
                .create_element("Experiment")
                .with_attribute(("name", "Commands that rise"))
                .with_attribute(("startTime", start.as_str()))
                .with_attribute(("stopTime", stop.as_str()))
                .with_attribute(("stepSize", step.as_str()));
            if let Some(tolerance) = &tolerance {
                element = element.with_attribute(("tolerance", tolerance.as_str()));
            }
            element.write_inner_content(|xml| {
                for (name, source) in [("Stimuli", INPUTS), ("References", OUTPUTS)] {
                    let element = xml.create_element(name);
                    element.with_attribute(("source", source)).write_empty()?;
                }
                Ok(())
            })?;
            Ok(())
        })?;
    Ok(ended(xml))
}
