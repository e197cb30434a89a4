//! `epipolar`: single scattering by partial-sum trees in epipolar slices.
//!
//! Baran, Chen, Ragan-Kelley, Durand and Lehtinen 2010, "A Hierarchical Volumetric Shadow Algorithm for
//! Single Scattering". Half-planes through the line from the eye to the light hold view rays and light rays
//! alike ([`geometry`], [`slices`], [`spacing`]). In each, a sweep over the view rays, away from the light
//! ([`order`]), takes light rays out of a tree where they meet a surface ([`terminations`]); what a view ray
//! receives is the sum of those before its end ([`half_tree`], [`sweep`]). What they send is a sum of few
//! products ([`integrand`], [`factors`], [`svd`]).
//!
//! Beyond the paper: point lights, Henyey and Greenstein's phase function, media of other colours than grey,
//! and boxes of fog, which light rays enter and leave as they end: their way to the box is a factor of the
//! light ray's. Pixels ask the trees of both slices that they lie between ([`slice_rays`]). Since what has no
//! bound at the epipole is a factor of the view ray's, the ring around it that must be marched is as small as
//! view rays that cross fewer than a few light rays. Opposite to a sun, and of lamps, the integrand has more
//! terms. View rays on which errors of the products would be magnified are marched, too ([`magnified`]). At
//! its best, the lit segments of sunlight whose rays are alike are integrated in closed form, without a tree
//! ([`segments`]).
//!
//! Why it: a view ray costs the logarithm of the number of light rays, whatever hides the light, where a
//! march costs all of its steps. Why not: media must be the same throughout; shadows are averaged over a
//! pixel to both sides; of a box of dense fog that is seen from outside, only the near part is not marched.

mod exponential;
mod factors;
mod geometry;
mod half_tree;
mod integrand;
mod light_rays;
mod lines;
mod magnified;
mod order;
mod prefilter;
mod rectified;
mod segments;
mod slice_rays;
mod slices;
mod spacing;
mod svd;
mod sweep;
mod terminations;

use super::Quality;
use super::ray_march::March;
use super::shafts::{Integration, IntegrationInputs};
pub use factors::Factors;
pub use geometry::{Geometry, angle, beta};
use glam::Vec3;
pub use light_rays::{SliceOfLight, Traced};
pub use lines::Lines;
pub use prefilter::SAMPLES;
pub use rectified::{Rectified, Slice, SliceIntegration};
use segments::SegmentSweep;
pub use slice_rays::SliceRay;
pub use slices::Slices;
pub use spacing::Spacing;
use sweep::TreeSweep;

/// What it may take.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct EpipolarParameters {
    /// Light rays in a slice.
    #[schemars(range(min = 16, max = 16384))]
    pub light_rays: usize,
    /// Terms of the integrand's decomposition.
    #[schemars(skip)]
    pub terms: Terms,
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

/// How many terms the integrand is decomposed into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Terms {
    /// As in the paper, for distant lights unless the view is opposite to them; else twelve.
    Four,
    /// To the precision of the numbers; where all rays of a distant light are alike none, but the closed form
    /// of each lit segment.
    Twelve,
}

/// Optical depth of which the exponential is far from the largest number.
pub const REPRESENTED: f32 = 60.0;

impl Terms {
    /// The optical depth by whose exponential their errors may be magnified.
    pub const fn most_magnified(self) -> f32 {
        match self {
            Self::Four => 2.0,
            Self::Twelve => 6.0,
        }
    }
}

impl EpipolarParameters {
    /// More time is more light rays and finer shadow maps.
    pub const fn of(quality: Quality) -> Self {
        let (light_rays, terms, shadow_size, steps) = match quality {
            Quality::Low => (512, Terms::Four, 1024, 32),
            Quality::Medium => (1024, Terms::Four, 1024, 64),
            Quality::High => (2048, Terms::Four, 2048, 128),
            Quality::Ultra => (4096, Terms::Twelve, 4096, 512),
        };
        Self { light_rays, terms, shadow_size, least_light_rays: 16.0, steps }
    }
}

impl Integration for EpipolarParameters {
    const NAME: &'static str = "epipolar";
    const WANTS_EVEN_FOG: bool = true;

    fn shadow_size(&self) -> usize {
        self.shadow_size
    }

    fn add(&self, lit: &IntegrationInputs<'_>, radiance: &mut [Vec3]) {
        let march = March::new(lit, 0);
        let marched = |ray: usize| march.shifted(ray, self.steps);
        let has_closed_form = self.terms == Terms::Twelve && lit.lamp.is_distant() && lit.lamp.is_even();
        let most_magnified = if has_closed_form { REPRESENTED } else { self.terms.most_magnified() };
        let Some(rectified) = Rectified::new(lit, self.light_rays, self.least_light_rays, most_magnified)
        else {
            return march.add(self.steps, radiance);
        };
        let terms = if lit.lamp.is_distant() && !rectified.looks_back() { self.terms } else { Terms::Twelve };
        match (rectified.are_coloured(), terms) {
            (false, _) if has_closed_form => rectified.add::<1, 1, SegmentSweep>(radiance, marched),
            (true, _) if has_closed_form => rectified.add::<3, 3, SegmentSweep>(radiance, marched),
            (false, Terms::Four) => rectified.add::<4, 1, TreeSweep<4, 1>>(radiance, marched),
            (false, Terms::Twelve) => rectified.add::<12, 1, TreeSweep<12, 1>>(radiance, marched),
            (true, Terms::Four) => rectified.add::<12, 3, TreeSweep<12, 3>>(radiance, marched),
            (true, Terms::Twelve) => rectified.add::<36, 3, TreeSweep<36, 3>>(radiance, marched),
        }
    }
}
