//! `lpv`: light in a grid of cells around the scene, handed on from cell to cell.
//!
//! Kaplanyan and Dachsbacher 2010, "Cascaded Light Propagation Volumes for Real-Time Indirect Illumination",
//! is `lpv` of `gi`; Billeter, Sintorn and Assarsson 2012, "Real-Time Multiple Scattering using Light
//! Propagation Volumes", of `fog-multiple`. The propagation is [`crate::lpv`]'s, which says in what it
//! differs.
//!
//! What surfaces reflect, and what blocks light, is injected from surfels in place of reflective shadow maps:
//! of all lamps alike and also where no lamp or camera looks. Single scattering is looked for at eight points
//! of each cell, by the lamps' shadow maps. Sums over surfels are in fixed point, so that the same frame
//! gives the same bits. Nothing is taken on from frame to frame but light that surfaces and a medium keep.
//! Light is kept apart by what it met, so that each effect of fog shows its own paths: once reflected,
//! reflected again, scattered.
//!
//! Why it: it costs cells times iterations, whatever the scene and the image, and it is the only method of
//! `fog-multiple`. Why not: light that a cell cannot tell apart it mixes, so that shadows of indirect light
//! are as blurred as cells are large, and some light passes through what is thinner than a cell. Of a point
//! without a medium 0.70 of the flux that goes there where all directions are alike goes along axes, 1.17
//! across edges and 1.41 across corners; in a medium scattering evens that out.
//!
//! Light that surfaces emit, and in a medium that which they and it kept and give back, goes through a volume
//! of its own until surfels reflect it or the medium scatters it, which is then handed on as that of the
//! lamps is; where nothing shines by itself there is no such volume. Without a medium there may be finer
//! grids around the camera ([`crate::lpv::cascade`]).
//!
//! The sky shines into a medium through the cells along the grid's border ([`crate::lpv::sky`]), beside what
//! shines by itself, and goes on doing so: light of all its directions crosses in a cell.
//!
//! Light that surfaces kept is all that `phosphor-gi` has: surfels give it back as they reflect that of lamps
//! for `gi`. To `fog-indirect` and `fog-multiple` it comes beside other light, as does what the medium kept.
//!
//! Limits. Without a medium, light of lamps and of surfaces that emit, not of an environment. What a medium
//! scatters outside of the grid does not come in. In a medium, surfaces send back
//! light that comes to them, in the mean colour of those around a cell and the way that it came. Light
//! outside the grid, which ends a cell beyond the scene, is lost. A medium with a preferred direction of
//! scattering is replaced by a thinner one without, but for the last scattering towards the eye, where
//! scattered light is followed; where light is wanted that met no medium (`fog-indirect`), all of it is
//! there. A medium of many mean free paths in a cell reflects light of other cells as it should
//! ([`crate::lpv::flight`]), but for a thousandth of it that an iteration may add; what lamps and surfaces
//! send into it is still far too much of hundreds of mean free paths. Of what a dense medium gives back too
//! little comes out: light of a whole cell begins in its middle. Out of half a space comes, of the true flux,
//! 0.91 with a quarter of a mean free path in a cell, 0.88 with a half, 0.79 with one, 0.58 with two, 0.33
//! with four and 0.17 with eight.
//!
//! [`Scheme::PAPER`] is equation (3) as Billeter et al. have it, with linear extinction, two bands and
//! surfaces lit by the cell that they are in, to be compared with.
//!
//! Surfaces in fog send all that they reflect, their hemispherical albedo, as matte ones do. Light of
//! `fog-indirect` is kept apart by six sides, which takes room: 128 cells along all edges are more than a
//! binding of 128 MiB holds, 76 are not.

pub mod in_medium;
mod lit_volume;
pub mod passes;
pub mod reference;
mod series;
mod shining;
pub mod shown;
#[cfg(test)]
mod tests;
mod volume_buffers;

use super::Quality;
use crate::lpv::lobe::Lobes;
use crate::lpv::{LightGrid, Scheme};
use crate::scene::Bounds;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use glam::Vec3;
use passes::Filled;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct LpvParameters {
    /// Cells along the longest edge of the scene's box.
    #[schemars(range(min = 4, max = 128))]
    pub cells: usize,
    /// Grids of so many cells: one around the scene, and in it finer ones around the camera, each with half
    /// the edges of the one before. In a medium, and in `composed`, there is one, whatever this says; with
    /// squared lobes there are at most two.
    #[schemars(range(min = 1, max = MOST_CASCADES))]
    pub cascades: usize,
    /// How often light is handed on.
    #[schemars(range(min = 1, max = 512))]
    pub iterations: usize,
    /// Steps of the march through the medium.
    #[schemars(range(min = 1, max = 512))]
    pub steps: u32,
    /// Of so many pixels along each axis one is marched.
    #[schemars(range(min = 1, max = 4), extend("unit" = "pixels"))]
    pub scale: usize,
    /// How light is handed on and looked up.
    pub scheme: Scheme,
}

/// Most grids: the finest one's cells are then a 32nd of the coarsest one's.
const MOST_CASCADES: usize = 6;

impl LpvParameters {
    /// More time is more cells, and iterations for light to cross them once and a half: from then on what is
    /// still on its way falls by the same share ([`crate::lpv::series`]).
    pub const fn of(quality: Quality) -> Self {
        let (cells, iterations, steps, scale) = match quality {
            Quality::Low => (16, 24, 16, 2),
            Quality::Medium => (32, 48, 32, 2),
            Quality::High => (48, 72, 48, 1),
            Quality::Ultra => (64, 96, 64, 1),
        };
        Self { cells, cascades: 1, iterations, steps, scale, scheme: Scheme::OURS }
    }

    /// The grids, the coarsest first, of a scene in a box that is filled, and a camera at a place.
    fn grids(&self, filled: Filled, bounds: Bounds, camera: Vec3) -> Vec<LightGrid> {
        let coarsest = LightGrid::around(bounds, self.cells);
        let finer = |grid: &LightGrid| Some(grid.nested(camera));
        let most = match (filled.has_medium(), self.scheme.lobes) {
            (true, _) => 1,
            (false, Lobes::Squared) => 2,
            (false, Lobes::TwoBands) => MOST_CASCADES,
        };
        let count = self.cascades.clamp(1, most);
        std::iter::successors(Some(coarsest), finer).take(count).collect()
    }

    /// The edge of a cell of the finest grid, metres.
    fn finest_cell(&self, filled: Filled, bounds: Bounds) -> f32 {
        let grids = self.grids(filled, bounds, bounds.centre());
        grids[grids.len() - 1].cell
    }
}

impl Technique for LpvParameters {
    fn about(&self) -> About {
        About::beyond_screen("lpv", Effect::Gi, &[Attribute::Position, Attribute::Normal, Attribute::Valid])
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(view, view.radius)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::lit_steps(to, *self, Filled::Clear)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        reference::lit_image(inputs, view, *self, Filled::Clear)
    }
}

/// Diffuse light of phosphorescence by the grid: its only light is what surfels give back of light that they
/// kept.
#[derive(Clone, Copy, Debug)]
pub struct KeptLight(pub LpvParameters);

impl Technique for KeptLight {
    fn about(&self) -> About {
        About { effect: Effect::PhosphorGi, ..self.0.about() }
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.0.uniforms(view)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::lit_steps(to, self.0, Filled::Kept)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        reference::lit_image(inputs, view, self.0, Filled::Kept)
    }
}

/// Light that surfaces emit and others have reflected, once or more often, as surfaces get it: what
/// `composed` has beside that which they get at once. A medium dims it.
#[derive(Clone, Copy, Debug)]
pub struct ReflectedEmission(pub LpvParameters);

impl Technique for ReflectedEmission {
    fn about(&self) -> About {
        self.0.about()
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(view, f32::MAX)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::lit_steps(to, self.0, Filled::ReflectedEmission)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let view = View { radius: f32::MAX, ..*view };
        reference::lit_image(inputs, &view, self.0, Filled::ReflectedEmission)
    }
}
