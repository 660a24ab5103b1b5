//! Rays of sensors in the world: how far it is to the first thing in the way, and what it is.
//!
//! In: poses of a state. Out: a distance and a number for each ray. Things are the collision
//! shapes of all links, whatever they may touch, and the ground. All rays of a sensor begin in one
//! place, so its things are sorted once by how near they may be: a ray ends its search at the
//! first thing that cannot be nearer than what it has hit, and looks at a shape only if it meets
//! the ball around it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::frame::pose;
use crate::geometry::ray::{Ray, Target};
use crate::model::{Collider, LinkId, Model, SensorKind};
use crate::spatial::{Mat3, Pose, Vec3};
use crate::step::point::{Context, Point};
use crate::tree::within;

/// What stands for the ground where a hit is told.
const GROUND: f64 = -1.0;

/// By which part a ball around a shape is larger than it must be, so that round-off loses no hit.
const SLACK: f64 = 1e-7;

/// The rays of all sensors.
#[derive(Clone, Debug)]
pub struct Scans {
    /// What can be in the way; follows from the model.
    things: Vec<Thing>,
    /// Per sensor; filled when first read.
    sensors: Vec<Scan>,
    /// Things within reach of one sensor; scratch of [`Self::update`].
    seen: Vec<Seen>,
}

#[cfg(test)]
crate::spoil::spoil!(Scans: sensors; things seen);

/// Readings of one sensor; empty of one without rays.
#[derive(Clone, Debug, Default)]
struct Scan {
    /// m, per ray.
    distances: Vec<f64>,
    /// Per ray: what is hit, see [`Scans::hit`].
    hits: Vec<f64>,
    /// Whether both are those of the state.
    known: bool,
}

#[cfg(test)]
crate::spoil::spoil!(Scan: distances hits; known);

/// A collision shape.
#[derive(Clone, Debug)]
struct Thing {
    target: Target,
    body: usize,
    link: LinkId,
    /// Pose in the body's solver frame.
    X: Pose,
    /// A ball around it, in its own axes, m.
    center: Vec3,
    radius: f64,
}

impl Thing {
    #[cfg_attr(small, optimize(size))]
    fn new(model: &Model, collider: &Collider) -> Self {
        let (center, radius) = collider.shape.ball_around();
        Self {
            target: Target::new(&collider.shape),
            body: collider.body.index(),
            link: collider.link,
            X: within(&model.solver_frame(collider.body), &collider.X_BG),
            center,
            radius,
        }
    }
}

/// A thing as one sensor sees it.
#[derive(Clone, Debug)]
struct Seen {
    /// No point of it is nearer, m.
    least: f64,
    /// Its place in [`Scans::things`].
    thing: usize,
    /// Middle of the ball around it, sensor frame, m.
    center: Vec3,
    /// Square of that ball's radius, and of the distance of its middle, m².
    radius2: f64,
    distance2: f64,
    /// Sensor axes to the shape's, and the sensor's origin there, m.
    R_GS: Mat3,
    origin: Vec3,
}

impl Scans {
    /// Buffers for a robot.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        let of = |kind: &SensorKind| match kind {
            SensorKind::Ray { directions, .. } => Scan {
                distances: vec![0.0; directions.len()],
                hits: vec![0.0; directions.len()],
                known: false,
            },
            _ => Scan::default(),
        };
        let sensors: Vec<_> = model.outputs.sensors.iter().map(|s| of(&s.kind)).collect();
        let has_rays = sensors.iter().any(|scan| !scan.distances.is_empty());
        let colliders = model.colliders.iter().filter(|_| has_rays);
        let things: Vec<_> = colliders.map(|c| Thing::new(model, c)).collect();
        Self {
            seen: Vec::with_capacity(things.len()),
            things,
            sensors,
        }
    }

    /// The state has changed.
    pub fn invalidate(&mut self) {
        for scan in &mut self.sensors {
            scan.known = false;
        }
    }

    /// Distance along a ray of a sensor, m; its range where nothing is within it.
    pub fn distance(&mut self, ctx: &Context, point: &Point, sensor: usize, ray: usize) -> f64 {
        self.update(ctx, point, sensor);
        self.sensors[sensor].distances[ray]
    }

    /// What a ray of a sensor hits: 0 for nothing within its range, −1 for the ground, else one
    /// more than the index of the link.
    pub fn hit(&mut self, ctx: &Context, point: &Point, sensor: usize, ray: usize) -> f64 {
        self.update(ctx, point, sensor);
        self.sensors[sensor].hits[ray]
    }

    /// All rays of a sensor, unless they are known.
    fn update(&mut self, ctx: &Context, point: &Point, sensor: usize) {
        let SensorKind::Ray {
            directions,
            near,
            range,
            ignored,
            ..
        } = &ctx.model.outputs.sensors[sensor].kind
        else {
            return;
        };
        if self.sensors[sensor].known {
            return;
        }
        let (body, X) = pose(ctx, point, sensor);
        self.gather(ctx, point, (body, &X), (*range, ignored));
        let height = X.p.z + point.kin.origin(ctx.tree, body).z;
        let has_ground = ctx.model.world.ground.is_some();
        let scan = &mut self.sensors[sensor];
        let readings = scan.distances.iter_mut().zip(&mut scan.hits);
        for ((distance, hit), along) in readings.zip(directions) {
            (*distance, *hit) = (*range, 0.0);
            if has_ground {
                let slope = (X.R * along).z;
                if let Some(found) = ground(height, slope, *near).filter(|found| found < range) {
                    (*distance, *hit) = (found, GROUND);
                }
            }
            for seen in &self.seen {
                if seen.least >= *distance {
                    break;
                }
                let middle = seen.center.dot(along);
                let off2 = seen.distance2 - middle * middle;
                if off2 > seen.radius2 || (middle < 0.0 && seen.distance2 > seen.radius2) {
                    continue;
                }
                let thing = &self.things[seen.thing];
                let ray = Ray {
                    origin: seen.origin,
                    along: seen.R_GS * along,
                };
                if let Some(found) = thing.target.first(&ray, *near)
                    && found < *distance
                {
                    (*distance, *hit) = (found, f64::from(thing.link.0) + 1.0);
                }
            }
        }
        scan.known = true;
    }

    /// Things within reach, the nearest first.
    fn gather(
        &mut self,
        ctx: &Context,
        point: &Point,
        (body, X): (usize, &Pose),
        (range, ignored): (f64, &[LinkId]),
    ) {
        let kin = &point.kin;
        let R_SW = X.R.transpose();
        let own = kin.origin(ctx.tree, body);
        self.seen.clear();
        for (t, thing) in self.things.iter().enumerate() {
            if thing.body == body || ignored.binary_search(&thing.link).is_ok() {
                continue;
            }
            let X_OG = kin.X[thing.body].compose(&thing.X);
            // From the sensor's origin: each tree has an O of its own.
            let p = X_OG.p + (kin.origin(ctx.tree, thing.body) - own) - X.p;
            let center = R_SW * (p + X_OG.R * thing.center);
            let distance2 = center.norm_squared();
            let distance = distance2.sqrt();
            let radius = thing.radius + SLACK * (thing.radius + distance);
            if distance - radius > range {
                continue;
            }
            let R_GW = X_OG.R.transpose();
            self.seen.push(Seen {
                least: distance - radius,
                thing: t,
                center,
                radius2: radius * radius,
                distance2,
                R_GS: R_GW * X.R,
                origin: -(R_GW * p),
            });
        }
        self.seen.sort_unstable_by(|a, b| {
            let by_place = a.thing.cmp(&b.thing);
            a.least.total_cmp(&b.least).then(by_place)
        });
    }
}

/// The first point of a ray at or below the plane z = 0, m along it, not nearer than `near`.
///
/// - `height`: m, of the ray's beginning
/// - `slope`: by how much it rises per m
fn ground(height: f64, slope: f64, near: f64) -> Option<f64> {
    if height + near * slope <= 0.0 {
        Some(near)
    } else {
        (slope < 0.0).then(|| height / -slope)
    }
}

#[cfg(all(test, feature = "urdf"))]
mod tests;
