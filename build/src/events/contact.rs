//! Contacts with the ground: the deepest, the hardest, and the times without any.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::run::{Event, Run, TOLD, moment, three};
use urdf2fmu_core::geometry::Shape as Solids;
use urdf2fmu_core::spatial::{Pose, Vec3};
use urdf2fmu_drawing::scene::{self, Drawn, Head, Scene, Shape};

/// Least depth that is told, m.
const SHALLOWEST: f64 = 1e-6;

/// A robot that is higher than this above the ground, m, is in the air …
const ALOFT: f64 = 1e-3;

/// … and this is told from this length on, s.
const FLIGHT: f64 = 0.1;

/// A force of this many weights of the robot is told.
const HARD: f64 = 3.0;

/// The greatest contact force, where it is several weights.
pub(super) fn hardest(run: &Run) -> Option<Event> {
    let head = run.head;
    let gravity = ["x", "y", "z"].map(|axis| {
        let name = format!("world.gravity.{axis}");
        let value = run.setting(&name)(0);
        value.or_else(|| run.setting(&name.replace('.', "_"))(0))
    });
    let [Some(x), Some(y), Some(z)] = gravity else {
        return None;
    };
    let weight = head.mass * Vec3::new(x, y, z).norm();
    let mut hardest: Option<(f64, f64, usize)> = None;
    for contact in &head.contacts {
        let Some(force) = run.all(&contact.force).filter(|force| force.len() == 3) else {
            continue;
        };
        for (row, &time) in run.time.iter().enumerate() {
            let size = Vec3::new(force[0][row], force[1][row], force[2][row]).norm();
            if size > hardest.map_or(HARD * weight, |(most, ..)| most) {
                hardest = Some((size, time, contact.link));
            }
        }
    }
    let (size, time, link) = hardest.filter(|_| weight > 0.0)?;
    let link = &head.links.get(link)?.name;
    Some(Event {
        time,
        text: format!(
            "Hardest contact: {} N on link '{link}' at {}, {} times the robot's weight.",
            three(size),
            moment(time),
            three(size / weight)
        ),
    })
}

/// How deep the robot was in the ground, and when it was in the air.
pub(super) fn ground(run: &Run, scene: &Scene) -> Vec<Event> {
    let head = run.head;
    let (known, moving) = (known_links(run), moving_links(head));
    let solids: Vec<Solid> = head
        .collisions
        .iter()
        .filter(|drawn| known[drawn.link] && moving[drawn.link])
        .filter_map(|drawn| Solid::new(scene, drawn))
        .collect();
    if !head.ground || solids.is_empty() {
        return Vec::new();
    }
    let columns: Vec<&[f64]> = pose_variables(head)
        .filter_map(|name| run.columns.get(name.as_str()).copied())
        .collect();
    // Time, height of the lowest point, and its link.
    let mut heights: Vec<(f64, f64, usize)> = Vec::new();
    for (row, &time) in run.time.iter().enumerate() {
        // Where a value is missing, the robot would be drawn at its start.
        if columns.iter().any(|column| !column[row].is_finite()) {
            continue;
        }
        let poses = scene::link_poses(head, |name| run.columns.get(name).map(|c| c[row]));
        let mut lowest = (f64::INFINITY, 0);
        for solid in &solids {
            if let Some(height) = solid.height(&poses[solid.link], lowest.0) {
                lowest = (height, solid.link);
            }
        }
        heights.push((time, lowest.0, lowest.1));
    }
    let mut events = Vec::from_iter(deepest(head, &heights));
    // A link whose place is not known may touch.
    let floating = !head.base().position.variables.is_empty();
    // Above the ground a robot may stand on something else.
    let alone = head.roots.len() == 1;
    if floating && alone && head.collisions.iter().all(|drawn| known[drawn.link]) {
        events.extend(flights(&heights));
    }
    events
}

fn deepest(head: &Head, heights: &[(f64, f64, usize)]) -> Option<Event> {
    // Of equal depths the first.
    let (time, height, link) = heights.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (-height > SHALLOWEST).then(|| Event {
        time: *time,
        text: format!(
            "Deepest contact: link '{}' was {} below the ground at {}.",
            head.links[*link].name,
            length(-height),
            moment(*time)
        ),
    })
}

/// A time in the air.
struct Flight {
    begin: f64,
    end: Option<f64>,
    highest: f64,
}

impl Flight {
    fn span(&self) -> String {
        let end = self.end.map_or("the end".to_owned(), moment);
        format!("from {} to {end}", moment(self.begin))
    }
}

/// Times in which nothing is near the ground.
fn flights(heights: &[(f64, f64, usize)]) -> Vec<Event> {
    let mut flights: Vec<Flight> = Vec::new();
    let mut now: Option<Flight> = None;
    for &(time, height, _) in heights {
        if height > ALOFT {
            let flight = now.get_or_insert(Flight {
                begin: time,
                end: None,
                highest: height,
            });
            flight.highest = flight.highest.max(height);
        } else if let Some(mut flight) = now.take() {
            flight.end = Some(time);
            flights.push(flight);
        }
    }
    flights.extend(now);
    let last = heights.last().map_or(0.0, |(time, ..)| *time);
    flights.retain(|flight| flight.end.unwrap_or(last) - flight.begin >= FLIGHT);
    let single = if flights.len() <= TOLD + 1 {
        flights.len()
    } else {
        TOLD
    };
    let (each, rest) = flights.split_at(single);
    let event = |flight: &Flight| Event {
        time: flight.begin,
        text: format!(
            "In the air {}, up to {} above the ground.",
            flight.span(),
            length(flight.highest)
        ),
    };
    let mut events: Vec<Event> = each.iter().map(event).collect();
    if let [first, .., last] = rest {
        events.push(Event {
            time: first.begin,
            text: format!(
                "In the air {} more times, the last time {}.",
                rest.len(),
                last.span()
            ),
        });
    }
    events
}

/// `0.31 mm`, `1.2 m`
fn length(meters: f64) -> String {
    if meters < 0.1 {
        format!("{} mm", three(1e3 * meters))
    } else {
        format!("{} m", three(meters))
    }
}

/// Variables that place any link.
fn pose_variables(head: &Head) -> impl Iterator<Item = &String> {
    head.tracks().flat_map(|track| &track.variables)
}

/// Links whose place follows from the columns.
fn known_links(run: &Run) -> Vec<bool> {
    let head = run.head;
    let mut known = vec![false; head.links.len()];
    for root in &head.roots {
        let tracks = [&root.position, &root.orientation];
        let mut tracks = tracks.into_iter();
        known[root.link] = tracks.all(|track| run.all(&track.variables).is_some());
    }
    for joint in &head.joints {
        let mut tracks = joint.motions.iter().map(|motion| &motion.track);
        known[joint.child] =
            known[joint.parent] && tracks.all(|track| run.all(&track.variables).is_some());
    }
    known
}

/// Whether each link can move. What cannot may be in the ground, as the foot of a ramp is.
fn moving_links(head: &Head) -> Vec<bool> {
    let mut moving = vec![false; head.links.len()];
    for root in &head.roots {
        moving[root.link] = !root.position.variables.is_empty();
    }
    for joint in &head.joints {
        moving[joint.child] = moving[joint.parent] || !joint.motions.is_empty();
    }
    moving
}

/// A shape on a link.
struct Solid {
    link: usize,
    X_LG: Pose,
    shape: Solids,
    /// The box around a mesh: its pose on the link, and itself.
    around: Option<(Pose, Solids)>,
}

impl Solid {
    /// `None` for a mesh that is not there.
    fn new(scene: &Scene, drawn: &Drawn) -> Option<Self> {
        let X_LG = scene::pose(&drawn.position, &drawn.orientation);
        let mut around = None;
        let shape = match drawn.shape {
            Shape::Box(sides) => Solids::Box {
                half: 0.5 * Vec3::from(sides),
            },
            Shape::Sphere(radius) => Solids::Sphere { radius },
            Shape::Cylinder([radius, length]) => Solids::Cylinder {
                radius,
                half_length: 0.5 * length,
            },
            Shape::Capsule([radius, length]) => Solids::Capsule {
                radius,
                half_length: 0.5 * length,
            },
            Shape::Mesh(mesh) => {
                let mesh = scene.head.meshes.get(mesh)?;
                let scale = Vec3::from(drawn.scale.unwrap_or([1.0; 3]));
                let corner = |p: &[f64; 3]| Vec3::from(*p).component_mul(&scale);
                let half = Vec3::from(mesh.size).component_mul(&scale) * 0.5;
                let middle = Pose {
                    p: corner(&mesh.low) + half,
                    ..Pose::IDENTITY
                };
                let half = half.abs();
                around = Some((X_LG.compose(&middle), Solids::Box { half }));
                let vertices = &scene.triangles(mesh)?.positions;
                Solids::Hull {
                    vertices: vertices.iter().map(corner).collect(),
                }
            }
        };
        Some(Self {
            link: drawn.link,
            X_LG,
            shape,
            around,
        })
    }

    /// z of its lowest point, m, if that is below `least`.
    fn height(&self, X_WL: &Pose, least: f64) -> Option<f64> {
        let height = |X_LG: &Pose, shape: &Solids| shape.lowest(&X_WL.compose(X_LG), &Vec3::z());
        // Most meshes are higher as a whole.
        let may_be_lower = |(X_LG, shape): &(Pose, Solids)| height(X_LG, shape) < least;
        if !self.around.as_ref().is_none_or(may_be_lower) {
            return None;
        }
        Some(height(&self.X_LG, &self.shape)).filter(|height| *height < least)
    }
}
