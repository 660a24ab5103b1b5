//! Where a servo that nobody commands begins.

use super::*;

const COMMAND: u32 = 0;
const START: u32 = 1;
const POSITION: u32 = 2;

/// The rover with a position servo on its axle.
fn servo(version: Version) -> Instance {
    let mut model = rover();
    model.actuators[0].mode = ActuatorMode::Position;
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
