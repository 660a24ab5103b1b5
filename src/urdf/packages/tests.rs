use super::*;
use crate::urdf::test_folder::Folder;

const GRIP: &str = "<package><name>grip</name></package>";

/// Where the package `name` is for a file in `base`.
fn place(folder: &Folder, base: &str, paths: &[&str], name: &str) -> Option<String> {
    let options = ReadOptions {
        package_paths: paths.iter().map(|path| folder.0.join(path)).collect(),
        ..ReadOptions::default()
    };
    let found = Packages::new(&folder.0.join(base), &options).folder(name)?;
    let below = found.strip_prefix(&folder.0).ok()?;
    Some(below.to_string_lossy().replace('\\', "/"))
}

#[test]
fn packages_are_found_at_any_depth_of_the_workspace() {
    let grip = Some("deps/repo/more/grip".to_owned());
    for (name, base) in [
        ("depth1", "arm/urdf"),
        ("depth2", "manipulator/arm/urdf"),
        ("depth4", "manipulator/maker/more/arm/urdf"),
    ] {
        let robot = format!("{base}/r.urdf");
        let files = [
            (robot.as_str(), ""),
            ("deps/repo/more/grip/package.xml", GRIP),
        ];
        let folder = Folder::new(name, &files);
        assert_eq!(place(&folder, base, &[], "grip"), grip, "{base}");
        assert_eq!(place(&folder, base, &[], "other"), None, "{base}");
    }
    // Farther up only where that is the workspace, or the repository.
    let deep = "src/a/b/c/d/e/f/g/arm/urdf";
    let files = [
        ("src/a/b/c/d/e/f/g/arm/urdf/r.urdf", ""),
        ("src/x/grip/package.xml", GRIP),
    ];
    let folder = Folder::new("deep", &files);
    let found = place(&folder, deep, &[], "grip");
    assert_eq!(found.as_deref(), Some("src/x/grip"));
    let files = [
        ("repo/a/b/c/d/e/f/g/arm/urdf/r.urdf", ""),
        ("repo/x/grip/package.xml", GRIP),
    ];
    let folder = Folder::new("repository", &files);
    let deep = "repo/a/b/c/d/e/f/g/arm/urdf";
    assert_eq!(place(&folder, deep, &[], "grip"), None);
    fs::create_dir(folder.0.join("repo/.git")).expect("folder");
    let found = place(&folder, deep, &[], "grip");
    assert_eq!(found.as_deref(), Some("repo/x/grip"));
}

#[test]
fn a_workspace_ends_where_the_robot_s_src_or_install_is() {
    let folder = Folder::new(
        "ends",
        &[
            ("mine/src/arm/package.xml", "<name>arm</name>"),
            ("mine/src/arm/src/r.urdf", ""),
            ("yours/src/grip/package.xml", GRIP),
            ("alone/arm/package.xml", "<name>arm</name>"),
            ("alone/arm/src/r.urdf", ""),
        ],
    );
    assert_eq!(place(&folder, "mine/src/arm/src", &[], "grip"), None);
    // The sources of a package are no workspace.
    let beside = Some("yours/src/grip".to_owned());
    assert_eq!(place(&folder, "alone/arm/src", &[], "grip"), beside);
}

#[test]
fn a_folder_without_a_manifest_comes_last() {
    let folder = Folder::new(
        "bare",
        &[
            ("src/arm/urdf/r.urdf", ""),
            ("src/grip/grip/package.xml", GRIP),
            ("src/tool/readme", ""),
            ("src/kit/readme", ""),
            ("ros/share/tool/package.xml", "<name>tool</name>"),
            ("ws/install/arm/share/arm/urdf/r.urdf", ""),
            ("ws/install/grip/share/grip/package.xml", GRIP),
            ("ws/install/tool/share/tool/readme", ""),
        ],
    );
    // A repository that is called as the package in it.
    let inner = Some("src/grip/grip".to_owned());
    assert_eq!(place(&folder, "src/arm/urdf", &[], "grip"), inner);
    let bare = Some("src/kit".to_owned());
    assert_eq!(place(&folder, "src/arm/urdf", &[], "kit"), bare);
    let ros = Some("ros/share/tool".to_owned());
    assert_eq!(place(&folder, "src/arm/urdf", &["ros"], "tool"), ros);
    // An install tree of colcon, with and without what ROS knows of it.
    let arm = "ws/install/arm/share/arm/urdf";
    let installed = Some("ws/install/grip/share/grip".to_owned());
    let prefixes = ["ws/install/grip", "ws/install/arm"];
    assert_eq!(place(&folder, arm, &[], "grip"), installed);
    assert_eq!(place(&folder, arm, &prefixes, "grip"), installed);
    let bare = Some("ws/install/tool/share/tool".to_owned());
    assert_eq!(place(&folder, arm, &[], "tool"), bare);
}

#[test]
fn of_two_packages_of_one_name_the_nearest_is_taken() {
    let folder = Folder::new(
        "twice",
        &[
            ("ws/src/arm/r.urdf", ""),
            ("ws/src/b/grip/package.xml", GRIP),
            ("ws/install/grip/share/grip/package.xml", GRIP),
        ],
    );
    let base = folder.0.join("ws/src/arm");
    let options = ReadOptions::default();
    let found = || {
        let packages = Packages::new(&base, &options);
        (packages.folder("grip"), packages.remark("grip"))
    };
    let near = folder.0.join("ws/src/b/grip");
    assert_eq!(found(), (Some(near.clone()), None));
    let first = folder.0.join("ws/src/a/grip");
    fs::create_dir_all(&first).expect("folder");
    fs::write(first.join("package.xml"), GRIP).expect("file");
    let (used, remark) = found();
    let remark = remark.expect("two");
    assert_eq!(
        (used, remark.severity),
        (Some(first.clone()), Severity::Warning)
    );
    let both = format!("is at {} and at {};", first.display(), near.display());
    assert!(remark.message.contains(&both), "{remark:?}");
}

/// Whoever has taken a robot out of its workspace must learn that the next package of the name is
/// one of something else.
#[test]
fn a_package_that_no_workspace_holds_is_told_with_its_folder() {
    let files = [
        ("robots/arm/urdf/r.urdf", ""),
        ("robots/arm/package.xml", "<name>arm</name>"),
        ("tools/grip/package.xml", GRIP),
    ];
    let folder = Folder::new("outside", &files);
    let base = folder.0.join("robots/arm/urdf");
    let options = ReadOptions::default();
    let remark = |name: &str| {
        let packages = Packages::new(&base, &options);
        assert!(packages.folder(name).is_some());
        packages.remark(name)
    };
    let told = remark("grip").expect("a remark");
    let place = folder.0.join("tools/grip").display().to_string();
    assert!(
        told.severity == Severity::Note && told.message.contains(&place),
        "{told:?}"
    );
    // The robot's own package, what an option names, and what its repository holds, are plain.
    assert_eq!(remark("arm"), None);
    let named = ReadOptions {
        package_paths: vec![folder.0.join("tools")],
        ..ReadOptions::default()
    };
    let packages = Packages::new(&base, &named);
    assert!(packages.folder("grip").is_some() && packages.remark("grip").is_none());
    fs::create_dir(folder.0.join(".git")).expect("folder");
    assert_eq!(remark("grip"), None);
}

#[test]
fn folders_of_builds_and_hidden_ones_have_no_packages() {
    for made in [
        "build",
        "log",
        "node_modules",
        "target",
        "__pycache__",
        ".cache",
    ] {
        let copy = format!("src/{made}/grip/package.xml");
        let name = format!("made-{made}");
        let folder = Folder::new(&name, &[("src/arm/r.urdf", ""), (&copy, GRIP)]);
        assert_eq!(place(&folder, "src/arm", &[], "grip"), None, "{made}");
    }
}

#[test]
fn a_search_ends_after_a_number_of_files_and_says_so() {
    let folder = Folder::new(
        "bound",
        &[
            ("a/1", ""),
            ("a/2", ""),
            ("a/3", ""),
            ("b/grip/package.xml", GRIP),
            ("grip/package.xml", GRIP),
        ],
    );
    let roots = [folder.0.clone()];
    let found = |most: usize| {
        let index = Index::below(&roots, most);
        let count = index.named(&["grip".to_owned()]).count();
        (count, index.cut_short().map(Path::to_owned))
    };
    assert_eq!(found(MOST_ENTRIES), (2, None));
    // Three folders at the top, three files in the first, one folder and one file.
    assert_eq!(found(9), (2, None));
    assert_eq!(found(8), (1, Some(folder.0.clone())));
    assert_eq!(found(0), (0, Some(folder.0.clone())));
    // A folder that is too large is left out, and the others are looked at.
    for file in 4..20 {
        fs::write(folder.0.join(format!("a/{file}")), "").expect("file");
    }
    assert_eq!(found(18), (2, Some(folder.0.clone())));
}

#[test]
fn the_folders_of_users_and_of_the_system_are_not_looked_through() {
    let root = |path: &str| around(Path::new(path)).folders.pop();
    let some = |path: &str| Some(PathBuf::from(path));
    assert_eq!(root("/home/me/robots/arm/urdf"), some("/home/me/robots"));
    assert_eq!(root("/home/me"), None);
    assert_eq!(root("/"), None);
    assert_eq!(root("/opt/ros/share/arm/urdf"), some("/opt/ros"));
    // Of a container.
    assert_eq!(root("/ws/src/arm/urdf"), some("/ws"));
    let temporary = std::env::temp_dir();
    assert_eq!(around(&temporary).folders, Vec::<PathBuf>::new());
}

#[cfg(unix)]
#[test]
fn links_to_packages_are_followed_and_circles_end() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new(
        "circles",
        &[
            ("ws/src/arm/r.urdf", ""),
            ("repos/tools/grip/package.xml", GRIP),
        ],
    );
    let src = folder.0.join("ws/src");
    for (target, name) in [
        ("..", "up"),
        (".", "again"),
        ("/", "all"),
        ("arm/b", "arm/a"),
    ] {
        symlink(target, src.join(name)).expect("a link");
    }
    assert_eq!(place(&folder, "ws/src/arm", &[], "grip"), None);
    symlink("../../repos/tools", src.join("tools")).expect("a link");
    let linked = Some("ws/src/tools/grip".to_owned());
    assert_eq!(place(&folder, "ws/src/arm", &[], "grip"), linked);
}
