//! What is asked of `expand` and `explain`.

use super::values::{folder, package, xacro_argument};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Expand {
    /// The file in xacro
    #[arg(value_name = "ROBOT.xacro")]
    pub(crate) file: PathBuf,
    /// Folder to look in for `$(find …)`; may be repeated
    #[arg(long = "package-path", value_name = "DIR", value_parser = folder)]
    pub(crate) package_paths: Vec<PathBuf>,
    /// Folder of one package; may be repeated
    #[arg(long = "package", value_name = "NAME=DIR", value_parser = package)]
    pub(crate) packages: Vec<(String, PathBuf)>,
    /// Where it goes [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Its arguments
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    pub(crate) xacro_arguments: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Explain {
    /// Such as U063; without it all are listed
    #[arg(value_name = "CODE")]
    pub(crate) code: Option<String>,
}
