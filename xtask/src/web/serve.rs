//! A web server of static files, for this machine alone.

use anyhow::{Context, Result};
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// How long a browser may take to say what it wants.
const PATIENCE: Duration = Duration::from_secs(5);

/// Serves a folder until the program is ended, and says where.
///
/// # Errors
/// If no port is free.
pub fn forever(folder: &Path) -> Result<()> {
    let listener = listen()?;
    println!("http://{}/", listener.local_addr()?);
    accept(&listener, folder);
    Ok(())
}

/// Serves a folder as long as the program runs, and gives the address.
///
/// # Errors
/// If no port is free.
#[cfg(feature = "browser")]
pub fn beside(folder: &Path) -> Result<SocketAddr> {
    let (listener, folder) = (listen()?, folder.to_owned());
    let address = listener.local_addr()?;
    std::thread::spawn(move || accept(&listener, &folder));
    Ok(address)
}

fn listen() -> Result<TcpListener> {
    TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, 0))).context("no port is free")
}

fn accept(listener: &TcpListener, folder: &Path) {
    for stream in listener.incoming().flatten() {
        let folder = folder.to_owned();
        // A browser that goes away has no answer.
        std::thread::spawn(move || drop(answer(stream, &folder)));
    }
}

fn answer(mut stream: TcpStream, folder: &Path) -> Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let asked = lines.next().context("nothing is asked")??;
    // The rest of what a browser says means nothing here, but is to be read.
    for line in lines {
        if line?.is_empty() {
            break;
        }
    }
    let file = asked.strip_prefix("GET ").and_then(|rest| path(folder, rest.split(' ').next()?));
    let (status, kind, body) = match file.and_then(|file| Some((fs::read(&file).ok()?, kind(&file)))) {
        Some((body, kind)) => ("200 OK", kind, body),
        None => ("404 Not Found", "text/plain", b"not found".to_vec()),
    };
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    )?;
    stream.write_all(&body)?;
    Ok(())
}

/// The file that an address names, where it is within the folder.
fn path(folder: &Path, address: &str) -> Option<PathBuf> {
    let name = address.split(['?', '#']).next()?.strip_prefix('/')?;
    let name = Path::new(if name.is_empty() { "index.html" } else { name });
    name.components().all(|part| matches!(part, Component::Normal(_))).then(|| folder.join(name))
}

fn kind(file: &Path) -> &'static str {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css",
        Some("js") => "text/javascript",
        Some("json") => "application/json",
        Some("wasm") => "application/wasm",
        Some("png") => "image/png",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_outside_of_the_folder_is_served() {
        let folder = Path::new("page");
        assert_eq!(path(folder, "/"), Some(folder.join("index.html")));
        assert_eq!(path(folder, "/models/ao/net.json?x=1"), Some(folder.join("models/ao/net.json")));
        for address in ["/../secret", "/models/../../secret", "//etc/passwd", "secret"] {
            assert_eq!(path(folder, address), None, "{address}");
        }
    }
}
