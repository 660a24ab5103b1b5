//! Mass matrix, bias forces and accelerations against Pinocchio, on published robots.
//!
//! `tests/python/pinocchio_reference.py` writes Pinocchio's numbers for random states in our
//! convention; the same URDF goes through our reader. Both algorithms for the accelerations are
//! held against it: articulated bodies, and the factorised mass matrix.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

#[path = "base.rs"]
mod base;
#[path = "environment.rs"]
mod environment;
mod reader;

use base::Base;
use reader::model_on;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;
use urdf2fmu_core::dynamics::{aba::Articulated, crba, rnea};
use urdf2fmu_core::kinematics::Kinematics;
use urdf2fmu_core::parameters::Parameters;
use urdf2fmu_core::tree::Tree;

/// A robot and Pinocchio's answers.
#[derive(Deserialize)]
struct Robot {
    urdf: String,
    floating: bool,
    /// Moving joints that mimic nothing, in the order of the answers.
    joints: Vec<String>,
    states: Vec<State>,
}

/// `v`, `tau`, `M`, `bias`, `vdot`: base first (angular, linear, world axes), then the joints.
#[derive(Deserialize)]
struct State {
    position: Option<[f64; 3]>,
    quaternion_wxyz: Option<[f64; 4]>,
    q: Vec<f64>,
    v: Vec<f64>,
    tau: Vec<f64>,
    M: Vec<Vec<f64>>,
    bias: Vec<f64>,
    vdot: Vec<f64>,
}

/// Pinocchio's answers for all robots, computed once; none where there is no Python.
fn reference() -> Option<&'static BTreeMap<String, Robot>> {
    static REFERENCE: OnceLock<Option<BTreeMap<String, Robot>>> = OnceLock::new();
    let made = REFERENCE.get_or_init(|| {
        let environment = environment::make()?;
        let out = environment.folder.join("pinocchio.json");
        let status = Command::new(environment.interpreter)
            .arg("-B")
            .arg(environment::tests().join("pinocchio_reference.py"))
            .arg(environment.pybullet_data)
            .arg(&out)
            .env_remove("PYTHONPATH")
            .status()
            .expect("the environment has an interpreter");
        assert!(
            status.success(),
            "Pinocchio's reference could not be computed"
        );
        let text = std::fs::read_to_string(out).expect("it has just been written");
        Some(serde_json::from_str(&text).expect("it is as the script writes it"))
    });
    made.as_ref()
}

/// Largest difference, relative to the largest number.
fn relative<'a>(
    ours: impl Iterator<Item = f64>,
    theirs: impl Iterator<Item = &'a f64> + Clone,
) -> f64 {
    let scale = theirs.clone().fold(0.0, |m: f64, x| m.max(x.abs()));
    let error = ours
        .zip(theirs)
        .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    error / scale
}

/// Largest relative differences of M, bias, accelerations by articulated bodies and by
/// factorisation.
fn differences(robot: &Robot) -> [f64; 4] {
    let model = model_on(Path::new(&robot.urdf), robot.floating);
    let first = if robot.floating { 6 } else { 0 };
    assert_eq!(model.is_floating(), robot.floating);
    assert_eq!(model.nv(), first + robot.joints.len(), "degrees of freedom");
    // Where a joint of the reference stands in our q and v.
    let bodies: Vec<_> = robot
        .joints
        .iter()
        .map(|name| {
            let joint = model.joints.iter().find(|j| j.name == *name);
            let joint = joint.unwrap_or_else(|| panic!("no joint {name}"));
            &model.bodies[joint.bodies[0].index()]
        })
        .collect();
    let place: Vec<usize> = (0..first)
        .chain(bodies.iter().map(|body| body.dof.index()))
        .collect();

    let tree = Tree::new(&model, &Parameters::new(&model));
    let mut kin = Kinematics::new(&tree);
    let mut aba = Articulated::new(&tree);
    let mut worst = [0.0_f64; 4];
    for state in &robot.states {
        let mut q = vec![0.0; model.nq];
        if let (Some(position), Some(quaternion)) = (state.position, state.quaternion_wxyz) {
            q[..3].copy_from_slice(&position);
            q[3..7].copy_from_slice(&quaternion);
        }
        for (body, angle) in bodies.iter().zip(&state.q) {
            q[body.coordinate] = *angle;
        }
        let mut v = vec![0.0; model.nv()];
        let mut tau = vec![0.0; model.nv()];
        for (k, &ours) in place.iter().enumerate() {
            v[ours] = state.v[k];
            tau[ours] = state.tau[k];
        }
        let base = Base::enter(&tree, &mut q, &mut v, &mut tau);

        kin.update_poses(&tree, &q);
        kin.update_velocities(&tree, &v);
        crba::mass_matrix(&tree, &mut kin);
        rnea::bias(&tree, &mut kin, &v, &[], 0.0);
        // Column by column, so that the packing is checked along with the numbers.
        let mut rows = vec![vec![0.0; model.nv()]; model.nv()];
        for (k, row) in rows.iter_mut().enumerate() {
            let column = base.column(&tree, &kin.M, place[k]);
            for (entry, &ours) in row.iter_mut().zip(&place) {
                *entry = column[ours];
            }
        }
        let mut by_factor: Vec<f64> = tau.iter().zip(&kin.bias).map(|(t, k)| t - k).collect();
        let mut factor = kin.M.clone();
        tree.sparsity.factor(&mut factor);
        tree.sparsity.solve(&factor, &mut by_factor);
        // Exact coupling of two branches is out of its reach.
        let mut by_bodies = by_factor.clone();
        if tree.pure {
            aba.accelerations(&tree, &kin, &v, &tau, (&[], 0.0), &mut by_bodies);
        }

        let ours = |x: &[f64]| place.iter().map(|&k| x[k]).collect::<Vec<_>>().into_iter();
        for (worst, now) in worst.iter_mut().zip([
            relative(rows.into_iter().flatten(), state.M.iter().flatten()),
            relative(
                ours(&base.bias(&tree, &kin.M, &kin.bias)),
                state.bias.iter(),
            ),
            relative(ours(&base.leave(by_bodies)), state.vdot.iter()),
            relative(ours(&base.leave(by_factor)), state.vdot.iter()),
        ]) {
            *worst = worst.max(now);
        }
    }
    worst
}

/// Accuracy demanded, relative to the largest number of its kind.
const ACCURACY: f64 = 1e-12;

fn agrees(name: &str) {
    let Some(reference) = reference() else {
        return;
    };
    let worst = differences(&reference[name]);
    for (what, error) in ["M", "bias", "vdot (ABA)", "vdot (CRBA)"].iter().zip(worst) {
        assert!(
            error < ACCURACY,
            "{name}: {what} differs by {error:e} relative; all: {worst:?}"
        );
    }
}

#[test]
fn iiwa_moves_as_in_pinocchio() {
    agrees("iiwa");
}

#[test]
fn panda_with_its_mimic_finger_moves_as_in_pinocchio() {
    agrees("panda");
}

#[test]
fn anymal_moves_as_in_pinocchio() {
    agrees("anymal");
    agrees("anymal_c");
}

#[test]
fn g1_moves_as_in_pinocchio() {
    agrees("g1");
    agrees("g1_with_hands");
}
