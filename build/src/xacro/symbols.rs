//! Properties in their scopes. A property's text is evaluated when it is used first, in the scope
//! where it stands.

use super::value::Value;
use std::collections::BTreeMap;

/// All scopes; 0 is the file's own.
#[derive(Debug)]
pub struct Symbols {
    tables: Vec<Table>,
}

#[derive(Debug, Default)]
struct Table {
    parent: Option<usize>,
    /// Of a file that was included under a name, not of a macro.
    named: bool,
    entries: BTreeMap<String, Entry>,
}

/// A property.
#[derive(Clone, Debug)]
pub enum Entry {
    /// Known.
    Value(Value),
    /// A text that is still to be evaluated.
    Text(String),
    /// A text that is being evaluated.
    Open,
    /// What it is cannot be known, and why was told.
    Failed,
}

impl Entry {
    /// A property that is evaluated when it is used, unless it is a number.
    pub fn lazy(text: &str) -> Self {
        match Value::text(text).of_literal() {
            Value::Str(text) => Self::Text(text.to_string()),
            value => Self::Value(value),
        }
    }
}

impl Symbols {
    pub fn new() -> Self {
        Self {
            tables: vec![Table::default()],
        }
    }

    /// A scope below another one.
    pub fn below(&mut self, parent: usize, named: bool) -> usize {
        self.tables.push(Table {
            parent: Some(parent),
            named,
            entries: BTreeMap::new(),
        });
        self.tables.len() - 1
    }

    /// The scope where a name is found, from `scope` upwards, and what it is there.
    pub fn find(&self, scope: usize, name: &str) -> Option<(usize, &Entry)> {
        let mut next = Some(scope);
        while let Some(scope) = next {
            let table = &self.tables[scope];
            if let Some(entry) = table.entries.get(name) {
                return Some((scope, entry));
            }
            next = table.parent;
        }
        None
    }

    /// All names that are found from a scope upwards.
    pub fn names(&self, scope: usize) -> impl Iterator<Item = &str> {
        let scopes = std::iter::successors(Some(scope), |scope| self.tables[*scope].parent);
        scopes.flat_map(|scope| self.tables[scope].entries.keys().map(String::as_str))
    }

    pub fn set(&mut self, scope: usize, name: &str, entry: Entry) {
        self.tables[scope].entries.insert(name.to_owned(), entry);
    }

    /// What the file's own scope has under a name.
    pub fn own(&self, name: &str) -> Option<&Entry> {
        self.tables[0].entries.get(name)
    }

    /// How many scopes there are.
    pub fn scopes(&self) -> usize {
        self.tables.len()
    }

    /// Removes a name from a scope and all above it.
    pub fn remove(&mut self, scope: usize, name: &str) {
        let mut next = Some(scope);
        while let Some(scope) = next {
            let table = &mut self.tables[scope];
            table.entries.remove(name);
            next = table.parent;
        }
    }

    /// Properties of files that nothing has needed so far: their scopes, names and texts.
    pub fn unread(&self) -> Vec<(usize, String, String)> {
        let mut found = Vec::new();
        for (scope, table) in self.tables.iter().enumerate() {
            if table.parent.is_some() && !table.named {
                continue;
            }
            for (name, entry) in &table.entries {
                if let Entry::Text(text) = entry {
                    found.push((scope, name.clone(), text.clone()));
                }
            }
        }
        found
    }

    /// The uppermost scope.
    pub fn top(&self, scope: usize) -> usize {
        let mut top = scope;
        while let Some(parent) = self.tables[top].parent {
            top = parent;
        }
        top
    }

    /// The scope of whoever called a macro; that above a file's own is where it was included.
    pub fn caller(&self, scope: usize) -> Option<usize> {
        let mut parent = self.tables[scope].parent?;
        if !self.tables[scope].named {
            while let (true, Some(above)) = (self.tables[parent].named, self.tables[parent].parent)
            {
                parent = above;
            }
        }
        Some(parent)
    }
}
