//! Continuous states of a Model Exchange FMU, as modelDescription.xml lists them.

use super::library::Element;
use super::variable::Variable;
use std::collections::BTreeMap;

/// What is read of them.
#[derive(Default)]
pub(super) struct States {
    /// FMI 2: whether unknowns that come are derivatives.
    pub inside: bool,
    /// The state of each derivative: places from 1 in FMI 2, value references in FMI 3.
    pub of: BTreeMap<u32, u32>,
    /// Derivatives in their order.
    pub rates: Vec<u32>,
    /// Number of event indicators.
    pub indicators: u32,
    /// Whether their events may be as late as the end of a step, which tells of them: so it is with
    /// FMUs of this program.
    pub announced: bool,
}

impl States {
    /// Names of the states in FMI 2, in their order.
    pub fn names_of_fmi_2(&self, variables: &[Variable]) -> Vec<String> {
        self.names(|state, names| {
            let place = usize::try_from(state).ok().and_then(|n| n.checked_sub(1));
            let variable = place.and_then(|place| variables.get(place));
            names.extend(variable.map(|variable| variable.name.clone()));
        })
    }

    /// Names of the states in FMI 3, in their order; those of a vector one by one.
    pub fn names_of_fmi_3(&self, variables: &[Variable], elements: &[Element]) -> Vec<String> {
        self.names(|state, names| {
            let of = variables.iter().filter(|variable| {
                let element = elements.get(variable.value_reference as usize);
                element.is_some_and(|element| element.value_reference == state)
            });
            names.extend(of.map(|variable| variable.name.clone()));
        })
    }

    fn names(&self, name: impl Fn(u32, &mut Vec<String>)) -> Vec<String> {
        let mut names = Vec::new();
        for rate in &self.rates {
            match self.of.get(rate) {
                Some(state) => name(*state, &mut names),
                // The number of states counts.
                None => names.push(format!("state {}", names.len() + 1)),
            }
        }
        names
    }
}
