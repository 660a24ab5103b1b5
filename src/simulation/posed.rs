//! The values of outputs where the importer integrates.

use crate::continuous::Events;
use crate::model::Model;
use crate::state::State;
use crate::step::point::Context;
use crate::tree::Tree;

/// The state as outputs show it: an integrator's quaternions are not of unit length.
#[derive(Clone, Debug)]
pub(super) struct Posed {
    pub state: State,
    /// Whether it is that of the simulation.
    pub known: bool,
    /// Derivatives of all continuous states, and whether they are those of the state.
    pub rates: Vec<f64>,
    /// See `rates`.
    pub derived: bool,
    /// Events that the outside is told of.
    pub events: Events,
}

/// The state that outputs show, where it is not that of the simulation.
#[inline]
pub(super) fn seen<'a>(
    posed: &'a mut Option<Box<Posed>>,
    ctx: &Context,
    state: &State,
) -> Option<&'a mut Posed> {
    let posed = posed.as_deref_mut()?;
    if !posed.known {
        posed.state.copy_from(state);
        ctx.tree.normalize(&mut posed.state.physical.q);
        posed.known = true;
        posed.derived = false;
    }
    Some(posed)
}

impl Posed {
    /// One of nothing yet.
    pub fn new(model: &Model, tree: &Tree, states: usize) -> Self {
        Self {
            state: State::new(model),
            known: false,
            rates: vec![0.0; states],
            derived: false,
            events: Events::new(tree, model.contact_room()[0]),
        }
    }
}
