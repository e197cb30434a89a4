//! `cargo xtask faults`: whatever happens to the program, what it makes in the end is what it makes undisturbed, byte for
//! byte.
//!
//! `kills` ends jobs at random moments (SIGKILL) and takes them up again; `scenarios` are everything else that happens to
//! programs. Both go on after a failure, so that the figures say how much holds; the command fails at its end.

mod job;
mod kills;
mod scenarios;

use crate::figures::{json_argument, to_json, write};
use crate::program::{Program, work_folder};
use anyhow::{Context, Result, bail, ensure};

/// Kills without `--kills`: some twenty seconds.
const KILLS: usize = 60;

/// What the command line says.
struct Args {
    kills: usize,
    seed: u64,
}

/// Disturbs the program in every way and says what survived.
///
/// # Errors
/// If the program does not build, or something did not survive.
pub fn run(args: &[String]) -> Result<()> {
    let (json, rest) = json_argument(args)?;
    let Args { kills, seed } = parse(&rest)?;
    let program = Program::build()?;
    let folder = work_folder("faults")?;
    println!("moments by --seed {seed}, in {}", folder.display());
    let jobs = job::all(&program, &folder)?;
    let mut faults = Vec::new();
    let killed = kills::run(&program, &jobs, &folder, kills, seed, &mut faults)?;
    let scenarios = scenarios::run(&program, &jobs, &folder)?;
    let survived = scenarios.iter().filter(|(_, outcome)| outcome.is_ok()).count();
    for (name, outcome) in &scenarios {
        match outcome {
            Ok(()) => println!("{name}: survived"),
            Err(error) => faults.push(format!("{name}: {error:#}")),
        }
    }
    let mut figures = vec![
        ("kills".to_owned(), killed.kills as f64),
        ("kills_survived".to_owned(), killed.survived as f64),
        ("bytes_compared".to_owned(), killed.bytes as f64),
        ("scenarios".to_owned(), scenarios.len() as f64),
        ("scenarios_survived".to_owned(), survived as f64),
    ];
    figures.extend(killed.by_job.iter().map(|(job, kills)| (format!("kills_{job}"), *kills as f64)));
    let names = scenarios.into_iter().map(|(name, _)| name).collect();
    if let Some(path) = json {
        let details = [("scenarios", names), ("faults", faults.clone()), ("seed", vec![seed.to_string()])];
        write(&path, &to_json("faults", &figures, &details))?;
    }
    figures.iter().for_each(|(name, value)| println!("{name}: {value}"));
    ensure!(
        faults.is_empty(),
        "not everything survived; {} is kept:\n{}",
        folder.display(),
        faults.join("\n")
    );
    std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())
}

fn parse(args: &[String]) -> Result<Args> {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH)?;
    let mut parsed = Args { kills: KILLS, seed: u64::from(now.subsec_nanos()) };
    for pair in args.chunks(2) {
        let [option, value] = pair else { bail!("{} wants a number", pair.join(" ")) };
        let number = || value.parse::<u64>().with_context(|| format!("{option} {value}"));
        match option.as_str() {
            "--kills" => parsed.kills = number()? as usize,
            "--seed" => parsed.seed = number()?,
            _ => bail!("do not understand `{option}`: cargo xtask faults [--kills N] [--seed S] [--json F]"),
        }
    }
    Ok(parsed)
}
