//! What modelDescription.xml of both versions of FMI has in common.

pub(super) use super::words::number;
use super::words::{EXCHANGE_TOLERANCE, STEP_SIZE, STOP_TIME, TOLERANCE};
use crate::units;
use quick_xml::Writer;
use std::collections::BTreeSet;
use std::io;
use urdf2fmu_core::model::{Interface, Model};
use urdf2fmu_core::settings::FmuSettings;
use urdf2fmu_core::variables::{Kind, Slot, TableError, Unit, Variable};

/// As `generationTool` names this program.
pub(super) const TOOL: &str = concat!("urdf2fmu ", env!("CARGO_PKG_VERSION"));

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
    /// The name of a vector is that of another variable.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The writer writes to memory, so this does not happen.
    #[error("cannot write modelDescription.xml: {0}")]
    Write(#[from] io::Error),
}

/// The rules of FMI that the schema does not express.
pub(super) fn check(table: &[Variable]) -> Result<(), DescribeError> {
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

/// Units in use, in the order of their declaration.
pub(super) fn used_units(table: &[Variable]) -> BTreeSet<Unit> {
    table
        .iter()
        .filter(|v| v.kind == Kind::Real)
        .map(|v| v.unit)
        .collect()
}

/// The units and how they are made of base units.
pub(super) fn unit_definitions(
    xml: &mut Writer<Vec<u8>>,
    units: &BTreeSet<Unit>,
) -> io::Result<()> {
    list(xml, "UnitDefinitions", units.iter(), |xml, unit| {
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
    })
}

/// `variableNamingConvention`
pub(super) fn naming(model: &Model) -> &'static str {
    if model.outputs.flat_names {
        "flat"
    } else {
        "structured"
    }
}

/// FMI's own categories.
pub(super) fn log_categories(xml: &mut Writer<Vec<u8>>) -> io::Result<()> {
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
    )
}

/// Times and tolerance that importers begin with.
pub(super) fn default_experiment(
    xml: &mut Writer<Vec<u8>>,
    about: &FmuSettings,
    interface: Interface,
) -> io::Result<()> {
    let tolerance = if interface.exchanges() {
        EXCHANGE_TOLERANCE
    } else {
        TOLERANCE
    };
    xml.create_element("DefaultExperiment")
        .with_attribute(("startTime", "0"))
        .with_attribute((
            "stopTime",
            number(about.stop_time.unwrap_or(STOP_TIME)).as_str(),
        ))
        .with_attribute(("tolerance", number(tolerance).as_str()))
        .with_attribute(("stepSize", number(STEP_SIZE).as_str()))
        .write_empty()?;
    Ok(())
}

/// An element around a list; absent when the list is empty, as FMI asks.
pub(super) fn list<T>(
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

/// Text as an XML 1.0 attribute may hold it, on one line.
pub(super) fn clean(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\u{FFFE}' | '\u{FFFF}' => '\u{FFFD}',
            c if c.is_control() => ' ',
            c => c,
        })
        .collect()
}
