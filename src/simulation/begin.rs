//! The initial state, and what follows from it.

use super::Simulation;
use crate::dynamics::crba;
use crate::initial::{self, initial_state};
use crate::kinematics::Kinematics;
use crate::model::{ActuatorId, ActuatorMode};
use crate::slots::ParameterSlot;

/// Way by which closing loops moves joints that stay where they are, rad or m: round-off.
const CLOSED: f64 = 1e-12;

impl Simulation {
    /// Sets the time at which the simulation is to begin, s, before [`Self::initialize`]: time
    /// stands there from now on.
    pub fn set_start(&mut self, start: f64) {
        self.start = start;
        self.state.time = start;
        // What the initial state knows of the time follows from it.
        self.stale = true;
        self.forget();
    }

    /// The link that is deepest in the ground, how deep, m, and with how many weights its contact
    /// pushes there, of those that are deeper than their contacts carry the weight at rest, be they
    /// as soft as a user likes; none where none is.
    #[cfg_attr(small, optimize(size))]
    pub fn deepest_in_ground(&self) -> Option<(&str, [f64; 2])> {
        self.model.world.ground.as_ref()?;
        let mut kin = Kinematics::new(&self.tree);
        kin.update_poses(&self.tree, &self.state.physical.q);
        let deep = initial::in_ground(&self.model, (&self.tree, &kin));
        let (deepest, depth) = deep.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let push = deepest.spring.weights(depth);
        Some((&self.model.links[deepest.link].name, [depth, push]))
    }

    /// Two joints of a group whose common position nobody has set, and where both begin, rad or m:
    /// the first, which the command follows, and one that begins elsewhere, so that its servo is to
    /// move it over. None once the simulation runs.
    #[cfg_attr(small, optimize(size))]
    pub fn apart_in_group(&mut self) -> Option<[(&str, f64); 2]> {
        if self.stale {
            self.place();
        }
        let (model, q) = (&self.model, &self.state.physical.q);
        let begins = |a: &ActuatorId| {
            let joint = model.actuators[a.index()].joint;
            let body = model.scalar_body(joint)?;
            let position = q[model.bodies[body.index()].coordinate];
            Some((model.joints[joint.index()].name.as_str(), position))
        };
        let held = |a: &&ActuatorId| {
            let mode = model.actuators[a.index()].mode;
            let holds = matches!(mode, ActuatorMode::Position | ActuatorMode::Pd);
            holds && !self.initialized && self.inputs.given[a.index()] == 0.0
        };
        model.outputs.groups.iter().find_map(|group| {
            let first = begins(group.actuators.first().filter(held)?)?;
            let mut others = group.actuators.iter().filter_map(begins);
            let other = others.find(|other| (other.1 - first.1).abs() > CLOSED)?;
            Some([first, other])
        })
    }

    /// Derives everything from the parameters and puts the robot into its initial state.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn place(&mut self) {
        self.tree.renew(&self.model, &self.parameters);
        self.state = initial_state(&self.model, &self.parameters, self.start);
        self.scale_tree(&self.state.physical.q.clone());
        self.close();
        self.follow();
        self.gather();
        self.applied.copy_from(&self.inputs);
        self.settle();
        self.stale = false;
        self.forget();
    }

    /// Before the simulation begins, commanded positions that nobody has set are those in which the
    /// joints begin: a servo is to hold what it is given, not to strike out.
    fn follow(&mut self) {
        if self.initialized {
            return;
        }
        let (model, parameters, q) = (&self.model, &self.parameters, &self.state.physical.q);
        self.inputs.follow(|a| {
            let joint = model.actuators[a.index()].joint;
            let set = parameters.get(ParameterSlot::InitialJointPosition(joint));
            let body = model.scalar_body(joint);
            let found = body.map_or(set, |body| q[model.bodies[body.index()].coordinate]);
            // What a loop that closes has hardly moved keeps its very number.
            if (found - set).abs() > CLOSED {
                found
            } else {
                set
            }
        });
    }

    /// Closes the loops of the initial state; what follows from it is that of the closed one.
    pub(super) fn close(&mut self) {
        if self.model.loops.is_empty() {
            return;
        }
        self.tree.mesh(&self.state.physical.q);
        let kin = &mut self.readout.point.kin;
        let (model, state) = (&self.model, &mut self.state.physical);
        self.open = initial::close(model, &self.parameters, &self.tree, kin, state);
        self.scale_tree(&self.state.physical.q.clone());
    }

    /// Stiffness and error weights, which follow from the initial position.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn scale_tree(&mut self, q: &[f64]) {
        let kin = &mut self.readout.point.kin;
        kin.update_poses(&self.tree, q);
        crba::mass_matrix(&self.tree, kin);
        let diagonal = |k| kin.M[self.tree.sparsity.diagonal(k)];
        let inertia: Vec<f64> = (0..self.model.nv()).map(diagonal).collect();
        self.tree.scale(&self.model, &inertia, &kin.X);
    }
}
