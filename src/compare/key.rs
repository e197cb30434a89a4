//! What tells an image from every other that it could be taken for: a hash of all that it was made from.
//! Where an image of the same key is there already, it is not made again.

use anyhow::{Context, Result};
use std::fmt::{Arguments, Debug, Result as Written, Write};
use std::fs::File;
use std::path::Path;

/// A BLAKE3 hash of what is said to it. Numbers are said exactly by their `Debug`.
#[derive(Default)]
pub struct Digest(blake3::Hasher);

impl Digest {
    /// Says one thing more.
    pub fn say(&mut self, what: &impl Debug) {
        self.said(format_args!("{what:?}\n"));
    }

    /// The hash, in hexadecimal.
    pub fn finish(&self) -> String {
        self.0.finalize().to_hex().to_string()
    }

    fn said(&mut self, what: Arguments<'_>) {
        self.write_fmt(what).expect("a hash takes everything");
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> Written {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

/// The hash of a file's bytes.
///
/// # Errors
/// If it cannot be read.
pub fn file_digest(path: &Path) -> Result<String> {
    let mut hasher = blake3::Hasher::new();
    let file = File::open(path).with_context(|| path.display().to_string())?;
    hasher.update_reader(file).with_context(|| path.display().to_string())?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// What makes images beside what they are made from: this very program, since another build may make others,
/// and the machine, since times are its own.
///
/// # Errors
/// If the program cannot be read.
pub fn maker(machine: &[(String, String)]) -> Result<String> {
    let program = std::env::current_exe().context("the program's own file")?;
    Ok(format!("{} {machine:?}", file_digest(&program)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_differs_gives_another_key() {
        let key = |things: &[&dyn Debug]| {
            let mut digest = Digest::default();
            things.iter().for_each(|thing| digest.say(thing));
            digest.finish()
        };
        let plain = key(&[&0.1f32, &"room:1"]);
        assert_eq!(plain, key(&[&0.1f32, &"room:1"]));
        let near = f32::from_bits(0.1f32.to_bits() + 1);
        for other in [
            key(&[&near, &"room:1"]),
            key(&[&0.1f32, &"room:2"]),
            key(&[&0.1f32]),
            key(&[&0.1f32, &"room", &":1"]),
        ] {
            assert_ne!(plain, other);
        }
    }
}
