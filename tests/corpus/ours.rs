//! What becomes of a URDF here: read, assembled with the default settings, stepped.

use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_core::urdf::{Diagnostic, ReadOptions, Severity};
use urdf2fmu_core::{assemble, urdf};

/// Communication steps.
pub const STEPS: u32 = 100;
/// s
const STEP: f64 = 1.0 / 240.0;

/// What became of the file: `fate` is `loaded`, `refused` (with the errors), or `failed` (with the reason).
pub fn judge(path: &Path) -> Value {
    let description = match urdf::read(path, &ReadOptions::from_environment()) {
        Ok(description) => description,
        Err(findings) => return json!({"fate": "refused", "errors": errors(&findings)}),
    };
    let model = match assemble::build(&description, &Settings::default()) {
        Ok(assembled) => assembled.model,
        Err(findings) => return json!({"fate": "refused", "errors": errors(&findings)}),
    };
    let mut told = contents(&model);
    told["fate"] = "loaded".into();
    if let Err(reason) = run(model) {
        told["fate"] = "failed".into();
        told["reason"] = reason.into();
    }
    told
}

/// Code, line and message of the errors among the findings.
fn errors(findings: &[Diagnostic]) -> Vec<Value> {
    findings
        .iter()
        .filter(|finding| finding.severity == Severity::Error)
        .map(|finding| {
            let line = finding.place.as_ref().map(|place| place.line);
            json!({"code": finding.code, "line": line, "message": finding.message})
        })
        .collect()
}

/// Links, joints, collision shapes by link and masses by link, as the solver has them.
fn contents(model: &Model) -> Value {
    let mut colliders = serde_json::Map::new();
    for collider in &model.colliders {
        let count = colliders
            .entry(&model.links[collider.link.index()].name)
            .or_insert_with(|| 0.into());
        *count = (count.as_u64().unwrap_or(0) + 1).into();
    }
    let joints: serde_json::Map<_, _> = model
        .joints
        .iter()
        .map(|joint| {
            let kind = serde_json::to_value(joint.kind).expect("a kind is a word");
            let told = json!({
                "type": kind, "parent": model.links[joint.parent.index()].name,
                "child": model.links[joint.child.index()].name, "axis": joint.axis.as_slice(),
                "limits": joint.limits.map(|l| [l.lower, l.upper]), "effort": joint.effort,
                "velocity": joint.velocity, "damping": joint.damping, "friction": joint.friction,
            });
            (joint.name.clone(), told)
        })
        .collect();
    let masses: serde_json::Map<_, _> = model
        .links
        .iter()
        .filter(|link| link.inertia.mass > 0.0)
        .map(|link| (link.name.clone(), link.inertia.mass.into()))
        .collect();
    let links: Vec<_> = model.links.iter().map(|link| &link.name).collect();
    json!({"links": links, "joints": joints, "colliders": colliders, "masses": masses})
}

/// Steps it; an error if it stops or a number of the state is not finite.
fn run(model: Model) -> Result<(), String> {
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.initialize(0.0).map_err(|e| e.to_string())?;
    for k in 1..=STEPS {
        simulation
            .advance_to(f64::from(k) * STEP)
            .map_err(|e| format!("step {k}: {e}"))?;
        let state = simulation.state();
        if !state.q.iter().chain(&state.v).all(|x| x.is_finite()) {
            return Err(format!("step {k}: a number is not finite"));
        }
    }
    Ok(())
}
