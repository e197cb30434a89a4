//! `deepshade infer`: a network on a g-buffer file, whichever renderer wrote it.

mod camera;
mod contract;
mod normals;
mod projection;
mod reach;
mod read;
mod sky;
mod space;

use crate::arguments::{image_file, positive, written_file};
use crate::figures::Figures;
use crate::learned::{self, Learned};
use crate::location::Location;
use crate::report::images::{shown, write_png};
use anyhow::{Context, Result, ensure};
use deepshade_infer::Model;
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::method::{Repeats, Shaded};
use deepshade_render::metrics::{exposed, exposure};
use deepshade_shaders::gpu::Gpu;
use read::{Read, ReadRequest};
use std::path::{Path, PathBuf};

/// Runs a network on a g-buffer file from any renderer.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  deepshade infer --model models/ao --gbuffer in.exr --out out.exr --radius 0.5\n\n\
    The file needs the network's inputs as layers, for ambient occlusion `normal.X/Y/Z` and \
    `position.X/Y/Z`: in camera space, metres, y up, the camera looking down -z. Options convert files in \
    another space or unit; one that contradicts this is refused. No surface is seen where a layer `valid` is \
    0 or, in a file without that layer, where all inputs are 0; nor, in any file, where one of the inputs or \
    the depth is not finite, a length is 65504 or at least 1e9, or a normal has no length. A number that \
    fills much of the image and is a hundred times all others is taken for the sky, with a note. The \
    book's chapter on your own g-buffer states unit, sign and space of every layer that a network may read."
)]
pub struct Args {
    /// Folder, address or name of the network.
    #[arg(long, value_parser = crate::learned::place)]
    model: Location,
    /// G-buffer, an EXR file.
    #[arg(long)]
    gbuffer: PathBuf,
    /// Which layer of a file with several, such as a scene's view layers or the views of a stereo image, by
    /// its name.
    #[arg(long, value_name = "NAME", value_parser = crate::arguments::name)]
    layer: Option<String>,
    #[command(flatten)]
    space: space::Args,
    /// Takes a g-buffer as it is, though it contradicts what it should be.
    #[arg(long)]
    trusted: bool,
    /// Image to write: an EXR file with one layer, the effect's name, or a PNG file, which shows it.
    #[arg(long, value_parser = image_file)]
    out: PathBuf,
    /// How far the effect reaches, metres; by default what the file's attribute `radius_metres` says, else a
    /// share of the diagonal of what is seen, the one that the network states, and at most a quarter of its
    /// median depth.
    #[arg(long, value_parser = positive)]
    radius: Option<f32>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = written_file)]
    json: Option<PathBuf>,
}

/// Reads, computes, writes.
///
/// # Errors
/// If model or g-buffer cannot be read or do not fit each other, the GPU fails, or the image cannot be
/// written.
pub fn run(args: &Args) -> Result<()> {
    args.space.check()?;
    let model = Model::load(&args.model.read()?)?;
    let Args { gbuffer: path, layer, space, trusted, .. } = args;
    let wanted = ReadRequest { path, layer: layer.as_deref(), space, trusted: *trusted };
    let Read { gbuffer, windows, file } = read::read(&wanted, &model.spec)?;
    let radius = match args.radius {
        Some(radius) => radius,
        None => reach::default_radius(&file, &gbuffer, &model.spec)
            .with_context(|| args.gbuffer.display().to_string())?,
    };
    if let Some(doubt) = reach::doubt(&gbuffer, radius) {
        note!("{doubt}");
    }
    let length = model.spec.reach.position_scale(radius);
    ensure!(length.is_finite(), "radius {radius} m is too small: positions cannot be multiplied by {length}");
    let gpu = Gpu::new().inspect_err(|error| note!("{error}; the processor runs the network")).ok();
    let learned =
        gpu.as_ref().map_or_else(|| Learned::on_processor(&model), |gpu| Learned::new(gpu, &model))?;
    if let Some(warning) = learned::outside(&model.spec, &gbuffer, radius) {
        note!("{warning}");
    }
    let Shaded { image, device, .. } = learned.image(&gbuffer, radius, Repeats::ONCE)?;
    let effect = model.spec.effect;
    let [least, most] = effect.range();
    let image = image.map(|value| value.clamp(least, most));
    let metadata = Metadata::from([
        ("gbuffer".to_owned(), args.gbuffer.display().to_string()),
        ("model".to_owned(), args.model.to_string()),
        ("radius_metres".to_owned(), radius.to_string()),
    ]);
    match is_png(&args.out) {
        true => write_png(&args.out, &shown(&exposed(&image, exposure(effect, &image))))?,
        false => {
            exr_file::write_within(&args.out, &[Layer::image(effect.name(), &image)], &metadata, &windows)?;
        }
    }

    let mean = image.mean();
    let mut figures = Figures::new("infer");
    figures.set("radius", f64::from(radius));
    figures.set("mean", mean);
    figures.detail("device", device.as_str().into());
    figures.write(args.json.as_deref())?;
    say!("{}: {effect}, {} x {}, radius {radius} m", args.out.display(), image.width(), image.height())?;
    say!("{device}, mean {mean:.4}")
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
}
