//! Image-based lighting with what the screen shows of occlusion, in two parts.
//!
//! - The base reflects the light of the directions that [`ssdo`](super::ssdo) finds open.
//! - The specular lobe reflects [`prefiltered`](super::prefiltered) maps, dimmed by how open
//!   [`gtao`](super::gtao) says that the surface is: by a share that depends on the viewer's angle and the
//!   lobe's width (Lagarde and de Rousiers, "Moving Frostbite to Physically Based Rendering", 2014, 4.10.1).
//!
//! Limits. Openness has no direction, so a lobe shows a sun that a wall hides. Those of `ssdo`: shadows are
//! as soft as a few directions are, and what the screen does not show blocks nothing.
//!
//! Engines often dim the base by ambient occlusion, too. Then a sun that a wall hides shines on the base.

#[cfg(test)]
mod tests;

use super::Quality;
use super::gtao::GtaoParameters;
use super::prefiltered::PrefilteredParameters;
use super::ssdo::SsdoParameters;
use crate::path::bsdf::phong_alpha;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};

/// What can be set: how each part is made.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct OccludedPrefilteredParameters {
    /// Light of open directions, for the base.
    pub directions: SsdoParameters,
    /// Ambient occlusion, for the specular lobe.
    pub occlusion: GtaoParameters,
    /// The environment, for the specular lobe.
    pub light: PrefilteredParameters,
}

/// Uniform buffers of what marches; the environment has the last.
const OF_A_MARCH: usize = 3;

impl OccludedPrefilteredParameters {
    /// All parts of a quality.
    pub fn of(quality: Quality) -> Self {
        Self {
            directions: SsdoParameters::of(quality),
            occlusion: GtaoParameters::of(quality),
            light: PrefilteredParameters::of(quality),
        }
    }

    /// What the passes write, of the openness that `occlusion` ends with.
    fn written(
        &self,
        occlusion: Written,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Result<Written, MissingAttribute> {
        let directions = self.directions.reference(inputs, view)?;
        let specular = open_specular(inputs.gbuffer, last(&occlusion))?;
        let black = vec![0.0; specular.len()];
        let gbuffer = inputs.gbuffer.with(&[Attribute::Diffuse], &black);
        let gbuffer = gbuffer.with(&[Attribute::Specular], &specular);
        let mirrored = self.light.reference(&PlainInputs { gbuffer: &gbuffer, ..*inputs }, view)?;
        let diffuse = inputs.gbuffer.select(&[Attribute::Diffuse])?;
        let arrived = diffuse.data().iter().zip(last(&directions)).zip(last(&mirrored));
        let sum = arrived.map(|((diffuse, light), mirrored)| diffuse * light + mirrored).collect();
        Ok([directions, occlusion, vec![specular], mirrored, vec![sum]].concat())
    }
}

fn last(written: &Written) -> &[f32] {
    written.last().map_or(&[], Vec::as_slice)
}

/// The specular colour, `[3, height, width]`, times the share of the environment that the lobe gets.
fn open_specular(gbuffer: &GBuffer, openness: &[f32]) -> Result<Vec<f32>, MissingAttribute> {
    let select = |attribute| gbuffer.select(&[attribute]);
    let [normal, viewer] = [select(Attribute::WorldNormal)?, select(Attribute::ToCamera)?];
    let [glossiness, specular] = [select(Attribute::Glossiness)?, select(Attribute::Specular)?];
    let cosine = |at: usize| (0..3).map(|axis| normal.plane(axis)[at] * viewer.plane(axis)[at]).sum::<f32>();
    let share = |(at, open): (usize, &f32)| specular_share(cosine(at), *open, 1.0 - glossiness.data()[at]);
    let shares: Vec<f32> = openness.iter().enumerate().map(share).collect();
    Ok(specular.data().iter().zip(shares.iter().cycle()).map(|(colour, share)| colour * share).collect())
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
        [self.directions.uniforms(view), self.occlusion.uniforms(view), self.light.uniforms(view)].concat()
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let [height, width] = to.size();
        let planes =
            |name: &str, count| gpu::empty::<f32>(to.device, &format!("occluded_prefiltered.{name}"), count);
        let (colours, values) = (3 * height * width, height * width);
        let (light, openness) = (planes("light", colours)?, planes("openness", values)?);
        let [specular, black, mirrored] =
            [planes("specular", colours)?, planes("black", colours)?, planes("mirrored", colours)?];
        let (of_directions, rest) = to.uniforms.split_at(OF_A_MARCH);
        let (of_occlusion, of_light) = rest.split_at(OF_A_MARCH);
        let mut steps =
            self.directions.steps(&Resources { uniforms: of_directions, output: &light, ..*to })?;
        steps.extend(self.occlusion.steps(&Resources {
            uniforms: of_occlusion,
            output: &openness,
            ..*to
        })?);
        let pass = |shader| to.device.pass(Shader::at(shader), &[]);
        let [normal, viewer] = to.seen([Attribute::WorldNormal, Attribute::ToCamera]);
        let [glossiness, colour, diffuse] =
            to.seen([Attribute::Glossiness, Attribute::Specular, Attribute::Diffuse]);
        let occlude = pass("methods/occluded-prefiltered/occlude")?;
        let reads = [&of_light[0], normal, viewer, glossiness, colour, &openness];
        steps.push(MethodStep::bind(to.device, &occlude, to.whole(), &reads, &[&specular])?);
        let gbuffer = to.gbuffer.with(Attribute::Diffuse, black).with(Attribute::Specular, specular);
        let shiny = Resources { uniforms: of_light, gbuffer: &gbuffer, output: &mirrored, ..*to };
        steps.extend(self.light.steps(&shiny)?);
        let sum = pass("methods/occluded-prefiltered/sum")?;
        let reads = [&of_light[0], diffuse, &light, &mirrored];
        steps.push(MethodStep::bind(to.device, &sum, to.whole(), &reads, &[to.output])?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        self.written(self.occlusion.reference(inputs, view)?, inputs, view)
    }

    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        let occlusion = Technique::on_processor(&self.occlusion, inputs, view)?;
        Some(occlusion.and_then(|occlusion| self.written(occlusion, inputs, view)))
    }
}
