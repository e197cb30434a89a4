//! A scene's medium on the GPU: its coefficients and box, and its densities as a texture, since passes that
//! light surfels through it bind as many buffers as WebGPU allows.

use crate::scene::{Bounds, Density, Medium, Scene};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::wgsl::uniforms::MediumRecord;
use glam::Vec3;

/// What fills a scene.
#[derive(Debug)]
pub struct MediumOnGpu {
    /// 0 everywhere, 1 in a box, 2 a grid in a box: `MEDIUM` in shaders.
    pub kind: u32,
    /// [`MediumRecord`].
    pub record: wgpu::Buffer,
    /// Densities of a grid, `[z, y, x]` of f32; one cell where there is none.
    pub densities: wgpu::TextureView,
}

impl MediumOnGpu {
    /// The kind that is everywhere.
    pub const EVERYWHERE: u32 = 0;
    /// The kind that is a grid.
    pub const GRID: u32 = 2;

    /// Sends it to the GPU. Of a scene without one it is everywhere and does nothing.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let density = scene.medium.as_deref().map_or(&Density::Everywhere, |medium| &medium.density);
        let (size, values): ([usize; 3], &[f32]) = match density {
            Density::Grid(grid) => (grid.size(), grid.values()),
            _ => ([1; 3], &[1.0]),
        };
        let kind = match density {
            Density::Everywhere => Self::EVERYWHERE,
            Density::Within(_) => 1,
            Density::Grid(_) => Self::GRID,
        };
        let record = record(scene.medium.as_deref());
        let densities = gpu::sent_volume(&gpu.device, &gpu.queue, "frame.densities", size, values)?;
        Ok(Self {
            kind,
            record: gpu::uniform(&gpu.device, "frame.medium", &record)?,
            densities: densities.create_view(&wgpu::TextureViewDescriptor::default()),
        })
    }
}

/// A medium as passes read it.
pub fn record(medium: Option<&Medium>) -> MediumRecord {
    let Some(medium) = medium else { return bytemuck::Zeroable::zeroed() };
    let (Bounds { min, max }, cells) = match &medium.density {
        Density::Everywhere => (Bounds { min: Vec3::ZERO, max: Vec3::ONE }, [1; 3]),
        Density::Within(bounds) => (*bounds, [1; 3]),
        Density::Grid(grid) => (grid.bounds(), grid.size()),
    };
    MediumRecord {
        scattering: medium.scattering.extend(medium.anisotropy).to_array(),
        extinction: medium.extinction().extend(0.0).to_array(),
        low: min.extend(medium.density.largest()).to_array(),
        high: max.extend(0.0).to_array(),
        cells: Vec3::from(cells.map(|count| count as f32)).extend(0.0).to_array(),
    }
}
