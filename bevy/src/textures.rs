//! The two passes between Bevy's textures and deepshade's buffers.

use bevy::prelude::{Mat4, Resource, UVec2};
use bytemuck::{Pod, Zeroable};
use deepshade_shaders::gpu::{GpuError, Pass};
use wgpu::TextureFormat;

/// Edge of a workgroup, pixels: `WIDTH` in the shaders.
pub(crate) const TILE: u32 = 8;

/// What `read.wgsl` is told of a view.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Seen {
    /// From clip space, with Bevy's reversed depth, to camera space.
    pub view_from_clip: Mat4,
    /// From world to camera space.
    pub view_from_world: Mat4,
    /// Columns and rows of the image.
    pub size: UVec2,
    /// Where the viewport begins in the prepass' textures, pixels.
    pub origin: UVec2,
}

/// The passes, compiled when they are first wanted.
#[derive(Default, Resource)]
pub(crate) struct TexturePasses {
    read: Option<Pass>,
    write: Option<(TextureFormat, Pass)>,
}

impl TexturePasses {
    /// From a prepass' depth and normals to positions, normals and what is seen.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn read(&mut self, device: &wgpu::Device) -> Result<Pass, GpuError> {
        if let Some(pass) = &self.read {
            return Ok(pass.clone());
        }
        let pass = Pass::new(device, "bevy.read", include_str!("read.wgsl"))?;
        Ok(self.read.insert(pass).clone())
    }

    /// From openness in a buffer to a texture as Bevy's ambient occlusion has it, `R16Float` or `R32Float`.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn write(&mut self, device: &wgpu::Device, format: TextureFormat) -> Result<Pass, GpuError> {
        if let Some((known, pass)) = &self.write
            && *known == format
        {
            return Ok(pass.clone());
        }
        let source = include_str!("write.wgsl");
        let source = match format {
            TextureFormat::R16Float => source.replace("r32float", "r16float"),
            _ => source.to_owned(),
        };
        let pass = Pass::new(device, "bevy.write", &source)?;
        self.write = Some((format, pass.clone()));
        Ok(pass)
    }
}
