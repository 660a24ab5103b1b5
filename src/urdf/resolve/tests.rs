use super::*;

/// A folder of its own below the system's temporary folder, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let root = std::env::temp_dir().join(format!("urdf2fmu-{name}-{}", std::process::id()));
        for (path, text) in files {
            let path = root.join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("folder");
            fs::write(path, text).expect("file");
        }
        Self(fs::canonicalize(root).expect("path"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn found(folder: &Folder, base: &str, paths: &[&str], name: &str) -> Option<String> {
    let options = ReadOptions {
        package_paths: paths.iter().map(|p| folder.0.join(p)).collect(),
        ..ReadOptions::default()
    };
    let base = folder.0.join(base);
    let found = Resolver::new(&base, &options, None).find(name).ok()?;
    let relative = found.path.strip_prefix(&folder.0).ok()?;
    Some(relative.to_string_lossy().replace('\\', "/"))
}

#[test]
fn every_form_of_mesh_name_is_found() {
    let folder = Folder::new(
        "resolve",
        &[
            (
                "ws/my-robot/package.xml",
                "<package><name>my_robot</name></package>",
            ),
            ("ws/my-robot/meshes/a.stl", ""),
            ("ws/my-robot/urdf/r.urdf", ""),
            ("ws/my-robot/urdf/b c.stl", ""),
            ("ws/other/meshes/o.stl", ""),
            ("prefix/share/third/t.stl", ""),
            ("src/repo/fourth/f.stl", ""),
            ("odd/package.xml", "<package><name>fifth</name></package>"),
            ("odd/g.stl", ""),
        ],
    );
    let from = |paths: &[&str], name: &str| found(&folder, "ws/my-robot/urdf", paths, name);
    let a = Some("ws/my-robot/meshes/a.stl".to_owned());
    // up to the package.xml of that name, whatever the folder is called
    assert_eq!(from(&[], "package://my_robot/meshes/a.stl"), a);
    assert_eq!(from(&[], "model://my-robot/meshes/a.stl"), a);
    assert_eq!(from(&[], "../meshes/a.stl"), a);
    assert_eq!(from(&[], "..\\meshes\\a.stl"), a);
    let spaced = Some("ws/my-robot/urdf/b c.stl".to_owned());
    assert_eq!(from(&[], "b c.stl"), spaced);
    let url = format!("file://{}/ws/my-robot/urdf/b%20c.stl", folder.0.display());
    assert_eq!(from(&[], &url), spaced);
    // The same address without the empty name of its machine (RFC 8089).
    assert_eq!(from(&[], &url.replacen("file://", "file:", 1)), spaced);
    // up to a folder that holds one of that name
    assert_eq!(
        from(&[], "package://other/meshes/o.stl").as_deref(),
        Some("ws/other/meshes/o.stl")
    );
    assert_eq!(
        from(&["prefix"], "package://third/t.stl").as_deref(),
        Some("prefix/share/third/t.stl")
    );
    assert_eq!(
        from(&["src"], "package://fourth/f.stl").as_deref(),
        Some("src/repo/fourth/f.stl")
    );
    assert_eq!(
        from(&["src/repo/fourth"], "package://fourth/f.stl").as_deref(),
        Some("src/repo/fourth/f.stl")
    );
    assert_eq!(
        from(&["odd"], "package://fifth/g.stl").as_deref(),
        Some("odd/g.stl")
    );
    assert_eq!(from(&["odd"], "package://sixth/g.stl"), None);
}

#[test]
fn meshes_are_looked_for_in_the_mesh_folder_of_mujoco() {
    let folder = Folder::new(
        "meshdir",
        &[("r/assets/a.stl", ""), ("r/assets/b/c.stl", "")],
    );
    let (base, options) = (folder.0.join("r"), ReadOptions::default());
    let resolver = Resolver::new(&base, &options, Some("./assets/"));
    for (name, file) in [
        ("a.stl", "a.stl"),
        ("x/a.stl", "a.stl"),
        ("b/c.stl", "b/c.stl"),
    ] {
        let found = resolver.find(name).map(|found| found.path);
        assert_eq!(found, Ok(base.join("assets").join(file)), "{name}");
    }
}

#[test]
fn a_name_in_other_case_means_the_one_file_that_has_it() {
    let folder = Folder::new(
        "case",
        &[
            ("r/Link.STL", ""),
            ("r/twice.stl", ""),
            ("r/Twice.STL", ""),
            ("r/Meshes/collision/arm.stl", ""),
            ("r/Meshes/visual/Arm.stl", ""),
            ("pack/meshes/Foot.stl", ""),
        ],
    );
    let (base, options) = (folder.0.join("r"), ReadOptions::default());
    let resolver = Resolver::new(&base, &options, None);
    // On a file system that ignores case the files are simply found.
    if base.join("link.stl").is_file() {
        return;
    }
    let found = |name: &str| resolver.find(name).map(|found| found.path);
    assert_eq!(found("link.stl"), Ok(base.join("Link.STL")));
    let arm = base.join("Meshes/collision/arm.stl");
    assert_eq!(found("meshes/collision/Arm.stl"), Ok(arm));
    // A package beside the robot's is another folder.
    let foot = folder.0.join("pack/meshes/Foot.stl");
    assert_eq!(found("package://pack/meshes/foot.stl"), Ok(foot));
    let moved = resolver.moved_files();
    assert!(moved["link.stl"].other_case && !moved["meshes/collision/Arm.stl"].other_case);
    let Err(Missing::NotFound(missing)) = found("TWICE.stl") else {
        panic!("two files differ in case alone");
    };
    assert!(
        missing.advice.contains("upper and lower case"),
        "{missing:?}"
    );
    let Err(Missing::Outside(_)) = found("../pack/meshes/Foot.stl") else {
        panic!("outside of the robot's folders");
    };
    let Err(Missing::NotFound(missing)) = found("../pack/meshes/foot.stl") else {
        panic!("outside of the robot's folders");
    };
    assert!(missing.advice.contains("Foot.stl"), "{missing:?}");
}

#[test]
fn a_missing_mesh_lists_every_place_searched_and_advice() {
    let options = ReadOptions {
        package_paths: vec![PathBuf::from("/nowhere")],
        ..ReadOptions::default()
    };
    let resolver = Resolver::new(Path::new("/none/urdf"), &options, None);
    let missing = |name: &str| match resolver.find(name) {
        Err(Missing::NotFound(missing)) => missing,
        other => panic!("{name}: {other:?}"),
    };
    let found = missing("package://arm/meshes/a.stl");
    for place in [
        "/nowhere/arm/meshes/a.stl",
        "/nowhere/share/arm/meshes/a.stl",
        "/none/urdf/arm/meshes/a.stl",
        "/none/arm/meshes/a.stl",
        "/arm/meshes/a.stl",
    ] {
        assert!(found.tried.contains(&PathBuf::from(place)), "{found:?}");
    }
    assert!(found.help().contains("--package-path"));
    let help = missing("http://host/a.stl").help();
    assert!(help.contains("not supported"));
    assert!(missing("$(find arm)/a.stl").help().contains("xacro"));
}

#[test]
fn a_file_outside_of_the_robot_s_folders_is_not_taken() {
    let folder = Folder::new(
        "outside",
        &[
            ("secret.stl", ""),
            ("ws/secret.stl", ""),
            ("ws/bot/r.urdf", ""),
            ("ws/bot/m/a.stl", ""),
            ("ws/arm/urdf/r.urdf", ""),
            ("ws/arm/meshes/b.stl", ""),
            ("ws/pkg/package.xml", "<name>pkg</name>"),
            ("ws/pkg/a/b/r.urdf", ""),
            ("ws/pkg/c.stl", ""),
        ],
    );
    let find = |base: &str, paths: &[&str], name: &str| {
        let options = ReadOptions {
            package_paths: paths.iter().map(|p| folder.0.join(p)).collect(),
            ..ReadOptions::default()
        };
        let base = folder.0.join(base);
        Resolver::new(&base, &options, None)
            .find(name)
            .map(|found| found.path)
    };
    let there = |file: &str| Ok(folder.0.join(file));
    let outside = |file: &str| Err(Missing::Outside(folder.0.join(file)));
    let absolute = |file: &str| folder.0.join(file).display().to_string();
    // Below the URDF, in its package, beside a folder that is called urdf.
    assert_eq!(find("ws/bot", &[], "m/../m/a.stl"), there("ws/bot/m/a.stl"));
    assert_eq!(
        find("ws/bot", &[], &absolute("ws/bot/m/a.stl")),
        there("ws/bot/m/a.stl")
    );
    assert_eq!(
        find("ws/pkg/a/b", &[], "../../c.stl"),
        there("ws/pkg/c.stl")
    );
    assert_eq!(
        find("ws/arm/urdf", &[], "../meshes/b.stl"),
        there("ws/arm/meshes/b.stl")
    );
    // Anywhere else, however it is written.
    for name in [
        "../secret.stl",
        "m/../../secret.stl",
        &absolute("ws/secret.stl"),
        &format!("file://{}", absolute("ws/secret.stl")),
        "package://bot/../secret.stl",
    ] {
        assert_eq!(
            find("ws/bot", &[], name),
            outside("ws/secret.stl"),
            "{name}"
        );
    }
    assert_eq!(
        find("ws/bot", &[], "../../secret.stl"),
        outside("secret.stl")
    );
    assert_eq!(
        find("ws/arm/urdf", &[], "../../secret.stl"),
        outside("ws/secret.stl")
    );
    assert!(find("ws/bot", &[], "package://../secret.stl").is_err());
    // Unless the user says that it belongs there.
    assert_eq!(
        find("ws/bot", &["ws"], "../secret.stl"),
        there("ws/secret.stl")
    );
}

#[cfg(unix)]
#[test]
fn symbolic_links_are_followed_and_reported_and_cycles_end() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new("links", &[("far/a.stl", ""), ("bot/own.stl", "")]);
    let bot = folder.0.join("bot");
    for (target, name) in [
        ("../far/a.stl", "out.stl"),
        ("own.stl", "in.stl"),
        ("loop_b.stl", "loop_a.stl"),
        ("loop_a.stl", "loop_b.stl"),
        (".", "again"),
    ] {
        symlink(target, bot.join(name)).expect("a link");
    }
    let options = ReadOptions::default();
    let resolver = Resolver::new(&bot, &options, None);
    let linked = |name: &str| resolver.find(name).map(|found| found.linked);
    assert_eq!(linked("out.stl"), Ok(true));
    assert_eq!(linked("in.stl"), Ok(false));
    assert_eq!(linked("again/again/own.stl"), Ok(false));
    let Err(Missing::NotFound(lost)) = resolver.find("loop_a.stl") else {
        panic!("a loop leads nowhere");
    };
    assert!(lost.advice.contains("leads nowhere"), "{lost:?}");
    assert!(
        resolver
            .find(&format!("{}x.stl", "again/".repeat(500)))
            .is_err()
    );
}
