//! What a grid does to light that moves, and to light beside it: how much images flicker, and how much light
//! is seen behind a wall that is thinner than a cell.

use super::room::{self, Moving};
use anyhow::Result;
use deepshade::shared::figures::Figures;
use deepshade_render::lpv::Scheme;
use deepshade_render::lpv::scheme::Lookup;
use deepshade_render::methods::Quality;
use deepshade_render::methods::lpv::LpvParameters;
use deepshade_render::methods::lpv::in_medium::InMedium;
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::Gpu;

/// Rows and columns.
const SIZE: [usize; 2] = [54, 96];

/// How much images flicker.
pub struct Flicker(Vec<(Moving, f64)>);

/// Light behind a wall over that before it.
pub struct Leaks(Vec<(&'static str, f64)>);

/// The mean, over pixels and over all images but the first and last, of how far an image is from the mean of
/// that before and that after, over the mean of all: 0 where everything changes steadily.
fn flicker(images: &[Planes]) -> f64 {
    let off = |of: &[Planes]| -> f64 {
        let [before, image, after] = [0, 1, 2].map(|i: usize| of[i].data());
        let at = |i: usize| f64::from((image[i] - 0.5 * (before[i] + after[i])).abs());
        (0..image.len()).map(at).sum::<f64>() / image.len() as f64
    };
    let changes: Vec<f64> = images.windows(3).map(off).collect();
    let brightness: f64 = images.iter().map(Planes::mean).sum::<f64>() / images.len() as f64;
    changes.iter().sum::<f64>() / changes.len() as f64 / brightness
}

impl Flicker {
    /// Of so many frames of each motion.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, frames: usize) -> Result<Self> {
        let method = ScreenMethod::new(gpu, InMedium::multiple(LpvParameters::of(Quality::Low)));
        let of = |moving: Moving| {
            let image = |frame: usize| {
                let (scene, camera) = room::in_motion(moving, frame)?;
                room::image(&method, scene, &camera, SIZE)
            };
            let images: Vec<Planes> = (0..frames).map(image).collect::<Result<_>>()?;
            Ok((moving, flicker(&images)))
        };
        Ok(Self(Moving::ALL.into_iter().map(of).collect::<Result<_>>()?))
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        self.0.iter().for_each(|(moving, value)| figures.set(&format!("flicker_{}", moving.name()), *value));
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["what moves", "flicker"].map(str::to_owned).to_vec();
        let row = |(moving, value): &(Moving, f64)| vec![moving.name().to_owned(), format!("{value:.5}")];
        std::iter::once(head).chain(self.0.iter().map(row)).collect()
    }
}

impl Leaks {
    /// With surfaces lit by cells before them and by those that they are in.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu) -> Result<Self> {
        let of = |(name, lookup): (&'static str, Lookup)| {
            let scheme = Scheme { lookup, ..Scheme::OURS };
            let method =
                ScreenMethod::new(gpu, LpvParameters { scheme, ..LpvParameters::of(Quality::Medium) });
            let (scene, cameras) = room::divided();
            let brightness =
                |camera| Ok::<_, anyhow::Error>(room::image(&method, scene.clone(), camera, SIZE)?.mean());
            let [before, behind] = cameras.each_ref().map(brightness);
            Ok((name, behind? / before?))
        };
        let both = [("before", Lookup::Before), ("within", Lookup::Within)];
        Ok(Self(both.into_iter().map(of).collect::<Result<_>>()?))
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        self.0.iter().for_each(|(name, value)| figures.set(&format!("leak_{name}"), *value));
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["surfaces are lit by cells", "light behind a wall"].map(str::to_owned).to_vec();
        let row = |(name, value): &(&str, f64)| vec![(*name).to_owned(), format!("{value:.5}")];
        std::iter::once(head).chain(self.0.iter().map(row)).collect()
    }
}
