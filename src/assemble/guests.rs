//! What is said of the other robots and objects of a world, in words of its settings.

use crate::diagnostic::{Diagnostic, Severity};
use crate::model::RootKind;

/// What a thing is called in a sentence.
pub(super) fn called(kind: RootKind, name: &str) -> String {
    match kind {
        RootKind::Robot => format!("robot '{name}'"),
        RootKind::Object => format!("object '{name}'"),
    }
}

/// A finding in a guest as it is told: it says whose it is, and advises what can be done in the
/// settings of the world. None for what goes without saying.
pub(super) fn told(mut finding: Diagnostic, kind: RootKind, name: &str) -> Option<Diagnostic> {
    // Gravity is the world's, and so is the mass that links of objects may lack: both have been
    // told of the robot.
    if finding.code == "A143" || kind == RootKind::Object && finding.code == "A144" {
        return None;
    }
    if kind == RootKind::Object {
        if finding.code == "A107" {
            if finding.message.starts_with("the base is floating") {
                return None;
            }
            // As scenery is meant.
            finding.severity = Severity::Note;
        }
        finding.help = match finding.code {
            "A107" if finding.message.contains("<static>") => {
                Some("leave <static> out of its file to let it move".to_owned())
            }
            "A107" => Some("static = true says so, a mass lets it move".to_owned()),
            "A111" => Some("give it a z to start elsewhere".to_owned()),
            "A116" => Some("set its friction in [[world.object]]".to_owned()),
            "A104" | "A105" => finding.help.map(|help| of_masses(&help)),
            _ => finding.help,
        };
    }
    // The place says whose it is.
    if finding.place.is_none() {
        let message = finding.message.replacen("the robot ", "it ", 1);
        finding.message = format!("{}: {message}", called(kind, name));
    }
    Some(finding)
}

/// Help on links of an object without inertia: a density is the robot's alone, because scenery has
/// none, and would fall.
fn of_masses(help: &str) -> String {
    let of_file = |line: &&str| !line.starts_with("without a change") && !line.starts_with("  ");
    let rest: Vec<&str> = help.lines().filter(of_file).collect();
    format!(
        "--missing-mass 0.1 gives 0.1 kg to each link that cannot move without\n{}",
        rest.join("\n")
    )
}

/// Help for a name that is none of the robot's links or joints, but something else's in the world.
///
/// - `guests`: what else there is
pub(super) fn of_guest<'g>(
    finding: &Diagnostic,
    mut guests: impl Iterator<Item = (RootKind, &'g str)>,
) -> Option<String> {
    let rest = finding.message.strip_prefix("no ")?;
    let (part, rest) = rest.split_once(" matches '")?;
    let (text, _) = rest.split_once('\'')?;
    if !["link", "joint"].contains(&part) {
        return None;
    }
    let holds = |(_, name): &(RootKind, &str)| {
        let rest = text.strip_prefix(name);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    let (kind, name) = guests.find(holds)?;
    Some(match kind {
        RootKind::Object => format!(
            "'{name}' is an object of the world, and this key takes {part}s of the robot; \
             [[world.robot]] reads a URDF with settings of its own, sensors among them"
        ),
        RootKind::Robot => {
            let own = text.strip_prefix(name).unwrap_or_default();
            let own = own.strip_prefix('.').unwrap_or("*");
            format!(
                "'{name}' is another robot of the world, and this key takes {part}s of the first one: \
                 write config = \"{name}.toml\" in its [[world.robot]], and there this table, with \
                 '{own}'"
            )
        }
    })
}
