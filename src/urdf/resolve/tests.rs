use super::*;
use crate::urdf::test_folder::Folder;

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
    let help = missing("ftp://host/a.stl").help();
    assert!(help.contains("not supported"));
    for scheme in ["http", "https", "HTTPS"] {
        let help = missing(&format!("{scheme}://host/meshes/a.stl")).help();
        assert!(help.contains("nothing is downloaded"), "{help}");
        assert!(help.contains("filename=\"a.stl\""), "{help}");
    }
    assert!(missing("$(find arm)/a.stl").help().contains("xacro"));
}

/// A relative name's advice, or that of a file outside, would not help with these.
#[test]
fn names_of_other_machines_shells_and_schemes_are_told_as_such() {
    let options = ReadOptions::default();
    let resolver = Resolver::new(Path::new("/none/urdf"), &options, None);
    for (name, told) in [
        (
            r"C:\Users\me\a.stl",
            "Windows machine: put the file beside the URDF",
        ),
        ("file:///C:/Users/me/a.stl", "write filename=\"a.stl\""),
        ("~/meshes/a.stl", "'~' is not replaced here"),
        ("$HOME/a.stl", "'$HOME' is not replaced here"),
        ("file://~/a.stl", "not replaced here"),
        (
            "package:/arm/a.stl",
            "write two slashes: package://arm/a.stl",
        ),
        (
            "package://",
            "write package://NAME/ and the file's path in it",
        ),
        (
            "package://arm",
            "write package://arm/ and the file's path in it",
        ),
    ] {
        let Err(Missing::NotFound(missing)) = resolver.find(name) else {
            panic!("{name} was found");
        };
        let help = missing.help();
        // A drive is one on Windows.
        assert!(
            help.contains(told) || cfg!(windows) && name.contains("C:"),
            "{name}: {help}"
        );
        assert!(!help.contains("a relative name counts"), "{name}: {help}");
        assert!(!help.contains("--package"), "{name}: {help}");
    }
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

#[test]
fn a_package_that_is_found_comes_before_the_robot_s_own_files() {
    let folder = Folder::new(
        "own",
        &[
            ("ws/src/robot/package.xml", "<name>robot</name>"),
            ("ws/src/robot/urdf/r.urdf", ""),
            ("ws/src/robot/meshes/part.obj", ""),
            ("ws/src/robot/meshes/Foot.obj", ""),
            ("ws/src/common/parts/package.xml", "<name>parts</name>"),
            ("ws/src/common/parts/meshes/part.obj", ""),
        ],
    );
    let from = |name: &str| found(&folder, "ws/src/robot/urdf", &[], name);
    let part = Some("ws/src/common/parts/meshes/part.obj".to_owned());
    assert_eq!(from("package://parts/meshes/part.obj"), part);
    assert_eq!(from("model://parts/meshes/part.obj"), part);
    // It is not in the package, and what the robot has under that name is another one.
    assert_eq!(from("package://parts/meshes/Foot.obj"), None);
    let own = Some("ws/src/robot/meshes/Foot.obj".to_owned());
    assert_eq!(from("package://robot/meshes/Foot.obj"), own);
    // Without such a package it is guessed, but not with another package and in other case.
    assert_eq!(from("package://old/meshes/Foot.obj"), own);
    assert_eq!(from("package://old/meshes/foot.obj"), None);
}

#[test]
fn a_file_that_its_package_lacks_is_told_with_the_packages_of_that_name_alone() {
    let folder = Folder::new(
        "lacks",
        &[
            ("ws/robA/package.xml", "<name>robA</name>"),
            ("ws/robA/urdf/r.urdf", ""),
            ("ws/robA/meshes/arm.obj", ""),
            ("ws/robB/package.xml", "<name>robB</name>"),
            ("ws/robB/meshes/base.obj", ""),
        ],
    );
    let (base, options) = (folder.0.join("ws/robA/urdf"), ReadOptions::default());
    let name = "package://robA/meshes/base.obj";
    let resolver = Resolver::new(&base, &options, None);
    let Err(Missing::NotFound(missing)) = resolver.find(name) else {
        panic!("another robot's mesh is taken");
    };
    let at = format!(
        "package 'robA' is at {}",
        folder.0.join("ws/robA").display()
    );
    assert!(missing.advice.contains(&at), "{missing:?}");
    assert!(
        missing
            .advice
            .contains("there is no 'meshes/base.obj' in it")
    );
    assert_eq!(resolver.advice(&[name]), None);
    // A folder that is called so has it; another one has more of what is missing.
    for file in [
        "new/robA/meshes/base.obj",
        "old/robA/meshes/base.obj",
        "old/robA/meshes/b.obj",
    ] {
        let file = folder.0.join("ws").join(file);
        fs::create_dir_all(file.parent().expect("a folder")).expect("folder");
        fs::write(file, "").expect("file");
    }
    let resolver = Resolver::new(&base, &options, None);
    let option = |at: &str| format!("--package robA={}", folder.0.join(at).display());
    assert_eq!(resolver.advice(&[name]), Some((option("ws/new/robA"), 1)));
    let both = [name, "package://robA/meshes/b.obj"];
    assert_eq!(resolver.advice(&both), Some((option("ws/old/robA"), 2)));
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
