//! How far a training is: by its steps, or by the time that it has.

use super::{Lines, bar_of, left, short_left};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

const BAR: &str = "{prefix} {bar:40} {clock}, {rest} left, {msg}";
const LINE: &str = "{prefix} {clock}, {rest} left, {msg}";
/// The share of the time that is stated after which what the steps have taken says more about the end.
const SETTLED: f64 = 0.05;

/// What shows steps as they are done.
pub struct Gauge {
    bar: ProgressBar,
    steps: usize,
    /// Those that were done before.
    done: usize,
    began: Instant,
    time: Option<Time>,
}

/// The time that steps have.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Time {
    /// They end then, whether all are done or not.
    Until(Duration),
    /// They were chosen to take about as long, and all are done.
    About(Duration),
}

impl Gauge {
    /// A gauge by the number of `steps`, of which some are `done`.
    pub fn steps(steps: usize, done: usize) -> Self {
        Self { bar: bar_of("steps", steps, done, true), steps, done, began: Instant::now(), time: None }
    }

    /// A gauge by time for steps that end after `whole`, whether all are done or not.
    pub fn until(steps: usize, done: usize, whole: Duration) -> Self {
        Self::timed(steps, done, Time::Until(whole))
    }

    /// A gauge by time for steps that were chosen to take about `whole`.
    pub fn about(steps: usize, done: usize, whole: Duration) -> Self {
        Self::timed(steps, done, Time::About(whole))
    }

    fn timed(steps: usize, done: usize, time: Time) -> Self {
        let (target, template) = if io::stderr().is_terminal() {
            (ProgressDrawTarget::stderr(), BAR)
        } else {
            (Lines::at_once(io::stderr(), super::LINE_EVERY).target(), LINE)
        };
        let style = ProgressStyle::with_template(template).expect("a valid template");
        let style = style.with_key("clock", |state: &ProgressState, out: &mut dyn fmt::Write| {
            let _ = write!(out, "{} of {}", clock(state.pos()), clock(state.len().unwrap_or(0)));
        });
        let style = style.with_key("rest", |state: &ProgressState, out: &mut dyn fmt::Write| {
            let rest = state.len().unwrap_or(0).saturating_sub(state.pos());
            let _ = out.write_str(&short_left(Duration::from_millis(rest)));
        });
        let length = milliseconds(time.whole(Duration::ZERO, 0, 1));
        let bar = ProgressBar::with_draw_target(Some(length), target).with_prefix("training");
        let bar = bar.with_style(style).with_message(format!("step {done} of {steps}"));
        bar.tick();
        Self { bar, steps, done, began: Instant::now(), time: Some(time) }
    }

    /// Shows that `step` steps are done, with what is to be said of it.
    pub fn show(&self, step: usize, message: String) {
        let Some(time) = self.time else {
            self.bar.set_position(step as u64);
            return self.bar.set_message(message);
        };
        let elapsed = self.began.elapsed();
        let (made, rest) = (step.saturating_sub(self.done), self.steps.saturating_sub(step));
        self.bar.set_length(milliseconds(time.whole(elapsed, made, rest)));
        self.bar.set_position(milliseconds(elapsed));
        self.bar.set_message(format!("step {step} of {}, {message}", self.steps));
    }

    /// Leaves what was shown last.
    pub fn end(&self) {
        self.bar.abandon();
    }
}

impl Time {
    /// How long all steps take, of which so many were `made` since the beginning and `rest` are to come.
    fn whole(self, elapsed: Duration, made: usize, rest: usize) -> Duration {
        let (Self::Until(stated) | Self::About(stated)) = self;
        if made == 0 || (rest > 0 && elapsed < stated.mul_f64(SETTLED)) {
            return stated;
        }
        let by_steps = elapsed + left(elapsed, made as u64, rest as u64);
        if matches!(self, Self::Until(_)) { by_steps.min(stated) } else { by_steps }
    }
}

fn milliseconds(time: Duration) -> u64 {
    time.as_millis().try_into().unwrap_or(u64::MAX)
}

/// Milliseconds as a clock has them: minutes and seconds, and hours where there are some.
fn clock(milliseconds: u64) -> String {
    let seconds = milliseconds / 1000;
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    match hours {
        0 => format!("{minutes}:{seconds:02}"),
        _ => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_what_is_stated_until_steps_tell_it() {
        let [second, minute] = [1, 60].map(Duration::from_secs);
        let (until, about) = (Time::Until(10 * minute), Time::About(10 * minute));
        for time in [until, about] {
            assert_eq!(time.whole(Duration::ZERO, 0, 100), 10 * minute);
            // The first step takes long: whatever is compiled and rendered is waited for.
            assert_eq!(time.whole(20 * second, 1, 99), 10 * minute);
            // All are done before the time is up.
            assert_eq!(time.whole(2 * minute, 50, 50), 4 * minute);
            assert_eq!(time.whole(3 * second, 100, 0), 3 * second);
        }
        // Only one of them ends before all are done.
        assert_eq!(until.whole(5 * minute, 25, 75), 10 * minute);
        assert_eq!(about.whole(5 * minute, 25, 75), 20 * minute);
    }

    #[test]
    fn times_are_read_as_on_a_clock() {
        let times = [0, 9_400, 61_000, 3_599_999, 3_600_000, 90_061_000].map(clock);
        assert_eq!(times, ["0:00", "0:09", "1:01", "59:59", "1:00:00", "25:01:01"]);
    }
}
