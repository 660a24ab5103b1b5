//! What is packed into an FMU beside the robot. Commands that make no FMU take these options, too,
//! so that what is written for `export` can be checked, listed and kept in settings.

use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Packing {
    /// Platforms that the FMU runs on, such as `linux64,win64` or `aarch64-linux` [default: all
    /// that this program carries]
    #[arg(long = "platform", value_name = "NAMES", value_delimiter = ',')]
    pub(crate) platforms: Vec<String>,
    /// Leave out pictures and pages for people, which take two thirds of the time of an export
    #[arg(long)]
    pub(crate) no_documentation: bool,
    /// Put in what the FMU gives in two seconds in which its commands rise, for whoever imports it
    #[arg(long)]
    pub(crate) reference_run: bool,
}

impl Packing {
    /// Names of the options that were given, as the user writes them.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        let Self {
            platforms,
            no_documentation,
            reference_run,
        } = self;
        let all = [
            ("--platform", !platforms.is_empty()),
            ("--no-documentation", *no_documentation),
            ("--reference-run", *reference_run),
        ];
        let given = all.iter().filter(|(_, given)| *given);
        given.map(|(name, _)| *name).collect()
    }
}
