//! `cargo xtask store`: datasets, runs and models in an object store, against a server on this machine that speaks S3
//! (`s3s-fs`, by others), which keeps objects as files, so that they can be damaged and deleted.

use crate::command::{self, cargo, command, target};
use crate::program::{Program, contents, message, work_folder};
use anyhow::{Context, Result, ensure};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The server's version.
const SERVER: &str = "0.14.1";
/// What the server asks for.
const KEY: &str = "deepshade";
const SECRET: &str = "not-a-secret";
const BUCKET: &str = "bucket";
const RECIPE: &str = "dataset/recipes/ao-tiny.toml";

/// Sets up the server, builds the program with stores, and holds what it makes through them against what it makes in
/// folders.
///
/// # Errors
/// If the server or the program does not build, or something does not hold.
pub fn run() -> Result<()> {
    let server = server_program()?;
    command::run(&mut cargo(&["build", "--release", "--locked", "--features", "store"]))?;
    let program = Program::built();
    let folder = work_folder("store")?;
    let server = Server::start(&server, &folder.join("objects"))?;
    let bench = Bench { program, server, folder: folder.clone() };
    for (name, check) in CHECKS {
        check(&bench).with_context(|| format!("{name}; {} is kept", folder.display()))?;
        println!("{name}: holds");
    }
    drop(bench);
    std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())
}

type Check = (&'static str, fn(&Bench) -> Result<()>);

/// In this order: each goes on from those before.
const CHECKS: [Check; 7] = [
    ("shards made into the store are one dataset", shards),
    ("a network is trained from the store and into it", training),
    ("a cache is not asked for what it cannot vouch for", cache),
    ("a transfer that is killed is not seen and goes on", killed),
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
        let words: Vec<&str> = line.split(' ').collect();
        let mut command = self.program.command(&words);
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

    /// The command must fail and say that.
    fn refused(&self, mut command: Command, said: &str) -> Result<()> {
        let output = command.output()?;
        ensure!(output.status.code() == Some(1), "it ended with {}", output.status);
        ensure!(message(&output).contains(said), "it does not say `{said}`: {}", message(&output));
        ensure!(!String::from_utf8_lossy(&output.stderr).contains(SECRET), "it tells the secret");
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
    bench.run("machine-5", &format!("dataset merge {parts} --out {}", bench.local("merged")))?;
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
    let pairs = kept.keys().filter(|name| name.extension().is_some_and(|kind| kind == "exr")).count();
    ensure!(pairs == 0, "{pairs} pairs are left where there is no room");
    bench.run("machine-2", &train)?;
    let export = "export --run s3://bucket/run --dataset s3://bucket/ao/all --out s3://bucket/model";
    bench.run("machine-3", export)?;
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
    let pair =
        found.keys().find(|name| name.extension().is_some_and(|kind| kind == "exr")).context("a pair")?;
    std::fs::write(bench.folder.join("cut").join(pair), b"cut off")?;
    bench.run("cut", "dataset verify s3://bucket/ao/all")?;
    let mut small = bench.command("small", "dataset verify s3://bucket/ao/all");
    small.env("DEEPSHADE_CACHE_GB", "0");
    bench.refused(small, "more than the cache may hold")
}

fn killed(bench: &Bench) -> Result<()> {
    let line = format!("dataset generate {RECIPE} --out s3://bucket/killed");
    let mut child = bench.command("killed", &line).stderr(Stdio::null()).stdout(Stdio::null()).spawn()?;
    let begin = Instant::now();
    let objects = bench.objects("killed/objects");
    // The server makes a file's folder with the first of them.
    while !objects.exists() && begin.elapsed() < Duration::from_mins(2) && child.try_wait()?.is_none() {
        std::thread::sleep(Duration::from_micros(200));
    }
    let _ = child.kill();
    ensure!(!child.wait()?.success(), "it was done before it could be killed");
    ensure!(!bench.objects("killed/commit.json").exists(), "the list was not written last");
    bench.refused(bench.command("other", "dataset verify s3://bucket/killed"), "nothing is there")?;
    bench.run("another machine", &line)?;
    bench.run("other", "dataset verify s3://bucket/killed")
}

fn damaged(bench: &Bench) -> Result<()> {
    let objects = contents(&bench.objects("killed/objects"))?;
    let (name, mut bytes) = objects.into_iter().next().context("an object")?;
    let path = bench.objects("killed/objects").join(&name);
    let sound = bytes.clone();
    bytes[0] ^= 1;
    std::fs::write(&path, &bytes)?;
    let verify = || bench.command("fresh", "dataset verify s3://bucket/killed");
    bench.refused(verify(), "is damaged: delete that object")?;
    std::fs::remove_file(&path)?;
    bench.refused(verify(), "is gone")?;
    std::fs::write(&path, &sound)?;
    bench.run("fresh", "dataset verify s3://bucket/killed")
}

fn missing(bench: &Bench) -> Result<()> {
    let train = format!("train --dataset s3://bucket/nowhere --out {}", bench.local("never"));
    bench.refused(bench.command("fresh", &train), "s3://bucket/nowhere: nothing is there")
}

fn credentials(bench: &Bench) -> Result<()> {
    let mut wrong = bench.command("fresh", "dataset verify s3://bucket/ao/all");
    wrong.env("AWS_SECRET_ACCESS_KEY", "another");
    let output = wrong.output()?;
    ensure!(output.status.code() == Some(1), "it ended with {}", output.status);
    let mut inside = bench.command("fresh", &format!("dataset verify s3://{KEY}:{SECRET}@bucket/ao"));
    let output = inside.output()?;
    ensure!(!output.status.success(), "credentials in an address are taken");
    Ok(())
}

/// The server, which is built once.
fn server_program() -> Result<PathBuf> {
    let tools = target().join("tools");
    let program = tools.join("bin").join(format!("s3s-fs{}", std::env::consts::EXE_SUFFIX));
    if !program.exists() {
        let root = tools.display().to_string();
        let version = ["--version", SERVER, "--locked", "--features", "binary", "--root", &root];
        command::run(&mut cargo(&[&["install", "s3s-fs"][..], &version].concat()))?;
    }
    Ok(program)
}

/// A server that runs as long as this lives.
struct Server {
    child: Child,
    port: u16,
    root: PathBuf,
}

impl Server {
    fn start(program: &Path, root: &Path) -> Result<Self> {
        std::fs::create_dir_all(root.join(BUCKET)).with_context(|| root.display().to_string())?;
        let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port();
        let number = port.to_string();
        let options = ["--host", "127.0.0.1", "--port", &number, "--access-key", KEY, "--secret-key", SECRET];
        let mut server = command(&program.display().to_string(), &options);
        let child = server.arg(root).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        let server = Self { child, port, root: root.to_owned() };
        let begin = Instant::now();
        while TcpStream::connect((Ipv4Addr::LOCALHOST, port)).is_err() {
            ensure!(begin.elapsed() < Duration::from_secs(20), "the server does not answer");
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(server)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
