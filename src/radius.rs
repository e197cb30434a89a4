//! How far an effect reaches: as far as is stated, else by a default, which is said.

use deepshade_dataset::views::median_depth;
use deepshade_infer::Reach;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;

/// The default radius as a share of the scene's diagonal, where no network states its own.
const USUAL_SHARE: f32 = 0.03;

/// Most of the median depth of what is seen that a default radius is: from nearby the share of a large scene
/// would be most of the image.
const MOST_OF_DEPTH: f32 = 0.25;

/// What a default radius depends on.
#[derive(Clone, Copy, Debug)]
pub struct Space {
    /// Diagonal of the scene, metres.
    pub diagonal: f32,
    /// Median depth of what is seen, metres, where there is a view and it shows something.
    pub depth: Option<f32>,
}

impl Space {
    /// That of a scene as a camera sees it in an image of `[height, width]`.
    pub fn seen(scene: &TracedScene, camera: &Camera, size: [usize; 2]) -> Self {
        Self { diagonal: scene.diagonal(), depth: median_depth(scene, camera, size) }
    }

    /// The default radius, metres, whatever the resolution: the network's share of the diagonal, or that of
    /// methods without one, and at most a share of the depth.
    fn usual_radius(self, reach: Option<Reach>) -> f32 {
        let share = reach.map_or(USUAL_SHARE, |reach| reach.diagonal_share);
        let most = self.depth.map_or(f32::INFINITY, |depth| MOST_OF_DEPTH * depth);
        (share * self.diagonal).min(most)
    }
}

/// The radius of some effects, metres: the one that is stated, else the default of the network that computes
/// them, or of methods without one; no farther than the scene, beyond which there is nothing. A default is
/// said where one of the effects listens to it.
pub fn wanted(stated: Option<f32>, reach: Option<Reach>, effects: &[Effect], space: Space) -> f32 {
    let radius = stated.unwrap_or_else(|| {
        let radius = space.usual_radius(reach);
        if effects.iter().any(|effect| effect.listens_to(EffectSetting::Radius)) {
            note!("radius: {}, the default", in_words(radius, space.diagonal));
        }
        radius
    });
    radius.min(space.diagonal)
}

/// A radius in metres and as a share of the diagonal.
pub fn in_words(radius: f32, diagonal: f32) -> String {
    format!("{radius:.3} m, {:.1} % of the diagonal", 100.0 * radius / diagonal)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NETWORK: Reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 512 };

    fn usual(reach: Option<Reach>, depth: Option<f32>) -> f32 {
        wanted(None, reach, &[Effect::Ao], Space { diagonal: 20.0, depth })
    }

    #[test]
    fn the_default_radius_is_a_share_of_the_scene_and_at_most_one_of_the_depth() {
        for (reach, depth, radius) in [
            (None, None, 0.6),
            (Some(NETWORK), None, 2.0),
            (None, Some(8.0), 0.6),
            (Some(NETWORK), Some(8.0), 2.0),
            (Some(NETWORK), Some(4.0), 1.0),
            (None, Some(1.0), 0.25),
        ] {
            let found = usual(reach, depth);
            assert!((found - radius).abs() < 1e-5, "{reach:?}, {depth:?}: {found}");
        }
    }

    #[test]
    fn the_default_radius_does_not_depend_on_the_rows_of_training() {
        let low = Reach { height: 64, ..NETWORK };
        assert_eq!(usual(Some(low), None), usual(Some(NETWORK), None));
        let wide = Reach { diagonal_share: 0.2, ..NETWORK };
        assert_ne!(usual(Some(wide), None), usual(Some(NETWORK), None), "but on their share");
    }

    #[test]
    fn a_stated_radius_is_taken_up_to_the_whole_scene() {
        let stated = |radius: f32| {
            wanted(Some(radius), None, &[Effect::Ao], Space { diagonal: 20.0, depth: Some(0.1) })
        };
        assert_eq!((stated(0.3), stated(f32::INFINITY)), (0.3, 20.0));
        assert_eq!(in_words(3.0, 20.0), "3.000 m, 15.0 % of the diagonal");
    }
}
