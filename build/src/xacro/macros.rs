//! Macros in their scopes.

use super::parameter::Parameter;
use super::symbols::{Entry, Symbols};
use super::tree::Element;
use super::value::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

/// A macro.
#[derive(Debug)]
pub struct Macro {
    pub body: Rc<Element>,
    pub parameters: Vec<Parameter>,
    /// Where it stands.
    pub file: Rc<Path>,
}

/// All scopes; 0 is the file's own.
#[derive(Debug)]
pub struct Macros {
    tables: Vec<Table>,
}

#[derive(Debug, Default)]
struct Table {
    parent: Option<usize>,
    macros: BTreeMap<String, Rc<Macro>>,
    /// Tables of files that were included under a name.
    named: BTreeMap<String, usize>,
}

impl Macros {
    pub fn new() -> Self {
        Self {
            tables: vec![Table::default()],
        }
    }

    /// The file's own macro of a name.
    pub fn own(&self, name: &str) -> Option<Rc<Macro>> {
        self.tables[0].macros.get(name).map(Rc::clone)
    }

    /// Names of the file's own macros.
    pub fn names(&self) -> Vec<String> {
        self.tables[0].macros.keys().cloned().collect()
    }

    /// Names of all macros of any scope.
    pub fn all_names(&self) -> impl Iterator<Item = &str> {
        let tables = self.tables.iter();
        tables.flat_map(|table| table.macros.keys().map(String::as_str))
    }

    /// A scope below another one.
    pub fn below(&mut self, parent: usize) -> usize {
        self.tables.push(Table {
            parent: Some(parent),
            ..Table::default()
        });
        self.tables.len() - 1
    }

    /// A scope below another one, that of a file which is included under a name.
    pub fn named_below(&mut self, parent: usize, name: String) -> usize {
        let own = self.below(parent);
        self.tables[parent].named.insert(name, own);
        own
    }

    pub fn set(&mut self, scope: usize, name: String, found: Rc<Macro>) {
        self.tables[scope].macros.insert(name, found);
    }

    /// What a table has, or one of those above it.
    fn search<T>(&self, scope: usize, of: impl Fn(&Table) -> Option<T>) -> Option<T> {
        let mut next = Some(scope);
        while let Some(scope) = next {
            let table = &self.tables[scope];
            if let Some(found) = of(table) {
                return Some(found);
            }
            next = table.parent;
        }
        None
    }

    fn find(&self, scope: usize, name: &str) -> Option<Rc<Macro>> {
        self.search(scope, |table| table.macros.get(name).map(Rc::clone))
    }

    /// The macro of a name, and the scopes of macros and of properties in which it is expanded.
    ///
    /// - `name`: may begin with names of included files, `file.macro`
    pub fn resolve(
        &self,
        name: &str,
        (mut macros, mut scope): (usize, usize),
        symbols: &Symbols,
    ) -> Option<(Rc<Macro>, usize, usize)> {
        if let Some(found) = self.find(macros, name) {
            return Some((found, macros, scope));
        }
        let (files, last) = name.rsplit_once('.')?;
        for file in files.split('.') {
            macros = self.search(macros, |table| table.named.get(file).copied())?;
            let (_, Entry::Value(Value::Scope(inner))) = symbols.find(scope, file)? else {
                return None;
            };
            scope = *inner;
        }
        Some((self.find(macros, last)?, macros, scope))
    }
}
