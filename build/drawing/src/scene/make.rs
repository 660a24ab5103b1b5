//! A scene from a robot: its description, its model and the table of its variables.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::format::{
    Contact, Drawn, FORMAT, Head, Joint, Link, Mesh, Motion, MotionKind, Note, Root, Scene, Shape,
    Texture, Track, Variable, Wrench, short, vector,
};
use super::mesh;
use super::pose;
use super::texture;
use super::tie;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use urdf2fmu_core::geometry;
use urdf2fmu_core::model::{self, JointId, LinkId, Model, RootId};
use urdf2fmu_core::parallel;
use urdf2fmu_core::simulation::{Simulation, SimulationError};
use urdf2fmu_core::slots::{InputSlot, OutputSlot};
use urdf2fmu_core::spatial::{Pose, Vec3, quaternion_from_rotation};
use urdf2fmu_core::urdf::{Description, DrawnMesh, MeshPart, VisualShape};
use urdf2fmu_core::variables::{self, Slot};

const WHITE: [f64; 3] = [1.0; 3];

/// Colour of what has none: a light metal.
const PLAIN: [f64; 3] = [0.72, 0.74, 0.77];

/// Colour of collision shapes.
const COLLISION: [f64; 4] = [0.93, 0.56, 0.20, 1.0];

/// A robot without any shape is drawn with balls at its links; their radius as a part of its size.
const BALL: f64 = 0.04;

/// Size of a robot all of whose links are in one place, m.
const SMALLEST: f64 = 0.1;

/// The scene of a robot and what is around it.
///
/// - `parts`: descriptions of all trees with their names, empty for the robot itself
/// - `table`: tells which variable means what
/// - `variables`: the rows of the table, in the words of FMI
/// - `guid`: of its FMU; may be empty
///
/// # Errors
/// [`SimulationError`] if its initial state cannot be computed.
pub fn make(
    parts: &[(&str, &Description)],
    model: &Model,
    table: &[variables::Variable],
    variables: Vec<Variable>,
    notes: Vec<Note>,
    guid: &str,
) -> Result<Scene, SimulationError> {
    let mut simulation = Simulation::new(Arc::new(model.clone()));
    simulation.initialize(0.0)?;
    let mut names = Names {
        outputs: Vec::new(),
        inputs: Vec::new(),
        simulation,
    };
    for row in table {
        match row.slot {
            Slot::Output(slot) => names.outputs.push((slot, &row.name)),
            Slot::Input(slot) => names.inputs.push((slot, &row.name)),
            Slot::Parameter(_) => {}
        }
    }
    let links = model.links.iter().map(|link| Link {
        name: link.name.clone(),
        mass: short(link.inertia.mass),
        center_of_mass: vector(&link.inertia.com),
    });
    let mut body = Body::default();
    let mut visuals = Vec::new();
    for (name, description) in parts {
        body.visuals(&mut visuals, name, description, model);
    }
    let collisions = body.collisions(model);
    let joints: Vec<Joint> = (0..model.joints.len())
        .map(|j| names.joint(model, j))
        .collect();
    let own = model.links.iter();
    let own = own.filter(|link| model.root_of(link.body) == RootId::ROBOT);
    let mut head = Head {
        format: FORMAT,
        generator: format!("urdf2fmu {}", env!("CARGO_PKG_VERSION")),
        robot: model.name.clone(),
        guid: guid.to_owned(),
        mass: short(own.map(|link| link.inertia.mass).sum()),
        ground: model.world.ground.is_some(),
        roots: names.roots(model),
        links: links.collect(),
        joints,
        visuals: Vec::new(),
        collisions,
        ties: Vec::new(),
        meshes: body.meshes,
        textures: body.textures,
        contacts: names.contacts(model),
        wrenches: names.wrenches(model),
        variables,
        notes,
    };
    if visuals.is_empty() && head.collisions.is_empty() {
        visuals = skeleton(&head);
    }
    head.visuals = visuals;
    let body = body.bytes;
    let mut scene = Scene { head, body };
    tie::add(&mut scene, model);
    Ok(scene)
}

/// The names of variables by their meaning, and their values at the start.
struct Names<'t> {
    outputs: Vec<(OutputSlot, &'t String)>,
    inputs: Vec<(InputSlot, &'t String)>,
    simulation: Simulation,
}

impl Names<'_> {
    fn output(&self, slot: OutputSlot) -> Option<String> {
        let found = self.outputs.iter().find(|(s, _)| *s == slot);
        found.map(|(_, name)| (*name).clone())
    }

    fn input(&self, slot: InputSlot) -> Option<String> {
        let found = self.inputs.iter().find(|(s, _)| *s == slot);
        found.map(|(_, name)| (*name).clone())
    }

    fn track(&mut self, slots: impl IntoIterator<Item = OutputSlot>) -> Track {
        let mut track = Track::default();
        for slot in slots {
            track.variables.extend(self.output(slot));
            track.start.push(short(self.simulation.output(slot)));
        }
        track
    }

    fn roots(&mut self, model: &Model) -> Vec<Root> {
        let ids = (0..model.roots.len()).map(RootId::from);
        ids.map(|id| self.root(model, id)).collect()
    }

    fn root(&mut self, model: &Model, id: RootId) -> Root {
        let root = &model.roots[id.index()];
        let (position, orientation) = if model.floats(id) {
            (
                self.track((0..3).map(|axis| OutputSlot::BasePosition(id, axis))),
                self.track((0..4).map(|axis| OutputSlot::BaseOrientation(id, axis))),
            )
        } else {
            let X_WB = Pose::from_xyz_rpy(root.position, root.rpy);
            let still = |start: &[f64]| Track {
                variables: Vec::new(),
                start: start.to_vec(),
            };
            (still(&vector(&X_WB.p)), still(&quaternion(&X_WB)))
        };
        Root {
            name: root.name.clone(),
            kind: match root.kind {
                model::RootKind::Robot => "robot",
                model::RootKind::Object => "object",
            }
            .to_owned(),
            link: model.base(id).link.index(),
            position,
            orientation,
        }
    }

    fn joint(&mut self, model: &Model, j: usize) -> Joint {
        let joint = &model.joints[j];
        let id = JointId::from(j);
        let mut motions = Vec::new();
        for (i, body) in (0..).zip(&joint.bodies) {
            let motion = model.bodies[body.index()].motion;
            let (kind, axis) = match motion {
                model::Motion::Revolute(axis) => (MotionKind::Turn, axis),
                model::Motion::Prismatic(axis) => (MotionKind::Slide, axis),
                model::Motion::Spherical | model::Motion::Free | model::Motion::Welded => {
                    (MotionKind::Ball, Vec3::zeros())
                }
            };
            let track = match kind {
                MotionKind::Ball => self.track((0..4).map(|i| OutputSlot::JointOrientation(id, i))),
                _ => self.track([OutputSlot::JointPosition(id, i)]),
            };
            motions.push(Motion {
                kind,
                axis: vector(&axis),
                track,
            });
        }
        Joint {
            name: joint.name.clone(),
            kind: joint.kind.name().to_owned(),
            parent: joint.parent.index(),
            child: joint.child.index(),
            position: vector(&joint.X_PJ.p),
            orientation: quaternion(&joint.X_PJ),
            motions,
            variables: self.variables_of(model, id),
            limits: joint.limits.map(|l| [short(l.lower), short(l.upper)]),
        }
    }

    /// What a turning or sliding joint shows and takes, by what it means.
    fn variables_of(&self, model: &Model, id: JointId) -> BTreeMap<String, String> {
        let mut list = BTreeMap::new();
        let mut add = |key: &str, name: Option<String>| {
            list.extend(name.map(|name| (key.to_owned(), name)));
        };
        if model.scalar_body(id).is_none() {
            return list;
        }
        add("position", self.output(OutputSlot::JointPosition(id, 0)));
        add("velocity", self.output(OutputSlot::JointVelocity(id, 0)));
        add("effort", self.output(OutputSlot::JointEffort(id)));
        let leaders = model.leaders();
        for (a, actuator) in model.actuators.iter().enumerate() {
            if actuator.joint == id {
                let a = model::ActuatorId::from(leaders[a]);
                add("cmd.velocity", self.input(InputSlot::Velocity(a)));
                add("cmd.position", self.input(InputSlot::Position(a)));
                add("cmd.effort", self.input(InputSlot::Effort(a)));
                add("cmd.max_effort", self.input(InputSlot::MaxEffort(a)));
            }
        }
        list
    }

    fn contacts(&self, model: &Model) -> Vec<Contact> {
        let of = |slot: fn(LinkId, u8) -> OutputSlot, link: LinkId| -> Vec<String> {
            (0..3).filter_map(|i| self.output(slot(link, i))).collect()
        };
        let contact = |link: LinkId| {
            Some(Contact {
                link: link.index(),
                active: self.output(OutputSlot::ContactActive(link))?,
                force: of(OutputSlot::ContactForce, link),
                point: of(OutputSlot::ContactPoint, link),
            })
        };
        let links = (0..model.links.len()).map(LinkId::from);
        links.filter_map(contact).collect()
    }

    fn wrenches(&self, model: &Model) -> Vec<Wrench> {
        let of = |slot: fn(LinkId, u8) -> InputSlot, link: LinkId| -> Vec<String> {
            (0..3).filter_map(|i| self.input(slot(link, i))).collect()
        };
        let links = (0..model.links.len()).map(LinkId::from);
        links
            .map(|link| Wrench {
                link: link.index(),
                force: of(InputSlot::ExternalForce, link),
                torque: of(InputSlot::ExternalTorque, link),
            })
            .filter(|wrench| wrench.force.len() == 3 && wrench.torque.len() == 3)
            .collect()
    }
}

/// The scene's body, and what is in it.
#[derive(Default)]
struct Body {
    bytes: Vec<u8>,
    meshes: Vec<Mesh>,
    textures: Vec<Texture>,
}

impl Body {
    /// Adds the visuals of all links of a tree that the model has.
    fn visuals(
        &mut self,
        list: &mut Vec<Drawn>,
        name: &str,
        description: &Description,
        model: &Model,
    ) {
        let link_of: HashMap<&str, usize> = model
            .links
            .iter()
            .enumerate()
            .map(|(l, link)| (link.name.as_str(), l))
            .collect();
        let mut textures = vec![None; description.textures.len()];
        let side = texture::longest_side(&description.textures);
        let reduced = parallel::map_largest_first(
            &description.textures,
            |t| t.bytes.len(),
            |t| texture::reduced(t, side),
        );
        let parts = description.drawn_meshes.iter().map(|file| &file.parts);
        let parts: Vec<&MeshPart> = parts.flatten().collect();
        let mut packed = parallel::map_largest_first(
            &parts,
            |part| part.triangles.len(),
            |part| mesh::pack(&part.corners, &part.triangles, &part.uv),
        )
        .into_iter();
        // Packed parts by mesh.
        let mut packed: Vec<Vec<_>> = description
            .drawn_meshes
            .iter()
            .map(|file| packed.by_ref().take(file.parts.len()).collect())
            .collect();
        let mut meshes: Vec<Option<Vec<Option<usize>>>> =
            vec![None; description.drawn_meshes.len()];
        let prefix = if name.is_empty() {
            String::new()
        } else {
            format!("{name}.")
        };
        for link in &description.links {
            let own = format!("{prefix}{}", link.name);
            let Some(&l) = link_of.get(own.as_str()) else {
                continue;
            };
            for visual in &link.visuals {
                let mut add = |shape, scale, color: Option<[f64; 3]>, texture| {
                    let [red, green, blue] = color.unwrap_or(PLAIN);
                    let alpha = visual.color.map_or(1.0, |color| color[3]);
                    list.push(Drawn {
                        scale,
                        texture,
                        color: [red, green, blue, alpha].map(|x| (x * 1000.0).round() / 1000.0),
                        ..drawn(l, &visual.X_LG, shape)
                    });
                };
                let own = visual.color.map(|[red, green, blue, _]| [red, green, blue]);
                match &visual.shape {
                    VisualShape::Solid(solid) => {
                        if let Some(shape) = self.solid(solid) {
                            add(shape, None, own, None);
                        }
                    }
                    VisualShape::Mesh { mesh, scale } => {
                        let file = &description.drawn_meshes[*mesh];
                        let places = meshes[*mesh].get_or_insert_with(|| {
                            let parts = std::mem::take(&mut packed[*mesh]).into_iter();
                            parts.map(|part| Some(self.append(&part?))).collect()
                        });
                        let scale = vector(scale);
                        let same = scale.map(f64::to_bits) == [1.0_f64.to_bits(); 3];
                        let scale = (!same).then_some(scale);
                        for (part, place) in file.parts.iter().zip(places) {
                            let Some(place) = *place else { continue };
                            let texture = visual.texture.or(part.texture);
                            let texture = texture.filter(|_| !part.uv.is_empty());
                            let texture = texture.map(|texture| {
                                *textures[texture].get_or_insert_with(|| {
                                    let (texture, reduced) =
                                        (&description.textures[texture], &reduced[texture]);
                                    let packed = texture::append(&mut self.bytes, texture, reduced);
                                    self.textures.push(packed);
                                    self.textures.len() - 1
                                })
                            });
                            let color = match texture {
                                // The mesh's factor is that of its own texture.
                                Some(_) => {
                                    let tint = part.tint.filter(|_| visual.texture.is_none());
                                    tint.or(Some(WHITE))
                                }
                                None if is_colorful(file) => part.color.or(own),
                                None => own.or(part.color),
                            };
                            add(Shape::Mesh(place), scale, color, texture);
                        }
                    }
                }
            }
        }
    }

    /// The shapes that touch the ground, as the simulation has them.
    fn collisions(&mut self, model: &Model) -> Vec<Drawn> {
        let mut list = Vec::new();
        for collider in &model.colliders {
            let link = &model.links[collider.link.index()];
            let X_LG = link.X_BL.inverse().compose(&collider.X_BG);
            if let Some(shape) = self.solid(&collider.shape) {
                list.push(drawn(collider.link.index(), &X_LG, shape));
            }
        }
        list
    }

    /// `None` for a hull that has no area.
    fn solid(&mut self, shape: &geometry::Shape) -> Option<Shape> {
        Some(match shape {
            geometry::Shape::Box { half } => Shape::Box(vector(&(half * 2.0))),
            geometry::Shape::Sphere { radius } => Shape::Sphere(short(*radius)),
            geometry::Shape::Cylinder {
                radius,
                half_length,
            } => Shape::Cylinder([short(*radius), short(2.0 * half_length)]),
            geometry::Shape::Capsule {
                radius,
                half_length,
            } => Shape::Capsule([short(*radius), short(2.0 * half_length)]),
            geometry::Shape::Hull { .. }
            | geometry::Shape::Plane
            | geometry::Shape::Field { .. }
            | geometry::Shape::Surface { .. } => {
                Shape::Mesh(self.append(&mesh::pack_whole(&shape.triangles(), &[])?))
            }
        })
    }

    fn append(&mut self, mesh: &mesh::Packed) -> usize {
        self.meshes.push(mesh::append(&mut self.bytes, mesh));
        self.meshes.len() - 1
    }
}

/// Whether a mesh tells its parts apart by colour: one colour of the URDF must not paint over that.
fn is_colorful(file: &DrawnMesh) -> bool {
    let mut colors = file.parts.iter().filter_map(|part| part.color);
    let first = colors.next();
    colors.any(|color| Some(color) != first)
}

fn drawn(link: usize, X_LG: &Pose, shape: Shape) -> Drawn {
    Drawn {
        link,
        position: vector(&X_LG.p),
        orientation: quaternion(X_LG),
        shape,
        scale: None,
        color: COLLISION,
        texture: None,
    }
}

/// Balls at the base and at the links that move, and rods along the joints, for a robot that has no
/// shape at all. In a row they just touch: balls within each other take long to draw and hide all.
fn skeleton(head: &Head) -> Vec<Drawn> {
    let poses = pose::link_poses(head, |_| None);
    let reach = poses.iter().map(|X_WL| (X_WL.p - poses[0].p).norm());
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 links")]
    let radius = BALL.min(0.5 / poses.len() as f64) * reach.fold(SMALLEST, f64::max);
    let [red, green, blue] = PLAIN;
    let plain = |link, X_LG: &Pose, shape| Drawn {
        color: [red, green, blue, 1.0],
        ..drawn(link, X_LG, shape)
    };
    let moving = head.joints.iter().filter(|joint| !joint.motions.is_empty());
    let bases = head.roots.iter().map(|root| root.link);
    let mut list: Vec<Drawn> = bases
        .chain(moving.map(|joint| joint.child))
        .map(|link| plain(link, &Pose::IDENTITY, Shape::Sphere(short(radius))))
        .collect();
    for joint in &head.joints {
        let p = Vec3::from(joint.position);
        let length = p.norm();
        if length > radius {
            let X_LG = Pose {
                R: urdf2fmu_core::spatial::rotation_to_axis(&(p / length)),
                p: p * 0.5,
            };
            let rod = Shape::Cylinder([short(0.5 * radius), short(length)]);
            list.push(plain(joint.parent, &X_LG, rod));
        }
    }
    list
}

/// x, y, z, w.
fn quaternion(X: &Pose) -> [f64; 4] {
    let q = quaternion_from_rotation(&X.R);
    [short(q.i), short(q.j), short(q.k), short(q.w)]
}
