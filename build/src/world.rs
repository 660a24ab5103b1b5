//! Files of the world: the robot's, and those of further robots and objects.

use crate::kind::no_object;
use crate::{terrain, xacro};
use std::path::{Path, PathBuf};
use urdf2fmu_core::assemble::{self, Guest};
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity};
use urdf2fmu_core::folder;
use urdf2fmu_core::model::{JointKind, RootKind};
use urdf2fmu_core::settings::{
    BaseChoice, ObjectSettings, ObjectSource, RobotSettings, Settings, is_taken,
};
use urdf2fmu_core::urdf::{self, Description, ReadOptions};

/// What stands around the robot.
#[derive(Debug, Default)]
pub struct Surroundings {
    /// In the order of the settings: robots, then objects.
    pub guests: Vec<Guest>,
    /// Notes and warnings.
    pub diagnostics: Vec<Diagnostic>,
    /// Files that they were read from.
    pub sources: Vec<PathBuf>,
    /// What xacro files expand to.
    pub expanded: Vec<(PathBuf, String)>,
}

/// What stands around a robot where some of it cannot be read.
#[derive(Debug, Default)]
pub struct Unread {
    /// Everything that is wrong with any of it, and the findings before.
    pub findings: Vec<Diagnostic>,
    /// What can be read.
    pub guests: Vec<Guest>,
    /// Names of the rest; none where one of them is not known.
    pub lost: Option<Vec<String>>,
}

/// Where packages are looked for before the places that the environment names.
#[derive(Clone, Debug, Default)]
pub struct Packages {
    /// Folders of packages.
    pub paths: Vec<PathBuf>,
    /// Packages by their names.
    pub named: Vec<(String, PathBuf)>,
}

/// What all files are read with: folders of packages, and that everything is drawn.
pub fn options(settings: &Settings, packages: &Packages) -> ReadOptions {
    let mut options = assemble::read_options(settings, ReadOptions::from_environment());
    options.drawn = true;
    options
        .package_paths
        .splice(0..0, packages.paths.iter().cloned());
    options.packages.clone_from(&packages.named);
    options
}

/// Reads a URDF, or what xacro makes of the file, which is the text returned.
///
/// # Errors
/// Everything that is wrong with the file.
pub fn read(
    path: &Path,
    arguments: &[String],
    options: &ReadOptions,
) -> Result<(Description, Option<String>), Vec<Diagnostic>> {
    if !xacro::is_xacro(path) {
        if let Some(argument) = arguments.first() {
            return Err(vec![Diagnostic {
                severity: Severity::Error,
                code: "U006",
                message: format!(
                    "'{argument}' is an argument of xacro, '{}' is no xacro file",
                    path.display()
                ),
                help: Some("leave it out, or give the .xacro file".to_owned()),
                place: None,
            }]);
        }
        return urdf::read(path, options).map(|description| (description, None));
    }
    let folder = folder::of(path);
    let name = path.display().to_string();
    let xacro::Expanded {
        text,
        mut notes,
        packages,
        origins,
        lone,
    } = match xacro::expand(path, arguments, options) {
        Ok(expanded) => expanded,
        Err(refused) => return Err(unexpanded(*refused, &name, folder, options)),
    };
    if let Some(lone) = lone {
        notes.push(*lone);
        return Err(notes);
    }
    let mut options = options.clone();
    options.packages.extend(packages);
    let tell = |findings: &mut [Diagnostic]| {
        if let Some(origins) = &origins {
            origins.tell(&name, findings);
        }
    };
    match urdf::read_str(&text, &name, folder, &options) {
        Ok(mut description) => {
            description.sources.insert(0, path.to_owned());
            tell(&mut description.diagnostics);
            description.diagnostics.splice(0..0, notes);
            Ok((description, Some(text)))
        }
        Err(mut findings) => {
            xacro::name_includers(path, &mut findings);
            tell(&mut findings);
            findings.splice(0..0, notes);
            Err(findings)
        }
    }
}

/// Findings about trees and masses, which what is left out may explain.
const OF_ALL: [&str; 9] = [
    "U010", "U011", "U012", "U013", "U014", "U016", "U021", "U046", "U047",
];

/// Elements by which links have mass.
const OF_MASS: [&str; 4] = ["link", "inertial", "mass", "inertia"];

/// What is wrong with a file in xacro that cannot be expanded: of the part that can be, too. What
/// may follow from what is left out is told as such.
fn unexpanded(
    refused: xacro::Refused,
    name: &str,
    folder: &Path,
    options: &ReadOptions,
) -> Vec<Diagnostic> {
    let mut findings = refused.findings;
    let Some(rest) = refused.rest else {
        return findings;
    };
    let mut options = options.clone();
    options.packages.extend(rest.packages);
    let weighed = rest.whole
        && !rest
            .faulty
            .values()
            .any(|name| OF_MASS.contains(&name.as_str()));
    let told = |mut finding: Diagnostic| {
        let line = finding.place.as_ref().map(|place| place.line);
        let of_faulty = line.is_some_and(|line| rest.faulty.contains_key(&line));
        match finding.severity {
            // U066 tells what would come next.
            Severity::Warning if finding.code == "U066" && weighed => Some(finding),
            Severity::Warning if finding.code == "U068" => Some(finding),
            Severity::Error if of_faulty => None,
            Severity::Error if !rest.whole && OF_ALL.contains(&finding.code) => {
                may_follow(&mut finding);
                Some(finding)
            }
            Severity::Error => Some(finding),
            Severity::Warning | Severity::Note => None,
        }
    };
    let more = urdf::read_str(&rest.text, name, folder, &options);
    let more = more.err().unwrap_or_default();
    let mut more: Vec<Diagnostic> = more.into_iter().filter_map(told).collect();
    if !more.is_empty() || rest.foreseen {
        rest.origins.tell(name, &mut more);
        findings.push(rest.note);
        findings.append(&mut more);
    }
    findings
}

/// Makes an error what may be wrong, too, or follow from another one.
pub fn may_follow(finding: &mut Diagnostic) {
    (finding.severity, finding.code) = (Severity::Warning, "U068");
}

/// What can be read of a file that is refused.
pub struct Rest {
    /// What is read.
    pub description: Description,
    /// Whether it has all its names.
    pub whole: bool,
    /// Whether it is in xacro, and what is proposed makes it a robot that can be read.
    pub sound: bool,
}

/// What can be read of a file, whatever is wrong with it.
pub fn rest(path: &Path, arguments: &[String], options: &ReadOptions) -> Option<Rest> {
    let mut options = ReadOptions {
        rest: true,
        drawn: false,
        ..options.clone()
    };
    if !xacro::is_xacro(path) {
        let description = urdf::read(path, &options).ok()?;
        return Some(Rest {
            description,
            whole: true,
            sound: false,
        });
    }
    let (text, packages, whole, mut sound) = match xacro::expand(path, arguments, &options) {
        Ok(expanded) => (expanded.text, expanded.packages, true, false),
        Err(refused) => {
            let rest = refused.rest?;
            let sound = rest.whole && rest.faulty.is_empty();
            (rest.text, rest.packages, rest.whole, sound)
        }
    };
    options.packages.extend(packages);
    let name = path.display().to_string();
    let read = |options| urdf::read_str(&text, &name, folder::of(path), options);
    let all = ReadOptions {
        rest: false,
        ..options.clone()
    };
    sound = sound && read(&all).is_ok();
    let description = read(&options).ok()?;
    Some(Rest {
        description,
        whole,
        sound,
    })
}

/// Reads all that the settings place around the robot. An object that is nothing but a ground
/// becomes that of the settings.
///
/// # Errors
/// [`Unread`].
pub fn surroundings(settings: &mut Settings, packages: &Packages) -> Result<Surroundings, Unread> {
    let mut around = Surroundings::default();
    let mut names: Vec<String> = settings
        .robots
        .iter()
        .map(|r| r.name.text.clone())
        .collect();
    let given = settings.objects.iter().filter_map(|o| o.name.as_ref());
    names.extend(given.map(|name| name.text.clone()));

    // The ground comes first, so that all stand on the same one.
    let mut objects = Vec::new();
    let (mut failed, mut lost) = (false, Some(Vec::new()));
    for object in settings.objects.clone() {
        let Some(description) = around.object(&object, settings, packages) else {
            failed = true;
            // Without a name of its own it has that of its robot.
            lost = lost.zip(object.name).map(|(mut lost, name)| {
                lost.push(name.text);
                lost
            });
            continue;
        };
        let name = if let Some(name) = &object.name {
            name.text.clone()
        } else {
            let name = free_name(&description.name, &names);
            names.push(name.clone());
            name
        };
        match assemble::take_ground(&name, &object, &description, settings) {
            Some(note) => around.diagnostics.push(note),
            None => objects.push((name, object, description)),
        }
    }
    for robot in settings.robots.clone() {
        if let Some((own, description)) = around.robot(&robot, settings, packages) {
            around.guests.push(Guest {
                name: robot.name.text,
                kind: RootKind::Robot,
                description,
                settings: own,
            });
        } else {
            failed = true;
            lost = lost.map(|mut lost| {
                lost.push(robot.name.text);
                lost
            });
        }
    }
    for (name, object, description) in objects {
        around.guests.push(Guest {
            name,
            kind: RootKind::Object,
            settings: assemble::of_object(&object, settings),
            description,
        });
    }
    if failed {
        return Err(Unread {
            findings: around.diagnostics,
            guests: around.guests,
            lost,
        });
    }
    Ok(around)
}

/// The name of a robot without its file's ending, with a number where it is taken.
pub fn free_name(name: &str, taken: &[String]) -> String {
    let name = name.trim();
    let name = name.strip_suffix(".urdf").unwrap_or(name);
    let name = if name.is_empty() { "thing" } else { name };
    let taken = |name: &str| is_taken(name, taken.iter().map(String::as_str));
    if !taken(name) {
        return name.to_owned();
    }
    let numbered = (2..).map(|n| format!("{name}{n}"));
    numbered
        .into_iter()
        .find(|name| !taken(name))
        .unwrap_or_default()
}

/// Gives findings without a place of their own that of the key that names their file.
///
/// - `which`: those that are about the file as a whole
fn placed(findings: &mut [Diagnostic], which: fn(&Diagnostic) -> bool, place: Option<&Place>) {
    for finding in findings.iter_mut().filter(|finding| which(finding)) {
        finding.place = finding.place.take().or(place.cloned());
    }
}

impl Surroundings {
    /// Gives all links that can move the inputs of `settings` for forces from outside.
    pub fn push(&mut self, settings: &Settings) {
        for guest in &mut self.guests {
            let Description { links, joints, .. } = &guest.description;
            let heavy = links
                .iter()
                .any(|link| link.inertial.is_some_and(|i| i.mass > 0.0));
            let floats = heavy && guest.settings.base != BaseChoice::Fixed;
            if floats || joints.iter().any(|joint| joint.kind != JointKind::Fixed) {
                let wrenches = &mut guest.settings.external_wrenches;
                wrenches.clone_from(&settings.external_wrenches);
            }
        }
    }

    fn tell(&mut self, findings: Vec<Diagnostic>) {
        for finding in findings {
            // Two objects of one file have the same findings.
            if !self.diagnostics.contains(&finding) {
                self.diagnostics.push(finding);
            }
        }
    }

    /// None after an error was told.
    ///
    /// - `place`: where the file is named
    fn urdf(
        &mut self,
        path: &Path,
        options: &ReadOptions,
        place: Option<&Place>,
    ) -> Option<Description> {
        if let Some(kind) = no_object(path) {
            self.tell(vec![Diagnostic {
                severity: Severity::Error,
                code: "U007",
                message: format!("'{}' is {kind}", path.display()),
                help: None,
                place: place.cloned(),
            }]);
            return None;
        }
        match read(path, &[], options) {
            Ok((description, expanded)) => {
                self.tell(description.diagnostics.clone());
                for source in &description.sources {
                    self.source(source);
                }
                if let Some(text) = expanded {
                    self.expanded.push((path.to_owned(), text));
                }
                Some(description)
            }
            Err(mut findings) => {
                placed(&mut findings, |finding| finding.code == "U001", place);
                self.tell(findings);
                None
            }
        }
    }

    fn source(&mut self, path: &Path) {
        if !self.sources.iter().any(|known| known == path) {
            self.sources.push(path.to_owned());
        }
    }

    fn object(
        &mut self,
        object: &ObjectSettings,
        world: &Settings,
        packages: &Packages,
    ) -> Option<Description> {
        match &object.source {
            ObjectSource::Urdf(path) => {
                let options = options(&assemble::of_object(object, world), packages);
                self.urdf(path, &options, object.file_place.as_ref())
            }
            ObjectSource::Solid { shape, mass } => {
                if let Some(place) = &object.idle_mass {
                    let why = if object.driven { "driven" } else { "static" };
                    self.tell(vec![Diagnostic {
                        severity: Severity::Note,
                        code: "S106",
                        message: format!(
                            "the mass of '{}' changes nothing: it is {why}, so that no force moves it",
                            object.called()
                        ),
                        help: Some(format!("leave one of mass and {why} out")),
                        place: Some(place.clone()),
                    }]);
                }
                Some(assemble::solid(object.called(), shape, *mass))
            }
            ObjectSource::Terrain(settings) => {
                let place = object.place.as_ref();
                let of_file = object.file_place.as_ref().or(place);
                match terrain::shape(object.called(), settings, of_file) {
                    Ok((shape, files, notes)) => {
                        for file in &files {
                            self.source(file);
                        }
                        self.tell(notes);
                        let rpy = &object.initial.rpy;
                        self.tell(terrain::findings(object.called(), &shape, rpy, place));
                        Some(assemble::solid(object.called(), &shape, 0.0))
                    }
                    Err(finding) => {
                        self.tell(vec![*finding]);
                        None
                    }
                }
            }
        }
    }

    fn robot(
        &mut self,
        robot: &RobotSettings,
        world: &Settings,
        packages: &Packages,
    ) -> Option<(Settings, Description)> {
        let own = match &robot.config {
            Some(path) => {
                self.source(path);
                let read = Settings::read_as(path, Some(world.compat));
                read.map_err(|mut findings| {
                    let place = &robot.config_place;
                    placed(
                        &mut findings,
                        |finding| finding.place.is_none(),
                        place.as_ref(),
                    );
                    findings
                })
            }
            None => Ok(Settings::of(world.compat)),
        };
        let own = own.and_then(|own| assemble::of_robot(robot, own, world));
        match own {
            Ok(own) => {
                let description = self.urdf(
                    &robot.urdf,
                    &options(&own, packages),
                    robot.urdf_place.as_ref(),
                )?;
                Some((own, description))
            }
            Err(findings) => {
                self.tell(findings);
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_gets_the_name_of_its_robot_and_a_number_where_that_is_taken() {
        let taken = ["cube".to_owned(), "cube2".to_owned()];
        assert_eq!(free_name("cube.urdf", &taken), "cube3");
        assert_eq!(free_name("duck", &taken), "duck");
        // The name of a group of variables.
        assert_eq!(free_name("object", &[]), "object2");
        assert_eq!(free_name(" ", &[]), "thing");
    }
}
