//! Passes before or after a network on certain buffers of the caller's, ready to be recorded.

use crate::Scaling;
use deepshade_shaders::gpu::{self, BoundPass, GpuError};
use deepshade_shaders::wgsl::uniforms::NetFrame;
use wgpu::{Buffer, CommandEncoder, ComputePass, Device, Queue};

/// What pixels, lengths and light of a frame are to a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameScale {
    /// Distance in pixels, at depth 1, of two points one unit apart: half the image's height over the tangent
    /// of half the vertical field of view. Of no use to a network that reads neither `pixel_radius` nor
    /// `border`.
    pub focal_length: f32,
    /// How far the effect is to reach, metres.
    pub radius: f32,
    /// What lengths and light are multiplied by: [`NetSpec::scaling`](crate::NetSpec::scaling), or an
    /// exposure of the caller's.
    pub scaling: Scaling,
}

/// What [`InputPasses`](super::InputPasses) or an [`ImagePass`](super::ImagePass) does on certain buffers.
/// Recording it makes nothing anew.
#[derive(Debug)]
pub struct FrameRecording {
    label: String,
    passes: Vec<(BoundPass, [u32; 3])>,
    uniform: Buffer,
    told: NetFrame,
}

impl FrameRecording {
    /// None yet, for images of `[height, width]`; and what its passes bind first.
    pub(super) fn new(
        device: &Device,
        label: &str,
        [height, width]: [usize; 2],
        run: usize,
        frame: FrameScale,
    ) -> Result<Self, GpuError> {
        let [width, height, run] = [width, height, run].map(|number| number as u32);
        let told = told(NetFrame { width, height, run, ..bytemuck::Zeroable::zeroed() }, frame);
        let uniform = gpu::uniform(device, label, &told)?;
        Ok(Self { label: format!("deepshade.{label}"), passes: Vec::new(), uniform, told })
    }

    /// What its passes read of the frame.
    pub(super) const fn uniform(&self) -> &Buffer {
        &self.uniform
    }

    /// Adds a pass.
    pub(super) fn add(&mut self, pass: BoundPass, workgroups: [u32; 3]) {
        self.passes.push((pass, workgroups));
    }

    /// What holds from the next submission on. Nothing is made anew.
    pub fn set(&self, queue: &Queue, frame: FrameScale) {
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&told(self.told, frame)));
    }

    /// Records the passes in a compute pass of their own.
    pub fn encode(&self, encoder: &mut CommandEncoder) {
        let descriptor = wgpu::ComputePassDescriptor { label: Some(&self.label), timestamp_writes: None };
        self.encode_in(&mut encoder.begin_compute_pass(&descriptor));
    }

    /// Records the passes within a compute pass of the caller's.
    pub fn encode_in(&self, pass: &mut ComputePass<'_>) {
        for (bound, workgroups) in &self.passes {
            bound.dispatch_in(pass, *workgroups);
        }
    }
}

/// What passes are told of another frame.
const fn told(before: NetFrame, frame: FrameScale) -> NetFrame {
    let FrameScale { focal_length, radius, scaling } = frame;
    NetFrame { focal_length, radius, length_scale: scaling.length, light_scale: scaling.light, ..before }
}
