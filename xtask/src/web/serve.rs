//! A web server of static files, for this machine alone: Python's.

use crate::command::command;
use anyhow::{Context, Result};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};

/// A server, which ends with this.
pub struct Server {
    child: Child,
    /// Where it is, such as `http://127.0.0.1:40123/`.
    pub address: String,
}

impl Server {
    /// Serves a folder.
    ///
    /// # Errors
    /// If Python is not there, or no port is free.
    pub fn start(folder: &Path) -> Result<Self> {
        let folder = folder.display().to_string();
        let words = ["-u", "-m", "http.server", "--bind", "127.0.0.1", "--directory", &folder, "0"];
        let mut child = command("python3", &words).stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?;
        let mut said = String::new();
        let output = child.stdout.take().context("its output")?;
        BufReader::new(output).read_line(&mut said)?;
        let mut server = Self { child, address: String::new() };
        server.address = address(&said).with_context(|| format!("python3 does not serve: {said}"))?;
        Ok(server)
    }

    /// Waits until it is ended.
    ///
    /// # Errors
    /// If it cannot be waited for.
    pub fn wait(mut self) -> Result<()> {
        println!("{}", self.address);
        self.child.wait()?;
        Ok(())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The address in what Python says: `Serving HTTP on 127.0.0.1 port 40123 (http://127.0.0.1:40123/) ...`.
fn address(said: &str) -> Option<String> {
    Some(said.split_once('(')?.1.split_once(')')?.0.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::net::TcpStream;

    #[test]
    fn a_module_is_served_as_what_it_is() {
        let folder = std::env::temp_dir().join(format!("deepshade-serve-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("made");
        std::fs::write(folder.join("a.wasm"), "module").expect("written");
        let server = Server::start(&folder).expect("serves");
        let port = server.address.trim_start_matches("http://").trim_end_matches('/');
        let mut stream = TcpStream::connect(port).expect("connected");
        stream.write_all(b"GET /a.wasm HTTP/1.0\r\n\r\n").expect("asked");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        std::fs::remove_dir_all(&folder).expect("deleted");
        assert!(answer.contains("Content-type: application/wasm") && answer.ends_with("module"), "{answer}");
    }
}
