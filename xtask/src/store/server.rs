//! `s3s-fs`: a server that speaks S3 and keeps objects as files.

use crate::command::{self, cargo, command, target};
use anyhow::{Context, Result, ensure};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Its version.
const SERVER: &str = "0.14.1";
/// What it asks for.
pub const KEY: &str = "deepshade";
/// And that.
pub const SECRET: &str = "not-a-secret";
/// Where objects are.
pub const BUCKET: &str = "bucket";

/// Where it is; it is built once.
///
/// # Errors
/// If it does not build.
pub fn program() -> Result<PathBuf> {
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
pub struct Server {
    child: Child,
    /// Where it listens.
    pub port: u16,
    /// The folder of buckets.
    pub root: PathBuf,
}

impl Server {
    /// Starts it.
    ///
    /// # Errors
    /// If it does not answer.
    pub fn start(program: &Path, root: &Path) -> Result<Self> {
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
