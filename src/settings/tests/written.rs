//! How values and files are written.

use super::*;

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
