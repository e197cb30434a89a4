//! What is drawn for one image.

use super::{Fog, Lamp, TimelineMoment, Vary};
use crate::random::uniform;
use crate::views;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{Camera, Lens};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::LitBy;
use serde::{Deserialize, Serialize};

/// What an image was given beside what its scene brings; its lens belongs to its camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variation {
    /// Chooses every object's material, texture, mean free path and movement.
    pub seed: u32,
    /// The only light but for those of surfaces and the environment; without it, the scene has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lamp: Option<Lamp>,
    /// What is between the surfaces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fog: Option<Fog>,
    /// Which moment of a timeline it shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moment: Option<TimelineMoment>,
}

/// What random numbers are for, so that none is used twice.
pub(crate) mod purpose {
    pub const LENS: u64 = 1;
    pub const LAMP: u64 = 2;
    pub const FOG: u64 = 3;
    pub const MATERIAL: u64 = 4;
    pub const TEXTURE: u64 = 5;
    pub const MEAN_FREE_PATH: u64 = 6;
    pub const MOTION: u64 = 7;
    pub const TIME: u64 = 8;
    pub const POOL: u64 = 9;
    pub const SENSOR_DEPTH: u64 = 10;
    pub const SENSOR_COLOUR: u64 = 11;
    pub const SIZE: u64 = 12;
    pub const FIELD_OF_VIEW: u64 = 13;
    pub const RADIUS: u64 = 14;
    pub const ENVIRONMENT: u64 = 15;
    pub const HAS_ENVIRONMENT: u64 = 16;
}

/// Whether an effect shows light that lamps may be the source of.
const fn shows_lamps(effect: Effect) -> bool {
    !matches!(effect.lit_by(), LitBy::Nothing | LitBy::Environment)
}

/// What an image of a scene gets from its seed: a lens, and the rest. `None` where nothing is varied.
pub(super) fn draw(
    vary: Option<&Vary>,
    effect: Effect,
    scene: &TracedScene,
    camera: Camera,
    [height, width]: [usize; 2],
    seed: u32,
) -> (Camera, Option<Variation>) {
    let nothing = Vary::default();
    let table = vary.unwrap_or(&nothing);
    let lens = table.lens.map(|range| drawn_lens(range, scene, &camera, [height, width], seed));
    let camera = Camera { lens: lens.or(camera.lens), ..camera };
    let dark = if effect.is_lit_by_lamps_alone() {
        scene.scene().lights.is_empty()
    } else {
        table.environment.is_none() && scene.scene().is_dark()
    };
    let lamp = shows_lamps(effect) && (table.light || dark);
    if vary.is_none() && !lamp {
        return (camera, None);
    }
    let variation = Variation {
        seed,
        lamp: lamp.then(|| Lamp::drawn(scene, &camera, [height, width], seed)),
        fog: table.fog.map(|range| Fog::drawn(range, scene, seed)),
        moment: None,
    };
    (camera, Some(variation))
}

/// A lens that focuses what a random ray of the image meets, with a radius from the range of its blur.
fn drawn_lens(range: [f32; 2], scene: &TracedScene, camera: &Camera, size: [usize; 2], seed: u32) -> Lens {
    let words = |which: u64| [u64::from(seed), purpose::LENS, which];
    let seen = views::seen_points(scene, camera, size);
    let chosen = seen.get((uniform(&words(0)) * seen.len() as f32) as usize);
    // Where nothing is seen, nothing is in focus.
    let focus = chosen.map_or(scene.diagonal(), |point| -camera.to_camera(point.position).z);
    let blur = between(range, uniform(&words(1)));
    Lens { radius: blur * focus / camera.focal_length(size[0]), focus }
}

/// The number at a share of a range.
pub(super) fn between([low, high]: [f32; 2], share: f32) -> f32 {
    low + (high - low) * share
}

/// The number at a share of a range in which every ratio is as likely.
pub(super) fn between_ratios([low, high]: [f32; 2], share: f32) -> f32 {
    low * (high / low).powf(share)
}
