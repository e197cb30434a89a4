//! What runs on the GPU: tiles learn of the movements that reach them, then every pixel is exposed.

use crate::screen::{GpuGBuffer, MethodStep};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE, uniforms};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    tiles: Pass,
    neighbours: Pass,
    gather: Pass,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let compile = |shader: &wgsl::Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Self {
            tiles: compile(&wgsl::RECONSTRUCTION_TILES)?,
            neighbours: compile(&wgsl::RECONSTRUCTION_NEIGHBOURS)?,
            gather: compile(&wgsl::RECONSTRUCTION_GATHER)?,
        })
    }

    /// The passes bound to a g-buffer. They write radiance, `[3, height, width]`; `sizes` are what the uniform buffer will
    /// hold for images of this size.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        gbuffer: &GpuGBuffer,
        sizes: &uniforms::Reconstruction,
        settings: &wgpu::Buffer,
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        // [tiles_high, tiles_wide, 4], of vec3f
        let tiles = (sizes.tiles_wide * sizes.tiles_high) as usize;
        let of_tiles = gpu::empty::<[f32; 4]>(device, "reconstruction.longest_of_tiles", tiles)?;
        let around = gpu::empty::<[f32; 4]>(device, "reconstruction.longest_around", tiles)?;
        let [light, valid, motion, depth] =
            [Attribute::Light, Attribute::Valid, Attribute::Motion, Attribute::Depth]
                .map(|a| gbuffer.buffer(a));
        let step = |pass: &Pass, size: [u32; 2], reads: &[(u32, &wgpu::Buffer)], writes| {
            let [height, width] = size.map(|edge| edge as usize);
            MethodStep::bind_at(device, pass, gpu::groups(height, width, TILE), reads, &[writes])
        };
        let tiles = [sizes.tiles_high, sizes.tiles_wide];
        Ok(vec![
            step(&self.tiles, tiles, &[(0, settings), (2, valid), (3, motion)], (4, &of_tiles))?,
            step(&self.neighbours, tiles, &[(0, settings), (1, &of_tiles)], (2, &around))?,
            step(
                &self.gather,
                [sizes.height, sizes.width],
                &[(0, settings), (1, light), (2, valid), (3, motion), (4, depth), (5, &around)],
                (6, image),
            )?,
        ])
    }
}
