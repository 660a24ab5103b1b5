//! Where a contact carries its load: its depth, the shares of its points, their centre.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Response, normal_part};
use super::pairs::Pairs;
use super::point::{ContactPoint, PointResponse, norm};
use super::spread::Spread;
use crate::geometry::pair::MOST_PARTS;
use crate::kinematics::Kinematics;
use crate::law::Face;
use crate::model::Model;
use crate::spatial::{Vec3, Vec6, across, angular};
use crate::tree::Tree;

/// Where friction acts.
pub(super) struct Footing {
    /// See [`Contact::center`].
    pub center: Vec3,
    /// See [`Contact::radius`].
    pub radius: f64,
    /// Which forces it can bear there, where these are others.
    pub limit: Option<Face>,
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
        self.find_center(points);
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
            self.friction.limit.lean(&self.normal);
        }
    }

    /// Finds where the load is, and how it is spread.
    fn find_center(&mut self, points: &[ContactPoint]) {
        let own = &points[self.points.clone()];
        let (center, spread) = self.spread(own, |i| own[i].load);
        (self.center, self.radius) = (center, spread.radius(own.len()));
        self.oblong = spread.oblong();
    }

    /// Puts friction to where the load is.
    pub(crate) fn center_on_load(&mut self, points: &[ContactPoint]) {
        self.find_center(points);
        self.friction.limit = self.oblong.limit(&self.normal, &self.pull);
    }

    /// Finds which forces friction can bear, for sliding along the way in which it pulls at the
    /// velocity `u` of the start.
    pub(crate) fn slide_along(&mut self, u: &Vec3) {
        let friction = &self.friction;
        self.pull = friction.displacement * friction.stiffness + self.slid(u) * friction.damping;
        self.friction.limit = self.oblong.limit(&self.normal, &self.pull);
    }

    /// Lets friction act there.
    pub(super) fn stand(&mut self, footing: &Footing) {
        self.center = footing.center;
        self.radius = footing.radius;
        if let Some(limit) = footing.limit {
            self.friction.limit = limit;
        }
    }

    /// Where the load is that it has at the end of a step; where it is if it has none.
    pub(super) fn footing_under(
        &self,
        points: &[ContactPoint],
        (r, of): (&Response, &[PointResponse]),
    ) -> Footing {
        let own = &points[self.points.clone()];
        let total: f64 = of.iter().map(|r| r.weight).sum();
        // Depths of round-off may press without having shares.
        if !r.presses() || total <= 0.0 {
            return Footing {
                center: self.center,
                radius: self.radius,
                limit: None,
            };
        }
        let (center, spread) = self.spread(own, |i| of[i].weight / total);
        // What stands on two points is a line whatever their shares are, and a rim is round.
        let same = own.len() < 3 && spread.whole > 0.0 && !self.friction.limit.is_point();
        let limit = (!same).then(|| spread.oblong().limit(&self.normal, &self.pull));
        Footing {
            center,
            radius: spread.radius(own.len()),
            limit,
        }
    }

    /// Centre of a load, and how it is spread about it.
    ///
    /// - `loads`: shares of the load of its points `own`
    fn spread(&self, own: &[ContactPoint], loads: impl Fn(usize) -> f64) -> (Vec3, Spread) {
        let mut spread = Spread::default();
        if let [ContactPoint { x, rim: None, .. }] = own {
            return (*x, spread);
        }
        let mut center = Vec3::zeros();
        for (i, p) in own.iter().enumerate() {
            let load = loads(i);
            center += p.x * load;
            if let Some(rim) = &p.rim {
                spread.discs[0] += load * rim.flatness * rim.radius;
                spread.discs[1] += load * rim.flatness * rim.radius * rim.radius;
            }
        }
        if let [a, b] = own {
            // Both are on one line through their centre.
            let (_, apart) = normal_part(&self.normal, &(a.x - b.x));
            let (share, squared) = (loads(0) * loads(1), apart.norm_squared());
            spread.mean = 2.0 * share * squared.sqrt();
            spread.whole = share * squared;
            spread.first = apart;
            spread.turned[0] = spread.whole;
            return (center, spread);
        }
        spread.first = across(&self.normal);
        let second = self.normal.cross(&spread.first);
        for (i, p) in own.iter().enumerate() {
            let apart = p.x - center;
            spread.add(loads(i), [apart.dot(&spread.first), apart.dot(&second)]);
        }
        (center, spread)
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
