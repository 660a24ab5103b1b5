//! Texts with `${…}` and `$(…)` in them → their values.

use super::evaluate::Evaluation;
use super::functions::{self, Names};
use super::parse;
use super::problem::{Done, Lacking, Meant, Problem, Weight};
use super::sources::Sources;
use super::symbols::{Entry, Symbols};
use super::value::{Value, number_of};
use super::yaml;
use std::collections::{BTreeMap, BTreeSet};

/// Texts longer than this, in bytes, are not made: a few properties that double each other fill
/// every memory.
const LONGEST: usize = 16 << 20;

/// Properties that need each other, and levels of a value.
const DEEPEST: usize = 100;

/// What texts refer to.
pub struct Texts<'f> {
    pub arguments: BTreeMap<String, String>,
    pub symbols: Symbols,
    pub sources: Sources<'f>,
    /// Whether what defines things could not be read, so that what is not defined may be in it.
    pub blind: bool,
    /// Arguments whose default cannot be known.
    pub lost: BTreeSet<String>,
    /// Properties that are being evaluated.
    open: usize,
}

/// What a name in an expression means.
#[derive(Clone, Copy)]
enum Meaning {
    /// `${name}`: a property.
    Property,
    /// `$(eval name)`: an argument.
    Argument,
}

impl<'f> Texts<'f> {
    pub fn new(arguments: BTreeMap<String, String>, sources: Sources<'f>) -> Self {
        Self {
            arguments,
            symbols: Symbols::new(),
            sources,
            blind: false,
            lost: BTreeSet::new(),
            open: 0,
        }
    }

    /// What becomes of a name that is not defined.
    pub fn weight_of_missing(&self) -> Weight {
        if self.blind { Weight::May } else { Weight::Own }
    }

    /// The value of a name, evaluated where it must be.
    pub fn entry(&mut self, scope: usize, name: &str) -> Done<Option<Value>> {
        let Some((owner, entry)) = self.symbols.find(scope, name) else {
            return Ok(None);
        };
        match entry.clone() {
            Entry::Value(value) => Ok(Some(value)),
            Entry::Open => Err(self
                .sources
                .problem(format!("the property '{name}' needs itself"))),
            Entry::Failed => Err(self.sources.follows()),
            Entry::Text(text) => {
                self.open += 1;
                if self.open > DEEPEST {
                    let message = format!("more than {DEEPEST} properties need each other");
                    return Err(self.sources.problem(message).that_ends());
                }
                self.symbols.set(owner, name, Entry::Open);
                let value = self.value(&text, owner).map(Value::of_literal);
                self.open -= 1;
                let entry = value.as_ref().ok().cloned();
                let entry = entry.map_or(Entry::Failed, Entry::Value);
                self.symbols.set(owner, name, entry);
                value.map(Some)
            }
        }
    }

    /// A text with its expressions evaluated, as it is written.
    pub fn shown(&mut self, text: &str, scope: usize) -> Done<String> {
        Ok(self.value(text, scope)?.shown())
    }

    fn too_large(&self) -> Problem {
        let message = format!("a value has more than {LONGEST} bytes or {DEEPEST} levels");
        self.sources.problem(message).that_ends()
    }

    /// A text with its expressions evaluated: their own value where there is nothing else.
    pub fn value(&mut self, text: &str, scope: usize) -> Done<Value> {
        if !text.contains('$') {
            return Ok(Value::text(text));
        }
        let mut parts: Vec<Value> = Vec::new();
        let mut rest = text;
        while !rest.is_empty() {
            let dollars = rest.len() - rest.trim_start_matches('$').len();
            let after = &rest[dollars..];
            if dollars >= 2 && after.starts_with(['{', '(']) {
                parts.push(Value::text(&rest[1..=dollars]));
                rest = &after[1..];
            } else if let Some(inner) = rest.strip_prefix("${") {
                let (inner, after) = inner
                    .split_once('}')
                    .ok_or_else(|| self.sources.problem(format!("'}}' is missing in '{text}'")))?;
                let inner = self.shown(inner, scope)?;
                parts.push(self.expression(&inner, scope, Meaning::Property)?);
                rest = after;
            } else if let Some(inner) = rest.strip_prefix("$(") {
                let (inner, after) = inner
                    .split_once(')')
                    .ok_or_else(|| self.sources.problem(format!("')' is missing in '{text}'")))?;
                let inner = self.shown(inner, scope)?;
                parts.push(Value::text(self.substitution(&inner, scope)?));
                rest = after;
            } else {
                let skip = dollars.min(1);
                let end = rest[skip..].find('$').map_or(rest.len(), |end| end + skip);
                parts.push(Value::text(&rest[..end]));
                rest = &rest[end..];
            }
        }
        if parts.len() == 1 {
            return Ok(parts.swap_remove(0));
        }
        let mut joined = String::new();
        for part in parts {
            joined.push_str(&part.shown());
            if joined.len() > LONGEST {
                return Err(self.too_large());
            }
        }
        Ok(Value::text(joined))
    }

    fn expression(&mut self, text: &str, scope: usize, meaning: Meaning) -> Done<Value> {
        let (mut failed, mut unknown) = (None, None);
        let value = parse::expression(text).and_then(|parsed| {
            let mut names = Scoped {
                texts: &mut *self,
                scope,
                meaning,
                failed: &mut failed,
                unknown: &mut unknown,
            };
            Evaluation::new(&mut names).value(&parsed)
        });
        if let Some(problem) = failed {
            return Err(problem);
        }
        let value = value.map_err(|error| {
            let shown = match meaning {
                Meaning::Property => format!("${{{text}}}"),
                Meaning::Argument => format!("$(eval {text})"),
            };
            let problem = self.sources.problem(format!("{error}, in {shown}"));
            let Some(name) = unknown else {
                return problem;
            };
            let problem = self.near(problem, scope, (&name, text), meaning);
            let lacking = Some(Lacking::Property(name));
            let weight = self.weight_of_missing();
            Problem {
                lacking,
                weight,
                ..problem
            }
        })?;
        if !value.fits(&mut LONGEST.clone(), DEEPEST) {
            return Err(self.too_large());
        }
        Ok(value)
    }

    /// A name that is not defined in an expression, with what it may stand for.
    fn near(
        &self,
        problem: Problem,
        scope: usize,
        (name, expression): (&str, &str),
        meaning: Meaning,
    ) -> Problem {
        if let Meaning::Argument = meaning {
            return problem.meant(name, self.arguments.keys().map(String::as_str));
        }
        if self.symbols.find(scope, &format!("**{name}")).is_some() {
            let meant = format!(
                "<xacro:property name=\"{name}\"> has no attribute 'value', so that it is a block"
            );
            let meant = Some(Meant::advice(meant));
            return Problem { meant, ..problem };
        }
        let own = self
            .symbols
            .names(scope)
            .filter(|own| !own.starts_with('*'));
        // A function has brackets behind its name.
        let called = expression
            .split(name)
            .skip(1)
            .any(|rest| rest.trim_start().starts_with('('));
        let globals = functions::globals().into_iter().filter(|known| {
            called || !matches!(functions::global(known), Some(Value::Function(_)))
        });
        problem.meant(name, own.chain(globals))
    }

    /// A value from outside with its `$(find …)`, which xacro looks for once more in what
    /// arguments and variables of the environment have given.
    fn with_packages(&mut self, value: &str) -> Done<String> {
        let mut out = String::new();
        let mut rest = value;
        while let Some((before, after)) = rest.split_once("$(find ") {
            let Some((name, after)) = after.split_once(')') else {
                break;
            };
            out.push_str(before);
            out.push_str(&self.sources.package(name.trim())?);
            rest = after;
        }
        out.push_str(rest);
        Ok(out)
    }

    /// What stands in `$(…)`.
    fn substitution(&mut self, text: &str, scope: usize) -> Done<String> {
        if let Some(expression) = text.strip_prefix("eval ") {
            let value = self.expression(expression, scope, Meaning::Argument)?;
            return Ok(value.shown());
        }
        let words: Vec<&str> = text.split(' ').filter(|word| !word.is_empty()).collect();
        match words[..] {
            ["arg", name] => {
                let known = self.arguments.get(name).cloned();
                if self.lost.contains(name) {
                    return known.ok_or_else(|| self.sources.follows());
                }
                let value = known.ok_or_else(|| Problem {
                    lacking: Some(Lacking::Argument(name.to_owned())),
                    weight: self.weight_of_missing(),
                    ..self
                        .sources
                        .problem(format!("the argument '{name}' has no value"))
                        .meant(name, self.arguments.keys().map(String::as_str))
                })?;
                self.with_packages(&value)
            }
            ["find", package] => self.sources.package(package),
            ["env", name] => {
                let value = std::env::var(name).map_err(|_| Problem {
                    lacking: Some(Lacking::Variable(name.to_owned())),
                    ..self
                        .sources
                        .problem(format!("the environment variable {name} is not set"))
                })?;
                self.with_packages(&value)
            }
            ["optenv", name, ref default @ ..] => {
                let value = std::env::var(name).unwrap_or_else(|_| default.join(" "));
                self.with_packages(&value)
            }
            ["dirname"] => Ok(self.sources.folder()),
            ["cwd"] => Ok(std::env::current_dir()
                .unwrap_or_default()
                .display()
                .to_string()),
            _ => Err(self.sources.problem(format!(
                "$({text}) is not known: there are find, arg, env, optenv, eval, dirname, cwd"
            ))),
        }
    }
}

/// Names in a scope.
struct Scoped<'a, 'f> {
    texts: &'a mut Texts<'f>,
    scope: usize,
    meaning: Meaning,
    /// The problem behind an error, which knows its place.
    failed: &'a mut Option<Problem>,
    /// A name that is not defined.
    unknown: &'a mut Option<String>,
}

impl Scoped<'_, '_> {
    fn told<T>(&mut self, done: Done<T>) -> Result<T, String> {
        done.map_err(|problem| {
            let message = problem.message.clone();
            self.failed.get_or_insert(problem);
            message
        })
    }
}

impl Names for Scoped<'_, '_> {
    fn name(&mut self, name: &str) -> Result<Option<Value>, String> {
        match self.meaning {
            Meaning::Property => self.in_scope(self.scope, name),
            Meaning::Argument if self.texts.lost.contains(name) => {
                let lost = Err(self.texts.sources.follows());
                self.told(lost)
            }
            Meaning::Argument => Ok(match name {
                "true" => Some(Value::Bool(true)),
                "false" => Some(Value::Bool(false)),
                "arg" => Some(Value::Function("arg")),
                _ => self.argument(name).map(word),
            }),
        }
    }

    fn in_scope(&mut self, scope: usize, name: &str) -> Result<Option<Value>, String> {
        let found = self.texts.entry(scope, name);
        self.told(found)
    }

    fn unknown(&mut self, name: &str) {
        *self.unknown = Some(name.to_owned());
    }

    fn yaml(&mut self, name: &str) -> Result<Value, String> {
        let path = self.texts.sources.beside(name);
        let path = self.texts.sources.there(path);
        let text = self.texts.sources.text(&path);
        let text = self.told(text)?;
        let mut evaluate = |text: &str| {
            let parsed = parse::expression(text).ok()?;
            Evaluation::new(&mut Nothing).value(&parsed).ok()?.number()
        };
        let read = yaml::read(&text, &mut evaluate).map_err(|error| {
            let problem = self
                .texts
                .sources
                .problem(format!("{}: {error}", path.display()));
            let meant = "correct that file: it is no YAML that could be read".to_owned();
            let meant = Some(Meant::advice(meant));
            Problem { meant, ..problem }
        });
        self.told(read)
    }

    fn path(&mut self, name: &str) -> String {
        self.texts.sources.beside(name).display().to_string()
    }

    fn argument(&mut self, name: &str) -> Option<String> {
        self.texts.arguments.get(name).cloned()
    }
}

/// The value of an argument in `$(eval …)`.
fn word(text: String) -> Value {
    match text.to_lowercase().as_str() {
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        _ => number_of(&text).unwrap_or_else(|| Value::text(text)),
    }
}

/// No names but Python's own.
struct Nothing;

impl Names for Nothing {}
