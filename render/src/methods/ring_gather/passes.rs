//! What runs on the GPU: the picture is shrunk, tiles learn of the circles that reach them, layers are gathered and put
//! over the sharp picture.

use crate::screen::{GpuGBuffer, MethodStep};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE, uniforms};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    shrink: Pass,
    tiles: Pass,
    neighbours: Pass,
    gather: Pass,
    combine: Pass,
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let compile = |shader: &wgsl::Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Self {
            shrink: compile(&wgsl::RING_GATHER_SHRINK)?,
            tiles: compile(&wgsl::RING_GATHER_TILES)?,
            neighbours: compile(&wgsl::RING_GATHER_NEIGHBOURS)?,
            gather: compile(&wgsl::RING_GATHER_GATHER)?,
            combine: compile(&wgsl::RING_GATHER_COMBINE)?,
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
        sizes: &uniforms::RingGather,
        settings: &wgpu::Buffer,
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let pixels = (sizes.low_width * sizes.low_height) as usize;
        let tiles = (sizes.tiles_wide * sizes.tiles_high) as usize;
        // [low_height, low_width, 4]
        let low = gpu::empty::<[f32; 4]>(device, "ring_gather.low", pixels)?;
        let behind = gpu::empty::<[f32; 4]>(device, "ring_gather.behind", pixels)?;
        let before = gpu::empty::<[f32; 4]>(device, "ring_gather.before", pixels)?;
        // [tiles_high, tiles_wide]
        let largest_in_front = gpu::empty::<f32>(device, "ring_gather.largest_in_front", tiles)?;
        let largest_around = gpu::empty::<f32>(device, "ring_gather.largest_around", tiles)?;
        let of_image = gpu::groups(sizes.height as usize, sizes.width as usize, TILE);
        let of_low = gpu::groups(sizes.low_height as usize, sizes.low_width as usize, TILE);
        let of_tiles = gpu::groups(sizes.tiles_high as usize, sizes.tiles_wide as usize, TILE);
        let [light, valid, depth, blurriness] =
            [Attribute::Light, Attribute::Valid, Attribute::Depth, Attribute::Blurriness]
                .map(|a| gbuffer.buffer(a));
        let step = |pass: &Pass, workgroups, reads: &[&wgpu::Buffer], writes: &[&wgpu::Buffer]| {
            MethodStep::bind(device, pass, workgroups, &[&[settings], reads].concat(), writes)
        };
        let seen = [light, valid, depth, blurriness];
        Ok(vec![
            step(&self.shrink, of_low, &seen, &[&low])?,
            step(&self.tiles, of_tiles, &[&low], &[&largest_in_front])?,
            step(&self.neighbours, of_tiles, &[&largest_in_front], &[&largest_around])?,
            step(&self.gather, of_low, &[&low, &largest_around], &[&behind, &before])?,
            step(&self.combine, of_image, &[&seen[..], &[&low, &behind, &before]].concat(), &[image])?,
        ])
    }
}
