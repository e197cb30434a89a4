//! Processes of this machine, by what they were started with (proc(5)).

use std::path::Path;

/// Processes that `has` holds of: of their command line and their environment, words apart by line ends.
pub fn processes(has: impl Fn(&str, &str) -> bool) -> Vec<u32> {
    let own = std::process::id();
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let numbers = entries.filter_map(|entry| entry.file_name().to_string_lossy().parse().ok());
    let mut found: Vec<u32> = numbers
        .filter(|process| *process != own && has(&words(*process, "cmdline"), &words(*process, "environ")))
        .collect();
    found.sort_unstable();
    found
}

/// Processes of the program that work on a shard in a folder of jobs.
pub fn workers(jobs: &Path) -> Vec<u32> {
    let jobs = jobs.display().to_string();
    processes(|line, _| {
        let mut words = line.lines().skip(1);
        let verb = [words.next(), words.next()] == [Some("farm"), Some("work")];
        verb && words.next() == Some(jobs.as_str())
    })
}

/// What started a process.
pub fn parent(process: u32) -> Option<u32> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    status.lines().find_map(|line| line.strip_prefix("PPid:"))?.trim().parse().ok()
}

/// Its command line.
pub fn words(process: u32, what: &str) -> String {
    let bytes = std::fs::read(format!("/proc/{process}/{what}")).unwrap_or_default();
    String::from_utf8_lossy(&bytes).replace('\0', "\n")
}

/// Kills a process; whether it was there.
pub fn kill(process: u32) -> bool {
    crate::command::succeeds(&mut crate::command::command("kill", &["-KILL", &process.to_string()]))
}
