//! What contact between two shapes needs of each, prepared when a model is loaded: a core, its
//! faces, what is round about it.
//!
//! The core is the shape with `rounding` taken off all around, so that the shape is nearly the core
//! swept by a ball: faces stay where they are, edges and corners are rounded. Two cores that do not
//! meet have a direction from one to the other that changes continuously with the poses; the
//! direction between the shapes with sharp edges would jump.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::super::faces::Faces;
use super::super::hull::{Simplices, hull};
use super::super::{MOST_CORNERS, Shape, bounded_hull};
use super::corners::Corners;
use super::mesh::{Bar, Mesh, box_mesh, ends, hull_mesh};
use crate::geometry::field::Field;
use crate::geometry::surface::Surface;
use crate::spatial::{Mat3, Pose, Vec3};
use crate::tuning::{ROUNDING, ROUNDING_SHARE};
use std::sync::Arc;

/// Rounding of the inner core, as a share of the smallest half extent. The less, the less the
/// direction turns over to that of a rounder shape: at 0.3 the corner of a box that came 2 mm deep
/// into the side of a cylinder was felt as 0.6 mm, and
/// `d8_a_passive_robot_never_gains_energy` fails. At 0.1 inner cores meet so soon that
/// `forces_do_not_jump_unless_shapes_overlap_deeply` fails.
const INNER: f64 = 0.15;

/// Blend of a shape that is too thin for a rounding, as a share of its reach.
const LEAST_BLEND: f64 = 1e-4;

/// Part of the rounding within which two corners of a core are one.
const SAME: f64 = 1e-6;

/// The convex set that directions between shapes are found from.
#[derive(Clone, Debug)]
pub(super) enum Core {
    /// Everything below the plane z = 0.
    HalfSpace,
    /// Everything below a surface of heights.
    Field(Arc<Field>),
    /// Everything behind the surface of a mesh.
    Surface(Arc<Surface>),
    /// The origin.
    Point,
    /// From `−half` to `half` on the z axis.
    Segment { half: f64 },
    /// About the z axis.
    Cylinder { radius: f64, half: f64 },
    /// Half extents.
    Box { half: Vec3 },
    /// The hull of these.
    Corners(Corners),
}

/// What a capsule or a cylinder is along its z axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub(super) radius: f64,
    pub(super) half: f64,
    /// Whether it ends flat.
    pub(super) flat: bool,
}

/// A shape, prepared for contact with others.
#[derive(Clone, Debug)]
pub struct Solid {
    pub(super) core: Core,
    /// A smaller one, for shapes that overlap by more than their roundings.
    pub(super) inner: Core,
    /// Radius of the ball that sweeps the core, m.
    pub(super) radius: f64,
    /// The same for the inner core, m.
    pub(super) inner_radius: f64,
    /// How far its sharp corners and edges reach beyond what sweeps its core, m, at most: the
    /// rounding, and more where a hull is acute. 0 for balls, capsules and planes, which have none.
    pub(super) sharp: f64,
    /// Length over which faces take over from each other, m.
    pub(super) blend: f64,
    /// Real faces; of a cylinder its two ends as polygons.
    pub(super) mesh: Mesh,
    pub(super) round: Option<Round>,
    /// Largest distance of one of its points from its origin, m; infinite for a half-space.
    pub(super) reach: f64,
    /// Shares of a hull's corners on a plane.
    pub(super) shares: Faces,
    /// For each corner of a box or a hull that of the core which is nearest to it.
    pub(super) core_corners: Vec<Vec3>,
    /// The edges of the core of a box or a hull, in its own axes.
    pub(super) bars: Vec<Bar>,
}

impl Solid {
    /// Prepares a shape. `thickness`: within it corners of a hull count as in one face where it
    /// stands on a plane, m.
    ///
    /// Of a hull with more than 64 corners the outermost 64 are kept, as everywhere.
    #[cfg_attr(small, optimize(size))]
    pub fn new(shape: &Shape, thickness: f64) -> Self {
        let reach = shape.bounding_radius();
        let is_round = matches!(shape, Shape::Sphere { .. } | Shape::Capsule { .. });
        let of = |core: Core, radius: f64, smallest: f64| Self {
            inner: core.clone(),
            core,
            radius,
            inner_radius: radius,
            sharp: if is_round { 0.0 } else { radius },
            blend: rounding(smallest).max(LEAST_BLEND * reach),
            mesh: Mesh::default(),
            round: None,
            reach,
            shares: Faces::default(),
            core_corners: Vec::new(),
            bars: Vec::new(),
        };
        match shape {
            Shape::Sphere { radius } => of(Core::Point, *radius, *radius),
            Shape::Capsule {
                radius,
                half_length: half,
            } => Self {
                round: Some(Round {
                    radius: *radius,
                    half: *half,
                    flat: false,
                }),
                ..of(Core::Segment { half: *half }, *radius, *radius)
            },
            Shape::Cylinder {
                radius,
                half_length: half,
            } => {
                let smallest = radius.min(*half);
                let r = rounding(smallest);
                let core = |r: f64| Core::Cylinder {
                    radius: radius - r,
                    half: half - r,
                };
                Self {
                    round: Some(Round {
                        radius: *radius,
                        half: *half,
                        flat: true,
                    }),
                    mesh: ends(*radius, *half),
                    inner: core(INNER * smallest),
                    inner_radius: INNER * smallest,
                    ..of(core(r), r, smallest)
                }
            }
            Shape::Box { half } => {
                let r = rounding(half.min());
                let core = |r: f64| Core::Box {
                    half: half.add_scalar(-r),
                };
                let mesh = box_mesh(half);
                let within = |c: &Vec3| c - c.map(|x| r * x.signum());
                let core_corners: Vec<Vec3> = mesh.corners.iter().map(within).collect();
                Self {
                    bars: Bar::edges(&mesh, &core_corners, r),
                    core_corners,
                    mesh,
                    inner: core(INNER * half.min()),
                    inner_radius: INNER * half.min(),
                    ..of(core(r), r, half.min())
                }
            }
            Shape::Hull { vertices } => {
                let kept = bounded_hull(vertices, MOST_CORNERS);
                let corners = kept.map_or_else(|_| vertices.clone(), |hull| hull.vertices);
                let mesh = hull_mesh(&corners, reach);
                let smallest = thickness_of(&mesh);
                let (core, r) = shrunk(&mesh, rounding(smallest));
                let (inner, inner_radius) = shrunk(&mesh, INNER * smallest);
                let within = |c: &Vec3| nearest_of(&core, c);
                let core_corners: Vec<Vec3> = mesh.corners.iter().map(within).collect();
                Self {
                    sharp: sharpness(&mesh, &core_corners, r),
                    shares: Faces::new(&corners, thickness),
                    bars: Bar::edges(&mesh, &core_corners, r),
                    core_corners,
                    mesh,
                    inner: Core::Corners(Corners::new(inner)),
                    inner_radius,
                    ..of(Core::Corners(Corners::new(core)), r, smallest)
                }
            }
            Shape::Plane => Self::half_space(),
            Shape::Field { field } => Self {
                core: Core::Field(field.clone()),
                ..Self::half_space()
            },
            Shape::Surface { surface } => Self {
                core: Core::Surface(surface.clone()),
                ..Self::half_space()
            },
        }
    }

    /// How far a ball about `center` is from terrain that stands at `X`, at least, m; none for what
    /// is no terrain.
    pub fn clearance(&self, X: &Pose, center: &Vec3, radius: f64) -> Option<f64> {
        let p = X.R.tr_mul(&(center - X.p));
        match &self.core {
            Core::HalfSpace => Some(p.z - radius),
            Core::Field(field) => {
                let clear = p.z - radius - field.top();
                let near = clear <= 0.0;
                Some(if near {
                    p.z - radius - field.highest(p.x, p.y, radius)
                } else {
                    clear
                })
            }
            Core::Surface(surface) => {
                // Positive where no triangle is near.
                let near = surface.is_near(&p, radius);
                Some(if near { -radius } else { f64::MIN_POSITIVE })
            }
            _ => None,
        }
    }

    /// Whether it is a surface with everything below.
    pub fn is_terrain(&self) -> bool {
        matches!(
            self.core,
            Core::HalfSpace | Core::Field(_) | Core::Surface(_)
        )
    }

    /// The half-space below the plane z = 0 of its own axes.
    #[cfg_attr(small, optimize(size))]
    pub fn half_space() -> Self {
        Self {
            core: Core::HalfSpace,
            inner: Core::HalfSpace,
            radius: 0.0,
            inner_radius: 0.0,
            sharp: 0.0,
            blend: 0.0,
            mesh: Mesh::default(),
            round: None,
            reach: f64::INFINITY,
            shares: Faces::default(),
            core_corners: Vec::new(),
            bars: Vec::new(),
        }
    }

    /// How much its edges are rounded by to find directions, m; 0 for balls, capsules and planes,
    /// which have none.
    pub fn rounding(&self) -> f64 {
        match self.core {
            Core::Cylinder { .. } | Core::Box { .. } | Core::Corners(_) => self.radius,
            _ => 0.0,
        }
    }

    /// Half of its least extent, m, where that is below 5 cm; else no more than its half extents.
    pub fn thickness(&self) -> f64 {
        match self.core {
            Core::Point | Core::Segment { .. } => self.radius,
            Core::Cylinder { .. } | Core::Box { .. } | Core::Corners(_) => {
                self.radius / ROUNDING_SHARE
            }
            Core::HalfSpace | Core::Field(_) | Core::Surface(_) => f64::INFINITY,
        }
    }
}

/// By how much edges of a shape with this smallest half extent are rounded.
fn rounding(smallest: f64) -> f64 {
    ROUNDING.min(ROUNDING_SHARE * smallest)
}

/// The middle of a hull's corners.
fn center(mesh: &Mesh) -> Vec3 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = mesh.corners.len() as f64;
    mesh.corners.iter().sum::<Vec3>() / count
}

/// How far the faces of a hull are from its middle.
fn inside<'a>(mesh: &'a Mesh, center: &'a Vec3) -> impl Fn(usize) -> f64 + 'a {
    move |face| {
        let corner = mesh.corners[mesh.face(face)[0]];
        mesh.normals[face].dot(&(corner - center))
    }
}

/// Least distance of a face of a hull from its middle; 0 if it has no volume.
fn thickness_of(mesh: &Mesh) -> f64 {
    if mesh.normals.len() < 4 {
        return 0.0;
    }
    let center = center(mesh);
    let least = (0..mesh.normals.len()).map(inside(mesh, &center));
    least.fold(f64::INFINITY, f64::min).max(0.0)
}

/// The core of a hull with that rounding, and it; the hull itself and 0 where it has no volume.
#[cfg_attr(small, optimize(size))]
fn shrunk(mesh: &Mesh, r: f64) -> (Vec<Vec3>, f64) {
    let core = if r > 0.0 { moved_in(mesh, r) } else { None };
    core.map_or_else(|| (mesh.corners.clone(), 0.0), |core| (core, r))
}

/// See [`Solid::sharp`], of a hull whose core has the rounding `r`.
fn sharpness(mesh: &Mesh, core_corners: &[Vec3], r: f64) -> f64 {
    let corners = mesh.corners.iter().zip(core_corners);
    let beyond = corners.map(|(corner, core)| (corner - core).norm() - r);
    beyond.fold(r, f64::max)
}

/// The one of some places that is nearest to another one.
fn nearest_of(places: &[Vec3], to: &Vec3) -> Vec3 {
    let apart = |place: &&Vec3| (*place - to).norm_squared();
    let nearest = places.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
    nearest.copied().unwrap_or(*to)
}

/// Corners of the hull whose faces are all moved in by `r`.
///
/// 1. About an inner point `c` the faces are `ν·x ≤ e`, with `x` from `c` and `e > 0`.
/// 2. Moved in they are `p·x ≤ 1` with `p = ν/(e − r)`. A corner where faces `i j k` meet solves
///    `p_i·x = p_j·x = p_k·x = 1` and violates no other: `x` is the normal of a face of the hull of
///    all `p`, over its distance from 0.
fn moved_in(mesh: &Mesh, r: f64) -> Option<Vec<Vec3>> {
    let center = center(mesh);
    let inside = inside(mesh, &center);
    let dual: Vec<Vec3> = (0..mesh.normals.len())
        .map(|face| mesh.normals[face] / (inside(face) - r))
        .collect();
    let found = hull(&dual, dual.len().max(4))?;
    let Simplices::Faces(triangles) = &found.simplices else {
        return None;
    };
    let mut corners: Vec<Vec3> = Vec::new();
    for triangle in triangles {
        let [p, q, s] = triangle.map(|i| found.corners[i]);
        let rows = Mat3::from_rows(&[p.transpose(), q.transpose(), s.transpose()]);
        let Some(x) = rows.lu().solve(&Vec3::repeat(1.0)) else {
            continue;
        };
        let corner = x + center;
        if !corners.iter().any(|c| (c - corner).norm() < SAME * r) {
            corners.push(corner);
        }
    }
    (corners.len() >= 4).then_some(corners)
}
