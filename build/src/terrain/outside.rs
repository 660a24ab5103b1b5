//! Which way a mesh looks, how large it is, and where it has holes: what can be read and is still
//! not what was meant.
//!
//! A triangle carries what is in front of it. A file whose triangles go round clockwise lets
//! everything fall through without a word, and one in millimetres is a thousand times too large.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::holes::holes;
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity};
use urdf2fmu_core::geometry::surface::{Facet, Surface};
use urdf2fmu_core::spatial::{Vec3, rotation_from_rpy};

/// Columns along x and y that are looked at.
const COLUMNS: u32 = 50;
/// Cosine below which a triangle is a wall.
const WALL: f64 = 0.1;
/// Share of the columns in which nothing looks up from which on this is told: single lines of sight
/// pass between triangles that do not meet exactly.
const FEW: f64 = 0.01;
/// Share of the sum of all areas below which the sum of the vectors of areas is that of a closed
/// surface.
const CLOSED: f64 = 1e-6;
/// A mesh that is wider is probably in mm, m.
const WIDEST: f64 = 2000.0;

/// What looks wrong in a mesh that is turned by `rpy`.
pub(super) fn findings(
    name: &str,
    surface: &Surface,
    rpy: &Vec3,
    place: Option<&Place>,
) -> Vec<Diagnostic> {
    let told = |severity, code, message: String, help: String| Diagnostic {
        severity,
        code,
        message: format!("terrain '{name}': {message}"),
        help: Some(help),
        place: place.cloned(),
    };
    let R = rotation_from_rpy(rpy);
    let mut found = Vec::new();
    if let [largest, others @ ..] = &holes(surface)[..] {
        let at = R * largest.middle;
        let what = if others.is_empty() {
            "a hole".to_owned()
        } else {
            format!("{} holes, the largest", 1 + others.len())
        };
        found.push(told(
            Severity::Warning,
            "T005",
            format!(
                "the mesh has {what} of {} m² about {}, {}, {} m from its origin: what comes there \
                 falls through",
                brief(largest.area),
                millimetres(at.x),
                millimetres(at.y),
                millimetres(at.z)
            ),
            "close it, unless things are to fall through it".to_owned(),
        ));
    }
    let [low, high] = extent(surface, |c| R * c);
    let size = high - low;
    let widest = size.x.max(size.y);
    if widest > WIDEST {
        found.push(told(
            Severity::Warning,
            "T004",
            format!("the mesh is {widest:.0} m wide"),
            "scale = 0.001 if it is in mm".to_owned(),
        ));
    }
    let (mut seen, mut blind) = (0_u32, 0_u32);
    // Off the diagonals of what is looked at: a line of sight along an edge may miss both triangles
    // there.
    let [across, along] =
        [0.5, 0.3].map(|in_column| move |k: u32| (f64::from(k) + in_column) / f64::from(COLUMNS));
    for i in 0..COLUMNS {
        for j in 0..COLUMNS {
            let from = Vec3::new(
                low.x + size.x * across(i),
                low.y + size.y * along(j),
                high.z + 1.0,
            );
            let (origin, down) = (R.tr_mul(&from), R.tr_mul(&-Vec3::z()));
            let (mut any, mut up) = (false, false);
            surface.each_along(&origin, &down, |facet, _| {
                if is_met(facet, &origin, &down) {
                    // A wall that leans back covers what is behind it, and is itself no ground.
                    let facing = facet.normal.dot(&down);
                    any |= facing.abs() >= WALL;
                    up |= facing < 0.0;
                }
            });
            seen += u32::from(any);
            blind += u32::from(any && !up);
        }
    }
    let help = "exchange two corners of each triangle ('flip normals' in modelling programs), or \
                write them counter-clockwise, seen from above";
    let share = f64::from(blind) / f64::from(seen.max(1));
    if share > FEW {
        let where_ = if blind == seen {
            "its outside is down".to_owned()
        } else {
            let percent = 100.0 * share;
            format!("of {percent:.0} % of it, seen from above, the outside is down")
        };
        let message = format!("{where_}: what comes from above falls through it");
        found.push(told(Severity::Warning, "T003", message, help.to_owned()));
    } else if is_room(surface) {
        let message = "its triangles look inwards: it is a room, which carries what is in it, and \
                       what comes from outside falls into it";
        found.push(told(
            Severity::Note,
            "T003",
            message.to_owned(),
            help.to_owned(),
        ));
    }
    found
}

/// A coordinate to the millimetre, m: its last digits are those of round-off.
fn millimetres(x: f64) -> f64 {
    (1e3 * x).round() / 1e3 + 0.0
}

/// A number with three digits.
fn brief(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// The lowest and the highest coordinates of its corners, m.
fn extent(surface: &Surface, place: impl Fn(&Vec3) -> Vec3) -> [Vec3; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY].map(Vec3::repeat);
    let corners = surface.facets().iter().flat_map(|facet| &facet.corners);
    corners
        .map(place)
        .fold(start, |[low, high], c| [low.inf(&c), high.sup(&c)])
}

/// Whether a line meets a triangle.
fn is_met(facet: &Facet, origin: &Vec3, along: &Vec3) -> bool {
    let facing = facet.normal.dot(along);
    if facing == 0.0 {
        return false;
    }
    let way = facet.normal.dot(&(facet.corners[0] - origin)) / facing;
    let x = origin + along * way;
    (0..3).all(|edge| facet.inward[edge].dot(&(x - facet.corners[edge])) >= 0.0)
}

/// Whether triangles enclose a space that they look into.
fn is_room(surface: &Surface) -> bool {
    let (mut areas, mut sum, mut volume) = (Vec3::zeros(), 0.0, 0.0);
    for facet in surface.facets() {
        let [a, b, c] = facet.corners;
        let area = (b - a).cross(&(c - a)) * 0.5;
        areas += area;
        sum += area.norm();
        volume += a.dot(&b.cross(&c)) / 6.0;
    }
    areas.norm() < CLOSED * sum && volume < 0.0
}
