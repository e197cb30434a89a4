//! A medium drawn for an image.

use super::FogRange;
use super::draw::{between, between_ratios, purpose};
use crate::random::{mix, uniform};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::medium::{MediumError, Weather};
use deepshade_render::scene::{Bounds, Density, Medium};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A medium that fills a scene's box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fog {
    /// Absorption coefficient, 1/m, RGB.
    pub absorption: Vec3,
    /// Scattering coefficient, 1/m, RGB.
    pub scattering: Vec3,
    /// Mean cosine of the scattering angle.
    pub anisotropy: f32,
    /// Seed of the smoke on a grid; without it, the medium is the same everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smoke: Option<u32>,
}

/// How far the medium reaches beyond the scene's box, as a share of the diagonal.
const MARGIN: f32 = 0.1;
/// Cells of smoke along the longest edge of its box.
const CELLS: usize = 48;

impl Fog {
    /// The medium of a seed: grey to slightly coloured, absorbing from almost nothing to two fifths of what
    /// it meets, scattering from a little backwards to strongly forwards.
    pub(super) fn drawn(range: FogRange, scene: &TracedScene, seed: u32) -> Self {
        let draw = |which: u64| uniform(&[u64::from(seed), purpose::FOG, which]);
        let extinction = between_ratios(range.optical_depth, draw(0)) / scene.diagonal();
        let tint = Vec3::new(draw(1), draw(2), draw(3)) - 0.5;
        let albedo = Vec3::splat(between([0.65, 0.95], draw(4))) + 0.1 * tint;
        let smoke = mix(&[u64::from(seed), purpose::FOG, 7]) as u32;
        // Smoke covers a part of its box; where it is, it is denser.
        let (smoke, extinction) =
            if draw(5) < range.smoke_share { (Some(smoke), 2.0 * extinction) } else { (None, extinction) };
        Self {
            absorption: (1.0 - albedo) * extinction,
            scattering: albedo * extinction,
            anisotropy: between([-0.2, 0.8], draw(6)),
            smoke,
        }
    }

    /// The medium in a scene.
    ///
    /// # Errors
    /// If the scene is so small for its distance from the origin that smoke is too fine, or as
    /// [`Medium::check`].
    pub(super) fn medium(&self, scene: &TracedScene) -> Result<Medium, MediumError> {
        let margin = Vec3::splat(MARGIN * scene.diagonal());
        let Bounds { min, max } = scene.bounds();
        let bounds = Bounds { min: min - margin, max: max + margin };
        let density = match self.smoke {
            None => Density::Within(bounds),
            Some(seed) => {
                let share = |which: u64| uniform(&[u64::from(seed), which]);
                let billow = bounds.diagonal() * between([0.08, 0.25], share(0));
                let smoke = Weather::smoke(seed, billow, between([0.4, 0.8], share(1)));
                Density::Grid(smoke.grid(bounds, CELLS, 0.0)?)
            }
        };
        Medium::new(self.absorption, self.scattering, self.anisotropy, density)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::{Material, Mesh, Scene};

    /// A triangle of 2 m so far from the origin.
    fn scene(distance: f32) -> TracedScene {
        let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::new(0.0, 2.0, 2.0)];
        let mesh = Mesh {
            positions: corners.map(|corner| corner + Vec3::X * distance).to_vec(),
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let materials = vec![Material::default()];
        TracedScene::new(Scene { meshes: vec![mesh].into(), materials, ..Scene::default() })
            .expect("a triangle")
    }

    #[test]
    fn where_there_can_be_no_fog_is_an_error() {
        let fog = |smoke| Fog { absorption: Vec3::ZERO, scattering: Vec3::ONE, anisotropy: 0.0, smoke };
        for smoke in [None, Some(3)] {
            assert!(fog(smoke).medium(&scene(0.0)).is_ok());
        }
        assert!(matches!(fog(Some(3)).medium(&scene(2e6)), Err(MediumError::Weather { .. })));
        let thick = Fog { scattering: Vec3::splat(1e7), ..fog(None) };
        assert!(matches!(thick.medium(&scene(0.0)), Err(MediumError::Coefficient { .. })));
    }
}
