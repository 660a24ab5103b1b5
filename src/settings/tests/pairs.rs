//! `[[outputs.pair]]`.

use super::*;

#[test]
fn a_side_of_a_pair_is_a_name_or_a_list_of_names() {
    let settings = parse(
        "[[outputs.pair]]\nname = \"grasp\"\nfirst = [\"left_finger\", \"right_*\"]\n\
         second = \"cup\"\n[[outputs.pair]]\nname = \"stand\"\nfirst = \"cup\"\nsecond = [\"ground\"]",
    );
    let texts = |patterns: &[crate::pattern::Pattern]| -> Vec<String> {
        patterns.iter().map(|p| p.text.clone()).collect()
    };
    let [grasp, stand] = &settings.pairs[..] else {
        panic!("{:?}", settings.pairs);
    };
    assert_eq!(grasp.name.text, "grasp");
    assert_eq!(texts(&grasp.sides[0]), ["left_finger", "right_*"]);
    assert_eq!(texts(&grasp.sides[1]), ["cup"]);
    assert_eq!(texts(&stand.sides[1]), ["ground"]);
    let place = grasp.sides[1][0].place.as_ref().expect("a place");
    assert_eq!(place.line, 4);
}

#[test]
fn pairs_refuse_missing_empty_and_unsuitable_keys() {
    let table = "[[outputs.pair]]\n";
    for (text, code, word) in [
        ("first = \"a\"\nsecond = \"b\"", "S107", "name"),
        ("name = \"p\"\nsecond = \"b\"", "S107", "first"),
        ("name = \"p\"\nfirst = \"a\"", "S107", "second"),
        ("name = \"p\"\nfirst = []\nsecond = \"b\"", "S107", "first"),
        (
            "name = \"\"\nfirst = \"a\"\nsecond = \"b\"",
            "S104",
            "empty",
        ),
        (
            "name = \"p\"\nfirst = 1\nsecond = \"b\"",
            "S103",
            "or a list",
        ),
        (
            "name = \"p\"\nfirst = [1]\nsecond = \"b\"",
            "S103",
            "or a list",
        ),
        (
            "name = \"p\"\nfirst = \"a\"\nsecond = \"b\"\nthird = \"c\"",
            "S102",
            "third",
        ),
    ] {
        let found = finding(&format!("{table}{text}"));
        assert_eq!(found.code, code, "{text}");
        assert!(found.message.contains(word), "{text}: {}", found.message);
    }
    let found = finding("[outputs]\npair = 3");
    assert_eq!(found.code, "S103");
}
