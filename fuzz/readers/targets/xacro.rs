//! A document in xacro, after a zero a file that it can include, after another one a YAML file.
//! What cannot be expanded is told, and expanded as if what is proposed were done.

#[path = "../../../build/src/xacro/bind.rs"]
mod bind;
#[path = "../../../build/src/xacro/command.rs"]
mod command;
#[path = "../../../build/src/xacro/definitions.rs"]
mod definitions;
#[path = "../../../build/src/xacro/evaluate.rs"]
mod evaluate;
#[path = "../../../build/src/xacro/expand.rs"]
mod expand;
#[path = "../../../build/src/xacro/files.rs"]
mod files;
#[path = "../../../build/src/xacro/findings.rs"]
mod findings;
#[path = "../../../build/src/xacro/folders.rs"]
mod folders;
#[path = "../../../build/src/xacro/foreseen.rs"]
mod foreseen;
#[path = "../../../build/src/xacro/format.rs"]
mod format;
#[path = "../../../build/src/xacro/functions.rs"]
mod functions;
#[path = "../../../build/src/xacro/includers.rs"]
mod includers;
#[path = "../../../build/src/xacro/macros.rs"]
mod macros;
#[path = "../../../build/src/xacro/numbers.rs"]
mod numbers;
#[path = "../../../build/src/xacro/parameter.rs"]
mod parameter;
#[path = "../../../build/src/xacro/parse.rs"]
mod parse;
#[path = "../../../build/src/xacro/paths.rs"]
mod paths;
#[path = "../../../build/src/xacro/problem.rs"]
mod problem;
#[path = "../../../build/src/xacro/proposed.rs"]
mod proposed;
#[path = "../../../build/src/xacro/recover.rs"]
mod recover;
#[path = "../../../build/src/xacro/sources.rs"]
mod sources;
#[path = "../../../build/src/xacro/symbols.rs"]
mod symbols;
#[path = "../../../build/src/xacro/texts.rs"]
mod texts;
#[path = "../../../build/src/xacro/tree.rs"]
mod tree;
#[path = "../../../build/src/xacro/value.rs"]
mod value;
#[path = "../../../build/src/xacro/values.rs"]
mod values;
#[path = "../../../build/src/xacro/yaml.rs"]
mod yaml;

use expand::Expansion;
use std::collections::BTreeMap;
use std::path::Path;
use urdf2fmu_core::urdf::FoundPackage;

pub fn xacro(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let mut parts = text.split('\0');
    let nowhere = Path::new("no-such-folder");
    let find = |name: &str| {
        (name == "p").then(|| FoundPackage {
            folder: nowhere.to_owned(),
            remark: None,
        })
    };
    let arguments = BTreeMap::from([("a".to_owned(), "1".to_owned())]);
    let mut expansion = Expansion::new(arguments, &find);
    for name in ["r", "b", "y"] {
        let text = parts.next().unwrap_or_default();
        let files = &mut expansion.texts.sources.read;
        files.insert(nowhere.join(name), text.into());
    }
    let path = nowhere.join("r");
    let mut root = expansion.document(&path);
    let refused = !expansion.problems.is_empty();
    assert!(root.is_some() || refused);
    if refused {
        // What is told, and what comes next.
        let arguments = ["a:=1".to_owned()];
        let (told, _, last, _) = foreseen::all(&path, &arguments, &find, (expansion, root));
        assert!(!told.is_empty() && told.iter().all(|finding| !finding.message.is_empty()));
        root = last;
    }
    let Some(root) = root else {
        return;
    };
    // What comes out is XML, and nothing of xacro is left in its elements.
    let written = tree::write(&root).text;
    let again = tree::parse(&written, nowhere);
    assert!(again.1.is_empty() || odd(&root), "{written}");
}

/// Whether names or texts are in it that no XML can hold; xacro makes them of any text.
fn odd(element: &tree::Element) -> bool {
    let plain = |name: &str| {
        let mut letters = name.chars();
        letters.next().is_some_and(char::is_alphabetic)
            && letters.all(|c| c.is_alphanumeric() || "_:-.".contains(c))
    };
    !plain(&element.name)
        || !element.attributes.iter().all(|(name, _)| plain(name))
        || element.elements().any(|inner| odd(inner))
}
