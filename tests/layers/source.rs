//! Reads which file of a package uses which other one.
//!
//! In: the root file of a package. Out: its files and the arrows between them.
//!
//! An arrow goes from the file that names something to the file that defines it: a path that leads
//! through a `pub use` ends where the re-exported item stands. Test code is left out. Calls of
//! methods are not seen, because they name no path.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The files of a package and who uses whom.
#[derive(Default)]
pub struct Package {
    /// Every file of the package that is not test code, relative to the folder of its root file.
    pub files: Vec<String>,
    /// Pairs of indices of [`Self::files`]: the first uses the second.
    pub arrows: BTreeSet<(usize, usize)>,
    modules: Vec<Module>,
}

#[derive(Default)]
struct Module {
    file: usize,
    parent: usize,
    children: BTreeMap<String, usize>,
    /// Names that a `use` brings into the module, with the paths that they stand for.
    aliases: BTreeMap<String, Vec<String>>,
    /// Every path that the module's code names.
    paths: Vec<Vec<String>>,
}

/// Paths through more re-exports than this are given up.
const MOST_ALIASES: usize = 16;

impl Package {
    /// The package whose root file is `root`.
    ///
    /// # Panics
    /// Where a file cannot be read.
    pub fn read(root: &Path) -> Self {
        let mut package = Self::default();
        let folder = root.parent().expect("a folder").to_owned();
        let name = root.file_name().expect("a name").to_string_lossy();
        package.files.push(name.into_owned());
        package.modules.push(Module::default());
        package.read_module(&folder, root, &folder, 0);
        for module in 0..package.modules.len() {
            for path in &package.modules[module].paths {
                let target = package.file_of(module, path);
                let from = package.modules[module].file;
                if let Some(to) = target.filter(|&to| to != from) {
                    package.arrows.insert((from, to));
                }
            }
        }
        package
    }

    /// Reads a file; `children` is the folder in which the files of its modules lie.
    fn read_module(&mut self, folder: &Path, file: &Path, children: &Path, module: usize) {
        let text = std::fs::read_to_string(file)
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let tokens = without_tests(&tokens(&text));
        // Inline modules that are open, each with the depth of braces outside it.
        let mut open: Vec<(usize, usize)> = Vec::new();
        let (mut depth, mut module, mut at) = (0, module, 0);
        let mut files: Vec<(usize, PathBuf, PathBuf)> = Vec::new();
        while at < tokens.len() {
            match tokens[at].as_str() {
                "{" => depth += 1,
                "}" => {
                    assert!(depth > 0, "{}: braces do not match", file.display());
                    depth -= 1;
                    if let Some(&(outside, parent)) = open.last()
                        && outside == depth
                    {
                        open.pop();
                        module = parent;
                    }
                }
                "mod" if tokens.get(at + 2).is_some_and(|t| t == ";" || t == "{") => {
                    let name = tokens[at + 1].clone();
                    let child = self.modules.len();
                    self.modules.push(Module {
                        file: self.modules[module].file,
                        parent: module,
                        ..Module::default()
                    });
                    self.modules[module].children.insert(name.clone(), child);
                    if tokens[at + 2] == "{" {
                        open.push((depth, module));
                        depth += 1;
                        module = child;
                    } else {
                        let beside = children.join(format!("{name}.rs"));
                        let inside = children.join(&name).join("mod.rs");
                        let file = if beside.exists() { beside } else { inside };
                        files.push((child, file, children.join(&name)));
                    }
                    at += 2;
                }
                "use" if tokens.get(at + 1).is_some_and(|t| t != "<") => {
                    let end = at
                        + tokens[at..]
                            .iter()
                            .position(|t| t == ";")
                            .expect("a semicolon");
                    self.read_use(module, &tokens[at + 1..end]);
                    at = end;
                }
                word if is_name(word) => {
                    let start = at;
                    while tokens.get(at + 1).is_some_and(|t| t == "::")
                        && tokens.get(at + 2).is_some_and(|t| is_name(t))
                    {
                        at += 2;
                    }
                    let first = start == 0 || !["::", "."].contains(&tokens[start - 1].as_str());
                    if at > start && first {
                        let path = tokens[start..=at].iter().step_by(2).cloned().collect();
                        self.modules[module].paths.push(path);
                    }
                }
                _ => {}
            }
            at += 1;
        }
        for (child, path, children) in files {
            let name = path
                .strip_prefix(folder)
                .expect("a file below the root's folder");
            let name = name.to_string_lossy().replace('\\', "/");
            self.modules[child].file = self.files.len();
            self.files.push(name);
            self.read_module(folder, &path, &children, child);
        }
    }

    /// Notes the paths and the names of `a::{b, c as d}`.
    fn read_use(&mut self, module: usize, tokens: &[String]) {
        let mut before: Vec<Vec<String>> = vec![Vec::new()];
        let mut path: Vec<String> = Vec::new();
        let mut alias: Option<String> = None;
        let mut at = 0;
        while at <= tokens.len() {
            match tokens.get(at).map(String::as_str) {
                Some("::" | "*") => {}
                Some("{") => before.push(std::mem::take(&mut path)),
                Some("as") => {
                    alias = tokens.get(at + 1).cloned();
                    at += 1;
                }
                Some(word) if is_name(word) => path.push(word.to_owned()),
                end => {
                    if !path.is_empty() {
                        let mut whole: Vec<String> = before.concat();
                        whole.append(&mut path);
                        if whole.len() > 1 && whole.last().is_some_and(|last| last == "self") {
                            whole.pop();
                        }
                        let name = alias.take().or_else(|| whole.last().cloned());
                        let module = &mut self.modules[module];
                        module.aliases.insert(name.expect("a name"), whole.clone());
                        module.paths.push(whole);
                    }
                    if end == Some("}") {
                        before.pop();
                    }
                }
            }
            at += 1;
        }
    }

    /// The file in which what a path names is defined; none for other packages and for local names.
    fn file_of(&self, module: usize, path: &[String]) -> Option<usize> {
        let (module, _) = self.walk(module, path, 0)?;
        Some(self.modules[module].file)
    }

    /// The innermost module that a path leads to, and how many of its segments lie below that.
    fn walk(&self, start: usize, path: &[String], aliases: usize) -> Option<(usize, usize)> {
        if aliases > MOST_ALIASES {
            return None;
        }
        let mut module = start;
        for (at, segment) in path.iter().enumerate() {
            let here = &self.modules[module];
            match segment.as_str() {
                "crate" if at == 0 => module = 0,
                "self" if at == 0 => {}
                "super" => module = here.parent,
                name => {
                    if let Some(&child) = here.children.get(name) {
                        module = child;
                    } else if let Some(alias) = here.aliases.get(name)
                        && (at > 0 || alias[0] != name)
                    {
                        let (found, below) = self.walk(module, alias, aliases + 1)?;
                        if below > 0 {
                            return Some((found, below + path.len() - at - 1));
                        }
                        module = found;
                    } else if at == 0 {
                        return None;
                    } else {
                        return Some((module, path.len() - at));
                    }
                }
            }
        }
        Some((module, 0))
    }
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Names, `::` and single signs; comments and literals are left out.
fn tokens(text: &str) -> Vec<String> {
    let characters: Vec<char> = text.chars().collect();
    let next = |at: usize| characters.get(at).copied().unwrap_or('\0');
    let mut list = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        let c = characters[at];
        let mut raw = at + usize::from(c == 'b');
        if next(raw) == 'r' && ['"', '#'].contains(&next(raw + 1)) {
            raw += 1;
            let hashes = (raw..characters.len())
                .take_while(|&i| next(i) == '#')
                .count();
            if next(raw + hashes) == '"' {
                let end: Vec<char> = format!("\"{}", "#".repeat(hashes)).chars().collect();
                at = raw + hashes + 1;
                while at < characters.len() && !characters[at..].starts_with(&end) {
                    at += 1;
                }
                at += end.len();
                continue;
            }
        }
        if c == '/' && next(at + 1) == '/' {
            while at < characters.len() && characters[at] != '\n' {
                at += 1;
            }
        } else if c == '"' || (c == '\'' && (next(at + 1) == '\\' || next(at + 2) == '\'')) {
            at += 1;
            while at < characters.len() && characters[at] != c {
                at += 1 + usize::from(characters[at] == '\\');
            }
            at += 1;
        } else if c.is_alphanumeric() || c == '_' {
            let start = at;
            while next(at).is_alphanumeric() || next(at) == '_' {
                at += 1;
            }
            list.push(characters[start..at].iter().collect());
        } else if c == ':' && next(at + 1) == ':' {
            list.push("::".to_owned());
            at += 2;
        } else {
            if !c.is_whitespace() {
                list.push(c.to_string());
            }
            at += 1;
        }
    }
    list
}

/// Leaves out what `#[cfg(test)]` and `#[cfg(all(test, …))]` stand before.
fn without_tests(tokens: &[String]) -> Vec<String> {
    let mut list = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let starts = |words: &[&str]| {
            tokens[at..].len() >= words.len() && tokens[at..].iter().zip(words).all(|(t, w)| t == w)
        };
        if starts(&["#", "[", "cfg", "(", "test", ")"])
            || starts(&["#", "[", "cfg", "(", "all", "(", "test"])
        {
            // The attribute itself, other attributes, and the item up to its semicolon or closing
            // brace.
            let mut depth = 0;
            while at < tokens.len() {
                let token = tokens[at].as_str();
                at += 1;
                match token {
                    "{" | "(" | "[" => depth += 1,
                    "}" | ")" | "]" => depth -= 1,
                    _ => {}
                }
                if depth < 0 {
                    // A field or a variant was the last of its list.
                    at -= 1;
                    break;
                }
                if depth == 0 && (token == ";" || token == "}") {
                    break;
                }
            }
        } else {
            list.push(tokens[at].clone());
            at += 1;
        }
    }
    list
}
