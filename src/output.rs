//! What a verb tells people: `say!` on standard output, once its work is done, what it found out; `note!` on stderr,
//! before that, what it is at.
//!
//! `println!` panics where nobody reads any more (`deepshade scene --list | head -1`). Here that is an error, which
//! `main` takes for a quiet end. That is right only where no work is left: hence verbs write their files, the JSON file
//! too, before they say anything.

use anyhow::{Context, Result};
use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};

/// Prints a line, as `println!` does; gives a `Result`.
macro_rules! say {
    ($($text:tt)*) => { $crate::output::line(format_args!($($text)*)) };
}

/// Prints a line on stderr while work goes on. Whether anybody reads it does not matter.
macro_rules! note {
    ($($text:tt)*) => { $crate::output::aside(format_args!($($text)*)) };
}

/// Writes a line to standard output.
///
/// # Errors
/// If nobody reads it, or what it is led to is full.
pub fn line(text: Arguments<'_>) -> Result<()> {
    writeln!(io::stdout().lock(), "{text}").context("standard output")
}

/// Writes a line to stderr, where that is possible.
#[cfg(not(target_arch = "wasm32"))]
pub fn aside(text: Arguments<'_>) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Writes a line to the browser's console.
#[cfg(target_arch = "wasm32")]
pub fn aside(text: Arguments<'_>) {
    web_sys::console::log_1(&text.to_string().into());
}

/// Whether an error says no more than that nobody reads what is written.
pub fn nobody_reads(error: &anyhow::Error) -> bool {
    let broken = |cause: &io::Error| cause.kind() == ErrorKind::BrokenPipe;
    error.chain().any(|cause| cause.downcast_ref().is_some_and(broken))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_broken_pipe_means_that_nobody_reads() {
        let error = |kind: ErrorKind| anyhow::Error::new(io::Error::from(kind)).context("standard output");
        assert!(nobody_reads(&error(ErrorKind::BrokenPipe)));
        assert!(!nobody_reads(&error(ErrorKind::StorageFull)));
        assert!(!nobody_reads(&anyhow::anyhow!("no adapter")));
    }
}
