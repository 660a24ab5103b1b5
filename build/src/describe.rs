//! modelDescription.xml, FMI 2.0 co-simulation.
//!
//! In: the variable table and a few facts of the model. Out: the XML text; the same input gives the
//! same bytes.
//!
//! Only this module writes with quick-xml. It adds no variable to those of the table. What each
//! initial output depends on is in [`crate::structure`].
//!
//! Source: FMI 2.0.4 specification, sections 2.2 and 4.3.

use crate::structure;
use crate::units;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::collections::BTreeSet;
use std::io;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::FmuSettings;
use urdf2fmu_core::variables::{Causality, Kind, Slot, Unit, Variable};

/// Seconds of the default experiment.
pub const STOP_TIME: f64 = 10.0;
/// Communication step of the default experiment, s: what users of 240 Hz simulators are used to.
pub const STEP_SIZE: f64 = 1.0 / 240.0;
/// Tolerance of the default experiment; also the solver's tolerance if neither settings nor
/// importer give one.
pub const TOLERANCE: f64 = 1e-3;

/// FMI's own categories, and what this FMU writes into each.
const LOG_CATEGORIES: [(&str, &str); 7] = [
    (
        "logEvents",
        "Initialisation, reset and other changes of phase",
    ),
    ("logNonlinearSystems", "Convergence of the step's solver"),
    (
        "logStatusWarning",
        "Calls that succeed but look wrong, such as values outside min and max",
    ),
    ("logStatusDiscard", "Steps that could not be computed"),
    ("logStatusError", "Calls that are refused, with the reason"),
    (
        "logStatusFatal",
        "Failures after which the instance can only be freed",
    ),
    ("logAll", "Everything"),
];

/// What modelDescription.xml says beside the table.
#[derive(Debug)]
pub struct Header<'a> {
    /// Shown to people.
    pub model_name: &'a str,
    /// C identifier and name of the library.
    pub model_identifier: &'a str,
    /// Compared at instantiation.
    pub guid: &'a str,
    /// `YYYY-MM-DDThh:mm:ssZ`
    pub date: &'a str,
    /// One sentence.
    pub description: &'a str,
    /// Who made it, and how long it runs by default.
    pub about: &'a FmuSettings,
}

/// A table that FMI forbids; a defect of this program, not of the robot.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DescribeError {
    /// FMI has no such number.
    #[error(
        "variable '{name}': {attribute} is not finite; please report this as a defect of urdf2fmu"
    )]
    NotFinite {
        /// Variable.
        name: String,
        /// XML attribute.
        attribute: &'static str,
    },
    /// FMI requires min ≤ start ≤ max.
    #[error(
        "variable '{name}': start {start} lies outside {min} … {max}; please report this as a defect of urdf2fmu"
    )]
    Range {
        /// Variable.
        name: String,
        /// Value.
        start: f64,
        /// Lower bound.
        min: f64,
        /// Upper bound.
        max: f64,
    },
    /// Names and value references are unique.
    #[error("variable '{name}' occurs twice; please report this as a defect of urdf2fmu")]
    Duplicate {
        /// Variable.
        name: String,
    },
    /// Inputs and parameters have a start.
    #[error("variable '{name}' has no start value; please report this as a defect of urdf2fmu")]
    NoStart {
        /// Variable.
        name: String,
    },
    /// The writer writes to memory, so this does not happen.
    #[error("cannot write modelDescription.xml: {0}")]
    Write(#[from] io::Error),
}

/// The XML text.
///
/// # Errors
/// [`DescribeError`] where the table breaks a rule of FMI.
pub fn model_description(
    header: &Header,
    model: &Model,
    table: &[Variable],
) -> Result<Vec<u8>, DescribeError> {
    check(table)?;
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let tool = concat!("urdf2fmu ", env!("CARGO_PKG_VERSION"));
    let naming = if model.outputs.flat_names {
        "flat"
    } else {
        "structured"
    };
    let mut root = xml.create_element("fmiModelDescription");
    let about = header.about;
    for (name, text) in [
        ("author", &about.author),
        ("version", &about.version),
        ("copyright", &about.copyright),
    ] {
        if let Some(text) = text {
            root = root.with_attribute((name, clean(text).as_str()));
        }
    }
    let license = about
        .license
        .as_deref()
        .unwrap_or("See documentation/licenses/license.txt");
    root.with_attribute(("fmiVersion", "2.0"))
        .with_attribute(("modelName", clean(header.model_name).as_str()))
        .with_attribute(("guid", header.guid))
        .with_attribute(("description", clean(header.description).as_str()))
        .with_attribute(("license", clean(license).as_str()))
        .with_attribute(("generationTool", tool))
        .with_attribute(("generationDateAndTime", header.date))
        .with_attribute(("variableNamingConvention", naming))
        .with_attribute(("numberOfEventIndicators", "0"))
        .write_inner_content(|xml| {
            co_simulation(xml, header.model_identifier)?;
            unit_definitions(xml, table)?;
            type_definitions(xml, table)?;
            list(
                xml,
                "LogCategories",
                LOG_CATEGORIES.iter(),
                |xml, (name, what)| {
                    xml.create_element("Category")
                        .with_attributes([("name", *name), ("description", *what)])
                        .write_empty()?;
                    Ok(())
                },
            )?;
            xml.create_element("DefaultExperiment")
                .with_attribute(("startTime", "0"))
                .with_attribute((
                    "stopTime",
                    number(about.stop_time.unwrap_or(STOP_TIME)).as_str(),
                ))
                .with_attribute(("tolerance", number(TOLERANCE).as_str()))
                .with_attribute(("stepSize", number(STEP_SIZE).as_str()))
                .write_empty()?;
            list(xml, "ModelVariables", table.iter(), scalar_variable)?;
            model_structure(xml, model, table)
        })?;
    let mut text = xml.into_inner();
    text.push(b'\n');
    Ok(text)
}

/// The rules of FMI that the schema does not express.
fn check(table: &[Variable]) -> Result<(), DescribeError> {
    let (mut names, mut references) = (BTreeSet::new(), BTreeSet::new());
    for v in table {
        let name = || v.name.clone();
        if !names.insert(&v.name) || !references.insert(v.value_reference) {
            return Err(DescribeError::Duplicate { name: name() });
        }
        for (attribute, value) in [("start", v.start), ("min", v.min), ("max", v.max)] {
            if value.is_some_and(|x| !x.is_finite()) {
                return Err(DescribeError::NotFinite {
                    name: name(),
                    attribute,
                });
            }
        }
        if v.start.is_none() && !matches!(v.slot, Slot::Output(_)) {
            return Err(DescribeError::NoStart { name: name() });
        }
        let min = v.min.unwrap_or(f64::NEG_INFINITY);
        let max = v.max.unwrap_or(f64::INFINITY);
        let start = v.start.unwrap_or(min.max(f64::MIN).min(max));
        if !(min <= start && start <= max) {
            return Err(DescribeError::Range {
                name: name(),
                start,
                min,
                max,
            });
        }
    }
    Ok(())
}

fn co_simulation(xml: &mut Writer<Vec<u8>>, model_identifier: &str) -> io::Result<()> {
    xml.create_element("CoSimulation")
        .with_attribute(("modelIdentifier", model_identifier))
        .with_attributes([
            ("needsExecutionTool", "false"),
            ("canHandleVariableCommunicationStepSize", "true"),
            ("canInterpolateInputs", "true"),
            ("maxOutputDerivativeOrder", "1"),
            ("canRunAsynchronuously", "false"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            // The callbacks' allocator is never used: every instance owns its memory.
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            ("providesDirectionalDerivative", "false"),
        ])
        .write_empty()?;
    Ok(())
}

/// Units in use, in the order of their declaration.
fn used_units(table: &[Variable]) -> BTreeSet<Unit> {
    table
        .iter()
        .filter(|v| v.kind == Kind::Real)
        .map(|v| v.unit)
        .collect()
}

fn unit_definitions(xml: &mut Writer<Vec<u8>>, table: &[Variable]) -> io::Result<()> {
    list(
        xml,
        "UnitDefinitions",
        used_units(table).iter(),
        |xml, unit| {
            let facts = units::facts(*unit);
            xml.create_element("Unit")
                .with_attribute(("name", facts.name))
                .write_inner_content(|xml| {
                    let mut base = xml.create_element("BaseUnit");
                    for (symbol, exponent) in facts.exponents.iter().filter(|(_, n)| *n != 0) {
                        base = base.with_attribute((*symbol, exponent.to_string().as_str()));
                    }
                    base.write_empty()?;
                    for &(name, factor) in facts.display {
                        xml.create_element("DisplayUnit")
                            .with_attribute(("name", name))
                            .with_attribute(("factor", number(factor).as_str()))
                            .write_empty()?;
                    }
                    Ok(())
                })?;
            Ok(())
        },
    )
}

fn type_definitions(xml: &mut Writer<Vec<u8>>, table: &[Variable]) -> io::Result<()> {
    list(
        xml,
        "TypeDefinitions",
        used_units(table).iter(),
        |xml, unit| {
            let facts = units::facts(*unit);
            xml.create_element("SimpleType")
                .with_attribute(("name", facts.quantity))
                .write_inner_content(|xml| {
                    let mut real = xml
                        .create_element("Real")
                        .with_attribute(("quantity", facts.quantity))
                        .with_attribute(("unit", facts.name));
                    if let Some(&(display, _)) = facts.display.first() {
                        real = real.with_attribute(("displayUnit", display));
                    }
                    real.write_empty()?;
                    Ok(())
                })?;
            Ok(())
        },
    )
}

fn scalar_variable(xml: &mut Writer<Vec<u8>>, v: &Variable) -> io::Result<()> {
    let mut element = xml
        .create_element("ScalarVariable")
        .with_attribute(("name", clean(&v.name).as_str()))
        .with_attribute(("valueReference", v.value_reference.to_string().as_str()))
        .with_attribute(("description", clean(&v.description).as_str()))
        .with_attribute(("causality", causality(v)))
        .with_attribute(("variability", variability(v)));
    // FMI forbids `initial` on inputs.
    match v.slot {
        Slot::Input(_) => {}
        Slot::Parameter(_) => element = element.with_attribute(("initial", "exact")),
        Slot::Output(_) => element = element.with_attribute(("initial", "calculated")),
    }
    element.write_inner_content(|xml| {
        let mut value = xml.create_element(match v.kind {
            Kind::Real => "Real",
            Kind::Integer => "Integer",
            Kind::Boolean => "Boolean",
        });
        if v.kind == Kind::Real {
            let facts = units::facts(v.unit);
            value = value
                .with_attribute(("declaredType", facts.quantity))
                .with_attribute(("unit", facts.name));
            if let Some(display) = v.display {
                value = value.with_attribute(("displayUnit", units::display(display)));
            }
            if let Some(nominal) = v.nominal {
                value = value.with_attribute(("nominal", number(nominal).as_str()));
            }
        }
        // An output has neither start nor range: it is what the physics says.
        if !matches!(v.slot, Slot::Output(_)) {
            for (name, bound) in [("min", v.min), ("max", v.max)] {
                if let Some(bound) = bound.filter(|_| v.kind != Kind::Boolean) {
                    value = value.with_attribute((name, number(bound).as_str()));
                }
            }
            if let Some(start) = v.start {
                let text = if v.kind == Kind::Boolean {
                    (start != 0.0).to_string()
                } else {
                    number(start)
                };
                value = value.with_attribute(("start", text.as_str()));
            }
        }
        value.write_empty()?;
        Ok(())
    })?;
    Ok(())
}

/// FMI's word for whose the value is.
pub fn causality(v: &Variable) -> &'static str {
    match v.causality() {
        Causality::Input => "input",
        Causality::Parameter => "parameter",
        Causality::Output => "output",
        Causality::Local => "local",
    }
}

/// FMI's word for when the value may change.
pub fn variability(v: &Variable) -> &'static str {
    match (v.slot, v.kind) {
        (Slot::Parameter(slot), _) if slot.tunable() => "tunable",
        (Slot::Parameter(_), _) => "fixed",
        (_, Kind::Real) if !v.stepped => "continuous",
        _ => "discrete",
    }
}

fn model_structure(xml: &mut Writer<Vec<u8>>, model: &Model, table: &[Variable]) -> io::Result<()> {
    // FMI counts variables from 1, in the order of the file.
    let outputs: Vec<_> = (1..)
        .zip(table)
        .filter_map(|(index, v)| match v.slot {
            Slot::Output(slot) if v.causality() == Causality::Output => Some((index, slot)),
            _ => None,
        })
        .collect();
    xml.create_element("ModelStructure")
        .write_inner_content(|xml| {
            // Values at the end of the step: what an importer sets afterwards does not show in
            // them.
            list(xml, "Outputs", outputs.iter(), |xml, (index, _)| {
                unknown(xml, *index, Some(&[]))
            })?;
            list(
                xml,
                "InitialUnknowns",
                outputs.iter(),
                |xml, (index, slot)| {
                    let dependencies = structure::initial_dependencies(model, table, *slot);
                    unknown(xml, *index, dependencies.as_deref())
                },
            )
        })?;
    Ok(())
}

/// `dependencies`: indexes from 1, ascending; none means that it may depend on everything.
fn unknown(
    xml: &mut Writer<Vec<u8>>,
    index: usize,
    dependencies: Option<&[usize]>,
) -> io::Result<()> {
    let mut element = xml
        .create_element("Unknown")
        .with_attribute(("index", index.to_string().as_str()));
    if let Some(dependencies) = dependencies {
        let text: Vec<_> = dependencies.iter().map(ToString::to_string).collect();
        element = element.with_attribute(("dependencies", text.join(" ").as_str()));
    }
    element.write_empty()?;
    Ok(())
}

/// An element around a list; absent when the list is empty, as FMI asks.
fn list<T>(
    xml: &mut Writer<Vec<u8>>,
    name: &'static str,
    items: impl ExactSizeIterator<Item = T>,
    write: impl Fn(&mut Writer<Vec<u8>>, T) -> io::Result<()>,
) -> io::Result<()> {
    if items.len() == 0 {
        return Ok(());
    }
    xml.create_element(name).write_inner_content(|xml| {
        for item in items {
            write(xml, item)?;
        }
        Ok(())
    })?;
    Ok(())
}

/// Shortest text that reads back as the same double.
pub fn number(x: f64) -> String {
    // A negative zero would only puzzle readers.
    let text = format!("{:?}", if x == 0.0 { 0.0 } else { x });
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Text as an XML 1.0 attribute may hold it, on one line.
fn clean(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\u{FFFE}' | '\u{FFFF}' => '\u{FFFD}',
            c if c.is_control() => ' ',
            c => c,
        })
        .collect()
}

#[cfg(test)]
#[path = "describe_tests.rs"]
mod tests;
