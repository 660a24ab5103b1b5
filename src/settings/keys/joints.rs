//! The start, joints and what drives them, and outputs.

use super::kinds::Takes::{
    Flag, Name, Number, Numbers, Pattern, PatternOrPatterns, Patterns, Word, WordOrPatterns,
};
use super::kinds::{Key, key};
use crate::range::Range::{
    Coefficient, Flight, Limit, LimitSize, Position, ReferenceSpeed, Spin, Velocity,
};

/// Their keys, in the order of a file.
pub(super) const KEYS: &[Key] = &[
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
        "links that do not touch each other; those of another robot or an object as cup.handle, all of one as cup, and a glob means theirs only if it has a dot",
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
];
