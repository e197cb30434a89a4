//! `gpu-epipolar`: single scattering by partial sums in epipolar slices, on the GPU.
//!
//! Baran, Chen, Ragan-Kelley, Durand and Lehtinen 2010, "A Hierarchical Volumetric Shadow Algorithm for
//! Single Scattering", as [`epipolar`](super::epipolar) on the processor. A sweep that changes a tree light
//! ray by light ray has an order that a GPU cannot keep; the paper's CUDA gives a thread to each slice. Here
//! nodes of 4 to 64 light rays hold what they would at every moment of the sweep: their light rays in the
//! order in which they end, with sums from each on. They are built by merging, all at once, and each pixel
//! looks its moment up by bisection, in any order.
//!
//! In place of the integrand's factors, which a processor would have to decompose for every frame and lamp,
//! nodes sum the powers of the light rays' places, and within a node the integrand is a quadratic function of
//! it: three values for each node on a pixel's way, of all colours, whatever the phase function and the ways
//! through the box. Where it bends more than that, in dense fog, smaller nodes are asked, and single light
//! rays in the end.
//!
//! Lines through the epipole are counted along the image's border by how far apart they are across their
//! direction, which the paper has in closed form, so that the epipole may be infinitely far away.
//!
//! Why it: an image without noise and bands in about the time of a march of 16 steps (`low` of both; the
//! book's page on fog has the figures). Why not: media must be the same throughout; where a lamp projects a
//! picture, it goes light ray by light ray.
//!
//! Limits. Light rays are single samples of the frame's shadow maps, not prefiltered. A binding holds the
//! sums of 832 of them at 1280x720, of 512 at 1920x1080 and of 256 at 3840x2160, so that higher qualities
//! differ there in what is marched only.

mod lines;
pub mod passes;
pub mod reference;
#[cfg(test)]
mod tests;

use super::{Quality, single_scattering};
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Effect, MissingAttribute};

/// Light rays of a tree.
const LEAVES: usize = 64;

/// Levels of trees that are kept: nodes of 4 to 64 light rays.
const LEVELS: usize = 5;

/// Bytes that a binding holds.
const ROOM: usize = 128 << 20;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct GpuEpipolarParameters {
    /// Light rays in a slice; fewer where there would be no room.
    #[schemars(range(min = 16, max = 8192))]
    pub light_rays: usize,
    /// View rays that cross fewer light rays are marched,
    #[schemars(range(min = 0, max = 1024))]
    pub least: u32,
    /// in so many steps.
    #[schemars(range(min = 1, max = 4096))]
    pub steps: u32,
}

impl GpuEpipolarParameters {
    /// More time is more light rays.
    pub const fn of(quality: Quality) -> Self {
        let (light_rays, steps) = match quality {
            Quality::Low => (256, 32),
            Quality::Medium => (512, 64),
            Quality::High => (1024, 128),
            Quality::Ultra => (2048, 384),
        };
        Self { light_rays, least: 16, steps }
    }

    /// Lines for which there is room: as many as the border has pixels, and one on either side.
    const fn lines([height, width]: [usize; 2]) -> usize {
        2 * (height + width) + 2
    }

    /// Light rays for which there is room.
    fn rays(self, size: [usize; 2]) -> usize {
        let fit = ROOM / (Self::lines(size) * LEVELS * size_of::<[u32; 2]>());
        self.light_rays.min(fit).next_multiple_of(LEAVES).min(fit / LEAVES * LEAVES).max(LEAVES)
    }

    /// What the passes read.
    pub fn settings(self, view: &View) -> uniforms::Epipolar {
        let size = [view.height, view.width];
        uniforms::Epipolar {
            width: view.width as u32,
            height: view.height as u32,
            light_rays: self.rays(size) as u32,
            lines: Self::lines(size) as u32,
            least: self.least,
            steps: self.steps,
            seed: view.seed,
        }
    }
}

impl Technique for GpuEpipolarParameters {
    fn about(&self) -> About {
        About {
            wants_even_fog: true,
            ..About::beyond_screen("gpu-epipolar", Effect::FogDirect, single_scattering::ATTRIBUTES)
        }
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = view.perspective();
        vec![bytes_of(&self.settings(view)).to_vec(), bytes_of(&camera).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::steps(*self, to)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| reference::shade(inputs.gbuffer, scene, &self.settings(view), view))
    }
}
