//! FMI 3's arrays as lists of their elements.
//!
//! An FMU of this program names the elements in an annotation of the model: they have the names of
//! FMI 2's variables. Those of other FMUs are numbered from 1, `name[2]` or `name[1,2]`.

use super::attributes::DescriptionError;
use super::library::Element;
use super::variable::{Kind, Variable};
use std::collections::{BTreeMap, BTreeSet};

/// Elements that are looked at, of all variables.
const MOST: u32 = 1_000_000;

/// A variable of FMI 3.
pub(super) struct Array {
    pub variable: Variable,
    /// What a structural parameter is at its start: the size of arrays.
    pub start: Option<u32>,
    /// Empty for a scalar.
    pub shape: Vec<Size>,
}

/// What arrays become.
#[derive(Default)]
pub(super) struct Listed {
    /// Which element of what each variable is.
    pub elements: Vec<Element>,
    /// Scalars, and each element.
    pub variables: Vec<Variable>,
    /// Names of the elements of arrays that have them for themselves, by the arrays' names.
    pub wholes: BTreeMap<String, Vec<String>>,
}

/// Size of a dimension.
#[derive(Clone, Copy)]
pub(super) enum Size {
    /// A number.
    Fixed(u32),
    /// That of a structural parameter, by its value reference.
    Of(u32),
}

/// All of them, while they are read.
#[derive(Default)]
pub(super) struct Arrays {
    pub list: Vec<Array>,
    /// Whether what comes is a variable.
    pub inside: bool,
    /// Whether the next text names elements.
    pub named: bool,
    /// Names of the elements of arrays, by their value references.
    names: BTreeMap<u32, Vec<String>>,
}

/// Whether an element of the XML is a variable of FMI 3.
pub(super) fn is_type(name: &str) -> bool {
    let numbers = [
        "Float32", "Float64", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32",
    ];
    let others = [
        "Int64",
        "UInt64",
        "Boolean",
        "String",
        "Binary",
        "Enumeration",
        "Clock",
    ];
    numbers.contains(&name) || others.contains(&name)
}

impl Arrays {
    /// Text between tags.
    pub fn text(&mut self, text: &str) {
        if std::mem::take(&mut self.named) {
            self.names = text
                .lines()
                .filter_map(|line| {
                    let mut words = line.split_whitespace();
                    let reference = words.next()?.parse().ok()?;
                    Some((reference, words.map(str::to_owned).collect()))
                })
                .collect();
        }
    }

    /// A dimension of the last variable.
    pub fn dimension(&mut self, size: Size) {
        if let Some(array) = self.list.last_mut() {
            array.shape.push(size);
        }
    }

    /// Each element as a variable, and which one it is. A name is listed once: that of a scalar,
    /// else that of the first array.
    ///
    /// # Errors
    /// [`DescriptionError`] for the size of what is no structural parameter.
    pub fn elements(self) -> Result<Listed, DescriptionError> {
        let parameters = self.list.iter();
        let parameters = parameters.filter_map(|a| Some((a.variable.value_reference, a.start?)));
        let starts: BTreeMap<u32, u32> = parameters.collect();
        let scalars = self.list.iter().filter(|array| array.shape.is_empty());
        let mut names: BTreeSet<String> = scalars.map(|a| a.variable.name.clone()).collect();
        let Listed {
            mut elements,
            mut variables,
            mut wholes,
        } = Listed::default();
        // Those whose names others have count, too: they are not listed, and take as long.
        let mut seen = 0_u32;
        for array in self.list {
            let sizes = array.shape.iter().map(|size| match size {
                Size::Fixed(size) => Ok(*size),
                Size::Of(parameter) => starts.get(parameter).copied().ok_or_else(no_size),
            });
            let shape = sizes.collect::<Result<Vec<u32>, _>>()?;
            let mut sizes = shape.iter();
            let count = sizes.try_fold(1_u32, |count, size| count.checked_mul(*size));
            let count = count.unwrap_or(u32::MAX);
            let simulated = array.variable.kind != Kind::Text && count <= MOST - seen.min(MOST);
            let looked = if simulated { count } else { 1 };
            seen = seen.saturating_add(looked);
            let mut own = Vec::new();
            for index in 0..looked {
                let name = if array.shape.is_empty() || !simulated {
                    array.variable.name.clone()
                } else {
                    let reference = &array.variable.value_reference;
                    array.name(index, &shape, self.names.get(reference))
                };
                if !array.shape.is_empty() && !names.insert(name.clone()) {
                    continue;
                }
                own.push(name.clone());
                variables.push(Variable {
                    name,
                    value_reference: u32::try_from(elements.len()).unwrap_or(u32::MAX),
                    kind: if simulated {
                        array.variable.kind
                    } else {
                        Kind::Text
                    },
                    ..array.variable.clone()
                });
                elements.push(Element {
                    value_reference: array.variable.value_reference,
                    index,
                    count,
                });
            }
            if simulated && !array.shape.is_empty() && own.len() == count as usize {
                wholes.insert(array.variable.name.clone(), own);
            }
        }
        Ok(Listed {
            elements,
            variables,
            wholes,
        })
    }
}

fn no_size() -> DescriptionError {
    DescriptionError::Attribute {
        element: "Dimension".to_owned(),
        attribute: "valueReference",
    }
}

impl Array {
    fn name(&self, index: u32, shape: &[u32], names: Option<&Vec<String>>) -> String {
        if let Some(name) = names.and_then(|names| names.get(index as usize)) {
            return name.clone();
        }
        let mut rest = index;
        let mut numbers = Vec::new();
        for size in shape.iter().rev() {
            numbers.push((rest % size + 1).to_string());
            rest /= size;
        }
        numbers.reverse();
        format!("{}[{}]", self.variable.name, numbers.join(","))
    }
}
