//! Temporal reprojection, for the images of any method: each pixel keeps most of what the frame before made
//! of the same surface (Nehab et al. 2007, "Accelerating Real-Time Shading with Reverse Reprojection
//! Caching"), as far as that lies within what the pixels around it show now (Salvi 2016, "An Excursion in
//! Temporal Supersampling"). Noise that changes from frame to frame averages out, and what flickers becomes
//! calm (thesis 7.4, Animations). What lags behind is what moves over a surface without it: shadows, indirect
//! light.

pub mod reference;
#[cfg(test)]
mod tests;

use super::PassDispatch;
use deepshade_shaders::gpu::{self, GpuError, Pass, Stamps};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReprojectionParameters {
    /// Share of this frame in the image, above 0. Of noise that is new in every frame, the variance falls to
    /// `share / (2 - share)` where nothing is cut off.
    pub share: f32,
    /// Difference in depth, as a share of the depth, above which a pixel showed another surface.
    pub depth_tolerance: f32,
    /// Standard deviations of the 3x3 pixels around, beyond which what was is cut off.
    pub clip: f32,
}

impl Default for ReprojectionParameters {
    fn default() -> Self {
        Self { share: 0.1, depth_tolerance: 0.05, clip: 1.5 }
    }
}

impl ReprojectionParameters {
    /// As the pass reads them.
    pub const fn uniform(&self, height: usize, width: usize, first: bool) -> uniforms::Reprojection {
        uniforms::Reprojection {
            width: width as u32,
            height: height as u32,
            first: first as u32,
            share: self.share,
            depth_tolerance: self.depth_tolerance,
            clip: self.clip,
        }
    }
}

/// The pass for images of a method, and what it remembers of the frame before.
#[derive(Debug)]
pub struct Reprojection {
    parameters: ReprojectionParameters,
    size: [usize; 2],
    first: bool,
    uniform: wgpu::Buffer,
    since: wgpu::Buffer,
    since_before_that: wgpu::Buffer,
    history: wgpu::Buffer,
    mix: PassDispatch,
    output: wgpu::Buffer,
}

impl Reprojection {
    /// For the images `[channels, height, width]` that a method makes in `current`, of frames whose movement
    /// since the one before is in `since`, as [`Two::since_before`](reference::Two) has it.
    ///
    /// # Errors
    /// If the device refuses or has no room.
    pub fn new(
        device: &wgpu::Device,
        [height, width]: [usize; 2],
        since: &wgpu::Buffer,
        current: &wgpu::Buffer,
        channels: usize,
        parameters: ReprojectionParameters,
    ) -> Result<Self, GpuError> {
        let planes = |label: &str, count: usize| gpu::empty::<f32>(device, label, count * height * width);
        let uniform = gpu::uniform(device, "reprojection", &parameters.uniform(height, width, true))?;
        let since_before_that = planes("reprojection.since_before_that", 4)?;
        let history = planes("reprojection.history", channels)?;
        let output = planes("reprojection.output", channels)?;
        let buffers = [&uniform, current, &history, since, &since_before_that, &output];
        let pass = Pass::of(device, Shader::at("frame/reproject"), &[("CHANNELS", channels as u32)])?
            .bind(device, &buffers.map(|buffer| buffer.as_entire_binding()))?;
        let mix = PassDispatch { pass, workgroups: gpu::groups(height, width, TILE).into() };
        Ok(Self {
            parameters,
            size: [height, width],
            first: true,
            uniform,
            since: since.clone(),
            since_before_that,
            history,
            mix,
            output,
        })
    }

    /// Forgets the frames before, as after a cut.
    pub const fn forget(&mut self) {
        self.first = true;
    }

    /// Records the passes of a frame: remembers what the last call made, and mixes it into the image of this
    /// frame.
    pub fn encode(
        &mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        stamps: Option<&Stamps<'_>>,
    ) {
        let [height, width] = self.size;
        let uniform = self.parameters.uniform(height, width, self.first);
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        self.first = false;
        encoder.copy_buffer_to_buffer(&self.output, 0, &self.history, 0, self.output.size());
        self.mix.encode(encoder, "reprojection", stamps);
        encoder.copy_buffer_to_buffer(&self.since, 0, &self.since_before_that, 0, self.since.size());
    }

    /// The image, `[channels, height, width]` f32.
    pub const fn output(&self) -> &wgpu::Buffer {
        &self.output
    }
}
