//! Light in fog in a closed room, in which nothing is lost but to the medium and the walls: its mean over
//! truth's, at some presets.

use super::room;
use anyhow::Result;
use deepshade::shared::figures::Figures;
use deepshade_render::bvh::TracedScene;
use deepshade_render::methods::Quality;
use deepshade_render::methods::lpv::LpvParameters;
use deepshade_render::methods::lpv::in_medium::InMedium;
use deepshade_render::path::{self, Sampling, Shot};
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, Planes};

/// Rows and columns.
const SIZE: [usize; 2] = [36, 48];
/// What the walls reflect.
const ALBEDOS: [f32; 3] = [0.2, 0.5, 0.8];
const EFFECTS: [Effect; 2] = [Effect::FogIndirect, Effect::FogMultiple];

/// One room and preset.
struct Ratio {
    albedo: f32,
    effect: Effect,
    quality: Quality,
    /// Mean of the image over truth's.
    ratio: f64,
}

/// Of all rooms and some presets.
pub struct ClosedRooms<'a> {
    qualities: &'a [Quality],
    ratios: Vec<Ratio>,
}

impl<'a> ClosedRooms<'a> {
    /// With truth of so many samples a pixel.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, samples: u32, qualities: &'a [Quality]) -> Result<Self> {
        let mut ratios = Vec::new();
        for albedo in ALBEDOS {
            for effect in EFFECTS {
                let truth = truth(albedo, effect, samples)?.mean();
                for &quality in qualities {
                    let ratio = image(gpu, albedo, effect, quality)?.mean() / truth;
                    // At the finest presets one takes minutes.
                    note!("{effect}, albedo {albedo}, {}: {ratio:.3} of truth", quality.name());
                    ratios.push(Ratio { albedo, effect, quality, ratio });
                }
            }
        }
        Ok(Self { qualities, ratios })
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        for Ratio { albedo, effect, quality, ratio } in &self.ratios {
            let effect = effect.name().replace('-', "_");
            figures.set(&format!("room_{effect}_{albedo}_{}", quality.name()), *ratio);
        }
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let names = self.qualities.iter().map(|quality| quality.name().to_owned());
        let head = ["in a closed room", "albedo"].map(str::to_owned).into_iter().chain(names).collect();
        let row = |of: &[Ratio]| {
            let ratios = of.iter().map(|of| format!("{:.3}", of.ratio));
            [of[0].effect.name().to_owned(), of[0].albedo.to_string()].into_iter().chain(ratios).collect()
        };
        std::iter::once(head).chain(self.ratios.chunks(self.qualities.len()).map(row)).collect()
    }
}

fn truth(albedo: f32, effect: Effect, samples: u32) -> Result<Planes> {
    let (scene, camera) = room::foggy(albedo)?;
    let scene = TracedScene::new(scene)?;
    let shot = Shot::new(&scene, &camera, SIZE, scene.diagonal());
    Ok(path::render(effect, &shot, Sampling::one(samples, 1)).mean)
}

fn image(gpu: &Gpu, albedo: f32, effect: Effect, quality: Quality) -> Result<Planes> {
    let (scene, camera) = room::foggy(albedo)?;
    let parameters = LpvParameters::of(quality);
    let light = match effect {
        Effect::FogIndirect => InMedium::indirect(parameters),
        _ => InMedium::multiple(parameters),
    };
    room::image(&ScreenMethod::new(gpu, light), scene, &camera, SIZE)
}
