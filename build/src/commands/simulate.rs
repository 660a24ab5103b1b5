//! `simulate`: runs an FMU as an importer does, writes the results, and reports about the run.

use super::see::{self, Seen};
use super::shared::{CliError, as_fmu, refuse_ending, refuse_options, temporary};
use crate::archive;
use crate::cli::Simulate;
use crate::cost::{Costs, Touching};
use crate::events;
use crate::importer::experiment::Experiment;
use crate::importer::run::{self, Outcome};
use crate::output::{OutputError, Target, is_stdout, print, stem, tell};
use crate::plot::{self, Curve};
use crate::progress::Progress;
use crate::results::Table;
use crate::run_summary::{self, Ended};
use std::collections::BTreeMap;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use urdf2fmu_drawing::scene::{Head, Shape};

/// Tolerance of an FMU that is told none.
const TOLERANCE: f64 = 1e-3;

/// Where results go.
struct Targets {
    table: Option<Target>,
    page: Option<Target>,
    plot: Option<Target>,
}

pub(super) fn simulate(args: &Simulate) -> Result<(), CliError> {
    refuse_options(&args.file, &args.source)?;
    let folder = temporary()?;
    let (fmu, mut inputs) = as_fmu(&args.file, &args.source.request(&args.file), folder.path())?;
    inputs.extend(args.input_file.clone());
    let target = |path: &Option<PathBuf>| -> Result<Option<Target>, OutputError> {
        let target = |path| Target::new(path, inputs.iter().map(PathBuf::as_path));
        path.as_deref().map(target).transpose()
    };
    let outputs = [&args.output_file, &args.plot, &args.report];
    let to_stdout = |path: &&&Option<PathBuf>| path.as_deref().is_some_and(is_stdout);
    if outputs.iter().filter(to_stdout).count() > 1 {
        return Err(OutputError::Taken {
            option: if args.report.as_deref().is_some_and(is_stdout) {
                "--report"
            } else {
                "--plot"
            },
            other: "another output",
        }
        .into());
    }
    let targets = Targets {
        page: target(&args.report)?,
        plot: target(&args.plot)?,
        table: target(&args.output_file)?,
    };
    refuse_ending(args.plot.as_ref(), "--plot", ["an SVG picture", "svg"])?;
    refuse_ending(args.report.as_ref(), "--report", ["a page", "html"])?;
    refuse_ending(
        args.output_file.as_ref(),
        "--output-file",
        ["a table", "csv"],
    )?;
    let mut seen = match see::scene(&fmu, &args.file) {
        // What a report needs is looked for before the simulation.
        Err(error) if targets.page.is_some() => return Err(error),
        // An FMU of another program has none.
        seen => seen.ok(),
    };
    let unpacked = folder.path().join("fmu");
    archive::unpack(&fmu, &unpacked)?;
    let outcome = run(args, &unpacked)?;
    if let Some(seen) = &mut seen {
        let path = args.file.clone();
        seen.mount(&outcome.started)
            .map_err(|source| CliError::Scene { path, source })?;
    }
    // What was reached is of use even if the end was not.
    let written = write(args, &targets, &outcome, seen.as_ref());
    match (outcome.failure, written) {
        (None, written) => Ok(written?),
        (Some(failure), Ok(())) => Err(failure.into()),
        (Some(failure), Err(error)) => {
            tell(&format!("error: {error}\n"))?;
            Err(failure.into())
        }
    }
}

/// Simulates, with a line of progress; Ctrl-C ends the simulation and not the command.
fn run(args: &Simulate, unpacked: &Path) -> Result<Outcome, CliError> {
    let pairs = args.start_value.chunks_exact(2);
    let experiment = Experiment {
        start_time: args.start_time,
        stop_time: args.stop_time,
        output_interval: args.output_interval,
        tolerance: args.tolerance,
        start_values: pairs.map(|p| (p[0].clone(), p[1].clone())).collect(),
        inputs: args.input_file.clone(),
        written: args.output_variables.clone(),
        slopes: args.set_input_derivatives,
        debug_logging: args.debug_logging,
    };
    #[cfg(unix)]
    crate::process::watch_end();
    let mut progress = Progress::new(!args.quiet);
    let outcome = run::simulate(unpacked, &experiment, &mut |time, times| {
        progress.at(time, times.start, times.stop);
        !see::ended()
    });
    #[cfg(unix)]
    crate::process::finish();
    progress.clear();
    let outcome = outcome?;
    if args.set_input_derivatives && !outcome.slopes && !args.quiet {
        tell(
            "note: --set-input-derivatives has no effect: the FMU takes no slopes of inputs, which FMI 3.0 \
             does not have, nor Model Exchange\n",
        )?;
    }
    Ok(outcome)
}

/// Writes the results and says what happened.
fn write(
    args: &Simulate,
    targets: &Targets,
    outcome: &Outcome,
    seen: Option<&Seen>,
) -> Result<(), OutputError> {
    let written = results(args, targets, outcome, seen);
    let told = outcome.messages.iter().try_for_each(|(status, message)| {
        let word = match status {
            0 => "note",
            1 => "warning",
            _ => "error",
        };
        tell(&format!("{word}: {message}\n"))
    });
    let summary = written?;
    told?;
    tell(&summary)
}

/// Writes the results; gives the summary, empty with `--quiet`.
fn results(
    args: &Simulate,
    targets: &Targets,
    outcome: &Outcome,
    seen: Option<&Seen>,
) -> Result<String, OutputError> {
    let shown = targets.page.is_some() || targets.plot.is_some();
    match &targets.table {
        None if shown => {}
        None => print(&outcome.table.to_text_of(&outcome.written))?,
        Some(target) => target.write(outcome.table.to_text_of(&outcome.written).as_bytes())?,
    }
    let table = Table::of(&outcome.table.names, &outcome.table.rows);
    if let Some(target) = &targets.plot {
        let picture = picture(args, outcome, &table, seen);
        if let Some(note) = picture.note {
            tell(&format!("note: {note}\n"))?;
        }
        target.write(picture.svg.as_bytes())?;
    }
    let changed = &outcome.started;
    let timed = std::io::stderr().is_terminal();
    let hint = seen.filter(|_| timed && !args.quiet);
    let hint = hint.and_then(|seen| costs(outcome, &table, seen, changed).hint());
    let events = match (&targets.page, seen) {
        (Some(target), Some(seen)) => {
            let table = table.named(&seen.scene);
            Some(see::write(target, seen, table, changed)?)
        }
        (None, Some(seen)) if !args.quiet => {
            let Table { time, columns, .. } = &table;
            Some(events::find(&seen.scene, time, columns, changed))
        }
        _ => None,
    };
    if args.quiet {
        return Ok(String::new());
    }
    let ended = Ended {
        name: &name(args, seen),
        outcome,
        events: events.as_deref(),
    };
    let hint = hint.map(|hint| run_summary::hint(&hint));
    Ok(run_summary::text(&ended, timed) + &hint.unwrap_or_default())
}

/// The robot's name, or the file's.
fn name(args: &Simulate, seen: Option<&Seen>) -> String {
    seen.map_or_else(
        || stem(&args.file).to_string_lossy().into_owned(),
        |seen| seen.scene.head.robot.clone(),
    )
}

/// Curves of what was asked for, or of what says most about a robot.
fn picture(args: &Simulate, outcome: &Outcome, table: &Table, seen: Option<&Seen>) -> plot::Plot {
    let undecided = seen.filter(|_| args.output_variables.is_empty());
    let chosen = if let Some(seen) = undecided {
        plot::defaults(&seen.scene.head, &table.columns)
    } else {
        let written = outcome.written.iter().skip(1);
        written.map(|&i| outcome.table.names[i].clone()).collect()
    };
    let curves: Vec<Curve> = (0..table.columns.len())
        .filter(|&i| chosen.contains(&table.columns[i].0))
        .map(|i| Curve {
            name: &table.columns[i].0,
            unit: &outcome.units[i + 1],
            stepped: outcome.discrete[i + 1],
            values: &table.columns[i].1,
        })
        .collect();
    plot::svg(&name(args, seen), &table.time, &curves)
}

/// What the run cost.
fn costs<'c>(
    outcome: &'c Outcome,
    table: &'c Table,
    seen: &'c Seen,
    changed: &BTreeMap<String, f64>,
) -> Costs<'c> {
    let head = &seen.scene.head;
    let column = |name: &str| {
        let flat = name.replace('.', "_");
        let mut columns = table.columns.iter();
        let column = columns.find(|(other, _)| other == name || *other == flat);
        column.map(|(_, values)| values.as_slice())
    };
    // Zero stands for no value of its own.
    let setting = |name: &str| {
        let flat = name.replace('.', "_");
        let changed = changed.get(name).or_else(|| changed.get(&flat)).copied();
        let start = || {
            let mut variables = head.variables.iter();
            let variable = variables.find(|v| v.name == name || v.name == flat);
            variable.and_then(|v| v.start)
        };
        changed.or_else(start).filter(|x| *x > 0.0)
    };
    let steps = column("solver.steps").zip(column("solver.rejected"));
    let contacts = head.contacts.iter().filter_map(|contact| {
        let link = head.links.get(contact.link)?;
        Some(Touching {
            link: &link.name,
            corners: corners(head, contact.link),
            active: column(&contact.active)?,
        })
    });
    Costs {
        time: &table.time,
        took: &outcome.took,
        steps: steps.map(|(accepted, rejected)| [accepted, rejected]),
        contacts: contacts.collect(),
        step_size: setting("solver.step_size").unwrap_or_default(),
        tolerance: setting("solver.tolerance")
            .or(outcome.tolerance)
            .unwrap_or(TOLERANCE),
    }
}

/// Corners of a link's collision meshes.
fn corners(head: &Head, link: usize) -> usize {
    let solids = head.collisions.iter().filter(|solid| solid.link == link);
    solids
        .filter_map(|solid| match solid.shape {
            Shape::Mesh(mesh) => head.meshes.get(mesh),
            _ => None,
        })
        .map(|mesh| mesh.vertices)
        .sum()
}
