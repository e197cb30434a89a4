//! `cargo xtask farm`: a dataset made by real engines on this machine while their workers are killed, one of their nodes is
//! lost and one shard always fails. It must be named and all others made; once it is mended, the whole must have the bytes
//! of one run.

mod hunt;
mod ray;
mod slurm;

use crate::figures::{figure, json_argument, to_json, write};
use crate::program::{Program, contents, work_folder};
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;
use std::time::{Duration, Instant};

/// Into how many shards the dataset is cut.
const SHARDS: usize = 8;
/// The one that fails.
const FAILING: usize = 5;
/// Kills of workers.
const KILLS: usize = 5;
/// The longest that an engine may take.
const PATIENCE: Duration = Duration::from_mins(8);

/// A cluster on this machine.
trait Engine {
    /// As `farm plan` has it.
    fn name(&self) -> &'static str;

    /// Hands a folder of jobs to it by `farm submit`, whose success does not matter.
    fn submit(&mut self, program: &Program, jobs: &Path) -> Result<()>;

    /// Whether a second `farm submit`, while the first is under way, hands over nothing a second time.
    fn submitted_once(&mut self, program: &Program, jobs: &Path) -> Result<()>;

    /// Whether nothing is to be done any more.
    fn idle(&mut self) -> Result<bool>;

    /// Processes that work on shards in a folder of jobs, for one of them to be killed.
    fn workers(&self, jobs: &Path) -> Vec<u32>;

    /// Takes a node away with all that runs there.
    fn lose_node(&mut self) -> Result<()>;

    /// Seconds that the start of a task takes, if it is measured, with all nodes there.
    fn launch(&mut self) -> Result<Option<f64>> {
        Ok(None)
    }
}

/// Runs both engines, or one.
///
/// # Errors
/// If an engine cannot be set up, or what it makes is not what it must be.
pub fn run(args: &[String]) -> Result<()> {
    let (json, rest) = json_argument(args)?;
    let only = match rest.as_slice() {
        [] => None,
        [option, name] if option == "--only" && ["slurm", "ray"].contains(&name.as_str()) => {
            Some(name.as_str())
        }
        _ => bail!("do not understand `{}`: cargo xtask farm [--json F] [--only slurm|ray]", rest.join(" ")),
    };
    let program = Program::build()?;
    let folder = work_folder("farm")?;
    let recipe = folder.join("recipe.toml");
    // Enough samples that workers can be met at work.
    let tiny = std::fs::read_to_string(crate::command::root().join("dataset/recipes/ao-tiny.toml"))?;
    std::fs::write(&recipe, tiny.replace("samples = 16", "samples = 1024"))?;
    let [recipe, whole] = [recipe, folder.join("whole")].map(|path| path.display().to_string());
    program.run(&["dataset", "generate", &recipe, "--out", &whole])?;
    let mut figures = Vec::new();
    if only != Some("ray") {
        let mut engine = slurm::Slurm::start(&folder.join("slurm"))?;
        figures.extend(tried(&program, &mut engine, &recipe, &folder)?);
    }
    if only != Some("slurm") {
        let mut engine = ray::Ray::start()?;
        figures.extend(tried(&program, &mut engine, &recipe, &folder)?);
    }
    if let Some(path) = json {
        write(&path, &to_json("farm", &figures, &[]))?;
    }
    figures.iter().for_each(|(name, value)| println!("{name}: {value}"));
    std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())
}

/// Makes the dataset by an engine, and gives its figures.
fn tried(
    program: &Program,
    engine: &mut dyn Engine,
    recipe: &str,
    folder: &Path,
) -> Result<Vec<(String, f64)>> {
    let name = engine.name();
    let launch = engine.launch()?;
    let begin = Instant::now();
    let place = |what: &str| folder.join(format!("{name}-{what}"));
    let text = |what: &str| place(what).display().to_string();
    let (jobs, out) = (text("jobs"), text("shards"));
    // What is no part of a shard is never written over.
    let failing = place("shards").join(format!("shard-{FAILING}-of-{SHARDS}"));
    std::fs::create_dir_all(&failing)?;
    std::fs::write(failing.join("mine.txt"), "somebody's own")?;
    let plan = ["farm", "plan", recipe, "--out", &out, "--jobs", &jobs, "--engine", name, "--retries", "8"];
    program.run(&[&plan[..], &["--shards", &SHARDS.to_string()]].concat())?;

    engine.submit(program, &place("jobs"))?;
    engine.submitted_once(program, &place("jobs"))?;
    let kills = disturbed(engine, &place("jobs"))?;
    let status = |file: &str| -> Result<String> {
        program.run(&["farm", "status", &jobs, "--json", &text(file)])?;
        Ok(std::fs::read_to_string(place(file))?)
    };
    let report = status("status.json")?;
    let made = figure(&report, "shards_made")?;
    ensure!(made == (SHARDS - 1) as f64, "{name}: {made} shards were made:\n{report}");
    let named = format!("\"{FAILING}/{SHARDS}\": \"");
    ensure!(report.contains(&named) && report.contains("mine.txt"), "{name}: not named:\n{report}");

    std::fs::remove_dir_all(&failing)?;
    engine.submit(program, &place("jobs"))?;
    wait(engine)?;
    let report = status("status.json")?;
    ensure!(figure(&report, "shards_made")? == SHARDS as f64, "{name}: not all were made:\n{report}");
    program.run(&["farm", "merge", &jobs, "--out", &text("merged")])?;
    let whole = contents(&folder.join("whole"))?;
    ensure!(contents(&place("merged"))? == whole, "{name}: not the bytes of one run");
    let bytes = whole.values().map(Vec::len).sum::<usize>();
    let figures = [
        ("kills", kills as f64),
        ("nodes_lost", 1.0),
        ("shards", SHARDS as f64),
        ("tries", figure(&report, "tries")?),
        ("failing_named", 1.0),
        ("bytes_compared", bytes as f64),
        ("bytes_equal", 1.0),
        ("seconds", begin.elapsed().as_secs_f64()),
    ];
    println!(
        "{name}: {kills} workers killed, a node lost, shard {FAILING} named and mended; the bytes of one run"
    );
    let figures = figures.into_iter().chain(launch.map(|seconds| ("launch_seconds", seconds)));
    Ok(figures.map(|(figure, value)| (format!("{name}_{figure}"), value)).collect())
}

/// Kills workers now and then, takes a node away, and waits for the end; gives the number of kills.
fn disturbed(engine: &mut dyn Engine, jobs: &Path) -> Result<usize> {
    let begin = Instant::now();
    let mut kills = 0;
    let mut lost = false;
    let mut last = 0;
    while !engine.idle()? {
        ensure!(begin.elapsed() < PATIENCE, "{} does not come to an end", engine.name());
        std::thread::sleep(Duration::from_millis(700));
        let workers = engine.workers(jobs);
        // Not the same shard each time: processes have rising numbers.
        let victim = workers.iter().find(|worker| **worker > last).or(workers.first());
        if kills < KILLS
            && let Some(victim) = victim
        {
            last = *victim;
            kills += usize::from(hunt::kill(*victim));
        }
        if kills == KILLS && !lost && !engine.workers(jobs).is_empty() {
            engine.lose_node()?;
            lost = true;
        }
    }
    ensure!(kills == KILLS && lost, "{}: only {kills} kills, node lost: {lost}", engine.name());
    Ok(kills)
}

fn wait(engine: &mut dyn Engine) -> Result<()> {
    let begin = Instant::now();
    while !engine.idle()? {
        ensure!(begin.elapsed() < PATIENCE, "{} does not come to an end", engine.name());
        std::thread::sleep(Duration::from_millis(500));
    }
    Ok(())
}
