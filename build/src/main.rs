//! The `urdf2fmu` command turns a URDF robot into a Functional Mock-up Unit.
//!
//! `main` only prints errors and maps them to exit codes; [`cli`] defines the options, [`commands`]
//! executes them, [`stage`] makes the FMU. Two modules have unsafe code: `importer::library`, which
//! calls the C functions of an FMU, and `process`, which asks the system for the standard streams
//! before `main`.
#![deny(unsafe_code)]

mod archive;
mod cli;
mod columns;
mod commands;
mod cost;
mod date;
mod describe;
mod diagnostics;
mod documentation;
mod events;
mod identifier;
mod importer;
mod info;
mod init;
mod kind;
mod library;
mod license;
mod listing;
mod output;
mod page;
mod plot;
#[cfg(unix)]
mod process;
mod progress;
mod related;
mod report;
mod results;
mod run_summary;
mod sources;
mod ssv;
mod stage;
mod structure;
mod summary;
mod terrain;
mod units;
mod view;
mod world;
mod xacro;

use crate::commands::CliError;
use crate::diagnostics::Style;
use clap::Parser;
use std::process::ExitCode;
use urdf2fmu_core::diagnostic::Severity;

/// Exit code where an answer could not be written.
const UNWRITTEN: u8 = 1;

fn main() -> ExitCode {
    let ended = match cli::Cli::try_parse() {
        Ok(cli) => commands::run(&cli),
        Err(answer) => return usage(&cli::instead(answer)),
    };
    let Err(error) = ended else {
        return ExitCode::SUCCESS;
    };
    #[cfg(unix)]
    process::leave_to_signal();
    // A standard error that cannot be written changes no exit code: it is not 0 already.
    if let CliError::Findings { findings, .. } = &error {
        _ = commands::print_findings(findings, Severity::Note);
    }
    _ = output::tell(&format!("error: {error}\n"));
    ExitCode::from(error.exit_code())
}

/// Prints help, version or the error of the command line.
fn usage(answer: &clap::Error) -> ExitCode {
    let text = |style: Style| {
        if style.color() {
            answer.render().ansi().to_string()
        } else {
            answer.render().to_string()
        }
    };
    if answer.use_stderr() {
        _ = output::tell(&text(Style::of_stderr()));
        return ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(2));
    }
    match output::print(&text(Style::of_stdout())) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            _ = output::tell(&format!("error: {error}\n"));
            ExitCode::from(UNWRITTEN)
        }
    }
}
