//! What a run shows while it goes on: a bar on a terminal, a line now and then elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Time between lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

/// Shows steps, loss, images per second and the time left, on stderr.
pub struct Display {
    bar: ProgressBar,
    steps: usize,
    began: (Instant, usize),
    last_line: Instant,
}

impl Display {
    /// A display of a run of `steps` that goes on from a step.
    pub fn new(step: usize, steps: usize) -> Self {
        let bar = ProgressBar::new(steps as u64).with_position(step as u64);
        let style =
            ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {msg}").expect("a valid template");
        bar.set_style(style);
        Self { bar, steps, began: (Instant::now(), step), last_line: Instant::now() }
    }

    /// Shows a step.
    pub fn show(&mut self, step: usize, loss: f32, validation: Option<f32>, images_per_second: f64) {
        let seconds = self.began.0.elapsed().as_secs_f64() / (step - self.began.1).max(1) as f64;
        let left = Duration::from_secs_f64(seconds * (self.steps - step) as f64);
        let validation = validation.map_or(String::new(), |loss| format!(", best validation {loss:.4}"));
        let message = format!(
            "loss {loss:.4}{validation}, {images_per_second:.1} images/s, {} left",
            indicatif::HumanDuration(left)
        );
        self.bar.set_position(step as u64);
        if self.bar.is_hidden() && self.last_line.elapsed() > LINE_EVERY {
            eprintln!("step {step}/{}: {message}", self.steps);
            self.last_line = Instant::now();
        }
        self.bar.set_message(message);
    }

    /// Leaves the last state on the screen.
    pub fn finish(&self) {
        self.bar.abandon();
    }
}
