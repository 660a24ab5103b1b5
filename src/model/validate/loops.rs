//! Loops and springs.

use super::check::{Check, not_negative, number, pose, positive, require};
use crate::model::{Anchor, LoopKind, Model};
use std::collections::BTreeSet;

/// Most rows of all loops, and most springs: their matrix then takes 3 MB.
const MOST_ROWS: usize = 600;

#[cfg_attr(small, optimize(size))]
pub(super) fn validate(model: &Model) -> Check {
    let rows: usize = model.loops.iter().map(|part| part.kind.rows()).sum();
    require(
        rows <= MOST_ROWS && model.springs.len() <= MOST_ROWS,
        || "the model".to_owned(),
        "has loops of more than 600 rows, or more than 600 springs",
    )?;
    let mut names = BTreeSet::new();
    for closure in &model.loops {
        let part = || format!("loop '{}'", closure.name);
        let new = names.insert(closure.name.as_str());
        require(new, part, "has the name of another loop")?;
        match &closure.kind {
            LoopKind::Coupler { terms, sum } => {
                let sound = terms.iter().all(|term| {
                    number(term.factor)
                        && term.factor != 0.0
                        && term.joint.index() < model.joints.len()
                        && model.scalar_body(term.joint).is_some()
                });
                require(
                    sound && !terms.is_empty() && sum.is_none_or(number),
                    part,
                    "couples no joints, joints that neither turn nor slide, or with factors of 0",
                )?;
            }
            kind => {
                if let LoopKind::Distance { length, .. } = kind {
                    require(positive(*length), part, "has a length of 0 or less")?;
                }
                if let Some(ends) = kind.ends() {
                    anchors(model, ends, part)?;
                }
            }
        }
    }
    let mut names = BTreeSet::new();
    for spring in &model.springs {
        let part = || format!("spring '{}'", spring.name);
        let new = names.insert(spring.name.as_str());
        require(new, part, "has the name of another spring")?;
        let numbers = [spring.length, spring.stiffness, spring.damping];
        require(
            numbers.into_iter().all(not_negative),
            part,
            "has a length, stiffness or damping that is not finite or negative",
        )?;
        anchors(model, &spring.ends, part)?;
    }
    Ok(())
}

/// Ends exist, and lie on bodies that move against each other.
fn anchors(model: &Model, ends: &[Anchor; 2], part: impl Fn() -> String + Copy) -> Check {
    for anchor in ends {
        let exists = anchor.link.is_none_or(|l| l.index() < model.links.len());
        require(exists, part, "hangs on a link that does not exist")?;
        pose(&anchor.X_LA, part)?;
    }
    let bodies = ends.each_ref().map(|anchor| {
        let body = model.links[anchor.link?.index()].body;
        model.bodies[body.index()]
            .motion
            .kind()
            .moves()
            .then_some(body)
    });
    let apart = bodies[0] != bodies[1];
    require(apart, part, "joins what does not move against each other")
}
