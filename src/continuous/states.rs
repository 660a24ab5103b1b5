//! Which states there are, and where their values stand.

use super::memory::Remembered;
use crate::model::{BodyId, JointId, Model, RootId};
use crate::slots::OutputSlot;
use crate::spatial::Vec3;
use crate::state::Physical;
use crate::tree::{BaseFrame, Tree};

/// A continuous state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Where its value stands.
    pub place: Place,
    /// The output that it is, if it is one.
    pub output: Option<OutputSlot>,
    /// Size of the values to expect, in its unit.
    pub nominal: f64,
}

/// Where the value of a state stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A place in `q`.
    Position(usize),
    /// A place in `v`.
    Velocity(usize),
    /// What friction or a motor remembers, see [`States::memory`].
    Memory,
}

/// An orientation among the states.
#[derive(Clone, Copy, Debug)]
pub struct Quaternion {
    /// The first of its states x, y, z, w.
    pub first: usize,
    /// Their places in `q`.
    pub places: [usize; 4],
}

/// A floating base whose link's origin is apart from the solver's frame.
#[derive(Clone, Copy, Debug)]
struct Carried {
    frame: BaseFrame,
    /// The first of its states of position and of linear velocity.
    first: [usize; 2],
}

/// All states of a model, in FMI's order: positions, velocities, memory.
#[derive(Clone, Debug)]
pub struct States {
    list: Vec<State>,
    /// Where those stand in `q` and in `v` that stand there, in their order; together they come
    /// before all that is remembered.
    places: [Vec<usize>; 2],
    quaternions: Vec<Quaternion>,
    /// Floating bases whose states are not those of the solver's frame.
    bases: Vec<Carried>,
    /// What force elements remember.
    pub memory: Remembered,
}

impl States {
    /// Those of a model without Model Exchange.
    pub fn none() -> Self {
        Self {
            list: Vec::new(),
            places: [Vec::new(), Vec::new()],
            quaternions: Vec::new(),
            bases: Vec::new(),
            memory: Remembered::none(),
        }
    }

    /// Those of a model that can be exchanged, else none.
    ///
    /// - `tree`: that of the model's own parameters
    #[cfg_attr(small, optimize(size))]
    pub fn of(model: &Model, tree: &Tree) -> Self {
        if model.outputs.interface.exchanges() {
            Self::new(model, tree)
        } else {
            Self::none()
        }
    }

    /// Those of a model, whatever its interfaces.
    ///
    /// - `tree`: that of the model's own parameters
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let mut states = Self::none();
        let roots = (0..).map(RootId).zip(&model.roots);
        let floating: Vec<(RootId, BodyId)> = roots
            .filter(|(id, _)| model.floats(*id))
            .map(|(id, root)| (id, root.body))
            .collect();
        let is_base = |body: &BodyId| floating.iter().any(|(_, base)| base == body);
        for &(id, body) in &floating {
            let first = model.bodies[body.index()].coordinate;
            let frame = tree.base_frame(id);
            if let Some(frame) = frame.filter(|frame| frame.center != Vec3::zeros()) {
                let first = [states.list.len(), 0];
                states.bases.push(Carried { frame, first });
            }
            for axis in 0..3 {
                let place = Place::Position(first + usize::from(axis));
                states.add(place, OutputSlot::BasePosition(id, axis));
            }
            states.add_quaternion(first + 3, |axis| OutputSlot::BaseOrientation(id, axis));
        }
        let joints = || (0..).map(JointId).zip(&model.joints);
        for (id, joint) in joints().filter(|(_, joint)| joint.mimic.is_none()) {
            for (axis, at) in (0..).zip(joint.bodies.iter().filter(|body| !is_base(body))) {
                let body = &model.bodies[at.index()];
                match body.motion.kind().quaternion() {
                    Some(first) => {
                        states.add_quaternion(body.coordinate + first, |axis| {
                            OutputSlot::JointOrientation(id, axis)
                        });
                    }
                    None if body.motion.kind().moves() => {
                        let place = Place::Position(body.coordinate);
                        states.add(place, OutputSlot::JointPosition(id, axis));
                    }
                    None => {}
                }
            }
        }
        for &(id, body) in &floating {
            let first = model.bodies[body.index()].dof.index();
            let at = states.list.len();
            let mut bases = states.bases.iter_mut();
            if let Some(base) = bases.find(|base| base.frame.dof == first) {
                base.first[1] = at;
            }
            for axis in 0..3 {
                let place = Place::Velocity(first + 3 + usize::from(axis));
                states.add(place, OutputSlot::BaseLinearVelocity(id, axis));
            }
            for axis in 0..3 {
                let place = Place::Velocity(first + usize::from(axis));
                states.add(place, OutputSlot::BaseAngularVelocity(id, axis));
            }
        }
        for (id, joint) in joints().filter(|(_, joint)| joint.mimic.is_none()) {
            let mut axis = 0;
            for at in joint.bodies.iter().filter(|body| !is_base(body)) {
                let body = &model.bodies[at.index()];
                for own in 0..body.motion.nv() {
                    let place = Place::Velocity(body.dof.index() + own);
                    states.add(place, OutputSlot::JointVelocity(id, axis));
                    axis += 1;
                }
            }
        }
        let first = states.list.len();
        states.memory = Remembered::new(model, tree, first);
        let nominals = states.memory.nominals(model);
        states.list.extend(nominals.map(|nominal| State {
            place: Place::Memory,
            output: None,
            nominal,
        }));
        states
    }

    fn add(&mut self, place: Place, output: OutputSlot) {
        // Importers scale their tolerance with it. A centimetre of height decides whether
        // something touches.
        let nominal = match output {
            OutputSlot::BasePosition(_, 2) => 0.01,
            _ => 1.0,
        };
        match place {
            Place::Position(coordinate) => self.places[0].push(coordinate),
            Place::Velocity(dof) => self.places[1].push(dof),
            Place::Memory => {}
        }
        self.list.push(State {
            place,
            output: Some(output),
            nominal,
        });
    }

    /// States x, y, z, w of a quaternion whose w stands at `w` in `q`, and the others after it.
    fn add_quaternion(&mut self, w: usize, output: impl Fn(u8) -> OutputSlot) {
        let places = [w + 1, w + 2, w + 3, w];
        let first = self.list.len();
        self.quaternions.push(Quaternion { first, places });
        for (axis, place) in (0..).zip(places) {
            self.add(Place::Position(place), output(axis));
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Each of them.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &State> + '_ {
        self.list.iter()
    }

    /// The orientations among them.
    pub fn quaternions(&self) -> impl Iterator<Item = &Quaternion> + '_ {
        self.quaternions.iter()
    }

    /// The value of one of them.
    pub fn value(&self, index: usize, at: &Physical) -> f64 {
        for base in &self.bases {
            let [position, velocity] = base.first.map(|first| index.wrapping_sub(first));
            if position < 3 {
                return base.frame.position(&at.q)[position];
            }
            if velocity < 3 {
                return base.frame.velocity(&at.q, &at.v)[velocity];
            }
        }
        match self.list[index].place {
            Place::Position(coordinate) => at.q[coordinate],
            Place::Velocity(dof) => at.v[dof],
            Place::Memory => self.memory.value(index, &at.memory),
        }
    }

    /// Reads all values.
    pub fn read(&self, at: &Physical, x: &mut [f64]) {
        for (index, x) in x.iter_mut().enumerate() {
            *x = self.value(index, at);
        }
    }

    /// Sets all values.
    pub fn write(&self, x: &[f64], to: &mut Physical) {
        let [positions, velocities] = &self.places;
        let (of_q, rest) = x.split_at(positions.len().min(x.len()));
        for (coordinate, x) in positions.iter().zip(of_q) {
            to.q[*coordinate] = *x;
        }
        for (dof, x) in velocities.iter().zip(rest) {
            to.v[*dof] = *x;
        }
        for base in &self.bases {
            base.frame.take_link(&mut to.q, &mut to.v);
        }
        self.memory.write(x, &mut to.memory);
    }

    /// Puts the rates of link's origins in place of those of the solver's frames.
    pub(super) fn carry_rates(&self, at: &Physical, vdot: &[f64], out: &mut [f64]) {
        for Carried { frame, first } in &self.bases {
            let velocity = frame.velocity(&at.q, &at.v);
            let acceleration = frame.acceleration(&at.q, &at.v, vdot);
            out[first[0]..first[0] + 3].copy_from_slice(velocity.as_slice());
            out[first[1]..first[1] + 3].copy_from_slice(acceleration.as_slice());
        }
    }

    /// Picks what belongs to each state that stands in `q` or `v` out of such lists.
    ///
    /// - `out`: one a state; those of what is remembered stay
    pub(super) fn pick(&self, of_q: &[f64], of_v: &[f64], out: &mut [f64]) {
        let [positions, velocities] = &self.places;
        let (first, rest) = out.split_at_mut(positions.len().min(out.len()));
        for (coordinate, x) in positions.iter().zip(first) {
            *x = of_q[*coordinate];
        }
        for (dof, x) in velocities.iter().zip(rest) {
            *x = of_v[*dof];
        }
    }
}
