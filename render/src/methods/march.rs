//! A march through the g-buffer from every pixel, in random directions, and the blur that removes its noise: what
//! [`gtao`](super::gtao), [`hbao`](super::hbao), [`ssdo`](super::ssdo) and [`ssgi`](super::ssgi) have in common.

use super::Surface;
use super::blur::{self, Blur};
use crate::screen::{GpuGBuffer, MethodStep};
use bytemuck::{NoUninit, bytes_of};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, Planes};

/// Parameters of the three passes for one frame, as the GPU reads them.
#[derive(Clone, Copy, Debug)]
pub struct Settings<M> {
    /// The march.
    pub march: M,
    /// The blur along rows, then along columns.
    pub blurs: [uniforms::Blur; 2],
}

impl<M: NoUninit> Settings<M> {
    /// The contents of the passes' uniform buffers.
    pub fn uniforms(&self) -> Vec<Vec<u8>> {
        let blurs = self.blurs.iter().map(|blur| bytes_of(blur).to_vec());
        [bytes_of(&self.march).to_vec()].into_iter().chain(blurs).collect()
    }
}

/// What runs on the GPU: the march, the blur along rows, the blur along columns.
#[derive(Clone, Debug)]
pub struct Passes {
    march: Pass,
    blur: Blur,
}

/// What a march reads beside its uniforms, in the order of its bindings.
#[derive(Clone, Copy, Debug)]
pub struct Reads<'a> {
    /// The g-buffer.
    pub gbuffer: &'a GpuGBuffer,
    /// What of it.
    pub attributes: &'a [Attribute],
    /// What else.
    pub more: &'a [&'a wgpu::Buffer],
}

impl Passes {
    /// Compiles them; `march` makes images of an effect.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device, march: &Shader, effect: Effect) -> Result<Self, GpuError> {
        let blur = Blur::new(device, effect.channels())?;
        Ok(Self { march: Pass::new(device, march.name, &march.source())?, blur })
    }

    /// The passes bound to a g-buffer. They write `image`, `[channels, height, width]`.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        Reads { gbuffer, attributes, more }: Reads<'_>,
        uniforms: &[wgpu::Buffer],
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let [march, rows, columns] = uniforms else { unreachable!("there are three uniform buffers") };
        let attributes = attributes.iter().map(|attribute| gbuffer.buffer(*attribute));
        let reads: Vec<_> = [march].into_iter().chain(attributes).chain(more.iter().copied()).collect();
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        let march = MethodStep::bind(device, &self.march, workgroups, &reads, &[image])?;
        let blurs = self.blur.steps(device, gbuffer, [rows, columns], image)?;
        Ok([march].into_iter().chain(blurs).collect())
    }
}

/// What the plain versions of all three passes make of what that of the march does.
pub fn blurred(surface: &Surface, blurs: &[uniforms::Blur; 2], noisy: Planes) -> [Planes; 3] {
    let [along_rows, image] = blur::smooth(surface, blurs, &noisy);
    [noisy, along_rows, image]
}
