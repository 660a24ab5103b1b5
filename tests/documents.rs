//! Documents and comments name only what exists, and fit into 100 columns.
//!
//! In: every `*.rs` and `*.md` file of the repository but the recorded samples. Exceptions of the
//! line length: rows of tables, and code, which `rustfmt` breaks as far as it can.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Columns of a line, at most.
const COLUMNS: usize = 100;
/// Folders of this repository that documents may name files of.
const FOLDERS: [&str; 8] = [
    "src/",
    "fmi/",
    "build/",
    "tests/",
    "benches/",
    "docs/",
    "examples/",
    "fuzz/",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files below `folder` with one of these extensions, without hidden and built folders.
fn files(folder: &Path, extensions: &[&str], found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the folder can be read") {
        let path = entry.expect("the folder can be read").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let foreign = ["target", "node_modules"]
            .iter()
            .any(|folder| name == *folder);
        if name.starts_with('.') || foreign || name == "corpus" && !in_tests(&path) {
            continue;
        }
        if path.is_dir() {
            files(&path, extensions, found);
        } else if path
            .extension()
            .is_some_and(|e| extensions.iter().any(|x| e == *x))
        {
            found.push(path);
        }
    }
}

/// `tests/corpus` holds scripts; the other folders of that name hold samples.
fn in_tests(path: &Path) -> bool {
    path == root().join("tests/corpus")
}

fn texts(extensions: &[&str]) -> Vec<(String, String)> {
    let mut found = Vec::new();
    files(root(), extensions, &mut found);
    found.sort();
    assert!(found.len() > 10, "the repository's files are found");
    let text = |path: PathBuf| {
        let name = path.strip_prefix(root()).expect("below the root");
        let text = fs::read_to_string(&path).expect("UTF-8");
        (name.to_string_lossy().replace('\\', "/"), text)
    };
    found.into_iter().map(text).collect()
}

/// What stands in backticks in a line.
fn quoted(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

fn has_extension(name: &str, extension: &str) -> bool {
    Path::new(name).extension().is_some_and(|e| e == extension)
}

fn is_test_name(word: &str) -> bool {
    word.matches('_').count() >= 4
        && word
            .bytes()
            .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

#[test]
fn lines_of_documents_and_comments_fit_into_100_columns() {
    let mut long = Vec::new();
    for (name, text) in texts(&["rs", "md"]) {
        for (number, line) in text.lines().enumerate() {
            let comment = line.trim_start().starts_with("//");
            let prose = line.trim_start_matches([' ', '/', '!']);
            if line.chars().count() > COLUMNS
                && (has_extension(&name, "md") || comment)
                && !prose.starts_with('|')
            {
                long.push(format!("{name}:{}", number + 1));
            }
        }
    }
    assert!(long.is_empty(), "longer than {COLUMNS} columns: {long:#?}");
}

#[test]
fn documents_name_files_and_tests_that_exist() {
    let mut functions = HashSet::new();
    for (_, text) in texts(&["rs", "py"]) {
        for line in text.lines() {
            let line = line.trim_start();
            for keyword in ["fn ", "pub fn ", "pub(crate) fn ", "pub(super) fn ", "def "] {
                if let Some(rest) = line.strip_prefix(keyword) {
                    let end = rest.find(['(', '<']).unwrap_or(rest.len());
                    functions.insert(rest[..end].to_string());
                }
            }
            // A macro makes tests of lines such as `name: Value, 8;`.
            if let Some((name, _)) = line.split_once(": ").filter(|_| line.ends_with(';')) {
                functions.insert(name.to_string());
            }
        }
    }
    let mut missing = Vec::new();
    let mut named = [0, 0];
    for (name, text) in texts(&["md", "rs"]) {
        // The list of changes names what has been; of the sources the page of numbers names tests.
        if name == "CHANGELOG.md" || has_extension(&name, "rs") && name != "src/tuning.rs" {
            continue;
        }
        let folder = root().join(&name);
        let folder = folder.parent().expect("a file has a folder");
        for (number, line) in text.lines().enumerate() {
            let mut miss = |what: &str| missing.push(format!("{name}:{}: {what}", number + 1));
            for word in quoted(line) {
                if FOLDERS.iter().any(|f| word.starts_with(f))
                    && !word.contains(['*', '<', ' ', '{', '…'])
                {
                    named[0] += 1;
                    if !root().join(word).exists() {
                        miss(word);
                    }
                }
                let test = word.rsplit("::").next().unwrap_or(word);
                if is_test_name(test) {
                    named[1] += 1;
                    if !functions.contains(test) {
                        miss(word);
                    }
                }
            }
            for link in line
                .split("](")
                .skip(1)
                .filter_map(|rest| rest.split(')').next())
            {
                let file = link.split('#').next().unwrap_or(link);
                if !file.is_empty() && !file.contains("://") && !folder.join(file).exists() {
                    miss(link);
                }
            }
        }
    }
    assert!(
        named[0] > 50 && named[1] > 100,
        "files and tests are named: {named:?}"
    );
    assert!(
        missing.is_empty(),
        "documents name what does not exist: {missing:#?}"
    );
}

/// Names and the file that a document places them in: `name` in `file`, and `file`: a variant of
/// `Name`.
fn placed(text: &str) -> Vec<(String, String)> {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let parts: Vec<&str> = words.split('`').collect();
    let is_file = |word: &str| has_extension(word, "rs") && word.contains('/');
    let mut found = Vec::new();
    for (i, word) in parts.iter().enumerate().skip(1).step_by(2) {
        if !is_file(word) {
            continue;
        }
        let mut add = |name: &str| {
            let name = name.rsplit("::").next().unwrap_or(name);
            if name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
                found.push((name.to_string(), (*word).to_string()));
            }
        };
        let (mut at, mut joints) = (i, [" in ", " in "]);
        while at >= 2 && joints.contains(&parts[at - 1]) {
            at -= 2;
            add(parts[at]);
            joints = [", ", " and "];
        }
        if parts.get(i + 1) == Some(&": a variant of ") {
            add(parts.get(i + 2).unwrap_or(&""));
        }
    }
    found
}

#[test]
fn what_documents_place_in_a_file_is_in_it() {
    let text = "`a` and `b::C` in `src/x.rs`, `d` elsewhere; `src/y.rs`: a variant of `Z`.";
    let pair = |name: &str, file: &str| (name.to_string(), file.to_string());
    let expected = [
        pair("C", "src/x.rs"),
        pair("a", "src/x.rs"),
        pair("Z", "src/y.rs"),
    ];
    assert_eq!(placed(text), expected);
    let (mut count, mut missing) = (0, Vec::new());
    for (document, text) in texts(&["md"]) {
        for (name, file) in placed(&text) {
            let Ok(source) = fs::read_to_string(root().join(&file)) else {
                continue;
            };
            count += 1;
            let letter = |c: char| c.is_alphanumeric() || c == '_';
            if !source.split(|c| !letter(c)).any(|word| word == name) {
                missing.push(format!("{document}: {name} in {file}"));
            }
        }
    }
    assert!(count > 10, "{count} names are placed in files");
    assert!(missing.is_empty(), "not there: {missing:#?}");
}

/// Texts of the sources that look like a code of a finding, in quotes.
fn codes_in(text: &str) -> impl Iterator<Item = &str> {
    text.split('"').filter(|word| {
        let mut letters = word.chars();
        word.len() == 4
            && letters
                .next()
                .is_some_and(|letter| "ARSTU".contains(letter))
            && letters.all(|letter| letter.is_ascii_digit())
    })
}

#[test]
fn every_code_of_the_sources_is_in_the_table_and_the_other_way_round() {
    let (mut used, mut listed) = (HashSet::new(), HashSet::new());
    for (name, text) in texts(&["rs"]) {
        let table = name.ends_with("diagnostic/codes.rs");
        let own = (name.starts_with("src/") || name.starts_with("build/src/"))
            && !name.contains("/tests");
        for code in codes_in(&text).map(str::to_owned) {
            if table {
                listed.insert(code);
            } else if own {
                used.insert(code);
            }
        }
    }
    let mut missing: Vec<_> = used.symmetric_difference(&listed).collect();
    missing.sort();
    assert!(listed.len() > 100 && missing.is_empty(), "{missing:?}");
}
