//! What the advice says was meant.

use super::*;

/// What other programs call a key or a word; what is like none of them is not guessed.
#[test]
fn words_of_other_programs_lead_to_the_own_ones() {
    for (text, help) in [
        ("[[world.object]]\nshape = { ball = 1 }", "'sphere'"),
        ("[[world.object]]\nposition = [0, 0, 1]", "'xyz'"),
        ("[[world.object]]\nfixed = true", "'static'"),
        ("[world.ground]\nmu = 0.5", "'friction'"),
        ("[robot]\nfixed_base = true", "'base'"),
        ("[solver]\ntimestep = 1e-3", "'step_size'"),
        ("[initial]\nyaw = 1", "'rpy'"),
        ("[[loop]]\nlink1 = \"a\"", "'links'"),
        ("[[spring]]\nk = 100", "'stiffness'"),
        ("[[sensor]]\ntype = \"lidar\"", "'ray'"),
        ("[[sensor]]\nppr = 1000", "'counts'"),
        ("[[actuator]]\nmode = \"torque\"", "'effort'"),
        ("[joint.a]\nmimic = \"b\"", "known are damping"),
    ] {
        let found = Settings::parse(text, "robot.toml").expect_err(text);
        let advice = found.iter().filter_map(|f| f.help.as_deref());
        let advice: Vec<&str> = advice.filter(|h| h.contains(help)).collect();
        assert_eq!(advice.len(), 1, "{text}: {found:?}");
        assert!(
            help.starts_with('\'') || !advice[0].contains("did you"),
            "{found:?}"
        );
    }
    let found = finding("[[sensor]]\ntype = \"camera\"\nlink = \"a\"");
    assert_eq!(found.help, None, "a guess would mislead: {found:?}");
}

/// What stands in place of a table or a list says how that is written; degrees are no attitude.
#[test]
fn advice_shows_how_a_value_is_written() {
    for (text, part) in [
        ("[world.object]\nname = \"a\"", "[[world.object]]"),
        (
            "[world]\nground = false",
            "[world.ground] has the keys type, friction",
        ),
        ("link = 1", "write [link.\"…\"]"),
        ("[outputs]\nlinks = \"head\"", "links = [\"head\"]"),
        ("[solver]\nstep_size = 1/240", "\"1/240\""),
        (
            "[[world.object]]\nname = \"a\"\nurdf = \"C:\\robots\\a.urdf\"",
            "twice",
        ),
        ("[robot]\nscale = 2\n[solver]\n[robot]\n", "one header"),
        ("[robot]\nscale = null", "leave the key out"),
        ("[robot]\nbase = “fixed”", "straight quotes"),
        ("[robot]\nbase: \"fixed\"", "joined by ="),
        ("[robot]\nscale = .5", "0.5 or 1e-3"),
        ("[robot]\nscale = 2 m", "without a unit"),
        ("[joint.*]\ndamping = 1", "in quotes"),
        ("; settings\n[robot]", "begins with #"),
        ("[initial]\nrpy = [0, 0, 90]", "degrees"),
        ("{\"robot\": {}}", "JSON"),
        ("# settings\nrobot:\n  base: fixed\n", "YAML"),
    ] {
        let found = Settings::parse(text, "robot.toml").expect_err(text);
        let told = format!(
            "{} {}",
            found[0].message,
            found[0].help.as_deref().unwrap_or_default()
        );
        assert!(told.contains(part), "{text}: {found:?}");
    }
}

#[test]
fn numbers_and_flags_in_quotes_are_told_how_they_are_written() {
    for (text, advice) in [
        ("robot.scale = \"2\"", "write scale = 2, without quotes"),
        (
            "robot.density = \"7850 kg/m3\"",
            "without quotes, in SI units: density = 7850",
        ),
        (
            "world.gravity = [0, 0, \"-9.81\"]",
            "write gravity = -9.81, without quotes",
        ),
        (
            "robot.self_collision = \"yes\"",
            "write self_collision = true, without quotes",
        ),
    ] {
        let help = finding(text).help.unwrap_or_default();
        assert!(help.contains(advice), "{text}: {help}");
    }
    assert_eq!(finding("robot.scale = \"mm\"").help, None);
}

/// `urdf2fmu init robot.urdf > robot.toml` in Windows PowerShell.
#[test]
fn settings_that_powershell_has_redirected_are_read() {
    let folder = std::env::temp_dir();
    let path = folder.join(format!("urdf2fmu-settings-{}.toml", std::process::id()));
    let text = "\u{feff}robot.base = \"fixed\"\r\n";
    let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::fs::write(&path, bytes).expect("a file");
    let read = Settings::read(&path);
    std::fs::remove_file(&path).expect("the file");
    assert_eq!(read.expect("legal").base, BaseChoice::Fixed);
}

#[test]
fn a_number_as_a_program_prints_it_is_told_with_the_number() {
    for name in ["np.float64", "int", "numpy.float32", "Decimal"] {
        let found = finding(&format!("[robot]\nscale = {name}(1.5)"));
        assert_eq!(found.code, "S101");
        assert_eq!(found.help.as_deref(), Some("write the number alone: 1.5"));
        assert!(found.message.contains(&format!("'{name}(1.5)'")), "{name}");
    }
}

#[test]
fn points_of_contacts_that_there_are_none_of_are_refused() {
    let found = finding("[outputs]\ncontacts = \"none\"\ncontact_points = true");
    assert_eq!(found.code, "S106");
    assert_eq!(found.place.as_ref().map(|place| place.line), Some(3));
    for text in [
        "[outputs]\ncontacts = \"none\"\ncontact_points = false",
        "[outputs]\ncontacts = [\"a\"]\ncontact_points = true",
    ] {
        assert!(Settings::parse(text, "r.toml").is_ok(), "{text}");
    }
}

/// Where a header is missing, its keys stand below another one and belong together.
#[test]
fn keys_below_the_header_of_another_table_are_sent_where_all_of_them_belong() {
    for (text, key, help) in [
        (
            "[fmu]\nmass = 1",
            "mass",
            "'mass' belongs into [[world.object]] or [link.\"…\"]",
        ),
        (
            "[fmu]\nfriction = 0.5\ndamping = 1",
            "friction",
            "'friction' belongs into [joint.\"…\"]",
        ),
        (
            "[robot]\nfile = \"a.png\"\nsize = [1, 1]\nheight = 2",
            "size",
            "'size' belongs into [[world.terrain]]",
        ),
        (
            "[robot]\njoints = { a = 1 }",
            "joints",
            "write [initial.joints]",
        ),
    ] {
        let found = Settings::parse(text, "robot.toml").expect_err(text);
        let of_key = format!("unknown key '{key}'");
        let told = found.iter().find(|found| found.message.contains(&of_key));
        let told = told.expect(text).help.as_deref();
        assert_eq!(told, Some(help), "{text}");
    }
}

#[test]
fn habits_of_other_languages_at_the_end_of_a_value_are_told() {
    for (value, help) in [
        (
            "3,5",
            "the decimal sign is a point, and several numbers are a list: [1, 2]",
        ),
        ("3;", "leave the ; out: nothing ends a line"),
        ("3.5;", "a comment begins with #, and nothing ends a line"),
        (
            "",
            "the value is missing: write one behind =, or leave the key out",
        ),
    ] {
        let text = format!("[joint.a]\ndamping = {value}\nfriction = 1");
        let found = finding(&text);
        assert_eq!(
            (found.code, found.help.as_deref()),
            ("S101", Some(help)),
            "{value}"
        );
    }
}

/// The range is the documented one at the first try, and nothing is told that follows from it.
#[test]
fn counts_name_their_whole_range_at_once() {
    for rays in ["0", "20000", "1.5", "-3", "1e9"] {
        let text = format!("[[sensor]]\ntype = \"ray\"\nlink = \"a\"\nfov = 1\nrays = {rays}");
        let found = Settings::parse(&text, "robot.toml").expect_err(&text);
        let told: Vec<&str> = found.iter().map(|found| found.message.as_str()).collect();
        assert_eq!(
            told,
            ["'rays' must be a whole number from 1 to 10000"],
            "{rays}"
        );
    }
}
