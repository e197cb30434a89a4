//! Placeholder until its owner writes it.

/// The whole chain.
#[derive(clap::Args)]
pub struct Args {}

/// Runs the demo.
pub fn run(_: &Args) -> anyhow::Result<()> {
    anyhow::bail!("the demo is not written yet")
}
