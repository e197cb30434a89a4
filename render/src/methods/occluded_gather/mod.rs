//! Light dimmed by ambient occlusion, then seen through a lens: the rival of the thesis' network that does
//! both at once (7.4).
//!
//! Engines run the two one after the other. [`gtao`](super::gtao) says how open each surface is, its light is
//! multiplied by that, and [`ring_gather`](super::ring_gather) blurs the product.
//!
//! Limits. Those of the two: what the screen does not show neither hides light nor is seen past an edge.

#[cfg(test)]
mod tests;

use super::Quality;
use super::gtao::GtaoParameters;
use super::ring_gather::RingGatherParameters;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};

/// What can be set: how each of the two is made.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct OccludedGatherParameters {
    /// Ambient occlusion.
    pub occlusion: GtaoParameters,
    /// Depth of field.
    pub lens: RingGatherParameters,
}

/// Uniform buffers of ambient occlusion; the lens has the last.
const OF_OCCLUSION: usize = 3;

impl OccludedGatherParameters {
    /// Both of a quality.
    pub fn of(quality: Quality) -> Self {
        Self { occlusion: GtaoParameters::of(quality), lens: RingGatherParameters::of(quality) }
    }

    /// What the lens makes of occlusion's image, which `written` ends with, after all before it.
    fn seen_through_lens(
        &self,
        mut written: Written,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Result<Written, MissingAttribute> {
        let light = inputs.gbuffer.select(&[Attribute::Light])?;
        let openness = written.last().map_or(&[][..], Vec::as_slice);
        let occluded: Vec<f32> = (0..light.channels())
            .flat_map(|channel| light.plane(channel).iter().zip(openness).map(|(light, open)| light * open))
            .collect();
        let others = [Attribute::Depth, Attribute::Blurriness, Attribute::Valid];
        let gbuffer = GBuffer::new(others.to_vec(), inputs.gbuffer.select(&others)?);
        let gbuffer = gbuffer.with(&[Attribute::Light], &occluded);
        written.push(occluded);
        written.extend(self.lens.reference(&PlainInputs { gbuffer: &gbuffer, ..*inputs }, view)?);
        Ok(written)
    }
}

impl Technique for OccludedGatherParameters {
    fn about(&self) -> About {
        let seen = &[
            Attribute::Position,
            Attribute::Normal,
            Attribute::Light,
            Attribute::Depth,
            Attribute::Blurriness,
            Attribute::Valid,
        ];
        About::on_screen("occluded-gather", Effect::Multi, seen)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        [self.occlusion.uniforms(view), self.lens.uniforms(view)].concat()
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let [height, width] = to.size();
        let openness = gpu::empty::<f32>(to.device, "occluded_gather.openness", height * width)?;
        let occluded = gpu::empty::<f32>(to.device, "occluded_gather.occluded", 3 * height * width)?;
        let (of_occlusion, of_lens) = to.uniforms.split_at(OF_OCCLUSION);
        let occlusion = Resources { uniforms: of_occlusion, output: &openness, ..*to };
        let mut steps = self.occlusion.steps(&occlusion)?;
        let pass = to.device.pass(Shader::at("methods/occluded-gather/occlude"), &[])?;
        let [light] = to.seen([Attribute::Light]);
        let reads = [&of_lens[0], light, &openness];
        steps.push(MethodStep::bind(to.device, &pass, to.whole(), &reads, &[&occluded])?);
        let gbuffer = to.gbuffer.with(Attribute::Light, occluded);
        steps.extend(self.lens.steps(&Resources { uniforms: of_lens, gbuffer: &gbuffer, ..*to })?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        self.seen_through_lens(self.occlusion.reference(inputs, view)?, inputs, view)
    }

    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        let occluded = Technique::on_processor(&self.occlusion, inputs, view)?;
        Some(occluded.and_then(|occluded| self.seen_through_lens(occluded, inputs, view)))
    }
}
