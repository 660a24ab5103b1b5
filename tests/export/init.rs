//! `init`: settings to start from.

use super::*;

/// What `init` writes says what holds: exporting with it changes nothing, nor with all its lines
/// made active.
#[test]
fn init_writes_settings_that_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("init.toml");
    for name in EXAMPLES {
        for options in [
            &[][..],
            &["--fixed-base"],
            &["--floating-base", "--naming", "flat", "--mode", "pd"],
        ] {
            let urdf = example(&format!("{name}.urdf"));
            let mut args = vec!["init", text(&urdf)];
            args.extend(options);
            let run = run_in(Path::new("."), &args, &[]);
            assert_eq!(run.code, 0, "{run:?}");
            let active: String = run
                .out
                .lines()
                .map(|line| match line.strip_prefix('#') {
                    Some(rest) if !rest.starts_with(' ') => format!("{rest}\n"),
                    _ => format!("{line}\n"),
                })
                .collect();
            assert_ne!(active, run.out);
            let (_kept, plain) = export(&urdf, options);
            for settings in [&run.out, &active] {
                fs::write(&path, settings).unwrap();
                let (_folder, fmu) = export(&urdf, &["-c", text(&path)]);
                let (plain, with) = (entries(&plain).1, entries(&fmu).1);
                for file in ["modelDescription.xml", "resources/model.json"] {
                    assert_eq!(
                        String::from_utf8_lossy(&plain[file]),
                        String::from_utf8_lossy(&with[file]),
                        "{name} {options:?} {file}"
                    );
                }
            }
        }
    }
    let run = urdf2fmu(["init", text(&example("arm.urdf")), "-c", text(&path)]);
    assert_eq!(run.code, 2, "{run:?}");
}
