//! modelDescription.xml of FMI 2.0: a variable for each row of the table.
//!
//! Source: FMI 2.0.4 specification, sections 2.2, 3.3 and 4.3.

use super::shared::{
    DescribeError, Header, TOOL, check, clean, default_experiment, list, log_categories, naming,
    number, unit_definitions, used_units,
};
use super::words::{causality, variability};
use crate::structure;
use crate::units;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::collections::BTreeSet;
use std::io;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::simulation::OutputSlot;
use urdf2fmu_core::variables::{Causality, Kind, Slot, Unit, Variable};

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
    let is_indicator = |v: &&Variable| v.slot == Slot::Output(OutputSlot::Indicator);
    let indicators = table.iter().filter(is_indicator).count();
    root.with_attribute(("fmiVersion", "2.0"))
        .with_attribute(("modelName", clean(header.model_name).as_str()))
        .with_attribute(("guid", header.guid))
        .with_attribute(("description", clean(header.description).as_str()))
        .with_attribute(("license", clean(license).as_str()))
        .with_attribute(("generationTool", TOOL))
        .with_attribute(("generationDateAndTime", header.date))
        .with_attribute(("variableNamingConvention", naming(model)))
        .with_attribute(("numberOfEventIndicators", indicators.to_string().as_str()))
        .write_inner_content(|xml| {
            let interface = model.outputs.interface;
            if interface.exchanges() {
                model_exchange(xml, header.model_identifier)?;
            }
            if interface.steps() {
                co_simulation(xml, header.model_identifier)?;
            }
            let units = used_units(table);
            unit_definitions(xml, &units)?;
            type_definitions(xml, &units)?;
            log_categories(xml)?;
            default_experiment(xml, about, interface)?;
            list(xml, "ModelVariables", table.iter(), |xml, v| {
                scalar_variable(xml, table, v)
            })?;
            model_structure(xml, model, table)
        })?;
    let mut text = xml.into_inner();
    text.push(b'\n');
    Ok(text)
}

fn model_exchange(xml: &mut Writer<Vec<u8>>, model_identifier: &str) -> io::Result<()> {
    xml.create_element("ModelExchange")
        .with_attribute(("modelIdentifier", model_identifier))
        .with_attributes([
            ("needsExecutionTool", "false"),
            ("completedIntegratorStepNotNeeded", "false"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            ("providesDirectionalDerivative", "true"),
        ])
        .write_empty()?;
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

fn type_definitions(xml: &mut Writer<Vec<u8>>, units: &BTreeSet<Unit>) -> io::Result<()> {
    list(xml, "TypeDefinitions", units.iter(), |xml, unit| {
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
    })
}

/// FMI counts variables from 1, in the order of the file.
fn index_of(table: &[Variable], which: impl Fn(&Variable) -> bool) -> Option<usize> {
    table.iter().position(which).map(|place| place + 1)
}

fn scalar_variable(xml: &mut Writer<Vec<u8>>, table: &[Variable], v: &Variable) -> io::Result<()> {
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
            if let Slot::Output(OutputSlot::Rate(id)) = v.slot
                && let Some(state) = index_of(table, |v| v.state == Some(id))
            {
                value = value.with_attribute(("derivative", state.to_string().as_str()));
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

fn model_structure(xml: &mut Writer<Vec<u8>>, model: &Model, table: &[Variable]) -> io::Result<()> {
    let exchanges = model.outputs.interface.exchanges();
    let listed = |wanted: fn(&Variable, OutputSlot) -> bool| -> Vec<_> {
        let rows = (1..).zip(table).filter_map(|(index, v)| match v.slot {
            Slot::Output(slot) if wanted(v, slot) => Some((index, v, slot)),
            _ => None,
        });
        rows.collect()
    };
    let outputs = listed(|v, _| v.causality() == Causality::Output);
    let rates = listed(|_, slot| matches!(slot, OutputSlot::Rate(_)));
    let initial = listed(|_, slot| slot.begins());
    let own = |v: &Variable| {
        if exchanges {
            structure::dependencies(table, v)
        } else {
            // Values at the end of the step: what an importer sets afterwards does not show in
            // them.
            Some(Vec::new())
        }
    };
    xml.create_element("ModelStructure")
        .write_inner_content(|xml| {
            list(xml, "Outputs", outputs.iter(), |xml, (index, v, _)| {
                unknown(xml, *index, own(v).as_deref())
            })?;
            list(xml, "Derivatives", rates.iter(), |xml, (index, v, _)| {
                unknown(xml, *index, own(v).as_deref())
            })?;
            list(
                xml,
                "InitialUnknowns",
                initial.iter(),
                |xml, (index, _, slot)| {
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
