//! What a settings file says, checked.
//!
//! Over 500 lines because it is a list of types, each with what its fields mean.

mod terrain;

pub use terrain::{GeneratedHeights, HeightForm, HeightSource, TerrainSettings};

use super::closures::{LoopSettings, SpringSettings};
use super::compat::Compat;
use super::fmu::FmuSettings;
use super::sensor::SensorSettings;
use crate::diagnostic::Place;
use crate::geometry::Shape;
use crate::model::{ActuatorMode, ContactDefaults, SolverDefaults, World};
use crate::pattern::Pattern;
use crate::spatial::Vec3;
use std::path::PathBuf;

/// A settings file, checked.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a key of its own")]
pub struct Settings {
    /// Whose conventions hold where nothing says otherwise.
    pub compat: Compat,
    /// Whether the base can move.
    pub base: BaseChoice,
    /// Every length times this; masses stay.
    pub scale: f64,
    /// Where rotational inertia comes from.
    pub inertia: InertiaSource,
    /// Density, kg/m³, of links that the file gives no mass: they weigh what their collision shapes
    /// weigh as solids.
    pub density: Option<f64>,
    /// Whether links touch each other.
    pub self_collision: bool,
    /// Mass, kg, of links that cannot move without one: the file gives them none, and nothing that
    /// hangs on them has one.
    pub missing_mass: Option<f64>,
    /// Lists of links that do not touch each other.
    pub ignored_contacts: Vec<Vec<Pattern>>,
    /// Pairs of names of links that do not touch each other, of an SRDF.
    pub disabled_contacts: Vec<[String; 2]>,
    /// What an SRDF says of the base.
    pub mounting: Option<Mounting>,
    /// What the FMU says of itself.
    pub fmu: FmuSettings,
    /// Variable names with `_` instead of `.`.
    pub flat_names: bool,
    /// Step and tolerance.
    pub solver: SolverDefaults,
    /// Contact law.
    pub contact: ContactDefaults,
    /// Gravity and ground.
    pub world: World,
    /// Things in the world.
    pub objects: Vec<ObjectSettings>,
    /// Further robots.
    pub robots: Vec<RobotSettings>,
    /// Initial state.
    pub initial: InitialSettings,
    /// What is commanded where no entry of `actuators` says so; none: position for limited joints,
    /// velocity for the others.
    pub default_mode: Option<ModeChoice>,
    /// Commanded joints; where several match a joint, each key is the last one's.
    pub actuators: Vec<ActuatorSettings>,
    /// Overrides of the file's joints, as above.
    pub joints: Vec<JointSettings>,
    /// Overrides of the file's links, as above.
    pub links: Vec<LinkSettings>,
    /// Links with contact outputs.
    pub contact_outputs: ContactOutputs,
    /// Whether these include where the forces act.
    pub contact_points: bool,
    /// Sides whose contacts with each other are outputs.
    pub pairs: Vec<PairSettings>,
    /// Links with pose and velocity outputs.
    pub link_outputs: Vec<Pattern>,
    /// Links with force and torque inputs.
    pub external_wrenches: Vec<Pattern>,
    /// Whether its surface moves, by an input; of what stands still.
    pub conveyor: bool,
    /// Whether its base moves as inputs say.
    pub driven: bool,
    /// Joints that share a command.
    pub groups: Vec<GroupSettings>,
    /// Whether the URDF's sensors are read.
    pub described_sensors: bool,
    /// Sensors.
    pub sensors: Vec<SensorSettings>,
    /// What closes loops.
    pub loops: Vec<LoopSettings>,
    /// Springs between two points.
    pub springs: Vec<SpringSettings>,
    /// Loops and springs with outputs.
    pub closure_outputs: [Vec<Pattern>; 2],
}

/// A thing in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSettings {
    /// Its name; none: that of its URDF's robot, made unique.
    pub name: Option<Pattern>,
    /// What it is.
    pub source: ObjectSource,
    /// Where it begins, and how fast.
    pub initial: InitialSettings,
    /// Whether it stands still whatever pushes it.
    pub fixed: bool,
    /// Whether its surface moves, by an input.
    pub conveyor: bool,
    /// Whether it moves as inputs say, whatever pushes it.
    pub driven: bool,
    /// Where it says a mass of which it has no use, because nothing moves it or because inputs do.
    pub idle_mass: Option<Place>,
    /// Friction and restitution of all its links, and what their meshes become; none: its file's.
    pub surface: LinkSettings,
    /// Where its file is named.
    pub file_place: Option<Place>,
    /// Where it was asked for; none for one from the command line.
    pub place: Option<Place>,
}

impl ObjectSettings {
    /// What it is called in the settings.
    pub fn called(&self) -> &str {
        self.name.as_ref().map_or("thing", |name| &name.text)
    }
}

/// What an object is.
#[derive(Clone, Debug, PartialEq)]
pub enum ObjectSource {
    /// What a URDF says.
    Urdf(PathBuf),
    /// A solid of one material.
    Solid {
        /// Its shape.
        shape: Shape,
        /// kg; 0 for one that stands still.
        mass: f64,
    },
    /// A surface with everything below.
    Terrain(TerrainSettings),
}

/// A further robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSettings {
    /// What the names of its variables begin with.
    pub name: Pattern,
    /// Its URDF.
    pub urdf: PathBuf,
    /// Its own settings.
    pub config: Option<PathBuf>,
    /// Base x and y, m; none: those of its own settings.
    pub xy: Option<[f64; 2]>,
    /// Base z, m; none: that of its own settings.
    pub z: Option<f64>,
    /// Base roll, pitch, yaw, rad; none: those of its own settings.
    pub rpy: Option<Vec3>,
    /// Whether the base can move; none: as its own settings say.
    pub fixed_base: Option<bool>,
    /// Where its URDF is named.
    pub urdf_place: Option<Place>,
    /// Where its own settings are named.
    pub config_place: Option<Place>,
    /// Where it was asked for.
    pub place: Option<Place>,
}

/// Two sides whose contacts with each other are outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSettings {
    /// Its name, and where it was given.
    pub name: Pattern,
    /// What is on its first and on its second side.
    pub sides: [Vec<Pattern>; 2],
}

/// Joints that share a command.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupSettings {
    /// Its name, and where it was given.
    pub name: Pattern,
    /// Which joints.
    pub joints: Vec<Pattern>,
}

/// Whether the base can move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseChoice {
    /// Fixed where the root is named `world` or has no mass and a moving child.
    Auto,
    /// It can.
    Floating,
    /// It cannot.
    Fixed,
}

/// The virtual joint of an SRDF, by which a robot is joined to what is around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mounting {
    /// Its name, and where it stands.
    pub name: Pattern,
    /// The frame that it is joined to.
    pub frame: String,
    /// Whether it holds the robot; else the robot moves by it.
    pub fixed: bool,
}

/// Where rotational inertia comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InertiaSource {
    /// `<inertia>`.
    Urdf,
    /// `<inertia>`, where no body can have it the nearest that one can have.
    Nearest,
    /// The collision shapes, as solids of the link's mass.
    Collision,
    /// The box around the collision shapes, as `PyBullet` takes it.
    PyBullet,
}

/// Initial state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InitialSettings {
    /// Base x and y, m.
    pub xy: [f64; 2],
    /// Base z, m; none: the lowest collision point touches the ground.
    pub z: Option<f64>,
    /// Whether a fixed base without z is set down on the ground, as a floating one is; else it is
    /// mounted at z = 0.
    pub stands: bool,
    /// Base roll, pitch, yaw, rad.
    pub rpy: Vec3,
    /// m/s, world axes.
    pub linear_velocity: Vec3,
    /// rad/s, world axes.
    pub angular_velocity: Vec3,
    /// rad or m.
    pub joints: Vec<(Pattern, f64)>,
    /// Of an SRDF's state, rad or m: for joints that `joints` leaves open.
    pub state: Vec<(Pattern, f64)>,
    /// rad/s or m/s.
    pub joint_velocities: Vec<(Pattern, f64)>,
    /// Where `linear_velocity` or `angular_velocity` was given.
    pub velocity_place: Option<Place>,
}

/// Commanded joints.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatorSettings {
    /// Which joints.
    pub joint: Pattern,
    /// What is commanded; none: as without this entry.
    pub mode: Option<ModeChoice>,
    /// N·m or N.
    pub max_effort: Option<f64>,
    /// N·m/rad or N/m.
    pub kp: Option<f64>,
    /// N·m·s/rad or N·s/m.
    pub kd: Option<f64>,
    /// rad/s or m/s.
    pub no_load_speed: Option<f64>,
}

impl ActuatorSettings {
    /// An entry that changes nothing.
    pub fn new(joint: &str) -> Self {
        Self {
            joint: joint.into(),
            mode: None,
            max_effort: None,
            kp: None,
            kd: None,
            no_load_speed: None,
        }
    }

    /// Nothing drives the joint.
    pub fn passive(joint: Pattern) -> Self {
        Self {
            joint,
            mode: Some(ModeChoice::Passive),
            ..Self::new("")
        }
    }
}

/// What is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModeChoice {
    /// Nothing: the joint moves as the forces want.
    Passive,
    /// See [`ActuatorMode`].
    Commanded(ActuatorMode),
}

impl ModeChoice {
    /// From its word in the settings.
    pub fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "velocity" => Self::Commanded(ActuatorMode::Velocity),
            "position" => Self::Commanded(ActuatorMode::Position),
            "effort" => Self::Commanded(ActuatorMode::Effort),
            "pd" => Self::Commanded(ActuatorMode::Pd),
            "none" => Self::Passive,
            _ => return None,
        })
    }
}

/// Overrides of the file's joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSettings {
    /// Which joints.
    pub joint: Pattern,
    /// N·m·s/rad or N·s/m.
    pub damping: Option<f64>,
    /// N·m or N.
    pub friction: Option<f64>,
    /// kg·m² or kg.
    pub armature: Option<f64>,
    /// N·m or N, dry, at rest.
    pub static_friction: Option<f64>,
    /// rad/s or m/s.
    pub stribeck_velocity: Option<f64>,
    /// Whether the velocity limit binds.
    pub enforce_velocity: Option<bool>,
    /// rad or m.
    pub lower: Option<f64>,
    /// rad or m.
    pub upper: Option<f64>,
    /// N·m or N.
    pub effort: Option<f64>,
    /// rad/s or m/s; 0: no limit.
    pub velocity: Option<f64>,
}

impl JointSettings {
    /// An entry that changes nothing.
    pub fn new(joint: &str) -> Self {
        Self {
            joint: joint.into(),
            damping: None,
            friction: None,
            armature: None,
            static_friction: None,
            stribeck_velocity: None,
            enforce_velocity: None,
            lower: None,
            upper: None,
            effort: None,
            velocity: None,
        }
    }
}

/// What the collision mesh of a wheel becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelFit {
    /// A cylinder or a ball where it is one, on a continuous joint.
    Auto,
    /// A cylinder.
    Cylinder,
    /// A ball.
    Sphere,
    /// The hull of the mesh.
    None,
}

impl WheelFit {
    /// From its word in the settings.
    pub fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "auto" => Self::Auto,
            "cylinder" => Self::Cylinder,
            "sphere" => Self::Sphere,
            "none" => Self::None,
            _ => return None,
        })
    }
}

/// What a collision mesh becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshCollision {
    /// Its hull.
    Hull,
    /// The hulls of the objects in its file.
    Objects,
    /// Several convex parts.
    Decomposition,
}

impl MeshCollision {
    /// From its word in the settings.
    pub fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "hull" => Self::Hull,
            "objects" => Self::Objects,
            "decomposition" => Self::Decomposition,
            _ => return None,
        })
    }
}

/// Overrides of the file's links.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkSettings {
    /// Which links.
    pub link: Pattern,
    /// Coulomb coefficient.
    pub friction: Option<f64>,
    /// Coulomb coefficient at rest.
    pub static_friction: Option<f64>,
    /// m
    pub rolling_friction: Option<f64>,
    /// m
    pub torsional_friction: Option<f64>,
    /// Newton's coefficient.
    pub restitution: Option<f64>,
    /// N/m of a contact point.
    pub stiffness: Option<f64>,
    /// s/m
    pub dissipation: Option<f64>,
    /// kg; the inertia scales with it.
    pub mass: Option<f64>,
    /// What its collision meshes roll as.
    pub wheel_fit: Option<WheelFit>,
    /// What its collision meshes become.
    pub collision: Option<MeshCollision>,
}

impl LinkSettings {
    /// An entry that changes nothing.
    pub fn new(link: &str) -> Self {
        Self {
            link: link.into(),
            friction: None,
            static_friction: None,
            rolling_friction: None,
            torsional_friction: None,
            restitution: None,
            stiffness: None,
            dissipation: None,
            mass: None,
            wheel_fit: None,
            collision: None,
        }
    }
}

/// Links with contact outputs.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactOutputs {
    /// All that can touch something.
    Auto,
    /// These.
    Links(Vec<Pattern>),
}
