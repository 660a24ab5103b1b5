//! `check`: findings and exit codes.

use super::*;

#[test]
fn check_reports_for_people_and_for_programs() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("odd.urdf");
    let original = fs::read_to_string(example("rover.urdf")).unwrap();
    fs::write(&urdf, original.replacen("<mass ", "<colour/><mass ", 1)).unwrap();
    let run = urdf2fmu(["check", text(&urdf)]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("warning["), "{}", run.out);

    let denied = urdf2fmu(["check", text(&urdf), "--deny", "warnings"]);
    assert_eq!(denied.code, 1, "{denied:?}");

    let json = urdf2fmu(["check", text(&urdf), "--json"]);
    let value: Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!(value["ok"], true);
    let findings = value["findings"].as_array().unwrap();
    let warning = findings
        .iter()
        .find(|f| f["severity"] == "warning")
        .unwrap();
    assert!(warning["line"].as_u64().unwrap() > 1, "{warning}");

    assert_eq!(urdf2fmu(["check", text(&example("rover.urdf"))]).code, 0);
}

#[test]
fn unknown_setting_is_refused_with_its_place_and_the_nearest_known_one() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("s.toml");
    fs::write(&settings, "[contact]\npenetratoin = 1e-4\n").unwrap();
    let rover = example("rover.urdf");
    let run = urdf2fmu(["check", text(&rover), "-c", text(&settings)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(
        run.err.contains("s.toml:2:") && run.err.contains("penetration"),
        "{}",
        run.err
    );
}
