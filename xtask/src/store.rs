//! `cargo xtask store`: datasets, runs and models in an object store, against a server on this machine that speaks S3
//! (`s3s-fs`, by others), which keeps objects as files, so that they can be damaged and deleted. What the server takes is measured,
//! for `deepshade farm cost`.

mod server;

use crate::command::{self, cargo, command, succeeds};
use crate::figures::{figure, json_argument, to_json, write};
use crate::program::{Program, WITH_STUDIES, contents, message, work_folder};
use anyhow::{Context, Result, bail, ensure};
use server::{BUCKET, KEY, SECRET, Server};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

const RECIPE: &str = "dataset/recipes/ao-tiny.toml";

/// Sets up the server, builds the program with stores, and holds what it makes through them against what it makes in
/// folders.
///
/// # Errors
/// If the server or the program does not build, or something does not hold.
pub fn run(args: &[String]) -> Result<()> {
    let (json, rest) = json_argument(args)?;
    if !rest.is_empty() {
        bail!("do not understand `{}`: cargo xtask store [--json F]", rest.join(" "));
    }
    let server = server::program()?;
    command::run(&mut cargo(&[&WITH_STUDIES[..], &["--features", "store"]].concat()))?;
    let program = Program::built();
    let folder = work_folder("store")?;
    let server = Server::start(&server, &folder.join("objects"))?;
    let bench = Bench { program, server, folder: folder.clone() };
    for (name, check) in CHECKS {
        check(&bench).with_context(|| format!("{name}; {} is kept", folder.display()))?;
        println!("{name}: holds");
    }
    let mut figures = rates(&bench)?;
    figures.push(("checks".to_owned(), CHECKS.len() as f64));
    if let Some(path) = json {
        write(&path, &to_json("store", &figures, &[]))?;
    }
    figures.iter().for_each(|(name, value)| println!("{name}: {value}"));
    drop(bench);
    std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())
}

type Check = (&'static str, fn(&Bench) -> Result<()>);

/// In this order: each goes on from those before.
const CHECKS: [Check; 9] = [
    ("shards made into the store are one dataset", shards),
    ("a network is trained from the store and into it", training),
    ("a cache is not asked for what it cannot vouch for", cache),
    ("a transfer that is killed is not seen and goes on", killed),
    ("of two that write different things the second is told", contested),
    ("a store without conditional writes is written to, and that is said", unconditional),
    ("damage in the store is named", damaged),
    ("what is not there is said to be", missing),
    ("credentials are the environment's and must be right", credentials),
];

struct Bench {
    program: Program,
    server: Server,
    folder: PathBuf,
}

impl Bench {
    fn local(&self, name: &str) -> String {
        self.folder.join(name).display().to_string()
    }

    /// The program with an empty cache of that name.
    fn command(&self, cache: &str, line: &str) -> Command {
        self.command_of(&self.program, cache, line)
    }

    /// A program with an empty cache of that name.
    fn command_of(&self, program: &Program, cache: &str, line: &str) -> Command {
        let words: Vec<&str> = line.split(' ').collect();
        let mut command = program.command(&words);
        command
            .env("DEEPSHADE_CACHE", self.folder.join(cache))
            .env("AWS_ENDPOINT", format!("http://127.0.0.1:{}", self.server.port))
            .env("AWS_ALLOW_HTTP", "true")
            .env("AWS_REGION", "us-east-1")
            .env("AWS_ACCESS_KEY_ID", KEY)
            .env("AWS_SECRET_ACCESS_KEY", SECRET);
        command
    }

    fn run(&self, cache: &str, line: &str) -> Result<()> {
        let output = self.command(cache, line).output()?;
        ensure!(output.status.success(), "`{line}`: {}", String::from_utf8_lossy(&output.stderr));
        Ok(())
    }

    /// The command must fail with that code and say all of that.
    fn refused(&self, mut command: Command, code: i32, said: &[&str]) -> Result<()> {
        let output = command.output()?;
        let text = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.code() == Some(code), "it ended with {}", output.status);
        for said in said {
            ensure!(text.contains(said), "it does not say `{said}`: {text}");
        }
        ensure!(!text.contains(SECRET), "it tells the secret");
        Ok(())
    }

    /// The server's files below a name.
    fn objects(&self, name: &str) -> PathBuf {
        self.server.root.join(BUCKET).join(name)
    }
}

fn same(one: &str, other: &str) -> Result<()> {
    let [one, other] = [contents(Path::new(one))?, contents(Path::new(other))?];
    ensure!(!one.is_empty(), "nothing is there");
    ensure!(one.keys().eq(other.keys()), "{:?} and {:?}", one.keys(), other.keys());
    ensure!(one == other, "other bytes");
    Ok(())
}

fn shards(bench: &Bench) -> Result<()> {
    let whole = bench.local("whole");
    bench.run("unused", &format!("dataset generate {RECIPE} --out {whole}"))?;
    for shard in 1..=3 {
        let cache = format!("machine-{shard}");
        bench.run(
            &cache,
            &format!("dataset generate {RECIPE} --shard {shard}/3 --out s3://bucket/ao/{shard}"),
        )?;
    }
    let parts = "s3://bucket/ao/3 s3://bucket/ao/1 s3://bucket/ao/2";
    bench.run("machine-4", &format!("dataset merge {parts} --out s3://bucket/ao/all"))?;
    // What is put together here is fetched pair by pair, whatever the cache may hold.
    let merge = format!("dataset merge {parts} --out {}", bench.local("merged"));
    let output = bench.command("machine-5", &merge).env("DEEPSHADE_CACHE_GB", "0").output()?;
    ensure!(output.status.success(), "without a cache: {}", message(&output));
    let made = contents(&bench.folder.join("machine-1"))?;
    ensure!(!made.keys().any(|name| is_pair(name)), "a shard that is in the store is kept here");
    bench.run("machine-6", "dataset verify s3://bucket/ao/all")?;
    same(&whole, &bench.local("merged"))?;
    // A dataset that is there is not made again, on whatever machine.
    let json = bench.local("again.json");
    bench.run("machine-7", &format!("dataset generate {RECIPE} --out s3://bucket/ao/all --json {json}"))?;
    let figures = std::fs::read_to_string(&json)?;
    ensure!(figures.contains("\"rendered\": 0.0"), "it was made again: {figures}");
    Ok(())
}

fn training(bench: &Bench) -> Result<()> {
    let settings = "--crop 32 --batch 2 --validate-every 20";
    let whole = bench.local("whole");
    bench.run(
        "unused",
        &format!("train --dataset {whole} --out {} --steps 40 {settings}", bench.local("run")),
    )?;
    bench.run("unused", &format!("export --run {} --out {}", bench.local("run"), bench.local("model")))?;
    // The second machine finds the run as the first has left it.
    let train = format!("train --dataset s3://bucket/ao/all --out s3://bucket/run --steps 40 {settings}");
    // Without room for a single pair beyond those that are read: all come from the store, as they are wanted.
    let mut streamed = bench.command("machine-1", &format!("{train} --workers 3 --cache-megabytes 0"));
    let output = streamed.env("DEEPSHADE_CACHE_GB", "0").output()?;
    ensure!(output.status.success(), "streamed: {}", message(&output));
    let kept = contents(&bench.folder.join("machine-1/store/streams"))?;
    let pairs = kept.keys().filter(|name| is_pair(name)).count();
    ensure!(pairs == 0, "{pairs} pairs are left where there is no room");
    bench.run("machine-2", &train)?;
    let export = "export --run s3://bucket/run --dataset s3://bucket/ao/all --out s3://bucket/model";
    bench.run("exporter", export)?;
    let fetched = contents(&bench.folder.join("exporter"))?;
    ensure!(!fetched.keys().any(|name| is_pair(name)), "pairs are fetched where the manifest alone is read");
    let fetched = bench.local("fetched");
    bench.run("machine-4", &format!("export --model s3://bucket/model --wgsl {fetched}"))?;
    let local = bench.local("wgsl");
    bench.run("unused", &format!("export --model {} --wgsl {local}", bench.local("model")))?;
    same(&local, &fetched)
}

/// A copy of which a file was cut off is mended, and one that would not fit is not begun.
fn cache(bench: &Bench) -> Result<()> {
    bench.run("cut", "dataset verify s3://bucket/ao/all")?;
    let found = contents(&bench.folder.join("cut"))?;
    let pair = found.keys().find(|name| is_pair(name)).context("a pair")?;
    std::fs::write(bench.folder.join("cut").join(pair), b"cut off")?;
    bench.run("cut", "dataset verify s3://bucket/ao/all")?;
    let mut small = bench.command("small", "dataset verify s3://bucket/ao/all");
    small.env("DEEPSHADE_CACHE_GB", "0");
    bench.refused(small, 1, &["more than the cache may hold"])
}

fn killed(bench: &Bench) -> Result<()> {
    let line = format!("dataset generate {RECIPE} --out s3://bucket/killed");
    let mut child = bench.command("killed", &line).stderr(Stdio::null()).stdout(Stdio::null()).spawn()?;
    let begin = Instant::now();
    let objects = bench.objects("killed/objects");
    while times(&objects)?.is_empty()
        && begin.elapsed() < Duration::from_mins(2)
        && child.try_wait()?.is_none()
    {
        std::thread::sleep(Duration::from_micros(200));
    }
    let _ = child.kill();
    ensure!(!child.wait()?.success(), "it was done before it could be killed");
    ensure!(!bench.objects("killed/commit.json").exists(), "the list was not written last");
    bench.refused(bench.command("other", "dataset verify s3://bucket/killed"), 1, &["nothing is there"])?;
    // What the server has begun to write it may write to its end.
    std::thread::sleep(Duration::from_secs(1));
    let before = times(&objects)?;
    ensure!(!before.is_empty(), "nothing had been sent");
    let json = bench.local("goes-on.json");
    bench.run("killed", &format!("{line} --json {json}"))?;
    let figures = std::fs::read_to_string(&json)?;
    ensure!(figure(&figures, "rendered")? == 0.0, "it was rendered again: {figures}");
    let after = times(&objects)?;
    for (name, time) in &before {
        ensure!(after.get(name) == Some(time), "{} was sent again", name.display());
    }
    bench.run("other", "dataset verify s3://bucket/killed")
}

/// When the files of a folder were written.
fn times(folder: &Path) -> Result<BTreeMap<PathBuf, SystemTime>> {
    let names = contents(folder)?.into_keys();
    names.map(|name| Ok((name.clone(), folder.join(name).metadata()?.modified()?))).collect()
}

/// One that has begun, and is held up until another has written there.
fn contested(bench: &Bench) -> Result<()> {
    let line = |shard| format!("dataset generate {RECIPE} --shard {shard}/3 --out s3://bucket/contested");
    let mut slow = bench.command("slow", &line(1));
    let mut child = slow.stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
    let begun = |name: &Path| name.file_name().is_some_and(|name| name == "unfinished.jsonl");
    let begin = Instant::now();
    while !contents(&bench.folder.join("slow"))?.keys().any(|name| begun(name)) {
        ensure!(begin.elapsed() < Duration::from_mins(2) && child.try_wait()?.is_none(), "it does not begin");
        std::thread::sleep(Duration::from_millis(1));
    }
    let signal = |name: &str| succeeds(&mut command("kill", &[name, &child.id().to_string()]));
    ensure!(signal("-STOP"), "it cannot be held up");
    bench.refused(bench.command("slow", &line(1)), 1, &["is at work on it"])?;
    bench.run("fast", &line(2))?;
    ensure!(signal("-CONT"), "it cannot go on");
    let output = child.wait_with_output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.code() == Some(1), "it ended with {}: {text}", output.status);
    ensure!(text.contains("somebody else has put something else there"), "it is not told: {text}");
    // Given again, it finds the other's, and its own is kept.
    let other = ["what it had made lies in", "shard-2-of-3.json"];
    bench.refused(bench.command("slow", &line(1)), 1, &other)?;
    let kept = contents(&bench.folder.join("slow"))?;
    ensure!(kept.keys().any(|name| name.display().to_string().contains("aside-1/pairs")), "its own is lost");
    Ok(())
}

fn unconditional(bench: &Bench) -> Result<()> {
    let line = format!("dataset generate {RECIPE} --shard 1/3 --out s3://bucket/plain");
    let output = bench.command("plain", &line).env("AWS_CONDITIONAL_PUT", "disabled").output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success() && text.contains("no conditional writes"), "{text}");
    ensure!(bench.objects("plain/commit.json").exists(), "nothing was written");
    Ok(())
}

/// What the server takes, as a study measures it.
fn rates(bench: &Bench) -> Result<Vec<(String, f64)>> {
    let json = bench.local("rates.json");
    let line = format!("store s3://bucket/probe --json {json}");
    let output = bench.command_of(&Program::studies(), "unused", &line).output()?;
    ensure!(output.status.success(), "`{line}`: {}", message(&output));
    let text = std::fs::read_to_string(&json)?;
    let names = ["megabytes_per_second_written", "megabytes_per_second_read", "requests_per_second"];
    names.into_iter().map(|name| Ok((name.to_owned(), figure(&text, name)?))).collect()
}

fn damaged(bench: &Bench) -> Result<()> {
    let objects = contents(&bench.objects("killed/objects"))?;
    let (name, mut bytes) = objects.into_iter().next().context("an object")?;
    let path = bench.objects("killed/objects").join(&name);
    let sound = bytes.clone();
    bytes[0] ^= 1;
    std::fs::write(&path, &bytes)?;
    let verify = || bench.command("fresh", "dataset verify s3://bucket/killed");
    bench.refused(verify(), 1, &["is damaged: delete that object"])?;
    std::fs::remove_file(&path)?;
    bench.refused(verify(), 1, &["is gone"])?;
    std::fs::write(&path, &sound)?;
    bench.run("fresh", "dataset verify s3://bucket/killed")
}

fn missing(bench: &Bench) -> Result<()> {
    let train = format!("train --dataset s3://bucket/nowhere --out {}", bench.local("never"));
    bench.refused(bench.command("fresh", &train), 1, &["s3://bucket/nowhere: nothing is there"])
}

fn credentials(bench: &Bench) -> Result<()> {
    let mut wrong = bench.command("fresh", "dataset verify s3://bucket/ao/all");
    wrong.env("AWS_SECRET_ACCESS_KEY", "another");
    bench.refused(wrong, 1, &["s3://bucket/ao/all/commit.json", "SignatureDoesNotMatch"])?;
    let inside = bench.command("fresh", &format!("dataset verify s3://{KEY}:password@bucket/ao"));
    bench.refused(inside, 2, &["no credentials are in it"])
}

/// Whether a file is a pair.
fn is_pair(name: &Path) -> bool {
    name.extension().is_some_and(|kind| kind == "exr")
}
