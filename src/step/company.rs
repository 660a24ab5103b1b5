//! Who has pushed whom since the last communication point.
//!
//! What bodies do to each other leaves their common momentum as it is. So those that move freely
//! (see [`Kept`](crate::tree::Kept)), have pushed each other and nothing that is held fly together:
//! see [`super::flight`].

use crate::force::Terms;
use crate::model::{LinkId, Model};
use crate::step::convex::Newton;
use crate::tree::Tree;

/// What moves freely, and after the last of them all the rest, by who has pushed whom.
#[derive(Clone, Debug)]
pub(super) struct Company {
    /// The body of each link; never changes.
    body: Vec<usize>,
    /// The innermost that moves each link, and by whose joints each degree of freedom moves.
    of_link: Vec<usize>,
    of_dof: Vec<usize>,
    /// The first member of the company of each, after the steps that have been accepted.
    leader: Vec<usize>,
    /// The same after a try.
    tried: Vec<usize>,
    /// Which may fly.
    flies: Vec<bool>,
    /// How many members a leader has, and whether one of them may not fly.
    members: Vec<usize>,
    held: Vec<bool>,
}

#[cfg(test)]
crate::spoil::spoil!(Company: leader tried flies members held; body of_link of_dof);

impl Company {
    /// Room for a model.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let count = model.bodies.len() + 1;
        let body = |link| model.links[LinkId::index(link)].body.index();
        let links = (0..model.links.len()).map(LinkId::from);
        let mut company = Self {
            body: links.map(body).collect(),
            of_link: vec![count - 1; model.links.len()],
            of_dof: vec![count - 1; model.nv()],
            leader: (0..count).collect(),
            tried: (0..count).collect(),
            flies: vec![false; count],
            members: vec![1; count],
            held: vec![false; count],
        };
        company.meet(tree);
        company
    }

    /// Notes what moves freely.
    pub fn meet(&mut self, tree: &Tree) {
        let rest = self.leader.len() - 1;
        for (of, body) in self.of_link.iter_mut().zip(&self.body) {
            *of = tree.carrier[*body].unwrap_or(rest);
        }
        self.of_dof.fill(rest);
        for (index, kept) in tree.kept.iter().enumerate() {
            for column in kept.columns() {
                self.of_dof[tree.dof[*column]] = index;
            }
        }
    }

    /// All are alone, and those fly that may.
    pub fn part(&mut self, may_fly: impl Fn(usize) -> bool) {
        let rest = self.leader.len() - 1;
        for (index, flies) in self.flies.iter_mut().enumerate() {
            *flies = index < rest && may_fly(index);
        }
        self.separate();
    }

    /// All are alone again; those fly that do.
    pub fn separate(&mut self) {
        for (index, leader) in self.leader.iter_mut().enumerate() {
            *leader = index;
        }
        self.begin();
    }

    /// Begins a try.
    pub fn begin(&mut self) {
        self.tried.copy_from_slice(&self.leader);
    }

    /// Takes what the try has found.
    pub fn accept(&mut self) {
        std::mem::swap(&mut self.leader, &mut self.tried);
    }

    /// Notes in a try that two links have pushed each other; none: the ground.
    pub fn join_links(&mut self, links: [Option<usize>; 2]) {
        let rest = self.leader.len() - 1;
        self.join(links.map(|link| link.map_or(rest, |link| self.of_link[link])));
    }

    /// Notes in a try all that springs pull.
    pub fn join_springs(&mut self, tree: &Tree) {
        let rest = self.leader.len() - 1;
        let carrier = |body: usize| tree.carrier[body].unwrap_or(rest);
        for spring in &tree.springs {
            let [a, b] = spring.ends.each_ref();
            self.join([a, b].map(|end| end.body.map_or(rest, carrier)));
        }
    }

    /// Notes in a try which limits have pushed.
    pub fn join_limits(&mut self, terms: &Terms, solved: &Newton) {
        let rest = self.leader.len() - 1;
        for (term, response) in terms.joints.iter().zip(&solved.responses.joints) {
            let moves = self.of_dof[term.dof];
            if moves < rest && response.impulse != 0.0 {
                self.join([moves, rest]);
            }
        }
    }

    fn join(&mut self, pushed: [usize; 2]) {
        let [a, b] = pushed.map(|index| self.tried[index]);
        let (low, high) = (a.min(b), a.max(b));
        if low != high {
            for leader in self.tried.iter_mut().filter(|leader| **leader == high) {
                *leader = low;
            }
        }
    }

    /// Those no more fly of whose company one does not. What moves on others flies alone or not at
    /// all, and what it pushes these push, too.
    pub fn ground(&mut self, tree: &Tree) {
        self.members.fill(0);
        for leader in &self.leader {
            self.members[*leader] += 1;
        }
        for (index, kept) in tree.kept.iter().enumerate() {
            if kept.inner || kept.outer.is_some() {
                self.flies[index] &= self.members[self.leader[index]] == 1;
            }
            if let Some(outer) = kept.outer {
                self.flies[outer] &= self.flies[index];
            }
        }
        self.held.fill(false);
        for (leader, flies) in self.leader.iter().zip(&self.flies) {
            self.held[*leader] |= !flies;
        }
        for (leader, flies) in self.leader.iter().zip(&mut self.flies) {
            *flies &= !self.held[*leader];
        }
    }

    /// One does not fly.
    pub fn keep_down(&mut self, index: usize) {
        self.flies[index] = false;
    }

    /// Whether one flies.
    pub fn flies(&self, index: usize) -> bool {
        self.flies[index]
    }

    /// The first member of the company of one.
    pub fn leader(&self, index: usize) -> usize {
        self.leader[index]
    }
}
