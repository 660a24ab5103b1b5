//! modelDescription.xml of FMI 3.0: a variable for each entry of the table.
//!
//! The elements of vectors stand in an annotation of the model by their own names, so that a reader
//! can tell which is which; this program's importer shows them under these names. In annotations of
//! the variables `FMILibrary` 3.0 would overlook the dimensions, which follow them.
//!
//! Source: FMI 3.0 specification, sections 2.4, 3.3 and 4.4.

use super::shared::{
    DescribeError, Header, TOOL, check, clean, default_experiment, list, log_categories, naming,
    number, unit_definitions, used_units,
};
use super::words::{ELEMENTS, causality, variability};
use crate::structure;
use crate::units;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::simulation::OutputSlot;
use urdf2fmu_core::variables::{
    Causality, Entry, Kind, Slot, Unit, Variable, entries, time_reference,
};

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
    let entries = entries(model, table)?;
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let mut root = xml.create_element("fmiModelDescription");
    let about = header.about;
    for (name, text) in [
        ("author", &about.author),
        ("version", &about.version),
        ("copyright", &about.copyright),
        ("license", &about.license),
    ] {
        if let Some(text) = text {
            root = root.with_attribute((name, clean(text).as_str()));
        }
    }
    root.with_attribute(("fmiVersion", "3.0"))
        .with_attribute(("modelName", clean(header.model_name).as_str()))
        .with_attribute(("instantiationToken", header.guid))
        .with_attribute(("description", clean(header.description).as_str()))
        .with_attribute(("generationTool", TOOL))
        .with_attribute(("generationDateAndTime", header.date))
        .with_attribute(("variableNamingConvention", naming(model)))
        .write_inner_content(|xml| {
            let interface = model.outputs.interface;
            if interface.exchanges() {
                model_exchange(xml, header.model_identifier)?;
            }
            if interface.steps() {
                co_simulation(xml, header.model_identifier)?;
            }
            let mut units = used_units(table);
            units.insert(Unit::Second);
            unit_definitions(xml, &units)?;
            type_definitions(xml, &units)?;
            log_categories(xml)?;
            default_experiment(xml, about, interface)?;
            xml.create_element("ModelVariables")
                .write_inner_content(|xml| {
                    time(xml, table)?;
                    entries
                        .iter()
                        .try_for_each(|entry| variable(xml, model, (table, &entries), entry))
                })?;
            model_structure(xml, model, table, &entries)?;
            elements(xml, table, &entries)
        })?;
    let mut text = xml.into_inner();
    text.push(b'\n');
    Ok(text)
}

fn model_exchange(xml: &mut Writer<Vec<u8>>, model_identifier: &str) -> io::Result<()> {
    let own = [
        ("needsCompletedIntegratorStep", "true"),
        ("providesEvaluateDiscreteStates", "false"),
    ];
    interface(xml, "ModelExchange", model_identifier, "true", &own)
}

fn co_simulation(xml: &mut Writer<Vec<u8>>, model_identifier: &str) -> io::Result<()> {
    let own = [
        ("canHandleVariableCommunicationStepSize", "true"),
        ("maxOutputDerivativeOrder", "1"),
        ("providesIntermediateUpdate", "true"),
        // Only at the importer's request.
        ("mightReturnEarlyFromDoStep", "false"),
        ("canReturnEarlyAfterIntermediateUpdate", "true"),
        ("hasEventMode", "false"),
    ];
    interface(xml, "CoSimulation", model_identifier, "false", &own)
}

/// The element of an interface: what both say, whether it has directional derivatives, and what is
/// its `own`.
fn interface(
    xml: &mut Writer<Vec<u8>>,
    name: &str,
    model_identifier: &str,
    directional: &str,
    own: &[(&str, &str)],
) -> io::Result<()> {
    xml.create_element(name)
        .with_attribute(("modelIdentifier", model_identifier))
        .with_attributes([
            ("needsExecutionTool", "false"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canGetAndSetFMUState", "true"),
            ("canSerializeFMUState", "true"),
            ("providesDirectionalDerivatives", directional),
            ("providesAdjointDerivatives", "false"),
            ("providesPerElementDependencies", "false"),
        ])
        .with_attributes(own.iter().copied())
        .write_empty()?;
    Ok(())
}

fn type_definitions(xml: &mut Writer<Vec<u8>>, units: &BTreeSet<Unit>) -> io::Result<()> {
    list(xml, "TypeDefinitions", units.iter(), |xml, unit| {
        let facts = units::facts(*unit);
        let mut float = xml
            .create_element("Float64Type")
            .with_attribute(("name", facts.quantity))
            .with_attribute(("quantity", facts.quantity))
            .with_attribute(("unit", facts.name));
        if let Some(&(display, _)) = facts.display.first() {
            float = float.with_attribute(("displayUnit", display));
        }
        float.write_empty()?;
        Ok(())
    })
}

/// The independent variable.
fn time(xml: &mut Writer<Vec<u8>>, table: &[Variable]) -> io::Result<()> {
    let facts = units::facts(Unit::Second);
    xml.create_element("Float64")
        .with_attribute(("name", "time"))
        .with_attribute(("valueReference", time_reference(table).to_string().as_str()))
        .with_attribute(("description", "Simulation time"))
        .with_attribute(("causality", "independent"))
        .with_attribute(("variability", "continuous"))
        .with_attribute(("declaredType", facts.quantity))
        .with_attribute(("unit", facts.name))
        .write_empty()?;
    Ok(())
}

fn variable(
    xml: &mut Writer<Vec<u8>>,
    model: &Model,
    (table, entries): (&[Variable], &[Entry]),
    entry: &Entry,
) -> io::Result<()> {
    let rows: Vec<&Variable> = entry.rows.iter().map(|row| &table[*row as usize]).collect();
    // All rows of an entry have one type, causality and variability.
    let first = rows[0];
    let mut element = xml
        .create_element(match first.kind {
            Kind::Real => "Float64",
            Kind::Integer => "Int32",
            Kind::Boolean => "Boolean",
        })
        .with_attribute(("name", clean(&entry.name).as_str()))
        .with_attribute(("valueReference", entry.value_reference.to_string().as_str()))
        .with_attribute(("description", clean(&entry.description).as_str()))
        .with_attribute(("causality", causality(first)))
        .with_attribute(("variability", variability(first)));
    match first.slot {
        Slot::Input(_) => {}
        Slot::Parameter(_) => element = element.with_attribute(("initial", "exact")),
        Slot::Output(_) => element = element.with_attribute(("initial", "calculated")),
    }
    let within = rows.iter().all(|row| row.within_steps());
    if within && variability(first) == "continuous" && model.outputs.interface.steps() {
        element = element.with_attribute(("intermediateUpdate", "true"));
    }
    if first.kind == Kind::Real && rows.iter().all(|row| row.unit == first.unit) {
        let facts = units::facts(first.unit);
        element = element
            .with_attribute(("declaredType", facts.quantity))
            .with_attribute(("unit", facts.name));
        let all = |same: fn(&Variable, &Variable) -> bool| rows.iter().all(|row| same(row, first));
        if let Some(display) = first.display.filter(|_| all(|a, b| a.display == b.display)) {
            element = element.with_attribute(("displayUnit", units::display(display)));
        }
        if let Some(nominal) = first.nominal.filter(|_| all(|a, b| a.nominal == b.nominal)) {
            element = element.with_attribute(("nominal", number(nominal).as_str()));
        }
    }
    if let Slot::Output(OutputSlot::Rate(id)) = first.slot {
        let is_state = |entry: &&Entry| table[entry.rows[0] as usize].state == Some(id);
        // What gathers rows of others is none.
        let own = |entry: &&Entry| entry.rows[0] == entry.value_reference;
        if let Some(state) = entries.iter().filter(own).find(is_state) {
            let reference = state.value_reference.to_string();
            element = element.with_attribute(("derivative", reference.as_str()));
        }
    }
    // An output has neither start nor range: it is what the physics says.
    if !matches!(first.slot, Slot::Output(_)) {
        type Bound = fn(&Variable) -> Option<f64>;
        let bounds: [(&str, Bound); 2] = [("min", |v| v.min), ("max", |v| v.max)];
        for (name, of) in bounds {
            // A bound holds for all elements.
            let bound = of(first).filter(|_| first.kind != Kind::Boolean);
            if let Some(bound) = bound.filter(|_| rows.iter().all(|row| of(row) == bound)) {
                element = element.with_attribute((name, number(bound).as_str()));
            }
        }
        let starts: Option<Vec<String>> = rows
            .iter()
            .map(|row| {
                let boolean = |x: f64| (x != 0.0).to_string();
                row.start.map(if row.kind == Kind::Boolean {
                    boolean
                } else {
                    number
                })
            })
            .collect();
        if let Some(starts) = starts {
            element = element.with_attribute(("start", starts.join(" ").as_str()));
        }
    }
    if entry.shape.is_empty() {
        element.write_empty()?;
        return Ok(());
    }
    element.write_inner_content(|xml| {
        for size in &entry.shape {
            xml.create_element("Dimension")
                .with_attribute(("start", size.to_string().as_str()))
                .write_empty()?;
        }
        Ok(())
    })?;
    Ok(())
}

/// The names of the elements of all arrays.
fn elements(xml: &mut Writer<Vec<u8>>, table: &[Variable], entries: &[Entry]) -> io::Result<()> {
    let arrays = entries.iter().filter(|entry| !entry.shape.is_empty());
    let lines: Vec<String> = arrays
        .map(|entry| {
            let names = entry.rows.iter().map(|row| &table[*row as usize].name);
            let names: Vec<String> = names.map(|name| clean(name)).collect();
            format!("{} {}", entry.value_reference, names.join(" "))
        })
        .collect();
    if lines.is_empty() {
        return Ok(());
    }
    xml.create_element("Annotations")
        .write_inner_content(|xml| {
            xml.create_element("Annotation")
                .with_attribute(("type", ELEMENTS))
                .write_text_content(BytesText::new(&lines.join("\n")))?;
            Ok(())
        })?;
    Ok(())
}

fn model_structure(
    xml: &mut Writer<Vec<u8>>,
    model: &Model,
    table: &[Variable],
    entries: &[Entry],
) -> io::Result<()> {
    // The entry that a row belongs to; one that gathers rows of others is none.
    let mut owner = BTreeMap::new();
    for entry in entries {
        for row in &entry.rows {
            owner.insert(*row, entry.value_reference);
        }
    }
    let exchanges = model.outputs.interface.exchanges();
    let listed = |wanted: fn(&Variable) -> bool| -> Vec<&Entry> {
        let all = entries.iter();
        all.filter(|entry| wanted(&table[entry.rows[0] as usize]))
            .collect()
    };
    let is_rate = |slot: Slot| matches!(slot, Slot::Output(OutputSlot::Rate(_)));
    let outputs = listed(|row| row.causality() == Causality::Output);
    let rates: Vec<&Entry> = entries
        .iter()
        .filter(|entry| is_rate(table[entry.rows[0] as usize].slot))
        .collect();
    let indicators = listed(|row| row.slot == Slot::Output(OutputSlot::Indicator));
    let initial = listed(|row| matches!(row.slot, Slot::Output(slot) if slot.begins()));
    // Rows are counted from 1.
    let references = |rows: Option<Vec<Vec<usize>>>| {
        rows.map(|rows| {
            let rows = rows.iter().flatten();
            rows.filter_map(|row| owner.get(&u32::try_from(row - 1).ok()?).copied())
                .collect::<BTreeSet<u32>>()
        })
    };
    let own = |entry: &Entry| {
        if exchanges {
            let of_row = |row: &u32| structure::dependencies(table, &table[*row as usize]);
            references(entry.rows.iter().map(of_row).collect())
        } else {
            // Values at the end of the step: what an importer sets afterwards does not show in
            // them.
            Some(BTreeSet::new())
        }
    };
    xml.create_element("ModelStructure")
        .write_inner_content(|xml| {
            for entry in &outputs {
                unknown(xml, "Output", entry.value_reference, own(entry).as_ref())?;
            }
            for entry in &rates {
                let reference = entry.value_reference;
                unknown(
                    xml,
                    "ContinuousStateDerivative",
                    reference,
                    own(entry).as_ref(),
                )?;
            }
            for entry in &initial {
                let of_row = |row: &u32| match table[*row as usize].slot {
                    Slot::Output(slot) => structure::initial_dependencies(model, table, slot),
                    Slot::Input(_) | Slot::Parameter(_) => None,
                };
                let dependencies = references(entry.rows.iter().map(of_row).collect());
                let reference = entry.value_reference;
                unknown(xml, "InitialUnknown", reference, dependencies.as_ref())?;
            }
            for entry in &indicators {
                let reference = entry.value_reference;
                unknown(xml, "EventIndicator", reference, own(entry).as_ref())?;
            }
            Ok(())
        })?;
    Ok(())
}

/// `dependencies`: value references; none means that it may depend on everything.
fn unknown(
    xml: &mut Writer<Vec<u8>>,
    name: &'static str,
    reference: u32,
    dependencies: Option<&BTreeSet<u32>>,
) -> io::Result<()> {
    let mut element = xml
        .create_element(name)
        .with_attribute(("valueReference", reference.to_string().as_str()));
    if let Some(dependencies) = dependencies {
        let text: Vec<_> = dependencies.iter().map(ToString::to_string).collect();
        element = element.with_attribute(("dependencies", text.join(" ").as_str()));
    }
    element.write_empty()?;
    Ok(())
}
