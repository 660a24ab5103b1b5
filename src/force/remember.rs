//! What the terms of a step remember after it.

use super::memory::{Memory, Touch};
use super::terms::{Solved, Terms};

impl Terms {
    /// What the terms remember after a step of `h` seconds that has been solved.
    pub fn remember(&self, solved: &Solved, h: f64, memory: &mut Memory) {
        self.pass_on(solved, h, memory);
        for term in &self.joints {
            if let Some(index) = term.actuator
                && let Some(wound) = term.wound_motor(solved.v[term.dof], h)
            {
                memory.motor[index] = wound;
            }
        }
    }

    /// The same for a step that goes on with other terms: its first stage.
    pub fn pass_on(&self, solved: &Solved, h: f64, memory: &mut Memory) {
        memory.touches.clear();
        let mut turns = self.turns.iter().zip(&solved.at.turns).peekable();
        let contacts = solved.at.contacts.iter().zip(&solved.responses.contacts);
        for (contact, (v, response)) in self.contacts.iter().zip(contacts) {
            let inside = response.depth > 0.0;
            let bounce = if inside { contact.bounce } else { 0.0 };
            let turn = turns.next_if(|(turn, _)| turn.slot == contact.slot);
            let turns = turn.is_some_and(|(turn, _)| turn.holds());
            if contact.friction.cap > 0.0 || turns || bounce > 0.0 {
                let angle = turn.map(|(turn, w)| turn.remembered(w, h));
                let (friction, u) = (&contact.friction, contact.slid(v));
                let rub = &response.friction;
                memory.touches.push(Touch {
                    slot: contact.slot,
                    displacement: contact.keep_slip(&friction.next_after(rub, u, h)),
                    turn: contact.keep(&angle.unwrap_or_default()),
                    bounce,
                    sliding: friction.sliding_after(rub, u, contact.wound, h),
                });
            }
        }
        for term in &self.joints {
            let v = solved.v[term.dof];
            if let Some(index) = term.actuator {
                memory.motor[index] = term.next_motor(v, h);
            }
            memory.dry[term.dof] = term.dry.next_under_falling_cap(v, h);
            memory.sliding[term.dof] = term.dry.sliding(v, term.wound, h);
        }
    }

    /// Makes a memory that of nothing that touches, and nothing that is stretched.
    pub fn forget(&self, memory: &mut Memory) {
        memory.touches.clear();
        for term in &self.joints {
            memory.dry[term.dof] = 0.0;
            memory.sliding[term.dof] = 1.0;
            if let Some(index) = term.actuator {
                memory.motor[index] = 0.0;
            }
        }
    }

    /// Drops what contacts without load remember.
    pub fn drop_unloaded(&self, memory: &mut Memory) {
        memory.touches.retain(|touch| {
            let slot = touch.slot;
            let mut contacts = self.contacts.iter();
            contacts.any(|c| c.slot == slot && c.friction.cap > 0.0)
                || self.turns.iter().any(|t| t.slot == slot && t.holds())
                || touch.bounce > 0.0
        });
    }
}
