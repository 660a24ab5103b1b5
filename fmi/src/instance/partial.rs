//! Partial derivatives of outputs and derivatives by continuous states and inputs.
//!
//! Along the direction that the importer gives, the values at `±h` and `±h/2` give central
//! differences `D(h)` and `D(h/2)`, and `(4 D(h/2) − D(h))/3` errs by `O(h⁴)` only. `h` is chosen
//! so that the variable that changes most, relative to its nominal value, changes by [`DIFFERENCE`]
//! of it: contacts are a tenth of a millimetre deep, and their laws are curved on that scale.

use super::values::value;
use super::{Instance, Source};
use crate::error::FmiError;
use crate::layout::Place;
use crate::phase::Phase;
use crate::pointers::{In, Out};
use urdf2fmu_core::simulation::InputSlot;
use urdf2fmu_core::tuning::DIFFERENCE;
use urdf2fmu_core::variables::{Kind, Slot};

/// What the derivatives are by.
#[derive(Clone, Copy, Debug)]
enum Known {
    State(usize),
    Input(InputSlot),
}

impl Instance {
    /// The derivative of each element of the unknowns along the direction that `seeds` give the
    /// elements of the knowns. Nothing of the instance changes.
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
                    Source::Slot(Slot::Output(_)) | Source::State(_) | Source::Rate(_) => {}
                    _ => {
                        return Err(FmiError::NotUnknown {
                            name: self.name(place),
                        });
                    }
                }
                sources.push(element);
            }
        }
        let mut direction = Vec::new();
        let mut given = seeds.iter();
        let mut size = 0.0_f64;
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
                size = size.max(seed.abs());
                direction.push((known, seed));
            }
        }
        let wanted: usize = knowns
            .iter()
            .map(|known| self.layout.find(known).len())
            .sum();
        super::values::check_count(seeds.len(), wanted)?;
        super::values::check_count(sensitivities.len(), sources.len())?;
        if size == 0.0 {
            for index in 0..sources.len() {
                sensitivities.set(index, 0.0);
            }
            return Ok(());
        }
        // The derivative is linear in the seeds: of seeds of size 1 every step is finite.
        let mut reach = 0.0_f64;
        for (known, seed) in &mut direction {
            *seed /= size;
            reach = reach.max((*seed / self.nominal(*known)).abs());
        }
        // Writing states back is not exact: bases are kept at another point than the link's origin.
        let before = self.simulation.save();
        let mut found = self.differences(&sources, &direction, DIFFERENCE / reach);
        self.simulation.restore(&before)?;
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
            Known::Input(_) => 1.0,
        }
    }

    /// Richardson's extrapolation of the central differences over `h` and `h/2`; leaves states and
    /// inputs elsewhere.
    fn differences(&mut self, sources: &[usize], direction: &[(Known, f64)], h: f64) -> Vec<f64> {
        let mut x = vec![0.0; self.state_count()];
        self.simulation.read_states(&mut x);
        let base: Vec<f64> = direction
            .iter()
            .map(|(known, _)| match known {
                Known::State(index) => x[*index],
                Known::Input(slot) => self.simulation.input(*slot),
            })
            .collect();
        let mut sum = vec![0.0; sources.len()];
        for (way, weight) in [
            (h, -1.0 / (6.0 * h)),
            (-h, 1.0 / (6.0 * h)),
            (0.5 * h, 8.0 / (6.0 * h)),
            (-0.5 * h, -8.0 / (6.0 * h)),
        ] {
            let mut moves = false;
            for ((known, seed), base) in direction.iter().zip(&base) {
                let value = base + way * seed;
                match known {
                    Known::State(index) => {
                        x[*index] = value;
                        moves = true;
                    }
                    Known::Input(slot) => self.simulation.set_input(*slot, value),
                }
            }
            if moves {
                self.simulation.set_states(&x);
            }
            let mut reading = self.simulation.reading();
            for (sum, element) in sum.iter_mut().zip(sources) {
                *sum += weight * value(&mut reading, self.sources[*element]);
            }
        }
        sum
    }
}
