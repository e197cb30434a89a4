//! What is measured now, and about how long is left.

use std::time::Instant;

/// Steps of known shares of the whole.
pub struct Progress {
    began: Instant,
    /// Names, and what each takes, seconds of a machine of two cores.
    steps: Vec<(&'static str, f64)>,
    begun: usize,
}

impl Progress {
    /// None of these steps has begun.
    pub fn new(steps: Vec<(&'static str, f64)>) -> Self {
        Self { began: Instant::now(), steps, begun: 0 }
    }

    /// The next one begins.
    pub fn next(&mut self) {
        let elapsed = self.began.elapsed().as_secs_f64();
        let seconds = |steps: &[(&str, f64)]| steps.iter().map(|(_, seconds)| seconds).sum::<f64>();
        let (done, left) = self.steps.split_at(self.begun);
        let speed = if done.is_empty() { 1.0 } else { elapsed / seconds(done).max(1e-3) };
        let minutes = speed * seconds(left) / 60.0;
        note!("{}; about {:.0} minutes left", left.first().map_or("", |(name, _)| name), minutes.ceil());
        self.begun += 1;
    }
}
