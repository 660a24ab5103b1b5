//! Worlds: the robot with further robots and objects, as one model.
//!
//! Each of them is assembled by itself under the same gravity, ground, contact law and solver, and
//! then joined with the others. Reading the files is left to the caller.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::alone::{Assembled, attempt, build};
use super::findings::{Findings, first_of_many};
use super::guests::{called, of_guest, told};
use super::terrain::{self, has_terrain};
use super::touch::overlaps;
use super::{exchange, idle, loops, outputs, pairs, touch};
use crate::diagnostic::{Diagnostic, Place, Severity};
use crate::geometry::Shape;
use crate::model::{Ground, Interface, JointKind, Model, RootKind};
use crate::settings::{
    BaseChoice, ContactOutputs, LinkSettings, ModeChoice, ObjectSettings, ObjectSource,
    RobotSettings, Settings, static_excess,
};
use crate::spatial::{Pose, Vec3};
use crate::urdf::{
    CollisionDescription, Description, LinkDescription, Tag, VisualDescription, VisualShape,
};

/// Least length and width of a box that may be the ground, m.
const GROUND_SIZE: f64 = 5.0;
/// How far the top of such a box may be off z = 0, m.
const GROUND_SLACK: f64 = 1e-6;

/// A further robot or an object.
#[derive(Clone, Debug)]
pub struct Guest {
    /// Its name in the world.
    pub name: String,
    /// What it is.
    pub kind: RootKind,
    /// What it consists of.
    pub description: Description,
    /// Its own settings, see [`of_object`] and [`of_robot`].
    pub settings: Settings,
}

/// Assembles a robot and all that is around it.
///
/// # Errors
/// Everything that is wrong with any of them, with the notes and warnings found on the way.
pub fn world(
    description: &Description,
    settings: &Settings,
    guests: &[Guest],
) -> Result<Assembled, Vec<Diagnostic>> {
    if guests.is_empty() {
        return build(description, settings);
    }
    // The more so beside an error, which has to be found.
    match joined(description, settings, guests) {
        Ok(Assembled { model, diagnostics }) => Ok(Assembled {
            model,
            diagnostics: first_of_many(diagnostics),
        }),
        Err(findings) => Err(first_of_many(findings)),
    }
}

/// The same, with all that is found of each of them.
fn joined(
    description: &Description,
    settings: &Settings,
    guests: &[Guest],
) -> Result<Assembled, Vec<Diagnostic>> {
    // Pairs, loops, springs and what does not touch name what is around the robot, too.
    let mut alone = Settings {
        pairs: Vec::new(),
        loops: Vec::new(),
        springs: Vec::new(),
        closure_outputs: [Vec::new(), Vec::new()],
        ignored_contacts: touch::own(settings, description),
        ..settings.clone()
    };
    // So is what can be exchanged.
    alone.fmu.interface = Interface::Cs;
    let terrain = |c: &CollisionDescription| c.shape.is_terrain();
    let uneven = settings.world.ground.is_none()
        && guests.iter().any(|guest| {
            let mut links = guest.description.links.iter();
            links.any(|link| link.collisions.iter().any(terrain))
        });
    let robot = attempt(description, &alone);
    let mut findings = Vec::new();
    let mut models = Vec::new();
    let mut failed = false;
    let mut add = |built: (Option<Model>, Vec<Diagnostic>, bool), guest: Option<&Guest>| {
        let (model, list, fails) = built;
        failed |= fails;
        // Where things start on terrain follows when all are there.
        let list = list.into_iter().filter(|d| d.code != "A111" || !uneven);
        match guest {
            Some(guest) => findings.extend(list.filter_map(|d| told(d, guest.kind, &guest.name))),
            None => findings.extend(list.map(|mut finding| {
                // Scenery with something in it is meant.
                if finding.code == "A107" && finding.message.starts_with("nothing in '") {
                    finding.severity = Severity::Note;
                }
                let others = guests.iter().map(|guest| (guest.kind, guest.name.as_str()));
                if let Some(help) = of_guest(&finding, others) {
                    finding.help = Some(help);
                }
                finding
            })),
        }
        let settings = guest.map_or(settings, |guest| &guest.settings);
        models.extend(model.map(|mut model| {
            // Without a ground there is still something to touch.
            if settings.contact_outputs == ContactOutputs::Auto {
                model.outputs.contacts = outputs::touching(&model);
            }
            model
        }));
    };
    add(robot, None);
    for guest in guests {
        add(attempt(&guest.description, &guest.settings), Some(guest));
    }
    // The mass that links lack is that of all objects, too, and one may need it.
    if findings
        .iter()
        .any(|d| d.code == "A138" && d.message.contains("by missing_mass"))
    {
        findings.retain(|d| d.code != "A144" || !d.message.starts_with("the missing_mass"));
    }
    if models.len() <= guests.len() {
        return Err(findings);
    }
    let mut models = models.into_iter();
    let Some(mut model) = models.next() else {
        return Err(findings);
    };
    for (other, guest) in models.zip(guests) {
        model.join(other, &guest.name, guest.kind);
    }
    if !failed {
        findings.extend(set_down(&mut model, settings, guests));
    }
    let mut of_pairs = Findings::new(description);
    touch::across(&mut model, settings, &mut of_pairs);
    close(&mut model, settings, guests, !failed, &mut of_pairs);
    pairs::select(&mut model, &settings.pairs, &mut of_pairs);
    model.outputs.interface = settings.fmu.interface;
    if !failed && !of_pairs.has_errors() {
        exchange::check(&model, &mut of_pairs);
    }
    failed |= of_pairs.has_errors();
    findings.extend(of_pairs.list);
    if failed {
        return Err(findings);
    }
    if let Err(error) = model.validate() {
        let message = format!("the robot and what is around it do not make a world: {error}");
        let help = "leave something out, or correct what is named";
        findings.push(finding(Severity::Error, "A121", None, message, help));
        return Err(findings);
    }
    findings.extend(warnings(&model));
    findings.extend(idle::of_world(&model, settings));
    Ok(Assembled {
        model,
        diagnostics: findings,
    })
}

/// Adds the loops and springs of the world, and closes the loops of one that is sound.
fn close(
    model: &mut Model,
    settings: &Settings,
    guests: &[Guest],
    sound: bool,
    findings: &mut Findings,
) {
    let mut places = Vec::new();
    loops::select(model, settings, &mut places, findings);
    let mut given = loops::given(model, settings, "");
    for guest in guests {
        let own = loops::given(model, &guest.settings, &format!("{}.", guest.name));
        for (given, own) in given.iter_mut().zip(own) {
            for (given, own) in given.iter_mut().zip(own) {
                *given |= own;
            }
        }
    }
    if sound && !findings.has_errors() {
        loops::close(model, &given, (&places, true), findings);
    }
}

fn finding(
    severity: Severity,
    code: &'static str,
    place: Option<Place>,
    message: String,
    help: &str,
) -> Diagnostic {
    Diagnostic {
        severity,
        code,
        message,
        help: (!help.is_empty()).then(|| help.to_owned()),
        place,
    }
}

/// Settings that are the world's.
fn shared(own: Settings, world: &Settings) -> Settings {
    Settings {
        flat_names: world.flat_names,
        solver: world.solver.clone(),
        contact: world.contact.clone(),
        world: world.world.clone(),
        ..own
    }
}

/// The settings by which an object is assembled.
pub fn of_object(object: &ObjectSettings, world: &Settings) -> Settings {
    let mut own = shared(Settings::of(world.compat), world);
    own.base = if object.fixed {
        BaseChoice::Fixed
    } else {
        BaseChoice::Auto
    };
    own.initial = object.initial.clone();
    // A file has its own zero, as a mounted robot has.
    own.initial.stands = matches!(object.source, ObjectSource::Solid { .. });
    own.inertia = world.inertia;
    own.missing_mass = world.missing_mass;
    own.default_mode = Some(ModeChoice::Passive);
    own.conveyor = object.conveyor;
    own.driven = object.driven;
    if object.driven {
        own.base = BaseChoice::Floating;
    }
    // Links without meshes have the same surface, and no entry of theirs is in vain.
    let LinkSettings { collision, .. } = object.surface;
    own.links.push(LinkSettings {
        collision: None,
        ..object.surface.clone()
    });
    if collision.is_some() {
        own.links.push(LinkSettings {
            collision,
            ..LinkSettings::new("*")
        });
    }
    own
}

/// The settings by which a further robot is assembled: `own` are those of its own file.
///
/// # Errors
/// What only the settings of the world may say.
pub fn of_robot(
    robot: &RobotSettings,
    own: Settings,
    world: &Settings,
) -> Result<Settings, Vec<Diagnostic>> {
    let plain = Settings::of(own.compat);
    let decided = [
        ("compat", own.compat != world.compat),
        (
            "[fmu]",
            own.flat_names && !world.flat_names
                || own.fmu.arrays != plain.fmu.arrays
                || own.fmu.interface != plain.fmu.interface
                || own.fmu.fmi != plain.fmu.fmi,
        ),
        ("[solver]", own.solver != plain.solver),
        ("[contact]", own.contact != plain.contact),
        (
            "[world]",
            own.world != plain.world || !own.objects.is_empty() || !own.robots.is_empty(),
        ),
    ];
    let errors: Vec<_> = decided
        .into_iter()
        .filter(|(_, differs)| *differs)
        .map(|(what, _)| {
            let message = format!(
                "the settings of robot '{}' have {what}, which is the same for the whole world",
                robot.name.text
            );
            let help = "move it into the settings of the world";
            finding(Severity::Error, "A133", robot.place.clone(), message, help)
        })
        .collect();
    if !errors.is_empty() {
        return Err(errors);
    }
    let mut own = shared(own, world);
    if let Some(xy) = robot.xy {
        (own.initial.xy, own.initial.z) = (xy, robot.z);
    }
    if let Some(rpy) = robot.rpy {
        own.initial.rpy = rpy;
    }
    own.base = match robot.fixed_base {
        Some(true) => BaseChoice::Fixed,
        Some(false) => BaseChoice::Floating,
        None => own.base,
    };
    Ok(own)
}

/// A solid of one material as a robot of one link.
///
/// - `mass`: kg; 0 for one without
pub fn solid(name: &str, shape: &Shape, mass: f64) -> Description {
    Description::of(LinkDescription {
        inertial: (mass > 0.0).then(|| shape.solid_inertia(mass)),
        collisions: vec![CollisionDescription {
            X_LG: Pose::IDENTITY,
            shape: shape.clone(),
            part: false,
            mesh: None,
            outline: None,
            bounds: None,
        }],
        visuals: vec![VisualDescription {
            X_LG: Pose::IDENTITY,
            shape: VisualShape::Solid(shape.clone()),
            color: None,
            texture: None,
            line: 0,
        }],
        ..LinkDescription::frame(name, Tag::default())
    })
}

/// Whether an object is nothing but a ground: links without mass that carry one large box whose top
/// is the plane z = 0, as `PyBullet`'s planes are. The world then has this ground, and a note says
/// so.
pub fn take_ground(
    name: &str,
    object: &ObjectSettings,
    description: &Description,
    world: &mut Settings,
) -> Option<Diagnostic> {
    let initial = &object.initial;
    let placed = initial.xy.iter().any(|x| *x != 0.0)
        || initial.z.is_some_and(|z| z != 0.0)
        || initial.rpy != Vec3::zeros();
    let welded = description
        .joints
        .iter()
        .all(|j| j.kind == JointKind::Fixed);
    let mass = |link: &LinkDescription| link.inertial.map_or(0.0, |inertial| inertial.mass);
    let still = object.fixed || description.stands_still;
    let light = still || description.links.iter().all(|link| mass(link) <= 0.0);
    let moved = object.driven || object.conveyor;
    if placed || !welded || !light || moved {
        return None;
    }
    let link = large_box(description)?;
    let plain = Settings::of(world.compat).world.ground.unwrap_or_default();
    let before = world.world.ground.clone().unwrap_or(plain);
    let own = &object.surface;
    let friction = own.friction.or(link.friction);
    let at_rest = link.static_friction.filter(|_| own.friction.is_none());
    let at_rest = own.static_friction.or(at_rest);
    let excess = friction.map(|friction| static_excess(friction, at_rest.unwrap_or(friction)));
    if own.static_friction.is_some() && excess == Some(None) {
        // An object, of which this is told.
        return None;
    }
    let ground = Ground {
        friction: friction.unwrap_or(before.friction),
        restitution: own
            .restitution
            .or(link.restitution)
            .unwrap_or(before.restitution),
        static_excess: excess.map_or(before.static_excess, |excess| excess.unwrap_or(0.0)),
        rolling_friction: own
            .rolling_friction
            .or(link.rolling_friction)
            .unwrap_or(before.rolling_friction),
        torsional_friction: own
            .torsional_friction
            .or(link.torsional_friction)
            .unwrap_or(before.torsional_friction),
    };
    let message = format!(
        "{} is nothing but a ground: it becomes that of the world, the plane z = 0 without an end, with the friction {}; its own picture is not drawn",
        called(RootKind::Object, name),
        ground.friction
    );
    let help = "leave it out to have the ground of [world] ground";
    world.world.ground = Some(ground);
    Some(finding(
        Severity::Note,
        "A134",
        object.place.clone(),
        message,
        help,
    ))
}

/// The link of the one collision shape, a large box with its top at z = 0.
fn large_box(description: &Description) -> Option<&LinkDescription> {
    let mut poses = vec![Pose::IDENTITY; description.links.len()];
    for joint in &description.joints {
        poses[joint.child] = poses[joint.parent].compose(&joint.X_PJ);
    }
    let links = description.links.iter().zip(&poses);
    let mut shapes = links.flat_map(|(l, X_WL)| l.collisions.iter().map(move |c| (l, X_WL, c)));
    let (link, X_WL, collision) = shapes.next()?;
    let Shape::Box { half } = collision.shape else {
        return None;
    };
    let X_WG = X_WL.compose(&collision.X_LG);
    let level = X_WG.R[(2, 2)].abs() > 1.0 - 1e-12;
    let top = X_WG.p.z + half.z;
    let large = half.x.min(half.y) >= 0.5 * GROUND_SIZE;
    (shapes.next().is_none() && level && large && top.abs() <= GROUND_SLACK).then_some(link)
}

/// Sets all that has no height of its own down on terrain; notes where that is.
fn set_down(model: &mut Model, settings: &Settings, guests: &[Guest]) -> Vec<Diagnostic> {
    if !has_terrain(model) {
        return Vec::new();
    }
    let above = model.world.ground.is_some();
    let all = std::iter::once(settings).chain(guests.iter().map(|guest| &guest.settings));
    let mut notes = Vec::new();
    for (index, own) in all.enumerate() {
        let root = &model.roots[index];
        let floats = model.bodies[root.body.index()].motion.kind().is_free();
        if own.initial.z.is_some() || !(floats || own.initial.stands) {
            continue;
        }
        let name = match guests.get(index.wrapping_sub(1)) {
            Some(guest) => called(guest.kind, &guest.name),
            None => "the robot".to_owned(),
        };
        let message = match terrain::set_down(model, index, above) {
            Some((link, ground)) => {
                let root = &mut model.roots[index];
                root.set_down = false;
                format!(
                    "{name} starts with its base at z = {:.6} m, where its link '{}' touches '{ground}'",
                    root.position.z,
                    model.links[link.index()].name
                )
            }
            None if above => continue,
            None => format!("{name} starts with its base at z = 0: there is no terrain below it"),
        };
        let help = "give it a z to start elsewhere";
        notes.push(finding(Severity::Note, "A111", None, message, help));
    }
    notes
}

/// Warnings of links that overlap at the start: of different trees, as those of one robot that do
/// are already kept apart.
fn warnings(model: &Model) -> impl Iterator<Item = Diagnostic> + '_ {
    overlaps(model).into_iter().map(|(pair, depth)| {
        let [a, b] = pair.map(|link| &model.links[link.index()].name);
        let message = format!(
            "links '{a}' and '{b}' overlap by {:.1} mm at the start and will push each other apart",
            1e3 * depth
        );
        let help = "place them apart, with xyz and rpy, or name both in [[ignore_contact]]";
        finding(Severity::Warning, "A135", None, message, help)
    })
}
