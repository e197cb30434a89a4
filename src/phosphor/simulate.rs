//! `deepshade phosphor simulate`: measurements of a material that is known.

use super::materials::{named, of};
use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_render::phosphor::fit::Laboratory;
use deepshade_render::phosphor::spectrum::lights::Light;
use std::path::PathBuf;

/// Simulates the measurement of a known material by the thesis' procedure, with a camera's noise.
///
/// Writes the files that `fit` reads: photographs of the decay, through filters, and after light of one band after the other,
/// with the curves of camera and filters, and of the lamp where it is no halogen lamp.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade phosphor simulate orange --out measured")]
pub struct Args {
    /// The material's name.
    material: String,
    /// A file of materials; by default those of `deepshade phosphor materials`.
    #[arg(long)]
    materials: Option<PathBuf>,
    /// The lamp that excites it: halogen, incandescent, mercury, led or daylight.
    #[arg(long, default_value = "halogen", value_parser = lamp)]
    lamp: Light,
    /// Folder for the files, which is made.
    #[arg(long)]
    out: PathBuf,
    /// Chooses the noise.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// Measures and writes.
///
/// # Errors
/// If there is no such material, it is of other than eight bands, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let materials = of(args.materials.as_deref())?;
    let laboratory = Laboratory { lamp: args.lamp, ..Laboratory::thesis() };
    let measurement = laboratory.measure(named(&materials, &args.material)?, args.seed)?;
    std::fs::create_dir_all(&args.out).with_context(|| args.out.display().to_string())?;
    for (name, text) in laboratory.files(&measurement) {
        write_atomically(&args.out.join(name), text.as_bytes())?;
    }
    say!("{}", args.out.display())
}

/// A lamp by its name.
fn lamp(name: &str) -> Result<Light, String> {
    Light::ALL.into_iter().find(|light| light.name() == name).ok_or_else(|| {
        let names = Light::ALL.map(Light::name).join(", ");
        format!("there is no lamp `{name}`; there are {names}")
    })
}
