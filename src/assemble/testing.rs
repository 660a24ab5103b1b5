//! Descriptions made in code, for tests.

use super::{Assembled, build};
use crate::diagnostic::Diagnostic;
use crate::geometry::Shape;
use crate::model::{JointKind, Limits, Model};
use crate::settings::Settings;
use crate::spatial::{Pose, RigidInertia, Vec3};
use crate::urdf::{CollisionDescription, Description, JointDescription, LinkDescription, Tag};

/// A robot with a root link alone.
pub(crate) fn robot(root: LinkDescription) -> Description {
    Description {
        name: "test".into(),
        sources: vec!["test.urdf".into()],
        ..Description::of(root)
    }
}

/// Where a tag stands of which only the line is known.
fn line(line: usize) -> Tag {
    Tag {
        line,
        ..Tag::default()
    }
}

/// A frame without mass and shape.
pub(crate) fn frame(name: &str) -> LinkDescription {
    LinkDescription::frame(name, line(7))
}

/// A ball of `mass` kg and 0.1 m radius that touches nothing.
pub(crate) fn mass(name: &str, mass: f64) -> LinkDescription {
    LinkDescription {
        inertial: Some(ball().solid_inertia(mass)),
        ..frame(name)
    }
}

/// The same with a collision shape.
pub(crate) fn body(name: &str, m: f64) -> LinkDescription {
    LinkDescription {
        collisions: vec![collision(Pose::IDENTITY, ball())],
        ..mass(name, m)
    }
}

pub(crate) fn ball() -> Shape {
    Shape::Sphere { radius: 0.1 }
}

pub(crate) fn collision(X_LG: Pose, shape: Shape) -> CollisionDescription {
    CollisionDescription {
        X_LG,
        shape,
        mesh: None,
        outline: None,
        bounds: None,
        part: false,
    }
}

pub(crate) fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_xyz_rpy(Vec3::new(x, y, z), Vec3::zeros())
}

impl Description {
    /// Adds a link on a joint along or about z; both are placed after those there are.
    pub(crate) fn with(
        mut self,
        parent: &str,
        joint: &str,
        kind: JointKind,
        X_PJ: Pose,
        link: LinkDescription,
    ) -> Self {
        let parent = self.links.iter().position(|l| l.name == parent);
        self.joints.push(JointDescription {
            name: joint.into(),
            kind,
            parent: parent.expect("the parent link"),
            child: self.links.len(),
            X_PJ,
            axis: Vec3::z(),
            limits: matches!(kind, JointKind::Revolute | JointKind::Prismatic).then_some(Limits {
                lower: -1.0,
                upper: 2.0,
            }),
            effort: Some(10.0),
            velocity: Some(5.0),
            damping: 0.0,
            friction: 0.0,
            armature: 0.0,
            interfaces: Vec::new(),
            mimic: None,
            tag: line(9),
        });
        self.links.push(link);
        self
    }

    /// Changes the joint added last.
    pub(crate) fn and(mut self, change: impl FnOnce(&mut JointDescription)) -> Self {
        change(self.joints.last_mut().expect("a joint"));
        self
    }

    /// The joint added last mimics another one.
    pub(crate) fn mimicking(self, joint: &str, multiplier: f64, offset: f64) -> Self {
        self.and(|j| j.mimic = Some((joint.into(), multiplier, offset)))
    }
}

/// Builds with the settings of a TOML text; what comes out must be valid and survive being written
/// and read.
pub(crate) fn assembled(description: &Description, settings: &str) -> Assembled {
    let settings = Settings::parse(settings, "test.toml").expect("legal settings");
    let assembled = build(description, &settings).unwrap_or_else(|findings| {
        panic!("{}", texts(&findings).join("\n"));
    });
    assert!(assembled.model.validate().is_ok());
    let text = serde_json::to_string(&assembled.model).expect("JSON");
    let back: Model = serde_json::from_str(&text).expect("a model");
    assert_eq!(back, assembled.model);
    assembled
}

pub(crate) fn model(description: &Description, settings: &str) -> Model {
    assembled(description, settings).model
}

/// The errors of a build that fails.
pub(crate) fn errors(description: &Description, settings: &str) -> Vec<Diagnostic> {
    let settings = Settings::parse(settings, "test.toml").expect("legal settings");
    let mut findings = build(description, &settings).expect_err("a robot that cannot be built");
    findings.retain(|d| d.severity == crate::diagnostic::Severity::Error);
    findings
}

/// The only error of a build that fails.
pub(crate) fn error(description: &Description, settings: &str) -> Diagnostic {
    let mut errors = errors(description, settings);
    assert_eq!(errors.len(), 1, "{}", texts(&errors).join("\n"));
    errors.remove(0)
}

pub(crate) fn texts(findings: &[Diagnostic]) -> Vec<String> {
    findings
        .iter()
        .map(|d| format!("{} {} ({:?})", d.code, d.message, d.help))
        .collect()
}

/// The only finding with a code.
pub(crate) fn note(assembled: &Assembled, code: &str) -> Diagnostic {
    let mut found: Vec<_> = assembled
        .diagnostics
        .iter()
        .filter(|d| d.code == code)
        .cloned()
        .collect();
    assert_eq!(
        found.len(),
        1,
        "{code}: {}",
        texts(&assembled.diagnostics).join("\n")
    );
    found.remove(0)
}

pub(crate) fn has(assembled: &Assembled, code: &str) -> bool {
    assembled.diagnostics.iter().any(|d| d.code == code)
}

/// A point mass.
pub(crate) fn point(name: &str, m: f64, com: Vec3) -> LinkDescription {
    LinkDescription {
        inertial: Some(RigidInertia {
            mass: m,
            com,
            ..RigidInertia::ZERO
        }),
        ..frame(name)
    }
}
