//! Whether the same acts throughout a step: rims lean alike, contacts press, motors yield.

use super::{GAMMA, Stages};
use crate::force::{JointTerm, Response};
use crate::spatial::Vec3;
use crate::state::Physical;
use crate::tuning::ACROSS;

impl Stages {
    /// Whether a rim leans to another side in one of the stages up to `last` than in another or
    /// where the step begins: its load crosses the face, and two stages would throw it to and fro.
    /// A load that stays near the middle of the face is not thrown: there the rim is as smooth as
    /// its crown. The loads' places are `a/q` from that middle, in radii.
    pub(super) fn flips(&self, last: usize) -> bool {
        let [first, second] = self.solved.each_ref().map(|s| &s.responses.points);
        let starts = self.terms[0].contacts.points.iter().enumerate();
        let mut rims = starts.filter_map(|(i, point)| Some((i, point.rim.as_ref()?)));
        rims.any(|(i, rim)| {
            let across = |from: &Vec3, to: &Vec3| from.dot(to) < -ACROSS;
            let (start, one) = (rim.place(), first[i].end.0);
            across(&start, &one)
                || last > 0 && {
                    let two = second[i].end.0;
                    across(&start, &two) || across(&one, &two)
                }
        })
    }

    /// Whether a contact or a limit presses in one of the stages of `eta` seconds up to `last` and
    /// not in another, or not where the step begins, or friction that has ended a slip in the first
    /// stage slips the other way in the second. That stage begins beyond the first, with the slip
    /// turned around; friction that sticks ends this, too, but not where the load is gone by then.
    pub(super) fn changes(&self, last: usize, eta: f64) -> bool {
        let [first, second] = self.solved.each_ref().map(|s| &s.responses.contacts);
        let turns = |one: &Response, two: &Response| {
            two.slips() && one.friction.force.dot(&two.friction.force) < 0.0
        };
        let mut contacts = self.terms[0].contacts.iter().enumerate();
        contacts.any(|(i, contact)| {
            let one = first[i].presses();
            one != (contact.depth > 0.0)
                || last > 0 && (one != second[i].presses() || turns(&first[i], &second[i]))
        }) || self.leaves_limit(last, eta)
    }

    /// Whether a limit of a joint acts in one of the stages of `eta` seconds up to `last` and not
    /// in another, or not where the step begins.
    fn leaves_limit(&self, last: usize, eta: f64) -> bool {
        let [first, second] = &self.solved;
        let [before, terms] = &self.terms;
        before.joints.iter().zip(&terms.joints).any(|(one, two)| {
            let [start, first, second] = [
                one.gap.map(|gap| gap < 0.0),
                one.at_limits(first.v[one.dof], eta),
                two.at_limits(second.v[two.dof], eta),
            ];
            first != start || last > 0 && first != second
        })
    }

    /// Whether a motor yields at the start of the step of `h` seconds or in one stage, and does not
    /// everywhere.
    pub fn yields(&self, from: &Physical, h: f64) -> bool {
        let [first, second] = &self.solved;
        let [before, terms] = &self.terms;
        before.joints.iter().zip(&terms.joints).any(|(one, two)| {
            let yields = |term: &JointTerm, v: &[f64]| {
                let (_, slope) = term.drive_force(v[term.dof], GAMMA * h);
                slope.abs() <= 0.0
            };
            let start = yields(one, &from.v);
            start != yields(one, &first.v) || start != yields(two, &second.v)
        })
    }
}
