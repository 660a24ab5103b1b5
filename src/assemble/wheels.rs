//! Meshes of wheels → cylinders and balls, because a polygon rolls unevenly.
//!
//! A mesh that turns about a continuous joint and is round about its axis becomes the cylinder or
//! the ball that fits it; the error is reported. Whether it is round is judged by how far its
//! outline, seen along the axis, is from a circle all the way round: a wheel of `n` facets is off
//! by `1 − cos(π/n)` of its radius. A driven wheel that stays a polygon causes a warning.
//!
//! Not done here: wheels made of several meshes that are round only together; meshes on other
//! joints, unless the settings ask for it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::{Findings, listed};
use super::initial::Poses;
use super::robot::WheelChoice;
use crate::geometry::Shape;
use crate::model::{Collider, JointId, JointKind, Model};
use crate::settings::WheelFit;
use crate::spatial::{Pose, Vec3, rotation_to_axis};
use crate::urdf::CollisionDescription;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// Part of its radius by which a wheel may be off the circle: ten facets are round, eight are not.
const ROUND: f64 = 0.05;
/// Part of its radius by which a wheel's centre may be off the joint's axis and count as on it:
/// what meshes round, and far below what a builder would notice. Beyond, the fitted wheel is as
/// eccentric as the mesh.
const CENTRED: f64 = 0.01;
/// Part of its radius by which a wheel's centre may be off the axis at all: beyond, it is no wheel.
const ECCENTRIC: f64 = 0.2;
/// Part of its radius by which hubs and axles may stick out of a fitted cylinder.
const OVERHANG: f64 = 0.5;
/// Outline below this part of its radius somewhere: too far from round to be meant as a wheel.
const WHEEL_LIKE: f64 = 0.6;
/// Camber at which the sides of a wheel are compared with those of the cylinder, rad.
const CAMBER: f64 = 10.0 * PI / 180.0;
/// Directions in which an outline is compared with a circle.
const DIRECTIONS: u32 = 720;
/// Least half width of a fitted cylinder, in radii: a disc without thickness is still a wheel.
const THINNEST: f64 = 1e-3;

/// A driven wheel that stayed what its mesh is.
pub(super) struct Polygon {
    collider: usize,
    joint: JointId,
    radius: f64,
    /// Why it was not fitted.
    reason: String,
}

/// The circle through an outline, and how well it fits.
#[derive(Clone, Copy, Debug)]
struct Round {
    center: [f64; 2],
    radius: f64,
    /// Largest and root mean square difference of the outline's support from the circle's, m.
    worst: f64,
    rms: f64,
    /// Least support about the centre, m.
    inner: f64,
}

/// A shape in the frame whose z axis is the joint's, and its error.
struct Fitted {
    shape: Shape,
    center: Vec3,
    worst: f64,
    rms: f64,
    /// How far the mesh sticks out of the ends, m.
    overhang: f64,
    /// How far a tilted cylinder is off, m.
    sides: f64,
    /// Whether the fit is good enough to be taken unasked.
    good: bool,
}

/// Replaces the meshes of wheels in `model.colliders`, which are those of `shapes` in order;
/// returns the wheels that stayed polygons.
///
/// - `shapes`, `choices`: per link
pub(super) fn fit(
    model: &mut Model,
    shapes: &[Vec<CollisionDescription>],
    choices: &[WheelChoice],
    findings: &mut Findings,
) -> Vec<Polygon> {
    let mut polygons = Vec::new();
    let mut told: Vec<(String, Vec<String>)> = Vec::new();
    let collisions = shapes.iter().flatten();
    for (c, collision) in collisions.enumerate() {
        let collider = &model.colliders[c];
        let wanted = &choices[collider.link.index()];
        let Some((joint, axis)) = turns(model, collider) else {
            continue;
        };
        let unasked = wanted.fit == WheelFit::Auto;
        let continuous = model.joints[joint.index()].kind == JointKind::Continuous;
        if wanted.fit == WheelFit::None || unasked && !continuous {
            continue;
        }
        let Some(points) = corners(collision) else {
            continue;
        };
        let R_BA = rotation_to_axis(&axis);
        let local: Vec<Vec3> = points
            .iter()
            .map(|p| R_BA.transpose() * collider.X_BG.point(p))
            .collect();
        let name = &model.links[collider.link.index()].name;
        let round = Round::of(&local);
        let fitted = round.and_then(|round| choose(&local, &round, wanted.fit));
        let Some(fitted) = fitted.filter(|fitted| fitted.good || !unasked) else {
            if unasked {
                polygons.extend(round.and_then(|round| Polygon::of(c, joint, &round, &local)));
            } else {
                let message = format!("the mesh of link '{name}' is too flat to fit a wheel to");
                findings.error("A127", wanted.place.clone(), message, "leave wheel_fit out");
            }
            continue;
        };
        let text = fitted.text();
        if !fitted.good {
            let message = format!("the wheel fitted to the mesh of link '{name}' is rough: {text}");
            let help = "wheel_fit = \"none\" keeps the mesh's convex hull";
            findings.warning("A127", wanted.place.clone(), message, help);
        } else if let Some((_, names)) = told.iter_mut().find(|(other, _)| *other == text) {
            names.push(name.clone());
        } else {
            told.push((text, vec![name.clone()]));
        }
        let collider = &mut model.colliders[c];
        collider.X_BG = Pose {
            R: R_BA,
            p: R_BA * fitted.center,
        };
        collider.shape = fitted.shape;
    }
    for (text, names) in told {
        let message = format!(
            "round meshes roll as fitted shapes: {}: {text}",
            listed(&names)
        );
        let help = "wheel_fit = \"none\" under [link.\"…\"] keeps the mesh's convex hull";
        findings.note("A127", message, help);
    }
    polygons
}

/// Warns of wheels that the robot stands on and drives, and that are polygons.
pub(super) fn warn(model: &Model, poses: &Poses, polygons: &[Polygon], findings: &mut Findings) {
    if !model.is_floating() {
        return;
    }
    let down = Vec3::z();
    let lowest = |c: &Collider| c.shape.lowest(&poses.collider(model, c), &down);
    let floor = model
        .colliders
        .iter()
        .map(lowest)
        .fold(f64::INFINITY, f64::min);
    for polygon in polygons {
        let collider = &model.colliders[polygon.collider];
        let driven = model.actuators.iter().any(|a| a.joint == polygon.joint);
        let upright = turns(model, collider).is_some_and(|(_, axis)| {
            let R_BG = &collider.X_BG.R;
            let axis = poses.collider(model, collider).R * (R_BG.transpose() * axis);
            axis.z.abs() < 0.5_f64.sqrt()
        });
        if !driven || !upright || lowest(collider) > floor + 0.5 * polygon.radius {
            continue;
        }
        let name = &model.links[collider.link.index()].name;
        let message = format!(
            "the driven wheel '{name}' rolls on the corners of its mesh: {}",
            polygon.reason
        );
        let help = format!(
            "set [link.\"{name}\"] wheel_fit = \"cylinder\" or \"sphere\", or give it a <cylinder>; \"none\" if it is meant so"
        );
        findings.warning("A128", None, message, &help);
    }
}

/// The joint that turns a collider about an axis through its body's origin, and that axis in the
/// body's frame.
fn turns(model: &Model, collider: &Collider) -> Option<(JointId, Vec3)> {
    let body = &model.bodies[collider.body.index()];
    let joint = body.joint?;
    let turning = matches!(
        model.joints[joint.index()].kind,
        JointKind::Continuous | JointKind::Revolute
    );
    let axis = body.motion.axis().filter(|_| turning)?;
    Some((joint, axis))
}

/// Corners of a mesh, as many as are known; none for other shapes.
fn corners(collision: &CollisionDescription) -> Option<&[Vec3]> {
    collision.mesh.as_ref().filter(|_| !collision.part)?;
    match (&collision.outline, &collision.shape) {
        (Some(outline), _) => Some(outline),
        (None, Shape::Hull { vertices }) => Some(vertices),
        _ => None,
    }
}

impl Polygon {
    /// If it looks as if it were meant as a wheel.
    fn of(collider: usize, joint: JointId, round: &Round, points: &[Vec3]) -> Option<Self> {
        let [x, y] = round.center;
        let meant = round.inner >= WHEEL_LIKE * round.radius
            && libm::hypot(x, y) <= ECCENTRIC * round.radius;
        let percent = |error: f64| 100.0 * error / round.radius;
        let cylinder = cylinder(points, round);
        let reason = if !round.good() {
            let error = percent(round.worst);
            format!("it is off the circle by {error:.0} % of its radius")
        } else if cylinder.overhang > OVERHANG * round.radius {
            let overhang = 1e3 * cylinder.overhang;
            format!("{overhang:.0} mm of it stick out beyond its tread")
        } else {
            let error = percent(cylinder.sides);
            format!("its flanks are off a cylinder's by {error:.0} % of its radius")
        };
        meant.then_some(Self {
            collider,
            joint,
            radius: round.radius,
            reason,
        })
    }
}

impl Round {
    /// The least-squares circle through the corners of the outline of `points` seen along z; none
    /// without an area.
    fn of(points: &[Vec3]) -> Option<Self> {
        let outline = outline(points);
        if outline.len() < 3 {
            return None;
        }
        let size = outline
            .iter()
            .flatten()
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        // x² + y² = 2 a x + 2 b y + c, in units of the size.
        let (mut A, mut b) = (nalgebra::Matrix3::zeros(), nalgebra::Vector3::zeros());
        for [x, y] in &outline {
            let row = nalgebra::Vector3::new(2.0 * x / size, 2.0 * y / size, 1.0);
            A += row * row.transpose();
            b += row * ((x * x + y * y) / (size * size));
        }
        let solution = A.lu().solve(&b)?;
        let mut center = [solution.x * size, solution.y * size];
        let offset = libm::hypot(center[0], center[1]);
        let radius_about = |center: [f64; 2]| {
            let squares = outline.iter().map(|[x, y]| {
                let (dx, dy) = (x - center[0], y - center[1]);
                dx * dx + dy * dy
            });
            #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 corners")]
            let count = outline.len() as f64;
            (squares.sum::<f64>() / count).sqrt()
        };
        if offset <= CENTRED * radius_about(center) {
            center = [0.0; 2];
        }
        let radius = radius_about(center);
        // The support is largest towards a corner and smallest across an edge.
        let about = |[x, y]: [f64; 2]| [x - center[0], y - center[1]];
        let (mut worst, mut inner) = (0.0_f64, f64::INFINITY);
        for (i, corner) in outline.iter().enumerate() {
            let ([ax, ay], [bx, by]) = (about(*corner), about(outline[(i + 1) % outline.len()]));
            let edge = (ax * by - ay * bx) / libm::hypot(bx - ax, by - ay);
            inner = inner.min(edge);
            for support in [libm::hypot(ax, ay), edge] {
                worst = worst.max((support - radius).abs());
            }
        }
        let mut squares = 0.0;
        for i in 0..DIRECTIONS {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(DIRECTIONS));
            let support = outline
                .iter()
                .map(|corner| about(*corner))
                .map(|[x, y]| x * cos + y * sin)
                .fold(f64::NEG_INFINITY, f64::max);
            squares += (support - radius) * (support - radius);
        }
        (radius > 0.0 && radius.is_finite()).then_some(Self {
            center,
            radius,
            worst,
            rms: (squares / f64::from(DIRECTIONS)).sqrt(),
            inner,
        })
    }

    /// Whether the outline is a circle that may be called centred on the axis.
    fn good(&self) -> bool {
        let [x, y] = self.center;
        self.worst <= ROUND * self.radius && libm::hypot(x, y) <= ECCENTRIC * self.radius
    }
}

/// The shape to take, if any has a size.
fn choose(points: &[Vec3], round: &Round, wanted: WheelFit) -> Option<Fitted> {
    match wanted {
        WheelFit::Cylinder => Some(cylinder(points, round)),
        WheelFit::Sphere => sphere(points, round),
        WheelFit::Auto => sphere(points, round)
            .filter(|ball| ball.good)
            .or_else(|| Some(cylinder(points, round))),
        WheelFit::None => None,
    }
}

/// As wide as the mesh is where its radius is nearly the largest.
fn cylinder(points: &[Vec3], round: &Round) -> Fitted {
    let [x, y] = round.center;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut bottom, mut top) = (f64::INFINITY, f64::NEG_INFINITY);
    // Of an eccentric or rough mesh the outermost corners at least.
    let most = points
        .iter()
        .map(|p| libm::hypot(p.x - x, p.y - y))
        .fold(0.0, f64::max);
    let tread = (1.0 - ROUND) * round.radius.min(most);
    for p in points {
        (bottom, top) = (bottom.min(p.z), top.max(p.z));
        if libm::hypot(p.x - x, p.y - y) >= tread {
            (low, high) = (low.min(p.z), high.max(p.z));
        }
    }
    let half_length = (0.5 * (high - low)).max(THINNEST * round.radius);
    let z = 0.5 * (low + high);
    let (sin, cos) = libm::sincos(CAMBER);
    let mut sides = 0.0_f64;
    for i in 0..72 {
        let (sin_turn, cos_turn) = libm::sincos(TAU * f64::from(i) / 72.0);
        for lean in [sin, -sin] {
            let direction = Vec3::new(cos * cos_turn, cos * sin_turn, lean);
            let support = points
                .iter()
                .map(|p| direction.dot(&(p - Vec3::new(x, y, z))))
                .fold(f64::NEG_INFINITY, f64::max);
            sides = sides.max((support - round.radius * cos - half_length * sin).abs());
        }
    }
    let overhang = (top - high).max(low - bottom);
    Fitted {
        shape: Shape::Cylinder {
            radius: round.radius,
            half_length,
        },
        center: Vec3::new(x, y, z),
        worst: round.worst,
        rms: round.rms,
        overhang,
        sides,
        good: round.good() && sides <= ROUND * round.radius && overhang <= OVERHANG * round.radius,
    }
}

/// A ball about the centre of the outline, half way between the ends.
fn sphere(points: &[Vec3], round: &Round) -> Option<Fitted> {
    let [x, y] = round.center;
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
            (low.min(p.z), high.max(p.z))
        });
    let center = Vec3::new(x, y, 0.5 * (low + high));
    let (mut worst, mut squares) = (0.0_f64, 0.0);
    for i in 0..DIRECTIONS {
        // Evenly over the ball: equal heights, turned by the golden angle.
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(DIRECTIONS);
        let (sin, cos) = libm::sincos(f64::from(i) * PI * (3.0 - 5.0_f64.sqrt()));
        let across = (1.0 - z * z).sqrt();
        let direction = Vec3::new(across * cos, across * sin, z);
        let support = points
            .iter()
            .map(|p| direction.dot(&(p - center)))
            .fold(f64::NEG_INFINITY, f64::max);
        let error = support - round.radius;
        worst = worst.max(error.abs());
        squares += error * error;
    }
    let worst = worst.max(round.worst);
    worst.is_finite().then_some(Fitted {
        shape: Shape::Sphere {
            radius: round.radius,
        },
        center,
        worst,
        rms: (squares / f64::from(DIRECTIONS)).sqrt(),
        overhang: 0.0,
        sides: 0.0,
        good: round.good() && worst <= ROUND * round.radius,
    })
}

impl Fitted {
    /// What it is and how far off.
    fn text(&self) -> String {
        let (mut text, radius) = match &self.shape {
            Shape::Cylinder {
                radius,
                half_length,
            } => (
                format!(
                    "cylinder, radius {radius:.5} m, width {:.5} m",
                    2.0 * half_length
                ),
                *radius,
            ),
            shape => {
                let radius = shape.bounding_radius();
                (format!("sphere, radius {radius:.5} m"), radius)
            }
        };
        let _ = write!(
            text,
            ", radial error {:.3} mm rms, {:.3} mm ({:.2} %) at most",
            1e3 * self.rms,
            1e3 * self.worst,
            100.0 * self.worst / radius
        );
        let offset = libm::hypot(self.center.x, self.center.y);
        if offset > 0.0 {
            let _ = write!(text, ", centre {:.2} mm off the axis", 1e3 * offset);
        }
        if self.overhang > 1e-3 * radius {
            let _ = write!(
                text,
                ", without {:.1} mm that stick out at an end",
                1e3 * self.overhang
            );
        }
        text
    }
}

/// Convex hull of points seen along z, counter-clockwise (monotone chain).
fn outline(points: &[Vec3]) -> Vec<[f64; 2]> {
    let mut flat: Vec<[f64; 2]> = points.iter().map(|p| [p.x, p.y]).collect();
    flat.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    flat.dedup();
    let size = flat.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    // A point nearly on the line between its neighbours is not a corner.
    let straight = 1e-9 * size * size;
    let turn = |a: &[f64; 2], b: &[f64; 2], c: &[f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let half = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = &chain[..]
                && turn(a, b, p) <= straight
            {
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut flat.iter());
    corners.extend(half(&mut flat.iter().rev()));
    corners
}

#[cfg(test)]
mod tests;
