//! From a URDF to everything that goes into an FMU.
//!
//! URDF → settings → description → model → prepared model → variable table → modelDescription.xml →
//! files of the zip. Each step stops at the first error; other findings are collected. The prepared
//! model is read back and simulated for one step before anything is written, so that the FMU loads
//! what was checked.

mod asked;
mod later;
mod semantics;
mod told;

pub use asked::Request;

use crate::archive::{Archive, ArchiveError};
use crate::describe::{self, DescribeError, Header};
use crate::documentation::{self, Page, Remark};
use crate::identifier::{guid, model_identifier};
use crate::library::{self, Binary, LibraryError};
use crate::output;
use crate::related::{self, RelatedError};
use crate::{date, license, listing, page, sources, world, xacro};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use urdf2fmu_core::assemble::{self, Guest};
use urdf2fmu_core::diagnostic::Diagnostic;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModel, PreparedModelError};
use urdf2fmu_core::reading;
use urdf2fmu_core::settings::{ActuatorSettings, FmiVersion, Mounting, Settings};
use urdf2fmu_core::simulation::{Simulation, SimulationError};
use urdf2fmu_core::urdf::Description;
use urdf2fmu_core::variables::{self, TableError, Variable};
use urdf2fmu_drawing::picture;
use urdf2fmu_drawing::scene::{self, Scene, SceneError};

/// A robot that is ready to simulate.
#[derive(Debug)]
pub struct Robot {
    /// As read.
    pub description: Description,
    /// What is around it.
    pub guests: Vec<Guest>,
    /// As prepared.
    pub model: Model,
    /// Every variable of its FMU.
    pub table: Vec<Variable>,
    /// What was assumed and what looks wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// Files that it was read from: the URDF, its meshes, then the settings and the SRDF, then
    /// those of what is around it.
    pub sources: Vec<PathBuf>,
    /// The settings among them, and where they would stand if names of files counted from there.
    pub settled: Option<(PathBuf, PathBuf)>,
    /// As asked for.
    pub settings: Settings,
    /// The URDFs that xacro files expand to, by these files.
    pub expanded: Vec<(PathBuf, String)>,
}

/// An FMU, not yet on disk.
#[derive(Debug)]
pub struct Fmu {
    /// The zip.
    pub bytes: Vec<u8>,
    /// `linux64`, `darwin64 (x86_64 and aarch64)` …
    pub platforms: Vec<String>,
}

/// What an FMU has beyond what it needs to run; one that is used at once does without.
#[derive(Debug, Default)]
pub struct Extras<'a> {
    /// All of the robot's files, also those that cannot be read a second time.
    pub kept: bool,
    /// Pictures and documentation.
    pub documented: bool,
    /// A reference run, which is made in this folder.
    pub reference_run: Option<&'a Path>,
}

/// Why no FMU could be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StageError {
    /// The robot's files or the settings; each finding has its place.
    #[error("the robot cannot be read")]
    Robot(Vec<Diagnostic>),
    /// Names clash.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The platforms.
    #[error(transparent)]
    Library(#[from] LibraryError),
    /// The prepared model.
    #[error(transparent)]
    Prepared(#[from] PreparedModelError),
    /// The trial step.
    #[error("the robot was read, but its first step fails: {0}")]
    Trial(#[from] SimulationError),
    /// The XML.
    #[error(transparent)]
    Describe(#[from] DescribeError),
    /// The scene.
    #[error("{FILE}: {0}", FILE = scene::FILE_NAME)]
    Scene(#[from] SceneError),
    /// The parameters and the reference run.
    #[error(transparent)]
    Related(#[from] RelatedError),
    /// The zip.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// A file that was there a moment ago.
    #[error("cannot read '{}' again, to put it into the FMU: {source}", path.display())]
    Source {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// Reads a robot and its settings.
///
/// # Errors
/// [`StageError::Robot`] with everything found so far, [`StageError::Table`].
pub fn robot(request: &Request) -> Result<Robot, StageError> {
    let (settings, mut findings) = asked::settings_of(request);
    if findings.is_empty() {
        return made(request, settings).map_err(|error| match error {
            StageError::Robot(mut findings) => {
                later::gather(&mut findings);
                StageError::Robot(findings)
            }
            other => other,
        });
    }
    if let Err(StageError::Robot(more)) = made(request, settings) {
        let more = later::beside_settings(&findings, more);
        findings.extend(more);
    }
    later::gather(&mut findings);
    Err(StageError::Robot(findings))
}

fn made(request: &Request, mut settings: Settings) -> Result<Robot, StageError> {
    let packages = &request.packages;
    let options = world::options(&settings, packages);
    let read = world::read(&request.urdf, request.arguments_of_robot(), &options);
    let (description, expanded) = read.map_err(|mut findings| {
        let more = later::beside_robot(request, &settings, &options, &findings);
        findings.extend(more);
        StageError::Robot(findings)
    })?;
    let mut diagnostics = description.diagnostics.clone();
    let own = expanded.map(|text| (request.urdf.clone(), text));
    let mut expanded: Vec<(PathBuf, String)> = own.into_iter().collect();
    if let Some(path) = &request.srdf {
        match semantics::read(path, request, &options, &description, &mut diagnostics) {
            Ok(read) => {
                let semantics = read.semantics;
                expanded.extend(read.expanded);
                diagnostics.extend(semantics.diagnostics);
                settings.initial.state = semantics.positions;
                let name = |link: usize| description.links[link].name.clone();
                let pairs = semantics.disabled_pairs.iter();
                settings.disabled_contacts = pairs.map(|pair| pair.map(name)).collect();
                settings.mounting = semantics.virtual_joint.map(|joint| Mounting {
                    name: joint.name,
                    frame: joint.frame,
                    fixed: joint.fixed,
                });
                // Whatever the settings say comes later, and wins.
                let passive = semantics.passive.into_iter().map(ActuatorSettings::passive);
                settings.actuators.splice(0..0, passive);
            }
            Err(findings) => {
                diagnostics.extend(findings);
                let (guests, others) = later::around(&mut settings, packages);
                diagnostics.extend(others);
                diagnostics.extend(later::sound(&description, &settings, &guests));
                return Err(StageError::Robot(diagnostics));
            }
        }
    }
    let mut failed = |errors: Vec<Diagnostic>| {
        diagnostics.extend(errors);
        StageError::Robot(std::mem::take(&mut diagnostics))
    };
    let around = world::surroundings(&mut settings, packages);
    let mut around = around.map_err(|unread| {
        let known = later::known(&settings, &unread);
        let mut findings = unread.findings;
        findings.extend(later::sound(&description, &known, &unread.guests));
        failed(findings)
    })?;
    if request.pushable {
        around.push(&settings);
    }
    let built = assemble::world(&description, &settings, &around.guests);
    let assembled = built.map_err(|mut findings| {
        findings.extend(later::clashes(&description, &settings));
        failed(findings)
    })?;
    diagnostics.extend(around.diagnostics);
    diagnostics.extend(assembled.diagnostics);
    let Ok(table) = variables::table(&assembled.model) else {
        let clashes = variables::clashes(&assembled.model);
        let told = clashes
            .iter()
            .map(|e| crate::diagnostics::clash(&description, e));
        diagnostics.extend(told);
        return Err(StageError::Robot(diagnostics));
    };
    let mut sources = description.sources.clone();
    sources.extend(request.config.clone());
    sources.extend(request.srdf.clone());
    for source in around.sources {
        if !sources.contains(&source) {
            sources.push(source);
        }
    }
    let config = request.config.as_ref();
    let moved = config.zip(request.config_folder.as_ref());
    let settled = moved.and_then(|(file, to)| Some((file.clone(), to.join(file.file_name()?))));
    expanded.extend(around.expanded);
    Ok(Robot {
        description,
        guests: around.guests,
        model: assembled.model,
        table,
        diagnostics,
        sources,
        settled,
        settings,
        expanded,
    })
}

/// Makes an FMU of a robot, with the libraries of the platforms asked for, or of all that there
/// are.
///
/// # Errors
/// [`StageError`].
pub fn fmu(
    robot: &Robot,
    urdf: &Path,
    platforms: &[String],
    extras: &Extras,
) -> Result<Fmu, StageError> {
    let libraries = libraries(robot, platforms)?;
    let stem = output::stem(urdf);
    let about = &robot.settings.fmu;
    let model_name = about.name.as_ref().unwrap_or(&robot.model.name);
    let model_identifier = model_identifier(model_name, &stem.to_string_lossy());
    let guid = guid(
        about.fmi,
        &model_identifier,
        &robot.model,
        &robot.table,
        &libraries,
    )?;
    let prepared = PreparedModel::new(guid.clone(), robot.model.clone()).to_json()?;
    trial(&prepared)?;

    let mut archive = Archive::default();
    let date = date::text(std::env::var("SOURCE_DATE_EPOCH").ok().as_deref());
    let xml = describe::model_description(
        &Header {
            model_name,
            model_identifier: &model_identifier,
            guid: &guid,
            date: &date,
            description: &sentence(robot),
            about,
        },
        &robot.model,
        &robot.table,
    )?;
    let subject = related::Subject {
        description: &xml,
        prepared: &prepared,
        model_identifier: &model_identifier,
        fmi: about.fmi,
        table: &robot.table,
    };
    let reference = extras.reference_run;
    let reference = reference.map(|folder| related::reference(&subject, folder));
    let reference = reference.transpose()?;
    let listed = listing::listed(about.fmi, &robot.model, &robot.table)?;
    for (name, bytes) in related::files(&robot.model, &listed, reference.as_ref())? {
        archive.add(name, bytes)?;
    }
    archive.add("modelDescription.xml", xml)?;
    if about.fmi == FmiVersion::V3 {
        let terminals = describe::terminals(&robot.model, &robot.table)?;
        archive.add(describe::TERMINALS, terminals)?;
    }
    for library in &libraries {
        let name = format!(
            "binaries/{}/{model_identifier}.{}",
            library.folder, library.extension
        );
        archive.add_executable(name, library.file.clone(), library.deflated)?;
    }
    archive.add(format!("resources/{FILE_NAME}"), prepared)?;
    let names = add_sources(&mut archive, robot, extras.kept)?;
    let remarks = remarks(robot, &names);
    let scene = make_scene(robot, &remarks, &guid)?.to_bytes()?;
    let scene_name = format!("resources/{}", scene::FILE_NAME);
    archive.add(scene_name, scene.clone())?;
    archive.add("documentation/licenses/license.txt", license::text())?;
    let endings: Vec<&str> = libraries.iter().map(|l| l.extension).collect();
    let licences = license::spdx(&license::Subject {
        name: model_name,
        guid: &guid,
        date: &date,
        license: about.license.as_deref(),
        endings: &endings,
    });
    archive.add("documentation/licenses/license.spdx", licences)?;
    let inside = libraries.iter();
    let platforms: Vec<String> = inside
        .map(|l| library::describe(l.folder, &l.platforms))
        .collect();
    if extras.documented {
        let page = Page {
            model_identifier: &model_identifier,
            guid: &guid,
            platforms: &platforms,
            remarks: &remarks,
            sources: &names,
            fmi: about.fmi,
        };
        document(&mut archive, robot, &page, &scene)?;
    }
    Ok(Fmu {
        bytes: archive.to_bytes()?,
        platforms,
    })
}

/// Adds what people look at.
fn document(
    archive: &mut Archive,
    robot: &Robot,
    page: &Page,
    scene: &[u8],
) -> Result<(), StageError> {
    let still = page::still(&robot.model.name, scene);
    archive.add("documentation/robot.html", still)?;
    // Whoever draws the FMU must be able to read it: the pictures are of what was written.
    let scene = Scene::from_bytes(scene)?;
    for (name, picture) in picture::all(&scene) {
        if let Some(name) = documentation::picture(page.fmi, name) {
            archive.add(name, picture)?;
        }
    }
    let html = documentation::html(page, &robot.model, &robot.table)?;
    archive.add("documentation/index.html", html)?;
    Ok(())
}

/// What the robot looks like, outside of an FMU.
///
/// # Errors
/// [`StageError::Trial`] if its initial state cannot be computed.
pub fn scene(robot: &Robot) -> Result<Scene, StageError> {
    make_scene(robot, &remarks(robot, &[]), "")
}

fn make_scene(robot: &Robot, remarks: &[Remark], guid: &str) -> Result<Scene, StageError> {
    let Robot { model, table, .. } = robot;
    let variables = table.iter().map(told::variable).collect();
    let notes = remarks.iter().map(told::note).collect();
    let guests = robot.guests.iter();
    let parts = guests.map(|guest| (guest.name.as_str(), &guest.description));
    let parts: Vec<_> = std::iter::once(("", &robot.description))
        .chain(parts)
        .collect();
    Ok(scene::make(&parts, model, table, variables, notes, guid)?)
}

/// The libraries of `platforms`, else of those that the settings name, else of all.
///
/// # Errors
/// [`StageError::Library`], or [`StageError::Robot`] where the settings name them.
pub fn libraries(robot: &Robot, platforms: &[String]) -> Result<Vec<Binary>, StageError> {
    let all = library::embedded();
    let fmi = robot.settings.fmu.fmi.major();
    let set = &robot.settings.fmu.platforms;
    if !platforms.is_empty() || set.is_empty() {
        return Ok(library::pack(all, platforms, fmi)?);
    }
    let names: Vec<&str> = set.iter().map(|name| name.text.as_str()).collect();
    library::pack(all, &names, fmi).map_err(|error| {
        let told = set.iter().find(|n| error.to_string().contains(&n.text));
        StageError::Robot(vec![library::finding(told.unwrap_or(&set[0]), &error)])
    })
}

/// Loads what the FMU will load and takes one step of the default experiment.
fn trial(prepared: &str) -> Result<(), StageError> {
    let prepared = PreparedModel::from_json(prepared)?;
    let mut simulation = Simulation::with_hash(Arc::new(prepared.model), prepared.hash);
    simulation.initialize(0.0)?;
    simulation.advance_to(describe::STEP_SIZE)?;
    Ok(())
}

/// One sentence for importers that show it.
fn sentence(robot: &Robot) -> String {
    let model = &robot.model;
    format!(
        "{} with {} base and {}, on its own simulator with contact and force-limited motors",
        model.name,
        if model.is_floating() {
            "floating"
        } else {
            "fixed"
        },
        crate::info::count(model.nv(), "degree of freedom"),
    )
}

/// Adds the robot's own files; gives their names below `resources/source/`.
///
/// - `kept`: whether a source that cannot be read again, a pipe, is an error and not left empty
fn add_sources(
    archive: &mut Archive,
    robot: &Robot,
    kept: bool,
) -> Result<Vec<String>, StageError> {
    let paths = &robot.sources;
    let mut contents = Vec::with_capacity(paths.len());
    let text_of = |path: &PathBuf| robot.expanded.iter().find(|(file, _)| file == path);
    for path in paths {
        if let Some((_, expanded)) = text_of(path) {
            contents.push(expanded.clone().into_bytes());
            continue;
        }
        // What was read from a pipe is gone.
        let read = match reading::lasting(path) {
            Err(_) if !kept => Ok(Vec::new()),
            lasting => lasting.and_then(|()| std::fs::read(path)),
        };
        contents.push(read.map_err(|source| StageError::Source {
            path: path.clone(),
            source,
        })?);
    }
    let urdf = contents
        .first()
        .map(|c| String::from_utf8_lossy(c).into_owned());
    let place = |path: &PathBuf| match &robot.settled {
        Some((settings, place)) if settings == path => place.clone(),
        _ => path.clone(),
    };
    let places: Vec<PathBuf> = paths.iter().map(place).collect();
    let mut names = sources::layout(&places, &urdf.unwrap_or_default());
    for (name, path) in names.iter_mut().zip(paths) {
        if text_of(path).is_some() {
            *name = xacro::urdf_name(name);
        }
    }
    for (name, content) in names.iter().zip(contents) {
        archive.add(format!("resources/source/{name}"), content)?;
    }
    Ok(names)
}

/// Findings as the documentation shows them: files by their names in the FMU, no path of this
/// machine.
fn remarks(robot: &Robot, names: &[String]) -> Vec<Remark> {
    let rename = |text: &str| -> String {
        robot
            .sources
            .iter()
            .zip(names)
            .fold(text.to_owned(), |text, (path, name)| {
                text.replace(&path.display().to_string(), name)
            })
    };
    robot
        .diagnostics
        .iter()
        .map(|d| Remark {
            severity: d.severity,
            code: d.code,
            message: rename(&d.message),
            help: d.help.as_deref().map(rename),
            place: d
                .place
                .as_ref()
                .map(|p| format!("{}, line {}", rename(&p.file), p.line)),
        })
        .collect()
}
