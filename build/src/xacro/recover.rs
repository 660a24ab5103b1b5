//! What becomes of an expansion after something that cannot be expanded.

use super::expand::Expansion;
use super::problem::{Done, Lacking, Problem, Weight};
use super::symbols::Entry;
use super::tree::Element;
use urdf2fmu_core::diagnostic::nearest;

/// Problems that are told of one document.
const MOST_PROBLEMS: usize = 100;

/// What follows `xacro:` in the tags of xacro itself.
const TAGS: [&str; 10] = [
    "arg",
    "attribute",
    "call",
    "element",
    "if",
    "include",
    "insert_block",
    "macro",
    "property",
    "unless",
];

/// Attributes by which elements refer to each other.
const NAMES: [&str; 4] = ["name", "link", "joint", "type"];

impl Expansion<'_> {
    /// Tells a problem, unless it follows from another one or is the same again.
    pub(super) fn tell(&mut self, problem: Problem) {
        let own = matches!(problem.weight, Weight::Own | Weight::Ends);
        let may = self.supposed && problem.weight == Weight::Own || problem.weight == Weight::May;
        let known = |list: &[Problem]| list.iter().any(|known| known.is_as(&problem));
        if own && !self.supposed && !known(&self.problems) {
            // Looking into what is left out comes before telling why it is.
            self.maybe.retain(|known| !known.is_as(&problem));
            self.problems.push(problem);
        } else if may
            && self.maybe.len() < MOST_PROBLEMS
            && !known(&self.problems)
            && !known(&self.maybe)
        {
            self.maybe.push(problem);
        }
    }

    /// The result of a part of the expansion; none after a problem, which is told.
    ///
    /// # Errors
    /// What ends the expansion.
    pub(super) fn attempt<T>(
        &mut self,
        part: impl FnOnce(&mut Self) -> Done<T>,
    ) -> Done<Option<T>> {
        let (depth, faulty) = (self.depth, self.faulty);
        let place = self.texts.sources.place();
        match part(self) {
            Ok(found) => Ok(Some(found)),
            Err(problem) => {
                self.pass(problem)?;
                (self.depth, self.faulty) = (depth, faulty);
                self.texts.sources.go_back(place);
                Ok(None)
            }
        }
    }

    /// Tells a problem, and that the expansion goes on.
    ///
    /// # Errors
    /// If it must not.
    pub(super) fn pass(&mut self, problem: Problem) -> Done<()> {
        if matches!(problem.weight, Weight::Ends | Weight::Enough) {
            return Err(problem);
        }
        self.tell(problem);
        if self.problems.len() < MOST_PROBLEMS {
            return Ok(());
        }
        let weight = Weight::Enough;
        Err(Problem {
            weight,
            ..self.texts.sources.follows()
        })
    }

    /// Tells what is no XML in a file. Where a tag is not closed, what is around it may be wrong.
    pub(super) fn misread(&mut self, wrong: Vec<Problem>) -> Done<()> {
        for problem in wrong {
            self.whole &= problem.lacking != Some(Lacking::Tag);
            self.pass(problem)?;
        }
        Ok(())
    }

    /// Looks into what is left out: what is wrong in it may be a fault of its own.
    pub(super) fn suppose(&mut self, element: &Element, macros: usize, scope: usize) {
        self.supposing(|this| this.element(element, macros, scope).map(drop));
    }

    /// Looks into a call of a macro that there is not: that of the name which is nearest, or what
    /// stands in the call.
    pub(super) fn suppose_call(&mut self, name: &str, call: &Element, macros: usize, scope: usize) {
        let symbols = &self.texts.symbols;
        let near = nearest(name, self.macros.all_names()).map(str::to_owned);
        let near = near.filter(|near| {
            self.macros
                .resolve(near, (macros, scope), symbols)
                .is_some()
        });
        let Some(near) = near else {
            self.suppose(call, macros, scope);
            return;
        };
        self.supposing(|this| {
            let (mut attributes, mut out) = (Vec::new(), Vec::new());
            this.call(&near, call, macros, scope, &mut attributes, &mut out)
        });
    }

    /// Tells what is wrong with a part as what may be wrong, too.
    fn supposing(&mut self, part: impl FnOnce(&mut Self) -> Done<()>) {
        // What is supposed within that could go on without an end.
        if self.supposed {
            return;
        }
        self.supposed = true;
        let (depth, faulty, whole) = (self.depth, self.faulty, self.whole);
        let place = self.texts.sources.place();
        let scopes = self.texts.symbols.scopes();
        if let Err(problem) = part(self) {
            self.tell(problem);
        }
        for (scope, name) in std::mem::take(&mut self.doubtful) {
            if scope < scopes {
                self.texts.symbols.set(scope, &name, Entry::Failed);
            }
        }
        (self.depth, self.faulty, self.whole) = (depth, faulty, whole);
        self.texts.sources.go_back(place);
        self.supposed = false;
    }

    /// Looks at the properties of a document that nothing needs which could be expanded.
    pub(super) fn suppose_properties(&mut self) {
        /// More properties, and larger files in bytes, are not searched.
        const MOST: (usize, usize) = (1000, 1 << 20);
        self.supposed = true;
        let unread = self.texts.symbols.unread();
        for (scope, name, text) in unread.into_iter().take(MOST.0) {
            let sources = &mut self.texts.sources;
            let whole = sources.read.get(&*sources.written());
            let whole = whole.filter(|whole| whole.len() <= MOST.1);
            sources.at = whole.and_then(|whole| whole.find(&text)).unwrap_or(0);
            if let Err(problem) = self.texts.entry(scope, &name) {
                self.tell(problem);
            }
        }
        self.supposed = false;
    }

    /// Notes that an element is not there.
    pub(super) fn leave_out(&mut self, child: &Element) {
        (self.faulty, self.whole) = (true, false);
        self.texts.blind |= may_define(child);
    }

    /// Notes that an attribute is not there.
    pub(super) fn leave_out_attribute(&mut self, name: &str) {
        self.faulty = true;
        self.whole &= !NAMES.contains(&name);
    }

    /// A property's value, or that it cannot be known.
    pub(super) fn entry(&mut self, text: &str, scope: usize) -> Done<Entry> {
        let value = self.attempt(|this| this.texts.value(text, scope))?;
        Ok(value.map_or(Entry::Failed, |value| Entry::Value(value.of_literal())))
    }

    /// `<xacro:arg>`
    pub(super) fn argument(&mut self, element: &Element, scope: usize) -> Done<()> {
        let name = self.required(element, "name")?.to_owned();
        let default = self.attempt(|this| {
            let default = this.required(element, "default")?;
            match this.texts.arguments.get(&name) {
                Some(known) => Ok(known.clone()),
                None => this.texts.shown(default, scope),
            }
        })?;
        match default {
            Some(value) => drop(self.texts.arguments.insert(name, value)),
            None => drop(self.texts.lost.insert(name)),
        }
        Ok(())
    }

    /// That a macro is called which is not defined.
    pub(super) fn no_macro(&self, name: &str) -> Problem {
        Problem {
            lacking: Some(Lacking::Macro(name.to_owned())),
            weight: self.texts.weight_of_missing(),
            ..self.problem(format!("there is no macro '{name}'"))
        }
        .meant(name, self.macros.all_names().chain(TAGS))
    }

    /// That a macro puts in a block which it was not given.
    pub(super) fn no_block(&self, name: &str, scope: usize) -> Problem {
        let names = self.texts.symbols.names(scope);
        let blocks = names.filter_map(|name| Some(name.strip_prefix('*')?.trim_start_matches('*')));
        self.problem(format!("there is no block '{name}'"))
            .meant(name, blocks)
    }
}

/// Whether an element may define names for what comes after it.
fn may_define(element: &Element) -> bool {
    match element.name.strip_prefix("xacro:") {
        Some("include" | "macro" | "property" | "arg" | "call") => true,
        Some("if" | "unless") | None => element.elements().any(|inner| may_define(inner)),
        Some(_) => false,
    }
}
