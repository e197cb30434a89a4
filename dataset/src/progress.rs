//! Progress on stderr, with the time left: a bar where that is a terminal, else a plain line now and then.
//! The one way in which the project shows it.

mod gauge;

pub use gauge::Gauge;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle, TermLike};
use std::fmt::{self, Debug, Formatter};
use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Between two lines where stderr is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);
const BAR: &str = "{prefix} {bar:40} {pos}/{len}, {per_sec}, {left} left {msg}";
const LINE: &str = "{prefix} {pos}/{len}, {left} left {msg}";

/// A bar over `total` of something, of which `done` are done already, or lines that say the same. A bar's
/// message is shown at the end.
pub fn bar(what: &'static str, total: usize, done: usize) -> ProgressBar {
    bar_of(what, total, done, false)
}

/// As [`bar`]; where lines are written, the first of them `at_once` or only when the work takes long.
fn bar_of(what: &'static str, total: usize, done: usize, at_once: bool) -> ProgressBar {
    if io::stderr().is_terminal() {
        return styled(ProgressDrawTarget::stderr(), BAR, what, total, done);
    }
    let lines = if at_once { Lines::at_once } else { Lines::new };
    let bar = styled(lines(io::stderr(), LINE_EVERY).target(), LINE, what, total, done);
    if at_once {
        bar.tick();
    }
    bar
}

/// How long something takes, for people.
pub fn in_words(duration: Duration) -> String {
    let short = duration < Duration::from_secs(1);
    if short { "less than a second".to_owned() } else { HumanDuration(duration).to_string() }
}

fn styled(
    target: ProgressDrawTarget,
    template: &'static str,
    what: &'static str,
    total: usize,
    done: usize,
) -> ProgressBar {
    let left = move |state: &ProgressState, out: &mut dyn fmt::Write| {
        let (made, rest) =
            (state.pos().saturating_sub(done as u64), (total as u64).saturating_sub(state.pos()));
        // Nothing says how long the rest takes before something is made.
        let _ = match made {
            0 => out.write_str("?"),
            _ => out.write_str(&short_left(left(state.elapsed(), made, rest))),
        };
    };
    let style = ProgressStyle::with_template(template).expect("a valid template").with_key("left", left);
    let bar = ProgressBar::with_draw_target(Some(total as u64), target).with_prefix(what);
    let bar = bar.with_style(style).with_position(done as u64);
    bar.reset_eta();
    bar
}

/// How long the rest takes if it goes on as it went on the whole. What indicatif says of itself is by how
/// long the last pieces took, and grows without bound while a piece takes longer than those before.
fn left(elapsed: Duration, made: u64, rest: u64) -> Duration {
    elapsed.mul_f64(rest as f64 / made as f64)
}

/// How long the rest takes, in the unit that suits.
fn short_left(left: Duration) -> String {
    format!("{:#}", HumanDuration(left))
}

/// What draws a bar as lines, of which it leaves out those that come too soon after another.
struct Lines<W>(Mutex<LineWriter<W>>);

struct LineWriter<W> {
    out: W,
    every: Duration,
    /// When a line was written, or the bar began; nothing where the first line is to come at once.
    last: Option<Instant>,
    /// What is drawn.
    line: String,
}

impl<W: Write + Send + 'static> Lines<W> {
    fn new(out: W, every: Duration) -> Self {
        Self(Mutex::new(LineWriter { out, every, last: Some(Instant::now()), line: String::new() }))
    }

    /// Lines of which the first is written as soon as there is something to say.
    fn at_once(out: W, every: Duration) -> Self {
        Self(Mutex::new(LineWriter { out, every, last: None, line: String::new() }))
    }

    /// It draws once a second at most.
    fn target(self) -> ProgressDrawTarget {
        ProgressDrawTarget::term_like_with_hz(Box::new(self), 1)
    }
}

impl<W> Debug for Lines<W> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("Lines")
    }
}

impl<W: Write + Send + 'static> TermLike for Lines<W> {
    /// Lines are not wrapped.
    fn width(&self) -> u16 {
        u16::MAX
    }

    fn move_cursor_up(&self, _lines: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_down(&self, _lines: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_right(&self, _columns: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_left(&self, _columns: usize) -> io::Result<()> {
        Ok(())
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        self.write_str(text)
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).line.push_str(text);
        Ok(())
    }

    fn clear_line(&self) -> io::Result<()> {
        Ok(())
    }

    /// Writes what was drawn, if it is time to. Whether anybody reads it does not matter.
    fn flush(&self) -> io::Result<()> {
        let mut said = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let drawn = std::mem::take(&mut said.line);
        let line = drawn.trim();
        if !line.is_empty() && said.last.is_none_or(|last| last.elapsed() >= said.every) {
            said.last = Some(Instant::now());
            let _ = writeln!(said.out, "{line}");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// A writer whose text can be read meanwhile.
    #[derive(Clone, Default)]
    struct Text(Arc<Mutex<Vec<u8>>>);

    impl Write for Text {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().expect("no panic").write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// What is said of four frames that take 20 ms each, after one that was there.
    fn said(lines: fn(Text, Duration) -> Lines<Text>, every: Duration) -> String {
        let text = Text::default();
        let bar = styled(lines(text.clone(), every).target(), LINE, "frames", 5, 1);
        bar.tick();
        for _ in 0..4 {
            std::thread::sleep(Duration::from_millis(20));
            bar.set_message("of a hall");
            bar.inc(1);
        }
        bar.finish_and_clear();
        let bytes = text.0.lock().expect("no panic").clone();
        String::from_utf8(bytes).expect("text")
    }

    #[test]
    fn lines_say_what_is_done_and_how_long_the_rest_takes() {
        let text = said(Lines::new, Duration::ZERO);
        assert!(!text.is_empty() && !text.contains(['\r', '\x1b']), "{text:?}");
        for line in text.lines() {
            assert!(line.starts_with("frames ") && line.contains("/5, ") && line.contains(" left"), "{line}");
        }
    }

    #[test]
    fn lines_that_come_too_soon_are_left_out() {
        assert_eq!(said(Lines::new, Duration::from_secs(60)), "");
        assert!(said(Lines::new, Duration::from_millis(30)).lines().count() < 3);
        assert_eq!(said(Lines::at_once, Duration::from_secs(60)), "frames 1/5, ? left\n");
    }

    #[test]
    fn what_is_left_takes_as_long_as_what_is_done() {
        let minute = Duration::from_secs(60);
        assert_eq!([left(minute, 2, 8), left(minute, 8, 2)].map(short_left), ["4m", "15s"]);
    }

    #[test]
    fn waits_are_told_in_units_that_fit() {
        let words = |seconds: f64| in_words(Duration::from_secs_f64(seconds));
        assert_eq!([words(0.2), words(7.3)], ["less than a second", "7 seconds"]);
        assert_eq!([words(600.0), words(7.2e3)], ["10 minutes", "2 hours"]);
    }
}
