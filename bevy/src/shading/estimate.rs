//! A method's image as the network reads it, and, where it reads that, too, without the method's own blur.

use deepshade_render::methods::estimate::Estimator;
use deepshade_render::screen::{GpuGBuffer, Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, GpuError};
use wgpu::{Buffer, CommandEncoder, ComputePassDescriptor, Queue};

/// A method's passes.
pub(super) struct EstimatePasses {
    passes: MethodPasses,
    raw: Option<Raw>,
}

/// The image before the method's blur.
struct Raw {
    /// What the first pass writes. Later passes may write there again.
    written: Buffer,
    kept: Buffer,
}

impl EstimatePasses {
    /// Of a g-buffer on the method's device.
    ///
    /// # Errors
    /// If the device has no room, or refuses a binding.
    pub fn new(
        estimator: &Estimator,
        method: &ScreenMethod,
        gbuffer: &GpuGBuffer,
        view: &View,
    ) -> Result<Self, GpuError> {
        let inputs = Inputs { gbuffer, environment: None, world: None };
        let passes = MethodPasses::new(method, &inputs, view)?;
        let raw = match estimator.makes().len() {
            0 | 1 => None,
            _ => {
                let first = passes.steps().first().and_then(|step| step.writes.first());
                let written = first.unwrap_or_else(|| passes.output()).clone();
                let pixels = view.height * view.width;
                let kept = gpu::empty::<f32>(&method.gpu().device, "bevy.raw", pixels)?;
                Some(Raw { written, kept })
            }
        };
        Ok(Self { passes, raw })
    }

    /// What the estimator makes: the image, and the same before the method's blur.
    pub fn images(&self) -> impl Iterator<Item = &Buffer> {
        let raw = self.raw.as_ref().map(|raw| &raw.kept);
        [self.passes.output()].into_iter().chain(raw)
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
            if let (true, Some(Raw { written, kept })) = (is_first, &self.raw) {
                encoder.copy_buffer_to_buffer(written, 0, kept, 0, kept.size());
            }
        }
    }
}
