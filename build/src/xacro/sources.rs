//! Files that an expansion reads, and the place in them where it is.

use super::files::matching;
use super::folders;
use super::problem::{Done, Lacking, Meant, Problem, Weight};
use super::tree::{self, Element};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use urdf2fmu_core::diagnostic::Severity;
use urdf2fmu_core::encoding::xml_text;
use urdf2fmu_core::folder;
use urdf2fmu_core::reading;
use urdf2fmu_core::urdf::FoundPackage;

/// What a file is called whose name is empty.
pub(super) const NAMELESS: &str = "a file without a name";

/// Files within each other.
const DEEPEST: usize = 100;

/// Files larger than this, in bytes, are not read.
const LARGEST_FILE: u64 = 64 << 20;

/// Where packages are.
pub type Find<'f> = dyn Fn(&str) -> Option<FoundPackage> + 'f;

/// All files of an expansion.
pub struct Sources<'f> {
    find: &'f Find<'f>,
    /// The file that is read, and those that include it.
    open: Vec<Open>,
    /// Where the element starts that is expanded, bytes.
    pub at: usize,
    /// Every file read, with its text.
    pub read: BTreeMap<PathBuf, Rc<str>>,
    /// Packages that were found.
    pub packages: BTreeMap<String, PathBuf>,
    /// Paths at which there is no file, and those that are read in their place.
    pub meant: BTreeMap<PathBuf, PathBuf>,
    /// That files and packages are at other places than one would think.
    pub moved: Vec<(Severity, Problem)>,
}

/// A file that is read.
struct Open {
    path: Rc<Path>,
    /// The file of the macro that is expanded in it.
    body: Option<Rc<Path>>,
}

/// Where the expansion is, to go back there.
pub struct Place {
    files: usize,
    body: Option<Rc<Path>>,
    at: usize,
}

impl<'f> Sources<'f> {
    pub fn new(find: &'f Find<'f>) -> Self {
        Self {
            find,
            open: Vec::new(),
            at: 0,
            read: BTreeMap::new(),
            packages: BTreeMap::new(),
            meant: BTreeMap::new(),
            moved: Vec::new(),
        }
    }

    /// The file in which the element stands that is expanded: that of a macro, while paths count
    /// from where it is called.
    pub fn written(&self) -> Rc<Path> {
        self.open.last().map_or_else(
            || Path::new("").into(),
            |open| Rc::clone(open.body.as_ref().unwrap_or(&open.path)),
        )
    }

    /// Goes on in the file of a macro, or back; returns what was there before.
    pub fn body(&mut self, file: Option<Rc<Path>>) -> Option<Rc<Path>> {
        let open = self.open.last_mut()?;
        std::mem::replace(&mut open.body, file)
    }

    /// Where the expansion is.
    pub fn place(&self) -> Place {
        Place {
            files: self.open.len(),
            body: self.open.last().and_then(|open| open.body.clone()),
            at: self.at,
        }
    }

    /// Goes back to where the expansion was.
    pub fn go_back(&mut self, place: Place) {
        self.open.truncate(place.files);
        self.body(place.body);
        self.at = place.at;
    }

    /// A problem that follows from one that was told.
    pub fn follows(&self) -> Problem {
        let weight = Weight::Follows;
        Problem {
            weight,
            ..self.problem("")
        }
    }

    /// A problem at the present place.
    pub fn problem(&self, message: impl Into<String>) -> Problem {
        Problem {
            message: message.into(),
            file: self.written().to_path_buf(),
            at: self.at,
            lacking: None,
            meant: None,
            weight: Weight::Own,
        }
    }

    /// The root element of a file, and what is wrong with its text.
    pub fn root(&mut self, path: &Path) -> Done<(Element, Vec<Problem>)> {
        let text = self.text(path)?;
        let (root, wrong) = tree::parse(&text, path);
        let problem = |wrong: tree::Wrong| Problem {
            file: path.to_owned(),
            at: wrong.at,
            lacking: wrong.of_tags.then_some(Lacking::Tag),
            meant: wrong.help.map(Meant::advice),
            ..self.problem(wrong.message)
        };
        let mut wrong = wrong.into_iter().map(problem);
        match root {
            Some(root) => Ok((root, wrong.collect())),
            None => Err(wrong.next().unwrap_or_else(|| self.problem("not XML"))),
        }
    }

    /// Begins with a file.
    pub fn enter(&mut self, path: PathBuf) -> Done<()> {
        let path = path.into();
        self.open.push(Open { path, body: None });
        if self.open.len() > DEEPEST {
            let problem = self.problem("files include each other in a circle");
            return Err(problem.that_ends());
        }
        Ok(())
    }

    /// Goes on with the file around it.
    pub fn leave(&mut self) {
        self.open.pop();
    }

    /// The text of a file.
    pub fn text(&mut self, path: &Path) -> Done<Rc<str>> {
        if let Some(known) = self.read.get(path) {
            return Ok(Rc::clone(known));
        }
        // An empty name counts from the folder of the file that is read, too.
        let shown = path.to_string_lossy();
        let name = if shown.is_empty() || shown.ends_with(std::path::is_separator) {
            NAMELESS.to_owned()
        } else {
            path.display().to_string()
        };
        let absent = |error: String| Problem {
            lacking: Some(Lacking::File(path.to_owned())),
            ..self.problem(format!("{name} cannot be read: {error}"))
        };
        let read = reading::read_lasting(path, LARGEST_FILE);
        let bytes = match read {
            Err(error) if error.kind() == ErrorKind::FileTooLarge => {
                return Err(self.problem(format!("{} is too large", path.display())));
            }
            read => read.map_err(|error| absent(error.to_string()))?,
        };
        let text = xml_text(bytes).map_err(|refused| {
            let what = match refused.declared {
                Some(encoding) => format!("is in {encoding}: save it as UTF-8"),
                None => "is not UTF-8".to_owned(),
            };
            self.problem(format!("{} {what}", path.display()))
        })?;
        let text: Rc<str> = text.strip_prefix('\u{feff}').unwrap_or(&text).into();
        self.read.insert(path.to_owned(), Rc::clone(&text));
        Ok(text)
    }

    /// The path of a file, or of the one that is meant where there is none at it.
    pub fn there(&mut self, path: PathBuf) -> PathBuf {
        if self.read.contains_key(&path) || path.exists() {
            return path;
        }
        if let Some(meant) = self.meant.get(&path) {
            return meant.clone();
        }
        let Some(meant) = folders::meant(&path) else {
            return path;
        };
        let moved = Problem {
            lacking: Some(Lacking::File(path.clone())),
            ..self.problem(format!(
                "there is no file {}: {} is read in its place",
                path.display(),
                meant.display()
            ))
        };
        self.tell(Severity::Warning, moved);
        meant
    }

    /// Files that match a pattern; that there are none is told.
    pub fn matching(&mut self, pattern: &str) -> Vec<PathBuf> {
        let folder = self.beside("");
        let found = matching(&folder, pattern);
        if found.is_empty() {
            let help = "correct the pattern, which counts from the folder of the file that is \
                        read: '*' stands for any letters, '?' for one, '[ab]' for one of these; \
                        or leave it out";
            let none = Problem {
                lacking: Some(Lacking::File(folder.join(pattern))),
                meant: Some(Meant::advice(help.to_owned())),
                ..self.problem(format!(
                    "no file matches '{pattern}': this <xacro:include> includes nothing"
                ))
            };
            self.tell(Severity::Warning, none);
        }
        found
    }

    fn tell(&mut self, severity: Severity, moved: Problem) {
        if !self.moved.iter().any(|(_, known)| known.is_as(&moved)) {
            self.moved.push((severity, moved));
        }
    }

    /// A path that counts from the folder of the file that is read.
    pub fn beside(&self, name: &str) -> PathBuf {
        let folder = self.open.last().and_then(|open| open.path.parent());
        folder.map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
    }

    /// The folder of the file that is read.
    pub fn folder(&self) -> String {
        let beside = self.beside("");
        let folder = folder::present(&beside);
        let folder = std::path::absolute(folder);
        let shown = folder.unwrap_or(beside).display().to_string();
        shown.trim_end_matches('/').to_owned()
    }

    /// The folder of the package whose name is another one in small letters, as all are named.
    pub fn package_in_small_letters(&self, name: &str) -> Option<PathBuf> {
        let small = name.to_lowercase();
        let folder = (small != name).then(|| (self.find)(&small))??.folder;
        Some(std::path::absolute(&folder).unwrap_or(folder))
    }

    /// The folder of a package.
    pub fn package(&mut self, name: &str) -> Done<String> {
        let Some(found) = (self.find)(name) else {
            return Err(Problem {
                lacking: Some(Lacking::Package(name.to_owned())),
                ..self.problem(format!("the package '{name}' is not found"))
            });
        };
        if let Some(remark) = found.remark {
            let problem = self.problem(remark.message);
            let meant = Some(Meant::advice(remark.help));
            self.tell(remark.severity, Problem { meant, ..problem });
        }
        let folder = std::path::absolute(&found.folder).unwrap_or(found.folder);
        let shown = folder.display().to_string();
        self.packages.insert(name.to_owned(), folder);
        Ok(shown)
    }
}
