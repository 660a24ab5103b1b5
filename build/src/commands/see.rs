//! The commands that show a robot in a browser.

use super::shared::{CliError, as_fmu, refuse_ending, refuse_options, temporary};
use crate::archive;
use crate::cli::{Report, View};
use crate::events::Event;
use crate::importer::tabular::{LARGEST, decoded};
use crate::output::{OutputError, Target, beside, is_stdout, print, tell};
use crate::report;
use crate::results::Table;
use crate::run_summary;
use crate::view;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use urdf2fmu_core::reading;
use urdf2fmu_drawing::scene::{FILE_NAME, Scene, SceneError};

/// A scene and its bytes.
pub(super) struct Seen {
    pub(super) scene: Scene,
    bytes: Vec<u8>,
}

impl Seen {
    /// Puts bases that cannot move where the parameters `changed` in a run mount them: no output
    /// says where such a base is.
    pub(super) fn mount(&mut self, changed: &BTreeMap<String, f64>) -> Result<(), SceneError> {
        if self.scene.mount(changed) {
            self.bytes = self.scene.to_bytes()?;
        }
        Ok(())
    }
}

/// The scene of an FMU.
///
/// - `named`: what the user called it
pub(super) fn scene(fmu: &Path, named: &Path) -> Result<Seen, CliError> {
    let path = named.to_owned();
    let Some(bytes) = archive::read_entry(fmu, &format!("resources/{FILE_NAME}"))? else {
        return Err(CliError::NoScene { path });
    };
    let scene = Scene::from_bytes(&bytes).map_err(|source| CliError::Scene { path, source })?;
    Ok(Seen { scene, bytes })
}

/// `report`
pub(super) fn report(args: &Report) -> Result<(), CliError> {
    refuse_options(&args.model, &args.source)?;
    let folder = temporary()?;
    let request = args.source.request(&args.model);
    let (fmu, mut inputs) = as_fmu(&args.model, &request, folder.path())?;
    inputs.push(args.results.clone());
    let output = args.output.clone();
    let output = output.unwrap_or_else(|| beside(&args.results, "run", "html"));
    let target = Target::new(&output, inputs.iter().map(PathBuf::as_path))?;
    refuse_ending(args.output.as_ref(), "--output", ["a page", "html"])?;
    let seen = scene(&fmu, &args.model)?;
    let table = run(&args.results, &seen.scene)?;
    let events = write(&target, &seen, table, &BTreeMap::new())?;
    Ok(tell(&run_summary::list(&events))?)
}

/// The table of a run.
pub(super) fn run(path: &Path, scene: &Scene) -> Result<Table, CliError> {
    let path = path.to_owned();
    let bytes = match reading::read(&path, LARGEST) {
        Ok(bytes) => bytes,
        Err(source) => return Err(CliError::Read { path, source }),
    };
    let table = Table::parse(&decoded(bytes));
    let table = table.and_then(|table| table.named(scene).in_units_of(scene));
    table.map_err(|source| CliError::Results { path, source })
}

/// Says what had to be said of a table.
pub(super) fn tell_notes(notes: &[String]) -> Result<(), OutputError> {
    for note in notes {
        tell(&format!("note: {note}\n"))?;
    }
    Ok(())
}

/// Writes the page and says what had to be said; gives what happened in the run.
pub(super) fn write(
    target: &Target,
    seen: &Seen,
    table: Table,
    changed: &BTreeMap<String, f64>,
) -> Result<Vec<Event>, OutputError> {
    let report = report::make(&seen.scene, &seen.bytes, table, changed);
    if let Some(doubt) = &report.doubt {
        tell(&format!("warning: {doubt}\n"))?;
    }
    tell_notes(&report.notes)?;
    target.write(report.html.as_bytes())?;
    Ok(report.events)
}

/// Code of the finding that a wrench cannot move a link.
const IMMOVABLE: &str = "A102";

/// `view`
pub(super) fn view(args: &View) -> Result<(), CliError> {
    refuse_options(&args.file, &args.source)?;
    let folder = temporary()?;
    let mut request = args.source.request(&args.file);
    request.pushable = true;
    let made = match as_fmu(&args.file, &request, folder.path()) {
        // Nothing of a robot that is bolted to the world as a whole can be pushed.
        Err(CliError::Findings { findings, .. })
            if findings.iter().any(|f| f.code == IMMOVABLE) =>
        {
            request.pushable = false;
            as_fmu(&args.file, &request, folder.path())
        }
        made => made,
    };
    let (fmu, mut inputs) = made?;
    inputs.extend(args.input_file.clone());
    if let Some(record) = &args.record {
        if is_stdout(record) {
            return Err(OutputError::Taken {
                option: "--record",
                other: "the address of the view",
            }
            .into());
        }
        // Only whether it may be written: the file grows while the simulation runs.
        Target::new(record, inputs.iter().map(PathBuf::as_path))?;
        refuse_ending(Some(record), "--record", ["a table", "csv"])?;
    }
    let seen = scene(&fmu, &args.file)?;
    let unpacked = folder.path().join("fmu");
    archive::unpack(&fmu, &unpacked)?;
    let view = view::View {
        scene: &seen.scene,
        packed: &seen.bytes,
        folder: &unpacked,
        inputs: args.input_file.clone(),
        record: args.record.clone(),
        port: args.port,
        speed: args.speed,
    };
    let mut ready = view.start()?;
    print(&format!("{}\n", ready.address()))?;
    let port = ready.port();
    tell(&format!(
        "The address has a key: who knows it can steer the robot. It begins with the first viewer.\n\
         From another machine: ssh -L {port}:127.0.0.1:{port} this-host. Ctrl-C ends it.\n"
    ))?;
    if !args.no_open && !matches!(view::open(ready.address(), folder.path()), Ok(true)) {
        tell("note: no browser could be opened here; open the address yourself\n")?;
    }
    #[cfg(unix)]
    crate::process::watch_end();
    ready.run(ended)?;
    Ok(())
}

/// Whether the user wants the program to end.
pub(super) fn ended() -> bool {
    #[cfg(unix)]
    return crate::process::ended();
    // Elsewhere Ctrl-C ends the process as it is; a recording is whole up to a moment before.
    #[cfg(not(unix))]
    false
}
