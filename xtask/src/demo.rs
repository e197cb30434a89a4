//! `cargo xtask demo`: the program's main job on a machine that has only a Rust toolchain.

use crate::{
    command::{self, cargo},
    vulkan,
};
use anyhow::Result;

/// What the demo needs of the program: neither the window nor object stores.
const FEATURES: &str = "train";

/// Sets up and runs `deepshade demo`.
///
/// # Errors
/// If there is no Vulkan adapter, or the program does not build or fails.
pub fn run(args: &[String]) -> Result<()> {
    vulkan::ensure()?;
    let parts = ["--no-default-features", "--features", FEATURES];
    let mut demo = cargo(&[&["run", "--release", "--locked"], &parts[..], &["--", "demo"]].concat());
    command::run(demo.args(args))
}
