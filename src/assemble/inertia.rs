//! Inertia of links from their shapes, and whether the robot's mass matrix can be inverted.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::{Findings, counted, listed};
use super::idle;
use super::initial::Poses;
use super::robot::Tags;
use crate::dynamics::crba;
use crate::geometry::Shape;
use crate::model::{BodyId, LinkId, Model};
use crate::settings::{InertiaSource, Settings};
use crate::spatial::{Mat3, RigidInertia};
use crate::urdf::CollisionDescription;
use crate::urdf::solids::{of_density, of_solids};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Density of a suggested inertia, kg/m³: most robot parts are between plastics and hollow metal.
pub(super) const SUGGESTED_DENSITY: f64 = 1000.0;

/// Mass of a link without shapes that is suggested, kg: that of a small part.
pub(super) const SUGGESTED_MASS: f64 = 0.1;

/// What a link without shapes is taken for where it must have some size: a ball of 5 cm, as most
/// small parts of robots are.
const FILLING: Shape = Shape::Sphere { radius: 0.05 };

/// Part of its own inertia that must be left to a degree of freedom when all those behind it move
/// freely. Far above the round-off of a mass matrix, far below any real mechanism.
const SMALLEST_SHARE: f64 = 1e-11;

/// Smallest radius of gyration of what turns, m: that of a row of a hundred atoms. What is written
/// with less has no inertia. An inertia by itself says nothing: a grain of sand of 0.1 mm has
/// 1e-18 kg·m², with which a wheel of 1 kg has no finite acceleration. At 1e-10 fails
/// `each_number_of_a_urdf_is_refused_or_gives_finite_results`, at 1e-4
/// `a_grain_of_a_tenth_of_a_millimetre_has_inertia`.
const SMALLEST_GYRATION: f64 = 1e-8;

/// Gives links whose `<inertia>` is singular that of their shapes where the robot could not move
/// otherwise, then those that are left what the settings say, and reports degrees of freedom that
/// have none even so. Returns the poses of the model as it is then.
///
/// A point mass or a line without width is a legal body as long as something turns it about another
/// axis. Where nothing does, zeros mean that the inertia was not computed: a thousand of
/// `PyBullet`'s own objects are written so, with `ixx="1" iyy="1" izz="0"` for 0.1 kg.
pub(super) fn complete(
    model: &mut Model,
    mut poses: Poses,
    shapes: &[Vec<CollisionDescription>],
    tags: &Tags,
    settings: &Settings,
    findings: &mut Findings,
) -> Poses {
    let mut filled = BTreeSet::new();
    loop {
        let weak = match weak(model, &poses) {
            Weak::Dofs(dofs) if dofs.is_empty() => {
                report_filled(model, &filled, settings, findings);
                return poses;
            }
            Weak::Dofs(dofs) => dofs,
            Weak::NotFinite => {
                let message =
                    "the mass matrix is not finite: masses or lengths are out of all proportion";
                findings.error(
                    "A121",
                    None,
                    message.to_owned(),
                    "check the units: m, kg, kg m²",
                );
                return poses;
            }
        };
        let changed = weak
            .iter()
            .any(|&dof| from_solids(model, dof, shapes, tags, findings));
        if !changed {
            let before = filled.len();
            if let Some(mass) = settings.missing_mass {
                for &dof in &weak {
                    let link = model.bodies[model.dofs[dof].body.index()].link.index();
                    if filled.insert(link) {
                        fill(&mut model.links[link].inertia, mass, &shapes[link]);
                    }
                }
            }
            if filled.len() == before {
                let of_shapes = settings.inertia == InertiaSource::Collision;
                report(model, &weak, tags, of_shapes, findings);
                return poses;
            }
        }
        poses = super::initial::poses(model);
    }
}

/// Gives a link without mass `mass` kg, of its shapes as solids or without any as a ball, and one
/// with a mass the inertia of such a ball.
fn fill(inertia: &mut RigidInertia, mass: f64, shapes: &[CollisionDescription]) {
    if inertia.mass > 0.0 {
        let ball = FILLING.solid_inertia(inertia.mass);
        inertia.I_cm += ball.I_cm;
        return;
    }
    let volume: f64 = shapes.iter().map(|c| c.shape.volume()).sum();
    *inertia = of_density(mass / volume, shapes).unwrap_or_else(|| FILLING.solid_inertia(mass));
}

/// Which links got a mass or an inertia that their file does not give.
fn report_filled(
    model: &Model,
    filled: &BTreeSet<usize>,
    settings: &Settings,
    findings: &mut Findings,
) {
    if filled.is_empty() {
        idle::of_missing_mass(settings, findings);
        return;
    }
    let links = filled.iter().map(|&l| &model.links[l]);
    let names: Vec<&str> = links.clone().map(|link| link.name.as_str()).collect();
    let total: f64 = links.map(|link| link.inertia.mass).sum();
    let message = format!(
        "{} that could not move without inertia {} one by missing_mass, {total:.4} kg together: {}",
        counted(names.len(), "link"),
        if names.len() == 1 { "gets" } else { "get" },
        listed(&names)
    );
    findings.note("A138", message, "[link.\"…\"] mass sets the mass of one");
}

/// Gives the links that `dof` moves the inertia of their shapes where theirs is singular; whether
/// there was one.
fn from_solids(
    model: &mut Model,
    dof: usize,
    shapes: &[Vec<CollisionDescription>],
    tags: &Tags,
    findings: &mut Findings,
) -> bool {
    let mut changed = false;
    for l in singular_links_from(model, model.dofs[dof].body) {
        let link = &mut model.links[l];
        // Shapes that are next to nothing give no more than there was.
        let Some(I_cm) = of_solids(link.inertia.mass, &shapes[l]).filter(|own| !is_singular(own))
        else {
            continue;
        };
        link.inertia.I_cm = I_cm;
        changed = true;
        let message = format!(
            "link '{}' has {} kg without rotational inertia about every axis, and cannot move so: it gets the inertia of its collision shapes as solids",
            link.name, link.inertia.mass
        );
        let help = format!(
            "write it into the file to be sure of it:\n{}",
            element(&I_cm)
        );
        findings.warning("A123", findings.tag(&tags.links[l]), message, &help);
    }
    changed
}

/// Links with mass and no inertia about some axis, of `body` and of all that it carries.
fn singular_links_from(model: &Model, body: BodyId) -> Vec<usize> {
    let mut carried = vec![false; model.bodies.len()];
    for (b, other) in model.bodies.iter().enumerate() {
        carried[b] = b == body.index() || other.parent.is_some_and(|p| carried[p.index()]);
    }
    let singular = |own: &RigidInertia| own.mass > 0.0 && is_singular(&own.I_cm);
    (0..model.links.len())
        .filter(|&l| carried[model.links[l].body.index()] && singular(&model.links[l].inertia))
        .collect()
}

/// Whether there is no inertia about some axis.
fn is_singular(I_cm: &Mat3) -> bool {
    let moments = I_cm.symmetric_eigenvalues();
    moments.min() <= SMALLEST_SHARE * moments.max()
}

/// Degrees of freedom with too little inertia, those nearest to the tips first.
enum Weak {
    Dofs(Vec<usize>),
    NotFinite,
}

/// Looks for degrees of freedom without inertia.
///
/// The mass matrix is factored from the tips to the base; the pivot of a degree of freedom is the
/// inertia that is left to it when all those behind it move freely, its articulated inertia. All
/// must be positive. One that has none is taken as locked for those before it, so that all are
/// found at once and no massless frame in between is told whose children have inertia.
fn weak(model: &Model, poses: &Poses) -> Weak {
    let mut kin = poses.kin.clone();
    let tree = &poses.tree;
    crba::mass_matrix(tree, &mut kin);
    let n = model.nv();
    let pattern = &tree.sparsity;
    // The pattern is that of a tree where no joint mimics another one far away; here a full matrix
    // is simplest.
    let mut M = nalgebra::DMatrix::<f64>::zeros(n, n);
    for i in 0..n {
        for (k, &j) in row(pattern, i).iter().enumerate() {
            M[(i, j as usize)] = kin.M[pattern.start[i] + k];
            M[(j as usize, i)] = M[(i, j as usize)];
        }
    }
    let diagonal = M.diagonal();
    let carried = carried_masses(model);
    let mut weak = Vec::new();
    for i in (0..n).rev() {
        let pivot = M[(i, i)];
        if !pivot.is_finite() || !diagonal[i].is_finite() {
            return Weak::NotFinite;
        }
        let least = carried[model.dofs[i].body.index()] * SMALLEST_GYRATION * SMALLEST_GYRATION;
        if pivot <= least.max(SMALLEST_SHARE * diagonal[i]) {
            weak.push(i);
            continue;
        }
        // Rows that are coupled with this one; far fewer than all in a tree.
        let coupled: Vec<usize> = (0..i).filter(|&j| M[(i, j)] != 0.0).collect();
        for (a, &j) in coupled.iter().enumerate() {
            let factor = M[(i, j)] / pivot;
            for &k in &coupled[..=a] {
                M[(j, k)] -= factor * M[(i, k)];
            }
        }
    }
    Weak::Dofs(weak)
}

/// Mass of each body with all that it carries, kg.
fn carried_masses(model: &Model) -> Vec<f64> {
    let mut masses = vec![0.0; model.bodies.len()];
    for link in &model.links {
        masses[link.body.index()] += link.inertia.mass;
    }
    // Parents precede their children.
    for (b, body) in model.bodies.iter().enumerate().rev() {
        if let Some(parent) = body.parent {
            masses[parent.index()] += masses[b];
        }
    }
    masses
}

/// Columns of row `i` of the packed mass matrix.
fn row(pattern: &crate::sparsity::Sparsity, i: usize) -> &[u32] {
    &pattern.column[pattern.start[i]..=pattern.start[i] + pattern.depth[i]]
}

/// One error for all links that lack inertia.
///
/// - `of_shapes`: whether inertias are computed from the shapes already
fn report(model: &Model, weak: &[usize], tags: &Tags, of_shapes: bool, findings: &mut Findings) {
    // From the base outwards, each once.
    let mut bodies: Vec<BodyId> = weak.iter().map(|&dof| model.dofs[dof].body).collect();
    bodies.sort_by_key(|body| body.index());
    bodies.dedup();
    let link_of = |body: &BodyId| model.bodies[body.index()].link;
    let mut links: Vec<LinkId> = bodies.iter().map(link_of).collect();
    links.dedup();
    let joints = bodies.iter().filter_map(|b| model.bodies[b.index()].joint);
    let mut joints: Vec<String> = joints
        .map(|joint| model.joints[joint.index()].name.clone())
        .collect();
    joints.dedup();
    let Some(&first) = links.last() else {
        return;
    };
    let total: f64 = model.links.iter().map(|link| link.inertia.mass).sum();
    let base = model.bodies[bodies[0].index()].joint.is_none();
    let name = &model.links[first.index()].name;
    let message = if let [_] = links[..]
        && base
        && total > 0.0
    {
        format!("the floating base '{name}' has no inertia of its own")
    } else if let [_] = links[..]
        && let Some(joint) = joints.last()
        && total > 0.0
    {
        if model.links[first.index()].inertia.mass > 0.0 {
            format!("link '{name}' and what hangs on it have no inertia along joint '{joint}'")
        } else {
            format!(
                "link '{name}' moves, but neither it nor what hangs on it has inertia along joint '{joint}'"
            )
        }
    } else if total > 0.0 {
        format!(
            "{} move, but neither they nor what hangs on them has inertia",
            counted(links.len(), "link")
        )
    } else {
        format!(
            "the robot can move, but nothing has mass: {} without inertia",
            counted(links.len(), "link")
        )
    };
    let mut help = String::new();
    if links.len() > 1 {
        const MOST: usize = 60;
        let shown = links.iter().take(MOST).map(|link| {
            let line = tags.links[link.index()].line;
            format!("'{}' (line {line})", model.links[link.index()].name)
        });
        let _ = write!(help, "they are {}", shown.collect::<Vec<_>>().join(", "));
        if links.len() > MOST {
            let _ = write!(help, " and {} more", links.len() - MOST);
        }
        help.push('\n');
    }
    let each = if links.len() > 1 { "each" } else { "the link" };
    let _ = write!(
        help,
        "give {each} one, for instance '{name}'\n{}\n{}",
        suggestion(model, first),
        from_shapes(model, first, of_shapes)
    );
    if let [joint] = &joints[..] {
        let _ = write!(
            help,
            "or give the joint rotor inertia: [joint.\"{joint}\"] armature = 1e-4 in the settings"
        );
    }
    if base {
        help.push_str("or fix the base: --fixed-base");
    }
    let code = if base && total <= 0.0 { "A105" } else { "A104" };
    let place = findings.tag(&tags.links[first.index()]);
    findings.error(code, place, message, help.trim_end());
}

/// Advice for a missing `<inertia>`, if the link has a mass, and a shape that is not used for it
/// yet.
fn from_shapes(model: &Model, link: LinkId, of_shapes: bool) -> &'static str {
    let shaped = model.colliders.iter().any(|c| c.link == link);
    if shaped && !of_shapes && model.links[link.index()].inertia.mass > 0.0 {
        "or compute all from the collision shapes: --inertia collision\n"
    } else {
        ""
    }
}

/// An `<inertial>` that the link could have: its shapes as solids, else a ball of 5 cm.
fn suggestion(model: &Model, link: LinkId) -> String {
    let X_BL = &model.links[link.index()].X_BL;
    let mut total = RigidInertia::ZERO;
    for collider in model.colliders.iter().filter(|c| c.link == link) {
        let mass = SUGGESTED_DENSITY * collider.shape.volume();
        if mass > 0.0 && mass.is_finite() {
            let X_LG = X_BL.inverse().compose(&collider.X_BG);
            total = total.joined(&collider.shape.solid_inertia(mass).transformed(&X_LG));
        }
    }
    if total.mass <= 0.0 {
        total = FILLING.solid_inertia(SUGGESTED_MASS);
    }
    let c = total.com.map(|x| if x.abs() < 1e-9 { 0.0 } else { x });
    let mut text = String::from("<inertial>");
    let _ = write!(text, "<origin xyz=\"{:.4} {:.4} {:.4}\"/>", c.x, c.y, c.z);
    let _ = write!(text, "<mass value=\"{:.4}\"/>", total.mass.max(1e-4));
    text.push_str(&element(&total.I_cm));
    text.push_str("</inertial>");
    text
}

/// `<inertia …/>` with four digits.
fn element(I: &Mat3) -> String {
    // Round-off beside the largest entry is not worth printing.
    let largest = I.amax();
    let I = I.map(|i| if i.abs() < 1e-9 * largest { 0.0 } else { i });
    format!(
        "<inertia ixx=\"{:.3e}\" ixy=\"{:.3e}\" ixz=\"{:.3e}\" iyy=\"{:.3e}\" iyz=\"{:.3e}\" izz=\"{:.3e}\"/>",
        I[(0, 0)],
        I[(0, 1)],
        I[(0, 2)],
        I[(1, 1)],
        I[(1, 2)],
        I[(2, 2)]
    )
}
