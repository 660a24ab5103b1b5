//! Partial derivatives of outputs and derivatives by continuous states and inputs, and in
//! initialization mode by parameters and inputs.
//!
//! Along the direction that the importer gives, the values at `±h` and `±h/2` give central
//! differences `D(h)` and `D(h/2)`, and `(4 D(h/2) − D(h))/3` errs by `O(h⁴)` only. `h` is chosen
//! so that the variable that changes most, relative to its nominal value, changes by [`DIFFERENCE`]
//! of it: contacts are a tenth of a millimetre deep, and their laws are curved on that scale.
//!
//! What stands at an end of its range goes away from there: five values between 0 and `h` give its
//! part, with the same order. The parts add up, because derivatives are linear in the direction.

use super::values::value;
use super::{Instance, Source};
use crate::error::FmiError;
use crate::layout::Place;
use crate::phase::Phase;
use crate::pointers::{In, Out};
use urdf2fmu_core::simulation::{InputSlot, ParameterSlot};
use urdf2fmu_core::tuning::DIFFERENCE;
use urdf2fmu_core::variables::{Kind, Slot};

/// What the derivatives are by.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    State(usize),
    Input(InputSlot),
    Parameter(ParameterSlot),
}

/// How far one known goes along the direction.
#[derive(Clone, Copy, Debug)]
struct Part {
    known: Known,
    seed: f64,
    place: Place,
}

/// Where values are taken, in parts of an increment, with the weights that give the derivative by
/// it.
type Nodes = &'static [(f64, f64)];

const CENTRAL: Nodes = &[
    (1.0, -1.0 / 6.0),
    (-1.0, 1.0 / 6.0),
    (0.5, 8.0 / 6.0),
    (-0.5, -8.0 / 6.0),
];

const ONE_SIDED: Nodes = &[
    (0.0, -25.0 / 3.0),
    (0.25, 16.0),
    (0.5, -12.0),
    (0.75, 16.0 / 3.0),
    (1.0, -1.0),
];

impl Instance {
    /// The derivative of each element of the unknowns along the direction that `seeds` give the
    /// elements of the knowns. Nothing of the instance changes.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn directional_derivative(
        &mut self,
        unknowns: &In<u32>,
        knowns: &In<u32>,
        seeds: &In<f64>,
        sensitivities: &mut Out<f64>,
    ) -> Result<(), FmiError> {
        let mut sources = Vec::new();
        for reference in unknowns.iter() {
            let place = self.layout.of_kind(reference, Kind::Real)?;
            for element in place.elements() {
                match self.sources[element] {
                    Source::Slot(Slot::Output(_))
                    | Source::State(_)
                    | Source::Rate(_)
                    | Source::Indicator => {}
                    _ => {
                        return Err(FmiError::NotUnknown {
                            name: self.name(place),
                        });
                    }
                }
                sources.push(element);
            }
        }
        let mut direction: Vec<Part> = Vec::new();
        let mut given = seeds.iter();
        for reference in knowns.iter() {
            let place = self.layout.of_kind(reference, Kind::Real)?;
            for element in place.elements() {
                let known = self.known(place, element)?;
                let Some(seed) = given.next() else { break };
                if !seed.is_finite() {
                    return Err(FmiError::Value {
                        name: self.name(place),
                        expected: "a finite seed",
                        value: seed,
                    });
                }
                // What is named twice goes by both seeds.
                match direction.iter_mut().find(|part| part.known == known) {
                    Some(part) => part.seed += seed,
                    None => direction.push(Part { known, seed, place }),
                }
            }
        }
        let wanted: usize = knowns
            .iter()
            .map(|known| self.layout.find(known).len())
            .sum();
        super::values::check_count(seeds.len(), wanted)?;
        super::values::check_count(sensitivities.len(), sources.len())?;
        let size = direction.iter().map(|part| part.seed.abs());
        let size = size.fold(0.0, f64::max);
        if size == 0.0 {
            for index in 0..sources.len() {
                sensitivities.set(index, 0.0);
            }
            return Ok(());
        }
        // The derivative is linear in the seeds: of seeds of size 1 every step is finite.
        let mut reach = 0.0_f64;
        for part in &mut direction {
            part.seed /= size;
            reach = reach.max((part.seed / self.nominal(part.known)).abs());
        }
        let h = DIFFERENCE / reach;
        let mut groups = [(CENTRAL, h), (ONE_SIDED, h), (ONE_SIDED, -h)].map(|way| (way, vec![]));
        for part in direction {
            let group = match [h, -h].map(|h| self.may_go(part.known, h * part.seed)) {
                [true, true] => 0,
                [true, false] => 1,
                [false, true] => 2,
                [false, false] => {
                    return Err(FmiError::NotKnown {
                        name: self.name(part.place),
                    });
                }
            };
            groups[group].1.push(part);
        }
        // Writing states back is not exact: bases are kept at another point than the link's origin.
        let before = self.simulation.save();
        let mut found = vec![0.0; sources.len()];
        for (way, parts) in &groups {
            if !parts.is_empty() {
                self.add_differences(&mut found, &sources, parts, *way);
                self.simulation.restore(&before)?;
            }
        }
        for value in &mut found {
            *value *= size;
        }
        if let Some(place) = found.iter().position(|value| !value.is_finite()) {
            return Err(self.not_finite(self.layout.all_rows()[sources[place]]));
        }
        for (index, value) in found.into_iter().enumerate() {
            sensitivities.set(index, value);
        }
        Ok(())
    }

    /// What an element of a known variable is.
    fn known(&self, place: Place, element: usize) -> Result<Known, FmiError> {
        match self.sources[element] {
            Source::State(id) if self.phase != Phase::Initialization => {
                Ok(Known::State(id.index()))
            }
            Source::Slot(Slot::Input(slot)) => Ok(Known::Input(slot)),
            Source::Slot(Slot::Parameter(slot)) if self.phase == Phase::Initialization => {
                Ok(Known::Parameter(slot))
            }
            _ => Err(FmiError::NotKnown {
                name: self.name(place),
            }),
        }
    }

    fn name(&self, place: Place) -> String {
        self.layout.name(place).to_owned()
    }

    /// The size by which a change counts.
    fn nominal(&self, known: Known) -> f64 {
        match known {
            Known::State(index) => self
                .simulation
                .states()
                .iter()
                .nth(index)
                .map_or(1.0, |s| s.nominal),
            Known::Input(slot) => self.simulation.nominal_input(slot),
            Known::Parameter(_) => 1.0,
        }
    }

    /// Whether a known may go that far from where it is.
    fn may_go(&self, known: Known, way: f64) -> bool {
        let simulation = &self.simulation;
        match known {
            Known::State(_) => true,
            Known::Input(slot) => {
                let value = simulation.input(slot) + way;
                simulation.check_input(slot, value).is_ok()
            }
            Known::Parameter(slot) => {
                let value = simulation.parameter(slot) + way;
                simulation.check_parameter(slot, value).is_ok()
            }
        }
    }

    /// Adds the derivatives along some parts of the direction, by increments of `h`; leaves states,
    /// inputs and parameters elsewhere.
    fn add_differences(
        &mut self,
        found: &mut [f64],
        sources: &[usize],
        parts: &[Part],
        (nodes, h): (Nodes, f64),
    ) {
        let mut x = vec![0.0; self.state_count()];
        self.simulation.read_states(&mut x);
        let base: Vec<f64> = parts
            .iter()
            .map(|part| match part.known {
                Known::State(index) => x[index],
                Known::Input(slot) => self.simulation.input(slot),
                Known::Parameter(slot) => self.simulation.parameter(slot),
            })
            .collect();
        for (node, weight) in nodes {
            let mut moves = false;
            for (part, base) in parts.iter().zip(&base) {
                let value = base + node * h * part.seed;
                match part.known {
                    Known::State(index) => {
                        x[index] = value;
                        moves = true;
                    }
                    Known::Input(slot) => self.simulation.set_input(slot, value),
                    Known::Parameter(slot) => self.simulation.set_parameter(slot, value),
                }
            }
            if moves {
                self.simulation.set_states(&x);
            }
            let mut reading = self.simulation.reading();
            for (found, element) in found.iter_mut().zip(sources) {
                *found += weight / h * value(&mut reading, self.sources[*element]);
            }
        }
    }
}
