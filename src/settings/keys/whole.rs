//! The robot as a whole, its FMU, the solver and contacts.

use super::kinds::Takes::{Flag, Name, Number, NumberOrRatio, Patterns, Version, Word};
use super::kinds::{Key, key};
use crate::range::Range::{
    Density, Dissipation, Duration, Mass, Penetration, ReferenceSpeed, Scale, Step, Stiffness,
    Tolerance, Work,
};

/// Their keys, in the order of a file.
pub(super) const KEYS: &[Key] = &[
    key(
        "robot.base",
        Word(&["auto", "floating", "fixed"]),
        Some("\"auto\""),
        "whether the base can move; auto: fixed where the root is named 'world' or has no mass and a moving child",
    ),
    key(
        "robot.scale",
        Number(Scale),
        Some("1.0"),
        "every length times this; masses stay, so inertias grow with its square",
    ),
    key(
        "robot.inertia",
        Word(&["urdf", "nearest", "collision", "pybullet"]),
        Some("\"urdf\""),
        "rotational inertia from the file, with the nearest possible one where no body can have it, or recomputed: of the collision shapes as solids, or of the box around them as PyBullet does",
    ),
    key(
        "robot.density",
        Number(Density),
        None,
        "kg/m³, of links that the file gives no mass: they weigh what their collision shapes weigh as solids; without it they have none",
    ),
    key(
        "robot.missing_mass",
        Number(Mass),
        None,
        "kg, of links that move and that the file and density give no mass, where nothing that hangs on them has one: solids of their collision shapes, without any balls of 5 cm; without it they are an error",
    ),
    key(
        "robot.self_collision",
        Flag,
        Some("false"),
        "whether links touch each other; not those of one body, nor neighbours at a joint",
    ),
    key(
        "robot.sensors",
        Word(&["none", "urdf"]),
        Some("\"none\""),
        "whether <sensor> and <gazebo><sensor> of the URDF become sensors, besides those of [[sensor]]",
    ),
    key(
        "robot.compat",
        Word(&["none", "pybullet"]),
        Some("\"none\""),
        "conventions of another simulator; defaults change, see pybullet.md",
    ),
    key(
        "fmu.naming",
        Word(&["structured", "flat"]),
        Some("\"structured\""),
        "variable names with dots, or with underscores instead",
    ),
    key(
        "fmu.fmi",
        Version(&[2, 3]),
        Some("2"),
        "version of the Functional Mock-up Interface: 2 for FMI 2.0, 3 for FMI 3.0",
    ),
    key(
        "fmu.interface",
        Word(&["cs", "me", "both"]),
        Some("\"cs\""),
        "who integrates: the FMU (co-simulation), the importer (Model Exchange), or either",
    ),
    key(
        "fmu.arrays",
        Word(&["vectors", "none", "all"]),
        Some("\"vectors\""),
        "what FMI 3 lists as arrays: vectors of outputs and parameters; nothing; or vectors of inputs and of all joints, too",
    ),
    key(
        "fmu.name",
        Name,
        None,
        "modelName and, as far as C allows its letters, modelIdentifier; without it the robot's name",
    ),
    key(
        "fmu.author",
        Name,
        None,
        "whom modelDescription.xml names as author",
    ),
    key(
        "fmu.version",
        Name,
        None,
        "version of the model, in modelDescription.xml",
    ),
    key(
        "fmu.copyright",
        Name,
        None,
        "copyright of the model, in modelDescription.xml",
    ),
    key(
        "fmu.license",
        Name,
        None,
        "licence of the model, in modelDescription.xml; without it the one in documentation/licenses is named",
    ),
    key(
        "fmu.stop_time",
        Number(Duration),
        Some("10"),
        "s, end of the default experiment",
    ),
    key(
        "fmu.platforms",
        Patterns,
        Some("[]"),
        "systems that the FMU runs on, such as linux64 and win64, see platforms.md; none: all that the command has libraries for",
    ),
    key(
        "fmu.documentation",
        Flag,
        Some("true"),
        "whether the FMU has pictures and pages for people, which take two thirds of the time of an export and 0.3 MB; the licences stay",
    ),
    key(
        "fmu.reference_run",
        Flag,
        Some("false"),
        "whether the FMU has a run of two seconds, inputs and outputs, for whoever imports it, see fmi.md; it takes 0.1 to 1 MB",
    ),
    key(
        "solver.step_size",
        NumberOrRatio(Step),
        Some("0"),
        "s; 0: error controlled",
    ),
    key(
        "solver.tolerance",
        Number(Tolerance),
        None,
        "what a step may err by in each 0.1 s of its length, m, and rad at 1 m reach; without it the importer's, else 1e-3",
    ),
    key(
        "solver.max_steps",
        Number(Work),
        Some("1e5"),
        "most tries of a solver step in a communication step of up to 1 s, and in each second of a longer one; a step that needs more is discarded",
    ),
    key(
        "contact.penetration",
        Number(Penetration),
        Some("1e-4"),
        "m; a flat face sinks by half of it under the robot's weight",
    ),
    key(
        "contact.stiffness",
        Number(Stiffness),
        None,
        "N/m, the robot's weight over the depth of a contact under it; instead of penetration",
    ),
    key(
        "contact.dissipation",
        Number(Dissipation),
        Some("51"),
        "s/m, where restitution is 0",
    ),
    key(
        "contact.stribeck_velocity",
        Number(ReferenceSpeed),
        Some("0.01"),
        "m/s, sliding speed at which friction has lost 63 % of what static_friction has more",
    ),
];
