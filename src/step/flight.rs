//! What moves freely keeps its momentum.
//!
//! While nothing but gravity acts from outside on what moves freely (see [`Kept`]), its momentum
//! grows by its weight in all directions in which it can move, and its centre of mass goes with it,
//! whatever motors, limits and friction inside do. For a robot with a floating base these are its
//! parabola and its angular momentum. The same is true of several such parts that push each other
//! and nothing else, as a gripper in space and what it holds: see [`super::company`]. A step knows
//! this to its own error only: its lever arms and inertias are those of its middle, and what turns
//! or slides within it gets the impulse of a contact in another place.
//!
//! Here the free joints take up what the steps of a communication step have lost or made: all that
//! they carry moves as one rigid body, which of all changes of velocity that restore the momentum
//! has the least kinetic energy. Places change by what slides take up of the way of the centre of
//! mass; angles do not.
//!
//! 1. Let a part of the inertia `I` lack the momentum `p`, both about one place, and let its free
//!    joints have the columns `S`. What hangs on nothing that is free changes its velocities by
//!    `δ` with `Sᵀ I S δ = Sᵀ p`, and moves on by the twist `S δ`.
//! 2. Where a part hangs on a free part, both lack momenta, of which the outer one's is that of
//!    all. With `U = I S` and `D = Sᵀ U`, the inner one gives back to the outer one's `I` and `p`
//!    what it takes up itself, `U D⁻¹ Uᵀ` and `U D⁻¹ Sᵀ p`; the outer one then moves it by the
//!    twist `ξ`, and it takes up `D⁻¹ (Sᵀ p − Uᵀ ξ)`: the articulated-body algorithm of what is
//!    free.
//! 3. Parts that have pushed each other move by one twist, in which all of them can move: the
//!    columns are those of the one that has the fewest, `I` and `p` are sums.
//!
//! A momentum is that about the centre of mass here. What the centre of mass has gone aside by `s`,
//! where no slide takes that up, has changed it by `s × P` of the momentum `P`: what turns about an
//! axis that stands still keeps its momentum about the axis.
//!
//! A fixed step may have turned something so far that its momentum is far from what it was. To
//! restore that would make energy: where it makes more than such a step may, angular velocities
//! stay as solved.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod share;

use crate::kinematics::Kinematics;
use crate::spatial::{Vec3, add_scaled6, add6, angular, dot6, join, linear, velocity_at};
use crate::state::{Physical, State};
use crate::step::attempt::Attempt;
use crate::step::company::Company;
use crate::step::guards;
use crate::step::point::Context;
use crate::tree::{Kept, Space, Tree};
use crate::tuning::GAIN;
use share::{Flight, Share};

/// What flies from a communication point on, and scratch.
#[derive(Clone, Debug)]
pub(super) struct Flights {
    /// What it keeps, what hangs on others first.
    list: Vec<Flight>,
    shares: Vec<Share>,
    /// Where in the list each of [`Tree::kept`] is.
    place: Vec<usize>,
}

impl Flights {
    /// Room for a tree.
    pub fn new(tree: &Tree) -> Self {
        let room = tree.bodies.len();
        Self {
            list: Vec::with_capacity(room),
            shares: Vec::with_capacity(room),
            place: vec![0; room],
        }
    }

    /// Finds what flies from `state` on, and what it keeps: nothing holds it, nothing pushes it,
    /// and it touches nothing but what flies with it. Poses and velocities of `kin` then stand at
    /// `state`; tells whether there is any.
    pub fn begin(
        &mut self,
        ctx: &Context,
        state: &State,
        (kin, company): (&mut Kinematics, &mut Company),
    ) -> bool {
        self.list.clear();
        let tree = ctx.tree;
        let undisturbed = tree.world.drag == 0.0 && ctx.inputs.wrenches.is_empty();
        let q = &state.physical.q;
        let may_fly = |part: &Kept| {
            ctx.rules.momentum && undisturbed && tree.takes(part.tree) && !tree.is_limited(part, q)
        };
        company.part(|index| tree.kept.get(index).is_some_and(may_fly));
        for touch in &state.physical.memory.touches {
            let links = ctx.model.links_of(touch.slot);
            company.join_links(links.map(|link| link.map(crate::model::LinkId::index)));
        }
        company.join_springs(tree);
        company.accept();
        company.ground(tree);
        // What touches shows in each step, what hangs on springs goes together for good.
        company.separate();
        company.join_springs(tree);
        company.accept();
        for kept in (0..tree.kept.len()).filter(|kept| company.flies(*kept)) {
            if self.list.is_empty() {
                pose(kin, tree, &state.physical);
            }
            self.place[kept] = self.list.len();
            self.list.push(Flight::of(tree, kin, kept));
        }
        !self.list.is_empty()
    }

    /// Puts what should be in that has flown, `h` seconds later in `state`, into `attempt`; tells
    /// whether that is known of any: nothing that is held has touched it since.
    pub fn keep(
        &mut self,
        ctx: &Context,
        state: &State,
        h: f64,
        (kin, attempt): (&mut Kinematics, &mut Attempt),
    ) -> bool {
        let (tree, company) = (ctx.tree, &mut attempt.company);
        for flight in &self.list {
            // Something carries what has come to rest, with or without friction.
            if state.stepping.rested[tree.kept[flight.kept].tree] > 0.0 {
                company.keep_down(flight.kept);
            }
        }
        company.ground(tree);
        self.list.retain(|flight| company.flies(flight.kept));
        if self.list.is_empty() {
            return false;
        }
        attempt.stay(state);
        // Places.
        self.meet(ctx, h, (kin, attempt));
        for share in &mut self.shares {
            let way = share.now.inertia.mass * share.moved;
            let slides = tree.kept[share.now.kept].places().len();
            share.begin(&(Vec3::zeros(), way), slides);
        }
        self.take_up();
        self.give(tree, &mut attempt.end, true);
        // Velocities, there.
        self.meet(ctx, h, (kin, attempt));
        self.lack(ctx, h);
        self.take_up();
        if ctx.fixed_step > 0.0 {
            let mut spoils = false;
            for index in 0..self.shares.len() {
                let made = [self.made_by_turning(index), GAIN];
                self.shares[index].turns = !guards::takes(ctx, kin, &attempt.end, made);
                spoils |= !self.shares[index].turns;
            }
            if spoils {
                self.lack(ctx, h);
                self.take_up();
            }
        }
        self.give(tree, &mut attempt.end, false);
        true
    }

    /// Finds what momenta all lack.
    fn lack(&mut self, ctx: &Context, h: f64) {
        for (share, before) in self.shares.iter_mut().zip(&self.list) {
            let now = &share.now;
            let weight = ctx.tree.world.gravity * (now.inertia.mass * h);
            let linear = before.linear + weight - now.linear;
            let aside = share.moved.cross(&before.linear);
            let angular = before.angular - now.angular + aside;
            let part = &ctx.tree.kept[now.kept];
            let count = if share.turns {
                part.columns().len()
            } else {
                part.places().len()
            };
            share.begin(&(angular, linear), count);
        }
    }

    /// Kinetic energy that a company gains where it turns to take up what it lacks, J.
    fn made_by_turning(&self, chief: usize) -> f64 {
        let share = &self.shares[chief];
        if share.chief != chief || share.count == share.slides {
            return 0.0;
        }
        let mut all = [0.0; 6];
        for Share { now, lever, .. } in self.shares.iter().filter(|s| s.chief == chief) {
            let spin = now.angular + lever.cross(&now.linear);
            add6(&mut all, &join(&spin, &now.linear));
        }
        let change = share.I.map(|row| dot6(&row, &share.twist));
        add_scaled6(&mut all, &change, 0.5);
        // Without what the centre of mass gains, which is known.
        let (mass, p) = (share.I[3][3], linear(&all));
        dot6(&share.twist, &all) - linear(&change).dot(&p) / mass
    }

    /// Finds the parts as they are now, who moves with whom, and by how much they lack their way.
    fn meet(&mut self, ctx: &Context, h: f64, (kin, attempt): (&mut Kinematics, &Attempt)) {
        let Self {
            list,
            shares,
            place,
        } = self;
        let (tree, company) = (ctx.tree, &attempt.company);
        pose(kin, tree, &attempt.end);
        for (index, flight) in list.iter().enumerate() {
            place[flight.kept] = index;
        }
        shares.clear();
        for (index, before) in list.iter().enumerate() {
            let now = Flight::of(tree, kin, before.kept);
            let free =
                before.linear * (h / now.inertia.mass) + ctx.tree.world.gravity * (0.5 * h * h);
            let outer = tree.kept[before.kept].outer.filter(|o| company.flies(*o));
            shares.push(Share {
                moved: free - now.lever(before),
                now,
                chief: index,
                outer: outer.map(|outer| place[outer]),
                lever: Vec3::zeros(),
                S: [[0.0; 6]; 6],
                I: [[0.0; 6]; 6],
                p: [0.0; 6],
                U: [[0.0; 6]; 6],
                L: [[0.0; 6]; 6],
                slides: tree.kept[before.kept].places().len(),
                count: 0,
                fits: true,
                turns: true,
                twist: [0.0; 6],
                change: [0.0; 6],
            });
        }
        let columns = |share: &Share| tree.kept[share.now.kept].columns();
        for index in 0..shares.len() {
            let leader = place[company.leader(shares[index].now.kept)];
            let chief = shares[leader].chief;
            if columns(&shares[index]).len() < columns(&shares[chief]).len() {
                shares[leader].chief = index;
            }
        }
        // What hangs on others comes after them.
        for index in (0..shares.len()).rev() {
            let leader = place[company.leader(shares[index].now.kept)];
            let chief = if leader == index {
                shares[index].chief
            } else {
                shares[leader].chief
            };
            let place = match shares[index].outer {
                Some(outer) => shares[outer].now.center - shares[outer].lever,
                None => {
                    (shares[chief].now.origin - shares[index].now.origin) + shares[chief].now.center
                }
            };
            let share = &mut shares[index];
            share.chief = chief;
            share.lever = share.now.center - place;
            for (S, column) in share.S.iter_mut().zip(tree.kept[share.now.kept].columns()) {
                let S0 = &kin.S[*column];
                *S = join(&angular(S0), &velocity_at(S0, &place));
            }
        }
        for index in 0..shares.len() {
            let Share {
                chief, S, slides, ..
            } = shares[index];
            let all = [columns(&shares[index]), columns(&shares[chief])].map(<[usize]>::len);
            for [own, of] in [[slides, shares[chief].slides], all] {
                let mut space = Space::NONE;
                for twist in &S[..own] {
                    space.add(twist);
                }
                let fits = |twist| space.beside(twist).is_none();
                shares[chief].fits &= shares[chief].S[..of].iter().all(fits);
            }
        }
    }
}

impl Flights {
    /// Lets all take up what they lack.
    fn take_up(&mut self) {
        let shares = &mut self.shares;
        for index in 0..shares.len() {
            let Share { chief, I, p, .. } = shares[index];
            if chief != index {
                shares[chief].add(&I, &p);
            }
        }
        for index in 0..shares.len() {
            if shares[index].chief != index {
                continue;
            }
            shares[index].factor();
            if let Some(outer) = shares[index].outer {
                let (I, p) = shares[index].given_back();
                shares[outer].add(&I, &p);
            }
        }
        for index in (0..shares.len()).rev() {
            if shares[index].chief == index {
                let carried = shares[index].outer.map(|outer| shares[outer].twist);
                shares[index].solve(&carried.unwrap_or_default());
            }
        }
        for index in 0..shares.len() {
            let chief = shares[index].chief;
            if chief != index {
                let twist = shares[chief].twist;
                shares[index].follow(&twist);
            }
        }
    }

    /// Puts what joints take up into `end`.
    fn give(&self, tree: &Tree, end: &mut Physical, places: bool) {
        for share in &self.shares {
            let part = &tree.kept[share.now.kept];
            let change = &share.change[..share.count];
            if !change.iter().all(|x| x.is_finite()) {
                continue;
            }
            if places {
                for (place, change) in part.places().iter().zip(change) {
                    end.q[*place] += change;
                }
            } else {
                for (column, change) in part.columns().iter().zip(change) {
                    end.v[tree.dof[*column]] += change;
                }
            }
        }
    }
}

/// Poses and velocities of what a robot is in.
fn pose(kin: &mut Kinematics, tree: &Tree, physical: &Physical) {
    kin.update_poses(tree, &physical.q);
    kin.update_velocities(tree, &physical.v);
}

#[cfg(test)]
crate::spoil::spoil!(Flights: list shares place;);
