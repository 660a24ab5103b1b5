//! Faults that would be told only once those before them are mended.
//!
//! A robot goes from file to file and from check to check, and an error ends the way. So that one
//! run tells all that it can, what is left after an error goes on, and of what is found then the
//! errors are told that do not follow from the first ones: those of names. What is missing is not
//! taken for a fault: masses, shapes and limits may hang on what is wrong before.

use super::{Request, semantics};
use crate::world::{self, Packages, Unread};
use urdf2fmu_core::assemble::{self, Guest};
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::pattern::Pattern;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::urdf::{Description, ReadOptions};
use urdf2fmu_core::variables;

/// Errors of the assembly that are about names or about the settings alone, whatever else is wrong.
const OF_NAMES: [&str; 11] = [
    "A101", "A102", "A103", "A106", "A125", "A130", "A131", "A133", "A137", "A139", "A140",
];

/// The error of a loop that cannot be closed.
const OF_LOOPS: &str = "A141";

/// Errors of meshes alone.
const OF_MESHES: [&str; 6] = ["U104", "U105", "U106", "U107", "U112", "U115"];

/// Errors that settings can mend: those of masses and inertias.
const OF_MASSES: [&str; 3] = ["U06", "A104", "A105"];

/// Words of the settings that mend them.
const MENDING: [&str; 4] = ["inertia", "density", "missing_mass", "compat"];

/// Of a robot's findings what does not follow from faults of its settings.
pub(super) fn beside_settings(
    settings: &[Diagnostic],
    mut more: Vec<Diagnostic>,
) -> Vec<Diagnostic> {
    let unread = settings.iter().any(|finding| finding.code == "S108");
    let syntax = settings.iter().any(|finding| finding.code == "S101");
    let mending = settings.iter().any(|finding| {
        let line = finding.place.as_ref().map(|place| place.text.as_str());
        // Keys that a finding lists are not those that were meant.
        let help = finding.help.as_deref().and_then(|h| h.split('?').next());
        let texts = [line, Some(finding.message.as_str()), help];
        let mut texts = texts.into_iter().flatten();
        texts.any(|text| MENDING.iter().any(|word| text.contains(word)))
    });
    let holds = |finding: &Diagnostic| {
        let of_masses = OF_MASSES.iter().any(|code| finding.code.starts_with(code));
        let of_file = finding.code.starts_with('U') || OF_NAMES.contains(&finding.code);
        is_error(finding)
            && if of_masses {
                !(mending || unread)
            } else {
                of_file || !(unread || syntax)
            }
    };
    let counts = |finding: &Diagnostic| is_error(finding) || finding.code == "U068";
    more.retain(|finding| counts(finding) && !settings.contains(finding));
    for finding in more.iter_mut().filter(|finding| !holds(finding)) {
        world::may_follow(finding);
    }
    more
}

/// What else is wrong with a robot whose file has errors: with its names, its SRDF, and what is
/// around it.
///
/// - `findings`: of its file
pub(super) fn beside_robot(
    request: &Request,
    settings: &Settings,
    options: &ReadOptions,
    findings: &[Diagnostic],
) -> Vec<Diagnostic> {
    let read = world::rest(&request.urdf, request.arguments_of_robot(), options);
    let mut settings = settings.clone();
    let (guests, mut list) = around(&mut settings, &request.packages);
    list.retain(|finding| is_error(finding) || finding.code == "U068");
    let Some(world::Rest {
        description,
        whole,
        sound: is_sound,
    }) = read
    else {
        return list;
    };
    if let Some(path) = &request.srdf {
        let read = semantics::read(path, request, options, &description, &mut Vec::new());
        list.extend(read.err().into_iter().flatten().filter(is_error));
    }
    // Shapes may be left out.
    let of_shapes = |finding: &Diagnostic| finding.message.contains("no collision shape");
    if is_sound {
        list.extend(sound(&description, &settings, &guests));
        return list;
    }
    let mut names = of(&description, &settings, &guests);
    // Where the joints are does not depend on meshes.
    let mut errors = findings.iter().filter(|finding| is_error(finding));
    if !errors.all(|error| OF_MESHES.contains(&error.code)) {
        names.retain(|name| name.code != OF_LOOPS);
    }
    names.retain(|name| !of_shapes(name));
    if !whole {
        names.iter_mut().for_each(world::may_follow);
    }
    list.extend(names);
    list
}

/// What can be read of all that is around a robot, and what is wrong with the rest. The settings
/// are then without what names that.
pub(super) fn around(
    settings: &mut Settings,
    packages: &Packages,
) -> (Vec<Guest>, Vec<Diagnostic>) {
    match world::surroundings(settings, packages) {
        Ok(around) => (around.guests, Vec::new()),
        Err(unread) => {
            *settings = known(settings, &unread);
            (unread.guests, unread.findings)
        }
    }
}

/// Settings of what can be read of a world: without what names the rest, or may name it.
pub(super) fn known(settings: &Settings, unread: &Unread) -> Settings {
    let mut known = alone(settings);
    known.robots.clear();
    known.objects.clear();
    let Some(lost) = &unread.lost else {
        return known;
    };
    let sound = |name: &&Pattern| {
        let first = name.text.split('.').next().unwrap_or_default();
        !first.contains(['*', '?', '[']) && !lost.iter().any(|lost| lost == first)
    };
    let pairs = settings.pairs.iter();
    let of_known = pairs.filter(|pair| pair.sides.iter().flatten().all(|name| sound(&name)));
    known.pairs = of_known.cloned().collect();
    let loops = settings.loops.iter();
    let of_known = loops.filter(|closed| closed.kind.names().iter().all(sound));
    known.loops = of_known.cloned().collect();
    let springs = settings.springs.iter();
    let of_known = springs.filter(|spring| spring.links.iter().all(|name| sound(&name)));
    known.springs = of_known.cloned().collect();
    known
}

/// Makes one warning of all that may be wrong, too, or follow from the errors.
pub(super) fn gather(findings: &mut Vec<Diagnostic>) {
    /// More are counted.
    const MOST: usize = 20;
    let may = findings.extract_if(.., |finding| finding.code == "U068");
    let mut may: Vec<Diagnostic> = may.collect();
    may.dedup();
    let mut lines: Vec<String> = may
        .iter()
        .map(|finding| {
            let place = finding.place.as_ref();
            let place = place.map_or(String::new(), |place| {
                format!("{}:{}: ", place.file, place.line)
            });
            let advice = finding
                .help
                .as_deref()
                .filter(|help| help.starts_with("did you mean"));
            let advice = advice.map_or(String::new(), |advice| format!(" ({advice})"));
            format!("{place}{}{advice}", finding.message)
        })
        .collect();
    let Some(first) = may.into_iter().next() else {
        return;
    };
    if lines.len() > MOST {
        let more = lines.len() - MOST;
        lines.truncate(MOST);
        lines.push(format!("and {more} more"));
    }
    let count = lines.len();
    findings.push(Diagnostic {
        message: "this may be wrong, too, if it does not follow from the errors".to_owned(),
        help: Some(lines.join("\n")),
        place: if count == 1 { first.place } else { None },
        ..first
    });
}

fn is_error(finding: &Diagnostic) -> bool {
    finding.severity == Severity::Error
}

/// Errors of a robot whose own file has none.
///
/// - `guests`: all that are around it, or none of them where that is not known
pub(super) fn sound(
    description: &Description,
    settings: &Settings,
    guests: &[Guest],
) -> Vec<Diagnostic> {
    let built = if guests.is_empty() {
        assemble::build(description, &alone(settings))
    } else {
        assemble::world(description, settings, guests)
    };
    let mut list: Vec<Diagnostic> = built.err().unwrap_or_default();
    list.retain(is_error);
    list.extend(clashes(description, settings));
    list
}

/// What is wrong with the names and loops in a robot and its settings.
///
/// - `guests`: all that are around it, or none of them where that is not known
pub(super) fn of(
    description: &Description,
    settings: &Settings,
    guests: &[Guest],
) -> Vec<Diagnostic> {
    let findings = if guests.is_empty() {
        assemble::inspect(description, &alone(settings)).1
    } else {
        let world = assemble::world(description, settings, guests);
        world.map_or_else(|findings| findings, |world| world.diagnostics)
    };
    // A base may be fixed for what is wrong before.
    let of_base = |finding: &Diagnostic| {
        finding.code == "A106" && finding.message.starts_with("a fixed base")
    };
    let told = |finding: &Diagnostic| {
        let code = finding.code;
        is_error(finding) && (OF_NAMES.contains(&code) || code == OF_LOOPS) && !of_base(finding)
    };
    let mut list: Vec<Diagnostic> = findings.into_iter().filter(told).collect();
    list.extend(clashes(description, settings));
    list
}

/// Names that become one.
pub(super) fn clashes(description: &Description, settings: &Settings) -> Vec<Diagnostic> {
    let (model, _) = assemble::inspect(description, &alone(settings));
    let clashes = model.as_ref().map(variables::clashes).unwrap_or_default();
    let told = |error| crate::diagnostics::clash(description, error);
    clashes.iter().map(told).collect()
}

/// Settings without what names other trees of the world.
fn alone(settings: &Settings) -> Settings {
    let mut alone = settings.clone();
    if !(alone.robots.is_empty() && alone.objects.is_empty()) {
        alone.pairs.clear();
        alone.loops.clear();
        alone.springs.clear();
        alone.closure_outputs = [Vec::new(), Vec::new()];
    }
    alone
}
