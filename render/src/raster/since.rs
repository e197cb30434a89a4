//! How far surfaces moved in the image from one frame to the next, for whatever remembers the frame before.

use super::attributes::seen_bindings;
use super::frame::Frame;
use crate::screen::PassDispatch;
use deepshade_shaders::gpu::{self, GpuError, Pass, Stamps};
use deepshade_shaders::wgsl::{Shader, TILE};

/// How far each pixel's surface moved in the image since the frame before (x to the right, y up, pixels), its
/// depth, and the depth that it had then; 0 where nothing is seen: `[4, height, width]` f32.
#[derive(Debug)]
pub struct Since {
    step: PassDispatch,
    planes: wgpu::Buffer,
}

impl Since {
    /// Planes of what is known of each pixel.
    pub const PLANES: usize = 4;

    /// Of a frame.
    ///
    /// # Errors
    /// If the device refuses or has no room.
    pub fn new(device: &wgpu::Device, frame: &Frame) -> Result<Self, GpuError> {
        let (height, width) = (frame.gbuffer().height(), frame.gbuffer().width());
        let planes = gpu::empty::<f32>(device, "frame.since", Self::PLANES * height * width)?;
        let pass = Pass::of(device, Shader::at("frame/since"), &[])?;
        let mut resources = seen_bindings(frame.image(), &frame.world().materials);
        resources.extend([frame.view_before(), &planes].map(|buffer| buffer.as_entire_binding()));
        let step = PassDispatch {
            pass: pass.bind(device, &resources)?,
            workgroups: gpu::groups(height, width, TILE).into(),
        };
        Ok(Self { step, planes })
    }

    /// Records the pass.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, stamps: Option<&Stamps<'_>>) {
        self.step.encode(encoder, "movement", stamps);
    }

    /// The planes.
    pub const fn planes(&self) -> &wgpu::Buffer {
        &self.planes
    }
}
