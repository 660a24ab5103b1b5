//! Where a contact carries its load: its depth, the shares of its points, their centre.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Response, normal_part};
use super::pairs::Pairs;
use super::point::{ContactPoint, PointResponse, norm};
use crate::geometry::pair::MOST_PARTS;
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::spatial::{Vec3, Vec6, across, angular};
use crate::tree::Tree;
use crate::tuning::{EVEN_DISC, EVEN_LINE, MIN_CORNERS};

/// Mean distance of an even pressure from its middle, as a share of that of the points that carry
/// it, which are its corners: on a regular polygon of `n` corners, with `φ = π/n`,
///
/// ```text
/// ∫∫ r² dr dα/∫∫ r dr dα = R/3 (1 + cos φ ln(sec φ + tan φ)/tan φ)
/// ```
///
/// and half of the half length on a line. Between them it goes with the square of `2 a b/(a² + b²)`
/// of the root mean squares `a`, `b` of the distances along the principal axes, which for
/// rectangles is right to 1 % and smooth where the corners come to stand in a line. As many
/// corners as carry count, `1/Σ load²`, at least four, so that it does not jump where one of them
/// leaves. A triangle has 0.46 and is given 0.54.
///
/// - `loads`: those of the points
fn even_share(
    (points, loads): (&[ContactPoint], impl Fn(usize) -> f64),
    center: &Vec3,
    normal: &Vec3,
) -> f64 {
    if points.len() < 3 {
        return EVEN_LINE;
    }
    let (mut squares, mut whole, mut turned) = (0.0, 0.0, [0.0; 2]);
    let first = across(normal);
    let second = normal.cross(&first);
    for (i, p) in points.iter().enumerate() {
        let (load, apart) = (loads(i), p.x - center);
        let (x, y) = (apart.dot(&first), apart.dot(&second));
        squares += load * load;
        whole += load * (x * x + y * y);
        turned[0] += load * (x * x - y * y);
        turned[1] += load * 2.0 * x * y;
    }
    let [a, b] = turned;
    let round = (whole * whole - a * a - b * b) / (whole * whole);
    if squares <= 0.0 || round.is_nan() {
        return EVEN_LINE;
    }
    let corners = (1.0 / squares).max(MIN_CORNERS);
    let (sin, cos) = libm::sincos(std::f64::consts::PI / corners);
    let regular = (1.0 + cos * cos / sin * libm::log((1.0 + sin) / cos)) / 3.0;
    EVEN_LINE + round.max(0.0) * (regular - EVEN_LINE)
}

/// Makes the sum of the loads 1; points of which none carries anything share it evenly.
fn share_out(points: &mut [ContactPoint]) {
    let total: f64 = points.iter().map(|p| p.load).sum();
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let even = 1.0 / points.len() as f64;
    for p in points {
        p.load = if total > 0.0 { p.load / total } else { even };
    }
}

impl Contact {
    /// Moves its points by the displacement `way` of all bodies and by its rise over `risen`
    /// seconds, and finds its depth and the shares of its load there. Centre and radius stay, where
    /// a load has them.
    pub(super) fn shift(&mut self, points: &mut [ContactPoint], way: &[Vec6], risen: f64) {
        let W = self.relative(way);
        let w = angular(&W);
        for p in &mut points[self.points.clone()] {
            p.depth -= p.along(&W) + risen * self.rise;
            if let Some(rim) = &mut p.rim {
                p.depth += rim.shift(&p.normal, &w);
            }
        }
        let loaded = self.depth > 0.0;
        self.share_load(points);
        if !loaded {
            self.center_on_load(points);
        }
        self.load = self.load.min(self.loads(0.0)[1]);
    }

    /// Finds depth, shares of the load, centre and radius from the points that are there; where
    /// nothing presses yet, the shares are those that the spatial velocities `V` of all bodies lead
    /// to within `h` seconds.
    pub(crate) fn gather(&mut self, points: &mut [ContactPoint], V: &[Vec6], h: f64) {
        self.share_load(points);
        if self.depth <= 0.0 {
            self.expect_load(points, V, h);
        }
        self.center_on_load(points);
    }

    /// Finds the shares of the load to come: those of the depths to which the velocities take the
    /// points within `h` seconds, or, if these are less, of points that are pressed in together as
    /// deep as a weight makes them.
    ///
    /// Four corners of a face that comes down flat have a quarter each, whatever round-off makes of
    /// their heights. By their heights alone the deepest of them had all, by 1e-16 m: a box that
    /// landed flat in fixed steps and slid was turned by the friction of one corner, at 6.5 rad/s.
    fn expect_load(&mut self, points: &mut [ContactPoint], V: &[Vec6], h: f64) {
        let W = self.relative(V);
        let own = &mut points[self.points.clone()];
        let ahead = |p: &ContactPoint| p.depth - h * p.along(&W);
        let deepest = own.iter().map(ahead).fold(f64::NEG_INFINITY, f64::max);
        let pressed = (self.spring.reference - deepest).max(0.0);
        for p in own.iter_mut() {
            let depth = (ahead(p) + pressed).max(0.0);
            p.load = p.share * (depth * depth * depth);
        }
        share_out(own);
        self.lean_on_load(points);
    }

    /// Makes its points deeper by so much, m.
    pub(crate) fn sink(&self, points: &mut [ContactPoint], by: f64) {
        for p in &mut points[self.points.clone()] {
            p.depth += by;
        }
    }

    /// Finds depth and shares of the load, and what follows from these for the normal. Where
    /// nothing presses, the shares stay.
    pub(crate) fn share_load(&mut self, points: &mut [ContactPoint]) {
        let own = &mut points[self.points.clone()];
        let (depth, weights) = norm(own, 0.0);
        (self.depth, self.weights) = (depth, weights);
        if depth > 0.0 {
            for p in own.iter_mut() {
                let part = p.depth.max(0.0) / depth;
                p.load = p.share * part * part * part / weights;
            }
            share_out(own);
        }
        self.lean_on_load(points);
    }

    /// Makes its rows, together, what its depth changes by with displacements and with rotations
    /// about the centre of its load, in shares of what it changes by where all points sink.
    pub(super) fn lean(&mut self, points: &mut [ContactPoint], [way, turn]: [Vec3; 2]) {
        let own = &mut points[self.points.clone()];
        let (mut row, mut arm) = (-way, -(turn + self.center.cross(&way)));
        for p in own.iter() {
            row -= p.row * p.load;
            arm -= p.arm * p.load;
        }
        for p in own {
            p.row += row;
            p.arm += arm;
        }
        self.uneven = true;
    }

    /// Lets the direction in which a rim leans by little follow its load within a step of `h`
    /// seconds, see the rims of [`super::contact`].
    pub(super) fn let_swing(&self, points: &mut [ContactPoint], h: f64) {
        let swing = 2.0 * h * h * self.load / self.mass;
        for p in &mut points[self.points.clone()] {
            if let Some(rim) = &mut p.rim {
                rim.let_swing(swing);
            }
        }
    }

    /// Takes the shares of the load from where the contact was before. Loads follow from depths
    /// that are a hundredth of what a step moves by: a place that is expected does not know them.
    pub(crate) fn take_loads(&mut self, points: &mut [ContactPoint], before: &[ContactPoint]) {
        let own = &mut points[self.points.clone()];
        let load = |p: &ContactPoint| before.iter().find(|b| b.is(p));
        let total: f64 = own.iter().filter_map(|p| Some(load(p)?.load)).sum();
        if total > 0.0 {
            for p in own {
                p.load = load(p).map_or(0.0, |b| b.load / total);
            }
            self.lean_on_load(points);
            self.center_on_load(points);
        }
    }

    /// What friction acts against at the velocity `u` of the bodies.
    #[inline]
    pub(super) fn slid(&self, u: &Vec3) -> Vec3 {
        u + self.drift + self.carried
    }

    /// Normal force at the start of the step, N, for velocities of all bodies.
    pub fn normal_load(&self, points: &[ContactPoint], V: &[Vec6]) -> f64 {
        self.loads(self.normal_velocity(points, V))[0]
    }

    /// Normal force at the start of the step, N, and that of the spring alone.
    ///
    /// - `along`: [`Self::normal_velocity`]
    #[inline]
    pub(super) fn loads(&self, along: f64) -> [f64; 2] {
        if self.depth <= 0.0 {
            return [0.0; 2];
        }
        let weights = self.weights;
        let damped = self.normal_force(self.depth, -weights * along, 1.0).0;
        [damped * weights, self.spring.force(self.depth) * weights]
    }

    /// On uneven ground, finds the mean of the normals, along which friction does not act.
    fn lean_on_load(&mut self, points: &[ContactPoint]) {
        if self.uneven {
            let own = points[self.points.clone()].iter();
            let mean: Vec3 = own.map(|p| p.normal * p.load).sum();
            self.normal = mean.try_normalize(0.0).unwrap_or(self.normal);
        }
    }

    /// Finds the centre of the load and its mean distance from it.
    pub(crate) fn center_on_load(&mut self, points: &[ContactPoint]) {
        let own = &points[self.points.clone()];
        (self.center, self.radius) = self.center_of(own, |i| own[i].load);
    }

    /// The same of the load that it has at the end of a step; as they are where it has none.
    pub(super) fn center_under(
        &self,
        points: &[ContactPoint],
        (r, of): (&Response, &[PointResponse]),
    ) -> (Vec3, f64) {
        let total: f64 = of.iter().map(|r| r.weight).sum();
        // Depths of round-off may press without having shares.
        if !r.presses() || total <= 0.0 {
            return (self.center, self.radius);
        }
        self.center_of(&points[self.points.clone()], |i| of[i].weight / total)
    }

    /// - `loads`: shares of the load of its points `own`
    fn center_of(&self, own: &[ContactPoint], loads: impl Fn(usize) -> f64) -> (Vec3, f64) {
        let mut center = Vec3::zeros();
        for (i, p) in own.iter().enumerate() {
            center += p.x * loads(i);
        }
        let mut radius = 0.0;
        let even = even_share((own, &loads), &center, &self.normal);
        for (i, p) in own.iter().enumerate() {
            let (_, apart) = normal_part(&self.normal, &(p.x - center));
            radius += loads(i) * apart.norm() * even;
            if let Some(rim) = &p.rim {
                radius += loads(i) * EVEN_DISC * rim.radius * rim.flatness;
            }
        }
        (center, radius)
    }
}

/// All contacts of a step, and their points.
#[derive(Clone, Debug)]
pub struct ContactSet {
    /// By ascending slot.
    pub list: Vec<Contact>,
    /// Those of all contacts, in the same order.
    pub points: Vec<ContactPoint>,
    /// Scratch of the search for pairs of shapes.
    pub(crate) pairs: Pairs,
    /// Depth, m, of the contact of each slot that has been found when energies were last, see
    /// [`super::held`].
    pub depths: Vec<(usize, f64)>,
}

impl ContactSet {
    /// Room for so many contacts and points, none between two bodies.
    pub fn new([contacts, points]: [usize; 2]) -> Self {
        Self {
            list: Vec::with_capacity(contacts),
            points: Vec::with_capacity(points),
            pairs: Pairs::default(),
            depths: Vec::with_capacity(contacts),
        }
    }

    /// Room for all that can touch in a model.
    #[cfg_attr(small, optimize(size))]
    pub fn of(model: &Model) -> Self {
        Self {
            pairs: Pairs::new(model),
            ..Self::new(model.contact_room())
        }
    }

    /// Whether shapes that are not in contact here have come so near within the `h` seconds to the
    /// poses and velocities of `kin` that they may have met on the way: motors may make them much
    /// faster than they were when contacts were looked for. Only scratch of `self` changes.
    ///
    /// - `known`: contacts as they were found at the start
    pub fn has_missed(&mut self, tree: &Tree, kin: &Kinematics, h: f64, known: &Self) -> bool {
        let is_known = |places| {
            let slot = tree.contact.slot(places);
            let at = known.list.partition_point(|c| c.slot < slot);
            let next = known.list.get(at);
            next.is_some_and(|c| c.slot < slot + MOST_PARTS)
        };
        self.pairs
            .each((tree, kin), ([h, 0.0], false), is_known, |_, _, _, _| true)
    }

    /// Joins the trees of which shapes may come near each other within `h` seconds, or are nearer
    /// than `margin`, m. Only scratch of `self` changes.
    ///
    /// - `left_out`: trees that are not joined with each other; may be empty
    /// - `leader`: the first tree of the group of each tree
    pub fn group(
        &mut self,
        (tree, kin): (&Tree, &Kinematics),
        [h, margin]: [f64; 2],
        left_out: &[bool],
        leader: &mut [usize],
    ) {
        self.pairs.group((tree, kin), [h, margin], left_out, leader);
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Each of them.
    #[expect(
        clippy::iter_without_into_iter,
        reason = "the points belong to it, too"
    )]
    pub fn iter(&self) -> std::slice::Iter<'_, Contact> {
        self.list.iter()
    }

    /// Drops all.
    pub fn clear(&mut self) {
        self.list.clear();
        self.points.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms: a line, a square and a hexagon of corners at the distance 1, a rectangle of
    /// 5:1 (by a sum over its area: 0.5108) and a polygon that is nearly a disc. What stands on
    /// one corner, nearly, has a lever, too.
    #[test]
    fn an_even_pressure_has_the_lever_of_its_corners() {
        let share = |places: &[(f64, f64, f64)]| {
            let point = |&(x, y, load): &(f64, f64, f64)| ContactPoint {
                x: Vec3::new(x, y, 0.0),
                load,
                ..ContactPoint::default()
            };
            let points: Vec<ContactPoint> = places.iter().map(point).collect();
            let center = points.iter().map(|p| p.x * p.load).sum();
            even_share((&points, |i| points[i].load), &center, &Vec3::z())
        };
        let polygon = |n: u32| {
            let corner = |i: u32| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
                (cos, sin, 1.0 / f64::from(n))
            };
            share(&(0..n).map(corner).collect::<Vec<_>>())
        };
        let corners = [(5.0, 1.0), (5.0, -1.0), (-5.0, 1.0), (-5.0, -1.0)];
        let rectangle = share(&corners.map(|(x, y)| (x, y, 0.25)));
        let edge = share(&corners.map(|(x, y)| (x, y, if y > 0.0 { 0.5 } else { 0.0 })));
        for (found, expected, most) in [
            (polygon(4), 0.541_075, 1e-6),
            (polygon(6), 0.607_986, 1e-6),
            (polygon(60), 2.0 / 3.0, 1e-3),
            (rectangle, 0.5108, 6e-3),
            (edge, 0.5, 1e-12),
        ] {
            assert!((found - expected).abs() < most, "{found} {expected}");
        }
        let one = share(&[(0.0, 0.0, 0.98), (1.0, 0.0, 0.01), (0.0, 1.0, 0.01)]);
        assert!((0.3..0.7).contains(&one), "{one}");
    }
}
