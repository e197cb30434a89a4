//! Who has taken a folder: whoever holds a folder's lock writes into it which program it is, so that whoever
//! comes second can say whom to wait for. The lock decides; the note is for people.

use deepshade_shaders::atomic_file::TEMPORARY_PREFIX;
use std::path::{Path, PathBuf};

/// The note's name after the prefix of temporary files, with which it goes where a program was killed.
const NAME: &str = "holder";

/// Longest note that is read and longest command that is written, bytes.
const LONGEST: usize = 300;

/// The note in a folder, as long as the value lives.
#[derive(Debug)]
pub struct Holder {
    path: PathBuf,
}

impl Holder {
    /// Notes in a folder, whose lock is held, that this program has it. A note that cannot be written is left
    /// out: what is then missing is a name in an error of another program.
    #[must_use]
    pub fn sign(folder: &Path) -> Self {
        let path = note(folder);
        let _ = std::fs::write(&path, this_program());
        Self { path }
    }

    /// Whether a note is in a folder: somebody has it, or was killed having it.
    #[must_use]
    pub fn has_signed(folder: &Path) -> bool {
        note(folder).is_file()
    }

    /// Whether a process of this machine has signed last.
    #[must_use]
    pub fn is(folder: &Path, process: u32) -> bool {
        let (who, signed) = (named(process), Self::of(folder));
        signed.strip_prefix(&who).is_some_and(|rest| rest.starts_with(' '))
    }

    /// Who has a folder that is locked, in words.
    pub fn of(folder: &Path) -> String {
        let bytes = std::fs::read(note(folder)).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST)]).into_owned();
        // Anybody may have written it, and it is shown on a terminal.
        let text: String = text.chars().filter(|character| !character.is_control()).collect();
        if text.is_empty() { "another program".to_owned() } else { text }
    }
}

impl Drop for Holder {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

fn note(folder: &Path) -> PathBuf {
    folder.join(format!("{TEMPORARY_PREFIX}{NAME}"))
}

/// `process 7 on host`.
pub fn this_process() -> String {
    named(std::process::id())
}

fn named(process: u32) -> String {
    let place = host().map_or_else(String::new, |host| format!(" on {host}"));
    format!("process {process}{place}")
}

/// `process 7 on host (deepshade train ...)`.
fn this_program() -> String {
    let words: Vec<String> = std::env::args_os()
        .enumerate()
        .map(|(index, word)| {
            let path = Path::new(&word);
            let name = if index == 0 { path.file_name().unwrap_or(&word) } else { &word };
            name.to_string_lossy().into_owned()
        })
        .collect();
    let command: String = words.join(" ").chars().take(LONGEST / 2).collect();
    format!("{} (`{command}`)", this_process())
}

/// This machine's name, where it is told: by Linux, by Windows, or by a shell.
fn host() -> Option<String> {
    let kernel = std::fs::read_to_string("/proc/sys/kernel/hostname");
    let name =
        kernel.or_else(|_| std::env::var("COMPUTERNAME")).or_else(|_| std::env::var("HOSTNAME")).ok()?;
    Some(name.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::atomic_file::delete_temporaries;

    #[test]
    fn a_holder_is_named_as_long_as_it_holds() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(Holder::of(folder.path()), "another program");
        let holder = Holder::sign(folder.path());
        let who = Holder::of(folder.path());
        assert!(who.starts_with(&format!("process {}", std::process::id())), "{who}");
        assert!(Holder::is(folder.path(), std::process::id()));
        assert!(
            !Holder::is(folder.path(), std::process::id() / 10),
            "another one, whose number this one's begins with"
        );
        drop(holder);
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 0);
    }

    #[test]
    fn what_a_killed_holder_left_goes_with_its_other_files_and_harmful_notes_are_cut() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(note(folder.path()), format!("\u{1b}[2J{}", "x".repeat(1000))).expect("written");
        let who = Holder::of(folder.path());
        assert!(who.starts_with("[2Jxx") && who.len() < LONGEST, "{who}");
        delete_temporaries(folder.path()).expect("deleted");
        assert_eq!(Holder::of(folder.path()), "another program");
        // A folder that is gone is no reason to fail.
        drop(Holder::sign(&folder.path().join("missing")));
    }
}
