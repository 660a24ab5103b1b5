//! Output of the command: files are complete or missing, and a failure is never reported as
//! success.

use super::*;
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};

/// Runs a shell's command line in `folder`; `$urdf2fmu` is the command, `$rover` a robot, `$fmu`
/// its FMU, `$export` what exports without pictures and pages.
fn shell(folder: &Path, line: &str) -> Run {
    let output = Command::new("sh")
        .args(["-c", line])
        .current_dir(folder)
        .env("urdf2fmu", env!("CARGO_BIN_EXE_urdf2fmu"))
        .env("rover", example("rover.urdf"))
        .env("export", "export --no-documentation")
        .env("fmu", folder.join("rover.fmu"))
        .output()
        .unwrap();
    Run {
        code: output.status.code().expect("no signal ends it"),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

/// A folder with the rover's FMU, and a table of a run of it.
fn with_fmu() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let run = shell(
        folder.path(),
        "\"$urdf2fmu\" $export \"$rover\" -o \"$fmu\"",
    );
    assert_eq!(run.code, 0, "{run:?}");
    let table = "time,base.position.x\n0,0\n1,0.5\n";
    fs::write(folder.path().join("run.csv"), table).unwrap();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// All commands that write a file, to `$to`, but for `view`, which does not end by itself.
const WRITERS: [&str; 8] = [
    "\"$urdf2fmu\" $export \"$rover\" -o \"$to\"",
    "\"$urdf2fmu\" simulate \"$fmu\" --stop-time 0.01 --output-file \"$to\"",
    "\"$urdf2fmu\" simulate \"$fmu\" --stop-time 0.01 --plot \"$to\"",
    "\"$urdf2fmu\" simulate \"$fmu\" --stop-time 0.01 --report \"$to\"",
    "\"$urdf2fmu\" report run.csv --model \"$fmu\" -o \"$to\"",
    "\"$urdf2fmu\" picture \"$rover\" --size 32 -o \"$to\"",
    "\"$urdf2fmu\" init \"$rover\" -o \"$to\"",
    "\"$urdf2fmu\" init \"$rover\" --ssv -o \"$to\"",
];

fn write_to(folder: &Path, writer: &str, to: &str) -> Run {
    shell(folder, &format!("to='{to}'; {writer}"))
}

#[test]
fn a_symbolic_link_stays_and_its_target_is_written() {
    let folder = with_fmu();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("results")).unwrap();
    for writer in WRITERS {
        fs::write(at("results/target"), "old").unwrap();
        _ = fs::remove_file(at("results/new"));
        for (link, target) in [
            ("first", "results/target"),
            ("second", "first"),
            ("dangling", "results/new"),
        ] {
            _ = fs::remove_file(at(link));
            symlink(target, at(link)).unwrap();
        }
        for link in ["second", "dangling"] {
            let run = write_to(folder.path(), writer, link);
            assert_eq!(run.code, 0, "{run:?}");
            assert!(at(link).is_symlink(), "{link}");
        }
        assert!(fs::read(at("results/target")).unwrap().len() > 100);
        assert!(fs::read(at("results/new")).unwrap().len() > 100);
        assert_eq!(names(&at("results")), ["new", "target"]);
    }
}

#[test]
fn a_target_that_is_no_regular_file_is_refused_and_not_changed() {
    let folder = with_fmu();
    fs::create_dir(folder.path().join("folder")).unwrap();
    assert_eq!(
        shell(folder.path(), "mkfifo pipe && ln -s pipe link").code,
        0
    );
    let before = names(folder.path());
    for writer in WRITERS {
        for (to, what) in [
            ("pipe", "a pipe"),
            ("link", "a pipe"),
            ("folder", "a folder"),
            ("/dev/null", "a device"),
            ("/dev/full", "a device"),
        ] {
            let run = write_to(folder.path(), writer, to);
            assert_eq!(run.code, 1, "{to}: {run:?}");
            assert!(
                run.err.contains(&format!("'{to}' is {what}"))
                    && run.err.contains("name of a regular file"),
                "{}",
                run.err
            );
        }
        assert_eq!(names(folder.path()), before);
    }
    let record = "\"$urdf2fmu\" view \"$fmu\" --no-open --record \"$to\"";
    for to in ["pipe", "/dev/full"] {
        let run = write_to(folder.path(), record, to);
        assert!(
            run.code == 1 && run.err.contains("name of a regular file"),
            "{run:?}"
        );
    }
    let kind = |path: &str| fs::metadata(folder.path().join(path)).unwrap().file_type();
    assert!(kind("pipe").is_fifo());
    assert!(kind("/dev/null").is_char_device() && kind("/dev/full").is_char_device());
}

/// Versions behind a point belong to the name: files of two robots do not meet in one.
#[test]
fn files_are_named_after_the_robot_with_all_of_its_name() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["rover_v1.0.urdf", "rover_v1.5.urdf", "rover.v2.urdf.xacro"] {
        fs::copy(example("rover.urdf"), folder.path().join(name)).unwrap();
        for line in ["$export", "picture --size 32"] {
            let line = format!("\"$urdf2fmu\" {line} {name}");
            let run = shell(folder.path(), &line);
            assert_eq!(run.code, 0, "{line}: {run:?}");
        }
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    let made = ["rover.v2", "rover_v1.0", "rover_v1.5"];
    let made = made.map(|name| ["fmu", "png"].map(|ending| format!("{name}.{ending}")));
    assert_eq!(names(folder.path()), made.as_flattened());
}

/// `-` is standard output, as for other commands, and what is said about the result goes elsewhere.
#[test]
fn a_dash_is_standard_output() {
    let folder = with_fmu();
    let before = names(folder.path());
    let here = |line: &str| shell(folder.path(), &format!("to=-; {line}"));
    for writer in WRITERS {
        let run = here(&format!("{writer} > piped"));
        assert_eq!((run.code, run.out.as_str()), (0, ""), "{writer}: {run:?}");
        let run = shell(folder.path(), &format!("to=named; {writer}"));
        assert_eq!(run.code, 0, "{writer}: {run:?}");
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
        assert!(read("piped") == read("named"), "{writer}");
        fs::remove_file(folder.path().join("piped")).unwrap();
        fs::remove_file(folder.path().join("named")).unwrap();
        assert_eq!(names(folder.path()), before, "{writer}");
    }
    for wrong in [
        "\"$urdf2fmu\" view \"$fmu\" --no-open --record -",
        "\"$urdf2fmu\" simulate \"$fmu\" --output-file - --plot -",
    ] {
        let run = here(wrong);
        assert_eq!(run.code, 1, "{wrong}: {run:?}");
        assert!(run.err.contains("- is standard output, where"), "{run:?}");
    }
}

#[test]
fn a_failed_write_leaves_what_was_there_and_nothing_else() {
    let folder = with_fmu();
    // The table is longer than the FMU's library, which is unpacked before.
    let long = WRITERS[1].replace("--stop-time 0.01", "--stop-time 30");
    for (writer, limit) in [(WRITERS[0], 64), (&long, 6000)] {
        fs::write(folder.path().join("target"), "old").unwrap();
        let before = names(folder.path());
        // No file may grow beyond this many blocks of 512 bytes: what a full disk does, at a place
        // of our choice.
        let run = shell(
            folder.path(),
            &format!("ulimit -f {limit}; to=target; {writer}"),
        );
        assert_eq!(run.code, 1, "{run:?}");
        assert!(run.err.contains("cannot write 'target'"), "{}", run.err);
        assert_eq!(fs::read(folder.path().join("target")).unwrap(), b"old");
        assert_eq!(names(folder.path()), before);
    }
}

#[test]
fn permissions_of_a_file_stay_and_a_protected_one_is_refused() {
    let folder = with_fmu();
    let target = folder.path().join("target");
    for writer in WRITERS {
        for (mode, code) in [(0o600, 0), (0o444, 1)] {
            fs::write(&target, "old").unwrap();
            fs::set_permissions(&target, fs::Permissions::from_mode(mode)).unwrap();
            let run = write_to(folder.path(), writer, "target");
            assert_eq!(run.code, code, "{run:?}");
            assert_eq!(
                run.err.contains("write-protected"),
                code == 1,
                "{}",
                run.err
            );
            assert_eq!(
                fs::metadata(&target).unwrap().permissions().mode() & 0o777,
                mode
            );
            assert_eq!(fs::read(&target).unwrap() == b"old", code == 1);
            fs::remove_file(&target).unwrap();
        }
    }
}

#[test]
fn no_command_overwrites_its_input_file() {
    let folder = with_fmu();
    let at = folder.path();
    fs::copy(example("rover.urdf"), at.join("r.urdf")).unwrap();
    fs::copy(example("rover.toml"), at.join("r.toml")).unwrap();
    fs::write(at.join("in.csv"), "time,cmd.head_joint.velocity\n0,1\n").unwrap();
    for (line, file) in [
        (
            "\"$urdf2fmu\" export r.urdf -c r.toml -o ./r.urdf",
            "r.urdf",
        ),
        ("\"$urdf2fmu\" export r.urdf -c r.toml -o r.toml", "r.toml"),
        (
            "\"$urdf2fmu\" simulate rover.fmu --stop-time 0.01 --output-file rover.fmu",
            "rover.fmu",
        ),
        (
            "\"$urdf2fmu\" simulate r.urdf --stop-time 0.01 --output-file r.urdf",
            "r.urdf",
        ),
        (
            "\"$urdf2fmu\" simulate rover.fmu --input-file in.csv --output-file in.csv",
            "in.csv",
        ),
        (
            "\"$urdf2fmu\" simulate rover.fmu --stop-time 0.01 --report rover.fmu",
            "rover.fmu",
        ),
        (
            "\"$urdf2fmu\" simulate rover.fmu --input-file in.csv --plot in.csv",
            "in.csv",
        ),
        (
            "\"$urdf2fmu\" report run.csv --model rover.fmu -o run.csv",
            "run.csv",
        ),
        ("\"$urdf2fmu\" picture r.urdf -o r.urdf", "r.urdf"),
        (
            "\"$urdf2fmu\" picture rover.fmu --run run.csv -o run.csv",
            "run.csv",
        ),
    ] {
        let before = fs::read(at.join(file)).unwrap();
        let run = shell(at, line);
        assert_eq!(run.code, 1, "{line}: {run:?}");
        assert!(
            run.err.contains("one of the files that are read"),
            "{}",
            run.err
        );
        assert!(fs::read(at.join(file)).unwrap() == before, "{line}");
    }
}

/// Every command that prints a result.
const PRINTERS: [&str; 14] = [
    "$export \"$rover\" -o a.fmu",
    "info \"$rover\"",
    "info \"$fmu\" --json --variables",
    "check \"$rover\"",
    "check \"$rover\" --json",
    "init \"$rover\"",
    "simulate \"$fmu\" --stop-time 0.02",
    "picture \"$rover\" --size 32 -o a.png",
    "expand \"$rover\"",
    "explain",
    "explain U111",
    "view \"$fmu\" --no-open",
    "--help",
    "--version",
];

#[test]
fn a_result_that_cannot_be_printed_gives_an_error_code() {
    let folder = with_fmu();
    for arguments in PRINTERS {
        // A full disk, a closed stream, and one that is open for reading alone.
        for redirection in [">/dev/full", ">&-", "1</dev/null"] {
            let line = format!("\"$urdf2fmu\" {arguments} {redirection}");
            let run = shell(folder.path(), &line);
            assert_eq!(run.code, 1, "{line}: {run:?}");
            let told = "error: cannot write to standard output";
            assert!(run.err.contains(told), "{line}: {run:?}");
        }
    }
}

#[test]
fn a_warning_that_cannot_be_printed_gives_an_error_code_and_no_panic() {
    let folder = with_fmu();
    for arguments in [
        "$export \"$rover\" -o a.fmu",
        "check missing.urdf",
        "simulate \"$fmu\" --stop-time 0.02 --debug-logging --output-file a.csv",
        "no-such-command",
    ] {
        let line = format!("\"$urdf2fmu\" {arguments}");
        let expected = shell(folder.path(), &line);
        for redirection in ["2>/dev/full", "2>&-", "2</dev/null"] {
            let line = format!("{line} {redirection}");
            let run = shell(folder.path(), &line);
            let code = if expected.err.is_empty() {
                0
            } else {
                expected.code.max(1)
            };
            assert_eq!(run.code, code, "{line}: {run:?}\n{expected:?}");
        }
    }
}

#[test]
fn a_closed_pipe_on_standard_output_is_no_error() {
    let folder = with_fmu();
    for arguments in [
        "info \"$fmu\" --json --variables",
        "simulate --quiet \"$fmu\"",
        "simulate \"$fmu\" 2>&1",
        "--help",
    ] {
        let line = format!("{{ \"$urdf2fmu\" {arguments}; echo $? >code; }} | head -c 1");
        let run = shell(folder.path(), &line);
        assert_eq!(run.err, "", "{line}");
        let code = fs::read_to_string(folder.path().join("code")).unwrap();
        assert_eq!(code, "0\n", "{line}");
    }
}

#[test]
fn a_file_that_cannot_be_read_to_its_end_is_reported() {
    let folder = with_fmu();
    for line in [
        // Opening a folder succeeds, reading from it fails.
        "\"$urdf2fmu\" info .",
        "\"$urdf2fmu\" check /dev/stdin </",
        "\"$urdf2fmu\" check \"$rover\" -c .",
        "\"$urdf2fmu\" simulate \"$fmu\" --input-file .",
        "\"$urdf2fmu\" simulate \"$fmu\" --input-file /dev/stdin </",
    ] {
        let run = shell(folder.path(), line);
        assert_eq!(run.code, 1, "{line}: {run:?}");
        let words = ["cannot read", "cannot be read", "folder", "directory"];
        assert!(words.iter().any(|w| run.err.contains(w)), "{run:?}");
    }
}

#[test]
fn an_fmu_that_cannot_be_unpacked_is_reported() {
    let folder = with_fmu();
    let line = "ulimit -f 64; \"$urdf2fmu\" simulate \"$fmu\" --stop-time 0.02";
    let run = shell(folder.path(), line);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.err.contains("cannot unpack"), "{}", run.err);
    let run = shell(
        folder.path(),
        "TMPDIR=/no/such/folder \"$urdf2fmu\" simulate \"$fmu\" --stop-time 0.02",
    );
    assert_eq!(run.code, 1, "{run:?}");
    let told = "cannot make a temporary folder in '/no/such/folder', where TMPDIR";
    assert!(run.err.contains(told), "{}", run.err);
}

#[test]
fn failed_export_leaves_the_old_fmu_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (urdf, target) = (folder.path().join("a.urdf"), folder.path().join("a.fmu"));
    fs::write(&urdf, "<robot/>").unwrap();
    fs::write(&target, "precious").unwrap();
    let run = urdf2fmu(["export", text(&urdf), "-o", text(&target)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert_eq!(fs::read_to_string(&target).unwrap(), "precious");
}
