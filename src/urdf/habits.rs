//! What people write in a URDF as other programs and formats have it, and what to write in its
//! place: root elements, attributes, names, and meshes in files of other kinds.

use super::xml::Node;
use crate::diagnostic::words::did_you_mean;

/// Endings of files that hold others.
const PACKED: [&str; 7] = ["gz", "zip", "zae", "bz2", "xz", "7z", "zst"];

/// Longest text that is written out as the value of an attribute, bytes: a name of a mesh in its
/// folders, or some numbers.
const MOST_CONTENT: usize = 200;

/// What to do about a document with this root element, if another program has it.
pub(super) fn root(element: &str) -> Option<&'static str> {
    Some(match element {
        "sdf" => "this is an SDF file: convert it to URDF first",
        "mujoco" => "this is an MJCF file: convert it to URDF first",
        "xacro" => "name the file .xacro, so that it is expanded",
        "launch" => "this is a launch file: give the URDF or .xacro file that it loads",
        "package" => "this is the manifest of a package: give a URDF or .xacro file of it",
        _ => return None,
    })
}

/// What to write for an attribute that the element does not take.
///
/// - `known`: those that it takes
pub(super) fn attribute(name: &str, known: &[&str]) -> String {
    if name.starts_with("quat") && known.contains(&"rpy") {
        return "write quat_xyzw=\"x y z w\", with <robot version=\"1.1\">, or rpy".to_owned();
    }
    if name == "diameter" && known.contains(&"radius") {
        return "write radius=\"…\", which is half of it".to_owned();
    }
    did_you_mean(name, known.iter().copied())
}

/// What to write for an attribute that stands in an element of its own, or as the text of the one
/// that lacks it, as an SDF has it.
pub(super) fn content(node: Node, name: &str) -> Option<String> {
    let called = if name == "filename" { "uri" } else { name };
    let inner = node.children().find(|child| child.name() == called);
    let text = inner.map_or_else(|| node.content(), Node::content);
    let words: Vec<&str> = text.split_whitespace().collect();
    // Of several numbers it is not known which of them is this one.
    if inner.is_none() && (node.name() == "inertia" || words.len() > 1 && name != "size") {
        return None;
    }
    let value = words.join(" ");
    let place = match inner {
        Some(inner) => format!("<{}>", inner.name()),
        None => "the text".to_owned(),
    };
    let plain = |c: char| c.is_alphanumeric() || " _-+.:/".contains(c);
    let short = !value.is_empty() && value.len() <= MOST_CONTENT && value.chars().all(plain);
    short.then(|| {
        format!("write {name}=\"{value}\" in place of {place}, which is how an SDF has it")
    })
}

/// What to write for a name that nothing has, because it is an expression without its sign.
pub(super) fn name(name: &str) -> Option<&'static str> {
    let (before, behind) = name.split_once('{')?;
    (!before.ends_with('$') && behind.contains('}'))
        .then_some("an expression of xacro begins with a dollar sign: ${…}")
}

/// What to do about a mesh in a file of a kind, in small letters, that is not read.
pub(super) fn mesh(kind: &str) -> &'static str {
    if PACKED.contains(&kind) {
        "unpack the file, and name what is in it"
    } else {
        "convert the mesh to STL or OBJ"
    }
}

/// What to do about the name of a mesh with an ending, in small letters, that is of no kind that is
/// read.
pub(super) fn ending(kind: &str) -> String {
    // An address has more behind the ending, and a name may have marks around it.
    let letters = kind.find(|c: char| !c.is_alphanumeric());
    match letters.map(|end| &kind[end..]) {
        Some(more) => format!("leave {more} out, which is no part of a file's name"),
        None if PACKED.contains(&kind) => {
            format!(".{kind} files are not read: unpack them, and name what is in them")
        }
        None => format!(".{kind} files are not read: convert them to STL or OBJ"),
    }
}
