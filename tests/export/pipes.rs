//! Inputs that are no files: pipes, folders, sockets and devices are told as what they are, and
//! nothing waits for a pipe that nobody writes to.

use super::people::write;
use super::*;
use std::os::unix::net::UnixListener;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Longest time that a command may take which reads nothing: it would wait for ever otherwise.
const LONGEST: Duration = Duration::from_mins(2);

/// Runs a shell's command line in `folder` and kills it if it does not end.
fn ended(folder: &Path, line: &str) -> Run {
    let [out, err] = ["out.txt", "err.txt"].map(|name| folder.join(name));
    let file = |path: &Path| Stdio::from(fs::File::create(path).unwrap());
    let mut child = Command::new("bash")
        .args(["-c", &format!("exec {line}")])
        .current_dir(folder)
        .env("urdf2fmu", env!("CARGO_BIN_EXE_urdf2fmu"))
        .stdin(Stdio::null())
        .stdout(file(&out))
        .stderr(file(&err))
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if begun.elapsed() > LONGEST {
            child.kill().unwrap();
            panic!("it waits: {line}");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    Run {
        code: status.code().expect("no signal ends it"),
        out: fs::read_to_string(out).unwrap(),
        err: fs::read_to_string(err).unwrap(),
    }
}

/// A folder with a robot, its FMU, its settings and a run, and one of each kind that is no file,
/// with the endings of those.
fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::copy(example("rover.urdf"), at.join("r.urdf")).unwrap();
    write(at, "s.toml", "[robot]\nscale = 1.0\n");
    let run = "time,base.position.x\n0,0\n1,0.5\n";
    write(at, "run.csv", run);
    write(at, "in.csv", "time,world.gravity.z\n0,-9.81\n");
    let done = ended(
        at,
        "\"$urdf2fmu\" export --no-documentation r.urdf -o r.fmu",
    );
    assert_eq!(done.code, 0, "{done:?}");
    for ending in ["fmu", "urdf", "toml", "csv", "srdf", "stl", "png", "xacro"] {
        let pipe = at.join(format!("pipe.{ending}"));
        let made = Command::new("mkfifo").arg(pipe).status().unwrap();
        assert!(made.success(), "{made}");
        fs::create_dir(at.join(format!("folder.{ending}"))).unwrap();
        drop(UnixListener::bind(at.join(format!("socket.{ending}"))).unwrap());
    }
    folder
}

/// Each command with what it reads in place of `{}`, and the ending of that.
const READERS: [(&str, &str); 25] = [
    ("info {}", "fmu"),
    ("simulate {}", "fmu"),
    ("picture {} -o x.png", "fmu"),
    ("report run.csv --model {} -o x.html", "fmu"),
    ("view {} --no-open --port 0", "fmu"),
    ("check {}", "fmu"),
    ("check {}", "urdf"),
    ("info {}", "urdf"),
    ("export {} -o x.fmu", "urdf"),
    ("simulate {}", "urdf"),
    ("picture {} -o x.png", "urdf"),
    ("init {} -o x.toml", "urdf"),
    ("expand {}", "xacro"),
    ("check {}", "xacro"),
    ("check r.urdf -c {}", "toml"),
    ("init r.urdf --ssv -c {} -o x.ssv", "toml"),
    ("check r.urdf --srdf {}", "srdf"),
    ("check r.urdf --object {}", "urdf"),
    ("simulate r.fmu --input-file {}", "csv"),
    ("view r.fmu --no-open --port 0 --input-file {}", "csv"),
    ("report {} --model r.fmu -o x.html", "csv"),
    ("picture r.fmu --run {} -o x.png", "csv"),
    ("check r.urdf -c heights.toml", "png"),
    ("check r.urdf -c mesh.toml", "stl"),
    ("check r.urdf -c others.toml", "urdf"),
];

#[test]
fn what_is_no_file_is_told_and_not_waited_for() {
    let folder = scene();
    let terrain = |kind: &str, file: &str| {
        let size = if kind == "mesh" { "" } else { "size = [9, 9]" };
        format!("[[world.terrain]]\nname = 't'\ntype = '{kind}'\nfile = '{file}'\n{size}\n")
    };
    for what in ["pipe", "folder", "socket"] {
        for (name, text) in [
            (
                "heights.toml",
                terrain("heightfield", &format!("{what}.png")),
            ),
            ("mesh.toml", terrain("mesh", &format!("{what}.stl"))),
            (
                "others.toml",
                format!("[[world.object]]\nname = 'o'\nurdf = '{what}.urdf'\n"),
            ),
        ] {
            write(folder.path(), name, text);
        }
        for (command, ending) in READERS {
            let file = format!("{what}.{ending}");
            let line = format!("\"$urdf2fmu\" {}", command.replace("{}", &file));
            let done = ended(folder.path(), &line);
            assert_eq!(done.code, 1, "{line}: {done:?}");
            let told = format!("is a {what}");
            // `check` takes no FMU, whatever is in it.
            let told = done.err.contains(&told) || done.err.contains("is an FMU");
            assert!(told && done.err.contains(&file), "{line}: {done:?}");
        }
    }
}

#[test]
fn devices_without_an_end_are_read_up_to_a_size() {
    let folder = scene();
    for line in [
        "check /dev/zero",
        "check r.urdf -c /dev/zero",
        "check r.urdf --srdf /dev/zero",
        "simulate r.fmu --input-file /dev/zero",
        "report /dev/zero --model r.fmu -o x.html",
        "picture r.fmu --run /dev/zero -o x.png",
    ] {
        let done = ended(folder.path(), &format!("\"$urdf2fmu\" {line}"));
        let told = done.err.contains("more than") && done.err.contains(" bytes");
        assert!(done.code == 1 && told, "{line}: {done:?}");
    }
}

/// What the shell has opened begins at once, and a text is read once. What is put into an FMU has
/// to be read again, and was empty there.
#[test]
fn texts_are_read_from_what_the_shell_has_opened() {
    let folder = scene();
    for (line, code) in [
        ("check <(cat r.urdf)", 0),
        ("check r.urdf -c <(cat s.toml)", 0),
        (
            "simulate r.fmu --stop-time 0.01 --input-file <(cat in.csv)",
            0,
        ),
        (
            "simulate <(cat r.urdf) --stop-time 0.01 -c <(cat s.toml)",
            0,
        ),
        ("report <(cat run.csv) --model r.fmu -o x.html", 0),
        ("export <(cat r.urdf) -o x.fmu", 1),
        ("export r.urdf -c <(cat s.toml) -o x.fmu", 1),
    ] {
        let done = ended(folder.path(), &format!("\"$urdf2fmu\" {line}"));
        assert_eq!(done.code, code, "{line}: {done:?}");
        let told = done
            .err
            .contains("again, to put it into the FMU: it is a pipe");
        assert_eq!(told, code == 1, "{line}: {done:?}");
    }
}
