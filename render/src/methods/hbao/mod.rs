//! Horizon-based ambient occlusion: the analytic rival that the thesis compares with (7.4, Figure 7.6).
//!
//! Bavoil, Sainz and Dimitrov, "Image-space horizon-based ambient occlusion", SIGGRAPH 2008 talks. Around
//! each pixel the g-buffer is marched in several directions of the image. In each, the surface's tangent and
//! the highest sample so far span the angles that are occluded; with elevations `t` and `h` above the image
//! plane and the attenuation `W(r) = 1 - (r / radius)^2`, openness is
//! `1 - strength * mean over directions of the sum of W * (sin h - sin t)`, summed whenever a sample raises
//! the horizon. Directions are turned and samples shifted at random from pixel to pixel, and a separable blur
//! that keeps edges removes the noise. Where the original shifts directions onto the grid of pixels, here
//! each sample is measured from the tangent towards itself, which keeps slanted planes open.
//!
//! Limits. The g-buffer is taken for a height field: what is hidden behind something in front, behind the
//! camera or outside the image does not occlude, and everything seen is infinitely thick towards the back.
//! All directions count alike, while truth weighs them by their cosine to the normal; and attenuation fades
//! towards the radius, where truth ends sharply. `strength` and `radius_scale` make up for that on average
//! only. With normal maps the tangent is the shaded one, not the surface's own, and positions from half-float
//! files are stepped; the bias has to absorb both.
//!
//! Its rivals need more of the renderer (ambient occlusion volumes) or weigh by the cosine (ground-truth
//! ambient occlusion); this is the one that the published comparison has.

pub mod reference;
#[cfg(test)]
mod tests;

use super::{Quality, Surface, blur, march::Marched};
use crate::screen::{PlainInputs, View};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Effect, MissingAttribute, Planes};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct HbaoParameters {
    /// Radius that is marched over the radius of the effect. Above 1 it makes up for the attenuation.
    #[schemars(range(min = 0.1, max = 4.0))]
    pub radius_scale: f32,
    /// Angle above the tangent below which nothing occludes, radians; hides the facets of curved surfaces.
    #[schemars(range(min = 0.0, max = 1.5), extend("unit" = "radians"))]
    pub bias: f32,
    /// Factor of the occlusion; 1 is what the integral says.
    #[schemars(range(min = 0.0, max = 4.0))]
    pub strength: f32,
    /// Directions marched from each pixel, at least 1.
    #[schemars(range(min = 1, max = 64))]
    pub directions: u32,
    /// Samples of a direction, at least 1; fewer where the radius covers fewer pixels.
    #[schemars(range(min = 1, max = 128))]
    pub steps: u32,
    /// Pixels on either side that the blur reaches; 0 is no blur.
    #[schemars(range(min = 0, max = 32), extend("unit" = "pixels"))]
    pub blur_radius: u32,
    /// How much distance from the tangent plane weakens the blur: a neighbour one radius off the plane has
    /// the weight `exp(-blur_sharpness^2)`.
    #[schemars(range(min = 0.0, max = 65536.0))]
    pub blur_sharpness: f32,
}

impl HbaoParameters {
    /// Those of a quality: fewer directions and steps are faster, more leave less noise to the blur. The
    /// thesis has 16 directions of 24 steps (7.4); the rest is what `deepshade tune` found best on validation
    /// views of
    /// `dataset/recipes/ao-thesis.toml`.
    pub fn of(quality: Quality) -> Self {
        let (directions, steps) = match quality {
            Quality::Low => (4, 6),
            Quality::Medium => (8, 12),
            Quality::High => (16, 24),
            Quality::Ultra => (32, 48),
        };
        Self {
            radius_scale: 1.2,
            bias: 0.15,
            strength: 1.3,
            directions,
            steps,
            blur_radius: 4,
            blur_sharpness: 1024.0,
        }
    }
}

impl Marched for HbaoParameters {
    const NAME: &'static str = "hbao";
    const EFFECT: Effect = Effect::Ao;
    const SHADER: Shader = Shader::at("methods/hbao/occlusion");
    type March = uniforms::Hbao;

    fn march(&self, view: &View) -> uniforms::Hbao {
        let (width, height) = (view.width as u32, view.height as u32);
        uniforms::Hbao {
            width,
            height,
            directions: self.directions.max(1),
            steps: self.steps.max(1),
            seed: view.seed,
            radius: self.radius_scale * view.radius,
            focal_length: view.focal_length(),
            bias_sine: self.bias.sin(),
            bias_cosine: self.bias.cos(),
            strength: self.strength,
        }
    }

    fn blur(&self) -> blur::BlurParameters {
        blur::BlurParameters { radius: self.blur_radius, sharpness: self.blur_sharpness }
    }

    fn noisy(
        &self,
        _inputs: &PlainInputs<'_>,
        surface: &Surface,
        march: &uniforms::Hbao,
    ) -> Result<Planes, MissingAttribute> {
        Ok(reference::occlude(surface, march))
    }
}
