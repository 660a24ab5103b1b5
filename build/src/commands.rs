//! The commands.
//!
//! Results go to standard output, findings and problems to standard error, all of it through
//! [`crate::output`].

mod see;
mod shared;
mod simulate;

pub use shared::{CliError, print_findings};
use shared::{
    is_fmu, refuse_ending, refuse_fmu, refuse_given, refuse_options, refuse_other_kinds, temporary,
};

use crate::cli::{Check, Cli, Command, Deny, Expand, Explain, Export, Info, Init, Picture};
use crate::diagnostics::{self, Style};
use crate::importer::description::Description;
use crate::importer::error::RunError;
use crate::output::{OutputError, Target, beside, print};
use crate::stage::{self, Extras, StageError};
use crate::{archive, info, init, library, listing, ssv, summary, xacro};
use serde_json::json;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use urdf2fmu_core::diagnostic::Severity;
use urdf2fmu_core::diagnostic::codes;
use urdf2fmu_core::folder;
use urdf2fmu_core::pattern::Pattern;
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModel};
use urdf2fmu_core::urdf::ReadOptions;
use urdf2fmu_core::variables;
use urdf2fmu_drawing::picture;
use urdf2fmu_drawing::scene::{self, Scene};

/// Does what was asked.
///
/// # Errors
/// [`CliError`]; the caller prints it.
pub fn run(cli: &Cli) -> Result<(), CliError> {
    match &cli.command {
        Command::Export(args) => export(args),
        Command::Info(args) => show(args),
        Command::Check(args) => check(args),
        Command::Init(args) => init(args),
        Command::Picture(args) => picture(args),
        Command::Report(args) => see::report(args),
        Command::Simulate(args) => simulate::simulate(args),
        Command::View(args) => see::view(args),
        Command::Expand(args) => expand(args),
        Command::Explain(args) => explain(args),
    }
}

fn export(args: &Export) -> Result<(), CliError> {
    refuse_other_kinds(&args.urdf)?;
    refuse_fmu(
        &args.urdf,
        "an FMU already: export takes the URDF; urdf2fmu simulate runs an FMU",
    )?;
    let robot = stage::robot(&args.source.request(&args.urdf))?;
    print_findings(&robot.diagnostics, Severity::Warning)?;
    let output = args.output.clone();
    let output = output.unwrap_or_else(|| beside(&args.urdf, "robot", "fmu"));
    let target = Target::new(&output, robot.sources.iter().map(PathBuf::as_path))?;
    refuse_ending(args.output.as_ref(), "--output", ["an FMU", "fmu"])?;
    let about = &robot.settings.fmu;
    let wanted = args.packing.reference_run || about.reference_run;
    let folder = wanted.then(temporary).transpose()?;
    let extras = Extras {
        kept: true,
        documented: !(args.packing.no_documentation || about.undocumented),
        reference_run: folder.as_ref().map(TempDir::path),
    };
    let fmu = stage::fmu(&robot, &args.urdf, &args.packing.platforms, &extras)?;
    target.write(&fmu.bytes)?;
    target.describe(&summary::text(target.named(), &fmu, &robot))?;
    Ok(())
}

fn show(args: &Info) -> Result<(), CliError> {
    refuse_other_kinds(&args.file)?;
    let given = [args.source.given(), args.packing.given()].concat();
    refuse_given(&args.file, given)?;
    let (model, table, platforms, fmi, guid) = if is_fmu(&args.file) {
        let path = args.file.clone();
        let Some(bytes) = archive::read_entry(&path, &format!("resources/{FILE_NAME}"))? else {
            return Err(CliError::ForeignFmu { path });
        };
        let platforms = archive::heads(&path, "binaries/")?;
        let platforms: Vec<_> = platforms
            .into_iter()
            .map(|(folder, head)| (folder, library::header::platforms(&head)))
            .collect();
        let text = archive::read_entry(&path, "modelDescription.xml")?.unwrap_or_default();
        let description = Description::from_bytes(text).map_err(RunError::from)?;
        let prepared = PreparedModel::from_json(&String::from_utf8_lossy(&bytes))
            .map_err(|source| CliError::Prepared { path, source })?;
        let table = variables::table(&prepared.model)?;
        let Description { fmi, guid, .. } = description;
        (prepared.model, table, platforms, fmi, Some(guid))
    } else {
        let robot = stage::robot(&args.source.request(&args.file))?;
        print_findings(&robot.diagnostics, Severity::Warning)?;
        // Those that its FMU would get.
        let platforms = stage::libraries(&robot, &args.packing.platforms)?.into_iter();
        let platforms = platforms.map(|l| (l.folder.to_owned(), l.platforms));
        let platforms = platforms.collect();
        let fmi = robot.settings.fmu.fmi;
        (robot.model, robot.table, platforms, fmi, None)
    };
    let listed = listing::listed(fmi, &model, &table)?;
    if args.json {
        let mut value = info::json(&model);
        if args.variables {
            value["variables"] = listing::json(&listed);
        }
        let folders: Vec<_> = platforms.iter().map(|(folder, _)| folder).collect();
        let systems: Vec<_> = platforms.iter().flat_map(|(_, systems)| systems).collect();
        value["platforms"] = json!(folders);
        value["systems"] = json!(systems);
        value["fmi"] = json!(fmi.to_string());
        value["interfaces"] = json!(info::elements(&model));
        value["guid"] = json!(guid);
        print(&format!("{value:#}\n"))?;
    } else {
        let mut text = info::text(&model);
        text += &info::interface(&model, fmi, guid.as_deref());
        if args.variables {
            text += "\nVariables\n";
            text += &listing::text(&listed);
        }
        let inside = platforms.iter();
        let inside = inside.map(|(folder, systems)| library::describe(folder, systems));
        let inside = inside.collect::<Vec<_>>().join(" ");
        print(&format!("{text}\nPlatforms\n  {inside}\n"))?;
    }
    Ok(())
}

fn init(args: &Init) -> Result<(), CliError> {
    refuse_fmu(
        &args.urdf,
        "an FMU: init takes the URDF that it was made from",
    )?;
    let target = text_target(args.output.as_deref(), &args.urdf)?;
    let kind = if args.ssv {
        ["start values", "ssv"]
    } else {
        ["settings", "toml"]
    };
    refuse_ending(args.output.as_ref(), "--output", kind)?;
    if args.ssv {
        let robot = stage::robot(&args.source.request(&args.urdf))?;
        print_findings(&robot.diagnostics, Severity::Warning)?;
        let listed = listing::listed(robot.settings.fmu.fmi, &robot.model, &robot.table)?;
        let text = ssv::text(&robot.model, &listed).map_err(CliError::Ssv)?;
        target.write(text.as_bytes())?;
        return Ok(());
    }
    if args.source.config.is_some() {
        return Err(CliError::InitFromSettings);
    }
    let text = init::text(&asked_of_init(args)?);
    target.write(text.as_bytes())?;
    Ok(())
}

/// What settings are written about.
fn asked_of_init(args: &Init) -> Result<init::Subject, CliError> {
    let mut request = args.source.request(&args.urdf);
    let mut robot = stage::robot(&request)?;
    print_findings(&robot.diagnostics, Severity::Warning)?;
    let named: Vec<_> = robot.guests.iter().map(init::named).collect();
    // The settings of the robot are its own, whatever is around it.
    let objects = std::mem::take(&mut request.objects);
    if !objects.is_empty() {
        robot = stage::robot(&request)?;
    }
    let packing = &args.packing;
    library::known(&packing.platforms).map_err(StageError::from)?;
    let fmu = &mut robot.settings.fmu;
    let names = packing.platforms.iter();
    fmu.platforms
        .extend(names.map(|name| Pattern::from(name.as_str())));
    fmu.undocumented |= packing.no_documentation;
    fmu.reference_run |= packing.reference_run;
    let folder = args.output.as_deref().map(folder::of);
    Ok(init::Subject {
        model: robot.model,
        settings: robot.settings,
        diagnostics: robot.diagnostics,
        command: args.source.without_keys(&args.urdf),
        objects: init::objects(&objects, &named, folder),
    })
}

/// Where a text goes that is made from `input`: standard output unless a file is asked for.
fn text_target(output: Option<&Path>, input: &Path) -> Result<Target, OutputError> {
    Target::new(output.unwrap_or(Path::new("-")), [input])
}

fn expand(args: &Expand) -> Result<(), CliError> {
    refuse_fmu(&args.file, "an FMU: expand takes a file in xacro")?;
    let target = text_target(args.output.as_deref(), &args.file)?;
    let mut options = ReadOptions::from_environment();
    options
        .package_paths
        .splice(0..0, args.package_paths.iter().cloned());
    options.packages.clone_from(&args.packages);
    let expanded = xacro::expand(&args.file, &args.xacro_arguments, &options);
    let expanded = expanded.map_err(|refused| StageError::Robot(refused.findings))?;
    print_findings(&expanded.notes, Severity::Warning)?;
    target.write(expanded.text.as_bytes())?;
    Ok(())
}

fn explain(args: &Explain) -> Result<(), CliError> {
    let Some(code) = &args.code else {
        print(&codes::list())?;
        return Ok(());
    };
    let found = codes::text(code).ok_or_else(|| CliError::Code { code: code.clone() })?;
    print(&found)?;
    Ok(())
}

fn check(args: &Check) -> Result<(), CliError> {
    refuse_other_kinds(&args.urdf)?;
    refuse_fmu(
        &args.urdf,
        "an FMU: check takes the URDF; urdf2fmu info shows what is in an FMU",
    )?;
    let findings = match stage::robot(&args.source.request(&args.urdf)) {
        Ok(robot) => {
            let platforms = &args.packing.platforms;
            if !platforms.is_empty() {
                stage::libraries(&robot, platforms)?;
            }
            robot.diagnostics
        }
        Err(StageError::Robot(findings)) => findings,
        Err(other) => return Err(other.into()),
    };
    let worst = findings.iter().map(|d| d.severity).max();
    let refused = worst == Some(Severity::Error)
        || worst == Some(Severity::Warning) && args.deny == Some(Deny::Warnings);
    let tally = diagnostics::tally(&findings);
    if args.json {
        let list: Vec<_> = findings.iter().map(diagnostics::to_json).collect();
        print(&format!(
            "{:#}\n",
            json!({ "ok": !refused, "findings": list })
        ))?;
    } else if !refused {
        let findings_text: String = findings
            .iter()
            .map(|d| diagnostics::render(d, Style::of_stdout()))
            .collect();
        let verdict = tally
            .clone()
            .map_or("ok".to_owned(), |tally| format!("ok, with {tally}"));
        print(&format!(
            "{findings_text}{}: {verdict}\n",
            args.urdf.display()
        ))?;
    }
    if !refused {
        return Ok(());
    }
    Err(CliError::Findings {
        summary: format!("{}: {}", args.urdf.display(), tally.unwrap_or_default()),
        findings: if args.json { Vec::new() } else { findings },
    })
}

fn picture(args: &Picture) -> Result<(), CliError> {
    refuse_options(&args.file, &args.source)?;
    let mut inputs = vec![args.file.clone()];
    inputs.extend(args.run.clone());
    let scene = if is_fmu(&args.file) {
        let path = args.file.clone();
        let name = format!("resources/{}", scene::FILE_NAME);
        match archive::read_entry(&path, &name)? {
            Some(bytes) => {
                Scene::from_bytes(&bytes).map_err(|source| CliError::Scene { path, source })?
            }
            None => return Err(CliError::NoScene { path }),
        }
    } else {
        let robot = stage::robot(&args.source.request(&args.file))?;
        print_findings(&robot.diagnostics, Severity::Warning)?;
        inputs.extend(robot.sources.iter().cloned());
        stage::scene(&robot)?
    };
    let output = args.output.clone();
    let output = output.unwrap_or_else(|| beside(&args.file, "robot", "png"));
    let target = Target::new(&output, inputs.iter().map(PathBuf::as_path))?;
    refuse_ending(args.output.as_ref(), "--output", ["a PNG picture", "png"])?;
    let look = args.look();
    let Some(run) = &args.run else {
        let poses = scene::link_poses(&scene.head, |_| None);
        let (bytes, camera) = picture::still(&scene, &poses, &look);
        target.write(&bytes)?;
        target.describe(&summary::picture(
            target.named(),
            bytes.len(),
            &look,
            &camera,
        ))?;
        return Ok(());
    };
    if matches!(look.theme, picture::Theme::Clear | picture::Theme::Cutout) {
        return Err(CliError::FilmTheme);
    }
    let table = see::run(run, &scene)?;
    see::tell_notes(&table.notes)?;
    let shown =
        picture::poses(&scene.head, &table.time, &table.columns, args.rate).map_err(|source| {
            let path = run.clone();
            CliError::Show { path, source }
        })?;
    // 1 … 60 pictures a second.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "16 … 1000"
    )]
    let delay = (1000.0 / args.rate).round() as u16;
    let bytes = picture::film(&scene, &shown, delay, &look);
    target.write(&bytes)?;
    target.describe(&summary::film(
        target.named(),
        bytes.len(),
        &look,
        shown.len(),
    ))?;
    Ok(())
}
