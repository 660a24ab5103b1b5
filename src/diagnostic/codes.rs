//! Every code of a finding, with what it means and what helps: `urdf2fmu explain`, `docs/codes.md`.
//!
//! `tests/documents.rs` compares this table with the codes in the source files.

use std::fmt::Write as _;

/// A code, what it means, what helps.
pub type Row = (&'static str, &'static str, &'static str);

/// All codes, sorted.
#[rustfmt::skip]
pub const CODES: &[Row] = &[
    ("A101", "A name or glob in the settings means no joint, link or other thing of the robot. A glob of `*` alone is a note.", "Use the nearest name, which the finding tells; `urdf2fmu info robot.urdf` lists all."),
    ("A102", "A name in the settings means something that has no such property, for instance a fixed joint that should be driven.", "Choose another one."),
    ("A103", "A joint mimics a joint that cannot be followed.", "Follow a joint that turns or slides."),
    ("A104", "Links move, but neither they nor what hangs on them has mass or rotational inertia. The solver would divide by zero.", "`--density 1000` gives links without mass that of their collision shapes, `--missing-mass 0.1` that much to those that cannot move without, `--compat pybullet` 1 kg to each; or write an `<inertial>` into each link that the finding names. The finding offers only what it has tried."),
    ("A105", "The base can move, but nothing has mass.", "As A104, or `--fixed-base`."),
    ("A106", "A start value lies outside of the joint's limits.", "Correct it in `[initial]`, or the limits."),
    ("A107", "How the base was chosen: floating, or fixed to the world.", "`--fixed-base`, `--floating-base`, or `[robot] base`."),
    ("A108", "Links on fixed joints are one body with their parents.", "Nothing: their names and frames stay."),
    ("A109", "Links without mass move. What hangs on them must give their joints inertia.", "Nothing, or an `<inertial>`."),
    ("A110", "The zero of a joint lies outside of its limits, so it starts at the nearest limit.", "`[initial] joints`."),
    ("A111", "The height at which the robot starts: its lowest collision point touches the ground.", "`[initial] xyz`."),
    ("A112", "The robot starts inside the ground. Contacts push it out.", "Give `[initial] xyz` another z, or leave it out."),
    ("A113", "The file gives a joint no effort limit, so one was chosen from the robot's weight.", "`[[actuator]] max_effort`, or `<limit effort>`."),
    ("A114", "A joint with an effort limit of 0 has no motor that could move it.", "`[[actuator]] max_effort`."),
    ("A115", "A velocity limit of 0 counts as none.", "Write the limit, or leave it out."),
    ("A116", "The file gives no friction coefficient, so the default is taken.", "`[link.\"…\"] friction`."),
    ("A117", "Position limits that do not form a range.", "Give both, the lower one first."),
    ("A118", "A joint may go only where those that mimic it may go.", "Correct the limits of the joints that mimic it."),
    ("A119", "Rotational inertia was computed from the collision shapes, or could not be.", "Nothing, or another `[robot] inertia`."),
    ("A120", "Gains of a pd joint that were chosen, or are out of range.", "`[[actuator]] kp`, `kd`."),
    ("A121", "The robot cannot be computed with: a number is not finite or out of all proportion, or there is too much of something.", "Check units: m, kg, s, rad."),
    ("A122", "Damping, friction or armature of a joint that one number cannot describe.", "Remove them, or use joints of one axis."),
    ("A123", "A link whose inertia is zero could not move, so it gets that of its collision shapes as solids.", "Write the inertia that the finding shows into the file."),
    ("A124", "Velocity limits do not bind a motor that is driven by velocity or effort.", "`[joint.\"…\"] enforce_velocity = true`."),
    ("A125", "Friction at rest is below sliding friction.", "Make it at least as large."),
    ("A126", "What the file's `<ros2_control>` or `<transmission>` takes, compared with the commands of the FMU.", "`--mode`, or `[[actuator]] mode`."),
    ("A127", "A wheel's mesh is so round that a cylinder or a ball rolls in its place.", "`[link.\"…\"] wheel_fit = \"none\"`."),
    ("A128", "A driven wheel's mesh is a polygon and will bump.", "Give it a cylinder as collision shape, or `wheel_fit`."),
    ("A130", "A `[[group]]` of joints that cannot share a command.", "Let it hold commanded joints of one mode."),
    ("A131", "A `[[sensor]]` that has no place, whose rays all around end where they begin, or whose box lies off its link.", "Name an existing link or joint; `fov` of n rays all around is 2π (n − 1)/n; a box lies about the sensor's frame in the link."),
    ("A132", "Links without `<inertial>` get the mass that another simulator gives them.", "Give the link an `<inertial>`."),
    ("A133", "Settings of a further robot that are the world's.", "Move them into the settings of the first robot."),
    ("A134", "An object is the ground.", "Nothing: it becomes `[world.ground]`."),
    ("A135", "Shapes of different robots or objects overlap at the start.", "Move one of them."),
    ("A136", "Links of one robot overlap before anything moves.", "Nothing, or `[[ignore_contact]]`."),
    ("A137", "A `[[outputs.pair]]` that is not valid.", "Name two sides that can touch."),
    ("A138", "Links without mass weigh what their collision shapes weigh by the density given, or, where they could not move, the missing mass.", "`[link.\"…\"] mass` sets the mass of one."),
    ("A139", "A name clashes with another one in the names of variables.", "Rename what the finding names."),
    ("A140", "A `[[loop]]` or `[[spring]]` that is not valid: a name that means nothing, two links that do not move against each other, or a second one of the same name; a warning for a loop that holds nothing, because its ends lie on the axis of the joint between its links.", "Correct what the finding names."),
    ("A141", "The initial pose was moved so that the loops close, or cannot be.", "Correct the places where a loop holds its links, or `[initial] joints`."),
    ("A142", "What Model Exchange has no equations for: a rebound, a sensor that takes samples or errs, a closed loop, more continuous states than importers can work with.", "Leave it out, or export with `--interface cs`."),
    ("A143", "Gravity points upwards, nearly always because its sign was forgotten; or along -y, as where y is up; or it is the earth's in mm/s² or cm/s².", "`[world] gravity = [0, 0, -9.81]`. What hangs from a ceiling is turned by `[initial] rpy` instead."),
    ("A144", "A setting that changes nothing: `stribeck_velocity` without friction at rest, `dissipation` beside `restitution`, a density or a missing mass that no link needs, a joint that stands twice in a `[[group]]`, the friction of a link without collision shapes, an `[[actuator]]` that a later one replaces, a contact sensor on which nothing can press.", "Leave it out, or set what it belongs to; the finding names that."),
    ("A145", "Contacts are so soft that the robot sinks into the ground by more than a twentieth of the smallest size of the shapes that it stands on.", "A smaller `[contact] penetration`, or a greater `stiffness`; the finding names the key and the depth."),
    ("R101", "The SRDF cannot be read.", "Give the SRDF of this robot."),
    ("R102", "The SRDF names a link or joint that the URDF does not have.", "Check that both belong together."),
    ("R103", "A pair of the SRDF stands twice, or is of a link with itself.", "Remove it."),
    ("R104", "The SRDF has no state of that name.", "Use one of those that the finding lists."),
    ("R105", "A position in the SRDF is no number, or outside of the limits; or a joint has two in one state.", "Correct it."),
    ("R106", "A report of what was read from the SRDF.", "Nothing."),
    ("S101", "The settings are not TOML.", "Correct the place that is marked."),
    ("S102", "An unknown key.", "Use the nearest one, which the finding names."),
    ("S103", "A value of the wrong type.", "Write what the finding asks for."),
    ("S104", "A value outside of its range.", "Check its unit."),
    ("S106", "Keys that contradict each other.", "Keep one of them."),
    ("S107", "A key that must be there is missing.", "Add it."),
    ("S108", "The settings cannot be read.", "Check the path."),
    ("S109", "`[fmu] platforms` names what is no platform, or one that the command has no library for.", "docs/platforms.md lists the names, and how to build the libraries."),
    ("T001", "A file of `[[world.terrain]]` cannot be read.", "Check its name: a relative one counts from the folder of the settings."),
    ("T002", "A file of `[[world.terrain]]` holds no heights or no triangles that could be used.", "Correct what the finding names."),
    ("T003", "A mesh of `[[world.terrain]]` has its outside down, so that what comes from above falls through it; or it is a room, with its outside inwards, which is a note; or a plane is upside down.", "Exchange two corners of each triangle, which modelling programs call to flip normals, unless robots are to be in the room."),
    ("T004", "A mesh of `[[world.terrain]]` is kilometres wide.", "`scale = 0.001`, if it is in mm."),
    ("T005", "A mesh of `[[world.terrain]]` has holes: edges that belong to one triangle alone go round a place that no triangle covers.", "Close them, unless things are to fall through. The finding says where the largest is."),
    ("T006", "Three columns of heights of `[[world.terrain]]` that look like x, y and z of points.", "Write the heights alone, and the extent as `size`."),
    ("T007", "What is not used of a file of heights: the alpha of an image, bytes behind the array of an NPY file.", "Save a grey PNG, whose brightness is the height, and one array to each file."),
    ("T008", "Waves of `[[world.terrain]]` that are longer than the terrain along x: they do not rise to `height`.", "A shorter `wavelength`, or a longer `size`; the finding says how high they rise."),
    ("U001", "The file cannot be read, is a folder, or is too large.", "Name the URDF file."),
    ("U002", "The file is not UTF-8 text.", "Save it as UTF-8."),
    ("U003", "The file is not XML.", "Correct the place that is marked; often a tag is not closed."),
    ("U004", "A DOCTYPE or an entity declaration, which are not read.", "Remove it."),
    ("U005", "The file has more elements, attributes or levels than any robot needs.", "Check that it is the right file."),
    ("U006", "The file is written in xacro and cannot be expanded, or an argument is missing.", "The finding shows the call; `--package NAME=DIR` for packages that `$(find NAME)` does not find."),
    ("U007", "The file is no URDF, but a mesh or XML of another kind.", "Give the URDF; SDF and MJCF must be converted first."),
    ("U008", "What strict XML readers refuse: something before the XML declaration or after the end, two hyphens within a comment.", "Remove it."),
    ("U010", "The robot has no links.", "Give the file of the whole robot; a file of macros alone is none. The finding names the files that call them."),
    ("U011", "Several links are no joint's child, so there is more than one root.", "Join them, or remove what is left over."),
    ("U012", "Joints form a cycle.", "Remove one of them: a URDF is a tree."),
    ("U013", "A link is the child of two joints.", "Remove one of them: a URDF is a tree."),
    ("U014", "Two links or two joints have one name.", "Rename one."),
    ("U015", "An attribute that must be there is missing.", "Write it."),
    ("U016", "A link that a joint names does not exist. `world` as a parent is taken as the world itself.", "Correct the name; the finding tells the nearest."),
    ("U017", "An element that must be there is missing. An `<inertial>` without `<mass>` counts as none.", "Add it."),
    ("U018", "An element stands twice, of which the first is used, or the same `<collision>` or `<visual>` twice, which both count, or several shapes in one `<geometry>`.", "Keep one; write one `<collision>` or `<visual>` for each shape."),
    ("U019", "An element, attribute or text that is unknown where it stands, or has the prefix of another language, and is ignored.", "Correct its name, or move it; the finding tells the nearest name, or where it belongs."),
    ("U020", "An element of the file that has no use here.", "Nothing."),
    ("U021", "A tag of another program refers to something that does not exist.", "Correct the name."),
    ("U022", "A tag that would change the motion in another program and is not used.", "Check whether the robot needs it."),
    ("U023", "A tag of another program that is read.", "Nothing."),
    ("U024", "The file was expanded from xacro; lines are those of the expanded text.", "`urdf2fmu expand` prints that text."),
    ("U030", "A word that is not a number.", "Write a decimal number; the decimal sign is a point."),
    ("U031", "Too few or too many numbers.", "Write as many as the finding says."),
    ("U032", "A number that is not finite or out of range. In a `<limit>` it counts as unlimited.", "Check its unit."),
    ("U033", "A number with an impossible sign, or a size of 0. Negative limits of effort and velocity count as none, shapes without size touch as points, lines or faces.", "Write the size in m, or remove the element."),
    ("U034", "The default of xacro's `optenv` is used.", "Name the file `.xacro`, so that it is expanded."),
    ("U035", "An angle that looks like degrees: more than two turns in an `<origin>` or a limit, unless they are quarter turns.", "Write it in radians: 90° are 1.5708."),
    ("U040", "An unknown type of joint.", "Use one of those that the finding lists."),
    ("U041", "An axis of zeros.", "Write its direction, such as `0 0 1`."),
    ("U043", "The lower limit is above the upper one: the range between them is used, or none where PyBullet's files write none so.", "Exchange them, or use `type=\"continuous\"`."),
    ("U044", "A joint that turns or slides has no `<limit>`, or no range in it, and counts as unlimited; or one end of the range alone, whose other is 0.", "Give the range, or use `type=\"continuous\"`."),
    ("U045", "A `<limit>` without effort or velocity, or with a velocity by which the joint needs hours for its range.", "Write them, or nothing: they count as unlimited."),
    ("U046", "A `<mimic>` of a joint that does not exist or cannot be followed, or in a circle.", "Correct the name."),
    ("U047", "A `<mimic>` of a joint that cannot follow.", "Remove it."),
    ("U060", "A negative mass.", "Write the mass in kg."),
    ("U061", "An inertia that no body can have: it is not positive definite.", "Check signs and order; the finding shows the nearest that is possible, and `--inertia nearest` uses it. `--inertia collision` computes all from the shapes."),
    ("U062", "An inertia that no body can have: one moment exceeds the sum of the others.", "As U061; it is used as it is."),
    ("U063", "A mass without rotational inertia, or an `<inertia>` without all of its numbers.", "Write the inertia, or use `--inertia collision`."),
    ("U064", "A mass of zero with an inertia, or one that is too small to count.", "Give a mass, or leave `<inertial>` out."),
    ("U065", "An inertia that does not fit the link's size, probably a placeholder or in another unit.", "`--inertia collision`."),
    ("U066", "Joints move nothing that has mass, in a file that is refused for something else at once.", "`--density 1000` where they have collision shapes, `--missing-mass 0.1` for what has none, or `--compat pybullet`, together with what mends the rest."),
    ("U067", "A robot that is lighter than the air in its place: its lengths, or those of its meshes, look like mm.", "`scale=\"0.001 0.001 0.001\"` in `<mesh>`, or `--scale 0.001` for all lengths."),
    ("U068", "What may be wrong, too, or follow from an error.", "Look at the names that it lists while you mend the errors."),
    ("U069", "An `<origin>` that is more than ten times as far away as the robot is large: it looks like mm or cm; or a mesh whose corners are as far from the frame of its link.", "Write it in m; `--scale 0.001` if all lengths of the file are in mm. Move a mesh to its origin, or give it an `<origin>` that does."),
    ("U070", "An unknown shape.", "Use one of those that the finding lists."),
    ("U071", "A coefficient of a surface that is out of range.", "Correct it."),
    ("U073", "A colour that is not valid, a material that is defined nowhere, or two of one name that look differently.", "Red, green, blue and alpha are 0 … 1; give the material a `<color>`."),
    ("U074", "An `<origin>` inside `<geometry>`, where it is not used.", "Move it beside `<geometry>`."),
    ("U075", "A visual that is more than ten times as large as the rest of the robot, or, where nothing else has a length, as its mass is spread: it looks like mm or cm.", "`scale=\"0.001 0.001 0.001\"` in `<mesh>`, or lengths in m."),
    ("U104", "Collision meshes that are not found, once for each package.", "The option that the finding shows where it found them; else `--package NAME=DIR` or `--package-path DIR`."),
    ("U105", "A mesh that cannot be read, or a pointer of Git LFS in its place.", "Export the mesh again; `git lfs pull`."),
    ("U106", "A mesh in a format that is not read.", "Convert it to STL, OBJ, PLY, COLLADA or glTF."),
    ("U107", "A mesh without a convex hull.", "Check its scale; many meshes are in mm."),
    ("U108", "How far the hulls of meshes are off that do not keep all corners.", "Nothing."),
    ("U109", "A mesh without volume.", "Nothing: it is used as it is."),
    ("U110", "Collision meshes are replaced by their convex hulls.", "`[link.\"…\"] collision = \"decomposition\"` keeps notches, `\"objects\"` those between the objects of a file."),
    ("U111", "A visual mesh that is not found, or lies outside of the robot's folders.", "As U104; the robot moves without it."),
    ("U112", "A mesh outside of the robot's folders, which is not packed.", "`--package-path DIR`, if it belongs to the robot."),
    ("U113", "A mesh that is a symbolic link out of the robot's folders.", "Nothing: it is used, but not packed."),
    ("U114", "How many convex parts meshes were cut into.", "Nothing."),
    ("U115", "A mesh that cannot be cut into convex parts.", "`collision = \"hull\"`."),
    ("U116", "A visual mesh that cannot be read.", "Export it again; the robot moves without it."),
    ("U117", "A texture that cannot be read.", "Nothing: the visual is drawn without."),
    ("U118", "Meshes, or files that xacro reads, that were found at another place of the robot's folders than their names say, or in other upper and lower case; packages of one name that are equally near, or outside of the robot's workspace and repository; a pattern of an `<xacro:include>` that no file matches.", "`--package NAME=DIR` says where the package is; or correct the names."),
    ("U119", "Collision meshes of several convex objects, each of which has a hull of its own.", "Nothing; `[link.\"…\"] collision = \"hull\"` makes one of them."),
];

fn row(code: &str) -> Option<&'static Row> {
    CODES
        .iter()
        .find(|(own, ..)| own.eq_ignore_ascii_case(code.trim()))
}

/// What a code means, for a terminal.
pub fn text(code: &str) -> Option<String> {
    let (code, about, help) = row(code)?;
    Some(format!("{code}: {about}\n  help: {help}\n"))
}

/// All codes, as a page.
pub fn list() -> String {
    let mut out = String::from(
        "# Findings and their codes\n\n\
         This page is written by `urdf2fmu explain`; `urdf2fmu explain U063` explains one. U is about the\n\
         URDF, R about the SRDF, S about the settings, T about terrain, A about what is made of all of\n\
         them. A code keeps its meaning. The same code can be a note, a warning or an error; the finding\n\
         says so.\n\n\
         | code | meaning | what helps |\n|---|---|---|\n",
    );
    for (code, about, help) in CODES {
        let cell = |text: &str| text.replace('|', "\\|");
        _ = writeln!(out, "| {code} | {} | {} |", cell(about), cell(help));
    }
    out
}
