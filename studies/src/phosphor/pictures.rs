//! The room after its lamp has gone out, as in the thesis' Figure 8.15: all light path traced; what of it
//! surfaces send or reflect once, path traced and by frames on the GPU; and what surfaces give back by truth,
//! by states in a frame loop, and by moments of the past.

use super::cornell::{BRIGHT, OFF};
use super::subject::GlowingRoom;
use anyhow::{Context, Result};
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::Figures;
use deepshade::shared::pictures::{shown, write_png};
use deepshade_render::methods::Quality;
use deepshade_render::methods::disks::Disks;
use deepshade_render::methods::phosphor::RateEquationParameters;
use deepshade_render::methods::phosphor::glassner::GlassnerParameters as Moments;
use deepshade_render::methods::surfel;
use deepshade_render::methods::surfel::indirect::{INDIRECT, KEPT_LIGHT};
use deepshade_render::metrics::{exposed, exposure, relative_mse};
use deepshade_render::screen::{MethodPasses, ScreenMethod};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, Planes};
use image::{RgbImage, imageops};
use std::path::{Path, PathBuf};

/// Seconds after the lamp has gone out, and how files name them.
const AFTER: [(f32, &str); 3] = [(-0.1, "lit"), (0.1, "after-0.1s"), (60.0, "after-60s")];
/// Samples of a pixel of light that paths look for.
const SAMPLES: u32 = 256;
/// Seconds between frames.
const STEP: f32 = 0.5;

/// A picture, and how far light by frames is from the same light path traced, as a relative squared error.
pub struct RoomImage {
    pub path: PathBuf,
    name: &'static str,
    error: f64,
}

impl RoomImage {
    /// Sets its figure.
    pub fn set(&self, figures: &mut Figures) {
        figures.set(&format!("relmse_frames_{}", self.name), self.error);
    }
}

/// What is light of surfaces and of the lamp that nothing has reflected, and what is irradiance over pi of
/// that.
struct Light {
    direct: Vec<Planes>,
    indirect: Vec<Planes>,
}

impl Light {
    /// All of it on a surface of a colour.
    fn on(&self, diffuse: &Planes) -> Planes {
        let mut sum = Planes::filled(diffuse.channels(), diffuse.height(), diffuse.width(), 0.0);
        for light in &self.direct {
            sum.data_mut().iter_mut().zip(light.data()).for_each(|(sum, light)| *sum += light);
        }
        for light in &self.indirect {
            let reflected = light.data().iter().zip(diffuse.data()).map(|(light, diffuse)| light * diffuse);
            sum.data_mut().iter_mut().zip(reflected).for_each(|(sum, light)| *sum += light);
        }
        sum
    }
}

/// Writes them into a folder.
///
/// # Errors
/// If the device fails or a file cannot be written.
pub fn write(gpu: &Gpu, folder: &Path, size: Size, rivals: [u32; 2]) -> Result<Vec<RoomImage>> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let mut subject = GlowingRoom::new(gpu, size, BRIGHT, false, vec![[0.0, OFF]])?;
    let states = subject.passes(&ScreenMethod::new(gpu, RateEquationParameters::of(Quality::High)))?;
    let by_surfels = surfel::SurfelParameters::of(Quality::High);
    let kept = subject.passes(&ScreenMethod::new(gpu, Disks::new(by_surfels, KEPT_LIGHT)))?;
    let reflected = subject.passes(&ScreenMethod::new(gpu, Disks::new(by_surfels, INDIRECT)))?;
    let [few, many] = rivals.map(|samples| subject.passes(&ScreenMethod::new(gpu, Moments { samples })));
    let (few, many) = (few?, many?);
    let (mut pictures, mut now) = (Vec::new(), 0.0);
    for (after, name) in AFTER {
        let moment = OFF + after;
        while now + STEP < moment {
            subject.make(now, &[&states, &kept])?;
            now += STEP;
        }
        subject.make(moment, &[&states, &kept, &reflected, &few, &many])?;
        now = moment;
        let shines = after < 0.0;
        let [traced, by_frames] =
            [traced(&subject, moment, shines)?, framed(&subject, [&states, &kept, &reflected], shines)?];
        let truth = subject.truth(Effect::Phosphor, moment, 8)?;
        let everything = subject.truth(Effect::Path, moment, SAMPLES)?;
        let of_light = exposure(Effect::Path, &traced);
        let error = relative_mse(&exposed(&by_frames, of_light), &exposed(&traced, of_light));
        let scale = exposure(Effect::Phosphor, &truth);
        let light = [&everything, &traced, &by_frames].map(|image| exposed(image, of_light));
        let kept = [truth, subject.image(&states)?, subject.image(&few)?, subject.image(&many)?];
        let images: Vec<Planes> =
            light.into_iter().chain(kept.iter().map(|image| exposed(image, scale))).collect();
        let path = folder.join(format!("{name}.png"));
        write_png(&path, &side_by_side(&images, size))?;
        pictures.push(RoomImage { path, name, error });
    }
    Ok(pictures)
}

/// Light that is sent or reflected once, path traced.
fn traced(subject: &GlowingRoom<'_>, moment: f32, shines: bool) -> Result<Planes> {
    let mut light = Light {
        direct: vec![subject.truth(Effect::Phosphor, moment, 8)?],
        indirect: vec![subject.truth(Effect::PhosphorGi, moment, SAMPLES)?],
    };
    if shines {
        light.direct.push(subject.traced(Attribute::DiffuseLight));
        light.indirect.push(subject.truth(Effect::Gi, moment, SAMPLES)?);
    }
    Ok(light.on(&subject.traced(Attribute::Diffuse)))
}

/// The same of the frame that was made last.
fn framed(
    subject: &GlowingRoom<'_>,
    [states, kept, reflected]: [&MethodPasses; 3],
    shines: bool,
) -> Result<Planes> {
    let mut light = Light { direct: vec![subject.image(states)?], indirect: vec![subject.image(kept)?] };
    if shines {
        light.direct.push(subject.attribute(Attribute::DiffuseLight)?);
        light.indirect.push(subject.image(reflected)?);
    }
    Ok(light.on(&subject.attribute(Attribute::Diffuse)?))
}

fn side_by_side(images: &[Planes], Size { width, height }: Size) -> RgbImage {
    let mut all = RgbImage::new((images.len() * width) as u32, height as u32);
    for (index, image) in images.iter().enumerate() {
        imageops::replace(&mut all, &shown(image), (index * width) as i64, 0);
    }
    all
}
