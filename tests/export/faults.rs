//! Two faults at a time: a person who mends what one run of `check` tells finds no new fault.
//!
//! A robot, its settings, its SRDF and an object beside it have places where something sound stands
//! and something faulty may stand instead. Each fault alone must be told, and of each two faults
//! both: whichever stage finds the one, from the XML to the names of variables, it must not keep
//! the other from being found.

use super::people::{findings, of_severity, write};
use super::*;

/// A file of the four.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Robot,
    Settings,
    Srdf,
    Object,
}

/// What stands at one place, sound and faulty, and the code of the finding.
struct Fault {
    file: Of,
    sound: &'static str,
    faulty: &'static str,
    code: &'static str,
}

const fn robot(sound: &'static str, faulty: &'static str, code: &'static str) -> Fault {
    let file = Of::Robot;
    Fault {
        file,
        sound,
        faulty,
        code,
    }
}

const fn settings(sound: &'static str, faulty: &'static str, code: &'static str) -> Fault {
    let file = Of::Settings;
    Fault {
        file,
        sound,
        faulty,
        code,
    }
}

/// Sound texts differ, so that each marks its place.
const FAULTS: [Fault; 44] = [
    // The text.
    robot("<a1 x='1'/>", "<a1 x='1' x='1'/>", "U003"),
    robot("<a2 x='1'/>", "<a2 x=1/>", "U003"),
    robot("<a3 x='&amp;'/>", "<a3 x='&'/>", "U003"),
    robot("name='unclosed'></link>", "name='unclosed'>", "U003"),
    robot("<!-- no open tag -->", "<opened>", "U003"),
    robot("<!-- no doctype -->", "<!DOCTYPE robot>", "U004"),
    // Names.
    robot("<link name='nameless'/>", "<link/>", "U015"),
    robot(
        "<link name='double'/>",
        "<link name='double'/><link name='double'/>",
        "U014",
    ),
    robot("name='nameless joint'", "", "U015"),
    robot("name='again' type", "name='nameless joint' type", "U014"),
    robot("name='alike 1'", "name='alike-2'", "A139"),
    // Numbers.
    robot("<mass value='1.01'/>", "<mass value='1,01'/>", "U030"),
    robot("xyz='0 0 0.01'", "xyz='0 0.01'", "U031"),
    robot(
        "lower='-0.1' upper='0.1'",
        "lower='nan' upper='0.1'",
        "U032",
    ),
    robot("<axis xyz='0 0 1.1'/>", "<axis xyz='0 0 0'/>", "U041"),
    robot(
        "<dynamics damping='0.1'/>",
        "<dynamics damping='-0.1'/>",
        "U033",
    ),
    // Shapes.
    robot(
        "<sphere radius='0.01'/>",
        "<sphere radius='-0.01'/>",
        "U033",
    ),
    robot("<sphere radius='0.02'/>", "<ball radius='0.02'/>", "U070"),
    robot(
        "<box size='0.01 0.01 0.01'/>",
        "<mesh filename='nowhere.stl'/>",
        "U104",
    ),
    robot(
        "<box size='0.02 0.02 0.02'/>",
        "<mesh filename='broken.stl'/>",
        "U105",
    ),
    robot(
        "<box size='0.03 0.03 0.03'/>",
        "<mesh filename='other.step'/>",
        "U106",
    ),
    // Masses.
    robot("ixx='1.02'", "ixx='-102'", "U061"),
    robot("<mass value='1.03'/>", "<mass value='-1.03'/>", "U060"),
    robot(
        "<!-- no frame -->",
        "<link name='f'/><joint name='f' type='continuous'>\
        <parent link='a'/><child link='f'/></joint>",
        "A104 U066",
    ),
    // Joints.
    robot(
        "'following' type='continuous'",
        "'following' type='continous'",
        "U040",
    ),
    robot("<parent link='a' />", "", "U017"),
    robot(
        "<mimic joint='turning'/>",
        "<mimic joint='nobody'/>",
        "U046",
    ),
    // The tree.
    robot("<parent  link='a'/>", "<parent link='nowhere'/>", "U016"),
    robot("<child  link='known'/>", "<child link='unknown'/>", "U016"),
    robot("<!-- no second root -->", "<link name='lost'/>", "U011"),
    robot(
        "<!-- no circle -->",
        "<link name='p'/><link name='q'/>\
        <joint name='pq' type='fixed'><parent link='p'/><child link='q'/></joint>\
        <joint name='qp' type='fixed'><parent link='q'/><child link='p'/></joint>",
        "U012",
    ),
    robot(
        "<!-- no second parent -->",
        "<joint name='second' type='fixed'>\
        <parent link='a'/><child link='held'/></joint>",
        "U013",
    ),
    // Settings.
    settings("# no syntax error", "[unfinished", "S101"),
    settings("tolerance = 1e-4", "tolerence = 1e-4", "S102"),
    settings("self_collision = false", "self_collision = 1", "S103"),
    settings("gravity = [0, 0, -9.81]", "gravity = 'down'", "S103"),
    settings("joint = 'turning'", "joint = 'turnin'", "A101"),
    settings("[link.a]", "[link.aa]", "A101"),
    settings("link = 'a'", "link = 'b'", "A131 A101"),
    settings("second = 'ball'", "second = 'bal'", "A101 A137"),
    settings("platforms = ['linux64']", "platforms = ['linux']", "S109"),
    settings("sliding = 0.01", "sliding = 7.0", "A106"),
    // What goes with the robot.
    Fault {
        file: Of::Srdf,
        sound: "link1='a'",
        faulty: "link1=a",
        code: "U003",
    },
    Fault {
        file: Of::Object,
        sound: "<sphere radius='0.05'/>",
        faulty: "<sphere radius='x'/>",
        code: "U030",
    },
];

/// A link on a fixed joint to `a`.
fn part(name: &str, inner: &str) -> String {
    format!(
        "<link name='{name}'>{inner}</link>\n<joint name='to {name}' type='fixed'>\
         <parent link='a'/><child link='{name}'/></joint>\n"
    )
}

fn inertial(mass: &str, ixx: &str) -> String {
    format!("<inertial>{mass}<inertia {ixx} ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>")
}

fn shape(geometry: &str) -> String {
    format!("<collision><geometry>{geometry}</geometry></collision>")
}

/// A joint to a link of its own, which `link` begins with.
fn moving(head: &str, parent: &str, child: &str, more: &str) -> String {
    format!("<joint {head}>{parent}{child}{more}</joint>\n")
}

/// The robot with the sound text at each place.
#[expect(clippy::too_many_lines, reason = "one file")]
fn sound_robot() -> String {
    let heavy = |name: &str| {
        let own = inertial("<mass value='1'/>", "ixx='1'");
        format!("<link name='{name}'>{own}</link>\n")
    };
    let a = "<parent link='a'/>";
    let to = |child: &str| format!("<child link='{child}'/>");
    let fixed = |name: &str, child: &str| {
        let head = format!("name='{name}' type='fixed'");
        moving(&head, a, &to(child), "")
    };
    let limit = |range: &str| format!("<limit {range} effort='1' velocity='1'/>");
    let names = [
        "turning",
        "sliding",
        "limp",
        "following",
        "mimicking",
        "known",
        "adopted",
    ];
    let links: String = names.map(heavy).concat();
    let own = inertial("<mass value='1'/>", "ixx='1'");
    let parts = [
        part("u", "<u><a1 x='1'/><a2 x='1'/><a3 x='&amp;'/></u>"),
        part("m1", &inertial("<mass value='1.01'/>", "ixx='1'")),
        part("m2", &inertial("<mass value='1'/>", "ixx='1.02'")),
        part("m3", &inertial("<mass value='1.03'/>", "ixx='1'")),
        part("s1", &shape("<sphere radius='0.01'/>")),
        part("s2", &shape("<sphere radius='0.02'/>")),
        part("s3", &shape("<box size='0.01 0.01 0.01'/>")),
        part("s4", &shape("<box size='0.02 0.02 0.02'/>")),
        part("s5", &shape("<box size='0.03 0.03 0.03'/>")),
        part(
            "o",
            &format!(
                "<collision><origin xyz='0 0 0.01'/>{}</collision>",
                "<geometry><sphere radius='0.1'/></geometry>"
            ),
        ),
        part("held", &shape("<sphere radius='0.2'/>")),
    ]
    .concat();
    let joints = [
        moving(
            "name='turning' type='continuous'",
            a,
            &to("turning"),
            "<axis xyz='0 0 1.1'/>",
        ),
        moving(
            "name='sliding' type='prismatic'",
            a,
            &to("sliding"),
            &limit("lower='-1' upper='1'"),
        ),
        moving(
            "name='limp' type='revolute'",
            a,
            &to("limp"),
            &limit("lower='-0.1' upper='0.1'"),
        ),
        moving(
            "name='following' type='continuous'",
            a,
            &to("following"),
            "<dynamics damping='0.1'/>",
        ),
        moving(
            "name='mimicking' type='continuous'",
            a,
            &to("mimicking"),
            "<mimic joint='turning'/>",
        ),
        moving(
            "name='alike 1' type='continuous'",
            a,
            "<child  link='known'/>",
            "",
        ),
        moving(
            "name='alike 2' type='continuous'",
            "<parent  link='a'/>",
            &to("adopted"),
            "",
        ),
        moving(
            "name='orphan' type='fixed'",
            "<parent link='a' />",
            &to("orphan"),
            "",
        ),
        moving("name='nameless joint' type='fixed'", a, &to("nobody's"), ""),
        moving("name='again' type='fixed'", a, &to("again"), ""),
        fixed("to nameless", "nameless"),
        fixed("to double", "double"),
        fixed("to unclosed", "unclosed"),
    ]
    .concat()
    .replace("link='nobody's'", "link='of nameless joint'");
    format!(
        "<!-- no doctype -->\n<robot name='r'>\n<link name='a'>{own}</link>\n{parts}\
         <!-- no open tag -->{links}\
         <link name='orphan'/><link name='of nameless joint'/><link name='again'/>\n\
         <link name='nameless'/>\n<link name='double'/>\n<link name='unclosed'></link>\n{joints}\
         <!-- no frame --><!-- no second root --><!-- no circle --><!-- no second parent -->\n\
         </robot>\n"
    )
}

const SETTINGS: &str = "[fmu]
platforms = ['linux64']
# no syntax error
[solver]
tolerance = 1e-4
[robot]
self_collision = false
[world]
gravity = [0, 0, -9.81]
[[actuator]]
joint = 'turning'
mode = 'velocity'
[link.a]
friction = 0.5
[initial.joints]
sliding = 0.01
[[sensor]]
type = 'imu'
link = 'a'
[[outputs.pair]]
name = 'hit'
first = 'held'
second = 'ball'
[[world.object]]
name = 'ball'
urdf = 'ball.urdf'
xyz = [3, 0, 0]
";

const SRDF: &str =
    "<robot name='r'><disable_collisions link1='a' link2='u' reason='Never'/></robot>\n";

const BALL: &str = "<robot name='ball'><link name='ball'><inertial><mass value='1'/>\
    <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>\
    <collision><geometry><sphere radius='0.05'/></geometry></collision></link></robot>\n";

/// Errors of the robot with these faults, as code and message.
fn errors(folder: &Path, faults: &[&Fault]) -> Vec<(String, String)> {
    let text = |file: Of, sound: String| {
        faults
            .iter()
            .filter(|fault| fault.file == file)
            .fold(sound, |text, fault| {
                assert_eq!(text.matches(fault.sound).count(), 1, "{}", fault.sound);
                text.replace(fault.sound, fault.faulty)
            })
    };
    let path = write(folder, "r.urdf", text(Of::Robot, sound_robot()));
    let config = write(folder, "r.toml", text(Of::Settings, SETTINGS.to_owned()));
    let srdf = write(folder, "r.srdf", text(Of::Srdf, SRDF.to_owned()));
    write(folder, "ball.urdf", text(Of::Object, BALL.to_owned()));
    let options = [
        "--config",
        super::text(&config),
        "--srdf",
        super::text(&srdf),
    ];
    let (ok, list) = findings(&path, &options);
    let told = list.iter().filter(|f| {
        // What would be told next is told as a warning (U066), and so is what an error may explain
        // (U068).
        f["severity"] == "error" || f["code"] == "U066" || f["code"] == "U068"
    });
    let word = |f: &Value, key: &str| f[key].as_str().unwrap().to_owned();
    let text = |f: &Value| {
        let part = if f["code"] == "U068" {
            "help"
        } else {
            "message"
        };
        word(f, part)
    };
    let told: Vec<_> = told.map(|f| (word(f, "code"), text(f))).collect();
    assert_eq!(ok, of_severity(&list, "error").is_empty());
    told
}

/// Whether two faults are told as one, or the one as a part of the other.
fn same_place(a: &Fault, b: &Fault) -> bool {
    let either = |x: &str, y: &str| {
        a.sound.contains(x) && b.sound.contains(y) || a.sound.contains(y) && b.sound.contains(x)
    };
    // The joint that has no name may be the one whose name stands twice.
    either("name='nameless joint'", "name='again' type")
        // A joint that misses its link may hold one of the roots.
        || either("child  link", "no second root")
        // An object that cannot be read has no names that could be looked up.
        || either("second = 'ball'", "radius='0.05'")
        // What follows '&' may be an entity that is declared.
        || either("no doctype", "&amp;")
}

#[test]
fn of_two_faults_both_are_told_in_one_run() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "broken.stl", "solid with nothing");
    write(folder.path(), "other.step", "ISO-10303-21;");
    assert_eq!(errors(folder.path(), &[]), [], "the sound robot");
    for fault in &FAULTS {
        let told = errors(folder.path(), &[fault]);
        let known = |code: &str| fault.code.contains(code) || code == "U068";
        let known = told.iter().all(|(code, _)| known(code));
        assert!(!told.is_empty() && known, "{}: {told:?}", fault.faulty);
    }
    let (mut pairs, mut hidden) = (0, Vec::new());
    for (i, first) in FAULTS.iter().enumerate() {
        for second in FAULTS[i + 1..]
            .iter()
            .filter(|second| !same_place(first, second))
        {
            let told = errors(folder.path(), &[first, second]);
            pairs += 1;
            for fault in [first, second] {
                let mut codes = fault.code.split(' ');
                // What another fault may explain is told with its name.
                let mut words = fault.faulty.split('\'').skip(1).step_by(2);
                let may = told.iter().filter(|(code, _)| code == "U068");
                let may: String = may.map(|(_, lines)| lines.as_str()).collect();
                let named = words.any(|word| may.contains(&format!("'{word}'")));
                if !codes.any(|code| told.iter().any(|(own, _)| own == code)) && !named {
                    hidden.push(format!(
                        "{} beside {}",
                        fault.faulty,
                        [first, second].map(|f| f.faulty).join(" | ")
                    ));
                }
            }
            let own = told.iter().filter(|(code, _)| code != "U068");
            if first.code == second.code && own.count() < 2 {
                let both = [first, second].map(|f| f.faulty).join(" | ");
                hidden.push(format!("one of {both}: {told:?}"));
            }
        }
    }
    assert!(
        hidden.is_empty(),
        "{} of {pairs} pairs:\n{}",
        hidden.len(),
        hidden.join("\n")
    );
    assert!(pairs > 800, "{pairs}");
}
