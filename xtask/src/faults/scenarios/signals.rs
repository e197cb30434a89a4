//! Jobs that are asked to end, stopped, or started beside themselves.

use super::Stage;
use crate::command::{self, command};
use crate::program::message;
use anyhow::{Result, ensure};
use std::process::Child;
use std::time::Duration;

/// By Ctrl-C.
pub fn interrupted(stage: &Stage<'_>) -> Result<()> {
    asked_to_end(stage, "-INT", 130)
}

/// By what a scheduler sends before it takes a machine away.
pub fn ended(stage: &Stage<'_>) -> Result<()> {
    asked_to_end(stage, "-TERM", 143)
}

fn asked_to_end(stage: &Stage<'_>, signal: &str, code: i32) -> Result<()> {
    let child = stage.start_some()?;
    send(signal, &child)?;
    let output = child.wait_with_output()?;
    ensure!(output.status.code() == Some(code), "it ended with {}", output.status);
    ensure!(message(&output).contains("the same command goes on"), "it says: {}", message(&output));
    stage.check_so_far()?;
    stage.finish()
}

/// For a second, in the middle.
pub fn stopped(stage: &Stage<'_>) -> Result<()> {
    let mut child = stage.start_some()?;
    send("-STOP", &child)?;
    std::thread::sleep(Duration::from_secs(1));
    send("-CONT", &child)?;
    ensure!(child.wait()?.success(), "it failed when it was continued");
    stage.check(&stage.out)
}

/// A second one is started while the first is at work.
pub fn twice(stage: &Stage<'_>) -> Result<()> {
    let mut first = stage.start_some()?;
    send("-STOP", &first)?;
    let second = stage.command(&[]).output();
    send("-CONT", &first)?;
    ensure!(first.wait()?.success(), "the first failed");
    let second = second?;
    let holder = format!("process {}", first.id());
    ensure!(second.status.code() == Some(1), "the second ended with {}", second.status);
    ensure!(message(&second).contains(&holder), "it does not name {holder}: {}", message(&second));
    stage.check(&stage.out)
}

/// Sends a signal, named as kill(1) has it.
fn send(signal: &str, child: &Child) -> Result<()> {
    command::run(&mut command("kill", &[signal, &child.id().to_string()]))
}
