//! Getting and setting variables.

use super::{Instance, Source};
use crate::error::FmiError;
use crate::layout::Place;
use crate::phase::Phase;
use crate::pointers::{In, Out};
use urdf2fmu_core::digits::Digits;
use urdf2fmu_core::inputs::INPUT_ORDERS;
use urdf2fmu_core::range::Range;
use urdf2fmu_core::simulation::outputs::Reading;
use urdf2fmu_core::simulation::{ParameterSlot, SimulationError};
use urdf2fmu_core::variables::{Kind, Slot};

/// What follows from a start beyond a limit, whose spring is damped as contacts are: by 51 s a rad
/// or m.
const BEYOND: &str = ", and the limit moves the joint back slowly, by 0.02 rad or m a second";

/// How far outside its range a value may be without a word, relative to 1 and to the limit.
const ROUND_OFF: f64 = 1e-9;

impl Instance {
    /// Reads variables: nothing is written unless all references are right and `values` has as many
    /// elements as they have together.
    pub(crate) fn get<T: Copy>(
        &mut self,
        kind: Kind,
        value_references: &In<u32>,
        values: &mut Out<T>,
        from_number: impl Fn(f64) -> T,
    ) -> Result<(), FmiError> {
        let given = values.len();
        self.read(kind, value_references, given, &mut |index, number| {
            values.set(index, from_number(number));
        })
    }

    /// [`Self::get`] for values of all types: one function, and not a copy for each type of both
    /// versions.
    ///
    /// - `given`: how many values there is room for
    /// - `write`: takes the place of a value in the importer's array, and the value
    fn read(
        &mut self,
        kind: Kind,
        value_references: &In<u32>,
        given: usize,
        write: &mut dyn FnMut(usize, f64),
    ) -> Result<(), FmiError> {
        let mut expected = 0;
        for value_reference in value_references.iter() {
            expected += self.readable(value_reference, kind)?.len();
        }
        check_count(given, expected)?;
        let mut reading = self.simulation.reading();
        let mut written = 0;
        for value_reference in value_references.iter() {
            // Read again: the importer's array may overlap with `values`, so nothing is taken for
            // granted.
            for element in self.layout.find(value_reference).elements() {
                let number = value(&mut reading, self.sources[element]);
                if !number.is_finite() {
                    return Err(self.not_finite(self.layout.all_rows()[element]));
                }
                write(written, number);
                written += 1;
            }
        }
        Ok(())
    }

    /// The variable behind a value reference, if it has the type asked for. Within the importer's
    /// callback, only one that it has asked for.
    #[inline]
    fn readable(&self, value_reference: u32, kind: Kind) -> Result<Place, FmiError> {
        let place = self.layout.of_kind(value_reference, kind)?;
        if self.phase == Phase::IntermediateUpdate {
            self.check_required(place)?;
        }
        Ok(place)
    }

    #[cold]
    #[cfg_attr(small, optimize(size))]
    fn check_required(&self, place: Place) -> Result<(), FmiError> {
        let updates = self.updates.as_ref();
        let name = self.layout.name(place);
        if name == "time" || updates.is_some_and(|updates| updates.has(place.number as usize)) {
            return Ok(());
        }
        let name = name.to_owned();
        Err(FmiError::NotRequired { name })
    }

    /// An output that is no number.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn not_finite(&self, row: u32) -> FmiError {
        let variable = self.variables.get(row as usize);
        FmiError::NotFinite {
            name: variable.map(|v| v.name.clone()).unwrap_or_default(),
        }
    }

    /// Sets variables: nothing is set unless all of it is legal and `values` has as many elements
    /// as they have together.
    pub(crate) fn set<T: Copy>(
        &mut self,
        kind: Kind,
        value_references: &In<u32>,
        values: &In<T>,
        to_number: impl Fn(T) -> f64,
    ) -> Result<(), FmiError> {
        self.write(kind, value_references, values.len(), &|index| {
            values.at(index).map_or(f64::NAN, &to_number)
        })
    }

    /// [`Self::set`] for values of all types, as [`Self::read`].
    ///
    /// - `given`: how many values there are
    /// - `values`: the value at a place of the importer's array; NaN, which is refused, beyond it
    fn write(
        &mut self,
        kind: Kind,
        value_references: &In<u32>,
        given: usize,
        values: &dyn Fn(usize) -> f64,
    ) -> Result<(), FmiError> {
        let mut expected = 0;
        let mut all = (0..given).map(values);
        for value_reference in value_references.iter() {
            let place = self.readable(value_reference, kind)?;
            expected += place.len();
            if expected > given {
                let all = value_references.iter();
                let all = all.map(|reference| self.layout.find(reference).len());
                return check_count(given, all.sum());
            }
            for (row, value) in self.layout.rows(place).iter().zip(&mut all) {
                self.check(*row, value)?;
            }
        }
        check_count(given, expected)?;
        let mut all = (0..given).map(values);
        for value_reference in value_references.iter() {
            // Read again: the importer may write to its array meanwhile, so nothing is taken for
            // granted.
            for element in self.layout.find(value_reference).elements() {
                let row = self.layout.all_rows()[element] as usize;
                let (Some(variable), Some(number)) = (self.variables.get(row), all.next()) else {
                    break;
                };
                match variable.slot {
                    Slot::Input(slot) => self.simulation.set_input(slot, number),
                    Slot::Parameter(slot) => {
                        self.simulation.set_parameter(slot, number);
                        self.event(|| {
                            format!("parameter '{}' is set to {}", variable.name, Digits(number))
                        });
                    }
                    Slot::Output(_) => {}
                }
                self.note_range(row, number);
            }
        }
        Ok(())
    }

    /// Whether a row may be set to `value` now.
    fn check(&self, row: u32, value: f64) -> Result<(), FmiError> {
        let Some(variable) = self.variables.get(row as usize) else {
            return Err(FmiError::Time);
        };
        let name = || variable.name.clone();
        if !value.is_finite() {
            return Err(FmiError::Value {
                name: name(),
                expected: "a finite number",
                value,
            });
        }
        let checked = match variable.slot {
            Slot::Input(slot) => self.simulation.check_input(slot, value),
            Slot::Parameter(slot) => {
                if self.phase == Phase::ContinuousTime {
                    return Err(FmiError::Continuous { name: name() });
                }
                if self.phase.is_initialized() && !slot.tunable() {
                    let (name, fmi) = (name(), self.version);
                    return Err(FmiError::Fixed { name, fmi });
                }
                self.simulation.check_parameter(slot, value)
            }
            Slot::Output(_) => return Err(FmiError::Output { name: name() }),
        };
        checked.map_err(|error| match error {
            SimulationError::Value {
                expected, value, ..
            } => FmiError::Value {
                name: name(),
                expected,
                value,
            },
            other => FmiError::Simulation(other),
        })
    }

    /// Says once per variable that it has left its range; the value counts all the same.
    #[cfg_attr(small, optimize(size))]
    fn note_range(&mut self, index: usize, value: f64) {
        let variable = &self.variables[index];
        let (min, max) = (
            variable.min.unwrap_or(f64::NEG_INFINITY),
            variable.max.unwrap_or(f64::INFINITY),
        );
        // Importers interpolate their tables, with round-off.
        let slack = |limit: f64| ROUND_OFF * (1.0 + limit.abs());
        let inside = value >= min - slack(min) && value <= max + slack(max);
        if inside || self.range_logged[index] {
            return;
        }
        self.range_logged[index] = true;
        let starts = matches!(
            variable.slot,
            Slot::Parameter(ParameterSlot::InitialJointPosition(_))
        );
        let name = &variable.name;
        self.warn(&format!(
            "variable '{name}' is set to {}, outside its range [{}, {}]; the value is used{}, and \
             this is said once",
            Digits(value),
            Digits(min),
            Digits(max),
            if starts { BEYOND } else { "" }
        ));
    }

    /// fmi2SetRealInputDerivatives: nothing is set unless all of it is legal.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn set_input_derivatives(
        &mut self,
        value_references: &In<u32>,
        orders: &In<i32>,
        values: &In<f64>,
    ) -> Result<(), FmiError> {
        let all = || {
            let places = value_references.iter().zip(orders.iter());
            places.zip(values.iter())
        };
        for ((value_reference, order), value) in all() {
            self.layout.of_kind(value_reference, Kind::Real)?;
            let variable = &self.variables[value_reference as usize];
            let name = || variable.name.clone();
            if !matches!(variable.slot, Slot::Input(_)) {
                return Err(FmiError::NotInput { name: name() });
            }
            check_order(order, INPUT_ORDERS, name)?;
            if !Range::Slope.contains(value) {
                return Err(FmiError::Derivative {
                    name: name(),
                    order,
                    expected: Range::Slope.expected(),
                    value,
                });
            }
        }
        for ((value_reference, order), value) in all() {
            let row = self.variables.get(value_reference as usize);
            if let (Some(Slot::Input(slot)), Ok(order)) =
                (row.map(|row| row.slot), usize::try_from(order))
            {
                self.simulation
                    .set_input_derivative(slot, order.clamp(1, INPUT_ORDERS), value);
            }
        }
        Ok(())
    }

    /// Derivatives of outputs, an order for each reference: nothing is written unless all of it is
    /// known.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn output_derivatives(
        &mut self,
        value_references: &In<u32>,
        orders: &In<i32>,
        values: &mut Out<f64>,
    ) -> Result<(), FmiError> {
        // The second pass writes what the first has found to be there.
        for write in [false, true] {
            let mut element = 0;
            let places = value_references.iter().zip(orders.iter());
            for (value_reference, order) in places {
                let place = self.readable(value_reference, Kind::Real)?;
                let name = || self.layout.name(place).to_owned();
                for row in self.layout.rows(place) {
                    let variable = self.variables.get(*row as usize);
                    let Some(Slot::Output(slot)) = variable.map(|v| v.slot) else {
                        return Err(FmiError::NotOutput { name: name() });
                    };
                    check_order(order, 1, name)?;
                    let Some(value) = self.simulation.output_derivative(slot) else {
                        return Err(FmiError::NoDerivative { name: name() });
                    };
                    if !value.is_finite() {
                        return Err(self.not_finite(*row));
                    }
                    if write {
                        values.set(element, value);
                    }
                    element += 1;
                }
            }
            check_count(values.len(), element)?;
        }
        Ok(())
    }

    /// Functions for types that no variable has: `asked` is the type's name.
    pub(crate) fn refuse(
        &self,
        asked: &'static str,
        value_references: &In<u32>,
    ) -> Result<(), FmiError> {
        match value_references.iter().next() {
            None => Ok(()),
            Some(value_reference) => Err(self.layout.wrong(value_reference, asked)),
        }
    }
}

/// Value of an element. Nearly all are outputs: what else there is stays apart.
#[inline]
pub(super) fn value(reading: &mut Reading, source: Source) -> f64 {
    match source {
        Source::Slot(Slot::Output(slot)) => reading.output(slot),
        other => value_of_others(reading, other),
    }
}

#[inline(never)]
fn value_of_others(reading: &mut Reading, source: Source) -> f64 {
    match source {
        Source::Slot(Slot::Output(slot)) => reading.output(slot),
        Source::Slot(Slot::Input(slot)) => reading.input(slot),
        Source::Slot(Slot::Parameter(slot)) => reading.parameter(slot),
        Source::State(id) => reading.state(id),
        Source::Rate(id) => reading.rate(id),
        Source::Indicator => reading.margin(),
        Source::Time => reading.time(),
    }
}

/// Whether an importer's array of values is as long as the variables that it is for.
pub(super) fn check_count(given: usize, expected: usize) -> Result<(), FmiError> {
    if given == expected {
        Ok(())
    } else {
        Err(FmiError::Count { given, expected })
    }
}

/// Whether derivatives of this order exist.
fn check_order(order: i32, highest: usize, name: impl Fn() -> String) -> Result<(), FmiError> {
    let highest = i32::try_from(highest).unwrap_or(i32::MAX);
    if order < 1 {
        Err(FmiError::Order {
            name: name(),
            order,
        })
    } else if order > highest {
        Err(FmiError::HighOrder {
            name: name(),
            order,
            highest,
        })
    } else {
        Ok(())
    }
}
