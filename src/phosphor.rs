//! `deepshade phosphor`: phosphorescent materials, those that there are, those that are measured and those
//! that are designed (thesis, sections 8.4 and 8.6).

pub mod design;
mod fit;
mod materials;
mod particles;
mod self_test;
mod simulate;

use anyhow::Result;

/// What to do with phosphorescent materials.
#[derive(clap::Subcommand)]
pub enum Verb {
    Materials(materials::Args),
    Fit(fit::Args),
    Design(design::Args),
    Simulate(simulate::Args),
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
