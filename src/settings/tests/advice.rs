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
fn a_further_robot_is_told_from_the_table_of_the_first() {
    let found = finding("[[robot]]\nurdf = \"a.urdf\"");
    let help = found.help.unwrap_or_default();
    assert_eq!(help, "write [robot], and [[world.robot]] for a further one");
}

#[test]
fn numbers_and_flags_in_quotes_are_told_how_they_are_written() {
    for (text, advice) in [
        ("robot.scale = \"2\"", "write 2, without quotes"),
        (
            "robot.density = \"7850 kg/m3\"",
            "without quotes, in SI units: 7850",
        ),
        (
            "world.gravity = [0, 0, \"-9.81\"]",
            "write -9.81, without quotes",
        ),
        (
            "robot.self_collision = \"yes\"",
            "write true, without quotes",
        ),
    ] {
        let help = finding(text).help.unwrap_or_default();
        assert!(help.contains(advice), "{text}: {help}");
    }
    let help = finding("robot.scale = \"mm\"").help.unwrap_or_default();
    assert!(
        help.starts_with("what it is: every length times this"),
        "{help}"
    );
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

/// What is written in place of the value is right by itself and beside the others.
#[test]
fn advice_that_is_followed_leads_to_no_second_error() {
    let ray = "[[sensor]]\ntype = \"ray\"\nlink = \"a\"\n";
    let force = "[[sensor]]\ntype = \"ft\"\njoint = \"a\"\n";
    // Text, part of each finding in order, what the advice makes of it.
    for (text, told, mended) in [
        (
            format!("{ray}rays = 2.5\nfov = 1"),
            &["write rays = 3"][..],
            format!("{ray}rays = 3\nfov = 1"),
        ),
        (
            format!("{ray}rays = 1.5\nfov = 1"),
            &["write rays = 2"],
            format!("{ray}rays = 2\nfov = 1"),
        ),
        (
            format!("{ray}rays = 9\nfov = 90"),
            &["90° are fov = 1.570796; a row all around"],
            format!("{ray}rays = 9\nfov = 1.570796"),
        ),
        (
            format!("{ray}fov = 400"),
            &[
                "angles are in rad, and a row all around",
                "set rays above 1, too",
            ],
            format!("{ray}fov = 6.28\nrays = 9"),
        ),
        (
            format!("{force}force.noise_density = [1, 1, 1]"),
            &["write noise, the deviation of each sample: noise_density times the root"],
            format!("{force}force.noise = [10, 10, 10]\nrate = 100"),
        ),
        (
            "[[sensor]]\ntype = 'imu'\nlink = 'a'\nnoise = 0.1".to_owned(),
            &[
                "write angular_velocity.noise = [0.1, 0.1, 0.1], in rad/s, or \
               linear_acceleration.noise = [0.1, 0.1, 0.1], in m/s²; and rate, the samples",
            ],
            "[[sensor]]\ntype = 'imu'\nlink = 'a'\nangular_velocity.noise = [0.1, 0.1, 0.1]\n\
             rate = 100.0"
                .to_owned(),
        ),
        (
            format!("{ray}rays = 3\nfov = 1\nrate = 10\nnoise = 1"),
            &["write distance.noise = 1, in m"],
            format!("{ray}rays = 3\nfov = 1\nrate = 10\ndistance.noise = 1"),
        ),
        (
            "[joint.a.limits]\nlower = 1\nupper = -1".to_owned(),
            &["exchange them"],
            "[joint.a.limits]\nlower = -1\nupper = 1".to_owned(),
        ),
    ] {
        let found = Settings::parse(&text, "robot.toml").expect_err(&text);
        assert_eq!(found.len(), told.len(), "{text}: {found:?}");
        for part in told {
            let has = |d: &Diagnostic| d.help.as_ref().is_some_and(|help| help.contains(part));
            assert!(found.iter().any(has), "{text}: {part}: {found:?}");
        }
        let whole = Settings::parse(&mended, "robot.toml");
        assert!(whole.is_ok(), "{mended}: {whole:?}");
    }
}

/// The assembly would tell of the same joint that it has no range.
#[test]
fn exchanged_limits_are_left_out_once_they_are_told() {
    let text = "[joint.a.limits]\nlower = 1\nupper = -1";
    let (settings, findings) = Settings::read_by(Reader::new("f", text), None);
    assert_eq!(findings.len(), 1, "{findings:?}");
    let joint = &settings.expect("the rest").joints[0];
    assert_eq!((joint.lower, joint.upper), (None, None));
}

#[test]
fn keys_that_mean_nothing_beside_another_one_are_told() {
    for (text, key) in [
        (
            "[world.ground]\ntype = \"none\"\nfriction = 0.5",
            "friction",
        ),
        (
            "[world.ground]\ntype = \"none\"\nrestitution = 0.5",
            "restitution",
        ),
        (
            "[[spring]]\nlinks = [\"a\", \"b\"]\ndamping = 1\nlength = 0.1",
            "length",
        ),
    ] {
        let found = finding(text);
        let told = format!("'{key}' has no meaning");
        assert_eq!(found.code, "S106", "{text}: {found:?}");
        assert!(found.message.starts_with(&told), "{text}: {found:?}");
    }
}

/// Tables of others, which have a name, are not what was meant.
#[test]
fn the_name_of_a_joint_is_its_joint() {
    let found = Settings::parse("[[actuator]]\nname = \"a\"", "robot.toml").expect_err("two");
    let unknown = found.iter().find(|found| found.code == "S102");
    let help = unknown.and_then(|found| found.help.as_deref());
    let told = help.is_some_and(|help| help.starts_with("did you mean 'joint'?"));
    assert!(told, "{found:?}");
}

/// What the advice says is written, and the same is not refused again.
#[test]
fn advice_for_settings_can_be_followed_as_it_stands() {
    let cases = [
        // A value, the advice, and what it leads to, which may lack other keys alone.
        (
            "[initial]\njoints = [0.1, 0.2]",
            "joints = { \"name or glob\" = 0.1 }",
        ),
        (
            "[robot]\nfixed_base = true",
            "it takes \"auto\" or \"floating\" or \"fixed\"",
        ),
        (
            "[outputs]\ncontacts = \"hand\"",
            "write contacts = [\"hand\"]; [\"*\"] means all",
        ),
        (
            "[outputs]\ncontacts = \"non\"",
            "write contacts = \"none\", or contacts = [\"non\"]",
        ),
        (
            "[world]\ngravity = \"0 0 -9.81\"",
            "write gravity = [0, 0, -9.81]",
        ),
        ("[world]\ngravity = -9.81", "what it is: m/s²"),
        ("[contact]\ndamping = 10", "'dissipation'"),
        ("[fmu]\ninterface = \"co-simulation\"", "'cs'"),
        (
            "[fmu]\nfmi = 3.0",
            "what it is: version of the Functional Mock-up Interface: 2",
        ),
        (
            "[solver]\nstep_size = 240",
            "what it is: s; 0: error controlled",
        ),
        (
            "[[world.object]]\nname = \"a\"\nshape = { cylinder = [1, 2, 3] }",
            "radius and length",
        ),
        (
            "[[world.object]]\nname = \"a\"\nshape = { sphere = 1 }\nmass = 0",
            "is static or driven",
        ),
        (
            "[[world.object]]\nname = \"a\"\nshape = { type = \"box\" }",
            "shape = { box = [",
        ),
        (
            "[[spring]]\nstiffness = 1",
            "links = [\"a name\", \"another name\"]",
        ),
        (
            "[[loop]]\ntype = \"gear\"\nratio = 2",
            "joints = [\"a name\", \"another name\"]",
        ),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"a\"]",
            "links = [\"a name\", \"another name\"]",
        ),
        (
            "[[loop]]\ntype = \"hinge\"\nlinks = [\"a\", \"b\"]\naxes = [[0, 0, 0], [0, 1, 0]]",
            "axes =",
        ),
        (
            "[[spring]]\nlinks = [\"a\", \"b\"]\nstiffness = 1\nrest_length = 1",
            "'length'",
        ),
        (
            "[robot]\nbase = \"fixed\",\nscale = 1",
            "leave the comma out",
        ),
        (
            "[world]\ngravity = [0, 0, -9.81\n",
            "the bracket or the quotation mark",
        ),
        ("[robot]\rscale = 1\r", "line ends of Unix or Windows"),
    ];
    for (text, part) in cases {
        let found = Settings::parse(text, "robot.toml").expect_err(text);
        let advice = found.iter().filter_map(|f| f.help.as_deref());
        assert_eq!(
            advice.filter(|h| h.contains(part)).count(),
            1,
            "{text}: {found:?}"
        );
    }
    for text in [
        "[initial]\njoints = { \"name or glob\" = 0.1 }",
        "[outputs]\ncontacts = [\"hand\"]",
        "[world]\ngravity = [0, 0, -9.81]",
        "[[spring]]\nstiffness = 1\nlinks = [\"a name\", \"another name\"]",
        "[[loop]]\ntype = \"gear\"\nratio = 2\njoints = [\"a name\", \"another name\"]",
    ] {
        Settings::parse(text, "robot.toml").expect(text);
    }
}

/// A second thing of one name is told once, and nothing follows from it.
#[test]
fn a_second_thing_of_one_name_is_left_out_of_the_world() {
    let object = "[[world.object]]\nname = \"a\"\nshape = { sphere = 1 }\nmass = 1\n";
    let found = Settings::parse(&object.repeat(2), "robot.toml").expect_err("two of one name");
    assert_eq!(found.len(), 1, "{found:?}");
    let text = object.repeat(2);
    let mut reader = Reader::new("robot.toml", &text);
    let root = reader.read();
    assert_eq!(fill(&mut reader, &root, None).objects.len(), 1);
}
