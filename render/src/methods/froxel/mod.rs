//! `froxel`: single scattering in a grid of cells that are aligned with the view.
//!
//! Wronski, "Volumetric Fog: Unified Compute Shader Based Solution to Atmospheric Scattering", SIGGRAPH 2014
//! courses; Hillaire, "Physically Based and Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015
//! courses. The view is cut into columns of so many pixels and each of them into slices. One pass looks for
//! light in every froxel, one sums columns front to back, and one reads the sums between columns and slices
//! for each pixel.
//!
//! Here slices divide each ray's own way through the medium, so that they begin at its surface, and light is
//! looked for at the same places in all froxels, shifted from frame to frame: a still has no noise, and
//! frames that are mixed see more places.
//!
//! Why it: it costs froxels times lamps, however many pixels there are, and goes through grids. It is what
//! engines ship. Why not: shafts finer than a froxel are missed or blurred, and light leaks as far in front
//! of a surface as a slice is thick.
//!
//! Limits. Froxels do not end where surfaces do: in a room in fog that reaches far beyond it few slices are
//! within. A binding holds 8 million: at 1920x1080 `high` and `ultra` have 64 slices in place of 96 and 128.

pub mod reference;
#[cfg(test)]
mod tests;

use super::{Quality, single_scattering};
use crate::raster::light::shadow_sampler;
use crate::screen::{About, MethodStep, PassDispatch, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct FroxelParameters {
    /// Pixels along an edge of a column; more where there would be no room for 32 slices.
    #[schemars(range(min = 1, max = 64), extend("unit" = "pixels"))]
    pub tile: usize,
    /// Froxels in a column; fewer where there would be no room for them.
    #[schemars(range(min = 1, max = 512))]
    pub slices: u32,
    /// Points of a froxel at which light is looked for.
    #[schemars(range(min = 1, max = 64))]
    pub samples: u32,
}

/// Most froxels: what a binding holds of 16 bytes each.
const MOST_FROXELS: usize = (128 << 20) / 16;

/// Slices give way to columns down to so many.
const LEAST_SLICES: u32 = 32;

/// After so many frames the places at which light is looked for begin anew.
const FRAMES: u32 = 1024;

impl FroxelParameters {
    /// More time is more froxels; medium is about the 160 x 90 x 64 of the sources at 1280 x 720.
    pub const fn of(quality: Quality) -> Self {
        let (tile, slices, samples) = match quality {
            Quality::Low => (16, 32, 1),
            Quality::Medium => (8, 64, 1),
            Quality::High => (4, 96, 1),
            Quality::Ultra => (4, 128, 4),
        };
        Self { tile, slices, samples }
    }

    /// Pixels along an edge of a column, so that there is room for some slices.
    fn tile(self, [height, width]: [usize; 2]) -> usize {
        let fits = |tile: &usize| {
            height.div_ceil(*tile) * width.div_ceil(*tile) * self.slices.min(LEAST_SLICES) as usize
                <= MOST_FROXELS
        };
        (self.tile..).find(fits).unwrap_or(self.tile)
    }

    /// Froxels in a column for which there is room.
    fn slices_of(self, size: [usize; 2]) -> u32 {
        let [rows, columns] = self.grid(size);
        self.slices.min((MOST_FROXELS / (rows * columns)) as u32)
    }

    /// Rows and columns of columns of froxels for an image of rows and columns of pixels.
    fn grid(self, size: [usize; 2]) -> [usize; 2] {
        size.map(|pixels| pixels.div_ceil(self.tile(size)))
    }

    /// What the passes read.
    pub fn settings(self, view: &View) -> uniforms::Froxels {
        let size = [view.height, view.width];
        let [rows, columns] = self.grid(size).map(|count| count as u32);
        uniforms::Froxels {
            width: view.width as u32,
            height: view.height as u32,
            tile: self.tile(size) as u32,
            columns,
            rows,
            slices: self.slices_of(size),
            samples: self.samples,
            frame: view.seed % FRAMES,
        }
    }
}

impl Technique for FroxelParameters {
    fn about(&self) -> About {
        About::beyond_screen("froxel", Effect::FogDirect, single_scattering::ATTRIBUTES)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = view.perspective();
        vec![bytes_of(&self.settings(view)).to_vec(), bytes_of(&camera).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, world) = (to.device, to.scene()?);
        let [settings, view] = to.uniforms else { unreachable!("it has two uniform buffers") };
        let ([rows, columns], slices) = (self.grid(to.size()), self.slices_of(to.size()));
        let froxels = |label: &str| gpu::empty::<[f32; 4]>(device, label, rows * columns * slices as usize);
        let (scattered, sums) = (froxels("froxel.scattered")?, froxels("froxel.sums")?);
        let [valid, position] = to.seen([Attribute::Valid, Attribute::Position]);
        let record = &world.medium.record;

        let [lights, medium] = single_scattering::constants(world);
        let sampler = shadow_sampler(device);
        let own = [(0, settings), (1, view), (7, &scattered)]
            .map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let resources =
            own.into_iter().chain(single_scattering::bindings(world, &world.gpu_lights.records, &sampler));
        let scatter = device.pass(Shader::at("methods/froxel/scatter"), &[lights, medium])?;
        let scatter = scatter.bind_at(device, resources)?;
        let integrate = device.pass(Shader::at("methods/froxel/integrate"), &[])?;
        let apply = device.pass(Shader::at("methods/froxel/apply"), &[medium])?;
        let [x, y, _] = gpu::groups(rows, columns, TILE);
        let scatter = PassDispatch { pass: scatter, workgroups: [x, y, slices].into() };
        let read = [settings, view, record, valid, position, &sums];
        Ok(vec![
            MethodStep { step: scatter, writes: vec![scattered.clone()] },
            MethodStep::bind(device, &integrate, [x, y, 1], &[settings, record, &scattered], &[&sums])?,
            MethodStep::bind(device, &apply, to.whole(), &read, &[to.output])?,
        ])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| reference::shade(inputs.gbuffer, scene, &self.settings(view), view))
    }
}
