//! Attributes of the elements of modelDescription.xml, and what is wrong with them.

use quick_xml::XmlVersion;
use quick_xml::events::BytesStart;

/// Why a description cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionError {
    /// No XML.
    #[error(
        "modelDescription.xml cannot be read: {0}; download the FMU once more, or export it again"
    )]
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

/// Attributes of one element.
pub(super) struct Attributes {
    element: String,
    pairs: Vec<(String, String)>,
}

impl Attributes {
    pub fn read(element: &BytesStart, name: &str) -> Result<Self, DescriptionError> {
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

    pub fn text(&self, key: &str) -> Option<String> {
        let pair = self.pairs.iter().find(|(name, _)| name == key);
        pair.map(|(_, value)| value.clone())
    }

    fn bad(&self, attribute: &'static str) -> DescriptionError {
        DescriptionError::Attribute {
            element: self.element.clone(),
            attribute,
        }
    }

    pub fn required(&self, key: &'static str) -> Result<String, DescriptionError> {
        self.text(key).ok_or_else(|| self.bad(key))
    }

    pub fn reference(&self) -> Result<u32, DescriptionError> {
        self.whole("valueReference")
    }

    pub fn whole(&self, key: &'static str) -> Result<u32, DescriptionError> {
        let text = self.required(key)?;
        text.parse().map_err(|_| self.bad(key))
    }

    pub fn flag(&self, key: &str) -> bool {
        matches!(self.text(key).as_deref(), Some("true" | "1"))
    }

    pub fn number(&self, key: &'static str) -> Result<Option<f64>, DescriptionError> {
        let parse = |text: String| text.trim().parse().map_err(|_| self.bad(key));
        self.text(key).map(parse).transpose()
    }
}
