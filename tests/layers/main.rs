//! Checks that files use each other only in the direction that `docs/architecture.md` lists.
//!
//! The page lists the modules of each package from the bottom up, in code blocks whose first line
//! is `layers` and the package's root file. A module may use its own line and the lines above it.
//! Modules with a bar between them do not use each other. No files use each other in a circle.

mod source;

use source::Package;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What is still wrong: each pair is a file and another one that it should not use. Entries only
/// ever leave.
const KNOWN: &[(&str, &str)] = &[];

/// Files of more than 500 lines that do not say why. Entries only ever leave.
const KNOWN_LONG: &[&str] = &[];

/// Lines that a file may have without a reason.
const LONGEST_FILE: usize = 500;

/// How the line of a header begins that gives the reason.
const REASON: &str = "//! Over 500 lines because ";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A package of the page: its root file, and for each layer the groups of modules that do not use
/// each other.
struct Layers {
    file: String,
    layers: Vec<Vec<Vec<String>>>,
}

fn layers_of_the_page() -> Vec<Layers> {
    let path = root().join("docs/architecture.md");
    let page = std::fs::read_to_string(&path).expect("docs/architecture.md");
    let mut list: Vec<Layers> = Vec::new();
    let mut inside = false;
    for line in page.lines() {
        if let Some(file) = line.strip_prefix("```layers ") {
            list.push(Layers {
                file: file.trim().to_owned(),
                layers: Vec::new(),
            });
            inside = true;
        } else if line.starts_with("```") {
            inside = false;
        } else if inside {
            // What follows two spaces explains the line.
            let names = line.split("  ").next().unwrap_or_default();
            let groups = names.split('|').map(|group| {
                group
                    .split(',')
                    .map(|name| name.trim().to_owned())
                    .collect::<Vec<_>>()
            });
            list.last_mut()
                .expect("a block")
                .layers
                .push(groups.collect());
        }
    }
    assert!(!list.is_empty(), "docs/architecture.md lists no layers");
    list
}

/// The module of a file that stands directly below the package's root.
fn module_of(file: &str) -> &str {
    file.split('/')
        .next()
        .unwrap_or(file)
        .trim_end_matches(".rs")
}

impl Layers {
    /// Index of a module's layer and of its group within that.
    fn place(&self, module: &str) -> Option<(usize, usize)> {
        self.layers.iter().enumerate().find_map(|(layer, groups)| {
            let group = groups
                .iter()
                .position(|group| group.iter().any(|name| name == module));
            Some((layer, group?))
        })
    }
}

/// For each file the number of its circle; files with the same number reach each other.
fn circles(package: &Package, arrows: &BTreeSet<(usize, usize)>) -> Vec<usize> {
    let count = package.files.len();
    let reached: Vec<BTreeSet<usize>> = (0..count)
        .map(|start| {
            let mut seen = BTreeSet::from([start]);
            let mut open = vec![start];
            while let Some(file) = open.pop() {
                for &(_, to) in arrows.range((file, 0)..(file + 1, 0)) {
                    if seen.insert(to) {
                        open.push(to);
                    }
                }
            }
            seen
        })
        .collect();
    (0..count)
        .map(|file| {
            let same =
                |other: &usize| reached[file].contains(other) && reached[*other].contains(&file);
            (0..count).find(same).unwrap_or(file)
        })
        .collect()
}

#[test]
fn files_use_only_what_lies_below_them_and_never_each_other() {
    let mut wrong = Vec::new();
    let mut known: BTreeSet<(String, String)> = KNOWN
        .iter()
        .map(|&(from, to)| (from.to_owned(), to.to_owned()))
        .collect();
    for layers in layers_of_the_page() {
        let path = root().join(&layers.file);
        let folder = Path::new(&layers.file)
            .parent()
            .expect("a folder")
            .display()
            .to_string();
        let package = Package::read(&path);
        let name = |file: usize| format!("{folder}/{}", package.files[file]);
        for (file, path) in package.files.iter().enumerate().skip(1) {
            if layers.place(module_of(path)).is_none() {
                wrong.push(format!(
                    "{} is in no layer of docs/architecture.md",
                    name(file)
                ));
            }
        }
        let upward = |&(from, to): &(usize, usize)| {
            let (from, to) = (
                module_of(&package.files[from]),
                module_of(&package.files[to]),
            );
            match (layers.place(from), layers.place(to)) {
                (Some(from), Some(to)) => from.0 < to.0 || (from.0 == to.0 && from.1 != to.1),
                // The root file stands above all.
                (Some(_), None) => true,
                _ => false,
            }
        };
        let circle = circles(&package, &package.arrows);
        let mut rest = package.arrows.clone();
        for &arrow in &package.arrows {
            let (from, to) = arrow;
            let pair = (name(from), name(to));
            if known.contains(&pair) {
                known.remove(&pair);
                rest.remove(&arrow);
                if !upward(&arrow) && circle[from] != circle[to] {
                    wrong.push(format!(
                        "{} → {} is no longer wrong: strike it from KNOWN",
                        pair.0, pair.1
                    ));
                }
            } else if upward(&arrow) {
                wrong.push(format!(
                    "{} uses {}, which lies above it or beside a bar",
                    pair.0, pair.1
                ));
            }
        }
        let circle = circles(&package, &rest);
        for &(from, to) in &rest {
            if circle[from] == circle[to] {
                wrong.push(format!("{} → {} is part of a circle", name(from), name(to)));
            }
        }
    }
    for (from, to) in known {
        wrong.push(format!("{from} → {to} is gone: strike it from KNOWN"));
    }
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n"));
}

/// Arrows between the core's modules that the drawing of the page shows.
fn drawing() -> BTreeSet<(String, String)> {
    let path = root().join("docs/architecture.md");
    let page = std::fs::read_to_string(&path).expect("docs/architecture.md");
    let (_, rest) = page.split_once("```mermaid").expect("a drawing");
    let (drawing, _) = rest.split_once("```").expect("the drawing's end");
    let arrows = drawing.lines().filter_map(|line| line.split_once("-->"));
    arrows
        .map(|(from, to)| (from.trim().to_owned(), to.trim().to_owned()))
        .collect()
}

/// An arrow is drawn where no longer way along arrows leads from the one module to the other.
#[test]
fn the_drawing_shows_the_arrows_between_the_modules_of_the_core() {
    let package = Package::read(&root().join("src/lib.rs"));
    let mut below: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for &(from, to) in &package.arrows {
        let (file, used) = (&package.files[from], &package.files[to]);
        let known = KNOWN.contains(&(&format!("src/{file}"), &format!("src/{used}")));
        let (from, to) = (module_of(file), module_of(used));
        if from != to && !known {
            below.entry(from).or_default().insert(to);
        }
    }
    // All that a module uses, itself or through others. Only a circle would not end in this many
    // rounds.
    let mut reached = below.clone();
    for _ in 0..below.len() {
        for (module, list) in &mut reached {
            let more = list.iter().filter_map(|used| below.get(used)).flatten();
            let more: Vec<&str> = more.copied().collect();
            list.extend(more);
            assert!(
                !list.contains(module),
                "the modules around '{module}' use each other in a circle"
            );
        }
    }
    let mut expected = BTreeSet::new();
    for (from, list) in &below {
        for to in list {
            let longer = list
                .iter()
                .any(|by| reached.get(by).is_some_and(|all| all.contains(to)));
            if !longer {
                expected.insert(((*from).to_owned(), (*to).to_owned()));
            }
        }
    }
    let lines: Vec<String> = expected
        .iter()
        .map(|(from, to)| format!("    {from} --> {to}"))
        .collect();
    assert!(
        drawing() == expected,
        "\nthe drawing should be\n\n{}\n",
        lines.join("\n")
    );
}

fn rust_files(folder: &Path, list: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            if path.file_name().is_some_and(|name| name != "target") {
                rust_files(&path, list);
            }
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            list.push(path);
        }
    }
}

#[test]
fn files_of_more_than_500_lines_say_why() {
    let mut files = Vec::new();
    for folder in [
        "src", "fmi", "build", "tests", "fuzz", "benches", "examples",
    ] {
        rust_files(&root().join(folder), &mut files);
    }
    let mut known: BTreeSet<&str> = KNOWN_LONG.iter().copied().collect();
    let mut wrong = Vec::new();
    for path in files {
        let text = std::fs::read_to_string(&path).expect("a text");
        let name = path
            .strip_prefix(root())
            .expect("a file of the project")
            .to_string_lossy();
        let name = name.replace('\\', "/");
        let lines = text.lines().count();
        if lines > LONGEST_FILE && !text.contains(REASON) && !known.remove(name.as_str()) {
            wrong.push(format!(
                "{name} has {lines} lines and no line \"{REASON}…\""
            ));
        }
    }
    for name in known {
        wrong.push(format!("{name} is short enough: strike it from KNOWN_LONG"));
    }
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n"));
}
