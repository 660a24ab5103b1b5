//! Advice that is followed as it stands: careless calls and broken FMUs, what is said of them, and
//! that the next call goes on.

use super::people::{mesh_robot, tetrahedron, write};
use super::*;

const ROBOT: &str = "<robot name='r'><link name='base'><inertial><mass value='1'/>\
    <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>";

/// An FMU with some of its files changed; a file without content is left out.
fn changed(from: &Path, to: &Path, change: &[(&str, Option<&[u8]>)]) {
    use std::io::Write as _;
    let mut zip = zip::ZipWriter::new(fs::File::create(to).unwrap());
    for (name, bytes) in entries(from).1 {
        let own = change.iter().find(|(part, _)| name.ends_with(part));
        let content = own.map_or(Some(bytes.as_slice()), |(_, content)| *content);
        let Some(content) = content else { continue };
        let options = zip::write::SimpleFileOptions::default();
        zip.start_file(name, options).unwrap();
        zip.write_all(content).unwrap();
    }
    zip.finish().unwrap();
}

fn said(folder: &Path, args: &[&str]) -> String {
    let run = run_in(folder, args, &[]);
    assert_ne!(run.code, 0, "{args:?}: {run:?}");
    run.err
}

/// "Unpack it first" led to a folder, and that to its modelDescription.xml.
#[test]
fn a_part_of_an_fmu_is_told_with_the_fmu_to_give() {
    let urdf = tempfile::tempdir().unwrap();
    let urdf = write(urdf.path(), "r.urdf", ROBOT);
    let (folder, fmu) = export(&urdf, &[]);
    let folder = folder.path();
    fs::copy(&fmu, folder.join("robot.zip")).unwrap();
    for (name, bytes) in entries(&fmu).1 {
        write(folder, &format!("unpacked/{name}"), bytes);
    }
    write(folder, "r.urdf", ROBOT);
    for (args, part) in [
        (
            &["info", "robot.zip"][..],
            "a zip archive that holds an FMU: end its name with .fmu",
        ),
        (
            &["simulate", "unpacked"],
            "an FMU that was unpacked: give the .fmu itself",
        ),
        (
            &["check", "unpacked"],
            "an FMU that was unpacked: give the .fmu itself",
        ),
        (
            &["info", "unpacked/modelDescription.xml"],
            "a part of an FMU that was unpacked: give the .fmu itself",
        ),
        (
            &["check", "r.urdf", "--object", "robot.fmu@1,0"],
            "an FMU: give the URDF that it was made from",
        ),
    ] {
        let said = said(folder, args);
        assert!(said.contains(part), "{args:?}: {said}");
    }
    fs::rename(folder.join("robot.zip"), folder.join("renamed.fmu")).unwrap();
    assert_eq!(run_in(folder, &["info", "renamed.fmu"], &[]).code, 0);
}

#[test]
fn a_damaged_fmu_is_told_to_be_fetched_once_more() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = write(folder.path(), "r.urdf", ROBOT);
    let (_kept, fmu) = export(&urdf, &[]);
    let folder = folder.path();
    let whole = fs::read(&fmu).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 3] ^= 0xff;
    write(folder, "empty.fmu", "");
    write(folder, "cut.fmu", &whole[..whole.len() / 2]);
    write(folder, "flipped.fmu", flipped);
    let library = std::env::consts::DLL_SUFFIX;
    changed(
        &fmu,
        &folder.join("library.fmu"),
        &[(library, Some(b"none"))],
    );
    let half = entries(&fmu).1["modelDescription.xml"].clone();
    let half = &half[..half.len() / 2];
    let description = ("modelDescription.xml", Some(half));
    changed(&fmu, &folder.join("description.fmu"), &[description]);
    for (name, part) in [
        ("empty", "it is empty; copy or download it once more"),
        (
            "cut",
            "it is cut short, or no zip archive; copy or download it once more",
        ),
        (
            "flipped",
            "the FMU is damaged: copy or download it once more",
        ),
        ("library", "the FMU's library is damaged"),
        ("description", "download the FMU once more"),
    ] {
        let said = said(
            folder,
            &["simulate", &format!("{name}.fmu"), "--stop-time", "0.01"],
        );
        assert!(said.contains(part), "{name}: {said}");
    }
}

#[test]
fn options_without_an_effect_are_told_and_advice_for_options_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "r.urdf", ROBOT);
    for (args, part) in [
        (
            &["check", "r.urdf", "--package", "a=none"][..],
            "there is no folder 'none'",
        ),
        (
            &["check", "r.urdf", "--package-path", "none"],
            "there is no folder 'none'",
        ),
        (
            &["check", "r.urdf", "--package-path", "r.urdf"],
            "'r.urdf' is a file",
        ),
        (
            &["expand", "r.urdf", "--package-path", "none"],
            "there is no folder 'none'",
        ),
        (&["picture", "r.urdf", "--rate", "5"], "--run <FILE.csv>"),
        (&["check", "r.urdf", "--object", "r.urdf 1,0"], "r.urdf@X,Y"),
        (&["check", "r.urdf", "--object", "r.urdf:1,0"], "r.urdf@X,Y"),
        (&["check", "r.urdf", "--object", "r.urdf@1;0"], "r.urdf@X,Y"),
        (
            &["check", "r.urdf", "--object", "r.urdf@1,0@2,0"],
            "r.urdf@X,Y",
        ),
        (
            &["r.urdf"],
            "a command comes first, such as urdf2fmu check r.urdf",
        ),
        (
            &["simulate", "r.urdf", "--start-value", "link.base.mass=2"],
            "two words: --start-value NAME VALUE",
        ),
        (
            &[
                "simulate",
                "r.urdf",
                "--stop-time",
                "1",
                "--output-interval",
                "1e-12",
            ],
            "at least 1e-8 s for 1 s",
        ),
        (
            &[
                "simulate",
                "r.urdf",
                "--output-variable",
                "energy.kinetic,energy.potential",
            ],
            "each name has an --output-variable of its own",
        ),
        (
            &["check", "r.urdf", "-c", "none.toml"],
            "correct the name of the file",
        ),
    ] {
        let said = said(folder, args);
        assert!(said.contains(part), "{args:?}: {said}");
    }
    write(folder, "in.csv", "time,link.base.mass\n0,1\n");
    let rover = example("rover.urdf");
    let simulate = |args: &[&str]| said(folder, &[&["simulate", text(&rover)], args].concat());
    for (args, part) in [
        (
            &["--start-value", "joint.head_joint.position", "1"][..],
            "an output; it starts at 'initial.joint.head_joint.position'",
        ),
        (
            &["--start-value", "link.base_link.mass", "0,5"],
            "no finite number, in which the decimal sign is a point",
        ),
    ] {
        let said = simulate(args);
        assert!(said.contains(part), "{args:?}: {said}");
    }
    let said_of_table = said(folder, &["simulate", "r.urdf", "--input-file", "in.csv"]);
    assert!(
        said_of_table.contains("a parameter; --start-value sets it"),
        "{said_of_table}"
    );
    // It is no value of anything.
    let said = said(folder, &["simulate", "r.urdf", "--duration", "3"]);
    assert!(!said.contains("as a value"), "{said}");
}

#[test]
fn tables_of_one_time_and_marks_without_an_end_are_told_truly() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = example("rover.urdf");
    let input = "cmd.head_joint.velocity";
    let mut call = vec![
        "simulate",
        text(&urdf),
        "--stop-time",
        "0.01",
        "--output-file",
    ];
    let [out, table] = ["o.csv", "in.csv"].map(|name| folder.path().join(name));
    call.extend([text(&out), "--input-file", text(&table)]);
    fs::write(&table, format!("time,{input}\n0,0\n0,1\n0,0.5\n")).unwrap();
    let run = run(&call);
    assert!(run.code == 0 && !run.err.contains("Subtract"), "{run:?}");
    fs::write(&table, format!("time,\"{input}\n0,0\n1,1\n")).unwrap();
    let said = said(Path::new("."), &call);
    assert!(
        said.contains("line 1: a quotation mark in a name is never closed"),
        "{said}"
    );
}

/// The advice for faces, or to export it again, would not help.
#[test]
fn a_mesh_under_the_ending_of_another_format_is_told_with_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let obj = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";
    write(folder, "a.obj", tetrahedron());
    write(folder, "b.stl", obj);
    for (name, own) in [("a.obj", "stl"), ("b.stl", "obj")] {
        write(folder, "r.urdf", mesh_robot(&[name]));
        let told = said(folder, &["check", "r.urdf"]);
        assert!(
            told.contains(&format!("it begins as a .{own} file does")),
            "{told}"
        );
        assert!(
            !told.contains("U110"),
            "a hull of what cannot be read: {told}"
        );
        let renamed = format!("{}.{own}", &name[..1]);
        fs::rename(folder.join(name), folder.join(&renamed)).unwrap();
        write(folder, "r.urdf", mesh_robot(&[&renamed]));
        assert_eq!(run_in(folder, &["check", "r.urdf"], &[]).code, 0);
    }
}

/// The command of ROS refuses these, too.
#[test]
fn what_no_xacro_takes_is_not_left_to_another_program() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (inner, part) in [
        ("<link name='${1/0}'/>", "correct what it is divided by"),
        ("<link name='${1+}'/>", "write the rest of it"),
        ("<link name='${1'/>", "write it"),
        (
            "<xacro:if value='maybe'/>",
            "write true, false, 1, 0 or a comparison",
        ),
        ("<xacro:insert_block name='b'/>", "hand it to the macro"),
        (
            "<xacro:include filename='r.xacro'/>",
            "leave out the <xacro:include>",
        ),
    ] {
        let xmlns = "xmlns:xacro='http://www.ros.org/wiki/xacro'";
        write(
            folder,
            "r.xacro",
            format!("<robot name='r' {xmlns}>{inner}</robot>"),
        );
        let said = said(folder, &["check", "r.xacro"]);
        assert!(
            said.contains(part) && !said.contains("may know more"),
            "{inner}: {said}"
        );
    }
}

/// Each file at its own line, not at the header of its table.
#[test]
fn files_that_are_not_there_are_told_at_the_key_that_names_them() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "r.urdf", ROBOT);
    for (table, line) in [
        (
            "[[world.object]]\nname = \"a\"\nstatic = true\nurdf = \"no.urdf\"",
            4,
        ),
        (
            "[[world.robot]]\nname = \"a\"\nxyz = [1, 0, 1]\nurdf = \"no.urdf\"",
            4,
        ),
        (
            "[[world.robot]]\nname = \"a\"\nurdf = \"r.urdf\"\nconfig = \"no.toml\"",
            4,
        ),
        (
            "[[world.terrain]]\nname = \"a\"\ntype = \"mesh\"\nfile = \"no.stl\"",
            4,
        ),
        (
            "[[world.terrain]]\nname = \"a\"\ntype = \"heightfield\"\nsize = [2, 2]\n\
             file = \"no.png\"",
            5,
        ),
    ] {
        write(folder, "r.toml", table);
        let said = said(folder, &["check", "r.urdf", "--config", "r.toml"]);
        let place = format!("r.toml:{line}:");
        assert!(
            said.contains(&place) && said.contains("no."),
            "{table}: {said}"
        );
    }
}

/// They were told as arguments of xacro, which nobody meant.
#[test]
fn files_in_the_place_of_arguments_are_told_with_their_option() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "r.urdf", ROBOT);
    write(folder, "t.csv", "time,base.position.z\n0,1\n1,1\n");
    write(folder, "c.toml", "");
    for (args, part) in [
        (
            &["report", "r.urdf", "t.csv"][..],
            "report run.csv --model robot.urdf",
        ),
        (&["report", "t.csv", "r.urdf"], "report has it by --model"),
        (
            &["init", "r.urdf", "c.toml"],
            "init writes them to --output",
        ),
        (
            &["check", "r.urdf", "c.toml"],
            "settings are given by --config",
        ),
        (&["picture", "r.urdf", "a.png"], "named by --output"),
        (
            &["check", "r.urdf", "a"],
            "arguments of xacro are written name:=value",
        ),
    ] {
        let said = said(folder, args);
        assert!(said.contains(part), "{args:?}: {said}");
    }
    let run = run_in(folder, &["report", "t.csv", "--model", "r.urdf"], &[]);
    assert_eq!(run.code, 0, "{run:?}");
}

/// The advice for a joint of another robot is followed: its own settings take it.
#[test]
fn joints_of_another_robot_are_told_where_their_settings_stand() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arm = "<robot name='r'><link name='base'/><link name='l'><inertial><mass value='1'/>\
        <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\
        <joint name='j' type='continuous'><parent link='base'/><child link='l'/></joint></robot>";
    write(folder, "r.urdf", arm);
    let other = "[[world.robot]]\nname = \"b\"\nurdf = \"r.urdf\"\nxyz = [5, 0, 0]\n";
    let table = "[[actuator]]\njoint = \"NAME\"\nmode = \"velocity\"\n";
    let args = &["check", "r.urdf", "--config", "c.toml"];
    write(
        folder,
        "c.toml",
        format!("{other}{}", table.replace("NAME", "b.j")),
    );
    let said = said(folder, args);
    assert!(
        said.contains("write config = \"b.toml\" in its [[world.robot]]"),
        "{said}"
    );
    assert!(
        said.contains("with 'j'") && !said.contains("a later one sets"),
        "{said}"
    );
    write(folder, "c.toml", format!("{other}config = \"b.toml\"\n"));
    write(folder, "b.toml", table.replace("NAME", "j"));
    let run = run_in(folder, args, &[]);
    assert_eq!(run.code, 0, "{run:?}");
}
