//! A document in xacro → the document that it stands for.
//!
//! What is done, and in which order, follows the xacro program of ROS (2.1), which works on the
//! document in place: what a node stands for takes its place, and is not expanded again.
//!
//! Over 500 lines because it is one pass over one document, whose steps share its state.

use super::evaluate::Evaluation;
use super::files::matching;
use super::functions::Names;
use super::parameter::{Parameter, parameters};
use super::parse;
use super::symbols::{Entry, Symbols};
use super::tree::{self, Element, Node};
use super::value::Value;
use super::yaml;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Macros and files within each other.
const DEEPEST: usize = 100;

/// Elements that a document may grow to.
const MOST_ELEMENTS: usize = 1_000_000;

/// Files larger than this, in bytes, are not read.
const LARGEST_FILE: u64 = 64 << 20;

/// What stopped the expansion.
#[derive(Debug)]
pub struct Problem {
    pub message: String,
    /// Of the element.
    pub file: PathBuf,
    pub at: usize,
    /// An argument without a value.
    pub argument: bool,
    /// A file that is not there.
    pub absent: bool,
}

/// A macro.
#[derive(Debug)]
struct Macro {
    body: Rc<Element>,
    parameters: Vec<Parameter>,
    file: PathBuf,
}

/// Where packages are.
pub type Find<'f> = dyn Fn(&str) -> Option<PathBuf> + 'f;

/// The table above, macros by name, tables of included files by the files' names.
type Macros = (
    Option<usize>,
    BTreeMap<String, Rc<Macro>>,
    BTreeMap<String, usize>,
);

/// The state of an expansion.
pub struct Expansion<'f> {
    pub arguments: BTreeMap<String, String>,
    find: &'f Find<'f>,
    symbols: Symbols,
    macros: Vec<Macros>,
    files: Vec<PathBuf>,
    /// Every file read, with its text.
    pub read: BTreeMap<PathBuf, String>,
    /// Packages that were found.
    pub packages: RefCell<BTreeMap<String, PathBuf>>,
    elements: usize,
    depth: usize,
    at: usize,
}

type Done<T> = Result<T, Problem>;

impl<'f> Expansion<'f> {
    pub fn new(arguments: BTreeMap<String, String>, find: &'f Find<'f>) -> Self {
        Self {
            arguments,
            find,
            symbols: Symbols::new(),
            macros: vec![(None, BTreeMap::new(), BTreeMap::new())],
            files: Vec::new(),
            read: BTreeMap::new(),
            packages: RefCell::default(),
            elements: 0,
            depth: 0,
            at: 0,
        }
    }

    /// The expanded document.
    pub fn document(&mut self, path: &Path) -> Done<Element> {
        let root = self.open(path)?;
        self.files.push(path.to_owned());
        self.element(&root, 0, 0)
    }

    /// Whether anything but macros was defined.
    pub fn macro_names(&self) -> Vec<String> {
        self.macros[0].1.keys().cloned().collect()
    }

    fn problem(&self, message: impl Into<String>) -> Problem {
        Problem {
            message: message.into(),
            file: self.files.last().cloned().unwrap_or_default(),
            at: self.at,
            argument: false,
            absent: false,
        }
    }

    fn text_of(&mut self, path: &Path) -> Done<String> {
        if let Some(known) = self.read.get(path) {
            return Ok(known.clone());
        }
        let read = || {
            use std::io::Read as _;
            let file = std::fs::File::open(path)?;
            let mut bytes = Vec::new();
            file.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
            Ok::<_, std::io::Error>(bytes)
        };
        let bytes = read().map_err(|error| Problem {
            absent: true,
            ..self.problem(format!("{} cannot be read: {error}", path.display()))
        })?;
        if bytes.len() as u64 > LARGEST_FILE {
            return Err(self.problem(format!("{} is too large", path.display())));
        }
        let text = String::from_utf8(bytes)
            .map_err(|_| self.problem(format!("{} is not UTF-8", path.display())))?;
        let text = text
            .strip_prefix('\u{feff}')
            .map_or(text.clone(), str::to_owned);
        self.read.insert(path.to_owned(), text.clone());
        Ok(text)
    }

    fn open(&mut self, path: &Path) -> Done<Element> {
        let text = self.text_of(path)?;
        tree::parse(&text).map_err(|(message, at)| Problem {
            file: path.to_owned(),
            at,
            ..self.problem(message)
        })
    }

    /// An element with all that is in it, expanded.
    fn element(&mut self, element: &Element, macros: usize, scope: usize) -> Done<Element> {
        self.at = element.at;
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(self.problem(format!("more than {MOST_ELEMENTS} elements")));
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.problem("macros, files or elements are nested too deeply"));
        }
        let mut attributes = Vec::with_capacity(element.attributes.len());
        for (name, value) in &element.attributes {
            if !name.starts_with("xacro:") && name != "xmlns:xacro" {
                let value = self.text(value, scope)?.shown();
                attributes.push((name.clone(), value));
            }
        }
        let children = self.children(&element.children, macros, scope, &mut attributes)?;
        self.depth -= 1;
        Ok(Element {
            name: element.name.clone(),
            attributes,
            children,
            at: element.at,
        })
    }

    fn children(
        &mut self,
        children: &[Node],
        macros: usize,
        scope: usize,
        attributes: &mut Vec<(String, String)>,
    ) -> Done<Vec<Node>> {
        let mut out = Vec::new();
        for child in children {
            match child {
                Node::Text(text) => out.push(Node::Text(self.text(text, scope)?.shown())),
                Node::Element(child) => {
                    self.at = child.at;
                    self.child(child, macros, scope, attributes, &mut out)?;
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
                let many = self.entry(scope, &format!("**{name}"))?;
                let (block, whole) = match many {
                    Some(Value::Block(block)) => (block, false),
                    _ => match self.entry(scope, &format!("*{name}"))? {
                        Some(Value::Block(block)) => (block, true),
                        _ => return Err(self.problem(format!("there is no block '{name}'"))),
                    },
                };
                if whole && block.name.starts_with("xacro:") {
                    // A block that is itself a call was expanded where it was given.
                    return self.child(&block, macros, scope, attributes, out);
                }
                let found = self.element(&block, macros, scope)?;
                if whole {
                    out.push(Node::Element(Rc::new(found)));
                } else {
                    out.extend(found.children);
                }
            }
            "include" => self.include(child, macros, scope, attributes, out)?,
            "property" => self.property(child, scope)?,
            "macro" => self.define(child, macros)?,
            "arg" => {
                let name = self.required(child, "name")?.to_owned();
                let default = self.required(child, "default")?.to_owned();
                if !self.arguments.contains_key(&name) {
                    let value = self.text(&default, scope)?.shown();
                    self.arguments.insert(name, value);
                }
            }
            "element" => {
                let name = self.required(child, "xacro:name")?.to_owned();
                let name = self.text(&name, scope)?.shown();
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
                let (name, value) = (self.text(&name, scope)?, self.text(&value, scope)?);
                tree::set(attributes, &name.shown(), value.shown());
            }
            "if" | "unless" => {
                let condition = self.required(child, "value")?.to_owned();
                let value = self.text(&condition, scope)?;
                if self.truth(&value, &condition)? == (name == "if") {
                    out.extend(self.element(child, macros, scope)?.children);
                }
            }
            "call" => {
                let name = self.required(child, "macro")?.to_owned();
                let name = self.text(&name, scope)?.shown();
                let mut call = child.as_ref().clone();
                call.attributes.retain(|(own, _)| own != "macro");
                self.call(&name, &call, macros, scope, attributes, out)?;
            }
            name => self.call(name, child, macros, scope, attributes, out)?,
        }
        Ok(())
    }

    fn required<'e>(&self, element: &'e Element, name: &str) -> Done<&'e str> {
        let found = element.attribute(name);
        found.ok_or_else(|| self.problem(format!("<{}> has no attribute '{name}'", element.name)))
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
            let name = self.text(name, scope)?.shown();
            let inner = self.symbols.below(scope, true);
            self.symbols
                .set(scope, &name, Entry::Value(Value::Scope(inner)));
            self.macros
                .push((Some(macros), BTreeMap::new(), BTreeMap::new()));
            let own = self.macros.len() - 1;
            self.macros[macros].2.insert(name, own);
            (macros, scope) = (own, inner);
        }
        let spec = self.text(&file, outer)?.shown();
        let path = self.beside(&spec);
        let files = if spec.contains(['*', '[', '?']) {
            matching(&path)
        } else {
            vec![path]
        };
        for path in files {
            let at = self.at;
            let root = match self.open(&path) {
                Err(problem) if problem.absent && optional => continue,
                Err(problem) if problem.absent => {
                    return Err(Problem {
                        message: format!("the included file {}", problem.message),
                        ..problem
                    });
                }
                other => other?,
            };
            self.files.push(path);
            if self.files.len() > DEEPEST {
                return Err(self.problem("files include each other in a circle"));
            }
            let found = self.element(&root, macros, scope)?;
            self.files.pop();
            self.at = at;
            import_namespaces(attributes, &found);
            out.extend(found.children);
        }
        Ok(())
    }

    /// A path that counts from the folder of the file that is read.
    fn beside(&self, name: &str) -> PathBuf {
        let folder = self.files.last().and_then(|file| file.parent());
        folder.map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
    }

    fn property(&mut self, element: &Rc<Element>, scope: usize) -> Done<()> {
        let name = self.required(element, "name")?.to_owned();
        let mut name = self.text(&name, scope)?.shown();
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
            let value = this.text(word, scope)?;
            this.truth(&value, word)
        };
        let mut value = element.attribute("value");
        if flag(self, "remove", false)? && self.symbols.find(scope, &name).is_some() {
            self.symbols.remove(scope, &name);
            return Ok(());
        }
        if let Some(default) = element.attribute("default") {
            if self.symbols.find(scope, &name).is_some() {
                return Ok(());
            }
            value = Some(default);
        }
        let mut lazy = flag(self, "lazy_eval", true)?;
        let mut target = scope;
        match element.attribute("scope") {
            Some("global") => {
                target = self.symbols.top(scope);
                lazy = false;
            }
            Some("parent") => {
                let Some(caller) = self.symbols.caller(scope) else {
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
            Some(text) if lazy => lazily(text),
            Some(text) => Entry::Value(self.text(text, scope)?.of_literal()),
        };
        self.symbols.set(target, &name, entry);
        Ok(())
    }

    fn define(&mut self, element: &Rc<Element>, macros: usize) -> Done<()> {
        let name = self.required(element, "name")?;
        let name = name.strip_prefix("xacro:").unwrap_or(name).to_owned();
        let parameters = parameters(element.attribute("params").unwrap_or_default());
        let file = self.files.last().cloned().unwrap_or_default();
        let found = Macro {
            body: Rc::clone(element),
            parameters,
            file,
        };
        self.macros[macros].1.insert(name, Rc::new(found));
        Ok(())
    }

    /// The macro of a name, and the scopes in which it is expanded.
    fn resolve(
        &self,
        name: &str,
        macros: usize,
        scope: usize,
    ) -> Option<(Rc<Macro>, usize, usize)> {
        let own = |macros: usize, name: &str| {
            let mut next = Some(macros);
            while let Some(table) = next {
                if let Some(found) = self.macros[table].1.get(name) {
                    return Some(Rc::clone(found));
                }
                next = self.macros[table].0;
            }
            None
        };
        if let Some(found) = own(macros, name) {
            return Some((found, macros, scope));
        }
        let (spaces, last) = name.rsplit_once('.')?;
        let (mut macros, mut scope) = (macros, scope);
        for space in spaces.split('.') {
            let mut next = Some(macros);
            macros = loop {
                let table = next?;
                if let Some(found) = self.macros[table].2.get(space) {
                    break *found;
                }
                next = self.macros[table].0;
            };
            let Some((_, Entry::Value(Value::Scope(inner)))) = self.symbols.find(scope, space)
            else {
                return None;
            };
            scope = *inner;
        }
        Some((own(macros, last)?, macros, scope))
    }

    fn call(
        &mut self,
        name: &str,
        call: &Element,
        macros: usize,
        scope: usize,
        attributes: &mut Vec<(String, String)>,
        out: &mut Vec<Node>,
    ) -> Done<()> {
        let Some((found, own_macros, own_scope)) = self.resolve(name, macros, scope) else {
            return Err(self.problem(format!("there is no macro '{name}'")));
        };
        let inner = self.symbols.below(own_scope, false);
        self.macros
            .push((Some(own_macros), BTreeMap::new(), BTreeMap::new()));
        let inner_macros = self.macros.len() - 1;
        let mut given: Vec<&str> = Vec::new();
        for (key, text) in &call.attributes {
            if key == "xmlns:xacro" {
                continue;
            }
            if !found
                .parameters
                .iter()
                .any(|parameter| parameter.name == *key)
            {
                return Err(self.problem(format!("macro '{name}' has no parameter '{key}'")));
            }
            let value = self.text(text, scope)?.of_literal();
            self.symbols.set(inner, key, Entry::Value(value));
            given.push(key);
        }
        let mut ignored = Vec::new();
        let inside = self.children(&call.children, macros, scope, &mut ignored)?;
        let mut blocks = inside.iter().filter_map(|node| match node {
            Node::Element(element) => Some(Rc::clone(element)),
            Node::Text(_) => None,
        });
        for parameter in &found.parameters {
            let key = &parameter.name;
            if key.starts_with('*') {
                let Some(block) = blocks.next() else {
                    return Err(self.problem(format!("macro '{name}' needs a block for '{key}'")));
                };
                self.symbols
                    .set(inner, key, Entry::Value(Value::Block(block)));
            }
        }
        if let Some(block) = blocks.next() {
            let message = format!("macro '{name}' has no use for the block <{}>", block.name);
            return Err(self.problem(message));
        }
        let mut lacking = Vec::new();
        for parameter in &found.parameters {
            let key = &parameter.name;
            if key.starts_with('*') || given.contains(&key.as_str()) {
                continue;
            }
            let forwarded = if parameter.forward {
                self.entry(scope, key)?
            } else {
                None
            };
            let value = match (forwarded, &parameter.default) {
                (Some(value), _) => value,
                (None, Some(default)) => self.text(&default.clone(), scope)?,
                (None, None) => {
                    lacking.push(format!("'{key}'"));
                    continue;
                }
            };
            self.symbols
                .set(inner, key, Entry::Value(value.of_literal()));
        }
        if !lacking.is_empty() {
            return Err(self.problem(format!("macro '{name}' needs {}", lacking.join(", "))));
        }
        let at = self.at;
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.problem(format!("macro '{name}' calls itself without an end")));
        }
        // Places of problems are those of the macro; paths count from where it is called.
        let file = self.files.last().cloned().unwrap_or_default();
        let mut lifted = Vec::new();
        let body = self.children(&found.body.children, inner_macros, inner, &mut lifted);
        let body = body.map_err(|problem| {
            if problem.file == file {
                Problem {
                    file: found.file.clone(),
                    ..problem
                }
            } else {
                problem
            }
        })?;
        self.depth -= 1;
        self.at = at;
        let shell = Element {
            attributes: found.body.attributes.clone(),
            ..Element::default()
        };
        import_namespaces(attributes, &shell);
        out.extend(body);
        Ok(())
    }

    /// The value of a name, evaluated where it must be.
    fn entry(&mut self, scope: usize, name: &str) -> Done<Option<Value>> {
        let Some((owner, entry)) = self.symbols.find(scope, name) else {
            return Ok(None);
        };
        match entry.clone() {
            Entry::Value(value) => Ok(Some(value)),
            Entry::Open => Err(self.problem(format!("the property '{name}' needs itself"))),
            Entry::Text(text) => {
                self.symbols.set(owner, name, Entry::Open);
                let value = self.text(&text, owner)?.of_literal();
                self.symbols.set(owner, name, Entry::Value(value.clone()));
                Ok(Some(value))
            }
        }
    }

    /// A text with its expressions evaluated: their own value where there is nothing else.
    fn text(&mut self, text: &str, scope: usize) -> Done<Value> {
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
                    .ok_or_else(|| self.problem(format!("'}}' is missing in '{text}'")))?;
                parts.push(self.expression(inner, scope)?);
                rest = after;
            } else if let Some(inner) = rest.strip_prefix("$(") {
                let (inner, after) = inner
                    .split_once(')')
                    .ok_or_else(|| self.problem(format!("')' is missing in '{text}'")))?;
                let inner = self.text(inner, scope)?.shown();
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
        Ok(Value::text(
            parts.iter().map(Value::shown).collect::<String>(),
        ))
    }

    fn expression(&mut self, text: &str, scope: usize) -> Done<Value> {
        let text = self.text(text, scope)?.shown();
        let parsed = parse::expression(&text);
        let mut failed = None;
        let value = parsed.and_then(|parsed| {
            let mut names = Scoped {
                expansion: &mut *self,
                scope,
                failed: &mut failed,
            };
            Evaluation::new(&mut names).value(&parsed)
        });
        if let Some(problem) = failed {
            return Err(problem);
        }
        value.map_err(|error| self.problem(format!("{error}, in ${{{text}}}")))
    }

    /// What stands in `$(…)`.
    fn substitution(&mut self, text: &str, scope: usize) -> Done<String> {
        if let Some(expression) = text.strip_prefix("eval ") {
            return Ok(self.eval(expression, scope)?.shown());
        }
        let words: Vec<&str> = text.split(' ').filter(|word| !word.is_empty()).collect();
        match words[..] {
            ["arg", name] => {
                let known = self.arguments.get(name).cloned();
                known.ok_or_else(|| Problem {
                    argument: true,
                    ..self.problem(format!("the argument '{name}' has no value"))
                })
            }
            ["find", package] => self.package(package),
            ["env", name] => std::env::var(name)
                .map_err(|_| self.problem(format!("the environment variable {name} is not set"))),
            ["optenv", name, ref default @ ..] => {
                Ok(std::env::var(name).unwrap_or_else(|_| default.join(" ")))
            }
            ["dirname"] => {
                let folder = self.beside("");
                let folder = std::path::absolute(&folder).unwrap_or(folder);
                Ok(folder
                    .display()
                    .to_string()
                    .trim_end_matches('/')
                    .to_owned())
            }
            ["cwd"] => Ok(std::env::current_dir()
                .unwrap_or_default()
                .display()
                .to_string()),
            _ => Err(self.problem(format!(
                "$({text}) is not known: there are find, arg, env, optenv, eval, dirname, cwd"
            ))),
        }
    }

    fn package(&mut self, name: &str) -> Done<String> {
        let Some(folder) = (self.find)(name) else {
            return Err(Problem {
                ..self.problem(format!("the package '{name}' is not found"))
            });
        };
        let folder = std::path::absolute(&folder).unwrap_or(folder);
        self.packages
            .borrow_mut()
            .insert(name.to_owned(), folder.clone());
        Ok(folder.display().to_string())
    }

    /// `$(eval …)`, where names are arguments.
    fn eval(&mut self, text: &str, scope: usize) -> Done<Value> {
        let parsed = parse::expression(text);
        let mut failed = None;
        let value = parsed.and_then(|parsed| {
            let mut names = OfArguments(Scoped {
                expansion: &mut *self,
                scope,
                failed: &mut failed,
            });
            Evaluation::new(&mut names).value(&parsed)
        });
        if let Some(problem) = failed {
            return Err(problem);
        }
        value.map_err(|error| self.problem(format!("{error}, in $(eval {text})")))
    }
}

/// A property that is evaluated when it is used, unless it is a number.
fn lazily(text: &str) -> Entry {
    match Value::text(text).of_literal() {
        Value::Str(text) => Entry::Text(text.to_string()),
        value => Entry::Value(value),
    }
}

/// Declarations of prefixes go to the element around.
fn import_namespaces(attributes: &mut Vec<(String, String)>, from: &Element) {
    for (name, value) in &from.attributes {
        if name.starts_with("xmlns:")
            && name != "xmlns:xacro"
            && !attributes.iter().any(|(own, _)| own == name)
        {
            attributes.push((name.clone(), value.clone()));
        }
    }
}

/// Names in a scope.
struct Scoped<'a, 'f> {
    expansion: &'a mut Expansion<'f>,
    scope: usize,
    failed: &'a mut Option<Problem>,
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
        let found = self.expansion.entry(self.scope, name);
        self.told(found)
    }

    fn in_scope(&mut self, scope: usize, name: &str) -> Result<Option<Value>, String> {
        let found = self.expansion.entry(scope, name);
        self.told(found)
    }

    fn yaml(&mut self, name: &str) -> Result<Value, String> {
        let path = self.expansion.beside(name);
        let text = self.expansion.text_of(&path);
        let text = self.told(text)?;
        let mut evaluate = |text: &str| {
            let parsed = parse::expression(text).ok()?;
            let mut names = Nothing;
            Evaluation::new(&mut names).value(&parsed).ok()?.number()
        };
        yaml::read(&text, &mut evaluate).map_err(|error| format!("{}: {error}", path.display()))
    }

    fn path(&mut self, name: &str) -> String {
        self.expansion.beside(name).display().to_string()
    }

    fn argument(&mut self, name: &str) -> Option<String> {
        self.expansion.arguments.get(name).cloned()
    }
}

/// No names but Python's own.
struct Nothing;

impl Names for Nothing {
    fn name(&mut self, _: &str) -> Result<Option<Value>, String> {
        Ok(None)
    }
    fn in_scope(&mut self, _: usize, _: &str) -> Result<Option<Value>, String> {
        Ok(None)
    }
    fn yaml(&mut self, _: &str) -> Result<Value, String> {
        Err("files cannot be read here".to_owned())
    }
    fn path(&mut self, name: &str) -> String {
        name.to_owned()
    }
    fn argument(&mut self, _: &str) -> Option<String> {
        None
    }
}

/// Names are arguments, as in `$(eval …)`.
struct OfArguments<'a, 'f>(Scoped<'a, 'f>);

impl Names for OfArguments<'_, '_> {
    fn name(&mut self, name: &str) -> Result<Option<Value>, String> {
        let word = |text: String| match text.to_lowercase().as_str() {
            "true" => Value::Bool(true),
            "false" => Value::Bool(false),
            _ => super::value::number_of(&text).unwrap_or_else(|| Value::text(text)),
        };
        Ok(match name {
            "true" => Some(Value::Bool(true)),
            "false" => Some(Value::Bool(false)),
            "arg" => Some(Value::Function("arg")),
            _ => self.0.argument(name).map(word),
        })
    }
    fn in_scope(&mut self, scope: usize, name: &str) -> Result<Option<Value>, String> {
        self.0.in_scope(scope, name)
    }
    fn yaml(&mut self, name: &str) -> Result<Value, String> {
        self.0.yaml(name)
    }
    fn path(&mut self, name: &str) -> String {
        self.0.path(name)
    }
    fn argument(&mut self, name: &str) -> Option<String> {
        self.0.argument(name)
    }
}
