//! Standard output: what a verb found out, for people.
//!
//! `println!` panics where nobody reads any more (`deepshade scene --list | head -1`). Here that is an error, which
//! `main` takes for a quiet end; verbs that measure write their JSON file before they print.

use anyhow::{Context, Result};
use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};

/// Prints a line, as `println!` does; gives a `Result`.
macro_rules! say {
    ($($text:tt)*) => { $crate::output::line(format_args!($($text)*)) };
}

/// Writes a line to standard output.
///
/// # Errors
/// If nobody reads it, or what it is led to is full.
pub fn line(text: Arguments<'_>) -> Result<()> {
    writeln!(io::stdout().lock(), "{text}").context("standard output")
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
