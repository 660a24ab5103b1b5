//! The parameters of an FMU as an SSV file, which tools that connect FMUs read.
//!
//! Source: System Structure and Parameterization 1.0, chapter 6 (parameter values) and 4.2 (units);
//! where the FMU has arrays, 2.0, which has them, too.

use crate::listing::Listed;
use crate::units;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::collections::BTreeSet;
use std::io;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::variables::{Kind, Slot, Unit, Variable};

const VALUES: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
const COMMON: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";

/// Each parameter with the value that it starts with, and its unit.
///
/// # Errors
/// [`io::Error`] of the writer.
pub fn text(model: &Model, listed: &[Listed]) -> io::Result<String> {
    let parameters = listed.iter();
    let parameters: Vec<&Listed> = parameters
        .filter(|v| matches!(v.first().slot, Slot::Parameter(_)))
        .collect();
    let scalar = parameters.iter().all(|v| v.shape.is_empty());
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("ssv:ParameterSet")
        .with_attribute(("xmlns:ssv", VALUES))
        .with_attribute(("xmlns:ssc", COMMON))
        .with_attribute(("version", if scalar { "1.0" } else { "2.0" }))
        .with_attribute(("name", model.name.as_str()))
        .write_inner_content(|xml| {
            xml.create_element("ssv:Parameters")
                .write_inner_content(|xml| parameters.iter().try_for_each(|v| parameter(xml, v)))?;
            let of_file = parameters.iter().map(|v| v.first());
            let reals = of_file.filter(|v| v.kind == Kind::Real);
            let used: BTreeSet<Unit> = reals.map(|v| v.unit).collect();
            xml.create_element("ssv:Units")
                .write_inner_content(|xml| used.iter().try_for_each(|u| unit(xml, *u)))?;
            Ok(())
        })?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    String::from_utf8(bytes).map_err(io::Error::other)
}

fn value(v: &Variable) -> String {
    let start = v.start.unwrap_or_default();
    match v.kind {
        Kind::Real => format!("{start:?}"),
        Kind::Integer => format!("{start:.0}"),
        Kind::Boolean => (start != 0.0).to_string(),
    }
}

fn parameter(xml: &mut Writer<Vec<u8>>, v: &Listed) -> io::Result<()> {
    let values: Vec<String> = v.rows.iter().map(|row| value(row)).collect();
    let values = values.join(" ");
    let kind = match v.first().kind {
        Kind::Real => "ssv:Real",
        Kind::Integer => "ssv:Integer",
        Kind::Boolean => "ssv:Boolean",
    };
    xml.create_element("ssv:Parameter")
        .with_attribute(("name", v.name.as_str()))
        .write_inner_content(|xml| {
            let mut element = xml
                .create_element(kind)
                .with_attribute(("value", values.as_str()));
            // Elements of one parameter have one unit.
            if !v.unit().is_empty() {
                element = element.with_attribute(("unit", v.unit()));
            }
            element.write_empty()?;
            for size in &v.shape {
                let element = xml.create_element("ssc:Dimension");
                let element = element.with_attribute(("size", size.to_string().as_str()));
                element.write_empty()?;
            }
            Ok(())
        })?;
    Ok(())
}

fn unit(xml: &mut Writer<Vec<u8>>, unit: Unit) -> io::Result<()> {
    let facts = units::facts(unit);
    xml.create_element("ssc:Unit")
        .with_attribute(("name", facts.name))
        .write_inner_content(|xml| {
            let mut base = xml.create_element("ssc:BaseUnit");
            for (symbol, exponent) in facts.exponents.iter().filter(|(_, n)| *n != 0) {
                base = base.with_attribute((*symbol, exponent.to_string().as_str()));
            }
            base.write_empty()?;
            Ok(())
        })?;
    Ok(())
}
