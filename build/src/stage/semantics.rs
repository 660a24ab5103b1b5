//! The SRDF of a robot: as it is, or expanded from xacro.

use super::Request;
use crate::xacro;
use std::path::{Path, PathBuf};
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::urdf::{self, Description, ReadOptions, Semantics};

/// What an SRDF says, and what it was expanded to.
pub(super) struct Read {
    pub(super) semantics: Semantics,
    pub(super) expanded: Option<(PathBuf, String)>,
}

/// Reads the SRDF in `path`. An argument of xacro may be meant for it or for the robot alone: that
/// nobody asks for it is told where neither does, in `others`, the robot's findings.
///
/// # Errors
/// All that is wrong with it.
pub(super) fn read(
    path: &Path,
    request: &Request,
    options: &ReadOptions,
    robot: &Description,
    others: &mut Vec<Diagnostic>,
) -> Result<Read, Vec<Diagnostic>> {
    let state = request.initial_state.as_deref();
    if !xacro::is_xacro(path) {
        let semantics = urdf::read_srdf(path, state, robot)?;
        let expanded = None;
        return Ok(Read {
            semantics,
            expanded,
        });
    }
    let expanded = xacro::expand(path, &request.xacro_arguments, options);
    let name = path.display().to_string();
    let mut expanded = expanded.map_err(|refused| {
        let mut findings = refused.findings;
        // Where arguments stand in the call of this program.
        let [own, robot] = [
            format!("after the file: {name} "),
            format!("after the robot's file: {} ", request.urdf.display()),
        ];
        for help in findings
            .iter_mut()
            .filter_map(|finding| finding.help.as_mut())
        {
            *help = help.replace(&own, &robot);
        }
        findings
    })?;
    if xacro::is_xacro(&request.urdf) {
        let unasked = |finding: &Diagnostic| finding.code == "U006";
        let notes = &expanded.notes;
        others.retain(|finding| !unasked(finding) || notes.contains(finding));
        expanded.notes.retain(|finding| !unasked(finding));
    }
    let tell = |mut findings: Vec<Diagnostic>| {
        if let Some(origins) = &expanded.origins {
            origins.tell(&name, &mut findings);
        }
        let mut all = expanded.notes.clone();
        all.append(&mut findings);
        all
    };
    let read = urdf::read_srdf_str(&expanded.text, &name, state, robot);
    let mut semantics = read.map_err(tell)?;
    semantics.diagnostics = tell(std::mem::take(&mut semantics.diagnostics));
    let nothing = semantics.states.is_empty()
        && semantics.disabled_pairs.is_empty()
        && semantics.passive.is_empty()
        && semantics.virtual_joint.is_none();
    if let Some(lone) = expanded.lone.filter(|_| nothing) {
        semantics.diagnostics.push(Diagnostic {
            severity: Severity::Warning,
            code: "R101",
            message: format!("{name} only defines macros for other files: nothing is read from it"),
            ..*lone
        });
    }
    Ok(Read {
        semantics,
        expanded: Some((path.to_owned(), expanded.text)),
    })
}
