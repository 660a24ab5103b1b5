//! `resources/model.json`: the file that hands a prepared [`Model`] from the exporter to the FMU's
//! library.
//!
//! The library loads only this file. Floats are written with the fewest digits that read back to
//! the same bits.

mod reader;

use self::reader::{Fault, Order, Reader};
use crate::hash::{Fnv, fnv1a};
use crate::model::{Model, ModelError};
use serde::Serialize;

/// Layout of the file. A library reads its own format only: it travels in the same FMU as the file.
pub const FORMAT: u32 = 2;

/// Name of the file in an FMU's resources folder.
pub const FILE_NAME: &str = "model.json";

/// What the file holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PreparedModel {
    /// [`FORMAT`].
    pub format: u32,
    /// Version of the exporter, for messages.
    pub exporter: String,
    /// As in modelDescription.xml, braces included; fmi2Instantiate compares it.
    pub guid: String,
    /// Of the robot, in hexadecimal; whoever changes a number by hand is told. None in files that
    /// other programs wrote.
    pub checksum: Option<String>,
    /// The robot.
    pub model: Model,
    /// Of the robot as the file has it, for [`crate::simulation::Simulation::with_hash`].
    #[serde(skip)]
    pub hash: u64,
}

/// The fields of a [`PreparedModel`], in its order.
const FIELDS: &[&str] = &["format", "exporter", "guid", "checksum", "model"];

/// Why a prepared model cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PreparedModelError {
    /// Not the JSON text that [`PreparedModel::to_json`] writes.
    #[error("not a prepared model: {reason}; export the FMU again")]
    Text {
        /// What is wrong, and at which line and column.
        reason: String,
    },
    /// Written by another version of the exporter.
    #[error(
        "prepared model has format {found}, made by urdf2fmu {exporter}; this library reads format \
         {FORMAT}; export the FMU again"
    )]
    Format {
        /// Format of the file.
        found: u32,
        /// Version that wrote it.
        exporter: String,
    },
    /// A model that cannot be computed with.
    #[error("the prepared model is damaged: {0}; export the FMU again")]
    Damaged(#[from] ModelError),
    /// Numbers that are not those that were exported.
    #[error("the prepared model was changed after it was exported; export the FMU again")]
    Changed,
    /// A number that JSON cannot hold, or a model that contradicts itself.
    #[error("the model cannot be stored: {reason}")]
    Model {
        /// What is wrong.
        reason: String,
    },
}

impl PreparedModel {
    /// A file of this version; `guid` with its braces.
    pub fn new(guid: String, model: Model) -> Self {
        let hash = model_hash(&model);
        Self {
            format: FORMAT,
            exporter: env!("CARGO_PKG_VERSION").to_owned(),
            guid,
            checksum: Some(checksum(hash)),
            model,
            hash,
        }
    }

    /// The text of the file. The same robot gives the same text.
    ///
    /// # Errors
    /// [`PreparedModelError::Model`] if the model would not be read back, [`Model::validate`].
    pub fn to_json(&self) -> Result<String, PreparedModelError> {
        let refuse = |reason: String| PreparedModelError::Model { reason };
        self.model
            .validate()
            .map_err(|error| refuse(error.to_string()))?;
        let text = serde_json::to_string_pretty(self).map_err(|error| refuse(error.to_string()))?;
        // JSON has no NaN or infinity: they become `null`, which then fails here instead of in the
        // FMU.
        Self::read(&text).map_err(refuse)?;
        Ok(text)
    }

    /// Reads what [`Self::to_json`] wrote. What it returns can be computed with, see
    /// [`Model::validate`].
    ///
    /// # Errors
    /// [`PreparedModelError`] for anything else.
    pub fn from_json(text: &str) -> Result<Self, PreparedModelError> {
        let unreadable = match Self::read(text) {
            Ok(prepared) if prepared.format == FORMAT => {
                prepared.model.validate()?;
                let written = prepared.checksum.as_ref();
                if written.is_some_and(|written| *written != checksum(prepared.hash)) {
                    return Err(PreparedModelError::Changed);
                }
                return Ok(prepared);
            }
            Ok(prepared) => {
                return Err(PreparedModelError::Format {
                    found: prepared.format,
                    exporter: prepared.exporter,
                });
            }
            Err(reason) => reason,
        };
        match header(text) {
            Ok((found, exporter)) if found != FORMAT => {
                Err(PreparedModelError::Format { found, exporter })
            }
            _ => Err(PreparedModelError::Text { reason: unreadable }),
        }
    }

    /// What stands in a text, or what is wrong with it and at which line and column.
    fn read(text: &str) -> Result<Self, String> {
        let mut reader = Reader::new(text, Order::Written);
        if let Ok(prepared) = Self::fields(&mut reader) {
            return Ok(prepared);
        }
        let mut reader = Reader::new(text, Order::Any);
        Self::fields(&mut reader).map_err(|fault| reader.told(&fault))
    }

    #[cfg_attr(small, optimize(size))]
    fn fields(reader: &mut Reader) -> Result<Self, Fault> {
        let mut object = reader.object(FIELDS)?;
        let mut prepared = Self {
            format: object.required()?,
            exporter: object.required()?,
            guid: object.required()?,
            checksum: object.required()?,
            model: object.required()?,
            hash: 0,
        };
        prepared.hash = text_hash(object.last());
        object.end()?;
        reader.end()?;
        Ok(prepared)
    }
}

/// Format and exporter, which can be read from any format.
fn header(text: &str) -> Result<(u32, String), Fault> {
    let mut reader = Reader::new(text, Order::Lenient);
    let mut object = reader.object(&["format", "exporter"])?;
    let format = object.required()?;
    let exporter: Option<String> = object.required()?;
    Ok((format, exporter.unwrap_or_default()))
}

fn checksum(hash: u64) -> String {
    format!("{hash:016x}")
}

/// Hash of a model's text as it is stored, without blanks between its parts: two models that differ
/// in any number have different ones.
pub(crate) fn model_hash(model: &Model) -> u64 {
    serde_json::to_vec(model).map_or(0, |bytes| fnv1a(&bytes))
}

/// [`model_hash`] of the model that is stored by this text. Nothing is written for it, which would
/// take half of the time of loading, and code in each library.
#[cfg_attr(small, optimize(size))]
fn text_hash(text: &str) -> u64 {
    let mut hash = Fnv::default();
    let (mut quoted, mut escaped) = (false, false);
    for byte in text.bytes() {
        match byte {
            b' ' | b'\n' | b'\t' | b'\r' if !quoted => continue,
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => quoted = !quoted,
            _ => {}
        }
        hash.add(&[byte]);
    }
    hash.value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::Vec3;
    use crate::testing::{Builder, inertia};

    fn model() -> Model {
        let mut model = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.1; 3])).model;
        model.roots[0].position = Vec3::new(0.1, 1.0 / 3.0, 5e-324);
        model.solver.step_size = 1.0 / 240.0;
        model.name = "one \\ two \" \n\u{e9} \\\"".into();
        model
    }

    #[test]
    fn written_model_reads_back_to_the_same_bits() {
        let prepared = PreparedModel::new("{0}".into(), model());
        let read =
            PreparedModel::from_json(&prepared.to_json().expect("finite")).expect("own text");
        assert_eq!(read, prepared);
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused_when_writing() {
        let mut model = model();
        model.roots[0].position.x = f64::NAN;
        let result = PreparedModel::new("{0}".into(), model).to_json();
        assert!(matches!(result, Err(PreparedModelError::Model { .. })));
    }

    #[test]
    fn a_changed_number_is_noticed_and_other_blanks_are_not() {
        let prepared = PreparedModel::new("{0}".into(), model());
        let text = prepared.to_json().expect("finite");
        let dense = serde_json::to_string(&prepared).expect("finite");
        assert_eq!(PreparedModel::from_json(&dense).expect("own"), prepared);
        let changed = text.replacen("5e-324", "0.0", 1);
        assert_ne!(changed, text);
        let error = PreparedModel::from_json(&changed).expect_err("another number");
        assert!(matches!(error, PreparedModelError::Changed), "{error}");
    }

    #[test]
    fn another_format_is_named_even_if_its_fields_are_unknown() {
        let text = r#"{"format": 7, "exporter": "9.9.9", "wheels": 4}"#;
        let message = PreparedModel::from_json(text)
            .expect_err("format 7")
            .to_string();
        assert!(
            message.contains("format 7") && message.contains("9.9.9"),
            "{message}"
        );
    }

    #[test]
    fn a_truncated_file_is_refused_with_its_line() {
        let text = PreparedModel::new("{0}".into(), model())
            .to_json()
            .expect("finite");
        let message = PreparedModel::from_json(&text[..text.len() / 2])
            .expect_err("half a file")
            .to_string();
        assert!(message.contains("line"), "{message}");
    }

    #[test]
    fn a_model_that_contradicts_itself_is_neither_written_nor_read() {
        let prepared = PreparedModel::new("{0}".into(), model());
        let text = prepared.to_json().expect("legal");
        let damaged = text.replacen("\"nq\": 7", "\"nq\": 8", 1);
        assert_ne!(damaged, text);
        let error = PreparedModel::from_json(&damaged).expect_err("nq does not fit");
        assert!(matches!(error, PreparedModelError::Damaged(_)), "{error}");

        let mut wrong = model();
        wrong.nq = 8;
        let result = PreparedModel::new("{0}".into(), wrong).to_json();
        assert!(matches!(result, Err(PreparedModelError::Model { .. })));
    }
}
