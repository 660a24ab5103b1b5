//! Acceptance cases on published robots: A1 on random trees against Pinocchio, D1, D2 and rest on
//! PyBullet's R2D2 and on quadrupeds of example-robot-data. Rows of the table in
//! `docs/acceptance.md`, as in `tests/acceptance`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

#[path = "base.rs"]
mod base;
#[path = "../acceptance/claim.rs"]
mod claim;
#[path = "environment.rs"]
mod environment;
mod reader;

use base::Base;
use claim::{hold, hold_or_say};
use reader::{model, model_on};
use serde::Deserialize;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use urdf2fmu_core::dynamics::{aba::Articulated, crba, energy, rnea};
use urdf2fmu_core::kinematics::Kinematics;
use urdf2fmu_core::model::{ActuatorId, LinkId, Model, Motion, RootId};
use urdf2fmu_core::parameters::Parameters;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, Simulation};
use urdf2fmu_core::tree::Tree;
use urdf2fmu_core::tuning::Rules;

/// A random tree and Pinocchio's numbers for one state, as `random_trees.py` writes them.
#[derive(Deserialize)]
struct Case {
    urdf: String,
    floating: bool,
    /// Moving joints in the order of the numbers.
    joints: Vec<String>,
    /// Of the base if it floats, then of each joint.
    position: Vec<Vec<f64>>,
    v: Vec<f64>,
    tau: Vec<f64>,
    M: Vec<Vec<f64>>,
    bias: Vec<f64>,
    vdot: Vec<f64>,
    kinetic: f64,
    potential: f64,
}

/// Largest difference, relative to the largest number.
fn relative(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let scale = theirs.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let pairs = ours.iter().zip(theirs);
    pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale
}

/// Largest relative differences of M, bias, energies, accelerations by articulated bodies and by
/// factorisation, and of what the two accelerations ask for as forces.
fn differences(case: &Case) -> [f64; 8] {
    let model = model_on(Path::new(&case.urdf), case.floating);
    let tree = Tree::new(&model, &Parameters::new(&model));
    let mut q = vec![0.0; model.nq];
    // Where each of the reference's degrees of freedom stands in ours.
    let mut place: Vec<usize> = Vec::new();
    let mut positions = case.position.iter();
    if case.floating {
        q[..7].copy_from_slice(positions.next().expect("one for the base"));
        place.extend(0..6);
    }
    for (name, position) in case.joints.iter().zip(positions) {
        let joint = model.joints.iter().find(|j| j.name == *name);
        let mut rest = &position[..];
        for body in &joint.expect("a joint of the tree").bodies {
            let body = &model.bodies[body.index()];
            let (now, later) = rest.split_at(body.motion.nq());
            q[body.coordinate..body.coordinate + now.len()].copy_from_slice(now);
            rest = later;
            place.extend((0..body.motion.nv()).map(|i| body.dof.index() + i));
        }
        assert!(rest.is_empty(), "{name} has too few bodies");
    }
    let nv = model.nv();
    assert_eq!(place.len(), nv);
    let (mut v, mut tau) = (vec![0.0; nv], vec![0.0; nv]);
    for (k, &ours) in place.iter().enumerate() {
        (v[ours], tau[ours]) = (case.v[k], case.tau[k]);
    }
    let base = Base::enter(&tree, &mut q, &mut v, &mut tau);
    let mut kin = Kinematics::new(&tree);
    kin.update_poses(&tree, &q);
    kin.update_velocities(&tree, &v);
    crba::mass_matrix(&tree, &mut kin);
    rnea::bias(&tree, &mut kin, &v, &[], 0.0);
    let mut M = Vec::new();
    for &k in &place {
        let column = base.column(&tree, &kin.M, k);
        M.extend(place.iter().map(|&j| column[j]));
    }
    let mut factor = kin.M.clone();
    tree.sparsity.factor(&mut factor);
    let mut by_factor: Vec<f64> = tau.iter().zip(&kin.bias).map(|(t, k)| t - k).collect();
    tree.sparsity.solve(&factor, &mut by_factor);
    let mut by_bodies = vec![0.0; nv];
    Articulated::new(&tree).accelerations(&tree, &kin, &v, &tau, (&[], 0.0), &mut by_bodies);
    let ours = |x: &[f64]| place.iter().map(|&k| x[k]).collect::<Vec<_>>();
    let energies = [
        energy::kinetic(&tree, &kin, &v),
        energy::potential(&tree, &kin),
    ];
    // A long chain's accelerations are ill conditioned, in whatever program: `M v̇ + k` shows how
    // well each meets τ.
    let residual = |vdot: &[f64]| {
        let mut forces = vec![0.0; nv];
        tree.sparsity.multiply(&kin.M, vdot, &mut forces);
        for (force, k) in forces.iter_mut().zip(&kin.bias) {
            *force += k;
        }
        let scale = kin
            .bias
            .iter()
            .chain(&tau)
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        let pairs = forces.iter().zip(&tau);
        pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale
    };
    let mut theirs = vec![0.0; nv];
    for (k, &at) in place.iter().enumerate() {
        theirs[at] = case.vdot[k];
    }
    base.velocity(&mut theirs);
    for (x, drift) in theirs.iter_mut().zip(base.drift(nv)) {
        *x += drift;
    }
    [
        relative(&M, &case.M.concat()),
        relative(&ours(&base.bias(&tree, &kin.M, &kin.bias)), &case.bias),
        relative(&energies, &[case.kinetic, case.potential]),
        residual(&by_bodies),
        residual(&by_factor),
        residual(&theirs),
        relative(&ours(&base.leave(by_bodies)), &case.vdot),
        relative(&ours(&base.leave(by_factor)), &case.vdot),
    ]
}

/// A1. Mass matrix, bias forces, accelerations and energies of 100 random trees of up to 60 degrees
/// of freedom, on a fixed or a floating base, with every kind of joint, against Pinocchio.
#[test]
fn a1_a_hundred_random_trees_move_as_in_pinocchio() {
    let Some(environment) = environment::make() else {
        return;
    };
    let out = environment.folder.join("trees.json");
    let status = Command::new(environment.interpreter)
        .arg("-B")
        .arg(environment::tests().join("random_trees.py"))
        .arg(environment.folder.join("trees"))
        .arg(&out)
        .env_remove("PYTHONPATH")
        .status()
        .expect("the environment has an interpreter");
    assert!(status.success(), "random_trees.py failed");
    let text = std::fs::read_to_string(out).expect("it was written");
    let cases: Vec<Case> = serde_json::from_str(&text).expect("as the script writes it");
    assert_eq!(cases.len(), 100);
    let mut worst = [0.0_f64; 8];
    for case in &cases {
        for (worst, now) in worst.iter_mut().zip(differences(case)) {
            *worst = worst.max(now);
        }
    }
    let [
        M,
        bias,
        energies,
        by_bodies,
        by_factor,
        theirs,
        bodies,
        factor,
    ] = worst;
    for (name, worst, allowed) in [
        ("M", M, 1e-13),
        ("bias", bias, 1e-13),
        ("energies", energies, 1e-13),
        ("M v̇ + k − τ by CRBA", by_factor, 5e-12),
        ("M v̇ + k − τ by Pinocchio", theirs, 4e-12),
    ] {
        let what = format!("{name} of 100 random trees, relative");
        hold("A1", &what, "Pinocchio 4.1.0", worst, allowed);
    }
    for (name, worst, target) in [
        ("M v̇ + k − τ by ABA", by_bodies, 2e-11),
        ("v̇ by ABA", bodies, 1e-12),
        ("v̇ by CRBA", factor, 1e-12),
    ] {
        let what = format!("{name} of 100 random trees, relative");
        let why = "M of a long chain has condition numbers of up to a million";
        hold_or_say(["A1", &what, "Pinocchio 4.1.0"], worst, target, why);
    }
}

/// A robot under its settings at a tolerance, ready to run.
fn start(mut model: Model, tolerance: f64) -> Simulation {
    model.solver.tolerance = tolerance;
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.initialize(0.0).expect("a sound model");
    simulation
}

/// Vertical contact force over the weight of what moves, less one.
fn unbalanced(s: &mut Simulation) -> f64 {
    let links = s.model().links.len();
    let force: f64 = (0..links)
        .map(|l| s.output(OutputSlot::ContactForce(LinkId::from(l), 2)))
        .sum();
    force / (s.tree().moving_mass() * s.model().world.gravity.norm()) - 1.0
}

/// A robot at rest is left where it is; without that rule it has to stand by itself.
const REST: [(Rules, &str); 2] = [
    (Rules::ALL, ""),
    (
        Rules {
            rest: false,
            ..Rules::ALL
        },
        ", rest detection off",
    ),
];

/// Largest change of any coordinate in `seconds` after `settle` seconds, m or rad; and how well the
/// ground carries the weight.
fn stand(s: &mut Simulation, settle: u32, seconds: u32) -> [f64; 2] {
    for step in 1..=240 * settle {
        s.advance_to(f64::from(step) / 240.0).expect("finite");
    }
    let settled = s.state().physical.q.clone();
    for second in 1..=seconds {
        s.advance_to(f64::from(settle + second)).expect("finite");
    }
    let pairs = settled.iter().zip(&s.state().physical.q);
    let moved = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    [moved, unbalanced(s)]
}

/// D1. PyBullet's R2D2 stands for an hour: PyBullet's own walks by millimetres and turns by 0.7°
/// (design, §6.1).
#[test]
fn d1_r2d2_stands_for_an_hour() {
    let Some(environment) = environment::make() else {
        return;
    };
    let robot = environment.pybullet_data.join("r2d2.urdf");
    let model = model(&robot, &Settings::default());
    for ((rules, name), allowed) in REST.into_iter().zip([[0.0, 1e-8], [1.5e-11, 2e-10]]) {
        let mut s = start(model.clone(), 1e-3);
        s.set_rules(rules);
        let [moved, force] = stand(&mut s, 20, 3600);
        let what = |what: &str| format!("R2D2 at rest: {what}{name}");
        let still = what("motion in one hour, m or rad");
        hold("D1", &still, "0", moved, allowed[0]);
        let carried = what("Σ of the contact forces, relative");
        hold("D1", &carried, "m g", force, allowed[1]);
    }
}

/// D1. R2D2's wheels at 10 rad/s: its line is that of the same drive at a tolerance of 1e-8.
#[test]
fn d1_r2d2_drives_straight() {
    let Some(environment) = environment::make() else {
        return;
    };
    let robot = environment.pybullet_data.join("r2d2.urdf");
    // PyBullet takes inertia from the shapes, and so does its tutorial.
    let tutorial = "[robot]\ninertia = \"collision\"\n";
    let settings = Settings::parse(tutorial, "here").unwrap_or_else(|f| panic!("{f:#?}"));
    let drive = |tolerance: f64| {
        let mut s = start(model(&robot, &settings), tolerance);
        let mut end = 0.0;
        while s.time() < 4.0 {
            if (s.time() - 1.0).abs() < 1e-9 {
                for a in 0..s.model().actuators.len() {
                    let joint = s.model().actuators[a].joint;
                    if s.model().joints[joint.index()]
                        .name
                        .ends_with("wheel_joint")
                    {
                        s.set_input(InputSlot::Velocity(ActuatorId::from(a)), -10.0);
                    }
                }
            }
            end += 1.0;
            s.advance_to(end / 240.0).expect("finite");
        }
        let way = s.state().physical.q[0].hypot(s.state().physical.q[1]);
        (s.output(OutputSlot::BaseRpy(RootId::ROBOT, 2)), way)
    };
    let (reference, distance) = drive(1e-8);
    assert!(distance > 0.9, "{distance}");
    for (tolerance, allowed) in [(1e-4, 4e-5), (1e-6, 7e-7)] {
        let (yaw, way) = drive(tolerance);
        let what = |what: &str| format!("{what}, tol {tolerance:.0e}");
        let error = (yaw - reference) / distance;
        let heading = what("heading of R2D2, rad per m");
        let why = "the file's axles are tilted by micrometres, so that its wheels scrub; when each \
                   of them begins to hold decides";
        let claim = ["D1", &heading, "that at tol 1e-8"];
        let target = if tolerance > 1e-6 { 1e-6 } else { 2e-7 };
        hold_or_say(claim, error, target, why);
        let error = way - distance;
        hold(
            "D1",
            &what("way of R2D2 in 3 s, m"),
            "that at tol 1e-8",
            error,
            allowed,
        );
    }
}

/// D2. Quadrupeds of example-robot-data stand for an hour on servos that hold the pose in which
/// they begin. Without the rule of rest, where each step is taken, six minutes must do.
#[test]
fn d2_published_quadrupeds_stand_for_an_hour() {
    let Some(environment) = environment::make() else {
        return;
    };
    let data = environment.pybullet_data;
    for (name, file, settings, allowed) in [
        (
            "A1",
            "a1/a1.urdf",
            "[initial.joints]\n\"*_upper_joint\" = 0.8\n\"*_lower_joint\" = -1.6\n\
             [[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 200\nkd = 5\n",
            // What rests is balanced to BALANCE of the tolerance, 3e-7.
            [[0.0, 3e-7], [6e-10, 2.5e-8]],
        ),
        (
            "Laikago",
            "laikago/laikago_toes.urdf",
            "[initial]\nrpy = [1.5707963267948966, 0, 0]\n[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 400\nkd = 10\n",
            [[0.0, 1.5e-9], [1e-10, 8e-9]],
        ),
    ] {
        let settings = Settings::parse(settings, "here").unwrap_or_else(|f| panic!("{f:#?}"));
        let model = model(&data.join(file), &settings);
        assert_eq!(model.bodies[0].motion, Motion::Free);
        for ((rules, rule), allowed) in REST.into_iter().zip(allowed) {
            let mut s = start(model.clone(), 1e-3);
            s.set_rules(rules);
            let (seconds, time) = if rules.rest {
                (3600, "one hour")
            } else {
                (360, "six minutes")
            };
            let [moved, force] = stand(&mut s, 20, seconds);
            let what = |what: &str| format!("{name} under pd control: {what}{rule}");
            let still = what(&format!("motion in {time}, m or rad"));
            hold("D2", &still, "0", moved, allowed[0]);
            let carried = what("Σ of the contact forces, relative");
            hold("D2", &carried, "m g", force, allowed[1]);
        }
    }
}
