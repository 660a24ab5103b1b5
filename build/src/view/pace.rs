//! How many steps are due, so that simulated time keeps up with real time.
//!
//! The steps that are due are counted from one instant and its step, the anchor, so that errors of
//! sleeping do not add up. Where the simulation cannot keep up, the anchor moves.

use std::time::{Duration, Instant};

/// Steps behind, beyond which the lost time is given up, s of real time.
const GIVEN_UP: f64 = 0.2;

/// Length of the window in which the factor is measured.
const WINDOW: Duration = Duration::from_millis(500);

/// Share of the speed asked for, below which a window is slow.
const SLOW: f64 = 0.97;

/// Slow windows in a row that are no accident: two seconds.
const SLOW_WINDOWS: u32 = 4;

/// Keeps time.
#[derive(Debug)]
pub struct Pace {
    /// s
    step: f64,
    speed: f64,
    anchor: (Instant, u64),
    window: (Instant, u64),
    factor: f64,
    slow: u32,
}

impl Pace {
    /// - `step`: s
    pub fn new(step: f64, now: Instant) -> Self {
        Self {
            step,
            speed: 1.0,
            anchor: (now, 0),
            window: (now, 0),
            factor: 0.0,
            slow: 0,
        }
    }

    /// Begins to run at step `done`.
    pub fn start(&mut self, now: Instant, done: u64) {
        self.anchor = (now, done);
        self.window = (now, done);
        self.slow = 0;
    }

    /// Simulated seconds for each second, as asked for.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Changes the speed; it is kept within what makes sense.
    pub fn set_speed(&mut self, speed: f64, now: Instant, done: u64) {
        if speed.is_finite() {
            self.speed = speed.clamp(0.01, 100.0);
            self.start(now, done);
        }
    }

    /// Simulated seconds for each second, as measured.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Steps that are due, of which `done` are done.
    pub fn due(&mut self, now: Instant, done: u64) -> u64 {
        let (moment, at) = self.anchor;
        let passed = now.saturating_duration_since(moment).as_secs_f64() * self.speed;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of steps, rounded down"
        )]
        let due = at + (passed / self.step) as u64;
        let behind = due.saturating_sub(done);
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        if behind as f64 * self.step / self.speed > GIVEN_UP {
            // Never to be caught up with: go on from here.
            self.anchor = (now, done);
            return 1;
        }
        behind
    }

    /// When step `done + ahead` is due.
    pub fn when(&self, done: u64, ahead: u64) -> Instant {
        let (moment, at) = self.anchor;
        #[expect(clippy::cast_precision_loss, reason = "a number of steps")]
        let seconds = (done + ahead - at) as f64 * self.step / self.speed;
        moment + Duration::from_secs_f64(seconds)
    }

    /// Measures the factor; call it now and then while running.
    pub fn measure(&mut self, now: Instant, done: u64) {
        let (moment, at) = self.window;
        let passed = now.saturating_duration_since(moment);
        if passed >= WINDOW {
            #[expect(clippy::cast_precision_loss, reason = "a number of steps")]
            let simulated = (done - at) as f64 * self.step;
            self.factor = simulated / passed.as_secs_f64();
            self.window = (now, done);
            self.slow = if self.factor < SLOW * self.speed {
                self.slow + 1
            } else {
                0
            };
        }
    }

    /// Whether the speed asked for has not been reached for some time.
    pub fn is_slow(&self) -> bool {
        self.slow >= SLOW_WINDOWS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 0.004;

    fn after(start: Instant, seconds: f64) -> Instant {
        start + Duration::from_secs_f64(seconds)
    }

    #[test]
    fn steps_are_counted_from_the_anchor_and_do_not_drift() {
        let start = Instant::now();
        let mut pace = Pace::new(STEP, start);
        let mut done = 0;
        for i in 1..=1000 {
            done += pace.due(after(start, 0.0173 * f64::from(i)), done);
        }
        // 17.3 s in steps of 4 ms.
        assert_eq!(done, 4325);
        assert_eq!(pace.when(done, 1), after(start, 4326.0 * STEP));
    }

    #[test]
    fn double_speed_needs_twice_the_steps() {
        let start = Instant::now();
        let mut pace = Pace::new(STEP, start);
        pace.set_speed(2.0, start, 0);
        assert_eq!(pace.due(after(start, 0.1001), 0), 50);
        pace.set_speed(f64::NAN, start, 0);
        pace.set_speed(1e9, start, 0);
        assert!((pace.speed() - 100.0).abs() < 1e-9);
    }

    #[test]
    fn time_that_is_lost_is_given_up_and_the_factor_says_so() {
        let start = Instant::now();
        let mut pace = Pace::new(STEP, start);
        assert_eq!(pace.due(after(start, 3.0), 0), 1);
        assert_eq!(pace.due(after(start, 3.0 + STEP + 1e-6), 1), 0);
        pace.start(start, 0);
        pace.measure(after(start, 1.0), 125);
        assert!((pace.factor() - 0.5).abs() < 1e-9 && !pace.is_slow());
        for second in 2_i32..=4 {
            pace.measure(
                after(start, f64::from(second)),
                125 * u64::from(second.unsigned_abs()),
            );
        }
        assert!(pace.is_slow());
        pace.measure(after(start, 5.0), 750);
        assert!(!pace.is_slow());
    }
}
