//! Screen-space directional occlusion.
//!
//! Ritschel, Grosch and Seidel, "Approximating dynamic global illumination in image space", I3D 2009. From
//! each pixel's surface, directions of the hemisphere are marched up to the radius; a direction is blocked if
//! one of its points lies behind what the camera sees there, and no further behind than things are thick.
//! Where the original takes one point a direction, here several do, the denser the nearer. Directions that
//! nothing blocks bring the environment's radiance; they are spread by their cosine to the normal, so that
//! their mean is irradiance over pi, and with a radiance of 1 from everywhere the ambient occlusion of the
//! same directions. A blur that keeps edges removes the noise.
//!
//! So few directions would miss a sun or hit it by chance: they read a small map whose texels are means of
//! the environment over their solid angles ([`EnvironmentMap`]). Shadows are as soft as its texels are wide,
//! 22 degrees in the default.
//!
//! Limits. What is hidden behind something in front, behind the camera or outside the image does not block,
//! everything is equally thick, and what is thinner than points are apart is missed at random. Light that
//! bounces, the other half of the paper, is [`ssgi`](super::ssgi)'s.
//!
//! Bent normals of [`gtao`](super::gtao) would be faster, and would take all open directions for one cone.

pub mod reference;
#[cfg(test)]
mod tests;

use super::environment_map::EnvironmentMap;
use super::{Quality, Surface, blur, march::Marched};
use crate::scene::Environment;
use crate::screen::{PlainInputs, View};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Effect, MissingAttribute, Planes};
use glam::Vec3;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct SsdoParameters {
    /// Directions of a pixel, at least 1.
    #[schemars(range(min = 1, max = 1024))]
    pub directions: u32,
    /// Points along each, at least 1.
    #[schemars(range(min = 1, max = 128))]
    pub steps: u32,
    /// How thick everything is taken to be, away from the eye, as a share of the radius.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub thickness: f32,
    /// Rows of the map that the environment is filtered into, at least 1.
    #[schemars(range(min = 1, max = 256), extend("unit" = "rows"))]
    pub environment_height: usize,
    /// What removes the noise.
    pub blur: blur::BlurParameters,
}

impl SsdoParameters {
    /// Those of a quality: more directions and points leave less noise to the blur, miss less, and can tell a
    /// finer map.
    ///
    /// Swept on room, colonnade, still life, machinery, stairs and shelves under skies and photographed
    /// environments at 176x120 with a radius of 10 % of the diagonal. With 64 directions maps of 8 rows are
    /// best by 0.016 of SSIM to 16 rows and 0.08 to 32, with 128 those of 8 and 16 are level. Thicknesses
    /// from 0.25 to 0.5 are within 0.002; fewer than 10 steps lose, more than 16 gain nothing; a blur of 4 to
    /// 6 pixels with a sharpness of 512 is best.
    pub fn of(quality: Quality) -> Self {
        let (directions, steps, environment_height, radius) = match quality {
            Quality::Low => (8, 6, 8, 4),
            Quality::Medium => (24, 8, 8, 4),
            Quality::High => (64, 12, 8, 4),
            Quality::Ultra => (256, 20, 16, 3),
        };
        let blur = blur::BlurParameters { radius, sharpness: 512.0 };
        Self { directions, steps, thickness: 0.3, environment_height, blur }
    }

    /// What the environment is filtered into; black without one.
    pub fn filtered(&self, environment: Option<&Environment>) -> EnvironmentMap {
        let black = Environment::uniform(Vec3::ZERO);
        EnvironmentMap::new(environment.unwrap_or(&black), self.environment_height.max(1))
    }
}

impl Marched for SsdoParameters {
    const NAME: &'static str = "ssdo";
    const EFFECT: Effect = Effect::Do;
    const SHADER: Shader = Shader::at("methods/ssdo/light");
    type March = uniforms::Ssdo;

    fn march(&self, view: &View) -> uniforms::Ssdo {
        let [right, up, back] = [0, 1, 2].map(|axis| view.camera.rotation.col(axis));
        uniforms::Ssdo {
            width: view.width as u32,
            height: view.height as u32,
            directions: self.directions.max(1),
            steps: self.steps.max(1),
            seed: view.seed,
            radius: view.radius,
            thickness: self.thickness * view.radius,
            focal_length: view.focal_length(),
            environment_height: self.environment_height.max(1) as u32,
            right_x: right.x,
            right_y: right.y,
            right_z: right.z,
            up_x: up.x,
            up_y: up.y,
            up_z: up.z,
            back_x: back.x,
            back_y: back.y,
            back_z: back.z,
        }
    }

    fn blur(&self) -> blur::BlurParameters {
        self.blur
    }

    fn more(&self, environment: Option<&Environment>) -> Option<Vec<[f32; 4]>> {
        Some(self.filtered(environment).padded().collect())
    }

    fn noisy(
        &self,
        inputs: &PlainInputs<'_>,
        surface: &Surface,
        march: &uniforms::Ssdo,
    ) -> Result<Planes, MissingAttribute> {
        Ok(reference::gather_light(surface, &self.filtered(inputs.environment), march))
    }
}
