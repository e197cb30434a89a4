//! What a volume shows of its light: surfaces lit by it, and the medium in front of pixels.

use super::passes::Pixel;
use super::volume_buffers::scattered;
use crate::lpv::Scheme;
use crate::lpv::propagation::Kinds;
use crate::raster::medium::MediumOnGpu;
use crate::screen::{Device, MethodStep, PassDispatch, Resources};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE};

/// What surfaces are lit by.
const SURFACE: [Attribute; 3] = [Attribute::Position, Attribute::Normal, Attribute::Valid];

/// The buffers of a volume.
#[derive(Clone, Debug)]
pub struct VolumeOnGpu {
    /// The grid.
    pub record: wgpu::Buffer,
    /// `[planes, 3, cells]`: flux and energy times lengths of ways, watts times cells; as the medium and, if
    /// there is scattered light, as surfaces show it.
    pub shown: wgpu::Buffer,
    /// How light was handed on.
    pub scheme: Scheme,
    /// Which light there is.
    pub kinds: Kinds,
    /// Whether it is in a coarser one.
    pub is_nested: bool,
}

impl VolumeOnGpu {
    /// The pass that lights surfaces: irradiance over pi, `[3, height, width]`; that of a finer volume takes
    /// the place of what is there.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn lit_step(&self, to: &Resources<'_>, view: &wgpu::Buffer) -> Result<MethodStep, GpuError> {
        let device = to.device;
        let constants = [self.scheme.lookup_constant(), ("NESTED", u32::from(self.is_nested))];
        let pass = device.pass(Shader::at("methods/lpv/lit"), &constants)?;
        let [position, normal, valid] = to.seen(SURFACE);
        let reads = [&self.record, position, normal, valid, view, &self.shown];
        let reads: Vec<_> = (0..).zip(reads).collect();
        MethodStep::bind_at(device, &pass, to.whole(), &reads, &[(6, to.output)])
    }
}

/// Pixels that volumes light through a medium.
#[derive(Clone, Copy)]
pub struct Marched<'a> {
    /// The g-buffer, the scene and the image.
    pub to: &'a Resources<'a>,
    /// The camera.
    pub view: &'a wgpu::Buffer,
    /// [`uniforms::Marching`](deepshade_shaders::wgsl::uniforms::Marching).
    pub march: &'a wgpu::Buffer,
    /// What of pixels is lit.
    pub pixel: Pixel,
    /// Of so many pixels along each axis one is marched.
    pub scale: usize,
    /// Whether the image has other light already.
    pub adds: bool,
}

impl Marched<'_> {
    /// The passes that light the medium and the surfaces behind it: radiance, `[3, height, width]`.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn steps(&self, volume: &VolumeOnGpu) -> Result<Vec<MethodStep>, GpuError> {
        let size = self.size();
        let scattered = gpu::empty::<f32>(self.to.device, "lpv.scattered", 3 * size[0] * size[1])?;
        let march = self.pixel.medium.then(|| self.march_step(volume, &scattered)).transpose()?;
        Ok(march.into_iter().chain([self.apply_step(volume, &scattered)?]).collect())
    }

    /// Rows and columns of pixels that are marched.
    fn size(&self) -> [usize; 2] {
        self.to.size().map(|edge| edge.div_ceil(self.scale))
    }

    fn march_step(&self, volume: &VolumeOnGpu, scattered: &wgpu::Buffer) -> Result<MethodStep, GpuError> {
        let medium = &self.to.scene()?.medium;
        let [position, _, valid] = self.to.seen(SURFACE);
        let grid = [&volume.record, self.march, &medium.record, valid, position, self.view];
        let light = [(6, &volume.shown), (7, scattered)];
        let buffers = (0..).zip(grid).chain(light);
        step(
            self.to.device,
            Shader::at("methods/lpv/march"),
            &self.constants(medium, volume),
            (buffers, (8, medium)),
            self.size(),
            scattered,
        )
    }

    fn apply_step(&self, volume: &VolumeOnGpu, light: &wgpu::Buffer) -> Result<MethodStep, GpuError> {
        let (medium, image) = (&self.to.scene()?.medium, self.to.output);
        let shows = [
            ("SCATTERS", u32::from(self.pixel.medium)),
            ("LIT", u32::from(self.pixel.surface)),
            ("ADDS", u32::from(self.adds)),
            scattered(volume.kinds),
        ];
        let constants = [&self.constants(medium, volume)[..], &shows].concat();
        let [position, normal, valid] = self.to.seen(SURFACE);
        let buffers = [&volume.record, position, normal, valid, self.view, &volume.shown, image];
        let diffuse = self.to.gbuffer.buffer(Attribute::Diffuse);
        let others = [(7, self.march), (8, &medium.record), (10, diffuse), (11, light)];
        let buffers = (0..).zip(buffers).chain(others);
        step(
            self.to.device,
            Shader::at("methods/lpv/apply"),
            &constants,
            (buffers, (9, medium)),
            self.to.size(),
            image,
        )
    }

    fn constants(&self, medium: &MediumOnGpu, volume: &VolumeOnGpu) -> [(&'static str, u32); 4] {
        let (medium, scale) = (("MEDIUM", medium.kind), ("SCALE", self.scale as u32));
        [medium, scale, volume.scheme.lookup_constant(), ("NESTED", 0)]
    }
}

/// A pass over an image of rows and columns, bound to buffers and a medium's densities by their numbers.
fn step<'a>(
    device: &Device,
    shader: Shader,
    constants: &[(&'static str, u32)],
    (buffers, (densities, medium)): (impl Iterator<Item = (u32, &'a wgpu::Buffer)>, (u32, &'a MediumOnGpu)),
    [rows, columns]: [usize; 2],
    written: &wgpu::Buffer,
) -> Result<MethodStep, GpuError> {
    let pass = device.pass(shader, constants)?;
    let buffers = buffers.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
    let densities = (densities, wgpu::BindingResource::TextureView(&medium.densities));
    let pass = pass.bind_at(device, buffers.chain([densities]))?;
    let workgroups = gpu::groups(rows, columns, TILE).into();
    Ok(MethodStep { step: PassDispatch { pass, workgroups }, writes: vec![written.clone()] })
}
