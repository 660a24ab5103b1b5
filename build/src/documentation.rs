//! documentation/index.html: one page without links to the network.
//!
//! Beside it lie `robot.html`, the robot in 3-D ([`crate::page::still`]), which a script puts in
//! the place of a picture where the browser can show it, and a picture of the frames.
//!
//! It is made from the same table as modelDescription.xml. It lists the assumptions and names no
//! path of the machine that made the FMU.

use crate::info::{around, count, interfaces, parts, role, short, total_mass};
use crate::listing::{Listed, listed};
use std::fmt::{Display, Write as _};
use urdf2fmu_core::diagnostic::Severity;
use urdf2fmu_core::model::{Model, SensorKind};
use urdf2fmu_core::settings::FmiVersion;
use urdf2fmu_core::variables::{Causality, TableError, Variable};

/// Something that was assumed or looks wrong.
#[derive(Clone, Debug)]
pub struct Remark {
    /// Whether it is an assumption or a warning.
    pub severity: Severity,
    /// `U104`
    pub code: &'static str,
    /// In words.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// `rover.urdf, line 12`; none for what has no place.
    pub place: Option<String>,
}

/// What the page shows beside the model and its table.
#[derive(Debug)]
pub struct Page<'a> {
    /// C identifier of the FMU.
    pub model_identifier: &'a str,
    /// See modelDescription.xml.
    pub guid: &'a str,
    /// `linux64` …
    pub platforms: &'a [String],
    /// In order of appearance.
    pub remarks: &'a [Remark],
    /// Names below `resources/source/`.
    pub sources: &'a [String],
    /// Version of the standard.
    pub fmi: FmiVersion,
}

/// The picture that importers of FMI 2 show.
const ICON: &str = "model.png";
/// The same for FMI 3.
const ICON_OF_FMI_3: &str = "terminalsAndIcons/icon.png";

/// Where one of an FMU's pictures stands; none for one that it does not have. FMI 3 knows but one
/// icon, and the larger one is as good.
pub fn picture(fmi: FmiVersion, name: &'static str) -> Option<&'static str> {
    match (fmi, name) {
        (FmiVersion::V3, ICON) => Some(ICON_OF_FMI_3),
        (FmiVersion::V3, ICON_OF_FMI_3) => None,
        _ => Some(name),
    }
}

/// The page.
///
/// # Errors
/// [`TableError`] if the variables cannot be listed.
pub fn html(page: &Page, model: &Model, table: &[Variable]) -> Result<String, TableError> {
    let mut out = String::new();
    let name = escape(&model.name);
    let icon = match page.fmi {
        FmiVersion::V2 => ICON,
        FmiVersion::V3 => ICON_OF_FMI_3,
    };
    _ = write!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{name}</title>\n<style>\n{}</style>\n</head>\n\
         <body>\n<h1>{name}</h1>\n<p class=\"quiet\">FMI {} FMU of a URDF robot for {}, made by urdf2fmu {}</p>\n",
        include_str!("documentation.css"),
        page.fmi,
        interfaces(model),
        env!("CARGO_PKG_VERSION"),
    );
    _ = write!(
        out,
        "<figure id=\"robot\"><img src=\"../{icon}\" alt=\"{name} at the start\" width=\"400\" height=\"400\"></figure>\n\
         <script>{}</script>\n",
        include_str!("documentation.js"),
    );
    facts(&mut out, page, model, table);
    remarks(&mut out, page);
    out.push_str(CONVENTIONS);
    let listed = listed(page.fmi, model, table)?;
    variables(&mut out, &listed);
    links(&mut out, model);
    let sources: Vec<String> = page.sources.iter().map(code).collect();
    _ = write!(
        out,
        "<h2>Licences</h2>\n<p>The robot's description and meshes in <code>resources/source/</code> belong to their \
         authors: {}. The simulator in <code>binaries/</code> is MIT OR Apache-2.0, as are the parts it is made of or \
         under terms as free; see <code>documentation/licenses/license.txt</code>.</p>\n</body>\n</html>\n",
        sources.join(", "),
    );
    Ok(out)
}

/// The links by number, if a sensor tells which one it hits.
fn links(out: &mut String, model: &Model) {
    let tells = |kind: &SensorKind| matches!(kind, SensorKind::Ray { hits: true, .. });
    if !model.outputs.sensors.iter().any(|s| tells(&s.kind)) {
        return;
    }
    out.push_str(
        "<h2>What rays hit</h2>\n<p>Outputs <code>sensor.….hit[…]</code> are 0 for nothing, -1 for the ground, and else \
         the number of a link.</p>\n<table class=\"facts\">\n",
    );
    for (number, link) in (1..).zip(&model.links) {
        _ = writeln!(
            out,
            "<tr><td>{number}</td><td>{}</td></tr>",
            code(&link.name)
        );
    }
    out.push_str("</table>\n");
}

fn facts(out: &mut String, page: &Page, model: &Model, table: &[Variable]) {
    let number_of = |causality| {
        let all = table.iter().map(Variable::causality);
        all.filter(|own| *own == causality).count()
    };
    let gravity = model.world.gravity;
    let ground = model.world.ground.as_ref().map_or_else(
        || "none".to_owned(),
        |g| {
            format!(
                "plane z = 0, friction {}, restitution {}",
                short(g.friction),
                short(g.restitution)
            )
        },
    );
    let around = around(model);
    let around = (!around.is_empty()).then_some(("Around it", around));
    let rows: [(&str, String); 8] = [
        (
            "Base",
            if model.is_floating() {
                "floating"
            } else {
                "fixed"
            }
            .to_owned(),
        ),
        ("Parts", parts(model)),
        ("Mass", format!("{} kg", short(total_mass(model)))),
        (
            "Gravity",
            format!(
                "({}, {}, {}) m/s²",
                short(gravity.x),
                short(gravity.y),
                short(gravity.z)
            ),
        ),
        ("Ground", ground),
        (
            "Variables",
            format!(
                "{}, {}, {}, {}",
                count(number_of(Causality::Input), "input"),
                count(number_of(Causality::Output), "output"),
                count(number_of(Causality::Parameter), "parameter"),
                count(number_of(Causality::Local), "local variable"),
            ),
        ),
        ("Platforms", page.platforms.join(", ")),
        (
            "Identity",
            format!("{}, guid {}", page.model_identifier, page.guid),
        ),
    ];
    out.push_str("<table class=\"facts\">\n");
    for (what, value) in rows.into_iter().chain(around) {
        _ = writeln!(out, "<tr><td>{what}</td><td>{}</td></tr>", escape(&value));
    }
    out.push_str("</table>\n");
}

fn remarks(out: &mut String, page: &Page) {
    out.push_str("<h2>What was assumed</h2>\n");
    if page.remarks.is_empty() {
        out.push_str("<p>Nothing beyond the robot's files.</p>\n");
        return;
    }
    out.push_str("<ul>\n");
    for remark in page.remarks {
        let warning = if remark.severity == Severity::Note {
            ""
        } else {
            "<strong>Warning:</strong> "
        };
        let place = remark
            .place
            .as_ref()
            .map_or_else(String::new, |p| format!(", {}", escape(p)));
        _ = writeln!(
            out,
            "<li>{warning}{} <span class=\"quiet\">({}{place})</span></li>",
            escape(&remark.message),
            remark.code,
        );
    }
    out.push_str("</ul>\n");
}

/// What a number means.
const CONVENTIONS: &str = "<h2>Units and frames</h2>
<p>SI units: m, kg, s, rad, N. The world frame has z up and the ground at z = 0. <code>base.*</code> is the frame of the
URDF's root link, at its origin and not at its centre of mass; velocities are those of that point, in world axes.
Quaternions are x, y, z, w; roll, pitch and yaw turn about fixed axes, as in URDF. Joint positions and velocities have
the sign and the zero of the URDF; <code>effort</code> is the actuator's alone, without friction and damping. Contact
forces are net forces on the link in world axes, averaged over the last communication step; a contact point is where
the normal forces act at the end of that step, or the link's origin where nothing touches.</p>
<figure><img src=\"frames.png\" alt=\"Frames of the base and of the links that move\" width=\"400\" height=\"400\">
<figcaption>Frames of the base and of the links that move: x red, y green, z blue.</figcaption></figure>
<p>Outputs are values at the end of the communication step. An unconnected input keeps its start value. A
<code>max_effort</code> of 0 lets the joint go. Tunable parameters may change between steps, fixed ones only before or
during initialisation. <code>solver.step_size</code> = 0 means error controlled by <code>solver.tolerance</code>; 0
there means the importer's tolerance, or 0.001.</p>
";

/// A heading and what stands under it.
type Group = (&'static str, Causality);

fn variables(out: &mut String, listed: &[Listed]) {
    out.push_str("<h2>Variables</h2>\n");
    let groups: [Group; 4] = [
        ("Inputs", Causality::Input),
        ("Outputs", Causality::Output),
        ("Parameters", Causality::Parameter),
        (
            "Local variables, which importers record on request",
            Causality::Local,
        ),
    ];
    for (title, causality) in groups {
        let all = listed.iter();
        let rows: Vec<&Listed> = all.filter(|v| v.first().causality() == causality).collect();
        if rows.is_empty() {
            continue;
        }
        // What is computed has no start and no range; all inputs and all outputs are of one kind.
        let settable = matches!(causality, Causality::Input | Causality::Parameter);
        let (starts, kinds) = (settable, causality == Causality::Parameter);
        let heads = [
            (true, "Name"),
            (true, "Unit"),
            (starts, "Start"),
            (starts, "Range"),
            (kinds, "Kind"),
            (true, "Meaning"),
        ];
        _ = write!(out, "<h3>{title}</h3>\n<table>\n<tr>");
        for (_, head) in heads.iter().filter(|(shown, _)| *shown) {
            _ = write!(out, "<th>{head}</th>");
        }
        out.push_str("</tr>\n");
        for v in rows {
            let range = match (v.bound(|row| row.min), v.bound(|row| row.max)) {
                (None, None) => String::new(),
                (min, max) => format!(
                    "{} … {}",
                    min.map_or_else(|| "−∞".to_owned(), short),
                    max.map_or_else(|| "∞".to_owned(), short)
                ),
            };
            // A long name breaks after a dot.
            let mut name = code(&v.name).replace('.', ".<wbr>");
            if !v.shape.is_empty() {
                _ = write!(name, " [{}]", v.size().replace('x', "×"));
            }
            _ = write!(out, "<tr><td>{name}</td><td>{}</td>", v.unit());
            if starts {
                let start = v.starts().unwrap_or_default().into_iter().map(short);
                let start = start.collect::<Vec<_>>().join(" ");
                _ = write!(
                    out,
                    "<td class=\"n\">{start}</td><td class=\"n\">{range}</td>"
                );
            }
            if kinds {
                _ = write!(out, "<td>{}</td>", role(v.first()));
            }
            _ = writeln!(out, "<td>{}</td></tr>", escape(&v.description));
        }
        out.push_str("</table>\n");
    }
}

fn code(text: impl Display) -> String {
    format!("<code>{}</code>", escape(&text.to_string()))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
