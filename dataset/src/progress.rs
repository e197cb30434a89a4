//! Progress on stderr, with the time left, where stderr is a terminal: the one way in which the project shows it.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar over `total` of something, of which `done` are done already. Its message is shown at the end.
pub fn bar(what: &'static str, total: usize, done: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix} {bar:40} {pos}/{len}, {per_sec}, {eta} left {msg}");
    let bar = ProgressBar::new(total as u64).with_prefix(what).with_position(done as u64);
    bar.set_style(style.expect("a valid template"));
    bar.reset_eta();
    bar
}
