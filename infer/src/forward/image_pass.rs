//! An effect's image made on the device of what a network made: what [`NetSpec::image`] and
//! [`NetSpec::set_background`] do in main memory.

use super::frame_recording::{FrameRecording, FrameScale};
use super::{ForwardError, io};
use crate::NetSpec;
use deepshade_shaders::gpu::{self, Pass};
use deepshade_shaders::wgsl::TILE;
use deepshade_shaders::wgsl::net_image::FinishedImage;
use wgpu::{Buffer, Device};

/// A pass that makes a run's channels of an effect's image: in the light that the frame had before it was
/// scaled, within the effect's range, with the effect's background where no surface is seen.
#[derive(Debug)]
pub struct ImagePass {
    device: Device,
    spec: NetSpec,
    pass: Pass,
}

/// Buffers on the network's device.
#[derive(Clone, Copy, Debug)]
pub struct ImageBuffers<'a> {
    /// Rows and columns.
    pub size: [usize; 2],
    /// The g-buffer's `valid`, `[height, width]` f32.
    pub valid: &'a Buffer,
    /// What the network made, planar `[output channels, height, width]` f32.
    pub made: &'a Buffer,
    /// The effect's image, planar `[effect's channels, height, width]` f32: another buffer.
    pub image: &'a Buffer,
    /// Which of [`NetSpec::runs`] made it, and so which channels of the image are written.
    pub run: usize,
}

impl ImagePass {
    /// Compiles it for a network.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn new(device: &Device, spec: &NetSpec) -> Result<Self, ForwardError> {
        let pass = Pass::new(device, "net.finished", &finished(spec).source())?;
        Ok(Self { device: device.clone(), spec: spec.clone(), pass })
    }

    /// Prepares to make the image.
    ///
    /// # Errors
    /// If a buffer is too small, there is no such run, or the device refuses.
    pub fn bind(
        &self,
        buffers: &ImageBuffers<'_>,
        frame: FrameScale,
    ) -> Result<FrameRecording, ForwardError> {
        let ImageBuffers { size, valid, made, image, run } = *buffers;
        if run >= self.spec.runs() {
            return Err(io::refused("image", format!("run {run} of {}", self.spec.runs())));
        }
        io::check_buffer("valid", valid, 1, size)?;
        io::check_buffer("output", made, self.spec.output_channels(), size)?;
        io::check_buffer("image", image, self.spec.effect.channels(), size)?;
        let mut recording = FrameRecording::new(&self.device, "net.finished", size, run, frame)?;
        let buffers = [recording.uniform(), made, image, valid].map(Buffer::as_entire_binding);
        let bound = self.pass.bind(&self.device, &buffers)?;
        recording.add(bound, gpu::groups(size[0], size[1], TILE));
        Ok(recording)
    }
}

/// What the pass knows of a network's effect.
pub(super) fn finished(spec: &NetSpec) -> FinishedImage {
    FinishedImage {
        channels: spec.output_channels() as u32,
        range: spec.effect.range(),
        background: spec.effect.background(),
    }
}
