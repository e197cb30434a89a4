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
//! A binding holds the sums of 1024 light rays in 3,276 lines. An image that has more takes its lines part by
//! part, in the same buffers, and each pixel asks in the part of the two lines that it is between.
//!
//! Limits. Light rays are single samples of the frame's shadow maps, not prefiltered.

mod lines;
mod passes;
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

/// Bytes of a light ray's sums.
const OF_RAY: usize = LEVELS * size_of::<[u32; 2]>();

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct GpuEpipolarParameters {
    /// Light rays in a slice.
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

    /// As many lines as have room in so many bytes, at most all of an image.
    fn part(self, room: usize, size: [usize; 2]) -> Part {
        let light_rays = self.light_rays.next_multiple_of(LEAVES);
        let lines = most_lines(size).min(room / (light_rays * OF_RAY)).max(2);
        Part { light_rays, lines }
    }

    /// What the passes read, of parts like this one.
    fn settings(self, part: Part, view: &View) -> uniforms::Epipolar {
        uniforms::Epipolar {
            width: view.width as u32,
            height: view.height as u32,
            light_rays: part.light_rays as u32,
            lines: part.lines as u32,
            least: self.least,
            steps: self.steps,
            seed: view.seed,
        }
    }

    /// See [`Technique::uniforms`].
    fn uniforms_within(self, room: usize, view: &View) -> Vec<Vec<u8>> {
        let settings = self.settings(self.part(room, [view.height, view.width]), view);
        vec![bytes_of(&settings).to_vec(), bytes_of(&view.perspective()).to_vec()]
    }
}

/// What is in the buffers at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    /// Light rays in a slice.
    light_rays: usize,
    /// Lines, the last of which is the first of the next part.
    lines: usize,
}

impl Part {
    /// In how many an image's lines are.
    fn count(self, size: [usize; 2]) -> usize {
        (most_lines(size) - 1).div_ceil(self.lines - 1)
    }
}

/// Lines that an image may have: as many as its border has pixels, one where rounding makes them more, and
/// the first again.
const fn most_lines([height, width]: [usize; 2]) -> usize {
    2 * (height + width) + 2
}

impl Technique for GpuEpipolarParameters {
    fn about(&self) -> About {
        About {
            wants_even_fog: true,
            ..About::beyond_screen("gpu-epipolar", Effect::FogDirect, single_scattering::ATTRIBUTES)
        }
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.uniforms_within(ROOM, view)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::steps(self.part(ROOM, to.size()), to)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let settings = self.settings(self.part(ROOM, [view.height, view.width]), view);
        inputs.image_of_scene(|scene| reference::shade(inputs.gbuffer, scene, &settings, view))
    }
}
