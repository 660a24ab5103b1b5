//! What a message offers helps: each broken robot is changed, or read again, as its findings say.
//!
//! Nothing here is compared with recorded text: places are found again in the file, and remedies
//! are carried out.

use super::*;

#[path = "../robots/broken.rs"]
#[allow(dead_code, reason = "the expected findings are another test's")]
mod broken;

use broken::Broken;

/// Findings of a check: whether the robot loads, and the list.
fn check(path: &Path, options: &[&str]) -> (bool, Vec<Value>) {
    let mut words = vec!["check", text(path), "--json"];
    words.extend(options);
    let done = run_in(Path::new("."), &words, &[]);
    let value: Value = serde_json::from_str(&done.out).unwrap_or_else(|_| panic!("{done:?}"));
    let list = value["findings"].as_array().expect("a list").clone();
    (value["ok"] == true, list)
}

fn field<'f>(finding: &'f Value, name: &str) -> &'f str {
    finding[name].as_str().unwrap_or_default()
}

/// What stands between the last pair of quotes.
fn quoted(message: &str) -> Option<&str> {
    let (before, _) = message.rsplit_once('\'')?;
    Some(before.rsplit_once('\'')?.1)
}

/// The broken robots as files, where those with meshes find them.
fn robots(folder: &Path) -> Vec<(Broken, PathBuf)> {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let meshes = folder.join("meshes");
    fs::create_dir(&meshes).unwrap();
    for entry in fs::read_dir(project.join("tests/robots/broken/meshes")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, meshes.join(path.file_name().unwrap())).unwrap();
    }
    let all = broken::read(&project).into_iter().map(|robot| {
        let path = folder.join(format!("{}.urdf", robot.name));
        fs::write(&path, &robot.urdf).unwrap();
        (robot, path)
    });
    all.collect()
}

/// The line that a finding names holds the word that it quotes; where it suggests another word, the
/// file with that word has no such finding.
#[test]
fn a_finding_s_line_holds_its_word_and_the_suggested_word_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    let (mut places, mut mended) = (0, 0);
    for (robot, path) in robots(folder.path()) {
        let (_, findings) = check(&path, &[]);
        let source = String::from_utf8_lossy(&robot.urdf).into_owned();
        let lines: Vec<&str> = source.split('\n').collect();
        for finding in &findings {
            let (code, message) = (field(finding, "code"), field(finding, "message"));
            let number = usize::try_from(finding["line"].as_u64().unwrap_or(0)).unwrap();
            let name = &robot.name;
            let word = match code {
                "U016" | "U019" | "U030" | "U032" | "U040" | "U070" => {
                    let tag = message
                        .split_once('<')
                        .and_then(|(_, rest)| rest.split_once('>'));
                    let unknown_tag = code == "U070" || message.contains("> is unknown");
                    let word = if unknown_tag {
                        tag.map(|(tag, _)| tag)
                    } else {
                        quoted(message)
                    };
                    word.unwrap_or_else(|| panic!("{name}: {message}"))
                }
                _ => continue,
            };
            // "1e-12" is how a number is written that the file may write otherwise.
            if message.contains(" must be a number from ") {
                continue;
            }
            let line = lines
                .get(number.wrapping_sub(1))
                .copied()
                .unwrap_or_default();
            assert!(line.contains(word), "{name} line {number}: {message}");
            places += 1;
            let help = field(finding, "help");
            let Some(other) = help
                .strip_prefix("did you mean '")
                .and_then(|h| h.strip_suffix("'?"))
            else {
                continue;
            };
            // An element ends with its name, too.
            let whole_line = |line: &str| line.replace(word, other);
            let changed: Vec<String> = lines
                .iter()
                .enumerate()
                .map(|(at, line)| {
                    let ends = code != "U016" && line.contains(&format!("</{word}>"));
                    if at + 1 == number || ends {
                        whole_line(line)
                    } else {
                        (*line).to_owned()
                    }
                })
                .collect();
            let again = folder.path().join("again.urdf");
            fs::write(&again, changed.join("\n")).unwrap();
            let (_, left) = check(&again, &[]);
            let same = left.iter().any(|f| {
                ["code", "message", "line"]
                    .iter()
                    .all(|key| f[key] == finding[key])
            });
            assert!(
                !same,
                "{name}: '{other}' for '{word}' changes nothing: {message}"
            );
            mended += 1;
        }
    }
    assert!(
        places > 70 && mended > 25,
        "{places} places, {mended} words"
    );
}

/// Ways that a help offers: options.
fn offered(help: &str) -> Vec<Vec<&str>> {
    let ways = help.lines().filter_map(|line| {
        let options = ["--inertia", "--density", "--missing-mass", "--compat"];
        let from = options
            .iter()
            .filter_map(|option| line.find(option))
            .min()?;
        let part = line[from..].split([',', '(']).next()?;
        Some(part.split_whitespace().collect())
    });
    ways.collect()
}

/// A robot that is refused for its inertias loads with each of the ways that are offered, and no
/// second message of the kind comes.
#[test]
fn each_command_that_is_offered_makes_the_robot_load() {
    let folder = tempfile::tempdir().unwrap();
    let mut tried = 0;
    for (robot, path) in robots(folder.path()) {
        let (ok, findings) = check(&path, &[]);
        let errors = findings.iter().filter(|f| f["severity"] == "error");
        let helps: Vec<&str> = errors.map(|f| field(f, "help")).collect();
        // Beside other faults nothing makes it load.
        let of_inertia = |f: &Value| ["A104", "A105", "U061"].contains(&field(f, "code"));
        let mut errors = findings.iter().filter(|f| f["severity"] == "error");
        let alone = errors.all(of_inertia);
        for options in helps.iter().flat_map(|help| offered(help)) {
            assert!(!ok);
            if !alone {
                continue;
            }
            let (loads, left) = check(&path, &options);
            assert!(loads, "{}: {options:?}: {left:?}", robot.name);
            tried += 1;
        }
    }
    assert!(tried > 8, "{tried} ways");
}
