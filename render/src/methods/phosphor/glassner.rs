//! `glassner`: phosphorescence as an integral over the past (Glassner 1995, "A Model for Fluorescence and
//! Phosphorescence"), by Monte Carlo with moments drawn by the decay, as the thesis compares itself with
//! (section 8.5, Figure 8.16).
//!
//! Each pixel draws moments of the past for each state, and at each looks up the light of the lamps that
//! shone then, with their shadows. That model knows no saturation: strong light makes it too bright, and what
//! was lit for long is as bright as the light asks, not as the paint has room for. A start that is a share is
//! what the rate equation's is.
//!
//! Why it: no state is kept, so that any moment can be shown at once. Why not: noise that falls with the root
//! of the samples, and light anew for each. Of what moves a still has shadow maps of poses of the past; in a
//! sequence it is taken as it is now, at every moment of the past: shadow maps of frames gone by are not
//! kept. It takes paints as alike everywhere, whatever their textures. Surfaces are seen as if no medium were
//! before them, and what it keeps itself is not shown.

use super::passes::Finding;
use super::reference::{found, image};
use super::{ATTRIBUTES, Quality, RateEquationParameters as Texels};
use crate::bvh::TracedScene;
use crate::path::phosphor::Afterglow;
use crate::scene::Glow;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_glow::paint::{LightInterval, PaintState};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::random::random;
use deepshade_shaders::wgsl::uniforms::GlowSamples;
use deepshade_shaders::{Effect, MissingAttribute};
use glam::{Vec2, Vec3};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct GlassnerParameters {
    /// Moments that are drawn of each state.
    #[schemars(range(min = 1, max = 4096))]
    pub samples: u32,
}

impl GlassnerParameters {
    /// More time is more moments: from as many as cost what the rate equation does to those that the thesis
    /// calls of the same quality.
    pub const fn of(quality: Quality) -> Self {
        let samples = match quality {
            Quality::Low => 1,
            Quality::Medium => 16,
            Quality::High => 128,
            Quality::Ultra => 1024,
        };
        Self { samples }
    }

    fn settings(self, view: &View) -> GlowSamples {
        let (width, height) = (view.width as u32, view.height as u32);
        GlowSamples { width, height, samples: self.samples.max(1), seed: view.seed }
    }
}

/// All of the past, seconds ago.
const EVER: [f32; 2] = [0.0, f32::MAX];

impl Technique for GlassnerParameters {
    fn about(&self) -> About {
        About::beyond_screen("glassner", Effect::Phosphor, ATTRIBUTES)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = view.perspective();
        vec![bytes_of(&camera).to_vec(), bytes_of(&self.settings(view)).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, world, gbuffer, output) = (to.device, to.scene()?, to.gbuffer, to.output);
        let [view, settings] = to.uniforms else { unreachable!("it has two uniform buffers") };
        // It has no texels; tiles are how a pixel finds its triangle.
        let coarsest = Texels::exact(1);
        let finding = Finding::new(device, world, gbuffer, coarsest.texels)?;
        let mut steps = finding.steps(device, world, gbuffer, view)?;
        let parts = world.past().iter().map(|(stretch, pose)| (*stretch, pose));
        let parts: Vec<_> = if world.past().is_empty() { vec![(EVER, world)] } else { parts.collect() };
        for (index, (stretch, pose)) in parts.into_iter().enumerate() {
            let of = (stretch, self.samples.max(1), index > 0);
            steps.extend(finding.look_back(device, pose, gbuffer, of, [settings, output])?);
        }
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(inputs.scene.map(|scene| shaded(scene, view, *self)).into_iter().collect())
    }
}

/// The plain version's image.
fn shaded(scene: &TracedScene, view: &View, parameters: GlassnerParameters) -> Vec<f32> {
    let (afterglow, glow) = (Afterglow::new(scene).by_lamps(), Glow::of(scene.scene()));
    let states = glow.most_states() as u32;
    let paints = glow.paints_of(scene.scene());
    image(view, |at| {
        let found = found(scene, view, at)?;
        let mesh = &scene.scene().meshes[found.mesh as usize];
        let paint = paints[mesh.material.0 as usize]?;
        let Vec2 { x, y } = found.place;
        let past = afterglow.history(found.mesh as usize, found.triangle as usize, [1.0 - x - y, x, y]);
        let of_state = |(index, state): (usize, &PaintState)| {
            let number =
                |sample: u32| random(at.x as u32, at.y as u32, view.seed, sample * states + index as u32);
            state.emission * share(state, glow.before(), &past, (0..parameters.samples).map(number))
        };
        Some(glow.surfaces[paint].paint.states.iter().enumerate().map(of_state).sum())
    })
}

/// The excited share of a state without saturation, by moments that random numbers draw.
fn share(
    state: &PaintState,
    before: f32,
    past: &[LightInterval],
    numbers: impl ExactSizeIterator<Item = f32>,
) -> f32 {
    if state.decay <= 0.0 {
        return 0.0;
    }
    let whole: f32 = past.iter().map(|lit| lit.seconds).sum();
    let within = -(-state.decay * whole).exp_m1();
    let count = numbers.len() as f32;
    let charge = |number: f32| {
        let ago = -(-number * within).ln_1p() / state.decay;
        state.charge(light_at(past, ago))
    };
    numbers.map(charge).sum::<f32>() / count * within / state.decay + before * (-state.decay * whole).exp()
}

/// Irradiance so many seconds ago.
fn light_at(past: &[LightInterval], ago: f32) -> Vec3 {
    let mut left = ago;
    for lit in past.iter().rev() {
        if left < lit.seconds {
            return lit.irradiance;
        }
        left -= lit.seconds;
    }
    Vec3::ZERO
}
