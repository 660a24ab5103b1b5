//! The format of a scene, and its file.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use urdf2fmu_core::spatial::Vec3;

/// Name in an FMU, below `resources/`.
pub const FILE_NAME: &str = "scene.bin";

/// Version of the format; a reader refuses others.
pub(super) const FORMAT: u32 = 2;

/// Blocks of the body, and the body itself, begin at multiples of this many bytes.
pub(super) const ALIGNMENT: usize = 4;

/// A robot as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Everything but meshes and textures.
    pub head: Head,
    /// Meshes and textures; the head says where.
    pub body: Vec<u8>,
}

/// Why a scene cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Its bytes contradict each other.
    #[error("it is damaged: {0}")]
    Damaged(String),
    /// Written by another version of this program.
    #[error(
        "it has format {0}, this program reads format {FORMAT}; use the urdf2fmu that wrote it, or export \
         again"
    )]
    Format(u32),
}

/// The JSON head. Lengths are in m, angles in rad, masses in kg; quaternions are x, y, z, w.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the format.
    pub format: u32,
    /// Program and version that wrote it.
    pub generator: String,
    /// The robot's name.
    pub robot: String,
    /// The FMU's guid; empty outside of an FMU.
    pub guid: String,
    /// Of the robot itself.
    pub mass: f64,
    /// Whether there is a ground at z = 0.
    pub ground: bool,
    /// The trees that the links make up, the robot's first.
    pub roots: Vec<Root>,
    /// Parents before children.
    pub links: Vec<Link>,
    /// Parents before children; every link but those of the roots is the child of one.
    pub joints: Vec<Joint>,
    /// What is seen.
    pub visuals: Vec<Drawn>,
    /// What touches the ground in the simulation.
    pub collisions: Vec<Drawn>,
    /// What is seen between two points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ties: Vec<Tie>,
    /// Blocks of the body.
    pub meshes: Vec<Mesh>,
    /// Blocks of the body.
    pub textures: Vec<Texture>,
    /// Contact forces among the outputs.
    pub contacts: Vec<Contact>,
    /// External wrenches among the inputs.
    pub wrenches: Vec<Wrench>,
    /// The FMU's variables, in the order of modelDescription.xml.
    pub variables: Vec<Variable>,
    /// Findings of `check`.
    pub notes: Vec<Note>,
}

/// Numbers that variables give, or their start where there are none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Names of outputs, one for each number; none for what does not move.
    pub variables: Vec<String>,
    /// Values at the start of a simulation with default parameters.
    pub start: Vec<f64>,
}

/// A robot or an object: where its base is in the world.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Root {
    /// Empty for the robot itself; the names of the others' links and joints begin with theirs and
    /// a dot.
    pub name: String,
    /// `robot` or `object`.
    pub kind: String,
    /// The base, in the list of links.
    pub link: usize,
    /// x, y, z.
    pub position: Track,
    /// x, y, z, w.
    pub orientation: Track,
}

/// A link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Link {
    /// The URDF's name.
    pub name: String,
    /// kg
    pub mass: f64,
    /// In the link's frame.
    pub center_of_mass: [f64; 3],
}

/// A joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// The URDF's name.
    pub name: String,
    /// The URDF's type.
    pub kind: String,
    /// In the list of links.
    pub parent: usize,
    /// In the list of links.
    pub child: usize,
    /// Of the joint's frame in the parent's.
    pub position: [f64; 3],
    /// Of the joint's frame in the parent's.
    pub orientation: [f64; 4],
    /// What moves the child's frame from the joint's, one after the other; none for a fixed joint.
    pub motions: Vec<Motion>,
    /// Outputs and inputs by what they mean, such as `velocity` or `cmd.max_effort`.
    pub variables: BTreeMap<String, String>,
    /// The URDF's position limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
}

/// One motion of a joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// What it does.
    pub kind: MotionKind,
    /// Unit vector; zero for a ball.
    pub axis: [f64; 3],
    /// One number, for a ball a quaternion.
    #[serde(flatten)]
    pub track: Track,
}

/// What a motion does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MotionKind {
    /// Turns about the axis.
    Turn,
    /// Slides along the axis.
    Slide,
    /// Turns by a quaternion.
    Ball,
}

/// A shape on a link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// In the list of links.
    pub link: usize,
    /// Of the shape in the link's frame.
    pub position: [f64; 3],
    /// Of the shape in the link's frame.
    pub orientation: [f64; 4],
    /// What is drawn.
    pub shape: Shape,
    /// Factors on the shape's coordinates, where they are not 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 3]>,
    /// Red, green, blue (sRGB), alpha, each 0 … 1.
    pub color: [f64; 4],
    /// In the list of textures; multiplied by the colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<usize>,
}

/// A rod or a spring between two points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tie {
    /// That of the loop or the spring.
    pub name: String,
    /// The points.
    pub ends: [End; 2],
    /// What is drawn: 1 m long along z, and stretched to the distance of the points.
    pub shape: Shape,
    /// Factors on the shape's coordinates, where they are not 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 3]>,
    /// Red, green, blue (sRGB), alpha, each 0 … 1.
    pub color: [f64; 4],
}

/// Where a rod or a spring ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// In the list of links; none: the world.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<usize>,
    /// In the link's frame, or in the world.
    pub position: [f64; 3],
}

/// Geometry about the shape's own origin; cylinders and capsules stand along z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// Lengths of the sides.
    Box([f64; 3]),
    /// Radius.
    Sphere(f64),
    /// Radius and length.
    Cylinder([f64; 2]),
    /// Radius, and length without the ends.
    Capsule([f64; 2]),
    /// Place in the list of meshes.
    Mesh(usize),
}

/// A block with vertices and triangles, see `docs/scene.md`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// First byte in the body.
    pub at: usize,
    /// How many.
    pub vertices: usize,
    /// How many.
    pub triangles: usize,
    /// Least coordinates.
    pub low: [f64; 3],
    /// Greatest less least coordinates.
    pub size: [f64; 3],
    /// Least texture coordinates, and greatest less least ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uv: Option<[[f64; 2]; 2]>,
}

/// A block with an image file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Texture {
    /// First byte in the body.
    pub at: usize,
    /// How many.
    pub bytes: usize,
    /// `image/png` or `image/jpeg`.
    pub kind: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Outputs for the contact of a link with the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// In the list of links.
    pub link: usize,
    /// Name of the output that says whether it touches.
    pub active: String,
    /// Names of the three outputs of the force on the link, world axes.
    pub force: Vec<String>,
    /// Names of the three outputs of where it acts, world; empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub point: Vec<String>,
}

/// Inputs for a force and a torque on a link, at its centre of mass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// In the list of links.
    pub link: usize,
    /// Names of three inputs, world axes.
    pub force: Vec<String>,
    /// Names of three inputs, world axes.
    pub torque: Vec<String>,
}

/// A variable of the FMU.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// As in modelDescription.xml.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// `input`, `output` or `parameter`.
    pub causality: String,
    /// `continuous`, `discrete`, `tunable` or `fixed`.
    pub variability: String,
    /// `real`, `integer` or `boolean`.
    pub kind: String,
    /// FMI's name of the unit; empty for numbers without one.
    pub unit: String,
    /// In words.
    pub description: String,
    /// Of inputs and parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Of inputs and parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Of inputs and parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
}

/// A finding about the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Note {
    /// `note` or `warning`.
    pub severity: String,
    /// Such as `U065`.
    pub code: String,
    /// In words.
    pub message: String,
    /// What to do; empty where nothing is advised.
    pub help: String,
    /// File and line; empty for what has no place.
    pub place: String,
}

impl Head {
    /// What places all that moves: bases, then joints.
    pub fn tracks(&self) -> impl Iterator<Item = &Track> {
        let roots = self.roots.iter();
        let bases = roots.flat_map(|root| [&root.position, &root.orientation]);
        let motions = self.joints.iter().flat_map(|joint| &joint.motions);
        bases.chain(motions.map(|motion| &motion.track))
    }

    /// The robot's own base.
    pub fn base(&self) -> &Root {
        &self.roots[0]
    }
}

impl Scene {
    /// The file's content.
    ///
    /// # Errors
    /// [`SceneError::Damaged`] for what JSON cannot hold.
    pub fn to_bytes(&self) -> Result<Vec<u8>, SceneError> {
        let mut head =
            serde_json::to_vec(&self.head).map_err(|e| SceneError::Damaged(e.to_string()))?;
        // The head's length takes four bytes; spaces are white space in JSON.
        while !head.len().is_multiple_of(ALIGNMENT) {
            head.push(b' ');
        }
        let length = u32::try_from(head.len())
            .map_err(|_| SceneError::Damaged("its head is too large".to_owned()))?;
        let mut bytes = length.to_le_bytes().to_vec();
        bytes.extend(head);
        bytes.extend(&self.body);
        Ok(bytes)
    }

    /// Reads a file's content and checks that it is complete.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SceneError> {
        #[derive(Deserialize)]
        struct Version {
            format: u32,
        }
        let damaged = |what: &str| SceneError::Damaged(what.to_owned());
        let (length, rest) = bytes
            .split_first_chunk::<4>()
            .ok_or_else(|| damaged("it is cut short"))?;
        let length = u32::from_le_bytes(*length) as usize;
        let (head, body) = rest
            .split_at_checked(length)
            .ok_or_else(|| damaged("it is cut short"))?;
        let json = |error: serde_json::Error| SceneError::Damaged(error.to_string());
        let version: Version = serde_json::from_slice(head).map_err(json)?;
        if version.format != FORMAT {
            return Err(SceneError::Format(version.format));
        }
        let scene = Self {
            head: serde_json::from_slice(head).map_err(json)?,
            body: body.to_vec(),
        };
        scene.check()?;
        Ok(scene)
    }

    /// Every place in a list and every block is there.
    fn check(&self) -> Result<(), SceneError> {
        let Head {
            roots,
            links,
            joints,
            ties,
            meshes,
            textures,
            ..
        } = &self.head;
        let fail = |what: &str| Err(SceneError::Damaged(what.to_owned()));
        if roots.is_empty() || joints.len() + roots.len() != links.len() {
            return fail("its joints do not make trees");
        }
        // Parents come first, so that one pass over the joints places every link.
        let mut placed = vec![false; links.len()];
        for root in roots {
            if placed.get(root.link) != Some(&false) {
                return fail("its joints do not make trees");
            }
            placed[root.link] = true;
        }
        for joint in joints {
            if placed.get(joint.parent) != Some(&true) || placed.get(joint.child) != Some(&false) {
                return fail("its joints do not make trees");
            }
            placed[joint.child] = true;
        }
        let known = |shape: &Shape| match shape {
            Shape::Mesh(mesh) => *mesh < meshes.len(),
            _ => true,
        };
        for drawn in self.head.visuals.iter().chain(&self.head.collisions) {
            let texture = drawn.texture.is_none_or(|texture| texture < textures.len());
            if drawn.link >= links.len() || !known(&drawn.shape) || !texture {
                return fail("a shape refers to what is not there");
            }
        }
        for tie in ties {
            let held = |end: &End| end.link.is_none_or(|link| link < links.len());
            if !tie.ends.iter().all(held) || !known(&tie.shape) {
                return fail("a rod or a spring refers to what is not there");
            }
        }
        for mesh in meshes {
            if self.triangles(mesh).is_none() {
                return fail("a mesh is not complete");
            }
        }
        if textures.iter().any(|texture| self.image(texture).is_none()) {
            return fail("a texture is not complete");
        }
        Ok(())
    }

    /// What is drawn: the visuals, or the collision shapes where the robot has no visual.
    pub fn shown(&self) -> &[Drawn] {
        if self.head.visuals.is_empty() {
            &self.head.collisions
        } else {
            &self.head.visuals
        }
    }

    /// The bytes of an image file.
    pub fn image(&self, texture: &Texture) -> Option<&[u8]> {
        self.body
            .get(texture.at..texture.at.checked_add(texture.bytes)?)
    }
}

/// A number with as many digits as anyone sees: seven places, no "-0".
pub(super) fn short(x: f64) -> f64 {
    (x * 1e7).round() / 1e7 + 0.0
}

/// A place with such numbers.
pub(super) fn vector(v: &Vec3) -> [f64; 3] {
    [short(v.x), short(v.y), short(v.z)]
}
