use super::*;

#[test]
fn a_file_expanded_from_xacro_gets_a_name_that_ends_in_urdf() {
    assert_eq!(urdf_name("a/rover.urdf.xacro"), "a/rover.urdf");
    assert_eq!(urdf_name("a/rover.xacro"), "a/rover.urdf");
    assert_eq!(urdf_name("a/rover.srdf.xacro"), "a/rover.srdf");
    assert_eq!(urdf_name("a/rover.srdf"), "a/rover.srdf");
    assert!(is_xacro(Path::new("a.XACRO")) && !is_xacro(Path::new("xacro.urdf")));
}

#[test]
fn only_what_defines_something_is_taken_for_xacro() {
    assert!(defines("<robot><xacro:arg name='a' default='1'/></robot>"));
    assert!(defines("<robot><xacro:if value='1'/></robot>"));
    // A call whose macro is nowhere, and what stands in a comment.
    assert!(!defines("<robot><xacro:wheel/></robot>"));
    assert!(!defines("<robot><!-- <xacro:macro name='a'/> --></robot>"));
    assert!(!defines("<robot xmlns:xacro='x'/>"));
}

struct Nothing;

impl functions::Names for Nothing {}

/// What an expression gives, as Python writes it, or what is wrong with it.
fn value_of(text: &str) -> Result<String, String> {
    let parsed = parse::expression(text)?;
    let value = evaluate::Evaluation::new(&mut Nothing).value(&parsed)?;
    Ok(value.literal())
}

/// Expected: what Python 3.11 prints; sets of one value, whose order is no question.
#[test]
fn sets_are_subtracted_joined_and_cut_as_in_python() {
    for (text, expected) in [
        ("python.set([1, 2, 2]) - python.set([2, 3])", "{1}"),
        ("python.set('ab') & python.set('bc')", "{'b'}"),
        ("python.set([]) | python.set([4])", "{4}"),
        ("python.set([1, 2]) ^ python.set([2])", "{1}"),
        ("python.set(['a']) - python.set(['a'])", "set()"),
        ("python.set([1, 2]) == python.set([2, 1])", "True"),
        ("python.len(python.set('aab'))", "2"),
        ("'x' in python.set('xy')", "True"),
        ("xacro.tokenize('a=b;c', sep='=')", "['a', 'b;c']"),
    ] {
        assert_eq!(value_of(text).as_deref(), Ok(expected), "{text}");
    }
}

#[test]
fn numbers_at_the_ends_of_their_range_are_told_or_taken() {
    let lowest = "(-9223372036854775807 - 1)";
    assert!(value_of(&format!("-{lowest}")).is_err());
    assert!(value_of(&format!("{lowest} // -1")).is_err());
    // Found by fuzzing: the letter after the number has several bytes.
    assert_eq!(value_of("8Ⱦ"), Err("'8Ⱦ' is no number".to_owned()));
    let slice = value_of("[1, 2, 3][1:3:9223372036854775807]");
    assert_eq!(slice.as_deref(), Ok("[2]"));
}

/// Comments are no XML: their quotes may be of any alphabet. A curly one ended the program, in any
/// file that could be expanded.
#[test]
fn quotes_in_comments_may_be_of_any_alphabet() {
    let comment = "<!-- <xacro:arg name=\u{201c}a\u{201d}/> or <xacro:arg name=\u{e9}/> -->";
    let inside = "<xacro:property name='p' value='1'/><link name='a'/>";
    let text = format!("<robot name='r' xmlns:xacro='x'>{comment}{inside}</robot>");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("r.xacro");
    std::fs::write(&file, text).expect("written");
    let arguments = ["a:=1".to_owned()];
    let expanded = expand(&file, &arguments, &ReadOptions::default()).expect("expanded");
    let text = expanded.text;
    assert!(text.contains("<link name=\"a\"/>"), "{text}");
}

/// Macros that call themselves within calls that are wrong went on for seconds: each wrong call was
/// told, or known, and the next looked into. What is refused then is counted, too: each element
/// that is open, and its calls.
#[test]
fn macros_that_call_themselves_within_wrong_calls_end_soon() {
    let wrong = "<xacro:none/>".repeat(3);
    let calls = "<xacro:ab><xacro:b/></xacro:ab>".repeat(3);
    let text = format!(
        "<robot name='r' xmlns:xacro='http://wiki.ros.org/xacro'>\
         <xacro:macro name='a' params='*k'>{calls}<xacro:a/></xacro:macro>\
         <xacro:macro name='b' params='*k'>{wrong}</xacro:macro>\
         <xacro:macro name='ab' params=''><xacro:none y='${{y}}'/></xacro:macro><xacro:a/></robot>"
    );
    let path = Path::new("no-such-folder/r.xacro");
    let nowhere = |_: &str| None;
    let mut expansion = Expansion::new(BTreeMap::new(), &nowhere);
    let files = &mut expansion.texts.sources.read;
    files.insert(path.to_owned(), text.into());
    expansion.document(path);
    assert!(!expansion.problems.is_empty());
    let looked_at = expansion.after;
    assert!(looked_at < 2 * expand::MOST_AFTER, "{looked_at}");
}
