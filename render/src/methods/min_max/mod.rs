//! `min-max`: single scattering by a one-dimensional min/max mipmap in each epipolar slice.
//!
//! Chen, Baran, Durand and Jarosz 2011, "Real-Time Volumetric Shadows using 1D Min-Max Mipmaps". The slices,
//! light rays and rectified shadow map are those of [`epipolar`](super::epipolar). Over the light rays of a
//! slice lies a binary tree of where the least and the greatest of them end ([`mipmap`]); a view ray walks it
//! and comes to the runs of light rays that are lit where it passes. What a run sends is, of a distant lamp
//! whose rays are alike, a closed form; of others, the difference of two prefix sums of the integrand's
//! terms.
//!
//! Why it: view rays do not depend on each other, and nothing is approximated for suns. Why not: it costs as
//! much as a view ray has edges of shadows, the logarithm of the light rays for each.

mod integration;
mod mipmap;

use super::Quality;
use super::epipolar::{REPRESENTED, Rectified, Terms};
use super::ray_march::March;
use super::shafts::{Integration, IntegrationInputs};
use glam::Vec3;
use integration::{ClosedForm, PrefixSums};

/// What it may take.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct MinMaxParameters {
    /// Light rays in a slice, each with four samples of its depth.
    #[schemars(range(min = 16, max = 16384))]
    pub light_rays: usize,
    /// Texels along an edge of a shadow map; the nested maps of a sun have as many together.
    #[schemars(range(min = 64, max = 8192), extend("unit" = "texels", "multipleOf" = 64))]
    pub shadow_size: usize,
    /// View rays that cross fewer light rays are marched,
    #[schemars(range(min = 0.0, max = 1024.0))]
    pub least_light_rays: f32,
    /// in so many steps.
    #[schemars(range(min = 1, max = 4096))]
    pub steps: u32,
}

impl MinMaxParameters {
    /// More time is more light rays and finer shadow maps.
    pub const fn of(quality: Quality) -> Self {
        let (light_rays, shadow_size, steps) = match quality {
            Quality::Low => (256, 1024, 32),
            Quality::Medium => (512, 1024, 64),
            Quality::High => (1024, 2048, 128),
            Quality::Ultra => (4096, 4096, 512),
        };
        Self { light_rays, shadow_size, least_light_rays: 8.0, steps }
    }
}

impl Integration for MinMaxParameters {
    const NAME: &'static str = "min-max";
    const WANTS_EVEN_FOG: bool = true;

    fn shadow_size(&self) -> usize {
        self.shadow_size
    }

    fn add(&self, lit: &IntegrationInputs<'_>, radiance: &mut [Vec3]) {
        let march = March::new(lit, 0);
        let marched = |ray: usize| march.shifted(ray, self.steps);
        let has_closed_form = lit.lamp.is_distant() && lit.lamp.is_even();
        let most_magnified = if has_closed_form { REPRESENTED } else { Terms::Twelve.most_magnified() };
        let Some(rectified) = Rectified::new(lit, self.light_rays, self.least_light_rays, most_magnified)
        else {
            return march.add(self.steps, radiance);
        };
        match (has_closed_form, rectified.are_coloured()) {
            (true, false) => rectified.add::<1, 1, ClosedForm>(radiance, marched),
            (true, true) => rectified.add::<3, 3, ClosedForm>(radiance, marched),
            (false, false) => rectified.add::<12, 1, PrefixSums<12>>(radiance, marched),
            (false, true) => rectified.add::<36, 3, PrefixSums<36>>(radiance, marched),
        }
    }
}
