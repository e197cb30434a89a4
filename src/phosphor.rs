//! `deepshade phosphor`: phosphorescent materials, those that there are and those that are measured (thesis, section 8.4).

mod fit;
mod materials;
mod self_test;
mod simulate;

use anyhow::Result;

/// What to do with phosphorescent materials.
#[derive(clap::Subcommand)]
pub enum Verb {
    /// Lists the materials that are known by name, or those of a file.
    Materials(materials::Args),
    /// Fits a material to measurements, or tests such fits on simulated ones.
    Fit(fit::Args),
    /// Simulates the measurement of a known material: files for `fit`.
    Simulate(simulate::Args),
}

/// Does it.
///
/// # Errors
/// If a file cannot be read or written, or says what makes no sense.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Materials(args) => materials::run(args),
        Verb::Fit(args) => fit::run(args),
        Verb::Simulate(args) => simulate::run(args),
    }
}
