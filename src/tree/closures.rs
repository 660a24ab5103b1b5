//! Loops and springs: from the model to the form of the solver.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::closure::{Closure, ClosureKind, End, TreeSpring};
use super::parts::Tree;
use super::within;
use crate::model::{Anchor, Body, LoopKind, Model};
use crate::spatial::Pose;

impl Tree {
    /// Fills closures and springs; bodies are there.
    ///
    /// - `frames`: pose of each solver frame in the model's body frame
    pub(super) fn add_closures(&mut self, model: &Model, frames: &[Pose]) {
        let end = |anchor: &Anchor| {
            let Some(link) = anchor.link else {
                return End {
                    body: None,
                    X: anchor.X_LA,
                };
            };
            let link = &model.links[link.index()];
            let body = link.body.index();
            let X_SL = within(&frames[body], &link.X_BL);
            End {
                body: Some(body),
                X: X_SL.compose(&anchor.X_LA),
            }
        };
        let nowhere = End {
            body: None,
            X: Pose::IDENTITY,
        };
        for closure in &model.loops {
            let ends = closure.kind.ends();
            let ends = ends.map_or([nowhere; 2], |ends| ends.each_ref().map(end));
            let kind = match &closure.kind {
                LoopKind::Weld(_) => ClosureKind::Weld,
                LoopKind::Ball(_) => ClosureKind::Ball,
                LoopKind::Hinge(_) => ClosureKind::Hinge,
                LoopKind::Distance { length, .. } => ClosureKind::Distance(*length),
                LoopKind::Coupler { terms, sum } => {
                    let bodies = terms.iter().filter_map(|term| {
                        let body = model.scalar_body(term.joint)?;
                        Some((&model.bodies[body.index()], term.factor))
                    });
                    self.couple(&bodies.collect::<Vec<_>>(), *sum);
                    continue;
                }
            };
            let columns = self.columns_between(&ends);
            let mut dofs: Vec<usize> = columns.iter().flatten().map(|c| self.dof[*c]).collect();
            dofs.sort_unstable();
            dofs.dedup();
            let place = |column: usize| (column, place_of(&dofs, self.dof[column]));
            self.closures.push(Closure {
                kind,
                ends,
                columns: columns.map(|list| list.into_iter().map(place).collect()),
                trees: self.trees_of(ends.map(|end| Some(self.bodies[end.body?].tree))),
                first: self.closures.iter().map(|c| c.kind.rows()).sum(),
                parts: Vec::new(),
                beside: Vec::new(),
                rank: 0,
                dofs,
            });
        }
        for (index, spring) in model.springs.iter().enumerate() {
            let [a, b] = spring.ends.each_ref().map(end);
            let moves = |end: &End| end.body.is_some_and(|body| self.bodies[body].kind.moves());
            let reversed = !moves(&a);
            self.springs.push(TreeSpring {
                index,
                ends: if reversed { [b, a] } else { [a, b] },
                reversed,
                length: spring.length,
                stiffness: spring.stiffness,
                damping: spring.damping,
            });
        }
        self.tie();
        self.join_masses();
    }

    /// Notes which trees hang on others, or on the world, not by their bases alone.
    fn tie(&mut self) {
        let mut tied = vec![false; self.trees.len()];
        let springs = self.springs.iter().map(|spring| &spring.ends);
        let springs = springs.map(|ends| ends.map(|end| Some(self.bodies[end.body?].tree)));
        let of_springs = springs.map(|trees| self.trees_of(trees));
        let closures = self.closures.iter().map(|closure| closure.trees);
        for trees in closures.chain(of_springs) {
            if trees[0] != trees[1] {
                for tree in trees.into_iter().flatten() {
                    tied[tree] = true;
                }
            }
        }
        for (tree, tied) in self.trees.iter_mut().zip(tied) {
            tree.tied = tied;
        }
        for dof in self.closures.iter().flat_map(|closure| &closure.dofs) {
            for tree in self.trees.iter_mut().filter(|t| t.dofs.contains(dof)) {
                tree.closed = true;
            }
        }
    }

    /// Finds the masses that loops join, which ends of closures do and couplers do not. What is
    /// driven gives way to nothing, and joins what hangs on it as little as the world does.
    fn join_masses(&mut self) {
        let mut leader: Vec<usize> = (0..self.trees.len()).collect();
        for closure in &self.closures {
            let gives_way = |body: &usize| !self.is_driven(*body);
            let ends = closure.ends.map(|end| end.body.filter(gives_way));
            let ends = ends.map(|body| Some(self.bodies[body?].tree));
            join(ends, &mut leader);
        }
        let mut sums = vec![0.0; self.trees.len()];
        for (tree, leader) in self.trees.iter().zip(&leader) {
            sums[*leader] += tree.moving_mass;
        }
        for (tree, leader) in self.trees.iter_mut().zip(&leader) {
            tree.joined_mass = sums[*leader];
        }
    }

    /// Adds a coupler of joints, which `bodies` move.
    fn couple(&mut self, bodies: &[(&Body, f64)], sum: Option<f64>) {
        let mut dofs: Vec<usize> = bodies.iter().map(|(body, _)| body.dof.index()).collect();
        dofs.sort_unstable();
        dofs.dedup();
        // A mimic joint is at `ratio · q + offset`.
        let offset: f64 = bodies.iter().map(|(body, f)| f * body.offset).sum();
        let terms = bodies.iter().map(|(body, factor)| {
            let place = place_of(&dofs, body.dof.index());
            (body.coordinate, place, factor * body.ratio)
        });
        let terms: Vec<_> = terms.collect();
        let tree = |dof: &usize| self.trees.iter().position(|tree| tree.dofs.contains(dof));
        let trees: Vec<usize> = dofs.iter().filter_map(tree).collect();
        self.closures.push(Closure {
            kind: ClosureKind::Coupler {
                terms,
                sum: sum.unwrap_or_default() - offset,
                meshes: sum.is_none(),
            },
            ends: [End {
                body: None,
                X: Pose::IDENTITY,
            }; 2],
            columns: [Vec::new(), Vec::new()],
            trees: [trees.first().copied(), trees.last().copied()],
            first: self.closures.iter().map(|c| c.kind.rows()).sum(),
            parts: Vec::new(),
            beside: Vec::new(),
            rank: 0,
            dofs,
        });
    }

    /// Sets what couplers hold that has not been given: the sum at the positions `q`.
    pub fn mesh(&mut self, q: &[f64]) {
        for closure in &mut self.closures {
            if let ClosureKind::Coupler {
                terms,
                sum,
                meshes: true,
            } = &mut closure.kind
            {
                *sum = terms.iter().map(|(c, _, factor)| factor * q[*c]).sum();
            }
        }
    }

    /// Those of two trees that move.
    fn trees_of(&self, trees: [Option<usize>; 2]) -> [Option<usize>; 2] {
        trees.map(|tree| tree.filter(|tree| self.trees[*tree].moves()))
    }

    /// Columns that move one end and not the other one.
    fn columns_between(&self, ends: &[End; 2]) -> [Vec<usize>; 2] {
        let [a, b] = ends.map(|end| {
            let columns = end.body.map(|body| self.columns_to(body));
            columns.into_iter().flatten().collect::<Vec<usize>>()
        });
        let without = |own: &[usize], other: &[usize]| {
            let mut own: Vec<usize> = own.iter().copied().filter(|c| !other.contains(c)).collect();
            own.sort_unstable();
            own
        };
        [without(&a, &b), without(&b, &a)]
    }

    /// The closures that a step works on, with their indices, in the order of their rows.
    pub fn worked_closures(&self) -> impl Iterator<Item = (usize, &Closure)> + '_ {
        let takes = |closure: &Closure| {
            let mut trees = closure.trees.iter().flatten();
            trees.next().is_some_and(|tree| self.takes(*tree))
        };
        let order = self.closure_order.iter();
        let closures = order.map(|index| (*index, &self.closures[*index]));
        closures.filter(move |(_, closure)| takes(closure))
    }

    /// The springs that a step works on, with their indices.
    pub fn worked_springs(&self) -> impl Iterator<Item = (usize, &TreeSpring)> + '_ {
        let takes = |end: &End| end.body.is_some_and(|b| self.takes(self.bodies[b].tree));
        let springs = self.springs.iter().enumerate();
        springs.filter(move |(_, spring)| takes(&spring.ends[0]))
    }

    /// Whether bodies of two trees, or of one beyond its own pattern, are coupled in the matrix of
    /// a step.
    pub fn has_cross_terms(&self) -> bool {
        !self.contact.pairs.is_empty() || !self.springs.is_empty()
    }

    /// Joins the trees that closures and springs join.
    ///
    /// - `leader`: the first tree of the group of each tree
    pub fn join_closed(&self, leader: &mut [usize]) {
        let of_spring =
            |ends: &[End; 2]| self.trees_of(ends.map(|end| Some(self.bodies[end.body?].tree)));
        let springs = self.springs.iter().map(|spring| of_spring(&spring.ends));
        let closures = self.closures.iter().flat_map(|closure| {
            // A coupler may join more than two.
            let first = closure.trees[0];
            let tree = |dof: &usize| self.trees.iter().position(|tree| tree.dofs.contains(dof));
            closure.dofs.iter().map(move |dof| [first, tree(dof)])
        });
        for trees in springs.chain(closures) {
            join(trees, leader);
        }
    }

    /// Whether two bodies are joined as at a joint.
    pub(super) fn is_closed_between(&self, bodies: [usize; 2]) -> bool {
        self.closures.iter().any(|closure| {
            let joint = !matches!(closure.kind, ClosureKind::Distance(_));
            let own = closure.ends.map(|end| end.body);
            let [a, b] = bodies.map(Some);
            joint && (own == [a, b] || own == [b, a])
        })
    }
}

/// Joins the groups of two trees, if both are there.
///
/// - `leader`: the first tree of the group of each tree
fn join(trees: [Option<usize>; 2], leader: &mut [usize]) {
    let [Some(a), Some(b)] = trees else { return };
    let (a, b) = (leader[a], leader[b]);
    for leader in leader.iter_mut().filter(|leader| **leader == a.max(b)) {
        *leader = a.min(b);
    }
}

/// Place of a number in an ascending list that holds it.
fn place_of(list: &[usize], number: usize) -> usize {
    list.partition_point(|other| *other < number)
}
