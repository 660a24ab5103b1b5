//! `[[outputs.pair]]`: which links a side means, and what cannot be a pair.

use super::world::{built, names, surrounded};
use super::*;
use crate::assemble::{Guest, of_robot, world};
use crate::diagnostic::Diagnostic;
use crate::model::RootKind;
use crate::settings::Settings;

/// A cup with a handle.
fn cup() -> Description {
    robot(body("bowl", 0.3)).with(
        "bowl",
        "ear",
        Revolute,
        at(0.3, 0.0, 0.0),
        body("handle", 0.1),
    )
}

/// A cup and two cubes beside the cart, and a static table.
const AROUND: &str = "[[world.object]]\nname = \"cup\"\nurdf = \"cup.urdf\"\nxyz = [3, 0]\n\
    [[world.object]]\nname = \"cube1\"\nmass = 1\nshape = { box = [0.2, 0.2, 0.2] }\nxyz = [4, 0]\n\
    [[world.object]]\nname = \"cube2\"\nmass = 1\nshape = { box = [0.2, 0.2, 0.2] }\nxyz = [5, 0]\n\
    [[world.object]]\nname = \"table\"\nstatic = true\nshape = { box = [1, 1, 0.4] }\nxyz = [7, 0]\n";

fn pair(name: &str, first: &str, second: &str) -> String {
    format!("[[outputs.pair]]\nname = \"{name}\"\nfirst = {first}\nsecond = {second}\n")
}

/// Names of the links on both sides of a pair; `ground` for the ground.
fn sides(model: &Model, pair: usize) -> [Vec<&str>; 2] {
    model.outputs.pairs[pair].sides.each_ref().map(|side| {
        let names = side
            .iter()
            .map(|link| link.map_or("ground", |link: LinkId| &model.links[link.index()].name));
        names.collect()
    })
}

#[test]
fn a_side_is_links_of_the_robot_and_of_others_all_of_one_or_the_ground() {
    for (text, expected) in [
        ("\"left_wheel\"", vec!["left_wheel"]),
        // Links of the robot alone: no single ones of others.
        ("\"*_wheel\"", vec!["left_wheel", "right_wheel"]),
        ("\"cup\"", vec!["cup.bowl", "cup.handle"]),
        ("\"cup.handle\"", vec!["cup.handle"]),
        ("\"*.handle\"", vec!["cup.handle"]),
        ("\"cube?\"", vec!["cube1.cube1", "cube2.cube2"]),
        (
            "[\"cube1\", \"chassis\", \"cube1\"]",
            vec!["chassis", "cube1.cube1"],
        ),
    ] {
        let settings = AROUND.to_owned() + &pair("p", text, "\"ground\"");
        let built = built(&settings, Some(&cup()));
        assert_eq!(sides(&built.model, 0), [expected, vec!["ground"]], "{text}");
    }
    let settings = AROUND.to_owned() + &pair("p", "[\"table\", \"ground\"]", "\"cup\"");
    let built = built(&settings, Some(&cup()));
    let expected = [
        vec!["ground", "table.table"],
        vec!["cup.bowl", "cup.handle"],
    ];
    assert_eq!(sides(&built.model, 0), expected);
}

#[test]
fn a_pair_has_variables_of_its_name() {
    let both = pair("my grasp", "\"*_wheel\"", "\"cup\"") + &pair("2", "\"cup\"", "\"table\"");
    let settings = AROUND.to_owned() + &both;
    let model = built(&settings, Some(&cup())).model;
    let all = names(&model);
    let of = |prefix: &str| -> Vec<String> {
        let of_pair = all.iter().filter(|name| name.starts_with(prefix));
        of_pair
            .map(|name| name[prefix.len()..].to_owned())
            .collect()
    };
    let expected = "active force.x force.y force.z point.x point.y point.z
        normal.x normal.y normal.z depth slip_speed";
    let expected: Vec<&str> = expected.split_whitespace().collect();
    assert_eq!(of("pair.my_grasp."), expected);
    assert_eq!(of("pair._2."), expected);
    let flat = settings.clone() + "[fmu]\nnaming = \"flat\"\n";
    let flat = names(&built(&flat, Some(&cup())).model);
    assert!(flat.iter().any(|name| name == "pair_my_grasp_slip_speed"));
    // After those of links, before those of sensors.
    let place = |name: &str| all.iter().position(|n| n.starts_with(name));
    assert!(place("contact.") < place("pair.") && place("pair.") < place("energy."));
}

fn wrong(settings: &str) -> Diagnostic {
    let mut found = surrounded(&(AROUND.to_owned() + settings), Some(&cup())).expect_err(settings);
    found.retain(|d| d.severity == Severity::Error);
    assert_eq!(found.len(), 1, "{settings}: {}", texts(&found).join("\n"));
    found.remove(0)
}

#[test]
fn pairs_that_cannot_be_are_errors_with_their_place() {
    let apart = "[robot]\nself_collision = true\n[[ignore_contact]]\n\
                 links = [\"left_wheel\", \"right_wheel\"]\n";
    let together = "[robot]\nself_collision = true\n";
    let wheels = pair("p", "\"left_wheel\"", "\"right_wheel\"");
    for (settings, code, words) in [
        (
            pair("p", "\"cpu\"", "\"ground\""),
            "A101",
            "'cpu' Some(\"the nearest is 'cup'\")",
        ),
        (
            pair("p", "\"cup.handel\"", "\"ground\""),
            "A101",
            "the nearest is 'cup.handle'",
        ),
        (pair("p", "\"grund\"", "\"cup\""), "A101", "'ground'"),
        (
            pair("p", "\"cu[pq]\"", "\"ground\""),
            "A101",
            "no brackets: give a list",
        ),
        (
            pair("p", "\"mast_link\"", "\"cup\""),
            "A102",
            "'mast_link' has no collision shape",
        ),
        (
            pair("p", "\"cup\"", "\"ground\"") + &pair("p", "\"cup\"", "\"table\""),
            "A137",
            "second pair is named 'p'",
        ),
        (
            pair("a b", "\"cup\"", "\"ground\"") + &pair("a_b", "\"cup\"", "\"table\""),
            "A137",
            "second pair is named 'a b'",
        ),
        (
            pair("p", "\"cup\"", "[\"cup.handle\", \"ground\"]"),
            "A137",
            "link 'cup.handle' is on both sides",
        ),
        (
            pair("p", "\"ground\"", "[\"cup\", \"ground\"]"),
            "A137",
            "the ground is on both sides",
        ),
        (
            pair("p", "\"table\"", "\"ground\""),
            "A137",
            "no force can move either of them",
        ),
        (wheels.clone(), "A137", "self_collision"),
        (apart.to_owned() + &wheels, "A137", "kept apart"),
        (
            together.to_owned() + &pair("p", "\"chassis\"", "\"left_wheel\""),
            "A137",
            "neighbours",
        ),
    ] {
        let found = wrong(&settings);
        let said = format!("{} {:?}", found.message, found.help);
        assert_eq!(found.code, code, "{said}");
        assert!(said.contains(words), "{words}: {said}");
        assert!(found.place.is_some(), "{said}");
    }
    let airless = "world.ground = { type = \"none\" }\n".to_owned();
    let found = error(
        &cart(),
        &(airless + &pair("p", "\"chassis\"", "\"ground\"")),
    );
    assert_eq!(found.code, "A102");
    assert!(found.message.contains("no ground"), "{}", found.message);
}

#[test]
fn links_of_one_robot_are_a_pair_where_they_may_touch() {
    let settings = "[robot]\nself_collision = true\n".to_owned()
        + &pair("p", "\"left_wheel\"", "\"right_wheel\"");
    let model = model(&cart(), &settings);
    assert_eq!(sides(&model, 0), [["left_wheel"], ["right_wheel"]]);
}

#[test]
fn a_name_that_means_two_things_is_an_error() {
    let rover = robot(body("chassis", 1.0)).with(
        "chassis",
        "axle",
        Continuous,
        at(0.0, 0.2, 0.0),
        body("ground", 1.0),
    );
    let settings = pair("p", "\"chassis\"", "\"ground\"");
    let found = error(&rover, &settings);
    assert_eq!(found.code, "A137");
    assert!(
        found.message.contains("a link and the ground"),
        "{}",
        found.message
    );
}

/// Its links have other indices in the world.
#[test]
fn a_further_robot_has_pairs_of_its_own() {
    let settings = "[[world.robot]]\nname = \"left\"\nurdf = \"a\"\nxyz = [0, 3]\n".to_owned()
        + &pair("stand", "\"chassis\"", "\"ground\"");
    let settings = Settings::parse(&settings, "test.toml").expect("legal settings");
    let own = pair("stand", "[\"ground\"]", "\"*_wheel\"");
    let own = Settings::parse(&own, "own.toml").expect("legal settings");
    let own = of_robot(&settings.robots[0], own, &settings).expect("no contradiction");
    let guests = [Guest {
        name: "left".to_owned(),
        kind: RootKind::Robot,
        description: cart(),
        settings: own,
    }];
    let model = world(&cart(), &settings, &guests).expect("a world").model;
    let wheels = vec!["left.left_wheel", "left.right_wheel"];
    assert_eq!(sides(&model, 0), [vec!["ground"], wheels]);
    assert_eq!(sides(&model, 1), [["chassis"], ["ground"]]);
    let all = names(&model);
    for name in ["pair.left_stand.depth", "pair.stand.depth"] {
        assert!(all.iter().any(|n| n == name), "{name} of {all:#?}");
    }
}
