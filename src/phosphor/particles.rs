//! `deepshade phosphor particles`: a scene file of particles whose paths are known.

use crate::figures::write_atomically;
use anyhow::{Result, ensure};
use deepshade_render::scene::particles::Tracks;
use std::path::PathBuf;

/// Makes a glTF file of particles that move, small octahedra that any scene can take in (`--put`).
///
/// Their paths are those of a table (CSV) with the columns `particle`, `time`, `x`, `y` and `z`, in seconds and metres, as
/// simulations write them; or of a fountain.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade phosphor particles simulated.csv --out spray.glb\n  \
    deepshade phosphor particles --fountain 400 --out fountain.glb\n  \
    deepshade render --animate --scene room:7 --put fountain.glb@0,0,0 --effect phosphor --white 0.05 --out frames")]
pub struct Args {
    /// The table of paths.
    #[arg(required_unless_present = "fountain", conflicts_with = "fountain")]
    tracks: Option<PathBuf>,
    /// A fountain of so many drops in its place.
    #[arg(long, value_name = "DROPS", value_parser = clap::value_parser!(u32).range(1..=MOST as i64))]
    fountain: Option<u32>,
    /// Chooses the fountain's drops.
    #[arg(long, default_value_t = 1, requires = "fountain")]
    seed: u32,
    /// How long the fountain lasts, seconds.
    #[arg(long, default_value_t = 4.0, requires = "fountain")]
    seconds: f32,
    /// Radius of a particle, metres.
    #[arg(long, default_value_t = 0.02)]
    radius: f32,
    /// Name of their material, for files that say what keeps light (`--phosphor`).
    #[arg(long, default_value = "particles", value_parser = crate::arguments::name)]
    material: String,
    /// The glTF file, binary (.glb).
    #[arg(long)]
    out: PathBuf,
}

/// Most particles of a file: joints have 16 bits.
const MOST: u32 = 65_535;
/// Most moments of all particles: 16 bytes each, of which 4 GB can be told.
const MOST_MOMENTS: usize = 50_000_000;

/// Writes the file.
///
/// # Errors
/// If the table cannot be read or says what makes no sense, or the file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    ensure!(args.radius.is_finite() && args.radius > 0.0, "--radius {} is not above 0", args.radius);
    let seconds = args.seconds;
    ensure!((0.1..=600.0).contains(&seconds), "--seconds {seconds} is not from 0.1 to 600");
    let ending = args.out.extension().is_some_and(|ending| ending == "glb");
    ensure!(ending, "--out {}: binary glTF files end in .glb", args.out.display());
    let moments = f64::from(args.fountain.unwrap_or(0)) * f64::from(seconds) * 60.0;
    ensure!(
        moments <= MOST_MOMENTS as f64,
        "a fountain of so many drops for so long is more than a file can have"
    );
    let tracks = match (&args.tracks, args.fountain) {
        (Some(path), _) => Tracks::read(path)?,
        (None, drops) => Tracks::fountain(drops.unwrap_or(1) as usize, seconds, args.seed),
    };
    let count = tracks.count();
    let moments = tracks.moments();
    ensure!(moments <= MOST_MOMENTS, "{moments} rows are more than the {MOST_MOMENTS} that a file can have");
    ensure!(count <= MOST as usize, "{count} particles are more than the {MOST} that a file can have");
    write_atomically(&args.out, &tracks.glb(args.radius, &args.material))?;
    say!("{}: {count} particles", args.out.display())
}
