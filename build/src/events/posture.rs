//! Falls of a floating base.

use super::run::{Event, Run, TOLD, moment};
use std::fmt::Write as _;
use urdf2fmu_core::spatial::Vec3;
use urdf2fmu_drawing::scene;

/// Tilt from which on a robot lies, degrees.
const FALLEN: f64 = 60.0;

/// Tilt below which it stands again, degrees; the gap keeps one fall from counting twice.
const UPRIGHT: f64 = 30.0;

struct Fall {
    /// s
    begin: f64,
    /// Greatest tilt, degrees, and when, s.
    most: (f64, f64),
    /// When it stood again, s.
    end: Option<f64>,
}

/// Times at which the base tilted from the direction that was up in the first row.
pub(super) fn falls(run: &Run) -> Vec<Event> {
    let names = &run.head.base().orientation.variables;
    let Some(columns) = run.all(names).filter(|columns| columns.len() == 4) else {
        return Vec::new();
    };
    let mut falls: Vec<Fall> = Vec::new();
    // The direction that was up, in the base's axes.
    let mut up: Option<Vec3> = None;
    for (row, &time) in run.time.iter().enumerate() {
        let q = [0, 1, 2, 3].map(|i| columns[i][row]);
        if q.iter().any(|x| !x.is_finite()) {
            continue;
        }
        let turned = scene::pose(&[0.0; 3], &q).R;
        let up = *up.get_or_insert_with(|| turned.transpose() * Vec3::z());
        let tilt = libm::acos((turned * up).z.clamp(-1.0, 1.0)).to_degrees();
        match falls.last_mut().filter(|fall| fall.end.is_none()) {
            Some(fall) => {
                if tilt > fall.most.0 {
                    fall.most = (tilt, time);
                }
                fall.end = (tilt < UPRIGHT).then_some(time);
            }
            None if tilt > FALLEN => falls.push(Fall {
                begin: time,
                most: (tilt, time),
                end: None,
            }),
            None => {}
        }
    }
    told(&falls)
}

fn told(falls: &[Fall]) -> Vec<Event> {
    let mut events: Vec<Event> = falls.iter().take(TOLD).map(sentence).collect();
    if let [first, .., last] = &falls[falls.len().min(TOLD)..] {
        events.push(Event {
            time: first.begin,
            text: format!(
                "Fell over {} more times, the last time at {}.",
                falls.len() - TOLD,
                moment(last.begin)
            ),
        });
    } else if let Some(last) = falls.get(TOLD) {
        events.push(sentence(last));
    }
    events
}

fn sentence(fall: &Fall) -> Event {
    let Fall { begin, most, end } = fall;
    let mut text = format!(
        "Fell over at {}: the base tilted by more than {FALLEN}° from how it started, and by {:.0}° \
         at most, at {}.",
        moment(*begin),
        most.0,
        moment(most.1)
    );
    if let Some(end) = end {
        _ = write!(
            text,
            " It was upright again, within {UPRIGHT}°, at {}.",
            moment(*end)
        );
    }
    Event { time: *begin, text }
}
