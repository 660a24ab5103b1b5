//! Every broken robot of `tests/robots/broken/robots.txt` gives exactly the findings that are
//! listed there.

#[path = "robots/broken.rs"]
mod broken;
#[path = "../src/testing/random.rs"]
#[allow(dead_code, missing_docs, reason = "shared with the unit tests")]
mod random;

use broken::Broken;
use random::Random;
use std::collections::HashSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::urdf::{Description, ReadOptions, read, read_str};

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// CPU time of this thread, s, which other work on the machine does not affect.
#[cfg(unix)]
fn now() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    let t = std::time::Duration::try_from(t).expect("a time that has passed");
    t.as_secs_f64()
}

/// Wall time since the first call, s: there is no CPU clock without `unsafe` here.
#[cfg(not(unix))]
fn now() -> f64 {
    static START: LazyLock<std::time::Instant> = LazyLock::new(std::time::Instant::now);
    START.elapsed().as_secs_f64()
}

/// Copies the files of a folder that has no folders in it.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("target/ is writable");
    for entry in fs::read_dir(from).expect("the folder") {
        let path = entry.expect("an entry").path();
        if path.is_file() {
            fs::copy(&path, to.join(path.file_name().expect("a name"))).expect("a copy");
        }
    }
}

/// The broken robots as files with their meshes, in a folder beside one with sound meshes.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("broken");
    if place.exists() {
        fs::remove_dir_all(&place).expect("the last run's folder can be removed");
    }
    // Not named like a part of a robot, whose parent folder would count as the robot's, too.
    let folder = place.join("cases");
    copy(
        &project().join("tests/robots/broken/meshes"),
        &folder.join("meshes"),
    );
    copy(
        &project().join("tests/robots/meshes"),
        &place.join("meshes"),
    );
    for robot in broken::read(project()) {
        fs::write(file(&folder, &robot), &robot.urdf).expect("target/ is writable");
    }
    folder
});

fn file(folder: &Path, robot: &Broken) -> PathBuf {
    folder.join(format!("{}.urdf", robot.name))
}

struct Expected {
    severity: Severity,
    code: String,
    line: usize,
    fragment: String,
}

fn expected(robot: &Broken) -> Vec<Expected> {
    let lines = robot.expected.iter().map(|line| {
        let mut words = line.splitn(4, ' ');
        let mut word = || words.next().expect("four words");
        Expected {
            severity: match word() {
                "error" => Severity::Error,
                "warning" => Severity::Warning,
                "note" => Severity::Note,
                other => panic!("{}: '{other}' is no severity", robot.name),
            },
            code: word().to_owned(),
            line: word().parse().expect("a line number"),
            fragment: word().to_owned(),
        }
    });
    lines.collect()
}

fn matches(found: &Diagnostic, expected: &Expected) -> bool {
    found.severity == expected.severity
        && found.code == expected.code
        && found
            .place
            .as_ref()
            .is_some_and(|p| p.line == expected.line)
        && found.message.contains(&expected.fragment)
}

#[test]
fn every_broken_file_gives_its_expected_findings() {
    let robots = broken::read(project());
    // What counts: a text of its own, of which an error or a warning is told.
    let told = |robot: &&Broken| robot.expected.iter().any(|line| !line.starts_with("note "));
    let careless: HashSet<&[u8]> = robots.iter().filter(told).map(|r| &r.urdf[..]).collect();
    assert!(careless.len() >= 200, "{} inputs", careless.len());
    let mut wrong = String::new();
    for robot in robots {
        let name = format!("{}.urdf", robot.name);
        let expected = expected(&robot);
        let result = read(&file(&FOLDER, &robot), &ReadOptions::default());
        let refused = result.is_err();
        let found = result.map_or_else(|list| list, |description| description.diagnostics);
        let errors = |d: &&Diagnostic| d.severity == Severity::Error;
        let must_refuse = expected.iter().any(|e| e.severity == Severity::Error);
        let exact = found.iter().filter(errors).count()
            == expected
                .iter()
                .filter(|e| e.severity == Severity::Error)
                .count();
        let all = expected.iter().all(|e| found.iter().any(|d| matches(d, e)));
        if refused != must_refuse || !exact || !all {
            writeln!(wrong, "--- {name}").expect("a string");
            for finding in &found {
                writeln!(wrong, "{finding}").expect("a string");
            }
        }
        // What a user sees names the file and its line.
        for finding in found.iter().filter(errors) {
            let place = finding
                .place
                .as_ref()
                .expect("errors in a file have a place");
            let shown = finding.to_string();
            assert!(
                shown.contains(&format!("{name}:{}:", place.line)),
                "{shown}"
            );
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_help_for_xacro_is_the_command_line() {
    let text = "<robot name='r'><xacro:include filename='a'/></robot>";
    let read = |file| read_str(text, file, Path::new("."), &ReadOptions::default());
    let help = |file| {
        read(file).expect_err("xacro")[0]
            .help
            .clone()
            .unwrap_or_default()
    };
    assert!(
        help("robots/arm.urdf.xacro").contains("xacro robots/arm.urdf.xacro -o robots/arm.urdf\n")
    );
    assert!(help("my arm.xacro").contains("xacro 'my arm.xacro' -o 'my arm.urdf'\n"));
}

/// Each is of a public robot, and was mended as told: the first with a comma after each number, the
/// second gets a prefix for each hand, and in the third a link would hang on itself.
#[test]
fn who_mends_what_is_told_finds_nothing_more_of_it() {
    let link = "<link name='base'/><link name='table_link'/>";
    let joint = |origin: &str, parent: &str| {
        format!(
            "{link}<joint name='base_to_table' type='fixed'><origin xyz='{origin}'/>\
             <parent link='{parent}'/><child link='table_link'/></joint>"
        )
    };
    let finger = |name: &str, parent: &str, more: &str| {
        format!(
            "<link name='{name}'/><joint name='{name}_q' type='continuous'><parent link='{parent}'/>\
             <child link='{name}'/>{more}</joint>"
        )
    };
    let hands = [
        "<link name='base'/>".to_owned(),
        finger("Left_index", "base", ""),
        finger("Right_index", "base", ""),
        finger("Right_tip", "Right_index", "<mimic joint='index_q'/>"),
    ];
    for (body, message, help) in [
        (
            joint("0.07, 0, 0", "base"),
            "'0.07,' is not a number, nor is '0,'",
            None,
        ),
        (
            hands.concat(),
            "<mimic> names joint 'index_q', which does not exist",
            Some("did you mean 'Right_index_q'?"),
        ),
        (
            joint("0 0 0", "base_link"),
            "parent link 'base_link' does not exist",
            None,
        ),
        (
            joint("0 0 0", "tabel_link"),
            "parent link 'tabel_link' does not exist",
            None,
        ),
    ] {
        let text = format!("<robot name='r'>{body}</robot>");
        let read = read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default());
        let list = read.expect_err(message);
        let mut errors = list.iter().filter(|d| d.severity == Severity::Error);
        let found = errors.find(|d| d.message.contains(message));
        let found = found.unwrap_or_else(|| panic!("{message}: {list:?}"));
        if let Some(help) = help {
            assert_eq!(found.help.as_deref(), Some(help));
        }
        let itself = found
            .help
            .as_deref()
            .is_some_and(|help| help.contains("'table_link'"));
        assert!(!itself, "{found}");
    }
}

#[test]
fn a_missing_file_and_a_folder_are_errors_without_a_place() {
    for path in [FOLDER.join("no_such_file.urdf"), FOLDER.clone()] {
        let list = read(&path, &ReadOptions::default()).expect_err("nothing to read");
        assert_eq!(list.len(), 1);
        assert_eq!((list[0].code, list[0].place.is_none()), ("U001", true));
    }
}

#[test]
fn a_scale_that_is_not_positive_is_an_error() {
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = ReadOptions {
            scale,
            ..ReadOptions::default()
        };
        let text = "<robot name='r'><link name='a'/></robot>";
        assert!(read_str(text, "r.urdf", Path::new("."), &options).is_err());
    }
}

/// A file of a hundred thousand links, each with the same fault.
#[test]
fn a_flood_of_errors_is_cut_off() {
    let mut text = String::from("<robot name='r'>");
    for _ in 0..100_000 {
        text.push_str("<link name='a'><inertial/></link>");
    }
    text.push_str("</robot>");
    let list =
        read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default()).expect_err("faults");
    assert!(list.len() < 300, "{}", list.len());
    assert!(
        list.last()
            .is_some_and(|d| d.message.contains("more errors"))
    );
}

/// What takes other readers down takes no time and little memory here: refused in the same second.
#[test]
fn hostile_files_are_refused_quickly() {
    let bomb = {
        let mut text = String::from("<!DOCTYPE r [<!ENTITY a0 'ha'>");
        for i in 1..30 {
            write!(text, "<!ENTITY a{i} '&a{};&a{};'>", i - 1, i - 1).expect("a string");
        }
        text + "]><robot name='&a29;'><link name='a'/></robot>"
    };
    let attributes = (0..200_000).fold(String::from("<robot name='r'><link"), |mut text, i| {
        write!(text, " a{i}=''").expect("a string");
        text
    }) + "/></robot>";
    let number = format!(
        "<robot name='r'><link name='a'><inertial><mass value='{}'/>\
         <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>",
        "9".repeat(50_000_000)
    );
    let words = format!(
        "<robot name='r'><link name='a'><collision><geometry><box size='{}'/></geometry></collision></link></robot>",
        "1 ".repeat(20_000_000)
    );
    let kind = format!(
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='{}'><parent link='a'/><child link='b'/>\
         </joint></robot>",
        "revolute".repeat(5_000_000)
    );
    let nested = "<a>".repeat(20_000);
    let nested_in = format!("<robot name='r'>{}", "<link name='a'>".repeat(20_000));
    for (what, text, code) in [
        ("an XML bomb", bomb, "U004"),
        ("nested tags", nested, "U005"),
        ("nested links", nested_in, "U005"),
        ("many attributes", attributes, "U005"),
        ("a number of 50 MB", number, "U032"),
        ("twenty million numbers", words, "U031"),
        ("a word of 40 MB", kind, "U040"),
    ] {
        let start = now();
        let list = read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default())
            .expect_err("it is refused");
        assert!(
            list.iter().any(|d| d.code == code),
            "{what}: {}",
            list[0].code
        );
        let shown: usize = list.iter().map(|d| d.to_string().len()).sum();
        assert!(shown < 20_000, "{what}: {shown} bytes of findings");
        let seconds = now() - start;
        assert!(seconds < 5.0, "{what}: {seconds} s");
    }
}

/// Programs write the largest number that they know where there is no limit. A rover of a public
/// repository has a hundred of these, which hid its only error.
#[test]
fn limits_beyond_all_numbers_are_told_once() {
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    for i in 1..30 {
        let kind = if i == 29 { "hinge" } else { "continuous" };
        write!(
            text,
            "<link name='l{i}'/><joint name='j{i}' type='{kind}'><parent link='l0'/><child link='l{i}'/>\
             <limit effort='1.8e308' velocity='1'/></joint>"
        )
        .expect("a string");
    }
    text.push_str("</robot>");
    let list = read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default())
        .expect_err("there is no joint of this type");
    let with = |code: &str| list.iter().filter(|d| d.code == code).count();
    assert_eq!((with("U032"), with("U040")), (1, 1), "{list:#?}");
}

/// A chain of five thousand links: no pass may recurse or go through all pairs.
#[test]
fn a_long_chain_is_read_in_order() {
    const LINKS: usize = 5000;
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    // From the tip, so that file order is the reverse of tree order.
    for i in (1..LINKS).rev() {
        let up = i - 1;
        write!(
            text,
            "<link name='l{i}'/><joint name='j{i}' type='continuous'><parent link='l{up}'/><child link='l{i}'/></joint>"
        )
        .expect("a string");
    }
    text.push_str("</robot>");
    let robot =
        read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default()).expect("a chain");
    assert_eq!(robot.links.len(), LINKS);
    let in_order = |d: &Description| {
        d.joints
            .iter()
            .enumerate()
            .all(|(i, joint)| joint.parent == i && joint.child == i + 1)
    };
    assert!(in_order(&robot));
}

/// Random changes to valid files: an answer, never a panic, and errors have places.
#[test]
fn mutated_files_never_panic() {
    let mut random = Random(0x2545_F491_4F6C_DD1D);
    let sources: Vec<Vec<u8>> = broken::read(project())
        .into_iter()
        .map(|robot| robot.urdf)
        .chain(vec![include_bytes!("robots/every_tag.urdf").to_vec(); 40])
        .filter(|bytes| bytes.len() < 10_000)
        .collect();
    let words: [&[u8]; 24] = [
        b"<",
        b">",
        b"/>",
        b"\"",
        b"&",
        b"&lt;",
        b"<!--",
        b"]]>",
        b"<![CDATA[",
        b"nan",
        b"-",
        b"1e308",
        b"0",
        b" ",
        b"\n",
        b"\0",
        b"\xff",
        b"<link name=\"a\">",
        b"</link>",
        b"<robot>",
        b"<?xml?>",
        b"revolute",
        b"planar",
        b"floating",
    ];
    let mut read_well = 0;
    for round in 0..2000 {
        let mut bytes = sources[random.below(sources.len())].clone();
        for _ in 0..=random.below(3) {
            let at = random.below(bytes.len() + 1);
            let end = (at + random.below(12)).min(bytes.len());
            match random.below(8) {
                0 => drop(bytes.drain(at..end)),
                1 => drop(bytes.splice(at..end, words[random.below(words.len())].iter().copied())),
                2 => drop(bytes.splice(at..at, words[random.below(words.len())].iter().copied())),
                3 => {
                    // A piece from elsewhere in the file.
                    let from = random.below(bytes.len() + 1);
                    let to = (from + random.below(200)).min(bytes.len());
                    let piece = bytes[from..to].to_vec();
                    drop(bytes.splice(at..at, piece));
                }
                4 => bytes.truncate(at),
                // A digit, which leaves most files robots.
                _ => {
                    let digits: Vec<usize> = (0..bytes.len())
                        .filter(|&i| bytes[i].is_ascii_digit())
                        .collect();
                    if !digits.is_empty() {
                        bytes[digits[random.below(digits.len())]] =
                            b"0123456789.-e"[random.below(13)];
                    }
                }
            }
        }
        let text = String::from_utf8_lossy(&bytes);
        match read_str(&text, "mutated.urdf", &FOLDER, &ReadOptions::default()) {
            Ok(robot) => {
                read_well += 1;
                assert_eq!(robot.links.len(), robot.joints.len() + 1, "round {round}");
                for (i, joint) in robot.joints.iter().enumerate() {
                    assert!(joint.child == i + 1 && joint.parent <= i, "round {round}");
                }
            }
            Err(list) => {
                let errors = list.iter().filter(|d| d.severity == Severity::Error);
                assert!(
                    errors.count() > 0,
                    "round {round}: refused without an error\n{text}"
                );
                for finding in &list {
                    assert!(!finding.to_string().is_empty());
                }
            }
        }
    }
    // Else the changes are too rough to reach the later checks.
    assert!(read_well > 100, "only {read_well} of 4000 are still robots");
}

/// A link that moves without a mass is an error (A104), so that nobody is sent there.
#[test]
fn the_advice_about_masses_is_for_links_that_move_too() {
    for (mass, inertia, code) in [
        ("-1", "1", "U060"),
        ("1e-13", "1", "U064"),
        ("0", "1", "U064"),
    ] {
        let text = format!(
            "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='{mass}'/>\
             <inertia ixx='{inertia}' iyy='{inertia}' izz='{inertia}' ixy='0' ixz='0' iyz='0'/>\
             </inertial></link><joint name='j' type='continuous'><parent link='a'/>\
             <child link='b'/></joint></robot>"
        );
        let read = read_str(&text, "r.urdf", Path::new("."), &ReadOptions::default());
        let found = read.map_or_else(|errors| errors, |robot| robot.diagnostics);
        let told = found.iter().find(|finding| finding.code == code);
        let help = told.and_then(|told| told.help.clone()).unwrap_or_default();
        let sound = help.starts_with("give ") && help.contains("a frame that does not move");
        assert!(sound, "{mass}: {found:?}");
    }
}
