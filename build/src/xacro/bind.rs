//! The parameters of a macro that is called.

use super::expand::Expansion;
use super::macros::Macro;
use super::problem::{Done, Lacking, Problem};
use super::symbols::Entry;
use super::tree::{Element, Node};
use super::value::Value;
use std::rc::Rc;
use urdf2fmu_core::diagnostic::Place;

impl Expansion<'_> {
    /// Gives the parameters of a macro their values, in the scope `inner`.
    pub(super) fn bind(
        &mut self,
        (name, found): (&str, &Macro),
        call: &Element,
        (macros, scope): (usize, usize),
        inner: usize,
    ) -> Done<()> {
        let (mut given, mut unknown): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
        for (key, text) in &call.attributes {
            if key == "xmlns:xacro" {
                continue;
            }
            if !found
                .parameters
                .iter()
                .any(|parameter| parameter.name == *key)
            {
                // What uses it follows from that.
                self.texts.symbols.set(inner, key, Entry::Failed);
                unknown.push(key);
                continue;
            }
            let entry = self.entry(text, scope)?;
            self.texts.symbols.set(inner, key, entry);
            given.push(key);
        }
        let mut ignored = Vec::new();
        let (around, at) = (std::mem::take(&mut self.faulty), self.texts.sources.at);
        let inside = self.children(&call.children, macros, scope, &mut ignored)?;
        let lost = std::mem::replace(&mut self.faulty, around);
        self.texts.sources.at = at;
        let mut blocks = inside.iter().filter_map(|node| match node {
            Node::Element(element) => Some(Rc::clone(element)),
            Node::Text(_) => None,
        });
        for parameter in &found.parameters {
            let key = &parameter.name;
            if key.starts_with('*') {
                let entry = if let Some(block) = blocks.next() {
                    Entry::Value(Value::Block(block))
                } else {
                    // The block may be what could not be expanded.
                    if !lost {
                        let message = format!("macro '{name}' needs a block for '{key}'");
                        self.pass(self.problem(message))?;
                    }
                    Entry::Failed
                };
                self.texts.symbols.set(inner, key, entry);
            }
        }
        if let Some(block) = blocks.next() {
            let message = format!("macro '{name}' has no use for the block <{}>", block.name);
            self.pass(self.no_parameter(message, found))?;
        }
        let mut lacking = Vec::new();
        for parameter in &found.parameters {
            let key = &parameter.name;
            if key.starts_with('*') || given.contains(&key.as_str()) {
                continue;
            }
            let value = self.attempt(|this| {
                let forwarded = if parameter.forward {
                    this.texts.entry(scope, key)?
                } else {
                    None
                };
                match (forwarded, &parameter.default) {
                    (Some(value), _) => Ok(Some(value)),
                    (None, Some(default)) => this.texts.value(default, scope).map(Some),
                    (None, None) => Ok(None),
                }
            })?;
            let entry = match value {
                Some(Some(value)) => Entry::Value(value.of_literal()),
                Some(None) => {
                    lacking.push(format!("'{key}'"));
                    Entry::Failed
                }
                None => Entry::Failed,
            };
            self.texts.symbols.set(inner, key, entry);
        }
        if lacking.is_empty() && self.unlisted(name, found, &unknown)? {
            return Ok(());
        }
        // A name that is wrong makes both.
        let mut wrong = Vec::new();
        if !unknown.is_empty() {
            let listed: Vec<String> = unknown.iter().map(|key| format!("'{key}'")).collect();
            wrong.push(format!("has no parameter {}", listed.join(", ")));
        }
        if !lacking.is_empty() {
            wrong.push(format!("needs {}", lacking.join(", ")));
        }
        if wrong.is_empty() {
            return Ok(());
        }
        let message = format!("macro '{name}' {}", wrong.join(" and "));
        let left = found.parameters.iter().map(|parameter| &parameter.name[..]);
        let left = left.filter(|key| !given.contains(key));
        let problem = self.no_parameter(message, found);
        let problem = match unknown.first() {
            Some(first) => problem.meant(first, left),
            None => problem,
        };
        self.pass(problem.or_meant(|| self.parameters_of(found, &unknown, &lacking)))
    }

    /// Tells parameters that a macro uses and does not list; whether that are all of `unknown`.
    ///
    /// Who leaves them out of the calls would be told next that their names are not defined.
    fn unlisted(&mut self, name: &str, found: &Macro, unknown: &[&str]) -> Done<bool> {
        let used = |key: &&str| uses(&found.body, key);
        if unknown.is_empty() || !unknown.iter().all(used) {
            return Ok(false);
        }
        let Some(defined) = self.defined(found) else {
            return Ok(false);
        };
        let listed: Vec<String> = unknown.iter().map(|key| format!("'{key}'")).collect();
        let own = found.body.attribute("params").unwrap_or_default();
        let all: Vec<&str> = own
            .split_whitespace()
            .chain(unknown.iter().copied())
            .collect();
        let advice = format!(
            "the macro uses what it does not list: write params=\"{}\" where it is defined, in \
             {defined}",
            all.join(" ")
        );
        let message = format!("macro '{name}' has no parameter {}", listed.join(", "));
        let both = format!("{name} {}", unknown.join(" "));
        let problem = self.no_parameter(message, found).or_meant(|| Some(advice));
        self.pass(Problem {
            lacking: Some(Lacking::Parameter(both)),
            ..problem
        })?;
        Ok(true)
    }

    /// Where a macro is defined, `file:line`.
    fn defined(&self, found: &Macro) -> Option<String> {
        let text = self.texts.sources.read.get(&*found.file)?;
        let shown = found.file.display().to_string();
        let at = found.body.at;
        let line = Place::in_text(&shown, text, at..at + 1).line;
        Some(format!("{shown}:{line}"))
    }

    /// What a call lacks or has too much, and where the macro says so.
    fn parameters_of(&self, found: &Macro, unknown: &[&str], lacking: &[String]) -> Option<String> {
        let defined = self.defined(found)?;
        let give: Vec<String> = lacking
            .iter()
            .map(|key| format!("{}=\"…\"", key.trim_matches('\'')))
            .collect();
        let mut advice = Vec::new();
        if !give.is_empty() {
            advice.push(format!("write {} into the call", give.join(" ")));
        }
        if !unknown.is_empty() {
            advice.push(format!("leave out {}", unknown.join(", ")));
        }
        Some(format!(
            "{}: the macro is defined in {defined}",
            advice.join(" and ")
        ))
    }

    /// That a macro has not the parameters with which it is called: its list of them may have
    /// another name.
    fn no_parameter(&self, message: String, found: &Macro) -> Problem {
        let problem = self.problem(message);
        if found.body.attribute("params").is_some() || !found.parameters.is_empty() {
            return problem;
        }
        problem.misspelt("params", &found.body)
    }
}

/// Whether an expression in an element has a name.
fn uses(element: &Element, name: &str) -> bool {
    let letter = |c: char| c.is_alphanumeric() || c == '_';
    let within = |text: &str| {
        let expressions = text.split("${").skip(1);
        let mut words = expressions.flat_map(|rest| {
            let inside = rest.split('}').next().unwrap_or_default();
            inside.split(|c| !letter(c))
        });
        words.any(|word| word == name)
    };
    element.attributes.iter().any(|(_, value)| within(value))
        || element.children.iter().any(|node| match node {
            Node::Element(inner) => uses(inner, name),
            Node::Text(text) => within(text),
        })
}
