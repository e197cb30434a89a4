//! Ctrl-C, and what a scheduler sends before it takes a machine away: the program says that nothing is lost
//! and ends with the code that shells give it, 130 or 143.
//!
//! Nothing has to be put in order first. Whatever is written is written so that a kill at any moment does no
//! harm (`shaders::atomic_file`, the journal, checkpoints); the same command goes on from there. A training
//! keeps more than that: it is asked to end after the step that it is at, and ended by the second signal.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::sync::{Mutex, PoisonError};

/// Shells add this to a signal's number.
#[cfg(unix)]
const BY_SIGNAL: i32 = 128;

/// Asks work to end soon; whether it will.
type Ask = Box<dyn Fn() -> bool + Send>;

/// What is asked first, where there is something.
static ASKED: Mutex<Option<Ask>> = Mutex::new(None);

/// Work that has ended because it was asked to, and what it has kept.
#[derive(Debug)]
#[cfg_attr(not(feature = "train"), allow(dead_code, reason = "training alone is asked"))]
pub struct Interrupted {
    /// What it has kept, in words.
    pub kept: String,
}

impl Display for Interrupted {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.kept)
    }
}

impl Error for Interrupted {}

impl Interrupted {
    /// The code that the program ends with.
    pub fn code(&self) -> u8 {
        #[cfg(unix)]
        return unix::code();
        #[cfg(not(unix))]
        return 1;
    }
}

/// From now on the first signal asks work to end soon; where it says that it will not, and the second time,
/// it ends the program as it does without this.
#[cfg_attr(not(feature = "train"), allow(dead_code, reason = "training alone is asked"))]
pub fn ask_first(ask: impl Fn() -> bool + Send + 'static) {
    *ASKED.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(ask));
}

/// Watches for such signals from now on. Elsewhere than on Unix the system's own way stays.
pub fn watch() {
    #[cfg(unix)]
    unix::watch();
}

#[cfg(unix)]
mod unix {
    use super::{ASKED, BY_SIGNAL};
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::exit;
    use std::fs::File;
    use std::io::Write;
    use std::os::fd::AsFd;
    use std::sync::PoisonError;
    use std::sync::atomic::{AtomicI32, Ordering};

    /// The signal that came last.
    static LAST: AtomicI32 = AtomicI32::new(SIGINT);

    pub fn watch() {
        // Where signals cannot be watched, they end the program as they always did.
        let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
        std::thread::spawn(move || {
            for signal in signals.forever() {
                // It is asked once.
                let ask = ASKED.lock().unwrap_or_else(PoisonError::into_inner).take();
                LAST.store(signal, Ordering::SeqCst);
                if !ask.is_some_and(|ask| ask()) {
                    say(b"interrupted: what is finished is kept, and of long jobs the same command goes on; pictures begin anew\n");
                    exit(BY_SIGNAL + signal);
                }
                say(
                    b"interrupted: the step that is under way is finished and kept; once more ends at once\n",
                );
            }
        });
    }

    /// The code of the signal that came last.
    pub fn code() -> u8 {
        let code = BY_SIGNAL + LAST.load(Ordering::SeqCst);
        code.try_into().unwrap_or(u8::MAX)
    }

    /// Writes to stderr past its lock, which another thread may hold for as long as nobody reads.
    fn say(text: &[u8]) {
        let stderr = std::io::stderr().as_fd().try_clone_to_owned();
        let _ = stderr.and_then(|stderr| File::from(stderr).write_all(text));
    }
}
