//! Why a simulation was slower than real time, and which setting helps.

use crate::events::moment;
use crate::info::short;
use crate::progress::times;
use std::fmt::Write as _;
use std::time::Duration;

/// Least simulated time that is judged, s; a shorter run is judged as a whole.
const LENGTH: f64 = 0.5;

/// Least time by the clock that is judged, s: below it nobody waits.
const NOTICED: f64 = 0.2;

/// Solver steps in a communication step from which on their number is what costs.
const MANY: f64 = 2.0;

/// The usual tolerance: smaller ones are asked for.
const USUAL_TOLERANCE: f64 = 1e-3;

/// The largest tolerance that is advised; beyond it robots visibly sink and slide.
const LARGEST_TOLERANCE: f64 = 1e-2;

/// The usual communication step, s, with a little room.
const USUAL_INTERVAL: f64 = 0.004;

/// Corners of a collision mesh from which on a simpler shape is advised.
const MANY_CORNERS: usize = 100;

/// Links that are named.
const NAMED: usize = 3;

/// A simulation and how long its steps took.
#[derive(Debug)]
pub struct Costs<'c> {
    /// s, of all rows.
    pub time: &'c [f64],
    /// For each row but the first.
    pub took: &'c [Duration],
    /// Solver steps since the start, accepted and rejected, where the FMU tells.
    pub steps: Option<[&'c [f64]; 2]>,
    /// Links that can touch.
    pub contacts: Vec<Touching<'c>>,
    /// Of the solver, s; 0 for error control.
    pub step_size: f64,
    /// Relative tolerance of error control.
    pub tolerance: f64,
}

/// A link that can touch.
#[derive(Clone, Copy, Debug)]
pub struct Touching<'c> {
    /// Its name.
    pub link: &'c str,
    /// Corners of its collision meshes.
    pub corners: usize,
    /// Whether it touched, 0 or 1.
    pub active: &'c [f64],
}

/// Rows from one to another, and how many times longer than real time they took.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slow {
    from: usize,
    to: usize,
    ratio: f64,
}

impl Costs<'_> {
    /// What to tell about the slowest part of the run, if it was slower than real time.
    pub fn hint(&self) -> Option<String> {
        let slow = self.slowest()?;
        let (from, to) = (self.time[slow.from], self.time[slow.to]);
        let mut text = format!(
            "from {} to {} the simulation took {} times real time.",
            moment(from),
            moment(to),
            times(slow.ratio)
        );
        #[expect(clippy::cast_precision_loss, reason = "a number of rows")]
        let count = (slow.to - slow.from) as f64;
        if let Some([accepted, rejected]) = self.steps {
            let each = |column: &[f64]| (column[slow.to] - column[slow.from]) / count;
            let interval = (to - from) / count;
            let seconds = count * slow.ratio * interval;
            text += &self.reason(each(accepted), each(rejected), interval, seconds / count);
        }
        text += &self.touching(slow);
        Some(text)
    }

    /// The slowest part, if it is slower than real time and not by a few steps alone: those are the
    /// machine's.
    fn slowest(&self) -> Option<Slow> {
        let mut slowest: Option<Slow> = None;
        let (mut from, mut took, mut slow) = (0, 0.0, 0_usize);
        let lasted = |row: usize| self.time[row] - self.time[row - 1];
        let seconds = |row: usize| self.took[row - 1].as_secs_f64();
        let whole = self.time.last()? - self.time[0];
        for to in 1..self.time.len().min(self.took.len() + 1) {
            took += seconds(to);
            slow += usize::from(seconds(to) > lasted(to));
            // The shortest part that is long enough and ends here.
            while self.time[to] - self.time[from + 1] >= LENGTH {
                from += 1;
                took -= seconds(from);
                slow -= usize::from(seconds(from) > lasted(from));
            }
            let length = self.time[to] - self.time[from];
            let ratio = took / length;
            let judged = length >= LENGTH.min(whole) && took >= NOTICED && 2 * slow >= to - from;
            if judged && ratio > slowest.map_or(1.0, |s| s.ratio) {
                slowest = Some(Slow { from, to, ratio });
            }
        }
        slowest
    }

    /// What the solver did in each communication step, and what would change it.
    ///
    /// - `accepted`, `rejected`: solver steps
    /// - `interval`: of communication, s; `seconds`: by the clock
    fn reason(&self, accepted: f64, rejected: f64, interval: f64, seconds: f64) -> String {
        let steps = accepted + rejected;
        let step = format!("communication step of {} s", short(interval));
        if self.step_size > 0.0 && steps >= MANY {
            return format!(
                " Each {step} took {steps:.0} solver steps, because solver.step_size is {} s; a \
                 longer one takes fewer, and 0 chooses them by the error.",
                short(self.step_size)
            );
        }
        if steps >= MANY {
            let tolerance = self.tolerance;
            let advised = if tolerance < USUAL_TOLERANCE {
                USUAL_TOLERANCE
            } else {
                LARGEST_TOLERANCE
            };
            let mut text = format!(
                " Each {step} took {accepted:.1} solver steps and {rejected:.1} rejected ones, for \
                 a tolerance of {}.",
                short(tolerance)
            );
            if advised > tolerance {
                _ = write!(text, " Fewer do with --tolerance {}, or", short(advised));
            } else {
                text += " Fewer do";
            }
            _ = write!(
                text,
                " with fixed steps: --start-value solver.step_size {}.",
                short(interval)
            );
            return text;
        }
        let each = Duration::from_secs_f64(seconds);
        let mut text = format!(" Each {step} took about one solver step, and that {each:.1?}.");
        if interval < USUAL_INTERVAL {
            text += " A longer --output-interval takes fewer.";
        }
        text
    }

    /// Links that touched at least half of the time.
    fn touching(&self, slow: Slow) -> String {
        let rows = slow.from + 1..=slow.to;
        let half = (slow.to - slow.from).div_ceil(2);
        let often = |link: &&Touching| {
            let active = rows.clone().filter(|&i| link.active[i] > 0.5);
            active.count() >= half
        };
        let links: Vec<&Touching> = self.contacts.iter().filter(often).collect();
        if links.is_empty() {
            return String::new();
        }
        let named = links.iter().take(NAMED);
        let named: Vec<String> = named.map(|link| format!("'{}'", link.link)).collect();
        let more = match links.len() - named.len() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let mut text = format!(
            " Meanwhile there was contact at {}{more}.",
            named.join(", ")
        );
        let most = links.iter().max_by_key(|link| link.corners);
        if let Some(link) = most.filter(|link| link.corners >= MANY_CORNERS) {
            _ = write!(
                text,
                " The collision mesh of '{}' has {} corners; a box, cylinder or sphere costs less.",
                link.link, link.corners
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `n` steps of 0.01 s, each of which takes what `took` says, in milliseconds.
    fn run(n: u32, took: impl Fn(u32) -> u64) -> (Vec<f64>, Vec<Duration>) {
        let time = (0..=n).map(|i| 0.01 * f64::from(i)).collect();
        let took = (0..n).map(|i| Duration::from_millis(took(i))).collect();
        (time, took)
    }

    fn costs<'c>(time: &'c [f64], took: &'c [Duration]) -> Costs<'c> {
        Costs {
            time,
            took,
            steps: None,
            contacts: Vec::new(),
            step_size: 0.0,
            tolerance: 1e-3,
        }
    }

    #[test]
    fn the_slowest_part_is_found_and_nothing_where_real_time_is_held() {
        let (time, took) = run(300, |i| if (150..210).contains(&i) { 25 } else { 1 });
        let slow = costs(&time, &took).slowest().expect("a slow part");
        assert!(slow.from >= 150 && slow.to <= 210, "{slow:?}");
        assert!((slow.ratio - 2.5).abs() < 1e-9, "{slow:?}");
        let (time, took) = run(300, |_| 9);
        assert_eq!(costs(&time, &took).slowest(), None);
        assert_eq!(costs(&time[..1], &[]).slowest(), None);
    }

    #[test]
    fn a_few_long_steps_are_the_machines_and_short_waits_are_nobodys() {
        let (time, took) = run(300, |i| if i % 50 == 0 { 900 } else { 1 });
        assert_eq!(costs(&time, &took).slowest(), None);
        let (time, took) = run(9, |_| 20);
        assert_eq!(costs(&time, &took).slowest(), None);
        // A short run that is waited for is judged as a whole.
        let (time, took) = run(9, |_| 200);
        let slow = costs(&time, &took).slowest().expect("a slow run");
        assert_eq!((slow.from, slow.to), (0, 9));
    }

    #[test]
    fn the_hint_names_what_costs_and_which_setting_helps() {
        let (time, took) = run(100, |_| 20);
        let count = |each: f64| -> Vec<f64> { (0..=100).map(|i| each * f64::from(i)).collect() };
        let (accepted, rejected) = (count(12.0), count(3.0));
        let touching = vec![1.0; 101];
        let mut costs = costs(&time, &took);
        costs.steps = Some([&accepted, &rejected]);
        costs.contacts = vec![Touching {
            link: "foot",
            corners: 412,
            active: &touching,
        }];
        let text = costs.hint().expect("slow");
        for words in [
            "took 2.00 times real time",
            "12.0 solver steps and 3.0 rejected ones, for a tolerance of 0.001",
            "--tolerance 0.01, or with fixed steps: --start-value solver.step_size 0.01",
            "contact at 'foot'. The collision mesh of 'foot' has 412 corners",
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
        costs.tolerance = 1e-6;
        assert!(costs.hint().expect("slow").contains("--tolerance 0.001"));
        costs.step_size = 1e-4;
        assert!(
            costs
                .hint()
                .expect("slow")
                .contains("solver.step_size is 0.0001 s")
        );
        let one = count(1.0);
        let none = count(0.0);
        costs.steps = Some([&one, &none]);
        costs.step_size = 0.0;
        let text = costs.hint().expect("slow");
        assert!(
            text.contains("about one solver step, and that 20.0ms"),
            "{text}"
        );
    }
}
