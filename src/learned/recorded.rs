//! All that a trained network's image of a frame takes on a card, ready to be recorded: what methods estimate
//! for it, what else is made for it to read, the network, and the image of what it makes.

use super::estimates::SEED;
use deepshade_infer::forward::{FrameRecording, FrameScale, Runner};
use deepshade_render::screen::{GpuGBuffer, Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, GpuError, Stamps};
use std::sync::Arc;
use wgpu::{Buffer, CommandEncoder, ComputePass, ComputePassTimestampWrites, Queue};

/// A network's passes from a g-buffer to an image. Recording them makes nothing anew.
pub struct Recorded {
    /// Of each method that the network names; none where the g-buffer had what it makes.
    pub(super) estimates: Vec<Option<EstimatePasses>>,
    pub(super) runner: Arc<Runner>,
    pub(super) runs: Vec<NetworkRun>,
}

/// What comes before and after one of the network's runs.
pub struct NetworkRun {
    /// What makes the network's input.
    pub input: FrameRecording,
    /// What makes the image, or a colour channel of it.
    pub image: FrameRecording,
}

/// What a method estimates in passes.
pub struct EstimatePasses {
    passes: MethodPasses,
    /// What its first pass writes: the image before its blur. Later passes may write there again.
    first: Buffer,
    raw: Option<Buffer>,
}

impl Recorded {
    /// Records all of it; `stamps` are around the whole.
    pub fn encode(&self, encoder: &mut CommandEncoder, stamps: Option<&Stamps<'_>>) {
        let of_one = |is_first, is_last| stamps.and_then(|stamps| stamps.of_one_compute(is_first, is_last));
        let mut begin = of_one(true, false);
        for estimate in self.estimates.iter().flatten() {
            estimate.encode(encoder, begin.take());
        }
        for (index, NetworkRun { input, image }) in (1..).zip(&self.runs) {
            compute(encoder, begin.take(), |pass| input.encode_in(pass));
            self.runner.encode(encoder);
            compute(encoder, of_one(false, index == self.runs.len()), |pass| image.encode_in(pass));
        }
    }

    /// What holds for another frame, from the next submission on; `methods` are those that the network names.
    pub fn set(&self, queue: &Queue, methods: &[ScreenMethod], view: &View, frame: FrameScale) {
        for (estimate, method) in self.estimates.iter().zip(methods) {
            if let Some(estimate) = estimate {
                estimate.passes.look(queue, method, &of_estimates(view));
            }
        }
        for NetworkRun { input, image } in &self.runs {
            input.set(queue, frame);
            image.set(queue, frame);
        }
    }
}

impl EstimatePasses {
    /// Of a frame's g-buffer on the method's device.
    ///
    /// # Errors
    /// If the device has no room, or refuses a binding.
    pub fn new(
        method: &ScreenMethod,
        has_raw: bool,
        gbuffer: &GpuGBuffer,
        view: &View,
    ) -> Result<Self, GpuError> {
        let inputs = Inputs { gbuffer, environment: None, world: None };
        let passes = MethodPasses::new(method, &inputs, &of_estimates(view))?;
        let first = passes.steps().first().and_then(|step| step.writes.first());
        let first = first.unwrap_or_else(|| passes.output()).clone();
        let device = &method.gpu().device;
        let raw = || gpu::empty::<f32>(device, "learned.raw", view.height * view.width);
        let raw = if has_raw { Some(raw()?) } else { None };
        Ok(Self { passes, first, raw })
    }

    /// Its image, and the same before the method's blur, where a network reads that.
    pub fn images(&self) -> impl Iterator<Item = &Buffer> {
        std::iter::once(self.passes.output()).chain(&self.raw)
    }

    /// Records its passes; `begin` is when they begin.
    pub fn encode(&self, encoder: &mut CommandEncoder, begin: Option<ComputePassTimestampWrites<'_>>) {
        let steps = self.passes.steps();
        let (first, later) = steps.split_at(steps.len().min(1));
        compute(encoder, begin, |pass| first.iter().for_each(|step| step.step.encode_in(pass)));
        if let Some(raw) = &self.raw {
            encoder.copy_buffer_to_buffer(&self.first, 0, raw, 0, raw.size());
        }
        compute(encoder, None, |pass| later.iter().for_each(|step| step.step.encode_in(pass)));
    }
}

/// The view as methods that estimate see it.
const fn of_estimates(view: &View) -> View {
    View { seed: SEED, ..*view }
}

fn compute(
    encoder: &mut CommandEncoder,
    timestamp_writes: Option<ComputePassTimestampWrites<'_>>,
    record: impl FnOnce(&mut ComputePass<'_>),
) {
    let label = Some("deepshade.learned");
    record(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes }));
}
