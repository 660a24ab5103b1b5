//! What an importer needs of modelDescription.xml.

use super::arrays::{Array, Arrays, is_type};
use super::library::{Element, Interface};
use super::states::States;
use super::variable::{Kind, Variable};
use crate::describe::ELEMENTS;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
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
}

/// Why a description cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionError {
    /// No XML.
    #[error("modelDescription.xml cannot be read: {0}")]
    Xml(String),
    /// Another version of the standard.
    #[error("the FMU is for FMI {found}; only FMI 2.0 and 3.0 can be simulated here")]
    Version {
        /// As written.
        found: String,
    },
    /// Neither of the two.
    #[error(
        "the FMU cannot be simulated here: modelDescription.xml has neither <CoSimulation> nor \
         <ModelExchange>"
    )]
    Interface,
    /// Model Exchange with state events.
    #[error(
        "the FMU has {count} event indicators: Model Exchange is simulated here without state events; ask its \
         exporter for co-simulation"
    )]
    Indicators {
        /// How many.
        count: u32,
    },
    /// An attribute.
    #[error("modelDescription.xml: <{element}> has no valid '{attribute}'")]
    Attribute {
        /// Of which element.
        element: String,
        /// Which.
        attribute: &'static str,
    },
}

impl Description {
    /// Reads modelDescription.xml.
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
                "Dimension" => arrays.dimension(attributes.text("start")),
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
        (description.elements, description.variables) = match description.fmi {
            FmiVersion::V2 => (Vec::new(), description.variables),
            FmiVersion::V3 => arrays.elements(),
        };
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
        if states.indicators > 0 {
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
        shape: Vec::new(),
    })
}

/// Attributes of one element.
struct Attributes {
    element: String,
    pairs: Vec<(String, String)>,
}

impl Attributes {
    fn read(element: &BytesStart, name: &str) -> Result<Self, DescriptionError> {
        let mut pairs = Vec::new();
        for attribute in element.attributes() {
            let wrong = |error: String| DescriptionError::Xml(format!("in <{name}>: {error}"));
            let attribute = attribute.map_err(|error| wrong(error.to_string()))?;
            let value = attribute
                .normalized_value(XmlVersion::Implicit1_0)
                .map_err(|error| wrong(error.to_string()))?;
            let key = attribute.key.as_ref().to_owned();
            pairs.push((key, value.into_owned()));
        }
        Ok(Self {
            element: name.to_owned(),
            pairs,
        })
    }

    fn text(&self, key: &str) -> Option<String> {
        let pair = self.pairs.iter().find(|(name, _)| name == key);
        pair.map(|(_, value)| value.clone())
    }

    fn bad(&self, attribute: &'static str) -> DescriptionError {
        DescriptionError::Attribute {
            element: self.element.clone(),
            attribute,
        }
    }

    fn required(&self, key: &'static str) -> Result<String, DescriptionError> {
        self.text(key).ok_or_else(|| self.bad(key))
    }

    fn reference(&self) -> Result<u32, DescriptionError> {
        self.whole("valueReference")
    }

    fn whole(&self, key: &'static str) -> Result<u32, DescriptionError> {
        let text = self.required(key)?;
        text.parse().map_err(|_| self.bad(key))
    }

    fn flag(&self, key: &str) -> bool {
        matches!(self.text(key).as_deref(), Some("true" | "1"))
    }

    fn number(&self, key: &'static str) -> Result<Option<f64>, DescriptionError> {
        let parse = |text: String| text.trim().parse().map_err(|_| self.bad(key));
        self.text(key).map(parse).transpose()
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
        let three = TEXT_OF_FMI_3
            .replace("CoSimulation", "ModelExchange")
            .replace(
                "<Output ",
                "<ContinuousStateDerivative valueReference=\"8\"/><Output ",
            )
            .replace(
                "<Boolean name=\"on\"",
                "<Float64 derivative=\"7\" name=\"on\"",
            );
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
    <Float64 name="unknown" valueReference="4" causality="output"><Dimension valueReference="1"/></Float64>
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
                ("unknown", Kind::Text, 4, 0),
                ("s", Kind::Text, 2, 0),
            ]
        );
        assert_eq!(description.guid, "t");
    }
}
