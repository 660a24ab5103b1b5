//! The initial state: joint positions inside their limits, the base on the ground.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::base::Base;
use super::findings::{Findings, counted, listed};
use super::robot::{is_scalar, kind_name};
use crate::diagnostic::angles;
use crate::dynamics::crba;
use crate::force::{ContactSet, detect};
use crate::initial::{in_ground, initial_state};
use crate::kinematics::Kinematics;
use crate::model::{Collider, JointId, JointKind, LinkId, Model, RootId};
use crate::parameters::Parameters;
use crate::pattern::{Pattern, names_last};
use crate::settings::Settings;
use crate::spatial::{Pose, Vec3, rpy_from_rotation};
use crate::tree::{Tree, TreeCollider};
use std::collections::BTreeMap;

/// Smallest angle outside of the limits that may be meant in degrees: up to a turn it may as well
/// be in radians.
const LEAST_DEGREES: f64 = 7.0;

/// How far outside its limits an initial position may be and is moved onto them: files round their
/// numbers.
const LIMIT_SLACK: f64 = 1e-6;

/// Where everything is at the start, from O of its tree, in world axes.
pub(super) struct Poses {
    pub(super) tree: Tree,
    pub(super) kin: Kinematics,
}

/// The initial pose of the model as it is.
pub(super) fn poses(model: &Model) -> Poses {
    let parameters = Parameters::new(model);
    let tree = Tree::new(model, &parameters);
    let mut kin = Kinematics::new(&tree);
    kin.update_poses(&tree, &initial_state(model, &parameters, 0.0).physical.q);
    Poses { tree, kin }
}

impl Poses {
    /// Poses of two of the tree's colliders, in world axes about one origin.
    pub(super) fn pair(&self, [a, b]: [&TreeCollider; 2]) -> [Pose; 2] {
        let mut X = [a, b].map(|c| self.kin.X[c.body].compose(&c.X));
        X[1].p += self.kin.origins[b.tree] - self.kin.origins[a.tree];
        X
    }

    /// Pose of a collider.
    pub(super) fn collider(&self, model: &Model, collider: &Collider) -> Pose {
        let link = &model.links[collider.link.index()];
        self.link(model, collider.link)
            .compose(&link.X_BL.inverse())
            .compose(&collider.X_BG)
    }

    /// How much higher the origin of the robot's base link is than O, m.
    pub(super) fn base_height(&self, model: &Model) -> f64 {
        self.link(model, model.base(RootId::ROBOT).link).p.z
    }

    /// Pose of a link.
    pub(super) fn link(&self, model: &Model, link: LinkId) -> Pose {
        let body = model.links[link.index()].body;
        self.kin.X[body.index()].compose(&self.tree.link_pose[link.index()])
    }
}

/// Initial joint positions and velocities from the settings, else zero or the nearest limit.
pub(super) fn joints(model: &mut Model, settings: &Settings, findings: &mut Findings) {
    let count = model.joints.len();
    let state = values(model, &settings.initial.state, findings);
    let given = values(model, &settings.initial.joints, findings);
    let positions: Vec<_> = given.into_iter().zip(state).map(|(g, s)| g.or(s)).collect();
    let velocities = values(model, &settings.initial.joint_velocities, findings);
    model.initial.joint_positions = vec![0.0; count];
    model.initial.joint_velocities = vec![0.0; count];
    let mut moved = Vec::new();
    for j in 0..count {
        let joint = &model.joints[j];
        let (Some(body), None) = (model.scalar_body(JointId::from(j)), joint.mimic) else {
            continue;
        };
        let dof = model.bodies[body.index()].dof;
        let (mut position, given) = match &positions[j] {
            Some((value, pattern)) => (*value, Some(pattern)),
            None => (0.0, None),
        };
        if let Some(limits) = model.dofs[dof.index()].limits {
            let inside = position.clamp(limits.lower, limits.upper);
            let slack = LIMIT_SLACK * (1.0 + inside.abs());
            match given {
                Some(pattern) if (position - inside).abs() > slack => {
                    let message = format!(
                        "the initial position {position} of joint '{}' is outside its limits {} … {}",
                        joint.name, limits.lower, limits.upper
                    );
                    let radians = position.to_radians();
                    let meant = joint.kind == JointKind::Revolute
                        && (limits.lower..=limits.upper).contains(&radians);
                    let help = if meant && position.abs() >= LEAST_DEGREES {
                        format!("angles are in radians; {position} degrees are {radians:.5}")
                    } else {
                        format!("the nearest possible one is {inside}")
                    };
                    findings.error("A106", pattern.place.clone(), message, &help);
                }
                None if (position - inside).abs() > slack => {
                    moved.push(format!("{} = {inside}", joint.name));
                }
                _ => {}
            }
            position = inside;
        } else if let Some(pattern) = given
            && joint.kind == JointKind::Continuous
        {
            let what = format!("the initial position of joint '{}':", joint.name);
            if let Some(message) = angles::attitude(&what, &[position]) {
                findings.warning("S104", pattern.place.clone(), message, angles::HELP);
            }
        }
        model.initial.joint_positions[j] = position;
        model.initial.joint_velocities[j] = velocities[j].as_ref().map_or(0.0, |(v, _)| *v);
        if let (Some((value, pattern)), Some(limit)) = (&velocities[j], joint.velocity)
            && value.abs() > limit
        {
            let message = format!(
                "the initial velocity {value} of joint '{}' is beyond its limit {limit}",
                joint.name
            );
            findings.warning("A106", pattern.place.clone(), message, "");
        }
    }
    if !moved.is_empty() {
        let message = format!(
            "joint zero is outside the limits, the initial position is the nearest limit: {}",
            listed(&moved).replace('\'', "")
        );
        findings.note("A110", message, "set [initial] joints to start elsewhere");
    }
}

/// What the settings give per joint; later entries win, plain names over globs.
fn values(
    model: &Model,
    given: &[(Pattern, f64)],
    findings: &mut Findings,
) -> Vec<Option<(f64, Pattern)>> {
    let names: Vec<&str> = model.joints.iter().map(|j| j.name.as_str()).collect();
    let mut values: Vec<Option<(f64, Pattern)>> = vec![None; names.len()];
    let unsuitable = |j: usize| {
        let joint = &model.joints[j];
        match joint.mimic {
            _ if !is_scalar(joint.kind) => Some(format!(
                "{}: only turning and sliding joints have an initial value",
                kind_name(joint.kind)
            )),
            Some(mimic) => Some(format!(
                "follows '{}', which can be set",
                model.joints[mimic.joint.index()].name
            )),
            None => None,
        }
    };
    for (pattern, value) in names_last(given, |(pattern, _)| pattern) {
        for j in findings.select(pattern, "joint", &names, unsuitable) {
            values[j] = Some((*value, pattern.clone()));
        }
    }
    values
}

/// Base pose and velocity from the settings; z is 0 where it has to be found.
pub(super) fn base(model: &mut Model, base: &Base, settings: &Settings, findings: &mut Findings) {
    let initial = &settings.initial;
    let place = Vec3::new(initial.xy[0], initial.xy[1], initial.z.unwrap_or(0.0));
    if base.X_RB == Pose::IDENTITY {
        // The very numbers of the settings.
        model.roots[0].position = place;
        model.roots[0].rpy = initial.rpy;
    } else {
        let X_WR = Pose::from_xyz_rpy(place, initial.rpy);
        let X_WB = X_WR.compose(&base.X_RB);
        model.roots[0].position = X_WB.p;
        model.roots[0].rpy = rpy_from_rotation(&X_WB.R);
    }
    if base.motion.kind().is_free() {
        model.roots[0].linear_velocity = initial.linear_velocity;
        model.roots[0].angular_velocity = initial.angular_velocity;
    } else if initial.linear_velocity != Vec3::zeros() || initial.angular_velocity != Vec3::zeros()
    {
        let message = "a fixed base has no initial velocity".to_owned();
        let place = initial.velocity_place.clone();
        findings.error("A106", place, message, "set [robot] base = \"floating\"");
    }
}

/// Places a floating base on the ground where the settings give no height; warns of a start inside
/// the ground.
pub(super) fn height(
    model: &mut Model,
    poses: &Poses,
    settings: &Settings,
    findings: &mut Findings,
) {
    let floating = model.is_floating();
    let stands = floating || settings.initial.stands;
    let lowest = lowest_point(
        model,
        poses,
        stands && !floating && settings.initial.z.is_none(),
    );
    let given = settings.initial.z.is_some();
    if stands && !given {
        match lowest {
            Some((link, z)) if model.world.ground.is_some() => {
                // Adding 0 turns -0 into 0.
                model.roots[0].position.z = -z + 0.0;
                if floating {
                    model.roots[0].position.z -= static_depth(model);
                    model.roots[0].set_down = true;
                }
                let message = format!(
                    "the robot starts with its base at z = {:.6} m, where its lowest collision point, of link '{}', touches the ground",
                    model.roots[0].position.z,
                    model.links[link.index()].name
                );
                findings.note("A111", message, "set [initial] xyz to start elsewhere");
            }
            _ => {
                model.roots[0].position.z = 0.0;
                let why = match (&model.world.ground, floating) {
                    (None, _) => "there is no ground",
                    (Some(_), true) => "it has no collision shapes to stand on, and falls",
                    (Some(_), false) => "it has no collision shapes to stand on",
                };
                let message = format!("the robot starts with its base at z = 0: {why}");
                findings.note("A111", message, "set [initial] xyz to start elsewhere");
            }
        }
        return;
    }
    let (Some((_, z)), Some(_)) = (lowest, &model.world.ground) else {
        return;
    };
    // The height that would follow by itself, as `init` writes it down.
    let mut touching = model.clone();
    touching.roots[0].position.z = -z + 0.0;
    #[expect(clippy::float_cmp, reason = "another height is somebody's wish")]
    let own = floating
        && touching.roots[0].position.z - static_depth(&touching) == model.roots[0].position.z;
    model.roots[0].set_down = own;
    let deep = links_in_ground(model);
    let deepest = deep.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some(&(link, depth, push)) = deepest.filter(|_| !settings.driven) {
        let name = |link: usize| &model.links[link].name;
        let deepest = name(link);
        let others = deep.iter().filter(|(other, ..)| *other != link);
        let others: Vec<&String> = others.map(|(other, ..)| name(*other)).collect();
        let others = match others.len() {
            0 => String::new(),
            n => format!(
                ", and {} less deep ({})",
                counted(n, "other"),
                listed(&others)
            ),
        };
        let message = format!(
            "the robot starts {:.3} mm inside the ground, with link '{deepest}'{others}",
            1e3 * depth
        );
        let z = -z;
        let help = if floating {
            format!(
                "it touches the ground with its base at z = {z:.6} m: leave out z to start there"
            )
        } else {
            format!(
                "start in another pose ([initial] joints, or --srdf with --initial-state), mount the \
                 base at z = {z:.6} m ([initial] xyz), or use ground = {{ type = \"none\" }}"
            )
        };
        let help = format!(
            "{help}; contacts push it out at first with {push:.0} times its weight, for an instant"
        );
        findings.warning("A112", None, message, &help);
    }
}

/// The links that are deeper in the ground than their contacts carry the weight at rest, in their
/// order, how deep each is, m, and with how many weights its contact pushes there.
fn links_in_ground(model: &Model) -> Vec<(usize, f64, f64)> {
    let Poses { tree, kin } = scaled(model);
    let mut depths = BTreeMap::new();
    for (collider, depth) in in_ground(model, (&tree, &kin)) {
        let deepest = depths.entry(collider.link).or_insert((depth, 0.0));
        let push = collider.spring.weights(depth);
        *deepest = (depth.max(deepest.0), push.max(deepest.1));
    }
    let list = depths.into_iter();
    list.map(|(link, (depth, push))| (link, depth, push))
        .collect()
}

/// The initial pose, and a tree whose contacts are made for the weight of the model.
fn scaled(model: &Model) -> Poses {
    let Poses { mut tree, mut kin } = poses(model);
    crba::mass_matrix(&tree, &mut kin);
    let diagonal = |k| kin.M[tree.sparsity.diagonal(k)];
    let inertia: Vec<f64> = (0..model.nv()).map(diagonal).collect();
    tree.scale(model, &inertia, &kin.X);
    Poses { tree, kin }
}

fn moves(model: &Model, collider: &Collider) -> bool {
    model.bodies[collider.body.index()].motion.kind().moves()
}

/// How far the model, whose lowest point touches the ground, must sink until the ground carries its
/// weight, m; 0 where it does not within some depths of a single corner.
pub(super) fn static_depth(model: &Model) -> f64 {
    let Poses { tree, mut kin } = scaled(model);
    let weight = -tree.moving_mass() * model.world.gravity.z;
    let mut q = initial_state(model, &Parameters::new(model), 0.0)
        .physical
        .q;
    let (z, rest) = (q[2], vec![0.0; model.nv()]);
    let mut contacts = ContactSet::of(model);
    let mut carries = |depth: f64| {
        q[2] = z - depth;
        kin.update_poses(&tree, &q);
        kin.update_velocities(&tree, &rest);
        detect(model, &tree, &[], &kin, 0.0, &mut contacts);
        let loads = contacts
            .iter()
            .map(|c| c.normal_load(&contacts.points, &kin.V));
        loads.sum::<f64>() >= weight
    };
    // About how deep a single corner sinks; a light touch of a heavy robot sinks by some of them.
    let springs = tree.contact.colliders.iter().map(|c| c.spring.reference);
    let corner = springs.fold(0.0, f64::max);
    let (mut low, mut high) = (0.0, 64.0 * corner);
    if weight <= 0.0 || !carries(high) {
        return 0.0;
    }
    while high - low > f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if carries(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// Height of the lowest point of the shapes that move, or of all, above the base's origin, and its
/// link.
pub(super) fn lowest_point(model: &Model, poses: &Poses, all: bool) -> Option<(LinkId, f64)> {
    let base = poses.base_height(model);
    model
        .colliders
        .iter()
        .filter(|collider| all || moves(model, collider))
        .map(|collider| {
            let X = poses.collider(model, collider);
            (collider.link, collider.shape.lowest(&X, &Vec3::z()) - base)
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Largest distance of a shape or centre of mass from O, m.
pub(super) fn reach(model: &Model, poses: &Poses) -> f64 {
    let shapes = model.colliders.iter().map(|collider| {
        poses.collider(model, collider).p.norm() + collider.shape.bounding_radius()
    });
    let masses = model
        .links
        .iter()
        .enumerate()
        .filter(|(_, link)| link.inertia.mass > 0.0)
        .map(|(l, link)| {
            let X = poses.link(model, LinkId::from(l));
            X.point(&link.inertia.com).norm()
        });
    shapes.chain(masses).fold(0.0, f64::max)
}
