//! What an importer needs of modelDescription.xml.

use super::super::describe::ELEMENTS;
use super::arrays::{Array, Arrays, Size, is_type};
use super::attributes::{Attributes, DescriptionError};
use super::library::{Element, Interface};
use super::states::States;
use super::variable::{Kind, Variable};
use quick_xml::Reader;
use quick_xml::events::Event;
use std::collections::BTreeMap;
use urdf2fmu_core::encoding::xml_replaced;
use urdf2fmu_core::settings::FmiVersion;

/// What an importer needs to know of an FMU.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// Version of the standard.
    pub fmi: FmiVersion,
    /// Identifies the FMU: `guid`, `instantiationToken`.
    pub guid: String,
    /// Who integrates; the FMU, if it can.
    pub interface: Interface,
    /// Model Exchange: names of the continuous states, in their order.
    pub states: Vec<String>,
    /// File name of the library.
    pub model_identifier: String,
    /// Whether fmi2SetRealInputDerivatives has an effect.
    pub can_interpolate_inputs: bool,
    /// Whether steps of any length are possible.
    pub variable_step: bool,
    /// s
    pub start_time: Option<f64>,
    /// s
    pub stop_time: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// s
    pub step_size: Option<f64>,
    /// In the order of the file; of arrays each element.
    pub variables: Vec<Variable>,
    /// FMI 3: what the variables' handles mean.
    pub elements: Vec<Element>,
    /// FMI 3: names of the elements of arrays, by the arrays' names.
    pub arrays: BTreeMap<String, Vec<String>>,
}

impl Description {
    /// Reads modelDescription.xml in UTF-8, UTF-16 or the encoding that it declares; bytes that are
    /// no letters become U+FFFD.
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, DescriptionError> {
        Self::parse(&xml_replaced(bytes))
    }

    /// Reads the text of modelDescription.xml.
    ///
    /// # Errors
    /// [`DescriptionError`] if it is not that of an FMI 2.0 or 3.0 FMU that can be simulated here.
    pub fn parse(text: &str) -> Result<Self, DescriptionError> {
        let mut reader = Reader::from_str(text);
        let mut description = Self::default();
        let (mut co_simulation, mut model_exchange) = (None, None);
        let mut states = States::default();
        // The variable whose type is still to come.
        let mut pending: Option<Variable> = None;
        // FMI 3: the variable whose dimensions are still to come.
        let mut arrays = Arrays::default();
        loop {
            let event = reader.read_event().map_err(|error| {
                DescriptionError::Xml(format!("{error}, at byte {}", reader.error_position()))
            })?;
            let element = match event {
                Event::Eof => break,
                Event::Start(element) | Event::Empty(element) => element,
                Event::Text(text) => {
                    arrays.text(&text);
                    continue;
                }
                _ => continue,
            };
            let name = element.name().as_ref().to_owned();
            let attributes = Attributes::read(&element, &name)?;
            match name.as_str() {
                "fmiModelDescription" => {
                    states.indicators = description.identify(&attributes)?;
                    let tool = attributes.text("generationTool").unwrap_or_default();
                    states.announced = tool.starts_with("urdf2fmu ");
                }
                "CoSimulation" => {
                    co_simulation = Some(attributes.required("modelIdentifier")?);
                    description.can_interpolate_inputs = attributes.flag("canInterpolateInputs");
                    description.variable_step =
                        attributes.flag("canHandleVariableCommunicationStepSize");
                }
                "ModelExchange" => {
                    model_exchange = Some(attributes.required("modelIdentifier")?);
                }
                "DefaultExperiment" => {
                    description.start_time = attributes.number("startTime")?;
                    description.stop_time = attributes.number("stopTime")?;
                    description.tolerance = attributes.number("tolerance")?;
                    description.step_size = attributes.number("stepSize")?;
                }
                "ModelVariables" | "ModelStructure" => {
                    arrays.inside = name == "ModelVariables" && description.fmi == FmiVersion::V3;
                }
                "Outputs" | "Derivatives" | "InitialUnknowns" => {
                    states.inside = name == "Derivatives";
                }
                "Unknown" if states.inside => {
                    states.rates.push(attributes.whole("index")?);
                }
                "ContinuousStateDerivative" => states.rates.push(attributes.reference()?),
                "EventIndicator" => states.indicators += 1,
                "Dimension" if arrays.inside => arrays.dimension(size(&attributes)?),
                "Annotation" => {
                    arrays.named = attributes.text("type").as_deref() == Some(ELEMENTS);
                }
                name if arrays.inside && is_type(name) => {
                    if attributes.text("derivative").is_some() {
                        let state = attributes.whole("derivative")?;
                        states.of.insert(attributes.reference()?, state);
                    }
                    arrays.list.push(array(name, &attributes)?);
                }
                "ScalarVariable" => {
                    pending = Some(variable(&attributes)?);
                }
                "Real" | "Integer" | "Enumeration" | "Boolean" | "String" => {
                    // Outside of a variable it is a type definition.
                    if let Some(mut variable) = pending.take() {
                        variable.kind = match name.as_str() {
                            "Real" => Kind::Real,
                            "Boolean" => Kind::Boolean,
                            "String" => Kind::Text,
                            _ => Kind::Integer,
                        };
                        variable.unit = attributes.text("unit").unwrap_or_default();
                        description.variables.push(variable);
                        if attributes.text("derivative").is_some() {
                            let place = u32::try_from(description.variables.len());
                            let state = attributes.whole("derivative")?;
                            states.of.insert(place.unwrap_or(u32::MAX), state);
                        }
                    }
                }
                _ => {}
            }
        }
        if description.fmi == FmiVersion::V3 {
            let listed = arrays.elements()?;
            description.elements = listed.elements;
            description.variables = listed.variables;
            description.arrays = listed.wholes;
        }
        if description.guid.is_empty() {
            let message = "it has no <fmiModelDescription>".to_owned();
            return Err(DescriptionError::Xml(message));
        }
        description.take(co_simulation, model_exchange, &states)?;
        Ok(description)
    }

    /// Takes version and identity from the attributes of the root; gives the number of event
    /// indicators in FMI 2.
    fn identify(&mut self, attributes: &Attributes) -> Result<u32, DescriptionError> {
        let found = attributes.text("fmiVersion").unwrap_or_default();
        self.fmi = match found.as_str() {
            "2.0" => FmiVersion::V2,
            version if version.starts_with("3.") => FmiVersion::V3,
            _ => return Err(DescriptionError::Version { found }),
        };
        self.guid = attributes.required(match self.fmi {
            FmiVersion::V2 => "guid",
            FmiVersion::V3 => "instantiationToken",
        })?;
        match attributes.text("numberOfEventIndicators") {
            Some(_) => attributes.whole("numberOfEventIndicators"),
            None => Ok(0),
        }
    }

    /// Takes the interface with which it is simulated: co-simulation, if the FMU has both.
    ///
    /// - `co_simulation`, `model_exchange`: their model identifiers
    fn take(
        &mut self,
        co_simulation: Option<String>,
        model_exchange: Option<String>,
        states: &States,
    ) -> Result<(), DescriptionError> {
        if let Some(identifier) = co_simulation {
            self.model_identifier = identifier;
            return Ok(());
        }
        self.model_identifier = model_exchange.ok_or(DescriptionError::Interface)?;
        self.interface = Interface::ModelExchange;
        // Steps of the importer may end anywhere.
        self.variable_step = true;
        if states.indicators > 0 && !states.announced {
            return Err(DescriptionError::Indicators {
                count: states.indicators,
            });
        }
        self.states = match self.fmi {
            FmiVersion::V2 => states.names_of_fmi_2(&self.variables),
            FmiVersion::V3 => states.names_of_fmi_3(&self.variables, &self.elements),
        };
        Ok(())
    }

    /// The variable of that name.
    pub fn find(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|v| v.name == name)
    }
}

/// A variable of FMI 2, whose type is still to come.
fn variable(attributes: &Attributes) -> Result<Variable, DescriptionError> {
    let or = |key: &str, other: &str| attributes.text(key).unwrap_or(other.to_owned());
    Ok(Variable {
        name: attributes.required("name")?,
        value_reference: attributes.reference()?,
        kind: Kind::Real,
        causality: or("causality", "local"),
        variability: or("variability", "continuous"),
        initial: or("initial", ""),
        unit: String::new(),
    })
}

/// A variable of FMI 3 of the type `name`, whose dimensions are still to come.
fn array(name: &str, attributes: &Attributes) -> Result<Array, DescriptionError> {
    let or = |key: &str, other: &str| attributes.text(key).unwrap_or(other.to_owned());
    let usual = match name {
        "Float32" | "Float64" => "continuous",
        _ => "discrete",
    };
    let kind = match name {
        "Float64" => Kind::Real,
        "Int32" => Kind::Integer,
        "Boolean" => Kind::Boolean,
        _ => Kind::Text,
    };
    Ok(Array {
        variable: Variable {
            name: attributes.required("name")?,
            value_reference: attributes.reference()?,
            kind,
            causality: or("causality", "local"),
            variability: or("variability", usual),
            initial: or("initial", ""),
            unit: or("unit", ""),
        },
        start: match attributes.text("causality").as_deref() {
            Some("structuralParameter") => attributes.whole("start").ok(),
            _ => None,
        },
        shape: Vec::new(),
    })
}

/// What a `<Dimension>` says.
fn size(attributes: &Attributes) -> Result<Size, DescriptionError> {
    match attributes.text("valueReference") {
        Some(_) => attributes.reference().map(Size::Of),
        None => attributes.whole("start").map(Size::Fixed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="{&lt;1&gt;}">
  <CoSimulation modelIdentifier="m" canHandleVariableCommunicationStepSize="true"/>
  <TypeDefinitions><SimpleType name="T"><Real unit="m"/></SimpleType></TypeDefinitions>
  <DefaultExperiment stopTime="2.5" tolerance="1e-4"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="7" causality="input"><Real start="0" unit="m/s"/></ScalarVariable>
    <ScalarVariable name="on" valueReference="8" causality="output" variability="discrete"><Boolean/></ScalarVariable>
  </ModelVariables>
</fmiModelDescription>"#;

    #[test]
    fn variables_keep_their_order_and_type_definitions_are_none() {
        let description = Description::parse(TEXT).expect("FMI 2.0");
        assert_eq!(description.guid, "{<1>}");
        assert_eq!(
            (description.stop_time, description.step_size),
            (Some(2.5), None)
        );
        assert!(description.variable_step && !description.can_interpolate_inputs);
        let names: Vec<_> = description
            .variables
            .iter()
            .map(|v| (v.name.as_str(), v.value_reference, v.kind))
            .collect();
        assert_eq!(description.variables[0].unit, "m/s");
        assert_eq!(names, [("u", 7, Kind::Real), ("on", 8, Kind::Boolean)]);
    }

    #[test]
    fn an_fmu_that_cannot_be_simulated_is_refused_with_the_reason() {
        let message = |from: &str, to: &str| {
            let text = TEXT.replacen(from, to, 1);
            assert_ne!(text, TEXT);
            Description::parse(&text)
                .expect_err("not simulated")
                .to_string()
        };
        assert!(message("fmiVersion=\"2.0\"", "fmiVersion=\"1.0\"").contains("FMI 1.0"));
        assert!(message("CoSimulation", "ScheduledExecution").contains("neither <CoSimulation>"));
        assert!(message("valueReference=\"7\"", "valueReference=\"x\"").contains("valueReference"));
        assert!(message("</ModelVariables>", "</Model>").contains("cannot be read"));
    }

    const EXCHANGE: &str = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="1" numberOfEventIndicators="0">
  <ModelExchange modelIdentifier="m"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="7"><Real/></ScalarVariable>
    <ScalarVariable name="der(x)" valueReference="8"><Real derivative="1"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="9"><Real/></ScalarVariable>
    <ScalarVariable name="der(y)" valueReference="3"><Real derivative="3"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs>
    <Derivatives><Unknown index="4"/><Unknown index="2"/></Derivatives>
    <InitialUnknowns><Unknown index="1"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>"#;

    /// The description of FMI 3 for Model Exchange, with a variable as its state.
    fn exchange_of(state: u32) -> String {
        TEXT_OF_FMI_3
            .replace("CoSimulation", "ModelExchange")
            .replace(
                "<Output ",
                "<ContinuousStateDerivative valueReference=\"8\"/><Output ",
            )
            .replace(
                "<Boolean name=\"on\"",
                &format!("<Float64 derivative=\"{state}\" name=\"on\""),
            )
    }

    #[test]
    fn states_of_model_exchange_are_named_in_their_order() {
        let description = Description::parse(EXCHANGE).expect("Model Exchange");
        assert_eq!(description.interface, Interface::ModelExchange);
        assert_eq!(description.states, ["y", "x"]);
        let events = EXCHANGE.replace("EventIndicators=\"0\"", "EventIndicators=\"2\"");
        let refused = Description::parse(&events).expect_err("state events");
        assert!(
            refused.to_string().contains("2 event indicators"),
            "{refused}"
        );
        let announced = events.replacen("guid", "generationTool=\"urdf2fmu 0.1\" guid", 1);
        Description::parse(&announced).expect("a step tells of them");
        let three = exchange_of(7);
        let description = Description::parse(&three).expect("Model Exchange of FMI 3");
        assert_eq!(description.states, ["p.x", "p.y"]);
    }

    const TEXT_OF_FMI_3: &str = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="t">
  <CoSimulation modelIdentifier="m" canHandleVariableCommunicationStepSize="true"/>
  <TypeDefinitions><Float64Type name="T" unit="m"/></TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="9" causality="independent" variability="continuous"/>
    <Float64 name="p" valueReference="7" causality="output" unit="m"><Dimension start="2"/></Float64>
    <Float64 name="m" valueReference="3" causality="input" start="0 0 0 0">
      <Dimension start="2"/><Dimension start="2"/></Float64>
    <Float64 name="both" valueReference="5" causality="output"><Dimension start="2"/></Float64>
    <Boolean name="on" valueReference="8" causality="output"/>
    <Float64 name="free" valueReference="4" causality="output"><Dimension valueReference="1"/>
      <Dimension start="2"/></Float64>
    <UInt64 name="n" valueReference="1" causality="structuralParameter" variability="fixed" start="2"/>
    <String name="s" valueReference="2" causality="output"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="7"/></ModelStructure>
  <Annotations><Annotation type="other">3 a b c d</Annotation>
    <Annotation type="io.github.urdf2fmu.elements">7 p.x p.y
5 on p.x</Annotation></Annotations>
</fmiModelDescription>"#;

    #[test]
    fn arrays_of_fmi_3_are_listed_element_by_element() {
        let description = Description::parse(TEXT_OF_FMI_3).expect("FMI 3.0");
        let listed: Vec<_> = description
            .variables
            .iter()
            .map(|v| {
                let element = description.elements[v.value_reference as usize];
                (
                    v.name.as_str(),
                    v.kind,
                    element.value_reference,
                    element.index,
                )
            })
            .collect();
        assert_eq!(
            listed,
            [
                ("time", Kind::Real, 9, 0),
                ("p.x", Kind::Real, 7, 0),
                ("p.y", Kind::Real, 7, 1),
                ("m[1,1]", Kind::Real, 3, 0),
                ("m[1,2]", Kind::Real, 3, 1),
                ("m[2,1]", Kind::Real, 3, 2),
                ("m[2,2]", Kind::Real, 3, 3),
                // Names of "both" stand for others.
                ("on", Kind::Boolean, 8, 0),
                // Of the size that the structural parameter has at its start.
                ("free[1,1]", Kind::Real, 4, 0),
                ("free[1,2]", Kind::Real, 4, 1),
                ("free[2,1]", Kind::Real, 4, 2),
                ("free[2,2]", Kind::Real, 4, 3),
                ("n", Kind::Text, 1, 0),
                ("s", Kind::Text, 2, 0),
            ]
        );
        // Those that have all of their elements to themselves.
        let arrays = description.arrays.iter();
        let arrays: Vec<_> = arrays
            .map(|(name, list)| (name.as_str(), list.len()))
            .collect();
        assert_eq!(arrays, [("free", 4), ("m", 4), ("p", 2)]);
        assert_eq!(description.arrays["p"], ["p.x", "p.y"]);
        assert_eq!(description.guid, "t");
        // As many states as the structural parameter says.
        let description = Description::parse(&exchange_of(4)).expect("Model Exchange of FMI 3");
        assert_eq!(description.states.len(), 4);
    }

    #[test]
    fn a_size_that_is_not_told_is_refused() {
        for (from, to) in [
            (
                "name=\"n\" valueReference=\"1\"",
                "name=\"n\" valueReference=\"11\"",
            ),
            ("structuralParameter", "parameter"),
            (
                "<Dimension start=\"2\"/></Float64>",
                "<Dimension/></Float64>",
            ),
        ] {
            let text = TEXT_OF_FMI_3.replace(from, to);
            assert_ne!(text, TEXT_OF_FMI_3);
            let refused = Description::parse(&text).expect_err("no size").to_string();
            assert!(refused.contains("<Dimension>"), "{refused}");
        }
    }

    /// Arrays of one name are listed once, and were looked at without a limit, so that 200 lines
    /// took minutes. A million elements are looked at: of the third array none is left.
    #[test]
    fn elements_of_arrays_of_one_name_count_as_others() {
        let array = |name, reference| {
            format!(
                "<Float64 name=\"{name}\" valueReference=\"{reference}\">\
                 <Dimension start=\"400000\"/></Float64>"
            )
        };
        let arrays = [array("a", 1), array("a", 2), array("b", 3)].concat();
        let text = format!(
            "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"m\" instantiationToken=\"t\">\
             <CoSimulation modelIdentifier=\"m\"/><ModelVariables>{arrays}</ModelVariables>\
             </fmiModelDescription>"
        );
        let found = Description::parse(&text).expect("a description");
        assert_eq!(found.variables.len(), 400_001);
    }

    #[test]
    fn other_encodings_are_read() {
        let text = TEXT
            .replace("?>", " encoding='UTF-16'?>")
            .replace("modelName=\"m\"", "modelName=\"é\"");
        let wide = |order: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(order).collect();
        for bytes in [wide(u16::to_le_bytes), wide(u16::to_be_bytes)] {
            let description = Description::from_bytes(bytes).expect("UTF-16");
            assert_eq!(description.variables.len(), 2);
        }
    }
}
