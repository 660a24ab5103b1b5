//! The `urdf2fmu` command: any URDF robot in, a Functional Mock-up Unit out.
//!
//! `main` only prints errors and maps them to exit codes; [`cli`] says what can be asked for, [`stage`] makes the FMU.
//! The one module with unsafe code is `importer::library`, which calls the C functions of an FMU.
#![deny(unsafe_code)]

mod archive;
mod cli;
mod columns;
mod describe;
mod diagnostics;
mod documentation;
mod identifier;
mod importer;
mod info;
mod init;
mod library;
mod license;
mod sources;
mod stage;
mod structure;
mod summary;

mod units;
mod xacro;

use clap::Parser;
use std::process::ExitCode;
use urdf2fmu_core::urdf::Severity;

#[allow(clippy::print_stderr, reason = "a command prints")]
fn main() -> ExitCode {
    let Err(error) = cli::Cli::parse().run() else {
        return ExitCode::SUCCESS;
    };
    if let cli::CliError::Findings { findings, .. } = &error {
        cli::print_findings(findings, Severity::Note);
    }
    eprintln!("error: {error}");
    ExitCode::from(error.exit_code())
}
