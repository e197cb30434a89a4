//! A method's image as the network reads it: with and without the method's own blur.

use deepshade_render::screen::{GpuGBuffer, Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, GpuError};
use wgpu::{Buffer, CommandEncoder, ComputePassDescriptor, Queue};

/// A method's passes.
pub(super) struct EstimatePasses {
    passes: MethodPasses,
    /// What its first pass writes: the image before its blur. Later passes may write there again.
    first: Buffer,
    raw: Buffer,
}

impl EstimatePasses {
    /// Of a g-buffer on the method's device.
    ///
    /// # Errors
    /// If the device has no room, or refuses a binding.
    pub fn new(method: &ScreenMethod, gbuffer: &GpuGBuffer, view: &View) -> Result<Self, GpuError> {
        let inputs = Inputs { gbuffer, environment: None, world: None };
        let passes = MethodPasses::new(method, &inputs, view)?;
        let first = passes.steps().first().and_then(|step| step.writes.first());
        let first = first.unwrap_or_else(|| passes.output()).clone();
        let raw = gpu::empty::<f32>(&method.gpu().device, "bevy.raw", view.height * view.width)?;
        Ok(Self { passes, first, raw })
    }

    /// Its image, and the same before the method's blur.
    pub fn images(&self) -> [&Buffer; 2] {
        [self.passes.output(), &self.raw]
    }

    /// Tells them of another view.
    pub fn look(&self, queue: &Queue, method: &ScreenMethod, view: &View) {
        self.passes.look(queue, method, view);
    }

    /// Records them.
    pub fn encode(&self, encoder: &mut CommandEncoder) {
        let steps = self.passes.steps();
        let (first, later) = steps.split_at(steps.len().min(1));
        for (steps, is_first) in [(first, true), (later, false)] {
            let descriptor =
                ComputePassDescriptor { label: Some("deepshade.estimate"), timestamp_writes: None };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            steps.iter().for_each(|step| step.step.encode_in(&mut pass));
            drop(pass);
            if is_first {
                encoder.copy_buffer_to_buffer(&self.first, 0, &self.raw, 0, self.raw.size());
            }
        }
    }
}
