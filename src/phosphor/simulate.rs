//! `deepshade phosphor simulate`: measurements of a material that is known.

use super::materials::{named, of};
use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_glow::spectrum::lights::Light;
use deepshade_phosphor::curves::Curves;
use deepshade_phosphor::fit::Laboratory;
use std::path::PathBuf;

/// Simulates the measurement of a known material by the thesis' procedure, with a camera's noise.
///
/// Writes the files that `fit` reads: photographs of the decay, through filters, and after light of one band
/// after the other, with the curves of camera and filters, and of the lamp where it is no halogen lamp.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade phosphor simulate orange --out measured\n  \
    deepshade phosphor simulate orange --camera camera.csv --out measured")]
pub struct Args {
    /// The material's name.
    material: String,
    /// A file of materials; by default those of `deepshade phosphor materials`.
    #[arg(long)]
    materials: Option<PathBuf>,
    /// The lamp that excites it: halogen, incandescent, mercury, led or daylight.
    #[arg(long, default_value = "halogen", value_parser = lamp)]
    lamp: Light,
    /// The camera's curves, a table as `fit` reads it: wavelength_nm from 400 to 700, red, green, blue; by
    /// default a nominal camera's.
    #[arg(long)]
    camera: Option<PathBuf>,
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
/// If there is no such material, it is of other than eight bands, or a file cannot be read or written.
pub fn run(args: &Args) -> Result<()> {
    let materials = of(args.materials.as_deref())?;
    let mut laboratory = Laboratory { lamp: args.lamp, ..Laboratory::thesis() };
    if let Some(path) = &args.camera {
        laboratory.sensor = Curves::read_sensor(path)?;
    }
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

#[cfg(test)]
mod tests {
    use super::super::fit::read_exr;
    use super::*;
    use deepshade_phosphor::fit::Measurement;

    #[test]
    fn photographs_are_those_of_the_camera_that_is_given() {
        let folder = tempfile::tempdir().expect("a folder");
        let camera = folder.path().join("camera.csv");
        let curves = "wavelength_nm,red,green,blue\n400,0.1,0.5,1\n700,0.9,0.5,0.25\n";
        std::fs::write(&camera, curves).expect("written");
        let measured = |camera: Option<PathBuf>| {
            let out = folder.path().join(if camera.is_some() { "own" } else { "nominal" });
            let (material, lamp) = ("orange".to_owned(), Light::Halogen);
            run(&Args { material, materials: None, lamp, camera, out: out.clone(), seed: 1 })
                .expect("measured");
            let sensor = Curves::read_sensor(&out.join("camera.csv")).expect("curves");
            (sensor, Measurement::read(&out, read_exr).expect("read").decay[0].radiance())
        };
        let (own, seen) = measured(Some(camera.clone()));
        assert_eq!(own, Curves::read_sensor(&camera).expect("curves"));
        let (nominal, other) = measured(None);
        assert!(own != nominal && seen != other, "{seen:?}");
    }
}
