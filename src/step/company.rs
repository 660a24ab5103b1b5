//! Which trees have pushed each other since the last communication point.
//!
//! What trees do to each other leaves their common momentum as it is. So trees that have pushed
//! each other, and nothing that is held, fly together: see [`super::flight`].

use crate::model::{LinkId, Model};

/// Trees, and the ground after the last of them, by who has pushed whom.
#[derive(Clone, Debug)]
pub(super) struct Company {
    /// The tree of each link; never changes.
    of_link: Vec<usize>,
    /// The first member of the company of each, after the steps that have been accepted.
    leader: Vec<usize>,
    /// The same after a try.
    tried: Vec<usize>,
    /// Which may fly.
    flies: Vec<bool>,
    /// Of which leader a member may not.
    held: Vec<bool>,
}

#[cfg(test)]
crate::spoil::spoil!(Company: leader tried flies held; of_link);

impl Company {
    /// Room for a model.
    pub fn new(model: &Model) -> Self {
        let count = model.roots.len() + 1;
        let tree = |link| model.root_of(model.links[LinkId::index(link)].body).index();
        let links = (0..model.links.len()).map(LinkId::from);
        Self {
            of_link: links.map(tree).collect(),
            leader: (0..count).collect(),
            tried: (0..count).collect(),
            flies: vec![false; count],
            held: vec![false; count],
        }
    }

    /// All are alone, and those fly that may.
    pub fn part(&mut self, may_fly: impl Fn(usize) -> bool) {
        let ground = self.leader.len() - 1;
        for (index, flies) in self.flies.iter_mut().enumerate() {
            *flies = index < ground && may_fly(index);
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
        self.join(links.map(|link| link.map(|link| self.of_link[link])));
    }

    /// The same of two trees.
    pub fn join(&mut self, trees: [Option<usize>; 2]) {
        let ground = self.tried.len() - 1;
        let [a, b] = trees.map(|tree| self.tried[tree.unwrap_or(ground)]);
        let (low, high) = (a.min(b), a.max(b));
        if low != high {
            for leader in self.tried.iter_mut().filter(|leader| **leader == high) {
                *leader = low;
            }
        }
    }

    /// Those no more fly of whose company one does not.
    pub fn ground(&mut self) {
        self.held.fill(false);
        for (leader, flies) in self.leader.iter().zip(&self.flies) {
            self.held[*leader] |= !flies;
        }
        for (leader, flies) in self.leader.iter().zip(&mut self.flies) {
            *flies &= !self.held[*leader];
        }
    }

    /// A tree does not fly.
    pub fn keep_down(&mut self, tree: usize) {
        self.flies[tree] = false;
    }

    /// Whether a tree flies.
    pub fn flies(&self, tree: usize) -> bool {
        self.flies[tree]
    }

    /// The first tree of the company of a tree.
    pub fn leader(&self, tree: usize) -> usize {
        self.leader[tree]
    }
}
