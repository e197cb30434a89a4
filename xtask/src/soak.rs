//! `cargo xtask soak`: a dataset is made, a network trained and a window looked at, all at once and for long, while the
//! memory and the open files of each are watched. What leaks grows for ever; what is needed is had after the first third.

use crate::command::{self, command};
use crate::figures::{json_argument, to_json, write};
use crate::program::{Program, work_folder};
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Minutes without `--minutes`.
const MINUTES: f64 = 120.0;
/// What is kept of a process, once in so long.
const EVERY: Duration = Duration::from_secs(2);
/// Megabytes that memory may grow by in the last two thirds, whatever the time: caches of textures and shaders.
const SLACK: f64 = 64.0;

/// A process with what it had at each moment.
struct Watched {
    name: &'static str,
    child: Child,
    /// Megabytes and open files.
    samples: Vec<(f64, usize)>,
}

/// Runs all three for some minutes.
///
/// # Errors
/// If one ends before its time or fails, or its memory or its open files grow.
pub fn run(args: &[String]) -> Result<()> {
    let (json, rest) = json_argument(args)?;
    let minutes: f64 = match rest.as_slice() {
        [] => MINUTES,
        [option, minutes] if option == "--minutes" => {
            minutes.parse().with_context(|| format!("--minutes {minutes}"))?
        }
        _ => bail!("do not understand `{}`: cargo xtask soak [--minutes N] [--json F]", rest.join(" ")),
    };
    ensure!(minutes > 0.0 && minutes < 1e5, "--minutes {minutes}: it must be above 0");
    let program = Program::build()?;
    let folder = work_folder("soak")?;
    let mut all = start(&program, &folder, minutes)?;
    let begin = Instant::now();
    let time = Duration::from_secs_f64(60.0 * minutes);
    while begin.elapsed() < time {
        std::thread::sleep(EVERY);
        for watched in &mut all {
            if let Some(status) = watched.child.try_wait()? {
                // The window and the training stop by themselves, about now.
                let early = begin.elapsed() < time.mul_f64(0.9);
                ensure!(status.success() && !early, "{} ended with {status}", watched.name);
                continue;
            }
            watched.samples.extend(sample(watched.child.id()));
        }
    }
    let mut figures = vec![("minutes".to_owned(), minutes)];
    let mut faults = Vec::new();
    for mut watched in all {
        let ended = end(&mut watched.child)?;
        ensure!(ended, "{} does not end when it is asked to", watched.name);
        let (early, late) = thirds(&watched.samples).with_context(|| watched.name.to_owned())?;
        let [growth, files] = [late.0 - early.0, late.1 as f64 - early.1 as f64];
        if growth > SLACK || files > 0.0 {
            faults.push(format!("{}: {growth:.1} MB and {files} open files more", watched.name));
        }
        for (figure, value) in [
            ("memory_mb", late.0),
            ("memory_growth_mb", growth),
            ("files", late.1 as f64),
            ("files_growth", files),
        ] {
            println!("{} {figure}: {value:.1}", watched.name);
            figures.push((format!("{figure}_{}", watched.name), value));
        }
    }
    if let Some(path) = json {
        write(&path, &to_json("soak", &figures, &[("faults", faults.clone())]))?;
    }
    std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    Ok(())
}

/// A dataset too large to be done in the time, a training that takes the time, and a window under Xvfb.
fn start(program: &Program, folder: &Path, minutes: f64) -> Result<Vec<Watched>> {
    let place = |name: &str| folder.join(name).display().to_string();
    let tiny = std::fs::read_to_string(command::root().join("dataset/recipes/ao-tiny.toml"))?;
    std::fs::write(
        folder.join("large.toml"),
        tiny.replace("views_per_scene = 4", "views_per_scene = 20000"),
    )?;
    let data = place("data");
    program.run(&["dataset", "generate", "dataset/recipes/ao-tiny.toml", "--out", &data])?;
    // The window walks on to the end of a round.
    std::fs::write(
        folder.join("walk.txt"),
        format!("quality low\nwait picture\ntruth on\nsoak {} ao,do,aa\nquit\n", 0.95 * 60.0 * minutes),
    )?;
    let started = |name: &'static str, words: &[&str], before: &[&str]| -> Result<Watched> {
        let program = program.path().display().to_string();
        let line: Vec<&str> =
            before.iter().copied().chain([program.as_str()]).chain(words.iter().copied()).collect();
        let errors = std::fs::File::create(folder.join(format!("{name}.txt")))?;
        let child = command(line[0], &line[1..]).stdout(Stdio::null()).stderr(errors).spawn();
        Ok(Watched { name, child: child.with_context(|| line.join(" "))?, samples: Vec::new() })
    };
    let time = minutes.to_string();
    let train = ["train", "--dataset", &data, "--out", &place("run"), "--crop", "32", "--batch", "2"];
    let train = [&train[..], &["--patience", "0", "--steps", "100000000", "--minutes", &time]].concat();
    let view =
        ["view", "--scene", "room:7", "--height", "96", "--width", "128", "--script", &place("walk.txt")];
    Ok(vec![
        started("dataset", &["dataset", "generate", &place("large.toml"), "--out", &place("large")], &[])?,
        started("train", &train, &[])?,
        started("view", &view, &["xvfb-run", "-a", "-e", "/dev/stderr"])?,
    ])
}

/// Megabytes and open files of a process and of those that it has started (proc(5)).
fn sample(process: u32) -> Option<(f64, usize)> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: f64 = resident.trim().trim_end_matches(" kB").parse().ok()?;
    let files = std::fs::read_dir(format!("/proc/{process}/fd")).ok()?.count();
    let children =
        std::fs::read_to_string(format!("/proc/{process}/task/{process}/children")).unwrap_or_default();
    let of_children = children.split_whitespace().filter_map(|child| sample(child.parse().ok()?));
    Some(of_children.fold((kilobytes / 1000.0, files), |sum, one| (sum.0 + one.0, sum.1 + one.1)))
}

/// The largest of the second and of the last third.
fn thirds(samples: &[(f64, usize)]) -> Option<((f64, usize), (f64, usize))> {
    let third = samples.len() / 3;
    let largest = |samples: &[(f64, usize)]| {
        let files = samples.iter().map(|sample| sample.1).max()?;
        Some((samples.iter().map(|sample| sample.0).fold(0.0, f64::max), files))
    };
    Some((largest(&samples[third..2 * third])?, largest(&samples[2 * third..])?))
}

/// Asks a process to end, as Ctrl-C does, and waits for that; whether it did.
fn end(child: &mut Child) -> Result<bool> {
    let begin = Instant::now();
    while child.try_wait()?.is_none() {
        if begin.elapsed() > Duration::from_mins(1) {
            child.kill()?;
            child.wait()?;
            return Ok(false);
        }
        command::succeeds(&mut command("kill", &["-INT", &child.id().to_string()]));
        std::thread::sleep(Duration::from_secs(1));
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_from_the_second_to_the_last_third() {
        let samples = [(1.0, 3), (9.0, 9), (2.0, 4), (3.0, 4), (2.5, 5), (4.0, 4)];
        assert_eq!(thirds(&samples), Some(((3.0, 4), (4.0, 5))));
        assert_eq!(thirds(&samples[..2]), None);
    }
}
