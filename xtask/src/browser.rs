//! A headless Chromium, and what is asked of the page in it.

use crate::apt;
use crate::command::{command, succeeds};
use anyhow::{Context, Result, bail, ensure};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use thirtyfour::{By, ChromiumLikeCapabilities, DesiredCapabilities, WebDriver, WebElement};

/// What Chromium needs for WebGPU on a machine that has no graphics card.
pub const WEBGPU: &[&str] = &[
    "--enable-unsafe-webgpu",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--use-webgpu-adapter=swiftshader",
    // Canvases are put into pages by a software adapter, too.
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    // It ends what computes for long, as software does on a busy machine.
    "--disable-gpu-watchdog",
];
/// No window, and nothing asked of anybody elsewhere. Of itself a browser takes no software adapter for
/// WebGPU.
const QUIET: &[&str] = &[
    "--headless",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1100,1400",
];
/// How often a page is looked at.
pub const PAUSE: Duration = Duration::from_millis(200);
/// How long the driver may take to start.
const PATIENCE: Duration = Duration::from_secs(60);
/// How long a script may take: one that asks for values waits for the frames before, which take a software
/// adapter long.
const SCRIPT: Duration = Duration::from_mins(20);

const PACKAGES: [&str; 2] = ["chromium", "chromium-driver"];

/// Installs Chromium with its driver where it is missing.
///
/// # Errors
/// If that is not possible; the message says what to install by hand.
pub fn ensure() -> Result<()> {
    let there = |program| succeeds(&mut command(program, &["--version"]));
    match there("chromium") && there("chromedriver") {
        true => Ok(()),
        false => apt::install(&PACKAGES, "Chromium with its driver"),
    }
}

/// A browser with its driver, which ends with it.
pub struct Browser {
    pub(crate) driver: WebDriver,
    _process: Process,
}

struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Browser {
    /// Starts a browser with a profile of its own, with these arguments too.
    ///
    /// # Errors
    /// If it does not start.
    pub async fn open(arguments: &[&str]) -> Result<Self> {
        let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port();
        let mut command = Command::new("chromedriver");
        command
            .arg(format!("--port={port}"))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let process = Process(command.spawn().context("cannot start chromedriver")?);
        let began = Instant::now();
        while TcpStream::connect((Ipv4Addr::LOCALHOST, port)).is_err() {
            ensure!(began.elapsed() < PATIENCE, "chromedriver does not answer");
            tokio::time::sleep(PAUSE).await;
        }
        let mut capabilities = DesiredCapabilities::chrome();
        for argument in QUIET.iter().chain(arguments) {
            capabilities.add_arg(argument)?;
        }
        let address = format!("http://127.0.0.1:{port}");
        let driver = WebDriver::builder(address, capabilities).request_timeout(SCRIPT).connect().await?;
        driver.set_script_timeout(SCRIPT).await?;
        Ok(Self { driver, _process: process })
    }

    /// Goes to an address.
    ///
    /// # Errors
    /// If there is nothing.
    pub async fn goto(&self, address: &str) -> Result<()> {
        Ok(self.driver.goto(address).await?)
    }

    /// Ends the browser.
    ///
    /// # Errors
    /// If it does not end.
    pub async fn quit(self) -> Result<()> {
        Ok(self.driver.quit().await?)
    }

    /// An element.
    ///
    /// # Errors
    /// If there is none.
    pub async fn find(&self, by: By) -> Result<WebElement> {
        Ok(self.driver.find(by).await?)
    }

    /// The text of an element.
    ///
    /// # Errors
    /// If there is none.
    pub async fn text(&self, id: &str) -> Result<String> {
        self.asked(&format!("return document.getElementById('{id}').textContent")).await
    }

    /// Waits until the page's body has a datum, which is returned.
    ///
    /// # Errors
    /// If the page says in the datum `failed` that it does not, or time is over.
    pub async fn until_datum(&self, name: &str, patience: Duration) -> Result<String> {
        let began = Instant::now();
        loop {
            let datum = |name: &str| format!("return document.body.dataset.{name} || ''");
            let (failed, found): (String, String) =
                (self.asked(&datum("failed")).await?, self.asked(&datum(name)).await?);
            ensure!(failed.is_empty(), "the page says: {failed}");
            if !found.is_empty() {
                return Ok(found);
            }
            ensure!(began.elapsed() < patience, "the page is not ready after {} s", patience.as_secs());
            tokio::time::sleep(PAUSE).await;
        }
    }

    /// What an expression of the page comes to, which may be a promise.
    ///
    /// # Errors
    /// If it fails.
    pub async fn evaluated(&self, expression: &str) -> Result<serde_json::Value> {
        let script = format!(
            "const done = arguments[0]; Promise.resolve({expression}).then((value) => done({{ value }}), \
             (error) => done({{ failed: String(error) }}))"
        );
        let answer = self.driver.execute_async(script, Vec::new()).await?;
        match &answer.json()["failed"] {
            serde_json::Value::String(failed) => bail!("the page says: {failed}"),
            _ => Ok(answer.json()["value"].clone()),
        }
    }

    /// A picture of an element.
    ///
    /// # Errors
    /// If there is none.
    pub async fn picture(&self, of: By) -> Result<Vec<u8>> {
        Ok(self.find(of).await?.screenshot_as_png().await?)
    }

    /// What a script returns.
    ///
    /// # Errors
    /// If it fails.
    pub async fn asked<T: serde::de::DeserializeOwned>(&self, script: &str) -> Result<T> {
        Ok(self.driver.execute(script, Vec::new()).await?.convert()?)
    }
}
