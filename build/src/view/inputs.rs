//! Who holds which input.
//!
//! An input has the value that was set last, or that of the table of inputs until someone sets it.
//! A viewer may hold it at another value; of several holders the last one counts. When a viewer
//! disconnects, or sends nothing for some time, the inputs that it held are released.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use urdf2fmu_drawing::scene::Variable;

/// A viewer that holds something says so many times a second; after this silence it is let go.
const SILENCE: Duration = Duration::from_secs(2);

/// An input and what is asked of it.
#[derive(Debug)]
struct Input {
    name: String,
    start: f64,
    range: [f64; 2],
    /// Whether the table of inputs gives it.
    in_table: bool,
    /// What was set for good.
    set: Option<f64>,
    /// Viewers with their values, the last one last.
    holds: Vec<(u64, f64)>,
    /// What others than the table last made of it.
    sent: Option<f64>,
}

impl Input {
    /// None where the table gives it.
    fn value(&self) -> Option<f64> {
        let held = self.holds.last().map(|(_, value)| *value).or(self.set);
        held.or((!self.in_table).then_some(self.start))
    }
}

/// All inputs.
#[derive(Debug)]
pub struct Inputs {
    list: Vec<Input>,
    places: BTreeMap<String, usize>,
    heard: BTreeMap<u64, Instant>,
}

impl Inputs {
    /// The inputs of a scene.
    ///
    /// - `in_table`: whether the table of inputs has a column for one
    pub fn new(variables: &[Variable], in_table: impl Fn(&str) -> bool) -> Self {
        let inputs = variables
            .iter()
            .filter(|v| v.causality == "input" && v.kind == "real");
        let list: Vec<Input> = inputs
            .map(|v| Input {
                name: v.name.clone(),
                start: v.start.unwrap_or_default(),
                range: [v.min.unwrap_or(f64::MIN), v.max.unwrap_or(f64::MAX)],
                in_table: in_table(&v.name),
                set: None,
                holds: Vec::new(),
                sent: None,
            })
            .collect();
        let places = list
            .iter()
            .enumerate()
            .map(|(i, input)| (input.name.clone(), i))
            .collect();
        Self {
            list,
            places,
            heard: BTreeMap::new(),
        }
    }

    /// The input of that name and what it can be of a value; none for what is no number.
    fn find(&mut self, name: &str, value: f64) -> Option<(&mut Input, f64)> {
        let input = &mut self.list[*self.places.get(name)?];
        let [low, high] = input.range;
        value.is_finite().then(|| (input, value.clamp(low, high)))
    }

    /// A viewer is there.
    pub fn hear(&mut self, viewer: u64, now: Instant) {
        self.heard.insert(viewer, now);
    }

    /// A viewer sets inputs for good. Unknown names and what is no number are ignored; values
    /// beyond the limits become the limits.
    pub fn set(&mut self, values: &BTreeMap<String, f64>) {
        for (name, value) in values {
            if let Some((input, value)) = self.find(name, *value) {
                input.set = Some(value);
            }
        }
    }

    /// A viewer holds inputs.
    pub fn hold(&mut self, viewer: u64, values: &BTreeMap<String, f64>) {
        for (name, value) in values {
            if let Some((input, value)) = self.find(name, *value) {
                match input.holds.iter_mut().find(|(holder, _)| *holder == viewer) {
                    Some(hold) => hold.1 = value,
                    None => input.holds.push((viewer, value)),
                }
            }
        }
    }

    /// A viewer holds inputs no longer.
    pub fn release(&mut self, viewer: u64, names: &[String]) {
        for name in names {
            if let Some(&place) = self.places.get(name) {
                self.list[place]
                    .holds
                    .retain(|(holder, _)| *holder != viewer);
            }
        }
    }

    /// A viewer holds nothing any longer.
    pub fn release_all(&mut self, viewer: u64) {
        self.heard.remove(&viewer);
        for input in &mut self.list {
            input.holds.retain(|(holder, _)| *holder != viewer);
        }
    }

    /// Lets go what is held by viewers that are not heard of.
    pub fn release_silent(&mut self, now: Instant) {
        let heard = &self.heard;
        let there = |viewer: &u64| {
            heard
                .get(viewer)
                .is_some_and(|heard| now.duration_since(*heard) < SILENCE)
        };
        for input in &mut self.list {
            input.holds.retain(|(holder, _)| there(holder));
        }
    }

    /// After a reset nothing is set and nothing held.
    pub fn reset(&mut self) {
        for input in &mut self.list {
            (input.set, input.sent) = (None, None);
            input.holds.clear();
        }
    }

    /// Names and values of what people decide about; the table decides about the rest.
    pub fn decided(&self) -> Vec<(&str, f64)> {
        let decided = self
            .list
            .iter()
            .filter(|input| input.set.is_some() || !input.holds.is_empty() || !input.in_table);
        decided
            .filter_map(|input| Some((input.name.as_str(), input.value()?)))
            .collect()
    }

    /// Names and values that have changed since the last time.
    pub fn changed(&mut self) -> Vec<(String, f64)> {
        let mut changed = Vec::new();
        for input in &mut self.list {
            let value = input.value();
            if value.map(f64::to_bits) != input.sent.map(f64::to_bits) {
                input.sent = value;
                changed.extend(value.map(|value| (input.name.clone(), value)));
            }
        }
        changed
    }

    /// Names and values of all that people decide about, and names of what is held.
    pub fn all(&self) -> (BTreeMap<&str, f64>, Vec<&str>) {
        let values = self
            .list
            .iter()
            .filter_map(|i| Some((i.name.as_str(), i.value()?)));
        let held = self.list.iter().filter(|i| !i.holds.is_empty());
        (values.collect(), held.map(|i| i.name.as_str()).collect())
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values are passed on as they are")]
mod tests {
    use super::*;

    fn inputs() -> Inputs {
        let variable = |name: &str, reference| Variable {
            name: name.to_owned(),
            reference,
            causality: "input".to_owned(),
            variability: "continuous".to_owned(),
            kind: "real".to_owned(),
            unit: String::new(),
            description: String::new(),
            start: Some(1.0),
            min: Some(-5.0),
            max: Some(5.0),
        };
        let variables = [variable("a", 0), variable("b", 1), variable("table", 2)];
        Inputs::new(&variables, |name| name == "table")
    }

    fn of(name: &str, value: f64) -> BTreeMap<String, f64> {
        BTreeMap::from([(name.to_owned(), value)])
    }

    fn value(inputs: &Inputs, reference: u32) -> Option<f64> {
        let name = ["a", "b", "table"][reference as usize];
        let decided = inputs.decided();
        let mut decided = decided.iter();
        decided.find(|(n, _)| *n == name).map(|(_, value)| *value)
    }

    #[test]
    fn the_last_holder_counts_and_what_was_set_comes_back() {
        let mut inputs = inputs();
        assert_eq!(value(&inputs, 0), Some(1.0));
        inputs.set(&of("a", 2.0));
        inputs.hold(7, &of("a", 3.0));
        inputs.hold(8, &of("a", 4.0));
        inputs.hold(7, &of("a", 3.5));
        assert_eq!(value(&inputs, 0), Some(4.0));
        inputs.release(8, &["a".to_owned()]);
        assert_eq!(value(&inputs, 0), Some(3.5));
        inputs.release_all(7);
        assert_eq!(value(&inputs, 0), Some(2.0));
        inputs.reset();
        assert_eq!(value(&inputs, 0), Some(1.0));
    }

    #[test]
    fn what_a_silent_viewer_holds_is_let_go() {
        let mut inputs = inputs();
        let now = Instant::now();
        inputs.hear(7, now);
        inputs.hold(7, &of("b", 4.0));
        inputs.release_silent(now + SILENCE / 2);
        assert_eq!(value(&inputs, 1), Some(4.0));
        inputs.release_silent(now + SILENCE);
        assert_eq!(value(&inputs, 1), Some(1.0));
    }

    #[test]
    fn what_is_no_number_or_no_input_is_ignored_and_limits_hold() {
        let mut inputs = inputs();
        inputs.set(&of("nothing", 2.0));
        inputs.set(&of("a", f64::NAN));
        inputs.set(&of("a", f64::INFINITY));
        assert_eq!(value(&inputs, 0), Some(1.0));
        inputs.set(&of("a", 1e9));
        assert_eq!(value(&inputs, 0), Some(5.0));
    }

    #[test]
    fn the_table_decides_until_someone_else_does() {
        let mut inputs = inputs();
        assert_eq!(value(&inputs, 2), None);
        inputs.hold(7, &of("table", 2.0));
        assert_eq!(value(&inputs, 2), Some(2.0));
        inputs.release_all(7);
        assert_eq!(value(&inputs, 2), None);
        inputs.set(&of("table", 3.0));
        assert_eq!(value(&inputs, 2), Some(3.0));
    }

    #[test]
    fn changes_are_told_once() {
        let mut inputs = inputs();
        assert_eq!(inputs.changed().len(), 2);
        assert!(inputs.changed().is_empty());
        inputs.set(&of("b", 2.0));
        assert_eq!(inputs.changed(), [("b".to_owned(), 2.0)]);
    }
}
