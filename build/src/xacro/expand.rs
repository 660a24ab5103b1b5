//! A document in xacro → the document that it stands for.
//!
//! The operations and their order are those of the xacro program of ROS (2.1), which works on the
//! document in place: the result of a node replaces it, and is not expanded again.
//!
//! What cannot be expanded is told and left out, and the expansion goes on, so that one run tells
//! all that is wrong. What only follows from something that was told is not told.

use super::files::SIGNS;
use super::macros::{Macro, Macros};
use super::parameter::parameters;
use super::problem::{Done, Lacking, Problem, Weight};
use super::proposed::Proposed;
use super::sources::{Find, Sources};
use super::symbols::Entry;
use super::texts::Texts;
use super::tree::{self, Element, Node};
use super::value::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Macros and elements within each other.
const DEEPEST: usize = 100;

/// Elements that a document may grow to.
const MOST_ELEMENTS: usize = 1_000_000;

/// Elements and calls that are looked into after something wrong was met. Macros that call
/// themselves within calls which are wrong would go on for seconds, without anything new to tell.
pub(super) const MOST_AFTER: usize = 20_000;

/// The state of an expansion.
pub struct Expansion<'f> {
    pub texts: Texts<'f>,
    /// What is wrong, in the order in which it was met.
    pub problems: Vec<Problem>,
    /// What may follow from these.
    pub maybe: Vec<Problem>,
    /// Whether what is looked at is left out, as far as is known.
    pub(super) supposed: bool,
    /// Properties that are set where that is so: what they are afterwards is not known.
    pub(super) doubtful: Vec<(usize, String)>,
    /// Whether all elements are there and have their names, whatever is wrong.
    pub whole: bool,
    pub(super) macros: Macros,
    elements: usize,
    /// Elements and calls since something wrong was met.
    pub(super) after: usize,
    pub(super) depth: usize,
    /// Whether something of the present element is left out.
    pub(super) faulty: bool,
}

impl<'f> Expansion<'f> {
    pub fn new(arguments: BTreeMap<String, String>, find: &'f Find<'f>) -> Self {
        Self {
            texts: Texts::new(arguments, Sources::new(find)),
            problems: Vec::new(),
            maybe: Vec::new(),
            supposed: false,
            doubtful: Vec::new(),
            whole: true,
            macros: Macros::new(),
            elements: 0,
            after: 0,
            depth: 0,
            faulty: false,
        }
    }

    /// The expanded document, without what cannot be expanded.
    pub fn document(&mut self, path: &Path) -> Option<Element> {
        self.document_with(path, &Proposed::default())
    }

    /// The expanded document, as it would be if this was done.
    pub(super) fn document_with(&mut self, path: &Path, proposed: &Proposed) -> Option<Element> {
        for (name, found) in &proposed.macros {
            self.macros.set(0, name.clone(), Rc::clone(found));
        }
        for (name, entry) in &proposed.properties {
            self.texts.symbols.set(0, name, entry.clone());
        }
        self.texts.sources.meant.clone_from(&proposed.meant);
        let mut files = proposed.files.iter().map(PathBuf::as_path).chain([path]);
        let done = files.try_fold(Element::default(), |_, file| {
            let (root, wrong) = self.texts.sources.root(file)?;
            self.misread(wrong)?;
            self.texts.sources.enter(file.to_owned())?;
            let found = self.element(&root, 0, 0)?;
            self.texts.sources.leave();
            Ok(found)
        });
        let root = done.map_err(|problem| self.tell(problem)).ok();
        // What has ended the expansion may be a property without an end.
        if root.is_some() && !self.problems.is_empty() {
            self.suppose_properties();
        }
        root
    }

    /// Names of macros that the file defines.
    pub fn macro_names(&self) -> Vec<String> {
        self.macros.names()
    }

    pub(super) fn problem(&self, message: impl Into<String>) -> Problem {
        self.texts.sources.problem(message)
    }

    /// Counts an element or a call.
    ///
    /// # Errors
    /// After too many of them since something wrong was met: enough was told.
    fn step(&mut self) -> Done<()> {
        if self.problems.is_empty() && !self.supposed {
            return Ok(());
        }
        self.after += 1;
        if self.after <= MOST_AFTER {
            return Ok(());
        }
        let weight = Weight::Enough;
        Err(Problem {
            weight,
            ..self.texts.sources.follows()
        })
    }

    /// An element with all that is in it, expanded.
    pub(super) fn element(
        &mut self,
        element: &Element,
        macros: usize,
        scope: usize,
    ) -> Done<Element> {
        self.texts.sources.at = element.at;
        self.step()?;
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            let problem = self.problem(format!("more than {MOST_ELEMENTS} elements"));
            return Err(problem.that_ends());
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            let problem = self.problem("macros, files or elements are nested too deeply");
            return Err(problem.that_ends());
        }
        let around = std::mem::replace(&mut self.faulty, element.faulty);
        let mut attributes = Vec::with_capacity(element.attributes.len());
        for (name, value) in &element.attributes {
            if !name.starts_with("xacro:") && name != "xmlns:xacro" {
                let value = self.attempt(|this| this.texts.shown(value, scope))?;
                match value {
                    Some(value) => attributes.push((name.clone(), value)),
                    None => self.leave_out_attribute(name),
                }
            }
        }
        let children = self.children(&element.children, macros, scope, &mut attributes)?;
        self.depth -= 1;
        Ok(Element {
            name: element.name.clone(),
            attributes,
            children,
            at: element.at,
            file: element.file.clone(),
            faulty: std::mem::replace(&mut self.faulty, around),
        })
    }

    pub(super) fn children(
        &mut self,
        children: &[Node],
        macros: usize,
        scope: usize,
        attributes: &mut Vec<(String, String)>,
    ) -> Done<Vec<Node>> {
        let mut out = Vec::new();
        for child in children {
            match child {
                Node::Text(text) => match self.attempt(|this| this.texts.shown(text, scope))? {
                    Some(text) => out.push(Node::Text(text)),
                    None => self.faulty = true,
                },
                Node::Element(child) => {
                    self.texts.sources.at = child.at;
                    let (around, out) = (&mut *attributes, &mut out);
                    let found = self.attempt(|this| {
                        let done = this.child(child, macros, scope, around, out);
                        done.map_err(|problem| problem.after_that_of(child))
                    });
                    if found?.is_none() {
                        self.leave_out(child);
                    }
                }
            }
        }
        Ok(out)
    }

    fn child(
        &mut self,
        child: &Rc<Element>,
        macros: usize,
        scope: usize,
        attributes: &mut Vec<(String, String)>,
        out: &mut Vec<Node>,
    ) -> Done<()> {
        let Some(name) = child.name.strip_prefix("xacro:") else {
            out.push(Node::Element(Rc::new(self.element(child, macros, scope)?)));
            return Ok(());
        };
        match name {
            "insert_block" => {
                let name = self.required(child, "name")?.to_owned();
                let many = self.texts.entry(scope, &format!("**{name}"))?;
                let (block, whole) = match many {
                    Some(Value::Block(block)) => (block, false),
                    _ => match self.texts.entry(scope, &format!("*{name}"))? {
                        Some(Value::Block(block)) => (block, true),
                        _ => return Err(self.no_block(&name, scope)),
                    },
                };
                if whole && block.name.starts_with("xacro:") {
                    // A block that is itself a call was expanded where it was given.
                    return self.child(&block, macros, scope, attributes, out);
                }
                let found = self.element(&block, macros, scope)?;
                self.faulty |= found.faulty && !whole;
                if whole {
                    out.push(Node::Element(Rc::new(found)));
                } else {
                    out.extend(found.children);
                }
            }
            "include" => self.include(child, macros, scope, attributes, out)?,
            "property" => self.property(child, scope)?,
            "macro" => self.define(child, macros)?,
            "arg" => self.argument(child, scope)?,
            "element" => {
                let name = self.required(child, "xacro:name")?.to_owned();
                let name = self.texts.shown(&name, scope)?;
                if name.is_empty() {
                    return Err(self.problem("<xacro:element> has an empty name"));
                }
                let renamed = Rc::new(Element {
                    name,
                    ..child.as_ref().clone()
                });
                self.child(&renamed, macros, scope, attributes, out)?;
            }
            "attribute" => {
                let name = self.required(child, "name")?.to_owned();
                let value = self.required(child, "value")?.to_owned();
                let (name, value) = (
                    self.texts.value(&name, scope)?,
                    self.texts.value(&value, scope)?,
                );
                tree::set(attributes, &name.shown(), value.shown());
            }
            "if" | "unless" => {
                let condition = self.required(child, "value")?.to_owned();
                let value = self.texts.value(&condition, scope);
                let truth = value.and_then(|value| self.truth(&value, &condition));
                if truth.is_err() {
                    self.suppose(child, macros, scope);
                }
                if truth? == (name == "if") {
                    let found = self.element(child, macros, scope)?;
                    self.faulty |= found.faulty;
                    out.extend(found.children);
                }
            }
            "call" => {
                let name = self.required(child, "macro")?.to_owned();
                let name = self.texts.shown(&name, scope)?;
                let mut call = child.as_ref().clone();
                call.attributes.retain(|(own, _)| own != "macro");
                self.call(&name, &call, macros, scope, attributes, out)?;
            }
            name => self.call(name, child, macros, scope, attributes, out)?,
        }
        Ok(())
    }

    pub(super) fn required<'e>(&self, element: &'e Element, name: &str) -> Done<&'e str> {
        let found = element.attribute(name);
        found.ok_or_else(|| {
            let message = format!("<{}> has no attribute '{name}'", element.name);
            let problem = self.problem(message).misspelt(name, element);
            problem.or_meant(|| Some(format!("write {name}=\"…\"")))
        })
    }

    fn truth(&self, value: &Value, condition: &str) -> Done<bool> {
        let Value::Str(text) = value else {
            return Ok(value.truth());
        };
        match text.as_ref() {
            "true" | "True" => Ok(true),
            "false" | "False" => Ok(false),
            text => text
                .trim()
                .parse::<i64>()
                .map(|number| number != 0)
                .map_err(|_| {
                    self.problem(format!(
                        "'{condition}' is '{text}', which is neither true nor false"
                    ))
                }),
        }
    }

    fn include(
        &mut self,
        element: &Element,
        macros: usize,
        scope: usize,
        attributes: &mut Vec<(String, String)>,
        out: &mut Vec<Node>,
    ) -> Done<()> {
        let file = self.required(element, "filename")?.to_owned();
        let optional = match element.attribute("optional") {
            Some(word) => self.truth(&Value::text(word).of_literal(), word)?,
            None => false,
        };
        let (mut macros, mut scope) = (macros, scope);
        let outer = scope;
        if let Some(name) = element.attribute("ns") {
            let name = self.texts.shown(name, scope)?;
            let inner = self.texts.symbols.below(scope, true);
            self.texts
                .symbols
                .set(scope, &name, Entry::Value(Value::Scope(inner)));
            (macros, scope) = (self.macros.named_below(macros, name), inner);
        }
        let spec = self.texts.shown(&file, outer)?;
        let files = if spec.contains(SIGNS) {
            self.texts.sources.matching(&spec)
        } else {
            vec![self.texts.sources.beside(&spec)]
        };
        for path in files {
            let at = self.texts.sources.at;
            let path = if optional {
                path
            } else {
                self.texts.sources.there(path)
            };
            let (root, wrong) = match self.texts.sources.root(&path) {
                Err(problem) if matches!(problem.lacking, Some(Lacking::File(_))) => {
                    if optional {
                        continue;
                    }
                    let what = match spec.as_str() {
                        "" => "<xacro:include>:",
                        _ => "the included file",
                    };
                    return Err(Problem {
                        message: format!("{what} {}", problem.message),
                        ..problem
                    });
                }
                other => other?,
            };
            self.misread(wrong)?;
            self.texts.sources.enter(path)?;
            let found = self.element(&root, macros, scope)?;
            self.faulty |= found.faulty;
            self.texts.sources.leave();
            self.texts.sources.at = at;
            tree::import_namespaces(attributes, &found);
            out.extend(found.children);
        }
        Ok(())
    }

    fn property(&mut self, element: &Rc<Element>, scope: usize) -> Done<()> {
        let name = self.required(element, "name")?.to_owned();
        let mut name = self.texts.shown(&name, scope)?;
        let letters = |c: char| c.is_alphanumeric() || c == '_';
        if name.is_empty()
            || !name.chars().all(letters)
            || name.starts_with(|c: char| c.is_ascii_digit())
        {
            return Err(self.problem(format!("'{name}' cannot be the name of a property")));
        }
        let flag = |this: &mut Self, attribute: &str, default: bool| -> Done<bool> {
            let Some(word) = element.attribute(attribute) else {
                return Ok(default);
            };
            let value = this.texts.value(word, scope)?;
            this.truth(&value, word)
        };
        let mut value = element.attribute("value");
        if flag(self, "remove", false)? && self.texts.symbols.find(scope, &name).is_some() {
            self.texts.symbols.remove(scope, &name);
            return Ok(());
        }
        if let Some(default) = element.attribute("default") {
            if self.texts.symbols.find(scope, &name).is_some() {
                return Ok(());
            }
            value = Some(default);
        }
        let mut lazy = flag(self, "lazy_eval", true)?;
        let mut target = scope;
        match element.attribute("scope") {
            Some("global") => {
                target = self.texts.symbols.top(scope);
                lazy = false;
            }
            Some("parent") => {
                let Some(caller) = self.texts.symbols.caller(scope) else {
                    return Ok(());
                };
                target = caller;
                lazy = false;
            }
            _ => {}
        }
        let entry = match value {
            None => {
                name = format!("**{name}");
                Entry::Value(Value::Block(Rc::clone(element)))
            }
            Some(text) if lazy => Entry::lazy(text),
            Some(text) => self.entry(text, scope)?,
        };
        self.texts.symbols.set(target, &name, entry);
        if self.supposed {
            self.doubtful.push((target, name));
        }
        Ok(())
    }

    fn define(&mut self, element: &Rc<Element>, macros: usize) -> Done<()> {
        let name = self.required(element, "name")?;
        let name = name.strip_prefix("xacro:").unwrap_or(name).to_owned();
        let parameters = parameters(element.attribute("params").unwrap_or_default());
        let file = self.texts.sources.written();
        let found = Macro {
            body: Rc::clone(element),
            parameters,
            file,
        };
        self.macros.set(macros, name, Rc::new(found));
        Ok(())
    }

    pub(super) fn call(
        &mut self,
        name: &str,
        call: &Element,
        macros: usize,
        scope: usize,
        attributes: &mut Vec<(String, String)>,
        out: &mut Vec<Node>,
    ) -> Done<()> {
        self.step()?;
        let found = self
            .macros
            .resolve(name, (macros, scope), &self.texts.symbols);
        let Some((found, own_macros, own_scope)) = found else {
            let problem = self.no_macro(name);
            self.suppose_call(name, call, macros, scope);
            return Err(problem);
        };
        let inner = self.texts.symbols.below(own_scope, false);
        let inner_macros = self.macros.below(own_macros);
        // What stands in a call is expanded first, and may call this macro, too.
        self.depth += 1;
        if self.depth > DEEPEST {
            let problem = self.problem(format!("macro '{name}' calls itself without an end"));
            return Err(problem.that_ends());
        }
        self.bind((name, &found), call, (macros, scope), inner)?;
        let at = self.texts.sources.at;
        // Places of problems are those of the macro; paths count from where it is called.
        let around = self.texts.sources.body(Some(Rc::clone(&found.file)));
        let mut lifted = Vec::new();
        let body = self.children(&found.body.children, inner_macros, inner, &mut lifted)?;
        self.texts.sources.body(around);
        self.depth -= 1;
        self.texts.sources.at = at;
        let shell = Element {
            attributes: found.body.attributes.clone(),
            ..Element::default()
        };
        tree::import_namespaces(attributes, &shell);
        out.extend(body);
        Ok(())
    }
}
