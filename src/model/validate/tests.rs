use super::*;
use crate::assemble::testing::{at, body, frame, mass, model, robot};
use crate::model::Limits;
use crate::simulation::{ParameterSlot, Simulation};
use crate::spatial::{Pose, Vec3};
use crate::variables::{Slot, table};
use serde_json::Value;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// All kinds of joints, shapes and actuators in one robot.
fn everything() -> Model {
    let mut trunk = body("trunk", 3.0);
    for shape in [
        Shape::Box {
            half: Vec3::new(0.1, 0.2, 0.3),
        },
        Shape::Cylinder {
            radius: 0.1,
            half_length: 0.2,
        },
        Shape::Capsule {
            radius: 0.1,
            half_length: 0.1,
        },
        Shape::Hull {
            vertices: vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()],
        },
    ] {
        trunk
            .collisions
            .push(crate::assemble::testing::collision(Pose::IDENTITY, shape));
    }
    let description = robot(trunk)
        .with(
            "trunk",
            "wheel",
            JointKind::Continuous,
            at(0.0, 0.2, 0.0),
            body("rim", 1.0),
        )
        .with(
            "trunk",
            "lift",
            JointKind::Prismatic,
            at(0.0, 0.0, 0.4),
            mass("fork", 1.0),
        )
        .with(
            "fork",
            "finger",
            JointKind::Revolute,
            at(0.1, 0.0, 0.0),
            mass("tip", 0.1),
        )
        .mimicking("wheel", -0.5, 0.1)
        .and(|j| {
            j.limits = Some(Limits {
                lower: -3.0,
                upper: 3.0,
            });
        })
        .with(
            "fork",
            "eye",
            JointKind::Fixed,
            at(0.0, 0.0, 0.1),
            frame("camera"),
        )
        .with(
            "trunk",
            "plane",
            JointKind::Planar,
            at(0.0, 0.0, 1.0),
            mass("puck", 1.0),
        )
        .with(
            "trunk",
            "free",
            JointKind::Floating,
            at(0.0, 0.0, 2.0),
            body("drone", 1.0),
        );
    model(
        &description,
        "[[actuator]]\njoint = \"wheel\"\nmode = \"pd\"\nkp = 1\nkd = 1\n\
         [outputs]\nlinks = [\"*\"]\n[[outputs.pair]]\nname = \"stand\"\n\
         first = [\"trunk\", \"rim\"]\nsecond = \"ground\"\n\
         [[external_wrench]]\nlink = \"trunk\"\n",
    )
}

/// Pointers to every value of a tree.
fn pointers(value: &Value, path: &str, found: &mut Vec<String>) {
    found.push(path.to_owned());
    match value {
        Value::Array(list) => {
            for (i, value) in list.iter().enumerate() {
                pointers(value, &format!("{path}/{i}"), found);
            }
        }
        Value::Object(map) => {
            for (key, value) in map {
                pointers(value, &format!("{path}/{key}"), found);
            }
        }
        _ => {}
    }
}

/// What could be there instead.
fn damages(value: &Value) -> Vec<Value> {
    let mut damages = vec![Value::Null];
    match value {
        Value::Number(_) => {
            for number in [
                "-1",
                "0",
                "1",
                "2",
                "7",
                "4294967295",
                "1e9",
                "-1e-3",
                "1e60",
                "0.5",
            ] {
                damages.push(number.parse().map_or(Value::Null, Value::Number));
            }
        }
        Value::Array(list) => {
            damages.push(Value::Array(Vec::new()));
            if let Some((first, rest)) = list.split_first() {
                damages.push(Value::Array(rest.to_vec()));
                let mut longer = list.clone();
                longer.push(first.clone());
                damages.push(Value::Array(longer));
                let mut turned = list.clone();
                turned.reverse();
                damages.push(Value::Array(turned));
            }
        }
        Value::String(_) => {
            for word in [
                "",
                "fixed",
                "continuous",
                "floating",
                "welded",
                "free",
                "spherical",
                "pd",
            ] {
                damages.push(word.into());
            }
        }
        Value::Bool(flag) => damages.push((!flag).into()),
        Value::Null => damages.push(0.into()),
        Value::Object(_) => {}
    }
    damages
}

#[test]
fn no_damaged_model_can_make_the_simulation_panic() {
    let whole = serde_json::to_value(everything()).expect("JSON");
    let mut paths = Vec::new();
    pointers(&whole, "", &mut paths);
    let (mut refused, mut run) = (0, 0);
    for path in paths {
        let at = whole.pointer(&path).expect("a place");
        for damage in damages(at) {
            if *at == damage {
                continue;
            }
            let mut damaged = whole.clone();
            *damaged.pointer_mut(&path).expect("a place") = damage.clone();
            let legal = serde_json::from_value::<Model>(damaged)
                .ok()
                .filter(|model| model.validate().is_ok());
            let Some(model) = legal else {
                refused += 1;
                continue;
            };
            run += 1;
            let done = catch_unwind(AssertUnwindSafe(|| {
                let rows = table(&model).unwrap_or_default();
                let mut simulation = Simulation::new(Arc::new(model));
                // Error control needs billions of steps where something turns at 1e9 rad/s.
                if damage.as_f64().is_some_and(|x| x.abs() > 1e3) {
                    simulation.set_parameter(ParameterSlot::StepSize, 1e-3);
                }
                if simulation.initialize(0.0).is_ok() {
                    let _ = simulation.advance_to(1e-3);
                }
                for row in rows {
                    if let Slot::Output(slot) = row.slot {
                        let _ = simulation.output(slot);
                    }
                }
            }));
            assert!(done.is_ok(), "{path} = {damage} panics");
        }
    }
    // Both ways are taken often: most numbers may be anything, no index may.
    assert!(refused > 1000 && run > 1000, "{refused} refused, {run} run");
}

#[test]
fn a_model_with_wrong_rotations_axes_or_names_is_refused() {
    let whole = everything();
    let wrong = |change: fn(&mut Model)| {
        let mut model = whole.clone();
        change(&mut model);
        model.validate().expect_err("wrong").to_string()
    };
    assert!(wrong(|m| m.joints[0].axis *= 1.1).contains("joint 'wheel'"));
    assert!(wrong(|m| m.links[4].X_BL.R *= -1.0).contains("link 'camera'"));
    assert!(wrong(|m| m.bodies[1].X_PB.R[(0, 0)] = 0.9).contains("body 1"));
    assert!(wrong(|m| m.links[1].name = "trunk".into()).contains("another link"));
    assert!(wrong(|m| m.roots[0].rpy.x = f64::NAN).contains("initial"));
    assert!(wrong(|m| m.colliders[2].body = 7_usize.into()).contains("collider 2"));
    assert!(wrong(|m| m.dofs.clear()).contains("coordinates"));
    let pair = "pair 'stand'";
    assert!(wrong(|m| m.outputs.pairs[0].sides[1].clear()).contains(pair));
    assert!(wrong(|m| m.outputs.pairs[0].sides[0].reverse()).contains(pair));
    assert!(wrong(|m| m.outputs.pairs[0].sides[0][1] = Some(99_usize.into())).contains(pair));
    assert!(wrong(|m| m.outputs.pairs[0].sides[0].insert(0, None)).contains("both sides"));
    assert!(wrong(|m| m.outputs.pairs.push(m.outputs.pairs[0].clone())).contains("another pair"));
}
