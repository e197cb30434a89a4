//! What a verb tells people: `say!` on standard output, once its work is done, what it found out; `note!` on
//! stderr, before that, what it is at.
//!
//! `println!` panics where nobody reads any more (`deepshade scene --list | head -1`). Here that is an error,
//! which `main` takes for a quiet end. That is right only where no work is left: hence verbs write their
//! files, the JSON file too, before they say anything.

use anyhow::{Context, Result};
use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};

/// Prints a line, as `println!` does; gives a `Result`.
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => { $crate::output::line(format_args!($($text)*)) };
}

/// Prints a line on stderr while work goes on. Whether anybody reads it does not matter.
#[macro_export]
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

/// An error with its causes, but for what it states already: a cause as a whole, or the name of a file that
/// it is of.
pub(crate) fn message(error: &anyhow::Error) -> String {
    let mut message = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if message.contains(&cause) {
            continue;
        }
        let ends_with = |name: &str| message == name || message.ends_with(&format!(" {name}"));
        let named = cause.split_once(": ").filter(|(name, _)| ends_with(name));
        message = format!("{message}: {}", named.map_or(cause.as_str(), |(_, rest)| rest));
    }
    message
}

/// Whether an error says no more than that nobody reads what is written.
pub(crate) fn nobody_reads(error: &anyhow::Error) -> bool {
    let broken = |cause: &io::Error| cause.kind() == ErrorKind::BrokenPipe;
    error.chain().any(|cause| cause.downcast_ref().is_some_and(broken))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_named_once() {
        let gone = || {
            let source = io::Error::from(ErrorKind::NotFound);
            deepshade_render::scene::SceneError::Io { path: "a b.gltf".into(), source }
        };
        let said = ErrorKind::NotFound.to_string();
        let named = |context: &str| message(&anyhow::Error::new(gone()).context(context.to_owned()));
        assert_eq!(message(&gone().into()), format!("a b.gltf: {said}"));
        assert_eq!(named("scene a b.gltf"), format!("scene a b.gltf: {said}"));
        assert_eq!(named("a b.gltf"), format!("a b.gltf: {said}"));
        assert_eq!(named("scene hall.gltf"), format!("scene hall.gltf: a b.gltf: {said}"));
        assert_eq!(named("scene b.gltf"), format!("scene b.gltf: a b.gltf: {said}"));
    }

    #[test]
    fn only_a_broken_pipe_means_that_nobody_reads() {
        let error = |kind: ErrorKind| anyhow::Error::new(io::Error::from(kind)).context("standard output");
        assert!(nobody_reads(&error(ErrorKind::BrokenPipe)));
        assert!(!nobody_reads(&error(ErrorKind::StorageFull)));
        assert!(!nobody_reads(&anyhow::anyhow!("no adapter")));
    }
}
