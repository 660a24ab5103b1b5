//! Where a servo that nobody commands begins.

use super::*;

const COMMAND: u32 = 0;
const START: u32 = 1;
const POSITION: u32 = 2;

/// The rover with a position servo on its axle.
fn servo(version: Version) -> Instance {
    let mut model = rover();
    model.actuators[0].mode = ActuatorMode::Position;
    servos(version, model)
}

fn servos(version: Version, model: Model) -> Instance {
    let axle = JointId(0);
    let slots = [
        Slot::Input(InputSlot::Position(0.into())),
        Slot::Parameter(ParameterSlot::InitialJointPosition(axle)),
        Slot::Output(OutputSlot::JointPosition(axle, 0)),
    ];
    let names = [
        "cmd.axle.position",
        "initial.joint.axle.position",
        "joint.axle.position",
    ];
    let rows: Vec<Variable> = rows()
        .into_iter()
        .zip(names.into_iter().zip(slots))
        .map(|(row, (name, slot))| Variable {
            name: name.into(),
            slot,
            kind: Kind::Real,
            max: None,
            ..row
        })
        .collect();
    let logger = Logger::new(Sink::None, std::ptr::null_mut(), false);
    let layout = Layout::new(version, &model, &rows).expect("no clash");
    let prepared = PreparedModel::new(String::new(), model);
    Instance::new(
        logger,
        (version, Interface::CoSimulation),
        GuidHash::new("{servo}"),
        (Arc::new(prepared.model), prepared.hash),
        rows,
        layout,
    )
}

/// Sets what is given in initialization mode, ends it, and reads the command and the joint.
fn begun(instance: &mut Instance, references: &[u32], values: &[f64]) -> Vec<f64> {
    instance.enter_initialization_mode();
    set(instance, references, values).expect("legal");
    instance.exit_initialization_mode().expect("legal");
    get(instance, &[COMMAND, POSITION]).expect("known")
}

#[test]
fn a_command_that_is_not_set_holds_the_position_that_initialization_gives() {
    for version in [Version::V2, Version::V3] {
        let mut instance = servo(version);
        assert_eq!(begun(&mut instance, &[START], &[1.0]), [1.0, 1.0]);
        for step in 0..24 {
            let time = f64::from(step) / 240.0;
            instance.do_step(time, 1.0 / 240.0).expect("finite");
        }
        let turned = get(&mut instance, &[POSITION]).expect("known")[0] - 1.0;
        assert!(turned.abs() < 1e-3, "{turned}");
        // What is set stays, in any order and to its start value, too.
        for (references, values, command) in [
            (&[START, COMMAND][..], [1.0, 0.5], 0.5),
            (&[COMMAND, START], [0.5, 1.0], 0.5),
            (&[COMMAND, START], [0.0, 1.0], 0.0),
        ] {
            instance.reset();
            assert_eq!(begun(&mut instance, references, &values), [command, 1.0]);
        }
        // Before it all, the command is read as it would be at the start.
        instance.reset();
        assert_eq!(get(&mut instance, &[COMMAND]).expect("known"), [0.0]);
        set(&mut instance, &[START], &[0.75]).expect("legal");
        assert_eq!(get(&mut instance, &[COMMAND]).expect("known"), [0.75]);
        // A state that is saved here knows that the command has not been set.
        let state = instance.save();
        instance.reset();
        instance.restore(&state).expect("its own state");
        assert_eq!(begun(&mut instance, &[START], &[0.25]), [0.25, 0.25]);
    }
}

/// A second axle, whose servo has one command with the first.
fn paired() -> Instance {
    let mut model = rover();
    model.actuators[0].mode = ActuatorMode::Position;
    model.links.push(Link {
        name: "other".into(),
        joint: Some(JointId(1)),
        body: 2.into(),
        ..model.links[1].clone()
    });
    model.joints.push(Joint {
        name: "second".into(),
        child: LinkId(2),
        bodies: vec![2.into()],
        ..model.joints[0].clone()
    });
    model.bodies.push(Body {
        link: 2.into(),
        joint: Some(1.into()),
        coordinate: 8,
        dof: DofId(7),
        ..model.bodies[1].clone()
    });
    model.dofs.push(Dof {
        body: 2.into(),
        limits: None,
    });
    model.nq = 9;
    model.actuators.push(Actuator {
        joint: JointId(1),
        dof: DofId(7),
        ..model.actuators[0].clone()
    });
    model.initial.joint_positions.push(0.0);
    model.initial.joint_velocities.push(0.0);
    model.outputs.groups.push(Group {
        name: "both".into(),
        actuators: vec![0.into(), 1.into()],
    });
    servos(Version::V3, model)
}

/// A command cannot hold two joints that begin apart: who does not set it hears which one moves.
#[test]
fn a_group_whose_joints_start_apart_is_told_where_its_command_is_not_set() {
    for (references, values, told) in [
        (&[][..], &[][..], false),
        (&[START], &[0.5], true),
        (&[START, COMMAND], &[0.5, 0.5], false),
    ] {
        let mut heard: Vec<String> = Vec::new();
        let mut instance = paired();
        let list = std::ptr::from_mut(&mut heard).cast();
        instance.logger = Logger::new(Sink::Fmi3(super::messages::keep), list, false);
        begun(&mut instance, references, values);
        drop(instance);
        let expected = "Warning logStatusWarning joints 'axle' and 'second' share a position \
                        command, which is not set and follows 'axle', but start at 0.5 and 0: the \
                        servo of 'second' moves it over with its whole effort; set their \
                        initial.joint.*.position alike, or the command";
        let expected = told.then(|| expected.to_owned());
        assert_eq!(heard, Vec::from_iter(expected), "{values:?}");
    }
}
