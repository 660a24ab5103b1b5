//! A reader of modelDescription.xml with the rules of FMI 2.0 that the schema does not express.
//!
//! Written against the specification (FMI 2.0.4, sections 2.2.3, 2.2.7 and 2.2.8), not against the
//! writer.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::{BTreeMap, BTreeSet};

/// An element with its attributes and children.
#[derive(Debug, Default)]
pub struct Element {
    pub name: String,
    pub attributes: BTreeMap<String, String>,
    pub children: Vec<Element>,
}

impl Element {
    fn new(start: &BytesStart) -> Self {
        let text = |name: &[u8]| String::from_utf8(name.to_vec()).unwrap();
        Self {
            name: text(start.name().as_ref().as_ref()),
            attributes: start
                .attributes()
                .map(|a| {
                    let a = a.unwrap();
                    let key = text(a.key.as_ref().as_ref());
                    let value = a
                        .normalized_value(quick_xml::XmlVersion::Implicit1_0)
                        .unwrap();
                    (key, value.into_owned())
                })
                .collect(),
            children: Vec::new(),
        }
    }

    /// The document's root.
    pub fn read(text: &str) -> Self {
        let mut reader = Reader::from_str(text);
        let mut stack = vec![Self::default()];
        loop {
            match reader.read_event().unwrap() {
                Event::Start(start) => stack.push(Self::new(&start)),
                Event::Empty(start) => stack.last_mut().unwrap().children.push(Self::new(&start)),
                Event::End(_) => {
                    let done = stack.pop().unwrap();
                    stack.last_mut().unwrap().children.push(done);
                }
                Event::Eof => break,
                _ => {}
            }
        }
        stack.pop().unwrap().children.pop().unwrap()
    }

    pub fn get(&self, attribute: &str) -> Option<&str> {
        self.attributes.get(attribute).map(String::as_str)
    }

    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|c| c.name == name)
    }

    /// Children of the child `name`; nothing where there is no such child.
    pub fn list(&self, name: &str) -> &[Element] {
        self.child(name).map_or(&[], |c| &c.children)
    }
}

/// Every rule that `text` breaks, in words.
pub fn problems(text: &str) -> Vec<String> {
    let root = Element::read(text);
    let mut found = Vec::new();
    header(&root, &mut found);
    let units: BTreeSet<&str> = root
        .list("UnitDefinitions")
        .iter()
        .filter_map(|u| u.get("name"))
        .collect();
    let types: BTreeSet<&str> = root
        .list("TypeDefinitions")
        .iter()
        .filter_map(|u| u.get("name"))
        .collect();
    let variables = root.list("ModelVariables");
    for v in variables {
        variable(v, &units, &types, &mut found);
    }
    let mut seen = BTreeSet::new();
    for v in variables {
        for attribute in ["name", "valueReference"] {
            if !seen.insert((attribute, v.get(attribute))) {
                found.push(format!("{attribute} {:?} occurs twice", v.get(attribute)));
            }
        }
    }
    arrays(variables, &mut found);
    structure(&root, variables, &mut found);
    found
}

/// Elements of an array, `name[1]`, `name[2]` … or `name[1,1]`, `name[1,2]` …, stand one after the
/// other, the last index runs first, and none is missing.
fn arrays(variables: &[Element], found: &mut Vec<String>) {
    let element = |v: &Element| -> Option<(String, Vec<usize>)> {
        let name = v.get("name").unwrap_or_default();
        let (array, indices) = name.strip_suffix(']')?.rsplit_once('[')?;
        let indices = indices.split(',').map(|index| index.parse().unwrap_or(0));
        Some((array.to_owned(), indices.collect()))
    };
    let elements: Vec<_> = variables.iter().map(element).collect();
    let mut ended = BTreeSet::new();
    for run in elements.chunk_by(|a, b| a.as_ref().map(|a| &a.0) == b.as_ref().map(|b| &b.0)) {
        let run: Vec<_> = run.iter().flatten().collect();
        let Some((array, last)) = run.last() else {
            continue;
        };
        let all: Vec<Vec<usize>> = match last[..] {
            [count] => (1..=count).map(|i| vec![i]).collect(),
            [rows, columns] => (1..=rows)
                .flat_map(|row| (1..=columns).map(move |column| vec![row, column]))
                .collect(),
            _ => Vec::new(),
        };
        if !run.iter().map(|(_, indices)| indices).eq(&all) || !ended.insert(array.clone()) {
            found.push(format!("{array}: elements of an array are not consecutive"));
        }
    }
}

fn header(root: &Element, found: &mut Vec<String>) {
    const ORDER: [&str; 9] = [
        "ModelExchange",
        "CoSimulation",
        "UnitDefinitions",
        "TypeDefinitions",
        "LogCategories",
        "DefaultExperiment",
        "VendorAnnotations",
        "ModelVariables",
        "ModelStructure",
    ];
    if root.name != "fmiModelDescription" || root.get("fmiVersion") != Some("2.0") {
        found.push("not an FMI 2.0 model description".to_owned());
    }
    let places: Vec<_> = root
        .children
        .iter()
        .map(|c| ORDER.iter().position(|name| *name == c.name))
        .collect();
    if places.contains(&None) || !places.windows(2).all(|w| w[0] < w[1]) {
        found.push("elements out of order".to_owned());
    }
    for list in &root.children {
        let may_be_empty = ["CoSimulation", "DefaultExperiment", "ModelStructure"];
        if list.children.is_empty() && !may_be_empty.contains(&list.name.as_str()) {
            found.push(format!("empty {}", list.name));
        }
    }
    let date = root.get("generationDateAndTime").unwrap_or_default();
    if date.len() != 20 || !date.ends_with('Z') || date.as_bytes()[10] != b'T' {
        found.push(format!("date {date:?}"));
    }
    let Some(cs) = root.child("CoSimulation") else {
        found.push("no CoSimulation".to_owned());
        return;
    };
    let identifier = cs.get("modelIdentifier").unwrap_or_default();
    let legal = identifier.starts_with(|c: char| c.is_ascii_alphabetic())
        && identifier
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !legal {
        found.push(format!("modelIdentifier {identifier:?}"));
    }
    if cs.get("canSerializeFMUstate") == Some("true")
        && cs.get("canGetAndSetFMUstate") != Some("true")
    {
        found.push("state that can be serialised but not read".to_owned());
    }
    // They would need dependencies of all unknowns on all knowns, and fmi2GetDirectionalDerivative
    // is not answered.
    if cs.get("providesDirectionalDerivative") == Some("true") {
        found.push("directional derivatives".to_owned());
    }
}

fn variable(v: &Element, units: &BTreeSet<&str>, types: &BTreeSet<&str>, found: &mut Vec<String>) {
    let name = v.get("name").unwrap_or_default();
    let mut wrong = |what: &str| found.push(format!("{name}: {what}"));
    let [value] = v.children.as_slice() else {
        return wrong("not exactly one type");
    };
    let real = value.name == "Real";
    let number = |attribute: &str| -> Option<f64> {
        value.get(attribute).map(|text| match text {
            "true" => 1.0,
            "false" => 0.0,
            text => text.parse().unwrap_or(f64::NAN),
        })
    };
    for attribute in ["start", "min", "max"] {
        if number(attribute).is_some_and(|x| !x.is_finite()) {
            wrong(&format!("{attribute} is no finite number"));
        }
    }
    let (min, max) = (
        number("min").unwrap_or(f64::NEG_INFINITY),
        number("max").unwrap_or(f64::INFINITY),
    );
    if min > max {
        wrong("min > max");
    }
    if number("start").is_some_and(|start| start < min || start > max) {
        wrong("start outside min … max");
    }
    // Table of section 2.2.7: which combinations are legal, and where a start belongs.
    let (causality, variability) = (v.get("causality"), v.get("variability"));
    let legal = match causality {
        Some("parameter") => {
            matches!(variability, Some("fixed" | "tunable")) && v.get("initial") == Some("exact")
        }
        Some("input") => v.get("initial").is_none(),
        Some("output" | "local") => v.get("initial") == Some("calculated"),
        _ => false,
    };
    if !legal {
        wrong(&format!(
            "{causality:?} {variability:?} {:?}",
            v.get("initial")
        ));
    }
    if !real && !matches!(variability, Some("discrete" | "fixed" | "tunable")) {
        wrong("only a Real can be continuous");
    }
    let output = matches!(causality, Some("output" | "local"));
    if output == value.get("start").is_some() {
        wrong("start");
    }
    if output && (value.get("min").is_some() || value.get("max").is_some()) {
        wrong("range of an output");
    }
    if real && !value.get("unit").is_some_and(|unit| units.contains(unit)) {
        wrong("undefined unit");
    }
    if value
        .get("declaredType")
        .is_some_and(|t| !types.contains(t))
    {
        wrong("undefined type");
    }
}

fn structure(root: &Element, variables: &[Element], found: &mut Vec<String>) {
    let Some(structure) = root.child("ModelStructure") else {
        found.push("no ModelStructure".to_owned());
        return;
    };
    // Indexes count from 1.
    let with_causality = |wanted: &str| -> BTreeSet<usize> {
        (1..)
            .zip(variables)
            .filter(|(_, v)| v.get("causality") == Some(wanted))
            .map(|(index, _)| index)
            .collect()
    };
    let outputs = with_causality("output");
    let inputs = with_causality("input");
    let parameters = with_causality("parameter");
    for list in ["Outputs", "InitialUnknowns"] {
        let mut indexes = Vec::new();
        for unknown in structure.list(list) {
            let index: usize = unknown.get("index").unwrap().parse().unwrap();
            indexes.push(index);
            let Some(text) = unknown.get("dependencies") else {
                continue;
            };
            let dependencies: Vec<usize> = text
                .split_whitespace()
                .map(|i| i.parse().unwrap())
                .collect();
            if !dependencies.windows(2).all(|w| w[0] < w[1]) {
                found.push(format!("{list} {index}: dependencies not ascending"));
            }
            for d in dependencies {
                let known =
                    inputs.contains(&d) || list == "InitialUnknowns" && parameters.contains(&d);
                if !known {
                    found.push(format!("{list} {index} depends on {d}, which is not known"));
                }
            }
            let kinds = unknown
                .get("dependenciesKind")
                .map(|k| k.split_whitespace().count());
            if kinds.is_some_and(|n| n != text.split_whitespace().count()) {
                found.push(format!(
                    "{list} {index}: kinds and dependencies differ in number"
                ));
            }
        }
        if !indexes.windows(2).all(|w| w[0] < w[1]) {
            found.push(format!("{list} not ascending"));
        }
        if indexes.into_iter().collect::<BTreeSet<_>>() != outputs {
            found.push(format!("{list} are not the outputs"));
        }
    }
}
