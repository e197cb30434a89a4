//! Progress on stderr, with the time left, where stderr is a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar over `total` of something, of which `done` are done already.
pub fn bar(what: &'static str, total: usize, done: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {bar:40} {pos}/{len}, {per_sec}, {eta} left");
    let bar = ProgressBar::new(total as u64).with_message(what).with_position(done as u64);
    bar.set_style(style.expect("a valid template"));
    bar.reset_eta();
    bar
}
