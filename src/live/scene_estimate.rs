//! What methods that look beyond the screen estimate of a live frame for its network, which runs once the
//! frame's g-buffer has been read back.

use super::waited_for;
use crate::learned::{Learned, SEED};
use anyhow::{Context, Result};
use deepshade_render::screen::{Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, GBuffer};

/// A method's passes in a live scene.
pub struct SceneEstimate {
    makes: Attribute,
    method: ScreenMethod,
    passes: MethodPasses,
}

impl SceneEstimate {
    /// Those that a network reads, in a scene that `inputs` are of.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn all(gpu: &Gpu, learned: &Learned, inputs: &Inputs<'_>, view: &View) -> Result<Vec<Self>> {
        let prepared = |(makes, method): (Attribute, ScreenMethod)| {
            let passes = MethodPasses::new(&method, inputs, &steady(view));
            let passes = passes.with_context(|| format!("`{}` for the network", method.name()))?;
            Ok(Self { makes, method, passes })
        };
        learned.estimates_of_scene(gpu)?.into_iter().map(prepared).collect()
    }

    /// The g-buffer of the last frame, seen so, with what it makes, and the milliseconds of its passes by the
    /// wall clock.
    ///
    /// # Errors
    /// If the device fails.
    pub async fn with(&self, gpu: &Gpu, view: &View, gbuffer: &GBuffer) -> Result<(GBuffer, f64)> {
        self.passes.look(&gpu.queue, &self.method, &steady(view));
        let milliseconds = waited_for(gpu, &mut |encoder| {
            let label = Some(self.method.name());
            let descriptor = wgpu::ComputePassDescriptor { label, timestamp_writes: None };
            self.passes.encode_in(&mut encoder.begin_compute_pass(&descriptor));
        })
        .await?;
        let made = gpu::read_async(&gpu.device, &gpu.queue, self.passes.output()).await?;
        Ok((gbuffer.with(&[self.makes], &made), milliseconds))
    }
}

/// The view with random numbers that are the same in every frame.
const fn steady(view: &View) -> View {
    View { seed: SEED, ..*view }
}
