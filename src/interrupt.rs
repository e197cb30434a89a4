//! Ctrl-C, and what a scheduler sends before it takes a machine away: the program says that nothing is lost and ends with
//! the code that shells give it, 130 or 143.
//!
//! Nothing has to be put in order first. Whatever is written is written so that a kill at any moment does no harm
//! (`shaders::atomic_file`, the journal, checkpoints); the same command goes on from there.

/// Watches for such signals from now on. Elsewhere than on Unix the system's own way stays.
pub fn watch() {
    #[cfg(unix)]
    unix::watch();
}

#[cfg(unix)]
mod unix {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::exit;
    use std::fs::File;
    use std::io::Write;
    use std::os::fd::AsFd;

    /// Shells add this to a signal's number.
    const BY_SIGNAL: i32 = 128;

    pub fn watch() {
        // Where signals cannot be watched, they end the program as they always did.
        let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
        std::thread::spawn(move || {
            if let Some(signal) = signals.forever().next() {
                say(b"interrupted: what is finished is kept, and of long jobs the same command goes on; pictures begin anew\n");
                exit(BY_SIGNAL + signal);
            }
        });
    }

    /// Writes to stderr past its lock, which another thread may hold for as long as nobody reads.
    fn say(text: &[u8]) {
        let stderr = std::io::stderr().as_fd().try_clone_to_owned();
        let _ = stderr.and_then(|stderr| File::from(stderr).write_all(text));
    }
}
