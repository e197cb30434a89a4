//! `deepshade phosphor`: phosphorescent materials, those that there are, those that are measured and those that are
//! designed (thesis, sections 8.4 and 8.6).

mod design;
mod fit;
mod materials;
mod particles;
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
    /// Finds materials that make places of a scene look as they should at certain moments.
    Design(design::Args),
    /// Simulates the measurement of a known material: files for `fit`.
    Simulate(simulate::Args),
    /// Makes a scene of particles that move, each of which keeps light of its own.
    Particles(particles::Args),
}

/// Does it.
///
/// # Errors
/// If a file cannot be read or written, or says what makes no sense.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Materials(args) => materials::run(args),
        Verb::Fit(args) => fit::run(args),
        Verb::Design(args) => design::run(args),
        Verb::Simulate(args) => simulate::run(args),
        Verb::Particles(args) => particles::run(args),
    }
}
