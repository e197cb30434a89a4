//! Image-based lighting by prefiltered maps, dimmed by ambient occlusion, as engines have it.
//!
//! [`gtao`](super::gtao) says how open each surface is. The diffuse colour is multiplied by that share. The
//! specular colour is multiplied by a share that depends on the viewer's angle and the lobe's width (Lagarde
//! and de Rousiers, "Moving Frostbite to Physically Based Rendering", 2014, 4.10.1). Then
//! [`prefiltered`](super::prefiltered) shades.
//!
//! Limits. Openness has no direction: a sun behind a wall still shines, and a wall that a mirror shows is
//! dimmed as if all directions were equally blocked. What the screen does not show blocks nothing.

#[cfg(test)]
mod tests;

use super::Quality;
use super::gtao::GtaoParameters;
use super::prefiltered::PrefilteredParameters;
use crate::path::bsdf::phong_alpha;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};

/// What can be set: how each of the two is made.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct OccludedPrefilteredParameters {
    /// Ambient occlusion.
    pub occlusion: GtaoParameters,
    /// The environment.
    pub light: PrefilteredParameters,
}

/// Uniform buffers of ambient occlusion; the environment has the last.
const OF_OCCLUSION: usize = 3;

impl OccludedPrefilteredParameters {
    /// Both of a quality.
    pub fn of(quality: Quality) -> Self {
        Self { occlusion: GtaoParameters::of(quality), light: PrefilteredParameters::of(quality) }
    }

    /// What the environment makes of surfaces that are as open as the image that `written` ends with says,
    /// after all before it.
    fn lit(
        &self,
        mut written: Written,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Result<Written, MissingAttribute> {
        let openness = written.last().map_or(&[][..], Vec::as_slice);
        let [diffuse, specular] = occluded(inputs.gbuffer, openness)?;
        let others = [Attribute::WorldNormal, Attribute::ToCamera, Attribute::Glossiness, Attribute::Valid];
        let gbuffer = GBuffer::new(others.to_vec(), inputs.gbuffer.select(&others)?);
        let gbuffer = gbuffer.with(&[Attribute::Diffuse], &diffuse).with(&[Attribute::Specular], &specular);
        written.extend([diffuse, specular]);
        written.extend(self.light.reference(&PlainInputs { gbuffer: &gbuffer, ..*inputs }, view)?);
        Ok(written)
    }
}

/// The diffuse and the specular colour, `[3, height, width]` each, times the share of the environment that
/// each of them gets.
fn occluded(gbuffer: &GBuffer, openness: &[f32]) -> Result<[Vec<f32>; 2], MissingAttribute> {
    let select = |attribute| gbuffer.select(&[attribute]);
    let [normal, viewer] = [select(Attribute::WorldNormal)?, select(Attribute::ToCamera)?];
    let glossiness = select(Attribute::Glossiness)?;
    let cosine = |at: usize| (0..3).map(|axis| normal.plane(axis)[at] * viewer.plane(axis)[at]).sum::<f32>();
    let mirrored: Vec<f32> = openness
        .iter()
        .enumerate()
        .map(|(at, open)| specular_share(cosine(at), *open, 1.0 - glossiness.data()[at]))
        .collect();
    let dimmed = |attribute, shares: &[f32]| -> Result<Vec<f32>, MissingAttribute> {
        let colour = select(attribute)?;
        Ok(colour.data().iter().zip(shares.iter().cycle()).map(|(colour, share)| colour * share).collect())
    };
    Ok([dimmed(Attribute::Diffuse, openness)?, dimmed(Attribute::Specular, &mirrored)?])
}

/// The share of the environment that a specular lobe gets, by the cosine of the viewer to the normal (Lagarde
/// and de Rousiers 2014, listing 26).
fn specular_share(cosine: f32, open: f32, roughness: f32) -> f32 {
    let sharpness = (-16.0 * phong_alpha(roughness) - 1.0).exp2();
    ((cosine.max(0.0) + open).powf(sharpness) - 1.0 + open).clamp(0.0, 1.0)
}

impl Technique for OccludedPrefilteredParameters {
    fn about(&self) -> About {
        let seen = &[
            Attribute::Position,
            Attribute::Normal,
            Attribute::WorldNormal,
            Attribute::ToCamera,
            Attribute::Diffuse,
            Attribute::Specular,
            Attribute::Glossiness,
            Attribute::Valid,
        ];
        About::on_screen("occluded-prefiltered", Effect::OccludedIbl, seen)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        [self.occlusion.uniforms(view), self.light.uniforms(view)].concat()
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let [height, width] = to.size();
        let openness = gpu::empty::<f32>(to.device, "occluded_prefiltered.openness", height * width)?;
        let colour = |name| gpu::empty::<f32>(to.device, name, 3 * height * width);
        let diffuse = colour("occluded_prefiltered.diffuse")?;
        let specular = colour("occluded_prefiltered.specular")?;
        let (of_occlusion, of_light) = to.uniforms.split_at(OF_OCCLUSION);
        let occlusion = Resources { uniforms: of_occlusion, output: &openness, ..*to };
        let mut steps = self.occlusion.steps(&occlusion)?;
        let pass = to.device.pass(Shader::at("methods/occluded-prefiltered/occlude"), &[])?;
        let [normal, viewer] = to.seen([Attribute::WorldNormal, Attribute::ToCamera]);
        let [glossiness, of_base, of_gloss] =
            to.seen([Attribute::Glossiness, Attribute::Diffuse, Attribute::Specular]);
        let reads = [&of_light[0], normal, viewer, glossiness, of_base, of_gloss, &openness];
        steps.push(MethodStep::bind(to.device, &pass, to.whole(), &reads, &[&diffuse, &specular])?);
        let gbuffer = to.gbuffer.with(Attribute::Diffuse, diffuse).with(Attribute::Specular, specular);
        steps.extend(self.light.steps(&Resources { uniforms: of_light, gbuffer: &gbuffer, ..*to })?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        self.lit(self.occlusion.reference(inputs, view)?, inputs, view)
    }

    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        let open = Technique::on_processor(&self.occlusion, inputs, view)?;
        Some(open.and_then(|open| self.lit(open, inputs, view)))
    }
}
