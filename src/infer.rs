//! `deepshade infer`: a network on a g-buffer file, whichever renderer wrote it.

use crate::arguments::positive;
use crate::figures::Figures;
use crate::learned::{self, Learned};
use crate::place::Place;
use crate::radius::{self, Space};
use anyhow::{Context, Result, anyhow, ensure};
use deepshade_infer::{Model, NetSpec};
use deepshade_render::exr_file::{self, ExrImage, Layer, Metadata};
use deepshade_render::method::{Repeats, Shaded};
use deepshade_render::scene::Bounds;
use deepshade_shaders::{Attribute, GBuffer, Planes, gpu::Gpu};
use glam::Vec3;
use std::path::PathBuf;

/// Runs a network on a g-buffer file from any renderer.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  deepshade infer --model models/ao --gbuffer in.exr --out out.exr --radius 0.5\n\n\
    The file needs the network's inputs as layers, for ambient occlusion `normal.X/Y/Z` and `position.X/Y/Z`: in camera \
    space, metres, y up, the camera looking down -z. No surface is seen where a layer `valid` is 0 or, in a file without \
    that layer, where all inputs are 0; nor, in any file, where one of the inputs is not finite. The README's section `Your \
    own g-buffers` states unit, sign and space of every layer that a network may read."
)]
pub struct Args {
    /// Folder or address of the network.
    #[arg(long)]
    model: Place,
    /// G-buffer, an EXR file.
    #[arg(long)]
    gbuffer: PathBuf,
    /// Image to write, an EXR file with one layer, the effect's name.
    #[arg(long, value_parser = crate::arguments::exr_file)]
    out: PathBuf,
    /// How far the effect reaches, metres; by default what the file's attribute `radius_metres` says, else a share of the
    /// diagonal of what is seen, the one that the network states, and at most a quarter of its median depth.
    #[arg(long, value_parser = positive)]
    radius: Option<f32>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Reads, computes, writes.
///
/// # Errors
/// If model or g-buffer cannot be read or do not fit each other, the GPU fails, or the image cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let model = Model::load(&args.model.read()?)?;
    let file = exr_file::read(&args.gbuffer)?;
    let gbuffer = gbuffer(&file, &model.spec)?;
    let radius = match args.radius {
        Some(radius) => radius,
        None => default_radius(&file, &gbuffer, &model.spec)
            .with_context(|| args.gbuffer.display().to_string())?,
    };
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
    let metadata = Metadata::from([
        ("gbuffer".to_owned(), args.gbuffer.display().to_string()),
        ("model".to_owned(), args.model.to_string()),
        ("radius_metres".to_owned(), radius.to_string()),
    ]);
    exr_file::write(&args.out, &[Layer::image(effect.name(), &image)], &metadata)?;

    let mean = mean(&image);
    let mut figures = Figures::new("infer");
    figures.set("radius", f64::from(radius));
    figures.set("mean", mean);
    figures.detail("device", device.as_str().into());
    figures.write(args.json.as_deref())?;
    say!("{}: {effect}, {} x {}, radius {radius} m", args.out.display(), image.width(), image.height())?;
    say!("{device}, mean {mean:.4}")
}

/// What the network's inputs are made of, and validity.
fn gbuffer(file: &ExrImage, spec: &NetSpec) -> Result<GBuffer> {
    let mut attributes = learned::reads(spec)?;
    attributes.retain(|attribute| *attribute != Attribute::Valid || spec.inputs.contains(attribute));
    if !attributes.contains(&Attribute::Valid) && file.attributes().contains(&Attribute::Valid) {
        attributes.push(Attribute::Valid);
    }
    let gbuffer = file.gbuffer(&attributes)?;
    Ok(if attributes.contains(&Attribute::Valid) { gbuffer } else { with_validity(gbuffer) })
}

/// The g-buffer with a plane `valid`: 1 where any of its channels is not 0.
fn with_validity(gbuffer: GBuffer) -> GBuffer {
    let planes = gbuffer.planes();
    let seen = |pixel: usize| (0..planes.channels()).any(|c| planes.plane(c)[pixel] != 0.0);
    let valid = (0..planes.pixels()).map(|pixel| if seen(pixel) { 1.0 } else { 0.0 });
    let data = planes.data().iter().copied().chain(valid).collect();
    let attributes = [gbuffer.attributes(), &[Attribute::Valid]].concat();
    GBuffer::new(attributes, Planes::from_data(planes.channels() + 1, planes.height(), planes.width(), data))
}

/// The radius that the file states, or else the network's share of the diagonal of what is seen.
fn default_radius(file: &ExrImage, gbuffer: &GBuffer, spec: &NetSpec) -> Result<f32> {
    if let Some(radius) = file.metadata().get("radius_metres") {
        return positive(radius).map_err(|what| anyhow!("attribute `radius_metres`: {what}"));
    }
    let diagonal = visible_diagonal(gbuffer)
        .context("no radius is stated and no positions tell the size; use --radius")?;
    ensure!(
        diagonal > 0.0 && diagonal.is_finite(),
        "no radius is stated and what is seen has a diagonal of {diagonal} m; use --radius"
    );
    let space = Space { diagonal, depth: median_depth(gbuffer)? };
    Ok(radius::wanted(None, Some(spec.reach), &[spec.effect], space))
}

/// Diagonal of the bounds of all visible positions, metres.
fn visible_diagonal(gbuffer: &GBuffer) -> Result<f32> {
    let planes = gbuffer.select(&[Attribute::Position])?;
    let seen = gbuffer.seen()?;
    let seen = (0..planes.pixels()).filter(|pixel| seen[*pixel]);
    let position = |pixel| Vec3::from_array([0, 1, 2].map(|c| planes.plane(c)[pixel]));
    let bounds = seen.map(position).fold(Bounds::EMPTY, Bounds::grow);
    ensure!(bounds != Bounds::EMPTY, "no surface is seen");
    Ok(bounds.diagonal())
}

/// Median depth of what is seen, metres; none where nothing is in front of the camera.
fn median_depth(gbuffer: &GBuffer) -> Result<Option<f32>> {
    let planes = gbuffer.select(&[Attribute::Position])?;
    let seen = gbuffer.seen()?;
    let in_front = planes.plane(2).iter().zip(&seen).filter(|(z, seen)| **seen && **z < 0.0);
    let mut depths: Vec<f32> = in_front.map(|(z, _)| -z).collect();
    depths.sort_unstable_by(f32::total_cmp);
    Ok(depths.get(depths.len() / 2).copied())
}

fn mean(image: &Planes) -> f64 {
    image.data().iter().map(|value| f64::from(*value)).sum::<f64>() / image.data().len() as f64
}
