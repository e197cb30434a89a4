//! Horizon-based ambient occlusion: the analytic rival that the thesis compares with (7.4, Figure 7.6).
//!
//! Bavoil, Sainz and Dimitrov, "Image-space horizon-based ambient occlusion", SIGGRAPH 2008 talks. Around each pixel
//! the g-buffer is marched in several directions of the image. In each, the surface's tangent and the highest sample
//! so far span the angles that are occluded; with elevations `t` and `h` above the image plane and the attenuation
//! `W(r) = 1 - (r / radius)^2`, openness is `1 - strength * mean over directions of the sum of W * (sin h - sin t)`,
//! summed whenever a sample raises the horizon. Directions are turned and samples shifted at random from pixel to
//! pixel, and a separable blur that keeps edges removes the noise. Where the original shifts directions onto the grid
//! of pixels, here each sample is measured from the tangent towards itself, which keeps slanted planes open.
//!
//! Limits. The g-buffer is taken for a height field: what is hidden behind something in front, behind the camera or
//! outside the image does not occlude, and everything seen is infinitely thick towards the back. All directions
//! count alike, while truth weighs them by their cosine to the normal; and attenuation fades towards the radius,
//! where truth ends sharply. `strength` and `radius_scale` make up for that on average only. With
//! normal maps the tangent is the shaded one, not the surface's own, and positions from half-float files are stepped;
//! the bias has to absorb both.
//!
//! Its rivals need more of the renderer (ambient occlusion volumes) or weigh by the cosine (ground-truth ambient
//! occlusion); this is the one that the published comparison has.

pub mod passes;
pub mod reference;
#[cfg(test)]
mod tests;

use crate::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use deepshade_shaders::gpu::{Gpu, GpuError};
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use passes::Passes;

const NAME: &str = "hbao";

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Radius that is marched over the radius of the effect. Above 1 it makes up for the attenuation.
    pub radius_scale: f32,
    /// Angle above the tangent below which nothing occludes, radians; hides the facets of curved surfaces.
    pub bias: f32,
    /// Factor of the occlusion; 1 is what the integral says.
    pub strength: f32,
    /// Directions marched from each pixel, at least 1.
    pub directions: u32,
    /// Samples of a direction, at least 1; fewer where the radius covers fewer pixels.
    pub steps: u32,
    /// Pixels on either side that the blur reaches; 0 is no blur.
    pub blur_radius: u32,
    /// How much distance from the tangent plane weakens the blur: a neighbour one radius off the plane has the weight
    /// `exp(-blur_sharpness^2)`.
    pub blur_sharpness: f32,
}

impl Default for Parameters {
    /// 16 directions of 24 steps as in the thesis (7.4); the rest is what `deepshade tune` found best on validation views
    /// of `dataset/recipes/ao.toml`.
    fn default() -> Self {
        Self {
            radius_scale: 1.2,
            bias: 0.15,
            strength: 1.3,
            directions: 16,
            steps: 24,
            blur_radius: 4,
            blur_sharpness: 1024.0,
        }
    }
}

/// The method, compiled for a device.
#[derive(Clone, Debug)]
pub struct Hbao {
    gpu: Gpu,
    passes: Passes,
    parameters: Parameters,
}

impl Hbao {
    /// Compiles the passes.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(gpu: &Gpu, parameters: Parameters) -> Result<Self, GpuError> {
        Ok(Self { gpu: gpu.clone(), passes: Passes::new(&gpu.device)?, parameters })
    }

    /// The same passes with other parameters; nothing is compiled.
    #[must_use]
    pub fn with(&self, parameters: Parameters) -> Self {
        Self { parameters, ..self.clone() }
    }
}

impl Method for Hbao {
    fn name(&self) -> &'static str {
        NAME
    }

    fn effect(&self) -> Effect {
        Effect::Ao
    }

    /// The time is that of the three passes on the GPU, without sending the g-buffer there and the image back.
    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        let surface =
            Surface::of(frame.gbuffer).map_err(|source| MethodError::Missing { method: NAME, source })?;
        let focal_length = frame.camera.focal_length(surface.height);
        let settings = self.parameters.settings(&surface, focal_length, frame.radius, frame.seed);
        let (image, timing) = self
            .passes
            .shade(&self.gpu, &surface, &settings, repeats)
            .map_err(|source| MethodError::Gpu { method: NAME, source })?;
        let clock = if timing.by_gpu { Clock::Gpu } else { Clock::Cpu };
        Ok(Shaded { image, milliseconds: timing.milliseconds, clock })
    }
}

/// What the method reads of a g-buffer.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// [`Attribute::Position`], `[3, height, width]`, camera space, metres.
    pub position: Planes,
    /// [`Attribute::Normal`], `[3, height, width]`, camera space.
    pub normal: Planes,
    /// [`Attribute::Valid`], `[1, height, width]`.
    pub valid: Planes,
}

impl Surface {
    /// The surface that a g-buffer holds.
    ///
    /// # Errors
    /// If the g-buffer lacks position, normal or validity.
    pub fn of(gbuffer: &GBuffer) -> Result<Self, MissingAttribute> {
        Ok(Self {
            height: gbuffer.height(),
            width: gbuffer.width(),
            position: gbuffer.select(&[Attribute::Position])?,
            normal: gbuffer.select(&[Attribute::Normal])?,
            valid: gbuffer.select(&[Attribute::Valid])?,
        })
    }
}

/// Parameters of the three passes for one frame, as the GPU reads them.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// The march.
    pub occlusion: uniforms::Hbao,
    /// The blur along rows, then along columns.
    pub blurs: [uniforms::HbaoBlur; 2],
}

impl Parameters {
    /// The passes' parameters for a frame with this effect radius (metres), focal length (pixels) and seed.
    pub fn settings(&self, surface: &Surface, focal_length: f32, radius: f32, seed: u32) -> Settings {
        let (width, height) = (surface.width as u32, surface.height as u32);
        let sigma = 0.5 * (self.blur_radius as f32 + 1.0);
        let blur = |step_x, step_y| uniforms::HbaoBlur {
            width,
            height,
            step_x,
            step_y,
            radius: self.blur_radius as i32,
            falloff: 0.5 / (sigma * sigma),
            sharpness: self.blur_sharpness / radius,
        };
        let occlusion = uniforms::Hbao {
            width,
            height,
            directions: self.directions.max(1),
            steps: self.steps.max(1),
            seed,
            radius: self.radius_scale * radius,
            focal_length,
            bias_sine: self.bias.sin(),
            bias_cosine: self.bias.cos(),
            strength: self.strength,
        };
        Settings { occlusion, blurs: [blur(1, 0), blur(0, 1)] }
    }
}
