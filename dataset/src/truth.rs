//! What a pair of an effect consists of: which attributes its g-buffer holds, and which integrator gives its target.
//! The one list to add an effect to.

use deepshade_render::bvh::TracedScene;
use deepshade_render::path::ao::Ao;
use deepshade_render::scene::Camera;
use deepshade_shaders::{Attribute, Effect, Planes};

/// A picture to be taken.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// Of what.
    pub scene: &'a TracedScene,
    /// From where.
    pub camera: &'a Camera,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Samples of a pixel.
    pub samples: u32,
    /// Chooses the samples.
    pub seed: u32,
}

/// The attributes that pairs of an effect hold: what its networks and its analytic methods read.
pub const fn attributes(effect: Effect) -> &'static [Attribute] {
    match effect {
        Effect::Ao => &[Attribute::Position, Attribute::Normal, Attribute::Valid],
    }
}

/// Truth, `[effect.channels(), height, width]`.
pub fn render(effect: Effect, shot: &Shot<'_>) -> Planes {
    render_where(effect, shot, |_, _| true)
}

/// [`render`] for the pixels (x, y) that are wanted; the others have the effect's background.
pub fn render_where(effect: Effect, shot: &Shot<'_>, wanted: impl Fn(usize, usize) -> bool + Sync) -> Planes {
    match effect {
        Effect::Ao => Ao { radius: shot.radius, samples: shot.samples, seed: shot.seed }.render_where(
            shot.scene,
            shot.camera,
            shot.height,
            shot.width,
            wanted,
        ),
    }
}

/// The unit of an effect's values, for people who open the files.
pub const fn units(effect: Effect) -> &'static str {
    match effect {
        Effect::Ao => {
            "position in metres; ambient occlusion as the open share of the hemisphere, without unit"
        }
    }
}
