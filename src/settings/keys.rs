//! Every key of the settings file: type and range, default, purpose.
//!
//! A path names tables by dots; `*` stands for a name that the user chooses (a glob over joints or
//! links), `[]` for the elements of an array of tables.
//!
//! Over 500 lines because it is one table.

use crate::range::Range;

/// One key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Where it stands, such as `solver.tolerance` or `actuator[].joint`.
    pub path: &'static str,
    /// What may be given.
    pub takes: Takes,
    /// What holds where it is not given, in TOML; none where something else decides (see `about`).
    pub default: Option<&'static str>,
    /// What it is for, with its unit.
    pub about: &'static str,
}

/// What a key takes.
#[derive(Clone, Copy, Debug)]
pub enum Takes {
    /// A finite number of a range.
    Number(Range),
    /// The same, or a text like `"1/240"`.
    NumberOrRatio(Range),
    /// `true` or `false`.
    Flag,
    /// One of some words.
    Word(&'static [&'static str]),
    /// A name or glob.
    Pattern,
    /// A name of the user's own.
    Name,
    /// A file; a relative one counts from the folder of the settings.
    File,
    /// A whole number from 1 on, with its greatest.
    Count(u32),
    /// One of some whole numbers.
    Version(&'static [u32]),
    /// A list of names or globs.
    Patterns,
    /// A name or glob, or a list of them.
    PatternOrPatterns,
    /// One of some words, or a list of names or globs.
    WordOrPatterns(&'static [&'static str]),
    /// A list of numbers of a range, with its least and greatest length.
    Numbers(usize, usize, Range),
    /// So many lists of three numbers of a range.
    Vectors(usize, Range),
}

impl Takes {
    /// The range of each number.
    pub fn range(self) -> Option<Range> {
        match self {
            Self::Number(range)
            | Self::NumberOrRatio(range)
            | Self::Numbers(_, _, range)
            | Self::Vectors(_, range) => Some(range),
            _ => None,
        }
    }
}

use Range::{
    Bias, Coefficient, Density, Dissipation, Duration, Flight, Friction, Gravity, Length, Limit,
    LimitSize, Mass, Near, Noise, Penetration, Position, Rate, Ratio, ReferenceSpeed, Restitution,
    Scale, Spin, Step, Steps, Stiffness, Tolerance, Velocity, View, Work,
};
use Takes::{
    Count, File, Flag, Name, Number, NumberOrRatio, Numbers, Pattern, PatternOrPatterns, Patterns,
    Vectors, Version, Word, WordOrPatterns,
};

const fn key(
    path: &'static str,
    takes: Takes,
    default: Option<&'static str>,
    about: &'static str,
) -> Key {
    Key {
        path,
        takes,
        default,
        about,
    }
}

/// The table.
pub const KEYS: &[Key] = &[
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
        Word(&["urdf", "collision", "pybullet"]),
        Some("\"urdf\""),
        "rotational inertia from the file, or recomputed: of the collision shapes as solids, or of the box around them as PyBullet does",
    ),
    key(
        "robot.density",
        Number(Density),
        None,
        "kg/m³, of links that the file gives no mass: they weigh what their collision shapes weigh as solids; without it they have none",
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
    key(
        "world.gravity",
        Numbers(3, 3, Gravity),
        Some("[0, 0, -9.81]"),
        "m/s²",
    ),
    key(
        "world.ground.type",
        Word(&["plane", "none"]),
        Some("\"plane\""),
        "what there is to stand on: the plane z = 0, or nothing; other ground is [[world.terrain]]",
    ),
    key(
        "world.ground.friction",
        Number(Friction),
        Some("0.8"),
        "Coulomb coefficient; combined with the link's by the harmonic mean",
    ),
    key(
        "world.ground.static_friction",
        Number(Friction),
        None,
        "Coulomb coefficient at rest, not below friction; without it the same; combined likewise",
    ),
    key(
        "world.ground.rolling_friction",
        Number(Friction),
        Some("0"),
        "m: moment against rolling over normal force; combined with the link's by the larger of the two",
    ),
    key(
        "world.ground.torsional_friction",
        Number(Friction),
        Some("0"),
        "m: moment against turning about the normal over normal force; combined likewise",
    ),
    key(
        "world.ground.restitution",
        Number(Restitution),
        Some("0.0"),
        "Newton's coefficient; combined with the link's by the larger of the two",
    ),
    key(
        "world.object[].name",
        Name,
        None,
        "a name of its own, in the names of its variables: object.<name>.…",
    ),
    key(
        "world.object[].urdf",
        File,
        None,
        "the file that says what it is, from the folder of the settings; its joints are passive",
    ),
    key(
        "world.object[].shape.box",
        Numbers(3, 3, Length),
        None,
        "m, instead of urdf: the sides along x, y, z",
    ),
    key(
        "world.object[].shape.sphere",
        Number(Length),
        None,
        "m, instead of urdf: the radius",
    ),
    key(
        "world.object[].shape.cylinder",
        Numbers(2, 2, Length),
        None,
        "m, instead of urdf: radius and length along z",
    ),
    key(
        "world.object[].shape.capsule",
        Numbers(2, 2, Length),
        None,
        "m, instead of urdf: radius and length along z without the round ends",
    ),
    key(
        "world.object[].mass",
        Number(Mass),
        None,
        "kg, of a shape; its inertia is that of a solid. A static one needs none",
    ),
    key(
        "world.object[].xyz",
        Numbers(2, 3, Position),
        None,
        "m, base position; z, or all of it, may be left out: the lowest collision point then touches the ground, but a static one of a file is mounted at z = 0",
    ),
    key(
        "world.object[].rpy",
        Numbers(3, 3, Position),
        None,
        "rad, base roll, pitch, yaw; without it 0",
    ),
    key(
        "world.object[].linear_velocity",
        Numbers(3, 3, Flight),
        None,
        "m/s at the start, world axes; without it 0",
    ),
    key(
        "world.object[].angular_velocity",
        Numbers(3, 3, Spin),
        None,
        "rad/s at the start, world axes; without it 0",
    ),
    key(
        "world.object[].static",
        Flag,
        None,
        "whether it stands still whatever pushes it; without it false, but what has no mass stands still",
    ),
    key(
        "world.object[].conveyor",
        Flag,
        None,
        "whether its surface moves: inputs object.<name>.surface.velocity.{x,y,z} in m/s, along its own axes, held over each communication step; without it false",
    ),
    key(
        "world.object[].friction",
        Number(Friction),
        None,
        "Coulomb coefficient of all its links; without it the file's, else 0.8",
    ),
    key(
        "world.object[].restitution",
        Number(Restitution),
        None,
        "Newton's coefficient of all its links; without it the file's, else 0",
    ),
    key(
        "world.terrain[].name",
        Name,
        None,
        "a name of its own, as of an object",
    ),
    key(
        "world.terrain[].type",
        Word(&["plane", "heightfield", "mesh"]),
        None,
        "a plane without an end, heights over a rectangle about its origin, or a triangle mesh; it never moves, and below its surface all is solid. With terrain there is no ground but that of a [world.ground]",
    ),
    key(
        "world.terrain[].file",
        File,
        None,
        "from the folder of the settings. Heights: a grey PNG of 8 or 16 bits, seen from above with y upwards; or a table of heights in m, as CSV or NPY, the first row at the lowest y. Mesh: STL, OBJ, PLY, COLLADA or glTF in m, with its outside upwards",
    ),
    key(
        "world.terrain[].generate",
        Word(&["ramp", "steps", "waves", "noise"]),
        None,
        "heights without a file, from 0 up to height: up along x over the middle third; up along x in steps; ½ height · (1 − cos(2π x/wavelength)); smooth noise",
    ),
    key(
        "world.terrain[].size",
        Numbers(2, 2, Length),
        None,
        "m, of heights: extent along x and y; the origin is in the middle",
    ),
    key(
        "world.terrain[].height",
        Number(Length),
        None,
        "m, of an image: of white over black; of what is generated: from the lowest to the highest; a factor on the heights of a table; without it 1",
    ),
    key(
        "world.terrain[].resolution",
        Number(Length),
        None,
        "m, of what is generated: distance between samples; without it a hundredth of the longer side",
    ),
    key(
        "world.terrain[].wavelength",
        Number(Length),
        None,
        "m, of waves and noise; without it a tenth of the longer side",
    ),
    key(
        "world.terrain[].seed",
        Count(1_000_000),
        None,
        "of noise; without it 1",
    ),
    key(
        "world.terrain[].steps",
        Count(10_000),
        None,
        "how many steps; without it 5",
    ),
    key(
        "world.terrain[].scale",
        Number(Scale),
        None,
        "of a mesh: factor on its lengths; without it 1",
    ),
    key(
        "world.terrain[].xyz",
        Numbers(2, 3, Position),
        None,
        "m, its origin; without it 0",
    ),
    key(
        "world.terrain[].rpy",
        Numbers(3, 3, Position),
        None,
        "rad, roll, pitch, yaw; without it 0",
    ),
    key(
        "world.terrain[].conveyor",
        Flag,
        None,
        "whether its surface moves: inputs object.<name>.surface.velocity.{x,y,z} in m/s, along its own axes, held over each communication step; without it false",
    ),
    key(
        "world.terrain[].friction",
        Number(Friction),
        None,
        "Coulomb coefficient; without it 0.8",
    ),
    key(
        "world.terrain[].restitution",
        Number(Restitution),
        None,
        "Newton's coefficient; without it 0",
    ),
    key(
        "world.robot[].name",
        Name,
        None,
        "what the names of its variables begin with: <name>.cmd.…",
    ),
    key(
        "world.robot[].urdf",
        File,
        None,
        "the file that says what it is, from the folder of the settings",
    ),
    key(
        "world.robot[].config",
        File,
        None,
        "its own settings: [robot], [initial], [[actuator]], [joint], [link], [outputs] … as in this file",
    ),
    key(
        "world.robot[].xyz",
        Numbers(2, 3, Position),
        None,
        "m, base position; without it that of its own settings, see initial.xyz",
    ),
    key(
        "world.robot[].rpy",
        Numbers(3, 3, Position),
        None,
        "rad, base roll, pitch, yaw; without it those of its own settings",
    ),
    key(
        "world.robot[].fixed_base",
        Flag,
        None,
        "whether its base is mounted in the world; without it as its own settings say",
    ),
    key(
        "initial.xyz",
        Numbers(2, 3, Position),
        None,
        "m, base position; z, or all of it, may be left out: the lowest collision point then touches the ground",
    ),
    key(
        "initial.rpy",
        Numbers(3, 3, Position),
        Some("[0, 0, 0]"),
        "rad, base roll, pitch, yaw",
    ),
    key(
        "initial.linear_velocity",
        Numbers(3, 3, Flight),
        Some("[0, 0, 0]"),
        "m/s, of a floating base, world axes",
    ),
    key(
        "initial.angular_velocity",
        Numbers(3, 3, Spin),
        Some("[0, 0, 0]"),
        "rad/s, of a floating base, world axes",
    ),
    key(
        "initial.joints.*",
        Number(Position),
        None,
        "rad or m, by joint name or glob",
    ),
    key(
        "initial.joint_velocities.*",
        Number(Velocity),
        None,
        "rad/s or m/s, by joint name or glob",
    ),
    key(
        "actuator[].joint",
        Pattern,
        None,
        "joint name or glob; later entries win",
    ),
    key(
        "actuator[].mode",
        Word(&["velocity", "position", "effort", "pd", "none"]),
        None,
        "what is commanded; without it position for limited joints, velocity for the others",
    ),
    key(
        "actuator[].max_effort",
        Number(LimitSize),
        None,
        "N·m or N; without it the file's effort limit",
    ),
    key(
        "actuator[].no_load_speed",
        Number(ReferenceSpeed),
        None,
        "rad/s or m/s at which the motor has no effort left to drive with: max_effort falls in proportion to the speed, for braking it stays; without it, it does not depend on the speed",
    ),
    key(
        "actuator[].kp",
        Number(Coefficient),
        None,
        "N·m/rad or N/m, pd mode",
    ),
    key(
        "actuator[].kd",
        Number(Coefficient),
        None,
        "N·m·s/rad or N·s/m, pd mode",
    ),
    key(
        "joint.*.damping",
        Number(Coefficient),
        None,
        "N·m·s/rad or N·s/m, instead of the file's",
    ),
    key(
        "joint.*.friction",
        Number(Coefficient),
        None,
        "N·m or N, dry, instead of the file's",
    ),
    key(
        "joint.*.static_friction",
        Number(Coefficient),
        None,
        "N·m or N, dry friction at rest, not below friction; without it the same",
    ),
    key(
        "joint.*.stribeck_velocity",
        Number(ReferenceSpeed),
        None,
        "rad/s or m/s at which friction has lost 63 % of what static_friction has more; without it 0.01",
    ),
    key(
        "joint.*.armature",
        Number(Coefficient),
        None,
        "kg·m² or kg: rotor inertia times gear ratio squared, instead of the file's",
    ),
    key(
        "joint.*.limits.lower",
        Number(Limit),
        None,
        "rad or m, instead of the file's",
    ),
    key(
        "joint.*.limits.upper",
        Number(Limit),
        None,
        "rad or m, instead of the file's",
    ),
    key(
        "joint.*.effort",
        Number(LimitSize),
        None,
        "N·m or N, instead of the file's effort limit",
    ),
    key(
        "joint.*.velocity",
        Number(LimitSize),
        None,
        "rad/s or m/s, instead of the file's velocity limit; 0: none",
    ),
    key(
        "joint.*.enforce_velocity",
        Flag,
        None,
        "whether a damper holds the joint at its velocity limit: 1 % above it under the effort limit; without it false, but position servos keep to the limit anyway",
    ),
    key(
        "ignore_contact[].links",
        Patterns,
        None,
        "links that do not touch each other",
    ),
    key(
        "group[].name",
        Name,
        None,
        "takes the place of the joint's in the inputs' names: cmd.<group>.velocity",
    ),
    key(
        "group[].joints",
        Patterns,
        None,
        "commanded joints of one mode that share their inputs and gains",
    ),
    key(
        "outputs.contacts",
        WordOrPatterns(&["auto", "none"]),
        Some("\"auto\""),
        "links with contact outputs; auto: all that have collision shapes and can move, none without \
         a ground",
    ),
    key(
        "outputs.contact_points",
        Flag,
        Some("false"),
        "whether contact outputs include the point where the normal forces act",
    ),
    key(
        "outputs.links",
        Patterns,
        Some("[]"),
        "links with pose and velocity outputs",
    ),
    key(
        "outputs.loops",
        Patterns,
        Some("[]"),
        "loops with outputs of their force, torque and gap",
    ),
    key(
        "outputs.springs",
        Patterns,
        Some("[]"),
        "springs with outputs of their force and length",
    ),
    key(
        "outputs.pair[].name",
        Name,
        None,
        "in the names of its outputs: pair.<name>.…; what its two sides do to each other",
    ),
    key(
        "outputs.pair[].first",
        PatternOrPatterns,
        None,
        "the side whose force it is: links of the robot, others as cup.handle, all of one as cup, or ground",
    ),
    key(
        "outputs.pair[].second",
        PatternOrPatterns,
        None,
        "the other side, likewise",
    ),
    key(
        "loop[].type",
        Word(&["weld", "ball", "hinge", "distance", "gear", "coupler"]),
        None,
        "what closes the loop: two frames as one, two points as one, the same and two axes as one, the distance of two points; the speeds of two joints, a sum of positions of joints",
    ),
    key(
        "loop[].name",
        Name,
        None,
        "in messages and outputs: loop.<name>.…; without it loop1, loop2, …",
    ),
    key(
        "loop[].links",
        Patterns,
        None,
        "weld, ball, hinge, distance: the two links, with the name of their robot or object in front where it is another one; 'world' for the world",
    ),
    key(
        "loop[].origins",
        Vectors(2, Position),
        None,
        "m: where it holds each of the links, from the link's origin; without it 0",
    ),
    key(
        "loop[].rpy",
        Vectors(2, Position),
        None,
        "rad, weld: axes in each of the links; without it 0",
    ),
    key(
        "loop[].axes",
        Vectors(2, Position),
        None,
        "hinge: its axis in each of the links, of any length; without it z",
    ),
    key(
        "loop[].length",
        Number(Length),
        None,
        "m, distance: how far the points are apart; without it as far as they are at the start",
    ),
    key(
        "loop[].joints",
        Patterns,
        None,
        "gear: two joints, coupler: one or more, that turn or slide",
    ),
    key(
        "loop[].ratio",
        Number(Ratio),
        None,
        "gear: speed of the first joint over that of the second; they mesh as they are at the start",
    ),
    key(
        "loop[].factors",
        Numbers(1, 64, Ratio),
        None,
        "coupler: what each joint's position is multiplied by",
    ),
    key(
        "loop[].sum",
        Number(Position),
        None,
        "coupler: what the sum of these products is; without it 0",
    ),
    key(
        "spring[].name",
        Name,
        None,
        "in messages and outputs: spring.<name>.…; without it spring1, spring2, …",
    ),
    key(
        "spring[].links",
        Patterns,
        None,
        "the two links, as of a loop",
    ),
    key(
        "spring[].origins",
        Vectors(2, Position),
        None,
        "m: where it hangs on each of the links; without it 0",
    ),
    key(
        "spring[].stiffness",
        Number(Coefficient),
        None,
        "N/m; without it 0",
    ),
    key(
        "spring[].damping",
        Number(Coefficient),
        None,
        "N.s/m along the line between the points; without it 0",
    ),
    key(
        "spring[].length",
        Number(Coefficient),
        None,
        "m without force; without it 0",
    ),
    key(
        "sensor[].type",
        Word(&["imu", "ft", "ray", "encoder", "contact"]),
        None,
        "inertial unit on a link, force and torque in a joint, distances from a link to what is in the way, position of a joint in whole steps, what presses on a link",
    ),
    key(
        "sensor[].name",
        Name,
        None,
        "in the outputs' names: sensor.<name>.…; without it the link's or joint's",
    ),
    key(
        "sensor[].link",
        Pattern,
        None,
        "imu, ray and contact: where it is fixed",
    ),
    key(
        "sensor[].joint",
        Pattern,
        None,
        "ft: the joint, fixed or moving; encoder: a joint that turns or slides",
    ),
    key(
        "sensor[].xyz",
        Numbers(3, 3, Position),
        None,
        "m, imu, ray and contact: origin in the link; without it 0",
    ),
    key(
        "sensor[].rpy",
        Numbers(3, 3, Position),
        None,
        "rad, imu, ray and contact: axes in the link; without it 0. A row of rays lies in the plane x y, the middle one along x",
    ),
    key(
        "sensor[].frame",
        Word(&["child", "parent"]),
        None,
        "ft: whose axes; without it the child's",
    ),
    key(
        "sensor[].direction",
        Word(&["parent_to_child", "child_to_parent"]),
        None,
        "ft: whose force on whom; without it parent_to_child",
    ),
    key(
        "sensor[].rate",
        Number(Rate),
        None,
        "samples a second, each held until the next; taken at the first communication point at or after its time. Without it the sensor follows the state",
    ),
    key(
        "sensor[].seed",
        Count(1_000_000_000),
        None,
        "of the noise, which is the same in every run; without it 1",
    ),
    key(
        "sensor[].angular_velocity.bias",
        Numbers(3, 3, Bias),
        None,
        "rad/s, imu: added per axis; without it 0",
    ),
    key(
        "sensor[].angular_velocity.noise",
        Numbers(3, 3, Noise),
        None,
        "rad/s, imu: standard deviation of each sample, per axis; needs rate; without it 0",
    ),
    key(
        "sensor[].angular_velocity.noise_density",
        Numbers(3, 3, Noise),
        None,
        "rad/s √s, imu, instead of noise: that over the root of the rate, as data sheets have it",
    ),
    key(
        "sensor[].linear_acceleration.bias",
        Numbers(3, 3, Bias),
        None,
        "m/s², imu: added per axis; without it 0",
    ),
    key(
        "sensor[].linear_acceleration.noise",
        Numbers(3, 3, Noise),
        None,
        "m/s², imu: standard deviation of each sample, per axis; needs rate; without it 0",
    ),
    key(
        "sensor[].linear_acceleration.noise_density",
        Numbers(3, 3, Noise),
        None,
        "m/s² √s, imu, instead of noise: that over the root of the rate, as data sheets have it",
    ),
    key(
        "sensor[].force.bias",
        Numbers(3, 3, Bias),
        None,
        "N, ft: added per axis; without it 0",
    ),
    key(
        "sensor[].force.noise",
        Numbers(3, 3, Noise),
        None,
        "N, ft: standard deviation of each sample, per axis; needs rate; without it 0",
    ),
    key(
        "sensor[].torque.bias",
        Numbers(3, 3, Bias),
        None,
        "N·m, ft: added per axis; without it 0",
    ),
    key(
        "sensor[].torque.noise",
        Numbers(3, 3, Noise),
        None,
        "N·m, ft: standard deviation of each sample, per axis; needs rate; without it 0",
    ),
    key(
        "sensor[].distance.bias",
        Number(Bias),
        None,
        "m, ray: added where something is hit; without it 0",
    ),
    key(
        "sensor[].distance.noise",
        Number(Noise),
        None,
        "m, ray: standard deviation of each sample where something is hit; needs rate; without it 0",
    ),
    key(
        "sensor[].rays",
        Count(10_000),
        None,
        "ray: their number in a row; without it 1",
    ),
    key(
        "sensor[].fov",
        Number(View),
        None,
        "rad, ray: angle from the first to the last of a row, from right to left; without it 0",
    ),
    key(
        "sensor[].rows",
        Count(10_000),
        None,
        "ray: number of rows, with at most 10000 rays in all; without it 1",
    ),
    key(
        "sensor[].vertical_fov",
        Number(View),
        None,
        "rad, ray: angle from the lowest to the highest row; without it 0",
    ),
    key(
        "sensor[].range",
        Number(Length),
        None,
        "m, ray: largest distance, given where there is nothing; without it 10",
    ),
    key(
        "sensor[].min_range",
        Number(Near),
        None,
        "m, ray: where rays begin, less than range; what lies wholly before it is not seen; without it 0",
    ),
    key(
        "sensor[].hits",
        Flag,
        None,
        "ray: whether there are outputs that tell what is hit; without it false",
    ),
    key(
        "sensor[].ignore",
        Patterns,
        None,
        "ray: links that its rays go through; those of its own body they do anyway",
    ),
    key(
        "sensor[].counts",
        Number(Steps),
        None,
        "encoder: steps in a turn, or in a metre",
    ),
    key(
        "sensor[].size",
        Numbers(3, 3, Length),
        None,
        "m, contact: sides of the box about its frame in which contacts count; without it all of the link's",
    ),
    key(
        "external_wrench[].link",
        Pattern,
        None,
        "link name or glob that gets force and torque inputs",
    ),
    key(
        "link.*.friction",
        Number(Friction),
        None,
        "Coulomb coefficient; without it the file's, else 0.8",
    ),
    key(
        "link.*.static_friction",
        Number(Friction),
        None,
        "Coulomb coefficient at rest, not below friction; without it the file's, else the same",
    ),
    key(
        "link.*.rolling_friction",
        Number(Friction),
        None,
        "m: moment against rolling over normal force; without it the file's, else 0",
    ),
    key(
        "link.*.torsional_friction",
        Number(Friction),
        None,
        "m: moment against turning about the contact normal over normal force; without it the file's, else 0",
    ),
    key(
        "link.*.restitution",
        Number(Restitution),
        None,
        "Newton's coefficient; without it the file's, else 0",
    ),
    key(
        "link.*.stiffness",
        Number(Stiffness),
        None,
        "N/m, the robot's weight over the depth of a contact of the link under it; without it [contact]'s",
    ),
    key(
        "link.*.dissipation",
        Number(Dissipation),
        None,
        "s/m, of the link's contact points where restitution is 0; without it [contact]'s",
    ),
    key(
        "link.*.wheel_fit",
        Word(&["auto", "cylinder", "sphere", "none"]),
        None,
        "what the link's collision meshes roll as: fitted to the mesh about its joint's axis, or none; without it auto: on a continuous joint, where the mesh is off the circle by less than 5 % of its radius",
    ),
    key(
        "link.*.collision",
        Word(&["hull", "decomposition"]),
        None,
        "what the link's collision meshes become: their convex hulls, or a few convex parts each (at most 16, of 32 corners) that leave notches open; without it hull",
    ),
    key(
        "link.*.mass",
        Number(Mass),
        None,
        "kg, instead of the file's; the inertia scales with it",
    ),
];

/// The key at `path`.
pub fn find(path: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.path == path)
}

/// The names that may stand in the table at `path` (`""` is the file itself), each once, in file
/// order; `*` where the user chooses the names.
pub fn children(path: &str) -> Vec<&'static str> {
    let mut names = Vec::new();
    for key in KEYS {
        let rest = if path.is_empty() {
            Some(key.path)
        } else {
            key.path
                .strip_prefix(path)
                .and_then(|rest| rest.strip_prefix('.'))
        };
        let Some(rest) = rest else { continue };
        let name = rest.split(['.', '[']).next().unwrap_or(rest);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
