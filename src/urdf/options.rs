//! How a URDF is read.

use crate::pattern::Pattern;
use std::path::PathBuf;

/// What a collision mesh becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshShapes {
    /// Its hull.
    Hull,
    /// The hulls of the objects in its file.
    Objects,
    /// Several convex parts.
    Decomposition,
}

/// What becomes of an inertia that no body can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImpossibleInertia {
    /// It is an error.
    Refused,
    /// The nearest that a body can have is used, with a warning.
    Nearest,
    /// It is not used, because inertias are computed from the shapes: a warning.
    Unused,
}

/// What gives links a mass later that their file gives none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingMass {
    /// Nothing.
    Nothing,
    /// A density gives it to what has collision shapes.
    Shapes,
    /// All get one that need it.
    All,
}

/// How to read a URDF.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is switched by itself")]
pub struct ReadOptions {
    /// Folders in which packages are looked for: a package, a folder of packages, or an install
    /// prefix.
    pub package_paths: Vec<PathBuf>,
    /// Folders that are packages, by their names; they come before all others.
    pub packages: Vec<(String, PathBuf)>,
    /// Factor on all lengths, meshes included. Masses stay, inertia takes its square.
    pub scale: f64,
    /// What becomes of an inertia that no body can have.
    pub impossible_inertia: ImpossibleInertia,
    /// Who gives a mass to what has none: what would lack one even so is told with other errors.
    pub missing_mass: MissingMass,
    /// The numbers of `<contact>` are used that only `PyBullet` has a use for: inertia scaling,
    /// stiffness, damping.
    pub pybullet: bool,
    /// Sensors are read.
    pub sensors: bool,
    /// The meshes and textures of visuals are read; else only that they are there is checked.
    pub drawn: bool,
    /// A file with errors gives what is left of it, without meshes: for what can be told of it
    /// beside its errors.
    pub rest: bool,
    /// What the collision meshes of links become; of those that match, the last holds. Without one
    /// a mesh becomes the hulls of its objects where it has several and each is convex, else its
    /// hull.
    pub meshes: Vec<(Pattern, MeshShapes)>,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            package_paths: Vec::new(),
            packages: Vec::new(),
            scale: 1.0,
            impossible_inertia: ImpossibleInertia::Refused,
            missing_mass: MissingMass::Nothing,
            pybullet: false,
            sensors: false,
            drawn: false,
            rest: false,
            meshes: Vec::new(),
        }
    }
}

impl ReadOptions {
    /// The defaults, with the package paths of `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`.
    pub fn from_environment() -> Self {
        let paths = ["ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"]
            .into_iter()
            .filter_map(std::env::var_os)
            .flat_map(|value| std::env::split_paths(&value).collect::<Vec<_>>())
            .filter(|path| !path.as_os_str().is_empty())
            .collect();
        Self {
            package_paths: paths,
            ..Self::default()
        }
    }
}
