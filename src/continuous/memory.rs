//! What friction elements and velocity motors remember, as states.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Memory, Touch, light_touch};
use crate::geometry::pair::MOST_PARTS;
use crate::model::{ActuatorId, ActuatorMode, LinkId, Model};
use crate::state::Physical;
use crate::step::point::{Context, Point};
use crate::tree::{Surface, Tree};
use crate::tuning::{FRICTION_DEFLECTION, MOTOR_DEFLECTION, SLIP_NOMINAL, TURN_DEFLECTION};

/// What of a state's element is remembered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relaxing {
    /// Displacement of sliding and drilling friction, m: the first of three states.
    Slip,
    /// Angle of friction against turning, rad: the first of three states.
    Turn,
    /// Displacement of a velocity motor, rad or m.
    Motor(ActuatorId),
    /// Displacement of dry friction of a degree of freedom, rad or m.
    Dry(usize),
}

/// One element.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// What it is.
    pub what: Relaxing,
    /// Its first state.
    pub first: usize,
    /// The links of a contact, none for the ground, and its number among those of the same links,
    /// from 0; of the same for friction against turning.
    pub links: [Option<LinkId>; 2],
    /// See `links`.
    pub number: u32,
    /// Place of a contact in the memory.
    slot: usize,
    /// Places of its shapes in the tree's list; twice the same for the ground.
    places: [usize; 2],
}

impl Element {
    /// How many states it has.
    #[expect(clippy::len_without_is_empty, reason = "there is always one")]
    pub fn len(&self) -> usize {
        match self.what {
            Relaxing::Slip | Relaxing::Turn => 3,
            Relaxing::Motor(_) | Relaxing::Dry(_) => 1,
        }
    }
}

/// All elements that remember something: contacts by ascending slot, motors, joints.
#[derive(Clone, Debug)]
pub struct Remembered {
    elements: Vec<Element>,
    /// How many of them are of contacts.
    contacts: usize,
    /// The first state.
    first: usize,
}

impl Remembered {
    /// None.
    pub fn none() -> Self {
        Self {
            elements: Vec::new(),
            contacts: 0,
            first: 0,
        }
    }

    /// Those of a model, whose states begin at `first`.
    pub fn new(model: &Model, tree: &Tree, first: usize) -> Self {
        let mut all = Self {
            first,
            ..Self::none()
        };
        let contact = &tree.contact;
        let mut slots: Vec<(usize, [usize; 2])> = Vec::new();
        for (place, collider) in contact.colliders.iter().enumerate() {
            if collider.moves && contact.has_ground {
                slots.push((collider.index, [place; 2]));
            }
        }
        let shapes = contact.colliders.len();
        for a in 0..shapes {
            for b in (a + 1..shapes).filter(|b| contact.may_touch([a, *b])) {
                let is_terrain = |place: usize| {
                    let solid = contact.colliders[place].solid.as_ref();
                    solid.is_some_and(|solid| solid.is_terrain())
                };
                let parts = if is_terrain(a) || is_terrain(b) {
                    MOST_PARTS
                } else {
                    1
                };
                let first = contact.slot([a, b]);
                slots.extend((first..first + parts).map(|slot| (slot, [a, b])));
            }
        }
        slots.sort_unstable();
        for (slot, places) in slots {
            let links = model.links_of(slot);
            let same = |e: &&Element| e.links == links && e.what == Relaxing::Slip;
            let number = u32::try_from(all.elements.iter().filter(same).count());
            let number = number.unwrap_or(u32::MAX);
            let turns = surface(tree, places).resists_turning();
            let kinds = if turns {
                &[Relaxing::Slip, Relaxing::Turn][..]
            } else {
                &[Relaxing::Slip]
            };
            for what in kinds {
                all.add(*what, (links, number), (slot, places));
            }
        }
        all.contacts = all.elements.len();
        for (id, actuator) in (0..).map(ActuatorId).zip(&model.actuators) {
            if actuator.mode == ActuatorMode::Velocity {
                all.add(Relaxing::Motor(id), ([None; 2], 0), (0, [0; 2]));
            }
        }
        for (dof, friction) in tree.dofs.friction.iter().enumerate() {
            if friction.moving > 0.0 {
                all.add(Relaxing::Dry(dof), ([None; 2], 0), (0, [0; 2]));
            }
        }
        all
    }

    fn add(
        &mut self,
        what: Relaxing,
        (links, number): ([Option<LinkId>; 2], u32),
        (slot, places): (usize, [usize; 2]),
    ) {
        let last = self.elements.last();
        let first = last.map_or(self.first, |last| last.first + last.len());
        self.elements.push(Element {
            what,
            first,
            links,
            number,
            slot,
            places,
        });
    }

    /// Each of them.
    pub fn iter(&self) -> impl Iterator<Item = &Element> + '_ {
        self.elements.iter()
    }

    /// Whether the dry friction of a degree of freedom is among them.
    pub fn has_dry(&self, dof: usize) -> bool {
        self.elements.iter().any(|e| e.what == Relaxing::Dry(dof))
    }

    /// Size of the values to expect of each state.
    pub fn nominals<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = f64> + 'a {
        self.elements.iter().flat_map(|element| {
            let nominal = match element.what {
                Relaxing::Slip => SLIP_NOMINAL * model.contact.penetration,
                Relaxing::Turn => TURN_DEFLECTION,
                Relaxing::Motor(_) => MOTOR_DEFLECTION,
                Relaxing::Dry(_) => FRICTION_DEFLECTION,
            };
            std::iter::repeat_n(nominal, element.len())
        })
    }

    /// Value of a state.
    pub fn value(&self, index: usize, memory: &Memory) -> f64 {
        let at = self.elements.partition_point(|e| e.first <= index) - 1;
        let element = &self.elements[at];
        let axis = index - element.first;
        let touch = || {
            let touches = &memory.touches;
            let found = touches.binary_search_by_key(&element.slot, |touch| touch.slot);
            found.ok().map(|place| &touches[place])
        };
        match element.what {
            Relaxing::Slip => touch().map_or(0.0, |touch| touch.displacement[axis]),
            Relaxing::Turn => touch().map_or(0.0, |touch| touch.turn[axis]),
            Relaxing::Motor(id) => memory.motor[id.index()],
            Relaxing::Dry(dof) => memory.dry[dof],
        }
    }

    /// Sets all values, from the list of all states. What remembers nothing is not listed.
    pub fn write(&self, x: &[f64], memory: &mut Memory) {
        memory.touches.clear();
        let (touching, joints) = self.elements.split_at(self.contacts);
        let (threes, ones) = x
            .get(self.first..)
            .unwrap_or_default()
            .split_at(3 * touching.len());
        for (element, vector) in touching.iter().zip(threes.as_chunks::<3>().0) {
            if vector.iter().all(|x| x.abs() == 0.0) {
                continue;
            }
            let slot = element.slot;
            if memory.touches.last().is_none_or(|last| last.slot != slot) {
                memory.touches.push(Touch {
                    slot,
                    ..Touch::default()
                });
            }
            if let Some(touch) = memory.touches.last_mut() {
                match element.what {
                    Relaxing::Turn => touch.turn = *vector,
                    _ => touch.displacement = *vector,
                }
            }
        }
        for (element, value) in joints.iter().zip(ones) {
            match element.what {
                Relaxing::Motor(id) => memory.motor[id.index()] = *value,
                Relaxing::Dry(dof) => memory.dry[dof] = *value,
                Relaxing::Slip | Relaxing::Turn => {}
            }
        }
    }

    /// Sets their rates in the list of those of all states.
    pub fn rates(&self, ctx: &Context, point: &Point, at: &Physical, out: &mut [f64]) {
        let (tree, memory) = (ctx.tree, &at.memory);
        let Point { kin, terms, .. } = point;
        let mut contacts = terms.contacts.iter().peekable();
        let mut turns = terms.turns.iter().peekable();
        let mut touches = memory.touches.iter().peekable();
        let (touching, joints) = self.elements.split_at(self.contacts);
        for element in touching {
            while contacts.next_if(|c| c.slot < element.slot).is_some() {}
            while turns.next_if(|t| t.slot < element.slot).is_some() {}
            while touches.next_if(|t| t.slot < element.slot).is_some() {}
            let contact = contacts.peek().filter(|c| c.slot == element.slot);
            let turn = turns.peek().filter(|t| t.slot == element.slot);
            let rate = match (element.what, contact, turn) {
                (Relaxing::Slip, Some(contact), _) => contact.memory_rate(&kin.V),
                (_, Some(contact), Some(turn)) => contact.keep(&turn.memory_rate(&kin.V)),
                // Nothing touches: all goes that is left.
                _ => {
                    let touch = touches.peek().filter(|t| t.slot == element.slot);
                    let (stored, rate) = match (touch, element.what) {
                        (None, _) => ([0.0; 3], 0.0),
                        (Some(touch), Relaxing::Slip) => {
                            (touch.displacement, light_touch(tree, element.places))
                        }
                        (Some(touch), _) => (touch.turn, idle_turn(tree, element.places)),
                    };
                    stored.map(|x| -rate * x)
                }
            };
            out[element.first..element.first + 3].copy_from_slice(&rate);
        }
        for element in joints {
            out[element.first] = match element.what {
                Relaxing::Motor(id) => {
                    let dof = ctx.model.actuators[id.index()].dof.index();
                    let motor = tree.actuators.motors[id.index()];
                    let stored = memory.motor[id.index()];
                    let term = terms.along(dof);
                    term.map_or(0.0, |term| term.motor_rate(motor, stored, at.v[dof]))
                }
                Relaxing::Dry(dof) => {
                    let term = terms.along(dof);
                    term.map_or(0.0, |term| term.dry.rate(at.v[dof]))
                }
                Relaxing::Slip | Relaxing::Turn => 0.0,
            };
        }
    }
}

/// How fast friction against turning forgets where nothing touches, 1/s.
fn idle_turn(tree: &Tree, places: [usize; 2]) -> f64 {
    let contact = &tree.contact;
    let [a, b] = places.map(|place| &contact.colliders[place]);
    let (own, other) = if a.yields { (a, b) } else { (b, a) };
    let other = (places[0] != places[1] && other.yields).then_some(other.link);
    let turning = contact.turning_of(own.link, other);
    turning.forgets(surface(tree, places).turning)
}

/// What the surfaces of the shapes at two places have together, or that at one and the ground's.
fn surface(tree: &Tree, [a, b]: [usize; 2]) -> Surface {
    let [first, second] = [a, b].map(|place| &tree.contact.colliders[place]);
    if a == b {
        first.ground
    } else {
        tree.contact.surface_of([first, second])
    }
}
